//! From cycles as they leave the cycle thread to the messages that stand in a bag.

use super::frames::{Head, Taken, stream};
use crate::recording::encoder::Encoder;
use crate::recording::packed::Unpacker;
use crate::recording::{Cycle, Encoded};
use lineshaft_core::config::MachineConfig;

/// Makes the messages of one cycle after the other, from a key cycle on.
#[derive(Clone, Debug)]
pub struct Decoder {
    unpacker: Unpacker,
    encoder: Encoder,
    config: MachineConfig,
}

impl Decoder {
    /// A decoder for a machine of `config`.
    pub fn new(unpacker: Unpacker, encoder: Encoder, config: &MachineConfig) -> Self {
        Self { unpacker, encoder, config: config.clone() }
    }

    /// The messages of a cycle. It follows the one before, or is a key cycle.
    pub fn decode(&mut self, head: &Head, taken: &Taken) -> Encoded {
        self.unpacker.unpack(head.cycle, &taken.bytes, head.is_key);
        let beside = &taken.beside;
        self.unpacker.inputs.latch.extend_from_slice(&beside.latches);
        let stream = stream(&beside.setpoints, self.config.axes.len());
        let mut encoded = self.encoder.encode(&Cycle {
            stamp_ns: head.stamp_ns,
            inputs: &self.unpacker.inputs,
            commands: &beside.commands,
            stream: stream.as_ref(),
            events: &beside.events,
            board: &self.unpacker.board,
        });
        for frame in &beside.frames {
            encoded.add_frame(frame.bus, frame.way, frame.offset_ns, &frame.frame);
        }
        match &head.state {
            Some(state) => encoded.with_state(state, &self.config),
            None => encoded,
        }
    }
}

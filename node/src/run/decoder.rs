//! Converts the cycles sent by the cycle thread to messages of a bag.

use super::frames::{BusFrame, Head, Taken, stream};
use crate::recording::encoder::Encoder;
use crate::recording::packed::Unpacker;
use crate::recording::{Cycle, Encoded};
use lineshaft_core::config::MachineConfig;

/// Converts one cycle after the other, from a key cycle on.
#[derive(Clone, Debug)]
pub struct Decoder {
    unpacker: Unpacker,
    encoder: Encoder,
    config: MachineConfig,
}

impl Decoder {
    /// Creates a decoder for a machine of `config`.
    pub fn new(unpacker: Unpacker, encoder: Encoder, config: &MachineConfig) -> Self {
        Self { unpacker, encoder, config: config.clone() }
    }

    /// Returns the messages of a cycle, which must follow the previous one or be a key cycle.
    pub fn decode(&mut self, head: &Head, taken: &Taken) -> Encoded {
        self.unpacker.unpack(head.cycle, &taken.bytes, head.is_key);
        let extras = &taken.extras;
        self.unpacker.inputs.latch.extend_from_slice(&extras.latches);
        let stream = stream(&extras.setpoints, self.config.axes.len());
        let mut encoded = self.encoder.encode(&Cycle {
            time: head.time,
            inputs: &self.unpacker.inputs,
            commands: &extras.commands,
            stream: stream.as_ref(),
            events: &extras.events,
            board: &self.unpacker.board,
        });
        for BusFrame { bus, way, offset_ns, kind, bytes } in extras.frames.iter() {
            encoded.add_frame(bus, way, offset_ns, (kind, bytes));
        }
        match &head.state {
            Some(state) => encoded.with_state(state, &self.config),
            None => encoded,
        }
    }
}

//! `lineshaft can monitor`.

use super::Failure;
use super::args::MonitorArgs;
use super::open::Known;
use crate::interrupt::Interrupt;
use crate::output;
use crate::recording::clean::clean;
use lineshaft_can::commission::{AssignedPdo, Decoder};
use lineshaft_can::config::DeviceConfig;
use lineshaft_can::layout::Pdo;
use lineshaft_can::{Frame, NodeId};
use lineshaft_cia402::dictionary::{Direction, Mapped};
use lineshaft_cia402::texts::hex;

pub(super) fn monitor(args: &MonitorArgs) -> Result<(), Failure> {
    let mut known = Known::of(&args.bus)?;
    if let Some(node) = args.node {
        known = known.with_eds(node, args.eds.as_deref())?;
    }
    let mut decoder = Decoder::default();
    for device in known.config.iter().flat_map(|config| &config.devices) {
        carry(&mut decoder, device);
    }
    for (node, dictionary) in known.dictionaries() {
        decoder.add_dictionary(node, dictionary.clone());
    }
    let interrupt = Interrupt::listen().map_err(|error| Failure::Bus(format!("Ctrl-C cannot be heard: {error}")))?;
    let mut session = known.open()?;
    let begin = session.elapsed();
    session.listen(|now, frame| {
        let since = now.saturating_sub(begin);
        if args.time.is_some_and(|time| since >= time) || interrupt.requested().is_some() {
            return false;
        }
        let Some(frame) = frame else { return true };
        // Frames of other nodes may belong to the same exchange even if they are not printed.
        let words = decoder.words(frame);
        if args.node.is_some_and(|node| !decoder.is_of_node(frame, node)) {
            return true;
        }
        let (since_s, told) = (since.as_secs_f64(), told(frame, &words));
        output::print_line(&format_args!("{since_s:12.6}  {told}"))
    })?;
    Ok(())
}

/// Formats a frame with its meaning.
pub(super) fn told(frame: &Frame, words: &str) -> String {
    let bytes = if frame.is_remote() { format!("R{}", frame.length()) } else { hex(frame.bytes()) };
    format!("{:03X}  {bytes:23}  {}", frame.id().get(), clean(words))
}

/// Adds the PDOs of a device, as configured by the cell, to the decoder.
pub(super) fn carry(decoder: &mut Decoder, device: &DeviceConfig) {
    for pdo in &device.layout.asked {
        decoder.assign_pdo(pdo.id, carried(device.node, Direction::Receive, pdo));
    }
    for pdo in &device.layout.told {
        decoder.assign_pdo(pdo.id, carried(device.node, Direction::Transmit, pdo));
    }
}

fn carried<W>(node: NodeId, direction: Direction, pdo: &Pdo<W>) -> AssignedPdo {
    let mapped = pdo.fields.iter().map(|field| Mapped { object: field.object, bits: field.bits as u8 }).collect();
    AssignedPdo { node, direction, number: pdo.number.into(), mapped }
}

//! Inputs, outputs and encoders of a cell at CAN nodes: those that a node has, and those that it can have.
//!
//! Law      a node is a drive of the cell, otherwise a module of inputs and outputs, or an encoder
//! Refuses  addresses that such a device does not have; a node that would be both a module and an encoder
//! Source   CiA 401-1 (8 words of 8 digital, 12 analog channels in PDOs), CiA 402-2 (60FDh, 60FEh), CiA 406

use super::super::can::MOST_CHANNELS;
use super::super::names::quote;
use super::super::terminals::{CellTerminal, Kind};
use crate::document::Problems;
use lineshaft_can::NodeId;
use lineshaft_can::layout::ANALOG_CHANNELS;
use lineshaft_cia402::config::{AnalogTerminal, Encoder, Terminals};
use lineshaft_core::config::IoKind;
use lineshaft_core::drive::{ObjectAddress, Terminal};
use std::collections::BTreeMap;

/// Returns the terminals of the nodes of a backend; `is_drive`: whether a node is a drive of the cell.
pub(super) fn by_node(
    terminals: &[CellTerminal],
    backend: usize,
    is_drive: impl Fn(NodeId) -> bool,
    problems: &Problems,
) -> BTreeMap<NodeId, Terminals> {
    let mut nodes = BTreeMap::<NodeId, Terminals>::new();
    for terminal in terminals.iter().filter(|terminal| terminal.at.backend == backend) {
        let CellTerminal { name, place, kind, index, .. } = terminal;
        let ObjectAddress { device, channel: address } = terminal.at.address;
        let Some(node) = u8::try_from(device).ok().and_then(NodeId::new) else { continue };
        let refuse = |sentence| problems.push(*place, sentence, None);
        let drive = is_drive(node);
        let what = if drive { "a drive" } else { "a module" };
        let highest = match (kind, drive) {
            (Kind::Io { kind: IoKind::DigitalInput | IoKind::DigitalOutput, .. }, true) => 31,
            (Kind::Io { kind: IoKind::DigitalInput | IoKind::DigitalOutput, .. }, false) => MOST_CHANNELS,
            (Kind::Io { .. }, true) => {
                refuse(format!("io {} is analog; {node} is a drive, of which digital ones are taken", quote(name)));
                continue;
            }
            (Kind::Io { .. }, false) => ANALOG_CHANNELS as u16 - 1,
            (Kind::Encoder { .. }, _) => 0,
        };
        if address > highest {
            refuse(format!("io {}: address is {address}; {node} is {what}, 0 to {highest} is allowed", quote(name)));
            continue;
        }
        let of_node = nodes.entry(node).or_default();
        let terminal = Terminal { place: *index, address };
        match *kind {
            Kind::Io { kind: IoKind::DigitalInput, .. } => of_node.digital_inputs.push(terminal),
            Kind::Io { kind: IoKind::DigitalOutput, .. } => of_node.digital_outputs.push(terminal),
            Kind::Io { kind: IoKind::AnalogInput, full_scale } => {
                of_node.analog_inputs.push(AnalogTerminal { terminal, volts_at_full_scale: full_scale });
            }
            Kind::Io { kind: IoKind::AnalogOutput, full_scale } => {
                of_node.analog_outputs.push(AnalogTerminal { terminal, volts_at_full_scale: full_scale });
            }
            Kind::Encoder { is_absolute } => of_node.encoders.push(Encoder { place: *index, is_absolute }),
        }
        let Terminals { digital_inputs, digital_outputs, analog_inputs, analog_outputs, encoders } = of_node;
        let io = digital_inputs.len() + digital_outputs.len() + analog_inputs.len() + analog_outputs.len();
        if !drive && io > 0 && !encoders.is_empty() {
            refuse(format!(
                "{}: {node} has entries of io and of encoders; a module or an encoder is allowed",
                quote(name)
            ));
        }
    }
    nodes
}

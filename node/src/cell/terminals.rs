//! Inputs, outputs and encoders of a cell that are at devices of their backend.

use super::backends::Hardware;
use crate::document::Place;
use lineshaft_core::config::IoKind;

/// Default full scale of an analog channel, in V.
pub(super) const FULL_SCALE: f64 = 10.0;

/// Kind of a terminal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Io { kind: IoKind, full_scale: f64 },
    Encoder { is_absolute: bool },
}

/// An entry of section `io` or `encoders` that is at a device.
#[derive(Clone, Debug)]
pub struct CellTerminal {
    pub(super) name: String,
    pub(super) place: Place,
    pub(super) kind: Kind,
    pub(super) at: Hardware,
    /// Its index among its kind in the machine.
    pub(super) index: usize,
}

/// Whether an entry of `io` is a digital input of that drive.
pub(super) fn reads_drive(drive: Hardware, terminals: &[CellTerminal]) -> bool {
    terminals.iter().any(|terminal| {
        let is_input = matches!(terminal.kind, Kind::Io { kind: IoKind::DigitalInput, .. });
        let is_there = terminal.at.backend == drive.backend && terminal.at.address.device == drive.address.device;
        is_input && is_there
    })
}

//! Simulated drive with voltage interface.
//!
//! Law      its reference is volts/10 of the value at 10 V; without its enable it has no power. It is ready while it is
//!          present and has no fault; removing its enable clears a fault
//! Source   MACS-CAN-01 (DRIVETYPE 0); contract section 3

use crate::config::{AxisConfig, MachineConfig};
use crate::drive::{DriveOutput, DriveState, FULL_VOLTS, Interface, Mode, Outputs, control};

/// Wiring of the drive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Analog {
    /// Index of the analog output.
    reference: usize,
    /// Index of the digital output.
    enable: usize,
    /// Index of the digital input.
    ready: Option<usize>,
    /// Value of 10 V.
    full: f64,
    interface: Interface,
}

impl Analog {
    pub(super) fn of(axis: &AxisConfig, config: &MachineConfig) -> Option<Self> {
        let wiring = axis.analog?;
        let place = |entry: u16| config.io_place(entry.into());
        Some(Self {
            reference: place(wiring.reference),
            enable: place(wiring.enable),
            ready: wiring.ready.map(place),
            full: wiring.full,
            interface: axis.interface,
        })
    }

    /// Returns the digital input of the ready signal.
    pub(super) fn ready(&self) -> Option<usize> {
        self.ready
    }

    /// Returns the commands that a drive on a bus would get; none without a supply.
    pub(super) fn output(&self, all: &Outputs, is_supplied: bool) -> DriveOutput {
        let volts = all.analog.get(self.reference).copied().filter(|volts| volts.is_finite()).unwrap_or_default();
        let reference = volts.clamp(-FULL_VOLTS, FULL_VOLTS) / FULL_VOLTS * self.full;
        let control = if is_supplied && all.digital(self.enable) { control::ENABLE } else { control::DISABLE_VOLTAGE };
        let mode = self.interface.mode();
        match mode {
            Mode::Torque => DriveOutput { effort: reference, control, mode, ..DriveOutput::default() },
            _ => DriveOutput { velocity: reference, control, mode, ..DriveOutput::default() },
        }
    }

    /// Returns the next state of the drive for a control word.
    pub(super) fn next(state: DriveState, word: u16) -> DriveState {
        match (state, word == control::ENABLE) {
            (DriveState::FaultReaction, _) | (DriveState::Fault, true) => DriveState::Fault,
            (_, true) => DriveState::Enabled,
            (_, false) => DriveState::SwitchOnDisabled,
        }
    }
}

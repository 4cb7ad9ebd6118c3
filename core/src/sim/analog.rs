//! A simulated drive that is given a voltage.
//!
//! Law      its reference is volts/10 of what 10 V are; without its enable it has no power. It is ready while it is there and has no fault, and a fault is over
//!          once its enable is taken away
//! Source   MACS-CAN-01 (DRIVETYPE 0); contract section 3

use crate::config::{AxisConfig, MachineConfig};
use crate::drive::{DriveOutput, DriveState, FULL_VOLTS, Interface, Mode, Outputs, control};

/// How it is wired.
#[derive(Clone, Copy, Debug)]
pub(super) struct Analog {
    /// Among the analog outputs.
    reference: usize,
    /// Among the digital outputs.
    enable: usize,
    /// Among the digital inputs.
    ready: Option<usize>,
    /// What 10 V are.
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

    /// Where it tells that it is ready.
    pub(super) fn ready(&self) -> Option<usize> {
        self.ready
    }

    /// What a drive on a bus would be asked for; nothing, where it has no supply.
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

    /// The state of the drive behind another one, with such a control word.
    pub(super) fn next(state: DriveState, word: u16) -> DriveState {
        match (state, word == control::ENABLE) {
            (DriveState::FaultReaction, _) | (DriveState::Fault, true) => DriveState::Fault,
            (_, true) => DriveState::Enabled,
            (_, false) => DriveState::SwitchOnDisabled,
        }
    }
}

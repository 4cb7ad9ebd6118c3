//! States, control and status words, and modes of operation of CiA 402.

use serde::{Deserialize, Serialize};

/// State of a drive (CiA 402), numbered as in the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DriveState {
    /// Not ready to switch on.
    #[default]
    NotReady = 0,
    /// Switch on disabled.
    SwitchOnDisabled = 1,
    /// Ready to switch on.
    Ready = 2,
    /// Switched on.
    SwitchedOn = 3,
    /// Operation enabled.
    Enabled = 4,
    /// Quick stop active.
    QuickStop = 5,
    /// Fault reaction active.
    FaultReaction = 6,
    /// Fault.
    Fault = 7,
}

impl DriveState {
    /// All states, in the order of their numbers.
    pub const ALL: [Self; 8] = [
        Self::NotReady,
        Self::SwitchOnDisabled,
        Self::Ready,
        Self::SwitchedOn,
        Self::Enabled,
        Self::QuickStop,
        Self::FaultReaction,
        Self::Fault,
    ];

    /// Returns its name in messages (CiA 402-2).
    pub fn text(self) -> &'static str {
        match self {
            Self::NotReady => "not ready to switch on",
            Self::SwitchOnDisabled => "switch on disabled",
            Self::Ready => "ready to switch on",
            Self::SwitchedOn => "switched on",
            Self::Enabled => "operation enabled",
            Self::QuickStop => "quick stop active",
            Self::FaultReaction => "fault reaction active",
            Self::Fault => "fault",
        }
    }

    /// Returns the state of a status word (CiA 402-2, table of the status word).
    pub fn from_status(status: u16) -> Self {
        match (status & 0x4F, status & 0x6F) {
            (0x00, _) => Self::NotReady,
            (0x40, _) => Self::SwitchOnDisabled,
            (_, 0x21) => Self::Ready,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::Enabled,
            (_, 0x07) => Self::QuickStop,
            (0x0F, _) => Self::FaultReaction,
            (0x08, _) => Self::Fault,
            // Any other pattern is not defined by CiA 402: such a drive must not be commanded.
            _ => Self::NotReady,
        }
    }

    /// Returns the status word of this state, with voltage enabled (bit 4) from ready on.
    pub fn status(self) -> u16 {
        match self {
            Self::NotReady => 0x0000,
            Self::SwitchOnDisabled => 0x0040,
            Self::Ready => 0x0031,
            Self::SwitchedOn => 0x0033,
            Self::Enabled => 0x0037,
            Self::QuickStop => 0x0017,
            Self::FaultReaction => 0x001F,
            Self::Fault => 0x0008,
        }
    }

    /// Returns the next state for a control word and the previous control word (CiA 402-2, transitions 2 to 16), one
    /// transition at a time. Initialization and fault reaction take no time.
    #[must_use]
    pub fn next(self, control: u16, last_control: u16) -> Self {
        let rises = |bit: u16| control & bit != 0 && last_control & bit == 0;
        match self {
            Self::NotReady => Self::SwitchOnDisabled,
            Self::FaultReaction => Self::Fault,
            Self::Fault if rises(control::FAULT_RESET) => Self::SwitchOnDisabled,
            Self::Fault => Self::Fault,
            // Bit 1 is 0: no voltage.
            _ if control & 0x02 == 0 => Self::SwitchOnDisabled,
            // Bit 2 is 0: quick stop.
            Self::Enabled | Self::QuickStop if control & 0x04 == 0 => Self::QuickStop,
            _ if control & 0x04 == 0 => Self::SwitchOnDisabled,
            Self::QuickStop => Self::QuickStop,
            _ if control & 0x01 == 0 => Self::Ready,
            Self::Ready => Self::SwitchedOn,
            Self::SwitchedOn | Self::Enabled if control & 0x08 != 0 => Self::Enabled,
            Self::SwitchedOn | Self::Enabled => Self::SwitchedOn,
            Self::SwitchOnDisabled => Self::SwitchOnDisabled,
        }
    }
}

/// Control words (CiA 402-2, table of the control word).
pub mod control {
    /// Switches the voltage off: the drive coasts.
    pub const DISABLE_VOLTAGE: u16 = 0x00;
    /// Quick stop: the drive stops on its own ramp.
    pub const QUICK_STOP: u16 = 0x02;
    /// Shutdown: to ready to switch on.
    pub const SHUTDOWN: u16 = 0x06;
    /// Switch on: to switched on.
    pub const SWITCH_ON: u16 = 0x07;
    /// Enable operation: to operation enabled.
    pub const ENABLE: u16 = 0x0F;
    /// Fault reset, at its rising edge.
    pub const FAULT_RESET: u16 = 0x80;
    /// Start of homing in mode homing, together with [`ENABLE`], at its rising edge.
    pub const START_HOMING: u16 = 0x10;
}

/// Status word bit 7: warning.
pub const STATUS_WARNING: u16 = 0x80;
/// Status word bit 12 in mode homing: homing attained.
pub const STATUS_HOMING_ATTAINED: u16 = 0x1000;
/// Status word bit 13 in mode homing: homing error.
pub const STATUS_HOMING_ERROR: u16 = 0x2000;
/// Status word bit 10: target reached; in mode homing the axis is at rest.
pub const STATUS_TARGET_REACHED: u16 = 0x0400;
/// Mode of operation: homing.
pub const MODE_HOMING: i8 = 6;
/// Mode of operation: cyclic synchronous position.
pub const MODE_CSP: i8 = 8;
/// Mode of operation: cyclic synchronous velocity.
pub const MODE_CSV: i8 = 9;
/// Mode of operation: cyclic synchronous torque.
pub const MODE_CST: i8 = 10;
/// Mode of operation: voltage. CiA 402 has no mode for it; negative numbers are manufacturer-specific.
pub const MODE_VOLTAGE: i8 = -1;
/// Mode of operation: velocity mode of frequency converters and switched motors.
pub const MODE_VELOCITY: i8 = 2;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_reads_back_from_its_status_word() {
        use DriveState::*;
        for state in [NotReady, SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop, FaultReaction, Fault] {
            assert_eq!(DriveState::from_status(state.status()), state);
            assert_eq!(DriveState::from_status(state.status() | STATUS_WARNING | 0x1600), state, "don't-care bits");
        }
    }

    /// The table of transitions: each command word in each state.
    #[test]
    fn control_word_executes_one_transition() {
        use DriveState::*;
        let words = [
            (
                control::DISABLE_VOLTAGE,
                [SwitchOnDisabled, SwitchOnDisabled, SwitchOnDisabled, SwitchOnDisabled, SwitchOnDisabled],
            ),
            (control::QUICK_STOP, [SwitchOnDisabled, SwitchOnDisabled, SwitchOnDisabled, QuickStop, QuickStop]),
            (control::SHUTDOWN, [Ready, Ready, Ready, Ready, QuickStop]),
            (control::SWITCH_ON, [SwitchOnDisabled, SwitchedOn, SwitchedOn, SwitchedOn, QuickStop]),
            (control::ENABLE, [SwitchOnDisabled, SwitchedOn, Enabled, Enabled, QuickStop]),
        ];
        for (word, after) in words {
            for (before, after) in [SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop].into_iter().zip(after) {
                assert_eq!(before.next(word, 0), after, "{word:#x} in {before:?}");
            }
            assert_eq!((NotReady.next(word, 0), FaultReaction.next(word, 0)), (SwitchOnDisabled, Fault));
            assert_eq!(Fault.next(word, 0), Fault);
        }
        assert_eq!(Fault.next(control::FAULT_RESET, control::ENABLE), SwitchOnDisabled);
        assert_eq!(Fault.next(control::FAULT_RESET, control::FAULT_RESET), Fault, "no rising edge");
    }
}

//! Power state of an axis, and supervision of its idle drive.

use serde::{Deserialize, Serialize};

/// The power state of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::axis) enum Power {
    /// The drive has no voltage.
    Off,
    /// Changing to operation enabled, since that cycle.
    SwitchingOn { since: u64 },
    /// Operation enabled: the axis commands the drive.
    On,
    /// Operation enabled and holding, while the brake opens.
    Opening { since: u64 },
    /// Stops first, then switches off.
    SwitchingOff,
    /// At rest and holding, while the brake closes; then switches off.
    Closing { since: u64 },
    /// The drive stops by itself (error reaction 4), since that cycle; `then_off`: it is switched off afterwards.
    DriveStops { since: u64, then_off: bool },
    /// Resets the fault of the drive, since that cycle.
    Resetting { since: u64 },
}

/// Supervision of a drive whose axis is off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::axis) struct Watch {
    /// Whether it has been online without fault at least once.
    pub(in crate::axis) was_well: bool,
    /// Whether its present failure was reported.
    pub(in crate::axis) is_told: bool,
    /// Cycle of the last report.
    pub(in crate::axis) told: Option<u64>,
    /// Code of the emergency message that was last reported, and its cycle.
    pub(in crate::axis) emergency: Option<(u16, u64)>,
    /// Cycle since which emergency messages are counted, and number of them reported since.
    pub(in crate::axis) emergencies: (u64, u8),
}

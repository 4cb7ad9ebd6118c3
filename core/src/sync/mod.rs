//! Following a lead: exact transmissions, and the start and end of a coupling.

pub mod approach;
pub mod cam;
pub mod filter;
pub mod follower;
pub mod gear;
mod leads;
pub mod marker;
mod shift;
mod sum;
mod transmission;
mod virtual_master;

pub use leads::{Leads, OfAxis};
use serde::{Deserialize, Serialize};
pub use shift::Shift;
pub use sum::{MOST_TERMS, Sum, Term};
pub use transmission::{Stepped, Transmission};
pub use virtual_master::{VirtualMaster, VirtualSource};

/// Bits of `x.sync.status`, the SYNCSTAT of MACS, which specifies no numbers (MACS-SYS-04, A-55).
pub mod status {
    /// The synchronization error is within SYNCACCURACY.
    pub const ACCURATE: u64 = 1;
    /// Enough accurate pairs of markers have come.
    pub const READY: u64 = 1 << 1;
    /// Too many successive pairs of markers were inaccurate.
    pub const FAULT: u64 = 1 << 2;
    /// A marker of the master was missed.
    pub const MASTER_MARKER_MISSED: u64 = 1 << 3;
    /// A marker of the slave was missed.
    pub const SLAVE_MARKER_MISSED: u64 = 1 << 4;
}

/// The relation of a follower to its leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SyncMode {
    /// SYNCV: equal velocity times the ratio.
    Velocity,
    /// SYNCP: the distance lost while the follower accelerates is caught up. A cam uses this mode.
    Position,
    /// SYNCM: as SYNCP, and marks of both are matched.
    Marker,
    /// SYNCCMM: a cam whose position in the table is corrected by marks of its master.
    MasterMarker,
    /// SYNCCMS: a cam whose slave is corrected by its marks.
    SlaveMarker,
}

impl SyncMode {
    /// Whether it keeps a position.
    pub fn keeps_position(self) -> bool {
        self != Self::Velocity
    }

    /// Whether it is coupled by marks.
    pub fn has_marks(self) -> bool {
        matches!(self, Self::Marker | Self::MasterMarker | Self::SlaveMarker)
    }
}

/// The start of a cam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CamStart {
    /// Master and slave are at the positions of the table; a slave that is elsewhere is refused.
    #[default]
    Absolute,
    /// The table begins at the present positions of master and slave.
    Relative,
    /// As [`CamStart::Absolute`], but the slave catches up.
    RampIn,
}

impl CamStart {
    /// All starts by name; the place is the number in the interface.
    pub const NAMES: [(&'static str, Self); 3] =
        [("absolute", Self::Absolute), ("relative", Self::Relative), ("ramp_in", Self::RampIn)];
}

/// Action of a follower at the end of its coupling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Disengage {
    /// Stops.
    #[default]
    Stop,
    /// Continues at its velocity.
    KeepVelocity,
}

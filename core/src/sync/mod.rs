//! Following a lead: exact transmissions and the way into and out of them.

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

/// Bits of `x.sync.status`, what MACS calls SYNCSTAT; the text gives no numbers (MACS-SYS-04, A-55).
pub mod status {
    /// The sync error lies within SYNCACCURACY.
    pub const ACCURATE: u64 = 1;
    /// Enough markers have come.
    pub const READY: u64 = 1 << 1;
    /// Markers stay away.
    pub const FAULT: u64 = 1 << 2;
    /// A marker of the master was missed.
    pub const MASTER_MARKER_MISSED: u64 = 1 << 3;
    /// A marker of the slave was missed.
    pub const SLAVE_MARKER_MISSED: u64 = 1 << 4;
}

/// How a follower relates to its leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SyncMode {
    /// SYNCV: equal velocity times the ratio.
    Velocity,
    /// SYNCP: what is lost while the follower speeds up is caught up. A cam is one.
    Position,
    /// SYNCM: the same, and marks of both are brought together.
    Marker,
    /// SYNCCMM: a cam, and marks of its master correct where that is in the table.
    MasterMarker,
    /// SYNCCMS: a cam, and marks of its slave correct where that is.
    SlaveMarker,
}

impl SyncMode {
    /// Does it keep a position?
    pub fn keeps_position(self) -> bool {
        self != Self::Velocity
    }

    /// Is it coupled by marks?
    pub fn has_marks(self) -> bool {
        matches!(self, Self::Marker | Self::MasterMarker | Self::SlaveMarker)
    }
}

/// How a cam begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CamStart {
    /// Master and slave are where the table says: a slave that is not is refused.
    #[default]
    Absolute,
    /// The table begins where master and slave are.
    Relative,
    /// As [`CamStart::Absolute`], but the slave is led there.
    RampIn,
}

impl CamStart {
    /// Every start with its number and its name in the interface.
    pub const ALL: [(Self, u8, &'static str); 3] =
        [(Self::Absolute, 0, "absolute"), (Self::Relative, 1, "relative"), (Self::RampIn, 2, "ramp_in")];

    /// The name in scenarios.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(start, ..)| *start == self).map_or("", |(.., name)| name)
    }
}

/// What a follower does when it is uncoupled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Disengage {
    /// Stops.
    #[default]
    Stop,
    /// Goes on at its velocity.
    KeepVelocity,
}

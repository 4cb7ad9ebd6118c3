//! Following a lead: exact transmissions and the way into and out of them.

pub mod follower;
pub mod gear;
mod leads;
mod transmission;

pub use leads::{Leads, OfAxis};
use serde::{Deserialize, Serialize};
pub use transmission::Transmission;

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
    /// SYNCP: what is lost while the follower speeds up is caught up.
    Position,
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

//! Following a leader: exact gears and the way into and out of them.

pub mod follower;
pub mod gear;

use crate::encoder::Lead;
use crate::object::Leader;
use serde::{Deserialize, Serialize};

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

/// Everything that can lead, as far as this cycle has come.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Leads {
    /// Command positions of the axes.
    pub command: Vec<Lead>,
    /// Actual positions of the axes.
    pub actual: Vec<Lead>,
    /// Encoders.
    pub encoder: Vec<Lead>,
    /// Simulated masters of the axes.
    pub simulated: Vec<Lead>,
}

impl Leads {
    /// Copies others of the same machine, without taking memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.command.clone_from(&other.command);
        self.actual.clone_from(&other.actual);
        self.encoder.clone_from(&other.encoder);
        self.simulated.clone_from(&other.simulated);
    }

    /// The leader's values; an invalid lead for one that does not exist.
    pub fn get(&self, leader: Leader) -> Lead {
        let place = match leader {
            Leader::AxisCommand(axis) => self.command.get(usize::from(axis)),
            Leader::AxisActual(axis) => self.actual.get(usize::from(axis)),
            Leader::Encoder(encoder) => self.encoder.get(usize::from(encoder)),
            Leader::Simulated(axis) => self.simulated.get(usize::from(axis)),
        };
        place.copied().unwrap_or_default()
    }
}

//! Following a leader: exact gears and the way into and out of them.

pub mod follower;
pub mod gear;

use crate::encoder::Lead;
use crate::object::Leader;
use serde::{Deserialize, Serialize};

/// Everything that can lead, as far as this cycle has come.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Leads {
    /// Command positions of the axes.
    pub command: Vec<Lead>,
    /// Actual positions of the axes.
    pub actual: Vec<Lead>,
    /// Encoders.
    pub encoder: Vec<Lead>,
}

impl Leads {
    /// Copies others of the same machine, without taking memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.command.clone_from(&other.command);
        self.actual.clone_from(&other.actual);
        self.encoder.clone_from(&other.encoder);
    }

    /// The leader's values; an invalid lead for one that does not exist.
    pub fn get(&self, leader: Leader) -> Lead {
        let place = match leader {
            Leader::AxisCommand(axis) => self.command.get(usize::from(axis)),
            Leader::AxisActual(axis) => self.actual.get(usize::from(axis)),
            Leader::Encoder(encoder) => self.encoder.get(usize::from(encoder)),
        };
        place.copied().unwrap_or_default()
    }
}

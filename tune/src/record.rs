//! Record of an axis during its excitation.
//!
//! Law      `commands[k]` is output in cycle k, after `positions[k]` was read: without a delay its effect is first in
//!          `positions[k + 1]`. The record begins at rest, after the command 0
//! Reads    commands as fractions of full command, counted positions (inc)
//! Writes   nothing
//! Refuses  lists of different lengths, commands that are not within +-1, a cycle time outside its range

use crate::identify::Refusal;
use crate::model::{Takes, judge};
use serde::{Deserialize, Serialize};

/// A record of an excitation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Cycle time (s).
    pub cycle: f64,
    /// Interface of the drive.
    pub takes: Takes,
    /// One command for each cycle, -1 to 1.
    pub commands: Vec<f64>,
    /// One position for each cycle (inc).
    pub positions: Vec<i64>,
    /// Efforts that the drive reports, in the unit of the commands; empty if it reports none. If present they are used
    /// instead of the commands, and their lag is not part of the identified delay.
    pub efforts: Vec<f64>,
}

/// Minimum length of a record (cycles).
pub(crate) const LEAST_CYCLES: usize = 64;

impl Record {
    /// Creates an empty record for that number of cycles. Its memory is accessed here, so that no cycle waits for a
    /// memory page.
    pub fn with_capacity(cycle: f64, takes: Takes, cycles: usize) -> Self {
        let (mut commands, mut positions) = (vec![1.0; cycles], vec![1; cycles]);
        commands.clear();
        positions.clear();
        Self { cycle, takes, commands, positions, efforts: Vec::new() }
    }

    /// Adds one cycle.
    pub fn push(&mut self, command: f64, position: i64) {
        self.commands.push(command);
        self.positions.push(position);
    }

    pub(crate) fn check(&self) -> Result<(), Refusal> {
        judge("cycle", self.cycle, "s", 1e-5, 1.0)?;
        let (commands, positions) = (self.commands.len(), self.positions.len());
        if commands != positions || !(self.efforts.is_empty() || self.efforts.len() == positions) {
            return Err(Refusal::Uneven { commands, positions, efforts: self.efforts.len() });
        }
        if positions < LEAST_CYCLES {
            return Err(Refusal::Short { cycles: positions, least: LEAST_CYCLES });
        }
        for &command in &self.commands {
            judge("command", command, "", -1.0, 1.0)?;
        }
        for &effort in &self.efforts {
            judge("effort", effort, "", -100.0, 100.0)?;
        }
        Ok(())
    }

    /// Returns the inputs that act on the axis.
    pub(crate) fn inputs(&self) -> &[f64] {
        if self.takes == Takes::Effort && !self.efforts.is_empty() { &self.efforts } else { &self.commands }
    }

    /// Returns the positions relative to the first one (inc).
    pub(crate) fn relative_positions(&self) -> Vec<f64> {
        let first = self.positions.first().copied().unwrap_or(0);
        self.positions.iter().map(|&position| position.saturating_sub(first) as f64).collect()
    }
}

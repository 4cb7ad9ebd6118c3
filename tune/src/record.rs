//! What is seen of an axis while it is excited.
//!
//! Law      `commands[k]` is put out in cycle k, after `positions[k]` was read: without a delay it shows in `positions[k + 1]` first.
//!          The record begins at rest, with the command before it 0
//! Reads    commands in parts of the full one, counted positions (inc)
//! Writes   nothing
//! Refuses  lists of different length, commands that are no numbers within +-1, a cycle beyond its range

use crate::identify::Refusal;
use crate::model::{Takes, judge};
use serde::{Deserialize, Serialize};

/// A record of an excitation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Of the machine (s).
    pub cycle: f64,
    /// What the commands are.
    pub takes: Takes,
    /// One for each cycle, -1 to 1.
    pub commands: Vec<f64>,
    /// One for each cycle (inc).
    pub positions: Vec<i64>,
    /// Efforts that the drive tells, in the unit of the commands; empty where it tells none. Where there are any, they
    /// count as what acts, and their lag is no part of the delay that is found.
    pub efforts: Vec<f64>,
}

/// Shortest record (cycles).
pub(crate) const LEAST_CYCLES: usize = 64;

impl Record {
    /// For so many cycles, empty. Its memory is touched here, so that no cycle waits for a page of it.
    pub fn with_capacity(cycle: f64, takes: Takes, cycles: usize) -> Self {
        let (mut commands, mut positions) = (vec![1.0; cycles], vec![1; cycles]);
        commands.clear();
        positions.clear();
        Self { cycle, takes, commands, positions, efforts: Vec::new() }
    }

    /// One cycle more.
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

    /// What acts on the axis.
    pub(crate) fn inputs(&self) -> &[f64] {
        if self.takes == Takes::Effort && !self.efforts.is_empty() { &self.efforts } else { &self.commands }
    }

    /// From the first one on (inc).
    pub(crate) fn way(&self) -> Vec<f64> {
        let first = self.positions.first().copied().unwrap_or(0);
        self.positions.iter().map(|&position| position.saturating_sub(first) as f64).collect()
    }
}

//! Mechanics of a simulated drive in addition to its motor: switches and their wiring, index, load, brake, and outputs
//! for the sign of the reference.
//!
//! Law      a wired switch reads at its digital input and not at the drive; a switch without a wire reads at the drive
//!          (60FDh). A load falls with its acceleration while neither power nor brake holds it; a closed brake holds
//!          against the motor, too
//! Source   contract sections 3 and 8, MACS-DIR-08, MACS-DIR-09

use super::Fixtures;
use crate::drive::Outputs;

/// A switch that is wired to a digital input of the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwitchWiring {
    /// Bit of the switch in the digital inputs of a drive, see [`crate::drive::inputs`].
    pub switch: u32,
    /// Index among the digital inputs of the cell.
    pub input: usize,
    /// Whether the contact is normally closed: 0 while it is actuated.
    pub normally_closed: bool,
}

impl SwitchWiring {
    /// Returns the level at the input.
    pub(super) fn level(&self, actuated: u32) -> bool {
        (actuated & self.switch != 0) != self.normally_closed
    }
}

/// A brake that a digital output controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimBrake {
    /// Index among the digital outputs.
    pub output: usize,
    /// Whether output 1 closes the brake; otherwise it opens it.
    pub closes_with_one: bool,
    /// Time from the output to the open brake (ns).
    pub opens_ns: u64,
    /// Time from the output to the closed brake (ns).
    pub closes_ns: u64,
}

/// Outputs for the sign of a drive whose reference has none: indices among the digital outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignOutputs {
    /// 1: negative direction.
    Direction(usize),
    /// Positive direction while the first output is 1, negative while the second one is.
    Enables(usize, usize),
}

impl SignOutputs {
    /// Returns the reference with its sign; 0 if none or both are enabled.
    pub(super) fn of(self, reference: f64, outputs: &Outputs) -> f64 {
        match self {
            Self::Direction(output) if outputs.digital(output) => 0.0 - reference,
            Self::Direction(_) => reference,
            Self::Enables(forward, backward) => match (outputs.digital(forward), outputs.digital(backward)) {
                (true, false) => reference,
                (false, true) => 0.0 - reference,
                _ => 0.0,
            },
        }
    }
}

/// Mechanics of one simulated drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mechanics {
    /// Switches and index.
    pub fixtures: Fixtures,
    /// Switches that are wired to digital inputs: reference, negative, positive.
    pub wires: [Option<SwitchWiring>; 3],
    /// Acceleration of a hanging load without brake and power (counts/s^2); 0 without such a load.
    pub load: f64,
    /// Its brake.
    pub brake: Option<SimBrake>,
    /// Outputs for the sign of the reference.
    pub sign: Option<SignOutputs>,
}

impl Mechanics {
    /// Returns the bits of the switches that do not read at the drive.
    pub(super) fn wired(&self) -> u32 {
        self.wires.iter().flatten().fold(0, |bits, wire| bits | wire.switch)
    }
}

/// State of a brake.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brake {
    law: SimBrake,
    /// Whether its output commands it to close.
    closes: bool,
    /// Cycles since that command.
    since: u64,
    /// Whether it is closed.
    pub closed: bool,
}

impl Brake {
    pub(super) fn new(law: SimBrake) -> Self {
        Self { law, closes: true, since: 0, closed: true }
    }

    /// Executes one cycle with these outputs.
    pub(super) fn step(&mut self, outputs: &Outputs, cycle_ns: u64) {
        let closes = outputs.digital(self.law.output) == self.law.closes_with_one;
        self.since = if closes == self.closes { self.since.saturating_add(1) } else { 0 };
        self.closes = closes;
        let time = if closes { self.law.closes_ns } else { self.law.opens_ns };
        if self.since.saturating_mul(cycle_ns) >= time {
            self.closed = closes;
        }
    }
}

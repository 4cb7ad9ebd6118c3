//! What hangs on a simulated drive beside its motor: switches and an index along its way and where the switches are wired to, a
//! load, a brake, outputs that tell a drive the sign of its reference.
//!
//! Law      a switch with a wire reads at its digital input and not at the drive; one without reads at the drive (60FDh). A
//!          load falls with its acceleration while neither power nor brake holds it; a closed brake holds against the motor,
//!          too
//! Source   contract sections 3 and 8, MACS-DIR-08, MACS-DIR-09

use super::Fixtures;
use crate::drive::Outputs;

/// A switch that is wired to a digital input of the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// Bit of the switch in the digital inputs of a drive, see [`crate::drive::inputs`].
    pub switch: u32,
    /// The digital input, by its place among those of the cell.
    pub input: usize,
    /// A normally closed contact: 0 while it is actuated.
    pub normally_closed: bool,
}

impl Wire {
    /// The level at the input.
    pub(super) fn level(&self, actuated: u32) -> bool {
        (actuated & self.switch != 0) != self.normally_closed
    }
}

/// A brake that a digital output works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimBrake {
    /// The output, by its place among the digital outputs.
    pub output: usize,
    /// The output is 1 to close it; else 1 to open it.
    pub closes_with_one: bool,
    /// From the output to an open brake (ns).
    pub opens_ns: u64,
    /// From the output to a closed brake (ns).
    pub closes_ns: u64,
}

/// How a drive without a sign in its reference learns it: by places among the digital outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// 1: backwards.
    Direction(usize),
    /// Forwards while the first is 1, backwards while the second is.
    Enables(usize, usize),
}

impl Sign {
    /// The reference with its sign; 0 where nothing or both is enabled.
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

/// What hangs on one simulated drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mechanics {
    /// Along its way.
    pub fixtures: Fixtures,
    /// Switches that are wired to digital inputs: reference, negative, positive.
    pub wires: [Option<Wire>; 3],
    /// What a hanging load does when nothing holds it (counts/s^2); 0 where nothing hangs.
    pub load: f64,
    /// Its brake.
    pub brake: Option<SimBrake>,
    /// Outputs that tell the sign.
    pub sign: Option<Sign>,
}

impl Mechanics {
    /// Bits of the switches that the drive does not see.
    pub(super) fn wired(&self) -> u32 {
        self.wires.iter().flatten().fold(0, |bits, wire| bits | wire.switch)
    }
}

/// The brake as it moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brake {
    law: SimBrake,
    /// What its output asks for.
    closes: bool,
    /// Cycles since the output asks for that.
    since: u64,
    /// Where it is.
    pub closed: bool,
}

impl Brake {
    pub(super) fn new(law: SimBrake) -> Self {
        Self { law, closes: true, since: 0, closed: true }
    }

    /// One cycle with these outputs.
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

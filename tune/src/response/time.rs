//! Steps and moves of a model with the loops of the core.
//!
//! Law      in each cycle the position is counted, the loops of the core compute the command, and the model advances by
//!          a cycle; this is exact apart from Coulomb friction, which acts between parts of a cycle and holds what it
//!          can stop
//! Reads    a model, loops, a move
//! Writes   a sample for each cycle, figures
//! Refuses  loops that do not suit the model, invalid moves

use crate::discrete::held;
use crate::loops::{LoopError, Loops, PositionLaw};
use crate::model::{Dynamics, Model, judge};
use lineshaft_core::position::Position;
use lineshaft_core::regulator::{Pid, PidInput, Proportional, VelocityEstimator, VelocityLoop};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Commanded motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Move {
    /// A step.
    Step {
        /// Distance (inc).
        distance: f64,
    },
    /// A trapezoid: constant acceleration, constant velocity if the distance allows it, and the same deceleration.
    Trapezoid {
        /// Distance (inc).
        distance: f64,
        /// Velocity (inc/s).
        velocity: f64,
        /// Acceleration (inc/s^2).
        acceleration: f64,
    },
}

/// Values of a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time since the beginning of the move (s).
    pub time: f64,
    /// Command position (inc).
    pub command: f64,
    /// Position (inc), not rounded.
    pub position: f64,
    /// Output to the drive, -1 to 1.
    pub output: f64,
}

/// Figures of a move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Overshoot (% of the distance).
    pub overshoot: f64,
    /// Rise time from 10 to 90 % of the distance (s); `None` if it is not reached.
    pub rise: Option<f64>,
    /// Settling time from the end of the command until it stays within the window (s); `None` if it does not.
    pub settling: Option<f64>,
    /// Largest following error, as magnitude of command minus position (inc).
    pub following_error: f64,
}

/// Trace of a move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// One sample for each cycle.
    pub samples: Vec<Sample>,
    /// Figures of all samples.
    pub figures: Figures,
}

/// Parts of a cycle, before and after the change of the input.
const PARTS: u32 = 4;

/// Maximum length of a simulation (cycles).
const MOST_CYCLES: f64 = 1e7;

/// Command position, its velocity and its acceleration.
type Command = (f64, f64, f64);

impl Move {
    /// Returns the distance (inc).
    pub fn distance(&self) -> f64 {
        match *self {
            Self::Step { distance } | Self::Trapezoid { distance, .. } => distance,
        }
    }

    /// Returns the time of the acceleration, and of the whole move (s).
    fn times(&self) -> (f64, f64) {
        match *self {
            Self::Step { .. } => (0.0, 0.0),
            Self::Trapezoid { distance, velocity, acceleration } => {
                let fastest = velocity.min((distance.abs() * acceleration).sqrt());
                let rising = fastest / acceleration;
                (rising, rising + distance.abs() / fastest)
            }
        }
    }

    /// Returns the time until the command is at rest (s).
    pub fn duration(&self) -> f64 {
        self.times().1
    }

    fn at(&self, time: f64) -> Command {
        let distance = self.distance();
        let Self::Trapezoid { acceleration, .. } = *self else { return (distance, 0.0, 0.0) };
        let (rising, whole) = self.times();
        let (a, sense) = (acceleration, distance.signum());
        let left = whole - time;
        if left <= 0.0 {
            (distance, 0.0, 0.0)
        } else if time < rising {
            (sense * 0.5 * a * time * time, sense * a * time, sense * a)
        } else if left < rising {
            (distance - sense * 0.5 * a * left * left, sense * a * left, -sense * a)
        } else {
            (sense * a * rising * (time - 0.5 * rising), sense * a * rising, 0.0)
        }
    }

    fn check(&self) -> Result<(), LoopError> {
        judge("distance", self.distance().abs(), "inc", 1e-3, 1e12)?;
        if let Self::Trapezoid { velocity, acceleration, .. } = *self {
            judge("velocity", velocity, "inc/s", 1e-3, 1e12)?;
            judge("acceleration", acceleration, "inc/s^2", 1e-3, 1e15)?;
        }
        Ok(())
    }
}

/// A part of a cycle.
struct Part {
    a: DMatrix<f64>,
    b: DVector<f64>,
    /// Change of the velocity of the motor by Coulomb friction in it (inc/s).
    friction: f64,
}

/// State of the simulated model.
pub(super) struct Plant {
    pub(super) state: DVector<f64>,
    /// Before and after the change of the input.
    parts: [Option<Part>; 2],
    /// Delayed inputs, the newest first.
    pub(super) past: Vec<f64>,
    /// Constant input that corresponds to offset or load, as a fraction of full command.
    bias: f64,
}

impl Plant {
    pub(super) fn new(model: &Model) -> Self {
        let system = model.continuous();
        let (friction, bias) = match model.dynamics {
            Dynamics::Velocity { gain, offset, .. } => (0.0, offset / gain),
            Dynamics::Effort { acceleration, coulomb, load, resonance, .. } => {
                (coulomb * (1.0 + resonance.map_or(0.0, |r| r.inertia_ratio)), -load / acceleration)
            }
        };
        let lag = (model.delay / model.cycle + 1e-9).floor();
        let late = (model.delay - lag * model.cycle).max(0.0);
        let part = |time: f64| {
            let time = time / f64::from(PARTS);
            let (a, b) = held(&system, time);
            (time > 0.0).then_some(Part { a, b, friction: friction * time })
        };
        Self {
            state: DVector::zeros(system.a.nrows()),
            parts: [part(late), part(model.cycle - late)],
            past: vec![0.0; lag as usize + 2],
            bias,
        }
    }

    pub(super) fn cycle(&mut self, input: f64) {
        self.past.rotate_right(1);
        self.past[0] = input;
        let (older, newer) = (self.past[self.past.len() - 1], self.past[self.past.len() - 2]);
        for (part, input) in self.parts.iter().zip([older, newer]) {
            let Some(part) = part else { continue };
            for _ in 0..PARTS {
                part.step(&mut self.state, input + self.bias);
            }
        }
    }
}

impl Part {
    fn step(&self, state: &mut DVector<f64>, input: f64) {
        let mut next = &self.a * &*state;
        next.axpy(input, &self.b, 1.0);
        if self.friction == 0.0 {
            *state = next;
            return;
        }
        let (place, stood) = (state[0], state[1] == 0.0);
        *state = next;
        let velocity = state[1];
        state[1] = if velocity.abs() <= self.friction { 0.0 } else { velocity - self.friction * velocity.signum() };
        if stood && state[1] == 0.0 {
            // An axis at rest does not creep; the twist of a spring is of that order anyway.
            state[0] = place;
        }
    }
}

/// State of the loops between two cycles.
struct Control {
    loops: Loops,
    pid: Pid,
    velocity: VelocityLoop,
    estimator: Option<VelocityEstimator>,
}

impl Control {
    fn new(loops: Loops, cycle: f64) -> Result<Self, LoopError> {
        let estimator = loops.velocity.map(|inner| VelocityEstimator::new(inner.method, cycle)).transpose()?;
        Ok(Self { loops, pid: Pid::default(), velocity: VelocityLoop::default(), estimator })
    }

    fn cycle(&mut self, (command, velocity, acceleration): Command, actual: i64) -> f64 {
        let most = self.loops.max_velocity;
        let (command, place) = (Position::from_f64(command), Position::whole(actual));
        let asked = match self.loops.position {
            PositionLaw::Proportional { kv } => {
                Proportional { gain: kv, max_velocity: most }.velocity(command, place) / most
            }
            PositionLaw::Pid { gains, cycles } => {
                let input = PidInput {
                    error: (command - place).to_f64(),
                    velocity: velocity / most,
                    acceleration: acceleration / self.loops.max_acceleration,
                };
                self.pid.step(&gains, cycles, input)
            }
        };
        match (&self.loops.velocity, &mut self.estimator) {
            (Some(inner), Some(estimator)) => {
                let seen = estimator.step(actual);
                self.velocity.step(&inner.gains, asked - seen / most)
            }
            _ => asked,
        }
    }
}

/// Simulates a move for `duration` (s): from rest, with its position counted in whole increments. The target counts as
/// reached within `window` (inc).
///
/// # Errors
/// Loops that do not suit the model; a move, a window or a duration outside its range.
pub fn simulate(model: &Model, loops: &Loops, to: &Move, duration: f64, window: f64) -> Result<Trace, LoopError> {
    loops.check(model)?;
    to.check()?;
    judge("duration", duration, "s", model.cycle, MOST_CYCLES * model.cycle)?;
    judge("window", window, "inc", 0.0, 1e12)?;
    let (mut plant, mut control) = (Plant::new(model), Control::new(*loops, model.cycle)?);
    let count = (duration / model.cycle).ceil() as u32;
    let mut samples = Vec::new();
    for k in 0..count {
        let time = f64::from(k) * model.cycle;
        let command = to.at(time);
        let position = plant.state[0];
        let output = control.cycle(command, position.round() as i64);
        samples.push(Sample { time, command: command.0, position, output });
        plant.cycle(output);
    }
    let figures = Figures::of(&samples, to, window);
    Ok(Trace { samples, figures })
}

impl Figures {
    fn of(samples: &[Sample], to: &Move, window: f64) -> Self {
        let distance = to.distance();
        let part = |sample: &Sample| sample.position / distance;
        let first = |level: f64| samples.iter().find(|s| part(s) >= level).map(|s| s.time);
        let end = to.duration();
        let last_out = samples.iter().rposition(|s| (s.position - distance).abs() > window);
        let in_again = samples.get(last_out.map_or(0, |last| last + 1)).map(|s| (s.time - end).max(0.0));
        Self {
            overshoot: samples.iter().fold(0.0_f64, |most, s| most.max(100.0 * (part(s) - 1.0))),
            rise: first(0.1).zip(first(0.9)).map(|(from, to)| to - from),
            settling: in_again,
            following_error: samples.iter().fold(0.0_f64, |most, s| most.max((s.command - s.position).abs())),
        }
    }
}

#[cfg(test)]
mod tests;

//! Safe excitation of an axis from rest.
//!
//! Law      a ramp of the command in each direction until the axis breaks away; then steps of the command of random
//!          lengths around a slow motion back and forth, so that the direction of friction is known; then back to about
//!          the start. The commands of a leg are hold + sense (break-away +- amplitude). Outside its band the velocity
//!          selects the sign, within the band it is random. The amplitude doubles from leg to leg until the velocities
//!          fill their band
//! Reads    position since the start (inc), velocity (inc/s) of each cycle; NaN counts as 0
//! Writes   the command, -1 to 1, limited to the permitted one
//! Refuses  settings outside their range. Aborts with command 0: stuck, motion against the command, travel exceeded by
//!          more than its margin, no time left
//!
//! At a limit of the velocity it brakes, at a limit of the travel it reverses. It does not allocate and can run in a
//! cycle.

use crate::model::{ModelError, Takes, judge};
use serde::{Deserialize, Serialize};

/// Limits of an excitation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Permitted {
    /// Cycle time (s): 0.00001 to 1.
    pub cycle: f64,
    /// Interface of the drive.
    pub takes: Takes,
    /// Travel in both directions from the start (inc): 10 to 1e12.
    pub travel: f64,
    /// Distance beyond the travel at which it aborts (inc): above 0.
    pub margin: f64,
    /// Maximum velocity (inc/s): above 0.
    pub velocity: f64,
    /// Maximum command: 0.001 to 1.
    pub command: f64,
    /// Time from zero to the maximum command during the search for the break-away (s): 0.05 to 100.
    pub ramp: f64,
    /// Duration of the motion back and forth (s): 0.1 to 1000.
    pub duration: f64,
    /// Seed of the random steps.
    pub seed: u64,
}

/// Result of a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ExcitationOutput {
    /// The command, -1 to 1.
    Command(f64),
    /// The excitation has ended: the command is 0, or holds the load of a drive with effort interface.
    Done(f64),
    /// The excitation was aborted for this reason, and the command is 0.
    Aborted(Abort),
}

/// Reason for an abort.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Abort {
    /// The axis did not break away.
    #[error("the axis does not move at a command of {command}, the largest that is permitted")]
    Stuck {
        /// Maximum command.
        command: f64,
    },
    /// The axis moved against the command.
    #[error("the axis moved {moved:.0} inc against a command of {command:.3}; the same sense is expected")]
    Against {
        /// Command of the cycle.
        command: f64,
        /// Distance (inc).
        moved: f64,
    },
    /// The axis moved too far.
    #[error("the axis is {position:.0} inc from its start; within {most:.0} inc are permitted")]
    Travel {
        /// Position (inc).
        position: f64,
        /// Travel and margin (inc).
        most: f64,
    },
    /// No command is left for the excitation.
    #[error(
        "the axis needs a command of {needed:.3} to move at all; above {permitted:.3} there is nothing left to excite it with"
    )]
    NoRoom {
        /// Command at break-away.
        needed: f64,
        /// Maximum command.
        permitted: f64,
    },
}

/// Distributes the bits of small seeds.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Fraction of the travel beyond which it reverses.
const TURN: f64 = 0.6;

/// Fraction of the travel beyond which outward motion is braked.
const BRAKE_ZONE: f64 = 0.8;

/// Band of velocities of a leg, as fractions of the permitted one: it accelerates below and decelerates above.
const BAND: (f64, f64) = (0.2, 0.7);

/// Fraction of the permitted velocity at which it brakes with the maximum command.
const BRAKE: f64 = 0.95;

/// Maximum duration of a command step (cycles), a power of 2.
const LONGEST: u64 = 8;

/// Fraction of the permitted command for the first leg.
const FIRST: f64 = 1.0 / 16.0;

/// Minimum fraction of the permitted command that must be left above the break-away.
const MIN_EXCITATION: f64 = 0.1;

/// Fraction of the travel within which it counts as back at the start.
const START_ZONE: f64 = 0.05;

/// Maximum time for the return, as a multiple of the duration.
const WAY_BACK: f64 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Searches for the break-away in one direction, from a position and with a command.
    Ramp {
        sense: f64,
        level: f64,
        from: f64,
    },
    /// Brings the axis to rest.
    Rest {
        level: f64,
    },
    Legs {
        left: u32,
    },
    Back {
        left: u32,
    },
    Over(ExcitationOutput),
}

/// State of an excitation between two cycles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Excitation {
    permitted: Permitted,
    phase: Phase,
    /// Commands at which it broke away.
    up: f64,
    down: f64,
    sense: f64,
    amplitude: f64,
    /// Largest velocity of this leg (inc/s).
    fastest: f64,
    /// Sign of the command step, and its remaining cycles.
    bit: f64,
    lasts: u64,
    random: u64,
}

impl Excitation {
    /// Creates an excitation at rest, before the first cycle.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(permitted: Permitted) -> Result<Self, ModelError> {
        let p = &permitted;
        judge("cycle", p.cycle, "s", 1e-5, 1.0)?;
        judge("travel", p.travel, "inc", 10.0, 1e12)?;
        judge("margin", p.margin, "inc", 1e-3, 1e12)?;
        judge("velocity", p.velocity, "inc/s", 1e-3, 1e12)?;
        judge("command", p.command, "", 1e-3, 1.0)?;
        judge("ramp", p.ramp, "s", 0.05, 100.0)?;
        judge("duration", p.duration, "s", 0.1, 1000.0)?;
        Ok(Self {
            permitted,
            phase: Phase::Ramp { sense: 1.0, level: 0.0, from: 0.0 },
            up: 0.0,
            down: 0.0,
            sense: 1.0,
            amplitude: 0.0,
            fastest: 0.0,
            bit: 1.0,
            lasts: 0,
            // 0 would stay 0.
            random: (permitted.seed ^ SEED).max(1),
        })
    }

    /// Executes one cycle, with the position since the start (inc) and the velocity (inc/s).
    pub fn next(&mut self, position: f64, velocity: f64) -> ExcitationOutput {
        let number = |value: f64| if value.is_finite() { value } else { 0.0 };
        let (position, velocity) = (number(position), number(velocity));
        let most = self.permitted.travel + self.permitted.margin;
        if position.abs() > most && !matches!(self.phase, Phase::Over(_)) {
            return self.abort(Abort::Travel { position, most });
        }
        match self.phase {
            Phase::Ramp { sense, level, from } => self.ramp(sense, level, from, position),
            Phase::Rest { level } => self.rest(level, position, velocity),
            Phase::Legs { left } => self.leg(left, position, velocity),
            Phase::Back { left } => self.back(left, position, velocity),
            Phase::Over(drive) => drive,
        }
    }

    /// Returns the commands at which the axis broke away in positive and in negative direction; 0 before that.
    pub fn break_away(&self) -> (f64, f64) {
        (self.up, self.down)
    }

    /// Returns the completed fraction, 0 to 1.
    pub fn progress(&self) -> f64 {
        match self.phase {
            Phase::Ramp { sense, level, .. } => {
                let part = (0.1 * sense * level / self.permitted.command).max(0.0);
                if sense > 0.0 { part } else { 0.1 + part }
            }
            Phase::Rest { .. } => 0.1,
            Phase::Legs { left } => {
                0.2 + 0.7 * (1.0 - (f64::from(left) * self.permitted.cycle / self.permitted.duration).min(1.0))
            }
            Phase::Back { .. } => 0.9,
            Phase::Over(_) => 1.0,
        }
    }

    fn abort(&mut self, abort: Abort) -> ExcitationOutput {
        self.phase = Phase::Over(ExcitationOutput::Aborted(abort));
        ExcitationOutput::Aborted(abort)
    }

    /// Returns the distance that counts as motion instead of rounding (inc).
    fn motion_threshold(&self) -> f64 {
        (0.02 * self.permitted.travel).clamp(3.0, 50.0)
    }

    fn cycles(&self, time: f64) -> u32 {
        // The cast saturates.
        (time / self.permitted.cycle) as u32
    }

    fn ramp(&mut self, sense: f64, level: f64, from: f64, position: f64) -> ExcitationOutput {
        let p = self.permitted;
        let moved = sense * (position - from);
        if moved >= self.motion_threshold() {
            return self.broke_away(sense, level);
        }
        // A load that falls while the command is still small is no wrong direction; half of the travel is.
        if moved < -0.5 * p.travel {
            return self.abort(Abort::Against { command: level, moved: -moved });
        }
        if sense * level >= p.command {
            return match moved < -self.motion_threshold() {
                true => self.abort(Abort::Against { command: level, moved: -moved }),
                false => self.abort(Abort::Stuck { command: p.command }),
            };
        }
        let level = self.within(level + sense * p.command * p.cycle / p.ramp);
        self.phase = Phase::Ramp { sense, level, from };
        ExcitationOutput::Command(level)
    }

    fn broke_away(&mut self, sense: f64, level: f64) -> ExcitationOutput {
        if sense > 0.0 {
            self.up = level;
            self.phase = Phase::Rest { level };
            return ExcitationOutput::Command(level);
        }
        self.down = level;
        let (needed, permitted) = (self.needed(), self.permitted.command);
        if self.permitted.takes == Takes::Effort && permitted - needed < MIN_EXCITATION * permitted {
            return self.abort(Abort::NoRoom { needed, permitted });
        }
        self.amplitude = FIRST * permitted;
        self.sense = 1.0;
        self.phase = Phase::Legs { left: self.cycles(self.permitted.duration) };
        self.command(0.0)
    }

    /// Reduces the command until the axis rests, and no further, because a load would move it.
    fn rest(&mut self, level: f64, position: f64, velocity: f64) -> ExcitationOutput {
        let p = self.permitted;
        let level = self.within(level - 2.0 * p.command * p.cycle / p.ramp);
        let is_over = velocity <= 1e-3 * p.velocity || level <= -p.command;
        self.phase = if is_over { Phase::Ramp { sense: -1.0, level, from: position } } else { Phase::Rest { level } };
        ExcitationOutput::Command(level)
    }

    fn within(&self, command: f64) -> f64 {
        command.min(self.permitted.command).max(-self.permitted.command)
    }

    /// Returns the largest command at a break-away.
    fn needed(&self) -> f64 {
        self.up.max(-self.down)
    }

    /// Returns the command that holds a load: the mean of the two that move it. A velocity drive holds it itself.
    fn holding_command(&self) -> f64 {
        match self.permitted.takes {
            Takes::Velocity => 0.0,
            Takes::Effort => 0.5 * (self.up + self.down),
        }
    }

    /// Returns the command, in addition to the holding one, that moves the axis slowly in the direction of this leg.
    fn friction(&self) -> f64 {
        let friction = 0.5 * (self.up - self.down);
        match self.permitted.takes {
            // A velocity begins beyond the dead band, with the first step.
            Takes::Velocity => friction + self.amplitude,
            Takes::Effort => friction,
        }
    }

    /// Returns hold + sense (friction + `shake` amplitude), limited to the permitted command.
    fn command(&self, shake: f64) -> ExcitationOutput {
        ExcitationOutput::Command(
            self.within(self.holding_command() + self.sense * (self.friction() + shake * self.amplitude)),
        )
    }

    /// Returns the command against a motion at that fraction of the permitted velocity: half of the permitted command
    /// at 1 and above, or 0 if the drive brakes.
    fn brake(&self, part: f64) -> ExcitationOutput {
        match self.permitted.takes {
            Takes::Velocity => ExcitationOutput::Command(0.0),
            Takes::Effort => ExcitationOutput::Command(
                self.within(self.holding_command() - 0.5 * part.clamp(-1.0, 1.0) * self.permitted.command),
            ),
        }
    }

    fn leg(&mut self, left: u32, position: f64, velocity: f64) -> ExcitationOutput {
        let p = self.permitted;
        let Some(left) = left.checked_sub(1) else {
            // The return needs no excitation.
            self.amplitude = self.amplitude.min(FIRST * p.command);
            return self.back(self.cycles(WAY_BACK * p.duration), position, velocity);
        };
        self.phase = Phase::Legs { left };
        self.fastest = self.fastest.max(velocity.abs());
        if position * self.sense > TURN * p.travel {
            self.turn();
        }
        // It also brakes if a reversal takes too long.
        let is_late = position.abs() > BRAKE_ZONE * p.travel && velocity * position > 0.0;
        if is_late || velocity.abs() > BRAKE * p.velocity {
            return self.brake(velocity.signum());
        }
        let bit = self.random_step();
        let along = velocity * self.sense / p.velocity;
        let shake = if along < BAND.0 {
            1.0
        } else if along > BAND.1 {
            -1.0
        } else {
            bit
        };
        self.command(shake)
    }

    fn turn(&mut self) {
        self.sense = -self.sense;
        let most = match self.permitted.takes {
            Takes::Velocity => 0.5 * self.permitted.command,
            Takes::Effort => self.permitted.command - self.needed(),
        };
        if self.fastest < BAND.1 * self.permitted.velocity {
            self.amplitude = (2.0 * self.amplitude).min(most);
        } else if self.fastest > BRAKE * self.permitted.velocity {
            self.amplitude *= 0.5;
        }
        self.fastest = 0.0;
    }

    /// Returns +1 or -1 for a random number of cycles.
    fn random_step(&mut self) -> f64 {
        match self.lasts.checked_sub(1) {
            Some(lasts) => self.lasts = lasts,
            None => {
                self.random ^= self.random.wrapping_shl(13);
                self.random ^= self.random.wrapping_shr(7);
                self.random ^= self.random.wrapping_shl(17);
                // The high bits of this generator are the better ones.
                self.bit = if self.random >> 63 == 1 { 1.0 } else { -1.0 };
                self.lasts = (self.random >> 40) & (LONGEST - 1);
            }
        }
        self.bit
    }

    fn back(&mut self, left: u32, position: f64, velocity: f64) -> ExcitationOutput {
        let p = self.permitted;
        let is_home = position.abs() <= START_ZONE * p.travel && velocity.abs() < 0.1 * p.velocity;
        let Some(left) = left.checked_sub(1).filter(|_| !is_home) else {
            self.phase = Phase::Over(ExcitationOutput::Done(self.holding_command()));
            return ExcitationOutput::Done(self.holding_command());
        };
        self.phase = Phase::Back { left };
        self.sense = -position.signum();
        // The nearer the slower, but fast enough to arrive.
        let wanted = (0.5 * position.abs() / (TURN * p.travel)).clamp(0.06, 0.4);
        let along = velocity * self.sense / p.velocity;
        if along > 3.0 * wanted || along < -0.1 {
            // In proportion to the velocity: an axis of little inertia would be thrown back otherwise.
            return self.brake(velocity / p.velocity);
        }
        self.command(if along < wanted { 1.0 } else { -1.0 })
    }
}

#[cfg(test)]
mod tests;

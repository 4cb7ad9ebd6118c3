//! A safe excitation of an axis from rest.
//!
//! Law      a ramp of the command in each sense until the axis breaks away; then steps of the command of random lengths around a slow
//!          motion to and fro, so that the sense of friction is known; then back to about the start. The commands of a
//!          leg are hold + sense (break-away +- amplitude); a velocity outside its band decides which, chance inside of it. The
//!          amplitude doubles from leg to leg until the velocities fill their band
//! Reads    position since the start (inc), velocity (inc/s) of each cycle; NaN counts as 0
//! Writes   the command, -1 to 1, within the permitted one
//! Refuses  settings beyond their range. Aborts with 0: stuck, against the command, beyond the travel by more than
//!          its margin, no time left
//!
//! At a bound of the velocity it brakes, at a bound of the travel it turns. It takes no memory and runs in a cycle.

use crate::model::{ModelError, Takes, judge};
use serde::{Deserialize, Serialize};

/// What an excitation may do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Permitted {
    /// Of the machine (s): 0.00001 to 1.
    pub cycle: f64,
    /// What the drive takes.
    pub takes: Takes,
    /// Either way from the start (inc): 10 to 1e12.
    pub travel: f64,
    /// Beyond the travel, before it aborts (inc): above 0.
    pub margin: f64,
    /// Largest velocity (inc/s): above 0.
    pub velocity: f64,
    /// Largest command: 0.001 to 1.
    pub command: f64,
    /// Time from nothing to the largest command while it looks for the break-away (s): 0.05 to 100.
    pub ramp: f64,
    /// Time of the motion to and fro (s): 0.1 to 1000.
    pub duration: f64,
    /// Of the random steps.
    pub seed: u64,
}

/// What to do in this cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Drive {
    /// The command, -1 to 1.
    Command(f64),
    /// It is over: the command is 0, or what holds the load where the drive takes efforts.
    Done(f64),
    /// It is over, the command is 0, and this is why.
    Aborted(Abort),
}

/// Why an excitation ended early.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Abort {
    /// Nothing broke away.
    #[error("the axis does not move at a command of {command}, the largest that is permitted")]
    Stuck {
        /// The largest one.
        command: f64,
    },
    /// It went the other way.
    #[error("the axis moved {moved:.0} inc against a command of {command:.3}; the same sense is expected")]
    Against {
        /// Of the cycle.
        command: f64,
        /// inc
        moved: f64,
    },
    /// It went too far.
    #[error("the axis is {position:.0} inc from its start; within {most:.0} inc are permitted")]
    Travel {
        /// inc
        position: f64,
        /// Travel and margin (inc).
        most: f64,
    },
    /// Nothing is left to shake it with.
    #[error(
        "the axis needs a command of {needed:.3} to move at all; above {permitted:.3} there is nothing left to excite it with"
    )]
    NoRoom {
        /// At break-away.
        needed: f64,
        /// The largest one.
        permitted: f64,
    },
}

/// Makes of small seeds numbers with bits at all places.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Part of the travel within which it turns of its own accord.
const TURN: f64 = 0.6;

/// Part of it from which on what still goes outwards is braked.
const LATE: f64 = 0.8;

/// Band of velocities of a leg, in parts of the permitted one: it accelerates below, slows down above.
const BAND: (f64, f64) = (0.2, 0.7);

/// Part of the permitted velocity at which it brakes with all it may.
const BRAKE: f64 = 0.95;

/// Longest step of the command (cycles), a power of 2.
const LONGEST: u64 = 8;

/// Part of the permitted command with which the first leg is excited.
const FIRST: f64 = 1.0 / 16.0;

/// Least part of it that has to be left beside the break-away.
const ROOM: f64 = 0.1;

/// Part of the travel from the start within which it is back.
const HOME: f64 = 0.05;

/// Longest time for the way back, in parts of the duration.
const WAY_BACK: f64 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Looks for the break-away in one sense, from a position and with a command.
    Ramp {
        sense: f64,
        level: f64,
        from: f64,
    },
    /// Lets the axis come to rest.
    Rest {
        level: f64,
    },
    Legs {
        left: u32,
    },
    Back {
        left: u32,
    },
    Over(Drive),
}

/// An excitation between two cycles.
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
    /// Of the step of the command, and how many cycles it lasts yet.
    bit: f64,
    lasts: u64,
    random: u64,
}

impl Excitation {
    /// At rest, before the first cycle.
    ///
    /// # Errors
    /// A setting beyond its range.
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

    /// One cycle, with the position since the start (inc) and the velocity (inc/s).
    pub fn next(&mut self, position: f64, velocity: f64) -> Drive {
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

    /// Command at which the axis broke away upwards and downwards; 0 before that.
    pub fn break_away(&self) -> (f64, f64) {
        (self.up, self.down)
    }

    /// Part of it that is over, 0 to 1.
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

    fn abort(&mut self, abort: Abort) -> Drive {
        self.phase = Phase::Over(Drive::Aborted(abort));
        Drive::Aborted(abort)
    }

    /// Way that is a motion, no rounding (inc).
    fn some_way(&self) -> f64 {
        (0.02 * self.permitted.travel).clamp(3.0, 50.0)
    }

    fn cycles(&self, time: f64) -> u32 {
        // Saturates.
        (time / self.permitted.cycle) as u32
    }

    fn ramp(&mut self, sense: f64, level: f64, from: f64, position: f64) -> Drive {
        let p = self.permitted;
        let moved = sense * (position - from);
        if moved >= self.some_way() {
            return self.broke_away(sense, level);
        }
        // A load that falls while the command is small yet is no wrong sense; all of half the travel is.
        if moved < -0.5 * p.travel {
            return self.abort(Abort::Against { command: level, moved: -moved });
        }
        if sense * level >= p.command {
            return match moved < -self.some_way() {
                true => self.abort(Abort::Against { command: level, moved: -moved }),
                false => self.abort(Abort::Stuck { command: p.command }),
            };
        }
        let level = self.within(level + sense * p.command * p.cycle / p.ramp);
        self.phase = Phase::Ramp { sense, level, from };
        Drive::Command(level)
    }

    fn broke_away(&mut self, sense: f64, level: f64) -> Drive {
        if sense > 0.0 {
            self.up = level;
            self.phase = Phase::Rest { level };
            return Drive::Command(level);
        }
        self.down = level;
        let (needed, permitted) = (self.needed(), self.permitted.command);
        if self.permitted.takes == Takes::Effort && permitted - needed < ROOM * permitted {
            return self.abort(Abort::NoRoom { needed, permitted });
        }
        self.amplitude = FIRST * permitted;
        self.sense = 1.0;
        self.phase = Phase::Legs { left: self.cycles(self.permitted.duration) };
        self.command(0.0)
    }

    /// The command falls until the axis stands, and no farther: a load would take it along.
    fn rest(&mut self, level: f64, position: f64, velocity: f64) -> Drive {
        let p = self.permitted;
        let level = self.within(level - 2.0 * p.command * p.cycle / p.ramp);
        let is_over = velocity <= 1e-3 * p.velocity || level <= -p.command;
        self.phase = if is_over { Phase::Ramp { sense: -1.0, level, from: position } } else { Phase::Rest { level } };
        Drive::Command(level)
    }

    fn within(&self, command: f64) -> f64 {
        command.min(self.permitted.command).max(-self.permitted.command)
    }

    /// Largest command at a break-away.
    fn needed(&self) -> f64 {
        self.up.max(-self.down)
    }

    /// What holds a load: half way between the two that move it. A drive of velocities holds it by itself.
    fn hold(&self) -> f64 {
        match self.permitted.takes {
            Takes::Velocity => 0.0,
            Takes::Effort => 0.5 * (self.up + self.down),
        }
    }

    /// What moves it slowly in the sense of this leg, beyond what holds it.
    fn friction(&self) -> f64 {
        let friction = 0.5 * (self.up - self.down);
        match self.permitted.takes {
            // A velocity begins beyond its dead band, and with the first step.
            Takes::Velocity => friction + self.amplitude,
            Takes::Effort => friction,
        }
    }

    /// hold + sense (friction + `shake` amplitude), as far as it is permitted.
    fn command(&self, shake: f64) -> Drive {
        Drive::Command(self.within(self.hold() + self.sense * (self.friction() + shake * self.amplitude)))
    }

    /// Against a motion of so many parts of the permitted velocity, with half of what is permitted at 1 and beyond; with 0 where
    /// the drive brakes.
    fn brake(&self, part: f64) -> Drive {
        match self.permitted.takes {
            Takes::Velocity => Drive::Command(0.0),
            Takes::Effort => {
                Drive::Command(self.within(self.hold() - 0.5 * part.clamp(-1.0, 1.0) * self.permitted.command))
            }
        }
    }

    fn leg(&mut self, left: u32, position: f64, velocity: f64) -> Drive {
        let p = self.permitted;
        let Some(left) = left.checked_sub(1) else {
            // On its way back nothing has to be shaken any more.
            self.amplitude = self.amplitude.min(FIRST * p.command);
            return self.back(self.cycles(WAY_BACK * p.duration), position, velocity);
        };
        self.phase = Phase::Legs { left };
        self.fastest = self.fastest.max(velocity.abs());
        if position * self.sense > TURN * p.travel {
            self.turn();
        }
        // A turn that takes too long brakes as well.
        let is_late = position.abs() > LATE * p.travel && velocity * position > 0.0;
        if is_late || velocity.abs() > BRAKE * p.velocity {
            return self.brake(velocity.signum());
        }
        let bit = self.step_of_chance();
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

    /// +1 or -1 for a random number of cycles.
    fn step_of_chance(&mut self) -> f64 {
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

    fn back(&mut self, left: u32, position: f64, velocity: f64) -> Drive {
        let p = self.permitted;
        let is_home = position.abs() <= HOME * p.travel && velocity.abs() < 0.1 * p.velocity;
        let Some(left) = left.checked_sub(1).filter(|_| !is_home) else {
            self.phase = Phase::Over(Drive::Done(self.hold()));
            return Drive::Done(self.hold());
        };
        self.phase = Phase::Back { left };
        self.sense = -position.signum();
        // The nearer, the slower; fast enough to get there.
        let wanted = (0.5 * position.abs() / (TURN * p.travel)).clamp(0.06, 0.4);
        let along = velocity * self.sense / p.velocity;
        if along > 3.0 * wanted || along < -0.1 {
            // No more than the motion asks for: an axis of little inertia would be thrown back.
            return self.brake(velocity / p.velocity);
        }
        self.command(if along < wanted { 1.0 } else { -1.0 })
    }
}

#[cfg(test)]
mod tests;

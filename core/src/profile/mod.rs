//! Profiles: how a command position gets to a target or a velocity in time.
//!
//! A profile is planned once, from the motion at t_k, as a few phases of constant acceleration in continuous time, and then
//! read at each cycle; it is not stretched to the grid. Each phase runs in f64 relative to its own start or end,
//! whichever is nearer, so that the target is met exactly however far it is.

mod trapezoid;

pub use trapezoid::{Limits, stop, stop_at, to_rest, to_velocity};

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Position, velocity and acceleration at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// (inc)
    pub position: Position,
    /// (inc/s)
    pub velocity: f64,
    /// (inc/s^2)
    pub acceleration: f64,
    /// (inc/s^3)
    pub jerk: f64,
}

impl Motion {
    /// At rest.
    pub fn at_rest(position: Position) -> Self {
        Self { position, ..Self::default() }
    }
}

/// A span of constant acceleration.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Phase {
    start: Position,
    end: Position,
    start_velocity: f64,
    end_velocity: f64,
    acceleration: f64,
    /// (s) from the start of the plan.
    begin: f64,
    /// (s)
    duration: f64,
}

impl Phase {
    fn at(&self, time: f64) -> Motion {
        let past = time - self.begin;
        let left = self.duration - past;
        let (position, velocity) = if past <= left {
            let way = self.start_velocity * past + 0.5 * self.acceleration * past * past;
            (self.start + Position::from_f64(way), self.start_velocity + self.acceleration * past)
        } else {
            let way = self.end_velocity * left - 0.5 * self.acceleration * left * left;
            (self.end - Position::from_f64(way), self.end_velocity - self.acceleration * left)
        };
        Motion { position, velocity, acceleration: self.acceleration, jerk: 0.0 }
    }
}

/// The first cycle at or after `duration` (s). A millionth of a cycle is rounding, not time.
fn cycles(duration: f64, cycle_ns: u64) -> u64 {
    let exact = duration * 1e9 / cycle_ns as f64;
    let nearest = exact.round();
    // The cast saturates; a duration is never negative.
    (if (exact - nearest).abs() < 1e-6 { nearest } else { exact.ceil() }) as u64
}

/// Most phases that a trapezoid has: slow down or turn, speed up, cruise, slow down.
const MAX_PHASES: usize = 4;

/// A planned profile, read by elapsed cycles.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Plan {
    phases: [Phase; MAX_PHASES],
    count: usize,
    /// Where it ends, and with which velocity it goes on.
    end: Position,
    end_velocity: f64,
    /// (s)
    duration: f64,
    cycles: u64,
    cycle_ns: u64,
}

impl Plan {
    fn new(start: Motion, cycle_ns: u64) -> Self {
        Self {
            phases: [Phase::default(); MAX_PHASES],
            count: 0,
            end: start.position,
            end_velocity: start.velocity,
            duration: 0.0,
            cycles: 0,
            cycle_ns,
        }
    }

    /// Adds a phase to `velocity`; one without duration is left out.
    fn push(&mut self, duration: f64, velocity: f64) {
        if duration > 0.0 && self.count < MAX_PHASES {
            let way = 0.5 * (self.end_velocity + velocity) * duration;
            let end = self.end + Position::from_f64(way);
            self.phases[self.count] = Phase {
                start: self.end,
                end,
                start_velocity: self.end_velocity,
                end_velocity: velocity,
                acceleration: (velocity - self.end_velocity) / duration,
                begin: self.duration,
                duration,
            };
            self.count += 1;
            self.end = end;
            self.duration += duration;
            self.cycles = cycles(self.duration, self.cycle_ns);
        }
        self.end_velocity = velocity;
    }

    /// Lets the last phase end exactly at `target`, and what stands before it a cruise end where it begins.
    fn land(&mut self, target: Position) {
        let shift = target - self.end;
        if let Some(last) = self.phases[..self.count].last_mut() {
            last.start += shift;
            last.end = target;
        }
        if let [.., cruise, _] = &mut self.phases[..self.count] {
            cruise.end += shift;
        }
        self.end = target;
    }

    /// Where it ends.
    pub fn end(&self) -> Position {
        self.end
    }

    /// The velocity with which it ends (inc/s); 0 for a plan to rest.
    pub fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// Its duration (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Could it have been planned? One that was read from outside may hold anything.
    pub fn is_sound(&self) -> bool {
        self.count <= MAX_PHASES
    }

    /// Number of the first cycle at or after its end.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// The motion `elapsed` cycles after the start.
    pub fn at(&self, elapsed: u64) -> Motion {
        // Exact below 2^53 ns, and correctly rounded by the one division.
        let time = elapsed.saturating_mul(self.cycle_ns) as f64 / 1e9;
        if elapsed >= self.cycles() {
            let over = self.end_velocity * (time - self.duration).max(0.0);
            let position = self.end + Position::from_f64(over);
            return Motion { position, velocity: self.end_velocity, acceleration: 0.0, jerk: 0.0 };
        }
        let phases = &self.phases[..self.count];
        phases.iter().rev().find(|phase| phase.begin <= time).map_or(Motion::at_rest(self.end), |phase| phase.at(time))
    }

    /// Lowest and highest position from `now` to its end: its way, or the turn that still lies ahead.
    pub fn extent_from(&self, now: Position) -> (Position, Position) {
        let (low, high) = self.extent();
        let first = self.phases[..self.count].first();
        let start = first.map_or(self.end, |phase| phase.start);
        // Between its start and now it may have passed places that it will not see again; keeping them errs on the safe side
        // only where it turns, and there they still lie ahead.
        let low = if low == start { now.min(self.end) } else { low };
        let high = if high == start { now.max(self.end) } else { high };
        (low, high)
    }

    /// Lowest and highest position on the way; for a plan to rest.
    pub fn extent(&self) -> (Position, Position) {
        self.phases[..self.count]
            .iter()
            .flat_map(|phase| [phase.start, phase.end])
            .fold((self.end, self.end), |(low, high), position| (low.min(position), high.max(position)))
    }
}

#[cfg(test)]
mod tests;

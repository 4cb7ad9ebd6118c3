//! The filter of a master's velocity (SYNCVFTIME), which owes nothing in the long run.
//!
//! Law      velocity(k) = velocity(k-1) + (change(k) - velocity(k-1)) T / tau, in inc per cycle, at most at once. Where positions are kept, what
//!          it holds back is owed, to 2^-32 inc, and T / (10 tau) of that is given in each cycle, so that no increment is lost.
//!          Owed beyond a limit, tau falls by T a cycle, not below 5 ms; below a fifth of the limit it grows back as slowly. What is owed is
//!          judged by what a filter would owe that has kept its tau
//!          A coupling by marks owes nothing, as the marks take the difference out: what is held back is added up for the limit alone, anew every tau,
//!          and the filter comes back behind a tau that has stayed below it
//! Reads    the master's change, as it comes
//! Writes   the change that a gear is given
//! Refuses  nothing: what tau may be is up to its parameter
//! Source   MACS-SYNC-08, MACS-SYNC-09, MACS-SYNC-11, A-31, A-32, A-58

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// The least tau to which a limit takes it (us).
const LEAST_TAU: f64 = 5_000.0;
/// So many times slower than the velocity comes what is owed.
const OWED_SLOWNESS: f64 = 10.0;
/// The share of the limit below which the filter comes back.
const CALM_SHARE: f64 = 0.2;
/// A master whose velocity is so near (inc per cycle) has that velocity.
const SETTLED: f64 = 1.0 / (1_u64 << 31) as f64;

/// What is kept between master and slave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keeps {
    /// Their velocities alone.
    Velocity,
    /// Their positions: what is held back is owed.
    Position,
    /// Their marks.
    Marks,
}

/// How a master is filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filtering {
    /// (us)
    pub tau: f64,
    /// What it is for.
    pub keeps: Keeps,
    /// What may be owed before it becomes faster (inc); 0: anything.
    pub limit: f64,
}

/// A first-order filter, and what it owes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Lag {
    /// (inc per cycle)
    velocity: f64,
    owed: Position,
}

impl Lag {
    /// Takes a change with `tau` in cycles, and gives the one to follow.
    fn step(&mut self, change: Position, tau: f64, keeps: bool) -> Position {
        let act = change.to_f64();
        self.velocity += (act - self.velocity) * share(1.0 / tau);
        if (act - self.velocity).abs() < SETTLED {
            self.velocity = act;
        }
        let given = Position::from_f64(self.velocity);
        if !keeps {
            self.owed = Position::ZERO;
            return given;
        }
        self.owed += change - given;
        let mut back = Position::from_f64(self.owed.to_f64() * share(1.0 / (OWED_SLOWNESS * tau)));
        if back == Position::ZERO {
            // The last of it is less than the share can tell.
            back = Position::from_raw(self.owed.raw().signum());
        }
        self.owed = self.owed - back;
        given + back
    }
}

/// A share of at most all; NaN is nothing.
fn share(of: f64) -> f64 {
    of.clamp(0.0, 1.0)
}

/// The filter of one master.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MasterFilter {
    lag: Lag,
    /// What its limit is judged by while its tau is another one.
    kept: Lag,
    /// How much its tau has fallen (us).
    fallen: f64,
    /// Of a coupling by marks: how long what it holds back was added up (us), and whether it was beyond the limit since.
    since: f64,
    exceeded: bool,
    /// It comes back.
    returns: bool,
}

impl MasterFilter {
    /// One that has settled on a velocity (inc per cycle).
    pub fn settled(velocity: f64) -> Self {
        let velocity = if velocity.is_finite() { velocity } else { 0.0 };
        let lag = Lag { velocity, owed: Position::ZERO };
        Self { lag, kept: lag, ..Self::default() }
    }

    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        [self.lag.velocity, self.kept.velocity, self.fallen, self.since].iter().all(|number| number.is_finite())
            && self.fallen >= 0.0
    }

    /// What it holds back (inc).
    pub fn owed(&self) -> Position {
        self.lag.owed
    }

    /// What one that kept its tau would hold back (inc): PFG_MFILTERERROR.
    pub fn error(&self) -> Position {
        self.kept.owed
    }

    /// The tau in force (us).
    pub fn tau(&self, filtering: &Filtering) -> f64 {
        (filtering.tau - self.fallen).max(LEAST_TAU.min(filtering.tau))
    }

    /// By how much less uneven the counts of a master are behind it.
    pub fn smooths(&self, filtering: &Filtering, cycle_us: f64) -> f64 {
        share(cycle_us / self.tau(filtering))
    }

    /// Takes the master's change, and gives the one to follow.
    pub fn step(&mut self, change: Position, filtering: &Filtering, cycle_us: f64) -> Position {
        let tau = self.tau(filtering);
        let given = self.lag.step(change, tau / cycle_us, filtering.keeps == Keeps::Position);
        if filtering.keeps == Keeps::Marks && filtering.limit > 0.0 {
            self.watch_marks(change - given, filtering, cycle_us);
            return given;
        }
        if filtering.keeps != Keeps::Position || filtering.limit <= 0.0 {
            (self.kept, self.fallen) = (self.lag, 0.0);
            return given;
        }
        if self.fallen == 0.0 {
            self.kept = self.lag;
        } else {
            self.kept.step(change, filtering.tau / cycle_us, true);
        }
        let owed = self.kept.owed.to_f64().abs();
        let most = (filtering.tau - LEAST_TAU).max(0.0);
        if owed > filtering.limit {
            self.fallen = (self.fallen + cycle_us).min(most);
        } else if owed < filtering.limit * CALM_SHARE {
            self.fallen = (self.fallen - cycle_us).max(0.0);
        }
        given
    }

    /// Adds up what is held back, and judges the tau by it.
    fn watch_marks(&mut self, held_back: Position, filtering: &Filtering, cycle_us: f64) {
        self.kept.owed += held_back;
        let most = (filtering.tau - LEAST_TAU).max(0.0);
        if self.kept.owed.to_f64().abs() > filtering.limit {
            (self.exceeded, self.returns) = (true, false);
            self.fallen = (self.fallen + cycle_us).min(most);
        } else if self.returns {
            self.fallen = (self.fallen - cycle_us).max(0.0);
        }
        self.since += cycle_us;
        if self.since >= filtering.tau {
            self.returns = !self.exceeded;
            (self.kept.owed, self.since, self.exceeded) = (Position::ZERO, 0.0, false);
        }
    }
}

#[cfg(test)]
mod tests;

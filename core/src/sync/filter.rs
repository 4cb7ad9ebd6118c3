//! The filter of the velocity of a master (SYNCVFTIME), which loses no distance in the long run.
//!
//! Law      velocity(k) = velocity(k-1) + (change(k) - velocity(k-1)) T / tau, in inc per cycle, with T / tau limited
//!          to 1. If positions are kept, the distance that the filter holds back is owed, to 2^-32 inc, and T / (10
//!          tau) of it is given back in each cycle, so that no increment is lost.
//!          While more than a limit is owed, tau decreases by T per cycle, at least to 5 ms; while less than a fifth of
//!          the limit is owed, it increases at the same rate. For this comparison the owed distance is that of a filter
//!          with unchanged tau.
//!          A coupling by marks owes nothing, as the marks correct the difference. The distance held back is summed
//!          only for the limit, again for each tau, and tau increases after a period of tau in which the sum has stayed
//!          below the limit
//! Reads    the change of the master
//! Writes   the change for the gear
//! Refuses  nothing: the parameter limits tau
//! Source   MACS-SYNC-08, MACS-SYNC-09, MACS-SYNC-11, A-31, A-32, A-58

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Smallest tau to which the limit reduces it (us).
const LEAST_TAU: f64 = 5_000.0;
/// Factor by which the owed distance is given back more slowly than the velocity is filtered.
const OWED_SLOWNESS: f64 = 10.0;
/// Share of the limit below which tau increases again.
const CALM_SHARE: f64 = 0.2;
/// Difference (inc per cycle) below which the velocity is that of the master.
const SETTLED: f64 = 1.0 / (1_u64 << 31) as f64;

/// Relation between master and slave that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keeps {
    /// Only their velocities.
    Velocity,
    /// Their positions: the distance held back is owed.
    Position,
    /// Their marks.
    Marks,
}

/// Settings of the filter of a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filtering {
    /// Time constant (us).
    pub tau: f64,
    /// Relation that is kept.
    pub keeps: Keeps,
    /// Largest owed distance before the filter becomes faster (inc); 0: no limit.
    pub limit: f64,
}

/// A first-order filter, and its owed distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Lag {
    /// Filtered velocity (inc per cycle).
    velocity: f64,
    owed: Position,
}

impl Lag {
    /// Filters a change with `tau` in cycles and returns the change to follow.
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
            // The rest is too small for the share.
            back = Position::from_raw(self.owed.raw().signum());
        }
        self.owed = self.owed - back;
        given + back
    }
}

/// Limits a share to the range 0 to 1.
fn share(of: f64) -> f64 {
    of.clamp(0.0, 1.0)
}

/// The filter of one master.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MasterFilter {
    lag: Lag,
    /// Filter with unchanged tau, for the comparison with the limit while tau is reduced.
    kept: Lag,
    /// Reduction of its tau (us).
    fallen: f64,
    /// For a coupling by marks: time over which the distance held back was summed (us), and whether the sum has
    /// exceeded the limit in that time.
    since: f64,
    exceeded: bool,
    /// Whether tau increases again.
    returns: bool,
}

impl MasterFilter {
    /// Returns a filter that is settled at a velocity (inc per cycle).
    pub fn settled(velocity: f64) -> Self {
        let velocity = if velocity.is_finite() { velocity } else { 0.0 };
        let lag = Lag { velocity, owed: Position::ZERO };
        Self { lag, kept: lag, ..Self::default() }
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        [self.lag.velocity, self.kept.velocity, self.fallen, self.since].iter().all(|number| number.is_finite())
            && self.fallen >= 0.0
    }

    /// Returns the distance that it holds back (inc).
    pub fn lag_distance(&self) -> Position {
        self.lag.owed
    }

    /// Returns the distance that a filter with unchanged tau would hold back (inc): PFG_MFILTERERROR.
    pub fn error(&self) -> Position {
        self.kept.owed
    }

    /// Returns the active tau (us).
    pub fn tau(&self, filtering: &Filtering) -> f64 {
        (filtering.tau - self.fallen).max(LEAST_TAU.min(filtering.tau))
    }

    /// Returns the factor by which the filter reduces the unevenness of the counts of a master.
    pub fn smoothing_factor(&self, filtering: &Filtering, cycle_us: f64) -> f64 {
        share(cycle_us / self.tau(filtering))
    }

    /// Filters the change of the master and returns the change to follow.
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

    /// Sums the distance held back, and adapts tau to it.
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

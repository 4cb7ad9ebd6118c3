//! Motors and valves with a velocity setpoint: servo drives with a velocity loop, DC drives, pole-changing motors,
//! hydraulics.
//!
//! Law      v' = (u - v) / time_constant, u held over a cycle; solved exactly, so that no time constant makes it
//!          unstable. At u = 0 friction stops a motor that would coast by less than half a count
//! Reads    the velocity setpoint u (inc/s)
//! Writes   the velocity at the end of a cycle and the mean velocity over it (inc/s)
//! Refuses  times outside their ranges
//! Source   WF-FCE-01, WF-FCE-02

use super::ModelError;
use libm::exp;

/// Maximum time constant of a lag or of coasting (ns).
const MOST_LAG_NS: i64 = 10_000_000_000;
/// Maximum dead time (ns).
const MOST_DEAD_NS: i64 = 1_000_000_000;
/// Maximum velocity, beyond any machine (inc/s).
pub(super) const MAX_VELOCITY: f64 = 1e15;
/// Remaining coasting distance at which a motor with setpoint 0 stops (inc).
const STOP_DISTANCE: f64 = 0.5;
/// Remaining lag or lead at which a motor counts as at its setpoint (inc): one part in 2^32.
const SETPOINT_DISTANCE: f64 = 1.0 / (1_u64 << 32) as f64;

/// Returns the remaining difference to the setpoint that may be neglected, as distance (inc).
pub(super) fn negligible(setpoint: f64) -> f64 {
    if setpoint == 0.0 { STOP_DISTANCE } else { SETPOINT_DISTANCE }
}

/// A first-order lag over a fixed time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lag {
    time_constant_s: f64,
    /// Fraction of a difference that is left at the end.
    decay: f64,
    duration_s: f64,
}

impl Lag {
    pub(super) fn new(time_constant_ns: i64, duration_ns: u64) -> Self {
        let (time_constant_s, duration_s) = (time_constant_ns as f64 / 1e9, duration_ns as f64 / 1e9);
        // Without a time constant nothing is left after any time; without any time everything is left.
        let decay = if duration_ns == 0 { 1.0 } else { exp(-duration_s / time_constant_s) };
        Self { time_constant_s, decay, duration_s }
    }

    /// Moves towards a setpoint and returns the additional travel compared with the setpoint (inc).
    fn run(&self, velocity: &mut f64, setpoint: f64) -> f64 {
        let difference = *velocity - setpoint;
        *velocity = setpoint + difference * self.decay;
        difference * self.time_constant_s * (1.0 - self.decay)
    }

    /// Ends a difference that is no longer observable.
    fn settle(&self, velocity: &mut f64, setpoint: f64) {
        if (*velocity - setpoint).abs() * self.time_constant_s <= negligible(setpoint) {
            *velocity = setpoint;
        }
    }

    /// Executes one cycle at one setpoint. Returns the mean velocity (inc/s).
    pub(super) fn cycle(&self, velocity: &mut f64, setpoint: f64) -> f64 {
        let further = self.run(velocity, setpoint);
        self.settle(velocity, setpoint);
        setpoint + further / self.duration_s
    }
}

/// Checks a time constant.
///
/// # Errors
/// A time outside its range.
pub(super) fn check_lag(time_constant_ns: i64, error: fn(i64) -> ModelError) -> Result<(), ModelError> {
    if (0..=MOST_LAG_NS).contains(&time_constant_ns) { Ok(()) } else { Err(error(time_constant_ns)) }
}

/// A drive with a velocity loop: a lag to its setpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityLag {
    lag: Lag,
    /// Whether it turns against its setpoint.
    pub(super) inverted: bool,
}

impl VelocityLag {
    /// Creates a lag of that time constant (ns), stepped once per cycle.
    ///
    /// # Errors
    /// A time outside its range.
    pub fn new(time_constant_ns: i64, cycle_ns: u64) -> Result<Self, ModelError> {
        check_lag(time_constant_ns, ModelError::TimeConstant)?;
        Ok(Self { lag: Lag::new(time_constant_ns, cycle_ns), inverted: false })
    }

    pub(super) fn step(&self, velocity: &mut f64, setpoint: f64) -> f64 {
        self.lag.cycle(velocity, setpoint)
    }
}

/// A pole-changing motor: a lag to the selected speed; switched off it coasts with another time constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSpeed {
    driven: Lag,
    coasting: Lag,
    /// Whether it turns against its setpoint.
    pub(super) inverted: bool,
}

impl TwoSpeed {
    /// Creates a motor with these time constants (ns), stepped once per cycle.
    ///
    /// # Errors
    /// A time outside its range.
    pub fn new(time_constant_ns: i64, coast_ns: i64, cycle_ns: u64) -> Result<Self, ModelError> {
        check_lag(time_constant_ns, ModelError::TimeConstant)?;
        check_lag(coast_ns, ModelError::Coast)?;
        let (driven, coasting) = (Lag::new(time_constant_ns, cycle_ns), Lag::new(coast_ns, cycle_ns));
        Ok(Self { driven, coasting, inverted: false })
    }

    pub(super) fn step(&self, velocity: &mut f64, setpoint: f64) -> f64 {
        let lag = if setpoint == 0.0 { &self.coasting } else { &self.driven };
        lag.cycle(velocity, setpoint)
    }
}

/// A hydraulic motor with a valve: a lag after a dead time, which need not be whole cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valve {
    /// Lag from the beginning of a cycle until a setpoint takes effect in it.
    before: Lag,
    /// The rest of the cycle.
    after: Lag,
    /// Whole cycles of the dead time.
    cycles: usize,
    cycle_s: f64,
    /// Whether it turns against its setpoint.
    pub(super) inverted: bool,
}

impl Valve {
    /// Creates a valve with that time constant and dead time (ns), stepped once per cycle.
    ///
    /// # Errors
    /// A time outside its range.
    pub fn new(time_constant_ns: i64, dead_time_ns: i64, cycle_ns: u64) -> Result<Self, ModelError> {
        check_lag(time_constant_ns, ModelError::TimeConstant)?;
        let dead_ns = u64::try_from(dead_time_ns).ok().filter(|_| dead_time_ns <= MOST_DEAD_NS);
        let dead_ns = dead_ns.ok_or(ModelError::DeadTime(dead_time_ns))?;
        let cycle_ns = cycle_ns.max(1);
        let part_ns = dead_ns % cycle_ns;
        Ok(Self {
            before: Lag::new(time_constant_ns, part_ns),
            after: Lag::new(time_constant_ns, cycle_ns - part_ns),
            cycles: (dead_ns / cycle_ns) as usize,
            cycle_s: cycle_ns as f64 / 1e9,
            inverted: false,
        })
    }

    /// Returns the number of delayed setpoints, including the newest.
    pub(super) fn delayed_setpoints(&self) -> usize {
        self.cycles + 2
    }

    /// Executes one cycle: `old` is active until the dead time of `new` has elapsed within the cycle.
    pub(super) fn step(&self, velocity: &mut f64, old: f64, new: f64) -> f64 {
        let mut further = (old - new) * self.before.duration_s;
        further += self.before.run(velocity, old);
        further += self.after.run(velocity, new);
        self.after.settle(velocity, new);
        new + further / self.cycle_s
    }
}

/// Whole counts of a motion, and the fraction of a count.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CountAccumulator {
    /// Fraction in parts of [`Self::COUNT`].
    remainder: i128,
}

impl CountAccumulator {
    /// One count: 10^9 ns at 2^32 parts of 1 inc/s.
    const COUNT: i128 = 1_000_000_000 << 32;

    /// Returns the counts of a cycle at a mean velocity (inc/s), which is rounded once to 2^-32 inc/s.
    pub(super) fn advance(&mut self, velocity: f64, cycle_ns: u64) -> i64 {
        // The cast converts NaN to 0.
        let fine = (velocity.clamp(-MAX_VELOCITY, MAX_VELOCITY) * (1_u64 << 32) as f64).round() as i128;
        let total = fine.saturating_mul(cycle_ns.into()).saturating_add(self.remainder);
        self.remainder = total.rem_euclid(Self::COUNT);
        total.div_euclid(Self::COUNT).clamp(i64::MIN.into(), i64::MAX.into()) as i64
    }
}

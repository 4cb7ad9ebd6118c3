//! Conversion of user units to the registers of the module, and back.
//!
//! Law      counts = k units; reg_v = k Veloc 65536 T; reg_a = k Accel 65536 T^2; T = 2048 / 6 MHz, one chip sample;
//!          nearest, half away from zero, in both directions
//! Reads    the present MCFac
//! Refuses  values that do not fit a register; the caller creates the message
//! Source   SAIA-SCL-01..09, A06..A08

use super::Parameters;

/// Highest count and highest register value.
pub(super) const HIGHEST: i64 = (1 << 30) - 1;
/// Lowest count.
pub(super) const LOWEST: i64 = -(1 << 30);
/// Clock of the chip (1/s).
const CLOCK: f64 = 6e6;
/// Clock ticks of one sample.
const TICKS: f64 = 2048.0;
const FRACTION: f64 = 65_536.0;
/// Duration of one sample, 2048 / 6 MHz (ns / 3).
pub(super) const SAMPLE: u64 = 1_024_000;

/// The active conversion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scaling {
    k: f64,
    legacy: bool,
}

impl Scaling {
    pub(super) fn of(parameters: &Parameters) -> Self {
        Self { k: parameters.mcfac, legacy: parameters.legacy_scaling }
    }

    /// Returns counts of a number of units.
    pub(super) fn counts(self, units: i32) -> i64 {
        whole(self.k * f64::from(units))
    }

    /// Returns the velocity register of a velocity (units/s).
    pub(super) fn velocity(self, units: i32) -> i64 {
        whole(self.exact_velocity(units))
    }

    /// Returns the velocity register before rounding.
    pub(super) fn exact_velocity(self, units: i32) -> f64 {
        self.velocity_of(self.k * f64::from(units))
    }

    /// Returns the acceleration register of an acceleration (units/s^2).
    pub(super) fn acceleration(self, units: i32) -> i64 {
        whole(self.exact_acceleration(units))
    }

    /// Returns the acceleration register before rounding.
    pub(super) fn exact_acceleration(self, units: i32) -> f64 {
        let counts = self.k * f64::from(units);
        // Products first: powers of two stay exact, and so does the limit at 2^30.
        if self.legacy { counts * 7.6206e-3 } else { counts * (FRACTION * TICKS * TICKS) / (CLOCK * CLOCK) }
    }

    fn velocity_of(self, counts: f64) -> f64 {
        if self.legacy { counts * 22.348 } else { counts * (FRACTION * TICKS) / CLOCK }
    }

    /// Returns the units of a number of counts; `None` if the register cannot hold them.
    pub(super) fn units(self, counts: i64) -> Option<i32> {
        fits(counts as f64 / self.k)
    }

    /// Returns the units per second of a velocity register.
    pub(super) fn units_of_velocity(self, register: f64) -> Option<i32> {
        fits(register / self.velocity_of(self.k))
    }
}

/// Returns the velocity of the chip for a register (inc/s).
pub(super) fn velocity_of(register: f64) -> f64 {
    register * CLOCK / (FRACTION * TICKS)
}

/// Returns the acceleration of the chip for a register (inc/s^2).
pub(super) fn acceleration_of(register: f64) -> f64 {
    register * (CLOCK * CLOCK) / (FRACTION * TICKS * TICKS)
}

/// Returns the register nearest to an acceleration (inc/s^2), at least 1.
pub(super) fn register_of_rate(acceleration: f64) -> i64 {
    whole(acceleration * (FRACTION * TICKS * TICKS) / (CLOCK * CLOCK)).clamp(1, HIGHEST)
}

/// Returns the register of a velocity (inc/s).
pub(super) fn register_of(velocity: f64) -> f64 {
    (velocity * (FRACTION * TICKS) / CLOCK).round()
}

/// Returns the whole counts per sample at a velocity (inc/s): the value of the top 14 bits of the register.
pub(super) fn counts_a_sample(velocity: f64) -> f64 {
    (velocity * TICKS / CLOCK).floor()
}

/// Returns the number of chip samples in a time; `left` is the remainder of the last one (a third of ns).
pub(super) fn samples(left: &mut u64, cycle_ns: u64) -> u64 {
    let time = left.saturating_add(cycle_ns.saturating_mul(3));
    *left = time % SAMPLE;
    time / SAMPLE
}

/// Returns the length of a cycle in chip samples, with its fraction.
pub(super) fn in_samples(cycle_ns: u64) -> f64 {
    cycle_ns.saturating_mul(3) as f64 / SAMPLE as f64
}

/// Rounds to the nearest, half away from zero; the cast saturates, and NaN becomes a value beyond every range.
fn whole(value: f64) -> i64 {
    if value.is_nan() { i64::MAX } else { value.round() as i64 }
}

fn fits(value: f64) -> Option<i32> {
    let rounded = value.round();
    (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&rounded).then_some(rounded as i32)
}

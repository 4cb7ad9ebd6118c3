//! The velocity loop of an amplifier: proportional and integral.
//!
//! Law      output = K (VELKPROP e + VELKINT SUM e), within +-1; e as a fraction of full speed, summed per ms: a cycle
//!          of T ms adds e T. |SUM e| <= VELKILIM / 50, and the sum does not grow while the output is at its limit in
//!          that direction. K = 1/100
//! Reads    the error, setpoint minus actual velocity (1 = full speed, AMPENCRPM)
//! Writes   the output (1 = full current or full voltage, depending on the inner loop)
//! Refuses  nothing: the rows of its parameters do. Negative gains are used as they are
//! Source   MACS-AMP-04, MACS-AMP-05, A-27
//!
//! A change of gains does not change the output of its sample, which uses the gains before. The integral part is
//! converted to a new sum, as far as VELKILIM allows; the rest, especially the proportional part, becomes an offset
//! that decreases to 0 at a constant rate within [`CARRY_TIME`]. If the sum contained the proportional part, the error
//! of that one moment would remain in the integral.

use super::sum::{Room, grown, measured, within};
use serde::{Deserialize, Serialize};

/// Output per full speed for one unit of VELKPROP, and of VELKINT per ms.
///
/// With VELKPROP 200 an error of half the full speed gives full output, and one quadcount per ms of the default
/// encoder, of 33.3 at full speed, gives 6 %. With VELKINT 5 the integral part is equal to the proportional one after
/// 40 ms. Both suit a drive that reaches full speed within 10 to 100 ms at full current.
pub const VELOCITY_GAIN: f64 = 1.0 / 100.0;

/// Bound of the sum for one unit of VELKILIM (ms at an error of full speed).
///
/// With VELKINT 5 and VELKILIM 1000 the integral part alone can give the full output, and no more.
pub const VELOCITY_SUM: f64 = 1.0 / 50.0;

/// Time in which the offset of a change of gains decreases to 0 (ms).
pub const CARRY_TIME: f64 = 100.0;

/// Error at which it saturates (full speeds).
const MOST_ERROR: f64 = 1e6;

/// Largest magnitude of a parameter.
const MOST: i32 = 32_767;

/// Parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VelocityGains {
    /// VELKPROP: -32767 to 32767.
    pub proportional: i32,
    /// VELKINT: -32767 to 32767.
    pub integral: i32,
    /// VELKILIM: 0 to 32767; 0 switches the integral part off.
    pub limit: i32,
    /// Time between two samples (ms), above 0 up to 1000.
    pub cycle: f64,
}

impl VelocityGains {
    /// Whether each value is within its range.
    pub fn is_sound(&self) -> bool {
        let gain = |value: i32| (-MOST..=MOST).contains(&value);
        let cycle = self.cycle > 0.0 && self.cycle <= 1000.0;
        gain(self.proportional) && gain(self.integral) && (0..=MOST).contains(&self.limit) && cycle
    }

    /// Returns the output per full speed.
    fn factor(&self) -> f64 {
        f64::from(self.proportional) * VELOCITY_GAIN
    }

    /// Returns the output per ms at full speed.
    fn output_per_ms(&self) -> f64 {
        f64::from(self.integral) * VELOCITY_GAIN
    }

    /// Returns the bound of the sum (ms).
    fn sum_bound(&self) -> f64 {
        f64::from(self.limit) * VELOCITY_SUM
    }
}

/// State of the loop between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VelocityLoop {
    /// Sum of the errors (ms at an error of full speed).
    sum: f64,
    /// Gains of the last sample; none before the first.
    gains: Option<VelocityGains>,
    /// Offset of the output after a change of gains.
    offset: f64,
    /// Rate at which the offset decreases (1/ms).
    fall: f64,
}

impl VelocityLoop {
    /// Advances by one sample and returns the output within +-1. `error` is a fraction of full speed; NaN counts as 0.
    pub fn step(&mut self, gains: &VelocityGains, error: f64) -> f64 {
        self.step_within(gains, error, 1.0)
    }

    /// As [`step`](Self::step), within +-`most`, 0 to 1: the excess does not enter the sum either.
    pub fn step_within(&mut self, gains: &VelocityGains, error: f64, most: f64) -> f64 {
        let error = measured(error, MOST_ERROR);
        let most = measured(most, 1.0).max(0.0);
        let fallen = self.fall * gains.cycle;
        self.offset -= within(self.offset, fallen);
        match self.gains {
            Some(before) if before != *gains => self.advance_with_new_gains(&before, gains, error, most),
            _ => self.advance(gains, error, most),
        }
    }

    fn advance(&mut self, gains: &VelocityGains, error: f64, most: f64) -> f64 {
        self.gains = Some(*gains);
        self.sum = within(self.sum, gains.sum_bound());
        let law = self.law(gains, error);
        // An offset must not hide that the law itself already saturates.
        let room = Room::around(law.min(law + self.offset), law.max(law + self.offset), most);
        self.sum = grown(self.sum, error * gains.cycle, gains.sum_bound(), gains.output_per_ms(), room);
        self.output(gains, error, most)
    }

    /// Advances by a sample with other gains than the last one.
    fn advance_with_new_gains(&mut self, before: &VelocityGains, gains: &VelocityGains, error: f64, most: f64) -> f64 {
        let output = self.advance(before, error, most);
        let part = before.output_per_ms() * self.sum;
        let carried = if gains.integral == 0 { 0.0 } else { part / gains.output_per_ms() };
        self.sum = within(carried, gains.sum_bound());
        self.gains = Some(*gains);
        self.offset = output - within(self.law(gains, error), most);
        self.fall = self.offset.abs() / CARRY_TIME;
        self.output(gains, error, most)
    }

    fn law(&self, gains: &VelocityGains, error: f64) -> f64 {
        gains.factor() * error + gains.output_per_ms() * self.sum
    }

    fn output(&self, gains: &VelocityGains, error: f64, most: f64) -> f64 {
        within(within(self.law(gains, error), most) + self.offset, most)
    }

    /// Resets the loop: no sum, no offset.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        let sum = self.sum.abs() <= f64::from(MOST) * VELOCITY_SUM;
        let offset = self.offset.abs() <= 2.0 && (0.0..=2.0 / CARRY_TIME).contains(&self.fall);
        sum && offset && self.gains.is_none_or(|gains| gains.is_sound())
    }
}

#[cfg(test)]
mod tests;

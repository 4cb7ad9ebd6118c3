//! The regulator of the module.
//!
//! Law      U(n) = kp e(n) + clamp(ki SUM e, -IL, +IL) + kd (e(n') - e(n'-1)); n each sample, n' each SampI + 1 samples
//! Reads    the error, setpoint minus actual (counts)
//! Writes   U and the output code; a drive that closes its own position loop does not hear it
//! Refuses  nothing: every value saturates
//! Source   SAIA-PID-01..06, SAIA-EXT-04..06, A10..A12

use super::Parameters;
use serde::{Deserialize, Serialize};

/// Parameters of the law, each within its register's range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Gains {
    /// 0 to 32767
    pub proportional: i32,
    /// 0 to 32767
    pub integral: i32,
    /// 0 to 32767
    pub derivative: i32,
    /// Of the integral part, 0 to 32767.
    pub limit: i32,
    /// Samples between two derivative samples, less one: 0 to 255.
    pub interval: i32,
}

impl Gains {
    /// As the registers stand.
    pub(super) fn of(p: &Parameters) -> Self {
        Self { proportional: p.kprop, integral: p.kint, derivative: p.kder, limit: p.intl, interval: p.sampi }
    }

    /// The key of the first register that no command would load.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let registers = [
            ("saia.kprop", self.proportional, 32_767),
            ("saia.kint", self.integral, 32_767),
            ("saia.kder", self.derivative, 32_767),
            ("saia.intl", self.limit, 32_767),
            ("saia.sampi", self.interval, 255),
        ];
        registers.into_iter().find(|(_, value, most)| !(0..=*most).contains(value)).map(|(key, ..)| key)
    }

    pub(super) fn is_sound(&self) -> bool {
        self.problem().is_none()
    }
}

/// How the sum of the integral part is kept.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Options {
    /// It stops growing where its part reaches the limit (A10).
    pub clamp_sum: bool,
    /// Its part is made of its top 16 of 24 bits (A12).
    pub chip_integral: bool,
}

/// The regulator between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Pid {
    sum: i32,
    /// Error of the last derivative sample.
    before: i32,
    /// Derivative part, held until the next derivative sample.
    held: i64,
    /// Samples until then.
    wait: i32,
    /// Integral part of the last sample.
    integral: i32,
    output: i32,
}

/// Largest magnitude of the sum: 24 bit with sign.
const MOST_SUM: i32 = (1 << 23) - 1;

impl Pid {
    /// One sample: U, within 16 bit.
    pub(super) fn step(&mut self, gains: &Gains, options: Options, error: i64) -> i32 {
        let error = error.clamp(i16::MIN.into(), i16::MAX.into()) as i32;
        self.sum = self.grow(gains, options, error);
        let limit = i64::from(gains.limit);
        let part = part(gains, options, self.sum).min(limit).max(-limit);
        self.integral = part as i32;
        if self.wait > 0 {
            self.wait -= 1;
        } else {
            self.held = i64::from(gains.derivative) * i64::from(error.saturating_sub(self.before));
            self.before = error;
            self.wait = gains.interval;
        }
        let sum = i64::from(gains.proportional) * i64::from(error) + part + self.held;
        self.output = sum.clamp(i16::MIN.into(), i16::MAX.into()) as i32;
        self.output
    }

    fn grow(&self, gains: &Gains, options: Options, error: i32) -> i32 {
        let sum = self.sum.saturating_add(error).clamp(-MOST_SUM - 1, MOST_SUM);
        if !options.clamp_sum || gains.integral <= 0 {
            return sum;
        }
        let most = gains.limit / gains.integral;
        let (low, high) = if options.chip_integral { (-most * 256, most * 256 + 255) } else { (-most, most) };
        sum.min(high).max(low)
    }

    /// The regulator goes off: no output, no history (SAIA-PID-05, SAIA-PID-06).
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// clamp(ki SUM, -IL, +IL), as `frdits` reads it (A11).
    pub(super) fn integral(&self) -> i32 {
        self.integral
    }

    /// The code for the converter: the top 12 bits, or 8 for PWM, of U behind the gain (SAIA-EXT-06).
    pub(super) fn code(&self, gain: f64, pwm: bool) -> i32 {
        let scaled = (f64::from(self.output) * gain).round().clamp(f64::from(i16::MIN), f64::from(i16::MAX));
        (scaled as i32) >> (if pwm { 8 } else { 4 })
    }

    pub(super) fn is_sound(&self) -> bool {
        let word = |value: i32| i16::try_from(value).is_ok();
        let sum = (-MOST_SUM - 1..=MOST_SUM).contains(&self.sum);
        // A difference of two errors times a factor.
        let held = self.held.unsigned_abs() <= 65_535 * 32_767;
        sum && held && word(self.before) && word(self.output) && word(self.integral) && (0..=255).contains(&self.wait)
    }
}

fn part(gains: &Gains, options: Options, sum: i32) -> i64 {
    let sum = if options.chip_integral { sum >> 8 } else { sum };
    i64::from(gains.integral) * i64::from(sum)
}

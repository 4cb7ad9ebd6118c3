//! PID controller of the module.
//!
//! Law      U(n) = kp e(n) + clamp(ki SUM e, -IL, +IL) + kd (e(n') - e(n'-1)); n each sample, n' each SampI + 1
//!          samples. Between two cycles e is interpolated linearly; the samples of a cycle are spaced evenly, and the
//!          last one is at its end. A cycle is no whole number of samples, so that e(n') - e(n'-1) is scaled to the
//!          interval of the chip. SUM has whole counts
//! Reads    the error, setpoint minus actual (counts)
//! Writes   U and the output code; a drive with its own position loop does not use them
//! Refuses  nothing: every value saturates
//! Source   SAIA-PID-01..06, SAIA-EXT-04..06, A10..A12

use super::Parameters;
use serde::{Deserialize, Serialize};

/// Parameters of the law, each within the range of its register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Gains {
    /// Proportional gain, 0 to 32767.
    pub proportional: i32,
    /// Integral gain, 0 to 32767.
    pub integral: i32,
    /// Derivative gain, 0 to 32767.
    pub derivative: i32,
    /// Limit of the integral term, 0 to 32767.
    pub limit: i32,
    /// Samples between two derivative samples, minus one: 0 to 255.
    pub interval: i32,
}

impl Gains {
    /// Returns the gains of the registers.
    pub(super) fn of(p: &Parameters) -> Self {
        Self { proportional: p.kprop, integral: p.kint, derivative: p.kder, limit: p.intl, interval: p.sampi }
    }

    /// Returns the key of the first register that no command would load.
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

/// Options of the integral term.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Options {
    /// Whether the sum stops growing when its term reaches the limit (A10).
    pub clamp_sum: bool,
    /// Whether the term is computed from the top 16 of 24 bits of the sum (A12).
    pub chip_integral: bool,
}

/// State of the controller between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Pid {
    sum: i32,
    /// Error at the last derivative sample (counts).
    last_error: f64,
    /// Samples since the last derivative sample, and their duration (chip samples).
    samples: i32,
    since: f64,
    /// Derivative term, held until the next derivative sample.
    held: f64,
    /// Samples until the next derivative sample.
    wait: i32,
    /// Integral term of the last sample.
    integral: i32,
    output: i32,
    /// Error at the end of the last cycle with samples (counts); `None` before the first.
    last: Option<f64>,
    /// Time since that cycle (chip samples).
    elapsed: f64,
    /// Whether the next cycle starts without history, except the sum.
    forgets_past: bool,
}

/// Maximum magnitude of the sum: 24 bits with sign.
const MOST_SUM: i32 = (1 << 23) - 1;

impl Pid {
    /// Executes a cycle of `length` chip samples with `count` samples; `error` (counts) is that at its end. Returns U
    /// of the last sample, within 16 bits.
    pub(super) fn run_cycle(
        &mut self,
        gains: &Gains,
        options: Options,
        error: i64,
        (count, length): (u64, f64),
    ) -> i32 {
        let error = error as f64;
        if std::mem::take(&mut self.forgets_past) {
            (self.last_error, self.held, self.wait, self.last) = (limit_to_16_bits(error), 0.0, 0, None);
        }
        self.elapsed += length;
        if count == 0 {
            return self.output;
        }
        let elapsed = std::mem::take(&mut self.elapsed);
        // Before the first cycle there is no previous error, and no time.
        let span = if self.last.is_some() { elapsed / count as f64 } else { 1.0 };
        let last = self.last.replace(error).unwrap_or(error);
        for number in 1..=count {
            let share = number as f64 / count as f64;
            self.step(gains, options, last + (error - last) * share, span);
        }
        self.output
    }

    /// Executes one sample, `span` (chip samples) after the previous one. Returns U, within 16 bits.
    pub(super) fn step(&mut self, gains: &Gains, options: Options, error: f64, span: f64) -> i32 {
        let error = limit_to_16_bits(error);
        self.sum = self.grow(gains, options, error.round() as i32);
        let limit = i64::from(gains.limit);
        self.integral = part(gains, options, self.sum).min(limit).max(-limit) as i32;
        self.samples = self.samples.saturating_add(1);
        self.since += span;
        if self.wait > 0 {
            self.wait -= 1;
        } else {
            let change = (error - self.last_error) * (f64::from(self.samples) / self.since);
            self.held = f64::from(gains.derivative) * change;
            (self.last_error, self.samples, self.since, self.wait) = (error, 0, 0.0, gains.interval);
        }
        let sum = f64::from(gains.proportional) * error + f64::from(self.integral) + self.held;
        self.output = limit_to_16_bits(sum.round()) as i32;
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

    /// Switches the controller off: no output, no history (SAIA-PID-05, SAIA-PID-06).
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Skips a time without samples, in which the error may have changed: the sum is kept, and the change does not
    /// count as motion.
    pub(super) fn forget_past(&mut self) {
        self.forgets_past = true;
    }

    /// Returns clamp(ki SUM, -IL, +IL), the value of `frdits` (A11).
    pub(super) fn integral(&self) -> i32 {
        self.integral
    }

    /// Returns the code for the converter: the top 12 bits of U after the gain, or 8 for PWM (SAIA-EXT-06).
    pub(super) fn converter_code(&self, gain: f64, pwm: bool) -> i32 {
        let scaled = (f64::from(self.output) * gain).round().clamp(f64::from(i16::MIN), f64::from(i16::MAX));
        (scaled as i32) >> (if pwm { 8 } else { 4 })
    }

    pub(super) fn is_sound(&self) -> bool {
        let is_word = |value: i32| i16::try_from(value).is_ok();
        let sum = (-MOST_SUM - 1..=MOST_SUM).contains(&self.sum);
        let is_time = |time: f64| time.is_finite() && time >= 0.0;
        let times = is_time(self.since) && is_time(self.elapsed) && (0..=256).contains(&self.samples);
        sum && times
            && self.held.is_finite()
            && limit_to_16_bits(self.last_error) == self.last_error
            && self.last.is_none_or(f64::is_finite)
            && is_word(self.output)
            && is_word(self.integral)
            && (0..=255).contains(&self.wait)
    }
}

/// Limits a number to 16 bits.
fn limit_to_16_bits(value: f64) -> f64 {
    value.clamp(f64::from(i16::MIN), f64::from(i16::MAX))
}

fn part(gains: &Gains, options: Options, sum: i32) -> i64 {
    let sum = if options.chip_integral { sum >> 8 } else { sum };
    i64::from(gains.integral) * i64::from(sum)
}

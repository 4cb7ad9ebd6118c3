//! The PID position loop with feed-forward.
//!
//! Law      every TIMER: u = clamp((KPROP e + KDER (e - e') + KINT sum e) / [`K_OUT`], +-BANDWIDTH/1000)
//!                         + FFVEL/1000 v/VELMAX + FFACC/1000 a/amax, clamped to +-1.
//!          e' is the error of the sample before; there is no division by time, so that the same loop with a doubled
//!          TIMER needs half the KDER and twice the KINT.
//!          The sum is clamped to KILIM times the share of KILIMTIME. Outside the window the loop, but not the
//!          feed-forward, is off and its sum is 0. New gains cause no step: the difference fades within 64 samples
//! Reads    error and command of the sample; between two samples nothing
//! Writes   u, 1 for the full reference of the drive, held between two samples
//! Refuses  nothing: the rows of its parameters do. NaN counts as 0
//! Source   MACS-REG-01..12, A-22..A-26

mod limit;
mod window;

use super::fade::Fade;
use limit::Share;
use serde::{Deserialize, Serialize};
pub use window::Window;

/// Divisor of the sum of the parts: with the KPROP of a new controller, 30, an error of 2000 inc, one revolution
/// of an encoder of 500 lines, gives the full reference.
pub const K_OUT: f64 = 60_000.0;

/// Parameters, each within the range of its row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PidGains {
    /// KPROP: proportional gain.
    pub proportional: i64,
    /// KDER: derivative gain.
    pub derivative: i64,
    /// KINT: integral gain.
    pub integral: i64,
    /// KILIM: bound of the sum of errors (inc); 0 switches the integral part off.
    pub limit: i64,
    /// KILIMTIME (ms)
    pub limit_time: i64,
    /// BANDWIDTH (1/1000)
    pub bandwidth: i64,
    /// FFVEL (1/1000)
    pub velocity: i64,
    /// FFACC (1/1000)
    pub acceleration: i64,
    /// REGWMIN, REGWMAX.
    pub window: Window,
    /// TIMER (ms)
    pub period_ms: i64,
}

/// Inputs of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidInput {
    /// Command minus actual position (inc).
    pub error: f64,
    /// Command velocity as a fraction of VELMAX.
    pub velocity: f64,
    /// Command acceleration as a fraction of the largest one.
    pub acceleration: f64,
}

/// State of the loop between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pid {
    sum: f64,
    /// Error of the sample before; none before the first.
    before: Option<f64>,
    share: Share,
    /// Whether the window has switched it off.
    is_out: bool,
    /// Cycles until the next sample.
    wait: u32,
    fade: Fade,
    /// Gains of the last sample; the first sample has none to compare with.
    used: Option<PidGains>,
    output: f64,
}

/// The parts of an output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct OutputParts {
    loop_output: f64,
    forward: f64,
}

impl OutputParts {
    fn total(self) -> f64 {
        (self.loop_output + self.forward).clamp(-1.0, 1.0)
    }
}

impl Pid {
    /// Advances by one of the `cycles` of a period and returns the output, which is held between two samples.
    pub fn step(&mut self, gains: &PidGains, cycles: u32, input: PidInput) -> f64 {
        if self.wait > 0 {
            self.wait -= 1;
            return self.output;
        }
        self.wait = cycles.saturating_sub(1);
        self.output = self.sample(gains, input.without_nan());
        self.output
    }

    fn sample(&mut self, gains: &PidGains, input: PidInput) -> f64 {
        let error = input.error;
        let before = self.before.unwrap_or(error);
        if let Some(used) = self.used.filter(|used| used != gains) {
            // Both laws with the same history and the same inputs: the difference comes only from the gains.
            let (mut old, mut new) = (*self, *self);
            let step = new.parts(gains, input, before).total() - old.parts(&used, input, before).total();
            self.fade.make_up_for(step);
        }
        self.used = Some(*gains);
        let parts = self.parts(gains, input, before);
        self.before = Some(error);
        (parts.total() + self.fade.step()).clamp(-1.0, 1.0)
    }

    fn parts(&mut self, gains: &PidGains, input: PidInput, before: f64) -> OutputParts {
        let error = input.error;
        let share = self.share.step(gains.limit_time, input.velocity != 0.0, gains.period_ms as f64);
        let bound = gains.limit as f64 * share;
        // Without integral part no sum is kept that a new gain could release.
        self.sum = if gains.integral == 0 { 0.0 } else { (self.sum + error).clamp(-bound, bound) };
        self.is_out = !gains.window.step(!self.is_out, error);
        let bandwidth = gains.bandwidth as f64 / 1000.0;
        let loop_output = if self.is_out {
            self.sum = 0.0;
            0.0
        } else {
            let u = gains.proportional as f64 * error
                + gains.derivative as f64 * (error - before)
                + gains.integral as f64 * self.sum;
            (u / K_OUT).clamp(-bandwidth, bandwidth)
        };
        let forward =
            gains.velocity as f64 / 1000.0 * input.velocity + gains.acceleration as f64 / 1000.0 * input.acceleration;
        OutputParts { loop_output, forward }
    }

    /// Called after an interruption; the sum remains. The next cycle takes a sample without an earlier error.
    pub fn restart_after_gap(&mut self) {
        (self.before, self.wait) = (None, 0);
    }

    /// Returns the sum of errors (inc).
    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// Whether the window has switched it off.
    pub fn is_out(&self) -> bool {
        self.is_out
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        self.sum.abs() <= MOST_SUM
            && self.before.is_none_or(f64::is_finite)
            && self.share.is_sound()
            && self.fade.is_sound()
            && self.output.abs() <= 1.0
            && self.wait <= MOST_CYCLES
            && self.used.is_none_or(|gains| gains.is_sound())
    }
}

/// The largest KILIM.
const MOST_SUM: f64 = 65_000.0;
/// Cycles of the shortest length in the longest TIMER.
const MOST_CYCLES: u32 = 8_000;

impl PidGains {
    /// Whether the values that the law depends on are within the ranges of their rows.
    fn is_sound(&self) -> bool {
        let Self { proportional, derivative, integral, limit, bandwidth, velocity, acceleration, .. } = *self;
        let gains = [proportional, derivative, integral, limit].iter().all(|gain| (0..=65_000).contains(gain));
        gains
            && (0..=1000).contains(&bandwidth)
            && [velocity, acceleration].iter().all(|share| (0..=100_000).contains(share))
    }
}

impl PidInput {
    fn without_nan(self) -> Self {
        let number = |value: f64| if value.is_finite() { value } else { 0.0 };
        Self { error: number(self.error), velocity: number(self.velocity), acceleration: number(self.acceleration) }
    }
}

#[cfg(test)]
mod tests;

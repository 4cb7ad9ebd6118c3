//! The I2t supervision of an amplifier, and the displayed current.
//!
//! Law      each ms: shown += (I - shown) / CURFTIME; value += (shown^2 / 1000 - value) / I2TFTIME. A time of up to 1
//!          ms means no filter. A cycle of T ms uses the share 1 - (1 - 1/time)^T, which is equal to T steps of a ms at
//!          constant current. A value above I2TLIMIT is an error
//! Reads    the measured current (mA)
//! Writes   AMP_GETCUR (mA), AMP_I2TVALUE (A^2/1000), and the result of the supervision
//! Refuses  nothing: the rows of its parameters do
//! Source   MACS-I2T-01..05, A-29
//!
//! This is an indicator: it does not replace a motor protection. Its filters serve display and supervision, not the
//! current loop.

use super::sum::within;
use crate::code::Code;
use serde::{Deserialize, Serialize};

/// Share of I2TLIMIT above which there is a warning.
pub const I2T_WARNING: f64 = 0.9;

/// Current at which it saturates (mA).
const MOST: f64 = 1e9;

/// 2^30 - 1, the largest value of a parameter.
const MLONG: i32 = 1_073_741_823;

/// Parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct I2tSettings {
    /// I2TFTIME (ms): 0 to 2^30 - 1; 0 switches the supervision off.
    pub time: i32,
    /// I2TLIMIT (A^2/1000): 0 to 2^30 - 1. With 0 any current is an error.
    pub limit: i32,
    /// CURFTIME (ms): 0 to 2^30 - 1; 0 is no filter.
    pub shown_time: i32,
    /// Time between two samples (ms), above 0 up to 1000.
    pub cycle: f64,
}

impl I2tSettings {
    /// Whether each value is within its range.
    pub fn is_sound(&self) -> bool {
        let range = |value: i32| (0..=MLONG).contains(&value);
        range(self.time) && range(self.limit) && range(self.shown_time) && self.cycle > 0.0 && self.cycle <= 1000.0
    }
}

/// The law with its parameters, prepared for the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct I2t {
    settings: I2tSettings,
    /// Share of the difference to the squared current that is added per cycle.
    share: f64,
    /// Share of the difference to the measured current that is added per cycle.
    shown_share: f64,
}

impl I2t {
    /// Returns the law with these parameters.
    pub fn new(settings: I2tSettings) -> Self {
        let of = |time: i32| share(time, settings.cycle);
        Self { settings, share: of(settings.time), shown_share: of(settings.shown_time) }
    }

    /// Returns the parameters.
    pub fn settings(&self) -> I2tSettings {
        self.settings
    }

    /// Whether the parameters are within their ranges, and the shares match them.
    pub fn is_sound(&self) -> bool {
        self.settings.is_sound() && *self == Self::new(self.settings)
    }

    fn is_armed(&self) -> bool {
        self.settings.time > 0
    }
}

/// Returns 1 - (1 - 1/time)^cycle; at 1 ms as printed in the source.
fn share(time: i32, cycle: f64) -> f64 {
    if time <= 1 {
        return 1.0;
    }
    let one = 1.0 / f64::from(time);
    if cycle == 1.0 { one } else { -libm::expm1(cycle * libm::log1p(-one)) }
}

/// Result of the supervision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heat {
    /// The supervision is off, or the value is low.
    Fine,
    /// More than [`I2T_WARNING`] of the limit.
    Warning,
    /// More than the limit.
    TooMuch,
}

impl Heat {
    /// Returns the code of the error, if it is one.
    pub fn code(self) -> Code {
        if self == Self::TooMuch { Code::I2T_LIMIT } else { Code::NONE }
    }
}

/// State of the filters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeatFilter {
    /// Filtered current (mA).
    current: f64,
    /// Filtered squared current (A^2/1000).
    value: f64,
}

impl HeatFilter {
    /// Advances by one cycle with the measured current (mA). NaN does not change the filters.
    pub fn step(&mut self, law: &I2t, current: f64) -> Heat {
        if !current.is_nan() {
            self.current += (within(current, MOST) - self.current) * law.shown_share;
        }
        if !law.is_armed() {
            self.value = 0.0;
            return Heat::Fine;
        }
        let squared = self.current * self.current / 1000.0;
        self.value += (squared - self.value) * law.share;
        let limit = f64::from(law.settings.limit);
        if self.value > limit {
            Heat::TooMuch
        } else if self.value > I2T_WARNING * limit {
            Heat::Warning
        } else {
            Heat::Fine
        }
    }

    /// Returns AMP_GETCUR: the filtered current (mA).
    pub fn current(&self) -> f64 {
        self.current
    }

    /// Returns AMP_I2TVALUE: the filtered squared current (A^2/1000); 0 while the supervision is off.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        // Rounding may exceed the largest squared current by the last bits.
        self.current.abs() <= MOST * 1.001 && (0.0..=MOST * MOST / 1000.0 * 1.01).contains(&self.value)
    }
}

#[cfg(test)]
mod tests;

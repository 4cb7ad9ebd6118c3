//! The I2t supervision of an amplifier, and the current that is shown.
//!
//! Law      each ms: shown += (I - shown) / CURFTIME; value += (shown^2 / 1000 - value) / I2TFTIME. A time of up to 1 ms is no
//!          filter. A cycle of T ms moves by 1 - (1 - 1/time)^T of the way, which is T steps of a ms under a steady current.
//!          Too much is a value above I2TLIMIT
//! Reads    the measured current (mA)
//! Writes   AMP_GETCUR (mA), AMP_I2TVALUE (A^2/1000), and what they come to
//! Refuses  nothing: the rows of its parameters do
//! Source   MACS-I2T-01..05, A-29
//!
//! An indicator: it protects no motor by itself. What it filters is for eyes and for itself, not for the current loop.

use super::sum::within;
use crate::code::Code;
use serde::{Deserialize, Serialize};

/// Share of I2TLIMIT beyond which there is a warning.
pub const I2T_WARNING: f64 = 0.9;

/// A current beyond this saturates (mA).
const MOST: f64 = 1e9;

/// 2^30 - 1, the largest value of a parameter.
const MLONG: i32 = 1_073_741_823;

/// Parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct I2tSettings {
    /// I2TFTIME (ms): 0 to 2^30 - 1; 0 supervises nothing.
    pub time: i32,
    /// I2TLIMIT (A^2/1000): 0 to 2^30 - 1. 0 is taken as it stands: any current is too much.
    pub limit: i32,
    /// CURFTIME (ms): 0 to 2^30 - 1; 0 is no filter.
    pub shown_time: i32,
    /// Time between two samples (ms), above 0 up to 1000.
    pub cycle: f64,
}

impl I2tSettings {
    /// Is each value within its range?
    pub fn is_sound(&self) -> bool {
        let range = |value: i32| (0..=MLONG).contains(&value);
        range(self.time) && range(self.limit) && range(self.shown_time) && self.cycle > 0.0 && self.cycle <= 1000.0
    }
}

/// The law with its parameters, ready for the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct I2t {
    settings: I2tSettings,
    /// Part of the way to the squared current that a cycle goes.
    share: f64,
    /// Part of the way to the measured current that a cycle goes.
    shown_share: f64,
}

impl I2t {
    /// With these parameters.
    pub fn new(settings: I2tSettings) -> Self {
        let of = |time: i32| share(time, settings.cycle);
        Self { settings, share: of(settings.time), shown_share: of(settings.shown_time) }
    }

    /// What the parameters are.
    pub fn settings(&self) -> I2tSettings {
        self.settings
    }

    /// Are the parameters within their ranges, and the shares theirs?
    pub fn is_sound(&self) -> bool {
        self.settings.is_sound() && *self == Self::new(self.settings)
    }

    fn is_armed(&self) -> bool {
        self.settings.time > 0
    }
}

/// 1 - (1 - 1/time)^cycle, and as the source prints it at 1 ms.
fn share(time: i32, cycle: f64) -> f64 {
    if time <= 1 {
        return 1.0;
    }
    let one = 1.0 / f64::from(time);
    if cycle == 1.0 { one } else { -libm::expm1(cycle * libm::log1p(-one)) }
}

/// What a current comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heat {
    /// Nothing is supervised, or all is well.
    Fine,
    /// More than [`I2T_WARNING`] of the limit.
    Warning,
    /// More than the limit.
    TooMuch,
}

impl Heat {
    /// The error that it is, if it is one.
    pub fn code(self) -> Code {
        if self == Self::TooMuch { Code::I2T_LIMIT } else { Code::NONE }
    }
}

/// What is filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeatFilter {
    /// mA.
    current: f64,
    /// A^2/1000.
    value: f64,
}

impl HeatFilter {
    /// One cycle with the measured current (mA). No number leaves everything as it was.
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

    /// AMP_GETCUR: the filtered current (mA).
    pub fn current(&self) -> f64 {
        self.current
    }

    /// AMP_I2TVALUE: the filtered squared current (A^2/1000); 0 where nothing is supervised.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Is it a state that the filter can be in?
    pub fn is_sound(&self) -> bool {
        // Rounding may pass the largest squared current by the last bits.
        self.current.abs() <= MOST * 1.001 && (0.0..=MOST * MOST / 1000.0 * 1.01).contains(&self.value)
    }
}

#[cfg(test)]
mod tests;

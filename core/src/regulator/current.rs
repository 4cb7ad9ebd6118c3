//! The current loop of an amplifier, and its design for a winding.
//!
//! Law      voltage = U kc ku (CURKPROP e + 4 CURKINT SUM e), within +-U; e in A, summed per sample.
//!          |SUM e| <= CURKILIM, and the sum does not grow while the voltage is at its limit in that direction.
//!          Design: w = Beta pi / (2 Ts); CURKPROP = (2 w - R/L) L / (U kc ku); CURKINT = w^2 L / (kc ku U) Ts / 4
//! Reads    the error, setpoint minus actual current (A); the setpoint within [`capped`]
//! Writes   the voltage at the winding (V)
//! Refuses  a design beyond the ranges of the source, or with gains beyond the range of the parameters. The loop
//!          refuses nothing: the rows of its parameters do
//! Source   MACS-AMP-05, MACS-AMP-07, MACS-AMP-08, A-27, A-28
//!
//! The design is the double pole at -w of a loop in continuous time without delay of the voltage. A sample is Ts, 125
//! us in the source; an axis calls the loop once a cycle, which then is its Ts.
//!
//! A change of gains does not change the output of its sample: the integral part is converted to a new sum, as far as
//! CURKILIM allows; the rest fades within 64 samples.

use super::fade::Fade;
use super::sum::{Room, grown, measured, within};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Counts of current per A of a DC6 amplifier.
pub const DC6: f64 = 6554.0;
/// Counts of current per A of a DC3 amplifier.
pub const DC3: f64 = 3495.0;
/// Time between two samples of the source (s).
pub const CURRENT_SAMPLE: f64 = 0.000_125;

/// Full voltage per count of current and unit of gain: 2^-12 for the gain, 2^-15 for the output.
const KU: f64 = 1.0 / (1_u32 << 27) as f64;
/// Factor of CURKINT in the law.
const INTEGRAL: f64 = 4.0;
/// Largest magnitude of a parameter.
const MOST: f64 = 32_767.0;
/// Error at which it saturates (A).
const MOST_ERROR: f64 = 1e6;

/// Parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurrentGains {
    /// CURKPROP: -32767 to 32767.
    pub proportional: f64,
    /// CURKINT: -32767 to 32767.
    pub integral: f64,
    /// CURKILIM: 0 to 32767 (A samples); 0 switches the integral part off.
    pub limit: f64,
    /// U: supply of the power stage (V), above 0 up to 1000.
    pub voltage: f64,
    /// kc: counts per A ([`DC6`], [`DC3`]), above 0 up to 1000000.
    pub scale: f64,
}

impl CurrentGains {
    /// Whether each value is within its range.
    pub fn is_sound(&self) -> bool {
        let gains =
            self.proportional.abs() <= MOST && self.integral.abs() <= MOST && (0.0..=MOST).contains(&self.limit);
        let above = |value: f64, most: f64| value > 0.0 && value <= most;
        gains && above(self.voltage, 1000.0) && above(self.scale, 1e6)
    }

    /// Returns V per A and unit of gain.
    fn unit(&self) -> f64 {
        self.voltage * self.scale * KU
    }

    /// Returns V per A.
    fn factor(&self) -> f64 {
        self.unit() * self.proportional
    }

    /// Returns V per A and sample.
    fn volts_per_ampere_and_sample(&self) -> f64 {
        self.unit() * INTEGRAL * self.integral
    }
}

/// State of the loop between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CurrentLoop {
    /// Sum of the errors (A samples).
    sum: f64,
    /// Gains of the last sample; none before the first.
    gains: Option<CurrentGains>,
    /// Rest of a change of gains, as a fraction of U.
    fade: Fade,
}

impl CurrentLoop {
    /// Advances by one sample and returns the voltage (V) within +-U. `error` is in A; NaN counts as 0.
    pub fn step(&mut self, gains: &CurrentGains, error: f64) -> f64 {
        let error = measured(error, MOST_ERROR);
        match self.gains.replace(*gains) {
            Some(before) if before != *gains => self.advance_with_new_gains(&before, gains, error),
            _ => self.advance(gains, error),
        }
    }

    fn advance(&mut self, gains: &CurrentGains, error: f64) -> f64 {
        let rest = self.fade.step() * gains.voltage;
        self.sum = within(self.sum, gains.limit);
        let law = self.law(gains, error);
        // The fading rest must not hide that the law itself already saturates.
        let room = Room::around(law.min(law + rest), law.max(law + rest), gains.voltage);
        self.sum = grown(self.sum, error, gains.limit, gains.volts_per_ampere_and_sample(), room);
        within(within(self.law(gains, error), gains.voltage) + rest, gains.voltage)
    }

    /// Advances by a sample with other gains than the last one.
    fn advance_with_new_gains(&mut self, before: &CurrentGains, gains: &CurrentGains, error: f64) -> f64 {
        let voltage = self.advance(before, error);
        let part = |loops: &Self, gains: &CurrentGains| within(loops.law(gains, error), gains.voltage) / gains.voltage;
        let old = part(self, before);
        let carried = if gains.volts_per_ampere_and_sample() == 0.0 {
            0.0
        } else {
            before.volts_per_ampere_and_sample() * self.sum / gains.volts_per_ampere_and_sample()
        };
        self.sum = within(carried, gains.limit);
        self.fade.make_up_for(part(self, gains) - old);
        within(voltage, gains.voltage)
    }

    fn law(&self, gains: &CurrentGains, error: f64) -> f64 {
        gains.factor() * error + gains.volts_per_ampere_and_sample() * self.sum
    }

    /// Resets the loop: the sum is 0.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        self.sum.abs() <= MOST && self.fade.is_sound() && self.gains.is_none_or(|gains| gains.is_sound())
    }
}

/// Returns the setpoint of the current (mA) limited to +-AMPMAXCUR (mA); NaN counts as 0.
///
/// For the modes with a current loop, 0 and 2; the others limit no current.
pub fn capped(setpoint: f64, most: f64) -> f64 {
    measured(setpoint, most.max(0.0))
}

/// A winding and the speed of its current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// Speed of the loop: 0.1 slow to 0.3 fast.
    pub beta: f64,
    /// Ts: time between two samples (s), 0.000001 to 1. [`CURRENT_SAMPLE`] in the source.
    pub sample: f64,
    /// U: supply of the power stage (V), 12 to 48.
    pub voltage: f64,
    /// kc: counts per A, above 0 up to 1000000.
    pub scale: f64,
    /// L (H), above 0 up to 1000.
    pub inductance: f64,
    /// R (ohm), 0 to 1000000.
    pub resistance: f64,
}

/// Result of a design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// w: position of the double pole (rad/s).
    pub bandwidth: f64,
    /// CURKPROP, not rounded.
    pub proportional: f64,
    /// CURKINT, not rounded.
    pub integral: f64,
}

/// Error in a design.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// A value of the winding is outside its range.
    #[error("{name} is {value}{unit}; {range}{unit} is permitted")]
    Range {
        /// Name of the value.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Unit of both, with a space before it.
        unit: &'static str,
        /// Allowed range.
        range: &'static str,
    },
    /// The gain exceeds the range of its parameter.
    #[error("the design needs {name} {value}; -32767 to 32767 is permitted")]
    Gain {
        /// Name of the gain.
        name: &'static str,
        /// Necessary value.
        value: f64,
    },
}

impl Winding {
    /// Returns the gains for a double pole of the loop at -w.
    ///
    /// A winding that is faster than the loop, with R/L above 2 w, gets a negative CURKPROP.
    ///
    /// # Errors
    /// A value beyond its range; a gain beyond +-32767.
    pub fn design(&self) -> Result<Design, DesignError> {
        self.check_ranges()?;
        let bandwidth = self.beta * PI / (2.0 * self.sample);
        let unit = self.scale * KU * self.voltage;
        let proportional = (2.0 * bandwidth * self.inductance - self.resistance) / unit;
        let integral = bandwidth * bandwidth * self.inductance / unit * (self.sample / INTEGRAL);
        for (name, value) in [("CURKPROP", proportional), ("CURKINT", integral)] {
            if value.abs() > MOST {
                return Err(DesignError::Gain { name, value });
            }
        }
        Ok(Design { bandwidth, proportional, integral })
    }

    fn check_ranges(&self) -> Result<(), DesignError> {
        let positive = f64::MIN_POSITIVE;
        let values = [
            ("Beta", self.beta, "", 0.1, 0.3, "0.1 to 0.3"),
            ("Ts", self.sample, " s", 1e-6, 1.0, "0.000001 to 1"),
            ("U", self.voltage, " V", 12.0, 48.0, "12 to 48"),
            ("kc", self.scale, " counts/A", positive, 1e6, "more than 0 up to 1000000"),
            ("L", self.inductance, " H", positive, 1e3, "more than 0 up to 1000"),
            ("R", self.resistance, " ohm", 0.0, 1e6, "0 to 1000000"),
        ];
        for (name, value, unit, least, most, range) in values {
            // NaN is outside every range.
            if !(least..=most).contains(&value) {
                return Err(DesignError::Range { name, value, unit, range });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;

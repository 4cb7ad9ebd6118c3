//! Exact quantities, units and scales.
//!
//! Law      increments = quantity * scale, an exact fraction, rounded once: nearest, half away from zero
//! Reads    decimal numbers as text or as f64 (by its shortest decimal, so that 0.12 is 12/100 in every interface)
//! Writes   whole increments with |value| < 2^62; velocities, accelerations and jerks as f64 (inc/s .. inc/s^3)
//! Refuses  NaN and infinities, numbers beyond 38 digits, unknown units, wrong dimensions, positions beyond 2^62
//! Source   MACS-UNIT-01 .. 05
//!
//! Lengths, times, degrees and revolutions are exact. Radians are not: pi is irrational, so values in rad use pi as an
//! f64. Only texts, and errors with a text, allocate.

mod amount;
mod axis;
mod error;
mod fraction;
mod macs;
mod names;
mod quantity;
mod scale;
mod si;

pub use amount::{Amount, Units};
pub use axis::AxisUnit;
pub use error::{UnitError, excerpt, special_space};
pub use fraction::{
    Fraction, fraction_from_f64, fraction_to_digits, fraction_to_f64, fraction_to_text, number_to_text, parse_decimal,
    parse_fraction, round,
};
pub use macs::{MLONG, MacsFactors};
pub use names::{Dimension, Unit};
pub use quantity::Quantity;
pub use scale::{Scale, ScaleKind};
pub use si::SiScale;

//! Displayed position of the master of an axis, and its resolution.

use super::sensor::Claim;
use crate::object::Leader;
use crate::parameter::AxisParameters;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Displayed position of the master of an axis.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct MasterView {
    /// Leader of the last cycle.
    pub(in crate::axis) leader: Option<Leader>,
    /// Displayed position minus that of the leader (inc).
    pub(in crate::axis) offset: Position,
    /// Displayed position of the last cycle (inc).
    pub(in crate::axis) last: Position,
    /// New zero of this cycle, if the leader is an encoder.
    pub(in crate::axis) claim: Option<Claim>,
}

/// Resolution of displayed values that are multiples of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::axis) struct Grid {
    step: f64,
    /// Power of ten for rounding to the decimals that the step allows.
    power: Option<f64>,
}

impl Grid {
    /// Returns the resolution of the positions of a master, in increments or master units.
    pub(in crate::axis) fn of(p: &AxisParameters) -> Self {
        let (increments, units) = master_unit(p);
        Self::with(Position::from_raw(1).to_f64() * units / increments)
    }

    pub(in crate::axis) fn with(step: f64) -> Self {
        let step = step.abs();
        Self { step, power: power(step) }
    }

    /// Rounds a value to its decimals. The exact number that was given may have lost digits in a position of 2^-32 inc,
    /// and in the last digits of an f64.
    pub(in crate::axis) fn decimal(&self, value: f64) -> f64 {
        /// Rounding of the few operations that made the value.
        const DIGITS: f64 = 4.0 * f64::EPSILON;
        let digits = value.abs() * DIGITS;
        match if digits > self.step { power(digits) } else { self.power } {
            Some(power) => round(value * power) / power,
            None => value,
        }
    }
}

/// Returns the largest power of ten whose inverse is not finer than such steps; none if the steps are whole, or finer
/// than any.
fn power(step: f64) -> Option<f64> {
    /// All powers of ten up to this one are exact.
    const MOST: f64 = 1e22;
    let mut power = 1.0;
    while power * 10.0 * step < 1.0 && power < MOST {
        power *= 10.0;
    }
    // NaN fails the comparison.
    (step < 1.0 && power < MOST).then_some(power)
}

/// Returns numbers of increments and displayed units of the master that are equal.
pub(in crate::axis) fn master_unit(p: &AxisParameters) -> (f64, f64) {
    match p.macs.mencoder {
        ..0 if p.sync_master != 0 && p.sync_slave != 0 => (p.sync_master as f64, p.sync_slave as f64),
        _ => (1.0, 1.0),
    }
}

/// As `f64::round`, but without a call of the C library.
fn round(value: f64) -> f64 {
    // From this value on every f64 is whole.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    if value.is_nan() || value.abs() >= WHOLE {
        return value;
    }
    let whole = value as i64;
    let rest = value - whole as f64;
    ((whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)) as f64).copysign(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A number of up to six decimals that was converted to 2^-32 inc of any unit of a master is displayed
        /// unchanged.
        #[test]
        fn given_value_is_displayed(
            digits in -1_000_000_000_i64..1_000_000_000,
            places in 0_u32..7,
            increments in 1_i64..100_000,
            units in 1_i64..100,
        ) {
            let given = digits as f64 / libm::pow(10.0, f64::from(places));
            let (increments, units) = (increments as f64, units as f64);
            let kept = Position::from_f64(given * increments / units).to_f64();
            let step = Position::from_raw(1).to_f64() * units / increments;
            prop_assert_eq!(Grid::with(step).decimal(kept * units / increments), given);
        }

        /// Also values that round away from zero, and 0 with its sign.
        #[test]
        fn rounding_is_that_of_f64(
            bits in prop_oneof![any::<u64>(), (-4e9..4e9_f64).prop_map(f64::to_bits)],
            halves in -1_000_000_i64..1_000_000,
        ) {
            let half = halves as f64 / 2.0;
            for value in [f64::from_bits(bits), half, half.next_down(), half.next_up()] {
                prop_assert!(value.is_nan() || round(value).to_bits() == value.round().to_bits(), "{}", value);
            }
        }

        #[test]
        fn values_move_at_most_by_their_resolution(value in any::<f64>(), step in any::<f64>()) {
            let shown = Grid::with(step).decimal(value);
            let tellable = step.abs().max(value.abs() * 4.0 * f64::EPSILON);
            prop_assert!(value.is_nan() || shown == value || (shown - value).abs() <= 6.0 * tellable);
        }
    }
}

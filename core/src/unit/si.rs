//! Scale prepared for many conversions to SI units: a message has several values of each axis.

use super::{Fraction, Scale};

/// Limit up to which every whole number is an f64.
const EXACT: u64 = 1 << 53;

/// Converts increments to m or rad, with the same result as its [`Scale`].
#[derive(Clone, Copy, Debug)]
pub struct SiScale {
    scale: Scale,
    /// Increments per m or rad, the nearest f64.
    nearest: f64,
    way: DivisionMethod,
}

/// Method of dividing a whole number of increments.
#[derive(Clone, Copy, Debug)]
enum DivisionMethod {
    /// By the nearest f64: rad has no exact number of increments.
    Nearest,
    /// By the exact fraction, whose numerator and denominator are an f64 each.
    Ratio(f64, i64),
    /// By an exact fraction of larger numbers.
    Exact,
}

impl SiScale {
    pub(super) fn new(scale: Scale, exact: Option<Fraction>, nearest: f64) -> Self {
        let whole = |number: &i128| i64::try_from(*number).ok().filter(|number| number.unsigned_abs() <= EXACT);
        let way = match exact.map(|exact| (whole(exact.numer()), whole(exact.denom()))) {
            None => DivisionMethod::Nearest,
            Some((Some(numerator), Some(denominator))) => DivisionMethod::Ratio(numerator as f64, denominator),
            Some(_) => DivisionMethod::Exact,
        };
        Self { scale, nearest, way }
    }

    /// Converts a position like [`Scale::position_to_si`].
    pub fn position(&self, increments: i64, fraction: f64) -> f64 {
        let whole = match self.way {
            DivisionMethod::Nearest => increments as f64 / self.nearest,
            // The quotient of two numbers that are exact in f64 is rounded once (IEEE 754), like the exact fraction.
            DivisionMethod::Ratio(numerator, denominator)
                if let Some(product) = increments.checked_mul(denominator)
                    && product.unsigned_abs() <= EXACT =>
            {
                product as f64 / numerator
            }
            DivisionMethod::Ratio(..) | DivisionMethod::Exact => {
                return self.scale.position_to_si(increments, fraction);
            }
        };
        whole + fraction / self.nearest
    }

    /// Converts a rate like [`Scale::rate_to_si`].
    pub fn rate(&self, rate: f64) -> f64 {
        rate / self.nearest
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, Unit};
    use super::*;
    use proptest::prelude::*;

    fn scale(unit: Unit, increments: i128, of: i128) -> Scale {
        Scale::new(Fraction::from(increments), Quantity::new(Fraction::from(of), unit)).unwrap()
    }

    proptest! {
        #[test]
        fn values_have_the_bits_of_the_scale(
            unit in prop_oneof![Just(Unit::METRE), Just(Unit::REVOLUTION)],
            per in prop_oneof![1..2_000_000_i128, 1..1_i128 << 60],
            of in prop_oneof![1..2_000_i128, 1..1_i128 << 40],
            increments in prop_oneof![-3_000_000_000_i64..3_000_000_000, -(1_i64 << 62)..1 << 62],
            fraction in 0.0..1.0,
            rate in -1e12..1e12,
        ) {
            let scale = scale(unit, per, of);
            let prepared = SiScale::from(scale);
            let (fast, exact) = (prepared.position(increments, fraction), scale.position_to_si(increments, fraction));
            prop_assert_eq!(fast.to_bits(), exact.to_bits());
            prop_assert_eq!(prepared.rate(rate).to_bits(), scale.rate_to_si(rate).to_bits());
        }
    }

    #[test]
    fn usual_scales_need_no_exact_fraction() {
        assert!(matches!(SiScale::from(scale(Unit::METRE, 1_000_000, 1)).way, DivisionMethod::Ratio(1e6, 1)));
        assert!(matches!(SiScale::from(scale(Unit::REVOLUTION, 8192, 1)).way, DivisionMethod::Nearest));
        assert!(matches!(SiScale::from(scale(Unit::METRE, (1 << 60) + 1, 1)).way, DivisionMethod::Exact));
    }
}

//! A number with its unit.

use super::fraction::number_length;
use super::{
    Dimension, Fraction, Unit, UnitError, excerpt, fraction_from_f64, fraction_to_f64, fraction_to_text, parse_decimal,
};
use num_traits::{CheckedMul, Signed, ToPrimitive};
use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::fmt;

/// An exact number and its unit, as written: `8 m/s^2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    value: Fraction,
    unit: Unit,
}

impl Quantity {
    /// Creates the quantity `value` in `unit`.
    pub fn new(value: Fraction, unit: Unit) -> Self {
        Self { value, unit }
    }

    /// Creates a quantity from an f64 by its shortest decimal.
    ///
    /// # Errors
    /// [`UnitError::NotFinite`].
    pub fn from_f64(value: f64, unit: Unit) -> Result<Self, UnitError> {
        fraction_from_f64(value).map(|value| Self { value, unit })
    }

    /// Reads `NUMBER UNIT`, or a number without a unit, which is in the SI unit of the first of `expected` (inc for
    /// increments). The unit must be of one of the expected dimensions; an empty `expected` counts as a plain ratio.
    ///
    /// # Errors
    /// [`UnitError::NotANumber`], [`UnitError::TooManyDigits`], [`UnitError::NoBlank`], [`UnitError::UnknownUnit`],
    /// [`UnitError::WrongDimension`].
    pub fn parse(text: &str, expected: &[Dimension]) -> Result<Self, UnitError> {
        let text = text.trim();
        let first = expected.first().copied().unwrap_or(Dimension::Ratio);
        let (number, name) =
            text.split_once([' ', '\t']).map_or((text, ""), |(number, unit)| (number, unit.trim_start()));
        if let Some(length) = number_length(number).filter(|&length| length < number.len())
            && Unit::parse(&number[length..]).or_else(|| Unit::parse(Unit::meant(&number[length..], first)?)).is_some()
        {
            return Err(UnitError::NoBlank { text: excerpt(text), number: length });
        }
        let value = parse_decimal(number)?;
        let unit = if name.is_empty() { Some(first.si_unit()) } else { Unit::parse(name) };
        let Some(unit) = unit else {
            let (text, unit, meant) = (excerpt(text), excerpt(name), Unit::meant(name, first));
            return Err(UnitError::UnknownUnit { text, unit, expected: first, meant });
        };
        let quantity = Self { value, unit };
        if unit.dimension() == first || expected.contains(&unit.dimension()) {
            Ok(quantity)
        } else {
            Err(UnitError::wrong_dimension(quantity, first))
        }
    }

    /// Returns the number as written.
    pub fn value(&self) -> Fraction {
        self.value
    }

    /// Returns the unit as written.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the exact value in SI, but revolutions instead of radians for angles. `None` in rad, and beyond 128
    /// bits.
    pub fn exact(&self) -> Option<Fraction> {
        self.value.checked_mul(&self.unit.in_base()?)
    }

    /// Returns the value in SI (angles in rad, increments in inc).
    pub fn si(&self) -> f64 {
        let turn = if matches!(self.unit.dimension(), Dimension::Angle(_)) { TAU } else { 1.0 };
        match (self.exact(), self.unit.in_base()) {
            (Some(exact), _) => fraction_to_f64(&exact) * turn,
            (None, Some(factor)) => fraction_to_f64(&self.value) * fraction_to_f64(&factor) * turn,
            (None, None) => fraction_to_f64(&self.value),
        }
    }

    /// Returns a time in whole nanoseconds.
    ///
    /// # Errors
    /// [`UnitError::NotNanoseconds`] for fractions of a nanosecond and beyond i64; [`UnitError::WrongDimension`].
    pub fn nanoseconds(&self) -> Result<i64, UnitError> {
        if self.unit.dimension() != Dimension::Time {
            return Err(UnitError::wrong_dimension(*self, Dimension::Time));
        }
        self.exact()
            .and_then(|seconds| seconds.checked_mul(&Fraction::from(1_000_000_000)))
            .filter(Fraction::is_integer)
            .and_then(|nanoseconds| nanoseconds.to_integer().to_i64())
            .ok_or(UnitError::NotNanoseconds { given: *self })
    }

    /// Returns an example for an error: the number in a unit of the expected dimension, or one of it if the number is
    /// no good example: 0, negative or long. Its unit is derived from the given one, otherwise it is `usual`.
    pub(super) fn example(&self, expected: Dimension, usual: Unit) -> Self {
        const LONGEST: usize = 6;
        let is_example = self.value.is_positive() && fraction_to_text(&self.value).len() <= LONGEST;
        let value = if is_example { self.value } else { Fraction::from_integer(1) };
        let like = self.unit.with_order(expected.order());
        Self { value, unit: if like.dimension() == expected { like } else { usual } }
    }
}

/// Exact if both sides are; quantities of different dimensions have no order.
impl PartialOrd for Quantity {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        if self.unit == other.unit {
            return Some(self.value.cmp(&other.value));
        }
        if self.unit.dimension() != other.unit.dimension() {
            return None;
        }
        match (self.exact(), other.exact()) {
            (Some(mine), Some(theirs)) => Some(mine.cmp(&theirs)),
            _ => self.si().partial_cmp(&other.si()),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{} {}", fraction_to_text(&self.value), self.unit);
        f.write_str(text.trim_end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACCELERATION: [Dimension; 2] = [Dimension::Length(2), Dimension::Increments(2)];

    fn sentence(text: &str, expected: &[Dimension]) -> (String, Option<String>) {
        let error = Quantity::parse(text, expected).unwrap_err();
        (error.to_string(), error.hint())
    }

    #[test]
    fn number_and_unit_with_blanks_between() {
        for text in ["8 m/s^2", "8   m/s^2", " 8\tm/s^2 ", "8.0 m/s^2", "8", "800 cm/s^2"] {
            let quantity = Quantity::parse(text, &ACCELERATION).unwrap();
            assert_eq!(quantity.exact(), Some(Fraction::from(8)), "{text}");
        }
        assert_eq!(Quantity::parse("8 inc/s^2", &ACCELERATION).unwrap().unit().to_string(), "inc/s^2");
    }

    #[test]
    fn a_bare_number_is_si() {
        assert_eq!(Quantity::parse("2", &[Dimension::Angle(1)]).unwrap().to_string(), "2 rad/s");
        assert_eq!(Quantity::parse("0.001", &[Dimension::Time]).unwrap().nanoseconds(), Ok(1_000_000));
        assert_eq!(Quantity::parse("0.5", &[Dimension::Ratio]).unwrap().to_string(), "0.5");
        assert_eq!(Quantity::parse("50 %", &[Dimension::Ratio]).unwrap().exact(), Some(Fraction::new(1, 2)));
    }

    #[test]
    fn a_wrong_dimension_names_both() {
        let (sentence_1, hint) = sentence("8 m/s", &ACCELERATION);
        assert_eq!(sentence_1, "`8 m/s` is a velocity; an acceleration such as `8 m/s^2` is expected");
        assert_eq!(hint, None);
        assert_eq!(
            sentence("8 mm/s", &ACCELERATION).0,
            "`8 mm/s` is a velocity; an acceleration such as `8 mm/s^2` is expected"
        );
        assert_eq!(
            sentence("90 deg", &[Dimension::Length(0)]).0,
            "`90 deg` is an angle; a length such as `90 mm` is expected"
        );
        assert_eq!(
            sentence("10 rpm", &[Dimension::Angle(0)]).0,
            "`10 rpm` is an angular velocity; an angle such as `10 rev` is expected"
        );
    }

    #[test]
    fn an_unknown_unit_is_named_with_what_there_is() {
        assert_eq!(
            sentence("3 furlong", &[Dimension::Length(0)]),
            ("`furlong` in `3 furlong` is not a unit; a length has nm, um, mm, cm, m".to_owned(), None)
        );
        assert_eq!(
            sentence("3 m/s2", &ACCELERATION),
            (
                "`m/s2` in `3 m/s2` is not a unit; an acceleration has nm/s^2, um/s^2, mm/s^2, cm/s^2, m/s^2"
                    .to_owned(),
                Some("did you mean `m/s^2`?".to_owned())
            )
        );
    }

    #[test]
    fn a_blank_belongs_between_number_and_unit() {
        for (text, hint) in [("100ms", "write `100 ms`"), ("1e3us", "write `1e3 us`"), ("5min", "write `5 min`")] {
            let (sentence, given_hint) = sentence(text, &[Dimension::Time]);
            assert_eq!(sentence, format!("`{text}` has no blank between number and unit"));
            assert_eq!(given_hint.as_deref(), Some(hint));
        }
    }

    #[test]
    fn what_starts_with_no_number_is_no_quantity() {
        for text in ["", "mm", "mm 5", "0x10", "1/3 m", "NaN m", "inf m", "-- 5 m"] {
            let error = Quantity::parse(text, &[Dimension::Length(0)]).unwrap_err();
            assert!(matches!(error, UnitError::NotANumber { .. }), "{text}: {error}");
        }
        assert_eq!(sentence("1,5 m", &[Dimension::Length(0)]).1.unwrap(), "write a decimal point, not a comma");
    }

    #[test]
    fn si_values() {
        let si = |text: &str, dimension| Quantity::parse(text, &[dimension]).unwrap().si();
        assert_eq!(si("60 rpm", Dimension::Angle(1)), TAU);
        assert_eq!(si("180 deg", Dimension::Angle(0)), std::f64::consts::PI);
        assert_eq!(si("1.25 rad", Dimension::Angle(0)), 1.25);
        assert_eq!(si("6 m/min", Dimension::Length(1)), 0.1);
        assert_eq!(si("250 g", Dimension::Mass), 0.25);
        assert_eq!(si("2 kHz", Dimension::Frequency), 2000.0);
    }

    #[test]
    fn nanoseconds_are_whole() {
        let time = |text| Quantity::parse(text, &[Dimension::Time]).unwrap();
        assert_eq!(time("350 us").nanoseconds(), Ok(350_000));
        assert_eq!(time("2 min").nanoseconds(), Ok(120_000_000_000));
        assert_eq!(
            time("0.5 ns").nanoseconds().unwrap_err().to_string(),
            "`0.5 ns` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years"
        );
        assert!(time("1e12 s").nanoseconds().is_err());
    }

    #[test]
    fn order_is_exact_within_a_dimension_and_absent_between() {
        let length = |text| Quantity::parse(text, &[Dimension::Length(0)]).unwrap();
        let angle = |text| Quantity::parse(text, &[Dimension::Angle(0)]).unwrap();
        assert!(length("999.999 mm") < length("1 m"));
        assert_eq!(length("1000 mm").partial_cmp(&length("1 m")), Some(Ordering::Equal));
        assert!(angle("3.14 rad") < angle("180 deg"));
        assert_eq!(length("1 m").partial_cmp(&angle("1 rad")), None);
    }
}

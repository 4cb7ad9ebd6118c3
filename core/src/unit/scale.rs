//! Conversion of quantities to increments and back.

use super::fraction::{nine_digits, short_decimal};
use super::{
    AxisUnit, Dimension, Fraction, MacsFactors, Quantity, SiScale, Unit, UnitError, fraction_from_f64, fraction_to_f64,
    fraction_to_text, number_to_text, parse_decimal, round,
};
use num_traits::{CheckedDiv, CheckedMul, Signed};
use std::f64::consts::TAU;

/// Positions stay below 2^62 increments.
const LIMIT: u64 = 1 << 62;
/// Minimum rate other than 0 (inc/s^n). No machine is that slow. Above it every f64 written as its shortest decimal has
/// a last digit that [`parse_decimal`] can read, so that a recorded rate reads back unchanged.
const MIN_RATE: f64 = 1e-22;

/// Rates from this one on are outside every range (inc/s^n).
const MAX_EXACT_RATE: f64 = 1e30;

/// Kind of the axis: linear (m) or rotary (rad).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScaleKind {
    /// Lengths; SI m.
    Linear,
    /// Angles; SI rad.
    Rotary,
}

impl ScaleKind {
    /// Returns the dimension of the `order`-th derivative (0..=3) of the position.
    pub fn dimension(self, order: u8) -> Dimension {
        match self {
            Self::Linear => Dimension::Length(order),
            Self::Rotary => Dimension::Angle(order),
        }
    }
}

/// Increments per unit of travel, an exact positive fraction, and the axis unit, in which users read values of the
/// axis.
///
/// Law: increments = round(value in m or revolutions * scale); f64 results are the exact fraction, rounded once. Values
/// in rad use pi as an f64.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    kind: ScaleKind,
    /// Increments per m or per rev.
    per_base: Fraction,
    unit: AxisUnit,
}

impl Scale {
    /// Creates a scale of `increments` per length or angle `per`; the axis unit is m or rad until [`Scale::with_unit`].
    ///
    /// # Errors
    /// [`UnitError::NotPositive`]; [`UnitError::WrongDimension`] unless `per` is a length or an angle;
    /// [`UnitError::Inexact`] if the fraction exceeds 128 bits.
    pub fn new(increments: Fraction, per: Quantity) -> Result<Self, UnitError> {
        for (part, value) in [("increments", increments), ("per", per.value())] {
            if !value.is_positive() {
                return Err(UnitError::NotPositive { part, value });
            }
        }
        let kind = match per.unit().dimension() {
            Dimension::Length(0) => ScaleKind::Linear,
            Dimension::Angle(0) => ScaleKind::Rotary,
            _ => return Err(UnitError::wrong_dimension(per, Dimension::Length(0))),
        };
        let per_base = increments.checked_div(&in_base(&per)?).filter(Signed::is_positive);
        let per_base = per_base.ok_or(UnitError::Inexact { given: per })?;
        Ok(Self { kind, per_base, unit: kind.dimension(0).si_unit().into() })
    }

    /// Returns the scale of an object without units: one increment counts as one metre.
    pub fn increments() -> Self {
        Self { kind: ScaleKind::Linear, per_base: Fraction::from_integer(1), unit: Unit::INCREMENT.into() }
    }

    /// Creates the scale of MACS unit factors, for a user unit `user_unit` such as 0.1 mm.
    ///
    /// # Errors
    /// As [`Scale::new`]; [`UnitError::MacsFactor`].
    pub fn from_macs(factors: &MacsFactors, user_unit: Quantity) -> Result<Self, UnitError> {
        Self::new(factors.increments_per_user_unit()?, user_unit)
    }

    /// Returns the same scale with another axis unit: a length, an angle or inc, according to its kind, or a multiple
    /// of one.
    ///
    /// # Errors
    /// [`UnitError::WrongDimension`].
    pub fn with_unit(self, unit: impl Into<AxisUnit>) -> Result<Self, UnitError> {
        let unit = unit.into();
        if unit.unit().dimension() == self.kind.dimension(0) || unit == Unit::INCREMENT.into() {
            return Ok(Self { unit, ..self });
        }
        Err(UnitError::wrong_dimension(unit.times(Fraction::from(1))?, self.kind.dimension(0)))
    }

    /// Returns one increment, as a fraction of m or rev, and whether it is realistic for a machine: 1e-18 to 1e9 of
    /// them.
    pub fn increment(&self) -> (Fraction, bool) {
        let one = self.per_base.recip();
        let least = Fraction::new(1, 1_000_000_000_000_000_000);
        (one, one >= least && one <= Fraction::from_integer(1_000_000_000))
    }

    /// Returns the kind: linear or rotary.
    pub fn kind(&self) -> ScaleKind {
        self.kind
    }

    /// Returns the axis unit.
    pub fn unit(&self) -> AxisUnit {
        self.unit
    }

    /// Returns true if the axis unit is increments.
    pub fn is_in_increments(&self) -> bool {
        self.unit == Unit::INCREMENT.into()
    }

    /// Returns the dimensions of a quantity of the `order`-th derivative (0..=3), the SI one first.
    pub fn dimensions(&self, order: u8) -> [Dimension; 2] {
        [self.kind.dimension(order), Dimension::Increments(order)]
    }

    /// Returns the increments (per s^n) of a quantity, unrounded: for a modulo, which need not be whole, and for the
    /// absolute end of a relative move. In rad: the nearest f64 of turns, converted to a decimal.
    ///
    /// # Errors
    /// [`UnitError::WrongDimension`] unless it is of the kind of the scale or in increments; [`UnitError::Inexact`].
    pub fn exact(&self, quantity: &Quantity) -> Result<Fraction, UnitError> {
        let base = in_base(quantity)?;
        match (quantity.unit().dimension(), self.kind) {
            (Dimension::Increments(_), _) => Ok(base),
            (Dimension::Length(_), ScaleKind::Linear) | (Dimension::Angle(_), ScaleKind::Rotary) => {
                base.checked_mul(&self.per_base).ok_or(UnitError::Inexact { given: *quantity })
            }
            _ => Err(self.wrong_dimension(quantity, 0)),
        }
    }

    /// Returns the whole increments of a position: nearest, half away from zero, |result| < 2^62.
    ///
    /// # Errors
    /// As [`Scale::exact`]; a derivative is [`UnitError::WrongDimension`]; [`UnitError::OutOfRange`].
    pub fn position(&self, quantity: &Quantity) -> Result<i64, UnitError> {
        if !self.dimensions(0).contains(&quantity.unit().dimension()) {
            return Err(self.wrong_dimension(quantity, 0));
        }
        let exact = match self.exact(quantity) {
            Err(UnitError::Inexact { .. }) => None,
            other => Some(other?),
        };
        // A fraction beyond 128 bits may still be a small number with many digits: that is inexact, not out of range.
        if exact.is_none() && self.approximate_increments(quantity).abs() < LIMIT as f64 {
            return Err(UnitError::Inexact { given: *quantity });
        }
        exact
            .and_then(|exact| round(&exact))
            .filter(|whole| whole.unsigned_abs() < LIMIT)
            .ok_or_else(|| UnitError::OutOfRange { given: format!("`{quantity}`"), increments: exact })
    }

    /// Converts a velocity, acceleration or jerk (`order` 1..=3) to inc/s^order, correctly rounded from the exact
    /// fraction.
    ///
    /// # Errors
    /// As [`Scale::exact`]; another order is [`UnitError::WrongDimension`]; [`UnitError::RateTooLow`] between 0 and
    /// 1e-22 inc/s^order; [`UnitError::RateTooHigh`] if it is inexact from 1e30 inc/s^order on.
    pub fn rate(&self, quantity: &Quantity, order: u8) -> Result<f64, UnitError> {
        if !self.dimensions(order).contains(&quantity.unit().dimension()) {
            return Err(self.wrong_dimension(quantity, order));
        }
        let rate = match self.exact(quantity) {
            Ok(exact) => fraction_to_f64(&exact),
            Err(error) => {
                // The error is the size of the rate, not the number of its digits.
                let (rate, unit) = (self.approximate_increments(quantity), Unit::INCREMENT.with_order(order));
                let is_high = matches!(error, UnitError::Inexact { .. }) && rate.abs() >= MAX_EXACT_RATE;
                return Err(if is_high { UnitError::RateTooHigh { given: *quantity, rate, unit } } else { error });
            }
        };
        if rate != 0.0 && rate.abs() < MIN_RATE {
            return Err(UnitError::RateTooLow { given: *quantity, rate, unit: Unit::INCREMENT.with_order(order) });
        }
        Ok(rate)
    }

    /// Converts an SI number (m or rad) like [`Scale::position`], by its shortest decimal.
    ///
    /// # Errors
    /// [`UnitError::NotFinite`]; as [`Scale::position`].
    pub fn position_from_si(&self, metres_or_radians: f64) -> Result<i64, UnitError> {
        self.position(&Quantity::from_f64(metres_or_radians, self.si_unit())?)
    }

    /// Converts a number in the axis unit like [`Scale::position`], by its shortest decimal.
    ///
    /// # Errors
    /// As [`Scale::position_from_si`].
    pub fn position_from_unit(&self, value: f64) -> Result<i64, UnitError> {
        self.position(&self.unit.times_f64(value)?)
    }

    /// Converts an SI number (m/s^order or rad/s^order, `order` 1..=3) like [`Scale::rate`].
    ///
    /// # Errors
    /// [`UnitError::NotFinite`]; as [`Scale::rate`].
    pub fn rate_from_si(&self, value: f64, order: u8) -> Result<f64, UnitError> {
        self.rate(&Quantity::from_f64(value, self.si_unit().with_order(order))?, order)
    }

    /// Converts a number in the axis unit per s^order (`order` 1..=3) like [`Scale::rate`].
    ///
    /// # Errors
    /// As [`Scale::rate_from_si`].
    pub fn rate_from_unit(&self, value: f64, order: u8) -> Result<f64, UnitError> {
        self.rate(&self.unit.with_order(order).times_f64(value)?, order)
    }

    /// Returns a position in m or rad; `fraction` is the fraction of an increment, 0..1 inc.
    pub fn position_to_si(&self, increments: i64, fraction: f64) -> f64 {
        self.position_in(self.si_unit().into(), increments, fraction)
    }

    /// Returns a position in the axis unit; `fraction` is the fraction of an increment, 0..1 inc.
    pub fn position_to_unit(&self, increments: i64, fraction: f64) -> f64 {
        self.position_in(self.unit, increments, fraction)
    }

    /// Converts any derivative in inc/s^n to m/s^n or rad/s^n.
    pub fn rate_to_si(&self, rate: f64) -> f64 {
        rate / self.per(self.si_unit().into())
    }

    /// Converts any derivative in inc/s^n to axis unit per s^n.
    pub fn rate_to_unit(&self, rate: f64) -> f64 {
        rate / self.per(self.unit)
    }

    /// Returns a position for a message: `900 mm`. It is exact if 6 digits suffice; otherwise it has as few digits, 3
    /// or more, as are needed to read back as these increments. A value of a user is therefore shown as it was given.
    pub fn format_increments(&self, increments: i64) -> String {
        self.unit.text(&self.position_number(increments))
    }

    /// Returns a position like [`Scale::format_increments`], with the increments in brackets if the text is not exact:
    /// `11 mm (1153434 inc)`.
    pub fn format_with_increments(&self, increments: i64) -> String {
        let number = self.position_number(increments);
        let is_exact = parse_decimal(&number).ok() == self.position_in_unit(increments);
        let text = self.unit.text(&number);
        if is_exact { text } else { format!("{text} ({increments} inc)") }
    }

    /// Returns a position in the axis unit, as a number for [`Scale::format_increments`].
    fn position_number(&self, increments: i64) -> String {
        /// Maximum digits of an exact number in a message.
        const FEW: usize = 6;
        let exact = self.position_in_unit(increments);
        if let Some(exact) = exact
            && let Some(text) = short_decimal(&exact)
            && (exact.is_integer() || significant_digits(&text) <= FEW)
        {
            return text;
        }
        let value = self.position_to_unit(increments, 0.0);
        let mut rounded = (2..=16).filter_map(|digits| format!("{value:.digits$e}").parse().ok());
        match rounded.find(|number| self.position_from_unit(*number) == Ok(increments)) {
            Some(number) => number_to_text(number),
            None => exact.map_or_else(|| nine_digits(value), |exact| fraction_to_text(&exact)),
        }
    }

    /// Returns a position in the axis unit, exactly; `None` in rad, except for 0.
    fn position_in_unit(&self, increments: i64) -> Option<Fraction> {
        let whole = Fraction::from(i128::from(increments));
        if increments == 0 {
            return Some(whole);
        }
        self.exact_per(self.unit).and_then(|per| whole.checked_div(&per))
    }

    /// Returns a velocity, acceleration or jerk (`order` 1..=3) in inc/s^order for a message: `0.5 m/s`, at most nine
    /// digits.
    pub fn format_rate(&self, rate: f64, order: u8) -> String {
        self.unit.with_order(order).text(&nine_digits(self.rate_to_unit(rate)))
    }

    /// Returns the end of a range of rates for a message: with as few digits, nine or more, as are needed to read back
    /// as a rate on the permitted side of `rate`.
    pub fn format_bound(&self, rate: f64, order: u8, is_high: bool) -> String {
        let unit = self.unit.with_order(order);
        let exact = self.rate_to_unit(rate);
        let is_inside = |number: &f64| {
            let read = self.rate_from_unit(*number, order);
            read.is_ok_and(|read| if is_high { read <= rate } else { read >= rate })
        };
        let rounded = (8..=16).filter_map(|digits| format!("{exact:.digits$e}").parse().ok());
        // In rad the last digit may be outside for any rounding.
        let inwards = if is_high { f64::next_down } else { f64::next_up };
        let beside = std::iter::successors(Some(inwards(exact)), |number| Some(inwards(*number))).take(16);
        unit.text(&number_to_text(rounded.chain(beside).find(is_inside).unwrap_or(exact)))
    }

    /// Returns a rate like [`Scale::format_rate`], with as many digits, nine or more, as are needed to read back as
    /// `rate`.
    pub fn format_rate_precisely(&self, rate: f64, order: u8) -> String {
        let exact = self.rate_to_unit(rate);
        let mut rounded = (8..=16).filter_map(|digits| format!("{exact:.digits$e}").parse().ok());
        let number = rounded.find(|number| self.rate_from_unit(*number, order) == Ok(rate)).unwrap_or(exact);
        self.unit.with_order(order).text(&number_to_text(number))
    }

    /// Returns the same scale with m or rad as its unit.
    pub fn in_si(&self) -> Self {
        self.with_unit(self.si_unit()).unwrap_or(*self)
    }

    /// Returns a text in m or rad, with the text in the axis unit in brackets if that differs: `0.5 m/s (500 mm/s)`.
    pub fn text_in_si(&self, of: impl Fn(&Self) -> String) -> String {
        let si = self.in_si();
        if si.unit() == self.unit() { of(self) } else { format!("{} ({})", of(&si), of(self)) }
    }

    /// Returns the error of a quantity that is no `order`-th derivative here, with an example in the axis unit.
    fn wrong_dimension(&self, quantity: &Quantity, order: u8) -> UnitError {
        UnitError::wrong_dimension(*quantity, self.kind.dimension(order)).in_unit(self.unit.unit())
    }

    fn si_unit(&self) -> Unit {
        self.kind.dimension(0).si_unit()
    }

    /// Returns the increments per `unit`; `None` for rad.
    fn exact_per(&self, unit: AxisUnit) -> Option<Fraction> {
        if unit == Unit::INCREMENT.into() {
            return Some(Fraction::from(1));
        }
        self.per_base.checked_mul(&unit.unit().in_base()?)?.checked_mul(&unit.share())
    }

    /// Returns the increments per `unit`, as the nearest f64.
    fn per(&self, unit: AxisUnit) -> f64 {
        match self.exact_per(unit) {
            Some(exact) => fraction_to_f64(&exact),
            None => {
                let factor = unit.unit().in_base().map_or(1.0 / TAU, |factor| fraction_to_f64(&factor));
                fraction_to_f64(&self.per_base) * factor * fraction_to_f64(&unit.share())
            }
        }
    }

    fn position_in(&self, unit: AxisUnit, increments: i64, fraction: f64) -> f64 {
        let whole = Fraction::from(i128::from(increments));
        let rest = fraction / self.per(unit);
        match self.exact_per(unit).and_then(|per| whole.checked_div(&per)) {
            Some(exact) => fraction_to_f64(&exact) + rest,
            None => increments as f64 / self.per(unit) + rest,
        }
    }

    /// Returns the increments of a position in f64, for the case that the exact fraction exceeds 128 bits.
    fn approximate_increments(&self, quantity: &Quantity) -> f64 {
        let plain = quantity.unit().with_order(0);
        fraction_to_f64(&quantity.value()) * if plain == Unit::INCREMENT { 1.0 } else { self.per(plain.into()) }
    }
}

impl From<Scale> for SiScale {
    fn from(scale: Scale) -> Self {
        let unit = scale.si_unit().into();
        Self::new(scale, scale.exact_per(unit), scale.per(unit))
    }
}

/// Returns the number of digits of a decimal number, without leading zeros.
fn significant_digits(number: &str) -> usize {
    number.trim_start_matches(['-', '0', '.']).bytes().filter(u8::is_ascii_digit).count()
}

/// Returns the quantity in m, revolutions or increments (per s^n).
fn in_base(quantity: &Quantity) -> Result<Fraction, UnitError> {
    match (quantity.exact(), quantity.unit().in_base()) {
        (Some(exact), _) => Ok(exact),
        (None, Some(_)) => Err(UnitError::Inexact { given: *quantity }),
        (None, None) => fraction_from_f64(fraction_to_f64(&quantity.value()) / TAU),
    }
}

#[cfg(test)]
mod tests;

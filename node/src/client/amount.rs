//! Parses quantities of the command line, such as `10 mm` or `-90 deg`.
//!
//! Law      a number has a unit; 0 needs none. A goal has one unit for all of its quantities: SI, or increments
//! Refuses  a number without a unit, since 50 may be 50 m or 50 mm; a unit of another dimension than the axis; increments together with
//!          other units

use super::Failure;
use lineshaft_core::unit::{Dimension, Fraction, Quantity, ScaleKind, Unit, UnitError, parse_decimal};

/// Kind of an axis, and its displayed unit, if known.
pub(super) type AxisKind = (ScaleKind, Option<Unit>);

/// A quantity as given. Its unit exists, but may not fit the axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Given {
    name: &'static str,
    text: String,
    /// Order of the time derivative: 0 position, 1 velocity, 2 acceleration.
    order: u8,
    form: Form,
}

/// Format of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// A number in increments.
    Increments,
    /// A number in another unit.
    Unit,
    /// The number 0 without a unit, which is 0 in every unit.
    Zero,
    /// A number without a unit.
    Bare,
}

impl Given {
    /// Parses a quantity of the argument `name`: a position (`order` 0), a velocity (1) or an acceleration (2).
    ///
    /// # Errors
    /// Returns an error unless it is a number with a unit of length, angle or increments.
    pub(crate) fn read(name: &'static str, text: &str, order: u8) -> Result<Self, Failure> {
        let all = [Dimension::Length(order), Dimension::Angle(order), Dimension::Increments(order)];
        let quantity = Quantity::parse(text, &all).map_err(|error| match &error {
            UnitError::NotANumber { .. } if error.hint().is_none() => {
                let (length, angle) = (Dimension::Length(order).such_as(None), Dimension::Angle(order).such_as(None));
                Failure::Usage(format!("{name}: {error}; {length}, or {angle}, is expected"))
            }
            _ => wrong(name, &error),
        })?;
        let form = match parse_decimal(text.trim()) {
            Ok(number) if number == Fraction::from(0) => Form::Zero,
            Ok(_) => Form::Bare,
            Err(_) if quantity.unit().dimension() == Dimension::Increments(order) => Form::Increments,
            Err(_) => Form::Unit,
        };
        Ok(Self { name, text: text.trim().to_owned(), order, form })
    }

    /// Returns the value in SI, for an axis of this kind.
    ///
    /// # Errors
    /// Returns an error if it has no unit, or one of another kind.
    pub(super) fn si(&self, axis: AxisKind) -> Result<f64, Failure> {
        self.value(axis.0.dimension(self.order), axis)
    }

    /// Returns the value in increments, or in SI for an axis of this kind.
    ///
    /// # Errors
    /// Same errors as `si`.
    pub(super) fn in_units(&self, units: GoalUnits, axis: AxisKind) -> Result<f64, Failure> {
        match units {
            GoalUnits::Si => self.si(axis),
            GoalUnits::Increments => self.value(Dimension::Increments(self.order), axis),
        }
    }

    /// Returns the value of a velocity or an acceleration of a goal, in which 0 would mean the default.
    ///
    /// # Errors
    /// Same errors as `in_units`, and an error if the value does not exceed 0.
    pub(super) fn rate(&self, units: GoalUnits, axis: AxisKind) -> Result<f64, Failure> {
        let value = self.in_units(units, axis)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(Failure::Usage(format!(
            "{}: `{}` must exceed 0; without it the axis uses its default",
            self.name, self.text
        )))
    }

    fn value(&self, dimension: Dimension, (kind, unit): AxisKind) -> Result<f64, Failure> {
        if self.form == Form::Bare {
            return Err(self.without_unit(kind, unit));
        }
        let quantity = Quantity::parse(&self.text, &[dimension]).map_err(|error| match unit {
            Some(unit) => wrong(self.name, &error.in_unit(unit)),
            None => wrong(self.name, &error),
        })?;
        Ok(quantity.si())
    }

    /// Returns the error for a number without a unit, with a hint: the unit of the axis, otherwise the most common ones
    /// of its kind.
    fn without_unit(&self, kind: ScaleKind, unit: Option<Unit>) -> Failure {
        let Self { name, text, order, .. } = self;
        let dimension = kind.dimension(*order);
        let own = unit.map(|unit| unit.with_order(*order));
        let hint = match own {
            Some(own) if [dimension, Dimension::Increments(*order)].contains(&own.dimension()) => {
                format!("did you mean `{text} {own}`?")
            }
            _ => {
                format!("write a unit, such as `{text} {}` or `{text} {}`", dimension.usual_unit(), dimension.si_unit())
            }
        };
        Failure::Usage(format!("{name}: `{text}` has no unit; {hint}"))
    }
}

fn wrong(name: &str, error: &UnitError) -> Failure {
    Failure::Usage(format!("{name}: {}", error.message_with_hint()))
}

/// Unit of all quantities of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GoalUnits {
    Si,
    Increments,
}

impl GoalUnits {
    /// Returns the unit that fits all of these quantities.
    ///
    /// # Errors
    /// Returns an error if some are in increments and others are not.
    pub(super) fn of(all: &[&Given]) -> Result<Self, Failure> {
        let with_unit = all.iter().copied().filter(|given| given.form != Form::Zero);
        let (increments, others): (Vec<&Given>, Vec<&Given>) =
            with_unit.partition(|given| given.form == Form::Increments);
        match (increments.first(), others.first()) {
            (None, _) => Ok(Self::Si),
            (Some(_), None) => Ok(Self::Increments),
            (Some(one), Some(other)) => Err(Failure::Usage(format!(
                "{}: `{}` is in increments, but {} `{}` is not; give all quantities in increments, or none",
                one.name, one.text, other.name, other.text
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn position(text: &str) -> Given {
        Given::read("POSITION", text, 0).unwrap()
    }

    fn sentence(result: Result<impl std::fmt::Debug, Failure>) -> String {
        match result.unwrap_err() {
            Failure::Usage(sentence) => sentence,
            other => panic!("{other:?} is no usage error"),
        }
    }

    const MILLIMETRES: AxisKind = (ScaleKind::Linear, Some(Unit::MILLIMETRE));
    const DEGREES: AxisKind = (ScaleKind::Rotary, Some(Unit::DEGREE));

    #[test]
    fn number_without_unit_is_refused_with_the_unit_of_the_axis() {
        let refused = |axis| sentence(position("50").si(axis));
        assert_eq!(refused(MILLIMETRES), "POSITION: `50` has no unit; did you mean `50 mm`?");
        assert_eq!(refused(DEGREES), "POSITION: `50` has no unit; did you mean `50 deg`?");
        assert_eq!(
            refused((ScaleKind::Linear, Some(Unit::INCREMENT))),
            "POSITION: `50` has no unit; did you mean `50 inc`?"
        );
        let fast = Given::read("--velocity", " -0.2 ", 1).unwrap();
        assert_eq!(sentence(fast.si(MILLIMETRES)), "--velocity: `-0.2` has no unit; did you mean `-0.2 mm/s`?");
        // The unit of the axis is unknown, or of another kind.
        for unit in [None, Some(Unit::DEGREE)] {
            let refused = refused((ScaleKind::Linear, unit));
            assert_eq!(refused, "POSITION: `50` has no unit; write a unit, such as `50 mm` or `50 m`");
        }
        let refused = sentence(fast.si((ScaleKind::Rotary, None)));
        assert_eq!(refused, "--velocity: `-0.2` has no unit; write a unit, such as `-0.2 deg/s` or `-0.2 rad/s`");
    }

    /// 0 is the same in every unit, and fits every other quantity of a goal.
    #[test]
    fn zero_needs_no_unit() {
        for text in ["0", "-0.0"] {
            assert_eq!(position(text).si(MILLIMETRES), Ok(0.0), "{text}");
        }
        let fast = Given::read("--velocity", "500 inc/s", 1).unwrap();
        assert_eq!(GoalUnits::of(&[&position("0"), &fast]), Ok(GoalUnits::Increments));
        assert_eq!(position("0").in_units(GoalUnits::Increments, DEGREES), Ok(0.0));
    }

    #[test]
    fn units_are_converted_to_si() {
        assert_eq!(position("10 mm").si(MILLIMETRES), Ok(0.01));
        assert_eq!(position("-50 um").si(MILLIMETRES), Ok(-0.00005));
        assert_eq!(position("90 deg").si(DEGREES), Ok(FRAC_PI_2));
        assert_eq!(position("1 rev").si(DEGREES), Ok(TAU));
        assert_eq!(Given::read("--velocity", "60 rpm", 1).unwrap().si(DEGREES), Ok(TAU));
        assert_eq!(Given::read("--acceleration", "250 mm/s^2", 2).unwrap().si(MILLIMETRES), Ok(0.25));
    }

    #[test]
    fn unit_of_another_kind_than_the_axis_is_refused_with_an_example_in_the_unit_of_the_axis() {
        let refused = |text, axis| sentence(position(text).si(axis));
        let length = "POSITION: `90 deg` is an angle; a length such as";
        assert_eq!(refused("90 deg", MILLIMETRES), format!("{length} `90 mm` is expected"));
        assert_eq!(refused("90 deg", (ScaleKind::Linear, Some(Unit::METRE))), format!("{length} `90 m` is expected"));
        assert_eq!(refused("90 deg", (ScaleKind::Linear, None)), format!("{length} `90 mm` is expected"));
        assert_eq!(refused("10 mm", DEGREES), "POSITION: `10 mm` is a length; an angle such as `10 deg` is expected");
    }

    #[test]
    fn text_that_is_no_quantity_is_refused_before_anything_is_sent() {
        assert_eq!(
            sentence(Given::read("POSITION", "near", 0)),
            "POSITION: `near` is not a number; a length such as `1 mm`, or an angle such as `1 deg`, is expected"
        );
        assert_eq!(
            sentence(Given::read("POSITION", "1,5 mm", 0)),
            "POSITION: `1,5` is not a number; write a decimal point, not a comma"
        );
        let refused = sentence(Given::read("POSITION", "10mm", 0));
        assert_eq!(refused, "POSITION: `10mm` has no blank between number and unit; write `10 mm`");
        assert!(sentence(Given::read("POSITION", "10 s", 0)).contains("`10 s` is a time"));
        assert!(sentence(Given::read("--velocity", "10 mm", 1)).contains("`10 mm` is a length"));
        assert!(sentence(Given::read("POSITION", "NaN", 0)).contains("is not a number"));
    }

    #[test]
    fn goal_has_one_unit() {
        let (inc, mm) = (position("1000 inc"), position("10 mm"));
        let (fast, bare) = (Given::read("--velocity", "500 inc/s", 1).unwrap(), position("1 m"));
        assert_eq!(GoalUnits::of(&[&inc, &fast]), Ok(GoalUnits::Increments));
        assert_eq!(GoalUnits::of(&[&mm, &bare]), Ok(GoalUnits::Si));
        assert_eq!(inc.in_units(GoalUnits::Increments, MILLIMETRES), Ok(1000.0));
        let refused = sentence(GoalUnits::of(&[&mm, &fast]));
        assert!(
            refused.starts_with("--velocity: `500 inc/s` is in increments, but POSITION `10 mm` is not"),
            "{refused}"
        );
    }

    /// In a goal 0 means the default velocity, which is not the meaning of `--velocity 0`.
    #[test]
    fn rate_of_a_goal_must_exceed_zero() {
        for text in ["0", "-5 mm/s"] {
            let given = Given::read("--velocity", text, 1).unwrap();
            let refused = sentence(given.rate(GoalUnits::Si, MILLIMETRES));
            assert!(refused.starts_with(&format!("--velocity: `{text}` must exceed 0")), "{refused}");
        }
        let given = Given::read("--velocity", "5 mm/s", 1).unwrap();
        assert_eq!(given.rate(GoalUnits::Si, MILLIMETRES), Ok(0.005));
    }
}

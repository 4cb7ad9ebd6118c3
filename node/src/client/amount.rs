//! Quantities of the command line, such as `10 mm` or `-90 deg`.
//!
//! Law      a number without a unit is SI: m or rad, and per s, s^2. A goal has one unit for all of its quantities: SI, or increments
//! Refuses  a unit of another dimension than the axis, increments together with other units

use super::Failure;
use lineshaft_core::unit::{Dimension, Quantity, ScaleKind, UnitError};

/// A quantity as it was given. Its unit exists, but may not fit the axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Given {
    name: &'static str,
    text: String,
    /// Order of the time derivative: 0 position, 1 velocity, 2 acceleration.
    order: u8,
    is_in_increments: bool,
}

impl Given {
    /// Reads a quantity of the argument `name`: a position (`order` 0), a velocity (1) or an acceleration (2).
    ///
    /// # Errors
    /// It is not a number with a unit of a length, an angle or increments.
    pub(crate) fn read(name: &'static str, text: &str, order: u8) -> Result<Self, Failure> {
        let all = [Dimension::Length(order), Dimension::Angle(order), Dimension::Increments(order)];
        let quantity = Quantity::parse(text, &all).map_err(|error| wrong(name, &error))?;
        let is_in_increments = quantity.unit().dimension() == Dimension::Increments(order);
        Ok(Self { name, text: text.to_owned(), order, is_in_increments })
    }

    /// The value in SI, for an axis of this kind.
    ///
    /// # Errors
    /// The unit is of another kind.
    pub(super) fn si(&self, kind: ScaleKind) -> Result<f64, Failure> {
        self.value(kind.dimension(self.order))
    }

    /// The value in increments, or in SI for an axis of this kind.
    pub(super) fn in_units(&self, units: GoalUnits, kind: ScaleKind) -> Result<f64, Failure> {
        match units {
            GoalUnits::Si => self.si(kind),
            GoalUnits::Increments => self.value(Dimension::Increments(self.order)),
        }
    }

    /// Likewise, of a velocity or an acceleration of a goal, where 0 would mean the default.
    ///
    /// # Errors
    /// Likewise, or it does not exceed 0.
    pub(super) fn rate(&self, units: GoalUnits, kind: ScaleKind) -> Result<f64, Failure> {
        let value = self.in_units(units, kind)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(Failure::Usage(format!(
            "{}: `{}` must exceed 0; without it the axis uses its default",
            self.name, self.text
        )))
    }

    fn value(&self, dimension: Dimension) -> Result<f64, Failure> {
        let quantity = Quantity::parse(&self.text, &[dimension]).map_err(|error| wrong(self.name, &error))?;
        Ok(quantity.si())
    }
}

fn wrong(name: &str, error: &UnitError) -> Failure {
    let hint = error.hint().map(|hint| format!("; {hint}")).unwrap_or_default();
    Failure::Usage(format!("{name}: {error}{hint}"))
}

/// Unit of all quantities of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GoalUnits {
    Si,
    Increments,
}

impl GoalUnits {
    /// The unit that fits all of these quantities.
    ///
    /// # Errors
    /// Some are in increments, and others are not.
    pub(super) fn of(all: &[&Given]) -> Result<Self, Failure> {
        let (increments, others): (Vec<&Given>, Vec<&Given>) =
            all.iter().copied().partition(|given| given.is_in_increments);
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

    #[test]
    fn number_without_unit_is_si() {
        assert_eq!(position("0.01").si(ScaleKind::Linear), Ok(0.01));
        assert_eq!(position("-1.5").si(ScaleKind::Rotary), Ok(-1.5));
        assert_eq!(Given::read("--velocity", "0.2", 1).unwrap().si(ScaleKind::Linear), Ok(0.2));
    }

    #[test]
    fn units_are_converted_to_si() {
        assert_eq!(position("10 mm").si(ScaleKind::Linear), Ok(0.01));
        assert_eq!(position("-50 um").si(ScaleKind::Linear), Ok(-0.00005));
        assert_eq!(position("90 deg").si(ScaleKind::Rotary), Ok(FRAC_PI_2));
        assert_eq!(position("1 rev").si(ScaleKind::Rotary), Ok(TAU));
        assert_eq!(Given::read("--velocity", "60 rpm", 1).unwrap().si(ScaleKind::Rotary), Ok(TAU));
        assert_eq!(Given::read("--acceleration", "250 mm/s^2", 2).unwrap().si(ScaleKind::Linear), Ok(0.25));
    }

    #[test]
    fn unit_of_another_kind_than_the_axis_is_refused() {
        let refused = sentence(position("90 deg").si(ScaleKind::Linear));
        assert!(refused.starts_with("POSITION: `90 deg` is an angle; a length such as "), "{refused}");
        let refused = sentence(position("10 mm").si(ScaleKind::Rotary));
        assert!(refused.starts_with("POSITION: `10 mm` is a length; an angle such as "), "{refused}");
    }

    #[test]
    fn text_that_is_no_quantity_is_refused_before_anything_is_sent() {
        assert_eq!(sentence(Given::read("POSITION", "near", 0)), "POSITION: `near` is not a number");
        let refused = sentence(Given::read("POSITION", "10mm", 0));
        assert_eq!(refused, "POSITION: `10mm` has no blank between number and unit; write `10 mm`");
        assert!(sentence(Given::read("POSITION", "10 s", 0)).contains("`10 s` is a time"));
        assert!(sentence(Given::read("--velocity", "10 mm", 1)).contains("`10 mm` is a length"));
        assert!(sentence(Given::read("POSITION", "NaN", 0)).contains("is not a number"));
    }

    #[test]
    fn goal_has_one_unit() {
        let (inc, mm) = (position("1000 inc"), position("10 mm"));
        let (fast, bare) = (Given::read("--velocity", "500 inc/s", 1).unwrap(), position("1"));
        assert_eq!(GoalUnits::of(&[&inc, &fast]), Ok(GoalUnits::Increments));
        assert_eq!(GoalUnits::of(&[&mm, &bare]), Ok(GoalUnits::Si));
        assert_eq!(inc.in_units(GoalUnits::Increments, ScaleKind::Linear), Ok(1000.0));
        let refused = sentence(GoalUnits::of(&[&mm, &fast]));
        assert!(
            refused.starts_with("--velocity: `500 inc/s` is in increments, but POSITION `10 mm` is not"),
            "{refused}"
        );
    }

    /// In a goal 0 means the default velocity, which is not what `--velocity 0` asks for.
    #[test]
    fn rate_of_a_goal_must_exceed_zero() {
        for text in ["0", "-5 mm/s"] {
            let given = Given::read("--velocity", text, 1).unwrap();
            let refused = sentence(given.rate(GoalUnits::Si, ScaleKind::Linear));
            assert!(refused.starts_with(&format!("--velocity: `{text}` must exceed 0")), "{refused}");
        }
        let given = Given::read("--velocity", "5 mm/s", 1).unwrap();
        assert_eq!(given.rate(GoalUnits::Si, ScaleKind::Linear), Ok(0.005));
    }
}

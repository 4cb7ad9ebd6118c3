//! Keys `type`, `unit` and `scale` of axes and encoders.

use super::names::quote;
use super::parameters::{refuse_range, whole};
use crate::document::{Allowed, Map, Value};
use lineshaft_core::parameter::{self, Row};
use lineshaft_core::unit::{Dimension, Fraction, MacsFactors, Quantity, Scale, ScaleKind, Unit, UnitError};

/// The unit factors of MACS (MACS-UNIT-01).
const FACTORS: [&str; 6] = ["posfact_z", "posfact_n", "feedrev", "feeddist", "posencqc", "posencrev"];

/// How something moves, as far as it could be read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Travel {
    pub kind: Option<ScaleKind>,
    pub scale: Option<Scale>,
}

impl Travel {
    /// Keys `type` and `scale`.
    pub(super) fn read(map: &mut Map<'_>) -> Self {
        let kinds = [("linear", ScaleKind::Linear), ("rotary", ScaleKind::Rotary)];
        let kind = map.required("type").and_then(|value| value.choice(&kinds));
        let scale = map.required("scale").and_then(|value| scale(&value, kind));
        Self { kind: kind.or(scale.map(|scale| scale.kind())), scale }
    }

    /// Key `unit`.
    pub(super) fn read_unit(&mut self, map: &mut Map<'_>) {
        let Some(unit) = map.optional("unit").and_then(|value| unit(&value, self.kind)) else { return };
        // A unit that does not fit the scale does not fit the type, and that is reported there.
        self.scale = self.scale.and_then(|scale| scale.with_unit(unit).ok());
    }

    /// Keys `type`, `unit` and `scale` of an axis; the unit factors of MACS may stand in the place of `scale`.
    pub(super) fn read_axis(map: &mut Map<'_>) -> (Self, Option<MacsFactors>) {
        if !FACTORS.iter().any(|key| map.has(key)) {
            let mut travel = Self::read(map);
            travel.read_unit(map);
            let one = travel.scale.map(|scale| Quantity::new(Fraction::from(1), scale.unit()));
            let ratio = travel.scale.zip(one).and_then(|(scale, one)| scale.exact(&one).ok());
            return (travel, ratio.and_then(|ratio| MacsFactors::of_ratio(&ratio)));
        }
        if let Some(scale) = map.optional("scale") {
            let sentence = "scale stands beside the unit factors of MACS, which say the same".to_owned();
            scale.refuse(sentence, Some("write one of them".to_owned()));
        }
        let kinds = [("linear", ScaleKind::Linear), ("rotary", ScaleKind::Rotary)];
        let kind = map.required("type").and_then(|value| value.choice(&kinds));
        let given = map.optional("unit");
        let user_unit = given.as_ref().and_then(|value| unit(value, kind));
        let mut factors = MacsFactors::default();
        let mut is_good = given.is_none() || user_unit.is_some();
        if let (Some(value), Some(Unit::INCREMENT)) = (&given, user_unit) {
            let sentence =
                "unit is `inc`; beside the unit factors of MACS, increments per unit, a length or an angle is allowed";
            value.refuse(sentence, None);
            is_good = false;
        }
        let mut anchor = None;
        let places = [
            &mut factors.posfact_z,
            &mut factors.posfact_n,
            &mut factors.feedrev,
            &mut factors.feeddist,
            &mut factors.posencqc,
            &mut factors.posencrev,
        ];
        for (key, place) in FACTORS.iter().zip(places) {
            let Some(value) = map.optional(key) else { continue };
            match factor(key, &value) {
                Some(number) => *place = number,
                None => is_good = false,
            }
            anchor = Some(value);
        }
        let scale = is_good.then_some(()).and(kind).and_then(|kind| {
            let user_unit = user_unit.unwrap_or(kind.dimension(0).si_unit());
            let scale = Scale::from_macs(&factors, Quantity::new(Fraction::from(1), user_unit));
            let scale = scale.and_then(|scale| scale.with_unit(user_unit));
            let value = anchor.as_ref().or(given.as_ref())?;
            scale.map_err(|error| value.refuse(format!("unit factors: {error}"), error.hint())).ok()
        });
        (Self { kind, scale }, Some(factors))
    }

    /// Its scale, or one that stands in for it where only the kind of quantities matters.
    pub(super) fn any_scale(&self) -> Option<Scale> {
        let unit = self.kind.unwrap_or(ScaleKind::Linear).dimension(0).si_unit();
        self.scale.or_else(|| Scale::new(Fraction::from(1), Quantity::new(Fraction::from(1), unit)).ok())
    }
}

/// One of the unit factors, in its range.
fn factor(key: &str, value: &Value<'_>) -> Option<i64> {
    let (_, row) = Row::find(key)?;
    let number = whole(row, value, &Scale::increments())?;
    if row.check(parameter::Value::Int(number)).is_err() {
        refuse_range(row, value, &Scale::increments(), f64::INFINITY);
        return None;
    }
    Some(number)
}

fn unit(value: &Value<'_>, kind: Option<ScaleKind>) -> Option<Unit> {
    let of = |kind: ScaleKind| kind.dimension(0).units();
    let names = match kind {
        Some(kind) => of(kind),
        None => [of(ScaleKind::Linear), of(ScaleKind::Rotary)].join(", "),
    };
    let units: Vec<_> = names.split(", ").chain(["inc"]).filter_map(|name| Some((name, Unit::parse(name)?))).collect();
    value.choice(&units)
}

fn scale(value: &Value<'_>, kind: Option<ScaleKind>) -> Option<Scale> {
    let mut map = value.map("scale")?;
    let both = [Dimension::Length(0), Dimension::Angle(0)];
    let dimensions = kind.map_or(both.to_vec(), |kind| vec![kind.dimension(0)]);
    let increments = map.required("increments");
    let number = increments.as_ref().and_then(Value::fraction);
    let per = map.required("per").and_then(|value| value.quantity(&dimensions, &Allowed::Positive));
    map.finish();
    match Scale::new(number?, per?) {
        Ok(scale) => Some(scale),
        Err(UnitError::NotPositive { .. }) => {
            let value = increments?;
            let given = quote(value.peek().unwrap_or_default());
            value.refuse(format!("increments is {given}; a number above 0 is allowed"), None);
            None
        }
        Err(error) => {
            value.refuse(format!("scale: {error}"), error.hint());
            None
        }
    }
}

//! Reads keys `type`, `unit` and `scale` of axes and encoders.

use super::names::quote;
use super::row::{refuse_range, whole};
use crate::document::{Allowed, Map, Value};
use lineshaft_core::parameter::{self, Row};
use lineshaft_core::unit::{
    AxisUnit, Dimension, Fraction, MacsFactors, Quantity, Scale, ScaleKind, Unit, UnitError, fraction_to_f64,
    parse_decimal,
};

/// Unit factors of MACS (MACS-UNIT-01).
const FACTORS: [&str; 6] = ["posfact_z", "posfact_n", "feedrev", "feeddist", "posencqc", "posencrev"];

/// Type, scale and unit, as far as they could be read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Travel {
    pub kind: Option<ScaleKind>,
    pub scale: Option<Scale>,
}

impl Travel {
    /// Reads keys `type` and `scale`.
    pub(super) fn read(map: &mut Map<'_>) -> Self {
        let kinds = [("linear", ScaleKind::Linear), ("rotary", ScaleKind::Rotary)];
        let kind = map.required("type").and_then(|value| value.choice(&kinds));
        let scale = map.required("scale").and_then(|value| scale(&value, kind));
        Self { kind: kind.or(scale.map(|scale| scale.kind())), scale }
    }

    /// Reads key `unit`: a unit, or a number with a unit.
    pub(super) fn read_unit(&mut self, map: &mut Map<'_>) {
        let Some(unit) = map.optional("unit").and_then(|value| unit(&value, self.kind)) else { return };
        // A unit that does not fit the scale does not fit the type either, and is reported at the type.
        self.scale = self.scale.and_then(|scale| scale.with_unit(unit).ok());
    }

    /// Reads keys `type`, `unit` and `scale` of an axis; unit factors of MACS may replace `scale`.
    pub(super) fn read_axis(map: &mut Map<'_>) -> (Self, Option<MacsFactors>) {
        if !FACTORS.iter().any(|key| map.has(key)) {
            let mut travel = Self::read(map);
            travel.read_unit(map);
            let one = travel.scale.and_then(|scale| scale.unit().times(Fraction::from(1)).ok());
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
        if let (Some(value), true) = (&given, user_unit == Some(Unit::INCREMENT.into())) {
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
            let user_unit = user_unit.unwrap_or(kind.dimension(0).si_unit().into());
            let scale = user_unit.times(Fraction::from(1)).and_then(|one| Scale::from_macs(&factors, one));
            let scale = scale.and_then(|scale| scale.with_unit(user_unit));
            let value = anchor.as_ref().or(given.as_ref())?;
            let scale = scale.map_err(|error| value.refuse(format!("unit factors: {error}"), error.hint())).ok()?;
            plausible(scale, value, "unit factors")
        });
        (Self { kind, scale }, Some(factors))
    }

    /// Returns the scale, or a substitute if only the dimension of quantities matters.
    pub(super) fn any_scale(&self) -> Option<Scale> {
        let unit = self.kind.unwrap_or(ScaleKind::Linear).dimension(0).si_unit();
        self.scale.or_else(|| Scale::new(Fraction::from(1), Quantity::new(Fraction::from(1), unit)).ok())
    }
}

/// Refuses a scale outside of the range of real machines: values derived from it would have no meaning.
fn plausible(scale: Scale, value: &Value<'_>, what: &str) -> Option<Scale> {
    let (increment, is_plausible) = scale.increment();
    let unit = match scale.kind() {
        ScaleKind::Linear => "m",
        ScaleKind::Rotary => "rev",
    };
    if !is_plausible {
        let one = fraction_to_f64(&increment);
        value.refuse(format!("{what}: one increment is {one:e} {unit}; 1e-18 to 1e9 {unit} is allowed"), None);
    }
    is_plausible.then_some(scale)
}

/// Reads one of the unit factors, with its range.
fn factor(key: &str, value: &Value<'_>) -> Option<i64> {
    let (_, row) = Row::find(key)?;
    let number = whole(row, value, &Scale::increments())?;
    if row.check(parameter::Value::Int(number)).is_err() {
        refuse_range(row, value, &Scale::increments(), None);
        return None;
    }
    Some(number)
}

/// Spellings of inch.
const INCH: [&str; 3] = ["in", "inch", "inches"];

/// Reads a unit by name, or a positive number with a unit: `mm`, `0.1 mm`.
fn unit(value: &Value<'_>, kind: Option<ScaleKind>) -> Option<AxisUnit> {
    if value.peek().is_some_and(|text| text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))) {
        return share(value, kind);
    }
    let of = |kind: ScaleKind| kind.dimension(0).units();
    let names = match kind {
        Some(kind) => of(kind),
        None => [of(ScaleKind::Linear), of(ScaleKind::Rotary)].join(", "),
    };
    let units: Vec<_> = names.split(", ").chain(["inc"]).filter_map(|name| Some((name, Unit::parse(name)?))).collect();
    // The most similar name is `inc`, which is never meant by these.
    if let Some(text) = value.peek().filter(|text| INCH.contains(&text.to_lowercase().as_str())) {
        let sentence = format!("unit is {}; one of {names}, inc is allowed", quote(text));
        value.refuse(sentence, (kind != Some(ScaleKind::Rotary)).then(|| "an inch is `25.4 mm`".to_owned()));
        return None;
    }
    // `grad` is not `rad`, and `degrees` means `deg`.
    if let Some(text) = value.peek().filter(|text| Unit::parse(text).is_none())
        && let Some(meant) = Unit::meant(text, kind.unwrap_or(ScaleKind::Linear).dimension(0))
        && units.iter().any(|(name, _)| *name == meant)
    {
        let sentence = format!("unit is {}; one of {names}, inc is allowed", quote(text));
        value.refuse(sentence, Some(format!("did you mean `{meant}`?")));
        return None;
    }
    value.choice(&units).map(AxisUnit::from)
}

/// Reads a fraction of a unit, such as `0.1 mm`; increments cannot be divided.
fn share(value: &Value<'_>, kind: Option<ScaleKind>) -> Option<AxisUnit> {
    let kinds = kind.map_or(vec![ScaleKind::Linear, ScaleKind::Rotary], |kind| vec![kind]);
    let dimensions: Vec<_> = kinds.into_iter().map(|kind| kind.dimension(0)).collect();
    let text = value.text()?;
    if parse_decimal(text).is_ok() {
        let sentence = format!("unit is {}; a unit, or a number above 0 with one, is allowed", quote(text));
        value.refuse(
            sentence,
            Some(format!("write `{} {}`", text, if kind == Some(ScaleKind::Rotary) { "deg" } else { "mm" })),
        );
        return None;
    }
    AxisUnit::new(value.quantity(&dimensions, &Allowed::Positive)?).ok()
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
        Ok(scale) => plausible(scale, increments.as_ref()?, "scale"),
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

//! Keys `type`, `unit` and `scale` of axes and encoders.

use super::names::quote;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::unit::{Dimension, Fraction, Quantity, Scale, ScaleKind, Unit, UnitError};

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

    /// Its scale, or one that stands in for it where only the kind of quantities matters.
    pub(super) fn any_scale(&self) -> Option<Scale> {
        let unit = self.kind.unwrap_or(ScaleKind::Linear).dimension(0).si_unit();
        self.scale.or_else(|| Scale::new(Fraction::from(1), Quantity::new(Fraction::from(1), unit)).ok())
    }
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

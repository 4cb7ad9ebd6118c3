//! Verbs `home_axis` and `set_position` (contract section 7).

use super::{Effect, Reader, UNITS, amount, number};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::request::{Amount, HomeRequest, RequestError, SetPositionRequest, Units};
use lineshaft_core::unit::Scale;

const SCHEMES: [(&str, u8); 3] = [("configured", 0), ("cia402", 1), ("macs", 2)];

impl Reader<'_> {
    pub(super) fn home_axis(&mut self, value: &Value<'_>) -> (Option<Effect>, Option<usize>) {
        let Some(mut map) = value.map("home_axis") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let axis = map.required("axis");
        let scheme = number(&mut map, "scheme", &SCHEMES);
        let method = map.optional("method").map_or(Some(0), |method| method.integer(i8::MIN..=i8::MAX));
        map.finish();
        let deed = (|| {
            let axis = axis?;
            let request = HomeRequest { axis: axis.text()?.to_owned(), scheme: scheme?, method: method? };
            let result = self.names.config.resolve_home(&request).map(Action::HomeAxis);
            // In most cases a method without a scheme is a number of CiA 402.
            if let Err(error @ RequestError::BadChoice { field: "method", .. }) = &result
                && self.refused.is_none()
            {
                value.refuse(error.to_string(), Some("write `scheme: cia402`".to_owned()));
                return None;
            }
            let at = if matches!(result, Err(RequestError::UnknownAxis { .. })) { &axis } else { value };
            self.to_command(at, result)
        })();
        (deed, id.flatten())
    }

    pub(super) fn set_position(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("set_position")?;
        let axis = map.required("axis");
        let scale = axis.as_ref().and_then(|axis| self.zero_scale(axis.peek()?));
        let units = number(&mut map, "units", &UNITS);
        let given = map.optional("position");
        let read = |value| amount(value, 0, scale.as_ref(), units == Some(2));
        let position = given.as_ref().map_or(Some(Amount::default()), read);
        let relative = map.optional("relative").map_or(Some(false), |value| value.boolean());
        map.finish();
        let units = match Units::from_number(units?) {
            Ok(units) => units,
            Err(error) => return self.to_command(value, Err(error)),
        };
        let axis = axis?;
        let request = SetPositionRequest { axis: axis.text()?.to_owned(), position: position?, units };
        let result = match relative? {
            true => self.names.config.resolve_shift_position(&request),
            false => self.names.config.resolve_set_position(&request),
        };
        let at = match &result {
            Err(RequestError::UnknownAxis { .. }) => &axis,
            Err(RequestError::BadValue { .. }) => given.as_ref().unwrap_or(value),
            _ => value,
        };
        self.to_command(at, result)
    }

    /// Returns the scale of an object whose position can be set.
    fn zero_scale(&self, name: &str) -> Option<Scale> {
        let config = self.names.config;
        let encoder = config.encoders.iter().find(|encoder| encoder.name == name).map(|encoder| encoder.scale);
        let master = name.ends_with(".master").then(Scale::increments);
        encoder.or(master).or_else(|| config.find_axis(name).ok().map(|(_, axis)| axis.scale))
    }
}

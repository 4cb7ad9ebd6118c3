//! Verbs `touch_probe` and `abort_trigger`: positions recorded at latches without a motion (contract section 7).

use super::probe::EDGES;
use super::{Effect, Reader, UNITS, amount, number};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::request::{AbortTriggerRequest, Amount, TouchProbeRequest, Units};

impl Reader<'_> {
    pub(super) fn touch_probe(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("touch_probe")?;
        let (axis, event) = (map.required("axis"), map.required("event"));
        let scale = self.scale(axis.as_ref());
        let [edge, units] = [("edge", &EDGES[..]), ("units", &UNITS)].map(|(key, names)| number(&mut map, key, names));
        let continuous = map.optional("continuous").map_or(Some(false), |value| value.boolean());
        let given = [map.optional("first_position"), map.optional("last_position")];
        // A limit of the window implies that the window is used.
        let has_window = given.iter().any(Option::is_some);
        let window_only = map.optional("window_only").map_or(Some(has_window), |value| value.boolean());
        let [first_position, last_position] = given.map(|place| {
            place.map_or(Some(Amount::default()), |place| amount(&place, 0, scale.as_ref(), units == Some(2)))
        });
        map.finish();
        let units = match Units::from_number(units?) {
            Ok(units) => units,
            Err(error) => return self.to_command(value, Err(error)),
        };
        let request = TouchProbeRequest {
            axis: axis?.text()?.to_owned(),
            event: event?.text()?.to_owned(),
            edge: edge?,
            continuous: continuous?,
            units,
            window_only: window_only?,
            first_position: first_position?,
            last_position: last_position?,
        };
        self.to_command(value, self.names.config.resolve_touch_probe(&request).map(Action::TouchProbe))
    }

    pub(super) fn abort_trigger(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("abort_trigger")?;
        let (axis, event) = (map.required("axis"), map.optional("event"));
        map.finish();
        let event = event.map_or(Some(String::new()), |event| event.text().map(str::to_owned));
        let request = AbortTriggerRequest { axis: axis?.text()?.to_owned(), event: event? };
        self.to_command(value, self.names.config.resolve_abort_trigger(&request).map(Action::AbortTrigger))
    }
}

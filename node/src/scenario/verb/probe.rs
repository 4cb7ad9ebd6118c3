//! Verb `probe_axis` (contract section 7).

use super::{Effect, Reader, UNITS, number, optional_amount, optional_rates};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::request::{MoveRequest, ProbeRequest, Units};

const MODES: [(&str, u8); 2] = [("absolute", 0), ("relative", 1)];
pub(super) const EDGES: [(&str, u8); 4] = [("rising", 0), ("falling", 1), ("both", 2), ("index", 3)];

impl Reader<'_> {
    pub(super) fn probe_axis(&mut self, value: &Value<'_>) -> (Option<Effect>, Option<usize>) {
        let Some(mut map) = value.map("probe_axis") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let (axis, event) = (map.required("axis"), map.required("event"));
        let scale = self.scale(axis.as_ref());
        let [mode, units, edge] = [("mode", &MODES[..]), ("units", &UNITS), ("edge", &EDGES)]
            .map(|(key, names)| number(&mut map, key, names));
        let in_increments = units == Some(2);
        let position = self.position(&mut map, mode, scale.as_ref(), in_increments);
        let rates = optional_rates(&mut map, scale.as_ref(), in_increments);
        let distance = optional_amount(&mut map, "distance", 0, scale.as_ref(), in_increments);
        map.finish();
        let deed = (|| {
            let units = match Units::from_number(units?) {
                Ok(units) => units,
                Err(error) => return self.to_command(value, Err(error)),
            };
            let search = MoveRequest {
                axis: axis?.text()?.to_owned(),
                mode: mode?,
                units,
                position: position?,
                rates: rates?,
                ..MoveRequest::default()
            };
            let (event, edge, distance) = (event?.text()?.to_owned(), edge?, distance?);
            let request = ProbeRequest { search, event, edge, distance };
            self.to_command(value, self.names.config.resolve_probe(&request).map(Action::Probe))
        })();
        (deed, id.flatten())
    }
}

//! Verb `phase`: shifts an axis relative to its leader (contract section 10).

use super::{Effect, Reader, number, optional_amount};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::request::PhaseRequest;

const SLAVE: u8 = 0;
const SIDES: [(&str, u8); 2] = [("slave", SLAVE), ("master", 1)];

impl Reader<'_> {
    pub(super) fn phase(&mut self, value: &Value<'_>) -> (Option<Effect>, Option<usize>) {
        let Some(mut map) = value.map("phase") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let axis = map.required("axis");
        let side = number(&mut map, "side", &SIDES);
        // The leader is unknown here.
        let scale = self.scale(axis.as_ref()).filter(|_| side == Some(SLAVE));
        let [shift, velocity, acceleration] = [("shift", 0), ("velocity", 1), ("acceleration", 2)]
            .map(|(key, order)| optional_amount(&mut map, key, order, scale.as_ref(), false));
        map.finish();
        let deed = (|| {
            let request = PhaseRequest {
                axis: axis?.text()?.to_owned(),
                side: side?,
                shift: shift?,
                velocity: velocity?,
                acceleration: acceleration?,
            };
            self.to_command(value, self.names.config.resolve_phase(&request).map(Action::Phase))
        })();
        (deed, id.flatten())
    }
}

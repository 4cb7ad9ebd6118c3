//! Verb `gear_out`: ends a coupling at a position (contract section 7).

use super::{Effect, Reader, number, whole};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::request::GearOutRequest;

const PLACES: [(&str, u8); 3] = [("now", 0), ("master_position", 1), ("position", 2)];
const DISENGAGES: [(&str, u8); 3] = [("stop", 0), ("keep_velocity", 1), ("as_goal", 2)];

impl Reader<'_> {
    pub(super) fn gear_out(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("gear_out")?;
        let axis = map.required("axis");
        let [at, disengage] =
            [("at", &PLACES), ("disengage", &DISENGAGES)].map(|(key, names)| number(&mut map, key, names));
        let increments = whole(&mut map, "increments");
        map.finish();
        let request =
            GearOutRequest { axis: axis?.text()?.to_owned(), at: at?, increments: increments?, disengage: disengage? };
        self.to_command(value, self.names.config.resolve_gear_out(&request).map(Action::GearOut))
    }
}

//! Verb `out_an`: commands a value to the loops below the position loop (contract section 5).

use super::{Effect, Reader};
use crate::document::Value;
use lineshaft_core::command::{Action, Level};
use lineshaft_core::request::OutAnRequest;

impl Reader<'_> {
    pub(super) fn out_an(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("out_an")?;
        let (axis, given) = (map.required("axis"), map.required("value"));
        let level = map.optional("level").map_or(Some(Level::default()), |level| level.choice(Level::NAMES));
        map.finish();
        let request = OutAnRequest { axis: axis?.text()?.to_owned(), value: given?.number(-1.0..=1.0)?, level: level? };
        self.to_command(value, self.names.config.resolve_out_an(&request).map(Action::OutAn))
    }
}

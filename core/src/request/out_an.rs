//! Conversion of requests for the loops below the position loop.
//!
//! Law      the value is a fraction of full scale, independent of the unit of the axis
//! Reads    the names of the cell
//! Refuses  an unknown axis, values beyond 1, levels without a meaning
//! Source   MACS-AMP-02, MACS-CMD-28

use super::choice::{names, number_of};
use super::{Named, Presence, RequestError, Verb, VerbFields};
use crate::command::{Action, Level, OutAn};
use crate::config::MachineConfig;
use crate::object::Object;
use crate::unit::number_to_text;

/// A value for the loops below the position loop, with names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutAnRequest {
    /// Name of the axis.
    pub axis: String,
    /// Value, -1 to 1.
    pub value: f64,
    /// Loop that receives the value.
    pub level: Level,
}

impl OutAnRequest {
    /// Returns the request of a command.
    pub(super) fn of(command: &OutAn, config: &MachineConfig) -> Self {
        let OutAn { axis, value, level } = *command;
        Self { axis: config.name_or_nameless(Object::Axis(axis)), value, level }
    }
}

impl Verb for OutAnRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.real("value", -1.0..=1.0, &mut self.value);
        let mut level = number_of(Level::NAMES, &self.level);
        fields.word("level", &names(Level::NAMES), &mut level);
        self.level = Level::NAMES.get(usize::from(level)).map_or(self.level, |(_, level)| *level);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_out_an(self).map(Action::OutAn)
    }
}

impl MachineConfig {
    /// Converts the request to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_out_an(&self, request: &OutAnRequest) -> Result<OutAn, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let OutAnRequest { value, level, .. } = *request;
        if !(-1.0..=1.0).contains(&value) {
            let (name, value, allowed) = ("value".to_owned(), number_to_text(value), "-1 to 1".to_owned());
            return Err(RequestError::BadParameter { name, value, allowed });
        }
        // A recording keeps no -0.
        Ok(OutAn { axis, value: value + 0.0, level })
    }
}

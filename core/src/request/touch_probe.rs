//! Conversion of passive touch probes.
//!
//! Law      the window is in the units of the axis, like a target of `move_axis`
//! Reads    the names of the cell
//! Refuses  names of objects that do not latch, numbers without a meaning, positions of a window that is not used
//! Source   contract section 7, PLCopen (MC_TouchProbe, MC_AbortTrigger)

use super::choice::{names, number_of};
use super::{Amount, EDGES, Named, Presence, RequestError, UnitOf, Units, Verb, VerbFields, bad_value};
use crate::command::{AbortTrigger, Action, TouchProbe};
use crate::config::MachineConfig;
use crate::object::Object;
use crate::position::Length;

/// A passive touch probe, with names and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchProbeRequest {
    /// Name of the axis.
    pub axis: String,
    /// Name of the latch.
    pub event: String,
    /// 0 rising, 1 falling, 2 both, 3 the index of the axis itself.
    pub edge: u8,
    /// Whether every latch is recorded until the probe is aborted.
    pub continuous: bool,
    /// Units of numbers without a unit.
    pub units: Units,
    /// Whether only latches between first and last position are recorded.
    pub window_only: bool,
    /// First position of the window.
    pub first_position: Amount,
    /// Last position of the window.
    pub last_position: Amount,
}

/// A request to end touch probes, with names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AbortTriggerRequest {
    /// Name of the axis.
    pub axis: String,
    /// Name of their latch; empty: all touch probes of the axis.
    pub event: String,
}

impl TouchProbeRequest {
    /// Returns the request of a command, in increments.
    pub(super) fn of(command: &TouchProbe, config: &MachineConfig) -> Self {
        let [first_position, last_position] = command.window.unwrap_or_default().map(Amount::Increments);
        Self {
            axis: config.name_or_nameless(Object::Axis(command.axis)),
            event: config.name_or_nameless(command.source),
            edge: number_of(&EDGES, &command.edge),
            continuous: command.continuous,
            units: Units::default(),
            window_only: command.window.is_some(),
            first_position,
            last_position,
        }
    }
}

impl Verb for TouchProbeRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.name("event", Named::Other, Presence::Required, &mut self.event);
        fields.choice("edge", &names(&EDGES), Presence::Optional, &mut self.edge);
        fields.units(&mut self.units);
        fields.boolean("continuous", false, &mut self.continuous);
        let presence = if self.window_only { Presence::Written } else { Presence::Optional };
        fields.amount("first_position", 0, UnitOf::Axis, presence, &mut self.first_position);
        fields.amount("last_position", 0, UnitOf::Axis, presence, &mut self.last_position);
        // A limit of the window implies that the window is used.
        let has_window = fields.has("first_position") || fields.has("last_position");
        fields.boolean("window_only", has_window, &mut self.window_only);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_touch_probe(self).map(Action::TouchProbe)
    }
}

impl AbortTriggerRequest {
    /// Returns the request of a command.
    pub(super) fn of(command: &AbortTrigger, config: &MachineConfig) -> Self {
        let event = command.source.map(|source| config.name_or_nameless(source)).unwrap_or_default();
        Self { axis: config.name_or_nameless(Object::Axis(command.axis)), event }
    }
}

impl Verb for AbortTriggerRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.name("event", Named::Other, Presence::Optional, &mut self.event);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_abort_trigger(self).map(Action::AbortTrigger)
    }
}

impl MachineConfig {
    /// Converts a passive touch probe to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_touch_probe(&self, request: &TouchProbeRequest) -> Result<TouchProbe, RequestError> {
        let (index, axis) = self.find_axis(&request.axis)?;
        let source = self.find_latch(&request.event)?;
        let edge = self.probe_edge(request.edge, index, source)?;
        let place =
            |field, amount: &Amount| amount.length(request.units, &axis.scale).map_err(|error| bad_value(field, error));
        let first = place("first_position", &request.first_position)?;
        let last = place("last_position", &request.last_position)?;
        let is_given = [first, last] != [Length::default(); 2];
        if is_given && !request.window_only {
            return Err(RequestError::BadChoice {
                field: "window_only",
                value: 0,
                allowed: "without it first_position and last_position must be 0",
            });
        }
        let window = request.window_only.then_some([first, last]);
        Ok(TouchProbe { axis: index, source, edge, continuous: request.continuous, window })
    }

    /// Converts the end of touch probes to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_abort_trigger(&self, request: &AbortTriggerRequest) -> Result<AbortTrigger, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let source = if request.event.is_empty() { None } else { Some(self.find_latch(&request.event)?) };
        Ok(AbortTrigger { axis, source })
    }
}

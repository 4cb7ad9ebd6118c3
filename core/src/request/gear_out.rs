//! Conversion of requests to end a coupling at a position.
//!
//! Law      the position is in increments, as for `synchronize`: of the leader, which the machine determines when it
//!          executes the command, or of the axis
//! Reads    the names of the cell
//! Refuses  numbers without a meaning, a position beyond the range of positions, a position that is not used
//! Source   contract section 7, PLCopen (MC_GearOut, MC_CamOut)

use super::choice::{chosen, names, number_of, unknown};
use super::synchronize::checked_position;
use super::{Named, Presence, RequestError, Verb, VerbFields};
use crate::command::{Action, DisengageAt, GearOut};
use crate::config::MachineConfig;
use crate::object::Object;
use crate::sync::Disengage;

const PLACES: [&str; 3] = ["now", "master_position", "position"];
const DISENGAGES: [(&str, Option<Disengage>); 3] =
    [("stop", Some(Disengage::Stop)), ("keep_velocity", Some(Disengage::KeepVelocity)), ("as_goal", None)];

/// A request to end a coupling, with names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GearOutRequest {
    /// Name of the following axis.
    pub axis: String,
    /// 0 now, 1 at a position of its master, 2 at a position of the axis.
    pub at: u8,
    /// That position (inc).
    pub increments: i64,
    /// 0 stop, 1 keep velocity, 2 as given in its goal.
    pub disengage: u8,
}

impl GearOutRequest {
    /// Returns the request of a command.
    pub(super) fn of(command: &GearOut, config: &MachineConfig) -> Self {
        let (at, increments) = match command.at {
            DisengageAt::Now => (0, 0),
            DisengageAt::Leader(place) => (1, place),
            DisengageAt::Axis(place) => (2, place),
        };
        let axis = config.name_or_nameless(Object::Axis(command.axis));
        Self { axis, at, increments, disengage: number_of(&DISENGAGES, &command.disengage) }
    }
}

impl Verb for GearOutRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.list_in_order(&["axis", "at", "disengage", "increments"]);
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.choice("at", &PLACES, Presence::Written, &mut self.at);
        fields.whole("increments", i64::MIN..=i64::MAX, Presence::Optional, &mut self.increments);
        fields.choice("disengage", &names(&DISENGAGES), Presence::Optional, &mut self.disengage);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_gear_out(self).map(Action::GearOut)
    }
}

impl MachineConfig {
    /// Converts the end of a coupling to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_gear_out(&self, request: &GearOutRequest) -> Result<GearOut, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let increments = request.increments;
        let at = match (request.at, increments) {
            (0, 0) => DisengageAt::Now,
            (0, given) => {
                let allowed = "0 is allowed with at NOW, which waits for no place";
                return Err(RequestError::BadChoice { field: "increments", value: given, allowed });
            }
            (1, given) => DisengageAt::Leader(checked_position("increments", given)?),
            (2, given) => DisengageAt::Axis(checked_position("increments", given)?),
            (other, _) => return Err(unknown("at", other, &PLACES)),
        };
        let disengage = chosen("disengage", request.disengage, &DISENGAGES)?;
        Ok(GearOut { axis, at, disengage })
    }
}

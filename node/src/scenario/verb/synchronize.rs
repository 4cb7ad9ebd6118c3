//! Verb `synchronize`: a gear or a cam (contract sections 7, 10).
//!
//! Law      a position is an integer number of increments, or has a unit: of the axis, or of the leader
//! Refuses  one part of a ratio without the other: 9 : 0 is no gear

use super::{Effect, Reader, number, optional_amount};
use crate::document::{Allowed, Map, Value};
use crate::scenario::moment::bare;
use lineshaft_core::command::Action;
use lineshaft_core::request::{CamRequest, SynchronizeRequest};
use lineshaft_core::sync::CamStart;
use lineshaft_core::unit::{Dimension, Fraction, Scale};

const MODES: [(&str, u8); 6] =
    [("velocity", 0), ("position", 1), ("marker", 2), ("cam", 3), ("cam_master_marker", 4), ("cam_slave_marker", 5)];
/// Number of the first cam mode; higher ones are cam modes, too.
const FIRST_CAM: u8 = 3;
const AT_POSITION: u8 = 1;
const ON_EVENT: u8 = 2;
const ENGAGES: [(&str, u8); 4] =
    [("immediately", 0), ("at_position", AT_POSITION), ("on_event", ON_EVENT), ("at_end", 3)];
const DISENGAGES: [(&str, u8); 2] = [("stop", 0), ("keep_velocity", 1)];

impl Reader<'_> {
    pub(super) fn synchronize(&mut self, value: &Value<'_>) -> (Option<Effect>, Option<usize>) {
        let Some(mut map) = value.map("synchronize") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let axis = map.required("axis");
        let master = map.optional("master").map_or(Some(String::new()), |master| master.text().map(str::to_owned));
        let scale = self.scale(axis.as_ref());
        let given_event = map.optional("event");
        let [mode, engage, disengage] = [("mode", &MODES[..]), ("engage", &ENGAGES), ("disengage", &DISENGAGES)]
            .map(|(key, names)| number(&mut map, key, names));
        let [numerator, denominator] = self.ratio(&mut map, mode);
        let leads = master.as_deref().and_then(|name| self.leading_scale(name));
        let places = [("master_increments", leads), ("slave_increments", scale), ("start_distance_increments", leads)];
        let places = places.map(|(key, scale)| {
            let Some(given) = map.optional(key) else { return Some(0) };
            let place = increments(&given, scale)?;
            let has_meaning = engage == Some(AT_POSITION);
            if !has_meaning {
                given.refuse(format!("{key} belongs to `engage: at_position`"), None);
            }
            has_meaning.then_some(place)
        });
        let event = given_event.map_or(Some(String::new()), |given| {
            let name = given.text()?;
            let has_meaning = name.is_empty() || engage == Some(ON_EVENT);
            if !has_meaning {
                given.refuse("event belongs to `engage: on_event`", None);
            }
            has_meaning.then(|| name.to_owned())
        });
        let [offset, velocity, acceleration] = [("offset", 0), ("velocity", 1), ("acceleration", 2)]
            .map(|(key, order)| optional_amount(&mut map, key, order, scale.as_ref(), false));
        let cam = cam(&mut map, scale.as_ref());
        map.finish();
        let deed = (|| {
            let [master_increments, slave_increments, start_distance_increments] = places;
            let request = SynchronizeRequest {
                axis: axis?.text()?.to_owned(),
                master: master?,
                event: event?,
                mode: mode?,
                engage: engage?,
                master_increments: master_increments?,
                slave_increments: slave_increments?,
                start_distance_increments: start_distance_increments?,
                disengage: disengage?,
                numerator: numerator?,
                denominator: denominator?,
                offset: offset?,
                velocity: velocity?,
                acceleration: acceleration?,
                cam: cam?,
            };
            let config = self.names.config;
            let resolved = if self.recorded {
                config.resolve_recorded_synchronize(&request)
            } else {
                config.resolve_synchronize(&request)
            };
            self.to_command(value, resolved.map(Action::Synchronize))
        })();
        (deed, id.flatten())
    }

    /// Reads both parts of the ratio. If both are absent they are 0, as a cam requires. A gear with only one of them
    /// lacks the other.
    fn ratio(&self, map: &mut Map<'_>, mode: Option<u8>) -> [Option<i64>; 2] {
        let is_half = map.has("numerator") != map.has("denominator");
        let is_refused = is_half && !self.recorded && mode.is_some_and(|mode| mode < FIRST_CAM);
        ["numerator", "denominator"].map(|key| {
            let given = if is_refused { Some(map.required(key)?) } else { map.optional(key) };
            given.map_or(Some(0), |value| value.integer(i64::MIN..=i64::MAX))
        })
    }

    /// Returns the scale of a leader; `None` if nothing with that name can lead, or if it has increments only.
    fn leading_scale(&self, name: &str) -> Option<Scale> {
        let leader = self.names.config.find_leader(name).ok()?;
        self.names.config.known_scale_of(leader)
    }
}

/// Reads a position in increments, or with a unit.
fn increments(value: &Value<'_>, scale: Option<Scale>) -> Option<i64> {
    let scale = scale.filter(|_| !value.is_integer() && bare(value).is_none());
    let Some(scale) = scale else { return value.integer(i64::MIN..=i64::MAX) };
    let dimensions = [scale.kind().dimension(0), Dimension::Increments(0)];
    let quantity = value.quantity_in(Some(scale.unit().unit()), &dimensions, &Allowed::Any)?;
    scale.position(&quantity).map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()
}

/// Reads the arguments of mode cam; scales may be fractions such as `1/3`.
fn cam(map: &mut Map<'_>, slave: Option<&Scale>) -> Option<CamRequest> {
    let table = map.optional("table").map_or(Some(String::new()), |table| table.text().map(str::to_owned));
    let start = number(map, "cam_start", &CamStart::ALL.map(|(_, number, name)| (name, number)));
    let [master_scale, slave_scale] = ["master_scale", "slave_scale"]
        .map(|key| map.optional(key).map_or(Some(Fraction::default()), |scale| scale.fraction()));
    let master_offset = optional_amount(map, "master_offset", 0, None, false);
    let slave_offset = optional_amount(map, "slave_offset", 0, slave, false);
    Some(CamRequest {
        table: table?,
        start: start?,
        master_scale: master_scale?,
        slave_scale: slave_scale?,
        master_offset: master_offset?,
        slave_offset: slave_offset?,
    })
}

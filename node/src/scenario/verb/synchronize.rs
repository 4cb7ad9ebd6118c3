//! Verb `synchronize`: a gear or a cam (contract sections 7, 10).

use super::{Deed, Reader, number, optional_amount, whole};
use crate::document::{Map, Value};
use lineshaft_core::command::Action;
use lineshaft_core::request::{CamRequest, SynchronizeRequest};
use lineshaft_core::sync::CamStart;
use lineshaft_core::unit::{Fraction, Scale};

const MODES: [(&str, u8); 6] =
    [("velocity", 0), ("position", 1), ("marker", 2), ("cam", 3), ("cam_master_marker", 4), ("cam_slave_marker", 5)];
const AT_POSITION: u8 = 1;
const ON_EVENT: u8 = 2;
const ENGAGES: [(&str, u8); 4] =
    [("immediately", 0), ("at_position", AT_POSITION), ("on_event", ON_EVENT), ("at_end", 3)];
const DISENGAGES: [(&str, u8); 2] = [("stop", 0), ("keep_velocity", 1)];

impl Reader<'_> {
    pub(super) fn synchronize(&mut self, value: &Value<'_>) -> (Option<Deed>, Option<usize>) {
        let Some(mut map) = value.map("synchronize") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let axis = map.required("axis");
        let master = map.optional("master").map_or(Some(String::new()), |master| master.text().map(str::to_owned));
        let scale = self.scale(axis.as_ref());
        let given_event = map.optional("event");
        let [mode, engage, disengage] = [("mode", &MODES[..]), ("engage", &ENGAGES), ("disengage", &DISENGAGES)]
            .map(|(key, names)| number(&mut map, key, names));
        let [numerator, denominator] = ["numerator", "denominator"].map(|key| whole(&mut map, key));
        let places = ["master_increments", "slave_increments", "start_distance_increments"].map(|key| {
            let Some(given) = map.optional(key) else { return Some(0) };
            let place = given.integer(i64::MIN..=i64::MAX)?;
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
            self.settle(value, resolved.map(Action::Synchronize))
        })();
        (deed, id.flatten())
    }
}

/// What belongs to mode cam; scales may be fractions such as `1/3`.
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

//! Verbs for couplings: start, phase shift and end.

use super::motion::latching;
use super::numbers::{amount, factor, given, shift};
use super::values::Scalar;
use super::{NAMELESS, Verb, axis};
use lineshaft_core::command::{DisengageAt, Engage, GearOut, Phase, PhaseSide, Synchronize as Coupling};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::object::{Leader, Object, VIRTUAL_MASTER};
use lineshaft_core::sync::{Disengage, SyncMode};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Synchronize<'a> {
    id: String,
    axis: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    master: Option<String>,
    mode: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    engage: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    event: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    master_increments: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slave_increments: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    start_distance_increments: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    disengage: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    numerator: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    denominator: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    acceleration: Option<String>,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    cam: Option<Cam<'a>>,
}

#[derive(Serialize)]
struct Cam<'a> {
    table: &'a str,
    cam_start: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    master_scale: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slave_scale: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    master_offset: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slave_offset: Option<String>,
}

pub(super) fn synchronize<'a>(id: String, request: &Coupling, config: &'a MachineConfig) -> Synchronize<'a> {
    let whole = |number: i64| Some(number).filter(|&number| number != 0);
    let none = [None; 3];
    let (engage, places, event) = match request.engage {
        Engage::Immediately => (None, none, None),
        Engage::AtPosition { position, .. } => (Some("at_position"), [whole(position), None, None], None),
        Engage::InPosition { position, slave, distance, .. } => {
            (Some("at_position"), [position, slave, distance].map(whole), None)
        }
        Engage::OnEvent(source) => (Some("on_event"), none, Some(latching(source, config))),
        Engage::AtEnd => (Some("at_end"), none, None),
    };
    let [master_increments, slave_increments, start_distance_increments] = places;
    Synchronize {
        id,
        axis: axis(request.axis, config),
        master: request.leader.map(|leader| match leader {
            // No command contains it by name; the axis refers to it.
            Leader::Simulated(_) => NAMELESS.to_owned(),
            Leader::Virtual => VIRTUAL_MASTER.to_owned(),
            Leader::AxisCommand(index) => axis(index, config).to_owned(),
            Leader::Sink(index) => format!("{}.sink", config.name(Object::Function(index))),
            Leader::AxisActual(index) => format!("{}.actual", axis(index, config)),
            Leader::Sum(index) => {
                let master = config.masters.get(usize::from(index));
                master.map_or(NAMELESS, |master| &master.name).to_owned()
            }
            Leader::Encoder(index) => {
                let encoder = config.encoders.get(usize::from(index));
                encoder.map_or(NAMELESS, |encoder| &encoder.name).to_owned()
            }
        }),
        mode: match request.mode {
            SyncMode::MasterMarker => "cam_master_marker",
            SyncMode::SlaveMarker => "cam_slave_marker",
            _ if request.cam.is_some() => "cam",
            SyncMode::Velocity => "velocity",
            SyncMode::Position => "position",
            SyncMode::Marker => "marker",
        },
        engage,
        event,
        master_increments,
        slave_increments,
        start_distance_increments,
        disengage: match request.disengage {
            Disengage::Stop => None,
            Disengage::KeepVelocity => Some("keep_velocity"),
        },
        numerator: whole(request.numerator),
        denominator: whole(request.denominator),
        offset: shift(request.offset),
        velocity: given(request.velocity, 1),
        acceleration: given(request.acceleration, 2),
        cam: request.cam.as_ref().map(|cam| Cam {
            table: config.name(Object::Table(cam.table)),
            cam_start: cam.start.name(),
            master_scale: factor(cam.master_scale),
            slave_scale: factor(cam.slave_scale),
            master_offset: shift(cam.master_offset),
            slave_offset: shift(cam.slave_offset),
        }),
    }
}

pub(super) fn phase<'a>(id: String, request: &Phase, config: &'a MachineConfig) -> Verb<'a> {
    let text = |text: Option<String>| text.map(Scalar::Text);
    let (side, [shift, velocity, acceleration]) = match &request.side {
        PhaseSide::Slave(of) => {
            ("slave", [text(shift(of.shift)), text(given(of.velocity, 1)), text(given(of.acceleration, 2))])
        }
        // The scale of the increments depends on the leader.
        PhaseSide::Master { given, .. } => ("master", given.map(amount)),
    };
    Verb::Phase { id, axis: axis(request.axis, config), side, shift, velocity, acceleration }
}

pub(super) fn gear_out(request: GearOut, config: &MachineConfig) -> Verb<'_> {
    let (at, increments) = match request.at {
        DisengageAt::Now => ("now", 0),
        DisengageAt::Leader(place) => ("master_position", place),
        DisengageAt::Axis(place) => ("position", place),
    };
    let disengage = match request.disengage {
        Some(Disengage::Stop) => None,
        Some(Disengage::KeepVelocity) => Some("keep_velocity"),
        None => Some("as_goal"),
    };
    Verb::GearOut {
        axis: axis(request.axis, config),
        at,
        increments: (increments != 0).then_some(increments),
        disengage,
    }
}

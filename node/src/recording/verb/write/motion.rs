//! Verbs for the motion of one axis: moves, touch probes and homing.

use super::numbers::{given, length, rate};
use super::{NAMELESS, Verb, axis};
use lineshaft_core::command::{
    BufferMode, HomeAxis as Homing, HomingMethod, Move, MoveMode, Probe, ProbeEdge, TouchProbe,
};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::Object;
use lineshaft_core::position::Length;
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct MoveAxis<'a> {
    id: String,
    axis: &'a str,
    mode: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    acceleration: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    deceleration: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    jerk: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    buffer_mode: Option<&'static str>,
}

#[derive(Serialize)]
pub(super) struct ProbeAxis<'a> {
    #[serde(flatten)]
    search: MoveAxis<'a>,
    event: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    edge: Option<&'static str>,
    distance: String,
}

#[derive(Serialize)]
pub(super) struct HomeAxis<'a> {
    id: String,
    axis: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    scheme: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<i8>,
}

pub(super) fn move_axis<'a>(id: String, request: &Move, config: &'a MachineConfig) -> MoveAxis<'a> {
    let runs = request.mode == MoveMode::Velocity;
    MoveAxis {
        id,
        axis: axis(request.axis, config),
        mode: match request.mode {
            MoveMode::Absolute => "absolute",
            MoveMode::Relative => "relative",
            MoveMode::Additive => "additive",
            MoveMode::Velocity => "velocity",
            MoveMode::Superimposed => "superimposed",
        },
        position: Some(length(request.target)).filter(|_| !runs || request.target != Length::default()),
        // The velocity or position of a goal is always written, even if it is the default.
        velocity: if runs { Some(rate(request.velocity, 1)) } else { given(request.velocity, 1) },
        acceleration: given(request.acceleration, 2),
        deceleration: given(request.deceleration, 2),
        jerk: given(request.jerk, 3),
        direction: match request.direction {
            Direction::Shortest => None,
            Direction::Positive => Some("positive"),
            Direction::Negative => Some("negative"),
            Direction::Current => Some("current"),
        },
        buffer_mode: match request.buffer_mode {
            BufferMode::Aborting => None,
            BufferMode::Buffered => Some("buffered"),
            BufferMode::BlendingLow => Some("blending_low"),
            BufferMode::BlendingPrevious => Some("blending_previous"),
            BufferMode::BlendingNext => Some("blending_next"),
            BufferMode::BlendingHigh => Some("blending_high"),
        },
    }
}

/// Returns the name of the object that latches.
pub(super) fn latching(source: Object, config: &MachineConfig) -> &str {
    let io = |index: u16| config.io.get(usize::from(index)).map(|io| &io.name);
    let encoder = |index: u16| config.encoders.get(usize::from(index)).map(|encoder| &encoder.name);
    match source {
        Object::Io(index) => io(index).map_or(NAMELESS, String::as_str),
        Object::Encoder(index) => encoder(index).map_or(NAMELESS, String::as_str),
        Object::Axis(index) => axis(index, config),
        Object::Machine | Object::Memory(_) | Object::Function(_) | Object::Table(_) | Object::Program(_) => NAMELESS,
    }
}

pub(super) fn probe_axis<'a>(id: String, request: &Probe, config: &'a MachineConfig) -> ProbeAxis<'a> {
    ProbeAxis {
        search: move_axis(id, &request.search(), config),
        event: latching(request.source, config),
        edge: edge(request.edge),
        distance: length(request.distance),
    }
}

fn edge(edge: ProbeEdge) -> Option<&'static str> {
    match edge {
        ProbeEdge::Rising => None,
        ProbeEdge::Falling => Some("falling"),
        ProbeEdge::Both => Some("both"),
        ProbeEdge::Index => Some("index"),
    }
}

pub(super) fn touch_probe<'a>(request: &TouchProbe, config: &'a MachineConfig) -> Verb<'a> {
    let [first_position, last_position] = [0, 1].map(|end| request.window.map(|window| length(window[end])));
    Verb::TouchProbe {
        axis: axis(request.axis, config),
        event: latching(request.source, config),
        edge: edge(request.edge),
        continuous: request.continuous.then_some(true),
        first_position,
        last_position,
    }
}

pub(super) fn home_axis<'a>(id: String, request: &Homing, config: &'a MachineConfig) -> HomeAxis<'a> {
    let (scheme, method) = match request.method {
        HomingMethod::Configured => (None, None),
        HomingMethod::Cia402(method) => (Some("cia402"), Some(method)),
        HomingMethod::Macs(method) => (Some("macs"), Some(method)),
    };
    HomeAxis { id, axis: axis(request.axis, config), scheme, method }
}

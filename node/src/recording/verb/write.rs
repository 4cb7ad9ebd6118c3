//! Writes a command as text.

use super::{saia, trajectory, wf};
use crate::program;
use lineshaft_core::command::{
    Action, BufferMode, Command, CommandFunction, DisengageAt, Engage, GearOut, HomeAxis as Homing, HomingMethod,
    Level, MasterPosition, Move, MoveMode, OutAn, Phase, PhaseSide, Probe, ProbeEdge, Setpoint, Setpoints,
    Synchronize as Coupling, TouchProbe,
};
use lineshaft_core::config::{IoKind, MachineConfig, MemoryKind};
use lineshaft_core::function::Order;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader, Object, VIRTUAL_MASTER};
use lineshaft_core::parameter::{Change, Layer, MACHINE, Measure, Value};
use lineshaft_core::position::Length;
use lineshaft_core::sync::gear::Ratio;
use lineshaft_core::sync::{Disengage, SyncMode};
use lineshaft_core::table::{Form, Table};
use lineshaft_core::unit::{Amount, Unit, fraction_to_digits};
use lineshaft_core::vocabulary::Request;
use serde::{Serialize, Serializer};
use serde_json::ser::Formatter;
use std::borrow::Cow;
use std::io;

/// Placeholder for a missing name. No object can have this name, so it is refused when read back.
const NAMELESS: &str = "?";

/// Returns the verb of a command, as JSON.
pub(super) fn verb(command: &Command, config: &MachineConfig) -> String {
    text(&verb_of(command, config))
}

/// Returns setpoints, as JSON.
pub(super) fn setpoints(set: &Setpoints, config: &MachineConfig) -> String {
    let axes = (0..).zip(&set.axes).filter_map(|(index, setpoint)| {
        let Setpoint { velocity, duration } = (*setpoint)?;
        let velocity = rate(velocity, 1);
        let value = match duration {
            None => Streamed::Velocity(velocity),
            Some(ns) => Streamed::For { velocity, duration: format!("{ns} ns") },
        };
        Some((axis(index, config).to_owned(), value))
    });
    text(&Verb::Setpoints { axes: StreamedAxes(axes.collect()) })
}

fn text(verb: &Verb<'_>) -> String {
    let mut bytes = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, Printable);
    verb.serialize(&mut serializer).expect("names, texts and numbers have a JSON form, and a Vec takes all bytes");
    String::from_utf8(bytes).expect("the serializer writes UTF-8")
}

/// Verb with its arguments in the order in which they are written.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum Verb<'a> {
    Enable(Axes<'a>),
    Disable(Axes<'a>),
    Halt(Axes<'a>),
    QuickStop(Axes<'a>),
    ResetErrors(Axes<'a>),
    Activate(Nothing),
    Deactivate(Nothing),
    Abort(Nothing),
    MoveAxis(MoveAxis<'a>),
    ProbeAxis(ProbeAxis<'a>),
    TouchProbe {
        axis: &'a str,
        event: &'a str,
        #[serde(skip_serializing_if = "Option::is_none")]
        edge: Option<&'static str>,
        #[serde(skip_serializing_if = "Option::is_none")]
        continuous: Option<bool>,
        #[serde(skip_serializing_if = "Option::is_none")]
        first_position: Option<String>,
        #[serde(skip_serializing_if = "Option::is_none")]
        last_position: Option<String>,
    },
    AbortTrigger {
        axis: &'a str,
        #[serde(skip_serializing_if = "Option::is_none")]
        event: Option<&'a str>,
    },
    QueryTrajectory {
        axis: &'a str,
        time: String,
    },
    HomeAxis(HomeAxis<'a>),
    SetPosition {
        axis: Cow<'a, str>,
        #[serde(skip_serializing_if = "Option::is_none")]
        relative: Option<bool>,
        #[serde(skip_serializing_if = "Option::is_none")]
        units: Option<&'static str>,
        position: Scalar,
    },
    Synchronize(Synchronize<'a>),
    Phase {
        id: String,
        axis: &'a str,
        side: &'static str,
        #[serde(skip_serializing_if = "Option::is_none")]
        shift: Option<Scalar>,
        #[serde(skip_serializing_if = "Option::is_none")]
        velocity: Option<Scalar>,
        #[serde(skip_serializing_if = "Option::is_none")]
        acceleration: Option<Scalar>,
    },
    GearOut {
        axis: &'a str,
        at: &'static str,
        #[serde(skip_serializing_if = "Option::is_none")]
        increments: Option<i64>,
        #[serde(skip_serializing_if = "Option::is_none")]
        disengage: Option<&'static str>,
    },
    OutAn {
        axis: &'a str,
        value: Scalar,
        #[serde(skip_serializing_if = "Option::is_none")]
        level: Option<&'static str>,
    },
    FollowJointTrajectory(trajectory::FollowJointTrajectory<'a>),
    Cancel {
        id: String,
    },
    SetParameters(Entries),
    SaveParameters(Axes<'a>),
    ResetParameters {
        axes: Vec<&'a str>,
        #[serde(skip_serializing_if = "Option::is_none")]
        layer: Option<&'static str>,
    },
    DeleteParameters(Axes<'a>),
    Inject {
        power_cycle: Nothing,
    },
    SetMemory(Entries),
    CommandFunction {
        function: &'a str,
        command: &'static str,
        #[serde(skip_serializing_if = "Entries::is_empty")]
        parameters: Entries,
    },
    RunFunction {
        id: String,
        function: &'a str,
        #[serde(skip_serializing_if = "Entries::is_empty")]
        parameters: Entries,
    },
    LoadTable {
        table: &'a str,
        points: Numbers<'a>,
    },
    LoadProgram {
        program: &'a str,
        module: String,
        state: &'static str,
    },
    SetOutput(Entries),
    Setpoints {
        axes: StreamedAxes,
    },
    Saia(saia::Saia<'a>),
    Wf(wf::Wf<'a>),
    Refuse {
        text: &'a str,
    },
    Note {
        code: u32,
        number: i64,
    },
}

/// Streamed axes by name, in the order of the cell file.
struct StreamedAxes(Vec<(String, Streamed)>);

impl Serialize for StreamedAxes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum Streamed {
    Velocity(String),
    For { velocity: String, duration: String },
}

/// Written as `{}`.
#[derive(Serialize)]
struct Nothing {}

#[derive(Serialize)]
struct Axes<'a> {
    axes: Vec<&'a str>,
}

#[derive(Serialize)]
struct MoveAxis<'a> {
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
struct ProbeAxis<'a> {
    #[serde(flatten)]
    search: MoveAxis<'a>,
    event: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    edge: Option<&'static str>,
    distance: String,
}

#[derive(Serialize)]
struct HomeAxis<'a> {
    id: String,
    axis: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    scheme: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<i8>,
}

#[derive(Serialize)]
struct Synchronize<'a> {
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

/// Names and values in the order of the command.
pub(super) struct Entries(pub(super) Vec<(String, Scalar)>);

impl Entries {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Serialize for Entries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum Scalar {
    Nothing,
    Text(String),
    Whole(i128),
    Real(f64),
}

fn verb_of<'a>(command: &'a Command, config: &'a MachineConfig) -> Verb<'a> {
    let axes = |set: &AxisSet| Axes { axes: axes(*set, config) };
    let id = command.sequence.to_string();
    match &command.action {
        Action::Trajectory(run) => Verb::FollowJointTrajectory(trajectory::follow(id, run, config)),
        Action::Enable(set) => Verb::Enable(axes(set)),
        Action::Disable(set) => Verb::Disable(axes(set)),
        Action::Halt(set) => Verb::Halt(axes(set)),
        Action::QuickStop(set) => Verb::QuickStop(axes(set)),
        Action::ResetErrors(set) => Verb::ResetErrors(axes(set)),
        Action::Activate => Verb::Activate(Nothing {}),
        Action::Deactivate => Verb::Deactivate(Nothing {}),
        Action::Abort => Verb::Abort(Nothing {}),
        Action::Move(request) => Verb::MoveAxis(move_axis(id, request, config)),
        Action::Probe(request) => Verb::ProbeAxis(probe_axis(id, request, config)),
        Action::TouchProbe(request) => touch_probe(request, config),
        Action::AbortTrigger(request) => Verb::AbortTrigger {
            axis: axis(request.axis, config),
            event: request.source.map(|source| latching(source, config)),
        },
        Action::QueryTrajectory(request) => {
            Verb::QueryTrajectory { axis: axis(request.axis, config), time: format!("{} ns", request.at_ns) }
        }
        Action::HomeAxis(request) => Verb::HomeAxis(home_axis(id, request, config)),
        Action::SetPosition(request) => set_position(axis(request.axis, config).into(), request.position),
        Action::ShiftPosition(request) => Verb::SetPosition {
            axis: axis(request.axis, config).into(),
            relative: Some(true),
            units: None,
            position: Scalar::Text(length(request.distance)),
        },
        Action::SetEncoderPosition(request) => {
            let encoder = config.encoders.get(usize::from(request.encoder));
            set_position(encoder.map_or(NAMELESS, |encoder| &encoder.name).into(), request.position)
        }
        Action::SetMasterPosition(request) => {
            let name = format!("{}.master", axis(request.axis, config)).into();
            match request.position {
                MasterPosition::Increments(position) => set_position(name, position),
                MasterPosition::Shown(value) => {
                    let position = Scalar::Real(value);
                    Verb::SetPosition { axis: name, relative: None, units: Some("axis_unit"), position }
                }
            }
        }
        Action::Synchronize(request) => Verb::Synchronize(synchronize(id, request, config)),
        Action::Phase(request) => phase(id, request, config),
        Action::GearOut(request) => gear_out(*request, config),
        Action::OutAn(OutAn { axis: of, value, level }) => Verb::OutAn {
            axis: axis(*of, config),
            value: Scalar::Real(*value),
            level: (*level == Level::Effort).then_some("effort"),
        },
        Action::Vocabulary(Request::Saia(request)) => Verb::Saia(saia::saia(request, axis(request.axis, config))),
        Action::Vocabulary(Request::Wf(request)) => Verb::Wf(wf::wf(request, axis(request.axis, config))),
        Action::Cancel { goal } => Verb::Cancel { id: goal.to_string() },
        Action::SetParameters(changes) => {
            Verb::SetParameters(Entries(changes.iter().map(|change| parameter(change, config)).collect()))
        }
        Action::SaveParameters(set) => Verb::SaveParameters(axes(set)),
        Action::ResetParameters { axes: set, layer } => {
            let name = Layer::NAMES.iter().find(|(_, known)| known == layer).map(|(name, _)| *name);
            Verb::ResetParameters { axes: axes(set).axes, layer: name.filter(|_| *layer != Layer::User) }
        }
        Action::DeleteParameters(set) => Verb::DeleteParameters(axes(set)),
        Action::PowerCycle => Verb::Inject { power_cycle: Nothing {} },
        Action::SetMemory(values) => {
            Verb::SetMemory(Entries(values.iter().map(|value| cell(value.index, value.value, config)).collect()))
        }
        Action::SetOutputs(values) => {
            Verb::SetOutput(Entries(values.iter().map(|value| output(value.index, value.value, config)).collect()))
        }
        Action::CommandFunction(request) => command_function(request, config),
        Action::RunFunction(request) => Verb::RunFunction {
            id,
            function: config.name(Object::Function(request.slot)),
            parameters: set_values(request.slot, &request.values, config),
        },
        Action::LoadTable { index, table } => {
            Verb::LoadTable { table: config.name(Object::Table(*index)), points: Numbers(table) }
        }
        Action::LoadProgram { index, module, keeps } => Verb::LoadProgram {
            program: config.name(Object::Program(*index)),
            module: program::encode(module.bytes()),
            state: if *keeps { "keep" } else { "reset" },
        },
        Action::Refuse(text) => Verb::Refuse { text },
        Action::Note { code, number } => Verb::Note { code: code.0, number: *number },
    }
}

/// Numbers of a table as in its cell.
struct Numbers<'a>(&'a Table);

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.form() {
            Form::Xy => serializer.collect_seq(self.0.x().iter().zip(self.0.y()).map(|(x, y)| [x, y])),
            Form::Y | Form::Words => serializer.collect_seq(self.0.y()),
        }
    }
}

fn command_function<'a>(request: &CommandFunction, config: &'a MachineConfig) -> Verb<'a> {
    let order = Order::ALL.iter().find(|(order, ..)| *order == request.order);
    Verb::CommandFunction {
        function: config.name(Object::Function(request.slot)),
        command: order.map_or(NAMELESS, |(_, name, _)| name),
        parameters: set_values(request.slot, &request.values, config),
    }
}

/// Returns the values of a set, with the names of their fields.
fn set_values(slot: u16, values: &[(u16, i64)], config: &MachineConfig) -> Entries {
    let kind = config.slots.get(usize::from(slot)).map(|slot| slot.kind);
    let name = |place: u16| match kind.and_then(|kind| kind.description().field_of(place.into())) {
        Some((_, field, _)) if field.count == 1 => field.name.to_owned(),
        Some((_, field, nth)) => format!("{}[{nth}]", field.name),
        None => NAMELESS.to_owned(),
    };
    Entries(values.iter().map(|&(place, value)| (name(place), Scalar::Whole(value.into()))).collect())
}

fn set_position(axis: Cow<'_, str>, position: Length) -> Verb<'_> {
    Verb::SetPosition { axis, relative: None, units: None, position: Scalar::Text(length(position)) }
}

pub(super) fn axis(index: u16, config: &MachineConfig) -> &str {
    config.axes.get(usize::from(index)).map_or(NAMELESS, |axis| &axis.name)
}

fn axes(set: AxisSet, config: &MachineConfig) -> Vec<&str> {
    // An empty list would be read as all axes.
    let nothing = if config.axes.is_empty() { vec![] } else { vec![NAMELESS] };
    if set.is_empty() { nothing } else { set.iter().map(|index| axis(index, config)).collect() }
}

fn move_axis<'a>(id: String, request: &Move, config: &'a MachineConfig) -> MoveAxis<'a> {
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
fn latching(source: Object, config: &MachineConfig) -> &str {
    let io = |index: u16| config.io.get(usize::from(index)).map(|io| &io.name);
    let encoder = |index: u16| config.encoders.get(usize::from(index)).map(|encoder| &encoder.name);
    match source {
        Object::Io(index) => io(index).map_or(NAMELESS, String::as_str),
        Object::Encoder(index) => encoder(index).map_or(NAMELESS, String::as_str),
        Object::Axis(index) => axis(index, config),
        Object::Machine | Object::Memory(_) | Object::Function(_) | Object::Table(_) | Object::Program(_) => NAMELESS,
    }
}

fn probe_axis<'a>(id: String, request: &Probe, config: &'a MachineConfig) -> ProbeAxis<'a> {
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

fn touch_probe<'a>(request: &TouchProbe, config: &'a MachineConfig) -> Verb<'a> {
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

fn home_axis<'a>(id: String, request: &Homing, config: &'a MachineConfig) -> HomeAxis<'a> {
    let (scheme, method) = match request.method {
        HomingMethod::Configured => (None, None),
        HomingMethod::Cia402(method) => (Some("cia402"), Some(method)),
        HomingMethod::Macs(method) => (Some("macs"), Some(method)),
    };
    HomeAxis { id, axis: axis(request.axis, config), scheme, method }
}

fn synchronize<'a>(id: String, request: &Coupling, config: &'a MachineConfig) -> Synchronize<'a> {
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

fn phase<'a>(id: String, request: &Phase, config: &'a MachineConfig) -> Verb<'a> {
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

fn gear_out(request: GearOut, config: &MachineConfig) -> Verb<'_> {
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

/// Returns the amount as given; `None` for the number 0 without unit.
fn amount(amount: Amount) -> Option<Scalar> {
    match amount {
        Amount::Number(number) => (number != 0.0).then_some(Scalar::Real(number)),
        Amount::Quantity(quantity) => {
            Some(Scalar::Text(format!("{} {}", fraction_to_digits(&quantity.value()), quantity.unit())))
        }
    }
}

fn shift(value: Length) -> Option<String> {
    Some(value).filter(|value| *value != Length::default()).map(length)
}

fn factor(ratio: Ratio) -> Option<String> {
    (ratio != Ratio::ONE).then(|| format!("{}/{}", ratio.numerator(), ratio.denominator()))
}

fn parameter(change: &Change, config: &MachineConfig) -> (String, Scalar) {
    let row = change.row();
    let object = if change.axis == MACHINE { "machine" } else { axis(change.axis, config) };
    let name = format!("{object}.{}", row.map_or(NAMELESS, |row| row.key));
    let order = match row.map(|row| row.measure) {
        Some(Measure::Acceleration) => 2,
        Some(Measure::Jerk) => 3,
        _ => 1,
    };
    let value = match (change.value, row.map(|row| row.measure)) {
        (Value::Unset, _) => Scalar::Nothing,
        (Value::Real(value), Some(Measure::Number)) => Scalar::Real(value),
        (Value::Real(value), _) => Scalar::Text(rate(value, order)),
        (Value::Int(value), Some(Measure::Position | Measure::Distance)) => Scalar::Text(format!("{value} inc")),
        (Value::Int(value), Some(Measure::Time)) => Scalar::Text(format!("{value} ns")),
        (Value::Int(value), Some(Measure::Choice(names))) => {
            let name = usize::try_from(value).ok().and_then(|place| names.get(place));
            name.map_or(Scalar::Whole(value.into()), |name| Scalar::Text((*name).to_owned()))
        }
        (Value::Int(value), _) => Scalar::Whole(value.into()),
    };
    (name, value)
}

fn cell(index: u16, value: f64, config: &MachineConfig) -> (String, Scalar) {
    let Some(memory) = config.memory.get(usize::from(index)) else { return (NAMELESS.to_owned(), Scalar::Real(value)) };
    // The cast saturates; values that it changes are outside of the range of an integer memory cell.
    let whole = value as i128;
    let is_whole = memory.kind != MemoryKind::F64 && (whole as f64).to_bits() == value.to_bits();
    (memory.name.clone(), if is_whole { Scalar::Whole(whole) } else { Scalar::Real(value) })
}

fn output(index: u16, value: f64, config: &MachineConfig) -> (String, Scalar) {
    let Some(io) = config.io.get(usize::from(index)) else { return (NAMELESS.to_owned(), Scalar::Real(value)) };
    let is_bit = io.kind != IoKind::AnalogOutput && (value.to_bits() == 0 || value == 1.0);
    (io.name.clone(), if is_bit { Scalar::Whole(value as i128) } else { Scalar::Real(value) })
}

/// Returns a rate; `None` if it is the default.
fn given(value: f64, order: u8) -> Option<String> {
    (value.to_bits() != 0).then(|| rate(value, order))
}

/// Formats a rate, in inc/s^order, as the shortest decimal that is read back as the same f64.
pub(super) fn rate(value: f64, order: u8) -> String {
    let unit = Unit::INCREMENT.with_order(order);
    let is_handy = value == 0.0 || (1e-5..1e16).contains(&value.abs());
    if is_handy { format!("{value} {unit}") } else { format!("{value:e} {unit}") }
}

/// Formats a position, in inc, rounded to the tenth decimal.
pub(super) fn length(value: Length) -> String {
    const FRACTION_BITS: u32 = 32;
    const DECIMALS: u128 = 10_u128.pow(10);
    let raw = value.exact().raw();
    let magnitude = raw.unsigned_abs();
    let (whole, fraction) = (magnitude >> FRACTION_BITS, magnitude & ((1 << FRACTION_BITS) - 1));
    // The largest fraction, 1 - 2^-32, gives 9999999998 after the point: no carry.
    let decimals = (fraction * DECIMALS + (1 << (FRACTION_BITS - 1))) >> FRACTION_BITS;
    let sign = if raw < 0 { "-" } else { "" };
    let text = format!("{sign}{whole}.{decimals:010}");
    format!("{} inc", text.trim_end_matches('0').trim_end_matches('.'))
}

/// Compact JSON with all characters escaped that YAML does not allow in plain form.
struct Printable;

impl Formatter for Printable {
    fn write_string_fragment<W: ?Sized + io::Write>(&mut self, writer: &mut W, fragment: &str) -> io::Result<()> {
        let mut rest = fragment;
        while let Some((place, c)) = rest.char_indices().find(|(_, c)| is_special(*c)) {
            writer.write_all(&rest.as_bytes()[..place])?;
            write!(writer, "\\u{:04x}", u32::from(c))?;
            rest = &rest[place + c.len_utf8()..];
        }
        writer.write_all(rest.as_bytes())
    }
}

/// Whether it is a control character, a YAML line break, the byte order mark or a noncharacter; all of them are below
/// 2^16.
fn is_special(c: char) -> bool {
    matches!(c, '\u{7f}'..='\u{9f}' | '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}')
}

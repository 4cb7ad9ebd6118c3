//! Writes a command as text.

mod coupling;
mod motion;
mod numbers;
mod values;

pub(super) use self::numbers::{length, rate};
pub(super) use self::values::{Entries, Scalar};

use self::coupling::{Synchronize, gear_out, phase, synchronize};
use self::motion::{HomeAxis, MoveAxis, ProbeAxis, home_axis, latching, move_axis, probe_axis, touch_probe};
use self::values::{Numbers, cell, output, parameter, set_values};
use super::{saia, trajectory, wf};
use crate::program;
use lineshaft_core::command::{Action, Command, CommandFunction, Level, MasterPosition, OutAn, Setpoint, Setpoints};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::function::Order;
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::parameter::Layer;
use lineshaft_core::position::Length;
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

fn command_function<'a>(request: &CommandFunction, config: &'a MachineConfig) -> Verb<'a> {
    let order = Order::ALL.iter().find(|(order, ..)| *order == request.order);
    Verb::CommandFunction {
        function: config.name(Object::Function(request.slot)),
        command: order.map_or(NAMELESS, |(_, name, _)| name),
        parameters: set_values(request.slot, &request.values, config),
    }
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

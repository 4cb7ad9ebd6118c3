//! Writes a command as text.

mod fields;
mod numbers;
mod values;

pub(super) use self::numbers::{length, rate};
pub(super) use self::values::{Entries, Scalar};

use self::fields::FieldWriter;
use self::values::{Numbers, cell, output, parameter, set_values};
use super::{saia, trajectory, wf};
use crate::program;
use lineshaft_core::command::{Action, Command, Setpoint, Setpoints};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::function::Order;
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::parameter::Layer;
use lineshaft_core::request::NAMELESS;
use lineshaft_core::vocabulary::Request;
use serde::{Serialize, Serializer};
use serde_json::ser::Formatter;
use std::io;

/// Returns setpoints, as JSON.
pub(super) fn setpoints(set: &Setpoints, config: &MachineConfig) -> String {
    let axes = (0..).zip(&set.axes).filter_map(|(index, setpoint)| {
        let Setpoint { velocity, duration } = (*setpoint)?;
        let velocity = Scalar::Text(rate(velocity, 1));
        let value = match duration {
            None => velocity,
            Some(ns) => Scalar::Entries(Entries::of([("velocity", velocity), ("duration", time(ns))])),
        };
        Some((axis(index, config).to_owned(), value))
    });
    text("setpoints", &Entries::of([("axes", Scalar::Entries(Entries(axes.collect())))]))
}

/// Returns a verb with its arguments, as JSON.
fn text(verb: &str, arguments: &impl Serialize) -> String {
    let mut bytes = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, Printable);
    let written = serializer.collect_map([(verb, arguments)]);
    written.expect("names, texts and numbers have a JSON form, and a Vec takes all bytes");
    String::from_utf8(bytes).expect("the serializer writes UTF-8")
}

#[derive(Serialize)]
struct LoadTable<'a> {
    table: &'a str,
    points: Numbers<'a>,
}

/// Returns the verb of a command, as JSON.
pub(super) fn verb(command: &Command, config: &MachineConfig) -> String {
    let id = command.sequence.to_string();
    let of_axes = |set: &AxisSet| Entries::of([("axes", axes(*set, config))]);
    let nothing = Entries::default();
    match &command.action {
        Action::Trajectory(run) => text("follow_joint_trajectory", &trajectory::follow(id, run, config)),
        Action::Enable(set) => text("enable", &of_axes(set)),
        Action::Disable(set) => text("disable", &of_axes(set)),
        Action::Halt(set) => text("halt", &of_axes(set)),
        Action::QuickStop(set) => text("quick_stop", &of_axes(set)),
        Action::ResetErrors(set) => text("reset_errors", &of_axes(set)),
        Action::Activate => text("activate", &nothing),
        Action::Deactivate => text("deactivate", &nothing),
        Action::Abort => text("abort", &nothing),
        Action::QueryTrajectory(request) => {
            let axis = axis(request.axis, config).into();
            text("query_trajectory", &Entries::of([("axis", axis), ("time", time(request.at_ns))]))
        }
        Action::Vocabulary(Request::Saia(request)) => text("saia", &saia::saia(request, axis(request.axis, config))),
        Action::Vocabulary(Request::Wf(request)) => text("wf", &wf::wf(request, axis(request.axis, config))),
        Action::Cancel { goal } => text("cancel", &Entries::of([("id", Scalar::Text(goal.to_string()))])),
        Action::SetParameters(changes) => {
            text("set_parameters", &Entries(changes.iter().map(|change| parameter(change, config)).collect()))
        }
        Action::SaveParameters(set) => text("save_parameters", &of_axes(set)),
        Action::ResetParameters { axes: set, layer } => {
            let name = Layer::NAMES.iter().find(|(_, known)| known == layer).filter(|_| *layer != Layer::User);
            let name = name.map(|(name, _)| (*name).into());
            text("reset_parameters", &Entries::some([("axes", Some(axes(*set, config))), ("layer", name)]))
        }
        Action::DeleteParameters(set) => text("delete_parameters", &of_axes(set)),
        Action::PowerCycle => text("inject", &Entries::of([("power_cycle", Scalar::Entries(nothing))])),
        Action::SetMemory(values) => {
            let values = values.iter().map(|value| cell(value.index, value.value, config));
            text("set_memory", &Entries(values.collect()))
        }
        Action::SetOutputs(values) => {
            let values = values.iter().map(|value| output(value.index, value.value, config));
            text("set_output", &Entries(values.collect()))
        }
        Action::CommandFunction(request) => {
            let order = Order::ALL.iter().find(|(order, ..)| *order == request.order);
            let function = config.name(Object::Function(request.slot)).into();
            let order = order.map_or(NAMELESS, |(_, name, _)| name).into();
            let values = set_values(request.slot, &request.values, config).unless_empty();
            let arguments = [("function", Some(function)), ("command", Some(order)), ("parameters", values)];
            text("command_function", &Entries::some(arguments))
        }
        Action::RunFunction(request) => {
            let function = config.name(Object::Function(request.slot)).into();
            let values = set_values(request.slot, &request.values, config).unless_empty();
            let arguments = [("id", Some(Scalar::Text(id))), ("function", Some(function)), ("parameters", values)];
            text("run_function", &Entries::some(arguments))
        }
        Action::LoadTable { index, table } => {
            text("load_table", &LoadTable { table: config.name(Object::Table(*index)), points: Numbers(table) })
        }
        Action::LoadProgram { index, module, keeps } => {
            let arguments = [
                ("program", config.name(Object::Program(*index)).into()),
                ("module", Scalar::Text(program::encode(module.bytes()))),
                ("state", if *keeps { "keep" } else { "reset" }.into()),
            ];
            text("load_program", &Entries::of(arguments))
        }
        Action::Refuse(sentence) => text("refuse", &Entries::of([("text", (&**sentence).into())])),
        Action::Note { code, number } => {
            let [code, number] = [code.0.into(), (*number).into()].map(Scalar::Whole);
            text("note", &Entries::of([("code", code), ("number", number)]))
        }
        action @ (Action::Move(_)
        | Action::Probe(_)
        | Action::TouchProbe(_)
        | Action::AbortTrigger(_)
        | Action::HomeAxis(_)
        | Action::SetPosition(_)
        | Action::ShiftPosition(_)
        | Action::SetEncoderPosition(_)
        | Action::SetMasterPosition(_)
        | Action::Synchronize(_)
        | Action::Phase(_)
        | Action::GearOut(_)
        | Action::OutAn(_)) => match config.describe(action) {
            Some((verb, mut request)) => {
                let mut fields = FieldWriter { id: command.sequence, entries: Entries::default() };
                request.fields(&mut fields);
                text(verb, &fields.entries)
            }
            None => text(NAMELESS, &nothing),
        },
    }
}

pub(super) fn time(ns: u64) -> Scalar {
    Scalar::Text(format!("{ns} ns"))
}

pub(super) fn axis(index: u16, config: &MachineConfig) -> &str {
    config.axes.get(usize::from(index)).map_or(NAMELESS, |axis| &axis.name)
}

fn axes(set: AxisSet, config: &MachineConfig) -> Scalar {
    // An empty list would be read as all axes.
    let nothing = if config.axes.is_empty() { vec![] } else { vec![NAMELESS.into()] };
    let names = set.iter().map(|index| axis(index, config).into()).collect();
    Scalar::List(if set.is_empty() { nothing } else { names })
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

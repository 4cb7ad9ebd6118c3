//! Verbs: convert the actions of a step to commands, with the same requests as all other interfaces.

use super::inject::{self, Injection};
use super::names::{Names, did_you_mean, meant_parameter, nearest};
use super::refusal::Refusal;
use super::ruler::refuse_inexact;
use super::verb::amount::amount;
use crate::document::{Map, Place, Value};
use crate::explain::verbs_of;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, MemoryValue, Setpoints, Source};
use lineshaft_core::config::MemoryKind;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::{Change, Layer, Row};
use lineshaft_core::request::{Amount, MoveRequest, Rates, RequestError, Units};
use lineshaft_core::unit::{Scale, excerpt};

mod amount;
mod function;
mod gear_out;
mod homing;
mod out_an;
mod output;
mod phase;
mod plan;
mod probe;
mod recorded;
mod saia;
mod setpoints;
mod synchronize;
mod touch_probe;
mod trajectory;
mod vocabulary;
mod wf;

pub(super) use amount::parameter_input;
pub(crate) use recorded::{parameter_change, recorded_command};
pub(crate) use setpoints::recorded_setpoints;
pub(crate) use vocabulary::vocabulary_command;

/// Names of all verbs.
pub(crate) const VERBS: [&str; 35] = [
    "enable",
    "disable",
    "halt",
    "quick_stop",
    "reset_errors",
    "activate",
    "deactivate",
    "abort",
    "move_axis",
    "probe_axis",
    "touch_probe",
    "abort_trigger",
    "home_axis",
    "set_position",
    "synchronize",
    "phase",
    "gear_out",
    "out_an",
    "follow_joint_trajectory",
    "query_trajectory",
    "cancel",
    "set_parameters",
    "save_parameters",
    "reset_parameters",
    "delete_parameters",
    "command_function",
    "run_function",
    "load_table",
    "load_program",
    "set_memory",
    "set_output",
    "setpoints",
    "saia",
    "wf",
    "inject",
];

const VELOCITY: u8 = 3;
const MODES: [(&str, u8); 5] =
    [("absolute", 0), ("relative", 1), ("additive", 2), ("velocity", VELOCITY), ("superimposed", 4)];
const UNITS: [(&str, u8); 3] = [("si", 0), ("axis_unit", 1), ("increments", 2)];
const BUFFER_MODES: [(&str, u8); 6] = [
    ("aborting", 0),
    ("buffered", 1),
    ("blending_low", 2),
    ("blending_previous", 3),
    ("blending_next", 4),
    ("blending_high", 5),
];
const DIRECTIONS: [(&str, u8); 4] = [("shortest", 0), ("positive", 1), ("negative", 2), ("current", 3)];

/// One action of a step.
#[derive(Clone, Debug)]
pub(super) struct Act {
    pub place: Place,
    pub verb: String,
    pub deed: Effect,
    /// Index of its ID among the IDs of the scenario.
    pub id: Option<usize>,
}

/// Effect of an act.
#[derive(Clone, Debug)]
pub(super) enum Effect {
    Command(Action),
    /// A request that is invalid in itself, with the error message, as the step expects.
    Refused(String),
    /// Cancels the goal of the last command with that ID.
    Cancel(usize),
    Inject(Injection),
    /// Streamed setpoints: they are sent in addition to commands and get no answer.
    Stream(Setpoints),
}

/// IDs of commands, with their definitions and references.
#[derive(Default)]
pub(super) struct Ids {
    names: Vec<String>,
    carried: Vec<bool>,
    /// References to IDs that no command had before: ID and location.
    open: Vec<(usize, Place)>,
}

impl Ids {
    fn place(&mut self, name: &str) -> usize {
        self.names.iter().position(|known| known == name).unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.carried.push(false);
            self.names.len() - 1
        })
    }

    fn carry(&mut self, value: &Value<'_>) -> Option<usize> {
        let name = value.text()?;
        let place = self.place(name);
        if std::mem::replace(&mut self.carried[place], true) {
            value.refuse(format!("id `{}` stands twice", excerpt(name)), None);
            return None;
        }
        Some(place)
    }

    /// Returns the IDs that a cancel refers to and no command has.
    pub(super) fn missing(&self) -> impl Iterator<Item = (Place, String)> {
        let open = self.open.iter().filter(|(id, _)| !self.carried[*id]);
        open.map(|&(id, place)| (place, format!("no command has the id `{}`", excerpt(&self.names[id]))))
    }

    /// Returns all IDs by index.
    pub(super) fn into_names(self) -> Vec<String> {
        self.names
    }
}

/// Data for reading the verbs of one step.
pub(super) struct Reader<'a> {
    pub names: &'a Names<'a>,
    pub ids: &'a mut Ids,
    /// Refusal that the step expects for its commands.
    pub refused: Option<&'a Refusal>,
    /// Whether the verb was recorded: it was a command then, and is read even if it has no effect.
    pub recorded: bool,
}

impl Reader<'_> {
    /// Reads one verb or a list of them.
    pub(super) fn read(&mut self, value: &Value<'_>) -> Vec<Act> {
        let mut acts = Vec::new();
        if value.is_list() {
            let items = value.list().unwrap_or_default();
            if items.is_empty() {
                value.refuse("do is empty; one verb or more is expected", None);
            }
            items.iter().for_each(|item| self.read_one(item, &mut acts));
        } else {
            self.read_one(value, &mut acts);
        }
        acts
    }

    fn read_one(&mut self, value: &Value<'_>, acts: &mut Vec<Act>) {
        if let Some(text) = value.peek().filter(|text| VERBS.contains(text)) {
            value.refuse(format!("{} has no arguments", excerpt(text)), Some(format!("write `{text}: {{}}`")));
            return;
        }
        let Some(entries) = value.entries() else { return };
        let [(verb, arguments)] = entries.as_slice() else {
            value.refuse(
                format!("{} verbs stand together; one is expected", entries.len()),
                Some("write a list".to_owned()),
            );
            return;
        };
        let Some(name) = verb.text() else { return };
        let place = verb.place();
        let mut add = |deed: Option<Effect>, id: Option<usize>| {
            acts.extend(deed.map(|deed| Act { place, verb: name.to_owned(), deed, id }));
        };
        match name {
            "enable" => add(self.axes(arguments, Action::Enable), None),
            "disable" => add(self.axes(arguments, Action::Disable), None),
            "halt" => add(self.axes(arguments, Action::Halt), None),
            "quick_stop" => add(self.axes(arguments, Action::QuickStop), None),
            "reset_errors" => add(self.axes(arguments, Action::ResetErrors), None),
            "activate" => add(nothing(arguments, Action::Activate), None),
            "deactivate" => add(nothing(arguments, Action::Deactivate), None),
            "abort" => add(nothing(arguments, Action::Abort), None),
            "move_axis" => {
                let (deed, id) = self.move_axis(arguments);
                add(deed, id);
            }
            "probe_axis" => {
                let (deed, id) = self.probe_axis(arguments);
                add(deed, id);
            }
            "touch_probe" => add(self.touch_probe(arguments), None),
            "abort_trigger" => add(self.abort_trigger(arguments), None),
            "home_axis" => {
                let (deed, id) = self.home_axis(arguments);
                add(deed, id);
            }
            "set_position" => add(self.set_position(arguments), None),
            "synchronize" => {
                let (deed, id) = self.synchronize(arguments);
                add(deed, id);
            }
            "phase" => {
                let (deed, id) = self.phase(arguments);
                add(deed, id);
            }
            "gear_out" => add(self.gear_out(arguments), None),
            "out_an" => add(self.out_an(arguments), None),
            "follow_joint_trajectory" => {
                let (deed, id) = self.follow_joint_trajectory(arguments);
                add(deed, id);
            }
            "query_trajectory" => add(self.query_trajectory(arguments), None),
            "cancel" => add(self.cancel(arguments), None),
            "set_parameters" => add(self.set_parameters(arguments), None),
            "save_parameters" => add(self.axes(arguments, Action::SaveParameters), None),
            "reset_parameters" => add(self.reset_parameters(arguments), None),
            "delete_parameters" => add(self.axes(arguments, Action::DeleteParameters), None),
            "command_function" => add(self.command_function(arguments), None),
            "run_function" => {
                let (deed, id) = self.run_function(arguments);
                add(deed, id);
            }
            "load_table" => add(self.load_table(arguments), None),
            "load_program" => add(self.load_program(arguments), None),
            "set_memory" => add(self.set_memory(arguments), None),
            "set_output" => add(self.set_output(arguments), None),
            "setpoints" => add(self.setpoints(arguments, Source::Scenario), None),
            "saia" => add(self.saia(arguments), None),
            "wf" => add(self.wf(arguments), None),
            "inject" => add(self.inject(arguments), None),
            other => {
                let known = || format!("known are {}", VERBS.join(", "));
                let hint = meant_verb(other).unwrap_or_else(known);
                verb.refuse(format!("there is no verb `{}`", excerpt(other)), Some(hint));
            }
        }
    }

    /// Converts the result of a request: to a command, or to a refusal that the step expects.
    fn to_command(&self, value: &Value<'_>, result: Result<Action, RequestError>) -> Option<Effect> {
        self.settle_as(value, result.map(Effect::Command))
    }

    fn settle_as(&self, value: &Value<'_>, result: Result<Effect, RequestError>) -> Option<Effect> {
        let sentence = match result {
            Ok(deed) => return Some(deed),
            Err(error) => error.to_string(),
        };
        match self.refused {
            Some(wanted) if wanted.fits(Code::BAD_REQUEST, &[&sentence], &[]) => {
                return Some(Effect::Refused(sentence));
            }
            Some(wanted) => {
                let code = Code::BAD_REQUEST.0;
                value.refuse(sentence, Some(format!("`refused` asks for {wanted}; this has code {code}")));
            }
            None => value.refuse(sentence, None),
        }
        None
    }

    fn axes(&self, value: &Value<'_>, action: fn(AxisSet) -> Action) -> Option<Effect> {
        let mut map = value.map(value.label())?;
        let axes = map.optional("axes");
        map.finish();
        self.axis_set(value, axes, action)
    }

    fn reset_parameters(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("reset_parameters")?;
        let axes = map.optional("axes");
        let layer = map.optional("layer").map_or(Some(Layer::User), |layer| layer.choice(Layer::NAMES));
        map.finish();
        let layer = layer?;
        self.axis_set(value, axes, |axes| Action::ResetParameters { axes, layer })
    }

    /// Reads a command for the axes of a list; without a list, for all axes.
    fn axis_set(
        &self,
        value: &Value<'_>,
        axes: Option<Value<'_>>,
        action: impl FnOnce(AxisSet) -> Action,
    ) -> Option<Effect> {
        let items = axes.as_ref().map_or(Some(Vec::new()), |axes| axes.list())?;
        let names: Vec<_> = items.iter().map(|item| item.text()).collect();
        let names: Vec<&str> = names.into_iter().collect::<Option<_>>()?;
        self.to_command(axes.as_ref().unwrap_or(value), self.names.config.find_axes(&names).map(action))
    }

    fn scale(&self, axis: Option<&Value<'_>>) -> Option<Scale> {
        self.names.config.find_axis(axis?.peek()?).ok().map(|(_, axis)| axis.scale)
    }

    fn move_axis(&mut self, value: &Value<'_>) -> (Option<Effect>, Option<usize>) {
        let Some(mut map) = value.map("move_axis") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let axis = map.required("axis");
        let scale = self.scale(axis.as_ref());
        let numbers =
            [("mode", &MODES[..]), ("units", &UNITS), ("buffer_mode", &BUFFER_MODES), ("direction", &DIRECTIONS)]
                .map(|(key, names)| number(&mut map, key, names));
        let [mode, units, buffer_mode, direction] = numbers;
        let in_increments = units == Some(2);
        let position = self.position(&mut map, mode, scale.as_ref(), in_increments);
        let rates = optional_rates(&mut map, scale.as_ref(), in_increments);
        map.finish();
        let deed = (|| {
            let units = match Units::from_number(units?) {
                Ok(units) => units,
                Err(error) => return self.to_command(value, Err(error)),
            };
            let request = MoveRequest {
                axis: axis?.text()?.to_owned(),
                mode: mode?,
                units,
                position: position?,
                rates: rates?,
                buffer_mode: buffer_mode?,
                direction: direction?,
            };
            let config = self.names.config;
            let resolved =
                if self.recorded { config.resolve_recorded_move(&request) } else { config.resolve_move(&request) };
            self.to_command(value, resolved.map(Action::Move))
        })();
        (deed, id.flatten())
    }

    /// Reads the position of a motion. Only mode velocity has none; otherwise a forgotten position would be 0. A
    /// recorded command is read as it was.
    fn position(&self, map: &mut Map<'_>, mode: Option<u8>, scale: Option<&Scale>, inc: bool) -> Option<Amount> {
        let has_target = mode.is_some_and(|mode| mode != VELOCITY && usize::from(mode) < MODES.len());
        if has_target && !self.recorded {
            return amount(&map.required("position")?, 0, scale, inc);
        }
        optional_amount(map, "position", 0, scale, inc)
    }

    fn cancel(&mut self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("cancel")?;
        let id = map.required("id");
        map.finish();
        let id = id?;
        let place = self.ids.place(id.text()?);
        self.ids.open.push((place, id.place()));
        Some(Effect::Cancel(place))
    }

    /// Refuses a verb without effect, because success would mean that something was executed. Returns false for a
    /// recorded verb, and if a key that is not one of `known` shows what was meant.
    fn refuse_nothing(&self, value: &Value<'_>, verb: &str, known: &[&str]) -> bool {
        let is_meant = |key: &Value<'_>| key.peek().is_none_or(|key| !known.contains(&key));
        if self.recorded || value.entries().is_none_or(|entries| entries.iter().any(|(key, _)| is_meant(key))) {
            return false;
        }
        value.refuse(format!("{verb} asks for nothing; keys beside `axis` are expected"), None);
        true
    }

    fn set_parameters(&self, value: &Value<'_>) -> Option<Effect> {
        let entries = value.entries()?;
        if entries.is_empty() {
            value.refuse("set_parameters is empty; `axis.key: value` is expected", None);
            return None;
        }
        let mut changes = Vec::new();
        let mut refused = None;
        let mut is_good = true;
        for (key, input) in &entries {
            match self.change(key.text(), input) {
                None => is_good = false,
                Some(Ok(change)) => changes.push(change),
                Some(Err(error @ RequestError::UnknownParameter { .. })) if self.refused.is_none() => {
                    input.refuse(
                        error.to_string(),
                        key.peek().and_then(|name| meant_parameter(name, self.names.config)),
                    );
                    is_good = false;
                }
                Some(Err(error)) => {
                    let deed = self.to_command(input, Err(error));
                    is_good &= deed.is_some();
                    refused = refused.or(deed);
                }
            }
        }
        if !is_good {
            return None;
        }
        refused.or_else(|| Some(Effect::Command(Action::SetParameters(changes.into()))))
    }

    /// Reads a parameter change from a name and a value; returns `None` if the value is invalid, which is reported.
    fn change(&self, name: Option<&str>, input: &Value<'_>) -> Option<Result<Change, RequestError>> {
        let name = name?;
        let (object, row) = name.split_once('.').unwrap_or((name, ""));
        let scale = self.names.config.find_axis(object).ok().map(|(_, axis)| axis.scale);
        let dimensions = Row::find(row).zip(scale).and_then(|((_, row), scale)| row.measure.dimensions(&scale));
        let input = parameter_input(input, dimensions)?;
        Some(self.names.config.resolve_parameter(name, &input))
    }

    fn set_memory(&self, value: &Value<'_>) -> Option<Effect> {
        let entries = value.entries()?;
        if entries.is_empty() {
            // A value that is no mapping has been reported already.
            if value.is_map() {
                value.refuse("set_memory is empty; `cell: value` is expected", None);
            }
            return None;
        }
        // All entries are read, so that every problem is reported.
        let values: Vec<_> = entries.iter().map(|(key, value)| self.set_cell(key, value)).collect();
        let values: Vec<_> = values.into_iter().collect::<Option<_>>()?;
        Some(Effect::Command(Action::SetMemory(values.into())))
    }

    fn set_cell(&self, key: &Value<'_>, value: &Value<'_>) -> Option<MemoryValue> {
        let name = key.text()?;
        let memory = &self.names.config.memory;
        let Some(index) = memory.iter().position(|entry| entry.name == name) else {
            let hint = nearest(name, memory.iter().map(|entry| entry.name.as_str())).map(did_you_mean);
            key.refuse(format!("no memory cell is called `{}`", excerpt(name)), hint);
            return None;
        };
        memory_value(value, memory[index].kind).map(|value| MemoryValue { index: index as u16, value })
    }

    fn inject(&self, value: &Value<'_>) -> Option<Effect> {
        let entries = if value.is_map() { value.entries()? } else { Vec::new() };
        if let [(kind, arguments)] = entries.as_slice()
            && kind.peek() == Some("power_cycle")
        {
            arguments.map("power_cycle")?.finish();
            return Some(Effect::Command(Action::PowerCycle));
        }
        if self.refused.is_some() {
            value.refuse("inject is never refused; leave `refused` out of this step", None);
        }
        inject::read(value, self.names).map(Effect::Inject)
    }
}

/// Returns a hint with the most similar verb, or with those that do the same as a command or a function block of PLCopen
/// of that name.
fn meant_verb(name: &str) -> Option<String> {
    let same = verbs_of(name);
    match nearest(name, VERBS.into_iter()) {
        Some(near) if same.is_empty() || same.contains(&near) => Some(did_you_mean(near)),
        _ => (!same.is_empty()).then(|| did_you_mean(&same.join("` or `"))),
    }
}

/// Reads a verb without arguments.
fn nothing(value: &Value<'_>, action: Action) -> Option<Effect> {
    value.map(value.label())?.finish();
    Some(Effect::Command(action))
}

/// Reads a choice by name or number; 0 if it is absent.
fn number(map: &mut Map<'_>, key: &str, names: &[(&str, u8)]) -> Option<u8> {
    match map.optional(key) {
        None => Some(0),
        Some(value) if value.is_integer() => value.integer(0..=u8::MAX),
        Some(value) => value.choice(names),
    }
}

/// Reads a value that a memory cell can hold, like `~/set_memory`. A command has it as an f64, which must be exact.
fn memory_value(value: &Value<'_>, kind: MemoryKind) -> Option<f64> {
    let Some((low, high)) = kind.whole_range() else { return value.number(f64::NEG_INFINITY..=f64::INFINITY) };
    let whole = value.integer(low..=high)?;
    refuse_inexact(value, whole, (low, high)).then_some(whole as f64)
}

fn whole(map: &mut Map<'_>, key: &str) -> Option<i64> {
    map.optional(key).map_or(Some(0), |value| value.integer(i64::MIN..=i64::MAX))
}

fn optional_amount(map: &mut Map<'_>, key: &str, order: u8, scale: Option<&Scale>, inc: bool) -> Option<Amount> {
    map.optional(key).map_or(Some(Amount::default()), |value| amount(&value, order, scale, inc))
}

/// Reads the rates of a goal; returns `None` if one of them is wrong, which is reported.
fn optional_rates(map: &mut Map<'_>, scale: Option<&Scale>, inc: bool) -> Option<Rates> {
    let amounts = Rates::FIELDS.map(|(key, order)| optional_amount(map, key, order, scale, inc));
    let [Some(velocity), Some(acceleration), Some(deceleration), Some(jerk)] = amounts else { return None };
    Some(Rates { velocity, acceleration, deceleration, jerk })
}

//! Verbs: convert the actions of a step to commands, with the same requests as all other interfaces.

use self::fields::choice_number;
use super::inject::{self, Injection};
use super::names::{Names, did_you_mean, meant_parameter, nearest};
use super::refusal::Refusal;
use super::ruler::refuse_inexact;
use crate::document::{Map, Place, Value};
use crate::explain::verbs_of;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, MemoryValue, Setpoints, Source};
use lineshaft_core::config::MemoryKind;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::{Change, Layer, Row};
use lineshaft_core::request::{NewVerb, REQUESTS, RequestError, Units};
use lineshaft_core::unit::{Scale, excerpt};
use std::sync::LazyLock;

mod amount;
mod fields;
mod function;
mod output;
mod plan;
mod recorded;
mod saia;
mod setpoints;
mod trajectory;
mod vocabulary;
mod wf;

pub(super) use amount::parameter_input;
pub(crate) use recorded::{parameter_change, recorded_command};
pub(crate) use setpoints::recorded_setpoints;
pub(crate) use vocabulary::vocabulary_command;
pub(crate) use wf::{JOGS as WF_JOGS, MODES as WF_MODES};

/// Effect of a verb, and the index of its ID.
type EffectOfGoal = (Option<Effect>, Option<usize>);

/// Reader of the arguments of a verb.
#[derive(Clone, Copy)]
enum Arguments {
    /// Axes; without them, all axes.
    Axes(fn(AxisSet) -> Action),
    /// No arguments.
    Nothing(fn() -> Action),
    /// The fields of a request of the core.
    Request(NewVerb),
    /// Others.
    Own(fn(&mut Reader<'_>, &Value<'_>) -> Option<Effect>),
    /// Others, with an ID.
    Goal(fn(&mut Reader<'_>, &Value<'_>) -> EffectOfGoal),
}

/// Verbs before those of the core.
const FIRST: [(&str, Arguments); 8] = [
    ("enable", Arguments::Axes(Action::Enable)),
    ("disable", Arguments::Axes(Action::Disable)),
    ("halt", Arguments::Axes(Action::Halt)),
    ("quick_stop", Arguments::Axes(Action::QuickStop)),
    ("reset_errors", Arguments::Axes(Action::ResetErrors)),
    ("activate", Arguments::Nothing(|| Action::Activate)),
    ("deactivate", Arguments::Nothing(|| Action::Deactivate)),
    ("abort", Arguments::Nothing(|| Action::Abort)),
];

/// Verbs after those of the core.
const LAST: [(&str, Arguments); 17] = [
    ("follow_joint_trajectory", Arguments::Goal(|reader, value| reader.follow_joint_trajectory(value))),
    ("query_trajectory", Arguments::Own(|reader, value| reader.query_trajectory(value))),
    ("cancel", Arguments::Own(|reader, value| reader.cancel(value))),
    ("set_parameters", Arguments::Own(|reader, value| reader.set_parameters(value))),
    ("save_parameters", Arguments::Axes(Action::SaveParameters)),
    ("reset_parameters", Arguments::Own(|reader, value| reader.reset_parameters(value))),
    ("delete_parameters", Arguments::Axes(Action::DeleteParameters)),
    ("command_function", Arguments::Own(|reader, value| reader.command_function(value))),
    ("run_function", Arguments::Goal(|reader, value| reader.run_function(value))),
    ("load_table", Arguments::Own(|reader, value| reader.load_table(value))),
    ("load_program", Arguments::Own(|reader, value| reader.load_program(value))),
    ("set_memory", Arguments::Own(|reader, value| reader.set_memory(value))),
    ("set_output", Arguments::Own(|reader, value| reader.set_output(value))),
    ("setpoints", Arguments::Own(|reader, value| reader.setpoints(value, Source::Scenario))),
    ("saia", Arguments::Own(|reader, value| reader.saia(value))),
    ("wf", Arguments::Own(|reader, value| reader.wf(value))),
    ("inject", Arguments::Own(|reader, value| reader.inject(value))),
];

/// Returns all verbs, with the readers of their arguments.
fn all_verbs() -> impl Iterator<Item = (&'static str, Arguments)> {
    let requests = REQUESTS.map(|(name, request)| (name, Arguments::Request(request)));
    FIRST.into_iter().chain(requests).chain(LAST)
}

/// Names of all verbs.
pub(crate) static VERBS: LazyLock<Vec<&str>> = LazyLock::new(|| all_verbs().map(|(name, _)| name).collect());

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
        let Some((_, reader)) = all_verbs().find(|(known, _)| *known == name) else {
            let known = || format!("known are {}", VERBS.join(", "));
            let hint = meant_verb(name).unwrap_or_else(known);
            verb.refuse(format!("there is no verb `{}`", excerpt(name)), Some(hint));
            return;
        };
        let (deed, id) = match reader {
            Arguments::Axes(action) => (self.axes(arguments, action), None),
            Arguments::Nothing(action) => (nothing(arguments, action()), None),
            Arguments::Request(request) => self.request(name, request(), arguments),
            Arguments::Own(read) => (read(self, arguments), None),
            Arguments::Goal(read) => read(self, arguments),
        };
        acts.extend(deed.map(|deed| Act { place, verb: name.to_owned(), deed, id }));
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
    match nearest(name, VERBS.iter().copied()) {
        Some(near) if same.is_empty() || same.contains(&near) => Some(did_you_mean(near)),
        _ => (!same.is_empty()).then(|| did_you_mean(&same.join("` or `"))),
    }
}

/// Reads a verb without arguments.
fn nothing(value: &Value<'_>, action: Action) -> Option<Effect> {
    value.map(value.label())?.finish();
    Some(Effect::Command(action))
}

/// Reads the number of the units of numbers without a unit.
fn units(map: &mut Map<'_>) -> Option<u8> {
    map.optional("units").map_or(Some(0), |value| choice_number(&value, &Units::ALL.map(|(name, _)| name)))
}

/// Reads a value that a memory cell can hold, like `~/set_memory`. A command has it as an f64, which must be exact.
fn memory_value(value: &Value<'_>, kind: MemoryKind) -> Option<f64> {
    let Some((low, high)) = kind.whole_range() else { return value.number(f64::NEG_INFINITY..=f64::INFINITY) };
    let whole = value.integer(low..=high)?;
    refuse_inexact(value, whole, (low, high)).then_some(whole as f64)
}

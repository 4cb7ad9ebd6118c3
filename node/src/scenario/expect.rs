//! Section `expect`: expectations on signals, parameters and events.
//!
//! Law      values: row n is expected at from + n every, exactly or `within` a tolerance
//!          a condition is true in every cycle from..to (always), in one of them (eventually), in none (never); `at` is a
//!          window of one cycle; the default window is the whole scenario
//!          events of a kind or a source occur count times, or min to max times; by default at least once
//!          a mode of events: eventually means at least one, never means none
//!          `since: STEP` counts from the cycle in which that step fired first, also backwards; `end` is still the last
//!          cycle
//! Source   contract section 5

use super::drive::rows;
use super::moment::{Moment, positive_cycles, text};
use super::names::{Names, did_you_mean, nearest};
use super::predicate::{Predicate, Probe};
use super::refusal::contains;
use super::ruler::{self, ValueFormat};
use super::step::{Step, Trigger};
use crate::document::{Map, Place, Value};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Event, Kind, Severity};
use lineshaft_core::object::Object;
use lineshaft_core::signal::Value as Number;
use lineshaft_core::text::message;
use lineshaft_core::unit::excerpt;

/// One expectation.
#[derive(Clone, Debug)]
pub(super) struct Expectation {
    pub place: Place,
    /// Step from which its cycles are counted.
    pub since: Option<usize>,
    pub from: Moment,
    pub to: Moment,
    pub claim: Claim,
}

/// Expected signal values, condition or events.
#[derive(Clone, Debug)]
pub(super) enum Claim {
    Values { probe: Box<Probe>, values: Vec<Number>, within: Option<Number>, every: u64 },
    Condition { predicate: Predicate, mode: Mode },
    Events { filter: Filter, min: u64, max: Option<u64> },
}

/// Cycles of the window in which a condition must be true.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Always,
    Eventually,
    Never,
}

const MODES: [(&str, Mode); 3] = [("always", Mode::Always), ("eventually", Mode::Eventually), ("never", Mode::Never)];

/// Filter of the events that count.
#[derive(Clone, Debug, Default)]
pub(super) struct Filter {
    kind: Option<Kind>,
    source: Option<Object>,
    severity: Option<Severity>,
    code: Option<u32>,
    age_ns: Option<u32>,
    increments: Option<i64>,
    text: Option<String>,
    /// Text as written, for the report.
    pub name: String,
}

impl Mode {
    fn name(self) -> &'static str {
        MODES.iter().find(|(_, mode)| *mode == self).map_or("", |(name, _)| *name)
    }
}

impl Expectation {
    /// Returns the expectation and its cycles as text: `always x.state STANDSTILL, from cycle 5 (0.005 s) to the end`.
    pub(super) fn text(&self, steps: &[Step], cycle_ns: u64) -> String {
        let claim = match &self.claim {
            Claim::Values { probe, values, .. } => match values.len() {
                1 => format!("{} has 1 expected value", probe.name()),
                count => format!("{} has {count} expected values", probe.name()),
            },
            Claim::Condition { predicate, mode } => format!("{} {}", mode.name(), predicate.text()),
            Claim::Events { filter, min, max } => match max {
                Some(0) => format!("never {}", filter.name),
                Some(max) if max == min => format!("{} exactly {}", filter.name, times(*min)),
                Some(max) => format!("{} {min} to {}", filter.name, times(*max)),
                None => format!("{} at least {}", filter.name, times(*min)),
            },
        };
        let window = match (self.from, self.to) {
            (from, to) if from == to => format!(", at {}", self.moment(from, cycle_ns)),
            (Moment::Cycle(0), Moment::End) => String::new(),
            (from, to) => format!(", from {} to {}", self.moment(from, cycle_ns), self.moment(to, cycle_ns)),
        };
        let since = self.since.and_then(|step| steps.get(step)).and_then(|step| step.name.as_ref());
        let since = since.map_or_else(String::new, |name| format!(", counted from step `{}`", excerpt(name)));
        format!("{claim}{window}{since}")
    }

    fn moment(&self, moment: Moment, cycle_ns: u64) -> String {
        match (moment, self.since) {
            (Moment::End, _) => "the end".to_owned(),
            (Moment::Cycle(cycle), None) => text(cycle.unsigned_abs(), cycle_ns),
            (Moment::Cycle(cycle), Some(_)) => format!("{cycle} cycles"),
        }
    }
}

/// Returns `once`, `2 times` and so on.
pub(super) fn times(count: u64) -> String {
    if count == 1 { "once".to_owned() } else { format!("{count} times") }
}

impl Filter {
    /// Whether an event counts.
    pub(super) fn matches(&self, event: &Event, config: &MachineConfig) -> bool {
        self.kind.is_none_or(|kind| kind == event.kind)
            && self.source.is_none_or(|source| source == event.source)
            && self.severity.is_none_or(|severity| severity == event.severity)
            && self.code.is_none_or(|code| code == event.code.0)
            && self.age_ns.is_none_or(|age| age == event.age_ns)
            && self.increments.is_none_or(|increments| increments == event.position.floor())
            && self.text.as_ref().is_none_or(|text| contains(&message(event, config), text))
    }
}

/// Data for reading expectations.
pub(super) struct Reader<'a> {
    pub names: &'a Names<'a>,
    pub steps: &'a [Step],
    pub cycle_ns: u64,
    /// Length of the scenario, in cycles.
    pub cycles: u64,
}

impl Reader<'_> {
    /// Reads the section.
    pub(super) fn read(&self, section: &Value<'_>) -> Vec<Expectation> {
        let items = section.list().unwrap_or_default();
        items.iter().filter_map(|item| self.read_one(item)).collect()
    }

    fn read_one(&self, item: &Value<'_>) -> Option<Expectation> {
        let mut map = item.map("an expectation")?;
        let since = map.optional("since").map(|value| self.step(&value));
        let claim = if map.has("event") {
            self.events(&mut map)
        } else if map.has("values") {
            self.values(&mut map)
        } else {
            self.condition(&mut map)
        };
        let window = self.window(&mut map, claim.as_ref(), since.is_some());
        map.finish();
        let since = match since {
            None => None,
            Some(step) => Some(step?),
        };
        let (from, to) = window?;
        if let Some(step) = since.and_then(|step| self.steps.get(step))
            && let Trigger::At(cycle) = step.trigger
            && let Some(back) = [from, to].map(Moment::back).into_iter().max().filter(|back| *back > cycle)
        {
            let (name, cycle) = (excerpt(step.name.as_deref().unwrap_or_default()), text(cycle, self.cycle_ns));
            item.refuse(format!("{back} cycles before step `{name}` is before cycle 0; it fires in {cycle}"), None);
            return None;
        }
        Some(Expectation { place: item.place(), since, from, to, claim: claim? })
    }

    fn step(&self, value: &Value<'_>) -> Option<usize> {
        let name = value.text()?;
        let found = self.steps.iter().position(|step| step.name.as_deref() == Some(name));
        if found.is_none() {
            let names = self.steps.iter().filter_map(|step| step.name.as_deref());
            value.refuse(format!("no step is called `{}`", excerpt(name)), nearest(name, names).map(did_you_mean));
        }
        found
    }

    /// Reads the first and the last cycle. A list of values defines the last one itself.
    fn window(&self, map: &mut Map<'_>, claim: Option<&Claim>, is_relative: bool) -> Option<(Moment, Moment)> {
        let is_list = map.has("values");
        let at = if is_list { None } else { map.optional("at") };
        let to = if is_list { None } else { map.optional("to") };
        let from = map.optional("from");
        let read = |value: &Value<'_>| {
            if is_relative {
                return Moment::read_relative(value, self.cycle_ns);
            }
            let moment = Moment::read(value, self.cycle_ns)?;
            let cycle = moment.after(0, self.cycles - 1);
            super::refuse_beyond_end(value, cycle, self.cycles, self.cycle_ns).then_some(moment)
        };
        if let Some(at) = at {
            if let Some(other) = from.or(to) {
                other.refuse(format!("at and {} stand side by side; one of them is expected", other.label()), None);
            }
            return read(&at).map(|moment| (moment, moment));
        }
        let first = from.as_ref().map_or(Some(Moment::Cycle(0)), read);
        let last = to.as_ref().map_or(Some(Moment::End), read);
        let (first, mut last) = (first?, last?);
        if let Some(Claim::Values { values, every, .. }) = claim {
            last = self.last_value(map, first, values.len() as u64, *every, is_relative)?;
        }
        let end = self.cycles - 1;
        match (first, last, to) {
            (Moment::Cycle(first), Moment::Cycle(last), Some(to)) if is_relative && first > last => {
                to.refuse(format!("to is {last} cycles from the step, before from {first}"), None);
                return None;
            }
            (first, last, Some(to)) if !is_relative && first.after(0, end) > last.after(0, end) => {
                let [first, last] = [first, last].map(|moment| text(moment.after(0, end), self.cycle_ns));
                to.refuse(format!("to is {last}, before from {first}"), None);
                return None;
            }
            _ => {}
        }
        Some((first, last))
    }

    fn last_value(&self, map: &Map<'_>, from: Moment, count: u64, every: u64, is_relative: bool) -> Option<Moment> {
        let end = self.cycles - 1;
        if from == Moment::End && count == 1 {
            return Some(Moment::End);
        }
        let way = every.saturating_mul(count - 1);
        if let (true, Moment::Cycle(first)) = (is_relative, from) {
            return Some(Moment::Cycle(first.saturating_add_unsigned(way)));
        }
        let last = from.after(0, end).saturating_add(way);
        if last > end {
            let (last, end) = (text(last, self.cycle_ns), text(end, self.cycle_ns));
            map.refuse(format!("value {count} of {count} is at {last}; the scenario ends with {end}"), None);
            return None;
        }
        Some(Moment::Cycle(i64::try_from(last).ok()?))
    }

    fn values(&self, map: &mut Map<'_>) -> Option<Claim> {
        let probe = Probe::read(map, self.names);
        let every = map.optional("every").map_or(Some(1), |value| positive_cycles(&value, self.cycle_ns));
        let (values, within) = (map.optional("values")?, map.optional("within"));
        let probe = probe?;
        let values = rows(&values, &probe.ruler);
        let within = match within {
            Some(within) => Some(probe.read_tolerance(&within)?),
            None => None,
        };
        Some(Claim::Values { probe: Box::new(probe), values: values?, within, every: every? })
    }

    fn condition(&self, map: &mut Map<'_>) -> Option<Claim> {
        let predicate = Predicate::read(map, self.names);
        let mode = map.optional("mode").map_or(Some(Mode::Always), |value| value.choice(&MODES));
        Some(Claim::Condition { predicate: predicate?, mode: mode? })
    }

    fn events(&self, map: &mut Map<'_>) -> Option<Claim> {
        let filter = map.optional("event").and_then(|value| self.filter(&value));
        let [count, min, max, mode] = ["count", "min", "max", "mode"].map(|key| map.optional(key));
        let read = |value: &Option<Value<'_>>| value.as_ref().map(|value| value.integer(0..=u64::MAX >> 1));
        let (exact, low, high) = (read(&count), read(&min), read(&max));
        if let (Some(_), Some(other)) = (&count, min.as_ref().or(max.as_ref())) {
            other.refuse(format!("count and {} stand side by side; one of them is expected", other.label()), None);
            return None;
        }
        if let Some(mode) = mode {
            if let Some(other) = count.as_ref().or(min.as_ref()).or(max.as_ref()) {
                mode.refuse(format!("mode and {} stand side by side; one of them is expected", other.label()), None);
                return None;
            }
            let (min, max) = match mode.choice(&MODES)? {
                Mode::Eventually => (1, None),
                Mode::Never => (0, Some(0)),
                Mode::Always => {
                    let sentence = "mode is always, but an event stands in one cycle; eventually or never is allowed";
                    mode.refuse(sentence, Some("count, min and max say how often it comes".to_owned()));
                    return None;
                }
            };
            return Some(Claim::Events { filter: filter?, min, max });
        }
        let (low, high) = match (exact, low, high) {
            (Some(count), _, _) => (count?, Some(count?)),
            (_, None, None) => (1, None),
            (_, low, high) => (low.unwrap_or(Some(0))?, high.map_or(Some(None), |high| high.map(Some))?),
        };
        if let Some(max) = max.filter(|_| high.is_some_and(|high| high < low)) {
            max.refuse(format!("max is below min {low}"), None);
            return None;
        }
        Some(Claim::Events { filter: filter?, min: low, max: high })
    }

    fn filter(&self, value: &Value<'_>) -> Option<Filter> {
        let mut map = value.map("event")?;
        let [kind, source, severity, code, age, increments, text] =
            ["kind", "source", "severity", "code", "age_ns", "increments", "text"].map(|key| map.optional(key));
        let severities = [("info", Severity::Info), ("warn", Severity::Warn), ("error", Severity::Error)];
        let object = source.as_ref().map(|value| self.names.object(value));
        let written: Vec<String> = [&kind, &source, &severity, &code, &age, &increments, &text]
            .into_iter()
            .flatten()
            .filter_map(|value| Some(format!("{} {}", value.label(), excerpt(value.peek()?))))
            .collect();
        let kind = kind.map(|value| read_kind(&value));
        let severity = severity.map(|value| value.choice(&severities));
        let code = code.map(|value| ruler::read_code(&value));
        let age_ns = age.map(|value| value.integer(0..=u32::MAX));
        let increments = increments.map(|value| self.increments(&value, object.flatten()));
        let part = text.map(|value| value.text().map(str::to_owned));
        map.finish();
        Some(Filter {
            kind: inside_out(kind)?,
            source: inside_out(object)?,
            severity: inside_out(severity)?,
            code: inside_out(code)?,
            age_ns: inside_out(age_ns)?,
            increments: inside_out(increments)?,
            text: inside_out(part)?,
            name: if written.is_empty() { "any event".to_owned() } else { format!("event {}", written.join(", ")) },
        })
    }

    /// Reads a position of the source, with a unit if it has one.
    fn increments(&self, value: &Value<'_>, source: Option<Object>) -> Option<i64> {
        let config = self.names.config;
        let scale = match source {
            Some(Object::Axis(axis)) => config.axes.get(usize::from(axis)).map(|axis| axis.scale),
            Some(Object::Encoder(place)) => config.encoders.get(usize::from(place)).map(|encoder| encoder.scale),
            _ => None,
        };
        let Some(scale) = scale else { return value.integer(i64::MIN..=i64::MAX) };
        match ValueFormat::of_positions(scale).read(value)? {
            Number::Int(position) => Some(position),
            Number::Real(_) => None,
        }
    }
}

/// Converts an absent value to `Some(None)`, and a wrong one to `None`.
fn inside_out<T>(value: Option<Option<T>>) -> Option<Option<T>> {
    value.map_or(Some(None), |value| value.map(Some))
}

fn read_kind(value: &Value<'_>) -> Option<Kind> {
    let kinds: Vec<_> = Kind::ALL.iter().map(|(kind, name)| (*name, *kind)).collect();
    value.choice(&kinds)
}

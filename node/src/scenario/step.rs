//! Section `steps`: timed and conditional actions.
//!
//! Law      `at` steps act in their cycle. A `when` step is armed when the step before it has fired (acted for the
//!          first time), is evaluated at the end of a cycle k and acts in k + 1 + after; `every` and `count` repeat
//!          both kinds
//! Source   contract section 5

use super::moment::{self, Moment, positive_cycles};
use super::names::Names;
use super::predicate::Predicate;
use super::refusal::Refusal;
use super::verb::{self, Act, Ids};
use crate::document::{Map, Place, Value};
use lineshaft_core::unit::excerpt;
use std::ops::Range;

/// One step.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub place: Place,
    pub name: Option<String>,
    pub trigger: Trigger,
    pub repeat: Option<Repeat>,
    /// Range of its acts among those of all steps.
    pub acts: Range<usize>,
    /// Refusal that its commands must get.
    pub refused: Option<Refusal>,
    /// Whether the step may never fire.
    pub optional: bool,
}

/// Condition under which a step fires.
#[derive(Clone, Debug)]
pub(super) enum Trigger {
    At(u64),
    When { predicate: Box<Predicate>, after: u64 },
}

/// Repetition of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Repeat {
    pub every: u64,
    /// Number of times; `None` for until the end.
    pub count: Option<u64>,
}

/// Data for reading steps.
pub(super) struct Reader<'a> {
    pub names: &'a Names<'a>,
    pub cycle_ns: u64,
    /// Length of the scenario, in cycles.
    pub cycles: u64,
    pub ids: Ids,
    pub acts: Vec<Act>,
}

impl Reader<'_> {
    /// Reads the section.
    pub(super) fn read(&mut self, section: &Value<'_>) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        for item in section.list().unwrap_or_default() {
            let first = self.acts.len();
            let Some(mut map) = item.map("a step") else { continue };
            let name = map.optional("name").and_then(|value| step_name(&value, &steps));
            let optional = map.optional("optional").and_then(|value| value.boolean());
            let refused = map.optional("refused").and_then(|value| Refusal::read(&value));
            if let Some(verbs) = map.required("do") {
                let mut reader =
                    verb::Reader { names: self.names, ids: &mut self.ids, refused: refused.as_ref(), recorded: false };
                let acts = reader.read(&verbs);
                self.acts.extend(acts);
            }
            let (trigger, repeat) = (self.trigger(&mut map), self.repeat(&mut map));
            self.check_last(&item, trigger.as_ref(), repeat);
            map.finish();
            steps.push(Step {
                place: item.place(),
                name,
                // A step without a trigger is a problem; it is kept for references to its name.
                trigger: trigger.unwrap_or(Trigger::At(0)),
                repeat,
                acts: first..self.acts.len(),
                refused,
                optional: optional.unwrap_or(false),
            });
        }
        steps
    }

    fn trigger(&self, map: &mut Map<'_>) -> Option<Trigger> {
        let [at, when, after] = ["at", "when", "after"].map(|key| map.optional(key));
        let after_cycles = after.as_ref().map_or(Some(0), |value| moment::cycles(value, self.cycle_ns));
        match (at, when) {
            (Some(at), None) => {
                if let Some(after) = after {
                    after.refuse("after belongs to when", Some("add it to `at`".to_owned()));
                }
                let cycle = Moment::read(&at, self.cycle_ns)?.after(0, self.cycles - 1);
                super::refuse_beyond_end(&at, cycle, self.cycles, self.cycle_ns).then_some(Trigger::At(cycle))
            }
            (None, Some(when)) => {
                let mut condition = when.map("when")?;
                let predicate = Predicate::read(&mut condition, self.names);
                condition.finish();
                Some(Trigger::When { predicate: Box::new(predicate?), after: after_cycles? })
            }
            (at, _) => {
                let sentence = if at.is_some() { "at and when stand side by side" } else { "a step has no time" };
                map.refuse(format!("{sentence}; one of at, when is expected"), None);
                None
            }
        }
    }

    fn repeat(&self, map: &mut Map<'_>) -> Option<Repeat> {
        let (every, count) = (map.optional("every"), map.optional("count"));
        let times = count.as_ref().and_then(|value| value.integer(1..=moment::MAX_CYCLES));
        match (every, count) {
            (None, None) => None,
            (None, Some(count)) => {
                count.refuse("count needs every", None);
                None
            }
            (Some(every), _) => positive_cycles(&every, self.cycle_ns).map(|every| Repeat { every, count: times }),
        }
    }

    /// Checks that all times of an `at` step with a count are within the scenario.
    fn check_last(&self, item: &Value<'_>, trigger: Option<&Trigger>, repeat: Option<Repeat>) {
        if let (Some(Trigger::At(at)), Some(Repeat { every, count: Some(count) })) = (trigger, repeat) {
            let last = at.saturating_add(every.saturating_mul(count - 1));
            if last >= self.cycles {
                let (given, end) = (moment::text(last, self.cycle_ns), moment::text(self.cycles - 1, self.cycle_ns));
                item.refuse(format!("time {count} of {count} is {given}; the scenario ends with {end}"), None);
            }
        }
    }
}

fn step_name(value: &Value<'_>, steps: &[Step]) -> Option<String> {
    let name = value.text()?;
    if steps.iter().any(|step| step.name.as_deref() == Some(name)) {
        value.refuse(format!("two steps are called `{}`", excerpt(name)), None);
        return None;
    }
    Some(name.to_owned())
}

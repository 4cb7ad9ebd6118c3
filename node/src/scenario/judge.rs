//! Evaluates expectations while a scenario runs, and their results.

use super::expect::{Claim, Expectation, Mode, times};
use super::moment::text;
use super::predicate::{Check, Predicate, Probe};
use super::report::{ExpectationResult, Failure};
use super::step::Step;
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::Value as Number;
use std::collections::VecDeque;

/// Maximum number of event cycles in a report.
const LISTED: usize = 8;
/// Maximum number of different values in a report.
const DIFFERENCES: usize = 5;

/// State of one expectation.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    /// Number of cycles of the window so far.
    judged: u64,
    /// Number of cycles, values or events against it; for it, if one is sufficient.
    count: u64,
    /// First cycle in which it failed, and the value found.
    first: Option<(u64, String)>,
    /// Closest value: its distance, cycle, value.
    closest: Option<(f64, u64, Number)>,
    /// Last cycle of the window so far.
    last: Option<(u64, String)>,
    listed: Vec<u64>,
    /// First values that differ, each with its cycle.
    differences: Vec<(u64, Number)>,
    /// The newest cycles, until the step from which they may count has fired.
    past: VecDeque<Sample>,
    /// Memory for the current cycle.
    now: Sample,
}

/// Data of an expectation in a cycle.
#[derive(Clone, Debug, Default)]
struct Sample {
    cycle: u64,
    /// Values of each test, or of the probe.
    values: Vec<Number>,
    /// Number of events that count.
    events: u64,
}

/// A finished cycle.
pub(super) struct Seen<'a> {
    pub cycle: u64,
    pub machine: &'a Machine,
    /// First cycle in which each step fired.
    pub fired: &'a [Option<u64>],
}

/// End of a scenario.
pub(super) struct End<'a> {
    /// Last cycle.
    pub last: u64,
    /// Whether the scenario ran to its regular end.
    pub is_complete: bool,
    pub cycle_ns: u64,
    pub fired: &'a [Option<u64>],
}

impl Expectation {
    /// Returns the cycle from which its window counts; `None` until its step has fired.
    fn base(&self, fired: &[Option<u64>]) -> Option<u64> {
        self.since.map_or(Some(0), |step| fired.get(step).copied().flatten())
    }

    /// Returns the first and the last cycle of the window.
    fn window(&self, base: u64, last: u64) -> (u64, u64) {
        (self.from.after(base, last), self.to.after(base, last))
    }

    /// Returns by how many cycles the window begins before its step.
    fn back(&self) -> u64 {
        self.from.back().max(self.to.back())
    }

    /// Evaluates a cycle; cycles before a step are stored until it has fired.
    pub(super) fn evaluate(&self, record: &mut Record, seen: &Seen<'_>, last: u64) {
        let Some(base) = self.base(seen.fired) else {
            if self.back() > 0 {
                // The oldest sample is reused, so that its values need no new memory.
                let is_full = record.past.len() as u64 >= self.back();
                let mut sample = if is_full { record.past.pop_front() } else { None }.unwrap_or_default();
                self.look(seen, &mut sample);
                record.past.push_back(sample);
            }
            return;
        };
        let window = self.window(base, last);
        for sample in std::mem::take(&mut record.past) {
            self.judge_sample(record, &sample, window, last);
        }
        if (window.0..=window.1).contains(&seen.cycle) {
            let mut sample = std::mem::take(&mut record.now);
            self.look(seen, &mut sample);
            self.judge_sample(record, &sample, window, last);
            record.now = sample;
        }
    }

    fn look(&self, seen: &Seen<'_>, sample: &mut Sample) {
        sample.cycle = seen.cycle;
        sample.values.clear();
        match &self.claim {
            Claim::Values { probe, .. } => sample.values.push(probe.value(seen.machine)),
            Claim::Condition { predicate, .. } => predicate.look(seen.machine, &mut sample.values),
            Claim::Events { filter, .. } => {
                let events = seen.machine.events().iter();
                sample.events = events.filter(|event| filter.matches(event, seen.machine.config())).count() as u64;
            }
        }
    }

    fn judge_sample(&self, record: &mut Record, seen: &Sample, (from, to): (u64, u64), last: u64) {
        if !(from..=to).contains(&seen.cycle) {
            return;
        }
        match &self.claim {
            Claim::Values { values, within, every, .. } => {
                let n = seen.cycle - from;
                let row = usize::try_from(n / every)
                    .ok()
                    .and_then(|row| values.get(row))
                    .filter(|_| n.is_multiple_of(*every));
                let (Some(row), Some(&found)) = (row, seen.values.first()) else { return };
                record.judged += 1;
                if !(Check::Is { value: *row, within: *within }).holds(found) {
                    record.count += 1;
                    if record.differences.len() < DIFFERENCES {
                        record.differences.push((seen.cycle, found));
                    }
                }
            }
            Claim::Condition { predicate, mode } => {
                record.judged += 1;
                judge_condition(predicate, *mode, record, seen);
                if seen.cycle == to || seen.cycle == last {
                    record.last = Some((seen.cycle, predicate.found(&seen.values)));
                }
            }
            Claim::Events { .. } => {
                record.count += seen.events;
                let room = LISTED - record.listed.len();
                let times = usize::try_from(seen.events).unwrap_or(room).min(room);
                record.listed.extend(std::iter::repeat_n(seen.cycle, times));
            }
        }
    }

    /// Returns the failure at the end; `None` if there is none, or if the expectation was not judged because an
    /// optional step never fired.
    pub(super) fn verdict(&self, record: &Record, end: &End<'_>) -> Option<Failure> {
        let base = self.base(end.fired)?;
        if let Some(sentence) = self.before_start(base, end) {
            return Some(Failure { place: self.place, sentence });
        }
        let (from, to) = self.window(base, end.last);
        let window = Window { from, to: to.min(end.last), end };
        let sentence = match &self.claim {
            Claim::Values { probe, values, within, every } => {
                let rows = Rows { probe, values, within: *within, every: *every };
                rows.verdict(record, &window)
            }
            Claim::Condition { predicate, mode } => condition_verdict(predicate, *mode, record, &window),
            Claim::Events { filter, min, max } => events_verdict(&filter.name, *min, *max, record, &window),
        };
        let sentence = sentence.or_else(|| self.unfinished(to, end))?;
        Some(Failure { place: self.place, sentence })
    }

    /// Returns the result of the expectation.
    pub(super) fn result(&self, record: &Record, end: &End<'_>, steps: &[Step]) -> ExpectationResult {
        ExpectationResult {
            place: self.place,
            text: self.text(steps, end.cycle_ns),
            is_judged: self.base(end.fired).is_some(),
            failure: self.verdict(record, end).map(|failure| failure.sentence),
        }
    }

    /// Returns an error message for a window that begins before the scenario.
    fn before_start(&self, base: u64, end: &End<'_>) -> Option<String> {
        let back = self.back();
        let fired = text(base, end.cycle_ns);
        (back > base).then(|| format!("it reaches {back} cycles back, before cycle 0; the step fired in {fired}"))
    }

    /// Returns an error message for a window that ends after the scenario, unless one cycle is sufficient.
    fn unfinished(&self, to: u64, end: &End<'_>) -> Option<String> {
        let is_settled = matches!(&self.claim, Claim::Condition { mode: Mode::Eventually, .. })
            || matches!(&self.claim, Claim::Events { max: None, .. });
        if to <= end.last || is_settled || !end.is_complete {
            return None;
        }
        let (to, last) = (text(to, end.cycle_ns), text(end.last, end.cycle_ns));
        Some(format!("it reaches up to {to}; the scenario ends with {last}"))
    }
}

fn judge_condition(predicate: &Predicate, mode: Mode, record: &mut Record, seen: &Sample) {
    let holds = predicate.holds(&seen.values);
    let counts = match mode {
        Mode::Always => !holds,
        Mode::Eventually | Mode::Never => holds,
    };
    if counts {
        record.count += 1;
        record.first.get_or_insert_with(|| (seen.cycle, predicate.found(&seen.values)));
    }
    if mode == Mode::Eventually
        && record.count == 0
        && let Predicate::Test { check, .. } = predicate
        && let Some(&value) = seen.values.first()
        && let Some(miss) = check.miss(value)
        && record.closest.is_none_or(|(closest, _, _)| miss < closest)
    {
        record.closest = Some((miss, seen.cycle, value));
    }
}

struct Window<'a> {
    from: u64,
    to: u64,
    end: &'a End<'a>,
}

impl Window<'_> {
    fn text(&self) -> String {
        let cycle_ns = self.end.cycle_ns;
        if self.from == self.to {
            return format!("in {}", text(self.from, cycle_ns));
        }
        format!("from {} to {}", text(self.from, cycle_ns), text(self.to, cycle_ns))
    }
}

impl Record {
    fn list(&self) -> String {
        if self.listed.is_empty() {
            return String::new();
        }
        let cycles: Vec<String> = self.listed.iter().map(u64::to_string).collect();
        let more = if self.count > LISTED as u64 { ", .." } else { "" };
        format!("; it came in cycle {}{more}", cycles.join(", "))
    }
}

/// A list of expected values.
struct Rows<'a> {
    probe: &'a Probe,
    values: &'a [Number],
    within: Option<Number>,
    every: u64,
}

impl Rows<'_> {
    /// Returns the first difference in full, and up to four more.
    fn verdict(&self, record: &Record, window: &Window<'_>) -> Option<String> {
        let (cycle, found) = record.differences.first()?;
        let row = (cycle - window.from) / self.every;
        let ruler = &self.probe.ruler;
        let expected = Check::Is { value: self.value(*cycle, window)?, within: self.within }.text(ruler);
        let (name, found, when) = (self.probe.name(), ruler.text(*found), text(*cycle, window.end.cycle_ns));
        let count = self.values.len();
        let which = format!("value {} of {count}; {} of {count} values differ", row + 1, record.count);
        let all = self.list(record, window);
        Some(format!("{name} is {found} in {when}; {expected} was expected, {which}{all}"))
    }

    /// Returns the expected value in a cycle.
    fn value(&self, cycle: u64, window: &Window<'_>) -> Option<Number> {
        let row = usize::try_from((cycle - window.from) / self.every).ok()?;
        self.values.get(row).copied()
    }

    /// Lists all known differences if there are several: `: 7 instead of 8 in cycle 7, ..`
    fn list(&self, record: &Record, window: &Window<'_>) -> String {
        if record.differences.len() < 2 {
            return String::new();
        }
        let ruler = &self.probe.ruler;
        let one = |(cycle, found): &(u64, Number)| {
            let expected = self.value(*cycle, window).map_or_else(String::new, |value| ruler.text(value));
            format!("{} instead of {expected} in cycle {cycle}", ruler.text(*found))
        };
        let all: Vec<String> = record.differences.iter().map(one).collect();
        let more = if record.count > DIFFERENCES as u64 { ", .." } else { "" };
        format!(": {}{more}", all.join(", "))
    }
}

fn events_verdict(name: &str, min: u64, max: Option<u64>, record: &Record, window: &Window<'_>) -> Option<String> {
    let are_too_many = max.is_some_and(|max| record.count > max);
    let are_too_few = record.count < min && window.end.is_complete;
    if !are_too_many && !are_too_few {
        return None;
    }
    let expected = match max {
        Some(max) if min == max => format!("{min}"),
        Some(max) => format!("{min} to {max}"),
        None => format!("at least {min}"),
    };
    let came = format!("{name} came {} {}", times(record.count), window.text());
    Some(format!("{came}; {expected} was expected{}", record.list()))
}

fn condition_verdict(predicate: &Predicate, mode: Mode, record: &Record, window: &Window<'_>) -> Option<String> {
    let expected = predicate.expected();
    let cycle_ns = window.end.cycle_ns;
    match mode {
        Mode::Always => record.first.as_ref().map(|(cycle, found)| {
            let rest = match record.judged {
                1 => String::new(),
                judged => format!(" {}; {} of {judged} cycles fail", window.text(), record.count),
            };
            format!("{found} in {}; {expected} was expected{rest}", text(*cycle, cycle_ns))
        }),
        Mode::Never => record.first.as_ref().map(|(cycle, found)| {
            let judged = record.judged;
            let rest = format!("{}; {} of {judged} cycles fail", window.text(), record.count);
            format!("{found} in {}; {expected} was never to be {rest}", text(*cycle, cycle_ns))
        }),
        Mode::Eventually if record.count > 0 || !window.end.is_complete => None,
        Mode::Eventually => {
            let closest = match (&record.closest, &record.last, predicate) {
                (Some((_, cycle, value)), _, Predicate::Test { probe, .. }) if probe.ruler.is_ordered() => {
                    format!("; closest was {} in {}", probe.ruler.text(*value), text(*cycle, cycle_ns))
                }
                (_, Some((cycle, found)), _) => format!("; {found} in {}", text(*cycle, cycle_ns)),
                _ => String::new(),
            };
            Some(format!("{} was expected once {}, and never came{closest}", predicate.text(), window.text()))
        }
    }
}

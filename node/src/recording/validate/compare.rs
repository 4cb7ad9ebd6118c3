//! Compares one signal of a run with the same signal of the expected run.
//!
//! Law      lines: at each time at which one of the two has a point, the other is interpolated linearly between its
//!          points; the deviation is the distance of the two values. Steps: the values must occur in the same order; if
//!          both have samples at exactly the same times, they must also change at the same times
//! Refuses  NaN, start or end times that differ, and gaps

use super::rhythm::{gaps, median};
use crate::recording::series::Track;
use lineshaft_core::code::Code;
use lineshaft_core::signal::Type;

/// A signal, the time in ns that counts as zero, and all of its sample times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timed<'t> {
    pub track: &'t Track,
    pub zero: u64,
    pub samples: &'t [i64],
}

/// Permitted deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    /// Difference of values, in SI.
    pub value: f64,
    /// Difference of the times of ends, samples and steps, in ns, if it is larger than the usual one.
    pub time: u64,
    /// Whether the starts may differ, because zero is the start of motion.
    pub any_start: bool,
}

/// Values of both at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Worst {
    /// Their difference; `None` for steps.
    pub deviation: Option<f64>,
    /// Time in ns, relative to zero.
    pub at: i64,
    pub run: f64,
    pub expected: f64,
}

/// Result of a comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Judged {
    pub worst: Option<Worst>,
    /// Error messages, if any.
    pub failures: Vec<String>,
}

impl Timed<'_> {
    fn point(&self, place: usize) -> Option<(i64, f64)> {
        let &(time, value) = self.track.points.get(place)?;
        Some((time.wrapping_sub(self.zero).cast_signed(), value))
    }

    fn points(&self) -> impl Iterator<Item = (i64, f64)> {
        (0..self.track.points.len()).filter_map(|place| self.point(place))
    }

    /// Returns the times of the first and the last sample, in ns.
    fn span(&self) -> Option<(i64, i64)> {
        let last = self.track.points.len().checked_sub(1)?;
        Some((self.point(0)?.0, self.point(last)?.0))
    }
}

/// Compares a signal with the expected one.
pub(super) fn compare(run: Timed<'_>, expected: Timed<'_>, allowed: Allowed) -> Judged {
    let mut judged = Judged::default();
    let (Some(given), Some(wanted)) = (run.span(), expected.span()) else {
        judged.failures.push("there is no sample".to_owned());
        return judged;
    };
    let two_samples = median(expected.samples).saturating_mul(2);
    let slack = allowed.time.max(two_samples);
    if !allowed.any_start {
        judged.failures.extend(apart("begins", given.0, wanted.0, slack));
    }
    judged.failures.extend(apart("ends", given.1, wanted.1, slack));
    for (what, timed) in [("the run", run), ("what is expected", expected)] {
        if timed.track.samples > 1 && timed.span().is_some_and(|(first, last)| first == last) {
            judged.failures.push(format!("in {what} all {} samples have one stamp", timed.track.samples));
        }
    }
    match run.track.late {
        0 => {}
        1 => judged.failures.push("stamps go back once".to_owned()),
        late => judged.failures.push(format!("stamps go back {late} times")),
    }
    if let Some(gaps) = gaps(run.samples, expected.samples, allowed.time, two_samples) {
        let more = if gaps.count > 1 { format!(", the longest of {} gaps", gaps.count) } else { String::new() };
        let from = gaps.from as f64 / 1e9;
        judged.failures.push(format!("no sample for {} s from {from} s on{more}", seconds(gaps.length)));
    }
    let (from, to) = (given.0.max(wanted.0), given.1.min(wanted.1));
    if from > to {
        judged.failures.push("both have no time in common".to_owned());
        return judged;
    }
    if expected.track.kind == Type::Real {
        lines(run, expected, from, to, allowed.value, &mut judged);
    } else {
        steps(run, expected, from, to, allowed.time, &mut judged);
    }
    judged
}

/// Returns the error message for start or end times that differ too much.
fn apart(what: &str, run: i64, expected: i64, slack: u64) -> Option<String> {
    let far = run.abs_diff(expected);
    let when = if run < expected { "earlier" } else { "later" };
    let sentence = || format!("{what} {} s {when} than expected; {} s is allowed", seconds(far), seconds(slack));
    (far > slack).then(sentence)
}

fn seconds(time: u64) -> String {
    (time as f64 / 1e9).to_string()
}

/// A signal that is read at increasing times.
struct Line<'t> {
    timed: Timed<'t>,
    /// Index of the last point that is not later.
    place: usize,
}

impl Line<'_> {
    fn at(&mut self, time: i64) -> Option<f64> {
        while self.timed.point(self.place + 1).is_some_and(|(next, _)| next <= time) {
            self.place += 1;
        }
        let (before, value) = self.timed.point(self.place)?;
        match self.timed.point(self.place + 1) {
            Some((after, next)) if before < time => {
                let share = (time - before) as f64 / (after - before) as f64;
                Some(value + (next - value) * share)
            }
            _ => Some(value),
        }
    }
}

fn lines(run: Timed<'_>, expected: Timed<'_>, from: i64, to: i64, tolerance: f64, judged: &mut Judged) {
    let mut times: Vec<i64> = run.points().chain(expected.points()).map(|(time, _)| time).collect();
    times.retain(|time| (from..=to).contains(time));
    times.sort_unstable();
    times.dedup();
    let (mut given, mut wanted) = (Line { timed: run, place: 0 }, Line { timed: expected, place: 0 });
    let mut worst: Option<Worst> = None;
    for at in times {
        let (Some(run), Some(expected)) = (given.at(at), wanted.at(at)) else { continue };
        // Equal infinities have no distance.
        let deviation = if run == expected { 0.0 } else { (run - expected).abs() };
        let found = Worst { deviation: Some(deviation), at, run, expected };
        if deviation.is_nan() {
            judged.worst = Some(found);
            let whose = if run.is_nan() { "the run" } else { "what is expected" };
            judged.failures.push(format!("the value in {whose} is NaN"));
            return;
        }
        if worst.and_then(|worst| worst.deviation).is_none_or(|worst| deviation > worst) {
            worst = Some(found);
        }
    }
    judged.worst = worst;
    if let Some(deviation) = worst.and_then(|worst| worst.deviation)
        && deviation > tolerance
    {
        judged.failures.push("deviates".to_owned());
    }
}

fn steps(run: Timed<'_>, expected: Timed<'_>, from: i64, to: i64, slack: u64, judged: &mut Judged) {
    let (given, wanted) = (changes(run, from, to), changes(expected, from, to));
    let is_same_rhythm = run.track.samples == expected.track.samples
        && run.track.rhythm == expected.track.rhythm
        && run.span() == expected.span();
    for place in 0..given.len().max(wanted.len()) {
        let (run, expected) = (given.get(place), wanted.get(place));
        // If one of the two lacks a value there, its last value is shown.
        let values = (run.or(given.last()), expected.or(wanted.last()));
        let (Some(&(run_at, run_value)), Some(&(expected_at, expected_value))) = values else { return };
        let at = if run.is_some() { run_at } else { expected_at };
        let worst = Worst { deviation: None, at, run: run_value, expected: expected_value };
        if run.is_none() || expected.is_none() || run_value != expected_value {
            let (given, wanted, number) = (given.len(), wanted.len(), place + 1);
            let values = if given == 1 { "value" } else { "values" };
            let counts = format!("{given} {values} in the run, {wanted} expected");
            judged.failures.push(format!("differs from value {number} on ({counts})"));
            judged.worst = Some(worst);
            return;
        }
        let far = run_at.abs_diff(expected_at);
        if is_same_rhythm && place > 0 && far > slack {
            let when = if run_at < expected_at { "earlier" } else { "later" };
            judged.failures.push(format!("changes {} s {when} than expected", seconds(far)));
            judged.worst = Some(worst);
            return;
        }
    }
}

/// Returns the value at `from` and each other value until `to`, with the times from which they are valid.
fn changes(timed: Timed<'_>, from: i64, to: i64) -> Vec<(i64, f64)> {
    let mut changes: Vec<(i64, f64)> = Vec::new();
    for (time, value) in timed.points().filter(|(time, _)| *time <= to) {
        match changes.last_mut() {
            Some(last) if time <= from => *last = (from, value),
            Some(last) if last.1 == value => {}
            _ => changes.push((time.max(from), value)),
        }
    }
    changes
}

/// Formats a value.
pub(super) fn text(value: f64, kind: Type) -> String {
    match kind {
        Type::Enum(names) => {
            // Steps are small integers.
            let name = (value >= 0.0).then_some(value as usize).and_then(|place| names.get(place));
            name.map_or_else(|| value.to_string(), |name| (*name).to_owned())
        }
        Type::Int => {
            let row = Code::rows().find(|row| f64::from(row.code.0) == value && row.code.0 > 1000);
            row.map_or_else(|| value.to_string(), |row| format!("{value} ({})", row.name))
        }
        Type::Real => number(value),
        Type::Bit | Type::Word => value.to_string(),
    }
}

/// Formats a number with at most nine digits.
pub(super) fn number(value: f64) -> String {
    let rounded = format!("{value:.8e}").parse().unwrap_or(value);
    let magnitude: f64 = f64::abs(rounded);
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    if (1e-4..1e9).contains(&magnitude) || !magnitude.is_finite() {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

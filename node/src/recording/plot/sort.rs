//! Which signal is drawn where: panels of curves, lanes, or a line of text.

use super::curve::Window;
use super::lane::value_text;
use super::meaning::Meaning;
use super::scale::number;
use super::text::{clean, unit};
use super::{Chosen, Figure, Problem};
use crate::recording::series::{Kind, Series};
use std::collections::HashMap;

/// A number without a unit that changes no more than this often is a lane.
const SELDOM: usize = 40;

/// Times beyond this (s) are none: parts of a second would be lost.
const LATEST: f64 = 1e14;

/// A signal that is drawn, in the time shown.
#[derive(Clone, Debug)]
pub(super) struct Shown<'a> {
    pub(super) series: &'a Series,
    /// Its name, with the topic where several have that name.
    pub(super) name: String,
    pub(super) window: Window<'a>,
}

/// Curves over one another.
#[derive(Clone, Debug)]
pub(super) struct Group<'a> {
    pub(super) meaning: Meaning,
    /// As written for people.
    pub(super) unit: String,
    pub(super) curves: Vec<Shown<'a>>,
}

/// All that was chosen.
#[derive(Clone, Debug, Default)]
pub(super) struct Sorted<'a> {
    /// (s)
    pub(super) from: f64,
    /// (s)
    pub(super) to: f64,
    pub(super) groups: Vec<Group<'a>>,
    pub(super) lanes: Vec<Shown<'a>>,
    /// Signals that never change, each with its value.
    pub(super) constant: Vec<String>,
    /// Signals without a value in the time shown.
    pub(super) empty: Vec<String>,
    /// Fractions, which but few people want to see: of a motion they are a solid block.
    pub(super) fractions: Vec<String>,
    /// What a curve does not show: each signal, and how often.
    pub(super) gaps: Vec<String>,
    pub(super) no_numbers: Vec<String>,
    pub(super) too_large: Vec<String>,
}

/// A fraction that is not named in full.
type Fraction<'a> = (Shown<'a>, Meaning);

impl<'a> Sorted<'a> {
    /// # Errors
    /// [`Problem::NoSignal`], [`Problem::NoValue`], [`Problem::NoChange`], [`Problem::Backwards`]
    pub(super) fn new(figure: &Figure<'a>) -> Result<Self, Problem> {
        if figure.signals.is_empty() {
            return Err(Problem::NoSignal);
        }
        let (from, to) = times(figure)?;
        let mut sorted = Self { from, to, ..Self::default() };
        let mut fractions = Vec::new();
        for (chosen, name) in figure.signals.iter().zip(names(figure)) {
            sorted.add(chosen, name, &mut fractions);
        }
        if sorted.groups.is_empty() && sorted.lanes.is_empty() {
            // There is nothing else: somebody wants to see them.
            fractions.drain(..).for_each(|(shown, meaning)| sorted.draw(shown, meaning, usize::MAX));
        }
        sorted.fractions = fractions.into_iter().map(|(shown, _)| shown.name).collect();
        if sorted.groups.is_empty() && sorted.lanes.is_empty() {
            let count = sorted.constant.len();
            return Err(if count == 0 {
                no_value(figure, ends(figure))
            } else {
                Problem::NoChange { count, from, to }
            });
        }
        sorted.groups.sort_by(|a, b| a.meaning.cmp(&b.meaning));
        Ok(sorted)
    }

    fn add(&mut self, chosen: &Chosen<'a>, name: String, fractions: &mut Vec<Fraction<'a>>) {
        let series = chosen.series;
        let window = Window::new(series, self.from, self.to);
        let changes = window.changes(SELDOM + 1);
        let Some(first) = window.lines().next().or_else(|| window.steps().next()) else {
            self.empty.push(name);
            return;
        };
        if changes == 0 && !chosen.by_name {
            self.constant.push(constant(series, &name, first.1));
            return;
        }
        let shown = Shown { series, name, window };
        let meaning = Meaning::of(&series.name, &series.unit).shared(&series.name);
        if meaning == Meaning::Fraction && !chosen.by_name {
            fractions.push((shown, meaning));
        } else {
            self.draw(shown, meaning, changes);
        }
    }

    fn draw(&mut self, shown: Shown<'a>, meaning: Meaning, changes: usize) {
        let series = shown.series;
        self.note(&shown);
        let is_lane = match series.kind {
            Kind::Bit | Kind::Enum(_) | Kind::Word | Kind::Code => true,
            Kind::Int => matches!(meaning, Meaning::Other(_)) && series.unit.is_empty() && changes <= SELDOM,
            Kind::Real => false,
        };
        if is_lane {
            self.lanes.push(shown);
            return;
        }
        let unit = unit(&series.unit);
        match self.groups.iter_mut().find(|group| group.meaning == meaning && group.unit == unit) {
            Some(group) => group.curves.push(shown),
            None => self.groups.push(Group { meaning, unit, curves: vec![shown] }),
        }
    }

    /// What the curve or lane of a signal does not show.
    fn note(&mut self, shown: &Shown<'a>) {
        let name = &shown.name;
        let times = |count: usize| if count == 1 { "once".to_owned() } else { format!("{count} times") };
        let (no_numbers, too_large) = shown.window.undrawn();
        if no_numbers > 0 {
            self.no_numbers.push(format!("{name} {}", times(no_numbers)));
        }
        if too_large > 0 {
            self.too_large.push(format!("{name} {}", times(too_large)));
        }
        let mut gaps = shown.window.gaps();
        if let Some(first) = gaps.next() {
            let more = gaps.count();
            let when = format!("from {} s to {} s", number(first.0), number(first.1));
            let when = if more == 0 { when } else { format!("{}, first {when}", times(more + 1)) };
            self.gaps.push(format!("{name} {when}"));
        }
    }
}

/// The names of the signals, each with its topic where several have that name.
fn names(figure: &Figure<'_>) -> Vec<String> {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    figure.signals.iter().for_each(|chosen| *counts.entry(&chosen.series.name).or_default() += 1);
    let name = |Chosen { series, .. }: &Chosen<'_>| match counts.get(series.name.as_str()) {
        Some(2..) => clean(&format!("{} {}", series.name, series.topic)),
        _ => clean(&series.name),
    };
    figure.signals.iter().map(name).collect()
}

/// Does the signal jump from value to value? Positions of a motion are on their way between two of them.
pub(super) fn is_stepped(series: &Series) -> bool {
    let jumps = ["target.", "latch."].iter().any(|part| series.name.contains(part));
    match series.kind {
        Kind::Real => false,
        _ => jumps || matches!(Meaning::of(&series.name, &series.unit), Meaning::Other(_)),
    }
}

/// `x.homed 0`
fn constant(series: &Series, name: &str, value: f64) -> String {
    match series.kind {
        Kind::Real | Kind::Int => format!("{name} {} {}", number(value), unit(&series.unit)).trim_end().to_owned(),
        _ => format!("{name} {}", value_text(&series.kind, value as i64)),
    }
}

fn is_time(time: f64) -> bool {
    time.abs() <= LATEST
}

/// First and last time (s) of all signals.
fn ends(figure: &Figure<'_>) -> Option<(f64, f64)> {
    let ends = figure.signals.iter().flat_map(|chosen| {
        let points = &chosen.series.points;
        [points.first(), points.last()].into_iter().flatten().map(|point| point.0)
    });
    let ends = ends.filter(|&time| is_time(time)).map(|time| (time, time));
    ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

fn no_value(figure: &Figure<'_>, run: Option<(f64, f64)>) -> Problem {
    Problem::NoValue { from: figure.from, to: figure.to, run }
}

/// First and last time shown (s), never the same.
fn times(figure: &Figure<'_>) -> Result<(f64, f64), Problem> {
    let Some(run) = ends(figure) else { return Err(no_value(figure, None)) };
    let (from, to) = (figure.from.unwrap_or(run.0), figure.to.unwrap_or(run.1));
    if let (Some(from), Some(to)) = (figure.from, figure.to)
        && from > to
    {
        return Err(Problem::Backwards { from, to });
    }
    // The run is over before, or begins behind, the time that was asked for.
    if !is_time(from) || !is_time(to) || from > run.1 || to < run.0 {
        return Err(no_value(figure, Some(run)));
    }
    // Times in f64 are no finer than this.
    let shortest = 1e-9_f64.max(1e-12 * from.abs().max(to.abs()));
    Ok(if to - from < shortest { (from - 0.5, to + 0.5) } else { (from, to) })
}

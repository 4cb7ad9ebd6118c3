//! Rows of a figure of signals: panels of curves, lanes of states, and lines of text.

use super::axis::{Axis, Spacing};
use super::chart::{Chart, Curve, Lane, Page, Panel, check_width};
use super::curve::{LARGEST, Window, curve};
use super::events::Events;
use super::lane::{Content, LaneRange, stays, value_text};
use super::pen::{BIT_FILL, BUSY, LineStyle, MARGIN, SMALL};
use super::quantity::{ShownUnit, SignalQuantity, unified, with_prefix};
use super::text::{clean, number, use_bundled_font, wrap};
use super::{Chosen, Figure, HEIGHTS, Problem, Target};
use crate::recording::series::{Kind, Series};
use plotters::style::RGBColor;
use std::collections::HashMap;

/// Maximum number of changes of a number without a unit that is drawn as a lane.
const MAX_LANE_CHANGES: usize = 40;
/// Maximum time, in s; larger ones lose fractions of a second.
const MAX_TIME: f64 = 1e14;
/// Minimum height of a plot if the height of the figure is given, in px.
const MIN_HEIGHT: f64 = 64.0;
/// Minimum change; f64 has hardly any digits for smaller ones.
const SMALLEST: f64 = 1e-150;

/// A signal that is drawn, within the time shown.
#[derive(Clone, Debug)]
struct Shown<'a> {
    series: &'a Series,
    /// Name of the signal, with the topic if several signals have that name.
    name: String,
    window: Window<'a>,
}

/// The curves of a panel.
#[derive(Clone, Debug)]
struct Group<'a> {
    quantity: SignalQuantity,
    unit: String,
    curves: Vec<Shown<'a>>,
}

/// All signals of a figure.
#[derive(Clone, Debug, Default)]
struct Signals<'a> {
    /// Start, in s.
    from: f64,
    /// End, in s.
    to: f64,
    /// Whether each curve has its own panel.
    split: bool,
    groups: Vec<Group<'a>>,
    lanes: Vec<Shown<'a>>,
    /// Signals that never change, each with its value.
    constant: Vec<String>,
    /// Signals without a value in the time shown.
    empty: Vec<String>,
    /// Fractions that were not chosen by full name; during motion they would be a solid area.
    fractions: Vec<(Shown<'a>, SignalQuantity)>,
    /// Values that a curve does not show: signal, and number of times.
    gaps: Vec<String>,
    no_numbers: Vec<String>,
    too_large: Vec<String>,
}

/// Draws a figure.
///
/// # Errors
/// Returns any [`Problem`] except those about files.
pub(super) fn draw(figure: &Figure<'_>, target: Target) -> Result<Vec<u8>, Problem> {
    use_bundled_font();
    let signals = Signals::new(figure)?;
    check_width(figure.width)?;
    let (name, unit) = figure.across.words();
    let (low, high) = (signals.from, signals.to);
    let across = Axis { label: format!("{name} ({unit})"), low, high, spacing: Spacing::Even };
    let lanes: Vec<Lane> = signals.lanes.iter().map(|shown| lane(shown, f64::from(figure.width))).collect();
    let objects: Vec<&str> = figure.signals.iter().filter_map(|chosen| chosen.series.name.split('.').next()).collect();
    let events = Events::new(figure.marks, &objects, low, high);
    let notes = signals.notes(&events, f64::from(figure.width) - 2.0 * MARGIN);
    let panels = signals.panels(figure, &across, !lanes.is_empty());
    let mut chart = Chart { title: figure.title.clone(), panels, width: figure.width };
    if let Some(given) = figure.height {
        if !(HEIGHTS.0..=HEIGHTS.1).contains(&given) {
            return Err(Problem::Height { given });
        }
        let page = Page { chart: &chart, lanes: &lanes, across: &across, events: &events, notes: &notes };
        let (around, count) = (page.height_around(), chart.panels.len() as f64);
        let needed = (around + MIN_HEIGHT * count).ceil() as u32;
        if given < needed {
            return Err(Problem::Low { panels: page.contents(), needed, given });
        }
        chart.panels.iter_mut().for_each(|panel| panel.height = (f64::from(given) - around) / count);
    }
    Page { chart: &chart, lanes: &lanes, across: &across, events: &events, notes: &notes }.draw(target)
}

impl<'a> Signals<'a> {
    /// # Errors
    /// [`Problem::NoSignal`], [`Problem::NoValue`], [`Problem::NoChange`], [`Problem::Backwards`]
    fn new(figure: &Figure<'a>) -> Result<Self, Problem> {
        if figure.signals.is_empty() {
            return Err(Problem::NoSignal);
        }
        let (from, to) = times(figure)?;
        let mut signals = Self { from, to, split: figure.split, ..Self::default() };
        for (chosen, name) in figure.signals.iter().zip(names(figure)) {
            signals.add(chosen, name);
        }
        if signals.groups.is_empty() && signals.lanes.is_empty() {
            // There are no other curves to draw.
            let fractions = std::mem::take(&mut signals.fractions);
            fractions.into_iter().for_each(|(shown, quantity)| signals.place(shown, quantity, usize::MAX));
        }
        if signals.groups.is_empty() && signals.lanes.is_empty() {
            return Err(match signals.constant.len() {
                0 => no_value(figure, ends(figure)),
                count => Problem::NoChange { count, from, to },
            });
        }
        signals.groups.sort_by(|a, b| a.quantity.cmp(&b.quantity));
        Ok(signals)
    }

    fn add(&mut self, chosen: &Chosen<'a>, name: String) {
        let series = chosen.series;
        let window = Window::new(series, self.from, self.to);
        let changes = window.changes(MAX_LANE_CHANGES + 1);
        let Some(first) = window.lines().next().or_else(|| window.steps().next()) else {
            self.empty.push(name);
            return;
        };
        if changes == 0 && !chosen.by_name {
            self.constant.push(constant(series, &name, first.1));
            return;
        }
        let shown = Shown { series, name, window };
        let quantity = SignalQuantity::of(&series.name, &series.unit);
        if quantity == SignalQuantity::Fraction && !chosen.by_name {
            self.fractions.push((shown, quantity));
        } else {
            self.place(shown, quantity, changes);
        }
    }

    fn place(&mut self, shown: Shown<'a>, quantity: SignalQuantity, changes: usize) {
        let series = shown.series;
        self.note(&shown);
        let is_lane = match series.kind {
            Kind::Bit | Kind::Enum(_) | Kind::Word | Kind::Code => true,
            Kind::Int => {
                matches!(quantity, SignalQuantity::Other(_)) && series.unit.is_empty() && changes <= MAX_LANE_CHANGES
            }
            Kind::Real => false,
        };
        if is_lane {
            self.lanes.push(shown);
            return;
        }
        let unit = clean(&series.unit);
        let is_same = |group: &&mut Group<'_>| group.quantity == quantity && group.unit == unit;
        match self.groups.iter_mut().find(is_same).filter(|_| !self.split) {
            Some(group) => group.curves.push(shown),
            None => self.groups.push(Group { quantity, unit, curves: vec![shown] }),
        }
    }

    /// Records values that the curve or lane of a signal does not show.
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

    fn panels(&self, figure: &Figure<'_>, across: &Axis, has_lanes: bool) -> Vec<Panel> {
        let units: Vec<&str> = self.groups.iter().map(|group| group.unit.as_str()).collect();
        let height = match self.groups.len() {
            0..=2 => 200.0,
            3..=4 => 160.0,
            _ => 135.0,
        };
        let panel = |(place, group): (usize, &Group<'_>)| Panel {
            across: across.clone(),
            height,
            is_joined: has_lanes || place + 1 < self.groups.len(),
            ..panel(group, &units, f64::from(figure.width))
        };
        self.groups.iter().enumerate().map(panel).collect()
    }

    /// Returns the lines of text below the figure.
    fn notes(&self, events: &Events, room: f64) -> Vec<String> {
        let mut notes = Vec::new();
        if !events.rest.is_empty() {
            notes.extend(wrap(&events.rest, SMALL, room, 2));
        }
        let too_large = format!("beyond \u{b1}{LARGEST:e}, not drawn");
        let fractions: Vec<String> = self.fractions.iter().map(|(shown, _)| shown.name.clone()).collect();
        for (word, signals) in [
            ("NaN or infinite", &self.no_numbers),
            (&too_large, &self.too_large),
            ("values missing", &self.gaps),
            ("constant", &self.constant),
            ("without values", &self.empty),
            ("drawn only if named in full", &fractions),
        ] {
            if !signals.is_empty() {
                notes.extend(listing(word, signals, room));
            }
        }
        notes
    }
}

/// Returns text such as `constant: x.homed 0, x.brake 0 and 31 more`, on at most two lines.
fn listing(word: &str, signals: &[String], room: f64) -> Vec<String> {
    let text = |count: usize| {
        let rest = signals.len() - count;
        let more = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        format!("{word}: {}{more}", signals[..count].join(", "))
    };
    // More names do not fit on two lines; a limit that is too low would only shorten the list.
    let most = signals.len().min(200);
    let fits = |count: &usize| {
        let whole = text(*count);
        wrap(&whole, SMALL, room, 2).join(" ") == whole
    };
    let count = (1..=most).rev().find(fits).unwrap_or(1);
    wrap(&text(count), SMALL, room, 2)
}

/// Returns a panel of curves in one unit, without the fields that depend on its place in the figure.
fn panel(group: &Group<'_>, units: &[&str], columns: f64) -> Panel {
    let (unifying, unit) = unified(&group.unit, units);
    let extents = group.curves.iter().filter_map(|shown| shown.window.extent());
    let (low, high) = extents.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 0.0));
    let (low, high) = range(low * unifying, high * unifying);
    let ShownUnit { factor, text } = with_prefix(&unit, low.abs().max(high.abs()));
    let label = clean(group.quantity.label());
    let factor_of_all = unifying * factor;
    let drawn = |(place, shown): (usize, &Shown<'_>)| {
        let points = curve(&shown.window, is_stepped(shown.series), columns);
        let points = points.into_iter().map(|(time, value)| (time, value * factor_of_all)).collect();
        // A panel with a single curve needs no legend if the name is the same as the label.
        let name = if group.curves.len() == 1 && shown.name == label { String::new() } else { shown.name.clone() };
        Curve { name, look: LineStyle::Signal(place), points }
    };
    let axis = |label, low, high| Axis { label, low, high, spacing: Spacing::Even };
    Panel {
        across: axis(String::new(), 0.0, 1.0),
        up: axis(format!("{label} ({text})"), low * factor, high * factor),
        curves: group.curves.iter().enumerate().map(drawn).collect(),
        pins: Vec::new(),
        level: (low < 0.0 && high > 0.0).then_some(0.0),
        lines: Vec::new(),
        height: 0.0,
        is_joined: true,
    }
}

/// Returns the range of an axis for values from `low` to `high`, with a margin above and below, and with zero if it is
/// near.
fn range(low: f64, high: f64) -> (f64, f64) {
    let largest = low.abs().max(high.abs());
    // A change in the last digits of an f64 is rounding.
    let is_constant = high - low <= (largest * 1e-13).max(SMALLEST);
    let (low, high) = match (is_constant, largest > SMALLEST) {
        (true, false) => (-1.0, 1.0),
        (true, true) => (low - 0.1 * largest, high + 0.1 * largest),
        (false, _) => (low, high),
    };
    let span = high - low;
    let low = if low > 0.0 && low < 0.25 * span { 0.0 } else { low };
    let high = if high < 0.0 && high > -0.25 * span { 0.0 } else { high };
    (low - 0.06 * span, high + 0.06 * span)
}

/// Returns a lane of the timing diagram for a figure with this number of columns.
fn lane(shown: &Shown<'_>, columns: f64) -> Lane {
    let kind = &shown.series.kind;
    let state = |stay: LaneRange| match stay.content {
        Content::Busy => (stay, String::new(), BUSY),
        Content::Value(_) if *kind == Kind::Bit => (stay, String::new(), BIT_FILL),
        Content::Value(value) => {
            let text = value_text(kind, value);
            let colour = state_colour(kind, value, &text);
            (stay, text, colour)
        }
    };
    let states = stays(&shown.window, columns).into_iter().map(state).collect();
    Lane { name: shown.name.clone(), is_bit: *kind == Kind::Bit, states }
}

/// Background colours of states.
const STATES: [RGBColor; 7] = [
    RGBColor(205, 235, 222),
    RGBColor(204, 224, 242),
    RGBColor(250, 224, 200),
    RGBColor(240, 218, 232),
    RGBColor(250, 240, 200),
    RGBColor(216, 238, 250),
    RGBColor(218, 212, 236),
];

/// Returns the background colour of a state: red for faults and error codes, grey for states without power.
fn state_colour(kind: &Kind, value: i64, name: &str) -> RGBColor {
    let name = name.to_ascii_uppercase();
    let is_code = *kind == Kind::Code;
    if (is_code && value != 0) || name.contains("ERROR") || name.contains("FAULT") {
        RGBColor(244, 178, 170)
    } else if is_code || name.contains("DISABLED") || name.starts_with("NOT_READY") || name == "OFF" {
        RGBColor(226, 226, 226)
    } else {
        STATES[usize::try_from(value).unwrap_or(0).wrapping_sub(1) % STATES.len()]
    }
}

/// Returns the names of the signals, each with its topic if several signals have that name.
fn names(figure: &Figure<'_>) -> Vec<String> {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    figure.signals.iter().for_each(|chosen| *counts.entry(&chosen.series.name).or_default() += 1);
    let name = |Chosen { series, .. }: &Chosen<'_>| match counts.get(series.name.as_str()) {
        Some(2..) => clean(&format!("{} {}", series.name, series.topic)),
        _ => clean(&series.name),
    };
    figure.signals.iter().map(name).collect()
}

/// Whether the signal is drawn as steps; a position is drawn as lines, because it moves between two of its values.
fn is_stepped(series: &Series) -> bool {
    let jumps = ["target.", "latch."].iter().any(|part| series.name.contains(part));
    match series.kind {
        Kind::Real => false,
        _ => jumps || matches!(SignalQuantity::of(&series.name, &series.unit), SignalQuantity::Other(_)),
    }
}

/// Returns text such as `x.homed 0`.
fn constant(series: &Series, name: &str, value: f64) -> String {
    match series.kind {
        Kind::Real | Kind::Int => {
            let ShownUnit { factor, text } = with_prefix(&clean(&series.unit), value.abs());
            let unit = if series.unit.is_empty() { "" } else { text.as_str() };
            let factor = if unit.is_empty() { 1.0 } else { factor };
            format!("{name} {} {unit}", number(value * factor)).trim_end().to_owned()
        }
        _ => format!("{name} {}", value_text(&series.kind, value as i64)),
    }
}

fn is_time(time: f64) -> bool {
    time.abs() <= MAX_TIME
}

/// Returns the first and the last time of all signals, in s.
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

/// Returns the first and the last time shown, in s; they always differ.
fn times(figure: &Figure<'_>) -> Result<(f64, f64), Problem> {
    let Some(run) = ends(figure) else { return Err(no_value(figure, None)) };
    let (from, to) = (figure.from.unwrap_or(run.0), figure.to.unwrap_or(run.1));
    if let (Some(from), Some(to)) = (figure.from, figure.to)
        && from > to
    {
        return Err(Problem::Backwards { from, to });
    }
    // The run ends before, or begins after, the requested time.
    if !is_time(from) || !is_time(to) || from > run.1 || to < run.0 {
        return Err(no_value(figure, Some(run)));
    }
    // Resolution of times in f64.
    let shortest = 1e-9_f64.max(1e-12 * from.abs().max(to.abs()));
    Ok(if to - from < shortest { (from - 0.5, to + 0.5) } else { (from, to) })
}

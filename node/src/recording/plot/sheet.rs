//! A figure with all its parts in their places, ready to be painted.

use super::canvas::Colour;
use super::curve::{LARGEST, Line, lines};
use super::lane::{Content, Stay, stays, value_text};
use super::layout::{LABEL, LANE_HEIGHT, LEGEND_HEIGHT, Layout, MARGIN, Parts, SMALL, SMALLEST, TICK};
use super::marks::Events;
use super::palette::{BUSY, code, state};
use super::scale::{Ticks, power, range, ticks};
use super::sort::{Group, Shown, Sorted, is_stepped};
use super::text::{Font, clean};
use super::{Across, Figure, Problem};
use crate::recording::series::Kind;

/// Widest name beside a lane or in a legend: a part of the width of the figure, and at most so many px.
const NAME_PART: f64 = 0.175;
const WIDEST_NAME: f64 = 210.0;
/// What stands before a name in a legend, with its distances (px).
pub(super) const SWATCH: f64 = 44.0;
/// More rows than these make the legend of a panel begin another column, if the figure has this width for each (px).
const MOST_ROWS: usize = 32;
const COLUMN_PART: f64 = 600.0;
/// Below this (px) what is busy looks like the edge of a state, and nobody asks what it is.
const SEEN: f64 = 6.0;
/// Between a label and the axis (px).
const NEAR: f64 = 8.0;

/// A panel of curves.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) label: String,
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) ticks: Ticks,
    pub(super) curves: Vec<Curve>,
}

/// A curve of a panel.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// As in the legend; empty where there is none.
    pub(super) name: String,
    pub(super) lines: Vec<Line>,
}

/// A lane of the timing diagram.
#[derive(Clone, Debug)]
pub(super) struct Lane {
    /// As beside it.
    pub(super) name: String,
    pub(super) is_bit: bool,
    pub(super) stays: Vec<Piece>,
}

/// A stretch of a lane.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) stay: Stay,
    /// Name or number; empty for what is busy.
    pub(super) text: String,
    pub(super) ground: Colour,
    /// Size of its letters (px), if it has room within.
    pub(super) em: Option<f64>,
}

/// An entry of the legend beside the lanes: a state that no lane has room to name, or what is busy.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub(super) ground: Colour,
    /// As in the legend; it tells the lane where lanes of several kinds have such states.
    pub(super) text: String,
}

/// All of a figure.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) title: String,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) width: f64,
    /// Edges of the area of curves and lanes (px).
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) layout: Layout,
    /// Columns of the legends of panels, and the width of each (px).
    pub(super) columns: (usize, f64),
    pub(super) panels: Vec<Panel>,
    pub(super) lanes: Vec<Lane>,
    pub(super) states: Vec<State>,
    pub(super) time: Ticks,
    pub(super) across: Across,
    pub(super) events: Events,
    pub(super) notes: Vec<String>,
}

impl Sheet {
    /// # Errors
    /// The errors of [`draw`](super::draw), but for the pixels.
    pub(super) fn new(figure: &Figure<'_>, font: &Font) -> Result<Self, Problem> {
        let sorted = Sorted::new(figure)?;
        let objects: Vec<&str> =
            figure.signals.iter().filter_map(|chosen| chosen.series.name.split('.').next()).collect();
        let events = Events::new(figure.marks, &objects, sorted.from, sorted.to);
        let width = f64::from(figure.width);
        let longest = (NAME_PART * width).min(WIDEST_NAME);
        let title = font.shorten(&clean(&figure.title), super::layout::TITLE, width - 2.0 * MARGIN);
        let notes = notes(&sorted, &events, font, width - 2.0 * MARGIN);
        let most = sorted.groups.iter().map(|group| group.curves.len()).max().unwrap_or(0);
        let columns = most.div_ceil(MOST_ROWS).min((width / COLUMN_PART) as usize).max(1);
        let mut parts = Parts {
            has_title: !title.is_empty(),
            panels: sorted.groups.iter().map(|group| group.curves.len().div_ceil(columns)).collect(),
            lanes: sorted.lanes.len(),
            states: 0,
            rows: events.listed.len(),
            has_tags: !events.listed.is_empty(),
            notes: notes.len(),
        };
        let layout = parts.layout(figure)?;
        let mut panels: Vec<Panel> = sorted
            .groups
            .iter()
            .zip(&layout.panels)
            .map(|(group, edges)| Panel::new(group, edges, longest, font))
            .collect();
        let names = short_names(&sorted.lanes, longest, font);
        let left = left_margin(&panels, &names, font);
        // States that find no room in the widest lanes are those of the legend; narrower lanes leave out a few more.
        let curves = panels.iter().flat_map(|panel| &panel.curves).map(|curve| font.width(&curve.name, LABEL));
        let widest = curves.fold(0.0, f64::max);
        let column = SWATCH + widest;
        // The last column may be that of the states.
        let legend = (columns - 1) as f64 * column;
        let edge = |widest: f64| {
            let room = if widest > 0.0 { legend + SWATCH + widest } else { 12.0 };
            (width - MARGIN - room).max(left + 100.0)
        };
        let lanes = |right: f64| -> Vec<Lane> {
            let lanes = sorted.lanes.iter().zip(&names);
            lanes.map(|(shown, name)| Lane::new(shown, name, right - left, font)).collect()
        };
        let states = unwritten(&sorted, &lanes(edge(widest)));
        let states = states.iter().map(|state| font.width(&state.text, SMALL).min(longest));
        let right = edge(states.fold(widest, f64::max));
        for (panel, group) in panels.iter_mut().zip(&sorted.groups) {
            for (curve, shown) in panel.curves.iter_mut().zip(&group.curves) {
                curve.lines = lines(&shown.window, is_stepped(shown.series), right - left);
            }
        }
        let lanes = lanes(right);
        let mut states = unwritten(&sorted, &lanes);
        for state in &mut states {
            state.text = font.shorten(&state.text, SMALL, (width - MARGIN - right - SWATCH).max(40.0));
        }
        let lanes_hold = (lanes.len() as f64 * LANE_HEIGHT / LEGEND_HEIGHT) as usize;
        let layout = if states.len() > lanes_hold {
            parts.states = states.len();
            let layout = parts.layout(figure)?;
            for (panel, edges) in panels.iter_mut().zip(&layout.panels) {
                panel.count(edges);
            }
            layout
        } else {
            layout
        };
        let time = time_ticks(sorted.from, sorted.to, right - left, font);
        let (from, to) = (sorted.from, sorted.to);
        let (columns, across) = ((columns, column), figure.across);
        Ok(Self {
            title,
            from,
            to,
            width,
            left,
            right,
            layout,
            columns,
            panels,
            lanes,
            states,
            time,
            across,
            events,
            notes,
        })
    }

    /// The place of a time (px).
    pub(super) fn x(&self, time: f64) -> f64 {
        self.left + (time - self.from) / (self.to - self.from) * (self.right - self.left)
    }
}

impl Panel {
    fn new(group: &Group<'_>, edges: &(f64, f64), longest: f64, font: &Font) -> Self {
        let extents = group.curves.iter().filter_map(|curve| curve.window.extent());
        let (low, high) = extents.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 0.0));
        let (low, high) = range(low, high);
        let mut names = short_names(&group.curves, longest, font);
        // A name that says no more than the label of the panel needs no legend.
        if let [only] = names.as_mut_slice()
            && only == group.meaning.label()
        {
            only.clear();
        }
        let curves = names.into_iter().map(|name| Curve { name, lines: Vec::new() }).collect();
        let ticks = ticks(low, high, 2.0, true);
        let mut panel = Self { label: String::new(), low, high, ticks, curves };
        panel.label = label(group, 0);
        panel.count(edges);
        if panel.ticks.power != 0 {
            panel.label = label(group, panel.ticks.power);
        }
        panel.label = font.shorten(&panel.label, LABEL, edges.1 - edges.0 + 12.0);
        panel
    }

    /// As many marks along the axis as its height holds.
    fn count(&mut self, edges: &(f64, f64)) {
        let most = ((edges.1 - edges.0) / 24.0).clamp(2.0, 8.0);
        self.ticks = ticks(self.low, self.high, most, true);
    }

    /// The place of a value (px) between two edges.
    pub(super) fn y(&self, value: f64, edges: (f64, f64)) -> f64 {
        edges.1 - (value - self.low) / (self.high - self.low) * (edges.1 - edges.0)
    }
}

/// `position (mm)`, `velocity (10^6 inc/s)`.
fn label(group: &Group<'_>, exponent: i32) -> String {
    let factor = if exponent == 0 { String::new() } else { power(exponent) };
    let unit = format!("{factor} {}", group.unit);
    let meaning = clean(group.meaning.label());
    match unit.trim() {
        "" => meaning,
        unit => format!("{meaning} ({unit})"),
    }
}

impl Lane {
    fn new(shown: &Shown<'_>, name: &str, width: f64, font: &Font) -> Self {
        let is_bit = shown.series.kind == Kind::Bit;
        let piece = |stay: Stay| {
            let (text, ground) = match stay.content {
                Content::Value(value) => {
                    let text = value_text(&shown.series.kind, value);
                    let ground = match shown.series.kind {
                        Kind::Code => code(value),
                        _ => state(usize::try_from(value).unwrap_or(0), &text),
                    };
                    (text, ground)
                }
                Content::Busy => (String::new(), BUSY),
            };
            let fits = |em: &f64| font.width(&text, *em) + 6.0 <= stay.to - stay.from;
            let em = [SMALL, SMALLEST].into_iter().find(fits).filter(|_| !is_bit && !text.is_empty());
            Piece { stay, text, ground, em }
        };
        Self { name: name.to_owned(), is_bit, stays: stays(&shown.window, width).into_iter().map(piece).collect() }
    }
}

fn short_names(signals: &[Shown<'_>], longest: f64, font: &Font) -> Vec<String> {
    let names: Vec<&str> = signals.iter().map(|shown| shown.name.as_str()).collect();
    font.shorten_names(&names, LABEL, longest)
}

fn left_margin(panels: &[Panel], names: &[String], font: &Font) -> f64 {
    let ticks = panels.iter().flat_map(|panel| &panel.ticks.labels).map(|label| font.width(label, TICK));
    let ticks = ticks.fold(0.0, f64::max) + NEAR + LABEL + 10.0;
    let names = names.iter().map(|name| font.width(name, LABEL)).fold(0.0, f64::max) + NEAR;
    MARGIN + if panels.is_empty() { names } else { ticks.max(names) }
}

/// The lanes of one list of states.
struct Kin<'a> {
    names: &'a [String],
    /// What the first of them is called.
    called: &'a str,
    /// Number of each state that they take, where it is, and whether it is written somewhere.
    states: Vec<(i64, &'a Piece, bool)>,
}

/// The states that stand in a lane without their name, where no lane of the same states has room for it either; last what
/// is busy.
fn unwritten(sorted: &Sorted<'_>, lanes: &[Lane]) -> Vec<State> {
    let mut kin: Vec<Kin<'_>> = Vec::new();
    for (shown, lane) in sorted.lanes.iter().zip(lanes) {
        let names = match &shown.series.kind {
            Kind::Enum(names) => &names[..],
            Kind::Code => &[],
            _ => continue,
        };
        let place = kin.iter().position(|kin| kin.names == names).unwrap_or_else(|| {
            kin.push(Kin { names, called: lane.name.rsplit('.').next().unwrap_or_default(), states: Vec::new() });
            kin.len() - 1
        });
        for piece in &lane.stays {
            let Content::Value(number) = piece.stay.content else { continue };
            let states = &mut kin[place].states;
            match states.iter_mut().find(|(known, ..)| *known == number) {
                Some((.., is_written)) => *is_written |= piece.em.is_some(),
                None => states.push((number, piece, piece.em.is_some())),
            }
        }
    }
    for kin in &mut kin {
        kin.states.retain(|(.., is_written)| !is_written);
        kin.states.sort_by_key(|state| state.0);
    }
    kin.retain(|kin| !kin.states.is_empty());
    let is_mixed = kin.len() > 1;
    let state = |called: &str, piece: &Piece| {
        let name = &piece.text;
        let text = if is_mixed { format!("{called}: {name}") } else { name.clone() };
        State { ground: piece.ground, text }
    };
    let states = kin.iter().flat_map(|kin| kin.states.iter().map(|(_, piece, _)| state(kin.called, piece)));
    let is_seen = |stay: &Stay| stay.content == Content::Busy && stay.to - stay.from >= SEEN;
    let is_busy = lanes.iter().flat_map(|lane| &lane.stays).any(|piece| is_seen(&piece.stay));
    let busy = is_busy.then(|| State { ground: BUSY, text: "changes too fast to show".to_owned() });
    states.chain(busy).collect()
}

/// Marks along the time, as close as their labels allow.
fn time_ticks(from: f64, to: f64, width: f64, font: &Font) -> Ticks {
    let widest = |ticks: &Ticks| ticks.labels.iter().map(|label| font.width(label, TICK)).fold(0.0, f64::max);
    let counts = (2..=14).rev().map(f64::from);
    let all = counts.map(|most| ticks(from, to, most, false));
    let fitting = all.filter(|ticks| (widest(ticks) + 24.0) * ticks.labels.len() as f64 <= width);
    fitting.max_by_key(|ticks| ticks.labels.len()).unwrap_or_else(|| ticks(from, to, 1.0, false))
}

/// The lines of small text below the figure.
fn notes(sorted: &Sorted<'_>, events: &Events, font: &Font, room: f64) -> Vec<String> {
    let mut notes = Vec::new();
    if !events.rest.is_empty() {
        notes.extend(font.wrap(&events.rest, SMALL, room, 1));
    }
    let too_large = format!("beyond \u{b1}{LARGEST:e}, not drawn");
    for (word, signals) in [
        ("NaN or infinite", &sorted.no_numbers),
        (&too_large, &sorted.too_large),
        ("values missing", &sorted.gaps),
        ("constant", &sorted.constant),
        ("without values", &sorted.empty),
        ("drawn only if named in full", &sorted.fractions),
    ] {
        if !signals.is_empty() {
            notes.extend(listing(word, signals, font, room));
        }
    }
    notes
}

/// `constant: x.homed 0, x.brake 0 and 31 more` on two lines at most.
fn listing(word: &str, signals: &[String], font: &Font, room: f64) -> Vec<String> {
    let text = |count: usize| {
        let rest = signals.len() - count;
        let more = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        format!("{word}: {}{more}", signals[..count].join(", "))
    };
    // Two lines hold no more than this many; a count that is too low would only shorten the list.
    let most = signals.len().min(200);
    let fits = |count: &usize| {
        let lines = font.wrap(&text(*count), SMALL, room, 2);
        !lines.iter().any(|line| line.ends_with('\u{2026}'))
    };
    let count = (1..=most).rev().find(fits).unwrap_or(1);
    font.wrap(&text(count), SMALL, room, 2)
}

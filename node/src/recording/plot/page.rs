//! Paints a sheet.

use super::canvas::{Anchor, Canvas, Colour, Letters, Point, Stroke, point};
use super::lane::Content;
use super::layout::{
    LABEL, LANE_HEIGHT, LEGEND_HEIGHT, MARGIN, NOTE_HEIGHT, ROW_HEIGHT, SMALL, TAGS_HEIGHT, TICK, TITLE,
};
use super::marks::{Listed, spread};
use super::palette::{BIT_EDGE, BIT_FILL, BUSY, FRAME, GRID, INK, LANE_EDGE, PALE_INK, PAPER, curve, mark};
use super::sheet::{Lane, Panel, Piece, SWATCH, Sheet};
use super::text::Font;

const TAG: f64 = 15.0;
/// How far the mark of an event without a number reaches into the first panel (px).
const SHORT_MARK: f64 = 7.0;
/// Free above and below within a lane (px).
const LANE_AIR: f64 = 4.0;

pub(super) fn paint(sheet: &Sheet, font: &Font, canvas: &mut dyn Canvas) {
    let height = f64::from(sheet.layout.height);
    canvas.fill(point(0.0, 0.0), point(sheet.width, height), PAPER);
    if !sheet.title.is_empty() {
        let letters = Letters::new(TITLE, INK, Anchor::Start);
        canvas.text(&sheet.title, point(MARGIN, sheet.layout.title), letters);
    }
    grid(sheet, canvas);
    marks(sheet, canvas);
    for (panel, &edges) in sheet.panels.iter().zip(&sheet.layout.panels) {
        paint_panel(sheet, panel, edges, canvas);
    }
    paint_lanes(sheet, canvas);
    time_axis(sheet, canvas);
    list(sheet, font, canvas);
    for (place, note) in sheet.notes.iter().enumerate() {
        let y = sheet.layout.notes + (place as f64 + 0.5) * NOTE_HEIGHT;
        canvas.text(note, point(MARGIN, y), Letters::new(SMALL, PALE_INK, Anchor::Start));
    }
}

/// The middle of the nearest pixel: lines along it are sharp.
fn sharp(place: f64) -> f64 {
    place.floor() + 0.5
}

fn upright(canvas: &mut dyn Canvas, x: f64, edges: (f64, f64), colour: Colour) {
    canvas.stroke(&[point(sharp(x), edges.0), point(sharp(x), edges.1)], Stroke::line(colour, 1.0));
}

fn level(canvas: &mut dyn Canvas, y: f64, edges: (f64, f64), colour: Colour) {
    canvas.stroke(&[point(edges.0, sharp(y)), point(edges.1, sharp(y))], Stroke::line(colour, 1.0));
}

fn grid(sheet: &Sheet, canvas: &mut dyn Canvas) {
    let lanes = (!sheet.lanes.is_empty()).then_some(sheet.layout.lanes);
    for edges in sheet.layout.panels.iter().copied().chain(lanes) {
        for &time in &sheet.time.values {
            upright(canvas, sheet.x(time), edges, GRID);
        }
    }
    for (panel, &edges) in sheet.panels.iter().zip(&sheet.layout.panels) {
        for &value in &panel.ticks.values {
            let is_zero = value == 0.0;
            level(canvas, panel.y(value, edges), (sheet.left, sheet.right), if is_zero { FRAME } else { GRID });
        }
    }
}

/// Events as lines over all panels, below the curves. Those that were expected and have no number are short: a hundred lines
/// would be a fence.
fn marks(sheet: &Sheet, canvas: &mut dyn Canvas) {
    let layout = &sheet.layout;
    let top = if sheet.events.listed.is_empty() { layout.tags } else { layout.tags + TAGS_HEIGHT - 4.0 };
    let edges = (top, layout.axis);
    let first = layout.panels.first().map_or(layout.lanes.0, |panel| panel.0);
    let short = (top, first + SHORT_MARK);
    let mut last = f64::NAN;
    // The important ones, which come first, on top.
    for &(time, severity) in sheet.events.plain.iter().rev() {
        let x = sharp(sheet.x(time));
        if x != last {
            match severity {
                0 => upright(canvas, x, short, mark(severity)),
                _ => upright(canvas, x, edges, paler(mark(severity))),
            }
        }
        last = x;
    }
    let mut by_severity: Vec<&Listed> = sheet.events.listed.iter().collect();
    by_severity.sort_by_key(|listed| listed.severity);
    for listed in by_severity {
        upright(canvas, sheet.x(listed.time), edges, mark(listed.severity));
    }
    let wishes: Vec<f64> = sheet.events.listed.iter().map(|listed| sharp(sheet.x(listed.time))).collect();
    let places = spread(&wishes, TAG + 3.0, sheet.left - TAG, sheet.right + TAG);
    for ((listed, wish), place) in sheet.events.listed.iter().zip(wishes).zip(places) {
        let colour = mark(listed.severity);
        let foot = [point(place, layout.tags + TAG), point(wish, edges.0)];
        canvas.stroke(&foot, Stroke::line(colour, 1.0));
        tag(canvas, listed, point(place, layout.tags + TAG / 2.0));
    }
}

fn paler(colour: Colour) -> Colour {
    let pale = |part: u8| 255 - (255 - part) / 2;
    Colour(pale(colour.0), pale(colour.1), pale(colour.2))
}

/// The number of an event on its colour.
fn tag(canvas: &mut dyn Canvas, listed: &Listed, at: Point) {
    let half = TAG / 2.0;
    canvas.fill(point(at.x - half, at.y - half), point(at.x + half, at.y + half), mark(listed.severity));
    canvas.text(&listed.number.to_string(), at, Letters::new(10.5, PAPER, Anchor::Middle));
}

fn frame(sheet: &Sheet, edges: (f64, f64), canvas: &mut dyn Canvas) {
    let (left, right, top, end) = (sharp(sheet.left), sharp(sheet.right), sharp(edges.0), sharp(edges.1));
    let corners = [point(left, top), point(right, top), point(right, end), point(left, end), point(left, top)];
    canvas.stroke(&corners, Stroke::line(FRAME, 1.0));
}

fn paint_panel(sheet: &Sheet, panel: &Panel, edges: (f64, f64), canvas: &mut dyn Canvas) {
    for (place, one) in panel.curves.iter().enumerate() {
        for line in &one.lines {
            let points: Vec<Point> =
                line.iter().map(|&(x, value)| point(sheet.left + x, panel.y(value, edges))).collect();
            canvas.stroke(&points, curve(place, panel.curves.len()));
        }
    }
    frame(sheet, edges, canvas);
    let ticks = panel.ticks.values.iter().zip(&panel.ticks.labels);
    for (&value, label) in ticks {
        let y = panel.y(value, edges);
        level(canvas, y, (sheet.left - 4.0, sheet.left), FRAME);
        canvas.text(label, point(sheet.left - 7.0, y), Letters::new(TICK, INK, Anchor::End));
    }
    if let Some(base) = &panel.ticks.base {
        let at = point(sheet.left, edges.0 - 8.0);
        canvas.text(&format!("{base} +"), at, Letters::new(TICK, INK, Anchor::Start));
    }
    let letters = Letters { upright: true, ..Letters::new(LABEL, INK, Anchor::Middle) };
    canvas.text(&panel.label, point(MARGIN + 4.0, (edges.0 + edges.1) / 2.0), letters);
    legend(sheet, panel, edges, canvas);
}

fn legend(sheet: &Sheet, panel: &Panel, edges: (f64, f64), canvas: &mut dyn Canvas) {
    let rows = ((edges.1 - edges.0) / LEGEND_HEIGHT).floor().max(1.0) as usize;
    let (columns, width) = sheet.columns;
    let room = rows * columns;
    let shown = if panel.curves.len() > room { room - 1 } else { panel.curves.len() };
    let at = |place: usize| {
        let (column, row) = (place / rows, place % rows);
        point(sheet.right + column as f64 * width, edges.0 + (row as f64 + 0.5) * LEGEND_HEIGHT)
    };
    let text = |place: usize| point(at(place).x + SWATCH - 2.0, at(place).y);
    for (place, one) in panel.curves.iter().enumerate().take(shown).filter(|(_, one)| !one.name.is_empty()) {
        let from = point(at(place).x + 8.0, at(place).y);
        canvas.stroke(&[from, point(from.x + 28.0, from.y)], curve(place, panel.curves.len()));
        canvas.text(&one.name, text(place), Letters::new(LABEL, INK, Anchor::Start));
    }
    if shown < panel.curves.len() {
        let more = format!("and {} more", panel.curves.len() - shown);
        canvas.text(&more, text(shown), Letters::new(LABEL, PALE_INK, Anchor::Start));
    }
}

fn paint_lanes(sheet: &Sheet, canvas: &mut dyn Canvas) {
    if sheet.lanes.is_empty() {
        return;
    }
    let top = sheet.layout.lanes.0;
    for (place, lane) in sheet.lanes.iter().enumerate() {
        let edges = (top + place as f64 * LANE_HEIGHT, top + (place + 1) as f64 * LANE_HEIGHT);
        let middle = (edges.0 + edges.1) / 2.0;
        canvas.text(&lane.name, point(sheet.left - 7.0, middle), Letters::new(LABEL, INK, Anchor::End));
        paint_lane(sheet, lane, (edges.0 + LANE_AIR, edges.1 - LANE_AIR), canvas);
        if place > 0 {
            level(canvas, edges.0, (sheet.left, sheet.right), GRID);
        }
    }
    let end = top + sheet.lanes.len() as f64 * LANE_HEIGHT;
    frame(sheet, (top, end), canvas);
    for (row, one) in sheet.states.iter().enumerate() {
        let y = top + (row as f64 + 0.5) * LEGEND_HEIGHT;
        let (from, to) = (point(sheet.right + 12.0, y - 6.0), point(sheet.right + 32.0, y + 6.0));
        canvas.fill(from, to, LANE_EDGE);
        canvas.fill(point(from.x + 1.0, from.y + 1.0), point(to.x - 1.0, to.y - 1.0), one.ground);
        canvas.text(&one.text, point(sheet.right + SWATCH - 2.0, y), Letters::new(SMALL, INK, Anchor::Start));
    }
}

fn paint_lane(sheet: &Sheet, lane: &Lane, edges: (f64, f64), canvas: &mut dyn Canvas) {
    for piece in &lane.stays {
        let (from, to) = (sheet.left + piece.stay.from, sheet.left + piece.stay.to);
        match piece.stay.content {
            Content::Busy => canvas.fill(point(from, edges.0), point(to, edges.1), BUSY),
            Content::Value(value) if lane.is_bit => {
                if value != 0 {
                    canvas.fill(point(from, edges.0), point(to, edges.1), BIT_FILL);
                }
            }
            Content::Value(_) => paint_state(piece, (from, to), edges, canvas),
        }
    }
    if lane.is_bit {
        edge(sheet, lane, edges, canvas);
    }
}

fn paint_state(piece: &Piece, (from, to): (f64, f64), edges: (f64, f64), canvas: &mut dyn Canvas) {
    // A thin line around each state; in narrow ones nothing but that line would be left.
    let line = if to - from > 4.0 { 0.5 } else { 0.0 };
    canvas.fill(point(from, edges.0), point(to, edges.1), LANE_EDGE);
    let (upper, lower) = (point(from + line, edges.0 + 0.5), point(to - line, edges.1 - 0.5));
    canvas.fill(upper, lower, piece.ground);
    if let Some(em) = piece.em {
        let middle = point((from + to) / 2.0, (edges.0 + edges.1) / 2.0);
        canvas.text(&piece.text, middle, Letters::new(em, INK, Anchor::Middle));
    }
}

/// The edge of a bit: up where it is 1.
fn edge(sheet: &Sheet, lane: &Lane, edges: (f64, f64), canvas: &mut dyn Canvas) {
    let mut path: Vec<Point> = Vec::new();
    let mut draw = |path: &mut Vec<Point>| {
        canvas.stroke(path, Stroke::line(BIT_EDGE, 1.3));
        path.clear();
    };
    for piece in &lane.stays {
        let (from, to) = (sheet.left + piece.stay.from, sheet.left + piece.stay.to);
        let y = match piece.stay.content {
            Content::Value(0) => sharp(edges.1),
            Content::Value(_) => sharp(edges.0),
            Content::Busy => {
                draw(&mut path);
                continue;
            }
        };
        if path.last().is_some_and(|last| from - last.x > 0.5) {
            draw(&mut path);
        }
        path.extend([point(from, y), point(to, y)]);
    }
    draw(&mut path);
}

fn time_axis(sheet: &Sheet, canvas: &mut dyn Canvas) {
    let top = sheet.layout.axis;
    for (&time, label) in sheet.time.values.iter().zip(&sheet.time.labels) {
        upright(canvas, sheet.x(time), (top, top + 5.0), FRAME);
        canvas.text(label, point(sheet.x(time), top + 14.0), Letters::new(TICK, INK, Anchor::Middle));
    }
    let (name, unit) = sheet.across.words();
    let label = match &sheet.time.base {
        None => format!("{name} ({unit})"),
        Some(base) => format!("{name} ({unit}), from {base} {unit} on"),
    };
    let middle = (sheet.left + sheet.right) / 2.0;
    canvas.text(&label, point(middle, top + 32.0), Letters::new(LABEL, INK, Anchor::Middle));
}

/// The list of events: number, time, source, sentence.
fn list(sheet: &Sheet, font: &Font, canvas: &mut dyn Canvas) {
    let listed = &sheet.events.listed;
    let digits = if sheet.to - sheet.from < 0.1 { 6 } else { 3 };
    let times: Vec<String> = listed.iter().map(|one| format!("{:.digits$} s", one.time)).collect();
    let widest = |texts: &mut dyn Iterator<Item = &str>| texts.map(|text| font.width(text, SMALL)).fold(0.0, f64::max);
    let time_end = MARGIN + TAG + 12.0 + widest(&mut times.iter().map(String::as_str));
    let source = time_end + 14.0;
    let text = source + widest(&mut listed.iter().map(|one| one.source.as_str())).min(160.0) + 14.0;
    for (row, (one, time)) in listed.iter().zip(&times).enumerate() {
        let y = sheet.layout.list + (row as f64 + 0.5) * ROW_HEIGHT;
        tag(canvas, one, point(MARGIN + TAG / 2.0, y));
        canvas.text(time, point(time_end, y), Letters::new(SMALL, INK, Anchor::End));
        let letters = Letters::new(SMALL, INK, Anchor::Start);
        canvas.text(&font.shorten(&one.source, SMALL, 160.0), point(source, y), letters);
        canvas.text(&font.shorten(&one.text, SMALL, sheet.width - MARGIN - text), point(text, y), letters);
    }
}

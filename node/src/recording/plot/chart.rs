//! Charts: panels below each other, each with axes of its own, linear or logarithmic.
//!
//! Law      a curve ends where it leaves its panel; what a pin measures stands beside it, where nothing else stands
//! Reads    points, in the order in which they are joined
//! Refuses  a width out of its range ([`Problem::Width`]), more height than a figure has ([`Problem::High`])
//!
//! Unlike a figure of a run it knows no time and no signals; letters, colours and files are the same.

use super::canvas::{Anchor, Canvas, Colour, Letters, Point, Stroke, point};
use super::curve::reduced;
use super::layout::{LABEL, LEGEND_HEIGHT, MARGIN, NOTE_HEIGHT, SMALL, TICK, TITLE};
use super::palette::{FRAME, GRID, INK, PALE_INK, PAPER};
use super::scale::{Ticks, decades, multiples, ticks};
use super::text::{Font, clean};
use super::{HEIGHTS, Problem, Target, WIDTHS, canvas, pixels};

/// How values stand along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// Evenly, with round marks.
    Even,
    /// Evenly, with marks at the multiples of a step.
    Steps(f64),
    /// By their logarithm; all are above 0.
    Decades,
}

/// An axis of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it is, with its unit.
    pub label: String,
    /// Where it begins.
    pub low: f64,
    /// Where it ends, above `low`.
    pub high: f64,
    /// How values stand along it.
    pub spacing: Spacing,
}

/// How a curve looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// What counts: wide, without gaps.
    New,
    /// What it was before: grey, dashed.
    Old,
    /// What it is compared with: thin, above the others.
    Other,
    /// What is asked for: thin, dotted.
    Asked,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// In the legend; empty for none.
    pub name: String,
    /// How it looks.
    pub look: Look,
    /// In the units of the axes; NaN is a gap.
    pub points: Vec<(f64, f64)>,
}

/// A line with a text beside it: what is measured between two points, or what stands at one.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// One end.
    pub from: (f64, f64),
    /// The other one, with a dot.
    pub to: (f64, f64),
    /// Beside it.
    pub text: String,
}

/// A panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// To the right.
    pub across: Axis,
    /// Upwards.
    pub up: Axis,
    /// The first one below the others.
    pub curves: Vec<Curve>,
    /// Above the curves.
    pub pins: Vec<Pin>,
    /// A level line at that value.
    pub level: Option<f64>,
    /// Below the legend.
    pub lines: Vec<String>,
    /// Of its frame (px).
    pub height: f64,
    /// The next panel has the same axis to the right, and its label.
    pub is_joined: bool,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// One line on top.
    pub title: String,
    /// From above.
    pub sheets: Vec<Sheet>,
    /// (px), see [`WIDTHS`]
    pub width: u32,
}

/// Left of a panel: its label and those of its marks (px).
const LEFT: f64 = 78.0;
/// Right of a panel: its legend (px).
const RIGHT: f64 = 232.0;
const TITLE_HEIGHT: f64 = 34.0;
/// Below a panel: its axis, or a gap where the next one has it (px).
const AXIS: f64 = 52.0;
const JOINED: f64 = 12.0;
/// A mark for each (px): upwards, to the right, and between two labels of a logarithmic axis.
const MARKS: (f64, f64, f64) = (26.0, 80.0, 34.0);
/// Swatch of a legend (px).
const SWATCH: f64 = 44.0;
/// Free around the text of a pin (px).
const AIR: f64 = 3.0;
const DOT: f64 = 3.0;

impl Look {
    fn stroke(self) -> Stroke {
        let (colour, width, dash): (_, _, &[f64]) = match self {
            Self::New => (Colour(0, 114, 178), 2.2, &[]),
            Self::Old => (Colour(130, 130, 130), 1.6, &[7.0, 4.0]),
            Self::Other => (Colour(213, 94, 0), 1.2, &[]),
            Self::Asked => (INK, 1.0, &[2.0, 3.0]),
        };
        Stroke { colour, width, dash }
    }
}

impl Axis {
    /// Part of the way from its beginning to its end.
    fn part(&self, value: f64) -> f64 {
        match self.spacing {
            Spacing::Decades => libm::log(value / self.low) / libm::log(self.high / self.low),
            Spacing::Even | Spacing::Steps(_) => (value - self.low) / (self.high - self.low),
        }
    }

    fn ticks(&self, length: f64, per_mark: f64) -> Ticks {
        match self.spacing {
            Spacing::Even => ticks(self.low, self.high, length / per_mark, false),
            Spacing::Steps(step) => multiples(self.low, self.high, step),
            Spacing::Decades => decades(self.low, self.high, MARKS.2 * libm::log10(self.high / self.low) / length),
        }
    }
}

/// A rectangle: left, upper, right, lower edge (px).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Room {
    left: f64,
    top: f64,
    right: f64,
    end: f64,
}

impl Room {
    fn meets(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.end && other.top < self.end
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left && other.right <= self.right && self.top <= other.top && other.end <= self.end
    }
}

/// A panel with its place.
struct Placed<'a> {
    sheet: &'a Sheet,
    room: Room,
}

/// Draws a chart and returns the content of its file.
///
/// # Errors
/// [`Problem::Width`], [`Problem::High`], [`Problem::Pixels`], [`Problem::Drawing`]
pub fn draw_chart(chart: &Chart, target: Target) -> Result<Vec<u8>, Problem> {
    if !(WIDTHS.0..=WIDTHS.1).contains(&chart.width) {
        return Err(Problem::Width { given: chart.width });
    }
    let font = Font::new();
    let (placed, end) = place(chart);
    let height = end.ceil() as u32;
    if height > HEIGHTS.1 {
        return Err(Problem::High { panels: format!("{} panels", chart.sheets.len()), needed: height });
    }
    let size = (chart.width, height);
    match target {
        Target::Svg => canvas::svg(size, |canvas| paint(chart, &placed, size, &font, canvas)).map(String::into_bytes),
        Target::Png => pixels::png(size, &font, |canvas| paint(chart, &placed, size, &font, canvas)),
    }
}

fn place(chart: &Chart) -> (Vec<Placed<'_>>, f64) {
    let mut top = MARGIN + if chart.title.is_empty() { 0.0 } else { TITLE_HEIGHT };
    let mut placed = Vec::new();
    for sheet in &chart.sheets {
        let end = top + sheet.height.max(legend_height(sheet));
        let room = Room { left: LEFT, top, right: f64::from(chart.width) - RIGHT, end };
        placed.push(Placed { sheet, room });
        top = end + if sheet.is_joined { JOINED } else { AXIS };
    }
    (placed, top)
}

fn legend_height(sheet: &Sheet) -> f64 {
    let entries = sheet.curves.iter().filter(|curve| !curve.name.is_empty()).count();
    entries as f64 * LEGEND_HEIGHT + sheet.lines.len() as f64 * NOTE_HEIGHT + 2.0 * AIR
}

fn paint(chart: &Chart, placed: &[Placed<'_>], size: (u32, u32), font: &Font, canvas: &mut dyn Canvas) {
    let (width, height) = (f64::from(size.0), f64::from(size.1));
    canvas.fill(point(0.0, 0.0), point(width, height), PAPER);
    if !chart.title.is_empty() {
        let title = font.shorten(&clean(&chart.title), TITLE, width - 2.0 * MARGIN);
        canvas.text(&title, point(MARGIN, MARGIN + TITLE / 2.0), Letters::new(TITLE, INK, Anchor::Start));
    }
    for panel in placed {
        panel.paint(font, canvas);
    }
}

/// The middle of the nearest pixel: lines along it are sharp.
fn sharp(place: f64) -> f64 {
    place.floor() + 0.5
}

impl Placed<'_> {
    fn x(&self, value: f64) -> f64 {
        self.room.left + self.sheet.across.part(value) * (self.room.right - self.room.left)
    }

    fn y(&self, value: f64) -> f64 {
        self.room.end - self.sheet.up.part(value) * (self.room.end - self.room.top)
    }

    fn at(&self, place: (f64, f64)) -> Point {
        point(self.x(place.0), self.y(place.1))
    }

    fn paint(&self, font: &Font, canvas: &mut dyn Canvas) {
        let Room { left, top, right, end } = self.room;
        let across = self.sheet.across.ticks(right - left, MARKS.1);
        let up = self.sheet.up.ticks(end - top, MARKS.0);
        for &value in &across.values {
            line(canvas, point(sharp(self.x(value)), top), point(sharp(self.x(value)), end), GRID);
        }
        for &value in &up.values {
            line(canvas, point(left, sharp(self.y(value))), point(right, sharp(self.y(value))), GRID);
        }
        if let Some(level) = self.sheet.level {
            line(canvas, point(left, sharp(self.y(level))), point(right, sharp(self.y(level))), FRAME);
        }
        for curve in &self.sheet.curves {
            self.curve(curve, canvas);
        }
        let corners = [(left, top), (right, top), (right, end), (left, end), (left, top)];
        canvas.stroke(&corners.map(|(x, y)| point(sharp(x), sharp(y))), Stroke::line(FRAME, 1.0));
        self.axes(&across, &up, font, canvas);
        self.pins(font, canvas);
        self.legend(font, canvas);
    }

    /// A curve, cut where it leaves the panel.
    fn curve(&self, curve: &Curve, canvas: &mut dyn Canvas) {
        let (across, up) = (&self.sheet.across, &self.sheet.up);
        let inside = curve.points.iter().filter(|(x, _)| (across.low..=across.high).contains(x));
        let cut = cut(inside.copied(), up.low, up.high);
        let width = self.room.right - self.room.left;
        for part in reduced(cut.into_iter().map(|(x, y)| (across.part(x) * width, y))) {
            let points: Vec<Point> = part.iter().map(|&(x, y)| point(self.room.left + x, self.y(y))).collect();
            canvas.stroke(&points, curve.look.stroke());
        }
    }

    fn axes(&self, across: &Ticks, up: &Ticks, font: &Font, canvas: &mut dyn Canvas) {
        let Room { left, top, right, end } = self.room;
        for (&value, label) in up.values.iter().zip(&up.labels) {
            line(canvas, point(left - 4.0, sharp(self.y(value))), point(left, sharp(self.y(value))), FRAME);
            canvas.text(label, point(left - 7.0, self.y(value)), Letters::new(TICK, INK, Anchor::End));
        }
        let letters = Letters { upright: true, ..Letters::new(LABEL, INK, Anchor::Middle) };
        let label = font.shorten(&clean(&self.sheet.up.label), LABEL, end - top + 2.0 * MARGIN);
        canvas.text(&label, point(MARGIN + 4.0, (top + end) / 2.0), letters);
        if self.sheet.is_joined {
            return;
        }
        for (&value, label) in across.values.iter().zip(&across.labels) {
            line(canvas, point(sharp(self.x(value)), end), point(sharp(self.x(value)), end + 4.0), FRAME);
            canvas.text(label, point(self.x(value), end + 14.0), Letters::new(TICK, INK, Anchor::Middle));
        }
        let label = clean(&self.sheet.across.label);
        canvas.text(&label, point((left + right) / 2.0, end + 32.0), Letters::new(LABEL, INK, Anchor::Middle));
    }

    fn pins(&self, font: &Font, canvas: &mut dyn Canvas) {
        let mut taken: Vec<Room> = Vec::new();
        for pin in &self.sheet.pins {
            let (from, to) = (self.at(pin.from), self.at(pin.to));
            canvas.stroke(&[from, to], Stroke::line(INK, 1.2));
            canvas.fill(point(to.x - DOT, to.y - DOT), point(to.x + DOT, to.y + DOT), INK);
            taken.push(Room { left: to.x - DOT, top: to.y - DOT, right: to.x + DOT, end: to.y + DOT });
        }
        for pin in &self.sheet.pins {
            let room = self.beside(self.at(pin.from), self.at(pin.to), font.width(&pin.text, SMALL), &taken);
            let Some(room) = room else { continue };
            canvas.fill(point(room.left, room.top), point(room.right, room.end), PAPER);
            let at = point(room.left + AIR, (room.top + room.end) / 2.0);
            canvas.text(&pin.text, at, Letters::new(SMALL, INK, Anchor::Start));
            taken.push(room);
        }
    }

    /// Where a text of that width has room beside a line: at its middle, else at its ends. Curves fall: what reaches up to one has room
    /// to the left, what reaches down to it to the right, and what stands on it above to the right.
    fn beside(&self, from: Point, to: Point, width: f64, taken: &[Room]) -> Option<Room> {
        let (width, height) = (width + 2.0 * AIR, SMALL + 2.0 * AIR);
        let gap = 2.0 * DOT;
        let middle = point((from.x + to.x) / 2.0, (from.y + to.y) / 2.0);
        let ends = [to.y - height, to.y + height, from.y - height, from.y + height];
        let heights = (from != to).then_some(middle.y).into_iter().chain(ends);
        let (right, left) = (middle.x + gap, middle.x - gap - width);
        let sides = if to.y < from.y { [left, right] } else { [right, left] };
        let places = heights.flat_map(|y| sides.map(|x| (x, y)));
        let mut rooms =
            places.map(|(left, y)| Room { left, top: y - height / 2.0, right: left + width, end: y + height / 2.0 });
        rooms.find(|room| self.room.holds(room) && !taken.iter().any(|other| other.meets(room)))
    }

    fn legend(&self, font: &Font, canvas: &mut dyn Canvas) {
        let left = self.room.right + 12.0;
        let mut y = self.room.top + AIR + LEGEND_HEIGHT / 2.0;
        let most = RIGHT - 12.0 - MARGIN / 2.0;
        for curve in self.sheet.curves.iter().filter(|curve| !curve.name.is_empty()) {
            canvas.stroke(&[point(left, y), point(left + SWATCH - 10.0, y)], curve.look.stroke());
            let name = font.shorten(&clean(&curve.name), LABEL, most - SWATCH);
            canvas.text(&name, point(left + SWATCH, y), Letters::new(LABEL, INK, Anchor::Start));
            y += LEGEND_HEIGHT;
        }
        for text in &self.sheet.lines {
            let text = font.shorten(&clean(text), SMALL, most);
            canvas.text(&text, point(left, y), Letters::new(SMALL, PALE_INK, Anchor::Start));
            y += NOTE_HEIGHT;
        }
    }
}

fn line(canvas: &mut dyn Canvas, from: Point, to: Point, colour: Colour) {
    canvas.stroke(&[from, to], Stroke::line(colour, 1.0));
}

/// A line with gaps where it lies beyond `low` and `high`: it goes as far as these.
fn cut(points: impl Iterator<Item = (f64, f64)>, low: f64, high: f64) -> Vec<(f64, f64)> {
    let mut cut: Vec<(f64, f64)> = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    let is_inside = |y: f64| (low..=high).contains(&y);
    for (x, y) in points {
        if let Some((x0, y0)) = before.filter(|(_, y0)| y0.is_finite() && y.is_finite()) {
            let at = |edge: f64| (x0 + (edge - y0) / (y - y0) * (x - x0), edge);
            let crossed = |edge: f64| (y0 < edge && edge < y) || (y < edge && edge < y0);
            let mut edges: Vec<(f64, f64)> = [low, high].into_iter().filter(|edge| crossed(*edge)).map(at).collect();
            if y < y0 {
                edges.reverse();
            }
            cut.extend(edges);
        }
        if is_inside(y) {
            cut.push((x, y));
        } else if before.is_none_or(|(_, y0)| is_inside(y0)) || !y.is_finite() {
            cut.push((x, f64::NAN));
        } else if cut.last().is_some_and(|(_, last)| last.is_finite()) {
            // It has crossed the whole panel between two points.
            cut.push((x, f64::NAN));
        }
        before = Some((x, y));
    }
    cut
}

#[cfg(test)]
mod tests;

//! Draws the figure: read objects on the left, slots in their order in the middle, written objects on the right.
//!
//! All links are in the two gaps between the columns, so that none crosses a box.

use super::links::{Port, mirrors, ports};
use super::svg::{Svg, width};
use lineshaft_core::config::{IoKind, MachineConfig};
use lineshaft_core::object::Object;
use std::collections::BTreeMap;

const MARGIN: f64 = 24.0;
/// Distance between two columns.
const GAP: f64 = 150.0;
/// Distance between two boxes of a column.
const SPACE: f64 = 16.0;
/// Height of a line of text in a box.
const ROW: f64 = 20.0;
/// Distance from the top of a line to its baseline.
const FOOT: f64 = 14.0;
/// Margin left and right of the text in a box.
const PAD: f64 = 10.0;
/// Minimum extent of links from a column to itself, and increment for each further one.
const BULGE: f64 = 36.0;
const STEP: f64 = 11.0;
const COLOURS: [(&str, &str); 5] = [
    ("function", "#fff3bf"),
    ("axis", "#d0ebff"),
    ("encoder", "#d3f9d8"),
    ("input, output", "#ffe3e3"),
    ("memory", "#e9ecef"),
];

/// A box of the figure.
#[derive(Clone, Debug)]
struct Frame {
    object: Object,
    head: String,
    ports: Vec<Port>,
    /// A line without a link.
    note: Option<String>,
    top: f64,
}

impl Frame {
    fn height(&self) -> f64 {
        ROW * (1 + self.ports.len() + usize::from(self.note.is_some())) as f64 + 4.0
    }

    fn width(&self) -> f64 {
        let lines = self.ports.iter().map(text).chain(self.note.clone()).chain([self.head.clone()]);
        lines.map(|line| width(&line)).fold(0.0, f64::max) + 2.0 * PAD
    }

    /// Returns the height at which links end at a line; line 0 is the head.
    fn row(&self, row: usize) -> f64 {
        self.top + 2.0 + ROW * (row as f64 + 0.5)
    }
}

/// A column of boxes of the same width.
#[derive(Debug, Default)]
struct Column {
    left: f64,
    width: f64,
    frames: Vec<Frame>,
}

impl Column {
    fn new(left: f64, frames: Vec<Frame>) -> Self {
        let width = frames.iter().map(Frame::width).fold(0.0, f64::max);
        Self { left, width, frames }
    }

    fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Returns the left edge of the next column; an empty column has no width.
    fn next(&self) -> f64 {
        if self.frames.is_empty() { self.left } else { self.right() + GAP }
    }

    fn bottom(&self) -> f64 {
        self.frames.last().map_or(MARGIN, |frame| frame.top + frame.height())
    }

    fn find(&self, object: Object) -> Option<&Frame> {
        self.frames.iter().find(|frame| frame.object == object)
    }

    /// Places the boxes below each other, each as close as possible to its wanted position.
    fn place(&mut self, wishes: &BTreeMap<Object, f64>) {
        let wish = |frame: &Frame| wishes.get(&frame.object).copied().unwrap_or(f64::MAX);
        self.frames.sort_by(|a, b| wish(a).total_cmp(&wish(b)));
        let mut free = MARGIN;
        for frame in &mut self.frames {
            let height = frame.height();
            let wanted = wishes.get(&frame.object).map_or(free, |middle| middle - height / 2.0);
            frame.top = wanted.max(free);
            free = frame.top + height + SPACE;
        }
    }
}

/// Returns the figure of a cell; `None` without functions.
pub fn draw(machine: &MachineConfig, title: &str) -> Option<String> {
    if machine.slots.is_empty() {
        return None;
    }
    let slots: Vec<Frame> = (0..machine.slots.len() as u16).map(|slot| of_slot(machine, slot)).collect();
    let (read, written) = objects(machine, &slots);
    let mut left = Column::new(MARGIN, read.into_iter().map(|object| of_object(machine, object)).collect());
    let mut middle = Column::new(left.next(), slots);
    let mut right = Column::new(middle.next(), written.into_iter().map(|object| of_object(machine, object)).collect());
    let mut top = MARGIN;
    for frame in &mut middle.frames {
        frame.top = top;
        top += frame.height() + SPACE;
    }
    let wishes = wishes(&middle);
    left.place(&wishes);
    right.place(&wishes);
    Some(paint(machine, title, [&left, &middle, &right]))
}

/// Returns the objects that are only read, and those that are written.
fn objects(machine: &MachineConfig, slots: &[Frame]) -> (Vec<Object>, Vec<Object>) {
    let ports = || slots.iter().flat_map(|slot| &slot.ports);
    let mut written: Vec<Object> = ports().filter(|port| port.is_output).map(|port| port.object).collect();
    // An input that reads an output is next to it.
    let shown = mirrors(machine).filter(|(from, to)| written.contains(from) && ports().any(|port| port.object == *to));
    let shown: Vec<Object> = shown.map(|(_, to)| to).collect();
    written.extend(shown);
    written.sort_unstable();
    written.dedup();
    let mut read: Vec<Object> = ports().filter(|port| !port.is_output).map(|port| port.object).collect();
    read.retain(|object| !written.contains(object) && !matches!(object, Object::Function(_)));
    read.sort_unstable();
    read.dedup();
    (read, written)
}

/// Returns for each object the mean height of the lines that it is linked with.
fn wishes(middle: &Column) -> BTreeMap<Object, f64> {
    let mut sums: BTreeMap<Object, (f64, f64)> = BTreeMap::new();
    for frame in &middle.frames {
        for (row, port) in (1..).zip(&frame.ports) {
            let sum = sums.entry(port.object).or_default();
            *sum = (sum.0 + frame.row(row), sum.1 + 1.0);
        }
    }
    sums.into_iter().map(|(object, (sum, count))| (object, sum / count)).collect()
}

fn of_slot(machine: &MachineConfig, slot: u16) -> Frame {
    let config = machine.slots.get(usize::from(slot));
    let head = config.map_or(String::new(), |slot| format!("{} {}: {}", slot.number, slot.name, slot.kind.name()));
    let tables = config.iter().flat_map(|slot| slot.tables.iter().flatten());
    let tables: Vec<&str> = tables.map(|table| machine.name(Object::Table(*table))).collect();
    let note = (!tables.is_empty()).then(|| format!("table {}", tables.join(", ")));
    Frame { object: Object::Function(slot), head, ports: ports(machine, slot), note, top: 0.0 }
}

fn of_object(machine: &MachineConfig, object: Object) -> Frame {
    let kind = match object {
        Object::Io(place) => match machine.io.get(usize::from(place)).map(|io| io.kind) {
            Some(IoKind::DigitalInput) => "di ",
            Some(IoKind::DigitalOutput) => "do ",
            Some(IoKind::AnalogInput) => "ai ",
            Some(IoKind::AnalogOutput) => "ao ",
            None => "",
        },
        _ => "",
    };
    let head = format!("{kind}{}", machine.name(object));
    Frame { object, head, ports: Vec::new(), note: None, top: 0.0 }
}

fn text(port: &Port) -> String {
    format!("{} {}", port.label, port.name)
}

fn colour(object: Object) -> &'static str {
    let place = match object {
        Object::Function(_) => 0,
        Object::Axis(_) => 1,
        Object::Encoder(_) => 2,
        Object::Io(_) => 3,
        Object::Memory(_) | Object::Machine | Object::Table(_) | Object::Program(_) => 4,
    };
    COLOURS.get(place).map_or("#fff", |(_, colour)| colour)
}

fn paint(machine: &MachineConfig, title: &str, columns: [&Column; 3]) -> String {
    let [left, middle, right] = columns;
    let beside = if right.frames.is_empty() { BULGE + STEP * links_of_own(middle) as f64 } else { BULGE };
    let edge = middle.right().max(right.right()) + beside.min(GAP);
    let bottom = columns.map(Column::bottom).into_iter().fold(0.0, f64::max) + SPACE;
    let size = (edge.max(MARGIN + LEGEND) + MARGIN, bottom + 2.0 * ROW + MARGIN);
    let mut svg = Svg::new(title, size);
    let mut count = 0;
    for frame in &middle.frames {
        for (row, port) in (1..).zip(&frame.ports) {
            let y = frame.row(row);
            if let Some(other) = left.find(port.object) {
                svg.link((left.right(), other.row(0)), (middle.left, y), (GAP / 2.0, -GAP / 2.0), port.is_late);
            } else if let Some(other) = right.find(port.object) {
                let (here, there) = ((middle.right(), y), (right.left, other.row(0)));
                if port.is_output {
                    svg.link(here, there, (GAP / 2.0, -GAP / 2.0), false);
                } else {
                    svg.link(there, here, (-GAP / 2.0, GAP / 2.0), port.is_late);
                }
            } else if let Some(other) = middle.find(port.object) {
                count += 1;
                let bulge = (BULGE + STEP * f64::from(count)).min(GAP);
                svg.link((middle.right(), other.row(0)), (middle.right(), y), (bulge, bulge), port.is_late);
            }
        }
    }
    for (from, to) in mirrors(machine) {
        if let (Some(from), Some(to)) = (right.find(from), right.find(to)) {
            svg.link((right.right(), from.row(0)), (right.right(), to.row(0)), (BULGE, BULGE), true);
        }
    }
    for column in columns {
        column.frames.iter().for_each(|frame| paint_frame(&mut svg, column, frame));
    }
    legend(&mut svg, bottom);
    svg.finish()
}

/// Returns the number of links between slots.
fn links_of_own(middle: &Column) -> usize {
    let ports = middle.frames.iter().flat_map(|frame| &frame.ports);
    ports.filter(|port| matches!(port.object, Object::Function(_))).count()
}

fn paint_frame(svg: &mut Svg, column: &Column, frame: &Frame) {
    let (x, right) = (column.left + PAD, column.right() - PAD);
    svg.frame((column.left, frame.top), (column.width, frame.height()), colour(frame.object));
    let foot = |row: usize| frame.top + 2.0 + ROW * row as f64 + FOOT;
    svg.text((x, foot(0)), &frame.head, "start", true);
    if !frame.ports.is_empty() {
        let y = frame.top + 1.0 + ROW;
        svg.line((column.left, y), (column.right(), y));
    }
    for (row, port) in (1..).zip(&frame.ports) {
        let (x, anchor) = if port.is_output { (right, "end") } else { (x, "start") };
        svg.text((x, foot(row)), &text(port), anchor, false);
    }
    if let Some(note) = &frame.note {
        svg.text((x, foot(frame.ports.len() + 1)), note, "start", false);
    }
}

/// Width of the legend.
const LEGEND: f64 = 600.0;

fn legend(svg: &mut Svg, top: f64) {
    let y = top + ROW / 2.0;
    let mut x = MARGIN;
    for (what, is_dashed) in [("this cycle's value", false), ("the last cycle's value", true)] {
        svg.link((x, y), (x + 44.0, y), (14.0, -14.0), is_dashed);
        svg.text((x + 52.0, y + 4.0), what, "start", false);
        x += 52.0 + width(what) + 24.0;
    }
    let (mut x, y) = (MARGIN, y + ROW + 4.0);
    for (what, colour) in COLOURS {
        svg.frame((x, y - 7.0), (18.0, 14.0), colour);
        svg.text((x + 24.0, y + 4.0), what, "start", false);
        x += 24.0 + width(what) + 20.0;
    }
}

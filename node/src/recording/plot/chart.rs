//! Charts: panels below each other, drawn with plotters, each with its legend above it.
//!
//! Law      a curve ends at the edge of its panel; panels, legends and texts are rows of the drawing area, from top to
//!          bottom
//! Reads    points, in the order in which they are connected
//! Refuses  a width outside of its range ([`Problem::Width`]), a height above the maximum of a figure
//!          ([`Problem::High`])

use super::axis::{Axis, Plotted, Spacing};
use super::curve::reduced;
use super::events::{Events, Listed, spread};
use super::lane::{Content, LaneRange};
use super::pen::{
    BIT, Drawn, Entry, EntryMark, FRAME, INK, LABEL, LineStyle, MARGIN, PALE_INK, Pen, Plot, SMALL, SWATCH, TAG,
    severity_colour,
};
use super::text::{clean, shorten, use_bundled_font, width, wrap};
use super::{HEIGHTS, Problem, Target, WIDTHS, pixels};
use plotters::drawing::IntoDrawingArea;
use plotters::element::{PathElement, Rectangle};
use plotters::prelude::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor, WHITE};

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend; empty for no entry.
    pub name: String,
    /// Line style.
    pub look: LineStyle,
    /// Points in the units of the axes; NaN is a gap.
    pub points: Vec<(f64, f64)>,
}

/// A line with a text next to it: a value measured between two points, or at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureMark {
    /// Start point.
    pub from: (f64, f64),
    /// End point, drawn with a dot.
    pub to: (f64, f64),
    /// Text next to the line.
    pub text: String,
}

/// A panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Horizontal axis.
    pub across: Axis,
    /// Vertical axis.
    pub up: Axis,
    /// Curves; the first one is drawn below the others.
    pub curves: Vec<Curve>,
    /// Measured values, drawn above the curves.
    pub pins: Vec<MeasureMark>,
    /// Value of a horizontal line.
    pub level: Option<f64>,
    /// Text below the legend.
    pub lines: Vec<String>,
    /// Height of the plot, in px.
    pub height: f64,
    /// Whether the next panel has the same horizontal axis, with the label below it.
    pub is_joined: bool,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title at the top; empty for none.
    pub title: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Width, in px; see [`WIDTHS`].
    pub width: u32,
}

/// A lane of the timing diagram.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lane {
    pub(super) name: String,
    pub(super) is_bit: bool,
    /// States with text and colour; their coordinates are columns of the figure.
    pub(super) states: Vec<(LaneRange, String, RGBColor)>,
}

/// All rows of a figure.
#[derive(Clone, Debug)]
pub(super) struct Page<'a> {
    pub(super) chart: &'a Chart,
    /// Lanes below the panels, on the axis of the last panel.
    pub(super) lanes: &'a [Lane],
    /// Horizontal axis of the lanes.
    pub(super) across: &'a Axis,
    pub(super) events: &'a Events,
    /// Lines of text at the bottom.
    pub(super) notes: &'a [String],
}

/// Font size of the title, in px.
const TITLE: f64 = 16.0;
/// Space left of a plot for the labels of its axis and ticks, in px. Names of lanes may need more, up to a fraction of
/// the width.
const LEFT: f64 = 84.0;
const NAME_PART: f64 = 0.24;
/// Space right of a plot for half of the label of its last tick, in px.
const RIGHT: f64 = 30.0;
/// Margin left of the label of an axis, in px.
const EDGE: f64 = 10.0;
/// Heights of rows, in px.
const TITLE_ROW: f64 = 25.0;
const ROW: f64 = 17.0;
const TAGS: f64 = 26.0;
const GAP: f64 = 14.0;
const AXIS: f64 = 42.0;
const LANE: f64 = 26.0;
/// Minimum distance of ticks, horizontal and vertical, in px.
const TICKS: (f64, f64) = (85.0, 28.0);

/// Draws a chart and returns the content of its file.
///
/// # Errors
/// [`Problem::Width`], [`Problem::High`], [`Problem::Pixels`], [`Problem::Drawing`]
pub fn draw_chart(chart: &Chart, target: Target) -> Result<Vec<u8>, Problem> {
    check_width(chart.width)?;
    let across = Axis { label: String::new(), low: 0.0, high: 1.0, spacing: Spacing::Even };
    let page = Page { chart, lanes: &[], across: &across, events: &Events::default(), notes: &[] };
    page.draw(target)
}

/// # Errors
/// [`Problem::Width`]
pub(super) fn check_width(given: u32) -> Result<(), Problem> {
    if (WIDTHS.0..=WIDTHS.1).contains(&given) { Ok(()) } else { Err(Problem::Width { given }) }
}

/// Factor by which an SVG is drawn larger than shown, because plotters uses whole pixels.
const SVG_FACTOR: u32 = 10;

impl Page<'_> {
    /// # Errors
    /// [`Problem::High`], [`Problem::Pixels`], [`Problem::Drawing`]
    pub(super) fn draw(&self, target: Target) -> Result<Vec<u8>, Problem> {
        use_bundled_font();
        let height = self.height().ceil() as u32;
        if height > HEIGHTS.1 {
            return Err(Problem::High { panels: self.contents(), needed: height });
        }
        let size = (self.chart.width, height);
        match target {
            Target::Svg => {
                let mut text = String::new();
                let large = (size.0 * SVG_FACTOR, size.1 * SVG_FACTOR);
                self.paint(SVGBackend::with_string(&mut text, large), SVG_FACTOR)?;
                let attributes = |(width, height): (u32, u32)| format!(r#"width="{width}" height="{height}""#);
                Ok(text.replacen(&attributes(large), &attributes(size), 1).into_bytes())
            }
            Target::Png => {
                let factor = pixels::factor(size)?;
                pixels::png(size, factor, |backend| self.paint(backend, factor))
            }
        }
    }

    /// Returns the number of panels and lanes as text.
    pub(super) fn contents(&self) -> String {
        let count = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
        format!("{} and {}", count(self.chart.panels.len(), "panel"), count(self.lanes.len(), "lane"))
    }

    fn paint<DB: DrawingBackend>(&self, backend: DB, factor: u32) -> Result<(), Problem> {
        let pen = Pen { area: backend.into_drawing_area(), factor: f64::from(factor) };
        let drawn = self.rows(&pen).and_then(|()| pen.area.present());
        drawn.map_err(|error| Problem::Drawing { reason: error.to_string() })
    }

    fn full_width(&self) -> f64 {
        f64::from(self.chart.width)
    }

    fn title(&self) -> Vec<String> {
        let title = clean(&self.chart.title);
        if title.is_empty() { Vec::new() } else { wrap(&title, TITLE, self.full_width() - 2.0 * MARGIN, 2) }
    }

    /// Returns the width left of the plots, in px.
    fn left(&self) -> f64 {
        let names = self.lanes.iter().map(|lane| width(&lane.name, LABEL) + MARGIN + 10.0).fold(LEFT, f64::max);
        names.min((NAME_PART * self.full_width()).max(LEFT))
    }

    /// Returns the width of the plots, in px.
    pub(super) fn plot_width(&self) -> f64 {
        self.full_width() - self.left() - RIGHT
    }

    /// Returns the height of all rows except the plots, in px.
    pub(super) fn height_around(&self) -> f64 {
        self.height() - self.chart.panels.iter().map(|panel| panel.height).sum::<f64>()
    }

    fn height(&self) -> f64 {
        let mut height = 2.0 * MARGIN + self.title().len() as f64 * TITLE_ROW;
        height += if self.events.listed.is_empty() { 0.0 } else { TAGS };
        for panel in &self.chart.panels {
            height += self.legend(panel).len() as f64 * ROW + panel.height + self.below(panel);
        }
        if !self.lanes.is_empty() {
            height += self.state_legend().len() as f64 * ROW + self.lanes.len() as f64 * LANE + AXIS;
        }
        height + (self.event_rows().len() + self.notes.len()) as f64 * ROW
    }

    /// Returns the height below a plot, for its axis or a gap, in px.
    fn below(&self, panel: &Panel) -> f64 {
        if panel.is_joined { GAP } else { AXIS }
    }

    /// Returns the rows of the legend; an entry is a line with a text, or a text alone.
    fn legend(&self, panel: &Panel) -> Vec<Vec<Entry>> {
        let named = panel.curves.iter().filter(|curve| !curve.name.is_empty());
        let entry = |curve: &Curve| Entry { mark: EntryMark::Line(curve.look.line()), text: clean(&curve.name) };
        let mut rows = self.entry_rows(named.map(entry).collect());
        let line = |text: &String| Entry { mark: EntryMark::None, text: clean(text) };
        rows.extend(self.entry_rows(panel.lines.iter().map(line).collect()));
        rows
    }

    /// Returns the legend of states that are too narrow for their name in every lane.
    fn state_legend(&self) -> Vec<Vec<Entry>> {
        let per_column = self.plot_width() / self.full_width();
        let states = || self.lanes.iter().filter(|lane| !lane.is_bit).flat_map(|lane| &lane.states);
        let has_room = |(stay, text, _): &&(LaneRange, String, RGBColor)| is_written(stay, text, per_column);
        let written: Vec<_> = states().filter(has_room).map(|(_, text, colour)| (text, colour)).collect();
        let mut entries: Vec<Entry> = Vec::new();
        let all = self.lanes.iter().flat_map(|lane| &lane.states);
        // A narrow range of many values looks like the edge of a state.
        let is_seen = |stay: &LaneRange| (stay.to - stay.from) * per_column >= 6.0;
        for (stay, text, colour) in states().chain(all.filter(|(stay, ..)| stay.content == Content::Busy)) {
            let text = match stay.content {
                Content::Busy if !is_seen(stay) => continue,
                Content::Busy => "changes too fast to show".to_owned(),
                Content::Value(_) if written.contains(&(text, colour)) => continue,
                Content::Value(_) => text.clone(),
            };
            let entry = Entry { mark: EntryMark::Box(*colour), text };
            if !entries.contains(&entry) {
                entries.push(entry);
            }
        }
        self.entry_rows(entries)
    }

    fn entry_rows(&self, entries: Vec<Entry>) -> Vec<Vec<Entry>> {
        let room = self.plot_width();
        let (mut rows, mut used): (Vec<Vec<Entry>>, f64) = (Vec::new(), f64::INFINITY);
        for mut entry in entries {
            entry.text = shorten(&entry.text, LABEL, room - SWATCH - 8.0);
            if used + entry.width() > room {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += entry.width();
            rows.last_mut().into_iter().for_each(|row| row.push(entry.clone()));
        }
        rows
    }

    /// Returns the rows of the list of events: the event in its first row, and a part of its text.
    fn event_rows(&self) -> Vec<(Option<&Listed>, String)> {
        let room = self.full_width() - 2.0 * MARGIN - TAG - 10.0;
        let text = |event: &Listed| {
            let text = format!("{:.3} s  {}: {}", event.time, event.source, event.text);
            wrap(&text, SMALL, room, 3)
        };
        let rows =
            |event| text(event).into_iter().enumerate().map(move |(row, text)| ((row == 0).then_some(event), text));
        self.events.listed.iter().flat_map(rows).collect()
    }

    fn rows<DB: DrawingBackend>(&self, pen: &Pen<DB>) -> Drawn<DB> {
        pen.area.fill(&WHITE)?;
        let (left, mut y) = (self.left(), MARGIN);
        for line in self.title() {
            pen.text(&line, (MARGIN, y + TITLE_ROW / 2.0), TITLE, INK, HPos::Left)?;
            y += TITLE_ROW;
        }
        let tags = if self.events.listed.is_empty() { 0.0 } else { TAGS };
        let mut is_first = true;
        for panel in &self.chart.panels {
            for row in self.legend(panel) {
                pen.entries(&row, (left, y + ROW / 2.0))?;
                y += ROW;
            }
            if std::mem::take(&mut is_first) {
                self.tags(pen, left, y)?;
                y += tags;
            }
            self.panel(pen, panel, left, y)?;
            y += panel.height + self.below(panel);
        }
        if !self.lanes.is_empty() {
            for row in self.state_legend() {
                pen.entries(&row, (left, y + ROW / 2.0))?;
                y += ROW;
            }
            if is_first {
                self.tags(pen, left, y)?;
                y += tags;
            }
            self.paint_lanes(pen, left, y)?;
            y += self.lanes.len() as f64 * LANE + AXIS;
        }
        for (event, text) in self.event_rows() {
            if let Some(event) = event {
                pen.tag(event, (MARGIN + TAG / 2.0, y + ROW / 2.0))?;
            }
            pen.text(&text, (MARGIN + TAG + 8.0, y + ROW / 2.0), SMALL, INK, HPos::Left)?;
            y += ROW;
        }
        for note in self.notes {
            pen.text(note, (MARGIN, y + ROW / 2.0), SMALL, PALE_INK, HPos::Left)?;
            y += ROW;
        }
        Ok(())
    }

    fn panel<DB: DrawingBackend>(&self, pen: &Pen<DB>, panel: &Panel, left: f64, top: f64) -> Drawn<DB> {
        let across = Plotted::new(&panel.across, self.plot_width() / TICKS.0);
        let up = Plotted::new(&panel.up, (panel.height / TICKS.1).clamp(2.0, 9.0));
        let below = if panel.is_joined { 0.0 } else { AXIS };
        let area = pen.part((EDGE, top), (self.full_width() - RIGHT, top + panel.height + below));
        let mut chart = pen.chart(&area, (&across, &up), (left - EDGE, below))?;
        pen.mesh(&mut chart, (&across, &up), panel.height, !panel.is_joined)?;
        let level = panel.level.map(|level| vec![(across.low, up.place(level)), (across.high, up.place(level))]);
        chart.draw_series(level.map(|level| PathElement::new(level, pen.style(FRAME, 1.0))))?;
        self.event_lines(pen, &mut chart, &across, (up.low, up.high))?;
        for curve in &panel.curves {
            let columns = self.plot_width() / (across.high - across.low);
            let inside = clip(&curve.points, &panel.across, &panel.up);
            let points = reduced(&inside, |x| (across.place(x) - across.low) * columns);
            let points: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (across.place(x), up.place(y))).collect();
            for part in points.split(|point| point.1.is_nan()).filter(|part| !part.is_empty()) {
                pen.curve(&mut chart, part, curve.look.line(), (columns, panel.height / (up.high - up.low)))?;
            }
        }
        for pin in &panel.pins {
            let [from, to] = [pin.from, pin.to].map(|(x, y)| (across.place(x), up.place(y)));
            chart.draw_series([PathElement::new(vec![from, to], pen.style(INK, 1.0))])?;
            let (x, y) = pen.place(&chart, to);
            pen.fill((x - 3.0, y - 3.0), (x + 3.0, y + 3.0), INK)?;
            let middle = if pin.from == pin.to { y - 11.0 } else { f64::midpoint(pen.place(&chart, from).1, y) };
            let is_right = x + 10.0 + width(&pin.text, SMALL) < left + self.plot_width();
            let (x, side) = if is_right { (x + 7.0, HPos::Left) } else { (x - 7.0, HPos::Right) };
            pen.text(&pin.text, (x, middle), SMALL, INK, side)?;
        }
        Ok(())
    }

    fn paint_lanes<DB: DrawingBackend>(&self, pen: &Pen<DB>, left: f64, top: f64) -> Drawn<DB> {
        let across = Plotted::new(self.across, self.plot_width() / TICKS.0);
        let count = self.lanes.len() as f64;
        let ticks = (0..self.lanes.len()).map(|place| count - place as f64 - 0.5).collect();
        let tick_labels = self.lanes.iter().map(|lane| shorten(&lane.name, LABEL, left - MARGIN)).collect();
        let (base, minor, label) = (0.0, Vec::new(), String::new());
        let up = Plotted { low: 0.0, high: count, base, is_log: false, ticks, tick_labels, minor, label };
        let height = count * LANE;
        let area = pen.part((EDGE, top), (self.full_width() - RIGHT, top + height + AXIS));
        let mut chart = pen.chart(&area, (&across, &up), (left - EDGE, AXIS))?;
        pen.mesh(&mut chart, (&across, &up), height, true)?;
        let per_column = (across.high - across.low) / self.full_width();
        for (place, lane) in self.lanes.iter().enumerate() {
            let (low, high) = (count - place as f64 - 0.84, count - place as f64 - 0.16);
            let mut edge: Vec<(f64, f64)> = Vec::new();
            for (stay, text, colour) in &lane.states {
                let (from, to) = (across.low + stay.from * per_column, across.low + stay.to * per_column);
                let is_low = lane.is_bit && stay.content == Content::Value(0);
                if !is_low {
                    chart.draw_series([Rectangle::new([(from, high), (to, low)], colour.filled())])?;
                }
                if lane.is_bit {
                    let y = if is_low { low } else { high };
                    edge.extend([(from, y), (to, y)]);
                } else if stay.content != Content::Busy {
                    chart.draw_series([Rectangle::new([(from, high), (to, low)], pen.style(FRAME, 0.6))])?;
                    if is_written(stay, text, self.plot_width() / self.full_width()) {
                        let at = pen.place(&chart, (f64::midpoint(from, to), f64::midpoint(low, high)));
                        pen.text(text, at, SMALL, INK, HPos::Center)?;
                    }
                }
            }
            if !edge.is_empty() {
                chart.draw_series([PathElement::new(edge, pen.style(BIT, 1.3))])?;
            }
        }
        self.event_lines(pen, &mut chart, &across, (0.0, count))
    }

    /// Draws events as vertical lines. Expected events without a number are left out, because a hundred lines would
    /// hide the curves.
    fn event_lines<DB: DrawingBackend>(
        &self,
        pen: &Pen<DB>,
        chart: &mut Plot<'_, DB>,
        across: &Plotted,
        (low, high): (f64, f64),
    ) -> Drawn<DB> {
        let mut lines: Vec<(u8, f64, f64)> =
            self.events.plain.iter().filter(|event| event.1 > 0).map(|event| (event.1, event.0, 0.4)).collect();
        lines.sort_by(|a, b| a.1.total_cmp(&b.1));
        lines.dedup_by_key(|line| {
            let part = (across.place(line.1) - across.low) / (across.high - across.low);
            (part * self.plot_width()).round() as i64
        });
        lines.extend(self.events.listed.iter().map(|event| (event.severity, event.time, 0.8)));
        lines.sort_by_key(|line| line.0);
        let element = |&(severity, time, width): &(u8, f64, f64)| {
            let x = across.place(time);
            PathElement::new(vec![(x, low), (x, high)], pen.style(severity_colour(severity), width))
        };
        chart.draw_series(lines.iter().map(element)).map(drop)
    }

    /// Draws the numbers of events above the first plot.
    fn tags<DB: DrawingBackend>(&self, pen: &Pen<DB>, left: f64, top: f64) -> Drawn<DB> {
        let across = self.chart.panels.first().map_or(self.across, |panel| &panel.across);
        let per_unit = self.plot_width() / (across.high - across.low);
        let wanted: Vec<f64> =
            self.events.listed.iter().map(|event| left + (event.time - across.low) * per_unit).collect();
        let places = spread(&wanted, TAG + 3.0, left - TAG, left + self.plot_width() + TAG / 2.0);
        for ((event, wanted), place) in self.events.listed.iter().zip(wanted).zip(places) {
            let style = pen.style(severity_colour(event.severity), 0.8);
            let foot = [(place, top + TAG), (wanted, top + TAGS)].map(|at| pen.px(at)).to_vec();
            pen.area.draw(&PathElement::new(foot, style))?;
            pen.tag(event, (place, top + TAG / 2.0))?;
        }
        Ok(())
    }
}

/// Whether a state has room for its name; `per_column` is in px.
fn is_written(stay: &LaneRange, text: &str, per_column: f64) -> bool {
    stay.content != Content::Busy && width(text, SMALL) + 6.0 <= (stay.to - stay.from) * per_column
}

/// Returns the points within the axes, with NaN where the curve leaves them and a point where it crosses their edge.
fn clip(points: &[(f64, f64)], across: &Axis, up: &Axis) -> Vec<(f64, f64)> {
    let mut clipped: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    let mut before: Option<(f64, f64)> = None;
    for &(x, y) in points.iter().filter(|point| (across.low..=across.high).contains(&point.0)) {
        if let Some((x0, y0)) = before.filter(|(_, y0)| y0.is_finite() && y.is_finite()) {
            let edges = if y0 < y { [up.low, up.high] } else { [up.high, up.low] };
            let is_crossed = |edge: &f64| (y0 < *edge && *edge < y) || (y < *edge && *edge < y0);
            clipped.extend(
                edges.into_iter().filter(is_crossed).map(|edge| (x0 + (edge - y0) / (y - y0) * (x - x0), edge)),
            );
        }
        let is_inside = (up.low..=up.high).contains(&y);
        clipped.push((x, if is_inside { y } else { f64::NAN }));
        before = Some((x, y));
    }
    clipped
}

#[cfg(test)]
mod tests;

//! Draws lines, texts, legends and plots on a drawing area of plotters, in px of the figure.

use super::axis::Plotted;
use super::events::Listed;
use super::text::{clean, font, shorten, width};
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{DashedPathElement, PathElement, Rectangle};
use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, RGBColor, ShapeStyle, TRANSPARENT, TextStyle, WHITE};

/// Line style of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineStyle {
    /// New state: wide and solid.
    New,
    /// Old state: grey, dashed.
    Old,
    /// Curve for comparison: thin, dashed, above the others.
    Other,
    /// Demanded value: thin, dotted.
    Demanded,
    /// Curve with this index among the signals of its panel.
    Signal(usize),
}

/// Font sizes, in px.
pub(super) const LABEL: f64 = 12.0;
pub(super) const SMALL: f64 = 11.0;
/// Margin on all sides, in px.
pub(super) const MARGIN: f64 = 14.0;
/// Side of the tag of an event, and length of a line in a legend, in px.
pub(super) const TAG: f64 = 15.0;
pub(super) const SWATCH: f64 = 30.0;
/// Maximum number of dashes in a curve; a curve with more would be unreadable and is drawn solid and thin.
const MOST_DASHES: f64 = 600.0;

pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
pub(super) const PALE_INK: RGBColor = RGBColor(95, 95, 95);
pub(super) const FRAME: RGBColor = RGBColor(150, 150, 150);
const GRID: RGBColor = RGBColor(228, 228, 228);

pub(super) const BUSY: RGBColor = RGBColor(150, 150, 150);
pub(super) const BIT: RGBColor = RGBColor(0, 114, 178);
pub(super) const BIT_FILL: RGBColor = RGBColor(176, 212, 236);

/// Colours of Okabe and Ito without the yellow, which is hard to see on white, and with grey instead of black.
const CURVES: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(50, 50, 50),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
/// Lengths of dash and gap, in px, of all curves except the first, which is wide and solid and so visible through their
/// gaps.
const DASHES: [(f64, f64); 6] = [(8.0, 5.0), (3.0, 4.0), (15.0, 6.0), (5.0, 9.0), (22.0, 9.0), (2.0, 7.0)];

/// Colour, width in px, and dash and gap in px of a line.
pub(super) type Line = (RGBColor, f64, Option<(f64, f64)>);

impl LineStyle {
    pub(super) fn line(self) -> Line {
        match self {
            Self::New => (CURVES[0], 2.2, None),
            Self::Old => (RGBColor(130, 130, 130), 1.6, Some((7.0, 4.0))),
            Self::Other => (CURVES[1], 1.2, Some((6.0, 5.0))),
            Self::Demanded => (INK, 1.0, Some((2.0, 3.0))),
            Self::Signal(0) => (CURVES[0], 2.6, None),
            Self::Signal(place) => (CURVES[place % CURVES.len()], 1.6, Some(DASHES[(place - 1) % DASHES.len()])),
        }
    }
}

/// Returns the colour of an event by its severity.
pub(super) fn severity_colour(severity: u8) -> RGBColor {
    match severity {
        0 => RGBColor(120, 120, 120),
        1 => RGBColor(214, 120, 0),
        _ => RGBColor(200, 30, 30),
    }
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) mark: EntryMark,
    pub(super) text: String,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum EntryMark {
    Line(Line),
    Box(RGBColor),
    None,
}

impl Entry {
    pub(super) fn width(&self) -> f64 {
        let (swatch, em) = if self.mark == EntryMark::None { (0.0, SMALL) } else { (SWATCH + 6.0, LABEL) };
        swatch + width(&self.text, em) + 18.0
    }
}

pub(super) type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
pub(super) type Plot<'a, DB> = ChartContext<'a, DB, Cartesian2d<Plotted, Plotted>>;

/// A drawing area with coordinates in px of the figure.
pub(super) struct Pen<DB: DrawingBackend> {
    pub(super) area: DrawingArea<DB, Shift>,
    /// Number of pixels of the area per px.
    pub(super) factor: f64,
}

impl<DB: DrawingBackend> Pen<DB> {
    pub(super) fn px(&self, (x, y): (f64, f64)) -> (i32, i32) {
        ((x * self.factor).round() as i32, (y * self.factor).round() as i32)
    }

    /// Returns the place of a point of a plot, in px.
    pub(super) fn place(&self, chart: &Plot<'_, DB>, point: (f64, f64)) -> (f64, f64) {
        let (x, y) = chart.backend_coord(&point);
        (f64::from(x) / self.factor, f64::from(y) / self.factor)
    }

    fn length(&self, length: f64) -> i32 {
        (length * self.factor).round() as i32
    }

    pub(super) fn part(&self, from: (f64, f64), to: (f64, f64)) -> DrawingArea<DB, Shift> {
        let (from, to) = (self.px(from), self.px(to));
        self.area.clone().shrink(from, (to.0 - from.0, to.1 - from.1))
    }

    pub(super) fn style(&self, colour: RGBColor, width: f64) -> ShapeStyle {
        ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: self.length(width).max(1) as u32 }
    }

    pub(super) fn text(&self, text: &str, at: (f64, f64), em: f64, colour: RGBColor, side: HPos) -> Drawn<DB> {
        let style = TextStyle::from(font(em * self.factor)).color(&colour);
        self.area.draw_text(text, &style.pos(Pos::new(side, VPos::Center)), self.px(at))
    }

    pub(super) fn fill(&self, from: (f64, f64), to: (f64, f64), colour: RGBColor) -> Drawn<DB> {
        self.area.draw(&Rectangle::new([self.px(from), self.px(to)], colour.filled()))
    }

    /// Draws the number of an event on its colour.
    pub(super) fn tag(&self, event: &Listed, (x, y): (f64, f64)) -> Drawn<DB> {
        let half = TAG / 2.0;
        self.fill((x - half, y - half), (x + half, y + half), severity_colour(event.severity))?;
        self.text(&event.number.to_string(), (x, y), SMALL, WHITE, HPos::Center)
    }

    pub(super) fn entries(&self, row: &[Entry], (mut x, y): (f64, f64)) -> Drawn<DB> {
        for entry in row {
            let (em, colour, indent) = match &entry.mark {
                EntryMark::None => (SMALL, PALE_INK, 0.0),
                EntryMark::Line((colour, width, dash)) => {
                    let ends = [self.px((x, y)), self.px((x + SWATCH, y))];
                    self.line(&self.area, ends.to_vec(), (*colour, *width, *dash))?;
                    (LABEL, INK, SWATCH + 6.0)
                }
                EntryMark::Box(colour) => {
                    self.fill((x, y - 6.0), (x + SWATCH, y + 6.0), *colour)?;
                    (LABEL, INK, SWATCH + 6.0)
                }
            };
            self.text(&entry.text, (x + indent, y), em, colour, HPos::Left)?;
            x += entry.width();
        }
        Ok(())
    }

    fn line(&self, area: &DrawingArea<DB, Shift>, points: Vec<(i32, i32)>, (colour, width, dash): Line) -> Drawn<DB> {
        let style = self.style(colour, width);
        match dash {
            Some((dash, gap)) => area.draw(&DashedPathElement::new(points, self.length(dash), self.length(gap), style)),
            None => area.draw(&PathElement::new(points, style)),
        }
    }

    /// Draws a part of a curve without a gap; `scale` is the length of a unit along each axis, in px.
    pub(super) fn curve(
        &self,
        chart: &mut Plot<'_, DB>,
        points: &[(f64, f64)],
        line: Line,
        scale: (f64, f64),
    ) -> Drawn<DB> {
        let (colour, width, dash) = line;
        if let [point] = points {
            let (x, y) = self.place(chart, *point);
            return self.fill((x - width, y - width), (x + width, y + width), colour);
        }
        let length = |pair: &[(f64, f64)]| ((pair[1].0 - pair[0].0) * scale.0).hypot((pair[1].1 - pair[0].1) * scale.1);
        let length: f64 = points.windows(2).map(length).sum();
        let dash = dash.filter(|(dash, gap)| length / (dash + gap) < MOST_DASHES);
        match dash {
            Some((dash, gap)) => {
                let (dash, gap, style) = (self.length(dash), self.length(gap), self.style(colour, width));
                chart.draw_series([DashedPathElement::new(points.to_vec(), dash, gap, style)])?;
            }
            None => {
                let width = if line.2.is_some() { 1.0 } else { width };
                chart.draw_series([PathElement::new(points.to_vec(), self.style(colour, width))])?;
            }
        }
        Ok(())
    }

    pub(super) fn chart<'a>(
        &self,
        area: &'a DrawingArea<DB, Shift>,
        (across, up): (&Plotted, &Plotted),
        (left, below): (f64, f64),
    ) -> Result<Plot<'a, DB>, DrawingAreaErrorKind<DB::ErrorType>> {
        ChartBuilder::on(area)
            .set_left_and_bottom_label_area_size(0)
            .y_label_area_size(self.length(left))
            .x_label_area_size(self.length(below))
            .build_cartesian_2d(across.clone(), up.clone())
    }

    pub(super) fn mesh(
        &self,
        chart: &mut Plot<'_, DB>,
        (across, up): (&Plotted, &Plotted),
        height: f64,
        has_axis: bool,
    ) -> Drawn<DB> {
        let mut mesh = chart.configure_mesh();
        mesh.bold_line_style(self.style(GRID, 1.0))
            .light_line_style(if across.minor.is_empty() { TRANSPARENT.into() } else { self.style(GRID, 0.6) })
            .axis_style(self.style(FRAME, 1.0))
            .set_all_tick_mark_size(self.length(4.0))
            .label_style(TextStyle::from(font(SMALL * self.factor)).color(&INK))
            .axis_desc_style(TextStyle::from(font(LABEL * self.factor)).color(&INK))
            .y_desc(shorten(&clean(&up.label), LABEL, height + MARGIN));
        if has_axis {
            mesh.x_desc(clean(&across.label));
        }
        mesh.draw()
    }
}

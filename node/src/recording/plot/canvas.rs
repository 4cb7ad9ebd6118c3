//! What a figure is drawn on, and the SVG of it.
//!
//! plotters counts whole pixels. An SVG is therefore drawn ten times as large and shown at a tenth, so that slopes stay
//! smooth however close one looks.

use super::Problem;
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle};
use std::fmt::Display;

/// Red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Colour(pub(super) u8, pub(super) u8, pub(super) u8);

impl Colour {
    pub(super) fn rgb(self) -> RGBColor {
        RGBColor(self.0, self.1, self.2)
    }
}

/// A place (px), from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
}

pub(super) fn point(x: f64, y: f64) -> Point {
    Point { x, y }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    /// (px)
    pub(super) width: f64,
    /// Lengths of dash, gap, dash.. (px), of an even count; empty for a line without gaps.
    pub(super) dash: &'static [f64],
}

impl Stroke {
    pub(super) fn line(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: &[] }
    }
}

/// Which point of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How text is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Letters {
    /// Size (px).
    pub(super) em: f64,
    pub(super) colour: Colour,
    pub(super) anchor: Anchor,
    /// Read from below to above.
    pub(super) upright: bool,
}

impl Letters {
    pub(super) fn new(em: f64, colour: Colour, anchor: Anchor) -> Self {
        Self { em, colour, anchor, upright: false }
    }
}

/// Something to draw on. What cannot be drawn is told at the end.
pub(super) trait Canvas {
    /// Fills a rectangle between two corners.
    fn fill(&mut self, from: Point, to: Point, colour: Colour);
    /// Draws a line through points; one alone becomes a dot.
    fn stroke(&mut self, path: &[Point], stroke: Stroke);
    /// Writes a text whose small letters have their middle at the height of `at`.
    fn text(&mut self, text: &str, at: Point, letters: Letters);
}

/// Part of a pixel that an SVG tells apart.
const FINE: f64 = 10.0;
/// plotters gives this many times the size of letters as the height of a line.
const LINE_PER_EM: f64 = 1.24;

struct Svg<'a> {
    backend: SVGBackend<'a>,
    failure: Option<String>,
}

/// Draws an SVG of this size (px).
///
/// # Errors
/// [`Problem::Drawing`]
pub(super) fn svg(size: (u32, u32), paint: impl FnOnce(&mut dyn Canvas)) -> Result<String, Problem> {
    let mut text = String::new();
    let large = (size.0 * FINE as u32, size.1 * FINE as u32);
    let mut svg = Svg { backend: SVGBackend::with_string(&mut text, large), failure: None };
    paint(&mut svg);
    let done = svg.backend.present();
    svg.note(done);
    let failure = svg.failure.take();
    drop(svg);
    match failure {
        Some(reason) => Err(Problem::Drawing { reason }),
        None => Ok(text.replacen(
            &format!(r#"width="{}" height="{}""#, large.0, large.1),
            &format!(r#"width="{}" height="{}""#, size.0, size.1),
            1,
        )),
    }
}

impl Svg<'_> {
    fn note<E: Display>(&mut self, result: Result<(), E>) {
        if let Err(error) = result {
            self.failure.get_or_insert(error.to_string());
        }
    }
}

fn fine(at: Point) -> (i32, i32) {
    ((at.x * FINE).round() as i32, (at.y * FINE).round() as i32)
}

impl Canvas for Svg<'_> {
    fn fill(&mut self, from: Point, to: Point, colour: Colour) {
        let done = self.backend.draw_rect(fine(from), fine(to), &colour.rgb(), true);
        self.note(done);
    }

    fn stroke(&mut self, path: &[Point], stroke: Stroke) {
        let style = ShapeStyle {
            color: colour(stroke.colour),
            filled: false,
            stroke_width: (stroke.width * FINE).round() as u32,
        };
        for dash in dashes(path, stroke.dash) {
            let points = straightened(dash.iter().copied().map(fine));
            let done = match points[..] {
                [] => Ok(()),
                [(x, y)] => {
                    let half = (stroke.width * FINE) as i32;
                    self.backend.draw_rect((x - half, y - half), (x + half, y + half), &stroke.colour.rgb(), true)
                }
                _ => self.backend.draw_path(points, &style),
            };
            self.note(done);
        }
    }

    fn text(&mut self, text: &str, at: Point, letters: Letters) {
        let side = match letters.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let turn = if letters.upright { FontTransform::Rotate270 } else { FontTransform::None };
        let font = FontDesc::new(FontFamily::SansSerif, letters.em * FINE * LINE_PER_EM, FontStyle::Normal);
        let colour = letters.colour.rgb();
        let style = TextStyle::from(font.transform(turn)).color(&colour);
        let done = self.backend.draw_text(text, &style.pos(Pos::new(side, VPos::Center)), fine(at));
        self.note(done);
    }
}

fn colour(colour: Colour) -> plotters::style::RGBAColor {
    colour.rgb().to_rgba()
}

/// The points without those that stand on the level or upright line between their neighbours.
fn straightened(points: impl Iterator<Item = (i32, i32)>) -> Vec<(i32, i32)> {
    let mut kept: Vec<(i32, i32)> = Vec::new();
    for next in points {
        let between = |a: i32, b: i32, c: i32| (a <= b && b <= c) || (a >= b && b >= c);
        match kept[..] {
            [.., last] if last == next => continue,
            [.., (ax, ay), (bx, by)]
                if (ay == by && by == next.1 && between(ax, bx, next.0))
                    || (ax == bx && bx == next.0 && between(ay, by, next.1)) =>
            {
                kept.pop();
            }
            _ => {}
        }
        kept.push(next);
    }
    kept
}

/// Most dashes of a line whose every part counts with its full length: noise from edge to edge of a panel would else become
/// a hundred thousand of them.
const MOST_DASHES: f64 = 600.0;
/// What a part of a longer line counts at most (px).
const LONGEST: f64 = 16.0;

/// Cuts a line into dashes. Without a pattern it stays whole.
pub(super) fn dashes(path: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    if pattern.is_empty() || path.len() < 2 {
        return vec![path.to_vec()];
    }
    let length = |pair: &[Point]| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y);
    let count = path.windows(2).map(length).sum::<f64>() / pattern.iter().sum::<f64>();
    let longest = if count > MOST_DASHES { LONGEST } else { f64::MAX };
    let mut dashes = Vec::new();
    let mut dash = vec![path[0]];
    let (mut place, mut left) = (0, pattern[0]);
    for pair in path.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length = length(pair).min(longest);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let part = done / length;
            let at = point(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y));
            if place % 2 == 0 {
                dash.push(at);
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at];
            }
            place = (place + 1) % pattern.len();
            left = pattern[place];
        }
        left -= length - done;
        if place % 2 == 0 {
            dash.push(to);
        }
    }
    if dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dashed_line_is_cut_at_its_lengths_around_corners() {
        let path = [point(0.0, 0.0), point(6.0, 0.0), point(6.0, 6.0)];
        let cut = dashes(&path, &[4.0, 1.0]);
        assert_eq!(
            cut,
            [
                vec![point(0.0, 0.0), point(4.0, 0.0)],
                vec![point(5.0, 0.0), point(6.0, 0.0), point(6.0, 3.0)],
                vec![point(6.0, 4.0), point(6.0, 6.0)],
            ]
        );
    }

    #[test]
    fn a_line_without_pattern_stays_whole() {
        let path = [point(0.0, 0.0), point(6.0, 0.0)];
        assert_eq!(dashes(&path, &[]), [path.to_vec()]);
    }

    #[test]
    fn noise_makes_no_flood_of_dashes() {
        let path: Vec<Point> = (0..4000).map(|n| point(f64::from(n) / 4.0, f64::from(n % 2) * 300.0)).collect();
        assert!(dashes(&path, &[7.0, 4.0]).len() < 6000);
    }

    #[test]
    fn straight_parts_keep_their_ends_and_turns() {
        let points = [(0, 0), (5, 0), (9, 0), (9, 0), (9, 4), (9, 2), (9, 8)];
        assert_eq!(straightened(points.into_iter()), [(0, 0), (9, 0), (9, 4), (9, 2), (9, 8)]);
    }

    #[test]
    fn a_drawing_has_the_size_that_was_asked_for_and_ten_parts_of_a_pixel() {
        let text = svg((120, 80), |canvas| {
            canvas.stroke(&[point(1.25, 2.0), point(3.0, 4.0)], Stroke::line(Colour(1, 2, 3), 1.5));
        });
        let text = text.unwrap();
        assert!(text.starts_with(r#"<svg width="120" height="80" viewBox="0 0 1200 800""#), "{text}");
        assert!(text.contains(r##"stroke="#010203" stroke-width="15" points="13,20 30,40 ""##), "{text}");
        assert!(text.trim_end().ends_with("</svg>"));
    }
}

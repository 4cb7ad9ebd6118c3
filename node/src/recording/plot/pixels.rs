//! A figure as PNG.
//!
//! The figure is drawn larger by a whole factor and each pixel is the mean of those that it stands for: lines and letters get smooth
//! edges. Letters come from the font of the program, whatever fonts there are.

use super::Problem;
use super::canvas::{Anchor, Canvas, Colour, Letters, Point, Stroke, dashes};
use super::text::Font;
use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::Color;
use std::fmt::Display;

/// Half of the height of small letters (em): what the middle of a line of text is.
const MIDDLE: f64 = 0.2735;
/// Most pixels drawn for one that is shown, along one side, and in all.
const FINEST: u32 = 3;
const MOST_DRAWN: u64 = 50_000_000;

struct Pixels<'a> {
    bytes: Vec<u8>,
    size: (u32, u32),
    fine: u32,
    font: &'a Font,
    failure: Option<String>,
}

/// Draws a PNG of this size (px).
///
/// # Errors
/// [`Problem::Pixels`], [`Problem::Drawing`]
pub(super) fn png(size: (u32, u32), font: &Font, paint: impl FnOnce(&mut dyn Canvas)) -> Result<Vec<u8>, Problem> {
    let (width, height) = size;
    let shown = u64::from(width) * u64::from(height);
    if shown > super::MOST_PIXELS {
        return Err(Problem::Pixels { width, height });
    }
    let drawn = |fine: u32| shown * u64::from(fine * fine);
    let fine = (2..=FINEST).rev().find(|&fine| drawn(fine) <= MOST_DRAWN).unwrap_or(1);
    let bytes = vec![255; drawn(fine) as usize * 3];
    let mut pixels = Pixels { bytes, size: (width * fine, height * fine), fine, font, failure: None };
    paint(&mut pixels);
    if let Some(reason) = pixels.failure {
        return Err(Problem::Drawing { reason });
    }
    encode(&pixels.means(), width, height).map_err(|error| Problem::Drawing { reason: error.to_string() })
}

fn encode(bytes: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(file)
}

impl Pixels<'_> {
    fn note<E: Display>(&mut self, result: Result<(), E>) {
        if let Err(error) = result {
            self.failure.get_or_insert(error.to_string());
        }
    }

    /// Each pixel shown is the mean of `fine` x `fine` drawn ones.
    fn means(&self) -> Vec<u8> {
        let fine = self.fine as usize;
        let (width, height) = (self.size.0 as usize / fine, self.size.1 as usize / fine);
        let mut means = Vec::with_capacity(width * height * 3);
        let mut sums = vec![0_u32; width * 3];
        let count = (fine * fine) as u32;
        for rows in self.bytes.chunks_exact(self.size.0 as usize * 3 * fine) {
            sums.fill(0);
            for row in rows.chunks_exact(self.size.0 as usize * 3) {
                for (block, sums) in row.chunks_exact(3 * fine).zip(sums.chunks_exact_mut(3)) {
                    for pixel in block.chunks_exact(3) {
                        sums.iter_mut().zip(pixel).for_each(|(sum, &part)| *sum += u32::from(part));
                    }
                }
            }
            means.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
        }
        means
    }

    /// Fills spans of rows, each from its first pixel to before its last.
    fn spans(&mut self, spans: impl Iterator<Item = (i32, i32, i32)>, colour: Colour) {
        let (right, below) = (self.size.0 as i32, self.size.1 as i32);
        let mut backend = BitMapBackend::with_buffer(&mut self.bytes, self.size);
        let mut failure = None;
        for (row, from, to) in spans {
            let (from, to) = (from.max(0), to.min(right));
            if row >= 0
                && row < below
                && from < to
                && let Err(error) = backend.draw_rect((from, row), (to, row + 1), &colour.rgb(), true)
            {
                failure = Some(error.to_string());
            }
        }
        drop(backend);
        self.note(failure.map_or(Ok(()), Err));
    }

    /// Fills what lies within `radius` of the line between two points.
    fn capsule(&mut self, from: Point, to: Point, radius: f64, colour: Colour) {
        let top = first(from.y.min(to.y) - radius).max(0);
        let end = first(from.y.max(to.y) + radius).min(self.size.1 as i32);
        let rows = (top..end).filter_map(|row| {
            let (left, right) = span(from, to, radius, f64::from(row) + 0.5)?;
            Some((row, first(left), first(right)))
        });
        self.spans(rows, colour);
    }

    fn large(&self, at: Point) -> Point {
        Point { x: at.x * f64::from(self.fine), y: at.y * f64::from(self.fine) }
    }
}

/// Where the level line at `y` is nearer than `radius` to the line between two points.
fn span(from: Point, to: Point, radius: f64, y: f64) -> Option<(f64, f64)> {
    let mut span: Option<(f64, f64)> = None;
    let mut add = |left: f64, right: f64| {
        span = Some(span.map_or((left, right), |(a, b)| (a.min(left), b.max(right))));
    };
    for end in [from, to] {
        let rest = radius * radius - (y - end.y) * (y - end.y);
        if rest >= 0.0 {
            add(end.x - rest.sqrt(), end.x + rest.sqrt());
        }
    }
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let length = dx.hypot(dy);
    if length > 0.0 {
        // The two long edges of the line; the round ends above close it.
        let (side_x, side_y) = (-dy / length * radius, dx / length * radius);
        for sign in [-1.0, 1.0] {
            let (x, start) = (from.x + sign * side_x, from.y + sign * side_y);
            if dy == 0.0 {
                continue;
            }
            let part = (y - start) / dy;
            if (0.0..=1.0).contains(&part) {
                add(x + part * dx, x + part * dx);
            }
        }
    }
    span
}

/// The first pixel whose middle lies at or behind `edge`.
fn first(edge: f64) -> i32 {
    (edge - 0.5).ceil() as i32
}

impl Canvas for Pixels<'_> {
    fn fill(&mut self, from: Point, to: Point, colour: Colour) {
        let (from, to) = (self.large(from), self.large(to));
        let rows = first(from.y).max(0)..first(to.y).min(self.size.1 as i32);
        self.spans(rows.map(|row| (row, first(from.x), first(to.x))), colour);
    }

    fn stroke(&mut self, path: &[Point], stroke: Stroke) {
        let radius = (stroke.width * f64::from(self.fine) / 2.0).max(0.5);
        for dash in dashes(path, stroke.dash) {
            let dash: Vec<Point> = dash.into_iter().map(|at| self.large(at)).collect();
            if let [dot] = dash[..] {
                self.capsule(dot, dot, 2.0 * radius, stroke.colour);
            }
            for pair in dash.windows(2) {
                self.capsule(pair[0], pair[1], radius, stroke.colour);
            }
        }
    }

    fn text(&mut self, text: &str, at: Point, letters: Letters) {
        let font = self.font;
        let em = letters.em * f64::from(self.fine);
        let at = self.large(at);
        let width = font.width(text, em);
        let back = match letters.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => width / 2.0,
            Anchor::End => width,
        };
        let (along, across) = if letters.upright { (at.y, at.x) } else { (at.x, at.y) };
        let base = (across + MIDDLE * em).round() as i32;
        let start = if letters.upright { (along + back).round() } else { (along - back).round() } as i32;
        let (right, below) = (self.size.0 as i32, self.size.1 as i32);
        let mut backend = BitMapBackend::with_buffer(&mut self.bytes, self.size);
        let mut failure = None;
        for outline in font.outlines(text, em) {
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, covered| {
                let (x, y) = (corner.x as i32 + x as i32, corner.y as i32 + y as i32);
                let (x, y) = if letters.upright { (base + y, start - x) } else { (start + x, base + y) };
                if x < 0 || y < 0 || x >= right || y >= below || covered <= 0.0 {
                    return;
                }
                let colour = letters.colour.rgb().mix(f64::from(covered.min(1.0)));
                if let Err(error) = backend.draw_pixel((x, y), colour.to_backend_color()) {
                    failure = Some(error.to_string());
                }
            });
        }
        drop(backend);
        self.note(failure.map_or(Ok(()), Err));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::plot::canvas::point;

    fn decoded(file: &[u8]) -> (u32, u32, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        (info.width, info.height, bytes)
    }

    /// The darkness of each pixel of a picture, from 0 to 255, in rows.
    fn darkness(size: (u32, u32), paint: impl FnOnce(&mut dyn Canvas)) -> Vec<Vec<u8>> {
        let (width, _, bytes) = decoded(&png(size, &Font::new(), paint).unwrap());
        let dark: Vec<u8> = bytes.chunks_exact(3).map(|pixel| 255 - pixel[0]).collect();
        dark.chunks_exact(width as usize).map(<[u8]>::to_vec).collect()
    }

    const BLACK: Colour = Colour(0, 0, 0);

    #[test]
    fn a_level_line_on_the_middle_of_a_row_fills_that_row_and_no_other() {
        let rows = darkness((20, 7), |canvas| {
            canvas.stroke(&[point(-5.0, 3.5), point(30.0, 3.5)], Stroke::line(BLACK, 1.0));
        });
        for (place, row) in rows.iter().enumerate() {
            assert!(row.iter().all(|&dark| dark == if place == 3 { 255 } else { 0 }), "row {place}: {row:?}");
        }
    }

    #[test]
    fn a_slanted_line_covers_the_area_that_its_width_asks_for() {
        let rows = darkness((60, 60), |canvas| {
            canvas.stroke(&[point(10.0, 10.0), point(40.0, 50.0)], Stroke::line(BLACK, 3.0));
        });
        let area = rows.iter().flatten().map(|&dark| f64::from(dark) / 255.0).sum::<f64>();
        // 50 px long, and two half circles.
        let expected = 50.0 * 3.0 + 1.5 * 1.5 * std::f64::consts::PI;
        assert!((area - expected).abs() < 0.05 * expected, "{area} of {expected}");
    }

    #[test]
    fn a_text_stands_where_it_is_anchored() {
        let extent = |anchor: Anchor| {
            let rows = darkness((200, 40), |canvas| {
                canvas.text("xx", point(100.0, 20.0), Letters::new(20.0, BLACK, anchor));
            });
            let columns: Vec<usize> = (0..200).filter(|&x| rows.iter().any(|row| row[x] > 60)).collect();
            let inked: Vec<usize> = (0..40).filter(|&y| rows[y].iter().any(|&dark| dark > 60)).collect();
            ((columns[0], columns[columns.len() - 1]), (inked[0], inked[inked.len() - 1]))
        };
        let ((left, right), (top, below)) = extent(Anchor::Middle);
        assert!((left + right).abs_diff(199) <= 2, "{left} {right}");
        assert!((top + below).abs_diff(39) <= 2, "{top} {below}");
        assert!(extent(Anchor::Start).0.0.abs_diff(100) <= 2);
        assert!(extent(Anchor::End).0.1.abs_diff(99) <= 2);
    }

    #[test]
    fn an_upright_text_reads_from_below() {
        let text = |text: &'static str, upright| {
            let letters = Letters { upright, ..Letters::new(20.0, BLACK, Anchor::Middle) };
            darkness((40, 40), move |canvas| canvas.text(text, point(20.0, 20.0), letters))
        };
        let (level, upright) = (text("L", false), text("L", true));
        let turned = |x: usize, y: usize| upright[39 - x][y];
        let differ = (0..40).flat_map(|y| (0..40).map(move |x| (x, y)));
        let off = differ.filter(|&(x, y)| level[y][x].abs_diff(turned(x, y)) > 170).count();
        assert!(off < 12, "{off} pixels");
    }

    #[test]
    fn too_large_a_picture_is_refused_with_its_size() {
        let problem = png((8000, 8000), &Font::new(), |_| {}).unwrap_err();
        assert_eq!(
            problem.to_string(),
            "8000 x 8000 px are more than the 24 million pixels of a PNG; an SVG may be as large"
        );
    }
}

//! Draws a figure as PNG.
//!
//! The figure is drawn larger by an integer factor, and each pixel is the mean of the pixels that it covers, so that
//! lines and letters have smooth edges. Thick lines have round ends, so that noise shows neither spikes nor holes.

use super::Problem;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind};
use std::convert::Infallible;

/// Maximum factor, and maximum number of pixels that are drawn.
const FINEST: u32 = 3;
const MOST_DRAWN: u64 = 50_000_000;

/// Offset by which plotters places a text too high, as a fraction of its size: it ignores the space below the letters.
const LOWER: f64 = 0.125;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// Pixel buffer on which plotters draws.
pub(super) struct Pixels<'a> {
    bytes: &'a mut [u8],
    size: (u32, u32),
}

/// Returns the factor by which a PNG of this size (in px) is drawn larger.
///
/// # Errors
/// [`Problem::Pixels`]
pub(super) fn factor((width, height): (u32, u32)) -> Result<u32, Problem> {
    let shown = u64::from(width) * u64::from(height);
    if shown > super::MOST_PIXELS {
        return Err(Problem::Pixels { width, height });
    }
    Ok((2..=FINEST).rev().find(|factor| shown * u64::from(factor * factor) <= MOST_DRAWN).unwrap_or(1))
}

/// Draws a PNG of this size (in px) with `paint`, which draws it larger by `factor`.
///
/// # Errors
/// [`Problem::Drawing`]
pub(super) fn png(
    (width, height): (u32, u32),
    factor: u32,
    paint: impl FnOnce(Pixels<'_>) -> Result<(), Problem>,
) -> Result<Vec<u8>, Problem> {
    let size = (width * factor, height * factor);
    let mut bytes = vec![255; size.0 as usize * size.1 as usize * 3];
    paint(Pixels { bytes: &mut bytes, size })?;
    let means = means(&bytes, size.0 as usize, factor as usize);
    encode(&means, width, height).map_err(|error| Problem::Drawing { reason: error.to_string() })
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

/// Returns the means of blocks of `factor` x `factor` pixels.
fn means(bytes: &[u8], width: usize, factor: usize) -> Vec<u8> {
    let mut means = Vec::with_capacity(bytes.len() / (factor * factor));
    let mut sums = vec![0_u32; width / factor * 3];
    let count = (factor * factor) as u32;
    for rows in bytes.chunks_exact(width * 3 * factor) {
        sums.fill(0);
        for row in rows.chunks_exact(width * 3) {
            for (block, sums) in row.chunks_exact(3 * factor).zip(sums.chunks_exact_mut(3)) {
                for pixel in block.chunks_exact(3) {
                    sums.iter_mut().zip(pixel).for_each(|(sum, &part)| *sum += u32::from(part));
                }
            }
        }
        means.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    means
}

impl Pixels<'_> {
    /// Fills the pixels of a row from `from` up to, but not including, `to`.
    fn fill_row(&mut self, row: i32, from: i32, to: i32, colour: BackendColor) {
        let (from, to) = (from.max(0), to.min(self.size.0 as i32));
        if row < 0 || row >= self.size.1 as i32 || from >= to {
            return;
        }
        let start = row as usize * self.size.0 as usize;
        let (red, green, blue) = colour.rgb;
        if let Some(pixels) = self.bytes.get_mut((start + from as usize) * 3..(start + to as usize) * 3) {
            if red == green && green == blue {
                pixels.fill(red);
            } else {
                pixels.chunks_exact_mut(3).for_each(|pixel| pixel.copy_from_slice(&[red, green, blue]));
            }
        }
    }

    /// Fills all pixels within `radius` of the line between two points.
    fn fill_line(&mut self, from: (f64, f64), to: (f64, f64), radius: f64, colour: BackendColor) {
        let top = (from.1.min(to.1) - radius).floor().max(0.0) as i32;
        let end = (from.1.max(to.1) + radius).ceil().min(f64::from(self.size.1)) as i32;
        for row in top..end {
            if let Some((left, right)) = span(from, to, radius, f64::from(row) + 0.5) {
                self.fill_row(row, (left - 0.5).ceil() as i32, (right - 0.5).ceil() as i32, colour);
            }
        }
    }
}

/// Returns the part of the horizontal line at `y` that is within `radius` of the line between two points.
fn span(from: (f64, f64), to: (f64, f64), radius: f64, y: f64) -> Option<(f64, f64)> {
    let mut span: Option<(f64, f64)> = None;
    let mut add = |x: f64| span = Some(span.map_or((x, x), |(left, right)| (left.min(x), right.max(x))));
    for end in [from, to] {
        let rest = radius * radius - (y - end.1) * (y - end.1);
        if rest >= 0.0 {
            add(end.0 - rest.sqrt());
            add(end.0 + rest.sqrt());
        }
    }
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    if dy != 0.0 {
        // Intersections with the two long edges of the line; those with its round ends were added above.
        let length = dx.hypot(dy);
        for side in [radius / length, -radius / length] {
            let part = (y - (from.1 + side * dx)) / dy;
            if (0.0..=1.0).contains(&part) {
                add(from.0 - side * dy + part * dx);
            }
        }
    }
    span
}

impl DrawingBackend for Pixels<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        if x >= 0 && y >= 0 && x < self.size.0 as i32 && y < self.size.1 as i32 {
            let place = (y as usize * self.size.0 as usize + x as usize) * 3;
            let (red, green, blue) = colour.rgb;
            for (part, new) in self.bytes.iter_mut().skip(place).zip([red, green, blue]) {
                *part = (f64::from(*part) + (f64::from(new) - f64::from(*part)) * colour.alpha.min(1.0)).round() as u8;
            }
        }
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S, fill: bool) -> Drawn {
        if !fill {
            return self.draw_path([from, (to.0, from.1), to, (from.0, to.1), from], style);
        }
        for row in from.1.max(0)..to.1.min(self.size.1 as i32) {
            self.fill_row(row, from.0, to.0, style.color());
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Drawn {
        let failed = |error: S::FontError| DrawingErrorKind::FontError(error.to_string().into());
        let ((left, top), (right, end)) = style.layout_box(text).map_err(failed)?;
        let x = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => (left - right) / 2,
            HPos::Right => left - right,
        };
        let y = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => (top - end) / 2 + (LOWER * style.size()).round() as i32,
            VPos::Bottom => top - end,
        };
        let turn = style.transform();
        let drawn = style.draw(text, (0, 0), |dx, dy, colour| {
            let (dx, dy) = turn.transform(x + dx, y + dy);
            self.draw_pixel((at.0 + dx, at.1 + dy), colour)
        });
        drawn.map_err(failed)?
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        if style.color().alpha == 0.0 {
            return Ok(());
        }
        let radius = (f64::from(style.stroke_width()) / 2.0).max(0.5);
        // Edges of a line are edges of pixels: a line of odd width is centred on the middle of its pixel.
        let middle = if style.stroke_width() % 2 == 1 { 0.5 } else { 0.0 };
        let mut before = None;
        for (x, y) in path {
            let at = (f64::from(x) + middle, f64::from(y) + middle);
            if before != Some(at) {
                self.fill_line(before.unwrap_or(at), at, radius, style.color());
            }
            before = Some(at);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::style::{BLACK, Color};

    /// Returns the decoded bytes of a PNG of 40 x 40 px.
    fn drawn(paint: impl FnOnce(&mut Pixels<'_>)) -> Vec<u8> {
        let file = png((40, 40), 2, |mut pixels| {
            paint(&mut pixels);
            Ok(())
        });
        let mut reader = png::Decoder::new(std::io::Cursor::new(file.unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        bytes
    }

    fn shade(bytes: &[u8], x: usize, y: usize) -> u8 {
        bytes[(y * 40 + x) * 3]
    }

    #[test]
    fn a_rectangle_fills_its_pixels_and_no_others() {
        let bytes = drawn(|pixels| drop(pixels.draw_rect((20, 20), (40, 30), &Color::filled(&BLACK), true)));
        assert_eq!(
            [shade(&bytes, 9, 12), shade(&bytes, 10, 12), shade(&bytes, 19, 12), shade(&bytes, 20, 12)],
            [255, 0, 0, 255]
        );
        assert_eq!(
            [shade(&bytes, 12, 9), shade(&bytes, 12, 10), shade(&bytes, 12, 14), shade(&bytes, 12, 15)],
            [255, 0, 0, 255]
        );
    }

    #[test]
    fn a_line_has_its_width_in_every_direction() {
        for (from, to) in [((10, 40), (70, 40)), ((40, 10), (40, 70)), ((10, 10), (70, 70))] {
            let bytes = drawn(|pixels| drop(pixels.draw_path([from, to], &Color::stroke_width(&BLACK, 8))));
            let dark: f64 = bytes.chunks_exact(3).map(|pixel| f64::from(255 - pixel[0]) / 255.0).sum();
            let length = f64::from(to.0 - from.0).hypot(f64::from(to.1 - from.1)) / 2.0;
            // 4 px wide, with two half circles at the ends.
            let expected = 4.0 * length + std::f64::consts::PI * 4.0;
            assert!((dark - expected).abs() < 0.05 * expected, "{dark} {expected}");
        }
    }

    #[test]
    fn a_picture_that_is_too_large_is_refused_with_its_size() {
        assert_eq!(
            factor((8000, 8000)).unwrap_err().to_string(),
            "8000 x 8000 px are more than the 24 million pixels of a PNG; an SVG may be as large"
        );
        assert_eq!([factor((1000, 1000)), factor((6000, 4000))], [Ok(3), Ok(1)]);
    }
}

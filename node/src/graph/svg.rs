//! Writes the shapes of the figure as SVG.

use std::fmt::{Arguments, Write};

/// A point or a size, in px.
pub(super) type Point = (f64, f64);

/// Width of a character: the figure uses a monospaced font.
pub(super) const LETTER: f64 = 7.3;

/// A figure.
pub(super) struct Svg(String);

impl Svg {
    pub(super) fn new(title: &str, (width, height): Point) -> Self {
        let mut svg = Self(String::new());
        svg.put(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" font-family=\"DejaVu Sans Mono, Consolas, monospace\" font-size=\"12\">"
        ));
        svg.put(format_args!("<title>{}</title>", escaped(title)));
        svg.put(format_args!(
            "<defs><marker id=\"end\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" \
             orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" fill=\"#333\"/></marker></defs>"
        ));
        svg.put(format_args!("<rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"#fff\"/>"));
        svg
    }

    fn put(&mut self, line: Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{line}");
    }

    pub(super) fn frame(&mut self, (x, y): Point, (width, height): Point, fill: &str) {
        self.put(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"4\" fill=\"{fill}\" stroke=\"#495057\"/>"
        ));
    }

    pub(super) fn line(&mut self, (x, y): Point, (to_x, to_y): Point) {
        self.put(format_args!("<path d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\" stroke=\"#adb5bd\"/>"));
    }

    /// Draws a link with horizontal ends; `bends` are the lengths of its horizontal parts at both ends.
    pub(super) fn link(&mut self, (x, y): Point, (to_x, to_y): Point, bends: Point, is_dashed: bool) {
        let (first, last) = (x + bends.0, to_x + bends.1);
        let dashes = if is_dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        self.put(format_args!(
            "<path d=\"M{x:.1} {y:.1}C{first:.1} {y:.1} {last:.1} {to_y:.1} {to_x:.1} {to_y:.1}\" fill=\"none\" stroke=\"#333\" \
             stroke-width=\"1.3\"{dashes} marker-end=\"url(#end)\"/>"
        ));
    }

    pub(super) fn text(&mut self, (x, y): Point, text: &str, anchor: &str, is_bold: bool) {
        let weight = if is_bold { " font-weight=\"bold\"" } else { "" };
        self.put(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\"{weight}>{}</text>",
            escaped(text)
        ));
    }

    pub(super) fn finish(mut self) -> String {
        self.put(format_args!("</svg>"));
        self.0
    }
}

/// Returns the width of a text.
pub(super) fn width(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

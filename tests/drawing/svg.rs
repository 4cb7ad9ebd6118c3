//! A drawing as text, with the same bytes for the same strokes.

use std::fmt::Write;

pub(super) struct Svg(String);

/// Horizontal and vertical coordinate.
type Point = (f64, f64);

impl Svg {
    pub(super) fn new(width: f64, height: f64) -> Self {
        let mut svg = Self(String::new());
        svg.put(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" font-size=\"12\">"
        ));
        svg.put(format_args!("<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>"));
        svg
    }

    fn put(&mut self, line: std::fmt::Arguments<'_>) {
        writeln!(self.0, "{line}").expect("a text takes every line");
    }

    pub(super) fn line(&mut self, (x, y): Point, (to_x, to_y): Point, colour: &str, width: f64) {
        self.put(format_args!(
            "<path d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        ));
    }

    pub(super) fn dashes(&mut self, (x, y): Point, (to_x, to_y): Point) {
        self.put(format_args!(
            "<path d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\" stroke=\"#999\" stroke-dasharray=\"2 3\"/>"
        ));
    }

    pub(super) fn path(&mut self, points: &[Point], colour: &str) {
        let mut way = String::new();
        for (place, (x, y)) in points.iter().enumerate() {
            let letter = if place == 0 { 'M' } else { 'L' };
            write!(way, "{letter}{x:.1} {y:.1}").expect("a text takes every point");
        }
        self.put(format_args!(
            "<path d=\"{way}\" stroke=\"{colour}\" stroke-width=\"1.8\" fill=\"none\" stroke-linejoin=\"round\"/>"
        ));
    }

    pub(super) fn text(&mut self, (x, y): Point, text: &str, anchor: &str, colour: &str) {
        self.put(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        ));
    }

    pub(super) fn bar(&mut self, (x, y): Point, (width, height): Point, colour: &str) {
        self.put(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\"/>"
        ));
    }

    pub(super) fn frame(&mut self, (x, y): Point, (width, height): Point) {
        self.put(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"4\" fill=\"none\" stroke=\"#dee2e6\"/>"
        ));
    }

    pub(super) fn dot(&mut self, (x, y): Point) {
        self.put(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.4\" fill=\"#111\"/>"));
    }

    pub(super) fn ring(&mut self, (x, y): Point) {
        self.put(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.2\" fill=\"#fff\" stroke=\"#111\" stroke-width=\"1.2\"/>"
        ));
    }

    pub(super) fn finish(mut self) -> String {
        self.put(format_args!("</svg>"));
        self.0
    }
}

//! Tests whole figures.

mod figures;
mod odd;

use super::{Across, Chosen, Figure, Target, draw};
use crate::recording::series::{EventMark, Kind, Series};

fn series(name: &str, unit: &str, kind: Kind, points: Vec<(f64, f64)>) -> Series {
    let (name, unit, topic) = (name.to_owned(), unit.to_owned(), "/lineshaft/signals".to_owned());
    Series { name, unit, kind, topic, points, gaps: Vec::new() }
}

/// Returns a signal sampled at 1 kHz.
fn sampled(name: &str, unit: &str, kind: Kind, count: u32, value: impl Fn(f64) -> f64) -> Series {
    let times = (0..count).map(|cycle| f64::from(cycle) / 1e3);
    series(name, unit, kind, times.map(|time| (time, value(time))).collect())
}

fn states() -> Kind {
    Kind::Enum(["DISABLED", "STANDSTILL", "DISCRETE_MOTION"].map(str::to_owned).to_vec())
}

fn mark(time: f64, severity: u8, kind: &str, text: &str) -> EventMark {
    EventMark { time, severity, kind: kind.to_owned(), source: "x".to_owned(), text: text.to_owned() }
}

/// Returns a figure of all signals, as if they were chosen by a pattern.
fn figure<'a>(signals: &'a [Series], marks: &'a [EventMark]) -> Figure<'a> {
    Figure {
        title: "A run".to_owned(),
        signals: signals.iter().map(|series| Chosen { series, by_name: false }).collect(),
        marks,
        from: None,
        to: None,
        across: Across::Time,
        width: 1200,
        height: None,
        split: false,
    }
}

fn svg(figure: &Figure<'_>) -> String {
    String::from_utf8(draw(figure, Target::Svg).unwrap()).unwrap()
}

/// Returns the texts of an SVG, in the order in which they are drawn.
pub(super) fn texts(svg: &str) -> Vec<&str> {
    let texts = svg.split("<text").skip(1).filter_map(|text| text.split_once(">\n")?.1.split_once("\n</text>"));
    texts.map(|(text, _)| text).collect()
}

//! Axes of a plot: ranges, ticks and labels for plotters.

use super::text::{grouped, number};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// Spacing of values along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// Linear, with round ticks.
    Even,
    /// Linear, with ticks at the multiples of a step.
    Steps(f64),
    /// Logarithmic; all values must be greater than 0.
    Decades,
}

/// An axis of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit, such as `time (s)`.
    pub label: String,
    /// Lowest value shown.
    pub low: f64,
    /// Highest value shown, above `low`.
    pub high: f64,
    /// How values are spaced.
    pub spacing: Spacing,
}

/// An axis in the coordinates of plotters: logarithms for decades, and an offset if the numbers would be too long.
#[derive(Clone)]
pub(super) struct Plotted {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) base: f64,
    pub(super) is_log: bool,
    pub(super) ticks: Vec<f64>,
    /// Labels of the ticks.
    pub(super) tick_labels: Vec<String>,
    /// Ticks of the minor grid.
    pub(super) minor: Vec<f64>,
    pub(super) label: String,
}

impl Plotted {
    pub(super) fn new(axis: &Axis, most: f64) -> Self {
        let is_log = axis.spacing == Spacing::Decades;
        let scale = |value: f64| if is_log { libm::log10(value) } else { value };
        let (low, high) = (scale(axis.low), scale(axis.high));
        let largest = low.abs().max(high.abs());
        let is_far = (high - low) < 1e-6 * largest && !is_log;
        let base = if is_far { low.floor() } else { 0.0 };
        let (low, high) = (low - base, high - base);
        let label = if is_far { format!("{}, from {} on", axis.label, number(base)) } else { axis.label.clone() };
        let (ticks, minor) = match axis.spacing {
            Spacing::Even => (RangedCoordf64::from(low..high).key_points(most.max(2.0) as usize), Vec::new()),
            Spacing::Steps(step) => {
                let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
                ((first..=last.min(first.saturating_add(200))).map(|k| k as f64 * step).collect(), Vec::new())
            }
            Spacing::Decades => decades(low, high),
        };
        let step = ticks.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let decimals = if step.is_finite() && step > 0.0 { -(step.log10() + 1e-9).floor() } else { 0.0 };
        let decimals = decimals.clamp(0.0, 15.0) as usize;
        let tick_label = |value: &f64| {
            let text = format!("{value:.decimals$}");
            let is_zero = text.chars().all(|letter| "-0.".contains(letter));
            grouped(if is_zero { text.trim_start_matches('-') } else { &text })
        };
        let tick_labels = match is_log {
            true => ticks.iter().map(|power| number((10_f64.powf(*power) * 1e9).round() / 1e9)).collect(),
            false => ticks.iter().map(tick_label).collect(),
        };
        Self { low, high, base, is_log, ticks, tick_labels, minor, label }
    }

    pub(super) fn place(&self, value: f64) -> f64 {
        if self.is_log { libm::log10(value) } else { value - self.base }
    }
}

impl Ranged for Plotted {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.low..self.high).map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { self.minor.clone() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Plotted {
    fn format(value: &f64) -> String {
        number(*value)
    }

    fn format_ext(&self, value: &f64) -> String {
        let place = self.ticks.iter().position(|tick| tick == value);
        place.and_then(|place| self.tick_labels.get(place)).cloned().unwrap_or_default()
    }
}

/// Returns the ticks of a logarithmic axis (powers of ten, with 2 and 5 if it has few decades) and its minor grid, as
/// logarithms.
fn decades(low: f64, high: f64) -> (Vec<f64>, Vec<f64>) {
    let powers = (low.floor() as i32)..=(high.ceil() as i32);
    let all = |digits: &[f64]| -> Vec<f64> {
        let values = powers.clone().flat_map(|power| digits.iter().map(move |digit| f64::from(power) + digit.log10()));
        values.filter(|value| (low - 1e-9..=high + 1e-9).contains(value)).collect()
    };
    let digits: &[f64] = if high - low < 3.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    (all(digits), all(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]))
}

//! Tests the content of a chart by its SVG.

use super::super::pen::Line;
use super::super::tests::texts;
use super::*;
use plotters::coord::ranged1d::Ranged;
use proptest::prelude::*;

fn axis(label: &str, low: f64, high: f64, spacing: Spacing) -> Axis {
    Axis { label: label.to_owned(), low, high, spacing }
}

fn panel() -> Panel {
    let curve = Curve {
        name: "now".to_owned(),
        look: LineStyle::New,
        points: (0..100).map(|k| (1.0 * 1.05_f64.powi(k), 20.0 - f64::from(k))).collect(),
    };
    Panel {
        across: axis("frequency (Hz)", 1.0, 100.0, Spacing::Decades),
        up: axis("gain (dB)", -40.0, 20.0, Spacing::Even),
        curves: vec![curve],
        pins: vec![MeasureMark { from: (10.0, 0.0), to: (10.0, -20.0), text: "20 dB".to_owned() }],
        level: Some(0.0),
        lines: vec!["crossover 3 Hz".to_owned()],
        height: 200.0,
        is_joined: false,
    }
}

fn chart(panels: Vec<Panel>) -> Chart {
    Chart { title: "axis x".to_owned(), panels, width: 1000 }
}

fn svg(chart: &Chart) -> String {
    String::from_utf8(draw_chart(chart, Target::Svg).unwrap()).unwrap()
}

#[test]
fn a_chart_has_title_labels_legend_and_lines() {
    let svg = svg(&chart(vec![panel()]));
    let texts = texts(&svg);
    for text in ["axis x", "frequency (Hz)", "gain (dB)", "now", "crossover 3 Hz", "10", "50", "20 dB", "\u{2212}20"] {
        assert!(texts.contains(&text), "`{text}` is not in {texts:?}");
    }
}

#[test]
fn a_joined_panel_has_no_label_of_its_own_below() {
    let svg = svg(&chart(vec![Panel { is_joined: true, ..panel() }, panel()]));
    assert_eq!(svg.matches("frequency (Hz)").count(), 1);
    assert_eq!(svg.matches("gain (dB)").count(), 2);
}

#[test]
fn a_logarithmic_axis_has_its_middle_at_the_root() {
    let plotted = Plotted::new(&axis("", 1.0, 100.0, Spacing::Decades), 8.0);
    for (value, place) in [(1.0, 0), (10.0, 500), (100.0, 1000)] {
        assert!((plotted.map(&plotted.place(value), (0, 1000)) - place).abs() <= 1, "{value}");
    }
    assert_eq!(plotted.tick_labels, ["1", "2", "5", "10", "20", "50", "100"]);
}

#[test]
fn ticks_have_the_digits_of_their_step() {
    let labels = |low, high| Plotted::new(&axis("", low, high, Spacing::Even), 6.0).tick_labels;
    assert_eq!(labels(0.0, 7.0), ["0", "2", "4", "6"]);
    assert_eq!(labels(-0.31, 0.31), ["\u{2212}0.2", "0.0", "0.2"]);
    assert_eq!(labels(0.0, 0.05), ["0.00", "0.01", "0.02", "0.03", "0.04", "0.05"]);
    let steps = Plotted::new(&axis("", -230.0, -10.0, Spacing::Steps(45.0)), 6.0).tick_labels;
    assert_eq!(steps, ["\u{2212}225", "\u{2212}180", "\u{2212}135", "\u{2212}90", "\u{2212}45"]);
}

#[test]
fn a_small_change_of_a_large_value_is_counted_from_a_base() {
    let plotted = Plotted::new(&axis("time (s)", 1.7e9, 1.7e9 + 4.0, Spacing::Even), 5.0);
    assert_eq!(plotted.label, "time (s), from 1\u{2009}700\u{2009}000\u{2009}000 on");
    assert_eq!(plotted.tick_labels, ["0", "1", "2", "3", "4"]);
}

#[test]
fn a_curve_is_cut_at_the_edges() {
    let points = [(0.0, 0.0), (1.0, 20.0), (2.0, 20.0), (3.0, -20.0), (4.0, 0.0)];
    let cut = clip(&points, &axis("", 0.0, 4.0, Spacing::Even), &axis("", -10.0, 10.0, Spacing::Even));
    let seen: Vec<(f64, f64)> = cut.iter().copied().filter(|(_, y)| y.is_finite()).collect();
    assert_eq!(seen, [(0.0, 0.0), (0.5, 10.0), (2.25, 10.0), (2.75, -10.0), (3.5, -10.0), (4.0, 0.0)]);
    let gaps = cut.iter().filter(|(_, y)| y.is_nan()).count();
    assert!(gaps >= 2, "{cut:?}");
}

#[test]
fn each_curve_of_a_panel_has_its_own_colour_and_dash() {
    let looks: Vec<Line> = (0..42).map(|place| LineStyle::Signal(place).line()).collect();
    for (place, look) in looks.iter().enumerate() {
        let same = |other: &Line| (other.0, other.2) == (look.0, look.2);
        assert!(!looks[..place].iter().any(same), "{place}");
        // The first curve is visible through the gaps of the others.
        assert!(place == 0 || look.2.is_some_and(|(_, gap)| gap >= 3.0) && look.1 < looks[0].1, "{place}");
    }
    for (place, look) in looks[1..7].iter().enumerate() {
        assert!(looks[1..=place].iter().all(|other| other.2 != look.2 && other.0 != look.0), "{place}");
    }
}

#[test]
fn noise_makes_no_flood_of_dashes() {
    let points = (0..4000).map(|n| (f64::from(n) / 40.0, f64::from(n % 2) * 60.0 - 40.0)).collect();
    let curve = Curve { name: String::new(), look: LineStyle::Signal(1), points };
    let across = axis("", 0.0, 100.0, Spacing::Even);
    let svg = svg(&chart(vec![Panel { across, curves: vec![curve], ..panel() }]));
    assert!(svg.matches("<polyline").count() < 200);
}

#[test]
fn sizes_out_of_range_are_refused() {
    let narrow = Chart { width: 100, ..chart(vec![panel()]) };
    assert_eq!(draw_chart(&narrow, Target::Svg).unwrap_err(), Problem::Width { given: 100 });
    let high = chart(vec![Panel { height: 30_000.0, ..panel() }]);
    assert!(matches!(draw_chart(&high, Target::Svg), Err(Problem::High { .. })));
}

proptest! {
    #[test]
    fn a_cut_curve_lies_within(points in prop::collection::vec((0.0..1.0, -100.0..100.0), 0..40)) {
        let cut = clip(&points, &axis("", 0.0, 1.0, Spacing::Even), &axis("", -10.0, 10.0, Spacing::Even));
        prop_assert!(cut.iter().all(|(_, y)| y.is_nan() || (-10.0..=10.0).contains(y)), "{:?}", cut);
    }
}

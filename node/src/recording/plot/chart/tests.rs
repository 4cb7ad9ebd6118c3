//! What a chart shows, by its SVG and by the places of its texts.

use super::*;
use proptest::prelude::*;

fn axis(label: &str, low: f64, high: f64, spacing: Spacing) -> Axis {
    Axis { label: label.to_owned(), low, high, spacing }
}

fn sheet() -> Sheet {
    let curve = Curve {
        name: "now".to_owned(),
        look: Look::New,
        points: (0..100).map(|k| (1.0 * 1.05_f64.powi(k), 20.0 - f64::from(k))).collect(),
    };
    Sheet {
        across: axis("frequency (Hz)", 1.0, 100.0, Spacing::Decades),
        up: axis("gain (dB)", -40.0, 20.0, Spacing::Even),
        curves: vec![curve],
        pins: Vec::new(),
        level: Some(0.0),
        lines: vec!["crossover 3 Hz".to_owned()],
        height: 200.0,
        is_joined: false,
    }
}

fn chart(sheets: Vec<Sheet>) -> Chart {
    Chart { title: "axis x".to_owned(), sheets, width: 1000 }
}

#[test]
fn a_chart_has_title_labels_legend_and_lines() {
    let svg = String::from_utf8(draw_chart(&chart(vec![sheet()]), Target::Svg).unwrap()).unwrap();
    for text in ["axis x", "frequency (Hz)", "gain (dB)", "now", "crossover 3 Hz", "\n10\n", "\n50\n"] {
        assert!(svg.contains(text), "`{text}` is not in {svg}");
    }
}

#[test]
fn a_panel_that_is_joined_has_no_axis_of_its_own() {
    let upper = Sheet { is_joined: true, ..sheet() };
    let svg = String::from_utf8(draw_chart(&chart(vec![upper, sheet()]), Target::Svg).unwrap()).unwrap();
    assert_eq!(svg.matches("frequency (Hz)").count(), 1);
    assert_eq!(svg.matches("gain (dB)").count(), 2);
}

#[test]
fn a_logarithmic_axis_has_its_middle_at_the_root() {
    let axis = axis("", 1.0, 100.0, Spacing::Decades);
    for (value, part) in [(1.0, 0.0), (10.0, 0.5), (100.0, 1.0)] {
        assert!((axis.part(value) - part).abs() < 1e-12, "{value}");
    }
}

#[test]
fn a_curve_is_cut_at_the_edges() {
    let points = [(0.0, 0.0), (1.0, 20.0), (2.0, 20.0), (3.0, -20.0), (4.0, 0.0)];
    let cut = cut(points.into_iter(), -10.0, 10.0);
    let seen: Vec<(f64, f64)> = cut.iter().copied().filter(|(_, y)| y.is_finite()).collect();
    assert_eq!(seen, [(0.0, 0.0), (0.5, 10.0), (2.25, 10.0), (2.75, -10.0), (3.5, -10.0), (4.0, 0.0)]);
    let gaps = cut.iter().filter(|(_, y)| y.is_nan()).count();
    assert!(gaps >= 2, "{cut:?}");
}

#[test]
fn odd_sizes_are_refused() {
    let narrow = Chart { width: 100, ..chart(vec![sheet()]) };
    assert_eq!(draw_chart(&narrow, Target::Svg).unwrap_err(), Problem::Width { given: 100 });
    let high = chart(vec![Sheet { height: 30_000.0, ..sheet() }]);
    assert!(matches!(draw_chart(&high, Target::Svg), Err(Problem::High { .. })));
}

proptest! {
    /// No text of a pin stands on another one, or beyond the panel.
    #[test]
    fn texts_of_pins_have_room(ends in prop::collection::vec((1.0..100.0, -40.0..20.0, -40.0..20.0), 0..6)) {
        let sheet = sheet();
        let room = Room { left: LEFT, top: 50.0, right: 768.0, end: 250.0 };
        let placed = Placed { sheet: &sheet, room };
        let mut taken: Vec<Room> = Vec::new();
        for (x, from, to) in ends {
            let found = placed.beside(placed.at((x, from)), placed.at((x, to)), 60.0, &taken);
            if let Some(found) = found {
                prop_assert!(room.holds(&found));
                prop_assert!(!taken.iter().any(|other| other.meets(&found)));
                taken.push(found);
            }
        }
    }

    #[test]
    fn what_is_cut_lies_within(points in prop::collection::vec((0.0..1.0, -100.0..100.0), 0..40)) {
        let cut = cut(points.into_iter(), -10.0, 10.0);
        prop_assert!(cut.iter().all(|(_, y)| y.is_nan() || (-10.0..=10.0).contains(y)), "{:?}", cut);
    }
}

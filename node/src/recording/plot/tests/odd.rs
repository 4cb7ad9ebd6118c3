//! Tests that any content of a file gives a figure or an error message.

use super::{figure, mark, series};
use crate::recording::plot::{Figure, HEIGHTS, Target, WIDTHS, draw};
use crate::recording::series::{Kind, Series};
use proptest::prelude::*;

fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e3..1e3,
        1 => any::<f64>(),
        1 => Just(f64::NAN),
        1 => Just(0.0),
        1 => (-1.0..1.0).prop_map(|part| 1e9 + part),
        1 => Just(f64::MAX),
        1 => Just(f64::MIN_POSITIVE),
    ]
}

fn kind() -> impl Strategy<Value = Kind> {
    let names = prop::collection::vec("[A-Z_]{0,30}", 0..5);
    prop_oneof![
        Just(Kind::Real),
        Just(Kind::Int),
        Just(Kind::Bit),
        Just(Kind::Word),
        Just(Kind::Code),
        names.prop_map(Kind::Enum)
    ]
}

fn signal() -> impl Strategy<Value = Series> {
    let points = prop::collection::vec((prop_oneof![8 => 0.0..10.0, 1 => value()], value()), 0..60);
    let gaps = prop::collection::vec((0.0..10.0, 0.0..2.0), 0..4);
    ("[a-z.<&\u{0}\u{4e00}]{0,60}", "[a-z/^23<]{0,8}", kind(), points, gaps, any::<bool>()).prop_map(
        |(name, unit, kind, mut points, gaps, is_sorted)| {
            if is_sorted {
                points.sort_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
            }
            let gaps = gaps.into_iter().map(|(from, length)| (from, from + length)).collect();
            Series { gaps, ..series(&name, &unit, kind, points) }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn odd_data_makes_a_figure_or_a_sentence(
        signals in prop::collection::vec(signal(), 0..8),
        marks in prop::collection::vec((value(), any::<u8>(), "[a-z]{0,9}", ".{0,300}"), 0..30),
        edges in (proptest::option::of(value()), proptest::option::of(value())),
        size in (WIDTHS.0 - 1..1500, proptest::option::of(HEIGHTS.0 - 1..1500)),
        by_name in any::<bool>(),
    ) {
        let marks: Vec<_> = marks.iter().map(|(time, severity, kind, text)| mark(*time, *severity, kind, text)).collect();
        let mut figure = Figure { from: edges.0, to: edges.1, width: size.0, height: size.1, ..figure(&signals, &marks) };
        figure.signals.iter_mut().for_each(|chosen| chosen.by_name = by_name);
        match draw(&figure, Target::Svg) {
            Ok(bytes) => {
                let text = String::from_utf8(bytes).unwrap();
                prop_assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
                // NaN or a value beyond i32 would be drawn at one of the ends of i32.
                prop_assert!(!text.contains("2147483647") && !text.contains("-2147483648"));
                prop_assert!(!text.contains('\0'));
                if size.0 % 8 == 0 {
                    prop_assert!(draw(&figure, Target::Png).is_ok());
                }
            }
            Err(problem) => prop_assert!(problem.to_string().len() > 10),
        }
    }
}

/// Tests the edge cases.
#[test]
fn single_points_constants_and_far_values_are_drawn() {
    for points in [
        vec![(1.0, 5.0)],
        vec![(1.0, 5.0), (1.0, 6.0)],
        vec![(0.0, 0.0), (1.0, 0.0)],
        vec![(0.0, 1e9 - 1.0), (1.0, 1e9 + 1.0)],
        vec![(0.0, -1e-12), (1.0, 1e-12)],
        vec![(0.0, 1e-201), (1.0, 2e-201)],
        vec![(0.0, 1e200), (1.0, 2e200)],
        vec![(-5.0, -1e15), (-4.0, -1e15 + 1.0)],
        vec![(1.7e9, 1.0), (1.7e9 + 1e-6, 2.0)],
        vec![(0.0, f64::NAN), (1.0, 2.0), (2.0, f64::NAN)],
    ] {
        for kind in [Kind::Real, Kind::Int, Kind::Bit, Kind::Word] {
            let signals = [series("x.actual.position", "mm", kind, points.clone())];
            let mut figure = figure(&signals, &[]);
            figure.signals[0].by_name = true;
            for target in [Target::Svg, Target::Png] {
                assert!(draw(&figure, target).is_ok(), "{points:?}");
            }
        }
    }
}

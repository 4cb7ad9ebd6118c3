//! Comparison with the formulas of the spec in fractions, and laws for all sets and inputs.

use super::*;
use crate::unit::Fraction;
use proptest::prelude::*;

/// A set that starts, its points, and whether they are words.
fn sets() -> impl Strategy<Value = (Vec<(&'static str, i64)>, Vec<i64>, bool)> {
    let word = || prop_oneof![-5_i64..6, -32_767_i64..=32_767];
    let divisor = || prop_oneof![1_i64..6, 1_i64..=32_767];
    let point = || prop_oneof![-3_i64..4, -5000_i64..5000, -32_767_i64..=32_767];
    let modes = (0_i64..8, 0_i64..2, 0_i64..2, 0_i64..2, any::<bool>());
    let numbers = (divisor(), word(), 1_i64..=65_535, divisor(), 0_i64..=32_767, -32_767_i64..=0);
    (modes, numbers, (word(), word(), divisor()), prop::collection::vec(point(), 2..128)).prop_map(
        |((ba, active, low, high, is_words), (div, mult, res, last, most, least), (a, b, ratio_div), points)| {
            let (ratio_min, ratio_max) = if a == b { (a.min(32_766), a.min(32_766) + 1) } else { (a.min(b), a.max(b)) };
            let values = vec![
                ("ba", ba),
                ("table_count", 1),
                ("active_table", active),
                ("div", div),
                ("mult", mult),
                ("in_resolution", res),
                ("in_final", last),
                ("out_max", most),
                ("out_min", least),
                ("ratio_max", ratio_max),
                ("ratio_min", ratio_min),
                ("ratio_div", ratio_div),
                ("cont_low", low * 2),
                ("cont_high", high),
            ];
            (values, points, is_words)
        },
    )
}

/// Returns the output of a set at a speed in 0.0001 rpm, and its status, by the formulas of the spec in their order.
fn by_the_book(values: &[(&'static str, i64)], points: &[i64], n: Fraction) -> (i64, i64) {
    let get = |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0, |(_, value)| *value);
    let whole = |value: i64| Fraction::from_integer(value.into());
    let rpm = n / whole(RPM);
    let (last, end) = (whole(points[points.len() - 1]), whole(get("in_final")));
    let step = end / whole(points.len() as i64 - 1);
    let inside = |n: Fraction| {
        let i = ((n / step).floor().to_integer() as usize).min(points.len() - 2);
        let (from, to) = (whole(points[i]), whole(points[i + 1]));
        from + (to - from) * (n - whole(i as i64) * step) / step
    };
    let above = |n: Fraction| {
        let before = whole(points[points.len() - 2]);
        if n <= end {
            inside(n)
        } else if get("cont_high") == 1 {
            last + (last - before) * (n - end) / step
        } else {
            last
        }
    };
    let zero = whole(0);
    let t = match (get("active_table"), rpm < zero, get("cont_low")) {
        (0, ..) => rpm,
        (_, false, _) => above(rpm),
        (_, true, 0) => whole(points[0]),
        _ => -above(-rpm),
    };
    let mut y = t * whole(get("mult")) / whole(get("div"));
    if get("ba") & 4 != 0 && get("active_table") != 0 {
        y /= last / end;
    }
    let of_input = |name| rpm * whole(get(name)) / whole(get("ratio_div"));
    let (a, b) = (of_input("ratio_min"), of_input("ratio_max"));
    let geared = y.clamp(a.min(b), a.max(b));
    let sink = geared.clamp(whole(get("out_min")), whole(get("out_max")));
    let [y_cut, geared_cut, sink_cut] = [y, geared, sink].map(|y| (y * whole(RPM)).trunc().to_integer());
    let ratio_over = if rpm < zero { y < b } else { y > b };
    let has_table = get("active_table") != 0;
    let bits = [
        geared_cut != y_cut && ratio_over,
        geared_cut != y_cut && !ratio_over,
        sink_cut < geared_cut,
        sink_cut > geared_cut,
        has_table && rpm > end,
        has_table && rpm < zero,
    ];
    (sink_cut as i64, (0_u32..).zip(bits).map(|(nth, bit)| i64::from(bit) << nth).sum())
}

proptest! {
    /// Proves: AMK-DFKT-26, AMK-DFKT-27, AMK-DFKT-28, AMK-DFKT-29, AMK-DFKT-30, AMK-DFKT-31, AMK-DFKT-32, AMK-DFKT-33, AMK-DFKT-34
    #[test]
    fn every_output_equals_spec_and_is_within_limits(
        (values, points, is_words) in sets(),
        inputs in prop::collection::vec(prop_oneof![-3_i64..4, -2_000_000_i64..2_000_000, -2_147_483_648_i64..2_147_483_648], 1..20),
        call_ns in prop::sample::select(vec![125_000_u64, 1_000_000, 1_333_333, 20_000_000]),
    ) {
        let mut bench = Bench::new(&[if is_words { words(&points) } else { y(&points) }], &values);
        bench.call_ns = call_ns;
        prop_assume!(bench.refused(&[]).is_none());
        let get = |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0, |(_, value)| *value);
        bench.start(0, E1);
        for input in inputs {
            let n = if get("ba") & 1 == 1 {
                // Travel of 16 bits.
                let way = input % 32_768;
                bench.travel += way;
                Fraction::new(i128::from(way) * 600_000_000_000_000, i128::from(get("in_resolution")) * i128::from(call_ns))
            } else {
                Fraction::from_integer(input.into())
            };
            let (given, _) = bench.step(input, E1);
            let told = (given, bench.status());
            prop_assert_eq!(told, by_the_book(&values, &points, n), "{} {:?}", n, bench.dfkt);
            prop_assert!((get("out_min") * RPM..=get("out_max") * RPM).contains(&given));
            // The output is within the ratio limits, unless out_min and out_max limit it further; they always allow 0.
            let of = |name| n * Fraction::new(get(name).into(), get("ratio_div").into());
            let (a, b) = (of("ratio_min"), of("ratio_max"));
            let bounds = (a.min(b).floor().to_integer(), a.max(b).ceil().to_integer());
            let is_cut = given == get("out_min") * RPM || given == get("out_max") * RPM;
            prop_assert!(is_cut || (bounds.0..=bounds.1).contains(&given.into()), "{given} {bounds:?}");
        }
    }

    /// Proves: AMK-DFKT-28
    #[test]
    fn a_rising_table_makes_a_faster_master_no_slower_slave(
        rises in prop::collection::vec(0_i64..250, 2..100),
        last in 1_i64..=32_767,
        high in 0_i64..2,
        mut inputs in prop::collection::vec(-400_000_000_i64..400_000_000, 2..20),
    ) {
        let mut points = vec![0];
        rises.iter().for_each(|rise| points.push(points[points.len() - 1] + rise));
        let mut bench = free(&[y(&points)], &[("in_final", last), ("cont_low", 2), ("cont_high", high)]);
        bench.start(0, 0);
        inputs.sort_unstable();
        let outputs: Vec<i64> = inputs.iter().map(|n| bench.step(*n, 0).0).collect();
        prop_assert!(outputs.is_sorted(), "{inputs:?} {outputs:?}");
    }

    /// Proves: AMK-DFKT-30
    #[test]
    fn a_mirrored_table_mirrors_each_unit((mut values, points, _) in sets(), n in 1_i64..2_147_483_648) {
        let most = values.iter().find(|(name, _)| *name == "out_max").map_or(0, |(_, value)| *value);
        values.retain(|(name, _)| !["ba", "cont_low", "out_min"].contains(name));
        values.extend([("ba", 0), ("cont_low", 2), ("out_min", -most)]);
        let mut bench = Bench::new(&[y(&points)], &values);
        bench.start(0, 0);
        prop_assert_eq!(bench.step(n, 0).0, -bench.step(-n, 0).0);
    }

    /// Any input is handled without a panic, and the resulting state is valid.
    #[test]
    fn no_master_and_no_input_is_too_much(
        (values, points, _) in sets(),
        calls in prop::collection::vec((any::<i64>(), any::<i64>(), any::<u8>()), 1..40),
        call_ns in prop_oneof![Just(1), Just(u64::MAX), 1_u64..10_000_000_000],
    ) {
        let mut bench = Bench::new(&[y(&points), y(&[0, 5])], &values);
        bench.call_ns = call_ns;
        prop_assume!(bench.refused(&[]).is_none());
        bench.start(i64::MIN, 0);
        for (value, travel, inputs) in calls {
            bench.travel = travel;
            let (sink, _) = bench.step(value, inputs);
            prop_assert!(sink.abs() <= WORD * RPM);
        }
    }
}

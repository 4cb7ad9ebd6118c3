//! Laws that hold for every set and every motion of the master.

use super::*;

/// Values of a set of movement that any master may run.
fn sets() -> impl Strategy<Value = (Vec<Arc<Table>>, Vec<(&'static str, i64)>)> {
    let steps = || proptest::collection::vec(-900_i64..900, 1..6);
    let table = steps().prop_map(|steps| {
        let mut points = vec![0];
        steps.iter().for_each(|step| points.push(points[points.len() - 1] + step));
        y(&points)
    });
    (
        proptest::collection::vec(table, 3),
        prop::sample::select(vec![2_i64, 26, 82, 98]),
        (50_i64..90, 0_i64..3, -5_i64..6, 0_i64..4),
        (0_i64..50, 0_i64..50),
    )
        .prop_map(|(tables, mode, (length, starts, mult, div_exp), (start, stop))| {
            let mut values = vec![("mode", mode), ("mult", mult), ("div_exp", div_exp), ("increments_per_rev", length)];
            let several = mode == 82 || mode == 98;
            values.push(("table_count", if several { 3 } else { 1 }));
            if mode == 98 {
                values.extend([("start_tables", starts), ("stop_angle", stop)]);
            }
            if mode != 26 {
                values.push(("start_angle", start));
            }
            (tables, values)
        })
}

proptest! {
    /// A step of the master has the same result as its single increments, as long as E1 does not change; windows larger
    /// than 0 are excluded.
    #[test]
    fn steps_of_any_size_end_at_the_same_place(
        (tables, mut values) in sets(),
        calls in proptest::collection::vec((-400_i64..400, any::<bool>()), 1..30),
    ) {
        for (name, value) in &mut values {
            if name.ends_with("_angle") {
                *value = 0;
            }
        }
        let (mut far, mut near) = (fipw(&tables), fipw(&tables));
        far.start(&values, 0);
        near.start(&values, 0);
        for (way, e1) in calls {
            let e1 = u8::from(e1);
            // Inputs change while the master is at rest.
            prop_assert_eq!(far.step(0, e1), near.step(0, e1));
            // A movement that ends and waits for a start rests at another position in the middle of a step: it is
            // compared in positive direction.
            let way = way.abs();
            let out = far.step(way, e1);
            let mut last = near.step(0, e1);
            for _ in 0..way {
                last = near.step(1, e1);
            }
            prop_assert_eq!((out.sink, out.outputs), (last.sink, last.outputs), "{:?} {:?}", far.function, near.function);
        }
    }

    /// After any motion of the master inside a movement, the same motion back ends at the same position.
    #[test]
    fn master_moving_back_retraces_path(
        (tables, values) in sets(),
        ways in proptest::collection::vec(-300_i64..300, 1..20),
    ) {
        let mut bench = fipw(&tables);
        bench.start(&values, 0);
        bench.step(0, 1);
        for way in ways {
            let before = (bench.sink, bench.step(0, 1).outputs);
            if bench.step(way, 1).outputs == before.1 && before.1 == 0 {
                let there = bench.sink;
                bench.step(-way, 1);
                prop_assert_eq!(bench.sink, before.0);
                bench.step(way, 1);
                prop_assert_eq!(bench.sink, there);
            }
        }
    }

    /// Any input is handled without a panic, and the resulting state is valid.
    #[test]
    fn no_master_and_no_input_is_too_much(
        (tables, values) in sets(),
        calls in proptest::collection::vec((any::<i64>(), any::<u8>(), proptest::option::of(any::<i64>())), 1..40),
    ) {
        let mut bench = fipw(&tables);
        bench.start(&values, 0);
        for (travel, inputs, mark) in calls {
            bench.travel = travel;
            bench.function.step(&bench.seen(inputs, mark));
            prop_assert!(bench.function.is_valid_state());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Over a million periods, in steps that fit no period, with sets that inputs change, the travel of the slave is
    /// the sum of the ends of the tables.
    #[test]
    fn a_million_periods_lose_nothing(
        ends in proptest::collection::vec(-32_767_i64..=32_767, 3),
        (mult, div_exp) in (-32_768_i64..=32_767, 0_i64..16),
        (length, step) in (50_i64..32_768, 1_i64..300),
    ) {
        let tables: Vec<Arc<Table>> = ends.iter().map(|end| y(&[0, end / 2, *end])).collect();
        let mut bench = xfipw(&tables);
        let fits = ends.iter().all(|end| (end.abs() * mult.abs()) >> div_exp < (1 << 31) - 1);
        prop_assume!(fits);
        bench.start(&extended(3, &[("incr_per_rev", length), ("mult", mult), ("div_exp", div_exp)]), 0);
        let (mut sum, mut set, mut periods) = (0_i128, 0_usize, 0_i64);
        while periods < 1_000_000 {
            let wanted = (periods / 7 % 4) as usize;
            let inputs = if wanted < 3 { 1 | (wanted as u8) << 1 } else { 0 };
            // To a zero, by that many periods; the set changes at the first of them.
            bench.step(step * length, inputs);
            let first = set;
            set = if wanted < 3 { wanted } else { set };
            sum += i128::from(ends[first]) + i128::from(ends[set]) * i128::from(step - 1);
            periods += step;
            let exact = (sum * i128::from(mult)).div_euclid(1 << div_exp);
            prop_assert_eq!(i128::from(bench.sink), exact, "after {} periods", periods);
        }
        // All the way back with the last set.
        bench.step(-step * length, 0);
        let exact = ((sum - i128::from(ends[set]) * i128::from(step)) * i128::from(mult)).div_euclid(1 << div_exp);
        prop_assert_eq!(i128::from(bench.sink), exact);
    }
}

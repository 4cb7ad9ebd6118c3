//! Binary inputs: run and stop, the strobe, and values that wait for it.

use super::*;

/// Half, whole and double speed at 1000 rpm, selected by inputs.
fn chosen(more: &[(&'static str, i64)]) -> Bench {
    let tables = [y(&[0, 500]), y(&[0, 1000]), y(&[0, 2000]), y(&[0, 4000]), y(&[0, 8000])];
    let values = [("ba", 2), ("table_count", 3)];
    free(&tables, &values.iter().chain(more).copied().collect::<Vec<_>>())
}

const N: i64 = 1000 * RPM;

/// Proves: AMK-DFKT-08, AMK-DFKT-35, AMK-DFKT-36, AMK-DFKT-40, AMK-DFKT-46, AMK-DFKT-47
#[test]
fn e1_runs_and_stops_at_once() {
    let mut bench = chosen(&[]);
    assert_eq!(bench.start(N, 0), (0, A1, A1 | A2));
    assert_eq!(bench.step(N, 0), (0, A1));
    assert_eq!(bench.step(N, E1), (500 * RPM, 0));
    assert_eq!(bench.step(N, E1), (500 * RPM, 0));
    assert_eq!(bench.step(N, 0), (0, A1));
    // E1 acts by level: if it is 1 at START, the function runs.
    assert_eq!(chosen(&[]).start(N, E1), (500 * RPM, 0, A1 | A2));
    // Travel while it is stopped does not count as speed in the call in which it runs again.
    let mut bench = free(&[], &[("ba", 3), ("in_resolution", 20_000), ("active_table", 0)]);
    bench.start(0, E1);
    bench.travel = 9000;
    assert_eq!(bench.step(0, 0), (0, A1));
    bench.travel = 9100;
    assert_eq!(bench.step(0, E1), (1_500_000, 0));
}

/// Proves: AMK-DFKT-37, AMK-DFKT-38, AMK-DFKT-41, AMK-DFKT-45, AMK-DFKT-48, AMK-DFKT-49
#[test]
fn a_rising_e2_chooses_the_table_in_its_call() {
    let mut bench = chosen(&[("table_count", 5)]);
    // A strobe that is 1 at START is no edge.
    assert_eq!(bench.start(N, E1 | E2 | E4), (500 * RPM, 0, A1 | A2));
    assert_eq!(bench.step(N, E1 | E2 | E4), (500 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E4), (500 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E4), (1000 * RPM, A2));
    // The code is read at the edge only.
    assert_eq!(bench.step(N, E1 | E2 | E3), (1000 * RPM, A2));
    assert_eq!(bench.step(N, E1 | E3), (1000 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E3 | E4), (2000 * RPM, A2));
    assert_eq!(bench.step(N, E1 | E5), (2000 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E5), (4000 * RPM, A2));
    assert_eq!(bench.step(N, E1), (4000 * RPM, 0));
    // Code 0 selects no table; the code is read while it is stopped as well.
    assert_eq!(bench.step(N, E1 | E2), (1000 * RPM, A2));
    assert_eq!(bench.step(N, 0), (0, A1));
    assert_eq!(bench.step(N, E2 | E3 | E5), (0, A1 | A2));
    assert_eq!(bench.step(N, E1 | E2), (8000 * RPM, A2));
}

/// Proves: AMK-DFKT-39
#[test]
fn with_three_tables_e5_is_0() {
    let mut bench = chosen(&[("table_count", 3)]);
    bench.start(N, E1);
    assert_eq!(bench.step(N, E1 | E2 | E4 | E5), (1000 * RPM, A2));
    let mut bench = chosen(&[("table_count", 4)]);
    bench.start(N, E1);
    assert_eq!(bench.step(N, E1 | E2 | E5), (4000 * RPM, A2));
}

/// Proves: AMK-DFKT-12, AMK-DFKT-13, AMK-DFKT-43, AMK-DFKT-44, AMK-DFKT-50
#[test]
fn a_new_ratio_waits_for_the_strobe() {
    let mut bench = chosen(&[]);
    bench.start(N, E1);
    // active_table is ignored; the limits apply at once.
    bench.value_new(&[("mult", 3), ("div", 2), ("active_table", 7)]);
    assert_eq!(bench.step(N, E1), (500 * RPM, 0));
    bench.value_new(&[("out_max", 400)]);
    assert_eq!(bench.step(N, E1), (400 * RPM, 0));
    bench.value_new(&[("out_max", 32_767)]);
    // The strobe also reads the code: the present code keeps the table.
    assert_eq!(bench.step(N, E1 | E2 | E3), (750 * RPM, A2));
    assert_eq!(bench.step(N, E1), (750 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E4), (1500 * RPM, A2));
}

/// Numerator, denominator and number of the table; waiting values are not active.
/// Proves: AMK-DFKT-53, AMK-DFKT-54
#[test]
fn ratio_and_table_in_force_are_shown() {
    let mut bench = chosen(&[]);
    bench.start(N, E1);
    assert_eq!(bench.in_force(), [1, 1, 1]);
    bench.value_new(&[("mult", -3), ("div", 2), ("out_min", -400)]);
    bench.step(N, E1);
    assert_eq!((bench.in_force(), bench.status()), (&[1, 1, 1][..], 0));
    bench.step(N, E1 | E2 | E4);
    assert_eq!((bench.in_force(), bench.status()), (&[-3, 2, 2][..], 8));
    // While it is stopped no limit applies.
    bench.step(N, 0);
    assert_eq!((bench.in_force(), bench.status()), (&[-3, 2, 2][..], 0));
    bench.step(N, E2);
    assert_eq!(bench.in_force(), [-3, 2, 0]);
}

/// Proves: AMK-DFKT-38, AMK-DFKT-48
#[test]
fn a_strobe_for_a_table_that_is_not_there_does_nothing() {
    let mut bench = chosen(&[("table_count", 5), ("ba", 6)]);
    bench.tables[3] = y(&[5, 0]);
    bench.places[4] = None;
    bench.start(N, E1);
    bench.value_new(&[("mult", 2)]);
    // Codes beyond table_count, of a missing table, and of a table whose ratio would be to 0 (D10, D11): V stays 1 / 1.
    for code in [E3 | E4 | E5, E3 | E5, E5] {
        assert_eq!(bench.step(N, E1 | E2 | code), (N, 0), "{code}");
        assert_eq!(bench.step(N, E1), (N, 0));
    }
    assert_eq!(bench.step(N, E1 | E2 | E4), (2 * N, A2));
}

/// Proves: AMK-DFKT-11, AMK-DFKT-42
#[test]
fn without_inputs_it_runs_at_once_and_takes_values_at_once() {
    let mut bench = chosen(&[("ba", 0)]);
    assert_eq!(bench.start(N, 0), (500 * RPM, 0, 0));
    assert_eq!(bench.step(N, E2 | E4), (500 * RPM, 0));
    bench.value_new(&[("mult", 3), ("active_table", 2)]);
    assert_eq!(bench.step(N, 0), (3000 * RPM, 0));
    bench.value_new(&[("active_table", 0), ("in_final", 500)]);
    assert_eq!(bench.step(N, 0), (3000 * RPM, 0));
    let fault = bench.asked(&[("active_table", 4)], true, Occasion::Order).expect_err("three tables count");
    assert_eq!(fault.code, Code::AMK_BEYOND);
}

/// Proves: AMK-DFKT-13, AMK-DFKT-43
#[test]
fn a_new_ratio_is_judged_by_the_table_that_runs() {
    let mut bench = chosen(&[("ba", 6)]);
    bench.start(N, E1);
    // With half speed 32767 is allowed; with the double speed that a strobe selected, half of it.
    bench.value_new(&[("mult", 32_767)]);
    bench.step(N, E1 | E2 | E3 | E4);
    let kept = bench.asked(&[], true, Occasion::Kept);
    assert!(kept.is_ok(), "what a strobe has made goes on: {kept:?}");
    let fault = bench.clone().asked(&[("mult", 16_384)], true, Occasion::Order).expect_err("too large");
    assert_eq!((fault.code, fault.limit), (Code::AMK_BEYOND, Number::Count(16_383)));
    bench.value_new(&[("mult", 16_383)]);
}

/// Proves: AMK-DFKT-25
#[test]
fn the_table_that_runs_gets_no_new_numbers() {
    let edit = |bench: &Bench, place: u8, runs| bench.clone().asked(&[], runs, Occasion::Edit(1 << place)).err();
    let mut bench = chosen(&[]);
    let used = |place| Some(Fault::new(Code::AMK_TABLE_IN_USE).with(place, 0));
    // In the cycle of START the new set applies.
    assert_eq!((edit(&bench, 0, false), edit(&bench, 1, false)), (used(0), None));
    bench.start(N, 0);
    bench.step(N, E2 | E4);
    assert_eq!((edit(&bench, 0, true), edit(&bench, 1, true)), (None, used(1)));
    // New numbers must be valid speeds.
    bench.tables[0] = y(&[0, 40_000]);
    assert_eq!(edit(&bench, 0, true).map(|fault| fault.code), Some(Code::AMK_SPEED_POINT));
    bench.step(N, 0);
    bench.step(N, E2);
    bench.tables[0] = y(&[0, 500]);
    assert_eq!([0, 1, 2].map(|place| edit(&bench, place, true)), [None; 3]);
}

//! Orders relative to a reference: search for the zero pulse, the end after it, and the permitted cycles.

use super::*;
use crate::event::Number;

/// Without bit 2: at full speed it steps to the end 100 inc after the reference, without a ramp. With bit 2: 122.7
/// beyond, and back.
///
/// Proves: AMK-EPOS-04, AMK-EPOS-16, AMK-EPOS-17, AMK-EPOS-37, AMK-EPOS-39, AMK-EPOS-40, AMK-EPOS-41, AMK-EPOS-O4
#[test]
fn end_before_reference_causes_step_or_reversal() {
    for sense in [1, -1] {
        let mut bench = started(&[("ba", 2), ("travel", 100 * sense), ("velocity", 1_000_000 * sense)]);
        bench.run(E1, 200);
        assert_eq!((bench.epos.shown(), bench.sink.signum()), (&[0][..], sense));
        // The command is 20 inc and a fraction beyond the pulse: 53, 86, 100.
        let mut places = vec![bench.mark(0, 20 * sense).0 * sense];
        assert_eq!(bench.epos.shown(), [100 * sense - bench.sink]);
        places.push(bench.step(0).0 * sense);
        assert!((52..=54).contains(&places[0]) && (85..=87).contains(&places[1]), "{places:?}");
        assert_eq!(bench.step(0), (100 * sense, A1));
        assert_eq!(bench.epos.velocity, 0);
        let mut bench = started(&[("ba", 6), ("travel", 100 * sense), ("velocity", 1_000_000 * sense)]);
        bench.run(E1, 200);
        let first = bench.mark(0, 20 * sense).0 * sense;
        assert!((48..=50).contains(&first), "on its ramp down at once");
        let peak = (0..30).map(|_| bench.step(0).0 * sense).max().expect("calls");
        assert!((141..=144).contains(&peak), "20 and a fraction, 122.7 on: {peak}");
        bench.until_rest(0);
        assert_eq!(bench.sink, 100 * sense);
    }
}

/// Proves: AMK-EPOS-04, AMK-EPOS-39, AMK-EPOS-42, AMK-EPOS-O4
#[test]
fn far_end_is_reached_by_ramp_and_order_is_not_extended() {
    let mut bench = started(&[("ba", 2 | 8), ("velocity", 1_000_000)]);
    bench.run(E1, 200);
    bench.mark(0, 0);
    bench.run(E1, 100);
    let mut places = vec![bench.sink];
    while places.last() != Some(&20_000) {
        places.push(bench.step(0).0);
    }
    assert!(places.is_sorted(), "it never turns round");
    // 122.7 before the end the travel per call is 29 inc, before that 33.
    let ramp = places.windows(2).position(|pair| pair[1] - pair[0] < 33).expect("a ramp");
    assert!((20_000 - 157..=20_000 - 122).contains(&places[ramp]), "{}", places[ramp]);
    assert_eq!(bench.until_rest(0), 1);
    // The next order searches again, and a pulse before its edge is ignored.
    assert_eq!(bench.step(0).1, A1);
    let seen = bench.seen(E1, Some(19_990));
    let told = bench.epos.step(&seen);
    assert_eq!((told.coordinate_change, told.sink, told.outputs), (0, 20_004, MOVES));
}

/// A command that is already beyond the end: a step back without bit 2, a motion back with bit 2.
///
/// Proves: AMK-EPOS-37, AMK-EPOS-40, AMK-EPOS-41
#[test]
fn command_beyond_end_steps_or_moves_back() {
    let mut bench = started(&[("ba", 2), ("travel", 10), ("velocity", 1_000_000)]);
    bench.run(E1, 200);
    assert_eq!(bench.mark(0, 500), (10, A1));
    let mut bench = started(&[("ba", 6), ("travel", -50), ("velocity", 1_000_000)]);
    bench.run(E1, 200);
    bench.mark(0, 0);
    let peak = (0..30).map(|_| bench.step(0).0).max().expect("calls");
    assert!((122..=124).contains(&peak), "{peak}");
    bench.until_rest(0);
    assert_eq!(bench.sink, -50);
}

/// Proves: AMK-EPOS-33, AMK-EPOS-35, AMK-EPOS-37
#[test]
fn a_search_that_is_stopped_seeks_on_and_a_pulse_on_its_ramp_counts() {
    let begun = |ba| {
        let mut bench = started(&[("ba", ba), ("travel", 3000), ("velocity", 1_000_000)]);
        bench.run(E1, 100);
        bench
    };
    let mut bench = begun(2);
    assert_eq!(bench.until_rest(E2), 3);
    bench.step(0);
    assert_eq!(bench.ways(E1, 2).len(), 2);
    assert_eq!(bench.step(E1).1, MOVES);
    bench.run(E1, 50);
    bench.mark(E1, 3);
    bench.until_rest(0);
    assert_eq!(bench.sink, 3000);
    // On the ramp, and at rest while the drive lags behind.
    let mut bench = begun(2);
    bench.step(E2);
    bench.mark(E2, 5);
    bench.until_rest(0);
    assert!(bench.sink < 3000);
    bench.step(E1);
    bench.until_rest(0);
    assert_eq!(bench.sink, 3000);
    let mut bench = begun(2);
    bench.until_rest(E2);
    assert_eq!(bench.mark(0, 8), (8, A1));
    bench.step(E1);
    bench.until_rest(0);
    assert_eq!(bench.sink, 3000);
    // At rest beyond the end: without bit 2 the edge steps to the end.
    let mut bench = begun(2);
    bench.until_rest(E2);
    bench.mark(0, 3100);
    assert_eq!(bench.step(E1), (3000, MOVES));
    assert_eq!(bench.step(E1), (3000, A1));
}

/// Proves: AMK-EPOS-33, AMK-EPOS-35
#[test]
fn a_way_back_that_is_stopped_goes_on() {
    let mut bench = started(&[("ba", 6), ("travel", 100), ("velocity", 1_000_000)]);
    bench.run(E1, 200);
    bench.mark(0, 20);
    assert_eq!(bench.until_rest(E2), 2, "29.3 down by 16");
    let halted = bench.sink;
    assert_eq!(bench.epos.shown(), [100 - halted]);
    bench.step(0);
    bench.step(E1);
    bench.until_rest(0);
    assert_eq!(bench.sink, 100);
}

/// ID 2 is at least 1 ms, and `sf_cycle` 2 to 18: a slot of 0.5 ms has no search, whether or not its set gives the
/// cycle.
///
/// Proves: AMK-EPOS-44, AMK-EPOS-50
#[test]
fn search_for_reference_needs_a_cycle_of_1_to_9_ms() {
    let refused = |call_ns: u64, ba: i64, sf_cycle: i64| {
        let mut bench = example(&[]);
        bench.call_ns = call_ns;
        bench.checked(&[("ba", ba), ("sf_cycle", sf_cycle)]).err().map(|fault| (fault.code, fault.asked, fault.limit))
    };
    let of = |asked, limit| Some((Code::AMK_BEYOND, asked, limit));
    let (low, high) = (Number::Time(MS as i64), Number::Time(9 * MS as i64));
    for ba in [2, 6] {
        assert_eq!(refused(500_000, ba, 0), of(Number::Time(500_000), low));
        assert_eq!(refused(341_333, ba, 0), of(Number::Time(341_333), low));
        assert_eq!(refused(500_000, ba, 1), of(Number::Count(1), Number::Count(2)));
        assert_eq!(refused(9_500_000, ba, 0), of(Number::Time(9_500_000), high));
        for (call_ns, sf_cycle) in [(MS, 0), (MS, 2), (1_023_999, 0), (9 * MS, 0), (9 * MS, 18)] {
            assert_eq!(refused(call_ns, ba, sf_cycle), None, "{call_ns} {sf_cycle}");
        }
    }
    // Relative and modulo orders have no such limits.
    for ba in [0, 16] {
        assert_eq!((refused(500_000, ba, 0), refused(500_000, ba, 1), refused(10 * MS, ba, 0)), (None, None, None));
    }
}

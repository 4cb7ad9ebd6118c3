//! Orders of a multiple of a length: modulo mode.

use super::*;

/// Proves: AMK-EPOS-03, AMK-EPOS-08, AMK-EPOS-19, AMK-EPOS-21, AMK-EPOS-22, AMK-EPOS-23, AMK-EPOS-31
#[test]
fn a_modulo_order_runs_on_while_e1_stands_and_ends_at_a_multiple() {
    let mut bench = started(&[("ba", 16 | 8), ("travel", 1000)]);
    assert_eq!(bench.run(E1, 8).1, MOVES, "up to 32");
    assert_eq!(bench.step(E1).1, A2, "33.333");
    assert!(bench.ways(E1, 500).into_iter().all(|way| way == 33 || way == 34));
    while bench.sink % 1000 > 50 {
        assert_eq!(bench.step(E1).1, A2);
    }
    // The end is the first multiple beyond the ramp, which takes 156 including the call at full speed.
    let from = bench.sink;
    let end = (from + 156) / 1000 * 1000 + 1000;
    assert_eq!(bench.step(0).1, A2, "not yet");
    let mut outputs = Vec::new();
    while outputs.last() != Some(&A1) {
        outputs.push(bench.step(0).1);
    }
    assert_eq!(bench.sink, end);
    let ramp = outputs.iter().filter(|outputs| **outputs == MOVES).count();
    assert!(
        (7..=9).contains(&ramp)
            && outputs.is_sorted_by_key(|outputs| [A2, MOVES, A1].iter().position(|at| at == outputs))
    );
    // A short edge is one length; E1 after the start of the ramp down comes too late, and no edge adds to the order.
    let mut bench = started(&[("ba", 16 | 8), ("travel", -1000)]);
    bench.step(E1);
    bench.step(0);
    bench.step(E1);
    bench.step(0);
    while bench.step(0).1 != MOVES || bench.sink > -700 {}
    bench.until_rest(E1);
    assert_eq!(bench.sink, -1000);
    assert_eq!(bench.run(E1, 50), (-1000, A1), "only an edge begins anew (A-44)");
}

/// A length below the ramp: the first multiple that can be reached. With a length too short for n_comm, A2 stays
/// 0.
///
/// Proves: AMK-EPOS-21, AMK-EPOS-22
#[test]
fn lengths_below_the_ramp_end_at_the_first_multiple_that_can_be_reached() {
    let mut bench = started(&[("ba", 16), ("travel", 7)]);
    bench.run(E1, 300);
    let from = bench.sink;
    bench.until_rest(0);
    assert_eq!(bench.sink % 7, 0);
    assert!((from + 122..from + 157 + 7).contains(&bench.sink), "{} of {from}", bench.sink);
    let mut bench = started(&[("ba", 16), ("travel", 64)]);
    bench.step(E1);
    let told: Vec<_> = (0..6).map(|_| bench.step(0)).collect();
    assert!(told[..5].iter().all(|(_, outputs)| *outputs == MOVES) && told[5] == (64, A1), "{told:?}");
}

/// E2 stops regardless of E1; the distance to go is kept.
///
/// Proves: AMK-EPOS-21, AMK-EPOS-25
#[test]
fn a_stop_ramp_is_not_put_off() {
    let mut bench = started(&[("ba", 16), ("travel", 1000)]);
    bench.run(E1, 100);
    let from = bench.sink;
    assert_eq!(bench.until_rest(E1 | E2), 3);
    assert!((from + 18..=from + 20).contains(&bench.sink));
    bench.step(0);
    bench.step(E1);
    bench.until_rest(0);
    assert_eq!(bench.sink % 1000, 0);
}

/// 20 inc per call, ramps of 1, stop ramp of 4. The ramp down to 2500 begins in call 126, as E1 is 0; E2 stops it in
/// call 131 with 84 inc left. The next edge of E1 continues the order, and E1 decides again in the call in which the
/// ramp down would begin. Calls and positions are those of a model of whole numbers.
///
/// Proves: AMK-EPOS-21, AMK-EPOS-25, AMK-EPOS-31, AMK-EPOS-35
#[test]
fn modulo_order_stopped_on_its_last_ramp_and_continued_runs_on_while_e1_is_1() {
    let stopped = || {
        let mut bench = started(&[
            ("ba", 16),
            ("travel", 2500),
            ("velocity", 600_000),
            ("acceleration", 50_000),
            ("stop_decel", 200_000),
        ]);
        assert_eq!(bench.run(E1, 100), (1810, A2));
        assert_eq!(bench.run(0, 25), (2310, A2), "call 125");
        assert_eq!(bench.run(0, 5), (2395, MOVES), "19, 18, 17, 16, 15");
        assert_eq!(bench.ways(E2, 3), [11, 7, 3]);
        assert_eq!(bench.run(0, 17), (2416, A1), "call 150");
        bench
    };
    let mut bench = stopped();
    assert_eq!(bench.step(E1), (2417, MOVES));
    assert_eq!(bench.run(E1, 19), (2626, A2), "1 + 2 + .. + 20 from 2416 on");
    assert_eq!(bench.run(E1, 230), (7226, A2), "call 400");
    assert_eq!((bench.until_rest(0), bench.sink), (24, 7500));
    // A short edge continues to the remaining end: up to 9 inc per call and down again, in 18 calls.
    let mut bench = stopped();
    bench.step(E1);
    assert_eq!((bench.until_rest(0), bench.sink), (17, 2500));
}

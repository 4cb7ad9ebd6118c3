//! VALUE_NEW, START after RESET, and sets that are refused.

use super::*;

const PARTS_OF_MM: i128 = INC / 1000;

/// Proves: AMK-EPOS-26
#[test]
fn value_new_changes_ramps_at_once_and_orders_from_the_next_one_on() {
    let mut bench = started(&[]);
    assert_eq!(bench.ways(E1, 2), [4, 8]);
    bench.value_new(&[("acceleration", 400_000), ("velocity", 500_000), ("travel", -3)]);
    assert_eq!(bench.ways(E1, 3), [16, 24, 32], "8 inc a call");
    bench.value_new(&[("acceleration", 200_000), ("stop_decel", 400_000)]);
    bench.run(E1, 50);
    bench.step(0);
    assert_eq!(bench.until_rest(E2), 5, "25.3, 17.3, 9.3, 1.3, rest");
    bench.step(0);
    bench.step(E1);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 20_000, "the order is that of its edge");
    bench.step(0);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 19_997);
}

/// Half of the ramp is left when the ramp becomes ten times as flat: it brakes evenly, no harder than necessary.
///
/// Proves: AMK-EPOS-26
#[test]
fn a_flatter_ramp_on_the_way_down_passes_no_end() {
    let mut bench = started(&[]);
    bench.run(E1, 604);
    let velocity = bench.epos.velocity;
    bench.value_new(&[("acceleration", 20_000)]);
    let mut drops = Vec::new();
    let mut last = velocity;
    while bench.step(E1).1 != A1 {
        drops.push(last - bench.epos.velocity);
        last = bench.epos.velocity;
    }
    assert_eq!(bench.sink, 20_000);
    assert!(drops.iter().all(|drop| (0..=4 * INC + PARTS_OF_MM).contains(drop)), "{drops:?}");
}

/// Proves: AMK-EPOS-38
#[test]
fn start_after_reset_has_no_previous_order() {
    let mut bench = started(&[]);
    bench.run(E1, 100);
    let here = bench.sink;
    assert_eq!(bench.start(E1), (here, A1));
    assert_eq!(bench.run(0, 3), (here, A1));
    bench.until_rest(E1);
    assert_eq!(bench.sink, here + 20_000);
}

/// Values, and the code and the field of the error.
type Refused = (&'static [(&'static str, i64)], Code, &'static str);

/// Proves: AMK-EPOS-15, AMK-EPOS-19, AMK-EPOS-43, AMK-EPOS-44, AMK-EPOS-50, AMK-EPOS-52, AMK-EPOS-54, AMK-EPOS-56, AMK-EPOS-60, AMK-EPOS-61
#[test]
fn field_unused_by_mode_is_refused() {
    let bench = example(&[]);
    let refused = |more: &[(&'static str, i64)]| {
        let fault = bench.checked(more).expect_err("a set that is refused");
        (fault.code, fault.field.and_then(|field| FIELDS.get(usize::from(field))).map(|field| field.name))
    };
    let cases: &[Refused] = &[
        (&[("ba", 18)], Code::AMK_MODULO_SUBSTITUTIONAL, "ba"),
        (&[("ba", 2), ("travel", 0)], Code::AMK_NO_TRAVEL, "travel"),
        (&[("ba", 16), ("travel", 0)], Code::AMK_NO_TRAVEL, "travel"),
        (&[("ba", 2), ("velocity", 0)], Code::AMK_NO_APPROACH, "velocity"),
        (&[("ba", 3), ("velocity", 0), ("master_resolution", 1)], Code::AMK_NO_APPROACH, "velocity"),
        (&[("velocity", 0)], Code::AMK_NOT_ZERO, "velocity"),
        (&[("velocity", -5)], Code::AMK_NOT_ZERO, "velocity"),
        (&[("ba", 2), ("velocity", -5)], Code::AMK_AGAINST_APPROACH, "travel"),
        (&[("ba", 2), ("travel", -5)], Code::AMK_AGAINST_APPROACH, "travel"),
        (&[("stop_decel", 199_999)], Code::AMK_BEYOND, "stop_decel"),
        (&[("ba", 1)], Code::AMK_NOT_ZERO, "master_resolution"),
        (&[("sf_cycle", 3)], Code::AMK_CYCLE_MISMATCH, "sf_cycle"),
        (&[("ba", 2), ("sf_cycle", 1)], Code::AMK_BEYOND, "sf_cycle"),
        (&[("ba", 2), ("sf_cycle", 19)], Code::AMK_BEYOND, "sf_cycle"),
    ];
    for (more, code, field) in cases {
        assert_eq!(refused(more), (*code, Some(*field)), "{more:?}");
    }
    for taken in [
        &[("ba", 2)][..],
        &[("ba", 6), ("travel", -5)],
        &[("ba", 1), ("velocity", -5), ("master_resolution", 1)],
        &[("travel", 0), ("sf_cycle", 0)],
        &[("stop_decel", 200_000)],
    ] {
        assert_eq!(bench.checked(taken), Ok(()), "{taken:?}");
    }
    let mut bench = example(&[]);
    (bench.has_source, bench.has_mark) = (false, false);
    let code = |more: &[(&'static str, i64)]| bench.checked(more).err().map(|fault| fault.code);
    assert_eq!(code(&[]), None);
    assert_eq!(code(&[("ba", 1), ("master_resolution", 1)]), Some(Code::AMK_NO_SOURCE));
    assert_eq!(code(&[("ba", 2)]), Some(Code::AMK_NO_REFERENCE));
}

use super::*;
use crate::function::program::{LINES, SourceValue};
use crate::function::trial::{CALL_NS, at_rest, set, setting};
use proptest::prelude::*;

/// The example of the manual: difference, invalid pulses are discarded, negative limitation.
const MANUAL: [(&str, i64); 4] = [("ba", 8), ("spacing", 10_000), ("window", 2_000), ("blocked", 1_000)];

fn call<'a>(sink: i64, mark: Option<i64>) -> CallInputs<'a> {
    CallInputs { sink, source: SourceValue { mark, ..SourceValue::default() }, ..at_rest() }
}

/// Returns a function after START without a pulse.
fn started(values: &[(&str, i64)]) -> Imes {
    let mut imes = Imes::new(&SlotSetup::default());
    let first = imes.start(Words(&set(FIELDS, values)), &call(7, None));
    assert_eq!(first, Outcome { sink: 7, outputs: 0, writes: 3, ..Outcome::default() });
    imes
}

/// Returns sink, A1 and A2 of each call; each call has a pulse.
fn measured(values: &[(&str, i64)], pulses: &[i64]) -> Vec<(i64, bool, bool)> {
    let mut imes = started(values);
    let mut sink = 7;
    let mut given = Vec::new();
    for pulse in pulses {
        let outcome = imes.step(&call(sink, Some(*pulse)));
        assert_eq!(outcome.writes, 3);
        sink = outcome.sink;
        given.push((sink, outcome.outputs & 1 == 1, outcome.outputs & 2 == 2));
    }
    given
}

/// The result of a valid, an invalid and an ignored pulse.
fn valid(sink: i64) -> (i64, bool, bool) {
    (sink, true, true)
}

fn invalid(sink: i64) -> (i64, bool, bool) {
    (sink, false, false)
}

fn ignored(sink: i64) -> (i64, bool, bool) {
    (sink, false, true)
}

/// Proves: AMK-IMES-O1, AMK-IMES-12, AMK-IMES-15, AMK-IMES-18, AMK-IMES-22, AMK-IMES-23
#[test]
fn pulses_of_the_manual_are_measured_against_the_spacing() {
    let given = measured(&MANUAL, &[0, 9_500, 10_000, 19_200, 29_600, 39_000]);
    assert_eq!(given, [invalid(7), valid(-500), ignored(-500), valid(-300), invalid(-300), valid(-200)]);
}

/// Proves: AMK-IMES-17, AMK-IMES-19, AMK-IMES-26
#[test]
fn a1_lasts_one_call_and_sink_and_a2_are_held() {
    let mut imes = started(&MANUAL);
    imes.step(&call(7, Some(0)));
    assert_eq!(imes.step(&call(7, Some(9_500))).outputs, A1 | A2);
    for _ in 0..3 {
        assert_eq!(imes.step(&call(-500, None)), Outcome { sink: -500, outputs: A2, writes: 3, ..Outcome::default() });
    }
}

/// Proves: AMK-IMES-O4, AMK-IMES-11, AMK-IMES-13
#[test]
fn absolute_distances_need_no_spacing() {
    let absolute = [("ba", 1), ("spacing", 10_000), ("window", 1), ("blocked", 1_000)];
    let given = measured(&absolute, &[0, 12_345, 13_145, 13_345, 13_340]);
    assert_eq!(given, [invalid(7), valid(12_345), ignored(12_345), valid(1_000), ignored(1_000)]);
    // Bits 1 to 3 have no effect.
    let given = measured(&[("ba", 0b1011), ("spacing", 100)], &[-5, 150, 5_000_000_150]);
    assert_eq!(given, [invalid(7), valid(155), valid(5_000_000_000)]);
    assert_eq!(measured(&[("ba", 0)], &[0, 9_500, 9_400])[1..], [valid(9_500), valid(100)]);
}

/// Proves: AMK-IMES-14, AMK-IMES-16
#[test]
fn each_limitation_has_its_range() {
    let output = |ba, distance: i64| measured(&[("ba", ba), ("spacing", 10)], &[100, 100 + distance])[1];
    // Without limitation the middle is positive.
    let both = [4, 5, 6, 10, 15, 16, 34].map(|distance| output(0, distance));
    assert_eq!(both, [4, 5, -4, 0, 5, -4, 4].map(valid));
    let odd = |distance| measured(&[("spacing", 5)], &[0, distance])[1];
    assert_eq!([2, 3, 7, 8].map(odd), [2, -2, 2, -2].map(valid));
    let positive = [9, 10, 11, 19, 20].map(|distance| output(4, distance));
    assert_eq!(positive, [invalid(7), valid(0), valid(1), valid(9), valid(0)]);
    let negative = [1, 9, 10, 11, 20].map(|distance| output(8, distance));
    assert_eq!(negative, [-9, -1, 0, -9, 0].map(valid));
}

/// Proves: AMK-IMES-09, AMK-IMES-16
#[test]
fn the_window_includes_its_ends() {
    let output = |distance| measured(&[("spacing", 100), ("window", 7)], &[0, distance])[1];
    assert_eq!([107, 108, 93, 92].map(output), [valid(7), invalid(7), valid(-7), invalid(7)]);
    assert_eq!(measured(&[("window", 7)], &[0, 108])[1], valid(108));
}

/// Proves: AMK-IMES-14
#[test]
fn a_lost_pulse_leaves_the_deviation_right() {
    let pulses = [0, 9_900, 29_800];
    assert_eq!(measured(&MANUAL, &pulses)[1..], [valid(-100), valid(-100)]);
    assert_eq!(measured(&[("spacing", 10_000)], &[0, 30_020])[1], valid(20));
}

/// Proves: AMK-IMES-18, AMK-IMES-25
#[test]
fn an_invalid_pulse_is_the_next_start_only_where_the_mode_says_so() {
    let with = |ba| [("ba", ba), ("spacing", 1_000), ("window", 10), ("blocked", 300)];
    // 1500 is invalid. If it becomes the start value, 2500 is a spacing after it; otherwise it is 1500 after 1000.
    let pulses = [0, 1_000, 1_500, 2_500];
    assert_eq!(measured(&with(2), &pulses)[2..], [invalid(0), valid(0)]);
    assert_eq!(measured(&with(0), &pulses)[2..], [invalid(0), invalid(0)]);
    // The blocked range stays at the last valid pulse: 1550 counts, though it is only 100 after the start value.
    let short = [("ba", 2), ("spacing", 100), ("window", 10), ("blocked", 300)];
    assert_eq!(measured(&short, &[0, 1_000, 1_299, 1_450, 1_550])[2..], [ignored(0), invalid(0), valid(0)]);
}

#[test]
fn backward_motion_measures_distances_without_a_sign() {
    assert_eq!(measured(&MANUAL, &[0, -9_500, -10_000, -19_200])[1..], [valid(-500), ignored(-500), valid(-300)]);
    // Forward and back.
    assert_eq!(measured(&MANUAL, &[0, 9_500, 0])[1..], [valid(-500), valid(-500)]);
    // Across the wrap of 64 bits, and the largest possible distance.
    assert_eq!(measured(&[("ba", 1)], &[i64::MAX, i64::MIN])[1], valid(1));
    assert_eq!(measured(&[("ba", 1)], &[0, i64::MIN])[1], valid(i64::MAX));
}

/// Proves: AMK-IMES-20
#[test]
fn new_values_count_from_the_next_pulse_and_the_start_value_stays() {
    let mut imes = started(&MANUAL);
    imes.step(&call(7, Some(0)));
    let renewed = [("ba", 1), ("spacing", 1_000), ("window", 50), ("blocked", 20)];
    imes.apply_values(Words(&set(FIELDS, &renewed)));
    assert_eq!(imes.step(&call(7, None)).sink, 7);
    // 19 is in the blocked range; 970 after the first pulse is -30 with the new spacing: the mode stays as started.
    assert_eq!(imes.step(&call(7, Some(19))).outputs, 0);
    assert_eq!(
        imes.step(&call(7, Some(970))),
        Outcome { sink: -30, outputs: A1 | A2, writes: 3, ..Outcome::default() }
    );
}

/// Proves: AMK-IMES-22
#[test]
fn a_start_forgets_what_was_and_its_own_call_may_have_the_first_pulse() {
    let mut imes = started(&MANUAL);
    for pulse in [0, 9_500] {
        imes.step(&call(7, Some(pulse)));
    }
    let words = set(FIELDS, &MANUAL);
    assert_eq!(imes.start(Words(&words), &call(7, Some(12_000))).outputs, 0);
    assert_eq!(imes.step(&call(7, Some(21_900))).sink, -100);
}

/// Proves: AMK-IMES-06
#[test]
fn both_limitations_at_once_are_refused() {
    let setting = setting(CALL_NS, [None; LINES]);
    let check = |ba| Imes::new(&SlotSetup::default()).check(Words(&set(FIELDS, &[("ba", ba)])), &setting);
    for ba in 0..12 {
        assert_eq!(check(ba), Ok(()));
    }
    for ba in 12..16 {
        let fault = Fault::new(Code::AMK_LIMITATION).of(0);
        assert_eq!(check(ba), Err(Fault { asked: Number::Count(ba), ..fault }));
    }
    let mut read = Imes::new(&SlotSetup::default());
    assert!(read.is_valid_state());
    read.spacing = -1;
    assert!(!read.is_valid_state());
}

/// Returns the deviation of a distance from the nearest multiple of the spacing that the limitation allows.
fn deviation(limitation: i64, distance: i64, spacing: i64) -> Option<i64> {
    let from = |multiple: i64| distance - multiple * spacing;
    let multiples = 0..=distance / spacing + 1;
    match limitation {
        1 => multiples.map(from).filter(|it| *it >= 0 && distance >= spacing).min(),
        2 => multiples.map(from).filter(|it| *it <= 0).max(),
        _ => multiples.map(from).min_by_key(|it| (it.abs(), it.is_negative())),
    }
}

proptest! {
    /// Proves: AMK-IMES-12, AMK-IMES-14, AMK-IMES-16, AMK-IMES-17, AMK-IMES-18
    #[test]
    fn valid_pulses_are_those_near_a_multiple_of_the_spacing(
        limitation in 0_i64..3,
        sets_on in any::<bool>(),
        spacing in 1_i64..50,
        window in 0_i64..30,
        blocked in 0_i64..30,
        ways in proptest::collection::vec(-150_i64..150, 1..40),
    ) {
        let ba = limitation << 2 | i64::from(sets_on) << 1;
        let values = [("ba", ba), ("spacing", spacing), ("window", window), ("blocked", blocked)];
        let pulses: Vec<_> = ways.iter().scan(0, |at, way| { *at += way; Some(*at) }).collect();
        // The first pulse is the start value and starts the blocked range.
        let (mut begin, mut block, mut expected) = (pulses[0], pulses[0], invalid(7));
        for (pulse, given) in pulses.iter().zip(measured(&values, &pulses)).skip(1) {
            expected.1 = false;
            if (pulse - block).abs() >= blocked {
                let near = deviation(limitation, (pulse - begin).abs(), spacing);
                let near = near.filter(|it| window == 0 || it.abs() <= window);
                expected = near.map_or(invalid(expected.0), valid);
                if near.is_some() {
                    block = *pulse;
                }
                if near.is_some() || sets_on {
                    begin = *pulse;
                }
            }
            prop_assert_eq!(given, expected);
        }
    }
}

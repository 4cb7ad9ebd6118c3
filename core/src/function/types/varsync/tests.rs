use super::*;
use crate::event::Number;
use crate::function::program::SourceValue;
use crate::function::trial::{CALL_NS, at_rest, set, setting};
use proptest::prelude::*;

/// m1 to m8.
const RATIOS: [(&str, i64); 8] = [
    ("m1", 10_000),
    ("m2", -10_000),
    ("m3", 5_000),
    ("m4", 20_000),
    ("m5", 30_000),
    ("m6", 1),
    ("m7", -32_768),
    ("m8", 32_767),
];

fn words(mode: i64, others: &[(&str, i64)]) -> Vec<i64> {
    set(FIELDS, &[&[("mode", mode)], others].concat())
}

fn at<'a>(travel: i64, inputs: u8) -> CallInputs<'a> {
    CallInputs { source: SourceValue { travel, ..SourceValue::default() }, inputs, ..at_rest() }
}

fn started(words: &[i64], seen: &CallInputs<'_>) -> Varsync {
    let mut varsync = Varsync::new(&SlotSetup::of_words([true, false]));
    let first = varsync.start(Words(words), seen);
    assert_eq!((first.sink, first.sak_share), (seen.sink, 0));
    varsync
}

/// Returns the travel of the slave for 10000 inc of the master in a call with these inputs: the active ratio.
fn ratio_at(varsync: &mut Varsync, inputs: u8) -> (i64, u8) {
    let (master, slave) = (varsync.master, varsync.slave);
    let outcome = varsync.step(&at(master.wrapping_add(ONE), inputs));
    assert_eq!(outcome.writes, 1);
    (outcome.sink.wrapping_sub(slave), outcome.outputs)
}

/// Proves: AMK-VARSYNC-O1, AMK-VARSYNC-10, AMK-VARSYNC-12, AMK-VARSYNC-02
#[test]
fn a_level_chooses_between_forward_and_backward() {
    let words = words(0, &[("m1", 10_000), ("m2", -10_000), ("sak", 7936)]);
    let mut varsync = started(&words, &at(0, 0));
    let (mut slave, mut shares, mut a1) = (Vec::new(), Vec::new(), Vec::new());
    for (k, e1) in [(1, 0), (2, 0), (3, 1), (4, 1), (5, 0)] {
        let outcome = varsync.step(&at(100 * k, e1));
        slave.push(outcome.sink - outcome.sak_share);
        shares.push(outcome.sak_share);
        a1.push(outcome.outputs);
    }
    assert_eq!(slave, [100, 200, 100, 0, 100]);
    // 62 calls of 100 inc each, in the direction of the slave.
    assert_eq!(shares, [6200, 6200, -6200, -6200, 6200]);
    assert_eq!(a1, [0, 0, 1, 1, 0]);
}

/// Proves: AMK-VARSYNC-O3, AMK-VARSYNC-13
#[test]
fn an_edge_takes_the_ratio_of_three_bits_and_keeps_it() {
    let mut varsync = started(&words(1, &RATIOS), &at(0, 0));
    // E4, E3, E2, E1. m6 = 1 of 10000.
    let given = [0b0000, 0b1011, 0b0101, 0b1111, 0b0110, 0b0000].map(|inputs| ratio_at(&mut varsync, inputs));
    assert_eq!(given, [(10_000, 0), (1, 1), (1, 1), (1, 1), (1, 0), (1, 0)]);
    // Each selection by a separate edge.
    for (selection, (_, ratio)) in (0_u8..).zip(RATIOS) {
        assert_eq!(ratio_at(&mut varsync, selection << 1 | 1), (ratio, 1));
        assert_eq!(ratio_at(&mut varsync, 0), (ratio, 0));
    }
}

/// Proves: AMK-VARSYNC-13
#[test]
fn input_set_at_first_call_selects_no_ratio() {
    let mut varsync = Varsync::new(&SlotSetup::of_words([false, false]));
    assert_eq!(varsync.start(Words(&words(1, &RATIOS)), &at(0, 0b0101)).outputs, 0);
    assert_eq!(ratio_at(&mut varsync, 0b0101), (10_000, 0));
    assert_eq!(ratio_at(&mut varsync, 0b0100), (10_000, 0));
    assert_eq!(ratio_at(&mut varsync, 0b0101), (5_000, 1));
}

/// Proves: AMK-VARSYNC-14
#[test]
fn two_levels_choose_of_three_ratios_and_both_keep_it() {
    let mut varsync = started(&words(2, &RATIOS), &at(0, 0b11));
    let given = [0b11, 0b01, 0b11, 0b10, 0b11, 0b00, 0b11, 0b1101].map(|inputs| ratio_at(&mut varsync, inputs));
    assert_eq!(given.map(|(ratio, _)| ratio), [10_000, -10_000, -10_000, 5_000, 5_000, 10_000, 10_000, -10_000]);
    assert_eq!(given.map(|(_, a1)| a1), [0; 8]);
    // Inputs of the first call select the ratio.
    let mut varsync = started(&words(2, &RATIOS), &at(0, 0b10));
    assert_eq!(ratio_at(&mut varsync, 0b11), (5_000, 0));
}

/// Proves: AMK-VARSYNC-15
#[test]
fn a_word_is_the_ratio_of_each_call() {
    let words = words(3, &RATIOS);
    let mut varsync = started(&words, &CallInputs { words: [7, 0], ..at(0, 0) });
    let mut slave = |travel, word| varsync.step(&CallInputs { words: [word, 0], ..at(travel, 1) }).sink;
    assert_eq!([slave(100, 10_000), slave(200, -10_000), slave(300, 0), slave(400, 65_535 - 9_999)], [100, 0, 0, -100]);
    // 227.67, then -100.01: both are rounded down.
    assert_eq!([slave(500, 32_767), slave(600, 32_768)], [227, -101]);
}

/// Proves: AMK-VARSYNC-11
#[test]
fn a_remainder_passes_on_from_ratio_to_ratio() {
    // 0.3333 and 0.0001: a third of an increment is kept while the other ratio is active.
    let mut varsync = started(&words(0, &[("m1", 3_333), ("m2", 1)]), &CallInputs { sink: -5, ..at(1 << 40, 0) });
    let mut slave = |travel, inputs| varsync.step(&at((1_i64 << 40) + travel, inputs)).sink;
    // 3333, 6666, 6667, 10000 of 10000; and back by 1 of m2: 9999.
    assert_eq!([slave(1, 0), slave(2, 0), slave(3, 1), slave(4, 0), slave(3, 1)], [-5, -5, -5, -4, -5]);
}

#[test]
fn the_largest_ways_wrap_instead_of_overflowing() {
    for ratio in [i16::MIN, -1, 1, i16::MAX] {
        let words = words(0, &[("m1", ratio.into()), ("sak", 32_767)]);
        let mut varsync = started(&words, &CallInputs { sink: i64::MAX, ..at(i64::MIN, 0) });
        let mut exact = i128::from(i64::MAX) * i128::from(ONE);
        for (travel, change) in [(-1, i64::MAX), (i64::MAX, i64::MIN), (i64::MIN, 1), (0, i64::MIN)] {
            varsync.step(&at(travel, 0));
            exact += i128::from(ratio) * i128::from(change);
            assert_eq!(varsync.slave, exact.div_euclid(ONE.into()) as i64);
            assert!(varsync.is_valid_state());
        }
    }
    let mut read = Varsync::new(&SlotSetup::of_words([true, false]));
    read.remainder = ONE;
    assert!(!read.is_valid_state());
}

/// Proves: AMK-VARSYNC-01, AMK-VARSYNC-03
#[test]
fn a_word_and_the_cycle_of_the_slot_are_needed_in_mode_3_only() {
    let setting = setting(CALL_NS, [None; LINES]);
    let check = |mode, sf_cycle| {
        Varsync::new(&SlotSetup::of_words([true, false]))
            .check(Words(&words(mode, &[("sf_cycle", sf_cycle)])), &setting)
    };
    let mismatch = |asked| {
        let fault = Fault::new(Code::AMK_CYCLE_MISMATCH).of(number(FIELDS, "sf_cycle"));
        Err(Fault { asked: Number::Count(asked), limit: Number::Time(1_000_000), ..fault })
    };
    // 2 times 0.5 ms is the cycle.
    assert_eq!([0, 1, 2, 3].map(|sf_cycle| check(3, sf_cycle)), [Ok(()), mismatch(1), Ok(()), mismatch(3)]);
    assert_eq!(check(3, 32_767), mismatch(32_767));
    assert_eq!([0, 1, 2].map(|mode| check(mode, 3)), [Ok(()); 3]);
    let word = |mode, has_word| {
        Varsync::new(&SlotSetup::of_words([has_word, false])).check(Words(&words(mode, &[])), &setting)
    };
    assert_eq!(word(3, false), Err(Fault::new(Code::AMK_NO_WORD).of(0)));
    assert_eq!([word(3, true), word(0, false), word(1, false), word(2, false)], [Ok(()); 4]);
}

/// Returns the index of the active ratio in each call, from the inputs so far.
fn chosen(mode: i64, inputs: &[u8], k: usize) -> usize {
    let bit = |at: usize, n: u8| usize::from(inputs[at] >> n & 1);
    match mode {
        0 => bit(k, 0),
        1 => {
            let edge = (1..=k).rev().find(|at| bit(*at, 0) == 1 && bit(at - 1, 0) == 0);
            edge.map_or(0, |at| bit(at, 1) + 2 * bit(at, 2) + 4 * bit(at, 3))
        }
        _ => (0..=k).rev().map(|at| bit(at, 0) + 2 * bit(at, 1)).find(|both| *both < 3).unwrap_or(0),
    }
}

/// More than 10^9 increments of the master, forward and back, with a change of ratio every few calls.
///
/// Proves: AMK-VARSYNC-11
#[test]
fn nothing_is_lost_over_a_billion_increments() {
    let mut varsync = started(&words(1, &RATIOS), &at(0, 0));
    let (mut random, mut travelled, mut exact, mut travel) = (1_u64, 0_i64, 0_i128, 0_i64);
    let (mut ratio, mut before, mut calls) = (10_000_i64, 0_u8, 0_u32);
    while travelled < 1_200_000_000 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let change = (random >> 40) as i64 % 65_535 - 32_767;
        let inputs = (random >> 33) as u8 & 0xF;
        if inputs & 1 == 1 && before & 1 == 0 {
            ratio = RATIOS[usize::from(inputs >> 1)].1;
        }
        (before, calls) = (inputs, calls + 1);
        (travel, travelled) = (travel + change, travelled + change.abs());
        exact += i128::from(ratio) * i128::from(change);
        let slave = varsync.step(&at(travel, inputs)).sink;
        assert_eq!(i128::from(slave), exact.div_euclid(10_000), "call {calls}");
    }
}

proptest! {
    /// Proves: AMK-VARSYNC-11, AMK-VARSYNC-12, AMK-VARSYNC-13, AMK-VARSYNC-14
    #[test]
    fn the_slave_is_the_exact_sum_of_all_ratios_times_their_ways(
        mode in 0_i64..=2,
        ratios in proptest::array::uniform8(any::<i16>()),
        begin in (any::<i32>(), any::<i32>()),
        calls in proptest::collection::vec((-32_767_i64..=32_767, any::<u8>()), 1..200),
    ) {
        let fields: Vec<_> = RATIOS.iter().map(|(name, _)| *name).zip(ratios.map(i64::from)).collect();
        let (mut travel, sink) = (i64::from(begin.0), i64::from(begin.1));
        let inputs: Vec<_> = calls.iter().map(|(_, inputs)| *inputs).collect();
        let mut varsync = started(&words(mode, &fields), &CallInputs { sink, ..at(travel, inputs[0]) });
        let mut exact = i128::from(sink) * 10_000;
        for (k, (change, inputs_now)) in calls.iter().enumerate().skip(1) {
            travel += change;
            exact += i128::from(ratios[chosen(mode, &inputs, k)]) * i128::from(*change);
            let slave = varsync.step(&at(travel, *inputs_now)).sink;
            prop_assert_eq!(i128::from(slave), exact.div_euclid(10_000));
            prop_assert!(varsync.is_valid_state());
        }
    }
}

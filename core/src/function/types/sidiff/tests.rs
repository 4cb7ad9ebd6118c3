use super::*;
use crate::function::NO_DRIVES;
use crate::function::trial::{CALL_NS, NO_TABLES, at_rest, set, setting, tab0};
use proptest::prelude::*;
use std::sync::Arc;

fn table(words: &[i64]) -> Arc<Table> {
    Arc::new(Table::new(Form::Words, &[], words).expect("words"))
}

fn tables(table: &Table) -> [Option<&Table>; LINES] {
    let mut tables = [None; LINES];
    tables[0] = Some(table);
    tables
}

/// A call in which the first drives have these errors and compensations.
fn call<'a>(drives: &[(i64, i64)], table: Option<&'a Arc<Table>>) -> CallInputs<'a> {
    let mut seen = CallInputs { sink: 7, tables: table.map_or(NO_TABLES, tab0), ..at_rest() };
    let mut told = *NO_DRIVES;
    for (drive, (error, sak_share)) in told.iter_mut().zip(drives) {
        *drive = Drive { error: *error, sak_share: *sak_share, actual: 0 };
    }
    // The leak ends with the test.
    seen.drives = Box::leak(Box::new(told));
    seen
}

fn outcome(sink: i64, outputs: u8, writes: u8) -> Outcome {
    Outcome { sink, outputs, writes, ..Outcome::default() }
}

/// Starts a function with drive 1 monitored and displayed, and returns the outcome of its first call.
fn first(others: &[(&str, i64)], drive: (i64, i64), table: Option<&Arc<Table>>) -> (Sidiff, Outcome) {
    let one = [("aw_mask", 1), ("display_aw", 1), ("mean_n", 1), ("agreements", 1)];
    let words = set(FIELDS, &[others, &one].concat());
    let mut sidiff = Sidiff::new(&SlotSetup::default());
    let outcome = sidiff.start(Words(&words), &call(&[drive], table));
    (sidiff, outcome)
}

/// Drives 1 and 2 of the manual: threshold 50 each, ratios 2:1 and 1:1.
const MANUAL: [i64; 12] = [50, 0, 0, 10, 0, 20, 50, 0, 0, 0, 0, 0];

/// Proves: AMK-SIDIFF-O1, AMK-SIDIFF-07, AMK-SIDIFF-08, AMK-SIDIFF-09, AMK-SIDIFF-14, AMK-SIDIFF-16
#[test]
fn two_drives_as_the_manual_sets_them_up() {
    let table = table(&MANUAL);
    assert_eq!((table.double(2), table.double(4)), (655_360, 1_310_720));
    let values = [("mode", 3), ("aw_mask", 3), ("display_aw", 1), ("mean_n", 100), ("agreements", 10)];
    let words = set(FIELDS, &values);
    let setting = setting(CALL_NS, tables(&table));
    assert_eq!(Sidiff::new(&SlotSetup::default()).check(Words(&words), &setting), Ok(()));
    let mut sidiff = Sidiff::new(&SlotSetup::default());
    // Drive 1: 151 - 2 * 50 = 51, above; drive 2: 100 - 50 = 50, not above. Drive 3 is not monitored.
    let seen = call(&[(151, 50), (100, 50), (9999, 0)], Some(&table));
    assert_eq!(sidiff.start(Words(&words), &seen), outcome(51, 0, 3));
    for _ in 2..10 {
        assert_eq!(sidiff.step(&seen), outcome(51, 0, 3));
    }
    assert_eq!(sidiff.step(&seen), outcome(51, 1, 3));
    // Ten values of 51 and one of -1 are 509 / 11 = 46.27: the mean is no longer above.
    let low = call(&[(99, 50), (100, 50)], Some(&table));
    assert_eq!(sidiff.step(&low).sink, 46);
}

/// Proves: AMK-SIDIFF-O2, AMK-SIDIFF-13
#[test]
fn the_share_of_the_compensation_is_taken_off_in_increments_of_the_drive() {
    let table = table(&MANUAL[..6]);
    assert_eq!(first(&[], (300, 126), Some(&table)).1, outcome(48, 0, 1));
    assert_eq!(first(&[], (303, 126), Some(&table)).1, outcome(51, 1, 1));
    assert_eq!(first(&[], (-303, -126), Some(&table)).1, outcome(-51, 1, 1));
}

/// Proves: AMK-SIDIFF-13
#[test]
fn a_ratio_rounds_towards_zero_and_does_not_overflow() {
    let ratio = |divider: u32, multiplier: i32| {
        let word = |value: u32, high: bool| i64::from(if high { value >> 16 } else { value & 0xFFFF });
        let multiplier = multiplier.cast_unsigned();
        let words = [word(divider, false), word(divider, true), word(multiplier, false), word(multiplier, true)];
        table(&[&[0, 0], &words[..]].concat())
    };
    let corrected = |table: &Arc<Table>, share| first(&[], (0, share), Some(table)).1.sink;
    // 65535 / 65536 of an increment is truncated to 0, in both directions.
    let little = ratio(65_536, 65_535);
    assert_eq!([1, -1, 2, -2].map(|share| corrected(&little, share)), [0, 0, -1, 1]);
    // -2^31 / 2^16 = -32768; the product of 2^50 exceeds 64 bits as an intermediate result, that of 2^62 as a result.
    let large = ratio(65_536, i32::MIN);
    assert_eq!([1, 1 << 47, i64::MAX].map(|share| corrected(&large, share)), [32_768, 1 << 62, 0]);
    assert_eq!(first(&[], (i64::MIN, i64::MAX), None).1.sink, i64::MIN);
}

/// Proves: AMK-SIDIFF-10
#[test]
fn without_a_table_the_threshold_is_100_and_the_ratio_1() {
    assert_eq!(first(&[], (140, 40), None).1, outcome(100, 0, 1));
    assert_eq!(first(&[], (141, 40), None).1, outcome(101, 1, 1));
    assert_eq!(first(&[], (-141, -40), None).1, outcome(-101, 1, 1));
}

/// Proves: AMK-SIDIFF-01
#[test]
fn short_evaluation_takes_the_low_word_of_the_error() {
    for (mode, sink) in [(0, 0x1_FFFF), (1, -1), (2, 0x1_FFFF), (3, -1)] {
        assert_eq!(first(&[("mode", mode)], (0x1_FFFF, 0), None).1.sink, sink);
    }
}

/// Proves: AMK-SIDIFF-15
#[test]
fn as_many_agreements_in_a_row_set_a_bit_and_clear_it() {
    let words = set(FIELDS, &[("aw_mask", 0x80), ("mean_n", 1), ("agreements", 3)]);
    let mut sidiff = Sidiff::new(&SlotSetup::default());
    let mut bits = |k: usize, error| {
        let seen = call(&[(0, 0), (0, 0), (0, 0), (0, 0), (0, 0), (0, 0), (0, 0), (error, 0)], None);
        let given = if k == 0 { sidiff.start(Words(&words), &seen) } else { sidiff.step(&seen) };
        assert_eq!((given.sink, given.writes), (7, 0x80));
        given.outputs >> 7
    };
    let errors = [101, -101, 100, 101, 101, 101, 0, 0, 500, 0, 0, 0, 0];
    let given: Vec<_> = errors.iter().enumerate().map(|(k, error)| bits(k, *error)).collect();
    assert_eq!(given, [0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 0]);
}

/// Proves: AMK-SIDIFF-04, AMK-SIDIFF-05, AMK-SIDIFF-03
#[test]
fn zero_means_ten_values_and_five_agreements_and_no_display() {
    let words = set(FIELDS, &[("aw_mask", 1), ("mean_n", 0), ("agreements", 0)]);
    let mut sidiff = Sidiff::new(&SlotSetup::default());
    let mut given = vec![sidiff.start(Words(&words), &call(&[(2000, 0)], None))];
    given.extend((2..=24).map(|_| sidiff.step(&call(&[(0, 0)], None))));
    assert!(given.iter().all(|outcome| outcome.sink == 7));
    // The mean is above 100 in calls 1 to 10; the bit changes with the fifth call that agrees, 5 and 15.
    let bits: Vec<_> = given.iter().map(|outcome| outcome.outputs).collect();
    assert_eq!(bits, [&[0; 4][..], &[1; 10], &[0; 10]].concat());
    let left_out = set(FIELDS, &[]);
    assert_eq!((left_out[MEAN_N], left_out[AGREEMENTS]), (10, 5));
}

/// Proves: AMK-SIDIFF-07, AMK-CMD-14
#[test]
fn new_values_keep_bits_and_means_and_read_the_table_again() {
    let (old, new) = (table(&MANUAL), table(&[40, 0, 0, 0, 0, 0, 300, 0, 0, 0, 0, 0]));
    let values = |aw_mask, display_aw, mean_n| {
        set(FIELDS, &[("aw_mask", aw_mask), ("display_aw", display_aw), ("mean_n", mean_n), ("agreements", 1)])
    };
    let mut sidiff = Sidiff::new(&SlotSetup::default());
    let high = [(60, 0), (200, 0)];
    assert_eq!(sidiff.start(Words(&values(3, 1, 4)), &call(&high, Some(&old))), outcome(60, 3, 3));
    // A replaced table has no effect before VALUE_NEW.
    assert_eq!(sidiff.step(&call(&high, Some(&new))), outcome(60, 3, 3));
    // The mean of drive 1 continues: (60 + 60 + 0) / 3 = 40, not above 40; drive 2: 200, not above 300.
    sidiff.apply_values(Words(&values(3, 1, 4)));
    assert_eq!(sidiff.step(&call(&[(0, 0), (200, 0)], Some(&new))), outcome(40, 0, 3));
    // Another length restarts the mean.
    sidiff.apply_values(Words(&values(3, 1, 5)));
    assert_eq!(sidiff.step(&call(&[(90, 0), (400, 0)], Some(&new))), outcome(90, 3, 3));
    // Drive 2 is no longer monitored: its bit is written once as 0, then not at all. Drive 3 is only displayed.
    sidiff.apply_values(Words(&values(1, 3, 5)));
    let third = [(90, 0), (400, 0), (5000, 0)];
    assert_eq!(sidiff.step(&call(&third, Some(&new))), outcome(5000, 1, 3));
    assert_eq!(sidiff.step(&call(&third, Some(&new))), outcome(5000, 1, 1));
    // Monitored again, it starts without its old state.
    sidiff.apply_values(Words(&values(3, 2, 5)));
    assert_eq!(sidiff.step(&call(&[(90, 0), (0, 0)], Some(&new))), outcome(0, 1, 3));
}

#[test]
fn a_start_begins_anew() {
    let (mut sidiff, outcome) = first(&[], (500, 0), None);
    assert_eq!(outcome.outputs, 1);
    let words = set(FIELDS, &[("aw_mask", 1), ("display_aw", 1), ("agreements", 2)]);
    let again = sidiff.start(Words(&words), &call(&[(300, 0)], None));
    assert_eq!((again.sink, again.outputs), (300, 0));
}

/// Proves: AMK-SIDIFF-07, AMK-SIDIFF-08
#[test]
fn a_table_that_does_not_fit_the_drives_is_refused_with_its_number() {
    let check = |aw_mask, display_aw, table: &Table| {
        let words = set(FIELDS, &[("aw_mask", aw_mask), ("display_aw", display_aw)]);
        Sidiff::new(&SlotSetup::default()).check(Words(&words), &setting(CALL_NS, tables(table)))
    };
    let refused = |code: Code, asked, limit| Err(Fault::new(code).with(asked, limit));
    let of = |threshold: [i64; 2], divider: [i64; 2]| table(&[threshold, divider, [0, 0]].concat());
    assert_eq!(check(0b10, 0, &table(&MANUAL)), Ok(()));
    assert_eq!(check(0b10, 0, &table(&MANUAL[..11])), refused(Code::AMK_TABLE_SHORT, 11, 12));
    assert_eq!(check(0x80, 0, &table(&MANUAL)), refused(Code::AMK_TABLE_SHORT, 12, 48));
    assert_eq!(check(1, 3, &table(&MANUAL)), refused(Code::AMK_TABLE_SHORT, 12, 18));
    assert_eq!(check(0, 0, &table(&[1])), Ok(()));
    assert_eq!(check(1, 0, &of([32_767, 0], [0, 1])), Ok(()));
    assert_eq!(check(1, 0, &of([32_768, 0], [0, 1])), refused(Code::AMK_THRESHOLD, 32_768, 32_767));
    assert_eq!(check(1, 0, &of([0, 1], [0, 1])), refused(Code::AMK_THRESHOLD, 65_536, 32_767));
    assert_eq!(check(1, 0, &of([0, 0], [65_535, 0])), refused(Code::AMK_RATIO_DIVIDER, 65_535, 65_536));
    assert_eq!(check(1, 0, &of([0, 0], [0, 0x8000])), refused(Code::AMK_RATIO_DIVIDER, i32::MIN.into(), 65_536));
    // Errors of a drive that is not selected are ignored.
    let second = table(&[&MANUAL[..6], &[-1; 6]].concat());
    assert_eq!((check(1, 0, &second), check(1, 2, &second).is_err()), (Ok(()), true));
    let points = Table::new(Form::Y, &[], &[0; 48]).expect("points");
    assert_eq!(check(1, 0, &points), Err(Fault::new(Code::AMK_TABLE_FORM)));
}

#[test]
fn invalid_state_is_detected() {
    assert!(Sidiff::new(&SlotSetup::default()).is_valid_state());
    let unsound: [fn(&mut Sidiff); 5] = [
        |sidiff| sidiff.watches[7].limit.divider = 0,
        |sidiff| sidiff.watches[0].limit.threshold = -1,
        |sidiff| sidiff.watches[3].values = Window::new(LARGEST - 1),
        |sidiff| sidiff.live.agreements = 0,
        |sidiff| sidiff.live.display_aw = 9,
    ];
    for change in unsound {
        let mut sidiff = Sidiff::new(&SlotSetup::default());
        change(&mut sidiff);
        assert!(!sidiff.is_valid_state());
        // The step does not panic.
        sidiff.step(&call(&[(i64::MAX, i64::MIN); 8], None));
    }
}

#[test]
fn copy_continues_like_original() {
    let (mut original, _) = first(&[], (500, 3), None);
    let mut copy = Sidiff::new(&SlotSetup::default());
    copy.clone_from(&original);
    let mut other = original.clone();
    for error in [400, 0, -900] {
        let seen = call(&[(error, 1)], None);
        let given = original.step(&seen);
        assert_eq!([copy.step(&seen), other.step(&seen)], [given; 2]);
    }
}

proptest! {
    /// Bit and mean of each call are recomputed from all values since START.
    ///
    /// Proves: AMK-SIDIFF-13, AMK-SIDIFF-14, AMK-SIDIFF-15
    #[test]
    fn bits_and_means_are_those_of_the_whole_history(
        mean_n in 1_usize..6,
        agreements in 1_usize..5,
        threshold in 0_i64..40,
        multiplier in 1_i64..0x7FFF,
        calls in proptest::collection::vec(proptest::array::uniform2((-99_i64..99, -9_i64..9)), 1..60),
    ) {
        // Divider and multiplier of drive 1 are whole multiples of 2^16; drive 2 has ratio 1.
        let table = table(&[threshold, 0, 0, 1, 0, multiplier, threshold, 0, 0, 0, 0, 0]);
        let values = [("aw_mask", 3), ("display_aw", 1), ("mean_n", mean_n as i64), ("agreements", agreements as i64)];
        let (words, mut sidiff) = (set(FIELDS, &values), Sidiff::new(&SlotSetup::default()));
        let mean = |drive: usize, k: usize| {
            let ratio = [multiplier, 1][drive];
            let last = &calls[(k + 1).saturating_sub(mean_n)..=k];
            let sum: i64 = last.iter().map(|call| call[drive].0 - call[drive].1 * ratio).sum();
            sum / last.len() as i64
        };
        let bit = |drive: usize, k: usize| {
            let above: Vec<_> = (0..=k).map(|at| mean(drive, at).abs() > threshold).collect();
            let run = above.windows(agreements).rev().find(|run| run.iter().all(|it| *it == run[0]));
            u8::from(run.is_some_and(|run| run[0])) << drive
        };
        for (k, drives) in calls.iter().enumerate() {
            let seen = call(drives, Some(&table));
            let given = if k == 0 { sidiff.start(Words(&words), &seen) } else { sidiff.step(&seen) };
            prop_assert_eq!(given, outcome(mean(0, k), bit(0, k) | bit(1, k), 3));
            prop_assert!(sidiff.is_valid_state());
        }
    }
}

use super::*;
use crate::event::Number;
use crate::function::program::SourceValue;
use crate::function::trial::tab0;
use crate::function::trial::{at_rest, setting, with_memory};
use crate::table::Form;
use proptest::prelude::*;
use std::sync::Arc;

/// Position, A-value and A time of a point.
type Point = (i32, u16, u16);

fn table(points: &[Point]) -> Arc<Table> {
    let mut words = vec![points.len() as i64 + 1, 0, 0, 0];
    for (point, bits, time) in points {
        let [low, high] = [*point as u16, (*point >> 16) as u16];
        words.extend([low, high, *bits, *time].map(i64::from));
    }
    Arc::new(Table::new(Form::Words, &[], &words).expect("words"))
}

/// The example of the manual: two tracks over 20000 inc.
fn example() -> Arc<Table> {
    let bits = [0b00, 0b01, 0b11, 0b10, 0b00, 0b01, 0b11, 0b10];
    table(&bits.iter().zip(1..).map(|(bits, number)| (number * 2500, *bits, 0)).collect::<Vec<_>>())
}

fn set(fields: &[(usize, i64)]) -> Vec<i64> {
    let mut words = vec![0; crate::function::field::width(FIELDS)];
    words[TRACKS] = 2;
    for (place, value) in fields {
        words[*place] = *value;
    }
    words
}

/// A function with its table, 1 ms per call.
struct Bench {
    table: Arc<Table>,
    binea: Binea,
    call_ns: u64,
    word: i64,
    inputs: u8,
}

impl Bench {
    fn new(table: Arc<Table>) -> Self {
        Self { table, binea: Binea::new(&with_memory(100, 0)), call_ns: 1_000_000, word: 0, inputs: 0 }
    }

    fn call(&mut self, words: Option<&[i64]>, value: i64) -> Outcome {
        let source = SourceValue { value, travel: value, mark: None };
        let drives = crate::function::NO_DRIVES;
        let Self { call_ns, word, inputs, .. } = *self;
        let tables = tab0(&self.table);
        let seen = CallInputs { call_ns, source, inputs, sink: 77, words: [word, 0], tables, drives, ..at_rest() };
        let Some(words) = words else { return self.binea.step(&seen) };
        assert_eq!(self.refused(words), None);
        self.binea.start(Words(words), &seen)
    }

    fn start(&mut self, words: &[i64], value: i64) -> u8 {
        self.call(Some(words), value).outputs
    }

    fn step(&mut self, value: i64) -> u8 {
        self.call(None, value).outputs
    }

    fn refused(&self, words: &[i64]) -> Option<Fault> {
        let mut tables = [None; LINES];
        tables[0] = Some(&*self.table);
        self.binea.check(Words(words), &setting(self.call_ns, tables)).err()
    }
}

/// Proves: AMK-BINEA-O1, AMK-BINEA-03, AMK-BINEA-28, AMK-BINEA-33
#[test]
fn the_example_of_the_manual_switches_where_it_says() {
    let mut bench = Bench::new(example());
    // The source is at 5000 at START: x is 0 there.
    assert_eq!(bench.start(&set(&[(BA, 1), (SF_CYCLE_TIME, 2)]), 5000), 0b00);
    let at = [
        (2499, 0b00),
        (2500, 0b01),
        (4999, 0b01),
        (5000, 0b11),
        (7499, 0b11),
        (7500, 0b10),
        (9999, 0b10),
        (10_000, 0b00),
        (12_499, 0b00),
        (19_999, 0b10),
        (20_000, 0b00),
        // Back over 0: 19999 again.
        (19_999, 0b10),
        (22_500, 0b01),
        (20_000, 0b00),
    ];
    for (x, outputs) in at {
        assert_eq!(bench.step(5000 + x), outputs, "x {x}");
    }
    // Below 0, x counts down from M.
    assert_eq!([bench.step(5000), bench.step(4999), bench.step(2500)], [0b00, 0b10, 0b10]);
}

/// Proves: AMK-BINEA-O2, AMK-BINEA-10, AMK-BINEA-16, AMK-BINEA-31
#[test]
fn a_dead_time_is_led_by_the_mean_velocity() {
    let mut bench = Bench::new(example());
    bench.start(&set(&[(BA, 1), (FCT, 1), (DEAD_TIME, 10), (FEEDBACK_OFFSET, 500)]), 0);
    // 1000 inc per call and 5 ms lead by 5000. The 20th call is at 500 again.
    let outputs = (1..=20).map(|k| bench.step(1000 * k)).collect::<Vec<_>>();
    assert_eq!((outputs[19], outputs[18]), (0b11, 0b01), "500 + 5000 and 19500 + 5000 - 20000");
    // The first difference counts at once: 100 inc per call over 10 ms lead by 1000.
    bench.start(&set(&[(BA, 1), (FCT, 1), (DEAD_TIME, 20), (FEEDBACK_OFFSET, 1400)]), 0);
    assert_eq!(bench.step(100), 0b01, "1500 + 1000");
    bench.start(&set(&[(BA, 1), (FCT, 1), (DEAD_TIME, 20), (FEEDBACK_OFFSET, 1399)]), 0);
    assert_eq!(bench.step(100), 0b00, "1499 + 1000");
    // In negative direction the lead is negative: 2600 - 100 - 1000.
    bench.start(&set(&[(BA, 1), (FCT, 1), (DEAD_TIME, 20), (FEEDBACK_OFFSET, 2600)]), 0);
    assert_eq!(bench.step(-100), 0b00);
}

/// Calls of 0.75 ms: 10 half milliseconds are 6 2/3 calls, 15 inc each lead by exactly 100, 14 by 93 1/3.
/// Proves: AMK-BINEA-31
#[test]
fn a_lead_is_exact_where_a_call_is_no_whole_number_of_half_milliseconds() {
    for (change, offset, outputs) in [(15, 2385, 0b01), (15, 2384, 0b00), (14, 2393, 0b01), (14, 2392, 0b00)] {
        let mut bench = Bench { call_ns: 750_000, ..Bench::new(example()) };
        bench.start(&set(&[(BA, 1), (FCT, 1), (DEAD_TIME, 10), (FEEDBACK_OFFSET, offset)]), 0);
        assert_eq!(bench.step(change), outputs, "{change} from {offset}");
    }
}

/// Proves: AMK-BINEA-02
#[test]
fn the_absolute_mode_has_no_modulo_and_ends_at_its_last_segments() {
    let mut bench = Bench::new(table(&[(-100, 1, 0), (0, 2, 0), (100, 3, 0)]));
    assert_eq!(bench.start(&set(&[]), -101), 1);
    let values = [-100, -1, 0, 99, 100, i64::from(i32::MAX), i64::MAX, i64::MIN];
    assert_eq!(values.map(|value| bench.step(value)), [2, 2, 3, 3, 3, 3, 3, 1]);
}

/// Proves: AMK-BINEA-04
#[test]
fn the_time_mode_runs_round_in_the_last_point_without_a_source() {
    // On in the second half of 5 ms; calls of 0.75 ms: 0, 0.75, 1.5, 2.25, 3, 3.75, 4.5, 5.25 = 0.25, ..
    let mut bench = Bench { call_ns: 750_000, ..Bench::new(table(&[(5, 0, 0), (10, 1, 0)])) };
    let words = set(&[(BA, 2), (FEEDBACK_OFFSET, 5)]);
    let mut outputs = vec![bench.start(&words, 0)];
    outputs.extend((1..20).map(|k| bench.step(k * 1_000_000)));
    let expected = (0..20).map(|k| u8::from(k * 750 % 5000 >= 2500)).collect::<Vec<_>>();
    assert_eq!(outputs, expected);
    assert_eq!(expected[..8], [0, 0, 0, 0, 1, 1, 1, 0]);
}

/// Proves: AMK-BINEA-05, AMK-BINEA-14, AMK-BINEA-35
#[test]
fn an_offset_is_the_sets_until_the_next_one_or_the_words_in_each_call() {
    let mut bench = Bench::new(example());
    bench.word = 9999;
    assert_eq!(bench.start(&set(&[(BA, 1), (FEEDBACK_OFFSET, -1)]), 0), 0b10, "19999");
    assert_eq!(bench.step(2500), 0b00, "2499");
    bench.binea.apply_values(Words(&set(&[(BA, 1), (FEEDBACK_OFFSET, 0)])));
    assert_eq!(bench.step(2500), 0b01, "the change shifts x, START does not come again");

    bench.binea = Binea::new(&SlotSetup { has_words: [true, false], ..with_memory(20, 0) });
    bench.word = 2500;
    assert_eq!(bench.start(&set(&[(BA, 1), (FEEDBACK_OFFSET, 5000)]), 0), 0b01);
    bench.word = -1;
    assert_eq!(bench.step(0), 0b10);
    // Absolute mode with an offset word.
    bench.word = 7000;
    assert_eq!(bench.start(&set(&[]), 500), 0b10);
}

/// Proves: AMK-BINEA-20, AMK-BINEA-27, AMK-BINEA-29, AMK-BINEA-33
#[test]
fn a_pulse_begins_with_the_edge_and_lasts_the_time_of_its_segment() {
    // Track 0 with a pulse of 2.5 ms from 100 on is 3 calls of 1 ms; the pulse also continues over the wrap at 200.
    let mut bench = Bench::new(table(&[(100, 0, 9), (200, 1, 5)]));
    let words = set(&[(BA, 1), (MODE, 16)]);
    assert_eq!(bench.start(&words, 0), 0);
    let pulse = [100, 150, 50, 60, 70].map(|x| bench.step(x));
    assert_eq!(pulse, [1, 1, 1, 0, 0]);
    // In negative direction over 0 into the segment: the bit rises there as well.
    assert_eq!([-1, -2, -3, -4].map(|x| bench.step(x)), [1, 1, 1, 0]);
    // START within the segment triggers no pulse.
    assert_eq!(bench.start(&set(&[(BA, 1), (MODE, 16), (FEEDBACK_OFFSET, 150)]), 0), 0);
    assert_eq!([0, 1].map(|x| bench.step(x)), [0, 0]);
}

/// Proves: AMK-BINEA-01, AMK-BINEA-21, AMK-BINEA-23
#[test]
fn only_tracks_in_use_that_are_not_disabled_are_written() {
    let mut bench = Bench::new(table(&[(100, 0xFF, 0)]));
    let outcome = bench.call(Some(&set(&[(TRACKS, 3), (MODE + 1, 32), (MODE + 2, 1)])), 0);
    assert_eq!(outcome, Outcome { sink: 77, outputs: 0b001, writes: 0b101, ..Outcome::default() });
    let outcome = bench.call(Some(&set(&[(TRACKS, 8), (MODE + 7, 4 + 2)])), 0);
    assert_eq!((outcome.outputs, outcome.writes), (0xFF, 0xFF));
    bench.inputs = 0x80;
    assert_eq!(bench.step(0), 0x7F);
}

/// Proves: AMK-BINEA-07, AMK-BINEA-10, AMK-BINEA-11, AMK-BINEA-19, AMK-BINEA-24, AMK-BINEA-25, AMK-BINEA-27, AMK-BINEA-32
#[test]
fn what_is_no_set_is_refused_with_its_field_or_word() {
    let bench = Bench::new(example());
    let fault = |words: &[(usize, i64)]| bench.refused(&set(words));
    let of = |code, name, asked, limit| Some(Fault::new(code).of(number(FIELDS, name)).with(asked, limit));
    let mismatch = |name, asked| {
        let fault = Fault::new(Code::AMK_CYCLE_MISMATCH).of(number(FIELDS, name));
        Some(Fault { asked: Number::Count(asked), limit: Number::Time(1_000_000), ..fault })
    };
    assert_eq!(fault(&[(BA, 1), (FCT, 1), (DEAD_TIME, 32_000)]), None);
    assert_eq!(fault(&[(FCT, 1)]), of(Code::AMK_DEAD_TIME_MODE, "fct", 0, 1));
    assert_eq!(fault(&[(FCT, 1), (BA, 2)]), of(Code::AMK_DEAD_TIME_MODE, "fct", 2, 1));
    assert_eq!(fault(&[(DEAD_TIME, 7), (BA, 1)]), of(Code::AMK_DEAD_TIME_UNUSED, "dead_time", 7, 0));
    assert_eq!(fault(&[(SF_CYCLE_TIME, 1)]), mismatch("sf_cycle_time", 1));
    assert_eq!(fault(&[(MODE + 7, 12)]), of(Code::AMK_TRACK_LOGIC, "mode", 12, 12));

    let refused = |table, words: &[(usize, i64)]| Bench::new(table).refused(&set(words));
    let of = |code, asked, limit| Some(Fault::new(code).with(asked, limit));
    let words = |words: &[i64]| Arc::new(Table::new(Form::Words, &[], words).unwrap());
    assert_eq!(refused(words(&[1, 0, 0, 0]), &[]), of(Code::AMK_POINTS, 1, 64));
    assert_eq!(refused(words(&[65, 0, 0, 0]), &[]), of(Code::AMK_POINTS, 65, 64));
    assert_eq!(refused(words(&[2, 0, 0, 0, 9, 0, 0]), &[]), of(Code::AMK_TABLE_SHORT, 7, 8));
    assert_eq!(refused(table(&[(5, 0, 0), (5, 0, 0)]), &[]), of(Code::AMK_POINT_ORDER, 8, 5));
    assert_eq!(refused(table(&[(-5, 0, 0), (5, 0, 0)]), &[(BA, 1)]), of(Code::AMK_POINT_NEGATIVE, -5, 0));
    assert_eq!(refused(table(&[(0, 0, 0)]), &[(BA, 2)]), of(Code::AMK_NO_MODULO, 0, 1));
    assert_eq!(refused(table(&[(-5, 0, 0)]), &[]), None, "absolute");
    let long = || table(&[(5, 0, 0), (9, 0, 32_768)]);
    assert_eq!(refused(long(), &[(MODE, 16)]), of(Code::AMK_TIME_LONG, 11, 32_767));
    assert_eq!(refused(long(), &[(MODE + 2, 16)]), None, "only a track in use has pulses");
    let most = (0..63).map(|number| (number * 7, 1, 0)).collect::<Vec<_>>();
    assert_eq!(refused(table(&most), &[(BA, 1)]), None);
    let none = setting(1, [None; LINES]);
    assert_eq!(
        Binea::new(&with_memory(64, 0)).check(Words(&set(&[])), &none).unwrap_err().code,
        Code::AMK_TABLE_MISSING
    );
    let y = Arc::new(Table::new(Form::Y, &[], &[2, 0, 0, 0, 9, 0, 0, 0]).unwrap());
    assert_eq!(refused(y, &[]).unwrap().code, Code::AMK_TABLE_FORM);
}

/// Proves: AMK-BINEA-16
#[test]
fn a_mean_needs_room_only_where_it_is_taken() {
    let binea = Binea::new(&with_memory(19, 0));
    let check = |fields: &[(usize, i64)]| binea.check_mean(Words(&set(fields)));
    let fault = check(&[(FCT, 1)]).unwrap_err();
    assert_eq!((fault.code, fault.asked, fault.limit), (Code::AMK_MEAN_LONG, Number::Count(20), Number::Count(19)));
    assert_eq!(fault.field, Some(7));
    assert_eq!([check(&[]), check(&[(FCT, 1), (MEAN_FACTOR, 19)])], [Ok(()), Ok(())]);
}

#[test]
fn a_state_from_outside_may_hold_anything() {
    let mut bench = Bench::new(example());
    bench.start(&set(&[(BA, 1), (FCT, 1), (DEAD_TIME, 32_000)]), 0);
    assert!(bench.binea.is_valid_state());
    bench.binea.course.x = i64::MAX;
    assert!(!bench.binea.is_valid_state());
    bench.word = i64::MIN;
    bench.binea.has_offset_word = true;
    for value in [i64::MIN, i64::MAX, 0] {
        bench.step(value);
    }
    bench.binea.course.base = Base::Time;
    bench.call_ns = u64::MAX;
    bench.step(0);
}

/// Returns the bits of a segment by a search from the first point.
fn bits(points: &[Point], x: i64) -> u8 {
    points.iter().find(|point| x < point.0.into()).or(points.last()).map_or(0, |point| point.1 as u8)
}

proptest! {
    /// For any table and any travel, plain cams equal a search from the first point at the sum of all differences.
    #[test]
    fn outputs_are_the_segment_of_the_sum_of_all_differences(
        steps in proptest::collection::vec((1_i32..5000, 0_u16..256), 1..64),
        offset in -32_768_i64..32_768,
        ways in proptest::collection::vec(-70_000_i64..70_000, 1..40),
        ba in 0_i64..2,
    ) {
        let mut point = 0;
        let points = steps.iter().map(|(step, bits)| { point += step; (point, *bits, 0) }).collect::<Vec<_>>();
        let mut bench = Bench::new(table(&points));
        let mut place = 123;
        bench.start(&set(&[(BA, ba), (TRACKS, 8), (FEEDBACK_OFFSET, offset)]), place);
        for way in ways {
            place += way;
            let x = if ba == 0 { place + offset } else { (place - 123 + offset).rem_euclid(point.into()) };
            prop_assert_eq!(bench.step(place), bits(&points, x));
            prop_assert!(bench.binea.is_valid_state());
        }
    }
}

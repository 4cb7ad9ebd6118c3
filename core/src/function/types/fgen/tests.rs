//! Test oracles of the generator, its phases, zeroing and monitoring, and its errors.

use super::*;
use crate::function::program::{Occasion, SourceValue};
use crate::function::trial::{at_rest, set, setting};

mod laws;

const MS: u64 = 1_000_000;
const AT_REST: u8 = A1;
const MOVES: u8 = 0;

/// A generator with its inputs.
#[derive(Clone)]
struct Bench {
    fgen: Fgen,
    values: Vec<(&'static str, i64)>,
    limits: [i64; LIMITS],
    call_ns: u64,
    sink: i64,
    travel: i64,
    word: i64,
    drives: [Drive; LINES],
}

/// The example of the manual, without zeroing: 20000 inc in 2 s, ramps of 1 inc per call, a sequence.
const EXAMPLE: [(&str, i64); 6] = [
    ("fct", 1),
    ("ba", 2),
    ("cycle_time", 4000),
    ("sf_cycle_time", 2),
    ("cycle_increments", 20_000),
    ("accel", 1_000_000),
];

fn example(more: &[(&'static str, i64)]) -> Bench {
    let mut bench = Bench {
        fgen: Fgen::new(&SlotSetup::of_words([true, false])),
        values: EXAMPLE.into(),
        limits: [0; LIMITS],
        call_ns: MS,
        sink: 0,
        travel: 0,
        word: 1024,
        drives: [Drive::default(); LINES],
    };
    bench.take(more);
    bench
}

impl Bench {
    fn take(&mut self, more: &[(&'static str, i64)]) {
        for (name, value) in more {
            self.values.retain(|(known, _)| known != name);
            self.values.push((name, *value));
        }
    }

    fn words(&self) -> Vec<i64> {
        let mut words = set(FIELDS, &self.values);
        for (nth, limit) in self.limits.into_iter().enumerate() {
            words[at("pos_limit") + nth] = limit;
        }
        words
    }

    /// Returns the result of START, or of VALUE_NEW while it runs, for the set with these values changed.
    fn checked(&self, more: &[(&'static str, i64)], runs: bool) -> Result<(), Fault> {
        let mut asked = self.clone();
        asked.take(more);
        self.fgen.check(Words(&asked.words()), &Setting { runs, ..setting(self.call_ns, [None; LINES]) })
    }

    fn seen(&self, inputs: u8) -> CallInputs<'_> {
        let source = SourceValue { value: self.travel, travel: self.travel, mark: None };
        let Self { call_ns, sink, .. } = *self;
        CallInputs { call_ns, source, inputs, sink, words: [self.word, 0], drives: &self.drives, ..at_rest() }
    }

    /// Returns sink and outputs of START.
    fn start(&mut self, inputs: u8) -> (i64, u8) {
        self.checked(&[], false).expect("a set that starts");
        let mut fgen = self.fgen.clone();
        let told = fgen.start(Words(&self.words()), &self.seen(inputs));
        self.fgen = fgen;
        self.sink = told.sink;
        (told.sink, told.outputs)
    }

    fn value_new(&mut self, more: &[(&'static str, i64)]) {
        self.checked(more, true).expect("a set that it takes");
        self.take(more);
        self.fgen.apply_values(Words(&self.words()));
        self.is_sound();
    }

    fn is_sound(&self) {
        let words = self.words();
        let kept = Setting { runs: true, occasion: Occasion::Kept, ..setting(self.call_ns, [None; LINES]) };
        assert!(self.fgen.is_valid_state() && self.fgen.runs_with(Words(&words), self.call_ns));
        assert_eq!(self.fgen.check(Words(&words), &kept), Ok(()));
    }

    /// Returns sink and outputs of a call.
    fn step(&mut self, inputs: u8) -> (i64, u8) {
        let mut fgen = self.fgen.clone();
        let told = fgen.step(&self.seen(inputs));
        self.fgen = fgen;
        self.sink = told.sink;
        (told.sink, told.outputs)
    }

    /// Returns sink and outputs of the last of `calls` calls.
    fn run(&mut self, inputs: u8, calls: usize) -> (i64, u8) {
        let told = (0..calls).map(|_| self.step(inputs)).last().expect("a call");
        self.is_sound();
        told
    }

    /// Returns the travel of each of `calls` calls.
    fn ways(&mut self, inputs: u8, calls: usize) -> Vec<i64> {
        (0..calls)
            .map(|_| {
                let before = self.sink;
                self.step(inputs).0 - before
            })
            .collect()
    }
}

/// Proves: AMK-FGEN-04, AMK-FGEN-05, AMK-FGEN-06, AMK-FGEN-07, AMK-FGEN-08, AMK-FGEN-09, AMK-FGEN-10, AMK-FGEN-11, AMK-FGEN-12, AMK-FGEN-13,
/// AMK-FGEN-14, AMK-FGEN-15
#[test]
fn the_fields_are_those_of_the_commanding_block() {
    let fields: Vec<_> =
        FIELDS.iter().map(|field| (field.name, field.count, field.min, field.max, field.live)).collect();
    // Fields that only some modes need may be 0; the override is a word, the number of the function is its name.
    assert_eq!(
        fields,
        [
            ("fct", 1, 0, 7, false),
            ("ba", 1, 0, 7, true),
            ("cycle_time", 1, 0, 32_767, true),
            ("sf_cycle_time", 1, 0, 131, false),
            ("cycle_increments", 1, 1, 2_147_483_647, false),
            ("accel", 1, 1, 500_000_000, true),
            ("aw_mask", 1, 0, 254, false),
            ("pos_limit", 7, 0, 2_147_483_647, true),
            ("accel2", 1, 0, 500_000_000, true),
        ]
    );
    let row = Kind::Fgen.description();
    assert_eq!((row.words, row.inputs, row.outputs, row.tables), (&["override_addr"][..], 2, 8, 0));
}

/// Proves: AMK-FGEN-16, AMK-FGEN-25, AMK-FGEN-27, AMK-FGEN-28, AMK-FGEN-33, AMK-FGEN-39, AMK-FGEN-O1
#[test]
fn a_sequence_of_two_seconds_has_no_ramps_and_begins_anew_with_an_edge() {
    let mut bench = example(&[("fct", 3), ("aw_mask", 1)]);
    assert_eq!(bench.start(0), (0, AT_REST));
    assert_eq!(bench.run(0, 5), (0, AT_REST));
    bench.drives[0].actual = 777;
    assert_eq!(bench.ways(E1, 1999), [10; 1999]);
    assert_eq!(bench.fgen.shown()[0], 0, "zeroed by the edge, and the drive stands");
    bench.drives[0].actual = 800;
    assert_eq!(bench.step(E1), (20_000, AT_REST), "2000 calls, the last one ends it");
    assert_eq!(bench.fgen.shown()[0], 23);
    assert_eq!(bench.run(E1, 100), (20_000, AT_REST), "E1 stands");
    assert_eq!(bench.run(0, 2), (20_000, AT_REST));
    assert_eq!(bench.step(E1), (20_010, MOVES));
    assert_eq!(bench.fgen.shown()[0], 0, "zeroed again");
    assert_eq!(bench.run(E1, 1999), (40_000, AT_REST));
}

/// Proves: AMK-FGEN-20, AMK-FGEN-26, AMK-FGEN-34, AMK-FGEN-35, AMK-FGEN-36, AMK-FGEN-38, AMK-FGEN-O2
#[test]
fn an_interrupted_sequence_has_its_ramps_and_its_exact_total() {
    let mut bench = example(&[("fct", 3), ("aw_mask", 1)]);
    bench.start(0);
    assert_eq!(bench.run(E1, 500), (5000, MOVES));
    bench.drives[0].actual = 60;
    assert_eq!(bench.ways(0, 9), [9, 8, 7, 6, 5, 4, 3, 2, 1]);
    assert_eq!(bench.sink, 5045);
    assert_eq!(bench.step(0), (5045, AT_REST), "v = 0 in cycle 510");
    assert_eq!(bench.run(0, 30), (5045, AT_REST));
    assert_eq!(bench.ways(E1, 10), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    assert_eq!(bench.sink, 5100);
    assert_eq!(bench.fgen.shown()[0], 60, "continued: not zeroed");
    assert_eq!(bench.run(E1, 1489), (19_990, MOVES));
    assert_eq!(bench.step(E1), (20_000, AT_REST));
}

/// Proves: AMK-FGEN-26, AMK-FGEN-37, AMK-FGEN-39
#[test]
fn a_ramp_may_be_taken_back_and_may_reach_the_end() {
    let mut bench = example(&[]);
    bench.start(0);
    bench.run(E1, 100);
    assert_eq!(bench.ways(0, 3), [9, 8, 7]);
    assert_eq!(bench.ways(E1, 4), [8, 9, 10, 10], "from the present velocity");
    // 1061 so far; 19 before the end it ramps down; of the next 7, 2 are left.
    bench.run(E1, 1892);
    assert_eq!(bench.sink, 1000 + 24 + 37 + 18_920);
    assert_eq!(bench.ways(0, 2), [9, 8]);
    assert_eq!(bench.step(0), (20_000, AT_REST));
    assert_eq!(bench.ways(0, 3), [0; 3]);
}

/// Proves: AMK-FGEN-19, AMK-FGEN-24, AMK-FGEN-29, AMK-FGEN-32, AMK-FGEN-40
#[test]
fn continuous_starts_stops_and_goes_on_by_ramps_and_zeroes_once() {
    let mut bench = example(&[("ba", 0), ("fct", 3), ("aw_mask", 0b10), ("accel", 2_500_000)]);
    bench.start(E1);
    assert_eq!(bench.ways(E1, 3), [0; 3], "an input that stands at START is no edge");
    bench.drives[0].actual = 5;
    bench.drives[1].actual = 500;
    bench.step(0);
    assert_eq!(bench.fgen.shown()[..2], [5, 500], "not zeroed yet");
    // A ramp of 2.5 inc per call: 2.5, 5, 7.5, 10; the sum is rounded down.
    assert_eq!(bench.ways(E1, 6), [2, 5, 8, 10, 10, 10]);
    bench.drives[1].actual = 530;
    assert_eq!(bench.ways(0, 5), [7, 5, 3, 0, 0]);
    assert_eq!(bench.step(0).1, AT_REST);
    assert_eq!(bench.fgen.shown()[..2], [5, 30]);
    assert_eq!(bench.ways(E1, 4), [2, 5, 8, 10]);
    assert_eq!(bench.fgen.shown()[1], 30, "continued (G3)");
    assert_eq!(bench.run(E1, 5000).1, MOVES, "without end");
}

/// Proves: AMK-FGEN-18, AMK-FGEN-19
#[test]
fn an_override_scales_reverses_and_holds_by_ramps() {
    let mut bench = example(&[("ba", 0)]);
    bench.start(0);
    bench.run(E1, 20);
    bench.word = 512;
    assert_eq!(bench.ways(E1, 7), [9, 8, 7, 6, 5, 5, 5]);
    bench.word = 9999;
    assert_eq!(bench.run(E1, 40).1, MOVES);
    assert_eq!(bench.ways(E1, 2), [20, 20], "200 % at most");
    bench.word = 0;
    bench.run(E1, 20);
    assert_eq!(bench.ways(E1, 3), [0; 3]);
    assert_eq!(bench.step(E1).1, MOVES, "it runs all the same (G1)");
    bench.word = -1024;
    assert_eq!(bench.ways(E1, 12), [-1, -2, -3, -4, -5, -6, -7, -8, -9, -10, -10, -10]);
    bench.word = i64::MIN;
    bench.run(E1, 40);
    assert_eq!(bench.ways(E1, 2), [-20, -20]);
    // Without a word there is no scaling.
    let mut bench = example(&[("ba", 0)]);
    (bench.fgen, bench.word) = (Fgen::new(&SlotSetup::of_words([false, false])), 0);
    bench.start(0);
    assert_eq!(bench.ways(E1, 12)[9..], [10, 10, 10]);
}

/// Proves: AMK-FGEN-21
#[test]
fn the_second_input_changes_the_slope_at_once() {
    let mut bench = example(&[("ba", 4), ("accel2", 3_000_000)]);
    bench.start(0);
    assert_eq!(bench.ways(E1, 2), [1, 2]);
    assert_eq!(bench.ways(E1 | E2, 2), [5, 8]);
    assert_eq!(bench.ways(E1, 3), [9, 10, 10]);
    assert_eq!(bench.ways(0, 2), [9, 8], "in the middle of the ramp");
    assert_eq!(bench.ways(E2, 4), [5, 2, 0, 0]);
    // With one acceleration there is no second input.
    let mut bench = example(&[("ba", 0), ("accel2", 3_000_000)]);
    bench.start(0);
    assert_eq!(bench.ways(E1 | E2, 3), [1, 2, 3]);
}

/// Proves: AMK-FGEN-03, AMK-FGEN-17, AMK-FGEN-19, AMK-FGEN-30
#[test]
fn an_external_velocity_is_the_way_of_the_source() {
    let mut bench = example(&[("ba", 1), ("cycle_time", 0), ("accel", 500_000_000)]);
    let follow = |bench: &mut Bench, inputs: u8, ways: &[i64]| -> Vec<i64> {
        ways.iter()
            .map(|way| {
                bench.travel += way;
                bench.ways(inputs, 1)[0]
            })
            .collect()
    };
    bench.start(0);
    assert_eq!(follow(&mut bench, 0, &[7, 9]), [0, 0]);
    assert_eq!(follow(&mut bench, E1, &[7, 9, -3, 0, 400]), [7, 9, -3, 0, 400]);
    bench.word = -512;
    assert_eq!(follow(&mut bench, E1, &[7, 7, 7, 7]), [-4, -3, -4, -3]);
    assert_eq!(follow(&mut bench, 0, &[7]), [0], "interrupted");
    assert_eq!(bench.step(0).1, AT_REST);
    // The ramps are those of the set.
    bench.value_new(&[("accel", 1_000_000)]);
    bench.word = 1024;
    assert_eq!(follow(&mut bench, E1, &[5, 5, 5, 5, 5, 5, 2, 2, 2, 2]), [1, 2, 3, 4, 5, 5, 4, 3, 2, 2]);
    // A sequence ends at its increments.
    let mut bench = example(&[("ba", 3), ("cycle_increments", 20), ("accel", 500_000_000)]);
    bench.start(0);
    assert_eq!(follow(&mut bench, E1, &[9, 9, 9, 9]), [9, 9, 2, 0]);
    assert_eq!(follow(&mut bench, 0, &[9]), [0]);
    assert_eq!(follow(&mut bench, E1, &[-9, -9, -9, -9]), [-9, -9, -2, 0]);
}

/// Proves: AMK-FGEN-22
#[test]
fn fractions_are_carried() {
    // 1000 inc in 700 calls of 0.75 ms: 525 ms are 1050 half milliseconds.
    let mut bench = example(&[
        ("ba", 0),
        ("cycle_increments", 1000),
        ("cycle_time", 1050),
        ("accel", 500_000_000),
        ("sf_cycle_time", 0),
    ]);
    bench.call_ns = 750_000;
    bench.start(0);
    for turn in 1..=50 {
        assert_eq!(bench.run(E1, 700), (1000 * turn, MOVES));
    }
    // A small acceleration is not lost by rounding: 1 inc/s^2 is 10^-6 inc per call, and increases with each call; n (n
    // + 1) / 2 of them.
    let mut bench = example(&[("ba", 0), ("accel", 1)]);
    bench.start(0);
    assert_eq!(bench.run(E1, 1413), (0, MOVES), "998991 of 10^6");
    assert_eq!(bench.run(E1, 1), (1, MOVES), "1000405");
    assert_eq!(bench.run(E1, 586), (2, MOVES), "2001000 behind 2000 calls");
}

/// In negative direction, rounding down shows the last increment early: the sequence must not end at it.
///
/// Proves: AMK-FGEN-25
#[test]
fn a_sequence_backwards_lasts_as_long_as_forwards() {
    for sign in [1, -1] {
        let mut bench = example(&[("cycle_increments", 10), ("cycle_time", 2000)]);
        bench.word = 1024 * sign;
        bench.start(0);
        assert_eq!(bench.run(E1, 999).1, MOVES, "{sign}");
        assert_eq!(bench.step(E1), (10 * sign, AT_REST), "{sign}");
    }
}

/// Proves: AMK-FGEN-31
#[test]
fn continuous_becomes_a_sequence_that_ends_at_the_next_boundary_and_back() {
    let mut bench = example(&[("ba", 0), ("cycle_increments", 100), ("cycle_time", 20), ("accel", 500_000_000)]);
    bench.start(0);
    assert_eq!(bench.run(E1, 23), (230, MOVES));
    bench.value_new(&[("ba", 2)]);
    assert_eq!(bench.run(E1, 6), (290, MOVES));
    assert_eq!(bench.step(E1), (300, AT_REST));
    assert_eq!(bench.run(E1, 3), (300, AT_REST));
    bench.step(0);
    bench.run(E1, 3);
    bench.value_new(&[("ba", 0)]);
    assert_eq!(bench.run(E1, 50), (830, MOVES), "runs just on");
    // In negative direction the boundaries are the lower ones.
    bench.word = -1024;
    assert_eq!(bench.run(E1, 83 + 23), (-230, MOVES));
    bench.value_new(&[("ba", 2)]);
    // The travel counts from the start at 300: it is at -530, the next boundary at -600.
    assert_eq!(bench.run(E1, 6), (-290, MOVES));
    assert_eq!(bench.step(E1), (-300, AT_REST));
    for refused in [1, 3, 4, 6, 7] {
        let fault = bench.checked(&[("ba", refused), ("accel2", 1)], true).expect_err("bits 0 and 2");
        assert_eq!(fault, Fault::new(Code::AMK_BA_KEPT).of(1).with(refused, refused & 2));
    }
    assert_eq!(bench.checked(&[("ba", 1)], false), Ok(()), "START takes all");
}

#[test]
fn a_boundary_in_the_middle_of_an_increment_is_met_too() {
    // 2.5 inc per call, 100 per turn.
    let mut bench = example(&[("ba", 0), ("cycle_increments", 100), ("cycle_time", 80), ("accel", 500_000_000)]);
    bench.word = -1024;
    bench.start(0);
    assert_eq!(bench.run(E1, 39), (-98, MOVES));
    bench.value_new(&[("ba", 2)]);
    assert_eq!(bench.step(E1), (-100, AT_REST));
}

/// Proves: AMK-FGEN-19, AMK-FGEN-23
#[test]
fn value_new_of_the_time_is_a_ramp_and_of_a_velocity_beyond_16_bits_is_refused() {
    let mut bench = example(&[("ba", 0)]);
    bench.start(0);
    bench.run(E1, 20);
    bench.value_new(&[("cycle_time", 8000)]);
    assert_eq!(bench.ways(E1, 7), [9, 8, 7, 6, 5, 5, 5]);
    bench.value_new(&[("cycle_time", 4000), ("accel", 5_000_000)]);
    assert_eq!(bench.ways(E1, 3), [10, 10, 10]);
    // 20000 inc in 1 ms, twice that with an override.
    let fault = bench.checked(&[("cycle_time", 2)], true).expect_err("too fast");
    assert_eq!(fault, Fault::new(Code::AMK_CALL_WAY).of(2).with(40_000, 32_767));
    assert_eq!(bench.checked(&[("cycle_time", 3)], true), Ok(()), "26666.7");
    let is_taken = |increments: i64, time: i64, has_word: bool| {
        let mut bench = example(&[("cycle_increments", increments), ("cycle_time", time)]);
        bench.fgen = Fgen::new(&SlotSetup::of_words([has_word, false]));
        bench.checked(&[], false).is_ok()
    };
    assert!(is_taken(32_767, 2, false) && !is_taken(32_768, 2, false));
    assert!(is_taken(16_383, 2, true) && !is_taken(16_384, 2, true));
    assert!(!is_taken(65_535, 4, false), "32767.5 in a call are 32768 in some");
}

/// Proves: AMK-FGEN-41, AMK-FGEN-42, AMK-FGEN-43, AMK-FGEN-O5
#[test]
fn limits_of_the_chosen_axes_are_outputs_in_their_order() {
    let mut bench = example(&[("fct", 5), ("aw_mask", 129)]);
    bench.limits[..2].copy_from_slice(&[1000, 500]);
    bench.start(0);
    let mut at = |first: i64, second: i64, eighth: i64| {
        (bench.drives[0].actual, bench.drives[1].actual, bench.drives[7].actual) = (first, second, eighth);
        bench.step(0).1 >> 1
    };
    assert_eq!(at(1001, 9999, 499), 0b01);
    assert_eq!(at(1000, 0, 500), 0, "beyond, not at");
    assert_eq!(at(-1001, 0, -501), 0b11, "by its magnitude (G7)");
    assert_eq!(at(0, 0, i64::MIN), 0b10);
    assert_eq!(at(0, -9999, 0), 0, "not latched");
    bench.limits[1] = 400;
    let words = bench.words();
    bench.fgen.apply_values(Words(&words));
    bench.drives[7].actual = 450;
    assert_eq!(bench.step(0).1 >> 1, 0b10);
    // A limit of 0 applies, and seven axes have seven outputs.
    let mut bench = example(&[("fct", 4), ("aw_mask", 254)]);
    bench.start(0);
    bench.drives.iter_mut().for_each(|drive| drive.actual = 1);
    assert_eq!(bench.step(0).1 >> 1, 0b111_1111);
}

/// Proves: AMK-FGEN-40, AMK-FGEN-42
#[test]
fn without_a_generator_edges_zero_and_the_sink_stays() {
    let mut bench = example(&[("fct", 6), ("aw_mask", 1)]);
    bench.limits[0] = 10;
    bench.sink = 77;
    bench.drives[0].actual = 1000;
    bench.drives[1].actual = 1000;
    assert_eq!(bench.start(0), (77, 0b11), "raw before the first edge");
    for actual in [1000, 2000] {
        bench.drives[0].actual = actual;
        assert_eq!(bench.step(E1), (77, 0b01), "each edge zeroes (G11)");
        assert_eq!(bench.fgen.shown()[..2], [0, 1000], "AW2 is not chosen");
        bench.drives[0].actual += 11;
        assert_eq!((bench.step(0), bench.fgen.shown()[0]), ((77, 0b11), 11));
    }
    let writes = |fct: i64| {
        let mut bench = example(&[("fct", fct)]);
        bench.start(0);
        bench.fgen.clone().step(&bench.seen(E1)).writes
    };
    assert_eq!([0, 1, 2, 4, 7].map(writes), [0, 0b1, 0, 0b1111_1110, 0xFF]);
}

/// Proves: AMK-FGEN-03, AMK-FGEN-09, AMK-FGEN-15
#[test]
fn invalid_field_of_generator_is_refused() {
    let refused = |more: &[(&'static str, i64)]| example(&[]).checked(more, false).err();
    let fault = |code, field| Some(Fault::new(code).of(field));
    assert_eq!(refused(&[]), None);
    assert_eq!(refused(&[("cycle_time", 0)]), fault(Code::AMK_NOT_ZERO, 2).map(|fault| fault.with(0, 32_767)));
    assert_eq!(refused(&[("ba", 6)]), fault(Code::AMK_NOT_ZERO, 8).map(|fault| fault.with(0, 500_000_000)));
    assert_eq!(refused(&[("ba", 1), ("cycle_time", 0)]), None, "the time is not used");
    assert_eq!(refused(&[("sf_cycle_time", 3)]).map(|fault| fault.code), Some(Code::AMK_CYCLE_MISMATCH));
    let bench = example(&[("ba", 1)]);
    let setting = Setting { has_source: false, ..setting(MS, [None; LINES]) };
    let fault = bench.fgen.check(Words(&bench.words()), &setting).expect_err("no source");
    assert_eq!(fault, Fault::new(Code::AMK_NO_SOURCE).of(1).with(1, 0));
}

/// In the cycle of START the set may be changed again before the first call; the state can be read at any time.
#[test]
fn generator_before_start_is_valid_and_accepts_values() {
    for has_word in [false, true] {
        let mut fgen = Fgen::new(&SlotSetup::of_words([has_word, false]));
        assert!(fgen.is_valid_state());
        fgen.apply_values(Words(&example(&[("ba", 2)]).words()));
        assert!(fgen.is_valid_state());
        assert_eq!(fgen.motion.advance(), 0);
    }
}

#[test]
fn it_begins_at_what_the_sink_has_and_counts_round_in_it() {
    let mut bench = example(&[("ba", 0), ("accel", 500_000_000)]);
    bench.sink = i64::MAX - 5;
    assert_eq!(bench.start(0), (i64::MAX - 5, AT_REST));
    assert_eq!(bench.step(E1).0, i64::MIN + 4, "64 bits wrap, as 16 and 32 do in the slot (FGEN-22)");
}

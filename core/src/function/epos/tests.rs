//! Test oracles of the positioning, its edges and phases, both overrides, its errors, and its laws for all sets.

use super::super::program::{LINES, Occasion, SourceValue};
use super::super::trial::{at_rest, set, setting};
use super::*;
use crate::event::Number;
use proptest::prelude::*;

const MS: u64 = 1_000_000;
const MOVES: u8 = 0;
const PARTS_OF_MM: i128 = INC / 1000;

/// A positioning with its inputs.
#[derive(Clone)]
struct Bench {
    epos: Epos,
    values: Vec<(&'static str, i64)>,
    call_ns: u64,
    sink: i64,
    travel: i64,
    words: [i64; WORDS],
    has_source: bool,
    has_mark: bool,
}

/// The example of the manual as a relative order: 33.333 inc per call, ramps of 4 and 16 inc per call.
const EXAMPLE: [(&str, i64); 7] = [
    ("ba", 0),
    ("sf_cycle", 2),
    ("travel", 20_000),
    ("velocity", 1_000_000),
    ("acceleration", 200_000),
    ("stop_decel", 800_000),
    ("drive_resolution", 20_000),
];

fn example(more: &[(&'static str, i64)]) -> Bench {
    let mut bench = Bench {
        epos: Epos::new([true; WORDS]),
        values: EXAMPLE.into(),
        call_ns: MS,
        sink: 0,
        travel: 0,
        words: [1024; WORDS],
        has_source: true,
        has_mark: true,
    };
    bench.take(more);
    bench
}

/// Returns the same bench after START.
fn started(more: &[(&'static str, i64)]) -> Bench {
    let mut bench = example(more);
    assert_eq!(bench.start(0), (0, A1));
    bench
}

impl Bench {
    fn take(&mut self, more: &[(&'static str, i64)]) {
        for (name, value) in more {
            self.values.retain(|(known, _)| known != name);
            self.values.push((name, *value));
        }
    }

    fn setting(&self) -> Setting<'_> {
        let Self { has_source, has_mark, .. } = *self;
        Setting { has_source, has_mark, ..setting(self.call_ns, [None; LINES]) }
    }

    /// Returns the result of START for the set with these values changed.
    fn checked(&self, more: &[(&'static str, i64)]) -> Result<(), Fault> {
        let mut asked = self.clone();
        asked.take(more);
        self.epos.check(Words(&set(FIELDS, &asked.values)), &self.setting())
    }

    fn seen(&self, inputs: u8, mark: Option<i64>) -> CallInputs<'static> {
        let source = SourceValue { value: self.travel, travel: self.travel, mark };
        let Self { call_ns, sink, words, .. } = *self;
        CallInputs { call_ns, source, inputs, sink, words, ..at_rest() }
    }

    fn start(&mut self, inputs: u8) -> (i64, u8) {
        self.checked(&[]).expect("a set that starts");
        let told = self.epos.start(Words(&set(FIELDS, &self.values)), &self.seen(inputs, None));
        self.tell(told)
    }

    fn value_new(&mut self, more: &[(&'static str, i64)]) {
        self.checked(more).expect("a set that it takes");
        self.take(more);
        self.epos.apply_values(Words(&set(FIELDS, &self.values)));
        self.is_sound();
    }

    fn is_sound(&self) {
        let words = set(FIELDS, &self.values);
        let kept = Setting { runs: true, occasion: Occasion::Kept, ..self.setting() };
        assert!(self.epos.is_valid_state() && self.epos.runs_with(Words(&words), self.call_ns), "{:?}", self.epos);
        assert_eq!(self.epos.check(Words(&words), &kept), Ok(()));
    }

    fn tell(&mut self, told: Outcome) -> (i64, u8) {
        self.sink = told.sink;
        assert_eq!(told.writes, if self.epos.mode.modulo { A1 | A2 } else { A1 });
        (told.sink, told.outputs)
    }

    /// Returns sink and outputs of a call.
    fn step(&mut self, inputs: u8) -> (i64, u8) {
        let told = self.epos.step(&self.seen(inputs, None));
        assert_eq!(told.coordinate_change, 0);
        self.tell(told)
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

    /// Returns the number of calls until A1 is 1 again.
    fn until_rest(&mut self, inputs: u8) -> usize {
        for calls in 1..100_000 {
            if self.step(inputs).1 & A1 != 0 {
                self.is_sound();
                return calls;
            }
        }
        panic!("it never rests: {:?}", self.epos);
    }

    /// A call with a zero pulse `behind` increments behind the command: the sink counts from the pulse then.
    fn mark(&mut self, inputs: u8, behind: i64) -> (i64, u8) {
        let place = self.sink - behind;
        let told = self.epos.step(&self.seen(inputs, Some(place)));
        assert_eq!(told.coordinate_change, -place);
        self.is_sound();
        self.tell(told)
    }
}

/// Proves: AMK-EPOS-47, AMK-EPOS-48, AMK-EPOS-49, AMK-EPOS-50, AMK-EPOS-51, AMK-EPOS-52, AMK-EPOS-53, AMK-EPOS-54, AMK-EPOS-55, AMK-EPOS-56,
/// AMK-EPOS-57, AMK-EPOS-58, AMK-EPOS-59
#[test]
fn the_fields_are_those_of_the_commanding_record() {
    let fields: Vec<_> = FIELDS.iter().map(|field| (field.name, field.min, field.max, field.live)).collect();
    // Fields that only some modes need may be 0; overrides are words, the number of the function is its name.
    assert_eq!(
        fields,
        [
            ("ba", 0, 31, false),
            ("sf_cycle", 0, 131, false),
            ("travel", -2_147_483_648, 2_147_483_647, true),
            ("velocity", -2_147_483_648, 2_147_483_647, true),
            ("acceleration", 1, 100_000_000, true),
            ("stop_decel", 1, 100_000_000, true),
            ("drive_resolution", 1, 2_147_483_647, false),
            ("master_resolution", 0, 2_147_483_647, false),
        ]
    );
    let row = super::super::kind::Kind::Epos.description();
    assert_eq!((row.words, row.inputs, row.outputs), (&["vel_override_mw", "acc_override_mw"][..], 2, 2));
    assert!(row.renews && row.rests == A1);
}

/// 8 calls up, 592 at 33.333, 8 down: 144 + 19733.3 + 122.7.
///
/// Proves: AMK-EPOS-02, AMK-EPOS-05, AMK-EPOS-06, AMK-EPOS-08, AMK-EPOS-11, AMK-EPOS-24, AMK-EPOS-27, AMK-EPOS-28, AMK-EPOS-29, AMK-EPOS-30,
/// AMK-EPOS-36, AMK-EPOS-O1
#[test]
fn the_oracle_move_takes_608_calls_and_ends_exactly() {
    for sense in [1, -1] {
        let mut bench = started(&[("travel", 20_000 * sense)]);
        assert_eq!(bench.run(0, 5), (0, A1));
        let mut ways = bench.ways(E1, 11);
        if sense > 0 {
            // 144 after eight calls, then 177.3, 210.7, and 244 less a part lost by rounding.
            assert_eq!(ways, [4, 8, 12, 16, 20, 24, 28, 32, 33, 33, 33]);
        }
        assert_eq!(bench.epos.shown(), [20_000 * sense - bench.sink]);
        assert_eq!(bench.step(0).1, MOVES, "E1 may go");
        ways.extend(bench.ways(0, 594));
        assert_eq!(bench.step(0).1, MOVES, "607");
        assert_eq!(bench.step(0), (20_000 * sense, A1), "608");
        assert!(ways.iter().all(|way| (0..=34).contains(&(way * sense))));
        assert_eq!(bench.ways(E1, 1)[0].abs(), 4, "the next order begins");
    }
}

/// Proves: AMK-EPOS-28, AMK-EPOS-36
#[test]
fn an_order_of_nothing_moves_nothing_and_shows_itself_for_a_call() {
    let mut bench = started(&[("travel", 0)]);
    assert_eq!((bench.step(E1), bench.step(E1)), ((0, MOVES), (0, A1)));
    // An order that ends in its first call as well.
    bench.value_new(&[("travel", 3)]);
    assert_eq!(bench.step(0), (0, A1));
    assert_eq!((bench.step(E1), bench.step(E1)), ((3, MOVES), (3, A1)));
    // E1 = 1 at START is no edge.
    let mut bench = example(&[]);
    assert_eq!(bench.start(E1), (0, A1));
    assert_eq!(bench.run(E1, 5), (0, A1));
}

/// Too short for 33.333 inc: up and down at once, 4 + 8 + 12 + 16 + 12 + 8 + 4.
///
/// Proves: AMK-EPOS-05
#[test]
fn a_short_travel_is_a_triangle() {
    let mut bench = started(&[("travel", 64)]);
    assert_eq!(bench.ways(E1, 8), [4, 8, 12, 16, 12, 8, 4, 0]);
    assert_eq!(bench.step(E1).1, A1);
}

/// From 33.333 inc: 17.3, 1.3, rest; the exact travel so far differs by up to a third of an increment.
///
/// Proves: AMK-EPOS-25, AMK-EPOS-33, AMK-EPOS-34, AMK-EPOS-35, AMK-EPOS-O1
#[test]
fn a_stop_keeps_what_is_left_and_the_next_edge_goes_on() {
    let mut bench = started(&[]);
    bench.run(E1, 8 + 30);
    assert_eq!(bench.sink, 1143, "144 + 30 times 33.333, rounded down");
    assert_eq!(bench.ways(E1 | E2, 2), [18, 1], "1161.3, 1162.7");
    assert_eq!(bench.step(E1 | E2), (1162, A1));
    assert_eq!(bench.epos.shown(), [20_000 - 1162]);
    // The levels of E1 and E2 have no effect; both edges at once are a stop.
    assert_eq!(bench.run(E2, 3), (1162, A1));
    bench.run(0, 2);
    assert_eq!(bench.run(E1 | E2, 3), (1162, A1));
    bench.run(E2, 1);
    // New values apply from the next order on.
    bench.value_new(&[("travel", 7), ("velocity", 5_000_000)]);
    assert_eq!(bench.step(E1 | E2).1, MOVES, "the level of E2 holds nothing");
    assert!(bench.ways(E1, 300).into_iter().all(|way| way <= 34));
    bench.until_rest(E1);
    assert_eq!(bench.sink, 20_000);
    bench.run(0, 1);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 20_007);
}

/// Proves: AMK-EPOS-33
#[test]
fn a_stop_on_the_ramp_down_never_passes_the_end_and_an_edge_on_its_ramp_is_none() {
    // 29.3 in the first call of the ramp down; then 6 less in each call: 23.3, 17.3, 11.3, 5.3, rest.
    let mut bench = started(&[("stop_decel", 300_000)]);
    bench.run(E1, 601);
    let before = bench.sink;
    bench.step(E1 | E2);
    bench.step(0);
    assert_eq!(bench.until_rest(E1), 3, "its edge is on the ramp");
    assert!((57..=58).contains(&(bench.sink - before)));
    let halted = bench.sink;
    assert_eq!(bench.run(E1, 20), (halted, A1));
    bench.run(0, 1);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 20_000);
    // With the same ramp as at the end, it stops at the end.
    let mut bench = started(&[("stop_decel", 200_000)]);
    bench.run(E1, 601);
    assert_eq!((bench.until_rest(E2), bench.sink, bench.epos.phase), (7, 20_000, Phase::Idle));
}

/// Proves: AMK-EPOS-13, AMK-EPOS-O2
#[test]
fn the_override_of_the_velocity_counts_at_once_and_by_the_ramp() {
    let three = |bench: &mut Bench, word: i64| {
        bench.words[0] = word;
        bench.run(E1, 40);
        bench.ways(E1, 3).into_iter().sum::<i64>()
    };
    let mut bench = started(&[("travel", 2_000_000)]);
    assert_eq!(three(&mut bench, 512), 50, "16.667");
    assert_eq!(three(&mut bench, 2048), 200, "66.667");
    assert_eq!(three(&mut bench, 0), 0);
    assert_eq!(bench.run(E1, 3).1, MOVES, "held is not at rest (A-40)");
    assert_eq!(three(&mut bench, 1024), 100);
    assert_eq!(three(&mut bench, -5), 0, "below 0 is 0 (A-39)");
    // 3200 %: 1066.6 inc, after 267 calls.
    bench.words[0] = 99_999;
    bench.run(E1, 300);
    assert_eq!(bench.epos.velocity * 1024 / INC, 33_333_333 * 32_767 / 1_000_000);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 2_000_000);
    // Without a word there is no scaling.
    let mut bench = started(&[]);
    bench.epos.has_words = [false; WORDS];
    bench.words = [0; WORDS];
    assert_eq!(bench.ways(E1, 9), [4, 8, 12, 16, 20, 24, 28, 32, 33]);
}

/// 102/1024 of 4 inc are 0.3984 inc; a change without an edge has no effect.
///
/// Proves: AMK-EPOS-14, AMK-EPOS-O2
#[test]
fn the_override_of_the_acceleration_is_that_of_the_edge() {
    for (word, ramp) in [(50, 102), (-5, 102), (101, 102), (103, 103), (1024, 1024), (1500, 1024)] {
        let mut bench = started(&[]);
        bench.words[1] = word;
        bench.step(E1);
        bench.words[1] = 600;
        bench.run(E1, 5);
        assert_eq!(bench.epos.velocity, 6 * (4 * INC * ramp / 1024), "{word}");
        // The stop ramp is not scaled: 16 inc, more than the velocity.
        assert_eq!(bench.epos.ramps.1, 16 * INC);
        bench.step(E2);
        bench.run(E2, 3);
        bench.step(0);
        bench.step(E1);
        assert_eq!(bench.epos.velocity, 4 * INC * 600 / 1024, "an edge that goes on samples it, too");
        bench.until_rest(E1);
        assert_eq!(bench.sink, 20_000);
    }
}

/// 500 inc of a master with 1000 inc per turn: half a turn per call would be 10000 inc of the drive; at 1 inc, 20.
///
/// Proves: AMK-EPOS-07, AMK-EPOS-12
#[test]
fn an_external_velocity_is_that_of_the_source_without_its_sense() {
    let mut bench = started(&[("ba", 1), ("velocity", 0), ("master_resolution", 1000), ("travel", -5000)]);
    let follow = |bench: &mut Bench, ways: &[i64]| -> Vec<i64> {
        ways.iter()
            .map(|way| {
                bench.travel += way;
                bench.ways(E1, 1)[0]
            })
            .collect()
    };
    assert_eq!(follow(&mut bench, &[1, 1, 1, 1, 1, 1]), [-4, -8, -12, -16, -20, -20]);
    assert_eq!(follow(&mut bench, &[-1, -1]), [-20, -20], "the absolute value (A-42)");
    assert_eq!(follow(&mut bench, &[0, 0, 0, 0, 0, 0]), [-16, -12, -8, -4, 0, 0]);
    assert_eq!(bench.step(E1).1, MOVES);
    bench.words[0] = 512;
    assert_eq!(follow(&mut bench, &[1, 1, 1, 1]), [-4, -8, -10, -10]);
    for _ in 0..1000 {
        bench.travel += 3;
        bench.step(E1);
    }
    assert_eq!(bench.sink, -5000);
}

/// Proves: AMK-EPOS-18, AMK-EPOS-20, AMK-EPOS-32, AMK-EPOS-O4
#[test]
fn a_start_while_it_moves_adds_to_what_is_left() {
    // 5000 left, 20000 more.
    let mut bench = started(&[("ba", 8)]);
    while bench.sink < 15_000 {
        bench.step(E1);
    }
    bench.step(0);
    bench.step(E1);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 40_000);
    // 20000 back: 15000 net, through zero by the ramp. From 33.333 it travels another 29.3 + 25.3 + .. + 1.3 = 122.7.
    let mut bench = started(&[("ba", 8)]);
    while bench.sink < 15_000 {
        bench.step(E1);
    }
    bench.value_new(&[("travel", -20_000)]);
    bench.step(0);
    let ways = bench.ways(E1, 12);
    assert!((122..=123).contains(&ways.iter().filter(|way| **way > 0).sum::<i64>()), "{ways:?}");
    assert!(ways.windows(2).all(|pair| pair[0] - pair[1] <= 5));
    bench.until_rest(0);
    assert_eq!(bench.sink, 0);
    // On the ramp down as well.
    let mut bench = started(&[("ba", 8)]);
    bench.run(E1, 604);
    bench.step(0);
    bench.step(E1);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 40_000);
    // Without bit 3 the edge is ignored.
    let mut bench = started(&[]);
    bench.run(E1, 300);
    bench.step(0);
    bench.until_rest(E1);
    assert_eq!(bench.sink, 20_000);
}

/// After a travel in the other direction the remaining distance may be too short for the ramp, without a change of
/// direction.
///
/// Proves: AMK-EPOS-20
#[test]
fn too_near_end_is_passed_and_returned_to() {
    let mut bench = started(&[("ba", 8)]);
    bench.run(E1, 100);
    bench.step(0);
    let end = bench.sink + 50;
    bench.value_new(&[("travel", end - 20_000)]);
    let peak = (0..40).map(|_| bench.step(E1).0).max().expect("calls");
    // From 33.333 down by 4 per call: 122.7 further.
    assert!((end + 72..=end + 73).contains(&peak), "{peak} {end}");
    bench.until_rest(E1);
    assert_eq!(bench.sink, end);
}

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

/// Event of a call.
#[derive(Clone, Debug)]
enum Happening {
    Inputs(u8),
    Travel(i64),
    Velocity(i64),
    Ramps(i64, i64),
    Words(i64, i64),
    Calls(usize),
}

fn happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        4 => (0_u8..4).prop_map(Happening::Inputs),
        1 => prop_oneof![-3000_i64..3000, Just(0)].prop_map(Happening::Travel),
        1 => (1_i64..20_000_000).prop_map(Happening::Velocity),
        1 => (1_000_i64..1_000_000, 0_i64..1_000_000).prop_map(|(up, more)| Happening::Ramps(up, up + more)),
        1 => (-100_i64..3000, -100_i64..1200).prop_map(|(velocity, acceleration)| Happening::Words(velocity, acceleration)),
        3 => (1_usize..80).prop_map(Happening::Calls),
    ]
}

proptest! {
    /// From any state: the end is the sum of the orders, no call is faster than the velocity before or the target, and
    /// no call changes the velocity by more than a ramp, except where a flatter ramp would pass the end.
    #[test]
    fn orders_end_exactly_at_their_sum(
        retriggers in any::<bool>(),
        resolution in 1_i64..100_000,
        happenings in prop::collection::vec(happening(), 1..60),
    ) {
        let mut bench = started(&[("ba", if retriggers { 8 } else { 0 }), ("travel", 500), ("drive_resolution", resolution)]);
        let (mut inputs, mut before, mut end) = (0, 0, 0);
        for what in happenings.into_iter().chain([Happening::Words(1024, 1024), Happening::Inputs(0), Happening::Inputs(1)]) {
            let mut calls = 1;
            match what {
                Happening::Inputs(bits) => inputs = bits,
                Happening::Travel(travel) => bench.value_new(&[("travel", travel)]),
                Happening::Velocity(velocity) => bench.value_new(&[("velocity", velocity)]),
                Happening::Ramps(up, stop) => bench.value_new(&[("acceleration", up), ("stop_decel", stop)]),
                Happening::Words(velocity, acceleration) => bench.words = [velocity, acceleration],
                Happening::Calls(more) => calls = more,
            }
            for _ in 0..calls {
                let was = bench.epos.clone();
                let goes = inputs & !before & (E1 | E2) == E1;
                before = inputs;
                let adds = goes && (was.phase == Phase::Idle || was.phase == Phase::Run && retriggers);
                if adds {
                    end += bench.epos.live.travel;
                }
                let (sink, outputs) = bench.step(inputs);
                let epos = &bench.epos;
                // The travel of the call: the velocity is 0 at the end.
                let way = whole(epos.position - was.position) + epos.rest - was.rest;
                let from = was.velocity;
                let stops = was.phase == Phase::Stopping || was.phase == Phase::Run && inputs & !was.before & E2 != 0;
                let ramp = if stops { epos.ramps.1 } else { epos.ramps.0 };
                let is_tight = !is_long_enough(from.abs() - ramp, was.left.abs(), ramp);
                prop_assert!((way - from).abs() <= ramp || way.abs() < from.abs() && is_tight, "{:?} {:?}", was, epos);
                let ends = epos.phase == Phase::Idle && way != 0;
                prop_assert!(!ends || way.abs() <= ramp || is_tight, "{:?} {:?}", was, epos);
                let wanted = epos.target_velocity(0, bench.words[0]);
                prop_assert!(way.abs() <= from.abs().max(wanted));
                if epos.phase == Phase::Idle {
                    prop_assert_eq!((sink, outputs), (end, A1));
                    prop_assert_eq!(epos.rest, 0);
                }
            }
        }
        bench.is_sound();
        // At 100 % every order ends: a stopped one continues with the last edge, or another edge starts it again.
        for _ in 0..3 {
            if bench.epos.phase != Phase::Idle {
                bench.run(0, 1);
                if bench.epos.phase == Phase::Run { bench.until_rest(0); }
                if bench.epos.phase == Phase::Halted { bench.step(E1); }
                while !matches!(bench.epos.phase, Phase::Idle | Phase::Halted) { bench.step(0); }
            }
        }
        prop_assert_eq!(bench.epos.phase, Phase::Idle);
        prop_assert_eq!(bench.sink, end);
    }

    /// Fields at their limits, and calls of any length: nothing wraps, and the state stays valid.
    #[test]
    fn sets_at_their_bounds_have_room(
        ba in 0_i64..32,
        travel in prop::sample::select(vec![i64::from(i32::MIN), -1, 1, i64::from(i32::MAX)]),
        velocity in prop::sample::select(vec![i64::from(i32::MIN), 1, i64::from(i32::MAX)]),
        rates in prop::sample::select(vec![(1, 1), (1, STEEPEST), (STEEPEST, STEEPEST)]),
        turns in prop::sample::select(vec![(1, 1), (i64::from(i32::MAX), 1), (1, i64::from(i32::MAX))]),
        call_ns in prop::sample::select(vec![1, 62_500, MS, 9 * MS, u64::MAX]),
        calls in prop::collection::vec((0_u8..4, any::<i64>(), prop::option::of(any::<i64>()), any::<[i64; 2]>()), 1..100),
    ) {
        let mut bench = example(&[
            ("ba", ba), ("sf_cycle", 0), ("travel", travel), ("velocity", velocity), ("acceleration", rates.0), ("stop_decel", rates.1),
            ("drive_resolution", turns.0), ("master_resolution", turns.1),
        ]);
        bench.call_ns = call_ns;
        prop_assume!(bench.checked(&[]).is_ok());
        bench.start(0);
        for (inputs, source, mark, words) in calls {
            (bench.travel, bench.words) = (source, words);
            let seen = bench.seen(inputs, mark);
            let told = bench.epos.step(&seen);
            bench.sink = told.sink;
            bench.is_sound();
        }
    }

    /// A reference at any position, with stops on the way: the motion ends at the travel, counted from the reference.
    #[test]
    fn a_reference_is_the_zero_of_its_end(
        turns_round in any::<bool>(),
        travel in 1_i64..4000,
        behind in -200_i64..600,
        at in 1_usize..60,
        stops in prop::collection::vec(1_usize..120, 0..4),
    ) {
        let mut bench = started(&[("ba", if turns_round { 6 } else { 2 }), ("travel", travel), ("velocity", 1_000_000)]);
        bench.run(E1, at);
        bench.mark(0, behind);
        for calls in stops {
            bench.run(0, calls);
            bench.step(E2);
            while bench.epos.phase == Phase::Stopping { bench.step(0); }
            if bench.epos.phase == Phase::Halted {
                bench.step(0);
                bench.step(E1);
            }
        }
        for _ in 0..2 {
            if bench.epos.phase == Phase::Run { bench.until_rest(0); }
        }
        prop_assert_eq!((bench.sink, bench.epos.phase), (travel, Phase::Idle));
    }
}

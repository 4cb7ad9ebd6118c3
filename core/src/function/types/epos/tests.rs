//! Test oracles of the positioning: its edges and phases, and both overrides.

use super::*;
use crate::function::program::{LINES, Occasion, SourceValue};
use crate::function::trial::{at_rest, set, setting};

mod laws;
mod modulo;
mod reference;
mod values;

const MS: u64 = 1_000_000;
const MOVES: u8 = 0;

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
        epos: Epos::new(&SlotSetup::of_words([true; WORDS])),
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
    let row = Kind::Epos.description();
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

//! Laws of the generator for all sets and inputs.

use super::*;
use proptest::prelude::*;

/// The generator by the tables of the spec, for calls of whole half milliseconds: every number is in units of 1/parts
/// inc, in which all of them are whole.
#[derive(Clone, Debug)]
struct Model {
    parts: i128,
    /// Parts per call for an override of 1, or for one increment of the source.
    step: i128,
    /// Change of the velocity per call, for an acceleration of 1.
    ramp: i128,
    end: i128,
    set: ModelSet,
    phase: Phase,
    velocity: i128,
    /// Travel since START.
    sum: i128,
    /// Travel s since the start of the movement, or since the boundary that applies.
    way: i128,
    before: u8,
}

/// Values that VALUE_NEW changes.
#[derive(Clone, Copy, Debug)]
struct ModelSet {
    ba: i64,
    accelerations: [i64; 2],
}

impl Model {
    /// Creates a model with `increments` in `time` half milliseconds, called every `w` of them.
    fn new(set: ModelSet, increments: i64, time: i64, w: i64, inputs: u8) -> Self {
        let parts = 4_000_000 * 1024 * i128::from(time);
        let (w, end) = (i128::from(w), i128::from(increments));
        let internal = end * w * 4_000_000;
        Self {
            parts,
            step: if set.ba & 1 == 0 { internal } else { parts / 1024 },
            ramp: w * w * 1024 * i128::from(time),
            end: end * parts,
            set,
            phase: Phase::Idle,
            velocity: 0,
            sum: 0,
            way: 0,
            before: inputs,
        }
    }

    fn value_new(&mut self, set: ModelSet) {
        if set.ba & 2 > self.set.ba & 2 {
            let is_back = self.velocity < 0 || self.velocity == 0 && self.way < 0;
            self.way = if is_back { -(-self.way).rem_euclid(self.end) } else { self.way.rem_euclid(self.end) };
        }
        self.set = set;
    }

    /// Returns the maximum change of velocity per call.
    fn slope(&self, inputs: u8) -> i128 {
        let second = self.set.ba & 4 != 0 && inputs & E2 != 0;
        i128::from(self.set.accelerations[usize::from(second)]) * self.ramp
    }

    fn target(&self, percent: i64, way: i64) -> i128 {
        let by = if self.set.ba & 1 == 0 { 1 } else { i128::from(way) };
        self.step * by * i128::from(percent)
    }

    /// Advances by one call. Returns 1 if the generator is at rest after it.
    fn step(&mut self, inputs: u8, percent: i64, way: i64) -> u8 {
        let rises = inputs & !self.before & E1 != 0;
        self.before = inputs;
        let begins = self.phase == Phase::Idle && rises;
        self.phase = match (self.phase, inputs & E1 != 0) {
            (Phase::Idle, _) if begins => Phase::Run,
            (Phase::Run, false) => Phase::Stopping,
            (Phase::Stopping | Phase::Halted, true) => Phase::Run,
            (phase, _) => phase,
        };
        let is_sequence = self.set.ba & 2 != 0;
        if matches!(self.phase, Phase::Run | Phase::Stopping) {
            let target = if self.phase == Phase::Run { self.target(percent, way) } else { 0 };
            if begins {
                self.way = 0;
            }
            let slope = self.slope(inputs);
            self.velocity =
                if begins && is_sequence { target } else { target.clamp(self.velocity - slope, self.velocity + slope) };
            (self.sum, self.way) = (self.sum + self.velocity, self.way + self.velocity);
            if is_sequence && self.way.abs() >= self.end {
                self.sum -= self.way - self.way.signum() * self.end;
                (self.velocity, self.phase) = (0, Phase::Idle);
            } else if self.phase == Phase::Stopping && self.velocity == 0 {
                self.phase = Phase::Halted;
            }
        }
        u8::from(matches!(self.phase, Phase::Idle | Phase::Halted))
    }

    /// Returns X, relative to the position at START.
    fn position(&self) -> i64 {
        self.sum.div_euclid(self.parts) as i64
    }
}

/// Calls with the same inputs, override and travel of the source, optionally preceded by VALUE_NEW of bit 1 of ba and
/// both accelerations.
#[derive(Clone, Debug)]
struct Stretch {
    inputs: u8,
    percent: i64,
    way: i64,
    calls: usize,
    renewed: Option<(i64, [i64; 2])>,
}

fn accelerations() -> impl Strategy<Value = [i64; 2]> {
    let one = || prop_oneof![1_i64..=500_000_000, 1_i64..=2_000_000, 1_i64..=2000];
    (one(), one()).prop_map(|(first, second)| [first, second])
}

fn stretches() -> impl Strategy<Value = Vec<Stretch>> {
    let percent = prop_oneof![3 => Just(1024_i64), 1 => Just(-1024), 3 => -2048_i64..=2048];
    let way = prop_oneof![3 => -40_i64..400, 1 => -32_768_i64..32_768];
    let renewed = prop::option::weighted(0.3, (prop::sample::select(vec![0_i64, 2]), accelerations()));
    let stretch = (0_u8..4, percent, way, 1_usize..40, renewed).prop_map(|(inputs, percent, way, calls, renewed)| {
        // E1 is 1 most of the time.
        let inputs = if calls % 3 == 0 { inputs } else { inputs | E1 };
        Stretch { inputs, percent, way, calls, renewed }
    });
    prop::collection::vec(stretch, 1..14)
}

proptest! {
    /// For any inputs: each increment and A1 are those of the spec; no call is faster than the largest target so far,
    /// and no velocity changes by more than its ramp, except where a sequence begins or ends. From any resulting state
    /// a sequence reaches its end exactly: its length from its start, or a boundary of the cycle if VALUE_NEW made it a
    /// sequence.
    ///
    /// Proves: AMK-FGEN-16, AMK-FGEN-17, AMK-FGEN-18, AMK-FGEN-19, AMK-FGEN-20, AMK-FGEN-21, AMK-FGEN-22, AMK-FGEN-25, AMK-FGEN-26,
    /// AMK-FGEN-27, AMK-FGEN-32, AMK-FGEN-33, AMK-FGEN-34, AMK-FGEN-35, AMK-FGEN-36, AMK-FGEN-37, AMK-FGEN-38, AMK-FGEN-39
    #[test]
    fn it_is_the_law_of_the_spec_and_reaches_its_end_from_any_state(
        ba in 0_i64..8,
        increments in prop_oneof![1_i64..300_000, 1_i64..200],
        time in 1_i64..3000,
        w in 1_i64..8,
        first in accelerations(),
        base in any::<i32>(),
        stretches in stretches(),
        sign in prop::sample::select(vec![1_i64, -1]),
    ) {
        let mut bench = example(&[
            ("ba", ba), ("cycle_increments", increments), ("cycle_time", time), ("sf_cycle_time", w), ("accel", first[0]), ("accel2", first[1]),
        ]);
        bench.call_ns = w as u64 * 500_000;
        prop_assume!(bench.checked(&[], false).is_ok());
        bench.sink = base.into();
        bench.start(0);
        let mut model = Model::new(ModelSet { ba, accelerations: first }, increments, time, w, 0);
        // Start of the movement, and whether it has been a sequence from the start.
        let (mut from, mut is_whole) = (bench.sink, true);
        let (mut fastest, mut last) = (0_i128, 0_i64);
        for Stretch { inputs, percent, way, calls, renewed } in stretches {
            if let Some((bit, accelerations)) = renewed {
                let set = ModelSet { ba: ba & !2 | bit, accelerations };
                bench.value_new(&[("ba", set.ba), ("accel", accelerations[0]), ("accel2", accelerations[1])]);
                model.value_new(set);
                is_whole &= bit == 2;
            }
            bench.word = percent;
            for _ in 0..calls {
                let (sink, idle) = (bench.sink, model.phase == Phase::Idle);
                bench.travel += way;
                let outputs = model.step(inputs, percent, way);
                let told = bench.step(inputs);
                prop_assert_eq!(told, (i64::from(base) + model.position(), outputs));
                let ends = model.phase == Phase::Idle;
                // A short sequence ends in the call in which it begins.
                let begins = idle && (!ends || told.0 != sink);
                if begins {
                    (from, is_whole) = (sink, model.set.ba & 2 != 0);
                }
                // The travel of a call differs from the velocity by less than one increment.
                let now = told.0 - sink;
                fastest = fastest.max(model.target(percent, way).abs());
                prop_assert!((i128::from(now.abs()) - 1) * model.parts < fastest);
                let change = (i128::from(now.abs_diff(last)) - 2) * model.parts;
                prop_assert!(begins || ends || change < model.slope(inputs), "{} behind {}", now, last);
                last = if ends { 0 } else { now };
            }
        }
        let accelerations = [500_000_000; 2];
        model.value_new(ModelSet { ba: ba | 2, accelerations });
        bench.value_new(&[("ba", ba | 2), ("accel", accelerations[0]), ("accel2", accelerations[1])]);
        bench.word = sign * 1024;
        // A turn takes at most 3000 calls at 100 %, and a source is as fast here; the direction may have to change
        // first.
        let mut left = 12_000;
        while bench.fgen.phase != Phase::Idle && left > 0 {
            bench.travel += increments / 3000 + 1;
            bench.step(E1);
            left -= 1;
        }
        prop_assert_eq!((bench.fgen.phase, (bench.sink - from) % increments), (Phase::Idle, 0));
        prop_assert!(!is_whole || [0, increments].contains(&(bench.sink - from).abs()));
    }
}

/// Groups of calls with these inputs and this override.
fn course() -> impl Strategy<Value = Vec<(u8, i64, usize)>> {
    prop::collection::vec((0_u8..4, prop_oneof![3 => Just(1024), 1 => 0_i64..=2048], 1_usize..40), 1..12)
}

proptest! {
    /// Whatever E1, E2, override and accelerations do, a sequence has exactly its increments, and no call is faster
    /// than its rate.
    #[test]
    fn a_sequence_is_exact_and_never_beyond_its_rate(
        increments in 1_i64..300_000,
        time in 2_i64..3000,
        accel in 1_i64..=500_000_000,
        accel2 in 1_i64..=500_000_000,
        call in prop::sample::select(vec![250_000_u64, 500_000, 750_000, 1_000_000, 333_333, 4_000_000]),
        course in course(),
        times in prop::collection::vec(2_i64..3000, 12),
    ) {
        let mut bench = example(&[
            ("ba", 6), ("cycle_increments", increments), ("cycle_time", time), ("accel", accel), ("accel2", accel2), ("sf_cycle_time", 0),
        ]);
        bench.call_ns = call;
        prop_assume!(bench.checked(&[], false).is_ok());
        bench.start(0);
        let mut fastest = 0.0_f64;
        let mut go = |bench: &mut Bench, inputs: u8| {
            let of_time = bench.values.iter().find(|(name, _)| *name == "cycle_time").expect("a time").1;
            // A velocity never exceeds the largest target so far.
            let rate = increments as f64 * call as f64 / (of_time as f64 * 500_000.0);
            fastest = fastest.max(rate * bench.word as f64 / 1024.0);
            let way = bench.ways(inputs, 1)[0];
            assert!(way >= 0 && (way as f64) < fastest + 1.0 + 1e-6, "{way} in a call, {fastest} at most");
        };
        // The edge that begins the sequence.
        go(&mut bench, E1);
        for ((inputs, percent, calls), time) in course.into_iter().zip(times) {
            bench.word = percent;
            if bench.checked(&[("cycle_time", time)], true).is_ok() {
                bench.value_new(&[("cycle_time", time)]);
            }
            for _ in 0..calls {
                // No second sequence.
                if bench.fgen.phase == Phase::Idle {
                    break;
                }
                go(&mut bench, inputs);
                prop_assert!(bench.sink <= increments);
            }
        }
        // To the end, however slow it is: the cycle time bounds the number of calls.
        bench.word = 2048;
        bench.value_new(&[("accel", 500_000_000), ("accel2", 500_000_000)]);
        let mut left = 3_000_000_u64;
        while bench.fgen.phase != Phase::Idle && left > 0 {
            let mut fgen = bench.fgen.clone();
            let told = fgen.step(&bench.seen(E1));
            bench.fgen = fgen;
            bench.sink = told.sink;
            left -= 1;
        }
        prop_assert_eq!((bench.sink, bench.fgen.phase), (increments, Phase::Idle));
    }

    /// Once the velocity is that of 100 %, the travel in k times the cycle time is k times the increments.
    #[test]
    fn a_continuous_way_does_not_drift(
        increments in 1_i64..2_000_000,
        time in 2_i64..1500,
        accel in 1_000_i64..=500_000_000,
        sign in prop::sample::select(vec![1_i64, -1]),
        ramp in 1_usize..60,
    ) {
        // A call of 0.5 ms: the cycle time is a number of calls.
        let mut bench = example(&[
            ("ba", 0), ("cycle_increments", increments), ("cycle_time", time), ("accel", accel), ("sf_cycle_time", 1),
        ]);
        bench.call_ns = 500_000;
        prop_assume!(bench.checked(&[], false).is_ok());
        bench.word = sign * 1024;
        bench.start(0);
        bench.run(E1, ramp);
        bench.value_new(&[("accel", 500_000_000)]);
        // At most 32767 inc per call, 125 more in each.
        bench.run(E1, 300);
        let from = bench.sink;
        for turn in 1..=3 {
            bench.run(E1, time as usize);
            prop_assert!((bench.sink - from - sign * turn * increments).abs() < 1);
        }
    }

    /// No value of a set, a source or drives makes it fail, and its state stays valid.
    #[test]
    fn nothing_overflows(
        values in prop::collection::vec(any::<u64>(), 9),
        call in prop_oneof![Just(1_u64), Just(1_000_000), Just(255_000_000_000), 1_u64..1_000_000_000],
        steps in prop::collection::vec((any::<u8>(), any::<i64>(), any::<i64>(), any::<i64>()), 1..60),
        has_word in any::<bool>(),
    ) {
        let mut bench = example(&[]);
        bench.fgen = Fgen::new(&SlotSetup::of_words([has_word, false]));
        bench.call_ns = call;
        bench.values.clear();
        for (field, value) in FIELDS.iter().zip(values).filter(|(field, _)| field.name != "pos_limit") {
            let width = field.max.abs_diff(field.min) + 1;
            bench.values.push((field.name, field.min + (value % width) as i64));
        }
        bench.take(&[("sf_cycle_time", 0)]);
        prop_assume!(bench.checked(&[], false).is_ok());
        bench.sink = i64::MAX;
        bench.start(0);
        for (inputs, word, travel, actual) in steps {
            (bench.word, bench.travel) = (word, travel);
            bench.drives = [Drive { actual, ..Drive::default() }; LINES];
            bench.step(inputs);
            bench.is_sound();
        }
    }
}

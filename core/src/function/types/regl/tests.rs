//! Test oracles of the controller, its switches, limits, filters and synchronization.

use super::*;
use crate::function::program::{LINES, SourceValue};
use crate::function::trial::{at_rest, set, setting};

mod laws;

const E2: u8 = 1 << 1;
const E3: u8 = 1 << 2;
/// Value of `source_assess` for a source of 16 bits.
const DIRECT: i64 = 2;

/// A controller with its inputs.
#[derive(Clone)]
struct Bench {
    regl: PidFunction,
    values: Vec<(&'static str, i64)>,
    words: [i64; WORDS],
}

/// The example of the manual.
const EXAMPLE: [(&str, i64); 9] = [
    ("switch_mask", 7),
    ("kp", 512),
    ("ki", 128),
    ("kd", 64),
    ("gain_v", 1000),
    ("y_max", 10_000_000),
    ("i_max", 1_000_000),
    ("cmd1", 100),
    ("cmd2", 5_000_000),
];

fn example(more: &[(&'static str, i64)]) -> Bench {
    let mut bench = Bench {
        regl: PidFunction::new(&SlotSetup::of_words([false; WORDS])),
        values: EXAMPLE.into(),
        words: [0; WORDS],
    };
    bench.take(more);
    bench
}

/// P control with gain 1 and w2 = 0, and a source of 16 bits: the output is -x.
fn plain(more: &[(&'static str, i64)]) -> Bench {
    let plain = [("kp", 256), ("ki", 0), ("kd", 0), ("gain_v", 1), ("cmd1", 0), ("cmd2", 0), ("source_assess", DIRECT)];
    let mut bench = example(&plain);
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

    /// Returns the result of START, or of VALUE_NEW while it runs, for the set with these values changed.
    fn checked(&self, more: &[(&'static str, i64)], runs: bool) -> Result<(), Fault> {
        let mut asked = self.clone();
        asked.take(more);
        let words = set(FIELDS, &asked.values);
        self.regl.check(Words(&words), &Setting { runs, ..setting(1_000_000, [None; LINES]) })
    }

    fn seen(&self, value: i64, inputs: u8) -> CallInputs<'_> {
        let source = SourceValue { value, travel: value, mark: None };
        CallInputs { source, inputs, words: self.words, ..at_rest() }
    }

    /// Returns sink and outputs of START.
    fn start(&mut self, value: i64, inputs: u8) -> (i64, u8) {
        assert_eq!(self.checked(&[], false), Ok(()));
        let words = set(FIELDS, &self.values);
        let mut regl = self.regl.clone();
        let told = regl.start(Words(&words), &self.seen(value, inputs));
        self.regl = regl;
        assert!(self.regl.is_valid_state() && self.regl.runs_with(Words(&words), 1));
        (told.sink, told.outputs)
    }

    fn value_new(&mut self, more: &[(&'static str, i64)]) {
        assert_eq!(self.checked(more, true), Ok(()));
        self.take(more);
        self.regl.apply_values(Words(&set(FIELDS, &self.values)));
    }

    /// Returns sink and outputs of a call.
    fn step(&mut self, value: i64, inputs: u8) -> (i64, u8) {
        let mut regl = self.regl.clone();
        let told = regl.step(&self.seen(value, inputs));
        self.regl = regl;
        assert!(self.regl.is_valid_state() && told.writes == A1 | A2);
        (told.sink, told.outputs)
    }

    /// Returns the sink of START, then of calls, with these values of the source.
    fn controls<const N: usize>(&mut self, values: [i64; N]) -> [i64; N] {
        let mut is_first = true;
        values.map(|value| if std::mem::take(&mut is_first) { self.start(value, 0).0 } else { self.step(value, 0).0 })
    }
}

/// Proves: AMK-REGL-01, AMK-REGL-04, AMK-REGL-05, AMK-REGL-06, AMK-REGL-07, AMK-REGL-08, AMK-REGL-09, AMK-REGL-10, AMK-REGL-11, AMK-REGL-12,
/// AMK-REGL-13, AMK-REGL-14, AMK-REGL-15, AMK-REGL-16, AMK-REGL-17, AMK-REGL-18, AMK-REGL-19, AMK-REGL-20, AMK-REGL-21
#[test]
fn the_fields_are_those_of_the_commanding_block() {
    let fields: Vec<_> = FIELDS.iter().map(|field| (field.name, field.min, field.max, field.live)).collect();
    assert_eq!(
        fields,
        [
            ("fct", 0, 0, false),
            ("ba", 0, 63, true),
            ("sf_cycle_time", 0, 131, false),
            ("switch_mask", 0, 7, true),
            ("filter_type", 0, 2, false),
            ("source_assess", 0, 3, false),
            ("kp", 0, 16_383, true),
            ("ki", 0, 16_383, true),
            ("kd", 0, 16_383, true),
            ("y_max", 0, 1_073_741_823, true),
            ("gain_v", -32_768, 32_767, true),
            ("i_max", 0, 2_097_151, false),
            ("cmd1", -32_768, 32_767, true),
            ("cmd2", -2_147_483_648, 2_147_483_647, true),
        ]
    );
    let row = Kind::Regl.description();
    assert_eq!((row.words, row.inputs, row.outputs, row.tables), (&["src1_addr", "src2_addr"][..], 4, 2, 0));
    let zero = Fault::new(Code::AMK_NO_GAIN).of(10).with(0, 32_767);
    assert_eq!(example(&[]).checked(&[("gain_v", 0)], false), Err(zero));
    assert_eq!(example(&[]).checked(&[("sf_cycle_time", 7)], false), Ok(()), "not used");
}

/// Proves: AMK-REGL-27, AMK-REGL-28, AMK-REGL-29, AMK-REGL-35, AMK-REGL-41, AMK-REGL-O1
#[test]
fn the_manuals_example() {
    let mut bench = example(&[]);
    // x is 90, then 95, of an A/D converter.
    assert_eq!(bench.start(90 + 2048, 0), (5_025_000, 0));
    assert_eq!(bench.step(95 + 2048, 0), (5_016_250, 0));
    assert_eq!(
        example(&[("kp", 0), ("ki", 0), ("kd", 256), ("gain_v", 1)]).controls([2148, 2147]),
        [5_000_000, 5_000_001]
    );
    // Tn = kp / ki = 4 ms: with a constant error, I equals P in the fourth call. P 20, I 5, 10, 15, 20.
    let mut bench = example(&[("cmd2", 0), ("kd", 0)]);
    assert_eq!(bench.controls([2138; 4]), [25_000, 30_000, 35_000, 40_000]);
    // I keeps fractions of 1/256: 1/256 of 1 in each call.
    let mut bench = plain(&[("kp", 0), ("ki", 1), ("cmd1", 1)]);
    bench.start(0, 0);
    assert_eq!((0..254).map(|_| bench.step(0, 0).0).max(), Some(0));
    assert_eq!(bench.step(0, 0).0, 1);
}

/// Proves: AMK-REGL-25, AMK-REGL-30, AMK-REGL-31, AMK-REGL-O3
#[test]
fn limits_behind_the_sum_hold_its_side() {
    // P and I are 62.5 * 24000 each: u = 3000000 for x = -24000.
    let one_sided =
        |ba: i64| plain(&[("ba", ba), ("kp", 16_000), ("ki", 16_000), ("i_max", 2_000_000), ("cmd2", 2_000_000)]);
    assert_eq!(one_sided(24).start(24_000, 0), (0, A2));
    assert_eq!(one_sided(24).start(-24_000, 0), (5_000_000, 0));
    assert_eq!(one_sided(20).start(-24_000, 0), (0, A1));
    assert_eq!(one_sided(20).start(24_000, 0), (-1_000_000, 0));
    // w2 is multiplied, too (R3); after the limit it is neither multiplied nor limited.
    assert_eq!(plain(&[("ba", 16), ("gain_v", -3), ("cmd2", 100)]).start(10, 0), (-270, 0));
    assert_eq!(plain(&[("ba", 0), ("gain_v", -3), ("cmd2", 100), ("y_max", 20)]).start(10, 0), (120, A1));
}

/// Proves: AMK-REGL-24, AMK-REGL-25, AMK-REGL-30, AMK-REGL-34, AMK-REGL-36
#[test]
fn outputs_show_active_limit() {
    let mut bench = plain(&[("y_max", 50)]);
    bench.start(0, 0);
    assert_eq!([-49, -50, -51, 50, 51].map(|x| bench.step(x, 0)), [(49, 0), (50, 0), (50, A1), (-50, 0), (-50, A2)]);
    let mut bench = plain(&[("y_max", 50), ("ba", 12)]);
    assert_eq!(bench.start(0, 0), (0, 0), "at a limit of 0 nothing binds (R8)");
    assert_eq!([bench.step(-1, 0), bench.step(1, 0)], [(0, A1), (0, A2)]);
    // The fraction of 50.5 is cut off, so that it does not exceed the limit of 50.
    let mut bench = plain(&[("y_max", 50), ("kp", 128)]);
    bench.start(0, 0);
    assert_eq!([bench.step(-101, 0), bench.step(-102, 0)], [(50, 0), (50, A1)]);
    // The sum with w2 is limited to 32 bits.
    let most = i64::from(i32::MAX);
    assert_eq!(plain(&[("cmd2", most)]).start(-7, 0), (most, 0));
    assert_eq!(plain(&[("cmd2", -most)]).start(7, 0), (-most - 1, 0));
    // y_max does not limit I, i_max does (AMK-REGL-34).
    let mut bench = plain(&[("kp", 0), ("ki", 256), ("y_max", 10), ("i_max", 1000)]);
    bench.start(-100, 0);
    (0..50).for_each(|_| {
        bench.step(-100, 0);
    });
    assert_eq!(bench.regl.integral, 1000 * 256);
    assert_eq!([bench.step(995, 0), bench.step(100, 0)], [(5, 0), (-10, A2)]);
}

/// Proves: AMK-REGL-03, AMK-REGL-10, AMK-REGL-11, AMK-REGL-26
#[test]
fn a_source_is_converted_filtered_and_negated() {
    // The output is -x.
    let x = |more: &[(&'static str, i64)], raw: i64| -plain(more).start(raw, 0).0;
    let converter = [0, 2048, 4095, 4096 + 2148, -1].map(|raw| x(&[("source_assess", 0)], raw));
    assert_eq!(converter, [-2048, 0, 2047, 100, 2047], "offset binary of 12 bits (R5)");
    assert_eq!([40_000, -40_000, 12_345].map(|raw| x(&[], raw)), [32_767, -32_768, 12_345], "16 bits, saturated (I7)");
    assert_eq!([7, -1, -6].map(|raw| x(&[("filter_type", 1)], raw)), [4, -4, -8]);
    assert_eq!(
        [7, -6].map(|raw| x(&[("filter_type", 1), ("source_assess", 3)], raw)),
        [-4, 8],
        "negated behind the filter"
    );
    assert_eq!(x(&[("source_assess", 3)], -32_768), 32_768);
    let mut bench = plain(&[("filter_type", 2)]);
    // (90 * 4), (95 + 90 * 3) / 4 = 91.25, (7 + 95 + 180) / 4 = 70.5, (-500 + 7 + 95 + 90) / 4 = -77, -475 / 4 =
    // -118.75.
    assert_eq!(bench.controls([90, 95, 7, -500, -77]).map(|y| -y), [90, 91, 70, -77, -118]);
}

/// Proves: AMK-REGL-32, AMK-REGL-33, AMK-REGL-38, AMK-REGL-39, AMK-REGL-40, AMK-REGL-41
#[test]
fn switches_act_on_their_terms() {
    // w1 100, w2 7000, x 30, so e is 70, and -30 with S1 open; P only.
    let mut bench = plain(&[("cmd1", 100), ("cmd2", 7000), ("switch_mask", 7)]);
    bench.start(30, 0);
    let mut outputs = [0; 8];
    for (mask, output) in (0..).zip(&mut outputs) {
        bench.value_new(&[("switch_mask", mask)]);
        *output = bench.step(30, 0).0;
    }
    assert_eq!(outputs, [0, 0, -30, 70, 7000, 7000, 6970, 7070]);
}

/// Proves: AMK-REGL-07, AMK-REGL-32
#[test]
fn an_open_loop_holds_its_integrator_or_clears_it_and_closes_without_a_step_of_d() {
    let run = |ba: i64| {
        let mut bench = plain(&[("ba", ba), ("kp", 0), ("ki", 256), ("kd", 256), ("cmd1", 10), ("switch_mask", 3)]);
        let mut told = vec![bench.start(0, 0).0, bench.step(0, 0).0];
        bench.value_new(&[("switch_mask", 1)]);
        told.extend([bench.step(0, 0).0, bench.step(9000, 0).0]);
        bench.value_new(&[("switch_mask", 3)]);
        // e is 3 and 4 now: D was initialized with 3.
        told.extend([bench.step(7, 0).0, bench.step(6, 0).0]);
        told
    };
    assert_eq!(run(0), [10, 20, 0, 0, 23, 28]);
    assert_eq!(run(32), [10, 20, 0, 0, 3, 8]);
}

/// Proves: AMK-REGL-22
#[test]
fn inputs_are_the_switches_where_ba_says_so() {
    let mut bench = plain(&[("ba", 1), ("cmd1", 100), ("cmd2", 7000), ("switch_mask", 7)]);
    assert_eq!(bench.start(30, 0).0, 0, "the mask is ignored");
    let all = [E1 | E2 | E3, E2, E3, E1 | E2].map(|inputs| bench.step(30, inputs).0);
    assert_eq!(all, [7070, -30, 7000, 70]);
    let mut bench = plain(&[("cmd1", 100), ("switch_mask", 3)]);
    assert_eq!(bench.start(30, 0).0, 70);
    assert_eq!(bench.step(30, E2 | E3).0, 70, "without bit 0 they are not looked at");
}

/// Proves: AMK-REGL-23, AMK-REGL-37
#[test]
fn an_edge_makes_a_control_cycle_and_w2_is_of_each_call() {
    for (ba, edge, more) in [(2, E1, 0), (3, E4, E1 | E2 | E3)] {
        let mut bench = plain(&[("ba", ba), ("kp", 256), ("ki", 256), ("switch_mask", 7), ("i_max", 100_000)]);
        bench.regl = PidFunction::new(&SlotSetup::of_words([false, true]));
        bench.words[1] = 1000;
        // An input that is 1 at START is no edge.
        assert_eq!(bench.start(-5, edge | more).0, 1000, "ba {ba}");
        assert_eq!(bench.step(-5, more).0, 1000);
        // P 5, I 5; then frozen, while the input stays 1 and after it.
        assert_eq!([bench.step(-5, edge | more).0, bench.step(-9, edge | more).0, bench.step(-9, more).0], [1010; 3]);
        bench.words[1] = 2000;
        assert_eq!(bench.step(-9, more).0, 2010);
        assert_eq!(bench.step(-9, edge | more).0, 2000 + 9 + 14);
    }
    // Opening S2 disables the controller at once; closed again it waits for its edge.
    let mut bench = plain(&[("ba", 3), ("ki", 256), ("i_max", 100_000)]);
    bench.start(0, E2);
    assert_eq!(bench.step(-5, E2 | E4).0, 10);
    assert_eq!([bench.step(-5, 0).0, bench.step(-5, E2).0], [0, 0]);
    assert_eq!(bench.step(-5, E2 | E4).0, 15);
}

/// Proves: AMK-REGL-35
#[test]
fn the_first_control_cycle_seeds_mean_and_differential() {
    let mut bench = plain(&[("ba", 2), ("filter_type", 2), ("kp", 256), ("kd", 256)]);
    // Values before the first edge are ignored.
    bench.start(9999, 0);
    bench.step(-9999, 0);
    assert_eq!(bench.step(-40, E1).0, 40);
    bench.step(-40, 0);
    // The mean becomes -30: e changes from 40 to 30, and D is -10.
    assert_eq!(bench.step(0, E1).0, 20);
}

/// Proves: AMK-REGL-18, AMK-REGL-19
#[test]
fn commands_come_from_words_of_16_and_32_bits() {
    let mut bench = plain(&[("cmd1", 11), ("cmd2", 22), ("switch_mask", 7)]);
    bench.words = [300, 5000];
    assert_eq!(bench.start(0, 0).0, 33, "no words");
    bench.regl = PidFunction::new(&SlotSetup::of_words([true, false]));
    assert_eq!(bench.start(0, 0).0, 322);
    bench.regl = PidFunction::new(&SlotSetup::of_words([false, true]));
    assert_eq!(bench.start(0, 0).0, 5011);
    bench.regl = PidFunction::new(&SlotSetup::of_words([true, true]));
    bench.words = [-40_000, 1 << 40];
    assert_eq!(bench.start(0, 0).0, i64::from(i32::MAX) - 32_768);
    bench.words = [40_000, 0];
    assert_eq!(bench.step(0, 0).0, 32_767);
    assert!(!bench.regl.is_set_up_as(&PidFunction::new(&SlotSetup::of_words([true, false]))));
}

/// Proves: AMK-REGL-07, AMK-REGL-25
#[test]
fn value_new_takes_limits_gains_and_commands_and_no_other_bit_of_ba() {
    let mut bench = plain(&[("y_max", 50), ("switch_mask", 3)]);
    bench.start(0, 0);
    bench.value_new(&[("ba", 4)]);
    assert_eq!([bench.step(-60, 0), bench.step(60, 0)], [(0, A1), (-50, A2)]);
    bench.value_new(&[("ba", 8), ("gain_v", 2), ("y_max", 90)]);
    assert_eq!([bench.step(-60, 0), bench.step(60, 0)], [(90, A1), (0, A2)]);
    bench.value_new(&[("ba", 0), ("kp", 512), ("cmd1", 1)]);
    assert_eq!(bench.step(-9, 0), (40, 0));
    for refused in [1, 2, 16, 32, 63] {
        let fault = bench.checked(&[("ba", refused)], true);
        assert_eq!(fault, Err(Fault::new(Code::AMK_BA_KEPT).of(1).with(refused, refused & 12)));
        assert_eq!(bench.checked(&[("ba", refused)], false), Ok(()));
    }
    assert_eq!(bench.checked(&[("gain_v", 0)], true).map_err(|fault| fault.code), Err(Code::AMK_NO_GAIN));
}

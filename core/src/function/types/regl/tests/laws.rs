//! Laws of the controller for all sets and inputs.

use super::*;
use proptest::prelude::*;

/// A set of random bits.
fn random_set() -> impl Strategy<Value = Vec<(&'static str, i64)>> {
    prop::collection::vec(any::<u64>(), FIELDS.len()).prop_map(|bits| {
        let value = |field: &Field, bits: u64| field.min + (bits % (field.max.abs_diff(field.min) + 1)) as i64;
        let values = FIELDS.iter().zip(bits).map(|(field, bits)| (field.name, value(field, bits)));
        values.map(|(name, value)| (name, if name == "gain_v" && value == 0 { 1 } else { value })).collect()
    })
}

/// The controller as the spec defines it, in 128 bits and from its whole history.
struct Model {
    set: Vec<i64>,
    samples: Vec<i128>,
    integral: i128,
    error: Option<i128>,
    share: i128,
    before: u8,
}

impl Model {
    fn step(&mut self, raw: i64, inputs: u8, is_start: bool) -> (i64, u8) {
        let get = |name| i128::from(self.set[at(name)]);
        let ba = self.set[at("ba")];
        let switches = if ba & 1 != 0 { inputs } else { self.set[at("switch_mask")] as u8 };
        let edge = if ba & 1 != 0 { E4 } else { E1 };
        let is_edge = !is_start && inputs & !self.before & edge != 0;
        self.before = inputs;
        if switches & 2 == 0 {
            (self.share, self.error) = (0, None);
            if ba & 32 != 0 {
                self.integral = 0;
            }
        }
        if ba & 2 == 0 || is_edge {
            let assess = self.set[at("source_assess")];
            let x = if assess & 2 != 0 { raw.clamp(-32_768, 32_767) } else { raw.rem_euclid(4096) - 2048 };
            self.samples.push(x.into());
            let of = |back: usize| self.samples[self.samples.len().saturating_sub(1 + back)];
            let filtered = match self.set[at("filter_type")] {
                0 => of(0),
                1 => of(0).div_euclid(4) * 4,
                // The first sample is repeated for the time before it.
                _ => (0..4).map(of).sum::<i128>() / 4,
            };
            let x = if assess & 1 != 0 { -filtered } else { filtered };
            if switches & 2 != 0 {
                let error = if switches & 1 != 0 { get("cmd1") - x } else { -x };
                let most = 256 * get("i_max");
                self.integral = (self.integral + get("ki") * error).clamp(-most, most);
                let change = error - self.error.unwrap_or(error);
                self.error = Some(error);
                self.share = get("kp") * error + self.integral + get("kd") * change;
            }
        }
        let w2 = if switches & 4 != 0 { get("cmd2") } else { 0 };
        let sums = ba & 16 != 0;
        let y = get("gain_v") * (self.share + if sums { 256 * w2 } else { 0 }) / 256;
        let most = if ba & 4 != 0 { 0 } else { get("y_max") };
        let least = if ba & 8 != 0 { 0 } else { -get("y_max") };
        let sum = y.clamp(least, most) + if sums { 0 } else { w2 };
        let sink = sum.clamp(i32::MIN.into(), i32::MAX.into()) as i64;
        (sink, u8::from(y > most) | u8::from(y < least) << 1)
    }
}

proptest! {
    /// For any inputs, the output equals that of the spec without overflow, and is within its limits.
    #[test]
    fn it_is_the_law_of_the_spec(
        values in random_set(),
        steps in prop::collection::vec((prop_oneof![any::<i64>(), -40_000_i64..40_000], 0_u8..16), 1..60),
    ) {
        let mut bench = example(&[]);
        bench.values = values;
        let words = set(FIELDS, &bench.values);
        let mut model =
            Model { set: words.clone(), samples: Vec::new(), integral: 0, error: None, share: 0, before: 0 };
        for (k, (raw, inputs)) in steps.into_iter().enumerate() {
            let told = if k == 0 { bench.start(raw, inputs) } else { bench.step(raw, inputs) };
            prop_assert_eq!(told, model.step(raw, inputs, k == 0));
            prop_assert!(bench.regl.integral.abs() <= 256 * words[at("i_max")]);
            let is_behind = words[at("ba")] & 16 != 0;
            prop_assert!(!is_behind || told.0.abs() <= words[at("y_max")]);
        }
    }

    /// Switches and limits change in any order and without a bump: each output is that of a controller without limits
    /// that has seen only the calls with S2 closed, limited to the present limits. Open switches and limits leave no
    /// trace; D restarts when S2 closes.
    ///
    /// Proves: AMK-REGL-22, AMK-REGL-30, AMK-REGL-31, AMK-REGL-32, AMK-REGL-34, AMK-REGL-38, AMK-REGL-39, AMK-REGL-40, AMK-REGL-41
    #[test]
    fn switches_and_limits_in_any_order_make_no_bump(
        gains in (0_i64..=16_383, 0_i64..=16_383, 0_i64..=16_383),
        gain_v in prop::sample::select(vec![1_i64, -1, 7, -300]),
        cmd1 in -3000_i64..3000,
        cmd2 in -100_000_i64..100_000,
        i_max in prop_oneof![Just(I_MAX), 0_i64..100_000],
        steps in prop::collection::vec((-3000_i64..3000, 0_u8..8, limits(), 1_usize..4), 2..40),
    ) {
        const NONE: (i64, i64) = (0, (1 << 30) - 1);
        let (kp, ki, kd) = gains;
        let mut bench = plain(&[
            ("ba", 1), ("kp", kp), ("ki", ki), ("kd", kd), ("i_max", i_max), ("gain_v", gain_v), ("cmd1", cmd1), ("cmd2", cmd2),
            ("y_max", NONE.1),
        ]);
        let mut free = bench.clone();
        // Both start with all switches open, which does not count as a control cycle.
        bench.start(0, 0);
        free.start(0, 0);
        let mut was_closed = false;
        for (x, inputs, limit, calls) in steps {
            if let Some((bits, y_max)) = limit {
                bench.value_new(&[("ba", 1 | bits), ("y_max", y_max)]);
            }
            let get = |name| bench.values.iter().find(|(known, _)| *known == name).expect("a value").1;
            let (bits, y_max) = (get("ba"), get("y_max"));
            let most = if bits & 4 == 0 { y_max } else { 0 };
            let least = if bits & 8 == 0 { -y_max } else { 0 };
            for _ in 0..calls {
                let is_closed = inputs & E2 != 0;
                if is_closed && !was_closed {
                    free.value_new(&[("kd", 0)]);
                }
                let share = if is_closed { free.step(x, inputs & !E3).0 } else { 0 };
                free.value_new(&[("kd", kd)]);
                was_closed = is_closed;
                let behind = if inputs & E3 != 0 { cmd2 } else { 0 };
                let outputs = u8::from(share > most) | u8::from(share < least) << 1;
                prop_assert_eq!(bench.step(x, inputs), (share.clamp(least, most) + behind, outputs));
            }
        }
        // Opened and closed again with an error of 0, the output equals the integral, and stays there.
        let x = cmd1;
        bench.value_new(&[("ba", 1), ("y_max", NONE.1)]);
        let held = gain_v * bench.regl.integral / 256;
        for inputs in [E1, E1 | E2, E1 | E2, 0, E1 | E2] {
            let expected = if inputs & E2 != 0 { held } else { 0 };
            prop_assert_eq!(bench.step(x, inputs).0, expected);
        }
    }
}

/// Optional VALUE_NEW of bits 2 and 3 of ba and of y_max.
fn limits() -> impl Strategy<Value = Option<(i64, i64)>> {
    let most = prop_oneof![0_i64..2000, 0_i64..(1 << 30)];
    prop::option::of((prop::sample::select(vec![0_i64, 4, 8, 12]), most))
}

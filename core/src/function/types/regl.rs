//! PID control (REGL).
//!
//! Law      e = w1 * [S1] - x; u = kp e + clamp(sum of ki e, +-i_max) + kd (e - e of the previous control cycle), while
//!          S2 is closed, in 1/256; y = gain_v * u, limited, + w2 * [S3]; with bit 4 of ba y = gain_v * (u + w2 *
//!          [S3]), limited. Divided by 256 once, after the gain, towards 0. A control cycle is a call, or a call with a
//!          rising input of external synchronization
//! Reads    the low 12 bits of the source as an offset binary number, or the source as 16 bits; S1 to S3 of a mask or
//!          E1 to E3; w1 and w2 of the set or of words
//! Writes   the sink (0.0001 rpm if it is an axis), A1 = 1 while the upper limit is active, A2 = 1 while the lower
//!          limit is active
//! Refuses  a gain of 0; VALUE_NEW with changes of ba other than bits 2 and 3
//! Source   AMK-REGL-01 to -41 with R1 to R9

use crate::code::Code;
use crate::function::guest::*;
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new("fct", 0, 0, "", "0: PID control", "AMK-REGL-05"),
    Field::new(
        "ba",
        0,
        63,
        "bits",
        "bit 0: E1 to E3 are S1 to S3, not switch_mask; bit 1: a rising input makes a control cycle, E1, with bit 0 E4; bits 2 and 3 (alone \
         of them live): the upper, the lower limit is 0; bit 4: limit and gain behind the sum with w2; bit 5: S2 clears the integrator",
        "AMK-REGL-07",
    )
    .live(),
    Field::new("sf_cycle_time", 0, 131, "0.5 ms", "not used", "AMK-REGL-08"),
    Field::new("switch_mask", 0, 7, "bits", "S1 to S3, 1 closed; with bit 0 of ba unused", "AMK-REGL-09").live(),
    Field::new("filter_type", 0, 2, "", "1 clears the two low bits, 2 averages four samples", "AMK-REGL-10"),
    Field::new("source_assess", 0, 3, "bits", "bit 0: negates; bit 1: 16 bits, else 12 of an A/D converter", "AMK-REGL-11"),
    gain("kp", "proportional gain", "AMK-REGL-12"),
    gain("ki", "integral gain, a control cycle", "AMK-REGL-13"),
    gain("kd", "differential gain, a control cycle", "AMK-REGL-14"),
    Field::new("y_max", 0, (1 << 30) - 1, "sink", "limit of the output to both sides", "AMK-REGL-15")
        .live()
        .idle("its control adds nothing to its sink"),
    Field::new("gain_v", i16::MIN as i64, i16::MAX as i64, "", "gain of the output, not 0", "AMK-REGL-16").live(),
    Field::new("i_max", 0, I_MAX, "", "limit of the integrator to both sides, before gain_v", "AMK-REGL-17"),
    Field::new("cmd1", i16::MIN as i64, i16::MAX as i64, "source", "w1 where src1_addr names no word", "AMK-REGL-20").live(),
    Field::new("cmd2", i32::MIN as i64, i32::MAX as i64, "sink", "w2 where src2_addr names no word", "AMK-REGL-21").live(),
];

const fn gain(name: &'static str, help: &'static str, source: &'static str) -> Field {
    Field::new(name, 0, K_MAX, "1/256", help, source).live()
}

const K_MAX: i64 = 16_383;
const I_MAX: i64 = (1 << 21) - 1;
/// Units per 1 in gains and their products.
const ONE: i64 = 256;
/// Upper bound of an error: w1 and x have 16 bits, their difference 17.
const E_BOUND: i64 = 1 << 17;

const S1: u8 = 1 << 0;
const S2: u8 = 1 << 1;
const S3: u8 = 1 << 2;
const E1: u8 = 1 << 0;
const E4: u8 = 1 << 3;

const A1: u8 = 1 << 0;
const A2: u8 = 1 << 1;

/// Bits of ba that VALUE_NEW must not change.
const FIXED_BITS: i64 = !0b1100;

const fn at(name: &'static str) -> usize {
    place(FIELDS, name)
}

/// Values that only START takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Mode {
    /// Bits of ba that are taken at START.
    ba: i64,
    filter: i64,
    assess: i64,
    i_max: i64,
}

impl Mode {
    fn of(words: Words<'_>) -> Self {
        let get = |place| words.get(place);
        Self {
            ba: get(at("ba")) & FIXED_BITS,
            filter: get(at("filter_type")),
            assess: get(at("source_assess")),
            i_max: get(at("i_max")),
        }
    }

    fn by_inputs(&self) -> bool {
        self.ba & 1 != 0
    }

    /// Returns the input that triggers control cycles; `None` without external synchronization.
    fn sync(&self) -> Option<u8> {
        (self.ba & 2 != 0).then_some(if self.by_inputs() { E4 } else { E1 })
    }

    /// Returns true if limit and gain follow the sum.
    fn sums_first(&self) -> bool {
        self.ba & 16 != 0
    }

    fn clears(&self) -> bool {
        self.ba & 32 != 0
    }
}

/// Values that VALUE_NEW takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Live {
    switches: u8,
    kp: i64,
    ki: i64,
    kd: i64,
    /// Minimum and maximum output.
    limits: (i64, i64),
    gain: i64,
    commands: [i64; WORDS],
}

impl Live {
    fn of(words: Words<'_>) -> Self {
        let get = |place| words.get(place);
        let limit = |bit: i64| if get(at("ba")) & bit == 0 { get(at("y_max")) } else { 0 };
        Self {
            switches: (get(at("switch_mask")) & 7) as u8,
            kp: get(at("kp")),
            ki: get(at("ki")),
            kd: get(at("kd")),
            limits: (-limit(8), limit(4)),
            gain: get(at("gain_v")),
            commands: [get(at("cmd1")), get(at("cmd2"))],
        }
    }
}

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct PidFunction {
    /// Whether the slot has a word for w1, and for w2.
    has_words: [bool; WORDS],
    mode: Mode,
    live: Live,
    /// The last four values of the source, the newest first; `None` before the first control cycle.
    samples: Option<[i64; 4]>,
    /// Integral, in 1/256.
    integral: i64,
    /// Error of the last control cycle with S2 closed; `None` if S2 has been open since.
    error: Option<i64>,
    /// P + I + D of that control cycle, in 1/256; 0 with S2 open.
    control_output: i64,
    /// Inputs of the last call.
    last_inputs: u8,
}

impl PidFunction {
    /// Returns w1 and w2: a word of 16 bits and one of 32, or the values of the set.
    #[inline]
    fn commands(&self, words: [i64; WORDS]) -> [i64; WORDS] {
        let [first, second] = self.has_words;
        let [cmd1, cmd2] = self.live.commands;
        let [word1, word2] = words;
        [if first { limit_to_16_bits(word1) } else { cmd1 }, if second { limit_to_32_bits(word2) } else { cmd2 }]
    }

    /// Returns x of a control cycle.
    #[inline]
    fn sample(&mut self, raw: i64) -> i64 {
        let x = if self.mode.assess & 2 != 0 { limit_to_16_bits(raw) } else { (raw & 0xFFF) - 0x800 };
        let x = match self.mode.filter {
            1 => x & !3,
            2 => {
                let [a, b, c, _] = self.samples.unwrap_or([x; 4]);
                self.samples = Some([x, a, b, c]);
                (x + a + b + c) / 4
            }
            _ => x,
        };
        if self.mode.assess & 1 != 0 { -x } else { x }
    }

    /// Returns P + I + D of a control cycle. Gains have 14 bits and an error 17: each term stays below 2^32.
    #[inline]
    fn control(&mut self, error: i64) -> i64 {
        let Live { kp, ki, kd, .. } = self.live;
        let most = ONE * self.mode.i_max;
        self.integral = (self.integral + ki * error).max(-most).min(most);
        let change = error - self.error.replace(error).unwrap_or(error);
        kp * error + self.integral + kd * change
    }

    /// Returns the output, and the active limit. gain_v has 16 bits: all terms stay below 2^56.
    #[inline]
    fn output(&self, w2: i64) -> Outcome {
        let (first, behind) = if self.mode.sums_first() { (ONE * w2, 0) } else { (0, w2) };
        let y = self.live.gain * (self.control_output + first) / ONE;
        let (least, most) = self.live.limits;
        let outputs = if y > most { A1 } else { 0 } | if y < least { A2 } else { 0 };
        let sink = limit_to_32_bits(y.max(least).min(most) + behind);
        Outcome { sink, outputs, writes: A1 | A2, ..Outcome::default() }
    }
}

impl SlotType for PidFunction {
    const DESCRIPTION: Description = Description {
        source: Requirement::Must,
        quantity: Quantity::Speed,
        moves_axes: true,
        inputs: 4,
        outputs: 2,
        words: &["src1_addr", "src2_addr"],
        amk: AmkLimits { sets_call_time: true, sink_widths: &[Width::W32], ..AmkLimits::USUAL },
        example: &[("switch_mask", 7), ("kp", 7), ("ki", 7), ("kd", 7), ("y_max", 7), ("gain_v", 7), ("i_max", 7)],
        ..Description::of(Kind::Regl, "regl", "controls a speed by what a source reports (PID)", FIELDS)
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        Self { has_words: setup.has_words, ..Self::default() }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        self.has_words == other.has_words
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let (ba, mode) = (words.get(at("ba")), Mode::of(words));
        if setting.runs && mode.ba != self.mode.ba {
            let kept = self.mode.ba | ba & !FIXED_BITS;
            return Err(Fault::new(Code::AMK_BA_KEPT).of(number(FIELDS, "ba")).with(ba, kept));
        }
        if words.get(at("gain_v")) == 0 {
            return Err(Fault::new(Code::AMK_NO_GAIN).of(number(FIELDS, "gain_v")).with(0, i16::MAX.into()));
        }
        Ok(())
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        *self =
            Self { mode: Mode::of(words), last_inputs: seen.inputs, ..Self::new(&SlotSetup::of_words(self.has_words)) };
        self.apply_values(words);
        self.step(seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        self.live = Live::of(words);
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let rising = seen.inputs & !std::mem::replace(&mut self.last_inputs, seen.inputs);
        let switches = if self.mode.by_inputs() { seen.inputs } else { self.live.switches };
        let is_closed = |switch: u8| switches & switch != 0;
        let [w1, w2] = self.commands(seen.words);
        if !is_closed(S2) {
            (self.control_output, self.error) = (0, None);
            if self.mode.clears() {
                self.integral = 0;
            }
        }
        if self.mode.sync().is_none_or(|input| rising & input != 0) {
            let x = self.sample(seen.source.value);
            if is_closed(S2) {
                self.control_output = self.control(if is_closed(S1) { w1 - x } else { -x });
            }
        }
        self.output(if is_closed(S3) { w2 } else { 0 })
    }

    fn runs_with(&self, words: Words<'_>, _: u64) -> bool {
        self.mode == Mode::of(words) && self.live == Live::of(words)
    }

    fn is_valid_state(&self) -> bool {
        let is_error = |error: &i64| (-E_BOUND..=E_BOUND).contains(error);
        let most = ONE * I_MAX;
        (-most..=most).contains(&self.integral)
            && self.error.iter().all(is_error)
            && self.samples.iter().flatten().all(is_error)
            && self.control_output.saturating_abs() < 1 << 40
    }
}

/// Limits a value to 16 bits.
#[inline]
fn limit_to_16_bits(value: i64) -> i64 {
    value.clamp(i16::MIN.into(), i16::MAX.into())
}

/// Limits a value to 32 bits.
#[inline]
fn limit_to_32_bits(value: i64) -> i64 {
    value.clamp(i32::MIN.into(), i32::MAX.into())
}

#[cfg(test)]
mod tests;

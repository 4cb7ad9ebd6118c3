//! Distance between pulses, or its deviation from a spacing.
//!
//! Law      L = |pulse - start value|. Absolute: output L. Difference: r = L mod S; without limitation r or r - S
//!          within -S/2..S/2 (S/2 itself is positive), positive r, negative r - S or 0. The output is valid if |output|
//!          <= W (W = 0: always), with positive limitation from L = S on; S = 0: output L, always valid
//! Reads    the pulse of the source, unwrapped: L may exceed the counter range of the encoder
//! Writes   the sink at a valid pulse, A1 = 1 in that call only, A2 = 1 if the last evaluated pulse was valid
//! Refuses  both limitations at once
//! Source   AMK-IMES-01 to -26 with I1 to I10

use crate::code::Code;
use crate::event::Number;
use crate::function::guest::*;
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new(
        "ba",
        0,
        15,
        "",
        "bit 0: distance, not its difference; bit 1: an invalid pulse is the next start; bits 3,2: 1 positive, 2 negative",
        "AMK-IMES-06",
    ),
    Field::new("sf_cycle_time", 0, 131, "0.5 ms", "not used", "AMK-IMES-07"),
    range("spacing", "the spacing that is wanted; 0 none", "AMK-IMES-08"),
    range("window", "a pulse is valid so far around it; 0 always", "AMK-IMES-09"),
    range("blocked", "pulses so soon after a valid one are ignored; 0 none", "AMK-IMES-10"),
];

const fn range(name: &'static str, help: &'static str, source: &'static str) -> Field {
    Field::new(name, 0, (1 << 30) - 1, "inc", help, source).live()
}

const BA: usize = place(FIELDS, "ba");
const SPACING: usize = place(FIELDS, "spacing");
const WINDOW: usize = place(FIELDS, "window");
const BLOCKED: usize = place(FIELDS, "blocked");

/// Output of a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Mode {
    Absolute,
    Difference(Limitation),
}

/// Side of the spacing on which the deviation is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Limitation {
    None,
    Positive,
    Negative,
}

impl Mode {
    /// Returns the mode; `None` if both limitations are requested.
    fn of(ba: i64) -> Option<Self> {
        let limitation = match ba >> 2 & 3 {
            0 => Limitation::None,
            1 => Limitation::Positive,
            2 => Limitation::Negative,
            _ => return None,
        };
        Some(if ba & 1 == 1 { Self::Absolute } else { Self::Difference(limitation) })
    }
}

/// Previous pulses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Pulses {
    /// Start value of the distances.
    start: i64,
    /// The last valid pulse; before there is one, the first pulse.
    valid: i64,
}

/// State of the function.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::function) struct Imes {
    mode: Mode,
    restarts_at_invalid: bool,
    spacing: i64,
    window: i64,
    blocked: i64,
    pulses: Option<Pulses>,
    /// Output A2.
    was_valid: bool,
}

const A1: u8 = 1 << 0;
const A2: u8 = 1 << 1;

impl Imes {
    /// Evaluates a pulse. Returns the value of the sink if the pulse is valid.
    fn pulse(&mut self, pulse: i64) -> Option<i64> {
        let Some(pulses) = &mut self.pulses else {
            // The first pulse is the start value; the blocked range follows it (I2).
            self.pulses = Some(Pulses { start: pulse, valid: pulse });
            return None;
        };
        // A distance of 2^63 wraps to i64::MIN, which saturates.
        let from = |place: i64| pulse.wrapping_sub(place).saturating_abs();
        if from(pulses.valid) < self.blocked {
            return None;
        }
        let distance = from(pulses.start);
        let measured = match self.mode {
            Mode::Absolute => Some(distance),
            Mode::Difference(limitation) => difference(limitation, distance, self.spacing, self.window),
        };
        self.was_valid = measured.is_some();
        if self.was_valid {
            *pulses = Pulses { start: pulse, valid: pulse };
        } else if self.restarts_at_invalid {
            // The blocked range stays at the last valid pulse (I9).
            pulses.start = pulse;
        }
        measured
    }
}

/// Returns the deviation of a distance, 0 or more, from the next spacing; `None` if the pulse is not valid.
fn difference(limitation: Limitation, distance: i64, spacing: i64, window: i64) -> Option<i64> {
    // Without a spacing there is no deviation.
    let Some(rest) = distance.checked_rem_euclid(spacing) else { return Some(distance) };
    // 0 <= rest < spacing < 2^30.
    let below = rest.wrapping_sub(spacing);
    let output = match limitation {
        // The middle itself is positive (I5).
        Limitation::None if rest.saturating_mul(2) <= spacing => rest,
        Limitation::None => below,
        Limitation::Positive => rest,
        Limitation::Negative if rest == 0 => 0,
        Limitation::Negative => below,
    };
    let is_within = window == 0 || output.saturating_abs() <= window;
    (is_within && (limitation != Limitation::Positive || distance >= spacing)).then_some(output)
}

impl SlotType for Imes {
    const DESCRIPTION: Description = Description {
        source: Requirement::Must,
        inputs: 1,
        outputs: 2,
        measures_encoder: true,
        marks: MarkSource::Input,
        amk: AmkLimits { sets_call_time: true, sink_widths: &[Width::W16], ..AmkLimits::USUAL },
        ..Description::of(Kind::Imes, "imes", "measures the distance of marks", FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self {
            mode: Mode::Absolute,
            restarts_at_invalid: false,
            spacing: 0,
            window: 0,
            blocked: 0,
            pulses: None,
            was_valid: false,
        }
    }

    fn check(&self, words: Words<'_>, _: &Setting<'_>) -> Result<(), Fault> {
        let ba = words.get(BA);
        if Mode::of(ba).is_some() {
            return Ok(());
        }
        Err(Fault { asked: Number::Count(ba), ..Fault::new(Code::AMK_LIMITATION).of(number(FIELDS, "ba")) })
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        let ba = words.get(BA);
        *self = Self {
            mode: Mode::of(ba).unwrap_or(Mode::Absolute),
            restarts_at_invalid: ba & 2 != 0,
            ..Self::new(&SlotSetup::default())
        };
        self.apply_values(words);
        self.step(seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        (self.spacing, self.window, self.blocked) = (words.get(SPACING), words.get(WINDOW), words.get(BLOCKED));
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let measured = seen.source.mark.and_then(|pulse| self.pulse(pulse));
        let a1 = if measured.is_some() { A1 } else { 0 };
        let a2 = if self.was_valid { A2 } else { 0 };
        Outcome { sink: measured.unwrap_or(seen.sink), outputs: a1 | a2, writes: A1 | A2, ..Outcome::default() }
    }

    fn is_valid_state(&self) -> bool {
        self.spacing >= 0 && self.window >= 0 && self.blocked >= 0
    }
}

#[cfg(test)]
mod tests;

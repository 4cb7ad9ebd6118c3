//! Virtual master in time (FGEN), with zeroing and monitoring of actual positions.
//!
//! Law      Velocity: cycle_increments in cycle_time, or the travel of the source, times override / 1024; it changes to
//!          each new value by an acceleration, and travel and velocity are exact (`pace`). Continuous: without end.
//!          Sequence: starts at its velocity and ends exactly at cycle_increments, in either direction. A zeroed
//!          position counts from the position of its axis at that time
//! Reads    a rising E1 starts or continues, E1 = 0 interrupts by a ramp; E2 = 1 selects the second acceleration; the
//!          word of the override, at most 200 %; the source, if that is the velocity; actual positions of the first
//!          eight axes
//! Writes   the sink, starting at its present position; A1 = 1 at rest; A2 to A8 = 1 while the position of a selected
//!          axis exceeds its limit
//! Refuses  VALUE_NEW with changes of ba other than bit 1, an internal velocity without a time or of 32768 inc in a
//!          call, a second acceleration of 0, an external velocity without a source
//! Source   AMK-FGEN-01 to -43 with G1 to G9 and G11

mod pace;

use crate::code::Code;
use crate::function::guest::*;
use crate::function::time::check_cycle;
use pace::{FULL, Motion, Rate, VelocityStep};
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new(
        "fct",
        0,
        7,
        "bits",
        "bit 0: generates; bit 1: E1 zeroes the positions of aw_mask; bit 2: monitors them",
        "AMK-FGEN-05",
    ),
    Field::new(
        "ba",
        0,
        7,
        "bits",
        "bit 0: the velocity is that of the source; bit 1: a sequence of cycle_increments, else continuous (alone of them live); \
         bit 2: E2 takes accel2",
        "AMK-FGEN-07",
    )
    .live(),
    Field::new("cycle_time", 0, 32_767, "0.5 ms", "time of cycle_increments; with bit 0 of ba unused", "AMK-FGEN-08").live(),
    Field::new("sf_cycle_time", 0, 131, "0.5 ms", "the slot's cycle; 0: not compared", "AMK-FGEN-09"),
    Field::new(
        "cycle_increments",
        1,
        i32::MAX as i64,
        "inc",
        "a turn of the master; length of a sequence",
        "AMK-FGEN-10",
    ),
    Field::new("accel", 1, FASTEST, "inc/s^2", "up and down, with bit 2 of ba while E2 is 0", "AMK-FGEN-11").live(),
    Field::new("aw_mask", 0, 254, "bits", "bit n-1: axis n is zeroed and monitored; seven at most", "AMK-FGEN-13")
        .within(CellBound::AxisMask),
    Field::new("pos_limit", 0, i32::MAX as i64, "inc", "for A2 to A8: of the axes of aw_mask, ascending", "AMK-FGEN-14")
        .list(LIMITS)
        .live(),
    Field::new("accel2", 0, FASTEST, "inc/s^2", "up and down with bit 2 of ba while E2 is 1", "AMK-FGEN-15").live(),
];

/// Actual positions of AW1 to AW8.
const SHOWS: &[Shown; LINES] = &[
    Shown::position("feedback1", FEEDBACK),
    Shown::position("feedback2", FEEDBACK),
    Shown::position("feedback3", FEEDBACK),
    Shown::position("feedback4", FEEDBACK),
    Shown::position("feedback5", FEEDBACK),
    Shown::position("feedback6", FEEDBACK),
    Shown::position("feedback7", FEEDBACK),
    Shown::position("feedback8", FEEDBACK),
];

const FEEDBACK: &str = "actual position of the axis with that number, since it was zeroed";

const FASTEST: i64 = 500_000_000;
/// Number of outputs after A1.
const LIMITS: usize = LINES - 1;
/// Maximum travel per call: consumers may count in 16 bits.
const LARGEST_WAY: i64 = 32_767;
/// Override of 200 %.
const LARGEST_OVERRIDE: i64 = 2 * FULL;

const E1: u8 = 1 << 0;
const E2: u8 = 1 << 1;

const A1: u8 = 1 << 0;

const fn at(name: &'static str) -> usize {
    place(FIELDS, name)
}

/// Values that only START takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Mode {
    generates: bool,
    zeroes: bool,
    monitors: bool,
    /// Whether the source is the velocity.
    follows: bool,
    /// Whether E2 selects the acceleration.
    has_two_ramps: bool,
    mask: u8,
    cycle_increments: i64,
}

impl Mode {
    fn of(words: Words<'_>) -> Self {
        let (fct, ba) = (words.get(at("fct")), words.get(at("ba")));
        Self {
            generates: fct & 1 != 0,
            zeroes: fct & 2 != 0,
            monitors: fct & 4 != 0,
            follows: ba & 1 != 0,
            has_two_ramps: ba & 4 != 0,
            mask: words.get(at("aw_mask")) as u8,
            cycle_increments: words.get(at("cycle_increments")).max(1),
        }
    }
}

/// Phase of the movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// Not started, or a sequence has ended.
    #[default]
    Idle,
    Run,
    /// On the ramp down.
    Stopping,
    /// Interrupted.
    Halted,
}

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct Fgen {
    /// Whether the slot has a word for the override.
    has_word: bool,
    mode: Mode,
    /// Whether the movement ends at cycle_increments.
    is_sequence: bool,
    limits: [i64; LIMITS],
    /// Time between two calls (ns).
    call_ns: u64,
    phase: Phase,
    motion: Motion,
    /// The position X.
    position: i64,
    /// Increments since the start: the floor of the exact travel.
    travel_since_start: i64,
    /// Travel of the source at the last call.
    travel: i64,
    /// Inputs of the last call.
    before: u8,
    /// Actual positions at the last zeroing.
    zeros: [i64; LINES],
    /// Actual positions relative to `zeros`.
    feedback: [i64; LINES],
}

/// Returns the velocity and ramps per call of a parameter set.
fn pace(words: Words<'_>, call_ns: u64) -> VelocityStep {
    let follows = words.get(at("ba")) & 1 != 0;
    let rate = (!follows).then(|| rate(words));
    VelocityStep::new(rate, [at("accel"), at("accel2")].map(|place| words.get(place).max(0)), call_ns)
}

fn limits(words: Words<'_>) -> [i64; LIMITS] {
    std::array::from_fn(|nth| words.get(at("pos_limit") + nth))
}

fn is_sequence(words: Words<'_>) -> bool {
    words.get(at("ba")) & 2 != 0
}

fn rate(words: Words<'_>) -> Rate {
    Rate { increments: words.get(at("cycle_increments")), half_ms: words.get(at("cycle_time")) }
}

impl Fgen {
    /// Returns the factor of the velocity step in this call.
    #[inline]
    fn velocity_factor(&self, way: i64, seen: &CallInputs<'_>) -> i64 {
        let percent = if self.has_word { seen.words[0].clamp(-LARGEST_OVERRIDE, LARGEST_OVERRIDE) } else { FULL };
        // No encoder travels further in a call.
        if self.mode.follows { way.clamp(i32::MIN.into(), i32::MAX.into()).saturating_mul(percent) } else { percent }
    }

    /// Changes to the phase that E1 requests. Returns true if that begins a movement.
    fn switch(&mut self, inputs: u8, rising: u8) -> bool {
        let next = match self.phase {
            Phase::Idle if rising & E1 != 0 => Phase::Run,
            Phase::Run if inputs & E1 == 0 => Phase::Stopping,
            Phase::Stopping | Phase::Halted if inputs & E1 != 0 => Phase::Run,
            phase => phase,
        };
        std::mem::replace(&mut self.phase, next) == Phase::Idle && next == Phase::Run
    }

    /// Advances a movement by one call.
    #[inline]
    fn go(&mut self, asked: i64, inputs: u8, begins: bool) {
        let target = if self.phase == Phase::Run { self.motion.target(asked) } else { 0 };
        if begins {
            self.travel_since_start = 0;
        }
        if begins && self.is_sequence {
            self.motion.set_velocity(target);
        } else {
            self.motion.approach(target, self.mode.has_two_ramps && inputs & E2 != 0);
        }
        let step = self.motion.advance();
        (self.travel_since_start, self.position) =
            (self.travel_since_start.wrapping_add(step), self.position.wrapping_add(step));
        if self.is_sequence && self.is_done() {
            let end = self.mode.cycle_increments;
            let surplus = self.travel_since_start.wrapping_sub(if self.travel_since_start < 0 { -end } else { end });
            self.position = self.position.wrapping_sub(surplus);
            self.motion.stop();
            (self.phase, self.travel_since_start) = (Phase::Idle, 0);
        } else if self.phase == Phase::Stopping && self.motion.direction() == 0 {
            self.phase = Phase::Halted;
        }
    }

    /// Returns true if the exact travel has reached the length of a sequence. Rounding down shows the last increment in
    /// negative direction too early.
    fn is_done(&self) -> bool {
        let end = self.mode.cycle_increments;
        self.travel_since_start >= end
            || self.travel_since_start < -end
            || self.travel_since_start == -end && !self.motion.has_rest()
    }

    /// Counts the travel from the last boundary of a cycle instead of the start, so that a sequence ends at the next
    /// boundary (G9).
    fn count_from_boundary(&mut self) {
        let end = self.mode.cycle_increments;
        let sense = self.motion.direction();
        self.travel_since_start = if sense < 0 || sense == 0 && self.travel_since_start < 0 {
            // Counted from the exact travel, which is above its floor.
            let more = i64::from(self.motion.has_rest());
            let behind = self.travel_since_start.wrapping_add(more).wrapping_neg();
            behind.rem_euclid(end).wrapping_neg().wrapping_sub(more)
        } else {
            self.travel_since_start.rem_euclid(end)
        };
    }

    /// Returns the bits of A2 to A8.
    fn exceeded(&self) -> u8 {
        let (mut outputs, mut next) = (0, A1);
        let chosen = self.feedback.iter().enumerate().filter(|(axis, _)| self.mode.mask >> axis & 1 == 1);
        for ((_, position), limit) in chosen.zip(&self.limits) {
            next <<= 1;
            if position.unsigned_abs() > limit.unsigned_abs() {
                outputs |= next;
            }
        }
        outputs
    }

    #[inline]
    fn watch(&mut self, drives: &[Drive; LINES], zeroes: bool) {
        if zeroes {
            for ((axis, zero), drive) in self.zeros.iter_mut().enumerate().zip(drives) {
                if self.mode.mask >> axis & 1 == 1 {
                    *zero = drive.actual;
                }
            }
        }
        for ((shown, zero), drive) in self.feedback.iter_mut().zip(&self.zeros).zip(drives) {
            *shown = drive.actual.wrapping_sub(*zero);
        }
    }
}

impl SlotType for Fgen {
    const DESCRIPTION: Description = Description {
        moves_axes: true,
        inputs: 2,
        outputs: 8,
        rests: 1,
        words: &["override_addr"],
        shows: SHOWS,
        monitors: Monitored::Positions,
        amk: AmkLimits { sets_call_time: true, ..AmkLimits::USUAL },
        example: &[("fct", 7), ("cycle_time", 7), ("cycle_increments", 7), ("accel", 7), ("accel2", 7), ("aw_mask", 7)],
        ..Description::of(
            Kind::Fgen,
            "fgen",
            "makes a master of time, started and stopped by an input; zeroes and monitors actual positions",
            FIELDS,
        )
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        let [has_word, _] = setup.has_words;
        // VALUE_NEW may precede the first call; it divides the travel by the cycle increments, so they must not be 0.
        Self { has_word, mode: Mode { cycle_increments: 1, ..Mode::default() }, ..Self::default() }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        self.has_word == other.has_word
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        check_cycle(words.get(at("sf_cycle_time")), number(FIELDS, "sf_cycle_time"), setting)?;
        let (ba, mode) = (words.get(at("ba")), Mode::of(words));
        if setting.runs && (mode.follows, mode.has_two_ramps) != (self.mode.follows, self.mode.has_two_ramps) {
            let kept = i64::from(self.mode.follows) | i64::from(self.mode.has_two_ramps) << 2 | ba & 2;
            return Err(Fault::new(Code::AMK_BA_KEPT).of(number(FIELDS, "ba")).with(ba, kept));
        }
        let needs = |place: usize, field: u16, limit: i64| match words.get(place) {
            1.. => Ok(()),
            asked => Err(Fault::new(Code::AMK_NOT_ZERO).of(field).with(asked, limit)),
        };
        if mode.has_two_ramps {
            needs(at("accel2"), number(FIELDS, "accel2"), FASTEST)?;
        }
        if mode.follows {
            let no_source = Fault::new(Code::AMK_NO_SOURCE).of(number(FIELDS, "ba")).with(ba, 0);
            return if setting.has_source { Ok(()) } else { Err(no_source) };
        }
        let field = number(FIELDS, "cycle_time");
        needs(at("cycle_time"), field, 32_767)?;
        let way = rate(words).per_call(if self.has_word { 2 } else { 1 }, setting.call_ns);
        if way > LARGEST_WAY {
            return Err(Fault::new(Code::AMK_CALL_WAY).of(field).with(way, LARGEST_WAY));
        }
        Ok(())
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        *self = Self {
            mode: Mode::of(words),
            call_ns: seen.call_ns,
            motion: Motion::new(pace(words, seen.call_ns)),
            position: seen.sink,
            travel: seen.source.travel,
            before: seen.inputs,
            ..Self::new(&SlotSetup::of_words([self.has_word, false]))
        };
        self.apply_values(words);
        self.step(seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        self.limits = limits(words);
        self.motion.set_pace(pace(words, self.call_ns));
        let is_sequence = is_sequence(words);
        if is_sequence && !self.is_sequence {
            self.count_from_boundary();
        }
        self.is_sequence = is_sequence;
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let rising = seen.inputs & !std::mem::replace(&mut self.before, seen.inputs);
        let way = seen.source.travel.wrapping_sub(std::mem::replace(&mut self.travel, seen.source.travel));
        // Without a generator no movement is continued (G11).
        let begins = if self.mode.generates { self.switch(seen.inputs, rising) } else { rising & E1 != 0 };
        self.watch(seen.drives, begins && self.mode.zeroes);
        if matches!(self.phase, Phase::Run | Phase::Stopping) {
            self.go(self.velocity_factor(way, seen), seen.inputs, begins);
        }
        let Mode { generates, monitors, .. } = self.mode;
        let rests = matches!(self.phase, Phase::Idle | Phase::Halted);
        Outcome {
            sink: if generates { self.position } else { seen.sink },
            outputs: u8::from(rests) | if monitors { self.exceeded() } else { 0 },
            writes: if generates { A1 } else { 0 } | if monitors { !A1 } else { 0 },
            ..Outcome::default()
        }
    }

    fn runs_with(&self, words: Words<'_>, call_ns: u64) -> bool {
        let live = (self.is_sequence, self.limits);
        self.mode == Mode::of(words)
            && live == (is_sequence(words), limits(words))
            && self.call_ns == call_ns
            && self.motion.is_of(pace(words, call_ns))
    }

    fn is_valid_state(&self) -> bool {
        self.motion.is_sound() && self.mode.cycle_increments > 0
    }

    #[inline]
    fn shown(&self) -> &[i64] {
        &self.feedback
    }

    fn monitored_axes(words: Words<'_>) -> u8 {
        let mode = Mode::of(words);
        if mode.zeroes || mode.monitors { words.get(at("aw_mask")) as u8 } else { 0 }
    }
}

#[cfg(test)]
mod tests;

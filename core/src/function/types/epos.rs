//! Positioning by an edge of an input: relative, to multiples of a length, or relative to a reference.
//!
//! Law      n_comm * override / 1024 and ramps are parts of an increment per call, rounded down once; a call changes
//!          the velocity by at most a ramp, and the motion ends exactly at the travel (`ramp`). If a new travel, or the
//!          reference, leaves too short a distance, the axis ramps down beyond the end and returns. Modulo: at the
//!          point where the ramp down would begin, E1 = 1 moves the end by whole lengths
//! Reads    a rising E1 starts an order, continues it or adds to it, a rising E2 stops it and has priority; the words
//!          of both overrides; the travel of the source, if that is the velocity; the zero pulse of the axis that is
//!          the sink
//! Writes   the sink, starting at its present position, after the reference counted from the reference; A1 = 1 at rest,
//!          A2 = 1 at n_comm, in modulo mode only
//! Refuses  substitutional and modulo at once, or substitutional without an axis; a travel of 0 for either; an end
//!          against the approach direction without bit 2; no velocity; a cycle outside 1 to 9 ms for a reference; a
//!          stop ramp below the other ramp; an external velocity without a source or without its resolution
//! Source   AMK-EPOS-01 to -61 with

mod ramp;

use crate::code::Code;
use crate::function::guest::*;
use crate::function::time::{check_cycle, check_cycle_bounds};
use ramp::{
    INC, MAX_DISTANCE, MAX_VELOCITY, approach, approach_end, change, is_long_enough, length, quotient_in_parts,
    velocity,
};
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new(
        "ba",
        0,
        31,
        "bits",
        "bit 0: the velocity is that of the source; bit 1: substitutional; bit 2: it may turn round behind the reference; bit 3: E1 adds \
         while it moves; bit 4: modulo",
        "AMK-EPOS-49",
    ),
    Field::new(
        "sf_cycle",
        0,
        131,
        "0.5 ms",
        "the slot's cycle; 0: not compared; with bit 1 of ba 2 to 18, also where it is left out",
        "AMK-EPOS-50",
    ),
    Field::new(
        "travel",
        i32::MIN as i64,
        i32::MAX as i64,
        "inc",
        "of an order, from the reference with bit 1 of ba",
        "AMK-EPOS-51",
    )
    .live(),
    Field::new(
        "velocity",
        i32::MIN as i64,
        i32::MAX as i64,
        "0.0001 rpm",
        "n_comm; with bit 1 of ba its sign is the direction of the approach",
        "AMK-EPOS-52",
    )
    .live(),
    Field::new("acceleration", 1, STEEPEST, "0.001 rev/s^2", "up and down", "AMK-EPOS-53").live(),
    Field::new("stop_decel", 1, STEEPEST, "0.001 rev/s^2", "down at E2; no less than acceleration", "AMK-EPOS-54")
        .live(),
    Field::new("drive_resolution", 1, i32::MAX as i64, "inc/rev", "turn of the drive", "AMK-EPOS-55"),
    Field::new(
        "master_resolution",
        0,
        i32::MAX as i64,
        "inc/rev",
        "turn of the source, with bit 0 of ba",
        "AMK-EPOS-56",
    ),
];

const STEEPEST: i64 = 100_000_000;
/// Minimum and maximum cycle of a search for the reference (0.5 ms; AMK-EPOS-44, -50).
const SEARCH_CYCLES: (i64, i64) = (2, 18);
/// Override of 100 %.
const FULL: i64 = 1024;
/// Maximum override of the velocity.
const MAX_VELOCITY_OVERRIDE: i64 = 32_767;
/// Minimum override of the acceleration.
const MIN_ACCELERATION_OVERRIDE: i64 = 102;

const E1: u8 = 1 << 0;
const E2: u8 = 1 << 1;
const A1: u8 = 1 << 0;
const A2: u8 = 1 << 1;

const fn at(name: &'static str) -> usize {
    place(FIELDS, name)
}

/// Values that only START takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Mode {
    /// Whether the source is the velocity.
    follows: bool,
    substitutional: bool,
    turns_round: bool,
    retriggers: bool,
    modulo: bool,
    /// Increments per turn of the drive and of the source.
    turns: (i64, i64),
}

impl Mode {
    fn of(words: Words<'_>) -> Self {
        let has = |bit: u32| words.get(at("ba")) >> bit & 1 == 1;
        Self {
            follows: has(0),
            substitutional: has(1),
            turns_round: has(2),
            // Substitutional and modulo orders are not retriggered (AMK-EPOS-18, -42).
            retriggers: has(3) && !has(1) && !has(4),
            modulo: has(4),
            turns: (words.get(at("drive_resolution")), words.get(at("master_resolution"))),
        }
    }
}

/// Values that VALUE_NEW takes as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Live {
    travel: i64,
    velocity: i64,
    acceleration: i64,
    stop_decel: i64,
}

impl Live {
    fn of(words: Words<'_>) -> Self {
        let [travel, velocity, acceleration, stop_decel] =
            [at("travel"), at("velocity"), at("acceleration"), at("stop_decel")].map(|place| words.get(place));
        Self { travel, velocity, acceleration, stop_decel }
    }
}

/// Phase of the order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// No order.
    #[default]
    Idle,
    Run,
    /// On the stop ramp after E2.
    Stopping,
    /// Stopped before the end of the order.
    Halted,
}

/// The way in which the motion reaches its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum End {
    /// The reference has not been found yet.
    Unknown,
    #[default]
    Ramp,
    /// By stopping beyond the end and returning.
    Beyond,
    /// At once, without a ramp.
    Step,
}

/// State of the function.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct Epos {
    /// Whether the slot has words for the overrides of velocity and acceleration.
    has_words: [bool; WORDS],
    mode: Mode,
    live: Live,
    /// Time between two calls (ns).
    call_ns: u64,
    phase: Phase,
    end: End,
    /// Whether the ramp down to a multiple has begun.
    is_settled: bool,
    /// Velocity and travel of the current order.
    speed: i128,
    travel: i64,
    /// Whether the approach is in negative direction.
    is_negative: bool,
    /// Override of the acceleration of the current order.
    acceleration_override: i64,
    /// Maximum change of velocity per call, and the same on the stop ramp of E2.
    ramps: (i128, i128),
    /// Travel per call, in parts of an increment.
    velocity: i128,
    /// Distance to the end, in parts of an increment.
    left: i128,
    position: i64,
    /// Fraction of `position`, in 0..INC.
    rest: i128,
    /// Travel of the source at the last call.
    seen: i64,
    /// Inputs of the last call.
    before: u8,
    shown: [i64; 1],
}

impl Epos {
    /// Changes to the phase that the edges request. Returns true if an order begins or continues.
    fn switch(&mut self, rising: u8, share: i64) -> bool {
        let goes = rising & (E1 | E2) == E1;
        match self.phase {
            Phase::Run if rising & E2 != 0 => self.phase = Phase::Stopping,
            Phase::Run if goes && self.mode.retriggers => {
                self.take_order(share);
                self.left = self.left.saturating_add(whole(self.travel)).clamp(-MAX_DISTANCE, MAX_DISTANCE);
                self.end = if self.reaches() { End::Ramp } else { End::Beyond };
            }
            Phase::Idle if goes => {
                self.take_order(share);
                self.left = whole(self.travel);
                self.is_negative = if self.mode.substitutional { self.live.velocity < 0 } else { self.travel < 0 };
                self.end = if self.mode.substitutional { End::Unknown } else { End::Ramp };
                (self.phase, self.is_settled) = (Phase::Run, false);
                return true;
            }
            Phase::Halted if goes => {
                self.take_share(share);
                // After a stop E1 decides again whether the ramp down to this multiple begins (AMK-EPOS-35, A-44).
                (self.phase, self.is_settled) = (Phase::Run, false);
                return true;
            }
            _ => {}
        }
        false
    }

    fn take_order(&mut self, share: i64) {
        self.take_share(share);
        self.travel = self.live.travel;
        self.speed = velocity(self.live.velocity, self.mode.turns.0, self.call_ns);
    }

    fn take_share(&mut self, share: i64) {
        self.acceleration_override =
            if self.has_words[1] { share.clamp(MIN_ACCELERATION_OVERRIDE, FULL) } else { FULL };
        self.take_ramps();
    }

    fn take_ramps(&mut self) {
        let of = |rate| change(rate, self.mode.turns.0, self.call_ns);
        let ramp = of(self.live.acceleration) * i128::from(self.acceleration_override) / i128::from(FULL);
        self.ramps = (ramp.max(1), of(self.live.stop_decel));
    }

    /// Returns the direction of motion; at rest the direction of the next motion.
    fn sense(&self) -> i128 {
        match self.end {
            End::Ramp | End::Beyond if self.velocity != 0 => self.velocity.signum(),
            End::Ramp | End::Beyond if self.left != 0 => self.left.signum(),
            _ => self.approach_sense(),
        }
    }

    /// Returns true if the distance to go is long enough for the ramp down.
    fn reaches(&self) -> bool {
        let sense = self.sense();
        let left = self.left * sense;
        left >= 0 && is_long_enough(self.velocity * sense - self.ramps.0, left, self.ramps.0)
    }

    /// Sets the reference, which was at `place` of the sink: the sink counts from there now.
    fn set_reference(&mut self, place: i64) {
        self.position = self.position.wrapping_sub(place);
        let left = i128::from(self.travel) - i128::from(self.position);
        self.left = (left * INC - self.rest).clamp(-MAX_DISTANCE, MAX_DISTANCE);
        self.end = End::Ramp;
        if self.left * self.approach_sense() < 0 || !self.reaches() {
            self.end = if self.mode.turns_round { End::Beyond } else { End::Step };
        }
        self.rest_beyond();
    }

    fn approach_sense(&self) -> i128 {
        if self.is_negative { -1 } else { 1 }
    }

    /// At rest the distance to the end is treated like any other; but without bit 2 the direction never changes.
    fn rest_beyond(&mut self) {
        let is_ahead = self.left * self.approach_sense() >= 0;
        if self.velocity == 0 && (self.end == End::Beyond || self.end == End::Step && is_ahead) {
            self.end = End::Ramp;
        }
    }

    /// Returns the target velocity of this call.
    #[inline]
    fn target_velocity(&self, way: i64, percent: i64) -> i128 {
        let speed = if self.mode.follows {
            // No encoder travels further in a call.
            let way = i128::from(way.unsigned_abs()).min(i128::from(i32::MAX));
            quotient_in_parts(way * i128::from(self.mode.turns.0), self.mode.turns.1.into())
        } else {
            self.speed
        };
        if !self.has_words[0] {
            return speed;
        }
        (speed * i128::from(percent.clamp(0, MAX_VELOCITY_OVERRIDE)) / i128::from(FULL)).min(MAX_VELOCITY)
    }

    /// Advances an order by one call.
    #[inline]
    fn advance(&mut self, wanted: i128, goes_on: bool) {
        let sense = self.sense();
        let (v, mut left) = (self.velocity * sense, self.left * sense);
        let (wanted, ramp) = if self.phase == Phase::Run { (wanted, self.ramps.0) } else { (0, self.ramps.1) };
        let next = match self.end {
            End::Unknown => approach(v, wanted, ramp),
            End::Beyond => approach(v, 0, ramp),
            End::Step => approach(v, wanted, ramp).min(left),
            End::Ramp => {
                if self.mode.modulo && self.phase == Phase::Run {
                    left = self.extend_end(approach(v, wanted, ramp), left, goes_on);
                }
                approach_end(v, wanted, left, ramp)
            }
        };
        self.velocity = next * sense;
        if self.end != End::Unknown {
            self.left = (left * sense).saturating_sub(self.velocity).clamp(-MAX_DISTANCE, MAX_DISTANCE);
        }
        let sum = self.rest + self.velocity;
        // A step is at most as long as the distance to go: its whole increments have 63 bits.
        self.position = self.position.wrapping_add((sum >> ramp::BITS) as i64);
        self.rest = sum & (INC - 1);
        if self.has_reached_end() {
            self.velocity = 0;
        }
        self.rest_beyond();
    }

    /// Returns the distance to the end that applies to this call: at the point where the ramp down to a multiple would
    /// begin, E1 decides.
    #[inline]
    fn extend_end(&mut self, next: i128, left: i128, goes_on: bool) -> i128 {
        if self.is_settled || is_long_enough(next, left, self.ramps.0) {
            return left;
        }
        self.is_settled = !goes_on;
        if !goes_on {
            return left;
        }
        let (step, short) = (whole(self.travel).abs().max(INC), length(next, self.ramps.0) - left);
        let steps = (short.max(1) - 1) / step + 1;
        left.saturating_add(steps.saturating_mul(step)).min(MAX_DISTANCE)
    }

    /// Returns true if the end is reached, without a return from beyond it.
    fn has_reached_end(&self) -> bool {
        self.left == 0 && matches!(self.end, End::Ramp | End::Step)
    }

    /// Changes to a phase at rest if the motion has ended.
    fn settle(&mut self) {
        if self.has_reached_end() {
            self.phase = Phase::Idle;
        } else if self.phase == Phase::Stopping && self.velocity == 0 {
            self.phase = Phase::Halted;
        }
    }
}

/// Converts increments to parts of an increment.
fn whole(increments: i64) -> i128 {
    i128::from(increments) * INC
}

impl SlotType for Epos {
    const DESCRIPTION: Description = Description {
        moves_axes: true,
        inputs: 2,
        outputs: 2,
        rests: 1,
        words: &["vel_override_mw", "acc_override_mw"],
        shows: &[Shown::position("remaining", "what is left of its order")],
        takes_goals: true,
        marks: MarkSource::SinkAxis,
        amk: AmkLimits { sets_call_time: true, ..AmkLimits::USUAL },
        example: &[
            ("ba", 8),
            ("travel", 900),
            ("velocity", 9_000_000),
            ("acceleration", 1_000_000),
            ("stop_decel", 2_000_000),
            ("drive_resolution", 1000),
        ],
        ..Description::of(
            Kind::Epos,
            "epos",
            "moves by a travel at each edge of an input: relative, over multiples of it, or from a zero pulse on",
            FIELDS,
        )
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        Self { has_words: setup.has_words, acceleration_override: FULL, ramps: (1, 1), ..Self::default() }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        self.has_words == other.has_words
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let field = |name| number(FIELDS, name);
        let fault = |code, name, asked, limit| Err(Fault::new(code).of(number(FIELDS, name)).with(asked, limit));
        let (ba, mode, live) = (words.get(at("ba")), Mode::of(words), Live::of(words));
        if mode.modulo && mode.substitutional {
            return fault(Code::AMK_MODULO_SUBSTITUTIONAL, "ba", ba, 0);
        }
        if mode.follows && !setting.has_source {
            return fault(Code::AMK_NO_SOURCE, "ba", ba, 0);
        }
        if mode.substitutional && !setting.has_mark {
            return fault(Code::AMK_NO_REFERENCE, "ba", ba, 0);
        }
        let half_ms = words.get(at("sf_cycle"));
        if mode.substitutional {
            check_cycle_bounds(half_ms, SEARCH_CYCLES, (field("sf_cycle"), field("ba")), setting)?;
        }
        check_cycle(half_ms, field("sf_cycle"), setting)?;
        if (mode.substitutional || mode.modulo) && live.travel == 0 {
            return fault(Code::AMK_NO_TRAVEL, "travel", 0, ba);
        }
        let most = i64::from(i32::MAX);
        match live.velocity {
            0 if mode.substitutional => return fault(Code::AMK_NO_APPROACH, "velocity", 0, most),
            asked @ ..=0 if !mode.substitutional && !mode.follows => {
                return fault(Code::AMK_NOT_ZERO, "velocity", asked, most);
            }
            _ => {}
        }
        if mode.substitutional && !mode.turns_round && (live.travel < 0) != (live.velocity < 0) {
            return fault(Code::AMK_AGAINST_APPROACH, "travel", live.travel, live.velocity);
        }
        if live.stop_decel < live.acceleration {
            return fault(Code::AMK_BEYOND, "stop_decel", live.stop_decel, live.acceleration);
        }
        match words.get(at("master_resolution")) {
            0 if mode.follows => fault(Code::AMK_NOT_ZERO, "master_resolution", 0, most),
            _ => Ok(()),
        }
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        *self = Self {
            mode: Mode::of(words),
            call_ns: seen.call_ns,
            position: seen.sink,
            seen: seen.source.travel,
            before: seen.inputs,
            ..Self::new(&SlotSetup::of_words(self.has_words))
        };
        self.apply_values(words);
        self.step(seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        self.live = Live::of(words);
        self.take_ramps();
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let rising = seen.inputs & !std::mem::replace(&mut self.before, seen.inputs);
        let way = seen.source.travel.wrapping_sub(std::mem::replace(&mut self.seen, seen.source.travel));
        let [percent, share] = seen.words;
        let mut anew = 0;
        if let Some(place) = seen.source.mark.filter(|_| self.phase != Phase::Idle && self.end == End::Unknown) {
            self.set_reference(place);
            anew = place.wrapping_neg();
        }
        // A goal adds its edges to those of the inputs.
        let rising = match seen.asked {
            GoalRequest::Begin => rising | E1,
            GoalRequest::Stop => rising | E2,
            GoalRequest::Nothing | GoalRequest::Hold => rising,
        };
        let goes_on = seen.inputs & E1 != 0 || matches!(seen.asked, GoalRequest::Begin | GoalRequest::Hold);
        let begins = self.switch(rising, share);
        let mut outputs = 0;
        if matches!(self.phase, Phase::Run | Phase::Stopping) {
            let wanted = self.target_velocity(way, percent);
            self.advance(wanted, goes_on);
            if !begins {
                self.settle();
            }
            let is_even = self.phase == Phase::Run && !self.is_settled && self.velocity.abs() == wanted;
            outputs |= if self.mode.modulo && is_even { A2 } else { 0 };
        }
        outputs |= u8::from(matches!(self.phase, Phase::Idle | Phase::Halted));
        let is_open = self.phase != Phase::Idle && self.end != End::Unknown;
        self.shown = [if is_open { ((self.left + self.rest) >> ramp::BITS) as i64 } else { 0 }];
        let writes = A1 | if self.mode.modulo { A2 } else { 0 };
        Outcome { sink: self.position, outputs, writes, coordinate_change: anew, ..Outcome::default() }
    }

    fn progress(&self) -> Progress {
        match self.phase {
            Phase::Idle => Progress::Rests,
            Phase::Run | Phase::Stopping => Progress::Moves,
            Phase::Halted => Progress::Stopped,
        }
    }

    fn drop_order(&mut self) {
        (self.phase, self.velocity, self.left, self.rest, self.end) = (Phase::Idle, 0, 0, 0, End::Ramp);
        self.shown = [0];
    }

    fn runs_with(&self, words: Words<'_>, call_ns: u64) -> bool {
        self.mode == Mode::of(words) && self.live == Live::of(words) && self.call_ns == call_ns
    }

    fn is_valid_state(&self) -> bool {
        let ramps = [self.ramps.0, self.ramps.1];
        ramps.into_iter().all(|ramp| (1..=MAX_VELOCITY).contains(&ramp))
            && (0..=MAX_VELOCITY).contains(&self.speed)
            && self.velocity.saturating_abs() <= MAX_VELOCITY
            && self.left.saturating_abs() <= MAX_DISTANCE
            && (0..INC).contains(&self.rest)
            && (MIN_ACCELERATION_OVERRIDE..=FULL).contains(&self.acceleration_override)
            && i32::try_from(self.travel).is_ok()
    }

    #[inline]
    fn shown(&self) -> &[i64] {
        &self.shown
    }
}

#[cfg(test)]
mod tests;

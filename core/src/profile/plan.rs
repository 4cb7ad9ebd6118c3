//! A planned profile: its construction and evaluation.

use super::Motion;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Largest number of phases of a plan: with jerk limit, from an unavoidable zero crossing over a reversal to passing
/// the target in the other direction.
const MAX_PHASES: usize = 16;

const SIXTH: f64 = 1.0 / 6.0;

/// One increment in units of 2^-32.
pub(super) const ONE: f64 = (1_u64 << 32) as f64;

/// A phase, relative to a reference time: a polynomial of third degree, or half a wave of cosine.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Phase {
    /// Reference time (s), from the start or the end of the plan.
    moment: f64,
    /// Distance of the position at that time (inc), from the start or the end of the plan.
    way: f64,
    /// Velocity at that time (inc/s); for a wave its mean.
    velocity: f64,
    /// Acceleration at that time (inc/s^2); for a wave its amplitude of velocity (inc/s).
    acceleration: f64,
    /// Jerk (inc/s^3); for a wave its angular frequency (1/s).
    jerk: f64,
}

impl Phase {
    /// Returns distance (inc) and motion without position at `time` (s), on the time scale of the reference time.
    #[inline]
    fn at(&self, time: f64) -> (f64, Motion) {
        let past = time - self.moment;
        let half = 0.5 * self.jerk * past;
        let motion = Motion {
            position: Position::ZERO,
            velocity: self.velocity + past * (self.acceleration + half),
            acceleration: self.acceleration + self.jerk * past,
            jerk: self.jerk,
        };
        (self.way + past * (self.velocity + past * (0.5 * self.acceleration + half * (1.0 / 3.0))), motion)
    }

    /// As [`at`](Self::at), for a wave.
    #[inline(never)]
    fn wave_at(&self, time: f64) -> (f64, Motion) {
        let Self { velocity: mean, acceleration: amplitude, jerk: frequency, .. } = *self;
        let past = time - self.moment;
        let (sin, cos) = libm::sincos(frequency * past);
        let motion = Motion {
            position: Position::ZERO,
            velocity: mean - amplitude * cos,
            acceleration: amplitude * frequency * sin,
            jerk: amplitude * frequency * frequency * cos,
        };
        (self.way + mean * past - amplitude / frequency * sin, motion)
    }
}

/// Returns the first cycle at or after `time` (s). A millionth of a cycle is rounding.
fn cycles(time: f64, cycle_ns: u64) -> u64 {
    let exact = time * 1e9 / cycle_ns as f64;
    // The cast saturates, below at 0.
    let whole = exact as u64;
    if exact - (whole as f64) < 1e-6 { whole } else { whole.saturating_add(1) }
}

/// Returns the nearest position at a distance from `base`, as `Position::from_f64` but faster for usual distances.
#[inline]
fn position(base: Position, way: f64) -> Position {
    let raw = way * ONE;
    let size = raw.abs();
    if size < (1_u64 << 62) as f64 {
        // From 2^52 on an f64 is whole.
        let half = if size < (1_u64 << 52) as f64 { 0.5_f64.copysign(raw) } else { 0.0 };
        // The sum can wrap only with an invalid base.
        Position::from_raw(base.raw().wrapping_add(i128::from((raw + half) as i64)))
    } else {
        advanced_by(base, way)
    }
}

#[cold]
fn advanced_by(base: Position, way: f64) -> Position {
    base + Position::from_f64(way)
}

/// Distance of a phase that is rounding (inc).
const NEGLIGIBLE: f64 = 1e-9;

/// A planned profile, evaluated at elapsed cycles.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Start time of each phase (s), from the start of the plan; the largest number for unused ones.
    begins: [f64; MAX_PHASES],
    /// Phases evaluated from the start come first in the array, phases evaluated from the end come last.
    phases: [Phase; MAX_PHASES],
    start: Position,
    /// End position, and velocity with which it continues.
    end: Position,
    end_velocity: f64,
    /// Duration (s).
    duration: f64,
    /// Time by which it began before its start cycle (s).
    lead: f64,
    cycles: u64,
    cycle_ns: u64,
    /// Number of phases evaluated from the start.
    count: u8,
    /// Index of the first phase evaluated from the end.
    turn: u8,
    /// Bit i: phase i is a wave.
    waves: u16,
}

impl Plan {
    /// Returns a plan that stays at its position.
    #[inline]
    pub(super) fn new(start: Position, cycle_ns: u64) -> Self {
        Self {
            begins: [f64::MAX; MAX_PHASES],
            phases: [Phase::default(); MAX_PHASES],
            start,
            end: start,
            end_velocity: 0.0,
            duration: 0.0,
            lead: 0.0,
            cycles: 0,
            cycle_ns,
            count: 0,
            turn: MAX_PHASES as u8,
            waves: 0,
        }
    }

    /// Returns the end position.
    pub fn end(&self) -> Position {
        self.end
    }

    /// Returns the velocity at the end (inc/s); 0 for a plan to rest.
    pub fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// Returns the duration (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        let numbers = |phase: &Phase| {
            let Phase { moment, way, velocity, acceleration, jerk } = *phase;
            [moment, way, velocity, acceleration, jerk].iter().all(|number| number.is_finite())
        };
        self.count <= self.turn
            && usize::from(self.turn) <= MAX_PHASES
            && self.phases.iter().all(numbers)
            && [self.duration, self.end_velocity, self.lead].iter().all(|number| number.is_finite())
    }

    /// Returns the number of the first cycle at or after its end.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// Returns the same plan, begun `seconds` before its start cycle; less than a cycle.
    #[must_use]
    pub fn with_lead(mut self, seconds: f64) -> Self {
        self.lead = seconds;
        self.cycles = cycles(self.duration - seconds, self.cycle_ns);
        self
    }

    /// Returns the time from the end of the plan to cycle `elapsed` (s); 0 before the end.
    pub fn overshoot(&self, elapsed: u64) -> f64 {
        (self.time(elapsed) - self.duration).max(0.0)
    }

    #[inline]
    fn time(&self, elapsed: u64) -> f64 {
        // Exact below 2^53 ns, and correctly rounded by the single division; the conversion of 64 bits is faster.
        let ns = elapsed.saturating_mul(self.cycle_ns).min(i64::MAX as u64) as i64;
        ns as f64 / 1e9 + self.lead
    }

    /// Returns the motion `elapsed` cycles after the start.
    #[inline]
    pub fn at(&self, elapsed: u64) -> Motion {
        let time = self.time(elapsed);
        if elapsed >= self.cycles {
            let over = self.end_velocity * (time - self.duration).max(0.0);
            let position = position(self.end, over);
            return Motion { position, velocity: self.end_velocity, acceleration: 0.0, jerk: 0.0 };
        }
        let turn = usize::from(self.turn);
        let first = if self.begins.get(turn).is_some_and(|begin| *begin <= time) { turn } else { 0 };
        let index = first + self.begins.iter().skip(first + 1).take_while(|begin| **begin <= time).count();
        let (way, motion) = self.read(index, time);
        if time <= 0.0 {
            return Motion { position: self.start, ..motion };
        }
        let base = if index >= turn { self.end } else { self.start };
        Motion { position: position(base, way), ..motion }
    }

    /// Evaluates phase `index` at `time` (s) from the start.
    #[inline]
    fn read(&self, index: usize, time: f64) -> (f64, Motion) {
        let Some(phase) = self.phases.get(index) else { return Default::default() };
        let clock = if index >= usize::from(self.turn) { time - self.duration } else { time };
        if self.waves >> (index % MAX_PHASES) & 1 == 0 { phase.at(clock) } else { phase.wave_at(clock) }
    }

    /// Returns lowest and highest position from `now` to the end: these are `now`, the end or a reversal.
    pub fn extent_from(&self, now: Position) -> (Position, Position) {
        let (low, high) = self.extent();
        // Positions between the start and now are not reached again, except by a reversal. Past reversals are included,
        // which errs on the safe side.
        let (mut least, mut most) = (now.min(self.end), now.max(self.end));
        self.places(|place, is_turn| {
            if is_turn {
                (least, most) = (least.min(place), most.max(place));
            }
        });
        (if low == self.start { least } else { low }, if high == self.start { most } else { high })
    }

    /// Returns lowest and highest position of a plan to rest.
    pub fn extent(&self) -> (Position, Position) {
        let (mut low, mut high) = (self.start.min(self.end), self.start.max(self.end));
        self.places(|place, _| (low, high) = (low.min(place), high.max(place)));
        (low, high)
    }

    /// Calls `see` with the positions between its phases and its reversals, within a phase or between two phases.
    fn places(&self, mut see: impl FnMut(Position, bool)) {
        let turn = usize::from(self.turn).min(MAX_PHASES);
        let places = (0..usize::from(self.count).min(turn)).chain(turn..MAX_PHASES);
        let mut direction = 0.0;
        for index in places.clone() {
            let begin = self.begins.get(index).copied().unwrap_or_default();
            let next = places.clone().find(|next| *next > index).and_then(|next| self.begins.get(next));
            let end = next.copied().unwrap_or(self.duration);
            let (before, after) = (self.read(index, begin), self.read(index, end));
            let base = if index >= turn { self.end } else { self.start };
            // Within a phase the sign of the acceleration is constant.
            let turns = before.1.velocity * after.1.velocity < 0.0;
            let way = after.0 - before.0;
            let moves = way.abs() > NEGLIGIBLE;
            let (first, last) = match (turns, moves) {
                (true, _) => (before.1.velocity, after.1.velocity),
                (false, true) => (way, way),
                (false, false) => (direction, direction),
            };
            // Phases evaluated from the start are exact at their start, phases evaluated from the end at their end.
            let turned = first * direction < 0.0;
            if index < turn || turned {
                see(position(base, before.0), turned);
            }
            if index >= turn {
                see(position(base, after.0), false);
            }
            if turns {
                let way = self.read(index, self.turning_time(index, begin, end)).0;
                see(position(base, way), true);
            }
            direction = last;
        }
    }

    /// Returns the time at which the velocity of a phase passes through zero between `begin` and `end` (s).
    fn turning_time(&self, index: usize, begin: f64, end: f64) -> f64 {
        let phase = self.phases.get(index).copied().unwrap_or_default();
        let Phase { velocity, acceleration, jerk, .. } = phase;
        let past = if self.waves >> (index % MAX_PHASES) & 1 == 0 {
            let root = (acceleration * acceleration - 2.0 * jerk * velocity).max(0.0).sqrt();
            let sum = -(acceleration + root.copysign(acceleration));
            [2.0 * velocity / sum, sum / jerk]
        } else {
            let turn = libm::acos(velocity / acceleration) / jerk;
            [turn, -turn]
        };
        let moment = phase.moment + if index >= usize::from(self.turn) { self.duration } else { 0.0 };
        let middle = 0.5 * (begin + end);
        let times = past.map(|past| moment + past);
        let nearest = if (times[0] - middle).abs() <= (times[1] - middle).abs() { times[0] } else { times[1] };
        if nearest >= begin && nearest <= end { nearest } else { middle }
    }
}

/// A plan under construction: phases are appended at its start and, the last one first, prepended at its end.
pub(super) struct Draft<'a> {
    plan: &'a mut Plan,
    /// Time (s) and distance (inc) of the phases at the start.
    time: f64,
    pub(super) way: f64,
    /// Time (s) and distance (inc) of the phases at the end.
    left: f64,
    rest: f64,
}

impl<'a> Draft<'a> {
    pub(super) fn new(plan: &'a mut Plan) -> Self {
        Self { plan, time: 0.0, way: 0.0, left: 0.0, rest: 0.0 }
    }

    #[inline]
    fn push(&mut self, phase: Phase, wave: bool) {
        let index = usize::from(self.plan.count);
        if self.plan.count < self.plan.turn
            && let (Some(place), Some(begin)) = (self.plan.phases.get_mut(index), self.plan.begins.get_mut(index))
        {
            *place = phase;
            *begin = self.time;
            self.plan.waves |= u16::from(wave) << index;
            self.plan.count += 1;
        }
    }

    #[inline]
    fn push_tail(&mut self, phase: Phase, wave: bool) {
        let index = usize::from(self.plan.turn).wrapping_sub(1);
        if self.plan.count < self.plan.turn
            && let Some(place) = self.plan.phases.get_mut(index)
        {
            *place = phase;
            self.plan.waves |= u16::from(wave) << index;
            self.plan.turn -= 1;
        }
    }

    /// Appends a phase to those at the start: `time` (s), its initial velocity and acceleration, its jerk. A phase
    /// without time is omitted.
    #[inline]
    pub(super) fn forward(&mut self, time: f64, velocity: f64, acceleration: f64, jerk: f64) {
        if time > 0.0 {
            let last = self.plan.phases.get(usize::from(self.plan.count).wrapping_sub(1));
            let goes_on = acceleration != 0.0 && jerk != 0.0 && last.is_some_and(|last| last.jerk == jerk);
            if !goes_on {
                self.push(Phase { moment: self.time, way: self.way, velocity, acceleration, jerk }, false);
            }
            self.way += time * (velocity + time * (0.5 * acceleration + jerk * time * SIXTH));
            self.time += time;
        }
    }

    /// Prepends a phase to those at the end: `time` (s), its final velocity and acceleration, its jerk.
    #[inline]
    pub(super) fn backward(&mut self, time: f64, velocity: f64, acceleration: f64, jerk: f64) {
        if time > 0.0 {
            self.push_tail(Phase { moment: -self.left, way: -self.rest, velocity, acceleration, jerk }, false);
            self.rest += time * (velocity - time * (0.5 * acceleration - jerk * time * SIXTH));
            self.left += time;
        }
    }

    /// Appends half a wave of cosine to the phases at the start.
    pub(super) fn wave_forward(&mut self, time: f64, from: f64, to: f64) {
        if time > 0.0 {
            let (velocity, acceleration, jerk) = (0.5 * (from + to), 0.5 * (to - from), std::f64::consts::PI / time);
            self.push(Phase { moment: self.time, way: self.way, velocity, acceleration, jerk }, true);
            self.way += velocity * time;
            self.time += time;
        }
    }

    /// Prepends half a wave of cosine to the phases at the end.
    pub(super) fn wave_backward(&mut self, time: f64, from: f64, to: f64) {
        if time > 0.0 {
            let (velocity, acceleration, jerk) = (0.5 * (from + to), 0.5 * (from - to), std::f64::consts::PI / time);
            self.push_tail(Phase { moment: -self.left, way: -self.rest, velocity, acceleration, jerk }, true);
            self.rest += velocity * time;
            self.left += time;
        }
    }

    /// Appends a quarter of a wave in which `acceleration` ends, with an angular `frequency` (1/s).
    pub(super) fn push_quarter_wave(&mut self, velocity: f64, acceleration: f64, frequency: f64) {
        let time = std::f64::consts::FRAC_PI_2 / frequency;
        if time > 0.0 {
            let amplitude = acceleration / frequency;
            let way = self.way - velocity * time + amplitude / frequency;
            self.push(
                Phase { moment: self.time - time, way, velocity, acceleration: amplitude, jerk: frequency },
                true,
            );
            self.way += velocity * time + amplitude / frequency;
            self.time += time;
        }
    }

    /// Adds a phase of constant velocity for `time` (s): its first half is evaluated from the start, its second half
    /// from the end.
    pub(super) fn cruise(&mut self, time: f64, velocity: f64) {
        self.forward(0.5 * time, velocity, 0.0, 0.0);
        self.backward(0.5 * time, velocity, 0.0, 0.0);
    }

    /// Ends the plan at `target` or, without one, at its distance; it continues with `end_velocity`.
    pub(super) fn finish(self, target: Option<Position>, end_velocity: f64) {
        let plan = self.plan;
        plan.duration = self.time + self.left;
        plan.cycles = cycles(plan.duration, plan.cycle_ns);
        plan.end = target.unwrap_or_else(|| position(plan.start, self.way + self.rest));
        plan.end_velocity = end_velocity;
        let mut begin = self.time;
        let turn = usize::from(plan.turn).min(MAX_PHASES);
        for (begins, phase) in plan.begins[turn..].iter_mut().zip(&plan.phases[turn..]) {
            *begins = begin;
            // The reference time of a phase at the end is the start of the next one.
            begin = plan.duration + phase.moment;
        }
    }
}

//! Judging a cycle: following error and arrival.

use super::alarm::NO_NUMBERS;
use super::power::Power;
use super::reaction::Failure;
use super::{Axis, AxisState, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Severity};
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::regulator::{PAST, past};
use serde::{Deserialize, Serialize};

/// How far apart the axes are looked at in turn (ns).
const TURN_NS: u64 = 20_000_000;
/// An error that only is reported is told that often (ns).
const REPEAT_NS: u64 = 1_000_000_000;
/// An encoder that has not moved for so long stands (ns).
const STILL_NS: u64 = 5_000_000;
/// In [`Judge::waits_since`]: it was told.
const TOLD: u64 = u64::MAX;

/// What an axis remembers to judge itself.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(super) struct Judge {
    /// Length of the ring: one per cycle of the drive's delay and one more.
    length: usize,
    place: usize,
    /// Command that the actual position of this cycle answers, minus that actual position (inc).
    pub following_error: i64,
    exceeded_since: Option<u64>,
    /// Round robin: how often it was found exceeded, in succession.
    exceeded_times: u64,
    /// A following error was told in that cycle.
    told: Option<u64>,
    inside_since: Option<u64>,
    /// In the target window: the actual position, and the cycle in which it was read.
    reading: Option<(u64, i64)>,
    /// Since when a goal waits for its target window; once it was told of, for ever.
    waits_since: Option<u64>,
    /// At rest at the target, within the window for long enough.
    pub in_position: bool,
    /// How far the encoder has gone since it was found to go on.
    drift: Position,
    /// When that was last.
    drifted: Option<u64>,
    /// Error reaction that waits for the end of a stop; below 0 for none.
    pub after_stop: i64,
    /// Where the last goal rested, before rounding to whole increments.
    pub rested_at: Option<Position>,
    /// Command positions of the last cycles, in a ring. A cycle touches two places of it.
    #[serde(with = "past")]
    past: [i64; PAST],
}

impl Judge {
    /// Bytes in front of the ring.
    pub(super) const HOT_BYTES: usize = std::mem::offset_of!(Judge, past);

    pub(super) fn new(delay: u32) -> Self {
        Self {
            length: delay as usize + 1,
            place: 0,
            following_error: 0,
            exceeded_since: None,
            exceeded_times: 0,
            told: None,
            drift: Position::ZERO,
            drifted: None,
            inside_since: None,
            reading: None,
            waits_since: None,
            in_position: false,
            after_stop: -1,
            rested_at: None,
            past: [0; PAST],
        }
    }

    /// Is its ring as long as another one's?
    pub(super) fn has_ring_of(&self, other: &Self) -> bool {
        self.length == other.length && self.place < self.length
    }

    /// Forgets the past: the axis has been standing at `position`.
    pub(super) fn fill(&mut self, position: i64) {
        self.past.fill(position);
        self.keep_within();
        self.rested_at = None;
    }

    /// Forgets the past: the axis is at `here` (inc) and goes on by `step` a cycle, whoever asked for that.
    pub(super) fn follow(&mut self, here: i64, step: f64) {
        for cycle in 0..self.length {
            let ahead = (step * cycle as f64).round() as i64;
            // The next one to be answered stands behind the present place.
            let place = (self.place + 1 + cycle) % self.length;
            if let Some(past) = self.past.get_mut(place) {
                *past = here.saturating_add(ahead);
            }
        }
        self.keep_within();
        self.rested_at = None;
    }

    /// Every place is `by` (inc) more from now on.
    pub(super) fn shift(&mut self, by: i64) {
        self.past.iter_mut().for_each(|place| *place = place.wrapping_add(by));
        self.reading = self.reading.map(|(cycle, position)| (cycle, position.wrapping_add(by)));
        self.rested_at = self.rested_at.map(|rested| rested + Position::whole(by));
    }

    /// The following error is small.
    fn keep_within(&mut self) {
        (self.exceeded_since, self.exceeded_times) = (None, 0);
    }

    /// Is a following error allowed, and was the last one? Then judging it would change nothing.
    #[inline]
    pub(super) fn stays_within(&self, error: i64, p: &AxisParameters) -> bool {
        let is_within = error.unsigned_abs() <= p.max_following_error.unsigned_abs();
        is_within && self.exceeded_since.is_none() && self.exceeded_times == 0
    }

    /// Has it nothing of a rest that it would have to leave?
    pub(super) fn has_left_rest(&self) -> bool {
        let is_inside = self.in_position || self.inside_since.is_some() || self.reading.is_some();
        !is_inside && self.waits_since.is_none()
    }

    /// The actual position is not in the target window.
    fn leave_window(&mut self) {
        (self.inside_since, self.reading) = (None, None);
    }

    /// An error was reset: of its following error nothing is left, unless that lasts.
    pub(super) fn forget(&mut self, lasts: bool) {
        if !lasts {
            self.keep_within();
        }
        self.after_stop = -1;
    }

    /// Notes a step of the encoder; what stays within `most` from where it began is none.
    #[inline]
    pub(super) fn note_step(&mut self, cycle: u64, step: Position, most: Position) {
        self.drift += step;
        if self.drift > most || self.drift < -most {
            (self.drift, self.drifted) = (Position::ZERO, Some(cycle));
        }
    }

    /// The oldest command that is kept.
    fn oldest(&self) -> usize {
        if self.place + 1 < self.length { self.place + 1 } else { 0 }
    }

    /// The command that the actual position of this cycle answers.
    fn answered(&self) -> i64 {
        self.past.get(self.oldest()).copied().unwrap_or_default()
    }

    /// Keeps the same command for another cycle.
    pub(super) fn pass(&mut self) {
        self.place = self.oldest();
    }

    /// Is something to be done once the axis stands?
    pub(super) fn has_left_something(&self) -> bool {
        self.after_stop != -1
    }

    /// Has nothing begun that has its time, and are all commands that are kept this one?
    pub(super) fn is_settled(&self, asked: i64, allowed: i64) -> bool {
        let is_beyond = self.following_error.unsigned_abs() > allowed.unsigned_abs();
        let exceeds = is_beyond || self.exceeded_since.is_some() || self.exceeded_times != 0;
        let kept = self.past.get(..self.length).unwrap_or_default();
        !exceeds && !self.has_left_something() && kept.iter().all(|kept| *kept == asked)
    }

    /// Keeps the command of this cycle.
    #[inline]
    pub(super) fn keep(&mut self, command: i64) {
        self.place = self.oldest();
        if let Some(past) = self.past.get_mut(self.place) {
            *past = command;
        }
    }
}

impl Axis {
    /// The errors that the inputs of this cycle show: known before the commands of the cycle, and to the vocabularies.
    pub(super) fn judge_errors(&mut self, cx: &mut Context<'_>) {
        self.judge.note_step(cx.cycle, self.actual.change, self.slack());
        if !self.is_on() {
            self.judge.following_error = 0;
            return;
        }
        self.judge_jump(cx);
        if !self.is_on() {
            return;
        }
        if self.is_open_loop() || self.out_an().is_some() {
            self.judge.following_error = 0;
        } else if !self.is_virtual() {
            self.judge_following(cx, self.following_error());
        }
    }

    /// Is it at its target? Once the commands of the cycle have had their say.
    pub(super) fn judge_arrival(&mut self, cx: &mut Context<'_>) {
        self.judge.keep(self.asked());
        if !self.is_on() {
            self.holding.settles_since = None;
            self.judge.following_error = 0;
            self.judge.leave_window();
            self.judge.waits_since = None;
            self.judge.in_position = false;
        } else if self.rests() {
            self.judge_rest(cx);
        } else {
            self.leave_rest();
        }
    }

    /// It moves.
    fn leave_rest(&mut self) {
        self.holding.settles_since = None;
        self.judge.leave_window();
        self.judge.waits_since = None;
        self.judge.in_position = false;
    }

    /// The command that the actual position of this cycle answers, minus that position (inc).
    #[inline]
    pub(super) fn following_error(&self) -> i64 {
        // A simulated encoder shows the command itself.
        if self.is_simulated() { 0 } else { self.judge.answered().saturating_sub(self.actual.position.floor()) }
    }

    fn judge_following(&mut self, cx: &mut Context<'_>, error: i64) {
        self.judge.following_error = error;
        let is_within = error.unsigned_abs() <= self.parameters.max_following_error.unsigned_abs();
        let lasts = match self.parameters.supervision.following_error_check {
            1 => self.is_found_in_turn(cx.cycle, is_within),
            _ => self.exceeds_for_long(cx.cycle, is_within),
        };
        if !lasts || self.state == AxisState::ErrorStop {
            return;
        }
        let (error, allowed) = (Number::Position(error), Number::Position(self.parameters.max_following_error));
        if self.alarm.is_none() || !self.only_reports(Code::FOLLOWING_ERROR) {
            // Since it was reported error_reaction has become one that stops the axis: it is an error anew.
            if self.alarm.code() == Code::FOLLOWING_ERROR {
                self.alarm.clear();
            }
            self.tell_following_error(cx, error, allowed);
        } else {
            self.repeat(cx, error, allowed);
        }
    }

    /// The reaction to a following error.
    pub(super) fn tell_following_error(&mut self, cx: &mut Context<'_>, found: Number, allowed: Number) {
        self.judge.told = Some(cx.cycle);
        self.raise(cx, Failure::of(Code::FOLLOWING_ERROR).with(found, allowed));
    }

    /// Does it go away from its command, further than it may be off?
    pub(super) fn runs_away(&self) -> bool {
        let (error, most) = (self.judge.following_error, self.parameters.max_following_error);
        let leads_off =
            if error > 0 { self.actual.change < Position::ZERO } else { self.actual.change > Position::ZERO };
        error.unsigned_abs() > most.unsigned_abs() && leads_off
    }

    /// The following error that there still is, beyond what is tolerated.
    pub(super) fn lasting_following_error(&self, cycle: u64) -> Option<(Number, Number)> {
        let lasts = match self.parameters.supervision.following_error_check {
            1 => self.judge.exceeded_times > self.tolerated_times(),
            _ => self.judge.exceeded_since.is_some_and(|since| self.is_too_long(cycle, since)),
        };
        let error = Number::Position(self.judge.following_error);
        (lasts && self.is_on()).then_some((error, Number::Position(self.parameters.max_following_error)))
    }

    /// How far an encoder that stands may tremble or creep in [`STILL_NS`]: two counts, or a thousandth of the highest speed.
    pub(super) fn slack(&self) -> Position {
        self.parameters.derived.slack
    }

    /// Does its encoder move, as far as it shows? A drive that is lost shows nothing; one that has nothing new in
    /// this cycle is waited for.
    pub(super) fn turns(&self, cycle: u64) -> bool {
        let age = |drifted| cycle.saturating_sub(drifted).saturating_mul(self.setup.cycle_ns);
        self.shown.is_awaited(self.setup.missed_cycles)
            || self.judge.drifted.is_some_and(|drifted| age(drifted) < STILL_NS)
    }

    /// Did its encoder move in this cycle, faster than one that stands may creep? One look tells, where a reset waits for a while: what
    /// is braked by its drive does not coast.
    pub(super) fn moves(&self) -> bool {
        let change = self.actual.change.to_f64().abs().max(self.holding.second_change.saturating_abs() as f64);
        let moved = change * STILL_NS as f64;
        self.shown.is_awaited(self.setup.missed_cycles) || moved > self.slack().to_f64() * self.setup.cycle_ns as f64
    }

    /// Longer than it may? In each cycle anew.
    fn exceeds_for_long(&mut self, cycle: u64, is_within: bool) -> bool {
        if is_within {
            self.judge.keep_within();
            return false;
        }
        let since = *self.judge.exceeded_since.get_or_insert(cycle);
        self.is_too_long(cycle, since)
    }

    fn is_too_long(&self, cycle: u64, since: u64) -> bool {
        let time = cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        let tolerated = self.parameters.following_error_time.unsigned_abs();
        tolerated == 0 || time > tolerated
    }

    /// How often in succession it may be found exceeded when it is looked at in turn.
    fn tolerated_times(&self) -> u64 {
        let count = u64::from(self.setup.round.1.max(1));
        self.parameters.following_error_time.unsigned_abs() / count.saturating_mul(TURN_NS)
    }

    /// Found more often in succession than it may be? Looked at when it is this axis' turn (MACS-ERR-07).
    fn is_found_in_turn(&mut self, cycle: u64, is_within: bool) -> bool {
        let (place, count) = (u64::from(self.setup.round.0), u64::from(self.setup.round.1.max(1)));
        let turn = |cycle: u64| cycle.saturating_mul(self.setup.cycle_ns) / TURN_NS;
        let is_new = cycle == 0 || turn(cycle) != turn(cycle - 1);
        if !is_new || turn(cycle) % count != place {
            return false;
        }
        self.judge.exceeded_times = if is_within { 0 } else { self.judge.exceeded_times.saturating_add(1) };
        self.judge.exceeded_times > self.tolerated_times()
    }

    /// A following error that stops nothing is told again as long as it lasts (MACS-ERR-03), also beside another error.
    fn repeat(&mut self, cx: &mut Context<'_>, found: Number, allowed: Number) {
        let age = self.judge.told.map(|told| cx.cycle.saturating_sub(told).saturating_mul(self.setup.cycle_ns));
        if age.is_none_or(|age| age >= REPEAT_NS) {
            self.judge.told = Some(cx.cycle);
            self.tell_error(cx, Failure::of(Code::FOLLOWING_ERROR).with(found, allowed));
        }
    }

    /// The generator has nothing more to do: the goal is reached, or what ended it is done.
    fn judge_rest(&mut self, cx: &mut Context<'_>) {
        self.finish_stop(cx.cycle);
        self.judge.in_position = self.is_in_window(cx) && self.has_taken_up();
        if self.homing.is_running() {
            return self.settle_homing(cx);
        }
        use AxisState::{ContinuousMotion, DiscreteMotion, Homing};
        let is_moving_state = matches!(self.state, DiscreteMotion | ContinuousMotion | Homing);
        // A trajectory ends for all of its axes at once.
        if !is_moving_state || self.power != Power::On || self.has_track() {
            return;
        }
        let missed = self.searches();
        let ending = if missed { Some(Code::PROBE_MISSED) } else { self.goal.and_then(|goal| goal.ending) };
        let reached = self.judge.in_position || self.goal.is_none() || (ending.is_some() && !missed);
        if !reached {
            self.tell_long_wait(cx);
        }
        if reached {
            if ending.is_none() {
                self.judge.rested_at = self.goal.and_then(|goal| goal.target);
            }
            self.end_goal(cx, ending.unwrap_or(Code::NONE));
            if missed {
                self.buffer.end(cx.events, self.setup.index, Code::NOT_REACHED, self.command.position, NO_NUMBERS);
            }
            if self.buffer.is_empty() {
                self.set_state(cx, AxisState::Standstill);
            } else {
                let before = self.judge.rested_at;
                self.begin_next(cx, self.command, 0.0, before);
            }
        }
    }

    /// A goal that waits too long for its target window is told of, once (MACS-TGT-06).
    pub(super) fn tell_long_wait(&mut self, cx: &mut Context<'_>) {
        let patience = self.parameters.supervision.in_position_timeout.unsigned_abs();
        let since = *self.judge.waits_since.get_or_insert(cx.cycle);
        let waited = cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        if patience == 0 || since == TOLD || waited < patience {
            return;
        }
        self.judge.waits_since = Some(TOLD);
        let distance = self.asked().saturating_sub(self.actual.position.floor());
        let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::IN_POSITION_TIMEOUT);
        let window = Number::Position(self.parameters.in_position_window);
        let event = event.with(Number::Position(distance), window);
        cx.events.push(Event { position: self.actual.position, ..event });
    }

    /// MACS-TGT-01: without a window the command is enough. MACS-TGT-03: with a time and testval, two readings that are near
    /// to each other. MACS-TGT-04: with a time alone, longer than that within it.
    fn is_in_window(&mut self, cx: &Context<'_>) -> bool {
        let window = self.parameters.in_position_window;
        if window > 0 && !self.is_virtual() {
            let distance = self.asked().saturating_sub(self.actual.position.floor());
            if distance.unsigned_abs() > window.unsigned_abs() {
                self.judge.leave_window();
                return false;
            }
        }
        let most = self.parameters.supervision.testval;
        if window > 0 && most > 0 && self.parameters.in_position_time > 0 && !self.is_virtual() {
            return self.reads_the_same_twice(cx.cycle, most);
        }
        let since = *self.judge.inside_since.get_or_insert(cx.cycle);
        let time = self.parameters.in_position_time.unsigned_abs();
        window == 0 || time == 0 || cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns) > time
    }

    /// Two readings in the window, in_position_time apart, differ by less than `most`; once they do, that stays.
    fn reads_the_same_twice(&mut self, cycle: u64, most: i64) -> bool {
        let here = self.actual.position.floor();
        let (since, before) = *self.judge.reading.get_or_insert((cycle, here));
        if self.judge.in_position {
            return true;
        }
        let waited = cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        if waited < self.parameters.in_position_time.unsigned_abs() {
            return false;
        }
        self.judge.reading = Some((cycle, here));
        here.abs_diff(before) < most.unsigned_abs()
    }
}

/// How far an encoder that stands may tremble or creep, as these parameters have it.
pub(super) fn slack_of(p: &AxisParameters) -> Position {
    Position::from_f64((p.max_velocity / 1000.0 * STILL_NS as f64 / 1e9).max(2.0))
}

//! State of the supervision of an axis: following error, target window, drift of the encoder.

use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::regulator::{PAST, past};
use serde::{Deserialize, Serialize};

/// Time without motion after which an encoder is at rest (ns).
pub(in crate::axis) const STILL_NS: u64 = 5_000_000;

/// Value of the field `waits_since` after the wait was reported.
const LONG_WAIT_REPORTED: u64 = u64::MAX;

/// State of the supervision of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct Supervision {
    /// Length of the ring: the delay of the drive in cycles, plus one.
    length: usize,
    place: usize,
    /// Command to which the actual position of this cycle responds, minus that actual position (inc).
    following_error: i64,
    exceeded_since: Option<u64>,
    /// Round robin: number of successive checks with an exceeded following error.
    exceeded_times: u64,
    /// Cycle in which a following error was last reported.
    told: Option<u64>,
    inside_since: Option<u64>,
    /// In the target window: the actual position, and the cycle in which it was read.
    reading: Option<(u64, i64)>,
    /// Cycle since which a goal waits for its target window; [`LONG_WAIT_REPORTED`] after that was reported.
    waits_since: Option<u64>,
    /// Whether the axis is at rest at the target and has been within the window for long enough.
    in_position: bool,
    /// Travel of the encoder since motion was last detected.
    drift: Position,
    /// Cycle in which motion was last detected.
    drifted: Option<u64>,
    /// Error reaction that waits for the end of a stop; below 0 for none.
    after_stop: i64,
    /// End of the last goal before rounding to whole increments.
    rested_at: Option<Position>,
    /// Command positions of the last cycles, in a ring. A cycle accesses two of them.
    #[serde(with = "past")]
    past: [i64; PAST],
}

impl Supervision {
    /// Size of the fields before the ring (bytes).
    pub(super) const HOT_BYTES: usize = std::mem::offset_of!(Supervision, past);

    pub(in crate::axis) fn new(delay: u32) -> Self {
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

    /// Whether its ring has the same length as that of `other`.
    #[inline]
    pub(in crate::axis) fn has_ring_of(&self, other: &Self) -> bool {
        self.length == other.length && self.place < self.length
    }

    /// Resets the history to an axis at rest at `position`.
    pub(in crate::axis) fn fill(&mut self, position: i64) {
        self.past.fill(position);
        self.keep_within();
        self.rested_at = None;
    }

    /// Resets the history to an axis that is at `here` (inc) and moves `step` per cycle, whatever was commanded.
    pub(in crate::axis) fn follow(&mut self, here: i64, step: f64) {
        for cycle in 0..self.length {
            let ahead = (step * cycle as f64).round() as i64;
            // The next command to be compared follows the present one.
            let place = (self.place + 1 + cycle) % self.length;
            if let Some(past) = self.past.get_mut(place) {
                *past = here.saturating_add(ahead);
            }
        }
        self.keep_within();
        self.rested_at = None;
    }

    /// Increases all positions by `by` (inc).
    pub(in crate::axis) fn shift(&mut self, by: i64) {
        self.past.iter_mut().for_each(|place| *place = place.wrapping_add(by));
        self.reading = self.reading.map(|(cycle, position)| (cycle, position.wrapping_add(by)));
        self.rested_at = self.rested_at.map(|rested| rested + Position::whole(by));
    }

    /// Notes that the following error is within its limit.
    #[inline]
    pub(in crate::axis) fn keep_within(&mut self) {
        (self.exceeded_since, self.exceeded_times) = (None, 0);
    }

    /// Whether a following error is allowed, and the last one was, too, so that the check would change nothing.
    #[inline]
    pub(in crate::axis) fn stays_within(&self, error: i64, p: &AxisParameters) -> bool {
        let is_within = error.unsigned_abs() <= p.max_following_error.unsigned_abs();
        is_within && self.exceeded_since.is_none() && self.exceeded_times == 0
    }

    /// Whether no state of a rest is left.
    pub(in crate::axis) fn has_left_rest(&self) -> bool {
        let is_inside = self.in_position || self.inside_since.is_some() || self.reading.is_some();
        !is_inside && self.waits_since.is_none()
    }

    /// Notes that the actual position is outside the target window.
    #[inline]
    pub(in crate::axis) fn leave_window(&mut self) {
        (self.inside_since, self.reading) = (None, None);
    }

    /// Clears the state of a following error after a reset, unless the following error lasts.
    pub(in crate::axis) fn forget(&mut self, lasts: bool) {
        if !lasts {
            self.keep_within();
        }
        self.after_stop = -1;
    }

    /// Adds a step of the encoder. Motion within `most` of its start does not count.
    #[inline]
    pub(in crate::axis) fn note_step(&mut self, cycle: u64, step: Position, most: Position) {
        self.drift += step;
        if self.drift > most || self.drift < -most {
            (self.drift, self.drifted) = (Position::ZERO, Some(cycle));
        }
    }

    /// Returns the index of the oldest stored command.
    #[inline]
    fn oldest(&self) -> usize {
        if self.place + 1 < self.length { self.place + 1 } else { 0 }
    }

    /// Returns the command to which the actual position of this cycle responds.
    #[inline]
    pub(in crate::axis) fn answered_command(&self) -> i64 {
        self.past.get(self.oldest()).copied().unwrap_or_default()
    }

    /// Stores the same command for another cycle.
    #[inline]
    pub(in crate::axis) fn pass(&mut self) {
        self.place = self.oldest();
    }

    /// Whether a reaction waits until the axis is at rest.
    #[inline]
    pub(in crate::axis) fn has_pending_reaction(&self) -> bool {
        self.after_stop != -1
    }

    /// Whether no timer runs, and all stored commands are equal to `asked`.
    pub(in crate::axis) fn is_settled(&self, asked: i64, allowed: i64) -> bool {
        let is_beyond = self.following_error.unsigned_abs() > allowed.unsigned_abs();
        let exceeds = is_beyond || self.exceeded_since.is_some() || self.exceeded_times != 0;
        let kept = self.past.get(..self.length).unwrap_or_default();
        !exceeds && !self.has_pending_reaction() && kept.iter().all(|kept| *kept == asked)
    }

    /// Stores the command of this cycle.
    #[inline]
    pub(in crate::axis) fn keep(&mut self, command: i64) {
        self.place = self.oldest();
        if let Some(past) = self.past.get_mut(self.place) {
            *past = command;
        }
    }

    /// Returns the command to which the actual position of this cycle responds, minus that actual position (inc).
    #[inline]
    pub(in crate::axis) fn following_error(&self) -> i64 {
        self.following_error
    }

    #[inline]
    pub(in crate::axis) fn set_following_error(&mut self, error: i64) {
        self.following_error = error;
    }

    /// Returns the cycle since which the following error has been exceeded; none while it is allowed.
    #[inline]
    pub(in crate::axis) fn exceeded_since(&self) -> Option<u64> {
        self.exceeded_since
    }

    /// Notes an exceeded following error, and returns the cycle since which it has been exceeded.
    #[inline]
    pub(in crate::axis) fn note_exceeded(&mut self, cycle: u64) -> u64 {
        *self.exceeded_since.get_or_insert(cycle)
    }

    /// Returns the number of successive checks with an exceeded following error.
    #[inline]
    pub(in crate::axis) fn exceeded_times(&self) -> u64 {
        self.exceeded_times
    }

    /// Counts a check of the following error.
    #[inline]
    pub(in crate::axis) fn count_check(&mut self, is_within: bool) {
        self.exceeded_times = if is_within { 0 } else { self.exceeded_times.saturating_add(1) };
    }

    /// Returns the cycle in which a following error was last reported.
    #[inline]
    pub(in crate::axis) fn reported_at(&self) -> Option<u64> {
        self.told
    }

    /// Notes that a following error is reported in that cycle.
    #[inline]
    pub(in crate::axis) fn note_report(&mut self, cycle: u64) {
        self.told = Some(cycle);
    }

    /// Returns the cycle since which the actual position has been within the target window; the present one at first.
    #[inline]
    pub(in crate::axis) fn inside_since(&mut self, cycle: u64) -> u64 {
        *self.inside_since.get_or_insert(cycle)
    }

    /// Returns the last reading in the target window, its cycle first; the present one at first.
    #[inline]
    pub(in crate::axis) fn reading(&mut self, cycle: u64, position: i64) -> (u64, i64) {
        *self.reading.get_or_insert((cycle, position))
    }

    /// Replaces the reading in the target window.
    #[inline]
    pub(in crate::axis) fn read_again(&mut self, cycle: u64, position: i64) {
        self.reading = Some((cycle, position));
    }

    /// Returns the cycle since which a goal waits for its target window, the present one at first; none after the wait
    /// was reported.
    #[inline]
    pub(in crate::axis) fn waits_since(&mut self, cycle: u64) -> Option<u64> {
        Some(*self.waits_since.get_or_insert(cycle)).filter(|since| *since != LONG_WAIT_REPORTED)
    }

    /// Notes that the wait for the target window was reported.
    #[inline]
    pub(in crate::axis) fn note_long_wait(&mut self) {
        self.waits_since = Some(LONG_WAIT_REPORTED);
    }

    /// Whether the axis is at rest at the target and has been within the window for long enough.
    #[inline]
    pub(in crate::axis) fn is_in_position(&self) -> bool {
        self.in_position
    }

    #[inline]
    pub(in crate::axis) fn set_in_position(&mut self, in_position: bool) {
        self.in_position = in_position;
    }

    /// Clears the state of a rest.
    #[inline]
    pub(in crate::axis) fn leave_rest(&mut self) {
        self.leave_window();
        self.waits_since = None;
        self.in_position = false;
    }

    /// Returns the cycle in which motion of the encoder was last detected.
    #[inline]
    pub(in crate::axis) fn drifted(&self) -> Option<u64> {
        self.drifted
    }

    /// Returns the error reaction that waits for the end of a stop; below 0 for none.
    #[inline]
    pub(in crate::axis) fn after_stop(&self) -> i64 {
        self.after_stop
    }

    /// Lets an error reaction wait for the end of a stop; below 0: none.
    #[inline]
    pub(in crate::axis) fn react_after_stop(&mut self, reaction: i64) {
        self.after_stop = reaction;
    }

    /// Returns the error reaction that waits for the end of a stop, and ends its wait.
    #[inline]
    pub(in crate::axis) fn take_after_stop(&mut self) -> i64 {
        std::mem::replace(&mut self.after_stop, -1)
    }

    /// Returns the end of the last goal before rounding to whole increments.
    #[inline]
    pub(in crate::axis) fn rested_at(&self) -> Option<Position> {
        self.rested_at
    }

    /// Sets the end of a goal that is done, before rounding to whole increments.
    #[inline]
    pub(in crate::axis) fn rest_at(&mut self, end: Option<Position>) {
        self.rested_at = end;
    }

    /// Notes that the end of the last goal no longer counts.
    #[inline]
    pub(in crate::axis) fn forget_rest(&mut self) {
        self.rested_at = None;
    }
}

/// Returns the distance by which an encoder at rest may jitter or creep with these parameters.
pub(in crate::axis) fn slack_of(p: &AxisParameters) -> Position {
    Position::from_f64((p.max_velocity / 1000.0 * STILL_NS as f64 / 1e9).max(2.0))
}

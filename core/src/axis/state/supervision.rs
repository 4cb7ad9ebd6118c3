//! State of the supervision of an axis: following error, target window, drift of the encoder.

use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::regulator::{PAST, past};
use serde::{Deserialize, Serialize};

/// Time without motion after which an encoder is at rest (ns).
pub(in crate::axis) const STILL_NS: u64 = 5_000_000;

/// Value of [`Supervision::waits_since`] after the wait was reported.
pub(in crate::axis) const LONG_WAIT_REPORTED: u64 = u64::MAX;

/// State of the supervision of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct Supervision {
    /// Length of the ring: the delay of the drive in cycles, plus one.
    length: usize,
    place: usize,
    /// Command to which the actual position of this cycle responds, minus that actual position (inc).
    pub following_error: i64,
    pub(in crate::axis) exceeded_since: Option<u64>,
    /// Round robin: number of successive checks with an exceeded following error.
    pub(in crate::axis) exceeded_times: u64,
    /// Cycle in which a following error was last reported.
    pub(in crate::axis) told: Option<u64>,
    pub(in crate::axis) inside_since: Option<u64>,
    /// In the target window: the actual position, and the cycle in which it was read.
    pub(in crate::axis) reading: Option<(u64, i64)>,
    /// Cycle since which a goal waits for its target window; [`LONG_WAIT_REPORTED`] after that was reported.
    pub(in crate::axis) waits_since: Option<u64>,
    /// Whether the axis is at rest at the target and has been within the window for long enough.
    pub in_position: bool,
    /// Travel of the encoder since motion was last detected.
    drift: Position,
    /// Cycle in which motion was last detected.
    pub(in crate::axis) drifted: Option<u64>,
    /// Error reaction that waits for the end of a stop; below 0 for none.
    pub after_stop: i64,
    /// End of the last goal before rounding to whole increments.
    pub rested_at: Option<Position>,
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
    fn oldest(&self) -> usize {
        if self.place + 1 < self.length { self.place + 1 } else { 0 }
    }

    /// Returns the command to which the actual position of this cycle responds.
    pub(in crate::axis) fn answered_command(&self) -> i64 {
        self.past.get(self.oldest()).copied().unwrap_or_default()
    }

    /// Stores the same command for another cycle.
    pub(in crate::axis) fn pass(&mut self) {
        self.place = self.oldest();
    }

    /// Whether a reaction waits until the axis is at rest.
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
}

/// Returns the distance by which an encoder at rest may jitter or creep with these parameters.
pub(in crate::axis) fn slack_of(p: &AxisParameters) -> Position {
    Position::from_f64((p.max_velocity / 1000.0 * STILL_NS as f64 / 1e9).max(2.0))
}

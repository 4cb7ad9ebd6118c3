//! An active superimposed motion.

use super::planned_motion::ROUNDING;
use crate::code::Code;
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan};
use serde::{Deserialize, Serialize};

/// An active superimposed motion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Overlay {
    /// Number of its command.
    pub sequence: u64,
    pub(in crate::axis) plan: Plan,
    pub(in crate::axis) start: u64,
    pub(in crate::axis) limits: Limits,
    /// End of its distance, counted from the start of the first superimposed motion.
    pub(in crate::axis) end: Position,
    /// Its whole distance.
    pub(in crate::axis) whole: Position,
    /// The override of its plan (%).
    pub(in crate::axis) share: f64,
    /// Its motion in the last cycle.
    pub shown: Motion,
    pub(in crate::axis) ending: Option<Code>,
}

impl Overlay {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.plan.is_sound() && self.limits.is_sound() && self.shown.is_sound() && self.share.is_finite()
    }

    /// Returns lowest and highest remaining distance until its end.
    pub(in crate::axis) fn ahead(&self) -> (Position, Position) {
        let now = self.shown.position;
        let (low, high) = self.plan.extent_from(now);
        (low.min(self.end).min(now) - now, high.max(self.end).max(now) - now)
    }

    /// Returns the remaining share of its distance; 0 for one that stops.
    pub(in crate::axis) fn share_left(&self) -> f64 {
        let left = self.end - self.shown.position;
        if self.ending.is_some() || self.whole == Position::ZERO { 0.0 } else { left.to_f64() / self.whole.to_f64() }
    }

    /// Returns the direction of the remaining distance if the motion does not turn back: up is true.
    pub(in crate::axis) fn remaining_direction(&self) -> Option<bool> {
        let (low, high) = self.ahead();
        single_direction((low, high), self.end - self.shown.position)
    }

    /// Returns it planned again from this cycle on with another share of its velocity (%); with 0 it holds.
    pub(in crate::axis) fn planned(self, cycle: u64, share: f64, cycle_ns: u64) -> Self {
        let plan = plan(self.shown, self.end, &self.limits, share, cycle_ns);
        Self { plan, start: cycle, share, ..self }
    }
}

/// Returns the direction to an end if the lowest and the highest position are not beyond start and end: up is true.
pub(in crate::axis) fn single_direction((low, high): (Position, Position), end: Position) -> Option<bool> {
    let rounding = Position::from_f64(ROUNDING);
    let is_straight = low >= end.min(Position::ZERO) - rounding && high <= end.max(Position::ZERO) + rounding;
    (is_straight && end != Position::ZERO).then_some(end > Position::ZERO)
}

/// Returns a plan from `shown` to `end` with a share of the velocity (%); with 0 it holds.
pub(in crate::axis) fn plan(shown: Motion, end: Position, limits: &Limits, share: f64, cycle_ns: u64) -> Plan {
    let velocity = limits.velocity * (share / 100.0);
    if velocity > 0.0 {
        profile::to_rest(shown, end, &Limits { velocity, ..*limits }, cycle_ns)
    } else {
        profile::stop(shown, limits, cycle_ns)
    }
}

//! A planned motion: a profile that began in a cycle, with its aim and its limits.

use crate::position::Position;
use crate::profile::{Jerks, Limits, Motion, Plan, Shape};
use serde::{Deserialize, Serialize};

/// Cycles after which a motion of constant velocity is planned again from its present position, so that f64 stays exact
/// enough.
const REBASE_CYCLES: u64 = 1 << 20;

/// Distance by which the rounding of a plan may exceed a position (inc).
pub(in crate::axis) const ROUNDING: f64 = 1e-3;

/// The aim of a course.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) enum Aim {
    /// To this whole increment.
    Target(Position),
    /// Endless at this velocity (inc/s), not 0.
    Velocity(f64),
    /// To rest, at any position.
    Stop,
}

impl Aim {
    /// Returns the aim for a velocity; 0 stops.
    pub(in crate::axis) fn velocity(velocity: f64) -> Self {
        if velocity == 0.0 { Self::Stop } else { Self::Velocity(velocity) }
    }
}

/// A profile that started in a cycle.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct PlannedMotion {
    plan: Plan,
    /// Cycle in which the plan begins.
    start: u64,
    /// Shift by superimposed motions.
    shift: Position,
    /// End of the last step of a stop in whole steps, and whether the motion goes up there.
    bound: Option<(Position, bool)>,
    /// Aim of the course.
    pub aim: Aim,
    /// Limits of the request; the plan may use less of the velocity (override).
    pub limits: Limits,
    /// Velocity (inc/s) with which the next goal takes over at the target; 0: it ends at rest.
    pub pass: f64,
}

impl PlannedMotion {
    pub(in crate::axis) fn new(plan: Plan, start: u64, aim: Aim, limits: Limits) -> Self {
        Self { plan, start, shift: Position::ZERO, bound: None, aim, limits, pass: 0.0 }
    }

    /// Limits the positions of each cycle to `bound`; the plan may exceed it within a cycle.
    pub(in crate::axis) fn within(self, bound: Option<(Position, bool)>) -> Self {
        Self { bound, ..self }
    }

    /// Returns a position of the plan within the bound.
    fn bounded(&self, place: Position) -> Position {
        match self.bound {
            Some((bound, true)) => place.min(bound),
            Some((bound, false)) => place.max(bound),
            None => place,
        }
    }

    /// Sets the velocity (inc/s) with which the next goal takes over at the target.
    pub(in crate::axis) fn passing(self, pass: f64) -> Self {
        Self { pass, ..self }
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        let aim = match self.aim {
            Aim::Velocity(velocity) => velocity.is_finite(),
            Aim::Target(_) | Aim::Stop => true,
        };
        self.plan.is_sound() && self.limits.is_sound() && aim && self.pass.is_finite()
    }

    /// Returns the motion of a cycle.
    #[inline]
    pub(in crate::axis) fn at(&self, cycle: u64) -> Motion {
        let motion = self.plan.at(cycle.saturating_sub(self.start));
        let place = motion.position + self.shift;
        if self.bound.is_none() {
            return Motion { position: place, ..motion };
        }
        let position = self.bounded(place);
        if position == place { Motion { position, ..motion } } else { Motion::at_rest(position) }
    }

    /// Returns the motion of a cycle in which the course neither ends nor changes.
    #[inline]
    pub(in crate::axis) fn continued(&self, cycle: u64) -> Option<Motion> {
        // Velocity reached and kept.
        let stays = || matches!(self.aim, Aim::Velocity(_)) && self.end_velocity() != 0.0 && !self.is_old(cycle);
        let goes_on = self.bound.is_none() && (!self.has_ended(cycle) || stays());
        goes_on.then(|| self.at(cycle))
    }

    /// Whether each cycle is checked against the limits. A course that ends at rest was checked as a whole, and one
    /// that passes its target was checked together with the next goal.
    #[inline]
    pub(in crate::axis) fn needs_limit_check(&self) -> bool {
        self.end_velocity() != 0.0 && self.pass == 0.0
    }

    /// Whether the plan has ended.
    #[inline]
    pub(in crate::axis) fn has_ended(&self, cycle: u64) -> bool {
        cycle.saturating_sub(self.start) >= self.plan.cycles()
    }

    /// Returns the time since the end of the plan (s).
    pub(in crate::axis) fn overshoot(&self, cycle: u64) -> f64 {
        self.plan.overshoot(cycle.saturating_sub(self.start))
    }

    /// Returns the end position of the plan.
    pub(in crate::axis) fn end(&self) -> Position {
        self.bounded(self.plan.end() + self.shift)
    }

    /// Returns the velocity at the end of the plan (inc/s).
    pub(in crate::axis) fn end_velocity(&self) -> f64 {
        self.plan.end_velocity()
    }

    /// Moves the start of the plan by `lead` (s) before the cycle in which the course starts.
    pub(in crate::axis) fn with_lead(self, lead: f64) -> Self {
        Self { plan: self.plan.with_lead(lead), ..self }
    }

    /// Moves the start to one cycle earlier.
    pub(in crate::axis) fn begin_earlier(&mut self) {
        self.start = self.start.saturating_sub(1);
    }

    /// Moves the whole course.
    pub(in crate::axis) fn shift(&mut self, by: Position) {
        self.shift += by;
        self.bound = self.bound.map(|(bound, up)| (bound + by, up));
        if let Aim::Target(target) = &mut self.aim {
            *target += by;
        }
    }

    /// Whether the course waits at rest for an override above 0.
    pub(in crate::axis) fn is_held(&self) -> bool {
        let ends_at_rest = self.end_velocity() == 0.0;
        match self.aim {
            Aim::Target(target) => ends_at_rest && self.end() != target,
            Aim::Velocity(_) => ends_at_rest,
            Aim::Stop => false,
        }
    }

    /// Whether `next`, from `now`, passes positions that this course does not pass.
    pub(in crate::axis) fn passes_further(&self, next: &Self, now: Position) -> bool {
        let (low, high) = self.extent_from(now);
        let (next_low, next_high) = next.extent_from(now);
        let rounding = Position::from_f64(ROUNDING);
        next_low < low - rounding || next_high > high + rounding
    }

    /// Whether the constant velocity has lasted so long that it should be planned again from its present position.
    pub(in crate::axis) fn is_old(&self, cycle: u64) -> bool {
        cycle.saturating_sub(self.start) > self.plan.cycles().saturating_add(REBASE_CYCLES)
    }

    /// Returns lowest and highest position from `now` to the end.
    pub(in crate::axis) fn extent_from(&self, now: Position) -> (Position, Position) {
        let (low, high) = self.plan.extent_from(now - self.shift);
        (self.bounded(low + self.shift), self.bounded(high + self.shift))
    }
}

/// Returns the same limits, but with a higher jerk if the acceleration of `from` would otherwise end beyond `most`
/// (inc/s).
pub(in crate::axis) fn raise_jerk(from: Motion, limits: Limits, most: f64) -> Limits {
    let Shape::Jerk(jerks) = limits.shape else { return limits };
    let room = most - from.velocity.abs();
    if from.velocity * from.acceleration <= 0.0 || room <= 0.0 {
        return limits;
    }
    let least = from.acceleration * from.acceleration / (2.0 * room);
    Limits { shape: Shape::Jerk(Jerks { fall: jerks.fall.max(least), ..jerks }), ..limits }
}

//! A course is an active planned motion: its profile, its aim and its limits.

use crate::axis::state::planned_motion::raise_jerk;
use crate::axis::state::{Aim, Axis, Context, Generator, PlannedMotion};
use crate::position::Position;
use crate::profile::{self, Limits, Motion};

impl Axis {
    /// Returns the highest velocity that the override allows (inc/s).
    pub(in crate::axis) fn override_velocity(&self) -> f64 {
        let share = self.parameters.velocity_override / 100.0;
        // Limits of goals were checked against the maximum at that time, so an override of 100 % does not limit them
        // again.
        if share < 1.0 { self.velocity_for_base() * share } else { f64::INFINITY }
    }

    /// Returns a course from `from` within the override.
    pub(in crate::axis) fn course(&self, cycle: u64, from: Motion, aim: Aim, limits: Limits) -> PlannedMotion {
        let usable = self.with_raised_jerk(from, limits);
        let cap = self.override_velocity();
        let capped = Limits { velocity: limits.velocity.min(cap), ..usable };
        let cycle_ns = self.setup.cycle_ns;
        let plan = match aim {
            Aim::Stop => self.plan_stop(from, &usable),
            _ if cap <= 0.0 => self.plan_stop(from, &usable),
            Aim::Target(target) => profile::to_rest(from, target, &capped, cycle_ns),
            Aim::Velocity(velocity) => profile::to_velocity(from, velocity.clamp(-cap, cap), &capped, cycle_ns),
        };
        PlannedMotion::new(plan, cycle, aim, limits)
    }

    /// Returns the same limits, but with a higher jerk if the present acceleration would otherwise end beyond
    /// max_velocity. A goal with less jerk than the motion before it must not drive the axis too fast.
    pub(in crate::axis) fn with_raised_jerk(&self, from: Motion, limits: Limits) -> Limits {
        raise_jerk(from, limits, self.velocity_for_base())
    }

    /// Returns the end of the active motion. None: no end or no motion.
    pub(in crate::axis) fn course_end(&self) -> Option<Position> {
        if let Some(goal) = self.task.goal().as_ref().filter(|goal| goal.track.is_some()) {
            return goal.target;
        }
        let Generator::Plan(course) = self.motion.generator() else { return None };
        match course.aim {
            Aim::Target(target) => Some(target),
            Aim::Stop => Some(course.end()),
            Aim::Velocity(_) => None,
        }
    }

    /// Plans the active motion again after a change of the override.
    pub(in crate::axis) fn follow_override(&mut self, cx: &mut Context<'_>) {
        let share = self.parameters.velocity_override;
        self.override_overlay(cx.cycle);
        if self.observed.override_seen() == share {
            return;
        }
        if let Generator::Plan(course) = *self.motion.generator()
            && course.aim != Aim::Stop
        {
            let mut next = self.course_for(cx.cycle, course.aim, course.limits);
            // A goal that was to pass its target may have to slow down more than its own deceleration allows.
            if self.check_course(&next, self.base(), course.limits).is_err() {
                let largest = self.parameters.largest_limits();
                let limits = Limits { velocity: course.limits.velocity, ..largest };
                next = self.course_for(cx.cycle, course.aim, limits);
            }
            // An S-ramp first reduces its acceleration to 0, and so might pass the target. Then the old plan, which
            // already slows down, is kept, and the change is tried again in the next cycle. The same applies to a goal
            // that passes its target into the next goal without enough distance to slow down before.
            let (now, here) = (self.base(), self.command.position());
            let brakes = now.velocity * now.acceleration < 0.0 && now.velocity.abs() <= self.override_velocity();
            let keeps = course.pass != 0.0 || brakes && course.end_velocity() == 0.0;
            let turns = keeps && course.passes_further(&next, here);
            let ((low, high), (down, up)) = (next.extent_from(here), self.overlay_ahead());
            // A motion without end is checked in each cycle.
            let fits = next.end_velocity() != 0.0 || self.check_range(low + down, high + up).is_ok();
            if turns || !fits || self.check_course(&next, now, course.limits).is_err() {
                return;
            }
            self.motion.plan(next);
        }
        self.observed.set_override_seen(share);
    }

    /// Plans the active motion again from the present motion.
    pub(in crate::axis) fn replan(&mut self, cx: &mut Context<'_>, aim: Aim, limits: Limits) {
        self.motion.plan(self.course_for(cx.cycle, aim, limits));
    }

    fn course_for(&self, cycle: u64, aim: Aim, limits: Limits) -> PlannedMotion {
        let from = self.base();
        match aim {
            Aim::Target(target) => self.course_to(cycle, from, target, limits),
            _ => self.course(cycle, from, aim, limits),
        }
    }
}

//! Whether an axis may move backward (REVERS).
//!
//! Reads    REVERS, the leader of a coupling
//! Refuses  backward motion that REVERS does not allow
//! Source   MACS-DIR-01..10, A-09

use crate::axis::state::planned_motion::ROUNDING;
use crate::axis::state::{Aim, Axis, Context, Generator, Overlay, PlannedMotion};
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::parameter::ReversingRule;
use crate::position::Position;
use crate::profile::{self, Motion};

impl Axis {
    /// Whether a motion without master may go backward.
    pub(in crate::axis) fn reverses_alone(&self) -> bool {
        self.parameters.reversing().rule == ReversingRule::Always
    }

    /// Whether the axis may move backward in this cycle.
    fn may_reverse(&self) -> bool {
        match self.parameters.reversing().rule {
            ReversingRule::Always => true,
            ReversingRule::WithMaster => self.coupling().is_some_and(|coupling| coupling.follower.leader_reverses()),
            ReversingRule::Never => false,
        }
    }

    fn backwards(&self, asked: Number) -> Refusal {
        Refusal::new(Code::REVERSE_FORBIDDEN, self.object()).with(asked, Number::None)
    }

    /// Checks that a velocity is forward if REVERS requires that.
    pub(in crate::axis) fn check_forward(&self, velocity: f64) -> Result<(), Refusal> {
        let good = velocity >= 0.0 || self.reverses_alone();
        if good { Ok(()) } else { Err(self.backwards(Number::Velocity(velocity))) }
    }

    /// Checks that a course is forward throughout if REVERS requires that. An axis that already moves backward (with
    /// its master) first has to stop.
    pub(in crate::axis) fn check_course_forward(&self, course: &PlannedMotion, from: Motion) -> Result<(), Refusal> {
        if self.reverses_alone() {
            return Ok(());
        }
        let start = if from.velocity < 0.0 {
            profile::stop(from, &self.stop_limits(), self.setup.cycle_ns).end()
        } else {
            from.position
        };
        let rounding = Position::from_f64(ROUNDING);
        let (lowest, highest) = course.extent_from(from.position);
        match course.aim {
            // The target is behind the start, or is passed and approached again backward.
            Aim::Target(target) if lowest.min(target) < start - rounding || highest > course.end() + rounding => {
                Err(self.backwards(Number::Position(target.nearest())))
            }
            Aim::Velocity(velocity) => self.check_forward(velocity),
            _ => Ok(()),
        }
    }

    /// Checks that a waiting goal does not end behind the goal before it.
    pub(in crate::axis) fn check_end_forward(&self, before: Option<Position>, end: Position) -> Result<(), Refusal> {
        let behind = before.is_some_and(|before| Position::whole(end.nearest()) < Position::whole(before.nearest()));
        if behind && !self.reverses_alone() {
            return Err(self.backwards(Number::Position(end.nearest())));
        }
        Ok(())
    }

    /// Checks that a superimposed motion is forward if REVERS requires that.
    pub(super) fn check_overlay_forward(&self, overlay: &Overlay) -> Result<(), Refusal> {
        let (down, _) = overlay.ahead();
        if down < -Position::from_f64(ROUNDING) && !self.reverses_alone() {
            return Err(self.backwards(Number::Position(down.nearest())));
        }
        Ok(())
    }

    /// Returns the motion of this cycle without a negative velocity if REVERS forbids that: the axis stops
    /// instead of turning back, and continues from there if its target is ahead.
    pub(super) fn forward(&mut self, cx: &mut Context<'_>, next: Motion) -> Motion {
        // An axis that moves backward with its master may still slow down.
        if next.velocity >= 0.0 || self.command.velocity() < 0.0 || self.may_reverse() {
            return next;
        }
        let here = self.resting(self.command.position());
        if let Generator::Plan(course) = *self.motion.generator() {
            let goes_on = match course.aim {
                Aim::Target(target) => target >= here.position,
                Aim::Velocity(velocity) => velocity > 0.0,
                Aim::Stop => false,
            };
            if goes_on {
                self.motion.plan(self.course(cx.cycle, here, course.aim, course.limits));
            } else {
                // Homing ends with the reference that it has found, wherever the axis stops.
                if course.aim != Aim::Stop && !self.homing.is_running() {
                    self.end_goal(cx, Code::REVERSE_FORBIDDEN);
                    self.end_waiting_goals(cx, here.position);
                }
                self.motion.rest();
            }
        }
        here
    }
}

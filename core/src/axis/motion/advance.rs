//! The motion of an axis in a cycle.

use crate::axis::state::{Aim, Axis, Context, Generator, PlannedMotion};
use crate::code::Code;
use crate::profile::{self, Limits, Motion, Shape};
use crate::state::{AxisState, Reference};

impl Axis {
    /// Advances the command position to this cycle.
    pub(in crate::axis) fn advance(&mut self, cx: &mut Context<'_>) {
        if !self.is_on() {
            self.command.rest_at(self.feedback.position());
            self.motion.rest();
            self.status.set_led(false);
            return;
        }
        if self.is_open_loop() {
            return self.advance_open(cx);
        }
        if let Some((value, level)) = self.out_an() {
            return self.advance_out_an(cx, value, level);
        }
        if self.homing.is_in_drive() {
            return self.follow_drive();
        }
        self.start_waiting_track(cx);
        self.advance_command(cx);
    }

    /// Advances the command of an axis that is on by its generator.
    fn advance_command(&mut self, cx: &mut Context<'_>) {
        self.status.set_led(matches!(*self.motion.generator(), Generator::Follow(_)));
        let base = match self.motion.generator() {
            Generator::Rest | Generator::Open { .. } | Generator::OutAn { .. } | Generator::Coast { .. } => {
                Some(Motion::at_rest(self.command.position()))
            }
            // The usual case.
            Generator::Plan(course) if !course.has_ended(cx.cycle) => {
                let next = course.at(cx.cycle);
                return self.execute_within_limits(cx, next);
            }
            Generator::Plan(_) => Some(self.step_plan(cx)),
            Generator::Follow(_) => self.follow(cx),
            Generator::Track(_) => self.follow_track(cx),
        };
        // Without a motion the axis already stops.
        if let Some(base) = base {
            self.execute_within_limits(cx, base);
        } else {
            self.note_direction();
        }
    }

    /// Notes the direction of motion, for direction CURRENT.
    #[inline]
    pub(in crate::axis) fn note_direction(&mut self) {
        self.travel.note_direction(self.command.velocity());
    }

    /// Executes the motion of this cycle within the limits.
    #[inline]
    fn execute_within_limits(&mut self, cx: &mut Context<'_>, base: Motion) {
        let mut next = base;
        if self.coupling.overlay().is_some() {
            next = self.superimpose(cx, base);
        }
        let is_added = next.position != base.position;
        if next.velocity < 0.0 || next.velocity.is_nan() {
            next = self.forward(cx, next);
        }
        // A limit that stops the axis sets the command itself.
        let meets_switch =
            self.observed.switches().positive || self.observed.switches().negative || self.homing.is_ending();
        if meets_switch && self.stop_at_switch(cx, next) || self.stop_at_limit(cx, next, is_added) {
            return self.note_direction();
        }
        let is_planned = matches!(*self.motion.generator(), Generator::Plan(_)) && !is_added;
        if is_planned && !self.is_within_limits(next.position) {
            next = self.rounded(next);
        }
        self.command.execute(next);
        self.note_direction();
    }

    /// Returns the motion of this cycle from the active course; at its end the next motion begins.
    fn step_plan(&mut self, cx: &mut Context<'_>) -> Motion {
        let Generator::Plan(course) = self.motion.generator() else { return self.command.motion() };
        let next = course.at(cx.cycle);
        if !course.has_ended(cx.cycle) {
            return next;
        }
        if course.end_velocity() == 0.0 {
            // A stop may end between two increments. Its drive has the lower one in any case: resting there moves
            // nothing, and every axis at rest is at a whole increment.
            if !course.is_held() {
                self.motion.rest();
            }
            // A superimposed motion continues from the present position.
            return if self.coupling.overlay().is_some() {
                Motion::at_rest(next.position)
            } else {
                self.resting(next.position)
            };
        }
        match course.aim {
            Aim::Target(_) => self.pass_target(cx, next),
            _ if course.is_old(cx.cycle) => {
                let (aim, limits) = (course.aim, course.limits);
                let plan = profile::to_velocity(next, next.velocity, &limits, self.setup.cycle_ns);
                self.motion.plan(PlannedMotion::new(plan, cx.cycle, aim, limits));
                next
            }
            _ => next,
        }
    }

    /// Handles a target that is passed, or the position before it at which the acceleration to the passing velocity
    /// begins.
    fn pass_target(&mut self, cx: &mut Context<'_>, next: Motion) -> Motion {
        let Generator::Plan(course) = *self.motion.generator() else { return next };
        let lead = course.overshoot(cx.cycle);
        let from = Motion { velocity: course.end_velocity(), ..Motion::at_rest(course.end()) };
        if course.end_velocity() != course.pass {
            let plan = profile::to_velocity(from, course.pass, &course.limits, self.setup.cycle_ns);
            let speeding = PlannedMotion::new(plan, cx.cycle, course.aim, course.limits).passing(course.pass);
            self.motion.plan(speeding.with_lead(lead));
        } else if self.pending.buffer().is_empty() {
            // Its next goal was cancelled: it ends at its own target.
            self.replan_from(cx, from, lead);
        } else {
            let before = self.task.goal().and_then(|goal| goal.target);
            self.end_goal(cx, Code::NONE);
            self.begin_next(cx, from, lead, before);
        }
        match self.motion.generator() {
            Generator::Plan(course) => course.at(cx.cycle),
            _ => next,
        }
    }

    fn replan_from(&mut self, cx: &mut Context<'_>, from: Motion, lead: f64) {
        if let Generator::Plan(course) = *self.motion.generator() {
            let course = self.course(cx.cycle, from, course.aim, course.limits);
            self.motion.plan(course.with_lead(lead));
        }
    }

    /// Returns the motion of this cycle as the start of the next profile. The acceleration of a coupling comes from the
    /// counts of its leader: no profile continues with it.
    pub(in crate::axis) fn present_motion(&self) -> Motion {
        if self.status.is_led() {
            Motion { acceleration: 0.0, jerk: 0.0, ..self.command.motion() }
        } else {
            self.command.motion()
        }
    }

    /// Stops from the present motion; at rest the command stays at the increment that the drive already has.
    pub(in crate::axis) fn brake_to_rest(&mut self, cx: &mut Context<'_>, limits: &Limits) {
        if self.is_open_loop() {
            return self.switch_speed_off(cx);
        }
        if self.out_an().is_some() {
            return self.let_drive_stop(cx);
        }
        self.status.end_reference();
        if matches!(
            self.status.state(),
            AxisState::ContinuousMotion | AxisState::SynchronizedMotion | AxisState::Homing
        ) {
            self.set_state(cx, AxisState::DiscreteMotion);
        }
        let present = self.present_motion();
        if present.velocity == 0.0 && (present.acceleration == 0.0 || limits.shape == Shape::Trapezoid) {
            self.command.execute(self.resting(self.command.position()));
            self.motion.rest();
            return;
        }
        let course = self.course(cx.cycle, present, Aim::Stop, *limits);
        self.motion.plan(course);
    }

    /// Begins a motion: state, reference and generator change together.
    pub(in crate::axis) fn begin_motion(
        &mut self,
        cx: &mut Context<'_>,
        state: AxisState,
        reference: Reference,
        generator: Generator,
    ) {
        self.status.refer_to(reference);
        self.motion.begin(generator);
        if reference != Reference::Function {
            self.task.leave_function();
        }
        self.set_state(cx, state);
    }

    /// Returns the limits of the active motion.
    pub(in crate::axis) fn active_limits(&self) -> Limits {
        match self.motion.generator() {
            Generator::Plan(course) => course.limits,
            _ => self.parameters.default_goal_limits(),
        }
    }
}

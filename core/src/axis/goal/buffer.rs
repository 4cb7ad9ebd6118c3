//! Buffered and blended goals (PLCopen buffer modes).
//!
//! Law      BUFFERED: the next goal begins when the active goal is done. BLENDING: the active goal passes its target
//!          without a stop, with the lower, its own, the next or the higher velocity. The next goal begins there, also
//!          between two cycles. If the goals have different directions, or a distance is too short, the axis passes the
//!          target as fast as both goals allow without turning back; if necessary it stops there
//! Refuses  too many goals, a goal after a coupling

use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::planned_motion::ROUNDING;
use crate::axis::state::{Aim, Axis, Context, Generator, Goal, Next, PlannedMotion};
use crate::code::Code;
use crate::command::{BufferMode, Move, MoveMode};
use crate::event::{Event, Refusal};
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan, Shape};
use crate::state::AxisState;

/// Number of bisections in the search for the velocity at a target, which gives it to a thousandth.
const HALVINGS: u32 = 10;

impl Axis {
    /// Appends a goal to the waiting goals.
    ///
    /// # Errors
    /// There is no room; the goal before it has no end; its target is not allowed.
    pub(super) fn wait_in_buffer(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Move,
        limits: Limits,
    ) -> Result<(), Refusal> {
        if matches!(*self.motion.generator(), Generator::Follow(_)) {
            return Err(Refusal::new(Code::NOTHING_TO_WAIT_FOR, self.object()));
        }
        let next = Next { sequence, request: *request, limits };
        let before = self.waiting_ends().last().unwrap_or(self.known_end());
        let end = self.end_of(&next, before);
        self.check_with_overlay(&limits, before.zip(end).map(|(before, end)| end >= before))?;
        if request.mode == MoveMode::Velocity {
            self.check_forward(request.velocity)?;
        }
        if let Some(end) = end {
            self.check_end_forward(before, end)?;
            self.check_target(end, &self.parameters)?;
            let (down, up) = self.overlay_ahead();
            self.check_range(end + down, end + up)?;
        }
        if !self.pending.buffer_mut().push(next) {
            return Err(Refusal::new(Code::TOO_MANY_WAITING, self.object()));
        }
        self.accepted(cx, sequence);
        // The first waiting goal may change how the active goal ends.
        if let (Generator::Plan(course), true) = (self.motion.generator(), self.pending.buffer().iter().count() == 1)
            && let (Aim::Target(target), limits) = (course.aim, course.limits)
            && self.task.goal().is_none_or(|goal| goal.ending.is_none())
        {
            let course = self.course_to(cx.cycle, self.base(), target, limits);
            if course.pass != 0.0 {
                self.motion.plan(course);
            }
        }
        Ok(())
    }

    /// Returns the end of a goal before rounding, after a goal that ends at `before`. None: not known yet.
    fn end_of(&self, next: &Next, before: Option<Position>) -> Option<Position> {
        match (next.request.mode, before) {
            (MoveMode::Velocity, _) => None,
            (_, Some(end)) => Some(self.target(&next.request, next.limits, Motion::at_rest(end), Some(end))),
            (MoveMode::Absolute, None) if self.setup.modulo.is_none() => Some(next.request.target.exact()),
            _ => None,
        }
    }

    /// Returns the end of the active goal before rounding. None: it searches, or has no end.
    fn known_end(&self) -> Option<Position> {
        self.task.goal().filter(|_| !self.searches()).and_then(|goal| goal.target)
    }

    /// Returns the end of each waiting goal.
    pub(in crate::axis) fn waiting_ends(&self) -> impl Iterator<Item = Option<Position>> {
        let first = self.known_end();
        self.pending.buffer().iter().scan(first, |before, next| {
            *before = self.end_of(next, *before);
            Some(*before)
        })
    }

    /// Removes a goal from the buffer. The active goal may then need another end.
    pub(super) fn cancel_waiting(&mut self, cx: &mut Context<'_>, sequence: u64) -> bool {
        let was_first = self.pending.buffer().first().is_some_and(|next| next.sequence == sequence);
        let removed = self.pending.buffer_mut().remove(sequence);
        if removed {
            cx.events.push(Event::done(self.object(), sequence, Code::CANCELLED, self.command.position()));
        }
        if was_first
            && let Generator::Plan(course) = *self.motion.generator()
            && course.pass != 0.0
        {
            // If the deceleration of the goal would pass a limit now, the largest deceleration or a profile without
            // jerk limit may suffice. The goal was planned within them, but a profile with jerk limit first has to
            // reduce the present acceleration.
            let largest = Limits { velocity: course.limits.velocity, ..self.parameters.largest_limits() };
            let constant = Limits { shape: Shape::Trapezoid, ..largest };
            let stays = |limits: &Limits| match course.aim {
                Aim::Target(target) => {
                    self.check_plan_limits(&self.plan_to(self.base(), target, limits), *limits).is_ok()
                }
                _ => true,
            };
            let limits = [course.limits, largest].into_iter().find(stays).unwrap_or(constant);
            self.replan(cx, course.aim, limits);
        }
        removed
    }

    /// Ends the waiting goals, because the goal before them is not reached. `position` is that of their events.
    pub(in crate::axis) fn end_waiting_goals(&mut self, cx: &mut Context<'_>, position: Position) {
        self.pending.buffer_mut().end(cx.events, self.setup.index, Code::NOT_REACHED, position, NO_NUMBERS);
    }

    /// Begins the next goal at `from`, which was `lead` seconds ago, after the end of the goal before.
    pub(in crate::axis) fn begin_next(
        &mut self,
        cx: &mut Context<'_>,
        from: Motion,
        lead: f64,
        before: Option<Position>,
    ) {
        let Some(next) = self.pending.buffer_mut().pop() else { return };
        let exact = before.filter(|exact| Position::whole(exact.nearest()) == from.position);
        let target = match next.request.mode {
            MoveMode::Velocity => None,
            _ => Some(self.target(&next.request, next.limits, from, exact)),
        };
        let result = match target {
            Some(target) => self
                .check_target(target, &self.parameters)
                .map(|()| self.course_to(cx.cycle, from, Position::whole(target.nearest()), next.limits)),
            None => self.check_velocity(next.request.velocity).map(|()| {
                let aim = Aim::velocity(next.request.velocity);
                self.course(cx.cycle, from, aim, next.limits)
            }),
        };
        // The axis may have lost its reference since the goal was accepted.
        let result = self
            .check_zero()
            .and(result)
            .and_then(|course| self.check_course(&course, from, next.limits).map(|()| course));
        match result {
            Ok(course) => {
                let sequence = next.sequence;
                self.task.begin(Goal { sequence, ending: None, target, search: None, track: None, before: None });
                self.supervision.forget_rest();
                let moves_on = matches!(course.aim, Aim::Velocity(_));
                let state = if moves_on { AxisState::ContinuousMotion } else { AxisState::DiscreteMotion };
                let generator = Generator::Plan(course.with_lead(lead));
                self.begin_motion(cx, state, next.request.mode.reference(), generator);
            }
            Err(refusal) => {
                let event = Event::done(self.object(), next.sequence, refusal.code, self.command.position());
                cx.events.push(event.with(refusal.asked, refusal.limit));
                self.end_waiting_goals(cx, self.command.position());
                let plan = self.plan_stop(from, &self.parameters.largest_limits());
                let course = PlannedMotion::new(plan, cx.cycle, Aim::Stop, self.parameters.largest_limits());
                self.motion.plan(course.with_lead(lead));
            }
        }
    }

    /// Ends a velocity goal at its velocity if another goal waits.
    pub(in crate::axis) fn leave_velocity(&mut self, cx: &mut Context<'_>) {
        if let Generator::Plan(course) = self.motion.generator()
            && let Aim::Velocity(_) = course.aim
            && self.task.goal().is_some()
            && !self.pending.buffer().is_empty()
            && course.has_ended(cx.cycle)
            && !course.is_held()
        {
            let now = course.at(cx.cycle);
            self.end_goal(cx, Code::NONE);
            self.begin_next(cx, now, 0.0, None);
        }
    }

    pub(in crate::axis) fn plan_to(&self, from: Motion, target: Position, limits: &Limits) -> Plan {
        profile::to_rest(from, target, limits, self.setup.cycle_ns)
    }

    /// Returns the planned motion to a target, or through it if the next goal requires that.
    pub(in crate::axis) fn course_to(
        &self,
        cycle: u64,
        from: Motion,
        target: Position,
        limits: Limits,
    ) -> PlannedMotion {
        let usable = self.with_raised_jerk(from, limits);
        let cap = self.override_velocity();
        let own = limits.velocity.min(cap);
        let pass = if cap > 0.0 { self.passing_velocity(from, target, &usable, own) } else { 0.0 };
        if pass == 0.0 {
            return self.course(cycle, from, Aim::Target(target), limits);
        }
        let plan = self.plan_passing(from, target, &Limits { velocity: own, ..usable }, pass);
        PlannedMotion::new(plan, cycle, Aim::Target(target), limits).passing(pass)
    }

    /// Returns a plan that passes the target with `pass`, or that ends where the acceleration to `pass` has to begin.
    fn plan_passing(&self, from: Motion, target: Position, limits: &Limits, pass: f64) -> Plan {
        let cycle_ns = self.setup.cycle_ns;
        if pass.abs() <= limits.velocity {
            return profile::to_pass(from, target, pass, limits, cycle_ns);
        }
        let own = limits.velocity.copysign(pass);
        let cruise = Motion { velocity: own, ..Motion::default() };
        let way = profile::to_velocity(cruise, pass, limits, cycle_ns).end();
        profile::to_pass(from, target - way, own, limits, cycle_ns)
    }

    /// Returns the velocity with which the active goal passes its target into the next goal; 0 if it has to stop.
    fn passing_velocity(&self, from: Motion, target: Position, limits: &Limits, own: f64) -> f64 {
        // A search has no end to pass. The axis stops at the position that it found.
        let Some(next) = self.pending.buffer().first().filter(|_| !self.probes()) else { return 0.0 };
        let at_target = Motion::at_rest(target);
        let cap = self.override_velocity();
        let (after, follower) = match next.request.mode {
            MoveMode::Velocity => (None, next.request.velocity),
            _ => {
                let exact = self.task.goal().and_then(|goal| goal.target);
                let exact = exact.filter(|exact| Position::whole(exact.nearest()) == target);
                let end = self.target(&next.request, next.limits, at_target, exact);
                // If the goal before had no end, the end of this goal was unknown when it was accepted. It will be
                // refused there, at rest.
                if self.check_target(end, &self.parameters).is_err() {
                    return 0.0;
                }
                let end = Position::whole(end.nearest());
                (Some(end), (end - target).to_f64())
            }
        };
        let way = (target - from.position).to_f64();
        if way * follower <= 0.0 {
            return 0.0;
        }
        let its_velocity = match after {
            Some(_) => next.limits.velocity.min(cap),
            None => follower.abs().min(cap),
        };
        let wanted = match next.request.buffer_mode {
            BufferMode::Aborting | BufferMode::Buffered => return 0.0,
            BufferMode::BlendingLow => own.min(its_velocity),
            BufferMode::BlendingPrevious => own,
            BufferMode::BlendingNext => its_velocity,
            BufferMode::BlendingHigh => own.max(its_velocity),
        };
        let limits = Limits { velocity: own, ..*limits };
        let next_limits = Limits { velocity: its_velocity, ..next.limits };
        let works = |speed: f64| {
            let pass = speed.copysign(way);
            let plan = self.plan_passing(from, target, &limits, pass);
            let there = Motion { velocity: pass, ..at_target };
            stays_between_ends(&plan, from.position, target, Position::from_f64(ROUNDING))
                && match after {
                    // The end may be at a limit.
                    Some(end) => {
                        stays_between_ends(&self.plan_to(there, end, &next_limits), target, end, Position::ZERO)
                    }
                    None => self.can_stop(there, &next_limits),
                }
        };
        if works(wanted) {
            return wanted.copysign(way);
        }
        let (mut good, mut bad) = (0.0, wanted.min(own));
        if works(bad) {
            return bad.copysign(way);
        }
        for _ in 0..HALVINGS {
            let middle = (good + bad) / 2.0;
            if works(middle) { good = middle } else { bad = middle }
        }
        f64::copysign(good, way)
    }

    /// Whether the axis can stop from that motion before the limit ahead.
    fn can_stop(&self, from: Motion, limits: &Limits) -> bool {
        let up = from.velocity > 0.0;
        let limit = Position::whole(self.limit(up));
        let end = from.position + Position::from_f64(profile::stopping_distance(from, limits));
        if up { end <= limit } else { end >= limit }
    }
}

/// Whether the plan stays between its start and the target, with a tolerance of `rounding`.
fn stays_between_ends(plan: &Plan, from: Position, target: Position, rounding: Position) -> bool {
    let (low, high) = plan.extent();
    low >= from.min(target) - rounding && high <= from.max(target) + rounding
}

//! Positioning and velocity goals, from the command to the generator.

use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::goal::LEAST_RATE;
use crate::axis::state::planned_motion::ROUNDING;
use crate::axis::state::{Aim, Axis, Context, Generator, Goal, Numbers, PlannedMotion, Power};
use crate::code::Code;
use crate::command::{BufferMode, Move, MoveMode};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan};
use crate::state::AxisState;
use crate::vocabulary::Owner;

/// Highest jerk of a goal on an axis without a jerk limit (inc/s^3), and of the rates of an axis: a higher value would
/// exceed the exactness of f64.
const MOST_JERK: f64 = 1e15;

impl Axis {
    /// Ends the active goal now. A cancelled goal ends as cancelled, unless an error ends it.
    pub(in crate::axis) fn end_goal(&mut self, cx: &mut Context<'_>, code: Code) {
        self.end_goal_with(cx, code, NO_NUMBERS);
    }

    fn end_goal_with(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        if let Some(goal) = self.task.take_goal() {
            let taken_over =
                matches!(code, Code::REPLACED | Code::HALTED | Code::QUICK_STOP | Code::DISABLED | Code::ABORTED);
            let code = goal.ending.filter(|_| taken_over).unwrap_or(code);
            if goal.track.is_some() {
                // The machine ends it for all its axes at once.
                self.task.leave_track((goal.sequence, code, numbers));
                return;
            }
            let done = Event::done(self.object(), goal.sequence, code, self.command.position());
            cx.events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Ends everything that moves the axis or waits to move it: goal, superimposed motion, buffer, motion of a
    /// vocabulary.
    pub(in crate::axis) fn end_all_motion(&mut self, cx: &mut Context<'_>, code: Code) {
        self.end_all_motion_with(cx, code, NO_NUMBERS);
    }

    /// As [`end_all_motion`](Self::end_all_motion), with the numbers for the message of the code, which the sender of
    /// the goal reads, too.
    pub(in crate::axis) fn end_all_motion_with(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        self.end_goal_with(cx, code, numbers);
        self.end_overlay(cx, code, numbers);
        self.end_phase(cx, code, numbers);
        self.end_engagement(cx, code, numbers);
        self.end_leaving(cx, code, numbers);
        self.pending.buffer_mut().end(cx.events, self.setup.index, code, self.command.position(), numbers);
        self.status.set_owner(Owner::Native);
        // After power off and on the axis follows its function again.
        if code != Code::DISABLED {
            self.task.leave_function();
        }
        self.homing.stop();
    }

    pub(in crate::axis) fn begin_goal(&mut self, cx: &mut Context<'_>, sequence: u64, target: Option<Position>) {
        self.take_over(cx, sequence, target);
        self.accepted(cx, sequence);
    }

    /// Begins a goal that was accepted before.
    pub(in crate::axis) fn take_over(&mut self, cx: &mut Context<'_>, sequence: u64, target: Option<Position>) {
        self.end_all_motion(cx, Code::REPLACED);
        self.homing.forget_end();
        self.task.begin(Goal { sequence, ending: None, target, search: None, track: None, before: None });
        self.supervision.forget_rest();
    }

    pub(in crate::axis) fn accepted(&self, cx: &mut Context<'_>, sequence: u64) {
        cx.events.push(Event::new(Severity::Info, Kind::Accepted, self.object(), Code::NONE).of_command(sequence));
    }

    pub(in crate::axis) fn refuse(&self, code: Code) -> Refusal {
        Refusal::new(code, self.object())
    }

    /// Returns the refusal of a command that needs an axis at rest, with the state of the axis. No state: it is
    /// stopping.
    pub fn not_at_standstill(&self) -> Refusal {
        let state =
            if self.is_virtual() || self.status.power() == Power::On { Some(self.status.state()) } else { None };
        let number = state.map_or(Number::None, |state| Number::Count(state as i64));
        self.refuse(Code::NOT_AT_STANDSTILL).with(number, Number::None)
    }

    /// Checks that the axis can execute a motion command: it is ready, referenced if required, and not homing.
    pub(in crate::axis) fn check_free(&self) -> Result<(), Refusal> {
        self.check_ready()?;
        self.check_settled()
    }

    /// Checks that the axis is referenced if required, and not homing.
    pub(in crate::axis) fn check_settled(&self) -> Result<(), Refusal> {
        if self.homing.is_running() {
            return Err(self.refuse(Code::HOMING_UNDER_WAY));
        }
        self.check_zero()
    }

    /// Checks that the axis is referenced if homing is required.
    pub(in crate::axis) fn check_zero(&self) -> Result<(), Refusal> {
        let is_missing = self.parameters.homing.required && !self.is_referenced();
        if is_missing { Err(self.refuse(Code::HOMING_REQUIRED)) } else { Ok(()) }
    }

    /// Checks that the axis is on, without error and without lock.
    pub(in crate::axis) fn check_ready(&self) -> Result<(), Refusal> {
        self.check_lock()?;
        match self.status.power() {
            _ if !self.observed.is_active() => Err(self.refuse(Code::NOT_ACTIVE)),
            Power::On => self.check_contacts(),
            _ => Err(self.refuse(Code::NOT_ENABLED)),
        }
    }

    /// Checks that the axis has neither an error nor the lock of a stop.
    pub(in crate::axis) fn check_lock(&self) -> Result<(), Refusal> {
        match self.status.state() {
            AxisState::ErrorStop => Err(self.refuse(Code::IN_ERROR)),
            AxisState::Stopping if self.is_interrupted() => Err(self.refuse(Code::INTERRUPTED)),
            AxisState::Stopping if self.brake.is_aborted() => Err(self.refuse(Code::ABORTED)),
            AxisState::Stopping => Err(self.refuse(Code::QUICK_STOPPED)),
            _ => Ok(()),
        }
    }

    /// Returns a rate of a request, or the default for 0. It must not exceed its maximum.
    pub(in crate::axis) fn check_rate(&self, asked: f64, usual: f64, most: f64, code: Code) -> Result<f64, Refusal> {
        let number = match code {
            Code::VELOCITY_TOO_HIGH => Number::Velocity,
            Code::JERK_TOO_HIGH => Number::Jerk,
            _ => Number::Acceleration,
        };
        if !asked.is_finite() || asked < 0.0 {
            return Err(self.refuse(Code::BAD_NUMBER).with(number(asked), Number::None));
        }
        if asked != 0.0 && asked < LEAST_RATE {
            return Err(self.refuse(Code::RATE_TOO_LOW).with(number(asked), number(LEAST_RATE)));
        }
        if asked > most {
            return Err(self.refuse(code).with(number(asked), number(most)));
        }
        Ok(if asked == 0.0 { usual } else { asked })
    }

    fn check_limits(&self, request: &Move) -> Result<Limits, Refusal> {
        let p = &self.parameters;
        // In mode VELOCITY 0 means 0, and the sign is the direction.
        let (speed, usual) = match request.mode {
            MoveMode::Velocity => (request.velocity.abs(), 0.0),
            _ => (request.velocity, p.default_goal_velocity()),
        };
        let down = p.deceleration_limit();
        let jerk = self.check_rate(request.jerk, 0.0, p.max_jerk.unwrap_or(MOST_JERK), Code::JERK_TOO_HIGH)?;
        let velocity = self.check_rate(speed, usual, p.max_velocity, Code::VELOCITY_TOO_HIGH)?;
        Ok(Limits {
            // A goal to stop has no velocity of its own.
            velocity: if velocity == 0.0 { p.default_goal_velocity() } else { velocity },
            acceleration: self.check_rate(
                request.acceleration,
                p.default_goal_acceleration(),
                p.max_acceleration,
                Code::ACCELERATION_TOO_HIGH,
            )?,
            deceleration: self.check_rate(
                request.deceleration,
                p.default_goal_deceleration(),
                down,
                Code::DECELERATION_TOO_HIGH,
            )?,
            shape: if jerk == 0.0 { p.default_goal_shape() } else { p.shape(jerk) },
        })
    }

    /// Starts a positioning or velocity goal, or lets it wait for the goal before.
    pub(in crate::axis) fn start_move(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Move,
    ) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_free()?;
        let waits = request.mode == MoveMode::Superimposed || request.buffer_mode != BufferMode::Aborting;
        if waits && self.tracker().is_some() {
            return Err(self.refuse(Code::TRAJECTORY_UNDER_WAY));
        }
        if request.mode == MoveMode::Superimposed && !self.rests() {
            let whole = |position: Position| Position::whole(position.nearest());
            let end = whole(self.superimposed()) + whole(request.target.exact());
            return self.start_superimposed(cx, sequence, request, end);
        }
        let limits = self.check_limits(request)?;
        if request.buffer_mode != BufferMode::Aborting && self.task.goal().is_some() {
            return self.wait_in_buffer(cx, sequence, request, limits);
        }
        let from = self.present_motion();
        let (course, target) = if request.mode == MoveMode::Velocity {
            self.check_velocity(request.velocity)?;
            let aim = Aim::velocity(request.velocity);
            (self.course(cx.cycle, from, aim, limits), None)
        } else {
            let target = self.target(request, limits, from, self.goal_target());
            self.check_target(target, &self.parameters)?;
            let aim = Aim::Target(Position::whole(target.nearest()));
            (self.course(cx.cycle, from, aim, limits), Some(target))
        };
        self.check_course(&course, from, limits)?;
        self.begin_goal(cx, sequence, target);
        let state = if target.is_some() { AxisState::DiscreteMotion } else { AxisState::ContinuousMotion };
        self.begin_motion(cx, state, request.mode.reference(), Generator::Plan(course));
        Ok(())
    }

    /// Returns the end of a positioning goal before rounding to whole increments, if it begins with `from`. `exact` is
    /// the exact end of the goal before it.
    pub(in crate::axis) fn target(
        &self,
        request: &Move,
        limits: Limits,
        from: Motion,
        exact: Option<Position>,
    ) -> Position {
        let now = from.position;
        let rest_of_goal = match exact {
            // The goal before rests on this increment: the part lost by rounding counts for the next goal.
            Some(exact) if Position::whole(exact.nearest()) == Position::whole(now.nearest()) => exact,
            _ => now,
        };
        match (request.mode, self.setup.modulo) {
            (MoveMode::Relative | MoveMode::Superimposed, _) => rest_of_goal + request.target.exact(),
            (MoveMode::Additive, _) => exact.unwrap_or(now) + request.target.exact(),
            (_, Some(modulo)) => {
                let way = profile::stopping_distance(from, &self.with_raised_jerk(from, limits));
                // A passage may be at the last position from which the axis can stop; its rounding must not cost a
                // turn.
                let certain = (way.abs() - ROUNDING).clamp(0.0, Position::LIMIT as f64).copysign(way);
                // At rest the exact end of its goal counts, which may be half an increment away.
                let now = if from.velocity == 0.0 { rest_of_goal } else { now };
                let stop = now + Position::from_f64(certain);
                let direction = if from.velocity == 0.0 { self.travel.last_direction() } else { from.velocity };
                modulo.target(request.target.exact(), now, stop, request.direction, direction)
            }
            _ => request.target.exact(),
        }
    }

    fn goal_target(&self) -> Option<Position> {
        self.task.goal().and_then(|goal| goal.target).or(self.supervision.rested_at())
    }

    /// Checks that a target is within all position limits of `p`.
    pub(in crate::axis) fn check_target(&self, target: Position, p: &AxisParameters) -> Result<(), Refusal> {
        let end = target.nearest();
        let low = p.min_position.unwrap_or(1 - Position::LIMIT);
        let high = p.max_position.unwrap_or(Position::LIMIT - 1);
        if !target.is_legal() {
            return Err(self.refuse(Code::POSITION_OUT_OF_RANGE).with(Number::Position(end), Number::None));
        }
        if end > high {
            let numbers = (Number::Position(end), Number::Position(high));
            return Err(self.refuse(Code::ABOVE_MAX_POSITION).with(numbers.0, numbers.1));
        }
        if end < low {
            let numbers = (Number::Position(end), Number::Position(low));
            return Err(self.refuse(Code::BELOW_MIN_POSITION).with(numbers.0, numbers.1));
        }
        Ok(())
    }

    /// Checks that a velocity does not lead beyond a limit at which the axis already is.
    pub(in crate::axis) fn check_velocity(&self, velocity: f64) -> Result<(), Refusal> {
        self.check_forward(velocity)?;
        self.check_velocity_switches(velocity)?;
        let now = self.command.position();
        let limit = self.limit(velocity > 0.0);
        let at_limit = match velocity {
            v if v > 0.0 => now >= Position::whole(limit),
            v if v < 0.0 => now <= Position::whole(limit),
            _ => false,
        };
        if at_limit {
            let numbers = (Number::Velocity(velocity), Number::Position(limit));
            return Err(self.refuse(Code::LIMIT_VIOLATION).with(numbers.0, numbers.1));
        }
        Ok(())
    }

    /// Checks that a course stays within the position limits.
    pub(in crate::axis) fn check_course(
        &self,
        course: &PlannedMotion,
        from: Motion,
        limits: Limits,
    ) -> Result<(), Refusal> {
        self.check_course_forward(course, from)?;
        self.check_course_switches(course, from)?;
        let now = from.position;
        match course.aim {
            Aim::Target(_) if course.end_velocity() == 0.0 => self.check_extent(course.extent_from(now), limits),
            // The motion ahead is checked in each cycle. A reversal at its start is known now.
            Aim::Velocity(velocity) => {
                let (low, high) = course.extent_from(now);
                self.check_extent(if velocity > 0.0 { (low, now.max(low)) } else { (now.min(high), high) }, limits)
            }
            _ => Ok(()),
        }
    }

    /// Checks that a plan stays within the position limits. Beyond a limit it may be only where the axis already is.
    pub(super) fn check_plan_limits(&self, plan: &Plan, limits: Limits) -> Result<(), Refusal> {
        self.check_extent(plan.extent(), limits)
    }

    fn check_extent(&self, (lowest, highest): (Position, Position), limits: Limits) -> Result<(), Refusal> {
        let now = self.command.position();
        let asked = Number::Acceleration(limits.deceleration);
        let beyond = |code, reached: Position| Err(self.refuse(code).with(asked, Number::Position(reached.floor())));
        if highest > Position::whole(self.limit(true)).max(now) {
            return beyond(Code::CANNOT_STOP_BEFORE_MAX_POSITION, highest);
        }
        if lowest < Position::whole(self.limit(false)).min(now) {
            return beyond(Code::CANNOT_STOP_BEFORE_MIN_POSITION, lowest);
        }
        Ok(())
    }
}

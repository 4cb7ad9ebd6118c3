//! Goals: positioning, velocity and synchronization, from the command to the generator.

use super::power::Power;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::Code;
use crate::command::{Move, MoveMode, SyncMode, Synchronize};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::position::Position;
use crate::profile::{self, Limits, Plan};
use crate::sync::follower::{Bounds, Follower};
use crate::sync::gear::{Gear, Ratio};
use serde::{Deserialize, Serialize};

/// Least velocity, acceleration and deceleration of a goal, in increments: with less, a move would outlast its machine.
const LEAST_RATE: f64 = 1e-6;

/// The goal that the axis works on.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Goal {
    /// Number of the command that started it.
    pub sequence: u64,
    /// How it will end once the axis stands; none: by reaching its target.
    pub ending: Option<Code>,
    /// Where it ends, before rounding to whole increments; none for a goal without end.
    pub target: Option<Position>,
}

impl Axis {
    /// Ends the active goal now; one that was cancelled ends as cancelled, unless an error ends it.
    pub(super) fn end_goal(&mut self, cx: &mut Context<'_>, code: Code) {
        if let Some(goal) = self.goal.take() {
            let taken_over = matches!(code, Code::REPLACED | Code::HALTED | Code::QUICK_STOP | Code::DISABLED);
            let code = goal.ending.filter(|_| taken_over).unwrap_or(code);
            let severity = if code.is_none() { Severity::Info } else { Severity::Warn };
            let event = Event::new(severity, Kind::Done, self.object(), code).of_command(goal.sequence);
            cx.events.push(Event { position: self.command.position, ..event });
        }
    }

    fn begin_goal(&mut self, cx: &mut Context<'_>, sequence: u64, target: Option<Position>) {
        self.end_goal(cx, Code::REPLACED);
        self.goal = Some(Goal { sequence, ending: None, target });
        self.judge.rested_at = None;
        cx.events.push(Event::new(Severity::Info, Kind::Accepted, self.object(), Code::NONE).of_command(sequence));
    }

    fn refuse(&self, code: Code) -> Refusal {
        Refusal::new(code, self.object())
    }

    /// A motion command needs an axis that is on, without error and without lock.
    fn check_free(&self) -> Result<(), Refusal> {
        match (self.state, self.power) {
            (AxisState::ErrorStop, _) => Err(self.refuse(Code::IN_ERROR)),
            (AxisState::Stopping, _) => Err(self.refuse(Code::QUICK_STOPPED)),
            (_, Power::On) => Ok(()),
            _ => Err(self.refuse(Code::NOT_ENABLED)),
        }
    }

    /// A value that may be left out as 0: the default then, and no more than its maximum.
    fn check_rate(&self, asked: f64, usual: f64, most: f64, code: Code) -> Result<f64, Refusal> {
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
        // In mode velocity 0 means 0, and the sign is the direction.
        let (speed, usual) = match request.mode {
            MoveMode::Velocity => (request.velocity.abs(), 0.0),
            _ => (request.velocity, p.usual_velocity()),
        };
        let down = p.deceleration_limit();
        self.check_rate(request.jerk, 0.0, p.max_jerk.unwrap_or(f64::MAX), Code::JERK_TOO_HIGH)?;
        Ok(Limits {
            velocity: self.check_rate(speed, usual, p.max_velocity, Code::VELOCITY_TOO_HIGH)?,
            acceleration: self.check_rate(
                request.acceleration,
                p.usual_acceleration(),
                p.max_acceleration,
                Code::ACCELERATION_TOO_HIGH,
            )?,
            deceleration: self.check_rate(
                request.deceleration,
                p.usual_deceleration(),
                down,
                Code::DECELERATION_TOO_HIGH,
            )?,
        })
    }

    /// Starts a positioning or velocity goal.
    pub(super) fn start_move(&mut self, cx: &mut Context<'_>, sequence: u64, request: &Move) -> Result<(), Refusal> {
        self.check_free()?;
        let limits = self.check_limits(request)?;
        let (plan, target) = if request.mode == MoveMode::Velocity {
            (self.plan_velocity(request.velocity, limits)?, None)
        } else {
            let target = self.target(request, limits);
            (self.plan_position(target, limits)?, Some(target))
        };
        self.begin_goal(cx, sequence, target);
        self.reference = match request.mode {
            MoveMode::Velocity => Reference::Speed,
            MoveMode::Absolute => Reference::PositionAbsolute,
            MoveMode::Relative | MoveMode::Additive => Reference::PositionRelative,
        };
        self.generator = Generator::plan(plan, cx.cycle, limits.deceleration);
        let state = if target.is_some() { AxisState::DiscreteMotion } else { AxisState::ContinuousMotion };
        self.set_state(cx, state);
        Ok(())
    }

    /// Where a positioning goal ends, before rounding to whole increments.
    fn target(&self, request: &Move, limits: Limits) -> Position {
        let rest_of_goal = |target: Position| match self.goal_target() {
            // The goal stands on this increment: what its rounding left out counts on.
            Some(exact) if Position::whole(exact.nearest()) == target => exact,
            _ => target,
        };
        let now = self.command.position;
        match (request.mode, self.setup.modulo) {
            (MoveMode::Relative, _) => rest_of_goal(now) + request.target.exact(),
            (MoveMode::Additive, _) => {
                let active = self.goal.and_then(|goal| goal.target);
                active.unwrap_or_else(|| rest_of_goal(now)) + request.target.exact()
            }
            (_, Some(modulo)) => {
                let speed = self.command.velocity;
                let way = speed * speed.abs() / (2.0 * limits.deceleration);
                let legal = Position::LIMIT as f64;
                let stop = now + Position::from_f64(way.clamp(-legal, legal));
                let direction = if speed == 0.0 { self.last_direction } else { speed };
                Position::whole(modulo.target(request.target.exact(), now, stop, request.direction, direction))
            }
            _ => request.target.exact(),
        }
    }

    fn goal_target(&self) -> Option<Position> {
        self.goal.and_then(|goal| goal.target).or(self.judge.rested_at)
    }

    fn plan_position(&self, target: Position, limits: Limits) -> Result<Plan, Refusal> {
        let end = target.nearest();
        let (low, high) = (self.limit(false), self.limit(true));
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
        let plan = profile::to_rest(self.command, Position::whole(end), limits, self.setup.cycle_ns);
        self.check_way(&plan, limits)?;
        Ok(plan)
    }

    /// On its way a plan may turn back beyond a limit only where it stands already.
    fn check_way(&self, plan: &Plan, limits: Limits) -> Result<(), Refusal> {
        let (lowest, highest) = plan.extent();
        let now = self.command.position;
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

    fn plan_velocity(&self, velocity: f64, limits: Limits) -> Result<Plan, Refusal> {
        let now = self.command.position;
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
        if velocity == 0.0 {
            return Ok(self.plan_stop(self.command, limits.deceleration));
        }
        Ok(profile::to_velocity(self.command, velocity, limits, self.setup.cycle_ns))
    }

    /// Couples the axis to a leader.
    pub(super) fn start_synchronize(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Synchronize,
    ) -> Result<(), Refusal> {
        self.check_free()?;
        let p = &self.parameters;
        let (numerator, denominator) = match (request.numerator, request.denominator) {
            (0, 0) => (p.sync_slave, p.sync_master),
            given => given,
        };
        let ratio = Ratio::new(numerator, denominator)
            .ok_or_else(|| self.refuse(Code::BAD_RATIO).with(Number::Count(numerator), Number::Count(denominator)))?;
        let velocity =
            self.check_rate(request.velocity, p.usual_velocity(), p.max_velocity, Code::VELOCITY_TOO_HIGH)?;
        let acceleration = self.check_rate(
            request.acceleration,
            p.usual_acceleration(),
            p.max_acceleration,
            Code::ACCELERATION_TOO_HIGH,
        )?;
        if !cx.leads.get(request.leader).valid {
            return Err(self.refuse(Code::LEADER_LOST));
        }
        let bounds = Bounds {
            velocity,
            acceleration: acceleration.min(p.deceleration_limit()),
            max_velocity: p.max_velocity,
            max_acceleration: p.max_acceleration,
            max_deceleration: p.deceleration_limit(),
        };
        let offset = match request.mode {
            SyncMode::Position => request.offset.exact(),
            SyncMode::Velocity => Position::ZERO,
        };
        // From one coupling to the next the remainder passes on.
        let gear = match &self.generator {
            Generator::Follow(follower) => follower.gear().with_ratio(ratio),
            _ => Gear::new(ratio),
        };
        let follower =
            Follower::new(request.leader, gear, request.mode, request.disengage, self.command, offset, bounds);
        self.begin_goal(cx, sequence, None);
        self.reference = Reference::Gear;
        self.generator = Generator::Follow(follower);
        self.set_state(cx, AxisState::SynchronizedMotion);
        Ok(())
    }
}

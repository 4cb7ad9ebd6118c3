//! What moves an axis in a cycle, and what keeps it within its limits.

use super::power::Power;
use super::{Axis, AxisState, Context, Reference};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Severity};
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan};
use crate::sync::follower::{Follower, Phase};
use crate::sync::gear::Gear;
use serde::{Deserialize, Serialize};

/// Cycles after which a constant velocity starts from its own place again: f64 stays exact enough for ever.
const REBASE_CYCLES: u64 = 1 << 20;
/// What rounding may put a stopping point beyond a limit (inc).
const ROUNDING: f64 = 1e-6;

/// What generates the command position.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
pub(super) enum Generator {
    /// Nothing: the position holds.
    Rest,
    /// A profile, since cycle `start`.
    Plan {
        plan: Plan,
        start: u64,
        /// Deceleration that its goal asked for (inc/s^2).
        deceleration: f64,
    },
    /// A coupling.
    Follow(Follower),
}

impl Generator {
    pub(super) fn is_sound(&self) -> bool {
        match self {
            Generator::Rest => true,
            Generator::Plan { plan, .. } => plan.is_sound(),
            Generator::Follow(follower) => follower.is_sound(),
        }
    }

    pub(super) fn plan(plan: Plan, start: u64, deceleration: f64) -> Self {
        Generator::Plan { plan, start, deceleration }
    }
}

impl Axis {
    /// The command position of this cycle.
    pub(super) fn advance(&mut self, cx: &mut Context<'_>) {
        if !self.is_on() {
            self.command = Motion::at_rest(self.actual.position);
            self.generator = Generator::Rest;
            return;
        }
        let before = self.command;
        match self.generator {
            Generator::Rest => self.command = Motion::at_rest(before.position),
            Generator::Plan { plan, start, deceleration } => self.read_plan(cx, plan, start, deceleration),
            Generator::Follow(follower) => self.follow(cx, follower),
        }
        if self.command.velocity != 0.0 {
            self.last_direction = self.command.velocity;
        }
    }

    fn read_plan(&mut self, cx: &mut Context<'_>, plan: Plan, start: u64, deceleration: f64) {
        let elapsed = cx.cycle.saturating_sub(start);
        let next = plan.at(elapsed);
        let ends_at_rest = plan.end_velocity() == 0.0;
        if !ends_at_rest {
            if self.stop_at_limit(cx, next) {
                return;
            }
            if elapsed > plan.cycles().saturating_add(REBASE_CYCLES) {
                let same = profile::to_velocity(next, next.velocity, self.usual_limits(), self.setup.cycle_ns);
                self.generator = Generator::plan(same, cx.cycle, deceleration);
            }
        } else if elapsed >= plan.cycles() {
            // A stop may end between two increments. Its drive is given the lower one either way: resting there moves
            // nothing, and every axis at rest stands on a whole increment.
            self.generator = Generator::Rest;
            self.command = Motion::at_rest(Position::whole(next.position.floor()));
            return;
        }
        self.command = next;
    }

    fn follow(&mut self, cx: &mut Context<'_>, mut follower: Follower) {
        let lead = cx.leads.get(follower.leader);
        let bound = Position::whole(Gear::MAX_CHANGE);
        if !lead.valid || lead.change > bound || lead.change < -bound {
            let code = if lead.valid { Code::ENCODER_JUMP } else { Code::LEADER_LOST };
            self.react(cx, code, Number::Position(lead.change.floor()), Number::None);
            // The motion of this cycle is not known: the stop begins with the last one, a cycle ago.
            if let Generator::Plan { plan, start, .. } = &mut self.generator {
                *start = cx.cycle.saturating_sub(1);
                self.command = plan.at(1);
            }
            return;
        }
        let was = follower.phase();
        let next = follower.step(self.command, lead, self.cycle_s());
        if self.stop_at_limit(cx, next) {
            return;
        }
        if was == Phase::Synchronized && follower.phase() == Phase::CatchingUp {
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::SYNC_LOST);
            cx.events.push(Event { position: next.position, ..event });
        }
        self.generator = Generator::Follow(follower);
        self.command = next;
    }

    /// Would `next` leave no way to stop before a limit? Then the axis stops at it instead, from its last motion, and
    /// that is an error.
    fn stop_at_limit(&mut self, cx: &mut Context<'_>, next: Motion) -> bool {
        let up = next.velocity > 0.0;
        let limit = Position::whole(self.limit(up));
        let down = self.parameters.deceleration_limit();
        let sign = if up { 1.0 } else { -1.0 };
        let room = |from: Motion| sign * (limit - from.position).to_f64();
        if next.velocity == 0.0 || room(next) + ROUNDING >= self.stopping_way(next, down) {
            return false;
        }
        // The motion before kept the rule, so it can stop in time; it started a cycle ago.
        let before = self.command;
        let plan = if before.velocity * sign > 0.0 && room(before) > 0.0 {
            profile::stop_at(before, limit, self.setup.cycle_ns)
        } else {
            profile::stop(before, down, self.setup.cycle_ns)
        };
        self.generator = Generator::plan(plan, cx.cycle.saturating_sub(1), down);
        self.command = plan.at(1);
        self.reference = Reference::Stop;
        let code = if up { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE };
        cx.events.push(Event { position: limit, ..Event::new(Severity::Warn, Kind::Limit, self.object(), code) });
        self.raise(cx, code, Number::None, Number::Position(limit.floor()));
        self.judge.after_stop = self.parameters.error_reaction;
        self.set_state(cx, AxisState::ErrorStop);
        true
    }

    /// The software limit in a direction, or the end of all positions.
    pub(super) fn limit(&self, up: bool) -> i64 {
        if up {
            self.parameters.max_position.unwrap_or(Position::LIMIT - 1)
        } else {
            self.parameters.min_position.unwrap_or(1 - Position::LIMIT)
        }
    }

    /// The way that it takes to stop after `next`. A profile stops in continuous time; a coupled axis makes whole steps, of
    /// which one may be a count more than its leader's speed.
    fn stopping_way(&self, next: Motion, deceleration: f64) -> f64 {
        match &self.generator {
            Generator::Follow(follower) => {
                let cycle_s = self.cycle_s();
                let step = (next.velocity.abs() * cycle_s - follower.uneven()).max(0.0);
                let less = deceleration * cycle_s * cycle_s;
                let steps = (step / less * (1.0 + 1e-9)).floor();
                steps * step - less * steps * (steps + 1.0) / 2.0
            }
            _ => next.velocity * next.velocity / (2.0 * deceleration),
        }
    }

    /// Where it would come to rest from its present motion at best.
    fn earliest_rest(&self) -> Position {
        profile::stop(self.command, self.parameters.deceleration_limit(), self.setup.cycle_ns).end()
    }

    /// Lowest and highest position that the motion under way will or must take; none at rest.
    pub fn reach(&self) -> Option<(i64, i64)> {
        let (low, high) = match &self.generator {
            Generator::Rest => return None,
            Generator::Plan { plan, .. } if plan.end_velocity() == 0.0 => plan.extent_from(self.command.position),
            _ => {
                let (now, rest) = (self.command.position, self.earliest_rest());
                (now.min(rest), now.max(rest))
            }
        };
        Some((low.floor(), high.ceil()))
    }

    /// A plan to rest with `deceleration`, or as much more as it takes to stay within the limit.
    pub(super) fn plan_stop(&self, from: Motion, deceleration: f64) -> Plan {
        let plan = profile::stop(from, deceleration, self.setup.cycle_ns);
        let up = from.velocity > 0.0;
        let limit = Position::whole(self.limit(up));
        let (passes, lies_ahead) =
            if up { (plan.end() > limit, from.position < limit) } else { (plan.end() < limit, from.position > limit) };
        // Beyond the limit already, it can only stop.
        if passes && lies_ahead && from.velocity != 0.0 {
            return profile::stop_at(from, limit, self.setup.cycle_ns);
        }
        plan
    }

    /// Stops from the present motion; at rest it stays where its drive is asked to be.
    pub(super) fn brake_to_rest(&mut self, cx: &mut Context<'_>, deceleration: f64) {
        self.reference = Reference::Stop;
        if matches!(self.state, AxisState::ContinuousMotion | AxisState::SynchronizedMotion) {
            self.set_state(cx, AxisState::DiscreteMotion);
        }
        if self.command.velocity == 0.0 {
            self.command = Motion::at_rest(Position::whole(self.command.position.floor()));
            self.generator = Generator::Rest;
            return;
        }
        let plan = self.plan_stop(self.command, deceleration);
        self.generator = Generator::plan(plan, cx.cycle, deceleration);
    }

    /// The deceleration that the active motion was asked for.
    pub(super) fn active_deceleration(&self) -> f64 {
        match self.generator {
            Generator::Plan { deceleration, .. } => deceleration,
            _ => self.parameters.usual_deceleration(),
        }
    }

    pub(super) fn usual_limits(&self) -> Limits {
        Limits {
            velocity: self.parameters.usual_velocity(),
            acceleration: self.parameters.usual_acceleration(),
            deceleration: self.parameters.usual_deceleration(),
        }
    }

    /// Takes the newest streamed velocity, and stops when none has come for too long.
    pub(super) fn follow_stream(&mut self, cx: &mut Context<'_>) {
        let streams = self.state == AxisState::ContinuousMotion && self.reference == Reference::Stream;
        let free = self.state == AxisState::Standstill || streams;
        let newest = cx.stream.filter(|stream| stream.generation != self.stream_generation);
        let wanted = newest.and_then(|stream| *stream.velocity.get(usize::from(self.setup.index))?);
        self.stream_age = self.stream_age.saturating_add(1);
        if let Some(stream) = newest {
            self.stream_generation = stream.generation;
        }
        // NaN fails the comparison: a bad setpoint is no sign of life.
        if let Some(velocity) = wanted
            && free
            && self.power == Power::On
            && velocity.abs() <= self.parameters.max_velocity
        {
            self.stream_age = 0;
            let limits = self.usual_limits();
            let plan = profile::to_velocity(self.command, velocity, limits, self.setup.cycle_ns);
            self.generator = Generator::plan(plan, cx.cycle, limits.deceleration);
            self.reference = Reference::Stream;
            self.set_state(cx, AxisState::ContinuousMotion);
        }
        let timeout = self.parameters.setpoint_timeout.unsigned_abs();
        let silent = self.stream_age.saturating_mul(self.setup.cycle_ns) > timeout;
        if self.reference == Reference::Stream && self.command.velocity != 0.0 && silent {
            self.brake_to_rest(cx, self.parameters.usual_deceleration());
            cx.events.push(Event::new(Severity::Warn, Kind::Warning, self.object(), Code::STREAM_TIMEOUT));
        }
    }
}

//! A superimposed motion: a distance added to any other motion of the axis (MC_MoveSuperimposed).
//!
//! Law      command = active motion + superimposed motion. Velocity and acceleration of the superimposed motion are at
//!          most what the active motion leaves of the limits of the axis, so that the sum stays within them. If both
//!          have the same direction throughout, they share acceleration and deceleration. Otherwise one may slow down
//!          while the sum speeds up: then the lower limit also applies
//! Refuses  rates beyond those left, an end beyond a limit

use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::goal::LEAST_RATE;
use crate::axis::state::overlay::{plan, single_direction};
use crate::axis::state::planned_motion::{ROUNDING, raise_jerk};
use crate::axis::state::{Aim, Axis, Context, Generator, Numbers, Overlay};
use crate::code::Code;
use crate::command::Move;
use crate::event::{Event, Number, Refusal};
use crate::position::Position;
use crate::profile::{self, Jerks, Limits, Motion, Shape};
use crate::state::AxisState;
use crate::sync::follower::Reserve;
use crate::vocabulary::Owner;

/// Value for an override that is not planned yet, so that the motion is planned again.
const UNSEEN: f64 = -1.0;

/// Directions of two motions that are added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RelativeDirection {
    /// Both always have the same direction.
    Same,
    /// Unknown.
    Any,
}

impl RelativeDirection {
    /// Returns acceleration and deceleration that one motion leaves to the other (inc/s^2).
    fn left(self, most: &Limits, taken: &Limits) -> (f64, f64) {
        let least = most.acceleration.min(most.deceleration);
        let (up, down) = (most.acceleration - taken.acceleration, most.deceleration - taken.deceleration);
        match self {
            Self::Same => (up, down),
            // If one slows down while the other one speeds up against it, the sign of the sum is unknown.
            Self::Any => (up.min(least - taken.deceleration), down.min(least - taken.acceleration)),
        }
    }
}

impl Axis {
    /// Whether nothing moves the command, nor a second drive relative to the first one.
    pub(in crate::axis) fn rests(&self) -> bool {
        matches!(*self.motion.generator(), Generator::Rest)
            && self.coupling.overlay().is_none()
            && !self.brake.second_moves()
    }

    /// Returns the active motion without superimposed motion.
    pub(in crate::axis) fn underlying(&self) -> Motion {
        let Some(Overlay { shown, .. }) = self.coupling.overlay() else { return self.command.motion() };
        Motion {
            position: self.command.position(),
            velocity: self.command.velocity() - shown.velocity,
            acceleration: self.command.acceleration() - shown.acceleration,
            jerk: self.command.motion().jerk - shown.jerk,
        }
    }

    /// Returns the start of a course that is planned again below a superimposed motion.
    pub(in crate::axis) fn base(&self) -> Motion {
        if self.coupling.overlay().is_some() { self.underlying() } else { self.present_motion() }
    }

    /// Returns the velocity and acceleration that a coupling leaves to the superimposed motion (inc/s, inc/s^2).
    pub(in crate::axis) fn reserve(&self) -> Reserve {
        self.coupling.overlay().map_or(Reserve::default(), |overlay| Reserve {
            velocity: overlay.limits.velocity,
            acceleration: overlay.limits.acceleration.max(overlay.limits.deceleration),
        })
    }

    /// Adds the superimposed motion of this cycle to `base`; the distance remains in the active motion.
    pub(in crate::axis) fn superimpose(&mut self, cx: &mut Context<'_>, base: Motion) -> Motion {
        let Some(overlay) = self.coupling.overlay_mut() else { return base };
        let elapsed = cx.cycle.saturating_sub(overlay.start);
        let motion = overlay.plan.at(elapsed);
        let change = motion.position - overlay.shown.position;
        overlay.shown = motion;
        // A motion that the override holds continues later.
        let ended = elapsed >= overlay.plan.cycles() && overlay.plan.end() == overlay.end;
        let (sequence, ending) = (overlay.sequence, overlay.ending);
        self.motion.superimpose(change);
        if let Some(target) = self.task.goal_mut().and_then(|goal| goal.target.as_mut()) {
            *target += change;
        }
        let sum = Motion {
            position: base.position + change,
            velocity: base.velocity + motion.velocity,
            acceleration: base.acceleration + motion.acceleration,
            jerk: base.jerk + motion.jerk,
        };
        if ended {
            self.coupling.take_overlay();
            self.renew_override_share();
            let code = ending.unwrap_or(Code::NONE);
            cx.events.push(Event::done(self.object(), sequence, code, sum.position));
            if matches!(*self.motion.generator(), Generator::Rest) {
                return self.resting(sum.position);
            }
        }
        sum
    }

    /// Returns the position of the superimposed motion, counted from the start of the first one; 0 without one.
    pub(in crate::axis) fn superimposed(&self) -> Position {
        self.coupling.overlay().map_or(Position::ZERO, |overlay| overlay.shown.position)
    }

    /// Starts a superimposed motion to an end. It replaces an active one, from its present motion.
    ///
    /// # Errors
    /// The active motion does not leave enough; its end is beyond a limit.
    pub(in crate::axis) fn start_superimposed(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Move,
        end: Position,
    ) -> Result<(), Refusal> {
        self.check_no_marks()?;
        let shown = self.coupling.overlay().map_or(Motion::default(), |overlay| overlay.shown);
        let share = self.parameters.velocity_override;
        let with = |ways: RelativeDirection| {
            let (limits, most) = self.remaining_limits(request, ways)?;
            let limits = raise_jerk(shown, limits, most);
            let plan = plan(shown, end, &limits, share, self.setup.cycle_ns);
            Ok(Overlay {
                sequence,
                plan,
                start: cx.cycle,
                limits,
                end,
                whole: end - shown.position,
                share,
                shown,
                ending: None,
            })
        };
        let straight = self.direction_of_motion().filter(|up| *up == (end > shown.position));
        let beside = straight.and_then(|up| {
            with(RelativeDirection::Same).ok().filter(|overlay| overlay.remaining_direction() == Some(up))
        });
        let overlay = beside.map_or_else(|| with(RelativeDirection::Any), Ok)?;
        self.check_overlay_forward(&overlay)?;
        self.check_sum(&overlay)?;
        self.end_overlay(cx, Code::REPLACED, NO_NUMBERS);
        self.coupling.set_overlay(Some(overlay));
        self.renew_override_share();
        self.supervision.forget_rest();
        self.accepted(cx, sequence);
        if self.status.state() == AxisState::Standstill {
            self.set_state(cx, AxisState::DiscreteMotion);
        }
        Ok(())
    }

    /// Checks that both motions together stay within the position limits. A motion without end is checked in each
    /// cycle.
    fn check_sum(&self, overlay: &Overlay) -> Result<(), Refusal> {
        let (down, up) = overlay.ahead();
        let here = matches!(*self.motion.generator(), Generator::Rest)
            .then_some((self.command.position(), self.command.position()));
        match self.known_reach().or(here) {
            Some((low, high)) => self.check_range(low + down, high + up),
            None => Ok(()),
        }
    }

    /// Checks that these positions are within the limits, or no further out than the axis already is.
    pub(in crate::axis) fn check_range(&self, lowest: Position, highest: Position) -> Result<(), Refusal> {
        let now = self.command.position();
        let beyond = |code, reached: i64, limit| {
            Err(Refusal::new(code, self.object()).with(Number::Position(reached), Number::Position(limit)))
        };
        if !lowest.is_legal() || !highest.is_legal() {
            let place = if highest.is_legal() { lowest } else { highest };
            let refusal = Refusal::new(Code::POSITION_OUT_OF_RANGE, self.object());
            return Err(refusal.with(Number::Position(place.nearest()), Number::None));
        }
        if highest > Position::whole(self.limit(true)).max(now) {
            return beyond(Code::ABOVE_MAX_POSITION, highest.ceil(), self.limit(true));
        }
        if lowest < Position::whole(self.limit(false)).min(now) {
            return beyond(Code::BELOW_MIN_POSITION, lowest.floor(), self.limit(false));
        }
        Ok(())
    }

    /// Checks that the active motion plus the remaining superimposed motion stays within the position limits.
    pub(in crate::axis) fn check_overlay(&self) -> Result<(), Refusal> {
        self.coupling.overlay().map_or(Ok(()), |overlay| self.check_sum(&overlay))
    }

    /// Returns the direction of the active motion and the waiting goals if they do not turn back: up is true. None for
    /// motions that may reverse at any time: a leader, a stream, a vocabulary, a search.
    fn direction_of_motion(&self) -> Option<bool> {
        let Generator::Plan(course) = self.motion.generator() else { return None };
        if self.task.goal().is_none() || self.status.owner() != Owner::Native || self.searches() || self.probes() {
            return None;
        }
        let here = self.command.position();
        let (low, high) = course.extent_from(here);
        let ahead = (low - here, high - here);
        let up = match course.aim {
            // A waiting goal may reverse.
            Aim::Velocity(_) if !self.pending.buffer().is_empty() => None,
            // Once the velocity is reached, its plan is behind the axis.
            Aim::Velocity(velocity) => {
                let (end, rounding) = (course.end(), Position::from_f64(ROUNDING));
                let is_straight = low >= here.min(end) - rounding && high <= here.max(end) + rounding;
                (is_straight && self.underlying().velocity * velocity >= 0.0).then_some(velocity > 0.0)
            }
            Aim::Target(target) => single_direction(ahead, target - here),
            Aim::Stop => single_direction(ahead, course.end() - here),
        }?;
        let mut before = self.task.goal().and_then(|goal| goal.target);
        let goes_on = self.waiting_ends().all(|end| {
            let is_on = before.zip(end).is_some_and(|(before, end)| if up { end >= before } else { end <= before });
            before = end;
            is_on
        });
        goes_on.then_some(up)
    }

    /// Checks that a goal that will begin below a superimposed motion stays within the remaining rates; `up`: its
    /// direction, if known.
    pub(in crate::axis) fn check_with_overlay(&self, limits: &Limits, up: Option<bool>) -> Result<(), Refusal> {
        let Some(overlay) = self.coupling.overlay() else { return Ok(()) };
        let most = self.parameters.largest_limits();
        let is_same = up.is_some() && up == overlay.remaining_direction() && up == self.direction_of_motion();
        let (taken, code) = (overlay.limits, Code::SUPERIMPOSED_TOO_MUCH);
        let (speeding, slowing) =
            if is_same { RelativeDirection::Same } else { RelativeDirection::Any }.left(&most, &taken);
        let check = |asked: f64, left: f64, number: fn(f64) -> Number| {
            // The remaining rate was rounded.
            let fits = asked <= left * (1.0 + 1e-12);
            let refusal = Refusal::new(code, self.object()).with(number(asked), number(left.max(0.0)));
            if fits { Ok(()) } else { Err(refusal) }
        };
        check(limits.velocity, most.velocity - taken.velocity, Number::Velocity)?;
        check(limits.acceleration, speeding, Number::Acceleration)?;
        check(limits.deceleration, slowing, Number::Acceleration)?;
        match least_jerk(most.shape) {
            Some(jerk) => check(most_jerk(limits.shape), jerk - most_jerk(taken.shape), Number::Jerk),
            None => Ok(()),
        }
    }

    /// Returns the remaining limits that the active motion leaves for the request, and the whole remaining velocity
    /// (inc/s). The requested rates must be within them.
    fn remaining_limits(&self, request: &Move, ways: RelativeDirection) -> Result<(Limits, f64), Refusal> {
        let most = self.parameters.largest_limits();
        let usual = self.parameters.default_goal_limits();
        let used = match self.motion.generator() {
            Generator::Plan(course) => Some(course.limits),
            // A coupling keeps within the rest. Of the rates that are possible in both directions it uses the default
            // share.
            Generator::Follow(_) | Generator::Track(_) => {
                let rate = usual.acceleration.min(usual.deceleration);
                Some(Limits { acceleration: rate, deceleration: rate, ..usual })
            }
            Generator::Rest | Generator::Open { .. } | Generator::OutAn { .. } | Generator::Coast { .. } => None,
        };
        // The waiting goals will be active together with this motion, too.
        let used = self.pending.buffer().limits().fold(used, |used, next| {
            let used = used.unwrap_or(next);
            Some(Limits { velocity: used.velocity.max(next.velocity), ..used.at_least(&next) })
        });
        let left = |most: f64, used: f64| (most - used).max(0.0);
        let (mut velocity, mut speeding, mut slowing) = (most.velocity, most.acceleration, most.deceleration);
        let mut jerk = least_jerk(most.shape);
        if let Some(used) = used {
            velocity = left(velocity, used.velocity.max(self.underlying().velocity.abs()));
            let (up, down) = ways.left(&most, &used);
            (speeding, slowing) = (up.max(0.0), down.max(0.0));
            jerk = jerk.map(|jerk| left(jerk, most_jerk(used.shape)));
        }
        let choose = |asked: f64, left: f64, usual: f64, code, number: fn(f64) -> Number| {
            if !asked.is_finite() || asked < 0.0 {
                return Err(Refusal::new(Code::BAD_NUMBER, self.object()).with(number(asked), Number::None));
            }
            let enough = left >= LEAST_RATE;
            if asked > left || !enough {
                let asked = if asked > 0.0 { asked } else { usual };
                return Err(Refusal::new(code, self.object()).with(number(asked), number(left)));
            }
            Ok(if asked > 0.0 { asked } else { usual.min(left) })
        };
        let code = Code::SUPERIMPOSED_TOO_MUCH;
        let shape = match (most.shape, jerk) {
            (Shape::Jerk(_), Some(left)) => {
                let usual = least_jerk(usual.shape).unwrap_or(left);
                let jerk = choose(request.jerk, left, usual, code, Number::Jerk)?;
                Shape::Jerk(Jerks { rise: jerk, fall: jerk, brake_rise: jerk, brake_fall: jerk })
            }
            (shape, _) => shape,
        };
        let limits = Limits {
            velocity: choose(request.velocity, velocity, usual.velocity, code, Number::Velocity)?,
            acceleration: choose(request.acceleration, speeding, usual.acceleration, code, Number::Acceleration)?,
            deceleration: choose(request.deceleration, slowing, usual.deceleration, code, Number::Acceleration)?,
            shape,
        };
        Ok((limits, velocity))
    }

    /// Returns the velocity that a superimposed motion leaves to the active motion (inc/s).
    pub(in crate::axis) fn velocity_for_base(&self) -> f64 {
        let taken = self.coupling.overlay().map_or(0.0, |overlay| overlay.limits.velocity);
        (self.parameters.max_velocity - taken).max(0.0)
    }

    /// Returns lowest and highest distance that the superimposed motion still adds.
    pub(in crate::axis) fn overlay_ahead(&self) -> (Position, Position) {
        self.coupling.overlay().map_or_else(Default::default, |overlay| overlay.ahead())
    }

    /// Lets the active motion be planned again: with or without a superimposed motion it gets another share of the
    /// override.
    fn renew_override_share(&mut self) {
        if self.parameters.velocity_override < 100.0 {
            self.observed.set_override_seen(UNSEEN);
        }
    }

    /// Plans the superimposed motion again after a change of the override.
    pub(super) fn override_overlay(&mut self, cycle: u64) {
        let share = self.parameters.velocity_override;
        if let Some(overlay) = self.coupling.overlay_mut()
            && overlay.share != share
            && overlay.ending.is_none()
        {
            let next = overlay.planned(cycle, share, self.setup.cycle_ns);
            let ((low, high), (next_low, next_high)) = (overlay.ahead(), next.ahead());
            let rounding = Position::from_f64(ROUNDING);
            // As for the active motion: if slowing down would pass its end, the old plan is kept and the change is
            // tried again.
            if next_low >= low - rounding && next_high <= high + rounding {
                *overlay = next;
            }
        }
    }

    /// Ends the superimposed motion now.
    pub(in crate::axis) fn end_overlay(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        if let Some(overlay) = self.coupling.take_overlay() {
            self.renew_override_share();
            let code = overlay.ending.unwrap_or(code);
            let done = Event::done(self.object(), overlay.sequence, code, self.command.position());
            cx.events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Stops the superimposed motion; the active motion continues.
    pub(in crate::axis) fn cancel_overlay(&mut self, cx: &Context<'_>) {
        let cycle_ns = self.setup.cycle_ns;
        if let Some(overlay) = self.coupling.overlay_mut() {
            overlay.plan = profile::stop(overlay.shown, &overlay.limits, cycle_ns);
            overlay.end = overlay.plan.end();
            overlay.start = cx.cycle;
            overlay.ending = Some(Code::CANCELLED);
        }
    }
}

fn least_jerk(shape: Shape) -> Option<f64> {
    match shape {
        Shape::Jerk(Jerks { rise, fall, brake_rise, brake_fall }) => {
            Some(rise.min(fall).min(brake_rise).min(brake_fall))
        }
        _ => None,
    }
}

fn most_jerk(shape: Shape) -> f64 {
    match shape {
        Shape::Jerk(Jerks { rise, fall, brake_rise, brake_fall }) => rise.max(fall).max(brake_rise).max(brake_fall),
        _ => 0.0,
    }
}

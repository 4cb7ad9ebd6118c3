//! Software limits of an axis.
//!
//! Law      no motion passes a software limit. A motion with an end was checked as a whole when it was planned. Any
//!          other motion stops in the cycle whose next step would leave no distance to stop; the stop starts from the
//!          motion before that step
//! Writes   the stop at a limit, and its error; with `jog_at_limit: stop` the stop of a stream is no error
//! Source   MACS-LIM-01 to -05, MACS-PROF-13

use crate::axis::state::{Aim, Axis, Beyond, Context, Failure, Generator, PlannedMotion, Stopped, planned_motion};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Severity};
use crate::position::Position;
use crate::profile::{self, Limits, Motion, Plan, Shape};
use crate::state::AxisState;
use crate::sync::follower::Follower;

/// Distance by which rounding may put the end of a stop beyond a limit (inc).
const ROUNDING: f64 = 1e-6;

impl Axis {
    /// Limits a position that a plan puts beyond a limit only by rounding to the limit; the whole increment below it
    /// may be inside.
    pub(super) fn rounded(&self, next: Motion) -> Motion {
        let (low, high) = (Position::whole(self.limit(false)), Position::whole(self.limit(true)));
        let within = next.position.max(low).min(high);
        let is_rounding = (next.position - within).to_f64().abs() <= planned_motion::ROUNDING;
        Motion { position: if is_rounding { within } else { next.position }, ..next }
    }

    #[inline]
    pub(super) fn is_within_limits(&self, place: Position) -> bool {
        place >= Position::whole(self.limit(false)) && place <= Position::whole(self.limit(true))
    }

    /// Stops the axis at a limit if `next` would leave no distance to stop before it. The stop starts from the last
    /// motion, and is an error. A motion to a target and a trajectory without steps were checked as a whole when they
    /// were planned, except for motions added since.
    #[inline]
    pub(super) fn stop_at_limit(&mut self, cx: &mut Context<'_>, next: Motion, is_added: bool) -> bool {
        let watched = match self.motion.generator() {
            Generator::Plan(course) => course.needs_limit_check(),
            Generator::Follow(_) => true,
            Generator::Track(_) => !self.stays_within_limits(),
            Generator::Rest | Generator::Open { .. } | Generator::OutAn { .. } | Generator::Coast { .. } => false,
        };
        self.watch_beyond(cx.cycle);
        if !watched && !is_added {
            return false;
        }
        if self.is_clear_of_limits(next) {
            debug_assert!(self.crossed_limit(next, is_added).is_none() && self.passed_limit(next).is_none());
            return false;
        }
        self.check_limit(cx, next, watched, is_added)
    }

    /// Called when the power is removed, or the command starts again at the actual position. The rest of the stop at a
    /// limit that was not executed does not count as leaving the limit (MACS-LIM-05).
    pub(in crate::axis) fn note_stop_given_up(&mut self) {
        let Some(stopped) = self.travel.at_limits().stopped.filter(|stopped| stopped.is_error) else { return };
        let room = self.room(stopped.up, self.feedback.position()).max(stopped.room);
        // From a larger distance a stream may move it again.
        let is_told = stopped.is_told && room == stopped.room;
        self.travel.at_limits_mut().stopped = Some(Stopped { room, is_told, ..stopped });
    }

    fn check_limit(&mut self, cx: &mut Context<'_>, next: Motion, watched: bool, is_added: bool) -> bool {
        let crossed = self.crossed_limit(next, is_added);
        let Some(up) = crossed.or_else(|| self.passed_limit(next).filter(|_| watched)) else { return false };
        let course = self.limit_stop(cx.cycle, up);
        self.command.execute(course.at(cx.cycle));
        self.motion.plan(course);
        let stopped = self.travel.at_limits().stopped_at(up);
        let is_stream = self.streams() && self.stops_streams();
        let code = if up { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE };
        let limit = self.limit(up);
        if !(is_stream && stopped.is_some_and(|stopped| stopped.is_told)) {
            let event = Event::new(Severity::Warn, Kind::Limit, self.object(), code);
            cx.events.push(Event { position: Position::whole(limit), ..event });
        }
        // The axis has not left the limit since: this is a new attempt (MACS-LIM-05).
        let is_anew = stopped.is_some_and(|stopped| stopped.is_error);
        let place = Number::Position(limit);
        if is_stream {
            // The stop includes the superimposed motion.
            self.end_overlay(cx, code, (Number::None, place));
        } else {
            let (raised, asked) = match is_anew {
                true => (Code::LIMIT_VIOLATION, Number::Velocity(next.velocity)),
                false => (code, Number::None),
            };
            self.status.end_reference();
            self.raise(cx, Failure::of(raised).with(asked, place).at_limit());
        }
        let room = self.room(up, course.end());
        self.travel.at_limits_mut().stopped =
            Some(Stopped { up, room, is_error: is_anew || !is_stream, is_told: is_stream });
        true
    }

    /// Returns the stop at a limit, from the last motion.
    fn limit_stop(&self, cycle: u64, up: bool) -> PlannedMotion {
        let limit = Position::whole(self.limit(up));
        let ahead = is_towards(up, self.command.velocity());
        let is_within = if up { self.command.position() < limit } else { self.command.position() > limit };
        // The motion of the cycle before could still stop in time. The stop starts there.
        let before = Motion { acceleration: self.present_motion().acceleration, ..self.command.motion() };
        let limits = self.with_raised_jerk(before, self.stop_limits());
        let stop = profile::stop(before, &limits, self.setup.cycle_ns).duration() + 2.0 * self.cycle_s();
        // An axis that hardly moves would approach the limit slowly for a long time: it stops where it is.
        let is_near = (limit - before.position).to_f64().abs() <= before.velocity.abs() * stop;
        let began = cycle.saturating_sub(1);
        if let Some(mut course) = self.stream_to_limit(began, before, up).filter(|_| is_within) {
            if ahead && is_near {
                // The whole course is a stop, whatever the stream commands later.
                course.aim = Aim::Stop;
            }
            return course;
        }
        let from = self.eased(before, limit, &limits);
        let (plan, bound) = match ahead && is_within && is_near {
            true if self.fits_in_steps(from, limit, &limits) => {
                (profile::stop(from, &limits, self.setup.cycle_ns), Some((limit, up)))
            }
            true => (self.plan_stop_at(from, limit, &limits), None),
            false => (self.plan_stop(before, &limits), None),
        };
        PlannedMotion::new(plan, began, Aim::Stop, limits).within(bound)
    }

    /// Returns the motion with which a stop at `limit` begins. The velocity of a coupled axis is that of its last step.
    /// At the end of the step it may be lower by half the largest change per cycle, so that the deceleration need not
    /// exceed its limit. The ripple that single counts add to the speed of its leader is left out.
    fn eased(&self, before: Motion, limit: Position, limits: &Limits) -> Motion {
        let ripple = match self.motion.generator() {
            Generator::Follow(coupling) => coupling.follower.ripple(before.velocity),
            Generator::Track(_) if !self.is_on_track() => 0.0,
            _ => return before,
        };
        let most = (2.0 * limits.deceleration * (limit - before.position).to_f64().abs()).sqrt();
        let least = before.velocity.abs() - ripple / self.cycle_s() - limits.deceleration * self.cycle_s() / 2.0;
        let speed = before.velocity.abs().min(most.max(least));
        Motion { velocity: speed.copysign(before.velocity), ..before }
    }

    /// Whether the axis stops before the limit in whole steps with its deceleration, although a stop in continuous time
    /// would not fit. With a higher deceleration its followers might not keep up. The distance in steps is shorter by
    /// up to an eighth of the change per cycle.
    fn fits_in_steps(&self, from: Motion, limit: Position, limits: &Limits) -> bool {
        let steps_whole = match self.motion.generator() {
            Generator::Follow(_) => true,
            Generator::Track(_) => !self.is_on_track(),
            _ => false,
        };
        let way = (limit - from.position).to_f64().abs();
        let less = limits.deceleration * self.cycle_s() * self.cycle_s();
        // Speed at the start of its last step, as a multiple of the change per cycle.
        let step = from.velocity.abs() * self.cycle_s() / less + 0.5;
        let steps = (step * (1.0 + 1e-9)).floor();
        let in_steps = less * steps * (step - (steps + 1.0) / 2.0);
        steps_whole && profile::stopping_distance(from, limits).abs() > way && in_steps <= way + ROUNDING
    }

    /// Returns the limit beyond which `next` itself is, further out than the last motion: true for the upper one. A
    /// slow motion stops within a cycle, so that its stopping distance does not reveal the limit. A plan that ends or
    /// turns back was checked as a whole, and so was a trajectory that is followed exactly: they are checked here only
    /// for rounding and added motions.
    fn crossed_limit(&self, next: Motion, is_added: bool) -> Option<bool> {
        let is_exact = |up: bool| match self.motion.generator() {
            Generator::Plan(course) if is_added => course.end_velocity() != 0.0,
            Generator::Plan(course) => is_towards(up, course.end_velocity()),
            Generator::Follow(_) => true,
            Generator::Track(_) => !self.is_on_track(),
            Generator::Rest | Generator::Open { .. } | Generator::OutAn { .. } | Generator::Coast { .. } => false,
        };
        [true, false].into_iter().find(|up| {
            let outwards = |place: Position| if *up { place } else { -place };
            let limit = outwards(Position::whole(self.limit(*up)));
            let (now, next) = (outwards(self.command.position()), outwards(next.position));
            let bound = limit + Position::from_f64(planned_motion::ROUNDING);
            if !is_exact(*up) {
                return next > now && next > bound && now <= bound;
            }
            // An axis that is moved back from beyond a limit may jitter with its leader, but not creep further out.
            let inmost =
                self.travel.at_limits().beyond.filter(|beyond| beyond.up == *up).map(|beyond| outwards(beyond.inmost));
            let bound = inmost.map_or(limit, |inmost| inmost + Position::from_f64(1.0 + self.uneven()));
            next > now && next > bound
        })
    }

    /// Whether no stop after `next` can lead beyond a limit. An axis beyond a limit needs the detailed check.
    #[inline]
    fn is_clear_of_limits(&self, next: Motion) -> bool {
        self.travel.at_limits().beyond.is_none() && self.is_far_from_limits(next)
    }

    /// Whether `next` is so far within the limits that no stop after it can lead beyond one. A stop with constant
    /// deceleration needs v^2 / 2 d, and one in whole steps less than twice that.
    #[inline]
    pub(in crate::axis) fn is_far_from_limits(&self, next: Motion) -> bool {
        let limits = &self.parameters.derived.largest;
        // A follower stops in whole steps, whatever its profile. Any other motion, also a superimposed motion at rest,
        // uses its profile.
        let is_constant = self.motion.follower().is_some() || limits.shape == Shape::Trapezoid;
        let most = next.velocity * next.velocity / limits.deceleration * 1.01 + 2.0;
        let here = next.position.floor();
        // Room to an increment.
        let room = |up: bool| {
            let limit = self.limit(up);
            (if up { limit.saturating_sub(here) } else { here.saturating_sub(limit) }) as f64
        };
        // NaN gives false.
        is_constant && room(true) > most && room(false) > most
    }

    /// Returns the difference between steps at constant speed of the leader (inc).
    fn uneven(&self) -> f64 {
        self.motion.follower().map_or(0.0, Follower::uneven)
    }

    /// Updates the state of an axis beyond a limit, and whether it is still at the limit that has stopped it.
    #[inline]
    fn watch_beyond(&mut self, cycle: u64) {
        if self.travel.at_limits().stopped.is_none() && self.is_within_limits(self.command.position()) {
            self.travel.at_limits_mut().beyond = None;
        } else {
            self.note_beyond(cycle);
        }
    }

    fn note_beyond(&mut self, cycle: u64) {
        let now = self.command.position();
        let stays = |stopped: Stopped, place| self.room(stopped.up, place) <= stopped.room + self.rest_tolerance();
        self.travel.at_limits_mut().stopped =
            self.travel.at_limits().stopped.and_then(|stopped| match self.motion.generator() {
                // The stop is still active, and its end has changed or is closer to the limit than the axis is now.
                Generator::Plan(course) if self.status.state() == AxisState::ErrorStop && stopped.is_error => {
                    Some(Stopped { room: self.room(stopped.up, course.end()), ..stopped })
                }
                Generator::Plan(course) if stopped.is_told && self.streams() && course.end_velocity() == 0.0 => {
                    stays(stopped, course.end()).then_some(stopped)
                }
                _ => stays(stopped, now).then_some(stopped),
            });
        let up = match () {
            () if now > Position::whole(self.limit(true)) => Some(true),
            () if now < Position::whole(self.limit(false)) => Some(false),
            () => {
                self.travel.at_limits_mut().beyond = None;
                return;
            }
        };
        let before = self
            .travel
            .at_limits()
            .beyond
            .filter(|beyond| Some(beyond.up) == up && beyond.cycle.saturating_add(1) == cycle);
        self.travel.at_limits_mut().beyond = up.map(|up| {
            let inmost = before.map_or(now, |beyond| if up { beyond.inmost.min(now) } else { beyond.inmost.max(now) });
            Beyond { cycle, up, inmost }
        });
    }

    /// Returns the limit that a stop after `next` would pass: true for the upper one. A stop that first reduces its
    /// acceleration may turn back before it ends, so the limit ahead counts even if the stop ends behind its start.
    fn passed_limit(&self, next: Motion) -> Option<bool> {
        let end = self.stopping_distance(next);
        let (mut down, mut up) = (end.min(0.0), end.max(0.0));
        let limits = self.stop_limits();
        if next.velocity * next.acceleration < 0.0 && limits.shape != Shape::Trapezoid {
            let (low, high) = profile::stop(next, &limits, self.setup.cycle_ns).extent();
            (down, up) = (down.min((low - next.position).to_f64()), up.max((high - next.position).to_f64()));
        }
        let room = |up: bool| (Position::whole(self.limit(up)) - next.position).to_f64();
        // The limit ahead comes first.
        let beyond = |is_up: bool| {
            if is_up { up > 0.0 && room(true) + ROUNDING < up } else { down < 0.0 && room(false) - ROUNDING > down }
        };
        let first = next.velocity > 0.0;
        [first, !first].into_iter().find(|up| beyond(*up))
    }

    /// Returns the distance from `place` to the software limit in a direction.
    pub(in crate::axis) fn room(&self, up: bool, place: Position) -> Position {
        let limit = Position::whole(self.limit(up));
        if up { limit - place } else { place - limit }
    }

    /// Returns the software limit in a direction, or the end of the position range.
    #[inline]
    pub(in crate::axis) fn limit(&self, up: bool) -> i64 {
        // During homing the limits do not apply: they refer to the zero that homing is about to set.
        let holds = !self.homing.is_running();
        let limits = &self.parameters.derived;
        match (holds, up) {
            (true, true) => limits.high,
            (true, false) => limits.low,
            (false, true) => Position::LIMIT - 1,
            (false, false) => 1 - Position::LIMIT,
        }
    }

    /// Returns the limits of immediate stops (MACS-PROF-13). A coupling has no profile (MACS-PROF-07).
    pub(in crate::axis) fn stop_limits(&self) -> Limits {
        let limits = self.parameters.largest_limits();
        match self.motion.generator() {
            Generator::Follow(_) | Generator::Track(_) => Limits { shape: Shape::Trapezoid, ..limits },
            // Maxima that were lowered during the motion apply from the next motion on.
            Generator::Plan(course) => limits.at_least(&course.limits),
            _ => limits,
        }
    }

    /// Returns the signed stopping distance after `next`. A profile stops in continuous time. A coupled axis makes
    /// whole steps, and one step may be a count more than the speed of its leader: only the speed that the leader
    /// surely has counts.
    pub(in crate::axis) fn stopping_distance(&self, next: Motion) -> f64 {
        let limits = self.stop_limits();
        match self.motion.follower() {
            Some(follower) if !self.is_on_track() => {
                let cycle_s = self.cycle_s();
                let less = limits.deceleration * cycle_s * cycle_s;
                let step = (next.velocity.abs() * cycle_s - follower.excess(next.velocity, less)).max(0.0);
                let steps = (step / less * (1.0 + 1e-9)).floor();
                // The position of the leader is exact only to a count, too.
                let way = (steps * step - less * steps * (steps + 1.0) / 2.0 - follower.uneven()).max(0.0);
                way * next.velocity.signum()
            }
            _ => profile::stopping_distance(next, &limits),
        }
    }

    /// Returns a plan to rest at `target` ahead, without exceeding the present velocity or the target. If the profile
    /// allows no stop there, the axis turns back before the target and stops as near as it can. If it does not allow
    /// that either, the deceleration is constant: this stops before the target from every motion that could.
    fn plan_stop_at(&self, from: Motion, target: Position, limits: &Limits) -> Plan {
        let constant = || profile::stop_at(from, target, self.setup.cycle_ns);
        if limits.shape == Shape::Trapezoid {
            return constant();
        }
        let limits = Limits { velocity: from.velocity.abs(), ..*limits };
        let plan_to = |end: Position| {
            let plan = profile::to_rest(from, end, &limits, self.setup.cycle_ns);
            self.passed_by(&plan, from).is_none().then_some(plan)
        };
        if let Some(plan) = plan_to(target) {
            return plan;
        }
        let Some(mut best) = plan_to(from.position) else { return constant() };
        let (mut near, mut far) = (from.position, target);
        for _ in 0..16 {
            let middle = Position::from_raw(near.raw() / 2 + far.raw() / 2);
            match plan_to(middle) {
                Some(plan) => (best, near) = (plan, middle),
                None => far = middle,
            }
        }
        best
    }

    /// Returns the earliest position at which the axis can come to rest from its present motion.
    fn earliest_rest(&self) -> Position {
        profile::stop(self.present_motion(), &self.stop_limits(), self.setup.cycle_ns).end()
    }

    /// Returns lowest and highest position that the active motion, the superimposed motion and the waiting goals will
    /// reach, or cannot avoid. None at rest.
    pub fn reach(&self) -> Option<(i64, i64)> {
        if self.homing.is_running() {
            return None;
        }
        let now = self.command.position();
        let stopping = match self.motion.generator() {
            Generator::Plan(course) if course.end_velocity() != 0.0 => Some(self.earliest_rest()),
            Generator::Follow(_) | Generator::Track(_) => Some(self.earliest_rest()),
            Generator::Rest if self.coupling.overlay().is_some() => Some(now),
            // The end of a coasting axis is unknown.
            _ => None,
        };
        let stopping = stopping.map(|rest| (now.min(rest), now.max(rest)));
        let tracked = self.track_extent();
        let (low, high) = [stopping, self.known_reach(), tracked].into_iter().flatten().reduce(union)?;
        let (down, up) = self.overlay_ahead();
        Some(((low + down).floor(), (high + up).ceil()))
    }

    /// Returns lowest and highest position of the plan and of the waiting goals, without superimposed motion. None: no
    /// position is known.
    pub(super) fn known_reach(&self) -> Option<(Position, Position)> {
        let (way, target) = match self.motion.generator() {
            Generator::Plan(course) => {
                let ends = course.end_velocity() == 0.0;
                // A goal that passes its target with a velocity needs room to stop.
                let passing = Motion { velocity: course.pass, ..Motion::default() };
                let way = Position::from_f64(profile::stopping_distance(passing, &self.stop_limits()));
                let target = match course.aim {
                    Aim::Target(target) => Some((target.min(target + way), target.max(target + way))),
                    Aim::Velocity(_) | Aim::Stop => None,
                };
                (ends.then(|| course.extent_from(self.command.position())), target)
            }
            _ => (None, None),
        };
        let ends = self.waiting_ends().flatten().map(|end| Position::whole(end.nearest()));
        let places = ends.map(|place| (place, place));
        way.into_iter().chain(target).chain(places).reduce(union)
    }

    /// Returns a plan to rest with `limits`, or with higher rates if they are necessary to stay within the limit.
    pub(in crate::axis) fn plan_stop(&self, from: Motion, limits: &Limits) -> Plan {
        let is_up = from.velocity > 0.0;
        // Change of velocity per cycle (inc per cycle).
        let less = self.stop_limits().deceleration * self.cycle_s() * self.cycle_s();
        let uneven = self.uneven();
        let most = less + uneven + (2.0 * uneven * less).sqrt() + ROUNDING;
        let ends_here = from.velocity.abs() * self.cycle_s() <= most;
        if from.velocity != 0.0 && ends_here && from.position == Position::whole(self.limit(is_up)) {
            // There is no room left to stop, because the motion is slow or the counts are coarse.
            return profile::stop(Motion::at_rest(from.position), limits, self.setup.cycle_ns);
        }
        let plan = profile::stop(from, limits, self.setup.cycle_ns);
        let Some(up) = self.passed_by(&plan, from) else { return plan };
        let sharpest = self.with_raised_jerk(from, self.stop_limits());
        let limit = Position::whole(self.limit(up));
        if is_towards(up, from.velocity) {
            return self.plan_stop_at(from, limit, &sharpest);
        }
        // Its acceleration would make it turn back beyond the limit behind it: a stop without jerk limit does not.
        let plan = profile::stop(from, &Limits { shape: Shape::Trapezoid, ..sharpest }, self.setup.cycle_ns);
        match self.passed_by(&plan, from) {
            Some(up) => profile::stop_at(from, Position::whole(self.limit(up)), self.setup.cycle_ns),
            None => plan,
        }
    }

    /// Returns the limit that a plan from `from` passes: true for the upper one. A plan that starts beyond a limit does
    /// not count.
    fn passed_by(&self, plan: &Plan, from: Motion) -> Option<bool> {
        let (low, high) = plan.extent();
        let (lowest, highest) = (Position::whole(self.limit(false)), Position::whole(self.limit(true)));
        match () {
            () if high > highest && from.position < highest => Some(true),
            () if low < lowest && from.position > lowest => Some(false),
            () => None,
        }
    }
}

/// Whether a velocity leads up, or down.
fn is_towards(up: bool, velocity: f64) -> bool {
    if up { velocity > 0.0 } else { velocity < 0.0 }
}

/// Returns the range that contains both ranges.
fn union(one: (Position, Position), other: (Position, Position)) -> (Position, Position) {
    (one.0.min(other.0), one.1.max(other.1))
}

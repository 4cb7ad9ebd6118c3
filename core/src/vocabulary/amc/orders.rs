//! Orders of the single references, and the stop reference.

use super::check::POSITION_REFERENCE;
use super::parameters::POSITION_RELATIVE;
use super::rotary::{Circle, Exact, Mode};
use super::{Amc, Problem};
use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::profile::{self, Limits, Motion};
use crate::state::Reference;
use crate::vocabulary::{Order, View};

/// Cycles by which a software limit is anticipated, so that a stop with the maximum deceleration still ends at it.
const AHEAD_CYCLES: f64 = 2.0;

/// Returns 34.002, the position at which the axis would stop (AMC-STP-02, AMC-STP-03), in whole increments like every
/// axis at rest.
pub(super) fn stop_reference(view: &View<'_>) -> Position {
    if !stops_by_profile(view) {
        return Position::whole(view.actual.position.floor());
    }
    let end = profile::stop(view.present, &view.largest_limits(), view.cycle_ns).end();
    let now = view.command.position;
    let p = view.parameters;
    // The stop ends at the limit if that is nearer.
    let end = match (p.min_position.map(Position::whole), p.max_position.map(Position::whole)) {
        (_, Some(high)) if end > high && now < high => high,
        (Some(low), _) if end < low && now > low => low,
        _ => end,
    };
    Position::whole(end.floor())
}

fn stops_by_profile(view: &View<'_>) -> bool {
    let p = &view.parameters.vocabularies.amc;
    let mode = if view.at_limit { p.software_limit_stop_mode } else { p.stop_mode };
    mode % 2 == 0
}

impl Amc {
    /// Reference 0 (AMC-STP-02..05): the stop reference of this sample (M03) becomes the target (M09).
    pub(super) fn begin_stop(&mut self, view: &View<'_>) -> Order {
        self.stop = stop_reference(view);
        self.input = Circle::new(view.modulo).exact(self.stop);
        if stops_by_profile(view) { Order::Stop { limits: view.largest_limits() } } else { Order::HoldActualPosition }
    }

    /// Adds a change of position to PIP according to the rotary mode. Returns the order to move there.
    pub(super) fn add(&mut self, view: &View<'_>, wanted: Exact, enters: bool) -> Result<Option<Order>, Problem> {
        let circle = Circle::new(view.modulo);
        let mode = Mode::new(self.rotary_mode, view.modulo, view.cycle_ns);
        let added = circle.added(mode, wanted, self.input);
        let input = self.input.plus(added);
        let asked = Number::Position(self.reference);
        let refuse = |code, limit| Err(Problem { row: POSITION_REFERENCE, code, asked, limit });
        if !circle.is_legal(input) {
            return refuse(Code::POSITION_OUT_OF_RANGE, Number::None);
        }
        // AMC-ROT-04: within the integrators of input, output and slave.
        if let Some(turns) = circle.capacity(view.unit) {
            let others = [view.command.position, view.actual.position].map(|position| circle.exact(position));
            if others.iter().any(|other| circle.exceeds(input.minus(*other), turns)) {
                return refuse(Code::AMC_TURN_CAPACITY, Number::Count(turns));
            }
        }
        if input == self.input && !enters {
            return Ok(None);
        }
        self.input = input;
        Ok(self.go(view))
    }

    /// Returns the order to move to PIP; `None` if the present motion ends there.
    pub(super) fn go(&self, view: &View<'_>) -> Option<Order> {
        let target = Circle::new(view.modulo).nearest(self.input);
        let is_there = Position::whole(view.target.floor()) == target && (view.rests || view.has_end);
        // A phase of homing has an end of its own.
        if view.owns && !view.homing && is_there {
            return None;
        }
        let reference = match self.select {
            POSITION_RELATIVE => Reference::PositionRelative,
            super::POSITION_PROFILE => Reference::PositionProfile,
            _ => Reference::PositionAbsolute,
        };
        Some(Order::Position { target, limits: view.largest_limits(), reference })
    }

    /// Reference 2: a speed; near a software limit, a position at the limit (AMC-SEL-09: the reference stays selected).
    pub(super) fn run(&mut self, view: &View<'_>, changed: bool) -> Option<Order> {
        let velocity = self.speed;
        let limits = Limits { velocity: view.parameters.max_velocity, ..view.largest_limits() };
        let was_limited = std::mem::replace(&mut self.limited, false);
        if let Some(limit) = limit_in(view, velocity)
            && exceeds_limit(view, velocity, limit, &limits)
        {
            self.limited = true;
            if was_limited && !changed {
                return None;
            }
            let is_ahead = (limit > view.command.position) == (velocity > 0.0) && limit != view.command.position;
            if !is_ahead {
                return Some(Order::Stop { limits: view.largest_limits() });
            }
            let limits = Limits { velocity: velocity.abs(), ..limits };
            return Some(Order::Position { target: limit, limits, reference: Reference::Speed });
        }
        (changed || was_limited).then_some(Order::Velocity { velocity, limits })
    }
}

/// Returns the software limit in the direction of a velocity.
fn limit_in(view: &View<'_>, velocity: f64) -> Option<Position> {
    let limit = match velocity {
        v if v > 0.0 => view.parameters.max_position,
        v if v < 0.0 => view.parameters.min_position,
        _ => None,
    };
    limit.map(Position::whole)
}

/// Returns true if a stop that begins a few cycles later, at the maximum speed possible by then, would end beyond the
/// limit.
fn exceeds_limit(view: &View<'_>, velocity: f64, limit: Position, limits: &Limits) -> bool {
    let sign = velocity.signum();
    let time = AHEAD_CYCLES * view.cycle_ns as f64 / 1e9;
    let now = (sign * view.present.velocity).max(0.0);
    let speed = (now + limits.acceleration * time).min(now.max(velocity.abs()));
    let then = Motion {
        position: view.command.position + Position::from_f64(sign * speed * time),
        velocity: sign * speed,
        acceleration: if speed > now { sign * limits.acceleration } else { view.present.acceleration },
        jerk: 0.0,
    };
    sign * (profile::stop(then, limits, view.cycle_ns).end() - limit).to_f64() > 0.0
}

//! Limited jerk: the fastest change of motion within limits of velocity, acceleration, deceleration and four jerks.
//!
//! Law      each ramp rises to its acceleration with one jerk, holds, and falls to zero with another; the plan to a
//!          target is the fastest one within these limits. If the limits for increasing and decreasing |velocity| are
//!          equal, it passes through zero without a stop; otherwise it reverses at rest
//! Reads    the motion at the start, including its acceleration
//! Writes   a plan that ends exactly at the target, or continues at a velocity without end
//! Refuses  nothing: the caller has checked that all limits are finite and above 0
//! Source   MACS-PROF-10..12, as interpreted in A-21

mod climb;
mod ramp;

use super::plan::{Draft, Plan};
use super::{Jerks, Limits, Motion, distance, is_met};
use crate::position::Position;
use climb::{Choice, Climb};
use ramp::{Ease, Ramp, Side};

/// Acceleration limits while |velocity| increases and decreases.
#[derive(Clone, Copy, Debug)]
struct Sides {
    grow: Side,
    brake: Side,
    /// Whether both are equal.
    even: bool,
}

/// Velocity and acceleration.
#[derive(Clone, Copy, Debug)]
struct State {
    velocity: f64,
    acceleration: f64,
}

impl State {
    fn times(&self, sign: f64) -> Self {
        Self { velocity: sign * self.velocity, acceleration: sign * self.acceleration }
    }

    /// Returns the sign of its present or next velocity; 0 at rest.
    fn direction_of_velocity(&self) -> f64 {
        let leading = if self.velocity == 0.0 { self.acceleration } else { self.velocity };
        if leading == 0.0 { 0.0 } else { 1.0_f64.copysign(leading) }
    }
}

/// The first phases of a plan for any target: an acceleration beyond its limit, or one that leads through zero, is
/// reduced.
#[derive(Clone, Copy, Debug)]
struct Entry {
    eases: [Option<Ease>; 2],
    state: State,
}

impl Entry {
    fn way(&self) -> f64 {
        self.eases.iter().flatten().map(|ease| ease.way).sum()
    }

    fn add(&self, draft: &mut Draft<'_>) {
        for ease in self.eases.iter().flatten() {
            ease.add(draft, 1.0);
        }
    }
}

impl Sides {
    fn new(limits: &Limits, jerks: &Jerks) -> Self {
        let even = limits.acceleration == limits.deceleration
            && [jerks.fall, jerks.brake_rise, jerks.brake_fall].iter().all(|jerk| *jerk == jerks.rise);
        let grow = Side::new(limits.acceleration, jerks.rise, jerks.fall);
        let brake = if even { grow } else { Side::new(limits.deceleration, jerks.brake_rise, jerks.brake_fall) };
        Self { grow, brake, even }
    }

    fn enter(&self, start: Motion) -> Entry {
        let mut state = State { velocity: start.velocity, acceleration: start.acceleration };
        let mut eases = [None; 2];
        let State { velocity, acceleration } = state;
        let brakes = velocity * acceleration < 0.0;
        if !self.even && brakes && self.brake.fall_off(acceleration) > velocity.abs() {
            let rest = (acceleration * acceleration - 2.0 * self.brake.fall * velocity.abs()).max(0.0).sqrt();
            let rest = rest.copysign(acceleration);
            eases[0] = Some(Ease::new(velocity, acceleration, rest, &self.brake));
            state = State { velocity: 0.0, acceleration: rest };
        }
        let side = if state.velocity * state.acceleration < 0.0 { &self.brake } else { &self.grow };
        if state.acceleration.abs() > side.limit {
            let limit = side.limit.copysign(state.acceleration);
            let ease = Ease::new(state.velocity, state.acceleration, limit, side);
            state = State { velocity: state.velocity + ease.change(), acceleration: limit };
            eases[1] = Some(ease);
        }
        Entry { eases, state }
    }

    /// Returns the task from `state` to `end_velocity`, both with the sign `side`.
    fn climb(&self, state: State, end_velocity: f64, top: f64, side: f64) -> Climb<'_> {
        let (up, down) = if side < 0.0 { (&self.brake, &self.grow) } else { (&self.grow, &self.brake) };
        Climb::new((state.velocity, state.acceleration), end_velocity, top, (up, down))
    }

    /// Returns the ramp from rest to a velocity.
    fn ramp_to(&self, velocity: f64) -> Ramp<'_> {
        Ramp::new(&self.grow, 1.0_f64.copysign(velocity), 0.0, 0.0, velocity.abs(), velocity)
    }

    /// Returns the direct way to a velocity: without change of sign, or to rest and from there.
    fn direct(&self, state: State, velocity: f64) -> (Climb<'_>, Option<Ramp<'_>>) {
        let side = state.direction_of_velocity();
        if self.even || side * velocity >= 0.0 {
            let side = if side == 0.0 { velocity } else { side };
            (self.climb(state, velocity, f64::MAX, side), None)
        } else {
            (self.climb(state, 0.0, f64::MAX, side), Some(self.ramp_to(velocity)))
        }
    }
}

fn way(climb: &Climb<'_>, rest: Option<&Ramp<'_>>) -> f64 {
    climb.direct_way() + rest.map_or(0.0, Ramp::distance)
}

/// As [`super::to_pass`].
pub(super) fn to_pass(
    start: Motion,
    target: Position,
    end_velocity: f64,
    limits: &Limits,
    jerks: &Jerks,
    cycle_ns: u64,
) -> Plan {
    let sides = Sides::new(limits, jerks);
    let mut plan = Plan::new(start.position, cycle_ns);
    let mut draft = Draft::new(&mut plan);
    let entry = sides.enter(start);
    entry.add(&mut draft);
    let ahead = distance(start.position, target) - draft.way;
    let (climb, rest) = sides.direct(entry.state, end_velocity);
    let direct = way(&climb, rest.as_ref());
    let sign = 1.0_f64.copysign(ahead - direct);
    if is_met(ahead, direct) {
        if let Some(ramp) = rest {
            ramp.add_backward(&mut draft, 1.0);
        }
        climb.add(&mut draft, 1.0, Choice::Direct);
    } else if sides.even {
        let climb = sides.climb(entry.state.times(sign), sign * end_velocity, limits.velocity, 1.0);
        let choice = climb.solve(sign * ahead, sign * direct).unwrap_or(Choice::Direct);
        climb.add(&mut draft, sign, choice);
    } else {
        upwards(&mut draft, sign, entry.state.times(sign), sign * end_velocity, limits.velocity, &sides, sign * ahead);
    }
    draft.finish(Some(target), end_velocity);
    plan
}

/// Plans the way to a target `ahead`, which is above the end of the direct way to the end velocity, with velocity zero
/// passed only at rest. Signs in the draft are multiplied by `sign`.
fn upwards(draft: &mut Draft<'_>, sign: f64, mut state: State, mut end: f64, top: f64, sides: &Sides, mut ahead: f64) {
    let is_below = state.direction_of_velocity() < 0.0;
    if is_below && end < 0.0 {
        let climb = sides.climb(state, end, 0.0, -1.0);
        if let Some(choice) = climb.solve(ahead, climb.direct_way()) {
            return climb.add(draft, sign, choice);
        }
    }
    if is_below {
        let climb = sides.climb(state, 0.0, 0.0, -1.0);
        climb.add_direct(draft, sign);
        ahead -= climb.direct_way();
        state = State { velocity: 0.0, acceleration: 0.0 };
    }
    if end < 0.0 {
        let ramp = sides.ramp_to(end);
        ramp.add_backward(draft, sign);
        ahead -= ramp.distance();
        end = 0.0;
    }
    let climb = sides.climb(state, end, top, 1.0);
    let direct = climb.direct_way();
    // The rest of the distance may be only rounding.
    let choice = if is_met(ahead, direct) { None } else { climb.solve(ahead, direct) };
    climb.add(draft, sign, choice.unwrap_or(Choice::Direct));
}

/// As [`super::to_velocity`].
pub(super) fn to_velocity(start: Motion, velocity: f64, limits: &Limits, jerks: &Jerks, cycle_ns: u64) -> Plan {
    let sides = Sides::new(limits, jerks);
    let mut plan = Plan::new(start.position, cycle_ns);
    let mut draft = Draft::new(&mut plan);
    let entry = sides.enter(start);
    entry.add(&mut draft);
    let (climb, rest) = sides.direct(entry.state, velocity);
    match rest {
        // A stop is evaluated from its end, so that it ends smoothly from any velocity.
        None if velocity == 0.0 => climb.add(&mut draft, 1.0, Choice::Direct),
        None => climb.add_direct(&mut draft, 1.0),
        Some(ramp) => {
            climb.add_direct(&mut draft, 1.0);
            ramp.add_forward(&mut draft, 1.0);
        }
    }
    draft.finish(None, velocity);
    plan
}

/// As [`super::stopping_distance`].
pub(super) fn stopping_distance(start: Motion, limits: &Limits, jerks: &Jerks) -> f64 {
    let sides = Sides::new(limits, jerks);
    let entry = sides.enter(start);
    let (climb, rest) = sides.direct(entry.state, 0.0);
    entry.way() + way(&climb, rest.as_ref())
}

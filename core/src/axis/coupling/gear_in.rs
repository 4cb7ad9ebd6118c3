//! A gear that begins at a latch, or so that leader and axis reach a pair of positions together (MC_GearInPos).
//!
//! Law      at a latch: target = position of the axis at the end of that cycle + ratio * (leader - leader at the
//!          latch), to 2^-32 inc. If the axis was already geared to the same leader, it continues from its position in
//!          that gear at the latch. In position: an [`Approach`] over the start distance begins where the leader passes
//!          its start, also between two cycles, with position, velocity and acceleration of the axis. Without a
//!          distance the axis catches up with the gear of the pair. On an axis with modulo the pair is in the turn to
//!          which the mean of both slopes leads, or in the nearest one
//! Reads    the leader of this cycle; the mean speed of a counted leader in the last cycles
//! Refuses  a leader beyond its start, a distance too short for velocity and acceleration of the goal, an approach that
//!          moves backward against revers. It checks at the request if the leader moves, is not counted, and the axis
//!          is at rest, and again when the gear begins
//! Source   contract section 7, PLCopen (MC_GearInPos), AMC-EVT-05

use crate::axis::state::pair::Pair;
use crate::axis::state::{Axis, Generator, Started};
use crate::code::Code;
use crate::command::Synchronize;
use crate::encoder::Lead;
use crate::event::{Number, Refusal};
use crate::modulo::{Direction, Modulo};
use crate::parameter::ReversingRule;
use crate::position::Position;
use crate::sync::approach::{Approach, Begin, Shape, sufficient_length};
use crate::sync::follower::{Bounds, Follower, Phase};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{SyncMode, Transmission};
use crate::table::Table;
use std::sync::Arc;

/// Factor by which the rounding of a curve may exceed a limit.
const SLACK: f64 = 1.0 + 1e-9;

/// Data for the checks of a curve.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct CurveData {
    pub ratio: Ratio,
    /// Speed of the leader (inc per cycle).
    pub speed: f64,
    /// Motion of the axis at the start.
    pub from: Begin,
    pub bounds: Bounds,
}

impl Axis {
    /// Checks whether the axis may wait for that pair. A leader or axis in motion is checked again when the gear
    /// begins.
    pub(super) fn check_pair(&self, pair: Pair, request: &Synchronize, lead: Lead) -> Result<(), Refusal> {
        self.passed_start(pair, lead)?;
        // One change of a counted leader does not give its speed.
        let is_even = lead.uneven == 0.0;
        if pair.distance == 0
            || !is_even
            || !pair.is_ahead(lead)
            || !matches!(*self.motion.generator(), Generator::Rest)
        {
            return Ok(());
        }
        let from = Begin { place: self.command.position(), slope: 0.0, bend: 0.0 };
        let (ratio, bounds) = (self.ratio_of(request)?, self.bounds_of(request)?);
        self.approach(pair, CurveData { ratio, speed: lead.change.to_f64(), from, bounds }).map(|_| ())
    }

    /// Returns the distance of the leader after the start of a pair that it has passed in this cycle.
    pub(in crate::axis) fn passed_start(&self, pair: Pair, lead: Lead) -> Result<Option<Position>, Refusal> {
        let refuse = |(missing, distance)| self.refuse(Code::ENGAGE_PASSED).with(missing, distance);
        if pair.distance == 0 { Ok(None) } else { pair.passed_start(lead).map_err(refuse) }
    }

    /// Returns the follower of a gear that began when its leader was `after` before its present position.
    pub(super) fn engaged_gear(
        &self,
        tables: &[Arc<Table>],
        request: &Synchronize,
        started: Started,
    ) -> Result<Follower, Refusal> {
        let Started { leader, lead, after, .. } = started;
        let (bounds, present, led) =
            (self.bounds_of(request)?, self.present_motion(), self.leading_distance(request.mode));
        let new = |transmission, target: Position| {
            let offset = target + led - present.position;
            Follower::new(lead.uneven, transmission, request.mode, present, offset, bounds).leading_by(led)
        };
        let stands = present.position - led;
        if request.mode == SyncMode::Velocity {
            let (transmission, _) = self.gear_of(request)?;
            return Ok(new(transmission, present.position));
        }
        let ratio = self.ratio_of(request)?;
        let before = self.follows_by_position(leader);
        let back = before.map(|before| {
            let mut old = *before.transmission();
            let way = old.step(Lead { change: -after, ..Lead::default() }, tables);
            (before, Begin { place: before.place() + way, slope: old.signed_slope(), bend: 0.0 }, old)
        });
        let (transmission, target, goes_on) = match Pair::of(request.engage) {
            Some(pair) if pair.distance == 0 => {
                let mut gear = Gear::new(ratio);
                let way = gear.step(after);
                let slave = self.nearest_in_turn(pair.slave, stands - way);
                (Transmission::Gear(gear), slave + way, false)
            }
            Some(pair) => {
                let on_leader = back.filter(|(before, ..)| before.phase() != Phase::CatchingUp);
                let speed = started.speed();
                let from = on_leader.map_or_else(|| self.motion_at_start(stands, speed, after), |(_, from, _)| from);
                let approach = self.approach(pair, CurveData { ratio, speed, from, bounds })?;
                let mut transmission = Transmission::Approach(approach);
                let target = from.place + transmission.step(Lead { change: after, ..Lead::default() }, tables);
                if on_leader.is_none() {
                    return Ok(new(transmission, target).passing());
                }
                (transmission, target, true)
            }
            None => {
                let (stands, mut gear, is_same) = match back {
                    Some((_, from, Transmission::Gear(old))) => {
                        (from.place, old.with_ratio(ratio), old.ratio() == ratio)
                    }
                    Some((_, from, _)) => (from.place, Gear::new(ratio), false),
                    None => (stands, Gear::new(ratio), false),
                };
                let offset = request.offset.exact();
                let target = stands + offset + gear.step(after);
                (Transmission::Gear(gear), target, is_same && offset == Position::ZERO)
            }
        };
        Ok(match before {
            Some(before) => before.handed_over(transmission, target, bounds, goes_on),
            None => new(transmission, target),
        })
    }

    /// Returns the motion of an axis, now at `stands`, when the leader was `after` before its present position, as a
    /// function of the leader with `speed` increments per cycle.
    fn motion_at_start(&self, stands: Position, speed: f64, after: Position) -> Begin {
        let (present, cycle_s) = (self.present_motion(), self.cycle_s());
        let slope = present.velocity * cycle_s / speed;
        let bend = present.acceleration * cycle_s * cycle_s / speed / speed;
        let after = after.to_f64();
        let way = Position::from_f64(slope * after - bend * after * after / 2.0);
        Begin { place: stands - way, slope: slope - bend * after, bend }
    }

    /// Returns the approach to a pair.
    ///
    /// # Errors
    /// The axis must not, or cannot, follow it.
    pub(in crate::axis) fn approach(&self, pair: Pair, way: CurveData) -> Result<Approach, Refusal> {
        let geared = way.speed.abs() / self.cycle_s() * way.ratio.to_f64().abs();
        let most = way.bounds.max_velocity;
        if geared > most * SLACK {
            let numbers = (Number::Velocity(geared), Number::Velocity(most));
            return Err(self.refuse(Code::VELOCITY_TOO_HIGH).with(numbers.0, numbers.1));
        }
        let (approach, shape) =
            self.approach_over(pair, pair.distance, way).ok_or_else(|| self.refuse(Code::BAD_REQUEST))?;
        if !self.leads_forward(&approach, way.speed) {
            return Err(self.refuse(Code::REVERSE_FORBIDDEN).with(Number::Position(pair.slave), Number::None));
        }
        if self.can_follow(shape, way) {
            return Ok(approach);
        }
        let fits = |distance| {
            let longer = self.approach_over(pair, distance, way);
            longer.is_some_and(|(longer, shape)| self.leads_forward(&longer, way.speed) && self.can_follow(shape, way))
        };
        let enough = sufficient_length(pair.distance, fits).map_or(Number::None, Number::Count);
        Err(self.refuse(Code::ENGAGE_TOO_SHORT).with(Number::Count(pair.distance), enough))
    }

    fn approach_over(&self, pair: Pair, distance: i64, way: CurveData) -> Option<(Approach, Shape)> {
        let CurveData { ratio, speed, from, .. } = way;
        let length = if speed < 0.0 { -distance } else { distance };
        let even = (from.slope + ratio.to_f64()) / 2.0 * length as f64;
        let slave = self.nearest_in_turn(pair.slave, from.place + Position::from_f64(even));
        Approach::new(ratio, length, Begin { place: from.place - slave, ..from })
    }

    /// Returns the position in the turn nearest to `near`; without modulo the position itself.
    fn nearest_in_turn(&self, place: i64, near: Position) -> Position {
        let place = Position::whole(place);
        let target = |modulo: Modulo| modulo.target(place, near, near, Direction::Shortest, 0.0);
        self.setup.modulo.map_or(place, target)
    }

    /// Whether the axis can follow that curve at that speed of the leader. Velocity and acceleration that it already
    /// has count as possible.
    pub(super) fn can_follow(&self, shape: Shape, way: CurveData) -> bool {
        let (present, speed) = (self.present_motion(), way.speed.abs() / self.cycle_s());
        let steepest = shape.most.max(-shape.least);
        let geared = speed * way.ratio.to_f64().abs();
        let velocity = way.bounds.velocity.max(geared).max(present.velocity.abs());
        let acceleration = way.bounds.acceleration.max(present.acceleration.abs());
        speed * steepest <= velocity * SLACK && speed * speed * shape.bend <= acceleration * SLACK
    }

    /// Whether the curve never moves backward, except where revers allows it because the leader reverses.
    pub(super) fn leads_forward(&self, approach: &Approach, speed: f64) -> bool {
        match self.parameters.reversing().rule {
            ReversingRule::Always => true,
            ReversingRule::WithMaster => approach.keeps_sign(approach.ratio().to_f64()),
            ReversingRule::Never => approach.keeps_sign(speed),
        }
    }
}

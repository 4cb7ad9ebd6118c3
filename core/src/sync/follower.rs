//! A coupled axis: it accelerates to its leader, catches up the lost distance, and then follows exactly.
//!
//! Law      coupled: slave(k) = slave(k-1) + gear(master change of k).
//!          catching up (mode position): velocity = geared master velocity + w, where w is the largest velocity from
//!          which the slave can still slow down to the master with its acceleration in whole cycles without passing it.
//!          With e the distance to catch up and d the change of velocity in a cycle (all in inc per cycle), n the least
//!          number with e <= d (n + 1)(n + 2) / 2:
//!          w = e / (n + 1) + d n / 2; it arrives after exactly n + 1 cycles.
//!          ahead: the leading position is geared(k) + ahead * (geared(k) - geared(k-1)). While catching up the
//!          velocity can be kept in a band around that of the leader, which is 0 for a leader at rest
//! Reads    the change of the leader; the last motion of the slave; added motions
//! Writes   the motion of the slave, to 2^-32 inc
//! Refuses  nothing here: ratio, velocity and acceleration were checked by the axis
//! Source   MACS-SYNC-02, -04, -06, -07, -12, -15, A-30

use super::gear::Gear;
use super::{Stepped, SyncMode, Transmission};
use crate::encoder::Lead;
use crate::parameter::ReversingRule;
use crate::position::Position;
use crate::profile::Motion;
use crate::table::Table;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Phase of a coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// The slave accelerates or catches up.
    CatchingUp,
    /// The slave follows exactly.
    Synchronized,
    /// The slave followed the transmission before exactly, and follows this one from the next cycle on.
    Passing,
}

/// Limits of the slave (inc/s, inc/s^2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Velocity while catching up.
    pub velocity: f64,
    /// Acceleration while catching up.
    pub acceleration: f64,
    /// Largest velocity in any phase.
    pub max_velocity: f64,
    /// Largest acceleration in any phase.
    pub max_acceleration: f64,
    /// Largest deceleration in any phase.
    pub max_deceleration: f64,
}

/// Motions added to the slave in addition to the output of its transmission.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AddedMotion {
    /// Distance of this cycle.
    pub way: Position,
    /// Part of the change of the leader that is not its own motion.
    pub added: Position,
    /// Cycles of its geared velocity by which the slave leads.
    pub ahead: f64,
    /// Velocity band while it catches up; none: no band.
    pub band: Option<Band>,
}

/// A velocity band around that of a leader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Geared velocity of the leader (inc per cycle).
    pub velocity: f64,
    /// Half width of the band, as a share of the velocity, 0 to 1.
    pub share: f64,
}

impl Band {
    fn clamp(self, velocity: f64) -> f64 {
        let (slow, fast) = (self.velocity * (1.0 - self.share), self.velocity * (1.0 + self.share));
        velocity.max(slow.min(fast)).min(fast.max(slow))
    }
}

/// Part of the limits that is reserved for a motion superimposed on the coupling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reserve {
    /// Reserved velocity (inc/s).
    pub velocity: f64,
    /// Reserved acceleration (inc/s^2).
    pub acceleration: f64,
}

impl Bounds {
    fn reduced_by(self, reserve: Reserve) -> Self {
        if reserve == Reserve::default() {
            let rate = self.max_acceleration.min(self.max_deceleration);
            let (velocity, acceleration) = (self.velocity.min(self.max_velocity), self.acceleration.min(rate));
            return Self { velocity, acceleration, ..self };
        }
        // Never 0, as it is used as a divisor.
        let left = |most: f64, reserve: f64| (most - reserve).max(most * 1e-6);
        Self {
            velocity: self.velocity.min(left(self.max_velocity, reserve.velocity)),
            acceleration: self
                .acceleration
                .min(left(self.max_acceleration.min(self.max_deceleration), reserve.acceleration)),
            max_velocity: left(self.max_velocity, reserve.velocity),
            max_acceleration: left(self.max_acceleration, reserve.acceleration),
            max_deceleration: left(self.max_deceleration, reserve.acceleration),
        }
    }
}

/// An axis that follows any lead.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Follower {
    mode: SyncMode,
    transmission: Transmission,
    phase: Phase,
    /// Position of the slave by the transmission.
    target: Position,
    /// Position at which the leader will stop abruptly, or a cam ends, if it is known: the slave slows down before it.
    halt: Option<Position>,
    bounds: Bounds,
    /// Unevenness of its lead (inc).
    lead_uneven: f64,
    /// Last changes by the transmission (inc), the newest first.
    recent: [f64; RECENT],
    /// Smoothed change by the transmission (inc).
    mean: f64,
    /// Number of changes in the mean, at most [`MEAN_CYCLES`].
    noted: u8,
    /// Distance by which it leads.
    led_by: Position,
    /// Whether the reversing rule has prevented backward motion in the last step.
    barred: bool,
    /// Whether its leader alone exceeded the limits in the last step.
    overtaken: bool,
}

/// A step with which the slave stays synchronized with its leader.
#[derive(Clone, Copy, Debug)]
pub struct Following {
    /// Next motion of the slave.
    pub motion: Motion,
    change: Position,
    /// Change by the transmission (inc).
    geared: f64,
}

/// Cycles over which the speed of a counted leader is smoothed.
const MEAN_CYCLES: u8 = 64;
/// Cycles from which the least speed of a counted leader is calculated.
const RECENT: usize = 8;

impl Follower {
    /// Whether the state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        let Bounds { velocity, acceleration, max_velocity, max_acceleration, max_deceleration } = self.bounds;
        let bounds = [velocity, acceleration, max_velocity, max_acceleration, max_deceleration];
        let is_uneven = self.lead_uneven >= 0.0 && self.lead_uneven.is_finite();
        is_uneven && self.transmission.is_sound() && bounds.iter().all(|bound| *bound > 0.0 && bound.is_finite())
    }

    /// Returns a follower that begins with an axis in motion `slave`. `offset` shifts it against the leader;
    /// `lead_uneven` is the unevenness of its lead (inc).
    pub fn new(
        lead_uneven: f64,
        transmission: Transmission,
        mode: SyncMode,
        slave: Motion,
        offset: Position,
        bounds: Bounds,
    ) -> Self {
        let (phase, target) = (Phase::CatchingUp, slave.position + offset);
        let (halt, recent) = (None, [0.0; RECENT]);
        let (led_by, barred, overtaken) = (Position::ZERO, false, false);
        Self {
            mode,
            transmission,
            phase,
            target,
            halt,
            bounds,
            lead_uneven,
            recent,
            mean: 0.0,
            noted: 0,
            led_by,
            barred,
            overtaken,
        }
    }

    /// Returns the follower synchronized with its leader from the first cycle on, as far as its limits allow.
    #[must_use]
    pub fn at_once(self) -> Self {
        Self { phase: Phase::Synchronized, ..self }
    }

    /// Returns the follower at its position by the transmission, except for the change of one cycle.
    #[must_use]
    pub fn passing(self) -> Self {
        Self { phase: Phase::Passing, ..self }
    }

    /// Returns the follower that already leads by that distance.
    #[must_use]
    pub fn leading_by(self, led_by: Position) -> Self {
        Self { led_by, ..self }
    }

    /// Returns the follower with another transmission from now on, with which the slave should be at `place`, without
    /// the distance by which it leads. If it `goes_on` from the transmission before, the slave gets there in one cycle,
    /// otherwise it catches up.
    #[must_use]
    pub fn handed_over(self, transmission: Transmission, place: Position, bounds: Bounds, goes_on: bool) -> Self {
        let is_there = self.phase != Phase::CatchingUp;
        let target = place + self.led_by;
        let phase = if is_there && goes_on { Phase::Passing } else { Phase::CatchingUp };
        // The changes by another transmission do not give the speed.
        Self { transmission, phase, target, halt: None, bounds, noted: 0, ..self }
    }

    /// Replaces the approach to a pair of positions by its gear, which takes over the present motion of the slave.
    pub fn replace_approach_by_gear(&mut self, slave: Motion) {
        if let Transmission::Approach(approach) = &self.transmission {
            self.transmission = Transmission::Gear(Gear::new(approach.ratio()));
            (self.phase, self.target) = (Phase::CatchingUp, slave.position);
        }
    }

    /// Sets whether the slave of a cam rests at the end of the table.
    pub fn rest_at_end(&mut self, rests: bool) {
        if let Transmission::Cam(cam) = &mut self.transmission {
            *cam = if rests { cam.resting() } else { cam.continuing_at_end() };
        }
    }

    /// Sets the position at which the leader will stop abruptly, while the slave is on the straight segment to it;
    /// none: unknown.
    pub fn set_halt(&mut self, halt: Option<Position>) {
        self.halt = halt;
    }

    /// Returns the follower with a distance of the leader that is already past and counts.
    #[must_use]
    pub fn with_past(mut self, past: Position, tables: &[Arc<Table>]) -> Self {
        self.target += self.transmission.step(Lead { change: past, ..Lead::default() }, tables);
        self
    }

    /// Returns the position of the slave by the transmission.
    pub fn target(&self) -> Position {
        self.target
    }

    /// Returns the position by the transmission alone, without the distance by which it leads.
    pub fn place(&self) -> Position {
        self.target - self.led_by
    }

    /// Returns the distance by which it leads, if it has reached that.
    pub fn leading_distance(&self) -> Position {
        if self.phase == Phase::CatchingUp { Position::ZERO } else { self.led_by }
    }

    /// Returns the mode.
    pub fn mode(&self) -> SyncMode {
        self.mode
    }

    /// Returns its transmission, with its remainder.
    pub fn transmission(&self) -> &Transmission {
        &self.transmission
    }

    /// Returns the unevenness of its changes (inc): one geared count for a counted leader.
    pub fn uneven(&self) -> f64 {
        if self.lead_uneven == 0.0 { 0.0 } else { self.lead_uneven * self.transmission.slope() }
    }

    /// Returns by how much the last change of the leader may exceed its speed in the direction of `way` (inc), if the
    /// speed decreases by at most `rate` (inc per cycle) per cycle. The distance over n cycles is exact to one count.
    pub fn excess(&self, way: f64, rate: f64) -> f64 {
        let (uneven, [last, ..]) = (self.uneven(), self.recent);
        let sign = way.signum();
        let mut sum = 0.0;
        let mut least = f64::NEG_INFINITY;
        for (cycles, change) in (1_u8..).map(f64::from).zip(self.recent) {
            sum += change * sign;
            least = least.max((sum - uneven) / cycles - rate * (cycles - 1.0) / 2.0);
        }
        (last * sign - least).min((last * sign).min(uneven)).max(0.0)
    }

    /// Returns by how much the last change of the leader exceeds its mean of the last cycles, in the direction of `way`
    /// (inc).
    pub fn ripple(&self, way: f64) -> f64 {
        let mean = self.recent.iter().sum::<f64>() / RECENT as f64;
        ((self.recent[0] - mean) * way.signum()).max(0.0).min(self.uneven())
    }

    /// Returns the velocity with which the slave would continue without its leader (inc/s), given its present one. That
    /// of a counted leader is smoothed, as its single changes are too coarse.
    pub fn steady_velocity(&self, present: f64, cycle_s: f64) -> f64 {
        match self.transmission {
            _ if self.lead_uneven == 0.0 => present,
            Transmission::Gear(_) | Transmission::Approach(_) => self.mean / cycle_s,
            // Its changes at other positions of the table do not count.
            Transmission::Cam(cam) => cam.mean() * cam.slope() / cycle_s,
        }
    }

    /// Returns the phase.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Whether nothing is left to catch up, and no pair of positions is being approached.
    pub fn is_in_sync(&self) -> bool {
        self.phase != Phase::CatchingUp && !self.transmission.approaches()
    }

    /// Returns geared leader minus slave (inc); 0 in mode velocity, which has no position relation.
    pub fn error(&self, slave: Position) -> Position {
        match self.mode {
            SyncMode::Velocity => Position::ZERO,
            _ => self.target - slave,
        }
    }

    /// Shifts the position by the transmission when another motion has moved the slave.
    pub fn shift(&mut self, by: Position) {
        self.target += by;
    }

    /// Whether the reversing rule has prevented backward motion in its last step.
    pub fn is_reverse_prevented(&self) -> bool {
        self.barred
    }

    /// Whether its leader alone, without added motions, exceeded the limits in the last step.
    pub fn leader_exceeds_limits(&self) -> bool {
        self.overtaken
    }

    /// Returns the velocity of its goal for catching up (inc/s).
    pub fn catch_up_velocity(&self) -> f64 {
        self.bounds.velocity.min(self.bounds.max_velocity)
    }

    /// Treats the slave as being at its position, and returns the rest of the distance.
    pub fn settle(&mut self, slave: Position) -> Position {
        let lacked = self.error(slave);
        (self.target, self.phase) = (slave, Phase::Synchronized);
        lacked
    }

    /// Whether the last change of the leader, geared, was backward.
    pub fn leader_reverses(&self) -> bool {
        self.recent[0] < 0.0
    }

    /// Advances by one cycle and returns the next motion of the slave, within the limits less `reserve`. If the rule
    /// forbids backward motion, the slave stops, and the gear waits for it ahead or behind.
    pub fn step(
        &mut self,
        slave: Motion,
        lead: (Lead, &[Arc<Table>]),
        cycle_s: f64,
        reserve: Reserve,
        rule: ReversingRule,
    ) -> Motion {
        self.step_with_added(slave, lead, cycle_s, reserve, rule, AddedMotion::default())
    }

    /// As [`step`](Self::step), with added motions.
    pub fn step_with_added(
        &mut self,
        slave: Motion,
        (lead, tables): (Lead, &[Arc<Table>]),
        cycle_s: f64,
        reserve: Reserve,
        rule: ReversingRule,
        beside: AddedMotion,
    ) -> Motion {
        let bounds = self.bounds.reduced_by(reserve);
        let change = self.transmission.step(lead, tables);
        // The rest of the transmission before, and added motions, are no motion of the leader.
        let added = beside.added.to_f64();
        if added != 0.0 {
            self.transmission.forget(added);
        }
        let added = added * self.transmission.signed_slope();
        let led = change.to_f64() - added;
        let led_by = Position::from_f64(led * beside.ahead);
        let change = change + beside.way + (led_by - self.led_by);
        self.led_by = led_by;
        self.lead_uneven = lead.uneven * (1.0 + 2.0 * beside.ahead);
        self.target += change;
        let change = if self.phase == Phase::Passing { self.target - slave.position } else { change };
        // From here on in inc per cycle.
        let geared = change.to_f64();
        let before = slave.velocity * cycle_s;
        // A counted leader varies by one increment even at constant speed: that part of an actual change is no
        // acceleration. Added motions are no change of the leader.
        let of_leader = geared - added - beside.way.to_f64();
        let uneven = self.uneven().min((of_leader - self.recent[0]).abs());
        let own = self.uneven().min((led - self.recent[0]).abs());
        let alone = self.can_follow(led, self.recent[0], own, cycle_s, bounds);
        self.note_change(led);
        let forward_only = match rule {
            ReversingRule::Always => false,
            ReversingRule::WithMaster => led >= 0.0,
            ReversingRule::Never => true,
        };
        let rate = bounds.acceleration * cycle_s * cycle_s;
        let slowing = self.slowing(cycle_s, bounds);
        if let Some(cam) = self.transmission.cam() {
            // A smooth end of a cam is followed. If the slave could not stop in time, it slows down before.
            let cycles = before.abs() / slowing + 2.0;
            self.halt = cam.distance_to_end(lead.change, cycles, tables).map(|way| self.target + way);
        }
        let ahead = self.slowed(slave.position, geared, slowing) == geared;
        self.barred = forward_only && geared < 0.0;
        let follows = ahead && !self.barred && self.can_follow(geared, before, uneven, cycle_s, bounds);
        let position = match self.phase {
            Phase::Synchronized | Phase::Passing if follows => {
                self.phase = Phase::Synchronized;
                slave.position + change
            }
            _ => {
                self.overtaken = !alone;
                let slowing = if self.halt.is_some() { slowing.max(rate) } else { rate };
                let (down, up) = if before > 0.0 { (slowing, rate) } else { (rate, slowing) };
                let (low, high) = (before - down - uneven, before + up + uneven);
                // A slave that moved backward with its leader may still slow down.
                let low = if forward_only { low.max(high.min(0.0)) } else { low };
                self.catch_up(slave.position, (change, beside.band), (low, high), cycle_s, bounds)
            }
        };
        let velocity = (position - slave.position).to_f64() / cycle_s;
        Motion { position, velocity, acceleration: (velocity - slave.velocity) / cycle_s, jerk: 0.0 }
    }

    /// Returns the step of a slave that stays synchronized with its leader, the usual case; none if
    /// [`step`](Self::step) is needed for more checks. It changes nothing: [`keep`](Self::keep) does.
    #[inline]
    pub fn follow(
        &self,
        slave: Motion,
        (lead, change): (Lead, Position),
        behind: &impl Stepped,
        cycle_s: f64,
        rule: ReversingRule,
    ) -> Option<Following> {
        // In inc per cycle.
        let geared = change.to_f64();
        let before = slave.velocity * cycle_s;
        let uneven = if lead.uneven == 0.0 { 0.0 } else { lead.uneven * behind.slope().abs() };
        let uneven = uneven.min((geared - self.recent[0]).abs());
        let Bounds { max_velocity, max_acceleration, max_deceleration, .. } = self.bounds;
        let rate = if geared.abs() > before.abs() { max_acceleration } else { max_deceleration };
        // As `can_follow`, which also allows for rounding.
        let follows = self.phase == Phase::Synchronized
            && lead.valid
            && lead.uneven == self.lead_uneven
            && self.halt.is_none()
            && (rule != ReversingRule::Never || geared >= 0.0)
            && geared.abs() <= max_velocity * cycle_s + uneven
            && (geared - before).abs() <= rate * cycle_s * cycle_s + uneven;
        let position = slave.position + change;
        let velocity = geared / cycle_s;
        let acceleration = (velocity - slave.velocity) / cycle_s;
        let motion = Motion { position, velocity, acceleration, jerk: 0.0 };
        follows.then_some(Following { motion, change, geared })
    }

    /// Applies the step.
    #[inline]
    pub fn keep(&mut self, following: &Following, behind: impl Stepped) {
        self.transmission = behind.into();
        self.target += following.change;
        self.note_change(following.geared);
    }

    #[inline]
    fn note_change(&mut self, geared: f64) {
        let [a, b, c, d, e, f, g, _] = self.recent;
        self.recent = [geared, a, b, c, d, e, f, g];
        if self.noted < MEAN_CYCLES {
            return self.note_first(geared);
        }
        self.mean += (geared - self.mean) / f64::from(MEAN_CYCLES);
    }

    /// At first a mean of all values.
    #[cold]
    fn note_first(&mut self, geared: f64) {
        self.noted = self.noted.saturating_add(1);
        self.mean += (geared - self.mean) / f64::from(self.noted);
    }

    fn can_follow(&self, geared: f64, before: f64, uneven: f64, cycle_s: f64, bounds: Bounds) -> bool {
        // Positions are multiples of 2^-32: two steps of the leader may each be wrong by one unit, times the ratio, and
        // those of the slave as well.
        let grid = 2.0 * (1.0 + self.transmission.slope()) / (1_u64 << 32) as f64;
        let rate = if geared.abs() > before.abs() { bounds.max_acceleration } else { bounds.max_deceleration };
        geared.abs() <= bounds.max_velocity * cycle_s + uneven + grid
            && (geared - before).abs() <= rate * cycle_s * cycle_s * (1.0 + 1e-9) + uneven + grid
    }

    /// Returns the deceleration before a halt (inc per cycle and cycle): the end of a cam is known too late for a lower
    /// one.
    fn slowing(&self, cycle_s: f64, bounds: Bounds) -> f64 {
        let is_cam = self.transmission.cam().is_some();
        (if is_cam { bounds.max_deceleration } else { bounds.acceleration }) * cycle_s * cycle_s
    }

    /// Limits a step so that the slave can still stop at the halt of its leader.
    fn slowed(&self, position: Position, step: f64, rate: f64) -> f64 {
        match self.halt.map(|halt| (halt - position).to_f64()) {
            Some(way) if way * step > 0.0 => step.abs().min(closing_velocity(way, rate).0.abs()).copysign(step),
            _ => step,
        }
    }

    /// Returns the position after a cycle of catching up, with a step between `low` and `high`. Changes to synchronized
    /// on arrival.
    fn catch_up(
        &mut self,
        position: Position,
        (change, band): (Position, Option<Band>),
        (low, high): (f64, f64),
        cycle_s: f64,
        bounds: Bounds,
    ) -> Position {
        let geared = change.to_f64();
        let rate = bounds.acceleration * cycle_s * cycle_s;
        let way = match self.mode {
            SyncMode::Velocity => 0.0,
            _ => (self.target - change - position).to_f64(),
        };
        let (closing, arrives) = closing_velocity(way, rate);
        // A leader as fast as the velocity of the goal can be caught up only with a higher velocity.
        let catches = bounds.velocity * cycle_s > geared.abs();
        let top = if catches { bounds.velocity } else { bounds.max_velocity } * cycle_s;
        let wanted = geared + closing;
        let wanted = band.map_or(wanted, |band| band.clamp(wanted)).clamp(-top, top);
        let wanted = self.slowed(position, wanted, self.slowing(cycle_s, bounds));
        // Not `clamp`: an invalid state may contain NaN.
        let step = wanted.max(low).min(high);
        // Exactly the wanted velocity, bit by bit: no limit was applied.
        if arrives && step == geared + closing {
            self.phase = Phase::Synchronized;
            return match self.mode {
                SyncMode::Velocity => position + change,
                _ => self.target,
            };
        }
        self.phase = Phase::CatchingUp;
        position + Position::from_f64(step)
    }
}

/// Returns the velocity with which a distance is closed (inc per cycle) if it decreases by `rate` (inc per cycle and
/// cycle), and whether it is closed in this cycle.
pub(super) fn closing_velocity(way: f64, rate: f64) -> (f64, bool) {
    let cycles = ((-3.0 + (1.0 + 8.0 * way.abs() / rate).sqrt()) / 2.0).ceil().max(0.0);
    let speed = way.abs() / (cycles + 1.0) + rate * cycles / 2.0;
    (speed.copysign(way), cycles == 0.0)
}

#[cfg(test)]
mod tests;

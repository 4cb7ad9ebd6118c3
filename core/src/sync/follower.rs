//! A coupled axis: it speeds up to its leader, catches up what it lost, and then follows exactly.
//!
//! Law      coupled: slave(k) = slave(k-1) + gear(master change of k).
//!          catching up (mode position): velocity = geared master velocity + w, where w is the largest velocity from which
//!          the slave can still slow down to the master with its acceleration in whole cycles without passing it:
//!          with e the way to catch up and d the change of velocity in a cycle (all in inc per cycle), n the least
//!          number with e <= d (n + 1)(n + 2) / 2: w = e / (n + 1) + d n / 2; it arrives after n + 1 cycles exactly.
//!          ahead: what leads is geared(k) + ahead * (geared(k) - geared(k-1)). While catching up the velocity may be kept in a band
//!          around the leader's, which a leader that stands makes 0
//! Reads    the leader's change; the slave's last motion; what is added beside
//! Writes   the slave's motion, to 2^-32 inc
//! Refuses  nothing here: ratio, velocity and acceleration were checked by the axis
//! Source   MACS-SYNC-02, -04, -06, -07, -12, -15, A-30

use super::gear::Gear;
use super::{Stepped, SyncMode, Transmission};
use crate::encoder::Lead;
use crate::parameter::Rule;
use crate::position::Position;
use crate::profile::Motion;
use crate::table::Table;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How far a coupling has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// The slave speeds up or catches up.
    CatchingUp,
    /// The slave follows exactly.
    Synchronized,
    /// It followed exactly by the transmission before, and is to by this one from the next cycle on.
    Passing,
}

/// What limits the slave (inc/s, inc/s^2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// While catching up.
    pub velocity: f64,
    /// While catching up.
    pub acceleration: f64,
    /// Always.
    pub max_velocity: f64,
    /// Always, while speeding up.
    pub max_acceleration: f64,
    /// Always, while slowing down.
    pub max_deceleration: f64,
}

/// What comes to the slave beside what its transmission makes of the leader.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beside {
    /// A way of this cycle.
    pub way: Position,
    /// What of the leader's change is none of its own motion.
    pub added: Position,
    /// Cycles of its geared velocity by which the slave is led ahead.
    pub ahead: f64,
    /// Where its velocity is while it catches up; none: anywhere.
    pub band: Option<Band>,
}

/// A band of velocities around that of a leader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The leader's geared velocity (inc per cycle).
    pub velocity: f64,
    /// How far it reaches to either side, as a share of it, 0 to 1.
    pub share: f64,
}

impl Band {
    fn clamp(self, velocity: f64) -> f64 {
        let (slow, fast) = (self.velocity * (1.0 - self.share), self.velocity * (1.0 + self.share));
        velocity.max(slow.min(fast)).min(fast.max(slow))
    }
}

/// What of the bounds is left to a motion that is superimposed on the coupling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reserve {
    /// (inc/s)
    pub velocity: f64,
    /// (inc/s^2)
    pub acceleration: f64,
}

impl Bounds {
    fn less(self, reserve: Reserve) -> Self {
        if reserve == Reserve::default() {
            let rate = self.max_acceleration.min(self.max_deceleration);
            let (velocity, acceleration) = (self.velocity.min(self.max_velocity), self.acceleration.min(rate));
            return Self { velocity, acceleration, ..self };
        }
        // Never nothing: it divides by them.
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

/// How one axis follows a lead, whatever that is.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Follower {
    mode: SyncMode,
    transmission: Transmission,
    phase: Phase,
    /// Where the transmission wants the slave.
    target: Position,
    /// Where the leader will stop at once, or a cam ends, if that is known: the slave slows down before.
    halt: Option<Position>,
    bounds: Bounds,
    /// By how much its lead is uneven (inc).
    lead_uneven: f64,
    /// The changes of the last cycles that the transmission made (inc), the newest first.
    recent: [f64; RECENT],
    /// The same, smoothed.
    mean: f64,
    /// Of how many of them, at most [`MEAN_CYCLES`].
    noted: u8,
    /// How far it is led ahead.
    led_by: Position,
    /// The rule has kept it from going backwards in the last step.
    barred: bool,
    /// Its leader alone was faster in the last step than it may be.
    overtaken: bool,
}

/// A step that leaves the slave on its leader.
#[derive(Clone, Copy, Debug)]
pub struct Following {
    /// The slave's next motion.
    pub motion: Motion,
    change: Position,
    /// The same (inc).
    geared: f64,
}

/// Cycles over which the speed of a counted leader is smoothed.
const MEAN_CYCLES: u8 = 64;
/// Cycles from which the least speed of a counted leader is told.
const RECENT: usize = 8;

impl Follower {
    /// Could it have come about? One that was read from outside may hold anything.
    pub fn is_sound(&self) -> bool {
        let Bounds { velocity, acceleration, max_velocity, max_acceleration, max_deceleration } = self.bounds;
        let bounds = [velocity, acceleration, max_velocity, max_acceleration, max_deceleration];
        let is_uneven = self.lead_uneven >= 0.0 && self.lead_uneven.is_finite();
        is_uneven && self.transmission.is_sound() && bounds.iter().all(|bound| *bound > 0.0 && bound.is_finite())
    }

    /// Begins with an axis that stands or moves as `slave` says; `offset` shifts it against the leader, which is so
    /// uneven (inc) as its lead says.
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

    /// The same, exactly on its leader from the first cycle on, as far as its limits allow.
    #[must_use]
    pub fn at_once(self) -> Self {
        Self { phase: Phase::Synchronized, ..self }
    }

    /// The same, which the transmission has where it is, but for what it comes to in one cycle.
    #[must_use]
    pub fn passing(self) -> Self {
        Self { phase: Phase::Passing, ..self }
    }

    /// The same, which is led ahead by so much already.
    #[must_use]
    pub fn led_ahead(self, led_by: Position) -> Self {
        Self { led_by, ..self }
    }

    /// The same by another transmission from now on, which wants the slave at `place`, without what it is led ahead; where it `goes_on` from the one before, the slave
    /// comes there in one cycle, else it is led there.
    #[must_use]
    pub fn handed_over(self, transmission: Transmission, place: Position, bounds: Bounds, goes_on: bool) -> Self {
        let is_there = self.phase != Phase::CatchingUp;
        let target = place + self.led_by;
        let phase = if is_there && goes_on { Phase::Passing } else { Phase::CatchingUp };
        // What another transmission made of the leader says nothing of its speed.
        Self { transmission, phase, target, halt: None, bounds, noted: 0, ..self }
    }

    /// Leaves the way to a pair of places for its gear, which takes the slave where it is.
    pub fn give_approach_up(&mut self, slave: Motion) {
        if let Transmission::Approach(approach) = &self.transmission {
            self.transmission = Transmission::Gear(Gear::new(approach.ratio()));
            (self.phase, self.target) = (Phase::CatchingUp, slave.position);
        }
    }

    /// Says whether a cam lets its slave rest at its end.
    pub fn rest_at_end(&mut self, rests: bool) {
        if let Transmission::Cam(cam) = &mut self.transmission {
            *cam = if rests { cam.resting() } else { cam.going_on() };
        }
    }

    /// Says where the leader will stop at once, while the slave is on its straight way there; none: nobody knows.
    pub fn halt_at(&mut self, halt: Option<Position>) {
        self.halt = halt;
    }

    /// The same with a way of the leader that is past already and counts.
    #[must_use]
    pub fn with_past(mut self, past: Position, tables: &[Arc<Table>]) -> Self {
        self.target += self.transmission.step(Lead { change: past, ..Lead::default() }, tables);
        self
    }

    /// Where the transmission wants the slave.
    pub fn target(&self) -> Position {
        self.target
    }

    /// Where the transmission alone wants the slave, without what it is led ahead.
    pub fn place(&self) -> Position {
        self.target - self.led_by
    }

    /// How far it is led ahead, where it is there.
    pub fn led_by(&self) -> Position {
        if self.phase == Phase::CatchingUp { Position::ZERO } else { self.led_by }
    }

    /// What it keeps equal.
    pub fn mode(&self) -> SyncMode {
        self.mode
    }

    /// Its transmission, with what its remainder holds.
    pub fn transmission(&self) -> &Transmission {
        &self.transmission
    }

    /// What a leader's change may differ from its speed (inc): one geared count, where it is counted.
    pub fn uneven(&self) -> f64 {
        if self.lead_uneven == 0.0 { 0.0 } else { self.lead_uneven * self.transmission.slope() }
    }

    /// By how much the leader's last change may exceed its speed in the direction of `way` (inc), if that falls by no more than
    /// `rate` (inc per cycle) a cycle. Over n cycles its counts make a way that is exact to one of them.
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

    /// By how much the leader's last change exceeds its mean of the last cycles, in the direction of `way` (inc).
    pub fn ripple(&self, way: f64) -> f64 {
        let mean = self.recent.iter().sum::<f64>() / RECENT as f64;
        ((self.recent[0] - mean) * way.signum()).max(0.0).min(self.uneven())
    }

    /// The velocity with which the slave would go on without its leader (inc/s), given its present one: that of a counted
    /// leader is smoothed, as its single changes say little.
    pub fn steady_velocity(&self, present: f64, cycle_s: f64) -> f64 {
        match self.transmission {
            _ if self.lead_uneven == 0.0 => present,
            Transmission::Gear(_) | Transmission::Approach(_) => self.mean / cycle_s,
            // What it has done in other places of the table says nothing.
            Transmission::Cam(cam) => cam.mean() * cam.slope() / cycle_s,
        }
    }

    /// How far it has come.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Is nothing left to catch up, nor the pair of places to come to?
    pub fn is_in_sync(&self) -> bool {
        self.phase != Phase::CatchingUp && !self.transmission.approaches()
    }

    /// Geared leader minus slave (inc); 0 in mode velocity, which has no position relation.
    pub fn error(&self, slave: Position) -> Position {
        match self.mode {
            SyncMode::Velocity => Position::ZERO,
            _ => self.target - slave,
        }
    }

    /// Moves what the gear wants by what something else has moved the slave.
    pub fn shift(&mut self, by: Position) {
        self.target += by;
    }

    /// Has the rule kept it from going backwards in its last step?
    pub fn is_barred(&self) -> bool {
        self.barred
    }

    /// Was its leader alone, without what came beside, faster in the last step than it may be?
    pub fn is_overtaken(&self) -> bool {
        self.overtaken
    }

    /// The velocity that its goal lets it catch up with (inc/s).
    pub fn catch_up_velocity(&self) -> f64 {
        self.bounds.velocity.min(self.bounds.max_velocity)
    }

    /// Takes the slave for where it should be, and gives what it lacked of that.
    pub fn settle(&mut self, slave: Position) -> Position {
        let lacked = self.error(slave);
        (self.target, self.phase) = (slave, Phase::Synchronized);
        lacked
    }

    /// Did the leader's last change, geared, lead backwards?
    pub fn leader_reverses(&self) -> bool {
        self.recent[0] < 0.0
    }

    /// One cycle: the slave's next motion, with what `reserve` leaves of the bounds. Where the rule forbids to go backwards, the
    /// slave stands, and the gear waits for it ahead or behind.
    pub fn step(
        &mut self,
        slave: Motion,
        lead: (Lead, &[Arc<Table>]),
        cycle_s: f64,
        reserve: Reserve,
        rule: Rule,
    ) -> Motion {
        self.step_beside(slave, lead, cycle_s, reserve, rule, Beside::default())
    }

    /// The same, with what comes to it beside.
    pub fn step_beside(
        &mut self,
        slave: Motion,
        (lead, tables): (Lead, &[Arc<Table>]),
        cycle_s: f64,
        reserve: Reserve,
        rule: Rule,
        beside: Beside,
    ) -> Motion {
        let bounds = self.bounds.less(reserve);
        let change = self.transmission.step(lead, tables);
        // What the transmission before has left, and what comes beside, is not what the leader does.
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
        // A counted leader is uneven by one increment even at constant speed: that much of its change, where it did
        // change, is no acceleration. What comes beside is no change of it.
        let of_leader = geared - added - beside.way.to_f64();
        let uneven = self.uneven().min((of_leader - self.recent[0]).abs());
        let own = self.uneven().min((led - self.recent[0]).abs());
        let alone = self.can_follow(led, self.recent[0], own, cycle_s, bounds);
        self.note_change(led);
        let forward_only = match rule {
            Rule::Always => false,
            Rule::WithMaster => led >= 0.0,
            Rule::Never => true,
        };
        let rate = bounds.acceleration * cycle_s * cycle_s;
        let slowing = self.slowing(cycle_s, bounds);
        if let Some(cam) = self.transmission.cam() {
            // One that ends smoothly is followed; where the slave could not stop in time, it slows down before.
            let cycles = before.abs() / slowing + 2.0;
            self.halt = cam.way_to_end(lead.change, cycles, tables).map(|way| self.target + way);
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
                // What went backwards with its leader may still slow down.
                let low = if forward_only { low.max(high.min(0.0)) } else { low };
                self.catch_up(slave.position, (change, beside.band), (low, high), cycle_s, bounds)
            }
        };
        let velocity = (position - slave.position).to_f64() / cycle_s;
        Motion { position, velocity, acceleration: (velocity - slave.velocity) / cycle_s, jerk: 0.0 }
    }

    /// The step of a slave that is on its leader and stays there, which is most of them; none where [`step`](Self::step) has to
    /// look closer. Nothing is changed: that is up to [`keep`](Self::keep).
    #[inline]
    pub fn follow(
        &self,
        slave: Motion,
        (lead, change): (Lead, Position),
        behind: &impl Stepped,
        cycle_s: f64,
        rule: Rule,
    ) -> Option<Following> {
        // In inc per cycle.
        let geared = change.to_f64();
        let before = slave.velocity * cycle_s;
        let uneven = if lead.uneven == 0.0 { 0.0 } else { lead.uneven * behind.slope().abs() };
        let uneven = uneven.min((geared - self.recent[0]).abs());
        let Bounds { max_velocity, max_acceleration, max_deceleration, .. } = self.bounds;
        let rate = if geared.abs() > before.abs() { max_acceleration } else { max_deceleration };
        // As `can_follow`, which allows for rounding as well.
        let follows = self.phase == Phase::Synchronized
            && lead.valid
            && lead.uneven == self.lead_uneven
            && self.halt.is_none()
            && (rule != Rule::Never || geared >= 0.0)
            && geared.abs() <= max_velocity * cycle_s + uneven
            && (geared - before).abs() <= rate * cycle_s * cycle_s + uneven;
        let position = slave.position + change;
        let velocity = geared / cycle_s;
        let acceleration = (velocity - slave.velocity) / cycle_s;
        let motion = Motion { position, velocity, acceleration, jerk: 0.0 };
        follows.then_some(Following { motion, change, geared })
    }

    /// Takes the step.
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

    /// A mean of all that came, until that is enough.
    #[cold]
    fn note_first(&mut self, geared: f64) {
        self.noted = self.noted.saturating_add(1);
        self.mean += (geared - self.mean) / f64::from(self.noted);
    }

    fn can_follow(&self, geared: f64, before: f64, uneven: f64, cycle_s: f64, bounds: Bounds) -> bool {
        // Positions are multiples of 2^-32: the leader's two steps may be off by one each, times the ratio, and the
        // slave's as well.
        let grid = 2.0 * (1.0 + self.transmission.slope()) / (1_u64 << 32) as f64;
        let rate = if geared.abs() > before.abs() { bounds.max_acceleration } else { bounds.max_deceleration };
        geared.abs() <= bounds.max_velocity * cycle_s + uneven + grid
            && (geared - before).abs() <= rate * cycle_s * cycle_s * (1.0 + 1e-9) + uneven + grid
    }

    /// With what it slows down for a halt (inc per cycle and cycle): the end of a cam is known too late for less.
    fn slowing(&self, cycle_s: f64, bounds: Bounds) -> f64 {
        let is_cam = self.transmission.cam().is_some();
        (if is_cam { bounds.max_deceleration } else { bounds.acceleration }) * cycle_s * cycle_s
    }

    /// A step that leads the slave no further than it can still stop for the halt of its leader.
    fn slowed(&self, position: Position, step: f64, rate: f64) -> f64 {
        match self.halt.map(|halt| (halt - position).to_f64()) {
            Some(way) if way * step > 0.0 => step.abs().min(closing(way, rate).0.abs()).copysign(step),
            _ => step,
        }
    }

    /// The position after a cycle of catching up, with a step between `low` and `high`; turns to synchronized when it arrives.
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
        let (closing, arrives) = closing(way, rate);
        // A leader that is as fast as the goal's velocity can only be caught with more.
        let catches = bounds.velocity * cycle_s > geared.abs();
        let top = if catches { bounds.velocity } else { bounds.max_velocity } * cycle_s;
        let wanted = geared + closing;
        let wanted = band.map_or(wanted, |band| band.clamp(wanted)).clamp(-top, top);
        let wanted = self.slowed(position, wanted, self.slowing(cycle_s, bounds));
        // Not `clamp`: a state that was made up may have no number before.
        let step = wanted.max(low).min(high);
        // Bit for bit the velocity that is asked for: nothing held it back.
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

/// The velocity with which a way is closed (inc per cycle), slowed down by `rate` (inc per cycle and cycle), and whether that is in this one
/// cycle.
pub(super) fn closing(way: f64, rate: f64) -> (f64, bool) {
    let cycles = ((-3.0 + (1.0 + 8.0 * way.abs() / rate).sqrt()) / 2.0).ceil().max(0.0);
    let speed = way.abs() / (cycles + 1.0) + rate * cycles / 2.0;
    (speed.copysign(way), cycles == 0.0)
}

#[cfg(test)]
mod tests;

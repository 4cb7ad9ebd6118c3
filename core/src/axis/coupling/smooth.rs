//! The start of a coupling by marks over a polynomial of 5th order (SYNCMSTART 7).
//!
//! Law      until the positions of a mark of the master and of a mark of the axis are known, the present motion
//!          continues; of an index pulse the last position counts. The curve is then an [`Approach`] to the pair of
//!          marks k groups of the master ahead. k is the least number for which a curve with free end, at the mean of
//!          both velocities, stays below acceleration and jerk. The curve begins as soon as the mark of the axis
//!          nearest to that end can be reached with velocity and acceleration of the goal, for k or k + 1: from rest
//!          within one distance between marks. Each distance of waiting without success allows one more group. After
//!          the curve, marks correct as usual, and no state of the start remains. Start 5 replaces it if the master is
//!          at rest, the axis rests without a known mark, or 8 groups have passed; and on the curve if the velocity of
//!          the master changes by more than a tenth
//! Reads    marks of both sides, the leader
//! Writes   an event when start 5 replaces it
//! Refuses  nothing: start 5 replaces it
//! Source   MACS-MARK-14 to -17

use super::gear_in::CurveData;
use crate::axis::state::smooth::{MEAN_TIME, Mean, is_smooth};
use crate::axis::state::{Axis, Context, Curve, Engagement, Generator, MarkPath, Smooth};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::MarkSignal;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use crate::sync::approach::{Approach, Begin};
use crate::sync::filter::MasterFilter;
use crate::sync::follower::Follower;
use crate::sync::gear::Ratio;
use crate::sync::marker::MarkSide;
use crate::sync::{SyncMode, Transmission};

/// Groups of the master after which the smooth start is given up.
const MOST_GROUPS: f64 = 8.0;

/// Peaks of acceleration and jerk of the curve with free end: s = v T (x^3 - x^4 / 2) (MACS-MARK-17).
const PEAK_ACCELERATION: f64 = 1.5;

const PEAK_JERK: f64 = 6.0;

/// Reason why another start replaces a smooth one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fallback {
    /// The master is slower than 1 inc in [`MEAN_TIME`].
    MasterStands,
    /// The axis rests, and the positions of its marks are unknown.
    MarkUnknown,
    /// [`MOST_GROUPS`] have passed, or have no length.
    CurveMissing,
    /// The velocity of the master has changed by more than a tenth since the start.
    MasterChanged,
}

impl Fallback {
    /// Each reason with its message.
    const ALL: [(Self, &'static str); 4] = [
        (Self::MasterStands, "the leader is slower than 1 inc in 50 ms"),
        (Self::MarkUnknown, "the axis rests, and no mark of it is known"),
        (Self::CurveMissing, "within 8 groups of marks of the leader no curve was within the limits of the axis"),
        (Self::MasterChanged, "the velocity of the leader has changed by more than 10 % on the curve"),
    ];

    /// Returns the message for the number in an event.
    pub(crate) fn sentence(number: i64) -> &'static str {
        Self::ALL.iter().find(|(why, _)| *why as i64 == number).map_or("", |(_, sentence)| sentence)
    }
}

/// Result of a cycle of waiting.
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
enum Outcome {
    Waits,
    FallsBack(Fallback),
    Begins(Follower),
}

impl Axis {
    /// Returns the state for waiting if SYNCMSTART selects a smooth start and it is possible.
    pub(super) fn smooth_start(&self, mode: SyncMode, lead: Lead) -> Option<Smooth> {
        let start = self.parameters.marks.start;
        if mode != SyncMode::Marker || !is_smooth(start) {
            return None;
        }
        let by_index = MarkSignal::decode(self.parameters.marks.slave_type).input.is_none();
        // The cycle that begins the wait is counted at its end.
        let was_at = self.feedback.position() - self.feedback.change();
        let slave = self.known_index().filter(|_| by_index).map(|index| was_at - index);
        let mean = Mean { velocity: lead.velocity * self.cycle_s(), since: 0.0 };
        Some(Smooth { start, master: None, slave, mean, waited: 0.0 })
    }

    /// Advances a coupling that waits for a smooth start; none once it has begun.
    ///
    /// # Errors
    /// A coupling without waiting would be refused.
    pub(super) fn start_smoothly(
        &mut self,
        cx: &mut Context<'_>,
        engagement: &Engagement,
        lead: Lead,
    ) -> Result<Option<Smooth>, Refusal> {
        let Some(mut smooth) = engagement.smooth else { return Ok(None) };
        let (request, leader) = (&engagement.request, engagement.leader);
        let cycle_ms = self.cycle_s() * 1e3;
        smooth.mean.step(lead.change.to_f64(), cycle_ms);
        smooth.waited += lead.change.to_f64().abs();
        let marks = &self.parameters.marks;
        let signals = [marks.master_type, marks.slave_type].map(MarkSignal::decode);
        let [of_master, of_slave] = self.marks_of_cycle(cx, signals, (leader, lead));
        let since = |way: Option<Position>, change, seen: Option<Position>| seen.or(way.map(|way| way + change));
        smooth.master = since(smooth.master, lead.change, of_master);
        smooth.slave = since(smooth.slave, self.feedback.change(), of_slave);

        self.check_closed_loop()?;
        self.check_free()?;
        let (follower, why) = match self.outcome(engagement, &smooth, lead)? {
            Outcome::Waits => return Ok(Some(smooth)),
            Outcome::Begins(follower) => (follower, None),
            Outcome::FallsBack(why) => (self.follower_of(request, lead, self.gear_of(request)?)?, Some(why)),
        };
        let begun = why.is_none();
        let coupling = self.coupling_by(leader, request, follower);
        // It has begun: the takeover must not end its own wait.
        self.coupling.set_engagement(None);
        self.take_over(cx, engagement.sequence, None);
        self.begin_conditioning(request.mode, lead);
        let velocity = smooth.mean.velocity;
        // One count does not give the speed, but the mean does.
        let filter = self.parameters.master_tau(true).map(|_| MasterFilter::settled(velocity));
        self.coupling.conditioning_mut().continue_filter(filter);
        if let Some(path) = &mut self.coupling.conditioning_mut().marks {
            path.begin_smooth(smooth.start, velocity, begun.then_some(Curve { mean: smooth.mean, velocity }));
            let known = [(MarkSide::Master, smooth.master), (MarkSide::Slave, smooth.slave)];
            for (of, since) in known.into_iter().filter(|_| begun) {
                since.into_iter().for_each(|since| path.marker.set_travel(of, since));
            }
        }
        self.begin_motion(cx, AxisState::SynchronizedMotion, Reference::Gear, Generator::Follow(coupling));
        if let Some(why) = why {
            self.report_fallback(cx, smooth.start, why);
        }
        Ok(None)
    }

    /// Reports that another start replaces a smooth one.
    fn report_fallback(&self, cx: &mut Context<'_>, start: i64, why: Fallback) {
        let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::SMOOTH_START_FALLBACK);
        let event = event.with(Number::Count(why as i64), Number::Count(start));
        cx.events.push(Event { position: self.command.position(), ..event });
    }

    fn outcome(&self, engagement: &Engagement, smooth: &Smooth, lead: Lead) -> Result<Outcome, Refusal> {
        let Smooth { master, slave, mean, waited, .. } = *smooth;
        let cycle_ms = self.cycle_s() * 1e3;
        let group = self.master_group();
        let rests = matches!(*self.motion.generator(), Generator::Rest);
        // A counted master shows its speed only after some time.
        let is_known = lead.uneven == 0.0 || mean.since >= MEAN_TIME;
        if is_known && mean.is_at_rest(cycle_ms) {
            return Ok(Outcome::FallsBack(Fallback::MasterStands));
        }
        if slave.is_none() && rests {
            return Ok(Outcome::FallsBack(Fallback::MarkUnknown));
        }
        if waited >= MOST_GROUPS * group {
            return Ok(Outcome::FallsBack(Fallback::CurveMissing));
        }
        let (Some(master), Some(slave)) = (master, slave) else { return Ok(Outcome::Waits) };
        if !is_known {
            return Ok(Outcome::Waits);
        }
        let request = &engagement.request;
        let ratio = self.ratio_of(request)?;
        let bounds = self.bounds_of(request)?;
        let (present, cycle_s, speed) = (self.present_motion(), self.cycle_s(), mean.velocity);
        let led = self.leading_distance(request.mode);
        // An axis coupled to a counted master shows the velocity of single counts.
        let velocity = if self.coupling().is_some() { self.steady_velocity() } else { present.velocity };
        let from = Begin {
            place: present.position - led,
            slope: velocity * cycle_s / speed,
            bend: present.acceleration * cycle_s * cycle_s / speed / speed,
        };
        let way = CurveData { ratio, speed, from, bounds };
        let since = if speed < 0.0 { -master } else { master };
        let least = self.least_length(&way) + since.to_f64();
        let fewest = (least / group).ceil().max(1.0);
        // At most MOST_GROUPS have passed.
        let more = 1 + (waited / group) as u8;
        for more in 0..=more {
            let left = Position::from_f64((fewest + f64::from(more)) * group) - since;
            if let Some(approach) = self.curve(&way, left, slave) {
                let transmission = Transmission::Approach(approach);
                let follower = Follower::new(lead.uneven, transmission, request.mode, present, Position::ZERO, bounds);
                return Ok(Outcome::Begins(follower.leading_by(led).passing()));
            }
        }
        Ok(Outcome::Waits)
    }

    /// Returns the shortest distance of the master (inc) in which a curve with free end stays below acceleration and
    /// jerk.
    fn least_length(&self, way: &CurveData) -> f64 {
        let cycle_s = self.cycle_s();
        let turn = (way.ratio.to_f64() - way.from.slope).abs();
        let speed = way.speed.abs() / cycle_s;
        let by_acceleration = PEAK_ACCELERATION * turn * speed * speed / way.bounds.acceleration;
        let by_jerk = self.parameters.max_jerk.map_or(0.0, |most| (PEAK_JERK * turn * speed / most).sqrt() * speed);
        by_acceleration.max(by_jerk)
    }

    /// Returns the curve to the pair at distance `left` ahead of the master, if the axis can follow it; `since`:
    /// distance since its last mark.
    fn curve(&self, way: &CurveData, left: Position, since: Position) -> Option<Approach> {
        let CurveData { ratio, speed, from, .. } = *way;
        // Whole increments; the rest of the distance is after the curve.
        let whole = left.floor();
        let rest = left - Position::whole(whole);
        let length = if speed < 0.0 { whole.checked_neg()? } else { whole };
        let geared = ratio.to_f64() * if speed < 0.0 { -rest.to_f64() } else { rest.to_f64() };
        let by_itself = (from.slope + ratio.to_f64()) / 2.0 * length as f64;
        let end = from.place + Position::from_f64(by_itself + geared);
        let mark = self.feedback.position() - since;
        let period = self.slave_period(ratio);
        let marks = ((end - mark).to_f64() / period).round();
        let pair = mark + Position::from_f64(marks * period) - Position::from_f64(geared);
        let (approach, shape) = Approach::new(ratio, length, Begin { place: from.place - pair, ..from })?;
        let per_s = speed.abs() / self.cycle_s();
        let jerk = approach.jerk() * per_s * per_s * per_s;
        let is_smooth = self.parameters.max_jerk.is_none_or(|most| jerk <= most);
        // A short distance would need a start in the wrong direction.
        let turns = from.slope * ratio.to_f64() < 0.0;
        let is_onward = turns || approach.keeps_sign(ratio.to_f64());
        let fits = is_smooth && is_onward && self.leads_forward(&approach, speed) && self.can_follow(shape, *way);
        fits.then_some(approach)
    }

    /// Returns the distance between groups of marks of its master (inc of the master).
    fn master_group(&self) -> f64 {
        self.parameters.sync.mark_distance as f64 * self.parameters.marks.per_master.max(1) as f64
    }

    /// Returns the distance between groups of its own marks (inc).
    fn slave_period(&self, ratio: Ratio) -> f64 {
        let marks = &self.parameters.marks;
        match marks.slave_distance {
            0 => ratio.to_f64().abs() * self.master_group(),
            distance => distance as f64 * marks.per_slave.max(1) as f64,
        }
    }

    /// Aborts a curve whose master has changed its velocity: the gear starts from the present motion, and marks start
    /// as with start 5.
    pub(super) fn supervise_curve(&mut self, cx: &mut Context<'_>, path: &mut MarkPath, change: f64) {
        let cycle_ms = self.cycle_s() * 1e3;
        let slave = self.underlying();
        let Some(follower) = self.motion.coupled_mut() else { return };
        if let Some(start) = path.leaves_curve(change, cycle_ms, follower.transmission().approaches()) {
            follower.replace_approach_by_gear(slave);
            self.report_fallback(cx, start, Fallback::MasterChanged);
        }
    }
}

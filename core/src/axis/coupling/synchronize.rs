//! A coupling: an axis follows one of the leads of its machine.
//!
//! Law      as a follower ([`Follower`]); the coupling adds the choice of the lead, and the state of the axis after the
//!          coupling
//! Reads    the lead, of this cycle if the leader is before the axis in their order
//! Refuses  invalid ratios, rates beyond the limits, a leader that is lost
//! Source   MACS-SYNC-01, -02, -04, PLCopen (MC_GearIn)

use super::conditioning::Conditioned;
use crate::axis::state::{Axis, Context, Coupling, Failure, Generator};
use crate::code::Code;
use crate::command::{Engage, Synchronize};
use crate::encoder::Lead;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Leader;
use crate::parameter::{AxisParameters, Row};
use crate::position::Position;
use crate::profile::Motion;
use crate::state::{AxisState, Reference};
use crate::sync::follower::{Bounds, Follower, Phase};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{SyncMode, Transmission};

impl Axis {
    /// Returns the coupling to a leader, if there is one.
    #[inline]
    pub(in crate::axis) fn coupling(&self) -> Option<&Coupling> {
        match self.motion.generator() {
            Generator::Follow(coupling) => Some(coupling),
            _ => None,
        }
    }

    /// Returns the leader to which the axis is coupled, if any.
    pub fn leader(&self) -> Option<Leader> {
        self.coupling().map(|coupling| coupling.leader)
    }

    /// Couples the axis to a leader.
    pub(in crate::axis) fn start_synchronize(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Synchronize,
    ) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_free()?;
        self.bounds_of(request)?;
        let leader = self.leader_of(request.leader, cx.leads.axes())?;
        let lead = cx.leads.get(leader);
        if !lead.valid {
            return Err(self.refuse(Code::LEADER_LOST));
        }
        if request.engage != Engage::Immediately || self.smooth_start(request.mode, lead).is_some() {
            return self.wait_to_engage(cx, sequence, (request, leader));
        }
        let led = self.leading_distance(request.mode);
        // With the same leader the filter continues with the distance that it holds.
        let by_gear = request.mode == SyncMode::Position && request.cam.is_none();
        let filter = self.follows_by_position(leader).filter(|_| by_gear).and(self.coupling.conditioning().filter());
        let begins = match &request.cam {
            Some(cam) => {
                let start = cam.start;
                let stands = self.present_motion().position - led;
                let (cam, way) = self.cam_of(cx.tables, lead, (cam, request.disengage), stands)?;
                self.check_cam_marks(request.mode, &cam, start, cx.tables)?;
                let cam = self.cam_before_mark(request.mode, cam, cx.tables);
                (Transmission::Cam(cam.with_mean(self.mean_of(leader, lead))), way)
            }
            None => self.gear_of(request)?,
        };
        let follower = self.follower_of(request, lead, begins)?;
        let coupling = self.coupling_by(leader, request, follower);
        self.begin_goal(cx, sequence, None);
        self.begin_conditioning(request.mode, lead);
        self.coupling.conditioning_mut().continue_filter(filter);
        let reference = if request.cam.is_some() { Reference::Cam } else { Reference::Gear };
        self.begin_motion(cx, AxisState::SynchronizedMotion, reference, Generator::Follow(coupling));
        Ok(())
    }

    /// Returns a follower that begins at once, from a transmission and an offset of the slave.
    pub(super) fn follower_of(
        &self,
        request: &Synchronize,
        lead: Lead,
        (transmission, offset): (Transmission, Position),
    ) -> Result<Follower, Refusal> {
        let bounds = self.bounds_of(request)?;
        let follower = Follower::new(lead.uneven, transmission, request.mode, self.present_motion(), offset, bounds);
        Ok(follower.leading_by(self.leading_distance(request.mode)))
    }

    /// Returns the distance by which the axis leads (SYNCFFVEL), if a coupling in `mode` continues with that. This
    /// distance is then no motion to make up, and the follower starts at the position of its drive.
    pub(super) fn leading_distance(&self, mode: SyncMode) -> Position {
        let before = self.coupling().filter(|_| mode.keeps_position());
        before.map_or(Position::ZERO, |coupling| coupling.follower.leading_distance())
    }

    /// Returns the coupling of a request.
    pub(super) fn coupling_by(&self, leader: Leader, request: &Synchronize, follower: Follower) -> Coupling {
        let (disengage, accuracy) = (request.disengage, self.parameters.sync_accuracy);
        let at_places = matches!(request.engage, Engage::InPosition { .. });
        Coupling { leader, disengage, accuracy, at_places, follower }
    }

    /// Returns the limits of the slave of a request.
    pub(super) fn bounds_of(&self, request: &Synchronize) -> Result<Bounds, Refusal> {
        let p = &self.parameters;
        let velocity =
            self.check_rate(request.velocity, p.default_goal_velocity(), p.max_velocity, Code::VELOCITY_TOO_HIGH)?;
        let acceleration = self.check_rate(
            request.acceleration,
            p.default_goal_acceleration(),
            p.max_acceleration,
            Code::ACCELERATION_TOO_HIGH,
        )?;
        let (velocity, acceleration) = match request.cam {
            Some(_) if p.sync.follows_directly() => (p.max_velocity, p.max_acceleration),
            _ => (velocity, acceleration),
        };
        Ok(Bounds {
            velocity,
            acceleration: acceleration.min(p.deceleration_limit()),
            max_velocity: p.max_velocity,
            max_acceleration: p.max_acceleration,
            max_deceleration: p.deceleration_limit(),
        })
    }

    /// Returns the ratio of a request.
    pub(super) fn ratio_of(&self, request: &Synchronize) -> Result<Ratio, Refusal> {
        let (numerator, denominator) = (request.numerator, request.denominator);
        if (numerator, denominator) == (0, 0) {
            return self.ratio_of_parameters(&self.parameters);
        }
        Ratio::new(numerator, denominator)
            .ok_or_else(|| self.refuse(Code::BAD_RATIO).with(Number::Count(numerator), Number::Count(denominator)))
    }

    /// Returns the ratio of syncfacts to syncfactm. A refusal names the parameter that makes it invalid.
    pub(in crate::axis) fn ratio_of_parameters(&self, p: &AxisParameters) -> Result<Ratio, Refusal> {
        let (slave, master) = (p.sync_slave, p.sync_master);
        Ratio::new(slave, master).ok_or_else(|| {
            let key = if Ratio::new(slave, 1).is_none() { "syncfacts" } else { "syncfactm" };
            let parameter = Row::find(key).map(|(parameter, _)| parameter);
            let refusal = self.refuse(Code::BAD_RATIO).with(Number::Count(slave), Number::Count(master));
            Refusal { parameter, ..refusal }
        })
    }

    /// Returns the gear of a request, and the offset of the slave.
    pub(super) fn gear_of(&self, request: &Synchronize) -> Result<(Transmission, Position), Refusal> {
        let ratio = self.ratio_of(request)?;
        let offset = match request.mode {
            SyncMode::Velocity => Position::ZERO,
            _ => request.offset.exact(),
        };
        // The remainder passes from one gear to the next.
        let before = self.coupling().map(|coupling| coupling.follower.transmission());
        let gear = match before {
            Some(Transmission::Gear(gear)) => gear.with_ratio(ratio),
            _ => Gear::new(ratio),
        };
        Ok((Transmission::Gear(gear), offset))
    }

    /// Returns the motion of this cycle by the leader. None: the coupling is lost, and the axis already stops.
    pub(in crate::axis) fn follow(&mut self, cx: &mut Context<'_>) -> Option<Motion> {
        let (slave, cycle_s, reserve) = (self.underlying(), self.cycle_s(), self.reserve());
        let rule = self.parameters.reversing().rule;
        let Generator::Follow(Coupling { leader, .. }) = self.motion.generator() else { return None };
        let lead = cx.leads.get(*leader);
        let bound = Position::whole(Gear::MAX_CHANGE);
        if !lead.valid || lead.change > bound || lead.change < -bound {
            let code = if lead.valid { Code::ENCODER_JUMP } else { Code::LEADER_LOST };
            // The motion of this cycle is unknown.
            let change = Number::Position(lead.change.floor());
            self.raise(cx, Failure::of(code).with(change, Number::None).before_motion());
            return None;
        }
        let (change, uneven) = (lead.change, lead.uneven);
        if let Err(failure) = self.check_sink(change, uneven) {
            self.raise(cx, failure.before_motion());
            return None;
        }
        let (shift, ended) = self.phase_of_master();
        let Conditioned { lead, beside } = self.condition(cx, lead);
        let change = lead.change + shift;
        if change.raw().abs() > 2 * bound.raw() {
            let change = Number::Position(change.floor());
            self.report_phase(cx, ended, self.command.position());
            self.raise(cx, Failure::of(Code::ENCODER_JUMP).with(change, Number::None).before_motion());
            return None;
        }
        let lead = Lead { change, ..lead };
        let follower = self.motion.coupled_mut()?;
        if follower.transmission().cam().is_some_and(|cam| !cam.allows_change(change, cx.tables)) {
            let most = follower.transmission().cam().map_or(0, |cam| cam.largest_change(cx.tables) as i64);
            let numbers = (Number::Count(change.floor().saturating_abs()), Number::Count(most));
            self.report_phase(cx, ended, self.command.position());
            self.raise(cx, Failure::of(Code::CAM_MASTER_TOO_FAST).with(numbers.0, numbers.1).before_motion());
            return None;
        }
        let was = follower.phase();
        let next = follower.step_with_added(slave, (lead, cx.tables), cycle_s, reserve, rule, beside);
        let (is_lost, waits) = (follower.phase() == Phase::CatchingUp, follower.is_reverse_prevented());
        // Added motions were requested, so they are not reported as a loss of synchronization.
        let is_told = if waits { !self.was_reverse_prevented() } else { follower.leader_exceeds_limits() };
        if was != Phase::CatchingUp && is_lost && is_told {
            let lost = if waits { Code::REVERSE_FORBIDDEN } else { Code::SYNC_LOST };
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), lost);
            cx.events.push(Event { position: next.position, ..event });
        }
        self.schedule_make_up(next.position);
        self.report_phase(cx, ended, next.position);
        Some(next)
    }

    /// Returns the velocity with which the axis continues after the coupling.
    pub(in crate::axis) fn steady_velocity(&self) -> f64 {
        let present = self.command.velocity();
        self.coupling().map_or(present, |coupling| coupling.follower.steady_velocity(present, self.cycle_s()))
    }
}

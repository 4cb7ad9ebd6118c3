//! A coupling that waits to engage: for the end of the active cam, a position of its leader, or a latch.
//!
//! Law      until then the present motion continues. Relative: the new cam begins exactly at the end, position or
//!          latch, also between two cycles. No increment of leader or slave is lost there, nor the remainders of the
//!          scales below 2^-32 inc if the scales stay the same. Absolute and ramp-in: leader and table are compared at
//!          the end of that cycle with the position at which the cam before would have the slave. Gears begin as in
//!          [`gear_in`](super::gear_in). Only the first latch counts, and none before the command
//! Reads    the leader of this cycle; the active cam; the latches of the cycle
//! Refuses  the end of a cam if no cam is active. When it engages: everything that a coupling without waiting refuses.
//!          Its goal then ends, and the present motion continues
//! Source   contract sections 7, 10, PLCopen (MC_CamIn, mcBuffered; MC_GearInPos), AMC-EVT-05

use super::cam::no_cam;
use crate::axis::goal::probe::first_latch;
use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::engagement::RECENT;
use crate::axis::state::pair::Pair;
use crate::axis::state::{Axis, Context, Coupling, Engagement, Generator, Numbers, Started};
use crate::code::Code;
use crate::command::{CamIn, Engage, ProbeEdge, Synchronize};
use crate::encoder::Lead;
use crate::event::{Event, Refusal};
use crate::object::Leader;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use crate::sync::cam::Cam;
use crate::sync::follower::Follower;
use crate::sync::{CamStart, SyncMode, Transmission};
use crate::table::Table;
use std::sync::Arc;

/// The event that engages a waiting coupling.
#[derive(Clone, Copy, Debug)]
enum Due {
    /// The cam before has passed its end.
    End,
    /// Distance of the leader after its position, or since the latch.
    Behind(Position),
}

impl Axis {
    /// Returns the leader that the axis will follow once it has engaged.
    pub fn engaging_leader(&self) -> Option<Leader> {
        self.coupling.engagement().map(|engagement| engagement.leader)
    }

    /// Lets a coupling wait to engage.
    ///
    /// # Errors
    /// A coupling without waiting would be refused, too; there is no end to wait for, or no path to its pair of
    /// positions.
    pub(super) fn wait_to_engage(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        (request, leader): (&Synchronize, Leader),
    ) -> Result<(), Refusal> {
        let lead = cx.leads.get(leader);
        let request = match request.cam {
            Some(cam) => self.check_waiting_cam(cx.tables, (request, cam), leader).map(|()| *request)?,
            None => {
                // The ratio at the command counts.
                let ratio = self.ratio_of(request)?;
                Synchronize { numerator: ratio.numerator(), denominator: ratio.denominator(), ..*request }
            }
        };
        let (seen, since) = (lead.position - lead.change, cx.cycle);
        let smooth = self.smooth_start(request.mode, lead);
        let engagement = Engagement { sequence, leader, request, seen, since, recent: [0.0; RECENT], count: 0, smooth };
        if !engagement.is_sound() {
            return Err(self.refuse(Code::BAD_REQUEST));
        }
        if let Some(pair) = Pair::of(request.engage) {
            self.check_pair(pair, &request, lead)?;
        }
        self.end_engagement(cx, Code::REPLACED, NO_NUMBERS);
        self.coupling.set_engagement(Some(engagement));
        // A cam that takes over at the end needs no rest there.
        self.rest_at_end(request.engage != Engage::AtEnd);
        self.accepted(cx, sequence);
        Ok(())
    }

    fn check_waiting_cam(
        &self,
        tables: &[Arc<Table>],
        (request, cam): (&Synchronize, CamIn),
        leader: Leader,
    ) -> Result<(), Refusal> {
        let numbers = tables.get(usize::from(cam.table)).ok_or_else(|| self.refuse(Code::BAD_REQUEST))?;
        numbers.cam().map_err(|error| no_cam(cam.table, error))?;
        if request.engage == Engage::AtEnd {
            let by_place = |coupling: &&Coupling| coupling.leader == leader && !coupling.follower.mode().has_marks();
            let under_way = self.coupling().filter(by_place);
            let cam = under_way.and_then(|coupling| coupling.follower.transmission().cam());
            if cam.is_none_or(|cam| cam.has_ended(tables)) {
                return Err(self.refuse(Code::ENGAGE_NO_CAM));
            }
        }
        Ok(())
    }

    /// Sets whether the slave of the active cam rests at its end.
    pub(in crate::axis) fn rest_at_end(&mut self, rests: bool) {
        self.motion.rest_at_end(rests);
    }

    /// Returns the number of the command that waits to engage; 0 for none.
    pub(in crate::axis) fn engaging(&self) -> u64 {
        self.coupling.engagement().map_or(0, |engagement| engagement.sequence)
    }

    /// Ends the wait.
    pub(in crate::axis) fn end_engagement(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        if let Some(engagement) = self.coupling.take_engagement() {
            self.rest_at_end(true);
            let done = Event::done(self.object(), engagement.sequence, code, self.command.position());
            cx.events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Engages the waiting coupling if its event occurs in this cycle.
    pub(in crate::axis) fn engage(&mut self, cx: &mut Context<'_>) {
        let Some(engagement) = *self.coupling.engagement() else { return };
        let lead = cx.leads.get(engagement.leader);
        if !lead.valid {
            return self.end_engagement(cx, Code::LEADER_LOST, NO_NUMBERS);
        }
        if engagement.smooth.is_some() {
            return self.engage_smoothly(cx, &engagement, lead);
        }
        let engagement = engagement.note_change(lead.change.to_f64());
        let moment = match self.moment_of(cx, &engagement, lead) {
            Ok(Some(moment)) => moment,
            Ok(None) => {
                self.coupling.set_engagement(Some(Engagement { seen: lead.position, ..engagement }));
                return;
            }
            Err(refusal) => return self.end_engagement(cx, refusal.code, (refusal.asked, refusal.limit)),
        };
        match self.engaged(cx.tables, (&engagement, lead), moment) {
            Ok(coupling) => {
                self.coupling.set_engagement(None);
                if matches!(moment, Due::End) {
                    // The goal of its cam has reached its end.
                    self.end_goal(cx, Code::NONE);
                }
                // Shifts against the same leader continue, except if a pair of positions defines the position of the
                // slave.
                let is_same = self.follows_by_position(engagement.leader).is_some();
                let goes_on = is_same && Pair::of(engagement.request.engage).is_none();
                let shifts =
                    if goes_on { (self.coupling.take_overlay(), self.coupling.take_phasing()) } else { (None, None) };
                self.take_over(cx, engagement.sequence, None);
                if goes_on && engagement.request.cam.is_none() {
                    self.continue_conditioning();
                } else {
                    self.begin_conditioning(engagement.request.mode, lead);
                }
                if Pair::of(engagement.request.engage).is_some() {
                    self.treat_offset_as_moved();
                }
                self.coupling.set_overlay(shifts.0);
                self.coupling.set_phasing(shifts.1);
                let reference = if engagement.request.cam.is_some() { Reference::Cam } else { Reference::Gear };
                self.begin_motion(cx, AxisState::SynchronizedMotion, reference, Generator::Follow(coupling));
            }
            Err(refusal) => self.end_engagement(cx, refusal.code, (refusal.asked, refusal.limit)),
        }
    }

    /// Advances a coupling that waits for a smooth start by marks.
    fn engage_smoothly(&mut self, cx: &mut Context<'_>, engagement: &Engagement, lead: Lead) {
        match self.start_smoothly(cx, engagement, lead) {
            Ok(None) => self.coupling.set_engagement(None),
            Ok(smooth) => self.coupling.set_engagement(Some(Engagement { smooth, ..*engagement })),
            Err(refusal) => self.end_engagement(cx, refusal.code, (refusal.asked, refusal.limit)),
        }
    }

    /// Returns the event for which the coupling waits if it occurs in this cycle.
    ///
    /// # Errors
    /// The event cannot occur any more.
    fn moment_of(&self, cx: &Context<'_>, engagement: &Engagement, lead: Lead) -> Result<Option<Due>, Refusal> {
        let Engagement { leader, request, seen, since, .. } = engagement;
        let behind = match request.engage {
            Engage::Immediately => None,
            Engage::AtPosition { position, turn } | Engage::InPosition { position, turn, distance: 0, .. } => {
                let place = Position::whole(position);
                let place = turn.map_or(place, |turn| turn.last_reached(place, lead.position, lead.change));
                passed(place, lead, *seen)
            }
            Engage::InPosition { .. } => match Pair::of(request.engage) {
                Some(pair) => self.passed_start(pair, lead)?,
                None => None,
            },
            Engage::OnEvent(source) => {
                let latch = first_latch(cx.latches, source, ProbeEdge::Rising).filter(|_| cx.cycle != *since);
                latch.map(|latch| latch.travel_since(*leader, lead, self.setup.cycle_ns))
            }
            Engage::AtEnd => {
                let cam = self.coupling().and_then(|coupling| coupling.follower.transmission().cam());
                let cam = cam.ok_or_else(|| self.refuse(Code::NOT_REACHED))?;
                return Ok(cam.passes_end(cx.tables).then_some(Due::End));
            }
        };
        Ok(behind.map(Due::Behind))
    }

    /// Returns the coupling that begins in this cycle.
    fn engaged(
        &self,
        tables: &[Arc<Table>],
        (engagement, lead): (&Engagement, Lead),
        moment: Due,
    ) -> Result<Coupling, Refusal> {
        let Engagement { leader, request, .. } = engagement;
        self.check_closed_loop()?;
        self.check_free()?;
        let bad_request = || self.refuse(Code::BAD_REQUEST);
        let Some(cam) = &request.cam else {
            let Due::Behind(after) = moment else { return Err(bad_request()) };
            let started = Started { leader: *leader, lead, mean: engagement.mean(), after };
            let follower = self.engaged_gear(tables, request, started)?;
            return Ok(self.coupling_by(*leader, request, follower));
        };
        let bounds = self.bounds_of(request)?;
        let before = self.follows_by_position(*leader);
        let led = self.leading_distance(request.mode);
        let stands = before.map_or_else(|| self.present_motion().position - led, Follower::place);
        let (next, offset) = self.cam_of(tables, lead, (cam, request.disengage), stands)?;
        let next = next.with_mean(self.mean_of(*leader, lead));
        // Target of the slave, and the cam there.
        let (target, next) = if cam.start == CamStart::Relative {
            let (change, next) = match (before.map(|before| *before.transmission()), moment) {
                (Some(Transmission::Cam(old)), Due::End) => old.handed_over(next, tables).ok_or_else(bad_request)?,
                (old, Due::Behind(after)) => began_in_past(old, next, after, tables),
                (_, Due::End) => return Err(bad_request()),
            };
            (stands + offset + change, next)
        } else {
            (stands + offset, next)
        };
        let transmission = Transmission::Cam(next);
        let goes_on = cam.start == CamStart::Relative && offset == Position::ZERO;
        let follower = match before {
            Some(before) => before.handed_over(transmission, target, bounds, goes_on),
            None => {
                let present = self.present_motion();
                let offset = target + led - present.position;
                Follower::new(lead.uneven, transmission, request.mode, present, offset, bounds).leading_by(led)
            }
        };
        Ok(self.coupling_by(*leader, request, follower))
    }

    /// Returns the change of a leader in a cycle (inc), smoothed if the axis is already on a cam of this leader.
    pub(super) fn mean_of(&self, leader: Leader, lead: Lead) -> f64 {
        let cam = self.follows_by_position(leader).and_then(|follower| follower.transmission().cam());
        cam.map_or(lead.change.to_f64(), Cam::mean)
    }

    /// Returns the follower if it keeps a position to that leader.
    pub(super) fn follows_by_position(&self, leader: Leader) -> Option<&Follower> {
        let coupling = self.coupling().filter(|coupling| coupling.leader == leader);
        coupling.map(|coupling| &coupling.follower).filter(|follower| follower.mode() == SyncMode::Position)
    }
}

/// Returns the change of the slave, and the next cam, for a cam that began when the leader was `after` before its
/// present position. Until now `old` has moved the slave.
fn began_in_past(old: Option<Transmission>, next: Cam, after: Position, tables: &[Arc<Table>]) -> (Position, Cam) {
    let mean = next.mean();
    let (back, mut next) = match old {
        None => (Position::ZERO, next),
        Some(Transmission::Cam(mut old)) => (old.step(-after, tables), next.continued_from(&old)),
        Some(mut gear) => (gear.step(Lead { change: -after, ..Lead::default() }, tables), next),
    };
    let change = next.step(after, tables);
    (back + change, next.with_mean(mean))
}

/// Returns the distance of the leader after a position that it has reached in this cycle from either side, or at which
/// it rests. `seen` is its position in the cycle before; since then its coordinate may have been set.
pub(super) fn passed(place: Position, lead: Lead, seen: Position) -> Option<Position> {
    let (before, now) = (lead.position - lead.change, lead.position);
    let is_there = place == now || place == before && before != seen;
    let is_passed = is_there || (before < place && place < now) || (now < place && place < before);
    is_passed.then(|| now - place)
}

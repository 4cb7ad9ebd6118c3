//! Processing of the master motion before the gear of an axis, and motions added to the slave.
//!
//! Law      in this order: backward motion is stored, and later forward motion first makes up for it (SYNCTYPE 4). The
//!          velocity is filtered (SYNCVFTIME). An offset is added to the motion of the master, at once or as a
//!          trapezoid (SYNCPOSOFFS, SYNCOFFTIME). The gear treats it as any motion of the master, so that an offset
//!          that is removed again leaves no error. A distance that the slave could not move because of REVERS is made
//!          up by the same trapezoid, geared. The slave leads by a share of its velocity (SYNCFFVEL). No increment is
//!          lost, except in the filter in modes that keep no position of the master. If a function is switched off in
//!          motion, the distance that it holds is added at once
//! Reads    the parameters of synchronization; SYNCTYPE at the start of the coupling
//! Refuses  nothing: the axis follows within its limits
//! Source   MACS-SYNC-05, -08 to -15, MACS-DIR-07, A-30, A-57

use crate::axis::state::conditioning::{apply_step, shift};
use crate::axis::state::{Axis, Conditioning, Context, MarkPath};
use crate::encoder::Lead;
use crate::parameter::OffsetRates;
use crate::position::Position;
use crate::state::Reference;
use crate::sync::SyncMode;
use crate::sync::filter::{Filtering, Keeps, MasterFilter};
use crate::sync::follower::{AddedMotion, Follower};
use crate::vocabulary::Owner;

/// Cycles without prevented backward motion before it is reported again.
const SILENCE: u16 = 250;

/// The input of the follower in a cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::axis) struct Conditioned {
    pub lead: Lead,
    pub beside: AddedMotion,
}

impl Axis {
    /// Whether the coupling is one to which the parameters of MACS apply.
    fn conditions(&self) -> bool {
        self.status.owner() == Owner::Native && matches!(self.status.reference(), Reference::Gear | Reference::Cam)
    }

    /// Whether the motion of the master is changed before the gear, or a motion is added to the slave.
    pub(in crate::axis) fn is_conditioned(&self) -> bool {
        let Some(follower) = self.coupling().map(|coupling| &coupling.follower).filter(|_| self.conditions()) else {
            return false;
        };
        let p = &self.parameters;
        let by_position = follower.mode().keeps_position();
        let is_gear = follower.transmission().cam().is_none();
        self.coupling.conditioning().keeps_backward
            || by_position && (p.sync.feed_forward != 0 || p.sync.velocity_band != 0)
            || is_gear && p.master_tau(by_position).is_some()
            || is_gear && by_position && p.sync.offset != self.coupling.conditioning().offset
            || !self.coupling.conditioning().is_empty()
    }

    /// Returns the filter settings for the master of a gear. None: no filter.
    fn filtering(&self, follower: &Follower) -> Option<Filtering> {
        let mode = follower.mode();
        let tau = self.parameters.master_tau(mode.keeps_position())?;
        let keeps = match mode {
            SyncMode::Velocity => Keeps::Velocity,
            SyncMode::Position => Keeps::Position,
            _ => Keeps::Marks,
        };
        let is_gear = follower.transmission().cam().is_none();
        is_gear.then_some(Filtering { tau, keeps, limit: self.parameters.sync.filter_limit as f64 })
    }

    /// Returns the active time constant of the filter of the master (us); 0 without a filter.
    pub(in crate::axis) fn filter_tau(&self) -> f64 {
        let (Some(filter), Some(coupling)) = (&self.coupling.conditioning().filter, self.coupling()) else {
            return 0.0;
        };
        self.filtering(&coupling.follower).map_or(0.0, |filtering| filter.tau(&filtering))
    }

    /// Returns the motion that the slave follows in this cycle, and the motions added to it.
    pub(super) fn condition(&mut self, cx: &mut Context<'_>, lead: Lead) -> Conditioned {
        let Some(coupling) = self.coupling().filter(|_| self.conditions()) else {
            return Conditioned { lead, ..Conditioned::default() };
        };
        let follower = &coupling.follower;
        let (mode, is_turned) = (follower.mode(), follower.transmission().is_mirrored());
        let (is_gear, slope) = (follower.transmission().cam().is_none(), follower.transmission().signed_slope());
        let by_position = mode.keeps_position();
        let cycle_s = self.cycle_s();
        let sync = self.parameters.sync;
        let filtering = self.filtering(follower);
        let tau = filtering.map(|filtering| filtering.tau);
        let fastest = follower.catch_up_velocity() * cycle_s;
        let state = self.coupling.conditioning_mut();

        let mut next = lead;
        if state.keeps_backward {
            next.change = state.store(next.change, is_turned);
        }
        let passed_on = next.change;
        // A master whose backward motion is stored, and not followed, has no velocity.
        let velocity = if state.keeps_backward { passed_on.to_f64() } else { lead.velocity * cycle_s };
        // The distance that a filter releases is no motion of the master in this cycle.
        let mut owed = Position::ZERO;
        if let Some(filtering) = filtering {
            let cycle_us = cycle_s * 1e6;
            let filter = state.filter.get_or_insert(MasterFilter::settled(velocity));
            next.uneven = lead.uneven * filter.smoothing_factor(&filtering, cycle_us);
            next.change = filter.step(next.change, &filtering, cycle_us);
        } else if let Some(filter) = state.filter.take() {
            owed = filter.lag_distance();
            next.change += owed;
        }
        if !by_position {
            return Conditioned { lead: next, ..Conditioned::default() };
        }
        if let Some(rates) = state.rates(&sync, is_gear) {
            state.continue_at(rates, cycle_s);
        }
        let band = state.band(sync.velocity_band, velocity * slope, lead.uneven > 0.0, cycle_s);
        // Added motions must keep the velocity band, and the sum must not exceed the velocity of the goal.
        let most = band.map_or(f64::INFINITY, |band| {
            (band.velocity * band.share).abs().min((fastest - band.velocity.abs()).max(0.0))
        });
        let of_master = if slope == 0.0 { f64::INFINITY } else { most / slope.abs() };
        let most_of_marks = if mode == SyncMode::MasterMarker { of_master } else { most };
        let marks = self.step_marks(cx, (lead, passed_on), tau, most_of_marks).unwrap_or_default();
        let state = self.coupling.conditioning_mut();
        if marks.holds {
            // The master counts from there on.
            state.backward = Position::ZERO;
            (next.change, next.uneven) = (marks.master, lead.uneven);
            return Conditioned { lead: next, ..Conditioned::default() };
        }
        let rates = state.rates(&sync, is_gear);
        next.change += Position::from_f64(passed_on.to_f64() * marks.gear);
        let mut added = marks.master;
        if is_gear {
            let wanted = state.marks.as_ref().map_or(sync.offset, |marks| marks.offset(sync.offset));
            added += state.step_offset(wanted, rates, cycle_s, most / slope.abs());
        } else if state.marks.is_some() {
            // Corrections of the master of a cam.
            added += apply_step(&mut state.shift, rates, of_master);
        }
        next.change += added;
        if let Some(path) = state.marks.as_mut().filter(|_| !is_gear) {
            path.cam.given = next.change - passed_on;
        }
        let way = marks.way + apply_step(&mut state.late, rates, most);
        state.by_rule &= state.late.is_some();
        let beside = AddedMotion { way, added: added + owed, ahead: sync.ahead(cycle_s), band };
        Conditioned { lead: next, beside }
    }

    /// Makes up for prevented backward motion of the slave at `position` within syncofftime, if that is set.
    pub(super) fn schedule_make_up(&mut self, position: Position) {
        let (conditions, cycle_s) = (self.conditions(), self.cycle_s());
        let Some(follower) = self.motion.follower_mut() else { return };
        let is_barred = follower.is_reverse_prevented() && follower.mode().keeps_position();
        let silent = &mut self.coupling.conditioning_mut().silent;
        *silent = if is_barred { SILENCE } else { silent.saturating_sub(1) };
        if !is_barred || !conditions {
            return;
        }
        let is_gear = follower.transmission().cam().is_none();
        let rates = self.coupling.conditioning().rates(&self.parameters.sync, is_gear);
        let Some(OffsetRates { velocity, acceleration }) = rates else { return };
        // Marks of a slave are in its own increments.
        let is_own = follower.mode() == SyncMode::SlaveMarker;
        let slope = if is_own { 1.0 } else { follower.transmission().slope() };
        let rates = OffsetRates { velocity: velocity * slope, acceleration: acceleration * slope };
        let lacked = follower.settle(position);
        let state = self.coupling.conditioning_mut();
        // The part of this cycle that was prevented has not been moved: the trapezoid begins at the actual speed of the
        // slave.
        let before = state.late.map(|late| late.limited_to(late.speed() - lacked.to_f64()));
        let whole = before.map_or(Position::ZERO, |late| late.left()) + lacked;
        // Nothing is left to make up for.
        state.late = (whole != Position::ZERO).then(|| shift(whole, rates, cycle_s, before.as_ref()));
        state.late_slope = slope;
        state.by_rule = state.late.is_some();
    }

    /// Whether prevented backward motion was reported recently.
    pub(super) fn was_reverse_prevented(&self) -> bool {
        self.coupling.conditioning().silent > 0
    }

    /// Whether the slave makes up for prevented backward motion.
    pub(in crate::axis) fn is_late(&self) -> bool {
        self.coupling.conditioning().by_rule
    }

    /// Returns the distance that the slave lacks in addition to the error of its follower.
    pub(in crate::axis) fn missing_distance(&self) -> Position {
        if self.coupling.conditioning().is_empty() {
            return Position::ZERO;
        }
        let slope = self.coupling().map_or(0.0, |coupling| coupling.follower.transmission().signed_slope());
        let late = self.coupling.conditioning().late.map_or(Position::ZERO, |late| late.left());
        let owed = self.coupling.conditioning().filter.map_or(Position::ZERO, |filter| filter.lag_distance());
        let spread = self.coupling.conditioning().marks.map_or(Position::ZERO, |marks| marks.remaining_corrections());
        let of_master = self.coupling.conditioning().marks.is_some_and(|marks| marks.mode == SyncMode::MasterMarker);
        let spread = if of_master { Position::from_f64(spread.to_f64() * slope) } else { spread };
        Position::from_f64(owed.to_f64() * slope) + late + spread
    }

    /// Returns the commanded distance that the slave has not moved yet, without distances spread for marks.
    pub(super) fn pending_distance(&self) -> Position {
        let Some(follower) = self.coupling().map(|coupling| &coupling.follower) else { return Position::ZERO };
        let Conditioning { late, shift, .. } = self.coupling.conditioning();
        let late = late.map_or(Position::ZERO, |late| late.left());
        let shift = shift.map_or(0.0, |shift| shift.left().to_f64() * follower.transmission().signed_slope());
        follower.error(self.command.position()) + late + Position::from_f64(shift)
    }

    /// Returns the stored backward motion of the master, and the lag of its filter (inc of the master).
    pub(in crate::axis) fn stored_of_master(&self) -> (Position, Position) {
        let lacked = self.coupling.conditioning().filter.map_or(Position::ZERO, |filter| filter.error());
        (self.coupling.conditioning().backward, lacked)
    }

    /// Begins for a coupling to that lead.
    pub(super) fn begin_conditioning(&mut self, mode: SyncMode, lead: Lead) {
        let velocity = lead.velocity * self.cycle_s();
        let marks = mode.has_marks().then(|| MarkPath::new(mode, &self.parameters.marks, velocity));
        *self.coupling.conditioning_mut() = Conditioning::begin(&self.parameters.sync, marks);
    }

    /// Continues with another gear of the same leader.
    pub(super) fn continue_conditioning(&mut self) {
        self.coupling.conditioning_mut().keeps_backward = self.parameters.sync.keeps_backward();
    }

    /// Treats the offset as already moved: a pair of positions includes it, and a later offset shifts the slave by the
    /// difference.
    pub(super) fn treat_offset_as_moved(&mut self) {
        self.coupling.conditioning_mut().offset = self.parameters.sync.offset;
    }

    /// Clears the state when the coupling has ended.
    pub(in crate::axis) fn settle_conditioning(&mut self) {
        if (self.coupling().is_none() || !self.conditions()) && !self.coupling.conditioning().is_empty() {
            *self.coupling.conditioning_mut() = Conditioning::default();
        }
    }
}

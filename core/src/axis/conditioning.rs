//! What becomes of a master's motion before the gear of an axis, and what comes beside it.
//!
//! Law      in this order: backward motion is stored, and goes before further forward motion (SYNCTYPE 4). The velocity is filtered
//!          (SYNCVFTIME). An offset is a way of the master that is added, at once or as a trapezoid (SYNCPOSOFFS, SYNCOFFTIME): the gear
//!          makes of it what it makes of any motion, so that an offset taken back leaves nothing. What the rule of reversing has kept a
//!          slave from is worked off by the same trapezoid, geared. The slave is led ahead by a share of its velocity (SYNCFFVEL).
//!          But for the filter in modes that keep no position of the master, no increment is lost on these ways: what one gives up while it is
//!          switched off in motion comes at once
//! Reads    the parameters of synchronization; SYNCTYPE as the coupling began
//! Refuses  nothing: its axis follows within its limits
//! Source   MACS-SYNC-05, -08 to -15, MACS-DIR-07, A-30, A-57

use super::marker::MarkPath;
use super::{Axis, Context, Reference};
use crate::encoder::Lead;
use crate::parameter::{OffsetRates, Synchronization};
use crate::position::Position;
use crate::sync::filter::{Filtering, Keeps, MasterFilter};
use crate::sync::follower::{Band, Beside, Follower};
use crate::sync::{Shift, SyncMode};
use crate::vocabulary::Owner;
use serde::{Deserialize, Serialize};

/// Time over which the velocity of a counted master is smoothed for the band (ms).
const MEAN_TIME: f64 = 64.0;
/// Cycles without the rule of reversing before it is told again.
const SILENCE: u16 = 250;

/// What an axis follows in a cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Conditioned {
    pub lead: Lead,
    pub beside: Beside,
}

/// What a coupling keeps of its master's motion.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Conditioning {
    /// Backward motion is stored.
    keeps_backward: bool,
    /// What is stored (inc of the master), never below 0.
    backward: Position,
    /// While there is one.
    filter: Option<MasterFilter>,
    /// The offset that the slave has, or is on its way to (inc of the master).
    offset: i64,
    /// That way.
    shift: Option<Shift>,
    /// The way on which a slave makes up for what the rule has kept it from.
    pub(super) late: Option<Shift>,
    /// Its increments per increment of what SYNCOFFTIME is for.
    pub(super) late_slope: f64,
    /// It is what the rule has kept it from, and no correction for marks.
    by_rule: bool,
    /// Cycles until the rule is told again once it keeps the slave from something.
    silent: u16,
    /// The master's geared velocity for the band (inc per cycle), smoothed.
    mean: Option<f64>,
    /// Of a coupling by marks.
    pub(super) marks: Option<MarkPath>,
}

impl Conditioning {
    /// That of a coupling that begins.
    fn begin(sync: &Synchronization, marks: Option<MarkPath>) -> Self {
        Self { keeps_backward: sync.keeps_backward(), marks, ..Self::default() }
    }

    /// The offset that the slave has, or is on its way to (inc of the master).
    pub(super) fn offset_given(&self) -> i64 {
        self.offset
    }

    pub(super) fn is_sound(&self) -> bool {
        let shifts = [&self.shift, &self.late];
        self.filter.is_none_or(|filter| filter.is_sound())
            && self.backward >= Position::ZERO
            && self.backward.is_legal()
            && self.mean.is_none_or(f64::is_finite)
            && self.late_slope.is_finite()
            && self.marks.is_none_or(|marks| marks.is_sound())
            && shifts.into_iter().all(|shift| shift.is_none_or(|shift| shift.is_sound()))
    }

    /// The filter of its master, while there is one.
    pub(super) fn filter(&self) -> Option<MasterFilter> {
        self.filter
    }

    /// Goes on with the filter of the coupling before.
    pub(super) fn go_on_with(&mut self, filter: Option<MasterFilter>) {
        self.filter = filter;
    }

    /// What is left of a shift of the master.
    pub(super) fn shift_left(&self) -> Position {
        self.shift.map_or(Position::ZERO, |shift| shift.left())
    }

    /// Shifts the master by so much more.
    pub(super) fn shift_master(&mut self, way: Position, rates: OffsetRates, cycle_s: f64) {
        if way != Position::ZERO {
            self.shift = Some(shift(self.shift_left() + way, rates, cycle_s, self.shift.as_ref()));
        }
    }

    /// Is there nothing that it has to give?
    fn is_empty(&self) -> bool {
        self.backward == Position::ZERO
            && self.filter.is_none()
            && self.shift.is_none()
            && self.late.is_none()
            && self.marks.is_none()
            && self.silent == 0
    }

    /// What is left of a change when backward motion is stored; a turned master goes backwards where it counts up.
    fn store(&mut self, change: Position, is_turned: bool) -> Position {
        let turn = |way: Position| if is_turned { -way } else { way };
        let forwards = turn(change);
        let goes_on = if forwards < Position::ZERO {
            self.backward = self.backward - forwards;
            Position::ZERO
        } else {
            let consumed = forwards.min(self.backward);
            self.backward = self.backward - consumed;
            forwards - consumed
        };
        turn(goes_on)
    }

    /// The band in which the slave stays while it catches up, with a velocity of its master (geared, inc per cycle) that may be one of single counts.
    fn band(&mut self, share: i64, velocity: f64, is_uneven: bool, cycle_s: f64) -> Option<Band> {
        if share == 0 {
            self.mean = None;
            return None;
        }
        let before = self.mean.unwrap_or(velocity);
        let weight = if is_uneven { (cycle_s * 1e3 / MEAN_TIME).min(1.0) } else { 1.0 };
        let mean = before + (velocity - before) * weight;
        self.mean = Some(mean);
        Some(Band { velocity: mean, share: share as f64 / 100.0 })
    }

    /// The rates of now, by which all is worked off; none: at once. For the marks of a cam SYNCOFFTIME is the time of its period.
    fn rates(&self, sync: &Synchronization, is_gear: bool) -> Option<OffsetRates> {
        let period = self.marks.as_ref().and_then(|marks| marks.cam.period()).filter(|_| !is_gear);
        Synchronization { mark_distance: period.unwrap_or(sync.mark_distance), ..*sync }.offset_rates()
    }

    /// What is under way goes on with these rates.
    fn go_on_at(&mut self, rates: OffsetRates, cycle_s: f64) {
        let OffsetRates { velocity, acceleration } = rates;
        let slope = self.late_slope;
        self.shift = self.shift.map(|shift| shift.at_rates(velocity, acceleration, cycle_s));
        self.late = self.late.map(|late| late.at_rates(velocity * slope, acceleration * slope, cycle_s));
    }

    /// What a new offset, or one under way, adds to the master's change.
    fn step_offset(&mut self, wanted: i64, rates: Option<OffsetRates>, cycle_s: f64, most: f64) -> Position {
        let mut way = Position::ZERO;
        if wanted != self.offset {
            let left = self.shift.map_or(Position::ZERO, |shift| shift.left());
            let whole = left + Position::whole(wanted) - Position::whole(self.offset);
            self.offset = wanted;
            self.shift = rates.map(|rates| shift(whole, rates, cycle_s, self.shift.as_ref()));
            if rates.is_none() {
                way = whole;
            }
        }
        way + give(&mut self.shift, rates, most)
    }
}

pub(super) fn shift(whole: Position, rates: OffsetRates, cycle_s: f64, before: Option<&Shift>) -> Shift {
    Shift::new(whole, rates.velocity, rates.acceleration, cycle_s, before)
}

/// One cycle of a shift, no faster than `most`, which is over at its end.
fn step(shift: &mut Option<Shift>, most: f64) -> Position {
    let Some(under_way) = shift else { return Position::ZERO };
    let (way, has_ended) = under_way.step_within(most);
    if has_ended {
        *shift = None;
    }
    way
}

/// The same; without rates all of it at once.
fn give(shift: &mut Option<Shift>, rates: Option<OffsetRates>, most: f64) -> Position {
    if rates.is_some() { step(shift, most) } else { shift.take().map_or(Position::ZERO, |shift| shift.left()) }
}

impl Axis {
    /// Is it coupled as parameters of MACS say?
    fn conditions(&self) -> bool {
        self.owner == Owner::Native && matches!(self.reference, Reference::Gear | Reference::Cam)
    }

    /// Does anything come between its master and its gear, or beside?
    pub(super) fn is_conditioned(&self) -> bool {
        let Some(follower) = self.coupling().map(|coupling| &coupling.follower).filter(|_| self.conditions()) else {
            return false;
        };
        let p = &self.parameters;
        let by_position = follower.mode().keeps_position();
        let is_gear = follower.transmission().cam().is_none();
        self.conditioning.keeps_backward
            || by_position && (p.sync.feed_forward != 0 || p.sync.velocity_band != 0)
            || is_gear && p.master_tau(by_position).is_some()
            || is_gear && by_position && p.sync.offset != self.conditioning.offset
            || !self.conditioning.is_empty()
    }

    /// How parameters ask for its master to be filtered, in a gear; none: it is not.
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

    /// The tau in force of the filter of its master (us); 0 without a filter.
    pub(super) fn filter_tau(&self) -> f64 {
        let (Some(filter), Some(coupling)) = (&self.conditioning.filter, self.coupling()) else { return 0.0 };
        self.filtering(&coupling.follower).map_or(0.0, |filtering| filter.tau(&filtering))
    }

    /// What the slave follows in this cycle, and what comes beside.
    pub(super) fn condition(&mut self, cx: &mut Context<'_>, lead: Lead) -> Conditioned {
        let Some(coupling) = self.coupling().filter(|_| self.conditions()) else {
            return Conditioned { lead, ..Conditioned::default() };
        };
        let follower = &coupling.follower;
        let (mode, is_turned) = (follower.mode(), follower.transmission().is_turned());
        let (is_gear, slope) = (follower.transmission().cam().is_none(), follower.transmission().signed_slope());
        let by_position = mode.keeps_position();
        let cycle_s = self.cycle_s();
        let sync = self.parameters.sync;
        let filtering = self.filtering(follower);
        let tau = filtering.map(|filtering| filtering.tau);
        let fastest = follower.catch_up_velocity() * cycle_s;
        let state = &mut self.conditioning;

        let mut next = lead;
        if state.keeps_backward {
            next.change = state.store(next.change, is_turned);
        }
        let passed_on = next.change;
        // Of a master that goes backwards, and is not followed, it has none.
        let velocity = if state.keeps_backward { passed_on.to_f64() } else { lead.velocity * cycle_s };
        // What a filter gives up is no motion of the master in this cycle.
        let mut owed = Position::ZERO;
        if let Some(filtering) = filtering {
            let cycle_us = cycle_s * 1e6;
            let filter = state.filter.get_or_insert(MasterFilter::settled(velocity));
            next.uneven = lead.uneven * filter.smooths(&filtering, cycle_us);
            next.change = filter.step(next.change, &filtering, cycle_us);
        } else if let Some(filter) = state.filter.take() {
            owed = filter.owed();
            next.change += owed;
        }
        if !by_position {
            return Conditioned { lead: next, ..Conditioned::default() };
        }
        if let Some(rates) = state.rates(&sync, is_gear) {
            state.go_on_at(rates, cycle_s);
        }
        let band = state.band(sync.velocity_band, velocity * slope, lead.uneven > 0.0, cycle_s);
        // What comes beside leaves the velocity of the master by no more than the band has, and is no faster than the goal.
        let most = band.map_or(f64::INFINITY, |band| {
            (band.velocity * band.share).abs().min((fastest - band.velocity.abs()).max(0.0))
        });
        let of_master = if slope == 0.0 { f64::INFINITY } else { most / slope.abs() };
        let most_of_marks = if mode == SyncMode::MasterMarker { of_master } else { most };
        let marks = self.step_marks(cx, (lead, passed_on), tau, most_of_marks).unwrap_or_default();
        let state = &mut self.conditioning;
        if marks.holds {
            // It counts from there on.
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
            // Of the master of a cam.
            added += give(&mut state.shift, rates, of_master);
        }
        next.change += added;
        if let Some(path) = state.marks.as_mut().filter(|_| !is_gear) {
            path.cam.given = next.change - passed_on;
        }
        let way = marks.way + give(&mut state.late, rates, most);
        state.by_rule &= state.late.is_some();
        let beside = Beside { way, added: added + owed, ahead: sync.ahead(cycle_s), band };
        Conditioned { lead: next, beside }
    }

    /// What the rule of reversing has kept the slave at `position` from, it makes up for in syncofftime, where that is one.
    pub(super) fn make_up_later(&mut self, position: Position) {
        let (conditions, cycle_s) = (self.conditions(), self.cycle_s());
        let Some(follower) = self.generator.follower_mut() else { return };
        let is_barred = follower.is_barred() && follower.mode().keeps_position();
        let silent = &mut self.conditioning.silent;
        *silent = if is_barred { SILENCE } else { silent.saturating_sub(1) };
        if !is_barred || !conditions {
            return;
        }
        let is_gear = follower.transmission().cam().is_none();
        let rates = self.conditioning.rates(&self.parameters.sync, is_gear);
        let Some(OffsetRates { velocity, acceleration }) = rates else { return };
        // Marks of a slave have its own increments.
        let is_own = follower.mode() == SyncMode::SlaveMarker;
        let slope = if is_own { 1.0 } else { follower.transmission().slope() };
        let rates = OffsetRates { velocity: velocity * slope, acceleration: acceleration * slope };
        let lacked = follower.settle(position);
        let late = &mut self.conditioning.late;
        // What the rule has taken back of this cycle has not come: the trapezoid begins where the slave lets it.
        let before = late.map(|late| late.held_to(late.speed() - lacked.to_f64()));
        let whole = before.map_or(Position::ZERO, |late| late.left()) + lacked;
        // One that stands has nothing to make up for.
        *late = (whole != Position::ZERO).then(|| shift(whole, rates, cycle_s, before.as_ref()));
        self.conditioning.late_slope = slope;
        self.conditioning.by_rule = late.is_some();
    }

    /// Was it told not long ago that it was kept from going backwards?
    pub(super) fn was_barred(&self) -> bool {
        self.conditioning.silent > 0
    }

    /// Does it make up for what the rule has kept it from?
    pub(super) fn is_late(&self) -> bool {
        self.conditioning.by_rule
    }

    /// What of its way the slave lacks beside what its follower knows.
    pub(super) fn held_back(&self) -> Position {
        if self.conditioning.is_empty() {
            return Position::ZERO;
        }
        let slope = self.coupling().map_or(0.0, |coupling| coupling.follower.transmission().signed_slope());
        let late = self.conditioning.late.map_or(Position::ZERO, |late| late.left());
        let owed = self.conditioning.filter.map_or(Position::ZERO, |filter| filter.owed());
        let spread = self.conditioning.marks.map_or(Position::ZERO, |marks| marks.left());
        let of_master = self.conditioning.marks.is_some_and(|marks| marks.mode == SyncMode::MasterMarker);
        let spread = if of_master { Position::from_f64(spread.to_f64() * slope) } else { spread };
        Position::from_f64(owed.to_f64() * slope) + late + spread
    }

    /// What was ordered of the slave and is not done yet, but what is spread for marks.
    pub(super) fn under_way(&self) -> Position {
        let Some(follower) = self.coupling().map(|coupling| &coupling.follower) else { return Position::ZERO };
        let Conditioning { late, shift, .. } = &self.conditioning;
        let late = late.map_or(Position::ZERO, |late| late.left());
        let shift = shift.map_or(0.0, |shift| shift.left().to_f64() * follower.transmission().signed_slope());
        follower.error(self.command.position) + late + Position::from_f64(shift)
    }

    /// What is stored of its master's backward motion, and what its filter lacks (inc of the master).
    pub(super) fn kept_of_master(&self) -> (Position, Position) {
        let lacked = self.conditioning.filter.map_or(Position::ZERO, |filter| filter.error());
        (self.conditioning.backward, lacked)
    }

    /// Begins for a coupling to that lead.
    pub(super) fn begin_conditioning(&mut self, mode: SyncMode, lead: Lead) {
        let velocity = lead.velocity * self.cycle_s();
        let marks = mode.has_marks().then(|| MarkPath::new(mode, &self.parameters.marks, velocity));
        self.conditioning = Conditioning::begin(&self.parameters.sync, marks);
    }

    /// Goes on for another gear of the same leader.
    pub(super) fn go_on_conditioning(&mut self) {
        self.conditioning.keeps_backward = self.parameters.sync.keeps_backward();
    }

    /// A pair of places says where the slave is: it has its offset by then, and what is given later shifts it by the difference.
    pub(super) fn take_offset_for_given(&mut self) {
        self.conditioning.offset = self.parameters.sync.offset;
    }

    /// Where its coupling is over, nothing is kept.
    pub(super) fn settle_conditioning(&mut self) {
        if (self.coupling().is_none() || !self.conditions()) && !self.conditioning.is_empty() {
            self.conditioning = Conditioning::default();
        }
    }
}

//! State of the processing of the master motion.

use super::mark_path::MarkPath;
use crate::parameter::{OffsetRates, Synchronization};
use crate::position::Position;
use crate::sync::Shift;
use crate::sync::filter::MasterFilter;
use crate::sync::follower::Band;
use serde::{Deserialize, Serialize};

/// Time over which the velocity of a counted master is smoothed for the velocity band (ms).
const MEAN_TIME: f64 = 64.0;

/// State of the processing of the master motion.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct Conditioning {
    /// Whether backward motion is stored.
    pub(in crate::axis) keeps_backward: bool,
    /// Stored backward motion (inc of the master), never below 0.
    pub(in crate::axis) backward: Position,
    /// Filter of the master, if in use.
    pub(in crate::axis) filter: Option<MasterFilter>,
    /// Offset that the slave has, or moves to (inc of the master).
    pub(in crate::axis) offset: i64,
    /// The motion to this offset.
    pub(in crate::axis) shift: Option<Shift>,
    /// The motion by which a slave makes up for prevented backward motion.
    pub(in crate::axis) late: Option<Shift>,
    /// Increments of this motion per increment to which SYNCOFFTIME applies.
    pub(in crate::axis) late_slope: f64,
    /// Whether the distance comes from prevented backward motion, not from a correction by marks.
    pub(in crate::axis) by_rule: bool,
    /// Cycles until prevented backward motion is reported again.
    pub(in crate::axis) silent: u16,
    /// Smoothed geared velocity of the master for the velocity band (inc per cycle).
    mean: Option<f64>,
    /// State of a coupling by marks.
    pub(in crate::axis) marks: Option<MarkPath>,
}

impl Conditioning {
    /// Returns the state for a coupling that begins.
    pub(in crate::axis) fn begin(sync: &Synchronization, marks: Option<MarkPath>) -> Self {
        Self { keeps_backward: sync.keeps_backward(), marks, ..Self::default() }
    }

    /// Returns the offset that the slave has, or moves to (inc of the master).
    pub(in crate::axis) fn offset_given(&self) -> i64 {
        self.offset
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        let shifts = [&self.shift, &self.late];
        self.filter.is_none_or(|filter| filter.is_sound())
            && self.backward >= Position::ZERO
            && self.backward.is_legal()
            && self.mean.is_none_or(f64::is_finite)
            && self.late_slope.is_finite()
            && self.marks.is_none_or(|marks| marks.is_sound())
            && shifts.into_iter().all(|shift| shift.is_none_or(|shift| shift.is_sound()))
    }

    /// Returns the filter of the master if in use.
    pub(in crate::axis) fn filter(&self) -> Option<MasterFilter> {
        self.filter
    }

    /// Continues with the filter of the coupling before.
    pub(in crate::axis) fn continue_filter(&mut self, filter: Option<MasterFilter>) {
        self.filter = filter;
    }

    /// Returns the remaining shift of the master.
    pub(in crate::axis) fn shift_left(&self) -> Position {
        self.shift.map_or(Position::ZERO, |shift| shift.left())
    }

    /// Shifts the master by a further distance.
    pub(in crate::axis) fn shift_master(&mut self, way: Position, rates: OffsetRates, cycle_s: f64) {
        if way != Position::ZERO {
            self.shift = Some(shift(self.shift_left() + way, rates, cycle_s, self.shift.as_ref()));
        }
    }

    /// Whether there is nothing left to add.
    pub(in crate::axis) fn is_empty(&self) -> bool {
        self.backward == Position::ZERO
            && self.filter.is_none()
            && self.shift.is_none()
            && self.late.is_none()
            && self.marks.is_none()
            && self.silent == 0
    }

    /// Returns the rest of a change after backward motion is stored. With a negative ratio the master moves backward
    /// while it counts up.
    pub(in crate::axis) fn store(&mut self, change: Position, is_turned: bool) -> Position {
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

    /// Returns the velocity band of a slave that catches up, from the velocity of its master (geared, inc per cycle),
    /// which may come from single counts.
    pub(in crate::axis) fn band(&mut self, share: i64, velocity: f64, is_uneven: bool, cycle_s: f64) -> Option<Band> {
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

    /// Returns the present rates for all corrections. None: at once. For the marks of a cam SYNCOFFTIME is the time of
    /// its period.
    pub(in crate::axis) fn rates(&self, sync: &Synchronization, is_gear: bool) -> Option<OffsetRates> {
        let period = self.marks.as_ref().and_then(|marks| marks.cam.period()).filter(|_| !is_gear);
        Synchronization { mark_distance: period.unwrap_or(sync.mark_distance), ..*sync }.offset_rates()
    }

    /// Continues active corrections with these rates.
    pub(in crate::axis) fn continue_at(&mut self, rates: OffsetRates, cycle_s: f64) {
        let OffsetRates { velocity, acceleration } = rates;
        let slope = self.late_slope;
        self.shift = self.shift.map(|shift| shift.at_rates(velocity, acceleration, cycle_s));
        self.late = self.late.map(|late| late.at_rates(velocity * slope, acceleration * slope, cycle_s));
    }

    /// Returns what a new or active offset adds to the change of the master.
    pub(in crate::axis) fn step_offset(
        &mut self,
        wanted: i64,
        rates: Option<OffsetRates>,
        cycle_s: f64,
        most: f64,
    ) -> Position {
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
        way + apply_step(&mut self.shift, rates, most)
    }
}

pub(in crate::axis) fn shift(whole: Position, rates: OffsetRates, cycle_s: f64, before: Option<&Shift>) -> Shift {
    Shift::new(whole, rates.velocity, rates.acceleration, cycle_s, before)
}

/// Advances a shift by one cycle, at most by `most`, and removes it at its end.
fn step(shift: &mut Option<Shift>, most: f64) -> Position {
    let Some(under_way) = shift else { return Position::ZERO };
    let (way, has_ended) = under_way.step_within(most);
    if has_ended {
        *shift = None;
    }
    way
}

/// As [`step`], but without rates all at once.
pub(in crate::axis) fn apply_step(shift: &mut Option<Shift>, rates: Option<OffsetRates>, most: f64) -> Position {
    if rates.is_some() { step(shift, most) } else { shift.take().map_or(Position::ZERO, |shift| shift.left()) }
}

//! Marks of the master, or of the slave, of a cam (SYNCCMM, SYNCCMS).
//!
//! Law      a sensor lies SYNCMPULSM before the place where a period of the cam begins, on the way of its master, or SYNCMPULSS on that of its slave; what
//!          it sees is one side, where the cam itself has so far to go is the other: both are brought together as marks of two sides are. Marks of the master move
//!          the master of the cam, marks of the slave the slave. Their distance is a period of the cam. A sensor that is further away
//!          than a period tells of a later one: its marks wait for all whole periods but the last (the FIFO of MACS-MARK-03).
//!          SYNCMSTART 2000: the master counts from its first mark on
//! Reads    the cam, as it stands before this cycle's step
//! Refuses  cams that are not cyclic, whose period is not of whole increments, or that do not feed where their slave has the marks; sensors more than
//!          8 periods away
//! Source   MACS-SYNC-01, MACS-MARK-03, -04, -07, -14, MACS-CMD-13, -14

use super::marker::{MarkPath, Seen, Sides};
use super::{Axis, Context};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::{Number, Refusal};
use crate::parameter::{Marks, Synchronization};
use crate::position::Position;
use crate::sync::cam::{Cam, Periods};
use crate::sync::marker::FROM_MARK;
use crate::sync::{CamStart, SyncMode};
use crate::table::{CamShape, Table};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Marks that wait, and periods that a sensor may be away.
const MOST_WAITING: usize = 8;

/// What a coupling by marks of a cam keeps.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct CamMarks {
    /// Ways since marks that wait for their period, the oldest first.
    waiting: [Position; MOST_WAITING],
    count: u8,
    /// The side of the cam in the cycle before.
    seen: Option<Seat>,
    /// Its period (inc); 0 before the first cycle.
    period: i64,
    /// What was added to the master in the cycle before.
    pub given: Position,
    /// The master does not count yet.
    pub holds: bool,
}

/// Where the side of a cam is in its period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Seat {
    /// Behind the place of its own mark, 0 to a period (inc).
    past: f64,
    /// Period, and how far the sensor is away (inc).
    by: (i64, i64),
}

impl Seat {
    /// How far behind its own mark the side is that has come here from `before` by so much (inc), if it has passed that on the way. Each is passed
    /// once, whatever rounding leaves of the ways.
    fn passed(self, before: Option<Self>, change: f64) -> Option<Position> {
        let period = self.by.0 as f64;
        let before = before.filter(|before| before.by == self.by)?;
        let periods = libm::rint((before.past + change - self.past) / period);
        let past = if periods < 0.0 { self.past - period } else { self.past };
        (periods != 0.0).then(|| Position::from_f64(past))
    }
}

/// What a cam is in this cycle to those who bring marks together with it.
#[derive(Clone, Copy, Debug)]
struct CamSide {
    /// Marks come so far apart (inc of their side).
    period: i64,
    /// How far a mark waits for its period (inc), along `sense`, 1 or -1.
    wait: i64,
    sense: f64,
    /// How the side of the cam moves, and where its own mark was in this cycle, if one was.
    change: Position,
    mark: Option<Position>,
}

impl CamMarks {
    pub(super) fn new(start: i64) -> Self {
        Self { holds: start == FROM_MARK, ..Self::default() }
    }

    /// Marks of a side that moves by `change`, each behind its wait, and how many have found no room. One that has gone back over its sensor waits no more.
    fn delayed(&mut self, mut seen: Seen, change: Position, side: &CamSide, now_ns: u64) -> (Seen, u32) {
        let wait = Position::whole(side.wait);
        if wait == Position::ZERO {
            self.count = 0;
            return (seen, 0);
        }
        let along = |way: Position| if side.sense < 0.0 { -way } else { way };
        let mut passed = Seen::new();
        let mut kept = [Position::ZERO; MOST_WAITING];
        let (mut count, mut lost) = (0, 0);
        let waiting = self.waiting.iter().take(self.count.into()).map(|way| *way + change);
        for way in waiting.chain(seen.sorted().iter().map(|(before, _)| *before)) {
            let over = along(way) - wait;
            if over >= Position::ZERO {
                passed.push(along(over), now_ns);
            } else if along(way) < Position::ZERO {
                continue;
            } else if let Some(free) = kept.get_mut(count) {
                *free = way;
                count += 1;
            } else {
                lost += 1;
            }
        }
        (self.waiting, self.count) = (kept, count as u8);
        (passed, lost)
    }

    /// The period of the cam (inc), once it is known.
    pub(super) fn period(&self) -> Option<i64> {
        Some(self.period).filter(|period| *period > 0)
    }

    /// Nothing is known of the cam any more.
    pub(super) fn forget(&mut self) {
        (self.count, self.seen) = (0, None);
    }

    pub(super) fn is_sound(&self) -> bool {
        usize::from(self.count) <= MOST_WAITING
            && self.waiting.iter().all(|way| way.is_legal())
            && self.given.is_legal()
            && self.seen.is_none_or(|seat| seat.past.is_finite())
    }
}

/// Whole periods but the last that a sensor is away (inc).
fn wait_of(distance: i64, period: i64) -> i64 {
    if period <= 0 || distance <= 0 { 0 } else { (distance - 1) / period * period }
}

impl Axis {
    /// May marks of that side correct a cam, from where it begins?
    pub(super) fn check_cam_marks(
        &self,
        mode: SyncMode,
        cam: &Cam,
        start: CamStart,
        tables: &[Arc<Table>],
    ) -> Result<(), Refusal> {
        if !matches!(mode, SyncMode::MasterMarker | SyncMode::SlaveMarker) {
            return Ok(());
        }
        let of_slave = mode == SyncMode::SlaveMarker;
        let refuse = |code, asked, limit| Err(self.refuse(code).with(asked, limit));
        let period = self.check_periods(mode, cam.periods(tables))?;
        let marks = &self.parameters.marks;
        let distance = if of_slave { marks.slave_distance } else { self.parameters.sync.mark_distance };
        let most = period.saturating_mul(MOST_WAITING as u64);
        if distance.unsigned_abs() > most {
            return refuse(Code::CAM_MARKS_DISTANCE, Number::Count(distance), Number::Count(most as i64));
        }
        if marks.start == FROM_MARK && (start != CamStart::Relative || of_slave) {
            return refuse(Code::CAM_MARKS_START, Number::None, Number::None);
        }
        Ok(())
    }

    /// The period that marks of that side go by (inc).
    fn check_periods(&self, mode: SyncMode, periods: Periods) -> Result<u64, Refusal> {
        let period = if mode == SyncMode::SlaveMarker { periods.slave } else { periods.master };
        match period.map(i64::unsigned_abs) {
            None => Err(self.refuse(Code::CAM_MARKS_PERIOD)),
            Some(0) => Err(self.refuse(Code::CAM_MARKS_STROKE)),
            Some(period) => Ok(period),
        }
    }

    /// May the table of its cam become one of that shape, as far as its marks go?
    ///
    /// # Errors
    /// They would have no period.
    pub fn check_marks_on(&self, shape: CamShape) -> Result<(), Refusal> {
        let Some(follower) = self.coupling().map(|coupling| &coupling.follower) else { return Ok(()) };
        let mode = follower.mode();
        match follower.transmission().cam() {
            Some(cam) if mode.has_marks() => self.check_periods(mode, cam.periods_in(shape)).map(|_| ()),
            _ => Ok(()),
        }
    }

    /// A cam that counts from the first mark of its master on stands where that has its sensor.
    pub(super) fn cam_before_mark(&self, mode: SyncMode, cam: Cam, tables: &[Arc<Table>]) -> Cam {
        let from_mark = mode == SyncMode::MasterMarker && self.parameters.marks.start == FROM_MARK;
        if from_mark { cam.moved_back(Position::whole(self.parameters.sync.mark_distance), tables) } else { cam }
    }

    /// The side of the cam, whose master moves by `change` in this cycle.
    fn cam_side(&self, path: &mut MarkPath, change: Position, tables: &[Arc<Table>]) -> Option<CamSide> {
        let cam = self.coupling()?.follower.transmission().cam()?;
        let Periods { master, slave } = cam.periods(tables);
        let (way, period, distance, value) = if path.mode == SyncMode::SlaveMarker {
            let mut next = *cam;
            let way = next.step(change, tables);
            (way, slave?, self.parameters.marks.slave_distance, next.from_start(tables).to_f64())
        } else {
            let place = cam.master_place() + change.to_f64();
            (change + path.cam.given, master?, self.parameters.sync.mark_distance, place)
        };
        let sense = period.signum();
        let period = period.checked_abs().filter(|period| *period > 0)?;
        let value = value + distance.saturating_mul(sense) as f64;
        let seat = Seat { past: value.rem_euclid(period as f64), by: (period, distance) };
        let mark = seat.passed(path.cam.seen.replace(seat), way.to_f64());
        path.cam.period = period;
        Some(CamSide { period, wait: wait_of(distance, period), sense: sense as f64, change: way, mark })
    }

    /// Both sides of a coupling by marks of a cam, whose master moves by `passed_on` in this cycle.
    pub(super) fn sides_of_cam(
        &self,
        cx: &Context<'_>,
        path: &mut MarkPath,
        seen: [Seen; 2],
        (lead, passed_on): (Lead, Position),
    ) -> Option<Sides> {
        let side = self.cam_side(path, passed_on, cx.tables)?;
        let now_ns = cx.cycle.saturating_mul(self.setup.cycle_ns);
        let mut of_cam = Seen::new();
        side.mark.into_iter().for_each(|before| of_cam.push(before, now_ns));
        let [of_master, of_slave] = seen;
        let (sync, marks) = self.judged_by_cam(path, side.period);
        let (seen, changes, lost) = if path.mode == SyncMode::SlaveMarker {
            let change = self.actual.change;
            let (of_slave, lost) = path.cam.delayed(of_slave, change, &side, now_ns);
            ([of_cam, of_slave], [side.change, change], [0, lost])
        } else {
            let (of_master, lost) = path.cam.delayed(of_master, lead.change, &side, now_ns);
            ([of_master, of_cam], [lead.change, side.change], [lost, 0])
        };
        Some(Sides { seen, changes, lost, sync, marks, ratio: 1.0 })
    }

    /// The parameters with which marks of a cam are judged: their distance is its period, that of the cam itself is always met, and each is one of one.
    fn judged_by_cam(&self, path: &MarkPath, period: i64) -> (Synchronization, Marks) {
        let sync = Synchronization { mark_distance: period, ..self.parameters.sync };
        let marks =
            Marks { start: FROM_MARK, per_master: 1, per_slave: 1, slave_distance: period, ..self.parameters.marks };
        let marks = if path.mode == SyncMode::SlaveMarker {
            Marks { master_window: 0, ..marks }
        } else {
            Marks { slave_window: 0, slave_filter_time: 0, ..marks }
        };
        (sync, marks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Periods of 1000 inc: a sensor 300 or 1000 before tells of the next period, one 1001 or 2500 before of a later one.
    /// Proves: MACS-MARK-03
    #[test]
    fn a_sensor_further_away_than_a_period_waits() {
        let waits = [0, 1, 300, 1_000, 1_001, 2_000, 2_500, -5].map(|distance| wait_of(distance, 1_000));
        assert_eq!(waits, [0, 0, 0, 0, 1_000, 1_000, 2_000, 0]);
        assert_eq!(wait_of(5, 0), 0);
    }

    /// From seat to seat, forwards and back, also where the ways are rounded: each place is passed once.
    #[test]
    fn a_place_is_passed_once_from_either_side() {
        let seat = |value: f64| Seat { past: value.rem_euclid(1_000.0), by: (1_000, 300) };
        let passed = |from: f64, to: f64| seat(to).passed(Some(seat(from)), to - from);
        let at = |way: f64| Some(Position::from_f64(way));
        assert_eq!((passed(1_993.0, 2_003.0), passed(1_990.0, 2_000.0)), (at(3.0), at(0.0)));
        assert_eq!((passed(2_000.0, 2_000.0), passed(2_000.0, 2_010.0)), (None, None));
        assert_eq!(
            (passed(2_007.0, 1_997.0), passed(2_002.0, 2_000.0), passed(2_000.0, 1_998.0)),
            (at(-3.0), None, at(-2.0))
        );
        assert_eq!(passed(7.0, -3.0), at(-3.0));
        // A count is 3 inc of the table, rounded down: in the cycle of the mark it is just before it.
        let short = 1_000.0 - 4.7e-10;
        assert_eq!(seat(short).passed(Some(seat(999.0)), 1.0), None);
        assert!(seat(short + 1.0).passed(Some(seat(short)), 1.0).is_some());
        // What was measured otherwise says nothing.
        assert_eq!(seat(3.0).passed(Some(Seat { by: (1_000, 0), ..seat(993.0) }), 10.0), None);
        assert_eq!(seat(3.0).passed(None, 10.0), None);
    }
}

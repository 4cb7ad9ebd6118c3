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
use crate::sync::{CamStart, SyncMode};
use crate::table::Table;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Marks that wait, and periods that a sensor may be away.
const MOST_WAITING: usize = 8;
/// SYNCMSTART with which a cam begins at its first mark.
const FROM_MARK: i64 = 2_000;

/// What a coupling by marks of a cam keeps.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct CamMarks {
    /// Ways since marks that wait for their period, the oldest first.
    waiting: [Position; MOST_WAITING],
    count: u8,
    /// What was added to the master in the cycle before.
    pub given: Position,
    /// The master does not count yet.
    pub holds: bool,
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

    /// Marks of a side that moves by `change`, each behind its wait.
    fn delayed(&mut self, mut seen: Seen, change: Position, side: &CamSide, now_ns: u64) -> Seen {
        let mut passed = Seen::new();
        let along = |way: Position| if side.sense < 0.0 { -way } else { way };
        let wait = Position::whole(side.wait);
        if wait == Position::ZERO {
            return seen;
        }
        let mut kept = [Position::ZERO; MOST_WAITING];
        let mut count = 0;
        let waiting = self.waiting.iter().take(self.count.into()).map(|way| *way + change);
        for way in waiting.chain(seen.sorted().iter().map(|(before, _)| *before)) {
            let over = along(way) - wait;
            if over >= Position::ZERO {
                passed.push(along(over), now_ns);
            } else if let Some(free) = kept.get_mut(count) {
                *free = way;
                count += 1;
            }
        }
        (self.waiting, self.count) = (kept, count as u8);
        passed
    }

    pub(super) fn is_sound(&self) -> bool {
        usize::from(self.count) <= MOST_WAITING && self.waiting.iter().all(|way| way.is_legal())
    }
}

/// Whole periods but the last that a sensor is away (inc).
fn wait_of(distance: i64, period: i64) -> i64 {
    if period <= 0 || distance <= 0 { 0 } else { (distance - 1) / period * period }
}

/// Where a value that has moved by `change` has passed a multiple of `period` in this cycle: so far behind now.
fn crossed(value: f64, change: f64, period: f64) -> Option<Position> {
    let past = value.rem_euclid(period);
    let before = if change < 0.0 && past > 0.0 { past - period } else { past };
    (before.abs() < change.abs()).then(|| Position::from_f64(before))
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
        let of_slave = match mode {
            SyncMode::MasterMarker => false,
            SyncMode::SlaveMarker => true,
            _ => return Ok(()),
        };
        let refuse = |code, asked, limit| Err(self.refuse(code).with(asked, limit));
        let Periods { master, slave } = cam.periods(tables);
        let period = if of_slave { slave } else { master };
        let Some(period) = period else {
            return refuse(Code::CAM_MARKS_PERIOD, Number::None, Number::None);
        };
        let period = period.unsigned_abs();
        if period == 0 {
            return refuse(Code::CAM_MARKS_STROKE, Number::None, Number::None);
        }
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

    /// A cam that counts from the first mark of its master on stands where that has its sensor.
    pub(super) fn cam_before_mark(&self, mode: SyncMode, cam: Cam, tables: &[Arc<Table>]) -> Cam {
        let from_mark = mode == SyncMode::MasterMarker && self.parameters.marks.start == FROM_MARK;
        if from_mark { cam.moved_back(Position::whole(self.parameters.sync.mark_distance), tables) } else { cam }
    }

    /// The side of the cam, whose master moves by `change` in this cycle.
    fn cam_side(&self, path: &MarkPath, change: Position, tables: &[Arc<Table>]) -> Option<CamSide> {
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
        let mark = crossed(value, way.to_f64(), period as f64);
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
        let (seen, changes) = if path.mode == SyncMode::SlaveMarker {
            let change = self.actual.change;
            ([of_cam, path.cam.delayed(of_slave, change, &side, now_ns)], [side.change, change])
        } else {
            ([path.cam.delayed(of_master, lead.change, &side, now_ns), of_cam], [lead.change, side.change])
        };
        Some(Sides { seen, changes, sync, marks, ratio: 1.0 })
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

    #[test]
    fn a_place_is_passed_from_either_side() {
        let at = |way: f64| Some(Position::from_f64(way));
        assert_eq!(crossed(2_003.0, 10.0, 1_000.0), at(3.0));
        assert_eq!(crossed(2_000.0, 10.0, 1_000.0), at(0.0));
        assert_eq!(crossed(1_999.0, 10.0, 1_000.0), None);
        // Standing on it, it was passed before.
        assert_eq!((crossed(2_000.0, 0.0, 1_000.0), crossed(2_010.0, 10.0, 1_000.0)), (None, None));
        assert_eq!(crossed(1_997.0, -10.0, 1_000.0), at(-3.0));
        assert_eq!(crossed(-3.0, -10.0, 1_000.0), at(-3.0));
        assert_eq!((crossed(-3.0, 10.0, 1_000.0), crossed(0.0, -2.0, 1_000.0)), (None, at(0.0)));
    }
}

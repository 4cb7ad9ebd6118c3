//! Registration marks of the master, or of the slave, of a cam (SYNCCMM, SYNCCMS).
//!
//! Law      the sensor is SYNCMPULSM before the start of a period of the cam on the path of the master, or SYNCMPULSS
//!          on that of the slave. Its marks are one side; the start of each period of the cam is a mark of the other
//!          side. Both sides are matched as in marker synchronization. Marks of the master correct the master of the
//!          cam, marks of the slave correct the slave. The distance of marks is a period of the cam. If the sensor is
//!          more than one period away, its marks belong to later periods and wait for all whole periods but the last
//!          (the FIFO of MACS-MARK-03). SYNCMSTART 2000: the master counts from its first mark on
//! Reads    the cam before the step of this cycle
//! Refuses  cams that are not cyclic, with a period of not whole increments, or without feed for marks of the slave;
//!          sensors more than 8 periods away
//! Source   MACS-SYNC-01, MACS-MARK-03, -04, -07, -14, MACS-CMD-13, -14

use super::marker::Sides;
use crate::axis::state::cam_marks::MOST_WAITING;
use crate::axis::state::{Axis, CamPosition, CamSide, Context, MarkPath, Seen};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::{Number, Refusal};
use crate::parameter::{Marks, Synchronization};
use crate::position::Position;
use crate::sync::cam::{Cam, Periods};
use crate::sync::marker::FROM_MARK;
use crate::sync::{CamStart, SyncMode};
use crate::table::{CamShape, Table};
use std::sync::Arc;

/// Returns the distance of the sensor in whole periods without the last one (inc).
fn whole_periods_of(distance: i64, period: i64) -> i64 {
    if period <= 0 || distance <= 0 { 0 } else { (distance - 1) / period * period }
}

impl Axis {
    /// Checks whether marks of that side can correct a cam from its start on.
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

    /// Returns the distance between marks of that side (inc).
    fn check_periods(&self, mode: SyncMode, periods: Periods) -> Result<u64, Refusal> {
        let period = if mode == SyncMode::SlaveMarker { periods.slave } else { periods.master };
        match period.map(i64::unsigned_abs) {
            None => Err(self.refuse(Code::CAM_MARKS_PERIOD)),
            Some(0) => Err(self.refuse(Code::CAM_MARKS_STROKE)),
            Some(period) => Ok(period),
        }
    }

    /// Checks whether the table of the cam may change to that shape with respect to marks.
    ///
    /// # Errors
    /// The marks would have no period.
    pub fn check_marks_on(&self, shape: CamShape) -> Result<(), Refusal> {
        let Some(follower) = self.coupling().map(|coupling| &coupling.follower) else { return Ok(()) };
        let mode = follower.mode();
        match follower.transmission().cam() {
            Some(cam) if mode.has_marks() => self.check_periods(mode, cam.periods_in(shape)).map(|_| ()),
            _ => Ok(()),
        }
    }

    /// Returns the cam moved back to the sensor if it counts from the first mark of its master.
    pub(super) fn cam_before_mark(&self, mode: SyncMode, cam: Cam, tables: &[Arc<Table>]) -> Cam {
        let from_mark = mode == SyncMode::MasterMarker && self.parameters.marks.start == FROM_MARK;
        if from_mark { cam.moved_back(Position::whole(self.parameters.sync.mark_distance), tables) } else { cam }
    }

    /// Returns the side of the cam whose master moves by `change` in this cycle.
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
        let seat = CamPosition { past: value.rem_euclid(period as f64), by: (period, distance) };
        let mark = seat.passed(path.cam.seen.replace(seat), way.to_f64());
        path.cam.period = period;
        Some(CamSide { period, wait: whole_periods_of(distance, period), sense: sense as f64, change: way, mark })
    }

    /// Returns both sides of a coupling by marks of a cam whose master moves by `passed_on` in this cycle.
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
        let (sync, marks) = self.check_parameters_of_cam(path, side.period);
        let (seen, changes, lost) = if path.mode == SyncMode::SlaveMarker {
            let change = self.feedback.change();
            let (of_slave, lost) = path.cam.delayed(of_slave, change, &side, now_ns);
            ([of_cam, of_slave], [side.change, change], [0, lost])
        } else {
            let (of_master, lost) = path.cam.delayed(of_master, lead.change, &side, now_ns);
            ([of_master, of_cam], [lead.change, side.change], [lost, 0])
        };
        Some(Sides { seen, changes, lost, sync, marks, ratio: 1.0 })
    }

    /// Returns the parameters for checking the marks of a cam: their distance is its period, the mark of the cam itself
    /// is always inside the window, and every mark is used.
    fn check_parameters_of_cam(&self, path: &MarkPath, period: i64) -> (Synchronization, Marks) {
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

    /// Periods of 1000 inc: the marks of a sensor 300 or 1000 inc ahead belong to the next period, of one 1001 or 2500
    /// inc ahead to a later one.
    ///
    /// Proves: MACS-MARK-03
    #[test]
    fn a_sensor_further_away_than_a_period_waits() {
        let waits = [0, 1, 300, 1_000, 1_001, 2_000, 2_500, -5].map(|distance| whole_periods_of(distance, 1_000));
        assert_eq!(waits, [0, 0, 0, 0, 1_000, 1_000, 2_000, 0]);
        assert_eq!(whole_periods_of(5, 0), 0);
    }

    /// Forward and backward, also with rounded distances, each mark is passed once.
    #[test]
    fn a_place_is_passed_once_from_either_side() {
        let seat = |value: f64| CamPosition { past: value.rem_euclid(1_000.0), by: (1_000, 300) };
        let passed = |from: f64, to: f64| seat(to).passed(Some(seat(from)), to - from);
        let at = |way: f64| Some(Position::from_f64(way));
        assert_eq!((passed(1_993.0, 2_003.0), passed(1_990.0, 2_000.0)), (at(3.0), at(0.0)));
        assert_eq!((passed(2_000.0, 2_000.0), passed(2_000.0, 2_010.0)), (None, None));
        assert_eq!(
            (passed(2_007.0, 1_997.0), passed(2_002.0, 2_000.0), passed(2_000.0, 1_998.0)),
            (at(-3.0), None, at(-2.0))
        );
        assert_eq!(passed(7.0, -3.0), at(-3.0));
        // A count is 3 inc of the table, rounded down: in the cycle of the mark the position is just before it.
        let short = 1_000.0 - 4.7e-10;
        assert_eq!(seat(short).passed(Some(seat(999.0)), 1.0), None);
        assert!(seat(short + 1.0).passed(Some(seat(short)), 1.0).is_some());
        // A position measured with another period or sensor distance does not count.
        assert_eq!(seat(3.0).passed(Some(CamPosition { by: (1_000, 0), ..seat(993.0) }), 10.0), None);
        assert_eq!(seat(3.0).passed(None, 10.0), None);
    }
}

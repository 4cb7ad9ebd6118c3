//! Reference travel: JOG+ or JOG- moves the axis to the cam, across it and to the zero mark.
//!
//! Law      rapid until the cam is on, reduced until it is off, creep until the zero mark; closed loop: continue by
//!          MD17 to the reference point, where the position is MD16. Open loop: the speed is switched off at the zero
//!          mark, where the position is MD16. MD7 selects the side of the cam for the zero mark: 0 the side in the
//!          direction of JOG, 1 plus, 2 minus; for the side from which the axis came, it reverses on the cam. Open
//!          loop: once the speed is off, by the mark, JOG or the enable, the axis coasts; only before the mark does
//!          that end the travel without a zero
//! Reads    MD15: the reference switch, or the cam bit of the requests; the index of the axis
//! Writes   one order, which the axis executes like homing; speed value and direction are those of the present phase
//! Refuses  speeds that are 0 or too high; without a zero mark within a revolution: alarm 9
//! Source   WF-REF-01 to WF-REF-12, WF-MD-05, WF-MD-08; W10: JOG has to be held

use super::program::check_speed;
use super::request::{FULL_SPEED, Speed};
use super::{RefusalReason, State, Wf, is_moved, is_open};
use crate::code::Code;
use crate::parameter::Row;
use crate::vocabulary::{Order, Travel, View};

impl Wf {
    /// Applies the present inputs.
    pub(super) fn travel(&mut self, view: &View<'_>) -> Result<Option<Order>, RefusalReason> {
        let direction = self.jog.direction();
        // Open loop: after the mark JOG has no further effect on the travel.
        let is_under_way = self.is_running() || self.state == State::Settle;
        if is_under_way && direction == self.direction {
            return Ok(None);
        }
        if direction == 0 || self.is_running() {
            return Ok(self.end_travel(view));
        }
        self.check_enable()?;
        if is_moved(view) {
            return Err(RefusalReason::new(Code::WF_IN_MOTION));
        }
        let p = view.parameters;
        let velocity = |row, speed| {
            let value = check_speed(Speed::Value(speed), view).map_err(|objection| objection.about(row))?;
            Ok(value / FULL_SPEED * p.max_velocity)
        };
        let speeds = [
            velocity(const { Row::place("wf.reference_rapid") }, p.vocabularies.wf.reference_rapid)?,
            velocity(const { Row::place("wf.reference_reduced") }, p.vocabularies.wf.reference_reduced)?,
            velocity(const { Row::place("wf.reference_creep") }, p.vocabularies.wf.reference_creep)?,
        ];
        let [rapid, ..] = speeds;
        self.direction = direction;
        self.ending = false;
        self.state = State::Run;
        self.started = view.cycle;
        self.speed = p.vocabularies.wf.reference_rapid;
        let limits = p.vocabularies.wf.limits(rapid, view.largest_limits());
        let back = match p.encoder.side_or_omitted {
            1 => direction < 0,
            2 => direction > 0,
            _ => false,
        };
        let travel = Travel {
            direction,
            back,
            speeds,
            limits,
            shift: p.vocabularies.wf.md17,
            value: p.encoder.reference_or_parity,
        };
        Ok(Some(Order::ReferenceTravel(travel)))
    }

    /// WF-REF-12: when JOG is released, the axis stops, and its zero does not change.
    fn end_travel(&mut self, view: &View<'_>) -> Option<Order> {
        if !self.is_running() || self.ending {
            return None;
        }
        if is_open(view) {
            return Some(self.standstill(view));
        }
        self.ending = true;
        let p = view.parameters;
        Some(Order::Stop { limits: p.vocabularies.wf.limits(p.max_velocity, view.largest_limits()) })
    }

    /// Executes one step of the travel or of its stop.
    pub(super) fn step_travel(&mut self, view: &View<'_>) {
        if view.error == Code::WF_NO_ZERO_MARK {
            self.end_activity();
            (self.state, self.alarm) = (State::Alarm, 9);
        } else if !view.owns || !view.free {
            self.end_activity();
        } else if self.ending {
            if view.rests {
                self.end_activity();
            }
        } else if !view.homing {
            // WF-REF-05
            self.set_zero();
            self.end_activity();
        } else if view.search_speed == 0.0 && is_open(view) {
            // WF-OLC-09: the mark was found.
            if self.is_running() {
                self.switch_off(view);
            }
        } else if view.search_speed != 0.0 {
            // Removes the rounding of the conversion to increments, so that the value is the programmed one.
            let speed = view.search_speed.abs() / view.parameters.max_velocity * FULL_SPEED;
            self.speed = ((speed * 1e6).round() / 1e6).clamp(0.0, FULL_SPEED);
        }
    }
}

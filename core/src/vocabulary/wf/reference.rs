//! Reference travel: JOG+ or JOG- leads to the cam, across it and on to the zero mark.
//!
//! Law      rapid until the cam is on, reduced until it is off, creep until the zero mark; closed loop: on by MD17 to the reference
//!          point. There the position is MD16. Open loop: the speed is switched off at the zero mark, where the position is MD16.
//!          MD7 is the side of the cam on which that happens: 0 the one that JOG leads to, 1 plus, 2 minus; for the side that it
//!          comes from it turns round on the cam
//!          Open loop: once the speed is off, by the mark, JOG or the enable, it coasts; only before the mark that ends it without a zero
//! Reads    MD15: the reference switch, or the cam bit of the verbs; the index of the axis
//! Writes   one order; the axis does the rest as homing; the speed value and the direction are those of the way under way
//! Refuses  speeds that are 0 or too high; without a zero mark in a revolution: alarm 9
//! Source   WF-REF-01 to WF-REF-12, WF-MD-05, WF-MD-08; W10: JOG has to be held

use super::program::check_speed;
use super::request::{FULL_SPEED, Speed};
use super::{Objection, State, Wf, is_moved, is_open};
use crate::code::Code;
use crate::parameter::Row;
use crate::vocabulary::{Order, Travel, View};

impl Wf {
    /// Does what the inputs say now.
    pub(super) fn travel(&mut self, view: &View<'_>) -> Result<Option<Order>, Objection> {
        let direction = self.jog.direction();
        // Open loop: behind the mark the travel is done, as far as JOG goes.
        let is_under_way = self.is_running() || self.state == State::Settle;
        if is_under_way && direction == self.direction {
            return Ok(None);
        }
        if direction == 0 || self.is_running() {
            return Ok(self.end_travel(view));
        }
        self.check_enable()?;
        if is_moved(view) {
            return Err(Objection::new(Code::WF_IN_MOTION));
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

    /// WF-REF-12: released, the axis stops, and knows no more than before.
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

    /// One step while the axis travels, or stops.
    pub(super) fn step_travel(&mut self, view: &View<'_>) {
        if view.error == Code::WF_NO_ZERO_MARK {
            self.leave();
            (self.state, self.alarm) = (State::Alarm, 9);
        } else if !view.owns || !view.free {
            self.leave();
        } else if self.ending {
            if view.rests {
                self.leave();
            }
        } else if !view.homing {
            // WF-REF-05
            self.take_zero();
            self.leave();
        } else if view.search_speed == 0.0 && is_open(view) {
            // WF-OLC-09: the mark was found.
            if self.is_running() {
                self.switch_off(view);
            }
        } else if view.search_speed != 0.0 {
            // As it was programmed: what the conversion to increments has added to it is taken off.
            let speed = view.search_speed.abs() / view.parameters.max_velocity * FULL_SPEED;
            self.speed = ((speed * 1e6).round() / 1e6).clamp(0.0, FULL_SPEED);
        }
    }
}

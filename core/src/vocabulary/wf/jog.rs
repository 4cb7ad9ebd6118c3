//! Setup: JOG+ and JOG- run the axis as long as they are set.
//!
//! Law      open loop: the set position follows the actual one, the speed is switched on and off at once. If the
//!          distance to a software limit is within that of a step, the limit becomes the set position and the steps
//!          apply (WF-LIM-02)
//! Source   WF-SET-01, WF-SET-02, WF-LIM-02, WF-LIM-03

use super::program::check_speed;
use super::request::{FULL_SPEED, Mode, Request, Speed};
use super::steps::Steps;
use super::{RefusalReason, State, Wf, is_moved, is_open};
use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::vocabulary::{Order, View};

impl Wf {
    /// Applies the present inputs.
    pub(super) fn jog(&mut self, view: &View<'_>) -> Result<Option<Order>, RefusalReason> {
        let direction = self.jog.direction();
        if direction == 0 {
            return Ok(self.stop(view));
        }
        self.check_enable()?;
        if !self.is_running() && is_moved(view) {
            return Err(RefusalReason::new(Code::WF_IN_MOTION));
        }
        let (row, speed) = view.parameters.vocabularies.wf.fixed_speed(self.fixed_speed);
        let programmed = check_speed(Speed::Value(speed), view).map_err(|objection| objection.about(row))?;
        self.direction = direction;
        self.ending = false;
        (self.active, self.end) = (0, 0);
        if !self.is_running() {
            self.started = view.cycle;
            self.speed_valid = false;
        }
        if is_open(view) {
            return self.jog_open(view, programmed as i64).map(Some);
        }
        let p = view.parameters;
        let velocity = programmed / FULL_SPEED * p.max_velocity;
        self.state = State::Run;
        self.speed = programmed;
        let limits = p.vocabularies.wf.limits(velocity, view.largest_limits());
        Ok(Some(Order::Velocity { velocity: f64::from(direction) * velocity, limits }))
    }

    /// Returns the stop of an axis that ran by an input which the request releases; `None` if no input ran it.
    pub(crate) fn release(&mut self, request: &Request, view: &View<'_>) -> Option<Order> {
        let jog = request.jog?;
        let runs = self.mode == Mode::Jog && view.owns && self.is_running() && !self.ending;
        if !runs || jog.direction() == self.direction {
            return None;
        }
        self.jog = jog;
        self.stop(view)
    }

    fn jog_open(&mut self, view: &View<'_>, programmed: i64) -> Result<Order, RefusalReason> {
        let (state, speed) = self.limited(view, programmed).unwrap_or((State::Run, programmed));
        if state == State::Settle {
            let velocity = f64::from(self.direction) * programmed as f64 / FULL_SPEED * view.parameters.max_velocity;
            let numbers = (Number::Velocity(velocity), Number::Position(self.set.floor()));
            return Err(RefusalReason::new(Code::LIMIT_VIOLATION).with(numbers.0, numbers.1));
        }
        Ok(self.put_out(view, state, speed))
    }

    /// Returns the step for the distance to the software limit; the limit becomes the set position then.
    fn limited(&mut self, view: &View<'_>, present: i64) -> Option<(State, i64)> {
        let p = view.parameters;
        let limit = if self.direction > 0 { p.max_position } else { p.min_position };
        self.set = Position::whole(limit?);
        Steps::of(p).step_at(present, self.way_left(view))
    }

    pub(super) fn step_jog(&mut self, view: &View<'_>) -> Option<Order> {
        let (state, speed) = self.limited(view, self.speed as i64)?;
        if state == State::Settle {
            return Some(self.standstill(view));
        }
        Some(self.put_out(view, state, speed))
    }
}

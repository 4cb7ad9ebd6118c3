//! Blocks of an open-loop axis: reduction steps, and change on the fly.
//!
//! Law      deceleration point: a step slower than the present speed is reached. There the next block is evaluated: it
//!          is adopted if it is at least as fast as the present speed or faster than that step, otherwise the step is
//!          applied
//! Reads    the actual position
//! Writes   the speed of the drive
//! Source   WF-OST-01 to 10, WF-BCF-01 to 05, W09

use super::steps::Steps;
use super::{Mode, State, Wf};
use crate::vocabulary::{Order, View};

impl Wf {
    pub(super) fn begin_open(&mut self, view: &View<'_>) -> Order {
        self.set = self.end_of(self.active);
        self.state = State::Run;
        self.direction = self.following_error(view).signum() as i8;
        let (state, speed) = self.enter_block(view);
        self.put_out(view, state, speed)
    }

    /// Returns state and speed at the begin of the active block, from its distance to go.
    fn enter_block(&mut self, view: &View<'_>) -> (State, i64) {
        self.set = self.end_of(self.active);
        let left = self.way_left(view);
        Steps::of(view.parameters).begin(self.value_of(self.active, view) as i64, left)
    }

    /// Returns the distance to go in the direction of motion (inc); below 0 the end is passed.
    pub(super) fn way_left(&self, view: &View<'_>) -> i64 {
        self.set.nearest().saturating_sub(view.actual.position.floor()).saturating_mul(self.direction.into())
    }

    pub(super) fn put_out(&mut self, view: &View<'_>, state: State, speed: i64) -> Order {
        if state == State::Settle {
            self.switch_off(view);
        } else {
            self.state = state;
            self.speed = speed as f64;
        }
        let share = f64::from(self.direction) * self.speed / super::FULL_SPEED;
        Order::Speed { velocity: share * view.parameters.max_velocity }
    }

    pub(super) fn step_open(&mut self, view: &View<'_>) -> Option<Order> {
        if !self.is_running() {
            return self.settle(view);
        }
        if self.mode == Mode::Jog {
            return self.step_jog(view);
        }
        if view.parameters.vocabularies.wf.peh_from_start == 1 && self.is_late(view) {
            let window = view.parameters.vocabularies.wf.peh_window.unwrap_or(view.parameters.in_position_window);
            return self.raise_not_reached(self.following_error(view), window);
        }
        let present = self.speed as i64;
        let (state, speed) = Steps::of(view.parameters).step_at(present, self.way_left(view))?;
        let (state, speed) = match self.change_on_the_fly(view, present, speed) {
            true => self.enter_block(view),
            false => (state, speed),
        };
        Some(self.put_out(view, state, speed))
    }

    /// Returns true if the next block is adopted at a deceleration point.
    fn change_on_the_fly(&mut self, view: &View<'_>, present: i64, due: i64) -> bool {
        let next = self.active.saturating_add(1);
        // A block of the opposite direction has to wait for the end of this one (W09).
        if next >= self.end || self.direction_of(next) != self.direction {
            return false;
        }
        self.considered = true;
        let programmed = self.value_of(next, view) as i64;
        if programmed < present && due >= programmed {
            return false;
        }
        self.active = next;
        self.considered = false;
        true
    }
}

//! Blocks of a closed-loop axis, on the profiles of the axis.
//!
//! Law      blocks of one direction are one motion to the end of the last of them. Within each block the velocity is
//!          limited to its speed: the axis decelerates before the begin of a slower block, and accelerates from the
//!          begin of a faster one
//! Reads    the command of the axis
//! Writes   target positions, with the speed of the limiting block
//! Source   WF-CLC-01, WF-CLC-02, WF-SET-03; section 8 describes the change on the fly for open loops, this is the
//!          equivalent for closed loops

use super::request::{Mode, Speed};
use super::{State, Wf, direction, is_open};
use crate::code::Code;
use crate::profile::{self, Limits};
use crate::state::Reference;
use crate::vocabulary::{Order, View};

impl Wf {
    pub(super) fn begin_closed(&mut self, view: &View<'_>) -> Order {
        self.state = State::Run;
        self.direction = direction(view.command.position, self.end_of(self.active));
        self.last = self.active;
        while self.last + 1 < self.end && self.direction_of(self.last + 1) == self.direction {
            self.last += 1;
        }
        self.set = self.end_of(self.last);
        self.limiting_block = self.active;
        self.go_on(view)
    }

    /// Returns the order to the end of all blocks, with the speed of the limiting block.
    fn go_on(&mut self, view: &View<'_>) -> Order {
        self.speed = self.value_of(self.active, view);
        Order::Position {
            target: self.set,
            limits: self.limits_of(self.limiting_block, view),
            reference: Reference::PositionAbsolute,
        }
    }

    fn velocity_of(&self, block: u8, view: &View<'_>) -> f64 {
        let speed = self.program.get(block).map_or(Speed::default(), |block| block.speed);
        speed.velocity(view.parameters.max_velocity)
    }

    fn limits_of(&self, block: u8, view: &View<'_>) -> Limits {
        view.parameters.vocabularies.wf.limits(self.velocity_of(block, view), view.largest_limits())
    }

    pub(super) fn step_closed(&mut self, view: &View<'_>) -> Option<Order> {
        if !self.is_running() {
            return self.settle(view);
        }
        if self.ending || self.mode == Mode::Jog {
            if view.rests {
                self.end_activity();
            }
            return None;
        }
        if view.parameters.vocabularies.wf.peh_from_start == 1 && self.is_late(view) {
            let window = view.parameters.vocabularies.wf.peh_window.unwrap_or(view.parameters.in_position_window);
            return self.raise_not_reached(self.set.nearest().saturating_sub(view.actual.position.floor()), window);
        }
        let before = (self.active, self.limiting_block);
        while self.active < self.last && self.is_past(self.active, view) {
            self.active += 1;
        }
        if view.rests {
            return self.end_profile(view);
        }
        self.limiting_block = self.binding_block(view);
        if before == (self.active, self.limiting_block) {
            return None;
        }
        Some(self.go_on(view))
    }

    /// Handles the end of the profile.
    fn end_profile(&mut self, view: &View<'_>) -> Option<Order> {
        if view.command.position.floor() != self.set.nearest() {
            // Another command ended it.
            self.end_activity();
            return None;
        }
        self.active = self.last;
        self.switch_off(view);
        self.settle(view)
    }

    /// Returns true if the command has reached the end of a block.
    fn is_past(&self, block: u8, view: &View<'_>) -> bool {
        let (end, now) = (self.end_of(block), view.command.position);
        if self.direction < 0 { now <= end } else { now >= end }
    }

    /// Returns the limiting block: the one that runs, or a slower one after it for which the motion has to decelerate
    /// now.
    fn binding_block(&self, view: &View<'_>) -> u8 {
        let mut bound = self.active;
        // Once it decelerates for a block, the limit stays until that block begins.
        if self.limiting_block > bound && self.velocity_of(self.limiting_block, view) < self.velocity_of(bound, view) {
            bound = self.limiting_block;
        }
        for block in self.active.saturating_add(1)..=self.last {
            if self.velocity_of(block, view) < self.velocity_of(bound, view) && self.must_decelerate_for(block, view) {
                bound = block;
            }
        }
        bound
    }

    /// Returns true if the axis would reach a block too fast if it decelerated one cycle later.
    fn must_decelerate_for(&self, block: u8, view: &View<'_>) -> bool {
        let now = view.command;
        let sign = f64::from(self.direction);
        let cycle_s = view.cycle_ns as f64 / 1e9;
        // The velocity after the next cycle.
        let soon = sign * now.velocity + (sign * now.acceleration).max(0.0) * cycle_s;
        let allowed = self.velocity_of(block, view);
        if soon <= allowed {
            return false;
        }
        let left = sign * (self.end_of(block.saturating_sub(1)) - now.position).to_f64() - 2.0 * soon * cycle_s;
        let limits = self.limits_of(block, view);
        // With limited jerk, the distance for decelerating may exceed the stopping distance, but is at most twice as long,
        // because the mean velocity is at most twice as high.
        if left > 2.0 * sign * profile::stopping_distance(now, &limits) {
            return false;
        }
        let slowed = profile::to_velocity(now, sign * allowed, &limits, view.cycle_ns);
        sign * (slowed.end() - now.position).to_f64() >= left
    }

    /// Raises alarm 10 in motion, 11 at standstill (WF-MON-04, W13), for any owner of the axis: the module monitors its
    /// axis while it is enabled. In open loop the distance to the end of a block is no error.
    pub(super) fn watch_following_error(&mut self, view: &View<'_>) -> Option<Order> {
        let allowed = view.parameters.vocabularies.wf.max_following_error.filter(|_| !is_open(view))?;
        if !view.on || !view.error.is_none() || self.state == State::Alarm {
            return None;
        }
        let error = self.following_error(view);
        if error.unsigned_abs() <= allowed.unsigned_abs() {
            return None;
        }
        if view.rests {
            self.raise(11, Code::WF_FOLLOWING_ERROR_AT_STANDSTILL, error, allowed)
        } else {
            self.raise(10, Code::WF_FOLLOWING_ERROR_IN_TRAVEL, error, allowed)
        }
    }
}

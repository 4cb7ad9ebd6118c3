//! OUTAN: the loops inside the position loop run at a given value, and no loop holds the position.
//!
//! Law      command = actual position. The value replaces the output of the position loop: a velocity as a fraction of
//!          max_velocity, or with AMPMODE 2 an effort as a fraction of max_effort; level effort bypasses the velocity
//!          loop. Every end (halt, stop, disable, an error) leaves the stop to the drive and then removes the power: it
//!          is not known yet whether a loop here could stop the axis
//! Reads    the values of commands, position and velocity of the axis, its limits
//! Writes   the generator; the errors of a limit before which the axis could not stop, and of overspeed
//! Refuses  a drive that closes its own position loop, is one of two, or would coast when it has to stop; an axis that
//!          moves; values beyond 1, or further into a limit
//! Source   MACS-AMP-02, MACS-CMD-28

use crate::axis::state::{Axis, Context, Failure, Generator, Power};
use crate::code::Code;
use crate::command::{Level, OutAn};
use crate::event::{Number, Refusal};
use crate::position::Position;
use crate::profile::Motion;
use crate::state::{AxisState, Reference};

/// Share of max_velocity above which an axis without position loop is too fast.
const OVERSPEED: f64 = 1.2;

/// Error of a velocity from counts, in increments per cycle.
const ROUNDING: f64 = 1.0;

impl Axis {
    /// Returns the active value of OUTAN, and its level.
    #[inline]
    pub(in crate::axis) fn out_an(&self) -> Option<(f64, Level)> {
        match *self.motion.generator() {
            Generator::OutAn { value, level } => Some((value, level)),
            _ => None,
        }
    }

    pub(in crate::axis) fn start_out_an(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: OutAn,
    ) -> Result<(), Refusal> {
        let OutAn { value, level, .. } = request;
        self.check_out_an(request)?;
        if self.out_an().is_some() {
            self.motion.run_out_an(value, level);
        } else {
            self.end_all_motion(cx, Code::REPLACED);
            self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Speed, Generator::OutAn { value, level });
        }
        let motion = self.opened_motion(value, level);
        self.command.execute(motion);
        self.accepted(cx, sequence);
        Ok(())
    }

    fn check_out_an(&self, OutAn { value, level, .. }: OutAn) -> Result<(), Refusal> {
        if !self.closes_loop_here() {
            return Err(self.refuse(Code::OUT_AN_NO_LOOP));
        }
        if self.gantry().is_some() {
            return Err(self.refuse(Code::OUT_AN_TWO_DRIVES));
        }
        if self.setup.analog.is_some() && self.has_effort_command() {
            return Err(self.refuse(Code::ANALOG_COASTS));
        }
        if level == Level::Effort && !self.has_effort_command() {
            return Err(self.refuse(Code::OUT_AN_NO_EFFORT));
        }
        if !(-1.0..=1.0).contains(&value) {
            return Err(self.refuse(Code::BAD_NUMBER).with(Number::Real(value), Number::Real(1.0)));
        }
        self.check_free()?;
        if self.out_an().is_none() && (!self.rests() || self.task.goal().is_some()) {
            return Err(self.not_at_standstill());
        }
        // An effort against the motion first stops the axis and then reverses it.
        let is_velocity = self.asks_velocity(level);
        self.check_forward(if is_velocity { value } else { -1.0 })?;
        self.check_velocity_switches(value)?;
        if let Some(limit) = self.limit_ahead(value) {
            let asked = Number::Velocity(value * self.parameters.max_velocity);
            return Err(self.refuse(Code::LIMIT_VIOLATION).with(asked, Number::Position(limit)));
        }
        Ok(())
    }

    /// Whether a value of that level is a velocity. Otherwise it is an effort.
    fn asks_velocity(&self, level: Level) -> bool {
        level == Level::Setpoint && (!self.has_effort_command() || self.parameters.amplifier.has_velocity_loop())
    }

    /// Returns the actual position and the commanded velocity (inc/s); 0 with an effort.
    fn opened_motion(&mut self, value: f64, level: Level) -> Motion {
        let (full, _) = self.full_reference();
        let velocity = if self.asks_velocity(level) { value * full } else { 0.0 };
        Motion { velocity, ..Motion::at_rest(self.feedback.position()) }
    }

    /// Executes [`advance`](Self::advance) for such an axis.
    pub(super) fn advance_out_an(&mut self, cx: &mut Context<'_>, value: f64, level: Level) {
        let next = self.opened_motion(value, level);
        // An effort has a direction as well.
        let towards = if next.velocity == 0.0 { value } else { next.velocity };
        if self.stop_at_switch(cx, Motion { velocity: towards, ..next }) {
            return;
        }
        self.command.execute(next);
        let (velocity, most) = (self.feedback.velocity(), self.parameters.max_velocity * OVERSPEED);
        if velocity.abs() > most + ROUNDING / self.cycle_s() {
            let found = (Number::Velocity(velocity), Number::Velocity(most));
            return self.raise(cx, Failure::of(Code::OVERSPEED).with(found.0, found.1));
        }
        if let Some(limit) = self.limit_ahead(value).or_else(|| self.limit_reached(velocity)) {
            let way = if velocity == 0.0 { value } else { velocity };
            self.stop_speed_at(cx, way, limit);
        }
    }

    /// Returns the software limit (inc) that a drive would pass if it stopped with max_deceleration as soon as it can.
    fn limit_reached(&self, velocity: f64) -> Option<i64> {
        let answer = self.cycle_s() * (self.delay() + 2) as f64;
        let way = velocity * (answer + velocity.abs() / (2.0 * self.stop_limits().deceleration));
        let end = self.feedback.position() + Position::from_f64(way);
        let limit = self.limit(velocity > 0.0);
        let is_beyond = if velocity > 0.0 { end > Position::whole(limit) } else { end < Position::whole(limit) };
        (velocity != 0.0 && is_beyond).then_some(limit)
    }

    /// Whether no loop here stops the axis: its position loop is open, or its drive stops it because it was open.
    pub(in crate::axis) fn drive_stops_axis(&self) -> bool {
        self.out_an().is_some() || matches!(self.status.power(), Power::DriveStops { .. })
    }

    /// Ends OUTAN: the drive stops by itself, and then its power is removed.
    pub(in crate::axis) fn let_drive_stop(&mut self, cx: &mut Context<'_>) {
        self.status.end_reference();
        // The time counts from the start of the stop.
        let since = if let Power::DriveStops { since, .. } = self.status.power() { since } else { cx.cycle };
        self.status.set_power(Power::DriveStops { since, then_off: true });
        self.command_actual_position();
        if matches!(self.status.state(), AxisState::ContinuousMotion) {
            self.set_state(cx, AxisState::DiscreteMotion);
        }
    }
}

//! Removes the power of an axis that the loop closed here cannot control.
//!
//! Law      after an error the loop stops the axis under power. The axis is lost if its following error is more than
//!          twice the allowed one, and exceeds that at the start of the stop by more than the allowed one; or if it
//!          exceeds the allowed one and has not become smaller for [`PATIENCE_NS`] while the command is at rest. A
//!          direction is wired wrong, or the drive does not follow.
//!          In any state the encoder is dead or the axis blocked if the encoder counts nothing while the drive is
//!          commanded a distance of more than max_following_error, or the largest effort for [`PUSH_NS`]
//! Reads    the following error, command and state of the axis, the command to its drive, whether its encoder moves
//! Writes   the error, which removes the power
//! Refuses  nothing; a drive that closes the loop supervises itself
//! Source   docs/loops.md: no source system defines this case

use crate::axis::state::recovery::Stop;
use crate::axis::state::{Axis, Context, Failure, Power, Recovery};
use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::state::AxisState;

/// Time for which a following error may stay unchanged once the command is at rest (ns).
const PATIENCE_NS: u64 = 50_000_000;

/// Time for which the largest effort may cause no motion (ns).
const PUSH_NS: u64 = 100_000_000;

/// Share of the full output below which no motion is expected: a drive has a smallest step.
const LEAST: f64 = 0.001;

/// Share of the largest effort that counts as the largest one.
const ALL: f64 = 0.95;

impl Axis {
    /// Removes the power of an axis that its loop cannot control.
    pub(in crate::axis) fn supervise_recovery(&mut self, cx: &mut Context<'_>) {
        if !self.closes_loop_here() {
            return;
        }
        if !self.has_loops() {
            *self.loops.recovery_mut() = Recovery::default();
            return;
        }
        if !self.drive_data.shown().is_fresh() {
            return;
        }
        self.supervise_stop(cx);
        if self.is_on() {
            self.supervise_standstill(cx);
        }
    }

    fn supervise_stop(&mut self, cx: &mut Context<'_>) {
        let error = self.supervision.following_error().unsigned_abs();
        if self.status.state() != AxisState::ErrorStop {
            self.loops.recovery_mut().stop = None;
            return;
        }
        let allowed = self.parameters.max_following_error.unsigned_abs();
        let before = self.loops.recovery().stop.unwrap_or(Stop { begun: error, least: error, waits: 0 });
        // While the command moves, a slower axis may lag further behind.
        let is_stuck = error > allowed && self.rests() && error >= before.least;
        let stop = Stop {
            begun: before.begun,
            least: if is_stuck { before.least } else { error },
            waits: if is_stuck { before.waits.saturating_add(1) } else { 0 },
        };
        self.loops.recovery_mut().stop = Some(stop);
        let is_lost = error > allowed.saturating_mul(2) && error > stop.begun.saturating_add(allowed);
        if is_lost || stop.waits.saturating_mul(self.setup.cycle_ns) > PATIENCE_NS {
            let (found, limit) = (self.supervision.following_error(), self.parameters.max_following_error);
            let failure = Failure::of(Code::RUNAWAY).with(Number::Position(found), Number::Position(limit));
            self.raise(cx, failure);
        }
    }

    fn supervise_standstill(&mut self, cx: &mut Context<'_>) {
        let standing = self.standstill_values();
        let recovery = self.loops.recovery_mut();
        (recovery.way, recovery.pushes) = standing;
        if self.is_standstill_too_long(standing) {
            let (way, pushes) = standing;
            // The cast saturates.
            let way = if pushes > 0 { self.supervision.following_error() } else { way as i64 };
            let limit = Number::Position(self.parameters.max_following_error);
            self.raise(cx, Failure::of(Code::ENCODER_STANDS).with(Number::Position(way), limit));
        }
    }

    /// Returns distance and cycles of the largest effort since the encoder last moved, from the command of the cycle
    /// before.
    #[inline]
    pub(in crate::axis) fn standstill_values(&self) -> (f64, u64) {
        let is_held = matches!(self.status.power(), Power::Opening { .. } | Power::Closing { .. }) || self.is_braked();
        // If the motor has an encoder of its own, a load that has not moved yet is no dead encoder.
        let turns = self.has_velocity_encoder() && self.velocity_change() != 0;
        if self.motor_change() != Position::ZERO || turns || is_held {
            return (0.0, 0);
        }
        let Recovery { way, pushes, .. } = *self.loops.recovery();
        if self.has_effort_command() {
            return (0.0, if self.is_at_largest_effort(ALL) { pushes.saturating_add(1) } else { 0 });
        }
        let output = self.regulator_output().abs();
        (if output > LEAST { way + output * self.parameters.max_velocity * self.cycle_s() } else { way }, 0)
    }

    /// Whether these values exceed those that an axis may have without motion.
    #[inline]
    pub(in crate::axis) fn is_standstill_too_long(&self, (way, pushes): (f64, u64)) -> bool {
        // Commands that have not reached the drive yet have moved nothing.
        let coming = self.parameters.max_velocity * self.cycle_s() * (self.delay() + 2) as f64;
        pushes.saturating_mul(self.setup.cycle_ns) > PUSH_NS
            || way > self.parameters.max_following_error as f64 + coming
    }

    /// Stores these values in a reduced cycle, in which nothing else needs supervision.
    #[inline]
    pub(in crate::axis) fn store_standstill(&mut self, (way, pushes): (f64, u64)) {
        let recovery = self.loops.recovery_mut();
        (recovery.way, recovery.pushes) = (way, pushes);
    }

    /// Whether there is neither a stop nor a command without motion.
    pub(in crate::axis) fn is_inactive(&self) -> bool {
        *self.loops.recovery() == Recovery::default()
    }
}

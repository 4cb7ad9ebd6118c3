//! A loop closed here that has lost its axis: the power goes.
//!
//! Law      An error has the axis under power, to stop it by the loop. Where its following error is more than twice what is
//!          allowed, and by what is allowed more than when the stop began; or more than what is allowed and has become no
//!          smaller for [`PATIENCE_NS`] while the command stands: the loop does not bring it back. A sense is wired the wrong way,
//!          or its drive does not follow.
//!          Whatever the axis does: where the encoder counts nothing, while the drive is asked for a way of more than
//!          max_following_error, or for the largest effort for [`PUSH_NS`], it is dead or the axis blocked
//! Reads    the following error, command and state of the axis, what its drive was asked for, whether its encoder moves
//! Writes   the error, which takes the power
//! Refuses  nothing; where the drive closes the loop, that watches itself
//! Source   docs/loops.md: no source system says what becomes of such an axis

use super::power::Power;
use super::reaction::Failure;
use super::{Axis, AxisState, Context};
use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// How long a following error may stay what it is once the command stands (ns).
const PATIENCE_NS: u64 = 50_000_000;
/// How long the largest effort may move nothing (ns).
const PUSH_NS: u64 = 100_000_000;
/// Outputs below this share of the full one ask for no motion: a drive has a smallest step.
const LEAST: f64 = 0.001;
/// From this share of the largest effort on it is the largest one.
const ALL: f64 = 0.95;

/// What is kept of a stop by the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Stop {
    /// Following error when it began (inc).
    begun: u64,
    /// The smallest since (inc).
    least: u64,
    /// Cycles with new data in which it became no smaller.
    waits: u64,
}

/// How an axis does whose loop is closed here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Recovery {
    stop: Option<Stop>,
    /// Way that was asked for since the encoder has moved last (inc).
    way: f64,
    /// Cycles of the largest effort since then.
    pushes: u64,
}

impl Recovery {
    pub(super) fn is_sound(&self) -> bool {
        self.way >= 0.0 && self.way.is_finite()
    }
}

impl Axis {
    /// Takes the power of an axis that its loop has lost.
    pub(super) fn supervise_recovery(&mut self, cx: &mut Context<'_>) {
        if !self.closes_loop_here() {
            return;
        }
        if !self.has_loops() {
            self.recovery = Recovery::default();
            return;
        }
        if !self.shown.is_fresh() {
            return;
        }
        self.supervise_stop(cx);
        if self.is_on() {
            self.supervise_standing(cx);
        }
    }

    fn supervise_stop(&mut self, cx: &mut Context<'_>) {
        let error = self.judge.following_error.unsigned_abs();
        if self.state != AxisState::ErrorStop {
            self.recovery.stop = None;
            return;
        }
        let allowed = self.parameters.max_following_error.unsigned_abs();
        let before = self.recovery.stop.unwrap_or(Stop { begun: error, least: error, waits: 0 });
        // While the command moves, an axis that is slower may fall back.
        let is_stuck = error > allowed && self.rests() && error >= before.least;
        let stop = Stop {
            begun: before.begun,
            least: if is_stuck { before.least } else { error },
            waits: if is_stuck { before.waits.saturating_add(1) } else { 0 },
        };
        self.recovery.stop = Some(stop);
        let is_lost = error > allowed.saturating_mul(2) && error > stop.begun.saturating_add(allowed);
        if is_lost || stop.waits.saturating_mul(self.setup.cycle_ns) > PATIENCE_NS {
            let (found, limit) = (self.judge.following_error, self.parameters.max_following_error);
            let failure = Failure::of(Code::RUNAWAY).with(Number::Position(found), Number::Position(limit));
            self.raise(cx, failure);
        }
    }

    fn supervise_standing(&mut self, cx: &mut Context<'_>) {
        let standing = self.standing();
        (self.recovery.way, self.recovery.pushes) = standing;
        if self.stands_too_long(standing) {
            let (way, pushes) = standing;
            // The cast saturates.
            let way = if pushes > 0 { self.judge.following_error } else { way as i64 };
            let limit = Number::Position(self.parameters.max_following_error);
            self.raise(cx, Failure::of(Code::ENCODER_STANDS).with(Number::Position(way), limit));
        }
    }

    /// Way and cycles of the largest effort since the encoder has moved last, by what was asked for in the cycle before.
    #[inline]
    pub(super) fn standing(&self) -> (f64, u64) {
        let is_held = matches!(self.power, Power::Opening { .. } | Power::Closing { .. }) || self.is_braked();
        // Where the motor has an encoder of its own, a load that has not come along yet is no dead encoder.
        let turns = self.has_velocity_encoder() && self.velocity_change() != 0;
        if self.motor_change() != Position::ZERO || turns || is_held {
            return (0.0, 0);
        }
        let Recovery { way, pushes, .. } = self.recovery;
        if self.takes_effort() {
            return (0.0, if self.asks_for_all(ALL) { pushes.saturating_add(1) } else { 0 });
        }
        let output = self.regulator_output().abs();
        (if output > LEAST { way + output * self.parameters.max_velocity * self.cycle_s() } else { way }, 0)
    }

    /// Is that more than an axis may stand?
    #[inline]
    pub(super) fn stands_too_long(&self, (way, pushes): (f64, u64)) -> bool {
        // What is on its way to the drive has moved nothing yet.
        let coming = self.parameters.max_velocity * self.cycle_s() * (self.delay() + 2) as f64;
        pushes.saturating_mul(self.setup.cycle_ns) > PUSH_NS
            || way > self.parameters.max_following_error as f64 + coming
    }

    /// A calm cycle was one without anything to supervise.
    #[inline]
    pub(super) fn keep_standing(&mut self, (way, pushes): (f64, u64)) {
        (self.recovery.way, self.recovery.pushes) = (way, pushes);
    }

    /// Is there nothing of a stop, and nothing asked for that moves nothing?
    pub(super) fn is_well(&self) -> bool {
        self.recovery == Recovery::default()
    }
}

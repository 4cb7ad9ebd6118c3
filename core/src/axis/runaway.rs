//! A loop closed here that does not bring its axis back: the power goes.
//!
//! Law      An error has the axis under power, to stop it by the loop. Where its following error is more than twice what is
//!          allowed, or more than that and has become no smaller for [`PATIENCE_NS`] while the command stands, the loop has lost the
//!          axis: a sense wired the wrong way, an encoder that is dead, a drive that does not follow
//! Reads    the following error, command and state of the axis
//! Writes   the error, which takes the power
//! Refuses  nothing; where the drive closes the loop, that watches itself

use super::reaction::Failure;
use super::{Axis, AxisState, Context};
use crate::code::Code;
use crate::event::Number;
use serde::{Deserialize, Serialize};

/// How long a following error may stay what it is once the command stands (ns).
const PATIENCE_NS: u64 = 50_000_000;

/// The smallest following error since the axis has to stop (inc), and the cycle in which it was that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Recovery(Option<(u64, u64)>);

impl Axis {
    /// Takes the power of an axis that its loop has lost.
    pub(super) fn supervise_recovery(&mut self, cx: &mut Context<'_>) {
        if !self.closes_loop_here() {
            return;
        }
        let allowed = self.parameters.max_following_error.unsigned_abs();
        let error = self.judge.following_error.unsigned_abs();
        if self.state != AxisState::ErrorStop || !self.is_on() || error <= allowed {
            self.recovery = Recovery::default();
            return;
        }
        let (least, since) = match self.recovery.0 {
            // While the command moves, an axis that is slower may fall back.
            Some((least, since)) if self.rests() && error >= least => (least, since),
            _ => (error, cx.cycle),
        };
        self.recovery = Recovery(Some((least, since)));
        let waited = cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        if error > allowed.saturating_mul(2) || waited > PATIENCE_NS {
            let (found, limit) = (self.judge.following_error, self.parameters.max_following_error);
            let failure = Failure::of(Code::RUNAWAY).with(Number::Position(found), Number::Position(limit));
            self.raise(cx, failure);
        }
    }
}

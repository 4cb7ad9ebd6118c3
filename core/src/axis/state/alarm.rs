//! The error of an axis.
//!
//! Law      the first error remains with its numbers until it is cleared. The snapshot of the axis at the last error
//!          remains until the next error
//! Source   MACS-ERR-02, -03

use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use serde::{Deserialize, Serialize};

/// Found value and allowed value of an error.
pub(in crate::axis) type Numbers = (Number, Number);

/// For codes whose message has no numbers.
pub(in crate::axis) const NO_NUMBERS: Numbers = (Number::None, Number::None);

/// The active error of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct ActiveError {
    code: Code,
    numbers: Numbers,
    fault: ErrorSnapshot,
}

/// Snapshot of an axis in the cycle of its last error, before the reaction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorSnapshot {
    /// Code of the error; [`Code::NONE`] before the first error.
    pub code: Code,
    /// Cycle of the error.
    pub cycle: u64,
    /// State of the axis.
    pub state: AxisState,
    /// Source of the command.
    pub reference: Reference,
    /// Command position.
    pub command: Position,
    /// Command velocity (inc/s).
    pub velocity: f64,
    /// Actual position (inc).
    pub actual: i64,
    /// Actual velocity (inc/s).
    pub actual_velocity: f64,
    /// Following error (inc).
    pub following_error: i64,
}

impl ErrorSnapshot {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.velocity.is_finite() && self.actual_velocity.is_finite()
    }
}

impl Default for ActiveError {
    fn default() -> Self {
        Self { code: Code::NONE, numbers: NO_NUMBERS, fault: ErrorSnapshot::default() }
    }
}

impl ActiveError {
    #[inline]
    pub(in crate::axis) fn code(&self) -> Code {
        self.code
    }

    #[inline]
    pub(in crate::axis) fn is_none(&self) -> bool {
        self.code.is_none()
    }

    /// Returns the numbers of the last error.
    pub(in crate::axis) fn numbers(&self) -> Numbers {
        self.numbers
    }

    /// Returns the snapshot of the axis at the last error.
    pub(in crate::axis) fn fault(&self) -> &ErrorSnapshot {
        &self.fault
    }

    /// Sets an error.
    pub(in crate::axis) fn set(&mut self, numbers: Numbers, fault: ErrorSnapshot) {
        *self = Self { code: fault.code, numbers, fault };
    }

    /// Clears the error and returns its code.
    pub(in crate::axis) fn clear(&mut self) -> Code {
        std::mem::replace(&mut self.code, Code::NONE)
    }
}

//! The error of an axis.
//!
//! Law      the first one stands until it is cleared; its numbers stand with it, and how the axis stood stays until the next one
//! Source   MACS-ERR-02, -03

use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use serde::{Deserialize, Serialize};

/// What was found and what is allowed.
pub(super) type Numbers = (Number, Number);

/// For codes whose sentence needs none.
pub(super) const NO_NUMBERS: Numbers = (Number::None, Number::None);

/// The error that stopped an axis, or that it reports.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Alarm {
    code: Code,
    numbers: Numbers,
    fault: Fault,
}

/// How an axis stood in the cycle of its last error, before the reaction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// Its code; [`Code::NONE`] where none ever came.
    pub code: Code,
    /// The cycle.
    pub cycle: u64,
    /// Its state.
    pub state: AxisState,
    /// What commanded it.
    pub reference: Reference,
    /// Command position.
    pub command: Position,
    /// Command velocity (inc/s).
    pub velocity: f64,
    /// Actual position (inc).
    pub actual: i64,
    /// Actual velocity (inc/s).
    pub actual_velocity: f64,
    /// (inc)
    pub following_error: i64,
}

impl Fault {
    pub(super) fn is_sound(&self) -> bool {
        self.velocity.is_finite() && self.actual_velocity.is_finite()
    }
}

impl Default for Alarm {
    fn default() -> Self {
        Self { code: Code::NONE, numbers: NO_NUMBERS, fault: Fault::default() }
    }
}

impl Alarm {
    #[inline]
    pub(super) fn code(&self) -> Code {
        self.code
    }

    #[inline]
    pub(super) fn is_none(&self) -> bool {
        self.code.is_none()
    }

    /// The numbers of the last one.
    pub(super) fn numbers(&self) -> Numbers {
        self.numbers
    }

    /// How the axis stood when the last one came.
    pub(super) fn fault(&self) -> &Fault {
        &self.fault
    }

    /// One comes.
    pub(super) fn set(&mut self, numbers: Numbers, fault: Fault) {
        *self = Self { code: fault.code, numbers, fault };
    }

    /// It is over; what it was.
    pub(super) fn clear(&mut self) -> Code {
        std::mem::replace(&mut self.code, Code::NONE)
    }
}

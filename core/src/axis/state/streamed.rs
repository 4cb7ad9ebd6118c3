//! State of the streamed setpoints of an axis.

use crate::code::Code;
use serde::{Deserialize, Serialize};

/// State of the streamed setpoints of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Streamed {
    /// Cycles since the last setpoint that it followed.
    pub(in crate::axis) age: u64,
    /// Duration of that setpoint (ns).
    pub(in crate::axis) duration: Option<u64>,
    /// Cycles since the last setpoint that was received.
    pub(in crate::axis) silence: u64,
    /// Reported reason why a setpoint was not followed.
    pub(in crate::axis) told: Code,
}

impl Default for Streamed {
    /// No setpoint was received yet.
    fn default() -> Self {
        Self { age: u64::MAX, duration: None, silence: u64::MAX, told: Code::NONE }
    }
}

impl Streamed {
    /// Counts a cycle without a setpoint.
    pub(in crate::axis) fn pass(&mut self) {
        (self.age, self.silence) = (self.age.saturating_add(1), self.silence.saturating_add(1));
    }

    /// Whether no reported reason has to be cleared later.
    pub(in crate::axis) fn is_settled(&self) -> bool {
        self.told.is_none()
    }
}

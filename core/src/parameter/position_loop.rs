//! The position loop that the core closes for drives which only close that of their velocity.

use crate::regulator::KV;
use serde::{Deserialize, Serialize};

/// Its parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PositionLoop {
    /// Gain: velocity per following error (1/s).
    pub kv: f64,
    /// The gain as given in (mm/min)/um; none where it was given in 1/s.
    pub given: Option<f64>,
}

impl PositionLoop {
    /// The gain in (mm/min)/um.
    pub fn servo_gain(&self) -> f64 {
        self.given.unwrap_or(self.kv / KV)
    }

    /// Computes what follows from the gain as it was given.
    pub(super) fn derive(&mut self) {
        if let Some(gain) = self.given {
            self.kv = gain * KV;
        }
    }
}

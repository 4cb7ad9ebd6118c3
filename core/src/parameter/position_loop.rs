//! Position loop of the core, for drives that close only the velocity loop.

use crate::regulator::KV;
use serde::{Deserialize, Serialize};

/// Parameters of the position loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PositionLoop {
    /// Gain: velocity per following error (1/s).
    pub kv: f64,
    /// Gain as given in (mm/min)/um; `None` if it was given in 1/s.
    pub given: Option<f64>,
}

impl PositionLoop {
    /// Returns the gain in (mm/min)/um.
    pub fn servo_gain(&self) -> f64 {
        self.given.unwrap_or(self.kv / KV)
    }

    /// Computes the values that derive from the given gain.
    pub(super) fn derive(&mut self) {
        if let Some(gain) = self.given {
            self.kv = gain * KV;
        }
    }
}

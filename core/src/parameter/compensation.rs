//! Compensation of errors of the screw between motor and load, added to the command of the drive.

use serde::{Deserialize, Serialize};

/// Parameters of the compensation; the pitch error is in a table of the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Compensation {
    /// Backlash: travel of the motor before the load follows after a reversal (inc); 0: none.
    pub backlash: i64,
    /// Velocity of the backlash compensation (inc/s); `None`: a tenth of `max_velocity`.
    pub velocity: Option<f64>,
}

impl Compensation {
    /// Returns the velocity of the backlash compensation for an axis with that maximum velocity (inc/s).
    pub fn usual_velocity(&self, max_velocity: f64) -> f64 {
        self.velocity.unwrap_or(max_velocity / 10.0)
    }
}

//! What an axis asks of its drive beyond its command, for the screw between motor and load.

use serde::{Deserialize, Serialize};

/// Its parameters; what the pitch error is stands in a table of the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Compensation {
    /// How far the motor turns before the load follows it back (inc); 0: none.
    pub backlash: i64,
    /// How fast it is taken up (inc/s); left out: a tenth of `max_velocity`.
    pub velocity: Option<f64>,
}

impl Compensation {
    /// How fast it is taken up on an axis with that highest velocity (inc/s).
    pub fn usual_velocity(&self, max_velocity: f64) -> f64 {
        self.velocity.unwrap_or(max_velocity / 10.0)
    }
}

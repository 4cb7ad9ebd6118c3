//! Controllers of the core, for drives that do not close their loops themselves.

mod current;
mod estimator;
mod fade;
mod i2t;
mod pid;
mod proportional;
mod sum;
mod take_up;
mod velocity;

pub use current::{CURRENT_SAMPLE, CurrentGains, CurrentLoop, DC3, DC6, Design, DesignError, Winding, capped};
pub use estimator::{EstimatorError, MotionModel, VelocityEstimator, VelocityMethod};
pub use i2t::{Heat, HeatFilter, I2T_WARNING, I2t, I2tSettings};
pub use pid::{K_OUT, Pid, PidGains, PidInput, Window};
pub use proportional::{KV, Proportional};
pub(crate) use take_up::{Compensator, PAST, past};
pub use velocity::{CARRY_TIME, VELOCITY_GAIN, VELOCITY_SUM, VelocityGains, VelocityLoop};

use serde::{Deserialize, Serialize};

/// Law of a position loop that is closed here; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// [`Proportional`]
    #[default]
    Proportional,
    /// [`Pid`]
    Pid,
    /// Integer PID controller of a vocabulary, with its own samples and registers.
    Integer,
}

impl Law {
    /// All laws.
    pub const ALL: [Self; 3] = [Self::Proportional, Self::Pid, Self::Integer];

    /// Returns its name in a cell.
    pub fn name(self) -> &'static str {
        match self {
            Self::Proportional => "proportional",
            Self::Pid => "pid",
            Self::Integer => "integer",
        }
    }
}

//! Regulators that close a loop in the core, for drives that do not close it themselves.

mod fade;
mod pid;
mod proportional;

pub use pid::{K_OUT, Pid, PidGains, PidInput, Window};
pub use proportional::{KV, Proportional};

use serde::{Deserialize, Serialize};

/// The law of a position loop that is closed here; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// [`Proportional`]
    #[default]
    Proportional,
    /// [`Pid`]
    Pid,
}

impl Law {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Proportional, Self::Pid];

    /// Its name in a cell.
    pub fn name(self) -> &'static str {
        match self {
            Self::Proportional => "proportional",
            Self::Pid => "pid",
        }
    }
}

//! An active shift of the master.

use crate::code::Code;
use crate::sync::Shift;
use serde::{Deserialize, Serialize};

/// An active shift of the master.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Phasing {
    /// Number of its command.
    pub sequence: u64,
    pub(in crate::axis) shift: Shift,
    pub(in crate::axis) ending: Option<Code>,
}

impl Phasing {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.shift.is_sound()
    }
}

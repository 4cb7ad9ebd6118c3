//! Contacts of the cell that stop axes.

use crate::code::Code;
use crate::drive::Inputs;
use serde::{Deserialize, Serialize};

/// Contacts of the cell, by their indices among the digital inputs. A closed contact reads 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Safety {
    /// Emergency stop: axes stop, then their power is removed.
    pub estop: Option<u32>,
    /// Interlock of a guard: axes stop and hold.
    pub interlock: Option<u32>,
}

impl Safety {
    /// Returns the code of the open contact that prevents motion.
    pub(in crate::axis) fn open(&self, inputs: &Inputs) -> Option<Code> {
        let is_open = |place: Option<u32>| place.is_some_and(|place| !inputs.digital(place as usize));
        match () {
            () if is_open(self.estop) => Some(Code::EMERGENCY_STOP),
            () if is_open(self.interlock) => Some(Code::INTERLOCK),
            () => None,
        }
    }
}

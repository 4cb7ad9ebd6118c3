//! Contacts of the cell that stop axes, and the snapshot of an axis at an error.
//!
//! Law      a contact that reads 0 stops every axis that is on or moves, in the same cycle; a broken wire does the same
//! Reads    the digital inputs that section `safety` of the cell names
//! Refuses  with an open contact: enable and every motion
//! Source   MACS-ERR-04; the contacts of a safety relay must act on the power of the drives as well

use super::alarm::ErrorSnapshot;
use super::power::Power;
use super::reaction::Failure;
use super::{Axis, AxisState, Context};
use crate::code::Code;
use crate::drive::Inputs;
use crate::event::{Number, Refusal};
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
    fn open(&self, inputs: &Inputs) -> Option<Code> {
        let is_open = |place: Option<u32>| place.is_some_and(|place| !inputs.digital(place as usize));
        match () {
            () if is_open(self.estop) => Some(Code::EMERGENCY_STOP),
            () if is_open(self.interlock) => Some(Code::INTERLOCK),
            () => None,
        }
    }
}

impl Axis {
    /// Stops the axis if a contact is open.
    pub(super) fn watch_contacts(&mut self, cx: &mut Context<'_>) {
        let now = self.setup.safety.open(cx.inputs).unwrap_or(Code::NONE);
        let before = self.alarm.see_contact(now);
        if now.is_none() {
            return;
        }
        let runs = if self.is_virtual() { !self.rests() } else { !matches!(self.status.power(), Power::Off) };
        let stops_for_it = self.status.state() == AxisState::ErrorStop && self.alarm.code() == now;
        if !runs || stops_for_it {
            return;
        }
        self.raise(cx, Failure::of(now).before_motion().lasting(now == before));
    }

    /// Returns an error while a contact is open.
    pub(super) fn check_contacts(&self) -> Result<(), Refusal> {
        if self.alarm.open_contact().is_none() { Ok(()) } else { Err(self.refuse(self.alarm.open_contact())) }
    }

    /// Raises an error again after a reset if its cause persists (MACS-ERR-04).
    pub(super) fn return_error(&mut self, cx: &mut Context<'_>, before: Code, lasting: Option<(Number, Number)>) {
        if !self.alarm.open_contact().is_none() && before == self.alarm.open_contact() {
            self.raise(cx, Failure::of(before));
        } else if let Some((found, allowed)) = lasting {
            self.raise_following_error(cx, found, allowed);
        }
    }

    /// Returns a snapshot of the axis for an error of this cycle.
    pub(super) fn fault_of(&self, cycle: u64, code: Code) -> ErrorSnapshot {
        ErrorSnapshot {
            code,
            cycle,
            state: self.status.state(),
            reference: self.status.reference(),
            command: self.command.position(),
            velocity: self.command.velocity(),
            actual: self.feedback.position().floor(),
            actual_velocity: self.feedback.velocity(),
            following_error: self.supervision.following_error,
        }
    }
}

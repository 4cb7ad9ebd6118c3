//! Contacts of the cell that stop axes, and the snapshot of an axis at an error.
//!
//! Law      a contact that reads 0 stops every axis that is on or moves, in the same cycle; a broken wire does the same
//! Reads    the digital inputs that section `safety` of the cell names
//! Refuses  with an open contact: enable and every motion
//! Source   MACS-ERR-04; the contacts of a safety relay must act on the power of the drives as well

use crate::axis::state::{Axis, Context, ErrorSnapshot, Failure, Power};
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::state::AxisState;

impl Axis {
    /// Stops the axis if a contact is open.
    pub(in crate::axis) fn watch_contacts(&mut self, cx: &mut Context<'_>) {
        let now = self.setup.safety.open(cx.inputs).unwrap_or(Code::NONE);
        let before = self.alarm.replace_contact(now);
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
    pub(in crate::axis) fn check_contacts(&self) -> Result<(), Refusal> {
        if self.alarm.open_contact().is_none() { Ok(()) } else { Err(self.refuse(self.alarm.open_contact())) }
    }

    /// Raises an error again after a reset if its cause persists (MACS-ERR-04).
    pub(in crate::axis) fn return_error(
        &mut self,
        cx: &mut Context<'_>,
        before: Code,
        lasting: Option<(Number, Number)>,
    ) {
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
            following_error: self.supervision.following_error(),
        }
    }
}

//! Activation and deactivation of a machine.
//!
//! Law      inactive: nothing is switched on and nothing moves; inputs are read, signals and events continue
//! Refuses  while inactive: enable, and every command that starts a motion (NOT_ACTIVE)
//! Source   contract section 7, states of a ROS 2 lifecycle node

use super::Machine;
use crate::axis::Axis;
use crate::code::Code;
use crate::command::Command;
use crate::event::{Event, Kind, Severity};
use crate::object::Object;

impl Machine {
    /// Whether axes may be switched on and moved.
    pub fn is_active(&self) -> bool {
        self.state.active
    }

    /// Allows axes to be switched on again. Axes that a deactivation is stopping continue to stop; the deactivation
    /// itself ends here with REPLACED.
    pub(super) fn activate(&mut self, command: &Command) {
        self.replace_deactivation();
        self.set_active(true);
        self.accept(command, Object::Machine);
    }

    /// Starts the deactivation. Each axis receives the command and stops.
    pub(super) fn deactivate(&mut self, command: &Command) {
        self.replace_deactivation();
        self.set_active(false);
        self.accept(command, Object::Machine);
        self.state.deactivating = Some(command.sequence);
    }

    /// Reports the end of a deactivation once every drive is switched off.
    pub(super) fn settle_deactivation(&mut self) {
        if self.state.deactivating.is_some() && self.state.axes.iter().all(Axis::is_off) {
            self.end_deactivation(Code::NONE);
        }
    }

    fn replace_deactivation(&mut self) {
        self.end_deactivation(Code::REPLACED);
    }

    fn end_deactivation(&mut self, code: Code) {
        if let Some(sequence) = self.state.deactivating.take() {
            self.events.push(Event::new(Severity::Info, Kind::Done, Object::Machine, code).of_command(sequence));
        }
    }

    fn set_active(&mut self, active: bool) {
        self.state.active = active;
        self.state.axes.iter_mut().for_each(|axis| axis.set_active(active));
    }
}

//! Active and inactive.
//!
//! Law      inactive: nothing is switched on and nothing moves; inputs are read, signals and events go on
//! Refuses  inactive: enable, and every command that begins a motion (NOT_ACTIVE)
//! Source   contract section 7, the states of a ROS 2 node with a life cycle

use super::Machine;
use crate::axis::Axis;
use crate::code::Code;
use crate::command::Command;
use crate::event::{Event, Kind, Severity};
use crate::object::Object;

impl Machine {
    /// May axes be switched on and moved?
    pub fn is_active(&self) -> bool {
        self.state.active
    }

    /// Lets axes be switched on again. Those that a deactivation still stops go on stopping; nobody is told its end.
    pub(super) fn activate(&mut self, command: &Command) {
        self.replace_deactivation();
        self.set_active(true);
        self.accept(command, Object::Machine);
    }

    /// Each axis finds the command and stops itself.
    pub(super) fn deactivate(&mut self, command: &Command) {
        self.replace_deactivation();
        self.set_active(false);
        self.accept(command, Object::Machine);
        self.state.deactivating = Some(command.sequence);
    }

    /// Tells the end of a deactivation, once every drive is off.
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

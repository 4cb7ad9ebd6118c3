//! Status of an axis: its state, the source of its command, its power, and the owner of its motion.

use super::power::Power;
use crate::code::Code;
use crate::event::{Event, EventQueue, Kind, Number, Severity};
use crate::object::Object;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use crate::vocabulary::Owner;
use serde::{Deserialize, Serialize};

/// Status of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct Status {
    state: AxisState,
    reference: Reference,
    power: Power,
    /// Whether the command of this cycle came from a leader or an encoder, so that its acceleration is that of single
    /// counts.
    is_led: bool,
    /// Whether the reference of the drive is below 0; outputs may have to show that.
    is_backwards: bool,
    brake: bool,
    owner: Owner,
}

impl Status {
    /// Returns the status of an axis that is switched off; a virtual axis is always on.
    pub(in crate::axis) fn new(is_virtual: bool) -> Self {
        Self {
            state: if is_virtual { AxisState::Standstill } else { AxisState::Disabled },
            reference: Reference::Stop,
            power: if is_virtual { Power::On } else { Power::Off },
            is_led: false,
            is_backwards: false,
            brake: false,
            owner: Owner::Native,
        }
    }

    #[inline]
    pub(in crate::axis) fn state(&self) -> AxisState {
        self.state
    }

    /// Changes the state and reports it, with the command position. A state that a stop with lock replaces in the same
    /// cycle is not reported.
    pub(in crate::axis) fn enter(
        &mut self,
        state: AxisState,
        events: &mut EventQueue,
        (object, position): (Object, Position),
    ) {
        if self.state != state {
            self.state = state;
            let event = Event::new(Severity::Info, Kind::State, object, Code::NONE);
            let event = event.with(Number::Count(state as i64), Number::None);
            let locks = matches!(state, AxisState::Stopping | AxisState::ErrorStop);
            let is_outdated = |last: &Event| locks && last.kind == Kind::State && last.source == object;
            events.push_over(Event { position, ..event }, is_outdated);
        }
    }

    /// Returns the source of the command.
    #[inline]
    pub(in crate::axis) fn reference(&self) -> Reference {
        self.reference
    }

    /// Sets the source of the command from now on.
    #[inline]
    pub(in crate::axis) fn refer_to(&mut self, reference: Reference) {
        self.reference = reference;
    }

    /// Ends the source of the command: the axis stops, or is at rest.
    #[inline]
    pub(in crate::axis) fn end_reference(&mut self) {
        self.reference = Reference::Stop;
    }

    #[inline]
    pub(in crate::axis) fn power(&self) -> Power {
        self.power
    }

    #[inline]
    pub(in crate::axis) fn set_power(&mut self, power: Power) {
        self.power = power;
    }

    /// Whether the axis itself generates the command position. Otherwise it is the actual position.
    #[inline]
    pub(in crate::axis) fn is_on(&self) -> bool {
        matches!(self.power, Power::On | Power::SwitchingOff | Power::Opening { .. } | Power::Closing { .. })
    }

    /// Whether the command of this cycle came from a leader or an encoder.
    #[inline]
    pub(in crate::axis) fn is_led(&self) -> bool {
        self.is_led
    }

    #[inline]
    pub(in crate::axis) fn set_led(&mut self, is_led: bool) {
        self.is_led = is_led;
    }

    /// Whether the reference of the drive is below 0.
    #[inline]
    pub(in crate::axis) fn is_backwards(&self) -> bool {
        self.is_backwards
    }

    #[inline]
    pub(in crate::axis) fn set_backwards(&mut self, is_backwards: bool) {
        self.is_backwards = is_backwards;
    }

    /// Whether the error reaction or an abort requests the brake.
    #[inline]
    pub(in crate::axis) fn is_brake_requested(&self) -> bool {
        self.brake
    }

    /// Requests the brake if `asks`; an earlier request stays.
    #[inline]
    pub(in crate::axis) fn request_brake(&mut self, asks: bool) {
        self.brake |= asks;
    }

    /// Ends the request of the brake. Returns true if there was one.
    #[inline]
    pub(in crate::axis) fn release_brake(&mut self) -> bool {
        std::mem::take(&mut self.brake)
    }

    /// Returns the owner of the motion.
    #[inline]
    pub(in crate::axis) fn owner(&self) -> Owner {
        self.owner
    }

    #[inline]
    pub(in crate::axis) fn set_owner(&mut self, owner: Owner) {
        self.owner = owner;
    }

    /// Ends the motion of a vocabulary, if one owns it.
    pub(in crate::axis) fn leave_vocabulary(&mut self) {
        if std::mem::take(&mut self.owner) != Owner::Native {
            self.end_reference();
        }
    }
}

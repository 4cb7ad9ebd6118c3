//! Counting direction of an axis (POSDRCT), and outputs for the sign of its reference (REVERS).
//!
//! Law      position = direction * (origin + count). Values to and from the drive are inverted only here, so that all
//!          values inside the axis are in the direction of the user. If the direction of an axis without power is
//!          changed, the axis keeps its place: its position is mirrored
//! Reads    POSDRCT, REVERS
//! Writes   nothing; the axis calls these functions wherever counts and positions meet
//! Refuses  nothing
//! Source   MACS-DIR-01..10, A-07, A-08

use crate::axis::state::Axis;
use crate::drive::{Interface, Switching};
use crate::parameter::{AxisParameters, CountDirection, Polarity};
use crate::position::Position;
use crate::profile::Motion;

/// Whether the position loop can be inverted here. A drive that closes its own position loop has to be inverted itself
///
pub fn may_turn_loop(interface: Option<Interface>, parameters: &AxisParameters) -> bool {
    !parameters.sense().position || !matches!(interface, Some(Interface::Position))
}

/// Whether outputs can give the sign of the reference. A position reference has its own sign.
pub fn may_output_sign(interface: Option<Interface>, parameters: &AxisParameters) -> bool {
    let by_speed = matches!(interface, Some(Interface::Velocity | Interface::OpenLoop));
    by_speed || parameters.reversing().polarity == Polarity::Bipolar
}

impl Axis {
    /// Returns the reference for a unipolar drive, which has no sign (inc/s).
    pub(in crate::axis) fn unipolar(&self, velocity: f64) -> f64 {
        match self.parameters.reversing().polarity {
            Polarity::Bipolar => velocity,
            Polarity::Direction(_) | Polarity::Enables(_) => velocity.abs(),
        }
    }

    /// Whether outputs give the sign of the reference.
    #[inline]
    pub fn outputs_sign(&self) -> bool {
        self.parameters.reversing().polarity != Polarity::Bipolar
    }

    /// Returns the outputs that give the sign of the reference: number and level (MACS-DIR-08, MACS-DIR-09).
    pub fn sign_outputs(&self) -> [Option<(u8, bool)>; 2] {
        let backwards = self.status.is_backwards();
        match self.parameters.reversing().polarity {
            Polarity::Bipolar => [None, None],
            Polarity::Direction(output) => [Some((output, backwards)), None],
            Polarity::Enables(output) => {
                let on = self.is_on();
                [Some((output, on && !backwards)), Some((output + 1, on && backwards))]
            }
        }
    }

    /// Returns the direction of the axis. A virtual axis has no encoder and so no inverted direction.
    #[inline]
    pub(in crate::axis) fn direction(&self) -> CountDirection {
        if self.is_virtual() { CountDirection::default() } else { self.parameters.sense() }
    }

    /// Converts counts of the drive to the direction of the axis (inc), and back.
    #[inline]
    pub(in crate::axis) fn turn_counts(&self, counts: i64) -> i64 {
        self.direction().invert(counts)
    }

    /// Converts a value of the drive to the direction of the axis, and back.
    #[inline]
    pub(in crate::axis) fn convert_direction(&self, value: f64) -> f64 {
        self.direction().invert_real(value)
    }

    /// Converts a reference to the direction in which the motor turns, that of the loop that is closed here.
    #[inline]
    pub(in crate::axis) fn reference_across(&self, value: f64) -> f64 {
        let value = self.convert_direction(value);
        if self.direction().position && self.setup.interface != Interface::Position { 0.0 - value } else { value }
    }

    /// Returns the whole increment for the drive at `position`, in the direction of the axis: the lower one in the
    /// counts of the drive.
    #[inline]
    fn commanded_increment_at(&self, position: Position) -> i64 {
        let sense = self.direction();
        sense.invert(sense.invert_position(position).floor())
    }

    /// Returns the whole increment for the drive in this cycle, in the direction of the axis.
    #[inline]
    pub(in crate::axis) fn commanded_increment(&self) -> i64 {
        self.commanded_increment_at(self.command.position())
    }

    /// Returns the rest of an axis that stops at `position`: at the increment that the drive already has.
    pub(in crate::axis) fn resting(&self, position: Position) -> Motion {
        Motion::at_rest(Position::whole(self.commanded_increment_at(position)))
    }

    /// Returns the outputs that choose a direction, as wired to the motor.
    pub(crate) fn switching_of(&self, shown: Switching) -> Switching {
        if self.reference_across(1.0) > 0.0 {
            return shown;
        }
        Switching { forward: shown.backward, backward: shown.forward, dac: 0.0 - shown.dac, ..shown }
    }
}

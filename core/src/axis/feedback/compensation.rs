//! Compensation of pitch errors and backlash between motor and load, so that the load is at the commanded position.
//!
//! Law      counts = position of the load + c. c = pitch error(position) + gap; the gap is 0 in the direction in which
//!          the reference was found, and the backlash against it in the other direction. The position is the command
//!          while the axis is on, in the coordinate of the own zero of the axis and in the direction of the encoder. c
//!          follows this value with at most compensation.velocity, in whole increments, and starts at 0 while the axis
//!          has no reference. c stays unchanged during homing, while the brake is closed under power, and while OUTAN
//!          opens the position loop. The drive gets command + c. The c to which the counts respond, 1 + delay cycles
//!          old, is subtracted from the counts, so that compensation is no motion of the axis. A new zero is one of the
//!          motor: c is 0 there
//! Reads    the command, whether the axis is referenced, the table of pitch errors, compensation.backlash,
//!          compensation.velocity
//! Writes   the value added to the command of the drive, and the value subtracted from its counts
//! Refuses  nothing: a table that is no pitch error was refused before
//! Source   WF-INC-04, docs/compensation.md

use crate::axis::state::setup::MAX_DELAY;
use crate::axis::state::{Axis, Power};
use crate::modulo::Modulo;
use crate::position::Position;
use crate::regulator::PAST;
use crate::table::{PitchError, Table};
use std::sync::Arc;

const _: () = assert!(MAX_DELAY as usize + 1 == PAST, "a ring holds the cycles of the longest delay");

impl Axis {
    /// Subtracts from the counts, before those of this cycle are read, the compensation that they contain. Returns the
    /// motion of the load in addition to its counts (inc, in the direction of the encoder).
    pub(super) fn subtract_compensation(&mut self) -> i64 {
        if self.loops.compensation().is_idle() {
            return 0;
        }
        let by = self.loops.compensation_mut().advance_counts().saturating_neg();
        if by != 0 {
            self.feedback.counter_mut().shift(by);
            // The index pulses of a simulated encoder follow the command.
            if !self.is_simulated() {
                self.shift_pulses(by);
            }
        }
        by
    }

    /// Adds a motion of the load to that of its counts (inc, in the direction of the encoder).
    pub(super) fn add_load_motion(&mut self, by: i64) {
        if by != 0 {
            let change = Position::whole(self.turn_counts(by));
            self.feedback.add_motion(change, self.convert_direction(by as f64 / self.cycle_s()));
        }
    }

    /// Returns the index of the table of pitch errors.
    pub fn pitch_error(&self) -> Option<u16> {
        self.setup.pitch_error
    }

    /// Checks whether a table can be the pitch error of this axis.
    ///
    /// # Errors
    /// The reason why it cannot.
    pub fn check_pitch_error(&self, table: &Table) -> Result<(), PitchError> {
        table.check_pitch(self.setup.modulo.map(Modulo::length))
    }

    /// Advances the compensation by one cycle.
    pub(in crate::axis) fn compensate(&mut self, tables: &[Arc<Table>]) {
        let p = self.parameters.compensation;
        let pitch = self.setup.pitch_error.and_then(|place| tables.get(usize::from(place)));
        let is_wanted = p.backlash != 0 || self.setup.pitch_error.is_some();
        if self.loops.compensation().is_idle() && !is_wanted {
            return;
        }
        let is_own = self.is_on() && !self.homing.is_in_drive();
        let place =
            self.turn_counts(if is_own { self.commanded_increment() } else { self.feedback.position().floor() });
        if self.loops.compensation().is_idle() {
            self.loops.compensation_mut().begin_at(place);
        }
        self.loops.compensation_mut().set_command_position(place, is_own);
        // The motor must not turn against its brake, nor while the brake opens or closes.
        let is_held =
            is_own && self.is_braked() || matches!(self.status.power(), Power::Opening { .. } | Power::Closing { .. });
        // Nothing moves the motor to a new compensation while its position loop is open.
        let is_held = is_held || self.out_an().is_some();
        let target = if self.homing.is_running() || is_held {
            self.loops.compensation().commanded_compensation()
        } else if self.is_referenced() {
            let place = place.saturating_sub(self.turn_counts(self.homing.limit_shift()));
            let turn = self.setup.modulo.map(Modulo::length);
            let within = |modulo: Modulo| modulo.split(Position::whole(place)).1.floor();
            let place = self.setup.modulo.map_or(place, within);
            let target = pitch
                .map_or(0, |table| table.pitch_at(place, turn))
                .saturating_add(self.loops.compensation().gap(p.backlash));
            // The position of an axis without power depends on the compensation: a change of one increment could repeat
            // for ever.
            let asked = self.loops.compensation().commanded_compensation();
            if !is_own && target.abs_diff(asked) <= 1 { asked } else { target }
        } else {
            0
        };
        let most = p.usual_velocity(self.parameters.max_velocity) * self.cycle_s();
        self.loops.compensation_mut().step(target, most, is_wanted);
    }

    /// Sets c to 0 at a new reference. `way`: direction of the last approach in that of the axis; with 0 the direction
    /// of the last motion counts. `is_own`: whether the axis moved there by its command.
    pub(in crate::axis) fn compensate_from_zero(&mut self, way: i8, is_own: bool) {
        let way = self.turn_counts(way.into()).signum() as i8;
        self.loops.compensation_mut().begin_from_zero(way, is_own);
    }

    /// Whether compensation is complete. Otherwise the motor is still moving to the compensated position.
    pub(in crate::axis) fn is_compensated(&self) -> bool {
        self.loops.compensation().is_idle() || self.loops.compensation().is_settled()
    }

    /// Returns the motion of the motor in this cycle (inc, in the direction of the axis).
    pub(in crate::axis) fn motor_change(&self) -> Position {
        if self.loops.compensation().is_idle() {
            return self.feedback.change();
        }
        self.feedback.change() + Position::whole(self.turn_counts(self.loops.compensation().change()))
    }

    /// Returns the value added to the command of the drive (inc, in the direction of the axis).
    pub(in crate::axis) fn compensated(&self) -> i64 {
        self.turn_counts(self.loops.compensation().commanded_compensation())
    }
}

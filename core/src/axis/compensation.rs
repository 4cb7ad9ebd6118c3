//! What is between motor and load: pitch error and backlash of a screw, taken up by the motor so that the load is where it is asked to be.
//!
//! Law      counts = place of the load + c; c = pitch error(place) + gap, where the gap is 0 in the sense in which the reference was found, and
//!          the backlash against it in the other one. The place is that of the command while the axis is on, in the coordinate of its own
//!          zero, in the sense of the encoder. c follows that by compensation.velocity at most, in whole increments, from 0 where the axis
//!          knows no zero; while it looks for one, while its brake is closed under power, and while OUTAN holds its position loop open, c stays what it is. The drive is asked for
//!          command + c; off the counts is taken the c that they answer, 1 + delay cycles old, so that taking up is no motion of the axis.
//!          A new zero is one of the motor: c is 0 there
//! Reads    the command, whether the zero is known, the table of pitch errors, compensation.backlash, compensation.velocity
//! Writes   what the drive is asked for beside the command, what is taken off its counts
//! Refuses  nothing: a table that is no pitch error was refused before
//! Source   WF-INC-04, docs/compensation.md

use super::power::Power;
use super::{Axis, MAX_DELAY};
use crate::modulo::Modulo;
use crate::position::Position;
use crate::regulator::PAST;
use crate::table::{PitchError, Table};
use std::sync::Arc;

const _: () = assert!(MAX_DELAY as usize + 1 == PAST, "a ring holds the cycles of the longest delay");

impl Axis {
    /// Takes off the counts, of which this cycle's are about to be read, what they answer of the compensation; returns how far the load
    /// moves beside its counts (inc, in the sense of the encoder).
    pub(super) fn take_compensation(&mut self) -> i64 {
        if self.compensation.is_idle() {
            return 0;
        }
        let by = self.compensation.answer().saturating_neg();
        if by != 0 {
            self.counter.shift(by);
            // The marks of a simulated encoder are those of the command.
            if !self.is_simulated() {
                self.shift_pulses(by);
            }
        }
        by
    }

    /// The load has moved by so much beside its counts (inc, in the sense of the encoder).
    pub(super) fn move_beside_counts(&mut self, by: i64) {
        if by != 0 {
            self.actual.change += Position::whole(self.turn_counts(by));
            self.actual.velocity += self.across(by as f64 / self.cycle_s());
        }
    }

    /// Place of its pitch error among the tables.
    pub fn pitch_error(&self) -> Option<u16> {
        self.setup.pitch_error
    }

    /// Can a table be its pitch error?
    ///
    /// # Errors
    /// What keeps it from being one.
    pub fn check_pitch_error(&self, table: &Table) -> Result<(), PitchError> {
        table.check_pitch(self.setup.modulo.map(Modulo::length))
    }

    /// One cycle of what the drive is asked for beside the command.
    pub(super) fn compensate(&mut self, tables: &[Arc<Table>]) {
        let p = self.parameters.compensation;
        let pitch = self.setup.pitch_error.and_then(|place| tables.get(usize::from(place)));
        let is_wanted = p.backlash != 0 || self.setup.pitch_error.is_some();
        if self.compensation.is_idle() && !is_wanted {
            return;
        }
        let is_own = self.is_on() && !self.homing.is_in_drive();
        let place = self.turn_counts(if is_own { self.asked() } else { self.actual.position.floor() });
        if self.compensation.is_idle() {
            self.compensation.begin_at(place);
        }
        self.compensation.note_place(place, is_own);
        // A motor does not turn against its brake, nor while that opens or closes.
        let is_held = is_own && self.is_braked() || matches!(self.power, Power::Opening { .. } | Power::Closing { .. });
        // Nor does anything lead it while its position loop is open.
        let is_held = is_held || self.out_an().is_some();
        let target = if self.homing.is_running() || is_held {
            self.compensation.asked()
        } else if self.knows_zero() {
            let place = place.saturating_sub(self.turn_counts(self.homing.limit_shift()));
            let turn = self.setup.modulo.map(Modulo::length);
            let within = |modulo: Modulo| modulo.split(Position::whole(place)).1.floor();
            let place = self.setup.modulo.map_or(place, within);
            let target =
                pitch.map_or(0, |table| table.pitch_at(place, turn)).saturating_add(self.compensation.gap(p.backlash));
            // The place of an axis that is off follows from what is taken up: one increment would chase itself.
            let asked = self.compensation.asked();
            if !is_own && target.abs_diff(asked) <= 1 { asked } else { target }
        } else {
            0
        };
        let most = p.usual_velocity(self.parameters.max_velocity) * self.cycle_s();
        self.compensation.step(target, most, is_wanted);
    }

    /// A zero is found: with it c is 0. `way`: the sense of the last approach, in that of the axis; 0 where there was none, so that the
    /// sense of the last motion counts. `is_own`: the axis went there by its command.
    pub(super) fn compensate_from_zero(&mut self, way: i8, is_own: bool) {
        let way = self.turn_counts(way.into()).signum() as i8;
        self.compensation.begin_from_zero(way, is_own);
    }

    /// Is the load where its counts say? Else the motor is on its way there.
    pub(super) fn has_taken_up(&self) -> bool {
        self.compensation.is_idle() || self.compensation.is_settled()
    }

    /// How far the motor has turned in this cycle (inc, in the user's sense).
    pub(super) fn motor_change(&self) -> Position {
        if self.compensation.is_idle() {
            return self.actual.change;
        }
        self.actual.change + Position::whole(self.turn_counts(self.compensation.change()))
    }

    /// What the drive is asked for beside the command, in the user's sense (inc).
    pub(super) fn compensated(&self) -> i64 {
        self.turn_counts(self.compensation.asked())
    }
}

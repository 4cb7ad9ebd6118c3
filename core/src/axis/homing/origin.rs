//! Sets the coordinate of an axis: neither the axis nor its followers move.

use crate::axis::state::{Axis, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::{AxisParameters, ROWS, Row};
use crate::position::{Length, Position};
use crate::vocabulary::Notice;

impl Axis {
    /// Sets the present command position to `position` (DEFORIGIN, SETORIGIN; MACS-CMD-16).
    pub(in crate::axis) fn set_position(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        position: Length,
    ) -> Result<(), Refusal> {
        let by = position.nearest.saturating_sub(self.command.position().nearest());
        self.set_coordinate(cx, sequence, (position.nearest, by))
    }

    /// Increases all positions by `distance` (MC_SetPosition, relative).
    pub(in crate::axis) fn shift_position(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        distance: Length,
    ) -> Result<(), Refusal> {
        let place = self.command.position().nearest().saturating_add(distance.nearest);
        self.set_coordinate(cx, sequence, (place, distance.nearest))
    }

    /// Sets the command position to `place`, an increase by `by`.
    fn set_coordinate(&mut self, cx: &mut Context<'_>, sequence: u64, (place, by): (i64, i64)) -> Result<(), Refusal> {
        self.check_coordinate_free()?;
        self.check_zero_moves()?;
        if !Position::whole(place).is_legal() {
            let asked = Number::Position(place);
            return Err(self.refuse(Code::POSITION_OUT_OF_RANGE).with(asked, Number::None));
        }
        if let Some(limit) = self.limit_out_of_range(by) {
            let asked = Number::Position(place);
            return Err(self.refuse(Code::POSITION_OUT_OF_RANGE).with(asked, Number::Position(limit)));
        }
        let event = Event::new(Severity::Info, Kind::Accepted, self.object(), Code::NONE);
        cx.events.push(event.of_command(sequence));
        self.move_coordinate(by);
        self.shift_limits(cx, by);
        self.leave_vocabulary();
        self.vocabularies.notice(Notice::ZeroSet);
        self.share_shift(sequence, by);
        Ok(())
    }

    /// Returns a limit that would be out of range if it moved by `by` (inc).
    pub fn limit_out_of_range(&self, by: i64) -> Option<i64> {
        let mut parameters = *self.parameters;
        parameters.shift_limits(by);
        let limits = [parameters.min_position, parameters.max_position];
        limits.into_iter().flatten().find(|limit| !Position::whole(*limit).is_legal())
    }

    /// Moves the limits with the coordinate, so that they keep their physical positions (MACS-LIM-01). The distance is
    /// not saved with them.
    pub(in crate::axis) fn shift_limits(&mut self, cx: &mut Context<'_>, by: i64) {
        let before = *self.parameters;
        self.homing.shift_limits(by);
        self.parameters.change(|values| values.shift_limits(by));
        for place in const { [Row::place("min_position"), Row::place("max_position")] } {
            let Some(row) = ROWS.get(usize::from(place)) else { continue };
            let value = row.value(&self.parameters);
            if value != row.value(&before) {
                self.report_own_change(cx, None, place, value);
            }
        }
    }

    /// Restores the given limits: the zero of the machine is found.
    pub(super) fn restore_limits(&mut self, cx: &mut Context<'_>) {
        self.shift_limits(cx, self.homing.limit_shift().saturating_neg());
    }

    /// Returns the active parameters for saving: with limits in the coordinate of the zero of the machine.
    pub fn parameters_to_keep(&self) -> AxisParameters {
        let mut parameters = *self.parameters;
        parameters.shift_limits(self.homing.limit_shift().saturating_neg());
        parameters
    }

    /// Returns the parameters of a layer as they are active in the present coordinate.
    pub fn kept_parameters(&self, layer: AxisParameters) -> AxisParameters {
        let mut parameters = layer;
        let turned = (layer.macs.posdrct < 0) != (self.parameters.macs.posdrct < 0);
        let shift = self.homing.limit_shift();
        parameters.shift_limits(if turned { shift.saturating_neg() } else { shift });
        parameters
    }

    /// Increases all positions by `by` (inc).
    pub(in crate::axis) fn move_coordinate(&mut self, by: i64) {
        let shift = Position::whole(by);
        let counts = self.turn_counts(by);
        self.feedback.shift(shift, counts);
        self.shift_pulses(counts);
        self.loops.compensation_mut().shift(counts);
        self.command.shift(shift);
        self.supervision.shift(by);
        self.motion.shift(shift);
        self.travel.at_limits_mut().shift(shift);
        self.pending.touch_probes_mut().note_new_coordinate();
        self.vocabularies.notice(Notice::Shifted { by });
        self.observed.shift(shift);
    }

    /// Ends the motion of a vocabulary, which was commanded in the old coordinate.
    pub(in crate::axis) fn leave_vocabulary(&mut self) {
        self.status.leave_vocabulary();
    }

    /// Whether the coordinate was moved since the last call of [`take_moved`](Self::take_moved).
    #[inline]
    pub fn has_moved(&self) -> bool {
        self.observed.moved() != Position::ZERO
    }

    /// Returns the distance by which the coordinate was moved since the last call.
    pub fn take_moved(&mut self) -> Position {
        self.observed.take_moved()
    }
}

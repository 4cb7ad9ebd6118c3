//! The coordinate of an axis set anew: nothing moves, and nobody who follows it does.

use super::super::{Axis, Context, Reference};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::{AxisParameters, ROWS, Row};
use crate::position::{Length, Position};
use crate::vocabulary::{Notice, Owner};

impl Axis {
    /// The present command position is `position` from now on (DEFORIGIN, SETORIGIN; MACS-CMD-16).
    pub(in super::super) fn set_position(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        position: Length,
    ) -> Result<(), Refusal> {
        let by = position.nearest.saturating_sub(self.command.position.nearest());
        self.set_coordinate(cx, sequence, (position.nearest, by))
    }

    /// Every position is `distance` more from now on (MC_SetPosition, relative).
    pub(in super::super) fn shift_position(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        distance: Length,
    ) -> Result<(), Refusal> {
        let place = self.command.position.nearest().saturating_add(distance.nearest);
        self.set_coordinate(cx, sequence, (place, distance.nearest))
    }

    /// The command position is `place`, which is `by` more, from now on.
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

    /// A limit that would lie beyond all positions if it moved by so much (inc).
    pub fn limit_out_of_range(&self, by: i64) -> Option<i64> {
        let mut parameters = *self.parameters;
        parameters.shift_limits(by);
        let limits = [parameters.min_position, parameters.max_position];
        limits.into_iter().flatten().find(|limit| !Position::whole(*limit).is_legal())
    }

    /// The limits keep their places in the world (MACS-LIM-01); how far they were moved is not saved with them.
    pub(in super::super) fn shift_limits(&mut self, cx: &mut Context<'_>, by: i64) {
        let before = *self.parameters;
        self.homing.limit_shift = self.homing.limit_shift.saturating_add(by);
        self.parameters.change(|values| values.shift_limits(by));
        for place in const { [Row::place("min_position"), Row::place("max_position")] } {
            let Some(row) = ROWS.get(usize::from(place)) else { continue };
            let value = row.value(&self.parameters);
            if value != row.value(&before) {
                self.tell_own(cx, None, place, value);
            }
        }
    }

    /// The zero of the machine is found: the limits are as they were given.
    pub(super) fn restore_limits(&mut self, cx: &mut Context<'_>) {
        self.shift_limits(cx, self.homing.limit_shift.saturating_neg());
    }

    /// What is saved of the parameters in force: limits in the coordinate of the machine's own zero.
    pub fn parameters_to_keep(&self) -> AxisParameters {
        let mut parameters = *self.parameters;
        parameters.shift_limits(self.homing.limit_shift.saturating_neg());
        parameters
    }

    /// Parameters of a layer as they are in force in the coordinate of now.
    pub fn kept_parameters(&self, layer: AxisParameters) -> AxisParameters {
        let mut parameters = layer;
        let turned = (layer.macs.posdrct < 0) != (self.parameters.macs.posdrct < 0);
        let shift = self.homing.limit_shift;
        parameters.shift_limits(if turned { shift.saturating_neg() } else { shift });
        parameters
    }

    /// Every place is `by` (inc) more from now on.
    pub(in super::super) fn move_coordinate(&mut self, by: i64) {
        let shift = Position::whole(by);
        self.counter.shift(self.turn_counts(by));
        self.shift_pulses(self.turn_counts(by));
        self.compensation.shift(self.turn_counts(by));
        self.origin = self.origin.wrapping_add(self.turn_counts(by));
        self.command.position += shift;
        self.actual.position += shift;
        self.index.1 += shift;
        self.judge.shift(by);
        self.generator.shift(shift);
        self.at_limits.shift(shift);
        self.touch_probes.note_new_coordinate();
        self.vocabularies.notice(Notice::Shifted { by });
        self.moved += shift;
    }

    /// What a vocabulary was up to was meant in a coordinate that is not that of the axis any more.
    pub(in super::super) fn leave_vocabulary(&mut self) {
        if std::mem::take(&mut self.owner) != Owner::Native {
            self.reference = Reference::Stop;
        }
    }

    /// Was the coordinate moved since that was asked last?
    #[inline]
    pub fn has_moved(&self) -> bool {
        self.moved != Position::ZERO
    }

    /// By how much the coordinate was moved since this was asked last.
    pub fn take_moved(&mut self) -> Position {
        std::mem::take(&mut self.moved)
    }
}

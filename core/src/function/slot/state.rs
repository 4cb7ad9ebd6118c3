//! Restored states of a slot, and their copies.

use super::commands::{check_range, check_ranges, found};
use super::programs::module;
use super::{Phase, Slot};
use crate::function::field::{Field, Words};
use crate::function::program::Occasion;
use crate::function::wires::Wires;
use crate::table::Table;
use lineshaft_program::Module;
use std::sync::Arc;

impl Slot {
    /// Returns true if both functions have the same setup, in any state.
    pub(crate) fn is_set_up_as(&self, other: &Self) -> bool {
        self.function.is_set_up_as(&other.function)
    }

    /// Returns true if a restored state is valid.
    pub(crate) fn is_sound(&self, wires: &Wires, (tables, programs): (&[Arc<Table>], &[Arc<Module>])) -> bool {
        let row = wires.kind.description();
        let fits = |values: &[i64]| {
            let in_range = |(place, value): (u16, &i64)| {
                let (is_left_out, place_of) = (|field: &Field| *value == field.default, usize::from(place));
                check_range(row, place, *value).is_ok()
                    || row.field_of(place_of).is_some_and(|(_, field, _)| is_left_out(field))
            };
            values.len() == row.width() && (0_u16..).zip(values).all(in_range)
        };
        let setting = self.setting(wires, found(wires, tables), Occasion::Kept);
        fits(&self.staged)
            && fits(&self.active)
            && (!self.is_active()
                || check_ranges(row, &self.active).is_ok()
                    && self.function.check(Words(&self.active), &setting).is_ok())
            && (self.phase != Phase::Active || self.function.runs_with(Words(&self.active), wires.call_ns))
            && self.goal.is_none_or(|_| row.takes_goals && self.is_active())
            && self.lead.velocity.is_finite()
            && module(wires, programs).is_none_or(|module| self.function.belongs_to(module, self.phase != Phase::Reset))
            && self.function.is_valid_state()
    }
}

impl Clone for Slot {
    fn clone(&self) -> Self {
        Self { function: self.function.clone(), staged: self.staged.clone(), active: self.active.clone(), ..*self }
    }

    /// Does not allocate if both slots belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        // Lists every field, so that the compiler reports a new one.
        let Self {
            function,
            phase,
            since,
            staged,
            active,
            travel,
            last,
            mark,
            inputs,
            outputs,
            writes,
            sink,
            shown,
            error,
            lead,
            anew,
            is_shown,
            notice,
            goal,
            ended,
        } = other;
        self.function.clone_from(function);
        self.staged.clone_from(staged);
        self.active.clone_from(active);
        (self.phase, self.since, self.travel, self.last, self.mark) = (*phase, *since, *travel, *last, *mark);
        (self.inputs, self.outputs, self.writes) = (*inputs, *outputs, *writes);
        (self.sink, self.shown, self.error, self.lead, self.anew) = (*sink, *shown, *error, *lead, *anew);
        (self.is_shown, self.notice, self.goal, self.ended) = (*is_shown, *notice, *goal, *ended);
    }
}

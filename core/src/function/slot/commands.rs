//! Commands to a slot, and checks of parameter sets.

use super::bounds::{check_in_cell, check_set_in_cell};
use super::programs::first_output;
use super::{Order, Phase, Slot};
use crate::code::Code;
use crate::function::description::Description;
use crate::function::field::Words;
use crate::function::program::{Fault, LINES, Occasion, Setting, Tables};
use crate::function::shown::ANSWER;
use crate::function::wires::{Mark, Source, Wires};
use crate::table::Table;
use std::sync::Arc;

impl Slot {
    /// Executes a command, completely or not at all; after an error only the published error changes. `room` holds two
    /// of the widest sets. Returns the answer to READ_VALUE with the number of its field.
    pub(crate) fn command(
        &mut self,
        wires: &Wires,
        (order, values): (Order, &[(u16, i64)]),
        tables: &[Arc<Table>],
        room: &mut [i64],
    ) -> Result<Option<(u16, i64)>, Fault> {
        let result = self.try_command(wires, (order, values), tables, room);
        self.error = result.err().map_or(Code::NONE, |fault| fault.code);
        self.is_shown = false;
        result
    }

    fn try_command(
        &mut self,
        wires: &Wires,
        (order, values): (Order, &[(u16, i64)]),
        tables: &[Arc<Table>],
        room: &mut [i64],
    ) -> Result<Option<(u16, i64)>, Fault> {
        let row = wires.kind.description();
        let mut answer = None;
        match order {
            Order::Start if self.is_active() => return Err(Fault::new(Code::FUNCTION_ACTIVE)),
            Order::ReadValue if row.reads_at_rest && self.is_active() => return Err(Fault::new(Code::FUNCTION_ACTIVE)),
            Order::ValueNew if !row.renews => return Err(Fault::new(Code::FUNCTION_NO_VALUE_NEW)),
            Order::ValueNew if !self.is_active() => return Err(Fault::new(Code::FUNCTION_AT_REST)),
            _ => {}
        }
        let width = self.staged.len();
        // The machine allocates `room` in advance; a slot never allocates.
        let Some((tried, mixed)) = room.get_mut(..2 * width).map(|room| room.split_at_mut(width)) else {
            return Err(Fault::new(Code::BAD_REQUEST));
        };
        tried.copy_from_slice(&self.staged);
        for &(place, value) in values {
            check_range(row, place, value)?;
            check_in_cell(wires, row, (place, value), None)?;
            if let Some(word) = tried.get_mut(usize::from(place)) {
                *word = value;
            }
        }
        let setting = self.setting(wires, found(wires, tables), Occasion::Order);
        match order {
            Order::Start => {
                check_set(wires, tried)?;
                self.function.check(Words(tried), &setting)?;
                self.active.copy_from_slice(tried);
                let is_left = self.phase == Phase::Leaving && wires.program.is_some();
                self.phase = if is_left { Phase::Restarting } else { Phase::Starting };
            }
            Order::ValueNew => {
                // Fields that are not live keep their values of START.
                copy_live_fields(row, mixed, &self.active, tried);
                check_set_in_cell(wires, mixed)?;
                self.function.check(Words(mixed), &setting)?;
                self.active.copy_from_slice(mixed);
                self.function.apply_values(Words(mixed));
            }
            Order::Reset => self.reset(),
            Order::ReadValue if row.reads_at_rest => {
                check_set(wires, tried)?;
                if let Some((place, value)) = self.function.read(Words(tried), &setting)? {
                    self.active.copy_from_slice(tried);
                    if let Some(word) = self.active.get_mut(usize::from(place)) {
                        *word = value;
                    }
                    self.shown[ANSWER] = value;
                    answer = row.field_of(place.into()).map(|(number, ..)| (number, value));
                }
            }
            Order::Stage | Order::ReadValue => {}
        }
        self.staged.copy_from_slice(tried);
        Ok(answer)
    }

    /// Returns an error if START would refuse a set of a function at rest.
    pub(crate) fn check_start(&self, wires: &Wires, tables: &[Arc<Table>], set: &[i64]) -> Result<(), Fault> {
        check_set(wires, set)?;
        self.function.check(Words(set), &self.setting(wires, found(wires, tables), Occasion::Order))
    }

    /// Returns an error if the function cannot continue with an edited table.
    pub(crate) fn check_edit(
        &self,
        wires: &Wires,
        tables: &[Arc<Table>],
        (index, table): (u16, &Table),
    ) -> Result<(), Fault> {
        let (mut found, mut edited) = (found(wires, tables), 0);
        for (number, (place, read)) in found.iter_mut().zip(wires.tables).enumerate() {
            if read == Some(index) {
                *place = Some(table);
                edited |= 1 << number;
            }
        }
        self.function.check(Words(&self.active), &self.setting(wires, found, Occasion::Edit(edited)))
    }

    /// Returns the conditions for the check of a set.
    pub(super) fn setting<'a>(
        &self,
        wires: &Wires,
        tables: [Option<&'a Table>; LINES],
        occasion: Occasion,
    ) -> Setting<'a> {
        let (has_source, has_mark) = (wires.source != Source::None, wires.mark != Mark::None);
        // In the cycle of START the set has not been applied yet.
        let runs = self.phase == Phase::Active;
        let first_output = first_output(wires);
        Setting { call_ns: wires.call_ns, tables, has_source, has_mark, first_output, occasion, runs }
    }
}

/// Returns an error if a value of the set is outside the range of its field.
pub(super) fn check_range(row: &Description, place: u16, value: i64) -> Result<(), Fault> {
    match row.field_of(place.into()) {
        Some((_, field, _)) if (field.min..=field.max).contains(&value) => Ok(()),
        Some((number, _, nth)) => Err(Fault::new(Code::FUNCTION_RANGE).of(number).with(value, nth as i64)),
        None => Err(Fault::new(Code::BAD_REQUEST)),
    }
}

/// Returns an error if a value is outside the range of its field.
pub(super) fn check_ranges(row: &Description, values: &[i64]) -> Result<(), Fault> {
    let mut values = values.iter();
    for (number, field) in (0_u16..).zip(row.fields) {
        for (nth, value) in (0..).zip(values.by_ref().take(field.count)) {
            if !(field.min..=field.max).contains(value) {
                return Err(Fault::new(Code::FUNCTION_RANGE).of(number).with(*value, nth));
            }
        }
    }
    Ok(())
}

/// Returns an error if a value is outside its range or names an object that the cell lacks.
fn check_set(wires: &Wires, values: &[i64]) -> Result<(), Fault> {
    check_ranges(wires.kind.description(), values)?;
    check_set_in_cell(wires, values)
}

/// Copies the live fields of `new` into a set that runs with `active`.
fn copy_live_fields(row: &Description, mixed: &mut [i64], active: &[i64], new: &[i64]) {
    let live = row.fields.iter().flat_map(|field| std::iter::repeat_n(field.live, field.count));
    for (((place, live), active), new) in mixed.iter_mut().zip(live).zip(active).zip(new) {
        *place = if live { *new } else { *active };
    }
}

pub(super) fn found<'a>(wires: &'a Wires, tables: &'a [Arc<Table>]) -> [Option<&'a Table>; LINES] {
    let tables = Tables { all: tables, places: &wires.tables };
    std::array::from_fn(|number| tables.get(number))
}

//! Helpers for tests of function types: a set by the names of its fields, and a call without any change.

use super::field::Field;
use super::program::{
    CallInputs, GoalRequest, LINES, NO_DRIVES, Occasion, Setting, SlotSetup, SourceValue, Tables, WORDS,
};
use super::wires::MemorySize;
use crate::table::Table;
use std::sync::Arc;

/// Time between two calls (ns).
pub(super) const CALL_NS: u64 = 1_000_000;

/// Returns the setup of a function that averages over up to `mean` calls and has room for `cams` cams.
pub(super) fn with_memory(mean: usize, cams: usize) -> SlotSetup<'static> {
    SlotSetup { room: MemorySize { mean, cams }, ..SlotSetup::default() }
}

/// Returns a set of these values; the others have their defaults.
pub(super) fn set(fields: &[Field], values: &[(&str, i64)]) -> Vec<i64> {
    for (name, _) in values {
        assert!(fields.iter().any(|field| field.name == *name), "no field {name}");
    }
    let value =
        |field: &Field| values.iter().find(|(name, _)| *name == field.name).map_or(field.default, |(_, it)| *it);
    fields.iter().flat_map(|field| vec![value(field); field.count]).collect()
}

/// Returns the conditions for the check of a set at START, with a source that has marks.
pub(super) fn setting(call_ns: u64, tables: [Option<&Table>; LINES]) -> Setting<'_> {
    Setting {
        call_ns,
        tables,
        has_source: true,
        has_mark: true,
        first_output: 0,
        occasion: Occasion::Order,
        runs: false,
    }
}

/// No tables.
pub(super) const NO_TABLES: Tables<'static> = Tables { all: &[], places: &[None; LINES] };

/// Returns tables as Tab0 and up.
pub(super) fn as_tables(tables: &[Arc<Table>]) -> Tables<'_> {
    const ALL: &[Option<u16>; LINES] = &[Some(0), Some(1), Some(2), Some(3), Some(4), Some(5), Some(6), Some(7)];
    Tables { all: tables, places: ALL }
}

/// Returns a table as Tab0.
pub(super) fn tab0(table: &Arc<Table>) -> Tables<'_> {
    as_tables(std::slice::from_ref(table))
}

/// Returns a call with source, inputs and sink at 0.
pub(super) fn at_rest<'a>() -> CallInputs<'a> {
    CallInputs {
        call_ns: CALL_NS,
        source: SourceValue::default(),
        inputs: 0,
        asked: GoalRequest::Nothing,
        sink: 0,
        words: [0; WORDS],
        tables: NO_TABLES,
        drives: NO_DRIVES,
        outputs: 0,
        host: None,
    }
}

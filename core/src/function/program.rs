//! Interface between a slot and its function, common to all types.

use super::description::Description;
use super::field::Words;
use super::wires::{MemorySize, OutputCell, Word};
use crate::code::Code;
use crate::event::Number;
use crate::signal::Board;
use crate::table::Table;
use lineshaft_program::Module;
use std::sync::Arc;

/// Number of inputs, outputs, tables and monitored drives of a function.
pub const LINES: usize = 8;

/// Maximum number of words that a function reads in addition to its source.
pub const WORDS: usize = 2;

/// Source of a function in one call.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SourceValue {
    /// Value of the source: 16 and 32 bits are sign-extended.
    pub value: i64,
    /// Unwrapped travel of the source; only differences count. A new coordinate of an axis or encoder does not change
    /// it.
    pub travel: i64,
    /// Position of a mark of this call: in `travel`, or in the position of the sink for a mark of the axis that is the
    /// sink. The last one of several.
    pub mark: Option<i64>,
}

/// Drives of a function that monitors none.
pub const NO_DRIVES: &[Drive; LINES] = &[Drive { error: 0, sak_share: 0, actual: 0 }; LINES];

/// A monitored drive: sidiff reads its errors, fgen its position.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drive {
    /// Position control difference (inc): command less actual position.
    pub error: i64,
    /// Compensation of the following error (inc) by the function whose sink the drive is.
    pub sak_share: i64,
    /// Actual position (inc).
    pub actual: i64,
}

/// The tables of a function; a table is only looked up when it is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tables<'a> {
    /// All tables of the machine.
    pub all: &'a [Arc<Table>],
    /// Indices of Tab0 to Tab7 in `all`.
    pub places: &'a [Option<u16>; LINES],
}

impl<'a> Tables<'a> {
    /// Returns Tab0 to Tab7 by its number; `None` if the slot has no such table.
    #[inline]
    pub(super) fn get(self, number: usize) -> Option<&'a Table> {
        let place = self.places.get(number).copied().flatten()?;
        self.all.get(usize::from(place)).map(|table| &**table)
    }
}

/// Request of a goal to its function in a call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum GoalRequest {
    /// No goal.
    #[default]
    Nothing,
    /// The goal begins: E1 rises.
    Begin,
    /// The goal continues: E1 is 1.
    Hold,
    /// Controlled stop: E2 rises.
    Stop,
}

/// Progress of the order of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// No order, or the order has ended.
    Rests,
    /// The order is running.
    Moves,
    /// The order was stopped before its end.
    Stopped,
}

/// The environment in which a program runs; constant between its calls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Host<'a> {
    pub module: &'a Module,
    /// Maximum instructions per call.
    pub fuel: u32,
    pub board: &'a Board,
    /// Signals that the program reads.
    pub reads: &'a [Word],
    /// Memory cells that the program writes.
    pub writes: &'a [OutputCell],
    /// First output that the program may write, counted from 0.
    pub first_output: u8,
}

/// Inputs of a function in one call.
#[derive(Clone, Copy, Debug)]
pub(super) struct CallInputs<'a> {
    /// Time between two calls (ns), above 0.
    pub call_ns: u64,
    pub source: SourceValue,
    /// E1 in bit 0 to E8 in bit 7, after inversion.
    pub inputs: u8,
    /// Request of a goal, in addition to the inputs.
    pub asked: GoalRequest,
    /// Value of the sink: at START that of its object, later that of the function.
    pub sink: i64,
    /// Values of the words that the cell names (`word_addr`, `mw_offset_addr`..), in the order of the type; 0 without a
    /// word.
    pub words: [i64; WORDS],
    pub tables: Tables<'a>,
    /// The first eight axes.
    pub drives: &'a [Drive; LINES],
    /// A1 in bit 0 to A8 in bit 7, before the call.
    pub outputs: u8,
    /// Environment of a user program.
    pub host: Option<Host<'a>>,
}

/// Outputs of a function in one call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    /// Value of the sink; the slot truncates it to the width of the sink.
    pub sink: i64,
    /// Part of its change that is a new coordinate and no travel; 0 at START.
    pub coordinate_change: i64,
    /// A1 in bit 0 to A8 in bit 7, before inversion.
    pub outputs: u8,
    /// Outputs that the function writes; the others keep their values.
    pub writes: u8,
    /// Compensation of the following error (inc).
    pub sak_share: i64,
    /// Correction of printing mark control (inc), and deviation of the last mark.
    pub correction: i64,
    pub deviation: i64,
    /// Error that ends the function; the other fields are ignored then.
    pub failed: Option<Code>,
}

/// Error of a parameter set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Error code.
    pub code: Code,
    /// Number of the field, from 0; `None` for a table.
    pub field: Option<u16>,
    /// Requested value.
    pub asked: Number,
    /// Allowed value.
    pub limit: Number,
}

impl Fault {
    pub(super) fn new(code: Code) -> Self {
        Self { code, field: None, asked: Number::None, limit: Number::None }
    }

    pub(super) fn of(self, field: u16) -> Self {
        Self { field: Some(field), ..self }
    }

    pub(super) fn with(self, asked: i64, limit: i64) -> Self {
        Self { asked: Number::Count(asked), limit: Number::Count(limit), ..self }
    }
}

/// Conditions against which a parameter set is checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'a> {
    /// Time between two calls (ns), above 0.
    pub call_ns: u64,
    pub tables: [Option<&'a Table>; LINES],
    /// Whether the slot has a source.
    pub has_source: bool,
    /// Whether the source has marks.
    pub has_mark: bool,
    /// First output that is wired, from 0; 0 without one.
    pub first_output: u8,
    pub occasion: Occasion,
    /// Whether the function runs: selections since START are used instead of those of the set.
    pub runs: bool,
}

/// Reason for the check of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Occasion {
    /// A command sets it.
    Order,
    /// Tables are about to change: Tab0 in bit 0 to Tab7 in bit 7.
    Edit(u8),
    /// It is active, with a restored state.
    Kept,
}

/// Connections of a slot that decide how its function is created.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SlotSetup<'a> {
    /// Whether each word that it reads in addition to its source is connected.
    pub has_words: [bool; WORDS],
    /// Maximum memory.
    pub room: MemorySize,
    /// User program.
    pub module: Option<&'a Module>,
}

impl SlotSetup<'_> {
    /// Returns a setup with these words, and without memory or a program.
    pub(super) fn of_words(has_words: [bool; WORDS]) -> Self {
        Self { has_words, ..Self::default() }
    }
}

/// A slot type; the implementing struct is the state of a function. Only [`new`](Self::new) allocates: a struct with
/// heap memory needs a `clone_from` that does not.
pub(super) trait SlotType: Clone {
    /// Name, connections and fields.
    const DESCRIPTION: Description;

    /// Creates a function at rest, with all memory that it will need.
    fn new(setup: &SlotSetup<'_>) -> Self;

    /// Returns true if both functions were created with the same setup, as far as `new` depends on it.
    fn is_set_up_as(&self, _other: &Self) -> bool {
        true
    }

    /// Checks the fields against each other, and the tables; ranges were checked before.
    fn check(&self, _words: Words<'_>, _setting: &Setting<'_>) -> Result<(), Fault> {
        Ok(())
    }

    /// Executes the first call, with a checked set.
    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome;

    /// Applies the live fields of a checked set (VALUE_NEW). Only called for types with live fields.
    fn apply_values(&mut self, _words: Words<'_>) {}

    /// Executes each further call.
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome;

    /// Returns the answer to READ_VALUE at rest, and the index of its value in the set.
    fn read(&self, _words: Words<'_>, _setting: &Setting<'_>) -> Result<Option<(u16, i64)>, Fault> {
        Ok(None)
    }

    /// Executes the call of RESET, if the type has one; its outputs are kept.
    fn leave(&mut self, _seen: &CallInputs<'_>) -> Option<Outcome> {
        None
    }

    /// Returns the outputs after RESET; `rests` are those of its type.
    fn rests(&self, rests: u8) -> u8 {
        rests
    }

    /// Returns the progress of the order; only called for types with goals.
    fn progress(&self) -> Progress {
        Progress::Rests
    }

    /// Drops the distance to go of its order and stops.
    fn drop_order(&mut self) {}

    /// Returns true if the function runs with that set. Only called if it is started.
    fn runs_with(&self, _words: Words<'_>, _call_ns: u64) -> bool {
        true
    }

    /// Returns the values of `shows` that it stores; none if they are in the outcome of each call.
    fn shown(&self) -> &[i64] {
        &[]
    }

    /// Returns true if a restored state is valid.
    fn is_valid_state(&self) -> bool {
        true
    }

    /// Returns the modes in ascending order; none if the range of its field defines them.
    fn modes() -> Vec<i64> {
        Vec::new()
    }

    /// Returns true if a function with that set copies its source to its sink.
    fn copies_source(_words: Words<'_>) -> bool {
        false
    }

    /// Returns true if a function with that set copies values to its sink that any step may separate. `is_signal`: its
    /// source is a signal and no position.
    fn copies_values(_words: Words<'_>, _is_signal: bool) -> bool {
        false
    }

    /// Returns the axes that a function with that set monitors without a source, the first one in bit 0.
    fn monitored_axes(_words: Words<'_>) -> u8 {
        0
    }

    /// Returns the reserved pages of memory for a user program.
    fn room(&self) -> usize {
        0
    }

    /// Returns the value that the last call of a user program left for a memory cell.
    fn word(&mut self, _module: &Module, _place: usize) -> u64 {
        0
    }

    /// Replaces the user program, the second module. Returns false if it cannot keep the state, or lacks memory for the
    /// new one.
    fn exchange(&mut self, _modules: (&Module, &Module), _keeps: bool) -> bool {
        true
    }

    /// Returns true if calls of that user program can lead to this state. `runs`: the function is started.
    fn belongs_to(&self, _module: &Module, _runs: bool) -> bool {
        true
    }
}

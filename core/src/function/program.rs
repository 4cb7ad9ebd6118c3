//! What a type of function is to its slot: the interface that all of them share.

use super::apsf::Host;
use super::field::Words;
use crate::code::Code;
use crate::event::Number;
use crate::table::Table;
use std::sync::Arc;

/// Inputs, outputs, tables and monitored drives of one function.
pub const LINES: usize = 8;

/// Words that a function reads beside its source, at most.
pub const WORDS: usize = 2;

/// What a function reads of its source in one call.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reading {
    /// As wide as the source: 16 and 32 bits are sign-extended.
    pub value: i64,
    /// Its way since anything, unwrapped: differences count. A new coordinate of an axis or encoder is no way.
    pub travel: i64,
    /// Where a mark of this call was, as `travel`, one of the axis that is the sink as that; of several the last one.
    pub mark: Option<i64>,
}

/// Where no drive is watched.
pub const NO_DRIVES: &[Drive; LINES] = &[Drive { error: 0, sak_share: 0, actual: 0 }; LINES];

/// What is told of a monitored drive: to sidiff what it is behind by, to fgen where it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drive {
    /// Position control difference (inc): command less actual position.
    pub error: i64,
    /// What the function whose sink it is adds for the following error (inc).
    pub sak_share: i64,
    /// Actual position (inc).
    pub actual: i64,
}

/// The tables that a function reads; those that it does not read are not looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tables<'a> {
    /// All of the machine.
    pub all: &'a [Arc<Table>],
    /// Which of them are Tab0 to Tab7.
    pub places: &'a [Option<u16>; LINES],
}

impl<'a> Tables<'a> {
    /// Tab0 to Tab7 by its number; none where the slot has none there.
    #[inline]
    pub(super) fn get(self, number: usize) -> Option<&'a Table> {
        let place = self.places.get(number).copied().flatten()?;
        self.all.get(usize::from(place)).map(|table| &**table)
    }
}

/// What a goal asks of its function in a call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Asked {
    /// There is none.
    #[default]
    Nothing,
    /// It begins: E1 rises.
    Begin,
    /// It goes on: E1 stands.
    Hold,
    /// A controlled stop: E2 rises.
    Stop,
}

/// How the order of a function stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// There is none, or it has come to its end.
    Rests,
    /// It is under way.
    Moves,
    /// It was stopped with something left.
    Stopped,
}

/// What a function sees in one call.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    /// Time between two calls (ns), above 0.
    pub call_ns: u64,
    pub source: Reading,
    /// E1 in bit 0 to E8 in bit 7, after inversion.
    pub inputs: u8,
    /// Beside its inputs.
    pub asked: Asked,
    /// What the sink holds: at START what its object has, then what the function gave it.
    pub sink: i64,
    /// What the words hold that the cell names (`word_addr`, `mw_offset_addr`..), in the order of their type; 0 without one.
    pub words: [i64; WORDS],
    pub tables: Tables<'a>,
    /// The first eight axes.
    pub drives: &'a [Drive; LINES],
    /// A1 in bit 0 to A8 in bit 7, as they are before.
    pub outputs: u8,
    /// What a program of the user runs with.
    pub host: Option<Host<'a>>,
}

/// What a function gives in one call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    /// What the sink gets; the slot cuts it to the width of the sink.
    pub sink: i64,
    /// How much of its change is a new coordinate and no way; never at START.
    pub anew: i64,
    /// A1 in bit 0 to A8 in bit 7, before inversion.
    pub outputs: u8,
    /// Which of them it writes; the others keep what they have.
    pub writes: u8,
    /// What compensation of the following error adds (inc).
    pub sak_share: i64,
    /// What printing mark control adds (inc), and how far the last mark was off.
    pub correction: i64,
    pub deviation: i64,
    /// Why it cannot go on; nothing else of it counts then.
    pub failed: Option<Code>,
}

/// Why a set does not make a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// The code.
    pub code: Code,
    /// Which field, from 0; none where it is a table.
    pub field: Option<u16>,
    /// What was asked.
    pub asked: Number,
    /// What is allowed.
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

/// What a set is checked against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'a> {
    /// Time between two calls (ns), above 0.
    pub call_ns: u64,
    pub tables: [Option<&'a Table>; LINES],
    /// The slot has a source.
    pub has_source: bool,
    /// Its source has marks.
    pub has_mark: bool,
    /// The first output that is wired, from 0; 0 without one.
    pub first_output: u8,
    pub occasion: Occasion,
    /// The function runs: what it has chosen since START counts, where that is its own to choose.
    pub runs: bool,
}

/// Why a set is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Occasion {
    /// An order brings it.
    Order,
    /// Tables are about to get other numbers: Tab0 in bit 0 to Tab7 in bit 7.
    Edit(u8),
    /// It is in force, with a state that was read from outside.
    Kept,
}

/// A type of function. Nothing in it takes memory after it was made.
pub(super) trait Program {
    /// What the ranges of the fields do not say: fields against each other, and tables.
    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault>;

    /// The first call, with a set that was checked.
    fn start(&mut self, words: Words<'_>, seen: &Seen<'_>) -> Outcome;

    /// Takes the live fields of a set that was checked (VALUE_NEW). Types without live fields are never asked.
    fn renew(&mut self, _words: Words<'_>) {}

    /// Each further call.
    fn step(&mut self, seen: &Seen<'_>) -> Outcome;

    /// A value that READ_VALUE finds for a set while the function rests, and its place in the set.
    fn read(&self, _words: Words<'_>, _setting: &Setting<'_>) -> Result<Option<(u16, i64)>, Fault> {
        Ok(None)
    }

    /// The call of RESET, where its type has one: what that gives stays.
    fn leave(&mut self, _seen: &Seen<'_>) -> Option<Outcome> {
        None
    }

    /// Its outputs after RESET; `rests` are those of its type.
    fn rests(&self, rests: u8) -> u8 {
        rests
    }

    /// How its order stands; asked of types that take goals.
    fn progress(&self) -> Progress {
        Progress::Rests
    }

    /// Drops what is left of its order, and stands.
    fn drop_order(&mut self) {}

    /// Does it run by that set? Asked of one that is started.
    fn is_set(&self, _words: Words<'_>, _call_ns: u64) -> bool {
        true
    }

    /// Could its state have come about? One that was read from outside may hold anything.
    fn is_sound(&self) -> bool {
        true
    }
}

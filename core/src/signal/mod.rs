//! The signal board: every value that can be traced, read by name once and by handle from then on.
//!
//! Each signal is one 64-bit word; its type says how to read it. A room writes its signals when it has done its part of
//! a cycle, so a reader sees this cycle's value of what stands earlier in the order and last cycle's of what stands
//! later (contract section 1). A copy of the board is a snapshot of the machine.

pub mod axis;
mod block;
pub mod gantry;
pub mod sysvar;

pub(crate) use block::signal_block;

use serde::{Deserialize, Serialize};

/// How a signal's word is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// i64
    Int,
    /// f64
    Real,
    /// 0 or 1
    Bit,
    /// A number with names: the number is the place in the list.
    Enum(&'static [&'static str]),
    /// Unsigned bits.
    Word,
}

/// What a signal measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// No unit.
    None,
    /// (inc)
    Position,
    /// (inc/s)
    Velocity,
    /// (inc/s^2)
    Acceleration,
    /// (inc/s^3)
    Jerk,
    /// (V)
    Voltage,
}

impl Measure {
    /// The unit as text; empty without one.
    pub fn unit(self) -> &'static str {
        match self {
            Measure::None => "",
            Measure::Position => "inc",
            Measure::Velocity => "inc/s",
            Measure::Acceleration => "inc/s^2",
            Measure::Jerk => "inc/s^3",
            Measure::Voltage => "V",
        }
    }
}

/// The value of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Integers, bits, enums, words.
    Int(i64),
    /// Reals.
    Real(f64),
}

impl Value {
    /// As f64, rounded where an integer is too large.
    pub fn to_f64(self) -> f64 {
        match self {
            Value::Int(value) => value as f64,
            Value::Real(value) => value,
        }
    }
}

/// A signal's place on the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Signal(u32);

impl Signal {
    /// Place on the board, from 0 without gaps.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The signal `offset` places further, within the block of an object.
    pub(crate) fn plus(self, offset: usize) -> Self {
        Self(self.0 + offset as u32)
    }
}

/// What is known of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Full name, as `x.command.position`.
    pub name: String,
    /// How its word is read.
    pub kind: Type,
    /// What it measures.
    pub measure: Measure,
    /// May a scenario replace it?
    pub drivable: bool,
    /// What it is, in a few words.
    pub help: &'static str,
}

/// Names, types and places of all signals.
#[derive(Clone, Debug, Default)]
pub struct Directory {
    entries: Vec<Entry>,
}

impl Directory {
    /// Adds a signal.
    pub(crate) fn add(&mut self, entry: Entry) -> Signal {
        self.entries.push(entry);
        Signal((self.entries.len() - 1) as u32)
    }

    /// The signal that will be added next.
    pub(crate) fn next(&self) -> Signal {
        Signal(self.entries.len() as u32)
    }

    /// The signal of that name.
    pub fn find(&self, name: &str) -> Option<Signal> {
        self.entries.iter().position(|entry| entry.name == name).map(|index| Signal(index as u32))
    }

    /// What is known of a signal.
    ///
    /// # Panics
    /// With a signal of another directory.
    pub fn entry(&self, signal: Signal) -> &Entry {
        &self.entries[signal.index()]
    }

    /// All signals in the order of the board.
    pub fn iter(&self) -> impl Iterator<Item = (Signal, &Entry)> {
        self.entries.iter().enumerate().map(|(index, entry)| (Signal(index as u32), entry))
    }

    /// How many signals.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True without any signal.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

/// The values of all signals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Board {
    words: Vec<u64>,
}

impl Board {
    /// A board of zeros for a directory.
    pub fn new(directory: &Directory) -> Self {
        Self { words: vec![0; directory.len()] }
    }

    /// Copies another board of the same directory, without taking memory.
    pub fn copy_from(&mut self, other: &Board) {
        self.words.clone_from(&other.words);
    }

    /// The words of all signals, in the order of the directory.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// Takes the words of all signals, in the order of the directory; those of another board are not taken.
    pub fn copy_words(&mut self, words: &[u64]) {
        if words.len() == self.words.len() {
            self.words.copy_from_slice(words);
        }
    }

    /// How many signals.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// True without any signal.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// The word of a signal as it stands; 0 for one of another board.
    pub fn word(&self, signal: Signal) -> u64 {
        self.words.get(signal.index()).copied().unwrap_or(0)
    }

    /// An integer, bit, enum or word.
    pub fn int(&self, signal: Signal) -> i64 {
        self.word(signal).cast_signed()
    }

    /// A real.
    pub fn real(&self, signal: Signal) -> f64 {
        f64::from_bits(self.word(signal))
    }

    /// A bit.
    pub fn bit(&self, signal: Signal) -> bool {
        self.word(signal) != 0
    }

    /// The value by the signal's type.
    pub fn value(&self, signal: Signal, kind: Type) -> Value {
        match kind {
            Type::Real => Value::Real(self.real(signal)),
            _ => Value::Int(self.int(signal)),
        }
    }

    /// Sets an integer, bit, enum or word; one of another board stays.
    pub fn set_int(&mut self, signal: Signal, value: i64) {
        self.set(signal, value.cast_unsigned());
    }

    /// Sets a real; one of another board stays.
    pub fn set_real(&mut self, signal: Signal, value: f64) {
        self.set(signal, value.to_bits());
    }

    fn set(&mut self, signal: Signal, word: u64) {
        if let Some(place) = self.words.get_mut(signal.index()) {
            *place = word;
        }
    }

    /// The words of one object's block, to be written in one go.
    pub(crate) fn block(&mut self, first: Signal, length: usize) -> &mut [u64] {
        let end = (first.index() + length).min(self.words.len());
        &mut self.words[first.index().min(end)..end]
    }
}

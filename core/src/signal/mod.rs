//! Signal board: all values that can be traced, with access by name once and by handle afterwards.
//!
//! Each signal is one 64-bit word; its type defines the encoding. A module writes its signals at the end of its part of
//! a cycle, so a reader gets values of this cycle from modules earlier in the order and values of the last cycle from
//! later ones (contract section 1). A copy of the board is a snapshot of the machine.

pub mod axis;
mod block;
pub mod gantry;
pub mod sysvar;

pub(crate) use block::signal_block;

use serde::{Deserialize, Serialize};

/// Encoding of the word of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// Signed integer (i64).
    Int,
    /// Real (f64).
    Real,
    /// Bit, 0 or 1.
    Bit,
    /// A number with names: the number is the index in the list.
    Enum(&'static [&'static str]),
    /// Unsigned bits.
    Word,
}

/// Quantity that a signal measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// No unit.
    None,
    /// Position (inc).
    Position,
    /// Velocity (inc/s).
    Velocity,
    /// Acceleration (inc/s^2).
    Acceleration,
    /// Jerk (inc/s^3).
    Jerk,
    /// Voltage (V).
    Voltage,
}

impl Measure {
    /// Returns the unit as text; empty without one.
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
    /// Returns the value as f64, rounded if an integer is too large.
    pub fn to_f64(self) -> f64 {
        match self {
            Value::Int(value) => value as f64,
            Value::Real(value) => value,
        }
    }
}

/// Index of a signal on the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Signal(u32);

impl Signal {
    /// Returns the index on the board, from 0 without gaps.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns the signal `offset` places later, within the block of an object.
    pub(crate) fn plus(self, offset: usize) -> Self {
        Self(self.0 + offset as u32)
    }
}

/// Description of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Full name, such as `x.command.position`.
    pub name: String,
    /// Encoding of its word.
    pub kind: Type,
    /// Quantity that it measures.
    pub measure: Measure,
    /// Whether a scenario may override it.
    pub drivable: bool,
    /// Short description.
    pub help: &'static str,
}

/// Names, types and indices of all signals.
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

    /// Returns the signal that will be added next.
    pub(crate) fn next(&self) -> Signal {
        Signal(self.entries.len() as u32)
    }

    /// Returns the signal of that name.
    pub fn find(&self, name: &str) -> Option<Signal> {
        self.entries.iter().position(|entry| entry.name == name).map(|index| Signal(index as u32))
    }

    /// Returns the description of a signal.
    ///
    /// # Panics
    /// With a signal of another directory.
    pub fn entry(&self, signal: Signal) -> &Entry {
        &self.entries[signal.index()]
    }

    /// Returns all signals in the order of the board.
    pub fn iter(&self) -> impl Iterator<Item = (Signal, &Entry)> {
        self.entries.iter().enumerate().map(|(index, entry)| (Signal(index as u32), entry))
    }

    /// Returns the number of signals.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns true without any signal.
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
    /// Creates a board of zeros for a directory.
    pub fn new(directory: &Directory) -> Self {
        Self { words: vec![0; directory.len()] }
    }

    /// Copies another board of the same directory, without allocation.
    pub fn copy_from(&mut self, other: &Board) {
        self.words.clone_from(&other.words);
    }

    /// Returns the words of all signals, in the order of the directory.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// Sets the words of all signals, in the order of the directory; has no effect for words of another directory.
    pub fn copy_words(&mut self, words: &[u64]) {
        if words.len() == self.words.len() {
            self.words.copy_from_slice(words);
        }
    }

    /// Returns the number of signals.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Returns true without any signal.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Returns the raw word of a signal; 0 for a signal of another board.
    pub fn word(&self, signal: Signal) -> u64 {
        self.words.get(signal.index()).copied().unwrap_or(0)
    }

    /// Returns an integer, bit, enum or word.
    pub fn int(&self, signal: Signal) -> i64 {
        self.word(signal).cast_signed()
    }

    /// Returns a real.
    pub fn real(&self, signal: Signal) -> f64 {
        f64::from_bits(self.word(signal))
    }

    /// Returns a bit.
    pub fn bit(&self, signal: Signal) -> bool {
        self.word(signal) != 0
    }

    /// Returns the value by the type of the signal.
    pub fn value(&self, signal: Signal, kind: Type) -> Value {
        match kind {
            Type::Real => Value::Real(self.real(signal)),
            _ => Value::Int(self.int(signal)),
        }
    }

    /// Sets an integer, bit, enum or word; has no effect for a signal of another board.
    pub fn set_int(&mut self, signal: Signal, value: i64) {
        self.set(signal, value.cast_unsigned());
    }

    /// Sets a real; has no effect for a signal of another board.
    pub fn set_real(&mut self, signal: Signal, value: f64) {
        self.set(signal, value.to_bits());
    }

    fn set(&mut self, signal: Signal, word: u64) {
        if let Some(place) = self.words.get_mut(signal.index()) {
            *place = word;
        }
    }

    /// Returns the words of the block of an object, for writing all at once.
    pub(crate) fn block(&mut self, first: Signal, length: usize) -> &mut [u64] {
        let end = (first.index() + length).min(self.words.len());
        &mut self.words[first.index().min(end)..end]
    }
}

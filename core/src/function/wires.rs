//! What a slot is wired to: handles that stay the same as long as the cell does.

use super::kind::{Kind, Quantity};
use super::program::{LINES, WORDS};
use crate::object::Leader;
use crate::signal::{Signal, Type};
use serde::{Deserialize, Serialize};

/// How wide a source or a sink is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Width {
    /// 16 bits.
    W16,
    /// 32 bits.
    W32,
    /// 64 bits, which never wraps here.
    #[default]
    W64,
}

impl Width {
    /// By so many bits; none for another number.
    pub fn of(bits: u32) -> Option<Self> {
        match bits {
            16 => Some(Self::W16),
            32 => Some(Self::W32),
            64 => Some(Self::W64),
            _ => None,
        }
    }

    /// How many bits.
    pub fn bits(self) -> u32 {
        match self {
            Self::W16 => 16,
            Self::W32 => 32,
            Self::W64 => 64,
        }
    }

    /// The low bits of a value, sign-extended (AMK, A-07).
    #[inline]
    pub fn cut(self, value: i64) -> i64 {
        // Casts keep the low bits: that is the rule.
        match self {
            Self::W16 => i64::from(value as i16),
            Self::W32 => i64::from(value as i32),
            Self::W64 => value,
        }
    }
}

/// A source.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Source {
    /// Nothing: it reads 0.
    #[default]
    None,
    /// A position of an axis or encoder, or a sink, and its signal: a new coordinate is no way.
    Lead(Leader, Word),
    /// Any other signal.
    Signal(Word),
}

/// A signal as a whole number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Word {
    /// As it is.
    Int(Signal),
    /// Cut towards zero.
    Real(Signal),
    /// In mV, to the nearest.
    Volts(Signal),
}

impl Word {
    /// How a signal of that type is read.
    pub(crate) fn of(signal: Signal, kind: Type, is_voltage: bool) -> Self {
        match kind {
            Type::Real if is_voltage => Self::Volts(signal),
            Type::Real => Self::Real(signal),
            _ => Self::Int(signal),
        }
    }
}

/// A sink.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sink {
    /// Only other functions and followers read it.
    #[default]
    None,
    /// An axis, by its place, and the signal of its command position.
    Axis(u16, Signal),
    /// A memory cell of whole numbers and its width.
    Memory(Signal, Width),
    /// A memory cell of reals.
    Real(Signal),
    /// An analog output, by its place among them, and its signal; the value is in mV.
    Analog(usize, Signal),
}

/// A memory cell that a program writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// A bit: whatever is not 0 sets it.
    Bit(Signal),
    /// A whole number.
    Int(Signal, Width),
    /// A real.
    Real(Signal),
}

/// A binary input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// The bit.
    pub signal: Signal,
    /// It counts when it is 0.
    pub inverted: bool,
}

/// A binary output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Where it goes.
    pub to: Bit,
    /// It is 0 while it counts.
    pub inverted: bool,
}

/// What holds a bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bit {
    /// A digital output, by its place among them.
    Digital(usize),
    /// A memory cell.
    Memory(Signal),
}

/// What latches the marks that a function measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mark {
    /// Nothing.
    #[default]
    None,
    /// A rising edge of E1, at the instant of the cycle.
    Edge,
    /// Latches of an entry of `io`, rising.
    Latch(u16),
    /// Latches and index pulses of an encoder.
    Encoder(u16),
    /// Index pulses of the axis that is the sink.
    Axis(u16),
}

/// What happens to a function when the axis that it moves has an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnAxisError {
    /// Nothing (AMK-GEN-11).
    #[default]
    Run,
    /// RESET.
    Reset,
}

/// How much a function may ever need, as its memory is taken once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Room {
    /// Values of its mean.
    pub mean: usize,
    /// Cams of all tracks.
    pub cams: usize,
}

/// What a slot is wired to.
#[derive(Clone, Debug, PartialEq)]
pub struct Wires {
    /// Its type.
    pub kind: Kind,
    /// First of its signals.
    pub first: Signal,
    /// What it reads.
    pub source: Source,
    /// How wide that is.
    pub source_width: Width,
    /// What it writes.
    pub sink: Sink,
    /// How wide that is.
    pub sink_width: Width,
    /// (inc/s) of one of a sink that carries the speed of an axis.
    pub speed: Option<f64>,
    /// Range of a sink that is an analog output, to either side (mV); 0 of any other.
    pub full_scale: i64,
    /// How many axes the cell has.
    pub axes: usize,
    /// E1 to E8.
    pub inputs: [Option<Input>; LINES],
    /// A1 to A8.
    pub outputs: [Option<Output>; LINES],
    /// How many of both are looked at.
    pub lines: (usize, usize),
    /// Places of its tables.
    pub tables: [Option<u16>; LINES],
    /// So many values it publishes beside its lines.
    pub shows: usize,
    /// The words that it reads beside its source.
    pub words: [Option<Word>; WORDS],
    /// Its program, its place among them; type apsf has one.
    pub program: Option<u16>,
    /// Instructions of a call of it, at most.
    pub fuel: u32,
    /// Signals that it reads.
    pub reads: Box<[Word]>,
    /// Memory cells that it writes.
    pub writes: Box<[Cell]>,
    /// What its sink carries.
    pub quantity: Quantity,
    /// What latches its marks.
    pub mark: Mark,
    /// It is called in each n-th cycle.
    pub factor: u32,
    /// Time between two calls (ns).
    pub call_ns: u64,
    /// What an error of its axis does.
    pub on_axis_error: OnAxisError,
}

//! Connections of a slot: handles that are fixed by the cell.

use super::description::{Monitored, Quantity};
use super::program::{LINES, WORDS};
use super::types::Kind;
use crate::object::Leader;
use crate::signal::{Signal, Type};
use serde::{Deserialize, Serialize};

/// Width of a source or a sink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Width {
    /// 16 bits.
    W16,
    /// 32 bits.
    W32,
    /// 64 bits; positions never wrap in this width.
    #[default]
    W64,
}

impl Width {
    /// Returns the width of that number of bits; `None` for other numbers.
    pub fn of(bits: u32) -> Option<Self> {
        match bits {
            16 => Some(Self::W16),
            32 => Some(Self::W32),
            64 => Some(Self::W64),
            _ => None,
        }
    }

    /// Returns the number of bits.
    pub fn bits(self) -> u32 {
        match self {
            Self::W16 => 16,
            Self::W32 => 32,
            Self::W64 => 64,
        }
    }

    /// Returns the low bits of a value, sign-extended (AMK, A-07).
    #[inline]
    pub fn cut(self, value: i64) -> i64 {
        // The casts keep the low bits, as the rule requires.
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
    /// No source: reads 0.
    #[default]
    None,
    /// A position of an axis or encoder, or a sink, and its signal: a new coordinate does not count as travel.
    Lead(Leader, Word),
    /// Any other signal.
    Signal(Word),
}

/// Conversion of a signal to a whole number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Word {
    /// A whole number, unchanged.
    Int(Signal),
    /// A real, truncated towards zero.
    Real(Signal),
    /// A voltage in mV, rounded to the nearest.
    Volts(Signal),
}

impl Word {
    /// Returns the conversion of a signal of that type.
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
    /// No object: only other functions and followers read it.
    #[default]
    None,
    /// An axis, by its index, and the signal of its command position.
    Axis(u16, Signal),
    /// A memory cell of whole numbers, and its width.
    Memory(Signal, Width),
    /// A memory cell of reals.
    Real(Signal),
    /// An analog output, by its index, and its signal; the value is in mV.
    Analog(usize, Signal),
}

/// A memory cell that a program writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutputCell {
    /// A bit: any value except 0 sets it.
    Bit(Signal),
    /// A whole number.
    Int(Signal, Width),
    /// A real.
    Real(Signal),
}

/// A binary input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Signal of the bit.
    pub signal: Signal,
    /// Whether the input is active at 0.
    pub inverted: bool,
}

/// A binary output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Destination of the bit.
    pub to: Bit,
    /// Whether the output is 0 while it is active.
    pub inverted: bool,
}

/// Destination of an output bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bit {
    /// A digital output, by its index.
    Digital(usize),
    /// A memory cell.
    Memory(Signal),
}

/// Source of the marks that a function measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mark {
    /// None.
    #[default]
    None,
    /// A rising edge of E1, at the instant of the cycle.
    Edge,
    /// Rising latches of an entry of `io`.
    Latch(u16),
    /// Latches and index pulses of an encoder.
    Encoder(u16),
    /// Index pulses of the axis that is the sink.
    Axis(u16),
}

/// Reaction of a function to an error of the axis that it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnAxisError {
    /// No reaction (AMK-GEN-11).
    #[default]
    Run,
    /// RESET.
    Reset,
}

/// Maximum memory that a function may need; it is allocated once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemorySize {
    /// Maximum values of its mean.
    pub mean: usize,
    /// Maximum cams of all tracks.
    pub cams: usize,
}

/// Connections of a slot.
#[derive(Clone, Debug, PartialEq)]
pub struct Wires {
    /// Function type.
    pub kind: Kind,
    /// First signal of the slot.
    pub first: Signal,
    /// The source.
    pub source: Source,
    /// Width of the source.
    pub source_width: Width,
    /// The sink.
    pub sink: Sink,
    /// Width of the sink.
    pub sink_width: Width,
    /// Velocity (inc/s) of 1 of the sink, if the sink is the speed of an axis.
    pub speed: Option<f64>,
    /// Range of an analog output as sink, in both directions (mV); 0 for other sinks.
    pub full_scale: i64,
    /// Number of axes of the cell.
    pub axes: usize,
    /// E1 to E8.
    pub inputs: [Option<Input>; LINES],
    /// A1 to A8.
    pub outputs: [Option<Output>; LINES],
    /// Number of inputs and outputs to process.
    pub lines: (usize, usize),
    /// Indices of its tables.
    pub tables: [Option<u16>; LINES],
    /// Number of values that it publishes in addition to its inputs and outputs.
    pub shows: usize,
    /// The words that it reads in addition to its source.
    pub words: [Option<Word>; WORDS],
    /// Index of its program; only for type apsf.
    pub program: Option<u16>,
    /// Maximum instructions per call of the program.
    pub fuel: u32,
    /// Signals that the program reads.
    pub reads: Box<[Word]>,
    /// Memory cells that the program writes.
    pub writes: Box<[OutputCell]>,
    /// Quantity of the sink.
    pub quantity: Quantity,
    /// Source of its marks.
    pub mark: Mark,
    /// Values of axes that it reads without a source.
    pub monitors: Monitored,
    /// Cycles between two calls.
    pub factor: u32,
    /// Time between two calls (ns).
    pub call_ns: u64,
    /// Reaction to an error of its axis.
    pub on_axis_error: OnAxisError,
}

//! What a slot reads of the board and the leads in its call.
//!
//! Law      a voltage is read in mV, to the nearest; any other real is cut towards zero; 16 and 32 bits are the low ones, sign-extended

use super::wires::{Cell, Source, Wires, Word};
use crate::encoder::Lead;
use crate::object::Leader;
use crate::position::Position;
use crate::signal::Board;
use crate::sync::Leads;

/// E1 in bit 0 to E8 in bit 7, after inversion.
pub(super) fn read_inputs(wires: &Wires, board: &Board) -> u8 {
    let mut bits = 0;
    for (place, input) in wires.inputs.iter().take(wires.lines.0).enumerate() {
        if let Some(input) = input {
            bits |= u8::from(board.bit(input.signal) != input.inverted) << place;
        }
    }
    bits
}

/// What a slot reads of its source.
#[derive(Clone, Copy)]
pub(super) struct Read<'a> {
    /// As wide as the source; 0 without one.
    pub value: i64,
    /// None where it is no position of anything; lost where there is no such thing.
    pub lead: Option<&'a Lead>,
}

impl<'a> Read<'a> {
    /// Reads it; `room` is for what has to be added up.
    #[inline]
    pub(super) fn new(wires: &Wires, board: &Board, leads: &'a Leads, room: &'a mut Option<Lead>) -> Self {
        let (value, lead) = match wires.source {
            Source::None => return Self { value: 0, lead: None },
            Source::Signal(word) => (word.read(board), None),
            Source::Lead(leader, word) => match leads.simple(leader) {
                Some(lead) => {
                    // The board shows it behind the axes.
                    let is_actual = matches!(leader, Leader::AxisActual(_));
                    (if is_actual { lead.position.floor() } else { word.read(board) }, Some(lead))
                }
                None => added(leads, leader, room),
            },
        };
        Self { value: wires.source_width.cut(value), lead }
    }

    /// Is it there?
    #[inline]
    pub(super) fn is_valid(self) -> bool {
        self.lead.is_none_or(|lead| lead.valid)
    }

    /// What the floor of it leaves: the way is that of whole increments.
    pub(super) fn fraction(self) -> Position {
        let position = self.lead.map_or(Position::ZERO, |lead| lead.position);
        position - Position::whole(position.floor())
    }
}

/// A sum, which the board shows behind the axes, too.
#[cold]
fn added<'a>(leads: &Leads, leader: Leader, room: &'a mut Option<Lead>) -> (i64, Option<&'a Lead>) {
    let lead = room.insert(leads.get(leader));
    (lead.position.floor(), Some(lead))
}

/// A voltage as a whole number.
pub(super) fn millivolts(volts: f64) -> i64 {
    // The cast saturates, and makes 0 of NaN.
    (volts * 1000.0 + 0.5_f64.copysign(volts)) as i64
}

impl Word {
    /// The signal now as the image of a program has it: an i64, or of a real an f64.
    pub(super) fn bits(self, board: &Board) -> u64 {
        match self {
            Self::Int(signal) => board.int(signal).cast_unsigned(),
            Self::Real(signal) | Self::Volts(signal) => board.real(signal).to_bits(),
        }
    }

    /// The signal now.
    #[inline]
    pub(super) fn read(self, board: &Board) -> i64 {
        match self {
            Self::Int(signal) => board.int(signal),
            // The cast saturates, and makes 0 of NaN.
            Self::Real(signal) => board.real(signal) as i64,
            Self::Volts(signal) => millivolts(board.real(signal)),
        }
    }
}

impl Cell {
    /// What it holds, as the image of a program has it.
    pub(super) fn bits(self, board: &Board) -> u64 {
        match self {
            Self::Bit(signal) | Self::Int(signal, _) => board.int(signal).cast_unsigned(),
            Self::Real(signal) => board.real(signal).to_bits(),
        }
    }

    /// Can it hold what a program has left for it?
    pub(super) fn takes(self, word: u64) -> bool {
        !matches!(self, Self::Real(_)) || f64::from_bits(word).is_finite()
    }

    /// Takes what a program has left for it.
    pub(super) fn set(self, board: &mut Board, word: u64) {
        match self {
            Self::Bit(signal) => board.set_int(signal, i64::from(word != 0)),
            Self::Int(signal, width) => board.set_int(signal, width.cut(word.cast_signed())),
            Self::Real(signal) => board.set_real(signal, f64::from_bits(word)),
        }
    }
}

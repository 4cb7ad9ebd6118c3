//! Inputs and source of a slot, read from the board and the leads.
//!
//! Law      a voltage is read in mV, rounded to the nearest; any other real is truncated towards zero; 16 and 32 bits
//!          are the low ones, sign-extended

use super::wires::{OutputCell, Source, Wires, Word};
use crate::encoder::Lead;
use crate::object::Leader;
use crate::position::Position;
use crate::signal::Board;
use crate::sync::Leads;

/// Returns the inputs: E1 in bit 0 to E8 in bit 7, after inversion.
pub(super) fn read_inputs(wires: &Wires, board: &Board) -> u8 {
    let mut bits = 0;
    for (place, input) in wires.inputs.iter().take(wires.lines.0).enumerate() {
        if let Some(input) = input {
            bits |= u8::from(board.bit(input.signal) != input.inverted) << place;
        }
    }
    bits
}

/// The source of a slot.
#[derive(Clone, Copy)]
pub(super) struct SourceReading<'a> {
    /// Value in the width of the source; 0 without one.
    pub value: i64,
    /// Lead of the source; `None` if it is no position. An object that does not exist has an invalid lead.
    pub lead: Option<&'a Lead>,
}

impl<'a> SourceReading<'a> {
    /// Reads the source; `room` holds a lead that has to be computed as a sum.
    #[inline]
    pub(super) fn new(wires: &Wires, board: &Board, leads: &'a Leads, room: &'a mut Option<Lead>) -> Self {
        let (value, lead) = match wires.source {
            Source::None => return Self { value: 0, lead: None },
            Source::Signal(word) => (word.read(board), None),
            Source::Lead(leader, word) => match leads.simple(leader) {
                Some(lead) => {
                    // The board is updated after the axes, too late for this cycle.
                    let is_actual = matches!(leader, Leader::AxisActual(_));
                    (if is_actual { lead.position.floor() } else { word.read(board) }, Some(lead))
                }
                None => sum_of_leads(leads, leader, room),
            },
        };
        Self { value: wires.source_width.cut(value), lead }
    }

    /// Returns true if the source is valid.
    #[inline]
    pub(super) fn is_valid(self) -> bool {
        self.lead.is_none_or(|lead| lead.valid)
    }

    /// Returns the fraction of the position: travel counts whole increments.
    pub(super) fn fraction(self) -> Position {
        let position = self.lead.map_or(Position::ZERO, |lead| lead.position);
        position - Position::whole(position.floor())
    }
}

/// Returns a sum of positions; the board is updated after the axes, too.
#[cold]
fn sum_of_leads<'a>(leads: &Leads, leader: Leader, room: &'a mut Option<Lead>) -> (i64, Option<&'a Lead>) {
    let lead = room.insert(leads.get(leader));
    (lead.position.floor(), Some(lead))
}

/// Converts a voltage to mV.
pub(super) fn millivolts(volts: f64) -> i64 {
    // The cast saturates, and converts NaN to 0.
    (volts * 1000.0 + 0.5_f64.copysign(volts)) as i64
}

impl Word {
    /// Returns the signal as the image of a program holds it: an i64, or an f64 for a real.
    pub(super) fn bits(self, board: &Board) -> u64 {
        match self {
            Self::Int(signal) => board.int(signal).cast_unsigned(),
            Self::Real(signal) | Self::Volts(signal) => board.real(signal).to_bits(),
        }
    }

    /// Returns the present value of the signal.
    #[inline]
    pub(super) fn read(self, board: &Board) -> i64 {
        match self {
            Self::Int(signal) => board.int(signal),
            // The cast saturates, and converts NaN to 0.
            Self::Real(signal) => board.real(signal) as i64,
            Self::Volts(signal) => millivolts(board.real(signal)),
        }
    }
}

impl OutputCell {
    /// Returns the value as the image of a program holds it.
    pub(super) fn bits(self, board: &Board) -> u64 {
        match self {
            Self::Bit(signal) | Self::Int(signal, _) => board.int(signal).cast_unsigned(),
            Self::Real(signal) => board.real(signal).to_bits(),
        }
    }

    /// Returns true if it can hold the value of a program.
    pub(super) fn can_hold(self, word: u64) -> bool {
        !matches!(self, Self::Real(_)) || f64::from_bits(word).is_finite()
    }

    /// Sets the value of a program.
    pub(super) fn set(self, board: &mut Board, word: u64) {
        match self {
            Self::Bit(signal) => board.set_int(signal, i64::from(word != 0)),
            Self::Int(signal, width) => board.set_int(signal, width.cut(word.cast_signed())),
            Self::Real(signal) => board.set_real(signal, f64::from_bits(word)),
        }
    }
}

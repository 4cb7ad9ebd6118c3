//! What a slot reads of the board and the leads in its call.
//!
//! Law      a voltage is read in mV, to the nearest; any other real is cut towards zero; 16 and 32 bits are the low ones, sign-extended

use super::wires::{Source, Wires, Word};
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

/// Its source, as wide as that is; 0 without one.
pub(super) fn value(wires: &Wires, board: &Board, leads: &Leads) -> i64 {
    let value = match wires.source {
        Source::None => return 0,
        // The board shows it behind the axes.
        Source::Lead(leader @ Leader::AxisActual(_), _) => leads.find(leader).map_or(0, |lead| lead.position.floor()),
        Source::Lead(_, word) | Source::Signal(word) => word.read(board),
    };
    wires.source_width.cut(value)
}

/// Is its source there?
pub(super) fn is_valid(wires: &Wires, leads: &Leads) -> bool {
    match wires.source {
        Source::Lead(leader, _) => leads.get(leader).valid,
        Source::None | Source::Signal(_) => true,
    }
}

/// What the floor of its source leaves: the way is that of whole increments.
pub(super) fn fraction(wires: &Wires, leads: &Leads) -> Position {
    let Source::Lead(leader, _) = wires.source else { return Position::ZERO };
    let position = leads.get(leader).position;
    position - Position::whole(position.floor())
}

/// A voltage as a whole number.
pub(super) fn millivolts(volts: f64) -> i64 {
    // The cast saturates, and makes 0 of NaN.
    (volts * 1000.0 + 0.5_f64.copysign(volts)) as i64
}

impl Word {
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

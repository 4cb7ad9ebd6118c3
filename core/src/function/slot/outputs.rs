//! Sink, outputs and published values of a slot.

use super::{Slot, Written};
use crate::function::description::Quantity;
use crate::function::program::{LINES, Outcome};
use crate::function::reading::millivolts;
use crate::function::shown::MOST_SHOWN;
use crate::function::wires::{Bit, Sink, Wires};
use crate::position::Position;
use crate::signal::Board;

impl Slot {
    /// Returns the published values.
    #[inline]
    fn shows(&self) -> &[i64] {
        match self.function.shown() {
            [] => &self.shown,
            stored if self.is_active() => stored,
            _ => &[0; MOST_SHOWN],
        }
    }

    /// Sets the published values of the last call to 0.
    pub(super) fn clear_shown(&mut self) {
        let [.., answer] = self.shown;
        self.shown = [0, 0, 0, answer];
    }

    /// Changes the coordinate of the sink, without motion.
    #[cold]
    pub(super) fn shift_sink(&mut self, wires: &Wires, by: i64) {
        self.sink = wires.sink_width.cut(self.sink.wrapping_add(by));
        self.anew = Position::whole(by);
        self.lead.position += self.anew;
    }

    /// Returns the initial value of the sink: that of its object.
    pub(super) fn initial_sink(&self, wires: &Wires, board: &Board) -> i64 {
        let value = match wires.sink {
            Sink::None => self.sink,
            // A position is no speed: the axis is treated as at rest.
            Sink::Axis(..) if wires.quantity == Quantity::Speed => 0,
            Sink::Axis(_, command) | Sink::Memory(command, _) => board.int(command),
            Sink::Real(signal) => board.real(signal) as i64,
            Sink::Analog(_, signal) => millivolts(board.real(signal)),
        };
        wires.sink_width.cut(value)
    }

    /// Writes the outputs of a call.
    #[inline]
    pub(super) fn write(&mut self, wires: &Wires, outcome: Outcome, board: &mut Board) -> Written {
        let [.., answer] = self.shown;
        self.shown = [outcome.sak_share, outcome.correction, outcome.deviation, answer];
        self.writes = outcome.writes;
        self.write_sink(wires, board);
        self.set_outputs(wires, outcome.outputs, outcome.writes, board);
        Written { outputs: outcome.writes, sink: true, failed: None }
    }

    /// Moves the sink to a value, and its lead by the same distance.
    #[inline]
    pub(super) fn advance_sink(&mut self, wires: &Wires, value: i64) {
        let before = std::mem::replace(&mut self.sink, wires.sink_width.cut(value));
        self.lead.change = Position::whole(wires.sink_width.cut(self.sink.wrapping_sub(before)));
        self.lead.position += self.lead.change;
    }

    #[inline]
    fn write_sink(&self, wires: &Wires, board: &mut Board) {
        match wires.sink {
            Sink::None | Sink::Axis(..) => {}
            Sink::Memory(signal, width) => board.set_int(signal, width.cut(self.sink)),
            Sink::Real(signal) => board.set_real(signal, self.sink as f64),
            Sink::Analog(_, signal) => board.set_real(signal, self.volts(wires)),
        }
    }

    /// Returns the sink as voltage of an analog output (V), limited to the full scale.
    pub(crate) fn volts(&self, wires: &Wires) -> f64 {
        self.sink.min(wires.full_scale).max(-wires.full_scale) as f64 / 1000.0
    }

    #[inline]
    fn set_outputs(&mut self, wires: &Wires, outputs: u8, writes: u8, board: &mut Board) {
        self.outputs = self.outputs & !writes | outputs & writes;
        if wires.lines.1 > 0 {
            write_memory(wires, outputs, writes, board);
        }
    }

    /// Sets sink and outputs of a type without a call of RESET.
    pub(super) fn rest_sink(&mut self, wires: &Wires, board: &mut Board) -> Written {
        let sink = wires.quantity == Quantity::Speed;
        if sink {
            self.advance_sink(wires, 0);
            self.write_sink(wires, board);
        }
        let rests = wires.kind.description().rests;
        self.set_outputs(wires, self.function.rests(rests), self.writes, board);
        Written { outputs: self.writes, sink, failed: None }
    }

    pub(super) fn publish(&self, wires: &Wires, board: &mut Board) {
        let [sink, active, error, lines @ ..] = board.block(wires.first, signals(wires.shows)) else { return };
        let int = i64::cast_unsigned;
        (*sink, *active, *error) = (int(self.sink), u64::from(self.is_active()), u64::from(self.error.0));
        for (bit, word) in (0..LINES).zip(lines.iter_mut()) {
            *word = u64::from(self.inputs >> bit & 1);
        }
        for (bit, word) in (0..LINES).zip(lines.iter_mut().skip(LINES)) {
            *word = u64::from(self.outputs >> bit & 1);
        }
        for (value, word) in self.shows().iter().zip(lines.iter_mut().skip(2 * LINES)) {
            *word = int(*value);
        }
    }
}

/// Writes the outputs that are memory cells.
fn write_memory(wires: &Wires, outputs: u8, writes: u8, board: &mut Board) {
    for (place, output) in wires.outputs.iter().take(wires.lines.1).enumerate() {
        if let Some(output) = output
            && writes >> place & 1 == 1
            && let Bit::Memory(signal) = output.to
        {
            board.set_int(signal, i64::from((outputs >> place & 1 == 1) != output.inverted));
        }
    }
}

/// Returns the number of signals of a slot that publishes `shows` values.
pub(super) fn signals(shows: usize) -> usize {
    3 + 2 * LINES + shows
}

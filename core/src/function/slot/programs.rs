//! Slots with a user program: calls, results, errors and exchange.

use super::{Cycle, Phase, Slot, Written};
use crate::code::Code;
use crate::function::program::{CallInputs, Host, Outcome};
use crate::function::wires::Wires;
use crate::signal::Board;
use lineshaft_program::Module;
use std::sync::Arc;

impl Slot {
    /// Returns the inputs of a call together with the environment of a program.
    pub(super) fn inputs_of_program<'a>(
        &self,
        wires: &'a Wires,
        cx: &Cycle<'a>,
        board: &'a Board,
        sink: i64,
    ) -> CallInputs<'a> {
        let host = module(wires, cx.programs).map(|module| Host {
            module,
            fuel: wires.fuel,
            board,
            reads: &wires.reads,
            writes: &wires.writes,
            first_output: first_output(wires),
        });
        CallInputs { host, ..self.seen(wires, cx, board, sink) }
    }

    /// Calls a program; separate, so that other types take no time for it.
    #[inline(never)]
    pub(super) fn call_program(&mut self, wires: &Wires, cx: &Cycle<'_>, board: &mut Board) -> Written {
        let seen = self.inputs_of_program(wires, cx, board, self.sink);
        let outcome = self.function.step(&seen);
        self.apply_result(wires, cx, outcome, board)
    }

    /// Applies the result of a program, or ends it.
    pub(super) fn apply_result(
        &mut self,
        wires: &Wires,
        cx: &Cycle<'_>,
        outcome: Outcome,
        board: &mut Board,
    ) -> Written {
        if let Some(code) = outcome.failed {
            return self.fail(wires, code, board);
        }
        self.advance_sink(wires, outcome.sink);
        self.lead.velocity = self.lead.change.to_f64() / cx.cycle_s;
        let written = self.write(wires, outcome, board);
        self.write_cells(wires, cx, board);
        written
    }

    /// Ends a program after an error.
    #[cold]
    pub(super) fn fail(&mut self, wires: &Wires, code: Code, board: &mut Board) -> Written {
        let written = self.rest_sink(wires, board);
        (self.phase, self.error) = (Phase::Reset, code);
        self.clear_shown();
        self.mark = None;
        self.publish(wires, board);
        self.is_shown = false;
        Written { failed: Some(code), ..written }
    }

    /// Copies the values of a program to memory cells.
    pub(super) fn write_cells(&mut self, wires: &Wires, cx: &Cycle<'_>, board: &mut Board) {
        if wires.writes.is_empty() {
            return;
        }
        let Some(module) = module(wires, cx.programs) else { return };
        for (place, cell) in wires.writes.iter().enumerate() {
            cell.set(board, self.function.word(module, place));
        }
    }

    /// Returns the reserved pages of memory for its program.
    pub(crate) fn room(&self) -> usize {
        self.function.room()
    }

    /// Replaces the program. Returns false if it cannot keep the state, or lacks memory for the new one.
    pub(crate) fn exchange(&mut self, modules: (&Module, &Module), keeps: bool) -> bool {
        self.function.exchange(modules, keeps)
    }
}

/// Returns the first output that is wired: the bit mask of A1 (AMK-APSF-11).
pub(super) fn first_output(wires: &Wires) -> u8 {
    wires.outputs.iter().position(Option::is_some).map_or(0, |first| first as u8)
}

/// Returns the program of a slot; `None` for other types.
pub(super) fn module<'a>(wires: &Wires, programs: &'a [Arc<Module>]) -> Option<&'a Module> {
    programs.get(usize::from(wires.program?)).map(|module| &**module)
}

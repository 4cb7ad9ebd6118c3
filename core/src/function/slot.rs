//! Function slot: the state machine around a function of any type.
//!
//! Law      RESET -START-> ACTIVE -RESET-> RESET; VALUE_NEW and READ_VALUE do not change the state. A parameter set is
//!          accepted as a whole or not at all. The call in the cycle of START is the first one: the sink begins at the
//!          value of its object, so there is no jump
//! Reads    its source, its inputs, its tables: values of this cycle from objects before it in the cycle, of the last
//!          cycle from objects after it
//! Writes   its sink and its outputs while it is active, and once more at RESET: a position is held, a speed becomes 0,
//!          outputs that mean "at rest" become 1, all others 0. A function that was never started writes nothing
//! Refuses  START while it is active, VALUE_NEW while it is not, a parameter set that its type does not accept, each
//!          with the field
//! Source   AMK-CMD-01 to -14, AMK-BCOM-32 to -41, A-07 to -13

mod bounds;
mod commands;
mod goals;
mod outputs;
mod programs;
mod state;

use self::outputs::signals;
use super::field::Words;
use super::goal::{Goal, GoalEnd};
use super::notice::EventRateLimit;
use super::program::{CallInputs, Drive, GoalRequest, LINES, SlotSetup, SourceValue, Tables};
use super::reading::{SourceReading, read_inputs};
use super::shown::ANSWER;
use super::types::Any;
use super::wires::{Mark, MemorySize, Width, Wires};
use crate::code::Code;
use crate::encoder::{COUNT, Lead};
use crate::parameter::Sets;
use crate::position::Position;
use crate::signal::Board;
use crate::sync::Leads;
use crate::table::Table;
use lineshaft_program::Module;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Command to a function, numbered as in the source and in the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Order {
    /// Only stores values for the next START or VALUE_NEW.
    Stage,
    /// Stops the function.
    Reset,
    /// Starts the function.
    Start,
    /// Applies the live fields of the set while the function runs.
    ValueNew,
    /// Changes nothing; the answer contains the active set.
    ReadValue,
}

impl Order {
    /// All commands with their names and numbers.
    pub const ALL: [(Order, &'static str, u8); 5] = [
        (Order::Stage, "stage", 255),
        (Order::Reset, "reset", 0),
        (Order::Start, "start", 1),
        (Order::ValueNew, "value_new", 5),
        (Order::ReadValue, "read_value", 6),
    ];
}

/// State of a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// At rest.
    #[default]
    Reset,
    /// RESET was commanded in this cycle while the function ran.
    Leaving,
    /// START was commanded in this cycle.
    Starting,
    /// The function runs.
    Active,
    /// RESET and START were commanded in this cycle, while the function ran; its type has a call of RESET.
    Restarting,
}

/// Inputs of a slot in a cycle.
pub(crate) struct Cycle<'a> {
    /// Number k of the cycle.
    pub cycle: u64,
    pub leads: &'a Leads,
    pub tables: &'a [Arc<Table>],
    pub programs: &'a [Arc<Module>],
    /// Distance of the mark of this cycle, if any, behind the present position of the source; for a mark of an axis,
    /// behind its command.
    pub mark: Option<Position>,
    /// The first eight axes, for a function that monitors them.
    pub drives: &'a [Drive; LINES],
    pub cycle_s: f64,
}

/// Outputs of a slot in a cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Written {
    /// Outputs that were written, A1 in bit 0.
    pub outputs: u8,
    pub sink: bool,
    /// Error that stopped the function.
    pub failed: Option<Code>,
}

/// A slot.
#[derive(Debug, Serialize, Deserialize)]
pub struct Slot {
    function: Any,
    phase: Phase,
    /// The cycle of START.
    since: u64,
    /// Values for the next START or VALUE_NEW.
    staged: Box<[i64]>,
    /// Active values.
    active: Box<[i64]>,
    /// Unwrapped travel of the source since START.
    travel: Position,
    /// Last value of the source.
    last: i64,
    /// A mark that no call has used yet, in `travel`.
    mark: Option<i64>,
    inputs: u8,
    outputs: u8,
    /// Outputs that the function writes.
    writes: u8,
    sink: i64,
    /// Values that the last call publishes, 0 at rest; at [`ANSWER`] the answer to the last READ_VALUE.
    shown: [i64; ANSWER + 1],
    error: Code,
    lead: Lead,
    /// Change of the coordinate of the sink in this cycle, which is no motion.
    anew: Position,
    /// Whether the board is up to date and the lead at rest.
    is_shown: bool,
    notice: EventRateLimit,
    goal: Option<Goal>,
    /// End of a goal that has not been reported yet.
    ended: Option<GoalEnd>,
}

impl Slot {
    /// Creates a function at rest with these values.
    pub(crate) fn new(wires: &Wires, values: &[i64], room: MemorySize, module: Option<&Module>) -> Self {
        let setup = SlotSetup { has_words: wires.words.map(|word| word.is_some()), room, module };
        Self {
            function: Any::new(wires.kind, &setup),
            phase: Phase::Reset,
            since: 0,
            staged: values.into(),
            active: values.into(),
            travel: Position::ZERO,
            last: 0,
            mark: None,
            inputs: 0,
            outputs: 0,
            writes: 0,
            sink: 0,
            shown: [0; ANSWER + 1],
            error: Code::NONE,
            lead: Lead { uneven: COUNT, valid: true, ..Lead::default() },
            anew: Position::ZERO,
            is_shown: true,
            notice: EventRateLimit::default(),
            goal: None,
            ended: None,
        }
    }

    /// Returns true if the function is started.
    pub fn is_active(&self) -> bool {
        matches!(self.phase, Phase::Starting | Phase::Active | Phase::Restarting)
    }

    /// Returns the values for the next START or VALUE_NEW.
    pub fn staged(&self) -> &[i64] {
        &self.staged
    }

    /// Returns the active values; those of the last START if the function is at rest.
    pub fn active(&self) -> &[i64] {
        &self.active
    }

    /// Returns a copy of both sets, for publishing.
    pub(crate) fn sets(&self) -> Sets {
        Sets { staged: self.staged.clone(), active: self.active.clone() }
    }

    /// Updates a copy of the sets; does not allocate.
    pub(crate) fn copy_sets(&self, sets: &mut Sets) {
        for (copy, values) in [(&mut sets.staged, &self.staged), (&mut sets.active, &self.active)] {
            if copy.len() == values.len() {
                copy.copy_from_slice(values);
            }
        }
    }

    /// Returns the error of the last command; `Code::NONE` if it was accepted.
    pub fn error(&self) -> Code {
        self.error
    }

    /// Returns the value of the sink.
    pub fn sink(&self) -> i64 {
        self.sink
    }

    /// Returns the inputs: E1 in bit 0 to E8 in bit 7, after inversion.
    pub fn inputs(&self) -> u8 {
        self.inputs
    }

    /// Returns the outputs: A1 in bit 0 to A8 in bit 7, before inversion.
    pub fn outputs(&self) -> u8 {
        self.outputs
    }

    /// Returns the compensation of the following error (inc).
    pub(crate) fn sak_share(&self) -> i64 {
        if self.is_active() { self.shown[0] } else { 0 }
    }

    /// Returns the lead for followers of the sink.
    pub(crate) fn lead(&self) -> &Lead {
        &self.lead
    }

    /// Returns the change of the coordinate of the sink in this cycle.
    pub(crate) fn coordinate_change(&self) -> Position {
        self.anew
    }

    /// Returns whether it runs (256) and its outputs, A1 in bit 0, if an event is due in this cycle, and the number of
    /// unreported changes before.
    #[inline]
    pub(crate) fn due_event(&mut self, cycle: u64, cycle_ns: u64) -> Option<(u16, u32)> {
        let state = u16::from(self.is_active()) << LINES | u16::from(self.outputs);
        Some((state, self.notice.take(state, cycle, cycle_ns)?))
    }

    /// RESET. The last outputs are written in the turn of the slot in this cycle.
    pub(crate) fn reset(&mut self) {
        self.is_shown = false;
        self.abort_goal(Code::FUNCTION_RESET);
        let has_run = matches!(self.phase, Phase::Active | Phase::Restarting);
        self.phase = if has_run { Phase::Leaving } else { Phase::Reset };
    }

    /// Executes the cycle of a slot at rest, the most frequent case. Returns false if the cycle needs [`Self::step`].
    pub(crate) fn cycle_at_rest(&mut self, wires: &Wires, board: &mut Board) -> bool {
        let rests = self.phase == Phase::Reset && self.is_shown && !self.notice.is_pending();
        if rests {
            let before = std::mem::replace(&mut self.inputs, read_inputs(wires, board));
            if self.inputs != before {
                self.publish(wires, board);
            }
        }
        rests
    }

    /// Executes any other cycle.
    pub(crate) fn step(&mut self, wires: &Wires, cx: &Cycle<'_>, board: &mut Board) -> Written {
        let before = (self.inputs, self.outputs);
        self.inputs = read_inputs(wires, board);
        (self.lead.change, self.lead.velocity, self.anew) = (Position::ZERO, 0.0, Position::ZERO);
        let mut room = None;
        let source = SourceReading::new(wires, board, cx.leads, &mut room);
        if self.phase != Phase::Active {
            return self.start_or_stop(wires, cx, source, board);
        }
        self.add_source_travel(wires, source);
        let back = match wires.mark {
            Mark::None => None,
            Mark::Edge => (before.0 & 1 == 0 && self.inputs & 1 == 1).then_some(Position::ZERO),
            Mark::Latch(_) | Mark::Encoder(_) | Mark::Axis(_) => cx.mark,
        };
        if let Some(back) = back {
            self.mark = Some(match wires.mark {
                Mark::Axis(_) => self.sink.wrapping_sub(back.nearest()),
                _ => (self.travel - back).floor(),
            });
        }
        let mut written = Written::default();
        if wires.factor == 1 || cx.cycle.wrapping_sub(self.since).checked_rem(wires.factor.into()) == Some(0) {
            if wires.program.is_some() {
                written = self.call_program(wires, cx, board);
                if written.failed.is_some() {
                    return written;
                }
            } else {
                let seen = self.seen(wires, cx, board, self.sink);
                self.mark = None;
                let outcome = self.function.step(&seen);
                if outcome.coordinate_change != 0 {
                    self.shift_sink(wires, outcome.coordinate_change);
                }
                self.advance_sink(wires, outcome.sink);
                if self.goal.is_some() {
                    self.advance_goal();
                }
                self.lead.velocity = self.lead.change.to_f64() / cx.cycle_s;
                written = self.write(wires, outcome, board);
            }
        }
        self.lead.valid = source.is_valid();
        if before != (self.inputs, self.outputs) || !self.is_shown {
            self.publish(wires, board);
            self.is_shown = true;
            return written;
        }
        board.set_int(wires.first, self.sink);
        let shown = match self.function.shown() {
            [] => &self.shown,
            stored => stored,
        };
        for (word, value) in board.block(wires.first.plus(signals(0)), wires.shows).iter_mut().zip(shown) {
            *word = value.cast_unsigned();
        }
        written
    }

    /// Executes a cycle with START or RESET, and the one after RESET, in which the lead comes to rest.
    #[cold]
    fn start_or_stop(
        &mut self,
        wires: &Wires,
        cx: &Cycle<'_>,
        source: SourceReading<'_>,
        board: &mut Board,
    ) -> Written {
        let rests = self.phase == Phase::Reset;
        let written = match self.phase {
            Phase::Starting => self.begin(wires, cx, source, board),
            Phase::Leaving => self.leave(wires, cx, source, board),
            Phase::Restarting => {
                let written = self.leave(wires, cx, source, board);
                if written.failed.is_some() { written } else { self.begin(wires, cx, source, board) }
            }
            Phase::Reset | Phase::Active => Written::default(),
        };
        self.lead.valid = !self.is_active() || source.is_valid();
        self.publish(wires, board);
        self.is_shown = self.is_active() || rests;
        written
    }

    /// Executes the first call.
    fn begin(&mut self, wires: &Wires, cx: &Cycle<'_>, source: SourceReading<'_>, board: &mut Board) -> Written {
        (self.phase, self.since) = (Phase::Active, cx.cycle);
        (self.travel, self.mark, self.last) = (source.fraction(), None, source.value);
        let base = self.initial_sink(wires, board);
        // The initial value of the sink is no travel: a goal begins with the next call.
        let seen = CallInputs { asked: GoalRequest::Nothing, ..self.inputs_of_program(wires, cx, board, base) };
        let outcome = self.function.start(Words(&self.active), &seen);
        // After an error the sink keeps its value.
        self.sink = if outcome.failed.is_some() { base } else { wires.sink_width.cut(outcome.sink) };
        self.anew = Position::whole(self.sink) - self.lead.position;
        self.lead.position = Position::whole(self.sink);
        if let Some(code) = outcome.failed {
            return self.fail(wires, code, board);
        }
        let written = self.write(wires, outcome, board);
        self.write_cells(wires, cx, board);
        written
    }

    /// Adds the travel of the source.
    #[inline]
    fn add_source_travel(&mut self, wires: &Wires, source: SourceReading<'_>) {
        if let Some(lead) = source.lead {
            let before = self.travel;
            self.travel += lead.change;
            if wires.source_width != Width::W64 {
                // Differences are those of whole increments; the sum keeps the fraction.
                let step = self.travel.floor().wrapping_sub(before.floor());
                self.travel += Position::whole(wires.source_width.cut(step).wrapping_sub(step));
            }
        } else {
            self.travel += Position::whole(wires.source_width.cut(source.value.wrapping_sub(self.last)));
        }
        self.last = source.value;
    }

    #[inline]
    fn seen<'a>(&self, wires: &'a Wires, cx: &Cycle<'a>, board: &Board, sink: i64) -> CallInputs<'a> {
        CallInputs {
            call_ns: wires.call_ns,
            source: SourceValue { value: self.last, travel: self.travel.floor(), mark: self.mark },
            inputs: self.inputs,
            asked: self.goal.as_ref().map_or(GoalRequest::Nothing, Goal::request),
            sink,
            words: wires.words.map(|word| word.map_or(0, |word| word.read(board))),
            tables: Tables { all: cx.tables, places: &wires.tables },
            drives: cx.drives,
            outputs: self.outputs,
            host: None,
        }
    }

    /// Ends a running function.
    fn leave(&mut self, wires: &Wires, cx: &Cycle<'_>, source: SourceReading<'_>, board: &mut Board) -> Written {
        let written = if wires.program.is_some() {
            self.add_source_travel(wires, source);
            let seen = self.inputs_of_program(wires, cx, board, self.sink);
            match self.function.leave(&seen) {
                Some(outcome) => self.apply_result(wires, cx, outcome, board),
                None => self.rest_sink(wires, board),
            }
        } else {
            self.rest_sink(wires, board)
        };
        if written.failed.is_some() {
            return written;
        }
        self.phase = Phase::Reset;
        self.clear_shown();
        self.mark = None;
        written
    }
}

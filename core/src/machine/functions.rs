//! Function slots of a machine: their commands, their steps in a cycle, their tables.

use super::signals::locate;
use super::{CycleInputs, Machine, State};
use crate::axis::{Axis, MovedBy, no_cam};
use crate::code::Code;
use crate::command::{Command, CommandFunction, RunFunction};
use crate::drive::{Edge, Inputs};
use crate::event::{Event, Kind as EventKind, Number, Refusal, Severity};
use crate::function::{
    Bit, Cycle, Drive, Fault, LINES, Mark, Monitored, NO_DRIVES, OnAxisError, Order, Sink, Slot, Source, Wires,
};
use crate::object::{Leader, Object};
use crate::position::Position;
use crate::signal::axis::AxisSignal;
use crate::sync::Leads;
use crate::table::{PitchError, Table};
use lineshaft_program::Module;
use std::sync::Arc;

/// Returns a fault of a function as the refusal of its command.
fn refusal(fault: Fault, slot: u16) -> Refusal {
    let refusal = Refusal::new(fault.code, Object::Function(slot)).with(fault.asked, fault.limit);
    Refusal { parameter: fault.field, ..refusal }
}

/// Returns the slots that end on an error of the axis that they move, each with that axis.
pub(super) fn slots_ended_by_axis_errors(wires: &[Wires]) -> Vec<(u16, u16)> {
    let ended = |(place, wires): (u16, &Wires)| match wires.sink {
        Sink::Axis(axis, _) if wires.on_axis_error == OnAxisError::Reset => Some((place, axis)),
        _ => None,
    };
    (0..).zip(wires).filter_map(ended).collect()
}

/// Returns the axes that a function can watch and that a slot moves, each with its slot.
pub(super) fn slots_that_move_watched_axes(wires: &[Wires]) -> Vec<(usize, u16)> {
    let moved = |(place, wires): (u16, &Wires)| match wires.sink {
        Sink::Axis(axis, _) if usize::from(axis) < LINES => Some((axis.into(), place)),
        _ => None,
    };
    (0..).zip(wires).filter_map(moved).collect()
}

/// Keeps the shown master position of the followers of a sink when the sink increases by `by`.
#[cold]
fn keep_master_positions_of_sink(axes: &mut [Axis], leads: &Leads, slot: u16, by: Position) {
    axes.iter_mut().for_each(|axis| axis.continue_with_sink(leads, slot, by));
}

/// Fails the goal of a function if the axis has left the function.
#[cold]
fn fail_goal_if_axis_has_left(slot: &mut Slot, sink: Sink, axes: &[Axis], own: Leader) {
    if slot.follows_goal()
        && let Sink::Axis(axis, _) = sink
        && let Some(code) = axes.get(usize::from(axis)).and_then(|axis| axis.function_failure(own))
    {
        slot.abort_goal(code);
    }
}

impl Machine {
    /// Returns the function slots, by their numbers.
    pub fn slots(&self) -> &[Slot] {
        &self.state.slots
    }

    /// Returns the tables, in file order.
    pub fn tables(&self) -> &[Arc<Table>] {
        &self.state.tables
    }

    /// Returns the reason why START would refuse a parameter set of the function in a slot at rest. Returns `None` if
    /// START would accept it, or if the slot does not exist.
    pub fn refused_start(&self, place: u16, set: &[i64]) -> Option<Refusal> {
        let (wires, slot) = self.wires.get(usize::from(place)).zip(self.state.slots.get(usize::from(place)))?;
        slot.check_start(wires, &self.state.tables, set).err().map(|fault| refusal(fault, place))
    }

    /// Executes an order to a function. Returns true if the axis that it moves must receive the order, too.
    pub(super) fn command_function(&mut self, command: &Command, request: &CommandFunction) -> Result<bool, Refusal> {
        let CommandFunction { slot, order, ref values } = *request;
        self.order_function(command, slot, (order, values))
    }

    fn order_function(
        &mut self,
        command: &Command,
        slot: u16,
        (order, values): (Order, &[(u16, i64)]),
    ) -> Result<bool, Refusal> {
        let unknown = || Refusal::new(Code::BAD_REQUEST, Object::Machine);
        let wires = self.wires.get(usize::from(slot)).ok_or_else(unknown)?;
        let moved = match wires.sink {
            Sink::Axis(axis, _) => Some(axis),
            _ => None,
        };
        if order == Order::Start
            && let Some(axis) = moved
        {
            if let Some(axis) = self.state.axes.get(usize::from(axis)) {
                axis.check_function()?;
            }
            if self.closes_loop(axis, Leader::Sink(slot)) {
                return Err(Refusal::new(Code::LEADER_LOOP, Object::Axis(axis)));
            }
        }
        let State { slots, tables, .. } = &mut self.state;
        let taken = slots.get_mut(usize::from(slot)).ok_or_else(unknown)?;
        let answer =
            taken.command(wires, (order, values), tables, &mut self.room).map_err(|fault| refusal(fault, slot))?;
        if order != Order::ReadValue || !values.is_empty() || wires.kind.description().reads_at_rest {
            self.count_change();
        }
        self.accept(command, Object::Function(slot));
        if let Some((field, value)) = answer {
            let event = Event::new(Severity::Info, EventKind::Parameter, Object::Function(slot), Code::NONE);
            let event = event.of_command(command.sequence).with(Number::Position(value), Number::None);
            self.events.push(Event { parameter: Some(field), position: Position::whole(value), ..event });
        }
        let tells = moved.is_some() && matches!(order, Order::Start | Order::Reset);
        self.couples |= tells;
        Ok(tells)
    }

    /// Starts a goal of a function, after the order that it needs: START in RESET, otherwise VALUE_NEW. Returns true if
    /// the axis that it moves must receive that order, too.
    pub(super) fn run_function(&mut self, command: &Command, request: &RunFunction) -> Result<bool, Refusal> {
        let (place, sink) = (usize::from(request.slot), Leader::Sink(request.slot));
        let unknown = || Refusal::new(Code::BAD_REQUEST, Object::Machine);
        let (wires, slot) = self.wires.get(place).zip(self.state.slots.get(place)).ok_or_else(unknown)?;
        slot.check_goal(wires).map_err(|code| Refusal::new(code, Object::Function(request.slot)))?;
        let by = slot.is_active().then_some(sink);
        if let Sink::Axis(axis, _) = wires.sink
            && let Some(axis) = self.state.axes.get(usize::from(axis))
        {
            axis.check_goal(by)?;
        }
        let order = if by.is_some() { Order::ValueNew } else { Order::Start };
        let tells = self.order_function(command, request.slot, (order, &request.values))?;
        if let Some(slot) = self.state.slots.get_mut(place) {
            slot.take_goal(command.sequence);
        }
        Ok(tells)
    }

    /// Cancels a goal of a function. Returns true if the goal is one of a function.
    pub(super) fn cancel_run(&mut self, sequence: u64, goal: u64) -> bool {
        let mut slots = (0_u16..).zip(&mut self.state.slots);
        let Some((place, _)) = slots.find_map(|(place, slot)| slot.cancel_goal(goal).then_some((place, slot))) else {
            return false;
        };
        let event = Event::new(Severity::Info, EventKind::Accepted, Object::Function(place), Code::NONE);
        self.events.push(event.of_command(sequence));
        true
    }

    /// Passes START or RESET of a function to its axis.
    pub(super) fn pass_order_to_axis(&mut self, told: CycleInputs<'_>, slot: u16, order: Order) {
        let Some(wires) = self.wires.get(usize::from(slot)) else { return };
        let Sink::Axis(axis, _) = wires.sink else { return };
        let (sink, speed) = (Leader::Sink(slot), wires.speed);
        // A later command of this cycle may have ended the function again.
        let runs = self.state.slots.get(usize::from(slot)).is_some_and(Slot::is_active);
        self.act_on(axis.into(), told, |axis, cx| match order {
            Order::Start if runs => axis.start_following_function(cx, MovedBy { sink, speed }),
            Order::Reset if !runs => axis.stop_following_function(cx, sink),
            _ => {}
        });
    }

    /// Loads new values into a table.
    pub(super) fn load_table(&mut self, command: &Command, index: u16, table: &Arc<Table>) -> Result<(), Refusal> {
        let place = usize::from(index);
        let refuse = |code| Refusal::new(code, Object::Table(index));
        let Some(present) = self.state.tables.get(place) else {
            return Err(Refusal::new(Code::BAD_REQUEST, Object::Machine));
        };
        if present.form() != table.form() {
            let number = |table: &Table| Number::Count(table.form() as i64);
            return Err(refuse(Code::FUNCTION_TABLE_FORM).with(number(table), number(present)));
        }
        for (slot, (state, wires)) in self.state.slots.iter().zip(&self.wires).enumerate() {
            let reads = wires.tables.contains(&Some(index));
            if !reads || !state.is_active() {
                continue;
            }
            if !wires.kind.description().edits_tables {
                return Err(refuse(Code::FUNCTION_USES_TABLE).with(Number::Count(slot as i64), Number::None));
            }
            state.check_edit(wires, &self.state.tables, (index, table)).map_err(|fault| refusal(fault, slot as u16))?;
        }
        if present.cam_setting() != table.cam_setting() {
            return Err(Refusal::new(Code::BAD_REQUEST, Object::Machine));
        }
        for axis in self.state.axes.iter().filter(|axis| axis.pitch_error() == Some(index)) {
            let told = |error: PitchError| Number::Count(error.point() as i64);
            axis.check_pitch_error(table).map_err(|error| refuse(Code::PITCH_TABLE).with(told(error), Number::None))?;
        }
        if self.state.axes.iter().any(|axis| axis.cam_table() == Some(index)) {
            let shape = table.cam().map_err(|error| no_cam(index, error))?;
            let followed = present.cam().map_or(0, |shape| shape.length);
            if shape.length != followed {
                let lengths = (Number::Count(shape.length), Number::Count(followed));
                return Err(refuse(Code::CAM_OTHER_LENGTH).with(lengths.0, lengths.1));
            }
            let mut on_it = self.state.axes.iter().filter(|axis| axis.cam_table() == Some(index));
            on_it.try_for_each(|axis| axis.check_marks_on(shape))?;
        }
        if let Some(place) = self.state.tables.get_mut(place) {
            // The caller keeps a reference to the previous table, so nothing is freed here.
            place.clone_from(table);
        }
        self.count_change();
        self.accept(command, Object::Table(index));
        Ok(())
    }

    /// Replaces a program in all functions that run it.
    pub(super) fn load_program(
        &mut self,
        command: &Command,
        index: u16,
        (module, keeps): (&Arc<Module>, bool),
    ) -> Result<(), Refusal> {
        let refuse = |code| Refusal::new(code, Object::Program(index));
        let State { programs, slots, .. } = &mut self.state;
        let Some(present) = programs.get_mut(usize::from(index)) else {
            return Err(Refusal::new(Code::BAD_REQUEST, Object::Machine));
        };
        let runs_it = |wires: &Wires| wires.program == Some(index);
        let rooms =
            self.wires.iter().zip(slots.iter()).filter(|(wires, _)| runs_it(wires)).map(|(_, slot)| slot.room());
        if let Some(room) = rooms.min().filter(|room| module.pages() > *room) {
            let numbers = (Number::Count(module.pages() as i64), Number::Count(room as i64));
            return Err(refuse(Code::AMK_PROGRAM_LARGE).with(numbers.0, numbers.1));
        }
        if keeps && !lineshaft_program::is_as_long(module, present) {
            let length = |module: &Module| Number::Count(module.image().len() as i64);
            return Err(refuse(Code::AMK_OTHER_LENGTH).with(length(module), length(present)));
        }
        for (_, slot) in self.wires.iter().zip(slots.iter_mut()).filter(|(wires, _)| runs_it(wires)) {
            slot.exchange((module, present), keeps);
        }
        // The caller keeps a reference to the previous program, so nothing is freed here.
        present.clone_from(module);
        self.count_change();
        self.accept(command, Object::Program(index));
        Ok(())
    }

    /// Steps all slots of a cycle in ascending order: after the encoders and the drive inputs are read, before the axes
    /// move.
    pub(super) fn step_slots(&mut self, inputs: &Inputs) {
        let cycle_s = self.config.cycle_ns as f64 / 1e9;
        for (place, wires) in self.wires.iter().enumerate() {
            if self.state.slots.get_mut(place).is_none_or(|slot| slot.cycle_at_rest(wires, &mut self.state.board)) {
                continue;
            }
            let watched;
            let mut drives = NO_DRIVES;
            match wires.monitors {
                Monitored::Nothing => {}
                Monitored::Errors => {
                    watched = self.drive_errors();
                    drives = &watched;
                }
                Monitored::Positions => {
                    watched = self.drive_positions();
                    drives = &watched;
                }
            }
            let mark = self.distance_to_mark(wires.mark, wires.source, inputs);
            let State { slots, board, leads, tables, programs, panel, axes, cycle: now, .. } = &mut self.state;
            let Some(slot) = slots.get_mut(place) else { continue };
            let cycle = Cycle { cycle: *now, leads, tables, programs, mark, drives, cycle_s };
            let has_goal = slot.has_goal();
            if has_goal {
                fail_goal_if_axis_has_left(slot, wires.sink, axes, Leader::Sink(place as u16));
            }
            let written = slot.step(wires, &cycle, board);
            if let Some(code) = written.failed {
                let event = Event::new(Severity::Error, EventKind::Error, Object::Function(place as u16), code);
                self.events.push(event.with(Number::None, Number::Count(wires.fuel.into())));
                if let Sink::Axis(axis, _) = wires.sink {
                    self.failed.push((place as u16, axis, code));
                    if let Some(axis) = axes.get_mut(usize::from(axis)) {
                        axis.require_full_cycle();
                    }
                }
            }
            if has_goal && let Some(end) = slot.take_end() {
                self.events.push(end.event(place as u16, slot.sink()));
            }
            if let Some(of) = leads.sinks.get_mut(place) {
                *of = *slot.lead();
            }
            if let Some((state, left_out)) = slot.due_event(*now, self.config.cycle_ns) {
                let event = Event::new(Severity::Info, EventKind::State, Object::Function(place as u16), Code::NONE);
                self.events.push(event.with(Number::Count(state.into()), Number::Count(left_out.into())));
            }
            let anew = slot.coordinate_change();
            if anew != Position::ZERO {
                keep_master_positions_of_sink(axes, leads, place as u16, anew);
            }
            let outputs = if written.outputs == 0 { 0 } else { wires.lines.1 };
            for (nth, output) in wires.outputs.iter().take(outputs).enumerate() {
                if let Some(output) = output
                    && written.outputs >> nth & 1 == 1
                    && let Bit::Digital(terminal) = output.to
                {
                    panel.set_digital(terminal, (slot.outputs() >> nth & 1 == 1) != output.inverted);
                }
            }
            match wires.sink {
                Sink::Analog(terminal, _) if written.sink => panel.set_analog(terminal, slot.volts(wires)),
                // A speed is read after the motion, which the fast path skips.
                Sink::Axis(axis, _) if wires.speed.is_some() && slot.lead().change != Position::ZERO => {
                    if let Some(axis) = axes.get_mut(usize::from(axis)) {
                        axis.require_full_cycle();
                    }
                }
                _ => {}
            }
        }
    }

    /// Resets the functions that an error of their axis ends, after everything that may raise an error. Their final
    /// output is written in the next cycle.
    pub(super) fn reset_failed(&mut self, told: CycleInputs<'_>) {
        for at in 0..self.ended_by_errors.len() {
            let Some(&(place, axis)) = self.ended_by_errors.get(at) else { continue };
            let Some(slot) = self.state.slots.get_mut(usize::from(place)) else { continue };
            let fails = self.state.axes.get(usize::from(axis)).is_some_and(|axis| !axis.error().is_none());
            if fails && slot.is_active() {
                slot.reset();
                // With error_reaction 5 the axis would continue with the present command.
                self.act_on(axis.into(), told, |axis, cx| axis.stop_following_function(cx, Leader::Sink(place)));
            }
        }
    }

    /// Reports the error of a program that cannot continue on the axis that it moves. The axis holds in this cycle
    /// already, as the sink does.
    #[cold]
    pub(super) fn report_failed_functions(&mut self, told: CycleInputs<'_>) {
        while let Some((place, axis, code)) = self.failed.pop() {
            let fuel = self.wires.get(usize::from(place)).map_or(0, |wires| wires.fuel);
            self.act_on(axis.into(), told, |axis, cx| {
                axis.fail_function(cx, Leader::Sink(place), code, Number::Count(fuel.into()));
            });
        }
    }

    /// Returns the distance from the mark of this cycle to the present position of the source; for a mark of an axis,
    /// to its command. If there are several marks, the last one counts.
    fn distance_to_mark(&self, mark: Mark, source: Source, inputs: &Inputs) -> Option<Position> {
        if let Mark::Axis(place) = mark {
            return self.state.axes.get(usize::from(place))?.distance_from_index_to_command();
        }
        let Source::Lead(leader, _) = source else { return None };
        let (object, index) = match mark {
            Mark::None | Mark::Edge | Mark::Axis(_) => return None,
            Mark::Latch(entry) => (Object::Io(entry), None),
            Mark::Encoder(place) => {
                let index = inputs.encoder.get(usize::from(place)).and_then(|input| input.index);
                (Object::Encoder(place), index)
            }
        };
        let lead = self.state.leads.get(leader);
        let raw = |count: i64| match object {
            Object::Encoder(place) => self.state.encoders.get(usize::from(place)).map(|encoder| encoder.locate(count)),
            _ => None,
        };
        let latch = inputs.latch.iter().rev().find(|latch| latch.object == object && latch.edge == Edge::Rising);
        let latched =
            latch.map(|latch| locate(latch.position.and_then(raw), latch.age_ns, Some(lead), self.config.cycle_ns).0);
        let position = latched.or_else(|| index.and_then(raw).map(Position::whole))?;
        Some(lead.position - position)
    }

    /// Returns the values of the first axes that sidiff reads.
    fn drive_errors(&self) -> [Drive; LINES] {
        let mut drives = [Drive::default(); LINES];
        for (drive, first) in drives.iter_mut().zip(&self.signals.axes) {
            drive.error = self.state.board.int(AxisSignal::RegulatorError.of(*first));
        }
        for &(axis, slot) in &self.movers {
            if let (Some(drive), Some(slot)) = (drives.get_mut(axis), self.state.slots.get(usize::from(slot))) {
                drive.sak_share = slot.sak_share();
            }
        }
        drives
    }

    /// Returns the values of the first axes that fgen reads.
    fn drive_positions(&self) -> [Drive; LINES] {
        let mut drives = [Drive::default(); LINES];
        for (drive, axis) in drives.iter_mut().zip(&self.state.leads.of_axes) {
            drive.actual = axis.actual.position.floor();
        }
        drives
    }
}

//! Handling of commands before the axes: commands that concern several objects are checked for all of them, then
//! executed.

use super::{CycleInputs, MAX_COMMANDS, Machine};
use crate::axis::Axis;
use crate::code::Code;
use crate::command::{
    Action, Command, Commands, Engage, GearOut, HomeAxis, MemoryValue, Phase, PhaseSide, Probe, ProbeEdge, Synchronize,
};
use crate::config::IoKind;
use crate::drive::{ForeignEmergency, Inputs, NodeChange, NodeNotice};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::function::Order;
use crate::object::{Leader, Object};
use crate::parameter::Marker;

impl Machine {
    /// Executes and answers commands for the machine, before its inputs are read. Returns a bit set of the commands
    /// that are left for the axes.
    pub(super) fn handle_machine_commands(&mut self, commands: Commands<'_>) -> u64 {
        let (mut admitted, mut aborted_by) = (0, None);
        for (place, command) in commands.iter().enumerate() {
            let result = if place < MAX_COMMANDS {
                self.handle_machine_command(command)
            } else {
                Err(Refusal::new(Code::TOO_MANY_WAITING, Object::Machine))
            };
            match result {
                Ok(to_axes) => {
                    admitted |= u64::from(to_axes) << place;
                    if matches!(command.action, Action::Abort) {
                        aborted_by = Some(command.sequence);
                    }
                }
                Err(refusal) => self.events.push(refusal.event(command.sequence)),
            }
        }
        // The stop takes precedence in its cycle, whatever the order of the commands is.
        if aborted_by.is_some() {
            self.stop_virtual_master(aborted_by);
        }
        admitted
    }

    /// Checks that the drive whose latch a goal waits for can latch.
    fn check_latch(&self, axis: u16, source: Object) -> Result<(), Refusal> {
        let Object::Axis(source) = source else { return Ok(()) };
        let drive = self.config.axes.get(usize::from(source)).and_then(|axis| axis.drive);
        if drive.is_none_or(|offers| offers.latches) {
            return Ok(());
        }
        let refusal = Refusal::new(Code::LATCH_NOT_OFFERED, Object::Axis(axis));
        Err(refusal.with(Number::Count(source.into()), Number::None))
    }

    /// Checks that the switches that a homing searches are read. The drive of the axis may not report digital inputs.
    fn check_switches(&self, request: &HomeAxis) -> Result<(), Refusal> {
        let is_unread = self.config.global.without_inputs.contains(&Object::Axis(request.axis));
        match self.state.axes.get(usize::from(request.axis)).filter(|_| is_unread) {
            Some(axis) => axis.check_homing_switches(request.method),
            None => Ok(()),
        }
    }

    /// Checks that the edge of a probe can occur. If the input already has the level after the edge, the axis would
    /// move on to the end of the search.
    fn check_probe_input(&self, inputs: &Inputs, request: &Probe) -> Result<(), Refusal> {
        let Object::Io(entry) = request.source else { return Ok(()) };
        let level = match request.edge {
            ProbeEdge::Rising => true,
            ProbeEdge::Falling => false,
            ProbeEdge::Both | ProbeEdge::Index => return Ok(()),
        };
        let axis = self.state.axes.get(usize::from(request.axis));
        let is_allowed = axis.is_none_or(|axis| axis.parameters.probe_active_input != 0);
        let place = self.digital_inputs.iter().position(|input| *input == entry);
        let is_active = place.is_some_and(|place| self.state.panel.terminal(&self.config, place, inputs) == level);
        if is_allowed || !is_active {
            return Ok(());
        }
        let refusal = Refusal::new(Code::PROBE_INPUT_ACTIVE, Object::Axis(request.axis));
        Err(refusal.with(Number::Count(entry.into()), Number::Count(level.into())))
    }

    /// Returns true if the command is left for the axes.
    fn handle_machine_command(&mut self, command: &Command) -> Result<bool, Refusal> {
        if command.action.needs_active() && !self.state.active {
            return Err(Refusal::new(Code::NOT_ACTIVE, Object::Machine));
        }
        match &command.action {
            Action::Activate => {
                self.activate(command);
                Ok(false)
            }
            Action::Deactivate => {
                self.deactivate(command);
                Ok(true)
            }
            Action::Abort => {
                let outputs = self.config.count_io(IoKind::DigitalOutput);
                self.state.panel.abort(&self.state.axes, outputs);
                self.accept(command, Object::Machine);
                Ok(true)
            }
            Action::Enable(_)
            | Action::Disable(_)
            | Action::Halt(_)
            | Action::QuickStop(_)
            | Action::ResetErrors(_)
            | Action::Move(_)
            | Action::Probe(_)
            | Action::TouchProbe(_)
            | Action::AbortTrigger(_)
            | Action::Trajectory(_)
            | Action::QueryTrajectory(_)
            | Action::SetPosition(_)
            | Action::ShiftPosition(_)
            | Action::SetMasterPosition(_)
            | Action::Synchronize(_)
            | Action::Phase(_)
            | Action::GearOut(_)
            | Action::OutAn(_)
            | Action::Vocabulary(_)
            | Action::Cancel { .. } => Ok(true),
            Action::HomeAxis(request) => self.check_switches(request).map(|()| true),
            Action::SetEncoderPosition(request) if usize::from(request.encoder) >= self.state.encoders.len() => {
                Err(Refusal::new(Code::BAD_REQUEST, Object::Machine))
            }
            // Set after the encoders of the cycle are read.
            Action::SetEncoderPosition(_) => Ok(true),
            Action::SetParameters(changes) => {
                self.set_parameters(command, changes)?;
                Ok(false)
            }
            Action::SaveParameters(axes) => {
                self.save_parameters(command, *axes)?;
                Ok(false)
            }
            Action::ResetParameters { axes, layer } => {
                self.reset_parameters(command, *axes, *layer)?;
                Ok(false)
            }
            Action::DeleteParameters(axes) => {
                self.delete_parameters(command, *axes)?;
                Ok(false)
            }
            Action::PowerCycle => {
                self.power_cycle(command)?;
                Ok(false)
            }
            Action::SetMemory(values) => {
                let is_there = |index: u16| usize::from(index) < self.config.memory.len();
                let is_bad = |one: &&MemoryValue| !one.value.is_finite() || !is_there(one.index);
                if let Some(MemoryValue { index, value }) = values.iter().find(is_bad) {
                    let refusal = Refusal::new(Code::BAD_NUMBER, Object::Memory(*index));
                    return Err(refusal.with(Number::Real(*value), Number::None));
                }
                for MemoryValue { index, value } in values {
                    self.signals.set_memory(&mut self.state.board, *index, *value);
                }
                self.accept(command, if let [one] = **values { Object::Memory(one.index) } else { Object::Machine });
                Ok(false)
            }
            Action::CommandFunction(request) => self.command_function(command, request),
            Action::RunFunction(request) => self.run_function(command, request),
            Action::LoadTable { index, table } => {
                self.load_table(command, *index, table)?;
                Ok(false)
            }
            Action::LoadProgram { index, module, keeps } => {
                self.load_program(command, *index, (module, *keeps))?;
                Ok(false)
            }
            // An output may release something that the axes must not move.
            Action::SetOutputs(_) if !self.state.active => Err(Refusal::new(Code::NOT_ACTIVE, Object::Machine)),
            Action::SetOutputs(values) => {
                self.state.panel.set(&self.config, values)?;
                self.accept(command, if let [one] = **values { Object::Io(one.index) } else { Object::Machine });
                Ok(false)
            }
            Action::Refuse(_) => Err(Refusal::new(Code::BAD_REQUEST, Object::Machine)),
            Action::Note { code, number } => {
                let (severity, object) = self.note(*code, *number);
                let event = Event::new(severity, Kind::Warning, object, *code).of_command(command.sequence);
                self.events.push(event.with(Number::Count(*number), Number::None));
                Ok(false)
            }
        }
    }

    /// Returns the severity of a note and the object that it concerns.
    fn note(&self, code: Code, number: i64) -> (Severity, Object) {
        let notice = NodeNotice::from_number(number).filter(|_| code == Code::NODE_CHANGED);
        let axis = notice.and_then(|notice| notice.axis).filter(|axis| usize::from(*axis) < self.state.axes.len());
        let is_over = match code {
            Code::NODE_CHANGED => notice.is_some_and(|notice| notice.change == NodeChange::Ready),
            // Code 0 reports that the error has ended.
            Code::FOREIGN_EMERGENCY => ForeignEmergency::from_number(number).is_some_and(|message| message.code == 0),
            _ => false,
        };
        let severity = match code {
            _ if is_over => Severity::Info,
            Code::RECORD_LOST | Code::NODE_CHANGED | Code::FOREIGN_EMERGENCY | Code::CLOCK_STEPPED => Severity::Warn,
            _ => Severity::Error,
        };
        (severity, axis.map_or(Object::Machine, Object::Axis))
    }

    pub(super) fn accept(&mut self, command: &Command, object: Object) {
        let event = Event::new(Severity::Info, Kind::Accepted, object, Code::NONE);
        self.events.push(event.of_command(command.sequence));
    }

    /// Executes a command of the axes after all axes have moved and been monitored in this cycle, so that it is checked
    /// against the values of this cycle.
    pub(super) fn carry_out(&mut self, told: CycleInputs<'_>, command: &Command) {
        if let Err(refusal) = self.try_execute(told, command) {
            self.events.push(refusal.event(command.sequence));
        }
    }

    fn try_execute(&mut self, told: CycleInputs<'_>, command: &Command) -> Result<(), Refusal> {
        match &command.action {
            Action::Enable(axes)
            | Action::Disable(axes)
            | Action::Halt(axes)
            | Action::QuickStop(axes)
            | Action::ResetErrors(axes) => {
                self.check_axes(*axes)?;
                let mut named = axes.iter().filter_map(|index| self.state.axes.get(usize::from(index)));
                named.try_for_each(|axis| axis.admits(&command.action))?;
                self.check_skews(&command.action, *axes)?;
                self.accept(command, Object::Machine);
                axes.iter().try_for_each(|axis| self.give_to_axis(told, axis, command))
            }
            Action::Abort | Action::Deactivate => {
                (0..self.state.axes.len() as u16).try_for_each(|axis| self.give_to_axis(told, axis, command))
            }
            Action::Move(request) => self.give_to_axis(told, request.axis, command),
            Action::Probe(request) => {
                // Index pulses are reported together with the position.
                if request.edge != ProbeEdge::Index {
                    self.check_latch(request.axis, request.source)?;
                }
                self.check_probe_input(told.inputs, request)?;
                self.give_to_axis(told, request.axis, command)
            }
            Action::TouchProbe(request) => {
                if request.edge != ProbeEdge::Index {
                    self.check_latch(request.axis, request.source)?;
                }
                self.give_to_axis(told, request.axis, command)
            }
            Action::AbortTrigger(request) => self.give_to_axis(told, request.axis, command),
            Action::QueryTrajectory(request) => self.give_to_axis(told, request.axis, command),
            Action::HomeAxis(request) => self.give_to_axis(told, request.axis, command),
            Action::SetPosition(request) => {
                self.admit_shared_zero(request.axis)?;
                self.give_to_axis(told, request.axis, command)
            }
            Action::ShiftPosition(request) => {
                self.admit_shared_zero(request.axis)?;
                self.give_to_axis(told, request.axis, command)
            }
            Action::SetMasterPosition(request) => {
                self.admit_master_zero(request.axis)?;
                self.give_to_axis(told, request.axis, command)
            }
            Action::Synchronize(request) => {
                self.admit_synchronize(request)?;
                if let Engage::OnEvent(source) = request.engage {
                    self.check_latch(request.axis, source)?;
                }
                self.couples = true;
                self.give_to_axis(told, request.axis, command)
            }
            Action::Phase(request) => self.give_phase_shift(told, command.sequence, request),
            Action::GearOut(request) => self.give_gear_out(told, command.sequence, *request),
            Action::OutAn(request) => self.give_to_axis(told, request.axis, command),
            Action::Vocabulary(request) => self.give_to_axis(told, request.axis(), command),
            Action::Cancel { goal } => self.cancel(told, command.sequence, *goal),
            Action::CommandFunction(request) => {
                self.pass_order_to_axis(told, request.slot, request.order);
                Ok(())
            }
            Action::RunFunction(request) => {
                self.pass_order_to_axis(told, request.slot, Order::Start);
                Ok(())
            }
            Action::Trajectory(trajectory) => self.start_trajectory(told, command, trajectory),
            _ => Ok(()),
        }
    }

    /// Passes a command to one axis, which answers it.
    fn give_to_axis(&mut self, told: CycleInputs<'_>, axis: u16, command: &Command) -> Result<(), Refusal> {
        let given = self.act_on(axis.into(), told, |axis, cx| axis.take(cx, command));
        given.ok_or_else(|| Refusal::new(Code::BAD_REQUEST, Object::Machine))
    }

    /// Passes a phase shift to its axis, in increments of the shifted side.
    fn give_phase_shift(&mut self, told: CycleInputs<'_>, sequence: u64, request: &Phase) -> Result<(), Refusal> {
        let bad_request = || Refusal::new(Code::BAD_REQUEST, Object::Machine);
        let index = usize::from(request.axis);
        let axis = self.state.axes.get(index).ok_or_else(bad_request)?;
        let (of_slave, shift) = match &request.side {
            PhaseSide::Slave(shift) => (true, Some(*shift)),
            PhaseSide::Master { by_scale, .. } => {
                let scale = axis.leader().map(|leader| self.config.scale_of(leader));
                (false, by_scale.iter().find(|(of, _)| Some(*of) == scale).map(|(_, shift)| *shift))
            }
        };
        self.act_on(index, told, |axis, cx| axis.accept_phase(cx, sequence, of_slave, shift));
        Ok(())
    }

    /// Passes the end of a coupling to its axis, with the revolution of the leader for the condition that it waits for.
    fn give_gear_out(&mut self, told: CycleInputs<'_>, sequence: u64, request: GearOut) -> Result<(), Refusal> {
        let bad_request = || Refusal::new(Code::BAD_REQUEST, Object::Machine);
        let index = usize::from(request.axis);
        let leader = self.state.axes.get(index).ok_or_else(bad_request)?.leader();
        let turn = leader.and_then(|leader| self.config.turn_of(leader));
        self.act_on(index, told, |axis, cx| axis.start_gear_out(cx, sequence, request, turn));
        Ok(())
    }

    /// Ends a goal on all of its axes.
    fn cancel(&mut self, told: CycleInputs<'_>, sequence: u64, goal: u64) -> Result<(), Refusal> {
        let mut is_told = false;
        for index in 0..self.state.axes.len() {
            let ended = self.act_on(index, told, |axis, cx| axis.cancel(cx, sequence, goal, is_told));
            is_told |= ended == Some(true);
        }
        is_told = is_told || self.cancel_run(sequence, goal);
        let number = Number::Count(goal.cast_signed());
        let unknown = || Refusal::new(Code::UNKNOWN_GOAL, Object::Machine).with(number, Number::None);
        is_told.then_some(()).ok_or_else(unknown)
    }

    /// Checks that a coupling makes no axis follow itself.
    fn admit_synchronize(&self, request: &Synchronize) -> Result<(), Refusal> {
        let Some(axis) = self.state.axes.get(usize::from(request.axis)) else { return Ok(()) };
        let leader = axis.leader_of(request.leader, self.state.axes.len())?;
        if self.closes_loop(request.axis, leader) {
            return Err(Refusal::new(Code::LEADER_LOOP, Object::Axis(request.axis)));
        }
        if request.mode.has_marks() {
            self.check_marks(axis, leader, request)?;
        }
        Ok(())
    }

    /// Checks that the marks that a coupling needs can occur.
    fn check_marks(&self, axis: &Axis, leader: Leader, request: &Synchronize) -> Result<(), Refusal> {
        let gives = |source: Object| !self.config.global.without_index.contains(&source);
        let leads_index = match leader {
            Leader::Encoder(place) => {
                let encoder = self.state.encoders.get(usize::from(place));
                gives(Object::Encoder(place)) && encoder.is_some_and(|encoder| !encoder.is_absolute())
            }
            // The mark is defined by vmencmtyp; without an input there, it is the index pulse of the virtual master.
            Leader::Virtual => {
                let parameters = &self.state.panel.parameters;
                parameters.vmencres > 0 || parameters.virtual_marker() != Marker::Index
            }
            _ => false,
        };
        let latches = |number: u16| {
            let io = usize::from(number).checked_sub(1).and_then(|place| self.digital_inputs.get(place))?;
            self.config.io.get(usize::from(*io)).map(|io| io.latch)
        };
        let factor = if request.numerator == 0 { axis.parameters.sync_slave } else { request.numerator };
        let has_index = [leads_index, gives(axis.index_source())];
        axis.check_marks((request.mode, leader, factor), has_index, latches)
    }
}

//! Commands before the axes see them: what concerns several objects at once is checked for all of them, then done.

use super::{MAX_COMMANDS, Machine};
use crate::code::Code;
use crate::command::{Action, Command, Commands, Probe, ProbeEdge, Synchronize};
use crate::config::IoKind;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;

impl Machine {
    /// Answers what is answered here and returns which commands the axes have to look at, as bits.
    pub(super) fn admit(&mut self, commands: Commands<'_>) -> u64 {
        let mut admitted = 0;
        let mut couples = false;
        for (place, command) in commands.iter().enumerate() {
            if place == 0 {
                self.note_couplings();
            }
            let result = if place < MAX_COMMANDS {
                self.admit_one(command)
            } else {
                Err(Refusal::new(Code::TOO_MANY_WAITING, Object::Machine))
            };
            match result {
                Ok(to_axes) => {
                    admitted |= u64::from(to_axes) << place;
                    couples |= to_axes && matches!(command.action, Action::Synchronize(_));
                }
                Err(refusal) => self.events.push(refusal.event(command.sequence)),
            }
        }
        self.couples = couples;
        admitted
    }

    /// Can the drive latch whose latch a goal waits for?
    fn check_latch(&self, request: &Probe) -> Result<(), Refusal> {
        let Object::Axis(source) = request.source else { return Ok(()) };
        let axis = self.config.axes.get(usize::from(source));
        let latches = axis.and_then(|axis| axis.drive).is_none_or(|offers| offers.latches);
        // Index pulses come with the position.
        if latches || request.edge == ProbeEdge::Index {
            return Ok(());
        }
        let refusal = Refusal::new(Code::LATCH_NOT_OFFERED, Object::Axis(request.axis));
        Err(refusal.with(Number::Count(source.into()), Number::None))
    }

    pub(super) fn note_couplings(&mut self) {
        for (coupling, axis) in self.couplings.iter_mut().zip(&self.state.axes) {
            *coupling = axis.leader();
        }
    }

    /// True where the axes have to look at the command.
    fn admit_one(&mut self, command: &Command) -> Result<bool, Refusal> {
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
            Action::Enable(axes)
            | Action::Disable(axes)
            | Action::Halt(axes)
            | Action::QuickStop(axes)
            | Action::ResetErrors(axes) => {
                self.check_axes(*axes)?;
                self.state.axes.iter().try_for_each(|axis| axis.admits(&command.action))?;
                self.accept(command, Object::Machine);
                Ok(true)
            }
            Action::Synchronize(request) => self.admit_synchronize(request),
            Action::Probe(request) => {
                self.check_latch(request)?;
                Ok(true)
            }
            Action::Move(_)
            | Action::HomeAxis(_)
            | Action::Saia(_)
            | Action::Wf(_)
            | Action::Cancel { .. }
            | Action::Trajectory(_) => Ok(true),
            Action::SetEncoderPosition(request) if usize::from(request.encoder) >= self.state.encoders.len() => {
                Err(Refusal::new(Code::BAD_REQUEST, Object::Machine))
            }
            // Once the encoders of the cycle are read.
            Action::SetEncoderPosition(_) => Ok(true),
            Action::SetPosition(request) => {
                self.admit_shared_zero(request.axis)?;
                Ok(true)
            }
            Action::SetMasterPosition(request) => {
                self.admit_master_zero(request.axis)?;
                Ok(true)
            }
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
            Action::SetMemory { index, value } => {
                let object = Object::Memory(*index);
                if !value.is_finite() || !self.signals.set_memory(&mut self.state.board, *index, *value) {
                    return Err(Refusal::new(Code::BAD_NUMBER, object).with(Number::Real(*value), Number::None));
                }
                self.accept(command, object);
                Ok(false)
            }
            // An output may let go what the axes are not to move.
            Action::SetOutputs(_) if !self.state.active => Err(Refusal::new(Code::NOT_ACTIVE, Object::Machine)),
            Action::SetOutputs(values) => {
                self.state.panel.set(&self.config, values)?;
                self.accept(command, if let [one] = **values { Object::Io(one.index) } else { Object::Machine });
                Ok(false)
            }
            Action::Refuse(_) => Err(Refusal::new(Code::BAD_REQUEST, Object::Machine)),
            Action::Note { code, number } => {
                let severity = if *code == Code::RECORD_LOST { Severity::Warn } else { Severity::Error };
                let event = Event::new(severity, Kind::Warning, Object::Machine, *code).of_command(command.sequence);
                self.events.push(event.with(Number::Count(*number), Number::None));
                Ok(false)
            }
        }
    }

    pub(super) fn accept(&mut self, command: &Command, object: Object) {
        let event = Event::new(Severity::Info, Kind::Accepted, object, Code::NONE);
        self.events.push(event.of_command(command.sequence));
    }

    fn admit_synchronize(&mut self, request: &Synchronize) -> Result<bool, Refusal> {
        // An axis that does not exist is answered at the end of the cycle.
        let Some(axis) = self.state.axes.get(usize::from(request.axis)) else { return Ok(true) };
        let leader = axis.leader_of(request.leader, self.state.axes.len())?;
        if self.closes_loop(request.axis, leader) {
            return Err(Refusal::new(Code::LEADER_LOOP, Object::Axis(request.axis)));
        }
        // Should the axis refuse, the note only keeps others of this cycle from closing a loop with it.
        if let Some(coupling) = self.couplings.get_mut(usize::from(request.axis)) {
            *coupling = Some(leader);
        }
        Ok(true)
    }

    /// What no axis has answered: a goal that is not active, an axis that does not exist.
    pub(super) fn answer_the_rest(&mut self, commands: Commands<'_>, left: u64) {
        for (place, command) in commands.iter().take(MAX_COMMANDS).enumerate() {
            let refusal = match command.action {
                Action::Cancel { goal } => {
                    let goal = Number::Count(goal.cast_signed());
                    Refusal::new(Code::UNKNOWN_GOAL, Object::Machine).with(goal, Number::None)
                }
                Action::Move(_)
                | Action::Probe(_)
                | Action::HomeAxis(_)
                | Action::SetPosition(_)
                | Action::SetMasterPosition(_)
                | Action::Synchronize(_)
                | Action::Saia(_)
                | Action::Wf(_) => Refusal::new(Code::BAD_REQUEST, Object::Machine),
                _ => continue,
            };
            if left >> place & 1 == 1 {
                self.events.push(refusal.event(command.sequence));
            }
        }
    }
}

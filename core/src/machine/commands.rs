//! Commands before the axes see them: what concerns several objects at once is checked for all of them, then done.

use super::{MAX_COMMANDS, Machine};
use crate::code::Code;
use crate::command::{Action, Command, Commands, Synchronize};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::parameter::{AxisParameters, Change, ROWS, Range, Refused, Row, Value};

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

    pub(super) fn note_couplings(&mut self) {
        for (coupling, axis) in self.couplings.iter_mut().zip(&self.state.axes) {
            *coupling = axis.leader();
        }
    }

    /// True where the axes have to look at the command.
    fn admit_one(&mut self, command: &Command) -> Result<bool, Refusal> {
        match &command.action {
            Action::Enable(axes)
            | Action::Disable(axes)
            | Action::Halt(axes)
            | Action::QuickStop(axes)
            | Action::ResetErrors(axes) => {
                if axes.iter().any(|axis| usize::from(axis) >= self.state.axes.len()) {
                    return Err(Refusal::new(Code::BAD_REQUEST, Object::Machine));
                }
                self.state.axes.iter().try_for_each(|axis| axis.admits(&command.action))?;
                self.accept(command, Object::Machine);
                Ok(true)
            }
            Action::Synchronize(request) => self.admit_synchronize(request),
            Action::Move(_) | Action::Probe(_) | Action::Saia(_) | Action::Wf(_) | Action::Cancel { .. } => Ok(true),
            Action::SetParameters(changes) => {
                self.set_parameters(command, changes)?;
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
            Action::Refuse(_) => Err(Refusal::new(Code::BAD_REQUEST, Object::Machine)),
            Action::Note { code, number } => {
                let severity = if *code == Code::RECORD_LOST { Severity::Warn } else { Severity::Error };
                let event = Event::new(severity, Kind::Warning, Object::Machine, *code).of_command(command.sequence);
                self.events.push(event.with(Number::Count(*number), Number::None));
                Ok(false)
            }
        }
    }

    fn accept(&mut self, command: &Command, object: Object) {
        let event = Event::new(Severity::Info, Kind::Accepted, object, Code::NONE);
        self.events.push(event.of_command(command.sequence));
    }

    fn admit_synchronize(&mut self, request: &Synchronize) -> Result<bool, Refusal> {
        if self.closes_loop(request.axis, request.leader) {
            return Err(Refusal::new(Code::LEADER_LOOP, Object::Axis(request.axis)));
        }
        // Should the axis refuse, the note only keeps others of this cycle from closing a loop with it.
        if let Some(coupling) = self.couplings.get_mut(usize::from(request.axis)) {
            *coupling = Some(request.leader);
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
                Action::Move(_) | Action::Probe(_) | Action::Synchronize(_) | Action::Saia(_) | Action::Wf(_) => {
                    Refusal::new(Code::BAD_REQUEST, Object::Machine)
                }
                _ => continue,
            };
            if left >> place & 1 == 1 {
                self.events.push(refusal.event(command.sequence));
            }
        }
    }

    /// Sets all of them, or none.
    fn set_parameters(&mut self, command: &Command, changes: &[Change]) -> Result<(), Refusal> {
        for change in changes {
            let axis = self.state.axes.get(usize::from(change.axis));
            let axis = axis.ok_or(Refusal::new(Code::BAD_REQUEST, Object::Machine))?;
            self.candidates[usize::from(change.axis)] = axis.parameters;
        }
        for change in changes {
            let row = ROWS.get(usize::from(change.row));
            let row = row.ok_or(Refusal::new(Code::BAD_REQUEST, Object::Machine))?;
            let candidate = &mut self.candidates[usize::from(change.axis)];
            row.assign(candidate, change.value).map_err(|refused| refusal_of(change, refused))?;
        }
        changes.iter().try_for_each(|change| self.check_candidate(change))?;
        for change in changes {
            let index = usize::from(change.axis);
            self.state.axes[index].parameters = self.candidates[index];
        }
        self.accept(command, changes.first().map_or(Object::Machine, Change::object));
        for change in changes {
            let event = Event::new(Severity::Info, Kind::Parameter, change.object(), Code::NONE);
            let event = event.of_command(command.sequence).with(change.number(), Number::None);
            self.events.push(Event { parameter: Some(change.row), ..event });
        }
        Ok(())
    }

    /// The whole set of an axis must agree, with itself and with what the axis is doing.
    fn check_candidate(&self, change: &Change) -> Result<(), Refusal> {
        let index = usize::from(change.axis);
        self.state.axes[index].admits_selector(&self.candidates[index], self.state.cycle, &self.state.leads)?;
        let (axis, candidate) = (&self.state.axes[index], &self.candidates[index]);
        let refuse = |code| Refusal { parameter: Some(change.row), ..Refusal::new(code, change.object()) };
        if let Err((low, high)) = candidate.check() {
            let key = ROWS.get(usize::from(change.row)).map_or("", |row| row.key);
            // The change that is one of the two is to blame; if this one is not, the other change of the set is.
            let other = match key {
                key if key == low => high,
                key if key == high => low,
                _ => return Ok(()),
            };
            let other = Row::find(other)
                .map_or(Number::None, |(row, entry)| Change { row, value: (entry.get)(candidate), ..*change }.number());
            return Err(refuse(Code::PARAMETERS_CONTRADICT).with(change.number(), other));
        }
        let inside = |end: i64| {
            candidate.min_position.is_none_or(|low| end >= low) && candidate.max_position.is_none_or(|high| end <= high)
        };
        let limits = |p: &AxisParameters| (p.min_position, p.max_position);
        // On its way back from outside, an axis takes any other change.
        let reach = axis.reach().filter(|_| limits(candidate) != limits(&axis.parameters));
        match reach.and_then(|(low, high)| [low, high].into_iter().find(|&place| !inside(place))) {
            Some(place) => {
                let numbers = (change.number(), Number::Position(place));
                Err(refuse(Code::GOAL_BEYOND_NEW_LIMITS).with(numbers.0, numbers.1))
            }
            None => Ok(()),
        }
    }
}

fn refusal_of(change: &Change, refused: Refused) -> Refusal {
    let code = match refused {
        Refused::NotBuilt => Code::NOT_BUILT,
        Refused::OutOfRange | Refused::WrongType => Code::PARAMETER_OUT_OF_RANGE,
    };
    let row = ROWS.get(usize::from(change.row));
    let limit = match row.map(|row| row.range) {
        Some(Range::Int(_, high)) => Change { value: Value::Int(high), ..*change }.number(),
        Some(Range::PositiveUpTo(high) | Range::Real(_, high)) => {
            Change { value: Value::Real(high), ..*change }.number()
        }
        None => Number::None,
    };
    let refusal = Refusal::new(code, change.object()).with(change.number(), limit);
    Refusal { parameter: Some(change.row), ..refusal }
}

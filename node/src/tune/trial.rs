//! The trial: an axis is enabled, excited, and disabled, cycle by cycle.
//!
//! Law      enable | excitation by OUTAN, a command where the value is another one | disable, whatever ends it. What was put out in a
//!          cycle and where the axis was then makes the record
//! Reads    signals and events of the cycle before
//! Writes   commands for this cycle, the record
//! Refuses  an axis that is neither off nor at rest, or has no room
//! Source   MACS-CMD-28
//!
//! It takes no memory between its beginning and its end.

use super::setting::{Setting, Unfit};
use lineshaft_core::command::{Action, Command, OutAn, Source};
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::signal::Signal;
use lineshaft_core::state::AxisState;
use lineshaft_tune::{Abort, Drive, Excitation, Record};

/// How a trial ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ended {
    /// With a whole record.
    Done,
    /// The excitation gave up.
    Aborted(Abort),
    /// An error of the axis, or a refusal: its event.
    Failed(Event),
    /// Somebody else moved or stopped it: its state.
    Interrupted(i64),
    /// Too little room: the travel that there is (inc).
    NoRoom(f64),
    /// Nothing came in time.
    Late,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Begin,
    Enabling { left: u32 },
    Exciting,
    Disabling { ended: Ended, left: u32 },
    Over(Ended),
}

/// Signals of the axis.
#[derive(Clone, Copy, Debug)]
struct Signals {
    state: Signal,
    position: Signal,
}

/// Time for enabling and disabling, brakes and stops included (s).
const SWITCH_TIME: f64 = 10.0;
/// Of a velocity between two cycles (the rest is what it was).
const SMOOTHING: f64 = 0.3;
/// A command is given again where it changes by more than this part of the permitted one.
const STEP: f64 = 1.0 / 512.0;
/// Longest record in times of ramp and duration.
const LONGEST: f64 = 8.0;
/// Most cycles of a record.
const MOST_CYCLES: f64 = 2e6;

// As `x.state` shows them.
const DISABLED: i64 = AxisState::Disabled as i64;
const STANDSTILL: i64 = AxisState::Standstill as i64;
const CONTINUOUS_MOTION: i64 = AxisState::ContinuousMotion as i64;
const ERROR_STOP: i64 = AxisState::ErrorStop as i64;

/// A trial between two cycles.
#[derive(Debug)]
pub struct Trial {
    setting: Setting,
    signals: Signals,
    excitation: Excitation,
    record: Record,
    phase: Phase,
    /// Number of the last command, and what it has put out.
    given: u64,
    sent: f64,
    start: i64,
    before: i64,
    velocity: f64,
}

impl Trial {
    /// Before its first cycle.
    ///
    /// # Errors
    /// A bound that no excitation takes.
    pub fn new(setting: Setting, machine: &Machine) -> Result<Self, Unfit> {
        let p = setting.permitted;
        let name = machine.config().axes.get(usize::from(setting.axis)).map_or("", |axis| axis.name.as_str());
        let find = |of: &str| machine.directory().find(&format!("{name}.{of}"));
        let (Some(state), Some(position)) = (find("state"), find("actual.position")) else {
            return Err(Unfit::unknown(machine.config(), name));
        };
        let cycles = (LONGEST * (p.ramp + p.duration) / p.cycle).min(MOST_CYCLES);
        Ok(Self {
            setting,
            signals: Signals { state, position },
            excitation: Excitation::new(p).map_err(|error| Unfit::Excitation { axis: name.to_owned(), error })?,
            record: Record::with_capacity(p.cycle, p.takes, cycles as usize),
            phase: Phase::Begin,
            given: 0,
            sent: 0.0,
            start: 0,
            before: 0,
            velocity: 0.0,
        })
    }

    /// How it ended, once it is over and the axis off.
    pub fn ended(&self) -> Option<Ended> {
        match self.phase {
            Phase::Over(ended) => Some(ended),
            _ => None,
        }
    }

    /// What was seen.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The command of this cycle, by what the cycle before has shown; `number` is what it gets.
    pub fn before(&mut self, machine: &Machine, number: u64) -> Option<Command> {
        let action = self.step(machine)?;
        self.given = number;
        Some(Command { sequence: number, source: Source::Cli, action })
    }

    fn step(&mut self, machine: &Machine) -> Option<Action> {
        let state = machine.board().int(self.signals.state);
        let axes = AxisSet::one(self.setting.axis);
        if let Some(failure) = self.failure(machine)
            && !matches!(self.phase, Phase::Disabling { .. } | Phase::Over(_))
        {
            return self.end(state, Ended::Failed(failure));
        }
        match self.phase {
            Phase::Begin if matches!(state, DISABLED | STANDSTILL) => {
                self.phase = Phase::Enabling { left: self.switch_cycles() };
                (state == DISABLED).then_some(Action::Enable(axes))
            }
            Phase::Begin => {
                self.phase = Phase::Over(Ended::Interrupted(state));
                None
            }
            Phase::Enabling { .. } if state == STANDSTILL => self.begin(machine),
            Phase::Enabling { left } => match left.checked_sub(1) {
                Some(left) => {
                    self.phase = Phase::Enabling { left };
                    None
                }
                None => self.end(state, Ended::Late),
            },
            Phase::Exciting if state != CONTINUOUS_MOTION => self.end(state, Ended::Interrupted(state)),
            Phase::Exciting => self.excite(machine, state),
            Phase::Disabling { ended, left } => {
                let is_off = matches!(state, DISABLED | ERROR_STOP);
                match left.checked_sub(1).filter(|_| !is_off) {
                    Some(left) => self.phase = Phase::Disabling { ended, left },
                    None => self.phase = Phase::Over(ended),
                }
                None
            }
            Phase::Over(_) => None,
        }
    }

    /// The refusal of its last command, or the error of the axis.
    fn failure(&self, machine: &Machine) -> Option<Event> {
        let object = Object::Axis(self.setting.axis);
        let is_it = |event: &&Event| match event.kind {
            Kind::Refused => self.given != 0 && event.command == self.given,
            Kind::Error => event.source == object,
            _ => false,
        };
        machine.events().iter().find(is_it).copied()
    }

    fn switch_cycles(&self) -> u32 {
        // Saturates.
        (SWITCH_TIME / self.setting.permitted.cycle) as u32
    }

    fn end(&mut self, state: i64, ended: Ended) -> Option<Action> {
        self.phase = Phase::Disabling { ended, left: self.switch_cycles() };
        (state != DISABLED).then_some(Action::Disable(AxisSet::one(self.setting.axis)))
    }

    /// At rest and enabled: the position loop opens with the first value.
    fn begin(&mut self, machine: &Machine) -> Option<Action> {
        let position = machine.board().int(self.signals.position);
        let permitted = match self.setting.at(position) {
            Ok(permitted) => permitted,
            Err(travel) => return self.end(STANDSTILL, Ended::NoRoom(travel)),
        };
        // It was checked with larger bounds.
        if let Ok(excitation) = Excitation::new(permitted) {
            self.excitation = excitation;
        }
        (self.start, self.before) = (position, position);
        self.record.push(0.0, position);
        self.phase = Phase::Exciting;
        Some(self.ask(0.0))
    }

    fn ask(&mut self, value: f64) -> Action {
        self.sent = value;
        Action::OutAn(OutAn { axis: self.setting.axis, value, level: self.setting.level })
    }

    fn excite(&mut self, machine: &Machine, state: i64) -> Option<Action> {
        let position = machine.board().int(self.signals.position);
        let moved = position.wrapping_sub(self.before) as f64 / self.setting.permitted.cycle;
        self.velocity += SMOOTHING * (moved - self.velocity);
        self.before = position;
        if self.record.commands.len() == self.record.commands.capacity() {
            return self.end(state, Ended::Late);
        }
        self.record.push(self.sent, position);
        match self.excitation.next(position.wrapping_sub(self.start) as f64, self.velocity) {
            Drive::Command(value) => {
                let is_other = (value - self.sent).abs() > STEP * self.setting.permitted.command;
                let change = (value - self.sent).max(-self.setting.slew).min(self.setting.slew);
                is_other.then(|| self.ask(self.sent + change))
            }
            Drive::Done(_) => self.end(state, Ended::Done),
            Drive::Aborted(abort) => self.end(state, Ended::Aborted(abort)),
        }
    }
}

#[cfg(test)]
mod tests;

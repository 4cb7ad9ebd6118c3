//! Trial: enables, excites and disables an axis, cycle by cycle.
//!
//! Law      enable | excitation by OUTAN, with a command whenever the value changes | disable, whatever the reason of
//!          the end. The record has the output and the position of each cycle; for a missed cycle, during which a real
//!          drive continues, they are interpolated linearly
//! Reads    signals and events of the previous cycle; whether the trial was stopped
//! Writes   the command of this cycle, the record
//! Refuses  an axis that is neither off nor at standstill, has too little room, is not homed although that is required,
//!          or leads others
//! Source   MACS-CMD-28
//!
//! It does not allocate between its start and its end.

use super::setting::{Setting, Unfit};
use crate::recording::encoder::sentence;
use lineshaft_core::command::{Action, Command, OutAn, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::drive::DriveState;
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::signal::{Directory, Signal};
use lineshaft_core::state::{AXIS_STATES, AxisState};
use lineshaft_tune::{Abort, Excitation, ExcitationOutput, Record};

/// Reason why a trial was stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Cancelled by the client that began it.
    Cancel,
    /// Another client stopped the axis.
    Halt,
    /// A cycle had no room for its command.
    NoRoom,
    /// No cycles run any more.
    NoCycles,
}

/// End of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ended {
    /// The record is complete.
    Done,
    /// The excitation was aborted.
    Aborted(Abort),
    /// An error of the axis, or a refusal, with its event.
    Failed(Event),
    /// Another client moved or stopped the axis; its state.
    Interrupted(i64),
    /// There is too little room; the available travel, in inc.
    NoRoom(f64),
    /// This number of cycles was missed in a row.
    Missed(i64),
    /// The trial was stopped.
    Stopped(Stop),
    /// Axes follow it, which would be excited, too; the first of them.
    Leads(u16),
    /// The axis is not homed, but must be.
    NotHomed,
    /// The axis was not off within the time after the disable command.
    NotOff,
    /// There was no reaction in time.
    Late,
}

impl Ended {
    /// Returns the reason why the record is incomplete; `None` if it is complete.
    pub fn sentence(self, config: &MachineConfig, setting: &Setting) -> Option<String> {
        Some(match self {
            Self::Done => return None,
            Self::Aborted(abort) => abort.to_string(),
            Self::Failed(event) => format!("{} (code {})", sentence(&event, std::iter::empty(), config), event.code.0),
            Self::Interrupted(state) => {
                let name = usize::try_from(state).ok().and_then(|place| AXIS_STATES.get(place)).unwrap_or(&"unknown");
                format!("somebody else has stopped or moved it; it is in state {name}")
            }
            Self::NoRoom(travel) => format!(
                "the software limits leave {:.0} inc either way of where it stands; a travel of {:.0} inc was asked for",
                travel.max(0.0),
                setting.permitted.travel
            ),
            Self::Missed(cycles) => {
                format!(
                    "the machine has missed {cycles} cycles in a row; {MOST_MISSED} at most leave a record that tells something"
                )
            }
            Self::Stopped(Stop::Cancel) => "it was stopped before its end".to_owned(),
            Self::Stopped(Stop::Halt) => "somebody else has stopped it".to_owned(),
            Self::Stopped(Stop::NoRoom) => {
                "as many stops came in one cycle as it takes; there was no room for a command".to_owned()
            }
            Self::Stopped(Stop::NoCycles) => "the cycles have ended".to_owned(),
            Self::Leads(other) => {
                let name = config.axes.get(usize::from(other)).map_or("another axis", |axis| axis.name.as_str());
                format!("{name} follows it and would be shaken, too; end that first")
            }
            Self::NotHomed => "homing is required, and it has no reference".to_owned(),
            Self::NotOff => format!("it is not off {SWITCH_TIME} s after it was asked to be"),
            Self::Late => "it took too long, which an excitation of this axis should not".to_owned(),
        })
    }
}

/// Present action of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// Switches the axis on.
    Enabling,
    /// Excites the axis.
    Exciting,
    /// Stops the axis and switches it off.
    Disabling,
    /// Finished.
    Nothing,
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
    enabled: Signal,
    drive_state: Signal,
    homed: Signal,
    overruns: Signal,
}

/// Time for enabling and disabling, including brakes and stops, in s.
const SWITCH_TIME: f64 = 10.0;
/// Weight of the velocity between two cycles (the rest is the previous value).
const SMOOTHING: f64 = 0.3;
/// Change of a command, as a fraction of the permitted one, beyond which it is sent again.
const STEP: f64 = 1.0 / 512.0;
/// Maximum duration of a record, as a multiple of ramp and duration.
const LONGEST: f64 = 8.0;
/// Maximum number of cycles missed in a row.
const MOST_MISSED: i64 = 10;
/// Maximum number of cycles of a record.
const MOST_CYCLES: f64 = 2e6;

// Values of `x.state`.
const DISABLED: i64 = AxisState::Disabled as i64;
const STANDSTILL: i64 = AxisState::Standstill as i64;
const OPERATION_ENABLED: i64 = DriveState::Enabled as i64;
const QUICK_STOP_ACTIVE: i64 = DriveState::QuickStop as i64;
const CONTINUOUS_MOTION: i64 = AxisState::ContinuousMotion as i64;

/// State of a trial between two cycles.
#[derive(Debug)]
pub struct Trial {
    setting: Setting,
    source: Source,
    signals: Signals,
    excitation: Excitation,
    record: Record,
    phase: Phase,
    stopped: Option<Stop>,
    /// Number of the last command.
    given: u64,
    sent: f64,
    start: i64,
    before: i64,
    /// Whether the drive is a real one, which continues while cycles are missed; a simulated one does not.
    goes_on: bool,
    /// Number of cycles missed so far.
    overruns: i64,
    velocity: f64,
}

impl Trial {
    /// Creates a trial before its first cycle, for a machine with that configuration; its commands are those of
    /// `source`.
    ///
    /// # Errors
    /// Returns an error if a bound is not permitted for an excitation.
    pub fn new(setting: Setting, source: Source, config: &MachineConfig, directory: &Directory) -> Result<Self, Unfit> {
        let p = setting.permitted;
        let name = config.axes.get(usize::from(setting.axis)).map_or("", |axis| axis.name.as_str());
        let find = |of: &str| directory.find(&format!("{name}.{of}"));
        let signals = || {
            Some(Signals {
                state: find("state")?,
                position: find("actual.position")?,
                enabled: find("enabled")?,
                drive_state: find("drive_state")?,
                homed: find("homed")?,
                overruns: directory.find("machine.overruns")?,
            })
        };
        let Some(signals) = signals() else {
            return Err(Unfit::unknown(config, name));
        };
        let cycles = (LONGEST * (p.ramp + p.duration) / p.cycle).min(MOST_CYCLES);
        Ok(Self {
            setting,
            source,
            signals,
            excitation: Excitation::new(p).map_err(|error| Unfit::Excitation { axis: name.to_owned(), error })?,
            record: Record::with_capacity(p.cycle, p.takes, cycles as usize),
            phase: Phase::Begin,
            stopped: None,
            given: 0,
            sent: 0.0,
            start: 0,
            before: 0,
            goes_on: false,
            overruns: 0,
            velocity: 0.0,
        })
    }

    /// Marks the drive as a real one, which continues while cycles are missed.
    pub fn of_real(self) -> Self {
        Self { goes_on: true, ..self }
    }

    /// Returns how the trial ended, once it has ended and the axis is off.
    pub fn ended(&self) -> Option<Ended> {
        match self.phase {
            Phase::Over(ended) => Some(ended),
            _ => None,
        }
    }

    /// Returns the record.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Returns the setting.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }

    /// Returns the present action, and the finished fraction of the excitation, 0 to 1.
    pub fn progress(&self) -> (Doing, f64) {
        match self.phase {
            Phase::Begin | Phase::Enabling { .. } => (Doing::Enabling, 0.0),
            Phase::Exciting => (Doing::Exciting, self.excitation.progress()),
            Phase::Disabling { .. } => (Doing::Disabling, self.excitation.progress()),
            Phase::Over(_) => (Doing::Nothing, self.excitation.progress()),
        }
    }

    /// Stops the axis and switches it off, from the next cycle on.
    pub fn stop(&mut self, why: Stop) {
        self.stopped = self.stopped.or(Some(why));
    }

    /// Ends the trial without further cycles; the machine ends running motions by itself.
    pub fn give_up(&mut self) {
        if self.ended().is_none() {
            self.phase = Phase::Over(Ended::Stopped(Stop::NoCycles));
        }
    }

    /// Returns the command of this cycle, according to the previous cycle; `number` returns its command number.
    pub fn before(&mut self, machine: &Machine, number: impl FnOnce() -> u64) -> Option<Command> {
        let action = self.step(machine)?;
        self.given = number();
        Some(Command { sequence: self.given, source: self.source, action })
    }

    fn step(&mut self, machine: &Machine) -> Option<Action> {
        let state = machine.board().int(self.signals.state);
        let axes = AxisSet::one(self.setting.axis);
        if let Some(failure) = self.failure(machine)
            && !matches!(self.phase, Phase::Disabling { .. } | Phase::Over(_))
        {
            return self.end(Ended::Failed(failure));
        }
        match self.phase {
            Phase::Begin if let Some(why) = self.start_refusal(machine, state) => {
                self.phase = Phase::Over(why);
                None
            }
            Phase::Enabling { .. } | Phase::Exciting if let Some(why) = self.stopped => self.end(Ended::Stopped(why)),
            Phase::Begin => {
                self.phase = Phase::Enabling { left: self.switch_cycles() };
                (state == DISABLED).then_some(Action::Enable(axes))
            }
            Phase::Enabling { .. } if state == STANDSTILL => self.begin(machine),
            Phase::Enabling { .. } if state != DISABLED => self.end(Ended::Interrupted(state)),
            Phase::Enabling { left } => match left.checked_sub(1) {
                Some(left) => {
                    self.phase = Phase::Enabling { left };
                    None
                }
                None => self.end(Ended::Late),
            },
            Phase::Exciting if state != CONTINUOUS_MOTION => self.end(Ended::Interrupted(state)),
            Phase::Exciting => self.excite(machine),
            Phase::Disabling { ended, left } => {
                self.phase = match left.checked_sub(1) {
                    _ if self.is_off(machine) => Phase::Over(ended),
                    Some(left) => Phase::Disabling { ended, left },
                    None => Phase::Over(Ended::NotOff),
                };
                None
            }
            Phase::Over(_) => None,
        }
    }

    /// Returns the refusal of its last command, or the error of the axis.
    fn failure(&self, machine: &Machine) -> Option<Event> {
        let object = Object::Axis(self.setting.axis);
        let is_enabling = matches!(self.phase, Phase::Enabling { .. });
        let is_it = |event: &&Event| match event.kind {
            Kind::Refused => self.given != 0 && event.command == self.given,
            // The enable command was ended by another command.
            Kind::Done => event.command == self.given && is_enabling && !event.code.succeeds(),
            Kind::Error => event.source == object,
            _ => false,
        };
        machine.events().iter().find(is_it).copied()
    }

    fn switch_cycles(&self) -> u32 {
        // The cast saturates.
        (SWITCH_TIME / self.setting.permitted.cycle) as u32
    }

    /// Whether the drive has no power. The state remains that of a quick stop until a reset.
    fn is_off(&self, machine: &Machine) -> bool {
        let drive = machine.board().int(self.signals.drive_state);
        !machine.board().bit(self.signals.enabled) && !matches!(drive, OPERATION_ENABLED | QUICK_STOP_ACTIVE)
    }

    /// Returns the reason why the trial must not begin.
    fn start_refusal(&self, machine: &Machine, state: i64) -> Option<Ended> {
        if let Some(why) = self.stopped {
            return Some(Ended::Stopped(why));
        }
        if !matches!(state, DISABLED | STANDSTILL) {
            return Some(Ended::Interrupted(state));
        }
        if let Some(follower) = machine.followers(self.setting.axis).pop() {
            return Some(Ended::Leads(follower));
        }
        let is_homed = !self.setting.needs_reference || machine.board().bit(self.signals.homed);
        (!is_homed).then_some(Ended::NotHomed)
    }

    /// Disables the axis in any state, because the state of an axis that is being switched on does not show it yet.
    fn end(&mut self, ended: Ended) -> Option<Action> {
        self.phase = Phase::Disabling { ended, left: self.switch_cycles() };
        Some(Action::Disable(AxisSet::one(self.setting.axis)))
    }

    /// Begins at standstill with the axis enabled: the first value opens the position loop.
    fn begin(&mut self, machine: &Machine) -> Option<Action> {
        let position = machine.board().int(self.signals.position);
        let permitted = match self.setting.at(position) {
            Ok(permitted) => permitted,
            Err(travel) => return self.end(Ended::NoRoom(travel)),
        };
        if let Some(follower) = machine.followers(self.setting.axis).pop() {
            return self.end(Ended::Leads(follower));
        }
        // It was checked with larger bounds.
        if let Ok(excitation) = Excitation::new(permitted) {
            self.excitation = excitation;
        }
        (self.start, self.before) = (position, position);
        self.overruns = machine.board().int(self.signals.overruns);
        self.record.push(0.0, position);
        self.phase = Phase::Exciting;
        Some(self.ask(0.0))
    }

    fn ask(&mut self, value: f64) -> Action {
        self.sent = value;
        Action::OutAn(OutAn { axis: self.setting.axis, value, level: self.setting.level })
    }

    fn excite(&mut self, machine: &Machine) -> Option<Action> {
        let position = machine.board().int(self.signals.position);
        let overruns = machine.board().int(self.signals.overruns);
        let missed = overruns.saturating_sub(std::mem::replace(&mut self.overruns, overruns));
        let missed = if self.goes_on { missed } else { 0 };
        if missed > MOST_MISSED {
            return self.end(Ended::Missed(missed));
        }
        let (before, cycles) = (std::mem::replace(&mut self.before, position), missed + 1);
        let way = position.wrapping_sub(before);
        let moved = way as f64 / (cycles as f64 * self.setting.permitted.cycle);
        self.velocity += SMOOTHING * (moved - self.velocity);
        let room = self.record.commands.capacity() - self.record.commands.len();
        if room < cycles as usize {
            return self.end(Ended::Late);
        }
        // The drive had the same command during the missed cycles.
        for cycle in 1..=cycles {
            self.record.push(self.sent, before.wrapping_add(way.wrapping_mul(cycle) / cycles));
        }
        match self.excitation.next(position.wrapping_sub(self.start) as f64, self.velocity) {
            ExcitationOutput::Command(value) => {
                let is_other = (value - self.sent).abs() > STEP * self.setting.permitted.command;
                let change = (value - self.sent).max(-self.setting.slew).min(self.setting.slew);
                is_other.then(|| self.ask(self.sent + change))
            }
            ExcitationOutput::Done(_) => self.end(Ended::Done),
            ExcitationOutput::Aborted(abort) => self.end(Ended::Aborted(abort)),
        }
    }
}

#[cfg(test)]
mod tests;

//! One axis: from its drive's inputs to its drive's outputs, once per cycle.
//!
//! Law      sense (all axes first) | supervise | advance the generator to t_k | apply this cycle's commands | judge | command the drive
//! Reads    the drive's inputs, the leaders that stand earlier in the order, the commands that name the axis
//! Writes   its signals, its drive's outputs, events
//! Refuses  each command with a code and the numbers of its sentence; a refused command changes nothing
//! Source   PLCopen state diagram, CiA 402 states, MACS-ERR-02, contract sections 1 and 7

mod goal;
mod judge;
mod modulo;
mod motion;
mod power;
mod publish;
mod state;
mod stops;

pub use modulo::Modulo;
pub use state::{AXIS_STATES, AxisState, DRIVE_STATES, REFERENCES, Reference};

use crate::code::Code;
use crate::command::{Action, Command, Setpoints};
use crate::drive::{DriveInput, DriveOutput, DriveState};
use crate::encoder::{Counter, Lead};
use crate::event::{Event, EventQueue, Kind, Number, Severity};
use crate::object::Object;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::Motion;
use crate::signal::Signal;
use crate::sync::Leads;
use goal::Goal;
use judge::Judge;
use motion::Generator;
use power::Power;
use serde::{Deserialize, Serialize};
use stops::Waiting;

/// Longest delay of a drive in cycles.
pub const MAX_DELAY: u32 = 32;

/// What is fixed about an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AxisSetup {
    /// Place among the axes.
    pub index: u16,
    /// Place among the drives and the drive's delay; none for a virtual axis.
    pub drive: Option<(usize, u32)>,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
}

/// What an axis sees of its cycle.
pub struct Context<'a> {
    /// k
    pub cycle: u64,
    /// Inputs of its drive.
    pub input: Option<&'a DriveInput>,
    /// The leaders, as far as this cycle has come.
    pub leads: &'a Leads,
    /// Newest streamed setpoints.
    pub stream: Option<&'a Setpoints>,
    /// Where events go.
    pub events: &'a mut EventQueue,
}

/// One axis.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Axis {
    setup: AxisSetup,
    /// First of its signals.
    signals: Signal,
    /// In force for the next command, and at once where the row says so.
    pub parameters: AxisParameters,
    state: AxisState,
    reference: Reference,
    power: Power,
    drive_state: DriveState,
    /// Status bit 7 of the drive.
    warning: bool,
    stale_cycles: u32,
    counter: Counter,
    /// Position minus raw count.
    origin: i64,
    actual: Lead,
    effort: f64,
    /// Mode of operation that the drive shows.
    mode: i8,
    command: Motion,
    generator: Generator,
    goal: Option<Goal>,
    waiting: Waiting,
    judge: Judge,
    error: Code,
    brake: bool,
    /// Sign of the last motion, for direction CURRENT.
    last_direction: f64,
    stream_generation: u64,
    stream_age: u64,
    output: DriveOutput,
}

impl Axis {
    /// An axis at rest, switched off; a virtual one is always on.
    pub fn new(setup: AxisSetup, parameters: AxisParameters, signals: Signal) -> Self {
        let is_virtual = setup.drive.is_none();
        let delay = setup.drive.map_or(0, |(_, delay)| delay.min(MAX_DELAY));
        Self {
            setup,
            signals,
            parameters,
            state: if is_virtual { AxisState::Standstill } else { AxisState::Disabled },
            reference: Reference::Stop,
            power: if is_virtual { Power::On } else { Power::Off },
            drive_state: if is_virtual { DriveState::Enabled } else { DriveState::NotReady },
            warning: false,
            stale_cycles: 0,
            counter: Counter::new(64),
            origin: 0,
            actual: Lead { valid: is_virtual, ..Lead::default() },
            effort: 0.0,
            mode: 0,
            command: Motion::default(),
            generator: Generator::Rest,
            goal: None,
            waiting: Waiting::default(),
            judge: Judge::new(delay),
            error: Code::NONE,
            brake: false,
            last_direction: 0.0,
            stream_generation: 0,
            stream_age: 0,
            output: DriveOutput::default(),
        }
    }

    /// One cycle up to its outputs. `commands` are all commands of the cycle; the axis takes those that name it, and
    /// `answered` tells for each whether some axis has answered it.
    pub fn step<'c>(
        &mut self,
        cx: &mut Context<'_>,
        commands: impl Iterator<Item = (usize, &'c Command)>,
        answered: &mut u64,
    ) {
        self.supervise(cx);
        self.advance(cx);
        for (place, command) in commands {
            self.take(cx, place, command, answered);
        }
        self.follow_stream(cx);
        self.judge(cx);
        self.switch_drive(cx);
        self.settle_waiting(cx);
        if self.is_virtual() {
            let change = self.command.position - self.actual.position;
            let Motion { position, velocity, .. } = self.command;
            self.actual = Lead { position, change, velocity, counted: false, valid: true };
        }
    }

    /// Applies a command that names this axis and answers it. Set commands were admitted for all their axes before.
    fn take(&mut self, cx: &mut Context<'_>, place: usize, command: &Command, answered: &mut u64) {
        let sequence = command.sequence;
        let result = match &command.action {
            Action::Enable(axes) if axes.contains(self.setup.index) => return self.enable(cx, sequence),
            Action::Disable(axes) if axes.contains(self.setup.index) => return self.disable(cx, sequence),
            Action::Halt(axes) if axes.contains(self.setup.index) => return self.halt(cx, sequence),
            Action::QuickStop(axes) if axes.contains(self.setup.index) => return self.quick_stop(cx, sequence),
            Action::ResetErrors(axes) if axes.contains(self.setup.index) => return self.reset(cx, sequence),
            Action::Move(request) if request.axis == self.setup.index => self.start_move(cx, sequence, request),
            Action::Synchronize(request) if request.axis == self.setup.index => {
                self.start_synchronize(cx, sequence, request)
            }
            Action::Cancel { goal } if self.goal.is_some_and(|active| active.sequence == *goal) => {
                self.cancel(cx, sequence);
                Ok(())
            }
            _ => return,
        };
        *answered |= 1 << place;
        if let Err(refusal) = result {
            cx.events.push(Event { position: self.command.position, ..refusal.event(sequence) });
        }
    }

    /// Could its state have come about? One that was read from outside may hold anything.
    pub fn is_sound(&self) -> bool {
        self.generator.is_sound() && self.parameters.is_sound()
    }

    /// Is it the same axis of the same machine, whatever it is doing?
    pub fn is_set_up_as(&self, other: &Self) -> bool {
        self.setup == other.setup
            && self.signals == other.signals
            && self.judge.has_ring_of(&other.judge)
            && self.counter.has_width_of(&other.counter)
    }

    /// The axis as an object.
    pub fn object(&self) -> Object {
        Object::Axis(self.setup.index)
    }

    /// Place among the drives; none for a virtual axis.
    pub fn drive(&self) -> Option<usize> {
        self.setup.drive.map(|(place, _)| place)
    }

    /// Its command position as others follow it: the motion of this cycle.
    pub fn command(&self) -> Motion {
        self.command
    }

    /// Its actual position as others follow it.
    pub fn actual(&self) -> Lead {
        self.actual
    }

    /// The position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64) -> i64 {
        self.counter.locate(count)
    }

    /// What the drive is asked for.
    pub fn output(&self) -> DriveOutput {
        self.output
    }

    /// The error that stopped it.
    pub fn error(&self) -> Code {
        self.error
    }

    /// The axis whose command it follows, if any.
    pub fn leader(&self) -> Option<crate::object::Leader> {
        match &self.generator {
            Generator::Follow(follower) => Some(follower.leader),
            _ => None,
        }
    }

    /// Length of a cycle (s).
    fn cycle_s(&self) -> f64 {
        self.setup.cycle_ns as f64 / 1e9
    }

    /// Changes the state and tells it.
    fn set_state(&mut self, cx: &mut Context<'_>, state: AxisState) {
        if self.state != state {
            self.state = state;
            let event = Event::new(Severity::Info, Kind::State, self.object(), Code::NONE);
            let position = self.command.position;
            cx.events.push(Event { position, ..event.with(Number::Count(state as i64), Number::None) });
        }
    }

    /// Reads the drive: its state, and its counts as position. Inputs of all axes are read before any axis moves.
    pub fn sense(&mut self, input: Option<&DriveInput>) {
        let Some(input) = input else { return };
        self.stale_cycles = if input.fresh { 0 } else { self.stale_cycles.saturating_add(1) };
        self.drive_state = if input.online { DriveState::from_status(input.status) } else { DriveState::NotReady };
        self.warning = input.online && input.status & crate::drive::STATUS_WARNING != 0;
        let change = if input.online { self.counter.take(input.count, input.epoch) } else { 0 };
        self.origin = self.counter.position().wrapping_sub(input.count);
        self.effort = input.effort;
        self.mode = input.mode;
        self.actual = Lead {
            position: Position::whole(self.counter.position()),
            change: Position::whole(change),
            velocity: input.velocity,
            counted: true,
            valid: input.online,
        };
    }
}

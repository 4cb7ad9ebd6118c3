//! Commands: whatever changes the machine between cycles.
//!
//! A command is applied at a cycle boundary and answered once by an event: `accepted`, or `refused` with a code and the
//! values that the sentence needs (contract section 1); a note is answered by its `warning`. It carries increments; units end
//! at the border.

use crate::code::Code;
use crate::function::Order;
use crate::modulo::{Direction, Modulo};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Layer};
use crate::position::Length;
use crate::state::Reference;
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::table::Table;
use crate::trajectory::Trajectory;
use crate::unit::{Amount, Scale};
use crate::vocabulary::Request;
use lineshaft_program::Module;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Who gave a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A ROS 2 client.
    Ros,
    /// A step of a scenario.
    Scenario,
    /// The command line (Ctrl-C among it).
    Cli,
    /// The machine itself.
    Machine,
}

impl Source {
    /// The name in the interface (`lineshaft_msgs/AppliedCommand.source`).
    pub fn name(self) -> &'static str {
        match self {
            Self::Ros => "ros",
            Self::Scenario => "scenario",
            Self::Cli => "cli",
            Self::Machine => "machine",
        }
    }
}

/// One command with its place in the order of all commands.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// Grows by one with every command; names the goal that a motion command starts.
    pub sequence: u64,
    /// Who gave it.
    pub source: Source,
    /// What to do.
    pub action: Action,
}

/// What a command does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Switches axes on; done when each drive is in operation enabled.
    Enable(AxisSet),
    /// Stops axes with their maximum deceleration, then switches them off.
    Disable(AxisSet),
    /// Stops axes with the deceleration of their goal; a new goal may follow at once (MC_Halt).
    Halt(AxisSet),
    /// Stops axes with their maximum deceleration and locks them until [`Action::ResetErrors`] (MC_Stop).
    QuickStop(AxisSet),
    /// The Esc of MACS: stops all axes with their maximum deceleration, closes brakes, sets outputs as ESCCOND says, and locks
    /// the axes until [`Action::ResetErrors`].
    Abort,
    /// Clears errors and the lock of a quick stop or of an abort.
    ResetErrors(AxisSet),
    /// Lets axes be switched on and moved. A machine begins so.
    Activate,
    /// Stops all axes with their maximum deceleration, then switches them off; from then on nothing is switched on and nothing
    /// moves until [`Action::Activate`]. Done, as one, when every drive is off and every axis stands.
    Deactivate,
    /// Moves one axis.
    Move(Move),
    /// Moves one axis to a place that it has to find.
    Probe(Probe),
    /// Arms a touch probe of one axis, which moves nothing (MC_TouchProbe).
    TouchProbe(TouchProbe),
    /// Disarms touch probes of one axis (MC_AbortTrigger).
    AbortTrigger(AbortTrigger),
    /// Runs a trajectory of several axes as one goal: one `done` ends it, of the axis that made it end, or of the machine. Who
    /// gives it keeps a reference for as long as the machine may have one, so that none is freed in a cycle.
    Trajectory(Arc<Trajectory>),
    /// Answers what the trajectory of one axis asks of it at a time; nothing changes.
    QueryTrajectory(QueryTrajectory),
    /// Gives one axis its zero.
    HomeAxis(HomeAxis),
    /// Gives the present position of one axis a new value, where nothing refers to the old one; nothing moves, and what moves goes on
    /// (DEFORIGIN, SETORIGIN, MC_SetPosition).
    SetPosition(SetPosition),
    /// The same by a distance (MC_SetPosition, relative).
    ShiftPosition(ShiftPosition),
    /// Gives an entry of section `encoders` a new value for all of its users; nothing moves.
    SetEncoderPosition(SetEncoderPosition),
    /// Gives the position that one axis shows of its master a new value; nothing moves (DEFMORIGIN, SETMORIGIN).
    SetMasterPosition(SetMasterPosition),
    /// Couples one axis to a leader.
    Synchronize(Synchronize),
    /// Shifts one axis against its leader.
    Phase(Phase),
    /// Ends the coupling of one axis at a place (MC_GearOut, MC_CamOut).
    GearOut(GearOut),
    /// Opens the position loop of one axis and gives the loops below it their value (OUTAN).
    OutAn(OutAn),
    /// A verb of a vocabulary on one axis.
    Vocabulary(Request),
    /// Ends the goal that the command of this sequence number started, with a controlled stop.
    Cancel {
        /// Sequence number of the goal's command.
        goal: u64,
    },
    /// Sets parameters of axes: all of them, or none.
    SetParameters(Box<[Change]>),
    /// Keeps what is in force as layer User (SAVEEPROM, MACS-STO-06). Who stores it outside writes it down.
    SaveParameters(AxisSet),
    /// Brings a layer back into force (MACS-STO-03, MACS-STO-05).
    ResetParameters {
        /// Of which axes.
        axes: AxisSet,
        /// Which layer.
        layer: Layer,
    },
    /// Empties layer User: what the cell says is in force (MACS-STO-03).
    DeleteParameters(AxisSet),
    /// The power went and came back, in simulation; all axes must be disabled.
    PowerCycle,
    /// Sets memory cells, all of them or none; integers saturate at the cell's type.
    SetMemory(Box<[MemoryValue]>),
    /// Stages values of a function and gives it an order, or changes nothing.
    CommandFunction(CommandFunction),
    /// Gives a function an order that ends: a goal.
    RunFunction(RunFunction),
    /// Gives a table new numbers. Who gives it keeps a reference for as long as the machine may have one, so that none is freed in a
    /// cycle.
    LoadTable {
        /// Place in section `tables`.
        index: u16,
        /// The numbers, of the form that it has.
        table: Arc<Table>,
    },
    /// Exchanges a program in the functions that run it. Who gives it keeps a reference for as long as the machine may have one, so that none
    /// is freed in a cycle.
    LoadProgram {
        /// Place in section `programs`.
        index: u16,
        /// The module.
        module: Arc<Module>,
        /// Its functions go on with their state; else they begin anew.
        keeps: bool,
    },
    /// Sets outputs for good, all of them or none (OUT, OUTB, OUTAN; MACS-IO-03): also one that has a function, which sets it
    /// again with its next change.
    SetOutputs(Box<[OutputValue]>),
    /// A request that never became a command, with the sentence that refused it: it is answered with the event `refused` of
    /// code BAD_REQUEST, so that every refusal stands in the event stream.
    Refuse(Box<str>),
    /// A notice from the recorder or from a backend, which becomes an event `warning` of the machine, or of the axis that it names. That event is its answer: it is neither
    /// accepted nor, unless a cycle has more than [`MAX_COMMANDS`](crate::machine::MAX_COMMANDS), refused.
    Note {
        /// One of [`Code::NOTES`].
        code: Code,
        /// What the code counts or names.
        number: i64,
    },
}

/// An order to a function, with values that it stages first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandFunction {
    /// Place among the slots.
    pub slot: u16,
    /// What is done.
    pub order: Order,
    /// Values by their places in the set.
    pub values: Box<[(u16, i64)]>,
}

/// An order that ends, with values that the function takes first: by START where it is in RESET, else by VALUE_NEW.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFunction {
    /// Place among the slots.
    pub slot: u16,
    /// Values by their places in the set.
    pub values: Box<[(u16, i64)]>,
}

/// What a memory cell is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryValue {
    /// Place in section `memory`.
    pub index: u16,
    /// A whole number for integer cells; 0 or not 0 for a bit.
    pub value: f64,
}

/// What an output is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputValue {
    /// Place in section `io`.
    pub index: u16,
    /// 0 or 1 of a digital output, else in V.
    pub value: f64,
}

impl Action {
    /// A verb of a vocabulary.
    pub fn vocabulary(request: impl Into<Request>) -> Self {
        Self::Vocabulary(request.into())
    }

    /// Sets one memory cell.
    pub fn set_memory(index: u16, value: f64) -> Self {
        Self::SetMemory([MemoryValue { index, value }].into())
    }

    /// Sets one output.
    pub fn set_output(index: u16, value: f64) -> Self {
        Self::SetOutputs([OutputValue { index, value }].into())
    }

    /// Does it stop axes? Such commands have their own way into a cycle, ahead of all others.
    pub fn stops(&self) -> bool {
        matches!(self, Self::Halt(_) | Self::QuickStop(_) | Self::Disable(_) | Self::Deactivate | Self::Abort)
    }

    /// May it switch an axis on, or move one? An inactive machine refuses it.
    pub fn needs_active(&self) -> bool {
        matches!(
            self,
            Self::Enable(_)
                | Self::Move(_)
                | Self::Probe(_)
                | Self::Trajectory(_)
                | Self::HomeAxis(_)
                | Self::Synchronize(_)
                | Self::Phase(_)
                | Self::RunFunction(_)
                | Self::OutAn(_)
                | Self::Vocabulary(_)
        )
    }
}

/// How [`Move::target`] is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MoveMode {
    /// To a position; on a modulo axis within its turn, by [`Direction`].
    Absolute,
    /// By a distance from the command position.
    Relative,
    /// By a distance from the target of the active goal, from the command position without one.
    Additive,
    /// At a velocity, without end.
    Velocity,
    /// By a distance that is added to whatever moves the axis; at rest as [`MoveMode::Relative`].
    Superimposed,
}

impl MoveMode {
    /// What `reference` shows while it moves the axis.
    pub fn reference(self) -> Reference {
        match self {
            MoveMode::Absolute => Reference::PositionAbsolute,
            MoveMode::Relative | MoveMode::Additive | MoveMode::Superimposed => Reference::PositionRelative,
            MoveMode::Velocity => Reference::Speed,
        }
    }
}

/// What a goal does to the ones before it (PLCopen buffer mode).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BufferMode {
    /// It takes the axis over.
    #[default]
    Aborting,
    /// It begins when the one before it is done.
    Buffered,
    /// It begins where the one before it ends, passed with the lower velocity of both.
    BlendingLow,
    /// With the velocity of the one before it.
    BlendingPrevious,
    /// With its own.
    BlendingNext,
    /// With the higher velocity of both.
    BlendingHigh,
}

/// A positioning or velocity goal of one axis. Velocity, acceleration and deceleration of 0 ask for the defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Move {
    /// The axis.
    pub axis: u16,
    /// How the target is meant.
    pub mode: MoveMode,
    /// Position or distance (inc); unused in mode velocity.
    pub target: Length,
    /// (inc/s); signed in mode velocity, where 0 is 0.
    pub velocity: f64,
    /// (inc/s^2)
    pub acceleration: f64,
    /// (inc/s^2)
    pub deceleration: f64,
    /// (inc/s^3), for profile jerk; the others have no use for it, but it is checked against `max_jerk`.
    pub jerk: f64,
    /// Modulo axes, absolute.
    pub direction: Direction,
    /// Which goals it waits for.
    pub buffer_mode: BufferMode,
}

/// Which edge a search takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProbeEdge {
    /// From 0 to 1.
    #[default]
    Rising,
    /// From 1 to 0.
    Falling,
    /// Whichever comes first.
    Both,
    /// No edge but the index pulse of the axis' own encoder; one that is missing is an error (INDEX).
    Index,
}

/// A search for a mark and a move to a distance from it (touch probe to position). Velocity, acceleration and deceleration of 0
/// ask for the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// The axis.
    pub axis: u16,
    /// `target` is a distance from the command position, not a position.
    pub relative: bool,
    /// Where the search ends at the latest (inc).
    pub target: Length,
    /// (inc/s)
    pub velocity: f64,
    /// (inc/s^2)
    pub acceleration: f64,
    /// (inc/s^2)
    pub deceleration: f64,
    /// (inc/s^3), as in [`Move`].
    pub jerk: f64,
    /// The input, encoder or axis that latches.
    pub source: Object,
    /// Which of its edges.
    pub edge: ProbeEdge,
    /// Where the goal ends: from the position of the axis at the latch (inc); behind it where that is negative.
    pub distance: Length,
}

impl Probe {
    /// The move that searches.
    pub fn search(&self) -> Move {
        Move {
            axis: self.axis,
            mode: if self.relative { MoveMode::Relative } else { MoveMode::Absolute },
            target: self.target,
            velocity: self.velocity,
            acceleration: self.acceleration,
            deceleration: self.deceleration,
            jerk: self.jerk,
            direction: Direction::Shortest,
            buffer_mode: BufferMode::Aborting,
        }
    }
}

/// A passive touch probe: records where one axis is when something latches, and moves nothing (MC_TouchProbe).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchProbe {
    /// The axis.
    pub axis: u16,
    /// The input, encoder or axis that latches.
    pub source: Object,
    /// Which of its edges.
    pub edge: ProbeEdge,
    /// Records every latch until it is aborted; else the first one alone.
    pub continuous: bool,
    /// First and last position of the axis (inc) between which a latch is recorded, both included; none: anywhere.
    pub window: Option<[Length; 2]>,
}

/// A question for what a trajectory asks of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct QueryTrajectory {
    /// The axis.
    pub axis: u16,
    /// When, by the time of the machine: the number of a cycle times its length (ns).
    pub at_ns: u64,
}

/// The end of touch probes of one axis (MC_AbortTrigger).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AbortTrigger {
    /// The axis.
    pub axis: u16,
    /// What they wait for; none: all of them.
    pub source: Option<Object>,
}

/// By which numbers a way of homing is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum HomingMethod {
    /// As parameter `homing.method` says.
    #[default]
    Configured,
    /// A method of CiA 402.
    Cia402(i8),
    /// A HOME_TYPE of MACS.
    Macs(i8),
}

/// Homing of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomeAxis {
    /// The axis.
    pub axis: u16,
    /// How.
    pub method: HomingMethod,
}

/// A new value of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetPosition {
    /// The axis.
    pub axis: u16,
    /// What its command position is from now on (inc).
    pub position: Length,
}

/// A distance that is added to every position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShiftPosition {
    /// The axis.
    pub axis: u16,
    /// What its positions are more from now on (inc), rounded to whole increments.
    pub distance: Length,
}

/// A new value of the position of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetEncoderPosition {
    /// Place in section `encoders`.
    pub encoder: u16,
    /// What its position is from now on (inc).
    pub position: Length,
}

/// A new value of the position of a master, as one axis sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetMasterPosition {
    /// The axis that follows it, or may.
    pub axis: u16,
    /// What it shows from now on.
    pub position: MasterPosition,
}

/// A position of a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MasterPosition {
    /// In its increments.
    Increments(Length),
    /// As `x.master.position` shows it: in master units where MENCODER is negative (MACS-UNIT-09), else in increments.
    Shown(f64),
}

/// Where a coupling is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LeaveAt {
    /// In the cycle of the command.
    Now,
    /// Where the leader is there (inc), within its turn where it has one.
    Leader(i64),
    /// Where the axis itself is there (inc), likewise.
    Axis(i64),
}

/// Which of the loops below the position loop a value is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Level {
    /// The next one, as `ampmode` has it: the value is a velocity, or with `ampmode` 2 an effort.
    #[default]
    Setpoint,
    /// None of them: the value is the effort.
    Effort,
}

impl Level {
    /// The names in requests.
    pub const NAMES: &'static [(&'static str, Self)] = &[("setpoint", Self::Setpoint), ("effort", Self::Effort)];
}

/// A value for the loops below the position loop of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutAn {
    /// The axis.
    pub axis: u16,
    /// -1 to 1: parts of `max_velocity` or of `max_effort`.
    pub value: f64,
    /// For which loop.
    pub level: Level,
}

/// The end of the coupling that one axis has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GearOut {
    /// The axis that follows.
    pub axis: u16,
    /// Where.
    pub at: LeaveAt,
    /// What happens then; none: what the coupling was asked for with.
    pub disengage: Option<Disengage>,
}

/// A coupling of one axis to a leader.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Synchronize {
    /// The axis that follows.
    pub axis: u16,
    /// What it follows; none: what its `mencodertype` names.
    pub leader: Option<Leader>,
    /// How.
    pub mode: SyncMode,
    /// When.
    pub engage: Engage,
    /// What happens at the end.
    pub disengage: Disengage,
    /// Slave increments per `denominator` master increments; 0 : 0 asks for SYNCFACTS : SYNCFACTM.
    pub numerator: i64,
    /// Master increments; a negative ratio reverses.
    pub denominator: i64,
    /// Shift of the slave (inc), mode position only, without engage in position.
    pub offset: Length,
    /// Largest slave velocity while catching up (inc/s); 0 asks for the default.
    pub velocity: f64,
    /// Slave acceleration while catching up (inc/s^2); 0 asks for the default.
    pub acceleration: f64,
    /// The cam in the place of the gear; ratio and offset are unused then.
    pub cam: Option<CamIn>,
}

/// When a coupling begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Engage {
    /// In the cycle of its command.
    #[default]
    Immediately,
    /// Where the leader comes to a position (inc), from either side; where it has a turn, at the next pass of it.
    AtPosition {
        /// (inc)
        position: i64,
        /// The turn of the leader.
        turn: Option<Modulo>,
    },
    /// At the end of the cam under way.
    AtEnd,
    /// Of a gear by position: where the leader comes to a position the slave is at its own (MC_GearInPos).
    InPosition {
        /// Of the leader (inc).
        position: i64,
        /// The turn of the leader.
        turn: Option<Modulo>,
        /// Of the slave (inc).
        slave: i64,
        /// The leader's way before, in which the slave comes there (inc); 0: it catches up behind.
        distance: i64,
    },
    /// At the next latch of an input, encoder or axis, on its rising edge.
    OnEvent(Object),
}

/// A cam between an axis and its leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CamIn {
    /// Place in section `tables`.
    pub table: u16,
    /// How it begins.
    pub start: CamStart,
    /// Increments of the table per increment of the leader.
    pub master_scale: Ratio,
    /// Increments of the slave per increment of the table.
    pub slave_scale: Ratio,
    /// What is added to the scaled way of the leader (inc of the table).
    pub master_offset: Length,
    /// What is added to the scaled value of the table (inc of the slave).
    pub slave_offset: Length,
}

impl CamIn {
    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        self.master_scale.is_sound() && self.slave_scale.is_sound()
    }
}

/// A shift of an axis against its leader (MC_PhasingRelative).
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// The axis that follows.
    pub axis: u16,
    /// What is shifted, and by how much.
    pub side: PhaseSide,
}

/// What a phase shift shifts.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseSide {
    /// The axis, in its increments.
    Slave(PhaseShift),
    /// What leads it, as it sees it.
    Master {
        /// Shift, velocity and acceleration as they were given.
        given: [Amount; 3],
        /// The same in increments of each scale that the leader may have.
        by_scale: Box<[(Scale, PhaseShift)]>,
    },
}

/// How much, and how fast. Rates of 0 ask for the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseShift {
    /// (inc), with its sign.
    pub shift: Length,
    /// (inc/s)
    pub velocity: f64,
    /// (inc/s^2), speeding up and slowing down.
    pub acceleration: f64,
}

/// A streamed setpoint of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// (inc/s)
    pub velocity: f64,
    /// For how long it was asked for (ns): then the axis stops, as it was to. None: until the next one comes. Either way no
    /// longer than `setpoint_timeout`.
    pub duration: Option<u64>,
}

/// The setpoints that are new in a cycle, each the newest of its axis. One that came in an earlier cycle is not among them: each
/// axis counts for itself for how long it has had none.
#[derive(Clone, Debug, PartialEq)]
pub struct Setpoints {
    /// Who gave the newest of them.
    pub source: Source,
    /// One entry per axis, in file order.
    pub axes: Vec<Option<Setpoint>>,
}

impl Setpoints {
    /// Room for so many axes, with nothing new.
    pub fn none(axes: usize) -> Self {
        Self { source: Source::Machine, axes: vec![None; axes] }
    }

    /// Takes newer ones in the place of its own.
    pub fn take(&mut self, newer: &Self) {
        if !newer.is_empty() {
            self.source = newer.source;
        }
        for (mine, newer) in self.axes.iter_mut().zip(&newer.axes) {
            *mine = newer.or(*mine);
        }
    }

    /// Takes all of them out.
    pub fn clear(&mut self) {
        self.axes.fill(None);
    }

    /// Is there anything new?
    pub fn is_empty(&self) -> bool {
        self.axes.iter().all(Option::is_none)
    }
}

/// What enters a cycle beside the inputs: the stop lane and the queue, in this order, and the mailbox.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commands<'a> {
    /// halt, quick_stop, disable, deactivate: applied before the queue.
    pub stop: &'a [Command],
    /// Everything else, by sequence number.
    pub queue: &'a [Command],
    /// Streamed setpoints that are new.
    pub stream: Option<&'a Setpoints>,
}

impl<'a> Commands<'a> {
    /// Only a queue.
    pub fn queue(queue: &'a [Command]) -> Self {
        Self { queue, ..Self::default() }
    }

    /// Does nobody ask for anything?
    pub fn is_empty(&self) -> bool {
        self.stop.is_empty() && self.queue.is_empty() && self.stream.is_none()
    }

    /// All commands in the order in which they apply.
    pub fn iter(&self) -> impl Iterator<Item = &'a Command> + use<'a> {
        self.stop.iter().chain(self.queue)
    }
}

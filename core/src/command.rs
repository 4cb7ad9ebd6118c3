//! Commands: all changes of the machine between cycles.
//!
//! A command is applied at a cycle boundary and answered once by an event: `accepted`, or `refused` with a code and the
//! values of the message (contract section 1); a note is answered by its `warning`. Values are in increments: units are
//! converted before.

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

/// Origin of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A ROS 2 client.
    Ros,
    /// A step of a scenario.
    Scenario,
    /// The command line (including Ctrl-C).
    Cli,
    /// The machine itself.
    Machine,
}

impl Source {
    /// Returns the name in the interface (`lineshaft_msgs/AppliedCommand.source`).
    pub fn name(self) -> &'static str {
        match self {
            Self::Ros => "ros",
            Self::Scenario => "scenario",
            Self::Cli => "cli",
            Self::Machine => "machine",
        }
    }
}

/// One command with its position in the order of all commands.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// Sequence number, which increases by one with every command; identifies the goal that a motion command starts.
    pub sequence: u64,
    /// Origin of the command.
    pub source: Source,
    /// The action.
    pub action: Action,
}

/// Action of a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Enables axes; done when each drive is in operation enabled.
    Enable(AxisSet),
    /// Stops axes with their maximum deceleration, then disables them.
    Disable(AxisSet),
    /// Stops axes with the deceleration of their goal; a new goal may follow at once (MC_Halt).
    Halt(AxisSet),
    /// Stops axes with their maximum deceleration and locks them until [`Action::ResetErrors`] (MC_Stop).
    QuickStop(AxisSet),
    /// Esc of MACS: stops all axes with their maximum deceleration, closes brakes, sets outputs according to ESCCOND,
    /// and locks the axes until [`Action::ResetErrors`].
    Abort,
    /// Resets errors and the lock of a quick stop or of an abort.
    ResetErrors(AxisSet),
    /// Allows axes to be enabled and moved. A machine is active at its start.
    Activate,
    /// Stops all axes with their maximum deceleration, then disables them; until [`Action::Activate`] nothing can be
    /// enabled or moved. Done, for all together, when every drive is off and every axis at rest.
    Deactivate,
    /// Moves one axis.
    Move(Move),
    /// Moves one axis to a position relative to a mark, for which it searches.
    Probe(Probe),
    /// Arms a touch probe of one axis, without motion (MC_TouchProbe).
    TouchProbe(TouchProbe),
    /// Disarms touch probes of one axis (MC_AbortTrigger).
    AbortTrigger(AbortTrigger),
    /// Executes a trajectory of several axes as one goal: one `done` event ends it, of the axis that caused the end, or
    /// of the machine. The sender keeps a reference as long as the machine may have one, so that none is freed in a
    /// cycle.
    Trajectory(Arc<Trajectory>),
    /// Queries the setpoint of the trajectory of one axis at a time; changes nothing.
    QueryTrajectory(QueryTrajectory),
    /// Homes one axis.
    HomeAxis(HomeAxis),
    /// Sets the present position of one axis to a new value, if nothing refers to the old one; motions continue
    /// unchanged (DEFORIGIN, SETORIGIN, MC_SetPosition).
    SetPosition(SetPosition),
    /// Shifts the position of one axis by a distance (MC_SetPosition, relative).
    ShiftPosition(ShiftPosition),
    /// Sets an entry of section `encoders` to a new value for all of its users, without motion.
    SetEncoderPosition(SetEncoderPosition),
    /// Sets the master position of one axis to a new value, without motion (DEFMORIGIN, SETMORIGIN).
    SetMasterPosition(SetMasterPosition),
    /// Couples one axis to a leader.
    Synchronize(Synchronize),
    /// Shifts the phase of one axis to its leader.
    Phase(Phase),
    /// Ends the coupling of one axis at a position (MC_GearOut, MC_CamOut).
    GearOut(GearOut),
    /// Opens the position loop of one axis and sets the setpoint of the loops below it (OUTAN).
    OutAn(OutAn),
    /// A request of a vocabulary to one axis.
    Vocabulary(Request),
    /// Ends the goal of the command with this sequence number, with a controlled stop.
    Cancel {
        /// Sequence number of the command of the goal.
        goal: u64,
    },
    /// Sets parameters of axes: all of them, or none.
    SetParameters(Box<[Change]>),
    /// Saves the active parameters as layer User (SAVEEPROM, MACS-STO-06). The owner of the storage writes them.
    SaveParameters(AxisSet),
    /// Activates a layer of parameters (MACS-STO-03, MACS-STO-05).
    ResetParameters {
        /// Axes whose parameters are reset.
        axes: AxisSet,
        /// Layer to activate.
        layer: Layer,
    },
    /// Deletes layer User: the parameters of the cell become active (MACS-STO-03).
    DeleteParameters(AxisSet),
    /// Simulates a power cycle; all axes must be disabled.
    PowerCycle,
    /// Sets memory cells, all of them or none; integers saturate at the type of the cell.
    SetMemory(Box<[MemoryValue]>),
    /// Stages values of a function and commands it, or changes nothing.
    CommandFunction(CommandFunction),
    /// Starts an order of a function that ends: a goal.
    RunFunction(RunFunction),
    /// Sets new numbers of a table. The sender keeps a reference as long as the machine may have one, so that none is
    /// freed in a cycle.
    LoadTable {
        /// Index in section `tables`.
        index: u16,
        /// The numbers, in the form of the table.
        table: Arc<Table>,
    },
    /// Replaces a program in the functions that run it. The sender keeps a reference as long as the machine may have
    /// one, so that none is freed in a cycle.
    LoadProgram {
        /// Index in section `programs`.
        index: u16,
        /// The module.
        module: Arc<Module>,
        /// Whether its functions keep their state; otherwise they restart.
        keeps: bool,
    },
    /// Sets outputs permanently, all of them or none (OUT, OUTB, OUTAN; MACS-IO-03). An output with a function may be
    /// set as well, but the function overwrites it at its next change.
    SetOutputs(Box<[OutputValue]>),
    /// A request that failed before it became a command, with its error message: it is answered with the event
    /// `refused` of code BAD_REQUEST, so that every refusal is in the event stream.
    Refuse(Box<str>),
    /// A notice of the recorder or of a backend, which becomes an event `warning` of the machine, or of the axis that
    /// it names. That event is its answer: it is neither accepted nor, unless a cycle has more than
    /// [`MAX_COMMANDS`](crate::machine::MAX_COMMANDS), refused.
    Note {
        /// One of [`Code::NOTES`].
        code: Code,
        /// Count or name, depending on the code.
        number: i64,
    },
}

/// A command to a function, with values that it stages first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandFunction {
    /// Index among the slots.
    pub slot: u16,
    /// The command.
    pub order: Order,
    /// Values by their indices in the set.
    pub values: Box<[(u16, i64)]>,
}

/// An order that ends, with values that the function takes first: by START if it is in RESET, otherwise by VALUE_NEW.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFunction {
    /// Index among the slots.
    pub slot: u16,
    /// Values by their indices in the set.
    pub values: Box<[(u16, i64)]>,
}

/// New value of a memory cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryValue {
    /// Index in section `memory`.
    pub index: u16,
    /// A whole number for integer cells; 0 or not 0 for a bit.
    pub value: f64,
}

/// New value of an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputValue {
    /// Index in section `io`.
    pub index: u16,
    /// 0 or 1 for a digital output, otherwise V.
    pub value: f64,
}

impl Action {
    /// Returns the action of a request to a vocabulary.
    pub fn vocabulary(request: impl Into<Request>) -> Self {
        Self::Vocabulary(request.into())
    }

    /// Returns the action that sets one memory cell.
    pub fn set_memory(index: u16, value: f64) -> Self {
        Self::SetMemory([MemoryValue { index, value }].into())
    }

    /// Returns the action that sets one output.
    pub fn set_output(index: u16, value: f64) -> Self {
        Self::SetOutputs([OutputValue { index, value }].into())
    }

    /// Returns true if it stops axes. Such commands have their own queue, ahead of all others.
    pub fn stops(&self) -> bool {
        matches!(self, Self::Halt(_) | Self::QuickStop(_) | Self::Disable(_) | Self::Deactivate | Self::Abort)
    }

    /// Returns true if it may enable or move an axis. An inactive machine refuses it.
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

/// Meaning of [`Move::target`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MoveMode {
    /// A position; on a modulo axis within its turn, by [`Direction`].
    Absolute,
    /// A distance from the command position.
    Relative,
    /// A distance from the target of the active goal, or from the command position without one.
    Additive,
    /// A velocity, without end.
    Velocity,
    /// A distance that is superimposed on the present motion; at rest as [`MoveMode::Relative`].
    Superimposed,
}

impl MoveMode {
    /// Returns the value of `reference` during the motion.
    pub fn reference(self) -> Reference {
        match self {
            MoveMode::Absolute => Reference::PositionAbsolute,
            MoveMode::Relative | MoveMode::Additive | MoveMode::Superimposed => Reference::PositionRelative,
            MoveMode::Velocity => Reference::Speed,
        }
    }
}

/// Relation of a goal to the previous ones (PLCopen buffer mode).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BufferMode {
    /// Aborts the active goal.
    #[default]
    Aborting,
    /// Begins when the previous goal is done.
    Buffered,
    /// Blends at the end of the previous goal with the lower velocity of both.
    BlendingLow,
    /// Blends with the velocity of the previous goal.
    BlendingPrevious,
    /// Blends with its own velocity.
    BlendingNext,
    /// Blends with the higher velocity of both.
    BlendingHigh,
}

/// A positioning or velocity goal of one axis. Velocity, acceleration and deceleration of 0 mean the defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Move {
    /// Index of the axis.
    pub axis: u16,
    /// Meaning of the target.
    pub mode: MoveMode,
    /// Position or distance (inc); unused in mode velocity.
    pub target: Length,
    /// Velocity (inc/s); signed in mode velocity, where 0 is 0.
    pub velocity: f64,
    /// Acceleration (inc/s^2).
    pub acceleration: f64,
    /// Deceleration (inc/s^2).
    pub deceleration: f64,
    /// Jerk (inc/s^3), for profile jerk; the other profiles do not use it, but it is checked against `max_jerk`.
    pub jerk: f64,
    /// Direction of an absolute target on a modulo axis.
    pub direction: Direction,
    /// Relation to the previous goals.
    pub buffer_mode: BufferMode,
}

/// Edge of a latch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProbeEdge {
    /// From 0 to 1.
    #[default]
    Rising,
    /// From 1 to 0.
    Falling,
    /// The first of both.
    Both,
    /// The index pulse of the encoder of the axis, instead of an edge; a missing pulse is an error (INDEX).
    Index,
}

/// A search for a mark and a move to a distance from it (touch probe to position). Velocity, acceleration and
/// deceleration of 0 mean the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Index of the axis.
    pub axis: u16,
    /// Whether `target` is a distance from the command position, not a position.
    pub relative: bool,
    /// End of the search without a mark (inc).
    pub target: Length,
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Acceleration (inc/s^2).
    pub acceleration: f64,
    /// Deceleration (inc/s^2).
    pub deceleration: f64,
    /// Jerk (inc/s^3), as in [`Move`].
    pub jerk: f64,
    /// The input, encoder or axis that latches.
    pub source: Object,
    /// Edge of the latch.
    pub edge: ProbeEdge,
    /// End of the goal, relative to the position of the axis at the latch (inc); negative in negative direction.
    pub distance: Length,
}

impl Probe {
    /// Returns the search motion.
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

/// A passive touch probe: records the position of one axis at a latch, without motion (MC_TouchProbe).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchProbe {
    /// Index of the axis.
    pub axis: u16,
    /// The input, encoder or axis that latches.
    pub source: Object,
    /// Edge of the latch.
    pub edge: ProbeEdge,
    /// Whether every latch is recorded until the probe is aborted; otherwise only the first one.
    pub continuous: bool,
    /// First and last position of the axis (inc) between which a latch is recorded, both included; `None`: anywhere.
    pub window: Option<[Length; 2]>,
}

/// A query for the setpoint of a trajectory of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct QueryTrajectory {
    /// Index of the axis.
    pub axis: u16,
    /// Time of the query, in the time of the machine: the number of a cycle times the cycle time (ns).
    pub at_ns: u64,
}

/// The end of touch probes of one axis (MC_AbortTrigger).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AbortTrigger {
    /// Index of the axis.
    pub axis: u16,
    /// Object that latches; `None`: all touch probes of the axis.
    pub source: Option<Object>,
}

/// Numbering of a homing method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum HomingMethod {
    /// As set by parameter `homing.method`.
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
    /// Index of the axis.
    pub axis: u16,
    /// Homing method.
    pub method: HomingMethod,
}

/// A new value of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetPosition {
    /// Index of the axis.
    pub axis: u16,
    /// New value of its command position (inc).
    pub position: Length,
}

/// A distance that is added to every position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShiftPosition {
    /// Index of the axis.
    pub axis: u16,
    /// Change of its positions (inc), rounded to whole increments.
    pub distance: Length,
}

/// A new value of the position of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetEncoderPosition {
    /// Index in section `encoders`.
    pub encoder: u16,
    /// New value of its position (inc).
    pub position: Length,
}

/// A new value of the master position of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetMasterPosition {
    /// Index of the axis, whether or not it follows the master at present.
    pub axis: u16,
    /// New value of the position.
    pub position: MasterPosition,
}

/// A position of a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MasterPosition {
    /// In increments of the master.
    Increments(Length),
    /// In the unit of `x.master.position`: in master units if MENCODER is negative (MACS-UNIT-09), otherwise in
    /// increments.
    Shown(f64),
}

/// Position at which a coupling ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DisengageAt {
    /// In the cycle of the command.
    Now,
    /// At this position of the leader (inc), within its turn if it has one.
    Leader(i64),
    /// At this position of the axis itself (inc), within its turn if it has one.
    Axis(i64),
}

/// Loop below the position loop that receives a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Level {
    /// The next loop, depending on `ampmode`: the value is a velocity, or with `ampmode` 2 an effort.
    #[default]
    Setpoint,
    /// No loop: the value is the effort.
    Effort,
}

impl Level {
    /// Names in requests.
    pub const NAMES: &'static [(&'static str, Self)] = &[("setpoint", Self::Setpoint), ("effort", Self::Effort)];
}

/// A value for the loops below the position loop of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutAn {
    /// Index of the axis.
    pub axis: u16,
    /// Value, -1 to 1: fraction of `max_velocity` or of `max_effort`.
    pub value: f64,
    /// Loop that receives the value.
    pub level: Level,
}

/// The end of the coupling of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GearOut {
    /// Index of the following axis.
    pub axis: u16,
    /// Position of the end.
    pub at: DisengageAt,
    /// Behaviour after the end; `None`: as given when the coupling was commanded.
    pub disengage: Option<Disengage>,
}

/// A coupling of one axis to a leader.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Synchronize {
    /// Index of the following axis.
    pub axis: u16,
    /// The leader; `None`: the leader of its `mencodertype`.
    pub leader: Option<Leader>,
    /// Mode of the coupling.
    pub mode: SyncMode,
    /// Start of the coupling.
    pub engage: Engage,
    /// Behaviour after the end.
    pub disengage: Disengage,
    /// Slave increments per `denominator` master increments; 0 : 0 means SYNCFACTS : SYNCFACTM.
    pub numerator: i64,
    /// Master increments; a negative ratio reverses.
    pub denominator: i64,
    /// Shift of the slave (inc), mode position only, without engage in position.
    pub offset: Length,
    /// Maximum slave velocity during synchronization (inc/s); 0 means the default.
    pub velocity: f64,
    /// Slave acceleration during synchronization (inc/s^2); 0 means the default.
    pub acceleration: f64,
    /// Cam instead of the gear; ratio and offset are unused then.
    pub cam: Option<CamIn>,
}

/// Start of a coupling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Engage {
    /// In the cycle of its command.
    #[default]
    Immediately,
    /// When the leader reaches a position (inc), in either direction; with a turn, at the next pass of the position.
    AtPosition {
        /// Position of the leader (inc).
        position: i64,
        /// Turn of the leader.
        turn: Option<Modulo>,
    },
    /// At the end of the present cam.
    AtEnd,
    /// Gear by position: when the leader reaches its position, the slave is at its own (MC_GearInPos).
    InPosition {
        /// Position of the leader (inc).
        position: i64,
        /// Turn of the leader.
        turn: Option<Modulo>,
        /// Position of the slave (inc).
        slave: i64,
        /// Distance of the leader before its position in which the slave synchronizes (inc); 0: it synchronizes after
        /// it.
        distance: i64,
    },
    /// At the next latch of an input, encoder or axis, on its rising edge.
    OnEvent(Object),
}

/// A cam between an axis and its leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CamIn {
    /// Index in section `tables`.
    pub table: u16,
    /// Start of the cam.
    pub start: CamStart,
    /// Increments of the table per increment of the leader.
    pub master_scale: Ratio,
    /// Increments of the slave per increment of the table.
    pub slave_scale: Ratio,
    /// Offset that is added to the scaled travel of the leader (inc of the table).
    pub master_offset: Length,
    /// Offset that is added to the scaled value of the table (inc of the slave).
    pub slave_offset: Length,
}

impl CamIn {
    /// Returns true if a restored state is valid.
    pub fn is_sound(&self) -> bool {
        self.master_scale.is_sound() && self.slave_scale.is_sound()
    }
}

/// A phase shift of an axis to its leader (MC_PhasingRelative).
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Index of the following axis.
    pub axis: u16,
    /// Side that is shifted, and the distance.
    pub side: PhaseSide,
}

/// Side of a phase shift.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseSide {
    /// The axis, in its increments.
    Slave(PhaseShift),
    /// The master position of the axis.
    Master {
        /// Shift, velocity and acceleration, as given.
        given: [Amount; 3],
        /// The same in increments of each scale that the leader may have.
        by_scale: Box<[(Scale, PhaseShift)]>,
    },
}

/// Distance and rates of a phase shift. Rates of 0 mean the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseShift {
    /// Shift (inc), signed.
    pub shift: Length,
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Acceleration and deceleration (inc/s^2).
    pub acceleration: f64,
}

/// A streamed setpoint of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Duration (ns), after which the axis stops as commanded. `None`: until the next setpoint. The time is limited to
    /// `setpoint_timeout` in both cases.
    pub duration: Option<u64>,
}

/// Setpoints that are new in a cycle, only the newest of each axis. Setpoints of earlier cycles are not included: each
/// axis counts the time since its last setpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Setpoints {
    /// Origin of the newest setpoint.
    pub source: Source,
    /// One entry per axis, in file order.
    pub axes: Vec<Option<Setpoint>>,
}

impl Setpoints {
    /// Creates an empty set for that number of axes.
    pub fn none(axes: usize) -> Self {
        Self { source: Source::Machine, axes: vec![None; axes] }
    }

    /// Merges newer setpoints, which replace older ones.
    pub fn merge(&mut self, newer: &Self) {
        if !newer.is_empty() {
            self.source = newer.source;
        }
        for (mine, newer) in self.axes.iter_mut().zip(&newer.axes) {
            *mine = newer.or(*mine);
        }
    }

    /// Removes all setpoints.
    pub fn clear(&mut self) {
        self.axes.fill(None);
    }

    /// Returns true if there is no new setpoint.
    pub fn is_empty(&self) -> bool {
        self.axes.iter().all(Option::is_none)
    }
}

/// Commands of a cycle: the stop queue and the normal queue, in this order, and the streamed setpoints.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commands<'a> {
    /// halt, quick_stop, disable, deactivate: applied before the queue.
    pub stop: &'a [Command],
    /// All other commands, by sequence number.
    pub queue: &'a [Command],
    /// New streamed setpoints.
    pub stream: Option<&'a Setpoints>,
}

impl<'a> Commands<'a> {
    /// Returns commands with a queue only.
    pub fn queue(queue: &'a [Command]) -> Self {
        Self { queue, ..Self::default() }
    }

    /// Returns true if there is no command and no setpoint.
    pub fn is_empty(&self) -> bool {
        self.stop.is_empty() && self.queue.is_empty() && self.stream.is_none()
    }

    /// Returns all commands in the order in which they are applied.
    pub fn iter(&self) -> impl Iterator<Item = &'a Command> + use<'a> {
        self.stop.iter().chain(self.queue)
    }
}

//! Commands: all changes of the machine between cycles.
//!
//! A command is applied at a cycle boundary and answered once by an event: `accepted`, or `refused` with a code and the
//! values of the message (contract section 1); a note is answered by its `warning`. Values are in increments: units are
//! converted before.

mod coupling;
mod motion;
mod position;
mod probe;
mod setpoints;

pub use coupling::{CamIn, DisengageAt, Engage, GearOut, Phase, PhaseShift, PhaseSide, Synchronize};
pub use motion::{BufferMode, Level, Move, MoveMode, OutAn, QueryTrajectory};
pub use position::{
    HomeAxis, HomingMethod, MasterPosition, SetEncoderPosition, SetMasterPosition, SetPosition, ShiftPosition,
};
pub use probe::{AbortTrigger, Probe, ProbeEdge, TouchProbe};
pub use setpoints::{Setpoint, Setpoints};

use crate::code::Code;
use crate::function::Order;
use crate::object::AxisSet;
use crate::parameter::{Change, Layer};
use crate::table::Table;
use crate::trajectory::Trajectory;
use crate::vocabulary::Request;
use lineshaft_program::Module;
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

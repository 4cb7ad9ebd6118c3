//! Vocabularies of the source systems: state machines that convert their commands and registers to orders to the axis
//! (contract section 9).
//!
//! Law      each cycle: commands of the cycle, then one step; their result is an [`Order`], which the axis executes
//!          with the same profiles, limits and stops as a goal
//! Reads    a [`View`] of the axis
//! Writes   orders, its own signals; never the axis itself
//! Refuses  requests that the source rejects, with a code and the numbers of the message; the state is unchanged then

mod all;
pub mod amc;
mod one;
mod request;
pub mod saia;
pub mod wf;

pub use all::Vocabularies;
pub(crate) use all::{Notice, add_signals};
pub use amc::{Problem, Setting, check};
pub(crate) use one::{ParameterChange, Vocabulary};
pub use request::{Outcome, Request};

use crate::code::Code;
use crate::drive::Interface;
use crate::encoder::Lead;
use crate::event::{Number, Refusal};
use crate::modulo::Modulo;
use crate::object::{Leader, Object};
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::{Limits, Motion};
use crate::state::Reference;
use crate::sync::Leads;
use serde::{Deserialize, Serialize};

/// Checks that the integer PID damps a loop without an inner loop.
///
/// # Errors
/// The key of the invalid parameter, and the reason.
pub(crate) fn check_damping(parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
    saia::check_damping(&parameters.vocabularies.saia)
}

/// Checks that the integer PID can close the loop of an axis with these parameters.
///
/// # Errors
/// The key of the invalid parameter, and the reason.
pub(crate) fn check_loop(parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
    saia::check_loop(&parameters.vocabularies.saia)
}

/// Owner of an axis. Goals, halt, quick_stop and errors take the axis over from a vocabulary; an order of the
/// vocabulary takes it over again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Owner {
    /// Goals of the contract.
    #[default]
    Native,
    /// Reference selector.
    Amc,
    /// Command flags.
    Saia,
    /// Blocks and modes.
    Wf,
}

impl Owner {
    /// The vocabularies, in the order of their steps.
    pub(crate) const VOCABULARIES: [Self; 3] = [Self::Amc, Self::Saia, Self::Wf];

    /// Returns true if another order of the owner ends the homing that it started.
    pub(crate) fn order_ends_homing(self) -> bool {
        self == Self::Amc
    }

    /// Returns true if outputs of an axis without a position loop follow the orders of the owner.
    pub(crate) fn drives_outputs(self) -> bool {
        self == Self::Wf
    }
}

/// Connections of the vocabularies of an axis; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// The reference selector.
    pub amc: amc::Wiring,
}

impl Wiring {
    /// Returns the leader to which a vocabulary may couple the axis at any time.
    pub fn master(&self) -> Option<Leader> {
        self.amc.master
    }
}

/// A position in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CamPoint {
    /// Index of the table in the machine.
    pub table: u16,
    /// Index of the point, from 0.
    pub point: usize,
    /// Distance after the point (inc of the master).
    pub behind: i64,
}

/// A latch of this cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatchView {
    /// The object that latched.
    pub object: Object,
    /// Whether the edge was rising.
    pub rising: bool,
    /// Time before t_k (ns).
    pub age_ns: u32,
    /// Position that the device captured; `None` if it captured only the time.
    pub captured: Option<Position>,
    /// Position of an axis or encoder at that time; 0 for other objects.
    pub position: Position,
}

impl LatchView {
    /// Returns the travel of a leader from the time of the latch to t_k: from the captured position if the device of
    /// the leader captured it, otherwise by linear interpolation in this cycle.
    pub(crate) fn travel_since(&self, leader: Leader, lead: Lead, cycle_ns: u64) -> Position {
        let is_its_own = match (leader, self.object) {
            (Leader::Encoder(encoder), Object::Encoder(object)) => encoder == object,
            (Leader::AxisActual(axis), Object::Axis(object)) => axis == object,
            _ => false,
        };
        match self.captured.filter(|_| is_its_own) {
            Some(captured) => lead.position - captured,
            None => {
                let age = i128::from(self.age_ns).min(i128::from(cycle_ns));
                let change = lead.change.raw().clamp(-(1 << 94), 1 << 94);
                Position::from_raw((change * age).div_euclid(i128::from(cycle_ns.max(1))))
            }
        }
    }
}

/// State of an axis at t_k for its vocabularies: the generator has advanced, the following error is that of the
/// previous cycle.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The axis.
    pub object: Object,
    /// Number k of the cycle.
    pub cycle: u64,
    /// Cycle time T (ns).
    pub cycle_ns: u64,
    /// Whether the vocabulary gave the last order, and the axis was not taken over since.
    pub owns: bool,
    /// Whether it did so until an error of this cycle, detected before the commands, took the axis over.
    pub owned: bool,
    /// Whether the axis can be moved: on, without error and lock.
    pub free: bool,
    /// Whether the drive is on and its brake open.
    pub on: bool,
    /// Whether the brake is closing before the drive is switched off.
    pub closing: bool,
    /// Whether an error or a quick stop holds the axis until reset_errors, or an open contact holds an enabled axis.
    pub locked: bool,
    /// Whether an error stopped the axis.
    pub in_error: bool,
    /// The error that stopped it.
    pub error: Code,
    /// Open contact of the cell: nothing may be switched on or begin.
    pub contact: Code,
    /// Whether homing runs.
    pub homing: bool,
    /// Velocity of the search for the reference during homing, with its direction (inc/s); otherwise 0.
    pub search_speed: f64,
    /// Whether the axis is homed.
    pub homed: bool,
    /// Command of this cycle.
    pub command: Motion,
    /// Command from which a profile continues: without the acceleration of a coupling.
    pub present: Motion,
    /// Whether the command is at rest.
    pub rests: bool,
    /// Whether the axis rests without any motion or order.
    pub idle: bool,
    /// Whether a profile moves the command, and ends at rest.
    pub has_end: bool,
    /// End of the present motion; target of the gear for a coupled axis; otherwise the command position.
    pub target: Position,
    /// Actual position, its change in this cycle, actual velocity.
    pub actual: Lead,
    /// Following error (inc).
    pub following_error: i64,
    /// Whether the command is at or beyond a software limit, or the axis is on a limit switch.
    pub at_limit: bool,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Increments per axis unit.
    pub unit: f64,
    /// Command interface of the drive; `None` for a virtual axis.
    pub interface: Option<Interface>,
    /// Whether the controller of the vocabulary closes the loop of the axis.
    pub closes_loop: bool,
    /// Connections of the vocabularies.
    pub wiring: Wiring,
    /// Active parameters, including those of the vocabularies.
    pub parameters: &'a AxisParameters,
    /// The leaders, as far as this cycle has updated them.
    pub leads: &'a Leads,
    /// Latches of this cycle.
    pub latches: &'a [LatchView],
    /// Position of the index of its encoder in this cycle.
    pub index: Option<Position>,
}

impl View<'_> {
    /// Returns limits at the maxima of the axis, with its profile.
    pub fn largest_limits(&self) -> Limits {
        self.parameters.max_limits()
    }
}

/// Reference travel of the positioning modules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// 1 or -1.
    pub direction: i8,
    /// Whether it reverses on the cam: the zero mark is on the side from which the axis came.
    pub back: bool,
    /// Velocities to the cam, on the cam, and next to it to the zero mark (inc/s).
    pub speeds: [f64; 3],
    /// Limits of all of its motions.
    pub limits: Limits,
    /// Distance from the zero mark to the reference point (inc).
    pub shift: i64,
    /// Position of the reference point (inc).
    pub value: i64,
}

/// Order of a vocabulary to its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Moves to a position, from the present motion.
    Position {
        /// Target position (inc), before rounding to whole increments.
        target: Position,
        /// Limits of the motion.
        limits: Limits,
        /// Value of `reference`.
        reference: Reference,
    },
    /// Moves at a velocity, without end.
    Velocity {
        /// Velocity (inc/s), signed; 0 stops.
        velocity: f64,
        /// Limits of the motion.
        limits: Limits,
    },
    /// Stops at any position.
    Stop {
        /// Limits of the stop.
        limits: Limits,
    },
    /// Sets the command to the actual position, at once and at rest, without a ramp.
    HoldActualPosition,
    /// Follows the master of the vocabulary through the gear of the axis.
    Gear {
        /// Travel of the leader to include (inc): from the freeze point to t_k.
        past: Position,
    },
    /// Follows the master through a cam.
    Cam {
        /// Start of the cam, for any position of master and slave.
        from: CamPoint,
        /// Travel of the leader to include (inc): from the freeze point to t_k.
        past: Position,
    },
    /// Homes as configured.
    Home,
    /// Reference travel, until the next order.
    ReferenceTravel(Travel),
    /// Open loop: the drive runs at this speed (inc/s), signed; 0 switches its output off, and it coasts.
    Speed {
        /// Speed (inc/s).
        velocity: f64,
    },
    /// Switches the drive on.
    SwitchOn,
    /// Switches the drive off at once: it coasts.
    SwitchOff,
    /// An alarm of the vocabulary: the axis reacts by its `error_reaction`, and has no owner then.
    Fail {
        /// Code of the alarm.
        code: Code,
        /// Value that was found.
        found: Number,
        /// Allowed value.
        allowed: Number,
    },
    /// Acknowledges the alarm: the axis, at rest, leaves the error of [`Order::Fail`], but no other error.
    Reset,
    /// An error of the axis that switches its drive off at once.
    FailOff {
        /// Reason, with its numbers.
        refusal: Refusal,
    },
}

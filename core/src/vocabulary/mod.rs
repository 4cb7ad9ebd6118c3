//! The vocabularies of the source systems: state machines that turn their own commands and registers into orders to the
//! axis (contract section 9).
//!
//! Law      each cycle: commands of the cycle, then one step; what they ask becomes an [`Order`], which the axis does with
//!          the same profiles, limits and stops as a goal of its own
//! Reads    a [`View`] of the axis
//! Writes   orders, its own signals; never the axis itself
//! Refuses  what the source refuses, by a code and the numbers of its sentence; its state is unchanged then

mod all;
pub mod amc;
mod one;
mod request;
pub mod saia;
pub mod wf;

pub use all::Vocabularies;
pub(crate) use all::{Notice, add_signals};
pub use amc::{Problem, Setting, check};
pub(crate) use one::{Vocabulary, Writes};
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

/// Does the integer PID damp a loop without another one below it?
///
/// # Errors
/// The key that does not, and why.
pub(crate) fn check_damping(parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
    saia::check_damping(&parameters.vocabularies.saia)
}

/// Can the integer PID close the loop of an axis with these?
///
/// # Errors
/// The key that cannot be, and why.
pub(crate) fn check_loop(parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
    saia::check_loop(&parameters.vocabularies.saia)
}

/// Who commands an axis. Goals, halt, quick_stop and errors take it from a vocabulary; an order takes it back.
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

    /// Does another order of its own end the homing that it has asked for?
    pub(crate) fn leaves_homing(self) -> bool {
        self == Self::Amc
    }

    /// Do outputs of an axis without a position loop show what it orders?
    pub(crate) fn switches(self) -> bool {
        self == Self::Wf
    }
}

/// What the vocabularies of an axis are wired to; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// The reference selector.
    pub amc: amc::Wiring,
}

impl Wiring {
    /// The leader to which a vocabulary may couple the axis at any time.
    pub fn master(&self) -> Option<Leader> {
        self.amc.master
    }
}

/// A place in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CamPoint {
    /// Place of the table among those of the machine.
    pub table: u16,
    /// Its point, from 0.
    pub point: usize,
    /// Behind that (inc of the master).
    pub behind: i64,
}

/// A latch of this cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latched {
    /// What latched.
    pub object: Object,
    /// On the rising edge.
    pub rising: bool,
    /// Before t_k (ns).
    pub age_ns: u32,
    /// What the device captured of its own position; none where it captured only the instant.
    pub captured: Option<Position>,
    /// Where an axis or encoder stood then; 0 for others.
    pub position: Position,
}

impl Latched {
    /// The way of a leader from the instant of the latch to t_k: from what the leader's own device captured, else on the straight line of
    /// its change in this cycle.
    pub(crate) fn way_since(&self, leader: Leader, lead: Lead, cycle_ns: u64) -> Position {
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

/// What a vocabulary sees of its axis at t_k: the generator has advanced, the following error is that of the last cycle.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The axis.
    pub object: Object,
    /// k
    pub cycle: u64,
    /// T (ns)
    pub cycle_ns: u64,
    /// It gave the last order, and nothing has taken the axis over since.
    pub owns: bool,
    /// It did until an error of this cycle, known before the commands, took the axis over.
    pub owned: bool,
    /// The axis can be moved: on, without error and lock.
    pub free: bool,
    /// The drive is on, and its brake open.
    pub on: bool,
    /// Its brake closes; then it is switched off.
    pub closing: bool,
    /// An error or a quick stop holds the axis until reset_errors, or an open contact one that is on.
    pub locked: bool,
    /// An error stopped the axis.
    pub in_error: bool,
    /// The error that stopped it.
    pub error: Code,
    /// The contact of the cell that is open: nothing may be switched on or begin.
    pub contact: Code,
    /// Homing is under way.
    pub homing: bool,
    /// At which homing looks for its reference, signed by the way (inc/s); 0 where it does not.
    pub search_speed: f64,
    /// The axis knows its zero.
    pub homed: bool,
    /// The command of this cycle.
    pub command: Motion,
    /// The same as a profile goes on from it: what is left of a coupling's acceleration is none of its own.
    pub present: Motion,
    /// Nothing moves the command.
    pub rests: bool,
    /// It stands, with nothing to do.
    pub idle: bool,
    /// A profile moves the command, and it ends at rest.
    pub has_end: bool,
    /// Where the motion under way ends; where the gear wants a coupled axis; else the command position.
    pub target: Position,
    /// Actual position, its change in this cycle, actual velocity.
    pub actual: Lead,
    /// (inc)
    pub following_error: i64,
    /// The command stands at a software limit or beyond, or the axis stands on a limit switch.
    pub at_limit: bool,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Increments per axis unit.
    pub unit: f64,
    /// How the drive is commanded; none for a virtual axis.
    pub interface: Option<Interface>,
    /// The regulator of the vocabulary closes the loop of the axis.
    pub regulates: bool,
    /// What the vocabularies are wired to.
    pub wiring: Wiring,
    /// Parameters in force, those of the vocabularies among them.
    pub parameters: &'a AxisParameters,
    /// The leaders, as far as this cycle has come.
    pub leads: &'a Leads,
    /// The latches of this cycle.
    pub latches: &'a [Latched],
    /// Where the index of its encoder came in this cycle.
    pub index: Option<Position>,
}

impl View<'_> {
    /// Limits at the maxima of the axis, with its profile.
    pub fn largest_limits(&self) -> Limits {
        self.parameters.largest_limits()
    }
}

/// Reference travel, as the positioning modules ask for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// 1 or -1.
    pub direction: i8,
    /// It turns round on the cam: the zero mark lies on the side that it comes from.
    pub back: bool,
    /// To the cam, on it, beside it to the zero mark (inc/s).
    pub speeds: [f64; 3],
    /// Of all of its motions.
    pub limits: Limits,
    /// From the zero mark to the reference point (inc).
    pub shift: i64,
    /// Position of the reference point (inc).
    pub value: i64,
}

/// What a vocabulary asks of its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// To a position, from the present motion.
    Position {
        /// (inc), before rounding to whole increments.
        target: Position,
        /// Of the motion.
        limits: Limits,
        /// What `reference` shows.
        reference: Reference,
    },
    /// At a velocity, without end.
    Velocity {
        /// (inc/s), signed; 0 stops.
        velocity: f64,
        /// Of the motion.
        limits: Limits,
    },
    /// To rest, wherever that is.
    Stop {
        /// Of the stop.
        limits: Limits,
    },
    /// The actual position becomes the command, at rest and at once: no ramp.
    StandOnActual,
    /// Follows the master of its vocabulary through the gear of the axis.
    Gear {
        /// Way of the leader that is past already and counts (inc): from the freeze point to t_k.
        past: Position,
    },
    /// Follows it through a cam.
    Cam {
        /// Where it starts, wherever master and slave are.
        from: CamPoint,
        /// As of a gear.
        past: Position,
    },
    /// Homing as configured.
    Home,
    /// Reference travel, as long as nothing else is ordered.
    ReferenceTravel(Travel),
    /// Open loop: the drive runs at this speed (inc/s), signed; 0 switches its output off, and it coasts.
    Speed {
        /// (inc/s)
        velocity: f64,
    },
    /// The drive on.
    SwitchOn,
    /// The drive off, at once: it coasts.
    SwitchOff,
    /// An alarm of the vocabulary: the axis does what its `error_reaction` says, and nobody owns it then.
    Fail {
        /// Which.
        code: Code,
        /// What was found.
        found: Number,
        /// What is allowed.
        allowed: Number,
    },
    /// The alarm is acknowledged: the axis, at rest, leaves the error that [`Order::Fail`] made, and no other one.
    Reset,
    /// An error of the axis, with its drive off at once.
    FailOff {
        /// Why, with its numbers.
        refusal: Refusal,
    },
}

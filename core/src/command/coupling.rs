//! Couplings of one axis to a leader: start, phase shift and end.

use crate::modulo::Modulo;
use crate::object::{Leader, Object};
use crate::position::Length;
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::unit::{Amount, Scale};
use serde::{Deserialize, Serialize};

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

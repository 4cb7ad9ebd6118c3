//! Fixed properties of an axis.

use super::brake_state::BrakeConfig;
use super::safety::Safety;
use super::source::Wired;
use crate::drive::{AnalogWiring, Capabilities, Interface, SpeedOutputs};
use crate::modulo::Modulo;
use crate::regulator::Law;
use crate::vocabulary::{Setting, Wiring};
use serde::{Deserialize, Serialize};

/// Longest delay of a drive in cycles.
pub const MAX_DELAY: u32 = 32;

/// Fixed properties of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisSetup {
    /// Index among the axes.
    pub index: u16,
    /// Index among the drives, and capabilities of the drive; none for a virtual axis.
    pub drive: Option<(usize, Capabilities)>,
    /// Index among the gantries, if it has two drives.
    pub gantry: Option<u16>,
    /// Length of a turn.
    pub modulo: Option<Modulo>,
    /// Command interface of its drive.
    pub interface: Interface,
    /// Law of its position loop, if it is closed here.
    pub law: Law,
    /// Tolerated cycles without new data from its drive.
    pub missed_cycles: u32,
    /// Time within which its drive must switch on (ns).
    pub enable_timeout_ns: u64,
    /// Increments per axis unit.
    pub unit: f64,
    /// Wiring of its vocabularies.
    pub vocabularies: Wiring,
    /// Outputs of an open-loop axis.
    pub open_loop: SpeedOutputs,
    /// Wiring of its drive, if that is not on a bus.
    pub analog: Option<AnalogWiring>,
    /// Contacts of the cell that must be closed.
    pub safety: Safety,
    /// Index among the axes with a drive, and their number.
    pub round: (u32, u32),
    /// Source of its position.
    pub wired: Wired,
    /// Number of encoders of the machine.
    pub encoders: usize,
    /// Brake that the axis itself closes and opens.
    pub brake: Option<BrakeConfig>,
    /// Index of its pitch error among the tables.
    pub pitch_error: Option<u16>,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
}

impl AxisSetup {
    /// Returns the properties that its vocabularies need.
    pub fn setting(&self) -> Setting {
        let is_virtual = self.drive.is_none();
        let Self { modulo, unit, cycle_ns, vocabularies: wiring, .. } = *self;
        Setting { modulo, unit, cycle_ns, wiring, is_virtual }
    }
}

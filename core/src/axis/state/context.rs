//! Data of a cycle for an axis.

use super::run::Run;
use crate::command::Setpoints;
use crate::drive::{DriveInput, Inputs};
use crate::encoder::Encoder;
use crate::event::EventQueue;
use crate::gantry::Gantry;
use crate::sync::Leads;
use crate::table::Table;
use crate::vocabulary::LatchView;
use std::sync::Arc;

/// Data of a cycle for an axis.
pub struct Context<'a> {
    /// Cycle k.
    pub cycle: u64,
    /// Inputs of its drive.
    pub input: Option<&'a DriveInput>,
    /// All inputs of the cycle.
    pub inputs: &'a Inputs,
    /// Indices of the digital inputs in section `io`.
    pub digital_inputs: &'a [u16],
    /// The leaders, as far as they have been updated in this cycle.
    pub leads: &'a Leads,
    /// The tables of the machine.
    pub tables: &'a [Arc<Table>],
    /// The encoders in this cycle.
    pub encoders: &'a [Encoder],
    /// The latches of this cycle.
    pub latches: &'a [LatchView],
    /// New streamed setpoints.
    pub stream: Option<&'a Setpoints>,
    /// The active trajectories.
    pub runs: &'a [Option<Run>],
    /// The state of its two drives, if it has two.
    pub gantry: Option<&'a mut Gantry>,
    /// Queue of events.
    pub events: &'a mut EventQueue,
}

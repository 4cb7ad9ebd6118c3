//! Records a simulation that does not run in real time: each cycle is encoded and written immediately.

use super::bag::{Bag, BagError, BagOptions, Subject, Summary};
use super::encoder::Encoder;
use super::{Cycle, CycleTime, key_cycles};
use crate::cell::Cell;
use lineshaft_core::command::{Command, Commands};
use lineshaft_core::drive::Inputs;
use lineshaft_core::machine::{Machine, State};

/// Recorder of a simulation. Time is t_k, from 0.
pub struct SimulationRecorder {
    bag: Bag,
    encoder: Encoder,
    cycle_ns: u64,
    key_cycles: u64,
    state: Option<State>,
    commands: Vec<Command>,
}

impl SimulationRecorder {
    /// Begins a bag for a machine of `cell` before its first cycle. `scenario` is the name of the scenario that is
    /// played, if any.
    ///
    /// # Errors
    /// Returns an error if the bag cannot be created.
    pub fn new(cell: &Cell, machine: &Machine, options: &BagOptions, scenario: Option<&str>) -> Result<Self, BagError> {
        let subject = Subject { scenario: scenario.map(str::to_owned), ..Subject::new(cell, &cell.ros.node_name()) };
        let cycle_ns = machine.config().cycle_ns;
        Ok(Self {
            bag: Bag::create(options, subject)?,
            encoder: Encoder::new(cell, machine.config(), machine.directory()),
            cycle_ns,
            key_cycles: key_cycles(cycle_ns),
            state: None,
            commands: Vec::new(),
        })
    }

    /// Stores the state before a key cycle.
    pub fn before(&mut self, machine: &Machine) {
        let is_key = machine.next_cycle().is_multiple_of(self.key_cycles);
        self.state = is_key.then(|| machine.state().clone());
    }

    /// Writes the last cycle.
    ///
    /// # Errors
    /// Returns the error of the disk.
    pub fn after(&mut self, inputs: &Inputs, commands: Commands<'_>, machine: &Machine) -> Result<(), BagError> {
        self.commands.clear();
        self.commands.extend(commands.iter().cloned());
        let cycle = Cycle {
            time: CycleTime::same(inputs.cycle.saturating_mul(self.cycle_ns)),
            inputs,
            commands: &self.commands,
            stream: commands.stream,
            events: machine.events(),
            board: machine.board(),
        };
        let encoded = self.encoder.encode(&cycle);
        match self.state.take() {
            Some(state) => self.bag.write(&encoded.with_state(&state, machine.config())),
            None => self.bag.write(&encoded),
        }
    }

    /// Ends the bag.
    ///
    /// # Errors
    /// Returns the error of the disk.
    pub fn finish(self) -> Result<Summary, BagError> {
        self.bag.finish()
    }
}

//! Backends of a machine, with which the cycle thread exchanges inputs and outputs.
//!
//! Law      each backend accesses its own objects; inputs of a cycle start as absent, so the order of the backends does
//!          not matter
//! Source   contract section 8

use lineshaft_core::drive::{Backend, Inputs, Outputs};
use lineshaft_core::sim::Plant;

/// Any number of backends of any kind.
#[derive(Default)]
pub struct Backends {
    /// Simulated backends, on which scenarios act.
    pub plant: Option<Plant>,
    others: Vec<Box<dyn Backend>>,
}

impl Backends {
    /// Creates backends that consist of a simulation only.
    pub fn simulated(plant: Plant) -> Self {
        Self { plant: Some(plant), others: Vec::new() }
    }

    /// Adds a backend.
    pub fn with(mut self, backend: Box<dyn Backend>) -> Self {
        self.others.push(backend);
        self
    }

    /// Returns all backends.
    pub fn all(&self) -> Vec<&dyn Backend> {
        let plant = self.plant.iter().map(|plant| plant as &dyn Backend);
        plant.chain(self.others.iter().map(AsRef::as_ref)).collect()
    }

    /// Reads the inputs of a cycle that has begun.
    pub fn read(&mut self, inputs: &mut Inputs) {
        if let Some(plant) = &mut self.plant {
            plant.read(inputs);
        }
        self.others.iter_mut().for_each(|backend| backend.read(inputs));
    }

    /// Writes the outputs of the cycle.
    pub fn write(&mut self, outputs: &Outputs) {
        if let Some(plant) = &mut self.plant {
            plant.write(outputs);
        }
        self.others.iter_mut().for_each(|backend| backend.write(outputs));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::{Cell, CellBackend};
    use lineshaft_core::command::{Action, Command, Commands, Source};
    use lineshaft_core::drive::{Capabilities, DriveInput};
    use lineshaft_core::machine::Machine;
    use lineshaft_core::object::AxisSet;

    const CELL: &str = "lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}, bus0: {type: can, transport: 'socketcan:can0'}}
axes:
  x: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 4}, max_velocity: 1 m/s,
      max_acceleration: 1 m/s^2}
  y: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {backend: bus0, node: 3}, max_velocity: 1 m/s,
      max_acceleration: 1 m/s^2}
";

    /// A drive of another kind: it follows its setpoints immediately and needs no power.
    struct Direct {
        place: usize,
        count: i64,
        mode: i8,
    }

    impl Backend for Direct {
        fn capabilities(&self, drive: usize) -> Option<Capabilities> {
            (drive == self.place).then(|| Capabilities { delay: 1, position: true, ..Capabilities::default() })
        }

        fn read(&mut self, inputs: &mut Inputs) {
            let Self { place, count, mode } = *self;
            inputs.drive[place] =
                DriveInput { count, mode, status: 0x37, online: true, fresh: true, ..Default::default() };
        }

        fn write(&mut self, outputs: &Outputs) {
            let asked = outputs.drive[self.place];
            (self.count, self.mode) = (asked.position, asked.mode.number());
        }
    }

    #[test]
    fn two_kinds_of_backends_share_a_machine_and_touch_their_own_objects() {
        let mut cell = Cell::parse("c.yaml", CELL).unwrap();
        // The cell describes a drive on CAN with the capabilities of its simulation.
        cell.machine.axes[1].drive = Some(Capabilities { delay: 1, position: true, ..Capabilities::default() });
        let direct = || Box::new(Direct { place: 1, count: 0, mode: 0 });
        // A simulation of every backend has the capabilities given by the cell.
        let simulated = Backends::simulated(cell.plant());
        assert_eq!(cell.machine.check_backends(&simulated.all()), Ok(()));
        let plant = cell.plant_of(CellBackend::is_simulated);
        let alone = Backends::simulated(plant.clone());
        let error = cell.machine.check_backends(&alone.all()).unwrap_err();
        assert_eq!(error.to_string(), "drive of y: no backend serves it");
        let mut backends = Backends::simulated(plant).with(direct());
        assert_eq!(cell.machine.check_backends(&backends.all()), Ok(()));
        let mut machine = Machine::new(cell.machine).unwrap();
        let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
        for cycle in 0..40 {
            inputs.begin(cycle, 0);
            backends.read(&mut inputs);
            let enable = [Command { sequence: 1, source: Source::Cli, action: Action::Enable(AxisSet::first(2)) }];
            let commands = if cycle == 5 { Commands::queue(&enable) } else { Commands::default() };
            machine.cycle(&inputs, commands, &mut outputs);
            backends.write(&outputs);
        }
        for name in ["x.enabled", "y.enabled"] {
            assert!(machine.board().bit(machine.directory().find(name).unwrap()), "{name}");
        }
        inputs.begin(40, 0);
        assert!(inputs.drive.iter().all(|drive| !drive.online), "nobody has answered yet");
    }
}

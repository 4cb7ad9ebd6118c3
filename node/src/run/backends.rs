//! Backends of a machine, with which the cycle thread exchanges inputs and outputs.
//!
//! Law      each backend accesses its own objects; inputs of a cycle start as absent, so the order of the backends does
//!          not matter. At most one backend owns the clock of the cycle and shifts its deadlines
//! Refuses  a second owner of the clock
//! Source   contract section 8

use lineshaft_core::drive::{Backend, DeviceObjects, FrameSource, Inputs, Outputs, Service};
use lineshaft_core::sim::Plant;
use std::sync::Arc;

/// A backend before its start.
pub struct NewBackend {
    /// Its name in the cell.
    pub name: String,
    /// Its cyclic half.
    pub cyclic: Box<dyn Backend>,
    /// Its service half.
    pub service: Box<dyn Service>,
    /// Objects of its devices, if they have some.
    pub objects: Option<Arc<dyn DeviceObjects>>,
    /// Frames of its bus, if they are recorded.
    pub frames: Option<Box<dyn FrameSource>>,
}

/// Any number of backends of any kind.
#[derive(Default)]
pub struct Backends {
    /// Simulated backends, on which scenarios act. They do not own the clock of the cycle.
    pub plant: Option<Plant>,
    others: Vec<NamedBackend>,
    /// Index of the backend that owns the clock of the cycle.
    clock: Option<usize>,
}

/// A backend with its name in the cell.
struct NamedBackend {
    name: String,
    backend: Box<dyn Backend>,
}

/// Two backends own the clock of the cycle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("backends {first} and {second}: both own the clock of the cycle; at most one backend of a cell may own it")]
pub struct ClockConflict {
    /// Name of the first owner.
    pub first: String,
    /// Name of the second owner.
    pub second: String,
}

impl Backends {
    /// Creates backends that consist of a simulation only.
    pub fn simulated(plant: Plant) -> Self {
        Self { plant: Some(plant), ..Self::default() }
    }

    /// Adds a backend; `name` is its name in the cell.
    pub fn with(mut self, name: impl Into<String>, backend: Box<dyn Backend>) -> Self {
        if backend.owns_clock() {
            self.clock.get_or_insert(self.others.len());
        }
        self.others.push(NamedBackend { name: name.into(), backend });
        self
    }

    /// Checks that at most one backend owns the clock of the cycle. Call it before they start.
    ///
    /// # Errors
    /// Returns the first two owners.
    pub fn check_clock(&self) -> Result<(), ClockConflict> {
        let mut owners = self.others.iter().filter(|named| named.backend.owns_clock()).map(|named| named.name.clone());
        match (owners.next(), owners.next()) {
            (Some(first), Some(second)) => Err(ClockConflict { first, second }),
            _ => Ok(()),
        }
    }

    /// Returns all backends.
    pub fn all(&self) -> Vec<&dyn Backend> {
        let plant = self.plant.iter().map(|plant| plant as &dyn Backend);
        plant.chain(self.others.iter().map(|named| named.backend.as_ref())).collect()
    }

    /// Reads the inputs of a cycle that has begun.
    pub fn read(&mut self, inputs: &mut Inputs) {
        if let Some(plant) = &mut self.plant {
            plant.read(inputs);
        }
        self.others.iter_mut().for_each(|named| named.backend.read(inputs));
    }

    /// Writes the outputs of the cycle.
    pub fn write(&mut self, outputs: &Outputs) {
        if let Some(plant) = &mut self.plant {
            plant.write(outputs);
        }
        self.others.iter_mut().for_each(|named| named.backend.write(outputs));
    }

    /// Returns by how much the next deadline of the cycle shifts, in ns, positive for later; 0 if no backend owns the
    /// clock. `pending_ns` is the sum of the earlier shifts that is not applied yet. Call it once in each cycle, after
    /// [`write`](Self::write).
    pub fn clock_shift(&mut self, pending_ns: i64) -> i64 {
        let owner = self.clock.and_then(|place| self.others.get_mut(place));
        owner.map_or(0, |named| named.backend.clock_shift(pending_ns))
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
        let mut backends = Backends::simulated(plant).with("bus0", direct());
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

    /// A backend without objects that may own the clock.
    struct Clock {
        owns: bool,
        shift_ns: i64,
    }

    impl Backend for Clock {
        fn capabilities(&self, _: usize) -> Option<Capabilities> {
            None
        }

        fn read(&mut self, _: &mut Inputs) {}

        fn write(&mut self, _: &Outputs) {}

        fn owns_clock(&self) -> bool {
            self.owns
        }

        fn clock_shift(&mut self, pending_ns: i64) -> i64 {
            self.shift_ns - pending_ns
        }
    }

    fn clock(owns: bool, shift_ns: i64) -> Box<dyn Backend> {
        Box::new(Clock { owns, shift_ns })
    }

    #[test]
    fn second_owner_of_the_clock_is_refused_by_name() {
        let one = || Backends::default().with("bus0", clock(false, 1)).with("ecat0", clock(true, 2));
        assert_eq!(one().check_clock(), Ok(()));
        let error = one().with("ecat1", clock(true, 3)).check_clock().unwrap_err();
        let expected =
            "backends ecat0 and ecat1: both own the clock of the cycle; at most one backend of a cell may own it";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn only_the_owner_of_the_clock_shifts_the_deadline() {
        let mut backends = Backends::default().with("bus0", clock(false, 100)).with("ecat0", clock(true, 20));
        assert_eq!([0, 5, -5].map(|pending| backends.clock_shift(pending)), [20, 15, 25]);
        assert_eq!(Backends::default().with("bus0", clock(false, 100)).clock_shift(7), 0);
        assert_eq!(Backends::simulated(Cell::demo().plant()).clock_shift(7), 0);
    }
}

//! A machine of one closed-loop axis with an ideal drive.

use crate::code::Code;
use crate::command::{Action, Command, Commands, Source};
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::{Backend, Capabilities, Inputs, Outputs};
use crate::event::{Event, Kind};
use crate::machine::Machine;
use crate::object::AxisSet;
use crate::parameter::AxisParameters;
use crate::signal::Value;
use crate::sim::{Model, Plant};
use crate::unit::{Fraction, Quantity, Scale, Unit};
use crate::vocabulary::wf::Request;

pub(super) struct Rig {
    pub machine: Machine,
    pub plant: Plant,
    inputs: Inputs,
    outputs: Outputs,
    sequence: u64,
    pub events: Vec<Event>,
    /// Another machine that does the same from some cycle on.
    mirror: Option<Machine>,
}

/// 1000 inc/mm; 500 mm/s, 100 mm/s^2 up and 200 mm/s^2 down.
pub(super) fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).and_then(|scale| scale.with_unit(Unit::MILLIMETRE));
    let mut parameters = AxisParameters::new(500_000.0, 1_000_000.0);
    parameters.error_reaction = 2;
    (parameters.vocabularies.wf.md1, parameters.vocabularies.wf.md2) = (Some(100_000.0), Some(200_000.0));
    let axis = AxisConfig::new("x".into(), scale.expect("a scale"), Some(Capabilities::all(0)), parameters);
    MachineConfig { cycle_ns: 1_000_000, axes: vec![axis], ..MachineConfig::default() }
}

impl Rig {
    /// Switched on.
    pub(super) fn of(config: MachineConfig) -> Self {
        let plant = Plant::new(&config, &[Some(Model::Ideal)]);
        let machine = Machine::new(config).expect("a machine");
        let (inputs, outputs) = (machine.inputs(), machine.outputs());
        let mut rig = Self { machine, plant, inputs, outputs, sequence: 0, events: Vec::new(), mirror: None };
        rig.act(Action::Enable(AxisSet::first(1)));
        rig.run(40);
        rig
    }

    pub(super) fn new() -> Self {
        Self::of(config())
    }

    /// One cycle with an action; what refused it.
    pub(super) fn act(&mut self, action: Action) -> Option<Code> {
        self.sequence += 1;
        let command = Command { sequence: self.sequence, source: Source::Scenario, action };
        let before = self.events.len();
        self.cycle(Commands::queue(&[command]));
        let refused = self.events[before..].iter().find(|event| event.kind == Kind::Refused);
        refused.map(|event| event.code)
    }

    pub(super) fn give(&mut self, request: &Request) -> Option<Code> {
        self.act(Action::vocabulary(request.clone()))
    }

    fn cycle(&mut self, commands: Commands<'_>) {
        self.inputs.begin(self.machine.next_cycle(), 0);
        self.plant.read(&mut self.inputs);
        self.machine.cycle(&self.inputs, commands, &mut self.outputs);
        if let Some(mirror) = &mut self.mirror {
            let mut outputs = mirror.outputs();
            mirror.cycle(&self.inputs, commands, &mut outputs);
            assert_eq!((mirror.events(), &outputs), (self.machine.events(), &self.outputs));
            assert!(mirror.board() == self.machine.board());
        }
        self.plant.write(&self.outputs);
        self.events.extend_from_slice(self.machine.events());
    }

    /// From now on a machine that was restored from the state of this one must do the same.
    pub(super) fn mirror(&mut self) {
        let bytes = postcard::to_allocvec(self.machine.state()).expect("bytes");
        let state = postcard::from_bytes(&bytes).expect("a state");
        self.mirror = Some(Machine::restore(self.machine.config().clone(), state).expect("a machine"));
    }

    pub(super) fn run(&mut self, cycles: u64) {
        (0..cycles).for_each(|_| self.cycle(Commands::default()));
    }

    /// Cycles until a signal has a value.
    pub(super) fn run_until(&mut self, name: &str, value: i64) -> u64 {
        for cycle in 0..100_000 {
            if self.int(name) == value {
                return cycle;
            }
            self.run(1);
        }
        panic!("{name} never became {value}; it is {}", self.int(name));
    }

    fn value(&self, name: &str) -> Value {
        let directory = self.machine.directory();
        let signal = directory.find(name).expect("a signal");
        self.machine.board().value(signal, directory.entry(signal).kind)
    }

    pub(super) fn int(&self, name: &str) -> i64 {
        match self.value(name) {
            Value::Int(value) => value,
            Value::Real(value) => panic!("{name} is {value}"),
        }
    }

    pub(super) fn real(&self, name: &str) -> f64 {
        match self.value(name) {
            Value::Real(value) => value,
            Value::Int(value) => panic!("{name} is {value}"),
        }
    }

    pub(super) fn state(&self) -> &'static str {
        super::super::STATES[self.int("x.wf.state") as usize]
    }

    /// Codes of the errors so far.
    pub(super) fn errors(&self) -> Vec<Code> {
        self.events.iter().filter(|event| event.kind == Kind::Error).map(|event| event.code).collect()
    }
}

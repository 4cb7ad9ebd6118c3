//! A machine with a simulated plant, for the tests of the cycle and of the vocabularies.

use crate::axis::Context;
use crate::command::{
    Action, BufferMode, CamIn, Command, Commands, Engage, Move, MoveMode, Setpoint, Setpoints, Source, Synchronize,
};
use crate::config::{AxisConfig, EncoderConfig, MachineConfig};
use crate::drive::{Backend, Capabilities, Inputs, Outputs};
use crate::event::{Event, Kind, Refusal};
use crate::machine::Machine;
use crate::modulo::Direction;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{self, AxisParameters};
use crate::position::Length;
use crate::signal::Value;
use crate::sim::{Model, Plant};
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::unit::{Fraction, Quantity, Scale, Unit};
use crate::vocabulary::{Order, Owner, saia};

pub(crate) const LINE: u16 = 0;
pub(crate) const X: u16 = 1;
pub(crate) const Y: u16 = 2;

pub(crate) struct Rig {
    pub machine: Machine,
    pub plant: Plant,
    inputs: Inputs,
    outputs: Outputs,
    sequence: u64,
    /// All events so far.
    pub events: Vec<Event>,
    /// Modification of the inputs before the machine reads them.
    pub modify_inputs: fn(&mut Inputs),
    /// A second machine that must produce the same results from some cycle on.
    mirror: Option<Machine>,
    /// A machine that runs every cycle of every axis in full and must produce the same results from the beginning.
    pub full_cycle_machine: Option<Machine>,
}

/// Returns a scale of 1000 inc/mm.
pub(crate) fn scale() -> Scale {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    Scale::new(Fraction::from_integer(1000), per).unwrap().with_unit(Unit::MILLIMETRE).unwrap()
}

/// Returns parameters with 100 mm/s and 1 m/s^2, at 1000 inc/mm.
pub(crate) fn parameters() -> AxisParameters {
    AxisParameters { error_reaction: 2, ..AxisParameters::new(100_000.0, 1_000_000.0) }
}

/// Returns the verb `saia` on x: to 50 mm with 20 mm/s and 200 mm/s^2, as far as the commands load these values.
pub(crate) fn saia_verb(commands: &[saia::Command]) -> Action {
    let commands = saia::Commands::from_iter(commands.iter().copied());
    let request = saia::Request { axis: X, commands, ..Default::default() };
    let request = request.with(saia::Register::DestP, parameter::Value::Int(50_000));
    let request = request.with(saia::Register::Veloc, parameter::Value::Int(20_000));
    Action::vocabulary(request.with(saia::Register::Accel, parameter::Value::Int(200_000)))
}

pub(crate) fn config(delay: u32) -> MachineConfig {
    let axis = |name: &str, drive: Option<u32>| {
        AxisConfig::new(name.into(), scale(), drive.map(Capabilities::all), parameters())
    };
    MachineConfig {
        cycle_ns: 1_000_000,
        encoders: vec![EncoderConfig {
            name: "belt".into(),
            form: crate::encoder::Form::Incremental(16),
            check: None,
            scale: scale(),
        }],
        axes: vec![axis("line", None), axis("x", Some(delay)), axis("y", Some(0))],
        ..MachineConfig::default()
    }
}

fn give_order(machine: &mut Machine, axis: u16, order: Order) -> Result<(), Refusal> {
    let cycle = machine.next_cycle();
    let inputs = machine.inputs();
    let Machine { state, events, .. } = machine;
    events.begin(cycle, state.next_event);
    let mut cx = Context {
        cycle,
        input: None,
        inputs: &inputs,
        digital_inputs: &[],
        leads: &state.leads,
        tables: &state.tables,
        encoders: &state.encoders,
        latches: &[],
        stream: None,
        runs: &[],
        gantry: None,
        events: &mut *events,
    };
    state.axes[usize::from(axis)].require_full_cycle();
    let result = state.axes[usize::from(axis)].execute(&mut cx, Owner::Wf, order);
    state.next_event = events.next();
    result
}

impl Rig {
    pub(crate) fn new() -> Self {
        Self::of(config(0))
    }

    /// Returns a rig with ideal drives.
    pub(crate) fn of(config: MachineConfig) -> Self {
        let models = vec![Model::Ideal; config.count_drives()];
        Self::with(config, models)
    }

    /// Returns a rig with these models of the drives, in the order of their axes.
    pub(crate) fn with(config: MachineConfig, models: impl IntoIterator<Item = Model>) -> Self {
        let models: Vec<_> = models.into_iter().map(Some).collect();
        let plant = Plant::new(&config, &models);
        let plain = Some(Machine { steps_all: true, ..Machine::new(config.clone()).unwrap() });
        let machine = Machine::new(config).unwrap();
        let (inputs, outputs) = (machine.inputs(), machine.outputs());
        Self {
            machine,
            plant,
            inputs,
            outputs,
            sequence: 0,
            events: Vec::new(),
            modify_inputs: |_| {},
            mirror: None,
            full_cycle_machine: plain,
        }
    }

    /// Returns a rig with x and y switched on.
    pub(crate) fn enabled() -> Self {
        let mut rig = Self::new();
        rig.enable();
        rig
    }

    /// Switches all axes on.
    pub(crate) fn enable(&mut self) {
        let count = self.machine.config().axes.len();
        let sequence = self.give(Action::Enable(AxisSet::first(count)));
        self.run(40);
        assert_eq!(self.done(sequence).len(), count);
    }

    /// Runs one cycle with these actions. Returns the last of their sequence numbers.
    pub(crate) fn give_all(&mut self, actions: Vec<Action>) -> u64 {
        let commands: Vec<Command> = actions
            .into_iter()
            .map(|action| {
                self.sequence += 1;
                Command { sequence: self.sequence, source: Source::Scenario, action }
            })
            .collect();
        self.cycle(Commands::queue(&commands));
        self.sequence
    }

    /// Runs one cycle with a new setpoint for an axis.
    pub(crate) fn stream(&mut self, axis: u16, velocity: f64) {
        self.stream_for(axis, Setpoint { velocity, duration: None });
    }

    pub(crate) fn stream_for(&mut self, axis: u16, setpoint: Setpoint) {
        let mut stream = Setpoints::none(self.machine.config().axes.len());
        stream.axes[usize::from(axis)] = Some(setpoint);
        self.cycle(Commands { stream: Some(&stream), ..Commands::default() });
    }

    pub(crate) fn give(&mut self, action: Action) -> u64 {
        self.give_all(vec![action])
    }

    pub(crate) fn cycle(&mut self, commands: Commands<'_>) {
        self.inputs.begin(self.machine.next_cycle(), 0);
        self.plant.read(&mut self.inputs);
        (self.modify_inputs)(&mut self.inputs);
        self.machine.cycle(&self.inputs, commands, &mut self.outputs);
        let cycle = self.inputs.cycle;
        for other in [&mut self.mirror, &mut self.full_cycle_machine].into_iter().flatten() {
            let mut outputs = other.outputs();
            other.cycle(&self.inputs, commands, &mut outputs);
            assert_eq!((other.events(), &outputs), (self.machine.events(), &self.outputs), "in cycle {cycle}");
            assert!(other.board() == self.machine.board(), "other signals in cycle {cycle}");
        }
        if let Some(plain) = self.full_cycle_machine.as_ref().filter(|_| cycle.is_multiple_of(64)) {
            let image = |machine: &Machine| postcard::to_allocvec(machine.state()).unwrap();
            assert!(image(plain) == image(&self.machine), "another state behind cycle {cycle}");
            let agree = self.machine.state.axes.iter().all(|axis| axis.parameters.is_consistent());
            assert!(agree, "what is kept of parameters does not follow from them in cycle {cycle}");
        }
        self.plant.write(&self.outputs);
        self.note_events();
    }

    /// Records the events. Every error must have a row in the table of reactions, which docs/errors.md shows.
    fn note_events(&mut self) {
        let events = self.machine.events();
        for event in events.iter().filter(|event| event.kind == Kind::Error && matches!(event.source, Object::Axis(_)))
        {
            // With motor_off every refusal of a SAIA command is an error.
            let is_refusal = matches!(event.source, Object::Axis(axis)
                if self.machine.parameters(axis).is_some_and(|p| p.vocabularies.saia.command_error == 2));
            assert!(is_refusal || event.code.class().is_some(), "{event:?} has no line in the table of reactions");
        }
        self.events.extend_from_slice(events);
    }

    /// Runs one cycle with a new value for a parameter of x.
    #[track_caller]
    pub(crate) fn set(&mut self, key: &str, value: parameter::Value) -> u64 {
        let row = parameter::Row::find(key).unwrap_or_else(|| panic!("no row {key}")).0;
        self.give(Action::SetParameters([parameter::Change { axis: X, row, value }].into()))
    }

    /// Gives an axis an order of a vocabulary, before the next cycle.
    pub(crate) fn order(&mut self, axis: u16, order: Order) -> Result<(), Refusal> {
        for other in [&mut self.mirror, &mut self.full_cycle_machine].into_iter().flatten() {
            give_order(other, axis, order).ok();
        }
        let result = give_order(&mut self.machine, axis, order);
        self.note_events();
        result
    }

    /// Returns the outputs of the last cycle.
    pub(crate) fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// Returns the inputs of the last cycle.
    pub(crate) fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Returns another machine, restored from the state of this one.
    pub(crate) fn restored_machine(&self) -> Machine {
        let bytes = postcard::to_allocvec(self.machine.state()).unwrap();
        let state = postcard::from_bytes(&bytes).unwrap();
        Machine::restore(self.machine.config().clone(), state).unwrap()
    }

    /// Adds a restored machine that must produce the same results from now on.
    pub(crate) fn mirror(&mut self) {
        self.mirror = Some(self.restored_machine());
    }

    pub(crate) fn run(&mut self, cycles: u64) {
        for _ in 0..cycles {
            self.cycle(Commands::default());
        }
    }

    /// Runs until a signal has a value. Returns the number of cycles that it took.
    #[track_caller]
    pub(crate) fn run_until(&mut self, name: &str, value: i64) -> u64 {
        for cycle in 0..200_000 {
            if self.int(name) == value {
                return cycle;
            }
            self.run(1);
        }
        panic!("{name} never became {value}; it is {}", self.int(name));
    }

    /// Runs until a signal is at least that value.
    #[track_caller]
    pub(crate) fn run_to(&mut self, name: &str, value: f64) {
        for _ in 0..200_000 {
            if self.real(name) >= value {
                return;
            }
            self.run(1);
        }
        panic!("{name} never came to {value}; it is {}", self.real(name));
    }

    pub(crate) fn value(&self, name: &str) -> Value {
        let directory = self.machine.directory();
        let signal = directory.find(name).unwrap_or_else(|| panic!("no signal {name}"));
        self.machine.board().value(signal, directory.entry(signal).kind)
    }

    pub(crate) fn int(&self, name: &str) -> i64 {
        match self.value(name) {
            Value::Int(value) => value,
            Value::Real(value) => panic!("{name} is real: {value}"),
        }
    }

    pub(crate) fn real(&self, name: &str) -> f64 {
        self.value(name).to_f64()
    }

    pub(crate) fn state(&self, axis: &str) -> &'static str {
        crate::state::AXIS_STATES[self.int(&format!("{axis}.state")) as usize]
    }

    fn of_command(&self, sequence: u64, kind: Kind) -> Vec<Event> {
        self.events.iter().filter(|event| event.command == sequence && event.kind == kind).copied().collect()
    }

    pub(crate) fn done(&self, sequence: u64) -> Vec<Event> {
        self.of_command(sequence, Kind::Done)
    }

    /// Returns the answer to a command: an error with the refusal if it was refused.
    pub(crate) fn answer(&self, sequence: u64) -> Result<(), Box<Event>> {
        let refused = self.of_command(sequence, Kind::Refused);
        let answers = refused.len() + self.of_command(sequence, Kind::Accepted).len();
        assert_eq!(answers, 1, "answered once");
        refused.first().map_or(Ok(()), |event| Err(Box::new(*event)))
    }

    /// Returns the message of a refused command.
    pub(crate) fn refusal(&self, sequence: u64) -> String {
        let refused = self.answer(sequence).expect_err("a refusal");
        crate::text::message(&refused, self.machine.config())
    }

    pub(crate) fn was_accepted(&self, sequence: u64) -> bool {
        assert!(self.of_command(sequence, Kind::Refused).is_empty());
        self.of_command(sequence, Kind::Accepted).len() == 1
    }
}

/// Returns a configuration with `few` test cases, and 50 times as many with LINESHAFT_LONG.
pub(crate) fn cases(few: u32) -> proptest::prelude::ProptestConfig {
    let long = std::env::var_os("LINESHAFT_LONG").is_some();
    proptest::prelude::ProptestConfig::with_cases(if long { few.saturating_mul(50) } else { few })
}

pub(crate) fn to(axis: u16, position: i64) -> Move {
    Move {
        axis,
        mode: MoveMode::Absolute,
        target: Length::whole(position),
        velocity: 0.0,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        direction: Direction::Shortest,
        buffer_mode: BufferMode::Aborting,
    }
}

pub(crate) fn at(axis: u16, velocity: f64) -> Move {
    Move { mode: MoveMode::Velocity, velocity, ..to(axis, 0) }
}

/// Returns the unscaled cam of a table.
pub(crate) fn cam(table: u16, start: CamStart) -> CamIn {
    CamIn {
        table,
        start,
        master_scale: Ratio::ONE,
        slave_scale: Ratio::ONE,
        master_offset: Length::default(),
        slave_offset: Length::default(),
    }
}

pub(crate) fn couple(axis: u16, leader: Leader, numerator: i64, denominator: i64) -> Synchronize {
    Synchronize {
        axis,
        leader: Some(leader),
        mode: SyncMode::Position,
        engage: Engage::Immediately,
        disengage: Disengage::Stop,
        numerator,
        denominator,
        offset: Length::default(),
        velocity: 0.0,
        acceleration: 0.0,
        cam: None,
    }
}

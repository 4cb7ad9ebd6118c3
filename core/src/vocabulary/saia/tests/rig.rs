//! A machine with one axis on a simulated drive and a virtual one.

use crate::command::{Action, Command, Commands, Source};
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::{Backend, Capabilities, Edge, Inputs, Latch, Outputs};
use crate::event::{Event, Kind};
use crate::machine::Machine;
use crate::object::{AxisSet, Object};
use crate::parameter::{AxisParameters, Change, ParameterInput, Row, Value};
use crate::signal;
use crate::sim::{Model, Plant};
use crate::unit::{Fraction, Quantity, Scale, Unit};
use crate::vocabulary::saia::{Command as Flag, Register, Request};

/// The axis with a drive.
pub(super) const X: u16 = 0;
/// The virtual axis.
pub(super) const V: u16 = 1;

/// An acceptable set of registers: 50 000 counts/s, 1 000 000 counts/s^2, ramp stop, flag only.
pub(super) const FAST: &[(&str, f64)] = &[("veloc", 50_000.0), ("accel", 1_000_000.0), ("poser", 30_000.0)];

pub(super) struct Rig {
    pub machine: Machine,
    pub plant: Plant,
    inputs: Inputs,
    outputs: Outputs,
    sequence: u64,
    pub events: Vec<Event>,
    mirror: Option<Machine>,
}

pub(super) fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
    let parameters =
        AxisParameters { error_reaction: 2, max_following_error: 1_000_000_000, ..AxisParameters::new(1e9, 1e10) };
    let axis = |name: &str, drive| AxisConfig::new(name.into(), scale, drive, parameters);
    MachineConfig {
        cycle_ns: 1_000_000,
        axes: vec![axis("x", Some(Capabilities::all(0))), axis("v", None)],
        ..MachineConfig::default()
    }
}

impl Rig {
    pub(super) fn new() -> Self {
        Self::of(config())
    }

    pub(super) fn of(config: MachineConfig) -> Self {
        let plant = Plant::new(&config, &[Some(Model::Ideal)]);
        let machine = Machine::new(config).unwrap();
        let (inputs, outputs) = (machine.inputs(), machine.outputs());
        Self { machine, plant, inputs, outputs, sequence: 0, events: Vec::new(), mirror: None }
    }

    /// With `axinit` done on x with these registers.
    pub(super) fn ready(set: &[(&str, f64)]) -> Self {
        let mut rig = Self::new();
        rig.run(5);
        rig.does(set, "axinit");
        rig
    }

    /// The same where command errors are only told.
    pub(super) fn logging(set: &[(&str, f64)]) -> Self {
        let mut rig = Self::new();
        rig.run(5);
        rig.parameter("saia.command_error", Value::Int(1));
        rig.does(set, "axinit");
        rig
    }

    /// Moving in state POS to 100 000, at 50 000 counts/s.
    pub(super) fn moving() -> Self {
        let mut rig = Self::ready(FAST);
        rig.does(&[("destp", 100_000.0)], "fldda fstart");
        rig.run_until("x.command.velocity", 49_999.99);
        rig
    }

    /// At rest in state HOLD on its destination 1000.
    pub(super) fn holding() -> Self {
        let mut rig = Self::ready(FAST);
        rig.does(&[("destp", 1000.0)], "fldda fstart");
        rig.run_until("x.saia.ondest", 1.0);
        rig
    }

    /// x is switched on by `enable`.
    pub(super) fn on(&mut self) {
        self.give(vec![Action::Enable(AxisSet::one(X))]).expect("nothing bars it");
        self.run(5);
    }

    pub(super) fn cycle(&mut self, commands: Commands<'_>) {
        self.inputs.begin(self.machine.next_cycle(), 0);
        self.plant.read(&mut self.inputs);
        self.machine.cycle(&self.inputs, commands, &mut self.outputs);
        if let Some(mirror) = &mut self.mirror {
            let mut outputs = mirror.outputs();
            mirror.cycle(&self.inputs, commands, &mut outputs);
            assert_eq!((mirror.events(), &outputs), (self.machine.events(), &self.outputs));
            assert!(mirror.board() == self.machine.board(), "other signals in cycle {}", self.inputs.cycle);
        }
        self.plant.write(&self.outputs);
        self.events.extend_from_slice(self.machine.events());
    }

    /// From now on a machine that was restored from the state of this one must do the same.
    pub(super) fn mirror(&mut self) {
        let bytes = postcard::to_allocvec(self.machine.state()).unwrap();
        let state = postcard::from_bytes(&bytes).unwrap();
        self.mirror = Some(Machine::restore(self.machine.config().clone(), state).unwrap());
    }

    pub(super) fn run(&mut self, cycles: u64) {
        for _ in 0..cycles {
            self.cycle(Commands::default());
        }
    }

    /// Runs until a signal is at least that value.
    #[track_caller]
    pub(super) fn run_until(&mut self, name: &str, value: f64) {
        for _ in 0..200_000 {
            if self.real(name) >= value {
                return;
            }
            self.run(1);
        }
        panic!("{name} never became {value}; it is {}", self.real(name));
    }

    /// Gives all actions in one cycle; the answer of the last one.
    pub(super) fn give(&mut self, actions: Vec<Action>) -> Result<(), String> {
        let commands: Vec<Command> = actions
            .into_iter()
            .map(|action| {
                self.sequence += 1;
                Command { sequence: self.sequence, source: Source::Scenario, action }
            })
            .collect();
        self.cycle(Commands::queue(&commands));
        let answers = self.machine.events().iter().filter(|event| event.command == self.sequence);
        let answers: Vec<&Event> =
            answers.filter(|event| matches!(event.kind, Kind::Accepted | Kind::Refused)).collect();
        let [answer] = answers.as_slice() else { panic!("answered {} times", answers.len()) };
        match answer.kind {
            Kind::Accepted => Ok(()),
            _ => Err(crate::text::sentence(answer, self.machine.config())),
        }
    }

    /// Gives a verb. Where it is refused, the machine must be as one that was not asked.
    pub(super) fn give_or_nothing(&mut self, request: Request) {
        let state = self.machine.state().clone();
        let mut twin = Machine::restore(self.machine.config().clone(), state).unwrap();
        if self.give(vec![Action::vocabulary(request)]).is_err() {
            let mut outputs = twin.outputs();
            twin.cycle(&self.inputs, Commands::default(), &mut outputs);
            assert_eq!(outputs, self.outputs);
            assert!(twin.board() == self.machine.board(), "a refused verb changes a signal");
            assert_eq!(twin.parameters(X), self.machine.parameters(X));
        }
    }

    pub(super) fn request(&self, axis: u16, set: &[(&str, f64)], commands: &str) -> Request {
        let config = self.machine.config();
        let mut request = Request { axis, ..Request::default() };
        for (name, value) in set {
            let input = match *name {
                "mcfac" => ParameterInput::Number(*value),
                _ => ParameterInput::Integer(*value as i64),
            };
            let (register, value) = config.resolve_saia_register(name, &input).unwrap();
            request = request.with(register, value);
        }
        for name in commands.split_whitespace() {
            assert!(request.commands.insert(config.resolve_saia_command(name).unwrap()), "{name} twice");
        }
        request
    }

    pub(super) fn verb(&mut self, axis: u16, set: &[(&str, f64)], commands: &str) -> Result<(), String> {
        let request = self.request(axis, set, commands);
        self.give(vec![Action::vocabulary(request)])
    }

    /// A verb for x that is accepted and has no command error.
    #[track_caller]
    pub(super) fn does(&mut self, set: &[(&str, f64)], commands: &str) {
        let before = self.int("x.saia.command_errors");
        self.verb(X, set, commands).unwrap_or_else(|sentence| panic!("{commands}: {sentence}"));
        assert_eq!(self.int("x.saia.command_errors"), before, "{commands}");
    }

    /// A verb for x that is refused, with a part of the sentence.
    #[track_caller]
    pub(super) fn refuses(&mut self, set: &[(&str, f64)], commands: &str, part: &str) {
        let sentence = self.verb(X, set, commands).expect_err(commands);
        assert!(sentence.contains(part), "{commands}: {sentence}");
    }

    pub(super) fn try_parameter(&mut self, key: &str, value: Value) -> Result<(), String> {
        let (row, _) = Row::find(key).unwrap();
        self.give(vec![Action::SetParameters([Change { axis: X, row, value }].into())])
    }

    #[track_caller]
    pub(super) fn parameter(&mut self, key: &str, value: Value) {
        self.try_parameter(key, value).unwrap();
    }

    pub(super) fn register(&self, register: Register) -> Value {
        let (_, row) = register.row().unwrap();
        row.value(self.machine.parameters(X).unwrap())
    }

    pub(super) fn enable(&mut self) {
        self.give(vec![Action::Enable(AxisSet::one(X))]).unwrap();
        self.run(20);
    }

    pub(super) fn latch(&mut self, age_ns: u32) {
        let latch = Latch { object: Object::Axis(X), edge: Edge::Rising, age_ns: Some(age_ns), position: None };
        assert!(self.plant.add_latch(latch));
    }

    pub(super) fn real(&self, name: &str) -> f64 {
        let directory = self.machine.directory();
        let signal = directory.find(name).unwrap_or_else(|| panic!("no signal {name}"));
        self.machine.board().value(signal, directory.entry(signal).kind).to_f64()
    }

    pub(super) fn int(&self, name: &str) -> i64 {
        let directory = self.machine.directory();
        let signal = directory.find(name).unwrap_or_else(|| panic!("no signal {name}"));
        match self.machine.board().value(signal, directory.entry(signal).kind) {
            signal::Value::Int(value) => value,
            signal::Value::Real(value) => panic!("{name} is real: {value}"),
        }
    }

    /// The state by its name in section 12.
    pub(super) fn state(&self) -> &'static str {
        super::super::STATES[self.int("x.saia.state") as usize]
    }

    /// OnDest, IPuls, WrapOc, ExcPEr, BrkPos of x.
    pub(super) fn flags(&self) -> [i64; 5] {
        ["ondest", "ipuls", "wrapoc", "excper", "brkpos"].map(|flag| self.int(&format!("x.saia.{flag}")))
    }

    /// What `frdsr` reads.
    pub(super) fn signals(&mut self) -> i64 {
        self.does(&[], "frdsr");
        self.int("x.saia.rsigb")
    }

    /// Every signal of x under `saia.` but what the cycle itself changes, and the registers.
    pub(super) fn picture(&self) -> (Vec<i64>, AxisParameters) {
        let directory = self.machine.directory();
        let entries = directory.iter().map(|(_, entry)| entry);
        let names = entries.filter(|entry| entry.name.starts_with("x.saia."));
        let names = names.filter(|entry| !entry.name.ends_with(".position"));
        let words = names.map(|entry| self.int(&entry.name)).collect();
        (words, *self.machine.parameters(X).unwrap())
    }

    /// Warnings that carry a code, so far.
    pub(super) fn warnings(&self) -> usize {
        self.events.iter().filter(|event| event.kind == Kind::Warning && event.code.0 / 1000 == 2).count()
    }
}

pub(super) fn flag(name: &str) -> Flag {
    Flag::find(name).unwrap()
}

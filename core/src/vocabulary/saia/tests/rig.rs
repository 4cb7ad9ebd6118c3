//! Test machine with one axis on a simulated drive and a virtual one, and helpers for the tests of the module.

use crate::command::{Action, Commands};
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::{Capabilities, Edge, Latch};
use crate::event::Kind;
pub(super) use crate::machine::rig::Rig;
use crate::machine::rig::scale;
use crate::object::{AxisSet, Object};
use crate::parameter::{AxisParameters, Change, ParameterInput, Row, Value};
use crate::vocabulary::saia::{Command as Flag, Register, Request};

/// The axis with a drive.
pub(super) const X: u16 = 0;
/// The virtual axis.
pub(super) const V: u16 = 1;

/// An acceptable set of registers: 50 000 counts/s, 1 000 000 counts/s^2, ramp stop, flag only.
pub(super) const FAST: &[(&str, f64)] = &[("veloc", 50_000.0), ("accel", 1_000_000.0), ("poser", 30_000.0)];

pub(super) fn config() -> MachineConfig {
    let parameters =
        AxisParameters { error_reaction: 2, max_following_error: 1_000_000_000, ..AxisParameters::new(1e9, 1e10) };
    let axis = |name: &str, drive| AxisConfig::new(name.into(), scale(), drive, parameters);
    MachineConfig {
        cycle_ns: 1_000_000,
        axes: vec![axis("x", Some(Capabilities::all(0))), axis("v", None)],
        ..MachineConfig::default()
    }
}

impl Rig {
    pub(super) fn saia() -> Self {
        Self::of(config())
    }

    /// Returns a machine with `axinit` executed on x with these registers.
    pub(super) fn ready(set: &[(&str, f64)]) -> Self {
        let mut rig = Self::saia();
        rig.run(5);
        rig.does(set, "axinit");
        rig
    }

    /// Like [`Self::ready`], but command errors are only reported.
    pub(super) fn logging(set: &[(&str, f64)]) -> Self {
        let mut rig = Self::saia();
        rig.run(5);
        rig.parameter("saia.command_error", Value::Int(1));
        rig.does(set, "axinit");
        rig
    }

    /// Moving in state POS to 100 000, at 50 000 counts/s.
    pub(super) fn moving() -> Self {
        let mut rig = Self::ready(FAST);
        rig.does(&[("destp", 100_000.0)], "fldda fstart");
        rig.run_to("x.command.velocity", 49_999.99);
        rig
    }

    /// At rest in state HOLD on its destination 1000.
    pub(super) fn holding() -> Self {
        let mut rig = Self::ready(FAST);
        rig.does(&[("destp", 1000.0)], "fldda fstart");
        rig.run_until("x.saia.ondest", 1);
        rig
    }

    /// Enables x.
    pub(super) fn on(&mut self) {
        self.ask([Action::Enable(AxisSet::one(X))]).expect("nothing bars it");
        self.run(20);
    }

    /// Sends all actions in one cycle. Returns the error message of the last one.
    pub(super) fn ask(&mut self, actions: impl Into<Vec<Action>>) -> Result<(), String> {
        let sequence = self.give_all(actions.into());
        self.answer(sequence).map_err(|refused| crate::text::message(&refused, self.machine.config()))
    }

    /// Sends a request. If it is refused, the machine must be the same as without it.
    pub(super) fn give_or_nothing(&mut self, request: Request) {
        let mut twin = self.restored_machine();
        if self.ask([Action::vocabulary(request)]).is_err() {
            let mut outputs = twin.outputs();
            twin.cycle(self.inputs(), Commands::default(), &mut outputs);
            assert_eq!(&outputs, self.outputs());
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
        self.ask([Action::vocabulary(request)])
    }

    /// Sends a request for x that is accepted and has no command error.
    #[track_caller]
    pub(super) fn does(&mut self, set: &[(&str, f64)], commands: &str) {
        let before = self.int("x.saia.command_errors");
        self.verb(X, set, commands).unwrap_or_else(|sentence| panic!("{commands}: {sentence}"));
        assert_eq!(self.int("x.saia.command_errors"), before, "{commands}");
    }

    /// Sends a request for x that is refused, with a part of the message.
    #[track_caller]
    pub(super) fn refuses(&mut self, set: &[(&str, f64)], commands: &str, part: &str) {
        let sentence = self.verb(X, set, commands).expect_err(commands);
        assert!(sentence.contains(part), "{commands}: {sentence}");
    }

    pub(super) fn try_parameter(&mut self, key: &str, value: Value) -> Result<(), String> {
        let (row, _) = Row::find(key).unwrap();
        self.ask([Action::SetParameters([Change { axis: X, row, value }].into())])
    }

    #[track_caller]
    pub(super) fn parameter(&mut self, key: &str, value: Value) {
        self.try_parameter(key, value).unwrap();
    }

    pub(super) fn register(&self, register: Register) -> Value {
        let (_, row) = register.row().unwrap();
        row.value(self.machine.parameters(X).unwrap())
    }

    pub(super) fn latch(&mut self, age_ns: u32) {
        let latch = Latch { object: Object::Axis(X), edge: Edge::Rising, age_ns: Some(age_ns), position: None };
        assert!(self.plant.add_latch(latch));
    }

    /// Returns the state by its name in section 12.
    pub(super) fn saia_state(&self) -> &'static str {
        super::super::STATES[self.int("x.saia.state") as usize]
    }

    /// Returns OnDest, IPuls, WrapOc, ExcPEr, BrkPos of x.
    pub(super) fn flags(&self) -> [i64; 5] {
        ["ondest", "ipuls", "wrapoc", "excper", "brkpos"].map(|flag| self.int(&format!("x.saia.{flag}")))
    }

    /// Returns the value of `frdsr`.
    pub(super) fn signals(&mut self) -> i64 {
        self.does(&[], "frdsr");
        self.int("x.saia.rsigb")
    }

    /// Returns every signal of x under `saia.` that the cycle itself does not change, and the registers.
    pub(super) fn picture(&self) -> (Vec<i64>, AxisParameters) {
        let directory = self.machine.directory();
        let entries = directory.iter().map(|(_, entry)| entry);
        let names = entries.filter(|entry| entry.name.starts_with("x.saia."));
        let names = names.filter(|entry| !entry.name.ends_with(".position"));
        let words = names.map(|entry| self.int(&entry.name)).collect();
        (words, *self.machine.parameters(X).unwrap())
    }

    /// Returns the number of warnings with a code.
    pub(super) fn warnings(&self) -> usize {
        self.events.iter().filter(|event| event.kind == Kind::Warning && event.code.0 / 1000 == 2).count()
    }
}

pub(super) fn flag(name: &str) -> Flag {
    Flag::find(name).unwrap()
}

//! The machine of the benches, with a minimal replacement for its drives.

pub(crate) mod slots;

use lineshaft_core::command::{
    Action, BufferMode, CamIn, Command, Commands, Engage, Move, MoveMode, Source, Synchronize,
};
use lineshaft_core::config::{AxisConfig, MachineConfig, TableConfig};
use lineshaft_core::drive::{Capabilities, DriveInput, DriveState, Inputs, Interface, Outputs};
use lineshaft_core::machine::{MAX_COMMANDS, Machine};
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader};
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::position::Length;
use lineshaft_core::regulator::Law;
use lineshaft_core::sync::gear::Ratio;
use lineshaft_core::sync::{CamStart, Disengage, SyncMode};
use lineshaft_core::table::{CamSetting, Form, Interpolation, Table};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
use std::sync::Arc;

/// Loops that are closed here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Loops {
    interface: Interface,
    law: Law,
    estimator: i64,
}

impl Loops {
    /// The proportional position loop.
    const KV: Self = Self { interface: Interface::Velocity, law: Law::Proportional, estimator: 0 };
    /// The PID controller.
    const PID: Self = Self { law: Law::Pid, ..Self::KV };
    /// The PID controller and the velocity loop, with the change of each cycle as velocity.
    const CASCADE: Self = Self { interface: Interface::Torque, ..Self::PID };
    /// The same with a Kalman filter.
    const OBSERVER: Self = Self { estimator: 3, ..Self::CASCADE };
    /// All loops with their names.
    pub(crate) const ALL: [(&'static str, Self); 4] =
        [("kv", Self::KV), ("pid", Self::PID), ("cascade", Self::CASCADE), ("observer", Self::OBSERVER)];
}

/// A machine whose drives follow at once.
pub(crate) struct Shop {
    pub(crate) machine: Machine,
    inputs: Inputs,
    outputs: Outputs,
}

/// Returns an axis of 1 m/s with 1 um per increment.
fn axis(index: u16, drive: Option<Capabilities>) -> AxisConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::METRE);
    let scale = Scale::new(Fraction::from_integer(1_000_000), per).expect("a legal scale");
    AxisConfig::new(format!("a{index}"), scale, drive, AxisParameters::new(1e6, 1e7))
}

impl Shop {
    /// Returns a machine with `axes` axes, of which the first `leaders` have no drive; the drives are offline.
    pub(crate) fn new(leaders: u16, axes: u16) -> Self {
        let drive = |index| (index >= leaders).then(|| Capabilities::all(0));
        let axes = (0..axes).map(|index| axis(index, drive(index))).collect();
        Self::of(MachineConfig { cycle_ns: 1_000_000, axes, ..MachineConfig::default() })
    }

    pub(crate) fn of(config: MachineConfig) -> Self {
        let machine = Machine::new(config).expect("a legal machine");
        let (inputs, outputs) = (machine.inputs(), machine.outputs());
        Self { machine, inputs, outputs }
    }

    /// Adds a table: 1,001 points of a parabola there and back over 200,000 increments, for a cam of the first axis at
    /// 1 m/s.
    pub(crate) fn with_cam(self, interpolation: Interpolation) -> Self {
        let y: Vec<i64> = (0..=1000).map(|point: i64| point * (1000 - point) / 20).collect();
        let setting = CamSetting { length: Some(200_000), interpolation, ..CamSetting::default() };
        let table = Table::new(Form::Y, &[], &y).expect("points").with_cam(setting);
        let config = self.machine.config().clone();
        let tables = vec![TableConfig { name: "cam".into(), table: Arc::new(table) }];
        Self::of(MachineConfig { tables, ..config })
    }

    /// Adds loops that are closed here.
    pub(crate) fn with_loops(self, Loops { interface, law, estimator }: Loops) -> Self {
        let mut config = self.machine.config().clone();
        for axis in &mut config.axes {
            (axis.interface, axis.law) = (interface, law);
            let p = &mut axis.parameters;
            p.max_following_error = 1_000_000;
            (p.amplifier.max_effort, p.amplifier.estimator) = (Some(1000.0), estimator);
        }
        Self::of(config)
    }

    /// Sets the state of all drives.
    pub(crate) fn switch(&mut self, state: DriveState) {
        let drive = DriveInput { status: state.status(), online: true, fresh: true, ..DriveInput::default() };
        self.inputs.drive.fill(drive);
    }

    /// Sets the first digital input to 1 from the next cycle on.
    pub(crate) fn set_input(&mut self) {
        if let Some(word) = self.inputs.digital.first_mut() {
            *word |= 1;
        }
    }

    /// Switches all axes on.
    pub(crate) fn enable(&mut self) {
        self.switch(DriveState::Enabled);
        let axes = self.machine.config().axes.len();
        self.give(&[Action::Enable(AxisSet::first(axes))]);
        self.cycle(Commands::default());
    }

    /// Executes all commands in as few cycles as possible.
    pub(crate) fn give(&mut self, actions: &[Action]) {
        for some in actions.chunks(MAX_COMMANDS) {
            let command = |action: &Action| Command { sequence: 1, source: Source::Cli, action: action.clone() };
            let commands: Vec<_> = some.iter().map(command).collect();
            self.cycle(Commands::queue(&commands));
        }
    }

    pub(crate) fn cycle(&mut self, commands: Commands<'_>) {
        // The belt moves.
        for encoder in &mut self.inputs.encoder {
            (encoder.count, encoder.valid) = (encoder.count.wrapping_add(7) & 0xFFFF, true);
        }
        self.machine.cycle(&self.inputs, commands, &mut self.outputs);
        for (input, output) in self.inputs.drive.iter_mut().zip(&self.outputs.drive) {
            (input.count, input.mode) = (output.position, output.mode.number());
        }
    }
}

/// Returns a goal (inc, inc/s), with the rates of the axis.
pub(crate) fn goal(axis: u16, mode: MoveMode, target: i64, velocity: f64) -> Move {
    Move {
        axis,
        mode,
        target: Length::whole(target),
        velocity,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        direction: Direction::Shortest,
        buffer_mode: BufferMode::Aborting,
    }
}

/// Returns a coupling to the first axis, 355 : 113.
pub(crate) fn couple(axis: u16) -> Action {
    Action::Synchronize(Synchronize {
        axis,
        leader: Some(Leader::AxisCommand(0)),
        mode: SyncMode::Position,
        engage: Engage::Immediately,
        disengage: Disengage::Stop,
        numerator: 355,
        denominator: 113,
        offset: Length::default(),
        velocity: 0.0,
        acceleration: 0.0,
        cam: None,
    })
}

/// Returns a cam of the only table, from the present positions.
pub(crate) fn on_cam(axis: u16) -> Action {
    let Action::Synchronize(gear) = couple(axis) else { unreachable!("a coupling") };
    let scales = (Ratio::ONE, Ratio::new(7, 3).expect("legal"));
    let cam = CamIn {
        table: 0,
        start: CamStart::Relative,
        master_scale: scales.0,
        slave_scale: scales.1,
        master_offset: Length::default(),
        slave_offset: Length::default(),
    };
    Action::Synchronize(Synchronize { numerator: 0, denominator: 0, cam: Some(cam), ..gear })
}

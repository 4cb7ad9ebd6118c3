//! Time of a cycle by the number of moving axes, each with a drive that obeys at once.
//!
//! `cargo bench -p lineshaft-core`: the figure per element is the time per axis and cycle; group `step` of the bench `profile`, in the same
//! run, is Ruckig's step beside it.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lineshaft_core::command::{Action, BufferMode, Command, Commands, Move, MoveMode, Source, Synchronize};
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::drive::{Capabilities, DriveInput, DriveState, Inputs, Outputs};
use lineshaft_core::machine::Machine;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader};
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::position::Length;
use lineshaft_core::sync::{Disengage, SyncMode};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};

/// The machine and the least that stands for its drives.
struct Rig {
    machine: Machine,
    inputs: Inputs,
    outputs: Outputs,
}

impl Rig {
    fn new(axes: u16) -> Self {
        let per = Quantity::new(Fraction::from_integer(1), Unit::METRE);
        let scale = Scale::new(Fraction::from_integer(1_000_000), per).expect("a legal scale");
        let axis = |index: u16| {
            AxisConfig::new(format!("a{index}"), scale, Some(Capabilities::all(0)), AxisParameters::new(1e6, 1e7))
        };
        let config =
            MachineConfig { cycle_ns: 1_000_000, axes: (0..axes).map(axis).collect(), ..MachineConfig::default() };
        let machine = Machine::new(config).expect("a legal machine");
        let (mut inputs, outputs) = (machine.inputs(), machine.outputs());
        let drive =
            DriveInput { status: DriveState::Enabled.status(), online: true, fresh: true, ..Default::default() };
        inputs.drive.fill(drive);
        let mut rig = Self { machine, inputs, outputs };
        rig.give(Action::Enable(AxisSet::first(usize::from(axes))));
        rig.cycle(Commands::default());
        rig
    }

    fn give(&mut self, action: Action) {
        self.cycle(Commands::queue(&[Command { sequence: 1, source: Source::Cli, action }]));
    }

    fn cycle(&mut self, commands: Commands<'_>) {
        self.machine.cycle(&self.inputs, commands, &mut self.outputs);
        for (input, output) in self.inputs.drive.iter_mut().zip(&self.outputs.drive) {
            (input.count, input.mode) = (output.position, output.mode.number());
        }
    }
}

fn velocity(axis: u16, velocity: f64) -> Action {
    Action::Move(Move {
        axis,
        mode: MoveMode::Velocity,
        target: Length::default(),
        velocity,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        direction: Direction::Shortest,
        buffer_mode: BufferMode::Aborting,
    })
}

fn couple(axis: u16) -> Action {
    Action::Synchronize(Synchronize {
        axis,
        leader: Some(Leader::AxisCommand(0)),
        mode: SyncMode::Position,
        disengage: Disengage::Stop,
        numerator: 355,
        denominator: 113,
        offset: Length::default(),
        velocity: 0.0,
        acceleration: 0.0,
    })
}

fn cycles(c: &mut Criterion) {
    let mut group = c.benchmark_group("cycle");
    for axes in [1_u16, 8, 64, 512] {
        group.throughput(Throughput::Elements(axes.into()));
        for (name, geared) in [("profiles", false), ("gears", true)] {
            let mut rig = Rig::new(axes);
            rig.give(velocity(0, 1e5));
            for axis in 1..axes {
                rig.give(if geared { couple(axis) } else { velocity(axis, 1e5) });
            }
            group.bench_function(BenchmarkId::new(name, axes), |b| b.iter(|| rig.cycle(Commands::default())));
        }
    }
    group.finish();
}

/// What a key cycle of a recording takes on top: the state of the machine is copied whole.
fn key_cycles(c: &mut Criterion) {
    let mut group = c.benchmark_group("key_cycle");
    for axes in [64_u16, 512] {
        group.throughput(Throughput::Elements(axes.into()));
        let rig = Rig::new(axes);
        let mut copy = rig.machine.state().clone();
        group.bench_function(BenchmarkId::new("copy", axes), |b| {
            b.iter(|| copy.clone_from(std::hint::black_box(rig.machine.state())))
        });
    }
    group.finish();
}

criterion_group!(benches, cycles, key_cycles);
criterion_main!(benches);

//! The cycle takes no memory and gives none back, whatever happens in it: an armed allocator watches.

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use lineshaft_core::command::{
    Action, Command, Commands, Direction, Disengage, Length, Move, MoveMode, Setpoints, Source, SyncMode, Synchronize,
};
use lineshaft_core::config::{AxisConfig, EncoderConfig, IoConfig, IoKind, MachineConfig, MemoryConfig, MemoryKind};
use lineshaft_core::drive::{Backend, Edge, EncoderInput, Latch};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::{AxisSet, Leader, Object};
use lineshaft_core::parameter::{AxisParameters, Change, Value};
use lineshaft_core::sim::{Model, Plant};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const AXES: u16 = 8;

fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).expect("a legal scale");
    let axis = |index: u16| AxisConfig {
        name: format!("a{index}"),
        scale,
        modulo: lineshaft_core::axis::Modulo::new(36_001, 7).filter(|_| index % 3 == 1),
        drive: (index > 0).then_some(u32::from(index % 3)),
        parameters: AxisParameters {
            max_position: index.is_multiple_of(2).then_some(40_000),
            error_reaction: i64::from(index % 6),
            ..AxisParameters::new(1e5, 1e6)
        },
    };
    let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    MachineConfig {
        cycle_ns: 1_000_000,
        io: vec![io("in", IoKind::DigitalInput), io("u", IoKind::AnalogInput)],
        memory: vec![MemoryConfig { name: "m".into(), kind: MemoryKind::I16, initial: 0.0 }],
        encoders: vec![EncoderConfig { name: "belt".into(), bits: 16, scale }],
        axes: (0..AXES).map(axis).collect(),
    }
}

/// A small generator of numbers that are the same in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

fn action(numbers: &mut Numbers) -> Action {
    let axis = numbers.below(u64::from(AXES) + 1) as u16;
    let set = AxisSet::one(axis % AXES);
    let number = numbers.below(200_000) as i64 - 100_000;
    let request = |mode| Move {
        axis,
        mode,
        target: Length::whole(number),
        velocity: number.unsigned_abs() as f64,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        direction: Direction::Shortest,
    };
    let leader = match numbers.below(3) {
        0 => Leader::AxisCommand(numbers.below(8) as u16),
        1 => Leader::AxisActual(numbers.below(8) as u16),
        _ => Leader::Encoder(0),
    };
    match numbers.below(14) {
        0..=3 => Action::Enable(AxisSet::first(usize::from(AXES))),
        4 => Action::Disable(set),
        5 => Action::Halt(set),
        6 => Action::QuickStop(set),
        7 => Action::ResetErrors(AxisSet::first(usize::from(AXES))),
        8 => Action::Move(request(MoveMode::Absolute)),
        9 => Action::Move(request(MoveMode::Relative)),
        10 => Action::Move(request(MoveMode::Velocity)),
        11 => Action::Synchronize(Synchronize {
            axis,
            leader,
            mode: SyncMode::Position,
            disengage: Disengage::KeepVelocity,
            numerator: number,
            denominator: 7919,
            offset: Length::whole(number % 100),
            velocity: 0.0,
            acceleration: 0.0,
        }),
        12 => Action::SetMemory { index: 0, value: number as f64 },
        _ => Action::SetParameters(Box::new([Change { axis, row: 2, value: Value::Real(5e4 + number as f64 / 4.0) }])),
    }
}

#[test]
fn no_cycle_takes_or_gives_back_memory() {
    let config = config();
    let mut plant = Plant::new(&config, &[Some(Model::Ideal); AXES as usize - 1]);
    let mut machine = Machine::new(config).unwrap();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut kept = machine.state().clone();
    let mut numbers = Numbers(7);
    let mut stream = Setpoints { generation: 0, velocity: vec![None; usize::from(AXES)] };
    let (mut sequence, mut count, mut events) = (0, 0_i64, 0);
    for cycle in 0..20_000_u64 {
        let commands: Vec<Command> = (0..numbers.below(40).saturating_sub(37))
            .map(|_| {
                sequence += 1;
                Command { sequence, source: Source::Scenario, action: action(&mut numbers) }
            })
            .collect();
        if numbers.below(500) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            drive.inject_fault(0x1234);
        }
        stream.generation += 1;
        stream.velocity[3] = (cycle % 4_000 < 1_000).then_some(1_000.0);
        inputs.cycle = cycle;
        plant.read(&mut inputs);
        count += 20;
        inputs.encoder[0] = EncoderInput { count: count & 0xFFFF, epoch: 0, valid: numbers.below(900) != 0 };
        inputs.missed = u32::from(cycle.is_multiple_of(777));
        inputs.add_latch(Latch {
            object: Object::Axis(numbers.below(8) as u16),
            edge: Edge::Rising,
            age_ns: Some(1),
            position: None,
        });
        assert_no_alloc(|| {
            let commands = Commands { stop: &[], queue: &commands, stream: Some(&stream) };
            machine.cycle(&inputs, commands, &mut outputs);
            plant.write(&outputs);
            kept.clone_from(machine.state());
        });
        assert_eq!(violation_count(), 0, "in cycle {cycle}");
        events += machine.events().len();
    }
    assert!(events > 20_000, "a run in which little happens proves little: {events} events");
}

/// The watch is armed: a cycle that did take memory would be seen.
#[test]
fn the_watch_sees_an_allocation() {
    let before = violation_count();
    let bytes = assert_no_alloc(|| std::hint::black_box(vec![1_u8; 16]));
    assert!(violation_count() > before, "{} bytes were taken unseen", bytes.len());
}

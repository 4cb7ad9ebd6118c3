//! The cycle takes no memory and gives none back, whatever happens in it: an armed allocator watches.

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use lineshaft_core::axis::{BrakeConfig, Safety, Wired};
use lineshaft_core::code::Code;
use lineshaft_core::command::{
    Action, BufferMode, CamIn, Command, CommandFunction, Commands, Engage, HomeAxis, HomingMethod, MasterPosition,
    Move, MoveMode, Phase, PhaseShift, PhaseSide, Probe, ProbeEdge, SetEncoderPosition, SetMasterPosition, SetPosition,
    Setpoint, Setpoints, Source, Synchronize,
};
use lineshaft_core::config::{
    AxisConfig, EncoderConfig, FilterConfig, GlobalConfig, IoConfig, IoKind, Line, MachineConfig, MemoryConfig,
    MemoryKind, SinkConfig, SlotConfig, SourceConfig, SumConfig, TableConfig,
};
use lineshaft_core::drive::{Backend, Capabilities, Edge, EncoderInput, Interface, Latch, SpeedOutputs};
use lineshaft_core::encoder::{Absolute, Form, Parity, WordCode};
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::function::{self, Order, Room, TYPES};
use lineshaft_core::machine::Machine;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader, Object};
use lineshaft_core::parameter::{
    AssignedOutputs, AxisParameters, Change, Encoders, Layer, MachineParameters, Row, Supervision, Value,
};
use lineshaft_core::position::{Length, Position};
use lineshaft_core::sim::{Fixtures, Index, Model, Plant, SecondOrder, TwoSpeed, Valve, VelocityLag};
use lineshaft_core::sync::gear::Ratio;
use lineshaft_core::sync::{CamStart, Disengage, SyncMode};
use lineshaft_core::table::{CamSetting, Form as Numbering, Interpolation, MOST, Table};
use lineshaft_core::trajectory::{Knot, Tolerance, Track, Trajectory};
use lineshaft_core::unit::{Amount, Fraction, Quantity, Scale, Unit};
use lineshaft_core::vocabulary::saia::{Command as SaiaCommand, Register, Request};
use lineshaft_core::vocabulary::{self, Wiring, amc, wf};
use std::collections::BTreeMap;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const AXES: u16 = 8;

/// The first axis has no drive.
fn interface(index: u16) -> Interface {
    match index % 4 {
        1 => Interface::Velocity,
        2 if index > 4 => Interface::OpenLoop,
        3 if index > 4 => Interface::OpenLoop,
        _ => Interface::Position,
    }
}

/// Drives that take no memory either.
fn model(index: u16) -> Model {
    let ms = 1_000_000;
    match index {
        1 => Model::Velocity(VelocityLag::new(5 * ms, 1_000_000).expect("a legal lag")),
        4 => Model::SecondOrder(SecondOrder::new(60.0, 0.8, 1_000_000).expect("a legal model")),
        5 => Model::SecondOrder(SecondOrder::new(60.0, 0.8, 1_000_000).expect("a legal model")),
        6 => Model::TwoSpeed(TwoSpeed::new(50 * ms, 100 * ms, 1_000_000).expect("a legal motor")),
        7 => Model::Valve(Valve::new(50 * ms, 20 * ms + 1, 1_000_000).expect("a legal valve")),
        _ => Model::Ideal,
    }
}

macro_rules! kinds {
    ($($name:ident),* $(,)?) => {
        /// Names of all actions.
        const KINDS: &[&str] = &["Saia", "Wf", $(stringify!($name)),*];

        /// The name of an action. An action that the list lacks does not compile, and an action that it has must be given.
        fn kind(action: &Action) -> &'static str {
            match action {
                Action::Vocabulary(vocabulary::Request::Saia(_)) => "Saia",
                Action::Vocabulary(vocabulary::Request::Wf(_)) => "Wf",
                $(Action::$name { .. } => stringify!($name),)*
            }
        }
    };
}

kinds! {
    Enable, Disable, Halt, QuickStop, Abort, ResetErrors, Activate, Deactivate, Move, Probe, Trajectory, HomeAxis,
    SetPosition, SetEncoderPosition, SetMasterPosition, Synchronize, Phase, Cancel, SetParameters, SaveParameters,
    ResetParameters, DeleteParameters, PowerCycle, SetMemory, CommandFunction, LoadTable, SetOutputs, Refuse, Note,
}

/// How often each kind of action was given, and accepted.
#[derive(Default)]
struct Tally(BTreeMap<&'static str, [usize; 2]>);

impl Tally {
    fn count(&mut self, commands: &[Command], events: &[Event]) {
        for Command { sequence, action, .. } in commands {
            let [given, accepted] = self.0.entry(kind(action)).or_default();
            *given += 1;
            *accepted +=
                events.iter().filter(|event| event.kind == Kind::Accepted && event.command == *sequence).count();
        }
    }

    /// Each kind was given and accepted; a request that is none is refused, and a note is answered by its warning.
    fn is_whole(&self) {
        for kind in KINDS {
            let [given, accepted] = self.0.get(kind).copied().unwrap_or_default();
            let is_answered = accepted > 0 || ["Refuse", "Note"].contains(kind);
            assert!(given > 0 && is_answered, "{kind} was given {given} times and accepted {accepted} times");
        }
    }
}

/// The same machine where every kind of absolute encoder is read: words in Gray code with turns that are corrected, binary ones of a
/// drive that closes its own loop, an entry of `encoders`, and the words of a positioning module with parity.
fn absolute() -> MachineConfig {
    let mut config = config();
    let gray = |steps, turns| Absolute { turns, code: WordCode::Gray, ..Absolute::single_turn(steps) };
    let scale = config.encoders[0].scale;
    let disc = Form::Absolute(Absolute { parity: Some(Parity::Odd), ..gray(4_096, 16) });
    config.encoders.push(EncoderConfig { name: "disc".into(), form: disc, check: None, scale });
    config.axes[1].wired = Wired::Drive(Form::Absolute(gray(8_192, 4_096)));
    config.axes[1].parameters.encoder.encodertype = 3;
    config.axes[3].wired = Wired::Drive(Form::Absolute(Absolute::single_turn(40_000)));
    config.axes[5].wired = Wired::Encoder(1);
    let module = &mut config.axes[7].parameters;
    (module.encoder.kind, module.encoder.steps, module.encoder.reference_or_parity) = (1, 16_384, 1);
    config
}

fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).expect("a legal scale");
    let axis = |index: u16| {
        let drive = (index > 0).then_some(u32::from(index % 3));
        // Most keep their following errors to themselves, so that something goes on.
        let supervision = Supervision { following_error_stops_all: i64::from(index == 3), ..Supervision::default() };
        let parameters = AxisParameters {
            supervision,
            max_position: index.is_multiple_of(2).then_some(40_000),
            error_reaction: i64::from(index % 6),
            encoder: Encoders { mencodertype: if index == 2 { 10 } else { 0 }, ..Encoders::default() },
            outputs: AssignedOutputs { brake: if index == 3 { -2 } else { 0 }, axmove: if index == 3 { 5 } else { 0 } },
            ..AxisParameters::new(1e5, 1e6)
        };
        let interface = interface(index);
        // Each output of one axis.
        let place = |first: u16| (interface == Interface::OpenLoop).then_some(first + index);
        let open_loop = SpeedOutputs { forward: place(2), backward: place(10), output: place(18), dac: place(26) };
        let brake =
            BrakeConfig { output: 1 + index, closes_with_one: true, release_ns: 9_000_000, engage_ns: 7_000_000 };
        AxisConfig {
            interface,
            brake: Some(brake).filter(|_| index == 4),
            open_loop,
            modulo: lineshaft_core::modulo::Modulo::new(36_001, 7).filter(|_| index % 3 == 1),
            vocabularies: Wiring {
                amc: amc::Wiring {
                    master: (index > 0).then_some(Leader::AxisCommand(index / 2)),
                    freeze: Some(Object::Axis(index)),
                    cam: Some(2),
                },
            },
            ..AxisConfig::new(format!("a{index}"), scale, drive.map(Capabilities::all), parameters)
        }
    };
    let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    MachineConfig {
        cycle_ns: 1_000_000,
        io: [io("in", IoKind::DigitalInput), io("u", IoKind::AnalogInput)]
            .into_iter()
            .chain((0..24).map(|n| io(&format!("q{n}"), IoKind::DigitalOutput)))
            .chain((0..8).map(|n| io(&format!("v{n}"), IoKind::AnalogOutput)))
            .collect(),
        memory: [("m", MemoryKind::I16), ("bit", MemoryKind::Bit), ("d", MemoryKind::I32)]
            .map(|(name, kind)| MemoryConfig { name: name.into(), kind, initial: 0.0 })
            .into(),
        tables: [("t", table(3)), ("c", cam_table(Interpolation::Linear)), ("s", cam_table(Interpolation::Quintic))]
            .map(|(name, table)| TableConfig { name: name.into(), table })
            .into(),
        slots: slots(),
        encoders: vec![EncoderConfig {
            name: "belt".into(),
            form: lineshaft_core::encoder::Form::Incremental(16),
            check: None,
            scale,
        }],
        masters: vec![
            master("pair", &[Leader::Encoder(0), Leader::AxisCommand(1)], &[Leader::AxisActual(2)]),
            master("all", &[Leader::Sum(0), Leader::Sink(5)], &[Leader::AxisCommand(0)]),
        ],
        axes: (0..AXES).map(axis).collect(),
        safety: Safety { estop: Some(0), interlock: None },
        global: GlobalConfig {
            parameters: MachineParameters { i_errclr: 1, i_break: -1, i_continue: 1, o_error: 3, ainftime: 5 },
            filters: vec![FilterConfig { input: 0, time_ns: 3_000_000 }],
            ..GlobalConfig::default()
        },
    }
}

fn master(name: &str, add: &[Leader], subtract: &[Leader]) -> SumConfig {
    SumConfig { name: name.into(), add: add.into(), subtract: subtract.into() }
}

/// Two points or cams, the second one from `turn` * 100 on.
fn table(turn: i64) -> Arc<Table> {
    long_table(turn, 40)
}

/// The same with so many words.
fn long_table(turn: i64, count: usize) -> Arc<Table> {
    let words: Vec<i64> =
        (0..count).map(|word| [3, 0, 0, 0, 100, 0, 1, 0, turn * 100].get(word).copied().unwrap_or(0)).collect();
    Arc::new(Table::new(Numbering::Words, &[], &words).expect("words"))
}

/// One slot of each type, two of them with an axis, linked with each other.
fn slots() -> Vec<SlotConfig> {
    let slots = TYPES.iter().enumerate().map(|(place, row)| {
        let mut slot = SlotConfig::new(format!("f{place}"), place as u16, row.kind);
        slot.source = match row.kind {
            function::Kind::Imes | function::Kind::Dcopy | function::Kind::Cam | function::Kind::Dfkt => {
                SourceConfig::Lead(Leader::Encoder(0))
            }
            function::Kind::Varsync => SourceConfig::Lead(Leader::AxisCommand(0)),
            function::Kind::Ecopy => SourceConfig::Lead(Leader::Sink(5)),
            function::Kind::Binea => SourceConfig::Lead(Leader::Sink(0)),
            _ => SourceConfig::None,
        };
        slot.sink = match row.kind {
            function::Kind::Varsync => SinkConfig::Axis(5),
            function::Kind::Ecopy => SinkConfig::Memory(2),
            _ => SinkConfig::None,
        };
        slot.tables[0] = (row.tables > 0).then_some(0);
        let values: &[(&str, i64)] = match row.kind {
            function::Kind::Fipw => &[("mode", 4), ("mult", 1), ("table_count", 1), ("cycle_time", 9)],
            function::Kind::Xfipw => &[("ba", 4), ("mult", 1), ("tables_total", 1), ("cycle_time", 9)],
            function::Kind::Fipz => &[("mode", 16), ("mult", 1), ("table_count", 1), ("cycle_time", 9)],
            _ => &[],
        };
        for (name, value) in values {
            slot.tables[0] = Some(1);
            slot.values[row.find(name).expect("a field").1] = *value;
        }
        slot.room = Room { mean: 32, cams: 0 };
        if row.kind == function::Kind::Dfkt {
            let values =
                ["table_count", "active_table", "div", "mult", "in_resolution", "in_final", "ratio_max", "ratio_div"];
            for (_, place) in values.iter().filter_map(|name| row.find(name)) {
                slot.values[place] = 1;
            }
        }
        for line in slot.inputs.iter_mut().take(row.inputs) {
            *line = Some(Line { object: Object::Memory(1), inverted: false });
        }
        slot
    });
    slots.collect()
}

/// Two slopes over 4000 increments.
fn cam_table(interpolation: Interpolation) -> Arc<Table> {
    let table = Table::new(Numbering::Y, &[], &[0, 90, 20]).expect("points");
    Arc::new(table.with_cam(CamSetting { length: Some(4000), interpolation, ..CamSetting::default() }))
}

/// A cam of either table that is one, linear or a spline.
fn cam(number: i64) -> CamIn {
    let start = CamStart::ALL[number.unsigned_abs() as usize / 3 % 3].0;
    CamIn {
        table: if number % 2 == 0 { 1 } else { 2 },
        start,
        master_scale: Ratio::new(number % 7, 5).unwrap_or(Ratio::ONE),
        slave_scale: Ratio::ONE,
        master_offset: Length::whole(number % 1000),
        slave_offset: Length::whole(number % 50),
    }
}

/// A phase shift of either side, in increments of any leader.
fn phase(axis: u16, number: i64) -> Phase {
    let shift = PhaseShift { shift: Length::whole(number % 5_000), velocity: 1_000.0, acceleration: 10_000.0 };
    let scale = config().axes[0].scale;
    let given = [Amount::default(); 3];
    let master = PhaseSide::Master { given, by_scale: [(scale, shift), (Scale::increments(), shift)].into() };
    Phase { axis, side: if number % 4 == 0 { PhaseSide::Slave(shift) } else { master } }
}

/// An order to a function with a value that is often good.
fn command(numbers: &mut Numbers) -> Action {
    let slot = numbers.below(TYPES.len() as u64) as u16;
    let orders = [Order::Start, Order::Start, Order::Start, Order::Reset, Order::ValueNew, Order::ReadValue];
    let order = orders[numbers.below(6) as usize];
    let (_, field, _) = TYPES[usize::from(slot)].field_of(0).expect("each type has a field");
    let least = field.min.max(0);
    let mut values = vec![(0, least + numbers.below(field.max.abs_diff(least).min(4) + 2) as i64)];
    if let Some((_, tracks)) = TYPES[usize::from(slot)].find("tracks") {
        values.push((tracks as u16, 2));
    }
    if let Some((_, cams)) = TYPES[usize::from(slot)].find("cams") {
        values.push((cams as u16, 2));
    }
    Action::CommandFunction(CommandFunction { slot, order, values: values.into() })
}

/// A small generator of numbers that are the same in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

fn action(numbers: &mut Numbers, sequence: u64) -> Action {
    if numbers.below(6) == 0 {
        let position = Length::whole(numbers.below(20_000) as i64);
        return match numbers.below(8) {
            0 => Action::SetEncoderPosition(SetEncoderPosition { encoder: 0, position }),
            1 => {
                let position = MasterPosition::Increments(position);
                Action::SetMasterPosition(SetMasterPosition { axis: numbers.below(3) as u16, position })
            }
            2 => Action::Refuse("nobody knows what this is".into()),
            3 => Action::Note { code: Code::NOTES[numbers.below(Code::NOTES.len() as u64) as usize], number: 7 },
            4 | 5 => Action::Cancel { goal: sequence.saturating_sub(1 + numbers.below(20)) },
            _ => Action::vocabulary(module(numbers)),
        };
    }
    if numbers.below(30) == 0 {
        let set = AxisSet::one(numbers.below(u64::from(AXES)) as u16);
        return match numbers.below(12) {
            8..=10 => {
                let method = [1, 3, 8, 14, 18, 25, 33, 35][numbers.below(8) as usize];
                Action::HomeAxis(HomeAxis { axis: numbers.below(8) as u16, method: HomingMethod::Cia402(method) })
            }
            11 => {
                let position = Length::whole(numbers.below(20_000) as i64);
                Action::SetPosition(SetPosition { axis: numbers.below(8) as u16, position })
            }
            0 => Action::SaveParameters(set),
            1 => Action::ResetParameters { axes: set, layer: Layer::User },
            2 => Action::ResetParameters { axes: set, layer: Layer::Init },
            3 => Action::DeleteParameters(set),
            4 => Action::PowerCycle,
            5 => Action::Deactivate,
            _ => Action::Activate,
        };
    }
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
        buffer_mode: BufferMode::Aborting,
    };
    let leader = match numbers.below(3) {
        0 => Leader::AxisCommand(numbers.below(8) as u16),
        1 => Leader::AxisActual(numbers.below(8) as u16),
        _ if number % 3 == 0 => Leader::Encoder(0),
        _ => Leader::Sum((number % 3 < 0).into()),
    };
    match numbers.below(21) {
        0..=3 => Action::Enable(AxisSet::first(usize::from(AXES))),
        4 => Action::Disable(set),
        5 => Action::Halt(set),
        6 if number % 4 == 0 => Action::Abort,
        6 => Action::QuickStop(set),
        7 => Action::ResetErrors(AxisSet::first(usize::from(AXES))),
        8 => Action::Move(request(MoveMode::Absolute)),
        9 if number % 2 == 0 => Action::Phase(phase(axis, number)),
        9 => Action::Move(request(MoveMode::Relative)),
        10 => Action::Move(request(MoveMode::Velocity)),
        11 => Action::Synchronize(Synchronize {
            axis,
            leader: Some(leader),
            mode: SyncMode::Position,
            engage: match number % 18 {
                0 => Engage::AtEnd,
                3 => Engage::AtPosition { position: number / 7, turn: None },
                _ => Engage::Immediately,
            },
            disengage: Disengage::KeepVelocity,
            numerator: number,
            denominator: 7919,
            offset: Length::whole(number % 100),
            velocity: 0.0,
            acceleration: 0.0,
            cam: (number % 3 == 0).then(|| cam(number)),
        }),
        12 if number % 2 == 0 => Action::set_memory(number.unsigned_abs() as u16 % 3, number as f64),
        12 => Action::set_output((number.unsigned_abs() % 36) as u16, (number % 3) as f64),
        13..=16 => select(axis, numbers),
        17 | 18 => Action::vocabulary(saia(axis, numbers)),
        19 => Action::Probe(Probe {
            axis,
            relative: true,
            target: Length::whole(number),
            velocity: 0.0,
            acceleration: 0.0,
            deceleration: 0.0,
            jerk: 0.0,
            source: Object::Axis(number.rem_euclid(8) as u16),
            edge: ProbeEdge::Rising,
            distance: Length::whole(number % 1_000),
        }),
        _ => {
            let (row, _) = Row::find("max_velocity").expect("a key of the catalogue");
            Action::SetParameters(Box::new([Change { axis, row, value: Value::Real(5e4 + number as f64 / 4.0) }]))
        }
    }
}

/// What a positioning module is asked for; its modes come by themselves, so that some of it can be done.
fn module(numbers: &mut Numbers) -> wf::Request {
    let mode = [wf::Mode::Mdi, wf::Mode::Automatic, wf::Mode::Continuous, wf::Mode::Jog, wf::Mode::ActualValue];
    let mode = mode[numbers.below(5) as usize];
    let request = wf::Request { axis: numbers.below(8) as u16, mode: Some(mode), ..wf::Request::default() };
    let mut block = || wf::Block {
        position: Position::whole(numbers.below(40_000) as i64),
        speed: wf::Speed::Value(numbers.below(90) as f64),
        absolute: true,
    };
    match mode {
        wf::Mode::Jog => wf::Request { jog: Some(wf::Jog::Plus), fixed_speed: Some(1), ..request },
        wf::Mode::ActualValue => wf::Request { value: Some(Length::whole(100)), ..request },
        wf::Mode::Mdi => wf::Request { blocks: wf::Blocks::new(&[block()]), start: true, ..request },
        _ => wf::Request { blocks: wf::Blocks::new(&[block(), block()]), block: Some(1), start: true, ..request },
    }
}

/// Something for a reference selector.
fn select(axis: u16, numbers: &mut Numbers) -> Action {
    const KEYS: [(&str, u64); 6] = [
        ("amc.reference_select", 8),
        ("amc.reference_select", 8),
        ("amc.position_reference", 5_000),
        ("amc.rotary_mode", 7),
        ("amc.action_on_event", 3),
        ("amc.stop_mode", 4),
    ];
    let (key, bound) = KEYS[numbers.below(6) as usize];
    let (row, _) = Row::find(key).expect("a key of the catalogue");
    let value = Value::Int(numbers.below(bound) as i64);
    Action::SetParameters(Box::new([Change { axis, row, value }]))
}

/// Registers and commands as they come; often enough a start among them.
fn saia(axis: u16, numbers: &mut Numbers) -> Request {
    let set = [
        (Register::Veloc, 50_000),
        (Register::Accel, 200_000),
        (Register::DestP, numbers.below(40_000) as i64),
        (Register::PosEr, 32_000 + numbers.below(1000) as i64),
        (Register::Mcw, 0x1B | 0x100 << numbers.below(5)),
    ];
    let request = set.into_iter().fold(Request { axis, ..Request::default() }, |request, (register, value)| {
        request.with(register, Value::Int(value))
    });
    let all = SaiaCommand::ALL.len() as u64;
    let mut commands: Vec<SaiaCommand> =
        (0..numbers.below(4)).filter_map(|_| SaiaCommand::ALL.get(numbers.below(all) as usize)).map(|c| c.0).collect();
    commands.extend(
        [SaiaCommand::Initialise, SaiaCommand::LoadDestination, SaiaCommand::Start]
            .iter()
            .filter(|_| numbers.below(2) == 0),
    );
    Request { commands: commands.into_iter().collect(), ..request }
}

/// A trajectory of two axes from wherever they are, slow enough for many of them.
fn trajectory(numbers: &mut Numbers) -> Arc<Trajectory> {
    let first = numbers.below(u64::from(AXES)) as u16;
    let step = (200 + numbers.below(800)) * 1_000_000;
    let times: Box<[u64]> = (1..=3).map(|place| place * step).collect();
    let mut track = |axis| {
        let tolerance = Tolerance { position: Some(100.0 + numbers.below(50_000) as f64), ..Tolerance::default() };
        let knots = (0..3).map(|place| Knot {
            position: Position::whole(numbers.below(40_000) as i64),
            velocity: Some(if place == 2 { 0.0 } else { numbers.below(5_000) as f64 }),
            acceleration: Some(0.0),
        });
        Track { axis, knots: knots.collect(), path: tolerance, goal: tolerance }
    };
    let tracks = Box::new([track(first), track((first + 4) % AXES)]);
    let start = numbers.below(400_000_000) as i64 - 200_000_000;
    Arc::new(Trajectory::new(start, times, tracks, Some(100_000_000)).expect("a sound one"))
}

/// Of all axes, in file order.
fn actual_positions(machine: &Machine) -> [f64; AXES as usize] {
    std::array::from_fn(|axis| {
        let directory = machine.directory();
        let signal = directory.find(&format!("a{axis}.actual.position")).expect("a signal of each axis");
        machine.board().value(signal, directory.entry(signal).kind).to_f64()
    })
}

#[test]
fn no_cycle_takes_or_gives_back_memory() {
    assert_eq!(cycles_take_and_give_back_no_memory(config()), 0);
}

#[test]
fn no_cycle_of_absolute_encoders_takes_or_gives_back_memory() {
    assert!(cycles_take_and_give_back_no_memory(absolute()) > 0);
}

/// Everything that there is comes by chance; the number of words of an encoder that were replaced.
fn cycles_take_and_give_back_no_memory(config: MachineConfig) -> usize {
    let models: Vec<_> = (1..AXES).map(|index| Some(model(index))).collect();
    let mut plant = Plant::new(&config, &models);
    let index = Some(Index { every: 2_000, at: 300 });
    let fixtures = Fixtures { index, home: Some((2_000, 4_000)), ..Fixtures::default() };
    (0..7).for_each(|drive| plant.drive(drive).expect("a drive of each axis but the first").fit(fixtures));
    let mut machine = Machine::new(config).expect("a legal machine");
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut kept = machine.state().clone();
    // Those of functions come beside the others, which stay as they were without them.
    let (mut numbers, mut orders) = (Numbers(7), Numbers(11));
    let mut stream = Setpoints::none(usize::from(AXES));
    let (mut sequence, mut count, mut events, mut marks) = (0, 0_i64, 0, 0);
    // As whoever gives them does: kept for as long as the machine may have them.
    let (mut trajectories, mut tables, mut runs) = (Vec::new(), Vec::new(), 0);
    let mut tally = Tally::default();
    let mut started = [0; TYPES.len()];
    let (mut positions, mut moved) = (actual_positions(&machine), [0; AXES as usize]);
    let mut substituted = 0;
    for cycle in 0..40_000_u64 {
        // Now and then all axes are switched off, and so is the power; nothing else is asked for then.
        let pause = (cycle % 4_000).checked_sub(3_000).filter(|pause| *pause < 500);
        let all = AxisSet::first(usize::from(AXES));
        let planned = match pause {
            Some(0 | 300) => Some(Action::ResetErrors(all)),
            Some(50 | 400) => Some(Action::Disable(all)),
            Some(480) => Some(Action::PowerCycle),
            _ => None,
        };
        let by_chance = if pause.is_some() { 0 } else { numbers.below(40).saturating_sub(37) };
        let actions = (0..by_chance).map(|_| action(&mut numbers, sequence)).collect::<Vec<_>>();
        let mut commands: Vec<Command> = (sequence + 1..)
            .zip(planned.into_iter().chain(actions))
            .map(|(sequence, action)| Command { sequence, source: Source::Scenario, action })
            .collect();
        sequence += commands.len() as u64;
        if pause.is_none() && numbers.below(40) == 0 {
            let trajectory = trajectory(&mut numbers);
            trajectories.push(Arc::clone(&trajectory));
            sequence += 1;
            commands.push(Command { sequence, source: Source::Scenario, action: Action::Trajectory(trajectory) });
        }
        if pause.is_none() && orders.below(25) == 0 {
            sequence += 1;
            commands.push(Command { sequence, source: Source::Scenario, action: command(&mut orders) });
        }
        if pause.is_none() && orders.below(60) == 0 {
            let table = table(2 + orders.below(5) as i64);
            tables.push(Arc::clone(&table));
            sequence += 1;
            let action = Action::LoadTable { index: 0, table };
            commands.push(Command { sequence, source: Source::Scenario, action });
        }
        if numbers.below(500) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            drive.inject_fault(0x1234);
        }
        if numbers.below(700) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            // Limit switches come and go.
            drive.stick(3, numbers.below(16).saturating_sub(12) as u32);
        }
        if numbers.below(600) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            // Some words of its encoder are bad.
            drive.disturb(1 << numbers.below(16), numbers.below(5) as u32);
        }
        // The emergency stop is pressed now and then.
        plant.set_digital(0, numbers.below(3_000) != 0);
        stream.axes[3] = (cycle % 4_000 < 1_000).then_some(Setpoint { velocity: 1_000.0, duration: None });
        inputs.begin(cycle, 0);
        if numbers.below(200) == 0 {
            plant.set_digital(0, numbers.below(2) == 0);
        }
        plant.set_analog(0, numbers.below(10) as f64);
        assert_no_alloc(|| plant.read(&mut inputs));
        count += 20;
        inputs.encoder[0] =
            EncoderInput { count: count & 0xFFFF, epoch: 0, valid: numbers.below(900) != 0, index: None };
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
        tally.count(&commands, machine.events());
        for (starts, slot) in started.iter_mut().zip(machine.slots()) {
            *starts += usize::from(slot.is_active());
        }
        let before = std::mem::replace(&mut positions, actual_positions(&machine));
        for (cycles, (was, is)) in moved.iter_mut().zip(before.iter().zip(&positions)) {
            *cycles += u32::from(was != is);
        }
        substituted += machine.events().iter().filter(|event| event.code == Code::ENCODER_SUBSTITUTED).count();
        events += machine.events().len();
        let begins = |event: &Event| {
            event.kind == Kind::Accepted
                && commands
                    .iter()
                    .any(|command| command.sequence == event.command && matches!(command.action, Action::Trajectory(_)))
        };
        runs += machine.events().iter().filter(|event| begins(event)).count();
        marks += machine.events().iter().filter(|event| event.kind == Kind::Mark).count();
    }
    assert!(events > 20_000, "a run in which little happens proves little: {events} events");
    assert!(marks > 10, "{marks} marks were found");
    assert!(runs > 10, "{runs} trajectories ran");
    assert!(moved.iter().all(|cycles| *cycles > 500), "cycles in which each axis moved: {moved:?}");
    tally.is_whole();
    drop(machine);
    drop(kept);
    assert!(trajectories.iter().all(|trajectory| Arc::strong_count(trajectory) == 1));
    assert!(tables.iter().all(|table| Arc::strong_count(table) == 1));
    assert!(started.iter().all(|starts| *starts > 0), "STARTs of each type: {started:?}");
    substituted
}

/// The watch is armed: a cycle that did take memory would be seen.
#[test]
fn the_watch_sees_an_allocation() {
    let before = violation_count();
    let bytes = assert_no_alloc(|| std::hint::black_box(vec![1_u8; 16]));
    assert!(violation_count() > before, "{} bytes were taken unseen", bytes.len());
}

/// Layers and the power change at rest, too.
#[test]
fn no_change_of_a_layer_takes_or_gives_back_memory() {
    let config = config();
    let models: Vec<_> = (1..AXES).map(|index| Some(model(index))).collect();
    let mut plant = Plant::new(&config, &models);
    let mut machine = Machine::new(config).unwrap();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut image = machine.parameter_image();
    let axes = AxisSet::first(usize::from(AXES));
    let loaded = table(5);
    let actions = [
        Action::SetParameters(Box::new([Change {
            axis: 3,
            row: Row::find("default_velocity").expect("a key of the catalogue").0,
            value: Value::Real(5e4),
        }])),
        Action::SaveParameters(axes),
        Action::CommandFunction(CommandFunction { slot: 0, order: Order::Stage, values: Box::new([(0, 1)]) }),
        Action::LoadTable { index: 0, table: Arc::clone(&loaded) },
        Action::ResetParameters { axes, layer: Layer::Init },
        Action::ResetParameters { axes, layer: Layer::User },
        Action::PowerCycle,
        Action::DeleteParameters(axes),
    ];
    for (sequence, action) in (1..).zip(actions) {
        let commands = [Command { sequence, source: Source::Scenario, action }];
        assert_no_alloc(|| {
            inputs.begin(0, 0);
            plant.read(&mut inputs);
            machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
            machine.copy_parameters(&mut image);
            plant.write(&outputs);
        });
        assert_eq!(violation_count(), 0, "{:?}", commands[0].action);
        assert!(machine.events().iter().any(|event| event.kind == Kind::Accepted), "{:?}", commands[0].action);
    }
}

#[test]
fn homing_takes_no_memory() {
    let config = config();
    let models: Vec<_> = (1..AXES).map(|index| Some(model(index))).collect();
    let mut plant = Plant::new(&config, &models);
    let index = Some(Index { every: 2_000, at: 300 });
    let fixtures = Fixtures { index, home: Some((2_000, 4_000)), positive: Some(30_000), ..Fixtures::default() };
    plant.drive(1).unwrap().fit(fixtures);
    // The emergency stop is closed.
    plant.set_digital(0, true);
    let mut machine = Machine::new(config).unwrap();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut homed = Vec::new();
    let home = |method| Action::HomeAxis(HomeAxis { axis: 2, method: HomingMethod::Cia402(method) });
    let row = |key| Row::find(key).expect("a key of the catalogue").0;
    let set = |key, value| Action::SetParameters(Box::new([Change { axis: 2, row: row(key), value }]));
    let position = Length::whole(10_000);
    let actions = [
        Action::Enable(AxisSet::one(2)),
        home(8),
        home(2),
        home(30),
        home(35),
        Action::SetPosition(SetPosition { axis: 2, position }),
        set("homing.in_drive", Value::Int(1)),
        home(10),
        set("homing.in_drive", Value::Int(0)),
        set("homing.index_distance", Value::Int(5)),
        home(33),
    ];
    for (sequence, action) in (1_u64..).zip(actions) {
        let mut commands = vec![Command { sequence, source: Source::Scenario, action }];
        for _ in 0..10_000 {
            assert_no_alloc(|| {
                inputs.begin(machine.next_cycle(), 0);
                plant.read(&mut inputs);
                machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
                plant.write(&outputs);
            });
            homed.extend(machine.events().iter().filter(|event| event.kind == Kind::Homed).map(|event| event.cycle));
            commands.clear();
        }
    }
    assert_eq!((violation_count(), homed.len()), (0, 5));
}

/// A table is handed over by its pointer, however long it is: its numbers are neither copied nor freed in the cycle.
#[test]
fn a_million_points_change_hands_without_memory() {
    let numbers: Vec<i64> = (0..MOST as i64).collect();
    let points = |form, x: &[i64]| Arc::new(Table::new(form, x, &numbers).expect("as many as a table may have"));
    let tables = [table(1), points(Numbering::Y, &[]), points(Numbering::Xy, &numbers)];
    let tables = ["w", "y", "xy"].iter().zip(tables).map(|(name, table)| TableConfig { name: (*name).into(), table });
    // A cam reads the words, and takes new ones while it runs.
    let place = slots().iter().position(|slot| slot.kind == function::Kind::Cam).expect("one of each type");
    let slots = vec![slots().swap_remove(place)];
    let mut machine = Machine::new(MachineConfig { tables: tables.collect(), slots, masters: Vec::new(), ..config() })
        .expect("a sound machine");
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut kept = machine.state().clone();
    let start = CommandFunction { slot: 0, order: Order::Start, values: Box::new([]) };
    let commands = [Command { sequence: 1, source: Source::Ros, action: Action::CommandFunction(start) }];
    machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
    // Who gives tables keeps them as long as the machine may have them.
    let mut given = Vec::new();
    for turn in 1..4 {
        let loaded = [long_table(turn, MOST), points(Numbering::Y, &[]), points(Numbering::Xy, &numbers)];
        let action = |(index, table): (u16, &Arc<Table>)| Action::LoadTable { index, table: Arc::clone(table) };
        let commands: Vec<Command> =
            (0..).zip(&loaded).map(action).map(|action| Command { sequence: 2, source: Source::Ros, action }).collect();
        inputs.begin(turn.unsigned_abs(), 0);
        assert_no_alloc(|| {
            machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
            kept.clone_from(machine.state());
        });
        assert_eq!(violation_count(), 0, "in cycle {turn}");
        assert!(machine.slots()[0].is_active(), "the cam runs");
        assert!(machine.tables().iter().zip(&loaded).all(|(now, given)| Arc::ptr_eq(now, given)), "in cycle {turn}");
        given.push(loaded);
    }
}

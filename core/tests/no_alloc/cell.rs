//! A cell with every kind of object.

use lineshaft_core::axis::{BrakeConfig, Safety, Wired};
use lineshaft_core::config::{
    AxisConfig, EncoderConfig, FilterConfig, GlobalConfig, IoConfig, IoKind, Line, MachineConfig, MemoryConfig,
    MemoryKind, ProgramConfig, SinkConfig, SlotConfig, SourceConfig, SumConfig, TableConfig,
};
use lineshaft_core::drive::{AnalogWiring, Capabilities, Interface, SpeedOutputs};
use lineshaft_core::encoder::{Absolute, Form, Parity, WordCode};
use lineshaft_core::function::{self, MemorySize, TYPES};
use lineshaft_core::object::{Leader, Object};
use lineshaft_core::parameter::{
    AssignedOutputs, AxisParameters, Encoders, GantryParameters, MachineParameters, Supervision,
};
use lineshaft_core::regulator::Law;
use lineshaft_core::sim::{
    Amplifier, Coupling, Friction, Load, Model, Motor, MotorData, Reading, SecondOrder, Stage, TwoSpeed, Valve,
    VelocityLag,
};
use lineshaft_core::table::{CamSetting, Form as Numbering, Interpolation, Table};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
use lineshaft_core::vocabulary::{Wiring, amc};
use lineshaft_program::Module;
use std::sync::Arc;

use super::AXES;

/// The axis with two drives.
const GANTRY: u16 = 4;

/// Returns the interface of an axis; the first axis has no drive.
pub(super) fn interface(index: u16) -> Interface {
    match index % 4 {
        1 if index > 4 => Interface::Torque,
        1 => Interface::Velocity,
        2 if index == 2 => Interface::Voltage,
        2 if index > 4 => Interface::OpenLoop,
        3 if index > 4 => Interface::OpenLoop,
        _ => Interface::Position,
    }
}

/// Returns a model of a drive that does not allocate either.
pub(super) fn model(index: u16) -> Model {
    let ms = 1_000_000;
    match index {
        1 => Model::Velocity(VelocityLag::new(5 * ms, 1_000_000).expect("a legal lag")),
        4 => Model::SecondOrder(SecondOrder::new(60.0, 0.8, 1_000_000).expect("a legal model")),
        2 => {
            let winding = Stage::Winding {
                voltage: 48.0,
                resistance: 1.2,
                inductance: 3e-3,
                torque_constant: 0.4,
                back_emf: 0.4,
            };
            let amplifier = Amplifier { stage: winding, limit: 1.0, dead_time_ns: 0 };
            Model::Motor(Motor::new(MotorData { amplifier, ..motor() }).expect("a legal motor"))
        }
        5 => Model::Motor(Motor::new(motor()).expect("a legal motor")),
        6 => Model::TwoSpeed(TwoSpeed::new(50 * ms, 100 * ms, 1_000_000).expect("a legal motor")),
        7 => Model::Valve(Valve::new(50 * ms, 20 * ms + 1, 1_000_000).expect("a legal valve")),
        _ => Model::Ideal,
    }
}

/// Returns a motor with a load on an elastic shaft with backlash.
fn motor() -> MotorData {
    let friction = Friction { viscous: 1e-4, coulomb: 0.02, holding: 0.03 };
    MotorData {
        inertia: 2.5e-4,
        friction,
        load: Load { inertia: 5e-4, friction, torque: 0.01 },
        coupling: Some(Coupling { stiffness: 200.0, damping: 0.01, backlash: 0.01 }),
        amplifier: Amplifier {
            stage: Stage::Torque { rated: 1.0, lag_ns: 500_000 },
            limit: 3.0,
            dead_time_ns: 1_300_000,
        },
        reading: Reading { counts_per_turn: 4_000.0, noise: 0.5, seed: 3, at_load: false },
    }
}

/// Returns the models of all drives: the second drive of the axis with two drives comes last.
pub(super) fn models() -> Vec<Option<Model>> {
    (1..AXES).chain([GANTRY]).map(|index| Some(model(index))).collect()
}

/// Returns the same machine with every kind of absolute encoder: Gray code with corrected turns, binary code of a drive
/// that closes its own loop, an entry of `encoders`, and the code of a positioning module with parity.
pub(super) fn absolute() -> MachineConfig {
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

/// Returns the same machine with an axis that has an analog voltage command.
pub(super) fn analog() -> MachineConfig {
    let mut config = config();
    let place = config.io.len() as u16;
    let entry = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    config.io.push(entry("reference", IoKind::AnalogOutput));
    config.io.push(entry("enable", IoKind::DigitalOutput));
    config.io.push(entry("ready", IoKind::DigitalInput));
    let scale = config.encoders[0].scale;
    let form = Form::Incremental(32);
    config.encoders.push(EncoderConfig { name: "motor".into(), form, check: None, scale });
    let axis = &mut config.axes[1];
    axis.wired = Wired::Encoder(1);
    let [reference, enable, ready] = [place, place + 1, place + 2];
    axis.analog = Some(AnalogWiring { reference, enable, ready: Some(ready), full: 1e5, enable_ns: 10_000_000 });
    config
}

pub(super) fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).expect("a legal scale");
    let axis = |index: u16| {
        let drive = (index > 0).then_some(u32::from(index % 3));
        // Following errors usually stop only their own axis, so that other motions continue.
        let supervision = Supervision { following_error_stops_all: i64::from(index == 3), ..Supervision::default() };
        let parameters = AxisParameters {
            supervision,
            max_position: index.is_multiple_of(2).then_some(40_000),
            error_reaction: i64::from(index % 6),
            encoder: Encoders { mencodertype: if index == 2 { 10 } else { 0 }, ..Encoders::default() },
            outputs: AssignedOutputs { brake: if index == 3 { -2 } else { 0 }, axmove: if index == 3 { 5 } else { 0 } },
            gantry: GantryParameters { max_skew: (index == GANTRY).then_some(100_000), ..GantryParameters::default() },
            ..AxisParameters::new(1e5, 1e6)
        };
        let interface = interface(index);
        let mut parameters = parameters;
        if interface == Interface::Voltage {
            parameters.in_position_window = 5_000;
            let p = &mut parameters.amplifier;
            (p.max_effort, p.torque_constant) = (Some(1000.0), 25.0);
            parameters.power_stage.full_current = Some(10.0);
        }
        if interface == Interface::Torque {
            // A coarse encoder with backlash: the axis jitters around its target.
            parameters.in_position_window = 5_000;
            let p = &mut parameters.amplifier;
            (p.max_effort, p.torque_constant, p.max_current) = (Some(3000.0), 100.0, 60_000);
            (p.heat_time, p.heat_limit) = (500, 1_000_000);
            (p.estimator, p.acceleration) = (3, 1e5);
        }
        if index % 3 == 2 && interface != Interface::OpenLoop {
            parameters.compensation.backlash = 50;
        }
        let law = if index % 4 == 1 { Law::Pid } else { Law::Proportional };
        // Each output of one axis.
        let place = |first: u16| (interface == Interface::OpenLoop).then_some(first + index);
        let open_loop = SpeedOutputs { forward: place(2), backward: place(10), output: place(18), dac: place(26) };
        let brake =
            BrakeConfig { output: 1 + index, closes_with_one: true, release_ns: 9_000_000, engage_ns: 7_000_000 };
        AxisConfig {
            interface,
            law,
            second: drive.map(Capabilities::all).filter(|_| index == GANTRY),
            brake: Some(brake).filter(|_| index == 4),
            pitch_error: (index % 3 == 2 && interface != Interface::OpenLoop).then_some(3),
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
        tables: [
            ("t", table(3)),
            ("c", cam_table(Interpolation::Linear)),
            ("s", cam_table(Interpolation::Quintic)),
            ("p", screw()),
        ]
        .map(|(name, table)| TableConfig { name: name.into(), table })
        .into(),
        programs: vec![ProgramConfig { name: "wild".into(), module: wild() }],
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
            parameters: MachineParameters {
                i_errclr: 1,
                i_break: -1,
                i_continue: 1,
                o_error: 3,
                ainftime: 5,
                vmencmtyp: 12,
                ..MachineParameters::default()
            },
            filters: vec![FilterConfig { input: 0, time_ns: 3_000_000 }],
            ..GlobalConfig::default()
        },
    }
}

pub(super) fn master(name: &str, add: &[Leader], subtract: &[Leader]) -> SumConfig {
    SumConfig { name: name.into(), add: add.into(), subtract: subtract.into() }
}

/// Returns a table of pitch errors.
fn screw() -> Arc<Table> {
    Arc::new(Table::new(Numbering::Xy, &[0, 2_000, 5_000], &[40, -100, 0]).expect("points"))
}

pub(super) fn table(turn: i64) -> Arc<Table> {
    long_table(turn, 40)
}

/// Returns a table of `count` words: two points or cams, the second one from `turn` * 100 on.
pub(super) fn long_table(turn: i64, count: usize) -> Arc<Table> {
    let words: Vec<i64> =
        (0..count).map(|word| [3, 0, 0, 0, 100, 0, 1, 0, turn * 100].get(word).copied().unwrap_or(0)).collect();
    Arc::new(Table::new(Numbering::Words, &[], &words).expect("words"))
}

/// Returns a program that traps, loops without end and counts, as its source says.
pub(super) fn wild() -> Arc<Module> {
    let bytes = wat::parse_str(include_str!("../programs/wild.wat")).expect("a module");
    Arc::new(Module::load(&bytes).expect("it is taken"))
}

/// Returns one slot of each type, two of them with an axis, linked with each other.
pub(super) fn slots() -> Vec<SlotConfig> {
    let slots = TYPES.iter().enumerate().map(|(place, row)| {
        let mut slot = SlotConfig::new(format!("f{place}"), place as u16, row.kind);
        slot.source = match row.kind {
            function::Kind::Cam | function::Kind::Apsf => SourceConfig::Lead(Leader::Encoder(0)),
            function::Kind::Varsync => SourceConfig::Lead(Leader::AxisCommand(0)),
            function::Kind::Ecopy => SourceConfig::Lead(Leader::Sink(5)),
            function::Kind::Binea => SourceConfig::Lead(Leader::Sink(0)),
            _ if row.source == function::Requirement::Must => SourceConfig::Lead(Leader::Encoder(0)),
            _ => SourceConfig::None,
        };
        slot.sink = match row.kind {
            function::Kind::Varsync => SinkConfig::Axis(5),
            function::Kind::Ecopy => SinkConfig::Memory(2),
            _ => SinkConfig::None,
        };
        slot.program = (row.runs_program).then_some(0);
        slot.tables[0] = (row.tables > 0).then_some(0);
        if matches!(row.kind, function::Kind::Fipw | function::Kind::Xfipw | function::Kind::Fipz) {
            slot.tables[0] = Some(1);
        }
        for (name, value) in row.example {
            slot.values[row.find(name).expect("a field").1] = *value;
        }
        slot.room = MemorySize { mean: 32, cams: 0 };
        for line in slot.inputs.iter_mut().take(row.inputs) {
            *line = Some(Line { object: Object::Memory(1), inverted: false });
        }
        slot
    });
    slots.collect()
}

/// Returns a table with two slopes over 4000 increments.
pub(super) fn cam_table(interpolation: Interpolation) -> Arc<Table> {
    let table = Table::new(Numbering::Y, &[], &[0, 90, 20]).expect("points");
    Arc::new(table.with_cam(CamSetting { length: Some(4000), interpolation, ..CamSetting::default() }))
}

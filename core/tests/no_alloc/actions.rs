//! Random commands for the cell: the same in every run.

use lineshaft_core::code::Code;
use lineshaft_core::command::{
    AbortTrigger, Action, BufferMode, CamIn, CommandFunction, DisengageAt, Engage, GearOut, HomeAxis, HomingMethod,
    Level, MasterPosition, Move, MoveMode, OutAn, Phase, PhaseShift, PhaseSide, Probe, ProbeEdge, QueryTrajectory,
    RunFunction, SetEncoderPosition, SetMasterPosition, SetPosition, ShiftPosition, Synchronize, TouchProbe,
};
use lineshaft_core::function::{Order, TYPES};
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader, Object};
use lineshaft_core::parameter::{Change, Layer, MACHINE, Row, Value};
use lineshaft_core::position::{Length, Position};
use lineshaft_core::sync::gear::Ratio;
use lineshaft_core::sync::{CamStart, Disengage, SyncMode};
use lineshaft_core::trajectory::{Knot, Tolerance, Track, Trajectory};
use lineshaft_core::unit::{Amount, Scale};
use lineshaft_core::vocabulary::saia::{Command as SaiaCommand, Register, Request};
use lineshaft_core::vocabulary::{self, wf};
use std::sync::Arc;

use super::AXES;
use super::cell::config;

macro_rules! kinds {
    ($($name:ident),* $(,)?) => {
        /// Names of all actions.
        pub(super) const KINDS: &[&str] = &["Saia", "Wf", $(stringify!($name)),*];

        /// Returns the name of an action. An action missing in the list does not compile, and every action of the list
        /// must be given.
        pub(super) fn kind(action: &Action) -> &'static str {
            match action {
                Action::Vocabulary(vocabulary::Request::Saia(_)) => "Saia",
                Action::Vocabulary(vocabulary::Request::Wf(_)) => "Wf",
                $(Action::$name { .. } => stringify!($name),)*
            }
        }
    };
}

kinds! {
    Enable, Disable, Halt, QuickStop, Abort, ResetErrors, Activate, Deactivate, Move, Probe, TouchProbe, AbortTrigger, Trajectory, QueryTrajectory,
    HomeAxis, SetPosition, ShiftPosition, SetEncoderPosition, SetMasterPosition, Synchronize, Phase, GearOut, OutAn, Cancel, SetParameters, SaveParameters,
    ResetParameters, DeleteParameters, PowerCycle, SetMemory, CommandFunction, RunFunction, LoadTable, LoadProgram, SetOutputs, Refuse, Note,
}

/// Returns a cam of either cam table, linear or a spline.
pub(super) fn cam(number: i64) -> CamIn {
    let start = CamStart::NAMES[number.unsigned_abs() as usize / 3 % 3].1;
    CamIn {
        table: if number % 2 == 0 { 1 } else { 2 },
        start,
        master_scale: Ratio::new(number % 7, 5).unwrap_or(Ratio::ONE),
        slave_scale: Ratio::ONE,
        master_offset: Length::whole(number % 1000),
        slave_offset: Length::whole(number % 50),
    }
}

/// Returns a phase shift of either side, in increments of any leader.
pub(super) fn phase(axis: u16, number: i64) -> Phase {
    let shift = PhaseShift { shift: Length::whole(number % 5_000), velocity: 1_000.0, acceleration: 10_000.0 };
    let scale = config().axes[0].scale;
    let given = [Amount::default(); 3];
    let master = PhaseSide::Master { given, by_scale: [(scale, shift), (Scale::increments(), shift)].into() };
    Phase { axis, side: if number % 4 == 0 { PhaseSide::Slave(shift) } else { master } }
}

/// Returns the end of a coupling at a position that is reached often.
pub(super) fn leaving(axis: u16, number: i64) -> GearOut {
    let at = match number % 5 {
        0 => DisengageAt::Now,
        1 | -1 => DisengageAt::Axis(number / 7),
        _ => DisengageAt::Leader(number / 7),
    };
    let disengage = (number % 2 == 0).then_some(Disengage::KeepVelocity);
    GearOut { axis, at, disengage }
}

/// Returns an order to a function with a value that is often valid.
pub(super) fn command(numbers: &mut Numbers) -> Action {
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

/// Returns a goal of a function, usually of one that accepts goals.
pub(super) fn run(numbers: &mut Numbers) -> Action {
    let taking = TYPES.iter().position(|row| row.takes_goals).expect("a type that takes goals") as u16;
    let slot = if numbers.below(8) == 0 { numbers.below(TYPES.len() as u64) as u16 } else { taking };
    let travel = TYPES[usize::from(taking)].find("travel").expect("a field").1 as u16;
    let values = if slot == taking { vec![(travel, numbers.below(2000) as i64 - 1000)] } else { vec![] };
    Action::RunFunction(RunFunction { slot, values: values.into() })
}

/// A random number generator with the same numbers in every run.
pub(super) struct Numbers(pub(super) u64);

impl Numbers {
    pub(super) fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

pub(super) fn action(numbers: &mut Numbers, sequence: u64) -> Action {
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
            4 => Action::Cancel { goal: sequence.saturating_sub(1 + numbers.below(20)) },
            5 => Action::QueryTrajectory(QueryTrajectory {
                axis: (numbers.below(20) % 8) as u16,
                at_ns: sequence * 1_000_000,
            }),
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
                let axis = numbers.below(8) as u16;
                match position.nearest % 2 {
                    0 => Action::ShiftPosition(ShiftPosition { axis, distance: position }),
                    _ => Action::SetPosition(SetPosition { axis, position }),
                }
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
        _ if number % 5 == 0 => Leader::Virtual,
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
        11 if number % 5 == 4 => Action::Synchronize(Synchronize {
            axis,
            leader: Some(Leader::Encoder(0)),
            mode: match number % 4 {
                0 => SyncMode::MasterMarker,
                2 => SyncMode::SlaveMarker,
                _ => SyncMode::Marker,
            },
            engage: Engage::Immediately,
            disengage: Disengage::Stop,
            numerator: number,
            denominator: 7919,
            offset: Length::default(),
            velocity: 0.0,
            acceleration: 0.0,
            cam: (number % 2 == 0).then(|| cam(number)),
        }),
        11 => Action::Synchronize(Synchronize {
            axis,
            leader: Some(leader),
            mode: SyncMode::Position,
            engage: match number % 18 {
                0 => Engage::AtEnd,
                3 => Engage::AtPosition { position: number / 7, turn: None },
                1 => Engage::InPosition { position: number, turn: None, slave: number / 9, distance: 2_000 },
                6 | 7 => Engage::OnEvent(Object::Encoder(0)),
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
        19 if number % 3 == 0 => Action::TouchProbe(TouchProbe {
            axis,
            source: Object::Axis(number.rem_euclid(8) as u16),
            edge: ProbeEdge::Rising,
            continuous: number % 2 == 0,
            window: (number % 4 == 0).then(|| [-50_000, 50_000].map(Length::whole)),
        }),
        19 if number % 6 == 1 => Action::AbortTrigger(AbortTrigger { axis, source: None }),
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
        20 if number % 3 == 0 => virtual_master(number),
        _ => {
            let (row, _) = Row::find("max_velocity").expect("a key of the catalogue");
            Action::SetParameters(Box::new([Change { axis, row, value: Value::Real(5e4 + number as f64 / 4.0) }]))
        }
    }
}

/// Returns a value for OUTAN, for loops whose position loop is open, or opens with it.
pub(super) fn open(numbers: &mut Numbers) -> Action {
    let value = numbers.below(200) as f64 / 1000.0 - 0.1;
    let level = if numbers.below(4) == 0 { Level::Effort } else { Level::Setpoint };
    Action::OutAn(OutAn { axis: numbers.below(u64::from(AXES)) as u16, value, level })
}

/// Returns a start of the virtual master, which some axes lead and some follow.
fn virtual_master(number: i64) -> Action {
    let ramp = if number % 2 == 0 { 100_000 } else { number.clamp(-1, 0) };
    let values = [("vmenctyp", 100 * (number / 6).rem_euclid(4)), ("pulsacc", ramp), ("pulsvel", number)];
    let change = |(key, value)| {
        let (row, _) = Row::find(key).expect("a key of the catalogue");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    Action::SetParameters(Box::new(values.map(change)))
}

/// Returns a request to a positioning module; modes are selected often enough for some requests to be possible.
pub(super) fn module(numbers: &mut Numbers) -> wf::Request {
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

/// Returns a change for a reference selector.
pub(super) fn select(axis: u16, numbers: &mut Numbers) -> Action {
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

/// Returns random registers and commands, often enough a start.
pub(super) fn saia(axis: u16, numbers: &mut Numbers) -> Request {
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

/// Returns a trajectory of two axes from any position, slow enough for many of them.
pub(super) fn trajectory(numbers: &mut Numbers) -> Arc<Trajectory> {
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
        Track { axis, knots: knots.collect(), path: tolerance, goal: tolerance, ..Track::default() }
    };
    let tracks = Box::new([track(first), track((first + 4) % AXES)]);
    let start = numbers.below(400_000_000) as i64 - 200_000_000;
    Arc::new(Trajectory::new(start, times, tracks, Some(100_000_000)).expect("a sound one"))
}

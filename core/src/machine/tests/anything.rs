//! Random commands in any order, with faults and slips between them.

mod cell;
mod limits;
mod locks;

use super::rig::{Rig, at, cases, config, to};
use crate::code::Code;
use crate::command::{
    AbortTrigger, Action, BufferMode, CamIn, DisengageAt, Engage, GearOut, HomeAxis, HomingMethod, Level, Move,
    MoveMode, OutAn, Phase, PhaseShift, PhaseSide, Probe, ProbeEdge, QueryTrajectory, SetPosition, ShiftPosition,
    Synchronize, TouchProbe,
};
use crate::drive::{Edge, Interface, Latch, control};
use crate::event::Kind;
use crate::modulo::{Direction, Modulo};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Layer, MACHINE, Row, Value};
use crate::position::{Length, Position};
use crate::regulator::PidGains;
use crate::request::Amount;
use crate::state::HomingPhase;
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::trajectory::{Tolerance, Track, Trajectory};
use crate::vocabulary::{self, Order, saia, wf};
use cell::{TABLES, fixtures, interface, law, model, output, posdrct, screw, table, tables, terminals};
use limits::{check_limits, places};
use locks::Locks;
use proptest::prelude::*;
use std::sync::Arc;

const AXES: [&str; 3] = ["line", "x", "y"];

#[derive(Clone, Debug)]
enum RandomEvent {
    Command(Action),
    Cancel(usize),
    Cycles(u64),
    Fault(usize),
    Slip(usize, i64),
    /// An order that only axes in open loop execute.
    Order(u16, Order),
    Latch(u16, bool, u32),
    /// A new streamed setpoint.
    Stream(u16, f64),
    Mirror,
    /// A digital input: a contact of the cell, or i_break.
    Input(usize, bool),
    /// A switch at the drive that is stuck.
    Switch(usize, u32, bool),
}

fn axis() -> impl Strategy<Value = u16> {
    0_u16..3
}

fn axes() -> impl Strategy<Value = AxisSet> {
    prop::collection::vec(axis(), 1..4).prop_map(|axes| axes.into_iter().collect())
}

fn rate() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 2e4..1e6_f64]
}

fn positioning() -> impl Strategy<Value = Action> {
    let velocity = prop_oneof![Just(0.0), 100.0..100_000.0_f64];
    let modes = [MoveMode::Absolute, MoveMode::Relative, MoveMode::Additive, MoveMode::Superimposed];
    let modes = prop::sample::select(modes.to_vec());
    use Direction::{Current, Negative, Positive, Shortest};
    let ways = (buffer_mode(), prop::sample::select(vec![Shortest, Positive, Negative, Current]));
    (axis(), modes, -60_000_i64..60_000, velocity, rate(), rate(), ways).prop_map(
        |(axis, mode, target, velocity, acceleration, deceleration, (buffer_mode, direction))| {
            let goal = Move { mode, velocity, acceleration, deceleration, ..to(axis, target) };
            Action::Move(Move { buffer_mode, direction, ..goal })
        },
    )
}

fn buffer_mode() -> impl Strategy<Value = BufferMode> {
    use BufferMode::*;
    prop_oneof![
        3 => Just(Aborting),
        4 => prop::sample::select(vec![Buffered, BlendingLow, BlendingPrevious, BlendingNext, BlendingHigh]),
    ]
}

/// A change of the override or of the shape of the next profile.
fn setting() -> impl Strategy<Value = Action> {
    let share =
        prop_oneof![Just(0.0), Just(100.0), 0.0..100.0_f64].prop_map(|share| ("velocity_override", Value::Real(share)));
    let shape = (0_i64..3).prop_map(|shape| ("profile", Value::Int(shape)));
    let low = prop_oneof![-60_000_i64..0, -300_i64..0].prop_map(|low| ("min_position", Value::Int(low)));
    let high = prop_oneof![1_i64..60_000, 1_i64..300].prop_map(|high| ("max_position", Value::Int(high)));
    let open = prop::sample::select(vec![("min_position", Value::Unset), ("max_position", Value::Unset)]);
    let choices = vec!["homing.required", "endswmod", "homing.in_drive"];
    let choice = (prop::sample::select(choices), 0_i64..2).prop_map(|(key, value)| (key, Value::Int(value)));
    let offset = (-9_000_i64..9_000).prop_map(|by| ("homing.offset", Value::Int(by)));
    (axis(), prop_oneof![2 => share, 2 => shape, 1 => low, 1 => high, 1 => open, 2 => choice, 1 => offset]).prop_map(
        |(axis, (key, value))| {
            let (row, _) = Row::find(key).expect("the key of a row");
            Action::SetParameters([Change { axis, row, value }].into())
        },
    )
}

/// Parameters of the virtual master.
fn virtual_master() -> impl Strategy<Value = Action> {
    let values = (-90_000_i64..90_000, prop::sample::select(vec![-1_i64, 0, 5_000, 900_000]), 0_i64..4, any::<bool>());
    values.prop_map(|(velocity, pulsacc, axis, starts)| {
        let key = if starts { "pulsvel" } else { "setsys_15" };
        let all = [("vmenctyp", 100 * axis), ("vmencmtyp", 32), ("pulsacc", pulsacc), (key, velocity)];
        let change = |(key, value)| {
            let (row, _) = Row::find(key).expect("the key of a row");
            Change { axis: MACHINE, row, value: Value::Int(value) }
        };
        Action::SetParameters(all.map(change).into())
    })
}

/// Commands for parameter layers.
fn storing() -> impl Strategy<Value = Action> {
    let layer = prop::sample::select(&[Layer::User, Layer::Init][..]);
    prop_oneof![
        2 => axes().prop_map(Action::SaveParameters),
        2 => (axes(), layer).prop_map(|(axes, layer)| Action::ResetParameters { axes, layer }),
        1 => axes().prop_map(Action::DeleteParameters),
        1 => Just(Action::PowerCycle),
    ]
}

/// Requests of the other vocabularies.
fn vocabulary() -> impl Strategy<Value = Action> {
    use saia::{Command, Register};
    let commands = prop::sample::select(vec![
        vec![Command::LoadDestination, Command::Start],
        vec![Command::LoadVelocity, Command::Start],
        vec![Command::LoadAcceleration, Command::LoadVelocity, Command::Start],
        vec![Command::SelectMode, Command::Start],
        vec![Command::Stop],
        vec![Command::Initialise],
    ]);
    let saia = (axis(), commands, -60_000_i64..60_000, 1_000_i64..90_000).prop_map(|(axis, commands, place, speed)| {
        let request = saia::Request { axis, commands: saia::Commands::from_iter(commands), ..Default::default() };
        let request = request.with(Register::DestP, Value::Int(place)).with(Register::Veloc, Value::Int(speed));
        Action::vocabulary(request.with(Register::Accel, Value::Int(200_000)))
    });
    let jog = prop::sample::select(&[wf::Jog::None, wf::Jog::Plus, wf::Jog::Minus][..]);
    let mode = prop::sample::select(vec![wf::Mode::Mdi, wf::Mode::Single, wf::Mode::Continuous, wf::Mode::Jog]);
    let block = (-60_000_i64..60_000, 1.0..99.0_f64, any::<bool>()).prop_map(|(place, speed, absolute)| {
        let (position, speed) = (Position::whole(place), wf::Speed::Value(speed));
        wf::Block { position, speed, absolute }
    });
    let blocks = prop::collection::vec(block, 1..3).prop_map(|blocks| wf::Blocks::new(&blocks));
    let wf = (axis(), mode, jog, blocks, any::<bool>()).prop_map(|(axis, mode, jog, blocks, jogs)| {
        let (jog, start) = if jogs { (Some(jog), false) } else { (None, true) };
        let blocks = blocks.filter(|_| start);
        let request =
            wf::Request { axis, blocks, start, jog, mode: Some(mode), enable: Some(true), ..Default::default() };
        Action::vocabulary(request)
    });
    let amc =
        (axis(), prop::sample::select(vec![0, 1, 2, 4, 6, 7]), -60.0..60.0_f64).prop_map(|(axis, select, value)| {
            let row = |key| Row::find(key).expect("the key of a row").0;
            let change = |key, value| Change { axis, row: row(key), value };
            let select = change("amc.reference_select", Value::Int(select));
            let place = change("amc.position_reference", Value::Real(value));
            Action::SetParameters([place, change("amc.speed_reference", Value::Real(value)), select].into())
        });
    prop_oneof![saia, wf, amc]
}

fn running() -> impl Strategy<Value = Action> {
    let velocity = prop_oneof![Just(0.0), -100_000.0..100_000.0_f64, -2_000.0..2_000.0_f64];
    (axis(), velocity, rate(), rate(), buffer_mode()).prop_map(
        |(axis, velocity, acceleration, deceleration, buffer_mode)| {
            Action::Move(Move { acceleration, deceleration, buffer_mode, ..at(axis, velocity) })
        },
    )
}

/// Cams with every kind of start, from the tables of the cell.
fn cam() -> impl Strategy<Value = CamIn> {
    let start = prop::sample::select(CamStart::NAMES.map(|(_, start)| start).to_vec());
    let scale = prop::sample::select(vec![(1, 1), (-1, 1), (1, 3), (5, 2), (-7, 4)]);
    let ratio = |(numerator, denominator)| Ratio::new(numerator, denominator).expect("not 0");
    (0..TABLES, start, (scale.clone(), scale), (-3000_i64..3000, -900_i64..900)).prop_map(
        move |(table, start, (master, slave), (master_offset, slave_offset))| CamIn {
            table,
            start,
            master_scale: ratio(master),
            slave_scale: ratio(slave),
            master_offset: Length::whole(master_offset),
            slave_offset: Length::whole(slave_offset),
        },
    )
}

/// A replacement of a table by the values of another one.
fn loading() -> impl Strategy<Value = Action> {
    (0..TABLES, 0..TABLES).prop_map(|(index, from)| {
        let numbers = (*table(from)).clone().with_cam(table(index).cam_setting());
        Action::LoadTable { index, table: Arc::new(numbers) }
    })
}

fn coupling() -> impl Strategy<Value = Action> {
    let leader = (axis(), any::<bool>())
        .prop_map(|(axis, actual)| if actual { Leader::AxisActual(axis) } else { Leader::AxisCommand(axis) });
    let leader = prop_oneof![9 => leader, 1 => Just(Leader::Virtual)];
    let leader = prop::option::weighted(0.9, leader);
    let ways = (any::<bool>(), any::<bool>());
    let cam = prop::option::weighted(0.5, cam());
    let at_position = (-30_000_i64..30_000).prop_map(|position| Engage::AtPosition { position, turn: None });
    let on_event =
        prop::sample::select(vec![Object::Io(0), Object::Encoder(0), Object::Axis(1)]).prop_map(Engage::OnEvent);
    let pair = (-30_000_i64..30_000, -20_000_i64..20_000, prop_oneof![Just(0), 1_i64..20_000])
        .prop_map(|(position, slave, distance)| Engage::InPosition { position, turn: None, slave, distance });
    let engage = prop_oneof![
        4 => Just(Engage::Immediately),
        1 => Just(Engage::AtEnd),
        2 => at_position,
        2 => on_event,
        3 => pair
    ];
    let by_marks = prop::bool::weighted(0.15);
    (axis(), leader, -5_i64..5, 1_i64..4, ways, -500_i64..500, (cam, engage, by_marks)).prop_map(
        |(axis, leader, numerator, denominator, (keeps, relates), offset, (cam, engage, by_marks))| {
            let by_position = if relates || cam.is_some() { SyncMode::Position } else { SyncMode::Velocity };
            Action::Synchronize(Synchronize {
                axis,
                // The index of this encoder gives marks.
                leader: if by_marks { Some(Leader::Encoder(0)) } else { leader },
                mode: match (by_marks, cam.is_some(), relates) {
                    (false, ..) => by_position,
                    (true, false, _) => SyncMode::Marker,
                    (true, true, false) => SyncMode::MasterMarker,
                    (true, true, true) => SyncMode::SlaveMarker,
                },
                engage: if by_marks { Engage::Immediately } else { engage },
                disengage: if keeps { Disengage::KeepVelocity } else { Disengage::Stop },
                numerator,
                denominator,
                offset: Length::whole(offset),
                velocity: 0.0,
                acceleration: 0.0,
                cam,
            })
        },
    )
}

/// Phase shifts of either side of a coupling, if there is one.
fn phasing() -> impl Strategy<Value = Action> {
    let rate = |most: f64| prop_oneof![1 => Just(0.0), 3 => 10.0..most];
    (axis(), any::<bool>(), -20_000_i64..20_000, rate(60_000.0), rate(600_000.0)).prop_map(
        |(axis, is_master, shift, velocity, acceleration)| {
            let shift = PhaseShift { shift: Length::whole(shift), velocity, acceleration };
            let by_scale = [(super::rig::scale(), shift)].into();
            let master = PhaseSide::Master { given: [Amount::default(); 3], by_scale };
            Action::Phase(Phase { axis, side: if is_master { master } else { PhaseSide::Slave(shift) } })
        },
    )
}

/// The end of a coupling, if there is one.
fn leaving() -> impl Strategy<Value = Action> {
    let place = -30_000_i64..30_000;
    let at = prop_oneof![
        1 => Just(DisengageAt::Now),
        3 => place.clone().prop_map(DisengageAt::Leader),
        2 => place.prop_map(DisengageAt::Axis),
    ];
    let disengage = prop::option::of(prop::sample::select(vec![Disengage::Stop, Disengage::KeepVelocity]));
    (axis(), at, disengage).prop_map(|(axis, at, disengage)| Action::GearOut(GearOut { axis, at, disengage }))
}

/// Opening of a position loop that is closed in the core.
fn opening() -> impl Strategy<Value = Action> {
    let value = prop_oneof![4 => -1.0..1.0_f64, 1 => Just(0.0), 1 => Just(1.5), 1 => Just(f64::NAN)];
    let level = prop::sample::select(vec![Level::Setpoint, Level::Setpoint, Level::Effort]);
    (axis(), value, level).prop_map(|(axis, value, level)| Action::OutAn(OutAn { axis, value, level }))
}

fn probing() -> impl Strategy<Value = Action> {
    let edge = prop::sample::select(vec![ProbeEdge::Rising, ProbeEdge::Falling, ProbeEdge::Both, ProbeEdge::Index]);
    let velocity = prop_oneof![Just(0.0), 100.0..100_000.0_f64];
    let ways = (any::<bool>(), -60_000_i64..60_000, -20_000_i64..20_000);
    (axis(), ways, velocity, rate(), rate(), 1_u16..3, edge).prop_map(
        |(axis, (relative, target, distance), velocity, acceleration, deceleration, source, edge)| {
            Action::Probe(Probe {
                axis,
                relative,
                target: Length::whole(target),
                velocity,
                acceleration,
                deceleration,
                jerk: 0.0,
                source: Object::Axis(source),
                edge,
                distance: Length::whole(distance),
            })
        },
    )
}

/// Touch probes, armed and aborted, for sources that latch, more than fit, with and without a window.
fn touch_probing() -> impl Strategy<Value = Action> {
    let edge = prop::sample::select(vec![ProbeEdge::Rising, ProbeEdge::Falling, ProbeEdge::Both, ProbeEdge::Index]);
    let source = || prop_oneof![(0_u16..3).prop_map(Object::Axis), (0_u16..5).prop_map(Object::Io)];
    let window = prop::option::of([-60_000_i64..60_000, -60_000_i64..60_000]);
    let arm = (axis(), source(), edge, any::<bool>(), window).prop_map(|(axis, source, edge, continuous, window)| {
        let window = window.map(|places| places.map(Length::whole));
        Action::TouchProbe(TouchProbe { axis, source, edge, continuous, window })
    });
    let abort = (axis(), prop::option::of(source()))
        .prop_map(|(axis, source)| Action::AbortTrigger(AbortTrigger { axis, source }));
    prop_oneof![3 => arm, 1 => abort]
}

/// Trajectories of some axes, from any state; most of them are within the velocity limits.
fn following() -> impl Strategy<Value = Action> {
    let rate = |most: f64| prop::option::weighted(0.7, prop_oneof![Just(0.0), -most..most]);
    let point = || (-50_000_i64..50_000, rate(20_000.0), rate(100_000.0));
    let tolerance =
        || prop::option::of(0.0..3_000.0_f64).prop_map(|position| Tolerance { position, ..Tolerance::default() });
    let track = move || (prop::collection::vec(point(), 3), tolerance(), tolerance());
    let tracks = prop::collection::vec(track(), 3);
    let times = (1_u64..4, 1_u64..1_500_000_000, 1_000_000_u64..3_000_000_000);
    let start = prop_oneof![2 => Just(0), 1 => -500_000_000_i64..500_000_000];
    (axes(), tracks, times, start, prop::option::of(0_u64..500_000_000)).prop_map(
        |(axes, tracks, (count, first, step), start, goal_time)| {
            let times: Box<[u64]> = (0..count).map(|place| first + place * step).collect();
            let tracks = axes.iter().zip(tracks).map(|(axis, (mut points, path, goal))| {
                points.truncate(count as usize);
                if let Some((_, velocity, _)) = points.last_mut() {
                    *velocity = velocity.map(|_| 0.0);
                }
                Track { path, goal, ..super::trajectory::track(axis, &points) }
            });
            let trajectory = Trajectory::new(start, times, tracks.collect(), goal_time);
            Action::Trajectory(Arc::new(trajectory.expect("a sound one")))
        },
    )
}

/// Homing by methods of all kinds, and new coordinates.
fn homing() -> impl Strategy<Value = Action> {
    let method = prop::sample::select(vec![
        HomingMethod::Configured,
        HomingMethod::Cia402(1),
        HomingMethod::Cia402(3),
        HomingMethod::Cia402(8),
        HomingMethod::Cia402(14),
        HomingMethod::Cia402(18),
        HomingMethod::Cia402(25),
        HomingMethod::Cia402(33),
        HomingMethod::Cia402(35),
        HomingMethod::Macs(0),
        HomingMethod::Macs(3),
    ]);
    let home = (axis(), method).prop_map(|(axis, method)| Action::HomeAxis(HomeAxis { axis, method }));
    let set = (axis(), -60_000_i64..60_000)
        .prop_map(|(axis, place)| Action::SetPosition(SetPosition { axis, position: Length::whole(place) }));
    let shift = (axis(), -60_000_i64..60_000)
        .prop_map(|(axis, way)| Action::ShiftPosition(ShiftPosition { axis, distance: Length::whole(way) }));
    let query =
        (axis(), any::<u64>()).prop_map(|(axis, at_ns)| Action::QueryTrajectory(QueryTrajectory { axis, at_ns }));
    prop_oneof![6 => home, 2 => set, 1 => shift, 1 => query]
}

fn random_note() -> impl Strategy<Value = Action> {
    let note = (prop::sample::select(&Code::NOTES[..]), any::<i64>());
    let refuse = Just(Action::Refuse("no axis is called `q`".into()));
    prop_oneof![note.prop_map(|(code, number)| Action::Note { code, number }), refuse]
}

fn ordering() -> impl Strategy<Value = RandomEvent> {
    let speeds = prop_oneof![1 => Just(0.0), 3 => -110_000.0..110_000.0_f64, 1 => Just(f64::NAN)];
    let limits = super::rig::parameters().default_goal_limits();
    let others = prop::sample::select(vec![
        Order::SwitchOn,
        Order::SwitchOff,
        Order::HoldActualPosition,
        Order::Stop { limits },
        Order::Velocity { velocity: 10.0, limits },
    ]);
    let order = prop_oneof![4 => speeds.prop_map(|velocity| Order::Speed { velocity }), 1 => others];
    (1_u16..3, order).prop_map(|(axis, order)| RandomEvent::Order(axis, order))
}

/// Checks the velocity commands of drives with velocity interface: never above the maximum of the axis, and 0 for an
/// axis that must not move.
fn check_velocity_commands(rig: &Rig, interfaces: [Interface; 2]) -> Result<(), TestCaseError> {
    for (name, interface) in ["x", "y"].into_iter().zip(interfaces) {
        let asked = rig.real(&format!("{name}.output.velocity"));
        let is_position = interface == Interface::Position;
        prop_assert!(is_position || asked.abs() <= 100_000.0, "{} is asked for {}", name, asked);
        let is_on = rig.int(&format!("{name}.enabled")) == 1;
        if interface == Interface::OpenLoop {
            let runs = is_on && rig.state(name) == "CONTINUOUS_MOTION";
            prop_assert_eq!(runs, asked != 0.0, "{} {} at {}", name, rig.state(name), asked);
            let position = |of: &str| rig.int(&format!("{name}.{of}.position"));
            prop_assert_eq!(position("command"), position("actual"));
            prop_assert_eq!(rig.int(&format!("{name}.following_error")), 0);
        } else if interface == Interface::Velocity {
            // The drive holds while its brake opens; the control word also shows this during homing in the drive.
            let enable = i64::from(control::ENABLE);
            let holds = rig.int(&format!("{name}.output.control")) & enable == enable;
            prop_assert!(holds || asked == 0.0, "{} is off and asked for {}", name, asked);
        }
    }
    Ok(())
}

fn random_event() -> impl Strategy<Value = RandomEvent> {
    let command = |strategy: BoxedStrategy<Action>| strategy.prop_map(RandomEvent::Command);
    prop_oneof![
        4 => command(positioning().boxed()),
        3 => command(running().boxed()),
        2 => command(setting().boxed()),
        1 => command(virtual_master().boxed()),
        2 => command(vocabulary().boxed()),
        2 => command(storing().boxed()),
        1 => (axis(), prop_oneof![Just(0.0), -110_000.0..110_000.0_f64, Just(f64::NAN)])
            .prop_map(|(axis, velocity)| RandomEvent::Stream(axis, velocity)),
        3 => command(coupling().boxed()),
        2 => command(phasing().boxed()),
        2 => command(leaving().boxed()),
        2 => command(opening().boxed()),
        1 => command(loading().boxed()),
        3 => command(following().boxed()),
        2 => command(probing().boxed()),
        2 => command(touch_probing().boxed()),
        2 => command(homing().boxed()),
        2 => (1_u16..3, any::<bool>(), 0_u32..1_000_000)
            .prop_map(|(source, rising, age)| RandomEvent::Latch(source, rising, age)),
        2 => command(axes().prop_map(Action::Enable).boxed()),
        1 => command(axes().prop_map(Action::Disable).boxed()),
        2 => command(axes().prop_map(Action::Halt).boxed()),
        1 => command(axes().prop_map(Action::QuickStop).boxed()),
        3 => command(axes().prop_map(Action::ResetErrors).boxed()),
        1 => command(prop::sample::select(vec![Action::Deactivate, Action::Activate, Action::Activate, Action::Abort]).boxed()),
        1 => command(random_note().boxed()),
        1 => command(output().boxed()),
        2 => (0_usize..3, prop::bool::weighted(0.7)).prop_map(|(input, on)| RandomEvent::Input(input, on)),
        2 => (0_usize..2, prop::sample::select(vec![1_u32, 2, 4]), any::<bool>())
            .prop_map(|(drive, mask, on)| RandomEvent::Switch(drive, mask, on)),
        2 => (0_usize..4).prop_map(RandomEvent::Cancel),
        3 => ordering(),
        8 => (0_u64..80).prop_map(RandomEvent::Cycles),
        1 => (0_usize..2).prop_map(RandomEvent::Fault),
        1 => Just(RandomEvent::Mirror),
        1 => (0_usize..2, -3000_i64..3000).prop_map(|(drive, by)| RandomEvent::Slip(drive, by)),
    ]
}

/// Returns the number of ends of an accepted command: one per named axis, or one.
fn ends(action: &Action) -> usize {
    match action {
        Action::Enable(axes)
        | Action::Disable(axes)
        | Action::Halt(axes)
        | Action::QuickStop(axes)
        | Action::ResetErrors(axes) => axes.len(),
        Action::Abort => 3,
        // A request of a vocabulary has no end of its own.
        Action::Vocabulary(_) | Action::OutAn(_) => 0,
        Action::AbortTrigger(_) | Action::QueryTrajectory(_) => 0,
        Action::SetPosition(_) | Action::ShiftPosition(_) => 0,
        Action::LoadTable { .. } | Action::LoadProgram { .. } => 0,
        Action::Note { .. } | Action::SetParameters(_) | Action::SetOutputs(_) => 0,
        Action::SaveParameters(_) | Action::ResetParameters { .. } => 0,
        Action::DeleteParameters(_) | Action::PowerCycle | Action::Activate => 0,
        _ => 1,
    }
}

/// Returns commanded position and velocity by name, of the axes that are switched on and not coupled; `None` in open
/// loop, where the command follows the drive.
fn motions(rig: &Rig) -> [Option<(f64, f64)>; 3] {
    AXES.map(|name| {
        let axis = rig.machine.config().axes.iter().find(|axis| axis.name == name)?;
        let places = ["command", "actual"].map(|of| rig.int(&format!("{name}.{of}.position")));
        // Also after out_an.
        let is_opened =
            axis.interface == Interface::Velocity && rig.state(name) == "CONTINUOUS_MOTION" && places[0] == places[1];
        if axis.interface == Interface::OpenLoop || is_opened {
            return None;
        }
        let free = rig.int(&format!("{name}.enabled")) == 1 && rig.state(name) != "SYNCHRONIZED_MOTION";
        // During homing in the drive the drive moves by itself.
        let free = free && rig.int(&format!("{name}.homing.phase")) != HomingPhase::InDrive as i64;
        let whole = rig.int(&format!("{name}.command.position")) as f64;
        let position = whole + rig.real(&format!("{name}.command.fraction"));
        free.then(|| (position, rig.real(&format!("{name}.command.velocity"))))
    })
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn every_command_is_answered_once_and_ends_once_and_no_free_axis_ever_jumps(
        reaction in 0_i64..6,
        delay in 0_u32..5,
        interfaces in [interface(), interface()],
        modulo in any::<bool>(),
        sense in (posdrct(), 0_i64..3),
        laws in [law(), law()],
        is_braked in any::<bool>(),
        start in prop_oneof![Just(0), Just(7), Just(1_005), Just(2_000)],
        has_two in any::<bool>(),
        happenings in prop::collection::vec((random_event(), any::<bool>()), 1..40),
    ) {
        let mut config = config(delay);
        terminals(&mut config, is_braked);
        config.tables = tables();
        config.axes[2].modulo = Modulo::new(36_001, 3).filter(|_| modulo);
        for axis in &mut config.axes {
            axis.parameters.error_reaction = reaction;
            axis.parameters.max_jerk = Some(2e7);
            axis.parameters.marks.start = start;
            (axis.parameters.sync.mark_distance, axis.parameters.marks.slave_distance) = (1_000, 2_000);
        }
        for (axis, (interface, law)) in config.axes[1..].iter_mut().zip(interfaces.into_iter().zip(laws)) {
            (axis.interface, axis.law) = (interface, law);
            axis.parameters.pid = PidGains { derivative: 20, integral: 1, period_ms: 1 + reaction, ..axis.parameters.pid };
            let digit = if interface == Interface::Position { 1 } else { sense.0.abs() };
            axis.parameters.macs.posdrct = sense.0.signum() * digit;
            axis.parameters.macs.revers = sense.1;
            if interface == Interface::Velocity {
                axis.parameters.max_following_error = 10_000;
            }
        }
        // Axes with a brake drive a screw.
        config.tables.push(screw());
        for axis in config.axes[1..].iter_mut().filter(|axis| is_braked && axis.interface != Interface::OpenLoop) {
            axis.parameters.compensation.backlash = 300;
            axis.pitch_error = Some(TABLES);
        }
        let models = interfaces.map(|interface| model(interface).wired(sense.0.abs() == 2));
        let x = &mut config.axes[1];
        if has_two && x.interface == Interface::Position {
            x.second = x.drive;
            x.parameters.gantry.max_skew = Some(2_000);
        }
        let drives = config.count_drives();
        let mut rig = Rig::with(config, models.into_iter().chain([models[0]]).take(drives));
        (0..drives).for_each(|drive| rig.plant.drive(drive).unwrap().install_fixtures(fixtures()));
        (0..2).for_each(|contact| rig.plant.set_digital(contact, true));
        rig.run(1);
        rig.give(Action::Enable(AxisSet::first(3)));
        rig.run(80);
        let (mut given, mut goals, mut waiting) = (Vec::new(), Vec::new(), Vec::new());
        let (mut before, mut stood, mut locks) = (motions(&rig), places(&rig), Locks::default());
        for (happening, together) in happenings {
            match happening {
                RandomEvent::Command(action) => waiting.push(action),
                RandomEvent::Cancel(back) => {
                    waiting.extend(goals.iter().rev().nth(back).map(|&goal| Action::Cancel { goal }));
                }
                RandomEvent::Fault(drive) => rig.plant.drive(drive).unwrap().inject_fault(0x8611),
                RandomEvent::Mirror => rig.mirror(),
                RandomEvent::Latch(source, rising, age) => {
                    let edge = if rising { Edge::Rising } else { Edge::Falling };
                    let object = Object::Axis(source);
                    rig.plant.add_latch(Latch { object, edge, age_ns: Some(age), position: None });
                }
                RandomEvent::Stream(axis, velocity) => {
                    rig.stream(axis, velocity);
                    locks.check(&rig)?;
                    check_limits(&rig, stood)?;
                    (before, stood) = (motions(&rig), places(&rig));
                }
                RandomEvent::Input(input, on) => rig.plant.set_digital(input, on),
                RandomEvent::Switch(drive, mask, on) => rig.plant.drive(drive).unwrap().set_stuck_inputs(mask, if on { mask } else { 0 }),
                RandomEvent::Slip(drive, by) => rig.plant.drive(drive).unwrap().jump(by),
                RandomEvent::Order(axis, order) => {
                    let open = interfaces[usize::from(axis) - 1] == Interface::OpenLoop;
                    // Axes with a closed loop must refuse the order.
                    if open || matches!(order, Order::Speed { .. }) {
                        let answer = rig.order(axis, order);
                        prop_assert!(open || answer.is_err());
                    }
                }
                RandomEvent::Cycles(count) => {
                    for _ in 0..count {
                        let told = rig.events.len();
                        rig.run(1);
                        locks.check(&rig)?;
                        check_velocity_commands(&rig, interfaces)?;
                        let now = motions(&rig);
                        // A new zero is not a motion.
                        let is_homed = rig.events[told..].iter().any(|event| event.kind == Kind::Homed);
                        if !is_homed {
                            check_limits(&rig, stood)?;
                        }
                        stood = places(&rig);
                        for (name, (now, before)) in AXES.iter().zip(now.iter().zip(&before)) {
                            let (Some(now), Some(before)) = (now, before) else { continue };
                            // 1e6 inc/s^2 in a cycle; a stop may end between two increments. An axis that followed
                            // single counts to a limit has its velocity with a resolution of one count per cycle.
                            let change = (now.1 - before.1).abs();
                            // On a trajectory the axis shows the velocity of the spline, otherwise the mean since the
                            // last cycle.
                            let tracks = rig.int(&format!("{name}.reference")) == 10;
                            let most = if tracks { 1_502.0 } else { 1_001.0 };
                            let most = if rig.state(name) == "ERROR_STOP" { 2_001.0 } else { most };
                            prop_assert!(change <= most, "{} changes its velocity by {}", name, change);
                            let way = (now.0 - before.0) - 0.5 * (now.1 + before.1) * 0.001;
                            prop_assert!(is_homed || way.abs() <= 1.6, "{} jumps by {}", name, way);
                        }
                        before = now;
                    }
                    continue;
                }
            }
            if together && waiting.len() < 30 {
                continue;
            }
            let first = given.len() as u64 + 2;
            for (number, action) in (first..).zip(&waiting) {
                use Action::{Move, Phase, Probe, Synchronize, Trajectory};
                if matches!(action, Move(_) | Probe(_) | Synchronize(_) | Phase(_) | Trajectory(_)) {
                    goals.push(number);
                }
                given.push((number, action.clone()));
            }
            // Like a controller that is switched off and on, it loses its former state.
            if waiting.contains(&Action::PowerCycle) {
                locks = Locks::after(&rig);
            }
            rig.give_all(std::mem::take(&mut waiting));
            locks.check(&rig)?;
            (before, stood) = (motions(&rig), places(&rig));
        }
        rig.run(3_000);
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(6_000);
        locks.check(&rig)?;
        for axis in 0..3 {
            rig.give(Action::AbortTrigger(AbortTrigger { axis, source: None }));
        }
        for (number, action) in &given {
            let of = |kind| rig.events.iter().filter(|event| event.command == *number && event.kind == kind).count();
            let (accepted, refused, told) = (of(Kind::Accepted), of(Kind::Refused), of(Kind::Warning));
            // SAIA may accept a verb and report the part that failed; a trajectory is accepted with a report of its
            // modifications.
            let is_more = matches!(action, Action::Vocabulary(vocabulary::Request::Saia(_)) | Action::Trajectory(_));
            let noted = if is_more { 0 } else { told };
            prop_assert_eq!(accepted + refused + noted, 1, "answers of {:?}", action);
            prop_assert_eq!(noted == 1, matches!(action, Action::Note { .. }), "a warning answers notes only");
            let expected = if refused == 1 { 0 } else { ends(action) };
            prop_assert_eq!(rig.done(*number).len(), expected, "ends of {:?}", action);
        }
        for name in AXES {
            let state = rig.state(name);
            prop_assert!(["STANDSTILL", "DISABLED", "ERROR_STOP", "STOPPING"].contains(&state), "{} {}", name, state);
            if state == "STANDSTILL" {
                prop_assert_eq!(rig.real(&format!("{name}.command.fraction")), 0.0, "{}", name);
            }
        }
    }
}

//! With any source of motion into a software limit, the first new attempt is error 98, and motion back is allowed.

use super::super::direction::set;
use super::super::rig::{LINE, Rig, X, at, cam, config, couple, scale};
use crate::code::Code;
use crate::command::{Action, CamIn, Engage, Phase, PhaseShift, PhaseSide, Synchronize};
use crate::config::{IoConfig, IoKind, TableConfig};
use crate::drive::{Edge, Latch};
use crate::event::Kind;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, MACHINE, Row, Value};
use crate::position::Length;
use crate::request::Amount;
use crate::sim::{Model, SecondOrder};
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, SyncMode};
use crate::table::{CamSetting, Form, Table};
use std::sync::Arc;

const HIGH: i64 = 4_000;
const LOW: i64 = -2_000;
const TO_LINE: Leader = Leader::AxisCommand(LINE);

/// Source of the motion of x.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MotionSource {
    Gear,
    Velocity,
    AtPosition,
    OnEvent,
    Cam,
    Marks,
    VirtualMaster,
    ShiftOfMaster,
    ShiftOfSlave,
}

const ALL: [MotionSource; 9] = [
    MotionSource::Gear,
    MotionSource::Velocity,
    MotionSource::AtPosition,
    MotionSource::OnEvent,
    MotionSource::Cam,
    MotionSource::Marks,
    MotionSource::VirtualMaster,
    MotionSource::ShiftOfMaster,
    MotionSource::ShiftOfSlave,
];

/// x has limits of -2 mm and 4 mm with 2 m/s^2; the line reaches its velocity at once.
fn rig(reaction: i64, model: Model) -> Rig {
    let mut config = config(0);
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    config.io = vec![input("product"), input("label")];
    // One increment for each increment of the master, out and back.
    let table = Table::new(Form::Xy, &[0, 8_000, 16_000], &[0, 8_000, 0]).expect("points");
    let table = Arc::new(table.with_cam(CamSetting::default()));
    config.tables = vec![TableConfig { name: "knife".into(), table }];
    config.axes[usize::from(LINE)].parameters.max_acceleration = 1e9;
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.min_position, p.max_position) = (Some(LOW), Some(HIGH));
    (p.max_acceleration, p.max_following_error, p.error_reaction) = (2e6, 50_000, reaction);
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    rig.enable();
    let given = set(&mut rig, &[("syncmtypm", 12), ("syncmtyps", 22), ("syncmpulsm", 1_000), ("syncmpulss", 1_000)]);
    assert!(rig.was_accepted(given));
    rig
}

fn machine(rig: &mut Rig, values: &[(&str, i64)]) {
    let change = |&(key, value): &(&str, i64)| {
        let row = Row::find(key).expect("a row").0;
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    let given = rig.give(Action::SetParameters(values.iter().map(change).collect()));
    assert!(rig.was_accepted(given));
}

/// Moves x, with `way` 1 up and -1 down, until it is stopped, or for 300 cycles.
fn lead(rig: &mut Rig, led: MotionSource, way: i64) {
    let gear = couple(X, TO_LINE, 1, 1);
    let runs = at(LINE, way as f64 * 20_000.0);
    let goal = match led {
        MotionSource::Gear | MotionSource::ShiftOfMaster | MotionSource::ShiftOfSlave => {
            Synchronize { offset: Length::default(), ..gear }
        }
        MotionSource::Velocity => Synchronize { mode: SyncMode::Velocity, ..gear },
        MotionSource::AtPosition => {
            let here = rig.int("line.command.position");
            let engage = Engage::AtPosition { position: here + way * 400, turn: None };
            Synchronize { mode: SyncMode::Velocity, engage, ..gear }
        }
        MotionSource::OnEvent => Synchronize { engage: Engage::OnEvent(Object::Io(0)), ..gear },
        MotionSource::Cam => {
            // Downwards in the part of the table with a negative slope.
            let mut cam = cam(0, CamStart::Relative);
            cam.master_offset = Length::whole(if way > 0 { 0 } else { 8_000 });
            Synchronize { cam: Some(cam), ..couple(X, TO_LINE, 0, 0) }
        }
        MotionSource::Marks => Synchronize { mode: SyncMode::Marker, ..gear },
        MotionSource::VirtualMaster => couple(X, Leader::Virtual, 1, 1),
    };
    let shift = PhaseShift { shift: Length::whole(way * 20_000), velocity: 20_000.0, acceleration: 1e6 };
    match led {
        MotionSource::ShiftOfMaster | MotionSource::ShiftOfSlave => {
            rig.give(Action::Move(at(LINE, 0.0)));
            rig.run(2);
            rig.give(Action::Synchronize(goal));
            let side = match led {
                MotionSource::ShiftOfSlave => PhaseSide::Slave(shift),
                _ => PhaseSide::Master { given: [Amount::default(); 3], by_scale: [(scale(), shift)].into() },
            };
            rig.give(Action::Phase(Phase { axis: X, side }));
        }
        MotionSource::VirtualMaster => {
            machine(rig, &[("pulsvel", way * 20_000), ("pulsacc", 10_000_000)]);
            rig.give(Action::Synchronize(goal));
        }
        MotionSource::Cam => {
            rig.give(Action::Move(at(LINE, 20_000.0)));
            rig.run(3);
            rig.give(Action::Synchronize(goal));
        }
        _ => {
            rig.give(Action::Move(runs));
            rig.run(3);
            rig.give(Action::Synchronize(goal));
        }
    }
    if led == MotionSource::OnEvent {
        rig.run(5);
        let latch = Latch { object: Object::Io(0), edge: Edge::Rising, age_ns: Some(300_000), position: None };
        assert!(rig.plant.add_latch(latch));
    }
    for _ in 0..600 {
        if rig.state("x") == "ERROR_STOP" {
            break;
        }
        rig.run(1);
    }
}

fn errors(rig: &Rig) -> Vec<Code> {
    let found = rig.events.iter().filter(|event| event.kind == Kind::Error);
    found.map(|event| event.code).collect()
}

/// Waits until the axis is at rest, and resets it.
fn reset(rig: &mut Rig) {
    rig.run_until("x.state", 7);
    rig.run(20);
    for _ in 0..3_000 {
        if rig.real("x.command.velocity") == 0.0 && rig.int("x.output.control") != 1 {
            break;
        }
        rig.run(1);
    }
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(3_000);
    assert_eq!(rig.int("x.error"), 0);
    if rig.state("x") == "DISABLED" {
        rig.enable();
    }
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// For any source of motion and on either side: motion back is not an error, and a new motion into the limit after that
/// is a first error again.
///
/// Proves: MACS-LIM-05
#[test]
fn repeated_motion_into_limit_is_error_98() {
    for led in ALL {
        for way in [1, -1] {
            let mut rig = rig(2, Model::Ideal);
            let first = if way > 0 { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE };
            lead(&mut rig, led, way);
            assert_eq!(errors(&rig), [first], "{led:?} {way}");
            reset(&mut rig);
            lead(&mut rig, led, way);
            assert_eq!(errors(&rig), [first, Code::LIMIT_VIOLATION], "{led:?} {way}, again");
            let limit = if way > 0 { HIGH } else { LOW };
            assert!(rig.int("x.command.position").abs() <= limit.abs(), "{led:?} {way}");
            reset(&mut rig);
            // Error 98 is cleared like the first error, and motion back is no error up to the other limit.
            lead(&mut rig, led, -way);
            assert_eq!(errors(&rig).len(), 3, "{led:?} {way}, back");
            assert_ne!(errors(&rig)[2], first);
            assert_ne!(errors(&rig)[2], Code::LIMIT_VIOLATION, "{led:?} {way}, back");
        }
    }
}

/// The power was removed before the drive reached the position at which its command had stopped.
///
/// Proves: MACS-LIM-05
#[test]
fn a_drive_that_is_behind_when_its_power_goes_has_not_left_the_limit() {
    for led in ALL {
        for (way, reaction) in [(1, 0), (-1, 0), (1, 3), (1, 4)] {
            let lagging = Model::SecondOrder(SecondOrder::new(5.0, 1.0, 1_000_000).expect("a drive"));
            let mut rig = rig(reaction, lagging);
            let first = if way > 0 { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE };
            lead(&mut rig, led, way);
            assert_eq!(errors(&rig), [first], "{led:?} {way}");
            reset(&mut rig);
            // Under power the drive reaches its command.
            let short = (rig.int("x.command.position") - if way > 0 { HIGH } else { LOW }) * way;
            assert!((-4_000..-2).contains(&short) || reaction == 3 && short == 0, "{led:?} {way} {reaction}: {short}");
            lead(&mut rig, led, way);
            assert_eq!(errors(&rig), [first, Code::LIMIT_VIOLATION], "{led:?} {way}, again");
        }
    }
}

/// A cam with 14.6 increments per count of its leader, which is at rest: the catch-up distance is not treated as count
/// noise, so the stop at the limit starts in time.
/// Proves: MACS-LIM-01
#[test]
fn catch_up_with_leader_at_rest_is_not_treated_as_count_noise() {
    let table = Table::new(Form::Xy, &[0, 1000, 1600, 4000], &[0, 300, 1700, 2500]).expect("points");
    let mut config = config(0);
    config.tables = vec![TableConfig { name: "steep".into(), table: Arc::new(table) }];
    config.axes.iter_mut().for_each(|axis| axis.parameters.error_reaction = 0);
    config.axes[usize::from(LINE)].parameters.min_position = Some(-122);
    let mut rig = Rig::of(config);
    rig.enable();
    let scale = Ratio::new(5, 2).expect("a ratio");
    let (master_offset, slave_offset) = (Length::whole(1_000), Length::whole(-191));
    let scales = CamIn { master_scale: scale, slave_scale: scale, ..cam(0, CamStart::Relative) };
    let cam = Some(CamIn { master_offset, slave_offset, ..scales });
    rig.give(Action::Synchronize(Synchronize { cam, ..couple(LINE, Leader::AxisActual(X), 0, 1) }));
    let mut before = 0.0;
    for _ in 0..60 {
        rig.run(1);
        let velocity = rig.real("line.command.velocity");
        // A stop at a limit may take twice the acceleration.
        assert!((velocity - before).abs() <= 2_001.0, "from {before} to {velocity}");
        before = velocity;
    }
    assert_eq!((rig.state("line"), before), ("ERROR_STOP", 0.0));
    assert!((-122..0).contains(&rig.int("line.command.position")));
}

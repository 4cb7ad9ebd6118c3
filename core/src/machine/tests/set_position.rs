//! set_position of an axis in motion: another coordinate, the same motion, and states that block a new coordinate.

use super::feedback::moving_zero;
use super::rig::{LINE, Rig, X, Y, at, cam, cases, config, couple, to};
use crate::code::Code;
use crate::command::{
    AbortTrigger, Action, BufferMode, DisengageAt, Engage, GearOut, Level, Move, MoveMode, OutAn, Phase, PhaseShift,
    PhaseSide, Probe, ProbeEdge, SetPosition, ShiftPosition, Synchronize, TouchProbe,
};
use crate::config::{IoConfig, IoKind, MachineConfig, TableConfig};
use crate::drive::{Edge, Interface, Latch};
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::Value;
use crate::position::{Length, Position};
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::table::{Form, Table};
use crate::trajectory::{Knot, Track, Trajectory};
use proptest::prelude::*;
use std::sync::Arc;

const TO_LINE: Leader = Leader::AxisCommand(LINE);
const MARK: Object = Object::Io(0);

fn set(axis: u16, position: i64) -> Action {
    Action::SetPosition(SetPosition { axis, position: Length::whole(position) })
}

fn shift(axis: u16, distance: i64) -> Action {
    Action::ShiftPosition(ShiftPosition { axis, distance: Length::whole(distance) })
}

fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

#[track_caller]
fn give(rig: &mut Rig, action: Action) -> u64 {
    let sequence = rig.give(action);
    assert!(rig.was_accepted(sequence));
    sequence
}

/// Returns a rig with x at constant 50 mm/s after 1 m/s^2: 50 inc in each cycle, on whole increments.
fn running() -> Rig {
    let mut rig = Rig::enabled();
    give(&mut rig, Action::Move(Move { acceleration: 1e6, ..at(X, 50_000.0) }));
    rig.run(100);
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.fraction")), (3_750, 0.0));
    rig
}

#[test]
fn an_axis_at_a_velocity_has_its_new_position_in_that_cycle_and_goes_on() {
    let mut rig = running();
    give(&mut rig, set(X, -7));
    // The actual position is one cycle behind, as before.
    let shown = |rig: &Rig| (rig.int("x.command.position"), rig.int("x.actual.position"), rig.int("x.following_error"));
    assert_eq!(shown(&rig), (-7, -57, 0));
    rig.run(1);
    assert_eq!(shown(&rig), (43, -7, 0));
    assert_eq!((rig.real("x.command.velocity"), rig.state("x")), (50_000.0, "CONTINUOUS_MOTION"));
    give(&mut rig, shift(X, 1_000));
    assert_eq!(shown(&rig), (1_093, 1_043, 0));
    give(&mut rig, shift(X, -1_000));
    assert_eq!(shown(&rig), (143, 93, 0));
    // The setpoint of the drive is not affected: 50 inc per cycle since 3750.
    assert_eq!(rig.int("x.output.position"), 3_950);
    give(&mut rig, Action::Move(to(X, 0)));
    rig.run_until("x.state", 1);
    // The count there: position -7 was count 3800.
    assert_eq!((rig.int("x.command.position"), rig.int("x.output.position")), (0, 3_807));
}

#[test]
fn a_velocity_that_the_override_holds_goes_on_from_there() {
    let mut rig = Rig::enabled();
    rig.set("velocity_override", Value::Real(0.0));
    let goal = give(&mut rig, Action::Move(at(X, 10_000.0)));
    rig.run(5);
    assert_eq!(rig.state("x"), "CONTINUOUS_MOTION");
    give(&mut rig, set(X, 700));
    rig.run(5);
    assert_eq!(rig.int("x.command.position"), 700);
    rig.set("velocity_override", Value::Real(100.0));
    rig.run(100);
    // At 0.5 m/s^2 it takes 20 ms and 100 inc to reach 10 inc per cycle.
    assert_eq!((rig.int("x.command.position"), rig.done(goal).len()), (700 - 100 + 10 * 100, 0));
}

/// The machine positions of the limits are retained: x stops where it would have stopped.
#[test]
fn software_limits_keep_their_places() {
    for by in [-40_000, 40_000] {
        let [mut moved, mut plain] = [running(), running()];
        for rig in [&mut moved, &mut plain] {
            rig.set("max_position", Value::Int(20_000));
        }
        give(&mut moved, shift(X, by));
        plain.run(1);
        for cycle in 0..600 {
            assert_eq!(place(&moved, X) - place(&plain, X), Position::whole(by), "in cycle {cycle}");
            assert_eq!(moved.state("x"), plain.state("x"));
            moved.run(1);
            plain.run(1);
        }
        assert_eq!((plain.int("x.command.position"), plain.state("x")), (20_000, "ERROR_STOP"));
        assert_eq!(moved.machine.parameters(X).unwrap().max_position, Some(20_000 + by));
    }
}

#[test]
fn turns_are_those_of_the_new_coordinate() {
    let mut cell = config(0);
    cell.axes[usize::from(X)].modulo = Modulo::new(1_000, 1);
    let mut rig = Rig::of(cell);
    rig.enable();
    give(&mut rig, Action::Move(Move { acceleration: 1e6, ..at(X, 50_000.0) }));
    rig.run(100);
    let shown = |rig: &Rig| (rig.int("x.turns"), rig.int("x.modulo.position"));
    assert_eq!(shown(&rig), (3, 750));
    give(&mut rig, set(X, -100));
    assert_eq!(shown(&rig), (-1, 900));
    rig.run(3);
    assert_eq!(shown(&rig), (0, 50));
    give(&mut rig, Action::Move(to(X, 200)));
    rig.run_until("x.state", 1);
    assert_eq!(shown(&rig).1, 200);
}

/// A latch in the cycle after a new position is recorded in the new coordinate.
#[test]
fn latches_are_recorded_in_the_coordinate_of_their_cycle() {
    let input = IoConfig { name: "mark".into(), kind: IoKind::DigitalInput, latch: true };
    let mut rig = Rig::of(MachineConfig { io: vec![input], ..config(0) });
    rig.enable();
    give(&mut rig, Action::Move(Move { acceleration: 1e6, ..at(X, 50_000.0) }));
    rig.run(100);
    let probe = TouchProbe { axis: X, source: MARK, edge: ProbeEdge::Rising, continuous: true, window: None };
    let probe = give(&mut rig, Action::TouchProbe(probe));
    let latch = Latch { object: MARK, edge: Edge::Rising, age_ns: Some(500_000), position: None };
    assert!(rig.plant.add_latch(latch));
    give(&mut rig, set(X, 0));
    assert!(rig.plant.add_latch(latch));
    rig.run(1);
    let records = rig.events.iter().filter(|event| event.command == probe && event.kind == crate::event::Kind::Latch);
    let places: Vec<f64> = records.map(|event| event.position.to_f64()).collect();
    // The actual position is 3800 before the command of its cycle, then 0 in the next cycle.
    assert_eq!(places, [3_775.0, -25.0]);
}

/// For a follower of x the shown master position continues, and so it does for a follower of a sum that includes x.
#[test]
fn shown_master_positions_continue() {
    let mut rig = Rig::enabled();
    give(&mut rig, Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 2)));
    give(&mut rig, Action::Move(Move { acceleration: 1e6, ..at(X, 50_000.0) }));
    rig.run(100);
    let before = (rig.real("y.master.position"), rig.int("y.command.position"));
    give(&mut rig, set(X, 1_000_000));
    rig.run(1);
    let after = (rig.real("y.master.position"), rig.int("y.command.position"));
    assert_eq!((after.0 - before.0, after.1 - before.1, rig.int("y.sync.error")), (100.0, 50, 0));
    assert_eq!(rig.int("y.sync.master"), 1_000_050);
}

#[test]
fn an_axis_without_position_loop_goes_on_at_its_value() {
    let mut cell = config(0);
    cell.axes[usize::from(X)].interface = Interface::Velocity;
    cell.axes[usize::from(X)].parameters.max_following_error = 1 << 40;
    let mut rig = Rig::of(cell);
    rig.enable();
    give(&mut rig, Action::OutAn(OutAn { axis: X, value: 0.2, level: Level::Setpoint }));
    rig.run(50);
    let count = rig.int("x.actual.count");
    give(&mut rig, set(X, 0));
    rig.run(10);
    // 20 mm/s are 20 inc per cycle.
    assert_eq!((rig.int("x.actual.count") - count, rig.state("x")), (220, "CONTINUOUS_MOTION"));
    assert_eq!(rig.int("x.actual.position"), 200);
}

/// Both users of the belt encoder keep their places, in the new coordinate, and the moving one continues.
#[test]
fn a_shared_encoder_moves_with_the_zero_of_the_axis_that_moves_it() {
    let (mut rig, velocity) = moving_zero();
    let before = rig.int("x.actual.position") - rig.int("y.actual.position");
    let belt = rig.int("belt.position") - rig.int("x.actual.position");
    give(&mut rig, shift(X, 12_345));
    rig.run(1);
    assert_eq!(rig.int("x.actual.position") - rig.int("y.actual.position"), before);
    assert_eq!(rig.int("belt.position") - rig.int("x.actual.position"), belt);
    rig.run(100);
    assert_eq!((rig.real("x.command.velocity"), rig.int("x.error")), (velocity, 0));
}

fn knot(position: i64) -> Knot {
    Knot { position: Position::whole(position), velocity: Some(0.0), acceleration: None }
}

fn trajectory() -> Action {
    let track = Track { axis: X, knots: [knot(10_000)].into(), ..Track::default() };
    let times = [400_000_000].into();
    Action::Trajectory(Arc::new(Trajectory::new(0, times, [track].into(), None).expect("a sound one")))
}

fn pair(distance: i64) -> Synchronize {
    let engage = Engage::InPosition { position: 20_000, turn: None, slave: 20_000, distance };
    Synchronize { engage, velocity: 100_000.0, acceleration: 1e6, ..couple(X, TO_LINE, 1, 1) }
}

/// Returns a machine with everything that may refer to the coordinate of x: an input that latches, a cam.
fn cell() -> MachineConfig {
    let input = IoConfig { name: "mark".into(), kind: IoKind::DigitalInput, latch: true };
    let knife = Table::new(Form::Xy, &[0, 10_000, 20_000], &[0, 5_000, 0]).expect("points");
    let tables = vec![TableConfig { name: "knife".into(), table: Arc::new(knife) }];
    let mut cell = MachineConfig { io: vec![input], tables, ..config(0) };
    cell.axes[usize::from(X)].parameters.sync_accuracy = 10;
    cell
}

/// Each case with the previous command, its duration, and the text of the refusal.
#[test]
fn state_that_refers_to_coordinate_is_named_in_refusal() {
    let velocity =
        || Action::Move(Move { velocity: 20_000.0, acceleration: 2e5, deceleration: 2e5, ..at(X, 20_000.0) });
    let line = || Action::Move(Move { acceleration: 2e5, ..at(LINE, 20_000.0) });
    let gear = |mode| Action::Synchronize(Synchronize { mode, ..couple(X, TO_LINE, 1, 1) });
    let buffered = Move { buffer_mode: BufferMode::Buffered, ..to(X, 90_000) };
    let over = Move { mode: MoveMode::Superimposed, velocity: 1_000.0, ..to(X, 5_000) };
    let slave = PhaseSide::Slave(PhaseShift { shift: Length::whole(5_000), velocity: 1_000.0, acceleration: 1e4 });
    let probe = Probe {
        axis: X,
        relative: false,
        target: Length::whole(90_000),
        velocity: 0.0,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        source: MARK,
        edge: ProbeEdge::Rising,
        distance: Length::whole(1_000),
    };
    let window = Some([0, 10].map(Length::whole));
    let watched = TouchProbe { axis: X, source: MARK, edge: ProbeEdge::Rising, continuous: true, window };
    let cam = |start| Action::Synchronize(Synchronize { cam: Some(cam(0, start)), ..couple(X, TO_LINE, 0, 0) });
    let leave = |at| Action::GearOut(GearOut { axis: X, at, disengage: Some(Disengage::Stop) });
    let waits = Engage::AtPosition { position: 1_000_000, turn: None };
    let waits = Synchronize { mode: SyncMode::Velocity, engage: waits, ..couple(X, TO_LINE, 1, 1) };
    let cases: Vec<(Vec<Action>, u64, &str)> = vec![
        (vec![Action::Move(to(X, 90_000))], 20, "a goal to a target"),
        (vec![Action::Probe(probe)], 20, "a goal to a target"),
        (vec![velocity(), Action::Move(buffered)], 20, "a goal that waits"),
        (vec![velocity(), Action::Move(over)], 200, "a superimposed motion or phase shift"),
        (vec![trajectory()], 20, "a trajectory"),
        (
            vec![line(), gear(SyncMode::Position), Action::Phase(Phase { axis: X, side: slave })],
            300,
            "a superimposed motion or phase shift",
        ),
        (vec![line(), velocity(), Action::Synchronize(waits)], 300, "a coupling that waits to engage"),
        (
            vec![line(), gear(SyncMode::Velocity), leave(DisengageAt::Axis(1 << 40))],
            300,
            "a gear_out that waits for a place of the axis",
        ),
        (vec![line(), cam(CamStart::Relative)], 300, "a cam"),
        (vec![line(), cam(CamStart::RampIn)], 300, "a cam"),
        (vec![line(), Action::Synchronize(pair(0))], 2_000, "a coupling at a pair of places"),
        (vec![line(), Action::TouchProbe(watched)], 20, "a touch probe with a window"),
        (vec![velocity(), Action::TouchProbe(watched)], 20, "a touch probe with a window"),
    ];
    for (actions, cycles, what) in cases {
        let mut rig = Rig::of(cell());
        rig.enable();
        for action in &actions {
            give(&mut rig, action.clone());
            rig.run(2);
        }
        rig.run(cycles);
        rig.mirror();
        let before = (rig.int("x.command.position"), rig.real("x.command.velocity"));
        for action in [set(X, 0), shift(X, 100)] {
            let refused = rig.give(action);
            let sentence =
                format!("x: {what} refers to the present coordinate of the axis; wait for its end, or end it first");
            assert_eq!(rig.refusal(refused), sentence, "{actions:?}");
        }
        let way = (rig.int("x.command.position") - before.0) as f64;
        assert!(way.abs() <= 2.1 * before.1.abs().max(1_000.0) / 1_000.0, "{what}: {way}");
    }
}

/// A stop, homing and the transition to it end by themselves: they are reported as the present state of the axis.
#[test]
fn refusal_reports_state_of_stopping_axis() {
    let mut rig = running();
    give(&mut rig, Action::Halt(AxisSet::one(X)));
    let refused = rig.give(set(X, 0));
    assert_eq!(rig.refusal(refused), "x: the axis moves (DISCRETE_MOTION); wait for its end, or halt it first");
    let mut rig = running();
    give(&mut rig, Action::QuickStop(AxisSet::one(X)));
    let refused = rig.give(shift(X, 1));
    assert_eq!(rig.refusal(refused), "x: the axis is not at rest; wait until it stands");
}

#[test]
fn what_is_aborted_keeps_the_coordinate_no_more() {
    let mut rig = Rig::of(cell());
    rig.enable();
    let window = Some([0, 10].map(Length::whole));
    let watched = TouchProbe { axis: X, source: MARK, edge: ProbeEdge::Rising, continuous: true, window };
    give(&mut rig, Action::TouchProbe(watched));
    let refused = rig.give(set(X, 0));
    assert_eq!(rig.answer(refused).unwrap_err().code, Code::COORDINATE_IN_USE, "also of an axis that stands");
    give(&mut rig, Action::AbortTrigger(AbortTrigger { axis: X, source: None }));
    give(&mut rig, set(X, 0));
}

#[test]
fn no_position_leaves_its_range() {
    let mut rig = running();
    let most = (1_i64 << 62) - 1;
    for action in [set(X, most + 1), shift(X, most), shift(X, i64::MIN)] {
        let refused = rig.give(action);
        assert_eq!(rig.answer(refused).unwrap_err().code, Code::POSITION_OUT_OF_RANGE);
    }
    rig.set("max_position", Value::Int(most));
    let refused = rig.give(shift(X, 1));
    assert_eq!(rig.answer(refused).unwrap_err().code, Code::POSITION_OUT_OF_RANGE, "the limit would");
    assert_eq!(rig.real("x.command.velocity"), 50_000.0);
}

/// Source of the motion of x that continues in another coordinate.
#[derive(Clone, Copy, Debug)]
enum MotionSource {
    Velocity,
    Stream,
    Gear(SyncMode),
}

proptest! {
    #![proptest_config(cases(60))]

    /// With any source of motion, at any time: the motion is the same bit for bit except for the coordinate, for the
    /// axis and for all of its followers.
    #[test]
    fn another_coordinate_is_no_motion(
        way in prop::sample::select(vec![
            MotionSource::Velocity, MotionSource::Stream, MotionSource::Gear(SyncMode::Velocity), MotionSource::Gear(SyncMode::Position),
        ]),
        profile in 0_i64..3, delay in 0_u32..3, velocity in -90_000.0..90_000.0_f64,
        moments in prop::collection::vec((1_u64..200, any::<bool>(), -1_000_000_i64..1_000_000), 1..4),
        is_closed_here in any::<bool>(),
    ) {
        let mut cell = config(delay);
        for axis in &mut cell.axes {
            axis.parameters.profile = profile;
            axis.parameters.max_jerk = Some(2e7);
            axis.parameters.max_following_error = 1 << 40;
        }
        if is_closed_here {
            cell.axes[usize::from(X)].interface = Interface::Velocity;
        }
        let mut rigs = [Rig::of(cell.clone()), Rig::of(cell)];
        let step = |rigs: &mut [Rig; 2], action: Option<Action>| {
            let [moved, plain] = rigs;
            match (&way, action) {
                (_, Some(action)) => {
                    moved.give(action);
                    plain.run(1);
                }
                (MotionSource::Stream, None) => [moved, plain].into_iter().for_each(|rig| rig.stream(X, velocity)),
                _ => [moved, plain].into_iter().for_each(|rig| rig.run(1)),
            }
        };
        for rig in &mut rigs {
            rig.enable();
            rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 3, 7)));
            let leads = if matches!(way, MotionSource::Gear(_)) { LINE } else { X };
            if !matches!(way, MotionSource::Stream) {
                rig.give(Action::Move(Move { jerk: 1e7, ..at(leads, velocity) }));
            }
            if let MotionSource::Gear(mode) = way {
                rig.give(Action::Synchronize(Synchronize { mode, ..couple(X, TO_LINE, 355, 1_130) }));
            }
        }
        let mut by = 0;
        for (wait, is_relative, number) in moments {
            for _ in 0..wait {
                step(&mut rigs, None);
            }
            let before = place(&rigs[1], X);
            let action = if is_relative { shift(X, number) } else { set(X, number) };
            step(&mut rigs, Some(action));
            let now = place(&rigs[1], X);
            by = if is_relative { by + number } else { number - now.nearest() };
            prop_assert!(rigs[0].events.iter().all(|event| event.kind != crate::event::Kind::Refused), "{:?}", before);
            prop_assert_eq!(place(&rigs[0], X) - now, Position::whole(by));
            for _ in 0..60 {
                step(&mut rigs, None);
                let [moved, plain] = &rigs;
                prop_assert_eq!(place(moved, X) - place(plain, X), Position::whole(by));
                prop_assert_eq!(place(moved, Y), place(plain, Y));
                for name in ["x.output.position", "x.following_error", "x.actual.count", "x.state", "y.state", "x.error",
                    "x.in_velocity", "x.sync.error", "y.sync.error", "y.sync.status", "x.sync.status"] {
                    prop_assert_eq!(moved.int(name), plain.int(name), "{}", name);
                }
                for name in ["x.command.velocity", "x.command.acceleration", "x.actual.velocity", "x.output.velocity",
                    "y.command.velocity", "x.master.position", "y.master.position", "x.command.fraction"] {
                    prop_assert_eq!(moved.real(name).to_bits(), plain.real(name).to_bits(), "{}", name);
                }
                prop_assert_eq!(moved.int("x.actual.position") - plain.int("x.actual.position"), by);
            }
        }
        // The virtual line, too, whose new coordinate its followers do not see.
        if let MotionSource::Gear(_) = way {
            step(&mut rigs, Some(set(LINE, 77)));
            for _ in 0..20 {
                step(&mut rigs, None);
                let [moved, plain] = &rigs;
                prop_assert_eq!(place(moved, X) - place(plain, X), Position::whole(by));
                prop_assert_eq!(moved.real("x.master.position"), plain.real("x.master.position"));
            }
        }
    }
}

/// A position of the axis that a coupling waits for refers to the previous coordinate, also while the axis is at rest.
#[test]
fn a_pair_that_is_waited_for_keeps_the_coordinate_at_rest() {
    let mut rig = Rig::enabled();
    let engage = Engage::InPosition { position: 20_000, turn: None, slave: 20_000, distance: 0 };
    give(&mut rig, Action::Synchronize(Synchronize { engage, ..couple(X, TO_LINE, 1, 1) }));
    for action in [set(X, 0), shift(X, 5)] {
        let refused = rig.give(action);
        let sentence = "x: a coupling that waits to engage refers to the present coordinate of the axis; wait for its end, or end it first";
        assert_eq!(rig.refusal(refused), sentence);
    }
    assert_eq!(rig.int("x.command.position"), 0);
}

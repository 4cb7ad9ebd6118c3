//! Zeros and errors together with followers, trajectories, users of one encoder, and a first error that stops nothing.

use super::rig::{LINE, Rig, X, Y, config, couple, to};
use super::trajectory::track;
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, SetPosition};
use crate::config::MachineConfig;
use crate::drive::Interface;
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::sim::{Fixtures, Index};
use crate::trajectory::Trajectory;
use std::sync::Arc;

fn zero(axis: u16, position: i64) -> Action {
    Action::SetPosition(SetPosition { axis, position: Length::whole(position) })
}

fn set(axis: u16, key: &str, value: Value) -> Action {
    let (row, _) = Row::find(key).unwrap();
    Action::SetParameters([Change { axis, row, value }].into())
}

fn trajectory(axis: u16) -> Action {
    let times = vec![500_000_000].into();
    let trajectory = Trajectory::new(0, times, vec![track(axis, &[(1_000, None, None)])].into(), None);
    Action::Trajectory(Arc::new(trajectory.unwrap()))
}

/// x and y read the encoder of the belt, which x moves.
fn shared() -> MachineConfig {
    let mut config = config(0);
    for axis in &mut config.axes[1..] {
        axis.interface = Interface::Velocity;
        axis.wired = Wired::Encoder(0);
        axis.parameters.max_following_error = 1 << 40;
    }
    config
}

/// A zero of the leader in one cycle with a trajectory of another axis: followers see no motion, whether it is before
/// or after it, and ROS gets the new limits.
#[test]
fn a_zero_beside_a_trajectory_moves_no_follower() {
    for first in [true, false] {
        let mut rig = Rig::enabled();
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        rig.give(set(LINE, "max_position", Value::Int(9_000)));
        rig.run(20);
        let version = rig.machine.parameter_version();
        let actions =
            if first { vec![zero(LINE, 5_000), trajectory(Y)] } else { vec![trajectory(Y), zero(LINE, 5_000)] };
        rig.give_all(actions);
        rig.run(50);
        assert_eq!((rig.int("line.command.position"), rig.int("x.error")), (5_000, 0), "{first}");
        assert_eq!(rig.int("x.command.position"), 0, "{first}");
        assert_eq!(rig.machine.parameters(LINE).unwrap().max_position, Some(14_000));
        assert_ne!(rig.machine.parameter_version(), version, "{first}");
    }
}

/// A hard zero shifts the coordinate of the other users: their limits keep their machine positions, as those of the
/// axis itself do.
///
/// Proves: MACS-LIM-01
#[test]
fn a_hard_zero_keeps_the_limits_of_all_users_where_they_are() {
    let mut config = shared();
    for axis in &mut config.axes[1..] {
        axis.parameters.max_position = Some(1_000);
    }
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(zero(X, 500));
    rig.run(2);
    assert_eq!(rig.int("y.actual.position"), 500);
    for axis in [X, Y] {
        assert_eq!(rig.machine.parameters(axis).unwrap().max_position, Some(1_500), "{axis}");
        let told = |event: &&crate::event::Event| {
            event.kind == Kind::Parameter && event.source == crate::object::Object::Axis(axis)
        };
        assert_eq!(rig.events.iter().filter(told).count(), 1, "{axis}");
    }
}

/// The reference selector of another user refers to previous positions: it releases the axis, as it does for a zero of
/// its own.
#[test]
fn a_hard_zero_takes_the_other_users_from_their_selectors() {
    let mut rig = Rig::of(shared());
    rig.enable();
    rig.give(set(Y, "amc.position_reference", Value::Int(100)));
    rig.give(set(Y, "amc.reference_select", Value::Int(1)));
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(500);
    assert_eq!(rig.int("y.command.position"), 100);
    let before = rig.int("y.actual.position");
    rig.give(zero(X, 5_000));
    rig.run(2);
    let moved = rig.int("y.actual.position") - before;
    assert_ne!(moved, 0);
    assert_eq!((rig.int("y.amc.select"), rig.int("y.command.position")), (0, 100 + moved));
    rig.give(set(Y, "amc.position_reference", Value::Int(110)));
    rig.run(200);
    assert_eq!(rig.int("y.command.position"), 100 + moved);
}

/// With error_reaction 5 a following error stops nothing; a jump stops the axis although that error is active.
#[test]
fn a_jump_stops_an_axis_whose_first_error_did_not() {
    let mut config = config(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    p.error_reaction = 5;
    p.max_following_error = 1_000;
    p.encoder.max_jump = Some(5_000);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.plant.drive(0).unwrap().jump(3_000);
    rig.run(3);
    assert_eq!((rig.int("x.error"), rig.state("x")), (i64::from(Code::FOLLOWING_ERROR.0), "STANDSTILL"));
    rig.run(500);
    rig.plant.drive(0).unwrap().jump(6_000);
    rig.run(1);
    assert_eq!(rig.state("x"), "ERROR_STOP");
    assert_eq!(
        rig.events.iter().filter(|event| event.code == Code::ENCODER_JUMP && event.kind == Kind::Error).count(),
        1
    );
}

/// The number of pulses between two marks is unchanged if the coordinate is set between them.
#[test]
fn a_new_zero_between_two_marks_is_no_missing_pulse() {
    let mut config = config(0);
    config.axes[1].interface = Interface::Velocity;
    let p = &mut config.axes[1].parameters;
    (p.encoder.monitored, p.encoder.pulses_or_step, p.max_velocity) = (1, 250, 20_000.0);
    p.max_following_error = 20_000;
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 1_000, at: 100 }), ..Fixtures::default() });
    rig.enable();
    rig.give(Action::Move(to(X, 5_500)));
    rig.run(2_000);
    assert!(rig.int("x.index.count") > 2);
    rig.give(zero(X, 77));
    rig.give(Action::Move(to(X, 4_000)));
    rig.run(2_000);
    assert_eq!((rig.int("x.command.position"), rig.int("x.error")), (4_000, 0));
}

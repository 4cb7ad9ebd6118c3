//! Setpoint of an axis from its trajectory at a requested time.

use super::rig::{LINE, Rig, X, Y, at, config};
use super::trajectory::{Point, track};
use crate::code::Code;
use crate::command::{Action, QueryTrajectory};
use crate::event::{Event, Kind, Number};
use crate::modulo::Modulo;
use crate::object::AxisSet;
use crate::trajectory::{Track, Trajectory, TrajectoryLimits};
use std::sync::Arc;

const MS: u64 = 1_000_000;

fn rest(position: i64) -> Point {
    (position, Some(0.0), None)
}

fn later(start_ms: i64, time_ms: u64, track: Track) -> Action {
    let trajectory = Trajectory::new(start_ms * MS as i64, [time_ms * MS].into(), [track].into(), None);
    Action::Trajectory(Arc::new(trajectory.expect("a sound one")))
}

/// Returns the number of the last cycle.
fn cycle(rig: &Rig) -> u64 {
    rig.machine.state().cycle - 1
}

/// Returns the answer for a time since a cycle (ms): position, velocity, acceleration, and whether it comes from a
/// trajectory.
fn ask(rig: &mut Rig, axis: u16, (since, ms): (u64, f64)) -> Result<([f64; 3], bool), String> {
    let at_ns = (since * MS).saturating_add_signed((ms * MS as f64) as i64);
    let query = rig.give(Action::QueryTrajectory(QueryTrajectory { axis, at_ns }));
    let answer = rig.events.iter().find(|event| event.command == query && event.kind == Kind::Accepted);
    let Some(Event { position, asked, limit, place, .. }) = answer else { return Err(rig.refusal(query)) };
    let (Number::Velocity(velocity), Number::Acceleration(acceleration)) = (*asked, *limit) else {
        panic!("{answer:?}")
    };
    Ok(([position.to_f64(), velocity, acceleration], place.is_some()))
}

fn is_near(found: [f64; 3], expected: [f64; 3]) -> bool {
    std::iter::zip(found, expected).all(|(found, expected)| (found - expected).abs() <= 1e-6 * expected.abs() + 1e-4)
}

/// L (3 u^2 - 2 u^3) with L 10000 inc in 400 ms: at a quarter of the time 1562.5 inc, 28125 inc/s and 187500 inc/s^2;
/// in the middle 5000 inc and 37500 inc/s. A time between two cycles has its own answer: after 100.5 ms u is 0.25125.
#[test]
fn answer_is_the_trajectory_at_any_time_of_it() {
    let mut rig = Rig::enabled();
    rig.give(later(0, 400, track(X, &[rest(10_000)])));
    let start = cycle(&rig);
    for _ in 0..3 {
        for (ms, expected) in [
            (0.0, [0.0, 0.0, 375_000.0]),
            (100.0, [1_562.5, 28_125.0, 187_500.0]),
            (100.5, [1_576.585_898_437_5, 28_218.515_625, 186_562.5]),
            (200.0, [5_000.0, 37_500.0, 0.0]),
            (400.0, [10_000.0, 0.0, 0.0]),
        ] {
            let (found, is_asked) = ask(&mut rig, X, (start, ms)).expect("within the trajectory");
            assert!(is_near(found, expected) && is_asked, "{ms} ms: {found:?} instead of {expected:?}");
        }
        rig.run(100);
    }
    assert_eq!(
        ask(&mut rig, X, (start, -0.5)).unwrap_err(),
        "x: the trajectory lasts 0.4 s from its start; -0.0005 s after it was asked for"
    );
    assert_eq!(
        ask(&mut rig, X, (start, 400.5)).unwrap_err(),
        "x: the trajectory lasts 0.4 s from its start; 0.4005 s after it was asked for"
    );
}

/// The answer does not affect the axis, and the command reaches its values.
#[test]
fn command_comes_to_the_answer() {
    let mut rig = Rig::enabled();
    rig.give(later(0, 400, track(X, &[(7_001, Some(0.0), Some(0.0))])));
    let start = cycle(&rig);
    for ms in (50..400).step_by(50) {
        let ([position, velocity, _], _) = ask(&mut rig, X, (start, f64::from(ms))).expect("within the trajectory");
        rig.run(start + ms as u64 - cycle(&rig));
        let command = rig.int("x.command.position") as f64 + rig.real("x.command.fraction");
        assert!((command - position).abs() < 1e-6, "{ms} ms: {command} instead of {position}");
        assert!((rig.real("x.command.velocity") - velocity).abs() < 1e-6);
    }
}

/// The waiting trajectory covers its times, the previous one the times before.
#[test]
fn waiting_trajectory_and_the_one_before_cover_their_times() {
    let mut rig = Rig::enabled();
    rig.give(later(0, 400, track(X, &[rest(10_000)])));
    let start = cycle(&rig);
    rig.run(50);
    rig.give(later(150, 400, track(X, &[rest(14_000)])));
    let begins = cycle(&rig) + 150;
    assert_eq!(begins, start + 201);
    let before = ask(&mut rig, X, (start, 200.0)).expect("of the one before").0;
    assert!(is_near(before, [5_000.0, 37_500.0, 0.0]), "{before:?}");
    let end = ask(&mut rig, X, (begins, 400.0)).expect("of the one that waits").0;
    assert!(is_near(end, [14_000.0, 0.0, 0.0]), "{end:?}");
    // Once it has started, it has replaced the previous one.
    rig.run(begins - cycle(&rig) + 2);
    assert!(ask(&mut rig, X, (start, 200.0)).is_err());
}

/// 10000 inc are 2 revolutions of 3600 inc and 2800 inc, of which -800 inc is nearest to 0. In 400 ms that would be
/// 3000 inc/s in the middle; with a limit of half of that it takes twice the time.
#[test]
fn answer_is_of_the_stretched_time_and_of_the_turned_track() {
    let mut config = config(0);
    config.axes[usize::from(X)].modulo = Modulo::new(3_600, 1);
    config.axes[usize::from(X)].parameters.max_velocity = 1_500.0;
    let mut rig = Rig::of(config);
    rig.enable();
    let track = Track { wraps: true, ..track(X, &[rest(10_000)]) };
    let limits = TrajectoryLimits { margin: 0.0, max_stretch: 3.0, ..TrajectoryLimits::default() };
    let trajectory = Trajectory::new(0, [400 * MS].into(), [track].into(), None).expect("a sound one").within(limits);
    let goal = rig.give(Action::Trajectory(Arc::new(trajectory)));
    assert!(rig.was_accepted(goal));
    let start = cycle(&rig);
    for (ms, expected) in [(400.0, [-400.0, -1_500.0, 0.0]), (800.0, [-800.0, 0.0, 0.0])] {
        let (found, _) = ask(&mut rig, X, (start, ms)).expect("within the trajectory");
        assert!(is_near(found, expected), "{ms} ms: {found:?} instead of {expected:?}");
    }
}

#[test]
fn without_a_trajectory_an_axis_must_stand() {
    let mut rig = Rig::enabled();
    let now = cycle(&rig);
    assert_eq!(ask(&mut rig, Y, (now, 5_000.0)), Ok(([0.0; 3], false)));
    rig.give(Action::Move(at(Y, 1_000.0)));
    rig.run(5);
    assert_eq!(ask(&mut rig, Y, (now, 5_000.0)).unwrap_err(), "y: the axis moves, and not by a trajectory");
    // A cancelled axis stops.
    let goal = rig.give(later(0, 400, track(LINE, &[rest(2_000)])));
    rig.run(100);
    let stop = rig.give(Action::Cancel { goal });
    assert!(rig.was_accepted(stop));
    assert!(ask(&mut rig, LINE, (now, 5_000.0)).unwrap_err().contains("not by a trajectory"));
    rig.give(Action::Halt(AxisSet::one(LINE)));
    let unknown = rig.give(Action::QueryTrajectory(QueryTrajectory { axis: 77, at_ns: 0 }));
    assert_eq!(rig.answer(unknown).map_err(|event| event.code), Err(Code::BAD_REQUEST));
}

//! Trajectories: all axes or none, splines, tolerances, and exactly one end in every case.

use super::rig::{LINE, Rig, X, Y, config, to};
use crate::code::Code;
use crate::command::{Action, BufferMode, Move, MoveMode};
use crate::event::{Event, Number};
use crate::machine::{Machine, State, StateError};
use crate::object::{AxisSet, Object};
use crate::position::Position;
use crate::sim::{Model, SecondOrder};
use crate::trajectory::{Knot, OnExcess, Tolerance, Track, Trajectory, TrajectoryLimits};
use std::sync::Arc;

const MS: u64 = 1_000_000;

/// A position, a velocity and an acceleration, the last two if it carries them (inc, inc/s, inc/s^2).
pub(super) type Point = (i64, Option<f64>, Option<f64>);

pub(super) fn track(axis: u16, points: &[Point]) -> Track {
    let knot = |&(position, velocity, acceleration): &Point| Knot {
        position: Position::whole(position),
        velocity,
        acceleration,
    };
    let (path, goal) = (Tolerance::default(), Tolerance::default());
    Track { axis, knots: points.iter().map(knot).collect(), path, goal, ..Track::default() }
}

fn run(times_ms: &[u64], tracks: Vec<Track>) -> Action {
    start(0, times_ms, tracks, None)
}

fn start(start_ns: i64, times_ms: &[u64], tracks: Vec<Track>, goal_time_ns: Option<u64>) -> Action {
    let times = times_ms.iter().map(|ms| ms * MS).collect();
    Action::Trajectory(Arc::new(Trajectory::new(start_ns, times, tracks.into(), goal_time_ns).expect("a sound one")))
}

/// Returns the same action without time stretching.
fn refusing(action: Action) -> Action {
    let Action::Trajectory(trajectory) = action else { panic!("a trajectory is expected") };
    let limits = TrajectoryLimits { margin: 0.0, on_excess: OnExcess::Refuse, max_stretch: 1.0 };
    Action::Trajectory(Arc::new(trajectory.as_ref().clone().within(limits)))
}

/// Returns a point at rest at this position.
fn rest(position: i64) -> Point {
    (position, Some(0.0), None)
}

fn within(millimetres: i64) -> Tolerance {
    Tolerance { position: Some(1000.0 * millimetres as f64), ..Tolerance::default() }
}

/// Returns the only end of a goal.
fn end(rig: &Rig, sequence: u64) -> Event {
    let done = rig.done(sequence);
    assert_eq!(done.len(), 1, "ends: {done:?}");
    done[0]
}

fn command(rig: &Rig, axis: &str) -> f64 {
    rig.int(&format!("{axis}.command.position")) as f64 + rig.real(&format!("{axis}.command.fraction"))
}

/// x 10 mm and y -4 mm in 400 ms, cubic: L (3 u^2 - 2 u^3) in each cycle, and both arrive in the same cycle.
#[test]
fn both_axes_are_on_their_cubics_in_every_cycle() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)]), track(Y, &[rest(-4_000)])]));
    assert!(rig.was_accepted(goal));
    assert_eq!((rig.state("x"), rig.int("x.reference"), rig.int("x.target.position")), ("DISCRETE_MOTION", 10, 10_000));
    assert_eq!(command(&rig, "x"), 0.0, "it shows first in the next cycle");
    for cycle in 1..400 {
        rig.run(1);
        let u = f64::from(cycle) / 400.0;
        for (axis, way) in [("x", 10_000.0), ("y", -4_000.0)] {
            assert!((command(&rig, axis) - way * (3.0 * u * u - 2.0 * u * u * u)).abs() < 1e-6, "{axis} at {cycle}");
            let velocity = way * (6.0 * u - 6.0 * u * u) / 0.4;
            assert!((rig.real(&format!("{axis}.command.velocity")) - velocity).abs() < 1e-6);
            let acceleration = way * (6.0 - 12.0 * u) / 0.16;
            assert!((rig.real(&format!("{axis}.command.acceleration")) - acceleration).abs() < 1e-5);
            assert_eq!(rig.int(&format!("{axis}.sync.error")), 0);
        }
    }
    assert!(rig.done(goal).is_empty());
    rig.run(1);
    let done = end(&rig, goal);
    assert_eq!((done.code, done.source, done.cycle), (Code::NONE, Object::Machine, rig.machine.next_cycle() - 1));
    assert_eq!((command(&rig, "x"), command(&rig, "y")), (10_000.0, -4_000.0));
    assert_eq!((rig.state("x"), rig.state("y")), ("STANDSTILL", "STANDSTILL"));
}

/// A refusal changes nothing on any axis.
#[test]
fn refusal_by_one_axis_applies_to_all_axes() {
    let mut rig = Rig::enabled();
    let before = rig.give(Action::Move(to(X, 20_000)));
    rig.run(50);
    rig.give(Action::Disable(AxisSet::one(Y)));
    rig.run(5);
    let goal = rig.give(run(&[1_000], vec![track(X, &[rest(30_000)]), track(Y, &[rest(1)])]));
    assert_eq!(rig.refusal(goal), "y: the axis is not enabled; enable it first");
    assert!(rig.done(before).is_empty());
    rig.run(2_000);
    assert_eq!((end(&rig, before).code, rig.int("x.command.position")), (Code::NONE, 20_000));
}

#[test]
fn limits_refuse_knots_ways_velocities_and_ramps() {
    let mut config = config(0);
    config.axes[1].parameters.max_position = Some(10_000);
    config.axes[1].parameters.min_position = Some(-10_000);
    config.axes[1].parameters.max_deceleration = Some(400_000.0);
    let mut rig = Rig::of(config);
    rig.enable();
    let turn = |velocity: f64| [(9_000, Some(velocity), None), (9_000, Some(-velocity), None), rest(0)];
    let table: Vec<(&[u64], Vec<Point>, &str)> = vec![
        (
            &[500],
            vec![rest(10_001)],
            "x: position 0.010001 m (10.001 mm) exceeds max_position 0.01 m (10 mm) at point 0 (0.5 s)",
        ),
        (
            &[500],
            vec![rest(-10_001)],
            "x: position -0.010001 m (-10.001 mm) is below min_position -0.01 m (-10 mm) at point 0 (0.5 s)",
        ),
        // From 40000 inc/s to -40000 inc/s in 400 ms: 4000 inc further.
        (
            &[600, 1000, 1600],
            turn(40_000.0).to_vec(),
            "x: position 0.013 m (13 mm) exceeds max_position 0.01 m (10 mm) before point 1 (1 s)",
        ),
        (&[50], vec![(6_000, None, None)], "x: velocity 0.12 m/s (120 mm/s) exceeds max_velocity 0.1 m/s (100 mm/s)"),
        // 1.5 L / T
        (&[100], vec![rest(8_000)], "x: velocity 0.12 m/s (120 mm/s) exceeds max_velocity 0.1 m/s (100 mm/s)"),
        // 6 L / T^2, in acceleration and deceleration.
        (&[50], vec![rest(3_000)], "x: acceleration 7.2 m/s^2 (7200 mm/s^2) exceeds max_acceleration 1 m/s^2"),
        (&[100], vec![rest(1_000)], "x: deceleration 0.6 m/s^2 (600 mm/s^2) exceeds max_deceleration 0.4 m/s^2"),
        (
            &[0],
            vec![rest(1_000)],
            "x: the last point of the trajectory is due at once, and 0.001 m (1 mm) away; 0.000001 m (0.001 mm) at most is allowed",
        ),
    ];
    for (times, points, expected) in table {
        let goal = rig.give(refusing(run(times, vec![track(LINE, &vec![rest(0); times.len()]), track(X, &points)])));
        let sentence = rig.refusal(goal);
        assert!(sentence.starts_with(expected), "{sentence}");
    }
    // 6 * 100 / 0.02^2 = 1.5e6, and 7500 inc/s.
    let goal = rig.give(refusing(run(&[20], vec![track(X, &[rest(100)])])));
    let sentence = "x: acceleration 1.5 m/s^2 (1500 mm/s^2) exceeds max_acceleration 1 m/s^2 (1000 mm/s^2) before point 0 (0.02 s); \
                    trajectory_limits.on_excess is refuse, scale would stretch the time by 1.9365";
    assert_eq!(rig.refusal(goal), sentence);
    // Up to the limit, with the maximum deceleration: 6 * 10000 / 0.4^2 = 375000.
    let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)])]));
    rig.run(400);
    assert_eq!((end(&rig, goal).code, rig.int("x.error"), rig.int("x.command.position")), (Code::NONE, 0, 10_000));
}

/// 2.5 ms ahead: the trajectory starts 3 cycles later, at 0.5 ms of its time.
#[test]
fn a_start_ahead_waits_and_one_before_begins_under_way() {
    let mut rig = Rig::enabled();
    let goal = rig.give(start(2_500_000, &[100], vec![track(X, &[rest(1_500)])], None));
    rig.run(3);
    assert_eq!((command(&rig, "x"), rig.state("x")), (0.0, "DISCRETE_MOTION"));
    // From there 1500 inc in 99.5 ms.
    rig.run(1);
    let u = 1.0 / 99.5;
    assert!((command(&rig, "x") - 1_500.0 * (3.0 * u * u - 2.0 * u * u * u)).abs() < 1e-6);
    rig.run(98);
    assert!(rig.done(goal).is_empty());
    rig.run(1);
    assert_eq!((end(&rig, goal).code, command(&rig, "x")), (Code::NONE, 1_500.0));
    // It started 150 ms ago: the first point is past, and 50 ms remain to the second.
    let points = [(1_700, Some(5_000.0), None), rest(1_800)];
    let goal = rig.give(start(-150_000_000, &[100, 200], vec![track(X, &points)], None));
    rig.run(25);
    assert!((command(&rig, "x") - 1_650.0).abs() < 1e-6);
    rig.run(25);
    assert_eq!((end(&rig, goal).code, command(&rig, "x")), (Code::NONE, 1_800.0));
    let goal = rig.give(start(-200_000_000, &[100, 200], vec![track(X, &points)], None));
    let sentence = "machine: the last point of the trajectory is at 0.2 s; it must be after the present time, 0.2 s";
    assert_eq!(rig.refusal(goal), sentence);
}

/// Past points are skipped, together with the limits that they would exceed: 20000 inc, which exceeds max_position, and
/// 300000 inc/s. Only 300 inc in 50 ms are ahead. A point ahead that exceeds the limit is refused by its own number.
#[test]
fn past_points_are_not_checked_against_limits() {
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.max_position = Some(10_000);
    let goal = |start_ms: i64, last: i64| {
        let points = [(20_000, Some(0.0), None), rest(0), rest(last)];
        start(start_ms * MS as i64, &[50, 150, 200], vec![track(X, &points)], None)
    };
    let rig = || {
        let mut rig = Rig::of(config.clone());
        rig.enable();
        rig
    };
    let mut taken = rig();
    let sequence = taken.give(goal(-150, 300));
    assert!(taken.was_accepted(sequence), "{}", taken.refusal(sequence));
    taken.run(50);
    assert_eq!((end(&taken, sequence).code, command(&taken, "x")), (Code::NONE, 300.0));
    for (start_ms, last, beyond) in [(-40, 300, "0.02 m (20 mm)"), (-150, 10_001, "0.010001 m (10.001 mm)")] {
        let mut refused = rig();
        let sequence = refused.give(goal(start_ms, last));
        let place = if last == 300 { "point 0 (0.05 s)" } else { "point 2 (0.2 s)" };
        let sentence = format!("x: position {beyond} exceeds max_position 0.01 m (10 mm) at {place}");
        assert_eq!(refused.refusal(sequence), sentence);
    }
}

/// The first spline starts with the velocity of the previous motion.
#[test]
fn a_trajectory_takes_a_motion_over_without_a_jump_and_stops_whom_it_leaves() {
    let mut rig = Rig::enabled();
    let first = rig.give(run(&[400], vec![track(X, &[rest(10_000)]), track(Y, &[rest(10_000)])]));
    rig.run(200);
    // Half-way at 1.5 L / T.
    assert!((rig.real("x.command.velocity") - 37_500.0).abs() < 1e-6);
    let second = rig.give(run(&[300], vec![track(X, &[rest(8_000)])]));
    assert_eq!((end(&rig, first).code, end(&rig, first).source), (Code::REPLACED, Object::Axis(X)));
    assert!(rig.was_accepted(second));
    assert_eq!(rig.int("y.reference"), 0);
    let mut before = [37_500.0 - 0.001, 37_500.0];
    for _ in 0..300 {
        rig.run(1);
        for (place, axis) in ["x", "y"].into_iter().enumerate() {
            let velocity = rig.real(&format!("{axis}.command.velocity"));
            assert!((velocity - before[place]).abs() <= 1_001.0, "{axis} by {}", velocity - before[place]);
            before[place] = velocity;
        }
    }
    assert_eq!((end(&rig, second).code, command(&rig, "x"), rig.state("y")), (Code::NONE, 8_000.0, "STANDSTILL"));
}

#[test]
fn cancel_stops_all_axes_and_ends_once_all_stand() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)]), track(Y, &[rest(4_000)])]));
    rig.run(200);
    let cancel = rig.give(Action::Cancel { goal });
    assert!(rig.was_accepted(cancel) && rig.done(cancel).len() == 1);
    assert!(rig.done(goal).is_empty(), "it moves still");
    rig.run(100);
    let done = end(&rig, goal);
    assert_eq!(
        (done.code, done.source, rig.state("x"), rig.state("y")),
        (Code::CANCELLED, Object::Machine, "STANDSTILL", "STANDSTILL")
    );
    // Not before the slower axis is at rest: 37500 inc/s at half of 1e6 inc/s^2.
    let ended = done.cycle - rig.done(cancel)[0].cycle;
    assert!((37..=76).contains(&ended), "{ended} cycles");
}

#[test]
fn axis_that_leaves_ends_trajectory_for_all() {
    type Leaves = (fn(&mut Rig) -> u64, Code);
    let leaves: [Leaves; 5] = [
        (|rig| rig.give(Action::Halt(AxisSet::one(Y))), Code::HALTED),
        (|rig| rig.give(Action::QuickStop(AxisSet::one(Y))), Code::QUICK_STOP),
        (|rig| rig.give(Action::Disable(AxisSet::one(Y))), Code::DISABLED),
        (|rig| rig.give(Action::Move(to(Y, 0))), Code::REPLACED),
        (
            |rig| {
                rig.plant.drive(1).unwrap().inject_fault(0x8611);
                rig.run(3);
                0
            },
            Code::drive_fault(0x8611),
        ),
    ];
    for (leave, code) in leaves {
        let mut rig = Rig::enabled();
        let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)]), track(Y, &[rest(4_000)])]));
        rig.run(200);
        leave(&mut rig);
        assert_eq!((end(&rig, goal).code, end(&rig, goal).source), (code, Object::Axis(Y)));
        rig.run(200);
        assert_eq!((rig.state("x"), rig.int("x.reference")), ("STANDSTILL", 0));
        // 37500 inc/s half-way, 500000 inc/s^2: 1406 inc further.
        assert!((6_300..6_500).contains(&rig.int("x.command.position")), "{}", rig.int("x.command.position"));
        assert_eq!(rig.done(goal).len(), 1);
    }
}

/// A drive with a slow response: 100 mm/s at 5 Hz lag by several millimetres.
#[test]
fn the_path_tolerance_stops_all_axes_with_one_event() {
    let lazy = || Model::SecondOrder(SecondOrder::new(2.0, 0.8, 1_000_000).expect("a legal model"));
    let mut config = config(0);
    config.axes[1].parameters.max_following_error = 100_000;
    let mut rig = Rig::with(config.clone(), [lazy(), Model::Ideal]);
    rig.enable();
    let x = Track { path: within(2), ..track(X, &[rest(50_000)]) };
    let y = Track { path: within(2), ..track(Y, &[rest(50_000)]) };
    let goal = rig.give(run(&[1_000], vec![y, x.clone()]));
    rig.run(900);
    let done = end(&rig, goal);
    assert_eq!(
        (done.code, done.source, done.limit),
        (Code::TRAJECTORY_PATH_TOLERANCE, Object::Axis(X), Number::Position(2_000))
    );
    let Number::Position(error) = done.asked else { panic!("{done:?}") };
    assert!((2_001..2_200).contains(&error), "{error}");
    let sentence = crate::text::message(&done, rig.machine.config());
    assert!(sentence.starts_with("x: off the path of its trajectory: position error 0.002"), "{sentence}");
    assert!(sentence.ends_with(" mm) exceeds tolerance 0.002 m (2 mm)"), "{sentence}");
    assert_eq!((rig.state("y"), rig.int("y.error"), rig.state("x")), ("STANDSTILL", 0, "STANDSTILL"));
    // An ideal drive responds after its delay, and keeps the smallest tolerance.
    for delay in [0, 3] {
        let mut config = config.clone();
        config.axes[1].drive = Some(crate::drive::Capabilities::all(delay));
        let mut rig = Rig::of(config);
        rig.enable();
        let tight = Tolerance { position: Some(1.0), ..Tolerance::default() };
        let goal =
            rig.give(run(&[1_000], vec![Track { path: tight, goal: tight, ..x.clone() }, track(LINE, &[rest(9)])]));
        rig.run(1_010);
        assert_eq!(end(&rig, goal).code, Code::NONE, "delay {delay}");
    }
}

#[test]
fn goal_tolerance_waits_for_goal_time() {
    let lazy = || Model::SecondOrder(SecondOrder::new(2.0, 0.8, 1_000_000).expect("a legal model"));
    let mut config = config(0);
    config.axes[1].parameters.max_following_error = 100_000;
    let give = |goal_time, tolerance| {
        let mut rig = Rig::with(config.clone(), [lazy(), Model::Ideal]);
        rig.enable();
        let x = Track { goal: tolerance, ..track(X, &[rest(20_000)]) };
        let goal = rig.give(start(0, &[500], vec![x, track(Y, &[rest(10)])], goal_time));
        rig.run(500);
        let begun = rig.machine.next_cycle();
        assert!(rig.done(goal).is_empty(), "x lags at 500 ms");
        rig.run(1_500);
        let done = end(&rig, goal);
        (done.code, done.source, done.cycle + 1 - begun, rig.int("x.actual.position"))
    };
    let fine = Tolerance { velocity: Some(500.0), ..within(1) };
    let (code, source, after, _) = give(None, fine);
    assert_eq!((code, source), (Code::NONE, Object::Machine));
    assert!((50..1_000).contains(&after), "{after} cycles");
    // For the goal time, and one cycle more.
    let (code, source, after, _) = give(Some(20 * MS), fine);
    assert_eq!((code, source, after), (Code::TRAJECTORY_GOAL_TOLERANCE, Object::Axis(X), 21));
    let (code, ..) = give(Some(1_000 * MS), fine);
    assert_eq!(code, Code::NONE);
}

/// Only positions: 25 mm/s, then back. An axis cannot reverse at once; it lags, within its limits, and is exact again.
#[test]
fn straight_segments_are_followed_as_a_leader_is() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[200, 400], vec![track(X, &[(5_000, None, None), (0, None, None)])]));
    let (mut before, mut lagged) = (command(&rig, "x"), 0);
    let mut speed = 0.0;
    for cycle in 1..=400 {
        rig.run(1);
        let now = command(&rig, "x");
        let next = (now - before) * 1_000.0;
        assert!((next - speed).abs() <= 1_001.0, "1e6 inc/s^2 in a cycle, not {}", next - speed);
        assert!(next.abs() <= 100_000.0 * 1.000_002);
        let target = if cycle <= 200 { 25.0 * f64::from(cycle) } else { 25.0 * f64::from(400 - cycle) };
        let error = rig.int("x.sync.error");
        assert!((target - now - error as f64).abs() <= 0.5 + 1e-6);
        assert!(now >= 0.0, "beyond its end: {now} in {cycle}");
        lagged += i32::from(error != 0);
        // Long after each corner it is exact; the stop from 25 mm/s takes 25 ms and 312 inc, half of that late.
        if (120..=200).contains(&cycle) || (330..385).contains(&cycle) {
            assert!((now - target).abs() < 1e-6, "{now} in {cycle}");
        }
        (before, speed) = (now, next);
    }
    assert!((50..220).contains(&lagged), "{lagged} cycles");
    rig.run(120);
    assert_eq!((end(&rig, goal).code, command(&rig, "x"), rig.int("x.error")), (Code::NONE, 0.0, 0));
}

/// A straight line ends at once, but an axis cannot: it decelerates earlier and arrives late, but does not overshoot.
#[test]
fn a_straight_end_at_a_limit_is_met_without_passing_it() {
    let mut config = config(0);
    config.axes[1].parameters.max_position = Some(10_000);
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(run(&[200], vec![track(X, &[(10_000, None, None)])]));
    for _ in 0..400 {
        rig.run(1);
        assert!(rig.int("x.command.position") <= 10_000);
    }
    assert_eq!((end(&rig, goal).code, rig.state("x")), (Code::NONE, "STANDSTILL"));
    assert_eq!(command(&rig, "x"), 10_000.0);
}

#[test]
fn nothing_waits_behind_a_trajectory_or_is_added_to_it() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)])]));
    rig.run(100);
    for (mode, buffer_mode) in
        [(MoveMode::Superimposed, BufferMode::Aborting), (MoveMode::Absolute, BufferMode::Buffered)]
    {
        let other = rig.give(Action::Move(Move { mode, buffer_mode, ..to(X, 100) }));
        assert!(rig.refusal(other).starts_with("x: the axis runs a trajectory"), "{}", rig.refusal(other));
    }
    rig.run(400);
    assert_eq!(end(&rig, goal).code, Code::NONE);
}

/// Commands of one cycle apply in their order.
#[test]
fn commands_of_its_cycle_come_before_and_after_it() {
    let mut rig = Rig::enabled();
    let way = || run(&[400], vec![track(X, &[rest(10_000)]), track(Y, &[rest(4_000)])]);
    let last =
        rig.give_all(vec![Action::Move(to(X, 500)), way(), Action::Move(to(Y, 700)), Action::Cancel { goal: 99 }]);
    assert_eq!(end(&rig, last - 3).code, Code::REPLACED, "the move before it");
    assert_eq!((end(&rig, last - 2).code, end(&rig, last - 2).source), (Code::REPLACED, Object::Axis(Y)));
    assert_eq!(rig.refusal(last), "machine: goal 99 is not active");
    rig.run(1_000);
    assert_eq!(
        (end(&rig, last - 1).code, rig.int("y.command.position"), rig.int("x.command.position")),
        (Code::NONE, 700, 0)
    );
    let last = rig.give_all(vec![way(), way(), Action::Cancel { goal: last + 2 }]);
    assert_eq!(end(&rig, last - 2).code, Code::REPLACED);
    rig.run(5);
    assert_eq!((end(&rig, last - 1).code, end(&rig, last).code), (Code::CANCELLED, Code::NONE));
}

/// The override has no effect: a trajectory has its own time base and must not be late.
#[test]
fn an_override_changes_nothing() {
    let mut config = config(0);
    config.axes[1].parameters.velocity_override = 0.0;
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)])]));
    rig.run(400);
    assert_eq!((end(&rig, goal).code, command(&rig, "x")), (Code::NONE, 10_000.0));
}

#[test]
fn new_limits_may_not_leave_its_way_out() {
    let mut rig = Rig::enabled();
    rig.give(run(&[400], vec![track(X, &[rest(10_000)])]));
    rig.run(10);
    let row = crate::parameter::Row::find("max_position").unwrap().0;
    let limit = |value| {
        let value = crate::parameter::Value::Int(value);
        Action::SetParameters([crate::parameter::Change { axis: X, row, value }].into())
    };
    let lower = rig.give(limit(9_999));
    assert!(rig.refusal(lower).contains("which the motion under way reaches"), "{}", rig.refusal(lower));
    let enough = rig.give(limit(10_000));
    assert!(rig.was_accepted(enough));
}

#[test]
fn a_restored_machine_goes_on_with_the_trajectory_that_ran() {
    for start_ns in [0, 300_000_000] {
        let mut rig = Rig::enabled();
        let x = Track {
            path: within(1),
            ..track(X, &[(6_000, Some(20_000.0), Some(0.0)), (10_000, Some(0.0), Some(0.0))])
        };
        let goal =
            rig.give(start(start_ns, &[300, 600], vec![x, track(Y, &[(1, None, None), (900, None, None)])], Some(0)));
        rig.run(200);
        rig.mirror();
        rig.run(1_000);
        assert_eq!((end(&rig, goal).code, command(&rig, "x"), command(&rig, "y")), (Code::NONE, 10_000.0, 900.0));
    }
}

#[test]
fn a_state_whose_axes_do_not_run_its_trajectory_is_refused() {
    let mut rig = Rig::enabled();
    rig.give(run(&[400], vec![track(X, &[rest(10_000)])]));
    let state = rig.machine.state();
    let of = |state: State| Machine::restore(config(0), state).map(drop).unwrap_err();
    assert_eq!(of(State { runs: vec![None; 7], ..state.clone() }), StateError::Trajectory);
    let mut moved = state.clone();
    moved.runs.rotate_left(1);
    assert_eq!(of(moved), StateError::Trajectory);
    let fewer = of(State { runs: vec![None], ..state.clone() });
    assert_eq!(fewer.to_string(), "the state holds 1 places for trajectories; the cell has 7");
}

/// The same if it holds at its end for a while.
#[test]
fn a_straight_line_to_a_hold_at_a_limit_is_met_without_passing_it() {
    let hold = |velocity| (10_000, velocity, None);
    for tail in [vec![hold(None); 2], vec![hold(Some(0.0)); 3], vec![hold(Some(0.0)), hold(None), hold(Some(0.0))]] {
        let mut config = config(0);
        config.axes[1].parameters.max_position = Some(10_000);
        let mut rig = Rig::of(config);
        rig.enable();
        let points: Vec<Point> = std::iter::once((2_000, None, None)).chain(tail).collect();
        let times: Vec<u64> = (0..points.len() as u64).map(|index| 100 + 160 * index).collect();
        let goal = rig.give(run(&times, vec![track(X, &points)]));
        for _ in 0..1_000 {
            rig.run(1);
            assert!(command(&rig, "x") <= 10_000.0);
        }
        assert_eq!((end(&rig, goal).code, rig.int("x.error"), command(&rig, "x")), (Code::NONE, 0, 10_000.0));
    }
}

/// Rates whose products overflow cannot bypass the limits.
#[test]
fn rates_beyond_all_numbers_are_refused() {
    let mut rig = Rig::enabled();
    for rate in [1e308, -1e308, 1e306, 1e200] {
        for acceleration in [None, Some(0.0), Some(rate), Some(-rate)] {
            let points = [(0, Some(rate), acceleration), (0, Some(0.0), acceleration)];
            for times in [[1_000, 2_000], [1, 2], [1_000_000, 9_000_000]] {
                let goal = rig.give(run(&times, vec![track(X, &points)]));
                assert!(!rig.refusal(goal).is_empty(), "{rate} {acceleration:?} {times:?}");
            }
        }
    }
    rig.run(10);
    assert_eq!(command(&rig, "x"), 0.0);
}

/// An axis that must not move backwards ends at a position that exceeds its target by rounding.
#[test]
fn an_end_that_rounding_has_passed_is_reached() {
    let mut config = config(0);
    config.axes[1].parameters.macs.revers = 2;
    let mut rig = Rig::of(config);
    rig.enable();
    let knot = |raw: i128| Knot { position: Position::from_raw(raw), velocity: Some(0.0), acceleration: None };
    let whole = Position::whole(1_000).raw();
    let x = Track { knots: [knot(whole + 100), knot(whole)].into(), ..track(X, &[]) };
    let goal = rig.give(run(&[200, 300], vec![x]));
    assert!(rig.was_accepted(goal));
    rig.run(400);
    assert_eq!((end(&rig, goal).code, command(&rig, "x")), (Code::NONE, 1_000.0));
}

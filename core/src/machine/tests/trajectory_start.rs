//! Allowed starts of trajectories, rotation of the tracks of continuous joints to the start, and maximum duration.

use super::rig::{LINE, Rig, X, Y, config};
use super::trajectory::{Point, track};
use crate::code::Code;
use crate::command::Action;
use crate::modulo::Modulo;
use crate::object::AxisSet;
use crate::sim::{Model, SecondOrder};
use crate::trajectory::{Tolerance, Track, Trajectory};
use std::sync::Arc;

const MS: u64 = 1_000_000;

fn rest(position: i64) -> Point {
    (position, Some(0.0), None)
}

fn trajectory(times_ms: &[u64], tracks: Vec<Track>) -> Trajectory {
    let times = times_ms.iter().map(|ms| ms * MS).collect();
    Trajectory::new(0, times, tracks.into(), None).expect("a sound one")
}

fn run(times_ms: &[u64], tracks: Vec<Track>) -> Action {
    Action::Trajectory(Arc::new(trajectory(times_ms, tracks)))
}

fn turned(points: &[Point]) -> Track {
    Track { wraps: true, ..track(X, points) }
}

/// Returns a rig whose x has this revolution and is at 750 degrees (GRP-TRAJ-10), where 3600 inc are 360 degrees.
fn at_750_degrees(turn: (i64, i64)) -> Rig {
    let mut config = config(0);
    config.axes[usize::from(X)].modulo = Modulo::new(turn.0, turn.1);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(run(&[500], vec![track(X, &[rest(7_500)])]));
    rig.run(501);
    assert_eq!(rig.int("x.command.position"), 7_500);
    rig
}

/// GRP-TRAJ-10
#[test]
fn points_of_an_endless_joint_are_moved_by_the_same_whole_turns() {
    let mut rig = at_750_degrees((3_600, 1));
    let points = [rest(100), rest(1_000), rest(4_000)];
    let goal = rig.give(run(&[300, 600, 1_000], vec![turned(&points)]));
    assert!(rig.was_accepted(goal));
    assert_eq!(rig.int("x.target.position"), 11_200);
    for (until, expected) in [(300, 7_300), (300, 8_200), (400, 11_200)] {
        rig.run(until);
        assert_eq!(rig.int("x.command.position"), expected);
    }
    assert_eq!((rig.done(goal)[0].code, rig.int("x.sync.error")), (Code::NONE, 0));
    // Without the rotation the track is unmodified.
    let goal = rig.give(run(&[2_000], vec![track(X, &[rest(400)])]));
    rig.run(2_001);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.command.position")), (Code::NONE, 400));
}

/// Half a revolution is upwards: 180 degrees at 0 is 180, and so is -180. A point at time 0 is the one that is rotated.
#[test]
fn half_a_turn_is_up_and_the_first_point_decides() {
    for (first, expected) in [(1_800, 9_300), (-1_800, 9_300), (1_801, 5_701)] {
        let mut rig = at_750_degrees((3_600, 1));
        // From 7500, which is shown as 300.
        let goal = rig.give(run(&[800], vec![turned(&[rest(300 + first)])]));
        assert!(rig.was_accepted(goal));
        assert_eq!(rig.int("x.target.position"), expected, "{first}");
    }
    let mut rig = at_750_degrees((3_600, 1));
    let goal = rig.give(run(&[0, 400], vec![turned(&[rest(300), rest(2_300)])]));
    assert!(rig.was_accepted(goal));
    assert_eq!(rig.int("x.target.position"), 9_500);
}

/// A trajectory whose first points are past at its arrival is rotated like one that arrives in time: 5 ms after the
/// first point it requires slightly more than 300 inc, the position of the axis, and not the second point, which would
/// be nearer half a revolution back.
#[test]
fn points_that_are_past_do_not_change_the_turn() {
    for start_ms in [0, -5] {
        let mut rig = at_750_degrees((3_600, 1));
        let points = vec![turned(&[rest(300), rest(2_300)])];
        let goal =
            rig.give(Action::Trajectory(Arc::new(trajectory(&[0, 2_000], points).starting(start_ms * MS as i64))));
        assert!(rig.was_accepted(goal));
        assert_eq!(rig.int("x.target.position"), 9_500, "{start_ms}");
    }
}

/// A revolution of 10000 / 3 inc: two of them are 6666 2/3 inc, and 100 inc at 7500 inc become 6766 2/3.
#[test]
fn a_turn_that_is_no_whole_number_of_increments_leaves_no_error() {
    let mut rig = at_750_degrees((10_000, 3));
    let goal = rig.give(run(&[300, 600], vec![turned(&[rest(100), rest(100)])]));
    rig.run(450);
    let at = rig.int("x.command.position") as f64 + rig.real("x.command.fraction");
    assert!((at - 6_766.666_666_666_6).abs() < 1e-6, "{at}");
    rig.run(200);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.command.position")), (Code::NONE, 6_767));
}

/// GRP-TRAJ-11
#[test]
fn a_first_point_at_time_0_begins_within_the_start_tolerance() {
    let mut rig = Rig::enabled();
    let of = |first: i64| Track { start: Some(20.0), ..track(X, &[rest(first), rest(500)]) };
    let goal = rig.give(run(&[0, 300], vec![track(Y, &[rest(0), rest(100)]), of(21)]));
    let sentence = "x: the first point of the trajectory is 0.000021 m (0.021 mm) from the command; 0.00002 m (0.02 mm) is allowed (start tolerance)";
    assert_eq!(rig.refusal(goal), sentence);
    rig.run(10);
    assert_eq!((rig.int("x.command.position"), rig.int("y.command.position")), (0, 0));
    // A first point later than time 0 is not a start.
    for (times, first) in [(&[0, 300], 20), (&[0, 300], -20), (&[100, 300], 21)] {
        let mut rig = Rig::enabled();
        let goal = rig.give(run(times, vec![of(first)]));
        assert!(rig.was_accepted(goal), "{first}");
    }
}

#[test]
fn max_duration_refuses_longer_ones_and_ends_what_does_not_end() {
    let mut rig = Rig::enabled();
    let of = |ms: u64, goal: Tolerance| {
        let tracks = vec![Track { goal, ..track(X, &[rest(1_000)]) }];
        Action::Trajectory(Arc::new(trajectory(&[ms], tracks).ended_after(Some(500 * MS))))
    };
    let goal = rig.give(of(501, Tolerance::default()));
    assert_eq!(rig.refusal(goal), "machine: the trajectory takes 0.501 s; at most 0.5 s is allowed (max_duration)");
    let goal = rig.give(of(500, Tolerance::default()));
    rig.run(501);
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
    // Between two cycles: the cycle that ends it is after max_duration.
    let mut rig = Rig::enabled();
    let times = [499_500_000].into();
    let late = Trajectory::new(0, times, [track(X, &[rest(1_000)])].into(), None).expect("a sound one");
    let goal = rig.give(Action::Trajectory(Arc::new(late.ended_after(Some(499_700_000)))));
    rig.run(501);
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
    // x lags at its end at 500 ms, and would wait for its tolerance without a time limit.
    let lazy = || Model::SecondOrder(SecondOrder::new(2.0, 0.8, 1_000_000).expect("a legal model"));
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.max_following_error = 100_000;
    let mut rig = Rig::with(config, [lazy(), Model::Ideal]);
    rig.enable();
    let goal = Tolerance { position: Some(10.0), ..Tolerance::default() };
    let tracks = vec![Track { goal, ..track(X, &[rest(20_000)]) }, track(Y, &[rest(10)])];
    let of = trajectory(&[500], tracks).ended_after(Some(520 * MS));
    let goal = rig.give(Action::Trajectory(Arc::new(of)));
    rig.run(520);
    assert!(rig.done(goal).is_empty());
    rig.run(1);
    assert_eq!((rig.done(goal)[0].code, rig.state("x")), (Code::TRAJECTORY_TOO_LONG, "STANDSTILL"));
}

fn later(start_ms: i64, times_ms: &[u64], tracks: Vec<Track>) -> Action {
    Action::Trajectory(Arc::new(trajectory(times_ms, tracks).starting(start_ms * MS as i64)))
}

/// Returns position and velocity of x after this time (ms) of a cubic from 0 to 10000 inc in 400 ms.
fn on_the_way(ms: f64) -> (f64, f64) {
    let u = ms / 400.0;
    (10_000.0 * (3.0 * u * u - 2.0 * u * u * u), 10_000.0 * (6.0 * u - 6.0 * u * u) / 0.4)
}

/// Returns a rig with x and y 100 ms after the start of a trajectory.
fn under_way() -> (Rig, u64) {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[400], vec![track(X, &[rest(10_000)]), track(Y, &[rest(-4_000)])]));
    rig.run(100);
    (rig, goal)
}

fn exactly(rig: &Rig, axis: &str) -> f64 {
    rig.int(&format!("{axis}.command.position")) as f64 + rig.real(&format!("{axis}.command.fraction"))
}

fn has_room(rig: &Rig) -> bool {
    rig.machine.state().runs.iter().all(Option::is_none)
}

/// The goal of the running trajectory ends, and its axis follows it until the start, where the new one takes over
/// without a jump. Axes that are not in the new one stop.
#[test]
fn a_later_start_leaves_axes_on_the_trajectory_before_until_then() {
    let (mut rig, old) = under_way();
    let new = rig.give(later(100, &[400], vec![track(X, &[rest(14_000)])]));
    assert!(rig.was_accepted(new));
    assert_eq!(rig.done(old)[0].code, Code::REPLACED);
    assert_eq!(rig.int("x.target.position"), 14_000);
    for ms in 101..=201 {
        assert!((exactly(&rig, "x") - on_the_way(f64::from(ms)).0).abs() < 1e-6, "{ms}: {}", exactly(&rig, "x"));
        assert_eq!(rig.state("x"), "DISCRETE_MOTION");
        if ms == 150 {
            rig.mirror();
        }
        rig.run(1);
    }
    assert_eq!(rig.state("y"), "STANDSTILL");
    let (from, velocity) = on_the_way(201.0);
    for ms in 1..400 {
        let u = f64::from(ms) / 400.0;
        let (square, cube) = (u * u, u * u * u);
        let way = from * (2.0 * cube - 3.0 * square + 1.0) + velocity * 0.4 * (cube - 2.0 * square + u);
        let way = way + 14_000.0 * (3.0 * square - 2.0 * cube);
        assert!((exactly(&rig, "x") - way).abs() < 1e-5, "{ms}: {} instead of {way}", exactly(&rig, "x"));
        rig.run(1);
    }
    assert_eq!((rig.done(new)[0].code, exactly(&rig, "x")), (Code::NONE, 14_000.0));
    assert_eq!(rig.done(old).len(), 1);
    assert!(has_room(&rig));
}

/// The previous trajectory ends first: its axes rest at its end until the start.
#[test]
fn a_start_behind_the_end_of_the_trajectory_before_waits_there() {
    let (mut rig, _) = under_way();
    let new = rig.give(later(500, &[200], vec![track(X, &[rest(11_000)]), track(Y, &[rest(0)])]));
    rig.run(299);
    assert_eq!((exactly(&rig, "x"), exactly(&rig, "y")), (10_000.0, -4_000.0));
    rig.run(201);
    assert_eq!((exactly(&rig, "x"), exactly(&rig, "y")), (10_000.0, -4_000.0));
    rig.run(200);
    assert_eq!((rig.done(new)[0].code, exactly(&rig, "x"), exactly(&rig, "y")), (Code::NONE, 11_000.0, 0.0));
    assert!(has_room(&rig));
}

/// x is taken over at 28125 or 37500 inc/s. Its drive reports the position of 1 + delay cycles before, 28 inc less at
/// least: the first report is from before the start.
#[test]
fn the_path_is_judged_from_the_start_on() {
    for (delay, start_ms) in [(0, 0), (3, 0), (0, 100), (3, 100)] {
        let mut rig = Rig::of(config(delay));
        rig.enable();
        rig.give(run(&[400], vec![track(X, &[rest(10_000)])]));
        rig.run(100);
        let path = Tolerance { position: Some(1.0), ..Tolerance::default() };
        let new = rig.give(later(start_ms, &[400], vec![Track { path, ..track(X, &[rest(14_000)]) }]));
        assert!(rig.was_accepted(new));
        rig.run(start_ms.unsigned_abs() + 401);
        assert_eq!((rig.done(new)[0].code, exactly(&rig, "x")), (Code::NONE, 14_000.0), "{delay} {start_ms}");
    }
}

/// The line, commanded 25 inc per cycle from rest, accelerates by 1 inc per cycle: it lags by more than 100 inc when
/// the second trajectory takes it over. The path is the one from its present position.
#[test]
fn an_axis_that_lags_behind_the_trajectory_before_is_judged_from_where_it_is() {
    let mut rig = Rig::enabled();
    let old = rig.give(run(&[400], vec![track(LINE, &[(10_000, None, None)])]));
    assert!(rig.was_accepted(old));
    let path = Tolerance { position: Some(20.0), ..Tolerance::default() };
    let new = rig.give(later(10, &[400], vec![Track { path, ..track(LINE, &[rest(12_000)]) }]));
    assert!(rig.was_accepted(new));
    rig.run(9);
    assert!(rig.int("line.sync.error") > 100, "{}", rig.int("line.sync.error"));
    rig.run(402);
    assert_eq!((rig.done(new)[0].code, exactly(&rig, "line")), (Code::NONE, 12_000.0));
}

/// Halt and cancel of the new trajectory stop its axes while it waits.
#[test]
fn end_of_waiting_trajectory_stops_its_axes() {
    let both = || vec![track(X, &[rest(14_000)]), track(Y, &[rest(0)])];
    for (halts, code) in [(true, Code::HALTED), (false, Code::CANCELLED)] {
        let (mut rig, old) = under_way();
        let new = rig.give(later(200, &[400], both()));
        rig.run(20);
        let x = AxisSet::one(X);
        rig.give(if halts { Action::Halt(x) } else { Action::Cancel { goal: new } });
        rig.run(150);
        assert_eq!((rig.done(new).len(), rig.done(new)[0].code, rig.done(old).len()), (1, code, 1));
        assert_eq!((rig.state("x"), rig.state("y")), ("STANDSTILL", "STANDSTILL"));
        let rests = exactly(&rig, "x");
        assert!(rests < on_the_way(250.0).0, "{rests}");
        rig.run(500);
        assert_eq!(exactly(&rig, "x"), rests);
        assert!(has_room(&rig));
    }
}

/// A third trajectory replaces the waiting one: the axis stays on the first until the third starts, or leaves it at
/// once. A refused one changes nothing.
#[test]
fn a_trajectory_that_waits_is_replaced_by_another() {
    for start_ms in [150, 0] {
        let (mut rig, _) = under_way();
        let waiting = rig.give(later(100, &[400], vec![track(X, &[rest(14_000)])]));
        rig.run(9);
        let refused = rig.give(later(100, &[400], vec![track(X, &[rest(4_000_000)])]));
        assert!(rig.refusal(refused).contains("exceeds max_velocity"), "{}", rig.refusal(refused));
        assert!(rig.done(waiting).is_empty());
        let last = rig.give(later(start_ms, &[400], vec![track(X, &[rest(12_000)])]));
        assert_eq!(rig.done(waiting)[0].code, Code::REPLACED);
        rig.run(start_ms.unsigned_abs());
        assert!((exactly(&rig, "x") - on_the_way(112.0 + start_ms as f64).0).abs() < 1e-6);
        rig.run(401);
        assert_eq!((rig.done(last)[0].code, exactly(&rig, "x")), (Code::NONE, 12_000.0));
        assert!(has_room(&rig));
    }
}

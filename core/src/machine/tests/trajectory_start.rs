//! Where trajectories may begin, how tracks of endless joints are turned to them, and how long they may take.

use super::rig::{Rig, X, Y, config};
use super::trajectory::{Point, track};
use crate::code::Code;
use crate::command::Action;
use crate::modulo::Modulo;
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

/// A rig whose x has this turn, at 750 degrees (GRP-TRAJ-10), where 3600 inc are 360 degrees.
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
    // Without it nothing is turned.
    let goal = rig.give(run(&[2_000], vec![track(X, &[rest(400)])]));
    rig.run(2_001);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.command.position")), (Code::NONE, 400));
}

/// Half a turn is up: 180 degrees at 0 is 180, -180 too. A point at time 0 is the one that is turned.
#[test]
fn half_a_turn_is_up_and_the_first_point_decides() {
    for (first, expected) in [(1_800, 9_300), (-1_800, 9_300), (1_801, 5_701)] {
        let mut rig = at_750_degrees((3_600, 1));
        // From 7500, which shows as 300.
        let goal = rig.give(run(&[800], vec![turned(&[rest(300 + first)])]));
        assert!(rig.was_accepted(goal));
        assert_eq!(rig.int("x.target.position"), expected, "{first}");
    }
    let mut rig = at_750_degrees((3_600, 1));
    let goal = rig.give(run(&[0, 400], vec![turned(&[rest(300), rest(2_300)])]));
    assert!(rig.was_accepted(goal));
    assert_eq!(rig.int("x.target.position"), 9_500);
}

/// A turn of 10000 / 3 inc: two of them are 6666 2/3 inc, and 100 inc at 7500 inc become 6766 2/3.
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
    let sentence =
        "x: the first point of the trajectory is 0.021 mm from the command; 0.02 mm is allowed (start tolerance)";
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
    assert_eq!(rig.refusal(goal), "machine: the trajectory takes 501 ms; at most 500 ms is allowed (max_duration)");
    let goal = rig.give(of(500, Tolerance::default()));
    rig.run(501);
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
    // x lags behind its end at 500 ms, and would wait for its tolerance as long as it takes.
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

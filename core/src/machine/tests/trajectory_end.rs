//! Trajectories that end with a velocity: their goals, and the stops of their axes.

use super::rig::{LINE, Rig, X, Y, config};
use super::trajectory::{Point, track};
use crate::code::Code;
use crate::command::Action;
use crate::sim::{Model, SecondOrder};
use crate::text;
use crate::trajectory::{Tolerance, Track, Trajectory};
use std::sync::Arc;

const MS: u64 = 1_000_000;

fn run(start_ms: i64, times_ms: &[u64], tracks: Vec<Track>) -> Action {
    run_us(start_ms * 1_000, times_ms, tracks)
}

fn run_us(start_us: i64, times_ms: &[u64], tracks: Vec<Track>) -> Action {
    let times = times_ms.iter().map(|ms| ms * MS).collect();
    let trajectory = Trajectory::new(start_us * 1_000, times, tracks.into(), None).expect("a sound one");
    Action::Trajectory(Arc::new(trajectory))
}

/// To 10000 inc within 1 s, where x has 20000 inc/s: with 500000 inc/s^2 it stops from there within 40 ms, in 400 inc.
fn moving() -> Vec<Point> {
    vec![(10_000, Some(20_000.0), None)]
}

fn command(rig: &Rig, axis: &str) -> f64 {
    rig.int(&format!("{axis}.command.position")) as f64 + rig.real(&format!("{axis}.command.fraction"))
}

#[test]
fn goal_is_reached_in_motion_and_the_axis_stops_after_it() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(0, &[1_000], vec![track(Y, &[(-300, Some(0.0), None)]), track(X, &moving())]));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    rig.run(999);
    assert!(rig.done(goal).is_empty());
    rig.run(1);
    let [done] = rig.done(goal)[..] else { panic!("one end is expected") };
    assert_eq!((done.code, command(&rig, "x"), command(&rig, "y")), (Code::NONE, 10_000.0, -300.0));
    assert_eq!((rig.real("x.command.velocity"), rig.state("y")), (20_000.0, "STANDSTILL"));
    let mut before = 20_000.0;
    for cycle in 1..=40 {
        rig.run(1);
        let velocity = rig.real("x.command.velocity");
        assert!((before - velocity - 500.0).abs() < 1.0, "{velocity} after {before} in cycle {cycle}");
        before = velocity;
    }
    rig.run(2);
    assert_eq!((command(&rig, "x"), rig.state("x"), rig.int("x.error")), (10_400.0, "STANDSTILL", 0));
}

/// The trajectory ends with a cycle, or half a cycle before one, in which x moves 10 inc further.
#[test]
fn stop_after_the_end_must_be_within_the_limits() {
    for (start_us, max_position, refused_by) in [
        (0, 10_399, Some("0.0104 m (10.4 mm)")),
        (0, 10_400, None),
        (-500, 10_409, Some("0.01041 m (10.41 mm)")),
        (-500, 10_410, None),
    ] {
        let mut config = config(0);
        config.axes[usize::from(X)].parameters.max_position = Some(max_position);
        let mut rig = Rig::of(config);
        rig.enable();
        let goal = rig.give(run_us(start_us, &[1_000], vec![track(X, &moving())]));
        if let Some(position) = refused_by {
            let refusal = rig.refusal(goal);
            let start = format!("x: the stop after the last point ends at {position}, beyond the software limit 0.0");
            assert!(refusal.starts_with(&start), "{refusal}");
        } else {
            assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
        }
        rig.run(1_100);
        assert_eq!((rig.state("x"), rig.int("x.error")), ("STANDSTILL", 0));
    }
}

#[test]
fn straight_segments_and_points_without_time_are_refused() {
    let mut rig = Rig::enabled();
    let points = [(5_000, None, None), (10_000, Some(20_000.0), None)];
    let goal = rig.give(run(0, &[500, 1_000], vec![track(X, &points)]));
    assert!(rig.refusal(goal).starts_with("x: velocity steps by "), "{}", rig.refusal(goal));
    let goal = rig.give(run(0, &[0], vec![track(X, &[(0, Some(20_000.0), None)])]));
    assert_eq!(
        rig.refusal(goal),
        "x: the last point of the trajectory is at 0 s; it must be after the present time, 0 s"
    );
    rig.run(10);
    assert_eq!((command(&rig, "x"), rig.state("x")), (0.0, "STANDSTILL"));
}

/// Tolerances are checked once, at the end: waiting for them would let the axis move on.
#[test]
fn missed_tolerance_ends_the_goal_at_once() {
    let lazy = Model::SecondOrder(SecondOrder::new(2.0, 0.8, 1_000_000).expect("a legal model"));
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.max_following_error = 100_000;
    let mut rig = Rig::with(config, [lazy, Model::Ideal]);
    rig.enable();
    let goal = Tolerance { position: Some(2.0), ..Tolerance::default() };
    let goal = rig.give(run(0, &[1_000], vec![Track { goal, ..track(X, &moving()) }]));
    rig.run(1_001);
    let [done] = rig.done(goal)[..] else { panic!("one end is expected") };
    assert_eq!(done.code, Code::TRAJECTORY_GOAL_TOLERANCE, "{}", text::message(&done, rig.machine.config()));
    rig.run(45);
    assert_eq!((command(&rig, "x"), rig.state("x")), (10_400.0, "STANDSTILL"));
}

/// The line is commanded 25 inc per cycle from rest and accelerates by 1 inc per cycle. It lags by about 200 inc at the
/// start of the second trajectory, and still lags 30 ms later, when that ends in motion.
#[test]
fn axis_that_lags_at_the_end_in_motion_misses_it() {
    let mut rig = Rig::enabled();
    rig.give(run(0, &[400], vec![track(LINE, &[(10_000, None, None)])]));
    let goal = rig.give(run(10, &[30], vec![track(LINE, &[(1_025, Some(25_000.0), None)])]));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    rig.run(40);
    let [done] = rig.done(goal)[..] else { panic!("one end is expected") };
    let sentence = text::message(&done, rig.machine.config());
    assert_eq!(done.code, Code::TRAJECTORY_GOAL_TOLERANCE, "{sentence}");
    assert!(command(&rig, "line") < 900.0, "{}", command(&rig, "line"));
}

/// A trajectory that starts after the end of one that ends in motion cannot take it over: x stops at once.
#[test]
fn trajectory_with_a_later_start_takes_over_only_before_the_end() {
    // The command of the later trajectory applies in cycle 500 of the first: 500 ms is its end, 499.5 ms and 501 ms are
    // next to it.
    for (start_us, waits_at_rest) in
        [(300_000, false), (499_500, false), (500_000, false), (501_000, true), (1_500_000, true)]
    {
        let mut rig = Rig::enabled();
        rig.give(run(0, &[1_000], vec![track(X, &moving())]));
        rig.run(499);
        let goal = rig.give(run_us(start_us, &[2_000], vec![track(X, &[(12_000, Some(0.0), None)])]));
        assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
        rig.run(100);
        assert_eq!(rig.real("x.command.velocity") == 0.0, waits_at_rest, "{start_us} us");
        rig.run(4_000);
        assert_eq!(rig.done(goal)[0].code, Code::NONE);
        assert_eq!((command(&rig, "x"), rig.state("x")), (12_000.0, "STANDSTILL"));
    }
}

//! Trajectories that exceed the velocities and accelerations of their axes: their time is stretched, or they are
//! refused.

use super::rig::{Rig, X, Y, config, to};
use super::trajectory::{Point, track};
use crate::code::Code;
use crate::command::{Action, Move, MoveMode};
use crate::event::{Event, Kind};
use crate::position::Position;
use crate::text;
use crate::trajectory::{Knot, OnExcess, Spline, Track, Trajectory, TrajectoryLimits};
use proptest::prelude::*;
use std::sync::Arc;

const MS: u64 = 1_000_000;
/// Limits of the axes of the rig (inc/s, inc/s^2).
const MAX_VELOCITY: f64 = 100_000.0;
const MAX_ACCELERATION: f64 = 1_000_000.0;

fn rest(position: i64) -> Point {
    (position, Some(0.0), None)
}

fn run(times_ms: &[u64], tracks: Vec<Track>, limits: TrajectoryLimits) -> Action {
    let times = times_ms.iter().map(|ms| ms * MS).collect();
    let trajectory = Trajectory::new(0, times, tracks.into(), None).expect("a sound one");
    Action::Trajectory(Arc::new(trajectory.within(limits)))
}

fn refusing(margin: f64) -> TrajectoryLimits {
    TrajectoryLimits { margin, on_excess: OnExcess::Refuse, ..TrajectoryLimits::default() }
}

fn scaling(margin: f64, max_stretch: f64) -> TrajectoryLimits {
    TrajectoryLimits { margin, on_excess: OnExcess::Scale, max_stretch }
}

fn command(rig: &Rig, axis: &str) -> f64 {
    rig.int(&format!("{axis}.command.position")) as f64 + rig.real(&format!("{axis}.command.fraction"))
}

/// Runs a goal to its end. Returns the number of cycles, and the largest velocity and acceleration of an axis (inc/s,
/// inc/s^2).
fn played(rig: &mut Rig, goal: u64, axis: &str) -> (usize, f64, f64) {
    let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
    let mut before = (command(rig, axis), rig.real(&format!("{axis}.command.velocity")));
    for cycle in 0..100_000 {
        if let [done] = rig.done(goal)[..] {
            assert_eq!(done.code, Code::NONE);
            return (cycle, fastest, hardest);
        }
        rig.run(1);
        let now = (command(rig, axis), rig.real(&format!("{axis}.command.velocity")));
        fastest = fastest.max((now.0 - before.0).abs() / 0.001).max(now.1.abs());
        hardest = hardest.max((now.1 - before.1).abs() / 0.001);
        before = now;
    }
    panic!("goal {goal} does not end");
}

fn stretches(rig: &Rig, goal: u64) -> Vec<Event> {
    let is_one = |event: &&Event| event.command == goal && event.code == Code::TRAJECTORY_STRETCHED;
    rig.events.iter().filter(is_one).copied().collect()
}

/// 1500 inc from rest to rest in 50 ms: 6 * 1500 / 0.05^2 = 3.6e6 inc/s^2, 3.6 times the limit of x, so it takes
/// sqrt(3.6) = 1.8974 times as long: 94.87 ms. Each position is that of the 50 ms trajectory, later.
#[test]
fn excessive_acceleration_stretches_the_time_of_all_axes_and_keeps_the_path() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[50], vec![track(Y, &[rest(-300)]), track(X, &[rest(1_500)])], scaling(0.0, 2.0)));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    let stretch = 3.6_f64.sqrt();
    for cycle in 1..95 {
        rig.run(1);
        let u = f64::from(cycle) / (50.0 * stretch);
        for (axis, way) in [("x", 1_500.0), ("y", -300.0)] {
            let expected = way * (3.0 * u * u - 2.0 * u * u * u);
            let found = command(&rig, axis);
            assert!((found - expected).abs() < 1e-4, "{axis} at {cycle}: {found} instead of {expected}");
            let velocity = way * (6.0 * u - 6.0 * u * u) / (0.05 * stretch);
            assert!((rig.real(&format!("{axis}.command.velocity")) - velocity).abs() < 1e-3, "{axis} at {cycle}");
        }
    }
    assert!(rig.done(goal).is_empty(), "94 ms are not enough");
    rig.run(1);
    assert_eq!((rig.done(goal)[0].code, command(&rig, "x"), command(&rig, "y")), (Code::NONE, 1_500.0, -300.0));
    let [event] = stretches(&rig, goal)[..] else { panic!("one event is expected") };
    assert_eq!(event.kind, Kind::Warning);
    assert_eq!(
        text::message(&event, rig.machine.config()),
        "x: the trajectory takes 1.8974 times the planned time: acceleration 3.6 m/s^2 (3600 mm/s^2) exceeds max_acceleration \
         1 m/s^2 (1000 mm/s^2) before point 0 (0.05 s)"
    );
}

/// The second segment, 15000 inc in 100 ms, needs 1.5 times max_velocity.
#[test]
fn excessive_velocity_stretches_by_its_share() {
    let mut rig = Rig::enabled();
    let points: [Point; 3] = [(0, None, None), (15_000, None, None), (16_000, None, None)];
    let goal = rig.give(run(&[0, 100, 200], vec![track(X, &points)], scaling(0.0, 1.5)));
    let [event] = stretches(&rig, goal)[..] else { panic!("one event is expected: {}", rig.refusal(goal)) };
    assert_eq!(
        text::message(&event, rig.machine.config()),
        "x: the trajectory takes 1.5 times the planned time: velocity 0.15 m/s (150 mm/s) exceeds max_velocity 0.1 m/s (100 mm/s) \
         before point 1 (0.1 s)"
    );
    let (_, fastest, _) = played(&mut rig, goal, "x");
    assert!(fastest <= MAX_VELOCITY * (1.0 + 2e-6), "{fastest}");
}

#[test]
fn a_margin_accepts_what_exceeds_by_less_and_never_more() {
    // 1.5 L / T = 100050 inc/s, 0.05 % too fast, and 6 L / T^2 = 200100 inc/s^2.
    let points = [rest(133_400)];
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[2_000], vec![track(X, &points)], refusing(0.001)));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    let (cycles, fastest, _) = played(&mut rig, goal, "x");
    assert_eq!((cycles, stretches(&rig, goal).len()), (2_000, 0), "as planned");
    assert!(fastest > 100_049.0 && fastest <= MAX_VELOCITY * 1.001, "{fastest}");
    let goal = rig.give(run(&[2_000], vec![track(X, &[rest(0)])], refusing(0.0004)));
    assert_eq!(
        rig.refusal(goal),
        "x: velocity 0.10005 m/s (100.05 mm/s) exceeds max_velocity 0.1 m/s (100 mm/s) before point 0 (2 s); \
         trajectory_limits.on_excess is refuse, scale would stretch the time by 1.0005"
    );
}

#[test]
fn more_than_max_stretch_is_refused_with_point_time_and_factor() {
    let mut rig = Rig::enabled();
    // From 10000 to 14000 inc in 40 ms: 1.5 times max_velocity, and 6 * 4000 / 0.04^2 = 15e6 inc/s^2: sqrt(15) = 3.873.
    let points = [rest(0), rest(10_000), rest(14_000)];
    let goal = rig.give(run(&[0, 500, 540], vec![track(X, &points)], scaling(0.001, 3.0)));
    assert_eq!(
        rig.refusal(goal),
        "x: velocity 0.15 m/s (150 mm/s) exceeds max_velocity 0.1 m/s (100 mm/s) before point 2 (0.54 s); within all limits \
         it takes 3.873 times the planned time, trajectory_limits.max_stretch is 3"
    );
    rig.run(10);
    assert_eq!((command(&rig, "x"), rig.state("x")), (0.0, "STANDSTILL"));
    let goal = rig.give(run(&[0, 500, 540], vec![track(X, &points)], scaling(0.001, 4.0)));
    let (cycles, fastest, hardest) = played(&mut rig, goal, "x");
    // sqrt(15) * 540 ms = 2091.4 ms.
    assert_eq!(cycles, 2_092);
    assert!(fastest <= MAX_VELOCITY && hardest <= MAX_ACCELERATION * (1.0 + 1e-6), "{fastest} {hardest}");
}

/// A new trajectory takes x over in motion: the path to its first point changes with each stretch.
#[test]
fn a_trajectory_that_takes_over_in_motion_is_stretched_too() {
    let mut rig = Rig::enabled();
    let before = rig.give(run(&[1_000], vec![track(X, &[rest(40_000)])], refusing(0.0)));
    rig.run(400);
    assert!(rig.was_accepted(before) && rig.done(before).is_empty());
    // From 57600 inc/s at 14080 inc to 30000 inc/s at 20000 inc in 100 ms: 1.2e6 inc/s^2 at its end.
    let points = [(20_000, Some(30_000.0), None), rest(24_000)];
    let goal = rig.give(run(&[100, 400], vec![track(X, &points)], scaling(0.0, 1.5)));
    let [_] = stretches(&rig, goal)[..] else { panic!("one event is expected: {}", rig.refusal(goal)) };
    let (_, fastest, hardest) = played(&mut rig, goal, "x");
    assert!(fastest <= MAX_VELOCITY && hardest <= MAX_ACCELERATION * (1.0 + 1e-6), "{fastest} {hardest}");
    assert_eq!(command(&rig, "x"), 24_000.0);
}

/// Returns a rig whose x has this max_position.
fn up_to(max_position: i64) -> Rig {
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.max_position = Some(max_position);
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// 20751 inc in 346 ms: up to 6 * 20751 / 0.346^2 = 1.04e6 inc/s^2, within the margin, up to max_position.
#[test]
fn a_trajectory_decelerates_within_its_margin_down_to_a_limit() {
    let mut rig = up_to(20_751);
    let goal = rig.give(run(&[346], vec![track(X, &[rest(20_751)])], scaling(0.05, 1.0)));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    let (cycles, _, hardest) = played(&mut rig, goal, "x");
    assert_eq!((cycles, command(&rig, "x"), rig.state("x")), (346, 20_751.0, "STANDSTILL"));
    assert!(hardest > MAX_ACCELERATION, "{hardest}");
}

/// Returns the highest command of x within this number of cycles, and the largest change of its velocity per cycle
/// (inc/s).
fn highest(rig: &mut Rig, cycles: usize) -> (f64, f64) {
    let (mut highest, mut hardest, mut before) = (0.0_f64, 0.0_f64, rig.real("x.command.velocity"));
    for _ in 0..cycles {
        rig.run(1);
        let velocity = rig.real("x.command.velocity");
        (highest, hardest) = (highest.max(command(rig, "x")), hardest.max((velocity - before).abs()));
        before = velocity;
    }
    (highest, hardest)
}

/// x lags at the corner of the first trajectory, and is at 15750 inc with 76000 inc/s at the start of the second one,
/// which was checked with 14250 inc and -75000 inc/s.
#[test]
fn an_axis_that_lags_where_a_trajectory_begins_is_stopped_at_its_limit() {
    let mut rig = up_to(20_000);
    let points: [Point; 2] = [(15_000, None, None), (0, None, None)];
    rig.give(run(&[200, 400], vec![track(X, &points)], scaling(0.001, 1.44)));
    rig.run(99);
    let later = Trajectory::new(110_000_000, [1_000 * MS].into(), [track(X, &[rest(5_000)])].into(), None);
    let goal = rig.give(Action::Trajectory(Arc::new(later.expect("a sound one"))));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    let (highest, _) = highest(&mut rig, 1_500);
    assert!(highest <= 20_000.0, "{highest}");
    assert_eq!(rig.done(goal)[0].code, Code::SOFTWARE_LIMIT_POSITIVE);
}

/// The largest step is past; the one at max_position is ahead. Stopped in time, x decelerates by at most 1.5 times its
/// limit.
#[test]
fn an_axis_with_a_step_ahead_is_stopped_at_its_limit() {
    let mut rig = up_to(20_000);
    let places = [5_000, 0, 0, 0, 20_000, 0].map(|place| (place, None, None));
    let times = [100, 200, 300, 400, 1_400, 2_400].map(|ms| ms * MS).into();
    let trajectory = Trajectory::new(-250_000_000, times, [track(X, &places)].into(), None);
    let goal = rig.give(Action::Trajectory(Arc::new(trajectory.expect("a sound one"))));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    let (highest, hardest) = highest(&mut rig, 2_500);
    assert!(highest <= 20_000.0 && hardest <= 1_500.0, "{highest} {hardest}");
    assert_eq!(rig.done(goal)[0].code, Code::SOFTWARE_LIMIT_POSITIVE);
}

/// x is at 80000 inc/s, 6000 inc before max_position. Its planned path to point 0 stays below that, but the second
/// segment needs a stretch of sqrt(1.96) = 1.4, with which the path is 22400 inc/s times s long. A path of more than 3
/// * 6000 exceeds the limit: by 117 inc at its maximum.
#[test]
fn a_way_that_only_the_stretch_leads_beyond_a_limit_is_refused() {
    let mut rig = up_to(20_000);
    rig.give(Action::Move(Move { mode: MoveMode::Velocity, velocity: 80_000.0, ..to(X, 0) }));
    while command(&rig, "x") < 13_920.0 {
        rig.run(1);
    }
    let points = [rest(20_000), rest(16_733)];
    let goal = rig.give(run(&[200, 300], vec![track(X, &points)], scaling(0.001, 1.44)));
    assert!(rig.refusal(goal).contains("exceeds max_position"), "{}", rig.refusal(goal));
}

/// An axis at 1.1 times max_velocity is taken over by a trajectory with a smaller margin: no stretch makes it slower.
#[test]
fn an_axis_too_fast_for_any_stretch_is_refused() {
    let mut rig = Rig::enabled();
    let fast = [(0, Some(0.0), None), (55_000, Some(110_000.0), None), (77_000, Some(110_000.0), None), rest(132_000)];
    let first = rig.give(run(&[0, 1_000, 1_200, 2_200], vec![track(X, &fast)], scaling(0.1, 1.0)));
    assert!(rig.was_accepted(first), "{}", rig.refusal(first));
    rig.run(1_100);
    let goal = rig.give(run(&[300], vec![track(X, &[rest(90_000)])], scaling(0.001, 10.0)));
    let refusal = rig.refusal(goal);
    assert!(refusal.starts_with("x: velocity 0.11"), "{refusal}");
    assert!(refusal.ends_with("; no longer time of the trajectory helps"), "{refusal}");
}

/// 5000 inc in 200 ms and back: from 25000 to -25000 inc/s at point 0, while the limit of an axis is 1000 inc/s per
/// cycle.
#[test]
fn straight_segments_are_refused_with_on_excess_refuse() {
    let mut rig = Rig::enabled();
    let points: [Point; 2] = [(5_000, None, None), (0, None, None)];
    let refused = run(&[200, 400], vec![track(Y, &[rest(10), rest(20)]), track(X, &points)], refusing(0.0));
    let goal = rig.give(refused);
    assert_eq!(
        rig.refusal(goal),
        "x: velocity steps by 0.05 m/s (50 mm/s) at point 0 (0.2 s), the axis can do 0.001 m/s (1 mm/s) in a cycle; \
         give velocities in the points"
    );
    // One segment: steps of 2000 inc/s at its start and its end. A trajectory with velocities has no steps.
    let goal = rig.give(run(&[500], vec![track(X, &[(1_000, None, None)])], refusing(0.0)));
    assert!(rig.refusal(goal).starts_with("x: velocity steps by 0.002 m/s (2 mm/s) at point 0 (0.5 s)"));
    let goal = rig.give(run(&[500, 900], vec![track(X, &[(2_000, Some(4_000.0), None), rest(3_000)])], refusing(0.0)));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
}

/// 5000 inc in 100 ms and back: 100000 inc/s more at point 0, 50000 at point 1, where x is at rest. Started 100 ms
/// after point 1, only the motion from rest to rest is ahead.
#[test]
fn a_step_that_is_past_is_none() {
    let points: [Point; 4] = [(5_000, None, None), (0, None, None), rest(0), rest(3_000)];
    for (start_ms, steps) in [(0, true), (-300, false)] {
        let mut rig = Rig::enabled();
        let times = [100, 200, 400, 800].map(|ms| ms * MS).into();
        let of = Trajectory::new(start_ms * MS as i64, times, [track(X, &points)].into(), None).expect("a sound one");
        let goal = rig.give(Action::Trajectory(Arc::new(of.within(refusing(0.0)))));
        if steps {
            assert!(rig.refusal(goal).starts_with("x: velocity steps by 0.1 m/s (100 mm/s) at point 0 (0.1 s)"));
        } else {
            assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
            played(&mut rig, goal, "x");
            assert_eq!(command(&rig, "x"), 3_000.0);
        }
    }
}

/// The largest step is past: 100000 inc/s at point 0. Ahead are 10000 inc/s at point 3, and back at point 4, which is a
/// step of 20000; the limit of an axis is 1000 per cycle.
#[test]
fn a_smaller_step_ahead_is_reported_where_the_largest_is_past() {
    let points: [Point; 6] =
        [(5_000, None, None), (0, None, None), rest(0), rest(0), (1_000, None, None), (0, None, None)];
    let times = [100, 200, 300, 400, 500, 600].map(|ms| ms * MS);
    let of = |limits| {
        let trajectory = Trajectory::new(-300_000_000, times.into(), [track(X, &points)].into(), None);
        Action::Trajectory(Arc::new(trajectory.expect("a sound one").within(limits)))
    };
    let mut rig = Rig::enabled();
    let goal = rig.give(of(refusing(0.0)));
    let refusal = rig.refusal(goal);
    assert!(refusal.starts_with("x: velocity steps by 0.02 m/s (20 mm/s) at point 4 (0.5 s)"), "{refusal}");
    let goal = rig.give(of(TrajectoryLimits::default()));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    rig.run(600);
    let lags = |event: &&Event| event.command == goal && event.code == Code::TRAJECTORY_LAG;
    assert_eq!(rig.events.iter().filter(lags).count(), 1);
}

/// A trajectory with meaningless limits is invalid.
#[test]
fn limits_outside_of_their_ranges_are_refused() {
    let times: Box<[u64]> = [100 * MS].into();
    let of = |limits| {
        let tracks = vec![track(X, &[rest(100)])];
        Trajectory::new(0, times.clone(), tracks.into(), None).expect("a sound one").within(limits).is_sound()
    };
    assert!(of(TrajectoryLimits::default()));
    for limits in
        [scaling(-0.001, 1.5), scaling(0.11, 1.5), scaling(f64::NAN, 1.5), scaling(0.0, 0.9), scaling(0.0, 10.1)]
    {
        assert!(!of(limits), "{limits:?}");
    }
}

/// Three cubic segments, of which the last one may be short, up to 3 times above the limits.
fn knots() -> impl Strategy<Value = (Vec<u64>, Vec<Point>)> {
    let time = 20..200_u64;
    let place = -3_000..3_000_i64;
    let velocity = -40_000.0..40_000.0_f64;
    ([time.clone(), time, 5..100], [place.clone(), place.clone(), place], [velocity.clone(), velocity]).prop_map(
        |(times, places, velocities)| {
            let at = |count: usize| times[..count].iter().sum::<u64>();
            let points = vec![
                rest(0),
                (places[0], Some(velocities[0]), None),
                (places[1], Some(velocities[1]), None),
                rest(places[2]),
            ];
            (vec![0, at(1), at(2), at(3)], points)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// A stretched trajectory stays on its path, at its time divided by the stretch, and within all limits.
    #[test]
    fn stretched_trajectories_keep_their_path_and_all_limits((times, points) in knots()) {
        let mut rig = Rig::of(config(0));
        rig.enable();
        let limits = scaling(0.0, 10.0);
        let goal = rig.give(run(&times, vec![track(X, &points)], limits));
        let is_refused = |event: &Event| event.command == goal && event.kind == Kind::Refused;
        if rig.events.iter().any(is_refused) {
            // More than ten times as long.
            return Ok(());
        }
        let stretch = stretches(&rig, goal).first().and_then(|event| event.place).map_or(1.0, |place| place.stretch);
        let knots = track(X, &points).knots;
        let model = |time_ms: f64| {
            let next = times.partition_point(|&time| time as f64 <= time_ms);
            if next == times.len() {
                return points[3].0 as f64;
            }
            let (from, until) = (times[next - 1], times[next]);
            let spline = Spline::new(&knots[next - 1], &knots[next], (until - from) * MS);
            spline.at((time_ms - from as f64) * 1e6).position.to_f64()
        };
        let mut before = rig.real("x.command.velocity");
        for cycle in 1..20_000_u32 {
            rig.run(1);
            if !rig.done(goal).is_empty() {
                break;
            }
            let expected = model(f64::from(cycle) / stretch);
            prop_assert!((command(&rig, "x") - expected).abs() < 1e-2, "{} instead of {expected}", command(&rig, "x"));
            let velocity = rig.real("x.command.velocity");
            prop_assert!(velocity.abs() <= MAX_VELOCITY * (1.0 + 1e-6));
            prop_assert!((velocity - before).abs() / 0.001 <= MAX_ACCELERATION * (1.0 + 1e-6));
            before = velocity;
        }
        prop_assert_eq!(rig.done(goal)[0].code, Code::NONE);
    }
}

/// A motion with accelerations of -1, 0 or 1 times the limit, one millisecond each, to standstill: possible output of a
/// time-optimal planner.
fn optimal_plan() -> impl Strategy<Value = (Vec<(f64, f64, f64)>, usize)> {
    (proptest::collection::vec(-1..=1_i32, 2..90), 1..100_usize).prop_map(|(half, step)| {
        let back = half.iter().rev().map(|share| -share);
        let (mut position, mut velocity) = (0.0, 0.0);
        let mut motion = vec![(0.0, 0.0, MAX_ACCELERATION * f64::from(half[0]))];
        for acceleration in half.iter().copied().chain(back).map(|share| MAX_ACCELERATION * f64::from(share)) {
            position += velocity * 0.001 + acceleration * 0.5e-6;
            velocity += acceleration * 0.001;
            motion.push((position, velocity, acceleration));
        }
        (motion, step)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// Plans within the limits run with the defaults, with any sampling.
    #[test]
    fn plans_within_the_limits_are_accepted((motion, step) in optimal_plan(), with_accelerations: bool) {
        let last = motion.len() - 1;
        let samples = (0..last).step_by(step).chain([last]);
        let knots = samples.clone().map(|place| Knot {
            position: Position::from_f64(motion[place].0),
            velocity: Some(if place == last { 0.0 } else { motion[place].1 }),
            acceleration: with_accelerations.then_some(motion[place].2),
        });
        let of_x = Track { axis: X, knots: knots.collect(), ..Track::default() };
        let times = samples.map(|place| place as u64 * MS).collect();
        let trajectory = Trajectory::new(0, times, [of_x].into(), None).expect("a sound one");
        let mut rig = Rig::of(config(0));
        rig.enable();
        let goal = rig.give(Action::Trajectory(Arc::new(trajectory)));
        prop_assert!(rig.was_accepted(goal));
        let (_, fastest, hardest) = played(&mut rig, goal, "x");
        prop_assert!(fastest <= MAX_VELOCITY * 1.001 && hardest <= MAX_ACCELERATION * 1.001_001, "{fastest} {hardest}");
    }
}

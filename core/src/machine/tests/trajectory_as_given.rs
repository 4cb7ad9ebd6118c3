//! Trajectories are checked as they are given: rounding by the core is corrected during the motion and causes no
//! refusal.

use super::rig::{Rig, X, Y, config};
use crate::code::Code;
use crate::command::Action;
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::Capabilities;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::request::{PointRequest, TrajectoryRequest, Units};
use crate::trajectory::{Knot, Tolerance, Track, Trajectory};
use crate::unit::{Fraction, Quantity, Scale, Unit};
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::sync::Arc;

const MS: u64 = 1_000_000;

/// A position with a fraction, at rest.
fn rest(position: f64) -> Knot {
    Knot { position: Position::from_f64(position), velocity: Some(0.0), acceleration: None }
}

fn run(start_ns: i64, times_ms: &[u64], tracks: &[(u16, &[Knot])], goal: Option<f64>) -> Action {
    let times = times_ms.iter().map(|ms| ms * MS).collect();
    let goal = Tolerance { position: goal, ..Tolerance::default() };
    let track = |&(axis, knots): &(u16, &[Knot])| Track { axis, knots: knots.into(), goal, ..Track::default() };
    let tracks = tracks.iter().map(track).collect();
    Action::Trajectory(Arc::new(Trajectory::new(start_ns, times, tracks, None).expect("a sound one")))
}

/// Runs until the goal has ended. Returns the code of the end.
fn end(rig: &mut Rig, goal: u64) -> Code {
    for _ in 0..2_000 {
        if let [done] = rig.done(goal)[..] {
            return done.code;
        }
        rig.run(1);
    }
    panic!(
        "goal {goal} does not end: {:?}",
        rig.events.iter().filter(|event| event.command == goal).collect::<Vec<_>>()
    );
}

fn at(rig: &Rig, axis: &str) -> (i64, f64) {
    (rig.int(&format!("{axis}.command.position")), rig.real(&format!("{axis}.command.fraction")))
}

/// The remainder to the nearest increment is moved after the last point.
#[test]
fn the_axis_rests_on_the_increment_nearest_to_the_last_point() {
    for (end_at, rests) in [(1_000.6, 1_001), (1_000.4, 1_000), (-1_000.5, -1_001)] {
        let mut rig = Rig::enabled();
        // 6 * 1000 / 0.1^2 = 600000 inc/s^2, and the same for 0.1 inc in 1 ms; 0.4 inc more would need 2400000 inc/s^2
        // more.
        let before = rest(end_at - 0.1 * f64::from(end_at > 0.0));
        let goal = rig.give(run(0, &[100, 101], &[(X, &[before, rest(end_at)])], None));
        assert!(rig.was_accepted(goal), "{end_at}: {}", rig.refusal(goal));
        assert_eq!(end(&mut rig, goal), Code::NONE);
        assert_eq!((at(&rig, "x"), rig.state("x")), ((rests, 0.0), "STANDSTILL"));
    }
}

/// MoveIt sends one point at time 0 if start and goal are the same.
#[test]
fn goal_at_present_position_is_accepted() {
    let mut rig = Rig::enabled();
    let there = rig.give(run(0, &[100], &[(X, &[rest(1_000.0)]), (Y, &[rest(500.0)])], None));
    assert_eq!(end(&mut rig, there), Code::NONE);
    for (x, y) in [(1_000.0, 500.0), (1_000.4, 499.7), (1_001.0, 500.0)] {
        for times in [&[0][..], &[0, 10], &[0, 10, 20]] {
            let (x, y) = (vec![rest(x); times.len()], vec![rest(y); times.len()]);
            let goal = rig.give(run(0, times, &[(X, &x), (Y, &y)], None));
            assert!(rig.was_accepted(goal), "{x:?} {times:?}: {}", rig.refusal(goal));
            assert_eq!(end(&mut rig, goal), Code::NONE, "{x:?} {times:?}");
            assert_eq!((rig.state("x"), rig.state("y")), ("STANDSTILL", "STANDSTILL"));
        }
    }
    assert_eq!((at(&rig, "x"), at(&rig, "y")), ((1_001, 0.0), (500, 0.0)));
    // A start ahead, between two cycles: the axis is there at that time.
    let goal = rig.give(run(2_500_000, &[0], &[(X, &[rest(1_001.0)])], None));
    assert_eq!(end(&mut rig, goal), Code::NONE);
}

#[test]
fn goal_elsewhere_at_time_zero_is_refused() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(0, &[0], &[(X, &[rest(1_002.0)])], None));
    let sentence = "x: the last point of the trajectory is due at once, and 0.001002 m (1.002 mm) away; 0.000001 m (0.001 mm) at most is allowed";
    assert_eq!(rig.refusal(goal), sentence);
    // Within the goal tolerance, and moved there within the limits.
    let goal = rig.give(run(0, &[0], &[(X, &[rest(1_002.0)])], Some(1_002.0)));
    assert!(rig.was_accepted(goal));
    let hardest = largest_acceleration(&mut rig, 500);
    assert_eq!((end(&mut rig, goal), at(&rig, "x")), (Code::NONE, (1_002, 0.0)));
    // As at the end of straight lines, the velocity change of the last step may be 1.5 times the limit of a cycle
    // (docs/known-limits.md).
    assert!(hardest <= 1_500_000.0, "{hardest} inc/s^2");
    // An axis in motion is at no position.
    rig.give(run(0, &[1_000], &[(X, &[rest(20_000.0)])], None));
    rig.run(500);
    let here = at(&rig, "x").0 as f64;
    let goal = rig.give(run(0, &[0], &[(X, &[rest(here)])], None));
    assert!(rig.refusal(goal).starts_with("x: the axis moves (DISCRETE_MOTION)"), "{}", rig.refusal(goal));
}

/// Runs this number of cycles. Returns the largest acceleration of x (inc/s^2).
fn largest_acceleration(rig: &mut Rig, cycles: usize) -> f64 {
    let mut velocities = vec![rig.real("x.command.velocity")];
    for _ in 0..cycles {
        rig.run(1);
        velocities.push(rig.real("x.command.velocity"));
    }
    velocities.windows(2).map(|pair| (pair[1] - pair[0]).abs() / 0.001).fold(0.0, f64::max)
}

/// The first point is the measured position of the axis, one increment off its command, with 10 ms to the next point: a
/// spline from the command would need 6 * 1 / 0.01^2 = 60000 inc/s^2 more.
#[test]
fn a_start_beside_the_command_is_worked_off() {
    let mut config = config(0);
    config.axes[1].parameters.in_position_window = 3;
    config.axes[1].parameters.max_acceleration = 6_000.0;
    let plan = |first: f64| {
        // 5000 inc/s^2 from rest: 0.25 inc in 10 ms, 25 inc in 100 ms; then back to rest.
        let knot = |position: f64, velocity: f64| Knot { velocity: Some(velocity), ..rest(first + position) };
        [knot(0.0, 0.0), knot(0.25, 50.0), knot(25.0, 500.0), knot(50.0, 0.0)]
    };
    for first in [0.0, 1.0, -1.0, 3.0, -2.6] {
        let mut rig = Rig::of(config.clone());
        rig.enable();
        let goal = rig.give(run(0, &[0, 10, 100, 200], &[(X, &plan(first))], None));
        assert!(rig.was_accepted(goal), "{first}: {}", rig.refusal(goal));
        let hardest = largest_acceleration(&mut rig, 500);
        assert_eq!(end(&mut rig, goal), Code::NONE);
        assert_eq!(at(&rig, "x"), (Position::from_f64(first + 50.0).nearest(), 0.0), "{first}");
        assert!(hardest <= 6_000.0 * (1.0 + 1e-5), "{first}: {hardest} inc/s^2");
    }
    // With a larger distance it is another path.
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(run(0, &[0, 10, 100, 200], &[(X, &plan(4.0))], None));
    assert!(rig.refusal(goal).starts_with("x: acceleration"), "{}", rig.refusal(goal));
}

/// Returns the largest speed and acceleration of a spline of degree 3 or 5 with these ends, at ten thousand values of u
/// from 0 to 1. It uses the textbook's basis functions and not those of the code.
fn largest(from: [f64; 3], to: [f64; 3], seconds: f64, quintic: bool) -> (f64, f64) {
    let (s, [x0, v0, a0], [x1, v1, a1]) = (seconds, from, to);
    let (h, d0, d1, e0, e1) = (x1 - x0, v0 * s, v1 * s, a0 * s * s, a1 * s * s);
    let mut most = (0.0_f64, 0.0_f64);
    for place in 0..=10_000 {
        let u = f64::from(place) / 10_000.0;
        let (u3, u4) = (u * u * u, u * u * u * u);
        let (velocity, acceleration) = if quintic {
            (
                h * 30.0 * u * u * (1.0 - u) * (1.0 - u)
                    + d0 * (1.0 - 18.0 * u * u + 32.0 * u3 - 15.0 * u4)
                    + d1 * (-12.0 * u * u + 28.0 * u3 - 15.0 * u4)
                    + e0 * (u - 4.5 * u * u + 6.0 * u3 - 2.5 * u4)
                    + e1 * (1.5 * u * u - 4.0 * u3 + 2.5 * u4),
                h * (60.0 * u - 180.0 * u * u + 120.0 * u3)
                    + d0 * (-36.0 * u + 96.0 * u * u - 60.0 * u3)
                    + d1 * (-24.0 * u + 84.0 * u * u - 60.0 * u3)
                    + e0 * (1.0 - 9.0 * u + 18.0 * u * u - 10.0 * u3)
                    + e1 * (3.0 * u - 12.0 * u * u + 10.0 * u3),
            )
        } else {
            (
                h * 6.0 * u * (1.0 - u) + d0 * (1.0 - 4.0 * u + 3.0 * u * u) + d1 * (3.0 * u * u - 2.0 * u),
                h * (6.0 - 12.0 * u) + d0 * (6.0 * u - 4.0) + d1 * (6.0 * u - 2.0),
            )
        };
        most = (most.0.max((velocity / s).abs()), most.1.max((acceleration / (s * s)).abs()));
    }
    most
}

fn machine_of(increments: u64, max_velocity: f64, max_acceleration: f64) -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::REVOLUTION);
    let scale = Scale::new(Fraction::from_integer(i128::from(increments)), per).unwrap();
    let rate = |rate: f64| rate * increments as f64 / TAU;
    let parameters = AxisParameters::new(rate(max_velocity), rate(max_acceleration));
    let axis = AxisConfig::new("a".into(), scale, Some(Capabilities::all(0)), parameters);
    MachineConfig { cycle_ns: MS, axes: vec![axis], ..MachineConfig::default() }
}

proptest! {
    /// Law: a trajectory whose given spline is within the limits is accepted, at every resolution; its last interval
    /// may be short.
    #[test]
    fn what_is_within_the_limits_is_accepted_at_every_resolution(
        increments in prop_oneof![100..100_000_u64, 100..1_u64 << 26],
        points in prop::collection::vec((0.02..0.5_f64, -3.0..3.0_f64, -2.0..2.0_f64, -5.0..5.0_f64), 2..6),
        last_us in 20..200_000_u64,
        end in (-1.0..1.0_f64, -2.0..2.0_f64),
        quintic: bool,
    ) {
        // The last interval is a stop, after a share of the distance at the last velocity.
        let (share, last_velocity) = end;
        let mut ways: Vec<_> = points.iter().map(|&(seconds, x, v, a)| ((seconds * 1e9).round(), [x, v, a])).collect();
        let last = ways.last_mut().expect("two at least");
        last.1[1] = last_velocity;
        let (last_ns, last_x) = (1e3 * last_us as f64, last.1[0]);
        ways.push((last_ns, [last_x + share * last_velocity * last_ns / 1e9, 0.0, 0.0]));
        let point = |time_ns: f64, [x, v, a]: [f64; 3]| PointRequest {
            time_ns: time_ns as u64,
            positions: vec![x],
            velocities: vec![v],
            accelerations: if quintic { vec![a] } else { vec![] },
        };
        let (mut time_ns, mut before, mut most) = (0.0, [0.0; 3], (0.1_f64, 0.1_f64));
        let mut points = vec![point(0.0, before)];
        for (ns, to) in ways {
            let (velocity, acceleration) = largest(before, to, ns / 1e9, quintic);
            most = (most.0.max(velocity), most.1.max(acceleration));
            (time_ns, before) = (time_ns + ns, to);
            points.push(point(time_ns, to));
        }
        // By Markov's inequality a polynomial of degree 4 exceeds its values at ten thousand points by less than 4e-7
        // of its maximum.
        let config = machine_of(increments, most.0 * (1.0 + 1e-6), most.1 * (1.0 + 1e-6));
        let request = TrajectoryRequest { axes: vec!["a".into()], units: Units::Si, points, ..TrajectoryRequest::default() };
        let trajectory = config.resolve_trajectory(&request).unwrap();
        let mut rig = Rig::of(config);
        rig.enable();
        let goal = rig.give(Action::Trajectory(Arc::new(trajectory)));
        prop_assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    }
}

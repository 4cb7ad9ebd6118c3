//! Lag of axes with straight segments: the lag that is reported in advance, and the actual lag.

use super::rig::{Rig, X, Y, config};
use super::trajectory::{Point, track};
use crate::code::Code;
use crate::command::{Action, Move, MoveMode};
use crate::event::{Event, Number};
use crate::text;
use crate::trajectory::{OnExcess, Track, Trajectory, TrajectoryLimits};
use proptest::prelude::*;
use std::sync::Arc;

const MS: u64 = 1_000_000;

fn run(times_ms: &[u64], tracks: Vec<Track>, max_stretch: f64) -> Action {
    let times = times_ms.iter().map(|ms| ms * MS).collect();
    let trajectory = Trajectory::new(0, times, tracks.into(), None).expect("a sound one");
    let limits = TrajectoryLimits { margin: 0.0, on_excess: OnExcess::Scale, max_stretch };
    Action::Trajectory(Arc::new(trajectory.within(limits)))
}

fn through(places: &[i64]) -> Vec<Point> {
    places.iter().map(|&place| (place, None, None)).collect()
}

fn reports(rig: &Rig, goal: u64) -> Vec<Event> {
    let is_one = |event: &&Event| event.command == goal && event.code == Code::TRAJECTORY_LAG;
    rig.events.iter().filter(is_one).copied().collect()
}

fn said(rig: &Rig, goal: u64) -> Vec<String> {
    reports(rig, goal).iter().map(|event| text::message(event, rig.machine.config())).collect()
}

fn command(rig: &Rig, axis: &str) -> f64 {
    rig.int(&format!("{axis}.command.position")) as f64 + rig.real(&format!("{axis}.command.fraction"))
}

/// x has 1e6 inc/s^2. 5000 inc in 200 ms and back: the step from 25000 to -25000 inc/s takes 50 ms, in which x lags by
/// 50000^2 / 2e6 = 1250 inc. It stops from 25000 inc/s within 25 ms, in which the trajectory needs half of that.
#[test]
fn lag_and_late_end_are_reported_in_the_cycle_of_acceptance() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[200, 400], vec![track(X, &through(&[5_000, 0]))], 1.0));
    assert_eq!(
        said(&rig, goal),
        [
            "x: straight segments make the axis lag up to 0.00125 m (1.25 mm) behind before point 1 (0.4 s), and the trajectory \
            end 0.0125 s late; give velocities in the points"
        ]
    );
}

/// From 40000 inc/s in the opposite direction: 50000 inc/s of difference, 1250 inc; the end at -10000 inc/s is 5 ms
/// late. y lags by less.
#[test]
fn a_motion_that_is_taken_over_counts() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(Move { mode: MoveMode::Velocity, velocity: 40_000.0, ..super::rig::to(X, 0) }));
    rig.run(200);
    // It moves on for 40 inc in the cycle of the command.
    let place = command(&rig, "x") as i64;
    let tracks = vec![track(Y, &through(&[-2_000])), track(X, &through(&[place + 40 - 4_000]))];
    let goal = rig.give(run(&[400], tracks, 1.0));
    let [event] = reports(&rig, goal)[..] else { panic!("{:?}", said(&rig, goal)) };
    let (Number::Position(lag), Number::Time(late)) = (event.asked, event.limit) else { panic!("{event:?}") };
    assert!((1_248..=1_251).contains(&lag), "{lag}");
    assert!((4_900_000..=5_100_000).contains(&late), "{late}");
}

/// The same position twice: the segment to the first point ahead is the last one that moves. 18000 inc/s: 162 inc, and
/// half of 18 ms.
#[test]
fn points_that_only_hold_are_reported_too() {
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&[0, 5_000], vec![track(X, &through(&[90_000, 90_000]))], 1.0));
    let [event] = reports(&rig, goal)[..] else { panic!("{:?}", said(&rig, goal)) };
    assert_eq!((event.asked, event.limit), (Number::Position(162), Number::Time(9_000_000)));
}

/// 5000 segments are processed in 79 cycles. A goal that ends earlier is no longer reported.
#[test]
fn a_long_trajectory_is_reported_some_cycles_later() {
    let zigzag: Vec<i64> = (0..5_000).map(|point| if point % 2 == 0 { 400 } else { 0 }).collect();
    let times: Vec<u64> = (1..=5_000).map(|point| point * 50).collect();
    let mut rig = Rig::enabled();
    let goal = rig.give(run(&times, vec![track(X, &through(&zigzag))], 1.0));
    rig.run(77);
    assert!(reports(&rig, goal).is_empty());
    rig.run(1);
    // 16000 inc/s of difference: 128 inc.
    let [event] = reports(&rig, goal)[..] else { panic!("{:?}", said(&rig, goal)) };
    assert_eq!((event.asked, event.limit), (Number::Position(128), Number::Time(4_000_000)));
    rig.run(100);
    assert_eq!(reports(&rig, goal).len(), 1);
    let goal = rig.give(run(&times, vec![track(X, &through(&zigzag))], 1.0));
    rig.give(Action::Cancel { goal });
    rig.run(100);
    assert!(reports(&rig, goal).is_empty());
}

/// Returns the position that a trajectory with straight segments between these positions requires at a time (s).
fn wanted(times_ms: &[u64], places: &[i64], time_s: f64) -> f64 {
    let mut before = (0.0, 0.0);
    for (&time, &place) in times_ms.iter().zip(places) {
        let next = (time as f64 / 1e3, place as f64);
        if time_s < next.0 {
            return before.1 + (next.1 - before.1) * (time_s - before.0) / (next.0 - before.0);
        }
        before = next;
    }
    before.1
}

/// Returns a rig whose x and y need hundreds of cycles for a change of velocity.
fn slow() -> Rig {
    let mut config = config(0);
    for axis in [X, Y] {
        let parameters = &mut config.axes[usize::from(axis)].parameters;
        (parameters.max_acceleration, parameters.max_deceleration) = (10_000.0, None);
    }
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// x reaches the end before the trajectory, at 3000 inc/s, passes it, follows the trajectory, and returns: an
/// independent model of the follower with short cycles gives 4684 inc and 201.3 ms.
#[test]
fn an_axis_that_passes_the_end_comes_back() {
    let mut rig = slow();
    let goal = rig.give(run(&[300, 1_460], vec![track(X, &through(&[5_134, 450]))], 1.0));
    let [event] = reports(&rig, goal)[..] else { panic!("{:?}", said(&rig, goal)) };
    let (Number::Position(lag), Number::Time(late)) = (event.asked, event.limit) else { panic!("{event:?}") };
    assert!((4_683..=4_685).contains(&lag) && (200_000_000..=203_000_000).contains(&late), "{lag} {late}");
}

/// Up to five segments for each of two axes, some of which need more time than planned.
fn plans() -> impl Strategy<Value = (Vec<u64>, [Vec<i64>; 2])> {
    (1..6_usize).prop_flat_map(|points| {
        let place = || proptest::collection::vec(-6_000..6_000_i64, points);
        (proptest::collection::vec(300..2_500_u64, points), place(), place()).prop_map(|(durations, x, y)| {
            let mut time = 0;
            let times = durations.iter().map(|duration| {
                time += duration;
                time
            });
            (times.collect(), [x, y])
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    /// The largest lag of all axes and the time of the end are as reported, within the effect of whole cycles of 1 ms.
    #[test]
    fn axes_lag_as_reported((times, places) in plans()) {
        let mut rig = slow();
        let tracks = vec![track(X, &through(&places[0])), track(Y, &through(&places[1]))];
        let goal = rig.give(run(&times, tracks, 10.0));
        prop_assume!(rig.was_accepted(goal));
        let stretched = rig.events.iter().find(|event| event.command == goal && event.code == Code::TRAJECTORY_STRETCHED);
        let stretch = stretched.and_then(|event| event.place).map_or(1.0, |place| place.stretch);
        let mut largest = 0.0_f64;
        let mut cycles = 0.0;
        while rig.done(goal).is_empty() {
            rig.run(1);
            cycles += 1.0;
            for (axis, places) in [("x", &places[0]), ("y", &places[1])] {
                largest = largest.max((wanted(&times, places, cycles * 0.001 / stretch) - command(&rig, axis)).abs());
            }
        }
        prop_assert_eq!(rig.done(goal)[0].code, Code::NONE);
        let late = cycles * 0.001 - *times.last().expect("one point at least") as f64 * 1e-3 * stretch;
        let reported = match reports(&rig, goal)[..] {
            [Event { asked: Number::Position(lag), limit: Number::Time(late), .. }] => (lag as f64, late as f64 / 1e9),
            [] => (0.0, 0.0),
            _ => panic!("{:?}", said(&rig, goal)),
        };
        prop_assert!((largest - reported.0).abs() <= 0.01 * largest + 20.0, "lag {largest}, reported {}", reported.0);
        prop_assert!((late - reported.1).abs() <= 0.03, "late {late}, reported {}", reported.1);
    }
}

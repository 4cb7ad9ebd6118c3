//! Any goal becomes a request with the promised properties, or is refused with a message.

use super::*;
use proptest::collection::vec;
use proptest::prelude::*;

/// Generates joint names, mostly valid ones.
fn name() -> impl Strategy<Value = String> {
    prop_oneof![4 => Just("x".to_owned()), 4 => Just("y".to_owned()), 1 => Just("line".to_owned()), 1 => ".{0,8}"]
}

/// Generates numbers, mostly small ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![8 => -2.0..2.0, 2 => Just(0.0), 1 => Just(-1.0), 1 => any::<f64>()]
}

fn numbers() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![6 => vec(number(), 2), 3 => Just(Vec::new()), 1 => vec(number(), 0..4)]
}

fn duration() -> impl Strategy<Value = Duration> {
    let any = (any::<i32>(), any::<u32>());
    prop_oneof![6 => (0..4, 0..1_000_000_000_u32), 1 => any].prop_map(|(sec, nanosec)| Duration { sec, nanosec })
}

fn any_point() -> impl Strategy<Value = Point> {
    let effort = prop_oneof![20 => Just(Vec::new()), 1 => numbers()];
    (numbers(), numbers(), numbers(), effort, duration()).prop_map(
        |(positions, velocities, accelerations, effort, time_from_start)| Point {
            positions,
            velocities,
            accelerations,
            effort,
            time_from_start,
        },
    )
}

fn any_tolerance() -> impl Strategy<Value = JointTolerance> {
    (name(), number(), number(), number()).prop_map(|(name, position, velocity, acceleration)| JointTolerance {
        name,
        position,
        velocity,
        acceleration,
    })
}

fn any_goal() -> impl Strategy<Value = Goal> {
    let names = prop_oneof![4 => Just(vec!["x".to_owned(), "y".to_owned()]), 1 => vec(name(), 0..4)];
    let stamp = prop_oneof![4 => Just((0, 0)), 1 => (any::<i32>(), any::<u32>())];
    (names, vec(any_point(), 0..4), stamp, vec(any_tolerance(), 0..2), vec(any_tolerance(), 0..2), duration()).prop_map(
        |(joint_names, mut points, (sec, nanosec), path_tolerance, goal_tolerance, goal_time_tolerance)| {
            // Most goals have ascending times; otherwise nearly all would fail at the same check.
            points.sort_by_key(|point| duration_ns(&point.time_from_start));
            let mut goal = Goal { path_tolerance, goal_tolerance, goal_time_tolerance, ..Goal::default() };
            goal.trajectory.joint_names = joint_names;
            goal.trajectory.points = points;
            goal.trajectory.header.stamp = Time { sec, nanosec };
            goal
        },
    )
}

fn any_settings() -> impl Strategy<Value = Settings> {
    let tolerance = || prop_oneof![Just(0.0), 0.0..1.0, Just(f64::MAX)];
    let joint = || [tolerance(), tolerance(), tolerance()];
    (any::<bool>(), tolerance(), tolerance(), joint(), joint(), (any::<bool>(), 0.0..86_400.0)).prop_map(
        |(partial, goal_time, stopped, x, y, (angle_wraparound, max_duration))| {
            let group = TrajectorySettings { angle_wraparound, max_duration, ..TrajectorySettings::default() };
            Settings { partial, goal_time, stopped, joints: vec![x, y], group, ..Settings::default() }
        },
    )
}

proptest! {
    #[test]
    fn any_goal_is_refused_with_message_or_valid(
        goal in any_goal(), settings in any_settings(), now in 0..i64::MAX,
    ) {
        let request = match request(&joints(), &settings, &goal, now) {
            Err(wrong) => {
                let sentence = wrong.to_string();
                prop_assert!(!sentence.is_empty() && sentence.len() < 300, "{}", sentence);
                return Ok(());
            }
            Ok(request) => request,
        };
        let count = request.axes.len();
        prop_assert!(count == 2 || settings.partial && count == 1);
        prop_assert!(request.axes.iter().all(|axis| axis == "x" || axis == "y"));
        prop_assert_eq!((request.path.len(), request.goal.len()), (count, count));
        prop_assert!(!request.points.is_empty());
        prop_assert!(request.points.windows(2).all(|pair| pair[0].time_ns < pair[1].time_ns));
        let tolerances = request.path.iter().chain(&request.goal);
        let mut limits = tolerances.flat_map(|t| [t.position, t.velocity, t.acceleration]).flatten();
        prop_assert!(limits.all(|limit| limit > 0.0 && limit.is_finite()));
        // Refusals of the core have a message as well.
        if let Err(error) = config().resolve_trajectory(&request) {
            let sentence = error.to_string();
            prop_assert!(!sentence.is_empty() && sentence.len() < 300, "{}", sentence);
            return Ok(());
        }
        let last = request.points.last().map(|last| last.velocities.clone()).unwrap_or_default();
        prop_assert!(last.iter().all(|velocity| velocity.abs() <= ZERO_VELOCITY_TOLERANCE), "it ends at rest");
        for point in &request.points {
            prop_assert_eq!(point.positions.len(), count);
            for rest in [&point.velocities, &point.accelerations] {
                prop_assert!(rest.is_empty() || rest.len() == count);
            }
            let mut all = point.positions.iter().chain(&point.velocities).chain(&point.accelerations);
            prop_assert!(all.all(|value| value.is_finite()));
        }
    }
}

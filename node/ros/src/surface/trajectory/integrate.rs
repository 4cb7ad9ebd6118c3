//! Integrates points that have only velocities, with the parameter `allow_integration_in_goal_trajectories`.
//!
//! Law      between two points each joint moves with the mean of their velocities, as on a spline with linear velocity. The point before
//!          the first one is the command of the joint at the time of the goal
//! Refuses  such points in a trajectory with a stamp: the positions of the joints at its start are unknown
//! Source   joint_trajectory_controller (Jazzy)

use super::convert::{GoalError, places};
use super::joints::Joints;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal as Goal;
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectoryPoint as Point;

/// Returns true if a point has only velocities.
pub(super) fn has_points_to_integrate(goal: &Goal) -> bool {
    goal.trajectory.points.iter().any(has_velocities_alone)
}

fn has_velocities_alone(point: &Point) -> bool {
    point.positions.is_empty() && !point.velocities.is_empty()
}

/// Adds the positions to each such point. `command` is the command of the joints of the group when the goal arrives.
///
/// # Errors
/// The goal has a stamp, or an unknown joint. Other errors are found by [`request`](super::convert::request).
pub(super) fn integrate(joints: &Joints, goal: &mut Goal, command: &Point) -> Result<(), GoalError> {
    let trajectory = &mut goal.trajectory;
    if trajectory.header.stamp != Time::default() {
        return Err(GoalError::IntegrationLater);
    }
    let places = places(joints, &trajectory.joint_names)?;
    let of = |values: &[f64]| -> Vec<f64> {
        places.iter().map(|&place| values.get(place).copied().unwrap_or(0.0)).collect()
    };
    let mut before = (0.0, of(&command.positions), of(&command.velocities));
    for point in &mut trajectory.points {
        let time = &point.time_from_start;
        let seconds = f64::from(time.sec) + f64::from(time.nanosec) / 1e9;
        // With fewer velocities than joints, the request is refused later because of the missing values.
        if has_velocities_alone(point) && point.velocities.len() == places.len() {
            let mean = |(from, to): (&f64, &f64)| (from + to) * 0.5 * (seconds - before.0);
            let ways = before.2.iter().zip(&point.velocities).map(mean);
            point.positions = before.1.iter().zip(ways).map(|(position, way)| position + way).collect();
        }
        let velocities = if point.velocities.is_empty() { vec![0.0; places.len()] } else { point.velocities.clone() };
        before = (seconds, point.positions.clone(), velocities);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::convert;
    use super::super::settings::Settings;
    use super::super::tests::{config, joints};
    use super::*;
    use lineshaft_msgs::foreign::builtin_interfaces::msg::Duration;
    use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectory;

    fn point(sec: i32, positions: &[f64], velocities: &[f64]) -> Point {
        let time_from_start = Duration { sec, nanosec: 500_000_000 };
        Point { positions: positions.to_vec(), velocities: velocities.to_vec(), time_from_start, ..Point::default() }
    }

    fn goal(points: Vec<Point>) -> Goal {
        let joint_names = vec!["y".to_owned(), "x".to_owned()];
        Goal { trajectory: JointTrajectory { joint_names, points, ..JointTrajectory::default() }, ..Goal::default() }
    }

    /// Returns x at 1 m with 0.2 m/s, y at 2 m; the goal has them in the opposite order.
    fn command() -> Point {
        point(0, &[1.0, 2.0], &[0.2, 0.0])
    }

    #[test]
    fn positions_are_integrated_with_mean_velocity() {
        let mut goal =
            goal(vec![point(0, &[], &[1.0, 0.4]), point(2, &[5.0, 6.0], &[0.0, 1.0]), point(4, &[], &[0.0, 0.0])]);
        assert!(has_points_to_integrate(&goal));
        integrate(&joints(), &mut goal, &command()).expect("nothing is wrong");
        let positions: Vec<_> = goal.trajectory.points.iter().map(|point| point.positions.clone()).collect();
        // y: 2 + (0 + 1) / 2 * 0.5; x: 1 + (0.2 + 0.4) / 2 * 0.5. Then from the point with positions: x 6 + (1 + 0) / 2 * 2.
        assert_eq!(positions, [[2.25, 1.15], [5.0, 6.0], [5.0, 7.0]]);
        let settings = Settings { joints: vec![[0.0; 3]; 2], ..Settings::default() };
        assert!(convert::request(&joints(), &settings, &goal, 1).is_ok());
    }

    #[test]
    fn what_cannot_be_integrated_is_refused() {
        let mut later = goal(vec![point(0, &[], &[0.0, 0.0])]);
        later.trajectory.header.stamp.sec = 5;
        assert_eq!(
            integrate(&joints(), &mut later, &command()).unwrap_err().to_string(),
            "points have velocities alone, and header.stamp is not 0; give positions, or a stamp of 0"
        );
        let mut fewer = goal(vec![point(0, &[], &[0.0])]);
        integrate(&joints(), &mut fewer, &command()).expect("the request finds it");
        let settings = Settings { joints: vec![[0.0; 3]; 2], ..Settings::default() };
        let request = convert::request(&joints(), &settings, &fewer, 1).expect("the core finds it");
        let error = config().resolve_trajectory(&request).unwrap_err().to_string();
        assert_eq!(error, "points[0].positions has 0 numbers; one for each joint (2) is expected");
        assert!(!has_points_to_integrate(&goal(vec![point(0, &[], &[])])));
    }
}

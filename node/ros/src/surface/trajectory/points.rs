//! Desired and actual positions of the joints of a group, as points of a trajectory.

use super::joints::Joints;
use crate::surface::messages::AxisView;
use lineshaft_core::signal::Board;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectoryPoint;

/// Points at the end of a cycle, in SI units.
pub(super) struct Points {
    /// Point that the trajectory demands; the command if there is no trajectory.
    pub reference: JointTrajectoryPoint,
    /// Command, which lags behind the trajectory if the axis cannot follow.
    pub command: JointTrajectoryPoint,
    pub actual: JointTrajectoryPoint,
    /// Reference point minus actual point.
    pub error: JointTrajectoryPoint,
}

impl Points {
    pub(super) fn of(joints: &Joints, board: &Board) -> Self {
        let each = |value: &dyn Fn(&AxisView) -> f64| joints.views.iter().map(value).collect::<Vec<_>>();
        let command = JointTrajectoryPoint {
            positions: each(&|view| view.command(board)),
            velocities: each(&|view| view.rate(board, AxisSignal::CommandVelocity)),
            accelerations: each(&|view| view.rate(board, AxisSignal::CommandAcceleration)),
            ..JointTrajectoryPoint::default()
        };
        let reference = JointTrajectoryPoint { positions: each(&|view| view.desired(board)), ..command.clone() };
        let actual = JointTrajectoryPoint {
            positions: each(&|view| view.si(view.int(board, AxisSignal::ActualPosition), 0.0)),
            velocities: each(&|view| view.rate(board, AxisSignal::ActualVelocity)),
            ..JointTrajectoryPoint::default()
        };
        let minus = |reference: &[f64], actual: &[f64]| reference.iter().zip(actual).map(|(r, a)| r - a).collect();
        let error = JointTrajectoryPoint {
            positions: minus(&reference.positions, &actual.positions),
            velocities: minus(&reference.velocities, &actual.velocities),
            ..JointTrajectoryPoint::default()
        };
        Self { reference, command, actual, error }
    }
}

//! `~/controller_state`: desired and actual positions of the joints of a group, and the difference.
//!
//! Law      `controller_state_rate` messages per second while there is a subscriber and cycles run, at most one per cycle
//! Source   GRP-TRAJ-12; JointTrajectoryControllerState of control_msgs, as joint_trajectory_controller (Jazzy) fills it

use super::joints::Joints;
use super::points::Points;
use super::settings::state_period;
use crate::layer::{PublishError, Publisher};
use crate::surface::host::Snapshot;
use crate::surface::hub::Hub;
use crate::surface::messages;
use lineshaft_msgs::foreign::control_msgs::msg::JointTrajectoryControllerState;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;

/// Maximum time until a new subscriber is noticed.
const IDLE: Duration = Duration::from_millis(250);

pub(super) async fn publish(publisher: Publisher<JointTrajectoryControllerState>, hub: Arc<Hub>, joints: Arc<Joints>) {
    let mut last_cycle = None;
    let mut next = Instant::now();
    loop {
        let period = state_period(&hub.own, &joints).filter(|_| publisher.subscriptions() > 0);
        next = (next + period.unwrap_or(IDLE)).max(Instant::now());
        tokio::time::sleep_until(next).await;
        if period.is_none() {
            continue;
        }
        let snapshot = hub.host.snapshot();
        if last_cycle.replace(snapshot.cycle) == Some(snapshot.cycle) {
            continue;
        }
        match publisher.publish(&message(&joints, &snapshot, hub.clock.stamp(snapshot.stamp_ns))) {
            // The program is ending.
            Err(PublishError::Closed { .. }) => return,
            Ok(()) => {}
            Err(error) => tracing::debug!("{}: {error}", publisher.topic()),
        }
    }
}

/// Returns the message of a cycle with stamp `stamp_ns`.
pub(super) fn message(joints: &Joints, snapshot: &Snapshot, stamp_ns: u64) -> JointTrajectoryControllerState {
    let points = Points::of(joints, &snapshot.board);
    JointTrajectoryControllerState {
        header: messages::header(stamp_ns),
        joint_names: joints.names.clone(),
        reference: points.reference,
        feedback: points.actual,
        error: points.error,
        output: points.command,
        speed_scaling_factor: 1.0,
        ..JointTrajectoryControllerState::default()
    }
}

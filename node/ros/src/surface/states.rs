//! `joint_states` and `~/axis_states`.

use super::Rates;
use super::host::{Host, Snapshot};
use super::signals::AxisView;
use crate::layer::{CreateError, Node, PublishError, Publisher, Qos};
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_msgs::Message;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::msg::AxisStates;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::MissedTickBehavior;

pub(super) fn start(
    node: &Node,
    host: &Arc<dyn Host>,
    rates: Rates,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let views = AxisView::all(host.as_ref());
    let joints: Vec<AxisView> = views.iter().filter(|view| !view.is_virtual).cloned().collect();
    let publisher = node.publisher::<JointState>("joint_states", Qos::STREAM)?;
    let message = move |snapshot: &Snapshot| joint_states(&joints, snapshot);
    tasks.spawn(publish(publisher, Arc::clone(host), rates.joint_states, message));
    let publisher = node.publisher::<AxisStates>("~/axis_states", Qos::STREAM)?;
    let message = move |snapshot: &Snapshot| axis_states(&views, snapshot);
    tasks.spawn(publish(publisher, Arc::clone(host), rates.axis_states, message));
    Ok(())
}

/// Publishes a message of the newest signals at a rate; nothing while the machine stands.
async fn publish<M: Message>(
    publisher: Publisher<M>,
    host: Arc<dyn Host>,
    rate: f64,
    message: impl Fn(&Snapshot) -> M + Send,
) {
    let mut ticks = tokio::time::interval(Duration::from_secs_f64(1.0 / rate));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (mut last, mut failed) = (None, 0_u64);
    loop {
        ticks.tick().await;
        let snapshot = host.snapshot();
        // Before its first cycle a snapshot has no time.
        if snapshot.stamp_ns == 0 || last == Some(snapshot.cycle) {
            continue;
        }
        last = Some(snapshot.cycle);
        if let Err(error) = publisher.publish(&message(&snapshot)) {
            failed += 1;
            note_failure(failed, &error);
        }
    }
}

/// One line for the first failure, and then for each power of two.
fn note_failure(failed: u64, error: &PublishError) {
    if failed.is_power_of_two() {
        tracing::warn!("{error} ({failed} so far)");
    }
}

pub(super) fn time(stamp_ns: u64) -> Time {
    // Seconds since 1970 fit until 2038, as ROS 2 has it.
    let sec = i32::try_from(stamp_ns / 1_000_000_000).unwrap_or(i32::MAX);
    Time { sec, nanosec: (stamp_ns % 1_000_000_000) as u32 }
}

pub(super) fn header(stamp_ns: u64) -> Header {
    Header { stamp: time(stamp_ns), frame_id: String::new() }
}

fn joint_states(joints: &[AxisView], snapshot: &Snapshot) -> JointState {
    let each = |value: &dyn Fn(&AxisView) -> f64| joints.iter().map(value).collect::<Vec<_>>();
    JointState {
        header: header(snapshot.stamp_ns),
        name: joints.iter().map(|joint| joint.name.clone()).collect(),
        position: each(&|joint| joint.si(joint.int(snapshot, AxisSignal::ActualPosition), 0.0)),
        velocity: each(&|joint| joint.rate(snapshot, AxisSignal::ActualVelocity)),
        effort: each(&|joint| joint.effort(snapshot)),
    }
}

fn axis_states(views: &[AxisView], snapshot: &Snapshot) -> AxisStates {
    AxisStates {
        header: header(snapshot.stamp_ns),
        cycle: snapshot.cycle,
        axes: views.iter().map(|view| view.state(snapshot)).collect(),
    }
}

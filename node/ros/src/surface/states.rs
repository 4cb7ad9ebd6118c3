//! `joint_states` and `~/axis_states`.

use super::Rates;
use super::host::{Host, Snapshot};
use super::messages::{AxisView, axis_states, joint_states};
use super::table;
use crate::layer::{Clock, CreateError, Node, PublishError, Publisher};
use lineshaft_msgs::Message;
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
    let views = AxisView::all(host.config(), host.directory());
    let joints = views.clone();
    let publisher = table::JOINT_STATES.publisher(node)?;
    let clock: Clock = node.clock().clone();
    let message = move |snapshot: &Snapshot| joint_states(&joints, &snapshot.board, clock.stamp(snapshot.stamp_ns));
    tasks.spawn(publish(publisher, Arc::clone(host), rates.joint_states, message));
    let publisher = table::AXIS_STATES.publisher(node)?;
    let clock: Clock = node.clock().clone();
    let message =
        move |snapshot: &Snapshot| axis_states(&views, &snapshot.board, snapshot.cycle, clock.stamp(snapshot.stamp_ns));
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

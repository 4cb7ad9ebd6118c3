//! `joint_states`, `~/axis_states` and `~/shaft`.

use super::host::{Host, Snapshot};
use super::leaders::{LeaderView, shaft_states};
use super::messages::{AxisView, axis_states, joint_states};
use super::table;
use crate::layer::{Clock, CreateError, Node, PublishError, Publisher};
use lineshaft_msgs::Message;
use std::sync::Arc;
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::task::JoinSet;

/// Maximum number of waiting samples of a topic.
const WAITING: usize = 256;

/// Sender of the cycles for the state topics, used by the program.
#[derive(Debug)]
pub struct StateSender {
    joint_states: Sender<Arc<Snapshot>>,
    axis_states: Sender<Arc<Snapshot>>,
    shaft: Option<Sender<Arc<Snapshot>>>,
    left_out: u64,
}

/// Receiving end, used by the surface.
#[derive(Debug)]
pub struct StateReceiver {
    joint_states: Receiver<Arc<Snapshot>>,
    axis_states: Receiver<Arc<Snapshot>>,
    /// `None`: the topic is disabled.
    shaft: Option<Receiver<Arc<Snapshot>>>,
}

/// Creates the channels of the state topics, with or without `~/shaft`.
pub fn states(with_shaft: bool) -> (StateSender, StateReceiver) {
    let (joints, joint_states) = channel(WAITING);
    let (axes, axis_states) = channel(WAITING);
    let (leaders, shaft) = with_shaft.then(|| channel(WAITING)).unzip();
    let sender = StateSender { joint_states: joints, axis_states: axes, shaft: leaders, left_out: 0 };
    (sender, StateReceiver { joint_states, axis_states, shaft })
}

impl StateSender {
    /// Sends a sample to joint_states; never blocks.
    pub fn joint_states(&mut self, snapshot: &Arc<Snapshot>) {
        self.left_out += left_out(&self.joint_states, snapshot);
    }

    /// Sends a sample to `~/axis_states`; never blocks.
    pub fn axis_states(&mut self, snapshot: &Arc<Snapshot>) {
        self.left_out += left_out(&self.axis_states, snapshot);
    }

    /// Sends a sample to `~/shaft` if it is enabled; never blocks.
    pub fn shaft(&mut self, snapshot: &Arc<Snapshot>) {
        self.left_out += self.shaft.as_ref().map_or(0, |way| left_out(way, snapshot));
    }

    /// Returns the number of samples without room so far.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }
}

/// Sends a sample. Returns 1 if there is no room; a surface that has ended does not count.
fn left_out(way: &Sender<Arc<Snapshot>>, snapshot: &Arc<Snapshot>) -> u64 {
    u64::from(matches!(way.try_send(Arc::clone(snapshot)), Err(TrySendError::Full(_))))
}

pub(super) fn start(
    node: &Node,
    host: &Arc<dyn Host>,
    states: StateReceiver,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let views = AxisView::all(host.config(), host.directory());
    let (joints, of) = (views.clone(), Arc::clone(host));
    let publisher = table::JOINT_STATES.publisher(node)?;
    let clock: Clock = node.clock().clone();
    let message = move |snapshot: &Snapshot| {
        joint_states(&joints, of.joint_names(), &snapshot.board, clock.stamp(snapshot.stamp_ns))
    };
    tasks.spawn(publish(publisher, states.joint_states, message));
    let publisher = table::AXIS_STATES.publisher(node)?;
    let clock: Clock = node.clock().clone();
    let message =
        move |snapshot: &Snapshot| axis_states(&views, &snapshot.board, snapshot.cycle, clock.stamp(snapshot.stamp_ns));
    tasks.spawn(publish(publisher, states.axis_states, message));
    if let Some(samples) = states.shaft {
        let leaders = LeaderView::all(host.config(), host.directory());
        let publisher = table::SHAFT.publisher(node)?;
        let clock: Clock = node.clock().clone();
        let message = move |snapshot: &Snapshot| {
            shaft_states(&leaders, &snapshot.board, snapshot.cycle, clock.stamp(snapshot.stamp_ns))
        };
        tasks.spawn(publish(publisher, samples, message));
    }
    Ok(())
}

/// Publishes a message for each sample; none arrive while the machine is not running.
async fn publish<M: Message>(
    publisher: Publisher<M>,
    mut samples: Receiver<Arc<Snapshot>>,
    message: impl Fn(&Snapshot) -> M + Send,
) {
    let mut failed = 0_u64;
    while let Some(snapshot) = samples.recv().await {
        // A message without subscribers is not created.
        if publisher.subscriptions() == 0 {
            continue;
        }
        match publisher.publish(&message(&snapshot)) {
            Ok(()) => {}
            // The program is ending.
            Err(PublishError::Closed { .. }) => return,
            Err(error) => {
                failed += 1;
                note_failure(failed, &error);
            }
        }
    }
}

/// Logs the first failure, and then those at each power of two.
fn note_failure(failed: u64, error: &PublishError) {
    if failed.is_power_of_two() {
        tracing::warn!("{error} ({failed} so far)");
    }
}

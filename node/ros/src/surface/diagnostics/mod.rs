//! `/diagnostics`: one status for the cycle, one for each axis with a drive, one for each backend that had to be started, one for the
//! recorder; published once a second, and at once when a level changes.

mod judge;

use super::hub::Hub;
use super::lifecycle::NodeLifecycle;
use super::messages::AxisView;
use super::table;
use crate::layer::{CreateError, Node, Publisher};
use judge::{DiagnosticsEvaluator, StatusData};
use lineshaft_msgs::foreign::diagnostic_msgs::msg::DiagnosticArray;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::oneshot;
use tokio::task::JoinSet;
use tokio::time::{MissedTickBehavior, timeout};

/// Time between two messages without a change.
const PERIOD: Duration = Duration::from_secs(1);
/// Time between two evaluations.
const LOOK: Duration = Duration::from_millis(20);
/// Longer than the recorder takes to answer.
const PATIENCE: Duration = Duration::from_millis(200);

/// State of the recorder.
#[derive(Clone, Debug, Default)]
enum Recorder {
    /// The recorder has not answered yet.
    #[default]
    Unknown,
    /// The recorder has failed.
    Gone,
    Status(RecordResponse),
}

pub(super) fn start(
    node: &Node,
    hub: &Arc<Hub>,
    life: Arc<NodeLifecycle>,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let publisher = table::DIAGNOSTICS.publisher(node)?;
    let (config, directory) = (hub.host.config(), hub.host.directory());
    let hardware = |axis: u16| hub.host.hardware(axis).map(str::to_owned);
    let hardware = (0..config.axes.len()).map(|axis| u16::try_from(axis).ok().and_then(hardware)).collect();
    let judge = DiagnosticsEvaluator::new(
        AxisView::all(config, directory),
        hardware,
        directory,
        config.cycle_ns,
        Instant::now(),
    );
    tasks.spawn(publish(publisher, node.name().name().to_owned(), Arc::clone(hub), life, judge));
    Ok(())
}

async fn publish(
    publisher: Publisher<DiagnosticArray>,
    node: String,
    hub: Arc<Hub>,
    life: Arc<NodeLifecycle>,
    mut judge: DiagnosticsEvaluator,
) {
    let mut looks = tokio::time::interval(LOOK);
    looks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (mut told, mut failed) = (None::<(Instant, Vec<u8>)>, 0_u64);
    let (mut recorder, mut asked) = (Recorder::Unknown, None::<Instant>);
    loop {
        looks.tick().await;
        if asked.is_none_or(|asked| asked.elapsed() >= PERIOD) {
            asked = Some(Instant::now());
            recorder = request_recorder_state(&hub, recorder).await;
        }
        let (snapshot, time) = (hub.host.snapshot(), Instant::now());
        let backends = hub.host.backends();
        let findings = judge.evaluate(&snapshot, time, &backends, &recorder);
        let levels = findings.levels();
        if told.as_ref().is_some_and(|(last, before)| *before == levels && time - *last < PERIOD) {
            continue;
        }
        let words = StatusData { node: &node, state: life.label(), error: &|axis, code| hub.error_of(axis, code) };
        let status = judge.describe(&findings, &snapshot, &backends, &recorder, &words);
        let header = Header { stamp: hub.clock.now(), ..Header::default() };
        if let Err(error) = publisher.publish(&DiagnosticArray { header, status }) {
            failed += 1;
            if failed.is_power_of_two() {
                tracing::warn!("{error} ({failed} so far)");
            }
        }
        told = Some((time, levels));
    }
}

/// Requests the state of the recorder; returns the known state if it does not answer in time.
async fn request_recorder_state(hub: &Hub, known: Recorder) -> Recorder {
    let (answer, answered) = oneshot::channel();
    hub.host.record(RecordRequest { command: RecordRequest::STATUS, ..RecordRequest::default() }, answer);
    match timeout(PATIENCE, answered).await {
        Ok(Ok(status)) => Recorder::Status(status),
        Ok(Err(_)) => Recorder::Gone,
        Err(_) => known,
    }
}

//! Hub: submits commands, and delivers every event to `~/events` and to the waiting requester.

use super::history::History;
use super::host::{Host, StampedEvent, SubmitError};
use super::messages;
use super::parameters::own::OwnParameters;
use super::table;
use crate::layer::{Clock, CreateError, Node, Publisher, Rosout, SENT_TO_ROSOUT, Severity, Source};
use crate::line_limit::MessageRateLimit;
use lineshaft_core::code::Code;
use lineshaft_core::command::Action;
use lineshaft_core::event::{Event as CoreEvent, Kind};
use lineshaft_core::object::Object;
use lineshaft_core::text;
use lineshaft_msgs::msg::Event;
use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::task::JoinSet;

/// Number of stored error messages of one axis.
const ERRORS: usize = 4;

/// Longer than the machine ever takes to accept or refuse a command: without an answer it is not running.
const PATIENCE: Duration = Duration::from_secs(10);

/// Commands and events of one surface.
pub(super) struct Hub {
    pub host: Arc<dyn Host>,
    /// Parameters of the node itself.
    pub own: OwnParameters,
    /// Waiting requesters by command number. Locked before a command is submitted, so that its answer cannot arrive before the entry
    /// exists.
    waiting: Mutex<HashMap<u64, Requester>>,
    /// Newest errors of each axis with their messages: several errors may be reported at once.
    errors: Mutex<HashMap<u16, VecDeque<(Code, String)>>>,
    rosout: Rosout,
    /// Clock for stamps.
    pub clock: Clock,
    /// The kind of a refusal is the requested name, the text before the colon.
    refusals: MessageRateLimit<String>,
}

enum Requester {
    /// Receives the events of its command.
    Asker(UnboundedSender<StampedEvent>),
    /// Message about a request that was refused before it became a command.
    Refused(String),
}

/// Events of one command; dropping it ends the waiting.
pub(super) struct CommandEvents {
    pub sequence: u64,
    events: UnboundedReceiver<StampedEvent>,
    hub: Arc<Hub>,
}

impl CommandEvents {
    /// Returns the next event of the command; `None` once the machine has ended.
    pub(super) async fn next(&mut self) -> Option<StampedEvent> {
        self.events.recv().await
    }

    /// Waits until the machine has accepted the command.
    ///
    /// # Errors
    /// The command was refused, with the message of the machine, or there was no answer.
    pub(super) async fn accepted(self) -> Result<(), String> {
        let hub = Arc::clone(&self.hub);
        let answer = self.answer().await?;
        if answer.kind == Kind::Accepted { Ok(()) } else { Err(text::message(&answer, hub.host.config())) }
    }

    /// Waits until the machine has accepted or refused the command.
    ///
    /// # Errors
    /// Reason why there will be no answer.
    pub(super) async fn answer(mut self) -> Result<CoreEvent, String> {
        let answer = async {
            while let Some(answer) = self.next().await {
                if matches!(answer.event.kind, Kind::Accepted | Kind::Refused) {
                    return Ok(answer.event);
                }
            }
            Err("the machine has stopped".to_owned())
        };
        let late = || Err(format!("the machine has not answered within {} s", PATIENCE.as_secs()));
        tokio::time::timeout(PATIENCE, answer).await.unwrap_or_else(|_| late())
    }
}

impl Drop for CommandEvents {
    fn drop(&mut self) {
        self.hub.waiting().remove(&self.sequence);
    }
}

impl Hub {
    pub(super) fn start(
        node: &Node,
        host: Arc<dyn Host>,
        events: UnboundedReceiver<StampedEvent>,
        tasks: &mut JoinSet<()>,
    ) -> Result<Arc<Self>, CreateError> {
        let publisher = table::EVENTS.publisher(node)?;
        let history = History::start(node, host.as_ref())?;
        let hub = Arc::new(Self {
            host,
            own: OwnParameters::new(node.take_overrides()),
            waiting: Mutex::default(),
            errors: Mutex::default(),
            rosout: node.rosout()?,
            clock: node.clock().clone(),
            refusals: MessageRateLimit::default(),
        });
        tasks.spawn(Arc::clone(&hub).pass_on(events, publisher, history));
        Ok(hub)
    }

    fn waiting(&self) -> MutexGuard<'_, HashMap<u64, Requester>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Submits a command; its events arrive as answers.
    ///
    /// # Errors
    /// The command queue is full, or no cycles run.
    pub(super) fn submit(self: &Arc<Self>, action: Action) -> Result<CommandEvents, SubmitError> {
        self.submit_with(|| self.host.submit(action))
    }

    /// Submits a command from a message of a topic. If the machine refuses it, the event names the topic.
    ///
    /// # Errors
    /// As for [`Self::submit`].
    pub(super) fn submit_message(self: &Arc<Self>, topic: &str, action: Action) -> Result<CommandEvents, SubmitError> {
        self.submit_with(|| match self.host.topic_commands() {
            Some(commands) => commands.submit(topic, || self.host.submit(action)),
            None => self.host.submit(action),
        })
    }

    fn submit_with(
        self: &Arc<Self>,
        submit: impl FnOnce() -> Result<u64, SubmitError>,
    ) -> Result<CommandEvents, SubmitError> {
        let (sender, events) = unbounded_channel();
        let mut waiting = self.waiting();
        let sequence = submit()?;
        waiting.insert(sequence, Requester::Asker(sender));
        drop(waiting);
        Ok(CommandEvents { sequence, events, hub: Arc::clone(self) })
    }

    /// Submits a command without waiting for its events.
    pub(super) fn submit_without_answer(&self, action: Action) -> Result<u64, SubmitError> {
        self.host.submit(action)
    }

    /// Takes each lock once, which proves that none is held permanently.
    pub(super) fn check_locks(&self) {
        drop(self.waiting());
        drop(self.errors.lock());
    }

    /// Ends the waiting of all requesters, because no cycles run any more.
    pub(super) fn end_waiting(&self) {
        self.waiting().clear();
    }

    /// Returns the newest message about this error of an axis, if it is among the last few.
    pub(super) fn error_of(&self, axis: u16, code: Code) -> Option<String> {
        let errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
        errors.get(&axis)?.iter().find(|(known, _)| *known == code).map(|(_, sentence)| sentence.clone())
    }

    /// Returns the time with which stamps of requests are compared, in nanoseconds since the Unix epoch.
    pub(super) fn now_ns(&self) -> i64 {
        i64::try_from(self.clock.request_ns()).unwrap_or(i64::MAX)
    }

    /// Reports a request that was refused before it became a command, on `/rosout` and as an event.
    pub(super) fn refuse(&self, sentence: String) {
        let asked = sentence.split_once(':').map_or("", |(asked, _)| asked).to_owned();
        self.refusals.log(asked, |more| tracing::warn!(target: SENT_TO_ROSOUT, "{sentence}{more}"));
        self.say(Severity::Warn, &sentence);
        let mut waiting = self.waiting();
        // If the queue is full, the message is only on /rosout.
        if let Ok(sequence) = self.host.submit(Action::Refuse(sentence.as_str().into())) {
            waiting.insert(sequence, Requester::Refused(sentence));
        }
    }

    /// Logs a message on `/rosout`.
    pub(super) fn say(&self, severity: Severity, sentence: &str) {
        self.rosout.log(severity, sentence, Source { function: "surface".to_owned(), ..Source::default() });
    }

    async fn pass_on(
        self: Arc<Self>,
        mut events: UnboundedReceiver<StampedEvent>,
        publisher: Publisher<Event>,
        history: History,
    ) {
        let mut failed = 0_u64;
        while let Some(event) = events.recv().await {
            let refused = self.deliver(&event);
            let config = self.host.config();
            let sentence = refused.unwrap_or_else(|| match self.host.topic_commands() {
                Some(commands) => commands.sentence(&event.event, config),
                None => text::message(&event.event, config),
            });
            let message = messages::event(&event.event, self.clock.stamp(event.stamp_ns), config, sentence);
            if let (Kind::Error, Object::Axis(axis)) = (event.event.kind, event.event.source) {
                let mut errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
                let known = errors.entry(axis).or_default();
                known.push_front((event.event.code, message.text.clone()));
                known.truncate(ERRORS);
            }
            self.log_event(&event, &message.text);
            history.keep(self.host.as_ref(), &event.event, &message);
            if let Err(error) = publisher.publish(&message) {
                failed += 1;
                if failed.is_power_of_two() {
                    tracing::warn!("{error} ({failed} so far)");
                }
            }
            self.host.published(&event.event);
        }
    }

    /// Delivers an event to its requester. Returns the message about a request that never became a command.
    fn deliver(&self, event: &StampedEvent) -> Option<String> {
        let mut waiting = self.waiting();
        let refused = match waiting.get(&event.event.command)? {
            Requester::Asker(asker) => {
                // A requester that has ended removes its entry itself.
                let _ = asker.send(*event);
                return None;
            }
            Requester::Refused(sentence) => sentence.clone(),
        };
        waiting.remove(&event.event.command);
        Some(refused)
    }

    /// Logs errors and refusals on `/rosout`, with their remedies.
    fn log_event(&self, event: &StampedEvent, sentence: &str) {
        if let Some(severity) = rosout_severity(&event.event) {
            self.say(severity, &text::with_remedy(sentence, event.event.code));
        }
    }
}

/// Returns the severity of an event on `/rosout`, if it is logged there.
fn rosout_severity(event: &CoreEvent) -> Option<Severity> {
    use lineshaft_core::event::Severity as Matters;
    // A request that never became a command was already logged when it was refused.
    if event.code == Code::BAD_REQUEST {
        return None;
    }
    match (event.severity, event.kind) {
        (Matters::Error, _) => Some(Severity::Error),
        (Matters::Warn, Kind::Refused | Kind::Limit | Kind::Warning) => Some(Severity::Warn),
        // No client receives the result of a trajectory of the topic.
        (Matters::Warn, Kind::Done) if missed_its_tolerance(event.code) => Some(Severity::Warn),
        _ => None,
    }
}

/// Returns true if the surface logs an event on `/rosout`, so that the log message about it is not sent there again.
pub fn is_logged_on_rosout(event: &CoreEvent) -> bool {
    rosout_severity(event).is_some()
}

fn missed_its_tolerance(code: Code) -> bool {
    matches!(code, Code::TRAJECTORY_PATH_TOLERANCE | Code::TRAJECTORY_GOAL_TOLERANCE)
}

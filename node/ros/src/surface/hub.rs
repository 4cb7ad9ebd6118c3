//! The hub: hands commands over, and brings every event to `~/events` and to the one who waits for it.

use super::history::History;
use super::host::{Busy, Host, StampedEvent};
use super::messages;
use super::parameters::own::OwnParameters;
use super::table;
use crate::layer::{Clock, CreateError, Node, Publisher, Rosout, Severity, Source, TOLD};
use crate::line_limit::LineLimit;
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

/// Errors of one axis whose sentences are kept.
const ERRORS: usize = 4;

/// Longer than the machine ever takes to say yes or no: without an answer it stands.
const PATIENCE: Duration = Duration::from_secs(10);

/// Commands and events of one surface.
pub(super) struct Hub {
    pub host: Arc<dyn Host>,
    /// Parameters of the node itself.
    pub own: OwnParameters,
    /// Who waits for which command. Taken before a command is handed over, so that no answer can come before its asker.
    waiting: Mutex<HashMap<u64, Place>>,
    /// The newest errors of each axis, with their sentences: beside the first one others may be told.
    errors: Mutex<HashMap<u16, VecDeque<(Code, String)>>>,
    rosout: Rosout,
    /// What stamps show.
    pub clock: Clock,
    /// A kind is what is asked for, which stands before the colon.
    refusals: LineLimit<String>,
}

enum Place {
    /// Gets the events of its command.
    Asker(UnboundedSender<StampedEvent>),
    /// Sentence of a request that was refused before it became a command.
    Refused(String),
}

/// The events of one command; dropping it ends the waiting.
pub(super) struct Answers {
    pub sequence: u64,
    events: UnboundedReceiver<StampedEvent>,
    hub: Arc<Hub>,
}

impl Answers {
    /// The next event of the command; none once the machine is gone.
    pub(super) async fn next(&mut self) -> Option<StampedEvent> {
        self.events.recv().await
    }

    /// Waits until the machine has accepted the command.
    ///
    /// # Errors
    /// Its sentence.
    pub(super) async fn accepted(self) -> Result<(), String> {
        let hub = Arc::clone(&self.hub);
        let answer = self.answer().await?;
        if answer.kind == Kind::Accepted { Ok(()) } else { Err(text::sentence(&answer, hub.host.config())) }
    }

    /// Waits until the machine has accepted or refused the command.
    ///
    /// # Errors
    /// Why it never will.
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

impl Drop for Answers {
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
            refusals: LineLimit::default(),
        });
        tasks.spawn(Arc::clone(&hub).pass_on(events, publisher, history));
        Ok(hub)
    }

    fn waiting(&self) -> MutexGuard<'_, HashMap<u64, Place>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hands a command over; its events come as answers.
    ///
    /// # Errors
    /// The machine's lane is full.
    pub(super) fn submit(self: &Arc<Self>, action: Action) -> Result<Answers, Busy> {
        self.submit_with(|| self.host.submit(action))
    }

    /// The same for a message of a topic, which the event names if the machine refuses it.
    ///
    /// # Errors
    /// Likewise.
    pub(super) fn submit_message(self: &Arc<Self>, topic: &str, action: Action) -> Result<Answers, Busy> {
        self.submit_with(|| match self.host.topic_commands() {
            Some(commands) => commands.submit(topic, || self.host.submit(action)),
            None => self.host.submit(action),
        })
    }

    fn submit_with(self: &Arc<Self>, submit: impl FnOnce() -> Result<u64, Busy>) -> Result<Answers, Busy> {
        let (sender, events) = unbounded_channel();
        let mut waiting = self.waiting();
        let sequence = submit()?;
        waiting.insert(sequence, Place::Asker(sender));
        drop(waiting);
        Ok(Answers { sequence, events, hub: Arc::clone(self) })
    }

    /// Hands a command over for which nobody waits.
    pub(super) fn submit_unheard(&self, action: Action) -> Result<u64, Busy> {
        self.host.submit(action)
    }

    /// Takes each lock once.
    pub(super) fn pulse(&self) {
        drop(self.waiting());
        drop(self.errors.lock());
    }

    /// Tells all who still wait for an answer that none will come: no cycle runs any more.
    pub(super) fn forget_askers(&self) {
        self.waiting().clear();
    }

    /// The newest sentence of that error of an axis, if it is one of its last few.
    pub(super) fn error_of(&self, axis: u16, code: Code) -> Option<String> {
        let errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
        errors.get(&axis)?.iter().find(|(known, _)| *known == code).map(|(_, sentence)| sentence.clone())
    }

    /// The time that stamps of requests are compared with: nanoseconds since the Unix epoch.
    pub(super) fn now_ns(&self) -> i64 {
        i64::try_from(self.clock.request_ns()).unwrap_or(i64::MAX)
    }

    /// Tells of a request that was refused before it became a command: on `/rosout`, and as an event.
    pub(super) fn refuse(&self, sentence: String) {
        let asked = sentence.split_once(':').map_or("", |(asked, _)| asked).to_owned();
        self.refusals.say(asked, |more| tracing::warn!(target: TOLD, "{sentence}{more}"));
        self.say(Severity::Warn, &sentence);
        let mut waiting = self.waiting();
        // With a full lane the sentence stays on /rosout alone.
        if let Ok(sequence) = self.host.submit(Action::Refuse(sentence.as_str().into())) {
            waiting.insert(sequence, Place::Refused(sentence));
        }
    }

    /// A line on `/rosout`.
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
                None => text::sentence(&event.event, config),
            });
            let message = messages::event(&event.event, self.clock.stamp(event.stamp_ns), config, sentence);
            if let (Kind::Error, Object::Axis(axis)) = (event.event.kind, event.event.source) {
                let mut errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
                let known = errors.entry(axis).or_default();
                known.push_front((event.event.code, message.text.clone()));
                known.truncate(ERRORS);
            }
            self.tell(&event, &message.text);
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

    /// Brings an event to its asker; gives the sentence of a request that never became a command.
    fn deliver(&self, event: &StampedEvent) -> Option<String> {
        let mut waiting = self.waiting();
        let refused = match waiting.get(&event.event.command)? {
            Place::Asker(asker) => {
                // An asker that has gone takes its place away itself.
                let _ = asker.send(*event);
                return None;
            }
            Place::Refused(sentence) => sentence.clone(),
        };
        waiting.remove(&event.event.command);
        Some(refused)
    }

    /// Errors and refusals are also on `/rosout`, with their remedies.
    fn tell(&self, event: &StampedEvent, sentence: &str) {
        if let Some(severity) = told(&event.event) {
            self.say(severity, &text::with_remedy(sentence, event.event.code));
        }
    }
}

/// How an event is told on `/rosout`, if it is.
fn told(event: &CoreEvent) -> Option<Severity> {
    use lineshaft_core::event::Severity as Matters;
    // What never became a command was told when it was refused.
    if event.code == Code::BAD_REQUEST {
        return None;
    }
    match (event.severity, event.kind) {
        (Matters::Error, _) => Some(Severity::Error),
        (Matters::Warn, Kind::Refused | Kind::Limit | Kind::Warning) => Some(Severity::Warn),
        // A trajectory of the topic has nobody else to tell.
        (Matters::Warn, Kind::Done) if missed_its_tolerance(event.code) => Some(Severity::Warn),
        _ => None,
    }
}

/// Whether the surface tells an event on `/rosout`, so that a line of the log about it does not go there once more.
pub fn is_told(event: &CoreEvent) -> bool {
    told(event).is_some()
}

fn missed_its_tolerance(code: Code) -> bool {
    matches!(code, Code::TRAJECTORY_PATH_TOLERANCE | Code::TRAJECTORY_GOAL_TOLERANCE)
}

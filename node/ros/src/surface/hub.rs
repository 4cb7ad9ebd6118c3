//! The hub: hands commands over, and brings every event to `~/events` and to the one who waits for it.

use super::host::{Busy, Host, StampedEvent};
use super::lines::LineLimit;
use super::messages;
use crate::layer::{CreateError, Node, Publisher, Qos, Rosout, Severity, Source};
use lineshaft_core::command::Action;
use lineshaft_core::event::Kind;
use lineshaft_core::text;
use lineshaft_msgs::msg::Event;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::task::JoinSet;

/// Commands and events of one surface.
pub(super) struct Hub {
    pub host: Arc<dyn Host>,
    /// Who waits for which command. Taken before a command is handed over, so that no answer can come before its asker.
    waiting: Mutex<HashMap<u64, Place>>,
    rosout: Rosout,
    lines: LineLimit,
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
        let publisher = node.publisher::<Event>("~/events", Qos::EVENTS)?;
        let hub =
            Arc::new(Self { host, waiting: Mutex::default(), rosout: node.rosout()?, lines: LineLimit::default() });
        tasks.spawn(Arc::clone(&hub).pass_on(events, publisher));
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
        let (sender, events) = unbounded_channel();
        let mut waiting = self.waiting();
        let sequence = self.host.submit(action)?;
        waiting.insert(sequence, Place::Asker(sender));
        drop(waiting);
        Ok(Answers { sequence, events, hub: Arc::clone(self) })
    }

    /// Hands a command over for which nobody waits.
    pub(super) fn submit_unheard(&self, action: Action) -> Result<u64, Busy> {
        self.host.submit(action)
    }

    /// Tells of a request that was refused before it became a command: on `/rosout`, and as an event.
    pub(super) fn refuse(&self, sentence: String) {
        self.lines.say(|more| tracing::warn!("{sentence}{more}"));
        self.say(Severity::Warn, &sentence);
        let mut waiting = self.waiting();
        // With a full lane the sentence stays on /rosout alone.
        if let Ok(sequence) = self.host.submit(Action::Refuse(sentence.as_str().into())) {
            waiting.insert(sequence, Place::Refused(sentence));
        }
    }

    /// A line on `/rosout`.
    fn say(&self, severity: Severity, sentence: &str) {
        self.rosout.log(severity, sentence, Source { function: "surface".to_owned(), ..Source::default() });
    }

    async fn pass_on(self: Arc<Self>, mut events: UnboundedReceiver<StampedEvent>, publisher: Publisher<Event>) {
        let mut failed = 0_u64;
        while let Some(event) = events.recv().await {
            let refused = self.deliver(&event);
            let config = self.host.config();
            let sentence = refused.unwrap_or_else(|| text::sentence(&event.event, config));
            let message = messages::event(&event.event, event.stamp_ns, config, sentence);
            self.tell(&event, &message.text);
            if let Err(error) = publisher.publish(&message) {
                failed += 1;
                if failed.is_power_of_two() {
                    tracing::warn!("{error} ({failed} so far)");
                }
            }
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

    /// Errors and refusals also stand in the log of the ROS system.
    fn tell(&self, event: &StampedEvent, sentence: &str) {
        use lineshaft_core::event::Severity as Matters;
        let severity = match (event.event.severity, event.event.kind) {
            (Matters::Error, _) => Severity::Error,
            (Matters::Warn, Kind::Refused | Kind::Limit | Kind::Warning) => Severity::Warn,
            _ => return,
        };
        // What never became a command was told when it was refused.
        if event.event.code != lineshaft_core::code::Code::BAD_REQUEST {
            self.say(severity, sentence);
        }
    }
}

//! Endpoints that the node's graph knows, and what they need of their node.

use std::ops::Deref;
use std::sync::{Arc, Weak};

use tokio::runtime::Handle;
use tokio::sync::watch;

use super::arguments::Names;
use super::clock::Clock;
use super::dds::{DdsError, Participant, Reader, Writer};
use super::graph::{Graph, Kind};
use super::guid::Guid;
use super::matches::Matches;
use super::qos::Qos;

/// What endpoints keep of their node. None of it keeps the node in the graph.
#[derive(Clone)]
pub(super) struct Context {
    pub(super) participant: Weak<Participant>,
    pub(super) graph: Arc<Graph>,
    pub(super) matches: Arc<Matches>,
    pub(super) runtime: Handle,
    pub(super) names: Arc<Names>,
    /// What stamps show.
    pub(super) clock: Clock,
    /// Fails to change once the node is gone.
    pub(super) closed: watch::Receiver<()>,
    /// All that was ever opened on the wire.
    #[cfg(test)]
    pub(super) opened: Opened,
}

/// What a node has opened: whether it writes, the topic and its type in DDS, how it is delivered.
#[cfg(test)]
pub(crate) type Opened = Arc<std::sync::Mutex<Vec<(bool, String, String, Qos)>>>;

impl Context {
    pub(super) fn writer(&self, topic: &str, type_name: &str, qos: Qos) -> Result<Registered<Writer>, CreateError> {
        #[cfg(test)]
        self.note(true, topic, type_name, qos);
        let writer = self.participant()?.writer(topic, type_name, qos)?;
        Ok(Registered::new(self, Kind::Writer, writer.guid(), writer))
    }

    pub(super) fn reader(&self, topic: &str, type_name: &str, qos: Qos) -> Result<Registered<Reader>, CreateError> {
        #[cfg(test)]
        self.note(false, topic, type_name, qos);
        let reader = self.participant()?.reader(topic, type_name, qos)?;
        Ok(Registered::new(self, Kind::Reader, reader.guid(), reader))
    }

    #[cfg(test)]
    fn note(&self, writes: bool, topic: &str, type_name: &str, qos: Qos) {
        self.opened.lock().unwrap().push((writes, topic.to_owned(), type_name.to_owned(), qos));
    }

    fn participant(&self) -> Result<Arc<Participant>, CreateError> {
        self.participant.upgrade().ok_or(CreateError::Closed)
    }
}

/// Something of a node could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CreateError {
    /// Its name is not allowed.
    #[error(transparent)]
    Name(#[from] super::name::NameError),
    /// The DDS library refused.
    #[error(transparent)]
    Dds(#[from] DdsError),
    /// A parameter that was given at the start, in one sentence.
    #[error("{0}")]
    Given(String),
    /// The node is gone.
    #[error("the node is closed")]
    Closed,
}

/// A reader or writer that the graph shows for as long as it lives.
pub(super) struct Registered<E> {
    // Before the entry: fields are dropped in their order.
    endpoint: E,
    entry: Entry,
}

impl<E> Registered<E> {
    fn new(context: &Context, kind: Kind, guid: Guid, endpoint: E) -> Self {
        context.graph.add(kind, guid);
        let entry = Entry { kind, guid, graph: context.graph.clone(), matches: context.matches.clone() };
        Self { endpoint, entry }
    }

    /// Readers that are matched with this writer now.
    pub(super) fn matched(&self) -> usize {
        self.entry.matches.count(self.entry.guid)
    }
}

impl<E> Deref for Registered<E> {
    type Target = E;
    fn deref(&self) -> &E {
        &self.endpoint
    }
}

impl<E> std::ops::DerefMut for Registered<E> {
    fn deref_mut(&mut self) -> &mut E {
        &mut self.endpoint
    }
}

struct Entry {
    kind: Kind,
    guid: Guid,
    graph: Arc<Graph>,
    matches: Arc<Matches>,
}

impl Drop for Entry {
    fn drop(&mut self) {
        self.graph.remove(self.kind, self.guid);
        self.matches.forget(self.guid);
    }
}

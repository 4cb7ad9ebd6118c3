//! The node in the ROS graph: `ros_discovery_info` says which DDS endpoints belong to which node.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use lineshaft_msgs::foreign::rmw_dds_common::msg::{NodeEntitiesInfo, ParticipantEntitiesInfo};
use lineshaft_msgs::{Bounded, Message, cdr};
use tokio::runtime::Handle;

use super::dds::{DdsError, Participant};
use super::guid::Guid;
use super::latched::Latched;
use super::name::NodeName;
use super::qos::Qos;

/// The only ROS topic without a prefix.
const TOPIC: &str = "ros_discovery_info";
/// Endpoints that are made or dropped within this time are announced together.
const GATHER: Duration = Duration::from_millis(10);

/// Direction of an endpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Reader,
    Writer,
}

/// Announces the endpoints of a node whenever one comes or goes.
pub(super) struct Graph {
    entities: Mutex<Entities>,
    announcement: Latched,
}

struct Entities {
    participant: Guid,
    name: NodeName,
    readers: BTreeSet<Guid>,
    writers: BTreeSet<Guid>,
}

impl Graph {
    /// Announces the node, which has no endpoints yet.
    pub(super) fn new(runtime: &Handle, participant: &Arc<Participant>, name: &NodeName) -> Result<Self, DdsError> {
        let make =
            |participant: &Participant| participant.writer(TOPIC, ParticipantEntitiesInfo::DDS_NAME, Qos::STATUS);
        let (first, weak) = (make(participant)?, Arc::downgrade(participant));
        let again = move || Weak::upgrade(&weak).and_then(|participant| make(&participant).ok());
        let entities = Entities {
            participant: participant.guid(),
            name: name.clone(),
            readers: BTreeSet::new(),
            writers: BTreeSet::new(),
        };
        let announcement = Latched::start(runtime, GATHER, first, again);
        announcement.set(cdr::encode(&entities.info()));
        Ok(Self { entities: Mutex::new(entities), announcement })
    }

    pub(super) fn add(&self, kind: Kind, endpoint: Guid) {
        let mut entities = self.entities();
        entities.of(kind).insert(endpoint);
        self.announcement.set(cdr::encode(&entities.info()));
    }

    pub(super) fn remove(&self, kind: Kind, endpoint: Guid) {
        let mut entities = self.entities();
        entities.of(kind).remove(&endpoint);
        self.announcement.set(cdr::encode(&entities.info()));
    }

    /// A panic elsewhere leaves the sets whole: each change is one call.
    fn entities(&self) -> MutexGuard<'_, Entities> {
        self.entities.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Entities {
    fn of(&mut self, kind: Kind) -> &mut BTreeSet<Guid> {
        match kind {
            Kind::Reader => &mut self.readers,
            Kind::Writer => &mut self.writers,
        }
    }

    fn info(&self) -> ParticipantEntitiesInfo {
        let text =
            |text: &str| Bounded::new(text.to_owned()).expect("node names are at most 255 bytes, namespaces 247");
        let node = NodeEntitiesInfo {
            node_namespace: text(self.name.namespace()),
            node_name: text(self.name.name()),
            reader_gid_seq: self.readers.iter().map(|guid| (*guid).into()).collect(),
            writer_gid_seq: self.writers.iter().map(|guid| (*guid).into()).collect(),
        };
        ParticipantEntitiesInfo { gid: self.participant.into(), node_entities_info_seq: vec![node] }
    }
}

//! The node in the ROS graph: `ros_discovery_info` says which DDS endpoints belong to which node.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use lineshaft_msgs::foreign::rmw_dds_common::msg::{NodeEntitiesInfo, ParticipantEntitiesInfo};
use lineshaft_msgs::{Bounded, Message, cdr};
use tokio::runtime::Handle;

use super::dds::DdsError;
use super::latched::{Beside, Latched};
use super::member::Shared;
use crate::link::guid::Guid;
use crate::link::protocol::Join;
use crate::link::qos::Qos;

/// The only ROS topic without a prefix.
const TOPIC: &str = "ros_discovery_info";
/// Endpoints that are made or dropped within this time are announced together.
const GATHER: Duration = Duration::from_millis(10);

/// Announces the endpoints of a node whenever one comes or goes.
pub(super) struct Graph {
    entities: Entities,
    announcement: Latched,
}

struct Entities {
    participant: Guid,
    namespace: String,
    name: String,
    readers: BTreeSet<Guid>,
    writers: BTreeSet<Guid>,
}

impl Graph {
    /// Announces the node, which has no endpoints yet.
    pub(super) fn new(runtime: &Handle, shared: &Arc<Shared>, join: &Join) -> Result<Self, DdsError> {
        let writer = shared.participant.writer(TOPIC, ParticipantEntitiesInfo::DDS_NAME, Qos::STATUS)?;
        let target = Beside { writer, shared: Arc::clone(shared) };
        let announcement = Latched::start(runtime, target, &shared.matches, Qos::STATUS, GATHER);
        let entities = Entities {
            participant: shared.participant.guid(),
            namespace: join.namespace.clone(),
            name: join.name.clone(),
            readers: BTreeSet::new(),
            writers: BTreeSet::new(),
        };
        announcement.set(cdr::encode(&entities.info()));
        Ok(Self { entities, announcement })
    }

    pub(super) fn add(&mut self, endpoint: Guid) {
        self.entities.of(endpoint).insert(endpoint);
        self.announcement.set(cdr::encode(&self.entities.info()));
    }

    pub(super) fn remove(&mut self, endpoint: Guid) {
        self.entities.of(endpoint).remove(&endpoint);
        self.announcement.set(cdr::encode(&self.entities.info()));
    }
}

impl Entities {
    fn of(&mut self, endpoint: Guid) -> &mut BTreeSet<Guid> {
        if endpoint.is_reader() { &mut self.readers } else { &mut self.writers }
    }

    fn info(&self) -> ParticipantEntitiesInfo {
        let text =
            |text: &str| Bounded::new(text.to_owned()).expect("node names are at most 255 bytes, namespaces 247");
        let node = NodeEntitiesInfo {
            node_namespace: text(&self.namespace),
            node_name: text(&self.name),
            reader_gid_seq: self.readers.iter().map(|guid| (*guid).into()).collect(),
            writer_gid_seq: self.writers.iter().map(|guid| (*guid).into()).collect(),
        };
        ParticipantEntitiesInfo { gid: self.participant.into(), node_entities_info_seq: vec![node] }
    }
}

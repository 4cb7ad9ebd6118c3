//! The node in the ROS graph: `ros_discovery_info` publishes the nodes of each participant, and the DDS endpoints of each node.

use std::collections::{BTreeSet, HashSet};
use std::sync::{Arc, Weak};
use std::time::Duration;

use bytes::Bytes;
use lineshaft_msgs::cdr::DecodeError;
use lineshaft_msgs::foreign::rmw_dds_common::msg::{NodeEntitiesInfo, ParticipantEntitiesInfo};
use lineshaft_msgs::{Bounded, cdr};
use tokio::runtime::Handle;

use super::dds::{DdsError, Reader, Taken};
use super::dds_names::{DdsTopic, nodes};
use super::guid::Guid;
use super::latched::{DirectedWriter, Latched};
use super::member::Shared;
use crate::link::protocol::Join;
use crate::link::qos::Qos;

/// Maximum number of participants with a node of the same name that are reported.
const NAMESAKES: usize = 100;
/// Time until the program reports a successor, which has the same node.
const SUCCESSOR: Duration = Duration::from_millis(500);
/// Endpoints that are created or dropped within this time are announced together.
const GATHER: Duration = Duration::from_millis(10);

/// Announces the endpoints of a node whenever one is created or dropped.
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
        let DdsTopic { name, type_name, hash } = nodes();
        let writer = shared.participant.writer(&name, &type_name, Qos::STATUS)?;
        shared.hashes.add(writer.guid(), &hash);
        let target = DirectedWriter { writer, shared: Arc::clone(shared) };
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

    /// Returns a reader of the nodes of other participants.
    pub(super) fn others(shared: &Shared) -> Result<Reader, DdsError> {
        let qos = Qos { depth: 100, ..Qos::STATUS };
        let DdsTopic { name, type_name, hash } = nodes();
        let reader = shared.participant.reader(&name, &type_name, qos)?;
        shared.hashes.add(reader.guid(), &hash);
        Ok(reader)
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

/// Logs a warning, once for each participant, if it has a node of the same name: neither tools nor clients can distinguish the two nodes.
pub(super) async fn watch_for_namesakes(mut infos: Reader, shared: Weak<Shared>, namespace: String, name: String) {
    let mut told = HashSet::new();
    loop {
        let Ok(taken) = infos.next().await else { continue };
        let participant = taken.id.writer.prefix();
        // An invalid message is a fault of its sender, and is ignored.
        let Ok(info) = info(&taken) else { continue };
        let is_own = || shared.upgrade().is_none_or(|shared| shared.is_own(participant));
        if is_own() || told.contains(&participant) || told.len() >= NAMESAKES || !is_among(&info, &namespace, &name) {
            continue;
        }
        tokio::time::sleep(SUCCESSOR).await;
        if !is_own() {
            told.insert(participant);
            let slash = if namespace.ends_with('/') { "" } else { "/" };
            tracing::warn!(
                "participant {participant} has a node {namespace}{slash}{name}, too: clients reach either of the two; give one of \
                 them another name (`lineshaft run CELL --ros-args -r __node:=NAME`)"
            );
        }
    }
}

fn info(taken: &Taken) -> Result<ParticipantEntitiesInfo, DecodeError> {
    cdr::decode(&taken.bytes, taken.endian())
}

/// Returns the full names of the nodes of a participant, as a list in little-endian CDR.
pub(super) fn names(taken: &Taken) -> Result<Bytes, DecodeError> {
    let nodes = info(taken)?.node_entities_info_seq;
    let name = |node: &NodeEntitiesInfo| format!("{}/{}", node.node_namespace.trim_end_matches('/'), *node.node_name);
    Ok(cdr::encode(&nodes.iter().map(name).collect::<Vec<_>>()).into())
}

fn is_among(info: &ParticipantEntitiesInfo, namespace: &str, name: &str) -> bool {
    let mut nodes = info.node_entities_info_seq.iter();
    nodes.any(|node| *node.node_namespace == *namespace && *node.node_name == *name)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::protocol::SampleId;
    use lineshaft_msgs::cdr::Endian;

    #[test]
    fn full_name_is_namespace_and_name() {
        let node = |namespace: &str, name: &str| NodeEntitiesInfo {
            node_namespace: Bounded::new(namespace.to_owned()).unwrap(),
            node_name: Bounded::new(name.to_owned()).unwrap(),
            ..NodeEntitiesInfo::default()
        };
        let info = ParticipantEntitiesInfo {
            node_entities_info_seq: vec![node("/", "lineshaft"), node("/cell/a", "n")],
            ..ParticipantEntitiesInfo::default()
        };
        let (id, bytes) = (SampleId { writer: Guid([1; 16]), number: 1 }, cdr::encode(&info).into());
        let taken = Taken { id, related: None, written: None, is_big_endian: false, bytes };
        let names: Vec<String> = cdr::decode(&names(&taken).unwrap(), Endian::Little).unwrap();
        assert_eq!(names, ["/lineshaft", "/cell/a/n"]);
    }
}

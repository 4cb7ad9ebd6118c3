//! Names of the nodes in the ROS graph.

use std::collections::{BTreeSet, HashMap};

use futures::FutureExt;
use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::rmw_dds_common::msg::ParticipantEntitiesInfo;

use crate::layer::endpoint::Context;
use crate::link::Reader;
use crate::link::guid::Prefix;
use crate::link::protocol::{Sample, WireType};
use crate::link::qos::Qos;

/// The only ROS topic without a prefix: each participant publishes its nodes there.
const TOPIC: &str = "ros_discovery_info";
/// Maximum number of participants whose nodes are stored.
const MOST: usize = 1000;

/// Collects the names of all nodes, from the time at which it was created.
pub struct NodeNames {
    infos: Reader,
    known: HashMap<Prefix, Vec<String>>,
}

impl NodeNames {
    pub(in crate::layer) fn new(context: &Context) -> Self {
        let qos = Qos { depth: 100, ..Qos::STATUS };
        let wire = WireType::message::<ParticipantEntitiesInfo>();
        Self { infos: context.reader(TOPIC, wire, qos), known: HashMap::new() }
    }

    /// Returns the full names that were received so far, in ascending order. Nodes that have left meanwhile are still among them.
    pub fn so_far(&mut self) -> BTreeSet<String> {
        while let Some(taken) = self.infos.next().now_or_never() {
            if let Ok(sample) = taken {
                self.enter(&sample);
            }
        }
        self.known.values().flatten().cloned().collect()
    }

    fn enter(&mut self, sample: &Sample) {
        let participant = sample.id.writer.prefix();
        if self.known.len() >= MOST && !self.known.contains_key(&participant) {
            return;
        }
        // An invalid message is a fault of its sender, and is ignored.
        if let Ok(info) = cdr::decode::<ParticipantEntitiesInfo>(&sample.bytes, sample.endian()) {
            self.known.insert(participant, names(&info));
        }
    }
}

fn names(info: &ParticipantEntitiesInfo) -> Vec<String> {
    let nodes = info.node_entities_info_seq.iter();
    nodes.map(|node| format!("{}/{}", node.node_namespace.trim_end_matches('/'), *node.node_name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_msgs::Bounded;
    use lineshaft_msgs::foreign::rmw_dds_common::msg::NodeEntitiesInfo;

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
        assert_eq!(names(&info), ["/lineshaft", "/cell/a/n"]);
    }
}

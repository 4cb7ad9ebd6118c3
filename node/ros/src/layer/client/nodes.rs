//! Names of the nodes in the ROS graph.

use std::collections::{BTreeSet, HashMap};

use futures::FutureExt;

use crate::layer::endpoint::Context;
use crate::link::Reader;
use crate::link::protocol::{EndpointKind, ParticipantId, Sample, WireType};
use crate::link::qos::Qos;

/// Maximum number of participants whose nodes are stored.
const MOST: usize = 1000;

/// Collects the names of all nodes, from the time at which it was created.
pub struct NodeNames {
    infos: Reader,
    known: HashMap<ParticipantId, Vec<String>>,
}

impl NodeNames {
    pub(in crate::layer) fn new(context: &Context) -> Self {
        let qos = Qos { depth: 100, ..Qos::STATUS };
        let (_, infos) = context.opener.open(EndpointKind::Nodes, String::new(), WireType::default(), qos);
        Self { infos, known: HashMap::new() }
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
        if self.known.len() >= MOST && !self.known.contains_key(&sample.sender) {
            return;
        }
        // An invalid message is a fault of its sender, and is ignored.
        if let Ok(names) = sample.decode() {
            self.known.insert(sample.sender, names);
        }
    }
}

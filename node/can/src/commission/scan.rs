//! Scan of a bus for nodes.
//!
//! Law      nodes are queried in parallel; a new one starts after each `gap`. A scan of an empty bus therefore takes little longer than one
//!          SDO timeout. A node that answers is asked for its identity. Heartbeats are received meanwhile, for `least` at least
//! Reads    1000h, 1018h, 1008h
//! Refuses  nothing: a node that does not answer is absent, unless it sends a heartbeat or boot-up message
//! Source   CiA 301

use super::session::{CommissionError, Session};
use crate::sdo::Client;
use crate::{NmtState, NodeId};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_cia402::sdo::{SdoError, Transfer};
use lineshaft_cia402::texts::{number, text};
use std::thread;
use std::time::Duration;

/// Bytes of the longest name, with room for a whole last segment.
const NAME_CAPACITY: usize = 256 + 7;
/// Time between two polls of the bus.
const POLL_PERIOD: Duration = Duration::from_micros(200);
/// Objects that are read, in this order.
const ASKED: [Object; 6] = [
    objects::DEVICE_TYPE,
    objects::VENDOR,
    objects::PRODUCT,
    objects::REVISION,
    objects::SERIAL,
    Object { index: 0x1008, sub: 0 },
];

/// Settings of a scan.
#[derive(Clone, Copy, Debug)]
pub struct Scan {
    /// First node.
    pub from: NodeId,
    /// Last node.
    pub to: NodeId,
    /// Time between the first requests to two nodes.
    pub gap: Duration,
    /// Minimum time for receiving heartbeats.
    pub least: Duration,
}

/// Node that was found. A value that it does not report is `None`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundNode {
    /// Node ID.
    pub node: NodeId,
    /// NMT state, if the node has reported it.
    pub state: Option<NmtState>,
    /// Device type (1000h); the profile in its lower half.
    pub device_type: Option<u32>,
    /// Vendor, product code, revision number, serial number (1018h).
    pub identity: [Option<u32>; 4],
    /// Device name (1008h).
    pub name: Option<String>,
    /// Whether the node answers SDO requests.
    pub answers: bool,
}

/// Node that is being queried.
struct Asked {
    found: FoundNode,
    client: Client,
    /// Place in [`ASKED`] of the object that is read next.
    next: usize,
    begins: Duration,
}

impl Asked {
    fn is_finished(&self) -> bool {
        self.next >= ASKED.len() && self.client.is_idle()
    }

    /// Starts to read the next object.
    fn start_next_read(&mut self, now_ns: u64) {
        if self.client.is_idle()
            && let Some(object) = ASKED.get(self.next)
        {
            // The client is idle and accepts the transfer.
            drop(self.client.upload(*object, Vec::with_capacity(NAME_CAPACITY), false, now_ns));
            self.next += 1;
        }
    }

    fn handle_result(&mut self, Transfer { object, data, result }: Transfer) {
        match result {
            // There is no node, or it no longer answers.
            Err(SdoError::Silent(..)) => self.next = ASKED.len(),
            Err(_) => self.found.answers = true,
            Ok(()) => {
                self.found.answers = true;
                match object.index {
                    0x1000 => self.found.device_type = number(&data),
                    0x1018 => {
                        if let Some(place) = self.found.identity.get_mut(usize::from(object.sub).wrapping_sub(1)) {
                            *place = number(&data);
                        }
                    }
                    _ => self.found.name = Some(text(&data)),
                }
            }
        }
    }
}

impl Session {
    /// Scans the bus. Calls `progress` with the number of finished nodes and the total number.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn scan(
        &mut self,
        scan: Scan,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Vec<FoundNode>, CommissionError> {
        let began = self.elapsed();
        let nodes = (scan.from.get()..=scan.to.get()).filter_map(NodeId::new);
        let mut all: Vec<Asked> = (0_u32..)
            .zip(nodes)
            .map(|(place, node)| Asked {
                found: FoundNode {
                    node,
                    state: None,
                    device_type: None,
                    identity: [None; 4],
                    name: None,
                    answers: false,
                },
                client: Client::new(node.sdo_request(), node.sdo_response(), self.timeout_ns()),
                next: 0,
                begins: began + scan.gap * place,
            })
            .collect();
        loop {
            let now_ns = self.now_ns();
            for asked in all.iter_mut().filter(|asked| Duration::from_nanos(now_ns) >= asked.begins) {
                if let Some(done) = asked.client.tick(now_ns) {
                    asked.handle_result(done);
                }
                if asked.is_finished() {
                    continue;
                }
                asked.start_next_read(now_ns);
                while let Some(frame) = asked.client.next_frame() {
                    self.send(&frame)?;
                }
            }
            let frame = self.receive()?;
            if let Some(frame) = &frame {
                let now_ns = self.now_ns();
                let of = all.iter_mut().find(|asked| asked.found.node.sdo_response() == frame.id());
                if let Some(asked) = of
                    && let Some(done) = asked.client.receive(frame, now_ns)
                {
                    asked.handle_result(done);
                }
            }
            let done = all.iter().filter(|asked| asked.is_finished()).count();
            progress(done, all.len());
            if done == all.len() && self.elapsed() - began >= scan.least {
                break;
            }
            if frame.is_none() {
                thread::sleep(POLL_PERIOD);
            }
        }
        let found = all.into_iter().map(|asked| FoundNode { state: self.state(asked.found.node), ..asked.found });
        Ok(found.filter(|found| found.answers || found.state.is_some()).collect())
    }
}

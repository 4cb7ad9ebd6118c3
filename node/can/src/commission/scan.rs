//! Who is on a bus.
//!
//! Law      all nodes are asked beside each other, one new one per `gap`, so that a bus without anybody takes hardly longer than one
//!          answer may; whoever answers is asked for the rest. Signs of life are heard meanwhile, for `least` at least
//! Reads    1000h, 1018h, 1008h
//! Refuses  nothing: a node that is silent is not there, unless it shows that it lives
//! Source   CiA 301

use super::session::{CommissionError, Session};
use super::words::{number, text};
use crate::drive::objects;
use crate::sdo::{Client, Object, SdoError, Transfer};
use crate::{NmtState, NodeId};
use std::thread;
use std::time::Duration;

/// Bytes of the longest name.
const ROOM: usize = 256 + 7;
/// Between two looks at the bus.
const LOOK: Duration = Duration::from_micros(200);
/// What is asked, in this order.
const ASKED: [Object; 6] = [
    objects::DEVICE_TYPE,
    objects::VENDOR,
    objects::PRODUCT,
    objects::REVISION,
    objects::SERIAL,
    Object { index: 0x1008, sub: 0 },
];

/// How a bus is scanned.
#[derive(Clone, Copy, Debug)]
pub struct Scan {
    /// First node.
    pub from: NodeId,
    /// Last node.
    pub to: NodeId,
    /// From one node that is asked for the first time to the next.
    pub gap: Duration,
    /// How long signs of life are listened for.
    pub least: Duration,
}

/// A node that is there. What it does not tell is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Which one.
    pub node: NodeId,
    /// The state that it has shown.
    pub state: Option<NmtState>,
    /// Device type (1000h); the profile in its lower half.
    pub device_type: Option<u32>,
    /// Vendor, product code, revision number, serial number (1018h).
    pub identity: [Option<u32>; 4],
    /// Its name (1008h).
    pub name: Option<String>,
    /// Does it answer at all?
    pub answers: bool,
}

/// A node that is asked.
struct Asked {
    found: Found,
    client: Client,
    /// Which of the objects comes next.
    next: usize,
    begins: Duration,
}

impl Asked {
    fn is_over(&self) -> bool {
        self.next >= ASKED.len() && self.client.is_idle()
    }

    /// Begins with the next object.
    fn go_on(&mut self, now_ns: u64) {
        if self.client.is_idle()
            && let Some(object) = ASKED.get(self.next)
        {
            // It is idle, and takes it.
            drop(self.client.upload(*object, Vec::with_capacity(ROOM), false, now_ns));
            self.next += 1;
        }
    }

    fn take(&mut self, Transfer { object, data, result }: Transfer) {
        match result {
            // Nobody there, or nobody any more.
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
    /// Looks who is there; `progress` is told how many nodes are done, of how many.
    ///
    /// # Errors
    /// The way is lost.
    pub fn scan(&mut self, scan: Scan, progress: &mut dyn FnMut(usize, usize)) -> Result<Vec<Found>, CommissionError> {
        let began = self.elapsed();
        let nodes = (scan.from.get()..=scan.to.get()).filter_map(NodeId::new);
        let mut all: Vec<Asked> = (0_u32..)
            .zip(nodes)
            .map(|(place, node)| Asked {
                found: Found { node, state: None, device_type: None, identity: [None; 4], name: None, answers: false },
                client: Client::new(node.sdo_request(), node.sdo_response(), self.timeout_ns()),
                next: 0,
                begins: began + scan.gap * place,
            })
            .collect();
        loop {
            let now_ns = self.now_ns();
            for asked in all.iter_mut().filter(|asked| Duration::from_nanos(now_ns) >= asked.begins) {
                if let Some(done) = asked.client.tick(now_ns) {
                    asked.take(done);
                }
                if asked.is_over() {
                    continue;
                }
                asked.go_on(now_ns);
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
                    asked.take(done);
                }
            }
            let done = all.iter().filter(|asked| asked.is_over()).count();
            progress(done, all.len());
            if done == all.len() && self.elapsed() - began >= scan.least {
                break;
            }
            if frame.is_none() {
                thread::sleep(LOOK);
            }
        }
        let found = all.into_iter().map(|asked| Found { state: self.state(asked.found.node), ..asked.found });
        Ok(found.filter(|found| found.answers || found.state.is_some()).collect())
    }
}

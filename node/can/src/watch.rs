//! Monitoring of a device: error control (CiA 301).
//!
//! Law      heartbeat: the device reports its state by itself. It is lost if it is silent for longer than the heartbeat time, counted from
//!          its first heartbeat. Node guarding: the master sends a remote frame, and the device answers with a toggle bit that alternates,
//!          starting at 0 after its boot-up. It is lost if it gives no valid answer for guard time times life time factor, counted from the
//!          first request. A lost device is back with its next valid sign of life. If the first heartbeat never arrives, the device is not
//!          monitored; this is reported once, when the heartbeat time after its start has passed
//! Reads    frames on 700h + node, the time
//! Writes   the remote frames for node guarding
//! Source   CiA 301, MACS-CAN-06

use crate::{Frame, NmtState, NodeId, SignOfLife};

/// Kind of monitoring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Monitoring {
    /// Only the boot-up message is evaluated.
    None,
    /// The device sends heartbeats, at least one in this time.
    Heartbeat {
        /// Time, in ns.
        time_ns: u64,
    },
    /// The master requests an answer (node guarding).
    Guarding {
        /// Time between two requests, in ns (100Ch).
        guard_ns: u64,
        /// Number of requests without a valid answer after which the device is lost (100Dh).
        life_factor: u8,
    },
}

/// Event of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceEvent {
    /// The device has booted and lost its configuration.
    BootedUp,
    /// The device reports another state.
    State(NmtState),
    /// The device is silent.
    Lost,
    /// The device was started, but its first heartbeat did not arrive: it is not monitored.
    NeverHeard,
    /// The device is back, in this state.
    Back(NmtState),
}

/// Monitoring of one device.
#[derive(Clone, Copy, Debug)]
pub struct Monitor {
    node: NodeId,
    how: Monitoring,
    state: Option<NmtState>,
    is_lost: bool,
    /// Time of the last sign of life; for node guarding, the first request counts as well.
    heard_ns: Option<u64>,
    /// Time of the last request.
    asked_ns: Option<u64>,
    /// Expected toggle bit of the next answer.
    toggle: bool,
    /// Time of the start, before the first heartbeat.
    began_ns: Option<u64>,
    /// Whether the missing first heartbeat was reported.
    is_told: bool,
}

impl Monitor {
    /// Creates the monitoring of a device that has not sent anything.
    pub fn new(node: NodeId, how: Monitoring) -> Self {
        Self {
            node,
            how,
            state: None,
            is_lost: false,
            heard_ns: None,
            asked_ns: None,
            toggle: false,
            began_ns: None,
            is_told: false,
        }
    }

    /// Records that the device was configured and started: heartbeats are expected from now on.
    pub fn begin(&mut self, now_ns: u64) {
        self.began_ns = Some(now_ns);
    }

    /// Returns the last reported state; `None` before the first one, and if the device is lost.
    pub fn state(&self) -> Option<NmtState> {
        self.state.filter(|_| !self.is_lost)
    }

    /// Returns true if the device has been silent for too long.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Handles a frame on 700h + node.
    pub fn handle_frame(&mut self, frame: &Frame, now_ns: u64) -> Option<DeviceEvent> {
        let life = SignOfLife::of(frame).filter(|_| frame.id() == self.node.heartbeat())?;
        // A boot-up message has no toggle bit.
        if life.state == NmtState::BootUp && !life.toggle {
            *self = Self { state: Some(NmtState::BootUp), heard_ns: Some(now_ns), ..Self::new(self.node, self.how) };
            return Some(DeviceEvent::BootedUp);
        }
        if matches!(self.how, Monitoring::Guarding { .. }) {
            // An answer with the wrong toggle bit is ignored. After a loss, the toggle sequence starts again.
            if life.toggle != self.toggle && !self.is_lost {
                return None;
            }
            self.toggle = !life.toggle;
        }
        let (before, was_lost) = (self.state.replace(life.state), std::mem::replace(&mut self.is_lost, false));
        self.heard_ns = Some(now_ns);
        match () {
            () if was_lost => Some(DeviceEvent::Back(life.state)),
            () if before != Some(life.state) => Some(DeviceEvent::State(life.state)),
            () => None,
        }
    }

    /// Handles timeouts. Returns an event, and the guarding request that is due.
    pub fn tick(&mut self, now_ns: u64) -> (Option<DeviceEvent>, Option<Frame>) {
        let since = |then: Option<u64>| then.map(|then| now_ns.saturating_sub(then));
        match self.how {
            Monitoring::None => (None, None),
            Monitoring::Heartbeat { time_ns } => {
                let is_late = since(self.heard_ns).is_some_and(|silent| silent > time_ns);
                let is_missing = self.heard_ns.is_none() && since(self.began_ns).is_some_and(|silent| silent > time_ns);
                let is_new = is_missing && !self.is_told;
                self.is_told |= is_missing;
                (self.mark_lost_if(is_late).or(is_new.then_some(DeviceEvent::NeverHeard)), None)
            }
            Monitoring::Guarding { guard_ns, life_factor } => {
                let life_ns = guard_ns.saturating_mul(life_factor.into());
                let is_late = self.asked_ns.is_some() && since(self.heard_ns).is_some_and(|silent| silent > life_ns);
                let lost = self.mark_lost_if(is_late);
                if since(self.asked_ns).is_some_and(|waited| waited < guard_ns) {
                    return (lost, None);
                }
                if self.asked_ns.is_none() {
                    self.heard_ns = Some(now_ns);
                }
                self.asked_ns = Some(now_ns);
                (lost, Frame::remote(self.node.heartbeat(), 1).ok())
            }
        }
    }

    fn mark_lost_if(&mut self, is_late: bool) -> Option<DeviceEvent> {
        let is_new = is_late && !self.is_lost;
        self.is_lost |= is_late;
        is_new.then_some(DeviceEvent::Lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn node() -> NodeId {
        NodeId::new(9).unwrap()
    }

    fn life(byte: u8) -> Frame {
        Frame::data(node().heartbeat(), &[byte]).unwrap()
    }

    #[test]
    fn missing_heartbeat_is_loss_and_next_one_ends_it() {
        let mut watch = Monitor::new(node(), Monitoring::Heartbeat { time_ns: 100 * MS });
        assert_eq!(watch.tick(10_000 * MS), (None, None), "not before the first one");
        assert_eq!(watch.handle_frame(&life(0x7F), 0), Some(DeviceEvent::State(NmtState::PreOperational)));
        assert_eq!(watch.handle_frame(&life(0x05), 50 * MS), Some(DeviceEvent::State(NmtState::Operational)));
        assert_eq!(watch.handle_frame(&life(0x05), 100 * MS), None);
        assert_eq!(watch.tick(200 * MS).0, None, "100 ms are allowed");
        assert_eq!(watch.tick(200 * MS + 1).0, Some(DeviceEvent::Lost));
        assert_eq!((watch.tick(300 * MS).0, watch.state()), (None, None), "told once");
        assert_eq!(watch.handle_frame(&life(0x05), 301 * MS), Some(DeviceEvent::Back(NmtState::Operational)));
        assert_eq!(watch.state(), Some(NmtState::Operational));
    }

    /// Reported once, 100 ms after the start. A heartbeat that arrives later is monitored normally, and a boot-up message is a sign of
    /// life.
    #[test]
    fn missing_first_heartbeat_is_reported_once() {
        let mut watch = Monitor::new(node(), Monitoring::Heartbeat { time_ns: 100 * MS });
        assert_eq!(watch.tick(10_000 * MS).0, None, "it was not started");
        watch.begin(10_000 * MS);
        assert_eq!(watch.tick(10_100 * MS).0, None, "100 ms are allowed");
        assert_eq!(watch.tick(10_100 * MS + 1).0, Some(DeviceEvent::NeverHeard));
        assert_eq!((watch.tick(20_000 * MS).0, watch.is_lost()), (None, false), "reported once; it takes part");
        watch.begin(20_000 * MS);
        assert_eq!(watch.tick(30_000 * MS).0, None, "reported once, however often it is started");
        assert_eq!(watch.handle_frame(&life(0x05), 30_001 * MS), Some(DeviceEvent::State(NmtState::Operational)));
        assert_eq!(watch.tick(30_102 * MS).0, Some(DeviceEvent::Lost));
        // A device that sends heartbeats, or has another kind of monitoring, is not reported.
        let mut heard = Monitor::new(node(), Monitoring::Heartbeat { time_ns: 100 * MS });
        heard.begin(0);
        heard.handle_frame(&life(0x05), 50 * MS);
        assert_eq!(heard.tick(150 * MS).0, None);
        let mut unwatched = Monitor::new(node(), Monitoring::None);
        unwatched.begin(0);
        assert_eq!(unwatched.tick(10_000 * MS).0, None);
    }

    #[test]
    fn boot_up_is_always_reported() {
        let mut watch = Monitor::new(node(), Monitoring::Heartbeat { time_ns: 100 * MS });
        watch.handle_frame(&life(0x05), 0);
        assert_eq!(watch.handle_frame(&life(0x00), 10 * MS), Some(DeviceEvent::BootedUp));
        assert_eq!(watch.handle_frame(&life(0x00), 20 * MS), Some(DeviceEvent::BootedUp), "it has booted twice");
        assert_eq!(watch.handle_frame(&life(0x7F), 30 * MS), Some(DeviceEvent::State(NmtState::PreOperational)));
        let other = Frame::data(NodeId::new(8).unwrap().heartbeat(), &[0]).unwrap();
        assert_eq!(watch.handle_frame(&other, 40 * MS), None);
    }

    /// 100Ch = 100 ms, 100Dh = 3: lost after 300 ms without a valid answer.
    #[test]
    fn guarding_requests_periodically_and_checks_toggle_bit() {
        let mut watch = Monitor::new(node(), Monitoring::Guarding { guard_ns: 100 * MS, life_factor: 3 });
        let question = Frame::remote(node().heartbeat(), 1).ok();
        assert_eq!(watch.tick(0), (None, question));
        assert_eq!(watch.tick(99 * MS), (None, None));
        assert_eq!(watch.handle_frame(&life(0x05), MS), Some(DeviceEvent::State(NmtState::Operational)));
        assert_eq!(watch.tick(100 * MS), (None, question));
        assert_eq!(watch.handle_frame(&life(0x85), 101 * MS), None);
        for ms in [200, 300, 400] {
            assert_eq!(watch.tick(ms * MS), (None, question));
            assert_eq!(watch.handle_frame(&life(0x85), (ms + 1) * MS), None, "the toggle does not alternate");
        }
        assert_eq!(watch.tick(401 * MS + 1).0, Some(DeviceEvent::Lost));
        assert_eq!(watch.handle_frame(&life(0x85), 402 * MS), Some(DeviceEvent::Back(NmtState::Operational)));
        assert_eq!(watch.handle_frame(&life(0x05), 502 * MS), None);
        assert_eq!(watch.state(), Some(NmtState::Operational));
    }

    /// The life time starts with the first request: a device that never answers is lost.
    #[test]
    fn a_device_that_never_answers_is_lost() {
        let mut watch = Monitor::new(node(), Monitoring::Guarding { guard_ns: 100 * MS, life_factor: 2 });
        assert!(watch.tick(5 * MS).1.is_some());
        assert_eq!(watch.tick(205 * MS).0, None);
        assert_eq!(watch.tick(206 * MS).0, Some(DeviceEvent::Lost));
        // After a boot-up the toggle bit starts at 0.
        assert_eq!(watch.handle_frame(&life(0x00), 300 * MS), Some(DeviceEvent::BootedUp));
        assert!(watch.tick(301 * MS).1.is_some());
        assert_eq!(watch.handle_frame(&life(0x7F), 302 * MS), Some(DeviceEvent::State(NmtState::PreOperational)));
    }
}

//! Watching that a device is there (CiA 301, error control).
//!
//! Law      heartbeat: the device tells its state by itself, and is lost once it has been silent for longer than its time; that begins with
//!          the first one. Guarding: it is asked by a remote frame and answers with a toggle that alternates, from 0 on after its
//!          boot-up; it is lost once it has not answered rightly for the guard time times the life time factor, from the first question on.
//!          One that is lost is back with its next right sign of life. One whose first heartbeat never comes is not watched: that is
//!          reported once, its time after it was started
//! Reads    frames on 700h + node, the time
//! Writes   the remote frames that guard
//! Source   CiA 301, MACS-CAN-06

use crate::{Frame, Life, NmtState, NodeId};

/// How a device is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watching {
    /// Only its boot-up is heard.
    None,
    /// It sends heartbeats, at least one in this time (ns).
    Heartbeat {
        /// (ns)
        time_ns: u64,
    },
    /// It is asked.
    Guarding {
        /// From one question to the next (ns); 100Ch.
        guard_ns: u64,
        /// Questions without a right answer until it is lost; 100Dh.
        life_factor: u8,
    },
}

/// What has become of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Happened {
    /// It has booted: nothing that it was told before holds.
    BootedUp,
    /// It shows another state.
    State(NmtState),
    /// It is silent.
    Lost,
    /// It was started and its first heartbeat does not come: nothing watches it.
    NeverHeard,
    /// It is there again, in this state.
    Back(NmtState),
}

/// The watch of one device.
#[derive(Clone, Copy, Debug)]
pub struct Watch {
    node: NodeId,
    how: Watching,
    state: Option<NmtState>,
    is_lost: bool,
    /// When it was heard last; of guarding the first question counts as well.
    heard_ns: Option<u64>,
    /// When it was asked last.
    asked_ns: Option<u64>,
    /// Toggle of its next answer.
    toggle: bool,
    /// When it was started, before its first heartbeat.
    began_ns: Option<u64>,
    /// It was reported that its first heartbeat does not come.
    is_told: bool,
}

impl Watch {
    /// A device that has not been heard.
    pub fn new(node: NodeId, how: Watching) -> Self {
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

    /// It was configured and started: heartbeats come from now on.
    pub fn begin(&mut self, now_ns: u64) {
        self.began_ns = Some(now_ns);
    }

    /// The state that it has shown last; none before the first one, and of one that is lost.
    pub fn state(&self) -> Option<NmtState> {
        self.state.filter(|_| !self.is_lost)
    }

    /// Is it silent for longer than it may be?
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Takes a frame on 700h + node.
    pub fn hear(&mut self, frame: &Frame, now_ns: u64) -> Option<Happened> {
        let life = Life::of(frame).filter(|_| frame.id() == self.node.heartbeat())?;
        // A boot-up message has no toggle.
        if life.state == NmtState::BootUp && !life.toggle {
            *self = Self { state: Some(NmtState::BootUp), heard_ns: Some(now_ns), ..Self::new(self.node, self.how) };
            return Some(Happened::BootedUp);
        }
        if matches!(self.how, Watching::Guarding { .. }) {
            // A wrong toggle is a lost answer, and what comes behind a loss begins anew.
            if life.toggle != self.toggle && !self.is_lost {
                return None;
            }
            self.toggle = !life.toggle;
        }
        let (before, was_lost) = (self.state.replace(life.state), std::mem::replace(&mut self.is_lost, false));
        self.heard_ns = Some(now_ns);
        match () {
            () if was_lost => Some(Happened::Back(life.state)),
            () if before != Some(life.state) => Some(Happened::State(life.state)),
            () => None,
        }
    }

    /// What time has done, and the question that is due.
    pub fn tick(&mut self, now_ns: u64) -> (Option<Happened>, Option<Frame>) {
        let since = |then: Option<u64>| then.map(|then| now_ns.saturating_sub(then));
        match self.how {
            Watching::None => (None, None),
            Watching::Heartbeat { time_ns } => {
                let is_late = since(self.heard_ns).is_some_and(|silent| silent > time_ns);
                let is_missing = self.heard_ns.is_none() && since(self.began_ns).is_some_and(|silent| silent > time_ns);
                let is_new = is_missing && !self.is_told;
                self.is_told |= is_missing;
                (self.lose_if(is_late).or(is_new.then_some(Happened::NeverHeard)), None)
            }
            Watching::Guarding { guard_ns, life_factor } => {
                let life_ns = guard_ns.saturating_mul(life_factor.into());
                let is_late = self.asked_ns.is_some() && since(self.heard_ns).is_some_and(|silent| silent > life_ns);
                let lost = self.lose_if(is_late);
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

    fn lose_if(&mut self, is_late: bool) -> Option<Happened> {
        let is_new = is_late && !self.is_lost;
        self.is_lost |= is_late;
        is_new.then_some(Happened::Lost)
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
    fn a_heartbeat_that_stays_away_is_a_loss_and_the_next_one_ends_it() {
        let mut watch = Watch::new(node(), Watching::Heartbeat { time_ns: 100 * MS });
        assert_eq!(watch.tick(10_000 * MS), (None, None), "not before the first one");
        assert_eq!(watch.hear(&life(0x7F), 0), Some(Happened::State(NmtState::PreOperational)));
        assert_eq!(watch.hear(&life(0x05), 50 * MS), Some(Happened::State(NmtState::Operational)));
        assert_eq!(watch.hear(&life(0x05), 100 * MS), None);
        assert_eq!(watch.tick(200 * MS).0, None, "100 ms are allowed");
        assert_eq!(watch.tick(200 * MS + 1).0, Some(Happened::Lost));
        assert_eq!((watch.tick(300 * MS).0, watch.state()), (None, None), "told once");
        assert_eq!(watch.hear(&life(0x05), 301 * MS), Some(Happened::Back(NmtState::Operational)));
        assert_eq!(watch.state(), Some(NmtState::Operational));
    }

    /// 100 ms after the start, once; the first one that comes is watched as ever, and a boot-up is a sign of life.
    #[test]
    fn heartbeats_that_never_come_are_told_once() {
        let mut watch = Watch::new(node(), Watching::Heartbeat { time_ns: 100 * MS });
        assert_eq!(watch.tick(10_000 * MS).0, None, "it was not started");
        watch.begin(10_000 * MS);
        assert_eq!(watch.tick(10_100 * MS).0, None, "100 ms are allowed");
        assert_eq!(watch.tick(10_100 * MS + 1).0, Some(Happened::NeverHeard));
        assert_eq!((watch.tick(20_000 * MS).0, watch.is_lost()), (None, false), "reported once; it takes part");
        watch.begin(20_000 * MS);
        assert_eq!(watch.tick(30_000 * MS).0, None, "reported once, however often it is started");
        assert_eq!(watch.hear(&life(0x05), 30_001 * MS), Some(Happened::State(NmtState::Operational)));
        assert_eq!(watch.tick(30_102 * MS).0, Some(Happened::Lost));
        // A device that sends them, or is watched otherwise, is not reported.
        let mut heard = Watch::new(node(), Watching::Heartbeat { time_ns: 100 * MS });
        heard.begin(0);
        heard.hear(&life(0x05), 50 * MS);
        assert_eq!(heard.tick(150 * MS).0, None);
        let mut unwatched = Watch::new(node(), Watching::None);
        unwatched.begin(0);
        assert_eq!(unwatched.tick(10_000 * MS).0, None);
    }

    #[test]
    fn a_boot_up_is_always_told() {
        let mut watch = Watch::new(node(), Watching::Heartbeat { time_ns: 100 * MS });
        watch.hear(&life(0x05), 0);
        assert_eq!(watch.hear(&life(0x00), 10 * MS), Some(Happened::BootedUp));
        assert_eq!(watch.hear(&life(0x00), 20 * MS), Some(Happened::BootedUp), "it has booted twice");
        assert_eq!(watch.hear(&life(0x7F), 30 * MS), Some(Happened::State(NmtState::PreOperational)));
        let other = Frame::data(NodeId::new(8).unwrap().heartbeat(), &[0]).unwrap();
        assert_eq!(watch.hear(&other, 40 * MS), None);
    }

    /// 100Ch = 100 ms, 100Dh = 3: lost after 300 ms without a right answer.
    #[test]
    fn guarding_asks_in_its_time_and_wants_a_toggle() {
        let mut watch = Watch::new(node(), Watching::Guarding { guard_ns: 100 * MS, life_factor: 3 });
        let question = Frame::remote(node().heartbeat(), 1).ok();
        assert_eq!(watch.tick(0), (None, question));
        assert_eq!(watch.tick(99 * MS), (None, None));
        assert_eq!(watch.hear(&life(0x05), MS), Some(Happened::State(NmtState::Operational)));
        assert_eq!(watch.tick(100 * MS), (None, question));
        assert_eq!(watch.hear(&life(0x85), 101 * MS), None);
        for ms in [200, 300, 400] {
            assert_eq!(watch.tick(ms * MS), (None, question));
            assert_eq!(watch.hear(&life(0x85), (ms + 1) * MS), None, "the toggle does not alternate");
        }
        assert_eq!(watch.tick(401 * MS + 1).0, Some(Happened::Lost));
        assert_eq!(watch.hear(&life(0x85), 402 * MS), Some(Happened::Back(NmtState::Operational)));
        assert_eq!(watch.hear(&life(0x05), 502 * MS), None);
        assert_eq!(watch.state(), Some(NmtState::Operational));
    }

    /// The life time begins with the first question: one that never answers is lost.
    #[test]
    fn a_device_that_never_answers_is_lost() {
        let mut watch = Watch::new(node(), Watching::Guarding { guard_ns: 100 * MS, life_factor: 2 });
        assert!(watch.tick(5 * MS).1.is_some());
        assert_eq!(watch.tick(205 * MS).0, None);
        assert_eq!(watch.tick(206 * MS).0, Some(Happened::Lost));
        // After its boot-up the toggle begins with 0.
        assert_eq!(watch.hear(&life(0x00), 300 * MS), Some(Happened::BootedUp));
        assert!(watch.tick(301 * MS).1.is_some());
        assert_eq!(watch.hear(&life(0x7F), 302 * MS), Some(Happened::State(NmtState::PreOperational)));
    }
}

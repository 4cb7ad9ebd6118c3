//! Error control of a simulated drive: its own heartbeat, and monitoring of its master.
//!
//! Law      a heartbeat is sent every 1017h ms; without it, node guarding is answered with a toggle bit that starts at 0. The master is
//!          lost if its heartbeat is missing for the time of 1016h, or if it does not guard within 100Ch times 100Dh; each is monitored
//!          from its first message
//! Reads    100Ch, 100Dh, 1016h, 1017h, the time
//! Source   CiA 301 (error control)

use crate::can_objects;
use crate::{Id, NodeId};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::simulate::ObjectTable;
use std::time::Duration;

/// Deadlines and toggle bit of error control.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Supervision {
    next_heartbeat: Option<Duration>,
    /// Deadline for the heartbeat of the master; `None` before the first one.
    master_until: Option<Duration>,
    /// Deadline for the next guarding request of the master; `None` before the first one.
    guard_until: Option<Duration>,
    toggle: bool,
}

/// Returns the heartbeat time of the drive; `None` if it sends none.
fn heartbeat(table: &ObjectTable) -> Option<Duration> {
    let ms = table.get(can_objects::PRODUCER_HEARTBEAT);
    (ms > 0).then_some(Duration::from_millis(ms.into()))
}

/// Returns the identifier and the time of the monitored heartbeat; `None` if none is monitored.
fn monitored_heartbeat(table: &ObjectTable) -> Option<(Id, Duration)> {
    let [low, high, node, _] = table.get(can_objects::CONSUMER_HEARTBEAT).to_le_bytes();
    let ms = u16::from_le_bytes([low, high]);
    let node = NodeId::new(node).filter(|_| ms > 0)?;
    Some((node.heartbeat(), Duration::from_millis(ms.into())))
}

impl Supervision {
    /// Updates the deadlines after an object was written.
    pub(super) fn update_deadlines(&mut self, object: Object, table: &ObjectTable, now: Duration) {
        match object {
            can_objects::PRODUCER_HEARTBEAT => self.next_heartbeat = heartbeat(table).map(|time| now + time),
            can_objects::CONSUMER_HEARTBEAT => self.master_until = None,
            can_objects::GUARD_TIME | can_objects::LIFE_TIME_FACTOR => self.guard_until = None,
            _ => {}
        }
    }

    /// Handles a guarding request of the master. Returns the toggle bit of the answer; `None` if the drive sends heartbeats instead.
    pub(super) fn guard(&mut self, table: &ObjectTable, now: Duration) -> Option<u8> {
        if table.get(can_objects::PRODUCER_HEARTBEAT) != 0 {
            return None;
        }
        let life = u64::from(table.get(can_objects::GUARD_TIME)) * u64::from(table.get(can_objects::LIFE_TIME_FACTOR));
        self.guard_until = (life > 0).then_some(now + Duration::from_millis(life));
        let toggle = if self.toggle { 0x80 } else { 0 };
        self.toggle = !self.toggle;
        Some(toggle)
    }

    /// Returns true if a frame is the monitored heartbeat.
    pub(super) fn is_monitored_heartbeat(&mut self, id: Id, table: &ObjectTable, now: Duration) -> bool {
        let Some((master, limit)) = monitored_heartbeat(table) else { return false };
        if id == master {
            self.master_until = Some(now + limit);
        }
        id == master
    }

    /// Returns true if a heartbeat of the drive is due. Missed heartbeats are not made up for.
    pub(super) fn is_due(&mut self, table: &ObjectTable, now: Duration) -> bool {
        let (Some(due), Some(time)) = (self.next_heartbeat, heartbeat(table)) else { return false };
        if now < due {
            return false;
        }
        let next = due + time;
        self.next_heartbeat = Some(if next > now { next } else { now + time });
        true
    }

    /// Returns true once when the master is lost.
    pub(super) fn has_lost_master(&mut self, now: Duration) -> bool {
        let is_over = |until: &mut Option<Duration>| until.take_if(|until| now >= *until).is_some();
        let lost = [is_over(&mut self.master_until), is_over(&mut self.guard_until)];
        lost.contains(&true)
    }
}

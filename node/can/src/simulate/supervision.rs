//! Error control of a simulated drive: its own heartbeat, and whether its master is still there.
//!
//! Law      a heartbeat goes every 1017h ms; without it, guarding is answered with a toggle bit, from 0 on. The master is lost when its heartbeat
//!          is missing for the time of 1016h, or when it does not guard within 100Ch times 100Dh; each from the first time on
//! Reads    100Ch, 100Dh, 1016h, 1017h, the time
//! Source   CiA 301 (error control)

use super::table::Table;
use crate::drive::objects;
use crate::sdo::Object;
use crate::{Id, NodeId};
use std::time::Duration;

/// Times and toggle bit of the error control.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Supervision {
    next_heartbeat: Option<Duration>,
    /// Until when the heartbeat of the master must come; none before the first one.
    master_until: Option<Duration>,
    /// Until when the master must guard again; none before the first time.
    guard_until: Option<Duration>,
    toggle: bool,
}

/// From one heartbeat of the drive to the next; none if it sends none.
fn heartbeat(table: &Table) -> Option<Duration> {
    let ms = table.get(objects::PRODUCER_HEARTBEAT);
    (ms > 0).then_some(Duration::from_millis(ms.into()))
}

/// The identifier of the heartbeat that the drive watches, and within which time it must come; none if it watches none.
fn consumed(table: &Table) -> Option<(Id, Duration)> {
    let [low, high, node, _] = table.get(objects::CONSUMER_HEARTBEAT).to_le_bytes();
    let ms = u16::from_le_bytes([low, high]);
    let node = NodeId::new(node).filter(|_| ms > 0)?;
    Some((node.heartbeat(), Duration::from_millis(ms.into())))
}

impl Supervision {
    /// An object was written.
    pub(super) fn written(&mut self, object: Object, table: &Table, now: Duration) {
        match object {
            objects::PRODUCER_HEARTBEAT => self.next_heartbeat = heartbeat(table).map(|time| now + time),
            objects::CONSUMER_HEARTBEAT => self.master_until = None,
            objects::GUARD_TIME | objects::LIFE_TIME_FACTOR => self.guard_until = None,
            _ => {}
        }
    }

    /// The master guards. Returns the toggle bit of the answer; none if the drive sends heartbeats instead.
    pub(super) fn guard(&mut self, table: &Table, now: Duration) -> Option<u8> {
        if table.get(objects::PRODUCER_HEARTBEAT) != 0 {
            return None;
        }
        let life = u64::from(table.get(objects::GUARD_TIME)) * u64::from(table.get(objects::LIFE_TIME_FACTOR));
        self.guard_until = (life > 0).then_some(now + Duration::from_millis(life));
        let toggle = if self.toggle { 0x80 } else { 0 };
        self.toggle = !self.toggle;
        Some(toggle)
    }

    /// Returns true if a frame is the heartbeat that the drive watches.
    pub(super) fn hear(&mut self, id: Id, table: &Table, now: Duration) -> bool {
        let Some((master, limit)) = consumed(table) else { return false };
        if id == master {
            self.master_until = Some(now + limit);
        }
        id == master
    }

    /// Returns true if a heartbeat of the drive is due. One that is late is not made up for.
    pub(super) fn is_due(&mut self, table: &Table, now: Duration) -> bool {
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

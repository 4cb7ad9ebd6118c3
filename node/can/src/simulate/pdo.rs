//! PDOs of a simulated drive, as its dictionary describes them.
//!
//! Law      transmission types 1 to 240: with each n-th SYNC; 0: with a SYNC after a change; 254 and 255: at once after a change
//! Source   CiA 301 (objects 1400h to 1BFFh)

use super::table::{MOST_MAPPED, mapped};
use crate::eds::CobId;
use crate::layout::MOST_PDOS;
use crate::{Frame, Id};
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::simulate::ObjectTable;

/// Highest synchronous transmission type.
const LAST_SYNCHRONOUS: u8 = 240;

/// Enabled PDO.
#[derive(Clone, Debug)]
pub(super) struct Pdo {
    pub(super) id: Id,
    /// Transmission type.
    kind: u8,
    /// Mapped objects with their number of bytes.
    fields: Vec<(Object, u8)>,
    /// Received frame that applies with the next SYNC.
    pending: Option<Frame>,
    /// Last sent frame.
    last: Option<Frame>,
    /// Number of SYNCs since the last frame.
    syncs: u8,
}

impl Pdo {
    /// Returns the enabled PDOs of a direction.
    pub(super) fn all(table: &ObjectTable, direction: Direction) -> Vec<Self> {
        (1..=MOST_PDOS).filter_map(|number| Self::of(table, direction, number)).collect()
    }

    fn of(table: &ObjectTable, direction: Direction, number: u8) -> Option<Self> {
        let (communication, mapping) = (direction.communication(number), direction.mapping(number));
        let value = |index, sub| table.get(Object { index, sub });
        let cob_id = CobId(value(communication, 1));
        if !cob_id.is_valid() || cob_id.is_extended() {
            return None;
        }
        let id = Id::new(u16::try_from(cob_id.id()).ok()?).ok()?;
        let count = value(mapping, 0).min(MOST_MAPPED.into()) as u8;
        let fields = (1..=count).map(|sub| mapped(value(mapping, sub))).collect();
        Some(Self { id, kind: value(communication, 2) as u8, fields, pending: None, last: None, syncs: 0 })
    }

    fn is_synchronous(&self) -> bool {
        self.kind <= LAST_SYNCHRONOUS
    }

    fn frame(&self, table: &ObjectTable) -> Option<Frame> {
        let bytes = |&(object, bytes): &(Object, u8)| table.get(object).to_le_bytes().into_iter().take(bytes.into());
        let data: Vec<u8> = self.fields.iter().flat_map(bytes).collect();
        Frame::data(self.id, &data).ok()
    }

    /// Returns the frame to be sent with this SYNC, if any.
    pub(super) fn with_sync(&mut self, table: &ObjectTable) -> Option<Frame> {
        if !self.is_synchronous() {
            return None;
        }
        if self.kind == 0 {
            return self.if_changed(table);
        }
        self.syncs = self.syncs.saturating_add(1);
        if self.syncs < self.kind {
            return None;
        }
        self.syncs = 0;
        self.last = self.frame(table);
        self.last
    }

    /// Returns the frame to be sent at once, if any.
    pub(super) fn on_change(&mut self, table: &ObjectTable) -> Option<Frame> {
        if self.is_synchronous() { None } else { self.if_changed(table) }
    }

    fn if_changed(&mut self, table: &ObjectTable) -> Option<Frame> {
        let frame = self.frame(table).filter(|frame| self.last != Some(*frame))?;
        self.last = Some(frame);
        Some(frame)
    }

    /// Handles a received frame, which applies at once or with the next SYNC.
    pub(super) fn receive(&mut self, frame: &Frame, table: &mut ObjectTable) {
        if self.is_synchronous() { self.pending = Some(*frame) } else { self.apply(frame, table) }
    }

    /// Applies the frame that waited for SYNC.
    pub(super) fn apply_pending(&mut self, table: &mut ObjectTable) {
        if let Some(frame) = self.pending.take() {
            self.apply(&frame, table);
        }
    }

    /// Applies a frame; a frame that is too short changes nothing.
    fn apply(&self, frame: &Frame, table: &mut ObjectTable) {
        let needed: usize = self.fields.iter().map(|(_, bytes)| usize::from(*bytes)).sum();
        let mut left = frame.bytes();
        if left.len() < needed {
            return;
        }
        for (object, bytes) in &self.fields {
            let (data, rest) = left.split_at(usize::from(*bytes));
            table.receive(*object, data.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte)));
            left = rest;
        }
    }
}

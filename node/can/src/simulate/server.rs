//! The SDO server of a simulated drive: expedited transfers, as all of its objects have up to 4 bytes.
//!
//! Refuses  segmented and block transfers
//! Source   CiA 301

use super::table::Table;
use crate::sdo::{Abort, Object};
use crate::{Frame, Id};

/// Answers a request; returns the frame, and the object if it was written. No request has no answer: another length, or an abort.
pub(super) fn answer(table: &mut Table, request: &Frame, response: Id) -> Option<(Frame, Option<Object>)> {
    let &[command, low, high, sub, a, b, c, d] = request.bytes() else { return None };
    let object = Object { index: u16::from_le_bytes([low, high]), sub };
    let written = |done: Result<(), Abort>| done.map(|()| ([0x60, low, high, sub, 0, 0, 0, 0], Some(object)));
    let done = match command >> 5 {
        // Bit 1: expedited. Bit 0: bits 2 and 3 are the number of unused bytes.
        1 if command & 0x02 != 0 => {
            let bytes = (command & 0x01 != 0).then_some(4 - (command >> 2 & 0x03));
            written(table.write(object, u32::from_le_bytes([a, b, c, d]), bytes))
        }
        // In segments: more bytes than any object has.
        1 => Err(Abort::LENGTH),
        2 => table.read(object).map(|(value, bytes)| {
            let [a, b, c, d] = value.to_le_bytes();
            ([0x43 | (4 - bytes) << 2, low, high, sub, a, b, c, d], None)
        }),
        4 => return None,
        _ => Err(Abort::COMMAND),
    };
    let (data, object) = done.unwrap_or_else(|Abort(code)| {
        let [a, b, c, d] = code.to_le_bytes();
        ([0x80, low, high, sub, a, b, c, d], None)
    });
    Some((Frame::of(response, data), object))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::DeviceConfig;
    use crate::drive::objects;
    use crate::{NodeId, Watching};

    /// The bytes of the answer.
    fn answered(table: &mut Table, request: [u8; 8]) -> Option<Vec<u8>> {
        let node = NodeId::new(3).unwrap();
        let (frame, _) = answer(table, &Frame::of(node.sdo_request(), request), node.sdo_response())?;
        assert_eq!(frame.id().get(), 0x583);
        Some(frame.bytes().to_vec())
    }

    /// Frames of CiA 301, expedited transfers.
    #[test]
    fn requests_of_up_to_4_bytes_are_answered_in_one_frame() {
        let device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Watching::None);
        let mut table = Table::new(&device, device.drive().unwrap());
        let mut ask = |request| answered(&mut table, request);
        assert_eq!(ask([0x40, 0x00, 0x10, 0, 0, 0, 0, 0]), Some(vec![0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00]));
        // 2 bytes: 2Bh. They are read back by 4Bh.
        assert_eq!(ask([0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0]), Some(vec![0x60, 0x17, 0x10, 0, 0, 0, 0, 0]));
        assert_eq!(ask([0x40, 0x17, 0x10, 0, 0, 0, 0, 0]), Some(vec![0x4B, 0x17, 0x10, 0, 0x64, 0, 0, 0]));
        // 1 byte, and without a length.
        assert_eq!(ask([0x2F, 0x60, 0x60, 0, 8, 0, 0, 0]), Some(vec![0x60, 0x60, 0x60, 0, 0, 0, 0, 0]));
        assert_eq!(ask([0x22, 0x60, 0x60, 0, 6, 0, 0, 0]), Some(vec![0x60, 0x60, 0x60, 0, 0, 0, 0, 0]));
        // Missing object; in segments; an unknown command; the client ends its transfer.
        assert_eq!(ask([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]), Some(vec![0x80, 0x08, 0x10, 0, 0, 0, 0x02, 0x06]));
        assert_eq!(ask([0x21, 0x60, 0x60, 0, 9, 0, 0, 0]), Some(vec![0x80, 0x60, 0x60, 0, 0x10, 0, 0x07, 0x06]));
        assert_eq!(ask([0xE0, 0x60, 0x60, 0, 0, 0, 0, 0]), Some(vec![0x80, 0x60, 0x60, 0, 0x01, 0, 0x04, 0x05]));
        assert_eq!(ask([0x80, 0x60, 0x60, 0, 0, 0, 0, 0]), None);
        assert_eq!(table.signed(objects::MODE), 6);
    }
}

//! SDO server of a simulated drive: expedited transfers of 1 to 4 bytes, segmented transfers for more.
//!
//! Law      one transfer at a time; a new request ends the previous one
//! Refuses  block transfers; segments without a transfer, or with a repeated toggle bit; lengths other than that of the object
//! Source   CiA 301

use crate::{Frame, Id};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::Abort;
use lineshaft_cia402::simulate::ObjectTable;

/// Bytes of a segment.
const SEGMENT: usize = 7;

/// Segmented transfer. The toggle bit is that of the next segment.
#[derive(Clone, Debug)]
enum Transfer {
    /// Upload: the bytes from `at` are still to be sent.
    Upload { object: Object, data: Vec<u8>, at: usize, toggle: bool },
    /// Download: the bytes received so far.
    Download { object: Object, data: Vec<u8>, toggle: bool },
}

/// SDO server of one drive.
#[derive(Clone, Debug, Default)]
pub(super) struct Server {
    transfer: Option<Transfer>,
}

/// Bytes of an answer, and the object if it was written.
type Answer = Result<([u8; 8], Option<Object>), Abort>;

impl Server {
    /// Handles a request. Returns the answer, and the object if it was written. A frame of another length, or an abort, has no answer.
    pub(super) fn answer(
        &mut self,
        table: &mut ObjectTable,
        request: &Frame,
        response: Id,
    ) -> Option<(Frame, Option<Object>)> {
        let bytes: [u8; 8] = request.bytes().try_into().ok()?;
        let [command, low, high, sub, ..] = bytes;
        let named = Object { index: u16::from_le_bytes([low, high]), sub };
        let (object, done) = match command >> 5 {
            0 => (self.object(), self.handle_download_segment(table, bytes)),
            1 => (named, self.begin_download(table, named, bytes)),
            2 => (named, self.begin_upload(table, named, [low, high, sub])),
            3 => (self.object(), self.next_upload_segment(command)),
            4 => {
                self.transfer = None;
                return None;
            }
            _ => (named, Err(Abort::COMMAND)),
        };
        let (data, written) = done.unwrap_or_else(|Abort(code)| {
            self.transfer = None;
            let ([low, high], [a, b, c, d]) = (object.index.to_le_bytes(), code.to_le_bytes());
            ([0x80, low, high, object.sub, a, b, c, d], None)
        });
        Some((Frame::of(response, data), written))
    }

    /// Returns the object of the transfer in progress; 0 if there is none.
    fn object(&self) -> Object {
        match self.transfer {
            Some(Transfer::Upload { object, .. } | Transfer::Download { object, .. }) => object,
            None => Object { index: 0, sub: 0 },
        }
    }

    fn begin_download(
        &mut self,
        table: &mut ObjectTable,
        object: Object,
        [command, low, high, sub, a, b, c, d]: [u8; 8],
    ) -> Answer {
        self.transfer = None;
        let answer = [0x60, low, high, sub, 0, 0, 0, 0];
        let (value, has_size) = (u32::from_le_bytes([a, b, c, d]), command & 0x01 != 0);
        // Bit 1: expedited; bits 2 and 3 are the number of unused bytes.
        if command & 0x02 != 0 {
            table.write(object, value, has_size.then_some(4 - (command >> 2 & 0x03)))?;
            return Ok((answer, Some(object)));
        }
        let room = table.writable_length(object)?;
        if has_size && value as usize != room {
            return Err(Abort::LENGTH);
        }
        self.transfer = Some(Transfer::Download { object, data: Vec::new(), toggle: false });
        Ok((answer, None))
    }

    /// Handles a segment of a download.
    fn handle_download_segment(&mut self, table: &mut ObjectTable, [command, segment @ ..]: [u8; 8]) -> Answer {
        let Some(Transfer::Download { object, data, toggle }) = &mut self.transfer else { return Err(Abort::COMMAND) };
        if (command & 0x10 != 0) != *toggle {
            return Err(Abort::TOGGLE);
        }
        *toggle = !*toggle;
        let object = *object;
        let unused = usize::from(command >> 1 & 0x07);
        data.extend(segment.into_iter().take(SEGMENT - unused));
        if data.len() > table.writable_length(object)? {
            return Err(Abort::LENGTH);
        }
        let answer = [0x20 | command & 0x10, 0, 0, 0, 0, 0, 0, 0];
        if command & 0x01 == 0 {
            return Ok((answer, None));
        }
        table.write_bytes(object, data)?;
        self.transfer = None;
        Ok((answer, Some(object)))
    }

    fn begin_upload(&mut self, table: &ObjectTable, object: Object, [low, high, sub]: [u8; 3]) -> Answer {
        self.transfer = None;
        let data = table.read_bytes(object)?;
        if (1..=4).contains(&data.len()) {
            let unused = 4 - data.len() as u8;
            let [a, b, c, d] = padded::<4>(&data);
            return Ok(([0x43 | unused << 2, low, high, sub, a, b, c, d], None));
        }
        let [a, b, c, d] = u32::try_from(data.len()).unwrap_or(u32::MAX).to_le_bytes();
        self.transfer = Some(Transfer::Upload { object, data, at: 0, toggle: false });
        Ok(([0x41, low, high, sub, a, b, c, d], None))
    }

    /// Returns the next segment of an upload.
    fn next_upload_segment(&mut self, command: u8) -> Answer {
        let Some(Transfer::Upload { data, at, toggle, .. }) = &mut self.transfer else { return Err(Abort::COMMAND) };
        if (command & 0x10 != 0) != *toggle {
            return Err(Abort::TOGGLE);
        }
        let rest = data.get(*at..).unwrap_or_default();
        let (count, is_last) = (rest.len().min(SEGMENT), rest.len() <= SEGMENT);
        let [a, b, c, d, e, f, g] = padded::<SEGMENT>(rest);
        let unused = (SEGMENT - count) as u8;
        *at += count;
        *toggle = !*toggle;
        if is_last {
            self.transfer = None;
        }
        Ok(([command & 0x10 | unused << 1 | u8::from(is_last), a, b, c, d, e, f, g], None))
    }
}

/// Returns the first bytes, padded with zeros.
fn padded<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut all = [0; N];
    for (place, byte) in all.iter_mut().zip(bytes) {
        *place = *byte;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::table::objects_of;
    use super::*;
    use crate::config::DeviceConfig;
    use crate::{Monitoring, NodeId};
    use lineshaft_cia402::config::Write;
    use lineshaft_cia402::objects;

    /// Returns the objects of a drive with an object of 10 bytes.
    fn table() -> ObjectTable {
        let mut device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Monitoring::None);
        device.startup = vec![Write { object: Object { index: 0x2001, sub: 0 }, data: vec![0; 10] }];
        objects_of(&device, device.drive().unwrap())
    }

    /// Returns the bytes of the answer.
    fn answered(server: &mut Server, table: &mut ObjectTable, request: [u8; 8]) -> Option<Vec<u8>> {
        let node = NodeId::new(3).unwrap();
        let (frame, _) = server.answer(table, &Frame::of(node.sdo_request(), request), node.sdo_response())?;
        assert_eq!(frame.id().get(), 0x583);
        Some(frame.bytes().to_vec())
    }

    /// Expedited transfers of CiA 301.
    #[test]
    fn requests_of_up_to_4_bytes_are_answered_in_one_frame() {
        let (mut server, mut table) = (Server::default(), table());
        let mut ask = |request| answered(&mut server, &mut table, request);
        assert_eq!(ask([0x40, 0x00, 0x10, 0, 0, 0, 0, 0]), Some(vec![0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00]));
        // 2 bytes: 2Bh. They are read with 4Bh.
        assert_eq!(ask([0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0]), Some(vec![0x60, 0x17, 0x10, 0, 0, 0, 0, 0]));
        assert_eq!(ask([0x40, 0x17, 0x10, 0, 0, 0, 0, 0]), Some(vec![0x4B, 0x17, 0x10, 0, 0x64, 0, 0, 0]));
        // 1 byte, with and without a length.
        assert_eq!(ask([0x2F, 0x60, 0x60, 0, 8, 0, 0, 0]), Some(vec![0x60, 0x60, 0x60, 0, 0, 0, 0, 0]));
        assert_eq!(ask([0x22, 0x60, 0x60, 0, 6, 0, 0, 0]), Some(vec![0x60, 0x60, 0x60, 0, 0, 0, 0, 0]));
        // Missing object; more bytes than the object has; unknown command; abort by the client.
        assert_eq!(ask([0x40, 0x07, 0x10, 0, 0, 0, 0, 0]), Some(vec![0x80, 0x07, 0x10, 0, 0, 0, 0x02, 0x06]));
        assert_eq!(ask([0x21, 0x60, 0x60, 0, 9, 0, 0, 0]), Some(vec![0x80, 0x60, 0x60, 0, 0x10, 0, 0x07, 0x06]));
        assert_eq!(ask([0xE0, 0x60, 0x60, 0, 0, 0, 0, 0]), Some(vec![0x80, 0x60, 0x60, 0, 0x01, 0, 0x04, 0x05]));
        assert_eq!(ask([0x80, 0x60, 0x60, 0, 0, 0, 0, 0]), None);
        assert_eq!(table.signed(objects::MODE), 6);
    }

    /// 1008h has 25 bytes: 41h with the size, then 7, 7, 7 and 4 bytes; bit 4 toggles, bits 1 to 3 are the unused bytes, bit 0 is the end.
    #[test]
    fn texts_are_read_in_segments() {
        let (mut server, mut table) = (Server::default(), table());
        let mut ask = |request| answered(&mut server, &mut table, request).unwrap();
        assert_eq!(ask([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]), [0x41, 0x08, 0x10, 0, 25, 0, 0, 0]);
        assert_eq!(ask([0x60, 0, 0, 0, 0, 0, 0, 0]), *b"\x00Linesha");
        assert_eq!(ask([0x70, 0, 0, 0, 0, 0, 0, 0]), *b"\x10ft simu");
        assert_eq!(ask([0x60, 0, 0, 0, 0, 0, 0, 0]), *b"\x00lated d");
        assert_eq!(ask([0x70, 0, 0, 0, 0, 0, 0, 0]), *b"\x17rive\0\0\0");
        // The transfer has ended, so the command is unknown. Then the same toggle bit twice.
        assert_eq!(ask([0x60, 0, 0, 0, 0, 0, 0, 0]), [0x80, 0, 0, 0, 0x01, 0, 0x04, 0x05]);
        ask([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]);
        ask([0x60, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(ask([0x60, 0, 0, 0, 0, 0, 0, 0]), [0x80, 0x08, 0x10, 0, 0, 0, 0x03, 0x05]);
    }

    /// 10 bytes to 2001h: 21h with the size, then 7 and 3 bytes. Texts are read-only.
    #[test]
    fn objects_of_more_than_4_bytes_are_written_in_segments() {
        let (mut server, mut table) = (Server::default(), table());
        let object = Object { index: 0x2001, sub: 0 };
        let mut ask = |request| answered(&mut server, &mut table, request).unwrap();
        assert_eq!(ask([0x21, 0x01, 0x20, 0, 10, 0, 0, 0]), [0x60, 0x01, 0x20, 0, 0, 0, 0, 0]);
        assert_eq!(ask([0x00, 1, 2, 3, 4, 5, 6, 7]), [0x20, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(ask([0x19, 8, 9, 10, 0, 0, 0, 0]), [0x30, 0, 0, 0, 0, 0, 0, 0]);
        let refused = |object: [u8; 3], code: u32| {
            let ([low, high, sub], [a, b, c, d]) = (object, code.to_le_bytes());
            vec![0x80, low, high, sub, a, b, c, d]
        };
        assert_eq!(ask([0x21, 0x01, 0x20, 0, 11, 0, 0, 0]), refused([0x01, 0x20, 0], 0x0607_0010), "11 bytes");
        assert_eq!(ask([0x21, 0x08, 0x10, 0, 25, 0, 0, 0]), refused([0x08, 0x10, 0], 0x0601_0002), "1008h");
        assert_eq!(ask([0x00, 1, 2, 3, 4, 5, 6, 7]), refused([0, 0, 0], 0x0504_0001), "no transfer");
        // Without a size, and with 4 bytes too few.
        ask([0x20, 0x01, 0x20, 0, 0, 0, 0, 0]);
        assert_eq!(ask([0x03, 1, 2, 3, 4, 5, 6, 0]), refused([0x01, 0x20, 0], 0x0607_0010));
        assert_eq!(table.read_bytes(object), Ok((1..=10).collect()));
    }
}

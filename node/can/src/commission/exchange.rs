//! Decodes SDO frames that were recorded from the bus.
//!
//! Law      one exchange for each node: segments belong to the object that was named last. Segments of a block have no command specifier of
//!          their own; they are recognized by the frames before them. If the beginning of an exchange was not received, its frames are
//!          decoded by their first byte
//! Source   CiA 301

use super::allowed::label;
use crate::eds::Dictionary;
use crate::{Frame, NodeId};
use lineshaft_cia402::dictionary::Value;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::Abort;
use lineshaft_cia402::texts::hex;

/// Side that sends the segments of the present block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Block {
    Client,
    Server,
}

/// SDO exchange of one node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Exchange {
    object: Option<Object>,
    block: Option<Block>,
    /// Sequence number of the last segment of the block transfer.
    last: Option<u8>,
}

impl Exchange {
    /// Returns the text of a frame of the client.
    pub(super) fn request(&mut self, node: NodeId, frame: &Frame, known: Option<&Dictionary>) -> String {
        let head = format!("SDO {}", node.get());
        let Ok(bytes) = <[u8; 8]>::try_from(frame.bytes()) else { return format!("{head} request of another length") };
        let [command, .., a, b, c, d] = bytes;
        let size = u32::from_le_bytes([a, b, c, d]);
        if self.block == Some(Block::Client) && command != 0x80 {
            return format!("{head} {}", self.segment(command, known));
        }
        let words = match command {
            0x20..=0x3F => {
                self.begin(bytes);
                let of = self.label(known);
                match value(command, &bytes) {
                    Some(data) => format!("writes {of} = {}", self.value(data, known)),
                    None => format!("begins to write {of}, {size} bytes"),
                }
            }
            0x00..=0x1F => {
                let (count, ends) = (7 - (command >> 1 & 7), if command & 1 == 1 { ", the last ones" } else { "" });
                format!("writes {count} bytes of {}{ends}", self.label(known))
            }
            0x40..=0x5F => {
                self.begin(bytes);
                format!("reads {}", self.label(known))
            }
            0x60..=0x7F => format!("asks for more of {}", self.label(known)),
            0x80 => self.abort(bytes, known),
            0xA1 => format!("has all of {}", self.label(known)),
            0xA2 => self.block_acknowledgement(bytes, Block::Server, known),
            0xA3 => {
                (self.block, self.last) = (Some(Block::Server), None);
                format!("asks for the blocks of {}", self.label(known))
            }
            0xA0..=0xBF => {
                self.begin(bytes);
                format!("reads {} in blocks", self.label(known))
            }
            0xC0..=0xDF if command & 1 == 0 => {
                self.begin(bytes);
                format!("begins to write {} in blocks, {size} bytes", self.label(known))
            }
            0xC0..=0xDF => format!("has written all blocks of {}", self.label(known)),
            _ => format!("request {command:02X}h, which is not known"),
        };
        format!("{head} {words}")
    }

    /// Returns the text of a frame of the server.
    pub(super) fn response(&mut self, node: NodeId, frame: &Frame, known: Option<&Dictionary>) -> String {
        let head = format!("SDO {}", node.get());
        let Ok(bytes) = <[u8; 8]>::try_from(frame.bytes()) else { return format!("{head} answer of another length") };
        let [command, .., a, b, c, d] = bytes;
        let size = u32::from_le_bytes([a, b, c, d]);
        if self.block == Some(Block::Server) && command != 0x80 {
            return format!("{head} {}", self.segment(command, known));
        }
        let words = match command {
            0x60..=0x7F => {
                self.name(bytes);
                format!("takes {}", self.label(known))
            }
            0x20..=0x3F => format!("takes the bytes of {}", self.label(known)),
            0x40..=0x5F => {
                self.name(bytes);
                let of = self.label(known);
                match value(command, &bytes) {
                    Some(data) => format!("tells {of} = {}", self.value(data, known)),
                    None => format!("tells that {of} has {size} bytes"),
                }
            }
            0x00..=0x1F => {
                let (count, ends) = (7 - (command >> 1 & 7), if command & 1 == 1 { ", the last ones" } else { "" });
                format!("tells {count} bytes of {}{ends}", self.label(known))
            }
            0x80 => self.abort(bytes, known),
            0xA1 => format!("has all of {}", self.label(known)),
            0xA2 => self.block_acknowledgement(bytes, Block::Client, known),
            0xA0..=0xBF => {
                self.name(bytes);
                (self.block, self.last) = (Some(Block::Client), None);
                format!("takes {} in blocks of {a} segments", self.label(known))
            }
            0xC0..=0xDF if command & 1 == 0 => {
                self.name(bytes);
                format!("tells that {} has {size} bytes, in blocks", self.label(known))
            }
            0xC0..=0xDF => format!("has told all blocks of {}", self.label(known)),
            _ => format!("answer {command:02X}h, which is not known"),
        };
        format!("{head} {words}")
    }

    fn begin(&mut self, bytes: [u8; 8]) {
        *self = Self::default();
        self.name(bytes);
    }

    fn name(&mut self, [_, low, high, sub, ..]: [u8; 8]) {
        self.object = Some(Object { index: u16::from_le_bytes([low, high]), sub });
    }

    fn label(&self, known: Option<&Dictionary>) -> String {
        self.object.map_or_else(|| "an object".to_owned(), |object| label(object, known))
    }

    /// Returns bytes as a value of the dictionary's type, otherwise in hexadecimal.
    fn value(&self, bytes: &[u8], known: Option<&Dictionary>) -> String {
        let entry = self.object.zip(known).and_then(|(object, known)| known.entry(object));
        let value = entry.and_then(|entry| Value::from_bytes(entry.data_type, bytes).ok());
        value.map_or_else(|| hex(bytes), |value| value.to_string())
    }

    fn segment(&mut self, lead: u8, known: Option<&Dictionary>) -> String {
        let (number, ends) = (lead & 0x7F, lead & 0x80 != 0);
        if ends {
            self.last = Some(number);
        }
        format!("segment {number} of a block of {}{}", self.label(known), if ends { ", the last one" } else { "" })
    }

    /// Handles the acknowledgement of a block. `sender` sends the next block, unless the transfer is complete.
    fn block_acknowledgement(
        &mut self,
        [_, sequence, ..]: [u8; 8],
        sender: Block,
        known: Option<&Dictionary>,
    ) -> String {
        self.block = (self.last != Some(sequence)).then_some(sender);
        self.last = None;
        format!("has {sequence} segments of a block of {}", self.label(known))
    }

    fn abort(&mut self, bytes: [u8; 8], known: Option<&Dictionary>) -> String {
        let [_, _, _, _, a, b, c, d] = bytes;
        self.begin(bytes);
        format!("ends {}: {}", self.label(known), Abort(u32::from_le_bytes([a, b, c, d])))
    }
}

/// Returns the data bytes of an expedited transfer.
fn value(command: u8, bytes: &[u8; 8]) -> Option<&[u8]> {
    let unused = if command & 1 == 1 { usize::from(command >> 2 & 3) } else { 0 };
    (command & 2 != 0).then(|| bytes.get(4..8 - unused)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eds;

    fn node() -> NodeId {
        NodeId::new(3).unwrap()
    }

    fn all(frames: &[(bool, [u8; 8])]) -> Vec<String> {
        let known = eds::parse(include_bytes!("../../../../launch-configs/can/cia402_sim.eds"), Some(3)).unwrap();
        let mut exchange = Exchange::default();
        let mut words = |(is_request, bytes): &(bool, [u8; 8])| match is_request {
            true => exchange.request(node(), &Frame::of(node().sdo_request(), *bytes), Some(&known)),
            false => exchange.response(node(), &Frame::of(node().sdo_response(), *bytes), Some(&known)),
        };
        frames.iter().map(&mut words).collect()
    }

    #[test]
    fn expedited_transfers_are_decoded_with_values() {
        let told = all(&[
            (true, [0x40, 0x64, 0x60, 0, 0, 0, 0, 0]),
            (false, [0x43, 0x64, 0x60, 0, 0xFE, 0xFF, 0xFF, 0xFF]),
            (true, [0x2F, 0x60, 0x60, 0, 8, 0, 0, 0]),
            (false, [0x60, 0x60, 0x60, 0, 0, 0, 0, 0]),
            (true, [0x2B, 0x41, 0x60, 0, 1, 0, 0, 0]),
            (false, [0x80, 0x41, 0x60, 0, 2, 0, 1, 6]),
        ]);
        let expected = [
            "SDO 3 reads 6064h:00 Position actual value",
            "SDO 3 tells 6064h:00 Position actual value = -2",
            "SDO 3 writes 6060h:00 Modes of operation = 8",
            "SDO 3 takes 6060h:00 Modes of operation",
            "SDO 3 writes 6041h:00 Statusword = 1",
            "SDO 3 ends 6041h:00 Statusword: the object can only be read (06010002h)",
        ];
        assert_eq!(told, expected);
    }

    /// The last segment with number 65 looks like the end of a transfer (C1h).
    #[test]
    fn block_segments_are_recognized_by_previous_frames() {
        let told = all(&[
            (true, [0xC6, 0x01, 0x20, 0, 10, 0, 0, 0]),
            (false, [0xA4, 0x01, 0x20, 0, 127, 0, 0, 0]),
            (true, [0x01, 1, 2, 3, 4, 5, 6, 7]),
            (true, [0xC1, 8, 9, 10, 0, 0, 0, 0]),
            (false, [0xA2, 0x41, 127, 0, 0, 0, 0, 0]),
            (true, [0xD1, 0, 0, 0, 0, 0, 0, 0]),
            (false, [0xA1, 0, 0, 0, 0, 0, 0, 0]),
        ]);
        let name = "2001h:00 Simulator echo string";
        let expected = [
            format!("SDO 3 begins to write {name} in blocks, 10 bytes"),
            format!("SDO 3 takes {name} in blocks of 127 segments"),
            format!("SDO 3 segment 1 of a block of {name}"),
            format!("SDO 3 segment 65 of a block of {name}, the last one"),
            format!("SDO 3 has 65 segments of a block of {name}"),
            format!("SDO 3 has written all blocks of {name}"),
            format!("SDO 3 has all of {name}"),
        ];
        assert_eq!(told, expected);
    }
}

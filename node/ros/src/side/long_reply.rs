//! Replies that exceed one datagram, with the identity of their request, in our own DATAFRAGs.
//!
//! The DDS library (0.15.1) writes one byte too many before the inline QoS of a DATAFRAG. So the library sends such a sample without
//! identity, and the same fragments with the identity are sent before. Fast DDS reads the identity of a sample from the first
//! fragment that it receives, and accepts the other fragments from any source. The library resends lost fragments.

use super::guid::Guid;
use super::rtps::{Message, SENTINEL, entity, number, parameter};
use crate::link::protocol::SampleId;

/// Fragment size of the library in bytes; both must use the same size.
const FRAGMENT: usize = 256;
/// Number of fragments in a datagram: at most 1.2 kB with all headers, which also fits into tunnels.
const TOGETHER: usize = 4;

/// A reply to one reader.
pub(super) struct LongReply<'a> {
    pub(super) writer: Guid,
    pub(super) reader: Guid,
    /// Sequence number that the writer will give to the sample.
    pub(super) number: i64,
    /// First sequence number of the GAP, which ends before `number`: 1, or the number after the last reply to this reader.
    pub(super) from: i64,
    /// Source timestamp in 2^-32 s since 1970.
    pub(super) time: u64,
    /// Identity of the request, by which the client identifies its reply.
    pub(super) answers: SampleId,
    /// CDR data without its encapsulation; the length is a multiple of 4 bytes.
    pub(super) bytes: &'a [u8],
}

impl LongReply<'_> {
    /// Returns the datagrams, which are sent to every address of the reader.
    pub(super) fn datagrams(&self) -> Vec<Vec<u8>> {
        let sample = [&[0, 1, 0, 0], self.bytes].concat();
        let identity = [self.answers.writer.0.as_slice(), &number(self.answers.number)].concat();
        // With both parameter IDs in use, as the library does in DATA.
        let mut inline = Vec::new();
        parameter(&mut inline, 0x0083, &identity);
        parameter(&mut inline, 0x800f, &identity);
        inline.extend(SENTINEL);
        let (reader, writer) = (entity(self.reader), entity(self.writer));
        let datagram = |(place, piece): (usize, &[u8])| {
            let mut message = Message::from(self.writer.prefix());
            message.time(self.time).to(self.reader.prefix());
            if self.from < self.number {
                message.gap(reader, writer, self.from, self.number);
            }
            let mut body = [&[0, 0, 28, 0], reader.as_slice(), &writer, &number(self.number)].concat();
            // A frame of the link is shorter than 2^32, so all these numbers fit.
            body.extend((1 + (place * TOGETHER) as u32).to_le_bytes());
            body.extend((piece.len().div_ceil(FRAGMENT) as u16).to_le_bytes());
            body.extend((FRAGMENT as u16).to_le_bytes());
            body.extend((sample.len() as u32).to_le_bytes());
            body.extend(&inline);
            body.extend(piece);
            message.submessage(0x16, 0b10, &body);
            message.bytes()
        };
        sample.chunks(TOGETHER * FRAGMENT).enumerate().map(datagram).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pieces_make_up_the_sample_and_pass_every_network() {
        let bytes: Vec<u8> = (0..10_000).map(|n| n as u8).collect();
        let answers = SampleId { writer: Guid([3; 16]), number: 9 };
        let (writer, reader) = (Guid([1; 16]), Guid([2; 16]));
        let reply = LongReply { writer, reader, number: 7, from: 3, time: 0, answers, bytes: &bytes };
        let (mut whole, mut fragments) = (Vec::new(), 0);
        for datagram in reply.datagrams() {
            assert!(datagram.len() <= 1252, "{}", datagram.len());
            // Header, INFO_TS, INFO_DST, GAP, and the header of the DATAFRAG; then the inline QoS.
            let at = 20 + 12 + 16 + 32;
            assert_eq!(datagram[at], 0x16);
            assert_eq!(u32::from_le_bytes(datagram[at + 24..at + 28].try_into().unwrap()), fragments + 1);
            fragments += u32::from(datagram[at + 28]);
            whole.extend(&datagram[at + 4 + 32 + 2 * 28 + 4..]);
        }
        assert_eq!((&whole[..4], &whole[4..], fragments), ([0, 1, 0, 0].as_slice(), bytes.as_slice(), 40));
    }
}

//! Replies longer than one datagram, with the identity of their request, in DATAFRAGs of our own.
//!
//! The DDS library (0.15.1) writes a byte too many before the inline QoS of a DATAFRAG. So it is given such a sample without
//! identity, and the same fragments with the identity go out before: Fast DDS takes the identity of a sample from the first
//! fragment that it gets, whoever brings the rest. The library repairs what gets lost.

use super::rtps::{Message, SENTINEL, entity, number, parameter};
use crate::link::guid::Guid;
use crate::link::protocol::SampleId;

/// Of the library; both must cut alike.
const FRAGMENT: usize = 256;
/// Fragments in a datagram: at most 1.2 kB with all headers, which tunnels pass too.
const TOGETHER: usize = 4;

/// A reply to one reader.
pub(super) struct LongReply<'a> {
    pub(super) writer: Guid,
    pub(super) reader: Guid,
    /// That the writer will give the sample.
    pub(super) number: i64,
    /// From here to `number` nothing was for the reader: 1, or what follows the last reply to it.
    pub(super) from: i64,
    /// 2^-32 s since 1970.
    pub(super) time: u64,
    /// By which the client knows its reply.
    pub(super) answers: SampleId,
    /// CDR without its encapsulation, a multiple of 4 long.
    pub(super) bytes: &'a [u8],
}

impl LongReply<'_> {
    /// What goes to every address of the reader.
    pub(super) fn datagrams(&self) -> Vec<Vec<u8>> {
        let sample = [&[0, 1, 0, 0], self.bytes].concat();
        let identity = [self.answers.writer.0.as_slice(), &number(self.answers.number)].concat();
        // Under both ids in use, as the library does in DATA.
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
            // A frame of the link is shorter than 2^32, so all of these fit.
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
            // Header, INFO_TS, INFO_DST, GAP, and the DATAFRAG's own header; then the inline QoS.
            let at = 20 + 12 + 16 + 32;
            assert_eq!(datagram[at], 0x16);
            assert_eq!(u32::from_le_bytes(datagram[at + 24..at + 28].try_into().unwrap()), fragments + 1);
            fragments += u32::from(datagram[at + 28]);
            whole.extend(&datagram[at + 4 + 32 + 2 * 28 + 4..]);
        }
        assert_eq!((&whole[..4], &whole[4..], fragments), ([0, 1, 0, 0].as_slice(), bytes.as_slice(), 40));
    }
}

//! Frames as ASCII lines for adapters on a serial line or behind TCP (slcan, Lawicel).
//!
//! Law      `tIIILDD..` is a data frame, `rIIIL` a remote frame, each ended by CR, in both directions. An adapter may append four
//!          hexadecimal digits of milliseconds to a received frame
//! Reads    bytes, in pieces of any size
//! Refuses  nothing: lines other than frames with an 11-bit identifier are ignored, as adapters answer a sent frame with `z`, with nothing,
//!          or with an empty line
//! Source   CANUSB manual (Lawicel), python-can 4.6 (`slcan`)

use crate::{Frame, Id};

/// End of a line, and answer to a successful command.
pub(super) const CR: u8 = b'\r';
/// Answer to a refused command.
pub(super) const BEL: u8 = 0x07;
/// Maximum length of a frame line: kind, 8 digits of an extended identifier, length, 8 bytes, time stamp.
const LONGEST: usize = 1 + 8 + 1 + 16 + 4;
/// Maximum length of a line of a frame with an 11-bit identifier, with its CR.
const LONGEST_SENT: usize = 1 + 3 + 1 + 16 + 1;

/// Bit rates, in kbit/s, with the digits of the adapters' commands. Digit 7 is that of the CANUSB manual; some firmware uses another rate
/// there. Digit 9 is in no manual and therefore has no row.
const BIT_RATES: [(u32, &[u8; 3]); 9] = [
    (10, b"S0\r"),
    (20, b"S1\r"),
    (50, b"S2\r"),
    (100, b"S3\r"),
    (125, b"S4\r"),
    (250, b"S5\r"),
    (500, b"S6\r"),
    (800, b"S7\r"),
    (1000, b"S8\r"),
];

/// Returns the command that sets a bit rate (kbit/s); `None` if adapters have no digit, or different ones, for it.
pub fn bit_rate(kbit_per_s: u32) -> Option<&'static [u8]> {
    let row = BIT_RATES.iter().find(|(rate, _)| *rate == kbit_per_s)?;
    Some(row.1)
}

/// Returns the bit rates that can be set, in kbit/s.
pub fn bit_rates() -> impl Iterator<Item = u32> {
    BIT_RATES.iter().map(|(rate, _)| *rate)
}

/// Command that closes the channel; an adapter whose channel is closed refuses it.
pub const CLOSE: &[u8] = b"C\r";
/// Command that opens the channel.
pub const OPEN: &[u8] = b"O\r";

/// Line of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    bytes: [u8; LONGEST_SENT],
    length: usize,
}

impl Line {
    /// Returns the line that sends a frame.
    pub fn of(frame: &Frame) -> Self {
        let mut line = Self { bytes: [0; LONGEST_SENT], length: 0 };
        let id = frame.id().get();
        line.push(if frame.is_remote() { b'r' } else { b't' });
        for digit in [id >> 8, id >> 4, id] {
            line.push(digit_of(digit as u8));
        }
        line.push(digit_of(frame.length()));
        for byte in frame.bytes() {
            line.push(digit_of(byte >> 4));
            line.push(digit_of(*byte));
        }
        line.push(CR);
        line
    }

    fn push(&mut self, byte: u8) {
        // A frame of 8 bytes fills the line.
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }

    /// Returns the bytes with the CR.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

fn digit_of(value: u8) -> u8 {
    b"0123456789ABCDEF"[usize::from(value & 0xF)]
}

fn value_of(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|value| value as u8)
}

/// Message of an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdapterMessage {
    /// Received frame.
    Frame(Frame),
    /// Refusal of the last command.
    Refused,
}

/// Decodes bytes to messages.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    line: [u8; LONGEST],
    length: usize,
    /// Whether the line is longer than any frame.
    is_too_long: bool,
}

impl Decoder {
    /// Handles a byte. Returns the message that it completes, if any.
    pub fn take(&mut self, byte: u8) -> Option<AdapterMessage> {
        match byte {
            CR => {
                let line = self.line.get(..self.length).filter(|_| !self.is_too_long);
                let frame = line.and_then(frame_of).map(AdapterMessage::Frame);
                (self.length, self.is_too_long) = (0, false);
                frame
            }
            BEL => {
                (self.length, self.is_too_long) = (0, false);
                Some(AdapterMessage::Refused)
            }
            _ => {
                match self.line.get_mut(self.length) {
                    Some(place) => {
                        *place = byte;
                        self.length += 1;
                    }
                    None => self.is_too_long = true,
                }
                None
            }
        }
    }
}

/// Returns the frame of a line without its CR.
pub(super) fn frame_of(line: &[u8]) -> Option<Frame> {
    let (&kind, rest) = line.split_first()?;
    let is_remote = match kind {
        b't' => false,
        b'r' => true,
        _ => return None,
    };
    let (id, rest) = rest.split_at_checked(3)?;
    let id = id.iter().try_fold(0, |id, digit| Some(id << 4 | u16::from(value_of(*digit)?)))?;
    let id = Id::new(id).ok()?;
    let (&length, rest) = rest.split_first()?;
    let length = value_of(length).filter(|length| *length <= 8)?;
    let count = if is_remote { 0 } else { usize::from(length) };
    let (digits, stamp) = rest.split_at_checked(2 * count)?;
    let is_stamp = stamp.is_empty() || stamp.len() == 4 && stamp.iter().all(|digit| value_of(*digit).is_some());
    let mut data = [0; 8];
    for (byte, pair) in data.iter_mut().zip(digits.chunks_exact(2)) {
        let &[high, low] = pair else { return None };
        *byte = value_of(high)? << 4 | value_of(low)?;
    }
    match is_stamp {
        true if is_remote => Frame::remote(id, length).ok(),
        true => Frame::data(id, data.get(..count)?).ok(),
        false => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn said(bytes: &[u8]) -> Vec<AdapterMessage> {
        let mut decoder = Decoder::default();
        bytes.iter().filter_map(|byte| decoder.take(*byte)).collect()
    }

    fn data(id: u16, bytes: &[u8]) -> Frame {
        Frame::data(Id::new(id).unwrap(), bytes).unwrap()
    }

    /// Lines of the manual, and other output of adapters.
    #[test]
    fn lines_are_frames() {
        assert_eq!(Line::of(&data(0x123, &[0x11, 0xFF])).bytes(), b"t123211FF\r");
        assert_eq!(Line::of(&data(0, &[])).bytes(), b"t0000\r");
        assert_eq!(Line::of(&Frame::remote(Id::new(0x705).unwrap(), 1).unwrap()).bytes(), b"r7051\r");
        assert_eq!(
            said(b"z\rt1232aBcD\r\r\x07"),
            [AdapterMessage::Frame(data(0x123, &[0xAB, 0xCD])), AdapterMessage::Refused]
        );
        assert_eq!(said(b"t100101ABCD\r"), [AdapterMessage::Frame(data(0x100, &[1]))], "with a time stamp");
    }

    #[test]
    fn invalid_lines_are_ignored() {
        let none: [&[u8]; 11] = [
            b"t\r",
            b"t12\r",
            b"t8000\r",
            b"t1239\r",
            b"t1232AB\r",
            b"t1231ABC\r",
            b"t12G0\r",
            b"t1231+1\r",
            b"T000001230\r",
            b"V1013\r",
            b"t123800112233445566778899AABBCCDDEEFF\r",
        ];
        for line in none {
            assert_eq!(said(line), [], "{}", String::from_utf8_lossy(line));
            // The next frame is not lost.
            assert_eq!(said(&[line, b"t1230\r"].concat()), [AdapterMessage::Frame(data(0x123, &[]))]);
        }
    }

    #[test]
    fn bit_rates_have_the_digits_of_the_canusb_manual() {
        // CANUSB manual (Lawicel), command S: S7 sets 800 kbit/s, S8 sets 1 Mbit/s.
        let digits = [(10, 0), (20, 1), (50, 2), (100, 3), (125, 4), (250, 5), (500, 6), (800, 7), (1000, 8)];
        for (rate, digit) in digits {
            assert_eq!(bit_rate(rate), Some(format!("S{digit}\r").as_bytes()), "{rate} kbit/s");
        }
        assert_eq!((bit_rate(750), bit_rate(83), bit_rate(0)), (None, None, None));
        assert!(bit_rates().all(|rate| bit_rate(rate).is_some()));
    }

    proptest! {
        #[test]
        fn each_frame_comes_back(id in 0_u16..0x800, bytes in prop::collection::vec(any::<u8>(), 0..=8), remote: bool) {
            let id = Id::new(id).unwrap();
            let frame = match remote {
                true => Frame::remote(id, bytes.len() as u8).unwrap(),
                false => Frame::data(id, &bytes).unwrap(),
            };
            prop_assert_eq!(said(Line::of(&frame).bytes()), [AdapterMessage::Frame(frame)]);
        }

        /// After any bytes, the frame after the next CR is decoded.
        #[test]
        fn frame_after_noise_is_decoded(noise in prop::collection::vec(any::<u8>(), 0..100)) {
            let frame = data(0x181, &[7]);
            let all = said(&[&noise, &b"\r"[..], Line::of(&frame).bytes()].concat());
            prop_assert_eq!(all.last(), Some(&AdapterMessage::Frame(frame)));
        }
    }
}

//! Bus load of CAN frames.
//!
//! Law      a frame with an 11-bit identifier has 47 bits in addition to its data, including the 3 bits of interframe space. After 5 equal
//!          bits between start and checksum, a bit of the other level is stuffed
//! Reads    frames; the configuration of a bus
//! Source   ISO 11898-1; CRC-15 of CAN

use crate::Frame;
use crate::config::BusConfig;
use crate::layout::{Pdo, Transmission};

/// Bits of a frame without its data.
const BITS_WITHOUT_DATA: u64 = 47;
/// Bits without data that are subject to bit stuffing: from the start of the frame to its checksum.
const STUFFED_BITS_WITHOUT_DATA: u64 = 34;
/// Generator polynomial of the checksum, without its highest bit.
const GENERATOR: u16 = 0x4599;

/// Checksum of each byte.
const CHECKSUMS: [u16; 256] = checksums();

const fn checksums() -> [u16; 256] {
    let (mut table, mut byte) = ([0; 256], 0);
    while byte < 256 {
        let (mut checksum, mut bit) = ((byte as u16) << 7, 0);
        while bit < 8 {
            let is_set = checksum & 0x4000 != 0;
            checksum = (checksum << 1 & 0x7FFF) ^ if is_set { GENERATOR } else { 0 };
            bit += 1;
        }
        table[byte] = checksum;
        byte += 1;
    }
    table
}

/// Effect of a byte on a run of equal bits: the run after the byte, plus 8 times the number of stuffed bits. Runs of 1 to 4 zeros are 0 to
/// 3, runs of ones 4 to 7.
const STEPS: [[u8; 256]; 8] = steps();

const fn steps() -> [[u8; 256]; 8] {
    let (mut table, mut begin) = ([[0; 256]; 8], 0);
    while begin < 8 {
        let mut byte = 0;
        while byte < 256 {
            let (mut one, mut length, mut stuffed, mut bit) = (begin >> 2, begin & 3, 0, 8);
            while bit > 0 {
                bit -= 1;
                let next = byte >> bit & 1;
                length = if next == one { length + 1 } else { 0 };
                one = next;
                if length == 4 {
                    (one, length, stuffed) = (1 - one, 0, stuffed + 1);
                }
            }
            table[begin][byte] = stuffed << 3 | (one << 2 | length) as u8;
            byte += 1;
        }
        begin += 1;
    }
    table
}

/// Returns the maximum number of bits of a data frame with this number of bytes: one bit in four is stuffed.
pub fn max_bits(bytes: u8) -> u64 {
    let data = 8 * u64::from(bytes);
    BITS_WITHOUT_DATA + data + (STUFFED_BITS_WITHOUT_DATA + data - 1) / 4
}

/// Returns the number of bits of a frame on the bus, including stuffed bits and interframe space.
pub fn bits(frame: &Frame) -> u64 {
    let (id, length) = (u32::from(frame.id().get()), u32::from(frame.length()));
    // Start of frame, identifier, RTR, two bits of 0, length: 19 bits after 5 bits of 0, which do not change the checksum.
    let head = id << 7 | u32::from(frame.is_remote()) << 6 | length;
    let data = frame.bytes();
    let [_, head_bytes @ ..] = head.to_be_bytes();
    let checksum = head_bytes.iter().chain(data).fold(0_u16, |checksum, byte| {
        let at = usize::from((checksum >> 7) as u8 ^ byte);
        (checksum << 8 & 0x7FFF) ^ CHECKSUMS.get(at).copied().unwrap_or(0)
    });
    let word = data.iter().fold(u128::from(head), |word, byte| word << 8 | u128::from(*byte));
    let word = (word << 15 | u128::from(checksum)).to_be_bytes();
    // The start of frame is 0, the first bit of the identifier is handled separately, and whole bytes follow.
    let begin = if id & 0x400 == 0 { 1 } else { 4 };
    let rest = word.iter().skip(word.len() - 4 - data.len());
    let (_, stuffed) = rest.fold((begin, 0), |(run, stuffed), byte| {
        let step = STEPS.get(run).and_then(|steps| steps.get(usize::from(*byte))).copied().unwrap_or(0);
        (usize::from(step & 7), stuffed + u64::from(step >> 3))
    });
    BITS_WITHOUT_DATA + 8 * data.len() as u64 + stuffed
}

/// Bus load of each cycle: SYNC and the PDOs that are sent with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Number of frames.
    pub frames: u64,
    /// Maximum number of bits of the frames.
    pub bits: u64,
    /// Bit rate, in bit/s.
    pub rate: u32,
    /// Cycle time, in us.
    pub cycle_us: f64,
}

impl Load {
    /// Returns the load of a bus; `None` if it has no bit rate.
    pub fn of(bus: &BusConfig) -> Option<Self> {
        let sync = u8::from(bus.sync_overflow.is_some());
        let asked = bus.devices.iter().flat_map(|device| cyclic(&device.layout.asked));
        let told = bus.devices.iter().flat_map(|device| cyclic(&device.layout.told));
        let lengths: Vec<u8> = [sync].into_iter().chain(asked).chain(told).collect();
        Some(Self {
            frames: lengths.len() as u64,
            bits: lengths.iter().map(|bytes| max_bits(*bytes)).sum(),
            rate: bus.bit_rate?,
            cycle_us: bus.cycle_ns as f64 / 1000.0,
        })
    }

    /// Returns the time for the frames of a cycle, in us.
    pub fn time_us(self) -> f64 {
        self.bits as f64 * 1e6 / f64::from(self.rate)
    }

    /// Returns the part of a cycle that the frames need; above 1 they do not fit.
    pub fn share(self) -> f64 {
        self.time_us() / self.cycle_us
    }
}

/// Returns the lengths of the PDOs that are sent in each cycle, in bytes.
fn cyclic<W>(pdos: &[Pdo<W>]) -> impl Iterator<Item = u8> {
    pdos.iter().filter(|pdo| pdo.transmission == Transmission::EachSync).map(Pdo::bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;
    use proptest::prelude::*;

    /// Counts the bits of a frame one by one, according to ISO 11898-1.
    fn one_by_one(id: u16, is_remote: bool, length: u8, data: &[u8]) -> u64 {
        let number = |value: u32, bits: u32| (0..bits).rev().map(move |bit| value >> bit & 1 != 0);
        let mut frame = vec![false];
        frame.extend(number(id.into(), 11).chain([is_remote, false, false]).chain(number(length.into(), 4)));
        frame.extend(data.iter().flat_map(|byte| number((*byte).into(), 8)));
        let checksum = frame.iter().fold(0_u32, |checksum, bit| {
            let shifted = checksum << 1 & 0x7FFF;
            if (checksum & 0x4000 != 0) == *bit { shifted } else { shifted ^ 0x4599 }
        });
        frame.extend(number(checksum, 15));
        let (mut run, mut last, mut count) = (0, None, 0);
        for bit in frame {
            run = if last == Some(bit) { run + 1 } else { 1 };
            (last, count) = (Some(bit), count + 1);
            if run == 5 {
                (last, run, count) = (Some(!bit), 1, count + 1);
            }
        }
        // Delimiter, acknowledgement and its delimiter, end of frame, interframe space.
        count + 1 + 2 + 7 + 3
    }

    /// Check value of CRC-15/CAN in the catalogue of checksums.
    #[test]
    fn the_checksum_is_that_of_can() {
        let checksum = b"123456789".iter().fold(0_u16, |checksum, byte| {
            (checksum << 8 & 0x7FFF) ^ CHECKSUMS[usize::from((checksum >> 7) as u8 ^ byte)]
        });
        assert_eq!(checksum, 0x059E);
    }

    /// NMT without data: 34 bits of 0, with a stuffed 1 after each 5 of them.
    #[test]
    fn a_frame_of_zeros_is_stuffed_six_times() {
        assert_eq!(bits(&Frame::data(Id::NMT, &[]).unwrap()), 47 + 6);
        assert_eq!((max_bits(8), max_bits(0)), (135, 55));
    }

    proptest! {
        #[test]
        fn bits_are_those_of_the_standard(
            id in 0_u16..0x800,
            is_remote in any::<bool>(),
            data in prop::collection::vec(prop_oneof![Just(0_u8), Just(0xFF), any::<u8>()], 0..=8),
        ) {
            let (of, length) = (Id::new(id).unwrap(), data.len() as u8);
            let (frame, data) = match is_remote {
                true => (Frame::remote(of, length).unwrap(), &[][..]),
                false => (Frame::data(of, &data).unwrap(), &data[..]),
            };
            prop_assert_eq!(bits(&frame), one_by_one(id, is_remote, length, data));
            prop_assert!(bits(&frame) <= max_bits(length));
        }
    }
}

//! Layer setting services: giving node ids and bit rates to devices that are told apart by their identity (CiA 305).
//!
//! Law      one device at a time is switched to configuration and back to waiting; nothing here waits or has a clock: whoever has the bus
//!          sends the frames, and says what was answered. A search halves the identities bit by bit, from the highest one on: a device
//!          answers where all bits so far are its own, so no answer means that the bit is 1
//! Reads    frames on 7E4h
//! Writes   frames for 7E5h
//! Refuses  what a device refuses, with its code in words
//! Source   CiA 305, from memory; the search as CANopenNode and python-canopen do it

use crate::{Frame, Id, NodeId};

/// Bit rates by their index in table 0 (bit/s). Index 5 is reserved.
const BIT_RATES: [(u32, u8); 8] =
    [(1_000_000, 0), (800_000, 1), (500_000, 2), (250_000, 3), (125_000, 4), (50_000, 6), (20_000, 7), (10_000, 8)];
/// Begins a search: everybody without a node id answers.
const ALL: u8 = 0x80;
/// Answers to a search.
const IDENTIFIED: u8 = 79;
/// Answer to a selection.
const SELECTED: u8 = 68;

/// Vendor, product code, revision number, serial number (1018h): no two devices share all four.
pub type Identity = [u32; 4];

/// What is asked of the device that is in configuration, or of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LssCommand {
    /// All devices go to waiting; no answer.
    Wait,
    /// The node id that the device has from its next start or from its way to waiting on.
    NodeId(NodeId),
    /// The bit rate, by its index; it holds from the next start on.
    BitRate(u8),
    /// Keeps both.
    Store,
}

/// Why a device does not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LssError {
    /// It knows no such node id.
    #[error("the device does not take this node id")]
    NodeId,
    /// It knows no such bit rate.
    #[error("the device does not know this bit rate")]
    BitRate,
    /// It cannot keep anything.
    #[error("the device cannot store its node id and bit rate")]
    NoStore,
    /// Its memory fails.
    #[error("the memory of the device cannot be written")]
    Memory,
    /// Another reason.
    #[error("the device refuses with code {0} ({1})")]
    Other(u8, u8),
}

/// The index of a bit rate; none for one that LSS does not know.
pub fn bit_rate(bit_per_s: u32) -> Option<u8> {
    BIT_RATES.iter().find(|row| row.0 == bit_per_s).map(|row| row.1)
}

/// All bit rates (bit/s).
pub fn bit_rates() -> impl Iterator<Item = u32> {
    BIT_RATES.iter().map(|row| row.0)
}

fn frame(bytes: [u8; 8]) -> Frame {
    Frame::of(Id::LSS_MASTER, bytes)
}

/// The bytes of an answer.
fn answer(frame: &Frame) -> Option<[u8; 8]> {
    frame.bytes().try_into().ok().filter(|_| frame.id() == Id::LSS_SLAVE)
}

/// Frames that switch the device of an identity to configuration; it answers behind the last one.
pub fn select(identity: Identity) -> [Frame; 4] {
    let [vendor, product, revision, serial] = identity;
    [(64, vendor), (65, product), (66, revision), (67, serial)].map(|(command, number): (u8, u32)| {
        let [a, b, c, d] = number.to_le_bytes();
        frame([command, a, b, c, d, 0, 0, 0])
    })
}

/// Does a frame say that a device is in configuration?
pub fn is_selected(frame: &Frame) -> bool {
    answer(frame).is_some_and(|bytes| bytes[0] == SELECTED)
}

impl LssCommand {
    /// The frame that says it.
    pub fn frame(self) -> Frame {
        frame(match self {
            Self::Wait => [4, 0, 0, 0, 0, 0, 0, 0],
            Self::NodeId(node) => [17, node.get(), 0, 0, 0, 0, 0, 0],
            Self::BitRate(index) => [19, 0, index, 0, 0, 0, 0, 0],
            Self::Store => [23, 0, 0, 0, 0, 0, 0, 0],
        })
    }

    /// What a frame answers to it; none where it is no answer to it.
    pub fn answered(self, frame: &Frame) -> Option<Result<(), LssError>> {
        let [command, code, detail, ..] = answer(frame)?;
        let [own, ..] = <[u8; 8]>::try_from(self.frame().bytes()).ok()?;
        if command != own || self == Self::Wait {
            return None;
        }
        Some(match (self, code) {
            (_, 0) => Ok(()),
            (Self::NodeId(_), 1) => Err(LssError::NodeId),
            (Self::BitRate(_), 1) => Err(LssError::BitRate),
            (Self::Store, 1) => Err(LssError::NoStore),
            (Self::Store, 2) => Err(LssError::Memory),
            _ => Err(LssError::Other(code, detail)),
        })
    }
}

/// What a search has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A device: it is in configuration now.
    Found(Identity),
    /// No device without a node id is there.
    Nobody,
    /// A device answered and then no longer did: frames were lost, or answers came too late.
    Lost,
}

/// Where a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Is anybody there?
    Begin,
    /// Is this bit of this part 0?
    Bit { part: usize, bit: u8 },
    /// Is this part right?
    Part { part: usize },
}

/// A search for one device that has no node id yet.
#[derive(Clone, Copy, Debug)]
pub struct FastScan {
    identity: Identity,
    step: Step,
}

impl Default for FastScan {
    fn default() -> Self {
        Self { identity: [0; 4], step: Step::Begin }
    }
}

impl FastScan {
    /// Questions of a search that finds somebody.
    pub const QUESTIONS: usize = 1 + 4 * 33;

    /// The question that comes next.
    pub fn question(&self) -> Frame {
        let (part, checked, next) = match self.step {
            Step::Begin => (0, ALL, 0),
            Step::Bit { part, bit } => (part, bit, part),
            Step::Part { part } => (part, 0, (part + 1) % 4),
        };
        let [a, b, c, d] = self.identity.get(part).copied().unwrap_or_default().to_le_bytes();
        frame([81, a, b, c, d, checked, part as u8, next as u8])
    }

    /// Is a frame an answer to a question? Several devices send the same one, at the same time.
    pub fn is_answer(frame: &Frame) -> bool {
        answer(frame).is_some_and(|bytes| bytes[0] == IDENTIFIED)
    }

    /// Somebody has answered the question, or nobody has in time; what has come of the search, once it is over.
    pub fn next(&mut self, is_answered: bool) -> Option<Outcome> {
        match self.step {
            Step::Begin if !is_answered => return Some(Outcome::Nobody),
            Step::Begin => self.step = Step::Bit { part: 0, bit: 31 },
            Step::Bit { part, bit } => {
                if !is_answered && let Some(number) = self.identity.get_mut(part) {
                    *number |= 1 << bit;
                }
                self.step = match bit.checked_sub(1) {
                    Some(bit) => Step::Bit { part, bit },
                    None => Step::Part { part },
                };
            }
            Step::Part { .. } if !is_answered => return Some(Outcome::Lost),
            Step::Part { part: 3 } => return Some(Outcome::Found(self.identity)),
            Step::Part { part } => self.step = Step::Bit { part: part + 1, bit: 31 },
        }
        None
    }
}

#[cfg(test)]
mod tests;

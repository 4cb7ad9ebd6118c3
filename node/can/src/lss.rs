//! Layer setting services (LSS): sets node IDs and bit rates of devices that are identified by their identity object (CiA 305).
//!
//! Law      one device at a time is switched to configuration state and back to waiting state. This module neither waits nor has a clock:
//!          the caller sends the frames and reports whether an answer came. A search (fastscan) determines the identity bit by bit, from
//!          the highest bit. A device answers if all bits so far match its own, so a missing answer means that the bit is 1
//! Reads    frames on 7E4h
//! Writes   frames for 7E5h
//! Refuses  requests that a device refuses, with the meaning of its error code
//! Source   CiA 305, from memory; the search as in CANopenNode and python-canopen

use crate::{Frame, Id, NodeId};

/// Bit rates, in bit/s, with their index in table 0. Index 5 is reserved.
const BIT_RATES: [(u32, u8); 8] =
    [(1_000_000, 0), (800_000, 1), (500_000, 2), (250_000, 3), (125_000, 4), (50_000, 6), (20_000, 7), (10_000, 8)];
/// Starts a search: all devices without a node ID answer.
const ALL: u8 = 0x80;
/// Command specifier of an answer to a search.
const IDENTIFIED: u8 = 79;
/// Command specifier of the answer to a selection.
const SELECTED: u8 = 68;

/// Vendor ID, product code, revision number, serial number (1018h); together they are unique.
pub type Identity = [u32; 4];

/// Command to the device in configuration state, or to all devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LssCommand {
    /// All devices change to waiting state; there is no answer.
    SwitchToWaiting,
    /// Node ID of the device from its next start, or from its change to waiting state.
    NodeId(NodeId),
    /// Bit rate, by its index; it applies from the next start.
    BitRate(u8),
    /// Stores node ID and bit rate permanently.
    Store,
}

/// Reason why a device refuses a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LssError {
    /// The device does not support the node ID.
    #[error("the device does not take this node id")]
    NodeId,
    /// The device does not support the bit rate.
    #[error("the device does not know this bit rate")]
    BitRate,
    /// The device cannot store the configuration.
    #[error("the device cannot store its node id and bit rate")]
    NoStore,
    /// The storage of the device has failed.
    #[error("the memory of the device cannot be written")]
    Memory,
    /// Another reason.
    #[error("the device refuses with code {0} ({1})")]
    Other(u8, u8),
}

/// Returns the index of a bit rate; `None` if LSS does not support it.
pub fn bit_rate(bit_per_s: u32) -> Option<u8> {
    BIT_RATES.iter().find(|row| row.0 == bit_per_s).map(|row| row.1)
}

/// Returns all bit rates, in bit/s.
pub fn bit_rates() -> impl Iterator<Item = u32> {
    BIT_RATES.iter().map(|row| row.0)
}

fn frame(bytes: [u8; 8]) -> Frame {
    Frame::of(Id::LSS_MASTER, bytes)
}

/// Returns the bytes of an answer.
fn answer(frame: &Frame) -> Option<[u8; 8]> {
    frame.bytes().try_into().ok().filter(|_| frame.id() == Id::LSS_SLAVE)
}

/// Returns the frames that switch the device with an identity to configuration state; it answers after the last one.
pub fn select(identity: Identity) -> [Frame; 4] {
    let [vendor, product, revision, serial] = identity;
    [(64, vendor), (65, product), (66, revision), (67, serial)].map(|(command, number): (u8, u32)| {
        let [a, b, c, d] = number.to_le_bytes();
        frame([command, a, b, c, d, 0, 0, 0])
    })
}

/// Returns true if the frame confirms that a device is in configuration state.
pub fn is_selected(frame: &Frame) -> bool {
    answer(frame).is_some_and(|bytes| bytes[0] == SELECTED)
}

impl LssCommand {
    /// Returns the frame of the command.
    pub fn frame(self) -> Frame {
        frame(match self {
            Self::SwitchToWaiting => [4, 0, 0, 0, 0, 0, 0, 0],
            Self::NodeId(node) => [17, node.get(), 0, 0, 0, 0, 0, 0],
            Self::BitRate(index) => [19, 0, index, 0, 0, 0, 0, 0],
            Self::Store => [23, 0, 0, 0, 0, 0, 0, 0],
        })
    }

    /// Returns the result that a frame reports for this command; `None` if the frame is not an answer to it.
    pub fn result_of(self, frame: &Frame) -> Option<Result<(), LssError>> {
        let [command, code, detail, ..] = answer(frame)?;
        let [own, ..] = <[u8; 8]>::try_from(self.frame().bytes()).ok()?;
        if command != own || self == Self::SwitchToWaiting {
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

/// Result of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A device was found; it is in configuration state.
    Found(Identity),
    /// There is no device without a node ID.
    Nobody,
    /// A device answered at first, but no longer: frames were lost, or answers were too late.
    Lost,
}

/// Step of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Checks whether any device answers.
    Begin,
    /// Checks whether this bit of this part is 0.
    Bit { part: usize, bit: u8 },
    /// Checks this part of the identity.
    Part { part: usize },
}

/// Search for one device without a node ID.
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
    /// Number of questions of a search that finds a device.
    pub const QUESTIONS: usize = 1 + 4 * 33;

    /// Returns the next question.
    pub fn next_question(&self) -> Frame {
        let (part, checked, next) = match self.step {
            Step::Begin => (0, ALL, 0),
            Step::Bit { part, bit } => (part, bit, part),
            Step::Part { part } => (part, 0, (part + 1) % 4),
        };
        let [a, b, c, d] = self.identity.get(part).copied().unwrap_or_default().to_le_bytes();
        frame([81, a, b, c, d, checked, part as u8, next as u8])
    }

    /// Returns true if a frame is an answer to a question. Several devices send the same answer at the same time.
    pub fn is_answer(frame: &Frame) -> bool {
        answer(frame).is_some_and(|bytes| bytes[0] == IDENTIFIED)
    }

    /// Advances after a question that was answered, or that was not answered in time. Returns the result once the search is finished.
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

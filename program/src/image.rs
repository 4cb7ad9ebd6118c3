//! Image: the data that a program and its slot exchange, a structure in the memory of the program.
//!
//! Numbers are little-endian, and the structure is aligned to 8 bytes:
//!
//! | byte | type | name | written by |
//! | --- | --- | --- | --- |
//! | 0 | u32 | size | the program, once: bytes of its image, including its own part |
//! | 4 | u8 | command | the slot: 0 RESET, 1 START, 255 none (EB 217) |
//! | 5 | u8 | inputs | the slot: E1 in bit 0 to E8 in bit 7 (EB 216) |
//! | 6 | u8 | outputs | both: A1 in bit 0 to A8 in bit 7, with their previous values (AB 216) |
//! | 7 | u8 | reserved | none |
//! | 8 | i64 | source | the slot: the source, sign-extended (ED 212) |
//! | 16 | i64 | travel | the slot: travel of the source since START, unwrapped |
//! | 24 | i64 | sink | both: the sink, with its previous value (AD 212) |
//! | 32 | i64 | call_ns | the slot: time between two calls (ns) |
//! | 40 | 16 words | reads | the slot: the signals that the cell names |
//! | 168 | 16 words | writes | both: the memory cells that the cell names, with their previous values |
//! | 296 | 16 i64 | parameters | the slot, at START |
//! | 424 | u32 | db_words | the slot, at START: words of the table, 0 without one |
//! | 428 | u32 | reserved | none |
//! | 432 | 256 u16 | db | the slot, at START: the table; later the program |
//! | 944 | | its own part | the program: state that an exchange may keep |
//!
//! A word holds an i64 for a whole number or a bit, an f64 for a real.
//!
//! Source   AMK-APSF-04 to -14

use crate::module::{Module, Refused, refuse};
use std::ops::Range;

/// Size of the image without the program's own part (bytes).
pub const SIZE: usize = 944;
/// Maximum signals that are read, and maximum memory cells that are written.
pub const WORDS: usize = 16;
/// Number of parameters of a set.
pub const PARAMETERS: usize = 16;
/// Maximum words of the table.
pub const DB_WORDS: usize = 256;
/// Maximum size of the program's own part (bytes).
const MOST_OWN: usize = 16_384;
/// Maximum size of the data that an exchange keeps (bytes).
pub(crate) const MOST_KEPT: usize = SIZE + MOST_OWN;

const COMMAND: usize = 4;
const INPUTS: usize = 5;
const OUTPUTS: usize = 6;
const SOURCE: usize = 8;
const TRAVEL: usize = 16;
const SINK: usize = 24;
const CALL_NS: usize = 32;
const READS: usize = 40;
const WRITES: usize = 168;
const PARAMETER: usize = 296;
const DB_COUNT: usize = 424;
const DB: usize = 432;

/// Command to a program, for one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Set outputs to their values at rest.
    Reset = 0,
    /// Begin.
    Start = 1,
    /// No command.
    None = 255,
}

/// The image of a program between two calls.
#[derive(Debug)]
pub struct Image<'a> {
    bytes: &'a mut [u8],
}

impl<'a> Image<'a> {
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes }
    }

    fn set<const N: usize>(&mut self, at: usize, bytes: [u8; N]) {
        if let Some(to) = self.bytes.get_mut(at..).and_then(|bytes| bytes.first_chunk_mut()) {
            *to = bytes;
        }
    }

    fn get<const N: usize>(&self, at: usize) -> [u8; N] {
        self.bytes.get(at..).and_then(|bytes| bytes.first_chunk()).copied().unwrap_or([0; N])
    }

    /// Sets the command.
    pub fn set_command(&mut self, command: Command) {
        self.set(COMMAND, [command as u8]);
    }

    /// Sets the inputs: E1 in bit 0 to E8 in bit 7.
    pub fn set_inputs(&mut self, inputs: u8) {
        self.set(INPUTS, [inputs]);
    }

    /// Sets the outputs: A1 in bit 0 to A8 in bit 7.
    pub fn set_outputs(&mut self, outputs: u8) {
        self.set(OUTPUTS, [outputs]);
    }

    /// Returns the outputs: A1 in bit 0 to A8 in bit 7.
    pub fn outputs(&self) -> u8 {
        let [outputs] = self.get(OUTPUTS);
        outputs
    }

    /// Sets the source and its travel since START.
    pub fn set_source(&mut self, value: i64, travel: i64) {
        self.set(SOURCE, value.to_le_bytes());
        self.set(TRAVEL, travel.to_le_bytes());
    }

    /// Sets the sink.
    pub fn set_sink(&mut self, sink: i64) {
        self.set(SINK, sink.to_le_bytes());
    }

    /// Returns the sink.
    pub fn sink(&self) -> i64 {
        i64::from_le_bytes(self.get(SINK))
    }

    /// Sets the time between two calls (ns).
    pub fn set_call_ns(&mut self, call_ns: u64) {
        self.set(CALL_NS, call_ns.to_le_bytes());
    }

    /// Sets a signal that is read, as bits of an i64 or f64; its index must be below [`WORDS`].
    pub fn set_read(&mut self, place: usize, word: u64) {
        if place < WORDS {
            self.set(READS + 8 * place, word.to_le_bytes());
        }
    }

    /// Sets a memory cell that is written, as bits of an i64 or f64; its index must be below [`WORDS`].
    pub fn set_write(&mut self, place: usize, word: u64) {
        if place < WORDS {
            self.set(WRITES + 8 * place, word.to_le_bytes());
        }
    }

    /// Returns a memory cell that is written; 0 for an index that is not below [`WORDS`].
    pub fn write(&self, place: usize) -> u64 {
        if place < WORDS { u64::from_le_bytes(self.get(WRITES + 8 * place)) } else { 0 }
    }

    /// Sets a parameter; its index must be below [`PARAMETERS`].
    pub fn set_parameter(&mut self, place: usize, value: i64) {
        if place < PARAMETERS {
            self.set(PARAMETER + 8 * place, value.to_le_bytes());
        }
    }

    /// Sets the words of the table, at most [`DB_WORDS`]; the rest becomes 0.
    pub fn set_db(&mut self, words: impl Iterator<Item = u16>) {
        let mut count = 0_u32;
        for (place, word) in (0..DB_WORDS).zip(words) {
            self.set(DB + 2 * place, word.to_le_bytes());
            count += 1;
        }
        for place in count as usize..DB_WORDS {
            self.set(DB + 2 * place, [0; 2]);
        }
        self.set(DB_COUNT, count.to_le_bytes());
    }
}

/// Returns the range of the image at that address in the initial memory.
pub(crate) fn find(memory: &[u8], at: usize) -> Result<Range<usize>, Refused> {
    if at == 0 || !at.is_multiple_of(8) {
        return refuse(format!("its image is at {at}; an address above 0 that 8 divides is needed"));
    }
    let Some(size) = size(memory, at) else { return refuse("its image is outside its memory") };
    if !(SIZE..=MOST_KEPT).contains(&size) {
        let most = MOST_KEPT;
        return refuse(format!(
            "the first word of its image, its size, is {size}; {SIZE} to {most} bytes are possible"
        ));
    }
    let end = at + size;
    if end > memory.len() {
        return refuse(format!("its image ends at {end}, behind its memory of {} bytes", memory.len()));
    }
    Ok(at..end)
}

fn size(memory: &[u8], at: usize) -> Option<usize> {
    let size = memory.get(at..)?.first_chunk().copied().map(u32::from_le_bytes)?;
    usize::try_from(size).ok()
}

/// Returns true if the image still contains its size.
pub(crate) fn has_size(memory: &[u8], image: Range<usize>) -> bool {
    size(memory, image.start) == Some(image.len())
}

/// Returns the range that an exchange keeps: everything after the size, or only the values that the slot writes.
pub(crate) fn kept(module: &Module, whole: bool) -> Range<usize> {
    let Range { start, end } = module.image;
    start + COMMAND..if whole { end } else { start + SIZE }
}

/// Returns true if the own parts of both modules have the same length.
pub fn is_as_long(module: &Module, other: &Module) -> bool {
    module.image.len() == other.image.len()
}

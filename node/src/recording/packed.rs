//! Compresses inputs and signals of a cycle: stores only values that differ from their prediction.
//!
//! Law      unpacking restores the values bit by bit, from a key cycle on and without a missing cycle
//! Reads    [`Inputs`] without their latches, and a [`Board`]; their numbers of values must not change
//! Writes   for each word that differs from its prediction: the number of correctly predicted words before it (LEB128);
//!          one byte with the numbers of zero bytes at the upper and at the lower end of the difference, 3 bits each;
//!          the bytes in between. In a key cycle all predictions are zero
//!
//! A word is predicted from its last values (`History`). All arithmetic wraps. Packing does not allocate.

use lineshaft_core::drive::{BusState, DriveInput, Emergency, EncoderInput, Inputs};
use lineshaft_core::signal::Board;

/// Number of words of a drive and of an encoder.
const DRIVE: usize = 7;
const ENCODER: usize = 3;
/// Maximum number of bytes of a word: 3 for the number before it, which is below 2^21, then 1 and 8.
const MOST: usize = 12;
/// Number of words that are compared in one step.
const TOGETHER: usize = 8;

/// Last values of a word, from which the next one is predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct History {
    value: u64,
    /// Last change, and the one before.
    change: u64,
    before: u64,
}

impl History {
    /// Returns the predicted value. A word that changed twice in a row is extrapolated as a parabola, also in the bits
    /// of a float; any other word is predicted to stay.
    fn predicted(self) -> u64 {
        let Self { value, change, before } = self;
        if change == 0 || before == 0 {
            return value;
        }
        value.wrapping_add(change.wrapping_mul(2)).wrapping_sub(before)
    }

    fn push(&mut self, value: u64) {
        *self = Self { value, change: value.wrapping_sub(self.value), before: self.change };
    }

    /// Whether the word does not change now and has not changed in the last two cycles.
    fn rests(self, value: u64) -> bool {
        self == Self { value, ..Self::default() }
    }
}

/// Packs one cycle after the other.
#[derive(Debug)]
pub struct Packer {
    words: Vec<History>,
    /// Words of the inputs of the current cycle.
    inputs: Vec<u64>,
    bytes: Vec<u8>,
}

impl Packer {
    /// Creates a packer for inputs and boards of this shape.
    pub fn new(inputs: &Inputs, board: &Board) -> Self {
        let of_inputs = input_words(inputs);
        let words = of_inputs + board.len();
        let words = vec![History::default(); words];
        Self { inputs: vec![0; of_inputs], bytes: Vec::with_capacity(MOST * words.len()), words }
    }

    /// Returns the maximum number of bytes of a cycle.
    pub fn most(&self) -> usize {
        MOST * self.words.len()
    }

    /// Packs a cycle, relative to the previous one.
    pub fn pack(&mut self, inputs: &Inputs, board: &Board, is_key: bool) -> &[u8] {
        if is_key {
            self.words.fill(History::default());
        }
        write_inputs(inputs, &mut self.inputs);
        self.bytes.clear();
        let (of_inputs, of_board) = self.words.split_at_mut(self.inputs.len());
        let same = pack_words(of_inputs, &self.inputs, 0, &mut self.bytes);
        pack_words(of_board, board.words(), same, &mut self.bytes);
        &self.bytes
    }
}

/// Packs words that follow `same` correctly predicted words. Returns the number of such words at the end.
fn pack_words(words: &mut [History], values: &[u64], mut same: usize, bytes: &mut Vec<u8>) -> usize {
    for (words, values) in words.chunks_mut(TOGETHER).zip(values.chunks(TOGETHER)) {
        if words.iter().zip(values).all(|(word, value)| word.rests(*value)) {
            same += words.len();
            continue;
        }
        for (word, &value) in words.iter_mut().zip(values) {
            let difference = value.wrapping_sub(word.predicted());
            word.push(value);
            if difference == 0 {
                same += 1;
            } else {
                push_number(std::mem::take(&mut same), bytes);
                push_difference(difference, bytes);
            }
        }
    }
    same
}

fn push_number(mut number: usize, bytes: &mut Vec<u8>) {
    while number >= 0x80 {
        bytes.push(0x80 | (number & 0x7f) as u8);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn push_difference(difference: u64, bytes: &mut Vec<u8>) {
    // The sign is moved to the lowest bit, so that a small negative number has zero bytes at its upper end too.
    let folded = difference << 1 ^ (difference.cast_signed() >> 63).cast_unsigned();
    let (upper, lower) = (folded.leading_zeros() / 8, folded.trailing_zeros() / 8);
    // Both are below 8, because the difference is not 0.
    bytes.push((upper << 3 | lower) as u8);
    bytes.extend_from_slice(&(folded >> (8 * lower)).to_le_bytes()[..(8 - upper - lower) as usize]);
}

/// Unpacks one cycle after the other.
#[derive(Clone, Debug)]
pub struct Unpacker {
    words: Vec<History>,
    /// Values of the newest cycle.
    values: Vec<u64>,
    of_inputs: usize,
    /// Inputs of the newest cycle, without latches.
    pub inputs: Inputs,
    /// Board of the newest cycle.
    pub board: Board,
}

impl Unpacker {
    /// Creates an unpacker for inputs and boards of this shape.
    pub fn new(inputs: &Inputs, board: &Board) -> Self {
        let of_inputs = input_words(inputs);
        let words = of_inputs + board.len();
        let (words, values) = (vec![History::default(); words], vec![0; words]);
        Self { words, values, of_inputs, inputs: inputs.clone(), board: board.clone() }
    }

    /// Unpacks the cycle after the newest one, or a key cycle.
    pub fn unpack(&mut self, cycle: u64, bytes: &[u8], is_key: bool) {
        if is_key {
            self.words.fill(History::default());
        }
        unpack_words(&mut self.words, &mut self.values, bytes);
        let (of_inputs, of_board) = self.values.split_at(self.of_inputs);
        read_inputs(of_inputs, &mut self.inputs);
        self.inputs.cycle = cycle;
        self.inputs.latch.clear();
        self.board.copy_words(of_board);
    }
}

fn unpack_words(words: &mut [History], values: &mut [u64], mut bytes: &[u8]) {
    let mut next = take_word(&mut bytes);
    for (word, value) in words.iter_mut().zip(values) {
        *value = word.predicted();
        match &mut next {
            Some((0, difference)) => {
                *value = value.wrapping_add(*difference);
                next = take_word(&mut bytes);
            }
            Some((same, _)) => *same -= 1,
            None => {}
        }
        word.push(*value);
    }
}

/// Reads the number of correctly predicted words, and the difference of the word after them.
fn take_word(bytes: &mut &[u8]) -> Option<(usize, u64)> {
    take_number(bytes).zip(take_difference(bytes))
}

fn take_number(bytes: &mut &[u8]) -> Option<usize> {
    let mut number = 0;
    for shift in [0, 7, 14] {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= usize::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            break;
        }
    }
    Some(number)
}

fn take_difference(bytes: &mut &[u8]) -> Option<u64> {
    let (&head, rest) = bytes.split_first()?;
    let (upper, lower) = (usize::from(head >> 3), usize::from(head & 7));
    let length = 8_usize.checked_sub(upper + lower)?;
    let (middle, rest) = rest.split_at_checked(length)?;
    *bytes = rest;
    let mut folded = [0; 8];
    folded.iter_mut().zip(middle).for_each(|(byte, from)| *byte = *from);
    let folded = u64::from_le_bytes(folded) << (8 * lower);
    Some(folded >> 1 ^ (folded & 1).wrapping_neg())
}

/// Returns the number of words of the inputs.
fn input_words(inputs: &Inputs) -> usize {
    1 + inputs.digital.len() + inputs.analog.len() + ENCODER * inputs.encoder.len() + DRIVE * inputs.drive.len()
}

fn write_inputs(inputs: &Inputs, words: &mut [u64]) {
    let head = u64::from(inputs.missed) | u64::from(inputs.latches_lost) << 32;
    let terminals = inputs.digital.iter().copied().chain(inputs.analog.iter().map(|volts| volts.to_bits()));
    let encoders = inputs.encoder.iter().flat_map(encoder_words);
    let all = [head].into_iter().chain(terminals).chain(encoders).chain(inputs.drive.iter().flat_map(drive_words));
    words.iter_mut().zip(all).for_each(|(word, new)| *word = new);
}

fn read_inputs(words: &[u64], inputs: &mut Inputs) {
    let Some((head, words)) = words.split_first() else { return };
    (inputs.missed, inputs.latches_lost) = (*head as u32, (*head >> 32) as u32);
    let Some((digital, words)) = words.split_at_checked(inputs.digital.len()) else { return };
    inputs.digital.copy_from_slice(digital);
    let Some((analog, words)) = words.split_at_checked(inputs.analog.len()) else { return };
    inputs.analog.iter_mut().zip(analog).for_each(|(volts, word)| *volts = f64::from_bits(*word));
    let Some((encoders, drives)) = words.split_at_checked(ENCODER * inputs.encoder.len()) else { return };
    let encoders = encoders.as_chunks().0.iter().map(|words| encoder(*words));
    inputs.encoder.iter_mut().zip(encoders).for_each(|(encoder, new)| *encoder = new);
    let drives = drives.as_chunks().0.iter().map(|words| drive(*words));
    inputs.drive.iter_mut().zip(drives).for_each(|(drive, new)| *drive = new);
}

fn encoder_words(encoder: &EncoderInput) -> [u64; ENCODER] {
    let EncoderInput { count, epoch, valid, index } = *encoder;
    let flags = u64::from(epoch) | u64::from(valid) << 32 | u64::from(index.is_some()) << 33;
    [count.cast_unsigned(), flags, index.unwrap_or(0).cast_unsigned()]
}

fn encoder([count, flags, index]: [u64; ENCODER]) -> EncoderInput {
    let has = |bit: u32| flags >> bit & 1 == 1;
    EncoderInput {
        count: count.cast_signed(),
        epoch: flags as u32,
        valid: has(32),
        index: has(33).then_some(index.cast_signed()),
    }
}

fn drive_words(drive: &DriveInput) -> [u64; DRIVE] {
    let DriveInput {
        count,
        epoch,
        velocity,
        effort,
        status,
        mode,
        fault,
        online,
        fresh,
        bus,
        emergency,
        inputs,
        index,
        unacknowledged,
    } = *drive;
    let flags = u64::from(status)
        | u64::from(fault) << 16
        | u64::from(mode.cast_unsigned()) << 32
        | u64::from(online) << 40
        | u64::from(fresh) << 41
        | u64::from(emergency.is_some()) << 42
        | u64::from(index.is_some()) << 43
        | (bus as u64) << 44
        | u64::from(unacknowledged) << 46;
    [
        count.cast_unsigned(),
        velocity.to_bits(),
        effort.to_bits(),
        u64::from(epoch) | u64::from(inputs) << 32,
        flags,
        emergency.map_or(0, |sent| u64::from_le_bytes(sent.to_bytes())),
        index.unwrap_or(0).cast_unsigned(),
    ]
}

fn drive([count, velocity, effort, epoch, flags, emergency, index]: [u64; DRIVE]) -> DriveInput {
    let has = |bit: u32| flags >> bit & 1 == 1;
    DriveInput {
        count: count.cast_signed(),
        epoch: epoch as u32,
        velocity: f64::from_bits(velocity),
        effort: f64::from_bits(effort),
        status: flags as u16,
        mode: ((flags >> 32) as u8).cast_signed(),
        fault: (flags >> 16) as u16,
        online: has(40),
        fresh: has(41),
        bus: match flags >> 44 & 0b11 {
            0 => BusState::Active,
            1 => BusState::Degraded,
            _ => BusState::Off,
        },
        emergency: has(42).then_some(Emergency::from_bytes(emergency.to_le_bytes())),
        inputs: (epoch >> 32) as u32,
        index: has(43).then_some(index.cast_signed()),
        unacknowledged: has(46),
    }
}

#[cfg(test)]
mod tests;

//! Cam table: the words of a data block that may change while its function runs.
//!
//! Law      DW0 cycle time, DR1 the track whose offset is shown, from DW8 on offset, from DW16 on dead time, from DW24
//!          on pulse of each track; from DD32 on the cams, on and off of each, ordered by track
//! Refuses  fewer words than the cams need; times below a call or above 32767 where they are used; a hysteresis as long
//!          as the distance from the end of a cam to its start
//! Source   AMK-CAM-16, AMK-CAM-38 to -46, A-60. A hysteresis must exceed the lead, which depends on the velocity: this
//!          is not checked

use super::hysteresis::Ring;
use super::{BA, CAMS, HYSTERESIS, MODE, MODULO, hysteresis_inc};
use crate::code::Code;
use crate::function::field::Words;
use crate::function::program::{Fault, LINES, Setting};
use crate::function::time::HALF_MS;
use crate::function::track::{self, Track};
use crate::table::{Table, double};

const TRACK_SELECT: usize = 1;
const OFFSET: usize = 8;
const DEAD_TIME: usize = 16;
const MONOFLOP: usize = 24;
const FIRST_CAM: usize = 32;
/// Words per cam.
const CAM: usize = 4;
/// Maximum time, in half milliseconds.
const LONGEST: u16 = 32_767;

/// A data block as a cam table.
#[derive(Clone, Copy, Debug)]
pub(super) struct CamTable<'a> {
    head: &'a [i64; FIRST_CAM],
    cams: &'a [[i64; CAM]],
}

impl<'a> CamTable<'a> {
    /// Returns the cam table of a checked table; missing words of the head read as 0.
    #[inline]
    pub(super) fn new(table: &'a Table) -> Self {
        let (head, cams) = table.y().split_first_chunk().unwrap_or((&[0; FIRST_CAM], &[]));
        Self { head, cams: cams.as_chunks().0 }
    }

    /// Returns a word, unsigned.
    #[inline]
    fn word(self, place: usize) -> u16 {
        // Words are within 16 bits: the cast keeps their bits.
        self.head.get(place).map_or(0, |word| *word as u16)
    }

    /// Returns the duration of a turn in time mode, in half milliseconds.
    pub(super) fn cycle_time(self) -> u16 {
        self.word(0)
    }

    /// Returns the track whose offset is shown.
    pub(super) fn track_select(self) -> u8 {
        let [low, _] = self.word(TRACK_SELECT).to_le_bytes();
        low
    }

    /// Returns the offsets of all tracks.
    #[inline]
    pub(super) fn offsets(self) -> [i16; LINES] {
        std::array::from_fn(|track| self.word(OFFSET + track).cast_signed())
    }

    pub(super) fn dead_time(self, track: usize) -> u16 {
        self.word(DEAD_TIME + track)
    }

    pub(super) fn monoflop(self, track: usize) -> u16 {
        self.word(MONOFLOP + track)
    }

    /// Returns on and off of `count` cams, starting with cam `first`; none if the table is too short.
    #[inline]
    pub(super) fn cams(self, first: usize, count: usize) -> impl Iterator<Item = (i32, i32)> + use<'a> {
        // One bounds check for all cams: word by word it would be four per cam.
        let cams = self.cams.get(first..first + count).unwrap_or_default();
        cams.iter().map(|[a, b, c, d]| (double(*a, *b), double(*c, *d)))
    }
}

/// Checks the tracks to which the table belongs.
pub(in crate::function) fn check_table(words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
    let counts = || (0..LINES).map(|track| words.get(CAMS + track) as usize);
    let block = track::check_words(setting)?;
    track::check_length(block, FIRST_CAM + CAM * counts().sum::<usize>())?;
    let table = CamTable::new(block);
    if usize::from(table.track_select()) >= LINES {
        return Err(Fault::new(Code::AMK_TRACK_SELECT).with(table.track_select().into(), LINES as i64 - 1));
    }
    let call_ns = setting.call_ns;
    if words.get(BA) == 2 {
        check_time(0, table.cycle_time(), call_ns)?;
    }
    let ring = ring(words);
    let mut first = 0;
    for (number, count) in counts().enumerate().filter(|(_, count)| *count > 0) {
        if table.dead_time(number) != 0 {
            check_time(DEAD_TIME + number, table.dead_time(number), call_ns)?;
        }
        if Track::new(words.get(MODE + number)).has_pulse() && table.monoflop(number) != 0 {
            check_time(MONOFLOP + number, table.monoflop(number), call_ns)?;
        }
        let hysteresis = hysteresis_inc(words.get(HYSTERESIS + number));
        let rests = table.cams(first, count).filter_map(|(on, off)| ring.arc(on, off).gap());
        if let Some(rest) = rests.min().filter(|rest| hysteresis > 0 && hysteresis >= *rest) {
            return Err(Fault::new(Code::AMK_HYSTERESIS).with(hysteresis, rest));
        }
        first += count;
    }
    Ok(())
}

/// Returns the range of positions of a parameter set.
fn ring(words: Words<'_>) -> Ring {
    if words.get(BA) == 0 { Ring::LINE } else { Ring::of(words.get(MODULO).max(1)) }
}

fn check_time(place: usize, half_ms: u16, call_ns: u64) -> Result<(), Fault> {
    // Indices of words are below 2^16.
    if half_ms > LONGEST {
        return Err(Fault::new(Code::AMK_TIME_LONG).with(place as i64, LONGEST.into()));
    }
    if u64::from(half_ms) * HALF_MS.unsigned_abs() < call_ns {
        let call = i64::try_from(call_ns).unwrap_or(i64::MAX);
        return Err(Fault::new(Code::AMK_TIME_SHORT).with(place as i64, call));
    }
    Ok(())
}

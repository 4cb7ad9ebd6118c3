//! Tracks of the cam controllers: the processing of a track bit from the table to the output, for BINEA and CAM.
//!
//! Law      t = bit, or a pulse from each 0 -> 1 of it on (retriggered by the next one); g = t, t AND e or t OR e; A =
//!          g xor inversion; e is the input, inverted or not
//! Refuses  both codes of logic at once; no table, a table of another form
//! Source   AMK-BINEA-17 to -22, -29, AMK-CAM-13, -14, B3, B4, B10, A-54, A-60, A-61

use super::program::{CallInputs, Fault, Setting};
use super::time;
use crate::code::Code;
use crate::table::{Form, Table};
use serde::{Deserialize, Serialize};

/// Bits of the mode word.
const OUTPUT_INVERTED: u8 = 1 << 0;
const INPUT_INVERTED: u8 = 1 << 1;
const AND: u8 = 1 << 2;
const OR: u8 = 1 << 3;
const PULSE: u8 = 1 << 4;
const DISABLED: u8 = 1 << 5;

/// One track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Track {
    mode: u8,
    /// Bit of the table in the last call.
    bit: bool,
    /// Remaining calls of the pulse.
    left: u64,
}

impl Track {
    /// Creates a track of a checked mode word.
    pub(super) fn new(mode: i64) -> Self {
        Self { mode: mode as u8, ..Self::default() }
    }

    /// Returns true if the function writes its output.
    pub(super) fn is_written(self) -> bool {
        self.mode & DISABLED == 0
    }

    /// Returns true if its bit triggers a pulse.
    pub(super) fn has_pulse(self) -> bool {
        self.mode & PULSE != 0
    }

    /// Returns the output in the first call: a bit that is 1 is no edge.
    pub(super) fn start(&mut self, bit: bool, input: bool) -> bool {
        (self.bit, self.left) = (bit, 0);
        self.output(bit && !self.has_pulse(), input)
    }

    /// Returns the output in each further call; a pulse lasts `time` half milliseconds. An edge always restarts the
    /// timer: a time of 0 ends a pulse.
    pub(super) fn step(&mut self, bit: bool, time: u16, input: bool, call_ns: u64) -> bool {
        let was = std::mem::replace(&mut self.bit, bit);
        if !self.has_pulse() {
            return self.output(bit, input);
        }
        if bit && !was {
            self.left = time::calls_in_time(time, call_ns);
        }
        let is_on = self.left > 0;
        self.left = self.left.saturating_sub(1);
        self.output(is_on, input)
    }

    fn output(self, bit: bool, input: bool) -> bool {
        let has = |mask: u8| self.mode & mask != 0;
        let input = input != has(INPUT_INVERTED);
        let joined = if has(AND) {
            bit && input
        } else if has(OR) {
            bit || input
        } else {
            bit
        };
        joined != has(OUTPUT_INVERTED)
    }
}

/// Returns an error for a mode word with both codes of logic.
pub(super) fn check_mode(mode: i64, field: u16) -> Result<(), Fault> {
    let both = i64::from(AND | OR);
    if mode & both == both {
        return Err(Fault::new(Code::AMK_TRACK_LOGIC).of(field).with(mode, both));
    }
    Ok(())
}

/// Returns the data block in Tab0.
pub(super) fn check_words<'a>(setting: &Setting<'a>) -> Result<&'a Table, Fault> {
    let [table, ..] = setting.tables;
    let table = table.ok_or(Fault::new(Code::AMK_TABLE_MISSING))?;
    if table.form() == Form::Words { Ok(table) } else { Err(Fault::new(Code::AMK_TABLE_FORM)) }
}

/// Returns an error for a table that is shorter than the words that are read.
pub(super) fn check_length(table: &Table, needed: usize) -> Result<(), Fault> {
    if table.len() < needed {
        // A table has at most `table::MOST` words: both fit.
        return Err(Fault::new(Code::AMK_TABLE_SHORT).with(table.len() as i64, needed as i64));
    }
    Ok(())
}

/// Returns the data block in Tab0 during a call; `None` if the slot has none.
pub(super) fn words<'a>(seen: &CallInputs<'a>) -> Option<&'a Table> {
    seen.tables.get(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the outputs for bits and inputs, after a first call with 0.
    fn run(mode: i64, time: u16, calls: &[(bool, bool)]) -> Vec<bool> {
        let mut track = Track::new(mode);
        track.start(false, false);
        calls.iter().map(|(bit, input)| track.step(*bit, time, *input, 1_000_000)).collect()
    }

    /// Proves: AMK-BINEA-17, AMK-BINEA-18, AMK-BINEA-19, AMK-BINEA-22, AMK-CAM-14
    #[test]
    fn logic_follows_the_mode_bit_by_bit() {
        let all = [(false, false), (false, true), (true, false), (true, true)];
        let table: [(i64, [u8; 4]); 8] = [
            (0, [0, 0, 1, 1]),
            (1, [1, 1, 0, 0]),
            (2, [0, 0, 1, 1]),
            (4, [0, 0, 0, 1]),
            (4 + 2, [0, 0, 1, 0]),
            (8, [0, 1, 1, 1]),
            (8 + 2, [1, 0, 1, 1]),
            (8 + 2 + 1, [0, 1, 0, 0]),
        ];
        for (mode, expected) in table {
            assert_eq!(run(mode, 0, &all), expected.map(|bit| bit == 1), "mode {mode}");
        }
    }

    /// Proves: AMK-BINEA-20, AMK-BINEA-29, AMK-CAM-13
    #[test]
    fn a_pulse_runs_its_time_and_begins_anew_with_each_edge() {
        let bits = |row: &str| row.chars().map(|bit| (bit == '1', false)).collect::<Vec<_>>();
        let shown = |outs: Vec<bool>| outs.into_iter().map(|out| if out { '1' } else { '0' }).collect::<String>();
        // 1 ms per call, 5 half milliseconds: 3 calls; the bit may fall or stay 1, which has no effect (B10, A-60).
        assert_eq!(shown(run(16, 5, &bits("0100000"))), "0111000");
        assert_eq!(shown(run(16, 5, &bits("0111110"))), "0111000");
        // A second edge two calls later: five in a row (B4).
        assert_eq!(shown(run(16, 5, &bits("01010000"))), "01111100");
        assert_eq!(shown(run(16, 0, &bits("0101"))), "0000");
        assert_eq!(shown(run(16 + 1, 2, &bits("0100"))), "1011");
    }

    #[test]
    fn bit_set_at_start_is_no_edge() {
        let mut track = Track::new(16);
        assert!(!track.start(true, false));
        assert!(!track.step(true, 9, false, 1_000_000));
        assert!(!track.step(false, 9, false, 1_000_000));
        assert!(track.step(true, 9, false, 1_000_000));
        assert!(Track::new(0).start(true, false), "without a pulse the bit itself counts");
    }

    #[test]
    fn both_logics_at_once_are_none() {
        assert_eq!(check_mode(12 + 16, 6), Err(Fault::new(Code::AMK_TRACK_LOGIC).of(6).with(28, 12)));
        assert_eq!([0, 4, 8, 51].map(|mode| check_mode(mode, 6)), [Ok(()); 4]);
    }
}

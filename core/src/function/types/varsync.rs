//! Synchronous ratio that inputs or a word select (VARSYNC).
//!
//! Law      acc = acc + m * dXm; Xs = base + floor(acc / 10000), base = value of the sink at START; out = Xs + SAK. The
//!          remainder is kept when the ratio changes: a change alters the slope and loses nothing. Mode 0: E1 selects
//!          m1 or m2. Mode 1: a rising E1 selects m(1 + E2 + 2*E3 + 4*E4). Mode 2: (E2,E1) = 00 m1, 01 m2, 10 m3, 11
//!          keeps the ratio. Mode 3: a word is the ratio, in each call
//! Reads    the travel of the master, E1 to E4, in mode 3 the word; inputs of a call apply to its travel
//! Writes   the sink, A1 (mode 0: E1; mode 1: a ratio was selected; otherwise 0), the compensation of SAK
//! Refuses  mode 3 without a word, or with a cycle that differs from that of the slot
//! Source   AMK-VARSYNC-01 to -16 with A-38 to -40, AMK-SAK-05

use crate::code::Code;
use crate::function::guest::*;
use crate::function::sak::Sak;
use crate::function::time::check_cycle;
use serde::{Deserialize, Serialize};

/// The parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new(
        "mode",
        0,
        3,
        "",
        "chooses the ratio: 0 by E1, 1 by an edge of E1, 2 by E1 and E2, 3 by a word",
        "AMK-VARSYNC-01",
    ),
    Field::new("sak", 0, 32_767, "1/128 calls", "compensation of the following error", "AMK-VARSYNC-02"),
    Field::new("sf_cycle", 0, 32_767, "0.5 ms", "the slot's cycle, in mode 3; 0: not compared", "AMK-VARSYNC-03"),
    ratio("m1", "ratio of modes 0 to 2", "AMK-VARSYNC-04"),
    ratio("m2", "ratio of modes 0 to 2", "AMK-VARSYNC-04"),
    ratio("m3", "ratio of modes 1 and 2", "AMK-VARSYNC-05"),
    ratio("m4", "ratio of mode 1", "AMK-VARSYNC-06"),
    ratio("m5", "ratio of mode 1", "AMK-VARSYNC-06"),
    ratio("m6", "ratio of mode 1", "AMK-VARSYNC-06"),
    ratio("m7", "ratio of mode 1", "AMK-VARSYNC-06"),
    ratio("m8", "ratio of mode 1", "AMK-VARSYNC-06"),
];

const fn ratio(name: &'static str, help: &'static str, source: &'static str) -> Field {
    Field::new(name, i16::MIN as i64, i16::MAX as i64, "0.0001", help, source)
}

const MODE: usize = place(FIELDS, "mode");
const SAK: usize = place(FIELDS, "sak");
const SF_CYCLE: usize = place(FIELDS, "sf_cycle");
const M1: usize = place(FIELDS, "m1");

/// Ratio 1.
const ONE: i64 = 10_000;

/// Selection of the ratio.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Mode {
    Level,
    Edge,
    TwoLevels,
    Word,
}

impl Mode {
    fn of(number: i64) -> Self {
        match number {
            0 => Self::Level,
            1 => Self::Edge,
            2 => Self::TwoLevels,
            _ => Self::Word,
        }
    }
}

/// State of the function.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::function) struct Varsync {
    /// Whether the slot has a word for mode 3.
    has_word: bool,
    mode: Mode,
    ratios: [i16; LINES],
    /// Active ratio.
    ratio: i16,
    /// Mode 1: whether a ratio was selected since E1 rose.
    taken: bool,
    /// Inputs of the last call.
    before: u8,
    /// Travel of the master at the last call.
    master: i64,
    /// Slave position Xs.
    slave: i64,
    /// Fraction of Xs, in 0..ONE.
    remainder: i64,
    sak: Sak,
}

impl Varsync {
    /// Activates the ratio of a selection, counted from 0; a selection that does not exist keeps the ratio.
    #[inline]
    fn select_ratio(&mut self, selection: u8) {
        self.ratio = self.ratios.get(usize::from(selection)).copied().unwrap_or(self.ratio);
    }

    /// Selects the ratio and returns A1.
    #[inline]
    fn select(&mut self, seen: &CallInputs<'_>) -> bool {
        let e1 = seen.inputs & 1;
        let is_edge = e1 & !std::mem::replace(&mut self.before, seen.inputs) != 0;
        match self.mode {
            Mode::Level => {
                self.select_ratio(e1);
                e1 != 0
            }
            Mode::Edge => {
                if is_edge {
                    self.select_ratio(seen.inputs >> 1 & 0b111);
                }
                self.taken = is_edge || (self.taken && e1 != 0);
                self.taken
            }
            Mode::TwoLevels => {
                let both = seen.inputs & 0b11;
                if both != 0b11 {
                    self.select_ratio(both);
                }
                false
            }
            Mode::Word => {
                // A flag word has 16 bits.
                self.ratio = seen.words[0] as i16;
                false
            }
        }
    }

    /// Advances Xs by the ratio times the change of the master; positions of 64 bits wrap.
    #[inline]
    fn advance(&mut self, change: i64) {
        let ratio = i64::from(self.ratio);
        // m * change = m * (whole * 10000 + part): the whole parts need no division, the rest is below 2^15 * 10000 +
        // 10000.
        let (whole, part) = (change / ONE, change % ONE);
        let rest = ratio.wrapping_mul(part).wrapping_add(self.remainder);
        let way = rest.div_euclid(ONE);
        self.remainder = rest.wrapping_sub(way.wrapping_mul(ONE));
        self.slave = self.slave.wrapping_add(ratio.wrapping_mul(whole)).wrapping_add(way);
    }
}

impl SlotType for Varsync {
    const DESCRIPTION: Description = Description {
        source: Requirement::Must,
        moves_axes: true,
        inputs: 4,
        outputs: 1,
        words: &["word_addr"],
        shows: OF_SAK,
        ..Description::of(Kind::Varsync, "varsync", "gears its sink to its source by ratios that inputs choose", FIELDS)
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        let [has_word, _] = setup.has_words;
        Self {
            has_word,
            mode: Mode::Level,
            ratios: [0; LINES],
            ratio: 0,
            taken: false,
            before: 0,
            master: 0,
            slave: 0,
            remainder: 0,
            sak: Sak::default(),
        }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        self.has_word == other.has_word
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        if Mode::of(words.get(MODE)) != Mode::Word {
            // Values that only mode 3 uses are not checked in other modes.
            return Ok(());
        }
        if !self.has_word {
            return Err(Fault::new(Code::AMK_NO_WORD).of(number(FIELDS, "mode")));
        }
        check_cycle(words.get(SF_CYCLE), number(FIELDS, "sf_cycle"), setting)
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        let ratios = std::array::from_fn(|n| words.get(M1 + n) as i16);
        *self = Self {
            mode: Mode::of(words.get(MODE)),
            ratios,
            // Before the first selection.
            ratio: ratios.first().copied().unwrap_or(0),
            before: seen.inputs,
            master: seen.source.travel,
            slave: seen.sink,
            sak: Sak::new(words.get(SAK), seen.sink),
            ..Self::new(&SlotSetup::of_words([self.has_word, false]))
        };
        self.step(seen)
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let a1 = self.select(seen);
        let travel = seen.source.travel;
        let change = travel.wrapping_sub(std::mem::replace(&mut self.master, travel));
        self.advance(change);
        let sak_share = self.sak.share(self.slave);
        Outcome {
            sink: self.slave.wrapping_add(sak_share),
            outputs: a1.into(),
            writes: 1,
            sak_share,
            ..Outcome::default()
        }
    }

    fn is_valid_state(&self) -> bool {
        (0..ONE).contains(&self.remainder)
    }
}

#[cfg(test)]
mod tests;

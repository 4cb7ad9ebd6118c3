//! One source of counts, whatever its words are.
//!
//! Law      a good word moves the position by the shortest way from the one before. Where bad words are corrected, the position
//!          goes on with the last change instead, at most 100 times in a row; from then on words are taken as they are, which a
//!          supervision of the motion sees as a jump, until one follows from the one before (MACS-ENC-08)
//! Refuses  a bad word where nothing corrects it: no value, no motion. A step that is too large is believed once the next
//!          word confirms it: an absolute encoder cannot lose its place
//! Source   MACS-ENC-01, -07, -08, A-11, WF-ABS-04

use super::{Absolute, Bad, Circle, Counter};
use serde::{Deserialize, Serialize};

/// Most bad words in a row that are replaced.
pub const MOST_SUBSTITUTED: u32 = 100;

/// What the words of a source are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// Counts of so many bits, 1 to 64.
    Incremental(u32),
    /// Words of an absolute encoder.
    Absolute(Absolute),
}

impl Form {
    /// Where its counts begin anew.
    pub fn circle(self) -> Circle {
        match self {
            Self::Incremental(bits) => Circle::Bits(bits),
            Self::Absolute(encoder) if encoder.overflow => Circle::Steps(encoder.words()),
            Self::Absolute(_) => Circle::Line,
        }
    }

    /// The count of a word.
    fn decode(self, word: i64) -> Option<i64> {
        match self {
            Self::Incremental(_) => Some(word),
            Self::Absolute(encoder) => encoder.decode(word),
        }
    }

    /// The largest step from word to word that is believed (inc).
    fn largest_step(self) -> Option<i64> {
        match self {
            Self::Incremental(_) => None,
            Self::Absolute(encoder) => encoder.largest_step(),
        }
    }

    /// Are bad words replaced?
    fn corrects(self) -> bool {
        matches!(self, Self::Absolute(encoder) if encoder.corrects)
    }
}

/// What a cycle has read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// (inc)
    pub change: i64,
    /// There is a value that may be used.
    pub valid: bool,
    /// The value was made up for one that could not be used.
    pub substituted: bool,
    /// The coordinate began anew: the first value, or a new epoch.
    pub restarted: bool,
}

/// Reads one source.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Reader {
    form: Form,
    counter: Counter,
    /// Change of the last two good words in a row (inc).
    pace: i64,
    /// Count of a step that was not believed.
    doubted: Option<i64>,
    bad: u32,
    errors: u64,
}

impl Reader {
    /// Before the first word.
    pub fn new(form: Form) -> Self {
        Self { form, counter: Counter::on(form.circle()), pace: 0, doubted: None, bad: 0, errors: 0 }
    }

    /// What its words are.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Its words are judged by this form from now on; what they stand for stays.
    pub fn judge_by(&mut self, form: Form) {
        if form.circle() == self.form.circle() {
            self.form = form;
        }
    }

    /// Could its state have come about?
    pub fn is_sound(&self) -> bool {
        let form = match self.form {
            Form::Incremental(bits) => (1..=64).contains(&bits),
            Form::Absolute(encoder) => encoder.is_sound(),
        };
        form && self.counter.circle() == self.form.circle()
    }

    /// The epoch of the last word that was taken; none before the first one.
    pub fn epoch(&self) -> Option<u32> {
        self.counter.last().map(|(_, epoch)| epoch)
    }

    /// Takes the word of this cycle.
    #[inline]
    pub fn take(&mut self, word: i64, epoch: u32, valid: bool) -> Reading {
        // Any count follows from the one before.
        if matches!(self.form, Form::Incremental(_)) && valid && self.epoch() == Some(epoch) {
            return self.follow(word, epoch);
        }
        self.take_word(word, epoch, valid)
    }

    fn take_word(&mut self, word: i64, epoch: u32, valid: bool) -> Reading {
        let count = self.form.decode(word).filter(|_| valid);
        match (self.counter.last(), count) {
            (Some((last, same)), count) if same == epoch => match self.judge(last, count) {
                Ok(count) => self.follow(count, epoch),
                Err(bad) => self.survive(bad, last, count, epoch),
            },
            // The first word of a coordinate: there is nothing to compare it with.
            (_, Some(count)) => {
                self.counter.take(count, epoch);
                (self.pace, self.bad, self.doubted) = (0, 0, None);
                Reading { valid: true, restarted: true, ..Reading::default() }
            }
            (_, None) => {
                self.count_bad();
                Reading::default()
            }
        }
    }

    /// Is it a count that the encoder can have come to?
    fn judge(&self, last: i64, count: Option<i64>) -> Result<i64, Bad> {
        let count = count.ok_or(Bad::NoWord)?;
        let circle = self.form.circle();
        let is_small = |from: i64| {
            let largest = self.form.largest_step();
            largest.is_none_or(|most| circle.way(from, count).unsigned_abs() <= most.unsigned_abs())
        };
        let is_confirmed = !self.form.corrects() && self.doubted.is_some_and(is_small);
        if is_small(last) || is_confirmed { Ok(count) } else { Err(Bad::Step) }
    }

    #[inline]
    fn follow(&mut self, count: i64, epoch: u32) -> Reading {
        let change = self.counter.take(count, epoch);
        // The first good word behind bad ones also makes up for what was guessed.
        self.pace = if self.bad == 0 { change } else { self.pace };
        (self.bad, self.doubted) = (0, None);
        Reading { change, valid: true, ..Reading::default() }
    }

    fn survive(&mut self, bad: Bad, last: i64, count: Option<i64>, epoch: u32) -> Reading {
        self.count_bad();
        if !self.form.corrects() {
            self.doubted = count.filter(|_| bad == Bad::Step);
            return Reading::default();
        }
        if self.bad <= MOST_SUBSTITUTED {
            let guess = self.around(last.saturating_add(self.pace));
            let change = self.counter.take(guess, epoch);
            return Reading { change, valid: true, substituted: true, ..Reading::default() };
        }
        // No more guessing: it counts what stands there, if anything does.
        let Some(count) = count else { return Reading::default() };
        let change = self.counter.take(count, epoch);
        self.pace = 0;
        Reading { change, valid: true, ..Reading::default() }
    }

    /// A count as the encoder would tell it.
    fn around(&self, count: i64) -> i64 {
        match self.form.circle() {
            Circle::Steps(steps) => count.rem_euclid(steps),
            _ => count,
        }
    }

    fn count_bad(&mut self) {
        self.bad = self.bad.saturating_add(1);
        self.errors = self.errors.saturating_add(1);
    }

    /// Would the same word again change nothing?
    pub fn is_settled(&self) -> bool {
        self.is_good() && self.pace == 0
    }

    /// Was the last word a good one, like all that it could be mistaken for?
    pub fn is_good(&self) -> bool {
        self.bad == 0 && self.doubted.is_none()
    }

    /// Bad words in a row up to this cycle.
    pub fn bad_in_a_row(&self) -> u32 {
        self.bad
    }

    /// Bad words so far (SYSVAR 16).
    pub fn errors(&self) -> u64 {
        self.errors
    }

    /// The position so far (inc).
    pub fn position(&self) -> i64 {
        self.counter.position()
    }

    /// The count that the position stands for; none before the first one.
    pub fn count(&self) -> Option<i64> {
        self.counter.last().map(|(count, _)| count)
    }

    /// The position of a word near the last one (inc).
    pub fn locate(&self, word: i64) -> i64 {
        self.form.decode(word).map_or(self.counter.position(), |count| self.counter.locate(count))
    }

    /// Every position is `by` (inc) more from now on.
    pub fn shift(&mut self, by: i64) {
        self.counter.shift(by);
    }

    /// Moved by so much (inc), as someone else has counted.
    pub fn advance(&mut self, change: i64) {
        self.counter.advance(change);
    }
}

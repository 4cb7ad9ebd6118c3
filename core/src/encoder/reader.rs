//! Reads one source of counts, with values of any form.
//!
//! Law      a good value moves the position by the shortest distance from the one before. If bad values are corrected,
//!          the position continues with the last change instead, at most 100 times in succession. After that, values
//!          are used as they are, which the supervision of the motion detects as a jump, until one follows from the one
//!          before (MACS-ENC-08)
//! Refuses  a bad value without correction: neither value nor motion. Too large a step is accepted once the next value
//!          confirms it: an absolute encoder cannot lose its position
//! Source   MACS-ENC-01, -07, -08, A-11, WF-ABS-04

use super::{Absolute, Bad, Circle, Counter};
use serde::{Deserialize, Serialize};

/// Largest number of successive bad values that are replaced.
pub const MOST_SUBSTITUTED: u32 = 100;

/// Form of the values of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// Counts of that number of bits, 1 to 64.
    Incremental(u32),
    /// Code words of an absolute encoder.
    Absolute(Absolute),
}

impl Form {
    /// Returns the range at which its counts wrap.
    pub fn circle(self) -> Circle {
        match self {
            Self::Incremental(bits) => Circle::Bits(bits),
            Self::Absolute(encoder) if encoder.overflow => Circle::Steps(encoder.words()),
            Self::Absolute(_) => Circle::Line,
        }
    }

    /// Returns the count of a value.
    fn decode(self, word: i64) -> Option<i64> {
        match self {
            Self::Incremental(_) => Some(word),
            Self::Absolute(encoder) => encoder.decode(word),
        }
    }

    /// Returns the largest accepted step between two values (inc).
    fn largest_step(self) -> Option<i64> {
        match self {
            Self::Incremental(_) => None,
            Self::Absolute(encoder) => encoder.largest_step(),
        }
    }

    /// Whether bad values are replaced.
    fn corrects(self) -> bool {
        matches!(self, Self::Absolute(encoder) if encoder.corrects)
    }
}

/// Result of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// Change of the position (inc).
    pub change: i64,
    /// Whether there is a usable value.
    pub valid: bool,
    /// Whether the value replaces an unusable one.
    pub substituted: bool,
    /// Whether the coordinate started again: the first value, or a new epoch.
    pub restarted: bool,
}

/// State of the reader of one source.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Reader {
    form: Form,
    counter: Counter,
    /// Change between the last two successive good values (inc).
    pace: i64,
    /// Count of a step that was not accepted yet.
    doubted: Option<i64>,
    bad: u32,
    errors: u64,
}

impl Reader {
    /// Returns the state before the first value.
    pub fn new(form: Form) -> Self {
        Self { form, counter: Counter::on(form.circle()), pace: 0, doubted: None, bad: 0, errors: 0 }
    }

    /// Returns the form of its values.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Checks values by this form from now on; the conversion to counts stays the same.
    pub fn set_check_form(&mut self, form: Form) {
        if form.circle() == self.form.circle() {
            self.form = form;
        }
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        let form = match self.form {
            Form::Incremental(bits) => (1..=64).contains(&bits),
            Form::Absolute(encoder) => encoder.is_sound(),
        };
        form && self.counter.circle() == self.form.circle()
    }

    /// Returns the epoch of the last accepted value; none before the first one.
    pub fn epoch(&self) -> Option<u32> {
        self.counter.last().map(|(_, epoch)| epoch)
    }

    /// Reads the value of this cycle.
    #[inline]
    pub fn take(&mut self, word: i64, epoch: u32, valid: bool) -> Reading {
        // Every count of an incremental encoder is valid.
        if matches!(self.form, Form::Incremental(_)) && valid && self.epoch() == Some(epoch) {
            return self.follow(word, epoch);
        }
        self.take_word(word, epoch, valid)
    }

    fn take_word(&mut self, word: i64, epoch: u32, valid: bool) -> Reading {
        let count = self.form.decode(word).filter(|_| valid);
        match (self.counter.last(), count) {
            (Some((last, same)), count) if same == epoch => match self.check_reachable(last, count) {
                Ok(count) => self.follow(count, epoch),
                Err(bad) => self.substitute(bad, last, count, epoch),
            },
            // The first value of a coordinate: there is nothing for a comparison.
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

    /// Checks whether the encoder can have reached a count.
    fn check_reachable(&self, last: i64, count: Option<i64>) -> Result<i64, Bad> {
        let count = count.ok_or(Bad::NoWord)?;
        let circle = self.form.circle();
        let is_small = |from: i64| {
            let largest = self.form.largest_step();
            largest.is_none_or(|most| circle.shortest_distance(from, count).unsigned_abs() <= most.unsigned_abs())
        };
        let is_confirmed = !self.form.corrects() && self.doubted.is_some_and(is_small);
        if is_small(last) || is_confirmed { Ok(count) } else { Err(Bad::Step) }
    }

    #[inline]
    fn follow(&mut self, count: i64, epoch: u32) -> Reading {
        let change = self.counter.take(count, epoch);
        // The first good value after bad ones also corrects the error of the extrapolation.
        self.pace = if self.bad == 0 { change } else { self.pace };
        (self.bad, self.doubted) = (0, None);
        Reading { change, valid: true, ..Reading::default() }
    }

    fn substitute(&mut self, bad: Bad, last: i64, count: Option<i64>, epoch: u32) -> Reading {
        self.count_bad();
        if !self.form.corrects() {
            self.doubted = count.filter(|_| bad == Bad::Step);
            return Reading::default();
        }
        if self.bad <= MOST_SUBSTITUTED {
            let guess = self.wrapped(last.saturating_add(self.pace));
            let change = self.counter.take(guess, epoch);
            return Reading { change, valid: true, substituted: true, ..Reading::default() };
        }
        // No more extrapolation: the value is used as it is, if there is one.
        let Some(count) = count else { return Reading::default() };
        let change = self.counter.take(count, epoch);
        self.pace = 0;
        Reading { change, valid: true, ..Reading::default() }
    }

    /// Returns a count wrapped at the range of the encoder.
    fn wrapped(&self, count: i64) -> i64 {
        match self.form.circle() {
            Circle::Steps(steps) => count.rem_euclid(steps),
            _ => count,
        }
    }

    fn count_bad(&mut self) {
        self.bad = self.bad.saturating_add(1);
        self.errors = self.errors.saturating_add(1);
    }

    /// Whether the same value again would change nothing.
    pub fn is_settled(&self) -> bool {
        self.is_good() && self.pace == 0
    }

    /// Whether the last value was good, and no step is waiting for confirmation.
    pub fn is_good(&self) -> bool {
        self.bad == 0 && self.doubted.is_none()
    }

    /// Returns the number of successive bad values up to this cycle.
    pub fn bad_in_a_row(&self) -> u32 {
        self.bad
    }

    /// Returns the number of bad values so far (SYSVAR 16).
    pub fn errors(&self) -> u64 {
        self.errors
    }

    /// Returns the position (inc).
    pub fn position(&self) -> i64 {
        self.counter.position()
    }

    /// Returns the count of the present position; none before the first one.
    pub fn count(&self) -> Option<i64> {
        self.counter.last().map(|(count, _)| count)
    }

    /// Returns the position of a value near the last one (inc).
    pub fn locate(&self, word: i64) -> i64 {
        self.form.decode(word).map_or(self.counter.position(), |count| self.counter.locate(count))
    }

    /// Increases all positions by `by` (inc).
    pub fn shift(&mut self, by: i64) {
        self.counter.shift(by);
    }

    /// Adds a change (inc) that was counted elsewhere.
    pub fn advance(&mut self, change: i64) {
        self.counter.advance(change);
    }
}

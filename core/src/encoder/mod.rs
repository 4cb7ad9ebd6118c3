//! Counts to positions.
//!
//! Law      position(k) = position(k-1) + change, change = count(k) - count(k-1), the shortest way around the source's circle
//! Reads    raw words of a source, their epoch and validity
//! Writes   a position that does not wrap (inc), its change and its velocity
//! Refuses  a value that is none: the last position stays, the change is 0, and it is reported; a source that corrects puts an
//!          extrapolated one in its place, at most 100 times in a row
//! Source   MACS-ENC-01, -07, -08, A-11; a new epoch is no motion (contract section 8)

mod absolute;
mod counter;
mod pulses;
mod reader;
pub mod source;

pub use absolute::{Absolute, Bad, Parity, WordCode};
pub use counter::{Circle, Counter};
pub use pulses::{PulseCheck, Pulses};
pub use reader::{Form, MOST_SUBSTITUTED, Reader, Reading};
pub use source::Feedback;

use crate::drive::EncoderInput;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// By how much counts are uneven (inc).
pub const COUNT: f64 = 1.0;

/// What an axis can follow, as it stands in this cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lead {
    /// (inc)
    pub position: Position,
    /// Change since the last cycle (inc).
    pub change: Position,
    /// (inc/s)
    pub velocity: f64,
    /// By how much a change may differ from another one at the same speed (inc): 0 of what is generated, one count of what is counted.
    pub uneven: f64,
    /// False: the encoder is lost, and who follows it must stop.
    pub valid: bool,
}

/// What an encoder tells once, when it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Told {
    /// The encoder gives no value that can be used.
    Invalid,
    /// A bad value was replaced by an extrapolated one, the first of a row.
    Substituted,
    /// Pulses are missing or too many (inc).
    Pulses {
        /// By so many.
        by: i64,
        /// So many are allowed.
        tolerance: i64,
    },
}

/// An entry of section `encoders`, which any number of axes may use.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Encoder {
    reader: Reader,
    check: Option<PulseCheck>,
    pulses: Pulses,
    lead: Lead,
    /// Its counts began anew in this cycle.
    anew: bool,
}

impl Encoder {
    /// An encoder whose words have that form.
    pub fn new(form: Form, check: Option<PulseCheck>) -> Self {
        let lead = Lead { uneven: COUNT, ..Lead::default() };
        Self { reader: Reader::new(form), check, pulses: Pulses::default(), lead, anew: false }
    }

    /// Are its words those of an absolute encoder?
    pub fn is_absolute(&self) -> bool {
        matches!(self.reader.form(), Form::Absolute(_))
    }

    /// Is it the same encoder, wherever it stands?
    pub fn is_set_up_as(&self, other: &Self) -> bool {
        self.reader.form() == other.reader.form() && self.check == other.check
    }

    /// Could its state have come about?
    pub fn is_sound(&self) -> bool {
        self.reader.is_sound() && self.lead.velocity.is_finite()
    }

    /// One cycle; what begins in it is told.
    pub fn step(&mut self, input: &EncoderInput, cycle_s: f64) -> Option<Told> {
        let was_valid = self.lead.valid;
        let epoch = self.reader.epoch();
        let reading = self.reader.take(input.count, input.epoch, input.valid);
        self.anew = epoch.is_some() && epoch != self.reader.epoch();
        let position = self.reader.position();
        let mark = input.index.filter(|_| reading.valid).map(|count| self.reader.locate(count));
        if reading.restarted {
            self.pulses = Pulses::default();
        }
        let off = self.check.and_then(|check| self.pulses.step(&check, position, reading.change, mark));
        self.lead = Lead {
            position: Position::whole(position),
            change: Position::whole(reading.change),
            velocity: reading.change as f64 / cycle_s,
            uneven: COUNT,
            valid: reading.valid && off.is_none(),
        };
        match off {
            Some(by) => Some(Told::Pulses { by, tolerance: self.check.map_or(0, |check| check.tolerance) }),
            None if was_valid && !reading.valid => Some(Told::Invalid),
            None if reading.substituted && self.reader.bad_in_a_row() == 1 => Some(Told::Substituted),
            None => None,
        }
    }

    /// Did its counts begin anew in this cycle? That was no motion, but what was known of their zero does not hold any more.
    pub fn is_anew(&self) -> bool {
        self.anew
    }

    /// Its value is `by` (inc) more from now on, for whoever reads it. That is no motion.
    pub fn shift(&mut self, by: i64) {
        self.reader.shift(by);
        self.pulses.shift(by);
        self.lead.position += Position::whole(by);
    }

    /// The position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64) -> i64 {
        self.reader.locate(count)
    }

    /// Bad values so far.
    pub fn errors(&self) -> u64 {
        self.reader.errors()
    }

    /// As of this cycle.
    pub fn lead(&self) -> Lead {
        self.lead
    }
}

#[cfg(test)]
mod tests;

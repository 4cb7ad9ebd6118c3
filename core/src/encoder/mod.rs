//! Converts counts to positions.
//!
//! Law      position(k) = position(k-1) + change, change = count(k) - count(k-1), the shortest distance in the range of
//!          the source
//! Reads    raw values of a source, their epoch and validity
//! Writes   a position that does not wrap (inc), its change and its velocity
//! Refuses  an invalid value: the last position stays, the change is 0, and it is reported. A source with correction
//!          replaces it by an extrapolated value, at most 100 times in succession
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

/// Unevenness of counts (inc).
pub const COUNT: f64 = 1.0;

/// Values of a leader in this cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lead {
    /// Position (inc).
    pub position: Position,
    /// Change since the last cycle (inc).
    pub change: Position,
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Difference between changes at the same speed (inc): 0 for a generated leader, one count for a counted one.
    pub uneven: f64,
    /// Whether the values are valid. Otherwise the encoder is lost, and its followers must stop.
    pub valid: bool,
}

/// Event of an encoder, reported once at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EncoderReport {
    /// The encoder has no usable value.
    Invalid,
    /// A bad value was replaced by an extrapolated one, the first of a series.
    Substituted,
    /// Pulses are missing or surplus.
    Pulses {
        /// Their number (inc).
        by: i64,
        /// Allowed number (inc).
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
    /// Whether its counts started again in this cycle.
    anew: bool,
}

impl Encoder {
    /// Returns an encoder with values of that form.
    pub fn new(form: Form, check: Option<PulseCheck>) -> Self {
        let lead = Lead { uneven: COUNT, ..Lead::default() };
        Self { reader: Reader::new(form), check, pulses: Pulses::default(), lead, anew: false }
    }

    /// Whether it is an absolute encoder.
    pub fn is_absolute(&self) -> bool {
        matches!(self.reader.form(), Form::Absolute(_))
    }

    /// Whether it is the same encoder, at any position.
    pub fn is_set_up_as(&self, other: &Self) -> bool {
        self.reader.form() == other.reader.form() && self.check == other.check
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        self.reader.is_sound() && self.lead.velocity.is_finite()
    }

    /// Advances by one cycle and returns an event that begins in it.
    pub fn step(&mut self, input: &EncoderInput, cycle_s: f64) -> Option<EncoderReport> {
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
            Some(by) => Some(EncoderReport::Pulses { by, tolerance: self.check.map_or(0, |check| check.tolerance) }),
            None if was_valid && !reading.valid => Some(EncoderReport::Invalid),
            None if reading.substituted && self.reader.bad_in_a_row() == 1 => Some(EncoderReport::Substituted),
            None => None,
        }
    }

    /// Whether its counts started again in this cycle. This is no motion, but its zero is no longer valid.
    pub fn is_restarted(&self) -> bool {
        self.anew
    }

    /// Increases its value by `by` (inc) for all its users. This is no motion.
    pub fn shift(&mut self, by: i64) {
        self.reader.shift(by);
        self.pulses.shift(by);
        self.lead.position += Position::whole(by);
    }

    /// Returns the position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64) -> i64 {
        self.reader.locate(count)
    }

    /// Returns the number of bad values so far.
    pub fn errors(&self) -> u64 {
        self.reader.errors()
    }

    /// Returns its lead of this cycle.
    pub fn lead(&self) -> Lead {
        self.lead
    }
}

#[cfg(test)]
mod tests;

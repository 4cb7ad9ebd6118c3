//! Counts to positions.
//!
//! Law      position(k) = position(k-1) + change, change = count(k) - count(k-1), the shortest way around 2^bits
//! Reads    raw counts of `bits` width, their epoch and validity
//! Writes   a position that does not wrap (inc), its change and its velocity
//! Refuses  an invalid value: the last position stays, the change is 0, and it is reported
//! Source   MACS-ENC-07; a new epoch is no motion (contract section 8)

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Unwraps the counts of one source.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Counter {
    bits: u32,
    last: Option<(i64, u32)>,
    position: i64,
}

impl Counter {
    /// A source of counts of 1 to 64 bits.
    pub fn new(bits: u32) -> Self {
        Self { bits: bits.clamp(1, 64), last: None, position: 0 }
    }

    /// Does it unwrap counts of the same width?
    pub fn has_width_of(&self, other: &Self) -> bool {
        self.bits == other.bits
    }

    /// Takes the counts of this cycle and returns their change (inc); the first counts are the position itself.
    pub fn take(&mut self, count: i64, epoch: u32) -> i64 {
        let change = match self.last {
            Some((last, same)) if same == epoch => self.shortest(count, last),
            Some(_) => 0,
            None => {
                self.position = count;
                0
            }
        };
        self.last = Some((count, epoch));
        // Beyond 2^63 the position wraps, as its source would.
        self.position = self.position.wrapping_add(change);
        change
    }

    /// The position of raw counts near the last ones (inc).
    pub fn locate(&self, count: i64) -> i64 {
        let (last, _) = self.last.unwrap_or((count, 0));
        self.position.wrapping_add(self.shortest(count, last))
    }

    /// The position so far (inc).
    pub fn position(&self) -> i64 {
        self.position
    }

    /// The shortest way from `last` to `count` on a circle of 2^bits.
    fn shortest(&self, count: i64, last: i64) -> i64 {
        // Shifting the difference to the top and back extends its sign; wrapping is the point.
        let spare = 64 - self.bits;
        count.wrapping_sub(last).wrapping_shl(spare).wrapping_shr(spare)
    }
}

/// What an axis can follow, as it stands in this cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lead {
    /// (inc)
    pub position: Position,
    /// Change since the last cycle (inc).
    pub change: Position,
    /// (inc/s)
    pub velocity: f64,
    /// Counted, so that its change is uneven by one increment; else generated.
    pub counted: bool,
    /// False: it is lost, and who follows it must stop.
    pub valid: bool,
}

/// An encoder that leads.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Encoder {
    counter: Counter,
    lead: Lead,
}

impl Encoder {
    /// An encoder of `bits` width.
    pub fn new(bits: u32) -> Self {
        Self { counter: Counter::new(bits), lead: Lead { counted: true, ..Lead::default() } }
    }

    /// Does it unwrap counts of the same width?
    pub fn has_width_of(&self, other: &Self) -> bool {
        self.counter.has_width_of(&other.counter)
    }

    /// One cycle.
    pub fn step(&mut self, count: i64, epoch: u32, valid: bool, cycle_s: f64) -> Lead {
        let change = if valid { self.counter.take(count, epoch) } else { 0 };
        self.lead = Lead {
            position: Position::whole(self.counter.position()),
            change: Position::whole(change),
            velocity: change as f64 / cycle_s,
            counted: true,
            valid,
        };
        self.lead
    }

    /// The position of raw counts near those of this cycle (inc).
    pub fn locate(&self, count: i64) -> i64 {
        self.counter.locate(count)
    }

    /// As of this cycle.
    pub fn lead(&self) -> Lead {
        self.lead
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_16_bit_source_wraps_without_a_trace_in_both_directions() {
        let mut counter = Counter::new(16);
        for count in [65_530, 65_535, 4, 9, 65_533, 65_528] {
            counter.take(count, 0);
        }
        assert_eq!(counter.position(), 65_530 + 5 + 5 + 5 - 12 - 5);
    }

    #[test]
    fn a_32_bit_source_wraps_without_a_trace() {
        let mut counter = Counter::new(32);
        let start = i64::from(i32::MAX) - 2;
        counter.take(start, 0);
        counter.take(i64::from(i32::MIN) + 2, 0);
        assert_eq!(counter.position(), start + 5);
        counter.take(i64::from(i32::MAX), 0);
        assert_eq!(counter.position(), start + 2);
    }

    #[test]
    fn a_new_epoch_is_no_motion() {
        let mut counter = Counter::new(64);
        counter.take(1000, 1);
        assert_eq!(counter.take(0, 2), 0);
        assert_eq!(counter.take(3, 2), 3);
        assert_eq!(counter.position(), 1003);
    }

    #[test]
    fn an_invalid_value_is_left_out_and_what_moved_meanwhile_is_caught_up() {
        let mut encoder = Encoder::new(64);
        encoder.step(10, 0, true, 0.001);
        assert!(!encoder.step(999_999, 0, false, 0.001).valid);
        assert_eq!(encoder.lead().change, Position::ZERO);
        assert_eq!(encoder.step(13, 0, true, 0.001).position, Position::whole(13));
    }

    proptest! {
        #[test]
        fn any_walk_of_any_width_is_followed(
            bits in 3_u32..=64, start in any::<i64>(), steps in prop::collection::vec(-3_i64..=3, 1..300),
        ) {
            let mask = if bits == 64 { u64::MAX } else { (1 << bits) - 1 };
            let mut counter = Counter::new(bits);
            let mut real = start;
            counter.take((real as u64 & mask) as i64, 0);
            let first = counter.position();
            for step in steps {
                real = real.wrapping_add(step);
                prop_assert_eq!(counter.take((real as u64 & mask) as i64, 0), step);
            }
            prop_assert_eq!(counter.position().wrapping_sub(first), real.wrapping_sub(start));
        }
    }
}

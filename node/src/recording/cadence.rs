//! Selects the cycles in which states are published and recorded.

use std::ops::Range;

/// Cycles selected by a rate: each cycle k in which floor(k T rate) differs from its value at k - 1, and cycle 0.
///
/// The product T rate is the exact reduced fraction `share / whole`.
#[derive(Clone, Debug, PartialEq)]
pub struct Cadence {
    share: u128,
    whole: u128,
    /// Range of cycles in which none is due. It limits 128-bit divisions to one per due cycle.
    pause: Range<u64>,
}

impl Cadence {
    /// Creates the cadence of a rate in 1/s, rounded to the nearest 1e-9, for a cycle time in ns.
    pub fn new(rate: f64, cycle_ns: u64) -> Self {
        // The cast saturates below 2^64; the cycle time is below 2^64 too.
        let share = u128::from((rate * 1e9).round() as u64) * u128::from(cycle_ns);
        let whole = 1_000_000_000_000_000_000;
        let divisor = greatest_common_divisor(share, whole);
        Self { share: share / divisor, whole: whole / divisor, pause: 0..0 }
    }

    /// Returns the fraction of cycles that are due, 0 to 1.
    pub fn share(&self) -> f64 {
        (self.share as f64 / self.whole as f64).min(1.0)
    }

    /// Returns true if the cycle is due.
    pub fn is_due(&mut self, cycle: u64) -> bool {
        if self.pause.contains(&cycle) {
            return false;
        }
        self.pause = cycle.saturating_add(1)..self.next_after(cycle);
        self.takes(cycle)
    }

    /// Returns the first cycle after `cycle` that may be due.
    fn next_after(&self, cycle: u64) -> u64 {
        match self.share {
            0 => return u64::MAX,
            share if share >= self.whole => return cycle.saturating_add(1),
            _ => {}
        }
        // The step after floor(k share / whole), below 2^64: with share < whole < 2^60 no product reaches 2^128.
        let step = u128::from(cycle) * self.share / self.whole + 1;
        u64::try_from((step * self.whole).div_ceil(self.share)).unwrap_or(u64::MAX)
    }

    fn takes(&self, cycle: u64) -> bool {
        if cycle == 0 || self.share >= self.whole {
            return true;
        }
        // With share < whole <= 10^18 no product reaches 2^128, and floor(k share / whole) has just increased exactly
        // if the remainder is smaller than the step.
        u128::from(cycle) % self.whole * self.share % self.whole < self.share
    }
}

fn greatest_common_divisor(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

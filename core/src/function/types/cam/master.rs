//! The position that all tracks share, and its velocity.
//!
//! Law      x = source limited to 32 bits (ba 0); sum of differences mod modulo (ba 1); sum of modulo * call / cycle
//!          time mod modulo, with its fraction (ba 2); lead = mean(dx) * dead time / call, in each mode
//! Source   AMK-CAM-03 to -05, AMK-CAM-10, -11, A-55, A-59

use super::hysteresis::Ring;
use crate::function::program::CallInputs;
use crate::function::time::{self, HALF_MS, floor_ratio, wrapped};
use crate::function::window::Window;
use serde::{Deserialize, Serialize};

/// Parts per increment in the travel of the time mode.
const PARTS: i128 = 1 << 28;

/// The quantity that x measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Base {
    Absolute,
    Incremental,
    Time,
}

/// The shared position.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Master {
    base: Base,
    /// Modulo, in increments; above 0.
    modulo: i64,
    x: i64,
    /// Travel of the source at the last call.
    travel: i64,
    /// Time mode: duration of a turn in ns, and the fraction of x in inc / turn_ns.
    turn_ns: i64,
    rest: i64,
    /// Time mode: whether x has moved since START.
    runs: bool,
}

impl Master {
    /// Returns the master at START.
    pub(super) fn new(ba: i64, modulo: i64, cycle_time: u16, seen: &CallInputs<'_>) -> Self {
        let base = match ba {
            0 => Base::Absolute,
            1 => Base::Incremental,
            _ => Base::Time,
        };
        let x = if base == Base::Absolute { limit_to_32_bits(seen.source.value) } else { 0 };
        let (travel, turn_ns) = (seen.source.travel, turn_ns(cycle_time));
        Self { base, modulo: modulo.max(1), x, travel, turn_ns, rest: 0, runs: false }
    }

    /// Adds the travel or the time since the last call to x.
    #[inline]
    pub(super) fn advance(&mut self, cycle_time: u16, window: &mut Window, seen: &CallInputs<'_>) {
        let travel = seen.source.travel;
        let change = travel.wrapping_sub(std::mem::replace(&mut self.travel, travel));
        match self.base {
            Base::Absolute => {
                self.x = limit_to_32_bits(seen.source.value);
                window.push(change);
            }
            Base::Incremental => {
                // Both terms are within the modulo, which is below 2^30.
                self.x = wrapped(self.x.wrapping_add(change % self.modulo.max(1)), self.modulo);
                window.push(change);
            }
            Base::Time => {
                self.run(turn_ns(cycle_time), seen.call_ns);
                window.push(self.way(seen.call_ns));
            }
        }
    }

    /// Advances x in time mode. At a new cycle time the fraction is converted, with one rounding.
    fn run(&mut self, turn_ns: i64, call_ns: u64) {
        if turn_ns != self.turn_ns {
            let (rest, turn) = (i128::from(self.rest) * i128::from(turn_ns), i128::from(self.turn_ns.max(1)));
            self.rest = floor_ratio(rest + turn / 2, turn);
            self.turn_ns = turn_ns;
        }
        self.runs = true;
        let way = i128::from(self.modulo) * i128::from(call_ns) + i128::from(self.rest);
        let whole = floor_ratio(way, turn_ns.into());
        // The remainder is below the divisor unless the quotient was limited, which only a restored state can cause.
        self.rest = i64::try_from(way - i128::from(whole) * i128::from(turn_ns)).unwrap_or(0);
        self.x = wrapped(self.x.saturating_add(whole), self.modulo);
    }

    /// Returns the travel per call in time mode, in 2^-28 inc, rounded down.
    fn way(&self, call_ns: u64) -> i64 {
        let (way, turn) = (i128::from(self.modulo) * i128::from(call_ns), i128::from(self.turn_ns.max(1)));
        let whole = floor_ratio(way, turn);
        // The travel per call is below 2^34 inc; only a restored state can saturate.
        let rest = floor_ratio((way - i128::from(whole) * turn).saturating_mul(PARTS), turn);
        whole.saturating_mul(PARTS as i64).saturating_add(rest)
    }

    /// Returns the lead of the mean velocity in a dead time, in time mode, including the fraction of x.
    fn time_lead(&self, dead_time: u16, window: &Window, call_ns: u64) -> i64 {
        let (turn, dead_ns) = (i128::from(self.turn_ns.max(1)), i128::from(dead_time) * i128::from(HALF_MS));
        let (sum, count) = window.mean();
        if sum == count * i128::from(self.way(call_ns)) {
            // All calls of the mean have the present velocity: the result is exact.
            return floor_ratio(i128::from(self.modulo) * dead_ns + i128::from(self.rest), turn);
        }
        let ahead = sum.saturating_mul(dead_ns).div_euclid(count * i128::from(call_ns.max(1)));
        let fraction = i128::from(self.rest).saturating_mul(PARTS).div_euclid(turn);
        floor_ratio(ahead.saturating_add(fraction), PARTS)
    }

    /// Returns the position of a track with an offset and a dead time.
    #[inline]
    pub(super) fn place(&self, offset: i64, dead_time: u16, window: &Window, call_ns: u64) -> i64 {
        let lead = match dead_time {
            0 => 0,
            _ if self.base == Base::Time && self.runs => self.time_lead(dead_time, window, call_ns),
            _ => time::lead(window.mean(), dead_time.into(), call_ns),
        };
        // A saturated lead is at the end of the travel, or comes from a source that has jumped unreasonably far.
        let x = self.x.saturating_add(offset).saturating_add(lead);
        if self.base == Base::Absolute { limit_to_32_bits(x) } else { wrapped(x, self.modulo) }
    }

    /// Returns an offset after a change of its word: a counter of 32 bits, or within the modulo.
    pub(super) fn changed_offset(&self, offset: i64, change: i16) -> i64 {
        let sum = offset.wrapping_add(change.into());
        // The cast wraps like the counter of 32 bits (AMK-BCOM-41).
        if self.base == Base::Absolute { i64::from(sum as i32) } else { wrapped(sum, self.modulo) }
    }

    /// Returns the range of positions.
    pub(super) fn ring(&self) -> Ring {
        if self.base == Base::Absolute { Ring::LINE } else { Ring::of(self.modulo) }
    }

    /// Returns true if x is a position of the ring.
    pub(super) fn has(&self, x: i64) -> bool {
        if self.base == Base::Absolute { limit_to_32_bits(x) == x } else { (0..self.modulo).contains(&x) }
    }

    /// Returns true if a restored state is valid.
    pub(super) fn is_sound(&self) -> bool {
        (1..1 << 30).contains(&self.modulo)
            && self.has(self.x)
            && (1..1 << 36).contains(&self.turn_ns)
            && (0..self.turn_ns).contains(&self.rest)
    }
}

/// Limits x to the travel of 32 bits.
fn limit_to_32_bits(x: i64) -> i64 {
    x.clamp(i32::MIN.into(), i32::MAX.into())
}

fn turn_ns(cycle_time: u16) -> i64 {
    i64::from(cycle_time.max(1)) * HALF_MS
}

//! Compensation of the following error (SAK).
//!
//! Law      out = y + trunc(sak * dy / 128), dy = y(k) - y(k-1) per call, 0 in the first one. sak = 7680000 / (T *
//!          gain) + 128 * (1 + 1 / T) if the source is another drive, 7680000 / (T * gain) + 256 if it is a pulse
//!          input, T in ms, gain of the position loop in rpm, rounded once to the nearest
//! Refuses  a factor outside the range of a set
//! Source   AMK-SAK-01 to -05, A-14

use serde::{Deserialize, Serialize};

/// Type of the source, which determines the dead time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The position of another drive.
    Drive,
    /// A pulse input.
    Pulses,
}

/// Maximum factor of a set.
const LARGEST: i128 = 32_767;
/// 7680000 ms of the law, in ns.
const LAG: i128 = 7_680_000_000_000;

/// Returns the factor that cancels the following error of a slave whose position loop has this gain (rpm); `None`
/// outside 1 to 32767.
pub fn factor(call_ns: u64, gain_rpm: u32, origin: Origin) -> Option<i64> {
    let (call, gain) = (i128::from(call_ns), i128::from(gain_rpm));
    // Dead time in 128 parts of a call, times the call (ns).
    let dead = match origin {
        Origin::Drive => 128 * call + 128 * 1_000_000,
        Origin::Pulses => 256 * call,
    };
    // All terms are below 2^64 * 2^32 * 2^9: they fit.
    let (dividend, divisor) = (LAG + dead * gain, call * gain);
    let nearest = (2 * dividend + divisor).checked_div(2 * divisor)?;
    i64::try_from(nearest).ok().filter(|_| (1..=LARGEST).contains(&nearest))
}

/// The compensation of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Sak {
    factor: i64,
    last: i64,
}

impl Sak {
    /// Starts at `y`.
    pub(super) fn new(factor: i64, y: i64) -> Self {
        Self { factor, last: y }
    }

    /// Returns the compensation for `y` of this call (inc).
    pub(super) fn share(&mut self, y: i64) -> i64 {
        let change = y.wrapping_sub(std::mem::replace(&mut self.last, y));
        if self.factor == 0 {
            return 0;
        }
        // A wide division takes ten times as long.
        if let Some(product) = self.factor.checked_mul(change) {
            return product / 128;
        }
        // Both factors fit i64: their product fits i128. A result beyond i64 is no valid position.
        let share = i128::from(self.factor) * i128::from(change) / 128;
        i64::try_from(share).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Proves: AMK-SAK-02, AMK-SAK-03, AMK-SAK-04, AMK-SAK-O1, AMK-SAK-O2, AMK-SAK-O3, AMK-XFIPW-121, AMK-XFIPW-O4
    #[test]
    fn a_factor_is_the_lag_of_the_loop_and_the_dead_time_of_its_input() {
        let of = |half_ms: u64, gain, origin| factor(half_ms * 500_000, gain, origin);
        assert_eq!(of(4, 1000, Origin::Drive), Some(4032));
        assert_eq!(of(2, 1000, Origin::Pulses), Some(7936));
        assert_eq!(of(1, 1000, Origin::Drive), Some(15_744));
        assert_eq!(of(4, 1000, Origin::Pulses), Some(4096));
        assert_eq!(of(1, 400, Origin::Pulses), None); // 38656
        // 3682.9 and 3895.8.
        assert_eq!(of(4, 1100, Origin::Drive), Some(3683));
        assert_eq!(of(4, 1055, Origin::Pulses), Some(3896));
    }

    #[test]
    fn a_factor_lies_within_what_a_set_takes() {
        // The lag of an infinite gain is 0: only the dead time is left.
        assert_eq!(factor(u64::MAX, u32::MAX, Origin::Pulses), Some(256));
        assert_eq!(factor(0, 1000, Origin::Drive), None);
        assert_eq!(factor(1_000_000, 0, Origin::Pulses), None);
        assert_eq!(factor(1, 1, Origin::Pulses), None);
        // 7680000 / gain + 256 at 1 ms: the last that fits, and the first that does not.
        assert_eq!(
            (factor(1_000_000, 237, Origin::Pulses), factor(1_000_000, 236, Origin::Pulses)),
            (Some(32_661), None)
        );
    }

    /// Proves: AMK-SAK-O4
    #[test]
    fn a_share_is_the_cycles_of_the_factor_times_the_change() {
        let mut sak = Sak::new(4032, 0);
        assert_eq!([sak.share(0), sak.share(4), sak.share(8), sak.share(4)], [0, 126, 126, -126]);
        // 31.5 cycles of 1 inc: truncated towards zero.
        assert_eq!([sak.share(5), sak.share(4)], [31, -31]);
        assert_eq!(Sak::new(0, 0).share(1000), 0);
    }
}

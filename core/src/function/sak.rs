//! Compensation of the following error (SAK).
//!
//! Law      out = y + trunc(sak * dy / 128), dy = y(k) - y(k-1) per call, 0 in the first one
//! Source   AMK-SAK-01 to -05, A-14

use serde::{Deserialize, Serialize};

/// The compensation of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Sak {
    factor: i64,
    last: i64,
}

impl Sak {
    /// Begins at `y`.
    pub(super) fn new(factor: i64, y: i64) -> Self {
        Self { factor, last: y }
    }

    /// What it adds to `y` of this call (inc).
    pub(super) fn share(&mut self, y: i64) -> i64 {
        let change = y.wrapping_sub(std::mem::replace(&mut self.last, y));
        if self.factor == 0 {
            return 0;
        }
        // A wide division takes ten times as long.
        if let Some(product) = self.factor.checked_mul(change) {
            return product / 128;
        }
        // Both factors fit i64: their product fits i128. What leaves i64 is no position any more.
        let share = i128::from(self.factor) * i128::from(change) / 128;
        i64::try_from(share).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Proves: AMK-SAK-O4, AMK-BCOM-41
    #[test]
    fn a_share_is_the_cycles_of_the_factor_times_the_change() {
        let mut sak = Sak::new(4032, 0);
        assert_eq!([sak.share(0), sak.share(4), sak.share(8), sak.share(4)], [0, 126, 126, -126]);
        // 31.5 cycles of 1 inc: cut towards zero.
        assert_eq!([sak.share(5), sak.share(4)], [31, -31]);
        assert_eq!(Sak::new(0, 0).share(1000), 0);
    }
}

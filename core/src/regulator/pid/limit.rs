//! The bound of the integral part, and its change with motion.
//!
//! Law      bound = KILIM * share. KILIMTIME 0: share 1. Above 0 the share rises to 1 within that time once the command
//!          moves, and falls to 0 within it once the command is at rest; below 0 the other way round
//! Reads    whether the command moves, the time since the last sample
//! Writes   the share, 0 to 1
//! Refuses  nothing: the rows do
//! Source   MACS-REG-05, MACS-REG-06, MACS-REG-07, A-23

use serde::{Deserialize, Serialize};

/// The active share of the bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Share {
    /// None before the first sample, which begins with the final share.
    now: Option<f64>,
}

impl Share {
    /// Advances by one sample, `elapsed_ms` after the one before.
    pub(super) fn step(&mut self, limit_time_ms: i64, moves: bool, elapsed_ms: f64) -> f64 {
        let aim = if limit_time_ms == 0 || moves == (limit_time_ms > 0) { 1.0 } else { 0.0 };
        let before = self.now.unwrap_or(aim);
        let by = if limit_time_ms == 0 { 1.0 } else { elapsed_ms / limit_time_ms.unsigned_abs() as f64 };
        let share = if before < aim { (before + by).min(aim) } else { (before - by).max(aim) };
        self.now = Some(share);
        share
    }

    pub(super) fn is_sound(&self) -> bool {
        self.now.is_none_or(|share| (0.0..=1.0).contains(&share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 ms up, 4 ms down, by quarters.
    ///
    /// Proves: MACS-REG-06
    #[test]
    fn a_positive_time_opens_the_limit_with_the_motion_and_closes_it_behind() {
        let mut share = Share::default();
        let seen: Vec<_> =
            [false, true, true, true, true, true, false, false, true].map(|moves| share.step(4, moves, 1.0)).into();
        assert_eq!(seen, [0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 0.75, 0.5, 0.75]);
    }

    /// Proves: MACS-REG-06
    #[test]
    fn a_negative_time_closes_it_with_the_motion_and_opens_it_at_rest() {
        let mut share = Share::default();
        let seen: Vec<_> = [false, true, true, true, false, false].map(|moves| share.step(-4, moves, 2.0)).into();
        assert_eq!(seen, [1.0, 0.5, 0.0, 0.0, 0.5, 1.0]);
    }

    #[test]
    fn without_a_time_it_is_always_open_also_behind_one_with_a_time() {
        let mut share = Share::default();
        assert_eq!(share.step(100, false, 1.0), 0.0);
        assert_eq!(share.step(0, false, 1.0), 1.0);
        assert_eq!(share.step(0, true, 1.0), 1.0);
    }
}

//! Parameters of the synchronization of an axis with its master.
//!
//! Source   MACS-SYNC-03, -05, -08, -11 to -15, A-31, A-34, A-57

use super::AxisParameters;
use serde::{Deserialize, Serialize};

/// Values of |SYNCVFTIME| up to this one take tau from the table.
const LAST_OF_TABLE: i64 = 999;
/// MENCODER (counts/rev) and tau (us) of the row that deviates from the formula of the others.
const ODD_ROW: (u64, f64) = (5_000, 1_400.0);

/// Parameters of synchronization in the group AXS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Synchronization {
    /// SYNCTYPE: bit 1 (+2) cams with the maximum rates, bit 2 (+4) backward motion of the master is held back.
    pub options: i64,
    /// SYNCPOSOFFS (inc of the master).
    pub offset: i64,
    /// SYNCOFFTIME (ms).
    pub offset_time: i64,
    /// SYNCMPULSM (inc of the master).
    pub mark_distance: i64,
    /// SYNCVFTIME (us).
    pub filter_time: i64,
    /// SYNCVFLIMIT (inc of the master).
    pub filter_limit: i64,
    /// SYNCVELREL (%).
    pub velocity_band: i64,
    /// SYNCFFVEL (1/1000).
    pub feed_forward: i64,
}

/// Rates at which an offset of the master is applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetRates {
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Acceleration (inc/s^2).
    pub acceleration: f64,
}

impl Synchronization {
    /// Returns true if backward motion of the master is stored and compensated before further forward motion.
    pub fn keeps_backward(&self) -> bool {
        self.options & 4 != 0
    }

    /// Returns true if cams synchronize with the maximum rates of the axis.
    pub fn follows_directly(&self) -> bool {
        self.options & 2 != 0
    }

    /// Returns the rates of the trapezoid of 20 % acceleration, 60 % constant velocity and 20 % deceleration that
    /// applies one distance of marks in SYNCOFFTIME: v = D / (0.8 T), a = D / (0.16 T^2); `None` if the offset is
    /// applied at once (MACS-SYNC-14).
    pub fn offset_rates(&self) -> Option<OffsetRates> {
        let (distance, time) = (self.mark_distance as f64, self.offset_time as f64 / 1e3);
        (distance > 0.0 && time > 0.0)
            .then(|| OffsetRates { velocity: distance / (0.8 * time), acceleration: distance / (0.16 * time * time) })
    }

    /// Returns the feed-forward of the slave in cycles of its velocity: SYNCFFVEL / 1000 ms (MACS-SYNC-15).
    pub fn ahead(&self, cycle_s: f64) -> f64 {
        self.feed_forward as f64 / 1e6 / cycle_s
    }
}

/// Returns tau of the table (us) for counts per revolution; `None` without any (MACS-SYNC-08, A-31).
fn tau_of_table(mencoder: i64) -> Option<f64> {
    let counts = mencoder.unsigned_abs();
    if counts == 0 {
        return None;
    }
    if counts == ODD_ROW.0 {
        return Some(ODD_ROW.1);
    }
    let tau = 1e7 / counts as f64 - 500.0;
    Some((libm::round(tau / 100.0) * 100.0).max(1_000.0))
}

impl AxisParameters {
    /// Returns tau (us) of the filter of its master, for a coupling by velocity or by position; `None` without a
    /// filter.
    pub fn master_tau(&self, by_position: bool) -> Option<f64> {
        let given = self.sync.filter_time;
        if by_position && given >= 0 {
            return None;
        }
        let own = given.unsigned_abs() > LAST_OF_TABLE.unsigned_abs();
        if own { Some(given.unsigned_abs() as f64) } else { tau_of_table(self.macs.mencoder) }
    }

    /// Returns true if SYNCPOSOFFS exceeds MLONG / SYNCFACTS in either direction.
    pub(super) fn is_offset_too_large(&self) -> bool {
        self.sync.offset.saturating_abs() > crate::unit::MLONG / self.sync_slave.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tau(mencoder: i64, filter_time: i64, keeps: bool) -> Option<f64> {
        let mut parameters = AxisParameters::new(1e5, 1e6);
        parameters.macs.mencoder = mencoder;
        parameters.sync.filter_time = filter_time;
        parameters.master_tau(keeps)
    }

    /// The rows of the manual, and values between them.
    /// Proves: MACS-SYNC-08, MACS-O-36
    #[test]
    fn tau_of_a_master() {
        for (counts, expected) in [
            (250, 39_500.0),
            (256, 38_600.0),
            (500, 19_500.0),
            (512, 19_000.0),
            (1_000, 9_500.0),
            (1_024, 9_300.0),
            (2_000, 4_500.0),
            (2_048, 4_400.0),
            (2_500, 3_500.0),
            (4_096, 1_900.0),
            (5_000, 1_400.0),
            (1_250, 7_500.0),
            (-1_250, 7_500.0),
            (100_000, 1_000.0),
        ] {
            assert_eq!(tau(counts, 0, false), Some(expected), "{counts}");
        }
        assert_eq!((tau(0, 0, false), tau(0, -5, true), tau(0, -1_000, true)), (None, None, Some(1_000.0)));
    }

    /// Positive values apply to couplings by velocity only.
    /// Proves: MACS-SYNC-08
    #[test]
    fn the_sign_says_what_is_filtered() {
        let of = |time| [tau(1_000, time, false), tau(1_000, time, true)];
        assert_eq!(of(0), [Some(9_500.0), None]);
        assert_eq!(of(999), [Some(9_500.0), None]);
        assert_eq!(of(1_000), [Some(1_000.0), None]);
        assert_eq!(of(-999), [Some(9_500.0), Some(9_500.0)]);
        assert_eq!(of(-1_000), [Some(1_000.0), Some(1_000.0)]);
    }

    /// 1000 inc in 500 ms: 2500 inc/s, and 25000 inc/s^2 for 100 ms.
    /// Proves: MACS-SYNC-14
    #[test]
    fn rates_of_an_offset() {
        let sync = Synchronization { mark_distance: 1_000, offset_time: 500, ..Default::default() };
        let OffsetRates { velocity, acceleration } = sync.offset_rates().expect("a time");
        assert!((velocity - 2_500.0).abs() < 1e-9 && (acceleration - 25_000.0).abs() < 1e-8);
        for nothing in [Synchronization { mark_distance: 0, ..sync }, Synchronization { offset_time: 0, ..sync }] {
            assert_eq!(nothing.offset_rates(), None);
        }
    }
}

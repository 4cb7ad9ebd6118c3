//! Parameters of the marks of master and slave.
//!
//! Source   MACS-SYNC-03, MACS-MARK-02 to -09, -14, -18 to -21, A-35, A-37, A-42

use super::AxisParameters;
use crate::code::Code;
use crate::unit::MLONG;
use serde::{Deserialize, Serialize};

/// Parameters of marker synchronization in the group AXS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Marks {
    /// SYNCMARKM.
    pub per_master: i64,
    /// SYNCMARKS.
    pub per_slave: i64,
    /// SYNCMPULSS (inc of the slave).
    pub slave_distance: i64,
    /// SYNCMTYPM.
    pub master_type: i64,
    /// SYNCMTYPS.
    pub slave_type: i64,
    /// SYNCMWINM (inc of the master).
    pub master_window: i64,
    /// SYNCMWINS (inc of the slave).
    pub slave_window: i64,
    /// SYNCMSTART.
    pub start: i64,
    /// SYNCMFPAR.
    pub options: i64,
    /// SYNCMFTIME (ms).
    pub filter_time: i64,
    /// SYNCSFTIME (ms).
    pub slave_filter_time: i64,
    /// SYNCMMAXCORR (inc of the slave).
    pub largest: i64,
    /// SYNCREADY.
    pub ready: i64,
    /// SYNCFAULT.
    pub fault: i64,
}

/// Source of the marks of one side (SYNCMTYPM, SYNCMTYPS).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MarkSignal {
    /// Digital input by its number from 1; 0: that of the encoder. `None`: the index pulse.
    pub input: Option<u16>,
    /// Whether the edge is rising.
    pub rising: bool,
    /// Input, by its number, that enables the marks, and its required level.
    pub condition: Option<(u16, bool)>,
}

impl MarkSignal {
    /// Decodes a number: the ones digit is 0 index rising, 1 index falling, 2 external rising, 3 external falling, the
    /// tens digit an input, the hundreds digit an input that has to be high, or low if the number is negative
    /// (MACS-MARK-05).
    pub fn decode(number: i64) -> Self {
        let [ones, tens, hundreds] = [1, 10, 100].map(|place| number.unsigned_abs() / place % 10);
        Self {
            input: (ones >= 2).then_some(tens as u16),
            rising: ones % 2 == 0,
            condition: (hundreds > 0).then_some((hundreds as u16, number > 0)),
        }
    }
}

impl AxisParameters {
    /// Returns the maximum distance of the marks of the master for a coupling by marks, for that gear factor of the
    /// slave and that number of marks between master and slave (inc of the master).
    pub fn largest_mark_distance(&self, slave_factor: i64, between: i64) -> i64 {
        let factors = [self.marks.per_master, slave_factor.saturating_abs(), between];
        factors.iter().fold(2 * MLONG, |most, factor| most / (*factor).max(1))
    }

    /// Checks the marks against each other.
    ///
    /// # Errors
    /// The key, and the reason.
    pub(super) fn check_marks(&self) -> Result<(), (&'static str, Code)> {
        let marks = &self.marks;
        let is_beyond = |window: i64, distance: i64| distance > 0 && window > distance;
        let checks = [
            // Without a distance there is no window.
            ("syncmwinm", is_beyond(marks.master_window, self.sync.mark_distance), Code::MARK_WINDOW),
            ("syncmwins", is_beyond(marks.slave_window, marks.slave_distance), Code::MARK_WINDOW),
            ("syncmfpar", marks.options & 64 != 0, Code::MARKS_INACTIVE),
        ];
        checks.into_iter().find(|(_, is_wrong, _)| *is_wrong).map_or(Ok(()), |(key, _, code)| Err((key, code)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::{Row, Value};

    /// Proves: MACS-MARK-05, MACS-MARK-06, MACS-O-51
    #[test]
    fn a_type_says_what_gives_marks() {
        let of = |input, rising, condition| MarkSignal { input, rising, condition };
        for (number, expected) in [
            (42, of(Some(4), true, None)),
            (-203, of(Some(0), false, Some((2, false)))),
            (103, of(Some(0), false, Some((1, true)))),
            (0, of(None, true, None)),
            (1, of(None, false, None)),
            (912, of(Some(1), true, Some((9, true)))),
        ] {
            assert_eq!(MarkSignal::decode(number), expected, "{number}");
        }
    }

    fn checked(change: impl Fn(&mut AxisParameters)) -> Result<(), (&'static str, Code)> {
        let mut parameters = AxisParameters::new(1e5, 1e6);
        change(&mut parameters);
        parameters.check_marks()
    }

    /// SYNCFACTS 1000, SYNCMARKM 1 and two marks between: 1073741; SYNCMPULSS times 9 is at most 2147483646.
    /// Proves: MACS-SYNC-03, MACS-MARK-03, MACS-MARK-04, MACS-O-42
    #[test]
    fn distances_have_a_largest_one() {
        let parameters = AxisParameters::new(1e5, 1e6);
        assert_eq!([1, 2].map(|between| parameters.largest_mark_distance(1_000, between)), [2_147_483, 1_073_741]);
        let (_, row) = Row::find("syncmpulss").expect("a row");
        let takes = |distance| row.check(Value::Int(distance)).is_ok();
        assert_eq!([238_609_294, 238_609_295].map(takes), [true, false]);
    }

    /// A window must not exceed its distance.
    /// Proves: MACS-MARK-07
    #[test]
    fn windows_fit() {
        let window = |window| checked(|p| (p.sync.mark_distance, p.marks.master_window) = (100, window));
        assert_eq!((window(100), window(101)), (Ok(()), Err(("syncmwinm", Code::MARK_WINDOW))));
        assert_eq!(checked(|p| (p.sync.mark_distance, p.marks.master_window) = (0, 5)), Ok(()));
        let window = |window| checked(|p| (p.marks.slave_distance, p.marks.slave_window) = (100, window));
        assert_eq!((window(100), window(101)), (Ok(()), Err(("syncmwins", Code::MARK_WINDOW))));
    }
}

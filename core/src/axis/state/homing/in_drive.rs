//! Progress of homing that the drive executes itself.

use crate::drive::{STATUS_HOMING_ATTAINED, STATUS_HOMING_ERROR, STATUS_TARGET_REACHED};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Time within which the drive must show mode 6, and then that homing has begun (ns).
pub(in crate::axis) const TIMEOUT_NS: u64 = 5_000_000_000;

/// Time after which a method without motion has finished (ns): bits that are still set then count.
const INSTANT_NS: u64 = 50_000_000;

/// Progress of homing in the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct InDrive {
    /// Cycle in which mode 6 was commanded, or bit 4 set.
    pub(in crate::axis) since: u64,
    /// Cycle since which the drive shows mode 6.
    pub(in crate::axis) shown_since: Option<u64>,
    /// Whether bit 4 is set.
    pub(in crate::axis) started: bool,
    /// Whether the drive has shown after that that it has begun.
    begun: bool,
    /// Status word of the cycle before.
    shown: u16,
    /// Epoch of its counts before the start.
    pub(in crate::axis) epoch: u32,
    /// Whether bit 13 has been set since before the start: it belongs to an earlier homing.
    old_error: bool,
    /// Cycle since which the drive has its reference and the mode of the axis is commanded again.
    pub(in crate::axis) returns: Option<u64>,
    /// Position of the axis at the start of homing.
    pub(in crate::axis) from: Position,
}

/// State of homing as shown by the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::axis) enum Shown {
    /// Homing is active.
    UnderWay,
    /// The reference is found, and the axis is at rest there.
    Done,
    /// Homing has failed.
    Failed,
    /// The drive does not show a start, and the time has elapsed.
    NoBegin,
}

/// Time since bit 4 was set, and how to read the status word.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Since {
    /// Time since bit 4 was set (ns).
    pub(in crate::axis) time_ns: u64,
    /// Whether the process data of the drive may already respond to it.
    pub(in crate::axis) answers: bool,
    /// Whether the method takes no time.
    pub(in crate::axis) is_instant: bool,
}

impl InDrive {
    pub(in crate::axis) fn since(cycle: u64, from: Position) -> Self {
        Self {
            since: cycle,
            shown_since: None,
            started: false,
            begun: false,
            shown: 0,
            epoch: 0,
            old_error: false,
            returns: None,
            from,
        }
    }

    /// Sets bit 4 from this cycle on.
    pub(in crate::axis) fn start(self, cycle: u64, (status, epoch): (u16, u32)) -> Self {
        let old_error = status & STATUS_HOMING_ERROR != 0;
        // If bit 12 is 0 now, it belongs to this homing once it is 1.
        let begun = status & STATUS_HOMING_ATTAINED == 0;
        Self { since: cycle, started: true, begun, shown: status, epoch, old_error, ..self }
    }

    /// Evaluates status word and epoch of a cycle after [`start`](Self::start).
    pub(in crate::axis) fn take(&mut self, (status, epoch): (u16, u32), since: Since) -> Shown {
        let shows = |bit: u16| status & bit != 0;
        let leaves_target = self.shown & STATUS_TARGET_REACHED != 0 && !shows(STATUS_TARGET_REACHED);
        self.begun |= !shows(STATUS_HOMING_ATTAINED) || since.answers && leaves_target || epoch != self.epoch;
        self.old_error &= shows(STATUS_HOMING_ERROR);
        self.shown = status;
        let is_late = since.time_ns > TIMEOUT_NS;
        if !since.answers {
            return Shown::UnderWay;
        }
        if shows(STATUS_HOMING_ERROR) {
            // It may fail at once, for the same reason as before.
            return if self.old_error && !is_late { Shown::UnderWay } else { Shown::Failed };
        }
        let counts = self.begun || since.is_instant && since.time_ns > INSTANT_NS;
        match shows(STATUS_HOMING_ATTAINED) && shows(STATUS_TARGET_REACHED) {
            true if counts => Shown::Done,
            _ if !self.begun && is_late => Shown::NoBegin,
            _ => Shown::UnderWay,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATTAINED: u16 = STATUS_HOMING_ATTAINED;
    const REACHED: u16 = STATUS_TARGET_REACHED;
    const ERROR: u16 = STATUS_HOMING_ERROR;

    /// Returns the result of status words, each from a time on (ms), the first one before bit 4 is set, and its time.
    fn homed(method: i64, words: &[(u64, u16)]) -> (Shown, u64) {
        let status = |ms: u64| words.iter().rev().find(|(from, _)| *from <= ms).map_or(0, |(_, status)| *status);
        let mut drive = InDrive::since(0, Position::ZERO).start(0, (status(0), 0));
        for ms in 1..20_000 {
            let since = Since { time_ns: ms * 1_000_000, answers: ms > 1, is_instant: matches!(method, 35 | 37) };
            let shown = drive.take((status(ms), 0), since);
            if shown != Shown::UnderWay {
                return (shown, ms);
            }
        }
        (Shown::UnderWay, 20_000)
    }

    /// CiA 402-2, homing mode: bits 12 and 10 are 0 during homing, and both 1 at its end.
    #[test]
    fn first_homing_ends_with_both_bits() {
        assert_eq!(homed(1, &[(0, REACHED), (3, 0), (900, ATTAINED), (950, ATTAINED | REACHED)]), (Shown::Done, 950));
        assert_eq!(homed(1, &[(0, REACHED), (3, 0), (900, ERROR)]), (Shown::Failed, 900));
    }

    /// Bits of the homing before stay set for 200 ms, or for 4 s: they do not count for this one.
    #[test]
    fn bits_that_are_cleared_late_are_not_the_end() {
        let both = ATTAINED | REACHED;
        for clears in [3, 200, 4_000] {
            assert_eq!(homed(1, &[(0, both), (clears, 0), (9_000, both)]), (Shown::Done, 9_000));
            assert_eq!(homed(1, &[(0, both), (clears, ATTAINED), (9_000, both)]), (Shown::Done, 9_000), "bit 10 alone");
            assert_eq!(homed(1, &[(0, both), (clears, REACHED), (9_000, both)]), (Shown::Done, 9_000), "bit 12 alone");
            assert_eq!(homed(1, &[(0, ERROR), (clears, 0), (9_000, both)]), (Shown::Done, 9_000), "the old error");
            assert_eq!(homed(1, &[(0, ERROR), (clears, 0), (9_000, ERROR)]), (Shown::Failed, 9_000));
        }
    }

    /// After the counts were set again, the bits belong to this homing, even if a change of the bits was not seen.
    #[test]
    fn constant_bits_count_after_the_counts_were_reset() {
        let both = ATTAINED | REACHED;
        let mut drive = InDrive::since(0, Position::ZERO).start(0, (both, 3));
        let since = |time_ns| Since { time_ns, answers: true, is_instant: false };
        assert_eq!(drive.take((both, 3), since(100_000_000)), Shown::UnderWay);
        assert_eq!(drive.take((both, 4), since(200_000_000)), Shown::Done);
    }

    /// Methods 35 and 37 need no motion: bits that stay set count after 50 ms. All others must have begun within 5 s.
    #[test]
    fn constant_bits_end_only_methods_without_motion() {
        let both = ATTAINED | REACHED;
        for method in [35, 37] {
            assert_eq!(homed(method, &[(0, both)]), (Shown::Done, 51));
        }
        for method in [1, 17, 33, 34] {
            assert_eq!(homed(method, &[(0, both)]), (Shown::NoBegin, 5_001));
        }
        assert_eq!(homed(1, &[(0, ERROR)]), (Shown::Failed, 5_001));
        // Bit 10 that is not set yet at the rising edge of bit 4 is no end, either.
        assert_eq!(homed(1, &[(0, ATTAINED), (30, both), (200, ATTAINED), (900, both)]), (Shown::Done, 900));
    }
}

//! Events of nodes, stored until the program fetches and reports them.
//!
//! Law      at most 128 notes within 10 s, so that an intermittent node does not flood the event stream. Of the emergency messages of
//!          foreign nodes one per second is reported, and the end of each reported one

use lineshaft_core::code::Code;
use lineshaft_core::drive::Note;
use std::time::{Duration, Instant};

/// Maximum number of notes of a bus within [`PERIOD`]: each of up to 127 drives starts once.
const MOST: usize = 128;
const PERIOD: Duration = Duration::from_secs(10);
/// Minimum time between two reported errors of foreign nodes.
const SECOND: Duration = Duration::from_secs(1);

/// Notes of a bus.
#[derive(Debug, Default)]
pub(super) struct Notes {
    waiting: Vec<Note>,
    /// Beginning of the present period, and number of notes since then.
    counted: Option<(Instant, usize)>,
}

impl Notes {
    /// Adds a note, unless the maximum is reached.
    pub(super) fn add(&mut self, code: Code, number: i64) {
        let now = Instant::now();
        let (since, count) = self.counted.filter(|(since, _)| now - *since < PERIOD).unwrap_or((now, 0));
        self.counted = Some((since, count.saturating_add(1)));
        if count < MOST {
            self.waiting.push(Note { code, number });
        }
    }

    /// Returns and removes the notes since the last call.
    pub(super) fn take(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.waiting)
    }
}

/// Selects the emergency messages to be reported, of nodes that are no drives of the cell.
#[derive(Debug, Default)]
pub(super) struct ForeignEmergencies {
    /// Time of the last reported error.
    told: Option<Instant>,
    /// Nodes with a reported error that has not ended, one bit each.
    open: u128,
}

impl ForeignEmergencies {
    /// Returns true if a message of a node with an error code is reported: one per second, and the end (code 0) of a reported error.
    pub(super) fn is_reported(&mut self, node: u8, code: u16, now: Instant) -> bool {
        let bit = 1_u128.checked_shl(node.into()).unwrap_or(0);
        if code == 0 && self.open & bit != 0 {
            self.open &= !bit;
            return true;
        }
        if self.told.is_some_and(|told| now.saturating_duration_since(told) < SECOND) {
            return false;
        }
        self.told = Some(now);
        if code != 0 {
            self.open |= bit;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_of_reported_foreign_emergency_is_reported() {
        let (mut foreign, begin) = (ForeignEmergencies::default(), Instant::now());
        let mut pass = |node, code, ms| foreign.is_reported(node, code, begin + Duration::from_millis(ms));
        assert!(pass(9, 0x8130, 0));
        // One per second on the bus. The end of an error that was not reported is not reported either.
        assert!(!pass(9, 0x2310, 10) && !pass(127, 0xFF01, 20) && !pass(127, 0, 30));
        assert!(pass(9, 0, 40), "it has ended");
        assert!(!pass(9, 0, 50), "once");
        assert!(!pass(9, 0x8130, 999) && pass(127, 0xFF01, 1000) && pass(127, 0, 1001));
        // An end without an error is reported like any other message.
        assert!(pass(1, 0, 2000) && !pass(1, 0, 2001));
    }

    #[test]
    fn number_of_notes_is_limited() {
        let mut notes = Notes::default();
        (0..1000).for_each(|number| notes.add(Code::NODE_CHANGED, number));
        let taken = notes.take();
        assert_eq!(taken.len(), MOST);
        assert_eq!(taken.first(), Some(&Note { code: Code::NODE_CHANGED, number: 0 }));
        notes.add(Code::NODE_CHANGED, 1);
        assert_eq!(notes.take(), [], "not before the period is over");
        notes.counted = notes.counted.map(|(since, count)| (since - PERIOD, count));
        notes.add(Code::NODE_CHANGED, 1);
        assert_eq!(notes.take().len(), 1);
    }
}

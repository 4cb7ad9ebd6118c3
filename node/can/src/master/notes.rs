//! What happens to nodes, until somebody takes it to tell it.
//!
//! Law      at most 128 notes come within 10 s: a node that flaps floods no event stream

use lineshaft_core::code::Code;
use lineshaft_core::drive::Note;
use std::time::{Duration, Instant};

/// Most notes of a bus within [`PERIOD`]; each of its drives starts once, with 127 of them.
const MOST: usize = 128;
const PERIOD: Duration = Duration::from_secs(10);

/// Notes of a bus.
#[derive(Debug, Default)]
pub(super) struct Notes {
    waiting: Vec<Note>,
    /// Since when they are counted, and how many there were since then.
    counted: Option<(Instant, usize)>,
}

impl Notes {
    /// Adds one, unless there were too many.
    pub(super) fn add(&mut self, code: Code, number: i64) {
        let now = Instant::now();
        let (since, count) = self.counted.filter(|(since, _)| now - *since < PERIOD).unwrap_or((now, 0));
        self.counted = Some((since, count.saturating_add(1)));
        if count < MOST {
            self.waiting.push(Note { code, number });
        }
    }

    /// Those that have come since they were taken last.
    pub(super) fn take(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.waiting)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_come_than_can_be_told() {
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

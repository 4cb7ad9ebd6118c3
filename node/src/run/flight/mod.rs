//! The flight recorder: the last seconds of every cycle, kept in memory, saved as a bag after a fault or when asked.
//!
//! A bag begins at a key cycle whose state is known, so that it replays. After a fault the recorder waits a little, to have
//! the reaction in the bag too. Faults that follow while it waits are in the same bag; the next bag begins to be saved
//! no sooner than its cycles follow those of the last one, so that a storm of faults neither floods the disk nor loses one.

pub mod folder;

use crate::recording::Encoded;
use std::collections::VecDeque;
use std::sync::Arc;

/// How long it goes on after a fault (ns).
const AFTERMATH_NS: u64 = 1_000_000_000;
/// Memory that it may take (bytes): with very many moving axes it keeps less than its length.
const MOST_BYTES: usize = 512 << 20;

/// The last seconds of a run.
#[derive(Debug)]
pub struct Flight {
    length_ns: u64,
    segments: VecDeque<Segment>,
    newest_ns: u64,
    bytes: usize,
    /// Whether a line has said that less than the length is kept.
    was_told: bool,
    /// When to save, because of a fault.
    due_ns: Option<u64>,
    /// The newest cycle that was saved after a fault (ns).
    saved_ns: Option<u64>,
}

/// Cycles from one that a bag may begin with up to the next one.
type Segment = Vec<Arc<Encoded>>;

impl Flight {
    /// Keeps `length_ns` at least, and up to a second more.
    pub fn new(length_ns: u64) -> Self {
        Self {
            length_ns,
            segments: VecDeque::new(),
            newest_ns: 0,
            bytes: 0,
            was_told: false,
            due_ns: None,
            saved_ns: None,
        }
    }

    /// Takes a cycle; `is_fault`: something failed in it. True when it is time to save.
    pub fn push(&mut self, cycle: &Arc<Encoded>, is_fault: bool) -> bool {
        self.newest_ns = cycle.stamp_ns;
        if cycle.can_begin() {
            self.segments.push_back(Segment::new());
        }
        // Before the first cycle that a bag may begin with there is nothing to keep.
        let Some(segment) = self.segments.back_mut() else { return false };
        segment.push(Arc::clone(cycle));
        self.bytes += cycle.memory();
        self.forget();
        if is_fault {
            let earliest = self.saved_ns.map_or(0, |saved| saved.saturating_add(self.length_ns));
            let due = cycle.stamp_ns.saturating_add(AFTERMATH_NS).max(earliest);
            self.due_ns.get_or_insert(due);
        }
        self.due_ns.is_some_and(|due| cycle.stamp_ns >= due)
    }

    /// Lets go of the segments that lie wholly before the last seconds, and of the oldest where they take too much memory.
    fn forget(&mut self) {
        let oldest = self.newest_ns.saturating_sub(self.length_ns);
        while let Some(next) = self.segments.get(1).and_then(|next| next.first()) {
            let is_past = next.stamp_ns <= oldest;
            if !is_past && self.bytes <= MOST_BYTES {
                return;
            }
            if !is_past && !self.was_told {
                self.was_told = true;
                let (seconds, mebibytes) = (self.length_ns / 1_000_000_000, MOST_BYTES >> 20);
                tracing::warn!(
                    "the flight recorder keeps less than {seconds} s: these would take more than {mebibytes} MiB"
                );
            }
            let freed = self.segments.pop_front();
            self.bytes -= freed.iter().flatten().map(|cycle| cycle.memory()).sum::<usize>();
        }
    }

    /// A fault waits to be saved.
    pub fn is_due(&self) -> bool {
        self.due_ns.is_some()
    }

    /// The cycles so far, for a bag.
    pub fn cycles(&self) -> Vec<Arc<Encoded>> {
        self.segments.iter().flatten().map(Arc::clone).collect()
    }

    /// The cycles so far, for the bag that is due.
    pub fn freeze(&mut self) -> Vec<Arc<Encoded>> {
        self.due_ns = None;
        self.saved_ns = Some(self.newest_ns);
        self.cycles()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = 1_000_000_000;

    /// A cycle of 100 ms; every tenth has a state.
    fn cycle(number: u64) -> Arc<Encoded> {
        let mut cycle = Encoded::default();
        cycle.cycle = number;
        cycle.stamp_ns = 1_700_000_000 * SECOND + number * SECOND / 10;
        cycle.is_key = number.is_multiple_of(10);
        cycle.state = cycle.is_key.then(Vec::new);
        Arc::new(cycle)
    }

    fn kept(flight: &Flight) -> (u64, u64) {
        let cycles = flight.cycles();
        let numbers: Vec<u64> = cycles.iter().map(|cycle| cycle.cycle).collect();
        assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "no gap");
        assert!(cycles[0].can_begin());
        (numbers[0], *numbers.last().unwrap())
    }

    #[test]
    fn it_keeps_at_least_its_length_and_begins_with_a_state() {
        let mut flight = Flight::new(3 * SECOND);
        for number in 3..1000 {
            assert!(!flight.push(&cycle(number), false));
            if number >= 100 {
                let (first, last) = kept(&flight);
                assert_eq!(last, number);
                assert!((30..=40).contains(&(last - first)), "{first}..{last}");
            }
        }
    }

    #[test]
    fn cycles_before_the_first_state_are_not_kept() {
        let mut flight = Flight::new(3 * SECOND);
        (3..10).for_each(|number| assert!(!flight.push(&cycle(number), true)));
        assert!(flight.cycles().is_empty());
        flight.push(&cycle(10), false);
        assert_eq!(kept(&flight), (10, 10));
    }

    #[test]
    fn a_fault_is_saved_with_its_aftermath() {
        let mut flight = Flight::new(3 * SECOND);
        (0..100).for_each(|number| assert!(!flight.push(&cycle(number), false)));
        let saved = (100..200).find(|&number| flight.push(&cycle(number), number == 105)).unwrap();
        assert_eq!(saved, 115);
        // Who looks meanwhile takes nothing of it away.
        assert!(flight.is_due());
        let (first, last) = kept(&flight);
        assert!(first <= 105 - 20 && last == 115, "{first}..{last}");
        assert_eq!(flight.freeze().len() as u64, last - first + 1);
        assert!(!flight.is_due());
    }

    #[test]
    fn a_storm_of_faults_gives_bags_that_follow_each_other_and_miss_none() {
        let mut flight = Flight::new(3 * SECOND);
        let mut bags = Vec::new();
        for number in 0..300 {
            if flight.push(&cycle(number), (100..200).contains(&number)) {
                bags.push(kept(&flight));
                flight.freeze();
            }
        }
        assert_eq!(bags[0].1, 110);
        assert!(bags.windows(2).all(|pair| pair[1].1 - pair[0].1 == 30), "{bags:?}");
        assert!(bags.windows(2).all(|pair| pair[1].0 <= pair[0].1 + 1), "every cycle is in one of them: {bags:?}");
        assert!(bags.last().unwrap().1 >= 200);
        assert!(bags.len() <= 5);
    }
}

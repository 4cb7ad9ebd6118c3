//! Flight recorder: keeps the last seconds of every cycle in memory and saves them as a bag after a fault or on
//! request.
//!
//! A bag begins at a key cycle with a known state, so that it can be replayed. After a fault the recorder waits for a
//! short time, so that the bag contains the reaction too. Faults during that time are in the same bag. The next bag is
//! saved only when its cycles follow those of the last one, so that many faults neither fill the disk nor lose a cycle.

pub mod folder;

use super::decoder::Decoder;
use super::frames::{Extras, Head, Taken};
use crate::recording::{CycleTime, Encoded};
use std::collections::VecDeque;
use std::sync::Arc;

/// Time after a fault before it is saved, in ns.
const AFTERMATH_NS: u64 = 1_000_000_000;
/// Maximum memory, in bytes; with very many moving axes less than the given length is kept.
const MOST_BYTES: usize = 512 << 20;

/// The last seconds of a run.
#[derive(Debug)]
pub struct Flight {
    length_ns: u64,
    segments: VecDeque<Arc<Segment>>,
    newest_ns: u64,
    bytes: usize,
    /// Whether the log has reported that less than the given length is kept.
    was_told: bool,
    /// Time to save because of a fault.
    due_ns: Option<u64>,
    /// Newest cycle saved after a fault, in ns.
    saved_ns: Option<u64>,
}

/// Packed cycles from one with which a bag may begin up to the next such cycle.
#[derive(Clone, Debug, Default)]
struct Segment {
    cycles: Vec<Packed>,
    bytes: Vec<u8>,
    /// Extras of the cycles that have any.
    extras: Vec<(u64, Extras)>,
    /// Serialized state of the machine before the first cycle; `None` before cycle 0.
    state: Option<Vec<u8>>,
    /// Memory of everything except `cycles` and `bytes`, in bytes.
    memory: usize,
}

/// A cycle and its part of `bytes`.
#[derive(Clone, Copy, Debug)]
struct Packed {
    cycle: u64,
    time: CycleTime,
    length: usize,
    is_key: bool,
}

impl Segment {
    fn push(&mut self, head: &Head, taken: &mut Taken) {
        let Head { cycle, time, length, is_key, .. } = *head;
        self.cycles.push(Packed { cycle, time, length, is_key });
        self.bytes.extend_from_slice(&taken.bytes);
        if !taken.extras.is_empty() {
            let extras = std::mem::take(&mut taken.extras);
            self.memory += extras.memory();
            self.extras.push((head.cycle, extras));
        }
        if let Some(state) = &head.state {
            // Every state can be serialized; without one, no bag would begin here.
            self.state = postcard::to_allocvec(state).ok();
            self.memory += self.state.as_ref().map_or(0, Vec::len);
        }
    }

    fn memory(&self) -> usize {
        self.memory + self.bytes.len() + size_of_val(self.cycles.as_slice())
    }

    /// Decodes its cycles, until `each` fails.
    fn decode<E>(&self, decoder: &mut Decoder, each: &mut impl FnMut(&Encoded) -> Result<(), E>) -> Result<(), E> {
        let (mut taken, mut bytes, mut extras) =
            (Taken::default(), self.bytes.as_slice(), self.extras.iter().peekable());
        let mut state = self.state.as_ref().and_then(|state| postcard::from_bytes(state).ok());
        for &Packed { cycle, time, length, is_key } in &self.cycles {
            let (of_cycle, rest) = bytes.split_at_checked(length).unwrap_or_default();
            bytes = rest;
            taken.bytes.clear();
            taken.bytes.extend_from_slice(of_cycle);
            taken.extras = extras.next_if(|(of, _)| *of == cycle).map(|(_, extras)| extras.clone()).unwrap_or_default();
            let head = Head { cycle, time, length, is_key, state: state.take() };
            each(&decoder.decode(&head, &taken))?;
        }
        Ok(())
    }
}

/// The cycles of the flight recorder at one time.
#[derive(Debug, Default)]
pub struct Segments(Vec<Arc<Segment>>);

impl Segments {
    /// Returns number and system time, in ns, of the newest cycle; `None` without a cycle.
    pub fn newest(&self) -> Option<(u64, u64)> {
        let newest = self.0.iter().rev().find_map(|segment| segment.cycles.last())?;
        Some((newest.cycle, newest.time.stamp_ns))
    }

    /// Passes the messages of each cycle to `each`, until it fails.
    ///
    /// # Errors
    /// Returns the error of `each`.
    pub fn decode<E>(&self, decoder: &mut Decoder, mut each: impl FnMut(&Encoded) -> Result<(), E>) -> Result<(), E> {
        self.0.iter().try_for_each(|segment| segment.decode(decoder, &mut each))
    }
}

impl Flight {
    /// Creates a recorder that keeps at least `length_ns`, and up to one second more.
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

    /// Adds a cycle and moves its extras out of `taken`; `is_fault`: it has an error. Returns true when it is time to
    /// save.
    pub fn push(&mut self, head: &Head, taken: &mut Taken, is_fault: bool) -> bool {
        self.newest_ns = head.time.log_ns;
        if head.can_begin() {
            self.segments.push_back(Arc::default());
        }
        // Cycles before the first one with which a bag may begin are not kept.
        let Some(segment) = self.segments.back_mut() else { return false };
        // A bag that is being saved keeps its own copy of a segment.
        let segment = Arc::make_mut(segment);
        self.bytes -= segment.memory();
        segment.push(head, taken);
        self.bytes += segment.memory();
        self.forget();
        if is_fault {
            let earliest = self.saved_ns.map_or(0, |saved| saved.saturating_add(self.length_ns));
            let due = head.time.log_ns.saturating_add(AFTERMATH_NS).max(earliest);
            self.due_ns.get_or_insert(due);
        }
        self.due_ns.is_some_and(|due| head.time.log_ns >= due)
    }

    /// Removes the segments that are completely before the last seconds, and the oldest ones if they use too much
    /// memory.
    fn forget(&mut self) {
        let oldest = self.newest_ns.saturating_sub(self.length_ns);
        while let Some(next) = self.segments.get(1).and_then(|next| next.cycles.first()) {
            let is_past = next.time.log_ns <= oldest;
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
            self.bytes -= freed.map_or(0, |segment| segment.memory());
        }
    }

    /// Whether a fault is to be saved.
    pub fn is_due(&self) -> bool {
        self.due_ns.is_some()
    }

    /// Returns the cycles so far, for a bag.
    pub fn cycles(&self) -> Segments {
        Segments(self.segments.iter().map(Arc::clone).collect())
    }

    /// Returns the cycles so far, for the bag that is due.
    pub fn freeze(&mut self) -> Segments {
        self.due_ns = None;
        self.saved_ns = Some(self.newest_ns);
        self.cycles()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use lineshaft_core::machine::Machine;

    const SECOND: u64 = 1_000_000_000;

    /// Adds a cycle of 100 ms; every tenth has a state.
    fn push(flight: &mut Flight, cycle: u64, is_fault: bool) -> bool {
        let is_key = cycle.is_multiple_of(10);
        let state = is_key.then(|| Box::new(Machine::new(Cell::demo().machine).unwrap().state().clone()));
        let time = CycleTime::same(1_700_000_000 * SECOND + cycle * SECOND / 10);
        flight.push(&Head { cycle, time, length: 0, is_key, state }, &mut Taken::default(), is_fault)
    }

    fn kept(flight: &Flight) -> (u64, u64) {
        let kept = flight.cycles();
        let numbers: Vec<u64> = kept.0.iter().flat_map(|segment| &segment.cycles).map(|cycle| cycle.cycle).collect();
        assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "no gap");
        assert!(numbers[0].is_multiple_of(10) && kept.0[0].state.is_some());
        assert_eq!(flight.bytes, flight.segments.iter().map(|segment| segment.memory()).sum::<usize>());
        (numbers[0], *numbers.last().unwrap())
    }

    #[test]
    fn it_keeps_at_least_its_length_and_begins_with_a_state() {
        let mut flight = Flight::new(3 * SECOND);
        for number in 3..1000 {
            assert!(!push(&mut flight, number, false));
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
        (3..10).for_each(|number| assert!(!push(&mut flight, number, true)));
        assert!(flight.cycles().newest().is_none());
        push(&mut flight, 10, false);
        assert_eq!(kept(&flight), (10, 10));
    }

    #[test]
    fn a_fault_is_saved_with_its_aftermath() {
        let mut flight = Flight::new(3 * SECOND);
        (0..100).for_each(|number| assert!(!push(&mut flight, number, false)));
        let saved = (100..200).find(|&number| push(&mut flight, number, number == 105)).unwrap();
        assert_eq!(saved, 115);
        // Reading the cycles in between changes nothing.
        assert!(flight.is_due());
        let (first, last) = kept(&flight);
        assert!(first <= 105 - 20 && last == 115, "{first}..{last}");
        let saved: usize = flight.freeze().0.iter().map(|segment| segment.cycles.len()).sum();
        assert_eq!(saved as u64, last - first + 1);
        assert!(!flight.is_due());
    }

    #[test]
    fn a_storm_of_faults_gives_bags_that_follow_each_other_and_miss_none() {
        let mut flight = Flight::new(3 * SECOND);
        let mut bags = Vec::new();
        for number in 0..300 {
            if push(&mut flight, number, (100..200).contains(&number)) {
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

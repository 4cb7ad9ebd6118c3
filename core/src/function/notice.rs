//! Rate limit of the events of a slot: started, ended, or an output has changed.
//!
//! Law      each change causes an event in its cycle, up to [`BURST`] events at once and one per second on average.
//!          Changes between them are counted, and the next event reports the count. The last event of a slot therefore
//!          shows its present state
//! Source   Lineshaft: a cam switch may change its outputs in every cycle, which would flood a log

use serde::{Deserialize, Serialize};

/// Maximum number of events in a row.
const BURST: u64 = 8;

/// Events of a slot so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct EventRateLimit {
    /// State in the previous cycle.
    seen: u16,
    /// Changes that have not been reported.
    unreported: u32,
    /// Cycle in which the average is one event per second again.
    average_reached_at: u64,
}

impl EventRateLimit {
    /// Takes the state of the slot. Returns the number of unreported changes before it if an event is due now.
    #[inline]
    pub(super) fn take(&mut self, state: u16, cycle: u64, cycle_ns: u64) -> Option<u32> {
        if state != self.seen {
            self.seen = state;
            self.unreported = self.unreported.saturating_add(1);
        }
        if self.is_pending() { self.due_count(cycle, cycle_ns) } else { None }
    }

    /// Returns true if a change has not been reported.
    #[inline]
    pub(super) fn is_pending(&self) -> bool {
        self.unreported > 0
    }

    fn due_count(&mut self, cycle: u64, cycle_ns: u64) -> Option<u32> {
        // A cycle lasts at most one second.
        let second = 1_000_000_000_u64.checked_div(cycle_ns).unwrap_or(1).max(1);
        // A restored state may hold any value.
        self.average_reached_at = self.average_reached_at.min(cycle.saturating_add(second.saturating_mul(BURST)));
        if self.average_reached_at > cycle.saturating_add(second.saturating_mul(BURST - 1)) {
            return None;
        }
        self.average_reached_at = self.average_reached_at.max(cycle).saturating_add(second);
        Some(std::mem::take(&mut self.unreported) - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MS: u64 = 1_000_000;

    /// Returns the cycles with an event, and the number of changes left out before each.
    fn told(states: impl IntoIterator<Item = u16>) -> Vec<(usize, u32)> {
        let mut notice = EventRateLimit::default();
        let tell = |(cycle, state)| Some((cycle, notice.take(state, cycle as u64, MS)?));
        states.into_iter().enumerate().filter_map(tell).collect()
    }

    #[test]
    fn change_is_reported_in_its_cycle_and_constant_state_is_not() {
        assert_eq!(told([0, 0, 0]), []);
        assert_eq!(told([0, 0, 1, 1, 1, 0, 256]), [(2, 0), (5, 0), (6, 0)]);
    }

    #[test]
    fn change_in_every_cycle_is_reported_once_per_second_with_count() {
        // 1, 0, 1, 0 .. for 3 s, then 1 for 6 s.
        let states = (0..3000).map(|cycle| (cycle + 1) % 2).chain(std::iter::repeat_n(1, 6000));
        let mut wanted: Vec<_> = (0..8).map(|cycle| (cycle, 0)).collect();
        // After the burst, which stands for 7 s, the average is one per second again from cycle 8000 on: 1000, 2000,
        // 3000.
        wanted.extend([(1000, 992), (2000, 999), (3000, 999)]);
        assert_eq!(told(states), wanted);
    }

    #[test]
    fn burst_is_available_again_after_pause() {
        let again = std::iter::repeat_n(0, 10_000).chain((0..9).map(|cycle| (cycle + 1) % 2));
        let states = (0..9).map(|cycle| (cycle + 1) % 2).chain(again);
        let cycles: Vec<usize> = told(states).into_iter().map(|(cycle, _)| cycle).collect();
        // The ninth state, 1, waited for its second; it has already changed to 0.
        assert_eq!(cycles[..8], [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!((cycles[8], cycles.len()), (1000, 9 + 8));
    }

    proptest! {
        /// Events and counts add up to all changes, and ten seconds have at most 8 + 10 events.
        #[test]
        fn reported_and_counted_changes_are_all_changes(states in proptest::collection::vec(0_u16..4, 1..4000)) {
            let calm = std::iter::repeat_n(*states.last().expect("one"), 20_000);
            let changes = std::iter::once(0).chain(states.iter().copied()).zip(&states).filter(|(a, b)| a != *b).count();
            let told = told(states.iter().copied().chain(calm));
            prop_assert_eq!(told.iter().map(|(_, left_out)| 1 + *left_out as usize).sum::<usize>(), changes);
            for window in told.windows(19) {
                prop_assert!(window[18].0 - window[0].0 >= 10_000);
            }
        }
    }
}

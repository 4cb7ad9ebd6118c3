//! Finds the times at which the samples of a signal are missing for much longer than usual.

/// A gap is longer than this number of usual intervals.
const UNUSUAL: u64 = 5;
/// Minimum number of intervals from which the usual one is determined.
const FEWEST: usize = 4;
/// Maximum number of intervals that are kept to determine the usual one; they are evenly distributed.
const KEPT: usize = 128;
/// Maximum number of gaps of one signal; the longest are kept.
const MOST_GAPS: usize = 256;

/// Intervals between the samples of a signal; only some are kept.
#[derive(Clone, Debug, Default)]
pub(super) struct Intervals {
    /// Length, in ns, of each interval whose number is a multiple of 2^`coarseness`.
    kept: Vec<u64>,
    coarseness: u32,
    count: u64,
    /// Start and end of the longest intervals, in ns.
    longest: Vec<(u64, u64)>,
    /// Minimum length of a new interval among the longest, in ns.
    floor: u64,
}

impl Intervals {
    /// Adds the interval between two samples.
    pub(super) fn add(&mut self, from: u64, to: u64) {
        let length = to - from;
        if self.count.trailing_zeros() >= self.coarseness {
            self.kept.push(length);
            if self.kept.len() == KEPT {
                let mut place = 0;
                self.kept.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.coarseness += 1;
            }
        }
        self.count += 1;
        if length > self.floor {
            self.longest.push((from, to));
            if self.longest.len() == 2 * MOST_GAPS {
                self.longest.sort_by_key(|(from, to)| std::cmp::Reverse(to - from));
                self.longest.truncate(MOST_GAPS);
                self.floor = self.longest.last().map_or(0, |(from, to)| to - from);
            }
        }
    }

    /// Returns the gaps, in order of time.
    pub(super) fn gaps(&self) -> Vec<(u64, u64)> {
        if self.kept.len() < FEWEST {
            return Vec::new();
        }
        let mut kept = self.kept.clone();
        let (_, usual, _) = kept.select_nth_unstable(self.kept.len() / 2);
        let most = usual.saturating_mul(UNUSUAL);
        let mut gaps: Vec<(u64, u64)> = self.longest.iter().copied().filter(|(from, to)| to - from > most).collect();
        gaps.sort_unstable();
        gaps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaps(times: impl IntoIterator<Item = u64>) -> Vec<(u64, u64)> {
        let mut intervals = Intervals::default();
        let mut times = times.into_iter();
        let mut before = times.next().unwrap();
        for time in times {
            intervals.add(before, time);
            before = time;
        }
        intervals.gaps()
    }

    #[test]
    fn a_gap_is_longer_than_five_usual_intervals() {
        let without =
            |missing: std::ops::Range<u64>| gaps((0..10_000).filter(|n| !missing.contains(n)).map(|n| n * 10));
        assert_eq!(without(0..0), []);
        assert_eq!(without(7_000..7_004), [], "five intervals");
        assert_eq!(without(7_000..7_005), [(69_990, 70_050)]);
    }

    #[test]
    fn of_a_handful_of_samples_nothing_is_usual() {
        assert_eq!(gaps([0, 1, 100, 101]), []);
        assert_eq!(gaps([0, 1, 2, 100, 101]), [(2, 100)]);
    }

    #[test]
    fn jitter_is_no_gap_and_memory_is_bounded() {
        let mut intervals = Intervals::default();
        let mut time = 0;
        for n in 0..200_000_u64 {
            let next = time + 5 + n * 7_919 % 11;
            intervals.add(time, next);
            time = next;
        }
        assert_eq!(intervals.gaps(), []);
        assert!(intervals.kept.len() < KEPT && intervals.longest.len() < 2 * MOST_GAPS);
    }

    #[test]
    fn only_the_longest_gaps_are_reported() {
        // Each thousand intervals of 1 are followed by one of 100, 101, 102, ...
        let mut times = vec![0];
        for gap in 0..600 {
            let last = times[times.len() - 1];
            times.extend((1..1_000).map(|n| last + n));
            times.push(last + 999 + 100 + gap);
        }
        let found = gaps(times);
        assert!((MOST_GAPS..2 * MOST_GAPS).contains(&found.len()), "{}", found.len());
        assert!(found.iter().all(|(from, to)| to - from > 100));
        assert_eq!(found.last().map(|(from, to)| to - from), Some(699));
    }
}

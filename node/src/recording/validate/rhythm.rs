//! When samples come: how often, and where none come for long.

/// The run's own rhythm counts where it has at least so many samples.
const ENOUGH: usize = 10;
/// A gap is longer than so many samples.
const SAMPLES: u64 = 5;

/// Times without a sample where some are expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Gaps {
    /// Where the longest one begins (ns).
    pub from: i64,
    /// Its length (ns).
    pub length: u64,
    /// How many there are.
    pub count: usize,
}

/// Median of the times between samples (ns), of those that are apart; 0 where none are.
pub(super) fn median(times: &[i64]) -> u64 {
    let intervals = std::iter::zip(times, times.get(1..).unwrap_or_default());
    let mut lengths: Vec<u64> =
        intervals.map(|(before, after)| after.abs_diff(*before)).filter(|length| *length > 0).collect();
    if lengths.is_empty() {
        return 0;
    }
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable(middle).1
}

/// The gaps of a run: longer than five of its samples and than `time` (ns), and what is expected has a sample in them that
/// is further than `slack` (ns) from both ends.
///
/// A run with few samples has no rhythm of its own: what is expected then counts as well.
pub(super) fn gaps(run: &[i64], expected: &[i64], time: u64, slack: u64) -> Option<Gaps> {
    let own = median(run);
    let usual = if run.len() < ENOUGH { own.min(median(expected)) } else { own };
    let most = time.max(usual.saturating_mul(SAMPLES));
    let has_samples = |from: i64, to: i64| {
        let next = expected.partition_point(|&time| time <= from.saturating_add_unsigned(slack));
        expected.get(next).is_some_and(|&time| time < to.saturating_sub_unsigned(slack))
    };
    let mut found: Option<Gaps> = None;
    for (&from, &to) in std::iter::zip(run, run.get(1..).unwrap_or_default()) {
        let length = to.abs_diff(from);
        if length <= most || !has_samples(from, to) {
            continue;
        }
        let before = found.map_or(0, |found| found.count);
        let longest = found.filter(|found| found.length >= length).unwrap_or(Gaps { from, length, count: 0 });
        found = Some(Gaps { count: before + 1, ..longest });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_that_of_samples_that_are_apart() {
        assert_eq!(median(&[]), 0);
        assert_eq!(median(&[7, 7]), 0);
        assert_eq!(median(&[0, 10, 20, 500, 510]), 10);
        assert_eq!(median(&[0, 0, 0, 0, 30, 30, 60]), 30);
    }

    #[test]
    fn gaps_are_long_and_what_is_expected_has_samples_there() {
        let every = |period: i64| (0..200).map(|n| n * period).collect::<Vec<_>>();
        let without = |from: i64, to: i64| {
            every(10).into_iter().filter(|time| !(from + 1..to).contains(time)).collect::<Vec<_>>()
        };
        let found = |run: &[i64], time| gaps(run, &every(10), time, 20);
        assert_eq!(found(&every(10), 0), None);
        // Five samples may be missing, and every rate is one.
        assert_eq!(found(&without(500, 550), 0), None);
        assert_eq!(found(&every(70), 0), None);
        assert_eq!(found(&without(500, 560), 0), Some(Gaps { from: 500, length: 60, count: 1 }));
        assert_eq!(found(&without(500, 560), 60), None);
        // What is expected has the same gap, a little earlier.
        assert_eq!(gaps(&without(500, 900), &without(480, 880), 0, 20), None);
        assert_eq!(gaps(&without(500, 900), &without(460, 860), 0, 20).map(|gaps| gaps.count), Some(1));
        let mut two = without(500, 900);
        two.retain(|time| !(1001..1100).contains(time));
        assert_eq!(found(&two, 0), Some(Gaps { from: 500, length: 400, count: 2 }));
        // Two samples are no rhythm.
        assert_eq!(found(&[0, 1990], 0), Some(Gaps { from: 0, length: 1990, count: 1 }));
    }
}

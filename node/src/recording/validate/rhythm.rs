//! Finds the sample rate of a signal, and gaps in it.

/// Minimum number of samples from which the rate of the run itself is used.
const ENOUGH: usize = 10;
/// A gap is longer than this number of samples.
const SAMPLES: u64 = 5;

/// Gaps in the run during which samples are expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Gaps {
    /// Start of the longest one, in ns.
    pub from: i64,
    /// Length of the longest one, in ns.
    pub length: u64,
    /// Number of gaps.
    pub count: usize,
}

/// Returns the median of the nonzero intervals between samples, in ns; 0 if there are none.
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

/// Returns the gaps of a run that are longer than five of its samples and than `time` (in ns), if the expected run has
/// a sample in them that is more than `slack` (in ns) from both ends.
///
/// The rate of a run with few samples is unknown; that of the expected run is then used as well.
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
        // Five samples may be missing, and every rate is valid.
        assert_eq!(found(&without(500, 550), 0), None);
        assert_eq!(found(&every(70), 0), None);
        assert_eq!(found(&without(500, 560), 0), Some(Gaps { from: 500, length: 60, count: 1 }));
        assert_eq!(found(&without(500, 560), 60), None);
        // The expected run has the same gap, slightly earlier.
        assert_eq!(gaps(&without(500, 900), &without(480, 880), 0, 20), None);
        assert_eq!(gaps(&without(500, 900), &without(460, 860), 0, 20).map(|gaps| gaps.count), Some(1));
        let mut two = without(500, 900);
        two.retain(|time| !(1001..1100).contains(time));
        assert_eq!(found(&two, 0), Some(Gaps { from: 500, length: 400, count: 2 }));
        // Two samples define no rate.
        assert_eq!(found(&[0, 1990], 0), Some(Gaps { from: 0, length: 1990, count: 1 }));
    }
}

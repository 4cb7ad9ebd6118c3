//! Histogram of times with a fixed size, written by one thread and read by others, and its percentiles.
//!
//! Buckets  values below 64 ns: one bucket each; above: 32 buckets of equal width per power of two (log-linear), so that a
//!          bucket is at most 1/32 (3.1 %) as wide as its lowest value
//! Reports  p: the upper bound of the bucket that holds sample number ceil(p n) of n sorted samples (nearest rank), but
//!          never more than the exact maximum; 0 without samples

use lineshaft_ros::surface::host::Percentiles;
use std::sync::atomic::{AtomicU64, Ordering};

/// Base-two logarithm of the number of buckets per power of two.
const SUB_BITS: u32 = 5;
/// Buckets per power of two.
const SUB_BUCKETS: usize = 1 << SUB_BITS;
/// Number of buckets for the whole range of u64. The powers of two below `SUB_BUCKETS` share the first `SUB_BUCKETS`.
const BUCKETS: usize = (u64::BITS - SUB_BITS + 1) as usize * SUB_BUCKETS;

/// Cumulative histogram of times, in ns. The recording thread does not allocate and never waits for a reader.
#[derive(Debug)]
pub struct Histogram {
    counts: [AtomicU64; BUCKETS],
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: [const { AtomicU64::new(0) }; BUCKETS] }
    }
}

impl Histogram {
    /// Adds a sample.
    pub fn record(&self, value: u64) {
        self.counts[bucket(value)].fetch_add(1, Ordering::Relaxed);
    }

    /// Returns a copy of the counts. It allocates, so it is only for readers.
    pub fn counts(&self) -> Counts {
        Counts(self.counts.iter().map(|count| count.load(Ordering::Relaxed)).collect())
    }
}

/// Copy of the counts of a histogram. The default is that of a histogram without samples.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts(Vec<u64>);

impl Counts {
    /// Returns the counts of the samples that were added after `earlier` was copied.
    pub fn since(&self, earlier: &Self) -> Self {
        let before = earlier.0.iter().copied().chain(std::iter::repeat(0));
        Self(self.0.iter().zip(before).map(|(now, before)| now.saturating_sub(before)).collect())
    }

    /// Returns the percentiles of the samples, of which the largest is `maximum`.
    pub fn percentiles(&self, maximum: u64) -> Percentiles {
        let samples = self.0.iter().sum();
        let of = |per_mille| self.per_mille(per_mille, samples).min(maximum);
        Percentiles { p50: of(500), p99: of(990), p999: of(999) }
    }

    /// Returns the upper bound of the bucket of a percentile, given per mille; 0 without samples.
    fn per_mille(&self, per_mille: u64, samples: u64) -> u64 {
        if samples == 0 {
            return 0;
        }
        let rank = samples.saturating_mul(per_mille).div_ceil(1000);
        let mut below = 0;
        let found = self.0.iter().position(|count| {
            below += count;
            below >= rank
        });
        found.map_or(0, upper_bound)
    }
}

/// Returns the number of the bucket of a value.
fn bucket(value: u64) -> usize {
    // The SUB_BITS + 1 highest bits of the value select the bucket; the shift removes the others.
    let shift = (value | 1).ilog2().saturating_sub(SUB_BITS);
    shift as usize * SUB_BUCKETS + (value >> shift) as usize
}

/// Returns the largest value of a bucket.
fn upper_bound(bucket: usize) -> u64 {
    let shift = (bucket / SUB_BUCKETS).saturating_sub(1);
    let top = (bucket - shift * SUB_BUCKETS) as u64;
    (top << shift) | ((1 << shift) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the exact percentile by nearest rank.
    fn exact(sorted: &[u64], per_mille: usize) -> u64 {
        let rank = (sorted.len() * per_mille).div_ceil(1000);
        sorted[rank - 1]
    }

    fn recorded(samples: &[u64]) -> Histogram {
        let histogram = Histogram::default();
        samples.iter().for_each(|&sample| histogram.record(sample));
        histogram
    }

    /// Times of all magnitudes, in bits.
    fn time() -> impl Strategy<Value = u64> {
        (any::<u64>(), 0..64_u32).prop_map(|(value, shift)| value >> shift)
    }

    #[test]
    fn buckets_cover_all_of_u64_without_gap_or_overlap() {
        let mut lowest = 0_u64;
        for number in 0..BUCKETS {
            let highest = upper_bound(number);
            assert!(lowest <= highest, "bucket {number}: {lowest}..={highest}");
            assert_eq!((bucket(lowest), bucket(highest)), (number, number), "{lowest}..={highest}");
            // Width minus one: the largest difference of two values of the bucket.
            assert!(highest - lowest <= lowest / 32, "bucket {number}: {lowest}..={highest}");
            lowest = highest.wrapping_add(1);
        }
        assert_eq!(lowest, 0, "the last bucket ends with the largest u64");
    }

    #[test]
    fn percentiles_by_hand() {
        // 1000 samples: 1, 2, .. 50 us are in buckets of at most 1/32.
        let samples: Vec<u64> = (1..=1000).map(|number| number * 50).collect();
        let seen = recorded(&samples).counts().percentiles(50_000);
        // 25,000 = 0b11000_01101_01000: bucket 24,576 to 25,087. 49,500: 49,152 to 50,175. 49,950: the same.
        assert_eq!(seen, Percentiles { p50: 25_087, p99: 50_000, p999: 50_000 });
        // Below 64 ns they are exact.
        let seen = recorded(&[7, 63, 8]).counts().percentiles(63);
        assert_eq!(seen, Percentiles { p50: 8, p99: 63, p999: 63 });
    }

    #[test]
    fn no_samples_give_zero() {
        assert_eq!(Histogram::default().counts().percentiles(0), Percentiles::default());
        assert_eq!(Counts::default().percentiles(5), Percentiles::default());
    }

    proptest! {
        #[test]
        fn percentile_is_at_least_the_exact_one_and_at_most_one_bucket_larger(
            mut samples in prop::collection::vec(time(), 1..3000),
        ) {
            let counts = recorded(&samples).counts();
            samples.sort_unstable();
            let maximum = samples[samples.len() - 1];
            let seen = counts.percentiles(maximum);
            for (reported, per_mille) in [(seen.p50, 500), (seen.p99, 990), (seen.p999, 999)] {
                let exact = exact(&samples, per_mille);
                prop_assert!(reported >= exact, "{reported} is below {exact}");
                prop_assert!(reported - exact <= exact / 32, "{reported} is more than a bucket above {exact}");
                prop_assert!(reported <= maximum);
            }
        }

        #[test]
        fn difference_of_two_copies_counts_the_samples_in_between(
            before in prop::collection::vec(time(), 0..100),
            after in prop::collection::vec(time(), 0..100),
        ) {
            let histogram = recorded(&before);
            let earlier = histogram.counts();
            after.iter().for_each(|&sample| histogram.record(sample));
            prop_assert_eq!(histogram.counts().since(&earlier), recorded(&after).counts());
            prop_assert_eq!(earlier.since(&Counts::default()), earlier);
        }
    }
}

//! Sliding mean over the last values.
//!
//! Law      mean(k) = (v(k) + .. + v(k-n+1)) / n, n = min(length, values since the start)
//! Source   A-18, AMK-BINEA-16 with B8, AMK-CAM-11 with A-59

use serde::{Deserialize, Serialize};

/// The last values of a series. Its memory is allocated once, for the maximum length.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Window {
    ring: Box<[i64]>,
    /// Length of the mean.
    length: u32,
    /// Number of values in the mean.
    count: u32,
    /// Index of the next value.
    next: u32,
    sum: i128,
}

impl Window {
    /// Creates a window for up to `capacity` values, at least one.
    pub(super) fn new(capacity: usize) -> Self {
        let ring = vec![0; capacity.max(1)].into();
        Self { ring, length: 1, count: 0, next: 0, sum: 0 }
    }

    /// Returns the maximum length.
    pub(super) fn capacity(&self) -> usize {
        self.ring.len()
    }

    /// Restarts with `length` values, limited to the capacity.
    pub(super) fn restart(&mut self, length: usize) {
        self.length = length.clamp(1, self.ring.len()) as u32;
        (self.count, self.next, self.sum) = (0, 0, 0);
    }

    /// Adds a value.
    pub(super) fn push(&mut self, value: i64) {
        let is_full = self.count == self.length;
        if let Some(place) = self.ring.get_mut(self.next as usize) {
            let oldest = std::mem::replace(place, value);
            // At most 2^32 values of 64 bits: the sum fits.
            self.sum += i128::from(value) - if is_full { i128::from(oldest) } else { 0 };
            self.count += u32::from(!is_full);
        }
        self.next = if self.next + 1 < self.length { self.next + 1 } else { 0 };
    }

    /// Returns sum and number of the values; the number is at least 1.
    pub(super) fn mean(&self) -> (i128, i128) {
        (self.sum, self.count.max(1).into())
    }

    /// Returns true if a restored state is valid.
    pub(super) fn is_sound(&self) -> bool {
        let fits = |number: u32| number as usize <= self.ring.len();
        let values = self.ring.iter().take(self.count as usize).map(|value| i128::from(*value));
        self.length >= 1
            && fits(self.length)
            && self.count <= self.length
            && self.next < self.length
            && values.sum::<i128>() == self.sum
    }
}

impl Clone for Window {
    fn clone(&self) -> Self {
        Self { ring: self.ring.clone(), ..*self }
    }

    /// Does not allocate if both belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        self.ring.clone_from(&other.ring);
        (self.length, self.count, self.next, self.sum) = (other.length, other.count, other.next, other.sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_first_values_are_averaged_over_what_there_is() {
        let mut window = Window::new(4);
        window.restart(2);
        let mut means = Vec::new();
        for value in [100, 50, 70] {
            window.push(value);
            means.push(window.mean());
        }
        assert_eq!(means, [(100, 1), (150, 2), (120, 2)]);
    }

    proptest! {
        #[test]
        fn a_window_is_the_mean_of_its_last_values(
            capacity in 1_usize..9,
            length in 0_usize..12,
            values in proptest::collection::vec(any::<i64>(), 1..40),
        ) {
            let mut window = Window::new(capacity);
            window.restart(length);
            let length = length.clamp(1, capacity);
            for end in 1..=values.len() {
                window.push(values[end - 1]);
                let last = &values[end.saturating_sub(length)..end];
                let sum = last.iter().map(|value| i128::from(*value)).sum::<i128>();
                prop_assert_eq!(window.mean(), (sum, last.len() as i128));
                prop_assert!(window.is_sound());
            }
        }
    }
}

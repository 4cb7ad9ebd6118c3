//! Polynomials up to degree 7 over 0 <= u <= 1: values, derivatives, and maxima of derivatives.

use super::transfer::{Derivatives, Peak, Peaks};

/// Coefficients of u^0 to u^7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polynomial(pub [f64; 8]);

impl Polynomial {
    /// Returns the value at `u`.
    fn value(&self, u: f64) -> f64 {
        self.0.iter().rfold(0.0, |sum, coefficient| sum * u + coefficient)
    }

    /// Returns the derivative.
    fn derived(&self) -> Self {
        let mut derived = [0.0; 8];
        for (k, (to, from)) in derived.iter_mut().zip(self.0.iter().skip(1)).enumerate() {
            *to = from * (k + 1) as f64;
        }
        Self(derived)
    }

    /// Returns the value and three derivatives by u.
    pub(super) fn at(&self, u: f64) -> Derivatives {
        let v = self.derived();
        let a = v.derived();
        Derivatives { s: self.value(u), v: v.value(u), a: a.value(u), j: a.derived().value(u) }
    }

    /// Returns the largest magnitudes of its derivatives in 0..=1.
    pub(super) fn peaks(&self) -> Peaks {
        let v = self.derived();
        let a = v.derived();
        Peaks { v: v.peak(), a: a.peak(), j: a.derived().peak() }
    }

    /// Returns its largest magnitude in 0..=1.
    fn peak(&self) -> Peak {
        let mut peak = Peak { value: self.value(0.0).abs(), at: 0.0 };
        for at in self.turns() {
            let value = self.value(at).abs();
            if value > peak.value {
                peak = Peak { value, at };
            }
        }
        peak
    }

    /// Returns its possible extrema, ascending, and the end: between two of them it is monotonic.
    fn turns(&self) -> Vec<f64> {
        let derived = self.derived();
        // The recursion ends at a constant after at most seven derivatives.
        if derived.0.iter().all(|coefficient| *coefficient == 0.0) {
            return vec![1.0];
        }
        let mut turns = Vec::new();
        let mut from = 0.0;
        for to in derived.turns() {
            // Between two extrema of the derivative there is at most one root.
            if (derived.value(from) < 0.0) != (derived.value(to) < 0.0) {
                turns.push(derived.root(from, to));
            }
            turns.push(to);
            from = to;
        }
        turns
    }

    /// Returns the root between two positions with different signs, by bisection: 60 steps leave less than 2^-60.
    fn root(&self, mut from: f64, mut to: f64) -> f64 {
        let is_negative = self.value(from) < 0.0;
        for _ in 0..60 {
            let middle = f64::midpoint(from, to);
            if (self.value(middle) < 0.0) == is_negative {
                from = middle;
            } else {
                to = middle;
            }
        }
        f64::midpoint(from, to)
    }
}

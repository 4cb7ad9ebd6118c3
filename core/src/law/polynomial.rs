//! Polynomials up to degree 7 over 0 <= u <= 1: values, derivatives, and where a derivative is largest.

use super::transfer::{Derivatives, Peak, Peaks};

/// Coefficients of u^0 to u^7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polynomial(pub [f64; 8]);

impl Polynomial {
    /// The value at `u`.
    fn value(&self, u: f64) -> f64 {
        self.0.iter().rfold(0.0, |sum, coefficient| sum * u + coefficient)
    }

    /// The polynomial that is its derivative.
    fn derived(&self) -> Self {
        let mut derived = [0.0; 8];
        for (k, (to, from)) in derived.iter_mut().zip(self.0.iter().skip(1)).enumerate() {
            *to = from * (k + 1) as f64;
        }
        Self(derived)
    }

    /// The value and three derivatives by u.
    pub(super) fn at(&self, u: f64) -> Derivatives {
        let v = self.derived();
        let a = v.derived();
        Derivatives { s: self.value(u), v: v.value(u), a: a.value(u), j: a.derived().value(u) }
    }

    /// The largest amounts of its derivatives in 0..=1.
    pub(super) fn peaks(&self) -> Peaks {
        let v = self.derived();
        let a = v.derived();
        Peaks { v: v.peak(), a: a.peak(), j: a.derived().peak() }
    }

    /// Its largest amount in 0..=1.
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

    /// Where it may turn, rising, and the end: between two of them it is monotonous.
    fn turns(&self) -> Vec<f64> {
        let derived = self.derived();
        // The derivative of a derivative ends at a constant after at most seven of them.
        if derived.0.iter().all(|coefficient| *coefficient == 0.0) {
            return vec![1.0];
        }
        let mut turns = Vec::new();
        let mut from = 0.0;
        for to in derived.turns() {
            // Between two turns of the derivative there is one root at most.
            if (derived.value(from) < 0.0) != (derived.value(to) < 0.0) {
                turns.push(derived.root(from, to));
            }
            turns.push(to);
            from = to;
        }
        turns
    }

    /// The root between two places where the signs differ, by halves: 60 of them leave less than 2^-60.
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

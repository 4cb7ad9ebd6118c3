//! Exact electronic gear.
//!
//! Law      slave = floor((numerator * master + remainder) / denominator); the remainder is kept, so that no ratio
//!          drifts
//! Reads    the change of the master per cycle; the caller calculates the difference, so the source may wrap
//! Writes   the change of the slave per cycle, to 2^-32 inc
//! Refuses  denominator 0, numerator 0 (a ratio without motion), parts beyond 2^62
//! Source   MACS-SYNC-02

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Ratio slave : master in lowest terms; the denominator is positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ratio {
    numerator: i64,
    denominator: i64,
}

impl Ratio {
    /// Upper bound of the magnitude of a part, exclusive: 2^62.
    pub const LIMIT: i64 = 1 << 62;

    /// Ratio 1 : 1.
    pub const ONE: Self = Self { numerator: 1, denominator: 1 };

    /// Returns a ratio of slave increments to master increments, reduced; none if a part is 0 or not below 2^62.
    pub fn new(numerator: i64, denominator: i64) -> Option<Self> {
        let legal = |part: i64| part != 0 && part.unsigned_abs() < Self::LIMIT.unsigned_abs();
        if !legal(numerator) || !legal(denominator) {
            return None;
        }
        let divisor = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()) as i64;
        let sign = denominator.signum();
        Some(Self { numerator: sign * numerator / divisor, denominator: sign * denominator / divisor })
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub fn is_sound(self) -> bool {
        Self::new(self.numerator, self.denominator) == Some(self)
    }

    /// Returns the slave increments.
    pub fn numerator(self) -> i64 {
        self.numerator
    }

    /// Returns the master increments, above 0.
    pub fn denominator(self) -> i64 {
        self.denominator
    }

    /// Returns the ratio of master increments to slave increments.
    pub fn inverse(self) -> Option<Self> {
        Self::new(self.denominator, self.numerator)
    }

    /// Returns the value, rounded.
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

/// Returns the greatest common divisor; if one number is 0, the other one.
pub fn gcd(a: u64, b: u64) -> u64 {
    let (mut a, mut b) = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// A gear between two positions.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Gear {
    ratio: Ratio,
    /// Remainder in units of 2^-32 inc / denominator; 0 <= remainder < denominator.
    remainder: i128,
}

impl Gear {
    /// Largest change of the master per cycle (inc). The caller must treat a larger one as a fault of its source.
    pub const MAX_CHANGE: i64 = 1 << 31;

    /// Returns a gear without remainder.
    pub fn new(ratio: Ratio) -> Self {
        Self { ratio, remainder: 0 }
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        self.ratio.is_sound() && (0..=i128::from(self.ratio.denominator)).contains(&self.remainder)
    }

    /// Returns the ratio.
    pub fn ratio(&self) -> Ratio {
        self.ratio
    }

    /// Returns the gear with another ratio. The remainder is kept, rounded once to 2^-32 inc (contract section 1).
    pub fn with_ratio(self, ratio: Ratio) -> Self {
        // The multiples of 2^-32 are already in the position of the slave: the remainder rounds to 0 or one such unit.
        // A whole unit is a full denominator, which the next step adds.
        let round_up = 2 * self.remainder >= i128::from(self.ratio.denominator);
        Self { ratio, remainder: if round_up { i128::from(ratio.denominator) } else { 0 } }
    }

    /// Advances by the change of the master and returns the change of the slave.
    pub fn step(&mut self, master_change: Position) -> Position {
        // A change that fits 64 bits is within the largest change.
        if let Some((change, gear)) = self.stepped(master_change) {
            *self = gear;
            return change;
        }
        // Twice the largest change, as the travel of a cam may be.
        let bound = 2 * Position::whole(Self::MAX_CHANGE).raw();
        let change = master_change.raw().clamp(-bound, bound);
        // |numerator| < 2^62 and |change| <= 2^64, the remainder is below 2^62: the sum stays below 2^127.
        let total = i128::from(self.ratio.numerator) * change + self.remainder;
        let denominator = i128::from(self.ratio.denominator);
        self.remainder = total.rem_euclid(denominator);
        Position::from_raw(total.div_euclid(denominator))
    }

    /// Returns the change of the slave and the gear after it if 64 bits suffice, which takes a tenth of the time.
    #[inline]
    pub fn stepped(self, master_change: Position) -> Option<(Position, Self)> {
        let change = i64::try_from(master_change.raw()).ok()?;
        let remainder = i64::try_from(self.remainder).ok()?;
        let Ratio { numerator, denominator } = self.ratio;
        let total = numerator.checked_mul(change)?.checked_add(remainder)?;
        if denominator < 1 {
            return None;
        }
        // One division gives both results.
        let (slave, rest) = (total / denominator, total % denominator);
        let (slave, rest) = if rest < 0 { (slave - 1, rest + denominator) } else { (slave, rest) };
        Some((Position::from_raw(slave.into()), Self { remainder: rest.into(), ..self }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gear(numerator: i64, denominator: i64) -> Gear {
        Gear::new(Ratio::new(numerator, denominator).unwrap())
    }

    /// Proves: MACS-SYNC-02, MACS-O-33
    #[test]
    fn one_to_two_halves_a_thousand() {
        let mut gear = gear(1, 2);
        let slave = (0..1000).fold(Position::ZERO, |sum, _| sum + gear.step(Position::whole(1)));
        assert_eq!(slave, Position::whole(500));
    }

    /// Proves: MACS-SYNC-02
    #[test]
    fn ten_to_the_twelve_increments_at_355_to_113_with_reversals_end_on_the_exact_increment() {
        let mut gear = gear(355, 113);
        let (mut master, mut travelled, mut slave, mut k) = (0_i64, 0_i64, Position::ZERO, 0_i64);
        while travelled < 1_000_000_000_000 {
            // Steps of different lengths, every seventh one backward.
            let step = 700_001 + k % 1013 - if k % 7 == 6 { 1_900_007 } else { 0 };
            slave += gear.step(Position::whole(step));
            master += step;
            travelled += step.abs();
            k += 1;
        }
        let exact = (i128::from(master) * 355).div_euclid(113);
        assert_eq!(i128::from(slave.floor()), exact);
        while master != 0 {
            let back = (-master).max(-1_000_000_007);
            slave += gear.step(Position::whole(back));
            master += back;
        }
        assert_eq!(slave, Position::ZERO);
    }

    #[test]
    fn a_negative_master_leaves_a_non_negative_remainder() {
        let mut gear = gear(1, 3);
        assert_eq!(gear.step(Position::whole(-1)).floor(), -1);
        assert!(gear.remainder >= 0);
    }

    /// Proves: MACS-DIR-04, MACS-SYNC-02
    #[test]
    fn signs_meet_in_the_numerator_and_zero_is_refused() {
        assert_eq!(Ratio::new(-2, -4), Ratio::new(1, 2));
        assert_eq!(Ratio::new(2, -4), Ratio::new(-1, 2));
        assert_eq!(Ratio::new(1, 0), None);
        assert_eq!(Ratio::new(0, 1), None);
        assert_eq!(Ratio::new(i64::MIN, 1), None);
        assert_eq!(Ratio::new(1 << 62, 1), None);
        assert!(Ratio::new((1 << 62) - 1, 1).is_some());
    }

    #[test]
    fn the_largest_change_at_the_largest_ratio_does_not_overflow() {
        let mut gear = gear(Ratio::LIMIT - 1, Ratio::LIMIT - 3);
        for change in [i64::MAX, i64::MIN, 0] {
            gear.step(Position::whole(change));
        }
    }

    /// 1/3 inc is 1431655765.33 units of 2^-32 and 2/3 inc 2863311530.67: the first remainder rounds down to 0, the
    /// second one up to one unit.
    #[test]
    fn a_change_of_ratio_rounds_the_remainder_once_to_a_unit_of_2_to_the_minus_32() {
        for (first, units) in [(1, 1_431_655_765 + 1_431_655_765), (2, 2_863_311_530 + 1 + 1_431_655_765)] {
            let mut gear = gear(first, 3);
            let mut slave = gear.step(Position::whole(1));
            gear = gear.with_ratio(Ratio::new(1, 3).unwrap());
            slave += gear.step(Position::whole(1));
            assert_eq!(slave.raw(), units);
        }
    }

    proptest! {
        #[test]
        fn the_sum_of_steps_is_the_step_of_the_sum(
            numerator in prop_oneof![-1000_i64..-1, 1_i64..1000, 1_i64 << 40..1 << 61],
            denominator in prop_oneof![1_i64..1000, 1_i64 << 40..1 << 61],
            changes in prop::collection::vec(-(1_i128 << 60)..(1_i128 << 60), 1..50),
        ) {
            let ratio = Ratio::new(numerator, denominator).unwrap();
            let mut one_by_one = Gear::new(ratio);
            let mut sum = Position::ZERO;
            let mut fraction_of_all = 0_i128;
            for &change in &changes {
                sum += one_by_one.step(Position::from_raw(change));
                fraction_of_all += change;
            }
            prop_assume!(fraction_of_all.unsigned_abs() < 1 << 62);
            let mut at_once = Gear::new(ratio);
            prop_assert_eq!(sum, at_once.step(Position::from_raw(fraction_of_all)));
            prop_assert_eq!(one_by_one.remainder, at_once.remainder);
        }
    }
}

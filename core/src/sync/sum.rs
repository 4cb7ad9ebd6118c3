//! A sum of several leads as a leader.
//!
//! Law      position, change and velocity are the sums over all terms with their factors: exact to 2^-32 inc, in the
//!          increments of each term. The sum is valid while each term is, also with terms that cancel out; its
//!          unevenness is the sum of those of its terms
//! Reads    leads that are no sums: other sums are expanded into their terms, so that no reading depends on another one
//! Refuses  nothing: [`MOST_TERMS`] legal positions stay below 2^68 inc, and impossible values saturate. As with any
//!          leader, the follower handles a change that is too large
//! Source   contract section 10, PLCopen (MC_CombineAxes)

use super::Leads;
use crate::encoder::Lead;
use crate::object::Leader;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Largest number of leaders in a sum, its own and those of other sums, each counted as often as it occurs.
pub const MOST_TERMS: usize = 64;

/// A leader and its factor; negative: it is subtracted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Term {
    leader: Leader,
    times: i8,
}

/// A sum of leads.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sum {
    terms: Vec<Term>,
    /// Number of leaders in it, also of those that cancel out.
    count: usize,
}

impl Sum {
    /// Adds or subtracts a leader that is no sum.
    pub fn with(mut self, leader: Leader, is_added: bool) -> Self {
        self.put(leader, if is_added { 1 } else { -1 });
        self.count = self.count.saturating_add(1);
        self
    }

    /// Adds or subtracts another sum.
    pub fn with_sum(mut self, other: &Self, is_added: bool) -> Self {
        for term in &other.terms {
            self.put(term.leader, if is_added { term.times } else { term.times.saturating_neg() });
        }
        self.count = self.count.saturating_add(other.count);
        self
    }

    fn put(&mut self, leader: Leader, times: i8) {
        match self.terms.iter_mut().find(|term| term.leader == leader) {
            Some(term) => term.times = term.times.saturating_add(times),
            None => self.terms.push(Term { leader, times }),
        }
    }

    /// Whether its number of leaders is allowed.
    pub fn is_small(&self) -> bool {
        self.count <= MOST_TERMS
    }

    /// Returns the sum of the factors of the leaders for which `holds` is true.
    pub(super) fn times(&self, holds: impl Fn(Leader) -> bool) -> i64 {
        self.terms.iter().filter(|term| holds(term.leader)).map(|term| i64::from(term.times)).sum()
    }

    /// Returns its lead from these leads.
    pub(super) fn of(&self, leads: &Leads) -> Lead {
        let mut sum = Lead { valid: true, ..Lead::default() };
        for &Term { leader, times } in &self.terms {
            let lead = leads.simple(leader).copied().unwrap_or_default();
            sum.position += times_position(lead.position, times.into());
            sum.change += times_position(lead.change, times.into());
            sum.velocity += lead.velocity * f64::from(times);
            sum.uneven += lead.uneven * f64::from(times).abs();
            sum.valid &= lead.valid;
        }
        sum
    }
}

/// Returns a multiple of a position.
pub(super) fn times_position(position: Position, times: i64) -> Position {
    Position::from_raw(position.raw().saturating_mul(times.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BELT: Leader = Leader::Encoder(0);
    const OTHER: Leader = Leader::Encoder(1);

    fn lead(raw: i128, valid: bool) -> Lead {
        let position = Position::from_raw(raw);
        Lead { position, change: Position::from_raw(raw / 3), velocity: raw as f64, uneven: 1.0, valid }
    }

    fn leads(sum: Sum, encoders: [Lead; 2]) -> Leads {
        Leads { encoders: encoders.to_vec(), sums: vec![sum], ..Leads::default() }
    }

    /// Twice the belt minus the other: 2 * 3 - 5 units, as uneven as three counts.
    #[test]
    fn members_count_with_sign_and_multiplicity() {
        let twice = Sum::default().with(BELT, true).with_sum(&Sum::default().with(BELT, true), true);
        let sum = twice.with_sum(&Sum::default().with(OTHER, true), false);
        assert!(sum.is_small());
        let lead = leads(sum, [lead(3, true), lead(5, true)]).get(Leader::Sum(0));
        assert_eq!((lead.position.raw(), lead.change.raw()), (1, 1));
        assert_eq!((lead.velocity, lead.uneven, lead.valid), (1.0, 3.0, true));
    }

    /// Members that cancel out cause no motion, but must be valid.
    #[test]
    fn each_member_has_to_be_there() {
        let inner = Sum::default().with(BELT, true).with(OTHER, true);
        let sum = Sum::default().with_sum(&inner, true).with(OTHER, false);
        let seen = |valid| leads(sum.clone(), [lead(7, true), lead(1 << 40, valid)]).get(Leader::Sum(0));
        assert_eq!((seen(true).position.raw(), seen(true).uneven, seen(true).valid), (7, 1.0, true));
        assert!(!seen(false).valid);
        // A leader that does not exist is lost.
        let none = Sum::default().with(Leader::Encoder(2), true);
        assert!(!leads(none, [lead(0, true); 2]).get(Leader::Sum(0)).valid);
    }

    #[test]
    fn more_leaders_than_there_may_be_are_counted_also_where_they_cancel_out() {
        let half = (0..32).fold(Sum::default(), |sum, place| sum.with(Leader::Encoder(place), true));
        let full = Sum::default().with_sum(&half, true).with_sum(&half, false);
        assert!(full.is_small());
        assert!(!full.with(BELT, true).is_small());
    }

    proptest! {
        /// Exact for all positions and signs; impossible values saturate without panic.
        #[test]
        fn sums_are_exact(
            raws in prop::array::uniform2(-(1_i128 << 94)..(1_i128 << 94)),
            counts in prop::array::uniform2(-32_i8..=32),
            wild in prop::array::uniform2(any::<i128>()),
        ) {
            let many = |leader, count: i8| {
                (0..count.unsigned_abs()).fold(Sum::default(), |sum, _| sum.with(leader, count > 0))
            };
            let sum = many(BELT, counts[0]).with_sum(&many(OTHER, counts[1]), true);
            prop_assert!(sum.is_small());
            let exact = raws[0] * i128::from(counts[0]) + raws[1] * i128::from(counts[1]);
            let of = leads(sum, raws.map(|raw| lead(raw, true)));
            prop_assert_eq!(of.get(Leader::Sum(0)).position.raw(), exact);
            let beyond = Leads { encoders: wild.map(|raw| lead(raw, true)).to_vec(), ..of };
            prop_assert!(beyond.get(Leader::Sum(0)).valid);
        }
    }
}

//! The way of a follower to the pair of places at which its gear takes it (MC_GearInPos).
//!
//! Law      over the leader's way x from its start, 0 to length, the follower goes a polynomial of 5th order: at 0 it has place, slope and bend of
//!          its present motion, at length the pair, the slope of the gear and no bend. Behind the pair the gear is exact: ratio * (leader -
//!          its place of the pair) in 2^-32 inc. Before the start the follower holds where the curve begins
//! Reads    changes of the leader: the curve is one of its place, whatever its speed is and wherever it turns
//! Writes   the follower's change; behind the pair a gear, with what that keeps
//! Refuses  a length of 0, or beyond [`Gear::MAX_CHANGE`]; whether its axis bears the curve the axis judges by [`Shape`]
//! Source   contract section 7 (start_distance_increments), PLCopen (MC_GearInPos)

use super::gear::{Gear, Ratio};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// A polynomial, the constant first.
type Polynomial = [f64; 6];

/// Halvings of what lies between two lengths of which one is twice the other: a quarter of it is left.
const HALVINGS: u32 = 2;

/// Where a follower is as its approach begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// From its place of the pair.
    pub place: Position,
    /// Its change by that of its leader.
    pub slope: f64,
    /// The change of that by the leader's way (1/inc).
    pub bend: f64,
}

/// An approach under way.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Approach {
    ratio: Ratio,
    /// From the leader to its place of the pair.
    left: Position,
    /// Where the follower was at the start, from its place of the pair.
    begin: Position,
    /// Where the curve has it now, likewise.
    value: Position,
    /// The leader's way from the start to the pair (inc), with the sign of its direction.
    length: i64,
    /// At the start.
    slope: f64,
    /// At the start (1/inc).
    bend: f64,
    /// Sign of the slope where that is the same all the way; 0 where it changes.
    sense: i8,
}

/// What a curve asks of its follower, by the leader's way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Least slope, with its sign.
    pub least: f64,
    /// Largest slope, with its sign.
    pub most: f64,
    /// Largest bend, without its sign (1/inc).
    pub bend: f64,
}

impl Approach {
    /// An approach that begins now, with its leader at the start, and what it asks for.
    pub fn new(ratio: Ratio, length: i64, begin: Begin) -> Option<(Self, Shape)> {
        let Begin { place, slope, bend } = begin;
        let (left, value) = (Position::whole(length), place);
        let new = Self { ratio, left, begin: place, value, length, slope, bend, sense: 0 };
        if !new.is_sound() {
            return None;
        }
        let shape = new.shape();
        let Shape { least, most, .. } = shape;
        let sense = if least >= -rounding(most) {
            1
        } else if most <= rounding(least) {
            -1
        } else {
            0
        };
        Some((Self { sense, ..new }, shape))
    }

    /// Does it lead into a gear that turns its leader round?
    pub fn is_turned(&self) -> bool {
        self.ratio.numerator() < 0
    }

    /// Could it have come about? One that was read from outside may hold anything.
    pub fn is_sound(&self) -> bool {
        let length = self.length.unsigned_abs();
        self.ratio.is_sound()
            && length != 0
            && length <= Gear::MAX_CHANGE.unsigned_abs()
            && self.slope.is_finite()
            && self.bend.is_finite()
            && self.begin.is_legal()
    }

    /// The gear behind the pair.
    pub fn ratio(&self) -> Ratio {
        self.ratio
    }

    /// Has its slope that sign all the way?
    pub fn keeps_sense(&self, sign: f64) -> bool {
        f64::from(self.sense) * sign > 0.0
    }

    /// The follower's change by that of its leader where it stands.
    pub fn slope(&self) -> f64 {
        match self.share() {
            None => 0.0,
            Some(share) if share >= 1.0 => self.ratio.to_f64(),
            Some(share) => value(&derivative(&self.curve()), share) / self.length as f64,
        }
    }

    /// What the whole curve asks for, in 8 evaluations: its slopes are extreme where the bend is 0, which it is at the pair, so that a polynomial of 2nd order is
    /// left of it, and its bends where the third derivative is.
    pub fn shape(&self) -> Shape {
        let length = self.length as f64;
        let slope = derivative(&self.curve());
        let bend = derivative(&slope);
        let [third, more, most, ..] = derivative(&bend);
        let [at_start, linear, _, cubic, ..] = bend;
        let [one, other] = range(&slope, roots([at_start, at_start + linear, -cubic])).map(|slope| slope / length);
        let [low, high] = range(&bend, roots([third, more, most])).map(|bend| (bend / length / length).abs());
        Shape { least: one.min(other), most: one.max(other), bend: low.max(high) }
    }

    /// The largest change of its bends, without its sign (1/inc^2): they are straight but for a parabola, so that ends and apex tell.
    pub fn jerk(&self) -> f64 {
        let length = (self.length as f64).abs();
        let third = derivative(&derivative(&derivative(&self.curve())));
        let [_, linear, square, ..] = third;
        let apex = -linear / (2.0 * square);
        let apex = if (0.0..=1.0).contains(&apex) { apex } else { 0.0 };
        let largest = [0.0, 1.0, apex].map(|at| value(&third, at).abs()).into_iter().fold(0.0, f64::max);
        largest / length / length / length
    }

    /// The follower's change by one of its leader, and the gear that takes it from here on.
    pub fn step(&mut self, change: Position) -> (Position, Option<Gear>) {
        self.left = self.left - change;
        let before = self.value;
        let mut gear = Gear::new(self.ratio);
        let geared = gear.step(-self.left);
        let (value, gear) = match self.share() {
            None => (self.begin, None),
            Some(share) if share >= 1.0 => (geared, Some(gear)),
            Some(share) => (self.rounded(share, geared, change), None),
        };
        self.value = value;
        (value - before, gear)
    }

    /// The curve there, from the place of the pair: computed from its nearer end, and never against its sense by what rounding leaves.
    fn rounded(&self, share: f64, geared: Position, change: Position) -> Position {
        let exact = if share < 0.5 {
            self.begin + Position::from_f64(value(&self.curve(), share))
        } else {
            geared + Position::from_f64(self.beside(share))
        };
        let is_onward = (change > Position::ZERO) == (self.sense > 0);
        match self.sense {
            0 => exact,
            _ if change == Position::ZERO => self.value,
            _ if is_onward => exact.max(self.value),
            _ => exact.min(self.value),
        }
    }

    /// How much of the length the leader is past the start; none before it, where it stands on it, too.
    fn share(&self) -> Option<f64> {
        let past = Position::whole(self.length) - self.left;
        let is_past = past != Position::ZERO && (past > Position::ZERO) == (self.length > 0);
        let is_through = self.left == Position::ZERO || (self.left < Position::ZERO) == (self.length > 0);
        // Exactly 1 is the pair alone: what rounds to it lies before.
        let share = || (past.to_f64() / self.length as f64).min(1.0 - f64::EPSILON);
        is_past.then(|| if is_through { 1.0 } else { share() })
    }

    /// The curve from where it begins, over shares of the length.
    fn curve(&self) -> Polynomial {
        let length = self.length as f64;
        let (first, second) = (self.slope * length, self.bend * length * length);
        let way = -self.begin.to_f64() - first - second / 2.0;
        let turn = self.ratio.to_f64() * length - first - second;
        let c3 = 10.0 * way - 4.0 * turn - second / 2.0;
        let c4 = -15.0 * way + 7.0 * turn + second;
        let c5 = 6.0 * way - 3.0 * turn - second / 2.0;
        [0.0, first, second / 2.0, c3, c4, c5]
    }

    /// What the curve lies beside the line of the gear, which it touches at the pair.
    fn beside(&self, share: f64) -> f64 {
        let length = self.length as f64;
        let line = self.ratio.to_f64() * length;
        let (place, slope, bend) =
            (self.begin.to_f64() + line, self.slope * length - line, self.bend * length * length / 2.0);
        let left = self.left.to_f64() / length;
        let s = share;
        left * left * left * (place * (1.0 + 3.0 * s + 6.0 * s * s) + slope * s * (1.0 + 3.0 * s) + bend * s * s)
    }
}

/// What f64 leaves of a slope beside one as large as `other`.
fn rounding(other: f64) -> f64 {
    other.abs() * 1e-9
}

/// A length from `asked` on that fits, where any does that is a power of two of it: no more than a quarter above one that does not. It asks at most 34
/// times.
pub fn enough_length(asked: i64, fits: impl Fn(i64) -> bool) -> Option<i64> {
    let mut low = asked.max(1);
    let mut high = low;
    while !fits(high) {
        if high >= Gear::MAX_CHANGE {
            return None;
        }
        low = high;
        high = high.saturating_mul(2).min(Gear::MAX_CHANGE);
    }
    for _ in 0..HALVINGS {
        let middle = low + (high - low) / 2;
        if middle == low {
            break;
        }
        if fits(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

fn value(polynomial: &Polynomial, at: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, factor| sum * at + factor)
}

fn derivative(polynomial: &Polynomial) -> Polynomial {
    let [_, a, b, c, d, e] = *polynomial;
    [a, 2.0 * b, 3.0 * c, 4.0 * d, 5.0 * e, 0.0]
}

/// Least and largest value of a polynomial in 0 to 1, where it turns nowhere but at these places.
fn range(polynomial: &Polynomial, turns: [f64; 2]) -> [f64; 2] {
    let [one, other] = turns;
    let values = [0.0, 1.0, one, other].map(|at| value(polynomial, at));
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// The roots of a polynomial of 2nd order, the constant first; 0 for one that does not lie in 0 to 1.
fn roots([constant, first, second]: [f64; 3]) -> [f64; 2] {
    let half = -(first + (first * first - 4.0 * constant * second).sqrt().copysign(first)) / 2.0;
    // What is no number lies nowhere.
    [half / second, constant / half].map(|root| if (0.0..=1.0).contains(&root) { root } else { 0.0 })
}

#[cfg(test)]
mod tests;

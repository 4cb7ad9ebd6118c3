//! The curve of a follower to the pair of positions at which its gear takes over (MC_GearInPos).
//!
//! Law      over the travel x of the leader from its start, 0 to length, the follower moves on a polynomial of 5th
//!          order: at 0 with position, slope and bend of its present motion, at length with the position of the pair,
//!          the slope of the gear and no bend. After the pair the gear is exact: ratio * (leader - its position of the
//!          pair) in 2^-32 inc. Before the start the follower holds at the start of the curve
//! Reads    changes of the leader: the curve is a function of its position, whatever its speed is and wherever it
//!          reverses
//! Writes   the change of the follower; after the pair a gear with its remainder
//! Refuses  a length of 0, or beyond [`Gear::MAX_CHANGE`]; the axis checks by [`Shape`] whether it can follow the curve
//! Source   contract section 7 (start_distance_increments), PLCopen (MC_GearInPos)

use super::gear::{Gear, Ratio};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Coefficients of a polynomial, the constant first.
type Polynomial = [f64; 6];

/// Number of bisections between two lengths of which one is twice the other; a quarter of the range is left.
const HALVINGS: u32 = 2;

/// Motion of a follower at the start of its approach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// Position relative to its position of the pair.
    pub place: Position,
    /// Slope: change of the follower per change of its leader.
    pub slope: f64,
    /// Bend: change of the slope per travel of the leader (1/inc).
    pub bend: f64,
}

/// An active approach.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Approach {
    ratio: Ratio,
    /// Distance from the leader to its position of the pair.
    left: Position,
    /// Position of the follower at the start, relative to its position of the pair.
    begin: Position,
    /// Present position on the curve, relative to the same position.
    value: Position,
    /// Distance of the leader from the start to the pair (inc), with the sign of its direction.
    length: i64,
    /// Slope at the start.
    slope: f64,
    /// Bend at the start (1/inc).
    bend: f64,
    /// Sign of the slope if it is constant; 0 if it changes.
    sense: i8,
}

/// Extreme slopes and bends of a curve, as functions of the travel of the leader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Smallest slope, signed.
    pub least: f64,
    /// Largest slope, signed.
    pub most: f64,
    /// Largest bend, without sign (1/inc).
    pub bend: f64,
}

impl Approach {
    /// Returns an approach that begins now, with its leader at the start, and its shape.
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

    /// Whether the gear after it has a negative ratio.
    pub fn is_turned(&self) -> bool {
        self.ratio.numerator() < 0
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        let length = self.length.unsigned_abs();
        self.ratio.is_sound()
            && length != 0
            && length <= Gear::MAX_CHANGE.unsigned_abs()
            && self.slope.is_finite()
            && self.bend.is_finite()
            && self.begin.is_legal()
    }

    /// Returns the ratio of the gear after the pair.
    pub fn ratio(&self) -> Ratio {
        self.ratio
    }

    /// Whether its slope has that sign throughout.
    pub fn keeps_sign(&self, sign: f64) -> bool {
        f64::from(self.sense) * sign > 0.0
    }

    /// Returns the present slope of the follower by its leader.
    pub fn slope(&self) -> f64 {
        match self.share() {
            None => 0.0,
            Some(share) if share >= 1.0 => self.ratio.to_f64(),
            Some(share) => value(&derivative(&self.curve()), share) / self.length as f64,
        }
    }

    /// Returns the shape of the whole curve, in 8 evaluations. The slopes are extreme where the bend is 0, which it is
    /// at the pair, so that a polynomial of 2nd order remains. The bends are extreme where the third derivative is 0.
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

    /// Returns the largest change of its bends, without sign (1/inc^2). The third derivative is a parabola, so both
    /// ends and the apex suffice.
    pub fn jerk(&self) -> f64 {
        let length = (self.length as f64).abs();
        let third = derivative(&derivative(&derivative(&self.curve())));
        let [_, linear, square, ..] = third;
        let apex = -linear / (2.0 * square);
        let apex = if (0.0..=1.0).contains(&apex) { apex } else { 0.0 };
        let largest = [0.0, 1.0, apex].map(|at| value(&third, at).abs()).into_iter().fold(0.0, f64::max);
        largest / length / length / length
    }

    /// Returns the change of the follower for a change of its leader, and the gear once that takes over.
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

    /// Returns the position on the curve relative to the pair, calculated from its nearer end. Rounding never moves the
    /// follower against the direction of the curve.
    fn rounded(&self, share: f64, geared: Position, change: Position) -> Position {
        let exact = if share < 0.5 {
            self.begin + Position::from_f64(value(&self.curve(), share))
        } else {
            geared + Position::from_f64(self.distance_from_gear(share))
        };
        let is_onward = (change > Position::ZERO) == (self.sense > 0);
        match self.sense {
            0 => exact,
            _ if change == Position::ZERO => self.value,
            _ if is_onward => exact.max(self.value),
            _ => exact.min(self.value),
        }
    }

    /// Returns the travel of the leader since the start as a share of the length; none up to the start.
    fn share(&self) -> Option<f64> {
        let past = Position::whole(self.length) - self.left;
        let is_past = past != Position::ZERO && (past > Position::ZERO) == (self.length > 0);
        let is_through = self.left == Position::ZERO || (self.left < Position::ZERO) == (self.length > 0);
        // Exactly 1 is reserved for the pair: a value that rounds to it is before the pair.
        let share = || (past.to_f64() / self.length as f64).min(1.0 - f64::EPSILON);
        is_past.then(|| if is_through { 1.0 } else { share() })
    }

    /// Returns the curve relative to its start, over shares of the length.
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

    /// Returns the distance of the curve from the line of the gear, which it touches at the pair.
    fn distance_from_gear(&self, share: f64) -> f64 {
        let length = self.length as f64;
        let line = self.ratio.to_f64() * length;
        let (place, slope, bend) =
            (self.begin.to_f64() + line, self.slope * length - line, self.bend * length * length / 2.0);
        let left = self.left.to_f64() / length;
        let s = share;
        left * left * left * (place * (1.0 + 3.0 * s + 6.0 * s * s) + slope * s * (1.0 + 3.0 * s) + bend * s * s)
    }
}

/// Returns the rounding error of f64 of a slope next to one as large as `other`.
fn rounding(other: f64) -> f64 {
    other.abs() * 1e-9
}

/// Returns a length from `asked` on that fits, if `asked` times a power of two fits: at most a quarter above one that
/// does not fit. It tests at most 34 lengths.
pub fn sufficient_length(asked: i64, fits: impl Fn(i64) -> bool) -> Option<i64> {
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

/// Returns least and largest value of a polynomial in 0 to 1; `turns`: its extrema.
fn range(polynomial: &Polynomial, turns: [f64; 2]) -> [f64; 2] {
    let [one, other] = turns;
    let values = [0.0, 1.0, one, other].map(|at| value(polynomial, at));
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// Returns the roots of a polynomial of 2nd order, the constant first; 0 replaces a root outside 0 to 1.
fn roots([constant, first, second]: [f64; 3]) -> [f64; 2] {
    let half = -(first + (first * first - 4.0 * constant * second).sqrt().copysign(first)) / 2.0;
    // NaN is outside.
    [half / second, constant / half].map(|root| if (0.0..=1.0).contains(&root) { root } else { 0.0 })
}

#[cfg(test)]
mod tests;

//! The segment between two knots.
//!
//! Law      of degree 1, 3 or 5, depending on the values of both ends: positions, also velocities, also accelerations.
//!          With u = elapsed / duration: x(u) = sum of c_i u^i, so that both ends have all their values
//! Refuses  nothing: the numbers were checked before

use super::Knot;
use crate::position::Position;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// Number of bisections in the search for a root, after which f64 has no more bits.
const HALVINGS: u32 = 54;
/// Largest number of extrema of a polynomial of degree 5 and its derivatives, plus both ends.
const MOST: usize = 12;
/// Bound of coefficients: from here on they describe no motion, and their products may overflow (inc).
const TOO_MUCH: f64 = 1e200;
/// Share of a segment below which a distance is rounding.
const SHORTEST: f64 = 1e-9;
/// Half of the share by which a rate may exceed a limit.
const NEGLIGIBLE: f64 = 5e-10;
/// Largest change of a distance by rounding to the resolution of positions (inc).
const FRACTION: f64 = 1.0 / (1_u64 << 32) as f64;
/// Change of velocity and acceleration per change of the distance, in units of 1 / duration and its square: at most
/// 1.875 and 6.
const BY_WAY: (f64, f64) = (2.0, 6.0);
/// The same for the terms of their sums, each of which is rounded.
const BY_TERM: (f64, f64) = (60.0, 400.0);

/// A segment of a trajectory.
#[derive(Clone, Copy, Debug)]
pub struct Spline {
    from: Position,
    to: Position,
    /// Coefficients by powers of the share of its duration (inc).
    c: [f64; 6],
    /// Duration (ns), above 0.
    duration_ns: u64,
    /// Rounding error of f64 in its coefficients (inc), each of their terms counted once.
    rounding: f64,
}

/// Range and rates of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// Lowest position.
    pub low: Position,
    /// Highest position.
    pub high: Position,
    /// Lowest velocity (inc/s); negative: backward.
    pub slowest: f64,
    /// Highest velocity (inc/s).
    pub fastest: f64,
    /// Highest acceleration while |velocity| grows (inc/s^2).
    pub acceleration: f64,
    /// Highest deceleration, while |velocity| falls (inc/s^2).
    pub deceleration: f64,
}

impl Reach {
    /// Returns the range of rest at a position.
    pub fn at(position: Position) -> Self {
        Self { low: position, high: position, slowest: 0.0, fastest: 0.0, acceleration: 0.0, deceleration: 0.0 }
    }

    /// Returns the union of both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            slowest: self.slowest.min(other.slowest),
            fastest: self.fastest.max(other.fastest),
            acceleration: self.acceleration.max(other.acceleration),
            deceleration: self.deceleration.max(other.deceleration),
        }
    }

    /// Returns the same motion at shifted positions.
    #[must_use]
    pub fn moved(self, by: Position) -> Self {
        Self { low: self.low + by, high: self.high + by, ..self }
    }

    /// Returns the highest speed in either direction (inc/s).
    pub fn speed(&self) -> f64 {
        self.fastest.max(-self.slowest)
    }

    /// Whether all rates are finite.
    pub fn is_finite(&self) -> bool {
        [self.slowest, self.fastest, self.acceleration, self.deceleration].iter().all(|rate| rate.is_finite())
    }
}

/// Positions within a segment, ascending, as shares of its duration.
#[derive(Clone, Copy, Debug)]
struct Places {
    places: [f64; MOST],
    count: usize,
}

impl Places {
    fn ends() -> Self {
        let mut places = Self { places: [0.0; MOST], count: 0 };
        places.push(0.0);
        places.push(1.0);
        places
    }

    fn push(&mut self, place: f64) {
        if let Some(free) = self.places.get_mut(self.count) {
            *free = place;
            self.count += 1;
        }
    }

    fn as_slice(&self) -> &[f64] {
        self.places.get(..self.count).unwrap_or_default()
    }

    /// Returns both ends and the roots of a polynomial that is monotonic between these positions.
    fn roots(&self, polynomial: &[f64; 6]) -> Self {
        let mut found = Self { places: [0.0; MOST], count: 0 };
        found.push(0.0);
        for pair in self.as_slice().windows(2) {
            let &[mut low, mut high] = pair else { continue };
            let rises = value(polynomial, low) < 0.0;
            if value(polynomial, low) * value(polynomial, high) >= 0.0 {
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = (low + high) / 2.0;
                if (value(polynomial, middle) < 0.0) == rises { low = middle } else { high = middle }
            }
            found.push(high);
        }
        found.push(1.0);
        found
    }

    /// Returns these positions and others, ascending.
    fn with(mut self, others: &Self) -> Self {
        for &place in others.as_slice() {
            if !self.as_slice().contains(&place) {
                self.push(place);
            }
        }
        if let Some(all) = self.places.get_mut(..self.count) {
            all.sort_unstable_by(f64::total_cmp);
        }
        self
    }
}

/// Returns a rate without the rounding error, unless that is below the accuracy of the check against limits.
fn without(rate: f64, rounding: f64) -> f64 {
    if rounding <= NEGLIGIBLE * rate.abs() { rate } else { (rate.abs() - rounding).max(0.0).copysign(rate) }
}

fn value(polynomial: &[f64; 6], u: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

fn derivative(polynomial: &[f64; 6]) -> [f64; 6] {
    let [_, c1, c2, c3, c4, c5] = *polynomial;
    [c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5, 0.0]
}

impl Spline {
    /// Whether it has degree 1.
    pub fn is_straight(&self) -> bool {
        self.c[2..].iter().all(|c| *c == 0.0)
    }

    /// Returns its velocities at its start and at its end, before it rests there (inc/s).
    pub fn end_velocities(&self) -> (f64, f64) {
        let s = self.duration_ns as f64 / 1e9;
        let velocity = derivative(&self.c);
        (value(&velocity, 0.0) / s, value(&velocity, 1.0) / s)
    }

    /// Returns the segment from one knot to the other in that time, which is not 0.
    pub fn new(from: &Knot, to: &Knot, duration_ns: u64) -> Self {
        let duration_ns = duration_ns.max(1);
        let s = duration_ns as f64 / 1e9;
        let way = (to.position - from.position).to_f64();
        let velocities = from.velocity.zip(to.velocity).map(|(from, to)| (from * s, to * s));
        let accelerations = from.acceleration.zip(to.acceleration).map(|(from, to)| (from * s * s, to * s * s));
        let c = match (velocities, accelerations) {
            (None, _) => [0.0, way, 0.0, 0.0, 0.0, 0.0],
            (Some((v0, v1)), None) => [0.0, v0, 3.0 * way - 2.0 * v0 - v1, v0 + v1 - 2.0 * way, 0.0, 0.0],
            (Some((v0, v1)), Some((a0, a1))) => [
                0.0,
                v0,
                a0 / 2.0,
                10.0 * way - 6.0 * v0 - 4.0 * v1 - (3.0 * a0 - a1) / 2.0,
                -15.0 * way + 8.0 * v0 + 7.0 * v1 + (3.0 * a0 - 2.0 * a1) / 2.0,
                6.0 * way - 3.0 * (v0 + v1) - (a0 - a1) / 2.0,
            ],
        };
        let rates = [velocities, accelerations].into_iter().flatten().map(|(from, to)| from.abs() + to.abs());
        let rounding = f64::EPSILON * (way.abs() + rates.sum::<f64>());
        Self { from: from.position, to: to.position, c, duration_ns, rounding }
    }

    /// Returns its motion at that time after its start (ns); from its end on it rests there.
    pub fn at(&self, elapsed_ns: f64) -> Motion {
        if elapsed_ns >= self.duration_ns as f64 {
            return Motion::at_rest(self.to);
        }
        let u = elapsed_ns / self.duration_ns as f64;
        let s = self.duration_ns as f64 / 1e9;
        let velocity = derivative(&self.c);
        let acceleration = derivative(&velocity);
        Motion {
            position: self.from + Position::from_f64(value(&self.c, u)),
            velocity: value(&velocity, u) / s,
            acceleration: value(&acceleration, u) / (s * s),
            jerk: value(&derivative(&acceleration), u) / (s * s * s),
        }
    }

    /// Returns its range and rates, without the rounding error, which is large over a short segment.
    pub fn reach(&self) -> Reach {
        // Comparisons would ignore NaN: it counts as faster than everything.
        if !self.c.iter().all(|c| c.abs() < TOO_MUCH) {
            let fastest = f64::MAX;
            return Reach { slowest: -fastest, fastest, ..Reach::at(self.from).union(Reach::at(self.to)) };
        }
        let s = self.duration_ns as f64 / 1e9;
        let reach = self.rounded_reach();
        let velocity = (BY_WAY.0 * FRACTION + BY_TERM.0 * self.rounding) / s;
        let acceleration = (BY_WAY.1 * FRACTION + BY_TERM.1 * self.rounding) / (s * s);
        Reach {
            slowest: without(reach.slowest, velocity),
            fastest: without(reach.fastest, velocity),
            acceleration: without(reach.acceleration, acceleration),
            deceleration: without(reach.deceleration, acceleration),
            ..reach
        }
    }

    fn rounded_reach(&self) -> Reach {
        let s = self.duration_ns as f64 / 1e9;
        let velocity = derivative(&self.c);
        let acceleration = derivative(&velocity);
        let jerk = derivative(&acceleration);
        // Each of them is monotonic between the roots of the next one.
        let jerk_turns = Places::ends().roots(&derivative(&jerk));
        let peaks = jerk_turns.roots(&jerk);
        let steady = peaks.roots(&acceleration);
        let turns = steady.roots(&velocity);
        let mut reach = Reach::at(self.from).union(Reach::at(self.to));
        for &turn in turns.as_slice().iter().filter(|turn| (SHORTEST..1.0).contains(*turn)) {
            reach = reach.union(Reach::at(self.from + Position::from_f64(value(&self.c, turn))));
        }
        for &place in steady.as_slice() {
            let velocity = value(&velocity, place) / s;
            (reach.slowest, reach.fastest) = (reach.slowest.min(velocity), reach.fastest.max(velocity));
        }
        for pair in peaks.with(&steady).with(&turns).as_slice().windows(2) {
            let &[begin, end] = pair else { continue };
            if end - begin < SHORTEST {
                continue;
            }
            let middle = (begin + end) / 2.0;
            let most = value(&acceleration, begin).abs().max(value(&acceleration, end).abs()) / (s * s);
            let speeds_up = value(&velocity, middle) * value(&acceleration, middle) >= 0.0;
            let rate = if speeds_up { &mut reach.acceleration } else { &mut reach.deceleration };
            *rate = rate.max(most);
        }
        reach
    }
}

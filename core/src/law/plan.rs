//! Motion plans of VDI 2143: segments of a master, each with a travel of the slave and a law.
//!
//! Law      segment i, from position X to X + h with travel d: y(x) = y(X) + d f((x - X) / h). A polynomial next to a
//!          moving straight line begins or ends with its velocity, and with acceleration 0 (degree 7: also jerk 0): its
//!          coefficients are the solution of its boundary values. In a cyclic plan the end is next to the start; before
//!          and after any other plan the slave is at rest
//! Reads    segments; outside the cycle, when a table is made: its numbers are rounded to whole ones for a cam
//! Refuses  positions that do not ascend, travels that do not match a law, steps of velocity between two segments
//! Source   VDI 2143 part 1

use super::polynomial::Polynomial;
use super::transfer::{Derivatives, Law, Peaks};
use nalgebra::{Const, DimMin, SMatrix, SVector, U1};

/// Share by which equal velocities may differ, because of the rounding of a slope.
const SAME: f64 = 1e-9;

/// A section of the master with one law. It begins at the end of the one before, the first one at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// End position of the master.
    pub to: f64,
    /// Travel of the slave.
    pub travel: f64,
    /// Law of motion.
    pub law: Law,
}

/// Error in segments. Segments count from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// There are no segments.
    #[error("a plan has 0 segments; 1 at least is needed")]
    Empty,
    /// A position or a travel is not finite.
    #[error("segment {segment}: {name} is {value}; a finite number is needed")]
    NotFinite {
        /// Number of the segment.
        segment: usize,
        /// Field: `to` or `travel`.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The segment ends at or before its start.
    #[error("segment {segment}: to is {to}; more than {from}, where the segment begins, is needed")]
    Order {
        /// Number of the segment.
        segment: usize,
        /// Start position.
        from: f64,
        /// End position.
        to: f64,
    },
    /// A dwell has a travel.
    #[error("segment {segment}: travel is {travel}; 0 is needed for law dwell")]
    DwellTravel {
        /// Number of the segment.
        segment: usize,
        /// Its travel.
        travel: f64,
    },
    /// A law of motion without travel.
    #[error("segment {segment}: travel is 0; another value is needed for law {}, or law dwell", law.name())]
    NoTravel {
        /// Number of the segment.
        segment: usize,
        /// Its law.
        law: Law,
    },
    /// The derivatives exceed the range of numbers.
    #[error("segment {segment}: travel is {travel:e} within {length:e} of the master; that cannot be computed with")]
    Size {
        /// Number of the segment.
        segment: usize,
        /// Its travel.
        travel: f64,
        /// Its length.
        length: f64,
    },
    /// The velocity jumps at the start of a segment.
    #[error(
        "segment {segment} ({}): it begins at {at} with velocity {after}, segment {before_segment} ({}) ends with {before}; the same is \
         needed: put polynomial_5 or polynomial_7 between", law.name(), before_law.name()
    )]
    VelocityJump {
        /// Number of the segment.
        segment: usize,
        /// Its law.
        law: Law,
        /// Number of the segment before; for the first one of a cyclic plan that of the last.
        before_segment: usize,
        /// Law of the segment before.
        before_law: Law,
        /// Position of the master.
        at: f64,
        /// Velocity before (slave per master).
        before: f64,
        /// Velocity after (slave per master).
        after: f64,
    },
}

/// A jump of a derivative between two segments, or at an end of a plan that is not cyclic, before and after which the
/// slave is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Position of the master.
    pub at: f64,
    /// 1: velocity, 2: acceleration.
    pub derivative: u32,
    /// Its value before.
    pub before: f64,
    /// Its value after.
    pub after: f64,
}

/// A valid motion plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pieces: Vec<Piece>,
    is_cyclic: bool,
}

/// A segment with its start values.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from: f64,
    to: f64,
    /// Difference of both positions.
    length: f64,
    y: f64,
    travel: f64,
    law: Law,
    /// Velocities at its start and at its end.
    ends: [f64; 2],
    /// Travel over u, 0 <= u <= 1, of a polynomial that does not move from rest to rest.
    solved: Option<Polynomial>,
}

impl Plan {
    /// Returns segments as a plan.
    ///
    /// # Errors
    /// The error in the segments.
    pub fn new(segments: &[Segment], is_cyclic: bool) -> Result<Self, PlanError> {
        if segments.is_empty() {
            return Err(PlanError::Empty);
        }
        let mut pieces = Vec::with_capacity(segments.len());
        let (mut from, mut y) = (0.0, 0.0);
        for (i, segment) in segments.iter().enumerate() {
            pieces.push(Piece::new(i + 1, from, y, segment)?);
            (from, y) = (segment.to, y + segment.travel);
        }
        let mut plan = Self { pieces, is_cyclic };
        plan.solve();
        plan.check()?;
        Ok(plan)
    }

    /// Gives polynomials next to a moving straight line its velocity.
    fn solve(&mut self) {
        let slope =
            |piece: Option<&Piece>| piece.filter(|piece| piece.law == Law::Straight).map_or(0.0, |line| line.ends[0]);
        let slopes: Vec<_> = (0..self.pieces.len()).map(|i| [slope(self.before(i)), slope(self.after(i))]).collect();
        for (piece, slopes) in self.pieces.iter_mut().zip(slopes) {
            if slopes != [0.0; 2] {
                piece.solve(slopes);
            }
        }
    }

    /// Checks that all numbers are finite and the velocity is continuous.
    fn check(&self) -> Result<(), PlanError> {
        for (i, piece) in self.pieces.iter().enumerate() {
            let Peaks { v, a, j } = piece.peaks();
            if ![v, a, j].iter().all(|peak| peak.value.is_finite()) || !(piece.y + piece.travel).is_finite() {
                return Err(PlanError::Size { segment: i + 1, travel: piece.travel, length: piece.length });
            }
        }
        for (i, piece) in self.pieces.iter().enumerate() {
            let Some(neighbour) = self.before(i) else { continue };
            let ([_, before], [after, _]) = (neighbour.ends, piece.ends);
            if differ(before, after) {
                let before_segment = if i == 0 { self.pieces.len() } else { i };
                let (law, before_law, at) = (piece.law, neighbour.law, piece.from);
                let segment = i + 1;
                return Err(PlanError::VelocityJump { segment, law, before_segment, before_law, at, before, after });
            }
        }
        Ok(())
    }

    /// Returns the neighbour of a piece at its start.
    fn before(&self, i: usize) -> Option<&Piece> {
        match i.checked_sub(1) {
            Some(before) => self.pieces.get(before),
            None => self.pieces.last().filter(|_| self.is_cyclic),
        }
    }

    /// Returns the neighbour of a piece at its end.
    fn after(&self, i: usize) -> Option<&Piece> {
        let around = || self.pieces.first().filter(|_| self.is_cyclic);
        self.pieces.get(i + 1).or_else(around)
    }

    /// Returns its length (master).
    pub fn length(&self) -> f64 {
        self.pieces.last().map_or(0.0, |last| last.to)
    }

    /// Returns its travel from start to end (slave).
    pub fn end(&self) -> f64 {
        self.pieces.last().map_or(0.0, |last| last.y + last.travel)
    }

    /// Whether it is cyclic.
    pub fn is_cyclic(&self) -> bool {
        self.is_cyclic
    }

    /// Returns slave and derivatives at a position of the master, 0 <= x <= length; between two segments those of the
    /// second. A position out of range counts as the nearest end.
    pub fn at(&self, x: f64) -> Derivatives {
        let i = self.pieces.partition_point(|piece| piece.from <= x).saturating_sub(1);
        self.pieces.get(i).map_or(Derivatives::default(), |piece| piece.at(x))
    }

    /// Returns the largest velocity, acceleration and jerk with their positions: in closed form, or at a root of the
    /// next derivative.
    pub fn peaks(&self) -> Peaks {
        self.pieces.iter().map(Piece::peaks).fold(Peaks::default(), Peaks::or)
    }

    /// Returns the jumps of velocity or acceleration; those of a derivative only without jump of a lower one. The jerk
    /// may jump between any two segments.
    pub fn jumps(&self) -> Vec<Jump> {
        let start =
            self.pieces.iter().enumerate().map(|(i, piece)| {
                (piece.from, self.before(i).map_or([0.0; 2], Piece::last_rates), piece.first_rates())
            });
        let end = self.pieces.last().filter(|_| !self.is_cyclic);
        let end = end.map(|last| (self.length(), last.last_rates(), [0.0; 2]));
        start.chain(end).filter_map(|(at, before, after)| jump(at, before, after)).collect()
    }
}

fn differ(before: f64, after: f64) -> bool {
    (before - after).abs() > SAME * before.abs().max(after.abs())
}

fn jump(at: f64, before: [f64; 2], after: [f64; 2]) -> Option<Jump> {
    let pairs = (1..).zip(before.into_iter().zip(after));
    let jump = |(derivative, (before, after))| differ(before, after).then_some(Jump { at, derivative, before, after });
    pairs.filter_map(jump).next()
}

impl Piece {
    fn new(number: usize, from: f64, y: f64, segment: &Segment) -> Result<Self, PlanError> {
        let Segment { to, travel, law } = *segment;
        for (name, value) in [("to", to), ("travel", travel)] {
            if !value.is_finite() {
                return Err(PlanError::NotFinite { segment: number, name, value });
            }
        }
        if to <= from {
            return Err(PlanError::Order { segment: number, from, to });
        }
        match law {
            Law::Dwell if travel != 0.0 => return Err(PlanError::DwellTravel { segment: number, travel }),
            Law::Straight | Law::SimpleSine | Law::ModifiedSine | Law::ModifiedTrapezoid if travel == 0.0 => {
                return Err(PlanError::NoTravel { segment: number, law });
            }
            _ => {}
        }
        let length = to - from;
        let velocity = if law == Law::Straight { travel / length } else { 0.0 };
        Ok(Self { from, to, length, y, travel, law, ends: [velocity; 2], solved: None })
    }

    /// Sets the velocities at its ends, if its law allows them.
    fn solve(&mut self, ends: [f64; 2]) {
        let [before, after] = ends.map(|velocity| velocity * self.length);
        self.solved = match self.law {
            Law::Polynomial5 => solved::<3>(self.travel, before, after),
            Law::Polynomial7 => solved::<4>(self.travel, before, after),
            _ => return,
        };
        self.ends = ends;
    }

    /// Returns velocity and acceleration at its start. Polynomials always begin and end with acceleration 0.
    fn first_rates(&self) -> [f64; 2] {
        let [velocity, _] = self.ends;
        [velocity, self.law.at(0.0).over(self.y, self.length, self.travel).a]
    }

    /// Returns velocity and acceleration at its end.
    fn last_rates(&self) -> [f64; 2] {
        let [_, velocity] = self.ends;
        [velocity, self.law.at(1.0).over(self.y, self.length, self.travel).a]
    }

    fn at(&self, x: f64) -> Derivatives {
        let z = ((x - self.from) / self.length).clamp(0.0, 1.0);
        match self.solved {
            Some(solved) => solved.at(z).over(self.y, self.length, 1.0),
            None => self.law.at(z).over(self.y, self.length, self.travel),
        }
    }

    fn peaks(&self) -> Peaks {
        match self.solved {
            Some(solved) => solved.peaks().over(self.from, self.length, 1.0),
            None => self.law.peaks().over(self.from, self.length, self.travel),
        }
    }
}

/// Returns the polynomial of degree 2 N - 1 from 0 to `travel`, with these velocities at its ends, and with higher
/// derivatives 0 there as far as possible.
fn solved<const N: usize>(travel: f64, before: f64, after: f64) -> Option<Polynomial>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    // Coefficients from u^N on: each row is a derivative at u = 1, with k (k - 1) .. for u^k.
    let rows = SMatrix::<f64, N, N>::from_fn(|row, column| {
        (0..row).map(|factor| (N + column) as f64 - factor as f64).product()
    });
    let wanted = SVector::<f64, N>::from_fn(|row, _| match row {
        0 => travel - before,
        1 => after - before,
        _ => 0.0,
    });
    let upper = rows.lu().solve::<Const<N>, U1, _>(&wanted)?;
    let mut coefficients = [0.0, before, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (coefficient, value) in coefficients.iter_mut().skip(N).zip(upper.iter()) {
        *coefficient = *value;
    }
    Some(Polynomial(coefficients))
}

#[cfg(test)]
mod tests;

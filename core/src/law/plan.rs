//! Plans of motion of VDI 2143: segments of a master, each with a way of the slave and a law.
//!
//! Law      segment i, from place X to X + h with way d: y(x) = y(X) + d f((x - X) / h). A polynomial beside a moving straight line begins or
//!          ends with its velocity, and with acceleration 0 (of degree 7: and jerk 0): its coefficients are the solution of its boundary
//!          values. A cyclic plan goes round, its end is beside its start; before and after any other the slave stands
//! Reads    segments; outside the cycle, where a table is made: its numbers become whole ones before a cam sees them
//! Refuses  places that do not rise, ways that are not those of a law, velocities that jump between two segments
//! Source   VDI 2143 part 1

use super::polynomial::Polynomial;
use super::transfer::{Derivatives, Law, Peaks};
use nalgebra::{Const, DimMin, SMatrix, SVector, U1};

/// Velocities that differ by no more than this share of them are the same: what rounding makes of one slope.
const SAME: f64 = 1e-9;

/// A part of the master with one law. It begins where the one before ends, the first one at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Place of the master where it ends.
    pub to: f64,
    /// Way of the slave.
    pub travel: f64,
    /// How it gets there.
    pub law: Law,
}

/// Why segments are no plan. Segments count from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// Nothing in it.
    #[error("a plan has 0 segments; 1 at least is needed")]
    Empty,
    /// A place or a way that is no number.
    #[error("segment {segment}: {name} is {value}; a finite number is needed")]
    NotFinite {
        /// Which.
        segment: usize,
        /// `to` or `travel`.
        name: &'static str,
        /// What it is.
        value: f64,
    },
    /// It ends where it begins, or before.
    #[error("segment {segment}: to is {to}; more than {from}, where the segment begins, is needed")]
    Order {
        /// Which.
        segment: usize,
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// The slave stands in a dwell.
    #[error("segment {segment}: travel is {travel}; 0 is needed for law dwell")]
    DwellTravel {
        /// Which.
        segment: usize,
        /// Its way.
        travel: f64,
    },
    /// A law that only moves.
    #[error("segment {segment}: travel is 0; another value is needed for law {}, or law dwell", law.name())]
    NoTravel {
        /// Which.
        segment: usize,
        /// Its law.
        law: Law,
    },
    /// Derivatives that have no place in a number.
    #[error("segment {segment}: travel is {travel:e} within {length:e} of the master; that cannot be computed with")]
    Size {
        /// Which.
        segment: usize,
        /// Its way.
        travel: f64,
        /// How long it is.
        length: f64,
    },
    /// The velocity jumps where a segment begins.
    #[error(
        "segment {segment} ({}): it begins at {at} with velocity {after}, segment {before_segment} ({}) ends with {before}; the same is \
         needed: put polynomial_5 or polynomial_7 between", law.name(), before_law.name()
    )]
    VelocityJump {
        /// Which.
        segment: usize,
        /// Its law.
        law: Law,
        /// The one before it; of the first segment of a cyclic plan the last.
        before_segment: usize,
        /// The law of that one.
        before_law: Law,
        /// Where they meet.
        at: f64,
        /// Velocity before (slave per master).
        before: f64,
        /// Velocity after (slave per master).
        after: f64,
    },
}

/// A derivative that jumps between two segments, or at an end of a plan that is not cyclic: there the slave stands before and after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Place of the master.
    pub at: f64,
    /// 1: velocity, 2: acceleration.
    pub derivative: u32,
    /// Its value before.
    pub before: f64,
    /// Its value after.
    pub after: f64,
}

/// Segments that fit together.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pieces: Vec<Piece>,
    is_cyclic: bool,
}

/// A segment with what it begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from: f64,
    to: f64,
    /// From there to there.
    length: f64,
    y: f64,
    travel: f64,
    law: Law,
    /// Velocity at its start, at its end.
    ends: [f64; 2],
    /// The way over u, 0 <= u <= 1, of a polynomial that does not go from rest to rest.
    solved: Option<Polynomial>,
}

impl Plan {
    /// Segments as a plan.
    ///
    /// # Errors
    /// What keeps them from being one.
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

    /// Polynomials beside a moving straight line take its velocity over.
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

    /// Numbers that can be computed with, and velocities that go on.
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

    /// The neighbour of a piece at its start.
    fn before(&self, i: usize) -> Option<&Piece> {
        match i.checked_sub(1) {
            Some(before) => self.pieces.get(before),
            None => self.pieces.last().filter(|_| self.is_cyclic),
        }
    }

    /// The neighbour of a piece at its end.
    fn after(&self, i: usize) -> Option<&Piece> {
        let around = || self.pieces.first().filter(|_| self.is_cyclic);
        self.pieces.get(i + 1).or_else(around)
    }

    /// How long it is (master).
    pub fn length(&self) -> f64 {
        self.pieces.last().map_or(0.0, |last| last.to)
    }

    /// The way from its start to its end (slave).
    pub fn end(&self) -> f64 {
        self.pieces.last().map_or(0.0, |last| last.y + last.travel)
    }

    /// Does it go round?
    pub fn is_cyclic(&self) -> bool {
        self.is_cyclic
    }

    /// Slave and derivatives at a place of the master, 0 <= x <= length; where two segments meet, those of the second. A place beyond counts as
    /// the end that it has passed.
    pub fn at(&self, x: f64) -> Derivatives {
        let i = self.pieces.partition_point(|piece| piece.from <= x).saturating_sub(1);
        self.pieces.get(i).map_or(Derivatives::default(), |piece| piece.at(x))
    }

    /// The largest velocity, acceleration and jerk, and where: in closed form, or at a root of the next derivative.
    pub fn peaks(&self) -> Peaks {
        self.pieces.iter().map(Piece::peaks).fold(Peaks::default(), Peaks::or)
    }

    /// Where velocity or acceleration jumps; of a derivative only where no lower one does. Jerk may jump wherever two segments meet.
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

    /// Takes velocities at its ends, if it can have any.
    fn solve(&mut self, ends: [f64; 2]) {
        let [before, after] = ends.map(|velocity| velocity * self.length);
        self.solved = match self.law {
            Law::Polynomial5 => solved::<3>(self.travel, before, after),
            Law::Polynomial7 => solved::<4>(self.travel, before, after),
            _ => return,
        };
        self.ends = ends;
    }

    /// Velocity and acceleration at its start. Polynomials begin and end with acceleration 0, moving or not.
    fn first_rates(&self) -> [f64; 2] {
        let [velocity, _] = self.ends;
        [velocity, self.law.at(0.0).over(self.y, self.length, self.travel).a]
    }

    /// Velocity and acceleration at its end.
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

/// The polynomial of degree 2 N - 1 through 0 and `travel`, with these velocities there and with all higher derivatives that it can have there 0.
fn solved<const N: usize>(travel: f64, before: f64, after: f64) -> Option<Polynomial>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    // Of the coefficients from u^N on each row has a derivative at u = 1: k (k - 1) .. of u^k.
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

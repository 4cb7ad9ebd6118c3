//! Rotary modes: the change of the profile input for a requested change of position.
//!
//! Law      A = f(mode, D, p, R): D the requested change, p the profile input as displayed (0..R), R the turn
//! Reads    exact positions: units of 2^-32 inc / denominator of the turn, so that a turn need not be whole increments
//! Writes   the change to add; the caller counts the turns
//! Refuses  nothing; modes 4 and 5 ignore some changes, with a result of 0
//! Source   AMC-ROT-01..20, M04..M06

use crate::modulo::Modulo;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Maximum magnitude of a position in units of 2^-32 inc: 2^62 inc.
const LARGEST: i128 = (Position::LIMIT as i128) << 32;
/// Range of the 32-bit integrators of the source, in user units.
const CAPACITY: f64 = i32::MAX as f64;

/// A position or a change of position in units of 2^-32 inc / denominator of the turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Exact(i128);

impl Exact {
    /// Returns true if a restored value is valid.
    pub(super) fn is_sound(self) -> bool {
        // 2^94 units of 2^-32 inc, times a denominator below 2^31.
        self.0.unsigned_abs() <= 1 << 125
    }

    /// Returns the sum; the sum of two positions cannot overflow.
    pub(super) fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Returns the difference.
    pub(super) fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

/// Direction of a change on a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Linear,
    Shortest,
    Forward,
    Reverse,
    NoRollover,
    MultiTurnForward,
    MultiTurnReverse,
    MultiTurnDelta,
}

impl Mode {
    /// Returns the mode of 34.005; linear without a turn, and for samples shorter than 500 us (AMC-ROT-01).
    pub(super) fn new(number: i64, modulo: Option<Modulo>, cycle_ns: u64) -> Self {
        const SHORTEST_SAMPLE_NS: u64 = 500_000;
        if modulo.is_none() || cycle_ns < SHORTEST_SAMPLE_NS {
            return Self::Linear;
        }
        match number {
            0 => Self::Shortest,
            1 => Self::Forward,
            2 => Self::Reverse,
            3 => Self::NoRollover,
            4 => Self::MultiTurnForward,
            5 => Self::MultiTurnReverse,
            _ => Self::MultiTurnDelta,
        }
    }

    /// Returns true if a reference is a position within one turn (M01).
    pub(super) fn is_within_turn(self) -> bool {
        matches!(self, Self::Shortest | Self::Forward | Self::Reverse | Self::NoRollover)
    }
}

/// Conversion of exact positions of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    denominator: i128,
    turn: Option<i128>,
}

impl Circle {
    pub(super) fn new(modulo: Option<Modulo>) -> Self {
        Self { denominator: modulo.map_or(1, Modulo::denominator), turn: modulo.map(Modulo::turn) }
    }

    /// Returns the exact value of a position.
    pub(super) fn exact(self, position: Position) -> Exact {
        Exact(position.raw().clamp(-LARGEST, LARGEST) * self.denominator)
    }

    /// Returns the position as displayed: 0..R without turns; the position itself without a turn length.
    pub(super) fn shown(self, position: Exact) -> Exact {
        Exact(self.turn.map_or(position.0, |turn| position.0.rem_euclid(turn)))
    }

    /// Returns the turns that the display leaves out; 0 without a turn length.
    pub(super) fn turns(self, position: Exact) -> i64 {
        self.turn.map_or(0, |turn| position.0.div_euclid(turn) as i64)
    }

    /// Converts to 2^-32 inc, rounded down.
    pub(super) fn position(self, exact: Exact) -> Position {
        Position::from_raw(exact.0.div_euclid(self.denominator))
    }

    /// Returns the nearest whole increment, halves away from zero.
    pub(super) fn nearest(self, exact: Exact) -> Position {
        let unit = self.denominator << 32;
        let magnitude = (exact.0.abs() + unit / 2) / unit;
        Position::whole(i64::try_from(if exact.0 < 0 { -magnitude } else { magnitude }).unwrap_or(i64::MAX))
    }

    /// Returns true if |position| < 2^62 inc.
    pub(super) fn is_legal(self, position: Exact) -> bool {
        position.0.abs() < LARGEST * self.denominator
    }

    /// Returns the last whole increment of a turn, R - 1 of the source; `None` without a turn length.
    pub(super) fn last(self) -> Option<i64> {
        let turn = self.turn?;
        i64::try_from((turn - 1).div_euclid(self.denominator << 32)).ok()
    }

    /// Returns the maximum difference of two integrators in whole turns, for a user unit of `unit` increments; `None`
    /// without a turn length (AMC-ROT-04).
    pub(super) fn capacity(self, unit: f64) -> Option<i64> {
        // f64 is precise enough: a turn is below 2^93 and the quotient is rounded down. The cast saturates.
        let turn = self.turn? as f64 / (1_u64 << 32) as f64 / self.denominator as f64;
        Some((CAPACITY * unit / turn).floor() as i64)
    }

    /// Returns true if a difference of positions exceeds `turns`.
    pub(super) fn exceeds(self, difference: Exact, turns: i64) -> bool {
        self.turn.is_some_and(|turn| difference.0.abs() > turn.saturating_mul(i128::from(turns)))
    }

    /// Returns half a turn as a change of references, which are whole increments: it is rounded up to the next
    /// increment.
    fn half(self, turn: i128) -> i128 {
        let unit = self.denominator << 32;
        (turn / 2 + turn % 2 + unit - 1).div_euclid(unit) * unit
    }

    /// Returns A: the change of a profile input at `from` for the change `wanted`.
    pub(super) fn added(self, mode: Mode, wanted: Exact, from: Exact) -> Exact {
        let Some(turn) = self.turn else { return wanted };
        let (wanted, shown) = (wanted.0, self.shown(from).0);
        // AMC-ROT-20: the remainder with the sign of the change.
        let rest = wanted % turn;
        let forward = if rest < 0 { rest + turn } else { rest };
        Exact(match mode {
            Mode::Linear | Mode::MultiTurnDelta => wanted,
            // At exactly half a turn the sign is kept (M04).
            Mode::Shortest if rest > self.half(turn) => rest - turn,
            Mode::Shortest if rest < -self.half(turn) => rest + turn,
            Mode::Shortest => rest,
            Mode::Forward => forward,
            Mode::Reverse if rest > 0 => rest - turn,
            Mode::Reverse => rest,
            Mode::NoRollover if shown + rest < 0 => rest + turn,
            Mode::NoRollover if shown + rest >= turn => rest - turn,
            Mode::NoRollover => rest,
            // A change of a whole turn or more against the direction is ignored (M05).
            Mode::MultiTurnForward if wanted <= -turn => 0,
            Mode::MultiTurnForward if wanted < 0 => wanted + turn,
            Mode::MultiTurnReverse if wanted >= turn => 0,
            Mode::MultiTurnReverse if wanted > 0 => wanted - turn,
            Mode::MultiTurnForward | Mode::MultiTurnReverse => wanted,
        })
    }
}

#[cfg(test)]
mod tests;

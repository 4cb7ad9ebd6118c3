//! Corrections by marks, spread over a distance of the master or over a time.
//!
//! Law      each correction is moved evenly over its own distance (inc of the master) or time (cycles), whatever
//!          corrections follow. A correction commanded less than a sixteenth of that after another ends with it. Their
//!          sum is bounded; the rest follows as soon as possible
//! Reads    the change of the master
//! Writes   the motion of the corrections in a cycle (inc)
//! Refuses  nothing
//! Source   MACS-MARK-12, MACS-MARK-13, A-39

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Largest number of simultaneous separate corrections.
const MOST: usize = 16;

/// One correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Part {
    /// Remaining correction; zero: the correction has ended.
    left: Position,
    /// Remaining distance (inc) or time (cycles).
    over: f64,
    is_time: bool,
}

impl Part {
    fn is_over(&self) -> bool {
        self.left == Position::ZERO
    }

    /// Returns the distance or time that passes in a cycle in which the master moves by `change` (inc).
    fn passed(&self, change: f64) -> f64 {
        if self.is_time { 1.0 } else { change.abs() }
    }

    /// Returns the motion of such a cycle.
    fn wanted(&self, change: f64) -> f64 {
        let (left, passed) = (self.left.to_f64(), self.passed(change));
        if passed >= self.over { left } else { left * (passed / self.over) }
    }

    /// Moves by a share of that.
    fn step(&mut self, change: f64, share: f64) -> Position {
        let step = self.wanted(change) * share;
        self.over = (self.over - self.passed(change)).max(0.0);
        // At the end the remaining correction is used exactly, bit by bit.
        let way = if step == self.left.to_f64() { self.left } else { Position::from_f64(step) };
        self.left = self.left - way;
        way
    }
}

/// The active corrections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Spread {
    parts: [Part; MOST],
}

impl Spread {
    /// Adds a correction over a distance of the master (inc), or over a time (cycles).
    pub(in crate::axis) fn add(&mut self, correction: Position, over: f64, is_time: bool) {
        if correction == Position::ZERO {
            return;
        }
        let least = over * (1.0 - 1.0 / MOST as f64);
        let joins = |part: &Part| !part.is_over() && part.is_time == is_time && (least..=over).contains(&part.over);
        if let Some(part) = self.parts.iter_mut().find(|part| joins(part)) {
            part.left += correction;
        } else if let Some(free) = self.parts.iter_mut().find(|part| part.is_over()) {
            *free = Part { left: correction, over, is_time };
        } else if let Some(last) = self.parts.iter_mut().max_by(|one, other| one.over.total_cmp(&other.over)) {
            // Only if distances or times have changed, or the bound delays corrections.
            last.left += correction;
        }
    }

    /// Returns the motion in a cycle in which the master moves by `change` (inc), at most `most` (inc) in either
    /// direction.
    pub(in crate::axis) fn step(&mut self, change: f64, most: f64) -> Position {
        let wanted: f64 = self.parts.iter().map(|part| part.wanted(change)).sum();
        let share = if wanted.abs() > most { most / wanted.abs() } else { 1.0 };
        let mut way = Position::ZERO;
        for part in self.parts.iter_mut().filter(|part| !part.is_over()) {
            way += part.step(change, share);
        }
        way
    }

    /// Returns the remaining sum of corrections.
    pub(in crate::axis) fn left(&self) -> Position {
        self.parts.iter().fold(Position::ZERO, |sum, part| sum + part.left)
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.parts.iter().all(|part| part.left.is_legal() && part.over >= 0.0) && self.left().is_legal()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(spread: &mut Spread, cycles: usize) -> f64 {
        (0..cycles).fold(Position::ZERO, |sum, _| sum + spread.step(10.0, f64::INFINITY)).to_f64()
    }

    /// SYNCVFTIME -100000 is a second, with a correct pair of marks every 50 ms. If each pair restarted the correction,
    /// 0.95^20 of it, 36 %, would be left after that second.
    ///
    /// Proves: MACS-SYNC-10, MACS-MARK-13, MACS-O-37
    #[test]
    fn a_correction_ends_in_its_time_whatever_pairs_come() {
        let mut spread = Spread::default();
        spread.add(Position::whole(100), 1_000.0, true);
        let mut sum = 0.0;
        for pair in 1..=20 {
            sum += given(&mut spread, 50);
            assert!((sum - 5.0 * f64::from(pair)).abs() < 1e-6, "{pair}: {sum}");
            spread.add(Position::ZERO, 1_000.0, true);
        }
        assert_eq!(spread.left(), Position::ZERO);
        // Without a time it moves with the distance of the master.
        spread.add(Position::whole(-200), 500.0, false);
        assert!((given(&mut spread, 25) + 100.0).abs() < 1e-6);
        assert_eq!(spread.step(0.0, f64::INFINITY), Position::ZERO);
        assert!((given(&mut spread, 25) + 100.0).abs() < 1e-6);
        assert_eq!(spread.left(), Position::ZERO);
    }

    /// 100 inc over 1000 cycles, and 250 cycles later 40 inc over as many: 0.1 inc per cycle, then 0.14, then 0.04.
    ///
    /// Proves: MACS-MARK-13
    #[test]
    fn each_correction_keeps_its_own_time() {
        let mut spread = Spread::default();
        spread.add(Position::whole(100), 1_000.0, true);
        assert!((given(&mut spread, 250) - 25.0).abs() < 1e-6);
        spread.add(Position::whole(40), 1_000.0, true);
        assert!((given(&mut spread, 750) - 105.0).abs() < 1e-6);
        assert!((given(&mut spread, 249) - 9.96).abs() < 1e-6);
        assert_eq!((given(&mut spread, 1) * 100.0).round(), 4.0);
        assert_eq!(spread.left(), Position::ZERO);
    }

    /// More corrections than there is room for: none takes longer than its time, and none ends more than a sixteenth of
    /// it earlier.
    #[test]
    fn many_corrections_end_in_time() {
        let mut spread = Spread::default();
        let (mut sum, mut ordered) = (0.0, vec![]);
        for cycle in 0..4_000 {
            if cycle % 5 == 0 {
                spread.add(Position::whole(1), 1_000.0, true);
                ordered.push(cycle);
            }
            sum += given(&mut spread, 1);
            let within = |time: f64| -> f64 {
                ordered.iter().map(|at| (f64::from(cycle + 1 - at) / time).clamp(0.0, 1.0)).sum()
            };
            assert!(sum >= within(1_000.0) - 1e-3 && sum <= within(1_000.0 * 15.0 / 16.0) + 1e-3, "{cycle}: {sum}");
        }
        assert!(spread.is_sound());
    }

    /// Half of the motion is allowed: all of it is moved, but later.
    #[test]
    fn a_bound_delays_and_loses_nothing() {
        let mut spread = Spread::default();
        spread.add(Position::whole(100), 100.0, true);
        spread.add(Position::whole(-20), 50.0, true);
        let mut sum = Position::ZERO;
        for _ in 0..400 {
            let step = spread.step(0.0, 0.3);
            assert!(step.to_f64().abs() <= 0.3 + 1e-6);
            sum += step;
        }
        assert_eq!((sum, spread.left()), (Position::whole(80), Position::ZERO));
    }
}

//! A shift of the leading position for its follower (MC_PhasingRelative).
//!
//! Law      the sum of its changes is the shift, to 2^-32 inc. The velocity changes by at most the acceleration per
//!          cycle, and the shift ends at rest after whole cycles, by the law with which a follower catches up
//!          ([`closing_velocity`])
//! Reads    nothing: the leader may be at rest or move in either direction
//! Refuses  nothing: velocity and acceleration were checked by the axis
//! Source   contract section 10, PLCopen (MC_PhasingRelative)

use super::follower::closing_velocity;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// An active shift.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shift {
    /// Whole distance from its start.
    whole: Position,
    /// Remaining distance.
    left: Position,
    /// Last change (inc per cycle).
    speed: f64,
    /// Largest velocity (inc per cycle).
    velocity: f64,
    /// Largest change of velocity (inc per cycle and cycle).
    rate: f64,
    /// Whether it slows down to rest at any position.
    stops: bool,
}

impl Shift {
    /// Returns a shift with a velocity (inc/s) and an acceleration (inc/s^2). It replaces an active one, from its
    /// speed.
    pub fn new(whole: Position, velocity: f64, acceleration: f64, cycle_s: f64, before: Option<&Self>) -> Self {
        // Below the resolution of positions there would be no motion.
        let least = Position::from_raw(1).to_f64();
        Self {
            whole,
            left: whole,
            speed: before.map_or(0.0, |before| before.speed),
            velocity: (velocity * cycle_s).max(least),
            rate: (acceleration * cycle_s * cycle_s).max(least),
            stops: false,
        }
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        let rates = [self.velocity, self.rate];
        self.speed.is_finite() && rates.iter().all(|rate| *rate > 0.0 && rate.is_finite()) && self.left.is_legal()
    }

    /// Returns the shift slowing down to rest.
    #[must_use]
    pub fn stopping(self) -> Self {
        Self { stops: true, ..self }
    }

    /// Returns the shift with another velocity (inc/s) and acceleration (inc/s^2) from now on.
    #[must_use]
    pub fn at_rates(self, velocity: f64, acceleration: f64, cycle_s: f64) -> Self {
        let Self { left, stops, .. } = self;
        Self { left, stops, ..Self::new(self.whole, velocity, acceleration, cycle_s, Some(&self)) }
    }

    /// Returns the shift after a cycle in which only `done` (inc per cycle) of its last change was moved: it
    /// accelerates from there.
    #[must_use]
    pub fn limited_to(self, done: f64) -> Self {
        let (low, high) = (self.speed.min(0.0), self.speed.max(0.0));
        Self { speed: done.max(low).min(high), ..self }
    }

    /// Returns the remaining share of the distance: more than 1 while it still has to reverse; 0 for a shift that
    /// stops.
    pub fn share_left(&self) -> f64 {
        if self.stops || self.whole == Position::ZERO { 0.0 } else { self.left.to_f64() / self.whole.to_f64() }
    }

    /// Returns its last change (inc per cycle).
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns the remaining distance.
    pub fn left(&self) -> Position {
        self.left
    }

    /// Returns the change of this cycle, and whether the shift has ended with it.
    pub fn step(&mut self) -> (Position, bool) {
        self.step_within(self.velocity)
    }

    /// As [`step`](Self::step), at most `most` (inc per cycle) as soon as it has slowed down to that.
    pub fn step_within(&mut self, most: f64) -> (Position, bool) {
        let (wanted, arrives) = if self.stops { (0.0, false) } else { closing_velocity(self.left.to_f64(), self.rate) };
        let (low, high) = (self.speed - self.rate, self.speed + self.rate);
        // Not `clamp`: an invalid state may have crossed bounds.
        let most = self.velocity.min(most.max(0.0));
        let speed = wanted.max(-most).min(most).max(low).min(high);
        if arrives && speed == wanted {
            self.speed = 0.0;
            return (std::mem::take(&mut self.left), true);
        }
        self.speed = speed;
        let change = Position::from_f64(speed);
        self.left = self.left - change;
        (change, self.stops && speed == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 10 inc at 1 inc per cycle and 0.25 inc per cycle and cycle: four cycles of acceleration, and a deceleration of
    /// 0.75 + 0.5 + 0.25.
    #[test]
    fn a_shift_is_a_trapezoid_of_whole_cycles() {
        let mut shift = Shift::new(Position::whole(10), 1_000.0, 250_000.0, 1e-3, None);
        let mut speeds = vec![];
        loop {
            let (change, ended) = shift.step();
            speeds.push(change.to_f64());
            if ended {
                break;
            }
        }
        assert_eq!(speeds[..4], [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(speeds.iter().sum::<f64>(), 10.0);
        // 1.5 inc of acceleration, 8.5 for the rest: seven at full speed, then 1.5 in three steps.
        assert_eq!(speeds.len(), 3 + 7 + 3);
        assert_eq!(speeds[10..], [0.75, 0.5, 0.25]);
    }

    /// At 1 inc per cycle: nothing of the step was moved, a part, or the opposite.
    #[test]
    fn limited_shift_accelerates_from_its_real_velocity() {
        let mut shift = Shift::new(Position::whole(-100), 1_000.0, 250_000.0, 1e-3, None);
        for _ in 0..4 {
            shift.step();
        }
        for (done, speed) in [(0.0, 0.0), (-0.5, -0.5), (2.0, 0.0), (-3.0, -1.0), (-1.0, -1.0)] {
            let mut held = shift.limited_to(done);
            assert_eq!((held.speed(), held.left()), (speed, shift.left()));
            assert_eq!(held.step().0.to_f64(), (speed - 0.25).max(-1.0));
        }
    }

    /// 10 inc at 1 inc per cycle and 0.25 inc per cycle and cycle, with half of both after the fifth cycle, when 6.5
    /// are left: it slows down to 0.5 in steps of 0.125.
    #[test]
    fn one_may_change_its_rates() {
        let mut shift = Shift::new(Position::whole(10), 1_000.0, 250_000.0, 1e-3, None);
        for _ in 0..5 {
            shift.step();
        }
        assert_eq!((shift.speed(), shift.left().to_f64()), (1.0, 6.5));
        let same = shift.at_rates(1_000.0, 250_000.0, 1e-3);
        assert_eq!(same, shift);
        let mut slower = shift.at_rates(500.0, 125_000.0, 1e-3);
        let speeds = [(); 5].map(|()| slower.step().0.to_f64());
        assert_eq!(speeds, [0.875, 0.75, 0.625, 0.5, 0.5]);
        assert_eq!(slower.left().to_f64(), 6.5 - 3.25);
    }

    #[test]
    fn one_that_stops_ends_at_rest_wherever_that_is() {
        let mut shift = Shift::new(Position::whole(-100), 1_000.0, 500_000.0, 1e-3, None);
        assert_eq!((shift.step().0.to_f64(), shift.step().0.to_f64()), (-0.5, -1.0));
        assert_eq!(shift.share_left(), 0.985);
        let mut shift = shift.stopping();
        let (half, rest) = (shift.step(), shift.step());
        assert_eq!((half, rest), ((Position::from_f64(-0.5), false), (Position::ZERO, true)));
    }

    proptest! {
        /// Whenever it is replaced, all of the last shift is moved; no cycle exceeds the velocity, and no change of
        /// velocity exceeds the acceleration, except for rounding.
        #[test]
        fn all_of_it_comes(
            first in -1_000_000_i64..1_000_000,
            second in -(1_i128 << 52)..(1_i128 << 52),
            velocity in 1e-3..1e6_f64,
            acceleration in 1.0..1e7_f64,
            after in 0_usize..2_000,
        ) {
            let new = |whole, before: Option<&Shift>| Shift::new(whole, velocity, acceleration, 1e-3, before);
            let grid = Position::from_raw(2).to_f64();
            let mut shift = new(Position::whole(first), None);
            let mut speed = 0.0;
            let mut sum = Position::ZERO;
            // As much as the time allows.
            let whole = Position::from_raw(second.clamp(-1, 1) * i128::min(second.abs(), Position::from_f64(velocity).raw()));
            for k in 0..200_000 {
                if k == after {
                    shift = new(whole, Some(&shift));
                    sum = Position::ZERO;
                }
                let (change, ended) = shift.step();
                let change_f = change.to_f64();
                prop_assert!(change_f.abs() <= velocity * 1e-3 + grid);
                prop_assert!((change_f - speed).abs() <= acceleration * 1e-6 + grid, "{} {}", change_f, speed);
                speed = change_f;
                sum += change;
                if ended && k >= after {
                    prop_assert_eq!(sum, whole);
                    return Ok(());
                }
            }
            prop_assert!(false, "it has not ended: {:?}", shift);
        }
    }
}

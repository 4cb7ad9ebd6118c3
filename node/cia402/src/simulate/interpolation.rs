//! Interpolation between two setpoints of csp and ip.
//!
//! Law      a new setpoint is reached after the interpolation time of 60C2h, in equal steps, one per cycle of the mechanics
//! Source   CiA 402-2 (60C2h)

use super::table::ObjectTable;
use crate::objects;

/// Interpolator between two setpoints.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Interpolator {
    /// Setpoint; `None` before the first one.
    goal: Option<i64>,
    demand: i64,
    /// Cycles until the setpoint is reached.
    left: u32,
}

/// Returns the number of cycles of the mechanics between two setpoints (60C2h); at least 1.
pub(super) fn cycles(table: &ObjectTable, cycle_s: f64) -> u32 {
    let units = f64::from(table.get(objects::INTERPOLATION_VALUE));
    let seconds = units * 10_f64.powi(table.signed(objects::INTERPOLATION_INDEX));
    // The conversion saturates.
    ((seconds / cycle_s).round() as u32).max(1)
}

impl Interpolator {
    /// Resets the interpolator to position `count`.
    pub(super) fn rest_at(&mut self, count: i64) {
        *self = Self { goal: None, demand: count, left: 0 };
    }

    /// Holds the present position.
    pub(super) fn hold(&mut self) -> i64 {
        self.rest_at(self.demand);
        self.demand
    }

    /// Advances by one cycle towards a setpoint, which is reached in `cycles` cycles. Returns the position.
    pub(super) fn step(&mut self, goal: i64, cycles: u32) -> i64 {
        if self.goal != Some(goal) {
            (self.goal, self.left) = (Some(goal), cycles.max(1));
        }
        if self.left > 0 {
            let way = goal.wrapping_sub(self.demand);
            self.demand = self.demand.wrapping_add(way / i64::from(self.left));
            self.left -= 1;
        }
        self.demand
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setpoint_is_reached_in_equal_steps_and_then_kept() {
        let mut interpolator = Interpolator::default();
        interpolator.rest_at(10);
        let way: Vec<_> = (0..5).map(|_| interpolator.step(-30, 4)).collect();
        assert_eq!(way, [0, -10, -20, -30, -30]);
        // If the setpoint changes before it is reached, the interpolation starts at the present position.
        assert_eq!([interpolator.step(-10, 4), interpolator.step(0, 5)], [-25, -20]);
        assert_eq!(interpolator.hold(), -20);
        assert_eq!(interpolator.step(7, 1), 7);
    }

    /// 8 times 10^-3 s and 25 times 10^-4 s, in cycles of 2 ms and 0.5 ms.
    #[test]
    fn interpolation_time_is_in_cycles_of_the_mechanics() {
        let mut table = ObjectTable::plain();
        let mut set = |value: u32, index: i32| {
            table.set(objects::INTERPOLATION_VALUE, value);
            table.set(objects::INTERPOLATION_INDEX, index.cast_unsigned());
            [0.002, 0.000_5].map(|cycle_s| cycles(&table, cycle_s))
        };
        assert_eq!([set(8, -3), set(25, -4), set(0, -3)], [[4, 16], [1, 5], [1, 1]]);
    }
}

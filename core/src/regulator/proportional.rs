//! The purely proportional position loop.
//!
//! Law      velocity = kv * (command - actual), within +-max_velocity. At constant speed within this limit the
//!          difference is velocity / kv
//! Reads    command and actual position of the same cycle (inc)
//! Writes   the velocity for the drive (inc/s)
//! Refuses  nothing: the rows of its parameters do
//! Source   WF-CLC-03, WF-MD-14

use crate::position::Position;

/// Gain of kv = 1 (mm/min)/um (1/s). Millimetres and micrometres cancel, so it applies to turns as well.
pub const KV: f64 = 1000.0 / 60.0;

/// The position loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportional {
    /// Gain (1/s).
    pub gain: f64,
    /// Largest velocity (inc/s).
    pub max_velocity: f64,
}

impl Proportional {
    /// Returns the velocity for the drive (inc/s).
    pub fn velocity(&self, command: Position, actual: Position) -> f64 {
        let error = (command - actual).to_f64();
        // With NaN as limit there is neither a limit nor a panic.
        (self.gain * error).min(self.max_velocity).max(-self.max_velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 6 m/min is 100 mm/s: with 1000 inc/mm the drive is commanded 100000 inc/s when it is 6 mm behind.
    ///
    /// Proves: WF-ORA-06, WF-CLC-03
    #[test]
    fn six_metres_a_minute_are_six_millimetres_behind() {
        let regulator = Proportional { gain: KV, max_velocity: 1e9 };
        let velocity = regulator.velocity(Position::whole(6_000), Position::ZERO);
        assert!((velocity - 100_000.0).abs() < 1e-9, "{velocity}");
        assert!((KV - 16.67).abs() < 0.005);
    }

    #[test]
    fn the_fraction_of_the_command_counts() {
        let regulator = Proportional { gain: 10.0, max_velocity: 1e9 };
        let command = Position::whole(3) + Position::from_f64(0.5);
        assert_eq!(regulator.velocity(command, Position::whole(1)), 25.0);
    }

    proptest! {
        #[test]
        fn velocity_never_exceeds_the_maximum(
            command in any::<i64>(), actual in any::<i64>(), gain in 0.1..2000.0_f64, most in 1e-3..1e15_f64,
        ) {
            let regulator = Proportional { gain, max_velocity: most };
            let velocity = regulator.velocity(Position::whole(command), Position::whole(actual));
            prop_assert!(velocity.abs() <= most);
            prop_assert_eq!(velocity > 0.0, command > actual);
            let other = regulator.velocity(Position::whole(actual), Position::whole(command));
            prop_assert_eq!(other, -velocity);
        }
    }
}

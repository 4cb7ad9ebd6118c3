//! The sum of errors of a sampled loop, with anti-windup.
//!
//! Law      sum' = sum + growth, within +-most; growth beyond the limit of the output is omitted
//! Reads    the sum, its growth, the output per unit of the sum, the remaining range of the output
//! Writes   the new sum
//! Refuses  nothing: every value saturates

/// Remaining range of the output upwards and downwards, both from 0 on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    pub(super) up: f64,
    pub(super) down: f64,
}

impl Room {
    /// Returns the range of an output that is between `low` and `high` and limited to +-`most`.
    pub(super) fn around(low: f64, high: f64, most: f64) -> Self {
        Self { up: (most - high).max(0.0), down: (most + low).max(0.0) }
    }
}

/// Returns the sum after a sample. `worth` is the output per unit of the sum, of either sign.
///
/// The last growth is cut, not omitted: a sum that stopped with the last whole sample below the limit would leave a
/// constant output below the limit.
pub(super) fn grown(sum: f64, growth: f64, most: f64, worth: f64, room: Room) -> f64 {
    let sum = within(sum, most);
    let next = within(sum + growth, most);
    let part = worth * (next - sum);
    if part > room.up {
        within(sum + room.up / worth, most)
    } else if part < -room.down {
        within(sum - room.down / worth, most)
    } else {
        next
    }
}

/// Limits to +-`most`, without panic for an invalid bound.
pub(super) fn within(value: f64, most: f64) -> f64 {
    value.min(most).max(-most)
}

/// Limits to +-`most`; NaN becomes 0, so that a failed measurement has no effect.
pub(super) fn measured(value: f64, most: f64) -> f64 {
    if value.is_nan() { 0.0 } else { within(value, most) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WIDE: Room = Room { up: 1e9, down: 1e9 };

    #[test]
    fn the_sum_grows_to_its_bound_either_way() {
        assert_eq!(grown(1.0, 2.0, 10.0, 1.0, WIDE), 3.0);
        assert_eq!(grown(9.0, 2.0, 10.0, 1.0, WIDE), 10.0);
        assert_eq!(grown(-9.0, -2.0, 10.0, 1.0, WIDE), -10.0);
        assert_eq!(grown(9.0, 2.0, 5.0, 1.0, WIDE), 5.0, "a bound that falls takes the sum with it");
        assert_eq!(grown(3.0, 2.0, 0.0, 1.0, WIDE), 0.0);
    }

    #[test]
    fn growth_ends_where_the_output_reaches_its_limit() {
        let room = Room::around(-0.5, 0.75, 1.0);
        assert_eq!((room.up, room.down), (0.25, 0.5));
        assert_eq!(grown(1.0, 2.0, 10.0, 0.5, room), 1.5);
        assert_eq!(grown(1.0, -2.0, 10.0, 0.5, room), 0.0);
        // With a negative worth a decreasing sum raises the output.
        assert_eq!(grown(1.0, -2.0, 10.0, -0.5, room), 0.5);
        assert_eq!(grown(1.0, 2.0, 10.0, -0.5, room), 2.0);
    }

    #[test]
    fn a_saturated_output_has_no_room_and_lets_the_sum_return() {
        let room = Room::around(3.0, 3.0, 1.0);
        assert_eq!((room.up, room.down), (0.0, 4.0));
        assert_eq!(grown(1.0, 2.0, 10.0, 0.5, room), 1.0);
        assert_eq!(grown(1.0, -2.0, 10.0, 0.5, room), -1.0);
    }

    proptest! {
        #[test]
        fn the_output_gains_no_more_than_its_room(
            sum in -50.0..50.0_f64, growth in -20.0..20.0_f64, most in 0.0..60.0_f64, worth in -4.0..4.0_f64,
            up in 0.0..10.0_f64, down in 0.0..10.0_f64,
        ) {
            let next = grown(sum, growth, most, worth, Room { up, down });
            let start = within(sum, most);
            prop_assert!(next.abs() <= most);
            prop_assert!((next - start).abs() <= growth.abs() * (1.0 + 1e-12) + 1e-12);
            let part = worth * (next - start);
            prop_assert!(part <= up + 1e-9 && part >= -down - 1e-9, "{part}");
            prop_assert!((next - start) * growth >= -1e-12, "it never turns back");
        }
    }
}

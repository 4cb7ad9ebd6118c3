//! Turn of a rotary axis. Its length is an exact fraction, so it need not be whole increments and never drifts.

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Direction of an absolute move on a modulo axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Direction {
    /// The shorter distance; positive if both are equal.
    #[default]
    Shortest,
    /// Positive direction only.
    Positive,
    /// Negative direction only.
    Negative,
    /// The present or last direction of motion; the shorter distance if the axis never moved.
    Current,
}

/// Length of a turn (inc) as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Modulo {
    numerator: i64,
    denominator: i64,
}

impl Modulo {
    /// Creates a turn of numerator / denominator increments; `None` unless 0 < denominator < 2^31, numerator < 2^61 and
    /// the turn is one increment or more.
    pub fn new(numerator: i64, denominator: i64) -> Option<Self> {
        let legal = (1..1 << 31).contains(&denominator) && (denominator..1 << 61).contains(&numerator);
        legal.then_some(Self { numerator, denominator })
    }

    /// Returns true if a restored turn is valid.
    pub fn is_sound(self) -> bool {
        Self::new(self.numerator, self.denominator) == Some(self)
    }

    /// Returns its length (inc), rounded up.
    pub(crate) fn length(self) -> i64 {
        let whole = self.numerator / self.denominator;
        if self.numerator % self.denominator == 0 { whole } else { whole.saturating_add(1) }
    }

    /// Returns the denominator of its length in increments.
    pub(crate) fn denominator(self) -> i128 {
        i128::from(self.denominator)
    }

    /// Returns a turn in units of 2^-32 inc / denominator.
    pub(crate) fn turn(self) -> i128 {
        i128::from(self.numerator) << 32
    }

    /// Returns whole turns, and the position within the turn.
    pub fn split(self, position: Position) -> (i64, Position) {
        let denominator = i128::from(self.denominator);
        let scaled = raw(position) * denominator;
        let (turns, within) = (scaled.div_euclid(self.turn()), scaled.rem_euclid(self.turn()));
        (turns as i64, Position::from_raw(within.div_euclid(denominator)))
    }

    /// Returns true if a position is between two others, both included, in positive direction from the first one within
    /// the turn; always true if they are a turn apart or more. Accurate to 2^-32 inc: a position within a turn may
    /// differ from its exact value by half of that.
    pub fn is_between(self, first: Position, last: Position, place: Position) -> bool {
        let denominator = i128::from(self.denominator);
        let up = |to: Position| raw(to) * denominator - raw(first) * denominator;
        let width = if last >= first { up(last) } else { up(last).rem_euclid(self.turn()) };
        let way = up(place).rem_euclid(self.turn());
        way <= width.saturating_add(denominator) || way + denominator >= self.turn()
    }

    /// Returns the position that is shown as `wanted` within its turn and that `now` has last reached or passed, with
    /// its last change.
    pub fn last_reached(self, wanted: Position, now: Position, change: Position) -> Position {
        let direction = if change < Position::ZERO { Direction::Positive } else { Direction::Negative };
        self.target(wanted, now, now, direction, 0.0)
    }

    /// Returns the target nearest to `now` in the given direction that is shown as `wanted` within its turn, to 2^-32
    /// inc. `stop` is the position at which the axis would come to rest: no direction requires a reversal from there.
    /// If both distances are equal, the positive one is used.
    ///
    /// A position within a turn may be no multiple of 2^-32 inc, so that `wanted` and `now` may each differ from their
    /// exact values by half of that. Within this difference they count as the same position, or as half a turn apart.
    pub fn target(self, wanted: Position, now: Position, stop: Position, direction: Direction, last: f64) -> Position {
        let denominator = i128::from(self.denominator);
        let rounding = denominator;
        let wanted = (raw(wanted) * denominator).rem_euclid(self.turn());
        let ahead = |from: Position| {
            let way = (wanted - raw(from) * denominator).rem_euclid(self.turn());
            if way + rounding >= self.turn() && way != 0 { way - self.turn() } else { way }
        };
        let up = |from: Position| raw(from) * denominator + ahead(from);
        let down = |from: Position| {
            let way = ahead(from);
            raw(from) * denominator + if way <= rounding { way } else { way - self.turn() }
        };
        let scaled = match direction {
            Direction::Positive => up(stop.max(now)),
            Direction::Negative => down(stop.min(now)),
            Direction::Current if last > 0.0 => up(stop.max(now)),
            Direction::Current if last < 0.0 => down(stop.min(now)),
            Direction::Shortest | Direction::Current => {
                let way = ahead(now);
                if 2 * (way - rounding) <= self.turn() { up(now) } else { down(now) }
            }
        };
        Position::from_raw((scaled + denominator / 2).div_euclid(denominator))
    }
}

/// Returns a position in units of 2^-32 inc, limited to 2^63 inc: times a denominator below 2^31 it stays below 2^127.
fn raw(position: Position) -> i128 {
    position.raw().clamp(-(1 << 95), 1 << 95)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn target(wanted: i64, now: i64, direction: Direction, last: f64) -> i64 {
        let now = Position::whole(now);
        Modulo::new(36_000, 1).unwrap().target(Position::whole(wanted), now, now, direction, last).nearest()
    }

    /// Returns the multiple of 2^-32 inc nearest to numerator / denominator, as requests are converted.
    fn part(numerator: i64, denominator: i64) -> Position {
        let scaled = i128::from(numerator) << 33;
        let twice = i128::from(denominator) * 2;
        Position::from_raw((scaled + i128::from(denominator)).div_euclid(twice))
    }

    /// 333 1/3 inc, 1001 inc, 100 1/7 inc: half of it is no whole increment, and mostly no multiple of 2^-32 either.
    /// Exactly half a turn is positive from any position, and an increment more or less is not.
    #[test]
    fn half_a_turn_that_is_no_whole_increment_goes_up() {
        for (numerator, denominator) in [(1_000, 3), (1_001, 1), (701, 7), (36_000, 1), (1_001, 4)] {
            let modulo = Modulo::new(numerator, denominator).unwrap();
            for turns in [0, 1, 2, 5, -1, -4, 1_000_003, -999_998] {
                // n turns, n turns and a half, and positions between.
                for twelfth in 0..12 {
                    let now = part((turns * 12 + twelfth) * numerator, denominator * 12);
                    let wanted = part((twelfth + 6) * numerator, denominator * 12);
                    let end = modulo.target(wanted, now, now, Direction::Shortest, 0.0);
                    let half = part((turns * 12 + twelfth + 6) * numerator, denominator * 12);
                    assert!(
                        (end - half).raw().abs() <= 2,
                        "{numerator}/{denominator}: {twelfth}, turn {turns}: {end:?}"
                    );
                    let beyond = wanted + part(1, 1_000_000);
                    let down = modulo.target(beyond, now, now, Direction::Shortest, 0.0);
                    assert!(down < now, "{numerator}/{denominator}: a millionth of an increment more is the other way");
                }
            }
        }
    }

    /// An axis at a position, as accurately as positions can represent it, has reached it: no direction causes a turn
    /// for the rounding error.
    #[test]
    fn position_within_rounding_error_is_reached() {
        use Direction::*;
        let modulo = Modulo::new(1_000, 3).unwrap();
        for turns in [-7, 0, 1, 2, 3_000_001] {
            for place in 0..12 {
                let now = part((turns * 12 + place) * 1_000, 36);
                let wanted = part(place * 1_000, 36);
                for direction in [Shortest, Positive, Negative, Current] {
                    let end = modulo.target(wanted, now, now, direction, 1.0);
                    assert!((end - now).raw().abs() <= 2, "{direction:?} {turns} {place}");
                }
            }
        }
    }

    #[test]
    fn each_direction_goes_its_way() {
        use Direction::*;
        assert_eq!(target(35_000, 1_000, Shortest, 0.0), -1_000);
        assert_eq!(target(35_000, 1_000, Positive, 0.0), 35_000);
        assert_eq!(target(2_000, 1_000, Negative, 0.0), 2_000 - 36_000);
        assert_eq!(target(1_000, 1_000, Positive, 0.0), 1_000);
        assert_eq!(target(1_000, 1_000, Negative, 0.0), 1_000);
        assert_eq!(target(35_000, 1_000, Current, 1.0), 35_000);
        assert_eq!(target(2_000, 1_000, Current, -1.0), 2_000 - 36_000);
        assert_eq!(target(35_000, 1_000, Current, 0.0), -1_000);
        assert_eq!(target(19_000, 1_000, Shortest, 0.0), 19_000, "both ways are equal: up");
        assert_eq!(target(10, -72_000_000_000, Shortest, 0.0), -72_000_000_000 + 10);
    }

    #[test]
    fn an_axis_that_cannot_stop_before_the_target_takes_the_next_turn() {
        let modulo = Modulo::new(36_000, 1).unwrap();
        let (now, stop) = (Position::whole(100), Position::whole(300));
        assert_eq!(modulo.target(Position::whole(200), now, stop, Direction::Positive, 1.0), Position::whole(36_200));
    }

    #[test]
    fn a_turn_of_a_third_of_an_increment_more_never_drifts() {
        // 1000 1/3 inc per turn: 3 million turns are 3 001 000 000 inc.
        let modulo = Modulo::new(3001, 3).unwrap();
        assert_eq!(modulo.split(Position::whole(3_001_000_000)), (3_000_000, Position::ZERO));
        assert_eq!(modulo.split(Position::whole(-1)).0, -1);
        let mut now = Position::ZERO;
        for turn in 1..=3000_i64 {
            let wanted = Position::ZERO;
            let next =
                modulo.target(wanted, now + Position::whole(1), now + Position::whole(1), Direction::Positive, 0.0);
            assert_eq!(next.nearest(), (turn * 3001 * 2 + 3) / 6, "turn {turn}");
            now = Position::whole(next.nearest());
        }
    }

    #[test]
    fn invalid_turn_is_refused() {
        for (numerator, denominator) in [(0, 1), (1, 0), (-5, 1), (1, 2), (1 << 61, 1), (5, 1 << 31)] {
            assert_eq!(Modulo::new(numerator, denominator), None);
        }
    }

    proptest! {
        #[test]
        fn turns_and_rest_make_the_position(
            raw in -(1_i128 << 93)..(1_i128 << 93), numerator in 1_000_i64..1 << 40, denominator in 1_i64..1000,
        ) {
            let modulo = Modulo::new(numerator, denominator).unwrap();
            let (turns, within) = modulo.split(Position::from_raw(raw));
            let scaled = i128::from(turns) * modulo.turn() + within.raw() * i128::from(denominator);
            let lost = raw * i128::from(denominator) - scaled;
            prop_assert!((0..i128::from(denominator)).contains(&lost));
            prop_assert!(within.raw() >= 0 && within.raw() * i128::from(denominator) < modulo.turn());
        }
    }
}

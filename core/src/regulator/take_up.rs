//! Compensation of pitch errors and backlash between motor and load.
//!
//! Law      the commanded compensation follows a target at a limited rate, in whole increments, and depends only on it.
//!          The counts respond to the value of 1 + delay cycles ago. The gap is 0 in the direction in which the
//!          reference was found, and the backlash against it in the other direction. The direction changes when a
//!          position is [`REVERSAL`] behind the furthest one in that direction
//! Reads    positions of the command, targets (inc, in the direction of the encoder)
//! Writes   the commanded compensation, the compensation to subtract from the counts
//! Refuses  nothing
//! Source   WF-INC-04, docs/compensation.md

use serde::{Deserialize, Serialize};

/// Longest ring: one for each cycle of the longest delay, plus one.
pub(crate) const PAST: usize = 33;

/// Distance of the command behind the furthest position in its direction that counts as a reversal (inc): a counted
/// leader jitters by less.
const REVERSAL: i64 = 2;

/// Largest value of the compensation (inc): an error has 32 bits, a backlash 31.
const MOST: i64 = 1 << 33;

/// Compensation of the motor relative to the load, in the direction of the encoder (inc).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Compensator {
    /// Whether there is nothing to compensate, and no compensation left.
    is_idle: bool,
    /// Whether the compensation has reached its target, and the counts have followed.
    is_settled: bool,
    /// Compensation added to the command of the drive.
    asked: i64,
    /// Compensation to which the counts of this cycle respond.
    taken: i64,
    /// Change of that value since the cycle before.
    change: i64,
    /// Fraction of an increment that has accumulated at the limited rate.
    credit: f64,
    /// Direction of the last motion of the command: 1, -1, 0 before the first one.
    sense: i8,
    /// Direction in which the reference was found; 0: none was found, and rising counts are used.
    reference: i8,
    /// Furthest position of the command in its direction.
    furthest: i64,
    /// Length of the ring: the delay of the drive in cycles, plus one.
    length: usize,
    /// Compensation of the last cycles, the oldest first.
    #[serde(with = "past")]
    past: [i64; PAST],
}

impl Compensator {
    pub(crate) fn new(delay: u32) -> Self {
        Self {
            is_idle: true,
            is_settled: true,
            asked: 0,
            taken: 0,
            change: 0,
            credit: 0.0,
            sense: 0,
            reference: 0,
            furthest: 0,
            length: (delay as usize + 1).min(PAST),
            past: [0; PAST],
        }
    }

    /// Returns the compensation added to the command of the drive (inc).
    pub(crate) fn commanded_compensation(&self) -> i64 {
        self.asked
    }

    /// Whether there is nothing to compensate.
    pub(crate) fn is_idle(&self) -> bool {
        self.is_idle
    }

    /// Whether it changes nothing while nothing moves.
    pub(crate) fn is_settled(&self) -> bool {
        self.is_settled
    }

    /// Returns the compensation to which the counts have not responded yet.
    #[inline]
    pub(crate) fn ahead(&self) -> i64 {
        self.asked.saturating_sub(self.taken)
    }

    /// Returns the part of the change of counts in this cycle that is no motion of the load.
    pub(crate) fn change(&self) -> i64 {
        self.change
    }

    /// Whether its ring has the same length as that of `other`.
    pub(crate) fn has_ring_of(&self, other: &Self) -> bool {
        self.length == other.length
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub(crate) fn is_sound(&self) -> bool {
        let is_small = |value: &i64| value.saturating_abs() <= MOST;
        (1..=PAST).contains(&self.length)
            && [self.asked, self.taken, self.change].iter().chain(&self.past).all(is_small)
            && (0.0..1.0).contains(&self.credit)
            && (-1..=1).contains(&self.sense)
            && (-1..=1).contains(&self.reference)
            && (!self.is_idle || self.kept().iter().all(|kept| *kept == 0) && self.asked == 0 && self.taken == 0)
    }

    fn kept(&self) -> &[i64] {
        self.past.get(..self.length).unwrap_or_default()
    }

    /// Advances to the counts of the next cycle, and returns by how much more than the load they have changed.
    pub(crate) fn advance_counts(&mut self) -> i64 {
        let answered = self.past.first().copied().unwrap_or_default();
        self.change = answered.saturating_sub(std::mem::replace(&mut self.taken, answered));
        self.change
    }

    /// Notes the position of the command; a position that is not the command of the axis has no direction.
    pub(crate) fn set_command_position(&mut self, place: i64, is_own: bool) {
        if !is_own {
            self.furthest = place;
            return;
        }
        let gone = place.saturating_sub(self.furthest);
        let turns = gone.saturating_abs() >= REVERSAL && gone.signum() != i64::from(self.sense);
        if turns {
            self.sense = if gone > 0 { 1 } else { -1 };
        }
        if turns || gone.signum() == i64::from(self.sense) {
            self.furthest = place;
        }
    }

    /// Returns the gap between motor and load in the present direction with that backlash.
    pub(crate) fn gap(&self, backlash: i64) -> i64 {
        let reference = if self.reference < 0 { -1 } else { 1 };
        if self.sense == -reference { backlash.saturating_mul(-i64::from(reference)) } else { 0 }
    }

    /// Advances by one cycle towards `target` (inc), by at most `most` (inc, above 0).
    pub(crate) fn step(&mut self, target: i64, most: f64, is_wanted: bool) {
        let way = target.saturating_sub(self.asked);
        if way == 0 {
            self.credit = 0.0;
        } else {
            let may = self.credit + most;
            let whole = may.floor();
            // The cast saturates: no distance exceeds 2^63.
            let step = (whole as i64).min(way.saturating_abs());
            self.credit = if step == way.saturating_abs() { 0.0 } else { may - whole };
            self.asked = self.asked.saturating_add(step.saturating_mul(way.signum()));
        }
        let length = self.length.min(PAST);
        if let Some(kept) = self.past.get_mut(..length) {
            kept.rotate_left(1);
            if let Some(newest) = kept.last_mut() {
                *newest = self.asked;
            }
        }
        let stands = self.kept().iter().all(|kept| *kept == self.asked) && self.taken == self.asked;
        self.is_settled = stands && self.asked == target;
        self.is_idle = !is_wanted && self.is_settled && self.asked == 0;
    }

    /// Makes the compensation of the counts of this cycle 0: it has become part of the coordinate.
    fn restart_at_zero(&mut self) {
        let taken = std::mem::take(&mut self.taken);
        self.asked = self.asked.saturating_sub(taken);
        self.past.iter_mut().for_each(|kept| *kept = kept.saturating_sub(taken));
    }

    /// Starts to observe the motion at that position.
    pub(crate) fn begin_at(&mut self, place: i64) {
        (self.sense, self.furthest) = (0, place);
    }

    /// Sets a reference found in that direction or, with 0, in that of the last motion; there the gap is 0. `is_own`:
    /// whether the last motion was one of the command.
    pub(crate) fn begin_from_zero(&mut self, way: i8, is_own: bool) {
        self.restart_at_zero();
        self.reference = if way == 0 { self.sense } else { way };
        if !is_own {
            self.sense = self.reference;
        }
    }

    /// Resets the compensation for another source of counts.
    pub(crate) fn forget_counts(&mut self) {
        let Self { sense, reference, furthest, length, .. } = *self;
        *self = Self { is_idle: false, is_settled: false, sense, reference, furthest, length, ..Self::new(0) };
    }

    /// Increases all positions by `by` (inc).
    pub(crate) fn shift(&mut self, by: i64) {
        self.furthest = self.furthest.wrapping_add(by);
    }
}

/// Serializes a ring of any length as a list: derived implementations exist only up to 32.
pub(crate) mod past {
    use super::PAST;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(past: &[i64; PAST], serializer: S) -> Result<S::Ok, S::Error> {
        past.as_slice().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[i64; PAST], D::Error> {
        let past = Vec::deserialize(deserializer)?;
        <[i64; PAST]>::try_from(past).map_err(|past| D::Error::invalid_length(past.len(), &"a whole ring"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn led(delay: u32, targets: &[i64], most: f64) -> (Compensator, Vec<i64>) {
        let mut compensation = Compensator::new(delay);
        let mut asked = Vec::new();
        for target in targets {
            compensation.advance_counts();
            compensation.step(*target, most, true);
            assert!(compensation.is_sound());
            asked.push(compensation.asked);
        }
        (compensation, asked)
    }

    /// 0.4 of an increment per cycle are two in five cycles; 2.5 are five in two.
    #[test]
    fn it_goes_by_its_rate_in_whole_increments() {
        assert_eq!(led(0, &[2; 8], 0.4).1, [0, 0, 1, 1, 2, 2, 2, 2]);
        assert_eq!(led(0, &[-7; 5], 2.5).1, [-2, -5, -7, -7, -7]);
        assert_eq!(led(0, &[9, 9, 0, 0], 1e300).1, [9, 9, 0, 0]);
    }

    #[test]
    fn the_counts_answer_one_cycle_and_the_delay_later() {
        for delay in [0, 1, 5, 32] {
            let mut compensation = Compensator::new(delay);
            compensation.step(3, 10.0, true);
            for cycle in 0..=delay {
                assert_eq!((compensation.taken, compensation.is_settled), (0, false), "{delay}");
                assert_eq!(compensation.advance_counts(), if cycle == delay { 3 } else { 0 }, "{delay}");
                compensation.step(3, 10.0, true);
            }
            assert_eq!((compensation.taken, compensation.ahead(), compensation.is_settled), (3, 0, true));
        }
    }

    #[test]
    fn one_increment_of_jitter_is_no_reversal() {
        let mut compensation = Compensator::new(0);
        let mut senses = |places: &[i64]| {
            let note = |place: &i64| {
                compensation.set_command_position(*place, true);
                compensation.sense
            };
            places.iter().map(note).collect::<Vec<_>>()
        };
        assert_eq!(senses(&[0, 1, 2, 1, 2, 1, 3]), [0, 0, 1, 1, 1, 1, 1]);
        assert_eq!(senses(&[2, 1, 2, 1, 2, 3]), [1, -1, -1, -1, -1, 1]);
        compensation.set_command_position(-50, false);
        assert_eq!((compensation.sense, compensation.furthest), (1, -50));
    }

    /// The gap is against the direction of the reference, and 0 before any motion.
    #[test]
    fn gap_is_opposite_to_the_reference_direction() {
        let gap = |reference, sense| Compensator { reference, sense, ..Compensator::new(0) }.gap(40);
        assert_eq!([gap(1, 1), gap(1, -1), gap(1, 0), gap(0, -1), gap(0, 1)], [0, -40, 0, -40, 0]);
        assert_eq!([gap(-1, -1), gap(-1, 1), gap(-1, 0)], [0, 40, 0]);
    }

    #[test]
    fn removed_compensation_moves_the_zero_and_commanded_one_stays() {
        let (mut compensation, _) = led(2, &[12; 4], 3.0);
        let ahead = compensation.ahead();
        assert_eq!((compensation.asked, compensation.taken), (12, 3));
        compensation.restart_at_zero();
        assert_eq!((compensation.taken, compensation.ahead()), (0, ahead));
        assert_eq!(
            (0..3)
                .map(|_| {
                    compensation.advance_counts();
                    compensation.step(0, 1e-9, true);
                    compensation.taken
                })
                .sum::<i64>(),
            3 + 6 + 9
        );
    }

    proptest! {
        /// The compensation never exceeds its rate, and reaches a constant target.
        #[test]
        fn it_never_changes_faster_than_its_rate(
            targets in prop::collection::vec(-5_000_i64..5_000, 1..40),
            most in 0.001..200.0_f64,
            delay in 0_u32..=32,
        ) {
            let targets: Vec<i64> = targets.iter().flat_map(|target| [*target; 20]).collect();
            let (compensation, asked) = led(delay, &targets, most);
            for from in (0..asked.len()).step_by(7) {
                for (cycles, to) in (1..).zip(&asked[from + 1..]).take(60) {
                    let way = (to - asked[from]).abs() as f64;
                    prop_assert!(way <= most * f64::from(cycles) + 1.0, "{} in {}", way, cycles);
                }
            }
            let mut last = compensation;
            let target = *targets.last().expect("one");
            for _ in 0..(10_000.0 / most) as usize + 40 {
                last.advance_counts();
                last.step(target, most, true);
                if last.is_settled {
                    break;
                }
            }
            prop_assert!(last.is_settled && last.taken == target);
        }
    }
}

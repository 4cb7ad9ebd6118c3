//! Taking up what is between motor and load.
//!
//! Law      what is asked for follows a target by a rate at most, in whole increments, and is found from it alone; what counts answer is what
//!          was asked for 1 + delay cycles ago. The gap is 0 in the sense in which the reference was found, and the backlash against
//!          it in the other one; a sense is another one once a place is [`REVERSAL`] behind the furthest of it
//! Reads    places of the command, targets (inc, in the sense of the encoder)
//! Writes   what is asked for, what is to be taken off the counts
//! Refuses  nothing
//! Source   WF-INC-04, docs/compensation.md

use serde::{Deserialize, Serialize};

/// Longest ring: as many cycles as a drive may take at most.
pub(crate) const PAST: usize = 33;

/// A reversal is one once the command is so far behind the furthest place of its sense (inc): a leader that is counted trembles by less.
const REVERSAL: i64 = 2;

/// Largest of the numbers that make c (inc): an error has 32 bits, a backlash 31.
const MOST: i64 = 1 << 33;

/// What the motor is beyond the load, in the sense of the encoder (inc).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct TakeUp {
    /// There is nothing to compensate, and nothing of it left.
    is_idle: bool,
    /// It is where it leads to, and so are the counts.
    is_settled: bool,
    /// What the drive is asked for beside the command.
    asked: i64,
    /// What the counts of this cycle answer.
    taken: i64,
    /// By how much that is more than in the cycle before.
    change: i64,
    /// The part of an increment that it may go beside the next whole ones.
    credit: f64,
    /// The sense of the last motion of the command: 1, -1, 0 before the first one.
    sense: i8,
    /// The sense in which the reference was found; 0: none was, and rising counts count as it.
    reference: i8,
    /// The furthest place of the command in its sense.
    furthest: i64,
    /// Length of the ring: one per cycle of the drive's delay and one more.
    length: usize,
    /// What was asked for in the last cycles, the oldest first.
    #[serde(with = "past")]
    past: [i64; PAST],
}

impl TakeUp {
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

    /// What the drive is asked for beside the command (inc).
    pub(crate) fn asked(&self) -> i64 {
        self.asked
    }

    /// Is there nothing to compensate?
    pub(crate) fn is_idle(&self) -> bool {
        self.is_idle
    }

    /// Does it change nothing while nothing moves?
    pub(crate) fn is_settled(&self) -> bool {
        self.is_settled
    }

    /// What the drive is asked for beside what its counts answer already.
    #[inline]
    pub(crate) fn ahead(&self) -> i64 {
        self.asked.saturating_sub(self.taken)
    }

    /// What of the change of counts in this cycle was none of the load.
    pub(crate) fn change(&self) -> i64 {
        self.change
    }

    /// Is its ring as long as another one's?
    pub(crate) fn has_ring_of(&self, other: &Self) -> bool {
        self.length == other.length
    }

    /// Could it have come about? One that was read from outside may hold anything.
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

    /// The counts of the next cycle are here; by how much less than they the load has moved.
    pub(crate) fn answer(&mut self) -> i64 {
        let answered = self.past.first().copied().unwrap_or_default();
        self.change = answered.saturating_sub(std::mem::replace(&mut self.taken, answered));
        self.change
    }

    /// Notes the place of the command; one that is not the axis' own has no sense.
    pub(crate) fn note_place(&mut self, place: i64, is_own: bool) {
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

    /// What is between motor and load in the present sense, with that backlash.
    pub(crate) fn gap(&self, backlash: i64) -> i64 {
        let reference = if self.reference < 0 { -1 } else { 1 };
        if self.sense == -reference { backlash.saturating_mul(-i64::from(reference)) } else { 0 }
    }

    /// One cycle towards `target` (inc), by `most` at most (inc, above 0).
    pub(crate) fn step(&mut self, target: i64, most: f64, is_wanted: bool) {
        let way = target.saturating_sub(self.asked);
        if way == 0 {
            self.credit = 0.0;
        } else {
            let may = self.credit + most;
            let whole = may.floor();
            // The cast saturates: beyond 2^63 there is no way.
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

    /// What is taken off the counts of this cycle is none from now on: the coordinate has it.
    fn begin_anew(&mut self) {
        let taken = std::mem::take(&mut self.taken);
        self.asked = self.asked.saturating_sub(taken);
        self.past.iter_mut().for_each(|kept| *kept = kept.saturating_sub(taken));
    }

    /// Nobody has looked at the motion so far: it begins at that place.
    pub(crate) fn begin_at(&mut self, place: i64) {
        (self.sense, self.furthest) = (0, place);
    }

    /// A zero is found with that sense, or, where there was none, with that of the last motion; with it nothing is between motor and load.
    /// `is_own`: the last motion was one of the command.
    pub(crate) fn begin_from_zero(&mut self, way: i8, is_own: bool) {
        self.begin_anew();
        self.reference = if way == 0 { self.sense } else { way };
        if !is_own {
            self.sense = self.reference;
        }
    }

    /// Other counts are read from now on, which nothing was taken off.
    pub(crate) fn forget_counts(&mut self) {
        let Self { sense, reference, furthest, length, .. } = *self;
        *self = Self { is_idle: false, is_settled: false, sense, reference, furthest, length, ..Self::new(0) };
    }

    /// Every place is `by` (inc) more from now on.
    pub(crate) fn shift(&mut self, by: i64) {
        self.furthest = self.furthest.wrapping_add(by);
    }
}

/// A ring of any length as a list: the derived form ends at 32.
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

    fn led(delay: u32, targets: &[i64], most: f64) -> (TakeUp, Vec<i64>) {
        let mut compensation = TakeUp::new(delay);
        let mut asked = Vec::new();
        for target in targets {
            compensation.answer();
            compensation.step(*target, most, true);
            assert!(compensation.is_sound());
            asked.push(compensation.asked);
        }
        (compensation, asked)
    }

    /// 0.4 of an increment a cycle are two in five; 2.5 are five in two.
    #[test]
    fn it_goes_by_its_rate_in_whole_increments() {
        assert_eq!(led(0, &[2; 8], 0.4).1, [0, 0, 1, 1, 2, 2, 2, 2]);
        assert_eq!(led(0, &[-7; 5], 2.5).1, [-2, -5, -7, -7, -7]);
        assert_eq!(led(0, &[9, 9, 0, 0], 1e300).1, [9, 9, 0, 0]);
    }

    #[test]
    fn the_counts_answer_one_cycle_and_the_delay_later() {
        for delay in [0, 1, 5, 32] {
            let mut compensation = TakeUp::new(delay);
            compensation.step(3, 10.0, true);
            for cycle in 0..=delay {
                assert_eq!((compensation.taken, compensation.is_settled), (0, false), "{delay}");
                assert_eq!(compensation.answer(), if cycle == delay { 3 } else { 0 }, "{delay}");
                compensation.step(3, 10.0, true);
            }
            assert_eq!((compensation.taken, compensation.ahead(), compensation.is_settled), (3, 0, true));
        }
    }

    #[test]
    fn a_command_that_trembles_by_an_increment_reverses_nothing() {
        let mut compensation = TakeUp::new(0);
        let mut senses = |places: &[i64]| {
            let note = |place: &i64| {
                compensation.note_place(*place, true);
                compensation.sense
            };
            places.iter().map(note).collect::<Vec<_>>()
        };
        assert_eq!(senses(&[0, 1, 2, 1, 2, 1, 3]), [0, 0, 1, 1, 1, 1, 1]);
        assert_eq!(senses(&[2, 1, 2, 1, 2, 3]), [1, -1, -1, -1, -1, 1]);
        compensation.note_place(-50, false);
        assert_eq!((compensation.sense, compensation.furthest), (1, -50));
    }

    /// The gap is against the sense of the reference, and none before anything has moved.
    #[test]
    fn the_gap_lies_in_the_other_sense_than_the_reference() {
        let gap = |reference, sense| TakeUp { reference, sense, ..TakeUp::new(0) }.gap(40);
        assert_eq!([gap(1, 1), gap(1, -1), gap(1, 0), gap(0, -1), gap(0, 1)], [0, -40, 0, -40, 0]);
        assert_eq!([gap(-1, -1), gap(-1, 1), gap(-1, 0)], [0, 40, 0]);
    }

    #[test]
    fn what_is_taken_off_goes_into_a_new_zero_and_what_is_asked_for_stays_ahead() {
        let (mut compensation, _) = led(2, &[12; 4], 3.0);
        let ahead = compensation.ahead();
        assert_eq!((compensation.asked, compensation.taken), (12, 3));
        compensation.begin_anew();
        assert_eq!((compensation.taken, compensation.ahead()), (0, ahead));
        assert_eq!(
            (0..3)
                .map(|_| {
                    compensation.answer();
                    compensation.step(0, 1e-9, true);
                    compensation.taken
                })
                .sum::<i64>(),
            3 + 6 + 9
        );
    }

    proptest! {
        /// What is asked for never goes by more than its rate, and comes to a target that stays.
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
                last.answer();
                last.step(target, most, true);
                if last.is_settled {
                    break;
                }
            }
            prop_assert!(last.is_settled && last.taken == target);
        }
    }
}

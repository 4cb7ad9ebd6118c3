//! Unwrapping, replacement and supervision with any motion.

use super::*;
use proptest::prelude::*;

fn word(count: i64) -> EncoderInput {
    EncoderInput { count, valid: true, ..EncoderInput::default() }
}

#[test]
fn a_16_bit_source_wraps_without_a_trace_in_both_directions() {
    let mut counter = Counter::new(16);
    for count in [65_530, 65_535, 4, 9, 65_533, 65_528] {
        counter.take(count, 0);
    }
    assert_eq!(counter.position(), 65_530 + 5 + 5 + 5 - 12 - 5);
}

#[test]
fn a_32_bit_source_wraps_without_a_trace() {
    let mut counter = Counter::new(32);
    let start = i64::from(i32::MAX) - 2;
    counter.take(start, 0);
    counter.take(i64::from(i32::MIN) + 2, 0);
    assert_eq!(counter.position(), start + 5);
    counter.take(i64::from(i32::MAX), 0);
    assert_eq!(counter.position(), start + 2);
}

#[test]
fn a_new_epoch_is_no_motion() {
    let mut counter = Counter::new(64);
    counter.take(1000, 1);
    assert_eq!(counter.take(0, 2), 0);
    assert_eq!(counter.take(3, 2), 3);
    assert_eq!(counter.position(), 1003);
}

#[test]
fn an_invalid_value_is_left_out_and_what_moved_meanwhile_is_caught_up() {
    let mut encoder = Encoder::new(Form::Incremental(64), None);
    assert_eq!(encoder.step(&word(10), 0.001), None);
    assert_eq!(encoder.step(&EncoderInput { valid: false, ..word(999_999) }, 0.001), Some(EncoderReport::Invalid));
    assert_eq!((encoder.lead().change, encoder.lead().valid), (Position::ZERO, false));
    assert_eq!(encoder.step(&EncoderInput { valid: false, ..word(999_999) }, 0.001), None, "told once");
    encoder.step(&word(13), 0.001);
    assert_eq!(encoder.lead().position, Position::whole(13));
}

proptest! {
    #[test]
    fn any_walk_of_any_width_is_followed(
        bits in 3_u32..=64, start in any::<i64>(), steps in prop::collection::vec(-3_i64..=3, 1..300),
    ) {
        let mask = if bits == 64 { u64::MAX } else { (1 << bits) - 1 };
        let mut counter = Counter::new(bits);
        let mut real = start;
        counter.take((real as u64 & mask) as i64, 0);
        let first = counter.position();
        for step in steps {
            real = real.wrapping_add(step);
            prop_assert_eq!(counter.take((real as u64 & mask) as i64, 0), step);
        }
        prop_assert_eq!(counter.position().wrapping_sub(first), real.wrapping_sub(start));
    }
}

const TYPE_3: Absolute =
    Absolute { steps: 1000, turns: 100, corrects: true, overflow: false, ..Absolute::single_turn(1000) };

/// Returns the result for each value: change, valid, substituted.
fn scan(reader: &mut Reader, words: &[i64]) -> Vec<(i64, bool, bool)> {
    let take = |word: &i64| reader.take(*word, 0, true);
    words.iter().map(take).map(|reading| (reading.change, reading.valid, reading.substituted)).collect()
}

/// Values 1:1, over the wrap by the shortest distance; half a turn, equal in both directions, goes forward.
///
/// Proves: MACS-ENC-01, MACS-ENC-07
#[test]
fn absolute_encoder_with_overflow_continues_across_its_wrap() {
    let mut reader = Reader::new(Form::Absolute(Absolute::single_turn(1000)));
    let seen = scan(&mut reader, &[998, 1, 995, 495, 996]);
    let expected = [(0, true), (3, true), (-6, true), (500, true), (-499, true)];
    assert_eq!(seen.iter().map(|(change, valid, _)| (*change, *valid)).collect::<Vec<_>>(), expected);
    assert_eq!(reader.position(), 998 + 3 - 6 + 500 - 499);
}

/// A jump of more than half a resolution is a read error: the position continues with the last velocity.
///
/// Proves: MACS-ENC-08
#[test]
fn a_bad_word_is_replaced_by_one_of_the_last_velocity() {
    let mut reader = Reader::new(Form::Absolute(TYPE_3));
    let seen = scan(&mut reader, &[5000, 5010, 5020, 5521, 5040, 5050, 4000, 99_999, 5080]);
    let moved = (10, true, false);
    let guessed = (10, true, true);
    assert_eq!(seen, [(0, true, false), moved, moved, guessed, moved, moved, guessed, guessed, moved]);
    assert_eq!((reader.errors(), reader.position()), (3, 5080));
    // Exactly half a resolution is accepted.
    assert_eq!(scan(&mut reader, &[5580]), [(500, true, false)]);
}

/// The hundred-and-first successive bad value is used as it is: the position jumps, which its axis detects.
///
/// Proves: MACS-ENC-08
#[test]
fn after_a_hundred_bad_words_none_is_replaced() {
    let mut reader = Reader::new(Form::Absolute(TYPE_3));
    scan(&mut reader, &[5000, 5003]);
    let seen = scan(&mut reader, &[90_000; 101]);
    assert!(seen[..100].iter().all(|reading| *reading == (3, true, true)));
    assert_eq!(seen[100], (90_000 - 5303, true, false));
    assert_eq!((reader.errors(), reader.position()), (101, 90_000));
    // The true values come back: the position is correct at once.
    let back = scan(&mut reader, &[5_306, 5_309, 5_312, 90_001, 5_318]);
    let moved = (3, true, false);
    assert_eq!(
        back,
        [(5_306 - 90_000, true, false), moved, moved, (3, true, true), moved],
        "bad ones are replaced again"
    );
    // Without any value there is nothing to use.
    for _ in 0..100 {
        assert!(reader.take(0, 0, false).substituted);
    }
    assert_eq!(reader.take(0, 0, false), Reading::default());
    assert_eq!(reader.errors(), 101 + 2 + 101);
}

/// Without correction an invalid word is no value at once; too large a step is accepted when it is confirmed.
///
/// Proves: WF-ABS-04
#[test]
fn bad_word_without_correction_is_invalid() {
    let mut reader = Reader::new(Form::Absolute(Absolute { max_step: Some(20), ..Absolute::single_turn(1024) }));
    let seen = scan(&mut reader, &[100, 120, 141, 120, 2000, 130, 600, 605, 606]);
    let none = (0, false, false);
    let of = |change| (change, true, false);
    assert_eq!(seen, [of(0), of(20), none, of(0), none, of(10), none, of(475), of(1)]);
    assert_eq!((reader.errors(), reader.position()), (3, 606));
}

#[test]
fn a_new_epoch_of_an_absolute_encoder_is_no_motion_and_no_error() {
    let mut reader = Reader::new(Form::Absolute(TYPE_3));
    scan(&mut reader, &[5000, 5003]);
    let reading = reader.take(90_000, 1, true);
    assert_eq!((reading.change, reading.restarted, reader.position(), reader.errors()), (0, true, 5003, 0));
    assert_eq!(reader.take(90_001, 1, true).change, 1);
}

/// Returns the results for marks with one turn of 100.
fn pulses(ways: &[(i64, Option<i64>)]) -> Vec<Option<i64>> {
    let mut pulses = Pulses::default();
    let check = PulseCheck { every: 100, tolerance: 5 };
    let mut before = 0;
    let step = |&(position, mark): &(i64, Option<i64>)| {
        let change = position - std::mem::replace(&mut before, position);
        pulses.step(&check, position, change, mark)
    };
    ways.iter().map(step).collect()
}

/// Proves: WF-MON-02, WF-MON-07
#[test]
fn a_turn_is_as_long_as_it_should_be_or_deviations_add_up() {
    // Two pulses too many in each turn: in the third turn the sum is too large.
    let slow = [(50, None), (105, Some(102)), (204, Some(204)), (306, Some(306)), (408, Some(408))];
    assert_eq!(pulses(&slow), [None, None, None, None, Some(6)]);
    // Missing and surplus pulses cancel out.
    let both = [(103, Some(103)), (200, Some(200)), (303, Some(303)), (400, Some(400)), (504, Some(504))];
    assert!(pulses(&both).iter().all(Option::is_none));
    // Reversed: the same mark at the same position, or at a wrong one.
    let back = |second| [(120, Some(100)), (150, None), (90, Some(second)), (50, None), (-1, Some(0))];
    assert!(pulses(&back(100)).iter().all(Option::is_none));
    assert_eq!(pulses(&back(93)), [None, None, Some(-7), None, None]);
}

/// Proves: WF-MON-02
#[test]
fn a_mark_that_stays_away_is_missed_as_soon_as_it_is_overdue() {
    assert_eq!(pulses(&[(100, Some(100)), (205, None), (206, None)]), [None, None, Some(6)]);
    assert_eq!(pulses(&[(-1, None), (-100, Some(-100)), (-205, None), (-206, None)]), [None, None, None, Some(-6)]);
    // After a reversal on the mark itself it does not come again, and the one before it is due.
    assert_eq!(pulses(&[(100, Some(100)), (99, None), (0, Some(0))]), [None; 3]);
    assert_eq!(pulses(&[(100, Some(100)), (99, None), (-5, None), (-6, None)]), [None, None, None, Some(-6)]);
}

/// At rest on its mark, back by less than a turn and forward again: the same mark, without deviation. A missing count
/// in between is a deviation.
///
/// Proves: WF-MON-02
#[test]
fn a_rest_on_the_mark_is_no_turn() {
    let fine = |ways: &[(i64, Option<i64>)]| {
        let told = pulses(ways);
        assert!(told.iter().all(Option::is_none), "{ways:?}: {told:?}");
    };
    fine(&[(100, Some(100)), (40, None), (100, Some(100)), (150, None), (200, Some(200))]);
    fine(&[(100, Some(100)), (99, None), (100, Some(100)), (99, None), (100, Some(100)), (101, None), (99, Some(100))]);
    // The same from above, where the mark was reached in backward motion.
    fine(&[(150, None), (100, Some(100)), (160, None), (100, Some(100)), (101, None), (100, Some(100)), (0, Some(0))]);
    // Through it from one side, to rest on it from the other.
    fine(&[(130, Some(100)), (100, Some(100)), (120, None), (90, Some(100)), (100, Some(100)), (200, Some(200))]);
    // From it to the next mark on either side, whose pulse comes first.
    fine(&[(100, Some(100)), (60, None), (0, Some(0)), (50, None), (100, Some(100)), (200, Some(200))]);
    // The pulse in the very cycle of the reversal, which ends before the mark, after it, and at the start.
    fine(&[
        (95, None),
        (97, Some(100)),
        (105, Some(100)),
        (200, Some(200)),
        (199, None),
        (201, Some(200)),
        (300, Some(300)),
    ]);
    fine(&[(101, Some(100)), (101, Some(100)), (200, Some(200)), (201, Some(200)), (100, Some(100)), (0, Some(0))]);
    // Many counts are missing in the second motion.
    assert_eq!(pulses(&[(100, Some(100)), (40, None), (93, Some(93))])[2], Some(-7));
    assert_eq!(pulses(&[(100, Some(100)), (40, None), (96, Some(96)), (200, None), (202, Some(202))]), [None; 5]);
    // Its counts are missing while the index continues.
    assert_eq!(pulses(&[(100, Some(100)), (100, Some(100))])[1], Some(-100));
    assert_eq!(pulses(&[(-100, Some(-100)), (-100, None), (-100, Some(-100))])[2], Some(100));
}

/// An encoder with an index at multiples of `every`, which is reported in the cycle in which it is reached, from either
/// side; of several in a cycle the last one.
struct Plant {
    every: i64,
    place: i64,
    missing: i64,
}

impl Plant {
    /// Moves by these distances within one cycle and returns the inputs of the supervision.
    fn cycle(&mut self, ways: &[i64]) -> (i64, i64, Option<i64>) {
        let before = self.place;
        let mut mark = None;
        for way in ways {
            let (from, to) = (self.place, self.place + way);
            let reached =
                if to > from { to.div_euclid(self.every) } else { -(-to).div_euclid(self.every) } * self.every;
            let is_reached = if to > from { reached > from } else { to != from && reached < from };
            mark = if is_reached { Some(reached - self.missing) } else { mark };
            self.place = to;
        }
        (self.place - self.missing, self.place - before, mark)
    }
}

/// Motions of a cycle: small ones around the marks, any, several turns, and reversals within the cycle.
fn ways() -> impl Strategy<Value = Vec<Vec<i64>>> {
    let half = prop::sample::select(&[50_i64, -50, 100, -100][..]);
    let way = prop_oneof![4 => -2_i64..=2, 2 => -60_i64..=60, 1 => -400_i64..=400, 4 => half];
    prop::collection::vec(prop::collection::vec(way, 1..4), 1..200)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// With exact pulses no motion is reported, and no deviation adds up.
    ///
    /// Proves: WF-MON-02
    #[test]
    fn exact_pulses_raise_no_error(start in -150_i64..150, ways in ways()) {
        let check = PulseCheck { every: 100, tolerance: 0 };
        let mut plant = Plant { every: 100, place: start, missing: 0 };
        let mut pulses = Pulses::default();
        for way in ways {
            let (position, change, mark) = plant.cycle(&way);
            // A mark that is left and reached again between two readings looks like an encoder without counts.
            if change == 0 && mark == Some(position) {
                plant.cycle(&[1]);
                pulses.step(&check, position + 1, 1, None);
                continue;
            }
            prop_assert_eq!(pulses.step(&check, position, change, mark), None, "{:?}", way);
            prop_assert_eq!(pulses.deviation(), 0);
        }
    }

    /// One missing count is reported at the next mark, or when that is overdue, wherever it was lost and however the
    /// encoder moved.
    ///
    /// Proves: WF-MON-02
    #[test]
    fn one_missing_pulse_is_reported(
        start in -150_i64..150, ways in ways(), lost in any::<bool>(), forward in any::<bool>(),
    ) {
        let check = PulseCheck { every: 100, tolerance: 0 };
        let mut plant = Plant { every: 100, place: start, missing: 0 };
        let mut pulses = Pulses::default();
        // A mark is known from here on.
        let (position, change, mark) = plant.cycle(&[200]);
        prop_assert_eq!(pulses.step(&check, position, change, mark), None);
        for way in ways {
            let (position, change, mark) = plant.cycle(&way);
            if change == 0 && mark == Some(position) {
                plant.cycle(&[1]);
                pulses.step(&check, position + 1, 1, None);
                continue;
            }
            prop_assert_eq!(pulses.step(&check, position, change, mark), None);
        }
        plant.missing = if lost { 1 } else { -1 };
        let step = if forward { 7 } else { -7 };
        let mut before = plant.place;
        let told = (0..40).find_map(|_| {
            let (position, _, mark) = plant.cycle(&[step]);
            let change = position - std::mem::replace(&mut before, position);
            pulses.step(&check, position, change, mark)
        });
        prop_assert_eq!(told.map(i64::abs), Some(1), "{:?}", told);
    }
}

#[test]
fn several_turns_in_a_cycle_report_only_the_last_mark() {
    assert_eq!(pulses(&[(100, Some(100)), (430, Some(400)), (760, Some(700)), (1090, Some(1007))])[3], Some(7));
}

/// Any speed below half of the range per cycle, for the operating time of a machine.
fn long_way(encoder: Absolute, steps: &[i64]) -> Result<(), TestCaseError> {
    let mut reader = Reader::new(Form::Absolute(encoder));
    let mut real = 0_i64;
    reader.take(encoder.encode(real), 0, true);
    for step in steps {
        real += step;
        let reading = reader.take(encoder.encode(real), 0, true);
        prop_assert_eq!((reading.change, reading.valid), (*step, true));
    }
    prop_assert_eq!(reader.position(), real);
    prop_assert_eq!(reader.errors(), 0);
    Ok(())
}

proptest! {
    #[test]
    fn any_absolute_encoder_is_followed_across_its_wrap(
        steps in 8_u32..1 << 20, turns in 1_u32..1 << 12, gray in any::<bool>(), shares in prop::collection::vec(-1000_i64..=1000, 1..300),
    ) {
        let code = if gray { WordCode::Gray } else { WordCode::Binary };
        let encoder = Absolute { turns, code, ..Absolute::single_turn(steps) };
        let most = encoder.words() / 2 - 1;
        let ways: Vec<i64> = shares.iter().map(|share| most / 1000 * share + share % 2).collect();
        let ways: Vec<i64> = ways.into_iter().map(|way| way.clamp(-most, most)).collect();
        long_way(encoder, &ways)?;
    }

    /// From any start, beyond 10^12 counts, which take years: no count is lost.
    #[test]
    fn years_of_turning_leave_no_trace(
        bits in 8_u32..=40, start in -(1_i64 << 61)..1 << 61, turns in 1_i64..1000, way in 1_i64..100,
    ) {
        let circle = 1_i64 << bits;
        let way = way.min(circle / 2 - 1);
        let mut counter = Counter::new(bits);
        counter.take(start.rem_euclid(circle), 0);
        let first = counter.position();
        // Jumps of whole ranges cannot be detected: only the value of the source counts.
        let mut real = start;
        let mut counted = 0_i64;
        for turn in 0..turns {
            real += way;
            counted += counter.take(real.rem_euclid(circle), 0);
            prop_assert_eq!(counted, way * (turn + 1));
        }
        prop_assert_eq!(counter.position() - first, real - start);
    }

    /// With any values a reader neither panics nor shows a step of more than half a turn while it corrects.
    #[test]
    fn anything_may_be_read(
        words in prop::collection::vec((any::<i64>(), any::<bool>(), 0_u32..3), 1..400), corrects in any::<bool>(),
    ) {
        let mut reader = Reader::new(Form::Absolute(Absolute { corrects, overflow: !corrects, ..TYPE_3 }));
        for (word, valid, epoch) in words {
            let word = if word % 3 == 0 { word } else { word.rem_euclid(100_000) };
            let bad_before = reader.bad_in_a_row();
            let reading = reader.take(word, epoch, valid);
            prop_assert!(reading.valid || reading.change == 0);
            if corrects && bad_before < 100 {
                prop_assert!(reading.change.abs() <= 500 || reading.restarted);
            }
            prop_assert!(reader.is_sound());
        }
    }
}

/// 10^12 counts of a 16-bit source, in cycles of the fastest motion: 31 million cycles, nearly nine hours of 1 ms.
#[test]
fn a_million_million_counts_are_counted_exactly() {
    let mut counter = Counter::new(16);
    let way = 32_767_i64;
    let cycles: i64 = if std::env::var_os("LINESHAFT_LONG").is_some() { 31_000_000 } else { 1_000_000 };
    let mut real = 0_i64;
    counter.take(0, 0);
    for _ in 0..cycles {
        real += way;
        assert_eq!(counter.take(real & 0xFFFF, 0), way);
    }
    assert_eq!(counter.position(), way * cycles);
}

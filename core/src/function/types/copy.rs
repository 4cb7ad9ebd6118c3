//! Copies of a source into a sink: DCOPY, and ECOPY with selection by a bit.
//!
//! Law      DCOPY mode 0: sink = source. Mode 1: acc = acc + i16(low(source(k)) - low(source(k-1))), sink = acc, which
//!          wraps at 32 bits and starts at the value of the sink. ECOPY: E1 selects one of two values; each is the
//!          source or a given value, as `mode` says; A1 = E1
//! Reads    the value of the source; ECOPY E1
//! Writes   the sink: a position, or a speed (0.0001 rpm) if the cell says so; ECOPY A1
//! Refuses  only values outside the ranges of the fields
//! Source   AMK-DCOPY-01 to -05 with A-15, AMK-ECOPY-01 to -05 with, AMK-GEN-16 to -18 with A-11

use crate::function::guest::*;
use serde::{Deserialize, Serialize};

/// Parameter set of DCOPY.
pub(super) const DCOPY_FIELDS: &[Field] =
    &[Field::new("mode", 0, 1, "", "0 copies the value, 1 adds up the changes of its low 16 bits", "AMK-DCOPY-01")];

/// Parameter set of ECOPY.
pub(super) const ECOPY_FIELDS: &[Field] = &[
    Field::new("mode", 0, 3, "", "bit 0 (E1 = 0), bit 1 (E1 = 1): 0 copies the source, 1 the value", "AMK-ECOPY-03"),
    value_field("value_e1_0", "value while E1 = 0", 1),
    value_field("value_e1_1", "value while E1 = 1", 2),
];

const fn value_field(name: &'static str, help: &'static str, bit: i64) -> Field {
    Field::new(name, i32::MIN as i64, i32::MAX as i64, "", help, "AMK-ECOPY-02")
        .live()
        .within(CellBound::FullScale(bit))
}

const MODE: usize = place(ECOPY_FIELDS, "mode");
/// Mode that does not read the source.
const BOTH_VALUES: i64 = 3;
const VALUE_E1_0: usize = place(ECOPY_FIELDS, "value_e1_0");
const VALUE_E1_1: usize = place(ECOPY_FIELDS, "value_e1_1");

/// Mode of DCOPY.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum CopyMode {
    Absolute,
    Incremental { acc: i32, last: i16 },
}

/// A copy without a condition.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::function) struct Dcopy {
    way: CopyMode,
}

impl SlotType for Dcopy {
    const DESCRIPTION: Description = Description {
        source: Requirement::Must,
        sink: Requirement::Must,
        chooses_quantity: true,
        moves_axes: true,
        amk: AmkLimits { writes_analog: true, ..AmkLimits::USUAL },
        ..Description::of(Kind::Dcopy, "dcopy", "copies its source into its sink", DCOPY_FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self { way: CopyMode::Absolute }
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        self.way = match words.get(place(DCOPY_FIELDS, "mode")) {
            0 => CopyMode::Absolute,
            // The casts keep the low words of sink and source, as the mode requires.
            _ => CopyMode::Incremental { acc: seen.sink as i32, last: seen.source.value as i16 },
        };
        self.step(seen)
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let sink = match &mut self.way {
            CopyMode::Absolute => seen.source.value,
            CopyMode::Incremental { acc, last } => {
                let now = seen.source.value as i16;
                *acc = acc.wrapping_add(now.wrapping_sub(std::mem::replace(last, now)).into());
                (*acc).into()
            }
        };
        Outcome { sink, ..Outcome::default() }
    }

    fn copies_source(_: Words<'_>) -> bool {
        true
    }

    fn copies_values(words: Words<'_>, is_signal: bool) -> bool {
        words.get(place(DCOPY_FIELDS, "mode")) == 0 && is_signal
    }
}

/// A copy of one of two values.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::function) struct Ecopy {
    /// Values for the sink while E1 is 0 and while it is 1; `None`: the source.
    chosen: [Option<i64>; 2],
}

impl SlotType for Ecopy {
    const DESCRIPTION: Description = Description {
        source: Requirement::May,
        sink: Requirement::Must,
        chooses_quantity: true,
        moves_axes: true,
        inputs: 1,
        outputs: 1,
        amk: AmkLimits { writes_analog: true, ..AmkLimits::USUAL },
        ..Description::of(Kind::Ecopy, "ecopy", "copies its source or one of two values, as E1 says", ECOPY_FIELDS)
    };

    fn new(_: &SlotSetup<'_>) -> Self {
        Self::default()
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        let mode = words.get(MODE);
        self.chosen = [mode & 1 != 0, mode & 2 != 0].map(|is_value| is_value.then_some(0));
        self.apply_values(words);
        self.step(seen)
    }

    fn apply_values(&mut self, words: Words<'_>) {
        // The mode stays as started: a value that copies the source continues to do so.
        let values = [words.get(VALUE_E1_0), words.get(VALUE_E1_1)];
        for (chosen, value) in self.chosen.iter_mut().zip(values) {
            *chosen = chosen.and(Some(value));
        }
    }

    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let e1 = seen.inputs & 1;
        let [while_0, while_1] = self.chosen;
        let chosen = if e1 == 0 { while_0 } else { while_1 };
        Outcome { sink: chosen.unwrap_or(seen.source.value), outputs: e1, writes: 1, ..Outcome::default() }
    }

    fn copies_source(words: Words<'_>) -> bool {
        words.get(MODE) != BOTH_VALUES
    }

    fn copies_values(words: Words<'_>, is_signal: bool) -> bool {
        words.get(MODE) != 0 || is_signal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::function::program::SourceValue;
    use crate::function::trial::{at_rest, set};
    use proptest::prelude::*;

    fn source<'a>(value: i64) -> CallInputs<'a> {
        CallInputs { source: SourceValue { value, ..SourceValue::default() }, ..at_rest() }
    }

    /// Starts with the first value of the source, and steps with the others.
    fn copied(mode: i64, sink: i64, values: &[i64]) -> Vec<i64> {
        let (words, mut dcopy) = (set(DCOPY_FIELDS, &[("mode", mode)]), Dcopy::new(&SlotSetup::default()));
        let mut sinks = Vec::new();
        for (k, value) in values.iter().enumerate() {
            let seen = CallInputs { sink: *sinks.last().unwrap_or(&sink), ..source(*value) };
            let outcome = if k == 0 { dcopy.start(Words(&words), &seen) } else { dcopy.step(&seen) };
            assert_eq!((outcome.outputs, outcome.writes), (0, 0));
            sinks.push(outcome.sink);
        }
        sinks
    }

    /// Proves: AMK-DCOPY-O1, AMK-DCOPY-03, AMK-DCOPY-04
    #[test]
    fn an_incremental_copy_begins_at_the_sink_and_adds_16_bit_changes() {
        assert_eq!(copied(1, 100_000, &[65_530, 2, 10, 65_535]), [100_000, 100_008, 100_016, 100_005]);
        // The high word of the source is ignored.
        assert_eq!(copied(1, 0, &[0x7_0000, 0x1_0003, -1]), [0, 3, -1]);
    }

    /// Proves: AMK-DCOPY-05
    #[test]
    fn an_incremental_copy_wraps_at_32_bits() {
        assert_eq!(copied(1, 2_147_483_640, &[0, 10, 0]), [2_147_483_640, -2_147_483_646, 2_147_483_640]);
        // The largest 16-bit change wraps to a negative one.
        assert_eq!(copied(1, 0, &[0, 32_767, 65_535]), [0, 32_767, -1]);
        assert_eq!(copied(1, 0, &[0, 32_768]), [0, -32_768]);
    }

    /// Proves: AMK-DCOPY-O3, AMK-DCOPY-02
    #[test]
    fn an_absolute_copy_is_the_source_in_the_same_call() {
        assert_eq!(copied(0, 55, &[-7, i32::MAX.into(), 1 << 40]), [-7, 2_147_483_647, 1 << 40]);
    }

    /// Proves: AMK-ECOPY-O1, AMK-ECOPY-01
    #[test]
    fn a_bit_chooses_between_two_values() {
        let words = set(ECOPY_FIELDS, &[("mode", 3), ("value_e1_0", 10_000), ("value_e1_1", 5_000)]);
        let mut ecopy = Ecopy::new(&SlotSetup::default());
        assert_eq!(ecopy.start(Words(&words), &source(77)), Outcome { sink: 10_000, writes: 1, ..Outcome::default() });
        // E2 to E8 are ignored.
        let high = ecopy.step(&CallInputs { inputs: 0xFF, ..source(77) });
        assert_eq!(high, Outcome { sink: 5_000, outputs: 1, writes: 1, ..Outcome::default() });
        assert_eq!(ecopy.step(&CallInputs { inputs: 0xFE, ..source(77) }).sink, 10_000);
    }

    /// Proves: AMK-ECOPY-03
    #[test]
    fn each_bit_of_the_mode_chooses_for_its_own_level() {
        let sinks = |mode| {
            let words = set(ECOPY_FIELDS, &[("mode", mode), ("value_e1_0", -1), ("value_e1_1", -2)]);
            let mut ecopy = Ecopy::new(&SlotSetup::default());
            let low = ecopy.start(Words(&words), &source(77)).sink;
            [low, ecopy.step(&CallInputs { inputs: 1, ..source(77) }).sink]
        };
        assert_eq!([0, 1, 2, 3].map(sinks), [[77, 77], [-1, 77], [77, -2], [-1, -2]]);
    }

    /// Proves: AMK-ECOPY-05
    #[test]
    fn new_values_count_from_the_next_call_and_the_mode_stays_as_started() {
        let first = set(ECOPY_FIELDS, &[("mode", 1), ("value_e1_0", 1), ("value_e1_1", 2)]);
        let second = set(ECOPY_FIELDS, &[("mode", 2), ("value_e1_0", 3), ("value_e1_1", 4)]);
        let mut ecopy = Ecopy::new(&SlotSetup::default());
        assert_eq!(ecopy.start(Words(&first), &source(77)).sink, 1);
        ecopy.apply_values(Words(&second));
        assert_eq!(ecopy.step(&source(77)).sink, 3);
        assert_eq!(ecopy.step(&CallInputs { inputs: 1, ..source(77) }).sink, 77);
    }

    proptest! {
        /// Proves: AMK-DCOPY-03, AMK-DCOPY-05
        #[test]
        fn small_changes_add_up_to_the_whole_way(
            sink in any::<i32>(),
            begin in any::<i32>(),
            changes in proptest::collection::vec(-32_768_i64..=32_767, 0..60),
        ) {
            let mut values = vec![i64::from(begin)];
            for change in &changes {
                values.push(values[values.len() - 1] + change);
            }
            let ended = copied(1, sink.into(), &values).pop().expect("there is a first call");
            let exact = i128::from(sink) + i128::from(values[values.len() - 1]) - i128::from(begin);
            prop_assert_eq!(i128::from(ended), (exact + (1 << 31)).rem_euclid(1 << 32) - (1 << 31));
        }
    }
}

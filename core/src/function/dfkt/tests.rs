//! Test oracles of DFKT, its inputs and errors, and a comparison with the formulas of the spec in fractions.

use super::super::program::SourceValue;
use super::super::trial::{at_rest, set, setting};
use super::*;
use crate::event::Number;
use crate::function::program::Tables;
use crate::table::{Form, Table};
use crate::unit::Fraction;
use proptest::prelude::*;
use std::sync::Arc;

/// Points of the example of the manual (rpm).
const T: [i64; 9] = [0, 500, 1000, 1500, 2000, 2500, 3000, 3500, 4000];
/// Two milliseconds (ns), as w = 4.
const CALL: u64 = 2_000_000;

const E1: u8 = 1;
const E2: u8 = 2;
const E3: u8 = 4;
const E4: u8 = 8;
const E5: u8 = 16;

fn y(points: &[i64]) -> Arc<Table> {
    Arc::new(Table::new(Form::Y, &[], points).expect("points"))
}

/// The same points as a data block; the high words are ignored.
fn words(points: &[i64]) -> Arc<Table> {
    let mut words = vec![points.len() as i64 + 1, 77];
    words.extend(points.iter().flat_map(|point| [*point, 1234]));
    Arc::new(Table::new(Form::Words, &[], &words).expect("words"))
}

/// A function with its tables.
#[derive(Clone)]
struct Bench {
    dfkt: Dfkt,
    tables: Vec<Arc<Table>>,
    places: [Option<u16>; LINES],
    call_ns: u64,
    values: Vec<(&'static str, i64)>,
    travel: i64,
}

impl Bench {
    /// Creates a function with these tables as Tab0 and up, and these values in its set.
    fn new(tables: &[Arc<Table>], values: &[(&'static str, i64)]) -> Self {
        let places = std::array::from_fn(|place| (place < tables.len()).then_some(place as u16));
        Self { dfkt: Dfkt::new(), tables: tables.into(), places, call_ns: CALL, values: values.into(), travel: 0 }
    }

    fn found(&self) -> [Option<&Table>; LINES] {
        self.places.map(|place| self.tables.get(usize::from(place?)).map(|table| &**table))
    }

    /// Returns the result of START, or of VALUE_NEW while it runs, for the set with these values changed.
    fn asked(&mut self, more: &[(&'static str, i64)], runs: bool, occasion: Occasion) -> Result<Vec<i64>, Fault> {
        for (name, value) in more {
            self.values.retain(|(known, _)| known != name);
            self.values.push((name, *value));
        }
        let words = set(FIELDS, &self.values);
        self.dfkt.check(Words(&words), &Setting { runs, occasion, ..setting(self.call_ns, self.found()) })?;
        Ok(words)
    }

    fn refused(&self, more: &[(&'static str, i64)]) -> Option<Fault> {
        self.clone().asked(more, false, Occasion::Order).err()
    }

    fn seen(&self, value: i64, inputs: u8) -> CallInputs<'_> {
        let tables = Tables { all: &self.tables, places: &self.places };
        let source = SourceValue { value, travel: self.travel, mark: None };
        CallInputs { call_ns: self.call_ns, source, inputs, tables, ..at_rest() }
    }

    /// Returns sink, outputs and written outputs of START.
    fn start(&mut self, value: i64, inputs: u8) -> (i64, u8, u8) {
        let words = self.asked(&[], false, Occasion::Order).expect("a set that starts");
        let mut dfkt = self.dfkt.clone();
        let told = dfkt.start(Words(&words), &self.seen(value, inputs));
        self.dfkt = dfkt;
        (told.sink, told.outputs, told.writes)
    }

    fn value_new(&mut self, more: &[(&'static str, i64)]) {
        let words = self.asked(more, true, Occasion::Order).expect("a set that it takes");
        self.dfkt.apply_values(Words(&words));
    }

    /// Returns sink and outputs of a call with an input in 0.0001 rpm.
    fn step(&mut self, value: i64, inputs: u8) -> (i64, u8) {
        let mut dfkt = self.dfkt.clone();
        let told = dfkt.step(&self.seen(value, inputs));
        self.dfkt = dfkt;
        assert!(self.dfkt.is_valid_state());
        (told.sink, told.outputs)
    }

    /// Returns the status of the last call, as AMK-DFKT-52 defines it.
    fn status(&self) -> i64 {
        (0_u32..6).zip(self.dfkt.shown()).map(|(nth, bit)| bit << nth).sum()
    }

    /// Returns the active ratio and table.
    fn in_force(&self) -> &[i64] {
        &self.dfkt.shown()[6..]
    }

    /// Returns the status for inputs in rpm, without binary inputs.
    fn statuses<const N: usize>(&mut self, rpm: [i64; N]) -> [i64; N] {
        self.start(0, 0);
        rpm.map(|rpm| {
            self.step(rpm * RPM, 0);
            self.status()
        })
    }

    /// Returns the outputs for inputs in rpm, without binary inputs.
    fn follows<const N: usize>(&mut self, rpm: [i64; N]) -> [i64; N] {
        self.start(0, 0);
        rpm.map(|rpm| self.step(rpm * RPM, 0).0)
    }

    /// Returns the outputs for travel per call.
    fn turns<const N: usize>(&mut self, ways: [i64; N]) -> [i64; N] {
        self.start(0, 0);
        ways.map(|way| {
            self.travel += way;
            self.step(0, 0).0
        })
    }
}

/// The example of the manual without its inputs: the ratio of the whole table.
const EXAMPLE: [(&str, i64); 15] = [
    ("ba", 4),
    ("sf_cycle_time", 4),
    ("table_count", 2),
    ("active_table", 1),
    ("div", 1000),
    ("mult", 1000),
    ("in_resolution", 20_000),
    ("in_final", 2000),
    ("out_max", 4000),
    ("out_min", -4000),
    ("ratio_max", 2000),
    ("ratio_min", -2000),
    ("ratio_div", 1000),
    ("cont_low", 2),
    ("cont_high", 1),
];

fn example(more: &[(&'static str, i64)]) -> Bench {
    let mut bench = Bench::new(&[y(&T), y(&[0, 4000])], &EXAMPLE);
    for (name, value) in more {
        bench.values.retain(|(known, _)| known != name);
        bench.values.push((name, *value));
    }
    bench
}

/// Limits that never apply.
const FREE: [(&str, i64); 5] =
    [("out_max", 32_767), ("out_min", -32_767), ("ratio_max", 32_767), ("ratio_min", -32_767), ("ratio_div", 1)];

fn free(tables: &[Arc<Table>], values: &[(&'static str, i64)]) -> Bench {
    let plain = [("div", 1), ("mult", 1), ("in_final", 1000), ("table_count", 1), ("active_table", 1)];
    let mut bench = Bench::new(tables, &FREE);
    for (name, value) in plain.iter().chain(values) {
        bench.values.retain(|(known, _)| known != name);
        bench.values.push((name, *value));
    }
    bench
}

/// Proves: AMK-DFKT-05, AMK-DFKT-06, AMK-DFKT-07, AMK-DFKT-09, AMK-DFKT-10, AMK-DFKT-11, AMK-DFKT-12, AMK-DFKT-13, AMK-DFKT-14,
/// AMK-DFKT-15, AMK-DFKT-16, AMK-DFKT-17, AMK-DFKT-18, AMK-DFKT-19, AMK-DFKT-20, AMK-DFKT-21, AMK-DFKT-22
#[test]
fn the_fields_are_those_of_the_commanding_block() {
    let fields: Vec<_> = FIELDS.iter().map(|field| (field.name, field.min, field.max, field.live)).collect();
    // Fields that only bit 0 of ba needs may be 0; both ratio limits have the range of D3.
    assert_eq!(
        fields,
        [
            ("ba", 0, 7, false),
            ("sf_cycle_time", 0, 32_767, false),
            ("table_count", 0, 7, false),
            ("active_table", 0, 7, true),
            ("div", 1, 32_767, true),
            ("mult", -32_767, 32_767, true),
            ("in_resolution", 0, 65_535, true),
            ("in_final", 1, 32_767, true),
            ("out_max", 0, 32_767, true),
            ("out_min", -32_767, 0, true),
            ("ratio_max", -32_767, 32_767, true),
            ("ratio_min", -32_767, 32_767, true),
            ("ratio_div", 1, 32_767, true),
            ("cont_low", 0, 2, true),
            ("cont_high", 0, 1, true),
        ]
    );
}

/// Proves: AMK-DFKT-03, AMK-DFKT-04, AMK-DFKT-26, AMK-DFKT-28, AMK-DFKT-29, AMK-DFKT-30, AMK-DFKT-32, AMK-DFKT-O1, AMK-DFKT-O2
#[test]
fn the_ratio_of_the_whole_table_is_that_of_its_last_point() {
    let rpm = [1000, 1125, 2500, -500, -2500, 2000, 0];
    let speeds = [1000, 1125, 2500, -500, -2500, 2000, 0].map(|speed| speed * RPM);
    assert_eq!(example(&[]).follows(rpm), speeds);
    // Without bit 2 the table applies in full, as far as the limits of ratio and speed allow.
    assert_eq!(example(&[("ba", 0)]).follows([1000, 1125, 2500]), [20_000_000, 22_500_000, 40_000_000]);
    assert_eq!(example(&[("ba", 0), ("mult", 500)]).follows([1000, 2500]), [10_000_000, 25_000_000]);
}

/// Proves: AMK-DFKT-27, AMK-DFKT-O4
#[test]
fn a_way_per_call_is_a_speed() {
    let by_way = [("ba", 1), ("sf_cycle_time", 4), ("in_resolution", 20_000), ("active_table", 0)];
    // The slot computes differences in the width of its source: 32760 to -32760 is 16 further.
    assert_eq!(free(&[], &by_way).turns([100, 1, 16, -100, 0]), [1_500_000, 15_000, 240_000, -1_500_000, 0]);
    // The travel of the first call is 0 (D2), and travel counts from the position at START.
    let mut bench = free(&[], &by_way);
    bench.travel = 5000;
    assert_eq!((bench.start(0, 0), bench.step(0, 0)), ((0, 0, 0), (0, 0)));
    // A call time that is no multiple of half a millisecond.
    let mut bench = free(&[], &[("ba", 1), ("in_resolution", 20_000), ("active_table", 0)]);
    bench.call_ns = 750_000;
    assert_eq!(bench.turns([1]), [40_000]);
}

/// Proves: AMK-BCOM-41
#[test]
fn speed_of_travel_is_rounded_once_at_the_end() {
    // 6e14 / (7000 * 1 ms) = 85714.28.., and seven times that.
    let by_way = [("ba", 1), ("in_resolution", 7000), ("active_table", 0)];
    let mut bench = free(&[], &by_way);
    bench.call_ns = 1_000_000;
    assert_eq!(bench.turns([1, -1]), [85_714, -85_714]);
    bench.value_new(&[("mult", 7)]);
    bench.travel += 1;
    assert_eq!(bench.step(0, 0).0, 600_000);
}

/// Proves: AMK-DFKT-28
#[test]
fn steps_of_a_table_need_not_be_whole() {
    // in_final 1001: a step is 500.5 rpm. 250 rpm: 100 * 250 / 500.5 = 49.95004.. rpm; 750.75 rpm is the middle of the second.
    let mut bench = free(&[y(&[0, 100, 700])], &[("in_final", 1001), ("cont_low", 2)]);
    bench.start(0, 0);
    let calls = [2_500_000, 7_507_500, 5_005_000, 10_010_000, -2_500_000].map(|n| bench.step(n, 0).0);
    // Rounded towards 0 on both sides.
    assert_eq!(calls, [499_500, 4_000_000, 1_000_000, 7_000_000, -499_500]);
}

/// Proves: AMK-DFKT-21, AMK-DFKT-22, AMK-DFKT-29, AMK-DFKT-30
#[test]
fn beyond_its_ends_a_table_is_held_or_goes_on() {
    // Points of 0, 500 and 1000 rpm.
    let bench = |low, high| free(&[y(&[100, 300, 900])], &[("cont_low", low), ("cont_high", high)]);
    let rpm = [-2000, -500, 750, 1000, 1500];
    let speeds = |speeds: [i64; 5]| speeds.map(|speed| speed * RPM);
    assert_eq!(bench(0, 0).follows(rpm), speeds([100, 100, 600, 900, 900]).map(|y| y));
    assert_eq!(bench(0, 1).follows(rpm), speeds([100, 100, 600, 900, 1500]));
    // The mirrored half has the upper end as well (D5).
    assert_eq!(bench(2, 0).follows(rpm), speeds([-900, -300, 600, 900, 900]));
    assert_eq!(bench(2, 1).follows(rpm), speeds([-2100, -300, 600, 900, 1500]));
}

/// Proves: AMK-DFKT-10, AMK-DFKT-31
#[test]
fn without_a_table_the_ratio_alone_counts() {
    for ba in [0, 4] {
        // V_N is 1 there (D11).
        let mut bench = free(&[], &[("ba", ba), ("table_count", 0), ("active_table", 0), ("mult", -3), ("div", 2)]);
        assert_eq!(bench.follows([100, -100, 1500]), [-1_500_000, 1_500_000, -22_500_000]);
    }
}

/// Proves: AMK-DFKT-18, AMK-DFKT-19, AMK-DFKT-20, AMK-DFKT-33
#[test]
fn the_ratio_is_limited_as_a_product_so_that_0_gives_0() {
    let ratios = |least, most, low| {
        let limits = [("ratio_min", least), ("ratio_max", most), ("ratio_div", 1000), ("cont_low", low)];
        free(&[y(&[1000, 1000])], &limits)
    };
    assert_eq!(ratios(-2000, 2000, 0).follows([100, 0, 800, -100]), [2_000_000, 0, 10_000_000, 2_000_000]);
    // The limits change places below 0 (D6): -750 to -1000.
    assert_eq!(ratios(1500, 2000, 0).follows([1500, -500]), [22_500_000, -7_500_000]);
    assert_eq!(ratios(1500, 2000, 2).follows([-500]), [-10_000_000]);
    assert_eq!(ratios(-2000, -1500, 2).follows([500, -500]), [-7_500_000, 7_500_000]);
}

/// Proves: AMK-DFKT-16, AMK-DFKT-17, AMK-DFKT-34
#[test]
fn the_speed_is_limited_behind_the_ratio() {
    let mut bench = free(&[], &[("active_table", 0), ("out_max", 500), ("out_min", -200), ("ratio_min", 2)]);
    // The ratio requires at least 2 n.
    assert_eq!(bench.follows([100, 250, 251, -100, -101]), [2_000_000, 5_000_000, 5_000_000, -2_000_000, -2_000_000]);
    assert_eq!(free(&[], &[("active_table", 0), ("out_max", 0), ("out_min", 0)]).follows([100, -100]), [0, 0]);
}

/// Bits 4 and 5 report the side of the table, whatever its continuation (D7).
/// Proves: AMK-DFKT-52, AMK-DFKT-O2
#[test]
fn status_shows_input_beyond_the_ends_of_the_table() {
    for (low, high) in [(2, 1), (0, 0)] {
        let mut bench = example(&[("cont_low", low), ("cont_high", high)]);
        assert_eq!(bench.statuses([1000, 2000, 2500, 0, -500, -2500]), [0, 0, 16, 0, 32, 32], "{low} {high}");
    }
    // Without a table there is no end of one.
    assert_eq!(free(&[], &[("active_table", 0)]).statuses([500, 2500, -500]), [0; 3]);
}

/// The inputs of the tests of both limits; 1 is ratio_max, 2 ratio_min, 4 out_max, 8 out_min.
/// Proves: AMK-DFKT-52
#[test]
fn status_shows_the_limits_that_changed_the_output() {
    let ratios = |least, most, low| {
        let limits = [("ratio_min", least), ("ratio_max", most), ("ratio_div", 1000), ("cont_low", low)];
        free(&[y(&[1000, 1000])], &limits)
    };
    assert_eq!(ratios(-2000, 2000, 0).statuses([100, 0, 800, -100]), [1, 1, 0, 2 + 32]);
    // 1000 / 1500 and 1000 / -500 are less than 1.5.
    assert_eq!(ratios(1500, 2000, 0).statuses([1500, -500]), [2 + 16, 2 + 32]);
    assert_eq!(ratios(1500, 2000, 2).statuses([-500]), [32]);
    // 2 is more than -1.5, in both directions.
    assert_eq!(ratios(-2000, -1500, 2).statuses([500, -500]), [1, 1 + 32]);
    let mut bench = free(&[], &[("active_table", 0), ("out_max", 500), ("out_min", -200), ("ratio_min", 2)]);
    assert_eq!(bench.statuses([100, 250, 251, -100, -101]), [2, 2, 2 + 4, 2, 2 + 8]);
}

/// Proves: AMK-DFKT-23, AMK-DFKT-24
#[test]
fn a_data_block_is_the_same_table() {
    let points = [-300, 500, -32_767, 32_767];
    let rpm = [0, 100, 250, 333, 334, 500, 999, 1000, 1200, -50];
    let more = [("mult", 1), ("div", 3), ("cont_high", 1)];
    assert_eq!(free(&[words(&points)], &more).follows(rpm), free(&[y(&points)], &more).follows(rpm));
    // 127 points, the last one in DW 254, and a block that ends with it.
    let long: Vec<i64> = (0..127).collect();
    let block = words(&long);
    let block = Table::new(Form::Words, &[], &block.y()[..255]).expect("words");
    assert_eq!(free(&[Arc::new(block)], &[]).follows([1000, 500]), [126 * RPM, 63 * RPM]);
}

/// Proves: AMK-DFKT-01, AMK-DFKT-23, AMK-DFKT-24, AMK-DFKT-25
#[test]
fn tables_are_those_of_speeds() {
    let long: Vec<i64> = (0..128).collect();
    let raw = |words: &[i64]| Arc::new(Table::new(Form::Words, &[], words).expect("words"));
    let refused = |tables: &[Arc<Table>], count| {
        free(tables, &[("table_count", count), ("active_table", 0)])
            .refused(&[])
            .map(|fault| (fault.code, fault.asked, fault.limit))
    };
    let (good, n) = (y(&[0, 1]), Number::Count);
    let of = |code, table, limit| Some((code, n(table), n(limit)));
    assert_eq!(refused(&[good.clone(), y(&[1])], 2), of(Code::AMK_CURVE_POINTS, 1, 1));
    assert_eq!(refused(&[y(&long)], 1), of(Code::AMK_CURVE_POINTS, 0, 128));
    assert_eq!(refused(&[words(&long)], 1), of(Code::AMK_SPEED_POINTS, 0, 129));
    assert_eq!(refused(&[raw(&[2, 0, 5, 0])], 1), of(Code::AMK_SPEED_POINTS, 0, 2));
    assert_eq!(refused(&[raw(&[3, 0, 5, 0])], 1), of(Code::AMK_SPEED_WORDS, 0, 4));
    assert_eq!(refused(&[raw(&[3, 0, 5, 0, 5])], 1), None);
    assert_eq!(refused(&[y(&[0, 32_768])], 1), of(Code::AMK_SPEED_POINT, 0, 2));
    assert_eq!(refused(&[y(&[-32_768, 0])], 1), of(Code::AMK_SPEED_POINT, 0, 1));
    assert_eq!(refused(&[raw(&[3, 0, 0, 0, 32_768])], 1), of(Code::AMK_SPEED_POINT, 0, 2));
    let places = Table::new(Form::Xy, &[0, 5], &[0, 1]).expect("points");
    assert_eq!(refused(&[Arc::new(places)], 1), of(Code::AMK_CURVE_FORM, 0, 0));
    // Tables beyond table_count are not checked; seven are allowed, and an eighth table is the output table.
    assert_eq!(refused(&[good.clone(), y(&[1])], 1), None);
    let seven = vec![good.clone(); 7];
    assert_eq!(refused(&seven, 7), None);
    let eight = vec![good; 8];
    assert_eq!(refused(&eight, 0).map(|(code, ..)| code), Some(Code::AMK_OUTPUT_TABLE));
}

/// Proves: AMK-DFKT-09, AMK-DFKT-11, AMK-DFKT-13, AMK-DFKT-14, AMK-DFKT-18, AMK-DFKT-21
#[test]
fn sets_that_make_no_function_are_refused_with_their_field() {
    let refused = |more: &[(&'static str, i64)]| {
        let fault = example(&[]).refused(more)?;
        let field = FIELDS.get(usize::from(fault.field.unwrap_or(u16::MAX))).map_or("", |field| field.name);
        Some((fault.code, field, fault.asked, fault.limit))
    };
    let (n, of) = (Number::Count, |code, field, asked, limit| Some((code, field, asked, limit)));
    assert_eq!(refused(&[]), None);
    assert_eq!(refused(&[("ratio_min", 2000)]), of(Code::AMK_RATIO_LIMITS, "ratio_min", n(2000), n(2000)));
    assert_eq!(refused(&[("ratio_min", 1999)]), None);
    assert_eq!(refused(&[("cont_low", 1)]), of(Code::AMK_CONTINUATION, "cont_low", n(1), n(2)));
    // Only if the input is a travel (C8).
    assert_eq!(
        refused(&[("ba", 5), ("sf_cycle_time", 2)]),
        of(Code::AMK_CYCLE_MISMATCH, "sf_cycle_time", n(2), Number::Time(2_000_000))
    );
    assert_eq!(refused(&[("ba", 5), ("sf_cycle_time", 0)]), None);
    assert_eq!(refused(&[("ba", 4), ("sf_cycle_time", 2)]), None);
    assert_eq!(
        refused(&[("ba", 5), ("in_resolution", 0)]),
        of(Code::AMK_NO_RESOLUTION, "in_resolution", n(0), n(65_535))
    );
    assert_eq!(refused(&[("ba", 4), ("in_resolution", 0)]), None);
    // D10, with and without binary inputs.
    for ba in [4, 6] {
        let count = [("ba", ba), ("active_table", 3)];
        assert_eq!(refused(&count), of(Code::AMK_BEYOND, "active_table", n(3), n(2)));
        let missing = [("ba", ba), ("active_table", 3), ("table_count", 3)];
        assert_eq!(refused(&missing), of(Code::AMK_TABLE_NONE, "active_table", n(3), n(2)));
    }
    assert_eq!(refused(&[("table_count", 7)]), None);
    // D4: V_N is 2 here, and 2 * 16384 is one too many; without bit 2 the ratio is not related.
    assert_eq!(refused(&[("mult", -16_384)]), of(Code::AMK_BEYOND, "mult", n(-16_384), n(-16_383)));
    assert_eq!(refused(&[("mult", -16_383)]), None);
    assert_eq!(refused(&[("mult", 32_767), ("ba", 0)]), None);
    // D11.
    let mut flat = example(&[]);
    flat.tables[0] = y(&[5, 0]);
    assert_eq!(flat.refused(&[]).map(|fault| fault.code), Some(Code::AMK_LAST_POINT));
    assert_eq!(flat.refused(&[("ba", 0)]), None);
    assert_eq!(flat.refused(&[("active_table", 2)]), None);
}

/// Half, whole and double speed at 1000 rpm, selected by inputs.
fn chosen(more: &[(&'static str, i64)]) -> Bench {
    let tables = [y(&[0, 500]), y(&[0, 1000]), y(&[0, 2000]), y(&[0, 4000]), y(&[0, 8000])];
    let values = [("ba", 2), ("table_count", 3)];
    free(&tables, &values.iter().chain(more).copied().collect::<Vec<_>>())
}

const N: i64 = 1000 * RPM;

/// Proves: AMK-DFKT-08, AMK-DFKT-35, AMK-DFKT-36, AMK-DFKT-40, AMK-DFKT-46, AMK-DFKT-47
#[test]
fn e1_runs_and_stops_at_once() {
    let mut bench = chosen(&[]);
    assert_eq!(bench.start(N, 0), (0, A1, A1 | A2));
    assert_eq!(bench.step(N, 0), (0, A1));
    assert_eq!(bench.step(N, E1), (500 * RPM, 0));
    assert_eq!(bench.step(N, E1), (500 * RPM, 0));
    assert_eq!(bench.step(N, 0), (0, A1));
    // E1 acts by level: if it is 1 at START, the function runs.
    assert_eq!(chosen(&[]).start(N, E1), (500 * RPM, 0, A1 | A2));
    // Travel while it is stopped does not count as speed in the call in which it runs again.
    let mut bench = free(&[], &[("ba", 3), ("in_resolution", 20_000), ("active_table", 0)]);
    bench.start(0, E1);
    bench.travel = 9000;
    assert_eq!(bench.step(0, 0), (0, A1));
    bench.travel = 9100;
    assert_eq!(bench.step(0, E1), (1_500_000, 0));
}

/// Proves: AMK-DFKT-37, AMK-DFKT-38, AMK-DFKT-41, AMK-DFKT-45, AMK-DFKT-48, AMK-DFKT-49
#[test]
fn a_rising_e2_chooses_the_table_in_its_call() {
    let mut bench = chosen(&[("table_count", 5)]);
    // A strobe that is 1 at START is no edge.
    assert_eq!(bench.start(N, E1 | E2 | E4), (500 * RPM, 0, A1 | A2));
    assert_eq!(bench.step(N, E1 | E2 | E4), (500 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E4), (500 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E4), (1000 * RPM, A2));
    // The code is read at the edge only.
    assert_eq!(bench.step(N, E1 | E2 | E3), (1000 * RPM, A2));
    assert_eq!(bench.step(N, E1 | E3), (1000 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E3 | E4), (2000 * RPM, A2));
    assert_eq!(bench.step(N, E1 | E5), (2000 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E5), (4000 * RPM, A2));
    assert_eq!(bench.step(N, E1), (4000 * RPM, 0));
    // Code 0 selects no table; the code is read while it is stopped as well.
    assert_eq!(bench.step(N, E1 | E2), (1000 * RPM, A2));
    assert_eq!(bench.step(N, 0), (0, A1));
    assert_eq!(bench.step(N, E2 | E3 | E5), (0, A1 | A2));
    assert_eq!(bench.step(N, E1 | E2), (8000 * RPM, A2));
}

/// Proves: AMK-DFKT-39
#[test]
fn with_three_tables_e5_is_0() {
    let mut bench = chosen(&[("table_count", 3)]);
    bench.start(N, E1);
    assert_eq!(bench.step(N, E1 | E2 | E4 | E5), (1000 * RPM, A2));
    let mut bench = chosen(&[("table_count", 4)]);
    bench.start(N, E1);
    assert_eq!(bench.step(N, E1 | E2 | E5), (4000 * RPM, A2));
}

/// Proves: AMK-DFKT-12, AMK-DFKT-13, AMK-DFKT-43, AMK-DFKT-44, AMK-DFKT-50
#[test]
fn a_new_ratio_waits_for_the_strobe() {
    let mut bench = chosen(&[]);
    bench.start(N, E1);
    // active_table is ignored; the limits apply at once.
    bench.value_new(&[("mult", 3), ("div", 2), ("active_table", 7)]);
    assert_eq!(bench.step(N, E1), (500 * RPM, 0));
    bench.value_new(&[("out_max", 400)]);
    assert_eq!(bench.step(N, E1), (400 * RPM, 0));
    bench.value_new(&[("out_max", 32_767)]);
    // The strobe also reads the code: the present code keeps the table.
    assert_eq!(bench.step(N, E1 | E2 | E3), (750 * RPM, A2));
    assert_eq!(bench.step(N, E1), (750 * RPM, 0));
    assert_eq!(bench.step(N, E1 | E2 | E4), (1500 * RPM, A2));
}

/// Numerator, denominator and number of the table; waiting values are not active.
/// Proves: AMK-DFKT-53, AMK-DFKT-54
#[test]
fn ratio_and_table_in_force_are_shown() {
    let mut bench = chosen(&[]);
    bench.start(N, E1);
    assert_eq!(bench.in_force(), [1, 1, 1]);
    bench.value_new(&[("mult", -3), ("div", 2), ("out_min", -400)]);
    bench.step(N, E1);
    assert_eq!((bench.in_force(), bench.status()), (&[1, 1, 1][..], 0));
    bench.step(N, E1 | E2 | E4);
    assert_eq!((bench.in_force(), bench.status()), (&[-3, 2, 2][..], 8));
    // While it is stopped no limit applies.
    bench.step(N, 0);
    assert_eq!((bench.in_force(), bench.status()), (&[-3, 2, 2][..], 0));
    bench.step(N, E2);
    assert_eq!(bench.in_force(), [-3, 2, 0]);
}

/// Proves: AMK-DFKT-38, AMK-DFKT-48
#[test]
fn a_strobe_for_a_table_that_is_not_there_does_nothing() {
    let mut bench = chosen(&[("table_count", 5), ("ba", 6)]);
    bench.tables[3] = y(&[5, 0]);
    bench.places[4] = None;
    bench.start(N, E1);
    bench.value_new(&[("mult", 2)]);
    // Codes beyond table_count, of a missing table, and of a table whose ratio would be to 0 (D10, D11): V stays 1 / 1.
    for code in [E3 | E4 | E5, E3 | E5, E5] {
        assert_eq!(bench.step(N, E1 | E2 | code), (N, 0), "{code}");
        assert_eq!(bench.step(N, E1), (N, 0));
    }
    assert_eq!(bench.step(N, E1 | E2 | E4), (2 * N, A2));
}

/// Proves: AMK-DFKT-11, AMK-DFKT-42
#[test]
fn without_inputs_it_runs_at_once_and_takes_values_at_once() {
    let mut bench = chosen(&[("ba", 0)]);
    assert_eq!(bench.start(N, 0), (500 * RPM, 0, 0));
    assert_eq!(bench.step(N, E2 | E4), (500 * RPM, 0));
    bench.value_new(&[("mult", 3), ("active_table", 2)]);
    assert_eq!(bench.step(N, 0), (3000 * RPM, 0));
    bench.value_new(&[("active_table", 0), ("in_final", 500)]);
    assert_eq!(bench.step(N, 0), (3000 * RPM, 0));
    let fault = bench.asked(&[("active_table", 4)], true, Occasion::Order).expect_err("three tables count");
    assert_eq!(fault.code, Code::AMK_BEYOND);
}

/// Proves: AMK-DFKT-13, AMK-DFKT-43
#[test]
fn a_new_ratio_is_judged_by_the_table_that_runs() {
    let mut bench = chosen(&[("ba", 6)]);
    bench.start(N, E1);
    // With half speed 32767 is allowed; with the double speed that a strobe selected, half of it.
    bench.value_new(&[("mult", 32_767)]);
    bench.step(N, E1 | E2 | E3 | E4);
    let kept = bench.asked(&[], true, Occasion::Kept);
    assert!(kept.is_ok(), "what a strobe has made goes on: {kept:?}");
    let fault = bench.clone().asked(&[("mult", 16_384)], true, Occasion::Order).expect_err("too large");
    assert_eq!((fault.code, fault.limit), (Code::AMK_BEYOND, Number::Count(16_383)));
    bench.value_new(&[("mult", 16_383)]);
}

/// Proves: AMK-DFKT-25
#[test]
fn the_table_that_runs_gets_no_new_numbers() {
    let edit = |bench: &Bench, place: u8, runs| bench.clone().asked(&[], runs, Occasion::Edit(1 << place)).err();
    let mut bench = chosen(&[]);
    let used = |place| Some(Fault::new(Code::AMK_TABLE_IN_USE).with(place, 0));
    // In the cycle of START the new set applies.
    assert_eq!((edit(&bench, 0, false), edit(&bench, 1, false)), (used(0), None));
    bench.start(N, 0);
    bench.step(N, E2 | E4);
    assert_eq!((edit(&bench, 0, true), edit(&bench, 1, true)), (None, used(1)));
    // New numbers must be valid speeds.
    bench.tables[0] = y(&[0, 40_000]);
    assert_eq!(edit(&bench, 0, true).map(|fault| fault.code), Some(Code::AMK_SPEED_POINT));
    bench.step(N, 0);
    bench.step(N, E2);
    bench.tables[0] = y(&[0, 500]);
    assert_eq!([0, 1, 2].map(|place| edit(&bench, place, true)), [None; 3]);
}

/// A set that starts, its points, and whether they are words.
fn sets() -> impl Strategy<Value = (Vec<(&'static str, i64)>, Vec<i64>, bool)> {
    let word = || prop_oneof![-5_i64..6, -32_767_i64..=32_767];
    let divisor = || prop_oneof![1_i64..6, 1_i64..=32_767];
    let point = || prop_oneof![-3_i64..4, -5000_i64..5000, -32_767_i64..=32_767];
    let modes = (0_i64..8, 0_i64..2, 0_i64..2, 0_i64..2, any::<bool>());
    let numbers = (divisor(), word(), 1_i64..=65_535, divisor(), 0_i64..=32_767, -32_767_i64..=0);
    (modes, numbers, (word(), word(), divisor()), prop::collection::vec(point(), 2..128)).prop_map(
        |((ba, active, low, high, is_words), (div, mult, res, last, most, least), (a, b, ratio_div), points)| {
            let (ratio_min, ratio_max) = if a == b { (a.min(32_766), a.min(32_766) + 1) } else { (a.min(b), a.max(b)) };
            let values = vec![
                ("ba", ba),
                ("table_count", 1),
                ("active_table", active),
                ("div", div),
                ("mult", mult),
                ("in_resolution", res),
                ("in_final", last),
                ("out_max", most),
                ("out_min", least),
                ("ratio_max", ratio_max),
                ("ratio_min", ratio_min),
                ("ratio_div", ratio_div),
                ("cont_low", low * 2),
                ("cont_high", high),
            ];
            (values, points, is_words)
        },
    )
}

/// Returns the output of a set at a speed in 0.0001 rpm, and its status, by the formulas of the spec in their order.
fn by_the_book(values: &[(&'static str, i64)], points: &[i64], n: Fraction) -> (i64, i64) {
    let get = |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0, |(_, value)| *value);
    let whole = |value: i64| Fraction::from_integer(value.into());
    let rpm = n / whole(RPM);
    let (last, end) = (whole(points[points.len() - 1]), whole(get("in_final")));
    let step = end / whole(points.len() as i64 - 1);
    let inside = |n: Fraction| {
        let i = ((n / step).floor().to_integer() as usize).min(points.len() - 2);
        let (from, to) = (whole(points[i]), whole(points[i + 1]));
        from + (to - from) * (n - whole(i as i64) * step) / step
    };
    let above = |n: Fraction| {
        let before = whole(points[points.len() - 2]);
        if n <= end {
            inside(n)
        } else if get("cont_high") == 1 {
            last + (last - before) * (n - end) / step
        } else {
            last
        }
    };
    let zero = whole(0);
    let t = match (get("active_table"), rpm < zero, get("cont_low")) {
        (0, ..) => rpm,
        (_, false, _) => above(rpm),
        (_, true, 0) => whole(points[0]),
        _ => -above(-rpm),
    };
    let mut y = t * whole(get("mult")) / whole(get("div"));
    if get("ba") & 4 != 0 && get("active_table") != 0 {
        y /= last / end;
    }
    let of_input = |name| rpm * whole(get(name)) / whole(get("ratio_div"));
    let (a, b) = (of_input("ratio_min"), of_input("ratio_max"));
    let geared = y.clamp(a.min(b), a.max(b));
    let sink = geared.clamp(whole(get("out_min")), whole(get("out_max")));
    let [y_cut, geared_cut, sink_cut] = [y, geared, sink].map(|y| (y * whole(RPM)).trunc().to_integer());
    let ratio_over = if rpm < zero { y < b } else { y > b };
    let has_table = get("active_table") != 0;
    let bits = [
        geared_cut != y_cut && ratio_over,
        geared_cut != y_cut && !ratio_over,
        sink_cut < geared_cut,
        sink_cut > geared_cut,
        has_table && rpm > end,
        has_table && rpm < zero,
    ];
    (sink_cut as i64, (0_u32..).zip(bits).map(|(nth, bit)| i64::from(bit) << nth).sum())
}

proptest! {
    /// Proves: AMK-DFKT-26, AMK-DFKT-27, AMK-DFKT-28, AMK-DFKT-29, AMK-DFKT-30, AMK-DFKT-31, AMK-DFKT-32, AMK-DFKT-33, AMK-DFKT-34
    #[test]
    fn every_output_equals_spec_and_is_within_limits(
        (values, points, is_words) in sets(),
        inputs in prop::collection::vec(prop_oneof![-3_i64..4, -2_000_000_i64..2_000_000, -2_147_483_648_i64..2_147_483_648], 1..20),
        call_ns in prop::sample::select(vec![125_000_u64, 1_000_000, 1_333_333, 20_000_000]),
    ) {
        let mut bench = Bench::new(&[if is_words { words(&points) } else { y(&points) }], &values);
        bench.call_ns = call_ns;
        prop_assume!(bench.refused(&[]).is_none());
        let get = |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0, |(_, value)| *value);
        bench.start(0, E1);
        for input in inputs {
            let n = if get("ba") & 1 == 1 {
                // Travel of 16 bits.
                let way = input % 32_768;
                bench.travel += way;
                Fraction::new(i128::from(way) * 600_000_000_000_000, i128::from(get("in_resolution")) * i128::from(call_ns))
            } else {
                Fraction::from_integer(input.into())
            };
            let (given, _) = bench.step(input, E1);
            let told = (given, bench.status());
            prop_assert_eq!(told, by_the_book(&values, &points, n), "{} {:?}", n, bench.dfkt);
            prop_assert!((get("out_min") * RPM..=get("out_max") * RPM).contains(&given));
            // The output is within the ratio limits, unless out_min and out_max limit it further; they always allow 0.
            let of = |name| n * Fraction::new(get(name).into(), get("ratio_div").into());
            let (a, b) = (of("ratio_min"), of("ratio_max"));
            let bounds = (a.min(b).floor().to_integer(), a.max(b).ceil().to_integer());
            let is_cut = given == get("out_min") * RPM || given == get("out_max") * RPM;
            prop_assert!(is_cut || (bounds.0..=bounds.1).contains(&given.into()), "{given} {bounds:?}");
        }
    }

    /// Proves: AMK-DFKT-28
    #[test]
    fn a_rising_table_makes_a_faster_master_no_slower_slave(
        rises in prop::collection::vec(0_i64..250, 2..100),
        last in 1_i64..=32_767,
        high in 0_i64..2,
        mut inputs in prop::collection::vec(-400_000_000_i64..400_000_000, 2..20),
    ) {
        let mut points = vec![0];
        rises.iter().for_each(|rise| points.push(points[points.len() - 1] + rise));
        let mut bench = free(&[y(&points)], &[("in_final", last), ("cont_low", 2), ("cont_high", high)]);
        bench.start(0, 0);
        inputs.sort_unstable();
        let outputs: Vec<i64> = inputs.iter().map(|n| bench.step(*n, 0).0).collect();
        prop_assert!(outputs.is_sorted(), "{inputs:?} {outputs:?}");
    }

    /// Proves: AMK-DFKT-30
    #[test]
    fn a_mirrored_table_mirrors_each_unit((mut values, points, _) in sets(), n in 1_i64..2_147_483_648) {
        let most = values.iter().find(|(name, _)| *name == "out_max").map_or(0, |(_, value)| *value);
        values.retain(|(name, _)| !["ba", "cont_low", "out_min"].contains(name));
        values.extend([("ba", 0), ("cont_low", 2), ("out_min", -most)]);
        let mut bench = Bench::new(&[y(&points)], &values);
        bench.start(0, 0);
        prop_assert_eq!(bench.step(n, 0).0, -bench.step(-n, 0).0);
    }

    /// Any input is handled without a panic, and the resulting state is valid.
    #[test]
    fn no_master_and_no_input_is_too_much(
        (values, points, _) in sets(),
        calls in prop::collection::vec((any::<i64>(), any::<i64>(), any::<u8>()), 1..40),
        call_ns in prop_oneof![Just(1), Just(u64::MAX), 1_u64..10_000_000_000],
    ) {
        let mut bench = Bench::new(&[y(&points), y(&[0, 5])], &values);
        bench.call_ns = call_ns;
        prop_assume!(bench.refused(&[]).is_none());
        bench.start(i64::MIN, 0);
        for (value, travel, inputs) in calls {
            bench.travel = travel;
            let (sink, _) = bench.step(value, inputs);
            prop_assert!(sink.abs() <= WORD * RPM);
        }
    }
}

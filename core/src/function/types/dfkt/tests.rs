//! Test oracles of DFKT: its fields, tables, ratios and limits, and sets that are refused.

use super::*;
use crate::event::Number;
use crate::function::program::SourceValue;
use crate::function::program::Tables;
use crate::function::trial::{at_rest, set, setting};
use crate::table::{Form, Table};
use std::sync::Arc;

mod inputs;
mod laws;

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
        Self {
            dfkt: Dfkt::new(&SlotSetup::default()),
            tables: tables.into(),
            places,
            call_ns: CALL,
            values: values.into(),
            travel: 0,
        }
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

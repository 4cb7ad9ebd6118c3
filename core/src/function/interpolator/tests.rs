//! Interpolators by their oracles, and against walks of single increments.

use super::super::program::{LINES, Outcome, Program, Seen};
use super::super::trial::{at_rest, set, setting, tabs};
use super::fipw::{self, Fipw};
use super::fipz::{self, Fipz};
use super::xfipw::{self, Xfipw};
use crate::code::Code;
use crate::function::field::{Field, Words};
use crate::function::program::{Fault, Reading, Setting};
use crate::table::{Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

/// The table of section 3.10.2.
const T: [i64; 9] = [0, 1000, 1500, 2000, 4000, 8000, 12_000, 15_000, 20_000];
/// Half a millisecond (ns).
const HALF: u64 = 500_000;

fn y(points: &[i64]) -> Arc<Table> {
    Arc::new(Table::new(Form::Y, &[], points).expect("points"))
}

fn xy(points: &[(i64, i64)]) -> Arc<Table> {
    let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
    Arc::new(Table::new(Form::Xy, &x, &y).expect("points"))
}

/// A function with its tables, at some place of its master.
struct Bench<'a, P> {
    function: P,
    fields: &'static [Field],
    tables: &'a [Arc<Table>],
    call_ns: u64,
    travel: i64,
    sink: i64,
}

impl<'a, P: Program> Bench<'a, P> {
    fn of(function: P, fields: &'static [Field], tables: &'a [Arc<Table>]) -> Self {
        Self { function, fields, tables, call_ns: 2 * HALF, travel: 0, sink: 0 }
    }

    /// Tab0 to Tab7.
    fn found(&self) -> [Option<&Table>; LINES] {
        std::array::from_fn(|place| self.tables.get(place).map(|table| &**table))
    }

    fn refused(&self, values: &[(&str, i64)]) -> Option<Fault> {
        let words = set(self.fields, values);
        self.function.check(Words(&words), &setting(self.call_ns, self.found())).err()
    }

    fn seen(&self, inputs: u8, mark: Option<i64>) -> Seen<'a> {
        let source = Reading { value: self.travel, travel: self.travel, mark };
        Seen { call_ns: self.call_ns, source, inputs, sink: self.sink, tables: tabs(self.tables), ..at_rest() }
    }

    fn start(&mut self, values: &[(&str, i64)], inputs: u8) -> Outcome {
        assert_eq!(self.refused(values), None);
        let words = set(self.fields, values);
        let outcome = self.function.start(Words(&words), &self.seen(inputs, None));
        self.sink = outcome.sink;
        outcome
    }

    /// A call behind so much way.
    fn step(&mut self, way: i64, inputs: u8) -> Outcome {
        self.travel += way;
        let outcome = self.function.step(&self.seen(inputs, None));
        self.sink = outcome.sink;
        outcome
    }

    /// Sink and A1 of calls, each behind some way and with these inputs.
    fn run(&mut self, calls: &[(i64, u8)]) -> Vec<(i64, u8)> {
        calls.iter().map(|(way, inputs)| self.step(*way, *inputs)).map(|out| (out.sink, out.outputs)).collect()
    }
}

fn fipw(tables: &[Arc<Table>]) -> Bench<'_, Fipw> {
    Bench::of(Fipw::new(), fipw::FIELDS, tables)
}

fn fipz(tables: &[Arc<Table>]) -> Bench<'_, Fipz> {
    Bench::of(Fipz::new(), fipz::FIELDS, tables)
}

fn xfipw(tables: &[Arc<Table>]) -> Bench<'_, Xfipw> {
    Bench::of(Xfipw::new(), xfipw::FIELDS, tables)
}

/// A set of fipw by way, of one table but for what is given.
fn by_way<'a>(mode: i64, more: &[(&'a str, i64)]) -> Vec<(&'a str, i64)> {
    let mut values = vec![("mode", mode), ("mult", 1), ("table_count", 1), ("increments_per_rev", 100)];
    for (name, value) in more {
        values.retain(|(known, _)| known != name);
        values.push((name, *value));
    }
    values
}

/// Proves: AMK-FIPW-05, AMK-FIPW-06, AMK-FIPW-36, AMK-FIPW-42, AMK-FIPW-55, AMK-FIPW-O1
#[test]
fn a_cycle_follows_its_table_over_every_passage_and_back() {
    let tables = [y(&T)];
    let mut bench = fipw(&tables);
    bench.start(&by_way(2, &[("increments_per_rev", 20_000)]), 0);
    for (x, sink) in [
        (1250, 500),
        (2500, 1000),
        (10_000, 4000),
        (11_000, 5600),
        (19_999, 19_998),
        (20_000, 20_000),
        (21_250, 20_500),
        (-1, -2),
        (-20_000, -20_000),
        (60_000 + 1250, 60_500),
        (0, 0),
    ] {
        let out = bench.step(x - bench.travel, 0);
        assert_eq!((out.sink, out.outputs, out.writes), (sink, 0, 0), "{x}");
    }
}

/// Proves: AMK-FIPW-41, AMK-FIPW-44, AMK-FIPW-45, AMK-FIPW-54, AMK-FIPW-O5
#[test]
fn a_movement_by_time_ends_with_its_last_value() {
    let tables = [y(&[0, 1000, 4000])];
    let timed = |time| [("mode", 132), ("mult", 1), ("table_count", 1), ("sf_cycle", 2), ("cycle_time", time)];
    let mut bench = fipw(&tables);
    assert_eq!(bench.start(&timed(10), 0).outputs, 1);
    // The call of the edge gives t = 0.
    let calls: Vec<_> = (0..8).map(|_| (0, 1)).collect();
    let wanted = [(0, 0), (400, 0), (800, 0), (1600, 0), (2800, 0), (4000, 1), (4000, 1), (4000, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // Another edge goes on from there.
    assert_eq!(bench.run(&[(0, 0), (0, 1), (0, 1)]), [(4000, 1), (4000, 0), (4400, 0)]);
    let mut bench = fipw(&tables);
    bench.start(&timed(5), 0);
    assert_eq!(bench.run(&[(0, 1); 5]), [(0, 0), (800, 0), (2800, 0), (4000, 1), (4000, 1)]);
}

/// Proves: AMK-FIPW-08, AMK-FIPW-09
#[test]
fn time_runs_in_parts_of_a_call_where_that_is_no_half_millisecond() {
    let tables = [y(&[0, 1000, 4000])];
    let mut bench = fipw(&tables);
    bench.call_ns = 125_000;
    bench.start(&[("mode", 4), ("mult", 1), ("table_count", 1), ("cycle_time", 1)], 0);
    // 0.5 ms are four calls: 500, 1000, 2500, 4000, and round again.
    assert_eq!(bench.run(&[(0, 0); 5]).iter().map(|call| call.0).collect::<Vec<_>>(), [500, 1000, 2500, 4000, 4500]);
}

/// Proves: AMK-FIPW-43, AMK-SYNC-01, AMK-SYNC-02, AMK-SYNC-O2
#[test]
fn a_zero_pulse_begins_a_cycle_where_it_was() {
    let tables = [y(&[0, 1000])];
    let mut bench = fipw(&tables);
    bench.sink = 70;
    bench.start(&by_way(2, &[("function", 4)]), 0);
    assert_eq!(bench.run(&[(250, 0), (250, 0)]), [(70, 0), (70, 0)]);
    bench.travel += 30;
    // 10 inc ago: x = 10.
    let out = bench.function.step(&bench.seen(0, Some(520)));
    assert_eq!(out.sink, 70 + 100);
    assert_eq!(bench.run(&[(10, 0), (80, 0)]), [(270, 0), (1070, 0)]);
    let mut bench = fipw(&tables);
    // With an offset beyond the window the table begins at its next zero: 40 inc behind the pulse.
    bench.start(&by_way(2, &[("function", 4), ("master_offset", 60)]), 0);
    bench.travel += 30;
    assert_eq!(bench.function.step(&bench.seen(0, Some(20))).sink, 0);
    assert_eq!(bench.run(&[(29, 0), (2, 0)]), [(0, 0), (10, 0)]);
}

/// Proves: AMK-FIPW-22, AMK-FIPW-23
#[test]
fn a_cycle_waits_for_its_window_and_is_locked_to_the_master() {
    let tables = [y(&[0, 1000])];
    let mut bench = fipw(&tables);
    // x = 40 lies within 0..50: it begins at once, and is caught up in the next call.
    assert_eq!(bench.start(&by_way(2, &[("master_offset", 40), ("start_angle", 50)]), 0).sink, 0);
    assert_eq!(bench.run(&[(0, 0), (1, 0)]), [(400, 0), (410, 0)]);
    let mut bench = fipw(&tables);
    bench.start(&by_way(2, &[("master_offset", 60), ("start_angle", 50)]), 0);
    assert_eq!(bench.run(&[(39, 0), (3, 0), (-10, 0)]), [(0, 0), (20, 0), (-80, 0)]);
}

/// Proves: AMK-FIPW-38, AMK-FIPW-40, AMK-FIPW-46, AMK-FIPW-47
#[test]
fn tables_run_one_after_the_other_once_e1_has_risen() {
    let tables = [y(&[0, 100]), y(&[0, 1000]), y(&[0, -50])];
    let mut bench = fipw(&tables);
    // E1 = 1 at START is no edge.
    assert_eq!(bench.start(&by_way(82, &[("table_count", 3)]), 1).outputs, 1);
    assert_eq!(bench.run(&[(150, 1), (0, 0)]), [(0, 1), (0, 1)]);
    // The edge waits for the zero; there x is 10 already.
    // x is 50. The edge comes with E1 at 0 between; it waits for the zero, where x is 10 already.
    let calls = [(0, 0), (10, 1), (50, 0), (90, 1), (100, 0), (90, 0), (20, 1), (100, 1), (0, 0), (0, 1), (90, 1)];
    let wanted = [
        (0, 1),
        (0, 1),
        (10, 0),
        (100, 0),
        (1100, 0),
        (1055, 0),
        (1050, 1),
        (1050, 1),
        (1050, 1),
        (1050, 1),
        (1050, 0),
    ];
    assert_eq!(bench.run(&calls), wanted);
}

/// Proves: AMK-FIPW-48, AMK-FIPW-49, AMK-FIPW-50, AMK-FIPW-51, AMK-FIPW-52, AMK-FIPW-39
#[test]
fn a_master_is_coupled_in_and_out_by_tables() {
    let tables = [y(&[0, 50]), y(&[0, 100]), y(&[0, 40])];
    let mut bench = fipw(&tables);
    bench.start(&by_way(98, &[("table_count", 3), ("start_tables", 1)]), 0);
    // In at the zero: start table, working table twice, out; then clocked out.
    let calls = [(50, 1), (50, 1), (100, 1), (100, 1), (50, 1), (50, 0), (50, 0), (50, 0), (100, 0)];
    let wanted = [(0, 1), (0, 0), (50, 0), (150, 0), (200, 0), (250, 0), (270, 0), (290, 1), (290, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // A level is enough now; it goes while the start table runs: no working table.
    let calls = [(100, 1), (50, 0), (50, 0), (50, 0), (50, 0), (50, 0)];
    let wanted = [(290, 0), (315, 0), (340, 0), (360, 0), (380, 1), (380, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // 1 again while it clocks out: in again at the same zero, A1 stays 0.
    let calls = [(50, 1), (100, 0), (50, 1), (50, 1)];
    assert_eq!(bench.run(&calls), [(380, 0), (430, 0), (450, 0), (470, 0)]);
    assert_eq!(bench.run(&[(50, 1)]), [(495, 0)]);
}

#[test]
fn a_stop_window_replaces_the_rest_of_a_pass() {
    let tables = [y(&[0, 100]), y(&[0, 40])];
    let values = by_way(98, &[("table_count", 2), ("stop_angle", 30)]);
    let mut bench = fipw(&tables);
    bench.start(&values, 0);
    // q = 0: the working table at once, at x = 0.
    assert_eq!(bench.run(&[(0, 1), (120, 1), (5, 0), (5, 0)]), [(0, 0), (120, 0), (110, 0), (112, 0)]);
    // Back before the zero: the working table again.
    assert_eq!(bench.run(&[(-40, 0), (20, 0), (110, 0)]), [(90, 0), (104, 0), (140, 1)]);
    // Without a stop table a window stops nothing.
    let mut bench = fipw(&tables);
    bench.start(&by_way(98, &[("table_count", 1), ("stop_angle", 30)]), 0);
    assert_eq!(bench.run(&[(0, 1), (20, 0), (79, 0), (1, 0), (5, 0)]), [(0, 0), (20, 0), (99, 0), (100, 1), (100, 1)]);
}

/// Proves: AMK-FIPW-37
#[test]
fn behind_its_first_table_a_movement_waits_for_the_master() {
    let tables = [y(&[0, 100])];
    let mut bench = fipw(&tables);
    bench.start(&by_way(26, &[]), 0);
    // Wherever the master is, x = 0 at the edge.
    let calls = [(77, 1), (10, 1), (-30, 1), (10, 1), (15, 0), (-400, 0), (395, 1), (200, 1), (10, 1)];
    let wanted = [(0, 0), (10, 0), (0, 0), (0, 0), (5, 0), (0, 0), (0, 0), (100, 1), (100, 1)];
    assert_eq!(bench.run(&calls), wanted);
}

/// Proves: AMK-FIPW-01, AMK-FIPW-15, AMK-FIPW-16, AMK-FIPW-18, AMK-FIPW-20, AMK-FIPW-21, AMK-FIPW-24, AMK-FIPW-28, AMK-FIPW-29, AMK-FIPW-30,
/// AMK-FIPW-31, AMK-FIPW-32, AMK-FIPW-33, AMK-FIPW-34
#[test]
fn what_a_mode_does_not_use_is_refused() {
    let many: Vec<i64> = (0..128).collect();
    let tables = [y(&[0, 100]), y(&many), xy(&[(0, 0), (100, 5)]), y(&[1, 2])];
    let bench = fipw(&tables);
    let of = |mode, more: &[(&str, i64)]| bench.refused(&by_way(mode, more)).map(|fault| (fault.code, fault.field));
    let field = |name: &str| fipw::FIELDS.iter().position(|field| field.name == name).map(|place| place as u16);
    assert_eq!(of(3, &[]), Some((Code::AMK_NO_MODE, field("mode"))));
    let unused = |mode, name: &'static str, value| (of(mode, &[(name, value)]), field(name));
    for (mode, name, value) in [
        (2, "table_count", 2),
        (26, "table_count", 2),
        (82, "start_tables", 1),
        (26, "master_offset", 1),
        (26, "start_angle", 1),
        (2, "stop_angle", 1),
        (82, "stop_angle", 1),
        (2, "cycle_time", 1),
        (82, "function", 1),
        (2, "function", 2),
        (26, "function", 4),
    ] {
        let (refused, field) = unused(mode, name, value);
        assert_eq!(refused, Some((Code::AMK_MODE_FIELD, field)), "{mode} {name}");
    }
    for (mode, name, value) in [
        (98, "start_tables", 1),
        (2, "increments_per_rev", 49),
        (2, "master_offset", 100),
        (82, "start_angle", 100),
        (98, "stop_angle", 100),
    ] {
        let (refused, field) = unused(mode, name, value);
        assert_eq!(refused, Some((Code::AMK_BEYOND, field)), "{mode} {name}");
    }
    assert_eq!(of(98, &[("master_offset", 99), ("start_angle", 99), ("stop_angle", 99)]), None);
    assert_eq!(of(82, &[("table_count", 2)]), Some((Code::AMK_CURVE_POINTS, None)));
    assert_eq!(of(82, &[("table_count", 5)]), Some((Code::AMK_TABLES_FEW, None)));
    let time = |more: &[(&str, i64)]| {
        let values = [&[("mode", 100), ("mult", 1), ("table_count", 1)], more].concat();
        bench.refused(&values).map(|fault| (fault.code, fault.field))
    };
    assert_eq!(time(&[]), Some((Code::AMK_BEYOND, field("cycle_time"))));
    assert_eq!(time(&[("cycle_time", 65_534), ("master_offset", 65_533), ("stop_angle", 65_533)]), None);
    assert_eq!(time(&[("cycle_time", 65_535)]), Some((Code::AMK_BEYOND, field("cycle_time"))));
    assert_eq!(time(&[("cycle_time", 9), ("function", 4)]), Some((Code::AMK_MODE_FIELD, field("function"))));
    assert_eq!(time(&[("cycle_time", 9), ("sf_cycle", 3)]), Some((Code::AMK_CYCLE_MISMATCH, field("sf_cycle"))));
    let only = |table: usize| fipw(&tables[table..]).refused(&by_way(2, &[])).map(|fault| fault.code);
    assert_eq!(
        [only(1), only(2), only(3)],
        [Some(Code::AMK_CURVE_POINTS), Some(Code::AMK_CURVE_FORM), Some(Code::AMK_CURVE_FIRST)]
    );
}

/// Proves: AMK-FIPW-19, AMK-FIPW-17, AMK-FIPW-27
#[test]
fn a_scaled_value_keeps_32_bits() {
    let high: Vec<i64> = (0..127).map(|i| i * 32_767).collect();
    let tables = [y(&high)];
    let of = |mult, div_exp| {
        fipw(&tables).refused(&by_way(2, &[("mult", mult), ("div_exp", div_exp)])).map(|fault| fault.code)
    };
    // 126 * 32767 = 4128642; times 520 it is 2146893840, times 521 2151022482.
    assert_eq!(
        (of(520, 0), of(521, 0), of(521, 1), of(-521, 0)),
        (None, Some(Code::AMK_CURVE_SCALED), None, Some(Code::AMK_CURVE_SCALED))
    );
}

/// Proves: AMK-FIPZ-02, AMK-FIPZ-04, AMK-FIPZ-16, AMK-FIPZ-17, AMK-FIPZ-18, AMK-FIPZ-19, AMK-FIPZ-O2
#[test]
fn each_input_starts_its_table() {
    let tables: Vec<Arc<Table>> = (1..6).map(|n| y(&[0, 1000 * n])).collect();
    let mut bench = fipz(&tables);
    bench.call_ns = 4 * HALF;
    let mut values = set(fipz::FIELDS, &[("mode", 16), ("sf_cycle", 4), ("table_count", 5), ("mult", 1)]);
    let place = values.len() - LINES;
    values[place..place + 5].copy_from_slice(&[2000, 4000, 6000, 8000, 10_000]);
    assert!(bench.function.check(Words(&values), &setting(bench.call_ns, bench.found())).is_ok());
    assert_eq!(bench.function.start(Words(&values), &bench.seen(1, None)).outputs, 1);
    // E1 stands: no edge. Then E3 and E2 at once: the lower one. 4000 half milliseconds are 1000 calls.
    assert_eq!(bench.run(&[(0, 1), (0, 0b111)]), [(0, 1), (0, 0)]);
    let calls: Vec<_> = bench.run(&[(0, 0b1001); 1000]);
    assert_eq!((calls[0], calls[499], calls[998], calls[999]), ((2, 0), (1000, 0), (1998, 0), (2000, 1)));
    // The edge of E4 while it ran is lost; Table 0 takes 500 calls.
    assert_eq!(bench.run(&[(0, 0b1001), (0, 0), (0, 1)]), [(2000, 1), (2000, 1), (2000, 0)]);
    let calls: Vec<_> = bench.run(&[(0, 0); 500]);
    assert_eq!((calls[498].1, calls[499]), (0, (3000, 1)));
    // A table beyond the count, or without a time.
    assert_eq!(bench.run(&[(0, 0b10_0000)]), [(3000, 1)]);
}

/// Proves: AMK-FIPZ-03, AMK-FIPZ-O1
#[test]
fn one_input_starts_the_table_that_the_others_name() {
    let tables: Vec<Arc<Table>> = (0..8).map(|n| y(&[0, 100 + n])).collect();
    // Bits from E1 on, and the table.
    for (inputs, table) in [(0b1011, 5), (0b1101, 6), (0b0001, 0), (0b1111, 7)] {
        let mut bench = fipz(&tables);
        let mut values = set(fipz::FIELDS, &[("mode", 17), ("table_count", 8), ("mult", 1)]);
        let place = values.len() - LINES;
        values[place..].copy_from_slice(&[2; LINES]);
        bench.function.start(Words(&values), &bench.seen(inputs & !1, None));
        assert_eq!(bench.run(&[(0, inputs), (0, 0)]), [(0, 0), (100 + table, 1)], "{inputs:b}");
    }
}

fn extended<'a>(ba: i64, more: &[(&'a str, i64)]) -> Vec<(&'a str, i64)> {
    let mut values = vec![("ba", ba), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 100)];
    for (name, value) in more {
        values.retain(|(known, _)| known != name);
        values.push((name, *value));
    }
    values
}

/// Proves: AMK-XFIPW-13, AMK-XFIPW-26, AMK-XFIPW-40, AMK-XFIPW-O1
#[test]
fn both_forms_run_through_the_same_curve() {
    let places: Vec<_> = T.iter().enumerate().map(|(i, y)| (2500 * i as i64, *y)).collect();
    let (even, uneven) = ([y(&T)], [xy(&places)]);
    let (mut a, mut b) = (xfipw(&even), xfipw(&uneven));
    a.start(&extended(2, &[("incr_per_rev", 20_000)]), 0);
    b.start(&extended(2, &[("incr_per_rev", 0)]), 0);
    for (x, sink) in
        [(3750, 1250), (10_000, 4000), (11_250, 6000), (20_000, 20_000), (22_500, 21_000), (45_000, 41_500)]
    {
        let way = x - a.travel;
        assert_eq!((a.step(way, 0).sink, b.step(way, 0).sink), (sink, sink), "{x}");
    }
    let mut scaled = xfipw(&even);
    scaled.start(&extended(2, &[("incr_per_rev", 20_000), ("mult", 3), ("div_exp", 1)]), 0);
    assert_eq!((scaled.step(3750, 0).sink, scaled.step(6250, 0).sink), (1875, 6000));
}

/// Proves: AMK-XFIPW-44, AMK-XFIPW-64, AMK-XFIPW-65, AMK-XFIPW-66, AMK-XFIPW-88, AMK-XFIPW-O3
#[test]
fn a_slave_is_set_on_where_its_master_is() {
    let tables = [y(&T)];
    let mut bench = xfipw(&tables);
    bench.call_ns = 4 * HALF;
    let values =
        |offset| extended(2, &[("function", 8), ("sf_cycle", 4), ("incr_per_rev", 20_000), ("master_offset", offset)]);
    let read = |bench: &Bench<'_, Xfipw>, offset| {
        let words = set(xfipw::FIELDS, &values(offset));
        bench
            .function
            .read(Words(&words), &setting(bench.call_ns, bench.found()))
            .map(|found| found.map(|(_, value)| value))
    };
    assert_eq!(read(&bench, 10_000), Ok(Some(4000)));
    // Y(-x) = Y(Xme - x) - Ye.
    assert_eq!(read(&bench, -10_000), Ok(Some(4000 - 20_000)));
    assert_eq!(bench.start(&values(10_000), 0).sink, 0);
    assert_eq!(bench.step(1250, 0).sink, 2000);
    // Behind the master by 1250.
    let mut bench = xfipw(&tables);
    bench.sink = 7;
    bench.start(&extended(2, &[("function", 8), ("incr_per_rev", 20_000), ("master_offset", -1250)]), 0);
    assert_eq!((bench.step(1250, 0).sink, bench.step(1250, 0).sink), (7 + 2500, 7 + 3000));
}

/// Proves: AMK-XFIPW-37, AMK-XFIPW-45, AMK-XFIPW-48, AMK-XFIPW-49, AMK-XFIPW-67, AMK-XFIPW-68, AMK-XFIPW-27, AMK-XFIPW-39
#[test]
fn a_movement_takes_its_passes_and_a_stored_edge_the_next_one() {
    let tables = [y(&[0, 100])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("work_cycles", 2)]), 0);
    // An edge while it runs is lost.
    let calls = [(9, 1), (150, 0), (40, 1), (20, 1), (20, 1), (0, 0), (0, 1), (5, 1)];
    let wanted = [(0, 0), (150, 0), (190, 0), (200, 1), (200, 1), (200, 1), (200, 0), (205, 0)];
    assert_eq!(bench.run(&calls), wanted);
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("function", 16)]), 0);
    // Stored, and E1 = 1 at the end: on without a rest, with what x is beyond.
    let calls = [(0, 1), (50, 0), (30, 1), (30, 1), (50, 0), (20, 1), (10, 0), (20, 0)];
    let wanted = [(0, 0), (50, 0), (80, 0), (110, 0), (160, 0), (180, 0), (190, 0), (200, 1)];
    assert_eq!(bench.run(&calls), wanted);
}

/// Proves: AMK-XFIPW-29, AMK-XFIPW-46, AMK-XFIPW-47, AMK-XFIPW-50, AMK-XFIPW-51, AMK-XFIPW-52, AMK-XFIPW-53
#[test]
fn a_level_alone_clocks_nothing_in_again() {
    let tables = [y(&[0, 50]), y(&[0, 100]), y(&[0, 40])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(98, &[("tables_total", 3), ("tables_start", 1)]), 0);
    // Taken back before the zero: disarmed.
    assert_eq!(bench.run(&[(50, 1), (20, 0), (40, 0), (90, 1)]), [(0, 1), (0, 1), (0, 1), (0, 0)]);
    assert_eq!(
        bench.run(&[(100, 1), (100, 0), (50, 1), (50, 1), (100, 1)]),
        [(50, 0), (150, 0), (170, 0), (190, 1), (190, 1)]
    );
    assert_eq!(bench.run(&[(0, 0), (0, 1), (100, 1)]), [(190, 1), (190, 0), (240, 0)]);
}

/// Proves: AMK-XFIPW-56, AMK-XFIPW-57, AMK-XFIPW-58, AMK-XFIPW-59, AMK-XFIPW-60
#[test]
fn inputs_switch_the_set_where_the_table_is_repeated() {
    let tables = [y(&[0, 100]), y(&[0, 200]), y(&[0, 300])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(3, &[]), 0);
    // E1 enables, E2 and E3 select: set 1 from the next zero on.
    assert_eq!(bench.run(&[(50, 0), (10, 0b011), (40, 0b011), (50, 0b011)]), [(50, 0), (60, 0), (100, 1), (200, 1)]);
    // Set 2, in one step over two zeros; set 3 is none.
    assert_eq!(bench.run(&[(200, 0b101), (50, 0b111), (50, 0b111)]), [(750, 1), (900, 0), (1050, 0)]);
    // Without enable it stays.
    assert_eq!(bench.run(&[(100, 0)]), [(1350, 0)]);
}

/// Proves: AMK-XFIPW-O7
#[test]
fn sets_are_whole() {
    let tables: Vec<Arc<Table>> = (0..8).map(|n| y(&[0, n])).collect();
    let refused = |count: usize, ba, more: &[(&str, i64)]| {
        xfipw(&tables[..count]).refused(&extended(ba, more)).map(|fault| fault.code)
    };
    let three = [("tables_total", 3), ("tables_start", 1)];
    assert_eq!(refused(6, 99, &three), None);
    assert_eq!(refused(7, 99, &three), Some(Code::AMK_TABLE_SETS));
    assert_eq!(refused(7, 98, &three), None);
    assert_eq!(refused(2, 99, &three), Some(Code::AMK_TABLES_FEW));
    assert_eq!(refused(8, 3, &[]), None);
}

/// Proves: AMK-XFIPW-92, AMK-XFIPW-97, AMK-XFIPW-122, AMK-XFIPW-123, AMK-XFIPW-16, AMK-XFIPW-24
#[test]
fn what_an_extended_mode_does_not_use_is_refused() {
    let (many, more): (Vec<i64>, Vec<i64>) = ((0..2000).collect(), (0..2001).collect());
    let places: Vec<(i64, i64)> = (0..1001).map(|i| (i, i)).collect();
    let one = |table: Arc<Table>, values: &[(&str, i64)]| xfipw(&[table]).refused(values).map(|fault| fault.code);
    assert_eq!(one(y(&many), &extended(2, &[])), None);
    assert_eq!(one(y(&more), &extended(2, &[])), Some(Code::AMK_CURVE_POINTS));
    assert_eq!(one(xy(&places[..1000]), &extended(2, &[("incr_per_rev", 0)])), None);
    assert_eq!(one(xy(&places), &extended(2, &[("incr_per_rev", 0)])), Some(Code::AMK_CURVE_POINTS));
    assert_eq!(one(xy(&[(0, 0), (49, 5)]), &extended(2, &[])), Some(Code::AMK_CURVE_LENGTH));
    assert_eq!(one(xy(&[(0, 0), (32_768, 5)]), &extended(2, &[])), Some(Code::AMK_CURVE_LENGTH));
    for (ba, name, value, code) in [
        (24, "mult", 1, Code::AMK_NO_MODE),
        (2, "function", 16, Code::AMK_MODE_FIELD),
        (26, "function", 8, Code::AMK_MODE_FIELD),
        (82, "function", 32, Code::AMK_MODE_FIELD),
        (2, "work_cycles", 2, Code::AMK_MODE_FIELD),
        (26, "tables_start", 1, Code::AMK_MODE_FIELD),
        (26, "master_offset", -1, Code::AMK_MODE_FIELD),
        (82, "stop_angle", 1, Code::AMK_MODE_FIELD),
        (2, "master_offset", 100, Code::AMK_BEYOND),
        (2, "master_offset", -100, Code::AMK_BEYOND),
        (98, "stop_angle", 100, Code::AMK_BEYOND),
    ] {
        assert_eq!(one(y(&[0, 1]), &extended(ba, &[(name, value)])), Some(code), "{ba} {name}");
    }
}

/// Values of a set of movement that any master may run.
fn sets() -> impl Strategy<Value = (Vec<Arc<Table>>, Vec<(&'static str, i64)>)> {
    let steps = || proptest::collection::vec(-900_i64..900, 1..6);
    let table = steps().prop_map(|steps| {
        let mut points = vec![0];
        steps.iter().for_each(|step| points.push(points[points.len() - 1] + step));
        y(&points)
    });
    (
        proptest::collection::vec(table, 3),
        prop::sample::select(vec![2_i64, 26, 82, 98]),
        (50_i64..90, 0_i64..3, -5_i64..6, 0_i64..4),
        (0_i64..50, 0_i64..50),
    )
        .prop_map(|(tables, mode, (length, starts, mult, div_exp), (start, stop))| {
            let mut values = vec![("mode", mode), ("mult", mult), ("div_exp", div_exp), ("increments_per_rev", length)];
            let several = mode == 82 || mode == 98;
            values.push(("table_count", if several { 3 } else { 1 }));
            if mode == 98 {
                values.extend([("start_tables", starts), ("stop_angle", stop)]);
            }
            if mode != 26 {
                values.push(("start_angle", start));
            }
            (tables, values)
        })
}

proptest! {
    /// A step of the master gives what its single increments give, as long as E1 is as it was, windows of more than their zero apart.
    #[test]
    fn steps_of_any_size_end_at_the_same_place(
        (tables, mut values) in sets(),
        calls in proptest::collection::vec((-400_i64..400, any::<bool>()), 1..30),
    ) {
        for (name, value) in &mut values {
            if name.ends_with("_angle") {
                *value = 0;
            }
        }
        let (mut far, mut near) = (fipw(&tables), fipw(&tables));
        far.start(&values, 0);
        near.start(&values, 0);
        for (way, e1) in calls {
            let e1 = u8::from(e1);
            // Inputs change while the master stands.
            prop_assert_eq!(far.step(0, e1), near.step(0, e1));
            // A movement that ends and waits for a start stands at another place in the middle of a step: it is compared going forward.
            let way = way.abs();
            let out = far.step(way, e1);
            let mut last = near.step(0, e1);
            for _ in 0..way {
                last = near.step(1, e1);
            }
            prop_assert_eq!((out.sink, out.outputs), (last.sink, last.outputs), "{:?} {:?}", far.function, near.function);
        }
    }

    /// Whatever a master does inside a movement, going back the same way ends at the same place.
    #[test]
    fn a_master_that_goes_back_retraces(
        (tables, values) in sets(),
        ways in proptest::collection::vec(-300_i64..300, 1..20),
    ) {
        let mut bench = fipw(&tables);
        bench.start(&values, 0);
        bench.step(0, 1);
        for way in ways {
            let before = (bench.sink, bench.step(0, 1).outputs);
            if bench.step(way, 1).outputs == before.1 && before.1 == 0 {
                let there = bench.sink;
                bench.step(-way, 1);
                prop_assert_eq!(bench.sink, before.0);
                bench.step(way, 1);
                prop_assert_eq!(bench.sink, there);
            }
        }
    }

    /// Nothing that may come panics, and the state is one that could have come about.
    #[test]
    fn no_master_and_no_input_is_too_much(
        (tables, values) in sets(),
        calls in proptest::collection::vec((any::<i64>(), any::<u8>(), proptest::option::of(any::<i64>())), 1..40),
    ) {
        let mut bench = fipw(&tables);
        bench.start(&values, 0);
        for (travel, inputs, mark) in calls {
            bench.travel = travel;
            bench.function.step(&bench.seen(inputs, mark));
            prop_assert!(bench.function.is_sound());
        }
    }
}

/// A call in which a mark lay so far back.
fn marked<P: Program>(bench: &mut Bench<'_, P>, way: i64, back: i64) -> Outcome {
    bench.travel += way;
    let outcome = bench.function.step(&bench.seen(0, Some(bench.travel - back)));
    bench.sink = outcome.sink;
    outcome
}

/// The oracle's set: FL 3000, D 2500, V 0, W 200.
fn registered<'a>(more: &[(&'a str, i64)]) -> Vec<(&'a str, i64)> {
    let set = [
        ("function", 1),
        ("increments_per_rev", 20_000),
        ("format_length", 3000),
        ("sensor_distance", 2500),
        ("valid_range", 200),
    ];
    by_way(2, &[&set[..], more].concat())
}

/// Proves: AMK-PMC-01, AMK-PMC-06, AMK-PMC-11, AMK-PMC-13, AMK-PMC-16, AMK-PMC-18, AMK-PMC-19, AMK-PMC-21, AMK-PMC-22, AMK-PMC-23, AMK-PMC-O1,
/// AMK-PMC-O2
#[test]
fn a_mark_that_is_late_lengthens_the_way() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    for (weight, total) in [(0, 200), (1, 100), (129, -100), (128, -200), (32, 0), (160 - 1, 0)] {
        let mut bench = fipw(&tables);
        bench.start(&registered(&[("weight", weight)]), 0);
        // At x = 3400 it is 10200 on the slave instead of 10000; W is 4000 there. It is told 100 inc later.
        let seen = marked(&mut bench, 3500, 100);
        assert_eq!((seen.sink, seen.deviation, seen.correction), (10_500, 200, 0), "{weight}");
        // SK 15000, LK 2500.
        let at = |bench: &mut Bench<'_, Fipw>, x: i64| {
            let out = bench.step(x - bench.travel, 0);
            assert_eq!(out.sink, 3 * x + out.correction, "{weight} {x}");
            out.correction
        };
        let parts = [15_000, 15_625, 16_250, 17_500, 19_999].map(|x| at(&mut bench, x));
        assert_eq!(parts, [0, total / 4, total / 2, total, total], "{weight}");
        // It stays, and no mark is no deviation.
        assert_eq!(at(&mut bench, 20_000 + 17_000), total);
        assert_eq!((at(&mut bench, 40_100), bench.step(0, 0).deviation), (total, 0));
    }
}

/// Proves: AMK-PMC-14, AMK-PMC-15, AMK-PMC-20
#[test]
fn a_mark_behind_the_window_waits_for_the_next_one() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let with = |more: &[(&'static str, i64)]| {
        let mut bench = fipw(&tables);
        bench.start(&registered(&[&[("corr_start", 1000), ("corr_length", 0)], more].concat()), 0);
        bench
    };
    let mut bench = with(&[]);
    assert_eq!(marked(&mut bench, 3500, 100).correction, 0);
    // LK = 0: all of it in the first call at SK or behind it. A second mark of the pass does not count.
    assert_eq!(marked(&mut bench, 1, 3).correction, 0);
    assert_eq!([16_400, 1000, 99, 1].map(|way| bench.step(way, 0).correction), [0, 0, 200, 200]);
    // Every second mark.
    let mut bench = with(&[("count_n", 2)]);
    let mut pass = || (marked(&mut bench, 3400, 0).correction, bench.step(16_600, 0).correction);
    assert_eq!([pass(), pass(), pass(), pass()], [(0, 0), (0, 0), (200, 200), (200, 200)]);
    // A step over the whole window.
    let mut bench = with(&[("corr_start", 18_000)]);
    assert_eq!((marked(&mut bench, 3400, 0).correction, bench.step(40_000, 0).correction), (0, 200));
}

/// Proves: AMK-PMC-24
#[test]
fn a_correction_stands_behind_the_compensation_or_before_it() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let shares = [1, 3].map(|function| {
        let mut bench = fipw(&tables);
        bench.start(&registered(&[("function", function), ("sak", 128)]), 0);
        marked(&mut bench, 3400, 0);
        bench.step(11_600, 0);
        // 625 inc: 1875 of the table, 50 of the correction.
        bench.step(625, 0).sak_share
    });
    assert_eq!(shares, [1875, 1925]);
}

/// Proves: AMK-PMC-03, AMK-PMC-05, AMK-PMC-12
#[test]
fn marks_have_modes_and_bounds() {
    let tables = [y(&[0, 1000])];
    let field = |name: &str| fipw::FIELDS.iter().position(|field| field.name == name).map(|place| place as u16);
    let of = |more: &[(&str, i64)]| fipw(&tables).refused(&registered(more)).map(|fault| (fault.code, fault.field));
    assert_eq!(of(&[]), None);
    assert_eq!(of(&[("mode", 98)]), None);
    for more in [&[("mode", 82)][..], &[("mode", 26)], &[("function", 5)], &[("function", 2)]] {
        assert_eq!(of(more), Some((Code::AMK_MODE_FIELD, field("function"))), "{more:?}");
    }
    for (name, value) in [
        ("format_length", 0),
        ("sync_shift", 3000),
        ("valid_range", 1501),
        ("corr_start", 20_001),
        ("corr_length", 20_001),
        ("weight", 33),
        ("weight", 160),
    ] {
        assert_eq!(of(&[(name, value)]), Some((Code::AMK_BEYOND, field(name))), "{name}");
    }
    let words = set(fipw::FIELDS, &registered(&[]));
    let bench = fipw(&tables);
    let blind = Setting { has_mark: false, ..setting(bench.call_ns, bench.found()) };
    assert_eq!(bench.function.check(Words(&words), &blind).map_err(|fault| fault.code), Err(Code::AMK_NO_ZERO_PULSE));
}

/// Proves: AMK-XFIPW-69, AMK-XFIPW-72, AMK-XFIPW-73, AMK-XFIPW-74, AMK-XFIPW-76, AMK-XFIPW-77, AMK-XFIPW-81, AMK-XFIPW-87, AMK-XFIPW-O8
#[test]
fn the_extended_control_tells_valid_marks_and_takes_other_values_while_it_runs() {
    let tables = [xy(&[(0, 0), (10_000, 15_000), (20_000, 30_000)])];
    let values = |more: &[(&'static str, i64)]| {
        let set = [
            ("function", 1),
            ("incr_per_rev", 0),
            ("format_length", 3000),
            ("sensor_distance", 1000),
            ("valid_range", 200),
        ];
        extended(2, &[&set[..], more].concat())
    };
    let tables = [xy(&[(0, 0), (19_000, 28_500), (20_000, 30_000)]), tables[0].clone()];
    // Its points are too far apart for a table: it takes more of them.
    assert_eq!(xfipw(&tables[..1]).refused(&values(&[])).map(|fault| fault.code), None);
    for (weight, total) in [(0, 400), (1, 200), (129, -200), (32, 0)] {
        let mut bench = xfipw(&tables[..1]);
        bench.start(&values(&[("corr_weight", weight)]), 0);
        assert_eq!(marked(&mut bench, 13_600, 0).deviation, 400);
        assert_eq!([1400, 2500, 2499].map(|way| bench.step(way, 0).correction), [0, total, total]);
        let out = bench.step(1, 0);
        assert_eq!((out.outputs, out.writes, out.deviation), (1, 1, 400));
        // 17998.5 lies outside 18000 to 22000.
        marked(&mut bench, 11_999, 0);
        let out = bench.step(8001, 0);
        assert_eq!((out.outputs, out.deviation, out.correction), (0, 0, total));
        // The place of the mark is moved by 50 units of 10 inc.
        let words = set(xfipw::FIELDS, &values(&[("corr_weight", weight), ("sync_shift", 50)]));
        bench.function.renew(Words(&words));
        assert_eq!(marked(&mut bench, 13_600, 0).deviation, -100);
    }
}

/// A run of marks, each at its own place: the deviation of the last thousand passes, at worst.
#[test]
fn marks_that_drift_are_held_in_register() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let mut bench = fipw(&tables);
    bench.start(&registered(&[("weight", 1)]), 0);
    // Each format is 60 inc longer than the table's way: the sensor sees the marks of the material, which the slave moves.
    let (mut next, mut worst) = (10_000_i64, 0);
    for call in 0..200_000 {
        let before = bench.sink;
        bench.travel += 100;
        let place = next - before;
        // The slave makes 300 inc in a call, a correction apart: the mark is where the material is at its place.
        let mark = (0..300).contains(&place).then(|| bench.travel - 100 + place / 3);
        let outcome = bench.function.step(&bench.seen(0, mark));
        bench.sink = outcome.sink;
        if mark.is_some() {
            next += 60_060;
            if call > 100_000 {
                worst = worst.max(outcome.deviation.abs());
            }
        } else if place < 0 {
            next += 60_060;
        }
    }
    // Half of the deviation is corrected in each pass, 60 inc come anew: twice of them stay.
    assert!((100..=140).contains(&worst), "{worst}");
}

/// Proves: AMK-FIPW-13, AMK-FIPW-14, AMK-FIPW-25, AMK-FIPZ-06, AMK-FIPZ-07, AMK-FIPZ-08, AMK-FIPZ-09, AMK-FIPZ-10, AMK-FIPZ-11, AMK-FIPZ-12,
/// AMK-FIPZ-13, AMK-FIPZ-15, AMK-XFIPW-89, AMK-XFIPW-90, AMK-XFIPW-91, AMK-XFIPW-93, AMK-XFIPW-94, AMK-XFIPW-95, AMK-XFIPW-96, AMK-XFIPW-98,
/// AMK-XFIPW-99, AMK-XFIPW-100, AMK-XFIPW-101, AMK-XFIPW-102, AMK-XFIPW-104, AMK-XFIPW-105, AMK-XFIPW-107, AMK-XFIPW-108, AMK-XFIPW-109,
/// AMK-XFIPW-110, AMK-XFIPW-111, AMK-XFIPW-112, AMK-XFIPW-113, AMK-XFIPW-114, AMK-XFIPW-115, AMK-XFIPW-117, AMK-XFIPW-118,
/// AMK-XFIPW-119, AMK-XFIPW-120
#[test]
fn sets_have_the_fields_of_the_source() {
    let of = |fields: &[Field]| {
        let row = |field: &Field| format!("{} {} {} {}", field.name, field.min, field.max, field.count);
        fields.iter().map(row).collect::<Vec<_>>()
    };
    assert_eq!(
        of(fipw::FIELDS)[..14],
        [
            "function 0 7 1",
            "mode 0 132 1",
            "sak 0 32767 1",
            "sf_cycle 0 32767 1",
            "table_count 1 8 1",
            "start_tables 0 7 1",
            "div_exp 0 15 1",
            "sync_md_addr 0 0 1",
            "mult -32768 32767 1",
            "increments_per_rev 0 32767 1",
            "cycle_time 0 1073676289 1",
            "master_offset 0 1073676288 1",
            "start_angle 0 1073676288 1",
            "stop_angle 0 1073676288 1",
        ]
    );
    assert_eq!(
        of(fipz::FIELDS),
        [
            "mode 16 17 1",
            "sak 0 32767 1",
            "sf_cycle 0 32767 1",
            "table_count 1 8 1",
            "div_exp 0 15 1",
            "mult 1 32767 1",
            "cycle_time 0 32767 8",
        ]
    );
    assert_eq!(
        of(xfipw::FIELDS),
        [
            "function 0 63 1",
            "ba 0 133 1",
            "sak_factor 0 32767 1",
            "sf_cycle 0 32767 1",
            "tables_total 1 8 1",
            "tables_start 0 7 1",
            "div_exp 0 15 1",
            "ext_sync_md 0 0 1",
            "work_cycles 0 255 1",
            "mult -32768 32767 1",
            "incr_per_rev 0 32767 1",
            "cycle_time 0 32767 1",
            "master_offset -32767 32767 1",
            "start_angle 0 32767 1",
            "stop_angle 0 32767 1",
            "format_length 0 32767 1",
            "sensor_distance 0 2147483647 1",
            "sync_shift 0 32766 1",
            "valid_range 0 16383 1",
            "corr_start 0 32767 1",
            "corr_len 0 32767 1",
            "corr_md 0 0 1",
            "corr_weight 0 255 1",
            "corr_every 0 255 1",
            "output_value -2147483648 2147483647 1",
        ]
    );
}

/// Proves: AMK-XFIPW-28, AMK-XFIPW-38, AMK-XFIPW-34, AMK-XFIPW-43
#[test]
fn a_sequence_repeats_its_working_table_and_a_last_one_ends_with_its_pass() {
    let tables = [y(&[0, 10]), y(&[0, 100]), y(&[0, 30])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(82, &[("tables_total", 3), ("tables_start", 1), ("work_cycles", 2)]), 0);
    // The edge is kept while E1 falls again; a table, the working one twice, the last one.
    let calls = [(40, 1), (30, 0), (30, 0), (100, 0), (100, 0), (100, 0), (50, 0), (50, 0), (100, 0)];
    let wanted = [(0, 1), (0, 1), (0, 0), (10, 0), (110, 0), (210, 0), (225, 0), (240, 1), (240, 1)];
    assert_eq!(bench.run(&calls), wanted);
    // Without stop tables a window ends nothing: the pass is run to its end.
    let mut bench = xfipw(&tables[..2]);
    bench.start(&extended(98, &[("tables_total", 2), ("tables_start", 1), ("stop_angle", 60)]), 0);
    assert_eq!(
        bench.run(&[(0, 1), (100, 1), (50, 0), (49, 0), (1, 0)]),
        [(0, 0), (10, 0), (60, 0), (109, 0), (110, 1)]
    );
}

/// Proves: AMK-XFIPW-30, AMK-XFIPW-31, AMK-XFIPW-32, AMK-XFIPW-33, AMK-XFIPW-106
#[test]
fn modes_by_time_are_those_by_way_with_the_calls_as_master() {
    let tables = [y(&[0, 10]), y(&[0, 100]), y(&[0, 30])];
    let several = [("tables_total", 3), ("tables_start", 1)];
    for (way, time, more) in
        [(2, 4, &[][..]), (26, 132, &[("work_cycles", 3)]), (82, 84, &several), (98, 100, &several)]
    {
        let values = |ba, length: (&'static str, i64)| {
            let mut values = extended(ba, more);
            values.retain(|(name, _)| *name != "incr_per_rev");
            values.push(length);
            values
        };
        // 25 half milliseconds in calls of 2; the same as 50 inc in steps of 4.
        let (mut by_way, mut by_time) = (xfipw(&tables), xfipw(&tables));
        by_way.start(&values(way, ("incr_per_rev", 50)), 0);
        by_time.start(&values(time, ("cycle_time", 25)), 0);
        for call in 0..200_i64 {
            let e1 = u8::from(call % 70 > 8 && call % 70 < 40);
            let (a, b) = (by_way.step(4, e1), by_time.step(0, e1));
            assert_eq!((a.sink, a.outputs), (b.sink, b.outputs), "{time}: call {call}");
        }
        assert_ne!(by_time.sink, 0, "{time}");
    }
}

/// Proves: AMK-XFIPW-35, AMK-XFIPW-36
#[test]
fn windows_are_those_of_the_tables_that_they_belong_to() {
    // A turn of 100 clocks in, one of 200 works, one of 60 clocks out.
    let tables = [xy(&[(0, 0), (100, 50)]), xy(&[(0, 0), (200, 200)]), xy(&[(0, 0), (60, 30)])];
    let values =
        [("tables_total", 3), ("tables_start", 1), ("incr_per_rev", 0), ("start_angle", 20), ("stop_angle", 150)];
    let mut bench = xfipw(&tables);
    bench.start(&extended(98, &values), 0);
    // x = 20 lies in the window; 10 of 50 are caught up.
    assert_eq!(bench.run(&[(20, 0), (0, 1), (80, 1)]), [(0, 1), (10, 0), (50, 0)]);
    // x = 150 of the working table, then E1 = 0: that is 30 of the stop table.
    assert_eq!(bench.run(&[(150, 1), (0, 0), (30, 0)]), [(200, 0), (65, 0), (80, 1)]);
    assert_eq!(
        xfipw(&tables).refused(&extended(98, &[&values[..4], &[("stop_angle", 200)]].concat())).map(|fault| fault.code),
        Some(Code::AMK_BEYOND)
    );
}

/// Proves: AMK-XFIPW-41, AMK-XFIPW-42, AMK-XFIPW-61
#[test]
fn an_extended_movement_waits_for_the_zero_of_its_master() {
    let tables = [y(&[0, 1000])];
    let mut bench = xfipw(&tables);
    bench.start(&extended(26, &[("function", 4)]), 0);
    // No movement before the pulse, and the edge has to come behind it.
    assert_eq!(bench.run(&[(30, 1), (30, 0)]), [(0, 1), (0, 1)]);
    marked(&mut bench, 10, 5);
    assert_eq!(bench.run(&[(0, 1), (10, 1)]), [(0, 0), (100, 0)]);
    // Set on at the pulse: only what the master goes behind it moves the slave.
    let mut bench = xfipw(&tables);
    bench.start(&extended(2, &[("function", 12), ("master_offset", 40)]), 0);
    assert_eq!((bench.step(30, 0).sink, marked(&mut bench, 10, 4).sink, bench.step(6, 0).sink), (0, 40, 100));
}

/// Proves: AMK-XFIPW-75, AMK-XFIPW-79
#[test]
fn the_extended_control_counts_marks_and_has_both_places() {
    let tables = [y(&[0, 20_000, 40_000, 60_000])];
    let set = |more: &[(&'static str, i64)]| {
        let set = [
            ("function", 1),
            ("incr_per_rev", 20_000),
            ("format_length", 3000),
            ("sensor_distance", 2500),
            ("corr_start", 4000),
        ];
        extended(2, &[&set[..], more].concat())
    };
    let mut bench = xfipw(&tables);
    bench.start(&set(&[("corr_every", 3)]), 0);
    let passes: Vec<_> = (0..4).map(|_| (marked(&mut bench, 3400, 0), bench.step(16_600, 0).correction).1).collect();
    assert_eq!(passes, [0, 0, 200, 200]);
    let shares = [1, 3].map(|function| {
        let mut bench = xfipw(&tables);
        bench.start(&set(&[("function", function), ("sak_factor", 256)]), 0);
        marked(&mut bench, 3400, 0);
        bench.step(600, 0).sak_share
    });
    assert_eq!(shares, [3600, 4000]);
}

/// Proves: AMK-FIPW-O6, AMK-PMC-04, AMK-SYNC-03, AMK-XFIPW-70, AMK-XFIPW-125
#[test]
fn the_set_of_the_manual_is_one_on_a_source_with_marks() {
    let tables = [y(&[0, 300]), y(&[0, 3000]), y(&[0, 300])];
    let set_of_it = [
        ("function", 1),
        ("mode", 98),
        ("sf_cycle", 4),
        ("table_count", 3),
        ("start_tables", 1),
        ("mult", 1),
        ("increments_per_rev", 20_000),
        ("format_length", 3000),
        ("sensor_distance", 1000),
        ("valid_range", 200),
        ("corr_start", 5000),
        ("corr_length", 10_000),
    ];
    let mut bench = fipw(&tables);
    bench.call_ns = 2_000_000;
    assert_eq!(bench.refused(&set_of_it), None);
    let words = set(fipw::FIELDS, &set_of_it);
    let without = |has_source, has_mark| {
        let setting = Setting { has_source, has_mark, ..setting(bench.call_ns, bench.found()) };
        bench.function.check(Words(&words), &setting).map_err(|fault| fault.code)
    };
    assert_eq!(without(true, false), Err(Code::AMK_NO_ZERO_PULSE));
    assert_eq!(without(false, false), Err(Code::AMK_NO_SOURCE));
}

/// Proves: AMK-XFIPW-02, AMK-XFIPW-03, AMK-XFIPW-04, AMK-XFIPW-23, AMK-TAB-04
#[test]
fn eight_tables_of_both_forms_run_one_after_the_other() {
    let tables: Vec<Arc<Table>> = (1..=8)
        .map(|n| if n % 2 == 0 { y(&[0, 5 * n, 10 * n]) } else { xy(&[(0, 0), (30, 5 * n), (50 * n, 10 * n)]) })
        .collect();
    let mut bench = xfipw(&tables);
    bench.start(&extended(82, &[("tables_total", 8), ("tables_start", 7), ("incr_per_rev", 60)]), 0);
    bench.step(0, 1);
    let mut ends = Vec::new();
    for n in 1..=8 {
        ends.push(bench.step(if n % 2 == 0 { 60 } else { 50 * n }, 0).sink);
    }
    assert_eq!(ends, [10, 30, 60, 100, 150, 210, 280, 360]);
    assert_eq!(bench.step(0, 0).outputs, 1);
}

/// Proves: AMK-XFIPW-17, AMK-XFIPW-19, AMK-XFIPW-21, AMK-XFIPW-22, AMK-XFIPW-71, AMK-XFIPW-82, AMK-XFIPW-85, AMK-XFIPW-124, AMK-XFIPW-126
#[test]
fn tables_and_marks_of_the_extended_type_have_their_ranges() {
    // The largest table: 2000 points of 32767 inc each.
    let high: Vec<i64> = (0..2000).map(|i| i * 32_767).collect();
    let one = |table: Arc<Table>, values: &[(&str, i64)]| xfipw(&[table]).refused(values).map(|fault| fault.code);
    assert_eq!(one(y(&high), &extended(2, &[])), None);
    assert_eq!(one(xy(&[(0, 0), (32_767, -32_767)]), &extended(2, &[("incr_per_rev", 0)])), None);
    assert_eq!(
        one(Arc::new(Table::new(Form::Words, &[], &[3, 0]).expect("words")), &extended(2, &[])),
        Some(Code::AMK_CURVE_FORM)
    );
    // By time a last place of 1 is long enough.
    let time = [("ba", 4), ("mult", 1), ("tables_total", 1)];
    assert_eq!(one(xy(&[(0, 0), (1, 5)]), &time), None);
    // Format and sensor alone are enough for marks; sak may be 0. Not by time, not with sets.
    let marks = [("function", 1), ("format_length", 3000), ("sensor_distance", 1000)];
    for (ba, code) in [(2, None), (26, None), (82, None), (98, None), (3, Some(Code::AMK_MODE_FIELD))] {
        assert_eq!(one(y(&[0, 1000]), &extended(ba, &marks)), code, "{ba}");
    }
    assert_eq!(
        one(y(&[0, 1000]), &[&time[..], &marks[..1], &[("cycle_time", 9)]].concat()),
        Some(Code::AMK_MODE_FIELD)
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Over a million periods, in steps that fit none, with sets that inputs change, the slave has made what the ends of the tables come to.
    #[test]
    fn a_million_periods_lose_nothing(
        ends in proptest::collection::vec(-32_767_i64..=32_767, 3),
        (mult, div_exp) in (-32_768_i64..=32_767, 0_i64..16),
        (length, step) in (50_i64..32_768, 1_i64..300),
    ) {
        let tables: Vec<Arc<Table>> = ends.iter().map(|end| y(&[0, end / 2, *end])).collect();
        let mut bench = xfipw(&tables);
        let fits = ends.iter().all(|end| end.abs() * mult.abs() >> div_exp < (1 << 31) - 1);
        prop_assume!(fits);
        bench.start(&extended(3, &[("incr_per_rev", length), ("mult", mult), ("div_exp", div_exp)]), 0);
        let (mut sum, mut set, mut periods) = (0_i128, 0_usize, 0_i64);
        while periods < 1_000_000 {
            let wanted = (periods / 7 % 4) as usize;
            let inputs = if wanted < 3 { 1 | (wanted as u8) << 1 } else { 0 };
            // To a zero, by so many periods; the set changes at the first of them.
            bench.step(step * length, inputs);
            let first = set;
            set = if wanted < 3 { wanted } else { set };
            sum += i128::from(ends[first]) + i128::from(ends[set]) * i128::from(step - 1);
            periods += step;
            let exact = (sum * i128::from(mult)).div_euclid(1 << div_exp);
            prop_assert_eq!(i128::from(bench.sink), exact, "after {} periods", periods);
        }
        // All the way back with the last set.
        bench.step(-step * length, 0);
        let exact = ((sum - i128::from(ends[set]) * i128::from(step)) * i128::from(mult)).div_euclid(1 << div_exp);
        prop_assert_eq!(i128::from(bench.sink), exact);
    }
}

//! Tests of interpolators: oracles, and comparison with single increments.

use super::fipw::{self, Fipw};
use super::fipz::{self, Fipz};
use super::xfipw::{self, Xfipw};
use crate::code::Code;
use crate::function::field::{Field, Words};
use crate::function::program::{CallInputs, LINES, Outcome, SlotType};
use crate::function::program::{Fault, Setting, SourceValue};
use crate::function::trial::{as_tables, at_rest, set, setting};
use crate::table::{Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

mod fipw_oracles;
mod fipz_oracles;
mod laws;
mod marks;
mod xfipw_oracles;

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

/// A function with its tables, and the position of its master.
struct Bench<'a, P> {
    function: P,
    fields: &'static [Field],
    tables: &'a [Arc<Table>],
    call_ns: u64,
    travel: i64,
    sink: i64,
}

impl<'a, P: SlotType> Bench<'a, P> {
    fn of(function: P, fields: &'static [Field], tables: &'a [Arc<Table>]) -> Self {
        Self { function, fields, tables, call_ns: 2 * HALF, travel: 0, sink: 0 }
    }

    /// Returns Tab0 to Tab7.
    fn found(&self) -> [Option<&Table>; LINES] {
        std::array::from_fn(|place| self.tables.get(place).map(|table| &**table))
    }

    fn refused(&self, values: &[(&str, i64)]) -> Option<Fault> {
        let words = set(self.fields, values);
        self.function.check(Words(&words), &setting(self.call_ns, self.found())).err()
    }

    fn seen(&self, inputs: u8, mark: Option<i64>) -> CallInputs<'a> {
        let source = SourceValue { value: self.travel, travel: self.travel, mark };
        CallInputs {
            call_ns: self.call_ns,
            source,
            inputs,
            sink: self.sink,
            tables: as_tables(self.tables),
            ..at_rest()
        }
    }

    fn start(&mut self, values: &[(&str, i64)], inputs: u8) -> Outcome {
        assert_eq!(self.refused(values), None);
        let words = set(self.fields, values);
        let outcome = self.function.start(Words(&words), &self.seen(inputs, None));
        self.sink = outcome.sink;
        outcome
    }

    /// Executes a call after a travel of the master.
    fn step(&mut self, way: i64, inputs: u8) -> Outcome {
        self.travel += way;
        let outcome = self.function.step(&self.seen(inputs, None));
        self.sink = outcome.sink;
        outcome
    }

    /// Returns sink and A1 of calls, each after a travel of the master and with these inputs.
    fn run(&mut self, calls: &[(i64, u8)]) -> Vec<(i64, u8)> {
        calls.iter().map(|(way, inputs)| self.step(*way, *inputs)).map(|out| (out.sink, out.outputs)).collect()
    }
}

fn fipw(tables: &[Arc<Table>]) -> Bench<'_, Fipw> {
    Bench::of(Fipw::default(), fipw::FIELDS, tables)
}

fn fipz(tables: &[Arc<Table>]) -> Bench<'_, Fipz> {
    Bench::of(Fipz::default(), fipz::FIELDS, tables)
}

fn xfipw(tables: &[Arc<Table>]) -> Bench<'_, Xfipw> {
    Bench::of(Xfipw::default(), xfipw::FIELDS, tables)
}

/// A set of fipw by travel, with one table unless `more` changes it.
fn by_way<'a>(mode: i64, more: &[(&'a str, i64)]) -> Vec<(&'a str, i64)> {
    let mut values = vec![("mode", mode), ("mult", 1), ("table_count", 1), ("increments_per_rev", 100)];
    for (name, value) in more {
        values.retain(|(known, _)| known != name);
        values.push((name, *value));
    }
    values
}

fn extended<'a>(ba: i64, more: &[(&'a str, i64)]) -> Vec<(&'a str, i64)> {
    let mut values = vec![("ba", ba), ("mult", 1), ("tables_total", 1), ("incr_per_rev", 100)];
    for (name, value) in more {
        values.retain(|(known, _)| known != name);
        values.push((name, *value));
    }
    values
}

/// Executes a call with a mark that is `back` increments behind.
fn marked<P: SlotType>(bench: &mut Bench<'_, P>, way: i64, back: i64) -> Outcome {
    bench.travel += way;
    let outcome = bench.function.step(&bench.seen(0, Some(bench.travel - back)));
    bench.sink = outcome.sink;
    outcome
}

/// The set of the oracle: FL 3000, D 2500, V 0, W 200.
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

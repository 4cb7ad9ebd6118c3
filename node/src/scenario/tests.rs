//! Tests scenarios by their reports, and the exact text of their errors.

mod contract;
mod coordinate;
mod drives;
mod events;
mod expectations;
mod files;
mod homing;
mod latches;
mod moments;
mod plan;
mod probe;
mod problems;
mod recorded;
mod saved;
mod shares;
mod steps;
mod touch_probe;
mod traces;
mod trajectory;
mod verbs;
mod vocabulary;

use super::{Options, Player, Report, Scenario, simulate};
use crate::cell::Cell;
use lineshaft_core::drive::Backend;
use lineshaft_core::machine::{MAX_COMMANDS, Machine};
use std::path::Path;

/// x and y: 1000 inc/mm, default 50 mm/s and 500 mm/s^2, so that 10 mm take 100 ms of acceleration, 100 ms at constant
/// speed and 100 ms of deceleration.
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  start: {type: di, backend: plant, address: 0}
  mark: {type: di, backend: plant, address: 1, latch: true}
  lamp: {type: do, backend: plant, address: 0}
  level: {type: ai, backend: plant, address: 0}
memory:
  feed: {type: i16, initial: 7}
  gain: {type: f64, initial: 0.5}
  flag: {type: bit, initial: 0}
encoders:
  belt: {backend: plant, address: 0, bits: 16, type: linear, scale: {increments: 40, per: 1 mm}}
axes:
  line: {type: linear, drive: virtual, scale: {increments: 1000000, per: 1 m}, max_velocity: 3 m/s, max_acceleration: 5 m/s^2}
  x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0, interface: position},
      min_position: -50 mm, max_position: 850 mm, max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, error_reaction: 2,
      max_following_error: 10 mm, sim: {model: ideal}}
  turret: {type: rotary, unit: deg, modulo: 360 deg, scale: {increments: 36000, per: 360 deg}, error_reaction: 2,
      drive: {backend: plant, address: 1, interface: position}, max_velocity: 90 deg/s, max_acceleration: 360 deg/s^2,
      sim: {model: ideal}}
";

fn cell() -> Cell {
    Cell::parse("cell.yaml", CELL).unwrap_or_else(|problems| panic!("{problems}"))
}

fn scenario(text: &str) -> Scenario {
    Scenario::parse("s.yaml", text, &cell()).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Returns the problems of a scenario, without the file name.
fn problems(text: &str) -> String {
    let problems = Scenario::parse("s.yaml", text, &cell()).expect_err("this scenario has errors");
    problems.to_string().replace("s.yaml:", "")
}

/// Returns the problem of one item of a section; `^` marks its location.
fn problem(section: &str, item: &str) -> String {
    let item_text = item.replacen('^', "", 1);
    let text = problems(&format!("{{scenario: s, cycles: 100, {section}: [\n\n{item_text}]}}"));
    let place = item.find('^').unwrap_or_else(|| panic!("no mark in {item}")) + 1;
    text.trim_end().strip_prefix(&format!("3:{place}: ")).unwrap_or_else(|| panic!("{item}: {text}")).to_owned()
}

fn run(text: &str) -> Report {
    let (cell, scenario) = (cell(), scenario(text));
    let report = simulate(&cell, &scenario, &Options::default()).unwrap();
    assert!(report.wall.is_some());
    recorded::plays_the_same_as_json(&cell, &scenario);
    Report { wall: None, ..report }
}

fn passes(text: &str) {
    let report = run(text);
    assert!(report.passed(), "{report}");
}

/// Returns the messages of all failures, each with its line.
fn failures(text: &str) -> Vec<String> {
    let report = run(text);
    report.failures.iter().map(|failure| format!("{}: {}", failure.place.line, failure.sentence)).collect()
}

/// Returns the only failure of a scenario of 1000 cycles, without its line.
fn failure(rest: &str) -> String {
    let all = failures(&format!("scenario: s\ncycles: 1000\n{rest}"));
    assert_eq!(all.len(), 1, "{all:?}");
    all[0].split_once(": ").unwrap().1.to_owned()
}

/// Returns the trace of a scenario.
fn trace(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.csv");
    let options = Options { csv: Some(path.clone()), progress: true, ..Options::default() };
    let (cell, scenario) = (cell(), scenario(text));
    let report = simulate(&cell, &scenario, &options).unwrap();
    assert!(report.passed(), "{report}");
    recorded::plays_the_same_as_json(&cell, &scenario);
    std::fs::read_to_string(path).unwrap()
}

/// Returns the values of one signal in every cycle.
fn values(signal: &str, cycles: u64, rest: &str) -> Vec<String> {
    let csv = trace(&format!("scenario: s\ncycles: {cycles}\ntrace: [{signal}]\n{rest}"));
    csv.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().to_owned()).collect()
}

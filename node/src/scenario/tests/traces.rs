//! Tests traces as CSV, byte for byte.

use super::*;
use crate::interrupt::{EndSignal, Interrupt};

#[test]
fn a_trace_is_exact_to_the_byte() {
    let text = "scenario: s\ncycles: 3\ntrace: [level, feed, line.state, 'line.command.v*']\n\
                drive: [{signal: level, values: [0.1, -1e-9, 123456789012345680000]}, {signal: feed, at: 1, values: [-5]}]";
    assert_eq!(
        trace(text),
        "cycle,time_s,level,feed,line.state,line.command.velocity\n\
         0,0,0.1,7,1,0.0\n\
         1,0.001,-1e-9,-5,1,0.0\n\
         2,0.002,1.2345678901234568e20,-5,1,0.0\n"
    );
}

#[test]
fn signals_stand_in_board_order_and_globs_match_across_dots() {
    let head = |globs: &str| {
        let text = format!("scenario: s\ncycles: 1\ntrace: {globs}");
        trace(&text).lines().next().unwrap().to_owned()
    };
    assert_eq!(head("[machine.error, start]"), "cycle,time_s,start,machine.error");
    assert_eq!(
        head("['*.command.position', 'x.command.*', x.command.position]").matches("x.command.position").count(),
        1
    );
    let x = head("['x.*']");
    assert!(x.contains(",x.state,") && x.contains(",x.limit.software_negative,") && !x.contains("line"), "{x}");
    assert_eq!(head("['{start,mark}', 'f???']"), "cycle,time_s,start,mark,feed,flag");
    assert_eq!(head("[]"), "cycle,time_s");
    let all = trace("scenario: s\ncycles: 1");
    let signals = Machine::new(cell().machine).unwrap().directory().len();
    assert_eq!(all.lines().next().unwrap().split(',').count(), signals + 2);
}

#[test]
fn every_nth_cycle_is_traced() {
    let cycles = |every: &str| {
        let csv = trace(&format!("scenario: s\ncycles: 8\ntrace: [start]\nevery: {every}"));
        csv.lines().skip(1).map(|row| row.split(',').next().unwrap().to_owned()).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(cycles("3"), "0 3 6");
    assert_eq!(cycles("2 ms"), "0 2 4 6");
}

/// A scenario with all sources of values, second-order drives, moves and gears.
const BUSY: &str = "
scenario: busy
cycles: 2500
drive:
  - {signal: belt.count, ramp: {per_cycle: 7/3}}
  - {signal: level, sine: {mean: 1, amplitude: 3.3, period: 77.7 ms}}
steps:
  - {at: 0, do: {enable: {}}}
  - {at: 50, do: {move_axis: {axis: x, position: 40 mm}}}
  - {at: 60, do: {synchronize: {axis: turret, master: belt, mode: position, numerator: 1, denominator: 3}}}
  - {at: 300, do: {move_axis: {axis: x, mode: velocity, velocity: 33 mm/s}}}
";

#[test]
fn the_same_run_is_the_same_file() {
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml")).unwrap();
    let text = format!(
        "{text}\nencoders:\n  belt: {{backend: plant, address: 0, bits: 16, type: linear, scale: {{increments: 40, per: 1 mm}}}}\nio:\n  level: {{type: ai, backend: plant, address: 0}}\n"
    );
    let cell = Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str| {
        let path = folder.path().join(name);
        let scenario = Scenario::parse("busy.yaml", BUSY, &cell).unwrap();
        let options = Options { csv: Some(path.clone()), ..Options::default() };
        assert!(simulate(&cell, &scenario, &options).unwrap().passed());
        std::fs::read(path).unwrap()
    };
    let (first, second) = (run("first.csv"), run("second.csv"));
    assert!(first.len() > 500_000, "{} bytes", first.len());
    assert_eq!(first, second);
    assert!(!first.contains(&b'\r') && first.ends_with(b"\n"));
}

#[test]
fn a_trace_that_cannot_be_written_is_a_clear_error() {
    let error = |path: &str| {
        let options = Options { csv: Some(path.into()), ..Options::default() };
        let text = "scenario: s\ncycles: 20000\ntrace: ['*']";
        simulate(&cell(), &scenario(text), &options).unwrap_err().to_string()
    };
    let missing = error("no/such/folder/t.csv");
    assert!(missing.starts_with("cannot write the trace no/such/folder/t.csv: No such file"), "{missing}");
    if Path::new("/dev/full").exists() {
        let full = error("/dev/full");
        assert!(full.starts_with("cannot write the trace /dev/full: No space left"), "{full}");
    }
}

/// A signal before the first cycle: no cycle runs, and the file has its header.
#[test]
fn interrupted_simulation_ends_before_its_next_cycle_and_completes_the_trace() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.csv");
    let interrupt = Interrupt::default();
    interrupt.request(EndSignal::Terminate);
    let options = Options { csv: Some(path.clone()), interrupt, ..Options::default() };
    let text = "scenario: s\ncycles: 1000\ntrace: [line.state]";
    let error = simulate(&cell(), &scenario(text), &options).unwrap_err().to_string();
    let expected =
        "interrupted by SIGTERM after 0 cycles (0 s) of 1000 cycles (1 s); no expectation was judged".to_owned();
    assert_eq!(error, expected);
    assert_eq!(std::fs::read_to_string(path).unwrap(), "cycle,time_s,line.state\n");
}

#[test]
fn what_a_trace_may_not_ask_is_refused() {
    let bad = |rest: &str| problems(&format!("scenario: s\ncycles: 9\n{rest}"));
    assert_eq!(bad("trace: [x.stat]"), "3:9: no signal matches `x.stat`, did you mean `x.state`?\n");
    assert_eq!(bad("trace: [start, 'z.*']"), "3:16: no signal matches `z.*`\n");
    assert!(bad("trace: ['a[']").starts_with("3:9: trace[0] is no pattern: "), "{}", bad("trace: ['a[']"));
    assert_eq!(bad("trace: start"), "3:8: trace is `start`; a list is expected\n");
    assert_eq!(bad("every: 0"), "3:8: every is 0; 1..1000000000000 is allowed\n");
}

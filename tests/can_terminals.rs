//! Inputs, outputs and encoders at CANopen modules that somebody else has written, in a cell of the program.

mod support;

use std::thread;
use std::time::{Duration, Instant};
use support::can::{CanDrives, Way};
use support::can_cell::{CanCell, CanRun, PATIENCE, axis};

/// The word of an object, as the device has it.
fn object(devices: &mut CanDrives, node: u8, index: u16, sub: u8) -> i64 {
    devices.tell(&format!("get {node} {index:#x} {sub}"))["value"].as_i64().expect("a number")
}

/// Waits until the devices are as asked for.
#[track_caller]
fn until(run: &CanRun, devices: &mut CanDrives, holds: impl Fn(&mut CanDrives) -> bool) {
    let begin = Instant::now();
    while !holds(devices) {
        assert!(begin.elapsed() < PATIENCE, "{}", run.program.log());
        thread::sleep(Duration::from_millis(10));
    }
}

const SECTIONS: &str = "io:
  start: {type: di, backend: bus0, node: 10, address: 9}
  probe: {type: di, backend: bus0, node: 1, address: 17}
  lamp: {type: do, backend: bus0, node: 10, address: 3}
  valve: {type: do, backend: bus0, node: 1, address: 16}
  pressure: {type: ai, backend: bus0, node: 10, address: 2, full_scale: 5 V}
  speed: {type: ao, backend: bus0, node: 10, address: 1}
encoders:
  belt: {backend: bus0, node: 12, type: linear, scale: {increments: 1000, per: 1 mm}}
  shaft: {backend: bus0, node: 1, type: linear, scale: {increments: 1000, per: 1 mm}}
";

/// Inputs of a module and of a drive, in the cycle and as words of both kinds; outputs of both, an analog one of -2.5 V of 10 V (-8192 of
/// 32767). An encoder counts through its 32 bits. At the end all outputs of the module are off.
#[test]
fn terminals_on_can_are_those_of_the_machine() {
    let mut devices = CanDrives::boot_with(Way::SlcanTcp, "1", &["--modules", "10", "--encoders", "12"]);
    devices.tell("set 12 0x6004 0 0xFFFFFFFE");
    let cell = CanCell::with_sections(&devices.address().to_string(), "10 ms", SECTIONS, &axis("x", 1, "", ""));
    let run = cell.run(
        "scenario: terminals
for: 6 s
steps:
  - {when: {signal: start, is: 1}, do: {set_output: {lamp: 1, valve: 1, speed: -2.5 V}}}
  - {when: {signal: probe, is: 1}, do: {set_output: {lamp: 0}}}
  - {when: {signal: pressure, min: 2.5 V}, do: {set_output: {lamp: 1}}}
  - {when: {signal: belt.position, is: 3}, do: {set_output: {lamp: 0}}}
expect:
  - {event: {kind: error}, count: 0}
  - {signal: pressure, at: end, is: 2.5 V, within: 0.001 V}
  - {signal: belt.count, at: 10, is: -2}
",
    );
    run.until_told(3, "ready after");
    devices.tell("set 10 0x6000 2 2");
    let module = |devices: &mut CanDrives| (object(devices, 10, 0x6200, 1), object(devices, 10, 0x6411, 2));
    until(&run, &mut devices, |devices| module(devices) == (8, -8192));
    let drive = [object(&mut devices, 1, 0x60FE, 1), object(&mut devices, 1, 0x60FE, 2)];
    assert_eq!(drive, [1 << 16, 1 << 16], "outputs and mask");
    devices.tell("input 1 17 1");
    devices.tell("set 10 0x6401 3 16384");
    devices.tell("set 12 0x6004 0 3");
    run.passes();
    assert_eq!(module(&mut devices), (0, 0), "at the end");
}

/// A module whose power goes: its inputs read 0 as behind a cut wire, while the axis goes on; it is told once, configured again when it is
/// back, and its outputs are those of the cycle then.
#[test]
fn a_module_that_goes_and_comes_back_has_its_outputs_again() {
    let mut devices = CanDrives::boot_with(Way::SlcanTcp, "1", &["--modules", "10"]);
    let sections = "io:
  start: {type: di, backend: bus0, node: 10, address: 0}
  lamp: {type: do, backend: bus0, node: 10, address: 7}
";
    let cell = CanCell::with_sections(
        &devices.address().to_string(),
        "10 ms",
        sections,
        &axis("x", 1, ", heartbeat: 50 ms", ""),
    );
    let run = cell.run(
        "scenario: a module is away
for: 8 s
steps:
  - {when: {signal: start, is: 1}, do: {set_output: {lamp: 1}}}
  - {when: {signal: start, is: 0}, do: {enable: {axes: [x]}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, mode: relative, position: 5 mm}}}
  - {when: {signal: start, is: 1}, do: {set_output: {lamp: 1}}}
expect:
  - {event: {kind: error}, count: 0}
  - {signal: x.actual.position, at: end, is: 5 mm}
",
    );
    run.until_told(2, "ready after");
    devices.tell("set 10 0x6000 1 1");
    until(&run, &mut devices, |devices| object(devices, 10, 0x6200, 1) == 0x80);
    devices.tell("dead 10 1");
    run.until_told(1, "machine: node 10: it is silent: no sign of life");
    thread::sleep(Duration::from_secs(1));
    devices.tell("dead 10 0");
    run.until_told(3, "ready after");
    devices.tell("set 10 0x6000 1 1");
    until(&run, &mut devices, |devices| object(devices, 10, 0x6200, 1) == 0x80);
    run.passes();
}

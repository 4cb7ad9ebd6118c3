//! Tests inputs, outputs and encoders at independent CANopen modules, in a cell of the program.

use crate::support::can::{BusConnection, CanDrives};
use crate::support::can_cell::{CanCell, CanRun, PATIENCE, axis};
use std::thread;
use std::time::{Duration, Instant};

/// Returns the value of an object in the device.
fn object(devices: &mut CanDrives, node: u8, index: u16, sub: u8) -> i64 {
    devices.tell(&format!("get {node} {index:#x} {sub}"))["value"].as_i64().expect("a number")
}

/// Waits until the devices are in the expected state.
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

/// Inputs of a module and of a drive, in the cycle and as words of both kinds; outputs of both, and an analog one of
/// -2.5 V of 10 V (-8192 of 32767). An encoder counts through its 32 bits. At the end all outputs of the module are
/// off.
#[test]
fn terminals_on_can_are_those_of_the_machine() {
    let mut devices = CanDrives::boot_with(BusConnection::SlcanTcp, "1", &["--modules", "10", "--encoders", "12"]);
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
    run.wait_for_log(3, "ready after");
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

/// A module loses its power: its inputs are 0 as with a cut wire, while the axis continues. This is reported once, the
/// module is configured again when it is back, and its outputs are then those of the cycle.
#[test]
fn outputs_are_restored_after_a_module_returns() {
    let mut devices = CanDrives::boot_with(BusConnection::SlcanTcp, "1", &["--modules", "10"]);
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
    run.wait_for_log(2, "ready after");
    devices.tell("set 10 0x6000 1 1");
    until(&run, &mut devices, |devices| object(devices, 10, 0x6200, 1) == 0x80);
    devices.tell("dead 10 1");
    run.wait_for_log(1, "machine: node 10: it is silent: no sign of life");
    thread::sleep(Duration::from_secs(1));
    devices.tell("dead 10 0");
    run.wait_for_log(3, "ready after");
    devices.tell("set 10 0x6000 1 1");
    until(&run, &mut devices, |devices| object(devices, 10, 0x6200, 1) == 0x80);
    run.passes();
}

/// At the end a module refuses to write its first outputs: the others are switched off anyway, and the refusal is
/// reported.
#[test]
fn an_output_that_refuses_leaves_no_other_one_on() {
    let mut devices = CanDrives::boot_with(BusConnection::SlcanTcp, "1", &["--modules", "10"]);
    let sections = "io:
  lamp: {type: do, backend: bus0, node: 10, address: 7}
  speed: {type: ao, backend: bus0, node: 10, address: 1}
";
    let cell = CanCell::with_sections(&devices.address().to_string(), "10 ms", sections, &axis("x", 1, "", ""));
    let run = cell.run(
        "scenario: on
for: 3 s
steps:
  - {at: 100, do: {set_output: {lamp: 1, speed: 5 V}}}
expect:
  - {event: {kind: error}, count: 0}
",
    );
    run.wait_for_log(2, "ready after");
    until(&run, &mut devices, |devices| object(devices, 10, 0x6411, 2) == 16384);
    devices.tell("sdo_abort 10 0x6200 1 0x06090030");
    run.passes();
    assert_eq!(object(&mut devices, 10, 0x6411, 2), 0);
}

const AMPLIFIER: &str = "io:
  reference: {type: ao, backend: bus0, node: 10, address: 0}
  enable: {type: do, backend: bus0, node: 10, address: 0}
  ready: {type: di, backend: bus0, node: 10, address: 0}
encoders:
  belt: {backend: bus0, node: 12, type: linear, scale: {increments: 1000, per: 1 mm}}
";

/// 100 mm/s at 10 V.
const OF_AMPLIFIER: &str = "  x: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {reference: reference, enable: enable, ready: ready, \
    enable_time: 100 ms, interface: velocity, full_velocity: 100 mm/s}, feedback: {encoder: belt}, max_velocity: 80 mm/s, \
    max_acceleration: 400 mm/s^2, max_following_error: 20 mm, in_position_window: 0.5 mm, position_loop: {kv: 5}}\n";

/// An amplifier with +-10 V at a module, and the encoder of its motor: it is enabled by its contact, moves and reaches
/// its target. At the end both reference and enable are off.
#[test]
fn an_amplifier_at_a_module_moves_an_axis() {
    let mut devices = CanDrives::boot_with(BusConnection::SlcanTcp, "1", &["--modules", "10", "--encoders", "12"]);
    devices.tell("amplifier 12 10 100000");
    let cell = CanCell::with_sections(&devices.address().to_string(), "10 ms", AMPLIFIER, OF_AMPLIFIER);
    let run = cell.run(
        "scenario: volts
for: 8 s
steps:
  - {when: {signal: ready, is: 1}, do: {enable: {axes: [x]}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, position: 30 mm, velocity: 40 mm/s}}}
expect:
  - {event: {kind: error}, count: 0}
  - {signal: reference, min: 3.5 V, mode: eventually}
  - {signal: reference, max: 5 V}
  - {signal: x.actual.position, at: end, is: 30 mm, within: 0.5 mm}
",
    );
    run.wait_for_log(2, "ready after");
    assert_eq!((object(&mut devices, 10, 0x6200, 1), object(&mut devices, 12, 0x6004, 0)), (0, 0));
    devices.tell("set 10 0x6000 1 1");
    until(&run, &mut devices, |devices| object(devices, 10, 0x6200, 1) == 1);
    run.passes();
    let outputs = (object(&mut devices, 10, 0x6200, 1), object(&mut devices, 10, 0x6411, 1));
    assert_eq!(outputs, (0, 0), "at the end");
}

/// Its module is lost in motion, and the contact with it: the axis has the fault of its drive. When it is back, enable
/// is off, whatever the contact reports.
#[test]
fn an_amplifier_whose_module_was_away_stays_off() {
    let mut devices = CanDrives::boot_with(BusConnection::SlcanTcp, "1", &["--modules", "10", "--encoders", "12"]);
    devices.tell("amplifier 12 10 100000");
    let cell = CanCell::with_sections(&devices.address().to_string(), "10 ms", AMPLIFIER, OF_AMPLIFIER);
    let run = cell.run(
        "scenario: volts away
for: 12 s
steps:
  - {when: {signal: ready, is: 1}, do: {enable: {axes: [x]}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, mode: velocity, velocity: 10 mm/s}}}
expect:
  - {event: {kind: error, source: x}, count: 1}
  - {signal: x.state, at: end, is: ERROR_STOP}
  - {signal: enable, at: end, is: 0}
",
    );
    run.wait_for_log(2, "ready after");
    devices.tell("set 10 0x6000 1 1");
    until(&run, &mut devices, |devices| object(devices, 12, 0x6004, 0) > 2_000);
    devices.tell("dead 10 1");
    run.wait_for_log(1, "x: drive fault 1000h");
    thread::sleep(Duration::from_secs(1));
    let place = object(&mut devices, 12, 0x6004, 0);
    devices.tell("dead 10 0");
    run.wait_for_log(3, "ready after");
    devices.tell("set 10 0x6000 1 1");
    for _ in 0..100 {
        thread::sleep(Duration::from_millis(10));
        assert_eq!((object(&mut devices, 10, 0x6200, 1), object(&mut devices, 10, 0x6411, 1)), (0, 0));
    }
    assert_eq!(object(&mut devices, 12, 0x6004, 0), place);
    run.passes();
}

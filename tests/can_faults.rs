//! Tests CANopen drives that are lost, come back, report errors, refuse commands, or are absent.

use crate::support::can::CanDrives;
use crate::support::can_cell::{CanCell, Shown, axis, recovery};
use crate::support::proxy::Proxy;
use std::thread;
use std::time::{Duration, Instant};

const PRE_OPERATIONAL: u64 = 127;
/// Time that a shared machine may add; no maximum below it is asserted.
const SLACK: Duration = Duration::from_millis(1500);

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

/// A fault of a drive, the commands that begin and end it, and the error of the axis.
struct Fault {
    axis: &'static str,
    node: u8,
    begin: &'static str,
    /// `None`: the drive comes back by itself.
    end: Option<&'static str>,
    code: &'static str,
    /// State of the drive when it is back.
    state: &'static str,
    /// Whether it is configured again.
    is_lost: bool,
    /// Minimum and maximum time from `begin` to the error of the axis: those of the contract minus the time before
    /// `begin` (a heartbeat, a cycle).
    time: (u64, u64),
}

/// Cycles of 10 ms: data is stale after ten of them; heartbeats of 100 ms: lost after three; guarded every 50 ms, three
/// times.
const FAULTS: [Fault; 6] = [
    Fault {
        axis: "x",
        node: 1,
        begin: "tpdo 1 1 0",
        end: Some("tpdo 1 1 1"),
        code: "DRIVE_STALE",
        state: "SWITCH_ON_DISABLED",
        is_lost: false,
        time: (90, 110),
    },
    Fault {
        axis: "x",
        node: 1,
        begin: "heartbeat 1 0",
        end: Some("heartbeat 1 1"),
        code: "DRIVE_LOST",
        state: "SWITCH_ON_DISABLED",
        is_lost: true,
        time: (190, 310),
    },
    Fault {
        axis: "x",
        node: 1,
        begin: "dead 1 1",
        end: Some("dead 1 0"),
        code: "DRIVE_STALE",
        state: "SWITCH_ON_DISABLED",
        is_lost: true,
        time: (90, 110),
    },
    Fault {
        axis: "x",
        node: 1,
        begin: "power 1",
        end: None,
        code: "DRIVE_LOST",
        state: "SWITCH_ON_DISABLED",
        is_lost: true,
        time: (0, 20),
    },
    Fault {
        axis: "x",
        node: 1,
        begin: "fault 1 0x8611",
        end: None,
        code: "0x18611",
        state: "FAULT",
        is_lost: false,
        time: (0, 20),
    },
    Fault {
        axis: "z",
        node: 3,
        begin: "heartbeat 3 0",
        end: Some("heartbeat 3 1"),
        code: "DRIVE_LOST",
        state: "FAULT",
        is_lost: true,
        time: (90, 160),
    },
];

/// The drives are lost in motion one after the other. The axis ends in error within its time, is off when the drive is
/// back and configured again, and moves once it is reset and enabled. The other axis is not affected and ends exactly
/// at its target. An emergency message and a warning are reported, and stop no axis. z is guarded, without heartbeats:
/// a missing answer is error 88. The simulated drive does not receive the guard requests meanwhile either: its life
/// time ends, and it goes into fault (6007h).
///
/// Proves: MACS-CAN-06
#[test]
fn lost_drive_stops_only_its_axis_and_recovers() {
    let mut drives = CanDrives::boot("1-4");
    let guarded = ", heartbeat: none, guarding: {time: 50 ms, factor: 3}";
    let axes = [axis("x", 1, "", ""), axis("y", 2, "", ""), axis("z", 3, guarded, "")].concat();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let (mut steps, mut expect) = (String::new(), String::new());
    for (at, Fault { axis, code, state, .. }) in FAULTS.iter().enumerate() {
        let (what, after) = recovery(at, axis, code, state);
        steps += &what;
        expect += &after;
    }
    let run = cell.run(&format!(
        "scenario: losses
for: 28 s
steps:
  - {{when: {{all: [{{signal: x.drive_state, is: SWITCH_ON_DISABLED}}, {{signal: y.drive_state, is: SWITCH_ON_DISABLED}}]}}, do: {{enable: {{}}}}}}
  - {{when: {{all: [{{signal: y.state, is: STANDSTILL}}, {{signal: z.state, is: STANDSTILL}}]}}, do: {{move_axis: {{axis: y, position: 130 mm, velocity: 5 mm/s}}}}}}
{steps}expect:
  - {{event: {{kind: error, source: x}}, count: 5}}
  - {{event: {{kind: error, source: z}}, count: 1}}
  - {{event: {{kind: error, source: y}}, mode: never}}
  - {{signal: y.state, at: 26 s, is: DISCRETE_MOTION}}
  - {{signal: y.actual.position, at: end, is: 130000}}
  - {{event: {{kind: warning, source: x, code: EMERGENCY, text: \"emergency 2310h (over-current at the output), register 01h (generic)\"}}, count: 1}}
  - {{event: {{kind: warning, source: machine, code: FOREIGN_EMERGENCY, text: \"node 4, no drive of the cell, sends emergency FF01h (of the vendor)\"}}, count: 1}}
  - {{event: {{kind: warning, source: x, text: \"node 1: it has booted\"}}, mode: eventually}}
  - {{event: {{kind: warning, source: z, text: \"node 3: it is silent: no sign of life\"}}, count: 1}}
  - {{event: {{kind: warning, source: z, severity: info, text: \"node 3: it is configured and operational\"}}, count: 2}}
  - {{event: {{source: y, code: NODE_CHANGED}}, count: 1}}
  - {{signal: x.warning, is: 1, mode: eventually}}
{expect}"
    ));
    run.until(&mut drives, 1, "it moves", |shown| shown.velocity == 10_000);
    for command in ["emcy 1 0x2310", "emcy 4 0xFF01", "warning 1 1"] {
        drives.tell(command);
    }
    thread::sleep(ms(200));
    let shown = drives.shown(1);
    assert!(shown.is_enabled() && shown.velocity == 10_000, "an emergency message stops nothing: {shown:?}");
    drives.tell("warning 1 0");
    for command in ["emcy_clear 1", "emcy_clear 4"] {
        drives.tell(command);
    }
    let (mut errors, mut readies) = ([0, 0], 3);
    for Fault { axis, node, begin, end, is_lost, time, .. } in &FAULTS {
        run.until(&mut drives, *node, "it moves", |shown| shown.velocity == 10_000);
        // A delay for heartbeats and guard requests.
        thread::sleep(ms(250));
        let errors = &mut errors[usize::from(*axis == "z")];
        *errors += 1;
        drives.tell(begin);
        let took = run.wait_for_log(*errors, &format!("ERROR {axis}: "));
        assert!((ms(time.0)..ms(time.1) + SLACK).contains(&took), "{begin}: the error after {took:?}");
        if let Some(end) = end {
            // It is absent for longer than any supervision time.
            thread::sleep(ms(700));
            assert_eq!(run.count_in_log("ready after"), readies, "{begin}: nobody is configured meanwhile");
            drives.tell(end);
        }
        if *is_lost {
            readies += 1;
            run.wait_for_log(readies, "ready after");
        }
        let back = run.until(&mut drives, *node, "it is back", |shown| !shown.is_enabled());
        thread::sleep(ms(250));
        let still = drives.shown(*node);
        assert_eq!((still.machine, still.is_enabled()), (back.machine, false), "{begin}: {still:?}");
    }
    let log = run.passes();
    assert_eq!(drives.shown(2).position, 130_000);
    assert_eq!(log.matches("ready after").count(), readies, "each is configured once: {log}");
    // Each emergency message gives one line when it occurs, and one when it has ended.
    let over = "sends emergency 0000h (no error), register 00h";
    assert!(log.contains(&format!("INFO x: the drive {over}")), "{log}");
    assert_eq!(log.matches(&format!("INFO machine: node 4, no drive of the cell, {over}")).count(), 1, "{log}");
}

/// All drives are lost with the transport: error 89 each. The program reconnects by itself and configures them again,
/// and they move once they are reset and enabled; their behaviour in between (6007h: fault, because the master is
/// silent) does not matter.
#[test]
fn drives_recover_after_an_interrupted_connection() {
    let mut drives = CanDrives::boot("1-2");
    let address = drives.address().to_string();
    let mut cable = Proxy::to(address.trim_start_matches("slcan-tcp:"));
    let axes = [axis("x", 1, "", ""), axis("y", 2, "", "")].concat();
    let cell = CanCell::new(&format!("slcan-tcp:{}", cable.address()), "10 ms", &axes);
    let run = cell.run(
        "scenario: a cable
for: 12 s
steps:
  - {when: {all: [{signal: x.drive_state, is: SWITCH_ON_DISABLED}, {signal: y.drive_state, is: SWITCH_ON_DISABLED}]}, do: {enable: {}}}
  - {when: {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}]}, do: [{move_axis: {axis: x, mode: velocity, velocity: 10 mm/s}}, {move_axis: {axis: y, mode: velocity, velocity: -10 mm/s}}]}
  - name: reset
    when: {all: [{signal: x.drive_state, is: FAULT}, {signal: y.drive_state, is: FAULT}]}
    after: 200 ms
    do: {reset_errors: {}}
  - {name: enable, when: {all: [{signal: x.state, is: DISABLED}, {signal: y.state, is: DISABLED}]}, after: 200 ms, do: {enable: {}}}
  - when: {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}]}
    do: [{move_axis: {axis: x, mode: relative, position: 5 mm}}, {move_axis: {axis: y, mode: relative, position: 5 mm}}]
expect:
  - {event: {kind: error, source: x, code: BUS_ERROR}, count: 1}
  - {event: {kind: error, source: y, code: BUS_ERROR}, count: 1}
  - {signal: x.enabled, since: enable, from: -19, to: 0, is: 0}
  - {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}], at: end}
",
    );
    for node in [1, 2] {
        run.until(&mut drives, node, "it moves", |shown| shown.velocity.abs() == 10_000);
    }
    cable.cut();
    run.wait_for_log(1, "ERROR x: ");
    run.wait_for_log(1, "ERROR y: ");
    // Heartbeats of 100 ms of the master are missing: after 300 ms the drives stop by themselves.
    let stopped = [1, 2]
        .map(|node| run.until(&mut drives, node, "it stops", |shown| shown.fault == 0x8130 && shown.state == "FAULT"));
    thread::sleep(ms(1500));
    cable.restore();
    run.wait_for_log(4, "ready after");
    let log = run.passes();
    for (node, stopped) in [1, 2].into_iter().zip(stopped) {
        let shown = drives.shown(node);
        assert_eq!(shown.position, stopped.position + 5000, "{shown:?}");
    }
    assert_eq!(log.matches("is open again").count(), 1, "{log}");
}

/// Refusals at the start; nothing moves, and the exit code reports it.
#[test]
fn bus_that_differs_from_the_cell_is_refused() {
    let mut drives = CanDrives::boot("1");
    let address = drives.address().to_string();
    let plain = axis("x", 1, "", "");
    let of = |drive: &str| axis("x", 1, drive, "");
    let cases = [
        (of(", identity: {vendor: 0x123}"), "", "its vendor (1018h:01) is 0000FFFFh; 00000123h is expected"),
        (
            plain.clone(),
            "set 1 0x1000 0 0x191",
            "its device type (1000h) is 00000191h, profile 401; profile 402 (drive) is expected",
        ),
        // Without csp: pp, pv, hm, csv.
        (
            plain.clone(),
            "set 1 0x6502 0 0x125",
            "it does not offer mode 8 (csp; 6502h is 00000125h: pp, pv, hm, csv); key mode chooses another",
        ),
        (
            plain.clone(),
            "sdo_abort 1 0x1A00 0 0x08000022",
            "1A00h:00: the device refuses: the data cannot be stored in the present state of the device (08000022h)",
        ),
        (of(", startup: [{index: 0x6098, type: i8, value: 36}]"), "", "6098h:00: the device refuses: "),
    ];
    for (axes, command, sentence) in cases {
        if !command.is_empty() {
            drives.tell(command);
        }
        let log = CanCell::new(&address, "10 ms", &axes).run(IDLE).ends_with(START_FAILED);
        assert!(log.contains(&format!("node 1 (x): {sentence}")), "{sentence}: {log}");
        let shown = drives.shown(1);
        assert!(shown.is_off() && shown.machine == 0.0, "{shown:?}");
        for command in ["sdo_abort 1 0x1A00 0 0", "power 1"] {
            drives.tell(command);
        }
    }
    drives.kill();
    let log = CanCell::new(&address, "10 ms", &plain).run(IDLE).ends_with(START_FAILED);
    assert!(log.contains("cannot be opened: the adapter cannot be reached: Connection refused"), "{log}");
}

/// No action for a moment.
const IDLE: &str = "scenario: idle\nfor: 1 s\nsteps: []\n";
/// Exit code for a failure of the machine (contract section 3).
const START_FAILED: i32 = 1;

/// One of two drives is absent, the SDO server of another one is silent: the one that is present works. Each of the
/// others is configured when it appears, is off until it is enabled, and then moves. Meanwhile the log reports the
/// problem once.
#[test]
fn late_drive_is_configured_when_it_boots() {
    let mut drives = CanDrives::boot("1-3");
    for command in ["dead 2 1", "sdo_mute 3 1"] {
        drives.tell(command);
    }
    let axes = [axis("x", 1, "", ""), axis("y", 2, "", ""), axis("z", 3, "", "")].concat();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let run = cell.run(
        "scenario: late
for: 14 s
steps:
  - {when: {signal: x.drive_state, is: SWITCH_ON_DISABLED}, do: {enable: {axes: [x]}}}
  - {at: 0, do: {enable: {axes: [y]}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, position: 5 mm}}}
  - {when: {all: [{signal: y.drive_state, is: SWITCH_ON_DISABLED}, {signal: z.drive_state, is: SWITCH_ON_DISABLED}]}, after: 500 ms, do: {reset_errors: {}}}
  - {name: enable, when: {all: [{signal: y.state, is: DISABLED}, {signal: z.state, is: DISABLED}]}, do: {enable: {axes: [y, z]}}}
  - {when: {all: [{signal: y.state, is: STANDSTILL}, {signal: z.state, is: STANDSTILL}]}, do: [{move_axis: {axis: y, position: 5 mm}}, {move_axis: {axis: z, position: -5 mm}}]}
expect:
  - {signal: x.actual.position, at: 5 s, is: 5000}
  - {event: {kind: error, source: y, code: DRIVE_LOST}, count: 1}
  - {event: {kind: error}, count: 1}
  - {all: [{signal: y.enabled, is: 0}, {signal: z.enabled, is: 0}], since: enable, from: -50, to: 0}
  - {all: [{signal: y.actual.position, is: 5000}, {signal: z.actual.position, is: -5000}], at: end}
",
    );
    run.until(&mut drives, 1, "it has moved", |shown| shown.position == 5000);
    thread::sleep(ms(4000));
    for node in ["WARN backend bus0: node 2 (y)", "WARN backend bus0: node 3 (z)"] {
        assert_eq!(run.count_in_log(node), 1, "{node}: {}", run.program.log());
    }
    for command in ["dead 2 0", "sdo_mute 3 0"] {
        drives.tell(command);
    }
    run.passes();
    assert_eq!([1, 2, 3].map(|node| drives.shown(node).position), [5000, 5000, -5000]);
}

/// A second bus starts slowly, because its drive is absent: the drives of the first one still get the heartbeats of the
/// master, which they supervise (300 ms).
#[test]
fn a_bus_that_starts_slowly_leaves_no_other_alone() {
    // So many drives that the first one receives a heartbeat before the last one is configured; its supervision begins
    // with that.
    let (mut drives, mut others) = (CanDrives::boot("1-6"), CanDrives::boot("7"));
    others.tell("dead 7 1");
    let axes = ["x", "a", "b", "c", "d", "e"].into_iter().zip(1..).map(|(name, node)| axis(name, node, "", ""));
    let axes = axes.chain([axis("y", 7, "", "").replace("bus0", "bus1")]).collect::<String>();
    let addresses = [drives.address().to_string(), others.address().to_string()];
    let cell = CanCell::with_buses(&addresses.each_ref().map(String::as_str), "10 ms", &axes);
    let run = cell.run(
        "scenario: two buses
for: 2 s
steps:
  - {when: {signal: x.drive_state, is: SWITCH_ON_DISABLED}, do: {enable: {axes: [x]}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, position: 5 mm}}}
expect:
  - {signal: x.actual.position, at: end, is: 5000}
  - {event: {kind: error}, mode: never}
",
    );
    let log = run.passes();
    let shown = drives.shown(1);
    assert_eq!((shown.position, shown.counter("emcy")), (5000, 0), "{shown:?}");
    assert_eq!(log.matches("ready after").count(), 6, "{log}");
}

/// The SDO server of x is silent, and that of y refuses a speed while homing is being set up: both fail, report it, and
/// stay at standstill. After the fault they home.
#[test]
fn a_homing_that_cannot_be_set_up_fails_and_the_next_one_works() {
    let mut drives = CanDrives::boot("1-2");
    let homing = ", homing: {method: 19, in_drive: true, velocity: 50 mm/s, index_velocity: 5 mm/s, acceleration: 500 mm/s^2, max_distance: 100 mm}";
    let axes = [axis("x", 1, "", homing), axis("y", 2, "", homing)].concat();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let run = cell.run(
        "scenario: homing
for: 14 s
steps:
  - {when: {all: [{signal: x.drive_state, is: SWITCH_ON_DISABLED}, {signal: y.drive_state, is: SWITCH_ON_DISABLED}]}, do: {enable: {}}}
  - {name: home, when: {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}]}, after: 1 s, do: [{home_axis: {axis: x}}, {home_axis: {axis: y}}]}
  - {name: failed, when: {all: [{signal: x.error, not: 0}, {signal: y.error, not: 0}]}, after: 1 s, do: {reset_errors: {}}}
  - {when: {all: [{signal: x.state, is: DISABLED}, {signal: y.state, is: DISABLED}]}, do: {enable: {}}}
  - {when: {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}]}, do: [{home_axis: {axis: x}}, {home_axis: {axis: y}}]}
  - {when: {all: [{signal: x.homed, is: 1}, {signal: y.homed, is: 1}]}, do: [{move_axis: {axis: x, position: 10 mm}}, {move_axis: {axis: y, position: 10 mm}}]}
expect:
  - {event: {kind: error, source: x, code: HOMING_IN_DRIVE_TIMEOUT}, count: 1}
  - {event: {kind: error, source: y, code: HOMING_IN_DRIVE_TIMEOUT}, count: 1}
  - {all: [{signal: x.homed, is: 0}, {signal: x.actual.position, is: 0}, {signal: y.homed, is: 0}, {signal: y.actual.position, is: 0}], since: failed, from: -600, to: 0}
  - {all: [{signal: x.actual.position, is: 10000}, {signal: y.actual.position, is: 10000}], at: end}
",
    );
    for node in [1, 2] {
        run.until(&mut drives, node, "it is on", Shown::is_enabled);
    }
    for command in ["sdo_mute 1 1", "sdo_abort 2 0x6099 1 0x06090030"] {
        drives.tell(command);
    }
    let refused = "homing is not set up: 6099h:01: the device refuses: ";
    run.wait_for_log(1, &format!("node 2 (y): {refused}"));
    run.wait_for_log(1, "node 1 (x): homing is not set up: 6098h:00: the device has not answered for 500 ms");
    for node in [1, 2] {
        run.wait_for_log(1, &format!("ERROR {}: ", if node == 1 { "x" } else { "y" }));
        assert_eq!(drives.shown(node).machine, 0.0, "nothing moves");
    }
    for command in ["sdo_mute 1 0", "sdo_abort 2 0x6099 1 0"] {
        drives.tell(command);
    }
    run.passes();
    for node in [1, 2] {
        let shown = drives.shown(node);
        // From the left edge of the switch, within the travel of a cycle.
        assert_eq!(shown.position, 10_000, "{shown:?}");
        assert!((shown.machine - 8_000.0).abs() <= 50.0, "{shown:?}");
    }
}

/// Ctrl-C in motion: drives are off and pre-operational, and do not supervise the master any more, so that no emergency
/// message follows.
#[test]
fn drives_are_off_and_released_when_the_program_ends() {
    let mut drives = CanDrives::boot("1-2");
    let guarded = ", heartbeat: none, guarding: {time: 50 ms, factor: 3}";
    let axes = [axis("x", 1, "", ""), axis("y", 2, guarded, "")].concat();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let mut run = cell.run(
        "scenario: motion
for: 60 s
steps:
  - {when: {all: [{signal: x.drive_state, is: SWITCH_ON_DISABLED}, {signal: y.drive_state, is: SWITCH_ON_DISABLED}]}, do: {enable: {}}}
  - {when: {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}]}, do: [{move_axis: {axis: x, mode: velocity, velocity: 10 mm/s}}, {move_axis: {axis: y, mode: velocity, velocity: 10 mm/s}}]}
",
    );
    for node in [1, 2] {
        run.until(&mut drives, node, "it moves", |shown| shown.velocity == 10_000);
    }
    let begin = Instant::now();
    run.program.end();
    assert!(begin.elapsed() < ms(3000), "it takes {:?}", begin.elapsed());
    // Longer than any supervision time.
    thread::sleep(ms(1000));
    for node in [1, 2] {
        let shown = drives.shown(node);
        assert!(shown.is_off() && shown.nmt == PRE_OPERATIONAL && shown.velocity == 0, "{shown:?}");
        assert_eq!(shown.counter("emcy"), 0, "{shown:?}");
    }
    let log = run.program.log();
    assert!(!log.contains("out of operation"), "nobody else has done that: {log}");
}

//! Tests drives of `lineshaft can simulate`, accessed by the commands of the program and by `lineshaft run`.

use crate::support::can_cell::{CanCell, axis};
use crate::support::{domain::Domain, program::Program};
use std::net::UdpSocket;
use std::time::Duration;

/// Much longer than a command takes.
const END: Duration = Duration::from_secs(60);

const SCENARIO: &str = "\
scenario: simulated drives
for: 8 s
steps:
  - name: enable
    when: {all: [{signal: x.drive_state, is: SWITCH_ON_DISABLED}, {signal: y.drive_state, is: SWITCH_ON_DISABLED}]}
    do: {enable: {axes: [x, y]}}
  - name: move
    when: {all: [{signal: x.state, is: STANDSTILL}, {signal: y.state, is: STANDSTILL}]}
    do: {move_axis: {axis: x, mode: relative, position: 10 mm, velocity: 50 mm/s}}
  - {name: home, when: {signal: y.state, is: STANDSTILL}, do: {home_axis: {axis: y}}}
expect:
  - {signal: x.actual.position, at: end, is: 10 mm, within: 10 um}
  - {signal: y.homed, at: end, is: 1}
  - {event: {kind: error}, count: 0}
";

/// Returns a UDP bus that no other test uses: a group of these tests, and a free port.
fn bus() -> String {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    format!("udp:239.74.163.46:{}", socket.local_addr().expect("it is bound").port())
}

/// Returns a cell with two drives; y homes in its drive.
fn cell(address: &str) -> CanCell {
    let axes = axis("x", 1, "", "") + &axis("y", 2, "", ", homing: {method: 35, in_drive: true}");
    CanCell::new(address, "10 ms", &axes)
}

/// Runs a command of the program to its end; returns its exit code and output.
fn run(arguments: &[&str]) -> (Option<i32>, String) {
    let mut program = Program::start(arguments, &Domain::take());
    let code = program.wait_exit(END).code();
    (code, program.log())
}

#[test]
fn simulated_drives_are_found_enabled_moved_and_homed() {
    let address = bus();
    let cell = cell(&address);
    let mut drives = Program::start(&["can", "simulate", &cell.path("cell.yaml")], &Domain::take());
    drives.wait_for_log("node 1 (x), node 2 (y) simulated");
    let scan = ["can", "scan", "--bus", &address, "--from", "1", "--to", "3"];
    for command in
        [&scan[..], &["can", "info", "2", "--bus", &address], &["can", "sdo", "read", "1", "6041", "--bus", &address]]
    {
        let (code, said) = run(command);
        assert_eq!(code, Some(0), "{command:?}: {said}");
    }
    // 1008h has 25 bytes: in segments.
    let (_, said) = run(&["can", "info", "2", "--bus", &address]);
    assert!(said.contains("Lineshaft simulated drive"), "{said}");
    cell.run(SCENARIO).passes();
    drives.end();
}

#[test]
fn a_node_that_is_on_the_bus_already_is_not_simulated_again() {
    let cell = cell(&bus());
    let path = cell.path("cell.yaml");
    let mut drives = Program::start(&["can", "simulate", &path], &Domain::take());
    drives.wait_for_log("simulated");
    let (code, said) = run(&["can", "simulate", &path]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("is on the bus already"), "{said}");
    drives.end();
}

/// Each axis moves to 20 mm at 40 mm/s and back to -5 mm in the mode of its drive. pp and ip end exactly at the
/// increment, pv within the window of the position loop of the core.
#[test]
fn simulated_drives_move_in_pp_ip_and_pv() {
    let ramps = "startup: [{index: 0x6083, value: 20000000, type: u32}, {index: 0x6084, value: 20000000, type: u32}]";
    let axes = [
        axis("p", 1, ", mode: pp", ""),
        axis("i", 2, ", mode: ip", ""),
        axis("v", 3, &format!(", interface: velocity, mode: pv, {ramps}"), ", in_position_window: 5 um"),
    ];
    let cell = CanCell::new(&bus(), "4 ms", &axes.concat());
    let mut drives = Program::start(&["can", "simulate", &cell.path("cell.yaml")], &Domain::take());
    drives.wait_for_log("simulated");
    let all = |state: &str| {
        let each = ["p", "i", "v"].map(|axis| format!("{{signal: {axis}.{state}}}"));
        format!("{{all: [{}]}}", each.join(", "))
    };
    let moves = |to: &str| {
        let each =
            ["p", "i", "v"].map(|axis| format!("{{move_axis: {{axis: {axis}, position: {to}, velocity: 40 mm/s}}}}"));
        each.join(", ")
    };
    let (off, on) = (all("drive_state, is: SWITCH_ON_DISABLED"), all("state, is: STANDSTILL"));
    let run = cell.run(&format!(
        "scenario: profile modes
for: 6 s
steps:
  - {{when: {off}, do: {{enable: {{axes: [p, i, v]}}}}}}
  - {{when: {on}, do: [{}]}}
  - {{when: {on}, after: 500 ms, do: [{}]}}
expect:
  - {{all: [{{signal: p.actual.position, is: -5000}}, {{signal: i.actual.position, is: -5000}}], at: end}}
  - {{signal: v.actual.position, at: end, is: -5000, within: 5}}
  - {{event: {{kind: error}}, mode: never}}
",
        moves("20 mm"),
        moves("-5 mm")
    ));
    run.passes();
    drives.end();
}

/// Index pulses are at 1234 and every 10000 counts further: the drive latches the first one, and the axis ends 1000
/// counts before it.
#[test]
fn simulated_drive_catches_the_index_pulse() {
    let sim = "sim: {model: ideal, index: {every: 10 mm, at: 1.234 mm}}";
    let axes = axis("x", 1, ", probe_1: index", &format!(", homing: {{index_distance: 20 mm}}, {sim}"));
    let cell = CanCell::new(&bus(), "10 ms", &axes);
    let mut drives = Program::start(&["can", "simulate", &cell.path("cell.yaml")], &Domain::take());
    drives.wait_for_log("simulated");
    let scenario = "scenario: index\nfor: 5 s\nsteps:\n  \
        - {when: {signal: x.drive_state, is: SWITCH_ON_DISABLED}, do: {enable: {}}}\n  \
        - {when: {signal: x.state, is: STANDSTILL}, do: {probe_axis: {axis: x, event: x, edge: index, position: 5 mm, \
        distance: -1 mm, velocity: 20 mm/s}}}\nexpect:\n  \
        - {signal: x.index.position, at: end, is: 1234}\n  \
        - {signal: x.actual.position, at: end, is: 234}\n  \
        - {event: {kind: error}, count: 0}\n";
    cell.run(scenario).passes();
    drives.end();
}

/// A pseudo terminal replaces an adapter: `can scan`, then `run`, open it one after the other.
#[test]
fn simulated_drives_are_reached_by_an_slcan_pseudo_terminal() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("room within the build");
    let link = folder.path().join("bus0");
    let path = link.to_str().expect("a path of text");
    let address = format!("slcan:{path}");
    // On a busy machine the bytes of a terminal are delayed longer than datagrams.
    let patient = |axis: &str| axis.replace("node: ", "missed_cycles: 100, node: ");
    let axes = axis("x", 1, "", "") + &axis("y", 2, "", ", homing: {method: 35, in_drive: true}");
    let cell = CanCell::new(&address, "10 ms", &patient(&axes));
    let mut drives = Program::start(&["can", "simulate", &cell.path("cell.yaml"), "--pty", path], &Domain::take());
    drives.wait_for_log(&format!("{address}: node 1 (x), node 2 (y) simulated"));
    let (code, said) = run(&["can", "scan", "--bus", &address, "--bitrate", "1000000", "--from", "1", "--to", "3"]);
    assert_eq!(code, Some(0), "{said}");
    cell.run(SCENARIO).passes();
    let (code, said) = run(&["can", "simulate", &cell.path("cell.yaml"), "--pty", path]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("exists already"), "{said}");
    drives.end();
    assert!(link.symlink_metadata().is_err(), "the link is removed");
}

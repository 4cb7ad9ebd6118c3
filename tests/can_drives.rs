//! Tests independent CANopen drives in a cell of the program: taken over, moved, homed, geared.

use crate::support::can::{Bus, BusConnection, CanDrives};
use crate::support::can_cell::{CanCell, CanRun, axis};
use crate::support::domain::Domain;
use crate::support::machine::alone;
use crate::support::program::Program;
use crate::support::{namespace, setup};
use lineshaft_can::{NmtCommand, NodeId};
use lineshaft_cia402::object::Object;
use std::fmt::Write;
use std::thread;
use std::time::Duration;

const OPERATIONAL: u64 = 5;
const PRE_OPERATIONAL: u64 = 127;
/// Travel of each test, in increments: 5 mm.
const WAY: i64 = 5000;

fn object(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Returns the predicate for all these axes.
fn all(axes: &[&str], signal: &str, value: &str) -> String {
    let each: Vec<_> = axes.iter().map(|axis| format!("{{signal: {axis}.{signal}, is: {value}}}")).collect();
    format!("{{all: [{}]}}", each.join(", "))
}

/// Starts a node and leaves it enabled in mode 3, at 20000 counts/s, using only objects.
fn set_moving(bus: &mut Bus) {
    let mut write = |index, data: &[u8]| bus.write(object(index, 0), data, false).expect("the drive takes it");
    write(0x6060, &[3]);
    write(0x60FF, &20_000_i32.to_le_bytes());
    for control in [6_u16, 7, 15] {
        write(0x6040, &control.to_le_bytes());
        // Some drives read it rarely.
        thread::sleep(Duration::from_millis(50));
    }
}

/// Maps other objects in PDO 1 of each direction, and sends PDO 3 of the drive ten times per second.
fn set_foreign_mapping(bus: &mut Bus, node: u8) {
    let off = |id: u16| (0x8000_0000 | (u32::from(id) + u32::from(node))).to_le_bytes();
    let on = |id: u16| (u32::from(id) + u32::from(node)).to_le_bytes();
    for (communication, mapping, id, mapped) in
        [(0x1400, 0x1600, 0x200, 0x60FF_0020_u32), (0x1800, 0x1A00, 0x180, 0x606C_0020)]
    {
        let mut write =
            |index, sub, data: &[u8]| bus.write(object(index, sub), data, false).expect("the drive takes it");
        write(communication, 1, &off(id));
        write(mapping, 0, &[0]);
        write(mapping, 1, &mapped.to_le_bytes());
        write(mapping, 0, &[1]);
        write(communication, 2, &[1]);
        write(communication, 1, &on(id));
    }
    bus.write(object(0x1802, 5), &100_u16.to_le_bytes(), false).expect("the drive takes it");
    bus.send(&NmtCommand::Start.frame(NodeId::new(node)));
    bus.way.flush().expect("the bus is there");
}

/// Pre-operational, operational, stopped, enabled and moving, in fault, with PDOs of another master: no drive moves
/// before a command, the moving one stops, and then each of them moves exactly to the target increment. The fault is
/// shown with its code, and is cleared by a reset.
#[test]
fn drives_are_enabled_from_any_state() {
    const NODES: [u8; 6] = [1, 2, 3, 4, 5, 6];
    const AXES: [&str; 6] = ["a", "b", "c", "d", "e", "f"];
    let mut drives = CanDrives::boot("1-6");
    for (node, command) in [(2, NmtCommand::Start), (3, NmtCommand::Stop)] {
        let mut bus = Bus::open(&drives, node);
        bus.send(&command.frame(NodeId::new(node)));
        bus.way.flush().unwrap();
    }
    set_moving(&mut Bus::open(&drives, 4));
    set_foreign_mapping(&mut Bus::open(&drives, 6), 6);
    drives.tell("fault 5 0x8611");
    for (node, nmt) in [(1, PRE_OPERATIONAL), (2, OPERATIONAL), (3, 4), (6, OPERATIONAL)] {
        assert_eq!(drives.shown(node).nmt, nmt, "node {node}");
    }
    assert!(drives.shown(4).is_enabled() && drives.shown(4).velocity > 0, "{:?}", drives.shown(4));
    assert_eq!(drives.shown(5).state, "FAULT");

    let axes: String = AXES.iter().zip(NODES).map(|(name, node)| axis(name, node, "", "")).collect();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let others = ["a", "b", "c", "d", "f"];
    let (off, stand) = (all(&others, "drive_state", "SWITCH_ON_DISABLED"), all(&AXES, "state", "STANDSTILL"));
    let moves: Vec<_> =
        AXES.iter().map(|axis| format!("{{move_axis: {{axis: {axis}, mode: relative, position: 5 mm}}}}")).collect();
    let run = cell.run(&format!(
        "scenario: taken over
for: 7 s
steps:
  - {{when: {off}, after: 3 s, do: {{enable: {{axes: [a, b, c, d, f]}}}}}}
  - {{when: {{signal: e.drive_state, is: FAULT}}, do: {{enable: {{axes: [e]}}}}}}
  - {{name: reset, when: {{signal: e.error, is: 0x18611}}, do: {{reset_errors: {{axes: [e]}}}}}}
  - {{when: {{signal: e.drive_state, is: SWITCH_ON_DISABLED}}, do: {{enable: {{axes: [e]}}}}}}
  - {{when: {stand}, do: [{}]}}
expect:
  - {{event: {{kind: error, source: e, code: 0x18611}}, count: 1}}
  - {{event: {{kind: error}}, count: 1}}
",
        moves.join(", ")
    ));
    run.wait_for_log(6, "ready after");
    let real = format!("WARN REAL DRIVES on bus0 ({}): a, b, c, d, e, f (nodes 1, 2, 3, 4, 5, 6)", drives.address());
    assert_eq!(run.count_in_log(&real), 1, "{}", run.program.log());
    let before = NODES.map(|node| drives.shown(node));
    thread::sleep(Duration::from_secs(1));
    for (before, node) in before.iter().zip(NODES) {
        let now = drives.shown(node);
        assert_eq!((now.nmt, now.machine, now.velocity), (OPERATIONAL, before.machine, 0), "node {node}: {now:?}");
        assert!(now.is_off() || now.state == "FAULT" && node == 5, "node {node}: {now:?}");
    }
    run.passes();
    for (before, node) in before.iter().zip(NODES) {
        let now = drives.shown(node);
        assert_eq!(now.position, before.position + WAY, "node {node}: {now:?}");
        assert!(now.is_off() && now.nmt == PRE_OPERATIONAL, "node {node}: {now:?}");
    }
}

/// Two nodes drive one axis: both move the same distance, exactly to the increment, and if one of them fails both are
/// without voltage.
#[test]
fn two_drives_carry_one_axis() {
    let mut drives = CanDrives::boot("4-5");
    let one = "drive: {backend: bus0, node: 4, eds: cia402_sim.eds}";
    let both = "drives: [{backend: bus0, node: 4, eds: cia402_sim.eds}, {backend: bus0, node: 5, eds: cia402_sim.eds}]";
    let portal = axis("portal", 4, "", ", max_skew: 1 mm").replace(one, both);
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &portal);
    let before = [4, 5].map(|node| drives.shown(node).position);
    let run = cell.run(
        "scenario: two drives of one axis
for: 8 s
steps:
  - {when: {all: [{signal: portal.drive_state, is: SWITCH_ON_DISABLED}, {signal: portal.second.drive_state, is: SWITCH_ON_DISABLED}]}, after: 500 ms, do: {enable: {axes: [portal]}}}
  - {when: {signal: portal.state, is: STANDSTILL}, do: {move_axis: {axis: portal, mode: relative, position: 5 mm}}}
expect:
  - {signal: portal.skew, max: 1 mm}
  - {signal: portal.skew, min: -1 mm}
  - {event: {kind: error, source: portal, code: 0x18611}, count: 1}
  - {event: {kind: error}, count: 1}
  - {signal: portal.output.control, at: end, is: 0}
",
    );
    run.wait_for_log(2, "ready after");
    let stand = |drives: &mut CanDrives| [4, 5].map(|node| drives.shown(node).position);
    let there = before.map(|position| position + WAY);
    for _ in 0..300 {
        if stand(&mut drives) == there {
            break;
        }
        thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(stand(&mut drives), there);
    assert!([4, 5].iter().all(|&node| drives.shown(node).is_enabled()));
    drives.tell("fault 5 0x8611");
    thread::sleep(Duration::from_millis(500));
    assert!(drives.shown(4).is_off(), "{:?}", drives.shown(4));
    run.passes();
}

/// Positions are exact at the end, also after 5 s of motion; with interface velocity the core ends within its window of
/// 5 increments. Every cycle has a PDO for the drive.
#[test]
fn axes_reach_their_targets() {
    let mut drives = CanDrives::boot("1-3");
    // At 500 mm/s a cycle that is 10 ms late is 5 mm.
    let fast = axis("x", 1, "", "").replace("max_following_error: 5 mm", "max_following_error: 50 mm");
    let axes = [fast, axis("y", 2, "", ""), axis("v", 3, ", interface: velocity", ", in_position_window: 5 um")];
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &axes.concat());
    let axes = ["x", "y", "v"];
    let log = cell.run(&format!(
        "scenario: moves
for: 8 s
steps:
  - {{when: {}, do: {{enable: {{axes: [x, y, v]}}}}}}
  - when: {}
    do:
      - {{move_axis: {{axis: x, position: -12.345 mm}}}}
      - {{move_axis: {{axis: y, position: 200.001 mm, velocity: 40 mm/s}}}}
      - {{move_axis: {{axis: v, position: 30 mm, velocity: 20 mm/s}}}}
  - {{when: {{signal: x.state, is: STANDSTILL}}, do: {{move_axis: {{axis: x, position: 1000 mm, velocity: 500 mm/s}}}}}}
  - {{when: {{signal: x.state, is: STANDSTILL}}, do: {{move_axis: {{axis: x, position: 7 um}}}}}}
expect:
  - {{all: [{{signal: x.actual.position, is: 7}}, {{signal: y.actual.position, is: 200001}}], at: end}}
  - {{signal: v.actual.position, at: end, is: 30000, within: 5}}
  - {{signal: v.in_position, at: end, is: 1}}
  - {{event: {{kind: error}}, mode: never}}
",
        all(&axes, "drive_state", "SWITCH_ON_DISABLED"),
        all(&axes, "state", "STANDSTILL")
    ));
    log.passes();
    let shown = [1, 2, 3].map(|node| drives.shown(node));
    assert_eq!((shown[0].position, shown[1].position), (7, 200_001));
    assert!((shown[2].position - 30_000).abs() <= 5, "{:?}", shown[2]);
    for shown in shown {
        assert_eq!((shown.counter("rpdo_missed"), shown.counter("emcy")), (0, 0), "{shown:?}");
    }
}

/// Reference of a CiA 402 method, and its accuracy: exact, or within this number of increments.
struct Home {
    method: i8,
    start: i64,
    at: i64,
    within: i64,
}

impl Home {
    /// Returns the target after homing: 10 mm away, off the positive limit.
    fn target(&self) -> i64 {
        if matches!(self.method, 2 | 18) { -10_000 } else { 10_000 }
    }
}

/// The simulated drive (its README): switch from -2000 to 2000, index pulses at 1234 + n * 10000; limit switches are
/// set to -30000 and 30000. Index pulses are exact, edges within the travel of a cycle at 5000 counts/s: 50.
fn homes() -> Vec<Home> {
    const INDEX: [(i8, i64); 14] = [
        (1, -28_766), // right of the negative limit
        (2, 21_234),
        (3, -8_766), // left of the left edge
        (4, 1_234),
        (5, 11_234), // right of the right edge
        (6, 1_234),
        (7, -8_766),
        (8, 1_234),
        (9, 1_234),
        (10, 11_234),
        (11, 11_234),
        (12, 1_234),
        (13, 1_234),
        (14, -8_766),
    ];
    const EDGES: [(i8, i64); 14] = [
        (17, -30_000),
        (18, 30_000),
        (19, -2_000),
        (20, -2_000),
        (21, 2_000),
        (22, 2_000),
        (23, -2_000),
        (24, -2_000),
        (25, 2_000),
        (26, 2_000),
        (27, 2_000),
        (28, 2_000),
        (29, -2_000),
        (30, -2_000),
    ];
    // At the present position, where no switch matters.
    const HERE: [(i8, i64); 4] = [(33, 1_234), (34, 11_234), (35, 5_000), (37, 5_000)];
    // On the switch, and on either side of it.
    let starts = [0, -5_000, 5_000].into_iter().cycle();
    let index = INDEX.map(|(method, at)| (method, at, 0)).into_iter();
    let edges = EDGES.map(|(method, at)| (method, at, 50)).into_iter();
    let with_switch = index.chain(edges).zip(starts);
    let with_switch = with_switch.map(|((method, at, within), start)| Home { method, start, at, within });
    let here = HERE.map(|(method, at)| Home { method, start: 5_000, at, within: 0 });
    with_switch.chain(here).collect()
}

/// Homes as many axes at once and moves each by 10 mm; the mechanics are then at that distance from the reference.
fn homes_each(drives: &mut CanDrives, homes: &[Home], keys: &str, phase: &str) {
    let names: Vec<_> = (0..homes.len()).map(|at| format!("a{at}")).collect();
    let (mut axes, mut homing, mut moves, mut expect) = (String::new(), vec![], vec![], String::new());
    for ((home, name), node) in homes.iter().zip(&names).zip(1_u8..) {
        let Home { method, start, .. } = home;
        for command in [format!("limits {node} -30000 30000"), format!("move {node} {start}")] {
            drives.tell(&command);
        }
        axes += &axis(name, node, "", &format!(", homing: {{method: {method}, {keys}}}"));
        homing.push(format!("{{home_axis: {{axis: {name}}}}}"));
        moves.push(format!("{{move_axis: {{axis: {name}, position: {} mm}}}}", home.target() / 1000));
        writeln!(expect, "  - {{signal: {name}.actual.position, at: end, is: {}}}", home.target()).expect("room");
        if !matches!(method, 35 | 37) {
            writeln!(expect, "  - {{signal: {name}.homing.phase, is: {phase}, mode: eventually}}").expect("room");
        }
    }
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    let (off, stand) = (all(&names, "drive_state", "SWITCH_ON_DISABLED"), all(&names, "state", "STANDSTILL"));
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let count = names.len();
    let run = cell.run(&format!(
        "scenario: homing
for: 8 s
steps:
  - {{when: {off}, do: {{enable: {{}}}}}}
  - {{when: {stand}, do: [{}]}}
  - {{when: {}, do: [{}]}}
expect:
  - {{event: {{kind: homed}}, count: {count}}}
  - {{event: {{kind: error}}, mode: never}}
{expect}",
        homing.join(", "),
        all(&names, "homed", "1"),
        moves.join(", ")
    ));
    run.passes();
    for (home, node) in homes.iter().zip(1..) {
        let (shown, Home { method, at, within, .. }) = (drives.shown(node), home);
        let from = shown.machine - (home.target() + at) as f64;
        assert!(from.abs() <= *within as f64, "method {method}: {from} from the reference {at}; {shown:?}");
    }
}

/// All methods of CiA 402, by the drives themselves. Each then counts from its zero.
#[test]
fn drives_home_by_each_method() {
    let mut drives = CanDrives::boot("1-8");
    let keys =
        "in_drive: true, velocity: 50 mm/s, index_velocity: 5 mm/s, acceleration: 500 mm/s^2, max_distance: 100 mm";
    for homes in homes().chunks(8) {
        homes_each(&mut drives, homes, keys, "IN_DRIVE");
        for (node, home) in (1..).zip(homes) {
            assert_eq!(drives.shown(node).position, home.target(), "method {}", home.method);
        }
        drives.tell("power *");
    }
}

/// The core homes with the switches that a drive reports in 60FDh; edges are within the travel of a cycle at 1 mm/s, 10
/// increments.
#[test]
fn the_core_homes_by_the_switches_of_drives() {
    let mut drives = CanDrives::boot("1-8");
    let keys = "velocity: 50 mm/s, index_velocity: 1 mm/s, acceleration: 2 m/s^2, max_distance: 100 mm";
    let methods = [17, 18, 19, 21, 24, 25, 28, 30];
    let homes = homes().into_iter().filter(|home| methods.contains(&home.method));
    let homes: Vec<_> = homes.map(|home| Home { within: 10, ..home }).collect();
    assert_eq!(homes.len(), 8);
    homes_each(&mut drives, &homes, keys, "SEARCH_SWITCH");
}

/// Geared 1 : 2 for this number of seconds, no increment is lost: n of one axis are floor(n / 2) of the other. For each
/// SYNC both drives have a PDO of that cycle.
fn two_drives_are_geared(seconds: u64) {
    // 10 mm/s, from about 2 s on.
    let (way, cycles) = ((seconds - 4) * 10_000 + 1, seconds * 250);
    let mut drives = CanDrives::boot("1-2");
    let axes = [axis("x", 1, "", ""), axis("y", 2, "", "")].concat();
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &axes);
    let run = cell.run(&format!(
        "scenario: gear
for: {seconds} s
steps:
  - {{when: {}, do: {{enable: {{}}}}}}
  - when: {}
    do:
      - {{synchronize: {{axis: y, master: x, mode: position, numerator: 1, denominator: 2}}}}
      - {{move_axis: {{axis: x, units: increments, position: {way}, velocity: 10 mm/s}}}}
expect:
  - {{signal: y.sync.error, is: 0}}
  - {{signal: y.in_sync, from: 5 s, to: end, is: 1}}
  - {{all: [{{signal: x.actual.position, is: {way}}}, {{signal: y.actual.position, is: {}}}], at: end}}
  - {{event: {{kind: error}}, mode: never}}
",
        all(&["x", "y"], "drive_state", "SWITCH_ON_DISABLED"),
        all(&["x", "y"], "state", "STANDSTILL"),
        way / 2
    ));
    run.passes();
    let shown = [1, 2].map(|node| drives.shown(node));
    assert_eq!(shown.each_ref().map(|shown| shown.position.unsigned_abs()), [way, way / 2]);
    for shown in shown {
        assert!(shown.counter("sync") >= cycles && shown.counter("tpdo") >= cycles, "{shown:?}");
        assert_eq!((shown.counter("rpdo_missed"), shown.counter("emcy")), (0, 0), "{shown:?}");
    }
}

#[test]
fn geared_drives_lose_no_increment() {
    two_drives_are_geared(15);
}

#[test]
#[ignore = "long: .ci/nightly runs it"]
fn geared_drives_lose_no_increment_in_a_minute() {
    // During a minute of other tests the simulated drives may miss a cycle.
    let _alone = alone();
    two_drives_are_geared(60);
}

/// Probe 1 is active from 3000 to 4000 counts, zero pulses are at 1234 and every 10000 further: the drive latches both
/// exactly, between two SYNCs, and the axis ends at the latched position, or 1 mm further.
#[test]
fn drives_catch_edges_and_zero_pulses() {
    let mut drives = CanDrives::boot("1");
    drives.tell("probe 1 1 3000 4000");
    let (drive, keys) = (", probe_1: both, probe_2: index", ", homing: {index_distance: 20 mm}");
    // Both edges, the index, and the cyclic data need 4 PDOs: there is no room for digital inputs.
    let refused = CanCell::new(&drives.address().to_string(), "10 ms", &axis("x", 1, drive, keys));
    let said = refused.run("scenario: none\nfor: 1 s\n").ends_with(2);
    assert!(said.contains("the mapped objects need more than 4 PDOs"), "{said}");
    let drive = ", probe_1: rising, probe_2: index";
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axis("x", 1, drive, keys));
    let probe = |edge: &str, position: &str, distance: &str| {
        format!(
            "  - {{when: {{signal: x.state, is: STANDSTILL}}, do: {{probe_axis: {{axis: x, event: x, edge: {edge}, position: \
             {position}, distance: {distance}, velocity: 20 mm/s}}}}}}\n"
        )
    };
    let scenario = format!(
        "scenario: probes\nfor: 5 s\nsteps:\n  - {{when: {{signal: x.drive_state, is: SWITCH_ON_DISABLED}}, do: {{enable: {{}}}}}}\n{}{}expect:\n  \
         - {{event: {{kind: mark}}, count: 2}}\n  - {{signal: x.latch.position, at: end, is: 3000}}\n  \
         - {{signal: x.index.position, at: end, is: 11234}}\n  - {{signal: x.actual.position, at: end, is: 10234}}\n",
        probe("rising", "10 mm", "1 mm"),
        probe("index", "15 mm", "-1 mm"),
    );
    cell.run(&scenario).passes();
    assert_eq!(drives.shown(1).position, 10_234);
}

/// One scenario, one cell: with ideal simulations and with drives it ends at the same increments. The recording of the
/// drives can be replayed bit by bit.
#[test]
fn a_scenario_ends_alike_in_a_simulation_and_with_drives() {
    let mut drives = CanDrives::boot("1-2");
    let axes = [axis("x", 1, "", ", sim: {model: ideal}"), axis("y", 2, "", ", sim: {model: ideal}")].concat();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let scenario = format!(
        "scenario: alike
for: 5 s
steps:
  - {{when: {}, do: {{enable: {{}}}}}}
  - when: {}
    do:
      - {{synchronize: {{id: gear, axis: y, master: x, mode: position, numerator: -3, denominator: 7}}}}
      - {{move_axis: {{axis: x, position: 33.333 mm, velocity: 100 mm/s}}}}
  - {{when: {{signal: x.state, is: STANDSTILL}}, do: {{move_axis: {{axis: x, mode: relative, position: -3.332 mm}}}}}}
  - {{when: {{signal: x.state, is: STANDSTILL}}, do: {{cancel: {{id: gear}}}}}}
  - {{when: {{signal: y.state, is: STANDSTILL}}, do: {{set_position: {{axis: y, position: 1 mm}}}}}}
  - {{when: {{signal: y.state, is: STANDSTILL}}, do: {{move_axis: {{axis: y, position: -4.5 mm}}}}}}
expect: # floor(-3 * 30001 / 7) is -12858; from there 5500 back
  - {{all: [{{signal: x.actual.position, is: 30001}}, {{signal: y.actual.position, is: -4500}}], at: end}}
  - {{all: [{{signal: x.actual.count, is: 30001}}, {{signal: y.actual.count, is: -18358}}], at: end}}
  - {{event: {{kind: error}}, mode: never}}
",
        all(&["x", "y"], "drive_state", "SWITCH_ON_DISABLED"),
        all(&["x", "y"], "state", "STANDSTILL")
    );
    cell.run_with(&scenario, &["--sim"]).passes();
    let bag = cell.path("drives");
    cell.run_with(&scenario, &["--record", &bag]).passes();
    assert_eq!((drives.shown(1).position, drives.shown(2).position), (30_001, -18_358));
    let told = CanRun { program: Program::start(&["replay", &bag], &Domain::take()) }.passes();
    assert!(told.contains("no difference"), "{told}");
}

/// Makes one move over this transport.
fn a_move_over(way: BusConnection) {
    let mut drives = CanDrives::boot_on(way, "1-2");
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axis("x", 2, "", ""));
    let scenario = "scenario: a move
for: 2 s
steps:
  - {when: {signal: x.drive_state, is: SWITCH_ON_DISABLED}, do: {enable: {}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, position: 5 mm}}}
expect:
  - {signal: x.actual.position, at: end, is: 5000}
";
    cell.run(scenario).passes();
    let shown = drives.shown(2);
    assert_eq!((shown.position, shown.nmt, drives.shown(1).position), (WAY, PRE_OPERATIONAL, 0), "{shown:?}");
}

#[test]
fn a_drive_moves_behind_an_adapter_on_a_terminal() {
    a_move_over(BusConnection::SlcanPty);
}

#[test]
fn a_drive_moves_by_datagrams() {
    if namespace::is_inside("can_drives::a_drive_moves_by_datagrams", &[setup::can_python]) {
        a_move_over(BusConnection::Udp);
    }
}

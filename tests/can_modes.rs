//! Tests independent CANopen drives in modes that are not cyclic, and with the drive types of MACS.

use crate::support::can::{Bus, CanDrives};
use crate::support::can_cell::{CanCell, PATIENCE, Shown, axis};
use lineshaft_cia402::object::Object;
use std::fs;
use std::time::Instant;

/// Waits until a drive reports that mode.
#[track_caller]
fn until_mode(drives: &mut CanDrives, node: u8, mode: i64) {
    let begin = Instant::now();
    loop {
        let shown = drives.tell(&format!("get {node} 0x6061 0"))["value"].clone();
        if shown == mode {
            return;
        }
        assert!(begin.elapsed() < PATIENCE, "node {node} is in mode {shown} instead of {mode}");
    }
}

/// Each axis moves to 20 mm at 40 mm/s and back to -5 mm; those positioned by the drive end exactly at the increment,
/// those of the core within its window. No setpoint is sent before the axis is enabled, and each drive is in its own
/// mode.
#[test]
fn axes_move_in_each_mode_that_a_drive_offers() {
    let mut drives = CanDrives::boot("1-3");
    let axes = [
        axis("p", 1, ", mode: pp, startup: [{index: 0x6081, value: 100000, type: u32}]", ""),
        axis("i", 2, ", mode: ip", ""),
        axis(
            "v",
            3,
            ", interface: velocity, mode: pv, startup: [{index: 0x6083, value: 20000000, type: u32}, {index: 0x6084, value: 20000000, type: u32}]",
            ", in_position_window: 5 um",
        ),
    ];
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &axes.concat());
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
        "scenario: modes
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
    for (node, mode) in [(1, 1), (2, 7), (3, 3)] {
        run.until(&mut drives, node, "enabled", Shown::is_enabled);
        until_mode(&mut drives, node, mode);
    }
    run.passes();
    let shown = [1, 2, 3].map(|node| drives.shown(node));
    assert_eq!([shown[0].position, shown[1].position], [-5_000; 2]);
    for shown in shown {
        assert_eq!((shown.counter("rpdo_missed"), shown.counter("emcy")), (0, 0), "{shown:?}");
    }
}

/// Drives that refuse 6060h, 6061h or both in a PDO: each is enabled, homes twice in mode 6 (to the index pulse at
/// 1234) and moves away as soon as the axis has its zero, each time in mode 8. None jumps: positions are exact, and no
/// axis has an error.
#[test]
fn drives_that_cannot_map_their_mode_move_and_home() {
    const NODES: [(u8, &str, &[&str]); 3] = [(1, "a", &["6060", "6061"]), (2, "b", &["6060"]), (3, "c", &["6061"])];
    let mut drives = CanDrives::boot("1-3");
    let keys = ", homing: {method: 33, in_drive: true, velocity: 50 mm/s, index_velocity: 5 mm/s, acceleration: 500 mm/s^2, max_distance: 100 mm}";
    let axes =
        NODES.map(|(node, name, _)| axis(name, node, "", keys).replace("cia402_sim.eds", &format!("{name}.eds")));
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes.concat());
    for (node, name, objects) in NODES {
        let mut eds = fs::read_to_string(cell.path("cia402_sim.eds")).expect("the cell has it");
        for object in objects {
            let at = eds.find(&format!("[{object}]")).expect("the drive has it");
            eds = format!("{}{}", &eds[..at], eds[at..].replacen("PDOMapping=0x1", "PDOMapping=0", 1));
            drives.tell(&format!("unmappable {node} 0x{object}"));
        }
        cell.write(&format!("{name}.eds"), &eds);
        drives.tell(&format!("move {node} 5000"));
    }
    let all = |state: &str| {
        let each = NODES.map(|(_, axis, _)| format!("{{signal: {axis}.{state}}}"));
        format!("{{all: [{}]}}", each.join(", "))
    };
    let (off, stand) = (all("drive_state, is: SWITCH_ON_DISABLED"), all("state, is: STANDSTILL"));
    let home = NODES.map(|(_, axis, _)| format!("{{home_axis: {{axis: {axis}}}}}")).join(", ");
    let moves = |to: &str| {
        let each =
            NODES.map(|(_, axis, _)| format!("{{move_axis: {{axis: {axis}, position: {to}, velocity: 100 mm/s}}}}"));
        each.join(", ")
    };
    cell.run(&format!(
        "scenario: modes by SDO
for: 10 s
steps:
  - {{when: {off}, do: {{enable: {{}}}}}}
  - {{when: {stand}, do: [{home}]}}
  - {{when: {stand}, do: [{}]}}
  - {{when: {stand}, do: [{home}]}}
  - {{when: {stand}, do: [{}]}}
expect:
  - {{all: [{{signal: a.actual.position, is: 3000}}, {{signal: b.actual.position, is: 3000}}, {{signal: c.actual.position, is: 3000}}], at: end}}
  - {{event: {{kind: homed}}, count: 6}}
  - {{event: {{kind: error}}, mode: never}}
",
        moves("8 mm"),
        moves("3 mm")
    ))
    .passes();
    // Number of objects in RPDO 1 and TPDO 1.
    for (node, mapped) in [(1, [2, 2]), (2, [2, 3]), (3, [3, 2])] {
        let shown = drives.shown(node);
        assert_eq!((shown.position, shown.machine), (3_000, 4_234.0), "{shown:?}");
        assert_eq!(drives.tell(&format!("get {node} 0x6061 0"))["value"], 8, "node {node}");
        for (index, count) in ["0x1600", "0x1A00"].into_iter().zip(mapped) {
            assert_eq!(drives.tell(&format!("get {node} {index} 0"))["value"], count, "node {node}, {index}");
        }
    }
}

/// A drive with torque interface (mode 10): the core closes position and velocity loop, on an axis of 2e6 counts/s^2 at
/// the rated torque with a static friction of 20 of 1000. It ends within its window, and has no torque once it is off.
#[test]
fn an_axis_moves_by_the_torques_of_the_core() {
    let mut drives = CanDrives::boot("1");
    let keys = ", max_effort: 800, velkprop: 1000, velkint: 10, velkilim: 5000, position_loop: {kv: 10}, in_position_window: 0.1 mm, \
                sim: {model: motor, inertia: 1e-4 kg*m^2, rated_torque: 1 Nm, counts_per_turn: 10000 inc}";
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &axis("t", 1, ", interface: torque", keys));
    let run = cell.run(
        "scenario: torques
for: 8 s
steps:
  - {when: {signal: t.drive_state, is: SWITCH_ON_DISABLED}, do: {enable: {axes: [t]}}}
  - {when: {signal: t.state, is: STANDSTILL}, do: {move_axis: {axis: t, position: 60 mm, velocity: 40 mm/s, acceleration: 0.2 m/s^2}}}
  - {when: {signal: t.in_position, is: 1}, after: 500 ms, do: {move_axis: {axis: t, position: -5 mm, velocity: 40 mm/s, acceleration: 0.2 m/s^2}}}
  - {when: {signal: t.in_position, is: 1}, after: 1 s, do: {disable: {axes: [t]}}}
expect:
  - {signal: t.actual.position, mode: eventually, min: 59900, max: 60100}
  - {signal: t.actual.position, at: end, is: -5000, within: 100}
  - {signal: t.actual.effort, mode: eventually, min: 30}
  - {signal: t.output.effort, at: end, is: 0}
  - {event: {kind: error}, mode: never}
",
    );
    run.until(&mut drives, 1, "enabled", Shown::is_enabled);
    until_mode(&mut drives, 1, 10);
    run.passes();
    assert_eq!(drives.tell("get 1 0x6071 0")["value"], 0);
    let shown = drives.shown(1);
    assert!(shown.is_off() && (shown.position + 5_000).abs() <= 100, "{shown:?}");
    assert_eq!((shown.counter("rpdo_missed"), shown.counter("emcy")), (0, 0), "{shown:?}");
}

/// Types 2 (guarded) and -3 are mapped; 13 is mapped beforehand, with a position of 16 bits, which wraps during the
/// motion: 100000 counts. If an axis is off, its drive is shut down (06h), not without voltage.
///
/// Proves: MACS-CAN-01, MACS-CAN-02, MACS-CAN-04, MACS-CAN-08, MACS-CAN-12
#[test]
fn drives_are_chosen_by_the_numbers_of_macs() {
    let mut drives = CanDrives::boot("1-3");
    map_as_akd(&mut Bus::open(&drives, 3));
    let keys = ", in_position_window: 5 um";
    let axes = [
        axis("d", 1, ", interface: velocity, drivetype: 2", keys),
        axis("e", 2, ", interface: velocity, drivetype: -3", keys),
        axis("a", 3, ", interface: velocity, drivetype: -13, velocity_factor: {numerator: 1, denominator: 1}", keys),
    ];
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &axes.concat());
    let run = cell.run(
        "scenario: types
for: 6 s
steps:
  - {at: 500 ms, do: {enable: {axes: [d, e, a]}}}
  - when: {all: [{signal: d.state, is: STANDSTILL}, {signal: e.state, is: STANDSTILL}, {signal: a.state, is: STANDSTILL}]}
    do:
      - {move_axis: {axis: d, position: 20 mm, velocity: 40 mm/s}}
      - {move_axis: {axis: e, position: -20 mm, velocity: 40 mm/s}}
      - {move_axis: {axis: a, position: 100 mm, velocity: 50 mm/s}}
  - {when: {signal: a.in_position, is: 1}, after: 1 s, do: {disable: {axes: [d, e, a]}}}
expect:
  - {signal: d.actual.position, at: end, is: 20000, within: 5}
  - {signal: e.actual.position, at: end, is: -20000, within: 5}
  - {signal: a.actual.position, at: end, is: 100000, within: 5}
  - {signal: d.drive_state, at: end, is: READY_TO_SWITCH_ON}
  - {event: {kind: error}, mode: never}
",
    );
    run.passes();
    assert!((drives.shown(3).position - 100_000).abs() <= 5, "{:?}", drives.shown(3));
    let guarded = [1, 2].map(|node| drives.tell(&format!("get {node} 0x100C 0"))["value"].clone());
    assert_eq!(guarded, [100, 0], "guard time");
    let modes = [1, 2, 3].map(|node| drives.tell(&format!("get {node} 0x6061 0"))["value"].clone());
    assert_eq!(modes, [9, 9, 9]);
}

/// Status word, 16 bits of the position and two more words; control word, velocity and one more word.
fn map_as_akd(bus: &mut Bus) {
    let mut write = |index, sub, data: &[u8]| {
        bus.write(Object { index, sub }, data, false).expect("the drive takes it");
    };
    let pdos: [(u16, &[u32]); 2] = [
        (0x1600, &[0x6040_0010, 0x60FF_0020, 0x60B8_0010]),
        (0x1A00, &[0x6041_0010, 0x2010_0010, 0x60D5_0010, 0x60B9_0010]),
    ];
    for (mapping, entries) in pdos {
        let id = if mapping == 0x1600 { 0x203_u32 } else { 0x183 };
        write(mapping - 0x200, 1, &(id | 0x8000_0000).to_le_bytes());
        write(mapping, 0, &[0]);
        for (sub, entry) in (1..).zip(entries) {
            write(mapping, sub, &entry.to_le_bytes());
        }
        write(mapping, 0, &[entries.len() as u8]);
        write(mapping - 0x200, 1, &id.to_le_bytes());
    }
}

/// An axis with speed steps: 6042h in units of 1000 counts/s, its ramp by bits 4 to 6 of the control word. 100 mm/s
/// until 10 mm before the target, 10 mm/s until 1 mm before it, then off.
#[test]
fn an_axis_runs_at_the_speeds_of_a_frequency_converter() {
    let mut drives = CanDrives::boot("1");
    let wf = ", unit: mm, error_reaction: 2, min_position: -1 m, max_position: 1 m, wf: {md42: 2, md43: 2, md44: 2, md45: 10, md46: 8, md47: 5, md48: 1, \
              md30: 2 s, peh_window: 2 mm}";
    let drive = ", interface: open_loop, velocity_factor: {numerator: 1, denominator: 1000}, startup: [{index: 0x6083, value: 5000000, type: u32}]";
    let text = axis("g", 1, drive, wf).replace(", max_following_error: 5 mm", "");
    let cell = CanCell::new(&drives.address().to_string(), "4 ms", &text);
    let run = cell.run(
        "scenario: speeds
for: 6 s
steps:
  - {at: 500 ms, do: {enable: {axes: [g]}}}
  - when: {signal: g.state, is: STANDSTILL}
    do: {wf: {axis: g, mode: mdi, blocks: [{position: 100 mm, velocity: 20}], start: true}}
expect:
  - {signal: g.output.velocity, max: 100 mm/s}
  - {signal: g.output.velocity, is: 100 mm/s, mode: eventually}
  - {signal: g.actual.position, at: end, is: 100 mm, within: 2 mm}
  - {event: {kind: error}, mode: never}
",
    );
    run.until(&mut drives, 1, "fast", |shown| shown.velocity == 100_000);
    assert_eq!(drives.tell("get 1 0x6061 0")["value"], 2);
    run.passes();
}

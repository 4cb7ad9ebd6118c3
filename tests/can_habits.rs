//! Tests CANopen drives with peculiarities of real ones (tests/peers/can/habits.py), each with the same test.

use crate::support::can::CanDrives;
use crate::support::can_cell::{CanCell, Shown, axis};

/// Axis of each peculiarity, and the additional keys of its drive.
const HABITS: [(&str, &str, &str); 6] = [
    ("slow_words", "w", ""),
    ("late_homing", "h", ""),
    ("late_mode", "m", ""),
    ("ack_at_enable", "p", ", mode: pp, startup: [{index: 0x6081, value: 100000, type: u32}]"),
    ("fixed_pdos", "f", ""),
    ("unmapped_mode", "u", ""),
];

/// Returns the predicate for all axes.
fn all(signals: &[&str]) -> String {
    let of = |axis: &str| signals.iter().map(|signal| format!("{{signal: {axis}.{signal}}}")).collect::<Vec<_>>();
    let each: Vec<_> = HABITS.iter().flat_map(|(_, axis, _)| of(axis)).collect();
    format!("{{all: [{}]}}", each.join(", "))
}

/// Enabled, homed, moved exactly to the increment, with a fault that is reset, enabled and homed again: the zero is
/// that of the second homing, at an index pulse of the drive (1234 + n * 10000), and there is no other error than that
/// fault.
#[test]
fn drives_of_all_habits_are_enabled_homed_moved_and_reset() {
    let mut drives = CanDrives::boot("1-6");
    let homing = ", homing: {method: 33, in_drive: true, velocity: 50 mm/s, index_velocity: 20 mm/s, \
                  acceleration: 500 mm/s^2, max_distance: 100 mm}";
    let mut axes = String::new();
    for ((habit, name, drive), node) in HABITS.into_iter().zip(1..) {
        drives.tell(&format!("habit {node} {habit}"));
        let text = axis(name, node, drive, homing);
        axes += &if habit == "unmapped_mode" { text.replace("cia402_sim.eds", "unmapped.eds") } else { text };
    }
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let names = HABITS.map(|(_, axis, _)| axis);
    let each = |verb: &str, keys: &str| {
        let each: Vec<_> = names.iter().map(|axis| format!("{{{verb}: {{axis: {axis}{keys}}}}}")).collect();
        each.join(", ")
    };
    let run = cell.run(&format!(
        "scenario: habits
for: 14 s
steps:
  - {{when: {off}, do: {{enable: {{}}}}}}
  - {{when: {stand}, do: [{home}]}}
  - {{when: {homed}, do: [{go}]}}
  - {{when: {failed}, after: 300 ms, do: {{reset_errors: {{}}}}}}
  - {{when: {off}, after: 300 ms, do: {{enable: {{}}}}}}
  - {{when: {stand}, do: [{home}]}}
expect:
  - {{event: {{kind: homed}}, count: 12}}
  - {{event: {{kind: error, code: 0x18611}}, count: 6}}
  - {{event: {{kind: error}}, count: 6}}
  - {{all: [{at_zero}], at: end}}
",
        off = all(&["state, is: DISABLED", "drive_state, is: SWITCH_ON_DISABLED"]),
        stand = all(&["state, is: STANDSTILL"]),
        homed = all(&["state, is: STANDSTILL", "homed, is: 1"]),
        failed = all(&["drive_state, is: FAULT", "error, is: 0x18611"]),
        home = each("home_axis", ""),
        go = each("move_axis", ", position: 5 mm"),
        at_zero = names.map(|axis| format!("{{signal: {axis}.homed, is: 1}}")).join(", "),
    ));
    for node in 1..=6 {
        run.until(&mut drives, node, "moved", |shown| shown.position == 5_000);
    }
    drives.tell("fault * 0x8611");
    run.passes();
    for ((habit, ..), node) in HABITS.iter().zip(1..) {
        let Shown { machine, position, .. } = drives.shown(node);
        let zero = machine - position as f64 - 1_234.0;
        assert_eq!(zero.rem_euclid(10_000.0), 0.0, "{habit}: {machine} is {position}");
    }
}

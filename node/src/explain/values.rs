//! Explains values by name: constants of ROS types (`AT_POSITION`), names that a key or a parameter accepts
//! (`second_order`), and CiA 402 modes (`csp`), which have other names in a cell.

use super::section;
use crate::interfaces::short;
use crate::reference::{File, Key, Shape};
use lineshaft_core::parameter::{Measure, ROWS};
use lineshaft_msgs::INTERFACES;

/// Modes of operation: names in lower case with `_`, object 6060h, and keys of the drive.
const MODES: [(&[&str], &str, &str); 8] = [
    (
        &["csp", "cyclic_position", "cyclic_synchronous_position", "cyclic_synchronous_position_mode"],
        "mode 8",
        "drive: {interface: position}",
    ),
    (
        &["csv", "cyclic_velocity", "cyclic_synchronous_velocity", "cyclic_synchronous_velocity_mode"],
        "mode 9",
        "drive: {interface: velocity}",
    ),
    (
        &["cst", "cyclic_torque", "cyclic_synchronous_torque", "cyclic_synchronous_torque_mode"],
        "mode 10",
        "drive: {interface: torque}",
    ),
    (
        &["pp", "profile_position", "profile_position_mode"],
        "mode 1",
        "drive: {interface: position, mode: pp}, with a drive on CAN",
    ),
    (
        &["pv", "profile_velocity", "profile_velocity_mode"],
        "mode 3",
        "drive: {interface: velocity, mode: pv}, with a drive on CAN",
    ),
    (&["vl", "velocity_mode"], "mode 2", "drive: {interface: open_loop}, with a drive on CAN"),
    (
        &["tq", "profile_torque", "profile_torque_mode"],
        "mode 4",
        "drive: {interface: torque, mode: tq}, with a drive on CAN",
    ),
    (
        &["ip", "interpolated_position", "interpolated_position_mode"],
        "mode 7",
        "drive: {interface: position, mode: ip}, with a drive on CAN",
    ),
];

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let plain = name.to_lowercase().replace([' ', '-'], "_");
    let modes = MODES.iter().filter(|(names, ..)| names.contains(&plain.as_str()));
    let modes = modes.map(|(names, object, here)| {
        let facts = [("object", format!("6060h: {object}")), ("here", (*here).to_owned())];
        let facts = facts.each_ref().map(|(label, said)| (*label, said.as_str()));
        section(&format!("{}: a mode of operation of CiA 402", names[0]), &facts, width)
    });
    constants(name, width).into_iter().chain(choices(name, width)).chain(modes).collect()
}

pub(super) fn names() -> Vec<String> {
    let of_types = INTERFACES.iter().flat_map(|interface| interface.sections).flat_map(|part| part.constants);
    let of_types = of_types.map(|constant| constant.name);
    let of_keys = File::ALL.into_iter().flat_map(File::keys).flat_map(key_names);
    let of_parameters = ROWS.iter().flat_map(|row| measure_names(row.measure));
    let modes = MODES.iter().flat_map(|(names, ..)| *names).copied();
    of_types.chain(of_keys).chain(of_parameters).chain(modes).map(str::to_owned).collect()
}

/// Returns the names that a key accepts.
fn key_names(key: &'static Key) -> impl Iterator<Item = &'static str> {
    let names = |shape: &Shape| -> &'static [&'static str] {
        match shape {
            Shape::Choice(names) => names,
            _ => &[],
        }
    };
    key.shapes.iter().flat_map(names).copied()
}

fn measure_names(measure: Measure) -> impl Iterator<Item = &'static str> {
    let names: &'static [&'static str] = match measure {
        Measure::Choice(names) => names,
        _ => &[],
    };
    names.iter().copied()
}

/// Returns a section for each type that has a constant of that name.
fn constants(name: &str, width: usize) -> Vec<String> {
    let mut sections = Vec::new();
    for interface in INTERFACES {
        for constant in interface.sections.iter().flat_map(|part| part.constants) {
            if !constant.name.eq_ignore_ascii_case(name) {
                continue;
            }
            let value = constant.value.to_string();
            let facts: [(&str, &str); 3] =
                [("what", constant.doc), ("value", value.as_str()), ("documented", "docs/interfaces.md")];
            sections.push(section(
                &format!("{}: a constant of {}", constant.name, short(interface.name)),
                &facts,
                width,
            ));
        }
    }
    sections
}

/// Returns the keys and parameters that accept the name, in one section.
fn choices(name: &str, width: usize) -> Option<String> {
    let is_it = |known: &str| known.eq_ignore_ascii_case(name);
    let keys = File::ALL.into_iter().flat_map(File::keys).filter(|&key| key_names(key).any(is_it));
    let keys: Vec<String> = keys.map(|key| format!("{} of a {}", key.path, key.file.name())).collect();
    let rows = ROWS.iter().filter(|row| measure_names(row.measure).any(is_it)).map(|row| row.key);
    let (keys, rows) = (keys.join(", "), rows.collect::<Vec<_>>().join(", "));
    if keys.is_empty() && rows.is_empty() {
        return None;
    }
    let facts: [(&str, &str); 2] = [("keys", keys.as_str()), ("parameters", rows.as_str())];
    Some(section(&format!("{name}: a value that keys take"), &facts, width))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_cia402::mode::DriveMode;

    /// Each mode that key `mode` accepts, with its number, and with its interface.
    #[test]
    fn each_mode_of_a_drive_on_can_has_its_number_and_key() {
        for (name, mode) in DriveMode::NAMES {
            let (_, object, here) = MODES.iter().find(|(names, ..)| names[0] == name).expect(name);
            assert_eq!(*object, format!("mode {}", mode.number()));
            let is_usual = DriveMode::default_of(mode.interface()) == Some(mode);
            assert_eq!(here.contains(&format!("mode: {name}")), !is_usual, "{name}: {here}");
        }
        assert_eq!(MODES.len(), DriveMode::NAMES.len());
    }
}

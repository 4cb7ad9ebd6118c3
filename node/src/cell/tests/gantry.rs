//! Tests axes with two drives.

use super::{assert_said, good, said};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::sim::Model;

/// Returns a cell of nine lines, followed by the keys of the axis.
fn cell(keys: &str) -> String {
    format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends:\n  plant: {{type: sim}}\n  late: {{type: sim, delay: 1}}\n  bus0: {{type: can, transport: 'socketcan:can0'}}\n\
         axes:\n  x:\n    type: linear\n    unit: mm\n    scale: {{increments: 1000, per: 1 mm}}\n    max_velocity: 1 m/s\n    max_acceleration: 5\n{keys}"
    )
}

const BOTH: &str = "    drives: [{backend: plant, address: 0}, {backend: plant, address: 4}]\n";
const LIMIT: &str = "    max_skew: 0.2 mm\n";

fn refused(keys: &str, sentence: &str) {
    assert_said(&cell(keys), sentence);
}

#[test]
fn two_drives_make_an_axis() {
    let sim = "    sim: {model: ideal, start: 5 mm, home_switch: {from: 0 mm, to: 1 mm}, second: {start: 6 mm}}\n";
    let keys =
        format!("{BOTH}{LIMIT}    squaring_distance: 3 mm\n    skew_reaction: 2\n    square_offset: -1 mm\n{sim}");
    let cell = good(&cell(&keys));
    let MachineConfig { axes, .. } = &cell.machine;
    assert_eq!((axes[0].drive, axes[0].second, cell.machine.count_drives()), (axes[0].second, axes[0].drive, 2));
    assert!(axes[0].second.is_some());
    let gantry = axes[0].parameters.gantry;
    assert_eq!((gantry.max_skew, gantry.squaring_distance), (Some(200), Some(3_000)));
    assert_eq!((gantry.skew_reaction, gantry.square_offset), (2, Some(-1_000)));
    // The first drives of all axes are before the second ones.
    assert_eq!(cell.models, [Model::Ideal; 2]);
    let starts: Vec<_> = cell.mechanics.iter().map(|mechanics| mechanics.fixtures.start).collect();
    let homes: Vec<_> = cell.mechanics.iter().map(|mechanics| mechanics.fixtures.home).collect();
    assert_eq!((starts, homes), (vec![5_000, 6_000], vec![Some((0, 1_000)), None]));
    assert_eq!(cell.drives().map(|at| at.address.device).collect::<Vec<_>>(), [0, 4]);
    assert_eq!(cell.hardware_names(), [Some("plant:0, plant:4".to_owned())]);
    assert_eq!(cell.machine.check(), Ok(()));
}

#[test]
fn two_drives_have_the_longer_time_to_be_enabled() {
    for (first, second, timeout_ns) in [
        ("", "", 5_000_000_000),
        (", enable_timeout: 8 s", "", 8_000_000_000),
        (", enable_timeout: 1 s", ", enable_timeout: 2 s", 2_000_000_000),
    ] {
        let keys = format!(
            "    drives: [{{backend: plant, address: 0{first}}}, {{backend: plant, address: 4{second}}}]\n{LIMIT}"
        );
        assert_eq!(good(&cell(&keys)).machine.axes[0].enable_timeout_ns, timeout_ns);
    }
}

/// An axis after one with two drives keeps its index among the drives.
#[test]
fn the_second_drives_stand_behind_all_others() {
    let other = "  y: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, max_velocity: 1 m/s, max_acceleration: 1, drive: {backend: plant, address: 1}}\n";
    let cell = good(&cell(&format!("{BOTH}{LIMIT}{other}")));
    assert_eq!(cell.drives().map(|at| at.address.device).collect::<Vec<_>>(), [0, 1, 4]);
    assert_eq!((cell.machine.second_drive(0), cell.machine.second_drive(1)), (Some(2), None));
}

#[test]
fn both_hang_on_a_bus() {
    let cell = good(&cell(&format!("    drives: [{{backend: bus0, node: 4}}, {{backend: bus0, node: 5}}]\n{LIMIT}")));
    let buses = cell.on_can().buses(None).unwrap();
    let devices: Vec<_> = buses[0]
        .devices
        .iter()
        .filter_map(|device| device.drive().map(|drive| (drive.place, drive.object, drive.axis.as_str())))
        .collect();
    assert_eq!(devices, [(0, 0, "x"), (1, 0, "x")]);
}

#[test]
fn what_are_no_two_drives_is_refused() {
    refused(
        &format!("    drives: ^[{{backend: plant, address: 0}}]\n{LIMIT}"),
        "drives of axis `x` has 1 entry; 2 are expected",
    );
    let three = "[{backend: plant, address: 0}, {backend: plant, address: 1}, {backend: plant, address: 2}]";
    refused(&format!("    drives: ^{three}\n{LIMIT}"), "drives of axis `x` has 3 entries; 2 are expected");
    refused(
        &format!("    drive: ^{{backend: plant, address: 7}}\n{BOTH}{LIMIT}"),
        "drive stands beside drives; one of them is expected",
    );
    refused(
        &format!("    drives: [{{backend: plant, address: 0}}, ^virtual]\n{LIMIT}"),
        "drives has `virtual`; {backend: .., address: ..} is expected",
    );
    refused(
        &format!("    drives: [{{backend: plant, address: 3}}, {{backend: plant, address: ^3}}]\n{LIMIT}"),
        "drive address 3 of backend `plant` is taken already, at 14:40",
    );
    refused(
        &format!(
            "    drives: [{{backend: plant, address: 0}}, ^{{backend: plant, address: 1, interface: velocity}}]\n{LIMIT}"
        ),
        "interface is velocity; two drives of one axis have interface position",
    );
    refused(
        &format!("    drives: [{{backend: plant, address: 0}}, ^{{backend: late, address: 1}}]\n{LIMIT}"),
        "it has a delay of 1 cycles, the first drive one of 0; the same delay is expected",
    );
    refused(
        &format!("    drives: [{{backend: bus0, node: 4}}, ^{{backend: bus0, node: 5, probe_1: rising}}]\n{LIMIT}"),
        "a touch probe is for the first of two drives, which tells the position",
    );
    refused(
        &format!("    drives: [{{backend: bus0, node: 4, mode: ip}}, ^{{backend: bus0, node: 5}}]\n{LIMIT}"),
        "mode is csp, that of the first drive ip; the same mode is expected",
    );
    for drives in [
        "^{backend: bus0, node: 4, mode: pp}, {backend: bus0, node: 5}",
        "{backend: bus0, node: 4}, ^{backend: bus0, node: 5, mode: pp}",
    ] {
        refused(
            &format!("    drives: [{drives}]\n{LIMIT}"),
            "mode is pp, in which each drive has a profile of its own; two drives of one axis have csp or ip",
        );
    }
}

#[test]
fn skew_limit_requires_two_drives() {
    assert_eq!(said(&cell(BOTH)), "9:5: missing key `max_skew` in axis `x`");
    for value in ["0 mm", "-1 mm", ".nan", "0.0004 mm"] {
        let text = said(&cell(&format!("{BOTH}    max_skew: {value}\n")));
        assert!(text.contains("max_skew") || text.contains("is no"), "{value}: {text}");
        assert_eq!(text.lines().count(), 1, "{text}");
    }
    let one = "    drive: {backend: plant, address: 0}\n";
    for key in [
        "max_skew: ^0.2 mm",
        "skew_reaction: ^1",
        "squaring_distance: ^1 mm",
        "square_offset: ^0 mm",
        "i_refswitch_second: ^0",
    ] {
        let name = key.split(':').next().unwrap();
        refused(&format!("{one}    {key}\n"), &format!("{name} is for axes with two drives, leave it out"));
    }
    refused(
        &format!("{one}    sim: {{model: ideal, second: ^{{start: 1 mm}}}}\n"),
        "second is for an axis with two drives; this one has one, leave it out",
    );
}

#[test]
fn what_two_drives_do_not_do_is_refused_by_name() {
    for (key, sentence) in [
        (
            "homing: {method: ^33}",
            "homing.method 33 does not square an axis with two drives; 0, 3 to 14, 19 to 30, 35, 37 and -1 to -4 are allowed",
        ),
        (
            "homing: {method: 19, in_drive: ^true}",
            "homing.in_drive true would let each of two drives of the axis move alone; false is allowed",
        ),
        (
            "encodertype: ^9",
            "encodertype 9 names another source than the two drives of the axis, which close their loops themselves",
        ),
    ] {
        refused(&format!("{BOTH}{LIMIT}    {key}\n"), sentence);
    }
}

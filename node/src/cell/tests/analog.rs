//! Drives that are given a voltage, problem by problem.

use super::{assert_said, good, said};
use lineshaft_core::drive::{AnalogWiring, Capabilities, Interface};
use lineshaft_core::regulator::Law;

const HEAD: &str = "\
lineshaft: 1
cycle: 1 ms
backends:
  plant: {type: sim, delay: 2}
  bus0: {type: can, transport: 'socketcan:can0'}
io:
  other: {type: ao, backend: plant, address: 0}
  a: {type: ao, backend: plant, address: 1}
  c: {type: ao, backend: bus0, node: 10, address: 0}
  c5: {type: ao, backend: bus0, node: 10, address: 1, full_scale: 5 V}
  q: {type: do, backend: plant, address: 0}
  e: {type: do, backend: plant, address: 1}
  i: {type: di, backend: plant, address: 0}
  v: {type: di, output: q}
encoders:
  belt: {backend: plant, address: 0, bits: 32, type: linear, scale: {increments: 1000, per: 1 mm}}
axes:
";

const AXIS: &str =
    "type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, max_velocity: 300 mm/s, max_acceleration: 2";

fn cell(drive: &str, rest: &str) -> String {
    format!("{HEAD}  x: {{{AXIS}, drive: {drive}{rest}}}\n")
}

#[test]
fn a_voltage_is_wired_by_the_entries_of_io() {
    let keys = "reference: a, enable: e, ready: i, enable_time: 50 ms, interface: velocity, full_velocity: 400 mm/s";
    let read = good(&cell(&format!("{{{keys}, regulator: pid}}"), ", feedback: {encoder: belt}"));
    let axis = &read.machine.axes[0];
    let wiring = AnalogWiring { reference: 1, enable: 5, ready: Some(6), full: 400_000.0, enable_ns: 50_000_000 };
    assert_eq!((axis.analog, axis.interface, axis.law), (Some(wiring), Interface::Velocity, Law::Pid));
    let offers = Capabilities { delay: 2, velocity: true, ..Capabilities::default() };
    assert_eq!(axis.drive, Some(offers));
    assert_eq!(read.hardware_names(), [Some("a".to_owned())]);
    assert_eq!((read.real_axes(), read.backends[0].objects.drives.len()), (vec![false], 1));
    let bare = "{reference: a, enable: e, interface: torque, full_effort: 3000}";
    let rest = ", feedback: {encoder: belt}, max_effort: 3000, sim: {model: motor, inertia: 1e-4 kg*m^2, rated_torque: 1 Nm, counts_per_turn: 8192 inc}";
    let axis = &good(&cell(bare, rest)).machine.axes[0];
    let wiring = AnalogWiring { reference: 1, enable: 5, ready: None, full: 3000.0, enable_ns: 0 };
    assert_eq!((axis.analog, axis.interface), (Some(wiring), Interface::Torque));
}

/// No bus knows a drive at a module: it is real, and nothing of CAN is said of it.
#[test]
fn at_a_module_on_can_no_drive_is_on_the_bus() {
    let read = good(&cell(
        "{reference: c, enable: e, interface: velocity, full_velocity: 400 mm/s}",
        ", feedback: {encoder: belt}",
    ));
    assert_eq!((read.real_axes(), read.hardware_names()), (vec![true], vec![Some("c".to_owned())]));
    assert!(read.backends.iter().all(|backend| backend.objects.drives.is_empty()));
    assert_eq!(read.machine.axes[0].drive.map(|offers| (offers.delay, offers.homes)), Some((1, false)));
    let buses = read.buses(None).unwrap();
    assert_eq!(buses[0].devices.len(), 1);
}

#[test]
fn each_problem_has_its_place() {
    let usual = |drive: &str| cell(drive, ", feedback: {encoder: belt}");
    let velocity = "interface: velocity, full_velocity: 400 mm/s";
    for (drive, says) in [
        ("{reference: ^q, enable: e, VELOCITY}", "reference is `q`, which is a do; an ao is allowed"),
        ("{reference: a, enable: ^a, VELOCITY}", "enable is `a`, which is an ao; a do is allowed"),
        (
            "{reference: a, enable: e, ready: ^q, VELOCITY}",
            "ready is `q`, which is no di; a di is allowed, which reads 1 while all is well",
        ),
        (
            "{reference: a, enable: e, ready: ^v, VELOCITY}",
            "ready is `v`, which reads an output of the machine itself; a di with a backend and an address is allowed",
        ),
        ("^{reference: a, VELOCITY}", "missing key `enable` in drive of axis `x`"),
        ("^{reference: a, enable: e, full_velocity: 1 m/s}", "missing key `interface` in drive of axis `x`"),
        ("^{reference: a, enable: e, interface: velocity}", "missing key `full_velocity` in drive of axis `x`"),
        (
            "{reference: a, enable: e, interface: ^voltage, full_velocity: 1 m/s}",
            "interface is `voltage`; one of velocity, torque is allowed",
        ),
        (
            "{reference: a, enable: e, interface: velocity, full_velocity: ^0 mm/s}",
            "full_velocity is `0 mm/s`; a value above 0 is allowed",
        ),
        (
            "{reference: a, enable: e, enable_time: ^4.001 s, VELOCITY}",
            "enable_time is `4.001 s`; 0 s to 4 s is allowed",
        ),
        (
            "{reference: ^c5, enable: e, VELOCITY}",
            "reference is `c5`, whose full_scale is 5 V; 10 V are the full reference, and an ao that reaches them is allowed",
        ),
    ] {
        let drive = drive.replace("VELOCITY", velocity);
        assert_said(&usual(&drive), says);
    }
    assert_said(
        &usual("{reference: a, enable: e, interface: velocity, full_velocity: 400 mm/s, ^address: 3}"),
        "unknown key `address` in drive of axis `x`, known are interface, regulator, reference, enable, ready, enable_time, full_velocity",
    );
    assert_said(
        &cell(
            "{reference: a, enable: e, interface: torque, full_effort: ^-1}",
            ", feedback: {encoder: belt}, max_effort: 10, sim: {model: motor, inertia: 1e-4 kg*m^2, rated_torque: 1 Nm, counts_per_turn: 8192 inc}",
        ),
        "full_effort is `-1`; a number above 0 is allowed",
    );
}

/// What it is given has an end, and it tells nothing.
#[test]
fn more_than_its_full_reference_and_what_it_would_have_to_tell_are_refused() {
    let drive = "{reference: a, enable: e, interface: velocity, full_velocity: 200 mm/s}";
    let text = cell(drive, ", feedback: {encoder: belt}").replace("max_velocity: 300", "max_velocity: ^300");
    assert_said(
        &text,
        "max_velocity 300 mm/s lies above what its drive does at 10 V; full_velocity or full_effort at most is allowed",
    );
    let text = cell(&drive.replace("200", "300"), "").replace("  x:", "  ^x:");
    assert_said(
        &text,
        "encodertype of axis `x` is told by a drive on a bus, and this one is given a voltage; an entry of encoders as feedback, ampencno -1 and torque_constant 0 are allowed",
    );
}

#[test]
fn an_output_is_of_one_axis() {
    let drive = "{reference: a, enable: e, interface: velocity, full_velocity: 400 mm/s}";
    let one = cell(drive, ", feedback: {encoder: belt}");
    let other = drive.replace("enable: e", "enable: q");
    let both = said(&format!("{one}  y: {{{AXIS}, drive: {other}, feedback: {{encoder: belt}}}}\n"));
    assert!(both.starts_with("19:") && both.contains("output `a` is taken already, at 18:"), "{both}");
    let braked = said(&cell(&format!("{drive}, brake: {{output: e}}"), ", feedback: {encoder: belt}"));
    assert!(braked.contains("output `e` is taken already, at 18:"), "{braked}");
}

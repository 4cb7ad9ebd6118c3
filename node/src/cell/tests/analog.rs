//! Tests drives with a voltage reference.

use super::{assert_said, good, said};
use lineshaft_core::command::{Action, Command, Commands, Level, OutAn, Source};
use lineshaft_core::drive::{AnalogWiring, Backend, Capabilities, Interface};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
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
  ce: {type: do, backend: bus0, node: 10, address: 0}
  ci: {type: di, backend: bus0, node: 10, address: 0}
  other_ci: {type: di, backend: bus0, node: 11, address: 0}
  c5: {type: ao, backend: bus0, node: 10, address: 1, full_scale: 5 V}
  q: {type: do, backend: plant, address: 0}
  e: {type: do, backend: plant, address: 1}
  i: {type: di, backend: plant, address: 0}
  v: {type: di, output: q}
encoders:
  can_belt: {backend: bus0, node: 12, bits: 32, type: linear, scale: {increments: 1000, per: 1 mm}}
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
    let wiring = AnalogWiring { reference: 1, enable: 8, ready: Some(9), full: 400_000.0, enable_ns: 50_000_000 };
    assert_eq!((axis.analog, axis.interface, axis.law), (Some(wiring), Interface::Velocity, Law::Pid));
    let offers = Capabilities { delay: 2, velocity: true, ..Capabilities::default() };
    assert_eq!(axis.drive, Some(offers));
    assert_eq!(read.hardware_names(), [Some("a".to_owned())]);
    assert_eq!((read.real_axes(), read.backends[0].objects.drives.len()), (vec![false], 1));
    let bare = "{reference: a, enable: e, enable_time: 0 s, interface: torque, full_effort: 3000}";
    let rest = ", feedback: {encoder: belt}, max_effort: 3000, sim: {model: motor, inertia: 1e-4 kg*m^2, rated_torque: 1 Nm, counts_per_turn: 8192 inc}";
    let axis = &good(&cell(bare, rest)).machine.axes[0];
    let wiring = AnalogWiring { reference: 1, enable: 8, ready: None, full: 3000.0, enable_ns: 0 };
    assert_eq!((axis.analog, axis.interface), (Some(wiring), Interface::Torque));
}

const AT_MODULE: &str =
    "{reference: c, enable: ce, ready: ci, enable_time: 20 ms, interface: velocity, full_velocity: 400 mm/s}";

/// A drive at a module is on no bus: it is real, and has no keys for CAN.
#[test]
fn at_a_module_on_can_no_drive_is_on_the_bus() {
    let read = good(&cell(AT_MODULE, ", feedback: {encoder: can_belt}"));
    assert_eq!((read.real_axes(), read.hardware_names()), (vec![true], vec![Some("c".to_owned())]));
    assert!(read.backends.iter().all(|backend| backend.objects.drives.is_empty()));
    assert_eq!(read.machine.axes[0].drive.map(|offers| (offers.delay, offers.homes)), Some((1, false)));
    let buses = read.on_can().buses(None).unwrap();
    assert_eq!(buses[0].devices.iter().map(|device| device.node.get()).collect::<Vec<_>>(), [10, 11, 12]);
}

/// Its simulation moves: it is enabled by its contact, and 100 of 400 mm/s are 2.5 V.
#[test]
fn a_module_on_can_is_simulated_with_what_hangs_on_it() {
    let read =
        good(&cell(AT_MODULE, ", feedback: {encoder: can_belt}, max_following_error: 30 mm, sim: {model: velocity}"));
    let (mut plant, mut machine) = (read.plant(), Machine::new(read.machine.clone()).unwrap());
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut run = |cycles: u64, action: Option<Action>| {
        let command = action.map(|action| Command { sequence: 1, source: Source::Scenario, action });
        for cycle in 0..cycles {
            inputs.begin(machine.next_cycle(), 0);
            plant.read(&mut inputs);
            let due = command.as_slice().get(..usize::from(cycle == 0)).unwrap_or_default();
            machine.cycle(&inputs, Commands::queue(due), &mut outputs);
            plant.write(&outputs);
        }
        (outputs.analog[2], outputs.digital(0), inputs.encoder[0].count)
    };
    run(10, None);
    assert_eq!(run(100, Some(Action::Enable(AxisSet::one(0)))), (0.0, true, 0));
    // A third of max_velocity.
    let level = Level::Setpoint;
    let (volts, enable, count) = run(300, Some(Action::OutAn(OutAn { axis: 0, value: 1.0 / 3.0, level })));
    assert!((volts - 2.5).abs() < 1e-9 && enable, "{volts}");
    // 0.3 s, minus its lag of 5 ms and some cycles.
    assert!((29_000..29_700).contains(&count), "{count}");
}

#[test]
fn each_problem_has_its_place() {
    let usual = |drive: &str| cell(drive, ", feedback: {encoder: belt}");
    let velocity = "interface: velocity, full_velocity: 400 mm/s";
    for (drive, says) in [
        ("{reference: ^q, enable: e, enable_time: 0 s, VELOCITY}", "reference is `q`, which is a do; an ao is allowed"),
        ("{reference: a, enable: ^a, enable_time: 0 s, VELOCITY}", "enable is `a`, which is an ao; a do is allowed"),
        (
            "{reference: a, enable: e, ready: ^q, enable_time: 0 s, VELOCITY}",
            "ready is `q`, which is no di; a di is allowed, which reads 1 while all is well",
        ),
        (
            "{reference: a, enable: e, ready: ^v, enable_time: 0 s, VELOCITY}",
            "ready is `v`, which reads an output of the machine itself; a di with a backend and an address is allowed",
        ),
        ("^{reference: a, enable_time: 0 s, VELOCITY}", "missing key `enable` in drive of axis `x`"),
        (
            "^{reference: a, enable: e, enable_time: 0 s, full_velocity: 1 m/s}",
            "missing key `interface` in drive of axis `x`",
        ),
        (
            "^{reference: a, enable: e, enable_time: 0 s, interface: velocity}",
            "missing key `full_velocity` in drive of axis `x`",
        ),
        (
            "{reference: a, enable: e, enable_time: 0 s, interface: ^voltage, full_velocity: 1 m/s}",
            "interface is `voltage`; one of velocity, torque is allowed",
        ),
        (
            "{reference: a, enable: e, enable_time: 0 s, interface: velocity, full_velocity: ^0 mm/s}",
            "full_velocity is `0 mm/s`; a value above 0 is allowed",
        ),
        (
            "{reference: a, enable: e, enable_time: ^4.001 s, VELOCITY}",
            "enable_time is `4.001 s`; 0 s to 4 s is allowed",
        ),
        (
            "{reference: ^c5, enable: e, enable_time: 0 s, VELOCITY}",
            "reference is `c5`, whose full_scale is 5 V; 10 V are the full reference, and an ao that reaches them is allowed",
        ),
    ] {
        let drive = drive.replace("VELOCITY", velocity);
        assert_said(&usual(&drive), says);
    }
    for (drive, feedback, says) in [
        (
            AT_MODULE.replace("reference: c", "reference: ^c").replace("ready: ci, ", ""),
            "can_belt",
            "reference is on CAN, and nothing shows whether its module is there; ready, a di of the same node, is expected",
        ),
        (
            AT_MODULE.replace("enable: ce", "enable: ^e"),
            "can_belt",
            "enable is `e`, at another node than the reference; what drives an axis comes and goes together",
        ),
        (
            AT_MODULE.replace("ready: ci", "ready: ^other_ci"),
            "can_belt",
            "ready is `other_ci`, at another node than the reference; what drives an axis comes and goes together",
        ),
    ] {
        assert_said(&cell(&drive, &format!(", feedback: {{encoder: {feedback}}}")), says);
    }
    let mixed = said(&cell(AT_MODULE, ", feedback: {encoder: belt}"));
    assert!(
        mixed.ends_with(
            "feedback of axis `x` names an encoder that is simulated while its reference is not, or the other way round"
        ),
        "{mixed}"
    );
    let bare = said(&cell(
        AT_MODULE,
        ", feedback: {encoder: can_belt}, sim: {model: velocity, home_switch: {from: 10 mm, to: 20 mm}}",
    ));
    assert!(
        bare.contains(
            "home_switch has no input, and a drive that is given a voltage reads none itself; input is expected"
        ),
        "{bare}"
    );
    assert_said(
        &usual(
            "{reference: a, enable: e, enable_time: 0 s, interface: velocity, full_velocity: 400 mm/s, ^address: 3}",
        ),
        "unknown key `address` in drive of axis `x`, known are interface, regulator, reference, enable, ready, enable_time, full_velocity",
    );
    assert_said(
        &cell(
            "{reference: a, enable: e, enable_time: 0 s, interface: torque, full_effort: ^-1}",
            ", feedback: {encoder: belt}, max_effort: 10, sim: {model: motor, inertia: 1e-4 kg*m^2, rated_torque: 1 Nm, counts_per_turn: 8192 inc}",
        ),
        "full_effort is `-1`; a number above 0 is allowed",
    );
}

/// The reference is limited to 10 V, and the drive reports no values.
#[test]
fn excess_of_the_full_reference_and_unavailable_inputs_are_refused() {
    let drive = "{reference: a, enable: e, enable_time: 0 s, interface: velocity, full_velocity: 200 mm/s}";
    let text = cell(drive, ", feedback: {encoder: belt}").replace("max_velocity: 300", "max_velocity: ^300");
    assert_said(&text, "max_velocity 300 mm/s exceeds full_velocity 200 mm/s, which is what its drive does at 10 V");
    let text = cell(&drive.replace("200", "300"), "").replace("  x:", "  ^x:");
    assert_said(
        &text,
        "encodertype of axis `x` asks for what no drive that is given a voltage tells; an entry of encoders as feedback (encodertype 0), ampencno -1 and torque_constant 0 are allowed",
    );
}

#[test]
fn an_output_is_of_one_axis() {
    let drive = "{reference: a, enable: e, enable_time: 0 s, interface: velocity, full_velocity: 400 mm/s}";
    let one = cell(drive, ", feedback: {encoder: belt}");
    let other = drive.replace("enable: e", "enable: q");
    let both = said(&format!("{one}  y: {{{AXIS}, drive: {other}, feedback: {{encoder: belt}}}}\n"));
    assert!(both.starts_with("23:") && both.contains("output `a` is taken already, at 22:"), "{both}");
    let braked = said(&cell(&format!("{drive}, brake: {{output: e}}"), ", feedback: {encoder: belt}"));
    assert!(braked.contains("output `e` is taken already, at 22:"), "{braked}");
}

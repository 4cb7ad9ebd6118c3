//! Tests the interfaces of drives, their simulation, and the outputs of open-loop axes.

use super::axes::axis;
use super::{HEAD, assert_said, good, said};
use lineshaft_core::drive::Interface;
use lineshaft_core::drive::SpeedOutputs;
use lineshaft_core::sim::{Model, TwoSpeed, Valve, VelocityLag};

const MS: i64 = 1_000_000;
const CYCLE: u64 = 1_000_000;

fn drive(interface: &str) -> String {
    format!("{{backend: plant, address: 0, interface: {interface}}}")
}

#[test]
fn interfaces_and_the_models_that_fit_them() {
    let velocity = |ms| Model::Velocity(VelocityLag::new(ms * MS, CYCLE).unwrap());
    let two_speed = |run, coast| Model::TwoSpeed(TwoSpeed::new(run * MS, coast * MS, CYCLE).unwrap());
    let valve = |lag, dead_us: i64| Model::Valve(Valve::new(lag * MS, dead_us * 1000, CYCLE).unwrap());
    for (interface, sim, expected, model) in [
        ("position", "{model: ideal}", Interface::Position, Model::Ideal),
        ("velocity", "{model: ideal}", Interface::Velocity, Model::Ideal),
        ("velocity", "{model: velocity}", Interface::Velocity, velocity(5)),
        ("velocity", "{model: velocity, time_constant: 0 ms}", Interface::Velocity, velocity(0)),
        ("open_loop", "{model: ideal}", Interface::OpenLoop, Model::Ideal),
        ("open_loop", "{model: velocity, time_constant: 0.08}", Interface::OpenLoop, velocity(80)),
        ("open_loop", "{model: two_speed}", Interface::OpenLoop, two_speed(50, 100)),
        ("open_loop", "{model: two_speed, time_constant: 10 s, coast: 0 s}", Interface::OpenLoop, two_speed(10_000, 0)),
        ("open_loop", "{model: valve}", Interface::OpenLoop, valve(50, 20_000)),
        ("open_loop", "{model: valve, dead_time: 2.5 ms, time_constant: 7 ms}", Interface::OpenLoop, valve(7, 2_500)),
    ] {
        let cell = good(&axis(&[("drive", &drive(interface)), ("sim", sim)]));
        assert_eq!((cell.machine.axes[0].interface, cell.models[0]), (expected, model), "{interface} {sim}");
    }
    let second_order = good(&axis(&[("drive", &drive("velocity")), ("sim", "{model: second_order}")]));
    assert!(matches!(second_order.models[0], Model::SecondOrder(_)));
    assert_eq!(good(&axis(&[("drive", &drive("open_loop"))])).models, [Model::Ideal]);
    let virtual_axis = good(&axis(&[("drive", "virtual")]));
    assert_eq!(virtual_axis.machine.axes[0].interface, Interface::Position);
}

#[test]
fn unsuitable_model_is_refused_with_its_valid_use() {
    for (interface, sim, expected) in [
        (
            "position",
            "{model: velocity}",
            "model velocity is for interface velocity, open_loop; this drive has position",
        ),
        ("position", "{model: valve}", "model valve is for interface open_loop; this drive has position"),
        ("velocity", "{model: two_speed}", "model two_speed is for interface open_loop; this drive has velocity"),
        (
            "open_loop",
            "{model: second_order}",
            "model second_order is for interface position, velocity; this drive has open_loop",
        ),
    ] {
        let text = axis(&[("drive", &drive(interface)), ("sim", sim)]);
        assert_eq!(said(&text), format!("9:18: {expected}"));
    }
}

/// Proves: MACS-DIR-01, MACS-DIR-05
#[test]
fn senses_of_rotation_and_rules_of_reversing() {
    let with = |interface: &str, key: &str, value: &str| axis(&[("drive", &drive(interface)), (key, value)]);
    for (interface, key, value) in [
        ("position", "posdrct", "-1"),
        ("position", "posdrct", "-11"),
        ("velocity", "posdrct", "-22"),
        ("open_loop", "posdrct", "2"),
        ("position", "revers", "2"),
    ] {
        let cell = good(&with(interface, key, value));
        let macs = cell.machine.axes[0].parameters.macs;
        let found = if key == "revers" { macs.revers } else { macs.posdrct };
        assert_eq!(found.to_string(), value, "{interface}");
        assert_eq!(cell.machine.check(), Ok(()));
    }
    let in_drive =
        "inverts the position loop, which a drive with interface position closes itself; 1, 11, -1 and -11 are allowed";
    let one_loop = "inverts one loop and not the other, and both have one encoder; 1, 2, 11, 22 and their \
                    negatives are allowed";
    for (interface, key, value, expected) in [
        ("position", "posdrct", "2", format!("9:14: posdrct 2 {in_drive}")),
        ("velocity", "posdrct", "-12", format!("9:14: posdrct -12 {one_loop}")),
        (
            "position",
            "revers",
            "20",
            "9:13: revers 20 asks for outputs, which tell the sign of a velocity to drives with interface velocity or open_loop; \
             0, 1 and 2 are allowed"
                .to_owned(),
        ),
    ] {
        assert_eq!(said(&with(interface, key, value)), expected);
    }
    assert!(said(&with("position", "posdrct", "3")).starts_with("9:14: posdrct is `3`; -22 to -21"));
    let inverted = good(&axis(&[("drive", &drive("velocity")), ("sim", "{model: velocity, inverted: true}")]));
    let usual = good(&axis(&[("drive", &drive("velocity")), ("sim", "{model: velocity}")]));
    assert_eq!(inverted.models[0], usual.models[0].wired(true));
    assert_ne!(inverted.models[0], usual.models[0]);
}

#[test]
fn keys_and_values_of_models() {
    for (sim, expected) in [
        ("{model: two_speed, dead_time: 1 ms}", "9:40: dead_time is for models valve, motor; this one is two_speed"),
        ("{model: valve, coast: 1 ms}", "9:32: coast is for models second_order, two_speed; this one is valve"),
        (
            "{model: ideal, time_constant: 1 ms}",
            "9:40: time_constant is for models velocity, two_speed, valve; this one is ideal",
        ),
        (
            "{model: ideal, inverted: true}",
            "9:35: inverted is for models velocity, two_speed, valve, motor; this one is ideal",
        ),
        ("{model: velocity, inverted: 1}", "9:38: inverted is `1`; true or false is allowed, write `true`"),
        ("{model: velocity, damping: 1}", "9:37: damping is for model second_order; this one is velocity"),
        ("{model: velocity, time_constant: -1 ms}", "9:43: time_constant is -1 ms; 0 ms to 10000 ms is allowed"),
        ("{model: velocity, time_constant: 10001 ms}", "9:43: time_constant is 10001 ms; 0 ms to 10000 ms is allowed"),
        (
            "{model: two_speed, time_constant: 11 s, coast: 12 s}",
            "9:44: time_constant is 11000 ms; 0 ms to 10000 ms is allowed\n9:57: coast is 12000 ms; 0 ms to 10000 ms is allowed",
        ),
        ("{model: valve, dead_time: 1.001 s}", "9:36: dead_time is 1001 ms; 0 ms to 1000 ms is allowed"),
        (
            "{model: velocity, time_constant: 0.5 ns}",
            "9:43: time_constant: `0.5 ns` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years",
        ),
        (
            "{model: velocity, time_constant: 5 mm}",
            "9:43: time_constant: `5 mm` is a length; a time such as `5 s` is expected",
        ),
    ] {
        let text = axis(&[("drive", &drive("open_loop")), ("sim", sim)]);
        assert_eq!(said(&text), expected);
    }
}

#[test]
fn kv_lies_within_its_range() {
    let kv = |value| axis(&[("drive", &drive("velocity")), ("wf", value)]);
    assert_eq!(good(&kv("{md22: 1.5}")).machine.axes[0].parameters.position_loop.servo_gain(), 1.5);
    let whole = axis(&[("drive", &drive("velocity")), ("wf.md22", "2")]);
    assert_eq!(good(&whole).machine.axes[0].parameters.position_loop.servo_gain(), 2.0);
    assert_eq!(said(&kv("{md22: 0}")), "9:16: wf.md22 is `0`; 0.01 to 100 is allowed");
    let native = axis(&[("drive", &drive("velocity")), ("position_loop.kv", "25")]);
    assert_eq!(good(&native).machine.axes[0].parameters.position_loop.kv, 25.0);
    let nested = axis(&[("drive", &drive("velocity")), ("position_loop", "{kv: 25}")]);
    assert_eq!(good(&nested).machine.axes[0].parameters.position_loop.kv, 25.0);
    assert_eq!(said(&kv("{md22: 100.1}")), "9:16: wf.md22 is `100.1`; 0.01 to 100 is allowed");
    assert_eq!(
        said(&axis(&[("wf.md22", "2")])),
        "8:14: wf.md22 is for axes with interface velocity, torque or voltage and regulator proportional, leave it out"
    );
}

const IO: &str = "io:\n  fwd: {type: do, backend: plant, address: 0}\n  bwd: {type: do, backend: plant, address: 1}\n  \
                  in: {type: di, backend: plant, address: 0}\n  q1: {type: do, backend: plant, address: 2}\n  \
                  a1: {type: ao, backend: plant, address: 0}\n";

/// Returns two axes, x in open loop and y, with these keys in their sections `wf`.
fn wired(x: &str, y_drive: &str, y: &str) -> String {
    let axis = |name: &str, drive: &str, wf: &str| {
        format!(
            "  {name}:\n    {{type: linear, scale: {{increments: 1, per: 1 mm}}, max_velocity: 1, max_acceleration: 1,\n     \
             drive: {drive},\n     wf: {wf}}}\n"
        )
    };
    format!("{HEAD}{IO}axes:\n{}{}", axis("x", &drive("open_loop"), x), axis("y", y_drive, y))
}

#[test]
fn outputs_are_wired_by_name() {
    let y = "{backend: plant, address: 1, interface: open_loop}";
    let cell = good(&wired("{forward: fwd, backward: bwd, output: q1, dac: a1}", y, "{}"));
    let wiring = |axis: usize| cell.machine.axes[axis].open_loop;
    assert_eq!(wiring(0), SpeedOutputs { forward: Some(0), backward: Some(1), output: Some(3), dac: Some(4) });
    assert_eq!(wiring(1), SpeedOutputs::default());
    let cell = good(&wired("{output: q1}", y, "{dac: a1, forward: fwd}"));
    assert_eq!(cell.machine.axes[0].open_loop, SpeedOutputs { output: Some(3), ..SpeedOutputs::default() });
}

#[test]
fn outputs_must_exist_fit_and_belong_to_one_axis() {
    let open = "{backend: plant, address: 1, interface: open_loop}";
    for (x, y_drive, y, sentence) in [
        ("{forward: ^in}", open, "{}", "forward is `in`, which is a di; a do is allowed"),
        ("{output: ^a1}", open, "{}", "output is `a1`, which is an ao; a do is allowed"),
        ("{dac: ^q1}", open, "{}", "dac is `q1`, which is a do; an ao is allowed"),
        ("{dac: ^y}", open, "{}", "dac is `y`, which is an axis; input or output is allowed"),
        (
            "{output: ^q2}",
            open,
            "{}",
            "output is `q2`; no input or output has that name, there are fwd, bwd, in, q1, a1",
        ),
        ("{forward: fwd, backward: ^fwd}", open, "{}", "output `fwd` is taken already, at 16:20"),
        ("{output: q1}", open, "{output: ^q1}", "output `q1` is taken already, at 16:19"),
        ("{outptu: ^q1}", open, "{}", "unknown key `outptu` in wf, did you mean `output`?"),
        (
            "{}",
            "{backend: plant, address: 1, interface: velocity}",
            "{output: ^q1}",
            "output is for interface open_loop; axis `y` has interface velocity, leave it out",
        ),
        ("{}", "virtual", "{dac: ^a1}", "dac is for interface open_loop; axis `y` is virtual, leave it out"),
    ] {
        // An unknown key is reported at the key.
        let (x, y) = if x.contains("outptu") { ("{^outptu: q1}", y) } else { (x, y) };
        assert_said(&wired(x, y_drive, y), sentence);
    }
}

/// The two drives in docs/contract.md.
#[test]
fn the_drives_of_the_contract_are_good() {
    let contract = include_str!("../../../../docs/contract.md");
    let (_, behind) = contract.split_once("by interface of the drive:\n\n```\n").unwrap();
    let (block, _) = behind.split_once("```").unwrap();
    let common =
        "    type: linear\n    scale: {increments: 1, per: 1 mm}\n    max_velocity: 1\n    max_acceleration: 1\n";
    let axes: String = block
        .split("---\n")
        .zip(["x", "y"])
        .map(|(drive, name)| {
            let lines: String = drive.lines().map(|line| format!("    {line}\n")).collect();
            format!("  {name}:\n{common}{lines}")
        })
        .collect();
    let io = IO.replace("fwd:", "f:").replace("bwd:", "b:");
    let cell = good(&format!("{HEAD}{io}axes:\n{axes}"));
    let interfaces: Vec<_> = cell.machine.axes.iter().map(|axis| axis.interface).collect();
    assert_eq!(interfaces, [Interface::Velocity, Interface::OpenLoop]);
    assert!(cell.machine.axes[1].open_loop.dac.is_some());
    assert!(matches!(cell.models[..], [Model::Velocity(_), Model::TwoSpeed(_)]));
}

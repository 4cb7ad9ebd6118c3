//! Tests model motor: its data, and refusals.

use super::axes::axis;
use super::{assert_said, good, said};
use lineshaft_core::drive::Interface;
use lineshaft_core::sim::{Amplifier, Coupling, Friction, Load, Model, Motor, MotorData, Reading, Stage};

const VELOCITY: (&str, &str) = ("drive", "{backend: plant, address: 0, interface: velocity}");

/// Returns an axis with a motor that has the required keys and these.
fn with(keys: &str) -> String {
    let sim = format!("{{model: motor, inertia: 2.5e-4, rated_torque: 1.2 Nm, counts_per_turn: 65536 inc{keys}}}");
    axis(&[VELOCITY, ("sim", &sim)])
}

/// Returns an axis with a motor that has only these keys.
fn bare(keys: &str) -> String {
    axis(&[VELOCITY, ("sim", &format!("{{model: motor, {keys}}}"))])
}

fn usual() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction::default(),
        load: Load::default(),
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.2, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 65_536.0, noise: 0.0, seed: 0, at_load: false },
    }
}

fn model(data: MotorData) -> Model {
    Model::Motor(Motor::new(data).unwrap())
}

#[test]
fn a_motor_has_what_its_keys_say() {
    assert_eq!(good(&with("")).models, [model(usual())]);
    assert_eq!(
        good(&bare("inertia: 2.5e-4 kg*m^2, rated_torque: 1.2, counts_per_turn: 65536")).models,
        [model(usual())]
    );
    let text = with(
        ", inertia_ratio: 3, viscous_friction: 1e-4 Nm*s/rad, coulomb_friction: 0.02 Nm, static_friction: 0.03 Nm, stiffness: 400 Nm/rad, \
         coupling_damping: 0.05 Nm*s/rad, backlash: 180 deg, max_torque: 3 Nm, torque_lag: 500 us, dead_time: 1.25 ms, noise: 0.5 inc, \
         seed: 7, load_viscous_friction: 2e-4, load_coulomb_friction: 0.04, load_torque: -0.3 Nm, inverted: true",
    );
    let mut data = usual();
    data.friction = Friction { viscous: 1e-4, coulomb: 0.02, holding: 0.03 };
    let friction = Friction { viscous: 2e-4, coulomb: 0.04, holding: 0.04 };
    data.load = Load { inertia: 7.5e-4, friction, torque: -0.3 };
    data.coupling = Some(Coupling { stiffness: 400.0, damping: 0.05, backlash: std::f64::consts::PI });
    data.amplifier.stage = Stage::Torque { rated: 1.2, lag_ns: 500_000 };
    (data.amplifier.limit, data.amplifier.dead_time_ns) = (2.5, 1_250_000);
    (data.reading.noise, data.reading.seed) = (0.5, 7);
    let cell = good(&text);
    assert_eq!(cell.machine.axes[0].interface, Interface::Velocity);
    assert_eq!(cell.models, [model(data).wired(true)]);
}

/// The torque constant and the voltage constant of a winding are equal, unless both are given.
#[test]
fn winding_data_replace_the_rated_torque() {
    let winding = "inertia: 2.5e-4, counts_per_turn: 65536, voltage: 48 V, resistance: 1.2 Ohm, inductance: 3 mH, torque_constant: 0.4 Nm/A";
    let mut data = usual();
    let stage =
        |back_emf| Stage::Winding { voltage: 48.0, resistance: 1.2, inductance: 3e-3, torque_constant: 0.4, back_emf };
    data.amplifier = Amplifier { stage: stage(0.4), limit: 1.0, dead_time_ns: 0 };
    assert_eq!(good(&bare(winding)).models, [model(data)]);
    data.amplifier.stage = stage(0.5);
    assert_eq!(good(&bare(&format!("{winding}, back_emf: 0.5 V*s/rad"))).models, [model(data)]);
}

#[test]
fn an_encoder_of_the_axis_may_sit_on_the_load() {
    let belt = "encoders:\n  belt: {backend: plant, address: 0, type: linear, scale: {increments: 1000, per: 1 mm}}\n";
    let on_load = with(", encoder_at: load")
        .replace("axes:\n  x:\n", &format!("{belt}axes:\n  x:\n    feedback: {{encoder: belt}}\n"));
    let mut data = usual();
    data.reading.at_load = true;
    assert_eq!(good(&on_load).models, [model(data)]);
    assert_eq!(good(&on_load.replace("at: load", "at: motor")).models, [model(usual())]);
    assert_said(
        &with(", encoder_at: ^load"),
        "encoder_at is load, but the axis reads its drive, which sits on the motor; an entry of encoders is expected in key feedback",
    );
    assert!(said(&with(", encoder_at: shaft")).contains("encoder_at is `shaft`; one of motor, load is allowed"));
}

#[test]
fn what_is_outside_its_range_is_refused_by_name() {
    for (keys, expected) in [
        (", load_inertia: ^-1 kg*m^2", "load_inertia is -1 kg*m^2; 0 kg*m^2 to 1000000 kg*m^2 is allowed"),
        (
            ", stiffness: 1 Nm/rad, inertia_ratio: ^0",
            "load_inertia is 0 kg*m^2; 0.000000001 kg*m^2 to 1000000 kg*m^2 is allowed",
        ),
        (", viscous_friction: ^-1", "viscous_friction is -1 Nm*s/rad; 0 Nm*s/rad to 1000000 Nm*s/rad is allowed"),
        (
            ", coulomb_friction: 0.5, static_friction: ^0.4 Nm",
            "static_friction is 0.4 Nm; 0.5 Nm to 1000000 Nm is allowed",
        ),
        (
            ", max_torque: ^0 Nm",
            "max_torque is 0 times rated_torque; 0.001 times rated_torque to 1000 times rated_torque is allowed",
        ),
        (", torque_lag: ^2 s", "torque_lag is 2000 ms; 0 ms to 1000 ms is allowed"),
        (", dead_time: ^-1 ms", "dead_time is -1 ms; 0 ms to 1000 ms is allowed"),
        (
            ", dead_time: ^0.5 ns",
            "dead_time: `0.5 ns` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years",
        ),
        (", noise: ^-1 inc", "noise is -1 inc; 0 inc to 1000000 inc is allowed"),
        (", seed: ^-1", "seed is -1; 0..18446744073709551615 is allowed"),
        (", load_torque: ^5 N", "load_torque: `5 N` is a force; a torque such as `5 Nm` is expected"),
        (
            ", viscous_friction: ^1 Nm/rad",
            "viscous_friction: `1 Nm/rad` is a stiffness; a viscous friction such as `1 Nm*s/rad` is expected",
        ),
    ] {
        assert_said(&with(keys), expected);
    }
    // All problems at once.
    let text = with(", noise: -1, load_torque: 1e7 Nm, dead_time: 2 s");
    assert_eq!(said(&text).lines().count(), 3, "{}", said(&text));
}

#[test]
fn what_does_not_stand_together_is_refused() {
    for (keys, expected) in [
        (", ^backlash: 1 deg", "backlash is for a motor with stiffness; this one has none"),
        (", ^coupling_damping: 1", "coupling_damping is for a motor with stiffness; this one has none"),
        (", ^resistance: 1 Ohm", "resistance is for a motor with voltage; this one has none"),
        (", load_inertia: 1, ^inertia_ratio: 2", "inertia_ratio stands beside load_inertia; one of them is expected"),
        (", ^time_constant: 1 ms", "time_constant is for models velocity, two_speed, valve; this one is motor"),
        (", ^damping: 1", "damping is for model second_order; this one is motor"),
    ] {
        let (text, sentence) = (with(&keys.replace('^', "")), expected);
        assert!(said(&text).ends_with(sentence) && said(&text).lines().count() == 1, "{}", said(&text));
    }
    let both =
        bare("inertia: 1, counts_per_turn: 1, voltage: 1, resistance: 1, torque_constant: 1, rated_torque: 1 Nm");
    assert!(said(&both).ends_with("rated_torque stands beside voltage; one of them is expected"));
    let other = axis(&[VELOCITY, ("sim", "{model: velocity, backlash: 1 deg, encoder_at: load}")]);
    let sentences = said(&other);
    assert!(sentences.contains("backlash is for model motor; this one is velocity"), "{sentences}");
    assert!(sentences.contains("encoder_at is for model motor; this one is velocity"), "{sentences}");
}

#[test]
fn missing_required_keys_are_reported() {
    for (keys, missing) in [
        ("rated_torque: 1, counts_per_turn: 1", "inertia"),
        ("inertia: 1, counts_per_turn: 1", "rated_torque"),
        ("inertia: 1, rated_torque: 1", "counts_per_turn"),
        ("inertia: 1, counts_per_turn: 1, rated_torque: 1, stiffness: 1", "load_inertia"),
        ("inertia: 1, counts_per_turn: 1, voltage: 1, torque_constant: 1", "resistance"),
        ("inertia: 1, counts_per_turn: 1, voltage: 1, resistance: 1", "torque_constant"),
    ] {
        let sentence = said(&bare(keys));
        assert!(sentence.contains(missing) && sentence.lines().count() == 1, "{sentence}");
    }
    let position = axis(&[("sim", "{model: motor, inertia: 1, rated_torque: 1, counts_per_turn: 1}")]);
    assert!(said(&position).ends_with("model motor is for interface velocity, torque; this drive has position"));
}

/// A power stage needs a simulated motor with a winding, and a backend with voltages. Requirements of its current loop
/// are reported at the key.
///
/// Proves: MACS-AMP-09, MACS-AMP-10
#[test]
fn a_voltage_is_for_a_motor_with_a_winding() {
    const STAGE: (&str, &str) = ("drive", "{backend: plant, address: 0, interface: voltage, regulator: pid}");
    let winding = "{model: motor, inertia: 1e-4, counts_per_turn: 4000, voltage: 48 V, resistance: 1.2 Ohm, torque_constant: 0.4 Nm/A}";
    let of = |keys: &[(&str, &str)]| axis(&[&[STAGE, ("sim", winding), ("max_effort", "1000")], keys].concat());
    let currents = [("torque_constant", "25"), ("full_current", "10")];
    let cell = good(&of(&currents));
    assert_eq!(cell.machine.axes[0].interface, Interface::Voltage);
    assert_eq!(cell.machine.axes[0].parameters.power_stage.full_current, Some(10.0));
    for kind in ["0", "1"] {
        good(&of(&[&currents[..], &[("ampcommtype", kind), ("amppwmfreq", "24000")]].concat()));
    }
    let refused = [
        (
            of(&currents[..1]),
            "full_current of axis `x` is missing for the current loop of an axis with interface voltage",
        ),
        (
            of(&currents[1..]),
            "torque_constant of axis `x` is missing for the current loop of an axis with interface voltage",
        ),
        (
            of(&[&currents[..], &[("ampcommtype", "2")]].concat()),
            "ampcommtype 2 asks for a motor that is commutated here",
        ),
        (of(&[&currents[..], &[("ampcommtype", "7")]].concat()), "ampcommtype is `7`; 0 to 6 is allowed"),
        (
            of(&[&currents[..], &[("amppwmfreq", "32000")]].concat()),
            "amppwmfreq is 32000: a power stage whose frequency is set here",
        ),
        (
            axis(&[STAGE, ("max_effort", "1000"), ("ampmode", "3")]),
            "axis `x` has interface voltage and no simulated motor; sim is expected",
        ),
        (
            axis(&[
                STAGE,
                ("sim", "{model: motor, inertia: 1, rated_torque: 1, counts_per_turn: 1}"),
                ("ampmode", "1"),
            ]),
            "model motor is for interface velocity, torque; this drive has voltage, a voltage needs a winding",
        ),
    ];
    for (text, sentence) in refused {
        let told = said(&text);
        assert!(told.contains(sentence) && told.lines().count() == 1, "{told}");
    }
    let on_bus =
        |interface: &str| said(&axis(&[("drive", &format!("{{backend: bus0, node: 1, interface: {interface}}}"))]));
    assert!(on_bus("voltage").contains(
        "interface is voltage, for which CiA 402 has no mode; a drive on CAN has position, velocity, torque or open_loop"
    ));
}

//! Keys of the simulation of a drive.

use super::{
    ANY, BOOLEAN, FREQUENCY, LENGTH, MAP, NOT_NEGATIVE, NUMBER, POSITIVE, SEED, TEXT, TIME, TO_10_S, TORQUE, key,
};
use crate::reference::Key;
use crate::reference::Shape::{Choice, Quantity};

/// Keys of switches and index pulses of a simulated drive: of `sim`, and of `sim.second`.
macro_rules! fixtures {
    ($at:literal) => {
        [
            key(
                concat!($at, ".start"),
                LENGTH,
                [ANY, "0", "Position at the start, where the drive counts 0.", "start: 250 mm"],
            ),
            key(
                concat!($at, ".index"),
                MAP,
                ["", "none", "Index pulses of the encoder.", "index: {every: 10 mm, at: 3 mm}"],
            ),
            key(
                concat!($at, ".index.every"),
                LENGTH,
                [POSITIVE, "required", "Distance between two index pulses.", "every: 10 mm"],
            )
            .required(),
            key(concat!($at, ".index.at"), LENGTH, [ANY, "0", "Position of one of them.", "at: 3 mm"]),
            key(
                concat!($at, ".home_switch"),
                MAP,
                ["", "none", "Reference switch.", "home_switch: {from: 245 mm, to: 260 mm}"],
            ),
            key(
                concat!($at, ".home_switch.from"),
                LENGTH,
                [ANY, "required", "Lower end of the reference switch.", "from: 245 mm"],
            )
            .required(),
            key(
                concat!($at, ".home_switch.to"),
                LENGTH,
                ["`from` and above", "required", "Upper end of the reference switch.", "to: 260 mm"],
            )
            .required(),
            key(
                concat!($at, ".home_switch.input"),
                TEXT,
                ["a di of `io`", "an input of the drive", "Input to which the switch is wired.", "input: s1"],
            ),
            key(
                concat!($at, ".home_switch.normally_closed"),
                BOOLEAN,
                ["", "false", "Whether the input reads 0 while the switch is actuated.", "normally_closed: true"],
            ),
            key(
                concat!($at, ".negative_limit_switch"),
                MAP,
                ["", "none", "Limit switch in negative direction.", "negative_limit_switch: {at: -60 mm}"],
            ),
            key(
                concat!($at, ".negative_limit_switch.at"),
                LENGTH,
                [ANY, "required", "Position up to which the switch is actuated.", "at: -60 mm"],
            )
            .required(),
            key(
                concat!($at, ".negative_limit_switch.input"),
                TEXT,
                ["a di of `io`", "an input of the drive", "Input to which the switch is wired.", "input: s2"],
            ),
            key(
                concat!($at, ".negative_limit_switch.normally_closed"),
                BOOLEAN,
                ["", "false", "Whether the input reads 0 while the switch is actuated.", "normally_closed: true"],
            ),
            key(
                concat!($at, ".positive_limit_switch"),
                MAP,
                ["", "none", "Limit switch in positive direction.", "positive_limit_switch: {at: 900 mm}"],
            ),
            key(
                concat!($at, ".positive_limit_switch.at"),
                LENGTH,
                [ANY, "required", "Position from which the switch is actuated.", "at: 900 mm"],
            )
            .required(),
            key(
                concat!($at, ".positive_limit_switch.input"),
                TEXT,
                ["a di of `io`", "an input of the drive", "Input to which the switch is wired.", "input: s3"],
            ),
            key(
                concat!($at, ".positive_limit_switch.normally_closed"),
                BOOLEAN,
                ["", "false", "Whether the input reads 0 while the switch is actuated.", "normally_closed: true"],
            ),
        ]
    };
}

/// Keys of the model of a simulated drive.
pub(super) const SIM: &[Key] = &[
    key(
        "axes.*.sim",
        MAP,
        ["", "{model: ideal}", "How the drive is simulated.", "sim: {model: second_order, bandwidth: 60 Hz}"],
    ),
    key(
        "axes.*.sim.model",
        &[Choice(&["ideal", "second_order", "velocity", "two_speed", "valve", "motor"])],
        ["", "required", "Model of the drive.", "model: motor"],
    )
    .required(),
    key(
        "axes.*.sim.bandwidth",
        FREQUENCY,
        ["above 0 Hz up to 100 kHz", "60 Hz", "Bandwidth of model second_order.", "bandwidth: 30 Hz"],
    ),
    key("axes.*.sim.damping", NUMBER, ["0.01 to 100", "0.8", "Damping ratio of model second_order.", "damping: 1"]),
    key(
        "axes.*.sim.time_constant",
        TIME,
        [
            TO_10_S,
            "5 ms of velocity, else 50 ms",
            "Time constant of models velocity, two_speed and valve.",
            "time_constant: 20 ms",
        ],
    ),
    key(
        "axes.*.sim.coast",
        TIME,
        [
            TO_10_S,
            "100 ms of two_speed, 0 s of second_order",
            "Time constant of models two_speed and second_order without power; 0 s: stops at once.",
            "coast: 80 ms",
        ],
    ),
    key(
        "axes.*.sim.dead_time",
        TIME,
        ["0 s to 1 s", "20 ms of valve, 0 s of motor", "Dead time of models valve and motor.", "dead_time: 2 ms"],
    ),
    key(
        "axes.*.sim.inverted",
        BOOLEAN,
        [
            "",
            "false",
            "Whether the motor is wired with swapped leads; not of ideal and second_order.",
            "inverted: true",
        ],
    ),
    key(
        "axes.*.sim.inertia",
        &[Quantity("inertia")],
        ["1e-9 kg*m^2 to 1e6 kg*m^2", "required of motor", "Inertia of the motor.", "inertia: 0.0003 kg*m^2"],
    ),
    key(
        "axes.*.sim.load_inertia",
        &[Quantity("inertia")],
        [NOT_NEGATIVE, "0; required with `stiffness`", "Inertia of the load.", "load_inertia: 0.001 kg*m^2"],
    ),
    key(
        "axes.*.sim.inertia_ratio",
        &[Quantity("ratio")],
        [
            NOT_NEGATIVE,
            "none",
            "Inertia of the load in parts of that of the motor, in place of `load_inertia`.",
            "inertia_ratio: 3",
        ],
    ),
    key(
        "axes.*.sim.viscous_friction",
        &[Quantity("viscous friction")],
        [NOT_NEGATIVE, "0", "Viscous friction of the motor.", "viscous_friction: 0.0001 Nm*s/rad"],
    ),
    key(
        "axes.*.sim.coulomb_friction",
        TORQUE,
        [NOT_NEGATIVE, "0", "Coulomb friction of the motor.", "coulomb_friction: 0.02 Nm"],
    ),
    key(
        "axes.*.sim.static_friction",
        TORQUE,
        [
            "`coulomb_friction` and above",
            "`coulomb_friction`",
            "Static friction of the motor.",
            "static_friction: 0.03 Nm",
        ],
    ),
    key(
        "axes.*.sim.load_viscous_friction",
        &[Quantity("viscous friction")],
        [NOT_NEGATIVE, "0", "Viscous friction of the load.", "load_viscous_friction: 0.0001 Nm*s/rad"],
    ),
    key(
        "axes.*.sim.load_coulomb_friction",
        TORQUE,
        [NOT_NEGATIVE, "0", "Coulomb friction of the load.", "load_coulomb_friction: 0.02 Nm"],
    ),
    key(
        "axes.*.sim.load_static_friction",
        TORQUE,
        [
            "`load_coulomb_friction` and above",
            "`load_coulomb_friction`",
            "Static friction of the load.",
            "load_static_friction: 0.03 Nm",
        ],
    ),
    key(
        "axes.*.sim.load_torque",
        TORQUE,
        ["-1e6 Nm to 1e6 Nm", "0", "Constant torque on the load.", "load_torque: 0.1 Nm"],
    ),
    key(
        "axes.*.sim.stiffness",
        &[Quantity("stiffness")],
        [POSITIVE, "rigid", "Stiffness of the coupling between motor and load.", "stiffness: 500 Nm/rad"],
    ),
    key(
        "axes.*.sim.coupling_damping",
        &[Quantity("viscous friction")],
        [NOT_NEGATIVE, "0", "Damping of the coupling; needs `stiffness`.", "coupling_damping: 0.01 Nm*s/rad"],
    ),
    key(
        "axes.*.sim.backlash",
        &[Quantity("angle")],
        ["0 to one turn", "0", "Backlash of the coupling; needs `stiffness`.", "backlash: 0.1 deg"],
    ),
    key(
        "axes.*.sim.rated_torque",
        TORQUE,
        [
            "1e-6 Nm to 1e6 Nm",
            "required of motor without `voltage`",
            "Rated torque of the motor.",
            "rated_torque: 1.3 Nm",
        ],
    ),
    key(
        "axes.*.sim.max_torque",
        TORQUE,
        [
            "0.001 to 1000 times `rated_torque`",
            "3 times `rated_torque`",
            "Torque that the motor makes at most.",
            "max_torque: 4 Nm",
        ],
    ),
    key("axes.*.sim.torque_lag", TIME, ["0 s to 1 s", "0 s", "Time constant of the torque loop.", "torque_lag: 1 ms"]),
    key(
        "axes.*.sim.voltage",
        &[Quantity("voltage")],
        [POSITIVE, "a motor with rated torque", "Voltage at full output, of a motor with a winding.", "voltage: 48 V"],
    ),
    key(
        "axes.*.sim.resistance",
        &[Quantity("resistance")],
        [POSITIVE, "required with `voltage`", "Resistance of the winding.", "resistance: 0.6 Ohm"],
    ),
    key(
        "axes.*.sim.inductance",
        &[Quantity("inductance")],
        [NOT_NEGATIVE, "0", "Inductance of the winding.", "inductance: 0.2 mH"],
    ),
    key(
        "axes.*.sim.torque_constant",
        &[Quantity("torque constant")],
        [POSITIVE, "required with `voltage`", "Torque per current of the motor.", "torque_constant: 0.05 Nm/A"],
    ),
    key(
        "axes.*.sim.back_emf",
        &[Quantity("voltage constant")],
        [NOT_NEGATIVE, "`torque_constant`", "Voltage per speed of the motor.", "back_emf: 0.05 V*s/rad"],
    ),
    key(
        "axes.*.sim.counts_per_turn",
        &[Quantity("increments")],
        [
            "1 inc to 2^32 inc",
            "required of motor",
            "Increments of the axis per revolution of the motor.",
            "counts_per_turn: 131072",
        ],
    ),
    key(
        "axes.*.sim.noise",
        &[Quantity("increments")],
        [NOT_NEGATIVE, "0", "Standard deviation of the noise of the encoder.", "noise: 0.5 inc"],
    ),
    key("axes.*.sim.seed", SEED, ["", "0", "Seed of the noise.", "seed: 7"]),
    key(
        "axes.*.sim.encoder_at",
        &[Choice(&["motor", "load"])],
        ["", "motor", "Place of the encoder that the axis reads from `encoders`.", "encoder_at: load"],
    ),
    key(
        "axes.*.sim.hanging_load",
        &[Quantity("acceleration")],
        [ANY, "0", "Acceleration of the load while neither power nor brake holds it.", "hanging_load: -9.81 m/s^2"],
    ),
    key("axes.*.sim.brake_opens", TIME, [TO_10_S, "0 s", "Time until the brake is open.", "brake_opens: 50 ms"]),
    key("axes.*.sim.brake_closes", TIME, [TO_10_S, "0 s", "Time until the brake is closed.", "brake_closes: 40 ms"]),
    key(
        "axes.*.sim.second",
        MAP,
        ["", "as the first drive", "Switches and index pulses of the second of two drives.", "second: {start: 1 mm}"],
    ),
];

pub(super) const FIXTURES: &[Key] = &fixtures!("axes.*.sim");
pub(super) const SECOND: &[Key] = &fixtures!("axes.*.sim.second");

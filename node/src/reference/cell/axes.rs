//! Keys of axes.

use super::{BOOLEAN, KIND, LIST, MAP, NAMES, NUMBER, POSITIVE, TEXT, TIME, TO_10_S, key};
use crate::reference::Key;
use crate::reference::Shape::{Choice, Map, Quantity, Text};

pub(super) const AXES: &[Key] = &[
    key("axes", NAMES, ["", "none", "The axes, at most 512; their order is that of all messages.", "axes: {x: {..}}"]),
    key(
        "axes.*",
        MAP,
        [
            "",
            "",
            "One axis. Its parameters are keys, too: docs/parameters.md and the table at the end of this page.",
            "",
        ],
    ),
    key("axes.*.type", KIND, ["", "required", "Linear (m) or rotary (rad).", "type: linear"]).required(),
    key(
        "axes.*.scale",
        MAP,
        [
            "",
            "required without the unit factors of MACS",
            "Increments per distance.",
            "scale: {increments: 1048576, per: 10 mm}",
        ],
    ),
    key(
        "axes.*.scale.increments",
        NUMBER,
        ["above 0, also a fraction", "required", "Increments.", "increments: 1048576"],
    )
    .required(),
    key("axes.*.scale.per", &[Quantity("length or angle")], [POSITIVE, "required", "Their distance.", "per: 10 mm"])
        .required(),
    key(
        "axes.*.unit",
        &[Text],
        ["a unit, or a number of one", "SI", "Unit in which people read the axis (user unit).", "unit: mm"],
    ),
    key(
        "axes.*.joint",
        TEXT,
        ["1 to 64 characters", "the name of the axis", "Joint name in ROS 2.", "joint: shoulder_pan"],
    ),
    key(
        "axes.*.modulo",
        &[Quantity("angle or increments")],
        [
            POSITIVE,
            "none",
            "One turn of a rotary axis: goals are within it. Shown positions are unwrapped; signal modulo.position is within the turn.",
            "modulo: 360 deg",
        ],
    ),
    key(
        "axes.*.drive",
        &[Map, Choice(&["virtual"])],
        [
            "",
            "required without `drives`",
            "The drive of the axis; `virtual` is an axis without a motor.",
            "drive: {backend: plant, address: 0}",
        ],
    ),
    key(
        "axes.*.drives",
        LIST,
        [
            "two entries",
            "one drive",
            "Two drives that move the axis together (gantry).",
            "drives: [{backend: plant, address: 0}, {backend: plant, address: 1}]",
        ],
    ),
    key("axes.*.drives[]", MAP, ["", "", "One of the two drives, with interface position.", ""]),
];

/// Keys of a drive with an analog reference.
pub(super) const ANALOG: &[Key] = &[
    key(
        "axes.*.drive.reference",
        TEXT,
        [
            "an ao of `io`",
            "a drive on a backend",
            "Output of the voltage that commands the drive, -10 V to 10 V.",
            "reference: speed",
        ],
    ),
    key(
        "axes.*.drive.enable",
        TEXT,
        ["a do of `io`", "required with `reference`", "Output that enables the drive.", "enable: x_enable"],
    ),
    key(
        "axes.*.drive.ready",
        TEXT,
        ["a di of `io`", "none; required on CAN", "Input that reads 1 while the drive is ready.", "ready: x_ready"],
    ),
    key(
        "axes.*.drive.enable_time",
        TIME,
        [
            "0 s to 4 s",
            "required with `reference`",
            "Time from the enable output until the drive follows.",
            "enable_time: 50 ms",
        ],
    ),
    key(
        "axes.*.drive.full_velocity",
        &[Quantity("velocity")],
        [POSITIVE, "required with interface velocity", "Velocity of the axis at 10 V.", "full_velocity: 1.5 m/s"],
    ),
    key(
        "axes.*.drive.full_effort",
        NUMBER,
        [
            POSITIVE,
            "required with interface torque",
            "Effort of the axis at 10 V, in parts of the rated torque.",
            "full_effort: 3",
        ],
    ),
];

pub(super) const FEEDBACK: &[Key] = &[
    key(
        "axes.*.feedback",
        MAP,
        ["", "the drive, 64 bits", "Source of the actual position.", "feedback: {encoder: belt}"],
    ),
    key(
        "axes.*.feedback.encoder",
        TEXT,
        ["a name of `encoders`", "the drive", "Encoder that the axis reads instead of its drive.", "encoder: belt"],
    ),
];

/// Sections of parameters of an axis, and their keys that are no parameters.
pub(super) const SECTIONS: &[Key] = &[
    key(
        "axes.*.brake",
        MAP,
        ["", "none", "Holding brake that Lineshaft switches.", "brake: {output: b1, release_delay: 60 ms}"],
    ),
    key("axes.*.brake.output", TEXT, ["a do of `io`", "required", "Output of the brake; 1 opens it.", "output: b1"])
        .required(),
    key("axes.*.brake.inverted", BOOLEAN, ["", "false", "Whether 1 closes the brake.", "inverted: true"]),
    key(
        "axes.*.brake.release_delay",
        TIME,
        [TO_10_S, "0 s", "Time that the brake needs to open; the axis waits for it.", "release_delay: 60 ms"],
    ),
    key(
        "axes.*.brake.engage_delay",
        TIME,
        [TO_10_S, "0 s", "Time that the brake needs to close; power stays on for it.", "engage_delay: 50 ms"],
    ),
    key("axes.*.homing", MAP, ["", "defaults", "Parameters of homing.", "homing: {method: 35}"]),
    key("axes.*.position_loop", MAP, ["", "defaults", "Parameters of the position loop.", "position_loop: {kv: 20}"]),
    key(
        "axes.*.velocity_loop",
        MAP,
        ["", "defaults", "Parameters of the velocity loop.", "velocity_loop: {bandwidth: 100 Hz}"],
    ),
    key("axes.*.compensation", MAP, ["", "none", "Backlash and pitch error.", "compensation: {backlash: 20 um}"]),
    key(
        "axes.*.compensation.pitch_error",
        TEXT,
        ["a name of `tables`", "none", "Table of the pitch error of the axis.", "pitch_error: screw"],
    ),
    key("axes.*.amc", MAP, ["", "defaults", "Parameters in the words of AMC.", "amc: {stop_mode: 1}"]),
    key(
        "axes.*.amc.master",
        TEXT,
        ["an axis, an encoder or a master", "none", "Master of the reference selector.", "master: line"],
    ),
    key(
        "axes.*.amc.freeze",
        TEXT,
        ["a latching di, an encoder or an axis", "none", "Latch that the reference selector uses.", "freeze: mark"],
    ),
    key("axes.*.amc.cam", TEXT, ["a name of `tables`", "none", "Cam of the reference selector.", "cam: knife"]),
    key("axes.*.saia", MAP, ["", "defaults", "Parameters in the words of SAIA.", "saia: {kprop: 100}"]),
    key(
        "axes.*.wf",
        MAP,
        ["", "defaults", "Parameters in the words of WF, and outputs of an axis in open loop.", "wf: {md22: 1}"],
    ),
    key("axes.*.wf.forward", TEXT, ["a do of `io`", "none", "Output for forward, interface open_loop.", "forward: f"]),
    key(
        "axes.*.wf.backward",
        TEXT,
        ["a do of `io`", "none", "Output for backward, interface open_loop.", "backward: b"],
    ),
    key(
        "axes.*.wf.output",
        TEXT,
        ["a do of `io`", "none", "Output of the speed selection, interface open_loop.", "output: q1"],
    ),
    key(
        "axes.*.wf.dac",
        TEXT,
        ["an ao of `io`", "none", "Output of the speed as a voltage, interface open_loop.", "dac: a1"],
    ),
];

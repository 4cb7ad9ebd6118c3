//! Keys of tables, programs, functions, masters and groups.

use super::{BOOLEAN, I32, LIST, MAP, NAMES, NUMBER, TEXT, TIME, key};
use crate::reference::Key;
use crate::reference::Shape::{Choice, Integer, List, Map, Text};

pub(super) const TABLES: &[Key] = &[
    key("tables", NAMES, ["", "none", "Tables of functions and cams.", "tables: {knife: {form: y, csv: knife.csv}}"]),
    key("tables.*", MAP, ["", "", "One table.", ""]),
    key(
        "tables.*.form",
        &[Choice(&["y", "xy", "words"])],
        ["", "required", "Values at equal distances, points with their place, or plain words.", "form: xy"],
    )
    .required(),
    key(
        "tables.*.points",
        LIST,
        ["", "required without `csv`, of forms y and xy", "Points of the table.", "points: [[0, 0], [1000, 500]]"],
    ),
    key(
        "tables.*.points[]",
        &[Integer(I32.0, I32.1), List],
        ["", "", "A value, of form xy a pair [master, slave].", ""],
    ),
    key("tables.*.points[][]", &[Integer(I32.0, I32.1)], ["", "", "Master and slave (inc).", ""]),
    key(
        "tables.*.words",
        LIST,
        ["", "required without `csv`, of form words", "Numbers of the table.", "words: [1, 2, 3]"],
    ),
    key("tables.*.words[]", &[Integer(I32.0, I32.1)], ["", "", "A number.", ""]),
    key(
        "tables.*.csv",
        TEXT,
        ["a file next to the cell", "none", "File with the numbers of the table.", "csv: knife.csv"],
    ),
    key("tables.*.cam", MAP, ["", "no cam", "Makes the table a cam.", "cam: {length: 20000}"]),
    key(
        "tables.*.cam.length",
        &[Integer(1, i32::MAX as i128)],
        [
            "",
            "required of form y",
            "Master increments of one period; not of form xy, which has its own.",
            "length: 20000",
        ],
    ),
    key("tables.*.cam.cyclic", BOOLEAN, ["", "true", "Whether the cam repeats.", "cyclic: false"]),
    key(
        "tables.*.cam.interpolation",
        &[Choice(&["linear", "cubic", "quintic"])],
        ["", "linear", "Curve between two points.", "interpolation: quintic"],
    ),
];

pub(super) const PROGRAMS: &[Key] = &[
    key(
        "programs",
        NAMES,
        ["", "none", "Programs of the user for functions of type apsf.", "programs: {law: {wasm: law.wasm}}"],
    ),
    key("programs.*", MAP, ["", "", "One program.", ""]),
    key("programs.*.wasm", TEXT, ["a file next to the cell", "required", "WebAssembly module.", "wasm: law.wasm"])
        .required(),
];

pub(super) const FUNCTIONS: &[Key] = &[
    key(
        "functions",
        NAMES,
        ["", "none", "Function slots.", "functions: {ratio: {slot: 0, type: varsync, source: belt, sink: x}}"],
    ),
    key("functions.*", MAP, ["", "", "One slot. The fields of its type are keys, too: docs/functions.md.", ""]),
    key(
        "functions.*.slot",
        &[Integer(0, 255)],
        ["", "required", "Number of the slot; slots are computed in this order.", "slot: 0"],
    )
    .required(),
    key(
        "functions.*.type",
        TEXT,
        ["a type of docs/functions.md", "required", "Type of the function.", "type: varsync"],
    )
    .required(),
    key(
        "functions.*.source",
        TEXT,
        [
            "a leader, a signal or none",
            "required, by the type",
            "Input value of the function.",
            "source: belt.position",
        ],
    ),
    key(
        "functions.*.sink",
        TEXT,
        [
            "an axis, a memory cell, an ao or none",
            "required, by the type",
            "Object that the function writes.",
            "sink: turret",
        ],
    ),
    key(
        "functions.*.quantity",
        &[Choice(&["position", "speed"])],
        ["", "by the type", "Quantity of the sink.", "quantity: speed"],
    ),
    key("functions.*.source_bits", &[Integer(16, 64)], ["16, 32, 64", "64", "Width of the source.", "source_bits: 16"]),
    key("functions.*.sink_bits", &[Integer(16, 64)], ["16, 32, 64", "64", "Width of the sink.", "sink_bits: 16"]),
    key("functions.*.inputs", LIST, ["", "none", "Inputs E1, E2 and so on of the function.", "inputs: [start]"]),
    key("functions.*.inputs[]", &[Text, Map], ["a di, a bit or none", "", "One input.", ""]),
    key("functions.*.inputs[].name", TEXT, ["a di, a bit or none", "required", "Its name.", "name: start"]).required(),
    key("functions.*.inputs[].inverted", BOOLEAN, ["", "false", "Whether 0 counts as 1.", "inverted: true"]),
    key("functions.*.outputs", LIST, ["", "none", "Outputs A1, A2 and so on of the function.", "outputs: [lamp]"]),
    key("functions.*.outputs[]", &[Text, Map], ["a do, a bit or none", "", "One output.", ""]),
    key("functions.*.outputs[].name", TEXT, ["a do, a bit or none", "required", "Its name.", "name: lamp"]).required(),
    key("functions.*.outputs[].inverted", BOOLEAN, ["", "false", "Whether 1 is written as 0.", "inverted: true"]),
    key("functions.*.tables", LIST, ["", "none", "Tables of the function.", "tables: [knife]"]),
    key("functions.*.tables[]", TEXT, ["a name of `tables`, or none", "", "One table.", ""]),
    key(
        "functions.*.cycle_factor",
        &[Integer(1, 255)],
        ["", "1", "Cycles from one call to the next.", "cycle_factor: 4"],
    ),
    key(
        "functions.*.on_axis_error",
        &[Choice(&["run", "reset"])],
        ["", "run", "Reaction of the function to an error of the axis that it moves.", "on_axis_error: reset"],
    ),
    key(
        "functions.*.program",
        TEXT,
        ["a name of `programs`", "required of apsf", "Program of type apsf.", "program: law"],
    ),
    key(
        "functions.*.fuel",
        &[Integer(1, 10_000_000)],
        ["", "50000", "Instructions that a call of the program may take.", "fuel: 20000"],
    ),
    key("functions.*.reads", LIST, ["", "none", "Signals that the program reads.", "reads: [x.actual.position]"]),
    key("functions.*.reads[]", TEXT, ["a signal", "", "One signal.", ""]),
    key("functions.*.writes", LIST, ["", "none", "Memory cells that the program writes.", "writes: [feed]"]),
    key("functions.*.writes[]", TEXT, ["a name of `memory`", "", "One memory cell.", ""]),
];

pub(super) const MASTERS: &[Key] = &[
    key(
        "masters",
        NAMES,
        ["", "none", "Masters that are the sum of others, at most 64.", "masters: {both: {add: [line, belt]}}"],
    ),
    key("masters.*", MAP, ["", "", "One master: 1 to 16 members in `add` and `subtract`.", ""]),
    key("masters.*.add", LIST, ["", "none", "Members that are added.", "add: [line, belt]"]),
    key("masters.*.add[]", TEXT, ["an axis, an encoder, NAME.sink of a function or a master", "", "One member.", ""]),
    key("masters.*.subtract", LIST, ["", "none", "Members that are subtracted.", "subtract: [belt]"]),
    key(
        "masters.*.subtract[]",
        TEXT,
        ["an axis, an encoder, NAME.sink of a function or a master", "", "One member.", ""],
    ),
];

pub(super) const GROUPS: &[Key] = &[
    key(
        "groups",
        NAMES,
        ["", "all axes", "Groups of axes that move on trajectories together.", "groups: {arm: [x, y]}"],
    ),
    key("groups.*", &[List, Map], ["", "", "The axes of a group, or a mapping with them in `axes`.", ""]),
    key("groups.*[]", TEXT, ["an axis with a drive", "", "One axis.", ""]),
    key("groups.*.axes", LIST, ["", "required", "The axes of the group.", "axes: [x, y]"]).required(),
    key("groups.*.axes[]", TEXT, ["an axis with a drive", "", "One axis.", ""]),
    key(
        "groups.*.trajectory_limits",
        MAP,
        [
            "",
            "defaults",
            "Reaction to a trajectory that exceeds the limits of its axes.",
            "trajectory_limits: {on_excess: refuse}",
        ],
    ),
    key(
        "groups.*.trajectory_limits.margin",
        NUMBER,
        ["0 to 0.1", "0.001", "Part of a limit that may be exceeded.", "margin: 0.02"],
    ),
    key(
        "groups.*.trajectory_limits.max_stretch",
        NUMBER,
        ["1 to 10", "1.44", "How many times longer a trajectory may become.", "max_stretch: 2"],
    ),
    key(
        "groups.*.trajectory_limits.on_excess",
        &[Choice(&["scale", "refuse"])],
        ["", "scale", "Slow the trajectory down, or refuse it.", "on_excess: refuse"],
    ),
    key(
        "groups.*.angle_wraparound",
        BOOLEAN,
        ["", "false", "Whether rotary axes take the shorter direction to a start point.", "angle_wraparound: true"],
    ),
    key(
        "groups.*.max_duration",
        TIME,
        ["0 s to 86400 s", "0 s", "Longest trajectory that is accepted; 0 s sets no limit.", "max_duration: 600 s"],
    ),
    key(
        "groups.*.controller_state_rate",
        NUMBER,
        [
            "0 to 1000",
            "50",
            "Messages per second on ~/controller_state; 0 publishes none.",
            "controller_state_rate: 50",
        ],
    ),
    key("groups.*.gripper", MAP, ["", "no gripper", "Makes a group of one axis a gripper.", "gripper: {}"]),
    key(
        "groups.*.gripper.allow_stalling",
        BOOLEAN,
        ["", "false", "Whether a gripper that stalls has reached its goal.", "allow_stalling: true"],
    ),
];

//! Keys of cells.
//!
//! The four texts of a key are its range (empty where its shape says it), its default, its meaning and an example.

use super::Shape::{Boolean, Choice, Integer, List, Map, Names, Number, Quantity, Text};
use super::{File, Key, Shape};

const MAP: &[Shape] = &[Map];
const NAMES: &[Shape] = &[Names];
const LIST: &[Shape] = &[List];
const TEXT: &[Shape] = &[Text];
const BOOLEAN: &[Shape] = &[Boolean];
const NUMBER: &[Shape] = &[Number];
const TIME: &[Shape] = &[Quantity("time")];
const FREQUENCY: &[Shape] = &[Quantity("frequency")];
/// Of the axis or encoder: a length of a linear one, an angle of a rotary one.
const LENGTH: &[Shape] = &[Quantity("length, angle or increments")];
const TORQUE: &[Shape] = &[Quantity("torque")];
const SEED: &[Shape] = &[Integer(0, u64::MAX as i128)];
const NODE: &[Shape] = &[Integer(1, 127)];
const OPTIONAL_TIME: &[Shape] = &[Quantity("time"), Choice(&["none"])];
const U32: &[Shape] = &[Integer(0, u32::MAX as i128)];
/// What a value of a table may be.
const I32: (i128, i128) = (i32::MIN as i128, i32::MAX as i128);
const KIND: &[Shape] = &[Choice(&["linear", "rotary"])];

const ANY: &str = "any value";
const POSITIVE: &str = "above 0";
const NOT_NEGATIVE: &str = "0 and above";
const TO_10_S: &str = "0 s to 10 s";
const RATE: &str = "1 Hz to 1000 Hz";

const fn key(path: &'static str, shapes: &'static [Shape], texts: [&'static str; 4]) -> Key {
    Key::new(File::Cell, path, shapes, texts)
}

/// The keys of a device on CAN in addition to `node`: of a drive, and of an entry of `nodes`.
macro_rules! device {
    ($at:literal) => {
        [
            key(
                concat!($at, ".eds"),
                TEXT,
                ["a file next to the cell", "", "EDS or DCF file of the device.", "eds: drive.eds"],
            ),
            key(
                concat!($at, ".heartbeat"),
                OPTIONAL_TIME,
                [
                    "none, or 1 ms to 21 s in whole milliseconds",
                    "100 ms",
                    "Time between two heartbeats of the device; `none` does not supervise it.",
                    "heartbeat: 50 ms",
                ],
            ),
            key(
                concat!($at, ".guarding"),
                MAP,
                ["", "heartbeat", "Node guarding in place of the heartbeat.", "guarding: {time: 100 ms, factor: 3}"],
            ),
            key(
                concat!($at, ".guarding.time"),
                TIME,
                [
                    "1 ms to 65535 ms in whole milliseconds",
                    "required",
                    "Time between two guarding requests.",
                    "time: 100 ms",
                ],
            )
            .required(),
            key(
                concat!($at, ".guarding.factor"),
                &[Integer(1, 255)],
                ["", "required", "Life time factor: requests without an answer until the device is lost.", "factor: 3"],
            )
            .required(),
            key(
                concat!($at, ".identity"),
                MAP,
                ["", "not checked", "Identity object 1018h that the device must have.", "identity: {vendor: 0x5A}"],
            ),
            key(concat!($at, ".identity.vendor"), U32, ["", "not checked", "Vendor ID, 1018h:01.", "vendor: 0x5A"]),
            key(concat!($at, ".identity.product"), U32, ["", "not checked", "Product code, 1018h:02.", "product: 1"]),
            key(
                concat!($at, ".identity.revision"),
                U32,
                ["", "not checked", "Revision number, 1018h:03.", "revision: 2"],
            ),
            key(concat!($at, ".identity.serial"), U32, ["", "not checked", "Serial number, 1018h:04.", "serial: 1234"]),
            key(
                concat!($at, ".startup"),
                LIST,
                [
                    "",
                    "empty",
                    "Objects that are written by SDO when the device is configured, in this order.",
                    "startup: [{index: 0x6065, type: u32, value: 1000}]",
                ],
            ),
            key(concat!($at, ".startup[]"), MAP, ["", "", "One object and its value.", ""]),
            key(
                concat!($at, ".startup[].index"),
                &[Integer(0x1000, 0xFFFF)],
                ["", "required", "Index of the object.", "index: 0x6065"],
            )
            .required(),
            key(concat!($at, ".startup[].sub"), &[Integer(0, 255)], ["", "0", "Subindex of the object.", "sub: 1"]),
            key(
                concat!($at, ".startup[].type"),
                &[Choice(&["u8", "u16", "u32", "u64", "i8", "i16", "i32", "i64", "f32", "bool"])],
                ["", "required", "Data type of the object.", "type: u32"],
            )
            .required(),
            key(
                concat!($at, ".startup[].value"),
                &[Number, Boolean],
                ["the range of the type", "required", "Value that is written.", "value: 1000"],
            )
            .required(),
        ]
    };
}

/// The keys of a drive on a backend: of `drive`, and of an entry of `drives`.
macro_rules! drive {
    ($at:literal) => {
        [
            key(
                concat!($at, ".backend"),
                TEXT,
                [
                    "a name of `backends`",
                    "required without `reference`",
                    "Backend on which the drive is.",
                    "backend: plant",
                ],
            ),
            key(
                concat!($at, ".address"),
                &[Integer(0, 65_535)],
                ["", "required on a simulation", "Number of the drive on its simulation.", "address: 0"],
            ),
            key(concat!($at, ".node"), NODE, ["", "required on CAN", "Node ID of the drive.", "node: 3"]),
            key(
                concat!($at, ".interface"),
                &[Choice(&["position", "velocity", "torque", "voltage", "open_loop"])],
                [
                    "",
                    "position",
                    "Setpoint that the drive takes; docs/loops.md explains the loops.",
                    "interface: velocity",
                ],
            ),
            key(
                concat!($at, ".regulator"),
                &[Choice(&["proportional", "pid", "integer"])],
                ["", "proportional", "Law of a position loop that Lineshaft closes.", "regulator: pid"],
            ),
            key(
                concat!($at, ".missed_cycles"),
                &[Integer(1, 1000)],
                ["", "10", "Cycles without new data after which the drive counts as lost.", "missed_cycles: 5"],
            ),
            key(
                concat!($at, ".enable_timeout"),
                TIME,
                ["100 ms to 600 s", "5 s", "Longest time that the drive may take to enable.", "enable_timeout: 10 s"],
            ),
            key(
                concat!($at, ".mode"),
                &[Choice(&["pp", "vl", "pv", "tq", "ip", "csp", "csv", "cst"])],
                ["", "csp, csv, cst or vl, by `interface`", "CiA 402 mode of operation of a drive on CAN.", "mode: ip"],
            ),
            key(
                concat!($at, ".drivetype"),
                &[Integer(-194, 194)],
                [
                    "-2, -3, -4, -11, -13, 2, 3, 4, 11, 13",
                    "none",
                    "DRIVETYPE of MACS: process data and supervision of a drive on CAN by number.",
                    "drivetype: 11",
                ],
            ),
            key(
                concat!($at, ".probe_1"),
                &[Choice(&["rising", "falling", "both", "index"])],
                ["", "not used", "Edge that touch probe 1 of the drive captures.", "probe_1: rising"],
            ),
            key(
                concat!($at, ".probe_2"),
                &[Choice(&["rising", "falling", "both", "index"])],
                ["", "not used", "Edge that touch probe 2 of the drive captures.", "probe_2: index"],
            ),
            key(
                concat!($at, ".feed"),
                LENGTH,
                [POSITIVE, "none", "Distance of the axis per revolution of the drive shaft.", "feed: 10 mm"],
            ),
            key(
                concat!($at, ".velocity_factor"),
                MAP,
                [
                    "",
                    "1",
                    "Velocity unit of the drive: increments per second times numerator / denominator.",
                    "velocity_factor: {numerator: 10, denominator: 1}",
                ],
            ),
            key(
                concat!($at, ".velocity_factor.numerator"),
                &[Integer(1, u32::MAX as i128)],
                ["", "required", "Numerator.", "numerator: 10"],
            )
            .required(),
            key(
                concat!($at, ".velocity_factor.denominator"),
                &[Integer(1, u32::MAX as i128)],
                ["", "required", "Denominator.", "denominator: 1"],
            )
            .required(),
            key(
                concat!($at, ".missed_pdo"),
                &[Choice(&["hold", "extrapolate"])],
                [
                    "",
                    "hold",
                    "Actual position while the process data of the drive are missing.",
                    "missed_pdo: extrapolate",
                ],
            ),
            key(
                concat!($at, ".rated_effort"),
                &[Quantity("force or torque")],
                [
                    POSITIVE,
                    "none",
                    "Effort of the axis at the rated torque of the drive, for signals in N or Nm.",
                    "rated_effort: 2.4 Nm",
                ],
            ),
        ]
    };
}

/// The keys of an absolute or incremental encoder: of an entry of `encoders`, and of `feedback`.
macro_rules! form {
    ($at:literal) => {
        [
            key(
                concat!($at, ".bits"),
                &[Integer(1, 64)],
                [
                    "",
                    "32 of `encoders`, 64 of `feedback`",
                    "Width of the counter of an incremental encoder.",
                    "bits: 16",
                ],
            ),
            key(
                concat!($at, ".steps"),
                &[Integer(2, i32::MAX as i128)],
                ["", "incremental", "Steps per revolution; makes the encoder an absolute one.", "steps: 4096"],
            ),
            key(
                concat!($at, ".turns"),
                &[Integer(1, i32::MAX as i128)],
                ["", "1", "Revolutions that an absolute encoder distinguishes.", "turns: 4096"],
            ),
            key(
                concat!($at, ".code"),
                &[Choice(&["binary", "gray"])],
                ["", "binary", "Code of an absolute encoder.", "code: gray"],
            ),
            key(
                concat!($at, ".parity"),
                &[Choice(&["none", "even", "odd"])],
                ["", "none", "Parity bit of an absolute encoder.", "parity: even"],
            ),
            key(
                concat!($at, ".omitted"),
                &[Integer(0, i32::MAX as i128)],
                ["", "0", "Code words that an absolute encoder leaves out.", "omitted: 76"],
            ),
            key(
                concat!($at, ".overflow"),
                BOOLEAN,
                ["", "true", "Whether the position continues when an absolute encoder wraps.", "overflow: false"],
            ),
            key(
                concat!($at, ".error_correction"),
                BOOLEAN,
                [
                    "",
                    "false",
                    "Whether single wrong words of an absolute encoder are replaced.",
                    "error_correction: true",
                ],
            ),
            key(
                concat!($at, ".max_step"),
                LENGTH,
                [POSITIVE, "none", "Largest plausible change of an absolute encoder in one cycle.", "max_step: 2 mm"],
            ),
        ]
    };
}

/// The keys of switches and index pulses of a simulated drive: of `sim`, and of `sim.second`.
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

pub(super) const GENERAL: &[Key] = &[
    key("lineshaft", &[Choice(&["1"])], ["", "required", "Version of the file format.", "lineshaft: 1"]).required(),
    key("cycle", TIME, ["125 us to 20 ms", "required", "Cycle time: everything happens in this step.", "cycle: 1 ms"])
        .required(),
    key("safety", MAP, ["", "none", "Inputs that must read 1, else all axes stop.", "safety: {estop: estop_ok}"]),
    key(
        "safety.estop",
        TEXT,
        ["a di of `io`", "none", "Emergency stop contact: on 0 all axes stop and lose power.", "estop: estop_ok"],
    ),
    key(
        "safety.interlock",
        TEXT,
        ["a di of `io`", "none", "Interlock contact: on 0 all axes stop and hold.", "interlock: door_closed"],
    ),
    key(
        "machine",
        MAP,
        ["", "defaults", "Parameters of the machine; docs/parameters.md lists them.", "machine: {i_errclr: 1}"],
    ),
];

pub(super) const ROS: &[Key] = &[
    key("ros", MAP, ["", "defaults", "How the node appears in ROS 2.", "ros: {name: press}"]),
    key(
        "ros.name",
        TEXT,
        ["a letter or _, then letters, digits and _", "lineshaft", "Name of the node.", "name: press"],
    ),
    key(
        "ros.namespace",
        TEXT,
        ["/ or names that each follow a /", "/", "Namespace of the node.", "namespace: /cell_1"],
    ),
    key(
        "ros.joint_states_rate",
        FREQUENCY,
        [RATE, "100 Hz", "Messages per second on joint_states.", "joint_states_rate: 250"],
    ),
    key(
        "ros.axis_states_rate",
        FREQUENCY,
        [RATE, "100 Hz", "Messages per second on ~/axis_states.", "axis_states_rate: 50"],
    ),
    key(
        "ros.shaft_rate",
        FREQUENCY,
        ["0, or 1 Hz to 1000 Hz", "100 Hz", "Messages per second on ~/shaft; 0 publishes none.", "shaft_rate: 0"],
    ),
    key(
        "ros.autostart",
        BOOLEAN,
        ["", "true", "Whether the node becomes active without a request.", "autostart: false"],
    ),
    key(
        "ros.robot_description",
        TEXT,
        [
            "a file next to the cell",
            "none",
            "URDF file that is published on robot_description.",
            "robot_description: demo.urdf",
        ],
    ),
    key(
        "ros.controller_manager",
        TEXT,
        [
            "an absolute name",
            "none",
            "Name of a controller manager whose services the node offers.",
            "controller_manager: /controller_manager",
        ],
    ),
    key(
        "ros.interfaces",
        LIST,
        ["", "as the environment says", "Network interfaces that ROS 2 uses.", "interfaces: [eth0]"],
    ),
    key("ros.interfaces[]", TEXT, ["", "", "An interface by name or address.", ""]),
    key(
        "ros.on_loss",
        &[Choice(&["halt", "none"])],
        ["", "halt", "Reaction to a lost ROS side: all axes halt, or none does.", "on_loss: none"],
    ),
    key(
        "ros.loss_timeout",
        TIME,
        ["0.5 s to 5 s", "2 s", "Time without an answer after which the ROS side is lost.", "loss_timeout: 1 s"],
    ),
    key(
        "ros.request_timeout",
        TIME,
        ["0.1 s to 3600 s", "2 s", "Age up to which a request is carried out.", "request_timeout: 5 s"],
    ),
];

pub(super) const BACKENDS: &[Key] = &[
    key(
        "backends",
        NAMES,
        [
            "",
            "none",
            "Simulations and buses that drives, inputs, outputs and encoders are connected to.",
            "backends: {plant: {type: sim}}",
        ],
    ),
    key("backends.*", MAP, ["", "", "One backend.", ""]),
    key("backends.*.type", &[Choice(&["sim", "can"])], ["", "required", "A simulation, or a CAN bus.", "type: sim"])
        .required(),
    key("backends.*.seed", SEED, ["", "0", "Seed for everything random in the simulation.", "seed: 7"]),
    key(
        "backends.*.delay",
        &[Integer(0, 32)],
        ["", "0", "Further cycles until a setpoint appears in the actual position.", "delay: 2"],
    ),
    key(
        "backends.*.transport",
        TEXT,
        [
            "socketcan:NAME, slcan:PATH, slcan-tcp:HOST:PORT, udp:..",
            "required on CAN",
            "How the bus is reached; docs/can.md explains it.",
            "transport: \"socketcan:can0\"",
        ],
    ),
    key(
        "backends.*.bitrate",
        &[Integer(10_000, 1_000_000)],
        ["", "as the interface is set; required with slcan", "Bit rate of the bus (bit/s).", "bitrate: 1000000"],
    ),
    key(
        "backends.*.serial_baudrate",
        U32,
        [
            "the usual rates of serial lines",
            "as the line is set",
            "Baud rate of the serial line of an slcan adapter (bit/s).",
            "serial_baudrate: 2000000",
        ],
    ),
    key(
        "backends.*.sync_counter",
        &[Integer(2, 240)],
        ["", "no counter", "Value at which the counter of SYNC wraps (1019h).", "sync_counter: 240"],
    ),
    key(
        "backends.*.sdo_timeout",
        TIME,
        [
            "10 ms to 10 s in whole milliseconds",
            "500 ms",
            "Time in which a device must answer an SDO request.",
            "sdo_timeout: 1 s",
        ],
    ),
    key(
        "backends.*.time",
        TIME,
        ["100 ms to 3600 s in whole milliseconds", "none", "Time between two TIME messages.", "time: 1 s"],
    ),
    key(
        "backends.*.master",
        &[Map, Choice(&["none"])],
        ["", "node 127, 100 ms", "Node ID and heartbeat of Lineshaft; `none` sends none.", "master: {node: 126}"],
    ),
    key("backends.*.master.node", NODE, ["", "127", "Node ID of Lineshaft.", "node: 126"]),
    key(
        "backends.*.master.heartbeat",
        TIME,
        [
            "1 ms to 21 s in whole milliseconds",
            "100 ms",
            "Time between two heartbeats of Lineshaft.",
            "heartbeat: 50 ms",
        ],
    ),
    key(
        "backends.*.nodes",
        LIST,
        [
            "",
            "empty",
            "Keys of I/O modules and encoders on CAN; drives have theirs in `drive`.",
            "nodes: [{node: 10, eds: io.eds}]",
        ],
    ),
    key("backends.*.nodes[]", MAP, ["", "", "One device.", ""]),
    key("backends.*.nodes[].node", NODE, ["", "required", "Node ID of the device.", "node: 10"]).required(),
];

pub(super) const NODES: &[Key] = &device!("backends.*.nodes[]");

pub(super) const IO: &[Key] = &[
    key(
        "io",
        NAMES,
        ["", "none", "Digital and analog inputs and outputs.", "io: {lamp: {type: do, backend: plant, address: 0}}"],
    ),
    key("io.*", MAP, ["", "", "One input or output.", ""]),
    key(
        "io.*.type",
        &[Choice(&["di", "do", "ai", "ao"])],
        ["", "required", "Digital or analog, input or output.", "type: di"],
    )
    .required(),
    key(
        "io.*.backend",
        TEXT,
        ["a name of `backends`", "required without `output`", "Backend on which the terminal is.", "backend: plant"],
    ),
    key(
        "io.*.address",
        &[Integer(0, 65_535)],
        [
            "0 to 65535 on a simulation, 0 to 63 at a node on CAN",
            "required without `output`",
            "Number of the terminal among those of its type.",
            "address: 0",
        ],
    ),
    key("io.*.node", NODE, ["", "required on CAN", "Node ID of the device that has the terminal.", "node: 10"]),
    key(
        "io.*.output",
        TEXT,
        ["a do of `io`", "none", "Makes the di read this output, in place of a terminal.", "output: lamp"],
    ),
    key("io.*.latch", BOOLEAN, ["", "false", "Whether edges of the di are latched with their time.", "latch: true"]),
    key(
        "io.*.full_scale",
        &[Quantity("voltage")],
        [POSITIVE, "10 V", "Voltage of an analog channel on CAN at 7FFFh.", "full_scale: 5 V"],
    ),
    key(
        "io.*.filter",
        TIME,
        [TO_10_S, "0 s", "Time for which a new level of the di must last before it counts.", "filter: 5 ms"],
    ),
    key("io.*.sim", MAP, ["", "none", "Simulated marks for a latching di.", "sim: {marks: {of: belt, every: 100 mm}}"]),
    key(
        "io.*.sim.marks",
        MAP,
        ["", "required", "Printed marks that pass the sensor.", "marks: {of: belt, every: 100 mm}"],
    )
    .required(),
    key(
        "io.*.sim.marks.of",
        TEXT,
        ["an encoder, or an axis with a drive", "required", "Encoder or axis that carries the marks.", "of: belt"],
    )
    .required(),
    key(
        "io.*.sim.marks.every",
        LENGTH,
        ["1 inc and above", "required", "Distance between two marks.", "every: 100 mm"],
    )
    .required(),
    key("io.*.sim.marks.first", LENGTH, [ANY, "0", "Position of the first mark.", "first: 20 mm"]),
    key("io.*.sim.marks.width", LENGTH, ["0 to less than half of `every`", "0", "Width of a mark.", "width: 2 mm"]),
    key(
        "io.*.sim.marks.jitter",
        LENGTH,
        [NOT_NEGATIVE, "0", "Largest random displacement of a mark.", "jitter: 0.2 mm"],
    ),
    key(
        "io.*.sim.marks.stretch",
        &[Quantity("ratio")],
        ["0 % to 100 %", "none", "Largest stretch of the web; needs `stretch_period`.", "stretch: 0.5 %"],
    ),
    key(
        "io.*.sim.marks.stretch_period",
        &[Integer(2, 1_000_000)],
        ["", "none", "Marks until the stretch repeats.", "stretch_period: 200"],
    ),
    key(
        "io.*.sim.marks.lost",
        &[Quantity("ratio")],
        ["0 % to 100 %", "0 %", "Share of marks that are missing.", "lost: 1 %"],
    ),
    key(
        "io.*.sim.marks.extra",
        &[Quantity("ratio")],
        ["0 % to 100 %", "0 %", "Share of marks followed by a false one.", "extra: 1 %"],
    ),
    key("io.*.sim.marks.seed", SEED, ["", "0", "Seed of the random displacements and losses.", "seed: 7"]),
];

pub(super) const MEMORY: &[Key] = &[
    key(
        "memory",
        NAMES,
        ["", "none", "Memory cells, which functions and scenarios read and write.", "memory: {feed: {type: i16}}"],
    ),
    key("memory.*", MAP, ["", "", "One memory cell.", ""]),
    key(
        "memory.*.type",
        &[Choice(&["i16", "i32", "i64", "f64", "bit"])],
        ["", "required", "Type of its value.", "type: i16"],
    )
    .required(),
    key(
        "memory.*.initial",
        NUMBER,
        ["the range of the type; of i64 -2^53 to 2^53", "0", "Value at the start.", "initial: 7"],
    ),
];

pub(super) const ENCODERS: &[Key] = &[
    key(
        "encoders",
        NAMES,
        [
            "",
            "none",
            "Encoders apart from those of drives.",
            "encoders: {belt: {backend: plant, address: 0, type: linear, scale: {increments: 40, per: 1 mm}}}",
        ],
    ),
    key("encoders.*", MAP, ["", "", "One encoder.", ""]),
    key(
        "encoders.*.backend",
        TEXT,
        ["a name of `backends`", "required", "Backend on which the encoder is.", "backend: plant"],
    )
    .required(),
    key(
        "encoders.*.address",
        &[Integer(0, 65_535)],
        ["", "required on a simulation", "Number of the encoder on its simulation.", "address: 0"],
    ),
    key("encoders.*.node", NODE, ["", "required on CAN", "Node ID of the encoder.", "node: 20"]),
    key("encoders.*.type", KIND, ["", "required", "Linear (m) or rotary (rad).", "type: linear"]).required(),
    key("encoders.*.scale", MAP, ["", "required", "Increments per distance.", "scale: {increments: 40, per: 1 mm}"])
        .required(),
    key(
        "encoders.*.scale.increments",
        NUMBER,
        ["above 0, also a fraction", "required", "Increments.", "increments: 40"],
    )
    .required(),
    key("encoders.*.scale.per", &[Quantity("length or angle")], [POSITIVE, "required", "Their distance.", "per: 1 mm"])
        .required(),
    key(
        "encoders.*.index",
        MAP,
        [
            "",
            "not supervised",
            "Supervision of an incremental encoder by its index pulses.",
            "index: {every: 4000 inc, tolerance: 8 inc}",
        ],
    ),
    key(
        "encoders.*.index.every",
        LENGTH,
        [POSITIVE, "required", "Distance between two index pulses.", "every: 4000 inc"],
    )
    .required(),
    key("encoders.*.index.tolerance", LENGTH, [POSITIVE, "required", "Largest deviation from it.", "tolerance: 8 inc"])
        .required(),
];

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
        [POSITIVE, "none", "Angle after which a rotary axis counts from 0 again.", "modulo: 360 deg"],
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

pub(super) const DRIVE: &[Key] = &drive!("axes.*.drive");
pub(super) const DRIVE_DEVICE: &[Key] = &device!("axes.*.drive");

/// Of a drive with an analog reference.
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

pub(super) const DRIVES: &[Key] = &drive!("axes.*.drives[]");
pub(super) const DRIVES_DEVICE: &[Key] = &device!("axes.*.drives[]");

pub(super) const ENCODER_FORM: &[Key] = &form!("encoders.*");

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
pub(super) const FEEDBACK_FORM: &[Key] = &form!("axes.*.feedback");

/// Of a simulated drive: its model.
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
    key("axes.*.sim.coast", TIME, [TO_10_S, "100 ms", "Time for which model two_speed coasts.", "coast: 80 ms"]),
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
        [POSITIVE, "required of motor", "Inertia of the motor.", "inertia: 0.0003 kg*m^2"],
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
    key("axes.*.sim.load_torque", TORQUE, [ANY, "0", "Constant torque on the load.", "load_torque: 0.1 Nm"]),
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
        [NOT_NEGATIVE, "0", "Backlash of the coupling; needs `stiffness`.", "backlash: 0.1 deg"],
    ),
    key(
        "axes.*.sim.rated_torque",
        TORQUE,
        [POSITIVE, "required of motor without `voltage`", "Rated torque of the motor.", "rated_torque: 1.3 Nm"],
    ),
    key(
        "axes.*.sim.max_torque",
        TORQUE,
        [POSITIVE, "3 times `rated_torque`", "Torque that the motor makes at most.", "max_torque: 4 Nm"],
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
            POSITIVE,
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

/// Sections of parameters of an axis, and what is in them that is no parameter.
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
        ["", "one per point", "Master increments of one period, of form y.", "length: 20000"],
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

//! Keys of backends, inputs and outputs, memory and encoders.

use super::{
    ANY, BOOLEAN, KIND, LENGTH, LIST, MAP, NAMES, NODE, NOT_NEGATIVE, NUMBER, POSITIVE, SEED, TEXT, TIME, TO_10_S, U32,
    key,
};
use crate::reference::Key;
use crate::reference::Shape::{Choice, Integer, Map, Quantity};

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
            "115200",
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

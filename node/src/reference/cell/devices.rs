//! Keys of drives, devices on CAN, and formats of encoders, which several mappings have.

use super::{BOOLEAN, LENGTH, LIST, MAP, NODE, OPTIONAL_TIME, POSITIVE, TEXT, TIME, U32, key};
use crate::reference::Key;
use crate::reference::Shape::{Boolean, Choice, Integer, Number, Quantity};

/// Keys of a device on CAN in addition to `node`: of a drive, and of an entry of `nodes`.
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
                [
                    "",
                    "vendor and product of the EDS, if there is one",
                    "Identity object 1018h that the device must have.",
                    "identity: {vendor: 0x5A}",
                ],
            ),
            key(concat!($at, ".identity.vendor"), U32, ["", "that of the EDS", "Vendor ID, 1018h:01.", "vendor: 0x5A"]),
            key(
                concat!($at, ".identity.product"),
                U32,
                ["", "that of the EDS", "Product code, 1018h:02.", "product: 1"],
            ),
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

/// Keys of a drive on a backend: of `drive`, and of an entry of `drives`.
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
                    "position; with `reference` required",
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

/// Keys of an absolute or incremental encoder: of an entry of `encoders`, and of `feedback`.
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

pub(super) const NODES: &[Key] = &device!("backends.*.nodes[]");

pub(super) const DRIVE: &[Key] = &drive!("axes.*.drive");
pub(super) const DRIVE_DEVICE: &[Key] = &device!("axes.*.drive");

pub(super) const DRIVES: &[Key] = &drive!("axes.*.drives[]");
pub(super) const DRIVES_DEVICE: &[Key] = &device!("axes.*.drives[]");

pub(super) const ENCODER_FORM: &[Key] = &form!("encoders.*");

pub(super) const FEEDBACK_FORM: &[Key] = &form!("axes.*.feedback");

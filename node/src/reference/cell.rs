//! Keys of cells.
//!
//! The four texts of a key are its range (empty if its shape defines it), its default, its meaning and an example.

mod axes;
mod devices;
mod functions;
mod general;
mod hardware;
mod sim;

use super::Shape::{Boolean, Choice, Integer, List, Map, Names, Number, Quantity, Text};
use super::{File, Key, Shape};

/// All keys, in the order of the reference.
pub(super) const KEYS: &[&[Key]] = &[
    general::GENERAL,
    general::ROS,
    hardware::BACKENDS,
    devices::NODES,
    hardware::IO,
    hardware::MEMORY,
    hardware::ENCODERS,
    devices::ENCODER_FORM,
    axes::AXES,
    devices::DRIVE,
    devices::DRIVE_DEVICE,
    axes::ANALOG,
    devices::DRIVES,
    devices::DRIVES_DEVICE,
    axes::FEEDBACK,
    devices::FEEDBACK_FORM,
    sim::SIM,
    sim::FIXTURES,
    sim::SECOND,
    axes::SECTIONS,
    functions::TABLES,
    functions::PROGRAMS,
    functions::FUNCTIONS,
    functions::MASTERS,
    functions::GROUPS,
];

const MAP: &[Shape] = &[Map];
const NAMES: &[Shape] = &[Names];
const LIST: &[Shape] = &[List];
const TEXT: &[Shape] = &[Text];
const BOOLEAN: &[Shape] = &[Boolean];
const NUMBER: &[Shape] = &[Number];
const TIME: &[Shape] = &[Quantity("time")];
const FREQUENCY: &[Shape] = &[Quantity("frequency")];
/// Length of a linear axis or encoder, angle of a rotary one.
const LENGTH: &[Shape] = &[Quantity("length, angle or increments")];
const TORQUE: &[Shape] = &[Quantity("torque")];
const SEED: &[Shape] = &[Integer(0, u64::MAX as i128)];
const NODE: &[Shape] = &[Integer(1, 127)];
const OPTIONAL_TIME: &[Shape] = &[Quantity("time"), Choice(&["none"])];
const U32: &[Shape] = &[Integer(0, u32::MAX as i128)];
/// Range of a value of a table.
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

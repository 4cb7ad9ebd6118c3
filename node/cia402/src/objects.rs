//! Objects of a drive that the master reads and writes, with their names from the standards.

use crate::object::Object;

const fn of(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Device type; the profile in its lower half (CiA 301).
pub const DEVICE_TYPE: Object = of(0x1000, 0);
/// Vendor ID (CiA 301).
pub const VENDOR: Object = of(0x1018, 1);
/// Product code (CiA 301).
pub const PRODUCT: Object = of(0x1018, 2);
/// Revision number (CiA 301).
pub const REVISION: Object = of(0x1018, 3);
/// Serial number (CiA 301).
pub const SERIAL: Object = of(0x1018, 4);
/// Error code (CiA 402).
pub const ERROR_CODE: Object = of(0x603F, 0);
/// Control word (CiA 402).
pub const CONTROL_WORD: Object = of(0x6040, 0);
/// Status word (CiA 402).
pub const STATUS_WORD: Object = of(0x6041, 0);
/// Target velocity of mode vl, 16 bits (CiA 402).
pub const VL_TARGET_VELOCITY: Object = of(0x6042, 0);
/// Modes of operation (CiA 402).
pub const MODE: Object = of(0x6060, 0);
/// Modes of operation display (CiA 402).
pub const MODE_DISPLAY: Object = of(0x6061, 0);
/// Position actual value, in counts (CiA 402).
pub const POSITION: Object = of(0x6064, 0);
/// Velocity actual value (CiA 402).
pub const VELOCITY: Object = of(0x606C, 0);
/// Target torque, in 0.1 % of rated torque (CiA 402).
pub const TARGET_TORQUE: Object = of(0x6071, 0);
/// Torque actual value, in 0.1 % of rated torque (CiA 402).
pub const TORQUE: Object = of(0x6077, 0);
/// Target position, in counts (CiA 402).
pub const TARGET_POSITION: Object = of(0x607A, 0);
/// Position encoder resolution: encoder increments per motor revolutions (CiA 402).
pub const ENCODER_RESOLUTION: [Object; 2] = [of(0x608F, 1), of(0x608F, 2)];
/// Gear ratio: motor shaft revolutions per driving shaft revolutions (CiA 402).
pub const GEAR_RATIO: [Object; 2] = [of(0x6091, 1), of(0x6091, 2)];
/// Feed constant: feed in position units per driving shaft revolutions (CiA 402).
pub const FEED_CONSTANT: [Object; 2] = [of(0x6092, 1), of(0x6092, 2)];
/// Homing method (CiA 402).
pub const HOMING_METHOD: Object = of(0x6098, 0);
/// Homing speed during search for switch (CiA 402).
pub const HOMING_SEARCH: Object = of(0x6099, 1);
/// Homing speed during search for zero (CiA 402).
pub const HOMING_ZERO: Object = of(0x6099, 2);
/// Homing acceleration (CiA 402).
pub const HOMING_ACCELERATION: Object = of(0x609A, 0);
/// Touch probe function (CiA 402).
pub const TOUCH_PROBE_FUNCTION: Object = of(0x60B8, 0);
/// Position at the rising edge of probe 1, in counts; those of the other edges follow (CiA 402).
pub const TOUCH_PROBE_POSITION: Object = of(0x60BA, 0);
/// Number of rising edges of probe 1; those of the other edges follow (CiA 402).
pub const TOUCH_PROBE_COUNT: Object = of(0x60D5, 0);
/// Interpolation data record: position, in counts (CiA 402).
pub const INTERPOLATION_POSITION: Object = of(0x60C1, 1);
/// Interpolation time period: value (CiA 402).
pub const INTERPOLATION_VALUE: Object = of(0x60C2, 1);
/// Interpolation time period: index, the power of ten of seconds (CiA 402).
pub const INTERPOLATION_INDEX: Object = of(0x60C2, 2);
/// Digital inputs (CiA 402).
pub const DIGITAL_INPUTS: Object = of(0x60FD, 0);
/// Digital outputs of a drive (CiA 402).
pub const DIGITAL_OUTPUTS: Object = of(0x60FE, 1);
/// Mask of the digital outputs that follow 60FEh:01 (CiA 402).
pub const DIGITAL_OUTPUT_MASK: Object = of(0x60FE, 2);
/// Target velocity (CiA 402).
pub const TARGET_VELOCITY: Object = of(0x60FF, 0);
/// Supported drive modes (CiA 402).
pub const SUPPORTED_MODES: Object = of(0x6502, 0);

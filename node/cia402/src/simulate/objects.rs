//! Objects of a simulated drive that the master does not use, with their names from the standards.

use crate::object::Object;

const fn of(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Error register (CiA 301).
pub const ERROR_REGISTER: Object = of(0x1001, 0);
/// Levels of the touch probe inputs: bit 0 probe 1, bit 1 probe 2. Manufacturer object that clients write.
pub const PROBE_INPUTS: Object = of(0x2000, 0);
/// Abort connection option code (CiA 402).
pub const ABORT_CONNECTION: Object = of(0x6007, 0);
/// vl velocity demand (CiA 402).
pub const VL_DEMAND: Object = of(0x6043, 0);
/// vl velocity actual value (CiA 402).
pub const VL_ACTUAL: Object = of(0x6044, 0);
/// vl velocity acceleration: velocity and time, in s (CiA 402).
pub const VL_ACCELERATION: [Object; 2] = [of(0x6048, 1), of(0x6048, 2)];
/// vl velocity deceleration: velocity and time, in s (CiA 402).
pub const VL_DECELERATION: [Object; 2] = [of(0x6049, 1), of(0x6049, 2)];
/// Profile velocity (CiA 402).
pub const PROFILE_VELOCITY: Object = of(0x6081, 0);
/// Profile acceleration (CiA 402).
pub const PROFILE_ACCELERATION: Object = of(0x6083, 0);
/// Profile deceleration (CiA 402).
pub const PROFILE_DECELERATION: Object = of(0x6084, 0);
/// Torque slope, in 0.1 % of rated torque per second (CiA 402).
pub const TORQUE_SLOPE: Object = of(0x6087, 0);
/// Touch probe status (CiA 402).
pub const TOUCH_PROBE_STATUS: Object = of(0x60B9, 0);

//! Objects of CANopen communication, modules and encoders, with their names from the standards.

use lineshaft_cia402::object::Object;

const fn of(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// COB-ID of SYNC; bit 30: the device produces it (CiA 301).
pub const SYNC_COB_ID: Object = of(0x1005, 0);
/// Communication cycle period, in us (CiA 301).
pub const CYCLE_PERIOD: Object = of(0x1006, 0);
/// Guard time, in ms (CiA 301).
pub const GUARD_TIME: Object = of(0x100C, 0);
/// Life time factor (CiA 301).
pub const LIFE_TIME_FACTOR: Object = of(0x100D, 0);
/// First consumer heartbeat time: node << 16 | ms (CiA 301).
pub const CONSUMER_HEARTBEAT: Object = of(0x1016, 1);
/// Producer heartbeat time, in ms (CiA 301).
pub const PRODUCER_HEARTBEAT: Object = of(0x1017, 0);
/// Synchronous counter overflow value (CiA 301).
pub const SYNC_OVERFLOW: Object = of(0x1019, 0);
/// Verify configuration: date; here one half of the digest of the configuration (CiA 301).
pub const CONFIGURATION_DATE: Object = of(0x1020, 1);
/// Verify configuration: time; here the other half of the digest (CiA 301).
pub const CONFIGURATION_TIME: Object = of(0x1020, 2);
/// Error behaviour: communication error (CiA 301).
pub const ERROR_BEHAVIOUR: Object = of(0x1029, 1);

/// First 8 digital inputs of a module; the next ones follow (CiA 401).
pub const MODULE_INPUTS: Object = of(0x6000, 1);
/// First 8 digital outputs of a module; the next ones follow (CiA 401).
pub const MODULE_OUTPUTS: Object = of(0x6200, 1);
/// First analog input of a module, 16 bits; the next ones follow (CiA 401).
pub const MODULE_ANALOG_INPUTS: Object = of(0x6401, 1);
/// First analog output of a module, 16 bits; the next ones follow (CiA 401).
pub const MODULE_ANALOG_OUTPUTS: Object = of(0x6411, 1);
/// Position value of an encoder (CiA 406).
pub const ENCODER_POSITION: Object = of(0x6004, 0);

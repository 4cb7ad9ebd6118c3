//! Homing (AXH).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value, int};

const HOMING_ROW: Row = Row { system: System::Macs, group: Group::Homing, applies: Applies::Drive, ..BASE };

pub(in super::super) const ROWS: &[Row] = rows! {
    "home_force": HOMING_ROW {
        mnemonic: "HOME_FORCE", number: "3", view_of: "homing.required", range: Range::Among(&[(0, 1), (255, 255)]), default: Value::Int(0),
        get: |p| Value::Int(p.home_force()), set: |p, v| p.set_home_force(int(v).unwrap_or(0)),
        description: "1: no motion before homing is done, after a start and after a change of encoder, units or homing. 255, compulsory \
            and done, acts as 1 and is shown as it was set; the signal homed shows whether homing has been done.",
        source: "MACS-HOME-09",
        note: "A-15: which changes ask for a new homing is not said; those of encoder, direction, units and homing do." }
    "home_vel": HOMING_ROW {
        mnemonic: "HOME_VEL", number: "7", view_of: "homing.velocity", unit: "1/VELRES", range: Range::Int(-10_000, 10_000),
        default: Value::Int(10), effect: Effect::NextHoming,
        get: |p| Value::Int(p.home_vel()), set: |p, v| p.homing.parts.velocity = int(v),
        description: "Velocity towards the reference switch, in parts of VELMAX; the sign is the direction. Not above velres.",
        source: "MACS-HOME-01", note: "A-14: with 0 homing is refused." }
    "home_type": HOMING_ROW {
        mnemonic: "HOME_TYPE", number: "40", view_of: "homing.method", range: Range::Int(0, 3), default: Value::Int(0),
        effect: Effect::NextHoming,
        get: |p| Value::Int(if (-4..0).contains(&p.homing.method) { -1 - p.homing.method } else { 0 }),
        set: |p, v| p.homing.method = -1 - int(v).unwrap_or(0),
        description: "Homing: to the switch, then 0 back off it and on to the index, 1 back off it to its edge, 2 on across it to the \
            index, 3 on across it to its edge.",
        source: "MACS-HOME-03" }
    "home_ramp": HOMING_ROW {
        mnemonic: "HOME_RAMP", number: "41", view_of: "homing.acceleration", unit: "1/VELRES", range: Range::Int(1, 10_000),
        default: Value::Int(10), effect: Effect::NextHoming,
        get: |p| Value::Int(p.home_ramp()), set: |p, v| p.homing.parts.acceleration = int(v),
        description: "Acceleration of homing, in parts of the largest one; never more than dfltacc. Not above velres.",
        source: "MACS-HOME-02", note: "D11: the unit is % in the overview; 1/VELRES is taken, which is the same while VELRES is 100." }
    "home_offset": HOMING_ROW {
        mnemonic: "HOME_OFFSET", number: "42", view_of: "homing.offset", unit: "inc", range: Range::Int(-MLONG, MLONG),
        default: Value::Int(0), effect: Effect::NextHoming,
        get: |p| Value::Int(p.home_offset()), set: |p, v| p.set_home_offset(int(v).unwrap_or(0)),
        description: "Where the zero lies, counted from the switch or the index; the axis moves there at the end of homing.",
        source: "MACS-HOME-07, MACS-UNIT-03" }
    "homezerovel": HOMING_ROW {
        mnemonic: "HOMEZEROVEL", number: "116", view_of: "homing.index_velocity", unit: "1/VELRES", range: Range::Int(1, MLONG),
        default: Value::Int(10), effect: Effect::NextHoming,
        get: |p| Value::Int(p.homezerovel()), set: |p, v| p.homing.parts.index_velocity = int(v),
        description: "Velocity of the search for the index, in parts of VELMAX.", source: "MACS-HOME-06",
        note: "A-14: the slow speed of homing is not given; this is taken, up to home_vel." }
};

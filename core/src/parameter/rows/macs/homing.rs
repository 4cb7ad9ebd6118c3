//! Homing (AXH).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value, int};

const HOMING_ROW: Row = Row { system: System::Macs, group: Group::Homing, applies: Applies::Drive, ..BASE };

pub(in super::super) const ROWS: &[Row] = &[
    Row {
        key: "home_force",
        mnemonic: "HOME_FORCE",
        number: "3",
        range: Range::Among(&[(0, 1), (255, 255)]),
        default: Value::Int(0),
        view_of: "homing.required",
        description: "1: no motion before homing is done, after a start and after a change of encoder, units or homing. 255, compulsory and done, acts as 1 and is shown as it was set; the signal homed shows whether homing has been done.",
        source: "MACS-HOME-09",
        note: "A-15: which changes ask for a new homing is not said; those of encoder, direction, units and homing do.",
        get: |p| Value::Int(p.home_force()),
        set: |p, v| p.set_home_force(int(v).unwrap_or(0)),
        ..HOMING_ROW
    },
    Row {
        key: "home_vel",
        mnemonic: "HOME_VEL",
        number: "7",
        unit: "1/VELRES",
        range: Range::Int(-10_000, 10_000),
        default: Value::Int(10),
        effect: Effect::NextHoming,
        view_of: "homing.velocity",
        description: "Velocity towards the reference switch, in parts of VELMAX; the sign is the direction. Not above velres.",
        source: "MACS-HOME-01",
        note: "A-14: with 0 homing is refused.",
        get: |p| Value::Int(p.home_vel()),
        set: |p, v| p.homing.parts.velocity = int(v),
        ..HOMING_ROW
    },
    Row {
        key: "home_type",
        mnemonic: "HOME_TYPE",
        number: "40",
        range: Range::Int(0, 3),
        default: Value::Int(0),
        effect: Effect::NextHoming,
        view_of: "homing.method",
        description: "Homing: to the switch, then 0 back off it and on to the index, 1 back off it to its edge, 2 on across it to the index, 3 on across it to its edge.",
        source: "MACS-HOME-03",
        get: |p| Value::Int(if (-4..0).contains(&p.homing.method) { -1 - p.homing.method } else { 0 }),
        set: |p, v| p.homing.method = -1 - int(v).unwrap_or(0),
        ..HOMING_ROW
    },
    Row {
        key: "home_ramp",
        mnemonic: "HOME_RAMP",
        number: "41",
        unit: "1/VELRES",
        range: Range::Int(1, 10_000),
        default: Value::Int(10),
        effect: Effect::NextHoming,
        view_of: "homing.acceleration",
        description: "Acceleration of homing, in parts of the largest one; never more than dfltacc. Not above velres.",
        source: "MACS-HOME-02",
        note: "D11: the unit is % in the overview; 1/VELRES is taken, which is the same while VELRES is 100.",
        get: |p| Value::Int(p.home_ramp()),
        set: |p, v| p.homing.parts.acceleration = int(v),
        ..HOMING_ROW
    },
    Row {
        key: "home_offset",
        mnemonic: "HOME_OFFSET",
        number: "42",
        unit: "inc",
        range: Range::Int(-MLONG, MLONG),
        default: Value::Int(0),
        effect: Effect::NextHoming,
        view_of: "homing.offset",
        description: "Where the zero lies, counted from the switch or the index; the axis moves there at the end of homing.",
        source: "MACS-HOME-07, MACS-UNIT-03",
        get: |p| Value::Int(p.home_offset()),
        set: |p, v| p.set_home_offset(int(v).unwrap_or(0)),
        ..HOMING_ROW
    },
    Row {
        key: "homezerovel",
        mnemonic: "HOMEZEROVEL",
        number: "116",
        unit: "1/VELRES",
        range: Range::Int(1, MLONG),
        default: Value::Int(10),
        effect: Effect::NextHoming,
        view_of: "homing.index_velocity",
        description: "Velocity of the search for the index, in parts of VELMAX.",
        source: "MACS-HOME-06",
        note: "A-14: the slow speed of homing is not given; this is taken, up to home_vel.",
        get: |p| Value::Int(p.homezerovel()),
        set: |p, v| p.homing.parts.index_velocity = int(v),
        ..HOMING_ROW
    },
];

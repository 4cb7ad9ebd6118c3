//! Homing (AXH).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value};

const HOMING_ROW: Row = Row { system: System::Macs, group: Group::Homing, applies: Applies::Drive, ..BASE };

pub(in super::super) const ROWS: &[Row] = &[
    Row {
        key: "home_force",
        mnemonic: "HOME_FORCE",
        number: "3",
        range: Range::Int(0, 1),
        default: Value::Int(0),
        missing: "homing",
        description: "1: no motion before homing is done, after a start and after a change of encoder, units or homing. 255, compulsory and done, is read only.",
        source: "MACS-HOME-09",
        note: "A-15: which changes ask for a new homing is not said; those of encoder, sense, units and homing do.",
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
        missing: "homing",
        description: "Velocity towards the reference switch, in parts of VELMAX; the sign is the direction. Not above velres.",
        source: "MACS-HOME-01",
        note: "A-14: with 0 homing is refused.",
        ..HOMING_ROW
    },
    Row {
        key: "home_type",
        mnemonic: "HOME_TYPE",
        number: "40",
        range: Range::Int(0, 3),
        default: Value::Int(0),
        effect: Effect::NextHoming,
        missing: "homing",
        description: "Homing: to the switch, then 0 back off it and on to the index, 1 back off it to its edge, 2 on across it to the index, 3 on across it to its edge.",
        source: "MACS-HOME-03",
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
        missing: "homing",
        description: "Acceleration of homing, in parts of the largest one; never more than dfltacc. Not above velres.",
        source: "MACS-HOME-02",
        note: "D11: the unit is % in the overview; 1/VELRES is taken, which is the same while VELRES is 100.",
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
        missing: "homing",
        description: "Where the zero lies, counted from the switch or the index; the axis moves there at the end of homing.",
        source: "MACS-HOME-07",
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
        missing: "homing",
        description: "Velocity of the search for the index, in parts of VELMAX.",
        source: "MACS-HOME-06",
        note: "A-14: the slow speed of homing is not given; this is taken, up to home_vel.",
        ..HOMING_ROW
    },
];

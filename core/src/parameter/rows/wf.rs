//! Parameters of the Siemens WF 725 / 726 positioning modules (spec/wf725.md); a bare number is in the axis unit.

use super::{BASE, Bare, Effect, HOUR_NS, Measure, POSITION, REAL, Range, Row, Value, int, option, real};

/// Two decimal digits (WF-DAC-02).
const BCD: Range = Range::Int(0, 99);
const DISTANCE: Range = Range::Int(0, (1 << 62) - 1);
/// Parts of `max_velocity` in hundredths.
const SPEED: Range = Range::Real(0.0, 100.0);

const UNIT: Row = Row { bare: Bare::AxisUnit, ..BASE };
const RATE: Row = Row {
    measure: Measure::Acceleration,
    range: REAL,
    effect: Effect::NextMotion,
    source: "WF-MD-01, WF-MD-02, WF-CLC-01",
    ..UNIT
};
const STEP_SPEED: Row =
    Row { measure: Measure::Integer, range: BCD, default: Value::Int(0), source: "WF-MD-19, WF-OLC-07", ..UNIT };
const STEP_DISTANCE: Row = Row {
    measure: Measure::Distance,
    range: DISTANCE,
    default: Value::Int(0),
    source: "WF-MD-20, WF-OLC-07, W06",
    ..UNIT
};
const FIXED_SPEED: Row = Row {
    measure: Measure::Number,
    range: SPEED,
    default: Value::Real(0.0),
    effect: Effect::NextMotion,
    source: "WF-MD-22, WF-SET-02",
    ..UNIT
};
const OFFSET: Row = Row {
    measure: Measure::Position,
    range: POSITION,
    default: Value::Int(0),
    effect: Effect::NextMotion,
    source: "WF-CRD-02, WF-CRD-03",
    ..UNIT
};

pub(super) const ROWS: &[Row] = &[
    Row {
        key: "wf.md1",
        default_text: "as max_acceleration",
        description: "Acceleration of blocks and of setup in closed loop; not above max_acceleration.",
        get: |p| option(p.wf.md1),
        set: |p, v| p.wf.md1 = real(v),
        ..RATE
    },
    Row {
        key: "wf.md2",
        default_text: "as max_deceleration",
        description: "Deceleration of blocks and of setup in closed loop; not above max_deceleration.",
        get: |p| option(p.wf.md2),
        set: |p, v| p.wf.md2 = real(v),
        ..RATE
    },
    Row {
        key: "wf.md22",
        measure: Measure::Number,
        range: Range::Real(0.01, 100.0),
        default: Value::Real(1.0),
        description: "Servo gain kv of the position loop with interface velocity, (mm/min)/um: 1 is 16.667 1/s.",
        source: "WF-MD-14, WF-CLC-03",
        get: |p| Value::Real(p.wf.md22),
        set: |p, v| p.wf.md22 = real(v).unwrap_or(p.wf.md22),
        ..BASE
    },
    Row {
        key: "wf.md30",
        measure: Measure::Time,
        range: Range::Int(0, HOUR_NS),
        default: Value::Int(1_000_000_000),
        description: "PEH time: within it the position has to be inside the PEH window, else alarm 22.",
        source: "WF-MD-15, WF-PEH-02",
        get: |p| Value::Int(p.wf.md30),
        set: |p, v| p.wf.md30 = int(v).unwrap_or(p.wf.md30),
        ..UNIT
    },
    Row {
        key: "wf.md42",
        description: "Speed value of reduction step 1.",
        get: |p| Value::Int(p.wf.md42),
        set: |p, v| p.wf.md42 = int(v).unwrap_or(p.wf.md42),
        ..STEP_SPEED
    },
    Row {
        key: "wf.md43",
        description: "Speed value of reduction step 2; not above wf.md42.",
        get: |p| Value::Int(p.wf.md43),
        set: |p, v| p.wf.md43 = int(v).unwrap_or(p.wf.md43),
        ..STEP_SPEED
    },
    Row {
        key: "wf.md44",
        description: "Speed value of reduction step 3; not above wf.md43.",
        get: |p| Value::Int(p.wf.md44),
        set: |p, v| p.wf.md44 = int(v).unwrap_or(p.wf.md44),
        ..STEP_SPEED
    },
    Row {
        key: "wf.md45",
        description: "Distance before the target from which on step 1 runs, this distance included.",
        get: |p| Value::Int(p.wf.md45),
        set: |p, v| p.wf.md45 = int(v).unwrap_or(p.wf.md45),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.md46",
        description: "Distance before the target below which step 2 runs; not above wf.md45.",
        get: |p| Value::Int(p.wf.md46),
        set: |p, v| p.wf.md46 = int(v).unwrap_or(p.wf.md46),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.md47",
        description: "Distance before the target below which step 3 runs; not above wf.md46.",
        get: |p| Value::Int(p.wf.md47),
        set: |p, v| p.wf.md47 = int(v).unwrap_or(p.wf.md47),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.md48",
        description: "Distance before the target below which the output is off; not above wf.md47.",
        get: |p| Value::Int(p.wf.md48),
        set: |p, v| p.wf.md48 = int(v).unwrap_or(p.wf.md48),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.peh_window",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "as in_position_window",
        description: "PEH window: this near to the end of a block its position is reached.",
        source: "WF-MD-22, WF-PEH-03",
        get: |p| p.wf.peh_window.map_or(Value::Unset, Value::Int),
        set: |p, v| p.wf.peh_window = int(v),
        ..UNIT
    },
    Row {
        key: "wf.peh_from_start",
        range: Range::Int(0, 1),
        default: Value::Int(0),
        description: "1: the PEH time begins with START, 0: with the end of the output.",
        source: "WF-PEH-01, W07",
        get: |p| Value::Int(p.wf.peh_from_start),
        set: |p, v| p.wf.peh_from_start = int(v).unwrap_or(p.wf.peh_from_start),
        ..UNIT
    },
    Row {
        key: "wf.max_following_error",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "no alarm",
        description: "Set position minus actual position beyond which alarm 10 (in travel) or 11 (at standstill) comes.",
        source: "WF-MD-22, WF-MON-04, W13",
        get: |p| p.wf.max_following_error.map_or(Value::Unset, Value::Int),
        set: |p, v| p.wf.max_following_error = int(v),
        ..UNIT
    },
    Row {
        key: "wf.fixed_speed_1",
        description: "Setup speed that fixed_speed 1 chooses in mode jog.",
        get: |p| Value::Real(p.wf.fixed_speed_1),
        set: |p, v| p.wf.fixed_speed_1 = real(v).unwrap_or(p.wf.fixed_speed_1),
        ..FIXED_SPEED
    },
    Row {
        key: "wf.fixed_speed_2",
        description: "Setup speed that fixed_speed 2 chooses in mode jog.",
        get: |p| Value::Real(p.wf.fixed_speed_2),
        set: |p, v| p.wf.fixed_speed_2 = real(v).unwrap_or(p.wf.fixed_speed_2),
        ..FIXED_SPEED
    },
    Row {
        key: "wf.fixed_speed_3",
        description: "Setup speed that fixed_speed 3 chooses in mode jog.",
        get: |p| Value::Real(p.wf.fixed_speed_3),
        set: |p, v| p.wf.fixed_speed_3 = real(v).unwrap_or(p.wf.fixed_speed_3),
        ..FIXED_SPEED
    },
    Row {
        key: "wf.zero_offset",
        description: "Zero offset NV: added to absolute positions of the blocks that start from now on.",
        get: |p| Value::Int(p.wf.zero_offset),
        set: |p, v| p.wf.zero_offset = int(v).unwrap_or(p.wf.zero_offset),
        ..OFFSET
    },
    Row {
        key: "wf.tool_length",
        description: "Tool length compensation WK: added to absolute positions of the blocks that start from now on.",
        get: |p| Value::Int(p.wf.tool_length),
        set: |p, v| p.wf.tool_length = int(v).unwrap_or(p.wf.tool_length),
        ..OFFSET
    },
];

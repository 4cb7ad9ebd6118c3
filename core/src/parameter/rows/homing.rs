//! Homing, by its native names.

use super::{Applies, BASE, Effect, Group, HOUR_NS, Measure, REAL, Range, Row, Value, int, option, real};

const HOMING_ROW: Row = Row { group: Group::Homing, applies: Applies::Drive, effect: Effect::NextHoming, ..BASE };

/// None, those of CiA 402, and below 0 the HOME_TYPE of MACS.
const METHODS: &[(i64, i64)] = &[(-4, 14), (17, 30), (33, 35), (37, 37)];
const NO_YES: Measure = Measure::Choice(&["false", "true"]);
const DISTANCE: Range = Range::Int(1, (1 << 61) - 1);

const fn whole(value: Option<i64>) -> Value {
    match value {
        Some(value) => Value::Int(value),
        None => Value::Unset,
    }
}

pub(super) const ROWS: &[Row] = &[
    Row {
        key: "homing.method",
        measure: Measure::Integer,
        range: Range::Among(METHODS),
        default: Value::Int(0),
        description: "How the axis gets its zero: a method of CiA 402 (1 to 14, 17 to 30, 33, 34, 35 and 37 here), -1 to -4 \
                      for home_type 0 to 3 of MACS, 0 not at all: its zero is where it was switched on.",
        source: "CiA 402 part 2 object 6098h, MACS-HOME-03",
        get: |p| Value::Int(p.homing.method),
        set: |p, v| p.homing.method = int(v).unwrap_or(0),
        ..HOMING_ROW
    },
    Row {
        key: "homing.in_drive",
        measure: NO_YES,
        range: Range::Int(0, 1),
        default: Value::Int(0),
        description: "The drive homes by itself, in mode 6, with the number of homing.method; its backend must offer that.",
        source: "contract section 8",
        get: |p| Value::Int(p.homing.in_drive.into()),
        set: |p, v| p.homing.in_drive = int(v) == Some(1),
        ..HOMING_ROW
    },
    Row {
        key: "homing.required",
        measure: NO_YES,
        range: Range::Int(0, 1),
        default: Value::Int(0),
        effect: Effect::AtOnce,
        description: "No motion before homing is done: after a start, and after a change of encoder, direction of rotation or homing.",
        source: "contract section 3, MACS-HOME-09",
        get: |p| Value::Int(p.homing.required.into()),
        set: |p, v| p.set_home_force(i64::from(int(v) == Some(1))),
        ..HOMING_ROW
    },
    Row {
        key: "homing.velocity",
        measure: Measure::Velocity,
        range: Range::Real(-1e15, 1e15),
        default_text: "a tenth of max_velocity",
        description: "Velocity towards the reference switch, up to max_velocity; its sign is the direction of the sequences of \
                      MACS, while methods of CiA 402 know theirs. With 0 homing is refused.",
        source: "CiA 402 part 2 object 6099h, MACS-HOME-01",
        get: |p| option(p.homing.velocity),
        set: |p, v| {
            p.homing.velocity = real(v);
            p.homing.parts.velocity = None;
        },
        ..HOMING_ROW
    },
    Row {
        key: "homing.index_velocity",
        measure: Measure::Velocity,
        range: REAL,
        default_text: "a tenth of max_velocity",
        description: "Velocity of the last approach to the edge of a switch and of the search for the index, up to \
                      homing.velocity. An edge without a latch is exact to the travel of one cycle at it.",
        source: "CiA 402 part 2 object 6099h, MACS-HOME-06",
        get: |p| option(p.homing.index_velocity),
        set: |p, v| {
            p.homing.index_velocity = real(v);
            p.homing.parts.index_velocity = None;
        },
        ..HOMING_ROW
    },
    Row {
        key: "homing.acceleration",
        measure: Measure::Acceleration,
        range: REAL,
        default_text: "a tenth of max_acceleration",
        description: "Acceleration of homing, and with it the same share of the largest deceleration; never more than \
                      default_acceleration.",
        source: "CiA 402 part 2 object 609Ah, MACS-HOME-02",
        get: |p| option(p.homing.acceleration),
        set: |p, v| {
            p.homing.acceleration = real(v);
            p.homing.parts.acceleration = None;
        },
        ..HOMING_ROW
    },
    Row {
        key: "homing.offset",
        measure: Measure::Position,
        range: Range::Int(1 - (1 << 61), (1 << 61) - 1),
        default: Value::Int(0),
        description: "Where the zero lies, counted from the switch or the index. The sequences of MACS move the axis there, methods \
                      of CiA 402 do not.",
        source: "CiA 402 part 2 object 607Ch, MACS-HOME-07",
        get: |p| Value::Int(p.homing.offset),
        set: |p, v| p.homing.offset = int(v).unwrap_or(0),
        ..HOMING_ROW
    },
    Row {
        key: "homing.index_distance",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "a revolution of the encoder: 4 * encoder increments, encoder of an absolute one",
        description: "Longest way in which an index pulse must come; without one homing ends in an error.",
        source: "MACS-HOME-05",
        get: |p| whole(p.homing.index_distance),
        set: |p, v| p.homing.index_distance = int(v),
        ..HOMING_ROW
    },
    Row {
        key: "homing.max_distance",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "twice the way from min_position to max_position; where one of them is left out twice the modulo, none without one",
        description: "Longest travel of each search for a switch, and of an axis that its drive homes from the start; beyond it homing ends in an error.",
        source: "contract section 7",
        get: |p| whole(p.homing.max_distance),
        set: |p, v| p.homing.max_distance = int(v),
        ..HOMING_ROW
    },
    Row {
        key: "homing.max_time",
        measure: Measure::Time,
        range: Range::Int(0, HOUR_NS),
        default: Value::Int(0),
        effect: Effect::AtOnce,
        description: "Longest time of homing, from its start to the zero; beyond it homing ends in an error (10315). 0: no limit.",
        source: "contract section 7",
        get: |p| Value::Int(p.homing.max_time),
        set: |p, v| p.homing.max_time = int(v).unwrap_or(0),
        ..HOMING_ROW
    },
];

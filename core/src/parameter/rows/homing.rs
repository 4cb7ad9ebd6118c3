//! Homing, by its native names.

use super::{Applies, BASE, Effect, Group, HOUR_NS, Measure, REAL, Range, Row, Value, int};

const HOMING_ROW: Row = Row { group: Group::Homing, applies: Applies::Drive, effect: Effect::NextHoming, ..BASE };

/// None, those of CiA 402, and below 0 the HOME_TYPE of MACS.
const METHODS: &[(i64, i64)] = &[(-4, 14), (17, 30), (33, 35), (37, 37)];
const NO_YES: Measure = Measure::Choice(&["false", "true"]);
const DISTANCE: Range = Range::Int(1, (1 << 61) - 1);

pub(super) const ROWS: &[Row] = rows! {
    "homing.method": HOMING_ROW, axis.homing.method {
        range: Range::Among(METHODS), default: Value::Int(0),
        description: "How the axis gets its zero: a method of CiA 402 (1 to 14, 17 to 30, 33, 34, 35 and 37 here), -1 to -4 for home_type \
            0 to 3 of MACS, 0 not at all: its zero is where it was switched on.",
        source: "CiA 402 part 2 object 6098h, MACS-HOME-03" }
    "homing.in_drive": HOMING_ROW, axis.homing.in_drive {
        measure: NO_YES, range: Range::Int(0, 1), default: Value::Int(0),
        description: "The drive homes by itself, in mode 6, with the number of homing.method; its backend must offer that.",
        source: "contract section 8" }
    "homing.required": HOMING_ROW {
        measure: NO_YES, range: Range::Int(0, 1), default: Value::Int(0), effect: Effect::AtOnce,
        get: |p| Value::Int(p.homing.required.into()), set: |p, v| p.set_home_force(i64::from(int(v) == Some(1))),
        description: "No motion before homing is done: after a start, and after a change of encoder, direction of rotation or homing.",
        source: "contract section 3, MACS-HOME-09" }
    "homing.velocity": HOMING_ROW, axis.homing.velocity, clears homing.parts.velocity {
        measure: Measure::Velocity, range: Range::Real(-1e15, 1e15), default_text: "a tenth of max_velocity",
        description: "Velocity towards the reference switch, up to max_velocity; its sign is the direction of the sequences of MACS, while \
            methods of CiA 402 know theirs. With 0 homing is refused.",
        source: "CiA 402 part 2 object 6099h, MACS-HOME-01" }
    "homing.index_velocity": HOMING_ROW, axis.homing.index_velocity, clears homing.parts.index_velocity {
        measure: Measure::Velocity, range: REAL, default_text: "a tenth of max_velocity",
        description: "Velocity of the last approach to the edge of a switch and of the search for the index, up to homing.velocity. An \
            edge without a latch is exact to the travel of one cycle at it.",
        source: "CiA 402 part 2 object 6099h, MACS-HOME-06" }
    "homing.acceleration": HOMING_ROW, axis.homing.acceleration, clears homing.parts.acceleration {
        measure: Measure::Acceleration, range: REAL, default_text: "a tenth of max_acceleration",
        description: "Acceleration of homing, and with it the same share of the largest deceleration; never more than \
            default_acceleration.",
        source: "CiA 402 part 2 object 609Ah, MACS-HOME-02" }
    "homing.offset": HOMING_ROW, axis.homing.offset {
        measure: Measure::Position, range: Range::Int(1 - (1 << 61), (1 << 61) - 1), default: Value::Int(0),
        description: "Where the zero lies, counted from the switch or the index. The sequences of MACS move the axis there, methods of CiA \
            402 do not.",
        source: "CiA 402 part 2 object 607Ch, MACS-HOME-07" }
    "homing.index_distance": HOMING_ROW, axis.homing.index_distance {
        measure: Measure::Distance, range: DISTANCE,
        default_text: "a revolution of the encoder: 4 * encoder increments, encoder of an absolute one",
        description: "Longest way in which an index pulse must come; without one homing ends in an error.", source: "MACS-HOME-05" }
    "homing.max_distance": HOMING_ROW, axis.homing.max_distance {
        measure: Measure::Distance, range: DISTANCE,
        default_text: "twice the way from min_position to max_position; where one of them is left out twice the modulo, none without one",
        description: "Longest travel of each search for a switch, and of an axis that its drive homes from the start; beyond it homing \
            ends in an error.",
        source: "contract section 7" }
    "homing.max_time": HOMING_ROW, axis.homing.max_time {
        measure: Measure::Time, range: Range::Int(0, HOUR_NS), default: Value::Int(0), effect: Effect::AtOnce,
        description: "Longest time of homing, from its start to the zero; beyond it homing ends in an error (10315). 0: no limit.",
        source: "contract section 7" }
};

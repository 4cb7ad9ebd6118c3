//! Gantries: axes with two drives, by native names.

use super::{Applies, BASE, Effect, Group, MLONG, Measure, Range, Row, Value, int};

const GANTRY_ROW: Row = Row { group: Group::Inputs, applies: Applies::Gantry, ..BASE };
const DISTANCE: Range = Range::Int(1, (1 << 61) - 1);

const fn whole(value: Option<i64>) -> Value {
    match value {
        Some(value) => Value::Int(value),
        None => Value::Unset,
    }
}

pub(super) const ROWS: &[Row] = &[
    Row {
        key: "max_skew",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "none: an axis with two drives must have it",
        description: "Most that the two drives of the axis may be from square. Beyond it the axis stops by skew_reaction in that cycle, and \
                      cannot be switched on.",
        source: "contract section 3",
        get: |p| whole(p.gantry.max_skew),
        set: |p, v| p.gantry.max_skew = int(v),
        ..GANTRY_ROW
    },
    Row {
        key: "skew_reaction",
        range: Range::Int(0, 5),
        default: Value::Int(0),
        description: "What a skew beyond max_skew does, by the numbers of error_reaction: 0 both drives off at once, 1 off and the brake \
                      closed, 2 stop and hold, 3 stop, then the brake closed, 4 the drives stop by themselves, 5 go on, and report it.",
        source: "contract section 3",
        get: |p| Value::Int(p.gantry.skew_reaction),
        set: |p, v| p.gantry.skew_reaction = int(v).unwrap_or(0),
        ..GANTRY_ROW
    },
    Row {
        key: "squaring_distance",
        group: Group::Homing,
        measure: Measure::Distance,
        range: DISTANCE,
        effect: Effect::NextHoming,
        default_text: "ten times max_skew",
        description: "Most that homing may find the two drives from square, and most that one reference switch may come behind the other; \
                      beyond it homing ends in an error.",
        source: "contract section 3",
        get: |p| whole(p.gantry.squaring_distance),
        set: |p, v| p.gantry.squaring_distance = int(v),
        ..GANTRY_ROW
    },
    Row {
        key: "square_offset",
        group: Group::Homing,
        measure: Measure::Position,
        range: Range::Int(1 - (1 << 61), (1 << 61) - 1),
        effect: Effect::Start,
        default_text: "as the drives stand when they are read first",
        description: "Counts of the second drive minus counts of the first where the axis is square, as drives know it that keep their counts \
                      without power; homing squares it again.",
        source: "contract section 3",
        get: |p| whole(p.gantry.square_offset),
        set: |p, v| p.gantry.square_offset = int(v),
        ..GANTRY_ROW
    },
    Row {
        key: "i_refswitch_second",
        range: Range::Int(-MLONG, MLONG),
        default: Value::Int(0),
        description: "Input of the reference switch of the second drive: n, inverted for -n, 0 none; i_refswitch is that of the first.",
        source: "contract section 3",
        get: |p| Value::Int(p.gantry.second_refswitch),
        set: |p, v| p.gantry.second_refswitch = int(v).unwrap_or(0),
        ..GANTRY_ROW
    },
];

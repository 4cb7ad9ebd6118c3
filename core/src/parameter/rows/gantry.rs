//! Gantries: axes with two drives, by native names.

use super::{Applies, BASE, Effect, Group, MLONG, Measure, Range, Row, Value};

const GANTRY_ROW: Row = Row { group: Group::Inputs, applies: Applies::Gantry, ..BASE };
const DISTANCE: Range = Range::Int(1, (1 << 61) - 1);

pub(super) const ROWS: &[Row] = rows! {
    "max_skew": GANTRY_ROW, axis.gantry.max_skew {
        measure: Measure::Distance, range: DISTANCE, default_text: "none: an axis with two drives must have it",
        description: "Most that the two drives of the axis may be from square. Beyond it the axis stops by skew_reaction in that cycle, \
            and cannot be switched on.",
        source: "contract section 3" }
    "skew_reaction": GANTRY_ROW, axis.gantry.skew_reaction {
        range: Range::Int(0, 5), default: Value::Int(0),
        description: "What a skew beyond max_skew does, by the numbers of error_reaction: 0 both drives off at once, 1 off and the brake \
            closed, 2 stop and hold, 3 stop, then the brake closed, 4 the drives stop by themselves, 5 go on, and report it.",
        source: "contract section 3" }
    "squaring_distance": GANTRY_ROW, axis.gantry.squaring_distance {
        group: Group::Homing, measure: Measure::Distance, range: DISTANCE, default_text: "ten times max_skew", effect: Effect::NextHoming,
        description: "Most that homing may find the two drives from square, and most that one reference switch may come behind the other; \
            beyond it homing ends in an error.",
        source: "contract section 3" }
    "square_offset": GANTRY_ROW, axis.gantry.square_offset {
        group: Group::Homing, measure: Measure::Position, range: Range::Int(1 - (1 << 61), (1 << 61) - 1),
        default_text: "as the drives stand when they are read first", effect: Effect::Start,
        description: "Counts of the second drive minus counts of the first where the axis is square, as drives know it that keep their \
            counts without power; homing squares it again.",
        source: "contract section 3" }
    "i_refswitch_second": GANTRY_ROW, axis.gantry.second_refswitch {
        range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Input of the reference switch of the second drive: n, inverted for -n, 0 none; i_refswitch is that of the first.",
        source: "contract section 3" }
};

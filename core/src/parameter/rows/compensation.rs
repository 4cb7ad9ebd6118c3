//! Compensation of what is between motor and load, by native names.

use super::{Applies, BASE, Group, Measure, REAL, Range, Row, Value};

const COMPENSATION_ROW: Row = Row { group: Group::Encoder, applies: Applies::Positioned, ..BASE };

pub(super) const ROWS: &[Row] = rows! {
    "compensation.backlash": COMPENSATION_ROW, axis.compensation.backlash {
        measure: Measure::Distance, range: Range::Int(0, 1 << 30), default: Value::Int(0),
        description: "How far the motor turns before the load follows it back, taken up at each reversal once the axis knows its zero: \
            none in the sense in which homing came to its reference, all of it in the other one. 0: no backlash.",
        source: "WF-INC-04" }
    "compensation.velocity": COMPENSATION_ROW, axis.compensation.velocity {
        measure: Measure::Velocity, range: REAL, default_text: "a tenth of max_velocity",
        description: "How fast the drive is led to what is compensated, backlash and pitch error alike, in addition to its motion; at most \
            max_velocity.",
        source: "WF-INC-04" }
};

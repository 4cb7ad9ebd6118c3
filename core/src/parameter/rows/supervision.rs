//! What watches over an axis, by its native names.

use super::super::FOLLOWING_ERROR_CHECKS;
use super::{Applies, BASE, Group, HOUR_NS, Measure, Range, Row, Value};

const SUPERVISION_ROW: Row = Row { group: Group::Inputs, applies: Applies::Drive, ..BASE };

pub(super) const ROWS: &[Row] = rows! {
    "following_error_check": SUPERVISION_ROW, axis.supervision.following_error_check {
        group: Group::Regulation, measure: Measure::Choice(FOLLOWING_ERROR_CHECKS), range: Range::Int(0, 1), default: Value::Int(0),
        description: "When the following error is looked at: every_cycle, or round_robin as MACS does, one axis with a drive every 20 ms.",
        source: "MACS-ERR-07",
        note: "A-45: MACS looks round robin; here each axis is looked at in every cycle unless this asks otherwise, because that finds an \
            error sooner." }
    "following_error_stops_all": SUPERVISION_ROW, axis.supervision.following_error_stops_all {
        group: Group::Regulation, range: Range::Int(0, 1), default: Value::Int(0),
        description: "1: a following error of this axis stops all axes with a drive, each by its own error_reaction, as MACS does. 0: it \
            stops this axis alone.",
        source: "MACS-ERR-05",
        note: "A-44: MACS stops all axes of its controller. A cell may hold machines that have nothing to do with each other, so a cell \
            that wants it says so; axes of one trajectory stop together either way." }
    "in_position_timeout": SUPERVISION_ROW, axis.supervision.in_position_timeout {
        measure: Measure::Time, range: Range::Int(0, HOUR_NS), default: Value::Int(0),
        description: "A goal that waits that long for its target window after the end of its profile is reported, once; it goes on \
            waiting. 0: never.",
        source: "MACS-TGT-06" }
};

//! Limits, windows, reactions, assigned inputs and outputs (AXI).

use super::super::{Applies, BASE, Bare, Group, MLONG, Measure, Range, Row, System, Value, int};

const INPUTS_ROW: Row = Row { system: System::Macs, group: Group::Inputs, applies: Applies::Drive, ..BASE };

pub(in super::super) const ROWS: &[Row] = rows! {
    "neglimit": INPUTS_ROW {
        mnemonic: "NEGLIMIT", number: "4", view_of: "min_position", unit: "inc", range: Range::Int(-MLONG, MLONG),
        default: Value::Int(-500_000), applies: Applies::Any,
        get: |p| Value::Int(p.active_neglimit().unwrap_or(p.macs.neglimit)),
        set: |p, v| { p.macs.neglimit = int(v).unwrap_or(p.macs.neglimit); p.set_falling(p.active_neglimit().map(|_| p.macs.neglimit)); },
        description: "Lowest position, in force with swneglimact 1: min_position. It is kept while it is off.",
        source: "MACS-LIM-01, MACS-UNIT-03" }
    "poslimit": INPUTS_ROW {
        mnemonic: "POSLIMIT", number: "5", view_of: "max_position", unit: "inc", range: Range::Int(-MLONG, MLONG),
        default: Value::Int(500_000), applies: Applies::Any,
        get: |p| Value::Int(p.active_poslimit().unwrap_or(p.macs.poslimit)),
        set: |p, v| { p.macs.poslimit = int(v).unwrap_or(p.macs.poslimit); p.set_rising(p.active_poslimit().map(|_| p.macs.poslimit)); },
        description: "Highest position, in force with swposlimact 1: max_position. It is kept while it is off.",
        source: "MACS-LIM-01, MACS-UNIT-03" }
    "swneglimact": INPUTS_ROW {
        mnemonic: "SWNEGLIMACT", number: "19", view_of: "min_position", range: Range::Int(0, 1), default: Value::Int(0),
        applies: Applies::Any,
        get: |p| Value::Int(p.active_neglimit().is_some().into()),
        // One that is in force stays as it is.
        set: |p, v| p.set_falling((int(v) == Some(1)).then(|| p.active_neglimit().unwrap_or(p.macs.neglimit))),
        description: "1: neglimit is in force, 0: there is no lowest position.", source: "MACS-LIM-02" }
    "swposlimact": INPUTS_ROW {
        mnemonic: "SWPOSLIMACT", number: "20", view_of: "max_position", range: Range::Int(0, 1), default: Value::Int(0),
        applies: Applies::Any,
        get: |p| Value::Int(p.active_poslimit().is_some().into()),
        // One that is in force stays as it is.
        set: |p, v| p.set_rising((int(v) == Some(1)).then(|| p.active_poslimit().unwrap_or(p.macs.poslimit))),
        description: "1: poslimit is in force, 0: there is no highest position.", source: "MACS-LIM-02" }
    "testwin": INPUTS_ROW, axis.in_position_window {
        mnemonic: "TESTWIN", number: "8", view_of: "in_position_window", unit: "inc", range: Range::Int(0, 10_000), default: Value::Int(0),
        applies: Applies::Any,
        description: "How near to the target the actual position must be: in_position_window. 0: the command alone has to arrive.",
        source: "MACS-TGT-01, MACS-TGT-02, MACS-UNIT-03" }
    "testtim": INPUTS_ROW, axis.in_position_time {
        mnemonic: "TESTTIM", number: "24", view_of: "in_position_time", measure: Measure::Time, range: Range::Int(0, 10_000_000),
        bare: Bare::Milliseconds, default: Value::Int(0), applies: Applies::Any,
        description: "How long the actual position has to stay in the target window: in_position_time.", source: "MACS-TGT-03, MACS-TGT-04",
        note: "A-18: the text bounds testwin with testval, which no range allows; that is not asked." }
    "errcond": INPUTS_ROW, axis.error_reaction {
        mnemonic: "ERRCOND", number: "43", view_of: "error_reaction", range: Range::Int(0, 5), default: Value::Int(0),
        applies: Applies::Any,
        description: "Reaction to an error: error_reaction, with the same numbers.", source: "MACS-ERR-02" }
    "testval": INPUTS_ROW, axis.supervision.testval {
        mnemonic: "TESTVAL", number: "25", unit: "inc", range: Range::Int(0, 10_000), default: Value::Int(0),
        description: "Two readings of the position, testtim apart, have to differ by less than this inside the target window; 0: it has to \
            stay inside for longer than testtim.",
        source: "MACS-TGT-03, MACS-TGT-04",
        note: "A-18: the range begins at 1, and not set is a rule of its own; 0 is taken as not set. MACS begins with 1; here that would \
            make in_position_time wait for two equal readings, so it begins as not set." }
    "endswmod": INPUTS_ROW, axis.supervision.endswmod {
        mnemonic: "ENDSWMOD", number: "44", range: Range::Int(0, 1), default: Value::Int(0),
        description: "Reaction to a limit switch: 0 as errcond says, 1 a stop with the largest deceleration; the axis stays in control.",
        source: "MACS-LIM-08",
        note: "A-17: whether 1 is an error, too, is not said; it is, raised in the cycle of the switch. With errcond 5 a switch stops as \
            with 1: nothing runs on into it." }
    "i_refswitch": INPUTS_ROW, axis.assigned.refswitch {
        mnemonic: "I_REFSWITCH", number: "45", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Input of the reference switch: n with the rising edge, -n with the falling one, 0 none.", source: "MACS-IO-02",
        note: "A-48: the range is +-8, other places allow any input; any is taken." }
    "i_poslimitsw": INPUTS_ROW, axis.assigned.poslimitsw {
        mnemonic: "I_POSLIMITSW", number: "46", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Input of the positive limit switch: n with the rising edge, -n with the falling one, 0 none.", source: "MACS-LIM-07" }
    "i_neglimitsw": INPUTS_ROW, axis.assigned.neglimitsw {
        mnemonic: "I_NEGLIMITSW", number: "47", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Input of the negative limit switch: n with the rising edge, -n with the falling one, 0 none.", source: "MACS-LIM-07" }
    "o_brake": INPUTS_ROW, axis.outputs.brake {
        mnemonic: "O_BRAKE", number: "48", range: Range::Int(-8, 8), default: Value::Int(0),
        description: "Output of the brake: n is high while the brake is closed, -n is low, 0 none. Errors close it with errcond 1 and 3; \
            only a program opens it.",
        source: "MACS-IO-04", note: "A-49: when the brake closes is described twice; errors with errcond 1 and 3, an abort always." }
    "o_axmove": INPUTS_ROW, axis.outputs.axmove {
        mnemonic: "O_AXMOVE", number: "64", range: Range::Int(-8, 8), default: Value::Int(0),
        description: "Output that shows a motion under way: n high, -n low, 0 none. It says nothing of whether the motor turns.",
        source: "MACS-IO-06" }
    "esccond": INPUTS_ROW, axis.supervision.esccond {
        mnemonic: "ESCCOND", number: "70", range: Range::Int(0, 2), default: Value::Int(0),
        description: "Outputs at an abort: 0 as they are, 1 all off, 2 all on; the largest of all axes decides. Whatever it is, brakes \
            close and all axes stop with the largest deceleration.",
        source: "MACS-ERR-09" }
};

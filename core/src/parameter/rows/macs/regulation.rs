//! The position loop (AXR).

use super::super::{Applies, BASE, Bare, Effect, Group, MLONG, Measure, Range, Row, System, Value};

const REGULATION_ROW: Row = Row { system: System::Macs, group: Group::Regulation, applies: Applies::Drive, ..BASE };
/// Of the PID loop; a change is faded in within 64 samples, but for that of the period, which waits until the axis is off.
const PID_ROW: Row = Row { effect: Effect::AtOnce, applies: Applies::Pid, ..REGULATION_ROW };

/// REVERS: -10 to -90, or rule (0 to 2) + 10 output + 100 node.
static REVERS: [(i64, i64); 9 + 1280] = {
    let mut ranges = [(0, 0); 9 + 1280];
    let mut place = 0;
    while place < ranges.len() {
        let tens = place as i64 - 9;
        ranges[place] = if tens < 0 { (tens * 10, tens * 10) } else { (tens * 10, tens * 10 + 2) };
        place += 1;
    }
    ranges
};

pub(in super::super) const ROWS: &[Row] = rows! {
    "poserr": REGULATION_ROW, axis.max_following_error {
        mnemonic: "POSERR", number: "15", view_of: "max_following_error", unit: "inc", range: Range::Int(1, MLONG),
        default: Value::Int(1000),
        description: "Following error that is tolerated: max_following_error. One revolution of the encoder, 4 ENCODER, is a good value.",
        source: "MACS-ERR-06, MACS-UNIT-03", note: "D15: the default is 20000 in the overview; 1000 is taken." }
    "proftime": REGULATION_ROW, axis.macs.proftime {
        mnemonic: "PROFTIME", number: "29", unit: "ms", range: Range::Int(1, 5), default: Value::Int(1), applies: Applies::Any,
        description: "Period of the profile generator of MACS, kept and without effect: the profile runs in every cycle here, and goals \
            that give no rates take the defaults.",
        source: "MACS-PROF-05, MACS-STO-09",
        note: "D16: the default is 1000 in the overview; 1 ms is taken, and an import reads 1000 to 5000 as us." }
    "poserrtime": REGULATION_ROW, axis.following_error_time {
        mnemonic: "POSERRTIME", number: "111", view_of: "following_error_time", measure: Measure::Time,
        range: Range::Int(0, 10_000_000_000), bare: Bare::Milliseconds, default: Value::Int(0),
        description: "How long the following error may be exceeded: following_error_time. 0: not at all.", source: "MACS-ERR-07" }
    "drivetype": REGULATION_ROW {
        mnemonic: "DRIVETYPE", number: "0", range: Range::Int(-194, 194), default: Value::Int(0), effect: Effect::Disabled,
        missing: "the choice of a drive by number other than by key drivetype of the drive in the cell",
        description: "Kind of drive: 0 an analog output, 1 to 13 a drive on the bus, 91 to 94 an output on the bus, 100 more: its control \
            word is left alone; negative without guarding. Setting it builds the objects of the bus again.",
        source: "MACS-CAN-01", note: "D09: the range is +-94 though 110 is used; +-194 in AXR is taken." }
    "kprop": PID_ROW, axis.pid.proportional {
        mnemonic: "KPROP", number: "11", range: Range::Int(1, 65_000), default: Value::Int(30),
        description: "Proportional gain of the position loop, on an error in increments.", source: "MACS-REG-01" }
    "kder": PID_ROW, axis.pid.derivative {
        mnemonic: "KDER", number: "12", range: Range::Int(0, 65_000), default: Value::Int(0),
        description: "Derivative gain of the position loop, on the change of the error in one period.", source: "MACS-REG-01",
        note: "D13: the default is 1 in the overview; 0 is taken." }
    "kint": PID_ROW, axis.pid.integral {
        mnemonic: "KINT", number: "13", range: Range::Int(0, 65_000), default: Value::Int(0),
        description: "Integral gain of the position loop, on the sum of the errors of all periods.", source: "MACS-REG-01" }
    "timer": PID_ROW, axis.pid.period_ms {
        mnemonic: "TIMER", number: "14", unit: "ms", range: Range::Int(1, 1000), default: Value::Int(1), effect: Effect::Disabled,
        description: "Period of the position loop and of the setpoints to the drive.", source: "MACS-REG-04" }
    "kilim": PID_ROW, axis.pid.limit {
        mnemonic: "KILIM", number: "21", range: Range::Int(0, 65_000), default: Value::Int(1000),
        description: "Bound of the sum of errors, either way; 0 is no integral part.", source: "MACS-REG-05",
        note: "D14: the default is 0 in the overview; 1000 is taken, without effect while KINT is 0. A-23: whether the sum or its product \
            with KINT is bounded is not said; the sum is." }
    "bandwidth": PID_ROW, axis.pid.bandwidth {
        mnemonic: "BANDWIDTH", number: "35", unit: "1/10 %", range: Range::Int(0, 1000), default: Value::Int(1000),
        description: "Share of the output that the position loop may use; feed-forward is added to it.", source: "MACS-REG-08",
        note: "D04: the unit is % in the overview; 1/10 % is taken, so that 1000 is all of it. A-24: clamp or scale is described in two \
            ways; a clamp is taken." }
    "ffvel": PID_ROW, axis.pid.velocity {
        mnemonic: "FFVEL", number: "36", unit: "1/1000", range: Range::Int(0, 100_000), default: Value::Int(0),
        description: "Share of the output that the command velocity VELMAX adds: 1000 is all of it; 0 off.", source: "MACS-REG-09",
        note: "D10: the unit is % in the overview and the scale 1000 in the detail; 1/1000 is taken." }
    "ffacc": PID_ROW, axis.pid.acceleration {
        mnemonic: "FFACC", number: "37", unit: "1/1000", range: Range::Int(0, 100_000), default: Value::Int(0),
        description: "Share of the output that the largest command acceleration adds: 1000 is all of it; 0 off.", source: "MACS-REG-10",
        note: "D10: the unit is % in the overview and missing in the detail; 1/1000 is taken, as for ffvel (A-25)." }
    "regwmax": PID_ROW, axis.pid.window.max {
        mnemonic: "REGWMAX", number: "38", unit: "inc", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Error beyond which the position loop switches on again; with regwmin 0, too, it is always on.", source: "MACS-REG-11",
        note: "A-26: the compared value is lost with a figure; command minus actual position is taken." }
    "regwmin": PID_ROW, axis.pid.window.min {
        mnemonic: "REGWMIN", number: "39", unit: "inc", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Error inside which the position loop switches off until regwmax is exceeded.", source: "MACS-REG-11",
        note: "A-26: the compared value is lost with a figure; command minus actual position is taken." }
    "revers": REGULATION_ROW, axis.macs.revers {
        mnemonic: "REVERS", number: "63", range: Range::Among(&REVERS), default: Value::Int(0), effect: Effect::Disabled,
        description: "May the axis move backwards? 0 always, 1 only while its master does, 2 never.", source: "MACS-DIR-05, MACS-DIR-06",
        note: "A-08: the printed range leaves out samples of the text; rule 0 to 2, output 0 to 9, node 0 to 127 and -10, -20 to -90 are \
            taken. Outputs are for interface velocity and open_loop; key node of the drive says its node: values of 100 and above are \
            refused." }
    "kilimtime": PID_ROW, axis.pid.limit_time {
        mnemonic: "KILIMTIME", number: "105", unit: "ms", range: Range::Int(-32_767, 32_767), default: Value::Int(0),
        description: "When the integral part acts: 0 always, positive in motion only, negative at rest only; the value is the time of the \
            change.",
        source: "MACS-REG-06" }
};

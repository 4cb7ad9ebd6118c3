//! Parameters of the machine (GL).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value};

const GLOBAL_ROW: Row = Row { system: System::Macs, group: Group::Global, applies: Applies::Machine, ..BASE };

/// CANBAUD: one or two digits, each 0 to 8 (D05).
const CANBAUD: [(i64, i64); 9] = {
    let mut ranges = [(0, 0); 9];
    let mut tens = 0;
    while tens < 9 {
        ranges[tens as usize] = (tens * 10, tens * 10 + 8);
        tens += 1;
    }
    ranges
};

/// VMENCMTYP: the index, or an edge of input 1 to 9 (MACS-VM-07, A-46).
const VMENCMTYP: [(i64, i64); 10] = {
    let mut ranges = [(0, 1); 10];
    let mut input = 1;
    while input < 10 {
        ranges[input as usize] = (input * 10 + 2, input * 10 + 3);
        input += 1;
    }
    ranges
};

pub(in super::super) const ROWS: &[Row] = rows! {
    "cannr": GLOBAL_ROW {
        mnemonic: "CANNR", number: "100", range: Range::Among(&[(0, 127), (9999, 9999)]), default: Value::Int(0), effect: Effect::Start,
        missing: "a node id other than by key master of the bus in the cell",
        description: "Own node on the bus, 1 to 127; 0 none, 9999 without the usual objects.", source: "MACS-CAN-19",
        note: "D23: the range is missing in the overview; 0 to 127 and 9999 are taken." }
    "canbaud": GLOBAL_ROW {
        mnemonic: "CANBAUD", number: "101", range: Range::Among(&CANBAUD), default: Value::Int(5), effect: Effect::Start,
        missing: "a bit rate other than by key bitrate of the bus in the cell",
        description: "Bit rate: 0 to 8 for 5, 10, 20, 50, 100, 125, 250, 500, 1000 kbit/s; with two buses the tens digit is the master \
            bus, the units digit the slave bus.",
        source: "MACS-CAN-20", note: "D05: the range 0 to 8 leaves out two digits, which MACS3 has; each digit may be 0 to 8." }
    "prgpar": GLOBAL_ROW {
        mnemonic: "PRGPAR", number: "102", range: Range::Among(&[(-1, 127), (999, 1127)]), default: Value::Int(-1), effect: Effect::Start,
        missing: "program control",
        description: "Program that starts after the autostart program; -1 none, 1000 more: with the motors off.", source: "MACS-IO-11" }
    "i_prgstart": GLOBAL_ROW {
        mnemonic: "I_PRGSTART", number: "103", range: Range::Int(0, 8), default: Value::Int(0), effect: Effect::Start,
        missing: "program control",
        description: "Input that starts the program that was chosen; 0 none.", source: "MACS-IO-12" }
    "i_prgchoice": GLOBAL_ROW {
        mnemonic: "I_PRGCHOICE", number: "104", range: Range::Int(0, 8), default: Value::Int(0), effect: Effect::Start,
        missing: "program control",
        description: "First of the inputs that choose a program, binary, up to the one before i_prgstart; 0 none.", source: "MACS-IO-13",
        note: "A-50: the example lost an input and the limits disagree; the choice is one of 0 to 89." }
    "i_break": GLOBAL_ROW, machine.i_break {
        mnemonic: "I_BREAK", number: "105", range: Range::Int(-8, 8), default: Value::Int(0),
        description: "Input that aborts what runs: every goal ends and every axis stops with its largest deceleration, locked until \
            i_continue or reset_errors. n with the rising edge, -n with the falling one, 0 none.",
        source: "MACS-IO-08", note: "A-47: sign and edge are described in two ways; the table is taken." }
    "i_continue": GLOBAL_ROW, machine.i_continue {
        mnemonic: "I_CONTINUE", number: "106", range: Range::Int(-8, 8), default: Value::Int(0),
        description: "Input that lets axes that i_break stopped take goals again: n with the rising edge, -n with the falling one, 0 none.",
        source: "MACS-IO-09", note: "A-47: sign and edge are described in two ways; the table is taken." }
    "i_errclr": GLOBAL_ROW, machine.i_errclr {
        mnemonic: "I_ERRCLR", number: "107", range: Range::Int(-8, 8), default: Value::Int(0),
        description: "Input that clears the errors of all axes as reset_errors does: n with the rising edge, -n with the falling one, 0 \
            none.",
        source: "MACS-IO-10", note: "A-47: sign and edge are described in two ways; the table is taken." }
    "o_error": GLOBAL_ROW, machine.o_error {
        mnemonic: "O_ERROR", number: "108", range: Range::Int(-8, 8), default: Value::Int(0),
        description: "Output that shows an error of any axis: n high, -n low, 0 none.", source: "MACS-IO-07" }
    "ainftime": GLOBAL_ROW, machine.ainftime {
        mnemonic: "AINFTIME", number: "109", unit: "samples", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Readings of 1 ms over which analog input 1 is smoothed; 0 not.", source: "MACS-IO-14" }
    "cansynctimer": GLOBAL_ROW {
        mnemonic: "CANSYNCTIMER", number: "114", unit: "ms", range: Range::Int(0, MLONG), default: Value::Int(1),
        missing: "a period of SYNC beside the cycle of the cell",
        description: "Period in which the drives are asked for their positions; 0: never.", source: "MACS-CAN-17",
        note: "D06: the default is 0 in the overview; 1 is taken. A-54: 0 is not explained; it is no cyclic request." }
    "vmenctyp": GLOBAL_ROW, machine.vmenctyp {
        mnemonic: "VMENCTYP", number: "116", range: Range::Int(0, MLONG), default: Value::Int(0), effect: Effect::NextVirtualMaster,
        description: "Whose velocity machine.vmaster has: hundreds the axis, in the order of the cell, whose command it is, 0 pulsvel; the \
            rest, the encodertype while it is off, is 0: it stands. 100000 more is the same: there is no output in any case.",
        source: "MACS-VM-01, MACS-VM-03, MACS-VM-05" }
    "vmencres": GLOBAL_ROW, machine.vmencres {
        mnemonic: "VMENCRES", number: "117", unit: "inc", range: Range::Int(0, 65_535), default: Value::Int(500),
        description: "Increments between two index pulses of machine.vmaster, which are at its multiples; 0 none.", source: "MACS-VM-06" }
    "vmencmtyp": GLOBAL_ROW, machine.vmencmtyp {
        mnemonic: "VMENCMTYP", number: "118", range: Range::Among(&VMENCMTYP), default: Value::Int(0),
        description: "What machine.vmaster.index counts: 0, 1 the index pulses; 2, 3 the rising, falling edges of an input, whose number \
            is the tens digit.",
        source: "MACS-VM-07",
        note: "A-46: value 1 is missing in the text; it is taken as 0. The range in the overview has no end; an edge needs its input." }
};

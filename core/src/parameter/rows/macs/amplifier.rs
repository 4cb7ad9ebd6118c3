//! The loops of the amplifier (AXA).

use super::super::{Applies, BASE, Group, MLONG, Range, Row, System, Value};

const AMPLIFIER_ROW: Row = Row { system: System::Macs, group: Group::Amplifier, applies: Applies::Drive, ..BASE };

pub(in super::super) const ROWS: &[Row] = &[
    Row {
        key: "velkprop",
        mnemonic: "VELKPROP",
        number: "90",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(200),
        missing: "velocity and current loops",
        description: "Proportional gain of the velocity loop.",
        source: "MACS-AMP-04",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "velkint",
        mnemonic: "VELKINT",
        number: "91",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(5),
        missing: "velocity and current loops",
        description: "Integral gain of the velocity loop.",
        source: "MACS-AMP-04",
        note: "A-27: law and scale are not printed; an error of 1 at full speed is taken.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "curkprop",
        mnemonic: "CURKPROP",
        number: "92",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(200),
        missing: "velocity and current loops",
        description: "Proportional gain of the current loop.",
        source: "MACS-AMP-07",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "curkint",
        mnemonic: "CURKINT",
        number: "93",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(100),
        missing: "velocity and current loops",
        description: "Integral gain of the current loop.",
        source: "MACS-AMP-07",
        note: "D08: the detail calls it AXR; AXA is taken.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "ampmaxcur",
        mnemonic: "AMPMAXCUR",
        number: "94",
        unit: "mA",
        range: Range::Int(0, 60_000),
        default: Value::Int(2000),
        missing: "velocity and current loops",
        description: "Largest current of the motor, where there is a current loop (ampmode 0 and 2).",
        source: "MACS-AMP-08",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "ampcommtype",
        mnemonic: "AMPCOMMTYPE",
        number: "95",
        range: Range::Int(0, 6),
        default: Value::Int(0),
        missing: "velocity and current loops",
        description: "Motor: 0 none, 1 with brushes, 2, 3 brushless with hall sensors at 120 or 60 deg, 4, 5 stepper, 6 coupled amplifiers.",
        source: "MACS-AMP-09",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "amppwmfreq",
        mnemonic: "AMPPWMFREQ",
        number: "96",
        unit: "Hz",
        range: Range::Int(10_000, 50_000),
        default: Value::Int(24_000),
        missing: "velocity and current loops",
        description: "Frequency of the power stage; multiples of 8000 Hz are best.",
        source: "MACS-AMP-10",
        note: "D03: the name is AMPWMFREQ in the overview and one step is given in kHz; AMPPWMFREQ in Hz is taken.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "ampmode",
        mnemonic: "AMPMODE",
        number: "97",
        range: Range::Int(0, 3),
        default: Value::Int(0),
        missing: "velocity and current loops",
        description: "Loops below the position loop: 0 velocity and current, 1 velocity, 2 current, 3 none.",
        source: "MACS-AMP-01",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "velkilim",
        mnemonic: "VELKILIM",
        number: "103",
        range: Range::Int(0, 32_767),
        default: Value::Int(1000),
        missing: "velocity and current loops",
        description: "Bound of the sum of errors of the velocity loop, either way.",
        source: "MACS-AMP-05",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "curkilim",
        mnemonic: "CURKILIM",
        number: "104",
        range: Range::Int(0, 32_767),
        default: Value::Int(1000),
        missing: "velocity and current loops",
        description: "Bound of the sum of errors of the current loop, either way.",
        source: "MACS-AMP-05",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "i2tftime",
        mnemonic: "I2TFTIME",
        number: "117",
        unit: "ms",
        range: Range::Int(0, MLONG),
        default: Value::Int(0),
        missing: "velocity and current loops",
        description: "Time of the filter of the squared current; more than 0 watches it, 0 does not.",
        source: "MACS-I2T-01",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "i2tlimit",
        mnemonic: "I2TLIMIT",
        number: "118",
        unit: "A^2/1000",
        range: Range::Int(0, MLONG),
        default: Value::Int(0),
        missing: "velocity and current loops",
        description: "Filtered squared current beyond which error 99 comes.",
        source: "MACS-I2T-03",
        note: "A-29: 0 with a filter time is taken as it stands: any current is too much.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "curftime",
        mnemonic: "CURFTIME",
        number: "119",
        unit: "ms",
        range: Range::Int(0, MLONG),
        default: Value::Int(0),
        missing: "velocity and current loops",
        description: "Time of the filter of the current that is shown; 0 no filter.",
        source: "MACS-I2T-05",
        note: "D07: range and group are not given; 0 to MLONG ms in AXA is taken.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "ampencno",
        mnemonic: "AMPENCNO",
        number: "126",
        range: Range::Int(1, MLONG),
        default: Value::Int(-1),
        missing: "velocity and current loops",
        description: "Encoder of the velocity loop: -1 that of the position loop, else its number.",
        source: "MACS-AMP-06",
        note: "D01: the group is AXA in the overview and AXB in the detail; AXA is taken. The default lies outside the range.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "ampencres",
        mnemonic: "AMPENCRES",
        number: "127",
        unit: "inc/turn",
        range: Range::Int(1, MLONG),
        default: Value::Int(-1),
        missing: "velocity and current loops",
        description: "Increments of that encoder in one turn; -1: not set.",
        source: "MACS-AMP-06",
        note: "D01, D02: the group is AXA in the overview and AXB in the detail, AXA is taken; the default means not set and lies outside the range.",
        ..AMPLIFIER_ROW
    },
    Row {
        key: "ampencrpm",
        mnemonic: "AMPENCRPM",
        number: "128",
        unit: "rpm",
        range: Range::Int(1, 65_535),
        default: Value::Int(0),
        missing: "velocity and current loops",
        description: "Speed of that encoder that is full output; 0: not set, VELMAX.",
        source: "MACS-AMP-06",
        note: "D01, D02: the group is AXA in the overview and AXB in the detail, AXA is taken; the default means not set and lies outside the range.",
        ..AMPLIFIER_ROW
    },
];

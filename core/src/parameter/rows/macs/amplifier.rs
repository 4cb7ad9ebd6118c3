//! The loops of the amplifier (AXA).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value, int};
use crate::parameter::amplifier::MAX_CURRENT;

const AMPLIFIER_ROW: Row = Row { system: System::Macs, group: Group::Amplifier, applies: Applies::Drive, ..BASE };
/// Of the current loop that is closed here.
const VOLTAGE_ROW: Row = Row { applies: Applies::Voltage, ..AMPLIFIER_ROW };
/// Of the loops that are closed here.
const TORQUE_ROW: Row = Row { applies: Applies::Torque, ..AMPLIFIER_ROW };

pub(in super::super) const ROWS: &[Row] = &[
    Row {
        key: "velkprop",
        mnemonic: "VELKPROP",
        number: "90",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(200),
        description: "Proportional gain of the velocity loop.",
        source: "MACS-AMP-04",
        get: |p| Value::Int(p.amplifier.proportional),
        set: |p, v| p.amplifier.proportional = int(v).unwrap_or(p.amplifier.proportional),
        ..TORQUE_ROW
    },
    Row {
        key: "velkint",
        mnemonic: "VELKINT",
        number: "91",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(5),
        description: "Integral gain of the velocity loop.",
        source: "MACS-AMP-04",
        note: "A-27: law and scale are not printed; an error of 1 at full speed is taken.",
        get: |p| Value::Int(p.amplifier.integral),
        set: |p, v| p.amplifier.integral = int(v).unwrap_or(p.amplifier.integral),
        ..TORQUE_ROW
    },
    Row {
        key: "curkprop",
        mnemonic: "CURKPROP",
        number: "92",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(200),
        description: "Proportional gain of the current loop: parts of max_effort for each full_current of error, times 4096.",
        source: "MACS-AMP-07",
        get: |p| Value::Int(p.power_stage.proportional),
        set: |p, v| p.power_stage.proportional = int(v).unwrap_or(p.power_stage.proportional),
        ..VOLTAGE_ROW
    },
    Row {
        key: "curkint",
        mnemonic: "CURKINT",
        number: "93",
        range: Range::Int(-32_767, 32_767),
        default: Value::Int(100),
        description: "Integral gain of the current loop: parts of max_effort for each full_current and cycle of error, times 1024.",
        source: "MACS-AMP-07",
        note: "D08: the detail calls it AXR; AXA is taken.",
        get: |p| Value::Int(p.power_stage.integral),
        set: |p, v| p.power_stage.integral = int(v).unwrap_or(p.power_stage.integral),
        ..VOLTAGE_ROW
    },
    Row {
        key: "ampmaxcur",
        mnemonic: "AMPMAXCUR",
        number: "94",
        unit: "mA",
        range: Range::Int(0, 60_000),
        default: Value::Int(MAX_CURRENT),
        description: "Largest current of the motor, where there is a current loop (ampmode 0 and 2).",
        source: "MACS-AMP-08",
        get: |p| Value::Int(p.amplifier.max_current),
        set: |p, v| p.amplifier.max_current = int(v).unwrap_or(p.amplifier.max_current),
        ..TORQUE_ROW
    },
    Row {
        key: "ampcommtype",
        mnemonic: "AMPCOMMTYPE",
        number: "95",
        range: Range::Int(0, 6),
        default: Value::Int(0),
        description: "Motor: 0 nothing is commutated, 1 with brushes, which commutate by themselves. 2, 3 brushless with hall sensors at 120 or 60 deg, 4, 5 stepper and 6 coupled amplifiers are refused.",
        source: "MACS-AMP-09",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.power_stage.commutation),
        set: |p, v| p.power_stage.commutation = int(v).unwrap_or(p.power_stage.commutation),
        ..VOLTAGE_ROW
    },
    Row {
        key: "amppwmfreq",
        mnemonic: "AMPPWMFREQ",
        number: "96",
        unit: "Hz",
        range: Range::Int(10_000, 50_000),
        default: Value::Int(24_000),
        missing: "a power stage whose frequency is set here",
        description: "Frequency of the power stage: higher is quieter and loses more in switching; of a DC3 or DC6 multiples of 8000 Hz, 16000 to 48000.",
        source: "MACS-AMP-10",
        note: "D03: the name is AMPWMFREQ in the overview and one step is given in kHz; AMPPWMFREQ in Hz is taken.",
        ..VOLTAGE_ROW
    },
    Row {
        key: "ampmode",
        mnemonic: "AMPMODE",
        number: "97",
        range: Range::Int(0, 3),
        default: Value::Int(0),
        description: "Loops below the position loop: 0 velocity and current, 1 velocity, 2 current, 3 none.",
        source: "MACS-AMP-01",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.amplifier.mode),
        set: |p, v| p.amplifier.mode = int(v).unwrap_or(p.amplifier.mode),
        ..TORQUE_ROW
    },
    Row {
        key: "velkilim",
        mnemonic: "VELKILIM",
        number: "103",
        range: Range::Int(0, 32_767),
        default: Value::Int(1000),
        description: "Bound of the sum of errors of the velocity loop, either way.",
        source: "MACS-AMP-05",
        get: |p| Value::Int(p.amplifier.limit),
        set: |p, v| p.amplifier.limit = int(v).unwrap_or(p.amplifier.limit),
        ..TORQUE_ROW
    },
    Row {
        key: "curkilim",
        mnemonic: "CURKILIM",
        number: "104",
        range: Range::Int(0, 32_767),
        default: Value::Int(1000),
        description: "Bound of the sum of errors of the current loop, either way, in A and cycles; 0: no integral part.",
        source: "MACS-AMP-05",
        get: |p| Value::Int(p.power_stage.limit),
        set: |p, v| p.power_stage.limit = int(v).unwrap_or(p.power_stage.limit),
        ..VOLTAGE_ROW
    },
    Row {
        key: "i2tftime",
        mnemonic: "I2TFTIME",
        number: "117",
        unit: "ms",
        range: Range::Int(0, MLONG),
        default: Value::Int(0),
        description: "Time of the filter of the squared current; more than 0 watches it, 0 does not.",
        source: "MACS-I2T-01",
        get: |p| Value::Int(p.amplifier.heat_time),
        set: |p, v| p.amplifier.heat_time = int(v).unwrap_or(p.amplifier.heat_time),
        ..TORQUE_ROW
    },
    Row {
        key: "i2tlimit",
        mnemonic: "I2TLIMIT",
        number: "118",
        unit: "A^2/1000",
        range: Range::Int(0, MLONG),
        default: Value::Int(0),
        description: "Filtered squared current beyond which error 99 comes.",
        source: "MACS-I2T-03",
        note: "A-29: 0 with a filter time is taken as it stands: any current is too much.",
        get: |p| Value::Int(p.amplifier.heat_limit),
        set: |p, v| p.amplifier.heat_limit = int(v).unwrap_or(p.amplifier.heat_limit),
        ..TORQUE_ROW
    },
    Row {
        key: "curftime",
        mnemonic: "CURFTIME",
        number: "119",
        unit: "ms",
        range: Range::Int(0, MLONG),
        default: Value::Int(0),
        description: "Time of the filter of the current that is shown; 0 no filter.",
        source: "MACS-I2T-05",
        note: "D07: range and group are not given; 0 to MLONG ms in AXA is taken.",
        get: |p| Value::Int(p.amplifier.current_time),
        set: |p, v| p.amplifier.current_time = int(v).unwrap_or(p.amplifier.current_time),
        ..TORQUE_ROW
    },
    Row {
        key: "ampencno",
        mnemonic: "AMPENCNO",
        number: "126",
        range: Range::Int(1, MLONG),
        default: Value::Int(-1),
        description: "Encoder of the velocity loop: -1 that of the position loop, else that in the drive of the axis of this number.",
        source: "MACS-AMP-06",
        note: "D01: the group is AXA in the overview and AXB in the detail; AXA is taken. The default is outside the range. The axis' own number alone is taken.",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.amplifier.encoder.number),
        set: |p, v| p.amplifier.encoder.number = int(v).unwrap_or(p.amplifier.encoder.number),
        ..TORQUE_ROW
    },
    Row {
        key: "ampencres",
        mnemonic: "AMPENCRES",
        number: "127",
        unit: "inc/turn",
        range: Range::Int(1, MLONG),
        default: Value::Int(-1),
        description: "Increments of that encoder in one turn; -1: not set.",
        source: "MACS-AMP-06",
        note: "D01, D02: the group is AXA in the overview and AXB in the detail, AXA is taken; the default means not set and is outside the range.",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.amplifier.encoder.resolution),
        set: |p, v| p.amplifier.encoder.resolution = int(v).unwrap_or(p.amplifier.encoder.resolution),
        ..TORQUE_ROW
    },
    Row {
        key: "ampencrpm",
        mnemonic: "AMPENCRPM",
        number: "128",
        unit: "rpm",
        range: Range::Int(1, 65_535),
        default: Value::Int(0),
        description: "Speed of that encoder that is full output; 0: not set, VELMAX.",
        source: "MACS-AMP-06",
        note: "D01, D02: the group is AXA in the overview and AXB in the detail, AXA is taken; the default means not set and is outside the range.",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.amplifier.encoder.rpm),
        set: |p, v| p.amplifier.encoder.rpm = int(v).unwrap_or(p.amplifier.encoder.rpm),
        ..TORQUE_ROW
    },
];

//! The loops of the amplifier (AXA).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value};
use crate::parameter::amplifier::MAX_CURRENT;

const AMPLIFIER_ROW: Row = Row { system: System::Macs, group: Group::Amplifier, applies: Applies::Drive, ..BASE };
/// Of the current loop that is closed here.
const VOLTAGE_ROW: Row = Row { applies: Applies::Voltage, ..AMPLIFIER_ROW };
/// Of the loops that are closed here.
const TORQUE_ROW: Row = Row { applies: Applies::Torque, ..AMPLIFIER_ROW };

pub(in super::super) const ROWS: &[Row] = rows! {
    "velkprop": TORQUE_ROW, axis.amplifier.proportional {
        mnemonic: "VELKPROP", number: "90", range: Range::Int(-32_767, 32_767), default: Value::Int(200),
        description: "Proportional gain of the velocity loop.", source: "MACS-AMP-04" }
    "velkint": TORQUE_ROW, axis.amplifier.integral {
        mnemonic: "VELKINT", number: "91", range: Range::Int(-32_767, 32_767), default: Value::Int(5),
        description: "Integral gain of the velocity loop.", source: "MACS-AMP-04",
        note: "A-27: law and scale are not printed; an error of 1 at full speed is taken." }
    "curkprop": VOLTAGE_ROW, axis.power_stage.proportional {
        mnemonic: "CURKPROP", number: "92", range: Range::Int(-32_767, 32_767), default: Value::Int(200),
        description: "Proportional gain of the current loop: parts of max_effort for each full_current of error, times 4096.",
        source: "MACS-AMP-07" }
    "curkint": VOLTAGE_ROW, axis.power_stage.integral {
        mnemonic: "CURKINT", number: "93", range: Range::Int(-32_767, 32_767), default: Value::Int(100),
        description: "Integral gain of the current loop: parts of max_effort for each full_current and cycle of error, times 1024.",
        source: "MACS-AMP-07", note: "D08: the detail calls it AXR; AXA is taken." }
    "ampmaxcur": TORQUE_ROW, axis.amplifier.max_current {
        mnemonic: "AMPMAXCUR", number: "94", unit: "mA", range: Range::Int(0, 60_000), default: Value::Int(MAX_CURRENT),
        description: "Largest current of the motor, where there is a current loop (ampmode 0 and 2).", source: "MACS-AMP-08" }
    "ampcommtype": VOLTAGE_ROW, axis.power_stage.commutation {
        mnemonic: "AMPCOMMTYPE", number: "95", range: Range::Int(0, 6), default: Value::Int(0), effect: Effect::Disabled,
        description: "Motor: 0 nothing is commutated, 1 with brushes, which commutate by themselves. 2, 3 brushless with hall sensors at \
            120 or 60 deg, 4, 5 stepper and 6 coupled amplifiers are refused.",
        source: "MACS-AMP-09" }
    "amppwmfreq": VOLTAGE_ROW {
        mnemonic: "AMPPWMFREQ", number: "96", unit: "Hz", range: Range::Int(10_000, 50_000), default: Value::Int(24_000),
        missing: "a power stage whose frequency is set here",
        description: "Frequency of the power stage: higher is quieter and loses more in switching; of a DC3 or DC6 multiples of 8000 Hz, \
            16000 to 48000.",
        source: "MACS-AMP-10", note: "D03: the name is AMPWMFREQ in the overview and one step is given in kHz; AMPPWMFREQ in Hz is taken." }
    "ampmode": TORQUE_ROW, axis.amplifier.mode {
        mnemonic: "AMPMODE", number: "97", range: Range::Int(0, 3), default: Value::Int(0), effect: Effect::Disabled,
        description: "Loops below the position loop: 0 velocity and current, 1 velocity, 2 current, 3 none.", source: "MACS-AMP-01" }
    "velkilim": TORQUE_ROW, axis.amplifier.limit {
        mnemonic: "VELKILIM", number: "103", range: Range::Int(0, 32_767), default: Value::Int(1000),
        description: "Bound of the sum of errors of the velocity loop, either way.", source: "MACS-AMP-05" }
    "curkilim": VOLTAGE_ROW, axis.power_stage.limit {
        mnemonic: "CURKILIM", number: "104", range: Range::Int(0, 32_767), default: Value::Int(1000),
        description: "Bound of the sum of errors of the current loop, either way, in A and cycles; 0: no integral part.",
        source: "MACS-AMP-05" }
    "i2tftime": TORQUE_ROW, axis.amplifier.heat_time {
        mnemonic: "I2TFTIME", number: "117", unit: "ms", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Time of the filter of the squared current; more than 0 watches it, 0 does not.", source: "MACS-I2T-01" }
    "i2tlimit": TORQUE_ROW, axis.amplifier.heat_limit {
        mnemonic: "I2TLIMIT", number: "118", unit: "A^2/1000", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Filtered squared current beyond which error 99 comes.", source: "MACS-I2T-03",
        note: "A-29: 0 with a filter time is taken as it stands: any current is too much." }
    "curftime": TORQUE_ROW, axis.amplifier.current_time {
        mnemonic: "CURFTIME", number: "119", unit: "ms", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Time of the filter of the current that is shown; 0 no filter.", source: "MACS-I2T-05",
        note: "D07: range and group are not given; 0 to MLONG ms in AXA is taken." }
    "ampencno": TORQUE_ROW, axis.amplifier.encoder.number {
        mnemonic: "AMPENCNO", number: "126", range: Range::Int(1, MLONG), default: Value::Int(-1), effect: Effect::Disabled,
        full_cycles: Some(|p| p.has_velocity_encoder()),
        description: "Encoder of the velocity loop: -1 that of the position loop, else that in the drive of the axis of this number.",
        source: "MACS-AMP-06",
        note: "D01: the group is AXA in the overview and AXB in the detail; AXA is taken. The default is outside the range. The axis' own \
            number alone is taken." }
    "ampencres": TORQUE_ROW, axis.amplifier.encoder.resolution {
        mnemonic: "AMPENCRES", number: "127", unit: "inc/turn", range: Range::Int(1, MLONG), default: Value::Int(-1),
        effect: Effect::Disabled,
        description: "Increments of that encoder in one turn; -1: not set.", source: "MACS-AMP-06",
        note: "D01, D02: the group is AXA in the overview and AXB in the detail, AXA is taken; the default means not set and is outside \
            the range." }
    "ampencrpm": TORQUE_ROW, axis.amplifier.encoder.rpm {
        mnemonic: "AMPENCRPM", number: "128", unit: "rpm", range: Range::Int(1, 65_535), default: Value::Int(0), effect: Effect::Disabled,
        description: "Speed of that encoder that is full output; 0: not set, VELMAX.", source: "MACS-AMP-06",
        note: "D01, D02: the group is AXA in the overview and AXB in the detail, AXA is taken; the default means not set and is outside \
            the range." }
};

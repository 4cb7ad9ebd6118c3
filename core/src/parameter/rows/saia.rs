//! Parameters of the SAIA PCD4.H3 servo module (spec/saia-h3.md): its input registers, in the module's own units, and the
//! options of this implementation.
//!
//! A register holds any 32 bits, as on the module; the command that reads it checks what it takes (SAIA-DET-02, SAIA-HND-04).

use super::super::saia::COMMAND_ERRORS;
use super::{BASE, Bare, Effect, Group, Measure, Range, Row, Storage, System, Value};

const WORD: Range = Range::Int(i32::MIN as i64, i32::MAX as i64);
const SWITCH: &[&str] = &["false", "true"];

/// A register of 32 bits.
const REGISTER: Row = Row {
    system: System::Saia,
    group: Group::Registers,
    range: WORD,
    bare: Bare::AxisUnit,
    default: Value::Int(0),
    effect: Effect::NextSaiaCommand,
    by_axis: true,
    ..BASE
};
/// A register that the module fills: a signal here.
const SHOWN: Row = Row {
    default: Value::Unset,
    default_text: "what the command reads",
    effect: Effect::AtOnce,
    by_axis: false,
    ..REGISTER
};
/// An option that is off or on.
const OPTION: Row = Row {
    system: System::Saia,
    group: Group::Registers,
    measure: Measure::Choice(SWITCH),
    range: Range::Int(0, 1),
    bare: Bare::AxisUnit,
    default: Value::Int(0),
    ..BASE
};

pub(super) const ROWS: &[Row] = rows! {
    "saia.kprop": REGISTER, axis.vocabularies.saia.kprop {
        mnemonic: "KProp", number: "0",
        description: "Proportional factor, 0 to 32767, for fldrp.", source: "SAIA-REG-00" }
    "saia.kint": REGISTER, axis.vocabularies.saia.kint {
        mnemonic: "KInt", number: "1",
        description: "Integral factor, 0 to 32767, for fldrp.", source: "SAIA-REG-01" }
    "saia.kder": REGISTER, axis.vocabularies.saia.kder {
        mnemonic: "KDer", number: "2",
        description: "Derivative factor, 0 to 32767, for fldrp.", source: "SAIA-REG-02" }
    "saia.intl": REGISTER, axis.vocabularies.saia.intl {
        mnemonic: "IntL", number: "3",
        description: "Limit of the integral part, 0 to 32767, for fldrp.", source: "SAIA-REG-03" }
    "saia.sampi": REGISTER, axis.vocabularies.saia.sampi {
        mnemonic: "SampI", number: "4",
        description: "Derivative sampling code n, 0 to 255, for fldrp: every n + 1 samples of 341.33 us.", source: "SAIA-REG-04" }
    "saia.mcfac": REGISTER, axis.vocabularies.saia.mcfac {
        mnemonic: "MCFac", number: "5", measure: Measure::Number, unit: "counts/unit", range: Range::Real(0.0, 9.223_371e18),
        default: Value::Real(1.0),
        description: "Motion control factor: counts per unit of destp, brkp, veloc, accel and of what is read.", source: "SAIA-REG-05" }
    "saia.poser": REGISTER, axis.vocabularies.saia.poser {
        mnemonic: "PosEr", number: "6", unit: "counts", default: Value::Int(32_767),
        description: "Largest position error [counts], 0 to 32767, for fsetpe.", source: "SAIA-REG-06" }
    "saia.destp": REGISTER, axis.vocabularies.saia.destp {
        mnemonic: "DestP", number: "7", unit: "units",
        description: "Destination [units], for fldda and flddr.", source: "SAIA-REG-07" }
    "saia.brkp": REGISTER, axis.vocabularies.saia.brkp {
        mnemonic: "BrkP", number: "8", unit: "units",
        description: "Break position [units], for fldbpa and fldbpr.", source: "SAIA-REG-08" }
    "saia.veloc": REGISTER, axis.vocabularies.saia.veloc {
        mnemonic: "Veloc", number: "9", unit: "units/s",
        description: "Velocity [units/s], for fldva and fldvr.", source: "SAIA-REG-09" }
    "saia.accel": REGISTER, axis.vocabularies.saia.accel {
        mnemonic: "Accel", number: "10", unit: "units/s^2", default: Value::Unset, default_text: "as default_acceleration",
        description: "Acceleration [units/s^2], for fldaa and fldar; one left out is cut to the velocity register of the start.",
        source: "SAIA-REG-10" }
    "saia.stafrr": REGISTER, axis.vocabularies.saia.stafrr {
        mnemonic: "StaFRR", number: "11",
        description: "Status flags that fressf keeps: bits 2 to 6 for OnDest, IPuls, WrapOc, ExcPEr, BrkPos; 0 clears.",
        source: "SAIA-REG-11" }
    "saia.mcw": REGISTER, axis.vocabularies.saia.mcw {
        mnemonic: "MCW", number: "12", default: Value::Int(0x41B),
        description: "Motion control word: bits 0 to 7 reaction to position errors (1BH, 1AH), 8 to 10 stop, 11 velocity control, 12 \
            forward.",
        source: "SAIA-REG-12" }
    "saia.ractp": SHOWN {
        mnemonic: "RActP", number: "13", unit: "units", storage: Storage::Signal("saia.ractp"),
        description: "Actual position, as frdap last read it.", source: "SAIA-REG-13" }
    "saia.rsetp": SHOWN {
        mnemonic: "RSetP", number: "14", unit: "units", storage: Storage::Signal("saia.rsetp"),
        description: "Position that the profile asks for, as frdsp last read it.", source: "SAIA-REG-14" }
    "saia.ractv": SHOWN {
        mnemonic: "RActV", number: "15", unit: "units/s", storage: Storage::Signal("saia.ractv"),
        description: "Actual velocity, as frdav last read it.", source: "SAIA-REG-15" }
    "saia.rsetv": SHOWN {
        mnemonic: "RSetV", number: "16", unit: "units/s", storage: Storage::Signal("saia.rsetv"),
        description: "Velocity that the profile asks for, as frdsv last read it.", source: "SAIA-REG-16" }
    "saia.rindp": SHOWN {
        mnemonic: "RIndP", number: "17", unit: "units", storage: Storage::Signal("saia.rindp"),
        description: "Position at the last index that was caught, as frdip last read it.", source: "SAIA-REG-17" }
    "saia.rintts": SHOWN {
        mnemonic: "RIntTS", number: "18", storage: Storage::Signal("saia.rintts"),
        description: "Integral part of the regulator, as frdits last read it.", source: "SAIA-REG-18",
        note: "The name is RIntS on one page; RIntTS is taken." }
    "saia.rsigb": SHOWN {
        mnemonic: "RSigB", number: "19", storage: Storage::Signal("saia.rsigb"),
        description: "Signal register, 16 bits, as frdsr last read it.", source: "SAIA-REG-19" }
    "saia.imode": REGISTER, axis.vocabularies.saia.imode {
        range: Range::Int(5, 6), default: Value::Int(6), by_axis: false,
        description: "Output that axinit chooses: 6 analogue of 12 bit, 5 PWM of 8 bit.", source: "SAIA-INI-02" }
    "saia.legacy_scaling": OPTION, axis.vocabularies.saia.legacy_scaling {
        description: "Convert velocities and accelerations with the printed 22.348 and 7.6206e-3 instead of the exact sample time.",
        source: "SAIA-SCL-04, SAIA-SCL-05" }
    "saia.clamp_sum": OPTION, axis.vocabularies.saia.clamp_sum {
        description: "The sum of the integral part stops growing where that reaches intl.", source: "SAIA-PID-03" }
    "saia.chip_integral": OPTION, axis.vocabularies.saia.chip_integral {
        description: "The integral factor sees the top 16 of 24 bits of the sum.", source: "SAIA-EXT-04" }
    "saia.output_gain": OPTION, axis.vocabularies.saia.output_gain {
        measure: Measure::Number, range: Range::PositiveUpTo(1e6), default: Value::Real(1.0),
        description: "Factor between the regulator and saia.output.", source: "SAIA-EXT-06" }
    "saia.command_error": OPTION, axis.vocabularies.saia.command_error {
        measure: Measure::Choice(COMMAND_ERRORS), range: Range::Int(0, 2),
        description: "What a command error does: refuse the verb; log_only, the command alone is left out; motor_off, that and an error of \
            the axis.",
        source: "SAIA-ERR-04" }
};

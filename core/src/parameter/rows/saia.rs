//! Parameters of the SAIA PCD4.H3 servo module (spec/saia-h3.md): its input registers, in the module's own units, and the
//! options of this implementation.
//!
//! A register holds any 32 bits, as on the module; the command that reads it checks what it takes (SAIA-DET-02, SAIA-HND-04).

use super::super::saia::{COMMAND_ERRORS, Parameters};
use super::{BASE, Bare, Effect, Group, Measure, Range, Row, Storage, System, Value, int, real};

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
    ..BASE
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

fn word(value: Value) -> Option<i32> {
    int(value).and_then(|value| i32::try_from(value).ok())
}

macro_rules! register {
    ($name:ident, $key:literal, $mnemonic:literal, $number:literal, $default:literal, $source:literal, $description:literal) => {
        Row {
            key: $key,
            mnemonic: $mnemonic,
            number: $number,
            default: Value::Int($default),
            description: $description,
            source: $source,
            get: |p| Value::Int(p.vocabularies.saia.$name.into()),
            set: |p, v| p.vocabularies.saia.$name = word(v).unwrap_or(p.vocabularies.saia.$name),
            ..REGISTER
        }
    };
}

/// A register that the module fills: a signal here.
macro_rules! shown {
    ($key:literal, $mnemonic:literal, $number:literal, $unit:literal, $signal:literal, $source:literal, $description:literal) => {
        Row {
            key: $key,
            mnemonic: $mnemonic,
            number: $number,
            unit: $unit,
            default: Value::Unset,
            default_text: "what the command reads",
            storage: Storage::Signal($signal),
            effect: Effect::AtOnce,
            description: $description,
            source: $source,
            ..REGISTER
        }
    };
}

macro_rules! option {
    ($name:ident, $key:literal, $source:literal, $description:literal) => {
        Row {
            key: $key,
            description: $description,
            source: $source,
            get: |p| Value::Int(p.vocabularies.saia.$name.into()),
            set: |p, v| p.vocabularies.saia.$name = int(v) == Some(1),
            ..OPTION
        }
    };
}

fn saia(p: &super::super::AxisParameters) -> &Parameters {
    &p.vocabularies.saia
}

pub(super) const ROWS: &[Row] = &[
    register!(kprop, "saia.kprop", "KProp", "0", 0, "SAIA-REG-00", "Proportional factor, 0 to 32767, for fldrp."),
    register!(kint, "saia.kint", "KInt", "1", 0, "SAIA-REG-01", "Integral factor, 0 to 32767, for fldrp."),
    register!(kder, "saia.kder", "KDer", "2", 0, "SAIA-REG-02", "Derivative factor, 0 to 32767, for fldrp."),
    register!(intl, "saia.intl", "IntL", "3", 0, "SAIA-REG-03", "Limit of the integral part, 0 to 32767, for fldrp."),
    register!(
        sampi,
        "saia.sampi",
        "SampI",
        "4",
        0,
        "SAIA-REG-04",
        "Derivative sampling code n, 0 to 255, for fldrp: every n + 1 samples of 341.33 us."
    ),
    Row {
        key: "saia.mcfac",
        mnemonic: "MCFac",
        number: "5",
        unit: "counts/unit",
        measure: Measure::Number,
        range: Range::Real(0.0, 9.223_371e18),
        default: Value::Real(1.0),
        description: "Motion control factor: counts per unit of destp, brkp, veloc, accel and of what is read.",
        source: "SAIA-REG-05",
        get: |p| Value::Real(saia(p).mcfac),
        set: |p, v| p.vocabularies.saia.mcfac = real(v).unwrap_or(p.vocabularies.saia.mcfac),
        ..REGISTER
    },
    Row {
        unit: "counts",
        ..register!(
            poser,
            "saia.poser",
            "PosEr",
            "6",
            32_767,
            "SAIA-REG-06",
            "Largest position error [counts], 0 to 32767, for fsetpe."
        )
    },
    Row {
        unit: "units",
        ..register!(destp, "saia.destp", "DestP", "7", 0, "SAIA-REG-07", "Destination [units], for fldda and flddr.")
    },
    Row {
        unit: "units",
        ..register!(brkp, "saia.brkp", "BrkP", "8", 0, "SAIA-REG-08", "Break position [units], for fldbpa and fldbpr.")
    },
    Row {
        unit: "units/s",
        ..register!(veloc, "saia.veloc", "Veloc", "9", 0, "SAIA-REG-09", "Velocity [units/s], for fldva and fldvr.")
    },
    Row {
        key: "saia.accel",
        mnemonic: "Accel",
        number: "10",
        unit: "units/s^2",
        default: Value::Unset,
        default_text: "as default_acceleration",
        description: "Acceleration [units/s^2], for fldaa and fldar; one left out is cut to the velocity register of the start.",
        source: "SAIA-REG-10",
        get: |p| saia(p).accel.map_or(Value::Unset, |accel| Value::Int(accel.into())),
        set: |p, v| p.vocabularies.saia.accel = word(v),
        ..REGISTER
    },
    register!(
        stafrr,
        "saia.stafrr",
        "StaFRR",
        "11",
        0,
        "SAIA-REG-11",
        "Status flags that fressf keeps: bits 2 to 6 for OnDest, IPuls, WrapOc, ExcPEr, BrkPos; 0 clears."
    ),
    register!(
        mcw,
        "saia.mcw",
        "MCW",
        "12",
        0x41B,
        "SAIA-REG-12",
        "Motion control word: bits 0 to 7 reaction to position errors (1BH, 1AH), 8 to 10 stop, 11 velocity control, 12 forward."
    ),
    shown!(
        "saia.ractp",
        "RActP",
        "13",
        "units",
        "saia.ractp",
        "SAIA-REG-13",
        "Actual position, as frdap last read it."
    ),
    shown!(
        "saia.rsetp",
        "RSetP",
        "14",
        "units",
        "saia.rsetp",
        "SAIA-REG-14",
        "Position that the profile asks for, as frdsp last read it."
    ),
    shown!(
        "saia.ractv",
        "RActV",
        "15",
        "units/s",
        "saia.ractv",
        "SAIA-REG-15",
        "Actual velocity, as frdav last read it."
    ),
    shown!(
        "saia.rsetv",
        "RSetV",
        "16",
        "units/s",
        "saia.rsetv",
        "SAIA-REG-16",
        "Velocity that the profile asks for, as frdsv last read it."
    ),
    shown!(
        "saia.rindp",
        "RIndP",
        "17",
        "units",
        "saia.rindp",
        "SAIA-REG-17",
        "Position at the last index that was caught, as frdip last read it."
    ),
    Row {
        note: "The name is RIntS on one page; RIntTS is taken.",
        ..shown!(
            "saia.rintts",
            "RIntTS",
            "18",
            "",
            "saia.rintts",
            "SAIA-REG-18",
            "Integral part of the regulator, as frdits last read it."
        )
    },
    shown!(
        "saia.rsigb",
        "RSigB",
        "19",
        "",
        "saia.rsigb",
        "SAIA-REG-19",
        "Signal register, 16 bits, as frdsr last read it."
    ),
    Row {
        key: "saia.imode",
        range: Range::Int(5, 6),
        default: Value::Int(6),
        description: "Output that axinit chooses: 6 analogue of 12 bit, 5 PWM of 8 bit.",
        source: "SAIA-INI-02",
        get: |p| Value::Int(saia(p).imode),
        set: |p, v| p.vocabularies.saia.imode = int(v).unwrap_or(p.vocabularies.saia.imode),
        ..REGISTER
    },
    option!(
        legacy_scaling,
        "saia.legacy_scaling",
        "SAIA-SCL-04, SAIA-SCL-05",
        "Convert velocities and accelerations with the printed 22.348 and 7.6206e-3 instead of the exact sample time."
    ),
    option!(
        clamp_sum,
        "saia.clamp_sum",
        "SAIA-PID-03",
        "The sum of the integral part stops growing where that reaches intl."
    ),
    option!(
        chip_integral,
        "saia.chip_integral",
        "SAIA-EXT-04",
        "The integral factor sees the top 16 of 24 bits of the sum."
    ),
    Row {
        key: "saia.output_gain",
        measure: Measure::Number,
        range: Range::PositiveUpTo(1e6),
        default: Value::Real(1.0),
        description: "Factor between the regulator and saia.output.",
        source: "SAIA-EXT-06",
        get: |p| Value::Real(saia(p).output_gain),
        set: |p, v| p.vocabularies.saia.output_gain = real(v).unwrap_or(p.vocabularies.saia.output_gain),
        ..OPTION
    },
    Row {
        key: "saia.command_error",
        measure: Measure::Choice(COMMAND_ERRORS),
        range: Range::Int(0, 2),
        description: "What a command error does: refuse the verb; log_only, the command alone is left out; motor_off, that and an error of the axis.",
        source: "SAIA-ERR-04",
        get: |p| Value::Int(saia(p).command_error),
        set: |p, v| p.vocabularies.saia.command_error = int(v).unwrap_or(p.vocabularies.saia.command_error),
        ..OPTION
    },
];

//! Encoders and user units (AXE).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, Storage, System, Value, int};

const ENCODER_ROW: Row = Row { system: System::Macs, group: Group::Encoder, applies: Applies::Drive, ..BASE };

pub(in super::super) const ROWS: &[Row] = rows! {
    "encoder": ENCODER_ROW, axis.macs.encoder {
        mnemonic: "ENCODER", number: "2", unit: "counts/rev", range: Range::Int(1, MLONG), default: Value::Int(500),
        effect: Effect::NextMotion, applies: Applies::Any,
        description: "Lines of the encoder in one revolution, of which each is 4 increments; of an absolute encoder its steps, each 1 \
            increment. It is what velmax and a revolution refer to. With encodertype 1 to 4 it is also how many steps the encoder has, \
            where feedback does not say that: then it changes only while the axis is disabled.",
        source: "MACS-ENC-01, MACS-PROF-02" }
    "posfact_z": ENCODER_ROW {
        mnemonic: "POSFACT_Z", number: "23", range: Range::Int(1, MLONG), default: Value::Int(1000), storage: Storage::Cell,
        effect: Effect::Start, applies: Applies::Any,
        get: |p| p.macs.scale.map_or(Value::Unset, |scale| Value::Int(scale.posfact_z)),
        description: "User factor, numerator: posfact_z / posfact_n increments are one axis unit. In a cell it replaces scale.",
        source: "MACS-UNIT-02", note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "posfact_n": ENCODER_ROW {
        mnemonic: "POSFACT_N", number: "26", range: Range::Int(1, MLONG), default: Value::Int(1000), storage: Storage::Cell,
        effect: Effect::Start, applies: Applies::Any,
        get: |p| p.macs.scale.map_or(Value::Unset, |scale| Value::Int(scale.posfact_n)),
        description: "User factor, denominator; see posfact_z.", source: "MACS-UNIT-02",
        note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "feedrev": ENCODER_ROW {
        mnemonic: "FEEDREV", number: "113", range: Range::Int(1, MLONG), default: Value::Int(1), storage: Storage::Cell,
        effect: Effect::Start, applies: Applies::Any,
        get: |p| p.macs.scale.map_or(Value::Unset, |scale| Value::Int(scale.feedrev)),
        description: "Feed constant, revolutions: multiplies posfact_z.", source: "MACS-UNIT-01",
        note: "D21: the unit is qc in the overview; a factor without a unit is taken." }
    "feeddist": ENCODER_ROW {
        mnemonic: "FEEDDIST", number: "112", range: Range::Int(1, MLONG), default: Value::Int(1), storage: Storage::Cell,
        effect: Effect::Start, applies: Applies::Any,
        get: |p| p.macs.scale.map_or(Value::Unset, |scale| Value::Int(scale.feeddist)),
        description: "Feed constant, distance: multiplies posfact_n.", source: "MACS-UNIT-01" }
    "posencqc": ENCODER_ROW {
        mnemonic: "POSENCQC", number: "114", range: Range::Int(1, MLONG), default: Value::Int(1), storage: Storage::Cell,
        effect: Effect::Start, applies: Applies::Any,
        get: |p| p.macs.scale.map_or(Value::Unset, |scale| Value::Int(scale.posencqc)),
        description: "Resolution of the encoder, increments: multiplies posfact_z.", source: "MACS-UNIT-01",
        note: "D22: the name is POSENCOC or without a group in places; POSENCQC in AXE is taken." }
    "posencrev": ENCODER_ROW {
        mnemonic: "POSENCREV", number: "115", range: Range::Int(1, MLONG), default: Value::Int(1), storage: Storage::Cell,
        effect: Effect::Start, applies: Applies::Any,
        get: |p| p.macs.scale.map_or(Value::Unset, |scale| Value::Int(scale.posencrev)),
        description: "Resolution of the encoder, revolutions: multiplies posfact_n.", source: "MACS-UNIT-01",
        note: "D22: the name is POSENCOC or without a group in places; POSENCQC in AXE is taken." }
    "encodertype": ENCODER_ROW, axis.encoder.encodertype {
        mnemonic: "ENCODERTYPE", number: "27", range: Range::Int(-MLONG, MLONG), default: Value::Int(0), effect: Effect::Disabled,
        description: "Where the position comes from: 0 incremental, 1 to 4 absolute, 5 sine and cosine, 9 simulated, 10, 20, 30 a \
            terminal, beyond 1000 a node of a bus, negative without guarding. Setting it clears the flags of the index.",
        source: "MACS-ENC-04" }
    "mencoder": ENCODER_ROW, axis.macs.mencoder {
        mnemonic: "MENCODER", number: "30", unit: "counts/rev", range: Range::Int(-MLONG, MLONG), default: Value::Int(500),
        description: "Lines of the master's encoder in one revolution; negative: master.position and master.velocity are in master units, \
            syncfacts / syncfactm of an increment.",
        source: "MACS-UNIT-09" }
    "mencodertype": ENCODER_ROW, axis.encoder.mencodertype {
        mnemonic: "MENCODERTYPE", number: "67", range: Range::Int(-MLONG, MLONG), default: Value::Int(0), effect: Effect::Disabled,
        description: "The master of a synchronize that names none: -1 to -999 the command of that axis, in the order of the cell, 10, 20, \
            30 the first, second, third entry of encoders, 6 a simulated one (master_simulation_velocity), 0, 1, 2, 5 none, as no encoder \
            is wired to an axis as that of its master; beyond 1000 a node of a bus.",
        source: "MACS-ENC-14",
        note: "A-13: the number of an axis is missing in the text; -1 to -999 are taken, beyond -1000 a bus without guarding." }
    "encoderclock": ENCODER_ROW {
        mnemonic: "ENCODERCLOCK", number: "73", range: Range::Int(0, 1), default: Value::Int(1),
        missing: "a serial interface whose clock could be left to another one",
        description: "Clock of a serial absolute encoder: 1 made here, 0 made by another master.", source: "MACS-ENC-09" }
    "encoderfreq": ENCODER_ROW, axis.encoder.encoderfreq {
        mnemonic: "ENCODERFREQ", number: "74", unit: "Hz", range: Range::Int(1, MLONG), default: Value::Int(262_000),
        effect: Effect::Disabled,
        description: "With encodertype 9 the distance of simulated marks (inc), any above 0. Else the clock rate of a serial absolute \
            encoder, 39000 to 5000000: kept for the interface that makes the clock; the simulation has none.",
        source: "MACS-ENC-09, MACS-ENC-13", note: "A-12: the unit is printed as kHz; the values are Hz, which is taken." }
    "mencoderclock": ENCODER_ROW {
        mnemonic: "MENCODERCLOCK", number: "77", range: Range::Int(0, 1), default: Value::Int(1),
        missing: "a serial interface whose clock could be left to another one",
        description: "As encoderclock, for the master's encoder.", source: "MACS-ENC-09" }
    "enccontrol": ENCODER_ROW, axis.encoder.enccontrol {
        mnemonic: "ENCCONTROL", number: "107", range: Range::Int(0, 3), default: Value::Int(0),
        description: "Bit 0: a change of the source keeps the position; bit 1: a new origin is one of this axis alone, and the encoder \
            keeps its value.",
        source: "MACS-ENC-11" }
    "menccontrol": ENCODER_ROW, axis.encoder.menccontrol {
        mnemonic: "MENCCONTROL", number: "108", range: Range::Int(0, 3), default: Value::Int(0),
        description: "Bit 0: a change of the master keeps master.position; bit 1: a new origin of a master that is an encoder \
            (set_position of x.master) is one of this axis alone, and the encoder keeps its value.",
        source: "MACS-ENC-11, MACS-CMD-17" }
};

/// Before all others: what limits of a set mean depends on it.
pub(in super::super) const SENSE: &[Row] = rows! {
    "posdrct": ENCODER_ROW {
        mnemonic: "POSDRCT", number: "28", range: Range::Among(&[(-22, -21), (-12, -11), (-2, -1), (1, 2), (11, 12), (21, 22)]),
        default: Value::Int(1), effect: Effect::Disabled,
        get: |p| Value::Int(p.macs.posdrct), set: |p, v| p.set_posdrct(int(v).unwrap_or(p.macs.posdrct)),
        description: "Direction of rotation: a minus sign inverts the axis' units, ones digit 2 the output of its position loop, tens \
            digit 2 its velocity loop; one digit is for both. The places that limits guard stay where they are.",
        source: "MACS-DIR-01, MACS-DIR-02, MACS-DIR-03",
        note: "A-07: two entries of the table are damaged; 1 and -1 are taken. Digits that differ need an encoder of the velocity loop \
            (ampencno); 2 with interface position would turn over a loop that the drive closes: refused." }
};

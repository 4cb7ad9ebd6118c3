//! Parameters of the Siemens WF 725 / 726 positioning modules (spec/wf725.md); a bare number is in the axis unit.

use super::{Applies, BASE, Bare, Effect, Group, HOUR_NS, Measure, POSITION, REAL, Range, Row, System, Value, real};

/// What a module keeps in one word.
const WORD: Range = Range::Int(0, i32::MAX as i64);
/// Two decimal digits (WF-DAC-02).
const BCD: Range = Range::Int(0, 99);
const DISTANCE: Range = Range::Int(0, (1 << 62) - 1);
/// Parts of `max_velocity` in hundredths.
const SPEED: Range = Range::Real(0.0, 100.0);

const UNIT: Row = Row { system: System::Wf, group: Group::MachineData, bare: Bare::AxisUnit, ..BASE };
const RATE: Row = Row {
    measure: Measure::Acceleration,
    range: REAL,
    effect: Effect::NextMotion,
    source: "WF-MD-01, WF-MD-02, WF-CLC-01",
    ..UNIT
};
const STEP_SPEED: Row = Row {
    measure: Measure::Integer,
    range: BCD,
    unit: "%",
    default: Value::Int(0),
    applies: Applies::OpenLoop,
    source: "WF-MD-19, WF-OLC-07",
    ..UNIT
};
const STEP_DISTANCE: Row = Row {
    applies: Applies::OpenLoop,
    measure: Measure::Distance,
    range: DISTANCE,
    default: Value::Int(0),
    source: "WF-MD-20, WF-OLC-07, W06",
    ..UNIT
};
const FIXED_SPEED: Row = Row {
    measure: Measure::Number,
    unit: "%",
    range: SPEED,
    default: Value::Real(0.0),
    effect: Effect::NextMotion,
    source: "WF-MD-22, WF-SET-02",
    ..UNIT
};
const OFFSET: Row = Row {
    measure: Measure::Position,
    range: POSITION,
    default: Value::Int(0),
    effect: Effect::NextMotion,
    source: "WF-CRD-02, WF-CRD-03",
    ..UNIT
};

const ENCODERS: &[&str] = &["incremental", "absolute"];
const CAMS: &[&str] = &["interface", "fast_input"];

pub(super) const ROWS: &[Row] = rows! {
    "wf.md1": RATE, axis.vocabularies.wf.md1 {
        mnemonic: "MD1", number: "1", default_text: "as max_acceleration",
        description: "Acceleration of blocks and of setup in closed loop; not above max_acceleration." }
    "wf.md2": RATE, axis.vocabularies.wf.md2 {
        mnemonic: "MD2", number: "2", default_text: "as max_deceleration",
        description: "Deceleration of blocks and of setup in closed loop; not above max_deceleration." }
    "wf.md4": UNIT, axis.encoder.kind {
        mnemonic: "MD4", number: "4", measure: Measure::Choice(ENCODERS), range: Range::Int(0, 1), default: Value::Int(0),
        effect: Effect::Disabled, applies: Applies::Drive,
        description: "Kind of encoder: absolute ones have a word of wf.md5 steps in Gray code and begin again after the last one.",
        source: "WF-MD-03" }
    "wf.md5": UNIT, axis.encoder.steps {
        mnemonic: "MD5", number: "5", unit: "steps", range: Range::Int(1, i32::MAX as i64), default: Value::Int(16384),
        effect: Effect::Disabled, applies: Applies::Drive,
        description: "Steps of an absolute encoder: those of a revolution times its revolutions.", source: "WF-MD-04, WF-ABS-02" }
    "wf.md7": UNIT, axis.encoder.side_or_omitted {
        mnemonic: "MD7", number: "7", range: WORD, default: Value::Int(0), effect: Effect::Disabled, applies: Applies::Drive,
        description: "Incremental encoder: side of the cam on which homing ends: 0 the one that JOG leads to, 1 plus, 2 minus; for the \
            side that it comes from the axis turns round on the cam. Absolute encoder: steps that are left out, the value of its first \
            word.",
        source: "WF-MD-05, WF-REF-02",
        note: "W04: it means another thing with each kind of encoder; the row is both. The numbers of the sides are not told: these are \
            taken." }
    "wf.md15": UNIT, axis.homing.cam_source {
        mnemonic: "MD15", number: "15", measure: Measure::Choice(CAMS), range: Range::Int(0, 1), default: Value::Int(1),
        effect: Effect::NextHoming, applies: Applies::Drive,
        description: "Where the cam of homing comes from: the key cam of verb wf, or the reference switch (i_refswitch, or that of the \
            drive).",
        source: "WF-MD-08, WF-REF-04", note: "The usual value is not told: fast_input is taken." }
    "wf.md16": UNIT, axis.encoder.reference_or_parity {
        mnemonic: "MD16", number: "16", measure: Measure::Position, default: Value::Int(0), effect: Effect::Disabled,
        applies: Applies::Drive,
        description: "Incremental encoder: position of the reference point; absolute encoder: parity of its word, 0 none, 1 inc even, 2 \
            inc odd.",
        source: "WF-MD-09, WF-ABS-04, WF-REF-02, WF-REF-03",
        note: "W04: it means another thing with each kind of encoder; the row is both. The numbers of the parity are not told: these are \
            taken." }
    "wf.md17": UNIT, axis.vocabularies.wf.md17 {
        mnemonic: "MD17", number: "17", measure: Measure::Position, default: Value::Int(0), effect: Effect::NextHoming,
        applies: Applies::Drive,
        description: "Way from the zero mark to the reference point; without effect in open loop.",
        source: "WF-MD-10, WF-REF-01, WF-REF-03" }
    "wf.md21": UNIT {
        mnemonic: "MD21", number: "21", range: Range::Int(4, 4), default: Value::Int(4), applies: Applies::Drive,
        get: |_| Value::Int(4),
        description: "Edges that are counted of each pulse of an incremental encoder: always all 4, which is what the source recommends. \
            The drive counts them; scale has what 1 or 2 would be for.",
        source: "WF-MD-13" }
    "wf.md22": UNIT {
        mnemonic: "MD22", number: "22", view_of: "position_loop.kv", measure: Measure::Number, unit: "(mm/min)/um",
        range: Range::Real(0.01, 100.0), default: Value::Real(1.0), applies: Applies::Proportional,
        get: |p| Value::Real(p.position_loop.servo_gain()), set: |p, v| p.position_loop.given = real(v).or(p.position_loop.given),
        description: "Servo gain kv of the position loop with interface velocity, (mm/min)/um: 1 is 16.667 1/s.",
        source: "WF-MD-14, WF-CLC-03" }
    "wf.md30": UNIT, axis.vocabularies.wf.md30 {
        mnemonic: "MD30", number: "30", measure: Measure::Time, range: Range::Int(0, HOUR_NS), default: Value::Int(1_000_000_000),
        description: "PEH time: within it the position has to be inside the PEH window, else alarm 22.", source: "WF-MD-15, WF-PEH-02" }
    "wf.md34": UNIT, axis.encoder.pulses_or_step {
        mnemonic: "MD34", number: "34", range: WORD, default: Value::Int(0), applies: Applies::Drive,
        description: "Incremental encoder: pulses of a revolution, a quarter of the increments from index to index; absolute encoder: most \
            steps of a cycle, beyond which its word is bad; 0: not supervised.",
        source: "WF-MD-16", note: "W04: it means another thing with each kind of encoder; the row is both." }
    "wf.md41": UNIT, axis.encoder.monitored {
        mnemonic: "MD41", number: "41", range: Range::Int(0, 1), default: Value::Int(0), applies: Applies::Drive,
        full_cycles: Some(|p| p.encoder.monitored != 0 && p.encoder.pulses_or_step != 0),
        description: "1: encoder monitoring. Alarm 8 when pulses are missing or too many from index to index (wf.md34), alarm 7 instead of \
            error 10206 when the encoder gives no value.",
        source: "WF-MD-18" }
    "wf.md42": STEP_SPEED, axis.vocabularies.wf.md42 {
        mnemonic: "MD42", number: "42",
        description: "Speed value of reduction step 1, in hundredths of max_velocity." }
    "wf.md43": STEP_SPEED, axis.vocabularies.wf.md43 {
        mnemonic: "MD43", number: "43",
        description: "Speed value of reduction step 2; not above wf.md42." }
    "wf.md44": STEP_SPEED, axis.vocabularies.wf.md44 {
        mnemonic: "MD44", number: "44",
        description: "Speed value of reduction step 3; not above wf.md43." }
    "wf.md45": STEP_DISTANCE, axis.vocabularies.wf.md45 {
        mnemonic: "MD45", number: "45",
        description: "Distance before the target from which on step 1 runs, this distance included." }
    "wf.md46": STEP_DISTANCE, axis.vocabularies.wf.md46 {
        mnemonic: "MD46", number: "46",
        description: "Distance before the target below which step 2 runs; not above wf.md45." }
    "wf.md47": STEP_DISTANCE, axis.vocabularies.wf.md47 {
        mnemonic: "MD47", number: "47",
        description: "Distance before the target below which step 3 runs; not above wf.md46." }
    "wf.md48": STEP_DISTANCE, axis.vocabularies.wf.md48 {
        mnemonic: "MD48", number: "48",
        description: "Distance before the target below which the output is off; not above wf.md47." }
    "wf.peh_window": UNIT, axis.vocabularies.wf.peh_window {
        measure: Measure::Distance, range: DISTANCE, default_text: "as in_position_window",
        description: "PEH window: this near to the end of a block its position is reached.", source: "WF-MD-22, WF-PEH-03" }
    "wf.peh_from_start": UNIT, axis.vocabularies.wf.peh_from_start {
        range: Range::Int(0, 1), default: Value::Int(0),
        description: "1: the PEH time begins with START, 0: with the end of the output.", source: "WF-PEH-01, W07" }
    "wf.max_following_error": UNIT, axis.vocabularies.wf.max_following_error {
        measure: Measure::Distance, range: DISTANCE, default_text: "no alarm", applies: Applies::Drive,
        description: "Set position minus actual position beyond which alarm 10 (in travel) or 11 (at standstill) comes: in closed loop, \
            from enable on, whatever moves the axis.",
        source: "WF-MD-22, WF-MON-04, W13" }
    "wf.fixed_speed_1": FIXED_SPEED, axis.vocabularies.wf.fixed_speed_1 {
        description: "Setup speed that fixed_speed 1 chooses in mode jog, in hundredths of max_velocity." }
    "wf.fixed_speed_2": FIXED_SPEED, axis.vocabularies.wf.fixed_speed_2 {
        description: "Setup speed that fixed_speed 2 chooses in mode jog." }
    "wf.fixed_speed_3": FIXED_SPEED, axis.vocabularies.wf.fixed_speed_3 {
        description: "Setup speed that fixed_speed 3 chooses in mode jog." }
    "wf.reference_rapid": FIXED_SPEED, axis.vocabularies.wf.reference_rapid {
        effect: Effect::NextHoming, applies: Applies::Drive,
        description: "Speed value of homing towards the cam.", source: "WF-MD-22, WF-REF-01" }
    "wf.reference_reduced": FIXED_SPEED, axis.vocabularies.wf.reference_reduced {
        effect: Effect::NextHoming, applies: Applies::Drive,
        description: "Speed value of homing on the cam.", source: "WF-MD-22, WF-REF-01" }
    "wf.reference_creep": FIXED_SPEED, axis.vocabularies.wf.reference_creep {
        effect: Effect::NextHoming, applies: Applies::Drive,
        description: "Speed value of homing from the cam to the zero mark.", source: "WF-MD-22, WF-REF-01" }
    "wf.zero_offset": OFFSET, axis.vocabularies.wf.zero_offset {
        description: "Zero offset NV: added to absolute positions of the blocks that start from now on." }
    "wf.tool_length": OFFSET, axis.vocabularies.wf.tool_length {
        description: "Tool length compensation WK: added to absolute positions of the blocks that start from now on." }
};

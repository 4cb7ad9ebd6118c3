//! Parameters of the Siemens WF 725 / 726 positioning modules (spec/wf725.md); a bare number is in the axis unit.

use super::{
    Applies, BASE, Bare, Effect, Group, HOUR_NS, Measure, POSITION, REAL, Range, Row, System, Value, int, option, real,
};

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

pub(super) const ROWS: &[Row] = &[
    Row {
        key: "wf.md1",
        mnemonic: "MD1",
        number: "1",
        default_text: "as max_acceleration",
        description: "Acceleration of blocks and of setup in closed loop; not above max_acceleration.",
        get: |p| option(p.vocabularies.wf.md1),
        set: |p, v| p.vocabularies.wf.md1 = real(v),
        ..RATE
    },
    Row {
        key: "wf.md2",
        mnemonic: "MD2",
        number: "2",
        default_text: "as max_deceleration",
        description: "Deceleration of blocks and of setup in closed loop; not above max_deceleration.",
        get: |p| option(p.vocabularies.wf.md2),
        set: |p, v| p.vocabularies.wf.md2 = real(v),
        ..RATE
    },
    Row {
        key: "wf.md4",
        mnemonic: "MD4",
        number: "4",
        measure: Measure::Choice(ENCODERS),
        range: Range::Int(0, 1),
        default: Value::Int(0),
        applies: Applies::Drive,
        description: "Kind of encoder: absolute ones have a word of wf.md5 steps in Gray code and begin again after the last one.",
        source: "WF-MD-03",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.encoder.kind),
        set: |p, v| p.encoder.kind = int(v).unwrap_or(p.encoder.kind),
        ..UNIT
    },
    Row {
        key: "wf.md5",
        mnemonic: "MD5",
        number: "5",
        unit: "steps",
        range: Range::Int(1, i32::MAX as i64),
        default: Value::Int(16384),
        applies: Applies::Drive,
        description: "Steps of an absolute encoder: those of a revolution times its revolutions.",
        source: "WF-MD-04, WF-ABS-02",
        effect: Effect::Disabled,
        get: |p| Value::Int(p.encoder.steps),
        set: |p, v| p.encoder.steps = int(v).unwrap_or(p.encoder.steps),
        ..UNIT
    },
    Row {
        key: "wf.md7",
        mnemonic: "MD7",
        number: "7",
        range: WORD,
        default: Value::Int(0),
        applies: Applies::Drive,
        effect: Effect::Disabled,
        get: |p| Value::Int(p.encoder.side_or_omitted),
        set: |p, v| p.encoder.side_or_omitted = int(v).unwrap_or(p.encoder.side_or_omitted),
        description: "Incremental encoder: side of the cam on which homing ends: 0 the one that JOG leads to, 1 plus, 2 minus; for the \
                      side that it comes from the axis turns round on the cam. Absolute encoder: steps that are left out, the \
                      value of its first word.",
        source: "WF-MD-05, WF-REF-02",
        note: "W04: it means another thing with each kind of encoder; the row is both. The numbers of the sides are not told: these \
               are taken.",
        ..UNIT
    },
    Row {
        key: "wf.md15",
        mnemonic: "MD15",
        number: "15",
        measure: Measure::Choice(CAMS),
        range: Range::Int(0, 1),
        default: Value::Int(1),
        applies: Applies::Drive,
        effect: Effect::NextHoming,
        get: |p| Value::Int(p.homing.cam_source),
        set: |p, v| p.homing.cam_source = int(v).unwrap_or(p.homing.cam_source),
        description: "Where the cam of homing comes from: the key cam of verb wf, or the reference switch (i_refswitch, or that of the \
                      drive).",
        source: "WF-MD-08, WF-REF-04",
        note: "The usual value is not told: fast_input is taken.",
        ..UNIT
    },
    Row {
        key: "wf.md16",
        mnemonic: "MD16",
        number: "16",
        measure: Measure::Position,
        default: Value::Int(0),
        applies: Applies::Drive,
        range: POSITION,
        effect: Effect::Disabled,
        get: |p| Value::Int(p.encoder.reference_or_parity),
        set: |p, v| p.encoder.reference_or_parity = int(v).unwrap_or(p.encoder.reference_or_parity),
        description: "Incremental encoder: position of the reference point; absolute encoder: parity of its word, 0 none, 1 inc even, 2 inc odd.",
        source: "WF-MD-09, WF-ABS-04, WF-REF-02, WF-REF-03",
        note: "W04: it means another thing with each kind of encoder; the row is both. The numbers of the parity are not told: these are taken.",
        ..UNIT
    },
    Row {
        key: "wf.md17",
        mnemonic: "MD17",
        number: "17",
        measure: Measure::Position,
        default: Value::Int(0),
        applies: Applies::Drive,
        range: POSITION,
        effect: Effect::NextHoming,
        get: |p| Value::Int(p.vocabularies.wf.md17),
        set: |p, v| p.vocabularies.wf.md17 = int(v).unwrap_or(p.vocabularies.wf.md17),
        description: "Way from the zero mark to the reference point; without effect in open loop.",
        source: "WF-MD-10, WF-REF-01, WF-REF-03",
        ..UNIT
    },
    Row {
        key: "wf.md21",
        mnemonic: "MD21",
        number: "21",
        range: Range::Int(4, 4),
        default: Value::Int(4),
        applies: Applies::Drive,
        get: |_| Value::Int(4),
        description: "Edges that are counted of each pulse of an incremental encoder: always all 4, which is what the source recommends. \
                      The drive counts them; scale has what 1 or 2 would be for.",
        source: "WF-MD-13",
        ..UNIT
    },
    Row {
        key: "wf.md22",
        mnemonic: "MD22",
        number: "22",
        view_of: "position_loop.kv",
        measure: Measure::Number,
        unit: "(mm/min)/um",
        range: Range::Real(0.01, 100.0),
        default: Value::Real(1.0),
        applies: Applies::Proportional,
        description: "Servo gain kv of the position loop with interface velocity, (mm/min)/um: 1 is 16.667 1/s.",
        source: "WF-MD-14, WF-CLC-03",
        get: |p| Value::Real(p.position_loop.servo_gain()),
        set: |p, v| p.position_loop.given = real(v).or(p.position_loop.given),
        ..UNIT
    },
    Row {
        key: "wf.md30",
        mnemonic: "MD30",
        number: "30",
        measure: Measure::Time,
        range: Range::Int(0, HOUR_NS),
        default: Value::Int(1_000_000_000),
        description: "PEH time: within it the position has to be inside the PEH window, else alarm 22.",
        source: "WF-MD-15, WF-PEH-02",
        get: |p| Value::Int(p.vocabularies.wf.md30),
        set: |p, v| p.vocabularies.wf.md30 = int(v).unwrap_or(p.vocabularies.wf.md30),
        ..UNIT
    },
    Row {
        key: "wf.md34",
        mnemonic: "MD34",
        number: "34",
        range: WORD,
        default: Value::Int(0),
        applies: Applies::Drive,
        description: "Incremental encoder: pulses of a revolution, a quarter of the increments from index to index; absolute encoder: most steps of a cycle, beyond which its word is bad; 0: not supervised.",
        source: "WF-MD-16",
        note: "W04: it means another thing with each kind of encoder; the row is both.",
        get: |p| Value::Int(p.encoder.pulses_or_step),
        set: |p, v| p.encoder.pulses_or_step = int(v).unwrap_or(p.encoder.pulses_or_step),
        ..UNIT
    },
    Row {
        key: "wf.md41",
        mnemonic: "MD41",
        number: "41",
        range: Range::Int(0, 1),
        default: Value::Int(0),
        applies: Applies::Drive,
        description: "1: encoder monitoring. Alarm 8 when pulses are missing or too many from index to index (wf.md34), alarm 7 instead of error 10206 when the encoder gives no value.",
        source: "WF-MD-18",
        get: |p| Value::Int(p.encoder.monitored),
        set: |p, v| p.encoder.monitored = int(v).unwrap_or(p.encoder.monitored),
        ..UNIT
    },
    Row {
        key: "wf.md42",
        mnemonic: "MD42",
        number: "42",
        description: "Speed value of reduction step 1, in hundredths of max_velocity.",
        get: |p| Value::Int(p.vocabularies.wf.md42),
        set: |p, v| p.vocabularies.wf.md42 = int(v).unwrap_or(p.vocabularies.wf.md42),
        ..STEP_SPEED
    },
    Row {
        key: "wf.md43",
        mnemonic: "MD43",
        number: "43",
        description: "Speed value of reduction step 2; not above wf.md42.",
        get: |p| Value::Int(p.vocabularies.wf.md43),
        set: |p, v| p.vocabularies.wf.md43 = int(v).unwrap_or(p.vocabularies.wf.md43),
        ..STEP_SPEED
    },
    Row {
        key: "wf.md44",
        mnemonic: "MD44",
        number: "44",
        description: "Speed value of reduction step 3; not above wf.md43.",
        get: |p| Value::Int(p.vocabularies.wf.md44),
        set: |p, v| p.vocabularies.wf.md44 = int(v).unwrap_or(p.vocabularies.wf.md44),
        ..STEP_SPEED
    },
    Row {
        key: "wf.md45",
        mnemonic: "MD45",
        number: "45",
        description: "Distance before the target from which on step 1 runs, this distance included.",
        get: |p| Value::Int(p.vocabularies.wf.md45),
        set: |p, v| p.vocabularies.wf.md45 = int(v).unwrap_or(p.vocabularies.wf.md45),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.md46",
        mnemonic: "MD46",
        number: "46",
        description: "Distance before the target below which step 2 runs; not above wf.md45.",
        get: |p| Value::Int(p.vocabularies.wf.md46),
        set: |p, v| p.vocabularies.wf.md46 = int(v).unwrap_or(p.vocabularies.wf.md46),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.md47",
        mnemonic: "MD47",
        number: "47",
        description: "Distance before the target below which step 3 runs; not above wf.md46.",
        get: |p| Value::Int(p.vocabularies.wf.md47),
        set: |p, v| p.vocabularies.wf.md47 = int(v).unwrap_or(p.vocabularies.wf.md47),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.md48",
        mnemonic: "MD48",
        number: "48",
        description: "Distance before the target below which the output is off; not above wf.md47.",
        get: |p| Value::Int(p.vocabularies.wf.md48),
        set: |p, v| p.vocabularies.wf.md48 = int(v).unwrap_or(p.vocabularies.wf.md48),
        ..STEP_DISTANCE
    },
    Row {
        key: "wf.peh_window",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "as in_position_window",
        description: "PEH window: this near to the end of a block its position is reached.",
        source: "WF-MD-22, WF-PEH-03",
        get: |p| p.vocabularies.wf.peh_window.map_or(Value::Unset, Value::Int),
        set: |p, v| p.vocabularies.wf.peh_window = int(v),
        ..UNIT
    },
    Row {
        key: "wf.peh_from_start",
        range: Range::Int(0, 1),
        default: Value::Int(0),
        description: "1: the PEH time begins with START, 0: with the end of the output.",
        source: "WF-PEH-01, W07",
        get: |p| Value::Int(p.vocabularies.wf.peh_from_start),
        set: |p, v| p.vocabularies.wf.peh_from_start = int(v).unwrap_or(p.vocabularies.wf.peh_from_start),
        ..UNIT
    },
    Row {
        key: "wf.max_following_error",
        measure: Measure::Distance,
        range: DISTANCE,
        default_text: "no alarm",
        applies: Applies::Drive,
        description: "Set position minus actual position beyond which alarm 10 (in travel) or 11 (at standstill) comes: in closed loop, from enable on, whatever moves the axis.",
        source: "WF-MD-22, WF-MON-04, W13",
        get: |p| p.vocabularies.wf.max_following_error.map_or(Value::Unset, Value::Int),
        set: |p, v| p.vocabularies.wf.max_following_error = int(v),
        ..UNIT
    },
    Row {
        key: "wf.fixed_speed_1",
        description: "Setup speed that fixed_speed 1 chooses in mode jog, in hundredths of max_velocity.",
        get: |p| Value::Real(p.vocabularies.wf.fixed_speed_1),
        set: |p, v| p.vocabularies.wf.fixed_speed_1 = real(v).unwrap_or(p.vocabularies.wf.fixed_speed_1),
        ..FIXED_SPEED
    },
    Row {
        key: "wf.fixed_speed_2",
        description: "Setup speed that fixed_speed 2 chooses in mode jog.",
        get: |p| Value::Real(p.vocabularies.wf.fixed_speed_2),
        set: |p, v| p.vocabularies.wf.fixed_speed_2 = real(v).unwrap_or(p.vocabularies.wf.fixed_speed_2),
        ..FIXED_SPEED
    },
    Row {
        key: "wf.fixed_speed_3",
        description: "Setup speed that fixed_speed 3 chooses in mode jog.",
        get: |p| Value::Real(p.vocabularies.wf.fixed_speed_3),
        set: |p, v| p.vocabularies.wf.fixed_speed_3 = real(v).unwrap_or(p.vocabularies.wf.fixed_speed_3),
        ..FIXED_SPEED
    },
    Row {
        key: "wf.reference_rapid",
        applies: Applies::Drive,
        effect: Effect::NextHoming,
        get: |p| Value::Real(p.vocabularies.wf.reference_rapid),
        set: |p, v| p.vocabularies.wf.reference_rapid = real(v).unwrap_or(p.vocabularies.wf.reference_rapid),
        description: "Speed value of homing towards the cam.",
        source: "WF-MD-22, WF-REF-01",
        ..FIXED_SPEED
    },
    Row {
        key: "wf.reference_reduced",
        applies: Applies::Drive,
        effect: Effect::NextHoming,
        get: |p| Value::Real(p.vocabularies.wf.reference_reduced),
        set: |p, v| p.vocabularies.wf.reference_reduced = real(v).unwrap_or(p.vocabularies.wf.reference_reduced),
        description: "Speed value of homing on the cam.",
        source: "WF-MD-22, WF-REF-01",
        ..FIXED_SPEED
    },
    Row {
        key: "wf.reference_creep",
        applies: Applies::Drive,
        effect: Effect::NextHoming,
        get: |p| Value::Real(p.vocabularies.wf.reference_creep),
        set: |p, v| p.vocabularies.wf.reference_creep = real(v).unwrap_or(p.vocabularies.wf.reference_creep),
        description: "Speed value of homing from the cam to the zero mark.",
        source: "WF-MD-22, WF-REF-01",
        ..FIXED_SPEED
    },
    Row {
        key: "wf.zero_offset",
        description: "Zero offset NV: added to absolute positions of the blocks that start from now on.",
        get: |p| Value::Int(p.vocabularies.wf.zero_offset),
        set: |p, v| p.vocabularies.wf.zero_offset = int(v).unwrap_or(p.vocabularies.wf.zero_offset),
        ..OFFSET
    },
    Row {
        key: "wf.tool_length",
        description: "Tool length compensation WK: added to absolute positions of the blocks that start from now on.",
        get: |p| Value::Int(p.vocabularies.wf.tool_length),
        set: |p, v| p.vocabularies.wf.tool_length = int(v).unwrap_or(p.vocabularies.wf.tool_length),
        ..OFFSET
    },
];

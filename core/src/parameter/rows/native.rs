//! What every axis has, by its native names.

use super::super::{ESTIMATORS, JOG_AT_LIMIT};
use super::{
    Applies, BASE, Effect, Group, HOUR_NS, Measure, PROBE_INPUTS, PROFILES, REAL, Range, Row, Storage, Value, int,
    option, real,
};
use crate::regulator::KV;

/// Of the loops below the position loop.
const EFFORT: Row = Row { group: Group::Amplifier, applies: Applies::Torque, ..BASE };

pub(super) const ROWS: &[Row] = &[
    Row {
        key: "min_position",
        group: Group::Inputs,
        measure: Measure::Position,
        default_text: "no limit",
        description: "Lowest position that a goal may ask for or pass; the axis stops before it.",
        source: "MACS-LIM-01, MACS-LIM-02",
        get: |p| p.min_position.map_or(Value::Unset, Value::Int),
        set: |p, v| {
            p.min_position = int(v);
            p.keep_limits();
        },
        ..BASE
    },
    Row {
        key: "max_position",
        group: Group::Inputs,
        measure: Measure::Position,
        default_text: "no limit",
        description: "Highest position that a goal may ask for or pass; the axis stops before it.",
        source: "MACS-LIM-01, MACS-LIM-02",
        get: |p| p.max_position.map_or(Value::Unset, Value::Int),
        set: |p, v| {
            p.max_position = int(v);
            p.keep_limits();
        },
        ..BASE
    },
    Row {
        key: "max_velocity",
        measure: Measure::Velocity,
        range: REAL,
        required: true,
        effect: Effect::NextMotion,
        description: "Highest velocity; a goal that asks for more is refused.",
        source: "MACS-PROF-01",
        get: |p| Value::Real(p.max_velocity),
        set: |p, v| {
            p.max_velocity = real(v).unwrap_or(p.max_velocity);
            p.macs.velmax = None;
        },
        ..BASE
    },
    Row {
        key: "max_acceleration",
        measure: Measure::Acceleration,
        range: REAL,
        required: true,
        effect: Effect::NextMotion,
        description: "Highest acceleration; a goal that asks for more is refused.",
        source: "MACS-PROF-03",
        get: |p| Value::Real(p.max_acceleration),
        set: |p, v| {
            p.max_acceleration = real(v).unwrap_or(p.max_acceleration);
            p.macs.rampmin = None;
        },
        ..BASE
    },
    Row {
        key: "max_deceleration",
        measure: Measure::Acceleration,
        range: REAL,
        default_text: "as max_acceleration",
        effect: Effect::NextMotion,
        description: "Highest deceleration; quick_stop, limits and error reactions stop with it.",
        source: "MACS-PROF-03, MACS-PROF-13",
        get: |p| option(p.max_deceleration),
        set: |p, v| p.max_deceleration = real(v),
        ..BASE
    },
    Row {
        key: "max_jerk",
        measure: Measure::Jerk,
        range: REAL,
        default_text: "no limit",
        effect: Effect::NextMotion,
        description: "Highest jerk, for profile jerk; a goal that asks for more is refused.",
        source: "MACS-PROF-10",
        get: |p| option(p.max_jerk),
        set: |p, v| {
            p.max_jerk = real(v);
            p.macs.jerkmin = None;
        },
        ..BASE
    },
    Row {
        key: "velocity_override",
        storage: Storage::Volatile,
        unit: "%",
        measure: Measure::Number,
        range: Range::Real(0.0, 100.0),
        default: Value::Real(100.0),
        description: "Share of max_velocity [%] that goals may use, changed in motion; 0 holds a goal at rest until it is more.",
        source: "contract section 7",
        get: |p| Value::Real(p.velocity_override),
        set: |p, v| p.velocity_override = real(v).unwrap_or(p.velocity_override),
        ..BASE
    },
    Row {
        key: "profile",
        measure: Measure::Choice(PROFILES),
        range: Range::Int(0, 2),
        default: Value::Int(0),
        effect: Effect::NextMotion,
        description: "Shape of the ramps.",
        source: "MACS-PROF-07",
        get: |p| Value::Int(p.profile),
        set: |p, v| p.profile = int(v).unwrap_or(p.profile),
        ..BASE
    },
    Row {
        key: "default_velocity",
        measure: Measure::Velocity,
        range: REAL,
        default_text: "half of max_velocity",
        effect: Effect::NextMotion,
        description: "Velocity of a goal that gives none.",
        source: "MACS-PROF-06",
        get: |p| option(p.default_velocity),
        set: |p, v| {
            p.default_velocity = real(v);
            p.macs.dfltvel = None;
        },
        ..BASE
    },
    Row {
        key: "default_acceleration",
        measure: Measure::Acceleration,
        range: REAL,
        default_text: "half of max_acceleration",
        effect: Effect::NextMotion,
        description: "Acceleration of a goal that gives none; its deceleration takes the same share of max_deceleration.",
        source: "MACS-PROF-06",
        get: |p| option(p.default_acceleration),
        set: |p, v| {
            p.default_acceleration = real(v);
            p.macs.dfltacc = None;
        },
        ..BASE
    },
    Row {
        key: "max_following_error",
        applies: Applies::Drive,
        group: Group::Regulation,
        measure: Measure::Distance,
        range: Range::Int(1, (1 << 62) - 1),
        default: Value::Int(1000),
        description: "Following error that is tolerated; beyond it the axis stops by error_reaction.",
        source: "MACS-ERR-06",
        get: |p| Value::Int(p.max_following_error),
        set: |p, v| p.max_following_error = int(v).unwrap_or(p.max_following_error),
        ..BASE
    },
    Row {
        key: "following_error_time",
        applies: Applies::Drive,
        group: Group::Regulation,
        measure: Measure::Time,
        range: Range::Int(0, 10_000_000_000),
        default: Value::Int(0),
        description: "How long the following error may be exceeded before it is an error; 0: not at all.",
        source: "MACS-ERR-07",
        get: |p| Value::Int(p.following_error_time),
        set: |p, v| p.following_error_time = int(v).unwrap_or(p.following_error_time),
        ..BASE
    },
    Row {
        key: "in_position_window",
        group: Group::Inputs,
        measure: Measure::Distance,
        range: Range::Int(0, (1 << 62) - 1),
        default: Value::Int(0),
        description: "A goal is reached when the actual position is this near to the target; 0: the command is enough.",
        source: "MACS-TGT-01, MACS-TGT-02",
        get: |p| Value::Int(p.in_position_window),
        set: |p, v| p.in_position_window = int(v).unwrap_or(p.in_position_window),
        ..BASE
    },
    Row {
        key: "in_position_time",
        group: Group::Inputs,
        measure: Measure::Time,
        range: Range::Int(0, HOUR_NS),
        default: Value::Int(0),
        description: "How long the actual position has to stay within in_position_window; leaving it starts again.",
        source: "MACS-TGT-04, MACS-TGT-05",
        get: |p| Value::Int(p.in_position_time),
        set: |p, v| p.in_position_time = int(v).unwrap_or(p.in_position_time),
        ..BASE
    },
    Row {
        key: "error_reaction",
        group: Group::Inputs,
        measure: Measure::Integer,
        range: Range::Int(0, 5),
        default: Value::Int(0),
        description: "Reaction to an error: 0 coast, 1 coast with brake, 2 stop with max_deceleration and hold, 3 as 2 and \
                      brake after the stop, 4 the drive's own quick stop, 5 only report.",
        source: "MACS-ERR-02",
        get: |p| Value::Int(p.error_reaction),
        set: |p, v| p.error_reaction = int(v).unwrap_or(p.error_reaction),
        ..BASE
    },
    Row {
        key: "setpoint_timeout",
        group: Group::Inputs,
        measure: Measure::Time,
        range: Range::Int(1_000_000, HOUR_NS),
        default: Value::Int(100_000_000),
        description: "How long a streamed setpoint holds; without a newer one the axis stops.",
        source: "contract section 1",
        get: |p| Value::Int(p.setpoint_timeout),
        set: |p, v| p.setpoint_timeout = int(v).unwrap_or(p.setpoint_timeout),
        ..BASE
    },
    Row {
        key: "jog_at_limit",
        group: Group::Inputs,
        measure: Measure::Choice(JOG_AT_LIMIT),
        range: Range::Int(0, 1),
        default: Value::Int(0),
        description: "What ends a jog or a stream of setpoints that leads into min_position or max_position: stop, the axis stops at the \
                      limit without an error and may be jogged away at once; error, it stops there with error 10202 or 10203.",
        source: "contract section 3",
        get: |p| Value::Int(p.supervision.jog_at_limit),
        set: |p, v| p.supervision.jog_at_limit = int(v).unwrap_or(0),
        ..BASE
    },
    Row {
        key: "probe_active_input",
        group: Group::Inputs,
        measure: Measure::Choice(PROBE_INPUTS),
        range: Range::Int(0, 1),
        default: Value::Int(0),
        description: "What probe_axis does where its input has the level of the edge already: refuse it before motion, or allow the search for the next edge.",
        source: "PLCopen MC_TouchProbe",
        get: |p| Value::Int(p.probe_active_input),
        set: |p, v| p.probe_active_input = int(v).unwrap_or(p.probe_active_input),
        ..BASE
    },
    Row {
        key: "position_loop.kv",
        group: Group::Regulation,
        measure: Measure::Number,
        unit: "1/s",
        range: Range::Real(0.01 * KV, 100.0 * KV),
        default: Value::Real(KV),
        applies: Applies::Proportional,
        description: "Gain of the position loop that the core closes with interface velocity: the output velocity for each \
                      increment of following error, within max_velocity.",
        source: "WF-CLC-03",
        get: |p| Value::Real(p.position_loop.kv),
        set: |p, v| {
            p.position_loop.kv = real(v).unwrap_or(p.position_loop.kv);
            p.position_loop.given = None;
        },
        ..BASE
    },
    Row {
        key: "max_effort",
        measure: Measure::Number,
        unit: "unit of effort of the drive",
        range: Range::PositiveUpTo(1e9),
        default_text: "must be given",
        description: "Effort at the output 1 of the loops, and so the largest one that is asked for.",
        source: "MACS-AMP-02",
        effect: Effect::Disabled,
        get: |p| option(p.amplifier.max_effort),
        set: |p, v| p.amplifier.max_effort = real(v),
        ..EFFORT
    },
    Row {
        key: "torque_constant",
        measure: Measure::Number,
        unit: "unit of effort per A",
        range: Range::Real(0.0, 1e9),
        default: Value::Real(0.0),
        description: "Effort for each ampere of the motor: by it ampmaxcur caps the effort, and i2tftime watches it. 0: currents are not known.",
        source: "MACS-AMP-08",
        effect: Effect::Disabled,
        get: |p| Value::Real(p.amplifier.torque_constant),
        set: |p, v| p.amplifier.torque_constant = real(v).unwrap_or(p.amplifier.torque_constant),
        ..EFFORT
    },
    Row {
        key: "full_current",
        measure: Measure::Number,
        unit: "A",
        range: Range::Real(0.05, 100_000.0),
        default: Value::Unset,
        default_text: "must be given with ampmode 0 and 2",
        applies: Applies::Voltage,
        description: "Current that the output 1 of the loop above the current loop asks for; 32768 / full_current are the counts for one A (kc) of its gains.",
        source: "MACS-AMP-07",
        effect: Effect::Disabled,
        get: |p| option(p.power_stage.full_current),
        set: |p, v| p.power_stage.full_current = real(v),
        ..EFFORT
    },
    Row {
        key: "velocity_loop.estimator",
        measure: Measure::Choice(ESTIMATORS),
        range: Range::Int(0, ESTIMATORS.len() as i64 - 1),
        default: Value::Int(0),
        effect: Effect::Disabled,
        description: "How the velocity of the velocity loop is found: change of a cycle, the same behind a filter, an observer, a Kalman filter.",
        source: "MACS-AMP-06",
        get: |p| Value::Int(p.amplifier.estimator),
        set: |p, v| p.amplifier.estimator = int(v).unwrap_or(p.amplifier.estimator),
        ..EFFORT
    },
    Row {
        key: "velocity_loop.bandwidth",
        measure: Measure::Number,
        unit: "Hz",
        range: Range::Real(0.1, 10_000.0),
        default: Value::Real(100.0),
        effect: Effect::Disabled,
        description: "Of the filter (filtered) or the double pole of the observer (alpha_beta).",
        source: "MACS-AMP-06",
        get: |p| Value::Real(p.amplifier.bandwidth),
        set: |p, v| p.amplifier.bandwidth = real(v).unwrap_or(p.amplifier.bandwidth),
        ..EFFORT
    },
    Row {
        key: "velocity_loop.acceleration",
        measure: Measure::Acceleration,
        range: REAL,
        default: Value::Real(1e6),
        effect: Effect::Disabled,
        description: "Standard deviation of the acceleration that the Kalman filter expects, new in each cycle: larger is faster and less smooth.",
        source: "MACS-AMP-06",
        get: |p| Value::Real(p.amplifier.acceleration),
        set: |p, v| p.amplifier.acceleration = real(v).unwrap_or(p.amplifier.acceleration),
        ..EFFORT
    },
];

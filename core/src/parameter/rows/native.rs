//! What every axis has, by its native names.

use super::super::{ESTIMATORS, JOG_AT_LIMIT};
use super::{
    Applies, BASE, Effect, Group, HOUR_NS, Measure, PROBE_INPUTS, PROFILES, REAL, Range, Row, Storage, Value, int,
};
use crate::regulator::KV;

/// Of the loops below the position loop.
const EFFORT: Row = Row { group: Group::Amplifier, applies: Applies::Torque, ..BASE };

pub(super) const ROWS: &[Row] = rows! {
    "min_position": BASE {
        group: Group::Inputs, measure: Measure::Position, default_text: "no limit", by_axis: true,
        get: |p| p.min_position.map_or(Value::Unset, Value::Int), set: |p, v| { p.min_position = int(v); p.keep_limits(); },
        description: "Lowest position that a goal may ask for or pass; the axis stops before it.", source: "MACS-LIM-01, MACS-LIM-02" }
    "max_position": BASE {
        group: Group::Inputs, measure: Measure::Position, default_text: "no limit", by_axis: true,
        get: |p| p.max_position.map_or(Value::Unset, Value::Int), set: |p, v| { p.max_position = int(v); p.keep_limits(); },
        description: "Highest position that a goal may ask for or pass; the axis stops before it.", source: "MACS-LIM-01, MACS-LIM-02" }
    "max_velocity": BASE, axis.max_velocity, clears macs.velmax {
        measure: Measure::Velocity, range: REAL, required: true, effect: Effect::NextMotion,
        description: "Highest velocity; a goal that asks for more is refused.", source: "MACS-PROF-01" }
    "max_acceleration": BASE, axis.max_acceleration, clears macs.rampmin {
        measure: Measure::Acceleration, range: REAL, required: true, effect: Effect::NextMotion,
        description: "Highest acceleration; a goal that asks for more is refused.", source: "MACS-PROF-03" }
    "max_deceleration": BASE, axis.max_deceleration {
        measure: Measure::Acceleration, range: REAL, default_text: "as max_acceleration", effect: Effect::NextMotion,
        description: "Highest deceleration; quick_stop, limits and error reactions stop with it.", source: "MACS-PROF-03, MACS-PROF-13" }
    "max_jerk": BASE, axis.max_jerk, clears macs.jerkmin {
        measure: Measure::Jerk, range: REAL, default_text: "no limit", effect: Effect::NextMotion,
        description: "Highest jerk, for profile jerk; a goal that asks for more is refused.", source: "MACS-PROF-10" }
    "velocity_override": BASE, axis.velocity_override {
        measure: Measure::Number, unit: "%", range: Range::Real(0.0, 100.0), default: Value::Real(100.0), storage: Storage::Volatile,
        description: "Share of max_velocity [%] that goals may use, changed in motion; 0 holds a goal at rest until it is more.",
        source: "contract section 7" }
    "profile": BASE, axis.profile {
        measure: Measure::Choice(PROFILES), range: Range::Int(0, 2), default: Value::Int(0), effect: Effect::NextMotion,
        description: "Shape of the ramps.", source: "MACS-PROF-07" }
    "default_velocity": BASE, axis.default_velocity, clears macs.dfltvel {
        measure: Measure::Velocity, range: REAL, default_text: "half of max_velocity", effect: Effect::NextMotion,
        description: "Velocity of a goal that gives none.", source: "MACS-PROF-06" }
    "default_acceleration": BASE, axis.default_acceleration, clears macs.dfltacc {
        measure: Measure::Acceleration, range: REAL, default_text: "half of max_acceleration", effect: Effect::NextMotion,
        description: "Acceleration of a goal that gives none; its deceleration takes the same share of max_deceleration.",
        source: "MACS-PROF-06" }
    "max_following_error": BASE, axis.max_following_error {
        group: Group::Regulation, measure: Measure::Distance, range: Range::Int(1, (1 << 62) - 1), default: Value::Int(1000),
        applies: Applies::Drive,
        description: "Following error that is tolerated; beyond it the axis stops by error_reaction.", source: "MACS-ERR-06" }
    "following_error_time": BASE, axis.following_error_time {
        group: Group::Regulation, measure: Measure::Time, range: Range::Int(0, 10_000_000_000), default: Value::Int(0),
        applies: Applies::Drive,
        description: "How long the following error may be exceeded before it is an error; 0: not at all.", source: "MACS-ERR-07" }
    "in_position_window": BASE, axis.in_position_window {
        group: Group::Inputs, measure: Measure::Distance, range: Range::Int(0, (1 << 62) - 1), default: Value::Int(0),
        description: "A goal is reached when the actual position is this near to the target; 0: the command is enough.",
        source: "MACS-TGT-01, MACS-TGT-02" }
    "in_position_time": BASE, axis.in_position_time {
        group: Group::Inputs, measure: Measure::Time, range: Range::Int(0, HOUR_NS), default: Value::Int(0),
        description: "How long the actual position has to stay within in_position_window; leaving it starts again.",
        source: "MACS-TGT-04, MACS-TGT-05" }
    "error_reaction": BASE, axis.error_reaction {
        group: Group::Inputs, range: Range::Int(0, 5), default: Value::Int(0),
        description: "Reaction to an error: 0 coast, 1 coast with brake, 2 stop with max_deceleration and hold, 3 as 2 and brake after the \
            stop, 4 the drive's own quick stop, 5 only report.",
        source: "MACS-ERR-02" }
    "setpoint_timeout": BASE, axis.setpoint_timeout {
        group: Group::Inputs, measure: Measure::Time, range: Range::Int(1_000_000, HOUR_NS), default: Value::Int(100_000_000),
        description: "How long a streamed setpoint holds; without a newer one the axis stops.", source: "contract section 1" }
    "jog_at_limit": BASE, axis.supervision.jog_at_limit {
        group: Group::Inputs, measure: Measure::Choice(JOG_AT_LIMIT), range: Range::Int(0, 1), default: Value::Int(0),
        description: "What ends a jog or a stream of setpoints that leads into min_position or max_position: stop, the axis stops at the \
            limit without an error and may be jogged away at once; error, it stops there with error 10202 or 10203.",
        source: "contract section 3" }
    "probe_active_input": BASE, axis.probe_active_input {
        group: Group::Inputs, measure: Measure::Choice(PROBE_INPUTS), range: Range::Int(0, 1), default: Value::Int(0),
        description: "What probe_axis does where its input has the level of the edge already: refuse it before motion, or allow the search \
            for the next edge.",
        source: "PLCopen MC_TouchProbe" }
    "position_loop.kv": BASE, axis.position_loop.kv, clears position_loop.given {
        group: Group::Regulation, measure: Measure::Number, unit: "1/s", range: Range::Real(0.01 * KV, 100.0 * KV),
        default: Value::Real(KV), applies: Applies::Proportional,
        description: "Gain of the position loop that the core closes with interface velocity: the output velocity for each increment of \
            following error, within max_velocity.",
        source: "WF-CLC-03" }
    "max_effort": EFFORT, axis.amplifier.max_effort {
        measure: Measure::Number, unit: "unit of effort of the drive", range: Range::PositiveUpTo(1e9), default_text: "must be given",
        effect: Effect::Disabled,
        description: "Effort at the output 1 of the loops, and so the largest one that is asked for.", source: "MACS-AMP-02" }
    "torque_constant": EFFORT, axis.amplifier.torque_constant {
        measure: Measure::Number, unit: "unit of effort per A", range: Range::Real(0.0, 1e9), default: Value::Real(0.0),
        effect: Effect::Disabled, full_cycles: Some(|p| p.amplifier.torque_constant > 0.0),
        description: "Effort for each ampere of the motor: by it ampmaxcur caps the effort, and i2tftime watches it. 0: currents are not \
            known.",
        source: "MACS-AMP-08" }
    "full_current": EFFORT, axis.power_stage.full_current {
        measure: Measure::Number, unit: "A", range: Range::Real(0.05, 100_000.0), default_text: "must be given with ampmode 0 and 2",
        effect: Effect::Disabled, applies: Applies::Voltage,
        description: "Current that the output 1 of the loop above the current loop asks for; 32768 / full_current are the counts for one A \
            (kc) of its gains.",
        source: "MACS-AMP-07" }
    "velocity_loop.estimator": EFFORT, axis.amplifier.estimator {
        measure: Measure::Choice(ESTIMATORS), range: Range::Int(0, ESTIMATORS.len() as i64 - 1), default: Value::Int(0),
        effect: Effect::Disabled,
        description: "How the velocity of the velocity loop is found: change of a cycle, the same behind a filter, an observer, a Kalman \
            filter.",
        source: "MACS-AMP-06" }
    "velocity_loop.bandwidth": EFFORT, axis.amplifier.bandwidth {
        measure: Measure::Number, unit: "Hz", range: Range::Real(0.1, 10_000.0), default: Value::Real(100.0), effect: Effect::Disabled,
        description: "Of the filter (filtered) or the double pole of the observer (alpha_beta).", source: "MACS-AMP-06" }
    "velocity_loop.acceleration": EFFORT, axis.amplifier.acceleration {
        measure: Measure::Acceleration, range: REAL, default: Value::Real(1e6), effect: Effect::Disabled,
        description: "Standard deviation of the acceleration that the Kalman filter expects, new in each cycle: larger is faster and less \
            smooth.",
        source: "MACS-AMP-06" }
};

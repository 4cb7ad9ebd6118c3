//! Velocity, acceleration and ramps (AXB).

use super::super::{Applies, BASE, Bare, Effect, Group, MLONG, Measure, Range, Row, Storage, System, Value, int, real};

const BASIC_ROW: Row = Row { system: System::Macs, group: Group::Basic, applies: Applies::Any, ..BASE };

pub(in super::super) const ROWS: &[Row] = rows! {
    "velmax": BASIC_ROW {
        mnemonic: "VELMAX", number: "1", view_of: "max_velocity", measure: Measure::Number, unit: "rpm", range: Range::Real(1.0, 65_535.0),
        default: Value::Real(1000.0), effect: Effect::NextMotion,
        get: |p| Value::Real(p.velmax()), set: |p, v| p.macs.velmax = real(v),
        description: "Rated speed at the encoder, which has 4 ENCODER increments in a revolution: max_velocity. Given so, it stays in rpm.",
        source: "MACS-PROF-01, MACS-PROF-02" }
    "velmaxqc": BASIC_ROW {
        mnemonic: "VELMAXQC", number: "9", unit: "inc/ms/65536", storage: Storage::Derived,
        get: |p| Value::Int(p.velmaxqc()),
        description: "Largest velocity as MACS keeps it: increments per ms in parts of 1/65536, cut to a whole number. It follows every \
            change of what it comes from.",
        source: "MACS-PROF-02, MACS-STO-08" }
    "accmaxqc": BASIC_ROW {
        mnemonic: "ACCMAXQC", number: "10", unit: "inc/ms^2/65536", storage: Storage::Derived,
        get: |p| Value::Int(p.accmaxqc()),
        description: "Largest acceleration as MACS keeps it: increments per ms^2 in parts of 1/65536, cut to a whole number. It follows \
            every change of what it comes from.",
        source: "MACS-PROF-03, MACS-STO-08" }
    "velres": BASIC_ROW, axis.macs.velres {
        mnemonic: "VELRES", number: "22", range: Range::Int(1, 10_000), default: Value::Int(100), effect: Effect::NextMotion,
        description: "The number that stands for all of VELMAX, and for the largest acceleration, in dfltvel, dfltacc and the homing \
            rates: 100 makes them percent.",
        source: "MACS-PROF-04, MACS-UNIT-06" }
    "rampmin": BASIC_ROW {
        mnemonic: "RAMPMIN", number: "31", view_of: "max_acceleration", measure: Measure::Time,
        range: Range::Int(1_000_000, 360_000 * 1_000_000), bare: Bare::Milliseconds, default: Value::Int(1_000_000_000),
        effect: Effect::NextMotion,
        get: |p| Value::Int(p.rampmin()), set: |p, v| p.macs.rampmin = int(v),
        description: "Shortest ramp from 0 to VELMAX: max_acceleration. Given so, it stays a time.", source: "MACS-PROF-03" }
    "ramptype": BASIC_ROW, axis.profile {
        mnemonic: "RAMPTYPE", number: "32", view_of: "profile", range: Range::Int(0, 2), default: Value::Int(0), effect: Effect::NextMotion,
        description: "Shape of the ramps of moves, velocities and stops: 0 constant acceleration, 1 sine, 2 limited jerk. A coupling has \
            none.",
        source: "MACS-PROF-07" }
    "dfltvel": BASIC_ROW {
        mnemonic: "DFLTVEL", number: "33", view_of: "default_velocity", unit: "1/VELRES", range: Range::Int(1, 10_000),
        default: Value::Int(50), effect: Effect::NextMotion,
        get: |p| Value::Int(p.dfltvel()), set: |p, v| p.macs.dfltvel = int(v),
        description: "Velocity of a goal that gives none, in parts of VELMAX; not above velres.", source: "MACS-PROF-06, MACS-PROF-04",
        note: "D11: the unit is % in the overview; 1/VELRES is taken, which is the same while VELRES is 100." }
    "dfltacc": BASIC_ROW {
        mnemonic: "DFLTACC", number: "34", view_of: "default_acceleration", unit: "1/VELRES", range: Range::Int(1, 10_000),
        default: Value::Int(50), effect: Effect::NextMotion,
        get: |p| Value::Int(p.dfltacc()), set: |p, v| p.macs.dfltacc = int(v),
        description: "Acceleration of a goal that gives none, in parts of the largest one; not above velres.",
        source: "MACS-PROF-06, MACS-PROF-04",
        note: "D11: the unit is % in the overview; 1/VELRES is taken, which is the same while VELRES is 100." }
    "jerkmin": BASIC_ROW {
        mnemonic: "JERKMIN", number: "98", view_of: "max_jerk", measure: Measure::Time, range: Range::Int(0, MLONG * 1_000_000),
        bare: Bare::Milliseconds, default: Value::Int(0), effect: Effect::NextMotion,
        get: |p| Value::Int(p.jerkmin()), set: |p, v| p.macs.jerkmin = int(v),
        description: "Time from acceleration 0 to the largest one: max_jerk; 0 is no limit. Given so, it stays a time when \
            max_acceleration changes. A goal that gives no jerk uses half of max_jerk.",
        source: "MACS-PROF-10", note: "D12: the overview has JERKMIN alone; there are four." }
    "jerkmin2": BASIC_ROW, axis.jerk_times[0] {
        mnemonic: "JERKMIN2", number: "100", measure: Measure::Time, range: Range::Int(0, MLONG * 1_000_000), bare: Bare::Milliseconds,
        default: Value::Int(0), effect: Effect::NextMotion,
        description: "Time from the largest acceleration back to 0, for profile jerk; 0: as jerkmin.", source: "MACS-PROF-11",
        note: "D12: the overview has JERKMIN alone; there are four." }
    "jerkmin3": BASIC_ROW, axis.jerk_times[1] {
        mnemonic: "JERKMIN3", number: "101", measure: Measure::Time, range: Range::Int(0, MLONG * 1_000_000), bare: Bare::Milliseconds,
        default: Value::Int(0), effect: Effect::NextMotion,
        description: "Time from deceleration 0 to the largest one, for profile jerk; 0: as jerkmin.", source: "MACS-PROF-11",
        note: "D12: the overview has JERKMIN alone; there are four." }
    "jerkmin4": BASIC_ROW, axis.jerk_times[2] {
        mnemonic: "JERKMIN4", number: "102", measure: Measure::Time, range: Range::Int(0, MLONG * 1_000_000), bare: Bare::Milliseconds,
        default: Value::Int(0), effect: Effect::NextMotion,
        description: "Time from the largest deceleration back to 0, for profile jerk; 0: as jerkmin.", source: "MACS-PROF-11",
        note: "D12: the overview has JERKMIN alone; there are four." }
};

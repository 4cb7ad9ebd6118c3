//! Parameters of one axis, and values derived from them.

use super::rows::{BY_AXIS, FULL_CYCLES, ROWS};
use super::vocabularies::{self, Vocabularies};
use super::{
    Amplifier, Assigned, AssignedOutputs, Compensation, Encoders, GantryParameters, Homing, Macs, Marks, PositionLoop,
    PowerStage, Row, Supervision, Synchronization, Value,
};
use crate::code::Code;
use crate::position::Position;
use crate::profile::{Jerks, Limits, Shape};
use crate::regulator::PidGains;
use serde::{Deserialize, Serialize};

/// Maximum velocity, acceleration and jerk (inc/s, ..).
const MAX_RATE: f64 = 1e15;

/// Values of the rows that an axis changes by itself ([`Row::by_axis`]).
pub(crate) type ValuesByAxis = [Value; BY_AXIS.len()];

/// Parameters of one axis, in units of the core.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisParameters {
    /// Lower software limit (inc).
    pub min_position: Option<i64>,
    /// Upper software limit (inc).
    pub max_position: Option<i64>,
    /// Maximum velocity (inc/s).
    pub max_velocity: f64,
    /// Maximum acceleration (inc/s^2).
    pub max_acceleration: f64,
    /// Maximum deceleration (inc/s^2); `None`: as `max_acceleration`.
    pub max_deceleration: Option<f64>,
    /// Maximum jerk (inc/s^3); `None`: no limit.
    pub max_jerk: Option<f64>,
    /// JERKMIN2 to 4: times from the maximum acceleration to 0, from 0 to the maximum deceleration, and back (ns); 0:
    /// as `max_jerk`.
    pub jerk_times: [i64; 3],
    /// Part of `max_velocity` that goals may use, 0 to 100 (%).
    pub velocity_override: f64,
    /// Default velocity (inc/s); `None`: half of `max_velocity`.
    pub default_velocity: Option<f64>,
    /// Default acceleration (inc/s^2); `None`: half of `max_acceleration`.
    pub default_acceleration: Option<f64>,
    /// Index in [`PROFILES`](super::PROFILES).
    pub profile: i64,
    /// Maximum following error (inc).
    pub max_following_error: i64,
    /// Time for which the following error may exceed its maximum (ns).
    pub following_error_time: i64,
    /// In-position window (inc).
    pub in_position_window: i64,
    /// In-position time (ns).
    pub in_position_time: i64,
    /// Reaction to errors, ERRCOND 0 to 5.
    pub error_reaction: i64,
    /// Gear factor, master side.
    pub sync_master: i64,
    /// Gear factor, slave side.
    pub sync_slave: i64,
    /// Accuracy window of the coupling (inc); negative: the error is shown with its sign.
    pub sync_accuracy: i64,
    /// Synchronization with the master.
    pub sync: Synchronization,
    /// Marks of the axis and its master.
    pub marks: Marks,
    /// Maximum age of a streamed setpoint (ns).
    pub setpoint_timeout: i64,
    /// Index in [`PROBE_INPUTS`](super::PROBE_INPUTS).
    pub probe_active_input: i64,
    /// Homing.
    pub homing: Homing,
    /// Sources of positions.
    pub encoder: Encoders,
    /// Inputs assigned to its switches.
    pub assigned: Assigned,
    /// Supervision.
    pub supervision: Supervision,
    /// Outputs assigned to the axis.
    pub outputs: AssignedOutputs,
    /// Gantry, for an axis with two drives.
    pub gantry: GantryParameters,
    /// Compensation that is added to the command of the drive.
    pub compensation: Compensation,
    /// Values that MACS gives relative to others.
    pub macs: Macs,
    /// Position loop, if it is closed in this program.
    pub position_loop: PositionLoop,
    /// Gains of a position loop with PID.
    pub pid: PidGains,
    /// Loops below the position loop, for drives that take efforts.
    pub amplifier: Amplifier,
    /// Current loop below those, for drives that take voltages.
    pub power_stage: PowerStage,
    /// Parameters of the vocabularies.
    pub vocabularies: Vocabularies,
}

impl AxisParameters {
    /// Returns the defaults of all rows; the required rows are arguments.
    pub fn new(max_velocity: f64, max_acceleration: f64) -> Self {
        let mut parameters = Self {
            min_position: None,
            max_position: None,
            max_velocity,
            max_acceleration,
            max_deceleration: None,
            max_jerk: None,
            jerk_times: [0; 3],
            velocity_override: 0.0,
            default_velocity: None,
            default_acceleration: None,
            profile: 0,
            max_following_error: 0,
            following_error_time: 0,
            in_position_window: 0,
            in_position_time: 0,
            error_reaction: 0,
            sync_master: 0,
            sync_slave: 0,
            sync_accuracy: 0,
            sync: Synchronization::default(),
            marks: Marks::default(),
            setpoint_timeout: 0,
            probe_active_input: 0,
            homing: Homing::default(),
            encoder: Encoders::default(),
            assigned: Assigned::default(),
            supervision: Supervision::default(),
            outputs: AssignedOutputs::default(),
            gantry: GantryParameters::default(),
            compensation: Compensation::default(),
            macs: Macs::default(),
            position_loop: PositionLoop::default(),
            pid: PidGains::default(),
            amplifier: Amplifier::default(),
            power_stage: PowerStage::default(),
            vocabularies: Vocabularies::default(),
        };
        for row in ROWS.iter().filter(|row| row.is_stored() && !row.required) {
            (row.set)(&mut parameters, row.default);
        }
        parameters
    }

    /// Returns the values that the axis may have changed by itself.
    pub(crate) fn values_by_axis(&self) -> ValuesByAxis {
        BY_AXIS.map(|row| row.value(self))
    }

    /// Whether a function that they switch on needs full cycles of the axis ([`Row::full_cycles`]).
    pub(crate) fn needs_full_cycles(&self) -> bool {
        FULL_CYCLES.iter().any(|row| row.full_cycles.is_some_and(|needs| needs(self)))
    }

    /// Returns the maximum deceleration (inc/s^2).
    pub fn deceleration_limit(&self) -> f64 {
        self.max_deceleration.unwrap_or(self.max_acceleration)
    }

    /// Returns the default velocity of a goal (inc/s).
    pub fn default_goal_velocity(&self) -> f64 {
        self.default_velocity.unwrap_or(self.max_velocity / 2.0)
    }

    /// Returns the default acceleration of a goal (inc/s^2).
    pub fn default_goal_acceleration(&self) -> f64 {
        self.default_acceleration.unwrap_or(self.max_acceleration / 2.0)
    }

    /// Returns the default deceleration of a goal (inc/s^2): the same fraction of its maximum as the acceleration, as
    /// MACS-PROF-06 gives both as fractions of the maximum.
    pub fn default_goal_deceleration(&self) -> f64 {
        self.deceleration_limit() * (self.default_goal_acceleration() / self.max_acceleration)
    }

    /// Returns the shape of ramps with a maximum jerk (inc/s^3) (MACS-PROF-07). The four jerks keep their ratios
    /// (MACS-PROF-11).
    pub fn shape(&self, jerk: f64) -> Shape {
        match self.profile {
            1 => Shape::SRamp,
            2 => {
                let share = self.max_jerk.map_or(1.0, |most| jerk / most);
                // JERKMIN2 to 4 are times from 0 to the maximum acceleration; 0 means the value of JERKMIN.
                let of = |time: i64| if time == 0 { jerk } else { self.max_acceleration / (time as f64 / 1e9) * share };
                let [fall, brake_rise, brake_fall] = self.jerk_times.map(of);
                Shape::Jerk(Jerks { rise: jerk, fall, brake_rise, brake_fall })
            }
            _ => Shape::Trapezoid,
        }
    }

    /// Returns the shape with the maximum jerk; without a limit of the jerk it is a trapezoid.
    fn max_jerk_shape(&self) -> Shape {
        self.max_jerk.map_or(self.shapeless(), |jerk| self.shape(jerk))
    }

    /// Returns the default shape of a goal: half of the maximum jerk, as for the other rates.
    pub fn default_goal_shape(&self) -> Shape {
        self.max_jerk.map_or(self.shapeless(), |jerk| self.shape(jerk / 2.0))
    }

    fn shapeless(&self) -> Shape {
        if self.profile == 1 { Shape::SRamp } else { Shape::Trapezoid }
    }

    /// Returns the default limits of a goal.
    pub fn default_goal_limits(&self) -> Limits {
        Limits {
            velocity: self.default_goal_velocity(),
            acceleration: self.default_goal_acceleration(),
            deceleration: self.default_goal_deceleration(),
            shape: self.default_goal_shape(),
        }
    }

    /// Returns the limits at their maxima, which stops at limits and after errors use (MACS-PROF-13).
    pub fn max_limits(&self) -> Limits {
        Limits {
            velocity: self.max_velocity,
            acceleration: self.max_acceleration,
            deceleration: self.deceleration_limit(),
            shape: self.max_jerk_shape(),
        }
    }

    /// Returns true if every value is within the range of its row, and the values are consistent.
    pub fn is_sound(&self) -> bool {
        let is_good = |row: &Row| row.check(row.value(self)).is_ok();
        let macs = &self.macs;
        let given = [
            ("rampmin", macs.rampmin.map(Value::Int)),
            ("jerkmin", macs.jerkmin.map(Value::Int)),
            ("dfltvel", macs.dfltvel.map(Value::Int)),
            ("dfltacc", macs.dfltacc.map(Value::Int)),
            ("velmax", macs.velmax.map(Value::Real)),
            ("home_vel", self.homing.parts.velocity.map(Value::Int)),
            ("homezerovel", self.homing.parts.index_velocity.map(Value::Int)),
            ("home_ramp", self.homing.parts.acceleration.map(Value::Int)),
            (vocabularies::SERVO_GAIN, self.position_loop.given.map(Value::Real)),
        ];
        // A new coordinate may have shifted the limits beyond the range of MACS.
        let is_place = |limit: i64| Position::whole(limit).is_legal();
        let takes = |key, value| Row::find(key).is_some_and(|(_, row)| row.check(value).is_ok());
        ROWS.iter().filter(|row| row.is_stored()).all(is_good)
            && given.into_iter().all(|(key, value)| value.is_none_or(|value| takes(key, value)))
            && is_place(macs.neglimit)
            && is_place(macs.poslimit)
            && self.is_derived()
            && self.check().is_ok()
    }

    /// Checks that the values are consistent.
    ///
    /// # Errors
    /// The first contradiction.
    pub fn check(&self) -> Result<(), Contradiction> {
        // A derived value may leave its range.
        for (key, value) in [
            ("max_velocity", Some(self.max_velocity)),
            ("max_acceleration", Some(self.max_acceleration)),
            ("max_jerk", self.max_jerk),
            ("default_velocity", self.default_velocity),
            ("default_acceleration", self.default_acceleration),
            ("homing.index_velocity", self.homing.index_velocity),
            ("homing.acceleration", self.homing.acceleration),
        ] {
            if value.is_some_and(|value| !(value > 0.0 && value <= MAX_RATE)) {
                return Err(Contradiction::OutOfRange(key));
            }
        }
        if self.has_loop_directions() && !self.has_velocity_encoder() {
            return Err(Contradiction::NotBuilt("posdrct", Code::NO_VELOCITY_LOOP));
        }
        self.encoder.check().map_err(|(key, code)| Contradiction::NotBuilt(key, code))?;
        if self.encoder.kind == 1 && !(0..=2).contains(&self.encoder.reference_or_parity) {
            return Err(Contradiction::NotBuilt(vocabularies::REFERENCE_OR_PARITY, Code::WF_NO_PARITY));
        }
        if !self.reversing().is_implemented() {
            return Err(Contradiction::NotBuilt("revers", Code::NO_REVERSING_OUTPUTS));
        }
        self.check_marks().map_err(|(key, code)| Contradiction::NotBuilt(key, code))?;
        if self.is_offset_too_large() {
            return Err(Contradiction::NotBuilt("syncposoffs", Code::SYNC_OFFSET_RANGE));
        }
        if let (Some(low), Some(high)) = (self.min_position, self.max_position)
            && low >= high
        {
            return Err(Contradiction::Above("min_position", "max_position"));
        }
        // Fractions of VELRES, reported by the names by which they were given.
        let parts = self.homing.parts;
        for (key, part) in [
            ("dfltvel", self.macs.dfltvel),
            ("dfltacc", self.macs.dfltacc),
            ("home_vel", parts.velocity),
            ("home_ramp", parts.acceleration),
        ] {
            if part.is_some_and(|part| part.saturating_abs() > self.macs.velres) {
                return Err(Contradiction::Above(key, "velres"));
            }
        }
        if self.homing.velocity.is_some_and(|velocity| velocity.abs() > self.max_velocity) {
            return Err(Contradiction::Above("homing.velocity", "max_velocity"));
        }
        if self.homing.index_velocity.is_some_and(|velocity| velocity > self.max_velocity) {
            return Err(Contradiction::Above("homing.index_velocity", "max_velocity"));
        }
        if self.default_velocity.is_some_and(|velocity| velocity > self.max_velocity) {
            return Err(Contradiction::Above("default_velocity", "max_velocity"));
        }
        if self.default_acceleration.is_some_and(|acceleration| acceleration > self.max_acceleration) {
            return Err(Contradiction::Above("default_acceleration", "max_acceleration"));
        }
        if self.compensation.velocity.is_some_and(|velocity| velocity > self.max_velocity) {
            return Err(Contradiction::Above("compensation.velocity", "max_velocity"));
        }
        self.vocabularies.check(self).map_err(|(low, high)| Contradiction::Above(low, high))
    }
}

/// Contradiction between parameters of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contradiction {
    /// The value of the first key exceeds that of the second.
    Above(&'static str, &'static str),
    /// The derived value of this key is outside its range.
    OutOfRange(&'static str),
    /// The value of this key requires a feature that does not exist yet; the code names it.
    NotBuilt(&'static str, Code),
}

//! The parameters of one axis, and what follows from them.

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

/// Largest velocity, acceleration and jerk (inc/s, ..).
const MOST: f64 = 1e15;

/// Values of the rows that an axis changes by itself ([`Row::by_axis`]).
pub(crate) type ValuesByAxis = [Value; BY_AXIS.len()];

/// The parameters of one axis, in the core's units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisParameters {
    /// Software limit (inc).
    pub min_position: Option<i64>,
    /// Software limit (inc).
    pub max_position: Option<i64>,
    /// (inc/s)
    pub max_velocity: f64,
    /// (inc/s^2)
    pub max_acceleration: f64,
    /// (inc/s^2); left out: as `max_acceleration`.
    pub max_deceleration: Option<f64>,
    /// (inc/s^3); left out: no limit.
    pub max_jerk: Option<f64>,
    /// JERKMIN2 to 4: from the maximum acceleration to 0, from 0 to the maximum deceleration, and back (ns); 0: as `max_jerk`.
    pub jerk_times: [i64; 3],
    /// 0 to 100: what a goal may use of `max_velocity` (%).
    pub velocity_override: f64,
    /// (inc/s); left out: half of `max_velocity`.
    pub default_velocity: Option<f64>,
    /// (inc/s^2); left out: half of `max_acceleration`.
    pub default_acceleration: Option<f64>,
    /// Place in [`PROFILES`](super::PROFILES).
    pub profile: i64,
    /// (inc)
    pub max_following_error: i64,
    /// (ns)
    pub following_error_time: i64,
    /// (inc)
    pub in_position_window: i64,
    /// (ns)
    pub in_position_time: i64,
    /// ERRCOND 0 to 5.
    pub error_reaction: i64,
    /// Gear factor, master side.
    pub sync_master: i64,
    /// Gear factor, slave side.
    pub sync_slave: i64,
    /// Accuracy window of the coupling (inc); negative: the error is shown with its sign.
    pub sync_accuracy: i64,
    /// What it does with its master.
    pub sync: Synchronization,
    /// Marks of it and its master.
    pub marks: Marks,
    /// How long a streamed setpoint holds (ns).
    pub setpoint_timeout: i64,
    /// Place in [`PROBE_INPUTS`](super::PROBE_INPUTS).
    pub probe_active_input: i64,
    /// How the axis gets its zero.
    pub homing: Homing,
    /// Where positions come from.
    pub encoder: Encoders,
    /// Inputs that are assigned to its switches.
    pub assigned: Assigned,
    /// How it is watched.
    pub supervision: Supervision,
    /// Outputs that are assigned to it.
    pub outputs: AssignedOutputs,
    /// How its two drives are held together, where it has two.
    pub gantry: GantryParameters,
    /// What its drive is asked for beyond its command.
    pub compensation: Compensation,
    /// What MACS gives relative to others.
    pub macs: Macs,
    /// The position loop that is closed here.
    pub position_loop: PositionLoop,
    /// The gains of that loop where it is a PID.
    pub pid: PidGains,
    /// The loops below it, where the drive takes efforts.
    pub amplifier: Amplifier,
    /// The current loop below those, where the drive takes voltages.
    pub power_stage: PowerStage,
    /// Of the vocabularies.
    pub vocabularies: Vocabularies,
}

impl AxisParameters {
    /// Defaults of all rows; the required ones have to follow.
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

    /// Whether a function that they switch on needs every cycle of the axis in full ([`Row::full_cycles`]).
    pub(crate) fn needs_full_cycles(&self) -> bool {
        FULL_CYCLES.iter().any(|row| row.full_cycles.is_some_and(|needs| needs(self)))
    }

    /// (inc/s^2)
    pub fn deceleration_limit(&self) -> f64 {
        self.max_deceleration.unwrap_or(self.max_acceleration)
    }

    /// Velocity of a goal that gives none (inc/s).
    pub fn usual_velocity(&self) -> f64 {
        self.default_velocity.unwrap_or(self.max_velocity / 2.0)
    }

    /// Acceleration of a goal that gives none (inc/s^2).
    pub fn usual_acceleration(&self) -> f64 {
        self.default_acceleration.unwrap_or(self.max_acceleration / 2.0)
    }

    /// Deceleration of a goal that gives none: the same share of its maximum as the acceleration (MACS-PROF-06 gives
    /// both in parts of the maximum) (inc/s^2).
    pub fn usual_deceleration(&self) -> f64 {
        self.deceleration_limit() * (self.usual_acceleration() / self.max_acceleration)
    }

    /// Shape of the ramps with a highest jerk (inc/s^3) (MACS-PROF-07). The four jerks keep their ratios (MACS-PROF-11).
    pub fn shape(&self, jerk: f64) -> Shape {
        match self.profile {
            1 => Shape::SRamp,
            2 => {
                let share = self.max_jerk.map_or(1.0, |most| jerk / most);
                // JERKMIN2 to 4 are times from 0 to the maximum acceleration; 0 takes the value of JERKMIN.
                let of = |time: i64| if time == 0 { jerk } else { self.max_acceleration / (time as f64 / 1e9) * share };
                let [fall, brake_rise, brake_fall] = self.jerk_times.map(of);
                Shape::Jerk(Jerks { rise: jerk, fall, brake_rise, brake_fall })
            }
            _ => Shape::Trapezoid,
        }
    }

    /// Shape with the largest jerk; without one the jerk is free: a trapezoid.
    fn largest_shape(&self) -> Shape {
        self.max_jerk.map_or(self.shapeless(), |jerk| self.shape(jerk))
    }

    /// Shape of a goal that gives no jerk: half of the largest one, as for its other rates.
    pub fn usual_shape(&self) -> Shape {
        self.max_jerk.map_or(self.shapeless(), |jerk| self.shape(jerk / 2.0))
    }

    fn shapeless(&self) -> Shape {
        if self.profile == 1 { Shape::SRamp } else { Shape::Trapezoid }
    }

    /// Limits of a goal that gives none.
    pub fn usual_limits(&self) -> Limits {
        Limits {
            velocity: self.usual_velocity(),
            acceleration: self.usual_acceleration(),
            deceleration: self.usual_deceleration(),
            shape: self.usual_shape(),
        }
    }

    /// Limits at their maxima: stops of limits and errors use them (MACS-PROF-13).
    pub fn largest_limits(&self) -> Limits {
        Limits {
            velocity: self.max_velocity,
            acceleration: self.max_acceleration,
            deceleration: self.deceleration_limit(),
            shape: self.largest_shape(),
        }
    }

    /// Is every value one that its row takes, and do they agree?
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
        // A new coordinate may have taken them beyond the numbers of MACS.
        let is_place = |limit: i64| Position::whole(limit).is_legal();
        let takes = |key, value| Row::find(key).is_some_and(|(_, row)| row.check(value).is_ok());
        ROWS.iter().filter(|row| row.is_stored()).all(is_good)
            && given.into_iter().all(|(key, value)| value.is_none_or(|value| takes(key, value)))
            && is_place(macs.neglimit)
            && is_place(macs.poslimit)
            && self.is_derived()
            && self.check().is_ok()
    }

    /// Do the values agree?
    ///
    /// # Errors
    /// The first contradiction.
    pub fn check(&self) -> Result<(), Contradiction> {
        // A value that follows from others may leave its range.
        for (key, value) in [
            ("max_velocity", Some(self.max_velocity)),
            ("max_acceleration", Some(self.max_acceleration)),
            ("max_jerk", self.max_jerk),
            ("default_velocity", self.default_velocity),
            ("default_acceleration", self.default_acceleration),
            ("homing.index_velocity", self.homing.index_velocity),
            ("homing.acceleration", self.homing.acceleration),
        ] {
            if value.is_some_and(|value| !(value > 0.0 && value <= MOST)) {
                return Err(Contradiction::OutOfRange(key));
            }
        }
        if self.turns_loops_apart() && !self.has_velocity_encoder() {
            return Err(Contradiction::NotBuilt("posdrct", Code::NO_VELOCITY_LOOP));
        }
        self.encoder.check().map_err(|(key, code)| Contradiction::NotBuilt(key, code))?;
        if self.encoder.kind == 1 && !(0..=2).contains(&self.encoder.reference_or_parity) {
            return Err(Contradiction::NotBuilt(vocabularies::REFERENCE_OR_PARITY, Code::WF_NO_PARITY));
        }
        if !self.reversing().is_built() {
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
        // Parts of VELRES, named as they were given.
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

/// Parameters of an axis that cannot stand together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contradiction {
    /// The first key's value is above that of the second, which it must not be.
    Above(&'static str, &'static str),
    /// The value of this key, which follows from others, lies outside its range.
    OutOfRange(&'static str),
    /// The value of this key asks for something that does not exist yet; the code says what.
    NotBuilt(&'static str, Code),
}

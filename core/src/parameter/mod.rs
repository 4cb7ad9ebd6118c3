//! The catalogue: every parameter of an axis once, as a row.
//!
//! What a cell may say, what is checked, what ROS declares and what the documentation lists derives from the rows. Values
//! are kept in increments; units exist only at the border. The rows so far are those that the core acts on.

mod convert;
mod rows;

pub use convert::{ConvertError, ParameterInput, convert};
pub use rows::ROWS;

use crate::event::Number;
use crate::object::Object;
use crate::profile::{Jerks, Limits, Shape};
use crate::vocabulary::{amc, saia, wf};
use serde::{Deserialize, Serialize};

/// Which profile an axis uses.
pub const PROFILES: &[&str] = &["trapezoid", "s_ramp", "jerk"];

/// What a parameter measures, and so how it is kept and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A position (inc), whole, signed.
    Position,
    /// A distance (inc), whole, not negative.
    Distance,
    /// (inc/s)
    Velocity,
    /// (inc/s^2)
    Acceleration,
    /// (inc/s^3)
    Jerk,
    /// (ns)
    Time,
    /// A plain whole number.
    Integer,
    /// A plain number.
    Number,
    /// One of some names; the number is the place in the list.
    Choice(&'static [&'static str]),
}

/// A parameter's value in the core's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Left out: what that means stands in the row.
    Unset,
    /// Whole numbers: positions, distances, times, integers, choices.
    Int(i64),
    /// Velocities and their derivatives.
    Real(f64),
}

/// When a new value takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// In the cycle in which it is set.
    AtOnce,
    /// With the next motion command; a running motion keeps what it started with.
    NextMotion,
    /// With the next synchronize.
    NextSynchronize,
    /// With the next SAIA command that reads it.
    NextSaiaCommand,
}

impl Effect {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Effect::AtOnce => "at once",
            Effect::NextMotion => "with the next motion command",
            Effect::NextSynchronize => "with the next synchronize",
            Effect::NextSaiaCommand => "with the next SAIA command that reads it",
        }
    }
}

/// Permitted values, in the core's units; both ends belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// For whole numbers.
    Int(i64, i64),
    /// For reals: above 0 up to this.
    PositiveUpTo(f64),
    /// For reals: between these.
    Real(f64, f64),
}

/// What a bare number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bare {
    /// m or rad, and their derivatives by s.
    Si,
    /// The axis unit, and its derivatives by s: the user unit of the sources.
    AxisUnit,
    /// The axis unit per ms.
    AxisUnitPerMs,
    /// For times: ms.
    Milliseconds,
}

/// One parameter.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Native name, the key in a cell and the end of the ROS parameter's name.
    pub key: &'static str,
    /// The source's name for the same value; empty where it has none.
    pub mnemonic: &'static str,
    /// The source's number; 0 without a mnemonic.
    pub number: u16,
    /// What it measures.
    pub measure: Measure,
    /// Permitted values.
    pub range: Range,
    /// What a bare number means.
    pub bare: Bare,
    /// Value when the cell leaves it out.
    pub default: Value,
    /// What the default means, where it is not a plain value.
    pub default_text: &'static str,
    /// Must a cell give it?
    pub required: bool,
    /// When a new value takes effect.
    pub effect: Effect,
    /// Largest choice that is built; what lies above is refused by name.
    pub built: Option<i64>,
    /// What it is for.
    pub description: &'static str,
    /// Requirement.
    pub source: &'static str,
    /// Reads it.
    pub get: fn(&AxisParameters) -> Value,
    /// Writes it; the value is of the row's type.
    set: fn(&mut AxisParameters, Value),
}

/// Why a value is refused by its row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// Outside the range of the row, or not finite.
    OutOfRange,
    /// A choice that this version does not have.
    NotBuilt,
    /// A whole number for a real, or the other way round; or nothing where a value is needed.
    WrongType,
}

impl Row {
    /// The row of that key.
    pub fn find(key: &str) -> Option<(u16, &'static Row)> {
        ROWS.iter().enumerate().find(|(_, row)| row.key == key).map(|(index, row)| (index as u16, row))
    }

    /// Checks a value against type, range and what is built, and sets it.
    ///
    /// # Errors
    /// What of these fails; nothing is changed then.
    pub fn assign(&self, parameters: &mut AxisParameters, value: Value) -> Result<(), Refused> {
        match (value, self.range) {
            (Value::Int(number), Range::Int(low, high)) => {
                if !(low..=high).contains(&number) {
                    return Err(Refused::OutOfRange);
                }
                if self.built.is_some_and(|built| number > built) {
                    return Err(Refused::NotBuilt);
                }
            }
            (Value::Real(number), Range::PositiveUpTo(high)) => {
                // NaN fails both comparisons.
                if !(number > 0.0 && number <= high) {
                    return Err(Refused::OutOfRange);
                }
            }
            (Value::Real(number), Range::Real(low, high)) => {
                if !(low..=high).contains(&number) {
                    return Err(Refused::OutOfRange);
                }
            }
            (Value::Unset, _) if self.default == Value::Unset && !self.required => {}
            _ => return Err(Refused::WrongType),
        }
        (self.set)(parameters, value);
        Ok(())
    }
}

/// A value for one parameter of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The axis.
    pub axis: u16,
    /// Place in [`ROWS`].
    pub row: u16,
    /// The new value.
    pub value: Value,
}

impl Change {
    /// The axis as an object.
    pub fn object(&self) -> Object {
        Object::Axis(self.axis)
    }

    /// The value with its meaning, for an event.
    pub fn number(&self) -> Number {
        let measure = ROWS.get(usize::from(self.row)).map(|row| row.measure);
        match (self.value, measure) {
            (Value::Unset, _) | (_, None) => Number::None,
            (Value::Int(value), Some(Measure::Position | Measure::Distance)) => Number::Position(value),
            (Value::Int(value), Some(Measure::Time)) => Number::Time(value),
            (Value::Int(value), _) => Number::Count(value),
            (Value::Real(value), Some(Measure::Acceleration)) => Number::Acceleration(value),
            (Value::Real(value), Some(Measure::Jerk)) => Number::Jerk(value),
            (Value::Real(value), Some(Measure::Number)) => Number::Real(value),
            (Value::Real(value), _) => Number::Velocity(value),
        }
    }
}

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
    /// Place in [`PROFILES`].
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
    /// How long a streamed setpoint holds (ns).
    pub setpoint_timeout: i64,
    /// Of the reference selector.
    pub amc: amc::Parameters,
    /// Of the command flags.
    pub saia: saia::Parameters,
    /// Of the positioning modules.
    pub wf: wf::Parameters,
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
            setpoint_timeout: 0,
            amc: amc::Parameters::default(),
            saia: saia::Parameters::default(),
            wf: wf::Parameters::default(),
        };
        for row in ROWS.iter().filter(|row| !row.required) {
            (row.set)(&mut parameters, row.default);
        }
        parameters
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
        let mut copy = *self;
        ROWS.iter().all(|row| row.assign(&mut copy, (row.get)(self)).is_ok()) && self.check().is_ok()
    }

    /// The pair of keys that contradict each other, if any.
    ///
    /// # Errors
    /// The two keys: the first one is above the second, which it must not be.
    pub fn check(&self) -> Result<(), (&'static str, &'static str)> {
        if let (Some(low), Some(high)) = (self.min_position, self.max_position)
            && low >= high
        {
            return Err(("min_position", "max_position"));
        }
        if self.default_velocity.is_some_and(|velocity| velocity > self.max_velocity) {
            return Err(("default_velocity", "max_velocity"));
        }
        if self.default_acceleration.is_some_and(|acceleration| acceleration > self.max_acceleration) {
            return Err(("default_acceleration", "max_acceleration"));
        }
        self.wf.check(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters() -> AxisParameters {
        AxisParameters::new(1000.0, 5000.0)
    }

    #[test]
    fn every_default_lies_in_its_range_and_reads_back() {
        for row in ROWS.iter().filter(|row| !row.required) {
            let mut parameters = parameters();
            assert_eq!((row.get)(&parameters), row.default, "{}", row.key);
            assert_eq!(row.assign(&mut parameters, row.default), Ok(()), "{}", row.key);
            assert!(!row.description.is_empty() && !row.source.is_empty(), "{}", row.key);
        }
    }

    #[test]
    fn keys_and_source_numbers_stand_once() {
        for (index, row) in ROWS.iter().enumerate() {
            let later = &ROWS[index + 1..];
            assert!(later.iter().all(|other| other.key != row.key), "{}", row.key);
            let named = !row.mnemonic.is_empty();
            assert!(!named || later.iter().all(|other| other.mnemonic != row.mnemonic), "{}", row.mnemonic);
        }
    }

    #[test]
    fn every_row_holds_its_range_and_changes_nothing_when_it_refuses() {
        for row in ROWS {
            let before = parameters();
            let mut after = before;
            let (good, bad): (Vec<Value>, Vec<Value>) = match row.range {
                Range::Int(low, high) => (
                    vec![Value::Int(low), Value::Int(row.built.unwrap_or(high))],
                    vec![Value::Int(low.saturating_sub(1)), Value::Int(high.saturating_add(1)), Value::Real(1.0)],
                ),
                Range::PositiveUpTo(high) => (
                    vec![Value::Real(high), Value::Real(1e-9)],
                    vec![
                        Value::Real(0.0),
                        Value::Real(-1.0),
                        Value::Real(f64::NAN),
                        Value::Real(high * 2.0),
                        Value::Int(1),
                    ],
                ),
                Range::Real(low, high) => (
                    vec![Value::Real(low), Value::Real(high)],
                    vec![
                        Value::Real(low - low.abs().max(1.0)),
                        Value::Real(high * 2.0),
                        Value::Real(f64::NAN),
                        Value::Real(f64::INFINITY),
                        Value::Int(1),
                    ],
                ),
            };
            for value in bad {
                assert!(row.assign(&mut after, value).is_err(), "{} takes {value:?}", row.key);
                assert_eq!(after, before, "{}", row.key);
            }
            for value in good {
                assert_eq!(row.assign(&mut after, value), Ok(()), "{}", row.key);
                assert_eq!((row.get)(&after), value, "{}", row.key);
            }
        }
    }

    /// Proves: MACS-PROF-06
    #[test]
    fn defaults_are_half_of_the_maximum_and_deceleration_takes_the_share_of_acceleration() {
        let mut p = parameters();
        p.max_deceleration = Some(2000.0);
        assert_eq!((p.usual_velocity(), p.usual_acceleration(), p.usual_deceleration()), (500.0, 2500.0, 1000.0));
        p.default_acceleration = Some(5000.0);
        assert_eq!(p.usual_deceleration(), 2000.0);
    }

    #[test]
    fn contradictions_are_named() {
        let mut p = parameters();
        (p.min_position, p.max_position) = (Some(5), Some(5));
        assert_eq!(p.check(), Err(("min_position", "max_position")));
        p = parameters();
        p.default_velocity = Some(1001.0);
        assert_eq!(p.check(), Err(("default_velocity", "max_velocity")));
    }
}

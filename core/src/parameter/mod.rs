//! Catalogue of parameters: one row for each.
//!
//! The keys of cells, the checks, the ROS parameters, the storage and the documentation are derived from the rows.
//! Values are in increments; units exist only at the interfaces. A row whose function is not implemented yet says what
//! is missing, and accepts only its default.

pub mod amc;
mod amplifier;
mod axis;
mod border;
mod compensation;
mod convert;
mod direction;
mod encoder;
mod gantry;
mod homing;
mod layers;
mod machine;
mod macs;
mod marks;
mod position_loop;
mod power_stage;
mod row;
mod rows;
pub mod saia;
mod supervision;
mod synchronization;
mod virtual_master;
pub mod vocabularies;
pub mod wf;
mod words;

pub use amplifier::{Amplifier, ESTIMATORS, VelocityEncoder};
pub(crate) use axis::ValuesByAxis;
pub use axis::{AxisParameters, Contradiction};
pub use border::{BorderRange, BorderType, BorderValue};
pub use compensation::Compensation;
pub use convert::{ConvertError, ParameterInput, convert};
pub use direction::{CountDirection, Polarity, Reversing, ReversingRule};
pub use encoder::Encoders;
pub use gantry::GantryParameters;
pub use homing::{Assigned, AssignedOutputs, Homing, HomingParts};
pub use layers::{Layer, ParameterImage, Sets};
pub use machine::MachineParameters;
pub use macs::Macs;
pub use marks::{MarkSignal, Marks};
pub use position_loop::PositionLoop;
pub use power_stage::PowerStage;
pub use row::{Applies, Bare, Effect, Group, Measure, Range, Refused, Row, Storage, System, Value};
pub use rows::ROWS;
pub use supervision::{FOLLOWING_ERROR_CHECKS, JOG_AT_LIMIT, Supervision};
pub use synchronization::{OffsetRates, Synchronization};
pub use virtual_master::{Marker, VirtualMasterProblem};
pub use vocabularies::Vocabularies;
pub use words::{Equivalent, Word};

use crate::event::Number;
use crate::object::Object;

/// Profiles of an axis.
pub const PROFILES: &[&str] = &["trapezoid", "s_ramp", "jerk"];

/// Behaviour of a probe whose input already has the level of its edge.
pub const PROBE_INPUTS: &[&str] = &["refuse", "allow"];

/// Value of [`Change::axis`] for the machine.
pub const MACHINE: u16 = u16::MAX;

/// New value of a parameter of an axis, or of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Index of the axis; [`MACHINE`] for a parameter of the machine.
    pub axis: u16,
    /// Index in [`ROWS`].
    pub row: u16,
    /// The new value.
    pub value: Value,
}

impl Change {
    /// Returns the object of the parameter.
    pub fn object(&self) -> Object {
        if self.axis == MACHINE { Object::Machine } else { Object::Axis(self.axis) }
    }

    /// Returns the row.
    pub fn row(&self) -> Option<&'static Row> {
        ROWS.get(usize::from(self.row))
    }

    /// Returns the value with its meaning, for an event.
    pub fn number(&self) -> Number {
        let measure = self.row().map(|row| row.measure);
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

/// Returns the changes of a set in the order in which they apply: a parameter on which others depend comes first.
pub fn in_order(changes: &[Change]) -> impl Iterator<Item = &Change> {
    let is_first = |change: &&Change| change.row == rows::SENSE_ROW;
    changes.iter().filter(is_first).chain(changes.iter().filter(move |change| !is_first(change)))
}

#[cfg(test)]
mod tests;

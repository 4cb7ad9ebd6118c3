//! Conversion of requests that set the zero of an axis.

use super::{Amount, RequestError, Units};
use crate::command::{
    Action, HomeAxis, HomingMethod, MasterPosition, SetEncoderPosition, SetMasterPosition, SetPosition, ShiftPosition,
};
use crate::config::MachineConfig;
use crate::unit::Scale;

/// A request to home one axis, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HomeRequest {
    /// Name of the axis.
    pub axis: String,
    /// 0 as configured, 1 by a number of CiA 402, 2 by a HOME_TYPE of MACS.
    pub scheme: u8,
    /// The number, if the scheme has one.
    pub method: i8,
}

/// A request to set a position, by name and with units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SetPositionRequest {
    /// An axis; or an entry of `encoders`; or `axis.master`, the master position of the axis.
    pub axis: String,
    /// New value of the position.
    pub position: Amount,
    /// Unit of a number without a unit.
    pub units: Units,
}

impl MachineConfig {
    /// Converts a homing request to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_home(&self, request: &HomeRequest) -> Result<HomeAxis, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let method = match request.scheme {
            0 if request.method == 0 => HomingMethod::Configured,
            // A method that is ignored would cause an unexpected motion.
            0 => {
                let allowed = "0 is allowed with scheme CONFIGURED; CIA402 and MACS take a number";
                return Err(RequestError::BadChoice { field: "method", value: request.method.into(), allowed });
            }
            1 => HomingMethod::Cia402(request.method),
            2 => HomingMethod::Macs(request.method),
            other => {
                let allowed = "0 CONFIGURED, 1 CIA402, 2 MACS are allowed";
                return Err(RequestError::BadChoice { field: "scheme", value: other.into(), allowed });
            }
        };
        Ok(HomeAxis { axis, method })
    }

    /// Converts a distance to add to the positions of an axis to a command.
    ///
    /// # Errors
    /// An error in the request itself: encoders and masters can only be set to a new value.
    pub fn resolve_shift_position(&self, request: &SetPositionRequest) -> Result<Action, RequestError> {
        let (axis, config) = self.find_axis(&request.axis)?;
        let distance = request
            .position
            .length(request.units, &config.scale)
            .map_err(|error| super::bad_value("position", error))?;
        Ok(Action::ShiftPosition(ShiftPosition { axis, distance }))
    }

    /// Converts a new value of a position to a command: of an axis, of an entry of `encoders`, or of the master of an
    /// axis (`x.master`).
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_set_position(&self, request: &SetPositionRequest) -> Result<Action, RequestError> {
        let bad = |error| RequestError::BadValue { field: "position".to_owned(), error: Box::new(error) };
        let length = |scale: &Scale| request.position.length(request.units, scale).map_err(bad);
        if let Some(encoder) = self.encoders.iter().position(|encoder| encoder.name == request.axis) {
            let position = length(&self.encoders[encoder].scale)?;
            return Ok(Action::SetEncoderPosition(SetEncoderPosition { encoder: encoder as u16, position }));
        }
        if let Some(axis) = request.axis.strip_suffix(".master") {
            let (axis, _) = self.find_axis(axis)?;
            let position = match (request.position, request.units) {
                (Amount::Number(number), Units::AxisUnit) => {
                    request.position.length(Units::Increments, &Scale::increments()).map_err(bad)?;
                    // Far less than 2^-32 inc in any master unit, and more digits than a recording contains.
                    MasterPosition::Shown(if number.abs() < 1e-20 { 0.0 } else { number })
                }
                // A master position has no SI unit: the master may be an axis or an encoder of any scale. 0 is 0 in all
                // of them.
                (Amount::Number(number), Units::Si) if number.is_finite() && number != 0.0 => {
                    let allowed = "1 AXIS_UNIT (as x.master.position shows it), 2 INCREMENTS are allowed for a master";
                    return Err(RequestError::BadChoice { field: "units", value: 0, allowed });
                }
                (Amount::Quantity(_) | Amount::Number(_), _) => {
                    let position = request.position.length(Units::Increments, &Scale::increments()).map_err(bad)?;
                    MasterPosition::Increments(position)
                }
            };
            return Ok(Action::SetMasterPosition(SetMasterPosition { axis, position }));
        }
        let (axis, config) = self.find_axis(&request.axis)?;
        Ok(Action::SetPosition(SetPosition { axis, position: length(&config.scale)? }))
    }
}

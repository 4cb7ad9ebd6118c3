//! Requests that give an axis its zero.

use super::{Amount, RequestError, Units};
use crate::command::{HomeAxis, HomingMethod, SetPosition};
use crate::config::MachineConfig;

/// Homing of one axis by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HomeRequest {
    /// Axis.
    pub axis: String,
    /// 0 as configured, 1 by a number of CiA 402, 2 by a HOME_TYPE of MACS.
    pub scheme: u8,
    /// The number, where the scheme has one.
    pub method: i8,
}

/// A new value of a position, by name and with units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SetPositionRequest {
    /// Axis.
    pub axis: String,
    /// What its position is from now on.
    pub position: Amount,
    /// Units of a bare number.
    pub units: Units,
}

impl MachineConfig {
    /// Homing as a command's content.
    ///
    /// # Errors
    /// What is wrong in the request itself.
    pub fn resolve_home(&self, request: &HomeRequest) -> Result<HomeAxis, RequestError> {
        let (axis, _) = self.find_axis(&request.axis)?;
        let method = match request.scheme {
            0 if request.method == 0 => HomingMethod::Configured,
            // Who names a method and gets another one is surprised by a motion.
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

    /// A new value of a position as a command's content.
    ///
    /// # Errors
    /// What is wrong in the request itself.
    pub fn resolve_set_position(&self, request: &SetPositionRequest) -> Result<SetPosition, RequestError> {
        let (axis, config) = self.find_axis(&request.axis)?;
        let length = request.position.length(request.units, &config.scale);
        let position =
            length.map_err(|error| RequestError::BadValue { field: "position".to_owned(), error: Box::new(error) })?;
        Ok(SetPosition { axis, position })
    }
}

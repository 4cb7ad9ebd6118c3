//! Conversion of requests that set the zero of an axis.

use super::choice::unknown;
use super::{Amount, Named, Presence, RequestError, UnitOf, Units, Verb, VerbFields};
use crate::command::{
    Action, HomeAxis, HomingMethod, MasterPosition, SetEncoderPosition, SetMasterPosition, SetPosition, ShiftPosition,
};
use crate::config::MachineConfig;
use crate::object::Object;
use crate::unit::Scale;

const SCHEMES: [&str; 3] = ["configured", "cia402", "macs"];

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
    /// Whether the position is a distance that is added to the positions of an axis.
    pub relative: bool,
}

impl HomeRequest {
    /// Returns the request of a command.
    pub(super) fn of(command: &HomeAxis, config: &MachineConfig) -> Self {
        let (scheme, method) = match command.method {
            HomingMethod::Configured => (0, 0),
            HomingMethod::Cia402(method) => (1, method),
            HomingMethod::Macs(method) => (2, method),
        };
        Self { axis: config.name_or_nameless(Object::Axis(command.axis)), scheme, method }
    }
}

impl Verb for HomeRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.id();
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.choice("scheme", &SCHEMES, Presence::Optional, &mut self.scheme);
        let presence = if self.scheme == 0 { Presence::Optional } else { Presence::Written };
        let mut method = self.method.into();
        fields.whole("method", i8::MIN.into()..=i8::MAX.into(), presence, &mut method);
        self.method = method as i8;
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_home(self).map(Action::HomeAxis)
    }

    fn place(&self, error: &RequestError) -> Option<&'static str> {
        matches!(error, RequestError::UnknownAxis { .. }).then_some("axis")
    }

    fn hint(&self, error: &RequestError) -> Option<&'static str> {
        // In most cases a method without a scheme is a number of CiA 402.
        matches!(error, RequestError::BadChoice { field: "method", .. }).then_some("write `scheme: cia402`")
    }
}

impl SetPositionRequest {
    /// Returns the request of a command, in increments; `None` for another command.
    pub(super) fn of(command: &Action, config: &MachineConfig) -> Option<Self> {
        let axis = |index| config.name_or_nameless(Object::Axis(index));
        let request = |axis, position| Self { axis, position: Amount::Increments(position), ..Self::default() };
        Some(match command {
            Action::SetPosition(command) => request(axis(command.axis), command.position),
            Action::ShiftPosition(command) => Self { relative: true, ..request(axis(command.axis), command.distance) },
            Action::SetEncoderPosition(command) => {
                request(config.name_or_nameless(Object::Encoder(command.encoder)), command.position)
            }
            Action::SetMasterPosition(command) => {
                let name = format!("{}.master", axis(command.axis));
                match command.position {
                    MasterPosition::Increments(position) => request(name, position),
                    MasterPosition::Shown(value) => {
                        Self { axis: name, position: Amount::Number(value), units: Units::AxisUnit, relative: false }
                    }
                }
            }
            _ => return None,
        })
    }
}

impl Verb for SetPositionRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.list_in_order(&["axis", "units", "position", "relative"]);
        fields.name("axis", Named::Position, Presence::Required, &mut self.axis);
        fields.boolean("relative", false, &mut self.relative);
        fields.units(&mut self.units);
        fields.amount("position", 0, UnitOf::Axis, Presence::Written, &mut self.position);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_set_position(self)
    }

    fn place(&self, error: &RequestError) -> Option<&'static str> {
        match error {
            RequestError::UnknownAxis { .. } => Some("axis"),
            RequestError::BadValue { .. } => Some("position"),
            _ => None,
        }
    }
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
            other => return Err(unknown("scheme", other, &SCHEMES)),
        };
        Ok(HomeAxis { axis, method })
    }

    /// Converts a new value of a position to a command: of an axis, of an entry of `encoders`, or of the master of an
    /// axis (`x.master`).
    ///
    /// # Errors
    /// An error in the request itself: a distance can only be added to the positions of an axis.
    pub fn resolve_set_position(&self, request: &SetPositionRequest) -> Result<Action, RequestError> {
        let bad = |error| RequestError::BadValue { field: "position".to_owned(), error: Box::new(error) };
        let length = |scale: &Scale| request.position.length(request.units, scale).map_err(bad);
        if request.relative {
            let (axis, config) = self.find_axis(&request.axis)?;
            return Ok(Action::ShiftPosition(ShiftPosition { axis, distance: length(&config.scale)? }));
        }
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
                (Amount::Number(_) | Amount::Quantity(_) | Amount::Increments(_) | Amount::IncrementsPerTime(_), _) => {
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

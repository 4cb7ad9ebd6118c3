//! Checks of fields that have no effect in a request.
//!
//! Law      a value that would be accepted without effect is an error; a field at its default is never an error
//! Refuses  a direction on an axis without modulo; a position with mode VELOCITY

use super::{Amount, MoveRequest, RequestError, Units, bad_value};
use crate::command::{Move, MoveMode};
use crate::config::AxisConfig;
use crate::modulo::Direction;
use crate::position::Length;
use crate::unit::Scale;

/// Checks that each field of a positioning goal has an effect on that axis.
pub(super) fn check_move(request: &MoveRequest, resolved: &Move, axis: &AxisConfig) -> Result<(), RequestError> {
    if resolved.direction != Direction::Shortest && axis.modulo.is_none() {
        let allowed = "0 SHORTEST is allowed, as the axis has no modulo";
        return Err(RequestError::BadChoice { field: "direction", value: request.direction.into(), allowed });
    }
    if resolved.mode == MoveMode::Velocity && resolved.target != Length::whole(0) {
        let allowed = "0 is allowed with mode VELOCITY, which has no target";
        return Err(unused_length_error("position", request.position, request.units, &axis.scale, allowed));
    }
    Ok(())
}

/// Returns the error of a length without effect.
pub(super) fn unused_length_error(
    field: &'static str,
    given: Amount,
    units: Units,
    scale: &Scale,
    allowed: &'static str,
) -> RequestError {
    match given.quantity(units, scale, 0) {
        Ok(quantity) => RequestError::NoMeaning { field, value: format!("`{quantity}`"), allowed },
        Err(error) => bad_value(field, error),
    }
}

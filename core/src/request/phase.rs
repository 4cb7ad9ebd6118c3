//! Conversion of phase shifts.
//!
//! Law      side SLAVE: in the units of the axis. Side MASTER: in the units of its leader, which the machine determines
//!          when it executes the command: the amounts are converted to the increments of every scale that a leader of
//!          the cell has
//! Reads    the names of the cell, the scales of its leaders
//! Refuses  amounts that fit no leader of the cell
//! Source   contract section 10, PLCopen (MC_PhasingRelative)

use super::{Amount, RequestError, Units, bad_value};
use crate::command::{Phase, PhaseShift, PhaseSide};
use crate::config::MachineConfig;
use crate::unit::{Scale, fraction_from_f64, fraction_to_f64};

/// A phase shift with names and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseRequest {
    /// Name of the following axis.
    pub axis: String,
    /// 0 slave, 1 master.
    pub side: u8,
    /// Shift, signed.
    pub shift: Amount,
    /// Velocity; 0: the default.
    pub velocity: Amount,
    /// Acceleration; 0: the default.
    pub acceleration: Amount,
}

impl MachineConfig {
    /// Converts a phase shift to a command.
    ///
    /// # Errors
    /// An error in the request itself.
    pub fn resolve_phase(&self, request: &PhaseRequest) -> Result<Phase, RequestError> {
        let (index, axis) = self.find_axis(&request.axis)?;
        let side = match request.side {
            0 => PhaseSide::Slave(resolve(request, &axis.scale)?),
            1 => {
                let (mut by_scale, mut refused) = (Vec::new(), None);
                for scale in self.leading_scales() {
                    match resolve(request, &scale) {
                        Ok(shift) => by_scale.push((scale, shift)),
                        Err(error) => refused = refused.or(Some(error)),
                    }
                }
                if let (true, Some(error)) = (by_scale.is_empty(), refused) {
                    return Err(error);
                }
                let given = [request.shift, request.velocity, request.acceleration].map(exact_decimal);
                PhaseSide::Master { given, by_scale: by_scale.into() }
            }
            other => {
                let allowed = "0 SLAVE, 1 MASTER are allowed";
                return Err(RequestError::BadChoice { field: "side", value: other.into(), allowed });
            }
        };
        Ok(Phase { axis: index, side })
    }

    /// Returns each scale of a leader in the cell, once.
    fn leading_scales(&self) -> Vec<Scale> {
        let axes = self.axes.iter().map(|axis| axis.scale);
        let encoders = self.encoders.iter().map(|encoder| encoder.scale);
        let mut scales = vec![];
        for scale in axes.chain(encoders).chain([Scale::increments()]) {
            if !scales.contains(&scale) {
                scales.push(scale);
            }
        }
        scales
    }
}

/// Converts a number without a unit to the decimal that was written: only rounding errors of f64 are removed.
fn exact_decimal(amount: Amount) -> Amount {
    match amount {
        Amount::Number(number) => {
            Amount::Number(fraction_from_f64(number).map_or(number, |exact| fraction_to_f64(&exact)))
        }
        Amount::Quantity(_) => amount,
    }
}

fn resolve(request: &PhaseRequest, scale: &Scale) -> Result<PhaseShift, RequestError> {
    let rate = |field, amount: Amount, order| {
        let rate = amount.rate(Units::Si, scale, order).map_err(|error| bad_value(field, error))?;
        if rate >= 0.0 {
            return Ok(rate);
        }
        let given = amount.quantity(Units::Si, scale, order).map_err(|error| bad_value(field, error))?;
        let allowed = "a finite number that is not negative is allowed; 0 stands for the default";
        Err(RequestError::NoMeaning { field, value: format!("`{given}`"), allowed })
    };
    Ok(PhaseShift {
        shift: request.shift.length(Units::Si, scale).map_err(|error| bad_value("shift", error))?,
        velocity: rate("velocity", request.velocity, 1)?,
        acceleration: rate("acceleration", request.acceleration, 2)?,
    })
}

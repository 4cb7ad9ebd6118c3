//! A phase shift, in names and units.
//!
//! Law      side SLAVE: in the units of the axis. Side MASTER: in those of what it follows, which the machine knows once it takes the
//!          command: the amounts are made increments of every scale that a leader of the cell has
//! Reads    the names of the cell, the scales of what can lead
//! Refuses  amounts that no leader of the cell has
//! Source   contract section 10, PLCopen (MC_PhasingRelative)

use super::{Amount, RequestError, Units, bad_value};
use crate::command::{Phase, PhaseShift, PhaseSide};
use crate::config::MachineConfig;
use crate::unit::{Scale, fraction_from_f64, fraction_to_f64};

/// A phase shift with names and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseRequest {
    /// Axis that follows.
    pub axis: String,
    /// 0 slave, 1 master.
    pub side: u8,
    /// By how much, with its sign.
    pub shift: Amount,
    /// 0: the default.
    pub velocity: Amount,
    /// 0: the default.
    pub acceleration: Amount,
}

impl MachineConfig {
    /// A phase shift as a command's content.
    ///
    /// # Errors
    /// What is wrong in the request itself.
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
                let given = [request.shift, request.velocity, request.acceleration].map(meant);
                PhaseSide::Master { given, by_scale: by_scale.into() }
            }
            other => {
                let allowed = "0 SLAVE, 1 MASTER are allowed";
                return Err(RequestError::BadChoice { field: "side", value: other.into(), allowed });
            }
        };
        Ok(Phase { axis: index, side })
    }

    /// Each scale that something in the cell leads with, once.
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

/// A bare number as the decimal that it means: what that rounds away is nothing, and was not written either.
fn meant(amount: Amount) -> Amount {
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

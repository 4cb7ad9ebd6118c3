//! Conversion of phase shifts.
//!
//! Law      side SLAVE: in the units of the axis. Side MASTER: in the units of its leader, which the machine determines
//!          when it executes the command: the amounts are converted to the increments of every scale that a leader of
//!          the cell has
//! Reads    the names of the cell, the scales of its leaders
//! Refuses  amounts that fit no leader of the cell
//! Source   contract section 10, PLCopen (MC_PhasingRelative)

use super::choice::unknown;
use super::{Amount, Named, Presence, RequestError, UnitOf, Units, Verb, VerbFields, bad_value};
use crate::command::{Action, Phase, PhaseShift, PhaseSide};
use crate::config::MachineConfig;
use crate::object::Object;
use crate::unit::{Scale, fraction_from_f64, fraction_to_f64};

const SIDES: [&str; 2] = ["slave", "master"];

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

impl PhaseRequest {
    /// Returns the request of a command: in increments, or as given if the scale of the increments depends on the leader.
    pub(super) fn of(command: &Phase, config: &MachineConfig) -> Self {
        let (side, [shift, velocity, acceleration]) = match &command.side {
            PhaseSide::Slave(PhaseShift { shift, velocity, acceleration }) => {
                let [velocity, acceleration] = [*velocity, *acceleration].map(Amount::IncrementsPerTime);
                (0, [Amount::Increments(*shift), velocity, acceleration])
            }
            PhaseSide::Master { given, .. } => (1, *given),
        };
        let axis = config.name_or_nameless(Object::Axis(command.axis));
        Self { axis, side, shift, velocity, acceleration }
    }
}

impl Verb for PhaseRequest {
    fn fields(&mut self, fields: &mut dyn VerbFields) {
        fields.id();
        fields.name("axis", Named::Axis, Presence::Required, &mut self.axis);
        fields.choice("side", &SIDES, Presence::Written, &mut self.side);
        let of = if self.side == 0 { UnitOf::Axis } else { UnitOf::Leader };
        fields.amount("shift", 0, of, Presence::Optional, &mut self.shift);
        fields.amount("velocity", 1, of, Presence::Optional, &mut self.velocity);
        fields.amount("acceleration", 2, of, Presence::Optional, &mut self.acceleration);
    }

    fn resolve(&self, config: &MachineConfig, _recorded: bool) -> Result<Action, RequestError> {
        config.resolve_phase(self).map(Action::Phase)
    }
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
            other => return Err(unknown("side", other, &SIDES)),
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
        Amount::Quantity(_) | Amount::Increments(_) | Amount::IncrementsPerTime(_) => amount,
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

//! Conversion of streamed setpoints with names and units.

use super::{Amount, RequestError, Units};
use crate::command::{Setpoint, Setpoints, Source};
use crate::config::MachineConfig;

/// The setpoint of one axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SetpointRequest {
    /// Name of the axis.
    pub axis: String,
    /// Velocity, signed.
    pub velocity: Amount,
    /// Duration (ns); `None`: until the next setpoint.
    pub duration: Option<u64>,
}

impl MachineConfig {
    /// Converts setpoints of one or more axes to the form of a cycle.
    ///
    /// # Errors
    /// No axis, an unknown or repeated axis, a velocity that is not a number.
    pub fn resolve_setpoints(
        &self,
        source: Source,
        units: Units,
        requests: &[SetpointRequest],
    ) -> Result<Setpoints, RequestError> {
        if requests.is_empty() {
            return Err(RequestError::NoSetpoint);
        }
        let mut set = Setpoints { source, ..Setpoints::none(self.axes.len()) };
        for request in requests {
            let (index, axis) = self.find_axis(&request.axis)?;
            let velocity = request.velocity.rate(units, &axis.scale, 1).map_err(|error| {
                let field = format!("velocity of {}", axis.name);
                RequestError::BadValue { field, error: Box::new(error) }
            })?;
            // No timeout is as long as 292 years, and this value can still be written as a time.
            let duration = request.duration.map(|ns| ns.min(i64::MAX as u64));
            let place = &mut set.axes[usize::from(index)];
            if place.replace(Setpoint { velocity, duration }).is_some() {
                return Err(RequestError::AxisTwice { name: axis.name.to_string() });
            }
        }
        Ok(set)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::AxisConfig;
    use crate::parameter::AxisParameters;
    use crate::unit::{Fraction, Quantity, Scale, Unit};

    fn config() -> MachineConfig {
        let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
        let scale = Scale::new(Fraction::from_integer(1000), per).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
        let axis = |name: &str| AxisConfig::new(name.into(), scale, None, AxisParameters::new(1e5, 1e6));
        MachineConfig { cycle_ns: 1_000_000, axes: vec![axis("x"), axis("y"), axis("z")], ..MachineConfig::default() }
    }

    fn of(axis: &str, velocity: f64) -> SetpointRequest {
        SetpointRequest { axis: axis.into(), velocity: Amount::Number(velocity), duration: None }
    }

    #[test]
    fn metres_per_second_become_increments_and_who_is_not_named_gets_none() {
        let for_a_while = SetpointRequest { duration: Some(50), ..of("x", 0.001) };
        let set = config().resolve_setpoints(Source::Ros, Units::Si, &[of("z", -0.02), for_a_while]).unwrap();
        let setpoint = |velocity, duration| Some(Setpoint { velocity, duration });
        assert_eq!(set.axes, [setpoint(1000.0, Some(50)), None, setpoint(-20_000.0, None)]);
        assert_eq!((set.source, set.is_empty()), (Source::Ros, false));
    }

    #[test]
    fn error_names_the_axis() {
        let sentence = |requests: &[SetpointRequest]| {
            config().resolve_setpoints(Source::Ros, Units::Si, requests).unwrap_err().to_string()
        };
        assert_eq!(sentence(&[]), "no axis is named; one or more, each with a velocity, are expected");
        assert_eq!(sentence(&[of("x", 0.0), of("x", 1.0)]), "axis `x` stands twice; once is allowed");
        assert_eq!(sentence(&[of("w", 0.0)]), "no axis is called `w`; there are x, y, z");
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(sentence(&[of("y", bad)]).starts_with("velocity of y: "), "{}", sentence(&[of("y", bad)]));
        }
    }
}

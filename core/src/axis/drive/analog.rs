//! Restrictions of an axis whose drive has only an analog voltage command.
//!
//! Law      the reference is at most 10 V. Nothing is read from the drive: neither position nor current. An axis with
//!          torque reference never leaves its stop to the drive, which would coast
//! Refuses  parameters beyond these restrictions
//! Source   MACS-CAN-01 (DRIVETYPE 0); contract section 3

use crate::axis::state::{Axis, Source, Wired};
use crate::code::Code;
use crate::drive::{AnalogWiring, Interface};
use crate::event::{Number, Refusal};
use crate::parameter::{AxisParameters, Row};

/// Checks whether an axis with such a drive may have these parameters.
///
/// # Errors
/// The key of the parameter that is not allowed, and the reason.
pub fn may_be_analog(
    analog: Option<&AnalogWiring>,
    interface: Interface,
    (wired, encoders): (Wired, usize),
    p: &AxisParameters,
) -> Result<(), (&'static str, Code)> {
    let Some(analog) = analog else { return Ok(()) };
    // The cell checks that this encoder and the reference are both real or both simulated. Other encoders are not
    // checked.
    let read = Source::of(wired, encoders, p);
    if !matches!((wired, read), (Wired::Encoder(own), Ok(Source::Encoder(place))) if own == place) {
        return Err(("encodertype", Code::ANALOG_SILENT));
    }
    if p.amplifier.encoder.is_separate() {
        return Err(("ampencno", Code::ANALOG_SILENT));
    }
    if p.amplifier.torque_constant > 0.0 {
        return Err(("torque_constant", Code::ANALOG_SILENT));
    }
    match interface {
        Interface::Velocity if p.max_velocity > analog.full => Err(("max_velocity", Code::ANALOG_FULL)),
        Interface::Torque if p.error_reaction == 4 => Err(("error_reaction", Code::ANALOG_COASTS)),
        Interface::Torque if p.amplifier.max_effort.is_some_and(|effort| effort > analog.full) => {
            Err(("max_effort", Code::ANALOG_FULL))
        }
        _ => Ok(()),
    }
}

impl Axis {
    /// Returns an error if these parameters are invalid for a drive with voltage interface.
    pub(in crate::axis) fn may_be_analog_with(&self, parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
        let sources = (self.setup.wired, self.setup.encoders);
        may_be_analog(self.setup.analog.as_ref(), self.setup.interface, sources, parameters)
    }

    /// As [`may_be_analog_with`](Self::may_be_analog_with), with the values for the refusal.
    pub(in crate::axis) fn admits_analog(&self, candidate: &AxisParameters) -> Result<(), Refusal> {
        let Err((key, code)) = self.may_be_analog_with(candidate) else { return Ok(()) };
        let full = self.setup.analog.map_or(0.0, |analog| analog.full);
        let p = &candidate.amplifier;
        let (asked, limit) = match (code, key) {
            (Code::ANALOG_FULL, "max_velocity") => (Number::Velocity(candidate.max_velocity), Number::Velocity(full)),
            (Code::ANALOG_FULL, _) => (Number::Real(p.max_effort.unwrap_or_default()), Number::Real(full)),
            (_, "ampencno") => (Number::Count(p.encoder.number), Number::None),
            (_, "error_reaction") => (Number::Count(candidate.error_reaction), Number::None),
            (_, "torque_constant") => (Number::Real(p.torque_constant), Number::None),
            _ => (Number::Count(candidate.encoder.encodertype), Number::None),
        };
        let parameter = Row::find(key).map(|(parameter, _)| parameter);
        Err(Refusal { parameter, ..Refusal::new(code, self.object()).with(asked, limit) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoder::Form;

    const WIRING: AnalogWiring = AnalogWiring { reference: 0, enable: 0, ready: None, full: 1000.0, enable_ns: 0 };

    fn check(interface: Interface, wired: Wired, change: impl FnOnce(&mut AxisParameters)) -> Option<&'static str> {
        let mut p = AxisParameters::new(1000.0, 1e6);
        p.amplifier.max_effort = Some(1000.0);
        change(&mut p);
        let checked = may_be_analog(Some(&WIRING), interface, (wired, 1), &p);
        assert_eq!(may_be_analog(None, interface, (wired, 1), &p), Ok(()));
        checked.err().map(|(key, _)| key)
    }

    #[test]
    fn full_output_is_the_largest_and_the_drive_reports_nothing() {
        let (velocity, torque) = (Interface::Velocity, Interface::Torque);
        let encoder = Wired::Encoder(0);
        assert_eq!(check(velocity, encoder, |_| {}), None);
        assert_eq!(check(torque, encoder, |_| {}), None);
        assert_eq!(check(velocity, encoder, |p| p.max_velocity = 1000.5), Some("max_velocity"));
        assert_eq!(check(torque, encoder, |p| p.max_velocity = 1000.5), None);
        assert_eq!(check(torque, encoder, |p| p.amplifier.max_effort = Some(1000.5)), Some("max_effort"));
        assert_eq!(check(torque, encoder, |p| p.amplifier.torque_constant = 0.1), Some("torque_constant"));
        assert_eq!(check(torque, encoder, |p| p.amplifier.encoder.number = 1), Some("ampencno"));
        assert_eq!(check(velocity, Wired::Drive(Form::Incremental(64)), |_| {}), Some("encodertype"));
        assert_eq!(
            check(velocity, Wired::Drive(Form::Incremental(64)), |p| p.encoder.encodertype = 10),
            Some("encodertype")
        );
        assert_eq!(check(velocity, Wired::Encoder(1), |p| p.encoder.encodertype = 10), Some("encodertype"));
        assert_eq!(check(velocity, encoder, |p| p.encoder.encodertype = 10), None);
        // The command takes the place of a position.
        assert_eq!(check(velocity, encoder, |p| p.encoder.encodertype = 9), Some("encodertype"));
        assert_eq!(check(torque, encoder, |p| p.error_reaction = 4), Some("error_reaction"));
        assert_eq!(check(velocity, encoder, |p| p.error_reaction = 4), None);
    }
}

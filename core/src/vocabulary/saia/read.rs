//! Read commands: from the registers of the module to the output registers, in units.

use super::scale::{self, Scaling};
use super::{Command, Fault, Register, Saia};
use crate::code::Code;
use crate::event::Number;
use crate::vocabulary::View;

impl Saia {
    /// Executes one read command; an output register keeps its value if the new one does not fit.
    pub(super) fn read(&mut self, command: Command, view: &View<'_>) -> Result<(), Fault> {
        let scaling = Scaling::of(&view.parameters.vocabularies.saia);
        let profile = self.profile(view);
        let shown = match command {
            Command::ReadActualPosition => scaling.units(self.position(view)),
            Command::ReadSetPosition => scaling.units(profile.position.floor().saturating_sub(self.zero)),
            Command::ReadIndex => scaling.units(self.index),
            Command::ReadActualVelocity => {
                let counts = scale::counts_a_sample(super::actual(view).1);
                scaling.units_of_velocity(counts * 65_536.0)
            }
            Command::ReadSetVelocity => scaling.units_of_velocity(scale::register_of(profile.velocity)),
            _ => Some(self.pid.integral()),
        };
        let factor = Number::Real(view.parameters.vocabularies.saia.mcfac);
        let fault = Fault { register: Some(Register::McFac), ..Fault::new(Code::SAIA_READ_OUT_OF_RANGE) };
        let shown = shown.ok_or(fault.with(factor, Number::None))?;
        let outputs = &mut self.outputs;
        match command {
            Command::ReadActualPosition => outputs.actual_position = shown,
            Command::ReadSetPosition => outputs.set_position = shown,
            Command::ReadIndex => outputs.index_position = shown,
            Command::ReadActualVelocity => outputs.actual_velocity = shown,
            Command::ReadSetVelocity => outputs.set_velocity = shown,
            _ => outputs.integral = shown,
        }
        Ok(())
    }
}

//! The master that parameters name (MENCODERTYPE), and the simulated one.
//!
//! Law      position(k) = position(k-1) + master_simulation_velocity * T, to 2^-32 inc a cycle; it counts from 0 as long as
//!          mencodertype is 6, whoever follows, and stands otherwise
//! Reads    mencodertype, master_simulation_velocity
//! Writes   a leader: nobody counts it, so it is as smooth as a command
//! Refuses  numbers that name no master here
//! Source   MACS-ENC-14, MACS-ENC-15, MACS-ENC-16, A-13, MACS-ERR-09

use super::{Axis, Context};
use crate::code::Code;
use crate::encoder::{Lead, source::Master};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Leader;
use crate::parameter::{Change, Row};
use crate::position::Position;

impl Axis {
    /// What it follows where a command names `asked`, or leaves it to MENCODERTYPE; the machine has so many axes.
    ///
    /// # Errors
    /// MENCODERTYPE names nothing that the cell has.
    pub fn leader_of(&self, asked: Option<Leader>, axes: usize) -> Result<Leader, Refusal> {
        let kind = self.parameters.encoder.mencodertype;
        let named = match Master::decode(kind) {
            Some(Master::Axis(number)) if usize::from(number) <= axes => number.checked_sub(1).map(Leader::AxisCommand),
            Some(Master::Terminal(number)) if usize::from(number) <= self.setup.encoders => {
                number.checked_sub(1).map(|place| Leader::Encoder(place.into()))
            }
            Some(Master::Simulation) => Some(Leader::Simulated(self.setup.index)),
            _ => None,
        };
        let refusal = || self.refuse(Code::NO_MASTER).with(Number::Count(kind), Number::None);
        asked.or(named).ok_or_else(refusal)
    }

    /// One cycle of its simulated master.
    pub fn simulate_master(&self, before: Lead) -> Lead {
        let p = &self.parameters.encoder;
        if Master::decode(p.mencodertype) != Some(Master::Simulation) {
            return Lead { position: before.position, ..Lead::default() };
        }
        let change = Position::from_f64(p.master_velocity * self.cycle_s());
        Lead { position: before.position + change, change, velocity: p.master_velocity, counted: false, valid: true }
    }

    /// An abort stops it (MACS-ERR-09).
    pub(super) fn stop_simulated_master(&mut self, cx: &mut Context<'_>) {
        if self.parameters.encoder.master_velocity == 0.0 {
            return;
        }
        self.parameters.encoder.master_velocity = 0.0;
        let Some((row, entry)) = Row::find("master_simulation_velocity") else { return };
        let value = entry.value(&self.parameters);
        let event = Event::new(Severity::Info, Kind::Parameter, self.object(), Code::NONE);
        let number = Change { axis: self.setup.index, row, value }.number();
        cx.events.push(Event { parameter: Some(row), ..event.with(number, Number::None) });
    }
}

//! Encoders that several axes use: what they tell, and zeros that are set for all of them.

use super::Machine;
use crate::code::Code;
use crate::encoder::Told;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::position::Position;

/// Code of what an encoder tells.
pub(super) fn code(told: Told) -> Code {
    match told {
        Told::Invalid => Code::ENCODER_INVALID,
        Told::Substituted => Code::ENCODER_SUBSTITUTED,
        Told::Pulses { .. } => Code::WF_PULSES,
    }
}

/// The event of it.
pub(super) fn event(told: Told, encoder: u16, errors: u64) -> Event {
    let (severity, kind) = match told {
        Told::Substituted => (Severity::Warn, Kind::Warning),
        _ => (Severity::Error, Kind::Error),
    };
    let event = Event::new(severity, kind, Object::Encoder(encoder), code(told));
    match told {
        Told::Invalid => event,
        Told::Substituted => event.with(Number::Count(errors.min(i64::MAX as u64).cast_signed()), Number::None),
        Told::Pulses { by, tolerance } => event.with(Number::Position(by), Number::Position(tolerance)),
    }
}

impl Machine {
    /// A zero that moves an encoder is refused while another axis that uses it moves.
    pub(super) fn admit_shared_zero(&self, axis: u16) -> Result<(), Refusal> {
        let Some(encoder) = self.state.axes.get(usize::from(axis)).and_then(|axis| axis.shares()) else {
            return Ok(());
        };
        match self.who_moves_with(encoder, usize::from(axis)) {
            Some(other) => Err(Refusal::new(Code::NOT_AT_STANDSTILL, Object::Axis(other as u16))),
            None => Ok(()),
        }
    }

    /// Moves encoders as their users have set new zeros (MACS-ENC-11): the values of the encoder and of its other users follow in
    /// the next cycle, before any command of it.
    pub(super) fn share_shifts(&mut self) {
        for index in 0..self.state.axes.len() {
            let Some((encoder, by)) = self.state.axes[index].take_shared() else { continue };
            let mut others =
                self.state.axes.iter().enumerate().filter(|(other, axis)| *other != index && axis.reads(encoder));
            let all_follow = others.all(|(_, axis)| axis.follows_encoder(by));
            if !all_follow || self.who_moves_with(encoder, index).is_some() {
                let object = Object::Axis(index as u16);
                self.events.push(Event::new(Severity::Warn, Kind::Warning, object, Code::ENCODER_NOT_SHARED));
                continue;
            }
            let place = usize::from(encoder);
            if let (Some(shifted), Some(lead)) =
                (self.state.encoders.get_mut(place), self.state.leads.encoder.get_mut(place))
            {
                shifted.shift(by);
                lead.position += Position::whole(by);
            }
            let others = self.state.axes.iter_mut().enumerate().filter(|(other, _)| *other != index);
            others.filter(|(_, axis)| axis.reads(encoder)).for_each(|(_, axis)| axis.shift_with_encoder(by));
        }
    }

    /// Another axis that uses the encoder and does not stand still.
    fn who_moves_with(&self, encoder: u16, index: usize) -> Option<usize> {
        let mut others = self.state.axes.iter().enumerate();
        others
            .find(|(other, axis)| *other != index && axis.reads(encoder) && !axis.stands_idle())
            .map(|(other, _)| other)
    }
}

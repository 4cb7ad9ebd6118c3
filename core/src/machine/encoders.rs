//! Encoders that several axes use: what they tell, and zeros that are set for all of them.

use super::Machine;
use crate::axis::Axis;
use crate::code::Code;
use crate::command::{Action, Commands, SetEncoderPosition};
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
        match self.state.axes.get(usize::from(axis)).and_then(|axis| axis.shares()) {
            Some(encoder) => self.check_users(encoder, Some(usize::from(axis))),
            None => Ok(()),
        }
    }

    /// The same of a new value of the master, where that is an encoder.
    pub(super) fn admit_master_zero(&self, axis: u16) -> Result<(), Refusal> {
        let axes = self.state.axes.len();
        match self.state.axes.get(usize::from(axis)).and_then(|axis| axis.shares_master(axes)) {
            Some(encoder) => self.check_users(encoder, None),
            None => Ok(()),
        }
    }

    /// New values of an encoder, in the cycle in which it has been read. What its users were before is what they are judged by.
    pub(super) fn set_encoder(&mut self, index: usize, commands: Commands<'_>, admitted: u64) {
        for (_, command) in super::live(commands, admitted) {
            let Action::SetEncoderPosition(request) = &command.action else { continue };
            if usize::from(request.encoder) != index {
                continue;
            }
            match self.zero_of_encoder(request) {
                Ok(by) => {
                    self.accept(command, Object::Encoder(request.encoder));
                    self.move_encoder(request.encoder, by, None);
                }
                Err(refusal) => self.events.push(refusal.event(command.sequence)),
            }
        }
    }

    /// By how much an encoder is to be moved (inc).
    fn zero_of_encoder(&self, request: &SetEncoderPosition) -> Result<i64, Refusal> {
        let refuse = |code| Refusal::new(code, Object::Encoder(request.encoder));
        let place = usize::from(request.encoder);
        let encoder = self.state.encoders.get(place).ok_or_else(|| refuse(Code::BAD_REQUEST))?;
        if encoder.is_absolute() {
            return Err(refuse(Code::MASTER_ZERO_STANDS));
        }
        if !encoder.lead().valid {
            return Err(refuse(Code::ENCODER_INVALID));
        }
        self.check_users(request.encoder, None)?;
        let asked = request.position.nearest;
        let by = asked.saturating_sub(encoder.lead().position.floor());
        let out = || refuse(Code::POSITION_OUT_OF_RANGE).with(Number::Position(asked), Number::None);
        let fits =
            Position::whole(asked).is_legal() && self.users(request.encoder).all(|(_, axis)| axis.follows_encoder(by));
        if fits { Ok(by) } else { Err(out()) }
    }

    /// Moves encoders as their users have set new zeros (MACS-ENC-11): the values of the encoder and of its other users follow in
    /// the next cycle, before any command of it.
    pub(super) fn share_shifts(&mut self) {
        for index in 0..self.state.axes.len() {
            if let Some((encoder, by)) = self.state.axes[index].take_shared() {
                self.share(index, encoder, by, Some(index));
            }
            if let Some((encoder, by)) = self.state.axes[index].take_shared_master()
                && self.share(index, encoder, by, None)
            {
                self.state.axes[index].share_master(by);
            }
        }
    }

    /// True where the encoder has moved; else only the axis has its new zero, and that is told.
    fn share(&mut self, index: usize, encoder: u16, by: i64, except: Option<usize>) -> bool {
        let fits = |(other, axis): (usize, &Axis)| Some(other) == except || axis.follows_encoder(by);
        let own = self.state.encoders.get(usize::from(encoder)).map(|encoder| encoder.lead().position);
        let is_legal = own.is_some_and(|own| (own + Position::whole(by)).is_legal());
        let moves = is_legal && self.users(encoder).all(fits) && self.check_users(encoder, except).is_ok();
        if moves {
            self.move_encoder(encoder, by, except);
        } else {
            let object = Object::Axis(index as u16);
            self.events.push(Event::new(Severity::Warn, Kind::Warning, object, Code::ENCODER_NOT_SHARED));
        }
        moves
    }

    /// The value of an encoder is `by` more, and so are those of its users but one.
    fn move_encoder(&mut self, encoder: u16, by: i64, except: Option<usize>) {
        let place = usize::from(encoder);
        if let (Some(shifted), Some(lead)) =
            (self.state.encoders.get_mut(place), self.state.leads.encoder.get_mut(place))
        {
            shifted.shift(by);
            lead.position += Position::whole(by);
        }
        let users = self.state.axes.iter_mut().enumerate();
        let others = users.filter(|(other, axis)| Some(*other) != except && axis.reads(encoder));
        others.for_each(|(_, axis)| axis.shift_with_encoder(by));
    }

    /// The axes that read an encoder.
    fn users(&self, encoder: u16) -> impl Iterator<Item = (usize, &Axis)> {
        self.state.axes.iter().enumerate().filter(move |(_, axis)| axis.reads(encoder))
    }

    /// A user of the encoder that does not stand still keeps it from being moved.
    fn check_users(&self, encoder: u16, except: Option<usize>) -> Result<(), Refusal> {
        let mut moving = self.users(encoder).filter(|(other, axis)| Some(*other) != except && !axis.stands_idle());
        match moving.next() {
            Some((_, axis)) => Err(axis.not_at_standstill()),
            None => Ok(()),
        }
    }

    /// Who sees an axis as its master counts on when its coordinate becomes `by` more.
    pub(super) fn count_on(&mut self, index: usize, by: Position) {
        self.state.axes.iter_mut().for_each(|axis| axis.count_on(index as u16, by));
    }
}

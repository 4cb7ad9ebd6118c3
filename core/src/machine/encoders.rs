//! Encoders shared by several axes: their events, and new zeros that apply to all users.

use super::{Machine, State};
use crate::axis::{Axis, Claim};
use crate::code::Code;
use crate::command::{Action, Commands, SetEncoderPosition};
use crate::encoder::EncoderReport;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::position::Position;

/// Returns the code of an encoder report.
pub(super) fn code(told: EncoderReport) -> Code {
    match told {
        EncoderReport::Invalid => Code::ENCODER_INVALID,
        EncoderReport::Substituted => Code::ENCODER_SUBSTITUTED,
        EncoderReport::Pulses { .. } => Code::WF_PULSES,
    }
}

/// Returns the event of an encoder report.
pub(super) fn event(told: EncoderReport, encoder: u16, errors: u64) -> Event {
    let (severity, kind) = match told {
        EncoderReport::Substituted => (Severity::Warn, Kind::Warning),
        _ => (Severity::Error, Kind::Error),
    };
    let event = Event::new(severity, kind, Object::Encoder(encoder), code(told));
    match told {
        EncoderReport::Invalid => event,
        EncoderReport::Substituted => {
            event.with(Number::Count(errors.min(i64::MAX as u64).cast_signed()), Number::None)
        }
        EncoderReport::Pulses { by, tolerance } => event.with(Number::Position(by), Number::Position(tolerance)),
    }
}

impl Machine {
    /// Refuses a zero that moves an encoder while another axis that uses this encoder moves.
    pub(super) fn admit_shared_zero(&self, axis: u16) -> Result<(), Refusal> {
        match self.state.axes.get(usize::from(axis)).and_then(|axis| axis.shares()) {
            Some(encoder) => self.check_users(encoder, Some(usize::from(axis))),
            None => Ok(()),
        }
    }

    /// Does the same as [`admit_shared_zero`](Self::admit_shared_zero) for a new value of the master, if the master is
    /// an encoder.
    pub(super) fn admit_master_zero(&self, axis: u16) -> Result<(), Refusal> {
        let axes = self.state.axes.len();
        match self.state.axes.get(usize::from(axis)).and_then(|axis| axis.shares_master(axes)) {
            Some(encoder) => self.check_users(encoder, None),
            None => Ok(()),
        }
    }

    /// Applies new values of an encoder in the cycle in which it was read. Each command is checked against the state of
    /// the users before it.
    pub(super) fn set_encoder(&mut self, index: usize, commands: Commands<'_>, admitted: u64) {
        self.set_by[index] = 0;
        for command in super::commands_for_axes(commands, admitted) {
            let Action::SetEncoderPosition(request) = &command.action else { continue };
            if usize::from(request.encoder) != index {
                continue;
            }
            match self.zero_of_encoder(request) {
                Ok(by) => {
                    self.accept(command, Object::Encoder(request.encoder));
                    self.move_encoder(request.encoder, by, |_| by);
                    self.set_by[index] = command.sequence;
                }
                Err(refusal) => self.events.push(refusal.event(command.sequence)),
            }
        }
    }

    /// Returns the distance by which an encoder is to be moved (inc).
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

    /// Moves encoders by the new zeros that their users have set (MACS-ENC-11). The values of the encoder and of its
    /// other users follow in the next cycle, before any command of it. If several zeros are set in one cycle, the last
    /// one applies, as if each had been shared before the next.
    pub(super) fn share_shifts(&mut self) {
        if self.state.encoders.is_empty() {
            return;
        }
        for encoder in 0..self.state.encoders.len() {
            self.share(encoder as u16);
        }
        self.state.axes.iter_mut().for_each(Axis::forget_claims);
    }

    fn share(&mut self, encoder: u16) {
        let Some(mut last) = self.encoder_claims(encoder).max_by_key(|claim| claim.sequence) else { return };
        let set_by = self.set_by.get(usize::from(encoder)).copied().unwrap_or_default();
        if set_by > last.sequence {
            // The encoder itself was set after all of them, and has that value already.
            last = Claim { sequence: set_by, by: 0, ..last };
        }
        if let Err(number) = self.check_share(encoder, last) {
            // The new zero of each axis applies to this axis only.
            for index in 0..self.state.axes.len() {
                for _ in
                    self.state.axes[index].zero_claims(encoder).into_iter().flatten().filter(|claim| !claim.is_soft)
                {
                    let object = Object::Axis(index as u16);
                    let event = Event::new(Severity::Warn, Kind::Warning, object, Code::ENCODER_NOT_SHARED);
                    self.events.push(event.with(number, Number::None));
                }
            }
            return;
        }
        self.move_encoder(encoder, last.by, |axis| axis.remaining_shift(last.by, last.sequence));
        for axis in &mut self.state.axes {
            let [_, of_master] = axis.zero_claims(encoder);
            // The shown master position of this axis already has that zero.
            match of_master {
                Some(claim) if !claim.is_soft => axis.share_master(claim.by),
                Some(claim) if claim.sequence > last.sequence => axis.share_master(last.by),
                _ => {}
            }
        }
    }

    /// Returns the new zeros of this cycle that apply to the encoder itself.
    fn encoder_claims(&self, encoder: u16) -> impl Iterator<Item = Claim> {
        let claims = self.state.axes.iter().flat_map(move |axis| axis.zero_claims(encoder));
        claims.flatten().filter(|claim| !claim.is_soft)
    }

    /// Checks that the encoder may be moved by a claim.
    ///
    /// # Errors
    /// The axis that moves; [`Number::None`] if a position or limit would leave its range.
    fn check_share(&self, encoder: u16, last: Claim) -> Result<(), Number> {
        let own = self.state.encoders.get(usize::from(encoder)).map(|encoder| encoder.lead().position);
        let is_legal = own.is_some_and(|own| (own + Position::whole(last.by)).is_legal());
        for (index, axis) in self.users(encoder) {
            let left = axis.remaining_shift(last.by, last.sequence);
            if left != 0 && !axis.is_idle_at_rest() {
                return Err(Number::Count(index as i64));
            }
            if left != 0 && !axis.follows_encoder(left) {
                return Err(Number::None);
            }
        }
        if is_legal { Ok(()) } else { Err(Number::None) }
    }

    /// Increases the value of an encoder by `by` (inc), and moves each of its users by the part of the distance that it
    /// still lacks.
    fn move_encoder(&mut self, encoder: u16, by: i64, left: impl Fn(&Axis) -> i64) {
        let place = usize::from(encoder);
        if let (Some(shifted), Some(lead)) =
            (self.state.encoders.get_mut(place), self.state.leads.encoders.get_mut(place))
        {
            shifted.shift(by);
            lead.position += Position::whole(by);
        }
        for axis in self.state.axes.iter_mut().filter(|axis| axis.reads(encoder)) {
            axis.shift_with_encoder(left(axis));
        }
    }

    /// Returns the axes that read an encoder.
    fn users(&self, encoder: u16) -> impl Iterator<Item = (usize, &Axis)> {
        self.state.axes.iter().enumerate().filter(move |(_, axis)| axis.reads(encoder))
    }

    /// Returns an error if a user of the encoder, apart from `except`, is not at standstill.
    fn check_users(&self, encoder: u16, except: Option<usize>) -> Result<(), Refusal> {
        let mut moving = self.users(encoder).filter(|(other, axis)| Some(*other) != except && !axis.is_idle_at_rest());
        match moving.next() {
            Some((_, axis)) => Err(axis.not_at_standstill()),
            None => Ok(()),
        }
    }

    /// Keeps the shown master position of the followers of an axis when the coordinate of this axis increases by `by`.
    pub(super) fn keep_master_positions(&mut self, index: usize, by: Position) {
        let State { axes, leads, .. } = &mut self.state;
        axes.iter_mut().for_each(|axis| axis.continue_with_axis(leads, index as u16, by));
    }
}

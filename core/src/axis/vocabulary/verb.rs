//! A command of a vocabulary on an axis: it is executed on copies first, and the axis checks the result.
//!
//! Law      a start whose drive has to be switched on first is checked at the command, as far as this is known then.
//!          Changes until the motion begins are checked once the drive is on
//! Refuses  the whole command, or only the part that is not possible, as the vocabulary defines
//! Source   SAIA-ERR-03, SAIA-ERR-04, WF-SET-02

use crate::axis::state::{Axis, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal};
use crate::parameter::Change;
use crate::profile::Motion;
use crate::regulator::Law;
use crate::vocabulary::{Order, Outcome, Owner, Request, View};

impl Axis {
    pub(in crate::axis) fn run_request(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Request,
    ) -> Result<(), Refusal> {
        let owner = request.owner();
        self.vocabularies.mark_used(owner);
        let mut parameters = *self.parameters;
        for (row, value) in request.writes() {
            let change = Change { axis: self.setup.index, row, value };
            let Some(entry) = change.row() else { continue };
            let refusal = Refusal::new(Code::PARAMETER_OUT_OF_RANGE, self.object());
            let refusal = Refusal { parameter: Some(row), ..refusal.with(change.number(), Number::None) };
            entry.assign(&mut parameters, value).map_err(|_| refusal)?;
        }
        if self.setup.law == Law::Integer {
            self.check_sense(&parameters)?;
        }
        let barred = self.check_stop_of(cx.cycle).err();
        let view = View { parameters: &parameters, ..self.view(cx.cycle, owner, cx.leads, cx.latches) };
        let (mut tried, mut outcome) = self.vocabularies.try_request(request, &view, barred)?;
        if let Err(refusal) = self.execute_if_allowed(cx, owner, &outcome) {
            let view = View { parameters: &parameters, ..self.view(cx.cycle, owner, cx.leads, cx.latches) };
            (tried, outcome) = self.vocabularies.try_failed_request(request, &view, refusal)?;
            self.execute_if_allowed(cx, owner, &outcome)?;
        }
        if let Some(refusal) = outcome.warning {
            self.warn_of(cx, refusal);
        }
        self.vocabularies.keep(&tried);
        self.accepted(cx, sequence);
        self.write_own(cx, Some(sequence), request.writes());
        for refusal in outcome.errors.iter().flatten() {
            let event = Event { kind: Kind::Warning, ..refusal.event(sequence) };
            cx.events.push(Event { position: self.command.position(), ..event });
        }
        Ok(())
    }

    /// Executes the order of a command if the motion that follows once the drive is on is allowed, too.
    fn execute_if_allowed(&mut self, cx: &mut Context<'_>, owner: Owner, outcome: &Outcome) -> Result<(), Refusal> {
        if let Some(motion) = outcome.coming {
            self.check_coming_motion(cx.cycle, motion)?;
        }
        outcome.order.map_or(Ok(()), |order| self.execute(cx, owner, order))
    }

    /// Checks whether a motion may begin as soon as the drive is on. Until then a drive that is off neither unlocks the
    /// axis nor finds its reference.
    fn check_coming_motion(&self, cycle: u64, motion: Order) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_lock()?;
        self.check_settled()?;
        // The end of a coasting axis is unknown.
        let from = if self.is_virtual() { self.present_motion() } else { Motion::at_rest(self.command.position()) };
        match motion {
            Order::Position { target, limits, .. } => self.admit_position(cycle, from, target, limits).map(|_| ()),
            Order::Velocity { velocity, limits } => self.admit_velocity(cycle, from, velocity, limits).map(|_| ()),
            _ => Ok(()),
        }
    }
}

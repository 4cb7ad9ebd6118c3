//! The verb of SAIA on an axis: registers and flags are tried on copies, and the axis judges what comes of them.
//!
//! Law      a start whose drive has to switch on first is judged when it comes, by all that can be known then; what changes
//!          until it moves is found once the drive is on
//! Refuses  the whole verb, or by `saia.command_error` only the commands that start
//! Source   SAIA-ERR-03, SAIA-ERR-04

use crate::axis::{Axis, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::{AxisParameters, Change};
use crate::profile::Motion;
use crate::vocabulary::saia::{Outcome, Request, Saia};
use crate::vocabulary::{Order, Owner, View};

impl Axis {
    pub(in crate::axis) fn run_saia(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        request: &Request,
    ) -> Result<(), Refusal> {
        self.awake.saia = true;
        let mut parameters = *self.parameters;
        for (register, value) in request.registers() {
            let Some((place, row)) = register.row() else { continue };
            let refusal = Refusal::new(Code::PARAMETER_OUT_OF_RANGE, self.object());
            let number = Change { axis: self.setup.index, row: place, value }.number();
            let refusal = Refusal { parameter: Some(place), ..refusal.with(number, Number::None) };
            row.assign(&mut parameters, value).map_err(|_| refusal)?;
        }
        let barred = self.check_stop_of(cx.cycle).err();
        let (mut saia, mut outcome) = self.ask_saia(cx, &parameters, request, barred)?;
        if let Err(refusal) = self.do_saia(cx, &outcome) {
            if parameters.vocabularies.saia.refuses() {
                return Err(refusal);
            }
            // The start fails, what stands beside it does not.
            (saia, outcome) = self.ask_saia(cx, &parameters, request, Some(refusal))?;
            self.do_saia(cx, &outcome)?;
        }
        self.saia = saia;
        self.parameters.change(|values| *values = parameters);
        self.accepted(cx, sequence);
        for (register, value) in request.registers() {
            let event = Event::new(Severity::Info, Kind::Parameter, self.object(), Code::NONE).of_command(sequence);
            let Some((row, _)) = register.row() else { continue };
            let number = Change { axis: self.setup.index, row, value }.number();
            cx.events.push(Event { parameter: Some(row), ..event.with(number, Number::None) });
        }
        for refusal in outcome.errors.iter().flatten() {
            let event = Event { kind: Kind::Warning, ..refusal.event(sequence) };
            cx.events.push(Event { position: self.command.position, ..event });
        }
        Ok(())
    }

    /// What the verb does to a copy of the vocabulary, with these parameters.
    fn ask_saia(
        &self,
        cx: &Context<'_>,
        parameters: &AxisParameters,
        request: &Request,
        barred: Option<Refusal>,
    ) -> Result<(Saia, Outcome), Refusal> {
        let mut saia = self.saia;
        let view = View { parameters, ..self.view(cx.cycle, Owner::Saia, cx.leads, cx.latches) };
        let outcome = saia.run(request, &view, barred)?;
        Ok((saia, outcome))
    }

    /// What a verb asks of the axis, if it also may do what it is to do once its drive is on.
    fn do_saia(&mut self, cx: &mut Context<'_>, outcome: &Outcome) -> Result<(), Refusal> {
        if let Some(motion) = outcome.coming {
            self.check_coming(cx.cycle, motion)?;
        }
        outcome.order.map_or(Ok(()), |order| self.obey(cx, Owner::Saia, order))
    }

    /// May a motion begin as soon as the drive is on? A drive that is off until then unlocks nothing and finds no zero.
    fn check_coming(&self, cycle: u64, motion: Order) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_lock()?;
        self.check_settled()?;
        // Where it coasts to nobody knows.
        let from = if self.is_virtual() { self.present() } else { Motion::at_rest(self.command.position) };
        match motion {
            Order::Position { target, limits, .. } => self.admit_position(cycle, from, target, limits).map(|_| ()),
            Order::Velocity { velocity, limits } => self.admit_velocity(cycle, from, velocity, limits).map(|_| ()),
            _ => Ok(()),
        }
    }
}

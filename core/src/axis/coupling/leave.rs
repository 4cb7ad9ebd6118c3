//! The end of a coupling at a position (MC_GearOut, MC_CamOut).
//!
//! Law      the coupling continues until the cycle in which its leader, or the axis itself, reaches the position from
//!          either side, or is at rest there; within the turn if it has a modulo. In that cycle the axis leaves the
//!          coupling with its velocity, and stops or continues at that velocity. A second command replaces the first;
//!          any other end of the coupling ends the wait
//! Reads    the leader, or the command of the axis as its followers see it
//! Refuses  an axis that no goal couples
//! Source   PLCopen (MC_GearOut, MC_CamOut)

use super::engage::passed;
use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::{Axis, Context, Leaving, Numbers};
use crate::code::Code;
use crate::command::{DisengageAt, GearOut};
use crate::event::{Event, Refusal};
use crate::modulo::Modulo;
use crate::object::Leader;
use crate::position::Position;

impl Axis {
    /// Accepts a command to leave the coupling; `turn` is the modulo of its leader.
    pub fn start_gear_out(&mut self, cx: &mut Context<'_>, sequence: u64, request: GearOut, turn: Option<Modulo>) {
        match self.leaving_of(cx, sequence, request, turn) {
            Ok(leaving) => {
                self.end_leaving(cx, Code::REPLACED, NO_NUMBERS);
                self.coupling.set_leaving(Some(leaving));
                self.accepted(cx, sequence);
            }
            Err(refusal) => cx.events.push(Event { position: self.command.position(), ..refusal.event(sequence) }),
        }
    }

    fn leaving_of(
        &self,
        cx: &Context<'_>,
        sequence: u64,
        request: GearOut,
        turn: Option<Modulo>,
    ) -> Result<Leaving, Refusal> {
        let GearOut { at, disengage, .. } = request;
        let coupling = self.coupling().filter(|_| self.task.goal().is_some());
        let coupling = coupling.ok_or_else(|| self.refuse(Code::NOT_COUPLED))?;
        let lead = cx.leads.get(self.left_by(at, coupling.leader));
        let turn = turn.filter(|_| matches!(at, DisengageAt::Leader(_)));
        let disengage = disengage.unwrap_or(coupling.disengage);
        let leaving = Leaving { sequence, at, turn, disengage, seen: lead.position - lead.change };
        if leaving.is_sound() { Ok(leaving) } else { Err(self.refuse(Code::BAD_REQUEST)) }
    }

    /// Returns the leader whose position counts.
    fn left_by(&self, at: DisengageAt, leader: Leader) -> Leader {
        match at {
            DisengageAt::Now | DisengageAt::Leader(_) => leader,
            DisengageAt::Axis(_) => Leader::AxisCommand(self.setup.index),
        }
    }

    /// Returns the number of the command that waits to leave the coupling; 0 for none.
    pub(in crate::axis) fn leaving(&self) -> u64 {
        self.coupling.leaving().map_or(0, |leaving| leaving.sequence)
    }

    /// Returns true if the command waits for a position of the axis itself.
    pub(in crate::axis) fn leaves_at_own_place(&self) -> bool {
        self.coupling.leaving().is_some_and(|leaving| matches!(leaving.at, DisengageAt::Axis(_)))
    }

    /// Ends the wait.
    pub(in crate::axis) fn end_leaving(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        if let Some(leaving) = self.coupling.take_leaving() {
            let done = Event::done(self.object(), leaving.sequence, code, self.command.position());
            cx.events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Ends the wait when the coupling has ended in any other way.
    pub(in crate::axis) fn settle_leaving(&mut self, cx: &mut Context<'_>) {
        if self.coupling.leaving().is_some() && self.coupling().is_none() {
            self.end_leaving(cx, Code::NOT_REACHED, NO_NUMBERS);
        }
    }

    /// Leaves the coupling if its position is reached in this cycle.
    pub(in crate::axis) fn leave(&mut self, cx: &mut Context<'_>) {
        let (Some(leaving), Some(coupling)) = (*self.coupling.leaving(), self.coupling()) else { return };
        let lead = cx.leads.get(self.left_by(leaving.at, coupling.leader));
        let (place, turn) = match leaving.at {
            DisengageAt::Now => (None, None),
            DisengageAt::Leader(place) => (Some(place), leaving.turn),
            DisengageAt::Axis(place) => (Some(place), self.setup.modulo),
        };
        let is_there = place.is_none_or(|place| {
            let place = Position::whole(place);
            let place = turn.map_or(place, |turn| turn.last_reached(place, lead.position, lead.change));
            passed(place, lead, leaving.seen).is_some()
        });
        if !is_there {
            self.coupling.set_leaving(Some(Leaving { seen: lead.position, ..leaving }));
            return;
        }
        self.end_leaving(cx, Code::NONE, NO_NUMBERS);
        // Shifts against the leader end with the coupling, with the velocity that they have added.
        self.end_overlay(cx, Code::NOT_REACHED, NO_NUMBERS);
        self.end_phase(cx, Code::NOT_REACHED, NO_NUMBERS);
        self.uncouple(cx, leaving.disengage, Code::GEARED_OUT);
    }
}

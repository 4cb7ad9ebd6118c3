//! A pair of places of leader and axis, and a leader at the moment of a gear.
//!
//! Law      the leader passes the start of a pair where it moves over the place that lies the distance before its own, in the direction in which it
//!          moves; where it has a turn, in the turn of the last pass
//! Reads    the leader, this cycle's
//! Refuses  without a turn a leader that moves towards its place, and is past the start
//! Source   PLCopen (MC_GearInPos)

use crate::command::Engage;
use crate::encoder::Lead;
use crate::event::Number;
use crate::modulo::Modulo;
use crate::object::Leader;
use crate::position::Position;
use crate::sync::gear::Gear;

/// A pair of places, and the leader's way before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// Of the leader (inc), within its turn where it has one.
    leader: i64,
    turn: Option<Modulo>,
    /// Of the axis (inc).
    pub slave: i64,
    /// The leader's way before it (inc); 0: the axis catches up behind.
    pub distance: i64,
}

impl Pair {
    /// The one that a coupling waits for.
    pub(super) fn of(engage: Engage) -> Option<Self> {
        let Engage::InPosition { position, turn, slave, distance } = engage else { return None };
        Some(Self { leader: position, turn, slave, distance })
    }

    /// Could it have come about? One that was read from outside may hold anything.
    pub(super) fn is_sound(&self) -> bool {
        let Self { leader, turn, slave, distance } = *self;
        let is_legal = [leader, slave].iter().all(|place| Position::whole(*place).is_legal());
        is_legal && turn.is_none_or(Modulo::is_sound) && (0..=Gear::MAX_CHANGE).contains(&distance)
    }

    /// May the leader come to it by going on as it does?
    pub(super) fn lies_ahead(&self, lead: Lead) -> bool {
        let towards = Position::whole(self.leader) - lead.position;
        let moves = lead.change != Position::ZERO;
        moves && (self.turn.is_some() || (towards > Position::ZERO) == (lead.change > Position::ZERO))
    }

    /// How far behind its start the leader is that has passed it in this cycle, towards its place.
    ///
    /// # Errors
    /// It is past it already; where it has a turn, it comes there again.
    pub(super) fn passed_start(&self, lead: Lead) -> Result<Option<Position>, (Number, Number)> {
        let direction = lead.change.raw().signum() as i64;
        if direction == 0 {
            return Ok(None);
        }
        let of_leader = |way: Position| if direction > 0 { way } else { -way };
        let start = Position::whole(self.leader) - Position::whole(direction * self.distance);
        let start = self.turn.map_or(start, |turn| turn.last_passed(start, lead.position, lead.change));
        let past = of_leader(lead.position - start);
        if past >= Position::ZERO && past <= of_leader(lead.change) {
            return Ok(Some(lead.position - start));
        }
        if self.turn.is_none() && past > Position::ZERO && past < Position::whole(self.distance) {
            return Err((Number::Count(past.ceil()), Number::Count(self.distance)));
        }
        Ok(None)
    }
}

/// A leader at the moment of a gear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Started {
    pub leader: Leader,
    /// As it stands in this cycle.
    pub lead: Lead,
    /// Its mean change in a cycle (inc).
    pub mean: f64,
    /// How far behind the moment it is.
    pub after: Position,
}

impl Started {
    /// Its change in a cycle (inc): that of a counted one is smoothed.
    pub(super) fn speed(&self) -> f64 {
        let change = self.lead.change.to_f64();
        if self.lead.uneven == 0.0 || self.mean * change <= 0.0 { change } else { self.mean }
    }
}

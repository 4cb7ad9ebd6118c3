//! A pair of positions of leader and axis, and the leader when a gear begins.
//!
//! Law      the leader passes the start of a pair when it crosses the position at the distance before its own position,
//!          in the direction in which it moves; with a modulo, in the turn of the last pass
//! Reads    the leader of this cycle
//! Refuses  without modulo: a leader beyond the start that moves towards its position
//! Source   PLCopen (MC_GearInPos)

use crate::command::Engage;
use crate::encoder::Lead;
use crate::event::Number;
use crate::modulo::Modulo;
use crate::object::Leader;
use crate::position::Position;
use crate::sync::gear::Gear;

/// A pair of positions, and the distance of the leader before it.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Pair {
    /// Position of the leader (inc), within its turn if it has a modulo.
    leader: i64,
    turn: Option<Modulo>,
    /// Position of the axis (inc).
    pub slave: i64,
    /// Start distance of the leader (inc); 0: the axis catches up afterwards.
    pub distance: i64,
}

impl Pair {
    /// Returns the pair for which a coupling waits.
    pub(in crate::axis) fn of(engage: Engage) -> Option<Self> {
        let Engage::InPosition { position, turn, slave, distance } = engage else { return None };
        Some(Self { leader: position, turn, slave, distance })
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub(in crate::axis) fn is_sound(&self) -> bool {
        let Self { leader, turn, slave, distance } = *self;
        let is_legal = [leader, slave].iter().all(|place| Position::whole(*place).is_legal());
        is_legal && turn.is_none_or(Modulo::is_sound) && (0..=Gear::MAX_CHANGE).contains(&distance)
    }

    /// Whether the leader approaches the pair in its present direction.
    pub(in crate::axis) fn is_ahead(&self, lead: Lead) -> bool {
        let towards = Position::whole(self.leader) - lead.position;
        let moves = lead.change != Position::ZERO;
        moves && (self.turn.is_some() || (towards > Position::ZERO) == (lead.change > Position::ZERO))
    }

    /// Returns the distance of the leader after the start, if it has passed the start in this cycle towards its
    /// position.
    ///
    /// # Errors
    /// It was already beyond the start. With a modulo it will pass again.
    pub(in crate::axis) fn passed_start(&self, lead: Lead) -> Result<Option<Position>, (Number, Number)> {
        let direction = lead.change.raw().signum() as i64;
        if direction == 0 {
            return Ok(None);
        }
        let of_leader = |way: Position| if direction > 0 { way } else { -way };
        let start = Position::whole(self.leader) - Position::whole(direction * self.distance);
        let start = self.turn.map_or(start, |turn| turn.last_reached(start, lead.position, lead.change));
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

/// A leader when a gear begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Started {
    pub leader: Leader,
    /// Its lead of this cycle.
    pub lead: Lead,
    /// Its mean change in a cycle (inc).
    pub mean: f64,
    /// Its distance after the start.
    pub after: Position,
}

impl Started {
    /// Returns its change in a cycle (inc), smoothed for a counted leader.
    pub(in crate::axis) fn speed(&self) -> f64 {
        let change = self.lead.change.to_f64();
        if self.lead.uneven == 0.0 || self.mean * change <= 0.0 { change } else { self.mean }
    }
}

//! An axis with two drives: how it holds them together, and squares them.
//!
//! Law      while it is on it may be `max_skew` from square, and while it looks for its square that much from what it holds; beyond
//!          that skew_reaction acts in the cycle in which it shows. What switches off, stops or fails, does so for both drives
//! Reads    its gantry, as both drives were read
//! Writes   what its gantry holds: as both stand when it comes on, the square once homing has found it
//! Refuses  to be switched on beyond `max_skew`; ways of homing that square nothing; another source than the drives
//! Source   contract section 3, docs/homing.md

use super::power::Power;
use super::reaction::Failure;
use super::{Axis, Context};
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::gantry::{Found, Gantry, Trouble};
use crate::position::Position;
use crate::profile::Limits;

impl Axis {
    /// Place of its gantry among those of the machine; none where it has one drive alone.
    #[inline]
    pub fn gantry(&self) -> Option<u16> {
        self.setup.gantry
    }

    /// A distance of its drives in its own sense (inc).
    pub fn in_its_sense(&self, counts: i64) -> i64 {
        self.turn_counts(counts)
    }

    /// May it be switched on as its two drives stand?
    ///
    /// # Errors
    /// They are too far from square.
    pub fn admits_skew(&self, gantry: &Gantry) -> Result<(), Refusal> {
        let (skew, limit) = (gantry.skew(), self.parameters.gantry.skew_limit());
        if self.power != Power::Off || skew.saturating_abs() <= limit {
            return Ok(());
        }
        let (found, limit) = (Number::Position(self.turn_counts(skew)), Number::Position(limit));
        Err(self.refuse(Code::SKEW).with(found, limit))
    }

    /// Sees to it that both drives stay together.
    pub(super) fn supervise_gantry(&mut self, cx: &mut Context<'_>) {
        let Some(gantry) = cx.gantry.as_deref_mut() else { return };
        if gantry.is_anew() {
            self.note_new_coordinate();
        }
        let is_left = if self.holding.had_power {
            let limits = self.squaring_limits();
            let is_left = !self.homing.is_running() && gantry.stop_squaring(&limits, cx.cycle);
            gantry.advance(cx.cycle);
            is_left
        } else {
            gantry.let_go()
        };
        if is_left {
            // It is between what it was and square: where, its zero does not tell.
            self.homing.forget();
        }
        let limit = self.parameters.gantry.skew_limit();
        let is_run = self.is_on() || matches!(self.power, Power::DriveStops { .. });
        let failure = match gantry.trouble(limit, self.homing.is_running()).filter(|_| is_run) {
            None => return,
            Some(Trouble::Unread) => Failure::of(Code::SECOND_UNREAD),
            Some(Trouble::Skewed(by)) => {
                let by = Number::Position(self.turn_counts(by));
                Failure::of(Code::SKEW).with(by, Number::Position(limit))
            }
        };
        self.raise(cx, failure.before_motion());
    }

    /// What the second drive may use on its way to the square.
    fn squaring_limits(&self) -> Limits {
        let p = &self.parameters;
        let acceleration = p.homing_acceleration();
        Limits {
            velocity: p.homing_index_velocity(),
            acceleration,
            deceleration: p.deceleration_limit() * (acceleration / p.max_acceleration),
            shape: p.usual_shape(),
        }
    }

    /// Homing begins: edges from before count no more.
    pub(super) fn forget_edges(&mut self, cx: &mut Context<'_>) {
        if let Some(gantry) = cx.gantry.as_deref_mut() {
            self.switches.home = gantry.begin_search();
        }
    }

    /// How far it has gone with the switch of one drive actuated alone, and how far it may, where that is further.
    pub(super) fn parted(&self, cx: &Context<'_>) -> Option<(i64, i64)> {
        let limit = self.parameters.gantry.squaring_limit();
        let gone = cx.gantry.as_deref()?.differs_for()?;
        (gone > limit).then_some((gone, limit))
    }

    /// Leads the second drive to the square by the edges of both switches, and returns the place of the first one's edge; none where there
    /// is one drive alone.
    ///
    /// # Errors
    /// What it would have to go, and how far it may.
    pub(super) fn square(&mut self, cx: &mut Context<'_>) -> Result<Option<Position>, (i64, i64)> {
        let (limits, most) = (self.squaring_limits(), self.parameters.gantry.squaring_limit());
        let Some(gantry) = cx.gantry.as_deref_mut() else { return Ok(None) };
        let Some(Found { square, way, gone }) = gantry.found() else { return Ok(None) };
        if way.saturating_abs() > most {
            return Err((self.turn_counts(way), most));
        }
        gantry.begin_squaring(square, &limits, cx.cycle);
        Ok(Some(self.actual.position - Position::whole(self.turn_counts(gone))))
    }

    /// Is its second drive on the way to the square?
    pub(super) fn is_squaring(cx: &Context<'_>) -> bool {
        cx.gantry.as_deref().is_some_and(Gantry::is_squaring)
    }
}

//! An axis with two drives: how it holds them together, and squares them.
//!
//! Law      while it is on it may be `max_skew` from square, and while it looks for its square that much from what it holds; beyond
//!          that skew_reaction acts in the cycle in which it shows, and beyond twice that both are without voltage whatever it is.
//!          What switches off, stops or fails, does so for both drives
//! Reads    its gantry, as both drives were read
//! Writes   what its gantry holds: as both stand when it comes on, the square once homing has found it
//! Refuses  to be switched on beyond `max_skew`, or where the second drive tells no place
//! Source   contract section 3, docs/homing.md

use super::power::Power;
use super::reaction::Failure;
use super::{Axis, AxisState, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
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
    /// They are too far from square, or nobody knows how far.
    pub fn admits_skew(&self, gantry: &Gantry) -> Result<(), Refusal> {
        if self.power != Power::Off {
            return Ok(());
        }
        self.fits_on(gantry).map_err(|(code, found, limit)| self.refuse(code).with(found, limit))
    }

    /// Would it be held together where both drives stand? Else why not.
    fn fits_on(&self, gantry: &Gantry) -> Result<(), (Code, Number, Number)> {
        let (skew, limit) = (gantry.skew(), self.parameters.gantry.skew_limit());
        match () {
            () if !gantry.is_second_read() => Err((Code::SECOND_UNREAD, Number::None, Number::None)),
            () if skew.saturating_abs() <= limit => Ok(()),
            () => Err((Code::SKEW, Number::Position(self.turn_counts(skew)), Number::Position(limit))),
        }
    }

    /// What keeps it from coming on as its two drives stand now.
    pub(super) fn unfit_to_come_on(&self, cx: &Context<'_>) -> Option<Failure> {
        let (code, found, limit) = self.fits_on(cx.gantry.as_deref()?).err()?;
        Some(Failure::of(code).with(found, limit).before_motion().taking_power())
    }

    /// Reads how its second drive moves.
    pub(super) fn read_second(&mut self, cx: &Context<'_>) {
        self.holding.second_change = cx.gantry.as_deref().map_or(0, Gantry::second_change);
    }

    /// Sees to it that both drives stay together.
    pub(super) fn supervise_gantry(&mut self, cx: &mut Context<'_>) {
        let Some(gantry) = cx.gantry.as_deref_mut() else { return };
        if gantry.is_anew() {
            self.note_new_coordinate();
        }
        if gantry.is_assumed() {
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::SQUARE_ASSUMED);
            cx.events.push(Event { position: self.actual.position, ..event });
        }
        let is_left = if self.holding.had_power {
            let stops = matches!(self.state, AxisState::Stopping | AxisState::ErrorStop) || self.power != Power::On;
            let limits = if stops { self.stop_limits() } else { self.squaring_limits() };
            let is_left = !self.homing.is_running() && gantry.stop_squaring(&limits, cx.cycle);
            gantry.advance(cx.cycle);
            is_left
        } else {
            gantry.let_go()
        };
        self.holding.second_moves = gantry.is_squaring();
        if is_left {
            // It is between what it was and square: where, its zero does not tell.
            self.homing.forget();
        }
        let limit = self.parameters.gantry.skew_limit();
        let is_run = self.is_on() || matches!(self.power, Power::DriveStops { .. });
        let failure = match gantry.trouble(cx.cycle, limit, self.homing.is_running()).filter(|_| is_run) {
            // Words of different cycles tell neither that it goes on nor that it is over.
            None if is_run && !gantry.is_fresh() => return,
            None => {
                gantry.note_beyond(false);
                return;
            }
            Some(Trouble::Unread) => Failure::of(Code::SECOND_UNREAD),
            Some(Trouble::Skewed(by)) => {
                let lasts = gantry.note_beyond(true);
                let is_far = by.saturating_abs() > limit.saturating_mul(2);
                let by = Number::Position(self.turn_counts(by));
                let failure = Failure::of(Code::SKEW).with(by, Number::Position(limit)).lasting(lasts);
                if is_far { failure.taking_power() } else { failure }
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

    /// A leg of the search begins.
    pub(super) fn begin_leg_of_both(cx: &mut Context<'_>) {
        if let Some(gantry) = cx.gantry.as_deref_mut() {
            gantry.begin_leg();
        }
    }

    /// Has one drive left its switch behind, further than a switch bounces, before that of the other one came?
    pub(super) fn has_passed_switch(&self, cx: &Context<'_>) -> bool {
        cx.gantry.as_deref().is_some_and(|gantry| gantry.has_passed(self.parameters.gantry.skew_limit()))
    }

    /// Is the second drive led into a limit switch on its way to the square?
    pub(super) fn squares_into_limit(&self, cx: &Context<'_>) -> bool {
        let way = cx.gantry.as_deref().filter(|gantry| gantry.is_squaring()).and_then(Gantry::goes_up);
        way.is_some_and(|up| if up { self.switches.positive } else { self.switches.negative })
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
    /// What it would have to go, and how far it may; none where an edge of one drive did not come.
    pub(super) fn square(&mut self, cx: &mut Context<'_>) -> Result<Option<Position>, (Number, Number)> {
        let (limits, most) = (self.squaring_limits(), self.parameters.gantry.squaring_limit());
        let Some(gantry) = cx.gantry.as_deref_mut() else { return Ok(None) };
        let Found { square, way, gone } = gantry.found().ok_or((Number::None, Number::None))?;
        if way.saturating_abs() > most {
            return Err((Number::Position(self.turn_counts(way)), Number::Position(most)));
        }
        gantry.begin_squaring(square, &limits, cx.cycle);
        self.holding.second_moves = gantry.is_squaring();
        Ok(Some(self.actual.position - Position::whole(self.turn_counts(gone))))
    }

    /// Is its second drive on the way to the square?
    pub(super) fn is_squaring(cx: &Context<'_>) -> bool {
        cx.gantry.as_deref().is_some_and(Gantry::is_squaring)
    }
}

//! An axis with two drives (gantry): supervision of its skew, and squaring.
//!
//! Law      while the axis is on, its skew is at most `max_skew`; while homing searches for the square position, the
//!          same applies to the change of the skew. A larger skew causes skew_reaction in the cycle in which it
//!          appears, and twice that removes the power of both drives in any case. Switching off, stops and failures act
//!          on both drives
//! Reads    its gantry with both drives
//! Writes   the difference that its gantry holds: that at switching on, and square once homing has found it
//! Refuses  to be switched on beyond `max_skew`, or without the position of the second drive
//! Source   contract section 3, docs/homing.md

use crate::axis::state::{Axis, Context, Failure, Power};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::gantry::{Found, Gantry, GantryError};
use crate::position::Position;
use crate::profile::Limits;
use crate::state::AxisState;

impl Axis {
    /// Returns the index of its gantry among those of the machine; none for an axis with one drive.
    #[inline]
    pub fn gantry(&self) -> Option<u16> {
        self.setup.gantry
    }

    /// Converts a distance of its drives to the direction of the axis (inc).
    pub fn in_axis_direction(&self, counts: i64) -> i64 {
        self.turn_counts(counts)
    }

    /// Checks whether it may be switched on with its two drives at their positions.
    ///
    /// # Errors
    /// They are too far from square, or their skew is unknown.
    pub fn admits_skew(&self, gantry: &Gantry) -> Result<(), Refusal> {
        if self.status.power() != Power::Off {
            return Ok(());
        }
        self.check_skew_at_present(gantry).map_err(|(code, found, limit)| self.refuse(code).with(found, limit))
    }

    /// Checks whether its gantry could be held with both drives at their positions.
    fn check_skew_at_present(&self, gantry: &Gantry) -> Result<(), (Code, Number, Number)> {
        let (skew, limit) = (gantry.skew(), self.parameters.gantry.skew_limit());
        match () {
            () if !gantry.is_second_read() => Err((Code::SECOND_UNREAD, Number::None, Number::None)),
            () if skew.saturating_abs() <= limit => Ok(()),
            () => Err((Code::SKEW, Number::Position(self.turn_counts(skew)), Number::Position(limit))),
        }
    }

    /// Returns the failure that prevents switching on with its two drives at their positions.
    pub(super) fn switch_on_failure(&self, cx: &Context<'_>) -> Option<Failure> {
        let (code, found, limit) = self.check_skew_at_present(cx.gantry.as_deref()?).err()?;
        Some(Failure::of(code).with(found, limit).before_motion().taking_power())
    }

    /// Reads the motion of its second drive.
    pub(in crate::axis) fn read_second(&mut self, cx: &Context<'_>) {
        self.brake.set_second_change(cx.gantry.as_deref().map_or(0, Gantry::second_change));
    }

    /// Supervises the skew of both drives.
    pub(in crate::axis) fn supervise_gantry(&mut self, cx: &mut Context<'_>) {
        let Some(gantry) = cx.gantry.as_deref_mut() else { return };
        if gantry.has_new_coordinate() {
            self.note_new_coordinate();
        }
        if gantry.is_assumed() {
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::SQUARE_ASSUMED);
            cx.events.push(Event { position: self.feedback.position(), ..event });
        }
        let is_left = if self.brake.had_power() {
            let stops = matches!(self.status.state(), AxisState::Stopping | AxisState::ErrorStop)
                || self.status.power() != Power::On;
            let limits = if stops { self.stop_limits() } else { self.squaring_limits() };
            let is_left = !self.homing.is_running() && gantry.stop_squaring(&limits, cx.cycle);
            gantry.advance(cx.cycle);
            is_left
        } else {
            gantry.hold_present_difference()
        };
        self.brake.set_second_moves(gantry.is_squaring());
        if is_left {
            // The second drive is between its old position and square; the zero does not show where.
            self.homing.forget();
        }
        let limit = self.parameters.gantry.skew_limit();
        let is_run = self.is_on() || matches!(self.status.power(), Power::DriveStops { .. });
        let failure = match gantry.error(cx.cycle, limit, self.homing.is_running()).filter(|_| is_run) {
            // Data of different cycles show neither that the skew lasts nor that it has ended.
            None if is_run && !gantry.is_fresh() => return,
            None => {
                gantry.set_skew_exceeded(false);
                return;
            }
            Some(GantryError::Unread) => Failure::of(Code::SECOND_UNREAD),
            Some(GantryError::Skewed(by)) => {
                let lasts = gantry.set_skew_exceeded(true);
                let is_far = by.saturating_abs() > limit.saturating_mul(2);
                let by = Number::Position(self.turn_counts(by));
                let failure = Failure::of(Code::SKEW).with(by, Number::Position(limit)).lasting(lasts);
                if is_far { failure.taking_power() } else { failure }
            }
        };
        self.raise(cx, failure.before_motion());
    }

    /// Returns the limits of the second drive for squaring.
    fn squaring_limits(&self) -> Limits {
        let p = &self.parameters;
        let acceleration = p.homing_acceleration();
        Limits {
            velocity: p.homing_index_velocity(),
            acceleration,
            deceleration: p.deceleration_limit() * (acceleration / p.max_acceleration),
            shape: p.default_goal_shape(),
        }
    }

    /// Clears earlier edges at the start of homing.
    pub(in crate::axis) fn forget_edges(&mut self, cx: &mut Context<'_>) {
        if let Some(gantry) = cx.gantry.as_deref_mut() {
            self.observed.set_home(gantry.begin_search());
        }
    }

    /// Begins a leg of the search.
    pub(in crate::axis) fn begin_leg_of_both(cx: &mut Context<'_>) {
        if let Some(gantry) = cx.gantry.as_deref_mut() {
            gantry.begin_leg();
        }
    }

    /// Whether one drive has left its switch, by more than a bouncing contact explains, before the other drive reached
    /// its own.
    pub(in crate::axis) fn has_passed_switch(&self, cx: &Context<'_>) -> bool {
        cx.gantry.as_deref().is_some_and(|gantry| gantry.has_passed(self.parameters.gantry.skew_limit()))
    }

    /// Whether the second drive moves into a limit switch during squaring.
    pub(in crate::axis) fn squares_into_limit(&self, cx: &Context<'_>) -> bool {
        let way = cx.gantry.as_deref().filter(|gantry| gantry.is_squaring()).and_then(Gantry::squaring_is_upward);
        way.is_some_and(|up| if up { self.observed.switches().positive } else { self.observed.switches().negative })
    }

    /// Returns the distance moved with the switch of only one drive active, and the allowed distance, if it exceeds
    /// that.
    pub(in crate::axis) fn distance_with_one_switch(&self, cx: &Context<'_>) -> Option<(i64, i64)> {
        let limit = self.parameters.gantry.squaring_limit();
        let gone = cx.gantry.as_deref()?.differs_for()?;
        (gone > limit).then_some((gone, limit))
    }

    /// Moves the second drive to square by the edges of both switches, and returns the position of the edge of the
    /// first drive; none for an axis with one drive.
    ///
    /// # Errors
    /// The necessary and the allowed distance; none if the edge of one drive is missing.
    pub(in crate::axis) fn square(&mut self, cx: &mut Context<'_>) -> Result<Option<Position>, (Number, Number)> {
        let (limits, most) = (self.squaring_limits(), self.parameters.gantry.squaring_limit());
        let Some(gantry) = cx.gantry.as_deref_mut() else { return Ok(None) };
        let Found { square, way, gone } = gantry.found().ok_or((Number::None, Number::None))?;
        if way.saturating_abs() > most {
            return Err((Number::Position(self.turn_counts(way)), Number::Position(most)));
        }
        gantry.begin_squaring(square, &limits, cx.cycle);
        self.brake.set_second_moves(gantry.is_squaring());
        Ok(Some(self.feedback.position() - Position::whole(self.turn_counts(gone))))
    }

    /// Whether its second drive is being squared.
    pub(in crate::axis) fn is_squaring(cx: &Context<'_>) -> bool {
        cx.gantry.as_deref().is_some_and(Gantry::is_squaring)
    }
}

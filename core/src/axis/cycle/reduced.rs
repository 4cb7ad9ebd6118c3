//! The reduced cycle of an axis that only moves.
//!
//! Law      the same result as a full cycle in which only the motion changes
//! Reads    its plan or its leader, its limits, the data of its drive
//! Writes   nothing if any other part of the cycle is needed: the cycle then starts again as a full cycle
//! Refuses  every event, every end of a motion, and motion close to a limit

use crate::axis::state::{Axis, Coupling, Generator};
use crate::drive::DriveInput;
use crate::encoder::Lead;
use crate::parameter::ReversingRule;
use crate::position::Position;
use crate::profile::Motion;
use crate::sync::{Leads, Stepped, Transmission};
use crate::table::Table;
use std::sync::Arc;

impl Axis {
    /// As [`sense`](Self::sense), if only the position and the effort of the drive can have changed.
    #[inline]
    pub fn sense_reduced(&mut self, input: Option<&DriveInput>) {
        let Some(input) = input else { return };
        let effort = self.reported_effort(input.effort);
        self.drive_data.shown_mut().read_effort(effort);
        if !self.read_counts(input) {
            self.require_full_cycle();
        }
    }

    /// As [`begin_step`](Self::begin_step) and [`end_step`](Self::end_step), in a cycle without commands. Returns false
    /// if a full cycle is needed.
    #[inline]
    pub fn step_reduced(&mut self, cycle: u64, leads: &Leads, tables: &[Arc<Table>]) -> bool {
        let goes_on = self.continue_motion(cycle, leads, tables).is_some();
        if !goes_on {
            self.require_full_cycle();
        }
        goes_on
    }

    #[inline]
    fn continue_motion(&mut self, cycle: u64, leads: &Leads, tables: &[Arc<Table>]) -> Option<()> {
        let error = self.following_error();
        let standing = self.closes_loop_here().then(|| self.standstill_values());
        if standing.is_some_and(|standing| self.is_standstill_too_long(standing)) {
            return None;
        }
        if self.has_supervision_report()
            || !self.is_virtual() && !self.supervision.stays_within(error, &self.parameters)
        {
            return None;
        }
        let next = match self.motion.generator() {
            Generator::Plan(course) => {
                let next = course.continued(cycle)?;
                self.may_continue(next, course.needs_limit_check()).then_some(())?;
                self.is_inside(next.position).then_some(())?;
                next
            }
            Generator::Follow(Coupling { leader, follower, .. }) => {
                let lead = leads.get(*leader);
                match *follower.transmission() {
                    Transmission::Gear(gear) => self.follow_reduced(lead, gear.stepped(lead.change)?)?,
                    Transmission::Cam(cam) => self.follow_reduced(lead, cam.stepped(lead.change, tables)?)?,
                    Transmission::Approach(_) => return None,
                }
            }
            _ => return None,
        };
        if let Some(standing) = standing {
            self.store_standstill(standing);
        }
        self.status.set_led(matches!(*self.motion.generator(), Generator::Follow(_)));
        self.travel.at_limits_mut().note_within();
        self.command.execute(next);
        self.note_direction();
        self.supervision.note_step(cycle, self.feedback.change(), self.rest_tolerance());
        if !self.is_virtual() {
            self.supervision.set_following_error(error);
        }
        self.command.streamed_mut().pass();
        let asked = self.commanded_increment();
        self.supervision.keep(asked);
        self.set_drive_outputs(asked);
        self.show_virtual(Position::ZERO);
        Some(())
    }

    /// Returns the motion of a slave that is synchronized with its leader.
    #[inline]
    fn follow_reduced(&mut self, lead: Lead, (change, behind): (Position, impl Stepped)) -> Option<Motion> {
        let rule = self.parameters.reversing().rule;
        let follower = self.motion.follower()?;
        let following = follower.follow(self.command.motion(), (lead, change), &behind, self.cycle_s(), rule)?;
        self.may_continue(following.motion, true).then_some(())?;
        self.motion.follower_mut()?.keep(&following, behind);
        Some(following.motion)
    }

    /// Whether the axis may continue with `next`: the motion needs no stop or reversal, and starts inside the limits.
    #[inline]
    fn may_continue(&self, next: Motion, is_watched: bool) -> bool {
        // False for NaN.
        let leads_on = next.velocity >= 0.0
            || next.velocity < 0.0
                && (self.command.velocity() < 0.0 || self.parameters.reversing().rule == ReversingRule::Always);
        leads_on
            && self.travel.at_limits().is_free()
            && self.is_inside(self.command.position())
            && (!is_watched || self.is_far_from_limits(next))
    }

    /// Whether the position, rounded down to a whole increment, is inside the limits. The upper limit itself is
    /// outside.
    #[inline]
    fn is_inside(&self, place: Position) -> bool {
        let limits = &self.parameters.derived;
        (limits.low..limits.high).contains(&place.floor())
    }
}

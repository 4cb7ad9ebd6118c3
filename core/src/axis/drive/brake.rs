//! The brake of an axis, and the inputs of the machine that act on all axes.
//!
//! Law      the brake opens only while the drive holds the axis. Enable: the drive is switched on and holds, the brake
//!          opens, and the axis is enabled after release_delay. Disable, and an error that stops the axis before it
//!          removes the power: the axis stops, the brake closes, and the power is switched off after engage_delay.
//!          Without power the brake closes in the same cycle
//! Reads    the power state of the axis
//! Writes   the output of the brake
//! Source   MACS-ERR-02, MACS-IO-04, MACS-IO-08 to -10

use crate::axis::state::{Axis, BrakeConfig, Context, Edges, Power};
use crate::code::Code;
use crate::drive::DriveState;
use crate::position::Position;
use crate::state::AxisState;

impl Axis {
    /// Returns the brake that the axis itself closes and opens.
    pub(in crate::axis) fn own_brake(&self) -> Option<BrakeConfig> {
        self.setup.brake.filter(|_| !self.is_virtual())
    }

    /// Whether the axis itself closes and opens a brake.
    #[inline]
    pub fn has_own_brake(&self) -> bool {
        self.own_brake().is_some()
    }

    /// Returns the output of the own brake and its level.
    pub fn brake_output(&self) -> Option<(u16, bool)> {
        self.own_brake().map(|brake| (brake.output, self.brake.is_closed() == brake.closes_with_one))
    }

    /// Whether the error reaction or an abort requests the brake.
    #[inline]
    pub fn is_brake_requested(&self) -> bool {
        self.status.is_brake_requested()
    }

    /// Whether the brake is requested in this cycle, also if it was requested before.
    #[inline]
    pub fn is_brake_requested_now(&self) -> bool {
        self.brake.is_requested_now()
    }

    /// Requests the brake, for an error or its remaining reaction. Also closes a brake that was opened after the last
    /// request.
    pub(in crate::axis) fn request_brake(&mut self, asks: bool) {
        self.status.request_brake(asks);
        self.brake.request_now(asks);
    }

    /// Whether the brake is closed, as far as the axis controls it.
    pub(in crate::axis) fn is_braked(&self) -> bool {
        if self.own_brake().is_some() { self.brake.is_closed() } else { self.status.is_brake_requested() }
    }

    /// Whether a motion command is active.
    #[inline]
    pub fn is_commanded(&self) -> bool {
        use AxisState::{ContinuousMotion, DiscreteMotion, Homing, SynchronizedMotion};
        matches!(self.status.state(), DiscreteMotion | ContinuousMotion | SynchronizedMotion | Homing)
    }

    /// Stores the edges of the machine inputs of this cycle.
    pub fn set_edges(&mut self, edges: Edges) {
        self.brake.set_edges(edges);
    }

    /// Called when the drive is in operation and holds: opens the brake first, if there is one.
    pub(in crate::axis) fn power_is_on(&mut self, cycle: u64) -> Power {
        // The reason for the closed brake has ended: the error was reset, or the abort ended with the power.
        self.status.release_brake();
        if self.own_brake().is_some() { Power::Opening { since: cycle } } else { Power::On }
    }

    /// Whether the given time of the brake has elapsed.
    pub(super) fn has_brake_time_elapsed(&self, cycle: u64, since: u64, time: impl Fn(BrakeConfig) -> u64) -> bool {
        let elapsed = cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        self.own_brake().is_none_or(|brake| elapsed >= time(brake))
    }

    /// Switches off the power of an axis at rest, after the closing time of its own brake.
    pub(in crate::axis) fn switch_off_after_brake(&mut self, cycle: u64) {
        if matches!(self.status.power(), Power::Closing { .. }) {
            return;
        }
        let since = self.brake.closed_since().unwrap_or(cycle);
        let holds = self.has_brake_time_elapsed(cycle, since, |brake| brake.engage_ns);
        self.status.set_power(if holds { Power::Off } else { Power::Closing { since } });
    }

    /// Whether a drive that stops by itself has stopped, and the closing time of the brake has elapsed.
    pub(in crate::axis) fn has_stopped_by_itself(&self, cycle: u64) -> bool {
        let Power::DriveStops { since, .. } = self.status.power() else { return true };
        let has_elapsed = |closed| self.has_brake_time_elapsed(cycle, closed, |brake| brake.engage_ns);
        let is_held = self.brake.closed_since().is_some_and(has_elapsed);
        self.has_drive_stopped(cycle, since) && (self.own_brake().is_none() || is_held)
    }

    /// Whether the drive is at rest, has switched itself off, or has exceeded the time for stopping.
    fn has_drive_stopped(&self, cycle: u64, since: u64) -> bool {
        let stops = matches!(self.drive_data.shown().state(), DriveState::QuickStop | DriveState::Enabled);
        // A drive that has not received the command yet is at rest for another reason. A slow motion has no counts in
        // some cycles.
        let has_heard = cycle.saturating_sub(since) > self.delay().saturating_add(1);
        let stands = has_heard && self.encoder_is_at_rest() && !self.turns(cycle);
        !stops || stands || self.has_timed_out(cycle, since)
    }

    /// Commands the brake according to the power state of this cycle.
    pub(in crate::axis) fn command_brake(&mut self, cycle: u64) {
        let holds = match self.status.power() {
            // An error reaction closes it although the power is on.
            Power::On | Power::SwitchingOff | Power::Opening { .. } => !self.status.is_brake_requested(),
            // The drive stops by itself and then switches itself off.
            Power::DriveStops { since, .. } => !self.brake.is_closed() && !self.has_drive_stopped(cycle, since),
            _ => false,
        };
        self.brake.hold(holds, cycle);
    }

    /// Whether a reset that `is_due` may be executed: the motor no longer coasts without power, or the time for waiting
    /// has elapsed.
    pub(in crate::axis) fn may_reset(&mut self, cycle: u64, is_due: bool) -> bool {
        let coasts = is_due && self.status.power() == Power::Off && !self.is_virtual() && self.turns(cycle);
        let since = self.brake.coasts_since(coasts, cycle);
        is_due && (!coasts || self.has_timed_out(cycle, since))
    }

    /// Whether an axis whose command is at rest is at rest itself, so that the power may be switched off and the brake
    /// closed. The wait is limited like that of a reset for a coasting motor. There is no wait if the axis runs away.
    /// In open loop the wait has ended before.
    pub(in crate::axis) fn has_settled_or_timed_out(&mut self, cycle: u64) -> bool {
        let since = self.brake.settles_since(cycle);
        let is_led = !self.is_virtual() && !self.is_open_loop();
        let settles = is_led && (self.moves() || !self.is_compensated()) && !self.runs_away();
        !settles || self.has_timed_out(cycle, since)
    }

    /// Whether its encoder and that of the second drive are at rest.
    pub(in crate::axis) fn encoder_is_at_rest(&self) -> bool {
        self.feedback.velocity() == 0.0 && self.feedback.change() == Position::ZERO && self.brake.second_change() == 0
    }

    /// Executes the edges of the machine inputs.
    pub(in crate::axis) fn execute_inputs(&mut self, cx: &mut Context<'_>) {
        let edges = self.brake.take_edges();
        if edges.clears && (!self.alarm.is_none() || self.drive_fails(cx)) {
            self.brake.wait_to_clear();
        }
        if edges.interrupts {
            self.stop_simulated_master(cx);
            self.interrupt(cx);
        }
        if self.status.state() != AxisState::Stopping {
            self.brake.set_interrupted(false);
        }
        self.brake.wait_to_resume(edges.resumes, self.alarm.is_none());
    }

    /// Whether I_BREAK has stopped the axis.
    pub(in crate::axis) fn is_interrupted(&self) -> bool {
        self.brake.is_interrupted()
    }

    /// Ends the active motion, stops, and locks the axis until it is resumed or reset.
    fn interrupt(&mut self, cx: &mut Context<'_>) {
        // An axis that is already locked remains so: only reset_errors unlocks it.
        let is_locked = matches!(self.status.state(), AxisState::ErrorStop | AxisState::Stopping);
        let was_on = self.is_on();
        self.stop_and_lock(cx, Code::INTERRUPTED);
        if was_on && !is_locked {
            self.brake.set_interrupted(true);
            // As after an error: with ERRCOND 1 and 3 the brake closes once the axis is at rest.
            let closes = matches!(self.parameters.error_reaction, 1 | 3);
            self.supervision.react_after_stop(if closes { 3 } else { -1 });
        }
    }
}

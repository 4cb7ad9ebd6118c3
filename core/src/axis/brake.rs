//! The brake of an axis, and what inputs of the machine do to it.
//!
//! Law      the power comes first and goes last: enable switches the drive on, holds, opens the brake, and the axis is enabled
//!          release_delay later; disable, and an error that stops the axis before it takes the power, stop it, close the brake, and
//!          the power goes engage_delay later. Without power to hold it the brake is closed, in the same cycle
//! Reads    what the axis wants of its drive
//! Writes   the output of the brake
//! Source   MACS-ERR-02, MACS-IO-04, MACS-IO-08 to -10

use super::power::Power;
use super::{Axis, AxisState, Context};
use crate::code::Code;
use crate::drive::DriveState;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// A brake that its axis closes before the power goes and opens once the power is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrakeConfig {
    /// Its output, by its place in section `io`.
    pub output: u16,
    /// The output is 1 while it is closed; else while it is open.
    pub closes_with_one: bool,
    /// How long it takes to open (ns): until then the axis holds, and does not move.
    pub release_ns: u64,
    /// How long it takes to close (ns): until then the axis holds with its power.
    pub engage_ns: u64,
}

/// What inputs of the machine ask of all axes in this cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edges {
    /// I_ERRCLR: errors are cleared.
    pub clears: bool,
    /// I_BREAK: what runs is aborted.
    pub interrupts: bool,
    /// I_CONTINUE: what was aborted may go on.
    pub resumes: bool,
}

/// Brake and inputs of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Holding {
    /// The axis' own brake is closed.
    closed: bool,
    /// Since that cycle.
    closed_at: u64,
    edges: Edges,
    /// I_ERRCLR waits for the axis to stand.
    pub(super) clears: bool,
    /// I_CONTINUE does.
    pub(super) resumes: bool,
    /// Since when a reset waits for an axis without power to stand.
    pub(super) coasts_since: Option<u64>,
    /// Since when the command of an axis stands that is to stand before its power goes or its brake closes.
    pub(super) settles_since: Option<u64>,
    /// The axis had power when this cycle began.
    pub(super) had_power: bool,
    /// Something of this cycle asks for the brake.
    pub(super) asks_anew: bool,
    /// I_BREAK has stopped it.
    pub(super) interrupted: bool,
    /// An abort has stopped it.
    pub(super) aborted: bool,
    /// When a stop that locks came last, and which.
    pub(super) locked: Option<(u64, Code)>,
    /// A second drive goes its own way.
    pub(super) second_moves: bool,
    /// What its place changed by with its last fresh word (inc).
    pub(super) second_change: i64,
}

impl Default for Holding {
    fn default() -> Self {
        Self {
            closed: true,
            closed_at: 0,
            edges: Edges::default(),
            clears: false,
            resumes: false,
            coasts_since: None,
            settles_since: None,
            had_power: false,
            asks_anew: false,
            interrupted: false,
            aborted: false,
            locked: None,
            second_moves: false,
            second_change: 0,
        }
    }
}

impl Holding {
    /// Does nothing wait, and has nothing been asked in this cycle?
    pub(super) fn is_settled(&self, has_power: bool) -> bool {
        let waits = self.clears || self.resumes || self.coasts_since.is_some() || self.settles_since.is_some();
        let is_stopped = self.interrupted || self.aborted;
        !waits && !is_stopped && !self.asks_anew && self.had_power == has_power && self.edges == Edges::default()
    }
}

impl Axis {
    /// The brake that it closes and opens itself.
    pub(super) fn own_brake(&self) -> Option<BrakeConfig> {
        self.setup.brake.filter(|_| !self.is_virtual())
    }

    /// Does it close and open one itself?
    #[inline]
    pub fn has_own_brake(&self) -> bool {
        self.own_brake().is_some()
    }

    /// Its output and the level there.
    pub fn brake_output(&self) -> Option<(u16, bool)> {
        self.own_brake().map(|brake| (brake.output, self.holding.closed == brake.closes_with_one))
    }

    /// Asks its error reaction, or an abort, for the brake?
    #[inline]
    pub fn asks_for_brake(&self) -> bool {
        self.brake
    }

    /// Does it ask in this cycle, whatever it asked before?
    #[inline]
    pub fn asks_anew(&self) -> bool {
        self.holding.asks_anew
    }

    /// An error asks for the brake, or what it has left to do: also where somebody has opened it since it was asked for last.
    pub(super) fn ask_for_brake(&mut self, asks: bool) {
        self.brake |= asks;
        self.holding.asks_anew |= asks;
    }

    /// Is the brake closed, as far as the axis itself knows?
    pub(super) fn is_braked(&self) -> bool {
        if self.own_brake().is_some() { self.holding.closed } else { self.brake }
    }

    /// Is a motion command active?
    #[inline]
    pub fn is_commanded(&self) -> bool {
        use AxisState::{ContinuousMotion, DiscreteMotion, Homing, SynchronizedMotion};
        matches!(self.state, DiscreteMotion | ContinuousMotion | SynchronizedMotion | Homing)
    }

    /// What inputs of the machine ask in this cycle.
    pub fn take_edges(&mut self, edges: Edges) {
        self.holding.edges = edges;
    }

    /// The drive is in operation and holds: opens the brake first, if there is one.
    pub(super) fn power_is_on(&mut self, cycle: u64) -> Power {
        // What had closed it is over: an error was reset, an abort ended with the power.
        self.brake = false;
        if self.own_brake().is_some() { Power::Opening { since: cycle } } else { Power::On }
    }

    /// Has the brake had its time?
    pub(super) fn has_passed(&self, cycle: u64, since: u64, time: impl Fn(BrakeConfig) -> u64) -> bool {
        let elapsed = cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        self.own_brake().is_none_or(|brake| elapsed >= time(brake))
    }

    /// Takes the power of an axis that stands: once its own brake has had its time to close.
    pub(super) fn give_to_brake(&mut self, cycle: u64) {
        if matches!(self.power, Power::Closing { .. }) {
            return;
        }
        let since = if self.holding.closed { self.holding.closed_at } else { cycle };
        let holds = self.has_passed(cycle, since, |brake| brake.engage_ns);
        self.power = if holds { Power::Off } else { Power::Closing { since } };
    }

    /// Has a drive that stops by itself done so, and the brake had its time behind it?
    pub(super) fn has_stopped_by_itself(&self, cycle: u64) -> bool {
        let Power::DriveStops { since, .. } = self.power else { return true };
        let is_held = self.holding.closed && self.has_passed(cycle, self.holding.closed_at, |brake| brake.engage_ns);
        self.has_drive_stopped(cycle, since) && (self.own_brake().is_none() || is_held)
    }

    /// Does it stand, has it switched itself off, or should it have stopped long ago?
    fn has_drive_stopped(&self, cycle: u64, since: u64) -> bool {
        let stops = matches!(self.shown.state(), DriveState::QuickStop | DriveState::Enabled);
        // One that has not heard of it yet stands for another reason, and one that creeps counts nothing in some cycles.
        let has_heard = cycle.saturating_sub(since) > self.delay().saturating_add(1);
        let stands = has_heard && self.encoder_stands() && !self.turns(cycle);
        !stops || stands || self.has_timed_out(cycle, since)
    }

    /// The brake goes with the power of this cycle.
    pub(super) fn work_brake(&mut self, cycle: u64) {
        let holds = match self.power {
            // An error reaction closes it though the power holds.
            Power::On | Power::SwitchingOff | Power::Opening { .. } => !self.brake,
            // The drive stops by itself, and switches itself off then.
            Power::DriveStops { since, .. } => !self.holding.closed && !self.has_drive_stopped(cycle, since),
            _ => false,
        };
        if !holds && !self.holding.closed {
            self.holding.closed_at = cycle;
        }
        self.holding.closed = !holds;
    }

    /// A reset `is_due`: does no motor coast any more that it would let go, or has it coasted for as long as it is waited for?
    pub(super) fn may_reset(&mut self, cycle: u64, is_due: bool) -> bool {
        let coasts = is_due && self.power == Power::Off && !self.is_virtual() && self.turns(cycle);
        let since = self.holding.coasts_since.unwrap_or(cycle);
        self.holding.coasts_since = coasts.then_some(since);
        is_due && (!coasts || self.has_timed_out(cycle, since))
    }

    /// Its command stands: does it, too, so that its power may go and its brake close? It is waited for, as long as a
    /// reset waits for one that coasts, and not at all where it runs away instead. A coast in open loop has been waited for already.
    pub(super) fn has_come_to_rest(&mut self, cycle: u64) -> bool {
        let since = *self.holding.settles_since.get_or_insert(cycle);
        let is_led = !self.is_virtual() && !self.is_open_loop();
        let settles = is_led && (self.moves() || !self.has_taken_up()) && !self.runs_away();
        !settles || self.has_timed_out(cycle, since)
    }

    /// Does its encoder stand still, and that of its second drive?
    pub(super) fn encoder_stands(&self) -> bool {
        self.actual.velocity == 0.0 && self.actual.change == Position::ZERO && self.holding.second_change == 0
    }

    /// Does what inputs of the machine ask.
    pub(super) fn obey_inputs(&mut self, cx: &mut Context<'_>) {
        let edges = std::mem::take(&mut self.holding.edges);
        if edges.clears && (!self.alarm.is_none() || self.drive_fails(cx)) {
            self.holding.clears = true;
        }
        if edges.interrupts {
            self.stop_simulated_master(cx);
            self.interrupt(cx);
        }
        if self.state != AxisState::Stopping {
            self.holding.interrupted = false;
        }
        self.holding.resumes |= edges.resumes;
        self.holding.resumes &= self.holding.interrupted && self.alarm.is_none();
    }

    /// Has I_BREAK stopped it?
    pub(super) fn is_interrupted(&self) -> bool {
        self.holding.interrupted
    }

    /// Ends what runs, stops, and locks the axis until it is resumed or reset.
    fn interrupt(&mut self, cx: &mut Context<'_>) {
        // What is locked already stays so: nothing but reset_errors lets it go on.
        let is_locked = matches!(self.state, AxisState::ErrorStop | AxisState::Stopping);
        let was_on = self.is_on();
        self.stop_and_lock(cx, Code::INTERRUPTED);
        if was_on && !is_locked {
            self.holding.interrupted = true;
            // As after an error: the brake closes with ERRCOND 1 and 3, once the axis stands.
            self.judge.after_stop = if matches!(self.parameters.error_reaction, 1 | 3) { 3 } else { -1 };
        }
    }
}

//! Monitoring in each cycle, after the commands.

use super::execute::MotionEffects;
use super::pid::{Gains, Options};
use super::scale::{self, HIGHEST, LOWEST};
use super::{Parameters, Phase, Saia, Starting};
use crate::event::Refusal;
use crate::vocabulary::{Order, View};

/// Length of the position range (counts), by which the position wraps.
const RANGE: i64 = 1 << 31;

impl Saia {
    /// Executes one step at t_k, after the commands of the cycle.
    pub(crate) fn step(&mut self, view: &View<'_>) -> Option<Order> {
        if self.phase == Phase::Power {
            return None;
        }
        self.wrap(view);
        self.watch_index(view);
        self.watch_break(view);
        self.note_error_of_axis(view);
        self.update_phase(view);
        if self.supervise_error(view) {
            let mut deed = MotionEffects::default();
            let latch = self.stop_latch;
            self.turn_off(view, &mut deed);
            self.stop_latch = latch;
            return Some(Self::off_order(view));
        }
        self.run_unused_controller(view);
        self.waiting_order(view)
    }

    /// Handles an order of [`step`](Self::step) that the axis rejected: a start after the drive was switched on.
    pub(crate) fn order_failed(&mut self, refusal: Refusal) {
        self.starting = Starting::default();
        if self.phase.moves() {
            self.phase = Phase::Hold;
            self.profile_done = true;
            self.flags.on_dest = true;
        }
        self.note_error(refusal.code);
    }

    /// Wraps the position register at 2^30 to the other end (SAIA-PRF-07).
    pub(super) fn wrap(&mut self, view: &View<'_>) {
        let position = self.position(view);
        if self.phase == Phase::Power || (LOWEST..=HIGHEST).contains(&position) {
            return;
        }
        let turns = position.saturating_sub(LOWEST).div_euclid(RANGE);
        self.zero = self.zero.saturating_add(turns.saturating_mul(RANGE));
        self.flags.wrapped |= self.working.by_velocity;
        self.handle_position_jump();
    }

    /// Adjusts to a change of all positions by `by` (inc). No edge was counted, so a zero of the vocabulary keeps its
    /// place, and with it the break position.
    pub(crate) fn shift_positions(&mut self, by: i64) {
        match self.phase {
            Phase::Power => {}
            _ if self.shares_zero => self.handle_position_jump(),
            _ => self.zero = self.zero.saturating_add(by),
        }
    }

    /// Adjusts to a new value of the actual position without motion, which passes no break position.
    pub(crate) fn handle_position_jump(&mut self) {
        if let Some(breaks) = &mut self.breaks {
            breaks.side = None;
        }
    }

    /// Latches the first index after the command, once (SAIA-DET-12).
    fn watch_index(&mut self, view: &View<'_>) {
        if self.armed.is_none_or(|since| since == view.cycle) {
            return;
        }
        if let Some(place) = view.index {
            self.index = place.floor().saturating_sub(self.zero).clamp(LOWEST, HIGHEST);
            self.flags.index = true;
            self.armed = None;
        }
    }

    /// Sets the flag once, when the actual position reaches or passes the break position (A21).
    fn watch_break(&mut self, view: &View<'_>) {
        let position = self.position(view);
        let Some(breaks) = &mut self.breaks else { return };
        let side = position.saturating_sub(breaks.position).signum();
        if side == 0 || side != *breaks.side.get_or_insert(side) {
            self.breaks = None;
            self.flags.passed = true;
        }
    }

    /// Updates the phase after changes of the drive, the profile and the owner of the axis.
    fn update_phase(&mut self, view: &View<'_>) {
        let before = self.phase;
        if !view.owns || view.in_error {
            // Another owner has the axis: a waiting start is cancelled.
            self.starting = Starting::default();
            self.phase = if view.on { Phase::Hold } else { Phase::Off };
        } else if self.starting.waits || (self.starting.switched && !view.on) {
            return;
        } else {
            self.starting = Starting::default();
            let is_virtual = view.interface.is_none();
            if !view.on {
                self.phase = Phase::Off;
            } else if (self.phase == Phase::Off && !is_virtual) || (self.phase.moves() && view.rests) {
                // Another command has enabled it; or the profile is done.
                self.phase = Phase::Hold;
            }
        }
        if before.moves() && !self.phase.moves() {
            self.profile_done = true;
        }
        let ended = before.moves() || (before == Phase::Hold && self.phase == Phase::Off);
        if ended && !self.phase.moves() {
            self.flags.on_dest = true;
        }
    }

    /// Sets the flag of the position error. Returns true if that switches the controller off (SAIA-STA-07).
    fn supervise_error(&mut self, view: &View<'_>) -> bool {
        let regulates = !self.is_off() && view.owns && view.on && !self.starting.waits;
        let exceeds = regulates && self.exceeds(view);
        self.flags.error |= exceeds;
        exceeds && self.error_stops
    }

    /// Sets the flag if an error of the axis in the same inputs ends the control by this vocabulary, which was active
    /// until then (SAIA-FSM-15). The axis handles its drive by its error_reaction.
    fn note_error_of_axis(&mut self, view: &View<'_>) {
        let regulated = view.owned && !self.is_off() && !self.starting.waits;
        self.flags.error |= regulated && self.exceeds(view);
    }

    fn exceeds(&self, view: &View<'_>) -> bool {
        view.following_error.unsigned_abs() > self.error_limit.unsigned_abs()
    }

    /// Computes the output of the controller if the drive or another law closes the loop.
    fn run_unused_controller(&mut self, view: &View<'_>) {
        if view.closes_loop {
            return;
        }
        if self.is_off() || !view.on || self.starting.waits {
            // The sampling continues.
            scale::samples(&mut self.sample_rest, view.cycle_ns);
            self.pid.clear();
            return;
        }
        let gains = self.gains;
        self.sample(&view.parameters.vocabularies.saia, &gains, view.cycle_ns, view.following_error);
    }

    /// Executes the controller that closes the loop of the axis: returns its output for an error (counts), -1 to 1.
    /// Before the module is initialised it uses the present registers.
    pub(crate) fn close_loop(&mut self, p: &Parameters, cycle_ns: u64, error: i64) -> f64 {
        let gains = if self.phase == Phase::Power { Gains::of(p) } else { self.gains };
        self.sample(p, &gains, cycle_ns, error);
        let code = self.pid.converter_code(p.output_gain, self.pwm);
        f64::from(code) / if self.pwm { 128.0 } else { 2048.0 }
    }

    /// Clears output and history of the controller, because the axis was switched off (SAIA-PID-05, SAIA-PID-06).
    pub(crate) fn open_loop(&mut self) {
        self.pid.clear();
    }

    /// Skips the time in which the axis was held and the controller was not stepped: the change of the error is no
    /// motion to be damped.
    pub(crate) fn skip_unsampled_time(&mut self) {
        self.pid.forget_past();
    }

    /// Executes the controller for a cycle, which has a number of chip samples and a remainder (SAIA-SW-01).
    fn sample(&mut self, p: &Parameters, gains: &Gains, cycle_ns: u64, error: i64) {
        let options = Options { clamp_sum: p.clamp_sum, chip_integral: p.chip_integral };
        let count = scale::samples(&mut self.sample_rest, cycle_ns);
        self.pid.run_cycle(gains, options, error, (count, scale::in_samples(cycle_ns)));
    }
}

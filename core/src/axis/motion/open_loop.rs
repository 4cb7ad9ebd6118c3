//! An axis without position loop: its drive runs at a speed or at none, and the command is the actual position.
//!
//! Law      command = actual position and commanded speed; without a speed the drive coasts, and counts as at rest once
//!          its encoder is at rest, or after 5 s
//! Reads    speeds commanded by a vocabulary
//! Writes   the generator; the speed is 0 in the cycle of a halt, a stop, an error
//! Refuses  positions, profiles and couplings; speeds beyond max_velocity or further into a software limit
//! Source   WF-OLC-01, WF-OLC-09, WF-OLC-11, WF-SET-02

use crate::axis::state::{Axis, Context, Failure, Generator, Power};
use crate::code::Code;
use crate::drive::{Interface, SpeedOutputs, Switching};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::position::Position;
use crate::profile::Motion;
use crate::state::{AxisState, Reference};

/// Time without a speed after which an axis counts as at rest, whatever its encoder shows (ns).
const COAST_TIMEOUT_NS: u64 = 5_000_000_000;

impl Axis {
    pub(in crate::axis) fn is_open_loop(&self) -> bool {
        !self.is_virtual() && self.setup.interface == Interface::OpenLoop
    }

    /// Returns an error if there is no position loop.
    pub(in crate::axis) fn check_closed_loop(&self) -> Result<(), Refusal> {
        match *self.motion.generator() {
            _ if self.is_open_loop() => Err(self.refuse(Code::OPEN_LOOP)),
            Generator::OutAn { .. } => Err(self.refuse(Code::OUT_AN_RUNS)),
            _ => Ok(()),
        }
    }

    /// Executes [`advance`](Self::advance) for such an axis.
    pub(super) fn advance_open(&mut self, cx: &mut Context<'_>) {
        self.command.execute(Motion { velocity: self.speed(), ..Motion::at_rest(self.feedback.position()) });
        if self.stop_at_switch(cx, self.command.motion()) {
            return;
        }
        match *self.motion.generator() {
            Generator::Open { velocity } => {
                if let Some(limit) = self.limit_ahead(velocity) {
                    self.stop_speed_at(cx, velocity, limit);
                }
            }
            Generator::Coast { since } if !self.has_run_down(cx.cycle, since) => {}
            _ => self.motion.rest(),
        }
    }

    /// Whether the drive has come to rest. It must have had time to receive the command, as it may be at rest because
    /// it has not started yet.
    fn has_run_down(&self, cycle: u64, since: u64) -> bool {
        let elapsed = cycle.saturating_sub(since);
        self.encoder_is_at_rest() && elapsed > self.delay().saturating_add(1)
            || elapsed.saturating_mul(self.setup.cycle_ns) > COAST_TIMEOUT_NS
    }

    /// Returns the software limit (inc) which the axis has reached, if `velocity` leads further into it.
    pub(super) fn limit_ahead(&self, velocity: f64) -> Option<i64> {
        let limit = self.limit(velocity > 0.0);
        let here = self.feedback.position();
        let reached = if velocity > 0.0 { here >= Position::whole(limit) } else { here <= Position::whole(limit) };
        (velocity != 0.0 && reached).then_some(limit)
    }

    /// Switches the axis off at a limit; without a ramp it cannot stop before it.
    pub(super) fn stop_speed_at(&mut self, cx: &mut Context<'_>, velocity: f64, limit: i64) {
        let up = velocity > 0.0;
        let code = if up { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE };
        let event = Event::new(Severity::Warn, Kind::Limit, self.object(), code);
        cx.events.push(Event { position: Position::whole(limit), ..event });
        self.raise(cx, Failure::of(code).with(Number::None, Number::Position(limit)).at_limit());
    }

    /// Runs the drive at a speed (inc/s), or switches it off.
    ///
    /// # Errors
    /// A speed that is invalid or too high, a limit ahead, an axis that is not free or closes a position loop. 0 is
    /// always accepted in open loop.
    pub(in crate::axis) fn set_speed(&mut self, cx: &mut Context<'_>, velocity: f64) -> Result<(), Refusal> {
        if velocity == 0.0 && self.is_open_loop() {
            // A stop is never refused, whatever the state of the axis, and ends reference travel as well.
            self.end_all_motion(cx, Code::REPLACED);
            self.switch_speed_off(cx);
            return Ok(());
        }
        self.check_free()?;
        let refuse = |code, limit| Err(Refusal::new(code, self.object()).with(Number::Velocity(velocity), limit));
        if !self.is_open_loop() {
            return refuse(Code::CLOSED_LOOP, Number::None);
        }
        if !velocity.is_finite() {
            return refuse(Code::BAD_NUMBER, Number::None);
        }
        if velocity.abs() > self.parameters.max_velocity {
            return refuse(Code::VELOCITY_TOO_HIGH, Number::Velocity(self.parameters.max_velocity));
        }
        self.check_forward(velocity)?;
        self.check_velocity_switches(velocity)?;
        if let Some(limit) = self.limit_ahead(velocity) {
            return refuse(Code::LIMIT_VIOLATION, Number::Position(limit));
        }
        self.command.execute(Motion { velocity, ..Motion::at_rest(self.feedback.position()) });
        self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Speed, Generator::Open { velocity });
        Ok(())
    }

    /// Switches the speed off from this cycle on: the axis coasts.
    pub(in crate::axis) fn switch_speed_off(&mut self, cx: &mut Context<'_>) {
        self.status.end_reference();
        self.command.rest_at(self.feedback.position());
        self.motion.coast(cx.cycle);
        let homes_no_more = self.status.state() == AxisState::Homing && !self.homing.is_running();
        if self.status.state() == AxisState::ContinuousMotion || homes_no_more {
            self.set_state(cx, AxisState::DiscreteMotion);
        }
    }

    /// Returns the speed for the drive (inc/s).
    pub(in crate::axis) fn speed(&self) -> f64 {
        match *self.motion.generator() {
            Generator::Open { velocity } if self.is_on() => velocity,
            _ => 0.0,
        }
    }

    /// Returns the outputs that it switches, by their indices in section `io`; none if it switches none.
    pub fn speed_outputs(&self) -> Option<SpeedOutputs> {
        Some(self.setup.open_loop).filter(|wiring| *wiring != SpeedOutputs::default())
    }

    /// Returns the values of these outputs.
    pub fn switching(&self) -> Switching {
        self.switching_of(self.allowed(self.vocabularies.switching()))
    }

    /// Limits the outputs to those allowed. The end of the speed ends the axis output and the voltage in the same
    /// cycle; an error, or a command of another owner, ends the direction as well.
    pub(crate) fn allowed(&self, asked: Switching) -> Switching {
        let commanded = self.status.owner().drives_outputs()
            && self.status.power() == Power::On
            && !matches!(self.status.state(), AxisState::ErrorStop | AxisState::Stopping);
        let runs = commanded && self.speed() != 0.0;
        Switching {
            forward: asked.forward && commanded,
            backward: asked.backward && commanded,
            output: asked.output && runs,
            dac: if runs && asked.dac.is_finite() { asked.dac } else { 0.0 },
        }
    }
}

//! The position loop, for a drive that does not close it itself.
//!
//! Law      one of [`Law`], once a cycle while the axis is on. Output 1 is the full reference, which is max_velocity if
//!          the drive takes velocities. An axis that is off, or whose drive homes by itself, has output 0, and the
//!          state of its loop is reset
//! Reads    command and actual position of the cycle
//! Writes   the output, from which the command to the drive follows
//! Refuses  a TIMER that is no whole number of cycles; parameters with which the inner loops cannot run
//! Source   MACS-REG-01, MACS-REG-04, MACS-REG-12, WF-CLC-03

use crate::axis::state::{Axis, PositionLoop, Power};
use crate::code::Code;
use crate::drive::{Interface, MODE_HOMING};
use crate::encoder::source::Feedback;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::regulator::{Law, PidInput, Proportional};

/// Checks whether the loops that are closed here can run with these parameters and this cycle time.
///
/// # Errors
/// The key of the invalid parameter, and the reason.
pub fn may_close_loop(
    interface: Option<Interface>,
    law: Law,
    parameters: &AxisParameters,
    cycle_ns: u64,
) -> Result<(), (&'static str, Code)> {
    if !closes_loop(interface) {
        return Ok(());
    }
    if law == Law::Pid && cycles(parameters.pid.period_ms, cycle_ns).is_none() {
        return Err(("timer", Code::LOOP_PERIOD));
    }
    if law == Law::Integer {
        crate::vocabulary::check_loop(parameters)?;
    }
    let amplifier = &parameters.amplifier;
    match interface {
        Some(Interface::Torque) => amplifier.check(cycle_ns)?,
        Some(Interface::Voltage) => parameters.power_stage.check(amplifier, cycle_ns)?,
        _ => return Ok(()),
    }
    // A position loop directly around a torque has no damping; around a voltage the back EMF damps (MACS-AMP-03).
    if amplifier.has_current_loop() && !amplifier.has_velocity_loop() {
        match law {
            Law::Proportional => return Err(("ampmode", Code::NO_DAMPING)),
            Law::Pid if parameters.pid.derivative == 0 => return Err(("kder", Code::NO_DAMPING)),
            Law::Pid => {}
            Law::Integer => crate::vocabulary::check_damping(parameters)?,
        }
    }
    if Feedback::decode(parameters.encoder.encodertype) == Some(Feedback::Simulated) {
        return Err(("encodertype", Code::SIMULATED_EFFORT));
    }
    Ok(())
}

/// Whether the position loop of such a drive is closed here.
fn closes_loop(interface: Option<Interface>) -> bool {
    interface.is_some_and(Interface::closes_loop_here)
}

/// Returns the cycles in a period if that is a whole number.
fn cycles(period_ms: i64, cycle_ns: u64) -> Option<u32> {
    let period_ns = u64::try_from(period_ms).ok()?.checked_mul(1_000_000)?;
    let count = u32::try_from(period_ns.checked_div(cycle_ns)?).ok()?;
    (count > 0 && period_ns % cycle_ns == 0).then_some(count)
}

impl Axis {
    /// Whether its position loop is closed here.
    #[inline]
    pub(in crate::axis) fn closes_loop_here(&self) -> bool {
        !self.is_virtual() && closes_loop(Some(self.setup.interface))
    }

    /// Whether the loops that are closed here are active. A drive that homes by itself closes its own loops.
    pub(in crate::axis) fn has_loops(&self) -> bool {
        self.is_on() && self.drive_data.shown().mode() != MODE_HOMING
    }

    /// Whether the loops already have their outputs of this cycle, or a closed brake holds the axis under power. With a
    /// closed brake nothing is integrated, and the effort stays unchanged until the brake opens.
    fn has_outputs(&mut self) -> bool {
        let has_brake = self.own_brake().is_some() || self.parameters.outputs.brake != 0;
        let is_held = has_brake
            && self.is_braked()
            && self.rests()
            && matches!(self.status.power(), Power::On | Power::SwitchingOff);
        let was_held = std::mem::replace(&mut self.loops.position_mut().is_held, is_held);
        if was_held && !is_held {
            self.loops.position_mut().pid.restart_after_gap();
            if self.setup.law == Law::Integer {
                self.vocabularies.forget_loop_past();
            }
        }
        self.note_stepped() || is_held
    }

    /// Whether its loops can run with its parameters.
    pub(in crate::axis) fn can_close_loop(&self) -> bool {
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let loops = may_close_loop(interface, self.setup.law, &self.parameters, self.setup.cycle_ns);
        loops.and(self.may_find_velocity_with(&self.parameters)).is_ok()
    }

    /// Whether its loop may change its output at rest.
    pub(in crate::axis) fn regulates(&self) -> bool {
        let has_past = self.setup.law != Law::Proportional || self.has_effort_command();
        self.closes_loop_here() && has_past && self.is_on()
    }

    /// Advances the loop by one cycle and returns its velocity (inc/s) for a drive that takes velocities, and true if
    /// no loop was advanced.
    #[inline]
    pub(in crate::axis) fn close_loop(&mut self) -> (f64, bool) {
        if !self.has_loops() {
            *self.loops.position_mut() = PositionLoop::default();
            if self.setup.law == Law::Integer {
                self.vocabularies.open_loop();
            }
            return (0.0, false);
        }
        if self.has_outputs() {
            return (self.loops.position().velocity, true);
        }
        let (full, rate) = self.full_reference();
        if let Some((value, _)) = self.out_an() {
            let state = self.loops.position_mut();
            *state = PositionLoop { output: value, velocity: value * full, ..*state };
            self.loops.position_mut().pid.restart_after_gap();
            if self.setup.law == Law::Integer {
                self.vocabularies.open_loop();
            }
            return (value * full, false);
        }
        // The loop moves the motor, not the load.
        let is_idle = self.loops.compensation().is_idle();
        let ahead = if is_idle { 0 } else { self.turn_counts(self.loops.compensation().ahead()) };
        let command = self.command.position() + Position::whole(ahead);
        let p = &self.parameters;
        let velocity = match self.setup.law {
            Law::Proportional => {
                let regulator = Proportional { gain: p.position_loop.kv, max_velocity: p.max_velocity };
                regulator.velocity(command, self.feedback.position())
            }
            Law::Pid => {
                let input = PidInput {
                    error: (command - self.feedback.position()).to_f64(),
                    velocity: self.command.velocity() / full,
                    // With a counted leader the acceleration is that of single counts.
                    acceleration: if self.status.is_led() { 0.0 } else { self.command.acceleration() / rate },
                };
                let cycles = cycles(p.pid.period_ms, self.setup.cycle_ns).unwrap_or(1);
                self.loops.position_mut().pid.step(&p.pid, cycles, input) * full
            }
            Law::Integer => {
                let error =
                    self.commanded_increment().saturating_add(ahead).saturating_sub(self.feedback.position().floor());
                self.vocabularies.close_loop(&self.parameters, self.setup.cycle_ns, error) * full
            }
        };
        let keeps = self.loops.position_mut();
        (keeps.output, keeps.velocity) = ((velocity / full).clamp(-1.0, 1.0), velocity);
        (velocity, false)
    }

    /// Returns the reference at output 1 (inc/s, inc/s^2). A change of max_velocity does not act on an active motion,
    /// unless the motion needs more.
    pub(in crate::axis) fn full_reference(&mut self) -> (f64, f64) {
        let now = (self.parameters.max_velocity, self.parameters.max_acceleration);
        let is_enough = |(full, _): &(f64, f64)| !self.rests() && self.command.velocity().abs() <= *full;
        let full = self.loops.position().full.filter(is_enough).unwrap_or(now);
        self.loops.position_mut().full = Some(full);
        full
    }

    /// Returns the velocity at output 1 that was used last (inc/s).
    pub(in crate::axis) fn full_velocity_in_use(&self) -> f64 {
        self.loops.position().full.map_or(self.parameters.max_velocity, |(full, _)| full)
    }

    /// Returns the sum of errors of the PID controller (inc).
    pub(in crate::axis) fn error_sum(&self) -> f64 {
        self.loops.position().pid.sum()
    }

    /// Returns the output of the position loop, -1 to 1; 0 if the drive closes it.
    pub(in crate::axis) fn regulator_output(&self) -> f64 {
        self.loops.position().output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Proves: MACS-REG-04
    #[test]
    fn a_period_is_a_whole_number_of_cycles() {
        for (ms, cycle_ns, expected) in [
            (1, 1_000_000, Some(1)),
            (1, 125_000, Some(8)),
            (1, 250_000, Some(4)),
            (1000, 125_000, Some(8000)),
            (2, 400_000, Some(5)),
            (1, 400_000, None),
            (1, 2_000_000, None),
            (3, 2_000_000, None),
            (0, 1_000_000, None),
            (-1, 1_000_000, None),
            (1, 0, None),
        ] {
            assert_eq!(cycles(ms, cycle_ns), expected, "{ms} ms, {cycle_ns} ns");
        }
    }
}

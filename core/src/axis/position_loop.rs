//! The position loop that is closed here, for a drive that does not close it.
//!
//! Law      one of [`Law`], once a cycle while the axis is on: its output, 1 for the full reference, which is max_velocity where
//!          the drive takes velocities. An axis that is off, or whose drive homes by itself, has no output, and its loop no past
//! Reads    command and actual position of the cycle
//! Writes   the output, and through it what the drive is asked for
//! Refuses  a TIMER that is no whole number of cycles; what the loops below it cannot run with
//! Source   MACS-REG-01, MACS-REG-04, MACS-REG-12, WF-CLC-03

use super::Axis;
use super::power::Power;
use crate::code::Code;
use crate::drive::{Interface, MODE_HOMING};
use crate::encoder::source::Feedback;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::regulator::{Law, Pid, PidInput, Proportional};
use serde::{Deserialize, Serialize};

/// What the loop keeps from cycle to cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PositionLoop {
    pid: Pid,
    /// -1 to 1
    output: f64,
    /// The same as a velocity (inc/s).
    velocity: f64,
    /// What 1 is: max_velocity and max_acceleration as they were when the axis came to rest last. They hold with the next motion.
    full: Option<(f64, f64)>,
    /// A closed brake holds the axis: nothing is stepped.
    is_held: bool,
}

impl PositionLoop {
    pub(super) fn is_sound(&self) -> bool {
        let is_full = |(velocity, acceleration): (f64, f64)| velocity > 0.0 && acceleration > 0.0;
        self.pid.is_sound() && self.output.abs() <= 1.0 && self.velocity.is_finite() && self.full.is_none_or(is_full)
    }
}

/// Can the loops that are closed here run with these parameters, in cycles of that length?
///
/// # Errors
/// The key that cannot be, and why.
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
    // A position loop right above a torque damps nothing; above a voltage the back EMF does (MACS-AMP-03).
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

/// Is the position loop of such a drive closed here?
fn closes_loop(interface: Option<Interface>) -> bool {
    interface.is_some_and(Interface::closes_loop_here)
}

/// Cycles in a period, if that is a whole number.
fn cycles(period_ms: i64, cycle_ns: u64) -> Option<u32> {
    let period_ns = u64::try_from(period_ms).ok()?.checked_mul(1_000_000)?;
    let count = u32::try_from(period_ns.checked_div(cycle_ns)?).ok()?;
    (count > 0 && period_ns % cycle_ns == 0).then_some(count)
}

impl Axis {
    /// Is its position loop closed here?
    #[inline]
    pub(super) fn closes_loop_here(&self) -> bool {
        !self.is_virtual() && closes_loop(Some(self.setup.interface))
    }

    /// Do the loops run that are closed here? A drive that homes by itself closes its own.
    pub(super) fn has_loops(&self) -> bool {
        self.is_on() && self.shown.mode() != MODE_HOMING
    }

    /// Have they their outputs of this cycle already, or does a closed brake hold the axis under power? What it holds is not integrated,
    /// and the effort stays what it was, for when it opens.
    fn has_outputs(&mut self) -> bool {
        let has_brake = self.own_brake().is_some() || self.parameters.outputs.brake != 0;
        let is_held =
            has_brake && self.is_braked() && self.rests() && matches!(self.power, Power::On | Power::SwitchingOff);
        let was_held = std::mem::replace(&mut self.position_loop.is_held, is_held);
        if was_held && !is_held {
            self.position_loop.pid.forget_past();
            if self.setup.law == Law::Integer {
                self.vocabularies.forget_loop_past();
            }
        }
        self.note_stepped() || is_held
    }

    /// Can its loops run with its parameters?
    pub(super) fn can_close_loop(&self) -> bool {
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let loops = may_close_loop(interface, self.setup.law, &self.parameters, self.setup.cycle_ns);
        loops.and(self.may_find_velocity_with(&self.parameters)).is_ok()
    }

    /// Does its loop change its output while nothing moves?
    pub(super) fn regulates(&self) -> bool {
        let has_past = self.setup.law != Law::Proportional || self.takes_effort();
        self.closes_loop_here() && has_past && self.is_on()
    }

    /// One cycle of the loop: the velocity that it asks for (inc/s), where the drive takes velocities. True where nothing was stepped.
    #[inline]
    pub(super) fn close_loop(&mut self) -> (f64, bool) {
        if !self.has_loops() {
            self.position_loop = PositionLoop::default();
            if self.setup.law == Law::Integer {
                self.vocabularies.open_loop();
            }
            return (0.0, false);
        }
        if self.has_outputs() {
            return (self.position_loop.velocity, true);
        }
        let (full, rate) = self.full_reference();
        if let Some((value, _)) = self.out_an() {
            self.position_loop = PositionLoop { output: value, velocity: value * full, ..self.position_loop };
            self.position_loop.pid.forget_past();
            if self.setup.law == Law::Integer {
                self.vocabularies.open_loop();
            }
            return (value * full, false);
        }
        // The motor is led, not the load.
        let is_idle = self.compensation.is_idle();
        let ahead = if is_idle { 0 } else { self.turn_counts(self.compensation.ahead()) };
        let command = self.command.position + Position::whole(ahead);
        let p = &self.parameters;
        let velocity = match self.setup.law {
            Law::Proportional => {
                let regulator = Proportional { gain: p.position_loop.kv, max_velocity: p.max_velocity };
                regulator.velocity(command, self.actual.position)
            }
            Law::Pid => {
                let input = PidInput {
                    error: (command - self.actual.position).to_f64(),
                    velocity: self.command.velocity / full,
                    // The acceleration behind a leader that is counted is that of single counts.
                    acceleration: if self.is_led { 0.0 } else { self.command.acceleration / rate },
                };
                let cycles = cycles(p.pid.period_ms, self.setup.cycle_ns).unwrap_or(1);
                self.position_loop.pid.step(&p.pid, cycles, input) * full
            }
            Law::Integer => {
                let error = self.asked().saturating_add(ahead).saturating_sub(self.actual.position.floor());
                self.vocabularies.close_loop(&self.parameters, self.setup.cycle_ns, error) * full
            }
        };
        let keeps = &mut self.position_loop;
        (keeps.output, keeps.velocity) = ((velocity / full).clamp(-1.0, 1.0), velocity);
        (velocity, false)
    }

    /// What the output 1 is (inc/s, inc/s^2): another max_velocity changes nothing that is under way, unless that needs more.
    pub(super) fn full_reference(&mut self) -> (f64, f64) {
        let now = (self.parameters.max_velocity, self.parameters.max_acceleration);
        let is_enough = |(full, _): &(f64, f64)| !self.rests() && self.command.velocity.abs() <= *full;
        let full = self.position_loop.full.filter(is_enough).unwrap_or(now);
        self.position_loop.full = Some(full);
        full
    }

    /// The velocity that the output 1 is, as it was asked for last (inc/s).
    pub(super) fn full_in_force(&self) -> f64 {
        self.position_loop.full.map_or(self.parameters.max_velocity, |(full, _)| full)
    }

    /// The sum of errors of the PID (inc).
    pub(super) fn error_sum(&self) -> f64 {
        self.position_loop.pid.sum()
    }

    /// The output of the position loop, -1 to 1; 0 where the drive closes it.
    pub(super) fn regulator_output(&self) -> f64 {
        self.position_loop.output
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

//! The loops inside the position loop, for a drive with torque or voltage command.
//!
//! Law      AMPMODE 0: the output of the position loop is a velocity as a fraction of max_velocity; the velocity loop
//!          calculates the effort as a fraction of max_effort. AMPMODE 2: the output of the position loop is the effort
//!          itself. Both are limited by AMPMAXCUR if the current is known. With voltage interface this effort is the
//!          setpoint of the current loop, which calculates the voltage; AMPMODE 1 and 3 are modes 0 and 2 without
//!          current loop and without limit
//! Reads    the output of the position loop, the changes of the actual position, the effort that the drive reports
//! Writes   the effort for the drive; displayed velocity, current and heat; the error of I2TLIMIT
//! Refuses  parameters with which these loops cannot run
//! Source   MACS-AMP-01, MACS-AMP-02, MACS-AMP-04, MACS-AMP-07, MACS-AMP-08, MACS-I2T-01..05

use crate::axis::state::{Axis, Context, CurrentStage, Failure};
use crate::code::Code;
use crate::drive::Interface;
use crate::event::{Event, Kind, Number, Severity};
use crate::regulator::{Heat, I2t, VelocityLoop};

/// Share of I2TLIMIT below which a warning ends.
const TOLD_UNTIL: f64 = 0.8;

impl Axis {
    /// Whether the drive has a torque or voltage command.
    #[inline]
    pub(in crate::axis) fn has_effort_command(&self) -> bool {
        !self.is_virtual() && self.setup.interface.takes_effort()
    }

    /// Advances the loops by one cycle and returns the effort for the drive in the direction of the axis, for an output
    /// `asked` of the position loop. With `is_done` no loop advances.
    pub(in crate::axis) fn close_effort(&mut self, asked: f64, is_done: bool) -> f64 {
        if !self.has_loops() {
            self.loops.effort_mut().clear();
            return 0.0;
        }
        let (full, _) = self.full_reference();
        let (full, moved) = (self.full_of_loop(full), self.velocity_change());
        let (most, has_current_loop) = (self.most_output(), self.closes_current_loop());
        let told = self.drive_data.shown().effort();
        let (p, stage, loops) = (&self.parameters.amplifier, &self.parameters.power_stage, self.loops.effort_mut());
        if is_done {
            return loops.output * p.max_effort.unwrap_or_default();
        }
        loops.way = loops.way.wrapping_add(moved);
        if loops.estimator.is_none() {
            // Invalid parameters are refused before.
            loops.estimator = p.estimator(self.setup.cycle_ns).ok();
        }
        let velocity = loops.estimator.as_mut().map_or(0.0, |estimator| estimator.step(loops.way));
        let passes_by = self.motion.generator().asks_effort();
        let output = if passes_by {
            loops.velocity = VelocityLoop::default();
            asked
        } else if p.has_velocity_loop() {
            let error = asked - velocity / full;
            loops.velocity.step_within(&p.velocity_gains(self.setup.cycle_ns), error, most)
        } else {
            asked
        };
        let output = if output.is_finite() { output.clamp(-most, most) } else { 0.0 };
        loops.output = match self.setup.interface {
            Interface::Voltage if has_current_loop => loops.current.step(stage, p, output, told),
            Interface::Voltage => {
                loops.current = CurrentStage::default();
                output
            }
            _ => output,
        };
        loops.output * p.max_effort.unwrap_or_default()
    }

    /// Whether the current loop runs here. An effort of OUTAN bypasses it.
    fn closes_current_loop(&self) -> bool {
        self.setup.interface == Interface::Voltage
            && self.parameters.amplifier.has_current_loop()
            && !self.motion.generator().asks_effort()
    }

    /// Returns the largest input of the drive, or of the current loop here, as a fraction of its full value, 0 to 1.
    fn most_output(&self) -> f64 {
        let p = &self.parameters;
        match self.setup.interface {
            Interface::Voltage if self.motion.generator().asks_effort() => 1.0,
            Interface::Voltage => p.power_stage.most(&p.amplifier),
            _ => p.amplifier.max_output(),
        }
    }

    /// Whether that part of the largest effort, or of the largest current, is commanded.
    pub(in crate::axis) fn is_at_largest_effort(&self, part: f64) -> bool {
        let (loops, p) = (self.loops.effort(), &self.parameters);
        if !self.closes_current_loop() {
            let most = self.most_output();
            return most > 0.0 && loops.output.abs() >= part * most;
        }
        let most = p.power_stage.most_current(&p.amplifier);
        loops.output.abs() >= part || most > 0.0 && loops.current.setpoint().abs() >= part * most
    }

    /// Returns the setpoint of the current loop (mA); 0 without one.
    pub(in crate::axis) fn current_setpoint(&self) -> f64 {
        self.loops.effort().current.setpoint() * 1000.0
    }

    /// Converts the effort that the drive reports to the direction in which it is commanded.
    #[inline]
    pub(in crate::axis) fn reported_effort(&self, effort: f64) -> f64 {
        if self.has_effort_command() { self.reference_across(effort) } else { self.convert_direction(effort) }
    }

    /// Returns the velocity in the velocity loop (inc/s of the axis, converted if the loop has an encoder of its own);
    /// 0 without one.
    pub(in crate::axis) fn estimated_velocity(&self) -> f64 {
        let velocity = self.loops.effort().estimator.map_or(0.0, |estimator| estimator.velocity());
        if self.has_velocity_encoder() { velocity * self.per_velocity_encoder() } else { velocity }
    }

    /// Returns the commanded effort as a fraction of the full one, -1 to 1.
    pub(in crate::axis) fn effort_output(&self) -> f64 {
        self.loops.effort().output
    }

    /// Returns AMP_GETCUR (mA) and AMP_I2TVALUE (A^2/1000).
    pub(in crate::axis) fn shown_current(&self) -> (f64, f64) {
        (self.loops.effort().heat.current(), self.loops.effort().heat.value())
    }

    /// Whether the current has to be supervised at rest, too.
    fn watches_current(&self) -> bool {
        self.has_effort_command() && self.parameters.amplifier.torque_constant > 0.0
    }

    /// Supervises the current that the drive reports, also of an axis that is off: its motor cools.
    pub(in crate::axis) fn supervise_current(&mut self, cx: &mut Context<'_>) {
        if !self.watches_current() {
            return;
        }
        let (p, loops) = (&self.parameters.amplifier, self.loops.effort_mut());
        let settings = p.i2t_settings(self.setup.cycle_ns);
        let watch = loops.watch.filter(|watch| watch.settings() == settings).unwrap_or_else(|| I2t::new(settings));
        loops.watch = Some(watch);
        let current = self.drive_data.shown().effort() / p.torque_constant * 1000.0;
        let heat = loops.heat.step(&watch, current);
        let (value, limit) = (Number::Real(loops.heat.value()), Number::Real(f64::from(settings.limit)));
        let was_told = loops.is_told;
        // A value that varies around the limit is reported once.
        loops.is_told = heat != Heat::Fine || was_told && loops.heat.value() > TOLD_UNTIL * f64::from(settings.limit);
        match heat {
            Heat::TooMuch if self.is_on() => {
                self.raise(cx, Failure::of(Code::I2T_LIMIT).with(value, limit).lasting(was_told).before_motion());
            }
            Heat::Warning if !was_told => {
                let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::I2T_NEAR);
                cx.events.push(Event { position: self.feedback.position(), ..event.with(value, limit) });
            }
            _ => {}
        }
    }
}

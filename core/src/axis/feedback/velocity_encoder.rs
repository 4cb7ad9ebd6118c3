//! The encoder of the velocity loop, if it is not that of the position loop: it is connected to the drive, on the
//! motor.
//!
//! Law      the velocity loop uses its velocity as a fraction of the full one, which is AMPENCRPM turns per minute of
//!          AMPENCRES increments, in the direction of the tens digit of POSDRCT. Only changes of its values count: the
//!          axis has no zero on it.
//!          apart = travel of the position - travel of this encoder under power, both in increments of the axis. After
//!          a section of travel in which both moved in the same direction, neither less than half as far as the other,
//!          apart is moved towards 0 by half of the longer travel. So neither a slightly different ratio nor torsion or
//!          backlash accumulates, but an encoder that stops or reverses while the other one moves is detected. More
//!          than max_following_error: one of both encoders is not the configured one
//! Reads    the values of the drive, the change of the actual position, AMPENCNO, AMPENCRES, AMPENCRPM, POSDRCT
//! Writes   the travel from which the velocity is calculated; the error, which removes the power
//! Refuses  an encoder of another axis, an axis with two drives, two directions of one encoder
//! Source   MACS-AMP-06, MACS-DIR-01, MACS-DIR-03; docs/loops.md

use crate::axis::state::velocity_feedback::Pair;
use crate::axis::state::{Axis, Context, Failure, Source, Wired};
use crate::code::Code;
use crate::drive::{DriveInput, Interface};
use crate::encoder::{Form, Reader};
use crate::event::Number;
use crate::parameter::AxisParameters;

/// Length of a section as a fraction of max_following_error, and its minimum in increments of either encoder: single
/// counts have no ratio.
const PIECE: f64 = 0.125;

const LEAST: f64 = 16.0;

/// Checks whether axis `own` may have the encoder of the velocity loop that its parameters name.
///
/// # Errors
/// The key of the invalid parameter, and the reason.
pub fn may_find_velocity(
    own: usize,
    interface: Option<Interface>,
    (wired, encoders): (Wired, usize),
    has_two_drives: bool,
    parameters: &AxisParameters,
) -> Result<(), (&'static str, Code)> {
    let encoder = parameters.amplifier.encoder;
    if !interface.is_some_and(Interface::takes_effort) || !encoder.is_separate() {
        return Ok(());
    }
    encoder.check(own.saturating_add(1), has_two_drives)?;
    // With one encoder for both loops, a tens digit of its own would make one loop accelerate what the other one
    // brakes.
    let is_one = !matches!(Source::of(wired, encoders, parameters), Ok(Source::Encoder(_)));
    if is_one && parameters.has_loop_directions() {
        return Err(("posdrct", Code::NO_VELOCITY_LOOP));
    }
    Ok(())
}

impl Axis {
    /// Checks whether its velocity loop may have the encoder that these parameters name.
    pub(in crate::axis) fn may_find_velocity_with(
        &self,
        parameters: &AxisParameters,
    ) -> Result<(), (&'static str, Code)> {
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let sources = (self.setup.wired, self.setup.encoders);
        may_find_velocity(self.setup.index.into(), interface, sources, self.setup.gantry.is_some(), parameters)
    }

    /// Whether its velocity loop has another encoder than its position loop.
    #[inline]
    pub(in crate::axis) fn has_velocity_encoder(&self) -> bool {
        self.parameters.has_velocity_encoder() && self.has_effort_command()
    }

    /// Returns the form of the values from its drive.
    fn form_of_drive(&self) -> Form {
        match (self.feedback.counter().form(), self.setup.wired) {
            // Its position has another source; the cell may define the form of the values from the drive.
            (Form::Incremental(64), Wired::Drive(form)) => form,
            (form, _) => form,
        }
    }

    /// Reads the value of the drive for the velocity loop.
    pub(in crate::axis) fn read_velocity_encoder(&mut self, input: &DriveInput) {
        if !self.has_velocity_encoder() {
            return;
        }
        let form = self.form_of_drive();
        let feedback = self.loops.velocity_feedback_mut();
        if feedback.reader.form() != form {
            feedback.reader = Reader::new(form);
        }
        feedback.change = 0;
        // A lost drive is reported as such.
        if input.online {
            let reading = feedback.reader.take(input.count, input.epoch, true);
            (feedback.change, feedback.is_lost) = (reading.change, !reading.valid);
        }
    }

    /// Whether the motion of the motor is unknown.
    pub(super) fn has_lost_velocity(&self) -> bool {
        self.loops.velocity_feedback().is_lost && self.has_velocity_encoder()
    }

    /// Returns the change of the encoder of the velocity loop in this cycle (inc of that encoder, in the direction of
    /// the axis).
    pub(in crate::axis) fn velocity_change(&self) -> i64 {
        if !self.has_velocity_encoder() {
            return self.motor_change().floor();
        }
        let change = self.turn_counts(self.loops.velocity_feedback().change);
        let sense = self.direction();
        // The direction of the position loop is that of the reference, so it also applies to this feedback.
        if sense.position == sense.velocity { change } else { change.wrapping_neg() }
    }

    /// Returns the full velocity of the encoder of the velocity loop for a full velocity `full` of the axis (inc/s,
    /// each in its own increments).
    pub(in crate::axis) fn full_of_loop(&self, full: f64) -> f64 {
        if self.has_velocity_encoder() { self.parameters.full_of_velocity_encoder(full) } else { full }
    }

    /// Returns increments of the axis per increment of the encoder of the velocity loop.
    pub(in crate::axis) fn per_velocity_encoder(&self) -> f64 {
        let full = self.full_velocity_in_use();
        full / self.full_of_loop(full)
    }

    /// Removes the power if load and motor do not move together.
    pub(in crate::axis) fn supervise_encoders(&mut self, cx: &mut Context<'_>) {
        if !self.has_velocity_encoder() {
            return;
        }
        if !self.is_on() {
            self.loops.velocity_feedback_mut().ways = Pair::default();
            return;
        }
        let ratio = self.per_velocity_encoder();
        let (load, motor) = (self.motor_change().to_f64(), self.velocity_change() as f64 * ratio);
        let allowed = self.parameters.max_following_error;
        let ways = &mut self.loops.velocity_feedback_mut().ways;
        let piece = (PIECE * allowed as f64).max(LEAST * ratio.max(1.0));
        ways.step(load, motor, piece);
        let apart = ways.distance();
        // Within a section a ratio is not detected yet.
        if apart.abs() > piece.max(allowed as f64) {
            // The cast saturates.
            let found = Number::Position(apart as i64);
            self.raise(cx, Failure::of(Code::ENCODERS_APART).with(found, Number::Position(allowed)));
        }
    }
}

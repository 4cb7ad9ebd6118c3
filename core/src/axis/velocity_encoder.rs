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

use super::reaction::Failure;
use super::source::Source;
use super::{Axis, Context, Wired};
use crate::code::Code;
use crate::drive::{DriveInput, Interface};
use crate::encoder::{Form, Reader};
use crate::event::Number;
use crate::parameter::AxisParameters;
use serde::{Deserialize, Serialize};

/// Share of the longer travel that is no difference: a ratio between half and twice the given one is tolerated.
const SHARE: f64 = 0.5;
/// Length of a section as a fraction of max_following_error, and its minimum in increments of either encoder: single
/// counts have no ratio.
const PIECE: f64 = 0.125;
const LEAST: f64 = 16.0;

/// Travel of two encoders that should be equal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Pair {
    /// Difference at the start of this section (inc).
    start_difference: f64,
    /// Travel of both since then (inc).
    load: f64,
    motor: f64,
}

impl Pair {
    fn is_sound(&self) -> bool {
        [self.start_difference, self.load, self.motor].iter().all(|way| way.is_finite())
    }

    /// Returns the difference of both.
    fn distance(&self) -> f64 {
        self.start_difference + self.load - self.motor
    }

    /// Adds these changes, in sections of length `piece`.
    fn step(&mut self, load: f64, motor: f64, piece: f64) {
        (self.load, self.motor) = (self.load + load, self.motor + motor);
        let (longer, shorter) = (self.load.abs().max(self.motor.abs()), self.load.abs().min(self.motor.abs()));
        if longer < piece {
            return;
        }
        let apart = self.distance();
        let goes_together = self.load * self.motor > 0.0 && shorter >= (1.0 - SHARE) * longer;
        let borne = if goes_together { SHARE * longer } else { 0.0 };
        let left = (apart.abs() - borne).max(0.0);
        *self = Self { start_difference: if apart < 0.0 { -left } else { left }, ..Self::default() };
        if !self.start_difference.is_finite() {
            *self = Self::default();
        }
    }
}

/// State of the encoder of the velocity loop.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct VelocityFeedback {
    reader: Reader,
    /// Change in this cycle (inc of this encoder, in its own direction).
    change: i64,
    /// Whether its value is invalid.
    is_lost: bool,
    /// Travel of position and motor under power.
    ways: Pair,
}

impl Default for VelocityFeedback {
    fn default() -> Self {
        Self { reader: Reader::new(Form::Incremental(64)), change: 0, is_lost: false, ways: Pair::default() }
    }
}

impl VelocityFeedback {
    pub(super) fn is_sound(&self) -> bool {
        self.reader.is_sound() && self.ways.is_sound()
    }
}

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
    pub(super) fn may_find_velocity_with(&self, parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let sources = (self.setup.wired, self.setup.encoders);
        may_find_velocity(self.setup.index.into(), interface, sources, self.setup.gantry.is_some(), parameters)
    }

    /// Whether its velocity loop has another encoder than its position loop.
    #[inline]
    pub(super) fn has_velocity_encoder(&self) -> bool {
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
    pub(super) fn read_velocity_encoder(&mut self, input: &DriveInput) {
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
    pub(super) fn velocity_change(&self) -> i64 {
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
    pub(super) fn full_of_loop(&self, full: f64) -> f64 {
        if self.has_velocity_encoder() { self.parameters.full_of_velocity_encoder(full) } else { full }
    }

    /// Returns increments of the axis per increment of the encoder of the velocity loop.
    pub(super) fn per_velocity_encoder(&self) -> f64 {
        let full = self.full_velocity_in_use();
        full / self.full_of_loop(full)
    }

    /// Removes the power if load and motor do not move together.
    pub(super) fn supervise_encoders(&mut self, cx: &mut Context<'_>) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Applies changes and returns the largest difference.
    fn most(changes: impl IntoIterator<Item = (f64, f64)>) -> f64 {
        let mut pair = Pair::default();
        let distances = changes.into_iter().map(|(load, motor)| {
            pair.step(load, motor, 100.0);
            pair.distance().abs()
        });
        distances.fold(0.0, f64::max)
    }

    proptest! {
        /// With a ratio between half and twice the given one, and changes in one direction, the difference is at most a
        /// section and a change.
        #[test]
        fn ratio_accumulates_no_error(ratio in 0.51..1.95_f64, changes in prop::collection::vec(0.0..50.0_f64, 1..500)) {
            prop_assert!(most(changes.iter().map(|change| (*change, change * ratio))) <= 200.0);
            prop_assert!(most(changes.iter().map(|change| (-change, -change * ratio))) <= 200.0);
        }

        /// If one encoder stops while the other one moves in any direction, the difference is the whole travel.
        #[test]
        fn motion_of_one_encoder_alone_counts_fully(changes in prop::collection::vec(-50.0..80.0_f64, 1..500), is_motor in any::<bool>()) {
            let mut pair = Pair::default();
            let mut way = 0.0;
            for change in changes {
                way += change;
                let (load, motor) = if is_motor { (0.0, change) } else { (change, 0.0) };
                pair.step(load, motor, 100.0);
                let distance = if is_motor { -pair.distance() } else { pair.distance() };
                prop_assert!((distance - way).abs() < 1e-6);
            }
        }
    }

    /// Motion in opposite directions adds up; infinite values reset the difference.
    #[test]
    fn half_as_far_is_together_and_less_is_not() {
        let mut pair = Pair::default();
        for _ in 0..100 {
            pair.step(5.0, -3.0, 100.0);
        }
        assert_eq!(pair.distance(), 800.0);
        pair.step(f64::INFINITY, 1.0, 100.0);
        assert_eq!(pair, Pair::default());
        assert!(!Pair { start_difference: f64::INFINITY, ..Pair::default() }.is_sound());
        assert_eq!(most([(100.0, 50.0)]), 0.0);
        assert_eq!(most([(100.0, 49.0)]), 51.0);
        assert_eq!(most([(99.0, 0.0)]), 99.0);
    }
}

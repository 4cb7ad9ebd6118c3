//! The encoder of the velocity loop, where that is not the one of the position loop: it sits in the drive, on the motor.
//!
//! Law      The velocity loop sees its velocity in parts of the full one, 1 for AMPENCRPM turns a minute of AMPENCRES increments, in the
//!          sense of POSDRCT's tens digit. Changes of its words count alone: no zero of the axis is one of it.
//!          apart = way of the position - way of this encoder under power, both in increments of the axis. A piece of way in which both went the
//!          same way, neither less than half as far as the other, brings it half of that nearer to 0: a ratio that is not quite the given one
//!          adds nothing up, a twist or play neither, and who stands or turns back while the other moves is told from that. More than
//!          max_following_error: one of both is not what it was taken for
//! Reads    the words of the drive, the change of the actual position, AMPENCNO, AMPENCRES, AMPENCRPM, POSDRCT
//! Writes   the way that the velocity is found from; the error, which takes the power
//! Refuses  another axis than its own, an axis with two drives, two senses of one encoder
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

/// Of the larger of both ways so much is no difference: a ratio that is less than twice, and more than half, of the given one is borne.
const SHARE: f64 = 0.5;
/// A piece of way in parts of max_following_error, and its least length in increments of either encoder: single counts have no ratio.
const PIECE: f64 = 0.125;
const LEAST: f64 = 16.0;

/// Two ways that ought to be one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Pair {
    /// How far they were apart when this piece of way began (inc).
    apart: f64,
    /// What both have gone since (inc).
    load: f64,
    motor: f64,
}

impl Pair {
    fn is_sound(&self) -> bool {
        [self.apart, self.load, self.motor].iter().all(|way| way.is_finite())
    }

    /// How far they are apart.
    fn distance(&self) -> f64 {
        self.apart + self.load - self.motor
    }

    /// Goes on by these changes, in pieces of that length.
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
        *self = Self { apart: if apart < 0.0 { -left } else { left }, ..Self::default() };
        if !self.apart.is_finite() {
            *self = Self::default();
        }
    }
}

/// What is kept of it from cycle to cycle.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct VelocityFeedback {
    reader: Reader,
    /// Change in this cycle (inc of this encoder, in its own sense).
    change: i64,
    /// Its word is none.
    is_lost: bool,
    /// Ways of position and motor under power.
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

/// May an axis of that place have the encoder of the velocity loop that its parameters name?
///
/// # Errors
/// The key that cannot be, and why.
pub fn may_find_velocity(
    own: usize,
    interface: Option<Interface>,
    (wired, encoders): (Wired, usize),
    has_two_drives: bool,
    parameters: &AxisParameters,
) -> Result<(), (&'static str, Code)> {
    let encoder = parameters.amplifier.encoder;
    if !interface.is_some_and(Interface::takes_effort) || !encoder.is_own() {
        return Ok(());
    }
    encoder.check(own.saturating_add(1), has_two_drives)?;
    // With one encoder for both, a tens digit of its own would make one loop push what the other brakes.
    let is_one = !matches!(Source::of(wired, encoders, parameters), Ok(Source::Encoder(_)));
    if is_one && parameters.turns_loops_apart() {
        return Err(("posdrct", Code::NO_VELOCITY_LOOP));
    }
    Ok(())
}

impl Axis {
    /// May its velocity loop have the encoder that such parameters name?
    pub(super) fn may_find_velocity_with(&self, parameters: &AxisParameters) -> Result<(), (&'static str, Code)> {
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let sources = (self.setup.wired, self.setup.encoders);
        may_find_velocity(self.setup.index.into(), interface, sources, self.setup.gantry.is_some(), parameters)
    }

    /// Does its velocity loop see another encoder than its position loop?
    #[inline]
    pub(super) fn has_velocity_encoder(&self) -> bool {
        self.parameters.has_velocity_encoder() && self.takes_effort()
    }

    /// What the words of its drive are.
    fn form_of_drive(&self) -> Form {
        match (self.counter.form(), self.setup.wired) {
            // Its position comes from elsewhere; the cell may say what the drive tells.
            (Form::Incremental(64), Wired::Drive(form)) => form,
            (form, _) => form,
        }
    }

    /// Reads the words of the drive for the velocity loop.
    pub(super) fn read_velocity_encoder(&mut self, input: &DriveInput) {
        if !self.has_velocity_encoder() {
            return;
        }
        let form = self.form_of_drive();
        let feedback = &mut self.velocity_feedback;
        if feedback.reader.form() != form {
            feedback.reader = Reader::new(form);
        }
        feedback.change = 0;
        // A drive that is lost is told of as such.
        if input.online {
            let reading = feedback.reader.take(input.count, input.epoch, true);
            (feedback.change, feedback.is_lost) = (reading.change, !reading.valid);
        }
    }

    /// Is it not known what the motor does?
    pub(super) fn has_lost_velocity(&self) -> bool {
        self.velocity_feedback.is_lost && self.has_velocity_encoder()
    }

    /// How far the encoder of the velocity loop has turned in this cycle (inc of that encoder, in the user's sense).
    pub(super) fn velocity_change(&self) -> i64 {
        if !self.has_velocity_encoder() {
            return self.motor_change().floor();
        }
        let change = self.turn_counts(self.velocity_feedback.change);
        let sense = self.turned();
        // The sense of the position loop is that of the reference, and so that of what is fed back here.
        if sense.position == sense.velocity { change } else { change.wrapping_neg() }
    }

    /// Full velocity of the encoder of the velocity loop, where that of the axis is `full` (inc/s, each in its own increments).
    pub(super) fn full_of_loop(&self, full: f64) -> f64 {
        if self.has_velocity_encoder() { self.parameters.full_of_velocity_encoder(full) } else { full }
    }

    /// Increments of the axis for each of the encoder of the velocity loop.
    pub(super) fn per_velocity_encoder(&self) -> f64 {
        let full = self.full_in_force();
        full / self.full_of_loop(full)
    }

    /// Takes the power where load and motor do not move together.
    pub(super) fn supervise_encoders(&mut self, cx: &mut Context<'_>) {
        if !self.has_velocity_encoder() {
            return;
        }
        if !self.is_on() {
            self.velocity_feedback.ways = Pair::default();
            return;
        }
        let ratio = self.per_velocity_encoder();
        let (load, motor) = (self.motor_change().to_f64(), self.velocity_change() as f64 * ratio);
        let allowed = self.parameters.max_following_error;
        let ways = &mut self.velocity_feedback.ways;
        let piece = (PIECE * allowed as f64).max(LEAST * ratio.max(1.0));
        ways.step(load, motor, piece);
        let apart = ways.distance();
        // Within a piece a ratio has not shown yet.
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

    /// Runs along changes and returns how far both were apart at most.
    fn most(changes: impl IntoIterator<Item = (f64, f64)>) -> f64 {
        let mut pair = Pair::default();
        let distances = changes.into_iter().map(|(load, motor)| {
            pair.step(load, motor, 100.0);
            pair.distance().abs()
        });
        distances.fold(0.0, f64::max)
    }

    proptest! {
        /// A ratio within half and twice the given one, by any changes of one sense: never further apart than a piece and a change make.
        #[test]
        fn a_ratio_adds_nothing_up(ratio in 0.51..1.95_f64, changes in prop::collection::vec(0.0..50.0_f64, 1..500)) {
            prop_assert!(most(changes.iter().map(|change| (*change, change * ratio))) <= 200.0);
            prop_assert!(most(changes.iter().map(|change| (-change, -change * ratio))) <= 200.0);
        }

        /// One that stands while the other goes to and fro and on: they are as far apart as that has come.
        #[test]
        fn a_way_alone_is_all_told(changes in prop::collection::vec(-50.0..80.0_f64, 1..500), is_motor in any::<bool>()) {
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

    /// What turned against the other is apart by both ways; what is endless begins anew.
    #[test]
    fn half_as_far_is_together_and_less_is_not() {
        let mut pair = Pair::default();
        for _ in 0..100 {
            pair.step(5.0, -3.0, 100.0);
        }
        assert_eq!(pair.distance(), 800.0);
        pair.step(f64::INFINITY, 1.0, 100.0);
        assert_eq!(pair, Pair::default());
        assert!(!Pair { apart: f64::INFINITY, ..Pair::default() }.is_sound());
        assert_eq!(most([(100.0, 50.0)]), 0.0);
        assert_eq!(most([(100.0, 49.0)]), 51.0);
        assert_eq!(most([(99.0, 0.0)]), 99.0);
    }
}

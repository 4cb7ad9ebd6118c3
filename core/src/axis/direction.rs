//! Counting direction of an axis (POSDRCT), and whether it may reverse (REVERS).
//!
//! Law      position = direction * (origin + count). Values to and from the drive are inverted only here, so that all
//!          values inside the axis are in the direction of the user. If the direction of an axis without power is
//!          changed, the axis keeps its place: its position is mirrored
//! Reads    POSDRCT, REVERS
//! Writes   nothing; the axis calls these functions wherever counts and positions meet
//! Refuses  backward motion that REVERS does not allow
//! Source   MACS-DIR-01..10, A-07, A-08, A-09

use super::alarm::NO_NUMBERS;
use super::course::{Aim, PlannedMotion, ROUNDING};
use super::overlay::Overlay;
use super::{Axis, Context, Generator};
use crate::code::Code;
use crate::drive::{Interface, Switching};
use crate::event::{Number, Refusal};
use crate::parameter::{AxisParameters, CountDirection, Polarity, ReversingRule};
use crate::position::Position;
use crate::profile::{self, Motion};
use crate::vocabulary::Notice;

/// Whether the position loop can be inverted here. A drive that closes its own position loop has to be inverted itself
///
pub fn may_turn_loop(interface: Option<Interface>, parameters: &AxisParameters) -> bool {
    !parameters.sense().position || !matches!(interface, Some(Interface::Position))
}

/// Whether outputs can give the sign of the reference. A position reference has its own sign.
pub fn may_output_sign(interface: Option<Interface>, parameters: &AxisParameters) -> bool {
    let by_speed = matches!(interface, Some(Interface::Velocity | Interface::OpenLoop));
    by_speed || parameters.reversing().polarity == Polarity::Bipolar
}

impl Axis {
    /// Returns the reference for a unipolar drive, which has no sign (inc/s).
    pub(super) fn unipolar(&self, velocity: f64) -> f64 {
        match self.parameters.reversing().polarity {
            Polarity::Bipolar => velocity,
            Polarity::Direction(_) | Polarity::Enables(_) => velocity.abs(),
        }
    }

    /// Whether outputs give the sign of the reference.
    #[inline]
    pub fn outputs_sign(&self) -> bool {
        self.parameters.reversing().polarity != Polarity::Bipolar
    }

    /// Returns the outputs that give the sign of the reference: number and level (MACS-DIR-08, MACS-DIR-09).
    pub fn sign_outputs(&self) -> [Option<(u8, bool)>; 2] {
        let backwards = self.status.is_backwards();
        match self.parameters.reversing().polarity {
            Polarity::Bipolar => [None, None],
            Polarity::Direction(output) => [Some((output, backwards)), None],
            Polarity::Enables(output) => {
                let on = self.is_on();
                [Some((output, on && !backwards)), Some((output + 1, on && backwards))]
            }
        }
    }

    /// Returns the direction of the axis. A virtual axis has no encoder and so no inverted direction.
    #[inline]
    pub(super) fn direction(&self) -> CountDirection {
        if self.is_virtual() { CountDirection::default() } else { self.parameters.sense() }
    }

    /// Converts counts of the drive to the direction of the axis (inc), and back.
    #[inline]
    pub(super) fn turn_counts(&self, counts: i64) -> i64 {
        self.direction().invert(counts)
    }

    /// Converts a value of the drive to the direction of the axis, and back.
    #[inline]
    pub(super) fn convert_direction(&self, value: f64) -> f64 {
        self.direction().invert_real(value)
    }

    /// Converts a reference to the direction in which the motor turns, that of the loop that is closed here.
    #[inline]
    pub(super) fn reference_across(&self, value: f64) -> f64 {
        let value = self.convert_direction(value);
        if self.direction().position && self.setup.interface != Interface::Position { 0.0 - value } else { value }
    }

    /// Returns the whole increment for the drive at `position`, in the direction of the axis: the lower one in the
    /// counts of the drive.
    #[inline]
    pub(super) fn commanded_increment_at(&self, position: Position) -> i64 {
        let sense = self.direction();
        sense.invert(sense.invert_position(position).floor())
    }

    /// Returns the whole increment for the drive in this cycle, in the direction of the axis.
    #[inline]
    pub(super) fn commanded_increment(&self) -> i64 {
        self.commanded_increment_at(self.command.position())
    }

    /// Returns the rest of an axis that stops at `position`: at the increment that the drive already has.
    pub(super) fn resting(&self, position: Position) -> Motion {
        Motion::at_rest(Position::whole(self.commanded_increment_at(position)))
    }

    /// Returns the outputs that choose a direction, as wired to the motor.
    pub(crate) fn switching_of(&self, shown: Switching) -> Switching {
        if self.reference_across(1.0) > 0.0 {
            return shown;
        }
        Switching { forward: shown.backward, backward: shown.forward, dac: 0.0 - shown.dac, ..shown }
    }

    /// Applies new parameters. Returns true if they mirror the axis: other copies of its position must then be
    /// mirrored, too.
    pub fn take_parameters(&mut self, parameters: AxisParameters) -> bool {
        let before = self.direction().units;
        let had_fixed_zero = self.has_fixed_zero();
        if self.parameters.invalidates_zero(&parameters) {
            self.homing.forget();
        }
        self.parameters.set(parameters);
        if had_fixed_zero && !self.is_referenced() {
            self.homing.forget_reference_of_encoder();
        }
        let turns = before != self.direction().units;
        if turns {
            self.mirror();
        }
        turns
    }

    /// Mirrors all stored positions of the axis, which is off and stays where it is.
    fn mirror(&mut self) {
        self.command.rest_at(-self.command.position());
        self.feedback.mirror();
        self.travel.mirror();
        self.observed.mirror();
        self.homing.turn_over();
        self.pending.touch_probes_mut().note_new_coordinate();
        self.supervision.fill(self.command.position().floor());
        self.vocabularies.notice(Notice::Turned);
    }

    /// Checks whether the axis may have these parameters.
    ///
    /// # Errors
    /// The loop of its drive cannot be inverted here, or the loop that is closed here cannot run.
    pub fn check_sense(&self, candidate: &AxisParameters) -> Result<(), Refusal> {
        self.admits_analog(candidate)?;
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let wired = super::may_read(self.setup.wired, self.setup.encoders, interface, candidate);
        let timed = super::may_close_loop(interface, self.setup.law, candidate, self.setup.cycle_ns);
        let (key, code) = if let Err(refused) = wired.and(timed).and(self.may_find_velocity_with(candidate)) {
            refused
        } else if !may_turn_loop(interface, candidate) {
            ("posdrct", Code::LOOP_IN_DRIVE)
        } else if !may_output_sign(interface, candidate) {
            ("revers", Code::REVERSING_BY_POSITION)
        } else {
            return Ok(());
        };
        let (parameter, row) = crate::parameter::Row::find(key).unzip();
        let asked = match row.map(|row| row.value(candidate)) {
            Some(crate::parameter::Value::Int(value)) => Number::Count(value),
            _ => Number::None,
        };
        Err(Refusal { parameter, ..Refusal::new(code, self.object()).with(asked, Number::None) })
    }

    /// Whether a motion without master may go backward.
    pub(super) fn reverses_alone(&self) -> bool {
        self.parameters.reversing().rule == ReversingRule::Always
    }

    /// Whether the axis may move backward in this cycle.
    fn may_reverse(&self) -> bool {
        match self.parameters.reversing().rule {
            ReversingRule::Always => true,
            ReversingRule::WithMaster => self.coupling().is_some_and(|coupling| coupling.follower.leader_reverses()),
            ReversingRule::Never => false,
        }
    }

    fn backwards(&self, asked: Number) -> Refusal {
        Refusal::new(Code::REVERSE_FORBIDDEN, self.object()).with(asked, Number::None)
    }

    /// Checks that a velocity is forward if REVERS requires that.
    pub(super) fn check_forward(&self, velocity: f64) -> Result<(), Refusal> {
        let good = velocity >= 0.0 || self.reverses_alone();
        if good { Ok(()) } else { Err(self.backwards(Number::Velocity(velocity))) }
    }

    /// Checks that a course is forward throughout if REVERS requires that. An axis that already moves backward (with
    /// its master) first has to stop.
    pub(super) fn check_course_forward(&self, course: &PlannedMotion, from: Motion) -> Result<(), Refusal> {
        if self.reverses_alone() {
            return Ok(());
        }
        let start = if from.velocity < 0.0 {
            profile::stop(from, &self.stop_limits(), self.setup.cycle_ns).end()
        } else {
            from.position
        };
        let rounding = Position::from_f64(ROUNDING);
        let (lowest, highest) = course.extent_from(from.position);
        match course.aim {
            // The target is behind the start, or is passed and approached again backward.
            Aim::Target(target) if lowest.min(target) < start - rounding || highest > course.end() + rounding => {
                Err(self.backwards(Number::Position(target.nearest())))
            }
            Aim::Velocity(velocity) => self.check_forward(velocity),
            _ => Ok(()),
        }
    }

    /// Checks that a waiting goal does not end behind the goal before it.
    pub(super) fn check_end_forward(&self, before: Option<Position>, end: Position) -> Result<(), Refusal> {
        let behind = before.is_some_and(|before| Position::whole(end.nearest()) < Position::whole(before.nearest()));
        if behind && !self.reverses_alone() {
            return Err(self.backwards(Number::Position(end.nearest())));
        }
        Ok(())
    }

    /// Checks that a superimposed motion is forward if REVERS requires that.
    pub(super) fn check_overlay_forward(&self, overlay: &Overlay) -> Result<(), Refusal> {
        let (down, _) = overlay.ahead();
        if down < -Position::from_f64(ROUNDING) && !self.reverses_alone() {
            return Err(self.backwards(Number::Position(down.nearest())));
        }
        Ok(())
    }

    /// Returns the motion of this cycle without a negative velocity if REVERS forbids that: the axis stops
    /// instead of turning back, and continues from there if its target is ahead.
    pub(super) fn forward(&mut self, cx: &mut Context<'_>, next: Motion) -> Motion {
        // An axis that moves backward with its master may still slow down.
        if next.velocity >= 0.0 || self.command.velocity() < 0.0 || self.may_reverse() {
            return next;
        }
        let here = self.resting(self.command.position());
        if let Generator::Plan(course) = *self.motion.generator() {
            let goes_on = match course.aim {
                Aim::Target(target) => target >= here.position,
                Aim::Velocity(velocity) => velocity > 0.0,
                Aim::Stop => false,
            };
            if goes_on {
                self.motion.plan(self.course(cx.cycle, here, course.aim, course.limits));
            } else {
                // Homing ends with the reference that it has found, wherever the axis stops.
                if course.aim != Aim::Stop && !self.homing.is_running() {
                    self.end_goal(cx, Code::REVERSE_FORBIDDEN);
                    self.pending.buffer_mut().end(
                        cx.events,
                        self.setup.index,
                        Code::NOT_REACHED,
                        here.position,
                        NO_NUMBERS,
                    );
                }
                self.motion.rest();
            }
        }
        here
    }
}

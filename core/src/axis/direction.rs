//! The sense in which an axis counts, and whether it may reverse.
//!
//! Law      position = sense * (origin + count); what goes to the drive and what comes from it is turned over at this border
//!          only, so that everything inside the axis is in the user's sense. An axis that is turned over while it is off keeps
//!          its place: its position becomes the mirror of what it was
//! Reads    POSDRCT, REVERS
//! Writes   nothing; the axis asks at each place where counts and positions meet
//! Refuses  a motion backwards where REVERS forbids it
//! Source   MACS-DIR-01..10, A-07, A-08, A-09

use super::alarm::NO_NUMBERS;
use super::course::{Aim, Course, ROUNDING};
use super::overlay::Overlay;
use super::{Axis, Context, Generator};
use crate::code::Code;
use crate::drive::{Interface, Switching};
use crate::event::{Number, Refusal};
use crate::parameter::{AxisParameters, Polarity, Rule, Sense};
use crate::position::Position;
use crate::profile::{self, Motion};
use crate::vocabulary::Notice;

/// Can a loop that is closed there be turned over here? Where a drive closes its position loop, it has to be told.
pub fn may_turn_loop(interface: Option<Interface>, parameters: &AxisParameters) -> bool {
    !parameters.sense().position || !matches!(interface, Some(Interface::Position))
}

/// Can outputs tell the sign of what the drive is given? A position has one by itself.
pub fn may_tell_sign(interface: Option<Interface>, parameters: &AxisParameters) -> bool {
    let by_speed = matches!(interface, Some(Interface::Velocity | Interface::OpenLoop));
    by_speed || parameters.reversing().polarity == Polarity::Bipolar
}

impl Axis {
    /// The reference as a unipolar drive gets it, which has no sign (inc/s).
    pub(super) fn unipolar(&self, velocity: f64) -> f64 {
        match self.parameters.reversing().polarity {
            Polarity::Bipolar => velocity,
            Polarity::Direction(_) | Polarity::Enables(_) => velocity.abs(),
        }
    }

    /// Do outputs tell the sign of its reference?
    #[inline]
    pub fn tells_sign(&self) -> bool {
        self.parameters.reversing().polarity != Polarity::Bipolar
    }

    /// The outputs that tell the sign of the reference: number and level (MACS-DIR-08, MACS-DIR-09).
    pub fn sign_outputs(&self) -> [Option<(u8, bool)>; 2] {
        let backwards = self.is_backwards;
        match self.parameters.reversing().polarity {
            Polarity::Bipolar => [None, None],
            Polarity::Direction(output) => [Some((output, backwards)), None],
            Polarity::Enables(output) => {
                let on = self.is_on();
                [Some((output, on && !backwards)), Some((output + 1, on && backwards))]
            }
        }
    }

    /// A virtual axis has no encoder that it could count against.
    #[inline]
    pub(super) fn turned(&self) -> Sense {
        if self.is_virtual() { Sense::default() } else { self.parameters.sense() }
    }

    /// A count of the drive's coordinate in the user's sense (inc).
    #[inline]
    pub(super) fn turn_counts(&self, counts: i64) -> i64 {
        self.turned().turn(counts)
    }

    /// A value of the drive in the user's sense, and the other way round.
    #[inline]
    pub(super) fn across(&self, value: f64) -> f64 {
        self.turned().turn_real(value)
    }

    /// A reference for the drive in the sense in which its motor turns: that of the loop that is closed here.
    #[inline]
    pub(super) fn reference_across(&self, value: f64) -> f64 {
        let value = self.across(value);
        if self.turned().position && self.setup.interface != Interface::Position { 0.0 - value } else { value }
    }

    /// The whole increment that the drive is asked for at `position`, in the user's sense: the lower one in its own counts.
    #[inline]
    pub(super) fn asked_at(&self, position: Position) -> i64 {
        let sense = self.turned();
        sense.turn(sense.turn_position(position).floor())
    }

    /// The whole increment that the drive is asked for in this cycle, in the user's sense.
    #[inline]
    pub(super) fn asked(&self) -> i64 {
        self.asked_at(self.command.position)
    }

    /// Where the axis rests that comes to rest at `position`: the increment that its drive was given already.
    pub(super) fn resting(&self, position: Position) -> Motion {
        Motion::at_rest(Position::whole(self.asked_at(position)))
    }

    /// The outputs that choose a direction, as they are wired to the motor.
    pub(crate) fn switching_of(&self, shown: Switching) -> Switching {
        if self.reference_across(1.0) > 0.0 {
            return shown;
        }
        Switching { forward: shown.backward, backward: shown.forward, dac: 0.0 - shown.dac, ..shown }
    }

    /// New parameters are in force from now on. True where that turns the axis over: what others keep of its position is to
    /// be mirrored as well.
    pub fn take_parameters(&mut self, parameters: AxisParameters) -> bool {
        let before = self.turned().units;
        let had_fixed_zero = self.has_fixed_zero();
        if self.parameters.loses_zero_to(&parameters) {
            self.homing.forget();
        }
        self.parameters.set(parameters);
        if had_fixed_zero && !self.knows_zero() {
            self.homing.forget_told();
        }
        let turns = before != self.turned().units;
        if turns {
            self.turn_over();
        }
        turns
    }

    /// Everything that it remembers of places: it is off, and stays where it is.
    fn turn_over(&mut self) {
        self.command = Motion::at_rest(-self.command.position);
        self.actual.position = -self.actual.position;
        self.last_direction = 0.0 - self.last_direction;
        self.index.1 = -self.index.1;
        self.homing.turn_over();
        self.touch_probes.note_new_coordinate();
        self.judge.fill(self.command.position.floor());
        self.vocabularies.notice(Notice::Turned);
    }

    /// May it have these parameters?
    ///
    /// # Errors
    /// The loop of its drive cannot be turned over here, or the loop that is closed here cannot run.
    pub fn admits_sense(&self, candidate: &AxisParameters) -> Result<(), Refusal> {
        self.admits_analog(candidate)?;
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let wired = super::may_read(self.setup.wired, self.setup.encoders, interface, candidate);
        let timed = super::may_close_loop(interface, self.setup.law, candidate, self.setup.cycle_ns);
        let (key, code) = if let Err(refused) = wired.and(timed).and(self.may_find_velocity_with(candidate)) {
            refused
        } else if !may_turn_loop(interface, candidate) {
            ("posdrct", Code::LOOP_IN_DRIVE)
        } else if !may_tell_sign(interface, candidate) {
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

    /// May a motion that no master commands go backwards?
    pub(super) fn reverses_alone(&self) -> bool {
        self.parameters.reversing().rule == Rule::Always
    }

    /// May it go backwards in this cycle?
    fn may_reverse(&self) -> bool {
        match self.parameters.reversing().rule {
            Rule::Always => true,
            Rule::WithMaster => self.coupling().is_some_and(|coupling| coupling.follower.leader_reverses()),
            Rule::Never => false,
        }
    }

    fn backwards(&self, asked: Number) -> Refusal {
        Refusal::new(Code::REVERSE_FORBIDDEN, self.object()).with(asked, Number::None)
    }

    /// A velocity leads forwards, where nothing else is allowed.
    pub(super) fn check_forward(&self, velocity: f64) -> Result<(), Refusal> {
        let good = velocity >= 0.0 || self.reverses_alone();
        if good { Ok(()) } else { Err(self.backwards(Number::Velocity(velocity))) }
    }

    /// A course leads forwards all the way, where nothing else is allowed. What moves backwards already (with its master) has to
    /// stop first.
    pub(super) fn check_course_forward(&self, course: &Course, from: Motion) -> Result<(), Refusal> {
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
            // Behind where it begins, or passed and come back to.
            Aim::Target(target) if lowest.min(target) < start - rounding || highest > course.end() + rounding => {
                Err(self.backwards(Number::Position(target.nearest())))
            }
            Aim::Velocity(velocity) => self.check_forward(velocity),
            _ => Ok(()),
        }
    }

    /// A goal that waits ends no further back than the one before it.
    pub(super) fn check_end_forward(&self, before: Option<Position>, end: Position) -> Result<(), Refusal> {
        let behind = before.is_some_and(|before| Position::whole(end.nearest()) < Position::whole(before.nearest()));
        if behind && !self.reverses_alone() {
            return Err(self.backwards(Number::Position(end.nearest())));
        }
        Ok(())
    }

    /// A superimposed motion leads forwards, where nothing else is allowed.
    pub(super) fn check_overlay_forward(&self, overlay: &Overlay) -> Result<(), Refusal> {
        let (down, _) = overlay.ahead();
        if down < -Position::from_f64(ROUNDING) && !self.reverses_alone() {
            return Err(self.backwards(Number::Position(down.nearest())));
        }
        Ok(())
    }

    /// The motion of this cycle, no velocity below 0 where that is forbidden: what would turn back stands, and goes
    /// on from there if its target lies ahead.
    pub(super) fn forward(&mut self, cx: &mut Context<'_>, next: Motion) -> Motion {
        // One that moves backwards with its master may still slow down.
        if next.velocity >= 0.0 || self.command.velocity < 0.0 || self.may_reverse() {
            return next;
        }
        let here = self.resting(self.command.position);
        if let Generator::Plan(course) = self.generator {
            let goes_on = match course.aim {
                Aim::Target(target) => target >= here.position,
                Aim::Velocity(velocity) => velocity > 0.0,
                Aim::Stop => false,
            };
            if goes_on {
                self.generator = Generator::Plan(self.course(cx.cycle, here, course.aim, course.limits));
            } else {
                // Homing ends with the zero that it has found, wherever the axis stands.
                if course.aim != Aim::Stop && !self.homing.is_running() {
                    self.end_goal(cx, Code::REVERSE_FORBIDDEN);
                    self.buffer.end(cx.events, self.setup.index, Code::NOT_REACHED, here.position, NO_NUMBERS);
                }
                self.generator = Generator::Rest;
            }
        }
        here
    }
}

//! An axis that follows the sink of a function slot.
//!
//! Law      position: each change of the sink is one of the command, exactly; profile limits do not apply. If the axis
//!          moves when the function takes over, it first reaches the velocity of the sink within its limits. Speed: the
//!          axis runs at this speed within its limits. The axis follows while it is on, and again after it was switched
//!          off and on. Any other motion or stop takes the axis from the function until the next START
//! Reads    the sink of the slot
//! Refuses  START if the axis is in error, locked, homing, or not referenced although required. In the cycle: a sink
//!          that is lost, or faster than max_velocity
//! Source   contract section 3 and 10, A-11, AMK-GEN-11, PLCopen (SYNCHRONIZED_MOTION)

use crate::axis::state::{Aim, Axis, Context, Coupling, Failure, Generator, MovedBy, Power};
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::object::Leader;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use crate::sync::follower::{Bounds, Follower};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{Disengage, SyncMode, Transmission};
use crate::vocabulary::Owner;

impl Axis {
    /// Whether the sink of a function commands the axis.
    pub fn is_led_by_function(&self) -> bool {
        self.status.reference() == Reference::Function
    }

    /// Checks whether a function with this axis as sink may start. An axis that is off follows once it is on.
    ///
    /// # Errors
    /// The reason why not.
    pub fn check_function(&self) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        match self.status.state() {
            AxisState::Disabled => self.check_settled(),
            _ => self.check_free(),
        }
    }

    /// Lets a started function move the axis from now on.
    pub fn start_following_function(&mut self, cx: &mut Context<'_>, by: MovedBy) {
        // Commands of this cycle have priority; the function then runs without its axis.
        if let Err(refusal) = self.check_function() {
            return self.warn_of(cx, refusal);
        }
        if self.status.state() == AxisState::Disabled {
            self.task.follow(by);
            self.status.refer_to(Reference::Function);
            return;
        }
        self.end_all_motion(cx, Code::REPLACED);
        self.homing.forget_end();
        self.supervision.forget_rest();
        self.task.follow(by);
        self.begin_function(cx, by);
    }

    /// The function is back in RESET: the axis stops following its sink.
    pub fn stop_following_function(&mut self, cx: &mut Context<'_>, sink: Leader) {
        if !self.task.leave_sink(sink) || self.status.reference() != Reference::Function {
            return;
        }
        if matches!(self.status.state(), AxisState::Disabled | AxisState::Standstill) {
            self.status.end_reference();
        } else {
            self.brake_to_rest(cx, &self.parameters.default_goal_limits());
        }
    }

    /// Checks whether a goal may move the axis. `by`: sink of the started function that already moves it.
    ///
    /// # Errors
    /// The reason why not.
    pub fn check_goal(&self, by: Option<Leader>) -> Result<(), Refusal> {
        match by.map_or(self.goal_failure(), |sink| self.function_failure(sink)) {
            None => Ok(()),
            Some(_) if !self.error().is_none() => Err(self.refuse(Code::IN_ERROR)),
            Some(code) => Err(self.refuse(code)),
        }
    }

    /// Returns the reason why no goal of a function can move the axis: its error, if it has one.
    fn goal_failure(&self) -> Option<Code> {
        match self.status.state() {
            _ if !self.error().is_none() => Some(self.error()),
            AxisState::Disabled => Some(Code::NOT_ENABLED),
            _ => None,
        }
    }

    /// Returns the reason why the function of that sink no longer moves the axis.
    pub fn function_failure(&self, sink: Leader) -> Option<Code> {
        let is_moved =
            self.status.reference() == Reference::Function && self.task.function().is_some_and(|by| by.sink == sink);
        self.goal_failure().or((!is_moved).then_some(Code::FUNCTION_LEFT))
    }

    /// Returns the distance from the index pulse of this cycle to the command, if the encoder had one.
    pub fn distance_from_index_to_command(&self) -> Option<Position> {
        Some(self.command.position() - self.index_of_cycle()?)
    }

    /// Ends a function that cannot continue: the axis gets the error and is no longer moved by the function.
    pub fn fail_function(&mut self, cx: &mut Context<'_>, sink: Leader, code: Code, limit: Number) {
        if self.task.leave_sink(sink) && self.status.reference() == Reference::Function {
            self.raise(cx, Failure::of(code).with(Number::None, limit));
        }
    }

    /// Follows again once the axis is on, and follows a speed when it changes.
    pub(in crate::axis) fn follow_function(&mut self, cx: &mut Context<'_>) {
        let Some(by) = self.task.function() else { return };
        if self.status.state() == AxisState::Disabled {
            self.status.refer_to(Reference::Function);
        }
        let rests = self.status.state() == AxisState::Standstill
            && self.status.power() == Power::On
            && self.task.goal().is_none();
        if rests && self.check_free().is_ok() {
            self.begin_function(cx, by);
        } else if self.status.reference() == Reference::Function
            && let (Some(speed), Generator::Plan(course)) = (by.speed, self.motion.generator())
            && course.aim != Aim::velocity(asked(cx, by.sink, speed))
        {
            self.run_at(cx, by.sink, speed);
        }
    }

    fn begin_function(&mut self, cx: &mut Context<'_>, by: MovedBy) {
        self.status.set_owner(Owner::Native);
        if let Some(speed) = by.speed {
            if self.status.state() == AxisState::Standstill && asked(cx, by.sink, speed) == 0.0 {
                // The axis rests, as commanded, until the speed changes.
                self.status.refer_to(Reference::Function);
                return;
            }
            return self.run_at(cx, by.sink, speed);
        }
        let p = &self.parameters;
        let bounds = Bounds {
            velocity: p.max_velocity,
            acceleration: p.default_goal_acceleration().min(p.deceleration_limit()),
            max_velocity: p.max_velocity,
            // The motion of the sink is executed however abrupt it is.
            max_acceleration: f64::MAX,
            max_deceleration: f64::MAX,
        };
        let present = self.present_motion();
        let (mode, transmission) = (SyncMode::Velocity, Transmission::Gear(Gear::new(Ratio::ONE)));
        let lead = cx.leads.get(by.sink);
        let follower = Follower::new(lead.uneven, transmission, mode, present, Position::ZERO, bounds);
        let follower = if present.velocity == 0.0 { follower.at_once() } else { follower };
        let (leader, disengage, accuracy) = (by.sink, Disengage::Stop, self.parameters.sync_accuracy);
        let coupling = Coupling { leader, disengage, accuracy, at_places: false, follower };
        self.begin_motion(cx, AxisState::SynchronizedMotion, Reference::Function, Generator::Follow(coupling));
    }

    /// Runs at the speed of its function.
    pub(in crate::axis) fn run_at(&mut self, cx: &mut Context<'_>, sink: Leader, speed: f64) {
        let velocity = asked(cx, sink, speed);
        let most = self.velocity_for_base();
        if velocity.abs() > most {
            let numbers = (Number::Velocity(velocity), Number::Velocity(most));
            return self.raise(cx, Failure::of(Code::FUNCTION_TOO_FAST).with(numbers.0, numbers.1));
        }
        let (from, limits) = (self.base(), self.parameters.default_goal_limits());
        let course = self.course(cx.cycle, from, Aim::velocity(velocity), limits);
        self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Function, Generator::Plan(course));
    }

    /// Returns an error if the sink exceeds the largest velocity. One more count is allowed for a counted sink of
    /// constant speed.
    pub(in crate::axis) fn check_sink(&self, change: Position, uneven: f64) -> Result<(), Failure> {
        let velocity = change.to_f64() / self.cycle_s();
        let most = self.parameters.max_velocity;
        if self.status.reference() != Reference::Function || velocity.abs() <= most + uneven / self.cycle_s() {
            return Ok(());
        }
        Err(Failure::of(Code::FUNCTION_TOO_FAST).with(Number::Velocity(velocity), Number::Velocity(most)))
    }
}

/// Returns the velocity that a sink commands (inc/s).
fn asked(cx: &Context<'_>, sink: Leader, speed: f64) -> f64 {
    cx.leads.get(sink).position.to_f64() * speed
}

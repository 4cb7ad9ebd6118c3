//! Start, end and steps of homing.

use crate::axis::state::homing::search::Search;
use crate::axis::state::homing::{Run, methods};
use crate::axis::state::{Axis, Context, Failure, InDrive, Stage};
use crate::code::Code;
use crate::command::HomingMethod;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::Limits;
use crate::state::{AxisState, Reference};
use crate::vocabulary::{Notice, Travel};

/// Interval of the messages that homing in the drive is still active (ns).
const MINUTE_NS: u64 = 60_000_000_000;

impl Axis {
    /// Starts homing.
    pub(in crate::axis) fn start_homing(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        method: HomingMethod,
    ) -> Result<(), Refusal> {
        let method = self.homing_method(method)?;
        self.check_homing()?;
        let run = self.homing_run(cx.cycle, method, &self.parameters)?;
        self.begin_goal(cx, sequence, None);
        self.begin_homing(cx, run);
        Ok(())
    }

    /// Checks a homing of an axis whose drive shows no digital inputs: each switch of the method needs an input of its
    /// own.
    ///
    /// # Errors
    /// An unknown method, or one whose switch is not read.
    pub fn check_homing_switches(&self, method: HomingMethod) -> Result<(), Refusal> {
        let method = self.homing_method(method)?;
        let p = &self.parameters;
        // The drive reads its own switches. A sequence of MACS without the input of its switch is refused anyway.
        if p.homing.in_drive || methods::is_macs(method) {
            return Ok(());
        }
        match methods::without_input(method, &p.assigned) {
            Some(switch) => {
                let refusal = self.refuse(Code::HOMING_NO_SWITCH);
                Err(refusal.with(Number::Count(method), Number::Count(switch as i64)))
            }
            None => Ok(()),
        }
    }

    /// Starts homing with the configured method, for a vocabulary.
    pub(in crate::axis) fn home_as_configured(&mut self, cx: &mut Context<'_>) -> Result<(), Refusal> {
        let method = self.homing_method(HomingMethod::Configured)?;
        self.check_homing()?;
        let run = self.homing_run(cx.cycle, method, &self.parameters)?;
        self.end_all_motion(cx, Code::REPLACED);
        self.begin_homing(cx, run);
        Ok(())
    }

    /// Starts reference travel of the positioning modules (WF-REF-01). Its legs are fixed.
    pub(in crate::axis) fn start_reference_travel(
        &mut self,
        cx: &mut Context<'_>,
        travel: &Travel,
    ) -> Result<(), Refusal> {
        self.check_homing()?;
        self.check_squares(methods::REFERENCE_TRAVEL)?;
        let way = f64::from(travel.direction);
        let [fast, reduced, _] = travel.speeds;
        let is_open = self.is_open_loop();
        self.check_forward(way * fast)?;
        if travel.back {
            self.check_forward(-way * reduced)?;
        }
        // From the mark back to the reference point.
        if !is_open && travel.shift < 0 {
            self.check_forward(-fast)?;
        }
        let run = Run {
            method: if travel.back { methods::REFERENCE_TRAVEL_BACK } else { methods::REFERENCE_TRAVEL },
            sense: travel.direction.signum(),
            speeds: travel.speeds,
            limits: Limits { velocity: fast, ..travel.limits },
            // Without a position loop the axis cannot move a distance, and the zero mark is the reference point
            // (WF-REF-02).
            goes: (!is_open).then_some(travel.shift),
            offset: if is_open { 0 } else { travel.shift }.saturating_sub(travel.value),
            began: cx.cycle,
            minutes: 0,
            stage: Stage::Search(Search::default()),
        };
        self.end_all_motion(cx, Code::REPLACED);
        self.begin_homing(cx, Some(run));
        Ok(())
    }

    /// Checks whether a vocabulary may start homing with these parameters. With `stops` the axis stops first and need
    /// not be at rest yet.
    pub(in crate::axis) fn check_configured_homing(
        &self,
        cycle: u64,
        p: &AxisParameters,
        stops: bool,
    ) -> Result<(), Refusal> {
        self.check_may_home()?;
        if !stops {
            self.check_at_rest()?;
        }
        self.homing_run(cycle, p.homing.method, p).map(|_| ())
    }

    fn check_homing(&self) -> Result<(), Refusal> {
        self.check_may_home()?;
        self.check_at_rest()
    }

    fn check_may_home(&self) -> Result<(), Refusal> {
        self.check_zero_moves()?;
        self.check_ready()?;
        if self.homing.is_running() { Err(self.refuse(Code::HOMING_UNDER_WAY)) } else { Ok(()) }
    }

    fn check_at_rest(&self) -> Result<(), Refusal> {
        if !self.rests() || self.task.goal().is_some() {
            return Err(self.not_at_standstill());
        }
        Ok(())
    }

    fn begin_homing(&mut self, cx: &mut Context<'_>, run: Option<Run>) {
        self.status.refer_to(Reference::Home);
        self.set_state(cx, AxisState::Homing);
        match run {
            // The present position is the reference.
            None => self.take_zero(cx, self.command.position() + Position::whole(self.parameters.homing.offset)),
            Some(run) => {
                self.forget_edges(cx);
                self.homing.continue_run(run);
                self.begin_leg(cx);
            }
        }
    }

    /// Returns the start of homing; none for a method without motion.
    fn homing_run(&self, cycle: u64, method: i64, p: &AxisParameters) -> Result<Option<Run>, Refusal> {
        self.check_squares(method)?;
        if matches!(method, 35 | 37) && !p.homing.in_drive {
            return Ok(None);
        }
        let named = Number::Count(method);
        if self.is_virtual() {
            return Err(self.refuse(Code::HOMING_NEEDS_DRIVE).with(named, Number::None));
        }
        self.check_closed_loop()?;
        let velocity = p.homing_velocity();
        if velocity == 0.0 {
            return Err(self.refuse(Code::HOMING_NO_VELOCITY));
        }
        let acceleration = p.homing_acceleration();
        let run = Run {
            method,
            sense: sense(if methods::is_macs(method) { velocity < 0.0 } else { self.direction().units }),
            speeds: [velocity.abs(), velocity.abs(), p.homing_index_velocity()],
            limits: Limits {
                velocity: velocity.abs(),
                acceleration,
                deceleration: p.deceleration_limit() * (acceleration / p.max_acceleration),
                shape: p.default_goal_shape(),
            },
            goes: methods::is_macs(method).then_some(p.homing.offset),
            offset: p.homing.offset,
            began: cycle,
            minutes: 0,
            stage: Stage::Search(Search::default()),
        };
        if p.homing.in_drive {
            if methods::is_macs(method) {
                return Err(self.refuse(Code::HOMING_NOT_IN_DRIVE).with(named, Number::None));
            }
            return Ok(Some(Run { stage: Stage::InDrive(InDrive::since(cycle, self.feedback.position())), ..run }));
        }
        // HOME without its input is refused.
        if methods::is_macs(method) && p.assigned.refswitch == 0 {
            return Err(self.refuse(Code::HOMING_NO_SWITCH).with(named, Number::None));
        }
        // A motion backward is refused if REVERS forbids it.
        if let Some(leg) = methods::legs(method).iter().find(|leg| leg.turns || leg.way * run.sense < 0) {
            self.check_forward(-run.speed(leg))?;
        }
        if run.goes.is_some_and(|way| way < 0) {
            self.check_forward(-velocity.abs())?;
        }
        Ok(Some(run))
    }

    /// Checks that the method squares an axis with two drives.
    fn check_squares(&self, method: i64) -> Result<(), Refusal> {
        if self.gantry().is_none() || methods::squares(method) {
            return Ok(());
        }
        Err(self.refuse(Code::GANTRY_HOMING).with(Number::Count(method), Number::None))
    }

    /// Returns the number of the method as in parameter `homing.method`: that of CiA 402, and -1 - HOME_TYPE of MACS.
    fn homing_method(&self, method: HomingMethod) -> Result<i64, Refusal> {
        let unknown =
            |number: i8, most| Err(self.refuse(Code::HOMING_UNKNOWN_METHOD).with(Number::Count(number.into()), most));
        match method {
            HomingMethod::Configured if self.parameters.homing.method == 0 => {
                Err(self.refuse(if self.is_virtual() { Code::HOMING_NEEDS_DRIVE } else { Code::HOMING_NO_METHOD }))
            }
            HomingMethod::Configured => Ok(self.parameters.homing.method),
            HomingMethod::Cia402(number @ (1..=14 | 17..=30 | 33 | 34 | 35 | 37)) => Ok(number.into()),
            HomingMethod::Macs(number @ 0..=3) => Ok(-1 - i64::from(number)),
            HomingMethod::Cia402(number) => unknown(number, Number::None),
            HomingMethod::Macs(number) => unknown(number, Number::Count(3)),
        }
    }

    /// Advances homing by one cycle, after the axis has moved and before its commands.
    pub(in crate::axis) fn step_homing(&mut self, cx: &mut Context<'_>) {
        if self.homing.take_unsure() {
            self.vocabularies.notice(Notice::ZeroLost);
        }
        if self.homing.take_lost() && !self.has_fixed_zero() {
            cx.events.push(Event::new(Severity::Warn, Kind::Warning, self.object(), Code::HOMING_LOST));
        }
        if self.homing.take_broken() && self.homing.is_running() {
            return self.fail_homing(cx, Code::HOMING_LOST, Number::None, Number::None);
        }
        if self.homing.is_running() && self.squares_into_limit(cx) {
            return self.fail_homing(cx, Code::HOMING_AT_LIMIT, Number::None, Number::None);
        }
        if self.end_if_too_long(cx) {
            return;
        }
        match self.homing.run().map(|run| run.stage) {
            Some(Stage::Search(_)) => self.search(cx),
            Some(Stage::InDrive(_)) => self.watch_drive(cx),
            Some(Stage::Found { goes: true, .. }) => self.supervise_return(cx),
            Some(Stage::Found { .. }) | None => {}
        }
    }

    /// Ends homing that exceeds `homing.max_time`, and reports each minute of homing in the drive. Returns true if it
    /// has ended.
    fn end_if_too_long(&mut self, cx: &mut Context<'_>) -> bool {
        let most = self.parameters.homing.max_time;
        let Some(run) = self.homing.run() else { return false };
        let time_ns = cx.cycle.saturating_sub(run.began).saturating_mul(self.setup.cycle_ns);
        let time = |ns: u64| Number::Time(i64::try_from(ns).unwrap_or(i64::MAX));
        if most > 0 && time_ns > most.unsigned_abs() {
            self.fail_homing(cx, Code::HOMING_TOO_LONG, time(time_ns), Number::Time(most));
            return true;
        }
        let minutes = time_ns / MINUTE_NS;
        if !run.is_own() && minutes > run.minutes {
            self.homing.note_minutes(minutes);
            let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::HOMING_LASTS);
            let event = event.with(time(minutes.saturating_mul(MINUTE_NS)), Number::None);
            cx.events.push(Event { position: self.feedback.position(), ..event });
        }
        false
    }

    /// Ends homing if the axis is at rest at the end of its motion.
    pub(in crate::axis) fn settle_homing(&mut self, cx: &mut Context<'_>) {
        let Some(Run { stage: Stage::Found { zero, .. }, .. }) = self.homing.run() else { return };
        if self.supervision.is_in_position() && Self::is_squaring(cx) {
            return;
        }
        if self.supervision.is_in_position() {
            self.take_zero(cx, zero);
        } else {
            self.report_long_wait(cx);
        }
    }

    /// Makes this position the zero and ends homing.
    pub(super) fn take_zero(&mut self, cx: &mut Context<'_>, zero: Position) {
        let shift = zero.nearest();
        let run = self.homing.finish();
        self.move_coordinate(shift.wrapping_neg());
        self.compensate_from_zero(run.map_or(0, |run| run.approach()), run.is_none_or(|run| run.is_own()));
        self.restore_limits(cx);
        self.vocabularies.notice(Notice::ZeroSet);
        self.supervision.forget_rest();
        self.status.end_reference();
        let number = Number::Position(shift);
        let homed = Event::new(Severity::Info, Kind::Homed, self.object(), Code::NONE).with(number, Number::None);
        cx.events.push(Event { position: self.command.position(), ..homed });
        if let Some(goal) = self.task.take_goal() {
            let done = Event::done(self.object(), goal.sequence, Code::NONE, self.command.position());
            cx.events.push(done.with(number, Number::None));
        }
        self.set_state(cx, AxisState::Standstill);
    }

    /// Ends homing with an error; the axis stops.
    pub(super) fn fail_homing(&mut self, cx: &mut Context<'_>, code: Code, found: Number, allowed: Number) {
        self.homing.stop();
        self.raise(cx, Failure::of(code).with(found, allowed));
    }

    /// Handles new raw counts of the drive: stored positions are no longer valid, unless homing has set the counts.
    pub(in crate::axis) fn note_new_coordinate(&mut self) {
        self.vocabularies.notice(Notice::Jumped);
        self.sources.sensor_mut().index_known = false;
        self.pending.touch_probes_mut().note_new_coordinate();
        if !self.homing.is_in_drive() {
            self.homing.break_counts();
        }
    }

    /// Checks whether the axis may have these parameters with respect to its zero. During homing neither the parameters
    /// of the zero nor the inputs of the switches may change.
    ///
    /// # Errors
    /// The zero being found would not match the new parameters, or a switch would change without a motion.
    pub fn admits_zero(&self, candidate: &AxisParameters) -> Result<(), Refusal> {
        let p = &self.parameters;
        let rewires = p.assigned != candidate.assigned
            || p.gantry.second_refswitch != candidate.gantry.second_refswitch
            || p.homing.cam_source != candidate.homing.cam_source;
        if self.homing.is_running() && (rewires || p.invalidates_zero(candidate)) {
            Err(self.refuse(Code::HOMING_UNDER_WAY))
        } else {
            Ok(())
        }
    }
}

/// Returns the direction: 1, or -1 if inverted.
fn sense(turned: bool) -> i8 {
    if turned { -1 } else { 1 }
}

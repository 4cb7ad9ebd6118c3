//! Reference selector of the Unidrive M advanced motion controller (menu 34).
//!
//! Law      each sample: direct write of 34.007, trigger, event, following-error stop, each with priority over the
//!          previous one; changes are written back; then the active reference gives its order
//! Reads    its parameters, the axis, latches, the master
//! Writes   orders; 34.002, 34.007, 38.006
//! Refuses  references that do not exist, targets beyond the integrators or the limits: the active reference is kept
//! Source   spec/amc.md
//!
//! An absolute target follows its reference. Only a change of the reference (or of the rotary mode, if that may change
//! the target) plans a new profile: between changes PIP is constant, and a new plan would give the same motion.
//!
//! A goal, halt, quick_stop, an error or another vocabulary takes over the axis and sets 34.007 to 0 without the stop
//! of the selector, which no longer controls the axis. `disable` keeps 34.007, which becomes active again, like a
//! change of its value, when the axis is enabled (M08). Homing is an exception: `disable` ends it and writes 0 (M14),
//! so that no axis starts homing when it is enabled again.
//!
//! Reference 5 stops a moving axis, and starts homing at rest; every other reference ends its homing (AMC-FSM-02..08).

mod check;
mod orders;
mod parameters;
mod rotary;
mod signals;

pub use check::{Problem, Setting, check};
pub use parameters::Wiring;
pub use signals::AmcSignal;

use super::{CamPoint, LatchView, Order, View};
use crate::code::Code;
use crate::parameter::amc::Parameters;
use crate::position::Position;
use parameters::{CAM, CAM_ON_FREEZE, GEAR, GEAR_ON_FREEZE, POSITION_ABSOLUTE, POSITION_PROFILE, POSITION_RELATIVE};
use parameters::{HOME, SPEED, STOP};
use rotary::{Circle, Exact, Mode};
use serde::{Deserialize, Serialize};

/// State of the vocabulary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amc {
    /// Active reference; 0 while the axis is off.
    select: i64,
    /// 34.009 of the last sample.
    trigger: i64,
    /// 34.003 of the last sample.
    reference: i64,
    /// 34.005 of the last sample.
    rotary_mode: i64,
    /// 34.006 of the last sample (inc/s).
    speed: f64,
    /// Profile input position, with its turns (38.006).
    input: Exact,
    /// Present or last end of a stop (34.002).
    stop: Position,
    /// Whether a software limit overrides the speed reference.
    limited: bool,
    /// Whether the axis cannot follow the speed reference: it rests until the reference changes.
    cannot_move: bool,
    /// Whether reference 5 is active and waits for the axis to come to rest.
    waits: bool,
}

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// New value of 34.007.
    pub select: i64,
    /// Order to the axis.
    pub order: Option<Order>,
    /// Error that prevents an order.
    pub problem: Option<Problem>,
}

impl Step {
    fn idle(select: i64) -> Self {
        Self { select, order: None, problem: None }
    }
}

impl Amc {
    /// Returns true if a selector that has not been used yet has work to do. Until then a step would change nothing
    /// that a later one does not detect.
    pub(crate) fn wakes(&self, p: &Parameters) -> bool {
        p.reference_select != STOP || p.reference_select_trigger != self.trigger || p.action_on_event != 0
    }

    /// Inverts the direction of counting of its axis, which is at rest.
    pub(crate) fn invert_direction(&mut self) {
        self.stop = -self.stop;
    }

    /// Executes one step at t_k, after the commands of the cycle.
    pub(crate) fn step(&mut self, view: &View<'_>) -> Step {
        let p = &view.parameters.vocabularies.amc;
        let before = *self;
        self.trigger = p.reference_select_trigger;
        self.reference = p.position_reference;
        self.rotary_mode = p.rotary_mode;
        self.speed = p.speed_reference;
        // AMC-TRG-02: the trigger has priority over a direct write.
        let written = if self.trigger == before.trigger { p.reference_select } else { self.trigger };
        let is_taken = view.free && before.select != STOP && !view.owns;
        if view.locked || is_taken {
            return self.rest(STOP);
        }
        if !view.free {
            // M14: homing ended before its completion.
            let ends = before.select == HOME && written == HOME;
            return self.rest(if ends { STOP } else { written });
        }
        self.follow_input(view);
        let mut step = Step::idle(written);
        let past = self.handle_event(view, &mut step);
        // M14: homing is complete and releases the axis.
        if before.homes() && step.select == HOME && !view.homing {
            step.select = STOP;
        }
        if step.select != STOP && self.stops_by_error(view) {
            step.select = STOP;
        }
        self.select = step.select;
        self.waits &= self.select == HOME;
        match self.reference_order(view, &before, past) {
            Ok(order) => step.order = order,
            Err(problem) => {
                (step.select, step.order) = self.order_failed(&before, view, problem.code);
                step.problem = Some(problem);
            }
        }
        if self.select != STOP {
            self.stop = orders::stop_reference(view);
        }
        step
    }

    /// Handles an order that the axis rejected, or a step that failed. A new reference is not activated, and the
    /// previous one continues. A speed that was already active has changed, and its old value is no longer valid: the
    /// axis stops, and the speed stays selected (AMC-SEL-09). A previous position is kept, unless the new one violates
    /// a limit: then the axis stops. Returns the new 34.007, and the stop.
    pub(crate) fn order_failed(&mut self, before: &Self, view: &View<'_>, code: Code) -> (i64, Option<Order>) {
        if self.select != before.select {
            // The next step detects changes of the previous reference.
            *self = Self { trigger: self.trigger, ..*before };
            return (self.select, None);
        }
        if self.select == SPEED {
            (self.limited, self.cannot_move) = (false, true);
            return (SPEED, Some(Order::Stop { limits: view.largest_limits() }));
        }
        if matches!(code, Code::LIMIT_VIOLATION | Code::REVERSE_FORBIDDEN) {
            self.rest(STOP);
            return (STOP, Some(self.begin_stop(view)));
        }
        (self.input, self.stop) = (before.input, before.stop);
        (self.select, None)
    }

    /// Returns true if the speed reference has been active since then.
    pub(crate) fn keeps_speed(&self, before: &Self) -> bool {
        self.select == SPEED && before.select == SPEED
    }

    /// Deactivates the reference. Returns a step that sets 34.007 to `written`.
    fn rest(&mut self, written: i64) -> Step {
        (self.select, self.waits, self.cannot_move) = (STOP, false, false);
        Step::idle(written)
    }

    /// Returns true if homing runs for reference 5.
    pub(crate) fn homes(&self) -> bool {
        self.select == HOME && !self.waits
    }

    /// Returns true if reference 5 waits for the axis to come to rest.
    pub(crate) fn waits_for_rest(&self) -> bool {
        self.waits
    }

    /// M14: homing is complete, and the axis rests at its end; sets 34.007 to 0.
    pub(crate) fn end_homing(&mut self, view: &View<'_>) -> Order {
        self.rest(STOP);
        self.begin_stop(view)
    }

    /// Deactivates the reference because the axis is locked, or because the waiting homing is not allowed. Returns the
    /// new 34.007.
    pub(crate) fn give_up(&mut self) -> i64 {
        self.rest(STOP).select
    }

    /// All positions change by `by`; the target follows the input position.
    pub(crate) fn shift(&mut self, by: Position) {
        self.stop += by;
    }

    /// M09: if the selector does not set the target itself, PIP is the output of the profile or the gear.
    pub(crate) fn follow_input(&mut self, view: &View<'_>) {
        let circle = Circle::new(view.modulo);
        match self.select {
            CAM | GEAR => self.input = circle.exact(view.target),
            SPEED | HOME => self.input = circle.exact(view.command.position),
            _ if !view.owns => self.input = circle.exact(view.command.position),
            _ => {}
        }
    }

    /// Handles a freeze event of this cycle. Returns the travel of the master since then, if it counts.
    fn handle_event(&self, view: &View<'_>, step: &mut Step) -> Position {
        let freeze = view.wiring.amc.freeze;
        let is_event = |latch: &&LatchView| latch.rising && Some(latch.object) == freeze;
        // The first one of several is the event.
        let first = view.latches.iter().filter(is_event).max_by_key(|latch| latch.age_ns);
        let Some(latch) = first.filter(|_| !view.at_limit) else { return Position::ZERO };
        let action = view.parameters.vocabularies.amc.action_on_event;
        match action {
            CAM_ON_FREEZE if self.select != CAM => {
                step.select = CAM;
                return travel_since_freeze(view, latch);
            }
            GEAR_ON_FREEZE if self.select != GEAR => {
                step.select = GEAR;
                return travel_since_freeze(view, latch);
            }
            _ => {}
        }
        Position::ZERO
    }

    /// AMC-STP-06: modes 2 and 3.
    fn stops_by_error(&self, view: &View<'_>) -> bool {
        let p = &view.parameters.vocabularies.amc;
        let window = p.following_error_window.unwrap_or(view.parameters.max_following_error);
        p.stop_mode >= 2 && view.following_error.unsigned_abs() > window.unsigned_abs()
    }

    /// Returns the order of the active reference, if it changes anything.
    fn reference_order(&mut self, view: &View<'_>, before: &Self, past: Position) -> Result<Option<Order>, Problem> {
        let enters = self.select != before.select;
        let changed = enters || self.reference != before.reference;
        if self.select != SPEED || enters {
            self.limited = false;
        }
        let turns = self.select != SPEED || enters || self.speed != before.speed;
        self.cannot_move &= !turns;
        let circle = Circle::new(view.modulo);
        match self.select {
            STOP if enters => Ok(Some(self.begin_stop(view))),
            POSITION_ABSOLUTE => {
                let mode = Mode::new(self.rotary_mode, view.modulo, view.cycle_ns);
                let tracks = mode.is_within_turn() && self.rotary_mode != before.rotary_mode;
                if !changed && !tracks {
                    return Ok(None);
                }
                let wanted = circle.exact(Position::whole(self.reference)).minus(circle.shown(self.input));
                self.add(view, wanted, enters)
            }
            POSITION_RELATIVE if changed => self.add(view, circle.exact(Position::whole(self.reference)), enters),
            POSITION_PROFILE if enters => Ok(self.go(view)),
            SPEED if self.cannot_move => Ok(None),
            SPEED => Ok(self.run(view, turns)),
            CAM if enters => Ok(cam_start(view).map(|from| Order::Cam { from, past })),
            GEAR if enters => Ok(Some(Order::Gear { past })),
            HOME if enters && !view.idle && !view.homing => {
                self.waits = true;
                Ok(Some(Order::Stop { limits: view.largest_limits() }))
            }
            HOME if enters || self.waits && view.idle => {
                self.waits = false;
                Ok(Some(Order::Home))
            }
            _ => Ok(None),
        }
    }

    /// Writes its signals: one word for each of [`AmcSignal`].
    pub(crate) fn publish(&self, view: &View<'_>, words: &mut [u64]) {
        let circle = Circle::new(view.modulo);
        let within = |exact: Exact| circle.position(circle.shown(exact));
        let shown = within(self.input);
        let turns = circle.turns(self.input);
        let values = [
            (AmcSignal::Active, i64::from(view.owns)),
            (AmcSignal::Select, self.select),
            (AmcSignal::StopReference, within(circle.exact(self.stop)).floor()),
            (AmcSignal::ProfileInputPosition, shown.floor()),
            (AmcSignal::ProfileInputTurns, turns),
        ];
        for (signal, value) in values {
            if let Some(word) = words.get_mut(signal as usize) {
                *word = value.cast_unsigned();
            }
        }
    }

    /// Returns true if a restored state is valid.
    pub(crate) fn is_sound(&self) -> bool {
        let kept = (!self.waits || self.select == HOME) && (!self.cannot_move || self.select == SPEED);
        (0..=POSITION_PROFILE).contains(&self.select) && kept && self.input.is_sound() && self.speed.is_finite()
    }
}

/// Start of the cam (35.001, 35.002).
fn cam_start(view: &View<'_>) -> Option<CamPoint> {
    let p = &view.parameters.vocabularies.amc;
    let point = usize::try_from(p.cam_start_index).unwrap_or(usize::MAX);
    view.wiring.amc.cam.map(|table| CamPoint { table, point, behind: p.cam_start_position })
}

/// Returns the travel of the master from the freeze point to this sample (AMC-EVT-05, M11, AMC-EVT-07).
fn travel_since_freeze(view: &View<'_>, latch: &LatchView) -> Position {
    let way = |master| latch.travel_since(master, view.leads.get(master), view.cycle_ns);
    view.wiring.amc.master.map_or(Position::ZERO, way)
}

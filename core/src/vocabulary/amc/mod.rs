//! Reference selector of the Unidrive M advanced motion controller (menu 34).
//!
//! Law      each sample: direct write of 34.007, trigger, event, following-error stop, the later the stronger; what changes by
//!          that is written back; then the reference in force gives its order
//! Reads    its parameters, the axis, latches, the master
//! Writes   orders; 34.002, 34.007, 38.006
//! Refuses  references that do not exist, targets beyond the integrators or the limits: the reference stays what it was
//! Source   spec/amc.md
//!
//! An absolute target follows its reference, but only a change of the reference (or of the rotary mode, where that may move
//! it) makes a new profile: between changes PIP stands, and planning anew would lead to the same motion.
//!
//! What takes the axis from the selector (a goal, halt, quick_stop, an error, another vocabulary) sets 34.007 to 0 without
//! its stop: the axis is not the selector's any more. `disable` leaves 34.007 as it is, and it is in force again, as a change
//! to its value, when the axis is on (M08). But one that it ends is homing, and that writes 0 (M14): nothing homes by itself
//! because it did so before.
//!
//! Reference 5 stops an axis that moves, and homes it once it stands; every other reference ends its homing (AMC-FSM-02..08).

mod check;
mod orders;
mod parameters;
mod rotary;
mod signals;

pub use check::{Problem, Setting, check};
pub use parameters::Wiring;
pub use signals::AmcSignal;

use super::{CamPoint, Latched, Order, View};
use crate::code::Code;
use crate::parameter::amc::Parameters;
use crate::position::Position;
use parameters::{CAM, CAM_ON_FREEZE, GEAR, GEAR_ON_FREEZE, POSITION_ABSOLUTE, POSITION_PROFILE, POSITION_RELATIVE};
use parameters::{HOME, SPEED, STOP};
use rotary::{Circle, Exact, Mode};
use serde::{Deserialize, Serialize};

/// What the vocabulary remembers of its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amc {
    /// The reference in force; 0 while the axis is off.
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
    /// Where a stop ends or ended (34.002).
    stop: Position,
    /// A software limit overrides the speed reference.
    limited: bool,
    /// The axis may not go where the speed reference leads: it stands until that changes.
    barred: bool,
    /// Reference 5 is in force, and its homing begins once the axis stands.
    waits: bool,
}

/// What a step asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// 34.007 as it is now.
    pub select: i64,
    /// What the axis has to do.
    pub order: Option<Order>,
    /// What could not be asked of the axis at all.
    pub problem: Option<Problem>,
}

impl Step {
    fn idle(select: i64) -> Self {
        Self { select, order: None, problem: None }
    }
}

impl Amc {
    /// Is anything asked of a selector that has not been used yet? Until then its step would change nothing that a later
    /// one does not find out by itself.
    pub(crate) fn wakes(&self, p: &Parameters) -> bool {
        p.reference_select != STOP || p.reference_select_trigger != self.trigger || p.action_on_event != 0
    }

    /// Its axis counts the other way from now on, and stands where it is.
    pub(crate) fn turn_over(&mut self) {
        self.stop = -self.stop;
    }

    /// One step at t_k, after the commands of the cycle.
    pub(crate) fn step(&mut self, view: &View<'_>) -> Step {
        let p = &view.parameters.vocabularies.amc;
        let before = *self;
        self.trigger = p.reference_select_trigger;
        self.reference = p.position_reference;
        self.rotary_mode = p.rotary_mode;
        self.speed = p.speed_reference;
        // AMC-TRG-02: the trigger is stronger than a direct write.
        let written = if self.trigger == before.trigger { p.reference_select } else { self.trigger };
        let is_taken = view.free && before.select != STOP && !view.owns;
        if view.locked || is_taken {
            return self.rest(STOP);
        }
        if !view.free {
            // M14: so much for homing, which has ended before its time.
            let ends = before.select == HOME && written == HOME;
            return self.rest(if ends { STOP } else { written });
        }
        self.follow_input(view);
        let mut step = Step::idle(written);
        let past = self.take_event(view, &mut step);
        // M14: at its end homing gives the axis back.
        if before.homes() && step.select == HOME && !view.homing {
            step.select = STOP;
        }
        if step.select != STOP && self.stops_by_error(view) {
            step.select = STOP;
        }
        self.select = step.select;
        self.waits &= self.select == HOME;
        match self.refer(view, &before, past) {
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

    /// The axis could not do what the step asked, or the step itself could not. A reference that was to come into force does
    /// not, and the one before goes on. A speed that was in force already leads elsewhere now, and what it was before is not
    /// asked for any more: the axis stops, and the speed stays selected (AMC-SEL-09). A place before has an end, and stays in
    /// force where only the way to the new one is not there. Gives 34.007 as it is then, and the stop.
    pub(crate) fn order_failed(&mut self, before: &Self, view: &View<'_>, code: Code) -> (i64, Option<Order>) {
        if self.select != before.select {
            // What has changed of the reference before is seen by the next step.
            *self = Self { trigger: self.trigger, ..*before };
            return (self.select, None);
        }
        if self.select == SPEED {
            (self.limited, self.barred) = (false, true);
            return (SPEED, Some(Order::Stop { limits: view.largest_limits() }));
        }
        if matches!(code, Code::LIMIT_VIOLATION | Code::REVERSE_FORBIDDEN) {
            self.rest(STOP);
            return (STOP, Some(self.begin_stop(view)));
        }
        (self.input, self.stop) = (before.input, before.stop);
        (self.select, None)
    }

    /// Did this speed reference stay in force since that one?
    pub(crate) fn keeps_speed(&self, before: &Self) -> bool {
        self.select == SPEED && before.select == SPEED
    }

    /// Nothing is in force; gives a step that leaves 34.007 at `written`.
    fn rest(&mut self, written: i64) -> Step {
        (self.select, self.waits, self.barred) = (STOP, false, false);
        Step::idle(written)
    }

    /// Is homing under way because reference 5 is in force?
    pub(crate) fn homes(&self) -> bool {
        self.select == HOME && !self.waits
    }

    /// Does reference 5 wait for the axis to stand?
    pub(crate) fn waits(&self) -> bool {
        self.waits
    }

    /// M14: homing is done, and the axis stands at its end; 34.007 is 0 from now on.
    pub(crate) fn end_homing(&mut self, view: &View<'_>) -> Order {
        self.rest(STOP);
        self.begin_stop(view)
    }

    /// Nothing is in force any more: the axis is locked, or the homing that waited for it to stand is not to be. Gives 34.007
    /// as it is then.
    pub(crate) fn give_up(&mut self) -> i64 {
        self.rest(STOP).select
    }

    /// Every place is `by` more from now on; the target follows by itself.
    pub(crate) fn shift(&mut self, by: Position) {
        self.stop += by;
    }

    /// M09: where the selector does not give the target itself, PIP is what the profile or the gear puts out.
    pub(crate) fn follow_input(&mut self, view: &View<'_>) {
        let circle = Circle::new(view.modulo);
        match self.select {
            CAM | GEAR => self.input = circle.exact(view.target),
            SPEED | HOME => self.input = circle.exact(view.command.position),
            _ if !view.owns => self.input = circle.exact(view.command.position),
            _ => {}
        }
    }

    /// Takes a freeze event of this cycle; gives the way of the master since then, where it counts.
    fn take_event(&self, view: &View<'_>, step: &mut Step) -> Position {
        let freeze = view.wiring.amc.freeze;
        let is_event = |latch: &&Latched| latch.rising && Some(latch.object) == freeze;
        // Of several the first one is the event.
        let first = view.latches.iter().filter(is_event).max_by_key(|latch| latch.age_ns);
        let Some(latch) = first.filter(|_| !view.at_limit) else { return Position::ZERO };
        let action = view.parameters.vocabularies.amc.action_on_event;
        match action {
            CAM_ON_FREEZE if self.select != CAM => {
                step.select = CAM;
                return past(view, latch);
            }
            GEAR_ON_FREEZE if self.select != GEAR => {
                step.select = GEAR;
                return past(view, latch);
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

    /// The order of the reference in force, where it changes anything.
    fn refer(&mut self, view: &View<'_>, before: &Self, past: Position) -> Result<Option<Order>, Problem> {
        let enters = self.select != before.select;
        let changed = enters || self.reference != before.reference;
        if self.select != SPEED || enters {
            self.limited = false;
        }
        let turns = self.select != SPEED || enters || self.speed != before.speed;
        self.barred &= !turns;
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
            SPEED if self.barred => Ok(None),
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

    /// Could its state have come about? One that was read from outside may hold anything.
    pub(crate) fn is_sound(&self) -> bool {
        let kept = (!self.waits || self.select == HOME) && (!self.barred || self.select == SPEED);
        (0..=POSITION_PROFILE).contains(&self.select) && kept && self.input.is_sound() && self.speed.is_finite()
    }
}

/// Where the cam starts (35.001, 35.002).
fn cam_start(view: &View<'_>) -> Option<CamPoint> {
    let p = &view.parameters.vocabularies.amc;
    let point = usize::try_from(p.cam_start_index).unwrap_or(usize::MAX);
    view.wiring.amc.cam.map(|table| CamPoint { table, point, behind: p.cam_start_position })
}

/// The way of the master from the freeze point to this sample (AMC-EVT-05, M11, AMC-EVT-07).
fn past(view: &View<'_>, latch: &Latched) -> Position {
    let way = |master| latch.way_since(master, view.leads.get(master), view.cycle_ns);
    view.wiring.amc.master.map_or(Position::ZERO, way)
}

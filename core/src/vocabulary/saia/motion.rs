//! Starts and stops, and the resulting orders.

use super::execute::MotionEffects;
use super::scale::{HIGHEST, LOWEST};
use super::{Fault, Load, Phase, Register, Saia, Starting};
use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::profile::Limits;
use crate::state::Reference;
use crate::vocabulary::{Order, View};

/// MCW bits 8 to 10: type of stop.
const STOP_BITS: i32 = 0x700;
const STOP_OFF: i32 = 1 << 8;
const STOP_HARD: i32 = 1 << 9;
const STOP_RAMP: i32 = 1 << 10;

impl Saia {
    /// Executes `fstop` (SAIA-FSM-09..13).
    pub(super) fn stop(&mut self, view: &View<'_>, deed: &mut MotionEffects) -> Result<(), Fault> {
        let bits = view.parameters.vocabularies.saia.mcw & STOP_BITS;
        // A motion of another command is stopped, too: a stop must always take effect.
        let moves = self.phase.moves() || (self.phase == Phase::Hold && view.free && !view.rests);
        match bits {
            STOP_OFF => self.turn_off(view, deed),
            STOP_HARD => {
                *deed = MotionEffects {
                    off: deed.off,
                    hold_actual: self.phase != Phase::Off && view.free,
                    ..MotionEffects::default()
                };
                self.end_motion();
                self.stop_latch = true;
            }
            STOP_RAMP => {
                *deed = MotionEffects { off: deed.off, ramp: moves && view.free, ..MotionEffects::default() };
                if moves && view.free {
                    self.phase = Phase::Ramp;
                } else {
                    self.end_motion();
                }
                self.stop_latch = true;
            }
            _ => return Err(Fault::of(Code::SAIA_BAD_STOP_BITS, Register::Mcw, i64::from(bits >> 8))),
        }
        self.starting.waits = false;
        Ok(())
    }

    /// Ends the motion; the controller stays as it is.
    fn end_motion(&mut self) {
        if self.phase.moves() {
            self.phase = Phase::Hold;
            self.profile_done = true;
        }
        self.flags.on_dest = true;
    }

    /// Executes `fsstepf` and `fsstepb`: one count from the destination.
    pub(super) fn single_step(&mut self, view: &View<'_>, by: i64, deed: &mut MotionEffects) -> Result<(), Fault> {
        if self.phase.moves() || (view.on && !view.rests) {
            return Err(Fault::new(Code::SAIA_STEP_IN_MOTION));
        }
        let destination = self.working.destination.saturating_add(by);
        if !(LOWEST..=HIGHEST).contains(&destination) {
            let at = Number::Count(self.working.destination);
            return Err(Fault::new(Code::SAIA_STEP_AT_END).with(at, Number::None));
        }
        self.start(view, Load { destination, ..self.buffer }, Some(false), deed)
    }

    /// Executes `fforw` and `fbackw`: a motion to the end of the range, which only a stop ends.
    pub(super) fn jog(&mut self, view: &View<'_>, destination: i64, deed: &mut MotionEffects) -> Result<(), Fault> {
        self.start(view, Load { destination, ..self.buffer }, Some(true), deed)
    }

    /// Activates `load` and starts, or changes the present motion. `jogs` marks the position moves that do not change
    /// the buffered mode (A23) and need no load after a stop.
    pub(super) fn start(
        &mut self,
        view: &View<'_>,
        load: Load,
        jogs: Option<bool>,
        deed: &mut MotionEffects,
    ) -> Result<(), Fault> {
        if self.stop_latch && jogs.is_none() {
            // A18: without effect, and no error.
            self.flags.on_dest = true;
            return Ok(());
        }
        if self.acceleration_pending && self.phase.moves() {
            return Err(Fault::new(Code::SAIA_ACCELERATION_PENDING));
        }
        if view.in_error {
            return Err(Fault::new(Code::IN_ERROR));
        }
        if !view.contact.is_none() {
            return Err(Fault::new(view.contact));
        }
        let acceleration = self.acceleration_of(&load);
        self.check_rates(view, &Load { acceleration, ..load })?;
        let by_velocity = load.by_velocity && jogs.is_none();
        if !by_velocity && jogs != Some(true) {
            self.check_target(view, load.destination)?;
        }
        self.buffer = load;
        self.working = Load { by_velocity, acceleration, ..load };
        self.jogs = jogs == Some(true);
        self.phase = if by_velocity { Phase::Velocity } else { Phase::Position };
        (self.stop_latch, self.acceleration_pending, self.profile_done) = (false, false, false);
        (self.started, self.flags.on_dest) = (true, false);
        self.starting.waits = true;
        *deed = MotionEffects { start: true, ramp: false, ..*deed };
        Ok(())
    }

    /// Returns the acceleration of a start. The default acceleration is limited to the velocity (SAIA-EXT-03), and a
    /// present motion keeps its acceleration (SAIA-PRF-03).
    fn acceleration_of(&self, load: &Load) -> i64 {
        match self.working.acceleration {
            _ if !load.usual => load.acceleration,
            present if self.phase.moves() && present > 0 => present,
            _ => load.acceleration.min(load.velocity),
        }
    }

    /// Checks the software limits as for any goal, even if the drive has to switch on first.
    fn check_target(&self, view: &View<'_>, destination: i64) -> Result<(), Fault> {
        let (p, end) = (view.parameters, self.place(destination));
        let beyond = |code, limit| {
            let numbers = (Number::Position(end), Number::Position(limit));
            Err(Fault::new(code).with(numbers.0, numbers.1))
        };
        match (p.min_position, p.max_position) {
            (_, Some(high)) if end > high => beyond(Code::ABOVE_MAX_POSITION, high),
            (Some(low), _) if end < low => beyond(Code::BELOW_MIN_POSITION, low),
            _ => Ok(()),
        }
    }

    /// Returns the order of a waiting start if the drive is on, otherwise the order to switch it on. A drive that was
    /// just switched off stays off for one cycle, and until its brake is closed.
    pub(super) fn waiting_order(&mut self, view: &View<'_>) -> Option<Order> {
        if !self.starting.waits {
            return None;
        }
        if view.on {
            self.starting = Starting::default();
            return Some(self.motion_order(view));
        }
        if self.starting.switched || self.off_at == Some(view.cycle) || view.closing {
            return None;
        }
        self.starting.switched = true;
        Some(Order::SwitchOn)
    }

    /// Returns the motion of the working registers.
    pub(super) fn motion_order(&self, view: &View<'_>) -> Order {
        let limits = self.limits(view);
        let end = self.place(self.working.destination);
        let up = self.working.destination > 0;
        let (low, high) = (view.parameters.min_position, view.parameters.max_position);
        let limited = high.is_some_and(|high| up && end > high) || low.is_some_and(|low| !up && end < low);
        if self.working.by_velocity || (self.jogs && limited) {
            // A jog that would reach a software limit before the end of the range is a motion without end, which the
            // limit stops.
            let forward = if self.working.by_velocity { self.working.forward } else { up };
            let velocity = if forward { limits.velocity } else { -limits.velocity };
            return Order::Velocity { velocity, limits };
        }
        Order::Position { target: Position::whole(end), limits, reference: Reference::PositionAbsolute }
    }

    /// Returns the limits of a stop ramp; those of the axis if nothing was started yet.
    pub(super) fn stop_limits(&self, view: &View<'_>) -> Limits {
        if self.working.acceleration > 0 && self.working.velocity > 0 {
            self.limits(view)
        } else {
            view.largest_limits()
        }
    }

    /// Returns the order to switch off. A virtual axis cannot coast: it stops with its maximum deceleration.
    pub(super) fn off_order(view: &View<'_>) -> Order {
        match view.interface {
            None => Order::Stop { limits: view.largest_limits() },
            Some(_) => Order::SwitchOff,
        }
    }
}

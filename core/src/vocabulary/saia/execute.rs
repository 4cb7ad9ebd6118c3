//! Execution of requests: the order of their commands, three tries, and the resulting order to the axis.

use super::{Command, Errors, Fault, Phase, Request, Saia};
use crate::code::Code;
use crate::event::Refusal;
use crate::parameter::saia::{MOTOR_OFF, REFUSE};
use crate::vocabulary::{Order, Outcome, View};

/// Number of tries of a command (SAIA-ERR-03).
const TRIES: u32 = 3;

/// Effects of the commands of a request on the motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MotionEffects {
    /// The controller was switched off.
    pub off: bool,
    /// The actual position became the setpoint.
    pub hold_actual: bool,
    /// A stop ramp began.
    pub ramp: bool,
    /// A motion was started.
    pub start: bool,
}

impl Saia {
    /// Executes a request whose registers are in the parameters of the view. If the request or its order is refused,
    /// the caller keeps the previous state. If only commands are to fail, the caller calls it again with `barred`, the
    /// reason why the axis cannot start.
    ///
    /// # Errors
    /// The first command error, if the parameter says that it refuses the request.
    pub(crate) fn run(
        &mut self,
        request: &Request,
        view: &View<'_>,
        barred: Option<Refusal>,
    ) -> Result<Outcome, Refusal> {
        if self.phase == Phase::Power && view.on && request.commands.wakes() {
            self.initialise_enabled_axis(view);
        }
        self.wrap(view);
        let policy = view.parameters.vocabularies.saia.command_error;
        let mut outcome = Outcome::of(None);
        let mut places = outcome.errors.iter_mut();
        let (mut deed, mut first) = (MotionEffects::default(), None);
        for command in request.commands.iter() {
            match self.attempt(command, view, barred, &mut deed) {
                Ok(()) => {}
                Err(refusal) if policy == REFUSE => return Err(refusal),
                Err(refusal) => {
                    first = first.or(Some(refusal));
                    if let Some(place) = places.next() {
                        *place = Some(refusal);
                    }
                }
            }
        }
        outcome.order = match first {
            Some(refusal) if policy == MOTOR_OFF => {
                self.turn_off(view, &mut deed);
                Some(Order::FailOff { refusal })
            }
            _ => self.order(view, deed),
        };
        outcome.coming = (deed.start && self.starting.waits).then(|| self.motion_order(view));
        Ok(outcome)
    }

    /// Tries a command up to three times; a command that cannot succeed fails in each of them.
    fn attempt(
        &mut self,
        command: Command,
        view: &View<'_>,
        barred: Option<Refusal>,
        deed: &mut MotionEffects,
    ) -> Result<(), Refusal> {
        let mut failure = None;
        for _ in 0..TRIES {
            let result = match barred.filter(|_| command.starts()) {
                Some(refusal) => Err(refusal),
                None => self.execute(command, view, deed).map_err(|fault| fault.refusal(view)),
            };
            match result {
                Ok(()) => return Ok(()),
                Err(refusal) => {
                    self.errors.tries = self.errors.tries.saturating_add(1);
                    failure = Some(refusal);
                }
            }
        }
        failure.map_or(Ok(()), |refusal| {
            self.note_error(refusal.code);
            Err(refusal)
        })
    }

    pub(super) fn note_error(&mut self, code: Code) {
        self.errors = Errors { code: code.0, count: self.errors.count.saturating_add(1), ..self.errors };
    }

    /// Executes one command; an error changes nothing.
    fn execute(&mut self, command: Command, view: &View<'_>, deed: &mut MotionEffects) -> Result<(), Fault> {
        if self.phase == Phase::Power && command != Command::Initialise {
            return Err(Fault::new(Code::SAIA_NOT_INITIALISED));
        }
        let p = &view.parameters.vocabularies.saia;
        match command {
            Command::Initialise => self.initialise(view, deed),
            Command::SelectMode => {
                self.select_mode(p);
                Ok(())
            }
            Command::SetPositionError => self.set_position_error(p),
            Command::LoadDestination => self.load_destination(p, false),
            Command::LoadDestinationRelative => self.load_destination(p, true),
            Command::LoadVelocity => self.load_velocity(p, false),
            Command::LoadVelocityRelative => self.load_velocity(p, true),
            Command::LoadAcceleration => self.load_acceleration(view, false, deed),
            Command::LoadAccelerationRelative => self.load_acceleration(view, true, deed),
            Command::LoadRegulator => self.load_regulator(p),
            Command::UpdateRegulator => {
                self.gains = self.loaded_gains;
                Ok(())
            }
            Command::SetIndex => {
                self.armed = Some(view.cycle);
                Ok(())
            }
            Command::SetZero => {
                self.zero = self.place(self.position(view));
                self.shares_zero = false;
                self.handle_position_jump();
                Ok(())
            }
            Command::LoadBreak => self.load_break(view, false),
            Command::LoadBreakRelative => self.load_break(view, true),
            Command::ResetFlags => {
                self.reset_flags(p);
                Ok(())
            }
            Command::MotorOff => {
                self.turn_off(view, deed);
                Ok(())
            }
            Command::Stop => self.stop(view, deed),
            Command::Start => self.start(view, self.buffer, None, deed),
            Command::StepForward => self.single_step(view, 1, deed),
            Command::StepBackward => self.single_step(view, -1, deed),
            Command::Forward => self.jog(view, super::HIGHEST, deed),
            Command::Backward => self.jog(view, super::LOWEST, deed),
            Command::ReadSignals => {
                self.outputs.signals = self.signal_register();
                Ok(())
            }
            Command::ReadActualPosition
            | Command::ReadSetPosition
            | Command::ReadActualVelocity
            | Command::ReadSetVelocity
            | Command::ReadIntegral
            | Command::ReadIndex => self.read(command, view),
        }
    }

    /// Returns the order that results from all commands; a start that is not possible yet waits for the step.
    fn order(&mut self, view: &View<'_>, deed: MotionEffects) -> Option<Order> {
        if deed.off {
            return Some(Self::off_order(view));
        }
        if deed.hold_actual {
            return Some(Order::HoldActualPosition);
        }
        if deed.start {
            return self.waiting_order(view);
        }
        deed.ramp.then(|| Order::Stop { limits: self.stop_limits(view) })
    }
}

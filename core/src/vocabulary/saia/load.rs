//! Commands that load buffers and limits: they cause no motion.

use super::execute::MotionEffects;
use super::pid::{Gains, Pid};
use super::scale::{self, HIGHEST, LOWEST, Scaling};
use super::{Break, Fault, Flags, Load, Parameters, Phase, Register, Saia};
use crate::code::Code;
use crate::event::Number;
use crate::vocabulary::View;

/// MCW: velocity control.
const BY_VELOCITY: i32 = 1 << 11;
/// MCW: forward.
const FORWARD: i32 = 1 << 12;
/// Low byte of MCW: a position error only sets its flag.
const FLAG_ONLY: i32 = 0x1B;
/// Low byte of MCW: a position error also switches the controller off (A16).
const FLAG_AND_OFF: i32 = 0x1A;
/// Maximum position error of the register (counts).
const LARGEST_ERROR: i64 = 32_767;
/// First bit of StaFRR: the order is that of the signal register (A26).
const FIRST_FLAG: u32 = 2;

/// Returns the value of a register, or an error outside the range of its commands.
fn checked(register: Register, value: i32) -> Result<i32, Fault> {
    let (low, high) = register.permitted().unwrap_or((i64::MIN, i64::MAX));
    if (low..=high).contains(&value.into()) {
        return Ok(value);
    }
    Err(Fault::of(Code::SAIA_REGISTER_OUT_OF_RANGE, register, value.into()))
}

fn within(code: Code, register: Register, value: i64, low: i64) -> Result<i64, Fault> {
    if (low..=HIGHEST).contains(&value) { Ok(value) } else { Err(Fault::of(code, register, value)) }
}

/// Returns an error for a negative value, even if it is rounded to 0.
fn not_below_0(code: Code, register: Register, exact: f64) -> Result<(), Fault> {
    let fault = Fault { register: Some(register), ..Fault::new(code) };
    if (-0.5..0.0).contains(&exact) { Err(fault.with(Number::Real(exact), Number::None)) } else { Ok(()) }
}

fn position(register: Register, counts: i64) -> Result<i64, Fault> {
    within(Code::SAIA_POSITION_OUT_OF_RANGE, register, counts, LOWEST)
}

impl Saia {
    /// AxInit: executes all of its steps, or none.
    pub(super) fn initialise(&mut self, view: &View<'_>, deed: &mut MotionEffects) -> Result<(), Fault> {
        let p = &view.parameters.vocabularies.saia;
        let mut fresh = Self {
            phase: Phase::Off,
            zero: super::actual(view).0.floor(),
            pwm: p.imode == 5,
            outputs: self.outputs,
            errors: self.errors,
            ..Self::default()
        };
        fresh.select_mode(p);
        fresh.set_position_error(p)?;
        fresh.load_regulator(p)?;
        fresh.gains = fresh.loaded_gains;
        fresh.load_velocity(p, false)?;
        // Last, because only this step changes `deed`, and only on success.
        fresh.load_acceleration(view, false, deed)?;
        fresh.keep_controller_of(self, view);
        *self = fresh;
        Ok(())
    }

    /// Initialises the module like `axinit` in the start-up of a program, for an axis that another command has switched
    /// on: it stays on, and the zero is that of the axis. A register that `axinit` would reject keeps the value after a
    /// reset.
    pub(super) fn initialise_enabled_axis(&mut self, view: &View<'_>) {
        let p = &view.parameters.vocabularies.saia;
        let position = super::actual(view).0.floor();
        let shares_zero = (LOWEST..=HIGHEST).contains(&position);
        let mut fresh = Self {
            phase: Phase::Hold,
            zero: if shares_zero { 0 } else { position },
            shares_zero,
            pwm: p.imode == 5,
            error_limit: LARGEST_ERROR,
            acceleration_pending: true,
            outputs: self.outputs,
            errors: self.errors,
            ..Self::default()
        };
        fresh.flags.on_dest = true;
        fresh.select_mode(p);
        // A failed step changes nothing; the command that loads the register again reports the reason.
        let _ = fresh.set_position_error(p);
        if fresh.load_regulator(p).is_ok() {
            fresh.gains = fresh.loaded_gains;
        }
        let _ = fresh.load_velocity(p, false);
        if let Ok((acceleration, usual)) = fresh.acceleration(view, false) {
            (fresh.buffer.acceleration, fresh.buffer.usual) = (acceleration, usual);
        }
        fresh.keep_controller_of(self, view);
        *self = fresh;
    }

    /// Keeps the state of a controller that closes the loop of the axis, until the axis is off.
    fn keep_controller_of(&mut self, before: &Self, view: &View<'_>) {
        if view.closes_loop {
            (self.pid, self.sample_rest) = (before.pid, before.sample_rest);
        }
    }

    pub(super) fn select_mode(&mut self, p: &Parameters) {
        self.buffer.by_velocity = p.mcw & BY_VELOCITY != 0;
        self.buffer.forward = p.mcw & FORWARD != 0;
        self.stop_latch = false;
    }

    pub(super) fn set_position_error(&mut self, p: &Parameters) -> Result<(), Fault> {
        let limit = checked(Register::PosEr, p.poser)?;
        let stops = match p.mcw & 0xFF {
            FLAG_ONLY => false,
            FLAG_AND_OFF => true,
            other => return Err(Fault::of(Code::SAIA_BAD_REACTION, Register::Mcw, other.into())),
        };
        (self.error_limit, self.error_stops) = (limit.into(), stops);
        Ok(())
    }

    /// Returns an error for a relative load before the first start (SAIA-DET-03).
    fn check_relative(&self, register: Register) -> Result<(), Fault> {
        let fault = Fault { register: Some(register), ..Fault::new(Code::SAIA_RELATIVE_TOO_EARLY) };
        if self.started { Ok(()) } else { Err(fault) }
    }

    /// Returns the base of a value: the present (working) one (A19), or 0.
    fn base(&self, register: Register, relative: bool, working: i64) -> Result<i64, Fault> {
        if relative { self.check_relative(register).map(|()| working) } else { Ok(0) }
    }

    pub(super) fn load_destination(&mut self, p: &Parameters, relative: bool) -> Result<(), Fault> {
        let base = self.base(Register::DestP, relative, self.working.destination)?;
        let change = position(Register::DestP, Scaling::of(p).counts(p.destp))?;
        self.buffer.destination = position(Register::DestP, base.saturating_add(change))?;
        self.stop_latch = false;
        Ok(())
    }

    pub(super) fn load_velocity(&mut self, p: &Parameters, relative: bool) -> Result<(), Fault> {
        let base = self.base(Register::Veloc, relative, self.working.velocity)?;
        let change = Scaling::of(p).velocity(p.veloc);
        if relative {
            within(Code::SAIA_VELOCITY_OUT_OF_RANGE, Register::Veloc, change, LOWEST)?;
        } else {
            not_below_0(Code::SAIA_VELOCITY_OUT_OF_RANGE, Register::Veloc, Scaling::of(p).exact_velocity(p.veloc))?;
        }
        let velocity = base.saturating_add(change);
        self.buffer.velocity = within(Code::SAIA_VELOCITY_OUT_OF_RANGE, Register::Veloc, velocity, 0)?;
        self.stop_latch = false;
        Ok(())
    }

    /// Loads an acceleration, which switches the motor off and waits for a start at rest (SAIA-DET-04).
    pub(super) fn load_acceleration(
        &mut self,
        view: &View<'_>,
        relative: bool,
        deed: &mut MotionEffects,
    ) -> Result<(), Fault> {
        let (acceleration, usual) = self.acceleration(view, relative)?;
        self.turn_off(view, deed);
        (self.buffer.acceleration, self.buffer.usual) = (acceleration, usual);
        (self.stop_latch, self.acceleration_pending) = (false, true);
        Ok(())
    }

    /// Returns the acceleration of the register, and whether it is the default acceleration of the axis.
    fn acceleration(&self, view: &View<'_>, relative: bool) -> Result<(i64, bool), Fault> {
        let p = &view.parameters.vocabularies.saia;
        let base = self.base(Register::Accel, relative, self.working.acceleration)?;
        let Some(accel) = p.accel else {
            let usual = view.parameters.default_goal_acceleration().min(view.parameters.default_goal_deceleration());
            return Ok(if relative { (base, self.working.usual) } else { (scale::register_of_rate(usual), true) });
        };
        let change = Scaling::of(p).acceleration(accel);
        if relative {
            within(Code::SAIA_ACCELERATION_OUT_OF_RANGE, Register::Accel, change, LOWEST)?;
        } else {
            let exact = Scaling::of(p).exact_acceleration(accel);
            not_below_0(Code::SAIA_ACCELERATION_OUT_OF_RANGE, Register::Accel, exact)?;
        }
        let acceleration = base.saturating_add(change);
        Ok((within(Code::SAIA_ACCELERATION_OUT_OF_RANGE, Register::Accel, acceleration, 0)?, false))
    }

    pub(super) fn load_regulator(&mut self, p: &Parameters) -> Result<(), Fault> {
        self.loaded_gains = Gains {
            proportional: checked(Register::KProp, p.kprop)?,
            integral: checked(Register::KInt, p.kint)?,
            derivative: checked(Register::KDer, p.kder)?,
            limit: checked(Register::IntL, p.intl)?,
            interval: checked(Register::SampI, p.sampi)?,
        };
        Ok(())
    }

    pub(super) fn load_break(&mut self, view: &View<'_>, relative: bool) -> Result<(), Fault> {
        let p = &view.parameters.vocabularies.saia;
        let base = self.base(Register::BrkP, relative, self.working.destination)?;
        let change = position(Register::BrkP, Scaling::of(p).counts(p.brkp))?;
        let position = position(Register::BrkP, base.saturating_add(change))?;
        let side = self.position(view).saturating_sub(position).signum();
        self.breaks = Some(Break { position, side: Some(side) });
        Ok(())
    }

    pub(super) fn reset_flags(&mut self, p: &Parameters) {
        let keeps = |place: u32| p.stafrr >> (FIRST_FLAG + place) & 1 == 1;
        let Flags { on_dest, index, wrapped, error, passed } = self.flags;
        self.flags = Flags {
            on_dest: on_dest && keeps(0),
            index: index && keeps(1),
            wrapped: wrapped && keeps(2),
            error: error && keeps(3),
            passed: passed && keeps(4),
        };
    }

    /// Checks that registers of that size can be started (SAIA-EXT-03), and that the axis allows them.
    pub(super) fn check_rates(&self, view: &View<'_>, load: &Load) -> Result<(), Fault> {
        if !load.is_startable() {
            let numbers = (Number::Count(load.acceleration), Number::Count(load.velocity));
            return Err(Fault::new(Code::SAIA_ACCELERATION_ABOVE_VELOCITY).with(numbers.0, numbers.1));
        }
        // Half a step of the register is rounding.
        let p = view.parameters;
        let register = load.velocity as f64;
        if scale::velocity_of(register - 0.5) > p.max_velocity {
            let numbers = (Number::Velocity(scale::velocity_of(register)), Number::Velocity(p.max_velocity));
            return Err(Fault::new(Code::VELOCITY_TOO_HIGH).with(numbers.0, numbers.1));
        }
        let register = load.acceleration as f64;
        for (most, code) in
            [(p.max_acceleration, Code::ACCELERATION_TOO_HIGH), (p.deceleration_limit(), Code::DECELERATION_TOO_HIGH)]
        {
            if scale::acceleration_of(register - 0.5) > most {
                let numbers = (Number::Acceleration(scale::acceleration_of(register)), Number::Acceleration(most));
                return Err(Fault::new(code).with(numbers.0, numbers.1));
            }
        }
        Ok(())
    }

    /// Switches the controller off: no output, no history, no waiting start.
    pub(super) fn turn_off(&mut self, view: &View<'_>, deed: &mut MotionEffects) {
        self.phase = Phase::Off;
        self.flags.on_dest = true;
        self.stop_latch = true;
        self.starting = Default::default();
        self.off_at = Some(view.cycle);
        if !view.closes_loop {
            self.pid = Pid::default();
        }
        *deed = MotionEffects { off: true, ..MotionEffects::default() };
    }
}

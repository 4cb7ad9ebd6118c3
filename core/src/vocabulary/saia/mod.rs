//! Command set of the SAIA PCD4.H3 servo module.
//!
//! Law      registers are set, then the command flags of the verb run in a fixed order, then one step. Loads fill buffers;
//!          a start takes them over. Values are quantized to the module's registers here; the generator is the axis' own,
//!          one count is one increment
//! Reads    the registers, which are parameters of the axis; the axis by its [`View`]
//! Writes   status flags, output registers, orders: position, velocity, stop, drive on and off
//! Refuses  what the module answers with a command error, and what the axis does not allow; see
//!          [`Parameters::command_error`]
//! Source   spec/saia-h3.md

mod command;
mod execute;
mod load;
mod motion;
mod pid;
mod read;
mod register;
mod request;
mod scale;
mod signals;
mod watch;

pub use command::{Command, Commands};
pub use register::Register;
pub use request::Request;
pub use signals::{STATES, SaiaSignal};

use super::View;
use crate::code::Code;
use crate::event::{Number, Refusal};
use crate::parameter::saia::Parameters;
use crate::position::Position;
use crate::profile::Motion;
use pid::{Gains, Pid};

/// Does its regulator damp?
///
/// # Errors
/// The key that does not.
pub(super) fn check_damping(p: &Parameters) -> Result<(), (&'static str, Code)> {
    if p.kder == 0 { Err(("saia.kder", Code::NO_DAMPING)) } else { Ok(()) }
}

/// Can its regulator close the loop of an axis with the registers as they stand?
///
/// # Errors
/// The key of the first that cannot be.
pub(super) fn check_loop(p: &Parameters) -> Result<(), (&'static str, Code)> {
    Gains::of(p).problem().map_or(Ok(()), |key| Err((key, Code::GAIN_RANGE)))
}
use scale::{HIGHEST, LOWEST};
use serde::{Deserialize, Serialize};

/// States of section 12.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// PWR: `axinit` has not run.
    #[default]
    Power,
    /// OFF: regulator off.
    Off,
    /// HOLD: regulator on, profile done.
    Hold,
    /// POS: position profile.
    Position,
    /// VEL: velocity profile.
    Velocity,
    /// RAMP: stop ramp.
    Ramp,
}

impl Phase {
    fn moves(self) -> bool {
        matches!(self, Self::Position | Self::Velocity | Self::Ramp)
    }
}

/// What a start takes over, from the buffers to the working registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Load {
    /// From the vocabulary's zero (counts).
    destination: i64,
    /// (2^-16 counts per sample)
    velocity: i64,
    /// (2^-16 counts per sample^2)
    acceleration: i64,
    /// The acceleration is the usual one of the axis, which no register has given: a start takes no more of it than it may.
    usual: bool,
    /// Velocity control.
    by_velocity: bool,
    /// Its direction.
    forward: bool,
}

impl Load {
    fn is_sound(&self) -> bool {
        let registers = 0..=HIGHEST;
        (LOWEST..=HIGHEST).contains(&self.destination)
            && registers.contains(&self.velocity)
            && registers.contains(&self.acceleration)
    }

    /// Can registers of that size be started (SAIA-EXT-03)?
    fn is_startable(&self) -> bool {
        (1..=self.velocity).contains(&self.acceleration)
    }
}

/// A break position that waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Break {
    /// From the vocabulary's zero (counts).
    position: i64,
    /// Sign of actual minus break position when it was loaded; none where the actual position has jumped since.
    side: Option<i64>,
}

/// The five status flags, latched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Flags {
    on_dest: bool,
    index: bool,
    wrapped: bool,
    error: bool,
    passed: bool,
}

/// Output registers, as their read commands left them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Outputs {
    actual_position: i32,
    set_position: i32,
    actual_velocity: i32,
    set_velocity: i32,
    index_position: i32,
    integral: i32,
    signals: u32,
}

/// Command errors so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Errors {
    /// Of the last one.
    code: u32,
    /// How often a command failed in all its tries.
    count: u64,
    /// Failed tries.
    tries: u64,
}

/// A start that waits for the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Starting {
    waits: bool,
    /// The drive was asked to switch on.
    switched: bool,
}

/// What the vocabulary remembers of its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saia {
    phase: Phase,
    /// Its zero in the coordinate of the axis (inc).
    zero: i64,
    /// Which is that of the axis itself, wherever it goes: nothing has given it one of its own.
    shares_zero: bool,
    buffer: Load,
    working: Load,
    /// The working destination is the end of the range, to be reached by no one: `fforw`, `fbackw`.
    jogs: bool,
    stop_latch: bool,
    acceleration_pending: bool,
    /// A start has been since `axinit`: relative loads are allowed.
    started: bool,
    profile_done: bool,
    pwm: bool,
    flags: Flags,
    breaks: Option<Break>,
    /// Waits for an index, since that cycle.
    armed: Option<u64>,
    /// From the vocabulary's zero of its time (counts).
    index: i64,
    /// Largest position error (counts).
    error_limit: i64,
    /// What it does: true switches the regulator off.
    error_stops: bool,
    loaded_gains: Gains,
    gains: Gains,
    pid: Pid,
    /// What is left of a chip sample (ns / 3).
    sample_rest: u64,
    starting: Starting,
    /// Cycle in which the drive was switched off last.
    off_at: Option<u64>,
    outputs: Outputs,
    errors: Errors,
}

/// Most commands of a verb.
pub(super) const MOST: usize = Command::ALL.len();

/// Why a command is not done.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fault {
    code: Code,
    register: Option<Register>,
    asked: Number,
    limit: Number,
}

impl Fault {
    fn new(code: Code) -> Self {
        Self { code, register: None, asked: Number::None, limit: Number::None }
    }

    fn of(code: Code, register: Register, asked: i64) -> Self {
        Self { register: Some(register), ..Self::new(code).with(Number::Count(asked), Number::None) }
    }

    fn with(self, asked: Number, limit: Number) -> Self {
        Self { asked, limit, ..self }
    }

    fn refusal(self, view: &View<'_>) -> Refusal {
        let parameter = self.register.map(Register::place);
        Refusal { parameter, ..Refusal::new(self.code, view.object).with(self.asked, self.limit) }
    }
}

/// The actual motion; a virtual axis is where it is asked to be.
fn actual(view: &View<'_>) -> (Position, f64) {
    match view.interface {
        None => (view.command.position, view.command.velocity),
        Some(_) => (view.actual.position, view.actual.velocity),
    }
}

impl Saia {
    /// Actual position from its zero (counts).
    fn position(&self, view: &View<'_>) -> i64 {
        actual(view).0.floor().saturating_sub(self.zero)
    }

    /// A count of the vocabulary in the coordinate of the axis.
    fn place(&self, count: i64) -> i64 {
        self.zero.saturating_add(count)
    }

    /// Limits of the working registers, as far as the axis has them: what quantizing adds does not count.
    fn limits(&self, view: &View<'_>) -> crate::profile::Limits {
        let p = view.parameters;
        let acceleration = scale::acceleration_of(self.working.acceleration as f64);
        crate::profile::Limits {
            velocity: scale::velocity_of(self.working.velocity as f64).min(p.max_velocity),
            acceleration: acceleration.min(p.max_acceleration),
            deceleration: acceleration.min(p.deceleration_limit()),
            shape: crate::profile::Shape::Trapezoid,
        }
    }

    /// The signal register (SAIA-SIG-00..10).
    fn signal_register(&self) -> u32 {
        let bits = [
            self.armed.is_some(),
            false,
            self.flags.on_dest,
            self.flags.index,
            self.flags.wrapped,
            self.flags.error,
            self.flags.passed,
            self.is_off(),
            self.pwm || self.phase == Phase::Power,
            self.error_stops,
            self.profile_done,
            self.working.by_velocity,
            self.working.forward,
            false,
            self.acceleration_pending,
        ];
        bits.iter().enumerate().map(|(place, bit)| u32::from(*bit) << place).sum()
    }

    fn is_off(&self) -> bool {
        matches!(self.phase, Phase::Power | Phase::Off)
    }

    /// Writes its signals: one word for each of [`SaiaSignal`].
    pub(crate) fn publish(&self, view: &View<'_>, words: &mut [u64]) {
        use SaiaSignal::*;
        let mut set = |signal: SaiaSignal, word: u64| {
            if let Some(place) = words.get_mut(signal as usize) {
                *place = word;
            }
        };
        let int = i64::cast_unsigned;
        let register = |value: i32| i64::from(value).cast_unsigned();
        let bit = u64::from;
        set(Active, bit(view.owns));
        set(State, self.phase as u64);
        set(OnDest, bit(self.flags.on_dest));
        set(IPuls, bit(self.flags.index));
        set(WrapOc, bit(self.flags.wrapped));
        set(ExcPEr, bit(self.flags.error));
        set(BrkPos, bit(self.flags.passed));
        set(RActP, register(self.outputs.actual_position));
        set(RSetP, register(self.outputs.set_position));
        set(RActV, register(self.outputs.actual_velocity));
        set(RSetV, register(self.outputs.set_velocity));
        set(RIndP, register(self.outputs.index_position));
        set(RIntTs, register(self.outputs.integral));
        set(RSigB, self.outputs.signals.into());
        set(RegulatorOff, bit(self.is_off()));
        set(ProfileDone, bit(self.profile_done));
        set(VelocityMode, bit(self.working.by_velocity));
        set(Forward, bit(self.working.forward));
        set(AccelerationPending, bit(self.acceleration_pending));
        set(IndexArmed, bit(self.armed.is_some()));
        set(StopLatch, bit(self.stop_latch));
        let position = if self.phase == Phase::Power { 0 } else { self.position(view) };
        set(SaiaSignal::Position, int(position));
        set(Destination, int(self.working.destination));
        set(VelocityRegister, int(self.working.velocity));
        set(AccelerationRegister, int(self.working.acceleration));
        set(Output, register(self.pid.code(view.parameters.vocabularies.saia.output_gain, self.pwm)));
        set(Integral, register(self.pid.integral()));
        set(SaiaSignal::Error, self.errors.code.into());
        set(CommandErrors, self.errors.count);
        set(Tries, self.errors.tries);
    }

    /// Could its state have come about? One that was read from outside may hold anything.
    pub(crate) fn is_sound(&self) -> bool {
        let breaks = self.breaks.is_none_or(|breaks| {
            (LOWEST..=HIGHEST).contains(&breaks.position) && breaks.side.is_none_or(|side| (-1..=1).contains(&side))
        });
        breaks
            && self.buffer.is_sound()
            && self.working.is_sound()
            && self.gains.is_sound()
            && self.loaded_gains.is_sound()
            && self.pid.is_sound()
            && (LOWEST..=HIGHEST).contains(&self.index)
            && (0..=32_767).contains(&self.error_limit)
            && self.sample_rest < scale::SAMPLE
            // An axis that has been started holds registers that move it.
            && (!matches!(self.phase, Phase::Position | Phase::Velocity) || self.working.is_startable())
    }

    /// Motion of the profile; with the regulator off it is where the axis is (A09).
    fn profile(&self, view: &View<'_>) -> Motion {
        if self.is_off() { Motion::at_rest(actual(view).0) } else { view.command }
    }
}

#[cfg(test)]
mod tests;

//! Command set of the SAIA PCD4.H3 servo module.
//!
//! Law      registers are set, then the command flags of the request run in a fixed order, then one step. Loads fill
//!          buffers; a start activates them. Values are quantized to the registers of the module here; the profile
//!          generator is that of the axis, and one count is one increment
//! Reads    the registers, which are parameters of the axis; the axis through its [`View`]
//! Writes   status flags, output registers, orders: position, velocity, stop, drive on and off
//! Refuses  command errors of the module, and motion that the axis does not allow; see [`Parameters::command_error`]
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

/// Checks that the controller has damping.
///
/// # Errors
/// The key of the missing gain.
pub(super) fn check_damping(p: &Parameters) -> Result<(), (&'static str, Code)> {
    if p.kder == 0 { Err(("saia.kder", Code::NO_DAMPING)) } else { Ok(()) }
}

/// Checks that the controller can close the loop of an axis with the present registers.
///
/// # Errors
/// The key of the first invalid register.
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
    /// OFF: controller off.
    Off,
    /// HOLD: controller on, profile done.
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

/// Values that a start copies from the buffers to the working registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Load {
    /// Destination from the zero of the vocabulary (counts).
    destination: i64,
    /// Velocity (2^-16 counts per sample).
    velocity: i64,
    /// Acceleration (2^-16 counts per sample^2).
    acceleration: i64,
    /// Whether the acceleration is the default of the axis instead of a register: a start limits it to the allowed
    /// value.
    usual: bool,
    /// Whether the mode is velocity control.
    by_velocity: bool,
    /// Whether velocity control moves in positive direction.
    forward: bool,
}

impl Load {
    fn is_sound(&self) -> bool {
        let registers = 0..=HIGHEST;
        (LOWEST..=HIGHEST).contains(&self.destination)
            && registers.contains(&self.velocity)
            && registers.contains(&self.acceleration)
    }

    /// Returns true if registers of that size can be started (SAIA-EXT-03).
    fn is_startable(&self) -> bool {
        (1..=self.velocity).contains(&self.acceleration)
    }
}

/// A loaded break position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Break {
    /// Position from the zero of the vocabulary (counts).
    position: i64,
    /// Sign of actual minus break position at the load; `None` if the actual position has jumped since then.
    side: Option<i64>,
}

/// The five latched status flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Flags {
    on_dest: bool,
    index: bool,
    wrapped: bool,
    error: bool,
    passed: bool,
}

/// Output registers, as set by their read commands.
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

/// Command errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Errors {
    /// Code of the last one.
    code: u32,
    /// Number of commands that failed in all tries.
    count: u64,
    /// Failed tries.
    tries: u64,
}

/// A start that waits for the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Starting {
    waits: bool,
    /// Whether the drive was ordered to switch on.
    switched: bool,
}

/// State of the vocabulary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saia {
    phase: Phase,
    /// Zero of the vocabulary in the coordinate of the axis (inc).
    zero: i64,
    /// Whether that is the zero of the axis itself, and follows it: no command has set another zero.
    shares_zero: bool,
    buffer: Load,
    working: Load,
    /// Whether the destination is the end of the range, which is not meant to be reached: `fforw`, `fbackw`.
    jogs: bool,
    stop_latch: bool,
    acceleration_pending: bool,
    /// Whether a start has been executed since `axinit`: relative loads are allowed.
    started: bool,
    profile_done: bool,
    pwm: bool,
    flags: Flags,
    breaks: Option<Break>,
    /// Cycle since which it waits for an index.
    armed: Option<u64>,
    /// Index position, from the zero of the vocabulary at that time (counts).
    index: i64,
    /// Maximum position error (counts).
    error_limit: i64,
    /// Whether a position error switches the controller off.
    error_stops: bool,
    loaded_gains: Gains,
    gains: Gains,
    pid: Pid,
    /// Remainder of a chip sample (ns / 3).
    sample_rest: u64,
    starting: Starting,
    /// Cycle in which the drive was last switched off.
    off_at: Option<u64>,
    outputs: Outputs,
    errors: Errors,
}

/// Maximum commands per request.
pub(super) const MOST: usize = Command::ALL.len();

/// Error of a command.
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

/// Returns the actual motion; a virtual axis is at its command.
fn actual(view: &View<'_>) -> (Position, f64) {
    match view.interface {
        None => (view.command.position, view.command.velocity),
        Some(_) => (view.actual.position, view.actual.velocity),
    }
}

impl Saia {
    /// Returns the actual position from the zero of the vocabulary (counts).
    fn position(&self, view: &View<'_>) -> i64 {
        actual(view).0.floor().saturating_sub(self.zero)
    }

    /// Converts a count of the vocabulary to the coordinate of the axis.
    fn place(&self, count: i64) -> i64 {
        self.zero.saturating_add(count)
    }

    /// Returns the limits of the working registers, without the part by which quantizing exceeds those of the axis.
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

    /// Returns the signal register (SAIA-SIG-00..10).
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
        set(Output, register(self.pid.converter_code(view.parameters.vocabularies.saia.output_gain, self.pwm)));
        set(Integral, register(self.pid.integral()));
        set(SaiaSignal::Error, self.errors.code.into());
        set(CommandErrors, self.errors.count);
        set(Tries, self.errors.tries);
    }

    /// Returns true if a restored state is valid.
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
            // A started axis has registers that move it.
            && (!matches!(self.phase, Phase::Position | Phase::Velocity) || self.working.is_startable())
    }

    /// Returns the motion of the profile; with the controller off it is at the actual position (A09).
    fn profile(&self, view: &View<'_>) -> Motion {
        if self.is_off() { Motion::at_rest(actual(view).0) } else { view.command }
    }
}

#[cfg(test)]
mod tests;

//! Interface of backends: inputs and outputs of a cycle, and their exchange (contract section 8).

mod analog;
mod backend;
mod cia402;
mod device_objects;
mod enabling;
mod error_code;
mod frames;
mod node;
mod service;
mod switching;

use crate::object::Object;
pub use analog::{AnalogDrive, AnalogWiring, FULL_VOLTS, LONGEST_ENABLE_NS};
pub use backend::{Backend, BackendObject, Capabilities, ObjectAddress, Objects, Terminal};
pub use cia402::*;
pub use device_objects::{DeviceObjects, ObjectAnswer, ObjectIndex, ObjectOperation, ObjectText, WaitingRequest};
pub use enabling::NotEnabled;
pub use error_code::{error_text, register_texts};
pub use frames::{FrameKind, FrameSource, RecordedFrame};
pub use node::{ForeignEmergency, NodeChange, NodeNotice};
use serde::{Deserialize, Serialize};
pub use service::{Health, Note, Service, ServiceError};
pub use switching::{SpeedOutputs, Switching};

/// Maximum latches per cycle; further ones are counted in [`Inputs::latches_lost`].
pub const MAX_LATCHES: usize = 16;

/// Input of an encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderInput {
    /// Raw counts.
    pub count: i64,
    /// Increases when the raw coordinate is set to a new value, which is no motion.
    pub epoch: u32,
    /// Whether the value may be used.
    pub valid: bool,
    /// Raw counts at the last index pulse of (t_k-1, t_k].
    pub index: Option<i64>,
}

/// State of the bus of a drive. Its backend decides what it treats as many errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BusState {
    /// The bus transmits.
    #[default]
    Active = 0,
    /// The bus transmits, with many errors (`PASSIVE` in CycleInputs).
    Degraded = 1,
    /// The bus does not transmit: it has switched itself off, the cable is cut, or the adapter is removed.
    Off = 2,
}

/// Emergency message of a drive (CiA 301, EMCY); in the inputs of one cycle only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emergency {
    /// Error code, as in object 603Fh.
    pub code: u16,
    /// Error register (1001h).
    pub register: u8,
    /// Manufacturer-specific data.
    pub data: [u8; 5],
}

impl Emergency {
    /// Converts the message to its bytes on the bus.
    pub fn to_bytes(self) -> [u8; 8] {
        let ([low, high], [a, b, c, d, e]) = (self.code.to_le_bytes(), self.data);
        [low, high, self.register, a, b, c, d, e]
    }

    /// Converts the message from its bytes on the bus.
    pub fn from_bytes([low, high, register, a, b, c, d, e]: [u8; 8]) -> Self {
        Self { code: u16::from_le_bytes([low, high]), register, data: [a, b, c, d, e] }
    }
}

/// Input of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveInput {
    /// Raw position counts (6064h).
    pub count: i64,
    /// Increases when the raw coordinate is set to a new value, which is no motion.
    pub epoch: u32,
    /// Actual velocity (counts/s).
    pub velocity: f64,
    /// Actual effort, in the unit of the drive.
    pub effort: f64,
    /// Status word (6041h).
    pub status: u16,
    /// Mode of operation display (6061h).
    pub mode: i8,
    /// Error code (603Fh).
    pub fault: u16,
    /// Whether the drive responds.
    pub online: bool,
    /// Whether the values are of this cycle; otherwise they are the last ones.
    pub fresh: bool,
    /// State of its bus.
    pub bus: BusState,
    /// Last emergency message since the previous cycle.
    pub emergency: Option<Emergency>,
    /// Digital inputs (60FDh): bits 0 to 2 are the limit switches and the reference switch, see [`inputs`].
    pub inputs: u32,
    /// Raw counts at the last index pulse of (t_k-1, t_k].
    pub index: Option<i64>,
    /// Whether a setpoint was not acknowledged in time; only for drives whose setpoints need that (profile position).
    pub unacknowledged: bool,
}

/// Digital inputs of a drive (CiA 402-2, object 60FDh): 1 if the switch is actuated.
pub mod inputs {
    /// Limit switch at the lower end of its counts.
    pub const NEGATIVE_LIMIT: u32 = 1;
    /// Limit switch at the upper end of its counts.
    pub const POSITIVE_LIMIT: u32 = 2;
    /// Reference switch.
    pub const HOME: u32 = 4;
}

/// Edge of a latch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// From 0 to 1.
    Rising,
    /// From 1 to 0.
    Falling,
}

/// A position or a time captured between t_k-1 and t_k. At least one of age and position is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latch {
    /// The input, encoder or axis that latched.
    pub object: Object,
    /// Edge of the latch.
    pub edge: Edge,
    /// Time before t_k (ns), below the cycle time.
    pub age_ns: Option<u32>,
    /// Raw counts.
    pub position: Option<i64>,
}

/// All values sampled at t_k. The arrays are in file order and never change their lengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// Number k of the cycle.
    pub cycle: u64,
    /// Missed cycles since the previous one.
    pub missed: u32,
    /// Digital inputs, 64 per word, the first one in bit 0.
    pub digital: Vec<u64>,
    /// Analog inputs (V).
    pub analog: Vec<f64>,
    /// Entries of `encoders`.
    pub encoder: Vec<EncoderInput>,
    /// Drives, in the order of their axes.
    pub drive: Vec<DriveInput>,
    /// Latches of (t_k-1, t_k]; at most [`MAX_LATCHES`].
    pub latch: Vec<Latch>,
    /// Latches that exceeded the maximum.
    pub latches_lost: u32,
}

/// Returns a bit of an array of 64-bit words, the first one in bit 0 of the first word; 0 if it does not exist.
pub fn bit(words: &[u64], place: usize) -> bool {
    words.get(place / 64).is_some_and(|word| word >> (place % 64) & 1 == 1)
}

/// Sets such a bit; has no effect if it does not exist.
pub fn set_bit(words: &mut [u64], place: usize, on: bool) {
    if let Some(word) = words.get_mut(place / 64) {
        *word = *word & !(1 << (place % 64)) | u64::from(on) << (place % 64);
    }
}

impl Inputs {
    /// Begins a new cycle, before backends write their inputs: digital inputs are 0, analog ones 0 V; drives and
    /// encoders keep their last values and are marked as not responding.
    pub fn begin(&mut self, cycle: u64, missed: u32) {
        (self.cycle, self.missed, self.latches_lost) = (cycle, missed, 0);
        self.digital.fill(0);
        self.analog.fill(0.0);
        for encoder in &mut self.encoder {
            (encoder.valid, encoder.index) = (false, None);
        }
        for drive in &mut self.drive {
            let DriveInput { count, epoch, velocity, effort, status, mode, fault, .. } = *drive;
            *drive = DriveInput { count, epoch, velocity, effort, status, mode, fault, ..DriveInput::default() };
        }
        self.latch.clear();
    }

    /// Copies all values of inputs of the same shape, without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        (self.cycle, self.missed, self.latches_lost) = (other.cycle, other.missed, other.latches_lost);
        self.digital.clone_from(&other.digital);
        self.analog.clone_from(&other.analog);
        self.encoder.clone_from(&other.encoder);
        self.drive.clone_from(&other.drive);
        self.latch.clone_from(&other.latch);
    }

    /// Returns a digital input by its number.
    pub fn digital(&self, index: usize) -> bool {
        bit(&self.digital, index)
    }

    /// Sets a digital input by its number; has no effect if it does not exist.
    pub fn set_digital(&mut self, index: usize, on: bool) {
        set_bit(&mut self.digital, index, on);
    }

    /// Adds a latch, or counts it as lost; does not allocate.
    pub fn add_latch(&mut self, latch: Latch) {
        if self.latch.len() < MAX_LATCHES.min(self.latch.capacity()) {
            self.latch.push(latch);
        } else {
            self.latches_lost = self.latches_lost.saturating_add(1);
        }
    }
}

/// Parameters of homing by the drive itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HomingOrder {
    /// Method (6098h).
    pub method: i8,
    /// Velocity of the search for the switch (6099h, sub-index 1; counts/s).
    pub search_velocity: f64,
    /// Velocity of the search for the zero (6099h, sub-index 2; counts/s).
    pub zero_velocity: f64,
    /// Acceleration (609Ah; counts/s^2).
    pub acceleration: f64,
}

/// Mode of operation of a drive (6060h), with the parameters that it needs in addition to the setpoints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Mode {
    /// No mode.
    #[default]
    None,
    /// The drive closes the position loop (csp).
    Position,
    /// The drive closes the velocity loop (csv).
    Velocity,
    /// The drive closes the torque loop (cst).
    Torque,
    /// The drive runs at a speed, without a closed loop (vl).
    Speed,
    /// The drive homes by itself.
    Homing(HomingOrder),
    /// The drive applies a voltage to its motor, without a closed loop.
    Voltage,
}

impl Mode {
    /// Returns its number (6060h).
    pub fn number(self) -> i8 {
        match self {
            Mode::None => 0,
            Mode::Position => MODE_CSP,
            Mode::Velocity => MODE_CSV,
            Mode::Torque => MODE_CST,
            Mode::Speed => MODE_VELOCITY,
            Mode::Homing(_) => MODE_HOMING,
            Mode::Voltage => MODE_VOLTAGE,
        }
    }
}

/// Output to a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriveOutput {
    /// Raw position counts (607Ah).
    pub position: i64,
    /// Velocity (counts/s).
    pub velocity: f64,
    /// Acceleration (counts/s^2).
    pub acceleration: f64,
    /// Effort, in the unit of the drive.
    pub effort: f64,
    /// Control word (6040h).
    pub control: u16,
    /// Mode of operation.
    pub mode: Mode,
}

/// All outputs of a cycle. The arrays are in file order and never change their lengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Digital outputs, 64 per word, the first one in bit 0.
    pub digital: Vec<u64>,
    /// Analog outputs (V).
    pub analog: Vec<f64>,
    /// Drives, in the order of their axes.
    pub drive: Vec<DriveOutput>,
}

impl Outputs {
    /// Copies all values of outputs of the same shape, without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        self.digital.clone_from(&other.digital);
        self.analog.clone_from(&other.analog);
        self.drive.clone_from(&other.drive);
    }

    /// Returns a digital output by its number.
    pub fn digital(&self, index: usize) -> bool {
        bit(&self.digital, index)
    }

    /// Sets a digital output by its number; has no effect if it does not exist.
    pub fn set_digital(&mut self, index: usize, on: bool) {
        set_bit(&mut self.digital, index, on);
    }

    /// Sets an analog output by its number (V); has no effect if it does not exist.
    pub fn set_analog(&mut self, index: usize, volts: f64) {
        if let Some(value) = self.analog.get_mut(index) {
            *value = volts;
        }
    }
}

/// Command interface of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The drive closes the position loop.
    #[default]
    Position,
    /// The drive closes the velocity loop.
    Velocity,
    /// The drive closes the torque loop.
    Torque,
    /// No loop is closed: the drive runs at one of several speeds (WF-OLC-01).
    OpenLoop,
    /// The drive closes no loop: it is a power stage that applies a voltage to its motor.
    Voltage,
}

impl Interface {
    /// All interfaces, in the order of messages.
    pub const ALL: [Self; 5] = [Self::Position, Self::Velocity, Self::Torque, Self::Voltage, Self::OpenLoop];

    /// Returns true if this program closes the loops of such a drive down to an effort: a torque or a voltage.
    pub fn takes_effort(self) -> bool {
        matches!(self, Self::Torque | Self::Voltage)
    }

    /// Returns true if this program closes the position loop.
    pub fn closes_loop_here(self) -> bool {
        self == Self::Velocity || self.takes_effort()
    }

    /// Returns its name in a cell.
    pub fn name(self) -> &'static str {
        match self {
            Interface::Position => "position",
            Interface::Velocity => "velocity",
            Interface::Torque => "torque",
            Interface::OpenLoop => "open_loop",
            Interface::Voltage => "voltage",
        }
    }

    /// Returns the mode of operation of such a drive.
    pub fn mode(self) -> Mode {
        match self {
            Interface::Position => Mode::Position,
            Interface::Velocity => Mode::Velocity,
            Interface::Torque => Mode::Torque,
            Interface::OpenLoop => Mode::Speed,
            Interface::Voltage => Mode::Voltage,
        }
    }
}

/// Returns the number of cycles for which a bit of the control word keeps each level, so that a drive detects its edge:
/// 50 ms, and at least 5 cycles. Some drives read their control word only in every fourth cycle.
pub fn level_cycles(cycle_ns: u64) -> u64 {
    50_000_000_u64.div_ceil(cycle_ns.max(1)).max(5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_is_set_alone_and_one_beyond_the_words_is_none() {
        for place in [0, 1, 63, 64, 127] {
            let mut words = [0, 0];
            set_bit(&mut words, place, true);
            assert_eq!((0..200).filter(|&place| bit(&words, place)).collect::<Vec<_>>(), [place]);
            let mut words = [u64::MAX; 2];
            set_bit(&mut words, place, false);
            assert_eq!((0..128).filter(|&place| !bit(&words, place)).collect::<Vec<_>>(), [place]);
        }
        let mut words = [0, 0];
        set_bit(&mut words, 128, true);
        assert_eq!(words, [0, 0]);
    }

    #[test]
    fn the_seventeenth_latch_is_counted() {
        let mut inputs = Inputs { latch: Vec::with_capacity(MAX_LATCHES), ..Inputs::default() };
        let latch = Latch { object: Object::Io(0), edge: Edge::Rising, age_ns: Some(0), position: None };
        (0..17).for_each(|_| inputs.add_latch(latch));
        assert_eq!((inputs.latch.len(), inputs.latches_lost), (16, 1));
    }
}

//! The backend contract: what enters and leaves a cycle, and who exchanges it (contract section 8).

use crate::object::Object;
use serde::{Deserialize, Serialize};

/// Most latches of one cycle; what comes beyond is counted in [`Inputs::latches_lost`].
pub const MAX_LATCHES: usize = 16;

/// What an encoder reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderInput {
    /// Raw counts.
    pub count: i64,
    /// Grows when the raw coordinate was set anew: that change is no motion.
    pub epoch: u32,
    /// False: the value is not to be used.
    pub valid: bool,
    /// Raw counts at the last index pulse of (t_k-1, t_k].
    pub index: Option<i64>,
}

/// What a drive tells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveInput {
    /// Raw position counts (6064h).
    pub count: i64,
    /// Grows when the raw coordinate was set anew: that change is no motion.
    pub epoch: u32,
    /// (counts/s)
    pub velocity: f64,
    /// In the drive's unit.
    pub effort: f64,
    /// Status word (6041h).
    pub status: u16,
    /// Mode of operation display (6061h).
    pub mode: i8,
    /// Error code (603Fh).
    pub fault: u16,
    /// The drive answers.
    pub online: bool,
    /// The values are of this cycle; else the last ones.
    pub fresh: bool,
    /// Digital inputs (60FDh): bits 0 to 2 are the switches of the travel, see [`inputs`].
    pub inputs: u32,
    /// Raw counts at the last index pulse of (t_k-1, t_k].
    pub index: Option<i64>,
}

/// Digital inputs of a drive (CiA 402-2, object 60FDh): 1 where the switch is actuated.
pub mod inputs {
    /// Limit switch at the lower end of its counts.
    pub const NEGATIVE_LIMIT: u32 = 1;
    /// Limit switch at the upper end of its counts.
    pub const POSITIVE_LIMIT: u32 = 2;
    /// Reference switch.
    pub const HOME: u32 = 4;
}

/// Which edge a latch took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// From 0 to 1.
    Rising,
    /// From 1 to 0.
    Falling,
}

/// A position or an instant caught between t_k-1 and t_k. At least one of age and position is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latch {
    /// The input, encoder or axis that latched.
    pub object: Object,
    /// Which edge.
    pub edge: Edge,
    /// How long before t_k (ns), below the cycle's length.
    pub age_ns: Option<u32>,
    /// Raw counts.
    pub position: Option<i64>,
}

/// Everything that is sampled at t_k. The arrays are in file order and never change their lengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// k
    pub cycle: u64,
    /// Cycles that were missed since the last one.
    pub missed: u32,
    /// Digital inputs, 64 to a word, the first one in bit 0.
    pub digital: Vec<u64>,
    /// (V)
    pub analog: Vec<f64>,
    /// Entries of `encoders`.
    pub encoder: Vec<EncoderInput>,
    /// Axes that have a drive.
    pub drive: Vec<DriveInput>,
    /// Latches of (t_k-1, t_k]; at most [`MAX_LATCHES`].
    pub latch: Vec<Latch>,
    /// Latches that found no room.
    pub latches_lost: u32,
}

/// A bit of words of 64, the first one in bit 0 of the first word; one that does not exist is 0.
pub fn bit(words: &[u64], place: usize) -> bool {
    words.get(place / 64).is_some_and(|word| word >> (place % 64) & 1 == 1)
}

/// Sets such a bit; one that does not exist stays so.
pub fn set_bit(words: &mut [u64], place: usize, on: bool) {
    if let Some(word) = words.get_mut(place / 64) {
        *word = *word & !(1 << (place % 64)) | u64::from(on) << (place % 64);
    }
}

impl Inputs {
    /// Copies all of another one of the same shape; takes no memory then.
    pub fn copy_from(&mut self, other: &Self) {
        (self.cycle, self.missed, self.latches_lost) = (other.cycle, other.missed, other.latches_lost);
        self.digital.clone_from(&other.digital);
        self.analog.clone_from(&other.analog);
        self.encoder.clone_from(&other.encoder);
        self.drive.clone_from(&other.drive);
        self.latch.clone_from(&other.latch);
    }

    /// A digital input by its number.
    pub fn digital(&self, index: usize) -> bool {
        bit(&self.digital, index)
    }

    /// Sets a digital input by its number; one that does not exist stays so.
    pub fn set_digital(&mut self, index: usize, on: bool) {
        set_bit(&mut self.digital, index, on);
    }

    /// Adds a latch, or counts it as lost; takes no memory.
    pub fn add_latch(&mut self, latch: Latch) {
        if self.latch.len() < MAX_LATCHES.min(self.latch.capacity()) {
            self.latch.push(latch);
        } else {
            self.latches_lost = self.latches_lost.saturating_add(1);
        }
    }
}

/// What a drive is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriveOutput {
    /// Raw position counts (607Ah).
    pub position: i64,
    /// (counts/s)
    pub velocity: f64,
    /// (counts/s^2)
    pub acceleration: f64,
    /// In the drive's unit.
    pub effort: f64,
    /// Control word (6040h).
    pub control: u16,
    /// Mode of operation (6060h).
    pub mode: i8,
    /// Homing method to run in the drive.
    pub homing: Option<i8>,
}

/// Everything that a cycle asks for. The arrays are in file order and never change their lengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Digital outputs, 64 to a word, the first one in bit 0.
    pub digital: Vec<u64>,
    /// (V)
    pub analog: Vec<f64>,
    /// Axes that have a drive.
    pub drive: Vec<DriveOutput>,
}

impl Outputs {
    /// A digital output by its number.
    pub fn digital(&self, index: usize) -> bool {
        bit(&self.digital, index)
    }

    /// Sets a digital output by its number; one that does not exist stays so.
    pub fn set_digital(&mut self, index: usize, on: bool) {
        set_bit(&mut self.digital, index, on);
    }

    /// Sets an analog output by its number (V); one that does not exist stays so.
    pub fn set_analog(&mut self, index: usize, volts: f64) {
        if let Some(value) = self.analog.get_mut(index) {
            *value = volts;
        }
    }
}

/// How a drive is commanded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The drive closes the position loop.
    #[default]
    Position,
    /// The drive closes the velocity loop.
    Velocity,
    /// The drive closes the torque loop.
    Torque,
    /// Nothing is closed: the drive runs at one of some speeds (WF-OLC-01).
    OpenLoop,
}

impl Interface {
    /// Its name in a cell.
    pub fn name(self) -> &'static str {
        match self {
            Interface::Position => "position",
            Interface::Velocity => "velocity",
            Interface::Torque => "torque",
            Interface::OpenLoop => "open_loop",
        }
    }

    /// Mode of operation of such a drive (6060h).
    pub fn mode(self) -> i8 {
        match self {
            Interface::Position => MODE_CSP,
            Interface::Velocity => MODE_CSV,
            Interface::Torque => MODE_CST,
            Interface::OpenLoop => MODE_VELOCITY,
        }
    }

    /// Can a drive of these capabilities be commanded so?
    pub fn is_offered(self, capabilities: &Capabilities) -> bool {
        match self {
            Interface::Position => true,
            Interface::Velocity | Interface::OpenLoop => capabilities.velocity,
            Interface::Torque => capabilities.torque,
        }
    }
}

/// What a backend offers for one drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capabilities {
    /// What the outputs of k ask shows in the inputs of k + 1 + delay.
    pub delay: u32,
    /// It commands velocity as well as position.
    pub velocity: bool,
    /// It commands torque as well as position.
    pub torque: bool,
    /// It latches positions.
    pub latches: bool,
    /// It homes by itself.
    pub homes: bool,
    /// It has a brake.
    pub brake: bool,
}

/// Whatever drives hang on. A backend reads and writes only its own objects, so that several share a machine.
pub trait Backend {
    /// What it offers for a drive, by the drive's place in [`Inputs::drive`]; none for a drive of another backend.
    fn capabilities(&self, drive: usize) -> Option<Capabilities>;

    /// Makes it ready to exchange.
    ///
    /// # Errors
    /// A sentence that says what is not there.
    fn start(&mut self) -> Result<(), String>;

    /// Fills in what it knows of cycle `inputs.cycle`; does not block.
    fn read(&mut self, inputs: &mut Inputs);

    /// Hands over what the cycle asks for; does not block.
    fn write(&mut self, outputs: &Outputs);

    /// Leaves its drives in a safe state.
    fn stop(&mut self);
}

/// State of a drive (CiA 402), numbered as in the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DriveState {
    /// Not ready to switch on.
    #[default]
    NotReady = 0,
    /// Switch on disabled.
    SwitchOnDisabled = 1,
    /// Ready to switch on.
    Ready = 2,
    /// Switched on.
    SwitchedOn = 3,
    /// Operation enabled.
    Enabled = 4,
    /// Quick stop active.
    QuickStop = 5,
    /// Fault reaction active.
    FaultReaction = 6,
    /// Fault.
    Fault = 7,
}

impl DriveState {
    /// The state that a status word shows (CiA 402-2, table of the status word).
    pub fn from_status(status: u16) -> Self {
        match (status & 0x4F, status & 0x6F) {
            (0x00, _) => Self::NotReady,
            (0x40, _) => Self::SwitchOnDisabled,
            (_, 0x21) => Self::Ready,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::Enabled,
            (_, 0x07) => Self::QuickStop,
            (0x0F, _) => Self::FaultReaction,
            (0x08, _) => Self::Fault,
            // Any other pattern is none of CiA 402: nothing may be asked of such a drive.
            _ => Self::NotReady,
        }
    }

    /// The status word that shows this state, with voltage enabled (bit 4) from ready on.
    pub fn status(self) -> u16 {
        match self {
            Self::NotReady => 0x0000,
            Self::SwitchOnDisabled => 0x0040,
            Self::Ready => 0x0031,
            Self::SwitchedOn => 0x0033,
            Self::Enabled => 0x0037,
            Self::QuickStop => 0x0017,
            Self::FaultReaction => 0x001F,
            Self::Fault => 0x0008,
        }
    }
}

/// Control words (CiA 402-2, table of the control word).
pub mod control {
    /// Switches the voltage off: the drive coasts.
    pub const DISABLE_VOLTAGE: u16 = 0x00;
    /// Quick stop: the drive stops on its own ramp.
    pub const QUICK_STOP: u16 = 0x02;
    /// Shutdown: to ready to switch on.
    pub const SHUTDOWN: u16 = 0x06;
    /// To switched on.
    pub const SWITCH_ON: u16 = 0x07;
    /// To operation enabled.
    pub const ENABLE: u16 = 0x0F;
    /// Its rising edge resets a fault.
    pub const FAULT_RESET: u16 = 0x80;
    /// In mode homing, together with [`ENABLE`]: its rising edge starts.
    pub const START_HOMING: u16 = 0x10;
}

/// Status word bit 7: the drive warns.
pub const STATUS_WARNING: u16 = 0x80;
/// Status word bit 12 in mode homing: the zero is known.
pub const STATUS_HOMING_ATTAINED: u16 = 0x1000;
/// Status word bit 13 in mode homing: it was not found.
pub const STATUS_HOMING_ERROR: u16 = 0x2000;
/// Status word bit 10: the target is reached, and in mode homing the axis stands.
pub const STATUS_TARGET_REACHED: u16 = 0x0400;
/// Mode of operation: homing by the drive.
pub const MODE_HOMING: i8 = 6;
/// Mode of operation: cyclic synchronous position.
pub const MODE_CSP: i8 = 8;
/// Mode of operation: cyclic synchronous velocity.
pub const MODE_CSV: i8 = 9;
/// Mode of operation: cyclic synchronous torque.
pub const MODE_CST: i8 = 10;
/// Mode of operation: velocity mode of frequency converters and switched motors.
pub const MODE_VELOCITY: i8 = 2;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_reads_back_from_its_status_word() {
        use DriveState::*;
        for state in [NotReady, SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop, FaultReaction, Fault] {
            assert_eq!(DriveState::from_status(state.status()), state);
            assert_eq!(DriveState::from_status(state.status() | STATUS_WARNING | 0x1600), state, "don't-care bits");
        }
    }

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

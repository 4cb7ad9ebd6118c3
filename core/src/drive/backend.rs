//! Whatever drives, encoders, inputs and outputs hang on.
//!
//! Law      a backend touches its own objects and no others, so that any number share a machine; what it does not fill in is not there
//! Refuses  nothing in a cycle: what fails is a state of its objects

use super::{Inputs, Interface, Outputs};
use serde::{Deserialize, Serialize};

/// What a backend offers for one drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Capabilities {
    /// What the outputs of k ask shows in the inputs of k + 1 + delay.
    pub delay: u32,
    /// The drive closes the position loop (mode 8).
    pub position: bool,
    /// The drive closes the velocity loop (mode 9).
    pub velocity: bool,
    /// The drive closes the torque loop (mode 10).
    pub torque: bool,
    /// The drive runs at a speed (mode 2).
    pub open_loop: bool,
    /// The drive latches positions.
    pub latches: bool,
    /// The drive homes by itself (mode 6).
    pub homes: bool,
    /// The drive is a power stage that takes voltages.
    pub voltage: bool,
}

impl Capabilities {
    /// All that there is, with that delay.
    pub fn all(delay: u32) -> Self {
        let [position, velocity, torque, open_loop, latches, homes, voltage] = [true; 7];
        Self { delay, position, velocity, torque, open_loop, latches, homes, voltage }
    }

    /// Can the drive be commanded so?
    pub fn offers(&self, interface: Interface) -> bool {
        match interface {
            Interface::Position => self.position,
            Interface::Velocity => self.velocity,
            Interface::Torque => self.torque,
            Interface::OpenLoop => self.open_loop,
            Interface::Voltage => self.voltage,
        }
    }
}

/// Where an object of the machine is at its backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Place among its kind in [`Inputs`] or [`Outputs`].
    pub place: usize,
    /// Its number at the backend: `address`; on CAN `node` of a drive, 256 `node` + `address` of other things.
    pub address: u16,
}

/// The objects of one backend.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Objects {
    /// Digital inputs.
    pub digital_inputs: Vec<Terminal>,
    /// Digital outputs.
    pub digital_outputs: Vec<Terminal>,
    /// Analog inputs.
    pub analog_inputs: Vec<Terminal>,
    /// Analog outputs.
    pub analog_outputs: Vec<Terminal>,
    /// Entries of `encoders`.
    pub encoders: Vec<Terminal>,
    /// Axes that have a drive.
    pub drives: Vec<Terminal>,
}

/// The cyclic half of a backend, on the cycle thread: neither of its doors blocks, locks or takes memory. What takes its time (starting,
/// configuring, health) is the other half, and runs elsewhere.
pub trait Backend: Send {
    /// What it offers for a drive, by the drive's place in [`Inputs::drive`]; none for a drive of another backend.
    fn capabilities(&self, drive: usize) -> Option<Capabilities>;

    /// Fills in what it knows of cycle `inputs.cycle`. The inputs [begin](Inputs::begin) as those of objects that are not there.
    fn read(&mut self, inputs: &mut Inputs);

    /// Hands over what the cycle asks for.
    fn write(&mut self, outputs: &Outputs);
}

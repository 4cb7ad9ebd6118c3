//! Backends: the access to drives, encoders, inputs and outputs.
//!
//! Law      a backend accesses only its own objects, so that any number of backends can share a machine; objects that
//!          no backend writes count as missing. At most one backend owns the time base of the cycle
//! Refuses  nothing in a cycle: a failure is a state of its objects

use super::{Inputs, Interface, Outputs};
use serde::{Deserialize, Serialize};

/// Capabilities of a drive at its backend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Capabilities {
    /// Additional delay in cycles: outputs of cycle k take effect in the inputs of cycle k + 1 + delay.
    pub delay: u32,
    /// Whether the drive closes the position loop (mode 8).
    pub position: bool,
    /// Whether the drive closes the velocity loop (mode 9).
    pub velocity: bool,
    /// Whether the drive closes the torque loop (mode 10).
    pub torque: bool,
    /// Whether the drive runs at a speed (mode 2).
    pub open_loop: bool,
    /// Whether the drive latches positions.
    pub latches: bool,
    /// Whether the drive homes by itself (mode 6).
    pub homes: bool,
    /// Whether the drive is a power stage that accepts voltages.
    pub voltage: bool,
}

impl Capabilities {
    /// Returns all capabilities, with that delay.
    pub fn all(delay: u32) -> Self {
        let [position, velocity, torque, open_loop, latches, homes, voltage] = [true; 7];
        Self { delay, position, velocity, torque, open_loop, latches, homes, voltage }
    }

    /// Returns true if the drive has that command interface.
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

/// Address of an object at its backend, in two parts. The backend defines the numbers and their ranges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ObjectAddress {
    /// Number of the device; 0 at a backend whose inputs, outputs and encoders are not at devices.
    pub device: u16,
    /// Number of the channel among those of its kind; 0 for a drive, and for an encoder that is a device.
    pub channel: u16,
}

impl ObjectAddress {
    /// Returns the address of an object that is a device.
    pub const fn of_device(device: u16) -> Self {
        Self { device, channel: 0 }
    }

    /// Returns the address of an object at a backend whose objects of this kind are not at devices.
    pub const fn of_channel(channel: u16) -> Self {
        Self { device: 0, channel }
    }
}

/// An object of the machine at its backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BackendObject {
    /// Index among its kind in [`Inputs`] or [`Outputs`].
    pub place: usize,
    /// Address at the backend.
    pub address: ObjectAddress,
}

/// An object of the machine at one of the channels of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Index among its kind in [`Inputs`] or [`Outputs`].
    pub place: usize,
    /// Number of the channel, as in [`ObjectAddress::channel`].
    pub address: u16,
}

/// The objects of one backend.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Objects {
    /// Digital inputs.
    pub digital_inputs: Vec<BackendObject>,
    /// Digital outputs.
    pub digital_outputs: Vec<BackendObject>,
    /// Analog inputs.
    pub analog_inputs: Vec<BackendObject>,
    /// Analog outputs.
    pub analog_outputs: Vec<BackendObject>,
    /// Entries of `encoders`.
    pub encoders: Vec<BackendObject>,
    /// Drives.
    pub drives: Vec<BackendObject>,
}

/// The cyclic half of a backend, on the cycle thread: its methods neither block nor lock nor allocate. The other half
/// handles slow work (start, configuration, health) on another thread.
pub trait Backend: Send {
    /// Returns the capabilities of a drive, by its index in [`Inputs::drive`]; `None` for a drive of another backend.
    fn capabilities(&self, drive: usize) -> Option<Capabilities>;

    /// Writes its inputs of cycle `inputs.cycle`. The inputs [begin](Inputs::begin) as those of missing objects.
    fn read(&mut self, inputs: &mut Inputs);

    /// Sends the outputs of the cycle.
    fn write(&mut self, outputs: &Outputs);

    /// Whether this backend owns the time base of the cycle, such as a segment with distributed clocks. It never changes.
    /// At most one backend of a machine owns it; without an owner, the clock of the host is the time base.
    fn owns_clock(&self) -> bool {
        false
    }

    /// Returns by how much the next deadline of the cycle shifts against the clock of the host, in ns, positive for
    /// later. It is called only if this backend owns the clock, once in each cycle, after [`write`](Self::write). A
    /// backend that cannot measure its clock, for example because an answer is missing, returns 0, or the negative
    /// `pending_ns` to discard what is left of earlier shifts.
    ///
    /// Shifts add up. Each cycle applies at most 1/1000 of the cycle time, the following cycles the rest.
    /// `pending_ns` is the sum of the earlier shifts that is not applied yet. A backend that measures its whole phase
    /// error in each cycle subtracts it, so that the same error is not corrected twice. When cycles begin again after a
    /// pause, deadlines begin at any phase and `pending_ns` is 0: measure the whole phase error again.
    ///
    /// The machine does not see the shift: its time stays k times the cycle time.
    fn clock_shift(&mut self, pending_ns: i64) -> i64 {
        let _ = pending_ns;
        0
    }
}

//! The simulated plant: drives, encoders and I/O, deterministic and as fast as the cycle.
//!
//! Law      what the outputs of k ask shows in the inputs of k + 1 + delay (contract section 1)
//! Reads    outputs; what a scenario injects
//! Writes   inputs
//! Refuses  nothing: what is wrong with a model is refused when it is made
//! Source   contract sections 3 and 8

mod drive;
mod motor;
mod second_order;

pub use drive::SimDrive;
pub use motor::{TwoSpeed, Valve, VelocityLag};
pub use second_order::{ModelError, SecondOrder};

use crate::config::{IoKind, MachineConfig};
use crate::drive::{Backend, Capabilities, EncoderInput, Inputs, Interface, Latch, MAX_LATCHES, Outputs};

/// How a simulated drive follows its setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Model {
    /// actual(k) = command(k - 1 - delay); a velocity is there at once.
    #[default]
    Ideal,
    /// A damped second-order system between the setpoint and the position, or the velocity.
    SecondOrder(SecondOrder),
    /// A lag between the velocity's setpoint and the velocity.
    Velocity(VelocityLag),
    /// A motor that runs at selected speeds and coasts when it is switched off.
    TwoSpeed(TwoSpeed),
    /// A hydraulic motor behind a valve.
    Valve(Valve),
}

impl Model {
    /// The same motor wired so that it turns against its setpoint, if `inverted`; a model of positions stays what it is.
    pub fn wired(self, inverted: bool) -> Self {
        let mut model = self;
        match &mut model {
            Model::Ideal | Model::SecondOrder(_) => {}
            Model::Velocity(law) => law.inverted = inverted,
            Model::TwoSpeed(law) => law.inverted = inverted,
            Model::Valve(law) => law.inverted = inverted,
        }
        model
    }

    /// Does a drive of this kind take what `interface` gives it?
    pub fn fits(&self, interface: Interface) -> bool {
        match self {
            Model::Ideal => interface != Interface::Torque,
            Model::SecondOrder(_) => matches!(interface, Interface::Position | Interface::Velocity),
            Model::Velocity(_) => matches!(interface, Interface::Velocity | Interface::OpenLoop),
            Model::TwoSpeed(_) | Model::Valve(_) => interface == Interface::OpenLoop,
        }
    }
}

/// The plant of one machine. Where a cell mixes backends, it serves the drives that have a model.
#[derive(Clone, Debug)]
pub struct Plant {
    drives: Vec<Option<SimDrive>>,
    encoders: Vec<EncoderInput>,
    digital: Vec<u64>,
    analog: Vec<f64>,
    latches: Vec<Latch>,
}

impl Plant {
    /// A plant for a machine: one model for each axis that has a drive, in file order; none leaves the drive to others.
    pub fn new(config: &MachineConfig, models: &[Option<Model>]) -> Self {
        let delays = config.axes.iter().filter_map(|axis| axis.drive);
        let drives = delays
            .zip(models)
            .map(|(delay, model)| model.map(|model| SimDrive::new(model, delay, config.cycle_ns)))
            .collect();
        Self {
            drives,
            encoders: vec![EncoderInput { valid: true, ..EncoderInput::default() }; config.encoders.len()],
            digital: vec![0; config.count_io(IoKind::DigitalInput).div_ceil(64)],
            analog: vec![0.0; config.count_io(IoKind::AnalogInput)],
            latches: Vec::with_capacity(MAX_LATCHES),
        }
    }

    /// A simulated drive by its place among the drives.
    pub fn drive(&mut self, place: usize) -> Option<&mut SimDrive> {
        self.drives.get_mut(place)?.as_mut()
    }

    /// Sets a digital input for good.
    pub fn set_digital(&mut self, place: usize, on: bool) {
        if let Some(word) = self.digital.get_mut(place / 64) {
            *word = *word & !(1 << (place % 64)) | u64::from(on) << (place % 64);
        }
    }

    /// Sets an analog input for good (V).
    pub fn set_analog(&mut self, place: usize, volts: f64) {
        if let Some(value) = self.analog.get_mut(place) {
            *value = volts;
        }
    }

    /// Lets an encoder read `by` more counts at once, as after a slip.
    pub fn jump_encoder(&mut self, place: usize, by: i64) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.count = encoder.count.wrapping_add(by);
        }
    }

    /// Adds a latch to the next inputs; false when there is no room.
    pub fn add_latch(&mut self, latch: Latch) -> bool {
        let room = self.latches.len() < MAX_LATCHES;
        if room {
            self.latches.push(latch);
        }
        room
    }
}

impl Backend for Plant {
    fn capabilities(&self, drive: usize) -> Option<Capabilities> {
        let drive = self.drives.get(drive)?.as_ref()?;
        Some(Capabilities { delay: drive.delay(), velocity: true, ..Capabilities::default() })
    }

    fn start(&mut self) -> Result<(), String> {
        Ok(())
    }

    fn read(&mut self, inputs: &mut Inputs) {
        for (input, drive) in inputs.drive.iter_mut().zip(&mut self.drives) {
            if let Some(drive) = drive {
                *input = drive.read();
            }
        }
        inputs.encoder.copy_from_slice(&self.encoders);
        inputs.digital.copy_from_slice(&self.digital);
        inputs.analog.copy_from_slice(&self.analog);
        inputs.latch.clear();
        inputs.latches_lost = 0;
        for latch in self.latches.drain(..) {
            inputs.add_latch(latch);
        }
    }

    fn write(&mut self, outputs: &Outputs) {
        for (output, drive) in outputs.drive.iter().zip(&mut self.drives) {
            if let Some(drive) = drive {
                drive.write(*output);
            }
        }
    }

    fn stop(&mut self) {}
}

#[cfg(test)]
mod tests;

//! Simulated plant: drives, encoders and I/O, deterministic and as fast as the cycle.
//!
//! Law      outputs of cycle k take effect in the inputs of cycle k + 1 + delay (contract section 1)
//! Reads    outputs; faults that a scenario injects
//! Writes   inputs
//! Refuses  nothing: errors of a model are reported at its creation
//! Source   contract sections 3 and 8

mod analog;
mod drive;
mod driven;
mod encoder;
mod fixtures;
mod homing;
mod marks;
mod mechanics;
mod motor;
mod plant;
mod second_order;
mod sensors;
mod word;

pub use drive::SimDrive;
pub use fixtures::{Fixtures, Index};
pub use marks::{Marks, Stretch};
pub use mechanics::{Mechanics, SignOutputs, SimBrake, SwitchWiring};
pub use motor::{TwoSpeed, Valve, VelocityLag};
pub use plant::{Amplifier, Coupling, Friction, Load, Motor, MotorData, Reading, Stage};
pub use second_order::{ModelError, SecondOrder};
pub use sensors::Carrier;

use crate::axis::{Source, Wired};
use crate::config::{AxisConfig, IoKind, MachineConfig};
use crate::drive::{
    Backend, BackendObject, BusState, Capabilities, Edge, Inputs, Interface, Latch, MAX_LATCHES, ObjectAddress,
    Objects, Outputs, bit, set_bit,
};
use crate::object::Object;
use analog::Analog;
use encoder::SimEncoder;
use sensors::Sensor;

/// Model of a simulated drive: its response to the setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Model {
    /// actual(k) = command(k - 1 - delay); a velocity is reached at once.
    #[default]
    Ideal,
    /// A damped second-order system between the setpoint and the position, or the velocity.
    SecondOrder(SecondOrder),
    /// A lag between the velocity setpoint and the velocity.
    Velocity(VelocityLag),
    /// A motor that runs at selected speeds and coasts when it is switched off.
    TwoSpeed(TwoSpeed),
    /// A hydraulic motor with a valve.
    Valve(Valve),
    /// A motor with its mechanics; its setpoint is a torque, or a velocity for a loop of its drive.
    Motor(Motor),
}

impl Model {
    /// Returns the same motor with inverted direction, if `inverted`; a model of positions does not change.
    pub fn wired(self, inverted: bool) -> Self {
        let mut model = self;
        match &mut model {
            Model::Ideal | Model::SecondOrder(_) => {}
            Model::Velocity(law) => law.inverted = inverted,
            Model::TwoSpeed(law) => law.inverted = inverted,
            Model::Valve(law) => law.inverted = inverted,
            Model::Motor(law) => law.inverted = inverted,
        }
        model
    }

    /// Returns the capabilities of a drive of this kind.
    pub fn capabilities(&self, delay: u32) -> Capabilities {
        Capabilities {
            delay,
            position: self.fits(Interface::Position),
            velocity: self.fits(Interface::Velocity),
            torque: self.fits(Interface::Torque),
            open_loop: self.fits(Interface::OpenLoop),
            latches: true,
            homes: true,
            voltage: self.fits(Interface::Voltage),
        }
    }

    /// Returns true if a drive of this kind has that command interface.
    pub fn fits(&self, interface: Interface) -> bool {
        match self {
            Model::Ideal => !interface.takes_effort(),
            Model::SecondOrder(_) => matches!(interface, Interface::Position | Interface::Velocity),
            Model::Velocity(_) => matches!(interface, Interface::Velocity | Interface::OpenLoop),
            Model::TwoSpeed(_) | Model::Valve(_) => interface == Interface::OpenLoop,
            // A voltage needs a winding.
            Model::Motor(law) => match interface {
                Interface::Velocity | Interface::Torque => true,
                Interface::Voltage => law.has_winding(),
                Interface::Position | Interface::OpenLoop => false,
            },
        }
    }
}

/// A simulated bus of the plant.
#[derive(Clone, Debug)]
struct Bus {
    objects: Objects,
    is_off: bool,
}

/// Plant of one machine, common to all of its simulated buses: the parts of an axis may be on different buses. If a
/// cell mixes backends, the plant serves the objects of its buses.
#[derive(Clone, Debug)]
pub struct Plant {
    drives: Vec<Option<SimDrive>>,
    encoders: Vec<SimEncoder>,
    digital: Vec<u64>,
    analog: Vec<f64>,
    latches: Vec<Latch>,
    buses: Vec<Bus>,
    /// Buffer for outputs while a bus is off.
    arriving: Outputs,
    /// Axis of each drive.
    axes: Vec<u16>,
    /// Switches that are wired to digital inputs, with the index of their drives.
    wires: Vec<(usize, SwitchWiring)>,
    /// Digital inputs that are contacts of drives, with the index of the drives.
    contacts: Vec<(usize, usize)>,
    /// Digital inputs that detect printed marks.
    sensors: Vec<Sensor>,
    /// Entry of `io` of each digital input that latches.
    latching: Vec<Option<u16>>,
    cycle_ns: u64,
}

/// Returns the age of an edge (ns) after which a fraction of the travel of the cycle was left: below the cycle time.
fn age(left: f64, cycle_ns: u64) -> u32 {
    let newest = cycle_ns.saturating_sub(1).min(u64::from(u32::MAX)) as u32;
    // The cast saturates.
    ((left * cycle_ns as f64).round() as u32).min(newest)
}

impl Plant {
    /// Creates a plant for a machine with one bus: one model for each axis that has a drive, in file order; `None`
    /// leaves the drive to another backend.
    pub fn new(config: &MachineConfig, models: &[Option<Model>]) -> Self {
        let objects = |count: usize, address: fn(u16) -> ObjectAddress| -> Vec<BackendObject> {
            let numbered = (0_u16..).zip(0..count);
            numbered.map(|(number, place)| BackendObject { place, address: address(number) }).collect()
        };
        let channels = |count| objects(count, ObjectAddress::of_channel);
        let mut drives = objects(config.count_drives(), ObjectAddress::of_device);
        drives.retain(|drive| models.get(drive.place).copied().flatten().is_some());
        let all = Objects {
            digital_inputs: channels(config.count_io(IoKind::DigitalInput)),
            digital_outputs: channels(config.count_io(IoKind::DigitalOutput)),
            analog_inputs: channels(config.count_io(IoKind::AnalogInput)),
            analog_outputs: channels(config.count_io(IoKind::AnalogOutput)),
            encoders: channels(config.encoders.len()),
            drives,
        };
        Self::with_buses(config, models, vec![all])
    }

    /// Creates a plant with the objects of each simulated bus.
    pub fn with_buses(config: &MachineConfig, models: &[Option<Model>], buses: Vec<Objects>) -> Self {
        let count = config.encoders.len();
        let source = |axis: &AxisConfig| Source::of(axis.wired, count, &axis.power_on()).ok();
        let (axes, drives): (Vec<u16>, Vec<(&AxisConfig, Capabilities)>) =
            config.drives().map(|(index, axis, offers)| (index, (axis, offers))).unzip();
        // An encoder that an axis reads is turned by it; by the first one of several axes.
        let turned_by = |encoder: usize| {
            let reads = |(axis, _): &(&AxisConfig, Capabilities)| matches!(source(axis), Some(Source::Encoder(place)) if usize::from(place) == encoder);
            drives.iter().position(reads)
        };
        let inputs = config.io.iter().enumerate().filter(|(_, io)| io.kind == IoKind::DigitalInput);
        let latching = inputs.map(|(entry, io)| u16::try_from(entry).ok().filter(|_| io.latch)).collect();
        let encoders = config.encoders.iter().enumerate();
        let encoders = encoders.map(|(place, encoder)| SimEncoder::new(encoder, turned_by(place))).collect();
        let count_drives = drives.len();
        let drives: Vec<Option<SimDrive>> = drives
            .iter()
            .zip(models)
            .map(|((axis, offers), model)| {
                let mut drive = SimDrive::new((*model)?, offers.delay, config.cycle_ns).offering(*offers);
                drive.set_analog(Analog::of(axis, config));
                match (source(axis), axis.wired) {
                    (Some(Source::Drive(form)), _) | (Some(Source::Encoder(_)), Wired::Drive(form)) => {
                        drive.set_encoder_form(form)
                    }
                    _ => {}
                }
                Some(drive)
            })
            .collect();
        let contact = |(place, drive): (usize, &Option<SimDrive>)| Some((drive.as_ref()?.analog()?.ready()?, place));
        let contacts = drives.iter().enumerate().filter_map(contact).collect();
        Self {
            drives,
            encoders,
            digital: vec![0; config.count_io(IoKind::DigitalInput).div_ceil(64)],
            analog: vec![0.0; config.count_io(IoKind::AnalogInput)],
            latches: Vec::with_capacity(MAX_LATCHES),
            buses: buses.into_iter().map(|objects| Bus { objects, is_off: false }).collect(),
            arriving: Outputs {
                digital: vec![0; config.count_io(IoKind::DigitalOutput).div_ceil(64)],
                analog: vec![0.0; config.count_io(IoKind::AnalogOutput)],
                drive: vec![Default::default(); count_drives],
            },
            axes,
            wires: Vec::new(),
            contacts,
            sensors: Vec::new(),
            latching,
            cycle_ns: config.cycle_ns,
        }
    }

    /// Switches one of its buses off permanently: its inputs are no longer updated, and its outputs and drives have no
    /// voltage. Returns false if the bus does not exist.
    pub fn switch_off_bus(&mut self, place: usize) -> bool {
        let bus = self.buses.get_mut(place);
        bus.map(|bus| bus.is_off = true).is_some()
    }

    /// Returns true if the bus of an object is off.
    fn is_bus_off(&self, object: Object) -> bool {
        let place = match object {
            Object::Io(entry) => self.latching.iter().position(|latching| *latching == Some(entry)),
            Object::Encoder(place) => Some(usize::from(place)),
            Object::Axis(axis) => self.axes.iter().position(|driven| *driven == axis),
            Object::Machine | Object::Memory(_) | Object::Function(_) | Object::Table(_) | Object::Program(_) => None,
        };
        self.buses.iter().filter(|bus| bus.is_off).any(|bus| {
            let all = match object {
                Object::Io(_) => &bus.objects.digital_inputs,
                Object::Encoder(_) => &bus.objects.encoders,
                _ => &bus.objects.drives,
            };
            all.iter().any(|terminal| Some(terminal.place) == place)
        })
    }

    /// Attaches mechanics to a drive. From now on its wired switches read at their digital inputs.
    pub fn attach_mechanics(&mut self, place: usize, mechanics: &Mechanics) {
        let Some(drive) = self.drive(place) else { return };
        drive.install_fixtures(mechanics.fixtures);
        drive.attach_mechanics(mechanics);
        self.wires.retain(|(drive, _)| *drive != place);
        self.wires.extend(mechanics.wires.iter().flatten().map(|wire| (place, *wire)));
    }

    /// Returns a simulated drive by its index.
    pub fn drive(&mut self, place: usize) -> Option<&mut SimDrive> {
        self.drives.get_mut(place)?.as_mut()
    }

    /// Sets a digital input permanently: a switch that is wired to it is stuck, and the input detects no more marks.
    pub fn set_digital(&mut self, place: usize, on: bool) {
        self.wires.retain(|(_, wire)| wire.input != place);
        self.contacts.retain(|(input, _)| *input != place);
        self.sensors.retain(|sensor| sensor.input != place);
        self.put_digital(place, on);
    }

    fn put_digital(&mut self, place: usize, on: bool) {
        set_bit(&mut self.digital, place, on);
    }

    /// Sets an analog input permanently (V).
    pub fn set_analog(&mut self, place: usize, volts: f64) {
        if let Some(value) = self.analog.get_mut(place) {
            *value = volts;
        }
    }

    /// Adds `by` counts to an encoder at once, as after a slip.
    pub fn jump_encoder(&mut self, place: usize, by: i64) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.jump(by);
        }
    }

    /// Adds `by` counts to an encoder without turning it: surplus or missing pulses.
    pub fn slip_encoder(&mut self, place: usize, by: i64) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.slip(by);
        }
    }

    /// Sets counts for index pulses and printed marks of an encoder in the next cycle, in which a scenario overrides
    /// the counts that the machine reads.
    pub fn replace_encoder_count(&mut self, place: usize, raw: i64) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.replace_count(raw);
        }
    }

    /// Sets such counts for a drive. Its switches still follow its axis.
    pub fn replace_drive_count(&mut self, place: usize, raw: i64) {
        if let Some(drive) = self.drive(place) {
            drive.replace_count(raw);
        }
    }

    /// Interrupts the power of an encoder: it counts from 0 again, and reports that.
    pub fn restart_encoder(&mut self, place: usize) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.restart();
        }
    }

    /// Inverts bits of the next `words` readings of an encoder.
    pub fn disturb_encoder(&mut self, place: usize, bits: i64, words: u32) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.disturb(bits, words);
        }
    }

    /// Sets the factor of the counts of an encoder: 0 for a dead one, -1 for swapped tracks.
    pub fn count_encoder_by(&mut self, place: usize, factor: i64) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.count_by(factor);
        }
    }

    /// Cuts the line of an encoder permanently.
    pub fn cut_encoder(&mut self, place: usize) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.cut();
        }
    }

    /// Stops the pulses of the index of an encoder.
    pub fn lose_encoder_index(&mut self, place: usize) {
        if let Some(encoder) = self.encoders.get_mut(place) {
            encoder.lose_index();
        }
    }

    /// Adds a latch to the next inputs. Returns false if there is no room, or the bus of the object is off.
    pub fn add_latch(&mut self, latch: Latch) -> bool {
        let room = self.latches.len() < MAX_LATCHES && !self.is_bus_off(latch.object);
        if room {
            self.latches.push(latch);
        }
        room
    }
}

impl Plant {
    /// Updates the inputs of contacts of drives: a shared input is closed while all of its contacts are.
    fn update_contacts(&mut self) {
        for &(input, _) in &self.contacts {
            set_bit(&mut self.digital, input, true);
        }
        for &(input, drive) in &self.contacts {
            let drive = self.drives.get(drive).and_then(Option::as_ref);
            if !drive.is_some_and(SimDrive::is_ready) {
                set_bit(&mut self.digital, input, false);
            }
        }
    }

    /// Updates the inputs of wired switches, and their latches.
    fn update_wired_switches(&mut self, inputs: &mut Inputs) {
        for place in 0..self.wires.len() {
            let (drive, wire) = self.wires[place];
            let drive = self.drives.get(drive).and_then(Option::as_ref);
            let actuated = drive.map_or(0, SimDrive::actuated);
            set_bit(&mut self.digital, wire.input, wire.level(actuated));
            let (Some(drive), Some(Some(entry))) = (drive, self.latching.get(wire.input)) else { continue };
            let object = Object::Io(*entry);
            for (age, is_on) in drive.switched(wire.switch).into_iter().flatten() {
                let edge = if is_on != wire.normally_closed { Edge::Rising } else { Edge::Falling };
                if !self.is_bus_off(object) {
                    inputs.add_latch(Latch { object, edge, age_ns: Some(age), position: None });
                }
            }
        }
    }
}

impl Backend for Plant {
    fn capabilities(&self, drive: usize) -> Option<Capabilities> {
        self.drives.get(drive)?.as_ref().map(SimDrive::capabilities)
    }

    fn read(&mut self, inputs: &mut Inputs) {
        for bus in &self.buses {
            for &BackendObject { place, .. } in &bus.objects.drives {
                let Some(drive) = self.drives.get_mut(place).and_then(Option::as_mut) else { continue };
                let (told, Some(input)) = (drive.read(), inputs.drive.get_mut(place)) else { continue };
                // A drive with voltage interface reports only through its encoder and its contact.
                if drive.analog().is_some() {
                    continue;
                }
                if bus.is_off {
                    input.bus = BusState::Off;
                } else {
                    *input = told;
                }
            }
        }
        self.update_contacts();
        self.update_wired_switches(inputs);
        for bus in &self.buses {
            for &BackendObject { place, .. } in &bus.objects.encoders {
                let (Some(encoder), Some(input)) = (self.encoders.get_mut(place), inputs.encoder.get_mut(place)) else {
                    continue;
                };
                let drive = encoder.drive().and_then(|place| self.drives.get(place)).and_then(Option::as_ref);
                if let Some(drive) = drive {
                    encoder.turn_to(drive.encoder_position());
                }
                let told = encoder.read();
                if !bus.is_off {
                    *input = told;
                }
            }
        }
        self.report_marks(inputs);
        for bus in self.buses.iter().filter(|bus| !bus.is_off) {
            for terminal in &bus.objects.digital_inputs {
                inputs.set_digital(terminal.place, bit(&self.digital, terminal.place));
            }
            for terminal in &bus.objects.analog_inputs {
                if let (Some(input), Some(volts)) =
                    (inputs.analog.get_mut(terminal.place), self.analog.get(terminal.place))
                {
                    *input = *volts;
                }
            }
        }
        for latch in self.latches.drain(..) {
            inputs.add_latch(latch);
        }
    }

    fn write(&mut self, outputs: &Outputs) {
        let Self { drives, buses, arriving, .. } = self;
        let outputs = if buses.iter().any(|bus| bus.is_off) {
            arriving.copy_from(outputs);
            for bus in buses.iter().filter(|bus| bus.is_off) {
                bus.objects.digital_outputs.iter().for_each(|terminal| arriving.set_digital(terminal.place, false));
                bus.objects.analog_outputs.iter().for_each(|terminal| arriving.set_analog(terminal.place, 0.0));
                for terminal in &bus.objects.drives {
                    arriving.drive[terminal.place] = Default::default();
                }
            }
            &*arriving
        } else {
            outputs
        };
        for (output, drive) in outputs.drive.iter().zip(drives) {
            if let Some(drive) = drive {
                let output = drive.wired_to(*output, outputs);
                drive.write(output);
            }
        }
    }
}

#[cfg(test)]
mod tests;

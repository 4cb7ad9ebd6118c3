//! Signals of all objects except axes, and latches.

use super::Machine;
use crate::axis::Axis;
use crate::code::Code;
use crate::config::{IoKind, MachineConfig, MemoryKind, SlotConfig};
use crate::drive::{AnalogWiring, EncoderInput, Inputs, MAX_LATCHES, Outputs, SpeedOutputs, Switching};
use crate::encoder::Lead;
use crate::event::{Event, Kind, Number, Severity};
use crate::function::{LINES, Quantity};
use crate::object::{Leader, Object};
use crate::position::Position;
use crate::signal::axis::AxisSignal;
use crate::signal::gantry::GantrySignal;
use crate::signal::{Board, Directory, Entry, Measure, Signal, Type};
use crate::sync::{Leads, VirtualMaster};
use crate::vocabulary::{self, LatchView};

/// Names of `machine.state`, by number.
const MACHINE_STATES: &[&str] = &["INACTIVE", "ACTIVE", "ERROR"];
const INACTIVE: i64 = 0;
const ACTIVE: i64 = 1;
const ERROR: i64 = 2;

/// Signals of the objects on the board.
#[derive(Debug)]
pub(super) struct Signals {
    /// Signal, kind, and index among the entries of its kind.
    io: Vec<(Signal, IoKind, usize)>,
    /// Digital inputs by their indices, with the signals of the outputs that they read.
    virtual_inputs: Vec<(usize, Signal)>,
    memory: Vec<(Signal, MemoryKind)>,
    /// First signal of: count, position, velocity, error, errors.
    encoders: Vec<Signal>,
    /// First signal of: position, velocity, valid, fraction.
    masters: Vec<Signal>,
    /// First signal of each slot.
    pub slots: Vec<Signal>,
    /// First signal of [`AxisSignal`] of each axis.
    pub axes: Vec<Signal>,
    /// First signal of [`GantrySignal`] of each axis with two drives.
    pub gantries: Vec<Signal>,
    /// First signal of: state, error, overruns; of the virtual master: position, velocity, count and position of its
    /// index, fraction.
    machine: Signal,
}

impl Signals {
    pub(super) fn new(directory: &mut Directory, config: &MachineConfig) -> Self {
        let io = config.io.iter().enumerate().map(|(index, entry)| {
            let (kind, measure, drivable, help) = match entry.kind {
                IoKind::DigitalInput if config.is_virtual_input(config.io_place(index)) => {
                    (Type::Bit, Measure::None, false, "digital input that reads an output of the cycle before")
                }
                IoKind::DigitalInput => (Type::Bit, Measure::None, true, "digital input"),
                IoKind::DigitalOutput => (Type::Bit, Measure::None, false, "digital output"),
                IoKind::AnalogInput => (Type::Real, Measure::Voltage, true, "analog input"),
                IoKind::AnalogOutput => (Type::Real, Measure::Voltage, false, "analog output"),
            };
            let name = entry.name.clone();
            let signal = directory.add(Entry { name, kind, measure, drivable, help });
            (signal, entry.kind, config.io_place(index))
        });
        let io: Vec<_> = io.collect();
        let read = config.global.virtual_inputs.iter();
        let virtual_inputs = read.filter_map(|read| Some((read.input, io.get(usize::from(read.output))?.0))).collect();
        let memory = config.memory.iter().map(|entry| {
            let kind = match entry.kind {
                MemoryKind::F64 => Type::Real,
                MemoryKind::Bit => Type::Bit,
                _ => Type::Int,
            };
            let name = entry.name.clone();
            let entry_of = Entry { name, kind, measure: Measure::None, drivable: true, help: "memory cell" };
            (directory.add(entry_of), entry.kind)
        });
        let memory = memory.collect();
        let encoders = config.encoders.iter().map(|entry| add_encoder(directory, &entry.name)).collect();
        let masters = config.masters.iter().map(|master| add_master(directory, &master.name)).collect();
        let slots = config.slots.iter().map(|slot| add_slot(directory, slot)).collect();
        let (mut axes, mut gantries) = (Vec::new(), Vec::new());
        for axis in &config.axes {
            axes.push(add_axis(directory, &axis.name));
            if axis.second.is_some() {
                gantries.push(GantrySignal::add_all(directory, &axis.name));
            }
        }
        Self { io, virtual_inputs, memory, encoders, masters, slots, axes, gantries, machine: add_machine(directory) }
    }

    /// Returns the inputs that read an output, with the levels of that output after the last cycle.
    pub(super) fn virtual_inputs(&self, board: &Board) -> impl ExactSizeIterator<Item = (usize, bool)> {
        self.virtual_inputs.iter().map(|&(place, output)| (place, board.int(output) != 0))
    }

    pub(super) fn set_memory_initials(&self, board: &mut Board, config: &MachineConfig) {
        for (index, entry) in config.memory.iter().enumerate() {
            self.set_memory(board, index as u16, entry.initial);
        }
    }

    /// Sets a memory cell. Scenarios, recordings and ROS 2 refuse a value that exceeds its range earlier; the casts
    /// saturate in addition.
    pub(super) fn set_memory(&self, board: &mut Board, index: u16, value: f64) {
        let Some(&(signal, kind)) = self.memory.get(usize::from(index)) else { return };
        match kind {
            MemoryKind::F64 => board.set_real(signal, value),
            MemoryKind::Bit => board.set_int(signal, i64::from(value != 0.0)),
            MemoryKind::I16 => board.set_int(signal, i64::from(value as i16)),
            MemoryKind::I32 => board.set_int(signal, i64::from(value as i32)),
            MemoryKind::I64 => board.set_int(signal, value as i64),
        }
    }

    pub(super) fn publish_io(&self, board: &mut Board, inputs: &Inputs) {
        for &(signal, kind, place) in &self.io {
            match kind {
                IoKind::DigitalInput => board.set_int(signal, i64::from(inputs.digital(place))),
                IoKind::AnalogInput => board.set_real(signal, inputs.analog.get(place).copied().unwrap_or(0.0)),
                IoKind::DigitalOutput | IoKind::AnalogOutput => {}
            }
        }
    }

    /// Publishes the outputs.
    pub(super) fn publish_outputs(&self, board: &mut Board, outputs: &Outputs) {
        for &(signal, kind, place) in &self.io {
            match kind {
                IoKind::DigitalOutput => board.set_int(signal, i64::from(outputs.digital(place))),
                IoKind::AnalogOutput => board.set_real(signal, outputs.analog.get(place).copied().unwrap_or(0.0)),
                IoKind::DigitalInput | IoKind::AnalogInput => {}
            }
        }
    }

    /// Sets the brake output of an axis and publishes its brake; `closed` is the state of the brake of O_BRAKE.
    pub(super) fn publish_brake(&self, board: &mut Board, axis: &Axis, closed: Option<bool>, outputs: &mut Outputs) {
        if let Some((entry, on)) = axis.brake_output()
            && let Some(&(signal, IoKind::DigitalOutput, place)) = self.io.get(usize::from(entry))
        {
            outputs.set_digital(place, on);
            board.set_int(signal, i64::from(on));
        } else if let Object::Axis(index) = axis.object()
            && let (Some(closed), Some(&first)) = (closed, self.axes.get(usize::from(index)))
        {
            board.set_int(AxisSignal::Brake.of(first), i64::from(closed));
        }
    }

    /// Sets and publishes the outputs that an axis switches.
    pub(super) fn publish_switching(
        &self,
        board: &mut Board,
        wiring: SpeedOutputs,
        switching: Switching,
        outputs: &mut Outputs,
    ) {
        let bits = [
            (wiring.forward, switching.forward),
            (wiring.backward, switching.backward),
            (wiring.output, switching.output),
        ];
        let entry = |index: Option<u16>| self.io.get(usize::from(index?));
        for (index, on) in bits {
            if let Some(&(signal, IoKind::DigitalOutput, place)) = entry(index) {
                outputs.set_digital(place, on);
                board.set_int(signal, i64::from(on));
            }
        }
        if let Some(&(signal, IoKind::AnalogOutput, place)) = entry(wiring.dac) {
            outputs.set_analog(place, switching.dac);
            board.set_real(signal, switching.dac);
        }
    }

    /// Sets the reference (V) and the enable of a drive without a bus.
    pub(super) fn publish_reference(
        &self,
        board: &mut Board,
        wiring: &AnalogWiring,
        (volts, enable): (f64, bool),
        outputs: &mut Outputs,
    ) {
        if let Some(&(signal, _, place)) = self.io.get(usize::from(wiring.reference)) {
            outputs.set_analog(place, volts);
            board.set_real(signal, volts);
        }
        if let Some(&(signal, _, place)) = self.io.get(usize::from(wiring.enable)) {
            outputs.set_digital(place, enable);
            board.set_int(signal, i64::from(enable));
        }
    }

    pub(super) fn publish_encoder(
        &self,
        board: &mut Board,
        index: usize,
        input: EncoderInput,
        lead: Lead,
        problem: Code,
        errors: u64,
    ) {
        let Some(&first) = self.encoders.get(index) else { return };
        board.set_int(first, input.count);
        board.set_int(first.plus(1), lead.position.floor());
        board.set_real(first.plus(2), lead.velocity);
        // An error that starts in this cycle; the error remains as long as there is no valid value.
        let error = match problem {
            Code::WF_PULSES => problem,
            _ if lead.valid => Code::NONE,
            _ => Code::ENCODER_INVALID,
        };
        board.set_int(first.plus(3), i64::from(error.0));
        board.set_int(first.plus(4), errors.min(i64::MAX as u64).cast_signed());
    }

    /// Publishes the sums of masters, after all masters have moved in this cycle.
    pub(super) fn publish_masters(&self, board: &mut Board, leads: &Leads) {
        for (place, &first) in (0..).zip(&self.masters) {
            let lead = leads.get(Leader::Sum(place));
            board.set_int(first, lead.position.floor());
            board.set_real(first.plus(1), lead.velocity);
            board.set_int(first.plus(2), i64::from(lead.valid));
            board.set_real(first.plus(3), lead.position.fraction());
        }
    }

    pub(super) fn publish_machine(&self, board: &mut Board, error: Code, active: bool, overruns: u64) {
        board.set_int(
            self.machine,
            if !error.is_none() {
                ERROR
            } else if active {
                ACTIVE
            } else {
                INACTIVE
            },
        );
        board.set_int(self.machine.plus(1), i64::from(error.0));
        board.set_int(self.machine.plus(2), overruns.cast_signed());
    }

    pub(super) fn publish_virtual_master(&self, board: &mut Board, lead: &Lead, master: &VirtualMaster) {
        board.set_int(self.machine.plus(3), lead.position.floor());
        // Adding 0.0 turns -0.0 into 0.0.
        board.set_real(self.machine.plus(4), lead.velocity + 0.0);
        board.set_int(self.machine.plus(5), master.count);
        board.set_int(self.machine.plus(6), master.mark.floor());
        board.set_real(self.machine.plus(7), lead.position.fraction());
    }
}

fn add_encoder(directory: &mut Directory, name: &str) -> Signal {
    let mut add = |text: &str, kind, measure, drivable, help| {
        directory.add(Entry { name: format!("{name}.{text}"), kind, measure, drivable, help })
    };
    let first = add("count", Type::Int, Measure::Position, true, "raw counts");
    add("position", Type::Int, Measure::Position, false, "position, without wrap");
    add("velocity", Type::Real, Measure::Velocity, false, "velocity over the last cycle");
    add("error", Type::Int, Measure::None, false, "code of what is wrong with it, 0 for nothing");
    add("errors", Type::Int, Measure::None, false, "bad words of an absolute encoder so far");
    first
}

fn add_master(directory: &mut Directory, name: &str) -> Signal {
    let mut add = |text: &str, kind, measure, help| {
        directory.add(Entry { name: format!("{name}.{text}"), kind, measure, drivable: false, help })
    };
    let first = add("position", Type::Int, Measure::Position, "sum of its members");
    add("velocity", Type::Real, Measure::Velocity, "sum of the velocities of its members");
    add("valid", Type::Bit, Measure::None, "no member is lost");
    add("fraction", Type::Real, Measure::None, "fraction of its position, 0 to 1");
    first
}

/// Adds the signal block of a slot, in the order in which it is published.
fn add_slot(directory: &mut Directory, slot: &SlotConfig) -> Signal {
    let row = slot.kind.description();
    let mut add = |text: &str, kind, measure, help| {
        let name = format!("{}.{text}", slot.name);
        directory.add(Entry { name, kind, measure, drivable: false, help })
    };
    let carried = if slot.quantity == Quantity::Speed { Measure::None } else { Measure::Position };
    let first = add("sink", Type::Int, carried, "what the function gives its sink");
    add("active", Type::Bit, Measure::None, "the function is started");
    add("error", Type::Int, Measure::None, "why its last command was refused, 0 for nothing");
    for line in 1..=LINES {
        let help = "binary input of the function, after inversion";
        add(&format!("in{line}"), Type::Bit, Measure::None, help);
    }
    for line in 1..=LINES {
        let help = "binary output of the function, before inversion";
        add(&format!("out{line}"), Type::Bit, Measure::None, help);
    }
    for shown in row.shows {
        add(shown.name, shown.kind, shown.measure, shown.help);
    }
    first
}

/// Adds the signal block of an axis and, directly after it, those of the vocabularies: [`Axis::publish`] relies on the
/// order.
fn add_axis(directory: &mut Directory, name: &str) -> Signal {
    let first = AxisSignal::add_all(directory, name);
    vocabulary::add_signals(directory, name);
    first
}

fn add_machine(directory: &mut Directory) -> Signal {
    let mut add = |text: &str, kind, measure, help| {
        let name = format!("machine.{text}");
        directory.add(Entry { name, kind, measure, drivable: false, help })
    };
    let first = add("state", Type::Enum(MACHINE_STATES), Measure::None, "state of the machine");
    add("error", Type::Int, Measure::None, "code of the first axis error, 0 for none");
    add("overruns", Type::Int, Measure::None, "cycles missed so far");
    add("vmaster.position", Type::Int, Measure::Position, "position of the virtual master");
    add("vmaster.velocity", Type::Real, Measure::Velocity, "velocity of the virtual master");
    add("vmaster.index.count", Type::Int, Measure::None, "marks of the virtual master so far, as vmencmtyp has them");
    add("vmaster.index.position", Type::Int, Measure::Position, "where its last mark was");
    add("vmaster.fraction", Type::Real, Measure::None, "fraction of its position, 0 to 1");
    first
}

impl MachineConfig {
    /// Returns names and types of the signals of a machine with this configuration.
    pub fn directory(&self) -> Directory {
        let mut directory = Directory::default();
        Signals::new(&mut directory, self);
        directory
    }
}

impl Machine {
    /// Reports the latches of this cycle, with the latched position.
    pub(super) fn report_latches(&mut self, inputs: &Inputs) {
        if inputs.latches_lost > 0 {
            let event = Event::new(Severity::Warn, Kind::Warning, Object::Machine, Code::LATCHES_LOST);
            self.events.push(event.with(Number::Count(inputs.latches_lost.into()), Number::None));
        }
        self.latched.clear();
        for latch in &inputs.latch {
            let lead = match latch.object {
                Object::Encoder(index) => self.state.leads.find(Leader::Encoder(index)),
                Object::Axis(index) => self.state.leads.find(Leader::AxisActual(index)),
                _ => None,
            };
            let raw = latch.position.map(|count| self.locate(latch.object, count));
            let (position, age_ns) = locate(raw, latch.age_ns, lead, self.config.cycle_ns);
            // The inputs hold no more latches than the buffer can store.
            if self.latched.len() < MAX_LATCHES {
                let rising = latch.edge == crate::drive::Edge::Rising;
                let captured = raw.map(Position::whole);
                self.latched.push(LatchView { object: latch.object, rising, age_ns, captured, position });
            }
            let event = Event::new(Severity::Info, Kind::Latch, latch.object, Code::NONE);
            let edge = Number::Count(i64::from(latch.edge == crate::drive::Edge::Rising));
            self.events.push(Event { age_ns, position, ..event.with(edge, Number::None) });
            if let Object::Axis(index) = latch.object
                && let Some(axis) = self.state.axes.get(usize::from(index))
            {
                axis.publish_latch(&mut self.state.board, position);
            }
        }
    }

    /// Returns latched raw counts as a position.
    fn locate(&self, object: Object, count: i64) -> i64 {
        let position = match object {
            Object::Encoder(index) => self.state.encoders.get(usize::from(index)).map(|encoder| encoder.locate(count)),
            Object::Axis(index) => {
                self.state.axes.get(usize::from(index)).map(|axis| axis.locate(count, &self.state.encoders))
            }
            _ => None,
        };
        position.unwrap_or(count)
    }
}

/// Returns position and age of a latch. A missing value is interpolated linearly over the change of this cycle.
pub(super) fn locate(position: Option<i64>, age_ns: Option<u32>, lead: Option<Lead>, cycle_ns: u64) -> (Position, u32) {
    let lead = lead.unwrap_or_default();
    let cycle = cycle_ns as f64;
    match (position, age_ns) {
        (Some(position), Some(age)) => (Position::whole(position), age),
        (None, age) => {
            let age = age.unwrap_or(0);
            let back = lead.change.to_f64() * (f64::from(age) / cycle);
            (lead.position - Position::from_f64(back), age)
        }
        (Some(position), None) => {
            let position = Position::whole(position);
            let change = lead.change.to_f64();
            let share = if change == 0.0 { 0.0 } else { (lead.position - position).to_f64() / change };
            // The cast saturates; an age is less than a cycle.
            (position, ((share.clamp(0.0, 1.0) * cycle) as u32).min(cycle_ns.saturating_sub(1) as u32))
        }
    }
}

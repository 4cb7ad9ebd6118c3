//! Function slots and tables of a machine: the connections of each slot, by indices in the sections.
//!
//! Law      slots are in ascending order of their numbers; the core uses indices in that list
//! Refuses  connections that a type does not have, indices that do not exist, two writers of one object, values outside
//!          their fields
//! Source   contract section 10

use super::{ConfigError, IoKind, MAX_MASTERS, MachineConfig, MemoryKind};
use crate::function::{
    self, Bit, Description, Input, Kind, LINES, Mark, MarkSource, MemorySize, OnAxisError, Output, OutputCell,
    Requirement, Sink, Source, WORDS, Width, Wires, Word,
};
use crate::modulo::Modulo;
use crate::object::{Leader, Object, VIRTUAL_MASTER};
use crate::signal::{Directory, Measure, Signal};
use crate::table::Table;
use crate::unit::{Dimension, Quantity, Scale};
use lineshaft_program::Module;
use std::sync::Arc;

/// Maximum slots of one machine.
pub const MAX_SLOTS: usize = 256;
/// Maximum cycles of the machine between two calls of a slot.
pub const MAX_FACTOR: u32 = 255;
/// Maximum values of a sliding mean.
pub const MAX_WINDOW: usize = 30_000;

/// An entry of `tables`.
#[derive(Clone, Debug, PartialEq)]
pub struct TableConfig {
    /// Name.
    pub name: String,
    /// Initial numbers.
    pub table: Arc<Table>,
}

/// An entry of `programs`.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramConfig {
    /// Name.
    pub name: String,
    /// Initial module.
    pub module: Arc<Module>,
}

/// Default of the instructions per call.
pub const FUEL: u32 = 50_000;
/// Maximum instructions per call.
pub const MAX_FUEL: u32 = 10_000_000;

/// Source of a slot.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SourceConfig {
    /// No source.
    #[default]
    None,
    /// A position or a sink.
    Lead(Leader),
    /// Any other signal, by its name.
    Signal(String),
}

/// Sink of a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SinkConfig {
    /// Only the signal of the sink.
    #[default]
    None,
    /// The command of an axis.
    Axis(u16),
    /// A memory cell.
    Memory(u16),
    /// An analog output, by its index in section `io`.
    Output(u16),
}

/// A binary input or output: an entry of `io` or a bit of `memory`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// The object.
    pub object: Object,
    /// Whether its level is inverted.
    pub inverted: bool,
}

/// An entry of `functions`.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotConfig {
    /// Name.
    pub name: String,
    /// Number: lower numbers come first in a cycle.
    pub number: u16,
    /// Function type.
    pub kind: Kind,
    /// The source.
    pub source: SourceConfig,
    /// Width of the source.
    pub source_width: Width,
    /// The sink.
    pub sink: SinkConfig,
    /// Width of the sink.
    pub sink_width: Width,
    /// E1 to E8.
    pub inputs: [Option<Line>; LINES],
    /// A1 to A8.
    pub outputs: [Option<Line>; LINES],
    /// Indices in `tables`.
    pub tables: [Option<u16>; LINES],
    /// Signals of the words that it reads in addition to its source, in the order of the type.
    pub words: [Option<String>; WORDS],
    /// Index in `programs`; only for a type that runs programs.
    pub program: Option<u16>,
    /// Maximum instructions per call of the program.
    pub fuel: u32,
    /// Signals that the program reads.
    pub reads: Vec<String>,
    /// Memory cells that the program writes.
    pub writes: Vec<u16>,
    /// Quantity of the sink.
    pub quantity: function::Quantity,
    /// Cycles between two calls.
    pub factor: u32,
    /// Reaction to an error of the axis that it moves.
    pub on_axis_error: OnAxisError,
    /// Initial parameter set, value by value.
    pub values: Box<[i64]>,
    /// Memory for its mean and its cams.
    pub room: MemorySize,
}

impl SlotConfig {
    /// Creates a slot without connections, with the defaults of its type.
    pub fn new(name: String, number: u16, kind: Kind) -> Self {
        Self {
            name,
            number,
            kind,
            source: SourceConfig::None,
            source_width: Width::W64,
            sink: SinkConfig::None,
            sink_width: Width::W64,
            inputs: [None; LINES],
            outputs: [None; LINES],
            tables: [None; LINES],
            words: [const { None }; WORDS],
            program: None,
            fuel: FUEL,
            reads: Vec::new(),
            writes: Vec::new(),
            quantity: kind.description().quantity,
            factor: 1,
            on_axis_error: OnAxisError::Run,
            values: kind.description().defaults(),
            room: MemorySize::default(),
        }
    }

    /// Returns the time between two calls (ns).
    pub fn call_ns(&self, cycle_ns: u64) -> u64 {
        cycle_ns.saturating_mul(u64::from(self.factor.max(1)))
    }
}

/// Error of a slot.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SlotProblem {
    /// Invalid number.
    #[error("slot {0} stands behind a slot of the same or a higher number, or is above 255")]
    Number(u16),
    /// A source that is missing or not allowed.
    #[error("type {0} has {source} source", source = if *.1 { "a" } else { "no" })]
    Source(&'static str, bool),
    /// A sink that is missing or not allowed.
    #[error("type {0} has {sink} sink", sink = if *.1 { "a" } else { "no" })]
    Sink(&'static str, bool),
    /// An object that does not exist, or that it cannot use.
    #[error("{0} is nothing that it can use")]
    Place(&'static str),
    /// An object that has another writer.
    #[error("{0} is written by something else, too")]
    Twice(&'static str),
    /// A value of its parameter set.
    #[error("{0} is {1}; {2} to {3} is allowed")]
    Value(&'static str, i64, i64, i64),
    /// A speed as sink of a linear axis, which has no revolutions.
    #[error("its sink carries a speed in rpm, and {0} is no rotary axis")]
    Linear(String),
    /// Cycles between two calls out of range.
    #[error("cycle_factor is {0}; 1 to {MAX_FACTOR} is allowed")]
    Factor(u32),
}

impl MachineConfig {
    /// Checks the slots.
    pub(super) fn check_slots(&self) -> Result<(), ConfigError> {
        let mut last = None;
        for (place, slot) in self.slots.iter().enumerate() {
            let refuse = |problem| ConfigError::Slot { slot: slot.name.clone(), problem };
            if last.is_some_and(|last| slot.number <= last) || usize::from(slot.number) >= MAX_SLOTS {
                return Err(refuse(SlotProblem::Number(slot.number)));
            }
            last = Some(slot.number);
            self.check_slot(place, slot).map_err(refuse)?;
        }
        Ok(())
    }

    fn check_slot(&self, place: usize, slot: &SlotConfig) -> Result<(), SlotProblem> {
        let row = slot.kind.description();
        let is_wrong =
            |need: Requirement, has: bool| need == Requirement::Must && !has || need == Requirement::Never && has;
        let has_source = slot.source != SourceConfig::None;
        if is_wrong(row.source, has_source) {
            return Err(SlotProblem::Source(row.name, !has_source));
        }
        let has_sink = slot.sink != SinkConfig::None;
        if row.sink == Requirement::Never && has_sink {
            return Err(SlotProblem::Sink(row.name, !has_sink));
        }
        if !(1..=MAX_FACTOR).contains(&slot.factor) {
            return Err(SlotProblem::Factor(slot.factor));
        }
        self.check_source(slot, row)?;
        self.check_sink(slot, row)?;
        let bit = |object: Object, kind| match object {
            Object::Io(place) => self.io.get(usize::from(place)).is_some_and(|io| io.kind == kind),
            Object::Memory(place) => {
                self.memory.get(usize::from(place)).is_some_and(|memory| memory.kind == MemoryKind::Bit)
            }
            _ => false,
        };
        let lines = |lines: &[Option<Line>; LINES], most: usize, kind| {
            lines.iter().enumerate().all(|(nth, line)| line.is_none_or(|line| nth < most && bit(line.object, kind)))
        };
        if !lines(&slot.inputs, row.inputs, IoKind::DigitalInput) {
            return Err(SlotProblem::Place("inputs"));
        }
        if !lines(&slot.outputs, row.outputs, IoKind::DigitalOutput) {
            return Err(SlotProblem::Place("outputs"));
        }
        let is_table = |(nth, table): (usize, &Option<u16>)| {
            table.is_none_or(|table| nth < row.tables && usize::from(table) < self.tables.len())
        };
        if !slot.tables.iter().enumerate().all(is_table) {
            return Err(SlotProblem::Place("tables"));
        }
        if slot.words.iter().skip(row.words.len()).any(Option::is_some) {
            return Err(SlotProblem::Place("word"));
        }
        self.check_program(slot)?;
        for (nth, object) in slot.writes().enumerate() {
            let earlier = self.slots.iter().take(place).flat_map(SlotConfig::writes);
            let is_axis_output = matches!(object, Object::Io(entry) if self.owner_of_output(entry).is_some());
            if is_axis_output || earlier.chain(slot.writes().take(nth)).any(|other| other == object) {
                return Err(SlotProblem::Twice(if matches!(object, Object::Axis(_)) { "sink" } else { "an output" }));
            }
        }
        for (place, value) in slot.values.iter().enumerate() {
            if let Some((_, field, _)) = row.field_of(place)
                && !(field.min..=field.max).contains(value)
                && *value != field.default
            {
                return Err(SlotProblem::Value(field.name, *value, field.min, field.max));
            }
        }
        if slot.values.len() != row.width() || slot.room.mean > MAX_WINDOW {
            return Err(SlotProblem::Place("its set"));
        }
        Ok(())
    }

    fn check_program(&self, slot: &SlotConfig) -> Result<(), SlotProblem> {
        let row = slot.kind.description();
        if !row.chooses_quantity && slot.quantity != row.quantity {
            return Err(SlotProblem::Place("quantity"));
        }
        let has_program = slot.program.is_some_and(|place| usize::from(place) < self.programs.len());
        if !row.runs_program {
            let has_none = slot.program.is_none() && slot.reads.is_empty() && slot.writes.is_empty();
            return if has_none { Ok(()) } else { Err(SlotProblem::Place("program")) };
        }
        if !has_program || !(1..=MAX_FUEL).contains(&slot.fuel) {
            return Err(SlotProblem::Place(if has_program { "fuel" } else { "program" }));
        }
        if slot.reads.len() > lineshaft_program::WORDS {
            return Err(SlotProblem::Place("reads"));
        }
        let exists = |place: &u16| usize::from(*place) < self.memory.len();
        if slot.writes.len() > lineshaft_program::WORDS || !slot.writes.iter().all(exists) {
            return Err(SlotProblem::Place("writes"));
        }
        Ok(())
    }

    fn check_source(&self, slot: &SlotConfig, row: &Description) -> Result<(), SlotProblem> {
        let exists = match &slot.source {
            SourceConfig::None | SourceConfig::Signal(_) | SourceConfig::Lead(Leader::Virtual) => true,
            SourceConfig::Lead(Leader::AxisCommand(axis) | Leader::AxisActual(axis)) => {
                usize::from(*axis) < self.axes.len()
            }
            SourceConfig::Lead(Leader::Encoder(place)) => usize::from(*place) < self.encoders.len(),
            SourceConfig::Lead(Leader::Sink(place)) => usize::from(*place) < self.slots.len(),
            SourceConfig::Lead(Leader::Sum(place)) => usize::from(*place) < self.masters.len(),
            SourceConfig::Lead(Leader::Simulated(_)) => false,
        };
        let fits = !row.measures_encoder || matches!(slot.source, SourceConfig::Lead(Leader::Encoder(_)));
        if exists && fits { Ok(()) } else { Err(SlotProblem::Place("source")) }
    }

    fn check_sink(&self, slot: &SlotConfig, row: &Description) -> Result<(), SlotProblem> {
        let fits = match slot.sink {
            SinkConfig::None => true,
            SinkConfig::Axis(axis) => {
                let axis = self.axes.get(usize::from(axis)).filter(|_| row.moves_axes);
                if let Some(axis) = axis
                    && slot.quantity == function::Quantity::Speed
                    && self.rpm(axis.scale).is_none()
                {
                    return Err(SlotProblem::Linear(axis.name.clone()));
                }
                axis.is_some_and(|axis| axis.interface != crate::drive::Interface::OpenLoop)
            }
            SinkConfig::Memory(place) => {
                self.memory.get(usize::from(place)).is_some_and(|memory| memory.kind != MemoryKind::Bit)
            }
            SinkConfig::Output(place) => {
                self.io.get(usize::from(place)).is_some_and(|io| io.kind == IoKind::AnalogOutput)
            }
        };
        if fits { Ok(()) } else { Err(SlotProblem::Place("sink")) }
    }

    /// Returns one revolution per minute of an axis (inc/s); `None` for a linear axis.
    fn rpm(&self, scale: Scale) -> Option<f64> {
        scale.rate(&Quantity::parse("1 rpm", &[Dimension::Angle(1)]).ok()?, 1).ok()
    }

    /// Returns the quantity of a source; `None` for a signal, whose values may have any meaning.
    pub fn carried(&self, source: &SourceConfig) -> Option<function::Quantity> {
        match source {
            SourceConfig::None | SourceConfig::Signal(_) => None,
            SourceConfig::Lead(Leader::Sink(place)) => self.slots.get(usize::from(*place)).map(|slot| slot.quantity),
            SourceConfig::Lead(_) => Some(function::Quantity::Position),
        }
    }

    /// Returns the slot that writes an object.
    pub fn writer(&self, object: Object) -> Option<u16> {
        self.slots.iter().position(|slot| slot.writes().any(|written| written == object)).map(|place| place as u16)
    }

    /// Returns the connections of each slot; `first` are the first signals of the slots.
    pub(crate) fn wires(&self, directory: &Directory, first: &[Signal]) -> Result<Vec<Wires>, ConfigError> {
        let wire = |(slot, &first): (&SlotConfig, &Signal)| {
            let problem = |problem| ConfigError::Slot { slot: slot.name.clone(), problem };
            self.wire(slot, first, directory).map_err(problem)
        };
        self.slots.iter().zip(first).map(wire).collect()
    }

    fn wire(&self, slot: &SlotConfig, first: Signal, directory: &Directory) -> Result<Wires, SlotProblem> {
        let word = |name: &str| {
            let signal = directory.find(name)?;
            let entry = directory.entry(signal);
            Some(Word::of(signal, entry.kind, entry.measure == Measure::Voltage))
        };
        let of_object = |object, key| directory.find(self.name(object)).ok_or(SlotProblem::Place(key));
        let source = match &slot.source {
            SourceConfig::None => Source::None,
            SourceConfig::Lead(leader) => {
                let name = self.signal_of(*leader);
                Source::Lead(*leader, name.and_then(|name| word(&name)).ok_or(SlotProblem::Place("source"))?)
            }
            SourceConfig::Signal(name) => Source::Signal(word(name).ok_or(SlotProblem::Place("source"))?),
        };
        let (mut speed, mut full_scale) = (None, 0);
        let sink = match slot.sink {
            SinkConfig::None => Sink::None,
            SinkConfig::Axis(axis) => {
                let config = self.axes.get(usize::from(axis)).ok_or(SlotProblem::Place("sink"))?;
                if slot.quantity == function::Quantity::Speed {
                    // Per 0.0001 rpm.
                    speed = self.rpm(config.scale).map(|rpm| rpm / 10_000.0);
                }
                let name = format!("{}.command.position", config.name);
                Sink::Axis(axis, directory.find(&name).ok_or(SlotProblem::Place("sink"))?)
            }
            SinkConfig::Memory(place) => match self.cell(place, directory).ok_or(SlotProblem::Place("sink"))? {
                OutputCell::Real(signal) => Sink::Real(signal),
                OutputCell::Int(signal, width) => Sink::Memory(signal, width),
                OutputCell::Bit(_) => return Err(SlotProblem::Place("sink")),
            },
            SinkConfig::Output(place) => {
                full_scale = (self.full_scale(place) * 1000.0).round() as i64;
                Sink::Analog(self.io_place(place.into()), of_object(Object::Io(place), "sink")?)
            }
        };
        let mut inputs = [None; LINES];
        for (to, line) in inputs.iter_mut().zip(slot.inputs) {
            if let Some(Line { object, inverted }) = line {
                *to = Some(Input { signal: of_object(object, "inputs")?, inverted });
            }
        }
        let mut outputs = [None; LINES];
        for (to, line) in outputs.iter_mut().zip(slot.outputs) {
            if let Some(Line { object, inverted }) = line {
                let bit = match object {
                    Object::Io(place) => Bit::Digital(self.io_place(place.into())),
                    _ => Bit::Memory(of_object(object, "outputs")?),
                };
                *to = Some(Output { to: bit, inverted });
            }
        }
        let mut words = [None; WORDS];
        for (to, name) in words.iter_mut().zip(&slot.words) {
            if let Some(name) = name {
                *to = Some(word(name).ok_or(SlotProblem::Place("word"))?);
            }
        }
        let reads: Option<Box<[Word]>> = slot.reads.iter().map(|name| word(name)).collect();
        let writes: Option<Box<[OutputCell]>> = slot.writes.iter().map(|place| self.cell(*place, directory)).collect();
        Ok(Wires {
            kind: slot.kind,
            first,
            source,
            source_width: slot.source_width,
            sink,
            sink_width: slot.sink_width,
            speed,
            full_scale,
            axes: self.axes.len(),
            lines: (wired(&inputs), wired(&outputs)),
            inputs,
            outputs,
            tables: slot.tables,
            shows: slot.kind.description().shows.len(),
            words,
            program: slot.program,
            fuel: slot.fuel,
            reads: reads.ok_or(SlotProblem::Place("reads"))?,
            writes: writes.ok_or(SlotProblem::Place("writes"))?,
            quantity: slot.quantity,
            mark: self.mark(slot),
            monitors: slot.kind.description().monitors,
            factor: slot.factor,
            call_ns: slot.call_ns(self.cycle_ns),
            on_axis_error: slot.on_axis_error,
        })
    }

    /// Returns a memory cell that a slot writes.
    fn cell(&self, place: u16, directory: &Directory) -> Option<OutputCell> {
        let kind = self.memory.get(usize::from(place))?.kind;
        let signal = directory.find(self.name(Object::Memory(place)))?;
        Some(match kind {
            MemoryKind::Bit => OutputCell::Bit(signal),
            MemoryKind::F64 => OutputCell::Real(signal),
            MemoryKind::I16 => OutputCell::Int(signal, Width::W16),
            MemoryKind::I32 => OutputCell::Int(signal, Width::W32),
            MemoryKind::I64 => OutputCell::Int(signal, Width::W64),
        })
    }

    /// Returns the source of the marks that a slot measures.
    fn mark(&self, slot: &SlotConfig) -> Mark {
        match (slot.kind.description().marks, slot.inputs[0]) {
            (MarkSource::None, _) => Mark::None,
            (MarkSource::SinkAxis, _) => match slot.sink {
                SinkConfig::Axis(place) if self.has_drive(place) => Mark::Axis(place),
                _ => Mark::None,
            },
            (MarkSource::Input, Some(Line { object: Object::Io(place), .. }))
                if self.io.get(usize::from(place)).is_some_and(|io| io.latch) =>
            {
                Mark::Latch(place)
            }
            (MarkSource::Input, Some(_)) => Mark::Edge,
            (MarkSource::Input, None) | (MarkSource::Encoder, _) => match slot.source {
                SourceConfig::Lead(Leader::Encoder(place)) => Mark::Encoder(place),
                _ => Mark::None,
            },
        }
    }

    fn has_drive(&self, axis: u16) -> bool {
        self.axes.get(usize::from(axis)).is_some_and(|axis| axis.drive.is_some())
    }

    /// Returns the scale of a leader; increments if it has none.
    pub fn scale_of(&self, leader: Leader) -> Scale {
        self.known_scale_of(leader).unwrap_or_else(Scale::increments)
    }

    /// Returns the turn of a leader.
    pub fn turn_of(&self, leader: Leader) -> Option<Modulo> {
        match leader {
            Leader::AxisCommand(axis) | Leader::AxisActual(axis) => self.axes.get(usize::from(axis))?.modulo,
            _ => None,
        }
    }

    /// Returns the scale of a leader, for a sum the common one of all members; `None` if it has none.
    pub fn known_scale_of(&self, leader: Leader) -> Option<Scale> {
        self.scale_within(leader, MAX_MASTERS)
    }

    /// Returns the scale, through at most `depth` sums.
    fn scale_within(&self, leader: Leader, depth: usize) -> Option<Scale> {
        match leader {
            Leader::AxisCommand(axis) | Leader::AxisActual(axis) | Leader::Simulated(axis) => {
                self.axes.get(usize::from(axis)).map(|axis| axis.scale)
            }
            Leader::Encoder(encoder) => self.encoders.get(usize::from(encoder)).map(|encoder| encoder.scale),
            Leader::Sum(place) => {
                let depth = depth.checked_sub(1)?;
                let mut scales =
                    self.masters.get(usize::from(place))?.members().map(|(of, _)| self.scale_within(of, depth));
                let first = scales.next()??;
                scales.all(|scale| scale == Some(first)).then_some(first)
            }
            Leader::Sink(_) | Leader::Virtual => None,
        }
    }

    /// Returns the signal of a leader.
    pub fn signal_of(&self, leader: Leader) -> Option<String> {
        let axis = |place: u16| self.axes.get(usize::from(place)).map(|axis| &axis.name);
        match leader {
            Leader::AxisCommand(place) => axis(place).map(|name| format!("{name}.command.position")),
            Leader::AxisActual(place) => axis(place).map(|name| format!("{name}.actual.position")),
            Leader::Encoder(place) => {
                self.encoders.get(usize::from(place)).map(|encoder| format!("{}.position", encoder.name))
            }
            Leader::Sink(place) => self.slots.get(usize::from(place)).map(|slot| format!("{}.sink", slot.name)),
            Leader::Sum(place) => {
                self.masters.get(usize::from(place)).map(|master| format!("{}.position", master.name))
            }
            Leader::Virtual => Some(format!("{VIRTUAL_MASTER}.position")),
            Leader::Simulated(_) => None,
        }
    }
}

/// Returns the number of lines up to the last one that is wired.
fn wired<T>(lines: &[Option<T>]) -> usize {
    lines.iter().rposition(Option::is_some).map_or(0, |last| last + 1)
}

impl SlotConfig {
    /// Returns the objects that it writes.
    fn writes(&self) -> impl Iterator<Item = Object> {
        let sink = match self.sink {
            SinkConfig::None => None,
            SinkConfig::Axis(place) => Some(Object::Axis(place)),
            SinkConfig::Memory(place) => Some(Object::Memory(place)),
            SinkConfig::Output(place) => Some(Object::Io(place)),
        };
        let cells = self.writes.iter().map(|place| Object::Memory(*place));
        sink.into_iter().chain(self.outputs.iter().flatten().map(|line| line.object)).chain(cells)
    }
}

//! Finds the objects that function slots read and write.
//!
//! Law      a slot reads the value of this cycle for inputs, outputs of lower slots, encoders, the actual position of a
//!          drive (as source), lower slots, and memory that a lower slot or none writes. It reads the value of the last
//!          cycle for other signals of axes, the machine, itself, higher slots, and everything that these write
//! Source   contract section 1 and 10

use lineshaft_core::config::{IoKind, Line, MachineConfig, SinkConfig, SlotConfig, SourceConfig};
use lineshaft_core::function::Monitored;
use lineshaft_core::object::{Leader, Object};

/// End of a link at a slot: `source`, `E1`, `sink`, `A1`..
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Port {
    /// Label of the end.
    pub label: String,
    /// Name of the linked object in the cell.
    pub name: String,
    /// Object at the other end.
    pub object: Object,
    /// Whether the object is written.
    pub is_output: bool,
    /// Whether the value of the last cycle is read.
    pub is_late: bool,
    /// Whether the value only affects outputs, not the sink.
    pub is_watched: bool,
}

/// Returns all objects that a slot reads and writes, in the order of its keys, read ones first.
pub(super) fn ports(machine: &MachineConfig, slot: u16) -> Vec<Port> {
    let Some(config) = machine.slots.get(usize::from(slot)) else { return Vec::new() };
    let mut ports = Vec::new();
    let words = config.words.iter().flatten().flat_map(|name| signal(machine, slot, name)).map(|read| ("word", read));
    let reads = (1..).zip(&config.reads).flat_map(|(nth, name)| {
        signal(machine, slot, name).into_iter().map(move |read| (format!("reads {nth}"), read))
    });
    let read = sources(machine, slot, config).into_iter().map(|read| ("source", read)).chain(words);
    let read = read.map(|(label, read)| (label.to_owned(), read)).chain(reads);
    ports.extend(read.map(|(label, (name, object, is_late))| Port {
        label,
        name,
        object,
        is_output: false,
        is_late,
        is_watched: false,
    }));
    let mut read = |label: String, name: &str, object| {
        let is_late = is_late(machine, slot, object);
        ports.push(Port { label, name: name.to_owned(), object, is_output: false, is_late, is_watched: false });
    };
    for (label, line) in lines('E', &config.inputs) {
        read(label, &line_name(machine, line), line.object);
    }
    for axis in watched(config).filter(|axis| usize::from(*axis) < machine.axes.len()) {
        let object = Object::Axis(axis);
        // Differences are those of the last cycle; positions reported by drives are those of this cycle.
        let reads_positions = config.kind.description().monitors == Monitored::Positions;
        let is_late = !reads_positions || !is_reported_by_drive(machine, Leader::AxisActual(axis));
        let (label, name) = (format!("AW{}", axis + 1), machine.name(object).to_owned());
        // The mean of a difference may affect the sink, a position does not.
        ports.push(Port { label, name, object, is_output: false, is_late, is_watched: reads_positions });
    }
    let sink = match config.sink {
        SinkConfig::None => None,
        SinkConfig::Axis(place) => Some(Object::Axis(place)),
        SinkConfig::Memory(place) => Some(Object::Memory(place)),
        SinkConfig::Output(place) => Some(Object::Io(place)),
    };
    let sink = sink.map(|object| ("sink".to_owned(), machine.name(object).to_owned(), object));
    let outputs = lines('A', &config.outputs).map(|(label, line)| (label, line_name(machine, line), line.object));
    let cell = |(nth, place): (usize, &u16)| {
        let object = Object::Memory(*place);
        (format!("writes {}", nth + 1), machine.name(object).to_owned(), object)
    };
    let written = sink.into_iter().chain(outputs).chain(config.writes.iter().enumerate().map(cell));
    ports.extend(written.map(|(label, name, object)| Port {
        label,
        name,
        object,
        is_output: true,
        is_late: false,
        is_watched: false,
    }));
    ports
}

/// Returns the virtual inputs, each with the output that it reads in the cycle before.
pub(super) fn mirrors(machine: &MachineConfig) -> impl Iterator<Item = (Object, Object)> {
    let inputs: Vec<u16> = machine.digital_inputs().collect();
    let reads = machine.global.virtual_inputs.iter();
    reads.filter_map(move |read| Some((Object::Io(read.output), Object::Io(*inputs.get(read.input)?))))
}

fn lines(letter: char, lines: &[Option<Line>]) -> impl Iterator<Item = (String, Line)> {
    let lines = lines.iter().enumerate();
    lines.filter_map(move |(place, line)| line.map(|line| (format!("{letter}{}", place + 1), line)))
}

fn line_name(machine: &MachineConfig, line: Line) -> String {
    format!("{}{}", if line.inverted { "not " } else { "" }, machine.name(line.object))
}

/// Returns the sources of a slot: name, object, and whether the value is that of the last cycle.
fn sources(machine: &MachineConfig, slot: u16, config: &SlotConfig) -> Vec<(String, Object, bool)> {
    match &config.source {
        SourceConfig::None => Vec::new(),
        SourceConfig::Signal(name) => signal(machine, slot, name),
        SourceConfig::Lead(leader) => {
            let read = |(before, leader): (String, Leader)| {
                let (name, object) = (machine.signal_of(leader)?, object(leader)?);
                let is_late = !is_reported_by_drive(machine, leader) && is_late(machine, slot, object);
                Some((format!("{before}{name}"), object, is_late))
            };
            leaders(machine, *leader).into_iter().filter_map(read).collect()
        }
    }
}

/// Returns a leader, or each member of a master, also of nested masters, with the names of the masters that contain it.
fn leaders(machine: &MachineConfig, leader: Leader) -> Vec<(String, Leader)> {
    let (mut found, mut next) = (vec![(String::new(), leader)], 0);
    while let Some((before, leader)) = found.get(next).cloned() {
        if let Leader::Sum(place) = leader
            && let Some(master) = machine.masters.get(usize::from(place))
        {
            let member =
                |(member, is_added)| (format!("{before}{} {} ", master.name, if is_added { '+' } else { '-' }), member);
            let members: Vec<_> = master.members().map(member).collect();
            found.splice(next..=next, members);
        } else {
            next += 1;
        }
    }
    found
}

fn object(leader: Leader) -> Option<Object> {
    match leader {
        Leader::AxisCommand(axis) | Leader::AxisActual(axis) | Leader::Simulated(axis) => Some(Object::Axis(axis)),
        Leader::Encoder(place) => Some(Object::Encoder(place)),
        Leader::Sink(place) => Some(Object::Function(place)),
        Leader::Virtual => Some(Object::Machine),
        Leader::Sum(_) => None,
    }
}

/// Returns a signal with its object; for a master, whose signals are those of the last cycle, with each of its members.
fn signal(machine: &MachineConfig, slot: u16, name: &str) -> Vec<(String, Object, bool)> {
    let of = name.split('.').next().unwrap_or_default();
    let Some(place) = machine.masters.iter().position(|master| master.name == of) else {
        let object = find(machine, name);
        return vec![(name.to_owned(), object, is_late(machine, slot, object))];
    };
    let members = leaders(machine, Leader::Sum(place as u16)).into_iter().filter_map(|(_, leader)| object(leader));
    members.map(|object| (name.to_owned(), object, true)).collect()
}

/// Returns the object that has the signal with that name.
fn find(machine: &MachineConfig, name: &str) -> Object {
    let name = name.split('.').next().unwrap_or_default();
    let places = |count: usize, object: fn(u16) -> Object| (0..count).map(move |place| object(place as u16));
    let mut all = places(machine.axes.len(), Object::Axis)
        .chain(places(machine.encoders.len(), Object::Encoder))
        .chain(places(machine.io.len(), Object::Io))
        .chain(places(machine.memory.len(), Object::Memory))
        .chain(places(machine.slots.len(), Object::Function));
    // A name that no section has belongs to the machine.
    all.find(|object| machine.name(*object) == name).unwrap_or(Object::Machine)
}

/// Returns the axes that a slot monitors without a source, according to the parameter set in the cell.
fn watched(config: &SlotConfig) -> impl Iterator<Item = u16> {
    let axes = config.kind.monitored_axes(&config.values);
    (0..8).filter(move |axis| axes >> axis & 1 == 1)
}

/// Whether it is the position of an axis that a drive reports before the slots are executed.
fn is_reported_by_drive(machine: &MachineConfig, leader: Leader) -> bool {
    let Leader::AxisActual(axis) = leader else { return false };
    machine.axes.get(usize::from(axis)).is_some_and(|axis| axis.drive.is_some())
}

/// Whether a slot reads the value of an object of the last cycle.
fn is_late(machine: &MachineConfig, slot: u16, object: Object) -> bool {
    let writer = || machine.writer(object).is_some_and(|writer| writer >= slot);
    match object {
        Object::Axis(_) | Object::Machine => true,
        Object::Function(other) => other >= slot,
        Object::Io(place) => {
            let is_output = |kind| matches!(kind, IoKind::DigitalOutput | IoKind::AnalogOutput);
            machine.io.get(usize::from(place)).is_some_and(|io| is_output(io.kind)) && writer()
        }
        Object::Memory(_) => writer(),
        Object::Encoder(_) | Object::Table(_) | Object::Program(_) => false,
    }
}

//! Reads section `backends`, and the keys with which other sections refer to it.

use super::can::{self, CellBus, CellDrive};
use super::names::{Entry, Names, Section, UsedOnce};
use crate::document::Map;
use lineshaft_can::NodeId;
use lineshaft_can::transport::Address;
use lineshaft_core::axis::MAX_DELAY;
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::drive::{Capabilities, Interface, Objects, Terminal};
use lineshaft_core::sim::Model;

/// Description of a backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Backend {
    Sim { delay: u32 },
    Can,
}

/// Kind of a backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackendKind {
    /// Simulation.
    Simulation,
    /// Drives and terminals on CAN.
    Can,
}

impl Backend {
    pub(super) fn kind(self) -> BackendKind {
        match self {
            Self::Sim { .. } => BackendKind::Simulation,
            Self::Can => BackendKind::Can,
        }
    }

    /// Returns the capabilities of a drive with that interface. `model` is its simulation; `on_can` are its keys for
    /// CAN.
    pub(super) fn offers(self, interface: Interface, model: Model, on_can: Option<&CellDrive>) -> Capabilities {
        match self {
            Self::Sim { delay } => model.capabilities(delay),
            Self::Can => can::offers(interface, on_can),
        }
    }
}

/// A backend of a cell.
#[derive(Clone, Debug)]
pub struct CellBackend {
    /// Name of the backend.
    pub name: String,
    /// Kind of the backend.
    pub kind: BackendKind,
    /// Objects at the backend.
    pub objects: Objects,
    /// Keys of the bus, for a backend on CAN.
    pub bus: Option<CellBus>,
}

impl CellBackend {
    /// Returns true for a simulation. `run` without `--sim` needs at least one other backend.
    pub fn is_simulated(&self) -> bool {
        self.kind == BackendKind::Simulation
    }

    /// Returns the transport of its bus, if it is on CAN.
    pub fn transport(&self) -> Option<&Address> {
        self.bus.as_ref().map(|bus| &bus.transport)
    }
}

/// Maximum address of an input or output at a node.
pub(super) const MOST_CHANNELS: u8 = 63;
/// Kind of address of encoders.
pub(super) const ENCODER: &str = "encoder";

/// Location of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Index of its backend in the section.
    pub backend: usize,
    /// Number at the backend: `address`; on CAN `node` for a drive, 256 `node` + `address` for other objects.
    pub number: u16,
}

/// Selects the list of objects of a kind.
type List = fn(&mut Objects) -> &mut Vec<Terminal>;

const IO_LISTS: [(IoKind, List); 4] = [
    (IoKind::DigitalInput, |objects| &mut objects.digital_inputs),
    (IoKind::DigitalOutput, |objects| &mut objects.digital_outputs),
    (IoKind::AnalogInput, |objects| &mut objects.analog_inputs),
    (IoKind::AnalogOutput, |objects| &mut objects.analog_outputs),
];

/// Returns the objects of each of `count` backends; `io` are the entries with their locations, `encoders` and `drives`
/// are in their order. An input that reads an output has no location, nor has a drive on no bus.
pub(super) fn objects(
    count: usize,
    io: (&[IoConfig], &[Option<Hardware>]),
    encoders: &[Option<Hardware>],
    drives: &[Option<Hardware>],
) -> Vec<Objects> {
    let mut all = vec![Objects::default(); count];
    let mut note = |at: Option<Hardware>, place: usize, list: List| {
        if let Some(Hardware { backend, number }) = at
            && let Some(objects) = all.get_mut(backend)
        {
            list(objects).push(Terminal { place, address: number });
        }
    };
    for (kind, list) in IO_LISTS {
        let of_kind = io.0.iter().zip(io.1).filter(|(entry, _)| entry.kind == kind);
        of_kind.enumerate().for_each(|(place, (_, at))| note(*at, place, list));
    }
    for (place, at) in encoders.iter().enumerate() {
        note(*at, place, |objects| &mut objects.encoders);
    }
    for (place, at) in drives.iter().enumerate() {
        note(*at, place, |objects| &mut objects.drives);
    }
    all
}

/// Data for the readers of all sections.
pub(super) struct Context<'d> {
    pub names: Names<'d>,
    /// Backends by index in the section; `None` if the description has problems.
    pub backends: Vec<Option<Backend>>,
    pub cycle_ns: Option<u64>,
}

/// Reads the backends, and the keys of those on CAN.
pub(super) fn read(entries: &[Entry<'_>]) -> (Vec<Option<Backend>>, Vec<Option<CellBus>>) {
    entries.iter().map(|entry| backend(entry).map_or((None, None), |(backend, bus)| (Some(backend), bus))).unzip()
}

fn backend(entry: &Entry<'_>) -> Option<(Backend, Option<CellBus>)> {
    let mut map = entry.value.map(format!("backend `{}`", entry.name()))?;
    let kinds = [("sim", BackendKind::Simulation), ("can", BackendKind::Can)];
    let backend = match map.required("type").and_then(|value| value.choice(&kinds)) {
        Some(BackendKind::Simulation) => sim(&mut map).map(|sim| (sim, None)),
        Some(BackendKind::Can) => can::bus(&mut map).map(|bus| (Backend::Can, Some(bus))),
        None => {
            map.rest();
            None
        }
    };
    map.finish();
    backend
}

fn sim(map: &mut Map<'_>) -> Option<Backend> {
    // Printed marks have their own seeds, and nothing else in the plant is random yet; this seed is reserved.
    let seed = map.optional("seed").map(|value| value.integer(0..=u64::MAX));
    let delay = map.optional("delay").map_or(Some(0), |value| value.integer(0..=MAX_DELAY));
    (seed != Some(None)).then_some(Backend::Sim { delay: delay? })
}

/// Reads key `backend`; returns its index in the section.
pub(super) fn backend_of<'d>(map: &mut Map<'d>, names: &Names<'d>) -> Option<usize> {
    let value = map.required("backend")?;
    let (_, place) = names.find(&value, value.text()?, &[Section::Backends])?;
    Some(place)
}

/// Returns the name of a backend for a message.
pub(super) fn name_of(backend: usize, names: &Names<'_>) -> String {
    names.section(Section::Backends).get(backend).map_or_else(String::new, Entry::quoted)
}

/// Reads keys `backend` and `address` of an object; `kind` is its kind of address at a backend. On CAN it also reads
/// `node`, which is sufficient for an encoder.
pub(super) fn address<'d>(
    map: &mut Map<'d>,
    cx: &Context<'d>,
    kind: Option<&'static str>,
    taken: &mut UsedOnce<(usize, &'static str, u16)>,
) -> Option<Hardware> {
    let backend = backend_of(map, &cx.names);
    let described = backend.and_then(|backend| cx.backends.get(backend).copied().flatten());
    let (number, value) = match described {
        Some(Backend::Sim { .. }) => {
            let value = map.required("address")?;
            (value.integer(0..=u16::MAX)?, value)
        }
        Some(Backend::Can) => {
            let node = map.required("node");
            let channel = if kind == Some(ENCODER) { None } else { Some(map.required("address")) };
            let node = node?;
            let channel = channel.map_or(Some(0), |channel| channel?.integer(0..=MOST_CHANNELS))?;
            (number(node.integer(1..=NodeId::MAX)?, channel), node)
        }
        // The keys depend on a backend that is unknown.
        None => {
            map.allow(&["address", "node"]);
            return None;
        }
    };
    let (backend, kind) = (backend?, kind?);
    let what = || {
        let backend = name_of(backend, &cx.names);
        let (node, channel) = node_and_channel(number);
        match (described, kind) {
            (Some(Backend::Can), ENCODER) => format!("{kind} node {node} of backend {backend}"),
            (Some(Backend::Can), _) => format!("{kind} address {channel} of node {node} of backend {backend}"),
            _ => format!("{kind} address {number} of backend {backend}"),
        }
    };
    taken.take((backend, kind, number), &value, what).then_some(Hardware { backend, number })
}

/// Returns the number of a terminal at its backend on CAN.
pub(super) fn number(node: u8, channel: u8) -> u16 {
    u16::from(node) << 8 | u16::from(channel)
}

/// Returns node and channel of such a number.
pub(super) fn node_and_channel(number: u16) -> (u16, u16) {
    (number >> 8, number & 0xFF)
}

//! Section `backends`, and the keys with which the other sections refer to it.

use super::can::{self, CellBus, CellDrive};
use super::names::{Entry, Names, Once, Section};
use crate::document::Map;
use lineshaft_can::NodeId;
use lineshaft_can::transport::Address;
use lineshaft_core::axis::MAX_DELAY;
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::drive::{Capabilities, Interface, Objects, Terminal};
use lineshaft_core::sim::Model;

/// A backend as it is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Backend {
    Sim { delay: u32 },
    Can,
}

/// Kinds of backends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackendKind {
    /// A simulation.
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

    /// What it offers for a drive with that interface, which a model simulates, or would simulate; on CAN it is described.
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
    /// Name.
    pub name: String,
    /// What it is.
    pub kind: BackendKind,
    /// What hangs on it.
    pub objects: Objects,
    /// Of one on CAN, what its keys say.
    pub bus: Option<CellBus>,
}

impl CellBackend {
    /// Is it a simulation? Another one is needed by `run` without `--sim`.
    pub fn is_simulated(&self) -> bool {
        self.kind == BackendKind::Simulation
    }

    /// The way to its bus, if it is on CAN.
    pub fn transport(&self) -> Option<&Address> {
        self.bus.as_ref().map(|bus| &bus.transport)
    }
}

/// Highest address of an input or output at a node.
pub(super) const MOST_CHANNELS: u8 = 63;
/// Kind of addresses that encoders have.
pub(super) const ENCODER: &str = "encoder";

/// Where an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Its backend, by its place in the section.
    pub backend: usize,
    /// Its number there: `address`; on CAN `node` of a drive, 256 `node` + `address` of other things.
    pub number: u16,
}

/// The list of the objects of a kind.
type List = fn(&mut Objects) -> &mut Vec<Terminal>;

const IO_LISTS: [(IoKind, List); 4] = [
    (IoKind::DigitalInput, |objects| &mut objects.digital_inputs),
    (IoKind::DigitalOutput, |objects| &mut objects.digital_outputs),
    (IoKind::AnalogInput, |objects| &mut objects.analog_inputs),
    (IoKind::AnalogOutput, |objects| &mut objects.analog_outputs),
];

/// The objects of each of `count` backends; `io` with where it is, then encoders and drives in their order. An input that reads an output is
/// nowhere, and so is a drive on no bus.
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

/// What the readers of all sections need.
pub(super) struct Context<'d> {
    pub names: Names<'d>,
    /// By place in the section; none where its description has problems.
    pub backends: Vec<Option<Backend>>,
    pub cycle_ns: Option<u64>,
}

/// The backends, and what the keys of those on CAN say.
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
    // Printed marks have seeds of their own, and nothing else in the plant is random yet; this one is for what will be.
    let seed = map.optional("seed").map(|value| value.integer(0..=u64::MAX));
    let delay = map.optional("delay").map_or(Some(0), |value| value.integer(0..=MAX_DELAY));
    (seed != Some(None)).then_some(Backend::Sim { delay: delay? })
}

/// Key `backend`: its place in the section.
pub(super) fn backend_of<'d>(map: &mut Map<'d>, names: &Names<'d>) -> Option<usize> {
    let value = map.required("backend")?;
    let (_, place) = names.find(&value, value.text()?, &[Section::Backends])?;
    Some(place)
}

/// The name of a backend in a sentence.
pub(super) fn name_of(backend: usize, names: &Names<'_>) -> String {
    names.section(Section::Backends).get(backend).map_or_else(String::new, Entry::quoted)
}

/// Keys `backend` and `address` of what has a `kind` of addresses of its own at a backend; on CAN `node` as well, which is all of an
/// encoder.
pub(super) fn address<'d>(
    map: &mut Map<'d>,
    cx: &Context<'d>,
    kind: Option<&'static str>,
    taken: &mut Once<(usize, &'static str, u16)>,
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
        // The keys depend on a backend that is not known.
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

/// Number of a terminal at its backend on CAN.
pub(super) fn number(node: u8, channel: u8) -> u16 {
    u16::from(node) << 8 | u16::from(channel)
}

/// Node and channel of such a number.
pub(super) fn node_and_channel(number: u16) -> (u16, u16) {
    (number >> 8, number & 0xFF)
}

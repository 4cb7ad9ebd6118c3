//! Reads section `backends`, and the keys with which other sections refer to it.

use super::can::{self, CellBus, CellDrive};
use super::names::{Entry, Names, Section, UsedOnce};
use super::scale::Travel;
use crate::document::Map;
use lineshaft_core::axis::MAX_DELAY;
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::drive::{BackendObject, Capabilities, Interface, ObjectAddress, Objects};
use lineshaft_core::sim::Model;
use std::ops::RangeInclusive;

/// Description of a backend. This file alone distinguishes the kinds; other sections use their properties.
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

    /// Returns the capabilities of a drive with that interface. `model` is its simulation; `keys` are those of its
    /// backend.
    pub(super) fn offers(self, interface: Interface, model: Model, keys: Option<&DriveKeys>) -> Capabilities {
        match self {
            Self::Sim { delay } => model.capabilities(delay),
            Self::Can => can::offers(interface, keys.and_then(DriveKeys::can)),
        }
    }

    /// Whether its objects are simulated. A drive at the outputs of such a backend is an object of the backend, too.
    pub(super) fn is_simulated(self) -> bool {
        matches!(self, Self::Sim { .. })
    }

    /// Returns what its objects are on, for messages.
    pub(super) fn medium(self) -> &'static str {
        match self {
            Self::Sim { .. } => "a simulation",
            Self::Can => can::MEDIUM,
        }
    }

    /// Returns the key that numbers its devices, and the allowed numbers. Each device may be lost by itself. `None` if its
    /// inputs, outputs and encoders are not at devices.
    pub(super) fn devices(self) -> Option<(&'static str, RangeInclusive<u16>)> {
        match self {
            Self::Sim { .. } => None,
            Self::Can => Some((can::DEVICE_KEY, can::NODES)),
        }
    }

    /// Returns the key that numbers its drives, and the allowed numbers.
    fn drives(self) -> (&'static str, RangeInclusive<u16>) {
        self.devices().unwrap_or(("address", self.channels()))
    }

    /// Returns the allowed addresses of inputs, outputs and encoders, for those at devices at each device.
    fn channels(self) -> RangeInclusive<u16> {
        match self {
            Self::Sim { .. } => 0..=u16::MAX,
            Self::Can => 0..=can::MOST_CHANNELS,
        }
    }

    /// Whether it reports the edges of digital inputs.
    pub(super) fn latches_inputs(self) -> bool {
        self.is_simulated()
    }

    /// Whether it reports the index pulses of encoders.
    pub(super) fn reports_index(self) -> bool {
        self.is_simulated()
    }

    /// Whether its analog channels have numbers, whose full scale in V the cell gives.
    pub(super) fn has_full_scales(self) -> bool {
        self == Self::Can
    }

    /// Returns the reason why its drives do not have that interface.
    pub(super) fn refuses(self, interface: Interface) -> Option<&'static str> {
        match self {
            Self::Can if interface == Interface::Voltage => Some(can::NO_VOLTAGE),
            _ => None,
        }
    }

    /// Returns the channel of an input, output or encoder as text, with its device if it has one.
    pub(super) fn channel_text(self, at: ObjectAddress) -> String {
        let ObjectAddress { device, channel } = at;
        self.devices().map_or_else(|| channel.to_string(), |(key, _)| format!("{channel} of {key} {device}"))
    }

    /// Reads the keys of a drive that only this backend has, after its number; `None` if they have problems.
    pub(super) fn drive_keys(
        self,
        map: &mut Map<'_>,
        number: Option<u16>,
        interface: Option<Interface>,
        travel: &Travel,
    ) -> Option<Option<DriveKeys>> {
        match self {
            Self::Sim { .. } => Some(None),
            Self::Can => can::drive(map, number, interface, travel).map(|drive| Some(DriveKeys::Can(drive))),
        }
    }
}

/// Kinds of backends whose analog channels have a full scale, for messages.
pub(super) const WITH_FULL_SCALES: &str = can::MEDIUM;

/// Kinds of backends whose devices have objects, for messages.
pub(crate) const WITH_OBJECTS: &str = can::MEDIUM;

/// Keys of a drive that only its backend has.
#[derive(Clone, Debug)]
pub enum DriveKeys {
    /// Keys of a drive on CAN.
    Can(CellDrive),
}

impl DriveKeys {
    /// Returns the keys of a drive on CAN.
    pub(super) fn can(&self) -> Option<&CellDrive> {
        let Self::Can(drive) = self;
        Some(drive)
    }

    /// Whether the drive has touch probes.
    pub(super) fn probes(&self) -> bool {
        let Self::Can(drive) = self;
        drive.probes()
    }

    /// Whether a touch probe of the drive reports index pulses.
    pub(super) fn has_index(&self) -> bool {
        let Self::Can(drive) = self;
        drive.has_index()
    }

    /// Whether the cell shows that the digital inputs of the drive are not read; `is_read_by_io`: an entry of `io` is
    /// one of them.
    pub(super) fn has_unread_inputs(&self, is_read_by_io: bool) -> bool {
        let Self::Can(drive) = self;
        drive.has_unread_inputs(is_read_by_io)
    }

    /// Returns the name of the mode of operation of the drive.
    pub(super) fn mode_name(&self) -> &'static str {
        let Self::Can(drive) = self;
        drive.mode().name()
    }

    /// Returns the number of the mode of operation of the drive (6060h).
    pub(super) fn mode_number(&self) -> i8 {
        let Self::Can(drive) = self;
        drive.mode().number()
    }

    /// Whether the drive plans its motion itself, in its mode of operation.
    pub(super) fn plans_motion(&self) -> bool {
        let Self::Can(drive) = self;
        drive.plans_motion()
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
    pub(super) bus: Option<CellBus>,
}

impl CellBackend {
    /// Returns true for a simulation. `run` without `--sim` needs at least one other backend.
    pub fn is_simulated(&self) -> bool {
        self.kind == BackendKind::Simulation
    }

    /// Whether its devices have objects, which `~/sdo_read` and `~/sdo_write` access.
    pub fn has_objects(&self) -> bool {
        self.kind == BackendKind::Can
    }

    /// Returns its hardware, such as the address of its bus; `None` for a simulation.
    pub fn hardware(&self) -> Option<String> {
        self.bus.as_ref().map(|bus| bus.transport.to_string())
    }

    /// Returns the word for its devices.
    pub fn device_word(&self) -> &'static str {
        match self.kind {
            BackendKind::Simulation => "address",
            BackendKind::Can => can::DEVICE_KEY,
        }
    }
}

/// Kind of address of encoders.
pub(super) const ENCODER: &str = "encoder";

/// Location of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Index of its backend in the section.
    pub backend: usize,
    /// Address at the backend.
    pub address: ObjectAddress,
}

/// Selects the list of objects of a kind.
type List = fn(&mut Objects) -> &mut Vec<BackendObject>;

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
        if let Some(Hardware { backend, address }) = at
            && let Some(objects) = all.get_mut(backend)
        {
            list(objects).push(BackendObject { place, address });
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

/// Addresses in use, by backend and kind of address.
pub(super) type TakenAddresses = UsedOnce<(usize, &'static str, ObjectAddress)>;

/// Data for the readers of all sections.
pub(super) struct Context<'d> {
    pub names: Names<'d>,
    /// Backends by index in the section; `None` if the description has problems.
    pub backends: Vec<Option<Backend>>,
    pub cycle_ns: Option<u64>,
}

impl Context<'_> {
    /// Returns the description of a backend, if it has no problems.
    pub(super) fn backend(&self, at: Hardware) -> Option<Backend> {
        self.backends.get(at.backend).copied().flatten()
    }
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

/// Reads keys `backend` and `address` of an object; `kind` is its kind of address at a backend. At a backend with
/// devices it also reads the key of the device, which is sufficient for an encoder.
pub(super) fn address<'d>(
    map: &mut Map<'d>,
    cx: &Context<'d>,
    kind: Option<&'static str>,
    taken: &mut TakenAddresses,
) -> Option<Hardware> {
    let backend = backend_of(map, &cx.names);
    let Some(described) = backend.and_then(|backend| cx.backends.get(backend).copied().flatten()) else {
        // The keys depend on a backend that is unknown.
        allow_addresses(map);
        return None;
    };
    let (address, value) = match described.devices() {
        None => {
            let value = map.required("address")?;
            (ObjectAddress::of_channel(value.integer(described.channels())?), value)
        }
        Some((key, numbers)) => {
            let device = map.required(key);
            let channel = if kind == Some(ENCODER) { None } else { Some(map.required("address")) };
            let device = device?;
            let channel = channel.map_or(Some(0), |channel| channel?.integer(described.channels()))?;
            (ObjectAddress { device: device.integer(numbers)?, channel }, device)
        }
    };
    let (backend, kind) = (backend?, kind?);
    let what = || {
        let backend = name_of(backend, &cx.names);
        match described.devices() {
            Some((key, _)) if kind == ENCODER => format!("{kind} {key} {} of backend {backend}", address.device),
            _ => format!("{kind} address {} of backend {backend}", described.channel_text(address)),
        }
    };
    taken.take((backend, kind, address), &value, what).then_some(Hardware { backend, address })
}

/// Reads the number of a drive at a backend, with the range of its key.
pub(super) fn drive_number(
    map: &mut Map<'_>,
    place: usize,
    backend: Backend,
    cx: &Context<'_>,
    taken: &mut UsedOnce<(usize, &'static str, u16)>,
) -> Option<u16> {
    let (key, range) = backend.drives();
    let value = map.required(key)?;
    let number = value.integer(range)?;
    let what = || format!("drive {key} {number} of backend {}", name_of(place, &cx.names));
    taken.take((place, key, number), &value, what).then_some(number)
}

/// Allows the keys with which backends of any kind number their objects.
fn allow_addresses(map: &mut Map<'_>) {
    map.allow(&["address", can::DEVICE_KEY]);
}

/// Allows the keys that a drive has at a backend of any kind.
pub(super) fn allow_drive_keys(map: &mut Map<'_>) {
    allow_addresses(map);
    map.allow(&can::DRIVE_KEYS);
}

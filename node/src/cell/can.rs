//! Reads the keys of CAN backends and their devices. `buses.rs` reads the files of devices when it creates the bus.

use super::names::{UsedOnce, quote};
use super::scale::Travel;
use super::times::time_within;
use crate::document::{Allowed, Map, Place, Value};
use lineshaft_can::config::{HEARTBEATS_MISSED, Master};
use lineshaft_can::transport::{Address, BAUD_RATES, slcan};
use lineshaft_can::{Monitoring, NodeId};
use lineshaft_cia402::config::{Identity, VelocityFactor, Write};
use lineshaft_cia402::drive_type::{DriveType, Kind};
use lineshaft_cia402::mode::DriveMode;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::probe::{Probe, Probes};
use lineshaft_core::drive::Capabilities;
use lineshaft_core::drive::Interface;
use lineshaft_core::unit::{Dimension, ScaleKind};
use std::ops::RangeInclusive;

/// What the objects of such a backend are on, for messages.
pub(super) const MEDIUM: &str = "CAN";
/// Key that numbers its devices.
pub(super) const DEVICE_KEY: &str = "node";
/// Numbers of its devices.
pub(super) const NODES: RangeInclusive<u16> = 1..=NodeId::MAX as u16;
/// Maximum address of an input or output at a node.
pub(super) const MOST_CHANNELS: u16 = 63;
/// Reason why a drive has no interface voltage.
pub(super) const NO_VOLTAGE: &str =
    "interface is voltage, for which CiA 402 has no mode; a drive on CAN has position, velocity, torque or open_loop";
/// Number of cycles from a setpoint to the response of a CANopen drive (contract section 1).
pub(super) const DELAY: u32 = 1;
/// Default timeout of an SDO server, in ns.
const SDO_TIMEOUT_NS: u64 = 500_000_000;
/// Default heartbeat period, in ns.
const HEARTBEAT_NS: u64 = 100_000_000;
/// Default guard time, in ns, and default life time factor of a drive with a drive type.
const GUARD_NS: u64 = 100_000_000;
const LIFE_FACTOR: u8 = 3;
/// Default node ID of the master.
const MASTER: NodeId = match NodeId::new(NodeId::MAX) {
    Some(node) => node,
    None => unreachable!(),
};
/// Maximum time of heartbeats and guarding, in ms: three times it must fit in 16 bits.
const LONGEST_MS: u64 = 21_000;

/// Types of values by name, with their size in bytes.
const TYPES: [(&str, Type); 10] = [
    ("u8", Type::Unsigned(1)),
    ("u16", Type::Unsigned(2)),
    ("u32", Type::Unsigned(4)),
    ("u64", Type::Unsigned(8)),
    ("i8", Type::Signed(1)),
    ("i16", Type::Signed(2)),
    ("i32", Type::Signed(4)),
    ("i64", Type::Signed(8)),
    ("f32", Type::Real),
    ("bool", Type::Bool),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    Unsigned(u32),
    Signed(u32),
    Real,
    Bool,
}

/// Keys of a bus.
#[derive(Clone, Debug)]
pub struct CellBus {
    pub(super) place: Place,
    pub(super) transport: Address,
    /// Bit rate, in bit/s.
    pub(super) bit_rate: Option<u32>,
    /// Baud rate of the serial line, in bit/s.
    pub(super) serial_baudrate: Option<u32>,
    pub(super) sync_overflow: Option<u8>,
    pub(super) sdo_timeout_ns: u64,
    pub(super) time_ns: Option<u64>,
    pub(super) master: Option<Master>,
    /// Keys of modules and encoders.
    pub(super) nodes: Vec<CellNode>,
}

/// A device on such a bus.
#[derive(Clone, Debug)]
pub(super) struct CellNode {
    pub(super) place: Place,
    pub(super) node: NodeId,
    /// File name relative to the cell, and location of the key.
    pub(super) eds: Option<(String, Place)>,
    pub(super) watching: Monitoring,
    pub(super) identity: Identity,
    pub(super) startup: Vec<Write>,
}

impl CellNode {
    /// Returns the default description of a device without keys in the cell.
    pub(super) fn with_defaults(node: NodeId, place: Place) -> Self {
        let watching = Monitoring::Heartbeat { time_ns: HEARTBEAT_NS * HEARTBEATS_MISSED };
        Self { place, node, eds: None, watching, identity: Identity::default(), startup: Vec::new() }
    }
}

/// A drive on such a bus.
#[derive(Clone, Debug)]
pub struct CellDrive {
    pub(super) device: CellNode,
    pub(super) mode: DriveMode,
    pub(super) drive_type: Option<DriveType>,
    pub(super) probes: Probes,
    /// Increments per revolution of the shaft, as a fraction.
    pub(super) per_revolution: Option<(u64, u64)>,
    pub(super) velocity: VelocityFactor,
    /// Whether the position is extrapolated while process data is missing.
    pub(super) extrapolates: bool,
    /// Effort of the axis at the rated torque, in N or Nm.
    pub(super) rated_effort: Option<f64>,
}

impl CellDrive {
    /// Returns the mode of operation.
    pub(super) fn mode(&self) -> DriveMode {
        self.mode
    }

    /// Whether it has touch probes.
    pub(super) fn probes(&self) -> bool {
        self.probes.iter().any(Option::is_some)
    }

    /// Whether a touch probe reports index pulses.
    pub(super) fn has_index(&self) -> bool {
        self.probes.contains(&Some(Probe::Index))
    }

    /// Whether the cell shows that the digital inputs of the drive (60FDh) are not read: it names no file of the drive
    /// and has no entry of `io` at the drive, or the drive has a fixed mapping.
    pub(super) fn has_unread_inputs(&self, is_read_by_io: bool) -> bool {
        self.drive_type.is_some() || self.device.eds.is_none() && !is_read_by_io
    }

    /// Whether the drive plans its motion itself (profile position).
    pub(super) fn plans_motion(&self) -> bool {
        self.mode == DriveMode::Pp
    }
}

/// Returns the capabilities of such a drive according to the cell; those of the real drive are read when it is online.
pub(super) fn offers(interface: Interface, drive: Option<&CellDrive>) -> Capabilities {
    let catches = |probe: &Option<Probe>| probe.is_some_and(|probe| probe != Probe::Index);
    let by_type = drive.is_some_and(|drive| drive.drive_type.is_some());
    Capabilities {
        latches: drive.is_some_and(|drive| drive.probes.iter().any(catches)),
        delay: DELAY,
        position: interface == Interface::Position,
        velocity: interface == Interface::Velocity,
        torque: interface == Interface::Torque,
        open_loop: interface == Interface::OpenLoop,
        // A drive with a drive type does not change its mode.
        homes: !by_type,
        ..Capabilities::default()
    }
}

/// Reads the keys of a backend except `type`.
pub(super) fn bus(map: &mut Map<'_>) -> Option<CellBus> {
    let place = map.place();
    let transport = map.required("transport").and_then(|value| transport(&value));
    let bitrate = map.optional("bitrate");
    let is_datagrams = matches!(transport, Some(Address::Udp { .. }));
    let bit_rate = match &bitrate {
        Some(value) if is_datagrams => {
            value.refuse("bitrate is for a bus; datagrams have none", Some("leave it out".to_owned()));
            None
        }
        Some(value) => bit_rate(value, transport.as_ref()).map(Some),
        None if matches!(transport, Some(Address::Slcan(_) | Address::SlcanTcp(_))) => {
            map.required("bitrate");
            None
        }
        None => Some(None),
    };
    let serial_baudrate =
        map.optional("serial_baudrate").map_or(Some(None), |value| baudrate(&value, transport.as_ref()).map(Some));
    let sync_overflow = map.optional("sync_counter").map_or(Some(None), |value| value.integer(2..=240).map(Some));
    let sdo_timeout_ns = map.optional("sdo_timeout").map_or(Some(SDO_TIMEOUT_NS), |value| ms(&value, 10..=10_000));
    let time_ns = map.optional("time").map_or(Some(None), |value| ms(&value, 100..=3_600_000).map(Some));
    let usual = Some(Master { node: MASTER, heartbeat_ns: HEARTBEAT_NS });
    let master = map.optional("master").map_or(Some(usual), |value| master(&value));
    let nodes = map.optional("nodes").map_or(Some(Vec::new()), |value| nodes(&value));
    Some(CellBus {
        place,
        transport: transport?,
        bit_rate: bit_rate?,
        serial_baudrate: serial_baudrate?,
        sync_overflow: sync_overflow?,
        sdo_timeout_ns: sdo_timeout_ns?,
        time_ns: time_ns?,
        master: master?,
        nodes: nodes?,
    })
}

/// Reads the descriptions of modules and encoders; each may occur once.
fn nodes(value: &Value<'_>) -> Option<Vec<CellNode>> {
    let mut taken = UsedOnce::new();
    let read = |value: &Value<'_>| {
        let mut map = value.map("an entry of nodes")?;
        let number = map.required("node");
        let node = number.as_ref().and_then(|value| value.integer(1..=NodeId::MAX)).and_then(NodeId::new);
        let device = device(&mut map, node);
        map.finish();
        taken.take(node?, &number?, || node.map_or_else(String::new, |node| node.to_string())).then_some(device?)
    };
    let nodes: Vec<_> = value.list()?.iter().map(read).collect();
    nodes.into_iter().collect()
}

fn transport(value: &Value<'_>) -> Option<Address> {
    match value.text()?.parse() {
        Ok(address) => Some(address),
        Err(error) => {
            value.refuse(format!("transport: {error}"), None);
            None
        }
    }
}

/// Reads the bit rate of a bus, in bit/s; an slcan adapter is set by a digit.
fn bit_rate(value: &Value<'_>, transport: Option<&Address>) -> Option<u32> {
    let rate = value.integer(10_000..=1_000_000_u32)?;
    let is_slcan = matches!(transport, Some(Address::Slcan(_) | Address::SlcanTcp(_)));
    let has_digit = rate.is_multiple_of(1000) && slcan::bit_rate(rate / 1000).is_some();
    if is_slcan && !has_digit {
        let rates = listed(slcan::bit_rates().map(|rate| 1000 * rate));
        value.refuse(format!("bitrate is {rate}; an slcan adapter knows {rates} bit/s"), None);
        return None;
    }
    Some(rate)
}

/// Reads the baud rate of the serial line of an adapter, in bit/s.
fn baudrate(value: &Value<'_>, transport: Option<&Address>) -> Option<u32> {
    if !matches!(transport?, Address::Slcan(_)) {
        let sentence = "serial_baudrate is for a serial line, transport slcan:PATH";
        value.refuse(sentence, Some("leave it out".to_owned()));
        return None;
    }
    let rate = value.integer(0..=u32::MAX)?;
    if !BAUD_RATES.contains(&rate) {
        let rates = listed(BAUD_RATES.into_iter());
        value.refuse(format!("serial_baudrate is {rate}; {rates} bit/s are allowed"), None);
        return None;
    }
    Some(rate)
}

/// Lists numbers, separated by commas.
fn listed(numbers: impl Iterator<Item = u32>) -> String {
    numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// Reads a time in whole milliseconds; returns it in ns.
fn ms(value: &Value<'_>, range: RangeInclusive<u64>) -> Option<u64> {
    let (low, high) = (range.start(), range.end());
    let allowed = format!("{low} ms to {high} ms in whole milliseconds");
    let time = time_within(value, low * 1_000_000..=high * 1_000_000, &allowed)?;
    let is_whole = time.is_multiple_of(1_000_000);
    if !is_whole {
        let given = quote(value.peek().unwrap_or_default());
        value.refuse(format!("{} is {given}; {allowed} is allowed", value.label()), None);
    }
    is_whole.then_some(time)
}

/// Whether the value is `none`.
fn is_none(value: &Value<'_>) -> bool {
    value.peek() == Some("none")
}

fn master(value: &Value<'_>) -> Option<Option<Master>> {
    if is_none(value) {
        return Some(None);
    }
    let mut map = value.map("master")?;
    let node = map.optional("node").map_or(Some(MASTER), |value| value.integer(1..=NodeId::MAX).and_then(NodeId::new));
    let heartbeat_ns = map.optional("heartbeat").map_or(Some(HEARTBEAT_NS), |value| ms(&value, 1..=LONGEST_MS));
    map.finish();
    Some(Some(Master { node: node?, heartbeat_ns: heartbeat_ns? }))
}

/// Reads the keys of a device except `node`, which is known.
fn device(map: &mut Map<'_>, node: Option<NodeId>) -> Option<CellNode> {
    let place = map.place();
    let eds = map.optional("eds").map_or(Some(None), |value| Some(Some((value.text()?.to_owned(), value.place()))));
    let watching = watching(map);
    let identity = map.optional("identity").map_or(Some(Identity::default()), |value| identity(&value));
    let startup = map.optional("startup").map_or(Some(Vec::new()), |value| startup(&value));
    Some(CellNode { place, node: node?, eds: eds?, watching: watching?, identity: identity?, startup: startup? })
}

/// Reads the keys of a drive except `backend`, `node` and `interface`, which are known.
pub(super) fn drive(
    map: &mut Map<'_>,
    node: Option<u16>,
    interface: Option<Interface>,
    travel: &Travel,
) -> Option<CellDrive> {
    let node = node.and_then(|node| NodeId::new(u8::try_from(node).ok()?));
    let mode = mode(map, interface);
    let number = map.optional("drivetype");
    let drive_type = number.as_ref().map_or(Some(None), |value| drive_type(value, interface).map(Some));
    let watched = ["heartbeat", "guarding"].map(|key| map.has(key));
    let mut device = device(map, node);
    if let (Some(Some(of_type)), Some(value), Some(device)) = (drive_type, &number, &mut device) {
        device.watching = watching_of(of_type, device.watching, watched, value)?;
    }
    let probes = probes(map);
    let feed = map.optional("feed").map_or(Some(None), |value| feed(&value, travel).map(Some));
    let given = map.optional("velocity_factor").map_or(Some(None), |value| factor(&value).map(Some));
    let policies = [("hold", false), ("extrapolate", true)];
    let extrapolates = map.optional("missed_pdo").map_or(Some(false), |value| value.choice(&policies));
    let rated =
        map.optional("rated_effort").map_or(Some(None), |value| rated_effort(&value, travel, interface).map(Some));
    let factor = factor_of(given?, drive_type?, feed?, number.as_ref());
    Some(CellDrive {
        device: device?,
        mode: mode?,
        drive_type: drive_type?,
        probes: probes?,
        per_revolution: feed?,
        velocity: factor?,
        extrapolates: extrapolates?,
        rated_effort: rated?,
    })
}

/// Reads the effort of the axis at the rated torque of its drive, in N or Nm.
fn rated_effort(value: &Value<'_>, travel: &Travel, interface: Option<Interface>) -> Option<f64> {
    if interface == Some(Interface::Torque) {
        let sentence = "rated_effort is not for interface torque, whose efforts are per mille of the rated torque";
        value.refuse(sentence, Some("leave it out".to_owned()));
        return None;
    }
    let dimension = match travel.kind? {
        ScaleKind::Linear => Dimension::Force,
        ScaleKind::Rotary => Dimension::Torque,
    };
    Some(value.quantity(&[dimension], &Allowed::Positive)?.si())
}

/// Reads the mode of operation.
fn mode(map: &mut Map<'_>, interface: Option<Interface>) -> Option<DriveMode> {
    let Some(value) = map.optional("mode") else { return DriveMode::default_of(interface?) };
    let mode = value.choice(&DriveMode::NAMES)?;
    let interface = interface?;
    if mode.interface() != interface {
        let fits = DriveMode::NAMES.iter().filter(|(_, mode)| mode.interface() == interface).map(|(name, _)| *name);
        let fits: Vec<_> = fits.collect();
        let sentence =
            format!("mode is {}; with interface {} {} is allowed", mode.name(), interface.name(), fits.join(", "));
        value.refuse(sentence, None);
        return None;
    }
    Some(mode)
}

fn drive_type(value: &Value<'_>, interface: Option<Interface>) -> Option<DriveType> {
    let number = value.integer(-194..=194_i16)?;
    let Some(known) = DriveType::decode(number) else {
        value.refuse(format!("drivetype is {number}; -2, -3, -4, -11, -13, 2, 3, 4, 11, 13 are allowed"), None);
        return None;
    };
    if let Some(why) = known.unsupported_reason() {
        value.refuse(format!("drivetype {number} does not exist here: {why}"), None);
        return None;
    }
    if interface.is_some_and(|interface| interface != Interface::Velocity) {
        value.refuse(format!("drivetype {number} is commanded by a velocity: it needs interface velocity"), None);
        return None;
    }
    Some(known)
}

/// Returns the supervision of a drive with a drive type: its sign enables guarding; the times are those of key
/// `guarding`.
fn watching_of(
    of: DriveType,
    said: Monitoring,
    [heartbeat, guarding]: [bool; 2],
    at: &Value<'_>,
) -> Option<Monitoring> {
    let number = at.peek().unwrap_or_default();
    if heartbeat {
        at.refuse(format!("drivetype {number}: its sign says how it is watched; heartbeat is not for it"), None);
        return None;
    }
    match (of.guarded, guarding) {
        (true, true) => Some(said),
        (true, false) => Some(Monitoring::Guarding { guard_ns: GUARD_NS, life_factor: LIFE_FACTOR }),
        (false, false) => Some(Monitoring::None),
        (false, true) => {
            at.refuse(format!("drivetype {number} is without guarding; key guarding is for a positive one"), None);
            None
        }
    }
}

/// Returns the units of velocity; those of the drive type if it has some.
fn factor_of(
    given: Option<VelocityFactor>,
    of: Option<DriveType>,
    feed: Option<(u64, u64)>,
    at: Option<&Value<'_>>,
) -> Option<VelocityFactor> {
    match (given, of.map(|of| of.kind), at) {
        (Some(given), ..) => Some(given),
        (None, Some(Kind::Akd), Some(at)) => {
            let factor = feed.and_then(|(counts, turns)| VelocityFactor::for_millirpm(counts, turns));
            if factor.is_none() {
                at.refuse("drivetype 13 has velocities in 1/1000 rpm: it needs feed, or velocity_factor", None);
            }
            factor
        }
        _ => Some(VelocityFactor::default()),
    }
}

/// Names of the keys that [`drive`] reads.
pub(super) const DRIVE_KEYS: [&str; 13] = [
    "missed_pdo",
    "rated_effort",
    "mode",
    "drivetype",
    "eds",
    "heartbeat",
    "guarding",
    "probe_1",
    "probe_2",
    "identity",
    "feed",
    "velocity_factor",
    "startup",
];

fn watching(map: &mut Map<'_>) -> Option<Monitoring> {
    let heartbeat = map.optional("heartbeat");
    let Some(guarding) = map.optional("guarding") else {
        let every_ns = match &heartbeat {
            Some(value) if is_none(value) => return Some(Monitoring::None),
            Some(value) => ms(value, 1..=LONGEST_MS)?,
            None => HEARTBEAT_NS,
        };
        return Some(Monitoring::Heartbeat { time_ns: every_ns * HEARTBEATS_MISSED });
    };
    if let Some(heartbeat) = heartbeat.filter(|value| !is_none(value)) {
        heartbeat.refuse("heartbeat and guarding exclude each other", Some("leave one of them out".to_owned()));
        return None;
    }
    let mut map = guarding.map("guarding")?;
    let guard_ns = map.required("time").and_then(|value| ms(&value, 1..=u16::MAX.into()));
    let life_factor = map.required("factor").and_then(|value| value.integer(1..=255_u8));
    map.finish();
    Some(Monitoring::Guarding { guard_ns: guard_ns?, life_factor: life_factor? })
}

/// Reads the event that each touch probe latches.
fn probes(map: &mut Map<'_>) -> Option<Probes> {
    let all = [("rising", Probe::Rising), ("falling", Probe::Falling), ("both", Probe::Both), ("index", Probe::Index)];
    let [first, second] = ["probe_1", "probe_2"].map(|key| map.optional(key));
    let read = |value: &Option<Value<'_>>| value.as_ref().map_or(Some(None), |value| value.choice(&all).map(Some));
    let (one, two) = (read(&first)?, read(&second)?);
    // Both would be the same latch source: the axis.
    if let (Some(one), Some(two), Some(value)) = (one, two, second)
        && (one == Probe::Index) == (two == Probe::Index)
    {
        value.refuse("probe_1 and probe_2: one of them may catch edges, and one the index", None);
        return None;
    }
    Some([one, two])
}

fn identity(value: &Value<'_>) -> Option<Identity> {
    let mut map = value.map("identity")?;
    let mut number = |key| map.optional(key).map_or(Some(None), |value| value.integer(0..=u32::MAX).map(Some));
    let numbers = ["vendor", "product", "revision", "serial"].map(&mut number);
    map.finish();
    let [vendor, product, revision, serial] = numbers;
    Some(Identity { vendor: vendor?, product: product?, revision: revision?, serial: serial? })
}

/// Reads the travel of the axis per revolution of the driving shaft, in increments.
fn feed(value: &Value<'_>, travel: &Travel) -> Option<(u64, u64)> {
    let kind = travel.kind?;
    let way = value.quantity(&[kind.dimension(0), Dimension::Increments(0)], &Allowed::Positive)?;
    let exact = match travel.scale?.exact(&way) {
        Ok(exact) => exact,
        Err(error) => {
            value.refuse(format!("feed: {error}"), error.hint());
            return None;
        }
    };
    let parts = (u64::try_from(*exact.numer()).ok(), u64::try_from(*exact.denom()).ok());
    if let (Some(numerator), Some(denominator)) = parts {
        return Some((numerator, denominator));
    }
    value.refuse(format!("feed is `{way}`, {exact} inc; a fraction of two numbers below 2^64 is allowed"), None);
    None
}

fn factor(value: &Value<'_>) -> Option<VelocityFactor> {
    let mut map = value.map("velocity_factor")?;
    let [numerator, denominator] =
        ["numerator", "denominator"].map(|key| map.required(key).and_then(|value| value.integer(1..=u32::MAX)));
    map.finish();
    Some(VelocityFactor { numerator: numerator?, denominator: denominator? })
}

fn startup(value: &Value<'_>) -> Option<Vec<Write>> {
    let mut taken = UsedOnce::new();
    let values: Vec<_> = value.list()?.iter().map(|value| write(value, &mut taken)).collect();
    values.into_iter().collect()
}

/// Objects that the master itself writes: first and last index, and the source of their values.
const OWN: [(u16, u16, &str); 10] = [
    (0x1005, 0x1006, "the cycle of the cell"),
    (0x100C, 0x100D, "key guarding"),
    (0x1016, 0x1016, "key master of the backend"),
    (0x1017, 0x1017, "key heartbeat"),
    (0x1019, 0x1019, "key sync_counter of the backend"),
    (0x1020, 0x1020, "the configuration"),
    (0x1400, 0x1BFF, "the interface of the drive, which maps its PDOs"),
    (0x6040, 0x6040, "the axis"),
    (0x6060, 0x6060, "the interface of the drive"),
    (0x60C2, 0x60C2, "the cycle of the cell"),
];

/// Returns the source of the values of an object that the master writes.
pub(crate) fn owner(index: u16) -> Option<&'static str> {
    OWN.iter().find(|(first, last, _)| (*first..=*last).contains(&index)).map(|(.., owner)| *owner)
}

fn write(value: &Value<'_>, taken: &mut UsedOnce<(u16, u8)>) -> Option<Write> {
    let mut map = value.map("an entry of startup")?;
    let index_value = map.required("index");
    let index = index_value.as_ref().and_then(|value| value.integer(0x1000..=0xFFFF_u16));
    let sub = map.optional("sub").map_or(Some(0), |value| value.integer(0..=255_u8));
    let kind = map.required("type").and_then(|value| value.choice(&TYPES));
    let given = map.required("value");
    let data = kind.zip(given).and_then(|(kind, value)| bytes(&value, kind));
    map.finish();
    let (index, sub, at) = (index?, sub?, index_value?);
    if let Some(owner) = owner(index) {
        at.refuse(format!("object {index:04X}h is not for startup: {owner} says what it holds"), None);
        return None;
    }
    let object = Object { index, sub };
    taken.take((index, sub), &at, || format!("object {object}")).then_some(())?;
    Some(Write { object, data: data? })
}

fn bytes(value: &Value<'_>, kind: Type) -> Option<Vec<u8>> {
    let of = |number: i128, bytes: u32| number.to_le_bytes().into_iter().take(bytes as usize).collect();
    match kind {
        Type::Unsigned(bytes) => {
            let most = (1_i128 << (bytes * 8)) - 1;
            value.integer(0..=most).map(|number| of(number, bytes))
        }
        Type::Signed(bytes) => {
            let half = 1_i128 << (bytes * 8 - 1);
            value.integer(-half..=half - 1).map(|number| of(number, bytes))
        }
        Type::Bool => value.boolean().map(|flag| vec![u8::from(flag)]),
        Type::Real => {
            let most = f64::from(f32::MAX);
            value.number(-most..=most).map(|number| (number as f32).to_le_bytes().to_vec())
        }
    }
}

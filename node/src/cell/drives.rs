//! Reads keys `drive` and `drives` of an axis: its drives and their locations.
//!
//! Law      an axis has one drive, or two that share its load, or none: then it is virtual
//! Refuses  two drives that differ in their interface, control loop or timing

use super::analog::{self, Analog, Outputs};
use super::backends::{Backend, Context, DriveKeys, Hardware, allow_drive_keys, backend_of, drive_number};
use super::names::{UsedOnce, quote};
use super::regulator::law;
use super::scale::Travel;
use super::times::time_within;
use crate::document::{Map, Value};
use lineshaft_core::axis::{ENABLE_TIMEOUT_NS, MISSED_CYCLES};
use lineshaft_core::drive::{AnalogWiring, Interface, ObjectAddress};
use lineshaft_core::regulator::Law;
use lineshaft_core::sim::Model;

/// Addresses of drives, with the name of the address key, by backend.
pub(super) type Taken = UsedOnce<(usize, &'static str, u16)>;

/// Key `drive`, and the keys in it that only the backend of the drive has.
pub(super) type Described = (Drive, Option<DriveKeys>);

/// Key `drive`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    Virtual,
    Real {
        at: Hardware,
        /// Backend of the drive.
        kind: Backend,
        interface: Interface,
        /// Control law of its position loop, if this program closes it.
        law: Law,
        /// Number of cycles without new data that are tolerated.
        missed_cycles: u32,
        /// Maximum time to switch on, in ns.
        enable_timeout_ns: u64,
        /// Wiring of a drive with voltage reference.
        analog: Option<AnalogWiring>,
    },
}

/// Maximum of the number of cycles without new data that are tolerated.
const MOST_MISSED: u32 = 1000;
/// Range of the maximum time to switch on, in ns.
const ENABLE_TIMES_NS: std::ops::RangeInclusive<u64> = 100_000_000..=600_000_000_000;

pub(super) fn interface_of(drive: Option<Drive>) -> Option<Interface> {
    match drive {
        Some(Drive::Real { interface, .. }) => Some(interface),
        _ => None,
    }
}

/// Returns the control law of the position loop of a drive, if this program closes it.
pub(super) fn law_of(drive: Option<Drive>) -> Law {
    match drive {
        Some(Drive::Real { law, .. }) => law,
        _ => Law::default(),
    }
}

/// Drive of an axis, and the second one if there are two; `None` if they have problems.
pub(super) type Read = (Option<Described>, Option<Described>);

/// Reads the keys, and returns whether the axis has two drives.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    axis: &str,
    travel: &Travel,
    cx: &Context<'d>,
    taken: &mut Taken,
    outputs: &mut Outputs<'_, 'd>,
) -> (Read, bool) {
    // A user of one key gets no message about the other.
    let both = if map.has("drives") || !map.has("drive") { map.optional("drives") } else { None };
    let Some(both) = both else {
        let one = map.required("drive").and_then(|value| drive(&value, axis, travel, cx, taken, Some(outputs)));
        return ((one, None), false);
    };
    if let Some(one) = map.optional("drive") {
        one.refuse("drive stands beside drives; one of them is expected", None);
        return ((None, None), true);
    }
    (two(&both, axis, travel, cx, taken).unwrap_or_default(), true)
}

/// Reads key `drives`.
fn two<'d>(both: &Value<'d>, axis: &str, travel: &Travel, cx: &Context<'d>, taken: &mut Taken) -> Option<Read> {
    let items = both.list()?;
    let [first, second] = items.as_slice() else {
        let count = items.len();
        both.refuse(
            format!(
                "drives of axis {} has {count} entr{}; 2 are expected",
                quote(axis),
                if count == 1 { "y" } else { "ies" }
            ),
            None,
        );
        return None;
    };
    let [one, other] = [first, second].map(|value| {
        if !value.is_map() {
            value.refuse(
                format!(
                    "drives has {}; {{backend: .., address: ..}} is expected",
                    quote(value.peek().unwrap_or_default())
                ),
                None,
            );
            return None;
        }
        let read = drive(value, axis, travel, cx, taken, None)?;
        let interface = interface_of(Some(read.0)).filter(|interface| *interface != Interface::Position);
        if let Some(interface) = interface {
            value.refuse(
                format!("interface is {}; two drives of one axis have interface position", interface.name()),
                None,
            );
            return None;
        }
        Some(read)
    });
    let (one, other) = (one?, other?);
    if other.1.as_ref().is_some_and(DriveKeys::probes) {
        second.refuse("a touch probe is for the first of two drives, which tells the position", None);
        return None;
    }
    let mode = |(_, keys): &Described| keys.as_ref().map(DriveKeys::mode_name);
    for (value, (_, keys)) in [(first, &one), (second, &other)] {
        if keys.as_ref().is_some_and(DriveKeys::plans_motion) {
            let sentence =
                "mode is pp, in which each drive has a profile of its own; two drives of one axis have csp or ip";
            value.refuse(sentence, None);
            return None;
        }
    }
    if let Some((before, behind)) = mode(&one).zip(mode(&other)).filter(|(before, behind)| before != behind) {
        let sentence = format!("mode is {behind}, that of the first drive {before}; the same mode is expected");
        second.refuse(sentence, None);
        return None;
    }
    let delay = |(drive, keys): &Described| match drive {
        Drive::Real { kind, interface, .. } => kind.offers(*interface, Model::Ideal, keys.as_ref()).delay,
        Drive::Virtual => 0,
    };
    let (before, behind) = (delay(&one), delay(&other));
    if before != behind {
        let sentence =
            format!("it has a delay of {behind} cycles, the first drive one of {before}; the same delay is expected");
        second.refuse(sentence, None);
        return None;
    }
    Some((Some(one), Some(other)))
}

pub(super) fn drive<'d>(
    value: &Value<'d>,
    axis: &str,
    travel: &Travel,
    cx: &Context<'d>,
    taken: &mut Taken,
    outputs: Option<&mut Outputs<'_, 'd>>,
) -> Option<Described> {
    if !value.is_map() {
        let text = value.text()?;
        if text == "virtual" {
            return Some((Drive::Virtual, None));
        }
        let allowed = "virtual, {backend: .., address: ..} or {reference: .., enable: ..} is allowed";
        value.refuse(format!("drive is {}; {allowed}", quote(text)), None);
        return None;
    }
    let mut map = value.map(format!("drive of axis `{axis}`"))?;
    if let Some(outputs) = outputs.filter(|_| map.has(analog::REFERENCE)) {
        let read = analog::read(&mut map, travel, cx, outputs);
        map.finish();
        let Analog { at, kind, interface, law, wiring } = read?;
        let analog = Some(wiring);
        let (missed_cycles, enable_timeout_ns) = (MISSED_CYCLES, ENABLE_TIMEOUT_NS);
        return Some((Drive::Real { at, kind, interface, law, missed_cycles, enable_timeout_ns, analog }, None));
    }
    let place = backend_of(&mut map, &cx.names);
    let backend = place.and_then(|place| cx.backends.get(place).copied().flatten());
    let interface = map.optional("interface").map_or(Some(Interface::Position), |value| interface(&value, backend));
    let law = map.optional("regulator").map_or(Some(Law::default()), |value| law(&value, interface));
    let missed = map.optional("missed_cycles").map_or(Some(MISSED_CYCLES), |value| value.integer(1..=MOST_MISSED));
    let enable = map
        .optional("enable_timeout")
        .map_or(Some(ENABLE_TIMEOUT_NS), |value| time_within(&value, ENABLE_TIMES_NS, "100 ms to 600 s"));
    let (number, keys) = match place.zip(backend) {
        Some((place, backend)) => {
            let number = drive_number(&mut map, place, backend, cx, taken);
            (number, backend.drive_keys(&mut map, number, interface, travel))
        }
        // The keys depend on a backend that is unknown.
        None => {
            allow_drive_keys(&mut map);
            (None, None)
        }
    };
    map.finish();
    let address = ObjectAddress::of_device(number?);
    let (at, kind) = (Hardware { backend: place?, address }, backend?);
    let drive = Drive::Real {
        at,
        kind,
        interface: interface?,
        law: law?,
        missed_cycles: missed?,
        enable_timeout_ns: enable?,
        analog: None,
    };
    Some((drive, keys?))
}

/// Reads key `interface`; `backend` is that of the drive, if known.
fn interface(value: &Value<'_>, backend: Option<Backend>) -> Option<Interface> {
    let interface = value.choice(&Interface::ALL.map(|interface| (interface.name(), interface)))?;
    if let Some(sentence) = backend.and_then(|backend| backend.refuses(interface)) {
        value.refuse(sentence, None);
        return None;
    }
    Some(interface)
}

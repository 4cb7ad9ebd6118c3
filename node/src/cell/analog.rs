//! Reads key `drive` of an axis whose drive has a voltage reference: the entries of `io` that drive it.
//!
//! Law      10 V is full_velocity, or full_effort with interface torque; the drive is at the backend of its reference
//! Refuses  entries of a wrong kind, or with another writer; an ao that does not reach 10 V; entries at several devices
//!          of a backend
//! Source   MACS-CAN-01 (DRIVETYPE 0); contract section 3

use super::backends::{Backend, Context, Hardware};
use super::devices::Io;
use super::names::quote;
use super::regulator::law;
use super::safety::contact;
use super::scale::Travel;
use super::terminals::Kind;
use super::times::time;
use super::wiring;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::config::IoKind;
use lineshaft_core::drive::{AnalogWiring, FULL_VOLTS, Interface, LONGEST_ENABLE_NS};
use lineshaft_core::regulator::Law;

/// Key that makes a drive an analog one.
pub(super) const REFERENCE: &str = "reference";

/// Entries of section `io`, and those of them that axes already use.
pub(super) struct Outputs<'a, 'd> {
    pub io: &'a Io<'d>,
    pub taken: &'a mut wiring::Taken,
}

/// Values of the keys.
pub(super) struct Analog {
    pub at: Hardware,
    /// Backend of the reference.
    pub kind: Backend,
    pub interface: Interface,
    pub law: Law,
    pub wiring: AnalogWiring,
}

/// Reads the keys that follow those of all drives.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    travel: &Travel,
    cx: &Context<'d>,
    outputs: &mut Outputs<'_, 'd>,
) -> Option<Analog> {
    let interfaces = [Interface::Velocity, Interface::Torque].map(|interface| (interface.name(), interface));
    let interface = map.required("interface").and_then(|value| value.choice(&interfaces));
    let law = map.optional("regulator").map_or(Some(Default::default()), |value| law(&value, interface));
    let reference_at = map.required(REFERENCE);
    let reference = reference_at.as_ref().and_then(|value| reference_of(value, cx, outputs));
    let enable_at = map.required("enable");
    let enable = enable_at
        .as_ref()
        .and_then(|value| wiring::place(value, IoKind::DigitalOutput, cx, &outputs.io.entries, outputs.taken));
    let contact_at = map.optional("ready");
    let ready = contact_at.as_ref().map_or(Some(None), |value| {
        contact(value, cx, &outputs.io.entries).and_then(|entry| u16::try_from(entry).ok()).map(Some)
    });
    let enable_ns = map.required("enable_time").and_then(|value| enable_time(&value));
    let full = match interface {
        Some(Interface::Torque) => map.required("full_effort").and_then(|value| effort(&value)),
        Some(_) => map.required("full_velocity").and_then(|value| velocity(&value, travel)),
        None => {
            map.allow(&["full_velocity", "full_effort"]);
            None
        }
    };
    let (reference, at) = reference?;
    let kind = cx.backend(at)?;
    let (enable, ready) = (enable?, ready?);
    if let Some((device, _)) = kind.devices().filter(|_| ready.is_none()) {
        let sentence = format!(
            "reference is on {}, and nothing shows whether its module is there; ready, a di of the same {device}, is expected",
            kind.medium()
        );
        reference_at.as_ref()?.refuse(sentence, None);
        return None;
    }
    let beside = |value: &Option<Value<'d>>, entry: Option<u16>| {
        let Some((value, entry)) = value.as_ref().zip(entry) else { return Some(()) };
        let found = outputs.io.terminals.get(usize::from(entry)).copied().flatten()?;
        is_lost_with(at, found).then_some(()).or_else(|| {
            let one = kind.devices().map_or("backend", |(device, _)| device);
            let (label, name) = (value.label(), quote(value.peek().unwrap_or_default()));
            let sentence = format!(
                "{label} is {name}, at another {one} than the reference; what drives an axis comes and goes together"
            );
            value.refuse(sentence, None);
            None
        })
    };
    let (by_enable, by_ready) = (beside(&enable_at, Some(enable)), beside(&contact_at, ready));
    by_enable.and(by_ready)?;
    let wiring = AnalogWiring { reference, enable, ready, full: full?, enable_ns: enable_ns? };
    Some(Analog { at, kind, interface: interface?, law: law?, wiring })
}

/// Whether it is lost together with `other`, because both are at the same device, or at a backend without devices.
fn is_lost_with(at: Hardware, other: Hardware) -> bool {
    at.backend == other.backend && at.address.device == other.address.device
}

/// Returns an ao that reaches 10 V, and its location.
fn reference_of<'d>(value: &Value<'d>, cx: &Context<'d>, outputs: &mut Outputs<'_, 'd>) -> Option<(u16, Hardware)> {
    let Outputs { io, taken } = outputs;
    let place = wiring::place(value, IoKind::AnalogOutput, cx, &io.entries, taken)?;
    let name = value.peek().unwrap_or_default();
    let at_device = io.at_devices.iter().find(|terminal| terminal.name == name);
    if let Some(Kind::Io { full_scale, .. }) = at_device.map(|terminal| terminal.kind)
        && full_scale < FULL_VOLTS
    {
        let sentence = format!(
            "reference is {}, whose full_scale is {full_scale} V; {FULL_VOLTS} V are the full reference, and an ao that reaches them is allowed",
            quote(name)
        );
        value.refuse(sentence, None);
        return None;
    }
    Some((place, io.terminals.get(usize::from(place)).copied().flatten()?))
}

fn enable_time(value: &Value<'_>) -> Option<u64> {
    let time = time(value)?;
    if time > LONGEST_ENABLE_NS {
        let given = quote(value.peek().unwrap_or_default());
        value.refuse(format!("{} is {given}; 0 s to 4 s is allowed", value.label()), None);
        return None;
    }
    Some(time)
}

fn velocity(value: &Value<'_>, travel: &Travel) -> Option<f64> {
    let quantity = value.quantity(&travel.any_scale()?.dimensions(1), &Allowed::Positive)?;
    let rate = travel.scale?.rate(&quantity, 1);
    rate.map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()
}

fn effort(value: &Value<'_>) -> Option<f64> {
    let effort = value.number(f64::NEG_INFINITY..=f64::INFINITY)?;
    if !(effort > 0.0 && effort.is_finite()) {
        let given = quote(value.peek().unwrap_or_default());
        value.refuse(format!("{} is {given}; a number above 0 is allowed", value.label()), None);
        return None;
    }
    Some(effort)
}

/// Whether a drive is on no bus of its backend, because it is connected only by inputs and outputs.
pub(super) fn is_off_bus(analog: Option<AnalogWiring>, kind: Option<Backend>) -> bool {
    analog.is_some() && kind.is_some_and(|kind| !kind.is_simulated())
}

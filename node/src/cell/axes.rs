//! Section `axes`: what an axis is made of. Its parameters are read beside.

use super::backends::{Backend, Context, backend_of, name_of};
use super::names::{Entry, Once, Section, limit, quote};
use super::parameters;
use super::scale::Travel;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::axis::Modulo;
use lineshaft_core::config::AxisConfig;
use lineshaft_core::object::MAX_AXES;
use lineshaft_core::sim::{Model, ModelError, SecondOrder};
use lineshaft_core::unit::{Dimension, ScaleKind};

/// Bandwidth of the second-order model when none is given (Hz).
const BANDWIDTH: f64 = 60.0;
/// Its damping when none is given.
const DAMPING: f64 = 0.8;
/// For the ranges of a model while the cycle has a problem.
const SOME_CYCLE_NS: u64 = 1_000_000;

/// An axis and how its drive is simulated; none for a virtual one.
pub(super) type Axis = (AxisConfig, Option<Model>);

/// Address of a drive and what it is called, by backend.
type Taken = Once<(usize, &'static str, u16)>;

/// Key `drive`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drive {
    Virtual,
    /// Its delay in cycles.
    Real(u32),
}

/// The axes, none where one has problems.
pub(super) fn read(cx: &Context<'_>) -> Vec<Option<Axis>> {
    let entries = cx.names.section(Section::Axes);
    limit(entries, MAX_AXES);
    let mut taken = Once::new();
    entries.iter().map(|entry| axis(entry, cx, &mut taken)).collect()
}

/// Is the axis without a drive, as far as can be seen?
pub(super) fn is_virtual(entry: &Entry<'_>) -> bool {
    let entries = if entry.value.is_map() { entry.value.entries() } else { None };
    entries.into_iter().flatten().any(|(key, value)| key.peek() == Some("drive") && value.peek() == Some("virtual"))
}

fn axis<'d>(entry: &Entry<'d>, cx: &Context<'d>, taken: &mut Taken) -> Option<Axis> {
    let name = entry.name();
    let mut map = entry.value.map(format!("axis `{name}`"))?;
    let mut travel = Travel::read(&mut map);
    travel.read_unit(&mut map);
    let drive = map.required("drive").and_then(|value| drive(&value, name, cx, taken));
    let modulo = map.optional("modulo").map(|value| modulo(&value, &travel));
    let homing = map.optional("homing");
    let sim = map.optional("sim");
    let parameters = parameters::read(&mut map, &travel, cx.cycle_ns);
    map.finish();
    let model = match drive {
        Some(Drive::Virtual) => {
            for value in [&homing, &sim].into_iter().flatten() {
                let sentence = format!("{} is for axes with a drive; axis {} is virtual", value.label(), quote(name));
                value.refuse(sentence, Some("leave it out".to_owned()));
            }
            None
        }
        _ => {
            homing.iter().for_each(check_homing);
            Some(sim.map_or(Some(Model::Ideal), |value| model(&value, cx.cycle_ns.unwrap_or(SOME_CYCLE_NS)))?)
        }
    };
    let drive = match drive? {
        Drive::Virtual => None,
        Drive::Real(delay) => Some(delay),
    };
    let modulo = modulo.map_or(Some(None), |modulo| modulo.map(Some))?;
    Some((AxisConfig { name: name.to_owned(), scale: travel.scale?, modulo, drive, parameters }, model))
}

fn drive<'d>(value: &Value<'d>, axis: &str, cx: &Context<'d>, taken: &mut Taken) -> Option<Drive> {
    if !value.is_map() {
        let text = value.text()?;
        if text == "virtual" {
            return Some(Drive::Virtual);
        }
        value.refuse(format!("drive is {}; virtual or {{backend: .., address: ..}} is allowed", quote(text)), None);
        return None;
    }
    let mut map = value.map(format!("drive of axis `{axis}`"))?;
    let place = backend_of(&mut map, &cx.names);
    let backend = place.and_then(|place| cx.backends.get(place).copied().flatten());
    let free = match (place, backend) {
        (Some(place), Some(Backend::Sim { .. })) => take(&mut map, place, "address", 0..=u16::MAX, cx, taken),
        (Some(place), Some(Backend::Can)) => {
            let eds = map.optional("eds").map(|value| value.text());
            take(&mut map, place, "node", 1..=127, cx, taken).filter(|()| eds != Some(None))
        }
        // The keys depend on a backend that is not known.
        _ => {
            map.allow(&["address", "node", "eds"]);
            None
        }
    };
    let interface = map.optional("interface").map_or(Some(()), |value| interface(&value));
    map.finish();
    free.and(interface)?;
    Some(Drive::Real(backend?.delay()))
}

/// Key `key`, which numbers the drives of a backend.
fn take(
    map: &mut Map<'_>,
    backend: usize,
    key: &'static str,
    range: std::ops::RangeInclusive<u16>,
    cx: &Context<'_>,
    taken: &mut Taken,
) -> Option<()> {
    let value = map.required(key)?;
    let number = value.integer(range)?;
    let what = || format!("drive {key} {number} of backend {}", name_of(backend, &cx.names));
    taken.take((backend, key, number), &value, what).then_some(())
}

fn interface(value: &Value<'_>) -> Option<()> {
    let name = value.choice(&["position", "velocity", "torque"].map(|name| (name, name)))?;
    if name != "position" {
        value.refuse(format!("interface {name} needs the position loop, which does not exist yet"), None);
    }
    (name == "position").then_some(())
}

fn modulo(value: &Value<'_>, travel: &Travel) -> Option<Modulo> {
    if travel.kind == Some(ScaleKind::Linear) {
        value.refuse("modulo is for rotary axes; this one is linear", Some("leave it out".to_owned()));
        return None;
    }
    let quantity = value.quantity(&[Dimension::Angle(0), Dimension::Increments(0)], &Allowed::Positive)?;
    let exact = match travel.scale?.exact(&quantity) {
        Ok(exact) => exact,
        Err(error) => {
            value.refuse(format!("modulo: {error}"), error.hint());
            return None;
        }
    };
    let parts = (i64::try_from(*exact.numer()).ok(), i64::try_from(*exact.denom()).ok());
    let modulo =
        if let (Some(numerator), Some(denominator)) = parts { Modulo::new(numerator, denominator) } else { None };
    if modulo.is_none() {
        let allowed = "1 inc to 2^61 inc as a fraction with a denominator below 2^31 is allowed";
        let hint = (quantity.unit() == Dimension::Angle(0).si_unit()).then(|| "write it in deg or rev".to_owned());
        value.refuse(format!("modulo is `{quantity}`, {exact} inc; {allowed}"), hint);
    }
    modulo
}

/// Key `homing`: none may be asked for yet.
fn check_homing(value: &Value<'_>) {
    let Some(mut map) = value.map("homing") else { return };
    let required = map.optional("required").and_then(|value| value.boolean());
    map.optional("method").map(|value| value.integer(i8::MIN..=i8::MAX));
    map.optional("home_type").map(|value| value.integer(0..=3_u8));
    let has_method = map.has("method") || map.has("home_type");
    map.finish();
    if required == Some(true) || has_method {
        value.refuse("homing does not exist yet", Some("leave it out".to_owned()));
    }
}

/// Key `sim`.
fn model(value: &Value<'_>, cycle_ns: u64) -> Option<Model> {
    let mut map = value.map("sim")?;
    let second_order = map.required("model").and_then(|v| v.choice(&[("ideal", false), ("second_order", true)]));
    let (bandwidth, damping) = (map.optional("bandwidth"), map.optional("damping"));
    map.finish();
    if second_order == Some(false) {
        let needless: Vec<_> = [bandwidth, damping].into_iter().flatten().collect();
        for value in &needless {
            value.refuse(format!("{} is for model second_order; this one is ideal", value.label()), None);
        }
        return needless.is_empty().then_some(Model::Ideal);
    }
    // Each by itself, so that both are reported.
    let hertz = bandwidth.map_or(Some(BANDWIDTH), |value| {
        let hertz = value.quantity(&[Dimension::Frequency], &Allowed::Any)?.si();
        accept(&value, SecondOrder::new(hertz, DAMPING, cycle_ns)).map(|_| hertz)
    });
    let damping = damping.map_or(Some(DAMPING), |value| {
        let damping = value.number(f64::NEG_INFINITY..=f64::INFINITY)?;
        accept(&value, SecondOrder::new(BANDWIDTH, damping, cycle_ns)).map(|_| damping)
    });
    second_order?;
    SecondOrder::new(hertz?, damping?, cycle_ns).ok().map(Model::SecondOrder)
}

fn accept(value: &Value<'_>, result: Result<SecondOrder, ModelError>) -> Option<SecondOrder> {
    result.map_err(|error| value.refuse(error.to_string(), None)).ok()
}

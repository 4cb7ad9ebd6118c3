//! Reads key `sim` of an input: the printed marks that it detects in the simulation.
//!
//! Law      marks are on the web of an encoder or of the drive of an axis, named by `of`; amounts are in its units
//! Refuses  an input that latches nothing or is at no simulation, a web at another backend, marks that could overlap

use super::backends::{Backend, Context, Hardware, name_of};
use super::names::{Section, quote};
use super::scale::Travel;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::position::Position;
use lineshaft_core::sim::{Carrier, Marks, Mechanics, Stretch};
use lineshaft_core::unit::{Dimension, Fraction, Quantity, Unit, fraction_to_f64};

/// Maximum number of marks in a period of the stretch.
const LONGEST_PERIOD: u32 = 1_000_000;

/// An input of the cell that detects marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellMarks {
    /// Index of the input among the digital ones.
    pub input: usize,
    /// Encoder or drive with the marks.
    pub carrier: Carrier,
    /// The marks.
    pub marks: Marks,
}

/// Key `sim` of a digital input.
pub(super) struct Given<'d> {
    pub value: Value<'d>,
    /// Index of the input among the digital ones.
    pub input: usize,
    pub latch: bool,
    /// Location; `None` for an input that reads an output.
    pub at: Option<Hardware>,
}

/// Locations of axes and encoders.
pub(super) struct Locations<'a> {
    /// Locations of the axes; `None` for a virtual one.
    pub axes: &'a [Option<Hardware>],
    pub encoders: &'a [Option<Hardware>],
    /// Mechanics of each drive.
    pub mechanics: &'a [Mechanics],
}

/// Reads the marks that inputs detect; problems are recorded.
pub(super) fn read<'d>(
    given: &[Given<'d>],
    cx: &Context<'d>,
    machine: &MachineConfig,
    hung: &Locations<'_>,
) -> Vec<CellMarks> {
    given.iter().filter_map(|given| one(given, cx, machine, hung)).collect()
}

fn one<'d>(given: &Given<'d>, cx: &Context<'d>, machine: &MachineConfig, hung: &Locations<'_>) -> Option<CellMarks> {
    let Given { value, input, latch, at } = given;
    let mut map = value.map("sim")?;
    let marks = map.required("marks");
    map.finish();
    let marks = marks?;
    let backend = at.map(|at| at.backend);
    let is_simulated = |backend: usize| cx.backends.get(backend).copied().flatten().is_some_and(Backend::is_simulated);
    let Some(backend) = backend.filter(|backend| is_simulated(*backend)) else {
        value.refuse("sim is for an input on a backend of type sim", Some("leave it out".to_owned()));
        return None;
    };
    if !latch {
        value.refuse("marks are for an input with latch: true; this one latches nothing", None);
        return None;
    }
    if hung.mechanics.iter().any(|hangs| hangs.wires.iter().flatten().any(|wire| wire.input == *input)) {
        value.refuse("marks are for an input of their own; a switch of an axis is wired to this one", None);
        return None;
    }
    let mut map = marks.map("marks")?;
    let way = map.required("of").and_then(|value| way(&value, backend, cx, machine, hung));
    let marks = match way {
        Some((_, travel)) => read_web_keys(&mut map, &marks, &travel),
        None => {
            map.rest();
            None
        }
    };
    map.finish();
    Some(CellMarks { input: *input, carrier: way?.0, marks: marks? })
}

/// Reads key `of`: the encoder or drive with the marks, and its scale.
fn way<'d>(
    value: &Value<'d>,
    backend: usize,
    cx: &Context<'d>,
    machine: &MachineConfig,
    hung: &Locations<'_>,
) -> Option<(Carrier, Travel)> {
    let name = value.text()?;
    let (section, place) = cx.names.find(value, name, &[Section::Encoders, Section::Axes])?;
    let (carrier, scale, at) = if section == Section::Encoders {
        (Carrier::Encoder(place), machine.encoders.get(place)?.scale, hung.encoders.get(place).copied().flatten())
    } else {
        let drives = hung.axes.iter().take(place).flatten().count();
        (Carrier::Drive(drives), machine.axes.get(place)?.scale, hung.axes.get(place).copied().flatten())
    };
    match at {
        Some(at) if at.backend == backend => Some((carrier, Travel { kind: Some(scale.kind()), scale: Some(scale) })),
        Some(at) => {
            let [there, here] = [at.backend, backend].map(|backend| name_of(backend, &cx.names));
            value.refuse(format!("of is {}, which is on backend {there}; one on {here} is allowed", quote(name)), None);
            None
        }
        None => {
            let sentence = "which is virtual; an encoder or an axis with a drive is allowed";
            value.refuse(format!("of is {}, {sentence}", quote(name)), None);
            None
        }
    }
}

/// Reads the keys in units of the web, and those for errors of the marks.
fn read_web_keys(map: &mut Map<'_>, whole: &Value<'_>, travel: &Travel) -> Option<Marks> {
    let given_every = map.required("every");
    let every = given_every.as_ref().and_then(|value| every(value, travel));
    let first = amount(map.optional("first"), travel, &Allowed::Any);
    let width_value = map.optional("width");
    let width = amount(width_value.clone(), travel, &Allowed::NotNegative);
    let jitter = amount(map.optional("jitter"), travel, &Allowed::NotNegative);
    let stretch = stretch(map);
    let [lost, extra] = ["lost", "extra"].map(|key| map.optional(key).map_or(Some(0.0), |value| share(&value)));
    let seed = map.optional("seed").map_or(Some(0), |value| value.integer(0..=u64::MAX));
    let marks = Marks {
        every: every?,
        first: first?,
        width: width?,
        jitter: jitter?,
        stretch: stretch?,
        missing_share: lost?,
        extra: extra?,
        seed: seed?,
    };
    let written = |value: &Option<Value<'_>>| quote(value.as_ref().and_then(Value::peek).unwrap_or_default());
    if marks.width.to_f64() * 2.0 >= marks.every.to_f64() {
        let value = width_value.as_ref()?;
        let sentence = format!(
            "width is {}; less than half of every, {}, is allowed",
            written(&width_value),
            written(&given_every)
        );
        value.refuse(sentence, None);
        return None;
    }
    if !marks.is_sound() {
        let sentence =
            "marks could overlap; width and jitter together less than half of every without its stretch are allowed";
        whole.refuse(sentence, None);
        return None;
    }
    Some(marks)
}

/// Reads key `every`; at least one increment.
fn every(value: &Value<'_>, travel: &Travel) -> Option<Position> {
    let every = exact(value, travel, &Allowed::Positive)?;
    if every < Position::whole(1) {
        let given = quote(value.peek().unwrap_or_default());
        value.refuse(format!("every is {given}, which is less than an increment; 1 inc and above is allowed"), None);
        return None;
    }
    Some(every)
}

/// Reads an optional amount.
fn amount(value: Option<Value<'_>>, travel: &Travel, allowed: &Allowed) -> Option<Position> {
    value.map_or(Some(Position::ZERO), |value| exact(&value, travel, allowed))
}

/// Reads an amount with its fraction of an increment.
fn exact(value: &Value<'_>, travel: &Travel, allowed: &Allowed) -> Option<Position> {
    let scale = travel.any_scale()?;
    let quantity = value.quantity(&scale.dimensions(0), allowed)?;
    // An amount beyond the range of positions is refused like a position.
    let exact = scale.position(&quantity).and_then(|_| scale.exact(&quantity));
    let exact = exact.map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()?;
    Some(Position::from_f64(fraction_to_f64(&exact)))
}

/// Reads keys `stretch` and `stretch_period`, which must be given together.
fn stretch(map: &mut Map<'_>) -> Option<Option<Stretch>> {
    let (most, period) = (map.optional("stretch"), map.optional("stretch_period"));
    match (most, period) {
        (None, None) => Some(None),
        (Some(value), None) => {
            value.refuse("stretch needs stretch_period, the marks until the web is the same again", None);
            None
        }
        (None, Some(value)) => {
            value.refuse("stretch_period is for marks with a stretch", Some("leave it out".to_owned()));
            None
        }
        (Some(most), Some(period)) => {
            let (share, period) = (share(&most), period.integer(2..=LONGEST_PERIOD));
            Some(Some(Stretch { share: share?, period: period? }))
        }
    }
}

/// Reads a fraction, 0 % to 100 %.
fn share(value: &Value<'_>) -> Option<f64> {
    let percent = Unit::parse("%")?;
    let [none, all] = [0, 100].map(|number| Quantity::new(Fraction::from(number), percent));
    Some(value.quantity(&[Dimension::Ratio], &Allowed::Between(none, all))?.si())
}

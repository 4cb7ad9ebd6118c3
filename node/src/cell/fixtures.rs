//! Reads the fixtures along a simulated axis, in key `sim`: start position, index of the encoder, switches, and inputs
//! to which they are wired.
//!
//! Positions are those of the machine in the count direction of its drive, so that the drive reads 0 at `start`
//! initially.

use super::backends::Context;
use super::devices;
use super::names::{Section, UsedOnce, quote};
use super::scale::Travel;
use super::times::time;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::drive::inputs;
use lineshaft_core::parameter::{AxisParameters, Polarity};
use lineshaft_core::sim::{Fixtures, Index, Mechanics, SignOutputs, SwitchWiring};
use lineshaft_core::unit::Dimension;

/// Inputs that switches are wired to, by their index in section `io`.
pub(super) type Taken = UsedOnce<usize>;

/// Data for reading the keys.
struct Reader<'r, 'd> {
    travel: &'r Travel,
    cx: &'r Context<'d>,
    io: &'r [Option<IoConfig>],
    taken: &'r mut Taken,
}

/// Reads the keys that do not belong to the model. `encoder` is the entry of section `encoders` that the axis reads
/// instead of its drive.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    travel: &Travel,
    cx: &Context<'d>,
    io: &[Option<IoConfig>],
    taken: &mut Taken,
    encoder: Option<&str>,
) -> Option<Mechanics> {
    let mut reader = Reader { travel, cx, io, taken };
    let start = map.optional("start").map_or(Some(0), |value| reader.place(&value));
    let index = optional(map.optional("index"), |value| {
        if let Some(encoder) = encoder {
            let sentence = format!("index belongs to entry {} of encoders, which the axis reads", quote(encoder));
            value.refuse(sentence, Some("give it there".to_owned()));
        }
        reader.index(&value)
    });
    let home = optional(map.optional("home_switch"), |value| reader.home(&value));
    let mut end = |key, bit| optional(map.optional(key), |value| reader.limit_switch(&value, key, bit));
    let negative = end("negative_limit_switch", inputs::NEGATIVE_LIMIT);
    let positive = end("positive_limit_switch", inputs::POSITIVE_LIMIT);
    let (home, negative, positive) = (home?, negative?, positive?);
    let fixtures = Fixtures {
        start: start?,
        index: index?,
        home: home.map(|(range, _)| range),
        negative: negative.map(|(at, _)| at),
        positive: positive.map(|(at, _)| at),
    };
    let wires =
        [home.and_then(|(_, wire)| wire), negative.and_then(|(_, wire)| wire), positive.and_then(|(_, wire)| wire)];
    Some(Mechanics { fixtures, wires, ..Mechanics::default() })
}

/// Whether the switches have inputs of the machine. A drive with voltage reference has none.
pub(super) fn are_wired(sim: &Value<'_>, mechanics: &Mechanics) -> bool {
    let Fixtures { home, negative, positive, .. } = mechanics.fixtures;
    let switches = [
        ("home_switch", home.is_some()),
        ("negative_limit_switch", negative.is_some()),
        ("positive_limit_switch", positive.is_some()),
    ];
    let bare = switches.iter().zip(&mechanics.wires).find(|((_, stands), wire)| *stands && wire.is_none());
    if let Some(((key, _), _)) = bare {
        let why = "has no input, and a drive that is given a voltage reads none itself; input is expected";
        sim.refuse(format!("{key} {why}"), None);
    }
    bare.is_none()
}

/// Reads key `second`: the fixtures of the second of two drives.
pub(super) fn second<'d>(
    map: &mut Map<'d>,
    has_two: bool,
    travel: &Travel,
    cx: &Context<'d>,
    io: &[Option<IoConfig>],
    taken: &mut Taken,
) -> Option<Option<Mechanics>> {
    let Some(value) = map.optional("second") else { return Some(None) };
    if !has_two {
        value.refuse("second is for an axis with two drives; this one has one", Some("leave it out".to_owned()));
        return None;
    }
    let mut map = value.map("second")?;
    let mechanics = read(&mut map, travel, cx, io, taken, None);
    map.finish();
    mechanics.map(Some)
}

/// Reads the times in which the brake opens and closes, in ns, of an axis that has one.
pub(super) fn brake_times(map: &mut Map<'_>, has_brake: bool) -> Option<[u64; 2]> {
    let [opens, closes] = ["brake_opens", "brake_closes"].map(|key| match map.optional(key) {
        None => Some(0),
        Some(value) if has_brake => time(&value),
        Some(value) => {
            let sentence = format!("{key} is for an axis with a brake; this one has neither brake nor o_brake");
            value.refuse(sentence, Some("leave it out".to_owned()));
            None
        }
    });
    Some([opens?, closes?])
}

/// Reads the acceleration of a hanging load that nothing holds, in inc/s^2.
pub(super) fn load(map: &mut Map<'_>, travel: &Travel) -> Option<f64> {
    let Some(value) = map.optional("hanging_load") else { return Some(0.0) };
    let scale = travel.any_scale()?;
    let unit = travel.scale.map(|scale| scale.unit().unit());
    let quantity = value.quantity_in(unit, &scale.dimensions(2), &Allowed::Any)?;
    let rate = travel.scale?.rate(&quantity, 2);
    rate.map_err(|error| value.refuse(format!("hanging_load: {error}"), error.hint())).ok()
}

/// Returns the outputs that give the drive the sign of its reference, according to REVERS.
pub(super) fn sign(parameters: &AxisParameters) -> Option<SignOutputs> {
    match parameters.reversing().polarity {
        Polarity::Bipolar => None,
        Polarity::Direction(output) => Some(SignOutputs::Direction(usize::from(output).checked_sub(1)?)),
        Polarity::Enables(output) => {
            let first = usize::from(output).checked_sub(1)?;
            Some(SignOutputs::Enables(first, first + 1))
        }
    }
}

/// Reads an optional value; returns `None` if it is wrong.
fn optional<'d, T>(value: Option<Value<'d>>, read: impl FnOnce(Value<'d>) -> Option<T>) -> Option<Option<T>> {
    value.map_or(Some(None), |value| read(value).map(Some))
}

impl<'d> Reader<'_, 'd> {
    /// Reads a position, in inc.
    fn place(&self, value: &Value<'_>) -> Option<i64> {
        self.length(value, &Allowed::Any)
    }

    fn length(&self, value: &Value<'_>, allowed: &Allowed) -> Option<i64> {
        let scale = self.travel.any_scale()?;
        let dimensions = match self.travel.kind {
            Some(_) => scale.dimensions(0).to_vec(),
            // The quantity is unknown, which is reported at `type`.
            None => vec![Dimension::Length(0), Dimension::Angle(0), Dimension::Increments(0)],
        };
        let unit = self.travel.scale.map(|scale| scale.unit().unit());
        let quantity = value.quantity_in(unit, &dimensions, allowed)?;
        let position = self.travel.scale?.position(&quantity);
        position.map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()
    }

    fn index(&self, value: &Value<'d>) -> Option<Index> {
        let mut map = value.map("index")?;
        let every = map.required("every").and_then(|value| {
            let every = self.length(&value, &Allowed::Positive)?;
            if every == 0 {
                let given = quote(value.peek().unwrap_or_default());
                value.refuse(
                    format!("every is {given}, which is less than half an increment; 1 inc and above is allowed"),
                    None,
                );
            }
            Some(every).filter(|every| *every > 0)
        });
        let at = map.optional("at").map_or(Some(0), |value| self.place(&value));
        map.finish();
        Some(Index { every: every?, at: at? })
    }

    /// Reads the reference switch: the range in which it is actuated, and its wire.
    fn home(&mut self, value: &Value<'d>) -> Option<((i64, i64), Option<SwitchWiring>)> {
        let mut map = value.map("home_switch")?;
        let lower = map.required("from");
        let from = lower.as_ref().and_then(|value| self.place(value));
        let upper = map.required("to");
        let to = upper.as_ref().and_then(|value| self.place(value));
        let wire = self.wire(&mut map, inputs::HOME);
        map.finish();
        let (from, to, lower, upper) = (from?, to?, lower?, upper?);
        if from > to {
            let [least, given] = [&lower, &upper].map(|value| quote(value.peek().unwrap_or_default()));
            upper.refuse(format!("to is {given}; from, {least}, and above is allowed"), None);
            return None;
        }
        Some(((from, to), wire?))
    }

    /// Reads a limit switch: the position from which it is actuated, and its wire.
    fn limit_switch(&mut self, value: &Value<'d>, key: &str, bit: u32) -> Option<(i64, Option<SwitchWiring>)> {
        let mut map = value.map(key)?;
        let at = map.required("at").and_then(|value| self.place(&value));
        let wire = self.wire(&mut map, bit);
        map.finish();
        Some((at?, wire?))
    }

    /// Reads keys `input` and `normally_closed`.
    fn wire(&mut self, map: &mut Map<'d>, switch: u32) -> Option<Option<SwitchWiring>> {
        let closed = map.optional("normally_closed");
        let normally_closed = closed.as_ref().map_or(Some(false), Value::boolean);
        let Some(value) = map.optional("input") else {
            if let Some(value) = closed {
                let sentence =
                    "normally_closed is for a switch with an input; the drive shows in 60FDh that one is actuated";
                value.refuse(sentence, Some("leave it out".to_owned()));
                return None;
            }
            return Some(None);
        };
        let name = value.text()?;
        let (_, place) = self.cx.names.find(&value, name, &[Section::Io])?;
        let kind = |place: usize| self.io.get(place).and_then(Option::as_ref).map(|entry| entry.kind);
        // An entry with its own problems may be of any kind.
        if kind(place).is_some_and(|kind| kind != IoKind::DigitalInput) {
            value.refuse(format!("input is {}, which is no di; a di is allowed", quote(name)), None);
            return None;
        }
        if kind(place).is_some() && devices::reads_output(place, self.cx) {
            let sentence = "reads an output of the machine; a di with a backend and an address is allowed";
            value.refuse(format!("input is {}, which {sentence}", quote(name)), None);
            return None;
        }
        if !self.taken.take(place, &value, || format!("input {}", quote(name))) {
            return None;
        }
        let input = (0..place).filter(|other| kind(*other) == Some(IoKind::DigitalInput)).count();
        Some(Some(SwitchWiring { switch, input, normally_closed: normally_closed? }))
    }
}

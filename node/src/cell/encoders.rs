//! Reads the keys for the format of an encoder: in section `encoders`, and in `feedback` of an axis.

use super::backends::Context;
use super::names::Section;
use super::scale::Travel;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::axis::Wired;
use lineshaft_core::encoder::{Absolute, Form, Parity, PulseCheck, WordCode};
use lineshaft_core::unit::Dimension;

/// Keys of an absolute encoder, in addition to `steps`.
const ABSOLUTE: [&str; 7] = ["turns", "code", "parity", "omitted", "overflow", "error_correction", "max_step"];
/// Limit that no number of encoder words reaches.
const MOST_WORDS: u64 = 1 << 62;

/// Whether the axis can have a feedback.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reads<'a> {
    /// Virtual axis of that name.
    Nothing(&'a str),
    Something,
}

/// Reads `bits`, or `steps` and its related keys; the default is `usual` bits.
pub(super) fn form(map: &mut Map<'_>, travel: &Travel, usual: u32) -> Option<Form> {
    let bits = map.optional("bits");
    let Some(steps) = map.optional("steps") else {
        let mut is_good = true;
        for key in ABSOLUTE {
            if let Some(value) = map.optional(key) {
                value.refuse(format!("{key} is for an absolute encoder, which has steps"), None);
                is_good = false;
            }
        }
        let bits = bits.map_or(Some(usual), |value| value.integer(1..=64_u32));
        return is_good.then_some(Form::Incremental(bits?));
    };
    if let Some(bits) = &bits {
        bits.refuse("bits is for an incremental encoder; this one has steps", Some("leave it out".to_owned()));
    }
    absolute(map, &steps, travel).filter(|_| bits.is_none()).map(Form::Absolute)
}

fn absolute(map: &mut Map<'_>, given: &Value<'_>, travel: &Travel) -> Option<Absolute> {
    let whole = |value: Option<Value<'_>>, usual: u32, least: u32| match value {
        None => Some(usual),
        Some(value) => value.integer(least..=i32::MAX.cast_unsigned()),
    };
    let yes = |value: Option<Value<'_>>, usual| value.map_or(Some(usual), |value| value.boolean());
    let steps = given.integer(2..=i32::MAX.cast_unsigned());
    let turns = whole(map.optional("turns"), 1, 1);
    let omitted = whole(map.optional("omitted"), 0, 0);
    let codes = [("binary", WordCode::Binary), ("gray", WordCode::Gray)];
    let code = map.optional("code").map_or(Some(WordCode::Binary), |value| value.choice(&codes));
    let parities = [("none", None), ("even", Some(Parity::Even)), ("odd", Some(Parity::Odd))];
    let parity = map.optional("parity").map_or(Some(None), |value| value.choice(&parities));
    let overflow = yes(map.optional("overflow"), true);
    let corrects = yes(map.optional("error_correction"), false);
    let max_step = match map.optional("max_step") {
        None => Some(None),
        Some(value) => increments(&value, travel).map(Some),
    };
    let (steps, turns, omitted) = (steps?, turns?, omitted?);
    let encoder = Absolute {
        steps,
        turns,
        code: code?,
        parity: parity?,
        omitted,
        overflow: overflow?,
        corrects: corrects?,
        max_step: max_step?,
    };
    if !encoder.is_sound() {
        let words = u64::from(steps) * u64::from(turns) + u64::from(omitted);
        given.refuse(
            format!("steps times turns and omitted are {words} words; at most {MOST_WORDS} are possible"),
            None,
        );
        return None;
    }
    Some(encoder)
}

/// Reads key `index`: supervision of the index pulses.
pub(super) fn check(map: &mut Map<'_>, travel: &Travel) -> Option<Option<PulseCheck>> {
    let Some(value) = map.optional("index") else { return Some(None) };
    let is_absolute = map.has("steps");
    let mut map = value.map("index")?;
    let every = map.required("every").and_then(|value| increments(&value, travel));
    let tolerance = map.required("tolerance").and_then(|value| increments(&value, travel));
    map.finish();
    if is_absolute {
        value.refuse("index is for an incremental encoder; this one has steps", Some("leave it out".to_owned()));
        return None;
    }
    Some(Some(PulseCheck { every: every?, tolerance: tolerance? }))
}

/// Reads a positive length as an integer number of increments.
fn increments(value: &Value<'_>, travel: &Travel) -> Option<i64> {
    let kind = travel.any_scale()?.kind().dimension(0);
    let quantity = value.quantity(&[kind, Dimension::Increments(0)], &Allowed::Positive)?;
    let scale =
        if quantity.unit() == lineshaft_core::unit::Unit::INCREMENT { travel.any_scale()? } else { travel.scale? };
    match scale.position(&quantity) {
        Ok(increments) if increments > 0 => Some(increments),
        Ok(_) => {
            value.refuse(format!("{} is `{quantity}`, less than half an increment", value.label()), None);
            None
        }
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}

/// Reads key `feedback` of an axis: an entry of section `encoders`, or the position of its drive.
pub(super) fn feedback<'d>(
    value: Option<&Value<'d>>,
    reads: Reads<'_>,
    travel: &Travel,
    cx: &Context<'d>,
) -> Option<Wired> {
    let Some(value) = value else { return Some(Wired::default()) };
    if let Reads::Nothing(axis) = reads {
        value.refuse(
            format!("feedback is for axes with a drive; axis {axis} is virtual"),
            Some("leave it out".to_owned()),
        );
        return None;
    }
    let mut map = value.map("feedback")?;
    let Some(encoder) = map.optional("encoder") else {
        let form = form(&mut map, travel, 64);
        map.finish();
        return form.map(Wired::Drive);
    };
    map.finish();
    let (_, place) = cx.names.find(&encoder, encoder.text()?, &[Section::Encoders])?;
    u16::try_from(place).ok().map(Wired::Encoder)
}

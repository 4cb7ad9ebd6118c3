//! Reads the keys of section `wf` of an axis that name outputs: those that an open-loop axis switches in addition to
//! its drive.

use super::backends::Context;
use super::names::{Section, UsedOnce, quote};
use crate::document::{Map, Value};
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::drive::SpeedOutputs;

/// Outputs that axes use, by their index in section `io`.
pub(super) type Taken = UsedOnce<u16>;

/// Reads the keys. `refusal` is the reason if the axis switches no outputs.
pub(super) fn read<'d>(
    map: &mut Map<'d>,
    refusal: Option<&str>,
    cx: &Context<'d>,
    io: &[Option<IoConfig>],
    taken: &mut Taken,
) -> Option<SpeedOutputs> {
    let mut output = |key, kind| {
        let Some(value) = map.optional(key) else { return Some(None) };
        if let Some(refusal) = refusal {
            let sentence = format!("{key} is for interface open_loop; {refusal}");
            value.refuse(sentence, Some("leave it out".to_owned()));
            return None;
        }
        place(&value, kind, cx, io, taken).map(Some)
    };
    let (forward, backward) = (output("forward", IoKind::DigitalOutput), output("backward", IoKind::DigitalOutput));
    let (switch, dac) = (output("output", IoKind::DigitalOutput), output("dac", IoKind::AnalogOutput));
    Some(SpeedOutputs { forward: forward?, backward: backward?, output: switch?, dac: dac? })
}

/// Returns the output that a key names.
pub(super) fn place<'d>(
    value: &Value<'d>,
    kind: IoKind,
    cx: &Context<'d>,
    io: &[Option<IoConfig>],
    taken: &mut Taken,
) -> Option<u16> {
    let name = value.text()?;
    let (_, place) = cx.names.find(value, name, &[Section::Io])?;
    // An entry with its own problems may be of any kind.
    let found = io.get(place).and_then(Option::as_ref).map(|entry| entry.kind).filter(|found| *found != kind);
    let (label, name) = (value.label(), quote(name));
    if let Some(found) = found {
        let allowed = if kind == IoKind::AnalogOutput { "an ao" } else { "a do" };
        value.refuse(format!("{label} is {name}, which is {}; {allowed} is allowed", described(found)), None);
        return None;
    }
    let place = u16::try_from(place).ok()?;
    taken.take(place, value, || format!("output {name}")).then_some(place)
}

/// Returns a kind with its article, for messages.
pub(super) fn described(kind: IoKind) -> &'static str {
    match kind {
        IoKind::DigitalInput => "a di",
        IoKind::DigitalOutput => "a do",
        IoKind::AnalogInput => "an ai",
        IoKind::AnalogOutput => "an ao",
    }
}

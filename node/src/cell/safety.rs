//! Reads section `safety`: inputs that must be 1, otherwise axes stop.

use super::backends::Context;
use super::devices;
use super::names::{Section, quote};
use crate::document::{Map, Value};
use lineshaft_core::axis::Safety;
use lineshaft_core::config::{IoConfig, IoKind};

/// Reads the contacts; `io` are the entries of that section.
pub(super) fn read<'d>(value: &Value<'d>, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<Safety> {
    let mut map = value.map("safety")?;
    let estop = input(&mut map, "estop", cx, io);
    let interlock = input(&mut map, "interlock", cx, io);
    map.finish();
    let (estop, interlock) = (estop?, interlock?);
    if estop.is_none() && interlock.is_none() {
        value.refuse("safety names no input; estop, interlock or both are expected".to_owned(), None);
        return None;
    }
    Some(Safety { estop, interlock })
}

/// Returns the index of an input among the digital ones; `Some(None)` if none is named, `None` if it has a problem.
fn input<'d>(map: &mut Map<'d>, key: &'static str, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<Option<u32>> {
    let Some(value) = map.optional(key) else { return Some(None) };
    let place = contact(&value, cx, io)?;
    let is_input = |entry: &&Option<IoConfig>| entry.as_ref().is_some_and(|io| io.kind == IoKind::DigitalInput);
    u32::try_from(io.iter().take(place).filter(is_input).count()).ok().map(Some)
}

/// Returns the index in section `io` of a contact that is 1 in the safe state.
pub(super) fn contact<'d>(value: &Value<'d>, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<usize> {
    let (name, key) = (value.text()?, value.label());
    let (_, place) = cx.names.find(value, name, &[Section::Io])?;
    // An entry with its own problems may be of any kind.
    let Some(entry) = io.get(place).and_then(Option::as_ref) else { return Some(place) };
    if entry.kind != IoKind::DigitalInput {
        value.refuse(
            format!("{key} is {}, which is no di; a di is allowed, which reads 1 while all is well", quote(name)),
            None,
        );
        return None;
    }
    if devices::reads_output(place, cx) {
        let sentence = "reads an output of the machine itself; a di with a backend and an address is allowed";
        value.refuse(format!("{key} is {}, which {sentence}", quote(name)), None);
        return None;
    }
    Some(place)
}

//! Section `safety`: inputs that must read 1, or axes stop.

use super::backends::Context;
use super::devices;
use super::names::{Section, quote};
use crate::document::{Map, Value};
use lineshaft_core::axis::Safety;
use lineshaft_core::config::{IoConfig, IoKind};

/// The contacts; `io` are the entries of that section.
pub(super) fn read<'d>(value: &Value<'d>, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<Safety> {
    let mut map = value.map("safety")?;
    let estop = contact(&mut map, "estop", cx, io);
    let interlock = contact(&mut map, "interlock", cx, io);
    map.finish();
    let (estop, interlock) = (estop?, interlock?);
    if estop.is_none() && interlock.is_none() {
        value.refuse("safety names no input; estop, interlock or both are expected".to_owned(), None);
        return None;
    }
    Some(Safety { estop, interlock })
}

/// The place of an input among the digital ones; nothing where none is named, none where that has a problem.
fn contact<'d>(map: &mut Map<'d>, key: &'static str, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<Option<u32>> {
    let Some(value) = map.optional(key) else { return Some(None) };
    let name = value.text()?;
    let (_, place) = cx.names.find(&value, name, &[Section::Io])?;
    let kind = |entry: &Option<IoConfig>| entry.as_ref().map(|entry| entry.kind);
    // One with problems of its own may be of any kind.
    let found = io.get(place).and_then(kind).filter(|kind| *kind != IoKind::DigitalInput);
    if found.is_some() {
        value.refuse(
            format!("{key} is {}, which is no di; a di is allowed, which reads 1 while all is well", quote(name)),
            None,
        );
        return None;
    }
    if io.get(place).and_then(kind).is_some() && devices::reads_output(place, cx) {
        let sentence = "reads an output of the machine itself; a di with a backend and an address is allowed";
        value.refuse(format!("{key} is {}, which {sentence}", quote(name)), None);
        return None;
    }
    let before = io.iter().take(place).filter(|entry| kind(entry) == Some(IoKind::DigitalInput)).count();
    u32::try_from(before).ok().map(Some)
}

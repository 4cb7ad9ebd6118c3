//! Section `groups`.

use super::axes::is_virtual;
use super::backends::Context;
use super::names::{Entry, Once, Section};
use crate::document::Value;

/// The groups: name, places of the axes.
pub(super) fn read(cx: &Context<'_>) -> Vec<(String, Vec<u16>)> {
    cx.names.section(Section::Groups).iter().map(|entry| (entry.name().to_owned(), axes(entry, cx))).collect()
}

fn axes<'d>(entry: &Entry<'d>, cx: &Context<'d>) -> Vec<u16> {
    let Some(values) = entry.value.list() else { return Vec::new() };
    if values.is_empty() {
        entry.value.refuse(format!("group `{}` is empty; the names of one axis or more are expected", entry.name()), None);
    }
    let mut once = Once::new();
    values.iter().filter_map(|value| axis(value, cx, &mut once)).collect()
}

fn axis<'d>(value: &Value<'d>, cx: &Context<'d>, once: &mut Once<usize>) -> Option<u16> {
    let name = value.text()?;
    let (_, place) = cx.names.find(value, name, &[Section::Axes])?;
    once.take(place, value, || format!("axis `{name}`"));
    if cx.names.section(Section::Axes).get(place).is_some_and(is_virtual) {
        value.refuse(format!("axis `{name}` is virtual; a group has axes with a drive"), None);
    }
    u16::try_from(place).ok()
}

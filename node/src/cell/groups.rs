//! Section `groups`.

use super::backends::Context;
use super::names::{Entry, Once, Section, is_virtual, quote};
use crate::document::Value;

/// The groups: name, places of the axes.
pub(super) fn read(cx: &Context<'_>) -> Vec<(String, Vec<u16>)> {
    cx.names.section(Section::Groups).iter().map(|entry| (entry.name().to_owned(), axes(entry, cx))).collect()
}

fn axes<'d>(entry: &Entry<'d>, cx: &Context<'d>) -> Vec<u16> {
    let Some(values) = entry.value.list() else { return Vec::new() };
    if values.is_empty() {
        let sentence = format!("group {} is empty; the names of one axis or more are expected", entry.quoted());
        entry.value.refuse(sentence, None);
    }
    let mut once = Once::new();
    values.iter().filter_map(|value| axis(value, cx, &mut once)).collect()
}

fn axis<'d>(value: &Value<'d>, cx: &Context<'d>, once: &mut Once<usize>) -> Option<u16> {
    let name = value.text()?;
    let (_, place) = cx.names.find(value, name, &[Section::Axes])?;
    once.take(place, value, || format!("axis {}", quote(name)));
    if cx.names.section(Section::Axes).get(place).is_some_and(is_virtual) {
        value.refuse(format!("axis {} is virtual; a group has axes with a drive", quote(name)), None);
    }
    u16::try_from(place).ok()
}

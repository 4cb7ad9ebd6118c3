//! Section `functions`: no type exists yet, and each is refused by its name. What does not depend on the type is checked:
//! slots, the names of source and sink, and that no axis follows itself.

use super::backends::Context;
use super::names::{Entry, Once, Section, quote};
use crate::document::Value;
use lineshaft_core::config::{IoConfig, IoKind};
use lineshaft_core::unit::excerpt;

/// Readings of an axis that follow from its command.
const OF_COMMAND: [&str; 5] = ["command", "target", "modulo", "turns", "output"];

/// What a function reads, as far as loops are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// The command of an axis.
    Command(usize),
    /// Another function.
    Function(usize),
}

/// A function between its source and its sink.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// Place in the section.
    function: usize,
    source: Option<Source>,
    /// The axis that it moves.
    sink: Option<usize>,
}

/// Checks all functions. `io` are the entries of that section.
pub(super) fn check(cx: &Context<'_>, io: &[Option<IoConfig>]) {
    let entries = cx.names.section(Section::Functions);
    let mut slots = Once::new();
    let links: Vec<_> =
        entries.iter().enumerate().filter_map(|(place, entry)| link(place, entry, cx, io, &mut slots)).collect();
    refuse_loops(&links, cx);
}

/// The function's part of a loop; none without a slot of its own, so that there are never more than there are slots.
fn link<'d>(
    function: usize,
    entry: &Entry<'d>,
    cx: &Context<'d>,
    io: &[Option<IoConfig>],
    slots: &mut Once<u8>,
) -> Option<Link> {
    let mut map = entry.value.map(format!("function `{}`", entry.name()))?;
    let slot = map.required("slot").and_then(|value| {
        let slot = value.integer(0..=63_u8)?;
        slots.take(slot, &value, || format!("slot {slot}")).then_some(slot)
    });
    if let Some(value) = map.required("type")
        && let Some(kind) = value.text()
    {
        value.refuse(format!("function type {} does not exist yet", excerpt(kind)), None);
    }
    let source = map.optional("source").and_then(|value| source(&value, cx));
    let sink = map.optional("sink").and_then(|value| sink(&value, cx, io));
    // The other keys belong to the type.
    map.rest();
    map.finish();
    slot.map(|_| Link { function, source, sink })
}

fn source<'d>(value: &Value<'d>, cx: &Context<'d>) -> Option<Source> {
    let text = value.text()?;
    let (object, part) = text.split_once('.').unwrap_or((text, "command"));
    if object == "machine" {
        return None;
    }
    let readable = [Section::Axes, Section::Encoders, Section::Io, Section::Memory, Section::Functions];
    match cx.names.find(value, object, &readable)? {
        (Section::Axes, axis) if OF_COMMAND.contains(&part.split('.').next()?) => Some(Source::Command(axis)),
        (Section::Functions, function) => Some(Source::Function(function)),
        _ => None,
    }
}

fn sink<'d>(value: &Value<'d>, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<usize> {
    let text = value.text()?;
    if text == "none" {
        return None;
    }
    match cx.names.find(value, text, &[Section::Axes, Section::Memory, Section::Io])? {
        (Section::Axes, axis) => Some(axis),
        (Section::Io, place) => {
            let kind = io.get(place).and_then(Option::as_ref).map(|io| io.kind);
            if kind.is_some_and(|kind| kind != IoKind::AnalogOutput) {
                let allowed = "an axis, a memory cell, an ao or none is allowed";
                value.refuse(format!("sink is {}, which is no ao; {allowed}", quote(text)), None);
            }
            None
        }
        _ => None,
    }
}

/// Refuses every function that closes a loop of axes that follow each other's commands.
fn refuse_loops(links: &[Link], cx: &Context<'_>) {
    let axes = cx.names.section(Section::Axes);
    let name = |axis: usize| excerpt(axes.get(axis).map_or("", Entry::name));
    // Leader and follower, of the functions so far that close no loop.
    let mut follows: Vec<(usize, usize)> = Vec::new();
    for link in links {
        let (Some(leader), Some(follower)) = (leader(link, links), link.sink) else { continue };
        let Some(path) = path(&follows, follower, leader) else {
            follows.push((leader, follower));
            continue;
        };
        let names: Vec<_> = path.into_iter().chain([follower]).map(name).collect();
        let sentence = format!("axes follow each other's commands in a loop: {}", names.join(" -> "));
        let hint = format!("follow `{}.actual`", name(leader));
        if let Some(entry) = cx.names.section(Section::Functions).get(link.function) {
            entry.key.refuse(sentence, Some(hint));
        }
    }
}

/// The axis whose command reaches a function, itself or through other functions.
fn leader(link: &Link, links: &[Link]) -> Option<usize> {
    let mut source = link.source?;
    // Functions that read each other in a circle lead to no axis.
    for _ in 0..=links.len() {
        match source {
            Source::Command(axis) => return Some(axis),
            Source::Function(function) => source = links.iter().find(|link| link.function == function)?.source?,
        }
    }
    None
}

/// A way from one axis to another along the followers, both included.
fn path(follows: &[(usize, usize)], from: usize, to: usize) -> Option<Vec<usize>> {
    let mut reached = vec![(from, None)];
    let mut next = 0;
    while let Some(&(axis, _)) = reached.get(next) {
        if axis == to {
            let mut path = vec![axis];
            let mut before = reached[next].1;
            while let Some(place) = before {
                let (axis, earlier): (usize, Option<usize>) = reached[place];
                path.push(axis);
                before = earlier;
            }
            path.reverse();
            return Some(path);
        }
        for &(_, follower) in follows.iter().filter(|(leader, _)| *leader == axis) {
            if reached.iter().all(|(axis, _)| *axis != follower) {
                reached.push((follower, Some(next)));
            }
        }
        next += 1;
    }
    None
}

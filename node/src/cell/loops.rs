//! Axes that would follow each other's commands through functions.
//!
//! Refuses  each function that closes such a loop, with the axes of it; a reading that is no command makes none

use super::backends::Context;
use super::names::{Entry, Section};
use lineshaft_core::unit::excerpt;

/// What a function reads, as far as loops are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reads {
    /// The command of an axis.
    Command(usize),
    /// Another function, by its place in the file.
    Function(usize),
}

/// A function between its source and its sink.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// Place in the section.
    pub function: usize,
    pub source: Option<Reads>,
    /// The axis that it moves.
    pub sink: Option<usize>,
}

/// Refuses every function that closes a loop of axes that follow each other's commands.
pub(super) fn refuse_loops(links: &[Link], cx: &Context<'_>) {
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
            Reads::Command(axis) => return Some(axis),
            Reads::Function(function) => source = links.iter().find(|link| link.function == function)?.source?,
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

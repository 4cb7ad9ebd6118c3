//! Axes that would follow each other's commands, through functions and masters, too.
//!
//! Refuses  each function that closes such a loop, with the axes of it; a reading that is no command makes none

use super::backends::Context;
use super::names::{Entry, Section};
use lineshaft_core::object::Leader;
use lineshaft_core::unit::excerpt;

/// What is read, as far as loops are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reads {
    /// The command of an axis.
    Command(usize),
    /// Another function, by its place in the file.
    Function(usize),
    /// A master of several.
    Master(usize),
}

impl Reads {
    /// Of a leader; sinks by the places of their functions in the file.
    pub(super) fn of(leader: Leader) -> Option<Self> {
        match leader {
            Leader::AxisCommand(axis) => Some(Self::Command(axis.into())),
            Leader::Sink(function) => Some(Self::Function(function.into())),
            Leader::Sum(master) => Some(Self::Master(master.into())),
            // Whom the virtual master follows is told while the machine runs.
            Leader::AxisActual(_) | Leader::Encoder(_) | Leader::Simulated(_) | Leader::Virtual => None,
        }
    }
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

/// What functions and masters read.
#[derive(Debug, Default)]
pub(super) struct Chains {
    pub links: Vec<Link>,
    /// By master.
    pub masters: Vec<Vec<Reads>>,
}

impl Chains {
    /// The axes whose commands reach whoever reads that, itself or through functions and masters.
    pub(super) fn leaders(&self, reads: Reads) -> Vec<usize> {
        let (mut axes, mut reached, mut next) = (Vec::new(), vec![reads], 0);
        // What reads itself in a circle is looked at once.
        while let Some(reads) = reached.get(next).copied() {
            next += 1;
            let found: Vec<Reads> = match reads {
                Reads::Command(axis) => {
                    axes.push(axis);
                    continue;
                }
                Reads::Function(function) => {
                    let link = self.links.iter().find(|link| link.function == function);
                    link.and_then(|link| link.source).into_iter().collect()
                }
                Reads::Master(master) => self.masters.get(master).cloned().unwrap_or_default(),
            };
            let new: Vec<Reads> = found.into_iter().filter(|reads| !reached.contains(reads)).collect();
            reached.extend(new);
        }
        axes
    }
}

/// Refuses every function that closes a loop of axes that follow each other's commands.
pub(super) fn refuse_loops(chains: &Chains, cx: &Context<'_>) {
    let mut follows = Follows::default();
    for link in &chains.links {
        let (Some(source), Some(follower)) = (link.source, link.sink) else { continue };
        if let Some((chain, hint)) = follows.take(follower, &chains.leaders(source), cx)
            && let Some(entry) = cx.names.section(Section::Functions).get(link.function)
        {
            entry.key.refuse(format!("axes follow each other's commands in a loop: {chain}"), Some(hint));
        }
    }
}

/// Leader and follower, of those so far that close no loop.
#[derive(Debug, Default)]
pub(super) struct Follows(Vec<(usize, usize)>);

impl Follows {
    /// Takes the leaders of an axis; else the loop that the first one closes, and what could be followed instead.
    pub(super) fn take(&mut self, follower: usize, leaders: &[usize], cx: &Context<'_>) -> Option<(String, String)> {
        let axes = cx.names.section(Section::Axes);
        let name = |axis: usize| excerpt(axes.get(axis).map_or("", Entry::name));
        let found = leaders.iter().find_map(|leader| Some((path(&self.0, follower, *leader)?, *leader)));
        let Some((path, leader)) = found else {
            self.0.extend(leaders.iter().map(|leader| (*leader, follower)));
            return None;
        };
        let names: Vec<_> = path.into_iter().chain([follower]).map(name).collect();
        Some((names.join(" -> "), format!("follow `{}.actual`", name(leader))))
    }
}

/// A way from one to another along the followers, both included.
pub(super) fn path(follows: &[(usize, usize)], from: usize, to: usize) -> Option<Vec<usize>> {
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

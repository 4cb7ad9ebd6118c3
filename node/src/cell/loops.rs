//! Finds axes that would follow each other's commands in a loop, also through functions and masters.
//!
//! Refuses  each function that closes such a loop, with the axes of the loop; reading a value other than a command
//!          makes no loop

use super::backends::Context;
use super::names::{Entry, Section};
use lineshaft_core::object::Leader;
use lineshaft_core::unit::excerpt;

/// Source that is read, for the search of loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reads {
    /// Command of an axis.
    Command(usize),
    /// Another function, by its index in the file.
    Function(usize),
    /// A master that is a sum.
    Master(usize),
}

impl Reads {
    /// Returns the source of a leader; sinks have the indices of their functions in the file.
    pub(super) fn of(leader: Leader) -> Option<Self> {
        match leader {
            Leader::AxisCommand(axis) => Some(Self::Command(axis.into())),
            Leader::Sink(function) => Some(Self::Function(function.into())),
            Leader::Sum(master) => Some(Self::Master(master.into())),
            // The leader of the virtual master is selected at run time.
            Leader::AxisActual(_) | Leader::Encoder(_) | Leader::Simulated(_) | Leader::Virtual => None,
        }
    }
}

/// A function between its source and its sink.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// Index in the section.
    pub function: usize,
    pub source: Option<Reads>,
    /// Axis that it moves.
    pub sink: Option<usize>,
}

/// Sources of functions and masters.
#[derive(Debug, Default)]
pub(super) struct Chains {
    pub links: Vec<Link>,
    /// Sources by master.
    pub masters: Vec<Vec<Reads>>,
}

impl Chains {
    /// Returns the axes whose commands reach a reader of `reads`, directly or through functions and masters.
    pub(super) fn leaders(&self, reads: Reads) -> Vec<usize> {
        let (mut axes, mut reached, mut next) = (Vec::new(), vec![reads], 0);
        // In a loop, each source is visited once.
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

/// Pairs of leader and follower that close no loop so far.
#[derive(Debug, Default)]
pub(super) struct Follows(Vec<(usize, usize)>);

impl Follows {
    /// Adds the leaders of an axis. If one of them closes a loop, returns the first such loop and a hint which source
    /// to use instead.
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

/// Returns the path from one axis to another along the followers, both included.
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

//! Finds slots that read their own output in a loop.

use super::links::{Port, mirrors, ports};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::object::Object;
use std::collections::{BTreeMap, BTreeSet};

/// A link from a written object to its reader.
#[derive(Clone, Copy, Debug)]
struct Link {
    from: Object,
    to: Object,
    is_late: bool,
}

/// All links, by the object at which they begin.
type Links = BTreeMap<Object, Vec<Link>>;

/// Returns a message for each loop: the shortest one through each slot that is the lowest of a loop.
pub fn loops(machine: &MachineConfig) -> Vec<String> {
    let links = links(machine);
    (0..machine.slots.len() as u16).filter_map(|slot| circle(machine, &links, slot)).collect()
}

fn links(machine: &MachineConfig) -> Links {
    let mirrored = mirrors(machine).map(|(from, to)| Link { from, to, is_late: true });
    let slots = (0..machine.slots.len() as u16).flat_map(|slot| {
        let own = Object::Function(slot);
        let moves = ports(machine, slot).into_iter().filter(|port| !port.is_watched);
        moves.map(move |Port { object, is_output, is_late, .. }| {
            let (from, to) = if is_output { (own, object) } else { (object, own) };
            Link { from, to, is_late }
        })
    });
    let mut links = Links::new();
    mirrored.chain(slots).for_each(|link| links.entry(link.from).or_default().push(link));
    links
}

/// Returns the shortest path from a slot back to itself through higher slots only.
fn circle(machine: &MachineConfig, links: &Links, slot: u16) -> Option<String> {
    let start = Object::Function(slot);
    // Links reached so far, each with the index of the previous one.
    let mut reached: Vec<(Link, Option<usize>)> = Vec::new();
    let mut known = BTreeSet::new();
    let mut next = 0;
    let mut from = Some((start, None));
    while let Some((object, before)) = from {
        for link in links.get(&object).into_iter().flatten() {
            if link.to == start {
                return Some(sentence(machine, &way(&reached, *link, before)));
            }
            let is_lower = matches!(link.to, Object::Function(other) if other < slot);
            if !is_lower && known.insert(link.to) {
                reached.push((*link, before));
            }
        }
        from = reached.get(next).map(|(link, _)| (link.to, Some(next)));
        next += 1;
    }
    None
}

fn way(reached: &[(Link, Option<usize>)], last: Link, mut before: Option<usize>) -> Vec<Link> {
    let mut way = vec![last];
    while let Some((link, earlier)) = before.and_then(|place| reached.get(place)) {
        way.push(*link);
        before = *earlier;
    }
    way.reverse();
    way
}

fn sentence(machine: &MachineConfig, way: &[Link]) -> String {
    let name = |object| machine.name(object);
    let first = way.first().map_or("", |link| name(link.from));
    let names: Vec<&str> = std::iter::once(first).chain(way.iter().map(|link| name(link.to))).collect();
    let seen = |link: &Link| {
        let what = match link.from {
            _ if link.is_late => "as of the cycle before",
            Object::Axis(_) => "as its drive tells it",
            _ => return None,
        };
        Some(format!("{} sees {} {what}", name(link.to), name(link.from)))
    };
    let late: Vec<String> = way.iter().filter_map(seen).collect();
    format!("function {first} reads itself: {}; {}", names.join(" -> "), late.join(", "))
}

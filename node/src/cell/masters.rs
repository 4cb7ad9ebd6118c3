//! Reads section `masters`: leaders that are sums of other leaders.
//!
//! Refuses  a master without members, members that cannot lead or occur twice, too many of them, masters that are
//!          members of each other in a loop

use super::backends::Context;
use super::loops::{Reads, path};
use super::names::{Entry, Section, UsedOnce, limit, quote};
use crate::document::Value;
use lineshaft_core::config::{MAX_MASTERS, MAX_MEMBERS, SlotConfig, SumConfig, sums};
use lineshaft_core::object::{Leader, VIRTUAL_MASTER};
use lineshaft_core::sync::{MOST_TERMS, Sum};
use lineshaft_core::unit::excerpt;

/// Sections of possible members.
const MEMBERS: [Section; 4] = [Section::Axes, Section::Encoders, Section::Functions, Section::Masters];

/// The masters that could be read; sinks have the indices of their functions in the file.
pub(super) struct Read {
    pub sums: Vec<Option<SumConfig>>,
    /// Sources of each master, for the search of loops.
    pub reads: Vec<Vec<Reads>>,
}

/// A member and its location.
type Member<'d> = (Leader, Value<'d>);

/// Reads all masters.
pub(super) fn read(cx: &Context<'_>) -> Read {
    let entries = cx.names.section(Section::Masters);
    limit(entries, MAX_MASTERS);
    let (mut read, mut members) = (Read { sums: Vec::new(), reads: Vec::new() }, Vec::new());
    for entry in entries {
        let (sum, of_it) = master(entry, cx);
        read.reads.push(of_it.iter().filter_map(|(member, _)| Reads::of(*member)).collect());
        read.sums.push(sum);
        members.push(of_it);
    }
    refuse_loops(&members, entries);
    let all: Vec<SumConfig> = read.sums.iter().map(|sum| sum.clone().unwrap_or_default()).collect();
    let is_large = |sum: &Option<Sum>| sum.as_ref().is_some_and(|sum| !sum.is_small());
    // Masters that contain it are too large as well; one problem is enough.
    if let Some(entry) = sums(&all).iter().position(is_large).and_then(|place| entries.get(place)) {
        let sentence = format!("has more than {MOST_TERMS} leaders, itself and through other masters");
        entry.key.refuse(format!("master {} {sentence}", entry.quoted()), None);
    }
    read
}

/// Replaces indices of functions in the file by those of slots, which are sorted by number now.
pub(super) fn settle(masters: &mut [Option<SumConfig>], slots: &[Option<SlotConfig>], cx: &Context<'_>) {
    let functions = cx.names.section(Section::Functions);
    for member in masters.iter_mut().flatten().flat_map(|sum| sum.add.iter_mut().chain(&mut sum.subtract)) {
        if let Leader::Sink(file) = member
            && let Some(name) = functions.get(usize::from(*file)).map(Entry::name)
            && let Some(slot) = slots.iter().position(|slot| slot.as_ref().is_some_and(|slot| slot.name == name))
        {
            *file = slot as u16;
        }
    }
}

fn master<'d>(entry: &Entry<'d>, cx: &Context<'d>) -> (Option<SumConfig>, Vec<Member<'d>>) {
    let Some(mut map) = entry.value.map(format!("master {}", entry.quoted())) else { return (None, Vec::new()) };
    let sides = ["add", "subtract"].map(|key| map.optional(key).map_or(Some(Vec::new()), |value| value.list()));
    map.finish();
    let [Some(add), Some(subtract)] = sides else { return (None, Vec::new()) };
    let count = add.len() + subtract.len();
    if count == 0 {
        let expected = "names of one leader or more are expected in add or subtract";
        entry.value.refuse(format!("master {} adds up nothing; {expected}", entry.quoted()), None);
        return (None, Vec::new());
    }
    if let Some(beyond) = add.iter().chain(&subtract).nth(MAX_MEMBERS) {
        let sentence = format!("master {} has {count} members; at most {MAX_MEMBERS} are possible", entry.quoted());
        beyond.refuse(sentence, None);
        return (None, Vec::new());
    }
    let mut once = UsedOnce::new();
    let [add, subtract] = [add, subtract].map(|side| -> Vec<Member<'d>> {
        side.into_iter().filter_map(|value| Some((member(&value, cx, &mut once)?, value))).collect()
    });
    let leaders = |side: &[Member<'_>]| side.iter().map(|(leader, _)| *leader).collect();
    let sum = SumConfig { name: entry.name().to_owned(), add: leaders(&add), subtract: leaders(&subtract) };
    let is_good = add.len() + subtract.len() == count;
    (is_good.then_some(sum), add.into_iter().chain(subtract).collect())
}

fn member<'d>(value: &Value<'d>, cx: &Context<'d>, once: &mut UsedOnce<Leader>) -> Option<Leader> {
    let leader = leader(value, cx, &MEMBERS)?;
    if let Some(first) = once.place(&leader) {
        let what = quote(value.peek().unwrap_or_default());
        let sentence = format!("{what} is a member already, at {}:{}; a member stands once", first.line, first.col);
        value.refuse(sentence, None);
        return None;
    }
    once.take(leader, value, String::new).then_some(leader)
}

/// Finds a leader in these sections: an axis (its command), `axis.command`, `axis.actual`, an encoder, `function.sink`
/// by its index in the file, a master, or the virtual master.
pub(super) fn leader<'d>(value: &Value<'d>, cx: &Context<'d>, sections: &[Section]) -> Option<Leader> {
    let text = value.text()?;
    if text == VIRTUAL_MASTER {
        return Some(Leader::Virtual);
    }
    let (object, part) = text.split_once('.').unwrap_or((text, ""));
    let (section, place) = cx.names.find(value, object, sections)?;
    let place = u16::try_from(place).ok()?;
    match (section, part) {
        (Section::Axes, "" | "command") => Some(Leader::AxisCommand(place)),
        (Section::Axes, "actual") => Some(Leader::AxisActual(place)),
        (Section::Encoders, "") => Some(Leader::Encoder(place)),
        (Section::Functions, "sink") => Some(Leader::Sink(place)),
        (Section::Masters, "") => Some(Leader::Sum(place)),
        _ => {
            let name = excerpt(object);
            let allowed = match section {
                Section::Axes => format!("`{name}`, `{name}.command` or `{name}.actual`"),
                Section::Functions => format!("`{name}.sink`"),
                _ => format!("`{name}`"),
            };
            value.refuse(format!("{} is {}; {allowed} is allowed", value.label(), quote(text)), None);
            None
        }
    }
}

/// Refuses every member that closes a loop of masters.
fn refuse_loops(members: &[Vec<Member<'_>>], entries: &[Entry<'_>]) {
    let name = |master: usize| excerpt(entries.get(master).map_or("", Entry::name));
    // Pairs of member and master that close no loop so far.
    let mut follows: Vec<(usize, usize)> = Vec::new();
    for (master, members) in members.iter().enumerate() {
        for (leader, value) in members {
            let Leader::Sum(member) = *leader else { continue };
            let Some(path) = path(&follows, master, member.into()) else {
                follows.push((member.into(), master));
                continue;
            };
            let names: Vec<_> = path.into_iter().chain([master]).map(name).collect();
            value.refuse(format!("masters are members of each other in a loop: {}", names.join(" -> ")), None);
        }
    }
}

//! Keys `amc` of an axis: what its reference selector is wired to, and whether its parameters fit the axis.

use super::backends::Context;
use super::names::{Entry, Section, is_virtual, quote};
use super::parameters::{Given, Sections};
use crate::document::{Map, Value};
use lineshaft_core::config::{AxisConfig, IoConfig, IoKind, MachineConfig, TableConfig};
use lineshaft_core::object::{Leader, Object};
use lineshaft_core::text::sentence;
use lineshaft_core::unit::excerpt;
use lineshaft_core::vocabulary::{self, amc::Wiring};

/// The axes that follow the command of another one: follower, leader and where that stands.
pub(super) type Masters<'d> = Vec<(usize, usize, Value<'d>)>;

/// The keys `master`, `freeze` and `cam` of the axis at place `axis`; `io` and `tables` are the entries of these sections.
pub(super) fn wiring<'d>(
    axis: usize,
    map: &mut Map<'d>,
    sections: &mut Sections<'d>,
    cx: &Context<'d>,
    (io, tables): (&[Option<IoConfig>], &[Option<TableConfig>]),
    masters: &mut Masters<'d>,
) -> Option<vocabulary::Wiring> {
    let master = sections.value(map, "amc.master").map(|value| {
        let leader = leader(&value, cx)?;
        if let Some(leader) = leader.commanded() {
            masters.push((axis, usize::from(leader), value));
        }
        Some(leader)
    });
    let freeze = sections.value(map, "amc.freeze").map(|value| freeze(&value, cx, io));
    let cam = sections.value(map, "amc.cam").map(|value| {
        let (_, place) = cx.names.find(&value, value.text()?, &[Section::Tables])?;
        // One that could not be read has its own problem.
        let table = &tables.get(place)?.as_ref()?.table;
        if let Err(error) = table.cam() {
            value.refuse(format!("cam is {}: {error}", quote(value.text()?)), None);
            return None;
        }
        u16::try_from(place).ok()
    });
    Some(vocabulary::Wiring { amc: Wiring { master: lift(master)?, freeze: lift(freeze)?, cam: lift(cam)? } })
}

/// Nothing where nothing stands; none where what stands has a problem.
fn lift<T>(given: Option<Option<T>>) -> Option<Option<T>> {
    given.map_or(Some(None), |value| value.map(Some))
}

/// An axis (its command), `axis.command`, `axis.actual`, an encoder.
fn leader<'d>(value: &Value<'d>, cx: &Context<'d>) -> Option<Leader> {
    let text = value.text()?;
    let (object, part) = text.split_once('.').unwrap_or((text, ""));
    let (section, place) = cx.names.find(value, object, &[Section::Axes, Section::Encoders])?;
    let place = u16::try_from(place).ok()?;
    match (section, part) {
        (Section::Axes, "" | "command") => Some(Leader::AxisCommand(place)),
        (Section::Axes, "actual") => Some(Leader::AxisActual(place)),
        (Section::Encoders, "") => Some(Leader::Encoder(place)),
        _ => {
            let name = excerpt(object);
            let allowed = if section == Section::Axes {
                format!("`{name}`, `{name}.command` or `{name}.actual`")
            } else {
                format!("`{name}`")
            };
            value.refuse(format!("master is {}; {allowed} is allowed", quote(text)), None);
            None
        }
    }
}

/// What latches: an input with `latch: true`, an encoder, an axis with a drive.
fn freeze<'d>(value: &Value<'d>, cx: &Context<'d>, io: &[Option<IoConfig>]) -> Option<Object> {
    let text = value.text()?;
    let (section, place) = cx.names.find(value, text, &[Section::Io, Section::Encoders, Section::Axes])?;
    let index = u16::try_from(place).ok()?;
    let refuse = |sentence: &str, hint: Option<&str>| {
        value.refuse(format!("freeze is {}, which {sentence}", quote(text)), hint.map(str::to_owned));
        None
    };
    match section {
        Section::Io => match io.get(place)?.as_ref()? {
            IoConfig { latch: true, .. } => Some(Object::Io(index)),
            IoConfig { kind: IoKind::DigitalInput, .. } => refuse("does not latch", Some("give it `latch: true`")),
            _ => refuse("is no digital input", None),
        },
        Section::Encoders => Some(Object::Encoder(index)),
        _ if is_virtual(cx.names.section(Section::Axes).get(place)?) => refuse("has no drive to latch", None),
        _ => Some(Object::Axis(index)),
    }
}

/// Refuses parameters that do not fit the axis, each at its place.
pub(super) fn check(config: &AxisConfig, given: &Given<'_>, cycle_ns: Option<u64>) {
    const TRIGGER: &str = "amc.reference_select_trigger";
    if let Some((_, value)) = given.iter().find(|(key, _)| *key == TRIGGER) {
        value.refuse(format!("{TRIGGER} is 0 when the machine starts"), Some("leave it out".to_owned()));
    }
    let Some(cycle_ns) = cycle_ns else { return };
    let machine = MachineConfig { cycle_ns, axes: vec![config.clone()], ..MachineConfig::default() };
    let Err(problem) = vocabulary::check(&config.parameters, &machine.setting(config)) else { return };
    let text = sentence(&problem.refusal(Object::Axis(0)).event(0), &machine);
    let text = text.split_once(": ").map_or(text.as_str(), |(_, text)| text);
    if let Some((_, value)) = given.iter().find(|(key, _)| *key == problem.key()) {
        value.refuse(text, None);
    }
}

/// Refuses every master that closes a loop: a selector may couple its axis at any time.
pub(super) fn refuse_loops(masters: &Masters<'_>, cx: &Context<'_>) {
    let axes = cx.names.section(Section::Axes);
    let name = |axis: usize| excerpt(axes.get(axis).map_or("", Entry::name));
    for (place, (follower, leader, value)) in masters.iter().enumerate() {
        // Each axis has one master: the chain from the leader on, through those that were good so far.
        let earlier = masters.get(..place).unwrap_or_default();
        let next = |axis: &usize| earlier.iter().find(|(follower, ..)| follower == axis).map(|(_, leader, _)| *leader);
        let chain: Vec<usize> = std::iter::successors(Some(*leader), next).take(masters.len() + 1).collect();
        if let Some(end) = chain.iter().position(|axis| axis == follower) {
            let names: Vec<_> = chain[..=end].iter().rev().chain([follower]).map(|axis| name(*axis)).collect();
            let sentence = format!("reference selectors follow each other's axes in a loop: {}", names.join(" -> "));
            value.refuse(sentence, Some(format!("follow `{}.actual`", name(*leader))));
        }
    }
}

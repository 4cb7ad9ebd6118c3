//! Reads the keys `amc` of an axis: the wiring of its reference selector, and a check of its parameters.

use super::backends::Context;
use super::loops::{Chains, Follows, Reads};
use super::masters::leader;
use super::names::{Section, is_virtual, quote};
use super::parameters::{Given, Sections};
use crate::document::{Map, Value};
use lineshaft_core::config::{AxisConfig, IoConfig, IoKind, MachineConfig, TableConfig};
use lineshaft_core::object::Object;
use lineshaft_core::text::message;
use lineshaft_core::vocabulary::{self, amc::Wiring};

/// Axes that may follow a leader's command: follower, source that it reads, and location of that key in the file.
pub(super) type Masters<'d> = Vec<(usize, Reads, Value<'d>)>;

/// Sections with possible leaders of a selector.
const LEADERS: [Section; 3] = [Section::Axes, Section::Encoders, Section::Masters];

/// Reads the keys `master`, `freeze` and `cam` of the axis with index `axis`; `io` and `tables` are the entries of
/// these sections.
pub(super) fn wiring<'d>(
    axis: usize,
    map: &mut Map<'d>,
    sections: &mut Sections<'d>,
    cx: &Context<'d>,
    (io, tables): (&[Option<IoConfig>], &[Option<TableConfig>]),
    masters: &mut Masters<'d>,
) -> Option<vocabulary::Wiring> {
    let master = sections.value(map, "amc.master").map(|value| {
        let leader = leader(&value, cx, &LEADERS)?;
        if let Some(reads) = Reads::of(leader) {
            masters.push((axis, reads, value));
        }
        Some(leader)
    });
    let freeze = sections.value(map, "amc.freeze").map(|value| freeze(&value, cx, io));
    let cam = sections.value(map, "amc.cam").map(|value| {
        let (_, place) = cx.names.find(&value, value.text()?, &[Section::Tables])?;
        // A table that could not be read has its own problem.
        let table = &tables.get(place)?.as_ref()?.table;
        if let Err(error) = table.cam() {
            value.refuse(format!("cam is {}: {error}", quote(value.text()?)), None);
            return None;
        }
        u16::try_from(place).ok()
    });
    Some(vocabulary::Wiring { amc: Wiring { master: lift(master)?, freeze: lift(freeze)?, cam: lift(cam)? } })
}

/// Converts an absent key to `Some(None)`, and a key with a problem to `None`.
fn lift<T>(given: Option<Option<T>>) -> Option<Option<T>> {
    given.map_or(Some(None), |value| value.map(Some))
}

/// Returns the latch source: an input with `latch: true`, an encoder, or an axis with a drive.
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

/// Refuses parameters that do not fit the axis, each at its location.
pub(super) fn check(config: &AxisConfig, given: &Given<'_>, cycle_ns: Option<u64>) {
    const TRIGGER: &str = "amc.reference_select_trigger";
    if let Some((_, value)) = given.iter().find(|(key, _)| *key == TRIGGER) {
        value.refuse(format!("{TRIGGER} is 0 when the machine starts"), Some("leave it out".to_owned()));
    }
    let Some(cycle_ns) = cycle_ns else { return };
    let machine = MachineConfig { cycle_ns, axes: vec![config.clone()], ..MachineConfig::default() };
    let Err(problem) = vocabulary::check(&config.parameters, &machine.setting(config)) else { return };
    let text = message(&problem.refusal(Object::Axis(0)).event(0), &machine);
    let text = text.split_once(": ").map_or(text.as_str(), |(_, text)| text);
    if let Some((_, value)) = given.iter().find(|(key, _)| *key == problem.key()) {
        value.refuse(text, None);
    }
}

/// Refuses every master that closes a loop, because a selector may couple its axis at any time.
pub(super) fn refuse_loops(masters: &Masters<'_>, chains: &Chains, cx: &Context<'_>) {
    let mut follows = Follows::default();
    for (follower, reads, value) in masters {
        if let Some((chain, hint)) = follows.take(*follower, &chains.leaders(*reads), cx) {
            value.refuse(format!("reference selectors follow each other's axes in a loop: {chain}"), Some(hint));
        }
    }
}

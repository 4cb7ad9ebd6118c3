//! Presets: limits of another controller that are narrower than those of a cell, for users who migrate functions from
//! or to it.
//!
//! Refuses  in preset amkasyn: a cycle off its grid, calls with too large intervals, slots above 15, axes after the
//!          eighth, more encoders, analog outputs and words than it addresses, sinks and lines that its types do not
//!          have, tables longer than a data block, too many cams
//! Source   AMK-GEN-01, -04, -08, -11; AMK-SRC-02 to -07; AMK-SNK-01 to -05; AMK-INIT-03, -07 to -09; AMK-BCOM-17 to -27; AMK-CTX-12 to -21;
//!          AMK-CAM-31, -33, -44; AMK-BINEA-11, -27; AMK-SIDIFF-09, -17; AMK-DIGDREH-04; AMK-IMES-01, -07; AMK-FGEN-09, -12; AMK-REGL-08, -19; AMK-EPOS-44, -50, -57, -58

use super::backends::{Context, Hardware};
use super::devices::memory_name;
use super::names::{Entry, Section, quote};
use crate::document::Value;
use lineshaft_core::config::{Line, MachineConfig, MemoryKind, SinkConfig, SlotConfig, SourceConfig};
use lineshaft_core::drive::ObjectAddress;
use lineshaft_core::function::{Kind, MarkSource, OnAxisError, TYPES, Width};
use lineshaft_core::object::{Leader, Object};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// Grid of cycle times, and unit of the cycle in a parameter set, in ns.
const GRID_NS: u64 = 500_000;
/// Maximum cycle time of a parameter set, in ns.
const LONGEST_NS: u64 = 131 * GRID_NS;
/// Time between two calls of an epos that searches its reference, in ns.
const SEARCH_NS: RangeInclusive<u64> = 2 * GRID_NS..=18 * GRID_NS;
const LAST_SLOT: u16 = 15;
/// Number of axes: AW1 to AW8.
const AXES: u16 = 8;
/// Number of AZ messages, which have pulse inputs.
const ENCODERS: usize = 4;
/// Number of analog outputs: AA1 to AA4.
const ANALOG_OUTPUTS: usize = 4;
/// Number of bytes of flags, as words and double words.
const BYTES: usize = 128;
/// Number of cams of all tracks.
const CAMS: i64 = 56;
/// Number of lines of a byte.
const BITS: u16 = 8;

/// Controller whose limits a cell must not exceed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Fast functions of AMKASYN.
    Amkasyn,
}

/// Refuses a value that exceeds the preset.
fn refuse(value: &Value<'_>, is: &str, allowed: &str) {
    value.refuse(format!("{is}; preset amkasyn allows {allowed}"), None);
}

/// Returns the value of a key in an entry.
fn at<'d>(entry: &Entry<'d>, key: &str) -> Option<Value<'d>> {
    let mut entries = entry.value.entries()?.into_iter();
    entries.find(|(known, _)| known.peek() == Some(key)).map(|(_, value)| value)
}

/// Returns the values of a list in an entry.
fn items<'d>(entry: &Entry<'d>, key: &str) -> Vec<Value<'d>> {
    at(entry, key).and_then(|value| value.list()).unwrap_or_default()
}

/// Returns the label and the text of a value.
fn named(value: &Value<'_>) -> String {
    format!("{} is {}", value.label(), quote(value.peek().unwrap_or_default()))
}

/// Refuses values beyond the preset in a cell without other problems. `terminals` are the locations of section `io`.
pub(super) fn hold(
    preset: Preset,
    cx: &Context<'_>,
    machine: &MachineConfig,
    terminals: &[Option<Hardware>],
    cycle: &Value<'_>,
) {
    let Preset::Amkasyn = preset;
    if !machine.cycle_ns.is_multiple_of(GRID_NS) {
        refuse(cycle, &named(cycle), "multiples of 0.5 ms");
    }
    let mut holder = Holder { cx, machine, terminals, used: Used::default() };
    for entry in cx.names.section(Section::Functions) {
        if let Some(slot) = machine.slots.iter().find(|slot| slot.name == entry.name()) {
            holder.function(entry, slot);
        }
    }
}

/// Objects that functions have used so far, by index in their section.
#[derive(Default)]
struct Used {
    encoders: BTreeSet<usize>,
    outputs: BTreeSet<usize>,
    /// Memory cells, with their sizes in bytes.
    memory: BTreeMap<usize, usize>,
}

/// Counts a use of a limited resource.
fn count(value: &Value<'_>, used: &mut BTreeSet<usize>, place: usize, most: usize, what: &str) {
    if used.insert(place) && used.len() > most {
        refuse(
            value,
            &format!("{}, {what} {} of those that functions use", named(value), used.len()),
            &most.to_string(),
        );
    }
}

fn refuse_master(value: &Value<'_>) {
    refuse(value, &format!("{}, a master of several", named(value)), "an axis, an encoder or a sink");
}

struct Holder<'a, 'd> {
    cx: &'a Context<'d>,
    machine: &'a MachineConfig,
    terminals: &'a [Option<Hardware>],
    used: Used,
}

impl Holder<'_, '_> {
    fn function(&mut self, entry: &Entry<'_>, slot: &SlotConfig) {
        let row = slot.kind.description();
        if let Some(value) = at(entry, "slot").filter(|_| slot.number > LAST_SLOT) {
            refuse(&value, &format!("slot is {}", slot.number), &format!("0..{LAST_SLOT}"));
        }
        if let Some(value) = at(entry, "type").filter(|_| row.runs_program) {
            refuse(
                &value,
                &format!("type is {}, a WebAssembly module", row.name),
                "programs of AWL, which run there alone",
            );
        }
        self.calls(entry, slot);
        if let Some(value) = at(entry, "source") {
            self.source(&value, &slot.source);
        }
        if let Some(value) = at(entry, "sink") {
            self.sink(&value, slot);
        }
        for (key, name) in row.words.iter().zip(&slot.words) {
            let Some((name, value)) = name.as_ref().zip(at(entry, key)) else { continue };
            // w2 of a regl is a double word.
            let kind = if *key == "src2_addr" { MemoryKind::I32 } else { MemoryKind::I16 };
            match self.machine.memory.iter().position(|memory| memory.name == *name) {
                Some(place) => self.memory(&value, place, &[kind]),
                None => refuse(&value, &named(&value), &format!("a memory cell of type {}", memory_name(kind))),
            }
        }
        let marks = at(entry, "inputs").filter(|_| row.marks == MarkSource::Input && slot.inputs[0].is_some());
        if let Some(value) = marks {
            refuse(&value, "inputs has an entry", &format!("none for type {}", row.name));
        }
        self.lines(&items(entry, "inputs"), &slot.inputs, "di");
        self.lines(&items(entry, "outputs"), &slot.outputs, "do");
        self.tables(entry, slot);
        cams(entry, slot);
        if let Some(value) = at(entry, "on_axis_error").filter(|_| slot.on_axis_error == OnAxisError::Reset) {
            refuse(&value, &named(&value), "run");
        }
    }

    /// Checks the time between two calls: for types whose parameter set has at most 131 units of it, and for the search
    /// of a reference.
    fn calls(&self, entry: &Entry<'_>, slot: &SlotConfig) {
        let cycle_ns = self.machine.cycle_ns;
        if let Some(value) = at(entry, "cycle_factor")
            && slot.kind.description().amk.sets_call_time
            && slot.call_ns(cycle_ns) > LONGEST_NS
        {
            let allowed = format!("1..{} for type {}", LONGEST_NS / cycle_ns.max(1), slot.kind.name());
            refuse(&value, &format!("cycle_factor is {}", slot.factor), &allowed);
        }
        if let Some(value) = at(entry, "ba")
            && is_search(slot)
            && !SEARCH_NS.contains(&slot.call_ns(cycle_ns))
        {
            let ms = |ns: u64| format!("{} ms", ns as f64 / 1e6);
            let (low, high) = (ms(*SEARCH_NS.start()), ms(*SEARCH_NS.end()));
            let is =
                format!("{}, substitutional, with {} between two calls", named(&value), ms(slot.call_ns(cycle_ns)));
            refuse(&value, &is, &format!("{low} to {high}"));
        }
    }

    fn axis(value: &Value<'_>, place: usize) {
        if place >= usize::from(AXES) {
            refuse(value, &format!("{}, axis {} of the cell", named(value), place + 1), &format!("axes 1..{AXES}"));
        }
    }

    fn encoder(&mut self, value: &Value<'_>, place: usize) {
        count(value, &mut self.used.encoders, place, ENCODERS, "encoder");
    }

    fn source(&mut self, value: &Value<'_>, source: &SourceConfig) {
        match source {
            SourceConfig::Lead(Leader::AxisCommand(place) | Leader::AxisActual(place)) => {
                Self::axis(value, usize::from(*place));
            }
            SourceConfig::Lead(Leader::Encoder(place)) => self.encoder(value, usize::from(*place)),
            SourceConfig::Signal(name) => {
                let object = name.split_once('.').map_or(name.as_str(), |(object, _)| object);
                if let Some(place) = self.machine.axes.iter().position(|axis| axis.name == object) {
                    Self::axis(value, place);
                } else if let Some(place) = self.machine.encoders.iter().position(|encoder| encoder.name == object) {
                    self.encoder(value, place);
                } else if let Some(place) = self.machine.memory.iter().position(|memory| memory.name == object) {
                    self.memory(value, place, &[MemoryKind::I16, MemoryKind::I32]);
                } else if self.machine.masters.iter().any(|master| master.name == object) {
                    refuse_master(value);
                }
            }
            SourceConfig::Lead(Leader::Sum(_)) => refuse_master(value),
            SourceConfig::Lead(Leader::Virtual) => {
                refuse(value, &format!("{}, the virtual master", named(value)), "an axis, an encoder or a sink");
            }
            SourceConfig::None | SourceConfig::Lead(Leader::Sink(_) | Leader::Simulated(_)) => {}
        }
    }

    fn sink(&mut self, value: &Value<'_>, slot: &SlotConfig) {
        match slot.sink {
            SinkConfig::None => {}
            SinkConfig::Axis(place) => Self::axis(value, usize::from(place)),
            SinkConfig::Memory(place) => {
                let kind = |width: &Width| if *width == Width::W16 { MemoryKind::I16 } else { MemoryKind::I32 };
                let kinds: Vec<_> = slot.kind.description().amk.sink_widths.iter().map(kind).collect();
                self.memory(value, usize::from(place), &kinds);
            }
            SinkConfig::Output(place) if slot.kind.description().amk.writes_analog => {
                count(value, &mut self.used.outputs, usize::from(place), ANALOG_OUTPUTS, "ao");
            }
            SinkConfig::Output(_) => {
                let is = format!("{}, an ao, for type {}", named(value), slot.kind.name());
                let types: Vec<_> = TYPES.iter().filter(|row| row.amk.writes_analog).map(|row| row.name).collect();
                refuse(value, &is, &format!("it for types {}", types.join(" and ")));
            }
        }
    }

    /// Checks a flag word or double word.
    fn memory(&mut self, value: &Value<'_>, place: usize, kinds: &[MemoryKind]) {
        let Some(kind) = self.machine.memory.get(place).map(|memory| memory.kind) else { return };
        if !kinds.contains(&kind) {
            let allowed: Vec<_> = kinds.iter().copied().map(memory_name).collect();
            refuse(value, &format!("{}, of type {}", named(value), memory_name(kind)), &allowed.join(", "));
            return;
        }
        let is_new = self.used.memory.insert(place, if kind == MemoryKind::I16 { 2 } else { 4 }).is_none();
        let bytes = self.used.memory.values().sum::<usize>();
        if is_new && bytes > BYTES {
            let is = format!("{}, with which functions use {bytes} bytes of memory", named(value));
            refuse(value, &is, &BYTES.to_string());
        }
    }

    /// Checks the lines E1.. or A1..: they must be consecutive bits of one byte, the first one at any bit.
    fn lines(&self, items: &[Value<'_>], lines: &[Option<Line>], what: &str) {
        let mut first: Option<(&Value<'_>, Object, u16)> = None;
        for ((item, line), n) in items.iter().zip(lines).zip(0_u16..) {
            let Some(Line { object, inverted }) = *line else { continue };
            if inverted {
                refuse(item, &format!("{}.inverted is true", item.label()), "false");
            }
            let label = item.label();
            let Some((first, of_first, from)) = first else {
                if let Some(at) = self.terminal(object).filter(|at| at.address.channel % BITS < n) {
                    let is = format!(
                        "{label} is at address {}, bit {} of its byte",
                        self.address(at),
                        at.address.channel % BITS
                    );
                    refuse(item, &is, &format!("bits {n}..{}", BITS - 1));
                }
                first = Some((item, object, n));
                continue;
            };
            let first = first.label();
            if matches!(object, Object::Io(_)) != matches!(of_first, Object::Io(_)) {
                let (is, other) =
                    if matches!(object, Object::Io(_)) { (what, "memory cell") } else { ("memory cell", what) };
                refuse(item, &format!("{label} is a {is}"), &format!("a {other}, as {first} is one"));
                continue;
            }
            let Some((at, of_first)) = self.terminal(object).zip(self.terminal(of_first)) else { continue };
            let channel = of_first.address.channel.saturating_add(n - from);
            let expected = Hardware { address: ObjectAddress { channel, ..of_first.address }, ..of_first };
            let is = format!("{label} is at address {}", self.address(at));
            if channel / BITS != of_first.address.channel / BITS {
                refuse(item, &is, &format!("none: the byte of {first} ends before it"));
            } else if at != expected {
                let allowed = format!("address {} beside {first}", self.address(expected));
                refuse(item, &is, &allowed);
            }
        }
    }

    /// Returns the location of a line; `None` for memory, and for an input that reads an output.
    fn terminal(&self, object: Object) -> Option<Hardware> {
        let Object::Io(place) = object else { return None };
        self.terminals.get(usize::from(place)).copied().flatten()
    }

    /// Returns an address in the format of the cell, with its backend.
    fn address(&self, at: Hardware) -> String {
        let name = self.cx.names.section(Section::Backends).get(at.backend).map_or("", Entry::name);
        let backend = self.cx.backend(at);
        let channel = backend.map_or_else(String::new, |backend| backend.channel_text(at.address));
        format!("{channel} of `{name}`")
    }

    fn tables(&self, entry: &Entry<'_>, slot: &SlotConfig) {
        for (item, place) in items(entry, "tables").iter().zip(slot.tables) {
            let Some(place) = place.map(usize::from) else { continue };
            let most = slot.kind.description().amk.table_words;
            let words = self.machine.tables.get(place).map_or(0, |table| table.table.len());
            if words > most {
                refuse(item, &format!("{}, which has {words} words", named(item)), &format!("1..{most}"));
            }
        }
    }
}

/// Whether a function is an epos that searches its reference (bit 1 of `ba`).
fn is_search(slot: &SlotConfig) -> bool {
    let ba = slot.kind.description().find("ba").and_then(|(_, place)| slot.values.get(place));
    slot.kind == Kind::Epos && ba.is_some_and(|ba| ba >> 1 & 1 == 1)
}

/// Checks the number of cams of each track, and of all tracks.
fn cams(entry: &Entry<'_>, slot: &SlotConfig) {
    let Some((field, place)) = slot.kind.description().find("cams") else { return };
    let tracks = slot.values.get(place..place + field.count).unwrap_or_default();
    let mut is_good = true;
    for (item, cams) in items(entry, "cams").iter().zip(tracks).filter(|(_, cams)| **cams > CAMS) {
        refuse(item, &format!("{} is {cams}", item.label()), &format!("0..{CAMS}"));
        is_good = false;
    }
    let all = tracks.iter().sum::<i64>();
    if let Some(value) = at(entry, "cams").filter(|_| is_good && all > CAMS) {
        refuse(&value, &format!("cams has {all} in all tracks"), &CAMS.to_string());
    }
}

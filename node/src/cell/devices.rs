//! Sections `io`, `memory` and `encoders`.

use super::backends::{Context, address};
use super::brake;
use super::encoders;
use super::names::{Entry, Once, Section, limit};
use super::scale::Travel;
use crate::document::Value;
use lineshaft_core::config::{EncoderConfig, FilterConfig, IoConfig, IoKind, MemoryConfig, MemoryKind};

/// How many entries a section of these may have.
const MOST: usize = u16::MAX as usize;
/// Integers up to here are exact in an f64.
const EXACT: i64 = 1 << 53;

/// Kinds of inputs and outputs by their names.
const IO_KINDS: [(&str, IoKind); 4] = [
    ("di", IoKind::DigitalInput),
    ("do", IoKind::DigitalOutput),
    ("ai", IoKind::AnalogInput),
    ("ao", IoKind::AnalogOutput),
];

const MEMORY_KINDS: [(&str, MemoryKind); 5] = [
    ("i16", MemoryKind::I16),
    ("i32", MemoryKind::I32),
    ("i64", MemoryKind::I64),
    ("f64", MemoryKind::F64),
    ("bit", MemoryKind::Bit),
];

/// The entries of `io`, none where one has problems, and the filters of digital inputs.
pub(super) fn io(cx: &Context<'_>) -> (Vec<Option<IoConfig>>, Vec<FilterConfig>) {
    let entries = cx.names.section(Section::Io);
    limit(entries, MOST);
    let mut taken = Once::new();
    let (mut filters, mut inputs) = (Vec::new(), 0);
    let read = |entry| {
        let (io, filter) = one_io(entry, cx, &mut taken)?;
        filters.extend(filter.filter(|time_ns| *time_ns > 0).map(|time_ns| FilterConfig { input: inputs, time_ns }));
        inputs += usize::from(io.kind == IoKind::DigitalInput);
        Some(io)
    };
    (entries.iter().map(read).collect(), filters)
}

fn one_io<'d>(
    entry: &Entry<'d>,
    cx: &Context<'d>,
    taken: &mut Once<(usize, &'static str, u16)>,
) -> Option<(IoConfig, Option<u64>)> {
    let mut map = entry.value.map(format!("io `{}`", entry.name()))?;
    let kind = map.required("type").and_then(|value| value.choice(&IO_KINDS.map(|(name, kind)| (name, (name, kind)))));
    let address = address(&mut map, &cx.names, kind.map(|(name, _)| name), taken);
    let latch = map.optional("latch").map_or(Some(false), |value| latch(&value, kind));
    let filter = map.optional("filter").map_or(Some(None), |value| filter(&value, kind).map(Some));
    map.finish();
    address?;
    Some((IoConfig { name: entry.name().to_owned(), kind: kind?.1, latch: latch? }, filter?))
}

fn latch(value: &Value<'_>, kind: Option<(&str, IoKind)>) -> Option<bool> {
    let latch = value.boolean()?;
    match kind {
        Some((name, kind)) if latch && kind != IoKind::DigitalInput => {
            value.refuse(format!("latch is true for type {name}; only the edges of a di are latched"), None);
            None
        }
        _ => Some(latch),
    }
}

/// How long a level must stand before it counts (ns).
fn filter(value: &Value<'_>, kind: Option<(&str, IoKind)>) -> Option<u64> {
    let time = brake::time(value)?;
    match kind {
        Some((name, kind)) if kind != IoKind::DigitalInput => {
            value.refuse(format!("filter is for type di; this one is {name}"), Some("leave it out".to_owned()));
            None
        }
        _ => Some(time),
    }
}

/// The entries of `memory`, none where one has problems.
pub(super) fn memory(cx: &Context<'_>) -> Vec<Option<MemoryConfig>> {
    let entries = cx.names.section(Section::Memory);
    limit(entries, MOST);
    entries.iter().map(one_memory).collect()
}

fn one_memory(entry: &Entry<'_>) -> Option<MemoryConfig> {
    let mut map = entry.value.map(format!("memory `{}`", entry.name()))?;
    let kind = map.required("type").and_then(|value| value.choice(&MEMORY_KINDS));
    let initial = map.optional("initial").map_or(Some(0.0), |value| initial(&value, kind?));
    map.finish();
    Some(MemoryConfig { name: entry.name().to_owned(), kind: kind?, initial: initial? })
}

fn initial(value: &Value<'_>, kind: MemoryKind) -> Option<f64> {
    match kind {
        MemoryKind::I16 => value.integer(i16::MIN..=i16::MAX).map(f64::from),
        MemoryKind::I32 => value.integer(i32::MIN..=i32::MAX).map(f64::from),
        // The core keeps it as f64, so beyond 2^53 it would not be what was written.
        MemoryKind::I64 => value.integer(-EXACT..=EXACT).map(|whole| whole as f64),
        MemoryKind::F64 => value.number(f64::NEG_INFINITY..=f64::INFINITY),
        MemoryKind::Bit => value.integer(0..=1_u8).map(f64::from),
    }
}

/// The entries of `encoders`, none where one has problems.
pub(super) fn encoders(cx: &Context<'_>) -> Vec<Option<EncoderConfig>> {
    let entries = cx.names.section(Section::Encoders);
    limit(entries, MOST);
    let mut taken = Once::new();
    entries.iter().map(|entry| one_encoder(entry, cx, &mut taken)).collect()
}

fn one_encoder<'d>(
    entry: &Entry<'d>,
    cx: &Context<'d>,
    taken: &mut Once<(usize, &'static str, u16)>,
) -> Option<EncoderConfig> {
    let mut map = entry.value.map(format!("encoder `{}`", entry.name()))?;
    let address = address(&mut map, &cx.names, Some("encoder"), taken);
    let travel = Travel::read(&mut map);
    let check = encoders::check(&mut map, &travel);
    let form = encoders::form(&mut map, &travel, 32);
    map.finish();
    address?;
    Some(EncoderConfig { name: entry.name().to_owned(), form: form?, check: check?, scale: travel.scale? })
}

//! Reads sections `io`, `memory` and `encoders`.

use super::backends::{Backend, Context, ENCODER, Hardware, TakenAddresses, WITH_FULL_SCALES, address};
use super::encoders;
use super::marks;
use super::names::{Entry, Section, UsedOnce, limit, quote};
use super::scale::Travel;
use super::terminals::{CellTerminal, FULL_SCALE, Kind};
use super::times::time;
use super::wiring;
use crate::document::{Allowed, Map, Value};
use lineshaft_core::config::{
    EncoderConfig, FilterConfig, FullScale, IoConfig, IoKind, MemoryConfig, MemoryKind, VirtualInput,
};
use lineshaft_core::encoder::Form;
use lineshaft_core::unit::Dimension;

/// Maximum number of entries of these sections.
const MOST: usize = u16::MAX as usize;
/// Integers up to this one are exact in an f64.
const EXACT: i64 = 1 << 53;

/// Kinds of inputs and outputs by name.
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

/// Returns the name of a kind of memory.
pub(super) fn memory_name(kind: MemoryKind) -> &'static str {
    MEMORY_KINDS.iter().find(|(_, known)| *known == kind).map_or("", |(name, _)| name)
}

/// Section `io`.
pub(super) struct Io<'d> {
    /// Entries; `None` for one with problems.
    pub entries: Vec<Option<IoConfig>>,
    /// Location of each entry; `None` if it has none or has problems.
    pub terminals: Vec<Option<Hardware>>,
    /// Entries at the devices of backends that have devices.
    pub at_devices: Vec<CellTerminal>,
    pub filters: Vec<FilterConfig>,
    pub virtual_inputs: Vec<VirtualInput>,
    /// Full scales of analog entries that have one.
    pub full_scales: Vec<FullScale>,
    /// Printed marks that digital inputs detect in the simulation.
    pub marks: Vec<marks::Given<'d>>,
}

/// One entry of the section.
struct Terminal<'d> {
    io: IoConfig,
    /// Filter time, in ns.
    filter: Option<u64>,
    /// Output that it reads, by its index in the section.
    output: Option<(u16, Value<'d>)>,
    at: Option<Hardware>,
    full_scale: f64,
    sim: Option<Value<'d>>,
}

/// Reads the entries of `io`, the filters of digital inputs, and the inputs that read an output.
pub(super) fn io<'d>(cx: &Context<'d>) -> Io<'d> {
    let entries = cx.names.section(Section::Io);
    limit(entries, MOST);
    let mut taken = UsedOnce::new();
    let (mut filters, mut outputs, mut full_scales, mut inputs) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let mut marks = Vec::new();
    let mut terminals = Vec::with_capacity(entries.len());
    let (mut at_devices, mut counts) = (Vec::new(), [0; IO_KINDS.len()]);
    let read = entries.iter().enumerate().map(|(place, entry)| {
        let terminal = one_io(entry, cx, &mut taken);
        terminals.push(terminal.as_ref().and_then(|terminal| terminal.at));
        let Terminal { io, filter, output, at, full_scale, sim } = terminal?;
        let count = IO_KINDS.iter().zip(&mut counts).find(|((_, kind), _)| *kind == io.kind).map(|(_, count)| count)?;
        let index = std::mem::replace(count, *count + 1);
        at_devices.extend(at.filter(|at| is_at_device(*at, cx)).map(|at| CellTerminal {
            name: io.name.clone(),
            place: entry.value.place(),
            kind: Kind::Io { kind: io.kind, full_scale },
            at,
            index,
        }));
        let is_analog = matches!(io.kind, IoKind::AnalogInput | IoKind::AnalogOutput);
        if is_analog && at.and_then(|at| cx.backend(at)).is_some_and(Backend::has_full_scales) {
            full_scales.extend(u16::try_from(place).map(|entry| FullScale { entry, volts: full_scale }));
        }
        filters.extend(filter.filter(|time_ns| *time_ns > 0).map(|time_ns| FilterConfig { input: inputs, time_ns }));
        outputs.extend(output.map(|(output, value)| (VirtualInput { input: inputs, output }, value)));
        marks.extend(sim.map(|value| marks::Given { value, input: inputs, latch: io.latch, at }));
        inputs += usize::from(io.kind == IoKind::DigitalInput);
        Some(io)
    });
    let entries: Vec<_> = read.collect();
    let virtual_inputs = outputs.into_iter().map(|(read, value)| {
        let kind = entries.get(usize::from(read.output)).and_then(Option::as_ref).map(|io| io.kind);
        if let Some(kind) = kind.filter(|kind| *kind != IoKind::DigitalOutput) {
            let (name, kind) = (quote(value.peek().unwrap_or_default()), wiring::described(kind));
            value.refuse(format!("output is {name}, which is {kind}; a do is allowed"), None);
        }
        read
    });
    Io { virtual_inputs: virtual_inputs.collect(), entries, terminals, at_devices, filters, marks, full_scales }
}

fn is_at_device(at: Hardware, cx: &Context<'_>) -> bool {
    cx.backend(at).is_some_and(|backend| backend.devices().is_some())
}

/// Whether an entry without problems reads an output.
pub(super) fn reads_output(place: usize, cx: &Context<'_>) -> bool {
    let map = cx.names.section(Section::Io).get(place).and_then(|entry| entry.value.map("io"));
    map.is_some_and(|map| map.has("output"))
}

fn one_io<'d>(entry: &Entry<'d>, cx: &Context<'d>, taken: &mut TakenAddresses) -> Option<Terminal<'d>> {
    let mut map = entry.value.map(format!("io `{}`", entry.name()))?;
    let kind = map.required("type").and_then(|value| value.choice(&IO_KINDS.map(|(name, kind)| (name, (name, kind)))));
    let reads_output = map.has("output");
    let wire = if reads_output {
        output(&mut map, kind, cx).map(|output| (Some(output), None))
    } else {
        map.allow(&["output"]);
        address(&mut map, cx, kind.map(|(name, _)| name), taken).map(|at| (None, Some(at)))
    };
    let at = wire.as_ref().and_then(|(_, at)| *at);
    let backend = at.and_then(|at| cx.backend(at));
    let latch = map.optional("latch").map_or(Some(false), |value| latch(&value, kind, reads_output, backend));
    // Without a backend it is unknown whether the key is allowed.
    let may_have = backend.is_none_or(Backend::has_full_scales);
    let full_scale = map
        .optional("full_scale")
        .map_or(Some(FULL_SCALE), |value| full_scale(&value, kind.map(|(_, kind)| kind), may_have));
    let filter = map.optional("filter").map_or(Some(None), |value| filter(&value, kind).map(Some));
    let sim = map.optional("sim").map_or(Some(None), |value| sim(value, kind).map(Some));
    map.finish();
    let io = IoConfig { name: entry.name().to_owned(), kind: kind?.1, latch: latch? };
    let (output, at) = wire?;
    Some(Terminal { io, filter: filter?, output, at, full_scale: full_scale?, sim: sim? })
}

/// Reads the voltage of an analog channel at its full scale (7FFFh), in V.
fn full_scale(value: &Value<'_>, kind: Option<IoKind>, may_have: bool) -> Option<f64> {
    if !may_have || matches!(kind, Some(IoKind::DigitalInput | IoKind::DigitalOutput)) {
        let sentence = format!("full_scale is for an ai or ao on {WITH_FULL_SCALES}");
        value.refuse(sentence, Some("leave it out".to_owned()));
        return None;
    }
    Some(value.quantity(&[Dimension::Voltage], &Allowed::Positive)?.si())
}

/// Returns the output that an input without a terminal reads, by its index in the section.
fn output<'d>(map: &mut Map<'d>, kind: Option<(&str, IoKind)>, cx: &Context<'d>) -> Option<(u16, Value<'d>)> {
    let value = map.optional("output")?;
    let wires = ["backend", "address"].map(|key| (key, map.optional(key)));
    if let Some((name, _)) = kind.filter(|(_, kind)| *kind != IoKind::DigitalInput) {
        value.refuse(format!("output is for type di; this one is {name}"), Some("leave it out".to_owned()));
        return None;
    }
    for (key, wire) in wires {
        if let Some(wire) = wire {
            let sentence = format!("{key} is for an input with a terminal; this one reads an output");
            wire.refuse(sentence, Some("leave it out".to_owned()));
        }
    }
    let (_, place) = cx.names.find(&value, value.text()?, &[Section::Io])?;
    Some((u16::try_from(place).ok()?, value))
}

fn latch(
    value: &Value<'_>,
    kind: Option<(&str, IoKind)>,
    reads_output: bool,
    backend: Option<Backend>,
) -> Option<bool> {
    let latch = value.boolean()?;
    if let Some(backend) = backend.filter(|backend| latch && !backend.latches_inputs()) {
        let medium = backend.medium();
        let sentence =
            format!("latch is true for an input on {medium}, which reports no edges; the touch probes of a drive do");
        value.refuse(sentence, None);
        return None;
    }
    match kind {
        _ if latch && reads_output => {
            value.refuse(
                "latch is true for an input that reads an output; only the edges at a terminal are latched",
                None,
            );
            None
        }
        Some((name, kind)) if latch && kind != IoKind::DigitalInput => {
            value.refuse(format!("latch is true for type {name}; only the edges of a di are latched"), None);
            None
        }
        _ => Some(latch),
    }
}

/// Reads the minimum duration of a level before it is accepted, in ns.
fn filter(value: &Value<'_>, kind: Option<(&str, IoKind)>) -> Option<u64> {
    let time = time(value)?;
    match kind {
        Some((name, kind)) if kind != IoKind::DigitalInput => {
            value.refuse(format!("filter is for type di; this one is {name}"), Some("leave it out".to_owned()));
            None
        }
        _ => Some(time),
    }
}

/// Returns the simulation of an input; it is read after axes and encoders are known.
fn sim<'d>(value: Value<'d>, kind: Option<(&str, IoKind)>) -> Option<Value<'d>> {
    match kind {
        Some((name, kind)) if kind != IoKind::DigitalInput => {
            value.refuse(format!("sim is for type di; this one is {name}"), Some("leave it out".to_owned()));
            None
        }
        _ => Some(value),
    }
}

/// Reads the entries of `memory`; `None` for one with problems.
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
        // The core stores it as f64, which is not exact beyond 2^53.
        MemoryKind::I64 => value.integer(-EXACT..=EXACT).map(|whole| whole as f64),
        MemoryKind::F64 => value.number(f64::NEG_INFINITY..=f64::INFINITY),
        MemoryKind::Bit => value.integer(0..=1_u8).map(f64::from),
    }
}

/// Reads the entries of `encoders` and their locations, `None` for one with problems; and those that are at devices.
pub(super) fn encoders(cx: &Context<'_>) -> (Vec<Option<EncoderConfig>>, Vec<Option<Hardware>>, Vec<CellTerminal>) {
    let entries = cx.names.section(Section::Encoders);
    limit(entries, MOST);
    let mut taken = UsedOnce::new();
    let read: Vec<_> = entries.iter().map(|entry| one_encoder(entry, cx, &mut taken)).collect();
    let terminals = entries.iter().zip(&read).enumerate().filter_map(|(index, (entry, read))| {
        let (config, at) = read.as_ref().filter(|(_, at)| is_at_device(*at, cx))?;
        Some(CellTerminal {
            name: config.name.clone(),
            place: entry.value.place(),
            kind: Kind::Encoder { is_absolute: matches!(config.form, Form::Absolute(_)) },
            at: *at,
            index,
        })
    });
    let terminals = terminals.collect();
    let (configs, at) = read.into_iter().map(Option::unzip).unzip();
    (configs, at, terminals)
}

fn one_encoder<'d>(
    entry: &Entry<'d>,
    cx: &Context<'d>,
    taken: &mut TakenAddresses,
) -> Option<(EncoderConfig, Hardware)> {
    let mut map = entry.value.map(format!("encoder `{}`", entry.name()))?;
    let address = address(&mut map, cx, Some(ENCODER), taken);
    let travel = Travel::read(&mut map);
    let without_index = address.and_then(|at| cx.backend(at)).filter(|backend| !backend.reports_index());
    if let Some((backend, index)) = without_index.and_then(|backend| Some((backend, map.optional("index")?))) {
        let sentence = format!("index is for an encoder that reports its pulses; one on {} does not", backend.medium());
        index.refuse(sentence, Some("leave it out".to_owned()));
    }
    let check = encoders::check(&mut map, &travel);
    let form = encoders::form(&mut map, &travel, 32);
    map.finish();
    let config = EncoderConfig { name: entry.name().to_owned(), form: form?, check: check?, scale: travel.scale? };
    Some((config, address?))
}

//! Reads section `functions`: slots, their sources and sinks, and the values of their type.
//!
//! Refuses  unknown types, slots that occur twice, names that the type cannot use, two writers of one object (with both
//!          locations), values outside of their fields, axes that follow each other's commands in a loop

use super::backends::Context;
use super::loops::{Chains, Link, Reads, refuse_loops};
use super::names::{Entry, Section, UsedOnce, hint, quote};
use super::wiring::Taken;
use crate::document::{Map, Value};
use lineshaft_core::config::{
    IoConfig, IoKind, Line, MAX_FACTOR, MAX_FUEL, MAX_SLOTS, MAX_WINDOW, MachineConfig, MemoryConfig, MemoryKind,
    SinkConfig, SlotConfig, SourceConfig, TableConfig,
};
use lineshaft_core::drive::Interface;
use lineshaft_core::function::{
    Description, Field, Kind, LINES, MemorySize, OnAxisError, Quantity, Requirement, TYPES, Width,
};
use lineshaft_core::object::{Leader, Object, VIRTUAL_MASTER};
use lineshaft_core::signal::Directory;
use lineshaft_core::unit::{ScaleKind, excerpt};

/// Sections whose entries have signals.
const READABLE: [Section; 6] =
    [Section::Axes, Section::Encoders, Section::Io, Section::Memory, Section::Functions, Section::Masters];

/// Signals of an axis that follow from its command.
const OF_COMMAND: [&str; 5] = ["command", "target", "modulo", "turns", "output"];

/// A source that may be any signal; it is checked once all signals are known.
pub(super) struct Open<'d> {
    value: Value<'d>,
    name: String,
}

/// The slots that could be read.
#[derive(Default)]
pub(super) struct Read<'d> {
    pub slots: Vec<Option<SlotConfig>>,
    pub open: Vec<Open<'d>>,
    pub chains: Chains,
}

/// Objects that functions may use, in addition to names.
#[derive(Clone, Copy)]
pub(super) struct Objects<'a> {
    pub io: &'a [Option<IoConfig>],
    pub memory: &'a [Option<MemoryConfig>],
    pub tables: &'a [Option<TableConfig>],
}

/// Slots and written objects that functions have used so far.
struct Claims<'t> {
    slots: UsedOnce<u16>,
    written: Written<'t>,
}

/// Objects that functions write.
struct Written<'t> {
    /// Entries of section `io` with a writer; there may be only one.
    outputs: &'t mut Taken,
    axes: UsedOnce<u16>,
    memory: UsedOnce<u16>,
}

impl Written<'_> {
    /// Registers an object as written; its name is in `value`.
    fn take(&mut self, object: Object, value: &Value<'_>) -> bool {
        let name = || quote(value.peek().unwrap_or_default());
        let writer = || format!("what writes {}", name());
        match object {
            Object::Io(place) => self.outputs.take(place, value, || format!("output {}", name())),
            Object::Axis(place) => self.axes.take(place, value, writer),
            Object::Memory(place) => self.memory.take(place, value, writer),
            _ => true,
        }
    }
}

/// Reads the width in keys `source_bits` and `sink_bits`.
fn bits(value: &Value<'_>) -> Option<Width> {
    let text = value.text()?;
    let bits = if value.is_integer() { value.integer(i128::MIN..=i128::MAX) } else { None };
    let width = bits.and_then(|bits| u32::try_from(bits).ok()).and_then(Width::of);
    if width.is_none() {
        value.refuse(format!("{} is {}; 16, 32, 64 is allowed", value.label(), excerpt(text)), None);
    }
    width
}

/// Reads all functions; the slots are sorted by number. `outputs` are the entries of `io` that have a writer, `masters`
/// the sources of each master.
pub(super) fn read<'d>(
    cx: &Context<'d>,
    objects: Objects<'_>,
    outputs: &mut Taken,
    masters: Vec<Vec<Reads>>,
) -> Read<'d> {
    let entries = cx.names.section(Section::Functions);
    let written = Written { outputs, axes: UsedOnce::new(), memory: UsedOnce::new() };
    let mut taken = Claims { slots: UsedOnce::new(), written };
    let (mut read, mut numbers) = (Read::default(), Vec::new());
    read.chains.masters = masters;
    for (place, entry) in entries.iter().enumerate() {
        let (slot, link, number) = function(place, entry, cx, objects, (&mut taken, &mut read.open));
        read.chains.links.extend(link);
        numbers.push(number.unwrap_or(u16::MAX));
        read.slots.push(slot);
    }
    refuse_loops(&read.chains, cx);
    sort(&mut read.slots, &numbers);
    read
}

/// Sorts the slots by number, and updates the sinks that they read.
fn sort(slots: &mut Vec<Option<SlotConfig>>, numbers: &[u16]) {
    let mut order: Vec<usize> = (0..slots.len()).collect();
    order.sort_by_key(|place| numbers.get(*place).copied());
    let now = |file: u16| order.iter().position(|place| *place == usize::from(file)).map_or(file, |now| now as u16);
    let mut sorted: Vec<_> = order.iter().map(|place| slots.get_mut(*place).and_then(Option::take)).collect();
    for slot in sorted.iter_mut().flatten() {
        if let SourceConfig::Lead(Leader::Sink(file)) = &mut slot.source {
            *file = now(*file);
        }
    }
    *slots = sorted;
}

/// Refuses sources that are no signal, once everything else is valid.
pub(super) fn check_signals(open: &[Open<'_>], directory: &Directory) {
    for Open { value, name } in open {
        if directory.find(name).is_none() {
            let known = directory.iter().map(|(_, entry)| entry.name.as_str()).collect();
            let hint = hint(name, known).unwrap_or_else(|| "`lineshaft signals CELL` lists them".to_owned());
            value.refuse(format!("{} is {}; no signal has that name", value.label(), quote(name)), Some(hint));
        }
    }
}

/// Refuses axes that no function can move: in open loop, or without a revolution for a speed in rpm.
pub(super) fn check_axes(cx: &Context<'_>, machine: &MachineConfig) {
    for slot in &machine.slots {
        let SinkConfig::Axis(place) = slot.sink else { continue };
        let Some(axis) = machine.axes.get(usize::from(place)) else { continue };
        let entry = cx.names.section(Section::Functions).iter().find(|entry| entry.name() == slot.name);
        let Some(entry) = entry else { continue };
        let is_speed = slot.quantity == Quantity::Speed;
        if is_speed && axis.scale.kind() != ScaleKind::Rotary {
            let (kind, axis) = (slot.kind.name(), quote(&axis.name));
            entry.key.refuse(format!("type {kind} gives a speed in rpm; its sink {axis} is no rotary axis"), None);
        }
        if axis.interface == Interface::OpenLoop {
            let sentence = format!("its sink {} is an axis in open loop, which no function moves", quote(&axis.name));
            entry.key.refuse(sentence, None);
        }
    }
}

/// Refuses copies that would move an axis by a speed as if it were a position, or vice versa, directly or through
/// copies of its sink. A memory cell, an output or another function may get a value of either kind.
pub(super) fn check_quantities(cx: &Context<'_>, machine: &MachineConfig) {
    for (place, slot) in machine.slots.iter().enumerate().filter(|(_, slot)| slot.kind.copies_source(&slot.values)) {
        let SourceConfig::Lead(leader) = slot.source else { continue };
        let carried = machine.carried(&slot.source).filter(|carried| *carried != slot.quantity);
        if let Some(carried) = carried
            && reaches_axis(machine, place)
            && let Some(entry) = cx.names.section(Section::Functions).iter().find(|entry| entry.name() == slot.name)
        {
            let source = machine.signal_of(leader).unwrap_or_default();
            let (quantity, carried) = (slot.quantity.name(), carried.name());
            entry.key.refuse(format!("quantity is {quantity}; its source {} is a {carried}", quote(&source)), None);
        }
    }
}

/// Returns true if a slot moves an axis, directly or through copies of its sink.
fn reaches_axis(machine: &MachineConfig, place: usize) -> bool {
    let (mut reached, mut next) = (vec![place], 0);
    // In a loop of copies, each copy is visited once.
    while let Some(place) = reached.get(next).copied() {
        next += 1;
        if machine.slots.get(place).is_some_and(|slot| matches!(slot.sink, SinkConfig::Axis(_))) {
            return true;
        }
        for (reader, slot) in machine.slots.iter().enumerate() {
            let reads = matches!(slot.source, SourceConfig::Lead(Leader::Sink(read)) if usize::from(read) == place);
            if reads && slot.kind.copies_source(&slot.values) && !reached.contains(&reader) {
                reached.push(reader);
            }
        }
    }
    false
}

/// Reads a function: its slot, its part of a loop, and its number.
#[allow(clippy::type_complexity, reason = "three things that are read in one go")]
fn function<'d>(
    place: usize,
    entry: &Entry<'d>,
    cx: &Context<'d>,
    objects: Objects<'_>,
    (taken, open): (&mut Claims<'_>, &mut Vec<Open<'d>>),
) -> (Option<SlotConfig>, Option<Link>, Option<u16>) {
    let Some(mut map) = entry.value.map(format!("function `{}`", entry.name())) else { return (None, None, None) };
    let number = map.required("slot").and_then(|value| {
        let number = value.integer(0..=(MAX_SLOTS as u16 - 1))?;
        taken.slots.take(number, &value, || format!("slot {number}")).then_some(number)
    });
    let kind = map.required("type").and_then(|value| kind(&value));
    let reader = Reader { cx, objects };
    let source = map.optional("source").map(|value| (reader.source(&value, open), value));
    let sink = map.optional("sink").map(|value| (reader.sink(&value), value));
    let link = Link {
        function: place,
        source: source.as_ref().and_then(|(_, value)| reader.reads(value)),
        sink: match sink.as_ref().and_then(|(sink, _)| *sink) {
            Some(SinkConfig::Axis(axis)) => Some(axis.into()),
            _ => None,
        },
    };
    let link = number.map(|_| link);
    let Some(kind) = kind else {
        // The other keys belong to the type.
        map.rest();
        map.finish();
        return (None, link, number);
    };
    let slot = slot(&mut map, entry, kind, (source, sink), &reader, (taken, open));
    map.finish();
    (slot.zip(number).map(|(slot, number)| SlotConfig { number, ..slot }), link, number)
}

fn kind(value: &Value<'_>) -> Option<Kind> {
    let text = value.text()?;
    if let Some(kind) = Kind::find(text) {
        return Some(kind);
    }
    let names = || TYPES.iter().map(|row| row.name).collect::<Vec<_>>().join(", ");
    let meant = hint(text, TYPES.iter().map(|row| row.name).collect());
    value.refuse(format!("type is {}; {} is allowed", quote(text), names()), meant);
    None
}

/// A given key, with its value if it could be read.
type Given<'d, T> = Option<(Option<T>, Value<'d>)>;

/// Reads the rest of a slot, by its type.
fn slot<'d>(
    map: &mut Map<'d>,
    entry: &Entry<'d>,
    kind: Kind,
    (source, sink): (Given<'d, SourceConfig>, Given<'d, SinkConfig>),
    reader: &Reader<'_, 'd>,
    (taken, open): (&mut Claims<'_>, &mut Vec<Open<'d>>),
) -> Option<SlotConfig> {
    let row = kind.description();
    let mut slot = SlotConfig::new(entry.name().to_owned(), 0, kind);
    let mut is_good = true;
    let mut note = |good: bool| is_good &= good;
    match source {
        Some((read, value)) => {
            // A source that could not be read has one problem already.
            note(read.as_ref().is_some_and(|source| fits_source(&value, source, row)));
            slot.source = read.unwrap_or_default();
        }
        None if row.source == Requirement::Must => {
            map.refuse(format!("function {} has no source; type {} reads one", entry.quoted(), row.name), None);
            note(false);
        }
        None => {}
    }
    match sink {
        Some((read, value)) => {
            note(read.is_some_and(|sink| reader.fits_sink(&value, sink, row)));
            slot.sink = read.unwrap_or_default();
            note(Reader::take_sink(&value, slot.sink, &mut taken.written));
        }
        None if row.sink == Requirement::Must => {
            let hint = Some("`sink: none` keeps the value for other functions".to_owned());
            map.refuse(format!("function {} has no sink; type {} writes one", entry.quoted(), row.name), hint);
            note(false);
        }
        None => {}
    }
    if row.chooses_quantity
        && let Some(value) = map.optional("quantity")
    {
        let quantity = value.choice(&Quantity::ALL);
        note(quantity.is_some());
        slot.quantity = quantity.unwrap_or_default();
    }
    for (key, width) in [("source_bits", &mut slot.source_width), ("sink_bits", &mut slot.sink_width)] {
        if let Some(value) = map.optional(key) {
            match bits(&value) {
                Some(read) => *width = read,
                None => note(false),
            }
        }
    }
    let inputs = map.optional("inputs");
    let (lines, good) = reader.lines(inputs.as_ref(), ("E", row.inputs), row, None);
    slot.inputs = lines;
    note(good);
    let outputs = map.optional("outputs");
    let (lines, good) = reader.lines(outputs.as_ref(), ("A", row.outputs), row, Some(&mut taken.written));
    slot.outputs = lines;
    note(good);
    if let Some(value) = map.optional("tables") {
        note(reader.tables(&value, row, &mut slot.tables));
    }
    if let Some(value) = map.optional("cycle_factor") {
        let factor = value.integer(1..=MAX_FACTOR);
        note(factor.is_some());
        slot.factor = factor.unwrap_or(1);
    }
    if let Some(value) = map.optional("on_axis_error") {
        let reaction = value.choice(&[("run", OnAxisError::Run), ("reset", OnAxisError::Reset)]);
        note(reaction.is_some());
        slot.on_axis_error = reaction.unwrap_or_default();
    }
    for (word, key) in slot.words.iter_mut().zip(row.words) {
        if let Some(value) = map.optional(key) {
            *word = reader.word(&value, open);
            note(word.is_some());
        }
    }
    if row.runs_program {
        note(reader.program(map, entry, &mut slot, (taken, open)));
    }
    note(fields(map, row, &mut slot.values));
    slot.room = reader.room(&slot);
    is_good.then_some(slot)
}

/// Reads the fields of the type into a set; returns true if all of them are valid.
fn fields(map: &mut Map<'_>, row: &Description, values: &mut [i64]) -> bool {
    let (mut is_good, mut first) = (true, 0);
    for field in row.fields {
        if let Some(value) = map.optional(field.name) {
            let items = if field.count == 1 { Some(vec![value]) } else { list(&value, field.count, field.name) };
            is_good &= items.is_some();
            for (place, item) in (first..).zip(items.into_iter().flatten()) {
                let number = number(&item, field);
                is_good &= number.is_some();
                if let (Some(to), Some(number)) = (values.get_mut(place), number) {
                    *to = number;
                }
            }
        }
        first += field.count;
    }
    is_good
}

/// Reads a value of a field: a whole number, or a quantity that is a multiple of its unit.
fn number(item: &Value<'_>, field: &Field) -> Option<i64> {
    let range = field.min..=field.max;
    let text = item.peek().unwrap_or_default();
    if field.one().is_none() || !text.trim().contains([' ', '\t']) {
        return item.integer(range);
    }
    let number = field.convert(text).filter(|number| range.contains(number));
    if number.is_none() {
        let (label, unit, low, high) = (item.label(), field.unit, field.min, field.max);
        let sentence = format!("{label} is {}; a multiple of {unit} is allowed, {low}..{high} times", quote(text));
        item.refuse(sentence, None);
    }
    number
}

/// Reads a list of at most `most` items.
fn list<'d>(value: &Value<'d>, most: usize, key: &str) -> Option<Vec<Value<'d>>> {
    let items = value.list()?;
    if items.len() > most {
        value.refuse(format!("{key} has {} entries; at most {most} are possible", items.len()), None);
        return None;
    }
    Some(items)
}

fn fits_source(value: &Value<'_>, source: &SourceConfig, row: &Description) -> bool {
    let has = *source != SourceConfig::None;
    let problem = match row.source {
        Requirement::Never if has => format!("type {} reads no source", row.name),
        Requirement::Must if !has => format!("source is none; type {} reads one", row.name),
        _ if row.measures_encoder && !matches!(source, SourceConfig::Lead(Leader::Encoder(_))) => {
            format!("type {} measures on an encoder; source is something else", row.name)
        }
        _ => return true,
    };
    value.refuse(problem, None);
    false
}

/// Data for looking up names.
struct Reader<'a, 'd> {
    cx: &'a Context<'d>,
    objects: Objects<'a>,
}

impl<'d> Reader<'_, 'd> {
    fn source(&self, value: &Value<'d>, open: &mut Vec<Open<'d>>) -> Option<SourceConfig> {
        let text = value.text()?;
        if text == "none" {
            return Some(SourceConfig::None);
        }
        let (object, part) = text.split_once('.').unwrap_or((text, ""));
        let any = |open: &mut Vec<Open<'d>>| {
            open.push(Open { value: value.clone(), name: text.to_owned() });
            Some(SourceConfig::Signal(text.to_owned()))
        };
        if matches!(text.strip_prefix(VIRTUAL_MASTER), Some("" | ".position")) {
            return Some(SourceConfig::Lead(Leader::Virtual));
        }
        if object == "machine" {
            return any(open);
        }
        let (section, place) = self.cx.names.find(value, object, &READABLE)?;
        let place = u16::try_from(place).ok()?;
        match (section, part) {
            (Section::Axes, "" | "command" | "command.position") => {
                Some(SourceConfig::Lead(Leader::AxisCommand(place)))
            }
            (Section::Axes, "actual" | "actual.position") => Some(SourceConfig::Lead(Leader::AxisActual(place))),
            (Section::Encoders, "" | "position") => Some(SourceConfig::Lead(Leader::Encoder(place))),
            (Section::Masters, "" | "position") => Some(SourceConfig::Lead(Leader::Sum(place))),
            (Section::Functions, "sink") => Some(SourceConfig::Lead(Leader::Sink(place))),
            (Section::Functions, "") => {
                let hint = Some(format!("`{}.sink`", excerpt(text)));
                value.refuse(format!("{} is {}, a function; its sink is read", value.label(), quote(text)), hint);
                None
            }
            _ => any(open),
        }
    }

    /// Returns the source that a value reads, for the search of loops.
    fn reads(&self, value: &Value<'d>) -> Option<Reads> {
        let text = value.peek()?;
        let (object, part) = text.split_once('.').unwrap_or((text, "command"));
        let find = |section| self.cx.names.section(section).iter().position(|entry| entry.name() == object);
        match (find(Section::Axes), find(Section::Functions).map(Reads::Function)) {
            (Some(axis), _) => OF_COMMAND.contains(&part.split('.').next()?).then_some(Reads::Command(axis)),
            // The validity of a master is no motion.
            (None, function) => {
                function.or_else(|| find(Section::Masters).filter(|_| part != "valid").map(Reads::Master))
            }
        }
    }

    /// Returns the signal of a word: a memory cell by its name alone, or any other signal.
    fn word(&self, value: &Value<'d>, open: &mut Vec<Open<'d>>) -> Option<String> {
        let text = value.text()?;
        let object = text.split_once('.').map_or(text, |(object, _)| object);
        if object != "machine" {
            self.cx.names.find(value, object, &READABLE)?;
        }
        open.push(Open { value: value.clone(), name: text.to_owned() });
        Some(text.to_owned())
    }

    fn sink(&self, value: &Value<'d>) -> Option<SinkConfig> {
        let text = value.text()?;
        if text == "none" {
            return Some(SinkConfig::None);
        }
        let (section, place) = self.cx.names.find(value, text, &[Section::Axes, Section::Memory, Section::Io])?;
        let index = u16::try_from(place).ok()?;
        let allowed = "an axis, a memory cell of numbers, an ao or none is allowed";
        let problem = match section {
            Section::Axes => return Some(SinkConfig::Axis(index)),
            Section::Memory => {
                let kind = self.objects.memory.get(place)?.as_ref()?.kind;
                if kind != MemoryKind::Bit {
                    return Some(SinkConfig::Memory(index));
                }
                "a bit"
            }
            _ => {
                let kind = self.objects.io.get(place)?.as_ref()?.kind;
                if kind == IoKind::AnalogOutput {
                    return Some(SinkConfig::Output(index));
                }
                "no ao"
            }
        };
        value.refuse(format!("sink is {}, which is {problem}; {allowed}", quote(text)), None);
        None
    }

    fn fits_sink(&self, value: &Value<'d>, sink: SinkConfig, row: &Description) -> bool {
        let is_axis = matches!(sink, SinkConfig::Axis(_));
        let problem = match row.sink {
            Requirement::Never if sink != SinkConfig::None => format!("type {} writes no sink", row.name),
            _ if is_axis && !row.moves_axes => format!("type {} moves no axis", row.name),
            _ => return true,
        };
        value.refuse(problem, None);
        false
    }

    /// Registers the object that a sink writes; only one function may write it.
    fn take_sink(value: &Value<'d>, sink: SinkConfig, written: &mut Written<'_>) -> bool {
        match sink {
            SinkConfig::None => true,
            SinkConfig::Axis(place) => written.take(Object::Axis(place), value),
            SinkConfig::Memory(place) => written.take(Object::Memory(place), value),
            SinkConfig::Output(place) => written.take(Object::Io(place), value),
        }
    }

    /// Reads inputs or outputs in their order; they are outputs if `written` is given.
    fn lines(
        &self,
        value: Option<&Value<'d>>,
        (letter, most): (&str, usize),
        row: &Description,
        mut written: Option<&mut Written<'_>>,
    ) -> ([Option<Line>; LINES], bool) {
        let mut lines = [None; LINES];
        let Some(value) = value else { return (lines, true) };
        let Some(items) = value.list() else { return (lines, false) };
        if items.len() > most {
            let known = match most {
                0 => "none".to_owned(),
                1 => format!("{letter}1"),
                _ => format!("{letter}1 to {letter}{most}"),
            };
            value.refuse(format!("{} has {} entries; type {} has {known}", value.label(), items.len(), row.name), None);
            return (lines, false);
        }
        let mut is_good = true;
        for (to, item) in lines.iter_mut().zip(&items) {
            match self.line(item, written.as_deref_mut()) {
                Some(line) => *to = line,
                None => is_good = false,
            }
        }
        (lines, is_good)
    }

    /// Reads a name, `none`, or `{name, inverted}`.
    fn line(&self, item: &Value<'d>, written: Option<&mut Written<'_>>) -> Option<Option<Line>> {
        let (name, inverted) = if item.is_map() {
            let mut map = item.map("a line")?;
            let name = map.required("name");
            let inverted = map.optional("inverted").map_or(Some(false), |value| value.boolean());
            map.finish();
            (name?, inverted?)
        } else {
            (item.clone(), false)
        };
        let text = name.text()?;
        if text == "none" {
            return Some(None);
        }
        let (section, place) = self.cx.names.find(&name, text, &[Section::Io, Section::Memory])?;
        let index = u16::try_from(place).ok()?;
        let (wanted, what) = match written {
            Some(_) => (IoKind::DigitalOutput, "do"),
            None => (IoKind::DigitalInput, "di"),
        };
        let object = match section {
            Section::Io if self.objects.io.get(place)?.as_ref()?.kind == wanted => Object::Io(index),
            Section::Memory if self.objects.memory.get(place)?.as_ref()?.kind == MemoryKind::Bit => {
                Object::Memory(index)
            }
            _ => {
                name.refuse(format!("{} is no {what} and no memory cell of type bit", quote(text)), None);
                return None;
            }
        };
        if let Some(written) = written
            && !written.take(object, &name)
        {
            return None;
        }
        Some(Some(Line { object, inverted }))
    }

    /// Returns the memory that the cell requires, and at least the usual one.
    fn room(&self, slot: &SlotConfig) -> MemorySize {
        const MEAN: usize = 256;
        const HEAD: usize = 32;
        const WORDS_PER_CAM: usize = 4;
        let row = slot.kind.description();
        let mean = ["mean_factor", "dead_time_mean"].into_iter().find_map(|name| row.find(name));
        let asked = mean.and_then(|(_, place)| slot.values.get(place).copied()).unwrap_or(0);
        let table =
            slot.tables.first().copied().flatten().and_then(|place| self.objects.tables.get(usize::from(place)));
        let words = table.and_then(Option::as_ref).map_or(0, |entry| entry.table.len());
        MemorySize {
            mean: usize::try_from(asked).unwrap_or(MEAN).clamp(MEAN, MAX_WINDOW),
            cams: words.saturating_sub(HEAD) / WORDS_PER_CAM,
        }
    }

    /// Reads the keys of a program: its module, its inputs and outputs, its limits.
    fn program(
        &self,
        map: &mut Map<'d>,
        entry: &Entry<'d>,
        slot: &mut SlotConfig,
        (taken, open): (&mut Claims<'_>, &mut Vec<Open<'d>>),
    ) -> bool {
        let mut is_good = true;
        match map.optional("program") {
            Some(value) => {
                let found = value.text().and_then(|text| self.cx.names.find(&value, text, &[Section::Programs]));
                slot.program = found.and_then(|(_, place)| u16::try_from(place).ok());
                is_good &= slot.program.is_some();
            }
            None => {
                let hint = Some("name an entry of section `programs`".to_owned());
                map.refuse(format!("function {} has no program; type apsf runs one", entry.quoted()), hint);
                is_good = false;
            }
        }
        if let Some(value) = map.optional("fuel") {
            let fuel = value.integer(1..=MAX_FUEL);
            is_good &= fuel.is_some();
            slot.fuel = fuel.unwrap_or(slot.fuel);
        }
        if let Some(value) = map.optional("reads") {
            for item in list(&value, lineshaft_program::WORDS, "reads").into_iter().flatten() {
                let word = self.word(&item, open);
                is_good &= word.is_some();
                slot.reads.extend(word);
            }
        }
        if let Some(value) = map.optional("writes") {
            for item in list(&value, lineshaft_program::WORDS, "writes").into_iter().flatten() {
                let found = item.text().and_then(|text| self.cx.names.find(&item, text, &[Section::Memory]));
                let place = found.and_then(|(_, place)| u16::try_from(place).ok());
                is_good &= place.is_some_and(|place| taken.written.take(Object::Memory(place), &item));
                slot.writes.extend(place);
            }
        }
        is_good
    }

    fn tables(&self, value: &Value<'d>, row: &Description, to: &mut [Option<u16>; LINES]) -> bool {
        let Some(items) = list(value, row.tables, "tables") else { return false };
        let mut is_good = true;
        for (to, item) in to.iter_mut().zip(items) {
            let Some(text) = item.text() else { return false };
            if text == "none" {
                continue;
            }
            let found = self.cx.names.find(&item, text, &[Section::Tables]);
            *to = found.and_then(|(_, place)| u16::try_from(place).ok());
            is_good &= to.is_some();
        }
        is_good
    }
}

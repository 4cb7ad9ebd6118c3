//! Reads an EDS or DCF file to a dictionary.
//!
//! Law      an invalid default value, an invalid list or a missing name is ignored with a warning, and so is an object whose type or access
//!          is invalid. A configuration value that cannot be read, or that belongs to such an object, is an error. All errors are reported
//!          together
//! Refuses  a file above 16 MiB, an invalid node ID, more than 100000 objects, a file without objects
//! Source   CiA 306-1

use super::device::{Commissioning, DeviceInfo, FileInfo};
use super::dictionary::Dictionary;
use super::entry;
use super::ini::{self, Section, Sections};
use super::notes::{Diagnostics, LAST_NODE};
use super::object::{IndexDescription, ObjectType};
use super::problem::EdsErrors;
use lineshaft_cia402::dictionary::quoted;
use lineshaft_cia402::object::Object;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum size of a file, in bytes.
const LARGEST_FILE: usize = 16 << 20;
/// Maximum number of objects with a value. A few lines of a file can describe 254 objects.
const MOST_ENTRIES: usize = 100_000;
/// Maximum number of indices that a warning lists.
const MOST_NAMED: usize = 8;
/// Sections that list indices.
const LISTS: [&str; 3] = ["mandatoryobjects", "optionalobjects", "manufacturerobjects"];

/// Sections of one index.
#[derive(Default)]
struct IndexSections<'a> {
    head: Option<&'a Section<'a>>,
    subs: BTreeMap<u8, &'a Section<'a>>,
    names: Option<&'a Section<'a>>,
    values: Option<&'a Section<'a>>,
}

/// Reads an EDS or DCF file. `$NODEID` is replaced by `node_id`, otherwise by the node ID that the file gives.
///
/// # Errors
/// All problems that make the file unusable, together with the warnings.
pub fn parse(bytes: &[u8], node_id: Option<u8>) -> Result<Dictionary, EdsErrors> {
    let mut notes = Diagnostics::default();
    let mut dictionary = Dictionary::default();
    if bytes.len() > LARGEST_FILE {
        let length = bytes.len();
        notes.errors.add(None, format!("the file has {length} bytes; {LARGEST_FILE} (16 MiB) are allowed"));
    } else if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        notes.errors.add(None, "the file is UTF-16; UTF-8 and Latin-1 are allowed");
    } else {
        if let Some(id) = node_id.filter(|id| !(1..=LAST_NODE).contains(id)) {
            notes.errors.add(None, format!("the node id {id} is not within 1 and {LAST_NODE}"));
        }
        let text = ini::text(bytes);
        let sections = ini::sections(&text, &mut notes.errors, &mut notes.warnings);
        fill(&mut dictionary, &sections, node_id, &mut notes);
    }
    let Diagnostics { mut errors, mut warnings } = notes;
    errors.sort();
    warnings.sort();
    if errors.is_empty() {
        dictionary.warnings = warnings;
        Ok(dictionary)
    } else {
        Err(EdsErrors { errors, warnings })
    }
}

fn fill(dictionary: &mut Dictionary, sections: &Sections<'_>, node_id: Option<u8>, notes: &mut Diagnostics) {
    dictionary.file = FileInfo::of(sections, notes);
    dictionary.device = DeviceInfo::of(sections, notes);
    dictionary.commissioning = Commissioning::of(sections, notes);
    dictionary.comments = comments(sections);
    dictionary.dummies = dummies(sections, notes);
    let own = dictionary.commissioning.as_ref().and_then(|commissioning| commissioning.node_id);
    dictionary.node_id = node_id.or(own.and_then(|id| u8::try_from(id).ok()));
    let parts = parts(sections, notes);
    if parts.is_empty() {
        notes.errors.add(None, "the file has no objects: there is no section like [1000]");
    }
    lists(sections, &parts, notes);
    for (index, parts) in &parts {
        read_index(dictionary, *index, parts, sections, notes);
        if dictionary.entries.len() > MOST_ENTRIES {
            let line = parts.head.map(|section| section.line);
            notes.errors.add(line, format!("the file has more than {MOST_ENTRIES} objects"));
            break;
        }
    }
    if dictionary.heads.is_empty() && notes.errors.is_empty() {
        notes.errors.add(None, "no object of the file can be used: the warnings say why");
    }
}

fn comments(sections: &Sections<'_>) -> Vec<String> {
    let Some(section) = sections.get("comments") else { return Vec::new() };
    let numbered = |key: &str| key.strip_prefix("line")?.parse::<u32>().ok();
    let lines: BTreeMap<u32, &str> =
        section.items.iter().filter_map(|(key, item)| Some((numbered(key)?, item.value))).collect();
    lines.into_values().map(str::to_owned).collect()
}

fn dummies(sections: &Sections<'_>, notes: &mut Diagnostics) -> BTreeSet<u16> {
    let Some(section) = sections.get("dummyusage") else { return BTreeSet::new() };
    let numbered = |key: &str| u16::from_str_radix(key.strip_prefix("dummy")?, 16).ok();
    let types = section.items.keys().filter_map(|key| Some((key, numbered(key)?)));
    types.filter(|(key, _)| notes.flag(section, key)).map(|(_, number)| number).collect()
}

/// Returns the sections of objects, by index. Other sections belong to tools.
fn parts<'a>(sections: &'a Sections<'a>, notes: &mut Diagnostics) -> BTreeMap<u16, IndexSections<'a>> {
    let mut all: BTreeMap<u16, IndexSections<'a>> = BTreeMap::new();
    for (name, section) in sections {
        let (digits, rest) = name.split_at_checked(4).unwrap_or((name.as_str(), ""));
        let index = Some(digits).filter(|digits| digits.len() == 4).and_then(hex);
        let Some(index) = index.and_then(|index| u16::try_from(index).ok()) else {
            report_stray_value(section, notes);
            continue;
        };
        if let Some(sub) = rest.strip_prefix("sub") {
            let Some(sub) = hex(sub).and_then(|sub| u8::try_from(sub).ok()) else {
                let name = quoted(section.name);
                notes.errors.add(Some(section.line), format!("the section {name} has no subindex within 0 and FF"));
                continue;
            };
            let parts = all.entry(index).or_default();
            if let Some(other) = parts.subs.insert(sub, section) {
                let (later, former) = if other.line > section.line { (other, section) } else { (section, other) };
                parts.subs.insert(sub, later);
                let name = quoted(later.name);
                let first = former.line;
                notes.warnings.add(Some(later.line), format!("{name} stands in line {first} too; this one holds"));
            }
            continue;
        }
        match rest {
            "" => all.entry(index).or_default().head = Some(section),
            "name" => all.entry(index).or_default().names = Some(section),
            "value" => all.entry(index).or_default().values = Some(section),
            // ObjectLinks group objects for display, Denotation contains names that users gave to objects.
            _ => report_stray_value(section, notes),
        }
    }
    for values in all.values().filter(|parts| parts.head.is_none()).filter_map(|parts| parts.values) {
        entry::report_unused_values(values, &[], notes);
    }
    all.retain(|_, parts| parts.head.is_some() || !parts.subs.is_empty());
    all
}

/// Reports a configuration value in a section of no object, which would be lost. Objects of modules (`[M1SubExt6000]`) are not supported.
fn report_stray_value(section: &Section<'_>, notes: &mut Diagnostics) {
    let Some(item) = section.get("parametervalue") else { return };
    let mut letters = section.name.chars();
    let is_of_module = letters.next().is_some_and(|first| first.eq_ignore_ascii_case(&'m'))
        && letters.next().is_some_and(|next| next.is_ascii_digit());
    if is_of_module {
        notes.warning(section, item, "the section is that of a module");
    } else {
        notes.error(section, item, "the section is that of no object; allowed are names like [2000] and [2000sub1]");
    }
}

/// Parses a text of hexadecimal digits only.
fn hex(digits: &str) -> Option<u32> {
    let is_hex = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    if is_hex { u32::from_str_radix(digits, 16).ok() } else { None }
}

/// Compares the lists of indices with the objects. The lists have no other use.
fn lists(sections: &Sections<'_>, parts: &BTreeMap<u16, IndexSections<'_>>, notes: &mut Diagnostics) {
    let mut listed = BTreeSet::new();
    for section in LISTS.iter().filter_map(|name| sections.get(*name)) {
        let mut found = 0_u32;
        for item in section.items.values().filter(|item| item.key.parse::<u32>().is_ok()) {
            found = found.saturating_add(1);
            match Diagnostics::checked(*item, 0, u32::from(u16::MAX)) {
                Ok(index) => {
                    let index = index as u16;
                    listed.insert(index);
                    if !parts.contains_key(&index) {
                        notes.warning(section, *item, &format!("there is no section [{index:04X}]"));
                    }
                }
                Err(why) => notes.warning(section, *item, &why),
            }
        }
        if let Some(item) = section.get("supportedobjects")
            && let Some(count) = notes.number(section, "supportedobjects", 0, u32::MAX)
            && count != found
        {
            notes.warning(section, item, &format!("the list has {found} objects"));
        }
    }
    let others: Vec<u16> = parts.keys().copied().filter(|index| !listed.contains(index)).collect();
    if !others.is_empty() {
        let named: Vec<String> = others.iter().take(MOST_NAMED).map(|index| format!("{index:04X}h")).collect();
        let more = if others.len() > MOST_NAMED { ", .." } else { "" };
        let (count, named) = (others.len(), named.join(", "));
        notes.warnings.add(None, format!("{count} objects stand in no list of objects: {named}{more}; they are taken"));
    }
}

fn read_index(
    dictionary: &mut Dictionary,
    index: u16,
    parts: &IndexSections<'_>,
    sections: &Sections<'_>,
    notes: &mut Diagnostics,
) {
    let head = match parts.head {
        Some(section) => {
            let Some(object_type) = object_type(section, parts, notes) else { return };
            IndexDescription { name: entry::name(section, &format!("{index:04X}h"), notes), object_type }
        }
        None => {
            let line = parts.subs.values().map(|section| section.line).min();
            notes.warnings.add(line, format!("the section [{index:04X}] is missing; the object is taken as a RECORD"));
            IndexDescription { name: format!("{index:04X}h"), object_type: ObjectType::Record }
        }
    };
    if let Some((section, item)) = parts.head.and_then(|section| Some((section, section.get("parametervalue")?)))
        && !head.object_type.is_single()
    {
        let why = "the index has no value of its own; allowed are sections of its subindices, or [xxxxValue] with CompactSubObj";
        notes.error(section, item, why);
    }
    let before = dictionary.entries.len();
    let mut compact = Vec::new();
    match parts.head {
        Some(section) if head.object_type.is_single() => {
            if let Some(values) = parts.values {
                entry::report_unused_values(values, &[], notes);
            }
            // An index without its only object has no content.
            let is_configured = entry::is_configured(section);
            let read = entry::read(section, head.object_type, is_configured, sections, notes);
            let Some(mut read) = read else { return };
            read.name.clone_from(&head.name);
            dictionary.entries.insert(Object { index, sub: 0 }, read);
        }
        Some(section) if section.get("compactsubobj").is_some() => {
            for (sub, read) in entry::compact(section, &head.name, parts.names, parts.values, sections, notes) {
                // A separate section has precedence and does not use [xxxxValue].
                if sub > 0 && !parts.subs.contains_key(&sub) {
                    compact.push(sub);
                }
                dictionary.entries.insert(Object { index, sub }, read);
            }
        }
        _ => {}
    }
    if let Some(values) = parts.values.filter(|_| parts.head.is_some() && !head.object_type.is_single()) {
        entry::report_unused_values(values, &compact, notes);
    }
    for (sub, section) in parts.subs.iter().filter(|_| !head.object_type.is_single()) {
        let is_configured = entry::is_configured(section);
        if let Some(mut read) = entry::read(section, ObjectType::Var, is_configured, sections, notes) {
            read.name = entry::name(section, &format!("{sub:02X}h"), notes);
            dictionary.entries.insert(Object { index, sub: *sub }, read);
        }
    }
    if let Some(section) = parts.head.filter(|_| !head.object_type.is_single()) {
        let found = dictionary.entries.len() - before;
        let said = notes.number(section, "subnumber", 0, 256);
        let is_compact = section.get("compactsubobj").is_some();
        // The list is correct if only its object was left out.
        if said.map_or(found == 0, |said| said as usize != parts.subs.len()) && !is_compact {
            let said = said.map_or_else(|| "no SubNumber".to_owned(), |said| format!("SubNumber={said}"));
            let (name, found) = (quoted(section.name), parts.subs.len());
            notes.warnings.add(Some(section.line), format!("the section {name} has {said}, and {found} subindices"));
        }
    }
    dictionary.heads.insert(index, head);
}

/// Returns true if a section of an index has a configuration value.
fn is_configured(parts: &IndexSections<'_>) -> bool {
    let mut sections = parts.head.into_iter().chain(parts.subs.values().copied());
    sections.any(entry::is_configured) || parts.values.is_some_and(entry::has_values)
}

/// Returns the object type of an index; `None`, with an error or a warning, if it is invalid.
fn object_type(section: &Section<'_>, parts: &IndexSections<'_>, notes: &mut Diagnostics) -> Option<ObjectType> {
    let Some(item) = section.get("objecttype") else {
        // CiA 306: without the key the object is a VAR, which an index with subindices cannot be.
        return Some(match (section.get("compactsubobj").is_some(), parts.subs.is_empty()) {
            (true, _) => ObjectType::Array,
            (false, true) => ObjectType::Var,
            (false, false) => ObjectType::Record,
        });
    };
    match Diagnostics::checked(item, 0, 9).map(ObjectType::of) {
        Ok(Some(found)) if found.is_single() && !parts.subs.is_empty() => {
            notes.warning(section, item, "the object has subindices, and is taken as a RECORD");
            Some(ObjectType::Record)
        }
        Ok(Some(found)) => Some(found),
        Ok(None) | Err(_) => {
            let why = "allowed are 0 (NULL), 2 (DOMAIN), 5 (DEFTYPE), 6 (DEFSTRUCT), 7 (VAR), 8 (ARRAY), 9 (RECORD)";
            entry::note_unusable_object(section, item, is_configured(parts), why, notes);
            None
        }
    }
}

#[cfg(test)]
mod tests;

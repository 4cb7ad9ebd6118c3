//! Reads objects from the sections of an index.
//!
//! Law      a missing key has the value that is safest: read access only, not mappable, no limits
//! Reads    sections of one object, and `CompactSubObj`, where one section describes many objects whose names and values are in separate
//!          sections
//! Refuses  a configuration value that cannot be read or belongs to no object, or whose object has an invalid data type or access. With a
//!          warning: such an object without a configuration value, a missing data type, a value in a separate file (`DownloadFile`)
//! Source   CiA 306-1

use super::ini::{Item, Section, Sections};
use super::notes::{Diagnostics, given, section_text, without_remark};
use super::object::{Access, Entry, FileValue, ObjectType};
use lineshaft_cia402::dictionary::{DataType, Value, quoted};

/// Maximum length of a name, in characters; CiA 306 allows 241.
const LONGEST_NAME: usize = 255;
/// Maximum subindex of an array.
const LAST_SUB: u32 = 254;
/// Maximum size of a value that is repeated for each subindex, in bytes.
const LONGEST_REPEATED: usize = 255;
/// First number of a data type that a profile or a device defines.
const FIRST_DEFINED: u16 = 0x40;

/// Returns the name of an index or of an object.
pub(super) fn name(section: &Section<'_>, otherwise: &str, notes: &mut Diagnostics) -> String {
    let Some(item) = section.get("parametername") else {
        let section_name = quoted(section.name);
        notes.warnings.add(Some(section.line), format!("the section {section_name} has no ParameterName"));
        return otherwise.to_owned();
    };
    let name = shortened(item.value);
    if name.len() < item.value.len() {
        notes.warnings.add(Some(item.line), format!("the name is longer than {LONGEST_NAME} characters, and is cut"));
    }
    name
}

fn shortened(name: &str) -> String {
    // Blanks before the cut would be lost when the name is written to a file.
    name.chars().take(LONGEST_NAME).collect::<String>().trim_end().to_owned()
}

/// Returns an object without its name. If the section is invalid, returns `None` and adds a note: an error if the configuration gives the
/// object a value.
pub(super) fn read(
    section: &Section<'_>,
    object_type: ObjectType,
    is_configured: bool,
    sections: &Sections<'_>,
    notes: &mut Diagnostics,
) -> Option<Entry> {
    // A subindex may be a DOMAIN of its own. For VAR and DOMAIN only the required keys differ.
    let own = section.get("objecttype").and_then(|item| Diagnostics::checked(item, 0, 9).ok()).and_then(ObjectType::of);
    let is_domain = own.unwrap_or(object_type) == ObjectType::Domain;
    let data_type = data_type(section, is_domain, is_configured, sections, notes);
    let access = access(section, is_domain, is_configured, notes);
    let data_type = data_type?;
    let mut entry = Entry {
        name: String::new(),
        data_type,
        access: access?,
        is_mappable: notes.flag(section, "pdomapping"),
        flags: notes.number(section, "objflags", 0, u32::MAX).unwrap_or(0),
        low: notes.given(section, "lowlimit", data_type),
        high: notes.given(section, "highlimit", data_type),
        default: notes.given(section, "defaultvalue", data_type),
        parameter: None,
    };
    if let Some(item) = section.get("parametervalue") {
        entry.parameter = parameter(section, item, &entry, notes);
    }
    if let Some(item) = section.get("downloadfile") {
        notes.warning(section, item, "the value is in a file, which is not read: write it with `can sdo write --file`");
    }
    if entry.has_inverted_limits()
        && let Some(item) = section.get("lowlimit")
    {
        notes.warning(section, item, "the limit is above HighLimit, and neither of them counts");
        (entry.low, entry.high) = (None, None);
    }
    Some(entry)
}

/// Returns the configuration value of an object. An unreadable value of a configurable object is an error, as the device would keep another
/// value.
fn parameter(section: &Section<'_>, item: Item<'_>, entry: &Entry, notes: &mut Diagnostics) -> Option<FileValue> {
    match given(item.value, entry.data_type) {
        Ok(given) => given,
        Err(why) if entry.is_configurable() => {
            notes.error(section, item, &why);
            None
        }
        Err(why) => {
            notes.warning(section, item, &why);
            None
        }
    }
}

/// Adds a note about a key without which an object is unusable. It is an error if the configuration gives the object a value, which would
/// be lost. Otherwise the object is left out with a warning.
pub(super) fn note_unusable_object(
    section: &Section<'_>,
    item: Item<'_>,
    is_configured: bool,
    why: &str,
    notes: &mut Diagnostics,
) {
    if is_configured {
        notes.error(section, item, why);
    } else {
        let text = format!("{}: {why}; the object is left out", section_text(section, item));
        notes.warnings.add(Some(item.line), text);
    }
}

/// Returns true if a section gives its object a configuration value.
pub(super) fn is_configured(section: &Section<'_>) -> bool {
    section.get("parametervalue").is_some()
}

/// Returns true if a section `[xxxxValue]` has a value.
pub(super) fn has_values(values: &Section<'_>) -> bool {
    values.items.iter().any(|(key, item)| key != "nrofentries" && !item.value.is_empty())
}

fn data_type(
    section: &Section<'_>,
    is_domain: bool,
    is_configured: bool,
    sections: &Sections<'_>,
    notes: &mut Diagnostics,
) -> Option<DataType> {
    let Some(item) = section.get("datatype") else {
        if is_domain {
            return Some(DataType::Domain);
        }
        if let Some(item) = section.get("parametervalue") {
            notes.error(section, item, "the section has no DataType, without which the value cannot be read");
            return None;
        }
        let name = quoted(section.name);
        notes.warnings.add(Some(section.line), format!("the section {name} has no DataType; the object is left out"));
        return None;
    };
    match Diagnostics::checked(item, 1, u32::from(u16::MAX)) {
        Ok(number) => {
            let number = number as u16;
            Some(base_type(number, sections).unwrap_or(DataType::of(number)))
        }
        Err(why) => {
            let why = format!("{why}; allowed is the number of a data type, like 0x0007 for UNSIGNED32");
            note_unusable_object(section, item, is_configured, &why, notes);
            None
        }
    }
}

/// Returns the base type of a type definition. CANFestival defines its own types for objects with limits, in sections such as `[A0]`, whose
/// subindex 1 contains the base type.
fn base_type(number: u16, sections: &Sections<'_>) -> Option<DataType> {
    if number < FIRST_DEFINED {
        return None;
    }
    let section = sections.get(&format!("{number:x}sub1")).or_else(|| sections.get(&format!("{number:04x}sub1")))?;
    let behind = Diagnostics::checked(section.get("defaultvalue")?, 1, u32::from(FIRST_DEFINED) - 1).ok()?;
    u16::try_from(behind).ok().map(DataType::of)
}

fn access(section: &Section<'_>, is_domain: bool, is_configured: bool, notes: &mut Diagnostics) -> Option<Access> {
    let Some(item) = section.get("accesstype") else {
        let (otherwise, name) = (if is_domain { Access::Rw } else { Access::Ro }, quoted(section.name));
        if let Some(item) = section.get("parametervalue").filter(|_| !is_domain) {
            notes.error(
                section,
                item,
                "the section has no AccessType, without which it is not known whether to write it",
            );
            return None;
        }
        if !is_domain {
            notes.warnings.add(Some(section.line), format!("the section {name} has no AccessType; ro is taken"));
        }
        return Some(otherwise);
    };
    let access = Access::of(without_remark(item.value));
    if access.is_none() {
        let why = "allowed are ro, wo, rw, rwr, rww and const";
        note_unusable_object(section, item, is_configured, why, notes);
    }
    access
}

/// Returns the objects of `CompactSubObj`: the number of entries, and that many objects that differ only in name and value.
pub(super) fn compact(
    section: &Section<'_>,
    parent: &str,
    names: Option<&Section<'_>>,
    values: Option<&Section<'_>>,
    sections: &Sections<'_>,
    notes: &mut Diagnostics,
) -> Vec<(u8, Entry)> {
    let Some(count) = notes.number(section, "compactsubobj", 0, 255).filter(|count| *count > 0) else {
        return Vec::new();
    };
    let last = count.min(LAST_SUB) as u8;
    let is_configured = is_configured(section) || values.is_some_and(has_values);
    let Some(mut one) = read(section, ObjectType::Var, is_configured, sections, notes) else { return Vec::new() };
    if let Some(item) = section.get("defaultvalue").filter(|item| item.value.len() > LONGEST_REPEATED) {
        notes.warning(section, item, &format!("a value for many objects has at most {LONGEST_REPEATED} bytes"));
        one.default = None;
    }
    // The caller reports an own value of the section as an error.
    one.parameter = None;
    let number_of_entries = Entry {
        name: "NrOfObjects".to_owned(),
        data_type: DataType::Unsigned8,
        access: Access::Ro,
        is_mappable: false,
        flags: 0,
        low: None,
        high: None,
        default: Some(FileValue::Value(Value::Unsigned(u64::from(last)))),
        parameter: None,
    };
    let mut entries = vec![(0, number_of_entries)];
    for sub in 1..=last {
        let key = sub.to_string();
        let own = names.and_then(|names| names.get(&key)).map(|item| shortened(item.value));
        let name = own.unwrap_or_else(|| format!("{}{sub}", parent.chars().take(LONGEST_NAME - 3).collect::<String>()));
        let mut entry = Entry { name, ..one.clone() };
        if let Some((values, item)) = values.and_then(|values| Some((values, values.get(&key)?))) {
            entry.parameter = parameter(values, item, &entry, notes);
        }
        entries.push((sub, entry));
    }
    entries
}

/// Reports values of `[xxxxValue]` that belong to no object. `compact` are the objects that have used their values.
pub(super) fn report_unused_values(values: &Section<'_>, compact: &[u8], notes: &mut Diagnostics) {
    let of_object = |key: &str| key.parse().is_ok_and(|sub: u8| compact.contains(&sub) && sub.to_string() == key);
    let taken = |key: &str| key == "nrofentries" || of_object(key);
    for (key, item) in &values.items {
        if taken(key) || without_remark(item.value).is_empty() {
            continue;
        }
        let why = match compact.last() {
            Some(last) => format!(
                "no object takes the value; allowed are the subindices 1 to {last} that have no section of their own, in decimal digits"
            ),
            None => "no object takes the value: CompactSubObj of the index makes none".to_owned(),
        };
        notes.error(values, *item, &why);
    }
}

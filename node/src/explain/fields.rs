//! Explains fields of ROS messages, services and actions: `MoveAxis.buffer_mode`, `move_axis.buffer_mode`, `buffer_mode`.

use super::section;
use crate::interfaces::short;
use lineshaft_msgs::INTERFACES;
use lineshaft_msgs::about::{Field, Interface, Section};
use lineshaft_ros::surface::table::ROWS;

/// A field with one meaning, and the interfaces that have it.
struct Meaning {
    field: &'static Field,
    /// Types without their package.
    types: Vec<&'static str>,
    /// Types with the part that has the field, such as `MoveAxis (goal)`.
    uses: Vec<String>,
}

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let (owner, field) = name.rsplit_once('.').map_or((None, name), |(owner, field)| (Some(owner), field));
    let mut meanings: Vec<Meaning> = Vec::new();
    for (interface, part, known) in fields() {
        if !known.name.eq_ignore_ascii_case(field) || owner.is_some_and(|owner| !is_called(interface, part, owner)) {
            continue;
        }
        let (kind, used) = (type_name(interface), use_text(interface, part));
        match meanings.iter_mut().find(|meaning| meaning.field == known) {
            Some(meaning) => {
                meaning.types.push(kind);
                meaning.uses.push(used);
            }
            None => meanings.push(Meaning { field: known, types: vec![kind], uses: vec![used] }),
        }
    }
    meanings.iter().map(|meaning| text(meaning, width)).collect()
}

pub(super) fn names() -> Vec<String> {
    let names = |(interface, _, field): (&Interface, &Section, &Field)| {
        [field.name.to_owned(), format!("{}.{}", type_name(interface), field.name)]
    };
    fields().flat_map(names).collect()
}

/// Returns every field with its interface and its part.
fn fields() -> impl Iterator<Item = (&'static Interface, &'static Section, &'static Field)> {
    let parts = INTERFACES.iter().flat_map(|interface| interface.sections.iter().map(move |part| (interface, part)));
    parts.flat_map(|(interface, part)| part.fields.iter().map(move |field| (interface, part, field)))
}

/// Returns the name of a type without its package.
fn type_name(interface: &Interface) -> &'static str {
    interface.name.rsplit('/').next().unwrap_or(interface.name)
}

/// Whether the part is called so: by its type, by the name of its topic, service or action, or as in Python,
/// `MoveAxis.Goal`.
fn is_called(interface: &Interface, part: &Section, name: &str) -> bool {
    let whole = name.rsplit_once('.').filter(|(_, end)| end.eq_ignore_ascii_case(part.name)).map_or(name, |(of, _)| of);
    let is_endpoint = ROWS.iter().any(|row| {
        row.interface == interface.name && (row.name == whole || row.name.strip_prefix("~/") == Some(whole))
    });
    is_endpoint
        || type_name(interface).eq_ignore_ascii_case(whole)
        || interface.name == whole
        || short(interface.name) == whole
}

fn use_text(interface: &Interface, part: &Section) -> String {
    let kind = type_name(interface);
    if part.name.is_empty() { kind.to_owned() } else { format!("{kind} ({})", part.name.to_lowercase()) }
}

fn text(meaning: &Meaning, width: usize) -> String {
    let Meaning { field, types, uses } = meaning;
    let uses = uses.join(", ");
    let page = match types.as_slice() {
        [kind] => format!("docs/interfaces.md; `lineshaft interfaces {kind}` lists all fields and constants"),
        _ => "docs/interfaces.md".to_owned(),
    };
    let facts: [(&str, &str); 4] =
        [("what", field.doc), ("type", field.kind), ("in", uses.as_str()), ("documented", page.as_str())];
    section(&format!("{}: a field of ROS interfaces", field.name), &facts, width)
}

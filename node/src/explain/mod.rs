//! Explains names: returns the text that `lineshaft explain` prints.
//!
//! Reads    the tables that the program uses: codes, parameters, keys, signals, types of functions, ROS interfaces,
//!          verbs, values; objects of CANopen, function blocks of PLCopen and commands
//! Writes   text
//! Refuses  a name that no table has, with the most similar names
//!
//! A subject is a file with two functions: the sections about a name, and the known names. A new subject needs a file
//! and a row of [`SUBJECTS`].

mod codes;
mod commands;
mod fields;
mod functions;
mod interfaces;
mod keys;
mod objects;
mod parameters;
mod plcopen;
mod signals;
mod values;
mod verbs;

use crate::parameters::wrap;
use crate::scenario::nearest;
use lineshaft_core::unit::excerpt;
use std::fmt::Write;

/// Width of the label before a fact.
const LABEL: usize = 14;
/// Minimum width, even if the terminal is narrower.
const NARROWEST: usize = 30;
/// Maximum number of suggested names.
const MOST_MEANT: usize = 3;

/// A kind of named objects.
struct Subject {
    /// Returns a section for each object with that name; each ends with a line feed.
    sections: fn(&str, usize) -> Vec<String>,
    /// Returns the known names.
    names: fn() -> Vec<String>,
}

/// Subjects in the order in which they are printed.
const SUBJECTS: [Subject; 12] = [
    Subject { sections: objects::sections, names: objects::names },
    Subject { sections: codes::sections, names: codes::names },
    Subject { sections: parameters::sections, names: parameters::names },
    Subject { sections: keys::sections, names: keys::names },
    Subject { sections: signals::sections, names: signals::names },
    Subject { sections: functions::sections, names: functions::names },
    Subject { sections: commands::sections, names: commands::names },
    Subject { sections: verbs::sections, names: verbs::names },
    Subject { sections: interfaces::sections, names: interfaces::names },
    Subject { sections: fields::sections, names: fields::names },
    Subject { sections: plcopen::sections, names: plcopen::names },
    Subject { sections: values::sections, names: values::names },
];

/// Returns the explanation of a name, `width` columns wide; it has a section for each object with that name.
///
/// # Errors
/// Returns an error message with the most similar names if no table has the name.
pub(crate) fn explain(name: &str, width: usize) -> Result<String, String> {
    let name = name.trim();
    let sections: Vec<String> = SUBJECTS.iter().flat_map(|subject| (subject.sections)(name, width)).collect();
    if sections.is_empty() { Err(unknown(name)) } else { Ok(sections.join("\n")) }
}

/// Returns the verbs of scenarios that do the same as a command or a function block of PLCopen of that name; underscores
/// and case are ignored.
pub(crate) fn verbs_of(name: &str) -> Vec<&'static str> {
    let bare = |text: &str| text.replace('_', "").to_lowercase();
    let name = bare(name);
    let is_called = |known: &str| bare(known) == name;
    let mut verbs: Vec<&'static str> = Vec::new();
    for verb in commands::equivalents(is_called).chain(plcopen::equivalents(is_called)) {
        if !verbs.contains(&verb) {
            verbs.push(verb);
        }
    }
    verbs
}

fn unknown(name: &str) -> String {
    let small = name.to_lowercase();
    let mut near: Vec<String> = SUBJECTS.iter().filter_map(|subject| meant(&small, &(subject.names)())).collect();
    near.sort_by_cached_key(|known| (strsim::damerau_levenshtein(&small, &known.to_lowercase()), known.clone()));
    near.dedup();
    near.retain(|known| !known.eq_ignore_ascii_case(name));
    near.truncate(MOST_MEANT);
    let near: Vec<_> = near.iter().map(|known| format!("`{known}`")).collect();
    let hint = if near.is_empty() {
        "a code, an object of CANopen, a parameter, a key, a signal, a value, a type of functions or its field, a verb, a command, a ROS \
         interface or its field, a function block or a term of PLCopen is expected"
            .to_owned()
    } else {
        format!("did you mean {}?", near.join(", "))
    };
    format!("`{}` is unknown; {hint}", excerpt(name))
}

/// Returns the most similar name; for `x.actual.postion`, the one most similar to the part after the object.
fn meant(name: &str, names: &[String]) -> Option<String> {
    let near = |text: &str| nearest(text, names.iter().map(String::as_str));
    let of_object = || name.split_once('.').and_then(|(object, rest)| Some(format!("{object}.{}", near(rest)?)));
    near(name).map(str::to_owned).or_else(of_object)
}

/// Returns a heading, and one line per fact with its label. Facts without a text are left out.
fn section(heading: &str, facts: &[(&str, &str)], width: usize) -> String {
    let mut text = format!("{heading}\n");
    for (label, said) in facts {
        let lines = wrap(&said.replace('`', ""), width.saturating_sub(LABEL + 2).max(NARROWEST));
        for (place, line) in lines.iter().enumerate() {
            let label = if place == 0 { *label } else { "" };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {label:LABEL$}{line}");
        }
    }
    text
}

/// Returns the line with the page that has more information.
fn documented(page: &str) -> String {
    format!("  {:LABEL$}{page}\n", "documented")
}

#[cfg(test)]
mod tests;

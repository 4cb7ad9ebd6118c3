//! Generates docs/parameters.md from the rows of the catalogue.

use super::words::{default_text, effect_text, range_words, storage_text, unit_text, views_of};
use lineshaft_core::parameter::{Effect, Equivalent, Group, ROWS, Row, System, Word};
use std::fmt::Write;

const INTRODUCTION: &str = "\
# Parameters

This page is made by the program: `lineshaft params --markdown > docs/parameters.md`. A test compares the two.

`lineshaft params` shows the same in a terminal: all, those of a pattern (`--name 'sync*'`) or of a source (`--system macs`), or
everything about one (`--name max_velocity`). With a cell it shows the values that its axes have.

## Names

A parameter of an axis is `<axis>.<key>`, in ROS 2 as in a scenario; in a cell the key is in the axis. Native names are those
of MoveIt and ros2_control. A parameter of another controller has the name that it has there, in small letters: of MACS as it
is (`x.kprop`), of the others behind a prefix (`x.saia.kprop`, `x.amc.rotary_mode`, `x.wf.md42`). Parameters of the whole machine
are `machine.<key>`. An axis has only those that apply to it.

Some native values have a second name, as MACS measures them: a *view*. `x.velmax` is `x.max_velocity` in rpm at the encoder. Both
show the one value, whichever was set. A file gives it by one of them; both in one file are an error.

A parameter whose function does not exist yet is there and has its default; anything else is refused with a sentence.

## Units

A quantity is `NUMBER UNIT`: `120 mm`, `0.5 m/s`, `20 ms`, `4000 inc`. A bare number is in the unit of the column *unit*: SI (m for
linear axes, rad for rotary ones) for native names, the source's own unit for the others. *Axis unit* is the key `unit` of the axis, the
user unit (UU) of the sources: a unit, or so many of one (`0.1 mm`). A parameter that counts increments (inc, the qc of MACS)
takes whole numbers. Ranges and defaults that are lengths are given here in increments, times in ms. An axis moves at most 2^31 increments in a
cycle, which is where limits of its velocity end: 2147483648000 inc/s with a cycle of 1 ms.

Whole numbers have the step 1. A value outside its range is refused, with the value and the range, and changes nothing. A default that
is outside its range means *not set* and is taken too.

## Layers

| layer | what it is | from | until |
|-|-|-|-|
| Init | the defaults of this page, and what the cell says | the start | the cell changes |
| User | what was saved: begins as Init | `~/save_parameters` | `~/delete_parameters` |
| Program | what was set | a set | the power goes, or `~/reset_parameters` |

In force is Program where something was set, else User, else Init. `~/reset_parameters` brings User or Init back into force;
`~/delete_parameters` forgets what was saved. A set of several parameters applies as a whole or not at all: values bound to each
other (limits, steps, defaults and their maxima) are checked together, with what the axis is doing.

Column *kept*:

| | |
|-|-|
| saved | may be set at any time; `~/save_parameters` keeps it |
| until the power goes | may be set at any time; begins again with each start |
| cell, read-only | part of the structure: changes with the cell and a new start |
| computed, read-only | follows from others |
| signal | no parameter here: read the signal of that name behind the axis |
";

const WORDS: &str = "
## Where the words of the sources live

Each machine datum, register and mnemonic, as its source writes it. `check`, scenarios and the parameter services know these words, too:
a key `MD18` is answered with `modulo`.
";

const SYSTEMS: [System; 5] = [System::Native, System::Macs, System::Amc, System::Saia, System::Wf];

const GROUPS: [Group; 11] = [
    Group::Basic,
    Group::Encoder,
    Group::Inputs,
    Group::Homing,
    Group::Synchronization,
    Group::Regulation,
    Group::Amplifier,
    Group::Global,
    Group::Menu,
    Group::Registers,
    Group::MachineData,
];

const EFFECTS: [Effect; 6] = [
    Effect::AtOnce,
    Effect::NextMotion,
    Effect::NextSynchronize,
    Effect::NextSaiaCommand,
    Effect::Disabled,
    Effect::Start,
];

/// Returns the content of the page.
pub fn markdown() -> String {
    let mut page = INTRODUCTION.to_owned();
    page.push_str("\n## When a value takes effect\n\nColumn *effective*:\n\n| | |\n|-|-|\n");
    for effect in EFFECTS {
        // Writing to a string cannot fail.
        let _ = writeln!(page, "| {} | {} |", effect_text(effect), effect.text());
    }
    for system in SYSTEMS {
        let rows = |group| ROWS.iter().filter(move |row| row.system == system && row.group == group);
        let count = ROWS.iter().filter(|row| row.system == system).count();
        let _ = writeln!(page, "\n## {}\n\n{count} parameters.", system.name());
        for group in GROUPS.into_iter().filter(|group| rows(*group).next().is_some()) {
            let _ = writeln!(page, "\n### {}: {}\n", system.name(), group.text());
            page.push_str("| name | source | unit | range | default | kept | effective | for | what |\n");
            page.push_str("|-|-|-|-|-|-|-|-|-|\n");
            rows(group).for_each(|row| page.push_str(&line(row)));
        }
    }
    page.push_str(&words());
    page
}

/// Returns the table with the key of each word of the sources.
fn words() -> String {
    let mut text = String::from(WORDS);
    for system in SYSTEMS {
        let lines: Vec<_> = Word::all().filter(|word| word.system == system).collect();
        if lines.is_empty() {
            continue;
        }
        let _ = writeln!(text, "\n### Words of {}\n\n| word | here |\n|-|-|", system.name());
        for word in lines {
            let here = match word.equivalent {
                Equivalent::Parameter(key) => format!("`{key}`"),
                Equivalent::Key(key) => format!("key `{key}` of the axis in its cell"),
                Equivalent::Words(words) => words.to_owned(),
            };
            let number =
                ROWS.iter().find(|row| row.system == system && row.mnemonic == word.name).map(|row| row.number);
            let number =
                number.filter(|number| number.contains('.')).map_or(String::new(), |number| format!("{number} "));
            let _ = writeln!(text, "| {number}{} | {here} |", word.name);
        }
    }
    text
}

fn line(row: &Row) -> String {
    let source = [row.mnemonic, row.number].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ");
    let cells = [
        format!("`{}`", row.key),
        source,
        unit_text(row),
        range_words(row),
        default_text(row),
        storage_text(row.storage),
        effect_text(row.effect).to_owned(),
        row.applies.text().to_owned(),
        what(row),
    ];
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// Returns description, views, missing parts, decisions and requirements of a row.
fn what(row: &Row) -> String {
    let mut text = row.description.to_owned();
    if row.is_view() {
        let _ = write!(text, " View of `{}`.", row.view_of);
    }
    let views = views_of(row);
    if !views.is_empty() {
        let views: Vec<String> = views.iter().map(|view| format!("`{view}`")).collect();
        let _ = write!(text, " Views: {}.", views.join(", "));
    }
    if !row.missing.is_empty() {
        let _ = write!(text, " *Not yet: {}.*", row.missing);
    }
    if !row.note.is_empty() {
        let _ = write!(text, " {}", row.note);
    }
    let _ = write!(text, " ({})", row.source);
    text
}

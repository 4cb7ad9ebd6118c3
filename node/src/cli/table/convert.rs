//! `lineshaft table convert`.

use super::args::ConvertArgs;
use super::{Exit, Failure, Format, name, read_csv, save};
use crate::cell::{Files, table as entry};
use crate::cli::say;
use crate::document::{Document, MAX_BYTES, MAX_VALUES, Value};
use crate::scenario::{did_you_mean, nearest};
use crate::table::csv;
use crate::table::form::{with_places, without_places};
use lineshaft_core::table::{CamSetting, Form, Interpolation, Table};
use lineshaft_core::unit::excerpt;
use lineshaft_ros::layer::open_file;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

/// Numbers per line of YAML.
const IN_LINE: usize = 12;

pub(super) fn convert(args: &ConvertArgs) -> Result<Exit, Failure> {
    let (from, to) = (Format::of(&args.input)?, Format::of(&args.output)?);
    if args.form.is_some() && from == Format::Yaml {
        return Err(Failure::Sentence("--form is for a CSV file; an entry of `tables` says it itself".to_owned()));
    }
    if args.name.is_some() && (from, to) == (Format::Csv, Format::Csv) {
        return Err(Failure::Sentence("--name is for a .yaml file; a CSV file has no names".to_owned()));
    }
    if to == Format::Yaml {
        only_a_table(&args.output)?;
    }
    let (called, read) = match from {
        Format::Csv => (None, read_csv(&args.input, args.form.map_or(Form::Y, Form::from))?),
        Format::Yaml => {
            let (called, table) = of_cell(&args.input, args.name.as_deref())?;
            (Some(called), table)
        }
    };
    let table = in_form(&read, args)?;
    let text = match to {
        Format::Csv => csv::text(&table, &[format!("form {}, {} points", table.form().name(), table.len())]),
        Format::Yaml => {
            let stem = || args.input.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            // A table that was read by its name keeps it.
            let called = called.or_else(|| args.name.clone()).unwrap_or_else(stem);
            snippet(&table, &called, &args.output)?
        }
    };
    save(&args.output, &text)?;
    say(&args.output.display());
    Ok(Exit::Good)
}

/// Refuses to replace a file that has more than section `tables`, such as a cell or the description of a table.
fn only_a_table(output: &Path) -> Result<(), Failure> {
    // A disk error is reported when the file is written.
    let Ok(mut file) = open_file(output) else { return Ok(()) };
    let mut old = Vec::new();
    if file.read_to_end(&mut old).is_err() {
        return Ok(());
    }
    let is_of_table = |line: &str| line.is_empty() || line.starts_with([' ', '#']) || line == "tables:";
    if String::from_utf8_lossy(&old).lines().all(is_of_table) {
        return Ok(());
    }
    let sentence = "exists and is more than a table, so it is not replaced; name another file";
    Err(Failure::Sentence(format!("{} {sentence}", output.display())))
}

fn in_form(read: &Table, args: &ConvertArgs) -> Result<Table, Failure> {
    let (from, to) = (read.form(), args.to.map_or(read.form(), Form::from));
    let sentence = |sentence: String| Failure::Sentence(format!("{}: {sentence}", args.input.display()));
    let is_cam = to == Form::Y && Format::of(&args.output)? == Format::Yaml;
    if args.master.is_some() && (from != Form::Y || to != Form::Xy && !is_cam) {
        let sentence = "--master is for a table of form y that gets places, or its length as a cam in a .yaml file";
        return Err(Failure::Sentence(sentence.to_owned()));
    }
    let setting = read.cam_setting();
    let length = args.master.or(setting.length);
    let converted = match (from, to) {
        (Form::Y, Form::Y) => return Ok(read.clone().with_cam(CamSetting { length, ..setting })),
        (Form::Y, Form::Xy) => {
            let master = length
                .ok_or_else(|| sentence("form y has no places; --master with its period (inc) is needed".to_owned()))?;
            with_places(read, master)
        }
        (Form::Xy, Form::Y) => without_places(read),
        (from, to) if from == to => return Ok(read.clone()),
        _ => {
            let words = "words are those of a data block; no other form becomes them, nor they another";
            return Err(sentence(words.to_owned()));
        }
    };
    converted.map_err(|error| sentence(error.to_string()))
}

/// Returns a table of a cell, or of a part of one, by its name.
fn of_cell(path: &Path, wanted: Option<&str>) -> Result<(String, Table), Failure> {
    let document = Document::read(path);
    let found = document.root("the file").and_then(|root| chosen(&root, wanted, &Files::in_folder_of(path)));
    let problems = document.into_problems();
    found.filter(|_| problems.is_empty()).ok_or_else(|| Failure::Problems(problems.to_string()))
}

fn chosen(root: &Value<'_>, wanted: Option<&str>, files: &Files) -> Option<(String, Table)> {
    let mut map = root.map("the file")?;
    let section = map.required("tables")?;
    // The other keys of a cell are not checked.
    map.rest();
    map.finish();
    let entries = section.entries()?;
    let names = || entries.iter().filter_map(|(key, _)| key.peek());
    let listed = || names().map(excerpt).collect::<Vec<_>>().join(", ");
    let (key, value) = match (wanted, entries.as_slice()) {
        (None, [only]) => only,
        (None, []) => {
            section.refuse("tables has no entry; one is expected", None);
            return None;
        }
        (None, _) => {
            section.refuse(
                format!("tables has {} entries; --name with one of {} is needed", entries.len(), listed()),
                None,
            );
            return None;
        }
        (Some(wanted), entries) => {
            let Some(found) = entries.iter().find(|(key, _)| key.peek() == Some(wanted)) else {
                let hint = nearest(wanted, names()).map(did_you_mean);
                section.refuse(format!("no table is called `{}`; {} are known", excerpt(wanted), listed()), hint);
                return None;
            };
            found
        }
    };
    let called = key.name()?;
    let table = entry(value, called, files)?.table;
    Some((called.to_owned(), (*table).clone()))
}

/// Returns the key of a table that is a cam.
fn cam(table: &Table) -> String {
    let CamSetting { length, is_cyclic, interpolation } = table.cam_setting();
    let length = length.map(|length| format!("length: {length}"));
    let cyclic = (!is_cyclic).then(|| "cyclic: false".to_owned());
    let spline =
        Interpolation::ALL.iter().find(|(_, known)| *known == interpolation && *known != Interpolation::Linear);
    let spline = spline.map(|(name, _)| format!("interpolation: {name}"));
    let parts: Vec<String> = length.into_iter().chain(cyclic).chain(spline).collect();
    if parts.is_empty() { String::new() } else { format!("    cam: {{{}}}\n", parts.join(", ")) }
}

/// Returns a table in the format of a cell.
fn snippet(table: &Table, called: &str, output: &Path) -> Result<String, Failure> {
    let as_key = Document::parse("the name", format!("{called}: 0\n"));
    let is_name = as_key
        .root("it")
        .and_then(|root| root.entries())
        .and_then(|entries| Some(entries.first()?.0.name() == Some(called)));
    if is_name != Some(true) {
        let sentence = "is no name; --name with a letter a..z, then a..z, 0..9 and _, at most 32 characters, is needed";
        return Err(Failure::Sentence(format!("`{}` {sentence}", excerpt(called))));
    }
    let key = if table.form() == Form::Words { "words" } else { "points" };
    let cam = cam(table);
    if let (false, Err(error)) = (cam.is_empty(), table.cam()) {
        return Err(Failure::Sentence(format!("{} is not written: {error}", name(output))));
    }
    let mut text = format!("tables:\n  {called}:\n    form: {}\n{cam}    {key}: [", table.form().name());
    let mut places = table.x().iter();
    for (nth, value) in table.y().iter().enumerate() {
        text.push_str(match nth {
            0 => "",
            nth if nth % IN_LINE == 0 => ",\n      ",
            _ => ", ",
        });
        // Writing to a string cannot fail.
        let _ = match places.next() {
            Some(place) => write!(text, "[{place}, {value}]"),
            None => write!(text, "{value}"),
        };
    }
    text.push_str("]\n");
    if !Document::parse("", text.as_str()).problems().is_empty() {
        let mib = MAX_BYTES >> 20;
        return Err(Failure::Sentence(format!(
            "{} points are more than a cell holds ({MAX_VALUES} values, of which a point of form xy is three, in {mib} MiB); keep them in a CSV \
             file beside it, {} is not written",
            table.len(),
            name(output)
        )));
    }
    Ok(text)
}

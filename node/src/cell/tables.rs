//! Reads section `tables`: numbers for functions, in the cell or in a CSV file next to it.

use super::backends::Context;
use super::names::{Section, quote};
use crate::document::{Place, Problems, Value};
use crate::program;
use crate::table::csv::{self, Numbers, Refused};
use lineshaft_core::config::TableConfig;
use lineshaft_core::table::{CamSetting, Form, Interpolation, MAX_LENGTH, Table, first_non_rising};
use lineshaft_core::unit::excerpt;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Source of the CSV files of tables and the modules of programs.
#[derive(Debug)]
pub(crate) enum Files {
    /// No files: the cell is a text.
    None,
    /// Files in that folder; the content of files that were read is stored.
    Beside(PathBuf, RefCell<BTreeMap<String, String>>),
    /// Known files, by their names in the cell.
    Known(BTreeMap<String, String>),
}

impl Files {
    pub(crate) fn in_folder_of(cell: &Path) -> Self {
        Self::Beside(cell.parent().unwrap_or(Path::new("")).to_owned(), RefCell::default())
    }

    /// Returns the files that were read, by their names in the cell.
    pub(crate) fn into_read(self) -> BTreeMap<String, String> {
        match self {
            Self::None => BTreeMap::new(),
            Self::Beside(_, read) => read.into_inner(),
            Self::Known(read) => read,
        }
    }

    /// Reads a module.
    pub(super) fn module(&self, name: &str) -> Result<Vec<u8>, String> {
        match self {
            Self::None => Err("a cell without a file has no files beside it".to_owned()),
            Self::Known(known) => {
                let text = known.get(name).ok_or("it was not recorded")?;
                program::decode(text).ok_or_else(|| "it was recorded as no module".to_owned())
            }
            Self::Beside(folder, read) => {
                let bytes = program::load(&folder.join(name))?;
                read.borrow_mut().insert(name.to_owned(), program::encode(&bytes));
                Ok(bytes)
            }
        }
    }

    fn read(&self, name: &str) -> Result<String, Refused> {
        let unread = |sentence: &str| Err(Refused { place: None, sentence: sentence.to_owned() });
        match self {
            Self::None => unread("a cell without a file has no files beside it"),
            Self::Known(known) => known.get(name).cloned().map_or_else(|| unread("it was not recorded"), Ok),
            Self::Beside(folder, read) => {
                let text = csv::load(&folder.join(name))?;
                read.borrow_mut().insert(name.to_owned(), text.clone());
                Ok(text)
            }
        }
    }
}

/// Reads all tables, in the order of the file.
pub(super) fn read(cx: &Context<'_>, files: &Files) -> Vec<Option<TableConfig>> {
    let entries = cx.names.section(Section::Tables);
    entries.iter().map(|entry| table(&entry.value, entry.name(), files)).collect()
}

/// Returns the indices of the tables that are cams according to the cell.
pub(super) fn cams(cx: &Context<'_>) -> Vec<u16> {
    let is_cam =
        |value: &Value<'_>| value.entries().unwrap_or_default().iter().any(|(key, _)| key.peek() == Some("cam"));
    let entries = (0_u16..).zip(cx.names.section(Section::Tables));
    entries.filter(|(_, entry)| is_cam(&entry.value)).map(|(place, _)| place).collect()
}

/// Reads one table.
pub(crate) fn table(value: &Value<'_>, name: &str, files: &Files) -> Option<TableConfig> {
    let mut map = value.map(format!("table {}", quote(name)))?;
    let form = map.required("form").and_then(|form| form.choice(&Form::ALL.map(|(form, name)| (name, form))));
    let key = if form == Some(Form::Words) { "words" } else { "points" };
    let (given, csv) = (map.optional(key), map.optional("csv"));
    let numbers = match (&given, &csv) {
        (Some(given), None) => form.and_then(|form| listed(given, form)),
        (None, Some(csv)) => csv.text().zip(form).and_then(|(file, form)| of_file(csv, file, form, files)),
        (Some(_), Some(csv)) => {
            csv.refuse(format!("csv stands beside {key}; one of them is expected"), None);
            None
        }
        (None, None) => {
            map.refuse(format!("table {} has no numbers; {key} or csv is expected", quote(name)), None);
            None
        }
    };
    let cam = map.optional("cam");
    let setting = cam.as_ref().map_or(Some(CamSetting::default()), |cam| cam_setting(cam, form));
    map.finish();
    let (x, y) = numbers?;
    if let Some(given) = &given
        && !rise(given, &x)
    {
        return None;
    }
    let table = match Table::new(form?, &x, &y) {
        Ok(table) => table.with_cam(setting?),
        Err(error) => {
            given.or(csv)?.refuse(error.to_string(), None);
            return None;
        }
    };
    if let (Some(cam), Err(error)) = (cam, table.cam()) {
        cam.refuse(error.to_string(), None);
        return None;
    }
    Some(TableConfig { name: name.to_owned(), table: Arc::new(table) })
}

/// Reads the keys of a table that is a cam.
fn cam_setting(value: &Value<'_>, form: Option<Form>) -> Option<CamSetting> {
    let mut map = value.map("cam")?;
    let length = map.optional("length");
    let given = length.as_ref().map_or(Some(None), |length| length.integer(1..=MAX_LENGTH).map(Some));
    let is_cyclic = map.optional("cyclic").map_or(Some(true), |cyclic| cyclic.boolean());
    let interpolation = map
        .optional("interpolation")
        .map_or(Some(Interpolation::Linear), |interpolation| interpolation.choice(&Interpolation::ALL));
    map.finish();
    if let Some(length) = length
        && form == Some(Form::Xy)
    {
        length.refuse("a table of form xy is as long as its last place", Some("leave it out".to_owned()));
        return None;
    }
    Some(CamSetting { length: given?, is_cyclic: is_cyclic?, interpolation: interpolation? })
}

/// Checks that positions increase; refuses the first one that does not.
fn rise(given: &Value<'_>, x: &[i64]) -> bool {
    let Some((number, sentence)) = first_non_rising(x) else { return true };
    let point = given.list().and_then(|items| items.into_iter().nth(number));
    point.as_ref().unwrap_or(given).refuse(sentence, None);
    false
}

/// Reads the numbers of a list.
pub(crate) fn listed(given: &Value<'_>, form: Form) -> Option<Numbers> {
    let items = given.list()?;
    let whole = |value: &Value<'_>| value.integer(i64::from(i32::MIN)..=i64::from(i32::MAX));
    if form != Form::Xy {
        let numbers: Vec<_> = items.iter().map(whole).collect();
        return Some((Vec::new(), numbers.into_iter().collect::<Option<_>>()?));
    }
    let pair = |item: &Value<'_>| {
        let parts = item.list()?;
        let [x, y] = parts.as_slice() else {
            item.refuse(format!("a point of form xy has {} numbers; [master, slave] is expected", parts.len()), None);
            return None;
        };
        Some((whole(x)?, whole(y)?))
    };
    let pairs: Vec<_> = items.iter().map(pair).collect();
    Some(pairs.into_iter().collect::<Option<Vec<_>>>()?.into_iter().unzip())
}

fn of_file(entry: &Value<'_>, file: &str, form: Form, files: &Files) -> Option<Numbers> {
    let numbers = files.read(file).and_then(|text| csv::parse(&text, form));
    let Refused { place, sentence } = match numbers {
        Ok(numbers) => return Some(numbers),
        Err(refused) => refused,
    };
    entry.refuse(
        match place {
            Some(Place { line, col }) => format!("{}, line {line}, column {col}: {sentence}", excerpt(file)),
            None => format!("cannot read {}: {sentence}", quote(file)),
        },
        None,
    );
    None
}

/// Returns the files of a recording as one text: JSON with names and contents.
pub(crate) fn files_text(files: &BTreeMap<String, String>) -> String {
    serde_json::to_string(files).unwrap_or_default()
}

/// Reads a text that [`files_text`] wrote.
pub(crate) fn files_of(text: &str) -> Result<Files, Problems> {
    serde_json::from_str(text).map(Files::Known).map_err(|error| {
        let problems = Problems::new("tables");
        problems.push(Place::START, format!("the attached files of tables cannot be read: {error}"), None);
        problems
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_a_recording_read_back() {
        let files = BTreeMap::from([("a.csv".to_owned(), "0\n1\n".to_owned())]);
        let Ok(Files::Known(known)) = files_of(&files_text(&files)) else { panic!("it reads back") };
        assert_eq!(known, files);
        assert!(files_of("[").is_err());
    }

    #[test]
    fn table_with_an_empty_key_cam_is_loaded_as_a_cam() {
        let text = "lineshaft: 1\ncycle: 1 ms\naxes: {}\ntables:\n  curve: {form: xy, points: [[0, 0], [10, 5]]}\n  \
                    round: {form: xy, points: [[0, 0], [10, 5]], cam: {}}\n";
        let cell = crate::cell::Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        let load = |name: &str, x: &[i64]| cell.machine.resolve_load_table(name, x, &[0, 10]).is_ok();
        assert_eq!((load("curve", &[5, 10]), load("round", &[5, 10]), load("round", &[0, 10])), (true, false, true));
    }
}

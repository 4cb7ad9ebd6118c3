//! Section `tables`: numbers that functions read, written in the cell or in a CSV file beside it.

use super::backends::Context;
use super::names::{Section, quote};
use crate::document::{Place, Problems, Value};
use lineshaft_core::config::TableConfig;
use lineshaft_core::table::{CamSetting, Form, Interpolation, MOST, MOST_LENGTH, Table};
use lineshaft_core::unit::excerpt;
use lineshaft_ros::layer::open_file;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Longest CSV file (bytes).
const MAX_BYTES: u64 = 4 << 20;

/// Where the CSV files of tables are.
#[derive(Debug)]
pub(crate) enum Files {
    /// Nowhere: the cell is a text.
    None,
    /// In that folder; what was read is kept.
    Beside(PathBuf, RefCell<BTreeMap<String, String>>),
    /// Read before, by their names in the cell.
    Known(BTreeMap<String, String>),
}

impl Files {
    pub(crate) fn beside(cell: &Path) -> Self {
        Self::Beside(cell.parent().unwrap_or(Path::new("")).to_owned(), RefCell::default())
    }

    /// What was read, by the names in the cell.
    pub(crate) fn into_read(self) -> BTreeMap<String, String> {
        match self {
            Self::None => BTreeMap::new(),
            Self::Beside(_, read) => read.into_inner(),
            Self::Known(read) => read,
        }
    }

    fn read(&self, name: &str) -> Result<String, String> {
        match self {
            Self::None => Err("a cell without a file has no files beside it".to_owned()),
            Self::Known(known) => known.get(name).cloned().ok_or_else(|| "it was not recorded".to_owned()),
            Self::Beside(folder, read) => {
                let text = load(&folder.join(name))?;
                read.borrow_mut().insert(name.to_owned(), text.clone());
                Ok(text)
            }
        }
    }
}

/// All tables, in file order.
pub(super) fn read(cx: &Context<'_>, files: &Files) -> Vec<Option<TableConfig>> {
    let entries = cx.names.section(Section::Tables);
    entries.iter().map(|entry| table(&entry.value, entry.name(), files)).collect()
}

fn table(value: &Value<'_>, name: &str, files: &Files) -> Option<TableConfig> {
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

/// What is said of a table as a cam.
fn cam_setting(value: &Value<'_>, form: Option<Form>) -> Option<CamSetting> {
    let mut map = value.map("cam")?;
    let length = map.optional("length");
    let given = length.as_ref().map_or(Some(None), |length| length.integer(1..=MOST_LENGTH).map(Some));
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

/// The numbers of a list.
pub(crate) fn listed(given: &Value<'_>, form: Form) -> Option<(Vec<i64>, Vec<i64>)> {
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

fn of_file(csv: &Value<'_>, file: &str, form: Form, files: &Files) -> Option<(Vec<i64>, Vec<i64>)> {
    let text = match files.read(file) {
        Ok(text) => text,
        Err(reason) => {
            csv.refuse(format!("cannot read {}: {reason}", quote(file)), None);
            return None;
        }
    };
    match parse(&text, form) {
        Ok(numbers) => Some(numbers),
        Err((Place { line, .. }, sentence)) => {
            csv.refuse(format!("{}, line {line}: {sentence}", excerpt(file)), None);
            None
        }
    }
}

/// The numbers of a CSV file: one column, or two of form xy; `#` begins a comment. The first problem with its line.
pub(crate) fn parse(text: &str, form: Form) -> Result<(Vec<i64>, Vec<i64>), (Place, String)> {
    let columns = if form == Form::Xy { 2 } else { 1 };
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (line, row) in (1..).zip(text.lines()) {
        let row = row.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        let problem = |sentence| (Place { line, col: 1 }, sentence);
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != columns {
            return Err(problem(format!("{} columns stand there; {columns} are expected", fields.len())));
        }
        if y.len() == MOST {
            return Err(problem(format!("more than {MOST} numbers")));
        }
        let mut numbers = Vec::with_capacity(columns);
        for field in fields {
            numbers.push(
                whole(field).ok_or_else(|| problem(format!("`{}` is no whole number of 32 bits", excerpt(field))))?,
            );
        }
        let mut numbers = numbers.into_iter();
        if form == Form::Xy {
            x.extend(numbers.next());
        }
        y.extend(numbers.next());
    }
    Ok((x, y))
}

/// A whole number, which may be written with a decimal point and zeros behind it.
fn whole(field: &str) -> Option<i64> {
    let digits = match field.split_once('.') {
        Some((digits, zeros)) if zeros.chars().all(|c| c == '0') => digits,
        Some(_) => return None,
        None => field,
    };
    digits.parse::<i32>().ok().map(i64::from)
}

fn load(path: &Path) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = open_file(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    read.map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("it is longer than {MAX_BYTES} bytes"));
    }
    String::from_utf8(bytes).map_err(|_| "it is not UTF-8 text".to_owned())
}

/// The files of a recording as one text, and back: a mapping of names to texts.
pub(crate) fn files_text(files: &BTreeMap<String, String>) -> String {
    serde_json::to_string(files).unwrap_or_default()
}

/// Reads what [`files_text`] wrote.
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
    fn a_csv_has_one_column_or_two_and_comments() {
        let text = "# rise\n0\n1000 # half\n\n4000.0\n";
        assert_eq!(parse(text, Form::Y), Ok((vec![], vec![0, 1000, 4000])));
        assert_eq!(parse("0, 0\n5000,1200\n", Form::Xy), Ok((vec![0, 5000], vec![0, 1200])));
        let refused = |text, form| parse(text, form).map_err(|(place, sentence)| (place.line, sentence));
        assert_eq!(refused("0\n1,2\n", Form::Y), Err((2, "2 columns stand there; 1 are expected".to_owned())));
        assert_eq!(refused("0\n1.5\n", Form::Y), Err((2, "`1.5` is no whole number of 32 bits".to_owned())));
        assert!(refused("3000000000\n", Form::Y).is_err());
    }

    #[test]
    fn files_of_a_recording_read_back() {
        let files = BTreeMap::from([("a.csv".to_owned(), "0\n1\n".to_owned())]);
        let Ok(Files::Known(known)) = files_of(&files_text(&files)) else { panic!("it reads back") };
        assert_eq!(known, files);
        assert!(files_of("[").is_err());
    }
}

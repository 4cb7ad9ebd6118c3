//! Reads a column of a CSV file as values of a driven signal.
//!
//! The first row has the names of the columns; fields are separated by commas and may be in quotes. A file written with
//! `--csv` can be read back.

use super::ruler::{ALL_WHOLE, ValueFormat, is_exact};
use crate::document::{Place, Problems, Value};
use lineshaft_core::signal::{Type, Value as Number};
use lineshaft_core::unit::excerpt;
use lineshaft_ros::layer::open_file;
use std::io::Read;
use std::path::Path;

/// Maximum size of a file, in bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Reads `{file, column}`; the file is relative to `folder`, and its problems are added to `all`.
pub(super) fn read(value: &Value<'_>, folder: &Path, ruler: &ValueFormat, all: &Problems) -> Option<Vec<Number>> {
    let mut map = value.map("csv")?;
    let (file, column) = (map.required("file"), map.required("column"));
    let name = file.as_ref().and_then(|file| file.text());
    let column_name = column.as_ref().and_then(|column| column.text());
    map.finish();
    let (file, column) = (file?, column?);
    let path = folder.join(name?);
    let text = match load(&path) {
        Ok(text) => text,
        Err(reason) => {
            file.refuse(format!("cannot read {}: {reason}", path.display()), None);
            return None;
        }
    };
    let problems = Problems::new(&path.display().to_string());
    let rows = match find_column(&text, column_name?) {
        Ok(index) => rows(&text, index, ruler, &problems),
        Err(known) => {
            let sentence = format!("{} has no column `{}`", path.display(), excerpt(column_name?));
            column.refuse(format!("{sentence}; it has {known}"), None);
            return None;
        }
    };
    if problems.is_empty() && rows.is_empty() {
        file.refuse(format!("{} has no rows below its head", path.display()), None);
        return None;
    }
    let good = problems.is_empty();
    all.append(problems);
    good.then_some(rows)
}

fn load(path: &Path) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = open_file(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    read.map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("it is longer than {MAX_BYTES} bytes"));
    }
    let text = String::from_utf8(bytes).map_err(|_| "it is not UTF-8 text".to_owned())?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Returns the index of a column; if there is none, the error lists the columns.
fn find_column(text: &str, name: &str) -> Result<usize, String> {
    let head = text.lines().next().unwrap_or_default();
    let known = || head.split(',').map(|field| excerpt(plain(field))).collect::<Vec<_>>().join(", ");
    head.split(',').position(|field| plain(field) == name).ok_or_else(known)
}

fn plain(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|field| field.strip_suffix('"')).unwrap_or(field)
}

fn rows(text: &str, index: usize, ruler: &ValueFormat, problems: &Problems) -> Vec<Number> {
    let mut rows = Vec::new();
    for (line, row) in text.trim_end().lines().enumerate().skip(1) {
        let before: usize = row.split(',').take(index).map(|field| field.chars().count() + 1).sum();
        let place = Place { line: line + 1, col: before + 1 };
        match row.split(',').nth(index).map(plain) {
            None => problems.push(place, format!("the row has no column {}", index + 1), None),
            Some(field) => match number(field, ruler) {
                Some(number) => rows.push(number),
                None => {
                    let sentence = format!("`{}` is no value here; {} is expected", excerpt(field), expected(ruler));
                    problems.push(place, sentence, None);
                }
            },
        }
    }
    rows
}

fn number(field: &str, ruler: &ValueFormat) -> Option<Number> {
    let (low, high) = ruler.range;
    match ruler.kind {
        Type::Real => field.parse().ok().filter(|value: &f64| value.is_finite()).map(Number::Real),
        Type::Bit => field.parse().ok().filter(|value| (0..=1).contains(value)).map(Number::Int),
        Type::Int | Type::Word | Type::Enum(_) => {
            let fits = |value: &i64| (low..=high).contains(value) && (!ruler.in_f64 || is_exact(*value));
            field.parse::<i64>().ok().filter(fits).map(Number::Int)
        }
    }
}

fn expected(ruler: &ValueFormat) -> String {
    match (ruler.kind, ruler.range) {
        _ if ruler.in_f64 => "a whole number, beyond +-2^53 one that an f64 holds,".to_owned(),
        (Type::Real, _) => "a finite number".to_owned(),
        (Type::Bit, _) => "0 or 1".to_owned(),
        (_, ALL_WHOLE) => "a whole number".to_owned(),
        (_, (low, high)) => format!("a whole number {low}..{high}"),
    }
}

//! Reads and writes numbers of tables as CSV files.
//!
//! Law      one column, or position and value for form xy; `#` begins a comment; a byte order mark and CRLF are
//!          accepted
//! Reads    integers of 32 bits, optionally with a decimal point and zeros after it
//! Refuses  anything else, with line and column: NaN, fractions, a header, `;`, a decimal comma, positions that do not
//!          increase, more than [`MAX_NUMBERS`] points

use crate::document::Place;
use lineshaft_core::table::{Form, MAX_NUMBERS, Table};
use lineshaft_core::unit::excerpt;
use lineshaft_ros::layer::open_file;
use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

/// Maximum size of a file, in bytes: two numbers of 32 bits for each of [`MAX_NUMBERS`] points, and the same size for spaces
/// and comments.
const MAX_BYTES: u64 = 64 << 20;
/// Windows programs write it before a text in UTF-8.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Positions of the master, empty except for form xy, and values.
pub(crate) type Numbers = (Vec<i64>, Vec<i64>);

/// Error of a file, with its location if it could be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refused {
    pub(crate) place: Option<Place>,
    pub(crate) sentence: String,
}

impl Refused {
    fn at(place: Place, sentence: String) -> Self {
        Self { place: Some(place), sentence }
    }
}

/// Reads the text of a file.
pub(crate) fn load(path: &Path) -> Result<String, Refused> {
    let mut bytes = Vec::new();
    let read = open_file(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    let unread = |sentence| Refused { place: None, sentence };
    read.map_err(|error| unread(error.to_string()))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(unread(format!("it is longer than {MAX_BYTES} bytes")));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.as_bytes().get(..error.utf8_error().valid_up_to()).unwrap_or_default();
        Refused::at(Place::after(&String::from_utf8_lossy(valid)), "it is not UTF-8 text".to_owned())
    })
}

/// Parses the numbers of a text. Returns the first problem with its location.
pub(crate) fn parse(text: &str, form: Form) -> Result<Numbers, Refused> {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    // Line of the previous position.
    let mut before = 0;
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    for (number, line) in (1..).zip(text.lines()) {
        let row = Row { line, data: line.split('#').next().unwrap_or_default(), number };
        if row.data.trim().is_empty() {
            continue;
        }
        if y.len() == MAX_NUMBERS {
            return Err(row.refused(row.data, format!("this is point {}; {MAX_NUMBERS} are possible", MAX_NUMBERS + 1)));
        }
        let mut fields = row.data.split(',');
        let (first, second, third) = (fields.next().unwrap_or_default(), fields.next(), fields.next());
        let is_first = y.is_empty();
        let value = match (form, second, third) {
            (Form::Xy, Some(second), None) => {
                let place = row.whole(first, is_first)?;
                if let Some(last) = x.last().filter(|last| **last >= place) {
                    let sentence = format!("place {place} is not after {last}, the one of line {before}; places rise");
                    return Err(row.refused(first, sentence));
                }
                x.push(place);
                before = number;
                second
            }
            (Form::Y | Form::Words, None, _) => first,
            _ => return Err(row.other_columns(form)),
        };
        y.push(row.whole(value, is_first)?);
    }
    Ok((x, y))
}

/// A line with numbers.
#[derive(Clone, Copy)]
struct Row<'a> {
    /// Full line, with its comment.
    line: &'a str,
    data: &'a str,
    /// Line number, from 1.
    number: usize,
}

impl Row<'_> {
    /// Returns a problem of a part of the line; its location is the start of the part, without spaces.
    fn refused(&self, part: &str, sentence: String) -> Refused {
        let blanks = part.len() - part.trim_start().len();
        // Parts are slices of the line.
        let offset = (part.as_ptr() as usize).saturating_sub(self.line.as_ptr() as usize) + blanks;
        let col = 1 + self.line.get(..offset).map_or(0, |before| before.chars().count());
        Refused::at(Place { line: self.number, col }, sentence)
    }

    /// Parses the number of a field.
    fn whole(&self, field: &str, is_first: bool) -> Result<i64, Refused> {
        let given = field.trim();
        whole(given).ok_or_else(|| match given.find(';') {
            Some(at) => {
                let rest = given.get(at..).unwrap_or_default();
                self.refused(rest, "`;` stands between columns; a comma is expected".to_owned())
            }
            None => self.refused(field, why(given, is_first)),
        })
    }

    /// Returns the error for a wrong number of columns.
    fn other_columns(&self, form: Form) -> Refused {
        let columns = if form == Form::Xy { 2 } else { 1 };
        if self.data.contains(';') {
            let at = self.data.find(';').unwrap_or_default();
            let rest = self.data.get(at..).unwrap_or_default();
            return self.refused(rest, "`;` stands between columns; a comma is expected".to_owned());
        }
        let count = self.data.split(',').count();
        if count < columns {
            return self.refused(self.data, "1 column stands there; 2 are expected, place and value".to_owned());
        }
        let expected = match form {
            Form::Xy => "2 are expected; a decimal sign is a point",
            _ => "1 is expected; a decimal sign is a point, and two columns are of form xy",
        };
        let surplus = self.data.split(',').nth(columns).unwrap_or_default();
        self.refused(surplus, format!("{count} columns stand there; {expected}"))
    }
}

/// Parses an integer, optionally with a decimal point and zeros after it.
fn whole(field: &str) -> Option<i64> {
    let digits = match field.split_once('.') {
        Some((digits, zeros)) if zeros.bytes().all(|c| c == b'0') => digits,
        Some(_) => return None,
        None => field,
    };
    digits.parse::<i32>().ok().map(i64::from)
}

/// Returns the reason why a field is no integer of 32 bits.
fn why(field: &str, is_first: bool) -> String {
    let given = excerpt(field);
    match field.parse::<f64>() {
        _ if field.is_empty() => "a column is empty; a whole number is expected".to_owned(),
        Ok(value) if !value.is_finite() && !field.contains(|c: char| c.is_ascii_digit()) => {
            format!("`{given}` is not finite; a whole number is expected")
        }
        Ok(value) if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value) => {
            format!("`{given}` is beyond 32 bits; {} to {} is possible", i32::MIN, i32::MAX)
        }
        Ok(value) if value.fract() != 0.0 => format!("`{given}` is a fraction; a whole number is expected"),
        _ if is_first && field.contains(char::is_alphabetic) => {
            format!("`{given}` is no whole number of 32 bits; a line of names needs `#` before it")
        }
        _ => format!("`{given}` is no whole number of 32 bits"),
    }
}

/// Returns a table as CSV, after lines of comments.
pub(crate) fn text(table: &Table, comments: &[String]) -> String {
    let mut text = comments.iter().fold(String::new(), |text, comment| text + "# " + comment + "\n");
    let mut places = table.x().iter();
    for value in table.y() {
        // Writing to a string cannot fail.
        let _ = match places.next() {
            Some(place) => writeln!(text, "{place},{value}"),
            None => writeln!(text, "{value}"),
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn refused(text: &str, form: Form) -> (usize, usize, String) {
        let Refused { place, sentence } = parse(text, form).expect_err(text);
        let Place { line, col } = place.expect("a place");
        (line, col, sentence)
    }

    #[test]
    fn a_csv_has_one_column_or_two_and_comments() {
        let text = "# rise\n0\n1000 # half\n\n4000.0\n";
        assert_eq!(parse(text, Form::Y), Ok((vec![], vec![0, 1000, 4000])));
        assert_eq!(parse("0, 0\n5000,1200\n", Form::Xy), Ok((vec![0, 5000], vec![0, 1200])));
        assert_eq!(
            parse("-2147483648\n2147483647\n+7\n", Form::Y),
            Ok((vec![], vec![-2_147_483_648, 2_147_483_647, 7]))
        );
        assert_eq!(parse("65535", Form::Words), Ok((vec![], vec![65_535])));
        assert_eq!(parse("", Form::Y), Ok((vec![], vec![])));
    }

    #[test]
    fn a_byte_order_mark_and_the_lines_of_windows_are_passed_over() {
        assert_eq!(parse("\u{feff}0,0\r\n500,12\r\n", Form::Xy), Ok((vec![0, 500], vec![0, 12])));
        assert_eq!(refused("\u{feff}0\r\nx\r\n", Form::Y).0, 2);
        assert_eq!(refused("\u{feff} x\r\n", Form::Y).1, 2, "the mark is no column");
    }

    #[test]
    fn what_is_no_number_is_told_with_line_and_column() {
        let finite = |text: &str| format!("`{text}` is not finite; a whole number is expected");
        let beyond = |text: &str| format!("`{text}` is beyond 32 bits; -2147483648 to 2147483647 is possible");
        for (text, form, line, col, sentence) in [
            ("0\n  NaN\n", Form::Y, 2, 3, finite("NaN")),
            ("0,0\n5, -inf\n", Form::Xy, 2, 4, finite("-inf")),
            ("Infinity", Form::Y, 1, 1, finite("Infinity")),
            ("0\n1.5\n", Form::Y, 2, 1, "`1.5` is a fraction; a whole number is expected".to_owned()),
            ("0\n3000000000\n", Form::Y, 2, 1, beyond("3000000000")),
            ("0\n-2147483649\n", Form::Y, 2, 1, beyond("-2147483649")),
            ("0\n1e400\n", Form::Y, 2, 1, beyond("1e400")),
            ("0\n1e3\n", Form::Y, 2, 1, "`1e3` is no whole number of 32 bits".to_owned()),
            ("0\nten\n", Form::Y, 2, 1, "`ten` is no whole number of 32 bits".to_owned()),
            ("0\n1 2\n", Form::Y, 2, 1, "`1 2` is no whole number of 32 bits".to_owned()),
            ("0,0\n5,\n", Form::Xy, 2, 3, "a column is empty; a whole number is expected".to_owned()),
            ("0,0\n,5\n", Form::Xy, 2, 1, "a column is empty; a whole number is expected".to_owned()),
        ] {
            assert_eq!(refused(text, form), (line, col, sentence), "{text:?}");
        }
    }

    #[test]
    fn a_header_is_told_how_to_become_a_comment() {
        let sentence = "`value` is no whole number of 32 bits; a line of names needs `#` before it";
        assert_eq!(refused("# cam\n\nvalue\n0\n", Form::Y), (3, 1, sentence.to_owned()));
        assert_eq!(refused("0\nvalue\n", Form::Y).2, "`value` is no whole number of 32 bits");
        assert_eq!(refused("master,slave\n0,0\n", Form::Xy).2, sentence.replace("value", "master"));
    }

    #[test]
    fn columns_of_other_programs_are_told_from_those_of_this_one() {
        let semicolon = "`;` stands between columns; a comma is expected".to_owned();
        let one = "columns stand there; 1 is expected; a decimal sign is a point, and two columns are of form xy";
        let two = "columns stand there; 2 are expected; a decimal sign is a point";
        for (text, form, line, col, sentence) in [
            ("0;0\n", Form::Xy, 1, 2, semicolon.clone()),
            ("0\n12 ;5\n", Form::Y, 2, 4, semicolon.clone()),
            ("0,5;1,5\n", Form::Xy, 1, 4, semicolon),
            ("0\n1,5\n", Form::Y, 2, 3, format!("2 {one}")),
            ("0,0\n1,5,7\n", Form::Xy, 2, 5, format!("3 {two}")),
            ("0,0\n1,5,7,5\n", Form::Xy, 2, 5, format!("4 {two}")),
            ("0,0\n  7\n", Form::Xy, 2, 3, "1 column stands there; 2 are expected, place and value".to_owned()),
            ("0\n\u{b5}5,1\n", Form::Y, 2, 4, format!("2 {one}")),
        ] {
            assert_eq!(refused(text, form), (line, col, sentence), "{text:?}");
        }
    }

    #[test]
    fn places_that_do_not_rise_are_told_with_both() {
        let sentence =
            |place, last, line| format!("place {place} is not after {last}, the one of line {line}; places rise");
        assert_eq!(refused("0,0\n700,1\n\n500,2\n", Form::Xy), (4, 1, sentence(500, 700, 2)));
        assert_eq!(refused("0,0\n700,1\n 700,2\n", Form::Xy), (3, 2, sentence(700, 700, 2)));
    }

    #[test]
    fn a_million_points_are_read_and_one_more_is_not() {
        let mut text: String = (0..1_000_000).map(|n| format!("{},{}\n", n * 2000, n % 7)).collect();
        let (x, y) = parse(&text, Form::Xy).expect("as many as are possible");
        assert_eq!((x.len(), y.len(), x.last(), y.last()), (1_000_000, 1_000_000, Some(&1_999_998_000), Some(&0)));
        text.push_str("# the end\n 1999999000,0\n");
        let sentence = "this is point 1000001; 1000000 are possible".to_owned();
        assert_eq!(refused(&text, Form::Xy), (1_000_002, 2, sentence));
    }

    #[test]
    fn files_are_bounded_and_are_texts() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.csv");
        let load_of = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("written");
            load(&path)
        };
        assert_eq!(load_of(b"0\n1\n"), Ok("0\n1\n".to_owned()));
        let place = Some(Place { line: 2, col: 2 });
        assert_eq!(load_of(b"0\n1\xff\n"), Err(Refused { place, sentence: "it is not UTF-8 text".to_owned() }));
        let long = vec![b'0'; 64 << 20 | 1];
        assert_eq!(load_of(&long).expect_err("long").sentence, "it is longer than 67108864 bytes");
        // The longest numbers, with as many digits after the point, fit.
        assert!("-2147483648.0000000000,-2147483648.0000000000\r\n".len() * MAX_NUMBERS <= 64 << 20);
    }

    proptest! {
        /// A written table can be read back.
        #[test]
        fn a_csv_reads_back(points in proptest::collection::btree_map(any::<i32>(), any::<i32>(), 1..50), even in any::<bool>()) {
            let (x, y): (Vec<_>, Vec<_>) = points.into_iter().map(|(x, y)| (i64::from(x), i64::from(y))).unzip();
            let (form, x) = if even { (Form::Y, Vec::new()) } else { (Form::Xy, x) };
            let table = Table::new(form, &x, &y).expect("points");
            prop_assert_eq!(parse(&text(&table, &["a cam".to_owned()]), form), Ok((x, y)));
        }

        /// Any content of a file gives a table, or one error message with a location in the text.
        #[test]
        fn any_text_is_read_or_refused_at_a_place(text in "(?s)[ -~\u{b5}\r\n]{0,60}", form in 0_usize..3) {
            if let Err(Refused { place, sentence }) = parse(&text, Form::ALL[form].0) {
                let Place { line, col } = place.expect("a place");
                let length = text.lines().nth(line - 1).expect("a line").chars().count();
                prop_assert!((1..=length + 1).contains(&col), "{line}:{col}: {sentence}");
                prop_assert!(!sentence.contains('\n'));
            }
        }
    }
}

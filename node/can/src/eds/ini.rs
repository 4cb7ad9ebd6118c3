//! Parses sections and keys of an EDS file.
//!
//! Law      `[section]`, `key=value`, `;` at the beginning of a line for a comment. Blanks around each of them are ignored. Upper and lower
//!          case of section names and keys are not distinguished. Of two sections or keys with the same name, the later one is used
//! Reads    UTF-8, with or without byte order mark, otherwise Latin-1; lines end in LF or CR LF
//! Refuses  a section without closing bracket, a line above 64 KiB; with a warning: any other line, a key before the first section
//! Source   CiA 306-1, "file structure"; files of vendors

use super::problem::Problems;
use lineshaft_cia402::dictionary::quoted;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Maximum length of a line, in bytes.
const LONGEST_LINE: usize = 64 << 10;
/// Maximum number of lines. If every second line starts a section, they need about 200 MB, which is the upper bound for a file.
const MOST_LINES: usize = 400_000;

/// Value with its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Item<'a> {
    /// Key as written.
    pub(super) key: &'a str,
    pub(super) value: &'a str,
    pub(super) line: usize,
}

/// Section with its keys.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    /// Name as written.
    pub(super) name: &'a str,
    pub(super) line: usize,
    /// Items by key in lower case.
    pub(super) items: BTreeMap<String, Item<'a>>,
}

impl<'a> Section<'a> {
    /// Returns the value of a key (in lower case); `None` if the value is empty.
    pub(super) fn get(&self, key: &str) -> Option<Item<'a>> {
        self.items.get(key).copied().filter(|item| !item.value.is_empty())
    }
}

/// Sections by name in lower case.
pub(super) type Sections<'a> = BTreeMap<String, Section<'a>>;

/// Decodes the text of a file.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().copied().map(char::from).collect()),
    }
}

/// Parses the sections of a text.
pub(super) fn sections<'a>(text: &'a str, errors: &mut Problems, warnings: &mut Problems) -> Sections<'a> {
    let mut sections = Sections::new();
    let mut present: Option<Section<'a>> = None;
    for (number, whole) in (1..).zip(text.split('\n')) {
        if number > MOST_LINES {
            errors.add(Some(number), format!("the file has more than {MOST_LINES} lines"));
            break;
        }
        let line = whole.trim();
        if line.is_empty() || line.starts_with(';') {
            continue;
        }
        if line.len() > LONGEST_LINE {
            // The line could contain a configuration value.
            errors.add(Some(number), format!("the line is longer than {LONGEST_LINE} bytes"));
            continue;
        }
        if let Some(header) = line.strip_prefix('[') {
            // Text after the bracket is a comment.
            let Some((name, _)) = header.split_once(']') else {
                errors.add(Some(number), format!("the section {} does not end in ]", quoted(line)));
                end(&mut sections, present.take(), warnings);
                continue;
            };
            end(&mut sections, present.take(), warnings);
            present = Some(Section { name: name.trim(), line: number, items: BTreeMap::new() });
            continue;
        }
        let Some((key, value)) = line.split_once('=') else {
            let said = quoted(line);
            warnings
                .add(Some(number), format!("{said} is neither a [section], a key=value nor a ;comment: passed over"));
            continue;
        };
        let item = Item { key: key.trim(), value: value.trim(), line: number };
        let Some(section) = &mut present else {
            warnings.add(Some(number), format!("the key {} stands in no section: passed over", quoted(item.key)));
            continue;
        };
        if let Some(former) = section.items.insert(item.key.to_lowercase(), item) {
            let (key, first) = (quoted(item.key), former.line);
            warnings.add(Some(number), format!("the key {key} stands in line {first} too; this one holds"));
        }
    }
    end(&mut sections, present, warnings);
    sections
}

fn end<'a>(sections: &mut Sections<'a>, section: Option<Section<'a>>, warnings: &mut Problems) {
    let Some(section) = section else { return };
    let (name, line) = (section.name, section.line);
    if let Some(former) = sections.insert(name.to_lowercase(), section) {
        let (name, first) = (quoted(name), former.line);
        warnings.add(Some(line), format!("the section {name} stands in line {first} too; this one holds as a whole"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> (Sections<'_>, String, String) {
        let (mut errors, mut warnings) = (Problems::default(), Problems::default());
        let sections = sections(text, &mut errors, &mut warnings);
        (sections, errors.to_string(), warnings.to_string())
    }

    #[test]
    fn section_and_key_names_ignore_case() {
        let (sections, errors, warnings) =
            read("; head\r\n\r\n [ DeviceInfo ] \r\n VendorName = maxon; ag \r\n\t\r\nA==\r\n");
        let section = &sections["deviceinfo"];
        assert_eq!((section.name, section.line), ("DeviceInfo", 3));
        assert_eq!(section.get("vendorname"), Some(Item { key: "VendorName", value: "maxon; ag", line: 4 }));
        assert_eq!(section.get("a"), Some(Item { key: "A", value: "=", line: 6 }));
        assert_eq!(section.get("b"), None);
        assert_eq!((errors.as_str(), warnings.as_str()), ("", ""));
    }

    #[test]
    fn empty_value_counts_as_missing() {
        assert_eq!(read("[a]\nDefaultValue=\n").0["a"].get("defaultvalue"), None);
    }

    #[test]
    fn later_section_or_key_replaces_earlier_one() {
        let (sections, _, warnings) = read("[A]\nx=1\ny=2\n[a]\nx=3\nX=4\n");
        assert_eq!(sections["a"].get("x").unwrap().value, "4");
        assert_eq!(sections["a"].get("y"), None);
        assert_eq!(
            warnings,
            "line 6: the key \"X\" stands in line 5 too; this one holds\n\
             line 4: the section \"a\" stands in line 1 too; this one holds as a whole"
        );
    }

    #[test]
    fn invalid_lines_are_reported() {
        let (sections, errors, warnings) = read("x=1\n[a]\nnonsense\n[b\ny=1\n");
        assert_eq!(errors, "line 4: the section \"[b\" does not end in ]");
        assert_eq!(
            warnings,
            "line 1: the key \"x\" stands in no section: passed over\n\
             line 3: \"nonsense\" is neither a [section], a key=value nor a ;comment: passed over\n\
             line 5: the key \"y\" stands in no section: passed over"
        );
        assert!(sections["a"].items.is_empty());
    }

    #[test]
    fn latin_1_and_utf_8_are_detected() {
        assert_eq!(text(b"\xEF\xBB\xBF[a]"), "[a]");
        assert_eq!(text("Stra\u{df}e".as_bytes()), "Straße");
        assert_eq!(text(b"Stra\xDFe"), "Straße");
    }

    #[test]
    fn a_line_without_end_is_refused_unless_it_is_a_comment() {
        let long = format!("[a]\nx={}\n", "1".repeat(LONGEST_LINE));
        assert_eq!(read(&long).1, "line 2: the line is longer than 65536 bytes");
        assert_eq!(read(&format!("[a]\n;{}\n", "1".repeat(LONGEST_LINE))).1, "");
    }

    #[test]
    fn too_many_lines_are_refused() {
        let many = "\n".repeat(MOST_LINES);
        assert_eq!(read(&many).1, "line 400001: the file has more than 400000 lines");
        assert_eq!(read(&many[1..]).1, "");
    }

    proptest! {
        #[test]
        fn any_bytes_have_sections(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            let text = text(&bytes);
            let _ = read(&text);
        }
    }
}

//! Explains errors of the YAML parser, at the line of the probable cause.
//!
//! Law      the location is that of the parser, except for a missing colon, a tab, and a bracket or a quotation mark
//!          that nothing closes, which it detects after their line
//! Reads    the text, the message of the parser, and the location where it stopped

use super::Place;
use super::brackets::unclosed;
use lineshaft_core::unit::{excerpt, special_space};

/// A syntax error.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Syntax {
    pub(super) place: Place,
    pub(super) sentence: String,
    pub(super) hint: Option<String>,
}

const ALIGNED: &str = "keys of one mapping, and entries of one list, begin in the same column";

/// Returns the plain explanation of a message of the parser.
pub(super) fn plain(text: &str, info: &str, place: Place) -> Syntax {
    let at = |place, sentence: &str, hint: Option<&str>| Syntax {
        place,
        sentence: format!("this is not YAML: {sentence}"),
        hint: hint.map(str::to_owned),
    };
    // It is the cause of the errors after it.
    if let Some(opened) = unclosed(text).filter(|opened| opened.place <= place) {
        return at(opened.place, &opened.sentence(), None);
    }
    match info {
        "simple key expect ':'" | "simple key expected" | "did not find expected <document start>" => {
            match line_without_colon(text, place.line) {
                Some((place, line)) => {
                    let hint = Some(with_colon(line));
                    Syntax { hint, ..at(place, "a colon and a blank are missing between key and value", None) }
                }
                None => at(place, "a colon and a blank are missing after a key", None),
            }
        }
        _ if is_tab(info) => {
            let sentence = "a tab is not allowed in the indentation";
            at(tab(text, place).unwrap_or(place), sentence, Some("indent with blanks"))
        }
        "mapping values are not allowed in this context" => {
            let sentence = "a second colon in one value, or a key in another column than the keys before it";
            at(place, sentence, Some("put keys of one mapping in the same column, and quotes around a value with `: `"))
        }
        "block sequence entries are not allowed in this context" => {
            at(place, "an entry of a list begins here, but a key or a value is in the same line", Some(ALIGNED))
        }
        "while parsing a block mapping, did not find expected key"
        | "while parsing a block collection, did not find expected '-' indicator"
        | "invalid indentation" => at(place, "the indentation does not fit the lines before", Some(ALIGNED)),
        "while parsing a flow mapping, did not find expected ',' or '}'" => {
            at(place, "a comma or the closing `}` of a mapping is missing", None)
        }
        "while parsing a flow sequence, expected ',' or ']'" => {
            at(place, "a comma or the closing `]` of a list is missing", None)
        }
        "while scanning a quoted scalar, found unexpected end of stream" => {
            at(place, "the closing quotation mark of a text is missing", None)
        }
        "while parsing node, found unknown anchor" => {
            let hint = "put quotes around a value that begins with `*`";
            at(place, "`*` begins an alias, and no anchor has its name", Some(hint))
        }
        "while scanning an anchor or alias, did not find expected alphabetic or numeric character" => {
            let hint = "put quotes around a value that begins with `*` or `&`";
            at(place, "`*` begins an alias and `&` an anchor, and its name is missing", Some(hint))
        }
        "invalid indentation in flow construct" => {
            at(place, "a line inside of brackets is not indented further than the key before them", None)
        }
        "misplaced bracket" => at(place, "this bracket closes nothing", None),
        "invalid trailing content after double-quoted scalar" => {
            let hint = "write `''` for `'` inside of '..', and `\\\"` for `\"` inside of \"..\"";
            at(place, "a text goes on after its closing quotation mark", Some(hint))
        }
        other if other.starts_with("unexpected character: ") => {
            at(place, other, Some("put quotes around a value that begins with it"))
        }
        other => at(place, other, None),
    }
}

fn is_tab(info: &str) -> bool {
    info.contains("found a tab") || info.starts_with("tabs disallowed") || info.starts_with("tab cannot be used")
}

/// Returns the text of a line; `number` begins with 1.
fn line(text: &str, number: usize) -> &str {
    number.checked_sub(1).and_then(|before| text.lines().nth(before)).unwrap_or_default()
}

/// Returns the location of the first text in a line.
fn begin(number: usize, line: &str) -> Place {
    let blanks = line.chars().take_while(|sign| sign.is_whitespace()).count();
    Place { line: number, col: 1 + blanks }
}

/// Returns the line with a key that lacks its colon: the one where the parser stopped, or the last one before it that
/// is not empty.
fn line_without_colon(text: &str, number: usize) -> Option<(Place, &str)> {
    /// Maximum number of comment lines in between.
    const FURTHEST: usize = 20;
    let content = |number| line(text, number).split(" #").next().unwrap_or_default().trim();
    let has_colon = |content: &str| content.contains(": ") || content.ends_with(':');
    let is_empty = |content: &str| content.is_empty() || content.starts_with('#');
    let here = content(number);
    if !is_empty(here) && !has_colon(here) {
        return Some((begin(number, line(text, number)), here));
    }
    let before = (1..number).rev().take(FURTHEST).find(|number| !is_empty(content(*number)))?;
    let there = content(before);
    (!has_colon(there)).then(|| (begin(before, line(text, before)), there))
}

/// Returns a line with its colon, which is missing at its first space or lacks a space after it, or is a `=`.
fn with_colon(line: &str) -> String {
    let line = line.trim_start_matches("- ");
    let with = match line.split_once(|sign: char| sign.is_whitespace() || matches!(sign, ':' | '=')) {
        Some((key, value)) => format!("{key}: {}", without_equals_sign(value)),
        None => format!("{line}: .."),
    };
    let found = special_space(line).map(|space| format!("; the line has {space}")).unwrap_or_default();
    format!("write `{}`{found}", excerpt(&with))
}

/// Returns a value without the blanks, and the `=`, before it.
pub(super) fn without_equals_sign(value: &str) -> &str {
    let value = value.trim_start();
    value.strip_prefix('=').unwrap_or(value).trim_start()
}

/// Returns the first line with a tab in its indentation, at the location or in the next line.
fn tab(text: &str, place: Place) -> Option<Place> {
    let indentation = |number: usize| {
        let line = line(text, number);
        line.chars().take_while(|sign| sign.is_whitespace()).any(|sign| sign == '\t').then(|| begin(number, line))
    };
    if indentation(place.line).is_some() {
        return Some(place);
    }
    indentation(place.line + 1)
}

#[cfg(test)]
mod tests {
    use super::super::Document;

    #[track_caller]
    fn said(text: &str, expected: &str) {
        let document = Document::parse("t.yaml", text);
        assert!(document.root("the file").is_none(), "{text:?}");
        assert_eq!(document.problems().to_string(), format!("t.yaml:{expected}\n"), "{text:?}");
    }

    #[test]
    fn missing_colon_is_reported_at_its_line() {
        let missing = "this is not YAML: a colon and a blank are missing between key and value, write";
        said("a:\n  b: 1\n  max_velocity 1200 mm/s\n  c: 2\n", &format!("3:3: {missing} `max_velocity: 1200 mm/s`"));
        said("a:\n  b: 1\n  max_velocity:1200 mm/s\n  c: 2\n", &format!("3:3: {missing} `max_velocity: 1200 mm/s`"));
        said(
            "a:\n  b: 1\n  bus udp:239.74.163.45:43145\n  c: 2\n",
            &format!("3:3: {missing} `bus: udp:239.74.163.45:43145`"),
        );
        for text in ["min_position = -50 mm", "min_position= -50 mm", "min_position=-50 mm"] {
            said(&format!("a:\n  b: 1\n  {text}\n  c: 2\n"), &format!("3:3: {missing} `min_position: -50 mm`"));
        }
        said(
            "a:\n  b: 1\n  min_position:\u{a0}-50 mm\n  c: 2\n",
            &format!("3:3: {missing} `min_position: -50 mm`; the line has a no-break space (U+00A0)"),
        );
        said(
            "a:\n  b: 1\n  max_velocity\u{a0}1200 mm/s\n  c: 2\n",
            &format!("3:3: {missing} `max_velocity: 1200 mm/s`; the line has a no-break space (U+00A0)"),
        );
        said("for 2 s\n\n# what is traced\ntrace: []\n", &format!("1:1: {missing} `for: 2 s`"));
    }

    #[test]
    fn tab_is_reported_at_its_line() {
        let tab = "this is not YAML: a tab is not allowed in the indentation, indent with blanks";
        said("a:\n  b: 1\n\tc: 2\n", &format!("3:2: {tab}"));
    }

    #[test]
    fn wrong_indentation_reports_the_related_lines() {
        let aligned = "keys of one mapping, and entries of one list, begin in the same column";
        let wrong = "this is not YAML: the indentation does not fit the lines before";
        for text in ["a:\n - b: 1\n  - c: 2\nd: 3\n", "a:\n    b: 1\n  c: 2\n"] {
            said(text, &format!("3:3: {wrong}, {aligned}"));
        }
        let second = "this is not YAML: a second colon in one value, or a key in another column than the keys before it, put keys of one \
                      mapping in the same column, and quotes around a value with `: `";
        said("a: 1\n   b: 2\n", &format!("2:5: {second}"));
        said("a: b: c\n", &format!("1:5: {second}"));
        said("a:\n  - {b: 1}\n  c: 2\n", &format!("3:3: {wrong}, {aligned}"));
    }

    #[test]
    fn missing_bracket_is_named() {
        said("a: {b: 1 c: 2}\n", "1:11: this is not YAML: a comma or the closing `}` of a mapping is missing");
        said("a: [1, 2\n", "1:4: this is not YAML: `]` is missing for `[` at 1:4");
    }

    /// The parser reports these in a later line.
    #[test]
    fn bracket_that_nothing_closes_is_reported_where_it_opens() {
        let missing = |closing: char, sign: char, at: &str| {
            format!("{at}: this is not YAML: `{closing}` is missing for `{sign}` at {at}")
        };
        said("axes:\n  x:\n    scale: {increments: 1, per: 1 mm\n    drive: virtual\n", &missing('}', '{', "3:12"));
        let steps = "steps:\n  - at: 0\n    do: [{enable: {}}, {halt: {}}\n  - at: 5\n    do: {halt: {}}\nexpect:\n  - {signal: x}\n";
        said(steps, &missing(']', '[', "3:9"));
        said("steps:\n  - {do: {enable: {axes: [x, y}}}\n  - {at: 1}\n", &missing(']', '[', "2:26"));
        said("a: 1\nb: \"two\nc: 3\n", "2:4: this is not YAML: the closing quotation mark is missing for \" at 2:4");
        said(
            "s:\n  - {name: 'go, at: 0}\n  - {name: 'stop', at: 1}\n",
            "2:12: this is not YAML: the closing quotation mark is missing for ' at 2:12",
        );
        // An error before it is reported first.
        said(
            "a: 1\n  b: 2\nc: {d: 3\n",
            "2:4: this is not YAML: a second colon in one value, or a key in another column than the keys before it, put keys of one \
             mapping in the same column, and quotes around a value with `: `",
        );
    }

    #[test]
    fn value_that_begins_with_an_asterisk_needs_quotes() {
        let quotes = "`*` begins an alias, and no anchor has its name, put quotes around a value that begins with `*`";
        said("trace: [*.command.*]\n", &format!("1:9: this is not YAML: {quotes}"));
        said("trace:\n  - *.command.*\n", &format!("2:5: this is not YAML: {quotes}"));
    }
}

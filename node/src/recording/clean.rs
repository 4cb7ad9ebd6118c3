//! Foreign text on a terminal.
//!
//! Law      what is printed is one line, and nothing in it steers the terminal or turns the direction of writing

use std::borrow::Cow;
use std::fmt::Write;

/// The text with everything escaped that is no letter for people: `\u{1b}` instead of an escape.
pub(crate) fn clean(text: &str) -> Cow<'_, str> {
    if !text.contains(is_bad) {
        return Cow::Borrowed(text);
    }
    let mut cleaned = String::with_capacity(text.len());
    for letter in text.chars() {
        // Writing to a text cannot fail.
        let _ = match letter {
            bad if is_bad(bad) => write!(cleaned, "{}", bad.escape_default()),
            good => write!(cleaned, "{good}"),
        };
    }
    Cow::Owned(cleaned)
}

/// As [`clean`], of a text that may have several lines.
pub(crate) fn clean_lines(text: &str) -> String {
    text.split('\n').map(clean).collect::<Vec<_>>().join("\n")
}

/// JSON without line breaks in which no character steers the terminal: it is written as `\u009b`. The value stays the same, as such
/// characters are in strings only.
pub(crate) fn escape_json(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        // Writing to a text cannot fail. None of these characters is beyond U+FFFF.
        let _ = match letter {
            bad if is_bad(bad) => write!(escaped, "\\u{:04x}", u32::from(bad)),
            good => write!(escaped, "{good}"),
        };
    }
    escaped
}

/// Controls, breaks of lines, and what turns the direction of writing.
fn is_bad(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{2028}' | '\u{2029}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_escaped() {
        assert_eq!(clean("x.position \u{fc} \\"), "x.position \u{fc} \\");
        assert_eq!(clean("\u{1b}[2Ja\u{7}b\rc\nd\u{9b}e\u{202e}f"), "\\u{1b}[2Ja\\u{7}b\\rc\\nd\\u{9b}e\\u{202e}f");
        assert_eq!(clean_lines("a\u{1b}\nb\r\n"), "a\\u{1b}\nb\\r\n");
    }
}

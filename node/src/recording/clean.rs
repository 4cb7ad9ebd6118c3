//! Escapes text from outside before it is printed on a terminal.
//!
//! Law      the result is one line; none of its characters controls the terminal or changes the writing direction

use std::borrow::Cow;
use std::fmt::Write;

/// Returns the text with control characters escaped, such as `\u{1b}` for the escape character.
pub(crate) fn clean(text: &str) -> Cow<'_, str> {
    if !text.contains(is_bad) {
        return Cow::Borrowed(text);
    }
    let mut cleaned = String::with_capacity(text.len());
    for letter in text.chars() {
        // Writing to a string cannot fail.
        let _ = match letter {
            bad if is_bad(bad) => write!(cleaned, "{}", bad.escape_default()),
            good => write!(cleaned, "{good}"),
        };
    }
    Cow::Owned(cleaned)
}

/// Does the same as [`clean`] for each line of a text.
pub(crate) fn clean_lines(text: &str) -> String {
    text.split('\n').map(clean).collect::<Vec<_>>().join("\n")
}

/// Returns JSON without line breaks and without control characters: they are written as `\u009b`. The value stays the
/// same, because such characters occur only in strings.
pub(crate) fn escape_json(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        // Writing to a string cannot fail. None of these characters exceeds U+FFFF.
        let _ = match letter {
            bad if is_bad(bad) => write!(escaped, "\\u{:04x}", u32::from(bad)),
            good => write!(escaped, "{good}"),
        };
    }
    escaped
}

/// Returns true for control characters, line breaks and characters that change the writing direction.
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

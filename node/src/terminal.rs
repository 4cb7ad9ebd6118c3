//! Determines whether the log has colours.

use std::env;
use std::ffi::OsStr;
use std::io::{IsTerminal, stderr};

/// Returns true if the log has colours: on a terminal that supports them, unless `NO_COLOR` is set
/// (<https://no-color.org>).
pub(crate) fn has_colors() -> bool {
    let (no_color, term) = (env::var_os("NO_COLOR"), env::var_os("TERM"));
    stderr().is_terminal() && may_color(no_color.as_deref(), term.as_deref())
}

fn may_color(no_color: Option<&OsStr>, term: Option<&OsStr>) -> bool {
    no_color.is_none_or(OsStr::is_empty) && !is_dumb(term)
}

/// Returns true for a terminal without escape sequences.
fn is_dumb(term: Option<&OsStr>) -> bool {
    term.is_some_and(|term| term == "dumb")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// no-color.org: set "when present and not an empty string (regardless of its value)".
    #[test]
    fn no_color_and_dumb_terminals_have_no_colors() {
        let may =
            |no_color: Option<&str>, term: Option<&str>| may_color(no_color.map(OsStr::new), term.map(OsStr::new));
        assert!(may(None, Some("xterm-256color")) && may(Some(""), Some("xterm")) && may(None, None));
        for (no_color, term) in
            [(Some("1"), Some("xterm")), (Some("0"), None), (None, Some("dumb")), (Some(""), Some("dumb"))]
        {
            assert!(!may(no_color, term), "{no_color:?} {term:?}");
        }
    }
}

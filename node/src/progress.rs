//! Shows a progress bar on a terminal for commands that take longer than a second.
//!
//! Law      the bar is drawn on standard error, if that is a terminal and TERM is neither unset nor `dumb`. It has no
//!          colors, so NO_COLOR has no effect. It is cleared at the end
//! Reads    the clock each time it is set, so that loops set it only every few hundred cycles or messages

use crate::recording::clean::clean;
use indicatif::{ProgressBar, ProgressStyle};
use std::ffi::OsStr;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Time before a bar is shown.
pub(crate) const MOMENT: Duration = Duration::from_secs(1);

/// The progress bar.
#[derive(Debug)]
pub(crate) struct Progress {
    unit: &'static str,
    started: Instant,
    after: Duration,
    bar: Option<ProgressBar>,
    is_wanted: bool,
}

impl Progress {
    /// Creates a bar that is shown after a time; it counts `unit`.
    pub(crate) fn new(unit: &'static str, after: Duration) -> Self {
        Self::wanted(unit, after, true)
    }

    /// Does the same, but never shows the bar unless `is_wanted`.
    pub(crate) fn wanted(unit: &'static str, after: Duration, is_wanted: bool) -> Self {
        let term = std::env::var_os("TERM");
        let is_wanted = is_wanted && can_be_shown(std::io::stderr().is_terminal(), term.as_deref());
        Self { unit, started: Instant::now(), after, bar: None, is_wanted }
    }

    /// Sets the progress: `done` of `of`.
    pub(crate) fn set(&mut self, done: usize, of: Option<usize>) {
        self.set_with(done as u64, of.map(|of| of as u64), String::new);
    }

    /// Does the same with a text about the current step, which is only created if the bar is shown.
    pub(crate) fn set_with(&mut self, done: u64, of: Option<u64>, detail: impl FnOnce() -> String) {
        if !self.is_wanted {
            return;
        }
        let elapsed = self.started.elapsed();
        if elapsed < self.after {
            return;
        }
        let unit = self.unit;
        let bar = self.bar.get_or_insert_with(|| bar(of, unit));
        bar.set_message(message(&detail(), elapsed, done, of));
        bar.set_position(done);
    }

    /// Prints without interference of the bar.
    pub(crate) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn can_be_shown(is_terminal: bool, term: Option<&OsStr>) -> bool {
    is_terminal && term.is_some_and(|term| !term.is_empty() && term != "dumb")
}

fn bar(of: Option<u64>, unit: &str) -> ProgressBar {
    let (bar, template) = match of {
        Some(of) => (ProgressBar::new(of), format!("{{bar:30}} {{percent}} %, {{pos}} of {{len}} {unit}{{wide_msg}}")),
        None => (ProgressBar::new_spinner(), format!("{{spinner}} {{pos}} {unit}{{wide_msg}}")),
    };
    match ProgressStyle::with_template(&template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Returns text such as `, detail, 12 s left`.
fn message(detail: &str, elapsed: Duration, done: u64, of: Option<u64>) -> String {
    let detail = if detail.is_empty() { String::new() } else { format!(", {}", clean(detail)) };
    let left = of.filter(|of| done > 0 && *of >= done).map_or_else(String::new, |of| {
        let seconds = elapsed.as_secs_f64() * (of - done) as f64 / done as f64;
        format!(", {seconds:.0} s left")
    });
    format!("{detail}{left}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bar_is_shown_on_a_terminal_that_moves_its_cursor_only() {
        let shown = |is_terminal, term: Option<&str>| can_be_shown(is_terminal, term.map(OsStr::new));
        assert!(shown(true, Some("xterm-256color")));
        assert!(!shown(false, Some("xterm-256color")), "a pipe");
        assert!(!shown(true, Some("dumb")) && !shown(true, Some("")) && !shown(true, None));
    }

    #[test]
    fn message_has_detail_and_time_left() {
        let second = Duration::from_secs(1);
        // A quarter in 1 s leaves 3 s for the rest.
        assert_eq!(message("step `go`", second, 250, Some(1000)), ", step `go`, 3 s left");
        assert_eq!(message("", second, 1000, Some(1000)), ", 0 s left");
        assert_eq!(message("a\u{1b}b", second, 0, Some(9)), ", a\\u{1b}b");
        assert_eq!(message("", second, 7, None), "");
        assert_eq!(message("", second, 7, Some(3)), "", "more than announced");
    }

    #[test]
    fn hidden_bar_makes_no_text() {
        let mut progress = Progress::wanted("cycles", Duration::ZERO, false);
        progress.set_with(1, Some(2), || panic!("nothing is shown"));
        progress.set(1, Some(2));
        assert_eq!(progress.aside(|| 7), 7);
    }
}

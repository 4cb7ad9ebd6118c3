//! A bar for what takes longer than a moment, on a terminal.

use crate::terminal;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// A moment: what takes no longer needs no bar.
pub(super) const MOMENT: Duration = Duration::from_secs(1);

/// The bar.
pub(super) struct Progress {
    unit: &'static str,
    begins: Instant,
    bar: Option<ProgressBar>,
    is_wanted: bool,
}

impl Progress {
    /// A bar that is shown once so much time has passed; it counts `unit`.
    pub(super) fn new(unit: &'static str, after: Duration) -> Self {
        Self { unit, begins: Instant::now() + after, bar: None, is_wanted: terminal::has_bars() }
    }

    /// So many of so many are done.
    pub(super) fn set(&mut self, done: usize, of: Option<usize>) {
        if !self.is_wanted || Instant::now() < self.begins {
            return;
        }
        let unit = self.unit;
        let bar = self.bar.get_or_insert_with(|| match of {
            Some(of) => bar(of, unit),
            None => ProgressBar::new_spinner().with_message(unit),
        });
        bar.set_position(done as u64);
    }
}

fn bar(of: usize, unit: &str) -> ProgressBar {
    let bar = ProgressBar::new(of as u64);
    match ProgressStyle::with_template(&format!("{{bar:40}} {{percent}} %, {{pos}} of {{len}} {unit}")) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

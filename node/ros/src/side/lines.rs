//! Sends the log of the process to the program. Only a few messages of each kind are sent, so that network events cannot flood the log.

use std::fmt::Write;
use std::sync::mpsc::Sender;
use std::sync::{Mutex, PoisonError};

use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, Layer};

use super::library_lines::{self, log_filter};
use crate::line_limit::MessageRateLimit;
use crate::link::protocol::{Line, Report};

/// Maximum length of a message in bytes: some messages contain received data.
const LONGEST: usize = 500;

/// Sends log messages as reports from now on; `RUST_LOG` selects them.
pub(super) fn start(reports: Sender<Report>) {
    let given = std::env::var("RUST_LOG").ok().filter(|text| !text.is_empty());
    let filter = given.and_then(|text| EnvFilter::try_new(text).ok());
    let filter = filter.unwrap_or_else(|| EnvFilter::new(log_filter("info")));
    let lines = Lines { reports: Mutex::new(reports), limit: MessageRateLimit::default() };
    // Cannot fail: this is the first subscriber of the process.
    let _ = tracing_subscriber::registry().with(filter).with(lines).try_init();
}

struct Lines {
    reports: Mutex<Sender<Report>>,
    /// Messages from the same place in the source code are of the same kind.
    limit: MessageRateLimit<(String, u32)>,
}

impl<S: Subscriber> Layer<S> for Lines {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let about = event.metadata();
        let mut text = Text { text: String::new(), target: about.target().to_owned(), place: None };
        event.record(&mut text);
        let here = (about.file().unwrap_or_default().to_owned(), about.line().unwrap_or_default());
        let place = text.place.take().unwrap_or(here);
        let severity = match *about.level() {
            Level::ERROR => Line::ERROR,
            Level::WARN => Line::WARN,
            Level::INFO => Line::INFO,
            _ => Line::DEBUG,
        };
        let severity = library_lines::severity(&text.target, &text.text, severity);
        self.limit.log(place.clone(), |more| {
            // Our own messages need no prefix with their target.
            let is_own = text.target.starts_with(env!("CARGO_CRATE_NAME"));
            let mut text = if is_own { text.text } else { format!("{}: {}", text.target, text.text) };
            if text.len() > LONGEST {
                let end = (0..=LONGEST).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
                text.truncate(end);
                text.push('…');
            }
            let report = Report::Line(Line { severity, place, text: text + more });
            // Fails if the program has ended.
            let _ = self.reports.lock().unwrap_or_else(PoisonError::into_inner).send(report);
        });
    }
}

/// Text of a message, and its place in the source code.
struct Text {
    text: String,
    target: String,
    /// Place, if the bridge from the `log` crate, which the DDS library uses, reports it.
    place: Option<(String, u32)>,
}

impl Visit for Text {
    fn record_u64(&mut self, field: &Field, value: u64) {
        match field.name() {
            "log.line" => self.place.get_or_insert_default().1 = u32::try_from(value).unwrap_or_default(),
            _ => self.record_debug(field, &value),
        }
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            "log.target" => value.clone_into(&mut self.target),
            "log.file" => value.clone_into(&mut self.place.get_or_insert_default().0),
            "log.module_path" => {}
            _ => self.record_debug(field, &value),
        }
    }

    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        // Writing to a string does not fail.
        let _ = match field.name() {
            "message" => write!(self.text, "{value:?}"),
            name => write!(self.text, " {name}={value:?}"),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    /// The program shows messages of level debug only if `RUST_LOG` or `--log-level` enables them.
    #[test]
    fn lines_of_the_library_are_sent_with_their_severity_for_users() {
        let (reports, sent) = channel();
        let lines = Lines { reports: Mutex::new(reports), limit: MessageRateLimit::default() };
        tracing::subscriber::with_default(tracing_subscriber::registry().with(lines), || {
            let text = "Participant was updated, but DB does not have it. Strange.";
            tracing::error!(target: "rustdds::rtps::dp_event_loop", "{text}");
            tracing::error!(target: "rustdds::rtps::dp_event_loop", "dp_event_loop poll failed: {:?}", "no memory");
        });
        let line = || match sent.try_recv() {
            Ok(Report::Line(line)) => (line.severity, line.text),
            other => panic!("a line is expected, not {other:?}"),
        };
        let strange = "rustdds::rtps::dp_event_loop: Participant was updated, but DB does not have it. Strange.";
        assert_eq!(line(), (Line::DEBUG, strange.to_owned()));
        let failed = "rustdds::rtps::dp_event_loop: dp_event_loop poll failed: \"no memory\"";
        assert_eq!(line(), (Line::ERROR, failed.to_owned()));
    }
}

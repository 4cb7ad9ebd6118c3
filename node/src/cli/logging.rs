//! Writes the log to standard error, and to `/rosout` while there is a node.

use crate::terminal;
use lineshaft_ros::layer::{Loggers, Rosout, SENT_TO_ROSOUT, Severity, Source, log_filter};
use lineshaft_ros::line_limit::MessageRateLimit;
use std::fmt::Write;
use std::sync::{Arc, PoisonError, RwLock};
use tracing::callsite::Identifier;
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_appender::non_blocking::{NonBlockingBuilder, WorkerGuard};
use tracing_subscriber::layer::{Context, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, Layer, Registry, reload};

/// Log of the process.
pub(super) struct Logging {
    filter: reload::Handle<EnvFilter, Registry>,
    /// Value of `RUST_LOG`.
    base: Option<String>,
    rosout: Arc<Lines>,
    /// Writes all pending lines when dropped.
    _writer: WorkerGuard,
}

/// Maximum number of lines that wait for standard error; further ones are lost.
const WAITING: usize = 8192;

impl Logging {
    /// Starts the log to standard error if `to_stderr`. `RUST_LOG` selects the lines; the default is `info`. A separate
    /// thread writes the lines, so that no other thread waits for a disk or a reader.
    pub(super) fn start(to_stderr: bool) -> Self {
        let base = std::env::var("RUST_LOG").ok().filter(|text| !text.is_empty() && EnvFilter::try_new(text).is_ok());
        let filter = base.clone().unwrap_or_else(|| log_filter("info"));
        let (filter, handle) = reload::Layer::new(EnvFilter::new(filter));
        let writer = NonBlockingBuilder::default().lossy(true).buffered_lines_limit(WAITING).thread_name("log");
        let (writer, guard) = writer.finish(std::io::stderr());
        let lines = tracing_subscriber::fmt::layer().with_target(false).with_writer(writer);
        // If standard error is closed, lines are lost and the machine continues.
        let lines = lines.with_ansi(terminal::has_colors()).log_internal_errors(false);
        let rosout = Arc::new(Lines::default());
        let layers = tracing_subscriber::registry().with(filter).with(to_stderr.then_some(lines));
        // A second start within one process keeps the first log.
        let _ = layers.with(ToRosout(Arc::clone(&rosout))).try_init();
        Self { filter: handle, base, rosout, _writer: guard }
    }

    /// Returns the loggers other than that of the node; their levels select the lines.
    pub(super) fn loggers(&self, node: String) -> Loggers {
        let handle = self.filter.clone();
        let apply = move |filter: &str| {
            let filter = EnvFilter::try_new(filter).map_err(|error| error.to_string())?;
            // If another log was installed before, it keeps its own levels.
            let _ = handle.reload(filter);
            Ok(())
        };
        Loggers::new(node, self.base.clone(), apply)
    }

    /// Logs only errors from now on, unless `RUST_LOG` selects other lines.
    pub(super) fn show_errors_only(&self) {
        if self.base.is_none()
            && let Ok(filter) = EnvFilter::try_new("error")
        {
            // If another log was installed before, it keeps its own levels.
            let _ = self.filter.reload(filter);
        }
    }

    /// Sends lines also to the `/rosout` of a node from now on; `None` stops it.
    pub(super) fn show_on(&self, rosout: Option<Rosout>) {
        *self.rosout.rosout.write().unwrap_or_else(PoisonError::into_inner) = rosout;
    }
}

#[derive(Default)]
struct Lines {
    rosout: RwLock<Option<Rosout>>,
    /// The limit applies to each location in the source code.
    limit: MessageRateLimit<Identifier>,
}

/// Passes on lines of the program itself, but not those of the DDS library, which would report their own transmission,
/// and not those that the surface publishes itself.
struct ToRosout(Arc<Lines>);

impl<S: Subscriber> Layer<S> for ToRosout {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let about = event.metadata();
        let severity = match *about.level() {
            Level::ERROR => Severity::Error,
            Level::WARN => Severity::Warn,
            Level::INFO => Severity::Info,
            _ => return,
        };
        if !about.target().starts_with("lineshaft") || about.target() == SENT_TO_ROSOUT {
            return;
        }
        let rosout = self.0.rosout.read().unwrap_or_else(PoisonError::into_inner);
        let Some(rosout) = rosout.as_ref() else { return };
        let mut text = Text::default();
        event.record(&mut text);
        self.0.limit.log(about.callsite(), |more| {
            let file = about.file().unwrap_or_default().to_owned();
            let function = about.module_path().unwrap_or_default().to_owned();
            rosout.log(severity, text.0 + more, Source { file, function, line: about.line().unwrap_or_default() });
        });
    }
}

/// The message of a line, followed by its fields.
#[derive(Default)]
struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        // Writing to a string cannot fail.
        let _ = match field.name() {
            "message" => write!(self.0, "{value:?}"),
            name => write!(self.0, " {name}={value:?}"),
        };
    }
}

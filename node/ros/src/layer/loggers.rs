//! Logger levels as ROS sees them: the logger of the node controls the whole program, other names control parts of it.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lineshaft_msgs::foreign::rcl_interfaces::msg::LoggerLevel;

use super::log::Severity;
use crate::side::log_filter;

/// Prefix of all targets of the program's log.
const PROGRAM: &str = "lineshaft";
/// Maximum number of loggers with a level, and maximum length of their names.
const MOST: usize = 1000;
const LONGEST: usize = 255;

/// Level of a logger: messages below it are not logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// All messages.
    Debug,
    /// Expected events and above.
    Info,
    /// Warnings and above.
    Warn,
    /// Errors and above.
    Error,
    /// Only errors that end the process.
    Fatal,
}

impl Level {
    /// Returns the level with a name. Upper and lower case are not distinguished.
    pub fn of_name(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "debug" => Self::Debug,
            "info" => Self::Info,
            "warn" => Self::Warn,
            "error" => Self::Error,
            "fatal" => Self::Fatal,
            _ => return None,
        })
    }

    fn of_number(number: u32) -> Option<Self> {
        let all = [Self::Debug, Self::Info, Self::Warn, Self::Error, Self::Fatal];
        all.into_iter().find(|level| u32::from(level.number()) == number)
    }

    /// Returns the number in ROS.
    fn number(self) -> u8 {
        match self {
            Self::Debug => LoggerLevel::LOG_LEVEL_DEBUG,
            Self::Info => LoggerLevel::LOG_LEVEL_INFO,
            Self::Warn => LoggerLevel::LOG_LEVEL_WARN,
            Self::Error => LoggerLevel::LOG_LEVEL_ERROR,
            Self::Fatal => LoggerLevel::LOG_LEVEL_FATAL,
        }
    }

    /// Returns the name in a filter; the program itself logs no fatal messages.
    fn filter_name(self) -> &'static str {
        match self {
            Self::Debug => "debug",
            Self::Info => "info",
            Self::Warn => "warn",
            Self::Error => "error",
            Self::Fatal => "off",
        }
    }
}

/// Applies a filter (`EnvFilter` of `tracing-subscriber`).
type Apply = Box<dyn Fn(&str) -> Result<(), String> + Send + Sync>;

/// Levels of all loggers; clones share them.
#[derive(Clone)]
pub struct Loggers(Arc<Inner>);

struct Inner {
    node: String,
    /// Filter of the environment, until a level for all loggers is set.
    base: Option<String>,
    apply: Apply,
    /// Levels by logger name; the empty name means all loggers.
    levels: Mutex<BTreeMap<String, Level>>,
    /// Number of the level of the node's logger.
    threshold: AtomicU8,
}

impl Default for Loggers {
    /// Creates loggers whose levels are not applied to the program.
    fn default() -> Self {
        Self::new(String::new(), None, |_| Ok(()))
    }
}

impl fmt::Debug for Loggers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Loggers").field(&*self.levels()).finish()
    }
}

impl Loggers {
    /// Creates the loggers of a node whose logger is called `node`. `base` is the filter of the environment, `apply` applies a new filter.
    pub fn new(
        node: String,
        base: Option<String>,
        apply: impl Fn(&str) -> Result<(), String> + Send + Sync + 'static,
    ) -> Self {
        let threshold = AtomicU8::new(Level::Info.number());
        Self(Arc::new(Inner { node, base, apply: Box::new(apply), levels: Mutex::default(), threshold }))
    }

    fn levels(&self) -> MutexGuard<'_, BTreeMap<String, Level>> {
        self.0.levels.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the number of the level that was set for a logger; 0: none.
    pub fn get(&self, name: &str) -> u8 {
        let level = self.levels().get(name).copied();
        match (level, name) {
            (Some(level), _) => level.number(),
            (None, "") => Level::Info.number(),
            (None, _) => LoggerLevel::LOG_LEVEL_UNKNOWN,
        }
    }

    /// Sets the level of a logger by its number in ROS; 0 removes it.
    ///
    /// # Errors
    /// The level does not exist, or there are too many loggers.
    pub fn set_number(&self, name: &str, number: u32) -> Result<(), String> {
        match (Level::of_number(number), number) {
            (Some(level), _) => self.set(name, Some(level)),
            (None, 0) => self.set(name, None),
            (None, _) => {
                Err(format!("level is {number}; 0 unset, 10 debug, 20 info, 30 warn, 40 error, 50 fatal are allowed"))
            }
        }
    }

    /// Sets the level of a logger; `None` removes it.
    ///
    /// # Errors
    /// There are too many loggers, or the filter is refused; nothing has changed then.
    pub fn set(&self, name: &str, level: Option<Level>) -> Result<(), String> {
        if name.len() > LONGEST {
            return Err(format!("the name has {} bytes; {LONGEST} are allowed", name.len()));
        }
        let mut levels = self.levels();
        let mut new = levels.clone();
        match level {
            Some(level) => new.insert(name.to_owned(), level),
            None => new.remove(name),
        };
        if new.len() > MOST {
            return Err(format!("{MOST} loggers have levels already; more are not remembered"));
        }
        (self.0.apply)(&self.filter(&new))?;
        self.0.threshold.store(effective(&new, &self.0.node).number(), Ordering::Relaxed);
        *levels = new;
        Ok(())
    }

    /// Returns true if the logger of the node passes messages of this severity.
    pub(super) fn is_enabled(&self, severity: Severity) -> bool {
        severity.level() >= self.0.threshold.load(Ordering::Relaxed)
    }

    fn filter(&self, levels: &BTreeMap<String, Level>) -> String {
        let mut filter = match (levels.get(""), &self.0.base) {
            (None, Some(base)) => base.clone(),
            (level, _) => log_filter(level.copied().unwrap_or(Level::Info).filter_name()),
        };
        // Other names could conflict with the filter syntax; no part of this program has such a name.
        let is_plain = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
        for (name, level) in levels.iter().filter(|(name, _)| !name.is_empty() && is_plain(name)) {
            let target = name.replace('.', "::");
            filter += &format!(",{target}={}", level.filter_name());
        }
        if levels.contains_key("") || self.0.base.is_none() || has_level(levels, &self.0.node) {
            // Added last, so that it has precedence over a logger with the name of the program.
            filter += &format!(",{PROGRAM}={}", effective(levels, &self.0.node).filter_name());
        }
        filter
    }
}

/// Returns true if a logger, or one of its parents, has a level.
fn has_level(levels: &BTreeMap<String, Level>, name: &str) -> bool {
    name_and_parents(name).any(|name| levels.contains_key(name))
}

/// Returns the effective level of a logger: its own, otherwise that of the nearest parent.
fn effective(levels: &BTreeMap<String, Level>, name: &str) -> Level {
    let own = name_and_parents(name).find_map(|name| levels.get(name).copied());
    own.or_else(|| levels.get("").copied()).unwrap_or(Level::Info)
}

/// Returns a name and its parents: `a.b.c`, `a.b`, `a`.
fn name_and_parents(name: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(Some(name).filter(|name| !name.is_empty()), |name| Some(name.rsplit_once('.')?.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns loggers, and the filters that were applied.
    fn loggers(node: &str, base: Option<&str>) -> (Loggers, Arc<Mutex<Vec<String>>>) {
        let applied = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&applied);
        let apply = move |filter: &str| {
            filter.parse::<tracing_subscriber::EnvFilter>().map_err(|error| error.to_string())?;
            seen.lock().unwrap().push(filter.to_owned());
            Ok(())
        };
        (Loggers::new(node.to_owned(), base.map(str::to_owned), apply), applied)
    }

    fn last(applied: &Mutex<Vec<String>>) -> String {
        applied.lock().unwrap().last().cloned().unwrap()
    }

    #[test]
    fn node_logger_controls_program() {
        let (loggers, applied) = loggers("cell.shaft", None);
        assert_eq!((loggers.get("cell.shaft"), loggers.get(""), loggers.get("other")), (0, 20, 0));
        loggers.set_number("cell.shaft", 40).unwrap();
        assert_eq!(loggers.get("cell.shaft"), 40);
        assert!(last(&applied).ends_with(",cell::shaft=error,lineshaft=error"), "{}", last(&applied));
        assert!(!loggers.is_enabled(Severity::Warn) && loggers.is_enabled(Severity::Error));
        // The level of a parent applies if the logger has none.
        loggers.set_number("cell.shaft", 0).unwrap();
        loggers.set_number("cell", 10).unwrap();
        assert!(last(&applied).ends_with(",lineshaft=debug"));
        assert!(loggers.is_enabled(Severity::Debug));
        loggers.set_number("rustdds.rtps", 10).unwrap();
        assert!(last(&applied).contains(",rustdds::rtps=debug"));
    }

    #[test]
    fn a_level_for_all_takes_the_place_of_the_environment() {
        let (loggers, applied) = loggers("shaft", Some("lineshaft=trace"));
        loggers.set("rustdds", Some(Level::Info)).unwrap();
        assert_eq!(last(&applied), "lineshaft=trace,rustdds=info");
        loggers.set("", Some(Level::Fatal)).unwrap();
        assert!(last(&applied).starts_with("off,rustdds=warn"), "{}", last(&applied));
        assert_eq!(loggers.get(""), 50);
        assert!(!loggers.is_enabled(Severity::Error));
    }

    #[test]
    fn what_is_no_level_changes_nothing_and_strange_names_break_no_filter() {
        let (loggers, applied) = loggers("shaft", None);
        for number in [1, 15, 51, 255, 256 + 10, u32::MAX] {
            let sentence = loggers.set_number("shaft", number).unwrap_err();
            assert!(sentence.starts_with(&format!("level is {number}; 0 unset")), "{sentence}");
        }
        assert!(applied.lock().unwrap().is_empty());
        loggers.set_number("a,b=trace[{", 10).unwrap();
        assert_eq!(loggers.get("a,b=trace[{"), 10);
        assert!(!last(&applied).contains("trace"), "{}", last(&applied));
        assert!(loggers.set_number(&"a".repeat(256), 10).is_err());
        for number in 0..2 * MOST {
            let _ = loggers.set_number(&format!("a{number}"), 10);
        }
        assert_eq!(loggers.levels().len(), MOST);
    }
}

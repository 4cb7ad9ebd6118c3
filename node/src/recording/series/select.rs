//! Selects signals by patterns.

use crate::scenario::{did_you_mean, nearest};
use globset::{GlobBuilder, GlobMatcher};
use lineshaft_core::unit::excerpt;
use std::collections::HashSet;

/// Reason why signals cannot be selected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SelectError {
    /// The pattern is invalid.
    #[error("`{pattern}` is no pattern: {reason}")]
    Pattern {
        /// Given pattern.
        pattern: String,
        /// Reason.
        reason: String,
    },
    /// No name matches the pattern.
    #[error("no signal matches `{pattern}`{hint}")]
    NoMatch {
        /// Given pattern.
        pattern: String,
        /// Suggested name.
        hint: String,
    },
}

/// Compiles a pattern such as `x.*`.
pub(crate) fn pattern(text: &str) -> Result<GlobMatcher, SelectError> {
    let glob = GlobBuilder::new(text)
        .build()
        .map_err(|error| SelectError::Pattern { pattern: excerpt(text), reason: error.kind().to_string() })?;
    Ok(glob.compile_matcher())
}

/// Returns the error for a pattern that matches none of the names.
pub(crate) fn no_match<'n>(pattern: &str, names: impl Iterator<Item = &'n str>) -> SelectError {
    let hint = nearest(pattern, names).map_or(String::new(), |name| format!(", {}", did_you_mean(name)));
    SelectError::NoMatch { pattern: excerpt(pattern), hint }
}

/// Returns the name of the corresponding field of a message: `x.position` for `x.actual.position`, and likewise
/// `x.command_velocity` and `x.error_code`.
pub(crate) fn alias(name: &str) -> Option<String> {
    let (rest, last) = name.rsplit_once('.')?;
    let other = match (rest.rsplit_once('.'), last) {
        (Some((object, "actual")), _) => format!("{object}.{last}"),
        (Some((object, group @ ("command" | "sync"))), _) => format!("{object}.{group}_{last}"),
        (_, "error") => format!("{rest}.error_code"),
        _ => return None,
    };
    Some(other)
}

/// Maximum number of names in a message.
const MOST_NAMES: usize = 6;

/// Patterns, and the names that they were compared with.
pub(super) struct Select {
    patterns: Vec<(String, GlobMatcher, bool)>,
    names: HashSet<String>,
}

impl Select {
    pub(super) fn new(patterns: &[String]) -> Result<Self, SelectError> {
        let patterns = patterns.iter().map(|text| Ok((text.clone(), pattern(text)?, false)));
        Ok(Self { patterns: patterns.collect::<Result<_, _>>()?, names: HashSet::new() })
    }

    /// Whether a pattern matches this signal, by its name or its alias.
    pub(super) fn wants(&mut self, name: &str, alias: Option<&str>) -> bool {
        self.names.insert(name.to_owned());
        let mut is_wanted = self.patterns.is_empty();
        for (_, pattern, has_matched) in &mut self.patterns {
            if pattern.is_match(name) || alias.is_some_and(|alias| pattern.is_match(alias)) {
                (is_wanted, *has_matched) = (true, true);
            }
        }
        is_wanted
    }

    /// Clears all names.
    pub(super) fn start_again(&mut self) {
        self.names.clear();
        self.patterns.iter_mut().for_each(|(.., has_matched)| *has_matched = false);
    }

    /// Whether there was no name.
    pub(super) fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Returns an error for the first pattern that matched nothing. `is_board`: the names are those of the cell.
    pub(super) fn finish(&self, is_board: bool) -> Result<(), SelectError> {
        let Some((text, ..)) = self.patterns.iter().find(|(.., has_matched)| !has_matched) else { return Ok(()) };
        let mut names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        names.sort_unstable();
        let aliases: Vec<String> = names.iter().filter_map(|name| alias(name)).collect();
        let known = || names.iter().copied().chain(aliases.iter().map(String::as_str));
        // An incomplete name is more likely than a misspelled one.
        let longer = known().filter(|name| name.starts_with(text.as_str())).min_by_key(|name| name.len());
        let near = longer.or_else(|| nearest(text, known()));
        let mut hint = near.map_or(String::new(), |name| format!(", {}", did_you_mean(name)));
        hint += if near.is_some() { " " } else { "; " };
        hint += &if is_board { "`lineshaft signals CELL` lists all names".to_owned() } else { listed(&names) };
        Err(SelectError::NoMatch { pattern: excerpt(text), hint })
    }
}

/// Returns text such as `the run has x.state, x.error and 19 more`.
fn listed(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(MOST_NAMES).map(|name| excerpt(name)).collect();
    let more = names.len() - shown.len();
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    format!("the run has {}{more}", shown.join(", "))
}

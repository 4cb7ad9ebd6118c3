//! Errors and warnings about a file, as messages with line numbers.

use lineshaft_cia402::dictionary::MOST_QUOTED;
use std::fmt;

/// Maximum number of stored problems of each kind; further ones are only counted, as an invalid file could have millions of them.
pub(super) const MOST_PROBLEMS: usize = 200;

/// Kind of an ignored key of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum IgnoredKeyKind {
    /// DefaultValue, ParameterValue, or a value of `[xxxxValue]`.
    Value,
    /// LowLimit, HighLimit.
    Limit,
}

/// Value or limit of an object that was ignored with a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct IgnoredKey {
    /// Index of the object.
    pub index: u16,
    /// Kind of the key.
    pub key: IgnoredKeyKind,
}

/// Error or warning.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// Line of the file, from 1; `None` for the file as a whole.
    pub line: Option<usize>,
    /// Message.
    pub text: String,
    /// Value or limit that was ignored, if that is the problem.
    pub passed_over: Option<IgnoredKey>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}: {}", self.text),
            None => f.write_str(&self.text),
        }
    }
}

/// Problems of one kind, ordered by line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems {
    kept: Vec<Problem>,
    dropped: usize,
}

impl Problems {
    pub(super) fn add(&mut self, line: Option<usize>, text: impl Into<String>) {
        self.add_of(line, text, None);
    }

    pub(super) fn add_of(&mut self, line: Option<usize>, text: impl Into<String>, passed_over: Option<IgnoredKey>) {
        // Half of the room is reserved for problems other than ignored values: a message about a left out object must not get lost among
        // those about defaults.
        let most = if passed_over.is_some() { MOST_PROBLEMS / 2 } else { MOST_PROBLEMS };
        if self.kept.len() < most {
            self.kept.push(Problem { line, text: text.into(), passed_over });
        } else {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    pub(super) fn sort(&mut self) {
        self.kept.sort();
    }

    /// Returns the stored problems.
    pub fn kept(&self) -> &[Problem] {
        &self.kept
    }

    /// Returns the number of problems that were only counted.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Returns true if there are no problems.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, problem) in self.kept.iter().enumerate() {
            write!(f, "{}{problem}", if number == 0 { "" } else { "\n" })?;
        }
        if self.dropped > 0 {
            write!(f, "\nand {} more", self.dropped)?;
        }
        Ok(())
    }
}

/// Errors that prevented reading a file, and its warnings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdsErrors {
    /// Problems that make the file unusable.
    pub errors: Problems,
    /// Problems that would only have been reported as warnings.
    pub warnings: Problems,
}

impl fmt::Display for EdsErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.errors.fmt(f)
    }
}

impl std::error::Error for EdsErrors {}

/// Returns the text without quotation marks, shortened if it is long; control characters are replaced by `?`.
pub(super) fn cut(text: &str) -> String {
    text.chars().take(MOST_QUOTED).map(|character| if character.is_control() { '?' } else { character }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_beyond_the_most_are_counted() {
        let mut problems = Problems::default();
        for line in 1..=MOST_PROBLEMS + 3 {
            problems.add(Some(line), "a");
        }
        assert_eq!((problems.kept().len(), problems.dropped()), (MOST_PROBLEMS, 3));
        assert!(problems.to_string().starts_with("line 1: a\nline 2: a\n"));
        assert!(problems.to_string().ends_with("line 200: a\nand 3 more"));
    }

    #[test]
    fn ignored_values_leave_room_for_other_problems() {
        let mut problems = Problems::default();
        let of_value = Some(IgnoredKey { index: 0x2000, key: IgnoredKeyKind::Value });
        for line in 1..=MOST_PROBLEMS {
            problems.add_of(Some(line), "a", of_value);
        }
        problems.add(Some(MOST_PROBLEMS + 1), "b");
        assert_eq!((problems.kept().len(), problems.dropped()), (101, 100));
        assert_eq!(problems.kept()[100].to_string(), "line 201: b");
    }
}

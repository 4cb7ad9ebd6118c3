//! What is wrong with a file, in sentences with line numbers.

use std::fmt;

/// Problems that are kept of each kind; the others are only counted. A file of noise would fill the memory with them.
pub(super) const MOST_PROBLEMS: usize = 200;
/// Characters of the file that a sentence quotes.
const MOST_QUOTED: usize = 60;

/// Which key of an object a warning passes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PassedKey {
    /// DefaultValue, ParameterValue, or a value of `[xxxxValue]`.
    Value,
    /// LowLimit, HighLimit.
    Limit,
}

/// A value or a limit of an object that a warning passes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PassedOver {
    /// The index of the object.
    pub index: u16,
    /// Which key.
    pub key: PassedKey,
}

/// One problem.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// Line of the file, from 1; none for the file as a whole.
    pub line: Option<usize>,
    /// The sentence.
    pub text: String,
    /// The value or limit that is passed over, if the problem is that.
    pub passed_over: Option<PassedOver>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}: {}", self.text),
            None => f.write_str(&self.text),
        }
    }
}

/// Problems of one kind, in the order of their lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems {
    kept: Vec<Problem>,
    dropped: usize,
}

impl Problems {
    pub(super) fn add(&mut self, line: Option<usize>, text: impl Into<String>) {
        self.add_of(line, text, None);
    }

    pub(super) fn add_of(&mut self, line: Option<usize>, text: impl Into<String>, passed_over: Option<PassedOver>) {
        // Half of the room is for what is no value: an object that is left out must not get lost among defaults.
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

    /// The first ones.
    pub fn kept(&self) -> &[Problem] {
        &self.kept
    }

    /// How many more there are.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Is there none?
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

/// Why a file gives no dictionary, and what else was noticed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdsErrors {
    /// What makes the file unusable.
    pub errors: Problems,
    /// What could have been passed over.
    pub warnings: Problems,
}

impl fmt::Display for EdsErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.errors.fmt(f)
    }
}

impl std::error::Error for EdsErrors {}

/// The text in quotation marks, cut where it is long.
pub(super) fn quoted(text: &str) -> String {
    let cut: String = text.chars().take(MOST_QUOTED).collect();
    let more = if cut.len() < text.len() { ".." } else { "" };
    format!("{cut:?}{more}")
}

/// The text without quotation marks, cut where it is long; what would tear a line stands as ?.
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
    fn passed_over_values_leave_room_for_other_problems() {
        let mut problems = Problems::default();
        let of_value = Some(PassedOver { index: 0x2000, key: PassedKey::Value });
        for line in 1..=MOST_PROBLEMS {
            problems.add_of(Some(line), "a", of_value);
        }
        problems.add(Some(MOST_PROBLEMS + 1), "b");
        assert_eq!((problems.kept().len(), problems.dropped()), (101, 100));
        assert_eq!(problems.kept()[100].to_string(), "line 201: b");
    }

    #[test]
    fn a_long_text_is_cut_at_a_character() {
        assert_eq!(quoted("a\"b"), r#""a\"b""#);
        assert_eq!(quoted(&"ä".repeat(61)), format!("\"{}\"..", "ä".repeat(60)));
    }
}

//! Collects problems with their locations.

use super::bare::BareNumber;
use lineshaft_core::unit::excerpt;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::sync::Arc;

/// Maximum number of problems that are stored; further ones are only counted.
const MAX_PROBLEMS: usize = 1000;

/// Line and column in a file, both from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub col: usize,
}

impl Place {
    /// First character of a file.
    pub const START: Self = Self { line: 1, col: 1 };

    /// Returns the location after a text at the start of a file.
    pub(crate) fn after(text: &str) -> Self {
        let last = text.rsplit('\n').next().unwrap_or_default();
        Self { line: 1 + text.matches('\n').count(), col: 1 + last.chars().count() }
    }
}

/// A problem: location, error with the permitted values, and hint.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// Path of the file, as given to the program.
    pub file: Arc<str>,
    /// Location in the file.
    pub place: Place,
    /// Given value and permitted values.
    pub sentence: String,
    /// Probable correction.
    pub hint: Option<String>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, place: Place { line, col }, sentence, hint } = self;
        write!(f, "{file}:{line}:{col}: {sentence}")?;
        hint.as_ref().map_or(Ok(()), |hint| write!(f, ", {hint}"))
    }
}

/// Problems of one or several files. All readers of a document share it, hence the interior mutability.
#[derive(Clone, Debug)]
pub struct Problems {
    pub(super) file: Arc<str>,
    list: RefCell<Vec<Problem>>,
    /// Number of problems after the first [`MAX_PROBLEMS`].
    beyond: Cell<usize>,
    /// Numbers without a unit, while a reader records them.
    pub(super) bare: RefCell<Option<Vec<BareNumber>>>,
    /// Observer of the requests of readers.
    #[cfg(test)]
    pub(super) observer: Option<Arc<super::Observer>>,
}

impl Problems {
    /// Creates an empty list for a file.
    pub fn new(file: &str) -> Self {
        Self {
            file: file.into(),
            list: RefCell::default(),
            beyond: Cell::new(0),
            bare: RefCell::default(),
            #[cfg(test)]
            observer: None,
        }
    }

    /// Adds a problem.
    pub fn push(&self, place: Place, sentence: impl Into<String>, hint: Option<String>) {
        if self.is_full() {
            self.beyond.set(self.beyond.get() + 1);
            return;
        }
        let problem = Problem { file: Arc::clone(&self.file), place, sentence: sentence.into(), hint };
        self.list.borrow_mut().push(problem);
    }

    /// Adds the problems of another file.
    pub fn append(&self, other: Self) {
        self.beyond.set(self.beyond.get() + other.beyond.get());
        self.list.borrow_mut().append(&mut other.list.into_inner());
    }

    /// Returns true if there are no problems.
    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }

    /// Returns the number of different problems: a value with an anchor is read at every alias.
    pub fn count(&self) -> usize {
        self.sorted().len() + self.beyond.get()
    }

    /// Returns the different problems, sorted by file, line and column.
    pub fn sorted(&self) -> Vec<Problem> {
        let mut list = self.list.borrow().clone();
        list.sort();
        list.dedup();
        list
    }

    /// Whether further problems are only counted, so that no hints are needed.
    pub(super) fn is_full(&self) -> bool {
        self.list.borrow().len() >= MAX_PROBLEMS
    }
}

/// Prints one line per problem, sorted by location.
impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for problem in self.sorted() {
            writeln!(f, "{problem}")?;
        }
        match self.beyond.get() {
            0 => Ok(()),
            more => writeln!(f, "{}: {more} more problems", self.file),
        }
    }
}

impl std::error::Error for Problems {}

/// Quotes a part of a document for a message.
pub(super) fn quote(text: &str) -> String {
    format!("`{}`", excerpt(text))
}

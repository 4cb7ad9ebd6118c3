//! Problems with their place, collected.

use lineshaft_core::unit::excerpt;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::sync::Arc;

/// Problems that are kept; what comes later is only counted.
const MAX_PROBLEMS: usize = 1000;

/// Line and column in a file, both from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub col: usize,
}

impl Place {
    /// The first character of a file.
    pub const START: Self = Self { line: 1, col: 1 };

    /// The place behind a text that starts a file.
    pub(crate) fn after(text: &str) -> Self {
        let last = text.rsplit('\n').next().unwrap_or_default();
        Self { line: 1 + text.matches('\n').count(), col: 1 + last.chars().count() }
    }
}

/// One problem: where, what is wrong and what is allowed, how to put it right.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// The file as it was named to the program.
    pub file: Arc<str>,
    /// Where in the file.
    pub place: Place,
    /// What was given and what is allowed.
    pub sentence: String,
    /// What was probably meant.
    pub hint: Option<String>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, place: Place { line, col }, sentence, hint } = self;
        write!(f, "{file}:{line}:{col}: {sentence}")?;
        hint.as_ref().map_or(Ok(()), |hint| write!(f, ", {hint}"))
    }
}

/// The problems of a file, or of several. Shared by all readers of a document, hence the interior mutability.
#[derive(Clone, Debug)]
pub struct Problems {
    file: Arc<str>,
    list: RefCell<Vec<Problem>>,
    /// How many came after the first [`MAX_PROBLEMS`].
    beyond: Cell<usize>,
    /// Observer of the requests of readers.
    #[cfg(test)]
    pub(super) observer: Option<Arc<super::Observer>>,
}

impl Problems {
    /// None yet, for a file.
    pub fn new(file: &str) -> Self {
        Self {
            file: file.into(),
            list: RefCell::default(),
            beyond: Cell::new(0),
            #[cfg(test)]
            observer: None,
        }
    }

    /// Notes a problem.
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

    /// True when nothing is wrong.
    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }

    /// How many there are, each once: a value behind an anchor is read at every alias.
    pub fn count(&self) -> usize {
        self.sorted().len() + self.beyond.get()
    }

    /// By file, line and column, each once.
    pub fn sorted(&self) -> Vec<Problem> {
        let mut list = self.list.borrow().clone();
        list.sort();
        list.dedup();
        list
    }

    /// True when further problems are only counted, so that nobody need look for hints.
    pub(super) fn is_full(&self) -> bool {
        self.list.borrow().len() >= MAX_PROBLEMS
    }
}

/// One line per problem, by position.
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

/// A piece of a document in a sentence.
pub(super) fn quote(text: &str) -> String {
    format!("`{}`", excerpt(text))
}

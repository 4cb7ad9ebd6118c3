//! The reference of the keys of cells, scenarios and descriptions of tables: docs/keys.md, JSON Schema, and `explain`.
//!
//! The readers of the files are code, not a table, so a separate table could be out of date. Two things prevent that:
//!
//! - The table ([`keys`]) says of each key what it is for, and of which kind and range its value is.
//! - A test reads all example files and a few cells of its own with an observer (`document/observer.rs`), which notes each key that a
//!   reader asks for, whether it is in the file or not, and the kind of each value. The keys that were asked for must be the
//!   keys of the table, and their kinds, ranges, names and whether they are required must agree with it.
//!
//! Parameters of axes and of the machine, and fields of function types, have tables of their own in the core; they are taken from there.
//!
//! A key is a path: `axes.*.drive.node` is key `node` in key `drive` of each axis. `*` is a name of the user's own, `[]` an entry of a
//! list, `condition` an entry of a list `all` or `any`.

mod catalogue;
mod cell;
mod description;
mod markdown;
mod scenario;
mod schema;

pub use markdown::markdown;
pub(crate) use markdown::range;
pub use schema::schema;

/// The version that the first keys came with.
const FIRST: &str = "0.1.0";

/// Files with keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum File {
    /// A cell.
    Cell,
    /// A scenario.
    Scenario,
    /// The description of a table, which `lineshaft table make` reads.
    Table,
}

impl File {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Cell, Self::Scenario, Self::Table];

    /// Its name in sentences.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cell => "cell",
            Self::Scenario => "scenario",
            Self::Table => "description of a table",
        }
    }

    /// Its keys, in the order of the reference.
    pub fn keys(self) -> impl Iterator<Item = &'static Key> {
        keys().filter(move |key| key.file == self)
    }
}

/// The kind of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A text; numbers and `true` are texts, too.
    Text,
    /// `true` or `false`.
    Boolean,
    /// A whole number between these, both included.
    Integer(i128, i128),
    /// A number.
    Number,
    /// A number with a unit of what is named; a number without one is SI.
    Quantity(&'static str),
    /// One of these names.
    Choice(&'static [&'static str]),
    /// A list; its entries are `[]`.
    List,
    /// A mapping with keys of this reference.
    Map,
    /// A mapping whose keys are names of the user's own.
    Names,
}

/// One key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The file.
    pub file: File,
    /// Its path: `axes.*.drive.node`.
    pub path: &'static str,
    /// Kinds of its value: one of these.
    pub shapes: &'static [Shape],
    /// Every mapping that can have the key must have it.
    pub required: bool,
    /// Allowed values, if the shapes do not say it; else empty.
    pub range: &'static str,
    /// The value without the key; empty if there is none.
    pub default: &'static str,
    /// Its purpose, in one sentence.
    pub meaning: &'static str,
    /// An entry of a file; empty for the entries of lists and of mappings of names.
    pub example: &'static str,
    /// The version that it came with.
    pub since: &'static str,
}

impl Key {
    const fn new(
        file: File,
        path: &'static str,
        shapes: &'static [Shape],
        [range, default, meaning, example]: [&'static str; 4],
    ) -> Self {
        Self { file, path, shapes, required: false, range, default, meaning, example, since: FIRST }
    }

    const fn required(self) -> Self {
        Self { required: true, ..self }
    }

    /// The last part of its path: the key as it is written.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }
}

/// All keys that no other table has.
const KEYS: [&[&[Key]]; 3] = [cell::KEYS, scenario::KEYS, description::KEYS];

/// All keys that no other table has, in the order of the reference.
pub fn keys() -> impl Iterator<Item = &'static Key> {
    KEYS.into_iter().flatten().copied().flatten()
}

/// The keys of that name: a whole path, or its last part.
pub fn find(name: &str) -> impl Iterator<Item = &'static Key> {
    keys().filter(move |key| key.path == name || key.name() == name)
}

#[cfg(test)]
mod tests;

//! The reference of the keys of cells, scenarios and descriptions of tables: docs/keys.md, JSON Schema, and `explain`.
//!
//! The readers of the files are code, not a table, so a separate table could be out of date. Two things prevent that:
//!
//! - The table ([`keys`]) has the purpose of each key, and the shape and range of its value.
//! - A test reads all example files and some additional cells with an observer (`document/observer.rs`), which records
//!   each key that a reader requests, whether it is in the file or not, and the kind of each value. The requested keys
//!   must be the keys of the table, and their kinds, ranges and names, and whether they are required, must agree with
//!   it.
//!
//! Parameters of axes and of the machine, and fields of function types, are in tables of the core; they are taken from
//! there.
//!
//! A key is a path: `axes.*.drive.node` is key `node` in key `drive` of each axis. `*` is a name chosen by the user,
//! `[]` an entry of a list, `condition` an entry of a list `all` or `any`.

mod catalogue;
mod cell;
mod description;
mod markdown;
mod scenario;
mod schema;

pub use markdown::markdown;
pub(crate) use markdown::range;
pub use schema::schema;

/// Version in which the first keys were introduced.
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
    /// All files with keys.
    pub const ALL: [Self; 3] = [Self::Cell, Self::Scenario, Self::Table];

    /// Returns the name for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cell => "cell",
            Self::Scenario => "scenario",
            Self::Table => "description of a table",
        }
    }

    /// Returns its keys, in the order of the reference.
    pub fn keys(self) -> impl Iterator<Item = &'static Key> {
        keys().filter(move |key| key.file == self)
    }
}

/// Shape of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A text; numbers and `true` are texts, too.
    Text,
    /// `true` or `false`.
    Boolean,
    /// Integer between these, inclusive.
    Integer(i128, i128),
    /// A number.
    Number,
    /// Number with a unit of the named quantity; a number without unit is in SI.
    Quantity(&'static str),
    /// A quantity that is a multiple of the unit in the meaning of the key.
    Multiple,
    /// One of these names.
    Choice(&'static [&'static str]),
    /// A list; its entries are `[]`.
    List,
    /// Mapping with keys of this reference.
    Map,
    /// Mapping whose keys are names chosen by the user.
    Names,
}

/// One key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// File that has the key.
    pub file: File,
    /// Path, such as `axes.*.drive.node`.
    pub path: &'static str,
    /// Permitted shapes of its value.
    pub shapes: &'static [Shape],
    /// Whether every mapping that can have the key must have it.
    pub required: bool,
    /// Permitted values, if the shapes do not define them; otherwise empty.
    pub range: &'static str,
    /// Value if the key is absent; empty if there is none.
    pub default: &'static str,
    /// Purpose, in one sentence; further ones warn of misunderstandings.
    pub meaning: &'static str,
    /// Example of an entry; empty for the entries of lists and of mappings of names.
    pub example: &'static str,
    /// Version in which it was introduced.
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

    /// Returns the last part of its path: the key as written.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }
}

/// All keys that are in no other table.
const KEYS: [&[&[Key]]; 3] = [cell::KEYS, scenario::KEYS, description::KEYS];

/// Returns all keys that are in no other table, in the order of the reference.
pub fn keys() -> impl Iterator<Item = &'static Key> {
    KEYS.into_iter().flatten().copied().flatten()
}

/// Returns the keys with that name: a full path, or its last part.
pub fn find(name: &str) -> impl Iterator<Item = &'static Key> {
    keys().filter(move |key| key.path == name || key.name() == name)
}

#[cfg(test)]
mod tests;

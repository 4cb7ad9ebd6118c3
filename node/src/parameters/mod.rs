//! Parameter sets as text: in bags, exported, imported and stored; and the description of the catalogue.

mod catalogue;
mod markdown;
mod read;
mod text;
mod values;
mod words;

pub(crate) use catalogue::wrap;
pub use catalogue::{Filter, details, listing, meant};
pub use markdown::markdown;
pub(crate) use read::changes;
pub use read::{Import, check_import, read_changes};
pub(crate) use text::exact_text;
pub use text::{export_text, parameters_text};
pub use values::{differences, values};
pub(crate) use words::{default_text, range_words, unit_text};

#[cfg(test)]
mod tests;

//! Sets of parameters as text: what a bag holds, what is exported and imported, what is stored; and the catalogue as people
//! read it.

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

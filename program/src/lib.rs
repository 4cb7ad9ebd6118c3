//! User programs in the cycle: WebAssembly that is checked and translated once, and executed in bounded time.
//!
//! Law      the same module, state and image give the same bits on every machine: arithmetic has a single NaN, memory
//!          never grows, nothing is imported. A call does not allocate or lock, and uses at most its fuel
//! Reads    a module (`module.rs`), an image in its memory (`image.rs`)
//! Refuses  features whose results would differ between machines, or whose time and memory are not bounded, by name and
//!          with the position in the module

#![forbid(unsafe_code)]

mod code;
mod image;
mod instance;
mod module;
mod number;
mod run;
#[cfg(test)]
mod tests;
mod translate;
mod trap;

pub use image::{Command, DB_WORDS, Image, PARAMETERS, SIZE, WORDS, is_as_long};
pub use instance::Instance;
pub use module::shared;
pub use module::{ENTRY, IMAGE, MOST_BYTES, MOST_GLOBALS, MOST_PAGES, Module, PAGE, Refused};
pub use trap::Trap;

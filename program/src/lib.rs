//! Programs of users in the cycle: WebAssembly that is checked and translated once, and run with bounded time.
//!
//! Law      the same module, state and image give the same bits on every machine: arithmetic gives one NaN alone, memory never grows,
//!          nothing is imported. A call takes no memory, no lock, and no more than its fuel
//! Reads    a module (`module.rs`), an image in its memory (`image.rs`)
//! Refuses  what it would not do the same everywhere, or not in bounded time and memory, by name and with its place in the module

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

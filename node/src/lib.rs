//! The Lineshaft program.

pub mod document;

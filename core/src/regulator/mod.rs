//! Regulators that close a loop in the core, for drives that do not close it themselves.

mod proportional;

pub use proportional::{KV, Proportional};

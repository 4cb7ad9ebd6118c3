//! How an axis answers with given loops: over frequency, and in time.
//!
//! Law      `frequency.rs`: open and closed loop, margins, sensitivity. `time.rs`: the laws of the core on the model
//! Reads    a model, loops
//! Writes   points, figures
//! Refuses  loops that do not suit the model

pub(crate) mod frequency;
mod time;

pub use frequency::{Bode, Margins, Point, bode, velocity_bode};
pub use time::{Figures, Move, Sample, Trace, simulate};

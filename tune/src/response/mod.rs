//! Response of an axis with given loops, in frequency and in time.
//!
//! Law      `frequency.rs`: open and closed loop, margins, sensitivity. `time.rs`: the laws of the core on the model.
//!          `retrace.rs`: the motion of the model for a record
//! Reads    a model, loops
//! Writes   points, figures
//! Refuses  loops that do not suit the model

pub(crate) mod frequency;
mod retrace;
mod time;

pub use frequency::{Bode, Margins, Point, bode, velocity_bode};
pub use retrace::{check_fit, retrace};
pub use time::{Figures, Move, Sample, Trace, simulate};

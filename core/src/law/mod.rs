//! What tables are made of: laws of motion, plans of them, splines through points.
//!
//! Law      in floating point, outside the cycle, but for [`Spline::rise`] and [`Spline::slope`]; the same bits on every machine
//! Refuses  segments and points that make no curve, by their number
//! Source   VDI 2143

mod plan;
mod polynomial;
mod spline;
mod transfer;

pub use plan::{Jump, Plan, PlanError, Segment};
pub use spline::{Ends, Spline, SplineError};
pub use transfer::{Derivatives, Law, Peak, Peaks};

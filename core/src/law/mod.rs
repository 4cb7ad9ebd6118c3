//! Sources of tables: laws of motion, motion plans, splines through points.
//!
//! Law      floating point, outside the cycle except [`Spline::rise`] and [`Spline::slope`]; identical bits on every
//!          machine
//! Refuses  segments and points that make no curve, by their number
//! Source   VDI 2143

mod plan;
mod polynomial;
mod spline;
mod transfer;

pub use plan::{Jump, Plan, PlanError, Segment};
pub use spline::{Ends, Spline, SplineError};
pub use transfer::{Derivatives, Law, Peak, Peaks};

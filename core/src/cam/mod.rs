//! Cams: what a table makes of the place of its master, and what tables are made of: laws of motion, splines.
//!
//! Law      exact: a value between two points is a ratio of whole numbers, and is rounded once, where it is written. Laws and splines
//!          are in floating point, outside the cycle
//! Reads    tables of form y and xy
//! Refuses  nothing in a cycle: who starts a cam has checked its table. Segments and points that make no curve, by their number
//! Source   AMK-FIPW-01 to -06, AMK-XFIPW-10 to -15, A-04, A-21, contract section 10

mod curve;
mod law;
mod plan;
mod polynomial;
mod spline;
mod total;

pub use curve::{Curve, Point};
pub use law::{Derivatives, Law, Peak, Peaks};
pub use plan::{Jump, Plan, PlanError, Segment};
pub use spline::{Ends, Spline, SplineError};
pub use total::{Scale, Total};

//! Cams: tables as functions of the position of a master.
//!
//! Law      exact: a value between two points is a ratio of whole numbers, and is rounded once, when it is written
//! Reads    tables of form y and xy
//! Refuses  nothing in a cycle: the table of a cam is checked at its start
//! Source   AMK-FIPW-01 to -06, AMK-XFIPW-10 to -15, A-04, A-21, contract section 10

mod curve;
mod total;

pub use curve::{Curve, Point};
pub use total::{Scale, Total};

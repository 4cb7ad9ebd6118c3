//! The report, as it reads.

use super::*;
use crate::tune::test_axes::{before, cascade, effort_record, subject, velocity_record, wish};
use lineshaft_tune::{PositionLaw, Targets, Wish};

fn of_velocities() -> Findings {
    Findings::find(subject(), &velocity_record(), &wish(), &before()).unwrap()
}

#[test]
fn print() {
    println!("{}", of_velocities().text());
    let (wish, loops) = cascade();
    println!("{}", Findings::find(subject(), &effort_record(), &wish, &loops).unwrap().text());
}

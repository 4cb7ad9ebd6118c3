//! Tests of the catalogue against the specification, and of its rows.

mod gain;
mod ranges;
mod sources;
mod spec;
mod table;
mod units;
mod views;

use super::*;

fn parameters() -> AxisParameters {
    AxisParameters::new(1000.0, 5000.0)
}

#[test]
fn keys_and_source_numbers_stand_once() {
    for (index, row) in ROWS.iter().enumerate() {
        let later = &ROWS[index + 1..];
        assert!(later.iter().all(|other| other.key != row.key), "{}", row.key);
        let same = |other: &Row| {
            (other.system, other.applies == Applies::Machine) == (row.system, row.applies == Applies::Machine)
                && other.number == row.number
        };
        assert!(row.number.is_empty() || !later.iter().any(same), "{} {}", row.key, row.number);
    }
}

/// Proves: MACS-PROF-06
#[test]
fn defaults_are_half_of_the_maximum_and_deceleration_takes_the_share_of_acceleration() {
    let mut p = parameters();
    p.max_deceleration = Some(2000.0);
    assert_eq!((p.usual_velocity(), p.usual_acceleration(), p.usual_deceleration()), (500.0, 2500.0, 1000.0));
    p.default_acceleration = Some(5000.0);
    assert_eq!(p.usual_deceleration(), 2000.0);
}

#[test]
fn contradictions_are_named() {
    let mut p = parameters();
    (p.min_position, p.max_position) = (Some(5), Some(5));
    assert_eq!(p.check(), Err(Contradiction::Above("min_position", "max_position")));
    p = parameters();
    p.default_velocity = Some(1001.0);
    assert_eq!(p.check(), Err(Contradiction::Above("default_velocity", "max_velocity")));
}

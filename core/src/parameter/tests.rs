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
fn keys_and_source_numbers_are_unique() {
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
    assert_eq!(
        (p.default_goal_velocity(), p.default_goal_acceleration(), p.default_goal_deceleration()),
        (500.0, 2500.0, 1000.0)
    );
    p.default_acceleration = Some(5000.0);
    assert_eq!(p.default_goal_deceleration(), 2000.0);
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

/// What an axis changes by itself has a value in force of its own.
#[test]
fn rows_that_an_axis_changes_are_stored() {
    let by_axis: Vec<_> = ROWS.iter().filter(|row| row.by_axis).collect();
    assert_eq!(by_axis.len(), parameters().values_by_axis().len());
    for row in by_axis {
        assert!(row.is_stored(), "{}", row.key);
    }
}

#[test]
fn each_function_that_needs_full_cycles_switches_them_on() {
    let switched_on: [fn(&mut AxisParameters); 3] = [
        |p| p.amplifier.torque_constant = 0.5,
        |p| (p.amplifier.encoder.number, p.amplifier.encoder.resolution) = (1, 4096),
        |p| (p.encoder.monitored, p.encoder.pulses_or_step) = (1, 1000),
    ];
    assert_eq!(switched_on.len(), ROWS.iter().filter(|row| row.full_cycles.is_some()).count());
    assert!(!parameters().needs_full_cycles());
    for switch_on in switched_on {
        let mut p = parameters();
        switch_on(&mut p);
        assert!(p.needs_full_cycles(), "{p:?}");
    }
    // Monitoring without pulses watches nothing.
    let mut p = parameters();
    p.encoder.monitored = 1;
    assert!(!p.needs_full_cycles());
}

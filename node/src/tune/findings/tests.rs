//! Tests findings of a drive with velocity interface, whose data are known.

use super::*;
use crate::tune::test_axes::{before, subject, velocity_record, wish};
use lineshaft_tune::{Dynamics, Targets};

fn found() -> Findings {
    Findings::find(subject(), &velocity_record(), &wish(), &before()).unwrap()
}

#[test]
fn both_sides_are_shown_on_the_model_that_was_found() {
    let found = found();
    let Dynamics::Velocity { gain, .. } = found.identified.model.dynamics else { panic!() };
    assert!((gain / 95_493.0 - 1.0).abs() < 0.005, "{gain}");
    let (before, after) = (found.before.as_ref().unwrap(), found.after.as_ref().unwrap());
    assert_eq!(bode(&found.identified.model, &after.loops).unwrap(), after.position);
    assert!(before.is_stable() && after.is_stable());
    assert!(after.position.margins.phase >= 60.0 && after.position.margins.gain >= 6.0);
    assert!(after.position.margins.crossover > 2.0 * before.position.margins.crossover);
    assert!(after.moved.figures.following_error < 0.1 * before.moved.figures.following_error);
}

#[test]
fn gains_stand_by_the_keys_of_their_parameters() {
    let found = found();
    let keys: Vec<&str> = found.gains.iter().map(|gain| gain.key).collect();
    assert_eq!(keys, ["kprop", "kder", "kint", "kilim", "ffvel", "ffacc", "timer"]);
    for Gain { key, .. } in &found.gains {
        assert!(Row::find(key).is_some_and(|(_, row)| row.is_stored()), "{key}");
    }
    let gain = |key: &str| found.gains.iter().find(|gain| gain.key == key).copied().unwrap();
    assert_eq!((gain("kprop").old, gain("timer").old), (Some(30.0), Some(1.0)));
    assert!(!gain("timer").changes() && gain("kprop").changes());
    assert!(found.changes().iter().all(|gain| gain.key != "timer"));
}

/// Values that the design does not determine are kept and shown.
#[test]
fn what_a_design_leaves_open_stays() {
    let mut before = before();
    let PositionLaw::Pid { gains, .. } = &mut before.position else { panic!() };
    (gains.bandwidth, gains.limit_time, gains.window.max) = (700, 30, 4);
    let found = Findings::find(subject(), &velocity_record(), &wish(), &before).unwrap();
    let PositionLaw::Pid { gains, .. } = found.after.unwrap().loops.position else { panic!() };
    assert_eq!((gains.bandwidth, gains.limit_time, gains.window.max), (700, 30, 4));
    assert!(gains.proportional > 30);
}

#[test]
fn a_servo_gain_is_rounded_down_and_within_its_range() {
    assert_eq!(servo_gain(72.4567), Ok(72.45));
    assert_eq!(servo_gain(30.0), Ok(30.0));
    assert_eq!(servo_gain(117.79), Ok(117.7));
    assert_eq!(servo_gain(1e5), Ok(1666.0));
    assert_eq!(servo_gain(0.1).unwrap_err(), "position_loop.kv would be 0.1 1/s; 0.1667 to 1666.7 1/s is permitted");
}

#[test]
fn a_design_that_is_refused_leaves_the_side_before() {
    let targets = Targets { phase_margin: 90.0, ..Targets::default() };
    let wish = DesignSpec { targets, ..wish() };
    let found = Findings::find(subject(), &velocity_record(), &wish, &before()).unwrap();
    assert_eq!(found.after.unwrap_err(), "phase_margin is 90 deg; 20 to 85 deg is permitted");
    assert!(found.before.is_ok() && found.gains.is_empty());
}

/// An oscillation of 20 inc that no part of the model explains.
#[test]
fn a_model_that_is_far_from_its_record_has_no_gains() {
    let mut record = velocity_record();
    for (k, position) in record.positions.iter_mut().enumerate() {
        *position += if k % 40 < 20 { 10 } else { -10 };
    }
    let found = Findings::find(subject(), &record, &wish(), &before()).unwrap();
    assert!(found.identified.explained > 95.0 && found.before.is_ok() && found.gains.is_empty());
    let refused = found.after.unwrap_err();
    assert!(
        refused.starts_with("half of the positions deviate by more than ") && refused.contains("play"),
        "{refused}"
    );
}

#[test]
fn a_record_without_a_model_is_refused() {
    let mut record = velocity_record();
    record.positions.fill(7);
    let refused = Findings::find(subject(), &record, &wish(), &before()).unwrap_err();
    assert!(matches!(refused, Refusal::Stuck { increments: 0, .. }), "{refused}");
}

/// An action fills its result from it.
#[test]
fn findings_are_serialized_whole() {
    let text = serde_json::to_value(found()).unwrap();
    assert!(text["after"]["Ok"]["position"]["margins"]["phase"].as_f64() >= Some(60.0));
    assert_eq!(text["gains"][0]["key"], "kprop");
    assert_eq!(text["subject"]["axis"], "x");
}

#[test]
fn steps_are_round() {
    assert_eq!([999.0, 499.0, 199.0, 10.0].map(round_down), [500.0, 200.0, 100.0, 10.0]);
}

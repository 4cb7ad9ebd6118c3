//! INDEX: motion to the next index pulse, without setting a zero.

use super::super::rig::{Rig, X};
use super::{cell, home, place, rig, rig_with, run_to_end, travel_range};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, Probe, ProbeEdge};
use crate::drive::Interface;
use crate::encoder::PulseCheck;
use crate::event::{Event, Kind};
use crate::object::{AxisSet, Object};
use crate::parameter::Value;
use crate::position::Length;
use crate::sim::Model;

/// Marks are at 300 + 2000 n, the next one at 2300; no switch is near.
const START: i64 = 1_000;
const NOWHERE: (i64, i64) = (15_000, 16_000);

fn index(by: i64, distance: i64) -> Action {
    Action::Probe(Probe {
        axis: X,
        relative: true,
        target: Length::whole(by),
        velocity: 7_300.0,
        acceleration: 1e6,
        deceleration: 1e6,
        jerk: 0.0,
        source: Object::Axis(X),
        edge: ProbeEdge::Index,
        distance: Length::whole(distance),
    })
}

fn give(rig: &mut Rig, action: Action) -> u64 {
    let sequence = rig.give(action);
    assert!(rig.was_accepted(sequence));
    sequence
}

fn run(rig: &mut Rig, sequence: u64) -> Vec<Code> {
    rig.run(3_000);
    rig.done(sequence).iter().map(|event| event.code).collect()
}

/// With 7.3 inc per cycle no sample is exactly at the mark: the count that the encoder captured decides.
///
/// Proves: MACS-CMD-02
#[test]
fn it_goes_to_the_next_index_pulse_and_sets_no_zero() {
    for (by, distance, mark) in [(2_500, 0, 2_300), (-2_500, 0, 300), (2_500, 17, 2_300), (-2_500, 400, 300)] {
        let mut rig = rig(travel_range(START, NOWHERE));
        let sequence = give(&mut rig, index(by, distance));
        assert_eq!(run(&mut rig, sequence), [Code::NONE]);
        let end = mark + distance;
        assert_eq!((place(&rig, START), rig.int("x.actual.position")), (end, end - START), "by {by}");
        assert_eq!((rig.int("x.homed"), rig.int("x.index.position")), (0, mark - START));
        let marks: Vec<&Event> = rig.events.iter().filter(|event| event.kind == Kind::Mark).collect();
        assert_eq!(marks.len(), 1);
        assert_eq!((marks[0].command, marks[0].position.floor()), (sequence, mark - START));
        assert!(marks[0].age_ns < 1_000_000);
        // The next search finds the next mark.
        let sequence = give(&mut rig, index(2_500, 0));
        let codes = run(&mut rig, sequence);
        let next = if end < 2_300 { 2_300 } else { 4_300 };
        assert_eq!((codes, place(&rig, START)), (vec![Code::NONE], next), "by {by}");
    }
}

/// A revolution has 2000 increments: after it the error follows, in its cycle, with any search distance.
///
/// Proves: MACS-CMD-02, MACS-HOME-05
#[test]
fn without_a_pulse_in_a_revolution_comes_an_error() {
    for reaction in [2, 5] {
        let mut rig = rig(travel_range(START, NOWHERE));
        rig.set("error_reaction", Value::Int(reaction));
        rig.plant.drive(0).unwrap().lose_index();
        let sequence = give(&mut rig, index(9_000, 0));
        for _ in 0..3_000 {
            if rig.int("x.error") != 0 || !rig.done(sequence).is_empty() {
                break;
            }
            rig.run(1);
        }
        let gone = place(&rig, START) - START;
        assert!((2_001..=2_008).contains(&gone), "{gone}");
        rig.run(500);
        let codes: Vec<Code> = rig.done(sequence).iter().map(|event| event.code).collect();
        assert_eq!(codes, [Code::HOMING_INDEX_MISSED], "reaction {reaction}");
        let state = if reaction == 2 { "ERROR_STOP" } else { "STANDSTILL" };
        assert_eq!((rig.state("x"), rig.real("x.command.velocity")), (state, 0.0), "reaction {reaction}");
    }
}

#[test]
fn a_search_that_ends_before_the_revolution_does_ends_as_any_other() {
    let mut rig = rig(travel_range(START, NOWHERE));
    let sequence = give(&mut rig, index(1_000, 0));
    assert_eq!(run(&mut rig, sequence), [Code::PROBE_MISSED]);
    assert_eq!((rig.state("x"), rig.int("x.error"), place(&rig, START)), ("STANDSTILL", 0, 2_000));
}

/// Proves: MACS-CMD-02, MACS-ENC-10
#[test]
fn absolute_encoders_have_none() {
    let mut config = cell(0);
    config.axes[usize::from(X)].parameters.encoder.encodertype = 1;
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, NOWHERE));
    let sequence = rig.give(index(2_500, 0));
    let sentence = "x: encodertype 1 says that its encoder is absolute, so that its zero stands; no homing, no index and no set_position";
    assert_eq!(rig.refusal(sequence), sentence);
}

/// The motor of the axis has an index of its own, at 300 + 2000 n, which is not that of the encoder that the axis
/// reads.
#[test]
fn the_index_is_that_of_the_encoder_that_the_axis_reads() {
    for searches in [false, true] {
        let mut config = cell(0);
        config.encoders[0].check = Some(PulseCheck { every: 2_000, tolerance: 8 });
        let axis = &mut config.axes[usize::from(X)];
        (axis.interface, axis.wired) = (Interface::Velocity, Wired::Encoder(0));
        axis.parameters.max_following_error = 20_000;
        let mut rig = rig_with(config, Model::Ideal, travel_range(START, NOWHERE));
        let before = rig.int("belt.count");
        let sequence = if searches { give(&mut rig, index(2_500, 0)) } else { home(&mut rig, 34) };
        assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
        rig.run(200);
        let mark = before - before.rem_euclid(2_000) + 2_000;
        let (count, position) = (rig.int("belt.count"), rig.int("x.actual.position"));
        // The command in counts of the encoder; for homing, the zero.
        let place = count - position + if searches { rig.int("x.command.position") } else { 0 };
        assert_eq!(place, mark, "searches: {searches}");
    }
}

#[test]
fn a_latch_of_the_axis_is_no_index() {
    let mut rig = rig(travel_range(START, NOWHERE));
    let sequence = give(&mut rig, index(1_000, 0));
    rig.run(20);
    let latch = crate::drive::Latch {
        object: Object::Axis(X),
        edge: crate::drive::Edge::Rising,
        age_ns: Some(0),
        position: None,
    };
    assert!(rig.plant.add_latch(latch));
    assert_eq!(run(&mut rig, sequence), [Code::PROBE_MISSED]);
    rig.give(Action::Halt(AxisSet::one(X)));
}

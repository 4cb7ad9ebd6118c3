//! Each output has at most one function.

use super::super::rig::{Rig, X, Y, to};
use super::{R, set, with_io};
use crate::axis::BrakeConfig;
use crate::command::Action;
use crate::config::{ConfigError, MachineConfig};
use crate::drive::inputs;
use crate::object::AxisSet;
use crate::parameter::{Change, Layer, MACHINE, Row, Value};

fn with_brake() -> MachineConfig {
    let mut cell = with_io();
    cell.axes[1].brake = Some(BrakeConfig { output: R, closes_with_one: false, release_ns: 0, engage_ns: 0 });
    cell
}

fn changes(of: &[(u16, &str, i64)]) -> Action {
    let change = |&(axis, key, value): &(u16, &str, i64)| {
        let (row, _) = Row::find(key).unwrap();
        Change { axis, row, value: Value::Int(value) }
    };
    Action::SetParameters(of.iter().map(change).collect())
}

/// Axes that share the output of O_AXMOVE: it is active while any of them has a motion command, with both signs.
///
/// Proves: MACS-IO-06
#[test]
fn axes_share_the_motion_output() {
    for (number, active) in [(1, 1), (-1, 0)] {
        let mut cell = with_io();
        (cell.axes[1].parameters.outputs.axmove, cell.axes[2].parameters.outputs.axmove) = (number, number);
        let mut rig = Rig::of(cell);
        rig.enable();
        assert_eq!(rig.int("p"), 1 - active);
        rig.give_all(vec![Action::Move(to(X, 1_000)), Action::Move(to(Y, 50_000))]);
        rig.run_until("x.state", 1);
        assert_eq!((rig.state("y"), rig.int("p")), ("DISCRETE_MOTION", active), "the other one still moves");
        rig.give(set(X, "o_axmove", 0));
        assert_eq!(rig.int("p"), active, "who leaves does not take it along");
        rig.give(set(X, "o_axmove", number));
        assert_eq!(rig.int("p"), active);
        rig.run_until("y.state", 1);
        assert_eq!(rig.int("p"), 1 - active);
    }
}

/// A brake that another function opens cannot hold: such a set is refused as a whole, in any order.
///
/// Proves: MACS-IO-04
#[test]
fn an_output_has_one_function() {
    let mut rig = Rig::of(with_brake());
    for (axis, key, number) in [(MACHINE, "o_error", 3), (X, "o_axmove", -3), (Y, "o_brake", 3), (Y, "o_axmove", 3)] {
        let sequence = rig.give(set(axis, key, number));
        let sentence = format!("{key} names output 3, which has another function already");
        assert!(rig.refusal(sequence).ends_with(&sentence), "{}", rig.refusal(sequence));
    }
    for (axis, key, number) in [(X, "o_brake", 2), (Y, "o_brake", 2), (Y, "o_axmove", 1)] {
        let sequence = rig.give(set(axis, key, number));
        assert!(rig.was_accepted(sequence), "{key} {number}: several axes may share a brake");
    }
    for (axis, key, number) in
        [(X, "o_axmove", 2), (Y, "o_brake", -2), (MACHINE, "o_error", -1), (MACHINE, "o_error", 2)]
    {
        let sequence = rig.give(set(axis, key, number));
        assert!(rig.refusal(sequence).contains("another function"), "{key} {number}");
    }
}

/// The refusal names the axis that requests an output that is in use, in any order of the axes.
#[test]
fn the_refusal_names_the_axis_that_was_set() {
    let mut rig = Rig::of(with_io());
    rig.give(set(Y, "o_axmove", 2));
    for (key, number) in [("o_brake", 2), ("o_axmove", -2)] {
        let sequence = rig.give(set(X, key, number));
        assert_eq!(rig.refusal(sequence), format!("x: {key} names output 2, which has another function already"));
    }
    rig.give(set(MACHINE, "o_error", 3));
    let sequence = rig.give(set(X, "o_axmove", 3));
    assert_eq!(rig.refusal(sequence), "x: o_axmove names output 3, which has another function already");
    let sequence = rig.give(set(MACHINE, "o_error", 2));
    assert_eq!(rig.refusal(sequence), "machine: o_error names output 2, which has another function already");
    // Several axes in one set: the last of them.
    let sequence = rig.give(changes(&[(X, "o_brake", 1), (Y, "o_axmove", 1)]));
    assert_eq!(rig.refusal(sequence), "y: o_axmove names output 1, which has another function already");
}

/// Saved and restored layers keep this rule, too.
#[test]
fn layers_give_an_output_one_function() {
    let mut rig = Rig::of(with_io());
    rig.give(set(X, "o_axmove", 2));
    rig.give(Action::SaveParameters(AxisSet::one(X)));
    rig.give(set(X, "o_axmove", 0));
    let taken = rig.give(set(Y, "o_brake", 2));
    assert!(rig.was_accepted(taken), "the output is free by now");
    let reset = rig.give(Action::ResetParameters { axes: AxisSet::one(X), layer: Layer::User });
    assert!(rig.refusal(reset).contains("x: o_axmove names output 2"), "{}", rig.refusal(reset));
    let saved = rig.give(Action::SaveParameters(AxisSet::one(Y)));
    assert!(rig.refusal(saved).contains("names output 2"), "{}", rig.refusal(saved));
    let both = rig.give(Action::SaveParameters([X, Y].into_iter().collect()));
    assert!(rig.was_accepted(both));
}

/// A cell that violates this rule is invalid.
#[test]
fn a_cell_gives_an_output_one_function() {
    let mut cell = with_brake();
    cell.global.parameters.o_error = -3;
    let said = |cell: &MachineConfig| cell.check().map_err(|error: ConfigError| error.to_string());
    assert_eq!(said(&cell), Err("machine: o_error names output 3, which has another function already".into()));
    cell.global.parameters.o_error = 1;
    assert_eq!(said(&cell), Ok(()));
    let mut saved = cell.axes[2].parameters;
    saved.outputs.axmove = 1;
    cell.axes[2].saved = Some(saved);
    assert_eq!(said(&cell), Err("machine: o_error names output 1, which has another function already".into()));
}

/// An output that changes its function shows the new one, at any level of the previous one, and a brake that an error
/// has closed is not opened by the previous function.
///
/// Proves: MACS-IO-04, MACS-IO-07
#[test]
fn an_output_that_changes_its_function_shows_the_new_one() {
    for (of, to) in [(-1, 1), (1, -1), (1, 1), (-1, -1)] {
        let mut cell = with_io();
        cell.axes[2].parameters.outputs.axmove = of;
        let mut rig = Rig::of(cell);
        rig.enable();
        rig.give(changes(&[(Y, "o_axmove", 0), (MACHINE, "o_error", to)]));
        assert_eq!(rig.int("p"), i64::from(to < 0), "there is no error: {of} {to}");
    }
    for (of, to) in [(-1, 1), (1, -1), (1, 1), (-1, -1)] {
        let mut cell = with_io();
        cell.axes[1].parameters.error_reaction = 3;
        cell.axes[2].parameters.outputs.axmove = of;
        let mut rig = Rig::of(cell);
        rig.enable();
        rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        rig.run(5);
        assert_eq!(rig.state("x"), "ERROR_STOP");
        rig.give(changes(&[(X, "o_brake", to), (Y, "o_axmove", 0)]));
        assert_eq!((rig.int("p"), rig.int("x.brake")), (i64::from(to > 0), 1), "{of} {to}");
    }
}

/// Functions that exchange their outputs in one set: each is shown on its new output.
///
/// Proves: MACS-IO-06, MACS-IO-07
#[test]
fn functions_change_places_in_one_set() {
    for (error, moves, shown) in [(1, 2, [0, 1]), (-1, 2, [1, 1]), (1, -2, [0, 0])] {
        let mut rig = Rig::of(with_io());
        rig.enable();
        rig.give(changes(&[(MACHINE, "o_error", error), (X, "o_axmove", moves)]));
        rig.give(Action::Move(to(X, 50_000)));
        assert_eq!([rig.int("p"), rig.int("q")], shown);
        let (error, moves) = (error * 2, moves / 2);
        let swapped = rig.give(changes(&[(MACHINE, "o_error", error), (X, "o_axmove", moves)]));
        assert!(rig.was_accepted(swapped));
        let level = |number: i64, active: bool| i64::from((number > 0) == active);
        assert_eq!([rig.int("p"), rig.int("q")], [level(moves, true), level(error, false)]);
        rig.plant.drive(1).unwrap().inject_fault(0x8611);
        rig.run(3);
        assert_eq!(rig.int("q"), level(error, true));
        rig.give(set(MACHINE, "o_error", 0));
        assert_eq!(rig.int("q"), level(error, false), "who leaves is inactive");
    }
}

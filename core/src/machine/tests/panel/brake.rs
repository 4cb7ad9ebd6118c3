//! A brake and a hanging load.

use super::super::rig::{Rig, X, at, parameters, to};
use super::{P, R, set, with_io};
use crate::axis::BrakeConfig;
use crate::command::Action;
use crate::config::MachineConfig;
use crate::drive::inputs;
use crate::object::AxisSet;
use crate::sim::{Fixtures, Mechanics, Model, SimBrake};

/// Returns a vertical axis: its load falls with 9.81 m/s^2 if nothing holds it. Its brake takes 40 ms to open and 30 ms
/// to close.
pub(super) fn vertical(release_ns: u64, engage_ns: u64, model: Model) -> Rig {
    vertical_of(with_io(), release_ns, engage_ns, model)
}

/// Returns the same in a given cell.
pub(super) fn vertical_of(mut cell: MachineConfig, release_ns: u64, engage_ns: u64, model: Model) -> Rig {
    cell.axes[1].brake = Some(BrakeConfig { output: R, closes_with_one: false, release_ns, engage_ns });
    let mut rig = Rig::with(cell, [model, Model::Ideal]);
    let brake = SimBrake { output: 2, closes_with_one: false, opens_ns: 40_000_000, closes_ns: 30_000_000 };
    let fixtures = Fixtures::default();
    rig.plant
        .attach_mechanics(0, &Mechanics { fixtures, load: -9_810_000.0, brake: Some(brake), ..Mechanics::default() });
    rig
}

/// The brake takes 50 ms to open; the axis is disabled again after 20 ms.
#[test]
fn an_axis_that_is_disabled_while_its_brake_opens_is_never_shown_as_enabled() {
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.run(20);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run_until("r", 1);
    rig.run(20);
    let disabled = rig.give(Action::Disable(AxisSet::one(X)));
    for _ in 0..60 {
        assert_eq!((rig.int("x.enabled"), rig.state("x")), (0, "DISABLED"));
        rig.run(1);
    }
    assert_eq!((rig.done(disabled).len(), rig.int("x.output.control"), rig.int("x.brake")), (1, 0, 1));
}

/// With delays that match its brake a hanging load does not move by one increment when the axis is switched on and off.
/// If its drive fails at rest, the load moves until the brake is closed, which no controller can shorten.
///
/// Proves: MACS-ERR-02
#[test]
fn a_hanging_load_does_not_drop() {
    for model in [Model::Ideal, Model::SecondOrder(crate::sim::SecondOrder::new(60.0, 0.8, 1_000_000).unwrap())] {
        let mut rig = vertical(50_000_000, 35_000_000, model);
        rig.run(20);
        for _ in 0..3 {
            assert_eq!((rig.int("x.brake"), rig.int("r"), rig.int("x.enabled")), (1, 0, 0));
            let enabled = rig.give(Action::Enable([X].into_iter().collect()));
            rig.run_until("r", 1);
            assert_eq!((rig.state("x"), rig.int("x.drive_state"), rig.int("x.brake")), ("DISABLED", 4, 0));
            let refused = rig.give(Action::Move(to(X, 1_000)));
            assert!(rig.refusal(refused).contains("not enabled"), "{}", rig.refusal(refused));
            assert_eq!(rig.run_until("x.state", 1), 49, "the cycle of the refusal is the first of 50");
            assert_eq!(rig.done(enabled).len(), 1);
            rig.run(100);
            assert_eq!(rig.int("x.actual.position"), 0);
            let moved = rig.give(Action::Move(to(X, 1_000)));
            rig.run(500);
            assert_eq!((rig.done(moved).len(), rig.int("x.actual.position")), (1, 1_000));
            rig.give(Action::Move(to(X, 0)));
            rig.run(500);
            let disabled = rig.give(Action::Disable([X].into_iter().collect()));
            assert_eq!(
                (rig.int("x.brake"), rig.int("r"), rig.int("x.output.control")),
                (1, 0, 0x0F),
                "first the brake"
            );
            assert_eq!(rig.run_until("x.state", 0), 35, "then the power");
            assert_eq!((rig.int("x.output.control"), rig.done(disabled).len()), (0, 1));
            rig.run(500);
            assert_eq!(rig.int("x.actual.position"), 0);
        }
    }
}

/// The same load without the delays drops. The test above would not detect a plant that never drops.
#[test]
fn without_delays_a_hanging_load_drops() {
    let mut rig = vertical(0, 0, Model::Ideal);
    rig.run(20);
    rig.give(Action::Enable([X].into_iter().collect()));
    rig.run(100);
    assert_eq!(rig.int("x.actual.position"), 0);
    rig.give(Action::Disable([X].into_iter().collect()));
    rig.run(200);
    // 30 ms of free fall: 9.81 m/s^2 * (30 ms)^2 / 2 = 4.41 mm, within the cycles of the brake and the drive.
    let dropped = -rig.int("x.actual.position");
    assert!((4_000..=5_100).contains(&dropped), "{dropped}");
}

/// Every removal of power closes the brake in the same cycle; a stop under power keeps it open.
///
/// Proves: MACS-ERR-02
#[test]
fn an_error_closes_the_brake_of_its_axis() {
    for (reaction, at_once, at_last) in [(0, 1, 1), (1, 1, 1), (2, 0, 0), (3, 0, 1), (4, 0, 1)] {
        let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
        rig.give(set(X, "error_reaction", reaction));
        rig.give(Action::Enable([X].into_iter().collect()));
        rig.run_until("x.state", 1);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(200);
        rig.plant.drive(0).unwrap().jump(-600_000);
        rig.run(1);
        assert_eq!((rig.state("x"), rig.int("x.brake")), ("ERROR_STOP", at_once), "reaction {reaction}");
        rig.run(500);
        assert_eq!(rig.int("x.brake"), at_last, "reaction {reaction}");
        let before = rig.int("x.actual.position");
        rig.run(100);
        assert_eq!(rig.int("x.actual.position"), before, "reaction {reaction}: it is held");
        rig.give(Action::ResetErrors(AxisSet::first(3)));
        rig.run(200);
        assert_eq!(rig.int("x.actual.position"), before, "reaction {reaction}: still");
    }
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.give(Action::Enable([X].into_iter().collect()));
    rig.run_until("x.state", 1);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(1);
    assert_eq!((rig.int("x.brake"), rig.int("r")), (1, 0), "in the cycle in which the fault is seen");
}

/// Commands while the brake opens or closes cause no motion, and the power is removed only after the brake is closed.
#[test]
fn commands_while_the_brake_moves() {
    let x = || [X].into_iter().collect::<AxisSet>();
    // Disabled again before the brake was open.
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.give(Action::Enable(x()));
    rig.run_until("r", 1);
    rig.run(45);
    rig.mirror();
    rig.give(Action::Disable(x()));
    rig.run(300);
    assert_eq!((rig.state("x"), rig.int("x.actual.position"), rig.int("x.brake")), ("DISABLED", 0, 1));
    // A quick stop in the meantime locks the axis permanently.
    rig.give(Action::Enable(x()));
    rig.run_until("r", 1);
    rig.give(Action::QuickStop(x()));
    rig.run(200);
    assert_eq!((rig.state("x"), rig.int("x.actual.position")), ("STOPPING", 0));
    rig.give(Action::ResetErrors(x()));
    rig.run(100);
    assert_eq!(rig.state("x"), "STANDSTILL");
    // An enable while the brake closes is refused: the axis is still stopping.
    rig.give(Action::Disable(x()));
    rig.run(5);
    let refused = rig.give(Action::Enable(x()));
    assert_eq!(rig.refusal(refused), "x: the axis is not at rest; wait until it stands");
    rig.run(100);
    assert_eq!((rig.state("x"), rig.int("x.actual.position")), ("DISABLED", 0));
    // Deactivated and switched off, the axis waits for the brake.
    rig.give(Action::Enable(x()));
    rig.run_until("x.state", 1);
    rig.give(Action::Deactivate);
    rig.run(2);
    assert_eq!((rig.int("x.brake"), rig.int("x.output.control")), (1, 0x0F));
    rig.run(100);
    assert_eq!((rig.int("x.output.control"), rig.int("x.actual.position")), (0, 0));
}

/// A brake on an output that has another function makes the configuration invalid.
#[test]
fn a_brake_has_its_output_alone() {
    let brake = |output| Some(BrakeConfig { output, closes_with_one: false, release_ns: 0, engage_ns: 0 });
    let mut cell = with_io();
    (cell.axes[1].brake, cell.axes[2].brake) = (brake(R), brake(R));
    assert_eq!(
        cell.check().unwrap_err().to_string(),
        "x: brake is wired to entry 5 of io, which something else switches"
    );
    cell.axes[2].brake = brake(0);
    assert_eq!(cell.check().unwrap_err().to_string(), "y: brake is wired to entry 0 of io, which is no do");
    assert_eq!(parameters().outputs.brake, 0);
}

/// i_break has closed the brake (error_reaction 3): after disable, reset and enable it is open.
#[test]
fn a_brake_that_i_break_has_closed_opens_with_the_next_enable() {
    let x = || [X].into_iter().collect::<AxisSet>();
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.give(set(X, "error_reaction", 3));
    rig.give(set(crate::parameter::MACHINE, "i_break", 1));
    rig.give(Action::Enable(x()));
    rig.run_until("x.state", 1);
    rig.plant.set_digital(0, true);
    rig.run(5);
    assert_eq!((rig.state("x"), rig.int("x.brake")), ("STOPPING", 1));
    rig.give(Action::Disable(x()));
    rig.run(100);
    let refused = rig.give(Action::Enable(x()));
    assert_eq!(rig.refusal(refused), "x: i_break has stopped the axis; i_continue or reset_errors lets it go on");
    assert_eq!((rig.state("x"), rig.int("x.enabled")), ("STOPPING", 0));
    rig.give(Action::ResetErrors(x()));
    assert_eq!(rig.state("x"), "DISABLED");
    rig.give(Action::Enable(x()));
    rig.run_until("x.state", 1);
    assert_eq!(rig.int("x.brake"), 0);
    rig.give(Action::Move(to(X, 1_000)));
    rig.run(500);
    assert_eq!(rig.int("x.actual.position"), 1_000);
}

/// An error with error_reaction 4 while the brake opens: the drive stops by itself, as at any other time.
#[test]
fn an_error_while_the_brake_opens_reacts_as_at_any_time() {
    let x = || [X].into_iter().collect::<AxisSet>();
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.give(set(X, "error_reaction", 4));
    rig.give(Action::Enable(x()));
    rig.run_until("r", 1);
    assert_eq!(rig.int("x.output.control"), 0x0F);
    rig.plant.drive(0).unwrap().jump(100_000);
    rig.run(3);
    assert_eq!((rig.state("x"), rig.int("x.output.control")), ("ERROR_STOP", 2), "the quick stop of the drive");
}

/// An error of another axis that removes the power closes the brake in its cycle, too.
#[test]
fn the_error_of_another_axis_closes_the_brake_in_its_cycle() {
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.give(set(X, "error_reaction", 0));
    rig.give(set(crate::machine::tests::rig::Y, "following_error_stops_all", 1));
    rig.give(Action::Enable(AxisSet::first(3)));
    rig.run_until("x.state", 1);
    rig.plant.drive(1).unwrap().jump(100_000);
    rig.run_until("x.state", 7);
    assert_eq!((rig.int("x.output.control"), rig.int("x.brake"), rig.int("r")), (0, 1, 0));
}

/// Returns a rig with x at 50 mm/s, with O_BRAKE -1 at an output that reads 1.
fn rolling(errcond: i64) -> Rig {
    let mut cell = with_io();
    cell.axes[1].parameters.outputs.brake = -1;
    cell.axes[1].parameters.error_reaction = errcond;
    let mut rig = Rig::of(cell);
    rig.give(Action::set_output(P, 1.0));
    rig.enable();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(1_000);
    rig
}

/// O_BRAKE -1: with ERRCOND 1 output 1 is low at once, with 3 after the stop, with 0 it is unchanged.
///
/// Proves: MACS-O-73, MACS-ERR-02, MACS-IO-04
#[test]
fn o_brake_goes_low_by_errcond() {
    for (errcond, at_once, before_rest, at_rest) in [(1, 0, 0, 0), (3, 1, 1, 0), (0, 1, 1, 1)] {
        let mut rig = rolling(errcond);
        rig.plant.drive(0).unwrap().jump(5_000);
        let mut seen = Vec::new();
        // 50 mm/s with 1 m/s^2: it stands after 50 ms.
        for cycles in [1, 48, 4] {
            rig.run(cycles);
            seen.push(rig.int("p"));
        }
        assert_eq!((rig.int("x.error"), seen), (10_201, vec![at_once, before_rest, at_rest]), "{errcond}");
    }
}

/// An error that prevents a controlled stop is an error like any other: with ERRCOND 1 and 3 O_BRAKE is active in its
/// cycle, also if the reaction would close the brake only at rest.
///
/// Proves: MACS-IO-04
#[test]
fn o_brake_closes_with_an_error_that_takes_the_power() {
    for errcond in 0..6 {
        for (lost, stops) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut rig = rolling(errcond);
            let drive = rig.plant.drive(0).unwrap();
            if stops {
                drive.set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
                rig.run(10);
            }
            assert_eq!(rig.int("p"), if stops && errcond == 1 { 0 } else { 1 });
            let drive = rig.plant.drive(0).unwrap();
            if lost {
                drive.disconnect();
            } else {
                drive.inject_fault(0x8611);
            }
            rig.run(1);
            let open = i64::from(!matches!(errcond, 1 | 3));
            assert_eq!((rig.state("x"), rig.int("p")), ("ERROR_STOP", open), "{errcond} {lost} {stops}");
            rig.run(200);
            assert_eq!(rig.int("p"), open, "{errcond} {lost} {stops}");
        }
    }
}

/// A brake that an abort has closed and a program has opened closes with the next error.
///
/// Proves: MACS-IO-04
#[test]
fn o_brake_closes_anew_with_an_error_after_an_abort() {
    for (errcond, closed) in [(1, 0), (2, 1), (3, 0)] {
        let mut cell = with_io();
        cell.axes[1].parameters.outputs.brake = -1;
        cell.axes[1].parameters.error_reaction = errcond;
        let mut rig = Rig::of(cell);
        rig.enable();
        rig.give(Action::Abort);
        rig.run(10);
        assert_eq!((rig.state("x"), rig.int("p")), ("STOPPING", 0));
        rig.give(Action::set_output(P, 1.0));
        rig.run(10);
        assert_eq!(rig.int("p"), 1);
        rig.plant.drive(0).unwrap().inject_fault(0x8611);
        rig.run(1);
        assert_eq!((rig.state("x"), rig.int("p")), ("ERROR_STOP", closed), "{errcond}");
    }
}

/// An error while an abort stops the axis does not change the brake of the abort.
///
/// Proves: MACS-ERR-09
#[test]
fn an_error_in_an_abort_leaves_it_its_brake() {
    for errcond in 0..4 {
        for fails in [false, true] {
            let mut rig = rolling(errcond);
            rig.give(Action::Abort);
            rig.run(10);
            let drive = rig.plant.drive(0).unwrap();
            if fails {
                drive.inject_fault(0x8611);
            } else {
                drive.jump(5_000);
            }
            rig.run(1);
            assert_eq!((rig.state("x"), rig.int("p")), ("ERROR_STOP", i64::from(!fails && errcond > 1)), "{errcond}");
            rig.run(60);
            assert_eq!(rig.int("p"), 0, "{errcond} {fails}");
        }
    }
}

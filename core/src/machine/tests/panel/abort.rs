//! Abort, the Esc of MACS.

use super::super::rig::{LINE, Rig, X, at, to};
use super::{P, Q, R, ready, set, with_io};
use crate::axis::BrakeConfig;
use crate::code::Code;
use crate::command::Action;
use crate::object::AxisSet;

fn put(rig: &mut Rig, index: u16, value: f64) {
    let set = rig.give(Action::set_output(index, value));
    assert!(rig.was_accepted(set));
}

/// The brake is output p, closed by 0; q and speed are free, r shows a motion command.
fn braked(esccond: i64) -> Rig {
    let mut cell = with_io();
    cell.axes[1].parameters.outputs.brake = -1;
    cell.axes[1].parameters.outputs.axmove = 3;
    cell.axes[2].parameters.supervision.esccond = esccond;
    let mut rig = ready(cell);
    put(&mut rig, P, 1.0);
    put(&mut rig, 7, 3.5);
    rig
}

fn outputs(rig: &Rig) -> [i64; 3] {
    ["p", "q", "r"].map(|name| rig.int(name))
}

/// All values: the axes stop with the maximum deceleration, the brake closes, the virtual master stops. 0 leaves the
/// outputs unchanged, 1 and 2 set all outputs except that of the brake.
///
/// Proves: MACS-ERR-09, MACS-PROF-13
#[test]
fn an_abort_stops_all_and_sets_the_outputs() {
    for q in [0, 1] {
        // r: its function shows the end of the motion command, then 1 and 2 set all outputs.
        for (esccond, at_once, volts) in [(0, [1, q, 0], 3.5), (1, [1, 0, 0], 0.0), (2, [1, 1, 1], 3.5)] {
            let mut rig = braked(esccond);
            put(&mut rig, Q, q as f64);
            let goals = [rig.give(Action::Move(at(X, 50_000.0))), rig.give(Action::Move(at(LINE, -20_000.0)))];
            rig.run(1_000);
            assert_eq!(outputs(&rig), [1, q, 1], "the brake is open, x moves");
            rig.mirror();
            let abort = rig.give(Action::Abort);
            assert!(rig.was_accepted(abort));
            assert_eq!(["line", "x", "y"].map(|axis| rig.state(axis)), ["STOPPING"; 3]);
            for goal in goals {
                assert_eq!(rig.done(goal).iter().map(|done| done.code.0).collect::<Vec<_>>(), [10_228]);
            }
            assert_eq!((outputs(&rig), rig.real("speed")), (at_once, volts), "esccond {esccond}");
            // 50 mm/s with 1 m/s^2: at most 50 ms; the brake closes at rest.
            rig.run(49);
            assert!(rig.real("x.command.velocity") > 0.0 && rig.int("x.brake") == 0);
            // The axis is one cycle behind its command.
            rig.run(3);
            assert_eq!((rig.real("x.command.velocity"), rig.real("line.command.velocity")), (0.0, 0.0));
            assert_eq!((outputs(&rig), rig.int("x.brake")), ([0, at_once[1], at_once[2]], 1), "esccond {esccond}");
            assert_eq!((rig.done(abort).len(), rig.int("x.enabled")), (3, 1));
            let refused = rig.give(Action::Move(to(X, 0)));
            assert_eq!(rig.refusal(refused), "x: abort has stopped the axis; reset_errors lets it go on");
            rig.give(Action::ResetErrors(AxisSet::first(3)));
            rig.run(3);
            assert_eq!(["line", "x", "y"].map(|axis| rig.state(axis)), ["STANDSTILL"; 3]);
            assert_eq!(rig.int("p"), 0, "a program opens the brake");
            put(&mut rig, P, 1.0);
            let again = rig.give(Action::Move(to(X, 0)));
            assert!(rig.was_accepted(again));
        }
    }
}

/// The largest ESCCOND of all axes applies.
#[test]
fn the_largest_of_all_axes_decides() {
    for (x, y, q) in [(0, 1, 0), (1, 0, 0), (1, 2, 1), (2, 1, 1)] {
        let mut rig = braked(y);
        rig.give(set(X, "esccond", x));
        put(&mut rig, Q, 1.0 - q as f64);
        rig.give(Action::Abort);
        assert_eq!(rig.int("q"), q, "{x}, {y}");
    }
}

/// With any error reaction, and also when the axis is off: every abort closes a brake that was opened manually, and
/// enable starts again.
///
/// Proves: MACS-ERR-09, MACS-IO-04, MACS-IO-05
#[test]
fn every_abort_closes_the_brake() {
    for errcond in 0..6 {
        let mut rig = braked(0);
        rig.give(set(X, "errcond", errcond));
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(100);
        rig.plant.drive(0).unwrap().jump(5_000);
        rig.run(1);
        assert_eq!(rig.int("x.error"), i64::from(Code::FOLLOWING_ERROR.0));
        rig.run(200);
        for _ in 0..2 {
            put(&mut rig, P, 1.0);
            rig.give(Action::Abort);
            rig.run(60);
            assert_eq!((rig.int("p"), rig.int("x.brake")), (0, 1), "{errcond}");
            assert_eq!((rig.int("x.error"), rig.real("x.command.velocity")), (10_201, 0.0), "the error stays");
        }
        rig.give(Action::ResetErrors(AxisSet::first(3)));
        rig.run(50);
        rig.give(Action::Disable(AxisSet::one(X)));
        rig.run(5);
        assert_eq!(rig.state("x"), "DISABLED");
        for _ in 0..2 {
            put(&mut rig, P, 1.0);
            rig.give(Action::Abort);
            assert_eq!((rig.int("p"), rig.state("x")), (0, "STOPPING"), "{errcond}");
        }
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        let enable = rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(50);
        assert_eq!((rig.done(enable)[0].code, rig.state("x"), rig.int("p")), (Code::NONE, "STANDSTILL", 0));
    }
}

/// The brake of the cell closes once the axis is at rest, under power; reset_errors opens it in its time. No ESCCOND
/// sets it.
///
/// Proves: MACS-ERR-09
#[test]
fn the_brake_of_the_cell_closes_too() {
    for (esccond, closes_with_one) in [(1, true), (2, false), (0, true)] {
        let mut cell = with_io();
        cell.axes[1].brake = Some(BrakeConfig { output: R, closes_with_one, release_ns: 20_000_000, engage_ns: 0 });
        cell.axes[1].parameters.supervision.esccond = esccond;
        let mut rig = Rig::of(cell);
        rig.enable();
        let (open, closed) = (i64::from(!closes_with_one), i64::from(closes_with_one));
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(100);
        rig.mirror();
        rig.give(Action::Abort);
        rig.run(49);
        assert_eq!((rig.int("r"), rig.int("x.brake")), (open, 0), "it still moves");
        rig.run(3);
        assert_eq!((rig.int("r"), rig.int("x.brake"), rig.int("x.output.control")), (closed, 1, 0x0F));
        let reset = rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(10);
        assert_eq!((rig.int("r"), rig.state("x")), (open, "DISABLED"), "it opens");
        assert!(rig.done(reset).is_empty(), "not before it takes goals");
        rig.run(15);
        assert_eq!((rig.state("x"), rig.done(reset).len(), rig.done(reset)[0].code), ("STANDSTILL", 1, Code::NONE));
    }
}

/// An axis that is being enabled is not switched on; a quick stop after an abort and a disable after it have their own
/// effects.
#[test]
fn an_abort_among_other_stops() {
    let mut rig = Rig::of(with_io());
    rig.run(3);
    let enable = rig.give_all(vec![Action::Enable(AxisSet::one(X)), Action::Abort]) - 1;
    rig.run(50);
    assert_eq!((rig.state("x"), rig.int("x.enabled")), ("STOPPING", 0));
    assert_eq!(rig.done(enable)[0].code, Code::ABORTED);
    rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.enable();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(100);
    rig.give(Action::Abort);
    rig.give(Action::QuickStop(AxisSet::one(X)));
    rig.run(100);
    let refused = rig.give(Action::Move(to(X, 0)));
    assert_eq!(rig.refusal(refused), "x: quick_stop has locked the axis; reset_errors first");
    rig.give(Action::Abort);
    let disable = rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(10);
    assert_eq!((rig.done(disable).len(), rig.state("x"), rig.int("x.enabled")), (1, "STOPPING", 0));
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.enable();
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// An error in the cycle of the abort is shown, although the abort sets all outputs to 0.
///
/// Proves: MACS-IO-07
#[test]
fn an_error_in_the_cycle_of_an_abort_shows() {
    let mut cell = with_io();
    cell.global.parameters.o_error = 2;
    cell.axes[1].parameters.supervision.esccond = 1;
    let mut rig = ready(cell);
    put(&mut rig, R, 1.0);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.give(Action::Abort);
    assert_eq!((rig.state("x"), rig.int("q"), rig.int("r")), ("ERROR_STOP", 1, 0));
    rig.run(10);
    assert_eq!(rig.int("q"), 1);
}

//! Reference travel in open loop: events that switch the speed off, in any phase, and the signals after that.

use super::super::rig::{Rig, X};
use super::vocabularies::{START, jog, wf};
use super::{assign, zero};
use crate::command::Action;
use crate::drive::Interface;
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::vocabulary::Order;
use crate::vocabulary::wf::{Jog, Mode, Request};

/// Numbers of `x.wf.state`.
const IDLE: i64 = 0;
const RUN: i64 = 1;
const SETTLE: i64 = 5;

/// Returns a rig whose cam is from 5000 to 7000; with md7 2 the axis reverses on it.
fn open(md7: i64) -> Rig {
    wf(START, |cell| {
        let axis = &mut cell.axes[usize::from(X)];
        axis.interface = Interface::OpenLoop;
        assign(&mut axis.parameters, "wf.md7", Value::Int(md7));
    })
}

/// Returns a rig in this phase of homing.
fn under_way(md7: i64, phase: i64) -> Rig {
    let mut rig = open(md7);
    jog(&mut rig, Jog::Plus);
    rig.run_until("x.homing.phase", phase);
    // In a reversing phase it soon leaves the cam.
    rig.run(2);
    assert_eq!((rig.int("x.homing.phase"), rig.int("x.wf.q"), rig.int("x.wf.state")), (phase, 1, RUN));
    assert!(rig.real("x.output.velocity") != 0.0 && rig.real("x.wf.dac") != 0.0);
    rig
}

/// Checks that there is no speed, output, voltage, direction or enable.
fn assert_off(rig: &Rig, what: &str) {
    assert_eq!(
        (rig.real("x.output.velocity"), rig.real("x.wf.speed"), rig.real("x.wf.dac")),
        (0.0, 0.0, 0.0),
        "{what}"
    );
    let bits = ["x.wf.q", "x.wf.f", "x.wf.b", "x.wf.g", "x.wf.enable", "x.wf.fe"];
    assert_eq!(bits.map(|name| rig.int(name)), [0; 6], "{what}");
}

fn ask(change: impl FnOnce(&mut Request)) -> Action {
    let mut request = Request { axis: X, ..Request::default() };
    change(&mut request);
    Action::vocabulary(request)
}

/// Returns every verb that removes the enable, in all combinations.
fn commands_that_remove_the_enable() -> Vec<(&'static str, Action)> {
    vec![
        ("enable", ask(|request| request.enable = Some(false))),
        ("reset", ask(|request| request.reset = true)),
        ("no jog", ask(|request| (request.enable, request.jog) = (Some(false), Some(Jog::None)))),
        ("same jog", ask(|request| (request.enable, request.jog) = (Some(false), Some(Jog::Plus)))),
        ("other jog", ask(|request| (request.enable, request.jog) = (Some(false), Some(Jog::Minus)))),
        ("cam", ask(|request| (request.enable, request.cam) = (Some(false), Some(true)))),
        ("fixed speed", ask(|request| (request.enable, request.fixed_speed) = (Some(false), Some(2)))),
        ("mode", ask(|request| (request.enable, request.mode) = (Some(false), Some(Mode::Mdi)))),
    ]
}

/// Proves: WF-IF-03, WF-OST-10, WF-OLC-09, WF-DAC-01, WF-IF-10
#[test]
fn removing_the_enable_switches_speed_off_in_every_phase() {
    for (md7, phase) in [(0, 1), (0, 2), (0, 3), (2, 2), (2, 3)] {
        for (what, action) in commands_that_remove_the_enable() {
            let mut rig = under_way(md7, phase);
            let sequence = rig.give(action);
            assert!(rig.was_accepted(sequence), "{what} in phase {phase}");
            let what = format!("{what} in phase {phase}, md7 {md7}");
            for _ in 0..300 {
                assert_off(&rig, &what);
                assert_eq!((rig.int("x.wf.state"), rig.int("x.homing.phase")), (IDLE, 0), "{what}");
                rig.run(1);
            }
            assert_eq!((rig.state("x"), rig.int("x.homed"), rig.int("x.error")), ("STANDSTILL", 0, 0), "{what}");
        }
    }
}

/// With any other command in its cycle.
///
/// Proves: WF-OST-10
#[test]
fn the_enable_is_taken_beside_another_stop() {
    for other in [
        Action::QuickStop(AxisSet::one(X)),
        Action::Halt(AxisSet::one(X)),
        Action::Disable(AxisSet::one(X)),
        Action::Abort,
    ] {
        let mut rig = under_way(0, 1);
        let sequence = rig.give_all(vec![other, ask(|request| request.enable = Some(false))]);
        assert!(rig.was_accepted(sequence));
        assert_off(&rig, "beside another stop");
        let sequence = rig.give(ask(|request| (request.enable, request.jog) = (Some(true), Some(Jog::None))));
        assert!(rig.was_accepted(sequence));
        rig.run(100);
        assert_off(&rig, "later");
    }
}

/// Proves: WF-REF-12, WF-OLC-09, WF-DAC-01, WF-IF-10
#[test]
fn released_everything_is_off_in_that_cycle() {
    for (md7, phase) in [(0, 1), (0, 2), (0, 3), (2, 3)] {
        let mut rig = under_way(md7, phase);
        jog(&mut rig, Jog::None);
        assert_eq!((rig.int("x.wf.state"), rig.state("x")), (IDLE, "DISCRETE_MOTION"), "it coasts");
        for _ in 0..300 {
            assert_off(&rig, "released");
            rig.run(1);
        }
        assert_eq!((rig.state("x"), rig.int("x.homed")), ("STANDSTILL", 0));
    }
}

/// While the axis coasts from the mark all outputs are off, and neither JOG nor the enable removes the zero.
///
/// Proves: WF-REF-02, WF-REF-09, WF-OLC-09, WF-DAC-01, WF-IF-10
#[test]
fn at_the_mark_everything_is_off_and_the_zero_is_found() {
    let jog_none = || ask(|request| request.jog = Some(Jog::None));
    let mut actions = vec![("nothing", None), ("released", Some(jog_none()))];
    actions.push(("again", Some(ask(|request| request.jog = Some(Jog::Plus)))));
    let taking = commands_that_remove_the_enable().into_iter().filter(|(what, _)| *what != "mode");
    actions.extend(taking.map(|(what, action)| (what, Some(action))));
    for (what, action) in actions {
        for (md7, mark) in [(0, 8_300), (2, 4_300)] {
            let mut rig = open(md7);
            jog(&mut rig, Jog::Plus);
            rig.run_until("x.homing.phase", 3);
            let before = loop {
                let dac = rig.real("x.wf.dac");
                rig.run(1);
                if rig.real("x.output.velocity") == 0.0 {
                    break dac;
                }
            };
            assert_eq!(before, if md7 == 2 { -0.1 } else { 0.1 }, "creep");
            assert_eq!((rig.int("x.wf.state"), rig.state("x")), (SETTLE, "HOMING"));
            assert_off(&rig, what);
            if let Some(action) = &action {
                let sequence = rig.give(action.clone());
                assert!(rig.was_accepted(sequence), "{what}");
            }
            while rig.state("x") == "HOMING" {
                assert_off(&rig, what);
                rig.run(1);
            }
            rig.run(1);
            assert_off(&rig, what);
            assert_eq!(
                (rig.int("x.homed"), rig.int("x.wf.synchronized"), rig.int("x.wf.state")),
                (1, 1, IDLE),
                "{what}"
            );
            assert_eq!(zero(&rig, START), mark - 50_000, "{what}");
        }
    }
}

/// A stop of another vocabulary ends the travel permanently: no edge and no mark continues it.
#[test]
fn a_stop_on_the_actual_position_ends_it() {
    let mut rig = under_way(0, 1);
    rig.order(X, Order::HoldActualPosition).unwrap();
    for _ in 0..500 {
        rig.run(1);
        assert_off(&rig, "stopped");
    }
    assert_eq!((rig.state("x"), rig.int("x.homed"), rig.int("x.homing.phase")), ("STANDSTILL", 0, 0));
}

/// Closed loop: removing the enable during a quick stop keeps the deceleration of the quick stop, with any MD2.
///
/// Proves: WF-IF-03
#[test]
fn the_ramp_of_the_enable_does_not_soften_a_quick_stop() {
    let mut rig = wf(START, |cell| {
        assign(&mut cell.axes[usize::from(X)].parameters, "wf.md2", Value::Real(10_000.0));
    });
    jog(&mut rig, Jog::Plus);
    rig.run(200);
    assert_eq!(rig.real("x.command.velocity"), 10_000.0);
    rig.give_all(vec![Action::QuickStop(AxisSet::one(X)), ask(|request| request.enable = Some(false))]);
    // 10000 inc/s with max_deceleration 1e6 inc/s^2 take 10 ms, with MD2 1 s.
    rig.run(12);
    assert_eq!((rig.real("x.command.velocity"), rig.state("x")), (0.0, "STOPPING"));
}

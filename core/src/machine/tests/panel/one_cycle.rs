//! A locking stop and a command that would release the axis, in one cycle: the stop takes precedence, in any order.

use super::super::rig::{LINE, Rig, X, Y, at, saia_verb, to};
use super::brake::vertical_of;
use super::{set, with_io};
use crate::code::Code;
use crate::command::{Action, Command, Commands, Source};
use crate::config::MachineConfig;
use crate::object::AxisSet;
use crate::sim::Model;
use crate::vocabulary::{saia, wf};

fn x() -> AxisSet {
    AxisSet::one(X)
}

/// Returns a cell in which inputs a, b and c are I_BREAK, I_CONTINUE and I_ERRCLR.
fn with_inputs() -> MachineConfig {
    let mut cell = with_io();
    let p = &mut cell.global.parameters;
    (p.i_break, p.i_continue, p.i_errclr) = (1, 2, 3);
    cell
}

/// Stop that locks an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stop {
    Quick,
    Abort,
    Break,
}

const STOPS: [Stop; 3] = [Stop::Quick, Stop::Abort, Stop::Break];

impl Stop {
    fn code(self) -> Code {
        match self {
            Self::Quick => Code::QUICK_STOP,
            Self::Abort => Code::ABORTED,
            Self::Break => Code::INTERRUPTED,
        }
    }

    /// Returns the state of an axis without power after this stop.
    fn leaves(self) -> &'static str {
        if self == Self::Break { "DISABLED" } else { "STOPPING" }
    }

    /// Gives the stop in one cycle with other commands: first or last. Returns the sequence number of the first of the
    /// others.
    fn give(self, rig: &mut Rig, first: bool, others: &[Action]) -> u64 {
        let mut actions = others.to_vec();
        let stop = match self {
            Self::Quick => Some(Action::QuickStop(x())),
            Self::Abort => Some(Action::Abort),
            Self::Break => None,
        };
        let behind = u64::from(first && stop.is_some());
        if let Some(stop) = stop {
            actions.insert(if first { 0 } else { actions.len() }, stop);
        } else {
            rig.plant.set_digital(0, true);
        }
        let count = actions.len() as u64;
        rig.give_all(actions) + 1 - count + behind
    }
}

fn codes(rig: &Rig, sequence: u64) -> Vec<Code> {
    rig.done(sequence).iter().map(|done| done.code).collect()
}

/// Returns the message for a command after this stop.
fn locked(stop: Stop) -> &'static str {
    match stop {
        Stop::Quick => "x: quick_stop has locked the axis; reset_errors first",
        Stop::Abort | Stop::Break => "x: abort has stopped the axis; reset_errors lets it go on",
    }
}

/// In every cycle from that of the enable to the one before the axis is on: the drive is switched off again at once,
/// and except for I_BREAK it remains off until a reset. The enable ends with the reason; another axis of the same
/// command is switched on.
#[test]
fn a_stop_ends_an_enable_under_way() {
    let both = || Action::Enable([X, Y].into_iter().collect());
    let mut rig = Rig::of(with_inputs());
    rig.run(3);
    rig.give(both());
    let needs = rig.run_until("x.state", 1);
    assert!(needs > 2, "{needs}");
    for stop in STOPS {
        for after in 0..needs {
            let mut rig = Rig::of(with_inputs());
            rig.run(3);
            let enabled = if after == 0 {
                stop.give(&mut rig, false, &[both()])
            } else {
                let enabled = rig.give(both());
                rig.run(after - 1);
                assert_eq!((rig.state("x"), rig.int("x.output.control") != 0), ("DISABLED", true));
                rig.mirror();
                stop.give(&mut rig, true, &[]);
                enabled
            };
            assert_eq!((rig.int("x.output.control"), rig.state("x")), (0, stop.leaves()), "{stop:?} after {after}");
            assert_eq!(codes(&rig, enabled)[0], stop.code(), "{stop:?} after {after}");
            rig.run(100);
            let y = if stop == Stop::Quick { "STANDSTILL" } else { stop.leaves() };
            assert_eq!((rig.state("x"), rig.int("x.drive_state"), rig.state("y")), (stop.leaves(), 1, y), "{stop:?}");
            assert_eq!(rig.done(enabled).len(), 2);
            rig.give(Action::ResetErrors([X, Y].into_iter().collect()));
            let again = rig.give(both());
            rig.run(40);
            assert_eq!((rig.state("x"), codes(&rig, again)), ("STANDSTILL", vec![Code::NONE; 2]), "{stop:?}");
        }
    }
}

/// Commands of one cycle are handled in the order of their lanes, not in the order of the clients: an enable after the
/// stop is refused, one before the stop of an input is ended, and the brake of an abort remains closed.
#[test]
fn an_enable_in_the_cycle_of_a_stop_does_not_come_on() {
    for stop in STOPS {
        let mut cell = with_inputs();
        cell.axes[usize::from(X)].parameters.outputs.brake = 1;
        let mut rig = Rig::of(cell);
        rig.run(3);
        let enabled = stop.give(&mut rig, true, &[Action::Enable(x())]);
        rig.run(60);
        assert_eq!((rig.state("x"), rig.int("x.output.control")), (stop.leaves(), 0), "{stop:?}");
        match stop {
            Stop::Break => assert_eq!(codes(&rig, enabled), [stop.code()]),
            _ => assert_eq!(rig.refusal(enabled), locked(stop)),
        }
        assert_eq!(rig.int("p"), i64::from(stop == Stop::Abort), "{stop:?}");
    }
    // An axis that is already on, and a virtual axis, are locked.
    for stop in [Stop::Quick, Stop::Abort] {
        for first in [false, true] {
            let mut rig = Rig::of(with_inputs());
            rig.enable();
            let enabled = stop.give(&mut rig, first, &[Action::Enable(x())]);
            rig.run(10);
            assert_eq!((rig.state("x"), codes(&rig, enabled)), ("STOPPING", vec![stop.code()]), "{stop:?} {first}");
            let later = rig.give(Action::Enable(x()));
            assert_eq!((rig.state("x"), codes(&rig, later)), ("STOPPING", vec![Code::NONE]), "it has its power");
        }
    }
    let mut rig = Rig::of(with_inputs());
    let line = AxisSet::one(LINE);
    rig.give_all(vec![Action::Enable(line), Action::QuickStop(line)]);
    assert_eq!((rig.state("line"), codes(&rig, 1)), ("STOPPING", vec![Code::QUICK_STOP]));
}

/// While the brake opens the drive already holds the load: the axis keeps its power and is locked. It is never reported
/// as enabled, and moves only after a reset.
#[test]
fn a_stop_while_the_brake_opens_locks_the_axis() {
    for stop in STOPS {
        for wait in [0, 20, 48] {
            let mut rig = vertical_of(with_inputs(), 50_000_000, 35_000_000, Model::Ideal);
            rig.run(3);
            let enabled = rig.give(Action::Enable(x()));
            rig.run_until("r", 1);
            rig.run(wait);
            rig.mirror();
            stop.give(&mut rig, true, &[]);
            assert_eq!((rig.state("x"), codes(&rig, enabled)), ("STOPPING", vec![stop.code()]), "{stop:?} {wait}");
            rig.run(200);
            assert_eq!((rig.state("x"), rig.int("x.actual.position"), rig.done(enabled).len()), ("STOPPING", 0, 1));
            assert_eq!(rig.int("x.output.control"), 0x0F);
            let reset = rig.give(Action::ResetErrors(x()));
            rig.run(60);
            assert_eq!((rig.state("x"), codes(&rig, reset)), ("STANDSTILL", vec![Code::NONE]), "{stop:?} {wait}");
            assert_eq!(rig.int("x.actual.position"), 0);
        }
        // Before the drive holds the load the brake is closed, and remains closed.
        let mut rig = vertical_of(with_inputs(), 50_000_000, 35_000_000, Model::Ideal);
        rig.run(3);
        rig.give(Action::Enable(x()));
        stop.give(&mut rig, true, &[]);
        for _ in 0..200 {
            rig.run(1);
            assert_eq!((rig.int("r"), rig.int("x.output.control"), rig.int("x.actual.position")), (0, 0, 0));
        }
    }
}

/// FStart switches the axis on and waits for that: a stop ends both, and the next enable moves nothing. A start after
/// the stop in its cycle is refused.
#[test]
fn a_stop_ends_a_start_that_switches_on() {
    use saia::Command::{Initialise, LoadAcceleration, LoadDestination, LoadVelocity, Start};
    let start = || saia_verb(&[LoadAcceleration, LoadVelocity, LoadDestination, Start]);
    for stop in STOPS {
        for after in 0..4 {
            let mut rig = Rig::of(with_inputs());
            rig.run(3);
            rig.give(saia_verb(&[Initialise]));
            rig.run(2);
            if after == 0 {
                stop.give(&mut rig, false, &[start()]);
            } else {
                rig.give(start());
                rig.run(after - 1);
                stop.give(&mut rig, true, &[]);
            }
            rig.run(50);
            assert_eq!((rig.state("x"), rig.int("x.output.control")), (stop.leaves(), 0), "{stop:?} after {after}");
            rig.give(Action::ResetErrors(AxisSet::first(3)));
            rig.enable();
            rig.run(500);
            assert_eq!((rig.state("x"), rig.int("x.actual.position")), ("STANDSTILL", 0), "{stop:?} after {after}");
        }
    }
    let mut rig = Rig::of(with_inputs());
    rig.run(3);
    rig.give(saia_verb(&[Initialise]));
    rig.run(2);
    let started = Stop::Quick.give(&mut rig, true, &[start()]);
    assert_eq!(rig.refusal(started), "x: quick_stop has stopped the axis");
    rig.run(100);
    assert_eq!((rig.state("x"), rig.int("x.output.control")), ("STOPPING", 0));
}

/// State of the axis before the stop.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Before {
    Stands,
    Moves,
    Locked,
    Failed,
}

const BEFORE: [Before; 4] = [Before::Stands, Before::Moves, Before::Locked, Before::Failed];

fn prepared(before: Before) -> Rig {
    let mut rig = Rig::of(with_inputs());
    rig.give(set(X, "error_reaction", 2));
    rig.enable();
    match before {
        Before::Stands => {}
        Before::Moves => {
            rig.give(Action::Move(at(X, 50_000.0)));
            rig.run(150);
        }
        Before::Locked => {
            rig.give(Action::QuickStop(x()));
            rig.run(10);
        }
        Before::Failed => {
            rig.plant.drive(0).unwrap().jump(5_000);
            rig.run(10);
            assert_eq!(rig.state("x"), "ERROR_STOP");
        }
    }
    rig
}

/// A reset in one cycle with a stop, before or after it or in another lane, applies to earlier errors: it ends with the
/// code of the stop, and a later reset unlocks the axis.
#[test]
fn stop_takes_precedence_over_reset_of_its_cycle() {
    for before in BEFORE {
        let held = if before == Before::Failed { "ERROR_STOP" } else { "STOPPING" };
        for stop in STOPS {
            for first in [false, true] {
                let mut rig = prepared(before);
                rig.mirror();
                let reset = stop.give(&mut rig, first, &[Action::ResetErrors(x())]);
                assert_eq!(
                    (rig.state("x"), codes(&rig, reset)),
                    (held, vec![stop.code()]),
                    "{before:?} {stop:?} {first}"
                );
                rig.run(200);
                assert_eq!((rig.state("x"), rig.int("x.enabled")), (held, 1), "{before:?} {stop:?} {first}");
                assert_eq!(rig.done(reset).len(), 1);
                let again = rig.give(Action::ResetErrors(x()));
                rig.run(3);
                assert_eq!(
                    (rig.state("x"), codes(&rig, again)),
                    ("STANDSTILL", vec![Code::NONE]),
                    "{before:?} {stop:?}"
                );
            }
        }
        let mut rig = prepared(before);
        let command = |sequence, action| Command { sequence, source: Source::Ros, action };
        let (queue, stop) = (command(1_000, Action::ResetErrors(x())), command(1_001, Action::QuickStop(x())));
        rig.cycle(Commands { stop: &[stop], queue: &[queue], stream: None });
        rig.run(200);
        assert_eq!((rig.state("x"), codes(&rig, 1_000)), (held, vec![Code::QUICK_STOP]), "{before:?}");
    }
}

/// A reset that waits for rest does not release a later stop, also if an error had stopped the axis.
#[test]
fn a_reset_that_waits_for_rest_does_not_undo_a_stop() {
    for stop in STOPS {
        for fails in [false, true] {
            let mut rig = prepared(Before::Moves);
            if fails {
                rig.plant.drive(0).unwrap().jump(5_000);
                rig.run(1);
            } else {
                rig.give(Action::QuickStop(x()));
            }
            let held = if fails { "ERROR_STOP" } else { "STOPPING" };
            let reset = rig.give(Action::ResetErrors(x()));
            assert_eq!((rig.state("x"), rig.done(reset).len()), (held, 0));
            stop.give(&mut rig, true, &[]);
            rig.run(200);
            assert_eq!((rig.state("x"), codes(&rig, reset)), (held, vec![stop.code()]), "{stop:?} {fails}");
        }
    }
}

/// The reset bit of the positioning modules cannot release a stop of its cycle, either.
///
/// Proves: WF-MON-06
#[test]
fn a_stop_wins_over_the_reset_bit_of_its_cycle() {
    let mut cell = with_inputs();
    cell.axes[usize::from(X)].parameters.vocabularies.wf.max_following_error = Some(500);
    let mut rig = Rig::of(cell);
    rig.give(set(X, "error_reaction", 2));
    rig.enable();
    rig.plant.drive(0).unwrap().jump(600);
    rig.run(5);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", 1_011));
    let bit = || Action::vocabulary(wf::Request { axis: X, reset: true, ..Default::default() });
    let acknowledged = Stop::Quick.give(&mut rig, true, &[bit()]);
    assert_eq!(
        (rig.refusal(acknowledged), rig.state("x")),
        ("x: quick_stop has stopped the axis".into(), "ERROR_STOP")
    );
    let again = rig.give(bit());
    assert_eq!((rig.was_accepted(again), rig.state("x")), (true, "STANDSTILL"));
}

/// I_CONTINUE and I_ERRCLR in the cycle of a stop, and an I_ERRCLR that waits for rest, do not release the axis.
#[test]
fn inputs_in_the_cycle_of_a_stop_release_nothing() {
    let mut rig = prepared(Before::Stands);
    rig.plant.set_digital(1, true);
    Stop::Break.give(&mut rig, true, &[]);
    rig.run(5);
    assert_eq!(rig.state("x"), "STOPPING");
    rig.plant.set_digital(1, false);
    rig.run(2);
    rig.plant.set_digital(1, true);
    rig.run(2);
    assert_eq!(rig.state("x"), "STANDSTILL", "the next edge does");
    for stop in STOPS {
        for earlier in [0, 1] {
            // An error that is only reported: the axis continues, and I_ERRCLR has something to clear.
            let mut rig = Rig::of(with_inputs());
            rig.give(set(X, "error_reaction", 5));
            rig.enable();
            rig.give(Action::Move(at(X, 50_000.0)));
            rig.run(150);
            rig.plant.drive(0).unwrap().jump(5_000);
            rig.run(2);
            assert_eq!((rig.state("x"), rig.int("x.error")), ("CONTINUOUS_MOTION", 10_201));
            rig.plant.set_digital(2, true);
            rig.run(earlier);
            stop.give(&mut rig, true, &[]);
            rig.run(200);
            assert_eq!((rig.state("x"), rig.int("x.error")), ("STOPPING", 10_201), "{stop:?} {earlier}");
        }
    }
}

/// An axis in error without power stays without it, and has no other reason for a lock: the reset is done.
#[test]
fn a_reset_of_an_axis_that_is_off() {
    for stop in STOPS {
        for first in [false, true] {
            for fails in [false, true] {
                let mut rig = Rig::of(with_inputs());
                rig.run(3);
                if fails {
                    rig.enable();
                    rig.plant.drive(0).unwrap().inject_fault(0x8611);
                    rig.run(5);
                    assert_eq!(rig.state("x"), "ERROR_STOP");
                }
                let reset = stop.give(&mut rig, first, &[Action::ResetErrors(x())]);
                rig.run(50);
                let locks = !fails && stop != Stop::Break;
                let (state, code) = if locks { ("STOPPING", stop.code()) } else { ("DISABLED", Code::NONE) };
                assert_eq!((rig.state("x"), codes(&rig, reset)), (state, vec![code]), "{stop:?} {first} {fails}");
            }
        }
    }
}

/// halt causes no lock, so the reset unlocks the axis; disable removes the power with any reset, and the load stays in
/// place.
#[test]
fn halt_and_disable_with_a_reset_in_one_cycle() {
    for before in BEFORE {
        for first in [false, true] {
            let pair = |stop: Action| {
                let reset = Action::ResetErrors(x());
                if first { vec![stop, reset] } else { vec![reset, stop] }
            };
            let mut rig = prepared(before);
            let last = rig.give_all(pair(Action::Halt(x())));
            rig.run(200);
            assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("STANDSTILL", 0.0), "{before:?} {first}");
            assert_eq!([codes(&rig, last - 1), codes(&rig, last)], [vec![Code::NONE], vec![Code::NONE]]);
            let free = rig.give(Action::Move(to(X, 0)));
            assert!(rig.was_accepted(free));
            let mut rig = prepared(before);
            let last = rig.give_all(pair(Action::Disable(x())));
            let free = rig.give(Action::Move(to(X, 0)));
            assert!(!rig.refusal(free).is_empty(), "on its way to being off");
            rig.run(200);
            assert_eq!((rig.state("x"), rig.int("x.output.control")), ("DISABLED", 0), "{before:?} {first}");
            assert_eq!([codes(&rig, last - 1), codes(&rig, last)], [vec![Code::NONE], vec![Code::NONE]]);
        }
    }
    for first in [false, true] {
        let mut rig = vertical_of(with_inputs(), 50_000_000, 35_000_000, Model::Ideal);
        rig.give(Action::Enable(x()));
        rig.run_until("x.state", 1);
        rig.give(Action::QuickStop(x()));
        rig.run(5);
        let (disable, reset) = (Action::Disable(x()), Action::ResetErrors(x()));
        rig.give_all(if first { vec![disable, reset] } else { vec![reset, disable] });
        assert_ne!(rig.state("x"), "STANDSTILL");
        rig.run(200);
        assert_eq!((rig.state("x"), rig.int("x.actual.position")), ("DISABLED", 0), "{first}");
    }
}

/// The stop ends a reset that is already acting on the drive; the axis is off and locked, and can be parameterised like
/// a disabled one.
#[test]
fn a_stop_ends_a_reset_of_a_drive_in_fault() {
    for stop in [Stop::Quick, Stop::Abort] {
        let mut rig = Rig::of(with_inputs());
        rig.run(3);
        rig.plant.drive(0).unwrap().inject_fault(0x8611);
        rig.run(5);
        let reset = rig.give(Action::ResetErrors(x()));
        stop.give(&mut rig, true, &[]);
        assert_eq!(codes(&rig, reset), [stop.code()]);
        rig.run(100);
        assert_eq!(rig.state("x"), "STOPPING", "{stop:?}");
        let enable = rig.give(Action::Enable(x()));
        assert!(rig.refusal(enable).contains("reset_errors"), "{stop:?}");
        let turned = rig.give(set(X, "posdrct", -1));
        assert!(rig.was_accepted(turned), "{stop:?}");
        let again = rig.give(Action::ResetErrors(x()));
        rig.run(50);
        assert_eq!((rig.state("x"), codes(&rig, again)), ("DISABLED", vec![Code::NONE]), "{stop:?}");
    }
}

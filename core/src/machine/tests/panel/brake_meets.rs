//! A closing or opening brake together with events that end, stop or reset its axis.

use super::super::rig::{Rig, X};
use super::brake::vertical;
use super::{set, with_io};
use crate::code::Code;
use crate::command::Action;
use crate::drive::inputs;
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::sim::Model;
use crate::vocabulary::saia;

const LIMITS: u32 = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT;

/// Returns a rig with x switched on, or being switched on: the brake takes 40 ms to open and has 50 ms.
fn switched_on(reaction: i64, until: &str) -> (Rig, u64) {
    let mut rig = vertical(50_000_000, 35_000_000, Model::Ideal);
    rig.give(set(X, "error_reaction", reaction));
    let enabled = rig.give(Action::Enable(AxisSet::one(X)));
    rig.run_until(until, 1);
    (rig, enabled)
}

/// A drive that stops by itself (error_reaction 4) keeps its power until the brake is closed, with any command that
/// switches it off.
///
/// Proves: MACS-ERR-02
#[test]
fn disable_leaves_a_drive_that_stops_by_itself_its_power_until_the_brake_is_closed() {
    for command in [Action::Disable(AxisSet::one(X)), Action::Deactivate] {
        for wait in [0, 1, 10, 34, 36, 100] {
            let (mut rig, _) = switched_on(4, "x.state");
            rig.plant.drive(0).unwrap().set_stuck_inputs(LIMITS, inputs::POSITIVE_LIMIT);
            rig.run(1);
            assert_eq!((rig.state("x"), rig.int("x.output.control")), ("ERROR_STOP", 2));
            rig.run(wait);
            rig.mirror();
            let sequence = rig.give(command.clone());
            let held = rig.run_until("x.output.control", 0);
            assert!(held <= 36, "{held}");
            rig.run(300);
            assert_eq!((rig.int("x.actual.position"), rig.state("x")), (0, "ERROR_STOP"), "{wait}");
            if matches!(command, Action::Disable(_)) {
                assert_eq!(rig.done(sequence).len(), 1, "{wait}");
            }
        }
    }
}

/// A drive that stops by itself and no longer reports meanwhile is not waited for: it is unknown whether it is at rest.
#[test]
fn a_drive_that_falls_silent_while_it_stops_is_not_waited_for() {
    for command in [Action::ResetErrors(AxisSet::one(X)), Action::Disable(AxisSet::one(X))] {
        let (mut rig, _) = switched_on(4, "x.state");
        rig.plant.drive(0).unwrap().set_stuck_inputs(LIMITS, inputs::POSITIVE_LIMIT);
        rig.run(1);
        rig.modify_inputs = |inputs| {
            inputs.drive[0].fresh = false;
            inputs.drive[0].velocity = 50.0;
        };
        let sequence = rig.give(command);
        rig.run(50);
        assert_eq!((rig.done(sequence).len(), rig.int("x.output.control")), (1, 0));
    }
}

/// A drive that never shows rest by its encoder is switched off after the maximum time for any action of a drive.
#[test]
fn a_drive_that_never_stands_is_not_waited_for_without_end() {
    for command in [Action::ResetErrors(AxisSet::one(X)), Action::Disable(AxisSet::one(X))] {
        let (mut rig, _) = switched_on(4, "x.state");
        rig.modify_inputs = |inputs| inputs.drive[0].velocity = 50.0;
        rig.plant.drive(0).unwrap().set_stuck_inputs(LIMITS, inputs::POSITIVE_LIMIT);
        rig.run(1);
        let sequence = rig.give(command);
        rig.run(4_990);
        assert_eq!((rig.done(sequence).len(), rig.int("x.output.control"), rig.int("x.brake")), (0, 2, 0));
        rig.run(20);
        assert_eq!((rig.int("x.output.control"), rig.int("x.brake")), (2, 1), "the brake first");
        rig.run(35);
        assert_eq!((rig.done(sequence).len(), rig.int("x.output.control")), (1, 0));
    }
}

/// An error or an abort while the brake opens closes it; after the reset it has its full time to open.
#[test]
fn a_brake_that_closed_while_it_opened_has_its_time_after_the_reset() {
    for aborts in [false, true] {
        let (mut rig, _) = switched_on(3, "r");
        rig.run(20);
        if aborts {
            rig.give(Action::Abort);
        } else {
            rig.plant.drive(0).unwrap().set_stuck_inputs(LIMITS, LIMITS);
        }
        rig.run_until("x.brake", 1);
        rig.plant.drive(0).unwrap().set_stuck_inputs(0, 0);
        rig.run(10);
        rig.mirror();
        let sequence = rig.give(Action::ResetErrors(AxisSet::one(X)));
        assert_eq!((rig.state("x"), rig.done(sequence).len()), ("DISABLED", 0), "{aborts}");
        rig.run_until("x.brake", 0);
        assert_eq!(rig.run_until("x.state", 1), 50, "{aborts}");
        assert_eq!((rig.done(sequence).len(), rig.int("x.actual.position")), (1, 0));
    }
}

/// If an error stops an axis while its brake opens, its enable ends with that error, not with success.
#[test]
fn enable_ends_with_the_error_that_comes_while_the_brake_opens() {
    for reaction in [2, 3] {
        let (mut rig, enabled) = switched_on(reaction, "r");
        rig.plant.drive(0).unwrap().set_stuck_inputs(LIMITS, LIMITS);
        rig.run(200);
        assert_eq!(rig.state("x"), "ERROR_STOP");
        let ends: Vec<i64> = rig.done(enabled).iter().map(|done| done.code.0.into()).collect();
        assert_eq!(ends, [rig.int("x.error")], "{reaction}");
        assert_ne!(ends, [0]);
    }
}

/// A stop while a reset waits for the brake locks the axis: the reset applies to earlier errors only.
#[test]
fn a_reset_that_waits_for_the_brake_does_not_undo_a_later_stop() {
    for (stop, code) in [(Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP), (Action::Abort, Code::ABORTED)] {
        let (mut rig, _) = switched_on(3, "x.state");
        rig.plant.drive(0).unwrap().set_stuck_inputs(LIMITS, LIMITS);
        rig.run(100);
        let reset = rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(10);
        assert_eq!((rig.state("x"), rig.int("x.brake"), rig.done(reset).len()), ("DISABLED", 0, 0));
        rig.give(stop);
        rig.run(200);
        assert_eq!(rig.state("x"), "STOPPING");
        assert_eq!(rig.done(reset).iter().map(|done| done.code).collect::<Vec<_>>(), [code]);
        let again = rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(60);
        assert_eq!((rig.state("x"), rig.done(again).len()), ("STANDSTILL", 1));
    }
}

fn saia(commands: &[saia::Command]) -> saia::Request {
    let commands = saia::Commands::from_iter(commands.iter().copied());
    saia::Request { axis: X, commands, ..Default::default() }
}

/// FStart switches the axis on; its motion starts once the brake is open, and is the same as without a brake. FMotOff
/// first closes the brake of a load, and a start in the meantime waits.
#[test]
fn motor_commands_of_saia_wait_for_the_brake() {
    use saia::Command::{Initialise, LoadAcceleration, LoadDestination, LoadVelocity, MotorOff, Start};
    let start = |to: i64| {
        let request = saia(&[LoadAcceleration, LoadVelocity, LoadDestination, Start]);
        let request = request.with(saia::Register::DestP, Value::Int(to));
        let request = request.with(saia::Register::Veloc, Value::Int(20_000));
        Action::vocabulary(request.with(saia::Register::Accel, Value::Int(200_000)))
    };
    let mut ends = Vec::new();
    for mut rig in [Rig::of(with_io()), vertical(50_000_000, 35_000_000, Model::Ideal)] {
        rig.run(3);
        rig.give(Action::vocabulary(saia(&[Initialise])));
        rig.run(5);
        rig.give(start(50_000));
        rig.run(3_500);
        ends.push((rig.state("x"), rig.int("x.command.position")));
        rig.mirror();
        rig.give(Action::vocabulary(saia(&[MotorOff])));
        rig.run(10);
        rig.give(start(80_000));
        rig.run(3_000);
        ends.push((rig.state("x"), rig.int("x.command.position")));
        let place = rig.int("x.actual.position");
        rig.give(Action::vocabulary(saia(&[MotorOff])));
        rig.run(300);
        assert_eq!((rig.int("x.output.control"), rig.int("x.actual.position") - place), (0, 0));
        assert!(rig.events.iter().all(|event| event.code != Code::NOT_ENABLED));
    }
    let [first, second, rest @ ..] = &ends[..] else { panic!("{ends:?}") };
    assert!(first.1 != 0 && second.1 != first.1, "{ends:?}");
    assert_eq!(rest, [*first, *second]);
}

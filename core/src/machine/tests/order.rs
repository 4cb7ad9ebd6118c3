//! Order within a cycle: errors from its inputs come first, then its commands and the vocabularies.

use super::rig::{Rig, X, Y, at, config, to};
use crate::code::Code;
use crate::command::Action;
use crate::event::Kind;
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};

fn set(rig: &mut Rig, axis: u16, values: &[(&str, i64)]) {
    let change =
        |&(key, value): &(&str, i64)| Change { axis, row: Row::find(key).unwrap().0, value: Value::Int(value) };
    let sequence = rig.give(Action::SetParameters(values.iter().map(change).collect()));
    assert!(rig.was_accepted(sequence));
}

/// A command in the cycle in which the following error is detected is handled after it, as after a fault of the drive.
#[test]
fn a_command_finds_the_error_of_its_cycle() {
    for reaction in [0, 2] {
        for fault in [false, true] {
            let mut config = config(0);
            config.axes[usize::from(X)].parameters.error_reaction = reaction;
            let mut rig = Rig::of(config);
            rig.enable();
            rig.mirror();
            let before = rig.give(Action::Move(at(X, 20_000.0)));
            rig.run(50);
            if fault {
                rig.plant.drive(0).unwrap().inject_fault(0x8611);
            } else {
                rig.plant.drive(0).unwrap().jump(-5_000);
            }
            let late = rig.give(Action::Move(to(X, 50_000)));
            let code = if fault { Code::drive_fault(0x8611) } else { Code::FOLLOWING_ERROR };
            assert_eq!(rig.done(before).iter().map(|done| done.code).collect::<Vec<_>>(), [code]);
            let refused: Vec<_> = rig.events.iter().filter(|event| event.command == late).collect();
            assert_eq!(
                refused.iter().map(|event| (event.kind, event.code)).collect::<Vec<_>>(),
                [(Kind::Refused, Code::IN_ERROR)]
            );
            assert_eq!(rig.state("x"), "ERROR_STOP");
        }
    }
}

/// An error of 500 inc exceeds the window of the selector, and is within the following error limit of the axis: the
/// axis stops in that cycle.
///
/// Proves: AMC-STP-06
#[test]
fn the_selector_stops_in_the_cycle_of_the_following_error() {
    let mut rig = Rig::enabled();
    set(&mut rig, Y, &[("amc.stop_mode", 2), ("amc.following_error_window", 200)]);
    set(&mut rig, Y, &[("amc.position_reference", 40_000), ("amc.reference_select", 1)]);
    rig.run(100);
    assert_eq!((rig.int("y.amc.select"), rig.int("y.following_error")), (1, 0));
    rig.plant.drive(1).unwrap().jump(-500);
    rig.run(1);
    assert_eq!((rig.int("y.following_error"), rig.int("y.amc.select")), (500, 0));
    rig.run(200);
    assert_eq!((rig.state("y"), rig.real("y.command.velocity")), ("STANDSTILL", 0.0));
}

/// A disable in the cycle of an error is handled after it, and does not clear it.
#[test]
fn a_disable_leaves_the_error_of_its_cycle() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 20_000.0)));
    rig.run(50);
    rig.plant.drive(0).unwrap().jump(-5_000);
    let disable = rig.give(Action::Disable(AxisSet::one(X)));
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", 10_201));
    rig.run(100);
    assert_eq!((rig.state("x"), rig.int("x.enabled"), rig.done(disable).len()), ("ERROR_STOP", 0, 1));
}

//! Effect of a zero, a source and a type on all axes that read an encoder: their positions and their homed state.

use super::super::rig::{Rig, X, Y, at, couple, to};
use super::{change, corrected, error, off, set, shared_config, velocity_config, zero};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::Action;
use crate::object::{AxisSet, Leader};

/// Two users at 25000: a soft zero applies to the first user only, a hard zero to the encoder.
///
/// Proves: MACS-O-59, MACS-ENC-11, MACS-ENC-12
#[test]
fn a_soft_zero_is_of_one_user_and_a_hard_one_of_all() {
    for (control, others) in [(2, 25_000), (0, 0)] {
        let mut rig = Rig::of(shared_config());
        rig.run(2);
        rig.give(Action::SetParameters(Box::new([change(X, "enccontrol", control)])));
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(40);
        rig.give(Action::Move(to(X, 25_000)));
        rig.run(2_000);
        let seen = |rig: &Rig| ["x.actual.position", "y.actual.position", "belt.position"].map(|name| rig.int(name));
        assert_eq!(seen(&rig), [25_000; 3]);
        rig.give(zero(X, 0));
        assert_eq!(rig.int("x.actual.position"), 0, "at once");
        rig.run(1);
        assert_eq!(seen(&rig), [0, others, others], "enccontrol {control}");
        // Nothing has moved, and all users continue from there.
        rig.run(50);
        assert_eq!((seen(&rig), error(&rig)), ([0, others, others], 0));
        rig.give(Action::Move(to(X, 1_000)));
        rig.run(1_000);
        assert_eq!(seen(&rig), [1_000, others + 1_000, others + 1_000]);
        assert_eq!(rig.int("belt.count"), 26_000, "what it reads is what it reads");
    }
}

/// A zero of the encoder would shift the coordinate of another user in motion: it is refused, and nothing changes.
///
/// Proves: MACS-ENC-11
#[test]
fn a_hard_zero_waits_for_the_other_users() {
    let mut rig = Rig::of(shared_config());
    rig.enable();
    rig.give(Action::Move(at(Y, 1_000.0)));
    rig.run(10);
    let refused = rig.give(zero(X, 5));
    assert_eq!(rig.refusal(refused), "y: the axis runs at a velocity (CONTINUOUS_MOTION); halt it first");
    let before = rig.int("x.actual.position");
    // In one cycle with the start of the other user: only the axis itself gets the new zero, and this is reported.
    let mut rig = Rig::of(shared_config());
    rig.enable();
    rig.give_all(vec![zero(X, 500), Action::Move(at(Y, 1_000.0))]);
    assert_eq!((before, rig.int("x.actual.position")), (0, 500));
    rig.run(1);
    assert_eq!(rig.int("belt.position"), 0);
    let told = rig.events.iter().find(|event| event.code == Code::ENCODER_NOT_SHARED).unwrap();
    let sentence = "x: y, which reads the same encoder, began to move, so that only this axis has its new zero";
    assert_eq!(crate::text::message(told, rig.machine.config()), sentence);
}

/// Followers of a shared encoder do not follow its new zero.
#[test]
fn hard_zero_moves_no_follower() {
    let mut config = velocity_config();
    config.axes[1].wired = Wired::Encoder(0);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Synchronize(couple(Y, Leader::Encoder(0), 1, 1)));
    rig.run(50);
    rig.give(zero(X, 5_000));
    rig.run(20);
    assert_eq!((rig.int("belt.position"), rig.int("y.command.position"), rig.int("y.error")), (5_000, 0, 0));
    rig.give(Action::Move(to(X, 6_000)));
    rig.run(1_000);
    assert_eq!((rig.int("belt.position"), rig.int("y.command.position")), (6_000, 1_000));
}

/// The source changes while the axis is off: a soft change keeps the position; a hard change takes that of the new
/// source.
///
/// Proves: MACS-ENC-11
#[test]
fn a_soft_change_of_the_source_keeps_the_position() {
    for (control, after) in [(1, 700), (0, 40)] {
        let mut config = velocity_config();
        config.axes[1].parameters.encoder.enccontrol = control;
        let mut rig = Rig::of(config);
        rig.plant.jump_encoder(0, 40);
        rig.enable();
        rig.give(Action::Move(to(X, 700)));
        rig.run(500);
        let on = set(&mut rig, &[("encodertype", 10)]);
        assert_eq!(rig.refusal(on), "x: encodertype becomes 10 only while x is disabled");
        off(&mut rig, X);
        rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
        rig.run(10);
        let y = rig.int("y.command.position");
        let changed = set(&mut rig, &[("encodertype", 10)]);
        assert!(rig.was_accepted(changed));
        rig.run(1);
        assert_eq!(rig.int("x.actual.position"), after, "enccontrol {control}");
        rig.run(20);
        assert_eq!(rig.int("y.command.position"), y, "that is no motion");
        rig.plant.jump_encoder(0, 3);
        rig.run(1);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.actual.count")), (after + 3, 43));
    }
}

/// A change of type cancels homing, even with the same source; a soft change keeps the position, and so the zero.
///
/// Proves: MACS-HOME-09, MACS-ENC-11
#[test]
fn another_type_of_encoder_cancels_homing() {
    for (control, homed) in [(0, 0), (1, 1)] {
        let mut config = velocity_config();
        config.axes[1].parameters.encoder.enccontrol = control;
        let mut rig = Rig::of(config);
        rig.enable();
        let method = crate::command::HomingMethod::Cia402(37);
        rig.give(Action::HomeAxis(crate::command::HomeAxis { axis: X, method }));
        rig.run(3);
        assert_eq!(rig.int("x.homed"), 1);
        off(&mut rig, X);
        set(&mut rig, &[("encodertype", 5)]);
        rig.run(2);
        assert_eq!(rig.int("x.homed"), homed, "enccontrol {control}");
        let warned = rig.events.iter().filter(|event| event.code == Code::HOMING_LOST).count();
        assert_eq!(warned as i64, 1 - homed, "enccontrol {control}");
    }
}

/// Proves: MACS-ENC-10, MACS-HOME-08
#[test]
fn zero_of_absolute_encoder_is_fixed() {
    let mut rig = corrected();
    assert_eq!(rig.int("x.homed"), 1, "it knows where it is");
    let set = rig.give(zero(X, 5));
    let text = "x: encodertype 3 says that its encoder is absolute, so that its zero stands; no homing, no index and no set_position";
    assert_eq!(rig.refusal(set), text);
    let method = crate::command::HomingMethod::Cia402(37);
    let home = rig.give(Action::HomeAxis(crate::command::HomeAxis { axis: X, method }));
    assert_eq!(rig.refusal(home), text);
    assert_eq!(rig.int("x.actual.position"), 0);
}

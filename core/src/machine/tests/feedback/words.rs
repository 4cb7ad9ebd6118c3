//! Words with parity, words that a drive decodes itself, and coordinates that start again.

use super::super::rig::{Rig, X, Y, config, couple, to};
use super::{error, set, shared_config, velocity_config, zero};
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::object::Leader;
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::vocabulary::wf::{Mode, Request};

/// One wrong track of a Gray word is a step of one increment: without parity it is not detected.
///
/// Proves: WF-MD-09, WF-ABS-04
#[test]
fn parity_by_md16_sees_a_single_wrong_track() {
    for (md16, seen) in [(0, false), (1, true), (2, true)] {
        let mut config = velocity_config();
        let p = &mut config.axes[1].parameters;
        (p.encoder.kind, p.encoder.steps, p.encoder.reference_or_parity) = (1, 16_384, md16);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(to(X, 40_000)));
        rig.run(2_500);
        assert_eq!((rig.int("x.actual.position"), error(&rig)), (40_000, 0), "over two seams");
        assert_eq!(
            rig.int("x.actual.count") >> 14 != 0,
            md16 == 2,
            "40000 mod 16384 is 7232, which has an even number of ones in Gray"
        );
        rig.plant.drive(0).unwrap().invert_bits(1, 1);
        rig.run(1);
        let expected = if seen { i64::from(Code::ENCODER_INVALID.0) } else { 0 };
        assert_eq!(error(&rig), expected, "md16 {md16}");
    }
}

/// Proves: WF-MD-03, WF-MD-09
#[test]
fn machine_data_of_an_absolute_encoder_are_refused_with_their_own_words() {
    let mut rig = Rig::of(velocity_config());
    rig.run(2);
    for value in [3, -1, 50_000] {
        let row = |key, value| Change { axis: X, row: Row::find(key).unwrap().0, value: Value::Int(value) };
        let refused = rig.give(Action::SetParameters(Box::new([row("wf.md4", 1), row("wf.md16", value)])));
        let sentence = rig.refusal(refused);
        let end = "is no parity; with wf.md4 absolute 0 inc (none), 1 inc (even) and 2 inc (odd) are allowed";
        assert!(sentence.starts_with("x: wf.md16 ") && sentence.ends_with(end), "{sentence}");
        // For an incremental encoder it is the reference point.
        let good = set(&mut rig, &[("wf.md16", value)]);
        assert!(rig.was_accepted(good));
    }
    let mut rig = Rig::of(config(0));
    rig.run(2);
    let refused = set(&mut rig, &[("wf.md4", 1)]);
    let sentence = "x: wf.md4 1 asks for words in Gray code, which a drive with interface position decodes itself; 0 \
                    (incremental) is allowed";
    assert_eq!(rig.refusal(refused), sentence);
}

/// An encoder loses its power: this is no motion for its users and followers, but its zero is lost.
///
/// Proves: MACS-ENC-12
#[test]
fn a_new_epoch_of_an_encoder_is_no_motion_and_drops_the_zero_of_its_users() {
    let mut config = shared_config();
    config.axes[2].wired = crate::axis::Wired::default();
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(37) }));
    rig.give(Action::Synchronize(couple(Y, Leader::Encoder(0), 1, 1)));
    rig.give(Action::Move(to(X, 5_000)));
    rig.run(2_000);
    assert_eq!((rig.int("x.homed"), rig.int("belt.count"), rig.int("y.command.position")), (1, 5_000, 5_000));
    rig.mirror();
    rig.plant.restart_encoder(0);
    rig.run(20);
    assert_eq!((rig.int("belt.count"), rig.int("belt.position"), rig.int("x.actual.position")), (0, 5_000, 5_000));
    assert_eq!((rig.int("x.command.position"), rig.int("y.command.position"), rig.int("x.homed")), (5_000, 5_000, 0));
    assert_eq!((error(&rig), rig.int("y.error")), (0, 0));
    let told = rig.events.iter().filter(|event| event.code == Code::HOMING_LOST).count();
    assert_eq!(told, 1);
    rig.give(Action::Move(to(X, 5_100)));
    rig.run(1_500);
    assert_eq!((rig.int("belt.count"), rig.int("belt.position"), rig.int("y.command.position")), (100, 5_100, 5_100));
}

/// `synchronized` is 1 while positions refer to a zero that was set by any method: the preset of the modules, homing,
/// set_position. It is 0 again when that zero is lost.
///
/// Proves: WF-IF-11, WF-REF-05
#[test]
fn the_modules_know_every_zero_that_was_set_and_lost() {
    let mut config = config(0);
    config.axes[1].parameters.encoder.max_jump = Some(3_000);
    let mut rig = Rig::of(config);
    rig.enable();
    let known = |rig: &Rig| rig.int("x.wf.synchronized");
    assert_eq!(known(&rig), 0);
    rig.give(zero(X, 1_000));
    assert_eq!(known(&rig), 1);
    // The last zero counts: the zero of the preset is 500 before it, and is not a zero any more after the next one.
    let preset =
        Request { axis: X, mode: Some(Mode::ActualValue), value: Some(Length::whole(500)), ..Request::default() };
    rig.give(Action::vocabulary(preset));
    rig.give(zero(X, 2_000));
    let to_2100 = |rig: &mut Rig| {
        let mut block = crate::vocabulary::wf::Block::default();
        (block.position, block.absolute) = (crate::position::Position::whole(2_100), true);
        block.speed = crate::vocabulary::wf::Speed::Value(10.0);
        let start = Request {
            axis: X,
            mode: Some(Mode::Mdi),
            blocks: crate::vocabulary::wf::Blocks::new(&[block]),
            start: true,
            ..Request::default()
        };
        rig.give(Action::vocabulary(start))
    };
    let given = to_2100(&mut rig);
    assert!(rig.was_accepted(given));
    rig.run(500);
    assert_eq!((rig.int("x.command.position"), known(&rig)), (2_100, 1));
    super::off(&mut rig, X);
    rig.run(20);
    rig.plant.drive(0).unwrap().jump(3_001);
    rig.run(2);
    assert!(rig.events.iter().any(|event| event.code == Code::ENCODER_JUMP));
    assert_eq!(known(&rig), 0, "where it is nobody knows");
    rig.give(Action::ResetErrors(crate::object::AxisSet::one(X)));
    rig.run(20);
    rig.give(Action::Enable(crate::object::AxisSet::one(X)));
    rig.run(40);
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(37) }));
    rig.run(20);
    assert_eq!((rig.int("x.homed"), known(&rig)), (1, 1));
}

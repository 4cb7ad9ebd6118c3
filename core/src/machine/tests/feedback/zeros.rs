//! Several zeros of one encoder in one cycle.

use super::super::rig::{Rig, X, Y, to};
use super::{shared_config, zero};
use crate::code::Code;
use crate::command::{Action, MasterPosition, ProbeEdge, SetEncoderPosition, SetMasterPosition, TouchProbe};
use crate::drive::{Edge, Latch};
use crate::event::Kind;
use crate::object::{AxisSet, Object};
use crate::position::{Length, Position};

const LINE: u16 = 0;

fn belt(position: i64) -> Action {
    Action::SetEncoderPosition(SetEncoderPosition { encoder: 0, position: Length::whole(position) })
}

/// Sets the master position that the line shows; its master is the belt.
fn master(position: i64) -> Action {
    let position = MasterPosition::Increments(Length::whole(position));
    Action::SetMasterPosition(SetMasterPosition { axis: LINE, position })
}

/// x and y read the belt, which is the master of the line; its value is 300, and y is 40 further.
fn rig(soft: i64) -> Rig {
    let mut config = shared_config();
    config.axes[usize::from(LINE)].parameters.encoder.mencodertype = 10;
    let mut rig = Rig::of(config);
    rig.run(2);
    let control = |value| Action::SetParameters(Box::new([super::change(Y, "enccontrol", value)]));
    rig.give_all(vec![control(2), zero(Y, 40)]);
    rig.give(control(soft));
    rig.give(belt(300));
    rig.run(2);
    assert_eq!(seen(&rig), [300, 340, 300, 300]);
    rig
}

fn seen(rig: &Rig) -> [i64; 4] {
    let shown = rig.real("line.master.position") as i64;
    [rig.int("x.actual.position"), rig.int("y.actual.position"), rig.int("belt.position"), shown]
}

/// As if each were shared before the next: the last zero applies to all of them.
///
/// Proves: MACS-ENC-11, MACS-ENC-12
#[test]
fn last_of_several_zeros_in_a_cycle_applies() {
    for (zeros, expected) in [
        (vec![zero(X, 500), zero(Y, 740)], [700, 740, 700, 700]),
        (vec![zero(Y, 740), zero(X, 500)], [500, 540, 500, 500]),
        (vec![zero(X, 500), belt(700)], [700, 740, 700, 700]),
        (vec![belt(700), zero(X, 500)], [500, 540, 500, 500]),
        (vec![zero(X, 500), master(11)], [11, 51, 11, 11]),
        (vec![master(11), zero(X, 500)], [500, 540, 500, 500]),
        (vec![zero(X, 500), zero(Y, 340)], [300, 340, 300, 300]),
        (vec![zero(X, 500), zero(Y, 740), zero(X, 100)], [100, 140, 100, 100]),
    ] {
        let mut rig = rig(0);
        let count = zeros.len() as u64;
        let last = rig.give_all(zeros.clone());
        assert!((0..count).all(|place| rig.was_accepted(last - place)));
        for _ in 0..5 {
            rig.run(1);
            assert_eq!(seen(&rig), expected, "{zeros:?}");
        }
        // An axis whose coordinate was shifted continues from there.
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(40);
        rig.give(Action::Move(to(X, expected[0] + 1_000)));
        rig.run(500);
        assert_eq!(seen(&rig), expected.map(|place| place + 1_000));
        assert!(!rig.events.iter().any(|event| event.code == Code::ENCODER_NOT_SHARED));
    }
}

/// A soft zero after a hard one has the commanded value; a soft zero before it moves with the encoder.
///
/// Proves: MACS-ENC-11
#[test]
fn soft_zero_keeps_its_order_with_hard_zeros() {
    for (zeros, expected) in [
        (vec![zero(X, 500), zero(Y, 740)], [500, 740, 500, 500]),
        (vec![zero(Y, 740), zero(X, 500)], [500, 940, 500, 500]),
    ] {
        let mut rig = rig(2);
        rig.give_all(zeros);
        rig.run(3);
        assert_eq!(seen(&rig), expected);
    }
}

/// Each of two zeros is legal; their sum would not be a zero of any axis. A zero that does not fit is reported.
#[test]
fn a_zero_that_leads_another_user_out_of_range_is_one_of_the_axis_alone() {
    let far = 4_000_000_000_000_000_000;
    let mut rig = rig(0);
    rig.give_all(vec![zero(X, far), zero(Y, far)]);
    rig.run(2);
    assert_eq!(seen(&rig)[..3], [far - 40, far, far - 40]);
    assert!(!rig.events.iter().any(|event| event.code == Code::ENCODER_NOT_SHARED));
    // y is 40 further than x.
    let mut rig = self::rig(0);
    rig.give(zero(X, (1 << 62) - 30));
    rig.run(1);
    assert_eq!(seen(&rig)[..3], [(1 << 62) - 30, 340, 300]);
    let told = rig.events.iter().find(|event| event.code == Code::ENCODER_NOT_SHARED).unwrap();
    assert_eq!(
        crate::text::message(told, rig.machine.config()),
        "x: with its new zero a position or limit of the encoder or of an axis that reads it would leave +-2^62 increments, so \
         that only this axis has it"
    );
}

/// A zero of x moves y in the next cycle. A latch of the drive of y in that cycle is recorded in the new coordinate.
#[test]
fn a_latch_in_the_cycle_of_a_shared_zero_has_the_new_coordinate() {
    let mut rig = rig(0);
    let source = Object::Axis(Y);
    let request = TouchProbe { axis: Y, source, edge: ProbeEdge::Rising, continuous: true, window: None };
    let probe = rig.give(Action::TouchProbe(request));
    assert!(rig.was_accepted(probe));
    let caught = |rig: &mut Rig| {
        assert!(rig.plant.add_latch(Latch { object: source, edge: Edge::Rising, age_ns: None, position: Some(7) }));
        rig.run(1);
        let is_record = |event: &&crate::event::Event| event.kind == Kind::Latch && event.command == probe;
        rig.events.iter().rfind(is_record).expect("a record").position
    };
    let before = caught(&mut rig);
    rig.give(zero(X, 500));
    assert_eq!(caught(&mut rig) - before, Position::whole(200));
}

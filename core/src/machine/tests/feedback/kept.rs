//! Parameters that may be set while an axis is on, and their effect on its position and its zero.

use super::super::rig::{Rig, X, Y, to};
use super::{change, error, off, set, velocity_config};
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::drive::Interface;
use crate::event::Kind;
use crate::object::AxisSet;
use crate::parameter::Layer;

fn home(rig: &mut Rig) {
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) }));
    rig.run(3);
    assert_eq!(rig.int("x.homed"), 1);
}

fn lost(rig: &Rig) -> usize {
    rig.events.iter().filter(|event| event.code == Code::HOMING_LOST).count()
}

/// MD34 only checks the words of an absolute encoder: whenever it is set, the position, its zero and the word overflows
/// are retained.
///
/// Proves: WF-MD-16, WF-ABS-04
#[test]
fn a_largest_step_moves_nothing_when_it_is_set() {
    let mut config = velocity_config();
    let p = &mut config.axes[1].parameters.encoder;
    (p.kind, p.steps) = (1, 4_096);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Move(to(X, 20_000)));
    rig.run(1_500);
    home(&mut rig);
    rig.mirror();
    for md34 in [300, 200, 0, 300] {
        let given = set(&mut rig, &[("wf.md34", md34)]);
        assert!(rig.was_accepted(given));
        for _ in 0..20 {
            assert_eq!((rig.int("x.actual.position"), rig.real("x.output.velocity")), (0, 0.0), "wf.md34 {md34}");
            rig.run(1);
        }
    }
    assert_eq!((rig.int("x.homed"), lost(&rig), error(&rig)), (1, 0, 0));
    // In motion, and over the word boundary.
    rig.give(Action::Move(to(X, 10_000)));
    rig.run(100);
    let before = rig.int("x.actual.position");
    set(&mut rig, &[("wf.md34", 250)]);
    assert!((0..=100).contains(&(rig.int("x.actual.position") - before)), "100 mm/s");
    rig.run(500);
    assert_eq!((rig.int("x.command.position"), error(&rig)), (10_000, 0));
    // Switched off as well; and the value is in force.
    off(&mut rig, X);
    rig.run(100);
    let before = rig.int("x.actual.position");
    set(&mut rig, &[("wf.md34", 260)]);
    rig.run(5);
    assert_eq!((rig.int("x.actual.position"), rig.int("x.homed")), (before, 1));
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(20);
    rig.plant.drive(0).unwrap().jump(261);
    rig.run(1);
    assert_eq!(error(&rig), i64::from(Code::ENCODER_INVALID.0));
}

/// With ENCODERTYPE 1 to 4 ENCODER is the size of the source, which can only be changed while the axis is off; with
/// other types it can be changed any time.
#[test]
fn the_size_of_an_absolute_encoder_changes_while_its_axis_is_off() {
    for interface in [Interface::Position, Interface::Velocity] {
        let mut config = velocity_config();
        let x = &mut config.axes[1];
        x.interface = interface;
        (x.parameters.encoder.encodertype, x.parameters.macs.encoder) = (1, 4_096);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(to(X, 5_000)));
        rig.run(1_500);
        let refused = set(&mut rig, &[("encoder", 8_192)]);
        assert_eq!(rig.refusal(refused), "x: encoder becomes 8192 only while x is disabled");
        let same = set(&mut rig, &[("encoder", 4_096)]);
        assert!(rig.was_accepted(same));
        let counts = rig.give(Action::SetParameters(Box::new([change(Y, "encoder", 8_192)])));
        assert!(rig.was_accepted(counts), "an incremental encoder has no size");
        rig.run(20);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.command.position"), error(&rig)), (5_000, 5_000, 0));
        off(&mut rig, X);
        let accepted = set(&mut rig, &[("encoder", 8_192)]);
        assert!(rig.was_accepted(accepted));
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(40);
        let back = rig.give(Action::ResetParameters { axes: AxisSet::one(X), layer: Layer::User });
        assert_eq!(rig.refusal(back), "x: encoder becomes 4096 only while x is disabled");
    }
}

/// The zero of an absolute encoder is fixed, whatever was known before; back to counts, it is unknown again.
///
/// Proves: MACS-ENC-10
#[test]
fn absolute_encoder_counts_as_homed() {
    let mut rig = Rig::of(velocity_config());
    rig.enable();
    home(&mut rig);
    off(&mut rig, X);
    for (kind, homed, warned) in [(1, 1, 0), (4, 1, 0), (0, 0, 1)] {
        let given = set(&mut rig, &[("encodertype", kind)]);
        assert!(rig.was_accepted(given));
        rig.run(3);
        assert_eq!((rig.int("x.homed"), lost(&rig)), (homed, warned), "encodertype {kind}");
    }
}

/// A limit that would leave its range with a new position is reported with the requested position.
#[test]
fn limit_that_would_leave_its_range_is_reported() {
    let mut config = velocity_config();
    config.axes[1].parameters.max_position = Some(20);
    let mut rig = Rig::of(config);
    let refused = rig.give(super::zero(X, (1 << 62) - 10));
    let told = rig.refusal(refused);
    assert!(
        told.starts_with("x: at position 46116860") && told.contains(" mm a software limit would be 46116860"),
        "{told}"
    );
}

/// The numbers of an error also appear in its reset.
#[test]
fn reset_reports_numbers_of_the_error() {
    let mut rig = Rig::of(velocity_config());
    rig.enable();
    rig.plant.drive(0).unwrap().jump(20_001);
    rig.run(1);
    assert_eq!(error(&rig), i64::from(Code::FOLLOWING_ERROR.0));
    rig.run(40);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(5);
    let told = |kind| {
        let event = rig.events.iter().find(|event| event.kind == kind && event.code == Code::FOLLOWING_ERROR).unwrap();
        crate::text::message(event, rig.machine.config())
    };
    let sentence = "following error -20.001 mm exceeds max_following_error 20 mm";
    assert_eq!(told(Kind::Error), format!("x: {sentence}"));
    assert_eq!(told(Kind::Reset), format!("x: reset after: {sentence}"));
}

//! Direction polarity: which values are inverted, where, and which are not.

mod mirror;
mod reversing;

use super::rig::{Rig, X, Y, at, config, couple, to};
use crate::command::Action;
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{Edge, Interface, Latch, SpeedOutputs, Switching};
use crate::machine::Machine;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Layer, Row, Value};
use crate::position::Length;
use crate::sim::{Model, TwoSpeed, VelocityLag};
use crate::vocabulary::Order;

const MS: u64 = 1_000_000;

/// Returns the machine of the rig with this POSDRCT of x.
fn turned(posdrct: i64) -> MachineConfig {
    let mut config = config(0);
    config.axes[1].parameters.macs.posdrct = posdrct;
    config
}

pub(super) fn set(rig: &mut Rig, changes: &[(&str, i64)]) -> u64 {
    let change = |&(key, value): &(&str, i64)| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: X, row, value: Value::Int(value) }
    };
    rig.give(Action::SetParameters(changes.iter().map(change).collect()))
}

/// A servo drive with a lag of 5 ms in its velocity loop.
fn servo(inverted: bool) -> Model {
    Model::Velocity(VelocityLag::new(5_000_000, MS).expect("a lag")).wired(inverted)
}

/// Returns a cell in which the loop of x is closed in the core.
fn closed_here(posdrct: i64) -> MachineConfig {
    let mut config = turned(posdrct);
    config.axes[1].interface = Interface::Velocity;
    config.axes[1].parameters.max_following_error = 20_000;
    config
}

/// Encoder at +500: APOS -500. POSA -1500 moves it to +1500. All values are shown in the user polarity, except counts
/// and outputs.
///
/// Proves: MACS-DIR-02, MACS-O-71
#[test]
fn inverted_units_mirror_commands_and_signals() {
    let mut rig = Rig::of(turned(-1));
    rig.plant.drive(0).unwrap().jump(500);
    rig.enable();
    assert_eq!((rig.int("x.actual.count"), rig.int("x.actual.position")), (500, -500));
    assert_eq!((rig.int("x.command.position"), rig.int("x.output.position")), (-500, 500));
    let goal = rig.give(Action::Move(to(X, -1_500)));
    rig.run(30);
    assert!(rig.real("x.command.velocity") < 0.0 && rig.real("x.actual.velocity") < 0.0);
    assert!(rig.real("x.output.velocity") > 0.0, "the drive counts up");
    rig.run(500);
    assert_eq!(rig.done(goal).len(), 1);
    assert_eq!((rig.int("x.actual.count"), rig.int("x.output.position")), (1_500, 1_500));
    assert_eq!((rig.int("x.command.position"), rig.int("x.actual.position")), (-1_500, -1_500));
    // POSR and CVEL as well.
    rig.give(Action::Move(at(X, 20_000.0)));
    rig.run(500);
    assert_eq!((rig.real("x.command.velocity"), rig.real("x.output.velocity")), (20_000.0, -20_000.0));
    assert_eq!(rig.real("x.actual.velocity"), 20_000.0);
    assert_eq!((rig.int("x.following_error"), rig.int("x.error")), (0, 0));
}

/// The stop reference of the reference selector is inverted like any other position.
#[test]
fn the_stop_reference_turns_over_with_its_axis() {
    let mut rig = Rig::of(turned(1));
    rig.enable();
    set(&mut rig, &[("amc.position_reference", 700), ("amc.reference_select", 1)]);
    rig.run(1_000);
    set(&mut rig, &[("amc.reference_select", 0)]);
    rig.run(10);
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(50);
    assert_eq!((rig.int("x.command.position"), rig.int("x.amc.stop_reference")), (700, 700));
    set(&mut rig, &[("posdrct", -1)]);
    assert_eq!((rig.int("x.command.position"), rig.int("x.amc.stop_reference")), (-700, -700));
}

/// Limits are in user units, too: no goal exceeds them, and a velocity goal stops at them.
#[test]
fn limits_are_in_the_units_of_the_axis() {
    let mut config = turned(-1);
    (config.axes[1].parameters.min_position, config.axes[1].parameters.max_position) = (Some(-2_000), Some(9_000));
    let mut rig = Rig::of(config);
    rig.enable();
    let low = rig.give(Action::Move(to(X, -2_001)));
    assert!(rig.refusal(low).contains("below min_position"), "{}", rig.refusal(low));
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(1_000);
    assert_eq!((rig.int("x.command.position"), rig.int("x.actual.count")), (9_000, -9_000));
}

/// The slave of an inverted axis follows the user position; an inverted slave counts in the direction opposite to its
/// drive.
///
/// Proves: MACS-DIR-02, MACS-DIR-04
#[test]
fn gears_are_in_the_units_of_both_axes() {
    for (numerator, position) in [(1, 10_000), (-1, -10_000)] {
        let mut rig = Rig::of(turned(-1));
        rig.enable();
        rig.give_all(vec![
            Action::Synchronize(couple(X, Leader::AxisCommand(0), numerator, 1)),
            Action::Synchronize(couple(Y, Leader::AxisActual(X), 1, 1)),
        ]);
        rig.give(Action::Move(to(0, 10_000)));
        rig.run(2_000);
        assert_eq!((rig.int("x.command.position"), rig.int("x.output.position")), (position, -position));
        assert_eq!((rig.int("y.command.position"), rig.int("y.output.position")), (position, position));
        assert_eq!((rig.int("x.sync.error"), rig.int("y.sync.error")), (0, 0));
    }
}

/// POSDRCT can only be changed while the axis is off. The position is then mirrored, and nothing moves: neither the
/// axis nor its followers.
#[test]
fn axis_inverted_while_off_stays_in_place() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(to(X, 3_000)));
    rig.run(1_000);
    let on = set(&mut rig, &[("posdrct", -1)]);
    assert!(rig.refusal(on).contains("posdrct") && rig.refusal(on).contains("disable"), "{}", rig.refusal(on));
    // An unchanged value is not a change.
    let same = set(&mut rig, &[("posdrct", 1)]);
    assert!(rig.was_accepted(same));
    rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
    rig.give(Action::Synchronize(couple(0, Leader::AxisActual(X), 1, 1)));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(20);
    let others = (rig.int("y.command.position"), rig.int("line.command.position"));
    rig.mirror();
    for (posdrct, position) in [(-1, -3_000), (1, 3_000), (-11, -3_000)] {
        rig.events.clear();
        let good = set(&mut rig, &[("posdrct", posdrct)]);
        assert!(rig.was_accepted(good), "{posdrct}");
        assert_eq!((rig.int("x.actual.count"), rig.int("x.actual.position")), (3_000, position));
        rig.run(20);
        assert_eq!((rig.int("x.command.position"), rig.int("x.output.position")), (position, 3_000));
        assert_eq!((rig.int("y.command.position"), rig.int("line.command.position")), others);
        assert_eq!(
            (rig.state("y"), rig.state("line"), rig.int("machine.error")),
            ("SYNCHRONIZED_MOTION", "SYNCHRONIZED_MOTION", 0)
        );
    }
    let enable = rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(20);
    assert_eq!((rig.done(enable).len(), rig.int("x.following_error"), rig.int("x.error")), (1, 0, 0));
    rig.give(Action::Move(to(X, -2_000)));
    rig.run(1_000);
    assert_eq!((rig.int("x.actual.count"), rig.int("y.command.position") - others.0), (2_000, 1_000));
}

/// A restored layer inverts the axis like a set does, and is refused while the axis is on.
#[test]
fn parameter_reset_restores_polarity() {
    let mut rig = Rig::new();
    rig.plant.drive(0).unwrap().jump(700);
    rig.run(2);
    set(&mut rig, &[("posdrct", -1)]);
    assert_eq!(rig.int("x.actual.position"), -700);
    rig.enable();
    let reset = Action::ResetParameters { axes: AxisSet::one(X), layer: Layer::User };
    let refused = rig.give(reset.clone());
    assert!(rig.refusal(refused).contains("posdrct"), "{}", rig.refusal(refused));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(20);
    let good = rig.give(reset);
    assert!(rig.was_accepted(good));
    assert_eq!((rig.int("x.actual.position"), rig.int("x.command.position")), (700, 700));
}

/// A position latched in counts of the drive is shown in user polarity.
#[test]
fn latches_are_inverted() {
    let mut rig = Rig::of(turned(-1));
    rig.plant.drive(0).unwrap().jump(500);
    rig.run(2);
    let latch = Latch { object: Object::Axis(X), edge: Edge::Rising, age_ns: None, position: Some(480) };
    rig.plant.add_latch(latch);
    rig.run(1);
    assert_eq!((rig.int("x.latch.position"), rig.int("x.actual.position")), (-480, -500));
}

/// A motor with swapped leads: with POSDRCT 2 the loop holds it and moves it, raw counts stay raw, and the drive is
/// commanded in the opposite direction. Without POSDRCT 2 the same motor runs away.
///
/// Proves: MACS-DIR-03
#[test]
fn an_inverted_position_feedback_turns_the_output_of_the_loop() {
    for (posdrct, sign) in [(2, 1), (22, 1), (-2, -1), (-22, -1)] {
        let mut rig = Rig::with(closed_here(posdrct), [servo(true), Model::Ideal]);
        rig.enable();
        rig.give(Action::Move(to(X, 30_000)));
        rig.run(500);
        let (asked, moves) = (rig.real("x.output.velocity"), rig.real("x.actual.velocity"));
        assert!(asked * f64::from(sign) < -1_000.0 && moves > 1_000.0, "{posdrct}: {asked} {moves}");
        assert!(rig.real("x.regulator.output") > 0.0);
        rig.run(2_000);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.actual.count")), (30_000, 30_000 * i64::from(sign)));
        assert_eq!((rig.int("x.error"), rig.state("x")), (0, "STANDSTILL"));
    }
    for (posdrct, inverted) in [(1, true), (-1, true), (2, false), (-2, false)] {
        let mut rig = Rig::with(closed_here(posdrct), [servo(inverted), Model::Ideal]);
        rig.enable();
        rig.give(Action::Move(to(X, 30_000)));
        rig.run(2_000);
        assert_eq!(rig.int("x.error"), 10_201, "positive feedback: {posdrct}");
    }
}

/// Proves: MACS-DIR-01
#[test]
fn invalid_posdrct_is_refused_with_message() {
    for (posdrct, sentence) in [
        (
            2,
            "x: posdrct inverts the position loop, which a drive with interface position closes itself; 1, 11, -1 and -11 are allowed",
        ),
        (
            -22,
            "x: posdrct inverts the position loop, which a drive with interface position closes itself; 1, 11, -1 and -11 are allowed",
        ),
    ] {
        assert_eq!(turned(posdrct).check().unwrap_err().to_string(), sentence);
    }
    for posdrct in [12, -21] {
        let text = closed_here(posdrct).check().unwrap_err().to_string();
        assert!(text.contains("both have one encoder"), "{text}");
    }
    assert!(closed_here(-2).check().is_ok());
    let mut rig = Rig::new();
    for (changes, sentence) in [
        (
            &[("posdrct", 2)][..],
            "x: posdrct 2 inverts the position loop, which a drive with interface position closes itself",
        ),
        (&[("posdrct", 21)], "x: posdrct 21 inverts one loop and not the other, and both have one encoder"),
        (&[("posdrct", -1), ("revers", 20)], "x: revers 20 asks for outputs, which tell the sign of a velocity"),
        (&[("posdrct", 3)], "posdrct"),
        (&[("revers", 3)], "revers"),
    ] {
        let refused = set(&mut rig, changes);
        assert!(rig.refusal(refused).contains(sentence), "{}", rig.refusal(refused));
        let macs = rig.machine.parameters(X).unwrap().macs;
        assert_eq!((macs.posdrct, macs.revers), (1, 0), "changes nothing");
    }
}

/// Open loop: speed and direction outputs refer to the motor. A motor with reversed direction and inverted units needs
/// neither inverted.
#[test]
fn an_open_loop_axis_turns_its_motor_as_it_is_wired() {
    for (posdrct, motor_sign, count_sign) in [(1, 1, 1), (-1, -1, -1), (2, -1, 1), (-2, 1, -1)] {
        let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
        let mut config = turned(posdrct);
        config.io = vec![
            io("f", IoKind::DigitalOutput),
            io("b", IoKind::DigitalOutput),
            io("q", IoKind::DigitalOutput),
            io("u", IoKind::AnalogOutput),
        ];
        config.axes[1].interface = Interface::OpenLoop;
        config.axes[1].open_loop = SpeedOutputs { forward: Some(0), backward: Some(1), output: Some(2), dac: Some(3) };
        let law = TwoSpeed::new(50_000_000, 100_000_000, MS).unwrap();
        let motor = Model::TwoSpeed(law).wired(posdrct.abs() == 2);
        let mut rig = Rig::with(config, [motor, Model::Ideal]);
        rig.enable();
        rig.order(X, Order::Speed { velocity: 20_000.0 }).unwrap();
        rig.run(1_000);
        assert_eq!(rig.real("x.output.velocity"), 20_000.0 * f64::from(motor_sign));
        assert_eq!(rig.real("x.command.velocity"), 20_000.0);
        assert!((rig.real("x.actual.velocity") - 20_000.0).abs() < 1e-3);
        assert!(rig.int("x.actual.count") * i64::from(count_sign) > 10_000, "{posdrct}");
        let shown = Switching { forward: true, backward: false, output: true, dac: 4.5 };
        let Machine { state, .. } = &rig.machine;
        let wired = state.axes[1].switching_of(shown);
        let forward = motor_sign > 0;
        assert_eq!((wired.forward, wired.backward, wired.output), (forward, !forward, true));
        assert_eq!(wired.dac, 4.5 * f64::from(motor_sign));
    }
}

/// SYNCFACTM 2048, SYNCFACTS 55, master at 2048 qc: MAPOS is 2048 qc with a positive MENCODER, and 55 MU with a
/// negative one.
///
/// Proves: MACS-UNIT-09, MACS-O-06
#[test]
fn a_negative_mencoder_shows_the_master_in_its_own_units() {
    for (mencoder, position, velocity) in [(512, 2_048.0, 20_480.0), (-512, 55.0, 550.0)] {
        let mut config = config(0);
        let p = &mut config.axes[1].parameters;
        (p.macs.mencoder, p.sync_master, p.sync_slave) = (mencoder, 2_048, 55);
        let mut rig = Rig::of(config);
        rig.enable();
        assert_eq!((rig.real("x.master.position"), rig.real("x.master.velocity")), (0.0, 0.0), "no master yet");
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(0), 0, 0)));
        rig.give(Action::Move(at(0, 20_480.0)));
        rig.run(500);
        assert_eq!(rig.real("x.master.velocity"), velocity);
        rig.give(Action::Move(to(0, 2_048)));
        rig.run(1_000);
        assert_eq!((rig.real("x.master.position"), rig.real("x.master.velocity")), (position, 0.0));
        assert_eq!((rig.int("x.sync.master"), rig.int("x.command.position")), (2_048, 55));
    }
}

/// With a rounded scaling factor every revolution leaves a residue that only a marker corrects; the exact fraction
/// leaves none. 2 pi 60 mm in 1/10 mm is 3769.91.. qc; rounded to 3770 a thousand revolutions are 88.8.. too much.
///
/// Proves: MACS-UNIT-08, MACS-O-07
#[test]
fn a_rounded_factor_drifts_by_its_rounding_and_an_exact_one_does_not() {
    let exact = std::f64::consts::TAU * 60.0 * 10.0;
    assert_eq!((exact.round(), (exact * 100.0).round()), (3_770.0, 376_991.0));
    // Per revolution of the wheel (2000 qc of the master) the slave must move by the circumference, here to 10^-4.
    for (numerator, denominator, after_1000) in [(37_699_112, 2_000 * 10_000, 3_769_911), (3_770, 2_000, 3_770_000)] {
        let mut rig = Rig::enabled();
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(0), numerator, denominator)));
        rig.give(Action::Move(crate::command::Move { velocity: 50_000.0, ..to(0, 2_000 * 1_000) }));
        rig.run(42_000);
        assert_eq!(rig.int("line.command.position"), 2_000_000);
        assert_eq!(rig.int("x.command.position"), after_1000);
    }
    let drift = 3_770.0 * 1_000.0 - exact * 1_000.0;
    assert!((drift - 88.8).abs() < 0.1, "{drift}");
}

/// REG_NORMTRACKERR = 100 * error / (velocity per ms), for any velocity and sign; 0 at rest.
///
/// Proves: MACS-SYS-03
#[test]
fn the_track_error_is_a_share_of_the_command_velocity() {
    let mut config = closed_here(1);
    // velocity / kv: at 10000 inc/s the lag is 600 inc with kv 1: 60 ms, which is 6000 % of 1 ms.
    config.axes[1].parameters.position_loop.kv = crate::regulator::KV;
    let mut rig = Rig::with(config, [Model::Ideal, Model::Ideal]);
    rig.enable();
    assert_eq!(rig.real("x.regulator.track_error"), 0.0);
    for velocity in [10_000.0, -5_000.0] {
        rig.give(Action::Move(at(X, velocity)));
        rig.run(2_000);
        let shown = rig.real("x.regulator.track_error");
        assert!((shown - 6_000.0).abs() < 20.0, "{shown} at {velocity}");
    }
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(2_000);
    assert_eq!(rig.real("x.regulator.track_error"), 0.0);
}

/// Proves: MACS-SYS-04
#[test]
fn sync_status_bits_have_the_numbers_of_the_contract() {
    use crate::sync::status::{ACCURATE, FAULT, MASTER_MARKER_MISSED, READY, SLAVE_MARKER_MISSED};
    assert_eq!([ACCURATE, READY, FAULT, MASTER_MARKER_MISSED, SLAVE_MARKER_MISSED], [1, 2, 4, 8, 16]);
    let mut rig = Rig::enabled();
    let accuracy = set(&mut rig, &[("syncaccuracy", 10)]);
    assert!(rig.was_accepted(accuracy));
    let far = Length::whole(5_000);
    rig.give(Action::Synchronize(crate::command::Synchronize {
        offset: far,
        ..couple(X, Leader::AxisCommand(0), 1, 1)
    }));
    rig.run(5);
    assert_eq!(rig.int("x.sync.status"), 0);
    rig.run(2_000);
    assert_eq!(rig.int("x.sync.status"), 1);
}

//! Compensation together with other functions that read or move the coordinate: repeated homing, marks, other sources,
//! couplings, two drives, power.

use super::*;
use crate::axis::BrakeConfig;
use crate::sim::{Fixtures, Index};

/// The reference is a motor position: repeated homing finds the same one, with any compensation before.
#[test]
fn a_zero_that_is_found_again_is_where_it_was() {
    for method in [19, 20, 33, 34] {
        // At its zero the screw already has an error of 90.
        let mut rig = Rig::of(cell(2, BACKLASH, Some(&[(-40_000, 0), (-1_000, 90), (40_000, 30)])));
        let index = Some(Index { every: 2_000, at: 300 });
        let home_switch = Some((-500, 500));
        rig.plant.drive(0).unwrap().install_fixtures(Fixtures {
            start: -3_000,
            home: home_switch,
            index,
            ..Fixtures::default()
        });
        rig.enable();
        let mut zeros = Vec::new();
        for place in [None, Some(-1_700), Some(-1_700), Some(-1_200)] {
            if let Some(place) = place {
                go(&mut rig, place);
                assert_ne!(compensation(&rig), 0);
            }
            home(&mut rig, method);
            rig.run(100);
            let zero = rig.int("x.actual.count") - compensation(&rig) - rig.int("x.actual.position");
            // Any index pulse may be found.
            zeros.push(if method > 30 { zero.rem_euclid(2_000) } else { zero });
            let cycle = rig.machine.next_cycle();
            assert!(rig.events.iter().all(|event| event.code != Code::FOLLOWING_ERROR), "{cycle}");
        }
        assert!(zeros.windows(2).all(|pair| pair[0] == pair[1]), "method {method}: {zeros:?}");
    }
}

/// During homing nothing is compensated: the detected edge is a position of the motor.
#[test]
fn homing_freezes_compensation() {
    let mut rig = homed(cell(0, BACKLASH, Some(&PITCH)));
    rig.plant.drive(0).unwrap().install_fixtures(Fixtures {
        start: 0,
        home: Some((30_000, 30_500)),
        ..Fixtures::default()
    });
    go(&mut rig, 20_000);
    let goal = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(19) }));
    while rig.done(goal).is_empty() {
        assert_eq!((compensation(&rig), rig.int("x.following_error")), (60, 0));
        rig.run(1);
    }
    rig.run(50);
    // Its first position before the switch, approached from above.
    assert_eq!(rig.int("x.actual.count") - rig.int("x.actual.position") - compensation(&rig), 30_000);
    // The other flank is the zero now: upwards the motor is 40 ahead.
    go(&mut rig, -15_000);
    assert_eq!(compensation(&rig), 0);
    go(&mut rig, 0);
    assert_eq!(compensation(&rig), 40);
}

/// The position of a pulse is that of the load: the motor position less the compensation in that cycle.
#[test]
fn pulses_are_counted_as_before_and_their_places_are_those_of_the_load() {
    let mut config = cell(0, 70, Some(&[(-40_000, 3_000), (0, 0), (40_000, 3_500)]));
    let p = &mut config.axes[1].parameters;
    (p.encoder.monitored, p.encoder.pulses_or_step, p.max_velocity) = (1, 250, 20_000.0);
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 1_000, at: 0 }), ..Fixtures::default() });
    rig.enable();
    home(&mut rig, 35);
    for target in [30_000, 29_000, 31_000, -20_000, 500] {
        rig.give(Action::Move(to(X, target)));
        let mut pulses = rig.int("x.index.count");
        for _ in 0..8_000 {
            let taken = compensation(&rig);
            rig.run(1);
            let now = rig.int("x.index.count");
            if now != pulses {
                let place = rig.int("x.index.position") + taken;
                assert_eq!(place.rem_euclid(1_000), 0, "{place}");
            }
            pulses = now;
        }
        assert_eq!((rig.int("x.actual.position"), rig.int("x.error")), (target, 0));
    }
    assert!(rig.events.iter().all(|event| event.code != Code::WF_PULSES));
}

/// Followers of the axis do not see its compensation; a led axis compensates at its own reversals.
#[test]
fn followers_see_the_load_only() {
    let mut config = cell(0, BACKLASH, Some(&PITCH));
    config.axes[2].parameters.max_following_error = 1;
    let mut rig = homed(config);
    rig.give(Action::Synchronize(couple(Y, Leader::AxisActual(X), 1, 1)));
    rig.run(50);
    rig.mirror();
    let apart = rig.int("y.command.position") - rig.int("x.actual.position");
    for target in [20_000, 15_000, 16_000] {
        go(&mut rig, target);
        assert_eq!(rig.int("y.command.position") - rig.int("x.actual.position"), apart, "{target}");
    }
    rig.give(Action::Halt(AxisSet::one(Y)));
    rig.run(500);
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    rig.run(50);
    let before = compensation(&rig);
    rig.give(Action::Move(to(LINE, -4_000)));
    rig.run(1_500);
    assert_eq!((before, compensation(&rig)), (48, 36 - 40));
    assert_eq!((rig.int("x.actual.position"), rig.int("x.following_error")), (12_000, 0));
}

/// An absolute encoder gives the zero: the compensation is applied before the axis is switched on, and without a step.
#[test]
fn an_absolute_encoder_knows_its_place_at_once() {
    let mut rig = Rig::of(absolute(cell(1, BACKLASH, Some(&[(0, 300), (100_000, 300)]))));
    let mut last = 0;
    for _ in 0..60 {
        rig.run(1);
        let now = compensation(&rig);
        assert!((0..=10).contains(&(now - last)), "{last} to {now}");
        last = now;
    }
    assert_eq!((rig.int("x.homed"), last), (1, 300));
    assert_eq!(rig.int("x.actual.position"), rig.int("x.actual.count") - 300);
    let before = rig.int("x.actual.count");
    rig.enable();
    assert_eq!((rig.int("x.actual.count"), rig.int("x.following_error")), (before, 0));
    let from = rig.int("x.actual.position");
    go(&mut rig, from + 1_000);
    assert_eq!(rig.int("x.actual.count"), before + 1_000);
    go(&mut rig, from);
    // The count of the encoder wraps around.
    assert_eq!(rig.int("x.actual.count"), (before - 40).rem_euclid(8192 * 4096));
}

/// Switched off and on again, and moved by hand in between: nothing moves by itself, and the direction of the last
/// motion is retained.
#[test]
fn power_off_and_on_moves_nothing() {
    let mut rig = homed(cell(4, BACKLASH, Some(&PITCH)));
    go(&mut rig, 20_000);
    go(&mut rig, 10_000);
    rig.mirror();
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(50);
    assert_eq!((rig.int("x.actual.position"), compensation(&rig)), (10_000, -10));
    rig.plant.drive(0).unwrap().jump(2_000);
    rig.run(50);
    // The screw error there is 6 larger, so the position is 11994: 35.982 - 40.
    assert_eq!((rig.int("x.actual.count"), compensation(&rig), rig.int("x.actual.position")), (11_990, -4, 11_994));
    rig.enable();
    rig.run(50);
    assert_eq!((rig.int("x.actual.count"), rig.int("x.command.position")), (11_990, 11_994));
}

/// Both drives of a gantry get the same compensation.
#[test]
fn two_drives_take_up_the_same() {
    let mut config = cell(0, BACKLASH, Some(&PITCH));
    let x = &mut config.axes[usize::from(X)];
    x.second = Some(Capabilities::all(0));
    x.parameters.gantry.max_skew = Some(5);
    x.parameters.assigned.refswitch = 0;
    let mut rig = homed(config);
    for (target, expected) in [(20_000, 60), (10_000, -10), (10_100, 30)] {
        go(&mut rig, target);
        assert_eq!((compensation(&rig), rig.int("x.skew"), rig.int("x.error")), (expected, 0, 0));
        let counts = [rig.int("x.actual.count"), rig.int("x.second.count")];
        assert_eq!((counts, rig.int("x.second.position")), ([target + expected; 2], target));
    }
}

/// A separate encoder that another axis also reads: the other axis sees the motor.
#[test]
fn a_shared_encoder_is_compensated_for_its_axis_alone() {
    let mut config = cell(0, BACKLASH, Some(&PITCH));
    for axis in [1, 2] {
        config.axes[axis].interface = Interface::Velocity;
        config.axes[axis].parameters.max_following_error = 1 << 40;
        config.axes[axis].wired = Wired::Encoder(0);
    }
    let mut rig = Rig::of(config);
    rig.enable();
    home(&mut rig, 35);
    for (target, expected) in [(20_000, 60), (10_000, -10), (20_000, 60)] {
        rig.give(Action::Move(to(X, target)));
        rig.run(3_000);
        assert_eq!((compensation(&rig), rig.int("x.actual.position"), rig.int("x.error")), (expected, target, 0));
        assert_eq!([rig.int("belt.count"), rig.int("y.actual.position")], [target + expected; 2]);
    }
    // A new coordinate of the encoder for both axes: the position on the screw is the same.
    rig.give(Action::SetPosition(SetPosition { axis: X, position: Length::whole(0) }));
    rig.run(20);
    assert_eq!((compensation(&rig), rig.int("x.actual.position"), rig.int("y.actual.position")), (60, 0, 60));
}

/// A drive that homes by itself reaches its reference in the direction of its method: 19 downwards, so that upwards the
/// motor is ahead.
#[test]
fn a_drive_that_homes_by_itself_has_the_sense_of_its_method() {
    for (method, up, down) in [(19, 40, 0), (20, 0, -40)] {
        let mut config = cell(1, BACKLASH, Some(&[(-50_000, 0), (-5_000, 100), (50_000, 100)]));
        config.axes[1].parameters.homing.in_drive = true;
        let mut rig = Rig::of(config);
        rig.plant.drive(0).unwrap().install_fixtures(Fixtures {
            start: -3_000,
            home: Some((-500, 500)),
            ..Fixtures::default()
        });
        rig.enable();
        home(&mut rig, method);
        let first = rig.int("x.actual.position");
        rig.run(60);
        assert_eq!((rig.int("x.following_error"), rig.int("x.actual.position")), (0, first), "{method}");
        for (target, expected) in [(10_000, 100 + up), (8_000, 100 + down)] {
            go(&mut rig, target);
            assert_eq!((compensation(&rig), rig.int("x.actual.count")), (expected, target + expected), "{method}");
        }
        // Homing again from a position with compensation.
        go(&mut rig, -2_000);
        assert_ne!(compensation(&rig), 0);
        home(&mut rig, method);
        rig.run(60);
        assert_eq!(compensation(&rig), 100, "{method}: the flank that it came by");
        go(&mut rig, 10_000);
        assert_eq!(rig.int("x.actual.count"), 10_000 + 100 + up, "{method}");
    }
}

/// 50 ms until the brake is open: nothing is compensated against the brake.
#[test]
fn closed_brake_suspends_compensation() {
    let mut config = cell(0, BACKLASH, None);
    config.io.push(IoConfig { name: "brake".into(), kind: IoKind::DigitalOutput, latch: false });
    let brake = BrakeConfig { output: 1, closes_with_one: false, release_ns: 50_000_000, engage_ns: 30_000_000 };
    config.axes[1].brake = Some(brake);
    let mut rig = Rig::of(config);
    rig.give(Action::Enable(AxisSet::first(3)));
    rig.run(100);
    home(&mut rig, 35);
    go(&mut rig, 1_000);
    go(&mut rig, 500);
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(100);
    assert_eq!((rig.state("x"), compensation(&rig)), ("DISABLED", -40));
    rig.mirror();
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(20);
    set(&mut rig, "compensation.backlash", Value::Int(0));
    let mut held = 0;
    while rig.int("x.enabled") == 0 {
        rig.run(1);
        held += i64::from(compensation(&rig) == -40);
    }
    assert!(held > 20, "{held}");
    rig.run(20);
    assert_eq!((compensation(&rig), rig.int("x.actual.position"), rig.int("x.actual.count")), (0, 500, 500));
}

/// Change of encoder while the axis is off: a soft change keeps position, zero and compensation; a hard change starts
/// all of them again.
#[test]
fn another_source_begins_anew_unless_its_change_is_soft() {
    for (control, position, expected) in [(1, 20_000, 60), (0, 7, 0)] {
        let mut config = cell(0, BACKLASH, Some(&PITCH));
        let axis = &mut config.axes[1];
        axis.interface = Interface::Velocity;
        axis.parameters.max_following_error = 20_000;
        axis.parameters.encoder.enccontrol = control;
        let mut rig = homed(config);
        rig.plant.jump_encoder(0, 7);
        rig.give(Action::Move(to(X, 20_000)));
        rig.run(3_000);
        assert_eq!((rig.int("x.actual.position"), compensation(&rig)), (20_000, 60));
        rig.give(Action::Disable(AxisSet::one(X)));
        rig.run(50);
        rig.mirror();
        set(&mut rig, "encodertype", Value::Int(10));
        for _ in 0..30 {
            rig.run(1);
            assert_eq!(
                (rig.int("x.actual.position"), compensation(&rig)),
                (position, expected),
                "enccontrol {control}"
            );
        }
        assert_eq!(rig.int("x.homed"), control);
        rig.plant.jump_encoder(0, 5);
        rig.run(20);
        assert_eq!((rig.int("x.actual.position"), rig.int("x.actual.count")), (position + 5, 12));
    }
}

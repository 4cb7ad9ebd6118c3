//! Faults with a specific motion: a searched switch or index is missing, or a limit is reached.

use super::super::rig::{LINE, Rig, X, at, couple};
use super::{Fault, Numbers, assign, set};
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::drive::inputs;
use crate::object::Leader;
use crate::parameter::Value;
use crate::sim::{Fixtures, Index};

/// Far outside all travel.
const FAR: i64 = i64::MAX / 4;
/// Longest distance to a switch (inc).
const MOST: i64 = 3_000;
/// A revolution of 500 lines: longest distance to the index (inc).
const REVOLUTION: i64 = 2_000;

/// Runs a homing that cannot find its zero, up to the cycle in which the failure is known. That cycle is determined
/// here by the position alone.
pub(super) fn fail_to_home(rig: &mut Rig, numbers: &mut Numbers, fault: Fault) -> Code {
    assign(rig, "homing.velocity", Value::Real(20_000.0 + numbers.below(60_000) as f64));
    assign(rig, "homing.index_velocity", Value::Real(10_000.0 + numbers.below(20_000) as f64));
    set(rig, "homing.max_distance", MOST);
    let drive = rig.plant.drive(0).expect("x");
    // The axis is at 0; the switch and the index are ahead.
    drive.install_fixtures(Fixtures {
        index: Some(Index { every: REVOLUTION, at: 1 + numbers.below(1_999) as i64 }),
        home: Some((1_500, FAR)),
        ..Fixtures::default()
    });
    let (method, most, code) = match fault {
        Fault::LostIndex => (33 + numbers.below(2) as i8, REVOLUTION, Code::HOMING_INDEX_MISSED),
        Fault::StuckSwitch => ([19, 20, 24][numbers.below(3) as usize], MOST, Code::HOMING_SWITCH_MISSED),
        _ => ([19, 20][numbers.below(2) as usize], MOST, Code::HOMING_AT_LIMIT),
    };
    let from = rig.int("x.actual.position");
    rig.run(1);
    match fault {
        Fault::LostIndex => rig.plant.drive(0).expect("x").lose_index(),
        _ => rig.plant.drive(0).expect("x").set_stuck_inputs(inputs::HOME, 0),
    }
    let home = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(method) }));
    assert!(rig.was_accepted(home), "{fault:?}");
    if fault == Fault::StuckLimit {
        rig.run(5 + numbers.below(25));
        assert_eq!((rig.state("x"), rig.int("x.error")), ("HOMING", 0));
        rig.plant.drive(0).expect("x").set_stuck_inputs(inputs::HOME | inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        rig.run(1);
    } else {
        while (rig.int("x.actual.position") - from).abs() <= most {
            assert_eq!((rig.state("x"), rig.int("x.error")), ("HOMING", 0), "{fault:?} after {most} inc only");
            rig.run(1);
        }
    }
    assert_eq!(rig.done(home).iter().map(|done| done.code).collect::<Vec<_>>(), [code], "its goal ends with it");
    assert_eq!(rig.int("x.homed"), 0);
    rig.plant.drive(0).expect("x").set_stuck_inputs(inputs::HOME | inputs::POSITIVE_LIMIT, 0);
    code
}

/// Runs a motion without a target into a software limit, up to the cycle in which the stop starts. The stop must start
/// in time, and not earlier than necessary.
pub(super) fn run_into_limit(rig: &mut Rig, numbers: &mut Numbers, fault: Fault) -> Code {
    let up = numbers.below(2) == 0;
    let sign = if up { 1.0 } else { -1.0 };
    let velocity = 10_000.0 + numbers.below(80_000) as f64;
    // 1 inc/ms^2: the axis stops within 4050 inc, and needs the same distance to accelerate.
    let room = 9_000 + numbers.below(9_000) as i64;
    let limit = rig.int("x.command.position") + if up { room } else { -room };
    set(rig, if up { "max_position" } else { "min_position" }, limit);
    if fault == Fault::LedIntoLimit {
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        rig.give(Action::Move(at(LINE, sign * velocity)));
    } else {
        rig.give(Action::Move(at(X, sign * velocity)));
    }
    let motion = |rig: &Rig| (rig.int("x.command.position"), rig.real("x.command.velocity").abs());
    let mut before = motion(rig);
    while rig.int("x.error") == 0 {
        let (place, speed) = motion(rig);
        // A coupled axis moves in whole steps: it is half a step further when its stop starts.
        let step = if fault == Fault::LedIntoLimit { speed / 1e3 } else { 0.0 };
        let way = speed * speed / 2e6 - step / 2.0;
        assert!(way <= (limit - place).abs() as f64 + 1.0, "{fault:?}: {speed} inc/s at {place}, the limit is {limit}");
        before = (place, speed);
        rig.run(1);
    }
    // Two cycles later the axis could no longer have stopped before the limit.
    let (place, speed) = before;
    let needed = speed * speed / 2e6 + 2.0 * speed / 1e3 + 2.0;
    assert!((limit - place).abs() as f64 <= needed, "{fault:?}: stops {} before the limit", (limit - place).abs());
    if up { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE }
}

/// Returns the software limit that is set (inc).
pub(super) fn limit(rig: &Rig) -> i64 {
    let p = rig.machine.parameters(X).expect("x");
    p.max_position.or(p.min_position).expect("one of them")
}

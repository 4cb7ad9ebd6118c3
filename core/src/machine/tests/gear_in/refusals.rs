//! Refusals of a pair of positions, and ends of its wait and of its approach.

use super::*;
use crate::event::Number;

/// The line at 20 inc per cycle: the refusal reports a distance that is just accepted. Once the line is at rest, the
/// check takes place at the event.
#[test]
fn too_short_start_distance_is_refused_with_minimum() {
    let mut rig = rig();
    rig.give(line(100_000_000, 20.0));
    rig.run(100);
    let ask = |rig: &mut Rig, distance| {
        let goal = rig.give(geared(1, 1, pair(50_000, 1_000, distance)));
        (goal, rig.answer(goal).err())
    };
    let (goal, refused) = ask(&mut rig, 100);
    let refused = refused.expect("too short");
    assert_eq!((refused.code, refused.asked), (Code::ENGAGE_TOO_SHORT, Number::Count(100)));
    let Number::Count(least) = refused.limit else { panic!("{refused:?}") };
    // A straight distance of 2 * 1000 needs 1.5 / 2000 * 400 = 0.3 of the 0.5; the largest curvature for any distance
    // exceeds 1 / length.
    assert!((800..2_000).contains(&least), "{least}");
    assert_eq!(
        rig.refusal(goal),
        format!(
            "x: start_distance_increments 100 is too short for what the slave may do at the present speed of its leader; {least} is enough"
        )
    );
    // At most a quarter above a distance that is too short.
    let short = least * 4 / 5 - 1;
    assert_eq!(ask(&mut rig, short).1.map(|event| event.code), Some(Code::ENGAGE_TOO_SHORT));
    assert_eq!(ask(&mut rig, least).1, None);
    // Faster than the limit of x.
    rig.give(line(200_000_000, 90.0));
    rig.run(100);
    let fast = rig.give(geared(3, 2, pair(100_000, 1_000, 20_000)));
    assert_eq!(rig.refusal(fast), "x: velocity 135 mm/s exceeds max_velocity 100 mm/s");
}

#[test]
fn a_way_too_short_at_its_moment_ends_the_goal_there() {
    let mut rig = rig();
    let goal = rig.give(geared(1, 1, pair(10_000, 50, 100)));
    assert!(rig.was_accepted(goal));
    rig.give(line(20_000, 20.0));
    rig.run(700);
    let done = rig.done(goal)[0];
    assert_eq!((done.code, done.asked), (Code::ENGAGE_TOO_SHORT, Number::Count(100)));
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("STANDSTILL", 0));
    // No distance is long enough if the slave would have to move back too far to reach the pair.
    let mut rig = rig_of(|axis| axis.parameters.max_acceleration = 1e-3);
    rig.give(line(2_000_000_000, 90.0));
    rig.run(200);
    let none = rig.give(geared(1, 1, pair(1_000_000_000, 50, 100)));
    let refused = rig.refusal(none);
    assert!(refused.starts_with("x: no start distance is enough for what the slave may do"), "{refused}");
}

#[test]
fn a_leader_past_its_start_is_refused_with_what_is_missing() {
    let mut rig = rig();
    rig.give(line(9_000, 20.0));
    rig.run_to("line.command.position", 7_000.0);
    let missing = (real(&rig, LINE) + rig.real("line.command.velocity") / 1e3 - 6_000.0).ceil();
    let goal = rig.give(geared(1, 1, pair(10_000, 3_000, 4_000)));
    assert_eq!(
        rig.refusal(goal),
        format!(
            "x: the leader is past its start already: {missing} of the 4000 increments before master_increments are missing"
        )
    );
    rig.run(500);
    // It is at rest at 9000, and its direction is unknown. If it moves away from the position it may return; if it
    // moves toward it, it is too late.
    let goal = rig.give(geared(1, 1, pair(10_000, 2_000, 4_000)));
    rig.give(line(5_000, 20.0));
    rig.run(400);
    assert_eq!((rig.int("x.sync.waiting"), rig.int("line.command.position")), (goal as i64, 5_000));
    rig.give(line(12_000, 20.0));
    rig.run(600);
    assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (4_000, 1));
    rig.give(line(9_000, 20.0));
    rig.run(500);
    let late = rig.give(geared(1, 1, pair(10_000, 9_000, 4_000)));
    rig.give(line(12_000, 20.0));
    rig.run(500);
    let done = rig.done(late)[0];
    // It was at 9000, and moves by at most 1 in the first cycle.
    assert_eq!((done.code, done.asked, done.limit), (Code::ENGAGE_PASSED, Number::Count(3_001), Number::Count(4_000)));
    // The previous gear continues.
    assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (4_000, 1));
}

/// Revers 2 forbids all backward motion, 1 only that without the master.
#[test]
fn backward_approach_is_refused_by_revers() {
    let with_rule = |rule: i64| match rule {
        1 => rig_of(|axis| axis.parameters.macs.revers = 1),
        _ => rig_of(|axis| axis.parameters.macs.revers = 2),
    };
    for rule in [1, 2] {
        let mut rig = with_rule(rule);
        // It is at rest at 0, and would have to approach from below 0.
        let stands = rig.give(geared(1, 1, pair(10_000, -500, 4_000)));
        assert!(rig.was_accepted(stands));
        rig.give(line(100_000, 20.0));
        rig.run(100);
        let moving = rig.give(geared(1, 1, pair(10_000, -500, 4_000)));
        assert_eq!(rig.refusal(moving), "x: the way to -0.5 mm leads backwards, which revers forbids");
        rig.run(400);
        assert_eq!((rig.done(stands)[0].code, rig.int("x.command.position")), (Code::REVERSE_FORBIDDEN, 0));
        // Forwards all the time.
        let good = rig.give(geared(1, 1, pair(20_000, 2_000, 4_000)));
        rig.run(700);
        assert_eq!((rig.int("x.in_sync"), rig.done(good).len()), (1, 0));
        // With a leader that moves downwards x moves backwards with it.
        let mut rig = with_rule(rule);
        rig.give(line(20_000, 90.0));
        rig.run(400);
        let back = rig.give(geared(1, 1, pair(10_000, -2_000, 4_000)));
        rig.give(line(5_000, 20.0));
        rig.run(1_200);
        if rule == 1 {
            assert_eq!((rig.int("x.command.position"), rig.done(back).len()), (-7_000, 0));
        } else {
            assert_eq!((rig.int("x.command.position"), rig.done(back)[0].code), (0, Code::REVERSE_FORBIDDEN));
        }
    }
}

#[test]
fn cancel_ends_the_wait_and_the_approach() {
    let mut rig = rig();
    let goal = waiting(&mut rig);
    rig.give(Action::Cancel { goal });
    rig.run(3);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.sync.waiting"), rig.state("x")), (Code::CANCELLED, 0, "STANDSTILL"));
    for (disengage, state) in [(Disengage::Stop, "STANDSTILL"), (Disengage::KeepVelocity, "CONTINUOUS_MOTION")] {
        let mut rig = super::rig();
        rig.give(Action::Move(to(X, 1_000)));
        rig.run(500);
        let engage = pair(10_000, 3_000, 4_000);
        let goal = rig.give(Action::Synchronize(Synchronize { engage, disengage, ..couple(X, TO_LINE, 1, 1) }));
        rig.give(line(30_000, 20.0));
        rig.run_to("line.command.position", 8_000.0);
        let speed = rig.real("x.command.velocity");
        // In the middle of the curve: 3 s^2 - 2 s^3 = 1/2 of the velocity of the line.
        assert!((speed - 10_000.0).abs() < 300.0, "{speed}");
        rig.give(Action::Cancel { goal });
        watch(&mut rig, 200, |_| {});
        assert_eq!((rig.done(goal)[0].code, rig.state("x")), (Code::CANCELLED, state));
    }
}

#[test]
fn a_leader_that_is_lost_ends_the_wait_and_stops_the_approach() {
    for approaches in [false, true] {
        let mut rig = rig();
        let engage = pair(2_000, 500, 1_000);
        let coupling = couple(X, Leader::AxisActual(Y), 1, 1);
        let goal = rig.give(Action::Synchronize(Synchronize { engage, ..coupling }));
        if approaches {
            rig.give(Action::Move(at(Y, 10_000.0)));
            rig.run_to("y.actual.position", 1_500.0);
            assert_eq!((rig.int("x.sync.waiting"), rig.int("x.in_sync")), (0, 0));
            assert!(rig.int("x.command.position") > 50);
        }
        rig.modify_inputs = |inputs| inputs.drive[1].online = false;
        rig.run(300);
        let state = if approaches { "ERROR_STOP" } else { "STANDSTILL" };
        assert_eq!((rig.done(goal)[0].code, rig.state("x")), (Code::LEADER_LOST, state));
    }
}

/// A request that cannot be fulfilled is refused.
#[test]
fn what_cannot_wait_is_refused() {
    let mut rig = rig();
    let bad = [
        Synchronize { engage: pair(0, 0, -1), ..couple(X, TO_LINE, 1, 1) },
        Synchronize { engage: pair(i64::MIN, 0, 1), ..couple(X, TO_LINE, 1, 1) },
        Synchronize { engage: pair(0, 0, 1), mode: SyncMode::Velocity, ..couple(X, TO_LINE, 1, 1) },
        Synchronize { engage: Engage::AtEnd, ..couple(X, TO_LINE, 1, 1) },
        Synchronize { engage: Engage::AtPosition { position: 0, turn: None }, ..couple(X, TO_LINE, 1, 1) },
    ];
    for request in bad {
        let goal = rig.give(Action::Synchronize(request));
        assert_eq!(rig.answer(goal).expect_err("no").code, Code::BAD_REQUEST, "{request:?}");
    }
    let ratio = rig.give(geared(0, 1, pair(0, 0, 1)));
    assert_eq!(rig.answer(ratio).expect_err("no").code, Code::BAD_RATIO);
}

//! Superimposed motion, and the override.

use super::rig::{LINE, Rig, X, at, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, BufferMode, Move, MoveMode};
use crate::object::{AxisSet, Leader};
use crate::parameter::Value;
use proptest::prelude::*;

fn over(distance: i64) -> Move {
    Move { mode: MoveMode::Superimposed, ..to(X, distance) }
}

fn position(rig: &Rig) -> f64 {
    rig.int("x.command.position") as f64 + rig.real("x.command.fraction")
}

/// Both motions have half of the limits: 50 mm/s, 0.5 m/s^2. 20000 inc take 0.1 + 0.3 + 0.1 s.
#[test]
fn superimposed_distance_is_added_to_move() {
    let mut rig = Rig::enabled();
    let k = rig.machine.next_cycle();
    let base = rig.give(Action::Move(to(X, 20_000)));
    rig.run(99);
    let added = rig.give(Action::Move(over(5_000)));
    assert!(rig.was_accepted(added));
    rig.run(50);
    // 2500 inc + 50 ms of 50 mm/s, and 0.25 m/s^2 * 50^2 ms^2
    assert!((position(&rig) - (2_500.0 + 2_500.0 + 625.0)).abs() < 1e-6, "{}", position(&rig));
    assert!((rig.real("x.command.velocity") - 75_000.0).abs() < 1e-6);
    assert_eq!(rig.int("x.target.position"), 20_625, "what was added so far is part of the target");
    rig.run(600);
    assert_eq!(position(&rig), 25_000.0);
    assert_eq!(rig.done(added)[0].cycle, k + 100 + 200, "5000 inc take two ramps of 0.1 s");
    assert_eq!(rig.done(base)[0].cycle, k + 500);
    assert_eq!((rig.done(base)[0].code, rig.done(added)[0].code), (Code::NONE, Code::NONE));
}

#[test]
fn it_shifts_a_velocity_and_a_coupling() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(999);
    let before = position(&rig);
    rig.give(Action::Move(over(-1_000)));
    rig.run(1_000);
    // The first of the 1001 cycles is that of the command, in which the active motion continues.
    assert!((position(&rig) - (before + 10_010.0 - 1_000.0)).abs() < 1e-3, "{}", position(&rig));
    assert_eq!(rig.real("x.command.velocity"), 10_000.0);

    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    rig.give(Action::Move(Move { velocity: 20_000.0, ..to(LINE, 30_000) }));
    rig.run(200);
    let added = rig.give(Action::Move(over(500)));
    rig.run(3_000);
    assert_eq!(rig.done(added)[0].code, Code::NONE);
    assert_eq!((rig.int("line.command.position"), position(&rig)), (30_000, 30_500.0));
    assert_eq!((rig.int("x.sync.error"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
}

#[test]
fn at_rest_it_is_a_relative_move() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(over(-700)));
    rig.run(400);
    assert_eq!((position(&rig), rig.done(goal)[0].code, rig.state("x")), (-700.0, Code::NONE, "STANDSTILL"));
}

#[test]
fn superimposed_motion_is_limited_to_remaining_rates() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(Move { velocity: 70_000.0, ..to(X, 30_000) }));
    let fast = rig.give(Action::Move(Move { velocity: 30_001.0, ..over(100) }));
    assert_eq!(rig.refusal(fast), "x: velocity 30.001 mm/s is more than the motion under way leaves: 30 mm/s");
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let goal = rig.give(Action::Move(Move { velocity: bad, ..over(100) }));
        assert!(rig.refusal(goal).contains("a finite number that is not negative is"), "{}", rig.refusal(goal));
    }
    let steep = rig.give(Action::Move(Move { acceleration: 600_000.0, ..over(100) }));
    assert!(rig.refusal(steep).contains("is more than the motion under way leaves: 500 mm/s^2"));
    let good = rig.give(Action::Move(Move { velocity: 30_000.0, ..over(100) }));
    assert!(rig.was_accepted(good));
    let mut rig = Rig::enabled();
    rig.give(Action::Move(Move { velocity: 100_000.0, ..to(X, 30_000) }));
    let nothing = rig.give(Action::Move(over(100)));
    assert!(rig.refusal(nothing).contains("leaves: 0 mm/s"));
}

#[test]
fn its_end_lies_within_the_limits_of_position() {
    let mut rig = Rig::enabled();
    rig.set("max_position", Value::Int(20_000));
    rig.give(Action::Move(to(X, 19_000)));
    let beyond = rig.give(Action::Move(over(1_001)));
    assert_eq!(rig.refusal(beyond), "x: target 20.001 mm exceeds max_position 20 mm");
    let good = rig.give(Action::Move(over(1_000)));
    assert!(rig.was_accepted(good));
    rig.run(1_000);
    assert_eq!(position(&rig), 20_000.0);
}

#[test]
fn a_stop_or_a_new_goal_ends_it_and_its_own_cancel_leaves_the_move() {
    for (other, code) in [
        (Action::Halt(AxisSet::one(X)), Code::HALTED),
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP),
        (Action::Move(to(X, 0)), Code::REPLACED),
    ] {
        let mut rig = Rig::enabled();
        rig.give(Action::Move(to(X, 20_000)));
        rig.run(50);
        let added = rig.give(Action::Move(over(5_000)));
        rig.run(50);
        rig.give(other);
        rig.run(1_000);
        assert_eq!(rig.done(added).iter().map(|event| event.code).collect::<Vec<_>>(), [code]);
        assert_eq!(rig.real("x.command.velocity"), 0.0);
    }
    let mut rig = Rig::enabled();
    let base = rig.give(Action::Move(to(X, 20_000)));
    let added = rig.give(Action::Move(over(5_000)));
    rig.run(100);
    rig.give(Action::Cancel { goal: added });
    rig.run(1_000);
    assert_eq!((rig.done(added)[0].code, rig.done(base)[0].code), (Code::CANCELLED, Code::NONE));
    // After 100 ms it had moved 2500 inc at 50 mm/s, and it took 2500 more to stop.
    assert_eq!(position(&rig), 25_000.0);
}

#[test]
fn the_override_slows_a_goal_down_and_lets_it_go_again() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(Move { velocity: 80_000.0, ..to(X, 100_000) }));
    rig.run(300);
    assert_eq!(rig.real("x.command.velocity"), 80_000.0);
    rig.set("velocity_override", Value::Real(25.0));
    rig.run(300);
    assert_eq!(rig.real("x.command.velocity"), 25_000.0, "a quarter of max_velocity");
    rig.set("velocity_override", Value::Real(0.0));
    rig.run(300);
    assert_eq!((rig.real("x.command.velocity"), rig.state("x")), (0.0, "DISCRETE_MOTION"));
    assert!(rig.done(goal).is_empty(), "it waits");
    rig.set("velocity_override", Value::Real(90.0));
    rig.run(400);
    assert_eq!(rig.real("x.command.velocity"), 80_000.0, "no more than it asked for");
    rig.run(2_000);
    assert_eq!((position(&rig), rig.done(goal)[0].code), (100_000.0, Code::NONE));
}

#[test]
fn the_override_holds_for_velocities_and_for_new_goals() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, -60_000.0)));
    rig.set("velocity_override", Value::Real(50.0));
    rig.run(500);
    assert_eq!((rig.real("x.command.velocity"), rig.int("x.in_velocity")), (-50_000.0, 0));
    rig.set("velocity_override", Value::Real(0.0));
    rig.run(500);
    let goal = rig.give(Action::Move(to(X, 0)));
    rig.run(500);
    assert_eq!((rig.real("x.command.velocity"), rig.state("x")), (0.0, "DISCRETE_MOTION"));
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(2);
    assert_eq!((rig.done(goal)[0].code, rig.state("x")), (Code::HALTED, "STANDSTILL"));
    for share in [-1.0, 100.5, f64::NAN] {
        let refused = rig.set("velocity_override", Value::Real(share));
        assert!(rig.refusal(refused).contains("velocity_override is"), "{share}");
    }
}

#[test]
fn the_override_changes_only_the_motion_below() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(Move { velocity: 50_000.0, ..to(X, 90_000) }));
    rig.run(300);
    rig.give(Action::Move(Move { velocity: 10_000.0, acceleration: 1e5, deceleration: 1e5, ..over(3_000) }));
    rig.run(200);
    let mut before = rig.real("x.command.velocity");
    assert!((before - 60_000.0).abs() < 1e-6);
    rig.set("velocity_override", Value::Real(40.0));
    for _ in 0..1_000 {
        rig.run(1);
        let now = rig.real("x.command.velocity");
        // 0.5 m/s^2 of the move and 0.1 m/s^2 of the superimposed motion.
        assert!((now - before).abs() <= 600.0 + 1e-6, "{before} -> {now}");
        before = now;
    }
    assert_eq!(before, 40_000.0);
    rig.run(2_000);
    assert_eq!(position(&rig), 93_000.0);
}

/// Returns a rig with 1 m/s^2 and this maximum deceleration.
fn with_deceleration(deceleration: f64) -> Rig {
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.max_deceleration = Some(deceleration);
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// Runs for `cycles`; the sum accelerates by at most 1 m/s^2, and decelerates by at most its limit.
fn run_within(rig: &mut Rig, deceleration: f64, cycles: u64) -> Result<(), TestCaseError> {
    for _ in 0..cycles {
        rig.run(1);
        let (velocity, rate) = (rig.real("x.command.velocity"), rig.real("x.command.acceleration"));
        let most = if velocity * rate > 0.0 { 1e6 } else { deceleration };
        prop_assert!(rate.abs() <= most * (1.0 + 1e-9), "{rate} at {velocity} inc/s");
        prop_assert!(velocity.abs() <= 100_000.0 * (1.0 + 1e-9), "{velocity}");
    }
    Ok(())
}

/// A default goal has half of each limit, and so has a default superimposed motion in the same direction: each
/// accelerates with half of 1 m/s^2, and decelerates with half of max_deceleration.
#[test]
fn defaults_share_acceleration_and_deceleration() {
    for deceleration in [0.3e6, 0.5e6, 1e6, 1.5e6, 2e6, 5e6] {
        for (way, velocity_goal, waits) in
            [(1, false, 0), (-1, false, 0), (1, true, 0), (-1, true, 0), (1, false, 1), (-1, false, 2)]
        {
            let mut rig = with_deceleration(deceleration);
            let base = if velocity_goal {
                rig.give(Action::Move(at(X, 50_000.0 * way as f64)))
            } else {
                rig.give(Action::Move(to(X, 40_000 * way)))
            };
            let behind = |at: i64| Move { buffer_mode: BufferMode::BlendingHigh, ..to(X, at * way) };
            let wait = (waits == 1).then(|| rig.give(Action::Move(behind(60_000))));
            rig.run(300);
            let added = rig.give(Action::Move(over(3_000 * way)));
            assert!(rig.was_accepted(added), "{deceleration} {way} {velocity_goal} {waits}");
            let wait = wait.or((waits == 2).then(|| rig.give(Action::Move(behind(60_000)))));
            assert!(wait.is_none_or(|wait| rig.was_accepted(wait)), "{deceleration} {way}");
            let k = rig.machine.next_cycle() - 1 - u64::from(waits == 2);
            run_within(&mut rig, deceleration, 4_000).unwrap();
            // Half of all limits: its profile is a triangle, or reaches 50 mm/s.
            let (up, down) = (0.5e6, deceleration / 2.0);
            let top = (2.0 * 3_000.0 * up * down / (up + down)).sqrt().min(50_000.0);
            let takes = top / up + top / down + (3_000.0 - top * top / 2.0 * (1.0 / up + 1.0 / down)) / top;
            assert_eq!(rig.done(added)[0].cycle, k + (takes * 1_000.0 - 1e-6).ceil() as u64, "{deceleration} {way}");
            if !velocity_goal {
                let end = if wait.is_some() { 60_000 } else { 40_000 };
                assert_eq!(rig.done(base)[0].code, Code::NONE);
                assert!(position(&rig) == (end * way) as f64 || position(&rig) == ((end + 3_000) * way) as f64);
            }
        }
    }
}

/// In opposite directions one motion may decelerate while the sum already accelerates: of 1 m/s^2 a goal with a
/// deceleration of 0.75 m/s^2 leaves 0.25, one with 1 m/s^2 leaves nothing.
#[test]
fn against_the_motion_under_way_the_lower_limit_holds() {
    let mut rig = with_deceleration(1.5e6);
    rig.give(Action::Move(to(X, 40_000)));
    rig.run(300);
    let steep = rig.give(Action::Move(Move { acceleration: 260_000.0, ..over(-3_000) }));
    assert!(rig.refusal(steep).ends_with("leaves: 250 mm/s^2"), "{}", rig.refusal(steep));
    let steep = rig.give(Action::Move(Move { deceleration: 510_000.0, ..over(-3_000) }));
    assert!(rig.refusal(steep).ends_with("leaves: 500 mm/s^2"), "{}", rig.refusal(steep));
    let added = rig.give(Action::Move(over(-3_000)));
    assert!(rig.was_accepted(added));
    run_within(&mut rig, 1.5e6, 3_000).unwrap();
    assert_eq!((position(&rig), rig.done(added)[0].code), (37_000.0, Code::NONE));
    let mut rig = with_deceleration(2e6);
    rig.give(Action::Move(to(X, 40_000)));
    rig.run(300);
    let against = rig.give(Action::Move(over(-3_000)));
    assert!(rig.refusal(against).ends_with("leaves: 0 mm/s^2"), "{}", rig.refusal(against));
    // A goal in the opposite direction that would wait for it also exceeds the limit.
    let along = rig.give(Action::Move(over(3_000)));
    assert!(rig.was_accepted(along));
    let back = rig.give(Action::Move(Move { buffer_mode: BufferMode::Buffered, ..to(X, 0) }));
    assert!(rig.refusal(back).contains("leaves: 0 mm/s^2"), "{}", rig.refusal(back));
}

/// max_acceleration 3 m/s^2, max_deceleration 1 m/s^2. A goal with a deceleration of 0.5 m/s^2 leaves what its
/// acceleration does not use. This also applies at constant velocity, because the goal may accelerate again. Here the
/// override causes this, while an opposite superimposed motion decelerates: 0.9 and 0.1 m/s^2 are all of the lower
/// limit.
#[test]
fn against_a_goal_that_has_its_velocity_its_acceleration_counts() {
    let cruising = |acceleration: f64| {
        let mut config = config(0);
        let p = &mut config.axes[usize::from(X)].parameters;
        (p.max_acceleration, p.max_deceleration) = (3e6, Some(1e6));
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(Move { acceleration, deceleration: 0.5e6, ..to(X, 500_000) }));
        rig.run(700);
        assert_eq!((rig.real("x.command.velocity"), rig.real("x.command.acceleration")), (50_000.0, 0.0));
        rig
    };
    for acceleration in [1e6, 1.5e6] {
        let mut rig = cruising(acceleration);
        let against = rig.give(Action::Move(over(-20_000)));
        assert!(rig.refusal(against).ends_with("leaves: 0 mm/s^2"), "{}", rig.refusal(against));
        let along = rig.give(Action::Move(over(20_000)));
        assert!(rig.was_accepted(along));
    }
    let mut rig = cruising(0.9e6);
    let against = rig.give(Action::Move(over(-20_000)));
    assert!(rig.was_accepted(against));
    let mut most: f64 = 0.0;
    for cycle in 0..2_000 {
        match cycle {
            // At 5 mm/s it needs 0.5 s to the target, and 50 ms to decelerate from 1.1 s on.
            150 => _ = rig.set("velocity_override", Value::Real(10.0)),
            1_120 => _ = rig.set("velocity_override", Value::Real(100.0)),
            _ => rig.run(1),
        }
        let rate = rig.real("x.command.acceleration").abs();
        assert!(rate <= 1e6 * (1.0 + 1e-9), "{rate} in cycle {cycle}");
        most = most.max(rate);
    }
    assert_eq!((rig.done(against)[0].code, (most / 1e3).round()), (Code::NONE, 1_000.0));
}

/// A coupling keeps its share of the limits: a superimposed motion has half of the lower limit by default.
#[test]
fn a_coupling_leaves_half_to_the_defaults() {
    for deceleration in [0.4e6, 1e6, 2e6, 5e6] {
        let mut rig = with_deceleration(deceleration);
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        rig.give(Action::Move(Move { velocity: 20_000.0, acceleration: 2e5, deceleration: 2e5, ..to(LINE, 30_000) }));
        rig.run(200);
        let added = rig.give(Action::Move(over(500)));
        assert!(rig.was_accepted(added), "{deceleration}");
        run_within(&mut rig, deceleration, 3_000).unwrap();
        assert_eq!((rig.done(added)[0].code, position(&rig)), (Code::NONE, 30_500.0), "{deceleration}");
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// With any superimposed motions on goals and any waiting goals, the sum keeps the limits.
    #[test]
    fn the_sum_keeps_acceleration_and_deceleration(
        deceleration in prop_oneof![0.2e6..6e6_f64, Just(1e6), Just(2e6)],
        steps in prop::collection::vec((0_u8..4, -20_000_i64..20_000, 0.0..1.2_f64, 0.0..1.2_f64, 1_u64..400), 1..10),
    ) {
        let mut rig = with_deceleration(deceleration);
        for (what, way, speeding, slowing, cycles) in steps {
            let rates = |goal: Move| Move {
                velocity: 40_000.0,
                acceleration: if speeding < 0.4 { 0.0 } else { 1e6 * (speeding - 0.3) },
                deceleration: if slowing < 0.4 { 0.0 } else { deceleration * (slowing - 0.3) },
                ..goal
            };
            let waits = Move { buffer_mode: BufferMode::BlendingLow, ..to(X, way) };
            match what {
                0 if rig.state("x") == "STANDSTILL" => _ = rig.give(Action::Move(rates(to(X, way)))),
                0 | 1 => _ = rig.give(Action::Move(rates(waits))),
                _ => _ = rig.give(Action::Move(rates(over(way)))),
            }
            run_within(&mut rig, deceleration, cycles)?;
        }
        run_within(&mut rig, deceleration, 2_000)?;
    }
}

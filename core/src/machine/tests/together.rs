//! Several functions at once: waiting goals, superimposed motion, the override, limits that change, streams.

use super::rig::{Rig, X, at, cases, config, to};
use crate::code::Code;
use crate::command::{Action, BufferMode, Move, MoveMode};
use crate::modulo::{Direction, Modulo};
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::position::{Length, Position};
use proptest::prelude::*;

fn share(rig: &mut Rig, percent: f64) {
    let sequence = rig.set("velocity_override", Value::Real(percent));
    assert!(rig.was_accepted(sequence));
}

/// 50 mm/s with 1 m/s^2.
fn quick(position: i64) -> Move {
    Move { velocity: 50_000.0, acceleration: 1e6, deceleration: 1e6, ..to(X, position) }
}

fn over(distance: i64) -> Move {
    Move { mode: MoveMode::Superimposed, ..to(X, distance) }
}

fn after(buffer_mode: BufferMode, goal: Move) -> Action {
    Action::Move(Move { buffer_mode, ..goal })
}

fn position(rig: &Rig) -> f64 {
    rig.int("x.command.position") as f64 + rig.real("x.command.fraction")
}

fn velocity(rig: &Rig) -> f64 {
    rig.real("x.command.velocity")
}

fn codes(rig: &Rig, sequence: u64) -> Vec<Code> {
    rig.done(sequence).iter().map(|event| event.code).collect()
}

/// New position limits must allow all planned motion.
#[test]
fn limit_that_excludes_waiting_goal_is_refused() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(quick(10_000)));
    rig.give(after(BufferMode::Buffered, quick(30_000)));
    rig.give(after(BufferMode::Buffered, quick(-5_000)));
    let high = rig.set("max_position", Value::Int(29_999));
    assert!(rig.refusal(high).contains("max_position"), "{}", rig.refusal(high));
    let low = rig.set("min_position", Value::Int(-4_999));
    assert!(rig.refusal(low).contains("min_position"), "{}", rig.refusal(low));
    for (key, value) in [("max_position", 30_000), ("min_position", -5_000)] {
        let good = rig.set(key, Value::Int(value));
        assert!(rig.was_accepted(good), "{key}");
    }
    rig.run(3_000);
    assert_eq!((rig.state("x"), position(&rig)), ("STANDSTILL", -5_000.0));
}

#[test]
fn no_limit_is_set_that_leaves_out_a_superimposed_motion() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(to(X, 20_000)));
    rig.run(50);
    rig.give(Action::Move(over(5_000)));
    let refused = rig.set("max_position", Value::Int(24_999));
    assert!(rig.refusal(refused).contains("max_position"));
    let good = rig.set("max_position", Value::Int(25_000));
    assert!(rig.was_accepted(good));
    rig.run(2_000);
    assert_eq!((rig.state("x"), position(&rig)), ("STANDSTILL", 25_000.0));
}

#[test]
fn no_limit_is_set_that_leaves_out_a_goal_that_is_held() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(quick(20_000)));
    rig.run(100);
    share(&mut rig, 0.0);
    rig.run(300);
    assert_eq!(velocity(&rig), 0.0);
    let refused = rig.set("max_position", Value::Int(19_999));
    assert!(rig.refusal(refused).contains("max_position"));
    share(&mut rig, 100.0);
    rig.run(1_000);
    assert_eq!((codes(&rig, goal), position(&rig)), (vec![Code::NONE], 20_000.0));
}

/// A goal that waits for one at rest outside its window must be allowed, too.
#[test]
fn no_limit_is_set_that_leaves_out_what_waits_for_the_window() {
    let mut rig = Rig::enabled();
    rig.set("in_position_window", Value::Int(5));
    rig.set("in_position_time", Value::Int(500_000_000));
    rig.give(Action::Move(quick(100)));
    rig.give(after(BufferMode::Buffered, quick(30_000)));
    rig.run(200);
    assert_eq!((position(&rig), rig.int("x.in_position")), (100.0, 0));
    let refused = rig.set("max_position", Value::Int(29_999));
    assert!(rig.refusal(refused).contains("max_position"));
}

/// The move ends while the superimposed motion is between two increments.
#[test]
fn a_superimposed_motion_that_outlasts_the_move_ends_on_its_increment() {
    for distance in [5_000, 5_001, 4_999, -5_001] {
        let mut rig = Rig::enabled();
        let base = rig.give(Action::Move(Move { velocity: 50_000.0, ..to(X, 5_000) }));
        let added = rig.give(Action::Move(Move { velocity: 7_777.7, ..over(distance) }));
        let mut before = (position(&rig), velocity(&rig));
        for cycle in 0..1_500 {
            rig.run(1);
            let now = (position(&rig), velocity(&rig));
            let way = now.0 - before.0 - 0.0005 * (now.1 + before.1);
            assert!(way.abs() < 0.55, "off by {way} in cycle {cycle}: {before:?} {now:?}");
            before = now;
        }
        assert_eq!(position(&rig), (5_000 + distance) as f64);
        assert_eq!((codes(&rig, base), codes(&rig, added)), (vec![Code::NONE], vec![Code::NONE]));
    }
}

#[test]
fn goals_and_superimposed_motion_together_keep_the_limits_of_position() {
    let limited = || {
        let mut rig = Rig::enabled();
        rig.set("max_position", Value::Int(20_000));
        rig
    };
    // The goal first, then the superimposed motion.
    let mut rig = limited();
    rig.give(Action::Move(to(X, 10_000)));
    rig.give(after(BufferMode::Buffered, to(X, 20_000)));
    let refused = rig.give(Action::Move(Move { velocity: 5_000.0, ..over(3_000) }));
    assert!(rig.refusal(refused).contains("exceeds max_position 20 mm"), "{}", rig.refusal(refused));
    // The superimposed motion first, then the goal.
    let mut rig = limited();
    rig.give(Action::Move(to(X, 10_000)));
    rig.give(Action::Move(Move { velocity: 5_000.0, ..over(3_000) }));
    let refused = rig.give(after(BufferMode::Buffered, to(X, 17_001)));
    assert!(rig.refusal(refused).contains("exceeds max_position 20 mm"), "{}", rig.refusal(refused));
    let good = rig.give(after(BufferMode::BlendingHigh, to(X, 17_000)));
    assert!(rig.was_accepted(good));
    rig.run(2_000);
    assert_eq!((codes(&rig, good), rig.state("x")), (vec![Code::NONE], "STANDSTILL"));
    assert!(position(&rig) <= 20_000.0);
}

#[test]
fn what_was_streamed_long_ago_does_not_move_an_axis_that_the_override_releases() {
    let mut rig = Rig::enabled();
    rig.stream(X, 20_000.0);
    rig.run(20);
    share(&mut rig, 0.0);
    rig.run(3_000);
    assert_eq!((velocity(&rig), rig.state("x")), (0.0, "STANDSTILL"));
    let before = position(&rig);
    share(&mut rig, 100.0);
    rig.run(500);
    assert_eq!((position(&rig), velocity(&rig)), (before, 0.0));
}

#[test]
fn a_streamed_zero_ends_at_standstill() {
    let mut rig = Rig::enabled();
    rig.stream(X, 20_000.0);
    rig.run(20);
    rig.stream(X, 0.0);
    rig.run(2_000);
    assert_eq!((velocity(&rig), rig.state("x")), (0.0, "STANDSTILL"));
}

#[test]
fn a_setpoint_beside_a_superimposed_motion_counts_it_once() {
    let mut rig = Rig::enabled();
    rig.stream(X, 20_000.0);
    rig.run(60);
    rig.give(Action::Move(Move { velocity: 20_000.0, ..over(20_000) }));
    rig.run(30);
    let before = velocity(&rig);
    rig.stream(X, 20_000.0);
    rig.run(1);
    assert!((velocity(&rig) - before).abs() <= 2_000.0, "from {before} to {}", velocity(&rig));
    // Together with 20 mm/s, 90 mm/s would exceed the limit.
    rig.stream(X, 90_000.0);
    for _ in 0..90 {
        rig.run(1);
        assert!(velocity(&rig) <= 100_000.0, "{}", velocity(&rig));
    }
}

#[test]
fn a_velocity_that_is_held_is_not_reached() {
    let mut rig = Rig::enabled();
    share(&mut rig, 0.0);
    let first = rig.give(Action::Move(at(X, 30_000.0)));
    let second = rig.give(after(BufferMode::Buffered, quick(5_000)));
    rig.run(500);
    assert_eq!((rig.done(first).len(), rig.done(second).len()), (0, 0), "both wait");
    share(&mut rig, 100.0);
    rig.run(2_000);
    assert_eq!((codes(&rig, first), codes(&rig, second)), (vec![Code::NONE], vec![Code::NONE]));
    assert_eq!(position(&rig), 5_000.0);
}

/// With limited jerk it takes more than v^2 / 2a to stop.
#[test]
fn no_motion_reverses_with_any_profile_shape() {
    for profile in 0..3 {
        for distance in (1_000..9_000).step_by(250) {
            let mut config = config(0);
            let axis = &mut config.axes[usize::from(X)];
            (axis.parameters.max_jerk, axis.parameters.profile) = (Some(2e7), profile);
            axis.modulo = Modulo::new(36_000, 1);
            let mut rig = Rig::of(config);
            rig.enable();
            rig.give(Action::Move(at(X, 80_000.0)));
            rig.run(600);
            let wanted = (rig.int("x.modulo.position") + distance) % 36_000;
            let goal = rig.give(Action::Move(Move { direction: Direction::Positive, ..to(X, wanted) }));
            for _ in 0..2_000 {
                rig.run(1);
                assert!(velocity(&rig) >= 0.0, "profile {profile}: {distance} inc ahead it turns");
            }
            assert_eq!((codes(&rig, goal), rig.int("x.modulo.position")), (vec![Code::NONE], wanted));
        }
    }
}

/// Both motions together keep the override's share of max_velocity, in any order.
#[test]
fn an_override_holds_for_the_sum() {
    let most = |rig: &mut Rig, cycles: u32| {
        (0..cycles).fold(0.0_f64, |most, _| {
            rig.run(1);
            most.max(velocity(rig).abs())
        })
    };
    // The override is set in motion.
    let mut rig = Rig::enabled();
    let base = rig.give(Action::Move(to(X, 60_000)));
    let added = rig.give(Action::Move(over(30_000)));
    rig.run(200);
    assert_eq!(velocity(&rig), 100_000.0);
    share(&mut rig, 40.0);
    rig.run(300);
    let reached = most(&mut rig, 100);
    assert!((39_999.0..=40_000.001).contains(&reached), "{reached}");
    share(&mut rig, 0.0);
    rig.run(300);
    assert_eq!((velocity(&rig), rig.done(added).len(), rig.done(base).len()), (0.0, 0, 0));
    let before = position(&rig);
    rig.run(300);
    assert_eq!(position(&rig), before);
    share(&mut rig, 100.0);
    rig.run(3_000);
    assert_eq!((codes(&rig, base), codes(&rig, added)), (vec![Code::NONE], vec![Code::NONE]));
    assert_eq!(position(&rig), 90_000.0);
    // The override is set before the motion.
    let mut rig = Rig::enabled();
    share(&mut rig, 40.0);
    rig.give(Action::Move(to(X, 60_000)));
    rig.run(200);
    assert_eq!(velocity(&rig), 40_000.0);
    let added = rig.give(Action::Move(over(5_000)));
    assert!(rig.was_accepted(added));
    let reached = most(&mut rig, 3_000);
    assert!(reached <= 40_000.001, "{reached}");
    assert_eq!((codes(&rig, added), position(&rig)), (vec![Code::NONE], 65_000.0));
}

#[test]
fn a_target_behind_a_velocity_is_checked_at_once() {
    let mut rig = Rig::enabled();
    rig.set("max_position", Value::Int(20_000));
    rig.give(Action::Move(at(X, 1_000.0)));
    let refused = rig.give(after(BufferMode::Buffered, quick(20_001)));
    assert_eq!(rig.refusal(refused), "x: target 20.001 mm exceeds max_position 20 mm");
}

/// 100 inc before the passage it is too late to decelerate to 10 mm/s: the axis moves on to the target and decelerates
/// after it.
#[test]
fn an_override_shortly_before_a_passage_turns_nothing_back() {
    for (profile, percent) in [(0, 10.0), (0, 0.0), (1, 10.0), (1, 0.0), (2, 10.0), (2, 0.0)] {
        let mut config = config(0);
        let p = &mut config.axes[usize::from(X)].parameters;
        (p.max_jerk, p.profile) = (Some(2e8), profile);
        let mut rig = Rig::of(config);
        rig.enable();
        let first = rig.give(Action::Move(quick(20_000)));
        let second = rig.give(after(BufferMode::BlendingPrevious, quick(40_000)));
        while position(&rig) < 19_900.0 {
            rig.run(1);
        }
        share(&mut rig, percent);
        let mut before = position(&rig);
        for _ in 0..1_000 {
            rig.run(1);
            assert!(position(&rig) >= before - 1.0, "profile {profile}, {percent} %: back at {before}");
            before = position(&rig);
        }
        share(&mut rig, 100.0);
        rig.run(1_000);
        assert_eq!((codes(&rig, first), codes(&rig, second)), (vec![Code::NONE], vec![Code::NONE]));
        assert_eq!(position(&rig), 40_000.0);
    }
}

/// A motion that accelerates with high jerk overshoots with a lower one.
#[test]
fn a_superimposed_motion_that_is_replaced_keeps_the_sum_within_the_limits() {
    let mut config = config(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.max_jerk, p.profile) = (Some(2e8), 2);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Move(Move { velocity: 60_000.0, acceleration: 3e5, deceleration: 3e5, ..to(X, 600_000) }));
    rig.run(500);
    let full = Move { velocity: 40_000.0, acceleration: 7e5, deceleration: 7e5, ..over(50_000) };
    rig.give(Action::Move(full));
    rig.run(45);
    let replaced = rig.give(Action::Move(Move { jerk: 1e6, ..full }));
    assert!(rig.was_accepted(replaced));
    for _ in 0..1_000 {
        rig.run(1);
        assert!(velocity(&rig) <= 100_000.001, "{}", velocity(&rig));
    }
}

/// Without max_jerk a goal may have any finite jerk.
#[test]
fn any_jerk_of_a_goal_makes_a_profile() {
    for jerk in [1e-6, 1e-3, 1.0, 1e9, 1e15, 1.1e15, 1e300, f64::MAX] {
        let mut config = config(0);
        config.axes[usize::from(X)].parameters.profile = 2;
        config.axes[usize::from(X)].parameters.jerk_times = [0, 1, 10_000_000_000];
        let mut rig = Rig::of(config);
        rig.enable();
        let goal = rig.give(Action::Move(Move { jerk, ..to(X, 10_000) }));
        let mut before = (0.0, 0.0);
        for cycle in 0..2_000 {
            rig.run(1);
            let now = (position(&rig), velocity(&rig));
            assert!(now.1.is_finite() && rig.real("x.command.acceleration").is_finite(), "jerk {jerk} cycle {cycle}");
            assert!((now.1 - before.1).abs() <= 1_001.0, "jerk {jerk} cycle {cycle}: {before:?} {now:?}");
            let way = now.0 - before.0 - 0.0005 * (now.1 + before.1);
            assert!(way.abs() <= 1.5, "jerk {jerk} cycle {cycle}: {before:?} {now:?}");
            before = now;
        }
        if jerk > 1e15 {
            assert!(rig.refusal(goal).contains("exceeds max_jerk"), "{}", rig.refusal(goal));
        } else if jerk >= 1e3 {
            assert_eq!(position(&rig), 10_000.0, "jerk {jerk}");
        }
    }
}

/// Returns random chains of goals within the limits, with their buffer modes and delays.
fn chain() -> impl Strategy<Value = Vec<(Move, BufferMode, u64)>> {
    use BufferMode::{BlendingHigh, BlendingLow, BlendingNext, BlendingPrevious, Buffered};
    let modes = prop::sample::select(vec![Buffered, BlendingLow, BlendingPrevious, BlendingNext, BlendingHigh]);
    let rate = |most: f64| prop_oneof![Just(0.0), Just(most), (0.1..1.0_f64).prop_map(move |share| share * most)];
    let target = prop_oneof![3 => -20_000_i64..=20_000, 1 => -20_i64..20, 1 => Just(20_000), 1 => Just(-20_000)];
    let goal = (target, any::<bool>(), (rate(1e5), rate(1e6), rate(1e6), rate(2e7))).prop_map(
        |(target, relative, (velocity, acceleration, deceleration, jerk))| {
            let mode = if relative { MoveMode::Additive } else { MoveMode::Absolute };
            Move { mode, velocity, acceleration, deceleration, jerk, ..to(X, target) }
        },
    );
    prop::collection::vec((goal, modes, prop_oneof![Just(0), 0_u64..60, 0_u64..600]), 1..10)
}

proptest! {
    #![proptest_config(cases(300))]

    /// A chain of goals within the limits reaches all its targets, in order, and no limit.
    #[test]
    fn every_goal_of_a_chain_is_reached(
        shape in 0_i64..3,
        modulo in any::<bool>(),
        posdrct in prop::sample::select(vec![1_i64, -1]),
        revers in prop::sample::select(vec![0_i64, 0, 2]),
        goals in chain(),
    ) {
        let mut config = config(0);
        let axis = &mut config.axes[usize::from(X)];
        let p = &mut axis.parameters;
        (p.max_jerk, p.profile) = (Some(2e7), shape);
        (p.macs.posdrct, p.macs.revers) = (posdrct, revers);
        (p.min_position, p.max_position) = (Some(-20_000), Some(20_000));
        if modulo {
            axis.modulo = Modulo::new(36_000, 1);
        }
        let mut rig = Rig::of(config);
        rig.enable();
        let mut given = Vec::new();
        for (goal, mode, cycles) in goals {
            let number = rig.give(after(mode, goal));
            given.push(number);
            for _ in 0..cycles {
                rig.run(1);
                prop_assert!(position(&rig).abs() <= 20_000.0);
            }
        }
        for _ in 0..12_000 {
            rig.run(1);
            prop_assert!(position(&rig).abs() <= 20_000.0, "{}", position(&rig));
        }
        prop_assert_eq!(rig.state("x"), "STANDSTILL");
        let accepted: Vec<u64> = given.into_iter().filter(|&goal| {
            rig.events.iter().any(|event| event.command == goal && event.kind == crate::event::Kind::Accepted)
        }).collect();
        let ends: Vec<(u64, Code)> = rig.events.iter()
            .filter(|event| event.kind == crate::event::Kind::Done && accepted.contains(&event.command))
            .map(|event| (event.command, event.code)).collect();
        let expected: Vec<_> = accepted.iter().map(|&goal| (goal, Code::NONE)).collect();
        prop_assert_eq!(ends, expected);
    }
}

/// These goals give a plan that exceeds the limit by 4e-5 inc due to rounding: below the lower limit that would be a
/// whole increment.
#[test]
fn rounding_leads_nothing_beyond_a_limit() {
    for way in [1, -1] {
        let mut config = config(0);
        let p = &mut config.axes[usize::from(X)].parameters;
        (p.max_jerk, p.profile) = (Some(2e7), 2);
        (p.min_position, p.max_position) = (Some(-20_000), Some(20_000));
        let mut rig = Rig::of(config);
        rig.enable();
        let back = Move {
            mode: MoveMode::Additive,
            velocity: 76_753.132_905_642_91,
            jerk: 2_181_706.284_522_271,
            ..to(X, -107 * way)
        };
        rig.give(after(BufferMode::Buffered, to(X, 0)));
        rig.give(after(BufferMode::Buffered, to(X, 20_000 * way)));
        rig.give(after(BufferMode::Buffered, back));
        let last = rig.give(after(BufferMode::BlendingPrevious, to(X, -20_000 * way)));
        for _ in 0..6_000 {
            rig.run(1);
            assert!(position(&rig).abs() <= 20_000.0, "{}", position(&rig));
            assert!(rig.int("x.output.position").abs() <= 20_000);
        }
        assert_eq!(codes(&rig, last), vec![Code::NONE]);
    }
}

/// Blending at the end of the position range.
#[test]
fn goals_pass_into_each_other_at_the_end_of_all_positions() {
    let mut rig = Rig::enabled();
    let last = Position::LIMIT - 1;
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(3);
    rig.plant.drive(0).unwrap().jump(last - 60_000);
    rig.run(2);
    rig.enable();
    assert_eq!(rig.int("x.command.position"), last - 60_000);
    let first = rig.give(Action::Move(quick(last - 30_000)));
    let second = rig.give(after(BufferMode::BlendingHigh, quick(last)));
    let third = Move { mode: MoveMode::Relative, target: Length::whole(i64::MAX), ..quick(0) };
    let third = rig.give(after(BufferMode::Buffered, third));
    assert!(rig.refusal(third).contains("is outside"));
    rig.run(4_000);
    assert_eq!((codes(&rig, first), codes(&rig, second)), (vec![Code::NONE], vec![Code::NONE]));
    assert_eq!(rig.int("x.command.position"), last);
}

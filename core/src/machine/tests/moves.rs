use super::rig::{LINE, Rig, X, at, config, to};
use crate::code::Code;
use crate::command::{Action, Move, MoveMode};
use crate::position::{Length, Position};
use proptest::prelude::*;

/// 10 mm with the defaults: 50 mm/s, 500 mm/s^2: ramps of 100 ms and 2.5 mm each, 5 mm at constant velocity: 300 ms.
///
/// Proves: MACS-PROF-06, MACS-TGT-01
#[test]
fn a_move_shows_first_in_the_next_cycle_and_is_there_after_its_duration() {
    let mut rig = Rig::enabled();
    let sequence = rig.give(Action::Move(to(X, 10_000)));
    assert!(rig.was_accepted(sequence));
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("DISCRETE_MOTION", 0));
    assert_eq!(rig.int("x.target.position"), 10_000);
    rig.run(1);
    assert!(rig.real("x.command.velocity") > 0.0);
    rig.run(298);
    assert!(rig.int("x.command.position") < 10_000 && rig.done(sequence).is_empty());
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("STANDSTILL", 10_000));
    assert_eq!((rig.real("x.command.velocity"), rig.int("x.in_position")), (0.0, 1));
    let done = rig.done(sequence);
    assert_eq!((done.len(), done[0].code, done[0].position), (1, Code::NONE, Position::whole(10_000)));
}

#[test]
fn the_drive_answers_after_its_delay_and_the_following_error_knows_it() {
    for delay in [0, 1, 4] {
        let mut rig = Rig::of(config(delay));
        rig.enable();
        let mut commands = Vec::new();
        rig.give(Action::Move(to(X, 50_000)));
        for _ in 0..300 {
            commands.push(rig.int("x.command.position"));
            rig.run(1);
            assert_eq!(rig.int("x.following_error"), 0, "delay {delay}");
            if let Some(past) = commands.len().checked_sub(1 + delay as usize) {
                assert_eq!(rig.int("x.actual.position"), commands[past], "delay {delay}");
            }
            let error = rig.int("x.command.position") - rig.int("x.actual.position");
            assert_eq!(rig.int("x.regulator.error"), error);
        }
    }
}

#[test]
fn a_new_target_in_motion_takes_over_and_the_old_goal_ends_as_replaced() {
    let mut rig = Rig::enabled();
    let first = rig.give(Action::Move(to(X, 50_000)));
    rig.run(200);
    let second = rig.give(Action::Move(to(X, -3_000)));
    assert_eq!(rig.done(first)[0].code, Code::REPLACED);
    rig.run_until("x.state", 1);
    assert_eq!(rig.int("x.command.position"), -3_000);
    assert_eq!(rig.done(second)[0].code, Code::NONE);
    assert_eq!(rig.done(first).len(), 1);
}

/// Proves: MACS-UNIT-05, MACS-CMD-03
#[test]
fn relative_moves_of_a_third_of_an_increment_do_not_drift() {
    let mut rig = Rig::enabled();
    let third = Position::from_f64(10.0 / 3.0);
    let target = Length { nearest: 3, rest: third - Position::whole(3) };
    let step = Move { mode: MoveMode::Relative, target, ..to(X, 0) };
    for k in 1..=300_i64 {
        rig.give(Action::Move(step));
        rig.run_until("x.state", 1);
        assert_eq!(rig.int("x.command.position"), (k * 10 + 1) / 3, "move {k}");
    }
}

#[test]
fn additive_counts_from_the_target_and_relative_from_the_command() {
    for (mode, end) in [(MoveMode::Additive, 15_000), (MoveMode::Relative, 5_000 + 2_500)] {
        let mut rig = Rig::enabled();
        rig.give(Action::Move(to(X, 10_000)));
        rig.run(100); // 100 ms at 500 mm/s^2: 2.5 mm
        assert_eq!(rig.int("x.command.position"), 2_500);
        // The command applies at the next cycle: 50 inc further, at 50 mm/s.
        rig.give(Action::Move(Move { mode, ..to(X, 5_000) }));
        rig.run_until("x.state", 1);
        let moved = if mode == MoveMode::Relative { 50 } else { 0 };
        assert_eq!(rig.int("x.command.position"), end + moved, "{mode:?}");
    }
}

#[test]
fn a_velocity_goal_stays_open_and_a_velocity_of_zero_ends_it() {
    let mut rig = Rig::enabled();
    let sequence = rig.give(Action::Move(at(X, -20_000.0)));
    rig.run(100);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("CONTINUOUS_MOTION", -20_000.0));
    assert_eq!((rig.int("x.in_velocity"), rig.int("x.reference")), (1, 2));
    rig.run(10_000);
    assert!(rig.done(sequence).is_empty());
    let stop = rig.give(Action::Move(at(X, 0.0)));
    rig.run_until("x.state", 1);
    assert_eq!((rig.done(sequence)[0].code, rig.done(stop)[0].code), (Code::REPLACED, Code::NONE));
    assert_eq!(rig.real("x.command.fraction"), 0.0);
}

#[test]
fn a_constant_velocity_keeps_its_way_over_millions_of_cycles() {
    let mut rig = Rig::new();
    rig.give(Action::Move(at(LINE, 12_345.678)));
    rig.run(100);
    let start = rig.int("line.command.position");
    rig.run(3_000_000);
    let way = (rig.int("line.command.position") - start) as f64;
    assert!((way - 12_345.678 * 3_000.0).abs() <= 1.0, "{way}");
}

/// Proves: MACS-LIM-03, MACS-CMD-03
#[test]
fn invalid_goal_is_refused_with_values_and_changes_nothing() {
    let mut rig = Rig::enabled();
    let mut refuse = |goal: Move| {
        let before = rig.machine.board().clone();
        let sequence = rig.give(Action::Move(goal));
        assert_eq!(rig.machine.board(), &before, "{goal:?}");
        rig.refusal(sequence)
    };
    let x = to(X, 0);
    assert_eq!(refuse(Move { velocity: 100_001.0, ..x }), "x: velocity 100.001 mm/s exceeds max_velocity 100 mm/s");
    assert_eq!(
        refuse(Move { acceleration: 2e6, ..x }),
        "x: acceleration 2000 mm/s^2 exceeds max_acceleration 1000 mm/s^2"
    );
    assert!(refuse(Move { deceleration: 1e7, ..x }).contains("max_deceleration 1000 mm/s^2"));
    assert!(refuse(Move { velocity: f64::NAN, ..x }).contains("finite number"));
    assert!(refuse(Move { velocity: -1.0, ..x }).contains("-0.001 mm/s is not allowed"));
    assert!(refuse(Move { jerk: f64::INFINITY, ..x }).contains("not allowed"));
    assert!(refuse(to(X, 1 << 62)).contains("2^62"));
    assert!(refuse(at(X, -100_001.0)).contains("max_velocity"));
    assert!(refuse(to(77, 0)).contains("not understood"));
}

#[test]
fn refusal_reports_position_of_axis() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(to(X, 777)));
    rig.run_until("x.state", 1);
    let refused = rig.give(Action::Move(Move { velocity: 1e9, ..to(X, 0) }));
    let event = rig.events.iter().find(|event| event.command == refused).unwrap();
    assert_eq!(event.position, Position::whole(777));
}

#[test]
fn a_disabled_axis_refuses_goals() {
    let mut rig = Rig::new();
    rig.run(5);
    let sequence = rig.give(Action::Move(to(X, 5)));
    assert_eq!(rig.refusal(sequence), "x: the axis is not enabled; enable it first");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Targets, velocities, halts and rates at random cycles: the axis never exceeds the limits, never has a velocity
    /// step, and is finally at rest on a whole increment without a goal.
    ///
    /// Proves: MACS-PROF-08
    #[test]
    fn random_commands_keep_limits_and_end_on_whole_increment(
        asks in prop::collection::vec((0_u8..4, -200_000_i64..200_000, 0.01..1.0_f64, 1_u64..200), 1..12),
    ) {
        let mut rig = Rig::enabled();
        let mut last: f64 = 0.0;
        for (kind, number, share, cycles) in asks {
            let velocity = 100_000.0 * share;
            let rate = 1_000_000.0 * share;
            let action = match kind {
                0 => Action::Move(Move { velocity, acceleration: rate, ..to(X, number) }),
                1 => Action::Move(Move { deceleration: rate, ..at(X, velocity * (number.signum() as f64)) }),
                2 => Action::Move(Move { mode: MoveMode::Relative, acceleration: rate, ..to(X, number / 10) }),
                _ => Action::Halt(crate::object::AxisSet::one(X)),
            };
            rig.give(action);
            for _ in 0..cycles {
                rig.run(1);
                let now = rig.real("x.command.velocity");
                prop_assert!(now.abs() <= 100_000.0 * (1.0 + 1e-12));
                prop_assert!((now - last).abs() <= 1_000_000.0 * 0.001 * 2.001, "{} after {}", now, last);
                prop_assert!(rig.real("x.command.acceleration").abs() <= 1_000_000.0 * (1.0 + 1e-9));
                last = now;
            }
            last = rig.real("x.command.velocity");
        }
        rig.give(Action::Halt(crate::object::AxisSet::one(X)));
        rig.run_until("x.state", 1);
        prop_assert_eq!(rig.real("x.command.fraction"), 0.0);
        prop_assert_eq!(rig.real("x.command.velocity"), 0.0);
    }
}

//! Goals that wait for the previous goal, and blend into each other.

use super::rig::{LINE, Rig, X, at, couple, to};
use crate::code::Code;
use crate::command::{Action, BufferMode, Move, MoveMode};
use crate::object::{AxisSet, Leader};
use crate::position::{Length, Position};

/// 50 mm/s with 1 m/s^2: a ramp takes 50 ms and 1250 inc.
fn quick(position: i64) -> Move {
    Move { velocity: 50_000.0, acceleration: 1e6, deceleration: 1e6, ..to(X, position) }
}

fn after(buffer_mode: BufferMode, goal: Move) -> Action {
    Action::Move(Move { buffer_mode, ..goal })
}

fn ends(rig: &Rig, sequence: u64) -> Vec<(u64, Code)> {
    rig.done(sequence).iter().map(|event| (event.cycle, event.code)).collect()
}

fn position(rig: &Rig) -> f64 {
    rig.int("x.command.position") as f64 + rig.real("x.command.fraction")
}

#[test]
fn a_buffered_goal_begins_when_the_one_before_it_is_done() {
    let mut rig = Rig::enabled();
    let k = rig.machine.next_cycle();
    let first = rig.give(Action::Move(quick(10_000)));
    rig.run(9);
    let second = rig.give(after(BufferMode::Buffered, quick(20_000)));
    assert!(rig.was_accepted(second));
    assert_eq!(rig.int("x.target.position"), 10_000, "where the present move ends");
    rig.run(600);
    // 0.05 s + 7500 inc / 50 mm/s + 0.05 s
    assert_eq!(ends(&rig, first), [(k + 250, Code::NONE)]);
    assert_eq!(ends(&rig, second), [(k + 500, Code::NONE)]);
}

#[test]
fn a_blended_goal_passes_the_target_without_a_stop() {
    let mut rig = Rig::enabled();
    let k = rig.machine.next_cycle();
    let first = rig.give(Action::Move(quick(10_000)));
    let second = rig.give(after(BufferMode::BlendingPrevious, quick(20_000)));
    rig.run(100);
    for cycle in rig.machine.next_cycle()..k + 399 {
        rig.run(1);
        assert_eq!(rig.real("x.command.velocity"), 50_000.0, "in cycle {cycle}");
        assert_eq!(rig.state("x"), "DISCRETE_MOTION");
    }
    rig.run(200);
    // 0.05 s + 8750 inc / 50 mm/s; then 8750 inc / 50 mm/s + 0.05 s
    assert_eq!(ends(&rig, first), [(k + 225, Code::NONE)]);
    assert_eq!(ends(&rig, second), [(k + 450, Code::NONE)]);
}

/// 10010 inc are passed at 0.2252 s: 0.8 ms before the next cycle, in which the position is 40 inc further.
#[test]
fn the_next_goal_begins_between_two_cycles() {
    let mut rig = Rig::enabled();
    let first = rig.give(Action::Move(quick(10_010)));
    let k = rig.machine.next_cycle() - 1;
    rig.give(after(
        BufferMode::BlendingPrevious,
        Move { target: Length::whole(10_000), mode: MoveMode::Relative, ..quick(0) },
    ));
    rig.run(225);
    assert_eq!(ends(&rig, first), [(k + 226, Code::NONE)]);
    assert!((position(&rig) - 10_050.0).abs() < 1e-6, "{}", position(&rig));
    rig.run(400);
    assert_eq!(position(&rig), 20_010.0);
}

#[test]
fn each_mode_passes_with_its_velocity() {
    use BufferMode::{BlendingHigh, BlendingLow, BlendingNext, BlendingPrevious};
    for (mode, next, expected) in [
        (BlendingLow, 20_000.0, 20_000.0),
        (BlendingLow, 80_000.0, 50_000.0),
        (BlendingPrevious, 20_000.0, 50_000.0),
        (BlendingPrevious, 80_000.0, 50_000.0),
        (BlendingNext, 20_000.0, 20_000.0),
        (BlendingNext, 80_000.0, 80_000.0),
        (BlendingHigh, 20_000.0, 50_000.0),
        (BlendingHigh, 80_000.0, 80_000.0),
    ] {
        let mut rig = Rig::enabled();
        let first = rig.give(Action::Move(quick(20_000)));
        rig.give(after(mode, Move { velocity: next, ..quick(40_000) }));
        let mut before = (0.0, 0.0);
        while ends(&rig, first).is_empty() {
            before = (position(&rig), rig.real("x.command.velocity"));
            assert!(before.0 < 20_000.0, "{mode:?}: the goal is done where its target is passed");
            rig.run(1);
        }
        let now = (position(&rig), rig.real("x.command.velocity"));
        assert!(now.0 >= 20_000.0 && now.0 - 20_000.0 < 80.0, "{mode:?}: {now:?}");
        // At most one cycle at 1 m/s^2 away from the passage.
        let share = (20_000.0 - before.0) / (now.0 - before.0);
        let there = before.1 + share * (now.1 - before.1);
        assert!((there - expected).abs() <= 500.0, "{mode:?} {next}: {there} instead of {expected}");
        rig.run(2_000);
        assert_eq!(position(&rig), 40_000.0, "{mode:?}");
        assert_eq!(rig.state("x"), "STANDSTILL");
    }
}

#[test]
fn direction_reversal_happens_at_rest_at_the_target() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(quick(10_000)));
    rig.give(after(BufferMode::BlendingHigh, quick(4_000)));
    let mut highest = 0.0_f64;
    for _ in 0..600 {
        rig.run(1);
        highest = highest.max(position(&rig));
    }
    assert_eq!((highest, position(&rig)), (10_000.0, 4_000.0));
}

/// From rest, 100 inc are too short for 50 mm/s: the maximum reached is sqrt(2 * 100 * 1e6) = 14142 inc/s.
#[test]
fn short_distance_limits_the_blending_velocity() {
    let mut rig = Rig::enabled();
    let first = rig.give(Action::Move(quick(100)));
    rig.give(after(BufferMode::BlendingPrevious, quick(20_000)));
    let mut lowest = 0.0_f64;
    while ends(&rig, first).is_empty() {
        rig.run(1);
        lowest = lowest.min(position(&rig));
    }
    assert_eq!(lowest, 0.0, "it does not take a run-up");
    let velocity = rig.real("x.command.velocity");
    assert!((12_000.0..16_000.0).contains(&velocity), "{velocity}");
}

/// The second goal is 100 inc long: with a start velocity above 14142 inc/s it would overrun its end.
#[test]
fn short_next_goal_is_not_overrun() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(quick(20_000)));
    rig.give(after(BufferMode::BlendingPrevious, quick(20_100)));
    let mut highest = 0.0_f64;
    for _ in 0..700 {
        rig.run(1);
        highest = highest.max(position(&rig));
    }
    assert_eq!((highest, rig.state("x")), (20_100.0, "STANDSTILL"));
}

#[test]
fn a_velocity_goal_is_done_for_the_next_one_once_it_is_reached() {
    let mut rig = Rig::enabled();
    let k = rig.machine.next_cycle();
    let first = rig.give(Action::Move(Move { acceleration: 1e6, ..at(X, 50_000.0) }));
    let second = rig.give(after(
        BufferMode::Buffered,
        Move { target: Length::whole(10_000), mode: MoveMode::Relative, ..quick(0) },
    ));
    rig.run(1_000);
    assert_eq!(ends(&rig, first), [(k + 50, Code::NONE)]);
    // From 1250 inc on at 50 mm/s: 8750 inc, then 0.05 s.
    assert_eq!(ends(&rig, second), [(k + 50 + 175 + 50, Code::NONE)]);
    assert_eq!(position(&rig), 11_250.0);
}

#[test]
fn move_may_be_blended_into_velocity_goal() {
    let mut rig = Rig::enabled();
    let first = rig.give(Action::Move(quick(10_000)));
    rig.give(after(BufferMode::BlendingHigh, Move { acceleration: 1e6, ..at(X, 80_000.0) }));
    rig.run(230);
    assert_eq!(ends(&rig, first).len(), 1);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("CONTINUOUS_MOTION", 80_000.0));
}

#[test]
fn rounding_remainder_is_carried_from_goal_to_goal() {
    let third = Length { nearest: 33, rest: Position::from_f64(1.0 / 3.0) };
    let mut rig = Rig::enabled();
    for mode in [BufferMode::Aborting, BufferMode::BlendingNext, BufferMode::Buffered] {
        rig.give(after(mode, Move { target: third, mode: MoveMode::Relative, ..quick(0) }));
    }
    rig.run(300);
    assert_eq!(position(&rig), 100.0);
}

#[test]
fn stop_ends_all_waiting_goals() {
    for (stop, code) in [
        (Action::Halt(AxisSet::one(X)), Code::HALTED),
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP),
        (Action::Disable(AxisSet::one(X)), Code::DISABLED),
        (Action::Move(quick(0)), Code::REPLACED),
    ] {
        let mut rig = Rig::enabled();
        let goals: Vec<_> =
            [10_000, 20_000, 30_000].map(|target| rig.give(after(BufferMode::BlendingLow, quick(target)))).into();
        rig.run(20);
        rig.give(stop);
        rig.run(500);
        for goal in goals {
            assert_eq!(rig.done(goal).iter().map(|event| event.code).collect::<Vec<_>>(), [code]);
        }
    }
}

#[test]
fn a_cancelled_goal_that_waits_lets_the_one_before_it_stop_at_its_target() {
    let mut rig = Rig::enabled();
    let first = rig.give(Action::Move(quick(10_000)));
    let second = rig.give(after(BufferMode::BlendingPrevious, quick(20_000)));
    rig.run(150);
    rig.give(Action::Cancel { goal: second });
    rig.run(300);
    assert_eq!(rig.done(second)[0].code, Code::CANCELLED);
    assert_eq!((rig.done(first)[0].code, position(&rig)), (Code::NONE, 10_000.0));
}

#[test]
fn cancelling_active_goal_ends_waiting_goals() {
    let mut rig = Rig::enabled();
    let first = rig.give(Action::Move(quick(10_000)));
    let second = rig.give(after(BufferMode::Buffered, quick(20_000)));
    rig.run(150);
    rig.give(Action::Cancel { goal: first });
    rig.run(300);
    assert_eq!((rig.done(first)[0].code, rig.done(second)[0].code), (Code::CANCELLED, Code::NOT_REACHED));
    assert_eq!(rig.state("x"), "STANDSTILL");
}

#[test]
fn the_ninth_goal_that_waits_is_refused() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(quick(1_000)));
    for target in 2..10 {
        let waits = rig.give(after(BufferMode::Buffered, quick(target * 1_000)));
        assert!(rig.was_accepted(waits), "{target}");
    }
    let refused = rig.give(after(BufferMode::Buffered, quick(10_000)));
    assert_eq!(rig.refusal(refused), "x: too many commands wait; try again");
    rig.run(3_000);
    assert_eq!(position(&rig), 9_000.0);
}

#[test]
fn command_that_cannot_wait_is_refused() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    let behind = rig.give(after(BufferMode::Buffered, quick(1_000)));
    assert_eq!(rig.refusal(behind), "x: a coupling has no end that a buffered goal could wait for");
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    let mut rig = Rig::enabled();
    rig.give(Action::Move(quick(10_000)));
    let far = rig.give(after(BufferMode::BlendingHigh, quick(Position::LIMIT - 1)));
    assert!(rig.was_accepted(far), "the end of all positions is legal");
    let beyond = Move { mode: MoveMode::Relative, target: Length::whole(1), ..quick(0) };
    let beyond = rig.give(after(BufferMode::Buffered, beyond));
    assert!(rig.refusal(beyond).contains("is outside +-2^62 increments"));
}

/// After a stop it is not known where goals will end. A goal is not blended into one that a limit forbids: the axis
/// stops first.
#[test]
fn goal_is_not_blended_into_a_goal_that_will_be_refused() {
    use BufferMode::{BlendingHigh, BlendingLow, BlendingNext, BlendingPrevious};
    let ends_at = 40_000;
    for mode in [BlendingLow, BlendingPrevious, BlendingNext, BlendingHigh] {
        let mut config = super::rig::config(0);
        config.axes[usize::from(X)].parameters.max_position = Some(ends_at);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(Move { deceleration: 1e6, ..at(X, 50_000.0) }));
        rig.run(100);
        rig.give(Action::Move(Move { deceleration: 1e6, ..at(X, 0.0) }));
        // From the last cycle at 50 mm/s it needs 1250 inc to stop.
        let stand = rig.int("x.target.position");
        let relative = |way| Move { mode: MoveMode::Relative, ..quick(way) };
        let first = rig.give(after(BufferMode::Buffered, relative(ends_at - stand)));
        let second = rig.give(after(mode, relative(10_000)));
        assert!(rig.was_accepted(first) && rig.was_accepted(second), "their ends are not known yet");
        for _ in 0..2_000 {
            rig.run(1);
            assert!(position(&rig) <= ends_at as f64, "{mode:?}: beyond the limit at {}", position(&rig));
            assert!(rig.real("x.command.acceleration") >= -1e6 * (1.0 + 1e-9), "{mode:?}");
        }
        let codes = |sequence| ends(&rig, sequence).iter().map(|(_, code)| *code).collect::<Vec<_>>();
        assert_eq!(codes(first), [Code::NONE], "{mode:?}");
        assert_eq!(codes(second), [Code::ABOVE_MAX_POSITION], "{mode:?}");
        assert_eq!((rig.state("x"), position(&rig)), ("STANDSTILL", ends_at as f64));
    }
}

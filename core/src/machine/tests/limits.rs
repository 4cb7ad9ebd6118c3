mod attempts;
mod chain;
mod coupled;
mod stopped;
mod streamed;

use super::rig::{LINE, Rig, X, at, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Move};
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use proptest::prelude::*;

fn limited() -> Rig {
    let mut config = config(0);
    for axis in &mut config.axes {
        axis.parameters.min_position = Some(-20_000);
        axis.parameters.max_position = Some(50_000);
    }
    config.axes[0].parameters.max_position = None;
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// Proves: MACS-LIM-02, MACS-LIM-03
#[test]
fn a_target_beyond_a_limit_is_refused_and_one_on_it_is_met() {
    let mut rig = limited();
    let beyond = rig.give(Action::Move(to(X, 50_001)));
    assert_eq!(rig.refusal(beyond), "x: target 50.001 mm exceeds max_position 50 mm");
    let below = rig.give(Action::Move(to(X, -20_001)));
    assert_eq!(rig.refusal(below), "x: target -20.001 mm is below min_position -20 mm");
    assert_eq!(rig.state("x"), "STANDSTILL");
    let on = rig.give(Action::Move(to(X, 50_000)));
    rig.run_until("x.state", 1);
    assert_eq!((rig.done(on)[0].code, rig.int("x.command.position")), (Code::NONE, 50_000));
    assert_eq!((rig.int("x.limit.software_positive"), rig.int("x.limit.software_negative")), (1, 0));
}

#[test]
fn a_retarget_that_could_not_stop_before_the_limit_is_refused_and_the_old_goal_goes_on() {
    let mut rig = limited();
    let fast = Move { velocity: 100_000.0, acceleration: 1e6, deceleration: 1e6, ..to(X, 50_000) };
    let goal = rig.give(Action::Move(fast));
    while rig.int("x.command.position") < 40_000 {
        rig.run(1);
    }
    // From 40 mm at 100 mm/s with 100 mm/s^2 it would stop at 90 mm.
    let slow = rig.give(Action::Move(Move { deceleration: 1e5, ..to(X, 30_000) }));
    assert!(rig.refusal(slow).contains("beyond max_position, on its way"));
    rig.run_until("x.state", 1);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.command.position")), (Code::NONE, 50_000));
}

/// Proves: MACS-LIM-04, MACS-LIM-05
#[test]
fn a_velocity_goal_stops_exactly_at_the_limit_and_only_the_way_back_is_open() {
    let mut rig = limited();
    let goal = rig.give(Action::Move(at(X, 100_000.0)));
    rig.run_until("x.state", 7);
    rig.run(300);
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.velocity")), (50_000, 0.0));
    assert_eq!(rig.done(goal)[0].code, Code::SOFTWARE_LIMIT_POSITIVE);
    assert!(rig.events.iter().any(|event| event.kind == Kind::Limit));
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    let further = rig.give(Action::Move(at(X, 1_000.0)));
    assert_eq!(rig.refusal(further), "x: velocity 1 mm/s leads further into the limit at 50 mm");
    let back = rig.give(Action::Move(at(X, -1_000.0)));
    assert!(rig.was_accepted(back));
    rig.run(100);
    assert!(rig.int("x.command.position") < 50_000);
}

#[test]
fn a_follower_stops_at_its_limit_while_its_leader_runs_on() {
    let mut rig = limited();
    let goal = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    rig.give(Action::Move(at(LINE, 80_000.0)));
    rig.run_until("x.state", 7);
    rig.run(300);
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.velocity")), (50_000, 0.0));
    assert_eq!(rig.done(goal)[0].code, Code::SOFTWARE_LIMIT_POSITIVE);
    assert_eq!((rig.state("line"), rig.real("line.command.velocity")), ("CONTINUOUS_MOTION", 80_000.0));
}

#[test]
fn a_halt_with_a_weak_deceleration_still_ends_before_the_limit() {
    let mut rig = limited();
    rig.give(Action::Move(Move { deceleration: 1e4, ..at(X, 100_000.0) }));
    while rig.int("x.command.position") < 40_000 {
        rig.run(1);
    }
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run_until("x.state", 1);
    assert!((40_000..=50_000).contains(&rig.int("x.command.position")));
}

#[test]
fn an_axis_outside_its_limits_may_only_come_back() {
    let mut rig = limited();
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(3);
    rig.plant.drive(0).unwrap().jump(70_000);
    rig.run(2);
    rig.enable();
    assert_eq!(rig.int("x.command.position"), 70_000);
    let out = rig.give(Action::Move(at(X, 1_000.0)));
    assert!(rig.refusal(out).contains("further into the limit"));
    let back = rig.give(Action::Move(to(X, 10_000)));
    assert!(rig.was_accepted(back));
    let (row, _) = Row::find("error_reaction").unwrap();
    let other = rig.give(Action::SetParameters(Box::new([Change { axis: X, row, value: Value::Int(3) }])));
    assert!(rig.was_accepted(other), "what does not touch the limits is not judged by them");
    rig.run_until("x.state", 1);
    assert_eq!(rig.int("x.command.position"), 10_000);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Proves: MACS-LIM-04
    #[test]
    fn no_velocity_goal_ever_passes_a_limit(
        start in -20_000_i64..=50_000, velocity in prop_oneof![-100_000.0..-1.0_f64, 1.0..100_000.0_f64],
        rate in 1_000.0..1_000_000.0_f64, change_at in 1_u64..500,
    ) {
        let mut rig = limited();
        rig.give(Action::Move(to(X, start)));
        rig.run_until("x.state", 1);
        rig.give(Action::Move(Move { acceleration: rate, deceleration: rate, ..at(X, velocity) }));
        for cycle in 0..1_500 {
            if cycle == change_at {
                rig.give(Action::Move(Move { acceleration: rate, deceleration: rate, ..at(X, -velocity / 2.0) }));
            }
            rig.run(1);
            prop_assert!((-20_000..=50_000).contains(&rig.int("x.command.position")), "cycle {}", cycle);
            prop_assert!(rig.real("x.command.acceleration").abs() <= 1_000_000.0 * (1.0 + 1e-6));
        }
    }

    /// At its limit a coupled axis needs no more than its deceleration, for any velocity of its leader and any position
    /// of the limit between two steps.
    ///
    /// Proves: MACS-LIM-04
    #[test]
    fn a_follower_stops_at_its_limit_within_its_deceleration(
        velocity in 2_000.0..100_000.0_f64, limit in 20_000_i64..21_000, down in any::<bool>(), numerator in 1_i64..4,
    ) {
        let way = if down { -1 } else { 1 };
        let mut config = config(0);
        let p = &mut config.axes[1].parameters;
        (p.min_position, p.max_position) = if down { (Some(-limit), None) } else { (None, Some(limit)) };
        p.max_deceleration = Some(500_000.0);
        let mut rig = Rig::of(config);
        rig.enable();
        // Near the limit.
        let near = 20_000 - (velocity * velocity / 1e6) as i64 - (velocity / 5.0) as i64;
        rig.give(Action::Move(to(X, way * near)));
        rig.run_until("x.state", 1);
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), numerator, numerator)));
        rig.give(Action::Move(at(LINE, velocity * way as f64)));
        let place = |rig: &Rig| rig.int("x.command.position") as f64 + rig.real("x.command.fraction");
        // A stop in whole cycles is up to an eighth of 0.5 inc shorter than one in continuous time.
        let most = 0.5 + 0.5 * 0.5 / (8.0 * (velocity / 1_000.0 - 0.75)) + 1e-6;
        let (mut before, mut step) = (place(&rig), None);
        for _ in 0..200_000 {
            if rig.state("x") == "ERROR_STOP" && rig.real("x.command.velocity") == 0.0 {
                break;
            }
            let coupled = rig.state("x") != "ERROR_STOP";
            rig.run(1);
            let now = place(&rig);
            let slower = step.map_or(0.0, |step: f64| (step - (now - before)) * way as f64);
            let stops = rig.state("x") == "ERROR_STOP";
            prop_assert!(!stops || slower <= most, "{slower} inc/cycle^2, coupled {coupled}");
            let shown = rig.real("x.command.acceleration").abs();
            prop_assert!(!stops || shown <= 500_000.0 * (1.0 + 1e-9), "{shown}");
            (before, step) = (now, Some(now - before));
        }
        prop_assert_eq!((rig.state("x"), rig.int("x.command.position")), ("ERROR_STOP", way * limit));
    }
}

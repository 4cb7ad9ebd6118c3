use super::rig::{LINE, Rig, X, Y, at, config, saia_verb, to};
use crate::code::Code;
use crate::command::{Action, Command, Commands, Source};
use crate::event::Kind;
use crate::object::AxisSet;
use crate::vocabulary::{saia, wf};

fn x() -> AxisSet {
    AxisSet::one(X)
}

#[test]
fn enable_takes_the_drive_through_its_states_and_answers_when_it_is_on() {
    let mut rig = Rig::new();
    rig.run(3);
    assert_eq!((rig.state("x"), rig.state("line")), ("DISABLED", "STANDSTILL"));
    let sequence = rig.give(Action::Enable(x()));
    assert!(rig.done(sequence).is_empty());
    rig.run_until("x.state", 1);
    assert_eq!(rig.int("x.drive_state"), 4);
    assert_eq!((rig.done(sequence).len(), rig.state("y")), (1, "DISABLED"));
}

#[test]
fn an_axis_that_was_pushed_while_off_stays_where_it_is_when_switched_on() {
    let mut rig = Rig::new();
    rig.run(5);
    rig.plant.drive(0).unwrap().jump(123_456);
    rig.enable();
    rig.run(50);
    assert_eq!((rig.int("x.command.position"), rig.int("x.actual.position")), (123_456, 123_456));
}

/// Proves: MACS-CMD-06
#[test]
fn halt_ends_the_goal_stops_and_leaves_the_axis_free() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(to(X, 100_000)));
    rig.run(150);
    let halt = rig.give(Action::Halt(x()));
    assert_eq!(rig.done(goal)[0].code, Code::HALTED);
    assert!(rig.done(halt).is_empty());
    // From 50 mm/s to 0 at 500 mm/s^2: 100 ms.
    rig.run(101);
    assert_eq!((rig.state("x"), rig.done(halt)[0].code), ("STANDSTILL", Code::NONE));
    let again = rig.give(Action::Move(to(X, 0)));
    assert!(rig.was_accepted(again));
}

#[test]
fn a_new_goal_may_follow_a_halt_at_once() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(to(X, 100_000)));
    rig.run(150);
    let halt = rig.give(Action::Halt(x()));
    let goal = rig.give(Action::Move(to(X, 1_000)));
    assert!(rig.was_accepted(goal));
    assert_eq!(rig.done(halt)[0].code, Code::REPLACED);
    rig.run_until("x.state", 1);
    assert_eq!(rig.int("x.command.position"), 1_000);
}

#[test]
fn halt_at_rest_is_done_with_any_following_command() {
    let mut rig = Rig::enabled();
    let last = rig.give_all(vec![Action::Halt(x()), Action::Move(to(X, 1_000))]);
    assert_eq!((rig.done(last - 1)[0].code, rig.done(last - 1).len()), (Code::NONE, 1));
    assert!(rig.was_accepted(last));
}

#[test]
fn quick_stop_uses_the_largest_deceleration_and_locks_until_reset() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 100_000.0)));
    rig.run(300);
    let before = rig.int("x.command.position");
    let stop = rig.give(Action::QuickStop(x()));
    assert_eq!(rig.state("x"), "STOPPING");
    // 100 mm/s at 1000 mm/s^2: 5 mm, plus the cycle in which the command came.
    rig.run(101);
    let way = rig.int("x.command.position") - before;
    assert!((5_000..=5_101).contains(&way), "{way}");
    assert_eq!((rig.state("x"), rig.done(stop)[0].code), ("STOPPING", Code::NONE));
    let refused = rig.give(Action::Move(to(X, 0)));
    assert_eq!(rig.refusal(refused), "x: quick_stop has locked the axis; reset_errors first");
    let reset = rig.give(Action::ResetErrors(x()));
    assert_eq!((rig.state("x"), rig.done(reset).len()), ("STANDSTILL", 1));
}

/// Disable and enable, or the start of another vocabulary, cannot replace reset_errors: while the axis stops, at rest,
/// or if it was already off at the stop.
#[test]
fn lock_survives_power_off() {
    let wf = || Action::vocabulary(wf::Request { axis: X, enable: Some(true), ..Default::default() });
    use saia::Command::{Initialise, LoadDestination, MotorOff, Start};
    let stops = [
        (Action::QuickStop(x()), "x: quick_stop has locked the axis; reset_errors first"),
        (Action::Abort, "x: abort has stopped the axis; reset_errors lets it go on"),
    ];
    let offs = [Action::Disable(x()), saia_verb(&[Initialise]), saia_verb(&[MotorOff])];
    for (stop, sentence) in stops {
        for off in &offs {
            for (before, after) in [(0, 0), (300, 0), (300, 1), (300, 150)] {
                let mut rig = if before == 0 { Rig::new() } else { Rig::enabled() };
                if before > 0 {
                    rig.give(Action::Move(at(X, 100_000.0)));
                }
                rig.run(before);
                if after == 0 {
                    rig.give_all(vec![off.clone(), stop.clone()]);
                } else {
                    rig.give(stop.clone());
                    rig.run(after);
                    rig.give(off.clone());
                }
                rig.run(400);
                assert_eq!((rig.state("x"), rig.int("x.enabled")), ("STOPPING", 0), "{off:?} {before} {after}");
                for on in [Action::Enable(x()), Action::Move(to(X, 0))] {
                    let refused = rig.give(on);
                    assert_eq!(rig.refusal(refused), sentence);
                }
                let place = rig.int("x.command.position");
                for on in [wf(), saia_verb(&[Initialise]), saia_verb(&[LoadDestination, Start])] {
                    rig.give(on);
                    rig.run(100);
                }
                assert_eq!((rig.state("x"), rig.int("x.output.control")), ("STOPPING", 0), "{off:?} {before} {after}");
                assert_eq!(rig.int("x.command.position"), place);
                let reset = rig.give(Action::ResetErrors(x()));
                assert_eq!((rig.state("x"), rig.done(reset)[0].code), ("DISABLED", Code::NONE));
                rig.give(Action::Enable(x()));
                rig.run(50);
                assert_eq!(rig.state("x"), "STANDSTILL");
            }
        }
    }
}

#[test]
fn a_reset_during_a_quick_stop_waits_for_standstill() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 100_000.0)));
    rig.run(300);
    rig.give(Action::QuickStop(x()));
    let reset = rig.give(Action::ResetErrors(x()));
    assert_eq!((rig.state("x"), rig.done(reset).len()), ("STOPPING", 0));
    rig.run(120);
    assert_eq!((rig.state("x"), rig.done(reset).len()), ("STANDSTILL", 1));
}

#[test]
fn disable_stops_first_and_then_switches_off() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(at(X, 100_000.0)));
    rig.run(300);
    let off = rig.give(Action::Disable(x()));
    assert_eq!(rig.done(goal)[0].code, Code::DISABLED);
    rig.run(50);
    assert_eq!((rig.int("x.enabled"), rig.done(off).len()), (1, 0));
    rig.run(60);
    assert_eq!((rig.state("x"), rig.int("x.enabled"), rig.done(off).len()), ("DISABLED", 0, 1));
    rig.run(3);
    assert_eq!(rig.int("x.drive_state"), 1);
}

#[test]
fn a_virtual_axis_is_stopped_by_disable_and_stays_on() {
    let mut rig = Rig::new();
    rig.give(Action::Move(at(LINE, 10_000.0)));
    rig.run(100);
    let off = rig.give(Action::Disable(AxisSet::first(3)));
    rig.run(100);
    assert_eq!((rig.state("line"), rig.done(off).len()), ("STANDSTILL", 3));
}

#[test]
fn the_stop_lane_comes_before_the_queue() {
    let mut rig = Rig::enabled();
    let command = |sequence, action| Command { sequence, source: Source::Ros, action };
    let queue = [command(100, Action::Move(to(X, 50_000)))];
    let stop = [command(101, Action::QuickStop(x()))];
    rig.cycle(Commands { stop: &stop, queue: &queue, stream: None });
    assert_eq!(rig.refusal(100), "x: quick_stop has locked the axis; reset_errors first");
}

#[test]
fn cancel_stops_the_goal_it_names_and_no_other() {
    let mut rig = Rig::enabled();
    let (gx, gy) = (rig.give(Action::Move(to(X, 50_000))), rig.give(Action::Move(to(Y, 50_000))));
    rig.run(100);
    let cancel = rig.give(Action::Cancel { goal: gx });
    assert!(rig.was_accepted(cancel));
    assert!(rig.done(gx).is_empty(), "it lives until the axis stands");
    rig.run(150);
    assert_eq!((rig.done(gx)[0].code, rig.state("x")), (Code::CANCELLED, "STANDSTILL"));
    rig.run_until("y.state", 1);
    assert_eq!((rig.done(gy)[0].code, rig.int("y.command.position")), (Code::NONE, 50_000));
    let late = rig.give(Action::Cancel { goal: gx });
    assert_eq!(rig.refusal(late), format!("machine: goal {gx} is not active"));
}

/// Proves: MACS-ERR-02, MACS-ERR-06, MACS-PROF-13
#[test]
fn a_following_error_stops_the_axis_by_its_reaction_in_the_same_cycle() {
    // Reaction; then power and brake at rest.
    for (reaction, on, brake) in [(0, 0, 0), (1, 0, 1), (2, 1, 0), (3, 1, 1), (4, 0, 0)] {
        let mut config = config(0);
        config.axes[1].parameters.error_reaction = reaction;
        let mut rig = Rig::of(config);
        rig.enable();
        let goal = rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(200);
        rig.plant.drive(0).unwrap().jump(-1_000);
        rig.run(1);
        assert_eq!(rig.int("x.error"), 0, "1000 inc are tolerated");
        rig.plant.drive(0).unwrap().jump(-1_001);
        let cycle = rig.machine.next_cycle();
        rig.run(1);
        let error = rig.events.iter().find(|event| event.kind == Kind::Error).expect("an error");
        assert_eq!((error.cycle, error.code), (cycle, Code::FOLLOWING_ERROR), "reaction {reaction}");
        assert_eq!(
            crate::text::message(error, rig.machine.config()),
            "x: following error 1.001 mm exceeds max_following_error 1 mm"
        );
        assert_eq!((rig.state("x"), rig.done(goal)[0].code), ("ERROR_STOP", Code::FOLLOWING_ERROR));
        assert_eq!(rig.int("x.brake"), i64::from(reaction == 1), "at once only with reaction 1");
        rig.run(60);
        assert_eq!((rig.int("x.enabled"), rig.int("x.brake")), (on, brake), "reaction {reaction}");
        assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("ERROR_STOP", 0.0));
        let reset = rig.give(Action::ResetErrors(x()));
        rig.run(1);
        assert_eq!(rig.done(reset)[0].code, Code::NONE);
        assert_eq!(rig.state("x"), if on == 1 { "STANDSTILL" } else { "DISABLED" });
    }
}

#[test]
fn reaction_five_only_reports() {
    let mut config = config(0);
    config.axes[1].parameters.error_reaction = 5;
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(Action::Move(to(X, 10_000)));
    rig.run(50);
    rig.plant.drive(0).unwrap().jump(5_000);
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("DISCRETE_MOTION", i64::from(Code::FOLLOWING_ERROR.0)));
    rig.run_until("x.state", 1);
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
    rig.give(Action::ResetErrors(x()));
    rig.run(1);
    assert_eq!(rig.int("x.error"), 0);
}

/// Proves: MACS-ERR-07
#[test]
fn a_following_error_must_last_longer_than_its_time() {
    let mut config = config(0);
    config.axes[1].parameters.following_error_time = 5_000_000;
    let mut rig = Rig::of(config);
    rig.enable();
    // Detected in cycles 0..=5: 5 ms have passed, which is not longer than the time; in cycle 6 it is.
    for cycle in 0..7 {
        rig.plant.drive(0).unwrap().jump(2_000);
        rig.run(1);
        assert_eq!(rig.int("x.error") != 0, cycle == 6, "cycle {cycle}");
    }
}

#[test]
fn a_drive_that_is_lost_or_fails_stops_the_axis_in_the_same_cycle() {
    let mut rig = Rig::enabled();
    let goal = rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(100);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", 0x1_8611));
    assert_eq!(rig.done(goal)[0].code, Code::drive_fault(0x8611));
    let enable = rig.give(Action::Enable(x()));
    assert_eq!(rig.refusal(enable), "x: the axis stands in ERROR_STOP; reset_errors first");
    let reset = rig.give(Action::ResetErrors(x()));
    rig.run(10);
    assert_eq!((rig.done(reset)[0].code, rig.state("x")), (Code::NONE, "DISABLED"));
    rig.enable();
    rig.plant.drive(0).unwrap().disconnect();
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.error"), rig.int("x.drive_state")), ("ERROR_STOP", 88, 0));
    let reset = rig.give(Action::ResetErrors(x()));
    rig.run(5_010);
    assert_eq!((rig.done(reset)[0].code, rig.state("x")), (Code::RESET_FAILED, "ERROR_STOP"));
}

#[test]
fn streamed_velocities_move_the_axis_and_their_silence_stops_it() {
    let mut rig = Rig::enabled();
    for _ in 0..300 {
        rig.stream(X, 20_000.0);
    }
    assert_eq!((rig.int("x.reference"), rig.real("x.command.velocity")), (9, 20_000.0));
    // 100 ms later the axis stops, within 40 ms.
    rig.run(150);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("STANDSTILL", 0.0));
    assert!(rig.events.iter().any(|event| event.code == Code::STREAM_TIMEOUT));
    // Invalid velocities do not move it.
    for bad in [f64::NAN, f64::INFINITY, 100_001.0] {
        rig.stream(X, bad);
        rig.run(2);
        assert_eq!(rig.state("x"), "STANDSTILL", "{bad}");
    }
}

/// Ten clients with 25 active stops of every axis each: 256 wait for each axis, and all of them end in the cycle in
/// which it is at rest. Further stops still stop the axis; they are answered at once.
#[test]
fn every_axis_lets_256_commands_wait_and_none_of_their_ends_is_lost() {
    let mut rig = Rig::enabled();
    for axis in [LINE, X, Y] {
        rig.give(Action::Move(at(axis, 100_000.0)));
    }
    rig.run(200);
    let all = AxisSet::first(3);
    let first = rig.give_all(vec![Action::Halt(all); 64]) - 63;
    for _ in 0..3 {
        rig.give_all(vec![Action::Halt(all); 64]);
    }
    let over = rig.give(Action::Halt(all));
    assert_eq!(rig.done(over).iter().map(|event| event.code).collect::<Vec<_>>(), [Code::TOO_MANY_WAITING; 3]);
    let refused = rig.give(Action::ResetErrors(AxisSet::one(X)));
    assert_eq!(rig.refusal(refused), "x: too many commands wait; try again");
    assert_eq!((first..over).map(|sequence| rig.done(sequence).len()).sum::<usize>(), 0, "all of them wait");
    rig.run(300);
    for sequence in first..over {
        assert_eq!(
            rig.done(sequence).iter().map(|event| event.code).collect::<Vec<_>>(),
            [Code::NONE; 3],
            "{sequence}"
        );
    }
    assert!(rig.events.iter().all(|event| event.code != Code::EVENTS_LOST));
    let again = rig.give(Action::ResetErrors(AxisSet::one(X)));
    assert!(rig.was_accepted(again), "there is room again");
}

/// A locking stop reports its final state, and no state before it.
#[test]
fn a_stop_that_locks_is_one_change_of_state() {
    let home = crate::command::HomeAxis { axis: X, method: crate::command::HomingMethod::Cia402(34) };
    for motion in [Action::HomeAxis(home), Action::Move(at(X, 20_000.0))] {
        for (stop, state) in [(Action::QuickStop(x()), 6), (Action::Abort, 6)] {
            let mut rig = Rig::enabled();
            let goal = rig.give(motion.clone());
            assert!(rig.was_accepted(goal));
            rig.run(20);
            let before = rig.events.len();
            rig.give(stop);
            let told: Vec<_> = rig.events[before..]
                .iter()
                .filter(|event| event.kind == Kind::State && event.source == crate::object::Object::Axis(X))
                .map(|event| event.asked)
                .collect();
            assert_eq!(told, [crate::event::Number::Count(state)]);
        }
    }
}

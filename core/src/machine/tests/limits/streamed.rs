//! Jogs and streams into a software limit: `jog_at_limit: stop` stops them at the limit without an error, `error`
//! treats them like any other motion.

use super::super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Move, MoveMode, Setpoint};
use crate::drive::inputs;
use crate::event::{Event, Kind, Severity};
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader};
use crate::parameter::{AxisParameters, Row, Value};
use crate::sim::{Model, SecondOrder};
use crate::text::message;
use proptest::prelude::*;

const HIGH: i64 = 4_000;
const LOW: i64 = -2_000;
/// A jog is repeated 50 times a second.
const PERIOD: u64 = 20;

/// x has limits of -2 mm and 4 mm, 100 mm/s, 1 m/s^2: a stream accelerates with half of that. The power is removed
/// after an error, as by default.
fn rig_of(change: impl Fn(&mut AxisParameters)) -> Rig {
    let mut config = config(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.min_position, p.max_position, p.error_reaction) = (Some(LOW), Some(HIGH), 0);
    change(p);
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn rig() -> Rig {
    rig_of(|_| ())
}

fn place(rig: &Rig) -> f64 {
    rig.int("x.command.position") as f64 + rig.real("x.command.fraction")
}

/// Jogs for a number of cycles. Checks that no cycle exceeds a limit, or decelerates by more than 1 m/s^2.
#[track_caller]
fn jog(rig: &mut Rig, velocity: f64, cycles: u64) {
    jog_within(rig, velocity, cycles, (LOW, HIGH));
}

#[track_caller]
fn jog_within(rig: &mut Rig, velocity: f64, cycles: u64, (low, high): (i64, i64)) {
    for cycle in 0..cycles {
        let before = rig.real("x.command.velocity");
        if cycle % PERIOD == 0 {
            rig.stream(X, velocity);
        } else {
            rig.run(1);
        }
        let (now, place) = (rig.real("x.command.velocity"), place(rig));
        assert!((low as f64..=high as f64).contains(&place), "it is at {place}");
        assert!((now - before).abs() <= 1_000.0 + 1e-6, "from {before} to {now}");
    }
}

/// Returns the events since the last call, except states, acceptances, ends and parameters.
fn reported_events(rig: &mut Rig) -> Vec<(Kind, Code)> {
    let mut told: Vec<_> = rig.events.drain(..).collect();
    told.retain(|event| !matches!(event.kind, Kind::State | Kind::Accepted | Kind::Done | Kind::Parameter));
    told.iter().map(|event| (event.kind, event.code)).collect()
}

fn limit(up: bool) -> (Kind, Code) {
    (Kind::Limit, if up { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE })
}

const FURTHER: (Kind, Code) = (Kind::Warning, Code::LIMIT_VIOLATION);

#[track_caller]
fn assert_at_rest(rig: &Rig, place: i64) {
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("STANDSTILL", place));
    assert_eq!((rig.real("x.command.velocity"), rig.real("x.command.fraction")), (0.0, 0.0));
    assert_eq!((rig.int("x.enabled"), rig.int("x.error")), (1, 0));
}

/// From 0 with 20 mm/s: acceleration takes 40 ms and 0.4 mm, then the stop of 20 ms and 0.2 mm starts at 3.8 mm (or
/// -1.8 mm).
#[test]
fn a_jog_stops_at_the_limit_without_an_error_and_leads_away_at_once() {
    for up in [true, false] {
        let mut rig = rig();
        rig.mirror();
        let (way, end) = if up { (20_000.0, HIGH) } else { (-20_000.0, LOW) };
        // The ramp takes 40 ms for the travel of 20 ms; then 20 inc per cycle up to 200 inc before the limit; 20 ms to
        // stop.
        let cycles = (end.unsigned_abs() - 400 - 200) / 20 + 40 + 20;
        jog(&mut rig, way, cycles - 1);
        assert_eq!(rig.state("x"), "CONTINUOUS_MOTION");
        jog(&mut rig, way, 3);
        assert_at_rest(&rig, end);
        let events: Vec<Event> = rig.events.iter().filter(|event| event.kind == Kind::Limit).copied().collect();
        assert_eq!((events.len(), events[0].severity, events[0].position.floor()), (1, Severity::Warn, end));
        let said = if up { "x: stopped at max_position 4 mm" } else { "x: stopped at min_position -2 mm" };
        assert_eq!(message(&events[0], rig.machine.config()), said);
        assert_eq!(reported_events(&mut rig), [limit(up)]);
        assert_eq!(rig.int(if up { "x.limit.software_positive" } else { "x.limit.software_negative" }), 1);
        jog(&mut rig, way, 1_000);
        assert_at_rest(&rig, end);
        assert_eq!(reported_events(&mut rig), [], "it is told once, and not 50 times a second");
        // 20 mm/s with 0.5 m/s^2 after 40 ms.
        jog(&mut rig, -way, 41);
        assert_eq!(rig.real("x.command.velocity"), -way);
        jog(&mut rig, way, 200);
        assert_at_rest(&rig, end);
        assert_eq!(reported_events(&mut rig), [limit(up)], "it has left it: that is another approach");
    }
}

/// Motion back applies from the cycle of the setpoint, also during the stop.
#[test]
fn a_jog_leads_away_from_the_limit_while_it_still_brakes() {
    for up in [true, false] {
        let mut rig = rig();
        rig.mirror();
        let way = if up { 20_000.0 } else { -20_000.0 };
        while rig.events.iter().all(|event| event.kind != Kind::Limit) {
            jog(&mut rig, way, 1);
        }
        jog(&mut rig, way, 10);
        // 11 of 20 cycles have passed, and 9 mm/s remain: 40.5 inc.
        let before = rig.real("x.command.velocity");
        assert!((before.abs() - 9_000.0).abs() < 200.0, "{before}");
        jog(&mut rig, -way, 80);
        assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("CONTINUOUS_MOTION", -way));
        assert_eq!(reported_events(&mut rig), [limit(up)]);
    }
}

/// A press of 50 ms every 500 ms, with pauses longer than setpoint_timeout; then all presses with a duration.
#[test]
fn repeated_press_at_limit_moves_nothing_and_is_reported_once() {
    let mut rig = rig();
    rig.mirror();
    jog(&mut rig, 20_000.0, 400);
    assert_eq!(reported_events(&mut rig), [limit(true)]);
    for press in 0..10 {
        let duration = (press % 2 == 0).then_some(50_000_000);
        for _ in 0..3 {
            rig.stream_for(X, Setpoint { velocity: 20_000.0 + f64::from(press), duration });
            rig.run(PERIOD - 1);
            assert_at_rest(&rig, HIGH);
        }
        rig.run(450);
    }
    // A setpoint of 0 has no direction.
    rig.stream(X, 0.0);
    rig.stream(X, 20_000.0);
    assert_at_rest(&rig, HIGH);
    assert_eq!(reported_events(&mut rig), []);
    // The direction changes for one cycle, which moves the axis by less than the distance for leaving the limit.
    rig.stream(X, -20_000.0);
    jog(&mut rig, 20_000.0, 100);
    assert_at_rest(&rig, HIGH);
    assert_eq!(reported_events(&mut rig), [limit(true)]);
}

/// 10 mm/s for 50 ms: 20 ms of acceleration, 30 ms at constant velocity, and 20 ms to stop: 500 inc each.
#[test]
fn short_jogs_by_duration_come_to_the_limit_and_are_told_once() {
    let mut rig = rig();
    for press in 1..=12 {
        rig.stream_for(X, Setpoint { velocity: 10_000.0, duration: Some(50_000_000) });
        rig.run(300);
        assert_at_rest(&rig, HIGH.min(press * 500));
    }
    assert_eq!(reported_events(&mut rig), [FURTHER], "the eighth one ends at the limit by itself");
}

/// From rest 1 to 400 increments before the limit, in every shape, at any velocity: the axis reaches the limit, and
/// this is reported once. If the jog is released in between, it stops.
#[test]
fn a_jog_that_begins_next_to_the_limit_still_ends_at_it() {
    for (profile, before) in [(0, 1), (0, 3), (1, 18), (1, 400), (2, 1), (2, 18), (2, 400)] {
        for velocity in [300.0, 20_000.0, 100_000.0] {
            let mut rig = rig_of(|p| (p.profile, p.max_jerk) = (profile, Some(5e7)));
            rig.give(Action::Move(to(X, HIGH - before)));
            rig.run_until("x.state", 1);
            for cycle in 0..3_000 {
                if cycle % PERIOD == 0 {
                    rig.stream(X, velocity)
                } else {
                    rig.run(1)
                }
                assert!(place(&rig) <= HIGH as f64, "{profile} {before} {velocity}");
            }
            assert_at_rest(&rig, HIGH);
            assert_eq!(reported_events(&mut rig), [limit(true)], "{profile} {before} {velocity}");
        }
    }
    let mut rig = rig_of(|p| (p.profile, p.max_acceleration) = (1, 50_000.0));
    rig.give(Action::Move(to(X, HIGH - 400)));
    rig.run_until("x.state", 1);
    for cycle in 0..20 {
        if cycle == 0 {
            rig.stream_for(X, Setpoint { velocity: 100_000.0, duration: Some(20_000_000) })
        } else {
            rig.run(1)
        }
    }
    rig.run(2_000);
    assert_eq!(rig.state("x"), "STANDSTILL");
    assert!((HIGH - 400..HIGH).contains(&rig.int("x.command.position")), "{}", rig.int("x.command.position"));
}

/// Goals, halts and silence end a jog as usual, and reaching the limit again is reported again.
#[test]
fn limit_is_reported_again_after_goal_away_and_back() {
    let mut rig = rig();
    jog(&mut rig, 20_000.0, 400);
    rig.give(Action::Move(to(X, 0)));
    rig.run_until("x.state", 1);
    jog(&mut rig, 20_000.0, 400);
    assert_eq!(reported_events(&mut rig), [limit(true); 2]);
    rig.give(Action::Move(to(X, 1_000)));
    rig.run_until("x.state", 1);
    rig.give(Action::Move(to(X, HIGH)));
    rig.run_until("x.state", 1);
    for _ in 0..3 {
        jog(&mut rig, 1.0, 100);
        rig.run(200);
    }
    assert_at_rest(&rig, HIGH);
    assert_eq!(reported_events(&mut rig), [FURTHER], "it came there without the jog");
    // Switched off and on in place, it has not left the limit.
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(20);
    rig.enable();
    jog(&mut rig, 20_000.0, 100);
    assert_at_rest(&rig, HIGH);
    assert_eq!(reported_events(&mut rig), []);
}

#[test]
fn silence_and_halt_in_the_stop_at_the_limit_end_it_as_they_do_elsewhere() {
    for halts in [false, true] {
        let mut rig = rig();
        while rig.events.iter().all(|event| event.kind != Kind::Limit) {
            jog(&mut rig, 20_000.0, 1);
        }
        if halts {
            rig.give(Action::Halt(AxisSet::one(X)));
        }
        rig.run(500);
        assert_at_rest(&rig, HIGH);
        assert_eq!(reported_events(&mut rig), [limit(true)], "halts {halts}: no stream has stopped coming");
    }
}

/// The reaction of any motion without an end: 10202 or 10203, and error_reaction 0 removes the power.
///
/// Proves: MACS-LIM-04
#[test]
fn with_error_a_jog_ends_as_any_motion_without_an_end() {
    for up in [true, false] {
        let mut rig = rig_of(|p| p.supervision.jog_at_limit = 1);
        let (way, end) = if up { (20_000.0, HIGH) } else { (-20_000.0, LOW) };
        jog(&mut rig, way, 400);
        let code = limit(up).1;
        assert_eq!((rig.state("x"), rig.int("x.enabled")), ("ERROR_STOP", 0));
        assert_eq!((rig.int("x.error"), rig.int("x.command.position")), (i64::from(code.0), end));
        let said = reported_events(&mut rig);
        assert_eq!(said[..2], [limit(up), (Kind::Error, code)]);
    }
}

/// A coupled axis and a motion with an end of its own are no jogs.
///
/// Proves: MACS-LIM-04, MACS-LIM-05
#[test]
fn other_motion_into_the_limit_is_the_error_that_it_was() {
    let code = Code::SOFTWARE_LIMIT_POSITIVE;
    for led in [false, true] {
        let mut rig = rig_of(|p| p.error_reaction = 2);
        // The stop of a jog at the limit does not turn the first attempt of another motion into a second one.
        jog(&mut rig, 20_000.0, 400);
        assert_at_rest(&rig, HIGH);
        reported_events(&mut rig);
        let lead = |rig: &mut Rig| {
            if led {
                rig.give(Action::Move(at(LINE, 20_000.0)));
                rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
            } else {
                rig.give(Action::Move(to(X, HIGH - 100)));
                rig.run_until("x.state", 1);
                rig.give(Action::Move(at(X, 20_000.0)));
            }
            rig.run_until("x.state", 7);
            rig.run(100);
        };
        lead(&mut rig);
        assert_eq!(reported_events(&mut rig), [limit(true), (Kind::Error, code)], "led {led}");
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(10);
        reported_events(&mut rig);
        // A jog further into the limit is reported once, is no error, and does not change the next attempt of a
        // coupling.
        jog(&mut rig, 20_000.0, 300);
        rig.run(300);
        jog(&mut rig, 20_000.0, 300);
        assert_at_rest(&rig, HIGH);
        assert_eq!(reported_events(&mut rig), [FURTHER], "led {led}");
        if led {
            lead(&mut rig);
            assert_eq!(reported_events(&mut rig), [limit(true), (Kind::Error, Code::LIMIT_VIOLATION)]);
        }
    }
}

/// The stop ends both motions; the goal of the superimposed motion ends with the reason.
#[test]
fn a_jog_that_carries_a_superimposed_motion_stops_at_the_limit_with_it() {
    let mut rig = rig();
    rig.mirror();
    jog(&mut rig, 20_000.0, 61);
    let over = Move { mode: MoveMode::Superimposed, velocity: 5_000.0, acceleration: 1e5, ..to(X, 2_000) };
    let goal = rig.give(Action::Move(Move { deceleration: 1e5, ..over }));
    assert!(rig.was_accepted(goal));
    jog(&mut rig, 20_000.0, 300);
    assert_at_rest(&rig, HIGH);
    let done = rig.done(goal);
    assert_eq!((done.len(), done[0].code), (1, Code::SOFTWARE_LIMIT_POSITIVE));
    assert_eq!(reported_events(&mut rig), [limit(true)]);
}

#[test]
fn limits_that_change_under_a_jog_hold_from_then_on() {
    let set = |rig: &mut Rig, high: i64| {
        let sequence = rig.set("max_position", Value::Int(high));
        assert!(rig.was_accepted(sequence));
    };
    let mut rig = rig();
    rig.mirror();
    // At the limit, and then in the middle of the stop at it: the axis moves on with the next message.
    jog(&mut rig, 20_000.0, 400);
    set(&mut rig, 6_000);
    assert_at_rest(&rig, HIGH);
    jog_within(&mut rig, 20_000.0, 400, (LOW, 6_000));
    assert_at_rest(&rig, 6_000);
    assert_eq!(reported_events(&mut rig), [limit(true); 2]);
    set(&mut rig, 8_000);
    while rig.events.iter().all(|event| event.kind != Kind::Limit) {
        jog_within(&mut rig, 20_000.0, 1, (LOW, 8_000));
    }
    set(&mut rig, 9_000);
    jog_within(&mut rig, 20_000.0, 400, (LOW, 9_000));
    assert_at_rest(&rig, 9_000);
    assert_eq!(reported_events(&mut rig), [limit(true); 2]);
    // Below the present position: further outwards nothing moves, motion back is allowed, and a reversal outside the
    // limit stops.
    set(&mut rig, 1_000);
    jog_within(&mut rig, 20_000.0, 300, (LOW, 9_000));
    assert_at_rest(&rig, 9_000);
    assert_eq!(reported_events(&mut rig), [], "it has not left the limit");
    jog_within(&mut rig, -20_000.0, 100, (LOW, 9_000));
    assert_eq!(rig.real("x.command.velocity"), -20_000.0);
    jog_within(&mut rig, 20_000.0, 300, (LOW, 9_000));
    assert_eq!((rig.state("x"), reported_events(&mut rig)), ("STANDSTILL", vec![FURTHER]));
    assert!((1_000..9_000).contains(&rig.int("x.command.position")));
    // A limit before which the jog could no longer stop is refused, as before.
    jog_within(&mut rig, -20_000.0, 600, (LOW, 9_000));
    assert_at_rest(&rig, LOW);
    jog_within(&mut rig, 20_000.0, 60, (LOW, 9_000));
    let refused = rig.set("max_position", Value::Int(rig.int("x.command.position") + 100));
    assert!(rig.refusal(refused).contains("max_position"));
}

/// Limits of an axis with a modulo apply to the position over all revolutions.
#[test]
fn a_jog_of_an_axis_with_a_modulo_stops_at_the_limit_of_all_turns() {
    let mut config = config(0);
    let x = &mut config.axes[usize::from(X)];
    x.modulo = Modulo::new(1_000, 1);
    assert!(x.modulo.is_some());
    (x.parameters.min_position, x.parameters.max_position) = (Some(LOW), Some(HIGH));
    let mut rig = Rig::of(config);
    rig.enable();
    jog(&mut rig, 20_000.0, 400);
    assert_at_rest(&rig, HIGH);
    jog(&mut rig, -20_000.0, 600);
    assert_at_rest(&rig, LOW);
    assert_eq!(reported_events(&mut rig), [limit(true), limit(false)]);
}

/// The parameter counts in the cycle in which the limit is reached.
#[test]
fn jog_at_limit_is_changed_in_motion() {
    let row = Row::find("jog_at_limit").expect("a row").1;
    let names = crate::parameter::JOG_AT_LIMIT;
    assert_eq!((row.measure, row.default), (crate::parameter::Measure::Choice(names), Value::Int(0)));
    assert_eq!(names, ["stop", "error"]);
    let mut rig = rig();
    jog(&mut rig, 20_000.0, 100);
    let sequence = rig.set("jog_at_limit", Value::Int(1));
    assert!(rig.was_accepted(sequence));
    jog(&mut rig, 20_000.0, 300);
    assert_eq!((rig.state("x"), rig.int("x.enabled")), ("ERROR_STOP", 0));
    let sequence = rig.set("jog_at_limit", Value::Int(2));
    assert!(rig.refusal(sequence).contains("jog_at_limit"));
}

/// A limit switch has no position to stop at: it remains an error, in the cycle of its edge.
///
/// Proves: MACS-LIM-07
#[test]
fn a_jog_into_a_limit_switch_is_an_error() {
    let mut rig = rig();
    jog(&mut rig, 20_000.0, 60);
    rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
    rig.stream(X, 20_000.0);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", i64::from(Code::HARDWARE_LIMIT_POSITIVE.0)));
}

/// The power is removed while the drive is still 1.5 mm behind: from there a jog moves the axis again, and is reported
/// again.
#[test]
fn a_drive_that_was_behind_when_its_power_went_may_be_jogged_to_the_limit_again() {
    let mut config = config(0);
    let x = &mut config.axes[usize::from(X)].parameters;
    (x.min_position, x.max_position, x.max_following_error) = (Some(LOW), Some(HIGH), 50_000);
    let lagging = Model::SecondOrder(SecondOrder::new(5.0, 1.0, 1_000_000).expect("a drive"));
    let mut rig = Rig::with(config, [lagging, Model::Ideal]);
    rig.enable();
    let end = |rig: &mut Rig| {
        while rig.int("x.command.position") < HIGH {
            jog(rig, 20_000.0, 1)
        }
    };
    end(&mut rig);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(100);
    assert_eq!(rig.int("x.enabled"), 0);
    assert!((LOW..HIGH - 200).contains(&rig.int("x.actual.position")), "{}", rig.int("x.actual.position"));
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(200);
    rig.enable();
    rig.events.clear();
    end(&mut rig);
    jog(&mut rig, 20_000.0, 100);
    assert_at_rest(&rig, HIGH);
    assert_eq!(reported_events(&mut rig), [limit(true)]);
}

/// Each axis of a message is handled separately.
#[test]
fn a_jog_of_two_axes_stops_the_one_that_is_at_its_limit() {
    let mut rig = rig();
    let both = |rig: &mut Rig| {
        let mut set = crate::command::Setpoints::none(3);
        for axis in [X, Y] {
            set.axes[usize::from(axis)] = Some(Setpoint { velocity: 20_000.0, duration: None });
        }
        rig.cycle(crate::command::Commands { stream: Some(&set), ..Default::default() });
        rig.run(PERIOD - 1);
    };
    (0..20).for_each(|_| both(&mut rig));
    assert_at_rest(&rig, HIGH);
    assert_eq!((rig.state("y"), rig.real("y.command.velocity")), ("CONTINUOUS_MOTION", 20_000.0));
    assert_eq!(reported_events(&mut rig), [limit(true)]);
}

#[derive(Clone, Copy, Debug)]
enum JogPress {
    /// Velocity, number of cycles, cycles between messages.
    Jog(f64, u64, u64),
    Silent(u64),
    Override(f64),
}

fn jog_press() -> impl Strategy<Value = JogPress> {
    let velocity = prop_oneof![-100_000.0..100_000.0_f64, -300.0..300.0_f64, Just(0.0)];
    prop_oneof![
        8 => (velocity, 1_u64..400, 1_u64..90).prop_map(|(velocity, cycles, every)| JogPress::Jog(velocity, cycles, every)),
        2 => (1_u64..400).prop_map(JogPress::Silent),
        1 => (0.0..100.0_f64).prop_map(JogPress::Override),
    ]
}

proptest! {
    #![proptest_config(cases(60))]

    /// With any jogs and any shape, a jog never exceeds a limit, never causes an error, keeps the power, and never
    /// exceeds the deceleration of the axis. The last jog ends at the limit, and there are no more events than
    /// approaches.
    #[test]
    fn no_jog_passes_a_limit_or_ends_in_an_error(
        profile in 0_i64..3, deceleration in prop::option::of(2e5..4e6_f64), hands in prop::collection::vec(jog_press(), 1..20),
        last in prop_oneof![-100_000.0..-3_000.0_f64, 3_000.0..100_000.0_f64],
    ) {
        let mut rig = rig_of(|p| {
            (p.profile, p.max_jerk, p.max_deceleration) = (profile, Some(5e7), deceleration);
            p.error_reaction = 2;
        });
        rig.mirror();
        let most = 1e6_f64.max(deceleration.unwrap_or(1e6)) * 1e-3 * (1.0 + 1e-6);
        let (mut before, mut turns, mut way) = (0.0, 1, 0.0);
        let mut checked = |rig: &Rig| {
            let (place, now) = (place(rig), rig.real("x.command.velocity"));
            prop_assert!((LOW as f64..=HIGH as f64).contains(&place), "it is at {}", place);
            prop_assert!(profile != 0 || (now - before).abs() <= most, "from {} to {}", before, now);
            prop_assert!(now.abs() <= 100_000.0 * (1.0 + 1e-9));
            prop_assert_eq!((rig.int("x.enabled"), rig.int("x.error")), (1, 0));
            before = now;
            Ok(())
        };
        for hand in hands {
            match hand {
                JogPress::Jog(velocity, cycles, every) => {
                    if velocity != 0.0 && velocity * way <= 0.0 {
                        (turns, way) = (turns + 1, velocity);
                    }
                    for cycle in 0..cycles {
                        if cycle % every == 0 {
                            rig.stream(X, velocity);
                        } else {
                            rig.run(1);
                        }
                        checked(&rig)?;
                    }
                }
                JogPress::Silent(cycles) => for _ in 0..cycles {
                    rig.run(1);
                    checked(&rig)?;
                },
                JogPress::Override(share) => {
                    rig.set("velocity_override", Value::Real(share));
                    checked(&rig)?;
                }
            }
        }
        rig.set("velocity_override", Value::Real(100.0));
        checked(&rig)?;
        for cycle in 0..20_000 {
            if cycle % PERIOD == 0 {
                rig.stream(X, last);
            } else {
                rig.run(1);
            }
            checked(&rig)?;
            let at_rest = cycle > 200 && rig.state("x") == "STANDSTILL";
            if at_rest {
                break;
            }
        }
        let (end, place) = (if last > 0.0 { HIGH } else { LOW }, rig.int("x.command.position"));
        prop_assert_eq!((rig.state("x"), place), ("STANDSTILL", end));
        let limits = rig.events.iter().filter(|event| event.kind == Kind::Limit).count();
        prop_assert!(limits <= turns + 1, "{} events, {} turns", limits, turns);
    }
}

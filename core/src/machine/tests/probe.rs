//! Touch probe to position: a search, a latch between two cycles, and the motion from there.

use super::rig::{LINE, Rig, X, Y, config, to};
use crate::code::Code;
use crate::command::{Action, BufferMode, Move, MoveMode, Probe, ProbeEdge};
use crate::config::{FilterConfig, IoConfig, IoKind};
use crate::drive::{Capabilities, Edge, Inputs, Latch};
use crate::event::{Event, Kind};
use crate::object::{AxisSet, Object};
use crate::parameter::{Change, Row, Value};
use crate::position::{Length, Position};

const MARK: Object = Object::Io(0);
const OTHER: Object = Object::Io(1);

/// Returns a rig with x and y switched on, and two inputs that latch.
fn rig() -> Rig {
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    let mut rig = Rig::of(crate::config::MachineConfig { io: vec![input("mark"), input("other")], ..config(0) });
    rig.enable();
    rig
}

/// Searches to 100 mm at 50 mm/s with 1 m/s^2: a ramp takes 50 ms and 1250 inc.
fn probe(distance: i64) -> Probe {
    Probe {
        axis: X,
        relative: false,
        target: Length::whole(100_000),
        velocity: 50_000.0,
        acceleration: 1e6,
        deceleration: 1e6,
        jerk: 0.0,
        source: MARK,
        edge: ProbeEdge::Rising,
        distance: Length::whole(distance),
    }
}

fn latch(rig: &mut Rig, object: Object, edge: Edge, age_ns: u32) {
    assert!(rig.plant.add_latch(Latch { object, edge, age_ns: Some(age_ns), position: None }));
}

/// Starts a goal and latches 101 cycles later, 350 us before that cycle. The command is at 3800 inc and at constant
/// velocity then; the actual position, one cycle behind, is 3750 inc: at the latch it was 17.5 inc less, 3732.5 inc.
fn found(rig: &mut Rig, request: Probe) -> u64 {
    let goal = rig.give(Action::Probe(request));
    assert!(rig.was_accepted(goal));
    rig.run(100);
    latch(rig, MARK, Edge::Rising, 350_000);
    rig.run(1);
    assert_eq!((rig.int("x.command.position"), rig.int("x.actual.position")), (3_800, 3_750));
    goal
}

fn ends(rig: &Rig, sequence: u64) -> Vec<(Code, i64)> {
    rig.done(sequence).iter().map(|event| (event.code, event.position.floor())).collect()
}

fn marks(rig: &Rig, sequence: u64) -> Vec<Event> {
    rig.events.iter().filter(|event| event.kind == Kind::Mark && event.command == sequence).copied().collect()
}

fn sentence(rig: &Rig, event: &Event) -> String {
    crate::text::message(event, rig.machine.config())
}

fn position(rig: &Rig) -> f64 {
    rig.int("x.command.position") as f64 + rig.real("x.command.fraction")
}

/// Runs until the axis is at rest. Returns the lowest and highest command position; no cycle exceeds 1 m/s^2.
fn run_to_rest(rig: &mut Rig) -> (f64, f64) {
    let (mut low, mut high) = (position(rig), position(rig));
    for _ in 0..10_000 {
        let before = rig.real("x.command.velocity");
        rig.run(1);
        let change = (rig.real("x.command.velocity") - before).abs();
        assert!(change <= 1_000.001, "the velocity changes by {change}");
        (low, high) = (low.min(position(rig)), high.max(position(rig)));
        if rig.state("x") == "STANDSTILL" {
            return (low, high);
        }
    }
    panic!("it never stands");
}

fn mark_is_high(inputs: &mut Inputs) {
    inputs.set_digital(0, true);
}

fn set(rig: &mut Rig, key: &str, value: i64) {
    let row = Row::find(key).unwrap().0;
    let sequence = rig.give(Action::SetParameters([Change { axis: X, row, value: Value::Int(value) }].into()));
    assert!(rig.was_accepted(sequence));
}

/// 3732.5 + 10000 - 0.25 is 13732.25, rounded 13732: rounding both parts separately would give 13733.
#[test]
fn the_end_counts_from_the_place_between_two_cycles_and_is_rounded_once() {
    let mut rig = rig();
    let distance = Length { nearest: 10_000, rest: Position::from_f64(-0.25) };
    let k = rig.machine.next_cycle();
    let goal = found(&mut rig, Probe { distance, ..probe(0) });
    assert_eq!(rig.int("x.target.position"), 13_732, "in the cycle of the latch");
    assert_eq!(rig.real("x.command.velocity"), 50_000.0);
    let mark = marks(&rig, goal);
    assert_eq!(mark.len(), 1);
    let Event { age_ns, position: place, cycle, .. } = mark[0];
    assert_eq!((age_ns, place, cycle), (350_000, Position::from_f64(3_732.5), k + 101));
    assert_eq!(sentence(&rig, &mark[0]), "x: mark at 3.732 mm, 350 us before the cycle");
    run_to_rest(&mut rig);
    // From 3800: 8682 inc at 50 mm/s are 173.64 ms, then 50 ms.
    let done = rig.done(goal);
    assert_eq!((done[0].cycle, done[0].code, done[0].position), (k + 101 + 224, Code::NONE, Position::whole(13_732)));
    assert_eq!((done.len(), position(&rig)), (1, 13_732.0));
}

/// The axis stops at 3800 + 1250 inc at the earliest.
#[test]
fn an_end_behind_the_mark_or_too_near_is_passed_and_returned_to() {
    for (distance, end) in [(-2_000, 1_733.0), (500, 4_233.0), (0, 3_733.0), (-100_000, -96_268.0)] {
        let mut rig = rig();
        let goal = found(&mut rig, probe(distance));
        let (_, high) = run_to_rest(&mut rig);
        assert!((5_049.0..=5_050.0).contains(&high), "{distance}: {high}");
        assert_eq!((position(&rig), ends(&rig, goal)), (end, vec![(Code::NONE, end as i64)]), "{distance}");
    }
}

#[test]
fn an_end_beyond_a_limit_fails_the_goal_and_stops_the_axis() {
    for (key, limit, distance, code, told) in [
        ("max_position", 20_000, 17_000, Code::ABOVE_MAX_POSITION, "x: target 20.733 mm exceeds max_position 20 mm"),
        ("min_position", -10, -3_743, Code::BELOW_MIN_POSITION, "x: target -0.011 mm is below min_position -0.01 mm"),
    ] {
        let mut rig = rig();
        set(&mut rig, key, limit);
        let goal = found(&mut rig, Probe { target: Length::whole(15_000), ..probe(distance) });
        assert_eq!(ends(&rig, goal), [(code, 3_800)], "at once");
        assert_eq!(sentence(&rig, &rig.done(goal)[0]), told);
        assert_eq!((marks(&rig, goal).len(), rig.state("x")), (1, "DISCRETE_MOTION"));
        let next = rig.give(Action::Move(to(X, 0)));
        assert!(rig.was_accepted(next), "it is free");
        let mut rig = self::rig();
        set(&mut rig, key, limit);
        found(&mut rig, Probe { target: Length::whole(15_000), ..probe(distance) });
        run_to_rest(&mut rig);
        assert_eq!(position(&rig), 5_050.0, "with the deceleration of the goal");
    }
}

#[test]
fn a_search_without_its_latch_is_missed() {
    let mut rig = rig();
    latch(&mut rig, MARK, Edge::Rising, 0);
    let goal = rig.give(Action::Probe(Probe { target: Length::whole(3_000), ..probe(1_000) }));
    let waits = rig.give(Action::Move(Move { buffer_mode: BufferMode::BlendingHigh, ..to(X, 50_000) }));
    assert!(rig.was_accepted(waits));
    rig.run(20);
    latch(&mut rig, MARK, Edge::Falling, 0);
    latch(&mut rig, OTHER, Edge::Rising, 0);
    latch(&mut rig, Object::Axis(X), Edge::Rising, 0);
    run_to_rest(&mut rig);
    assert_eq!(ends(&rig, goal), [(Code::PROBE_MISSED, 3_000)]);
    assert_eq!(sentence(&rig, &rig.done(goal)[0]), "x: nothing latched until the end of the search");
    assert_eq!(ends(&rig, waits), [(Code::NOT_REACHED, 3_000)]);
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(100);
    assert_eq!((position(&rig), marks(&rig, goal).len()), (3_000.0, 0), "it is over");
}

/// The index of the drive is not affected: pulses are reported with the position.
#[test]
fn a_latch_of_a_drive_that_has_none_is_not_waited_for() {
    let mut config = config(0);
    config.axes[1].drive = Some(Capabilities { latches: false, ..Capabilities::all(0) });
    let mut rig = Rig::of(config);
    rig.enable();
    let own = Probe { source: Object::Axis(X), ..probe(1_000) };
    let goal = rig.give(Action::Probe(own));
    let allowed = "an input with `latch: true` or an encoder is allowed";
    assert_eq!(rig.refusal(goal), format!("x: the drive of x latches nothing; {allowed}"));
    for may in [Probe { edge: ProbeEdge::Index, ..own }, Probe { source: Object::Axis(Y), ..own }] {
        let goal = rig.give(Action::Probe(may));
        assert!(rig.was_accepted(goal));
    }
}

#[test]
fn only_the_first_latch_counts_and_that_is_the_oldest() {
    let mut rig = rig();
    let goal = rig.give(Action::Probe(probe(1_000)));
    rig.run(100);
    for age in [100_000, 800_000, 300_000] {
        latch(&mut rig, MARK, Edge::Rising, age);
    }
    latch(&mut rig, MARK, Edge::Falling, 900_000);
    rig.run(1);
    latch(&mut rig, MARK, Edge::Rising, 0);
    run_to_rest(&mut rig);
    assert_eq!((marks(&rig, goal).len(), position(&rig)), (1, 4_710.0));
}

#[test]
fn each_edge_is_taken_by_the_probe_that_requests_it() {
    use ProbeEdge::{Both, Falling, Rising};
    for (edge, given, takes) in [
        (Rising, Edge::Rising, true),
        (Rising, Edge::Falling, false),
        (Falling, Edge::Rising, false),
        (Falling, Edge::Falling, true),
        (Both, Edge::Rising, true),
        (Both, Edge::Falling, true),
    ] {
        let mut rig = rig();
        if edge == Falling {
            rig.modify_inputs = mark_is_high;
        }
        let goal = rig.give(Action::Probe(Probe { edge, ..probe(0) }));
        rig.run(50);
        latch(&mut rig, MARK, given, 1);
        rig.run(1);
        assert_eq!(marks(&rig, goal).len() == 1, takes, "{edge:?} {given:?}");
    }
}

/// The raw count of its own drive is exact, independent of the age; a latch of another object only gives the age.
#[test]
fn a_position_that_the_own_device_caught_is_taken_as_it_is() {
    for (object, raw, end) in [(Object::Axis(X), 3_704, 4_704.0), (Object::Axis(2), 0, 4_750.0)] {
        let mut rig = rig();
        rig.give(Action::Probe(Probe { source: object, ..probe(1_000) }));
        rig.run(100);
        let caught = Latch { object, edge: Edge::Rising, age_ns: None, position: Some(raw) };
        assert!(rig.plant.add_latch(caught));
        run_to_rest(&mut rig);
        assert_eq!(position(&rig), end, "{object:?}");
    }
}

/// The position of a virtual axis is its command: 3800 inc in that cycle.
#[test]
fn a_virtual_axis_probes_its_command() {
    let mut rig = rig();
    rig.give(Action::Probe(Probe { axis: LINE, ..probe(1_000) }));
    rig.run(100);
    latch(&mut rig, MARK, Edge::Rising, 340_000);
    rig.run(1);
    rig.run_until("line.state", 1);
    // 3800 - 0.34 * 50
    assert_eq!(rig.int("line.command.position"), 4_783);
}

#[test]
fn a_goal_that_waits_begins_when_the_probe_is_done_and_not_before() {
    for mode in [BufferMode::Buffered, BufferMode::BlendingHigh] {
        let mut rig = rig();
        let goal = rig.give(Action::Probe(probe(10_000)));
        let further = Move { mode: MoveMode::Relative, velocity: 50_000.0, ..to(X, 2_000) };
        let next = rig.give(Action::Move(Move { buffer_mode: mode, ..further }));
        assert!(rig.was_accepted(next));
        rig.run(99);
        latch(&mut rig, MARK, Edge::Rising, 350_000);
        while rig.done(goal).is_empty() {
            rig.run(1);
        }
        // 3732.5 + 10000
        assert_eq!((rig.done(goal)[0].code, position(&rig)), (Code::NONE, 13_733.0), "{mode:?}");
        assert_eq!((rig.real("x.command.velocity"), rig.state("x")), (0.0, "DISCRETE_MOTION"));
        run_to_rest(&mut rig);
        // The rounding remainder, half an increment, is included: 13732.5 + 2000.
        assert_eq!(ends(&rig, next), [(Code::NONE, 15_733)], "{mode:?}");
    }
}

#[test]
fn a_waiting_goal_that_the_end_of_the_probe_forbids_is_refused_when_its_turn_comes() {
    let mut rig = rig();
    set(&mut rig, "max_position", 100_000);
    let goal = found(&mut rig, probe(90_000));
    let next =
        rig.give(Action::Move(Move { buffer_mode: BufferMode::Buffered, mode: MoveMode::Relative, ..to(X, 9_000) }));
    assert_eq!(rig.refusal(next), "x: target 102.733 mm exceeds max_position 100 mm", "its end is known now");
    run_to_rest(&mut rig);
    assert_eq!(ends(&rig, goal), [(Code::NONE, 93_733)]);
}

/// A superimposed motion continues: the remaining part of its 1000 inc is added to the end position.
#[test]
fn a_superimposed_motion_goes_on_across_the_mark() {
    let mut rig = rig();
    let goal = rig.give(Action::Probe(Probe { acceleration: 5e5, deceleration: 5e5, ..probe(10_000) }));
    rig.run(150);
    let over =
        Move { mode: MoveMode::Superimposed, velocity: 10_000.0, acceleration: 4e5, deceleration: 4e5, ..to(X, 1_000) };
    let added = rig.give(Action::Move(over));
    assert!(rig.was_accepted(added));
    let start = position(&rig);
    rig.run(60);
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    let over_so_far = position(&rig) - (start + 61.0 * 50.0);
    assert!((100.0..900.0).contains(&over_so_far), "{over_so_far}");
    let place = marks(&rig, goal)[0].position.to_f64();
    run_to_rest(&mut rig);
    assert_eq!((ends(&rig, goal)[0].0, ends(&rig, added)[0].0), (Code::NONE, Code::NONE));
    let expected = place + 10_000.0 + 1_000.0 - over_so_far;
    assert!((position(&rig) - expected).abs() <= 1.0, "{} instead of {expected}", position(&rig));
}

#[test]
fn what_is_superimposed_may_not_carry_the_end_beyond_a_limit() {
    let mut rig = rig();
    set(&mut rig, "max_position", 120_000);
    let goal = rig.give(Action::Probe(Probe { acceleration: 5e5, deceleration: 5e5, ..probe(112_000) }));
    rig.run(150);
    let over =
        Move { mode: MoveMode::Superimposed, velocity: 10_000.0, acceleration: 4e5, deceleration: 4e5, ..to(X, 3_000) };
    let added = rig.give(Action::Move(over));
    assert!(rig.was_accepted(added));
    rig.run(10);
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(1);
    assert_eq!(rig.done(goal)[0].code, Code::ABOVE_MAX_POSITION);
    assert_eq!(rig.done(added)[0].code, Code::NOT_REACHED);
    run_to_rest(&mut rig);
    assert!(position(&rig) < 20_000.0);
}

#[test]
fn a_goal_that_was_stopped_takes_no_latch() {
    for (stop, code) in [
        (Action::Halt(AxisSet::one(X)), Code::HALTED),
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP),
        (Action::Cancel { goal: 2 }, Code::CANCELLED),
        (Action::Move(to(X, 0)), Code::REPLACED),
    ] {
        let mut rig = rig();
        let goal = rig.give(Action::Probe(probe(50_000)));
        assert_eq!(goal, 2);
        rig.run(100);
        rig.give(stop);
        latch(&mut rig, MARK, Edge::Rising, 0);
        rig.run(1_000);
        assert_eq!((ends(&rig, goal)[0].0, marks(&rig, goal).len()), (code, 0));
        assert!(position(&rig) < 6_000.0, "{code:?}: {}", position(&rig));
    }
}

#[test]
fn the_latch_is_taken_while_the_search_waits_for_its_drive_or_for_the_override() {
    let mut rig = rig();
    set(&mut rig, "in_position_window", 1);
    set(&mut rig, "in_position_time", 50_000_000);
    let goal = rig.give(Action::Probe(Probe { target: Length::whole(3_000), ..probe(1_000) }));
    rig.run(120);
    assert_eq!((position(&rig), rig.done(goal).len()), (3_000.0, 0));
    latch(&mut rig, MARK, Edge::Rising, 0);
    run_to_rest(&mut rig);
    assert_eq!((position(&rig), rig.done(goal)[0].code), (4_000.0, Code::NONE));

    let mut rig = self::rig();
    let goal = rig.give(Action::Probe(probe(1_000)));
    rig.run(100);
    let share = |rig: &mut Rig, share| {
        let row = Row::find("velocity_override").unwrap().0;
        rig.give(Action::SetParameters([Change { axis: X, row, value: Value::Real(share) }].into()));
    };
    share(&mut rig, 0.0);
    rig.run(100);
    assert_eq!(rig.real("x.command.velocity"), 0.0);
    let stands = position(&rig);
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(100);
    assert_eq!((marks(&rig, goal).len(), position(&rig)), (1, stands), "it is held");
    share(&mut rig, 100.0);
    run_to_rest(&mut rig);
    assert_eq!((position(&rig), rig.done(goal)[0].code), ((stands + 1_000.0).round(), Code::NONE));
}

#[test]
fn every_profile_ends_on_the_increment() {
    for profile in 0..3 {
        let mut rig = rig();
        set(&mut rig, "profile", profile);
        let goal = rig.give(Action::Probe(Probe { jerk: 2e7, ..probe(777) }));
        rig.run(25);
        latch(&mut rig, MARK, Edge::Rising, 500_000);
        rig.mirror();
        rig.run(1);
        let place = marks(&rig, goal)[0].position;
        rig.run_until("x.state", 1);
        let end = (place + Position::whole(777)).nearest();
        assert_eq!(ends(&rig, goal), [(Code::NONE, end)], "profile {profile}");
    }
}

#[test]
fn a_probe_needs_an_axis_that_can_move() {
    let mut rig = Rig::new();
    let refused = rig.give(Action::Probe(probe(0)));
    assert_eq!(rig.refusal(refused), "x: the axis is not enabled; enable it first");
    let mut rig = self::rig();
    let fast = rig.give(Action::Probe(Probe { velocity: 1e6, ..probe(0) }));
    assert_eq!(rig.refusal(fast), "x: velocity 1000 mm/s exceeds max_velocity 100 mm/s");
    let nowhere = rig.give(Action::Probe(Probe { axis: 77, ..probe(0) }));
    assert!(rig.refusal(nowhere).ends_with("the request is not understood"));
    let goal = found(&mut rig, probe(i64::MAX));
    assert_eq!(rig.done(goal)[0].code, Code::POSITION_OUT_OF_RANGE);
}

/// A refusal changes nothing: an axis at rest stays at rest, and an active motion continues.
#[test]
fn a_probe_whose_input_is_active_is_refused_before_motion() {
    let mut rig = rig();
    rig.modify_inputs = mark_is_high;
    let refused = rig.give(Action::Probe(probe(0)));
    let remedy = "move the axis off it, or set probe_active_input to allow";
    assert_eq!(
        rig.refusal(refused),
        format!("x: probe input is already active: mark is 1, allowed 0 before a rising edge; {remedy}")
    );
    rig.run(200);
    assert_eq!((rig.state("x"), position(&rig), rig.real("x.command.velocity")), ("STANDSTILL", 0.0, 0.0));

    let goal = rig.give(Action::Move(Move { velocity: 50_000.0, ..to(X, 20_000) }));
    rig.run(20);
    let refused = rig.give(Action::Probe(probe(0)));
    assert!(rig.refusal(refused).starts_with("x: probe input is already active: mark is 1"));
    run_to_rest(&mut rig);
    assert_eq!(ends(&rig, goal), [(Code::NONE, 20_000)], "the goal before it goes on");

    rig.modify_inputs = |_| {};
    let accepted = rig.give(Action::Probe(probe(0)));
    assert!(rig.was_accepted(accepted), "the axis has left the mark");
}

/// The active level is the one after the edge: 1 for a rising edge, 0 for a falling one. With both edges, the first
/// edge can always occur.
#[test]
fn the_edge_says_which_level_of_the_input_is_active() {
    use ProbeEdge::{Both, Falling, Rising};
    for (edge, level, sentence) in [
        (Rising, true, Some("mark is 1, allowed 0 before a rising edge")),
        (Rising, false, None),
        (Falling, false, Some("mark is 0, allowed 1 before a falling edge")),
        (Falling, true, None),
        (Both, true, None),
        (Both, false, None),
    ] {
        let mut rig = rig();
        rig.modify_inputs = if level { mark_is_high } else { |_| {} };
        let goal = rig.give(Action::Probe(Probe { edge, ..probe(0) }));
        assert_eq!(rig.answer(goal).is_ok(), sentence.is_none(), "{edge:?} {level}");
        if let Some(sentence) = sentence {
            assert!(rig.refusal(goal).contains(sentence), "{}", rig.refusal(goal));
        }
    }
    // Another input, and sources without a level: the drive of the axis and its index.
    let mut rig = rig();
    rig.modify_inputs = mark_is_high;
    for source in [OTHER, Object::Encoder(0), Object::Axis(X)] {
        let goal = rig.give(Action::Probe(Probe { source, ..probe(0) }));
        assert!(rig.was_accepted(goal), "{source:?}");
    }
    let index = rig.give(Action::Probe(Probe { source: Object::Axis(X), edge: ProbeEdge::Index, ..probe(0) }));
    assert!(rig.was_accepted(index));
}

/// Its latch was before the goal, so the goal never takes it.
#[test]
fn an_edge_in_the_cycle_of_the_probe_leaves_its_input_active() {
    let mut rig = rig();
    latch(&mut rig, MARK, Edge::Rising, 1);
    rig.modify_inputs = mark_is_high;
    let goal = rig.give(Action::Probe(probe(0)));
    assert!(rig.refusal(goal).starts_with("x: probe input is already active"));
}

#[test]
fn an_active_input_may_be_allowed_and_the_next_edge_counts() {
    let mut rig = rig();
    set(&mut rig, "probe_active_input", 1);
    rig.modify_inputs = mark_is_high;
    let goal = rig.give(Action::Probe(probe(1_000)));
    assert!(rig.was_accepted(goal));
    rig.run(50);
    rig.modify_inputs = |_| {};
    rig.run(50);
    rig.modify_inputs = mark_is_high;
    latch(&mut rig, MARK, Edge::Rising, 350_000);
    rig.run(1);
    assert_eq!(marks(&rig, goal)[0].position, Position::from_f64(3_732.5));
    set(&mut rig, "probe_active_input", 0);
    run_to_rest(&mut rig);
    // 3732.5 + 1000, rounded half away from zero.
    assert_eq!(ends(&rig, goal), [(Code::NONE, 4_733)], "the search under way goes on");
    let next = rig.give(Action::Probe(probe(0)));
    assert_eq!(rig.answer(next).unwrap_err().code, Code::PROBE_INPUT_ACTIVE);
}

/// Latches are those of the terminal. A filter of 5 ms shows the level 5 cycles later.
#[test]
fn a_filter_does_not_hide_that_an_input_is_active() {
    let filtered = || {
        let mut config = crate::config::MachineConfig {
            io: vec![IoConfig { name: "mark".into(), kind: IoKind::DigitalInput, latch: true }],
            ..config(0)
        };
        config.global.filters = vec![FilterConfig { input: 0, time_ns: 5_000_000 }];
        let mut rig = Rig::of(config);
        rig.enable();
        rig
    };
    let mut rig = filtered();
    rig.modify_inputs = mark_is_high;
    rig.run(2);
    assert_eq!(rig.int("mark"), 0, "the filter holds it back");
    let goal = rig.give(Action::Probe(probe(0)));
    assert!(rig.refusal(goal).contains("mark is 1"));
    rig.run(10);
    assert_eq!(rig.int("mark"), 1);
    rig.modify_inputs = |_| {};
    rig.run(1);
    assert_eq!(rig.int("mark"), 1, "the filter holds it back");
    let goal = rig.give(Action::Probe(probe(0)));
    assert!(rig.was_accepted(goal));
}

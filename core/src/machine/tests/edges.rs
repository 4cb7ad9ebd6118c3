//! Boundary cases: two events in one cycle, limits met exactly, numbers outside the range of any machine.

use super::rig::{LINE, Rig, X, Y, at, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Move, Synchronize};
use crate::drive::{Edge, Latch};
use crate::event::Kind;
use crate::modulo::{Direction, Modulo};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use crate::position::{Length, Position};
use crate::sync::Disengage;

fn x() -> AxisSet {
    AxisSet::one(X)
}

fn limited() -> Rig {
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.max_position = Some(50_000);
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

#[test]
fn a_follower_may_land_exactly_on_its_limit_or_one_before() {
    for end in [50_000, 49_999] {
        let mut rig = limited();
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        rig.give(Action::Move(to(LINE, end)));
        rig.run_until("line.state", 1);
        rig.run(100);
        assert_eq!((rig.state("x"), rig.int("x.command.position")), ("SYNCHRONIZED_MOTION", end));
    }
}

#[test]
fn a_slow_encoder_leads_right_up_to_the_limit() {
    let mut rig = limited();
    rig.give(Action::Move(to(X, 49_990)));
    rig.run_until("x.state", 1);
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
    for cycle in 0..1_000 {
        if cycle % 100 == 0 {
            rig.plant.jump_encoder(0, 1);
        }
        rig.run(1);
    }
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("SYNCHRONIZED_MOTION", 50_000));
}

/// Proves: MACS-LIM-04
#[test]
fn whatever_the_velocity_the_stop_ends_exactly_at_the_limit() {
    for velocity in [77_777.7, 33_333.3, 100_000.0, 12_345.0, 0.500_000_3] {
        let mut rig = limited();
        let start = if velocity < 1.0 { 49_999 } else { 0 };
        rig.give(Action::Move(to(X, start)));
        rig.run_until("x.state", 1);
        rig.give(Action::Move(at(X, velocity)));
        rig.run_until("x.state", 7);
        rig.run(300);
        assert_eq!(rig.int("x.command.position"), 50_000, "at {velocity} inc/s");
    }
}

#[test]
fn limits_that_the_motion_under_way_cannot_keep_are_refused() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 100_000.0)));
    rig.run(500);
    let here = rig.int("x.command.position");
    let row = Row::find("max_position").unwrap().0;
    let set = |rig: &mut Rig, limit| {
        rig.give(Action::SetParameters(Box::new([Change { axis: X, row, value: Value::Int(limit) }])))
    };
    // 100 mm/s stop within 5 mm.
    let near = set(&mut rig, here + 300);
    assert!(rig.refusal(near).contains("which the motion under way reaches"));
    let far = set(&mut rig, here + 5_200);
    assert!(rig.was_accepted(far));
    rig.run_until("x.state", 7);
    rig.run(300);
    assert_eq!(rig.int("x.command.position"), here + 5_200);
}

#[test]
fn a_slow_halt_stops_at_once_and_never_speeds_up() {
    for (start, velocity) in [(0, 10.0), (49_999, 0.01)] {
        let mut rig = limited();
        rig.give(Action::Move(to(X, start)));
        rig.run_until("x.state", 1);
        rig.give(Action::Move(at(X, velocity)));
        rig.run(150);
        let halt = rig.give(Action::Halt(x()));
        for _ in 0..3 {
            rig.run(1);
            assert!(rig.real("x.command.velocity") <= velocity * (1.0 + 1e-12));
        }
        assert_eq!((rig.state("x"), rig.done(halt).len()), ("STANDSTILL", 1));
        assert_eq!(rig.real("x.command.fraction"), 0.0);
    }
}

#[test]
fn a_follower_keeps_its_own_deceleration_and_a_standing_encoder_gives_it_no_more() {
    for leader in [Leader::AxisCommand(LINE), Leader::Encoder(0)] {
        let mut config = config(0);
        config.axes[usize::from(X)].parameters.max_deceleration = Some(100_000.0);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Synchronize(Synchronize { offset: Length::whole(5_000), ..couple(X, leader, 1, 1) }));
        for _ in 0..1_000 {
            rig.run(1);
            assert!(rig.real("x.command.acceleration").abs() <= 100_001.0);
        }
        assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (5_000, 1));
    }
}

#[test]
fn a_follower_that_lost_a_fast_leader_catches_it_again() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
    // Slowly up to 80 inc per cycle, above the default velocity of 50 inc per cycle; then a slip of 3 inc.
    for cycle in 0..3_000_i64 {
        let slip = if cycle == 2_000 { 3 } else { 0 };
        rig.plant.jump_encoder(0, (cycle / 10).min(80) + slip);
        rig.run(1);
    }
    assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.error")), (1, 0));
}

#[test]
fn keeping_the_velocity_of_an_encoder_keeps_its_mean() {
    let mut rig = Rig::enabled();
    let couple = Synchronize { disengage: Disengage::KeepVelocity, ..couple(X, Leader::Encoder(0), 1, 1) };
    let goal = rig.give(Action::Synchronize(couple));
    for cycle in 0..1_001 {
        rig.plant.jump_encoder(0, i64::from(cycle % 3 == 0));
        rig.run(1);
    }
    rig.give(Action::Cancel { goal });
    rig.run(50);
    // One count every three cycles: 333 inc/s.
    assert!((rig.real("x.command.velocity") - 333.0).abs() < 20.0, "{}", rig.real("x.command.velocity"));
}

#[test]
fn lost_leader_stops_follower_smoothly() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, Leader::AxisActual(Y), 1, 1)));
    rig.give(Action::Move(at(Y, 50_000.0)));
    rig.run(500);
    rig.plant.drive(1).unwrap().disconnect();
    let mut before = rig.real("x.command.velocity");
    for _ in 0..60 {
        rig.run(1);
        let now = rig.real("x.command.velocity");
        assert!((before - now).abs() <= 1_001.0, "{before} {now}");
        before = now;
    }
    assert_eq!((rig.state("x"), before, rig.int("x.reference")), ("ERROR_STOP", 0.0, 0));
}

#[test]
fn no_loop_is_left_when_one_of_two_couplings_of_a_cycle_is_refused() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(Y), 1, 1)));
    let last = rig.give_all(vec![
        Action::Synchronize(Synchronize { denominator: 0, ..couple(X, Leader::AxisCommand(LINE), 1, 1) }),
        Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)),
    ]);
    let rule = "both parts must not be 0 and stay below 2^62";
    assert_eq!(rig.refusal(last - 1), format!("x: ratio 1 : 0 is none, as denominator is 0; {rule}"));
    assert_eq!(rig.refusal(last), "y: the axis would follow itself");
}

/// The key with the value 0 is named: that of the request, or the parameter that replaces it.
#[test]
fn invalid_ratio_names_its_invalid_part() {
    let mut rig = Rig::enabled();
    let rule = "both parts must not be 0 and stay below 2^62";
    let geared =
        |numerator, denominator| Action::Synchronize(couple(X, Leader::AxisCommand(LINE), numerator, denominator));
    let refused = rig.give(geared(0, 7));
    assert_eq!(rig.refusal(refused), format!("x: ratio 0 : 7 is none, as numerator is 0; {rule}"));
    let large = 1_i64 << 62;
    let refused = rig.give(geared(1, large));
    assert_eq!(rig.refusal(refused), format!("x: ratio 1 : {large} is none, as denominator is {large}; {rule}"));
    // 0 : 0 selects SYNCFACTS : SYNCFACTM.
    let set = rig.set("syncfactm", Value::Int(0));
    assert!(rig.was_accepted(set));
    let refused = rig.give(geared(0, 0));
    assert_eq!(rig.refusal(refused), format!("x: ratio 1 : 0 is none, as syncfactm is 0; {rule}"));
}

#[test]
fn switching_off_and_on_again_ends_both_commands_whatever_the_delay() {
    for delay in 0..5 {
        let mut rig = Rig::of(config(delay));
        rig.enable();
        let last = rig.give_all(vec![Action::Disable(x()), Action::Enable(x())]);
        rig.run(40);
        // The enable came while the axis was being switched off, or after that.
        let answered = rig.done(last).len() + usize::from(!rig.done(last - 1).is_empty());
        assert!(answered >= 1 && rig.done(last - 1).len() == 1, "delay {delay}");
        let again = rig.give(Action::Enable(x()));
        rig.run(40);
        assert_eq!((rig.state("x"), rig.done(again)[0].code), ("STANDSTILL", Code::NONE), "delay {delay}");
    }
}

#[test]
fn a_reset_that_waits_does_not_clear_what_comes_after_it() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 100_000.0)));
    rig.run(300);
    rig.give(Action::QuickStop(x()));
    let reset = rig.give(Action::ResetErrors(x()));
    rig.run(10);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(30);
    assert_eq!((rig.state("x"), rig.done(reset)[0].code), ("ERROR_STOP", Code::drive_fault(0x8611)));
}

#[test]
fn a_drive_in_fault_is_reset_while_its_axis_is_off() {
    let mut rig = Rig::new();
    rig.run(5);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(5);
    let reset = rig.give(Action::ResetErrors(x()));
    rig.run(10);
    assert_eq!((rig.int("x.drive_state"), rig.done(reset)[0].code), (1, Code::NONE));
}

#[test]
fn sixty_goals_in_one_cycle_are_all_ended() {
    let mut rig = Rig::enabled();
    let last = rig.give_all(vec![Action::Move(to(X, 5_000)); 60]);
    rig.run_until("x.state", 1);
    for sequence in last - 59..=last {
        assert_eq!(rig.done(sequence).len(), 1);
    }
    assert!(!rig.events.iter().any(|event| event.code == Code::EVENTS_LOST));
}

#[test]
fn extreme_numbers_neither_jump_nor_panic() {
    let mut config = config(0);
    config.axes[usize::from(X)].modulo = Modulo::new(36_000, 1);
    let parameters = &mut config.axes[usize::from(X)].parameters;
    (parameters.max_velocity, parameters.max_acceleration) = (1e15, 1e15);
    parameters.max_following_error = 1 << 61;
    let mut rig = Rig::of(config);
    rig.enable();
    let tiny = rig.give(Action::Move(Move { acceleration: 1e-200, ..to(X, 900) }));
    assert!(rig.refusal(tiny).contains("too low"));
    rig.give(Action::Move(Move { acceleration: 1e15, ..at(X, 1e13) }));
    rig.run(50);
    let weak = rig.give(Action::Move(Move { direction: Direction::Positive, deceleration: 1e-6, ..to(X, 5) }));
    assert!(rig.refusal(weak).contains("2^62"));
}

/// Revolution of 333 1/3 inc, in thirds of an increment: half a revolution is 166 2/3. SHORTEST moves up by it from the
/// end of any goal, although goals end on whole increments. The end position of a goal is never a revolution away, in
/// any direction mode.
#[test]
fn half_a_turn_is_judged_before_rounding() {
    let mut config = config(0);
    config.axes[usize::from(X)].modulo = Modulo::new(1_000, 3);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.mirror();
    let mut go = |thirds: i64, direction, end: i64| {
        let exact = Position::from_raw(((i128::from(thirds) << 33) + 3).div_euclid(6));
        let target = Length { nearest: exact.nearest(), rest: exact - Position::whole(exact.nearest()) };
        let goal = rig.give(Action::Move(Move { direction, target, ..to(X, 0) }));
        rig.run(150);
        assert_eq!((rig.done(goal).len(), rig.int("x.actual.position")), (1, end), "{direction:?} {thirds}/3");
    };
    use Direction::{Negative, Positive, Shortest};
    for (thirds, direction, end) in [
        (500, Shortest, 167),
        (0, Shortest, 333),
        (500, Shortest, 500),
        (0, Negative, 333),
        (500, Negative, 167),
        (500, Positive, 167),
        (500, Negative, 167),
        (0, Negative, 0),
        (500, Negative, -167),
        (500, Positive, -167),
        (0, Shortest, 0),
        (0, Positive, 0),
        (499, Shortest, 166),
        (0, Shortest, 0),
        (501, Shortest, -166),
    ] {
        go(thirds, direction, end);
    }
    go(0, Shortest, 0);
    for halves in 1..30 {
        go(halves % 2 * 500, Shortest, (halves * 1_000 + 3).div_euclid(6));
    }
}

#[test]
fn a_latch_of_raw_counts_is_found_beyond_the_wrap() {
    let mut rig = Rig::enabled();
    let mut inputs = rig.machine.inputs();
    let mut outputs = rig.machine.outputs();
    let mut count = 0_i64;
    for cycle in 0..2_001 {
        count += 50;
        inputs.encoder[0] = crate::drive::EncoderInput { count: count & 0xFFFF, epoch: 0, valid: true, index: None };
        inputs.latch.clear();
        if cycle == 2_000 {
            let position = Some((count - 25) & 0xFFFF);
            inputs.add_latch(Latch { object: Object::Encoder(0), edge: Edge::Rising, age_ns: None, position });
        }
        rig.machine.cycle(&inputs, Default::default(), &mut outputs);
    }
    let latch = rig.machine.events().iter().find(|event| event.kind == Kind::Latch).unwrap();
    // The first count of the belt, 50, is its position.
    assert_eq!((latch.position.floor(), latch.age_ns), (count - 25, 500_000));
}

#[test]
fn in_position_time_restarts_after_power_off() {
    let mut config = config(0);
    let parameters = &mut config.axes[usize::from(X)].parameters;
    (parameters.in_position_window, parameters.in_position_time) = (10, 100_000_000);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.run(300);
    rig.give(Action::Disable(x()));
    rig.run(20);
    let on = rig.give(Action::Enable(x()));
    while rig.done(on).is_empty() {
        rig.run(1);
    }
    assert_eq!(rig.int("x.in_position"), 0);
    rig.run(110);
    assert_eq!(rig.int("x.in_position"), 1);
}

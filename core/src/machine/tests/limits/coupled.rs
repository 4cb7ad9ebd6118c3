//! An axis that follows a leader, at any low speed, never exceeds a software limit.

use super::super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Move, MoveMode, Synchronize};
use crate::config::SumConfig;
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, MACHINE, Row, Value};
use crate::position::Length;
use crate::sync::{Disengage, SyncMode};
use proptest::prelude::*;

/// Limits of x (inc).
const LOW: i64 = -700;
const HIGH: i64 = 1_000;

fn cell(cycle_ms: u64, rate: f64, posdrct: i64) -> Rig {
    braking(cycle_ms, rate, posdrct, None)
}

fn braking(cycle_ms: u64, rate: f64, posdrct: i64, deceleration: Option<f64>) -> Rig {
    let mut config = config(0);
    config.cycle_ns = cycle_ms * 1_000_000;
    // The line changes its velocity in one cycle.
    config.axes[usize::from(LINE)].parameters.max_acceleration = 1e9;
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.min_position, p.max_position) = (Some(LOW), Some(HIGH));
    (p.max_acceleration, p.max_jerk, p.macs.posdrct) = (rate, Some(rate * 20.0), posdrct);
    p.max_deceleration = deceleration;
    p.encoder.mencodertype = 6;
    let (add, subtract) = (vec![Leader::AxisCommand(LINE), Leader::Encoder(0)], vec![Leader::AxisActual(Y)]);
    config.masters = vec![SumConfig { name: "sum".into(), add, subtract }];
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn place(rig: &Rig) -> f64 {
    rig.int("x.command.position") as f64 + rig.real("x.command.fraction")
}

fn set(rig: &mut Rig, axis: u16, key: &str, value: Value) -> u64 {
    rig.give(Action::SetParameters([Change { axis, row: Row::find(key).unwrap().0, value }].into()))
}

fn go_to(rig: &mut Rig, position: i64) {
    rig.give(Action::Move(to(X, position)));
    rig.run_until("x.state", 1);
}

fn errors(rig: &Rig) -> Vec<Code> {
    let found = rig.events.iter().filter(|event| event.kind == Kind::Error);
    found.map(|event| event.code).collect()
}

/// At 1 inc per cycle, with a possible change of 1 per cycle, the 1000th inc is the last one: the 1001st is an error.
///
/// Proves: MACS-LIM-04
#[test]
fn a_coupling_of_an_increment_a_cycle_ends_on_the_limit() {
    for (way, limit, code) in [(1, HIGH, Code::SOFTWARE_LIMIT_POSITIVE), (-1, -LOW, Code::SOFTWARE_LIMIT_NEGATIVE)] {
        for posdrct in [1, -1] {
            let mut rig = cell(1, 1e6, posdrct);
            rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
            rig.run(2);
            for _ in 0..limit {
                rig.plant.jump_encoder(0, way);
                rig.run(1);
                assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
            }
            assert_eq!((place(&rig), errors(&rig)), ((way * limit) as f64, vec![]));
            rig.plant.jump_encoder(0, way);
            rig.run(1);
            assert_eq!((rig.state("x"), place(&rig)), ("ERROR_STOP", (way * limit) as f64));
            rig.run(100);
            assert_eq!((errors(&rig), place(&rig)), (vec![code], (way * limit) as f64));
            assert_eq!(rig.real("x.command.velocity"), 0.0);
        }
    }
}

/// An axis at its limit stays there when its leader moves further, at any velocity, and follows it back.
///
/// Proves: MACS-LIM-04, MACS-LIM-05
#[test]
fn from_its_limit_an_axis_is_led_away_and_nowhere_else() {
    for speed in [1e-3, 100.0, 1_000.0, 90_000.0] {
        let mut rig = cell(1, 2e6, 1);
        go_to(&mut rig, HIGH);
        rig.give(Action::Move(at(LINE, speed)));
        rig.run(200);
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        rig.run(1);
        assert_eq!((rig.state("x"), place(&rig)), ("ERROR_STOP", HIGH as f64), "at {speed} inc/s");
        assert_eq!(errors(&rig), [Code::SOFTWARE_LIMIT_POSITIVE]);
        // A new attempt, and another one.
        for attempt in 1..3 {
            rig.give(Action::ResetErrors(AxisSet::one(X)));
            rig.run(1);
            rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
            rig.run(1);
            assert_eq!((rig.state("x"), place(&rig)), ("ERROR_STOP", HIGH as f64), "at {speed} inc/s");
            assert_eq!(errors(&rig)[attempt], Code::LIMIT_VIOLATION);
        }
        let last = rig.events.iter().rfind(|event| event.kind == Kind::Error).unwrap();
        let sentence = crate::text::message(last, rig.machine.config());
        assert!(sentence.ends_with("mm/s leads further into the limit at 1 mm"), "{sentence}");
        rig.give(Action::Move(at(LINE, -speed)));
        rig.run(200);
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(1);
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        rig.run(5);
        assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
        assert!(place(&rig) < HIGH as f64);
    }
}

/// An axis outside its limit may be led back by a leader with count noise, but a leader that creeps outwards does not
/// move it.
#[test]
fn led_back_from_beyond_its_limit_it_may_tremble_but_not_creep() {
    let mut rig = cell(1, 2e6, 1);
    go_to(&mut rig, HIGH);
    let lowered = set(&mut rig, X, "max_position", Value::Int(HIGH - 500));
    assert!(rig.was_accepted(lowered));
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
    for change in [0, 1, -1, 0, -2, -4, -6, -5, -3, -1, 1, -1, -1, 1, 0, 0] {
        rig.plant.jump_encoder(0, change);
        rig.run(1);
        assert_eq!((rig.state("x"), errors(&rig)), ("SYNCHRONIZED_MOTION", vec![]), "{change}");
    }
    rig.run(5);
    let inmost = place(&rig);
    assert!(inmost < HIGH as f64 - 20.0, "{inmost}");
    for _ in 0..20 {
        rig.plant.jump_encoder(0, 1);
        rig.run(10);
    }
    assert_eq!((rig.state("x"), errors(&rig)), ("ERROR_STOP", vec![Code::SOFTWARE_LIMIT_POSITIVE]));
    assert!(place(&rig) <= inmost + 4.0, "{} from {inmost}", place(&rig));
}

/// Each motion is done in one cycle: 3 inc with the limit 1 inc away.
///
/// Proves: MACS-LIM-04
#[test]
fn a_superimposed_way_of_one_cycle_ends_at_the_limit() {
    let mut rig = cell(20, 1e6, 1);
    go_to(&mut rig, HIGH - 1);
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    rig.run(5);
    rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, 3) }));
    rig.run(20);
    assert_eq!((rig.state("x"), errors(&rig)), ("ERROR_STOP", vec![Code::SOFTWARE_LIMIT_POSITIVE]));
    assert!(((HIGH - 1) as f64..=HIGH as f64).contains(&place(&rig)), "{}", place(&rig));
}

/// At 0.001 inc/s the 30 inc to the limit would take more than eight hours.
#[test]
fn stopped_axis_does_not_creep_to_the_limit() {
    let mut rig = cell(20, 1e6, 1);
    go_to(&mut rig, HIGH - 30);
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    rig.give(Action::Move(at(LINE, 1e-3)));
    rig.run(5);
    rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, 45) }));
    rig.run(5);
    assert_eq!((errors(&rig), rig.real("x.command.velocity")), (vec![Code::SOFTWARE_LIMIT_POSITIVE], 0.0));
    assert!((place(&rig) - (HIGH - 30) as f64).abs() < 0.1, "{}", place(&rig));
}

/// Two increments per count: a cycle cannot brake the velocity of one count, and the axis still ends at its limit.
///
/// Proves: MACS-LIM-04
#[test]
fn counts_that_are_larger_than_a_cycle_may_stop_end_on_the_limit() {
    for (way, limit) in [(1, HIGH), (-1, LOW)] {
        for halts in [false, true] {
            let mut rig = cell(1, 1.5e6, 1);
            rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 2, 1)));
            rig.run(2);
            for _ in 0..limit.abs() / 2 {
                rig.plant.jump_encoder(0, way);
                rig.run(1);
            }
            assert_eq!((place(&rig), errors(&rig)), (limit as f64, vec![]));
            rig.plant.jump_encoder(0, way);
            if halts {
                rig.give(Action::Halt(AxisSet::one(X)));
            }
            rig.run(100);
            assert_eq!((errors(&rig).len(), place(&rig)), (1, limit as f64));
        }
    }
}

/// Four increments per count, one count in each cycle: 4000 inc/s, which a cycle may reduce by 100.
///
/// Proves: MACS-LIM-04
#[test]
fn coarse_counts_leave_the_way_that_a_stop_takes() {
    let mut rig = cell(1, 1e5, 1);
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 4, 1)));
    rig.run(2);
    let mut before = 0.0;
    for cycle in 0..400 {
        rig.plant.jump_encoder(0, 1);
        rig.run(1);
        let velocity = rig.real("x.command.velocity");
        // In 8 cycles it moved 32 inc, within one count. Since then it may have lost at most 0.35 of 3.5 inc per cycle:
        // a stop from 3.15 inc takes 48 inc, of which one count may be missing. 4^2 / (2 * 44) inc per cycle, and 0.05
        // at the end of a step.
        assert!(cycle < 8 || before - velocity < 235.0, "{} in cycle {cycle}", before - velocity);
        before = velocity;
    }
    assert_eq!((rig.state("x"), errors(&rig)), ("ERROR_STOP", vec![Code::SOFTWARE_LIMIT_POSITIVE]));
    assert_eq!((place(&rig), before), (HIGH as f64, 0.0));
}

/// The same speed, but the leader itself decelerates, with the limit of the axis: the axis ends at its limit, without
/// an error.
#[test]
fn coarse_counts_of_a_leader_that_stops_in_time_are_no_error() {
    for (share, start) in [(0.99_f64, 0.0_f64), (0.99, 1.7), (0.5, 0.3), (0.1, 2.9)] {
        let mut rig = cell(1, 1e5, 1);
        // From 4 inc per cycle with this share of 0.1 inc/cycle^2: to the limit, in whole counts.
        let rate = 0.1 * share;
        let way = 16.0 / (2.0 * rate);
        let counts = ((way + start) / 4.0).floor() as i64;
        let before = 40;
        go_to(&mut rig, HIGH - 4 * (counts + before));
        rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 4, 1)));
        rig.run(2);
        for _ in 0..before {
            rig.plant.jump_encoder(0, 1);
            rig.run(1);
        }
        let mut shown = 0;
        for cycle in 1..=(4.0 / rate) as i64 + 1 {
            let time = (cycle as f64).min(4.0 / rate);
            let place = ((start + 4.0 * time - rate * time * time / 2.0) / 4.0).floor() as i64;
            rig.plant.jump_encoder(0, place - shown);
            shown = place;
            rig.run(1);
            assert_eq!((rig.state("x"), errors(&rig)), ("SYNCHRONIZED_MOTION", vec![]), "{share} {start} {cycle}");
        }
        rig.run(5);
        assert_eq!((place(&rig), shown), (HIGH as f64, counts));
    }
}

/// A halt of an axis that reached the limit at a velocity that one cycle can stop keeps it there.
///
/// Proves: MACS-LIM-04
#[test]
fn a_halt_on_the_limit_stands_there() {
    let mut rig = cell(1, 2e6, 1);
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
    rig.run(2);
    for _ in 1..HIGH / 2 {
        rig.plant.jump_encoder(0, 2);
        rig.run(1);
    }
    assert_eq!((place(&rig), rig.real("x.command.velocity")), ((HIGH - 2) as f64, 2_000.0));
    rig.plant.jump_encoder(0, 2);
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(20);
    assert_eq!((rig.state("x"), place(&rig), errors(&rig)), ("STANDSTILL", HIGH as f64, vec![]));
}

/// A thousandth of an increment per cycle.
///
/// Proves: MACS-LIM-04
#[test]
fn a_velocity_of_an_increment_in_many_cycles_ends_at_the_limit() {
    for (start, velocity, limit) in [(HIGH - 1, 1.3, HIGH), (LOW + 1, -1.3, LOW)] {
        let mut rig = cell(1, 2e6, 1);
        go_to(&mut rig, start);
        let goal = rig.give(Action::Move(at(X, velocity)));
        for _ in 0..2_000 {
            rig.run(1);
            assert!((LOW as f64..=HIGH as f64).contains(&place(&rig)), "{}", place(&rig));
        }
        assert_eq!((rig.state("x"), place(&rig), rig.done(goal).len()), ("ERROR_STOP", limit as f64, 1));
    }
}

/// The override is restored while the axis brakes, and is checked again in each cycle until the new plan fits. A
/// superimposed motion that accelerates the axis meanwhile does not matter: the base motion and the rest of the
/// superimposed distance count together.
#[test]
fn an_override_that_comes_back_below_a_superimposed_motion_keeps_the_limit() {
    let mut rig = cell(1, 155_020.447_424_407_32, 1);
    set(&mut rig, X, "profile", Value::Int(1));
    set(&mut rig, X, "velocity_override", Value::Real(21.637_311_118_131_63));
    rig.give(Action::Move(at(LINE, 1_000.0)));
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 3, 2)));
    rig.run(13);
    rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, -26) }));
    rig.run(365);
    rig.give(Action::Move(to(X, LOW + 1)));
    rig.run(1);
    rig.give(Action::Move(to(X, LOW)));
    set(&mut rig, X, "velocity_override", Value::Real(100.0));
    rig.run(201);
    let added = rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, 24) }));
    assert!(rig.was_accepted(added));
    let mut highest = LOW as f64;
    for _ in 0..2_000 {
        rig.run(1);
        highest = highest.max(place(&rig));
    }
    assert!(highest < HIGH as f64, "{highest}");
    assert_eq!((rig.state("x"), errors(&rig)), ("STANDSTILL", vec![]));
}

#[derive(Clone, Debug)]
enum RandomEvent {
    Couple {
        leader: usize,
        velocity_only: bool,
        keeps: bool,
        ratio: (i64, i64),
        offset: i64,
    },
    /// The line, the simulated master of x, the virtual master, or x itself at a velocity.
    Line(f64),
    Simulated(f64),
    Virtual(f64),
    Velocity(f64),
    Stream(f64, u64),
    Position(i64),
    Add(i64),
    Override(f64),
    /// Counts of the belt per cycle, and the number of cycles.
    Belt(i64, u64),
    Cancel,
    Halt,
    Reset,
    Run(u64),
}

fn speed() -> impl Strategy<Value = f64> {
    let size = prop_oneof![1e-3..5.0_f64, 5.0..3_000.0_f64, Just(1_000.0), Just(2_000.0), 3_000.0..100_000.0_f64];
    (size, any::<bool>()).prop_map(|(size, down)| if down { -size } else { size })
}

fn random_event() -> impl Strategy<Value = RandomEvent> {
    use RandomEvent::*;
    let couple = (0_usize..6, any::<bool>(), any::<bool>(), (-5_i64..6, 1_i64..4), -20_i64..20);
    let couple = couple.prop_map(|(leader, velocity_only, keeps, ratio, offset)| Couple {
        leader,
        velocity_only,
        keeps,
        ratio: if ratio.0 == 0 { (1, 1) } else { ratio },
        offset,
    });
    prop_oneof![
        6 => couple,
        4 => speed().prop_map(Line),
        2 => speed().prop_map(Simulated),
        2 => speed().prop_map(Virtual),
        1 => speed().prop_map(Velocity),
        1 => (speed(), 1_u64..50).prop_map(|(speed, cycles)| Stream(speed, cycles)),
        2 => prop_oneof![Just(LOW), Just(HIGH), Just(LOW + 1), Just(HIGH - 1), LOW..=HIGH].prop_map(Position),
        3 => (-30_i64..30).prop_map(Add),
        1 => prop_oneof![Just(0.0), Just(100.0), 0.0..100.0_f64].prop_map(Override),
        2 => (-4_i64..5, 1_u64..60).prop_map(|(by, cycles)| Belt(by, cycles)),
        1 => Just(Cancel),
        1 => Just(Halt),
        4 => Just(Reset),
        6 => (1_u64..300).prop_map(Run),
    ]
}

fn is_kept(rig: &Rig) -> Result<(), TestCaseError> {
    let here = place(rig);
    prop_assert!((LOW as f64..=HIGH as f64).contains(&here), "x is at {} as {}", here, rig.state("x"));
    Ok(())
}

/// A superimposed motion at rest stops in the shape of the profile, which takes more distance than a constant
/// deceleration.
///
/// Proves: MACS-LIM-02
#[test]
fn what_is_added_at_rest_has_the_way_that_its_shape_takes() {
    let mut rig = braking(1, 2_818_531.0, 1, None);
    set(&mut rig, X, "profile", Value::Int(1));
    let line = |velocity| vec![Action::Move(at(LINE, velocity)), Action::Move(at(Y, velocity))];
    rig.give_all(line(-2_413.38));
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 2, 1)));
    rig.run(112);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(13);
    let goal = rig.give(Action::Move(at(X, 2_843.6)));
    rig.give_all(line(0.001));
    rig.give(Action::Cancel { goal });
    rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, -14) }));
    for _ in 0..200 {
        rig.run(1);
        is_kept(&rig).unwrap();
    }
}

proptest! {
    #![proptest_config(cases(150))]

    /// Any leader, at any velocity, engaged at any position, with any superimposed motion.
    ///
    /// Proves: MACS-LIM-02, MACS-LIM-04
    #[test]
    fn follower_never_exceeds_a_limit(
        cycle_ms in prop::sample::select(vec![1_u64, 2, 4, 20]),
        rate in 1e5..5e6_f64,
        deceleration in prop::option::of(0.1..3.0_f64),
        posdrct in prop::sample::select(vec![1_i64, -1]),
        profile in 0_i64..3,
        happenings in prop::collection::vec(random_event(), 1..40),
    ) {
        let mut rig = braking(cycle_ms, rate, posdrct, deceleration.map(|share| rate * share));
        set(&mut rig, X, "profile", Value::Int(profile));
        let mut goal = 0;
        for happening in happenings {
            match happening {
                RandomEvent::Couple { leader, velocity_only, keeps, ratio, offset } => {
                    let leader = [
                        Leader::AxisCommand(LINE), Leader::AxisActual(Y), Leader::Encoder(0), Leader::Simulated(X),
                        Leader::Sum(0), Leader::Virtual,
                    ][leader];
                    goal = rig.give(Action::Synchronize(Synchronize {
                        mode: if velocity_only { SyncMode::Velocity } else { SyncMode::Position },
                        disengage: if keeps { Disengage::KeepVelocity } else { Disengage::Stop },
                        offset: Length::whole(offset),
                        ..couple(X, leader, ratio.0, ratio.1)
                    }));
                }
                RandomEvent::Line(velocity) => {
                    rig.give_all(vec![Action::Move(at(LINE, velocity)), Action::Move(at(Y, velocity))]);
                }
                RandomEvent::Virtual(velocity) => {
                    // It changes its velocity in one cycle, too.
                    set(&mut rig, MACHINE, "pulsacc", Value::Int(-1));
                    set(&mut rig, MACHINE, "setsys_15", Value::Int(velocity as i64));
                }
                RandomEvent::Simulated(velocity) => {
                    set(&mut rig, X, "master_simulation_velocity", Value::Real(velocity));
                }
                RandomEvent::Velocity(velocity) => goal = rig.give(Action::Move(at(X, velocity))),
                RandomEvent::Stream(velocity, cycles) => {
                    for _ in 0..cycles {
                        rig.stream(X, velocity);
                        is_kept(&rig)?;
                    }
                }
                RandomEvent::Position(position) => goal = rig.give(Action::Move(to(X, position))),
                RandomEvent::Add(way) => {
                    rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, way) }));
                }
                RandomEvent::Override(share) => {
                    set(&mut rig, X, "velocity_override", Value::Real(share));
                }
                RandomEvent::Belt(by, cycles) => {
                    for _ in 0..cycles {
                        rig.plant.jump_encoder(0, by);
                        rig.run(1);
                        is_kept(&rig)?;
                    }
                }
                RandomEvent::Cancel => {
                    rig.give(Action::Cancel { goal });
                }
                RandomEvent::Halt => {
                    rig.give(Action::Halt(AxisSet::one(X)));
                }
                RandomEvent::Reset => {
                    rig.give(Action::ResetErrors(AxisSet::one(X)));
                }
                RandomEvent::Run(cycles) => {
                    for _ in 0..cycles {
                        rig.run(1);
                        is_kept(&rig)?;
                    }
                }
            }
            is_kept(&rig)?;
        }
        let limits = [Code::SOFTWARE_LIMIT_POSITIVE, Code::SOFTWARE_LIMIT_NEGATIVE, Code::LIMIT_VIOLATION];
        for code in errors(&rig) {
            prop_assert!(limits.contains(&code), "error {:?}", code);
        }
        // An axis that is at rest or stopped at the limit can move back.
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(2_000);
        rig.give(Action::ResetErrors(AxisSet::first(3)));
        rig.run(2);
        set(&mut rig, X, "velocity_override", Value::Real(100.0));
        let back = rig.give(Action::Move(to(X, 0)));
        rig.run(3_000);
        prop_assert_eq!((rig.done(back).len(), place(&rig)), (1, 0.0), "{} {:?}", rig.state("x"), rig.events.last());
    }
}

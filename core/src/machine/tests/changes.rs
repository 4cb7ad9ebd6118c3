//! Changes of target, limits, shape, override and stops at any moment: the axis never exceeds a limit, never moves
//! without a goal, and finally rests on a whole increment.

use super::rig::{Rig, X, at, cases, config, to};
use crate::command::{Action, BufferMode, Move, MoveMode};
use crate::modulo::{Direction, Modulo};
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use proptest::prelude::*;

const MAX_VELOCITY: f64 = 100_000.0;
const MAX_ACCELERATION: f64 = 1_000_000.0;
const MAX_JERK: f64 = 2e7;
const LOW: i64 = -40_000;
const HIGH: i64 = 50_000;
const CYCLE: f64 = 1e-3;

#[derive(Clone, Debug)]
enum RandomCommand {
    Move(Move),
    Set(&'static str, Value),
    Halt,
    QuickStop,
    Cancel,
    /// Cancels the goal that was given this many goals ago.
    CancelOlder(usize),
    Disable,
    /// A fault of the drive.
    Fault,
    /// A new streamed setpoint.
    Stream(f64),
}

fn rate(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(most), (0.02..1.0_f64).prop_map(move |share| share * most)]
}

fn random_command() -> impl Strategy<Value = RandomCommand> {
    use MoveMode::{Absolute, Additive, Relative, Superimposed, Velocity};
    let mode = prop::sample::select(vec![Absolute, Absolute, Relative, Additive, Superimposed, Velocity]);
    let position = prop_oneof![LOW..=HIGH, -30_i64..30, Just(HIGH), Just(LOW)];
    let rates =
        (rate(MAX_VELOCITY), any::<bool>(), rate(MAX_ACCELERATION), rate(MAX_ACCELERATION / 2.0), rate(MAX_JERK));
    let buffer = prop::sample::select(vec![
        BufferMode::Aborting,
        BufferMode::Aborting,
        BufferMode::Aborting,
        BufferMode::Buffered,
        BufferMode::BlendingLow,
        BufferMode::BlendingPrevious,
        BufferMode::BlendingNext,
        BufferMode::BlendingHigh,
    ]);
    use Direction::{Current, Negative, Positive, Shortest};
    let direction = prop::sample::select(vec![Shortest, Positive, Negative, Current]);
    let moves = (mode, position, rates, buffer, direction).prop_map(
        |(mode, position, (velocity, back, acceleration, deceleration, jerk), buffer_mode, direction)| {
            let sign = if back && mode == Velocity { -1.0 } else { 1.0 };
            let base = if mode == Velocity { at(X, 0.0) } else { to(X, position) };
            RandomCommand::Move(Move {
                mode,
                velocity: sign * velocity,
                acceleration,
                deceleration,
                jerk,
                buffer_mode,
                direction,
                ..base
            })
        },
    );
    prop_oneof![
        8 => moves,
        2 => prop_oneof![Just(0.0), Just(100.0), 0.0..100.0_f64].prop_map(|share| RandomCommand::Set("velocity_override", Value::Real(share))),
        1 => (0_i64..3).prop_map(|shape| RandomCommand::Set("profile", Value::Int(shape))),
        1 => (0.1..1.0_f64).prop_map(|share| RandomCommand::Set("max_jerk", Value::Real(share * MAX_JERK))),
        1 => (0_i64..40_000_000).prop_map(|time| RandomCommand::Set("jerkmin3", Value::Int(time + 50_000_000))),
        1 => Just(RandomCommand::Halt),
        1 => Just(RandomCommand::QuickStop),
        1 => Just(RandomCommand::Cancel),
        1 => (0_usize..4).prop_map(RandomCommand::CancelOlder),
        1 => prop_oneof![Just(HIGH), 0..HIGH].prop_map(|high| RandomCommand::Set("max_position", Value::Int(high))),
        1 => prop_oneof![Just(LOW), LOW..0].prop_map(|low| RandomCommand::Set("min_position", Value::Int(low))),
        1 => prop_oneof![Just(0.0), -MAX_VELOCITY..MAX_VELOCITY].prop_map(RandomCommand::Stream),
        1 => prop_oneof![Just(RandomCommand::Disable), Just(RandomCommand::Fault)],
    ]
}

/// Signals of the command of x.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    position: f64,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
}

fn seen(rig: &Rig) -> Seen {
    Seen {
        position: rig.int("x.command.position") as f64 + rig.real("x.command.fraction"),
        velocity: rig.real("x.command.velocity"),
        acceleration: rig.real("x.command.acceleration"),
        jerk: rig.real("x.command.jerk"),
    }
}

/// Returns true if the command is at rest and remains at rest: a stop with limited jerk may reverse.
fn is_at_rest(rig: &Rig) -> bool {
    let now = seen(rig);
    (now.velocity, now.acceleration) == (0.0, 0.0)
}

/// Returns the first rule that the step from `before` to `now` violates.
fn fault(before: Seen, now: Seen, (low, high): (f64, f64), only_jerk: bool, inverted: bool) -> Option<String> {
    let near = 1.0 + 1e-9;
    if now.velocity.abs() > MAX_VELOCITY * near {
        return Some(format!("velocity {}", now.velocity));
    }
    let braking = now.velocity * now.acceleration < 0.0;
    let most = if braking { MAX_ACCELERATION / 2.0 } else { MAX_ACCELERATION };
    // At a velocity near 0 the axis brakes and starts within one cycle.
    let turns = now.velocity.abs() <= MAX_ACCELERATION * CYCLE;
    if now.acceleration.abs() > if turns { MAX_ACCELERATION } else { most } * near {
        return Some(format!("acceleration {} at {}", now.acceleration, now.velocity));
    }
    if only_jerk && now.jerk.abs() > MAX_JERK * near {
        return Some(format!("jerk {}", now.jerk));
    }
    if only_jerk && (now.acceleration - before.acceleration).abs() > MAX_JERK * CYCLE * near + 1e-3 {
        return Some(format!("acceleration from {} to {}", before.acceleration, now.acceleration));
    }
    if (now.velocity - before.velocity).abs() > MAX_ACCELERATION * CYCLE * near {
        return Some(format!("velocity from {} to {}", before.velocity, now.velocity));
    }
    // Simpson's rule needs the midpoint; the error of the trapezoidal rule is a twelfth of the change of acceleration,
    // and a stop ends on the increment below.
    let way = now.position - before.position - 0.5 * (now.velocity + before.velocity) * CYCLE;
    if way.abs() > MAX_ACCELERATION * CYCLE * CYCLE / 2.0 + 1.001 {
        return Some(format!("position off by {way}"));
    }
    // If a limit was set behind an axis at rest, the axis may only return; a stop ends on the increment below, as the
    // drive counts.
    let here = before.position;
    let (lowest, highest) = if inverted { (here, here.ceil()) } else { (here.floor(), here) };
    if now.position > high.max(highest) || now.position < low.min(lowest) {
        return Some(format!("position {} beyond a limit", now.position));
    }
    None
}

fn run(deeds: &[(RandomCommand, u64)], shape: i64, modulo: bool, sense: (i64, i64)) -> Result<(), TestCaseError> {
    let mut config = config(0);
    config.axes[usize::from(X)].modulo = Modulo::new(100_001, 3).filter(|_| modulo);
    let p = &mut config.axes[usize::from(X)].parameters;
    p.max_deceleration = Some(MAX_ACCELERATION / 2.0);
    (p.max_jerk, p.profile) = (Some(MAX_JERK), shape);
    (p.macs.posdrct, p.macs.revers) = sense;
    (p.min_position, p.max_position) = (Some(LOW), Some(HIGH));
    // Violations of limits by a velocity goal are reported without an error lock.
    p.error_reaction = 2;
    let mut rig = Rig::of(config);
    rig.enable();
    // A jerk limit that was lowered in motion may be exceeded already.
    let shapes_change =
        deeds.iter().any(|(deed, _)| matches!(deed, RandomCommand::Set("profile" | "max_jerk" | "jerkmin3", _)));
    let only_jerk = shape == 2 && !shapes_change;
    let (mut goals, mut before) = (Vec::new(), seen(&rig));
    for (deed, cycles) in deeds {
        let action = match deed {
            RandomCommand::Move(request) => Action::Move(*request),
            RandomCommand::Set(key, value) => {
                let (row, _) = Row::find(key).unwrap();
                Action::SetParameters([Change { axis: X, row, value: *value }].into())
            }
            RandomCommand::Halt => Action::Halt(AxisSet::one(X)),
            RandomCommand::QuickStop => Action::QuickStop(AxisSet::one(X)),
            RandomCommand::Cancel => Action::Cancel { goal: goals.last().copied().unwrap_or(0) },
            RandomCommand::CancelOlder(back) => {
                Action::Cancel { goal: goals.iter().rev().nth(*back).copied().unwrap_or(0) }
            }
            RandomCommand::Disable => Action::Disable(AxisSet::one(X)),
            // Another request that names no axis.
            RandomCommand::Fault | RandomCommand::Stream(_) => Action::SetParameters([].into()),
        };
        let is_move = matches!(action, Action::Move(_));
        if matches!(deed, RandomCommand::Fault) {
            rig.plant.drive(0).unwrap().inject_fault(0x8611);
        }
        if let RandomCommand::Stream(velocity) = deed {
            rig.stream(X, *velocity);
        } else {
            let sequence = rig.give(action);
            if is_move {
                goals.push(sequence);
            }
        }
        let p = rig.machine.parameters(X).unwrap();
        let limits = (p.min_position.unwrap() as f64, p.max_position.unwrap() as f64);
        for cycle in 0..=*cycles {
            if cycle > 0 {
                rig.run(1);
            }
            let now = seen(&rig);
            if rig.int("x.enabled") == 0 {
                before = now;
                continue;
            }
            // A stop that would exceed a limit with its profile shape brakes without the shape, and ends at the limit.
            let at_limit = [limits.0, limits.1].contains(&(rig.int("x.target.position") as f64))
                && !matches!(deed, RandomCommand::Move(_));
            // A motion that would swing back although this is forbidden stops at once.
            let is_held = sense.1 == 2 && now.velocity == 0.0;
            let broken = fault(
                before,
                now,
                limits,
                only_jerk && !at_limit && !is_held && rig.state("x") != "ERROR_STOP",
                sense.0 < 0,
            );
            prop_assert!(
                broken.is_none(),
                "{} after {:?} in cycle {}: {:?} -> {:?}",
                broken.unwrap(),
                deed,
                cycle,
                before,
                now
            );
            if rig.state("x") == "STANDSTILL" {
                prop_assert_eq!((now.velocity, now.acceleration), (0.0, 0.0));
                prop_assert_eq!(now.position.fract(), 0.0);
            }
            before = now;
        }
        if ["STOPPING", "ERROR_STOP"].contains(&rig.state("x")) && is_at_rest(&rig) {
            let sequence = rig.give(Action::ResetErrors(AxisSet::one(X)));
            rig.run(20);
            prop_assert_eq!(rig.done(sequence).len(), 1);
        }
        if rig.state("x") == "DISABLED" {
            let sequence = rig.give(Action::Enable(AxisSet::one(X)));
            rig.run(20);
            prop_assert_eq!(rig.done(sequence).len(), 1);
            prop_assert_eq!(rig.state("x"), "STANDSTILL");
        }
        before = seen(&rig);
    }
    rig.give(Action::Halt(AxisSet::one(X)));
    // 100 mm/s with the lowest deceleration, in the longest shape.
    let ends = (0..20_000).any(|_| {
        rig.run(1);
        rig.state("x") != "DISCRETE_MOTION" && is_at_rest(&rig)
    });
    prop_assert!(ends, "it never ends");
    prop_assert!(rig.state("x") != "DISCRETE_MOTION", "{}", rig.state("x"));
    prop_assert_eq!((rig.real("x.command.velocity"), rig.real("x.command.fraction")), (0.0, 0.0));
    for goal in goals {
        let refused = rig.events.iter().any(|event| event.command == goal && event.kind == crate::event::Kind::Refused);
        prop_assert_eq!(rig.done(goal).len(), usize::from(!refused), "ends of goal {}", goal);
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn no_change_in_motion_exceeds_a_limit(
        shape in 0_i64..3,
        modulo in any::<bool>(),
        posdrct in prop::sample::select(vec![1_i64, -1]),
        revers in prop::sample::select(vec![0_i64, 0, 2]),
        deeds in prop::collection::vec((random_command(), prop_oneof![Just(0_u64), 0_u64..20, 0_u64..400]), 1..30),
    ) {
        run(&deeds, shape, modulo, (posdrct, revers))?;
    }
}

/// A velocity goal with less jerk replaces a braking motion: the acceleration decreases so slowly that the axis swings
/// back before it moves in the commanded direction. A stop would end behind its start, but would exceed the limit
/// ahead.
#[test]
fn a_swing_back_begins_before_the_limit_ahead() {
    for (low, sign) in [(LOW, 1.0), (-HIGH, -1.0)] {
        let mut config = config(0);
        let p = &mut config.axes[usize::from(X)].parameters;
        p.max_deceleration = Some(MAX_ACCELERATION / 2.0);
        (p.max_jerk, p.profile) = (Some(MAX_JERK), 2);
        (p.min_position, p.max_position) = if sign > 0.0 { (Some(low), Some(HIGH)) } else { (Some(LOW), Some(-low)) };
        let ahead = if sign > 0.0 { low } else { -low };
        let mut rig = Rig::of(config);
        rig.enable();
        let deceleration = MAX_ACCELERATION / 4.0;
        rig.give(Action::Move(Move { velocity: MAX_VELOCITY, deceleration, jerk: MAX_JERK, ..to(X, ahead) }));
        // The axis brakes with its maximum until no more than 5 mm/s are left.
        let left = 5_000.0;
        rig.run(50);
        while rig.real("x.command.velocity").abs() > left {
            rig.run(1);
        }
        assert_eq!(rig.real("x.command.acceleration"), sign * deceleration);
        let (row, _) = Row::find("max_jerk").unwrap();
        // The acceleration changes the velocity by 2 * 5 mm/s before it is 0: the velocity reverses in between.
        let jerk = deceleration * deceleration / (4.0 * left);
        rig.give(Action::SetParameters([Change { axis: X, row, value: Value::Real(jerk) }].into()));
        let goal = rig.give(Action::Move(Move { jerk, ..at(X, -sign * MAX_VELOCITY) }));
        assert!(rig.was_accepted(goal));
        for _ in 0..2_000 {
            rig.run(1);
            let now = seen(&rig);
            assert!(sign * (now.position - ahead as f64) >= 0.0, "beyond the limit at {}", now.position);
            assert!(now.acceleration.abs() <= MAX_ACCELERATION / 2.0 * (1.0 + 1e-9), "{}", now.acceleration);
        }
        assert_eq!(rig.state("x"), "ERROR_STOP");
        assert!(is_at_rest(&rig));
        assert_eq!(rig.done(goal).len(), 1);
    }
}

/// An S-ramp that has just started to blend needs long to reduce its acceleration. Without the next goal there is not
/// enough distance for that before the limit.
#[test]
fn a_passage_whose_next_goal_is_cancelled_stops_before_the_limit() {
    for cycles in 100..160 {
        let deeds = [
            (RandomCommand::Move(to(X, LOW)), 6),
            (
                RandomCommand::Move(Move { mode: MoveMode::Relative, velocity: 62_380.072_232_098_384, ..to(X, HIGH) }),
                564,
            ),
            (RandomCommand::Move(Move { buffer_mode: BufferMode::BlendingLow, ..at(X, MAX_VELOCITY) }), cycles),
            (RandomCommand::Cancel, 400),
        ];
        run(&deeds, 1, false, (1, 0)).unwrap_or_else(|error| panic!("after {cycles} cycles: {error}"));
    }
}

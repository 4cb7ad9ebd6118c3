//! A chain of couplings whose first axis is stopped by its software limit.

use super::super::rig::{LINE, Rig, X, Y, at, cases, config, couple};
use crate::command::{Action, Move};
use crate::event::Kind;
use crate::object::Leader;
use proptest::prelude::*;

/// x follows the line 1:1 up to its limit, y follows x with `numerator` : `denominator`, and the limits of y are those
/// of x, geared.
fn chain(limit: i64, (numerator, denominator): (i64, i64), cycle_ms: u64, rate: f64) -> Rig {
    let mut config = config(0);
    config.cycle_ns = cycle_ms * 1_000_000;
    let ratio = numerator as f64 / denominator as f64;
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.min_position, p.max_position) = (Some(-limit), Some(limit));
    (p.max_acceleration, p.max_deceleration) = (1e6, Some(rate));
    let p = &mut config.axes[usize::from(Y)].parameters;
    p.max_velocity = 100_000.0 * ratio;
    (p.max_acceleration, p.max_deceleration) = (1e6 * ratio, Some(rate * ratio));
    p.max_following_error = 1_000_000;
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give_all(vec![
        Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)),
        Action::Synchronize(couple(Y, Leader::AxisCommand(X), numerator, denominator)),
    ]);
    rig.run(5);
    rig
}

fn place(rig: &Rig, axis: &str) -> f64 {
    rig.int(&format!("{axis}.command.position")) as f64 + rig.real(&format!("{axis}.command.fraction"))
}

/// Runs until x is stopped and at rest. Checks that y keeps its gear ratio, and that the speed of x decreases by at
/// most `most` per cycle (inc per cycle).
fn stop(rig: &mut Rig, velocity: f64, ratio: f64, most: f64) -> Result<(), TestCaseError> {
    rig.give(Action::Move(Move { acceleration: 3e5, ..at(LINE, velocity) }));
    let (mut before, mut step) = (place(rig, "x"), 0.0_f64);
    for _ in 0..20_000 {
        if rig.state("x") == "ERROR_STOP" && step == 0.0 {
            break;
        }
        rig.run(1);
        let now = place(rig, "x");
        let next = now - before;
        if rig.state("x") == "ERROR_STOP" {
            let less = (step - next) * velocity.signum();
            prop_assert!(less <= most * (1.0 + 1e-8) + 1e-9, "{less} of {most} from {step}");
            prop_assert!(next * velocity >= -1e-9, "it turns back: {next}");
        }
        let off = place(rig, "y") - now * ratio;
        prop_assert!(off.abs() < 1e-6, "y is {off} off its gear in cycle {}", rig.machine.next_cycle());
        (before, step) = (now, next);
    }
    prop_assert_eq!(rig.state("x"), "ERROR_STOP");
    let lost = rig.events.iter().find(|event| event.kind == Kind::Warning);
    prop_assert!(lost.is_none(), "{lost:?}");
    prop_assert_eq!((rig.state("y"), rig.int("y.error")), ("SYNCHRONIZED_MOTION", 0));
    Ok(())
}

/// 75 inc in each cycle, which a stop may reduce by 1: in whole steps, 74 + 73 + .. + 1 = 2775 inc, and in continuous
/// time from 74.5 an eighth of an inc more. The limit is where the whole steps just fit.
///
/// Proves: MACS-LIM-04, MACS-SYNC-02
#[test]
fn a_stop_in_whole_steps_takes_no_more_than_its_deceleration() {
    for way in [1.0, -1.0] {
        for velocity in [75_000.0, 60_000.0, 30_000.0, 6_000.0, 3_000.0] {
            // The line reaches a position that is a whole number of its steps before the limit.
            let mut rig = chain(1_000_000, (1, 2), 1, 1e6);
            rig.give(Action::Move(Move { acceleration: 3e5, ..at(LINE, velocity * way) }));
            rig.run((velocity / 300.0) as u64 + 20);
            assert_eq!(rig.real("x.command.velocity"), velocity * way);
            let step = velocity / 1_000.0;
            let whole = step * (step - 1.0) / 2.0;
            let limit = place(&rig, "x").abs() + whole + 100.0 * step;
            assert_eq!(limit.fract(), 0.0, "{velocity}");
            let mut rig = chain(limit as i64, (1, 2), 1, 1e6);
            stop(&mut rig, velocity * way, 0.5, 1.0).unwrap();
            assert_eq!(place(&rig, "x"), limit * way);
        }
    }
}

proptest! {
    #![proptest_config(cases(150))]

    /// For any limit and any velocity, with whole and fractional steps of the leader.
    ///
    /// Proves: MACS-LIM-04, MACS-SYNC-02
    #[test]
    fn the_next_axis_keeps_its_gear_behind_one_that_its_limit_stops(
        limit in 12_000_i64..14_000,
        velocity in prop_oneof![
            (1_i64..90).prop_map(|step| step as f64 * 1_000.0), 1_000.0..90_000.0_f64,
        ],
        up in any::<bool>(),
        gear in prop::sample::select(vec![(1_i64, 2_i64), (1, 1), (3, 2), (1, 3), (355, 113)]),
        cycle_ms in prop::sample::select(vec![1_u64, 2, 4]),
        rate in prop::sample::select(vec![1e6, 5e5, 2e6, 777_777.0]),
    ) {
        let mut rig = chain(limit, gear, cycle_ms, rate);
        let cycle_s = cycle_ms as f64 / 1e3;
        let velocity = if up { velocity } else { -velocity };
        stop(&mut rig, velocity, gear.0 as f64 / gear.1 as f64, rate * cycle_s * cycle_s)?;
        prop_assert_eq!(rig.int("x.command.position"), if up { limit } else { -limit });
    }
}

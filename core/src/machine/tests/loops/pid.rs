//! PID loop of an axis: K_OUT 60000, max_velocity 100000 inc/s, a drive that reaches its velocity at once.

use super::super::rig::{Rig, X, at, to};
use super::{MS, lag, velocity_config};
use crate::code::Code;
use crate::command::Action;
use crate::config::{ConfigError, MachineConfig};
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use crate::regulator::{Law, PidGains};
use crate::sim::Model;

fn pid_config(change: impl Fn(&mut PidGains)) -> MachineConfig {
    let mut config = velocity_config(0);
    config.axes[1].law = Law::Pid;
    change(&mut config.axes[1].parameters.pid);
    config
}

fn enabled(model: Model, change: impl Fn(&mut PidGains)) -> Rig {
    let mut rig = Rig::with(pid_config(change), [model, Model::Ideal]);
    rig.enable();
    rig
}

fn set(rig: &mut Rig, values: &[(&str, i64)]) -> u64 {
    let change = |&(key, value): &(&str, i64)| {
        let row = Row::find(key).expect("a row").0;
        Change { axis: X, row, value: Value::Int(value) }
    };
    rig.give(Action::SetParameters(values.iter().map(change).collect()))
}

/// A new controller: KPROP 30, and nothing else. At half of VELMAX the axis is 0.5 * 60000 / 30 = 1000 inc behind, at
/// KPROP 60 500.
///
/// Proves: MACS-REG-01, MACS-REG-12
#[test]
fn at_constant_speed_the_error_makes_the_velocity() {
    for (kprop, behind) in [(30, 1000), (60, 500), (300, 100)] {
        let mut rig = enabled(lag(2), |_| ());
        set(&mut rig, &[("kprop", kprop)]);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(3_000);
        assert!((rig.int("x.regulator.error") - behind).abs() <= 1, "{kprop}: {}", rig.int("x.regulator.error"));
        assert!((rig.real("x.regulator.output") - 0.5).abs() < 1e-3);
        assert_eq!(rig.real("x.output.velocity"), rig.real("x.regulator.output") * 100_000.0);
    }
}

/// FFVEL 1000 gives the drive the command velocity itself, so the error is 0; without it KINT removes the error.
///
/// Proves: MACS-REG-09, MACS-REG-01
#[test]
fn feed_forward_or_the_integral_part_takes_the_error_away() {
    let mut rig = enabled(Model::Ideal, |gains| gains.velocity = 1000);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(2_000);
    assert_eq!((rig.int("x.regulator.error"), rig.real("x.output.velocity")), (0, 50_000.0));
    let mut rig = enabled(Model::Ideal, |gains| (gains.integral, gains.limit) = (1, 65_000));
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(6_000);
    assert!(rig.int("x.regulator.error").abs() <= 1, "{}", rig.int("x.regulator.error"));
    // 0.5 is 30000 of the integral.
    assert!((rig.real("x.regulator.output") - 0.5).abs() < 1e-3);
}

/// KPROP 30 to 90 while the axis is 1000 inc behind: the output of that cycle equals that of the previous cycle, and
/// grows from there.
#[test]
fn a_gain_that_is_set_in_motion_makes_no_bump() {
    let mut rig = enabled(Model::Ideal, |_| ());
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(3_000);
    let mut last = rig.real("x.regulator.output");
    set(&mut rig, &[("kprop", 90)]);
    for cycle in 0..200 {
        rig.run(1);
        let output = rig.real("x.regulator.output");
        // 1000 inc with a gain increase of 60 are 1.0, applied in 64 parts, while the error decreases.
        assert!((output - last).abs() < 0.03, "cycle {cycle}: {output} after {last}");
        last = output;
    }
    rig.run(2_000);
    assert!((rig.int("x.regulator.error") - 333).abs() <= 1, "{}", rig.int("x.regulator.error"));
}

/// Every key of the loop, alone, in motion: the output never jumps by more than the control law allows.
#[test]
fn no_key_of_the_loop_makes_a_bump() {
    for (key, value) in [
        ("kprop", 300),
        ("kder", 20),
        ("kint", 100),
        ("kilim", 0),
        ("bandwidth", 100),
        ("ffvel", 1000),
        ("regwmin", 5_000),
        ("kilimtime", -100),
    ] {
        let mut rig = enabled(Model::Ideal, |gains| (gains.integral, gains.limit) = (1, 5_000));
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(3_000);
        let last = rig.real("x.regulator.output");
        set(&mut rig, &[(key, value)]);
        rig.run(1);
        let output = rig.real("x.regulator.output");
        assert!((output - last).abs() < 0.02, "{key}: {output} after {last}");
    }
}

/// TIMER 4 in cycles of 1 ms: the output is constant for four cycles.
///
/// Proves: MACS-REG-04
#[test]
fn a_longer_period_holds_the_output() {
    let mut rig = enabled(Model::Ideal, |gains| gains.period_ms = 4);
    rig.give(Action::Move(at(X, 50_000.0)));
    let outputs: Vec<_> = (0..400)
        .map(|_| {
            rig.run(1);
            rig.real("x.output.velocity")
        })
        .collect();
    let changes: Vec<_> = (1..outputs.len()).filter(|&k| outputs[k] != outputs[k - 1]).collect();
    assert!(changes.len() > 40 && changes.windows(2).all(|pair| (pair[1] - pair[0]) % 4 == 0), "{changes:?}");
}

#[test]
fn a_period_that_no_cycle_divides_is_refused() {
    let mut config = pid_config(|_| ());
    config.cycle_ns = 2 * MS;
    let expected = ConfigError::NotImplemented { axis: "x".into(), key: "timer", code: Code::LOOP_PERIOD };
    assert_eq!(config.check(), Err(expected));
    config.axes[1].parameters.pid.period_ms = 2;
    assert_eq!(config.check(), Ok(()));
    let mut rig = Rig::with(config, [Model::Ideal, Model::Ideal]);
    let refused = set(&mut rig, &[("timer", 5)]);
    rig.run(1);
    let sentence = "x: timer 5 is no whole number of cycles, and the position loop runs in cycles; a period that the cycle divides is allowed";
    assert_eq!(rig.refusal(refused), sentence);
    let taken = set(&mut rig, &[("timer", 6)]);
    rig.run(1);
    assert!(rig.was_accepted(taken));
}

/// At rest the integral continues: it corrects an error that KPROP cannot correct, also if the axis appears to be
/// permanently at rest.
#[test]
fn the_integral_part_works_at_rest() {
    let mut rig = enabled(Model::Ideal, |gains| (gains.proportional, gains.integral, gains.limit) = (1, 1, 60_000));
    rig.run(50);
    rig.plant.drive(0).unwrap().jump(-40);
    rig.run(5_000);
    assert_eq!(rig.int("x.regulator.error"), 0);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// Switched off, the loop has no output and no history: switched on again it starts as a new one.
///
/// Proves: MACS-REG-12
#[test]
fn loop_restarts_without_history_after_power_off() {
    let mut rig = enabled(lag(5), |gains| (gains.integral, gains.limit) = (5, 60_000));
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(200);
    assert!(rig.real("x.regulator.output") > 0.0);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(1);
    assert_eq!((rig.real("x.output.velocity"), rig.real("x.regulator.output")), (0.0, 0.0));
    rig.run(500);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(50);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(100);
    assert_eq!((rig.state("x"), rig.real("x.output.velocity")), ("STANDSTILL", 0.0));
}

#[test]
fn a_restored_machine_goes_on_with_the_same_loop() {
    let mut rig = enabled(lag(5), |gains| {
        *gains = PidGains { derivative: 40, integral: 2, limit: 9_000, limit_time: 300, period_ms: 3, ..*gains };
    });
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(151);
    set(&mut rig, &[("kprop", 60)]);
    rig.run(10);
    rig.mirror();
    rig.run(3_000);
    assert!(rig.int("x.regulator.error").abs() <= 1);
}

//! Streamed setpoints: for each axis, for the requested duration, and without effect on goals.

use super::rig::{Rig, X, Y, at, to};
use crate::code::Code;
use crate::command::{Action, Commands, Setpoint, Setpoints};
use crate::event::Kind;
use crate::object::AxisSet;
use crate::text::message;

fn for_ms(velocity: f64, ms: u64) -> Setpoint {
    Setpoint { velocity, duration: Some(ms * 1_000_000) }
}

fn warnings(rig: &Rig) -> Vec<String> {
    let said = rig.events.iter().filter(|event| event.kind == Kind::Warning);
    said.map(|event| message(event, rig.machine.config())).collect()
}

/// `setpoint_timeout` is 100 ms; 20 mm/s are reached from rest, and stopped, within 40 ms.
#[test]
fn setpoint_timeout_is_per_axis() {
    let mut rig = Rig::enabled();
    rig.stream(Y, 20_000.0);
    for _ in 0..100 {
        rig.stream(X, 20_000.0);
    }
    assert_eq!(rig.real("y.command.velocity"), 20_000.0, "100 cycles old");
    rig.stream(X, 20_000.0);
    rig.run(1);
    assert!(rig.real("y.command.velocity") < 20_000.0, "what comes for x keeps y no longer alive");
    (0..60).for_each(|_| rig.stream(X, 20_000.0));
    assert_eq!((rig.state("y"), rig.real("x.command.velocity")), ("STANDSTILL", 20_000.0));
    assert_eq!(warnings(&rig), ["y: streamed setpoints stopped coming"]);
    // Both axes in one message, from the same cycle.
    let mut both = Setpoints::none(3);
    both.axes[usize::from(X)] = Some(Setpoint { velocity: -10_000.0, duration: None });
    both.axes[usize::from(Y)] = Some(Setpoint { velocity: 10_000.0, duration: None });
    rig.cycle(Commands { stream: Some(&both), ..Commands::default() });
    rig.run(80);
    assert_eq!((rig.real("x.command.velocity"), rig.real("y.command.velocity")), (-10_000.0, 10_000.0));
}

#[test]
fn a_setpoint_that_was_asked_for_so_long_ends_then_without_a_warning() {
    let mut rig = Rig::enabled();
    rig.stream_for(X, for_ms(20_000.0, 60));
    rig.run(60);
    assert_eq!(rig.real("x.command.velocity"), 20_000.0);
    rig.run(1);
    assert!(rig.real("x.command.velocity") < 20_000.0, "60 ms are over");
    // While it stops it accepts the next setpoint.
    rig.run(5);
    rig.stream_for(X, for_ms(20_000.0, 60));
    rig.run(40);
    assert_eq!(rig.real("x.command.velocity"), 20_000.0);
    rig.run(60);
    assert_eq!(rig.state("x"), "STANDSTILL");
    assert_eq!(warnings(&rig), [""; 0]);
    // But not longer than setpoint_timeout, which causes a warning.
    rig.stream_for(X, for_ms(20_000.0, 60_000));
    rig.run(101);
    assert_eq!(rig.real("x.command.velocity"), 20_000.0);
    rig.run(40);
    assert_eq!(rig.state("x"), "STANDSTILL");
    assert_eq!(warnings(&rig), ["x: streamed setpoints stopped coming"]);
}

#[test]
fn rejected_stream_is_reported_once_per_reason() {
    let mut rig = Rig::new();
    let stream = |rig: &mut Rig, cycles| (0..cycles).for_each(|_| rig.stream(X, 20_000.0));
    stream(&mut rig, 200);
    let off = "x: streamed setpoints are not followed: the axis is not enabled; enable it first";
    assert_eq!(warnings(&rig), [off]);
    // A joystick at rest does not request motion.
    rig.run(150);
    (0..50).for_each(|_| rig.stream(X, 0.0));
    assert_eq!(warnings(&rig).len(), 1);
    rig.enable();
    let goal = rig.give(Action::Move(to(X, 30_000)));
    stream(&mut rig, 100);
    let busy = "x: streamed setpoints are not followed: something else moves the axis, and a stream takes no axis over; halt \
                it first";
    assert_eq!(warnings(&rig), [off, busy]);
    // After a pause it is reported again.
    rig.run(120);
    stream(&mut rig, 10);
    assert_eq!(warnings(&rig), [off, busy, busy]);
    assert!(rig.done(goal).is_empty(), "it moves on");
    // An axis that is braking is waited for without a warning.
    rig.give(Action::Halt(AxisSet::one(X)));
    stream(&mut rig, 200);
    assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("CONTINUOUS_MOTION", 20_000.0));
    assert_eq!(warnings(&rig).len(), 3);
    rig.stream(X, f64::NAN);
    rig.stream(X, 100_001.0);
    assert_eq!(
        warnings(&rig)[3..],
        [
            "x: streamed setpoints are not followed: the velocity is no finite number",
            "x: streamed setpoints are not followed: velocity 100.001 mm/s exceeds max_velocity 100 mm/s",
        ]
    );
    assert_eq!(rig.real("x.command.velocity"), 20_000.0);
    rig.give(Action::QuickStop(AxisSet::one(X)));
    stream(&mut rig, 10);
    assert_eq!(
        warnings(&rig)[5..],
        ["x: streamed setpoints are not followed: quick_stop has locked the axis; reset_errors first"]
    );
}

#[test]
fn a_goal_takes_a_streaming_axis_over() {
    let mut rig = Rig::enabled();
    rig.stream(X, 20_000.0);
    rig.run(30);
    let goal = rig.give(Action::Move(at(X, -10_000.0)));
    (0..200).for_each(|_| rig.stream(X, 20_000.0));
    assert_eq!(rig.real("x.command.velocity"), -10_000.0);
    assert!(rig.done(goal).is_empty());
    assert!(!rig.events.iter().any(|event| event.code == Code::STREAM_TIMEOUT));
}

//! Tests verb `follow_joint_trajectory`: exact texts, gaps, and the longest trajectory.

use super::*;

#[test]
fn trajectory_points_are_written_by_axis_and_missing_values_are_none() {
    use lineshaft_core::trajectory::{Knot, OnExcess, Tolerance, Track, Trajectory, TrajectoryLimits};
    let knot = |position, velocity| Knot { position, velocity, acceleration: None };
    let none = Tolerance::default();
    let path = Tolerance { position: Some(1000.0), ..none };
    let goal = Tolerance { position: Some(0.1), velocity: Some(2.5), acceleration: Some(3e20) };
    let quarter = Position::whole(-1) + Position::from_f64(0.25);
    let x = Track {
        axis: 0,
        knots: Box::new([knot(quarter, Some(7.5)), knot(Position::whole(9), None)]),
        path,
        ..Track::default()
    };
    let odd = Track {
        axis: 2,
        knots: Box::new([knot(Position::ZERO, Some(0.0)), knot(Position::whole(1), None)]),
        goal,
        start: Some(4.0),
        ..Track::default()
    };
    let run = Trajectory::new(-5, Box::new([10, 20]), Box::new([odd, x]), Some(30)).expect("a sound one");
    let limits = TrajectoryLimits { margin: 0.01, on_excess: OnExcess::Refuse, max_stretch: 2.0 };
    let run = run.within(limits).ended_after(Some(40));
    Desk::new().is(
        &Action::Trajectory(run.into()),
        r#"{"follow_joint_trajectory":{"id":"17","joints":["odd","x"],"start":"-5 ns","points":[{"time":"10 ns","positions":["0 inc","-0.75 inc"],"velocities":["0 inc/s","7.5 inc/s"]},{"time":"20 ns","positions":["1 inc","9 inc"]}],"path_tolerance":{"x":{"position":"1000 inc"}},"goal_tolerance":{"odd":{"position":"0.1 inc","velocity":"2.5 inc/s","acceleration":"3e20 inc/s^2"}},"goal_time":"30 ns","start_tolerance":{"odd":{"position":"4 inc"}},"trajectory_limits":{"margin":0.01,"on_excess":"refuse","max_stretch":2.0},"max_duration":"40 ns"}}"#,
    );
}

/// A trajectory that no interface creates cannot be read back: one axis has a velocity, the other has none.
#[test]
fn a_trajectory_with_gaps_is_refused() {
    use lineshaft_core::trajectory::{Knot, Track, Trajectory};
    let track = |axis, velocity| Track {
        axis,
        knots: Box::new([Knot { position: Position::ZERO, velocity, acceleration: None }]),
        ..Track::default()
    };
    let run = Trajectory::new(0, Box::new([10]), Box::new([track(0, None), track(1, Some(0.0))]), None).expect("sound");
    let desk = Desk::new();
    assert!(desk.read(&desk.write(&Action::Trajectory(run.into()))).is_err());
}

/// The longest trajectory exceeds the size limit of a file, and can still be read back.
#[test]
fn the_longest_trajectory_reads_back() {
    use lineshaft_core::trajectory::{Knot, MAX_KNOTS, Track, Trajectory};
    let position = Position::whole((1 << 61) + 1) + Position::from_f64(1.0 / 3.0);
    let rate = Some(-1.2345678901234567e-10);
    let mut knots = vec![Knot { position, velocity: rate, acceleration: rate }; MAX_KNOTS];
    knots[MAX_KNOTS - 1] = Knot { position: Position::whole(1 << 61), velocity: Some(0.0), acceleration: rate };
    let times = (0..MAX_KNOTS as u64).map(|place| (1 << 60) + place).collect();
    let track = Track { axis: 4, knots: knots.into(), ..Track::default() };
    let run = Action::Trajectory(Trajectory::new(0, times, Box::new([track]), None).expect("a sound one").into());
    let desk = Desk::new();
    let json = desk.write(&run);
    assert!(json.len() > crate::document::MAX_BYTES, "{} bytes", json.len());
    assert!(desk.read(&json).as_ref() == Ok(&run));
}

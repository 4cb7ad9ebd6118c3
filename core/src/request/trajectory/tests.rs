use super::*;
use crate::parameter::AxisParameters;
use crate::unit::{Fraction, Quantity, Scale, Unit};

/// x: 1000 inc/mm; y: 36000 inc per turn; valve: open loop.
fn config() -> MachineConfig {
    let axis = |name: &str, per: Unit, increments: i128, drive| {
        let per = Quantity::new(Fraction::from_integer(1), per);
        let scale = Scale::new(Fraction::from_integer(increments), per).unwrap();
        AxisConfig::new(name.into(), scale, drive, AxisParameters::new(1e5, 1e6))
    };
    let valve = AxisConfig {
        interface: Interface::OpenLoop,
        ..axis("valve", Unit::MILLIMETRE, 1, Some(crate::drive::Capabilities::all(0)))
    };
    let axes = vec![
        axis("x", Unit::MILLIMETRE, 1000, Some(crate::drive::Capabilities::all(0))),
        axis("y", Unit::REVOLUTION, 36_000, None),
        valve,
    ];
    MachineConfig { cycle_ns: 1_000_000, axes, ..MachineConfig::default() }
}

fn request() -> TrajectoryRequest {
    let tolerance = ToleranceRequest { position: Some(0.001), velocity: None, acceleration: None };
    TrajectoryRequest {
        axes: vec!["y".into(), "x".into()],
        start_ns: -5,
        points: vec![
            PointRequest { time_ns: 10, positions: vec![1.0, 0.000_000_25], ..PointRequest::default() },
            PointRequest {
                time_ns: 20,
                positions: vec![0.0, 0.010_000_6],
                velocities: vec![0.0, 0.0],
                accelerations: vec![0.5, -0.5],
            },
        ],
        path: vec![ToleranceRequest::default(), tolerance],
        goal_time_ns: Some(7),
        ..TrajectoryRequest::default()
    }
}

#[test]
fn names_and_units_become_axes_and_increments() {
    let trajectory = config().resolve_trajectory(&request()).unwrap();
    assert_eq!((trajectory.start_ns(), trajectory.times_ns(), trajectory.goal_time_ns()), (-5, &[10, 20][..], Some(7)));
    let [y, x] = trajectory.tracks() else { panic!("two tracks") };
    assert_eq!((y.axis, x.axis), (1, 0));
    // 1 rad of 36000 inc per turn is 5729.578 inc.
    assert!((y.knots[0].position.to_f64() - 36_000.0 / std::f64::consts::TAU).abs() < 1e-9);
    assert_eq!(x.knots[0], Knot { position: Position::from_f64(0.25), velocity: None, acceleration: None });
    // 10000.6 inc as it is given, and the whole increment next to it where the axis rests at last.
    let end = Position::whole(10_000) + Position::from_f64(0.6);
    assert!((x.knots[1].position - end).to_f64().abs() < 1e-9, "{:?}", x.knots[1]);
    assert_eq!((x.knots[1].velocity, x.knots[1].acceleration), (Some(0.0), Some(-500_000.0)));
    assert_eq!(trajectory.end(1, Position::ZERO), Some(Position::whole(10_001)));
    assert_eq!(x.path, Tolerance { position: Some(1000.0), ..Tolerance::default() });
    assert_eq!((y.path, x.goal), (Tolerance::default(), Tolerance::default()));
}

/// rqt sends 2.96706 for a limit of 170 deg. y has 36000 inc per turn: 17000 inc, and 1e-6 rad are 0.0057 inc.
#[test]
fn a_position_that_was_rounded_beyond_a_limit_is_on_it() {
    let mut config = config();
    let parameters = &mut config.axes[1].parameters;
    (parameters.min_position, parameters.max_position) = (Some(-17_000), Some(17_000));
    let inc = std::f64::consts::TAU / 36_000.0;
    for (asked, is_on_limit) in [(2.967_06, true), (17_000.0 * inc + 0.9e-6, true), (17_000.0 * inc + 1.1e-6, false)] {
        for sign in [1.0, -1.0] {
            let points = vec![PointRequest { positions: vec![sign * asked], ..PointRequest::default() }];
            let request = TrajectoryRequest { axes: vec!["y".into()], points, ..TrajectoryRequest::default() };
            let trajectory = config.resolve_trajectory(&request).expect("a sound one");
            let position = trajectory.tracks()[0].knots[0].position;
            assert_eq!(position == Position::whole(sign as i64 * 17_000), is_on_limit, "{asked}: {position:?}");
        }
    }
}

#[test]
fn what_is_wrong_is_refused_with_name_value_and_range() {
    let refused = |change: fn(&mut TrajectoryRequest)| {
        let mut request = request();
        change(&mut request);
        config().resolve_trajectory(&request).unwrap_err().to_string()
    };
    type Wrong = (fn(&mut TrajectoryRequest), &'static str);
    let table: [Wrong; 17] = [
        (|r| r.axes.clear(), "axes: empty; 1 to 3 names are expected"),
        (|r| r.axes[0] = "z".into(), "no axis is called `z`; there are x, y, valve"),
        (|r| r.axes[0] = "x".into(), "axes: x twice; each axis may stand once"),
        (
            |r| r.axes[0] = "valve".into(),
            "axes: valve, which runs in open loop; an axis with a closed position loop, or a virtual one, is expected",
        ),
        (|r| r.points.clear(), "points: a list of 0; 1 to 100000 are allowed"),
        (
            |r| r.points[1].time_ns = 10,
            "time of point 1: 10 ns; more than 10 ns, that of the point before, is expected",
        ),
        (
            |r| r.points[1].time_ns = 1 << 63,
            "time of point 1: 9223372036854775808 ns; at most 9223372036854775807 ns is allowed",
        ),
        (|r| r.points[0].positions.clear(), "positions of point 0: a list of 0; 2 are expected"),
        (|r| r.points[0].positions.push(1.0), "positions of point 0: a list of 3; 2 are expected"),
        (|r| r.points[1].velocities.truncate(1), "velocities of point 1: a list of 1; none or 2 are expected"),
        (|r| r.points[1].accelerations.truncate(1), "accelerations of point 1: a list of 1; none or 2 are expected"),
        (|r| r.points[1].velocities[1] = 0.5, "velocity of x at point 1: 0.5 m/s; 0 is expected at the last point"),
        (
            |r| {
                r.points = vec![PointRequest::default(); 60_000]
                    .into_iter()
                    .zip(0..)
                    .map(|(p, time_ns)| PointRequest { time_ns, ..p })
                    .collect()
            },
            "points: 60000 for 2 axes; points times axes may be 100000, and are 120000",
        ),
        (
            |r| r.goal_time_ns = Some(u64::MAX),
            "goal time: 18446744073709551615 ns; at most 9223372036854775807 ns is allowed",
        ),
        (|r| r.path.truncate(1), "path tolerances: 1 values; none or 2 are allowed"),
        (|r| r.path[1].position = Some(-1.0), "path tolerance of x: -1000000 inc; 0 or more is expected"),
        (|r| r.points[0].positions[1] = f64::NAN, "position of x at point 0: "),
    ];
    for (change, expected) in table {
        let sentence = refused(change);
        assert!(sentence.starts_with(expected), "{sentence}");
    }
    for number in [f64::INFINITY, f64::NEG_INFINITY, 1e60] {
        let mut request = request();
        request.points[0].positions[1] = number;
        config().resolve_trajectory(&request).unwrap_err();
        let mut request = self::request();
        request.points[0].velocities = vec![0.0, number];
        config().resolve_trajectory(&request).map(drop).unwrap_err();
    }
}

#[test]
fn a_position_of_two_to_the_62_is_refused() {
    let at = |position: f64| {
        let mut request = TrajectoryRequest { units: Units::Increments, ..request() };
        request.points[0].positions[1] = position;
        config().resolve_trajectory(&request)
    };
    assert!(at((1_i64 << 61) as f64).is_ok());
    for position in [(1_i64 << 62) as f64, -((1_i64 << 62) as f64)] {
        assert!(at(position).is_err(), "{position}");
    }
}

/// What a float rounds away is no velocity: 1.19e-7 rad/s, as in joint_trajectory_controller.
#[test]
fn a_trajectory_may_end_with_the_rounding_of_a_velocity() {
    let ends = |velocity: f64| {
        let mut request = request();
        request.points[1].velocities = vec![velocity, -velocity];
        config().resolve_trajectory(&request)
    };
    for velocity in [1e-12, 1.1e-7] {
        let trajectory = ends(velocity).unwrap();
        assert!(trajectory.tracks().iter().all(|track| track.knots[1].velocity == Some(0.0)), "{velocity}");
    }
    let error = ends(1.2e-7).unwrap_err().to_string();
    assert!(error.starts_with("velocity of y at point 1: 0.00000012 rad/s; 0 is expected"), "{error}");
}

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
    // 10000.6 inc exactly, and the nearest whole increment at the end of the trajectory.
    let end = Position::whole(10_000) + Position::from_f64(0.6);
    assert!((x.knots[1].position - end).to_f64().abs() < 1e-9, "{:?}", x.knots[1]);
    assert_eq!((x.knots[1].velocity, x.knots[1].acceleration), (Some(0.0), Some(-500_000.0)));
    assert_eq!(trajectory.end(1, Position::ZERO), Some(Position::whole(10_001)));
    assert_eq!(x.path, Tolerance { position: Some(1000.0), ..Tolerance::default() });
    assert_eq!((y.path, x.goal), (Tolerance::default(), Tolerance::default()));
}

/// rqt sends 2.96706 for a limit of 170 deg. y has 36000 inc per turn: 17000 inc, and 1e-6 rad are 0.0057 inc.
#[test]
fn position_rounded_beyond_limit_is_set_to_limit() {
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
fn error_has_name_value_and_range() {
    let refused = |change: fn(&mut TrajectoryRequest)| {
        let mut request = request();
        change(&mut request);
        config().resolve_trajectory(&request).unwrap_err().to_string()
    };
    type Wrong = (fn(&mut TrajectoryRequest), &'static str);
    let table: [Wrong; 21] = [
        (|r| r.axes.clear(), "joints is empty; one or more are expected"),
        (|r| r.axes[0] = "z".into(), "no axis is called `z`; there are x, y, valve"),
        (|r| r.axes[0] = "x".into(), "joints has the joint `x` twice; once is expected"),
        (
            |r| r.axes[0] = "valve".into(),
            "joints has the joint `valve`, which runs in open loop; an axis with a closed position loop, or a virtual one, is expected",
        ),
        (|r| r.points.clear(), "points is empty; one point or more is expected"),
        (
            |r| r.points[1].time_ns = 10,
            "points[1].time is 0.00000001 s; more than 0.00000001 s, the time of the point before it, is expected",
        ),
        (
            |r| r.points[1].time_ns = 1 << 63,
            "points[1].time is 9223372036.854775808 s; at most 9223372036.854775807 s is allowed",
        ),
        (|r| r.points[0].positions.clear(), "points[0].positions has 0 numbers; one for each joint (2) is expected"),
        (|r| r.points[0].positions.push(1.0), "points[0].positions has 3 numbers; one for each joint (2) is expected"),
        (
            |r| r.points[1].velocities.truncate(1),
            "points[1].velocities has 1 number; one for each joint (2), or none, is expected",
        ),
        (
            |r| r.points[1].accelerations.truncate(1),
            "points[1].accelerations has 1 number; one for each joint (2), or none, is expected",
        ),
        (
            |r| r.points[1].velocities[1] = 0.5,
            "the velocity of `x` in the last point is 0.5 m/s; 0 is expected, or set allow_nonzero_velocity_at_trajectory_end",
        ),
        (
            |r| {
                r.points = vec![PointRequest::default(); 60_000]
                    .into_iter()
                    .zip(0..)
                    .map(|(p, time_ns)| PointRequest { time_ns, ..p })
                    .collect()
            },
            "points has 60000 entries for 2 joints; points times joints may be at most 100000, and are 120000",
        ),
        (
            |r| r.goal_time_ns = Some(u64::MAX),
            "goal_time is 18446744073.709551615 s; at most 9223372036.854775807 s is allowed",
        ),
        (
            |r| r.points = vec![PointRequest::default(); 100_001],
            "points has 100001 entries; at most 100000 are allowed",
        ),
        (|r| r.start_ns = MAX_START_NS + 500_000_000, "start is 600.5 s; at most 600 s is allowed"),
        (|r| r.path.truncate(1), "path_tolerance has 1 entry; one for each joint (2), or none, is expected"),
        (|r| r.path[1].position = Some(-1.0), "path_tolerance (position) of `x` is -1 m; 0 or more is expected"),
        (
            |r| r.path[1].velocity = Some(f64::INFINITY),
            "path_tolerance (velocity) of `x` is inf; a finite number within +-1e38 is expected",
        ),
        (
            |r| r.points[0].positions[1] = f64::NAN,
            "points[0].positions of `x` is NaN; a finite number within +-1e38 is expected",
        ),
        (
            |r| r.points[1].accelerations[1] = 1e300,
            "points[1].accelerations of `x` is 1e300; a finite number within +-1e38 is expected",
        ),
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

/// A velocity within the rounding of a float counts as zero: 1.19e-7 rad/s, as in joint_trajectory_controller.
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
    assert!(error.starts_with("the velocity of `y` in the last point is 0.00000012 rad/s; 0 is expected"), "{error}");
}

/// For a client that names joints, errors contain its names, and SI units before those of the axis.
#[test]
fn errors_have_the_names_of_the_request_and_its_units_first() {
    let mut config = config();
    let scale = config.axes[0].scale.with_unit(Unit::MILLIMETRE).expect("a length");
    config.axes[0].scale = scale;
    let refused = |change: fn(&mut TrajectoryRequest)| {
        let mut request = request();
        request.joints = vec!["wrist".into(), "Shoulder_Pan".into()];
        change(&mut request);
        config.resolve_trajectory(&request).unwrap_err().to_string()
    };
    assert_eq!(
        refused(|r| r.points[1].velocities[1] = 0.5),
        "the velocity of `Shoulder_Pan` in the last point is 0.5 m/s (500 mm/s); 0 is expected, or set \
         allow_nonzero_velocity_at_trajectory_end"
    );
    assert_eq!(
        refused(|r| r.path[1].position = Some(-1.0)),
        "path_tolerance (position) of `Shoulder_Pan` is -1 m (-1000 mm); 0 or more is expected"
    );
    assert_eq!(refused(|r| r.axes[1] = "y".into()), "joints has the joint `Shoulder_Pan` twice; once is expected");
}

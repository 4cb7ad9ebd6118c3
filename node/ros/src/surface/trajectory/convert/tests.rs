use super::super::tests::{config, joints, joints_called};
use super::*;
use crate::surface::JointNames;
use crate::surface::group::TrajectorySettings;
use lineshaft_core::trajectory::{OnExcess, TrajectoryLimits};
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectory;

mod any;

const NOW: i64 = 1_700_000_000_000_000_000;

fn settings() -> Settings {
    Settings { stopped: 0.01, joints: vec![[0.0; 3]; 2], ..Settings::default() }
}

fn at(seconds: f64) -> Duration {
    Duration { sec: seconds.floor() as i32, nanosec: ((seconds - seconds.floor()) * 1e9).round() as u32 }
}

fn point(seconds: f64, positions: &[f64]) -> Point {
    Point { positions: positions.to_vec(), time_from_start: at(seconds), ..Point::default() }
}

/// Returns a goal that moves both joints to 1 and 2 in one second, then to 3 and 4.
fn goal() -> Goal {
    Goal {
        trajectory: JointTrajectory {
            joint_names: vec!["x".to_owned(), "y".to_owned()],
            points: vec![point(1.0, &[1.0, 2.0]), point(2.5, &[3.0, 4.0])],
            ..JointTrajectory::default()
        },
        ..Goal::default()
    }
}

fn tolerance(name: &str, position: f64, velocity: f64, acceleration: f64) -> JointTolerance {
    JointTolerance { name: name.to_owned(), position, velocity, acceleration }
}

fn read(goal: &Goal) -> Result<TrajectoryRequest, GoalError> {
    request(&joints(), &settings(), goal, NOW)
}

#[track_caller]
fn refused(change: impl FnOnce(&mut Goal), sentence: &str) {
    let mut goal = goal();
    change(&mut goal);
    let error = read(&goal).expect_err("it should be refused").to_string();
    assert_eq!(error, sentence);
}

/// Checks that the core refuses the request of the goal.
#[track_caller]
fn refused_by_core(change: impl FnOnce(&mut Goal), sentence: &str) {
    let mut goal = goal();
    change(&mut goal);
    let request = read(&goal).expect("nothing is wrong with the message");
    assert_eq!(config().resolve_trajectory(&request).expect_err("it should be refused").to_string(), sentence);
}

#[test]
fn plain_goal_starts_now_with_default_tolerances() {
    let stands = ToleranceRequest { velocity: Some(0.01), ..ToleranceRequest::default() };
    let point =
        |time_ns, positions: &[f64]| PointRequest { time_ns, positions: positions.to_vec(), ..PointRequest::default() };
    let expected = TrajectoryRequest {
        axes: vec!["x".to_owned(), "y".to_owned()],
        joints: vec!["x".to_owned(), "y".to_owned()],
        units: Units::Si,
        start_ns: 0,
        points: vec![point(1_000_000_000, &[1.0, 2.0]), point(2_500_000_000, &[3.0, 4.0])],
        path: vec![ToleranceRequest::default(); 2],
        goal: vec![stands; 2],
        goal_time_ns: None,
        start: vec![ToleranceRequest::default(); 2],
        ..TrajectoryRequest::default()
    };
    assert_eq!(read(&goal()), Ok(expected));
}

#[test]
fn joints_may_stand_in_any_order() {
    let mut goal = goal();
    goal.trajectory.joint_names.reverse();
    goal.goal_tolerance = vec![tolerance("x", 0.5, 0.0, 0.0)];
    let request = read(&goal).unwrap();
    assert_eq!(request.axes, ["y", "x"]);
    assert_eq!(request.points[0].positions, [1.0, 2.0], "in the order of the message");
    assert_eq!((request.goal[0].position, request.goal[1].position), (None, Some(0.5)));
}

#[test]
fn missing_fields_of_points_stay_empty() {
    let mut goal = goal();
    goal.trajectory.points[0].velocities = vec![0.5, -0.5];
    goal.trajectory.points[1].velocities = vec![0.0, 0.0];
    goal.trajectory.points[1].accelerations = vec![0.0, 9.0];
    let request = read(&goal).unwrap();
    assert_eq!(request.points[0].velocities, [0.5, -0.5]);
    assert_eq!(request.points[0].accelerations, [0.0; 0]);
    assert_eq!(request.points[1].accelerations, [0.0, 9.0]);
}

#[test]
fn a_stamp_moves_the_start() {
    let start = |sec, nanosec| {
        let mut goal = goal();
        goal.trajectory.header.stamp = Time { sec, nanosec };
        read(&goal).map(|request| request.start_ns)
    };
    let now = 1_700_000_000;
    assert_eq!(start(now + 3, 5), Ok(3_000_000_005), "in the future");
    assert_eq!(start(now - 2, 0), Ok(-2_000_000_000), "it has begun before");
    assert_eq!(start(now - 3, 500_000_000), Ok(-2_500_000_000), "it ends now");
    assert_eq!(start(now - 3, 0), Err(GoalError::Past { ago_ns: 500_000_000 }));
    assert_eq!(
        start(now - 3, 0).unwrap_err().to_string(),
        "the trajectory ends 0.5 s before now; it may have begun before, but must end later"
    );
    assert_eq!(start(now + 600, 0), Ok(600_000_000_000));
    assert_eq!(
        start(now + 600, 500_000_000).unwrap_err().to_string(),
        "the stamp is 1700000600.5 s, 600.5 s after now, 1700000000 s; at most 600 s is allowed"
    );
    // A simulation whose time is still unknown: a stamp of system time would delay the start by half a century.
    let mut early = goal();
    early.trajectory.header.stamp = Time { sec: now, nanosec: 0 };
    let unknown = request(&joints(), &settings(), &early, 0).unwrap_err().to_string();
    assert_eq!(unknown, "the stamp is 1700000000 s, and /clock has not said any time yet; a stamp of 0 starts at once");
    early.trajectory.header.stamp = Time::default();
    assert!(request(&joints(), &settings(), &early, 0).is_ok());
}

#[test]
fn partial_goals_need_their_parameter() {
    let mut goal = goal();
    goal.trajectory.joint_names = vec!["y".to_owned()];
    goal.trajectory.points = vec![point(1.0, &[2.0])];
    assert_eq!(
        read(&goal).unwrap_err().to_string(),
        "joint_names has 1 of x, y; all are expected, or some with allow_partial_joints_goal"
    );
    let settings = Settings { partial: true, joints: vec![[0.1, 0.2, 0.0], [0.3, 0.4, 0.0]], ..settings() };
    let request = request(&joints(), &settings, &goal, NOW).unwrap();
    assert_eq!(request.axes, ["y"]);
    assert_eq!((request.path[0].position, request.goal[0].position), (Some(0.3), Some(0.4)), "its own tolerances");
    goal.path_tolerance = vec![tolerance("x", 1.0, 0.0, 0.0)];
    let error = super::request(&joints(), &settings, &goal, NOW).unwrap_err();
    assert_eq!(error.to_string(), "path_tolerance has the joint `x`; joints of joint_names are expected");
}

#[test]
fn settings_of_group_and_joints_are_part_of_the_request() {
    let limits = TrajectoryLimits { margin: 0.01, on_excess: OnExcess::Refuse, max_stretch: 2.0 };
    let group =
        TrajectorySettings { limits, angle_wraparound: true, max_duration: 1.5, ..TrajectorySettings::default() };
    let settings = Settings { group, joints: vec![[0.0, 0.0, 0.01], [0.0; 3]], ..settings() };
    let request = request(&joints(), &settings, &goal(), NOW).unwrap();
    assert_eq!((request.limits, request.angle_wraparound), (limits, true));
    assert_eq!(request.max_duration_ns, Some(1_500_000_000));
    assert_eq!((request.start[0].position, request.start[1].position), (Some(0.01), None));
}

#[test]
fn last_point_may_have_velocities_where_the_parameter_allows_them() {
    let mut goal = goal();
    goal.trajectory.points[1].velocities = vec![0.0, -0.25];
    let settings = Settings { may_end_in_motion: true, ..settings() };
    let of = |goal: &Goal| request(&joints(), &settings, goal, NOW).expect("nothing is wrong");
    let moving = of(&goal);
    assert!(moving.may_end_in_motion && moving.points[1].velocities == [0.0, -0.25]);
    assert_eq!(moving.goal[0].velocity, None, "joints that move on do not stand");
    goal.trajectory.points[1].velocities = vec![0.0, 0.0];
    assert_eq!(of(&goal).goal[0].velocity, Some(0.01));
}

#[test]
fn a_trajectory_ends_at_rest() {
    refused_by_core(
        |goal| goal.trajectory.points[1].velocities = vec![0.0, -0.25],
        "the velocity of `y` in the last point is -0.25 m/s (-250 mm/s); 0 is expected, or set \
         allow_nonzero_velocity_at_trajectory_end",
    );
    // Velocities below the float epsilon count as zero: 1.19e-7, as in the controller.
    let mut goal = goal();
    let is_taken = |goal: &Goal| config().resolve_trajectory(&read(goal).expect("a good message")).is_ok();
    goal.trajectory.points[1].velocities = vec![1.1e-7, -1.1e-7];
    assert!(is_taken(&goal));
    goal.trajectory.points[1].velocities = vec![1.2e-7, 0.0];
    assert!(!is_taken(&goal));
}

/// The range of these parameters is unlimited.
#[test]
fn parameters_that_are_very_large_are_no_limit_and_refuse_no_goal() {
    let settings =
        Settings { goal_time: f64::MAX, stopped: f64::MAX, joints: vec![[f64::MAX; 3]; 2], ..Settings::default() };
    let request = request(&joints(), &settings, &goal(), NOW).expect("nothing is wrong");
    assert_eq!((request.path[0], request.goal[1]), (ToleranceRequest::default(), ToleranceRequest::default()));
    assert_eq!(request.goal_time_ns, None);
    assert!(config().resolve_trajectory(&request).is_ok());
}

#[test]
fn goal_tolerances_override_parameters() {
    let settings =
        Settings { goal_time: 1.5, stopped: 0.01, joints: vec![[0.1, 0.2, 0.0], [0.0; 3]], ..Settings::default() };
    let mut goal = goal();
    // 0: value of the parameters; -1: no limit; otherwise: this value.
    goal.path_tolerance = vec![tolerance("x", -1.0, 0.0, 3.0)];
    goal.goal_tolerance = vec![tolerance("x", 0.0, -1.0, 0.0), tolerance("y", 0.7, 0.8, 0.0)];
    let merged = |goal: &Goal| request(&joints(), &settings, goal, NOW).unwrap();
    let request = merged(&goal);
    assert_eq!(request.path[0], ToleranceRequest { acceleration: Some(3.0), ..ToleranceRequest::default() });
    assert_eq!(request.path[1], ToleranceRequest::default());
    assert_eq!(request.goal[0], ToleranceRequest { position: Some(0.2), ..ToleranceRequest::default() });
    let own = ToleranceRequest { position: Some(0.7), velocity: Some(0.8), acceleration: None };
    assert_eq!(request.goal[1], own);
    assert_eq!(request.goal_time_ns, Some(1_500_000_000), "0: what the parameter says");
    for (sec, nanosec, time) in [(2, 7, Some(2_000_000_007)), (-1, 0, None)] {
        goal.goal_time_tolerance = Duration { sec, nanosec };
        assert_eq!(merged(&goal).goal_time_ns, time);
    }
}

#[test]
fn invalid_goals_are_refused_with_reason() {
    refused(|goal| goal.trajectory.joint_names.clear(), "joint_names is empty; one or more of x, y are expected");
    refused(
        |goal| goal.trajectory.joint_names[1] = "line".to_owned(),
        "joint_names has the joint `line`; there are x, y",
    );
    refused(
        |goal| goal.trajectory.joint_names[1] = "x".to_owned(),
        "joint_names has the joint `x` twice; once is expected",
    );
    refused(|goal| goal.trajectory.points.clear(), "points is empty; one point or more is expected");
    refused(
        |goal| goal.trajectory.points[1].time_from_start = at(1.0),
        "points[1].time_from_start is 1 s; more than 1 s, the time of the point before it, is expected",
    );
    refused(
        |goal| goal.trajectory.points[0].time_from_start = at(-0.5),
        "points[0].time_from_start is -0.5 s; 0 s or more is expected",
    );
    refused_by_core(
        |goal| goal.trajectory.points[0].positions = vec![1.0],
        "points[0].positions has 1 number; one for each joint (2) is expected",
    );
    refused_by_core(
        |goal| goal.trajectory.points[1].positions.clear(),
        "points[1].positions has 0 numbers; one for each joint (2) is expected",
    );
    refused_by_core(
        |goal| goal.trajectory.points[1].accelerations = vec![0.0; 3],
        "points[1].accelerations has 3 numbers; one for each joint (2), or none, is expected",
    );
    refused_by_core(
        |goal| goal.trajectory.points[0].velocities = vec![0.0, f64::NAN],
        "points[0].velocities of `y` is NaN; a finite number within +-1e38 is expected",
    );
    refused_by_core(
        |goal| goal.trajectory.points[0].positions[0] = f64::INFINITY,
        "points[0].positions of `x` is inf; a finite number within +-1e38 is expected",
    );
    refused(
        |goal| goal.trajectory.points[0].effort = vec![1.0, 1.0],
        "points[0].effort is not empty; positions, velocities and accelerations are followed",
    );
    refused(
        |goal| goal.multi_dof_trajectory.joint_names = vec!["x".to_owned()],
        "multi_dof_trajectory is not empty; only trajectory is followed",
    );
    refused(
        |goal| goal.component_goal_tolerance = vec![Default::default()],
        "component_goal_tolerance is not empty; only tolerances of joints are kept",
    );
}

#[test]
fn invalid_tolerances_are_refused_with_reason() {
    refused(
        |goal| goal.path_tolerance = vec![tolerance("elbow", 1.0, 0.0, 0.0)],
        "path_tolerance has the joint `elbow`; there are x, y",
    );
    refused(
        |goal| goal.goal_tolerance = vec![tolerance("x", 1.0, 0.0, 0.0), tolerance("x", 2.0, 0.0, 0.0)],
        "goal_tolerance has the joint `x` twice; once is expected",
    );
    refused(
        |goal| goal.goal_tolerance = vec![tolerance("y", 0.0, -0.5, 0.0)],
        "goal_tolerance (velocity) of `y` is -0.5; a positive number, 0 for the parameter's or -1 for no limit is \
         expected",
    );
    refused(
        |goal| goal.path_tolerance = vec![tolerance("y", 0.0, 0.0, f64::NAN)],
        "path_tolerance (acceleration) of `y` is NaN; a positive number, 0 for the parameter's or -1 for no limit is \
         expected",
    );
    refused(
        |goal| goal.goal_time_tolerance = at(-2.0),
        "goal_time_tolerance is -2 s; 0 or more, or -1 s for no limit, is expected",
    );
}

#[test]
fn joint_names_select_axes_and_object_names_are_refused() {
    let joints = joints_called(&JointNames::new(["line", "Shoulder_Pan", "left/arm_1"].map(str::to_owned).to_vec()));
    let read = |change: &dyn Fn(&mut Goal)| {
        let mut goal = goal();
        goal.trajectory.joint_names = vec!["left/arm_1".to_owned(), "Shoulder_Pan".to_owned()];
        change(&mut goal);
        let request = request(&joints, &settings(), &goal, NOW).map_err(|wrong| wrong.to_string())?;
        config().resolve_trajectory(&request).map_err(|error| error.to_string())?;
        Ok::<_, String>(request)
    };
    let good = read(&|goal| goal.path_tolerance = vec![tolerance("Shoulder_Pan", 0.5, 0.0, 0.0)]).unwrap();
    assert_eq!(good.axes, ["y", "x"]);
    assert_eq!((good.path[0].position, good.path[1].position), (None, Some(0.5)));
    let object = |field: &str| format!("{field} has `x`, the object name of an axis; its joint name is `Shoulder_Pan`");
    let wrong = read(&|goal| goal.trajectory.joint_names[1] = "x".to_owned());
    assert_eq!(wrong, Err(object("joint_names")));
    let wrong = read(&|goal| goal.goal_tolerance = vec![tolerance("x", 0.5, 0.0, 0.0)]);
    assert_eq!(wrong, Err(object("goal_tolerance")));
    let wrong = read(&|goal| goal.trajectory.points[0].positions[1] = 1e300);
    let sentence = "points[0].positions of `Shoulder_Pan` is 1e300; a finite number within +-1e38 is expected";
    assert_eq!(wrong.unwrap_err(), sentence);
    // For an axis outside the group there is no suggestion.
    let wrong = read(&|goal| goal.trajectory.joint_names[1] = "line".to_owned());
    assert_eq!(wrong.unwrap_err(), "joint_names has the joint `line`; there are Shoulder_Pan, left/arm_1");
    let wrong = read(&|goal| goal.trajectory.points[0].positions[1] = f64::NAN);
    let sentence = "points[0].positions of `Shoulder_Pan` is NaN; a finite number within +-1e38 is expected";
    assert_eq!(wrong.unwrap_err(), sentence);
}

#[test]
fn long_names_are_cut_in_sentences() {
    let mut goal = goal();
    goal.trajectory.joint_names[0] = "j".repeat(10_000_000);
    assert!(read(&goal).unwrap_err().to_string().len() < 200);
}
